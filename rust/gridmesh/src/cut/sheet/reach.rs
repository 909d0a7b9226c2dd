//! How far a stroke reaches whose ends are not continued to infinity: which of the curves in which the swept surface
//! meets the mesh are cut.
//!
//! The crossings of the line with the mesh's edges are joined within triangles to curves. Those that the stroke itself
//! meets are cut, and with an outline the holes in it; the crossings of all others are forgotten.

use glam::{DVec2, DVec3};

use crate::cut::divide::chains::{is_inside, start};
use crate::cut::divide::cross::Edges;
use crate::cut::divide::locate::Met;
use crate::cut::sheet::Sheet;
use crate::error::{Error, Result};
use crate::progress::Progress;

/// A curve in which the swept surface meets the mesh, on the unrolled surface.
#[derive(Default)]
struct Curve {
    /// Stretches, as the left piece's faces run along them.
    stretches: Vec<[DVec2; 2]>,
    low: f64,
    high: f64,
    area: f64,
}

/// Curves, and for each crossing the one that it is on.
struct Curves {
    curves: Vec<Curve>,
    curve_of: Vec<u32>,
}

/// What a stroke cuts whose ends are not continued.
pub(in crate::cut) struct Reach {
    /// For each crossing, counted along all edges: whether it is cut.
    pub cut: Vec<bool>,
    /// From where to where on the unrolled line.
    pub from: f64,
    pub to: f64,
}

/// Finds what the stroke itself cuts.
///
/// # Errors
/// [`Error::StrokeMisses`] if that is nothing, [`Error::Cancelled`].
pub(in crate::cut) fn reach(
    vertices: &[DVec3],
    sheet: &Sheet,
    met: &Met,
    edges: &Edges,
    progress: Progress<'_>,
) -> Result<Reach> {
    let found = join(vertices, sheet, met, edges, progress)?;
    let [from, to] = sheet.drawn();
    let curves = &found.curves;
    let meets = |c: &Curve| c.stretches.iter().any(|[p, q]| p.x.min(q.x) <= to && p.x.max(q.x) >= from);
    let mut cut = curves.iter().map(meets).collect::<Vec<_>>();
    // Holes go with what they are in.
    let sign = curves.iter().map(|c| c.area).sum::<f64>().signum();
    for k in 0..curves.len() {
        if sign * curves[k].area >= 0.0 {
            continue;
        }
        progress.report(1.0)?;
        let around = (0..curves.len())
            .filter(|&o| o != k && sign * curves[o].area > 0.0 && curves[o].holds(&curves[k]));
        if let Some(outline) = around.min_by(|&a, &b| curves[a].area.abs().total_cmp(&curves[b].area.abs())) {
            cut[k] = cut[outline];
        }
    }
    let own = || (0..curves.len()).filter(|&k| cut[k]);
    if own().next().is_none() {
        return Err(Error::StrokeMisses);
    }
    let (low, high) = (own().map(|k| curves[k].low), own().map(|k| curves[k].high));
    let (from, to) = (low.fold(from, f64::min), high.fold(to, f64::max));
    let cut = found.curve_of.iter().map(|&c| cut[c as usize]).collect();
    Ok(Reach { cut, from, to })
}

/// Joins crossings within triangles.
fn join(
    vertices: &[DVec3],
    sheet: &Sheet,
    met: &Met,
    edges: &Edges,
    progress: Progress<'_>,
) -> Result<Curves> {
    let mut starts = vec![0];
    for hits in &edges.hits {
        starts.push(starts[starts.len() - 1] + hits.len());
    }
    let mut roots = (0..starts[edges.hits.len()]).collect::<Vec<_>>();
    let spot = |id: usize| {
        let k = starts.partition_point(|&s| s <= id) - 1;
        let (hit, (a, b)) = (&edges.hits[k][id - starts[k]], edges.keys[k]);
        let p = vertices[a as usize].lerp(vertices[b as usize], hit.t);
        DVec2::new(sheet.place(hit.segment as usize, hit.s), sheet.view.height(p))
    };
    let mut stretches = vec![];
    for (at, &(corners, _)) in edges.triangles.iter().enumerate() {
        if at % 4096 == 0 {
            progress.report(at as f64 / edges.triangles.len() as f64)?;
        }
        // Around the triangle: segment, place, number, and whether the side before it is on the left.
        let mut events: Vec<(u32, f64, usize, bool)> = vec![];
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let Ok(edge) = edges.keys.binary_search(&(a.min(b), a.max(b))) else { continue };
            let n = edges.hits[edge].len();
            for j in 0..n {
                let i = if a < b { j } else { n - 1 - j };
                let hit = &edges.hits[edge][i];
                let place = sheet.place(hit.segment as usize, hit.s);
                events.push((hit.segment, place, starts[edge] + i, met.left[a as usize] != (j % 2 == 1)));
            }
        }
        events.sort_by(|x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)));
        let segments = events.iter().map(|e| e.0).collect::<Vec<_>>();
        let Some(begin) = start(&segments, |k| is_inside(sheet, corners, k)) else { continue };
        let count = events.len();
        for pair in 0..count / 2 {
            let p = events[(begin + 2 * pair) % count];
            let q = events[(begin + 2 * pair + 1) % count];
            let (x, y) = (root(&mut roots, p.2), root(&mut roots, q.2));
            roots[x.max(y)] = x.min(y);
            stretches.push(if p.3 { (p.2, q.2) } else { (q.2, p.2) });
        }
    }
    let mut number = vec![u32::MAX; roots.len()];
    let mut curves: Vec<Curve> = vec![];
    let mut curve_of = vec![0; roots.len()];
    for id in 0..roots.len() {
        let own = root(&mut roots, id);
        if own == id {
            number[id] = curves.len() as u32;
            let x = spot(id).x;
            curves.push(Curve { low: x, high: x, ..Curve::default() });
        }
        curve_of[id] = number[own];
    }
    for (p, q) in stretches {
        let curve = &mut curves[curve_of[p] as usize];
        let ends = [spot(p), spot(q)];
        for end in ends {
            (curve.low, curve.high) = (curve.low.min(end.x), curve.high.max(end.x));
        }
        let origin = curve.stretches.first().map_or(ends[0], |s| s[0]);
        curve.area += 0.5 * (ends[0] - origin).perp_dot(ends[1] - origin);
        curve.stretches.push(ends);
    }
    Ok(Curves { curves, curve_of })
}

fn root(parents: &mut [usize], mut i: usize) -> usize {
    while parents[i] != i {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    i
}

impl Curve {
    /// True if another curve lies inside this one.
    fn holds(&self, other: &Curve) -> bool {
        if other.low < self.low || other.high > self.high || other.stretches.is_empty() {
            return false;
        }
        let n = other.stretches.len();
        let within = |k: usize| {
            let p = other.stretches[k * n / 3][0];
            let passes = |[a, b]: &&[DVec2; 2]| {
                (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
            };
            self.stretches.iter().filter(passes).count() % 2 == 1
        };
        (0..3).filter(|&k| within(k)).count() >= 2
    }
}
