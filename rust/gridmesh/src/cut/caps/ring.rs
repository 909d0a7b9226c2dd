//! Regions between two loops, filled by a lattice tube in the unrolled surface.

use glam::DVec2;
use robust::{Coord, orient2d};

use super::regions::Spot;
use crate::cut::caps::capper::{Capper, key, sides};
use crate::cut::sheet::roll::Roll;
use crate::error::{Error, Result};
use crate::fill::bridge::{BridgeOptions, bridge};
use crate::fill::options::Smooth;
use crate::fill::planar::flat::{FlatFill, Method};
use crate::fill::planar::quality::Quality;
use crate::options::CellShape;
use crate::progress::Progress;

/// Edges of both loops up to which a tube is tried: it takes longer than polygons do.
const MOST: usize = 1000;

/// How many times as long as the shortest edge the longest one may be where the rim is as the mesh divides it: what is uneven has no
/// good tube.
const UNEVEN: f64 = 4.0;

/// Least corners, in degrees, of triangles and of quads that are good enough. Where a hole lies far from the middle, polygons have
/// better ones.
const LEAST: [f64; 2] = [20.0, 30.0];

impl Capper<'_> {
    /// A patch between an outline, counter-clockwise, and the hole in it, the vertices of which are those of `ring`: of the outline
    /// first, of which there are `n`. `None` where polygons are better.
    pub(crate) fn ring(&self, ring: &[Spot], n: usize, progress: Progress<'_>) -> Result<Option<FlatFill>> {
        let roll = Roll::new(self.sheet, ring);
        let flat = ring.iter().map(|s| roll.flatten(s.at)).collect::<Vec<_>>();
        let is_even =
            self.cutting.options.edge_length.is_some() || !(is_uneven(&flat[..n]) || is_uneven(&flat[n..]));
        if ring.len() > MOST || !is_even {
            return Ok(None);
        }
        let vertices = flat.iter().map(|p| p.extend(0.0)).collect::<Vec<_>>();
        let names = (0..ring.len() as u32).collect::<Vec<_>>();
        let cells = self.cutting.options.cells;
        let options = BridgeOptions { smooth: Smooth::Flat, cells, ..BridgeOptions::default() };
        let (outline, hole) = names.split_at(n);
        let fill = match bridge(&vertices, &[], outline, hole, &options, progress) {
            // Where there is no tube there are polygons.
            Err(
                Error::ZeroLengthEdge { .. }
                | Error::SelfTouching { .. }
                | Error::NoPatch { .. }
                | Error::TooLarge { .. }
                | Error::ExtremeSize { .. }
                | Error::Solver { .. },
            ) => return Ok(None),
            fill => fill?,
        };
        let interior = fill.vertices.iter().map(|p| p.truncate()).collect::<Vec<DVec2>>();
        let triangles = fill.facets();
        let quads = fill.quads.len();
        let made = FlatFill {
            interior,
            triangles,
            quads,
            method: Method::Optimal,
            quality: Quality::default(),
            folded: false,
            candidates: 1,
        };
        let least = LEAST[usize::from(cells == CellShape::Quad)].to_radians();
        let is_good =
            fill.report.min_angle >= least && is_embedded(&flat, &made) && !self.repeats_in(ring, n, &made);
        Ok(is_good.then_some(made))
    }

    /// Whether a patch has an edge across the ring that exists by now.
    fn repeats_in(&self, ring: &[Spot], n: usize, patch: &FlatFill) -> bool {
        let follows = |a: usize, b: usize| {
            let (first, count) = if a < n { (0, n) } else { (n, ring.len() - n) };
            (b >= n) == (a >= n)
                && ((a - first + 1) % count == b - first || (b - first + 1) % count == a - first)
        };
        let is_taken = |(a, b): (u32, u32)| {
            let (a, b) = (a as usize, b as usize);
            let (Some(p), Some(q)) = (ring.get(a), ring.get(b)) else { return false };
            !follows(a, b) && self.edges.contains(&key(p.node, q.node))
        };
        patch.quads().any(|q| sides(&q).any(is_taken))
            || patch.single().iter().any(|t| sides(t).any(is_taken))
    }
}

/// Whether the edges of a loop differ much in length.
fn is_uneven(loop_: &[DVec2]) -> bool {
    let lengths = loop_.iter().zip(loop_.iter().cycle().skip(1)).map(|(p, q)| p.distance(*q));
    let (least, most) = lengths.fold((f64::INFINITY, 0.0f64), |(least, most), l| (least.min(l), most.max(l)));
    most > UNEVEN * least
}

/// Whether all corners of the faces turn to the left.
fn is_embedded(rim: &[DVec2], patch: &FlatFill) -> bool {
    let at = |v: u32| {
        let p = rim.get(v as usize).copied().unwrap_or_else(|| patch.interior[v as usize - rim.len()]);
        Coord { x: p.x, y: p.y }
    };
    let is_left = |a: u32, b: u32, c: u32| orient2d(at(a), at(b), at(c)) > 0.0;
    patch.single().iter().all(|&[a, b, c]| is_left(a, b, c))
        && patch.quads().all(|q| (0..4).all(|k| is_left(q[k], q[(k + 1) % 4], q[(k + 2) % 4])))
}
