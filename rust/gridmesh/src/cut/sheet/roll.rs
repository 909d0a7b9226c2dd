//! The swept surface unrolled into the plane.

use glam::DVec2;

use crate::cut::caps::regions::Spot;
use crate::cut::sheet::Sheet;

/// The unrolled sheet around a region: places and heights as points of the plane, without distortion.
pub(in crate::cut) struct Roll {
    /// For a sheet through an eye: the place in the middle.
    middle: Option<f64>,
}

impl Roll {
    pub fn new(sheet: &Sheet, polygon: &[Spot]) -> Self {
        let low = polygon.iter().map(|s| s.at.x).fold(f64::INFINITY, f64::min);
        let high = polygon.iter().map(|s| s.at.x).fold(f64::NEG_INFINITY, f64::max);
        Roll { middle: sheet.view.central.then_some(0.5 * (low + high)) }
    }

    pub fn flatten(&self, at: DVec2) -> DVec2 {
        match self.middle {
            None => at,
            Some(middle) => at.y * DVec2::new(libm::sin(at.x - middle), libm::cos(at.x - middle)),
        }
    }

    pub fn unflatten(&self, p: DVec2) -> DVec2 {
        match self.middle {
            None => p,
            Some(middle) => DVec2::new(middle + libm::atan2(p.x, p.y), p.length()),
        }
    }
}
