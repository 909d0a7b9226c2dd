//! Regions between two loops, filled by a lattice tube in the unrolled surface.

use glam::DVec2;
use robust::{Coord, orient2d};

use super::capper::Capper;
use super::regions::{Region, Spot};
use crate::cut::options::CutOptions;
use crate::cut::sheet::roll::Roll;
use crate::error::{Error, Result};
use crate::fill::bridge::{BridgeOptions, bridge};
use crate::fill::options::Smooth;
use crate::fill::planar::flat_patch::FlatPatch;
use crate::options::CellShape;
use crate::progress::Progress;

/// Edges of both loops up to which a tube is tried: it takes longer than polygons do.
const MOST: usize = 1000;

/// How many times as long as the shortest edge the longest one may be where the rim is as the mesh divides it: what is uneven has no
/// good tube.
const UNEVEN: f64 = 4.0;

/// Least corners, in degrees, that are good enough: chosen looking at rings of tori. Where a hole lies far from the middle polygons
/// have better ones, and more irregular vertices; at 0 they are never made, at twice these degrees always.
const LEAST_OF_TRIANGLES: f64 = 20.0;
const LEAST_OF_QUADS: f64 = 30.0;

impl Capper<'_> {
    /// A patch between the outline of a region and the one hole in it, and its rim: the outline, then the hole. `None` for other
    /// regions, and where polygons are better.
    pub(crate) fn ring(
        &self,
        region: &Region,
        progress: Progress<'_>,
    ) -> Result<Option<(Vec<Spot>, FlatPatch)>> {
        let Region::Sheet { outline, holes } = region else { return Ok(None) };
        let [hole] = &holes[..] else { return Ok(None) };
        let rim = [&outline[..], hole].concat();
        let roll = Roll::new(self.sheet, &rim);
        let flat = rim.iter().map(|s| roll.flatten(s.at)).collect::<Vec<_>>();
        let (outer, inner) = flat.split_at(outline.len());
        let CutOptions { cells, edge_length, .. } = *self.cutting.options;
        if rim.len() > MOST || (edge_length.is_none() && (is_uneven(outer) || is_uneven(inner))) {
            return Ok(None);
        }
        let vertices = flat.iter().map(|p| p.extend(0.0)).collect::<Vec<_>>();
        let names = (0..rim.len() as u32).collect::<Vec<_>>();
        let (first, second) = names.split_at(outline.len());
        let options = BridgeOptions { smooth: Smooth::Flat, cells, ..BridgeOptions::default() };
        let fill = match bridge(&vertices, &[], first, second, &options, progress) {
            // Where there is no tube there are polygons.
            Err(
                Error::ZeroLengthEdge { .. }
                | Error::SelfTouching { .. }
                | Error::Loops(_)
                | Error::NoPatch { .. }
                | Error::TooLarge { .. }
                | Error::ExtremeSize { .. }
                | Error::Solver { .. },
            ) => return Ok(None),
            fill => fill?,
        };
        let interior = fill.vertices.iter().map(|p| p.truncate()).collect();
        let patch = FlatPatch { interior, triangles: fill.facets(), quads: fill.quads.len() };
        let least = match cells {
            CellShape::Triangle => LEAST_OF_TRIANGLES,
            CellShape::Quad => LEAST_OF_QUADS,
        };
        let is_good = fill.report.min_angle >= least.to_radians()
            && is_embedded(&flat, &patch)
            && !self.repeats(&[outline, hole], &patch);
        Ok(is_good.then_some((rim, patch)))
    }
}

/// Whether the edges of a loop differ much in length.
fn is_uneven(loop_: &[DVec2]) -> bool {
    let lengths = loop_.iter().zip(loop_.iter().cycle().skip(1)).map(|(p, q)| p.distance(*q));
    let (least, most) = lengths.fold((f64::INFINITY, 0.0f64), |(least, most), l| (least.min(l), most.max(l)));
    most > UNEVEN * least
}

/// Whether all corners of the faces turn to the left.
fn is_embedded(rim: &[DVec2], patch: &FlatPatch) -> bool {
    let at = |v: u32| {
        let p = rim.get(v as usize).copied().unwrap_or_else(|| patch.interior[v as usize - rim.len()]);
        Coord { x: p.x, y: p.y }
    };
    let is_left = |a: u32, b: u32, c: u32| orient2d(at(a), at(b), at(c)) > 0.0;
    patch.single().iter().all(|&[a, b, c]| is_left(a, b, c))
        && patch.quads().all(|q| (0..4).all(|k| is_left(q[k], q[(k + 1) % 4], q[(k + 2) % 4])))
}
