//! One drawing of a stage: polygons, lines, dots and wires.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use glam::{DVec2, DVec3};

use crate::body::surface::Surface;
use crate::path::placement::{Lattice, ROW_HEIGHT};
use crate::svg::ink::Ink;

/// One panel.
#[derive(Clone, Debug)]
pub struct Picture {
    pub(crate) body: String,
    pub(crate) low: DVec2,
    pub(crate) high: DVec2,
    pub(crate) scale: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
    /// Widths of lines and dots, relative to those of a large panel.
    pub(crate) weight: f64,
    pub(crate) title: String,
    pub(crate) caption: String,
    pub(crate) used: BTreeSet<Ink>,
}

impl Picture {
    /// An empty panel of at most `width` by `height` pixels that shows the box from `low` to `high`.
    /// `weight` scales the lines and dots: one suits a panel of 400 pixels.
    pub fn new(low: DVec2, high: DVec2, width: f64, height: f64, weight: f64) -> Self {
        let size = high - low;
        let scale = (width / size.x).min(height / size.y);
        Self {
            body: String::new(),
            low,
            high,
            scale,
            width: scale * size.x,
            height: scale * size.y,
            weight,
            title: String::new(),
            caption: String::new(),
            used: BTreeSet::new(),
        }
    }

    /// Names the panel.
    pub fn titled(mut self, title: &str, caption: &str) -> Self {
        (self.title, self.caption) = (title.to_owned(), caption.to_owned());
        self
    }

    /// Tenths of pixels, downwards.
    pub(crate) fn place(&self, p: DVec2) -> [i64; 2] {
        let q = 10.0 * self.scale * DVec2::new(p.x - self.low.x, self.high.y - p.y);
        [q.x.round() as i64, q.y.round() as i64]
    }

    pub(crate) fn push(&mut self, ink: Ink, data: &str) {
        if !data.is_empty() {
            self.used.insert(ink);
            let (class, width, ..) = ink.style();
            // Beats the class's width, which the legend has.
            let width = match width * self.weight {
                w if w == width => String::new(),
                w => format!(r#" style="stroke-width:{:.2}""#, w),
            };
            let _ = writeln!(self.body, r#"<path class="{class}"{width} d="{data}"/>"#);
        }
    }

    /// Closed polygons: lines, or one face by the even-odd rule.
    pub fn polygons<'a>(&mut self, ink: Ink, polygons: impl IntoIterator<Item = &'a [DVec2]>) {
        let mut data = String::new();
        for polygon in polygons {
            self.trail(&mut data, polygon.iter().copied());
            data.push('z');
        }
        self.push(ink, &data);
    }

    /// Separate lines.
    pub fn lines(&mut self, ink: Ink, lines: impl IntoIterator<Item = [DVec2; 2]>) {
        let mut data = String::new();
        for line in lines {
            self.trail(&mut data, line.into_iter());
        }
        self.push(ink, &data);
    }

    /// Round dots.
    pub fn dots(&mut self, ink: Ink, points: impl IntoIterator<Item = DVec2>) {
        let mut data = String::new();
        for p in points {
            let [x, y] = self.place(p);
            let _ = write!(data, "M{} {}h0", tenths(x), tenths(y));
        }
        self.push(ink, &data);
    }

    /// The edges of a mesh, each once, as a few long trails.
    pub fn wire(&mut self, positions: &[DVec2], triangles: &[[u32; 3]]) {
        let mut data = String::new();
        for trail in trails(triangles) {
            self.trail(&mut data, trail.into_iter().map(|v| positions[v as usize]));
        }
        self.push(Ink::Wire, &data);
    }

    /// The lines of a lattice across the panel.
    pub fn lattice(&mut self, lattice: &Lattice) {
        let (low, high) = (self.low, self.high);
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        let step = ROW_HEIGHT * lattice.edge_length;
        let mut lines = Vec::new();
        for k in 0..3 {
            let along = DVec2::from_angle(lattice.angle + f64::from(k) * std::f64::consts::FRAC_PI_3);
            let across = |p: DVec2| (p - lattice.origin).dot(along.perp()) / step;
            let rows = corners.map(across);
            let (first, last) = rows.iter().fold((f64::MAX, f64::MIN), |(a, b), &r| (a.min(r), b.max(r)));
            for row in first.ceil() as i64..=last.floor() as i64 {
                let base = lattice.origin + row as f64 * step * along.perp();
                lines.extend(clip(base, along, low, high));
            }
        }
        self.lines(Ink::Lattice, lines);
    }

    /// A body seen from an angle `tilt` above the drawing plane's edge, lit from the upper left;
    /// panels for it show the plane spanned by x and the vertical of the view.
    pub fn body(&mut self, surface: &Surface, tilt: f64) {
        const SHADES: f64 = 24.0;
        let (sin, cos) = libm::sincos(tilt);
        let view = |p: DVec3| DVec3::new(p.x, sin * p.y + cos * p.z, sin * p.z - cos * p.y);
        let seen: Vec<DVec3> = surface.vertices.iter().map(|&p| view(p)).collect();
        let light = DVec3::new(-0.45, 0.55, 0.7).normalize();
        let mut faces: Vec<(f64, [u32; 3], u8)> = Vec::new();
        for &t in &surface.triangles {
            let [a, b, c] = t.map(|v| seen[v as usize]);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            if normal.z > 0.0 {
                let shade = SHADES * (0.5 + 0.5 * normal.dot(light)).powi(2);
                faces.push(((a + b + c).z, t, shade.round() as u8));
            }
        }
        faces.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Neighbours in the order of depth that share a shade share a path.
        for run in faces.chunk_by(|a, b| a.2 == b.2) {
            let mut data = String::new();
            for (_, t, _) in run {
                self.trail(&mut data, t.iter().map(|&v| seen[v as usize].truncate()));
                data.push('z');
            }
            let shade = f64::from(run[0].2) / SHADES;
            let mix = |dark: f64, bright: f64| (dark + shade * (bright - dark)).round() as u8;
            let (r, g, b) = (mix(58.0, 250.0), mix(72.0, 246.0), mix(96.0, 238.0));
            let _ =
                writeln!(self.body, r##"<path class="o" style="fill:#{r:02x}{g:02x}{b:02x}" d="{data}"/>"##);
        }
    }

    /// Appends a polyline: one absolute point, then steps.
    pub(crate) fn trail(&self, data: &mut String, points: impl Iterator<Item = DVec2>) {
        let mut last: Option<[i64; 2]> = None;
        for point in points {
            let [x, y] = self.place(point);
            match last {
                None => {
                    let _ = write!(data, "M{}", pair(x, y));
                    data.push('l');
                }
                Some([a, b]) => {
                    let step = pair(x - a, y - b);
                    if !data.ends_with('l') && !step.starts_with('-') {
                        data.push(' ');
                    }
                    data.push_str(&step);
                }
            }
            last = Some([x, y]);
        }
    }
}

/// Tenths as a decimal fraction without spare digits.
pub(crate) fn tenths(value: i64) -> String {
    let (sign, whole, rest) =
        (if value < 0 { "-" } else { "" }, value.unsigned_abs() / 10, value.unsigned_abs() % 10);
    match (whole, rest) {
        (_, 0) => format!("{sign}{whole}"),
        (0, _) => format!("{sign}.{rest}"),
        _ => format!("{sign}{whole}.{rest}"),
    }
}

pub(crate) fn pair(x: i64, y: i64) -> String {
    let y = tenths(y);
    format!("{}{}{y}", tenths(x), if y.starts_with('-') { "" } else { " " })
}

/// The part of a line that lies in a box.
pub(crate) fn clip(base: DVec2, along: DVec2, low: DVec2, high: DVec2) -> Option<[DVec2; 2]> {
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    for (x, d, low, high) in [(base.x, along.x, low.x, high.x), (base.y, along.y, low.y, high.y)] {
        if d.abs() < 1e-12 {
            if x < low || x > high {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - x) / d, (high - x) / d);
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    (from < to).then(|| [base + from * along, base + to * along])
}

/// Every edge of a mesh in exactly one walk; linear but for sorting.
pub(crate) fn trails(triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut edges: Vec<[u32; 2]> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let mut ends: Vec<(u32, u32, u32)> = Vec::with_capacity(2 * edges.len());
    for (i, &[a, b]) in (0u32..).zip(&edges) {
        ends.extend([(a, b, i), (b, a, i)]);
    }
    ends.sort_unstable();
    let mut next: Vec<usize> = Vec::new();
    for (i, end) in ends.iter().enumerate() {
        next.resize(next.len().max(end.0 as usize + 1), i);
    }
    let mut free = vec![true; edges.len()];
    let mut found = Vec::new();
    for start in 0..next.len() as u32 {
        loop {
            let mut trail = vec![start];
            let mut at = start;
            while let Some(&(from, to, edge)) = ends.get(next[at as usize]).filter(|end| end.0 == at) {
                next[from as usize] += 1;
                if std::mem::take(&mut free[edge as usize]) {
                    trail.push(to);
                    at = to;
                }
            }
            if trail.len() < 2 {
                break;
            }
            found.push(trail);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::assemble::assemble;
    use crate::lattice::axial::Axial;
    use crate::lattice::dir::Dir;
    use crate::svg::Ink;

    #[test]
    fn every_edge_is_drawn_once() {
        let mut at = Axial::new(4, 0);
        let mut ring = Vec::new();
        for side in 0..6 {
            for _ in 0..4 {
                ring.push(at);
                at = at + Dir::new(side + 2);
            }
        }
        let region = assemble(&[ring]);
        let mut drawn: Vec<[u32; 2]> = Vec::new();
        for trail in trails(&region.triangles) {
            drawn.extend(trail.windows(2).map(|w| [w[0].min(w[1]), w[0].max(w[1])]));
        }
        let n = drawn.len();
        drawn.sort_unstable();
        drawn.dedup();
        // A disk: edges = triangles + vertices - 1.
        assert_eq!((n, drawn.len()), (region.triangles.len() + region.points.len() - 1, n));
    }

    #[test]
    fn numbers_are_short() {
        let shown = [0, 5, -5, 10, -10, 123, -123, -100].map(tenths);
        assert_eq!(shown, ["0", ".5", "-.5", "1", "-1", "12.3", "-12.3", "-10"]);
        assert_eq!(pair(-12, -3), "-1.2-.3");
    }

    #[test]
    fn steps_add_up_to_the_points() {
        let mut picture = Picture::new(DVec2::ZERO, DVec2::new(10.0, 5.0), 100.0, 100.0, 1.0);
        picture.lines(Ink::Path, [[DVec2::new(1.0, 1.0), DVec2::new(2.5, 0.0)]]);
        assert_eq!(picture.body, "<path class=\"p\" d=\"M10 40l15 10\"/>\n");
    }

    #[test]
    fn lattice_lines_stay_in_the_panel() {
        let lattice = Lattice { origin: DVec2::new(0.3, 0.2), angle: 0.1, edge_length: 1.0 };
        for k in 0..40 {
            let base = lattice.from_units(DVec2::new(0.0, f64::from(k) - 20.0));
            if let Some(ends) = clip(base, DVec2::from_angle(0.7), DVec2::ZERO, DVec2::splat(3.0)) {
                for p in ends {
                    assert!(p.cmpge(DVec2::splat(-1e-9)).all() && p.cmple(DVec2::splat(3.0 + 1e-9)).all());
                }
            }
        }
    }
}
