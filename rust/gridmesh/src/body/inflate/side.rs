//! How deep each side is, and where.

use super::height::Flat;
use super::section;
use crate::body::inflate::options::{ALLOWED, InflateOptions, RANGE, Side};
use crate::error::{Error, Result, told};

/// Depth of both sides at every vertex of the flat patch.
pub(crate) struct Scales {
    pub front: Vec<f64>,
    pub back: Vec<f64>,
}

impl Scales {
    /// The larger of the two sides' means.
    pub fn largest_mean(&self) -> f64 {
        let mean = |data: &[f64]| data.iter().sum::<f64>() / data.len() as f64;
        mean(&self.front).max(mean(&self.back))
    }
}

impl InflateOptions {
    /// Refuses values that are not allowed.
    pub(crate) fn check(&self) -> Result<()> {
        let refuse =
            |name, value: f64, allowed| Err(Error::InvalidOption { name, value: told(value), allowed });
        if !RANGE.contains(&self.depth) {
            return refuse("depth", self.depth, ALLOWED);
        }
        if self.corner_angle.is_nan() || self.corner_angle < 0.0 {
            return refuse("corner_angle", self.corner_angle, "an angle in radians, 0 or more");
        }
        for (name, side) in [("front", &self.front), ("back", &self.back)] {
            let values = match side {
                None => continue,
                Some(Side::Uniform(value)) => std::slice::from_ref(value),
                Some(Side::PerPoint(values)) => values,
            };
            if let Some(&value) = values.iter().find(|v| !(0.0..=*RANGE.end()).contains(*v)) {
                return refuse(name, value, "0, or numbers up to 1e9");
            }
            let largest = values.iter().copied().fold(0.0, f64::max);
            if largest > 0.0 && largest < *RANGE.start() {
                return refuse(name, largest, "0, or a largest number from 1e-9 on");
            }
        }
        if let Some(values) = &self.curve {
            section::check(values)?;
        }
        let empty = |side: &Option<Side>| match side {
            None => false,
            Some(Side::Uniform(value)) => *value == 0.0,
            Some(Side::PerPoint(values)) => values.iter().all(|&v| v == 0.0),
        };
        if empty(&self.front) && empty(&self.back) {
            return refuse("back", 0.0, "a depth above 0 where the front's is 0, or the body is flat");
        }
        Ok(())
    }
}

/// The depth of both sides at every vertex.
pub(crate) fn scales(flat: &Flat<'_>, options: &InflateOptions) -> Result<Scales> {
    let front = side(flat, "front", options.front.as_ref(), options.depth)?;
    let back = if options.back == options.front {
        front.clone()
    } else {
        side(flat, "back", options.back.as_ref(), options.depth)?
    };
    Ok(Scales { front, back })
}

fn side(flat: &Flat<'_>, name: &'static str, side: Option<&Side>, depth: f64) -> Result<Vec<f64>> {
    let values = match side {
        None => return Ok(vec![depth; flat.vertices.len()]),
        Some(Side::Uniform(value)) => return Ok(vec![*value; flat.vertices.len()]),
        Some(Side::PerPoint(values)) => values,
    };
    let outer = &flat.patch.loops[0];
    let points = outer.source.iter().map(|s| s.0 as usize + 1).max().unwrap_or(0);
    if values.len() < points {
        return Err(Error::InvalidOption {
            name,
            value: format!("{} values", values.len()),
            allowed: "one number, or one per point of the outline",
        });
    }
    let known = outer.source.iter().map(|&(segment, t)| {
        let (a, b) = (values[segment as usize], values[(segment as usize + 1) % values.len()]);
        a + t * (b - a)
    });
    let known = known.collect::<Vec<_>>();
    flat.harmonic(&known)
}
