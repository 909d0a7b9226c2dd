//! Stand-in.
use glam::DVec2;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};
use crate::error::Result;
use crate::progress::Progress;
#[derive(Default)]
pub(crate) struct FlatOptions {}
pub(crate) struct FlatFill { pub(crate) interior: Vec<DVec2>, pub(crate) triangles: Vec<[u32; 3]> }
struct V { p: DVec2, i: u32 }
impl HasPosition for V { type Scalar = f64; fn position(&self) -> Point2<f64> { Point2::new(self.p.x, self.p.y) } }
fn inside(poly: &[DVec2], p: DVec2) -> bool {
    let n = poly.len(); let mut c = false;
    for i in 0..n { let (a, b) = (poly[i], poly[(i + 1) % n]); if (a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x { c = !c; } }
    c
}
pub(crate) fn fill_flat(polygon: &[DVec2], _wanted: &[i32], taken: &dyn Fn(usize, usize) -> bool, _options: &FlatOptions, _progress: Progress<'_>) -> Result<FlatFill> {
    let n = polygon.len();
    let h: f64 = (0..n).map(|k| polygon[k].distance(polygon[(k + 1) % n])).sum::<f64>() / n as f64;
    let (lo, hi) = polygon.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    let mut interior = vec![];
    let rows = ((hi.y - lo.y) / (h * 0.866)) as i32 + 1; let cols = ((hi.x - lo.x) / h) as i32 + 2;
    for r in 0..=rows { for c in -1..=cols {
        let p = lo + DVec2::new((c as f64 + 0.5 * (r % 2) as f64) * h, r as f64 * 0.866 * h);
        if inside(polygon, p) && (0..n).all(|k| crate::segments::nearest_on_segment(p, polygon[k], polygon[(k + 1) % n]).1.sqrt() > 0.6 * h) { interior.push(p); }
    } }
    loop {
        let mut t: ConstrainedDelaunayTriangulation<V> = ConstrainedDelaunayTriangulation::new();
        let hs: Vec<_> = polygon.iter().chain(&interior).enumerate().map(|(i, &p)| t.insert(V { p, i: i as u32 }).unwrap()).collect();
        for k in 0..n { t.add_constraint(hs[k], hs[(k + 1) % n]); }
        let triangles: Vec<[u32; 3]> = t.inner_faces().filter(|f| { let c = f.center(); inside(polygon, DVec2::new(c.x, c.y)) }).map(|f| f.vertices().map(|v| v.data().i)).collect();
        let mut extra = None;
        for tr in &triangles { for k in 0..3 { let (a, b) = (tr[k] as usize, tr[(k + 1) % 3] as usize);
            let adj = (a + 1) % n == b || (b + 1) % n == a;
            if a < n && b < n && !adj && taken(a, b) { extra = Some(0.5 * (polygon[a] + polygon[b])); } } }
        match extra { Some(p) => interior.push(p), None => return Ok(FlatFill { interior, triangles }) }
    }
}
