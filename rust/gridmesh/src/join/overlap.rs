//! Pieces of one part that overlap each other: these are joined as parts of their own.

use std::panic::{AssertUnwindSafe, catch_unwind};

use manifold_rust::manifold::Manifold;
use manifold_rust::types::{BooleanEngine, MeshGL64, OpType};
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::pieces::{Fault, INSIDE_OUT, Piece, Surface};
use crate::error::{Error, Result};
use crate::fill::parallel::in_parallel;
use crate::fill::surface::meet::Box3;
use crate::geometry::embed::{triangles_cross, triangles_meet};
use crate::progress::Progress;

/// Pieces touch, and do not overlap, whose boxes have less than this in common, relative to the larger box: rounding to single
/// precision lets bricks of a wall overlap by so much.
const THIN: f64 = 1e-6;

/// Pieces that touch overlap if they have more than this in common, relative to the smaller one.
const COMMON: f64 = 1e-6;

/// How the surfaces of two pieces lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lie {
    Apart,
    /// They touch or lie on each other; what they enclose does not overlap.
    Touching,
    /// They cross at this vertex, or what they enclose overlaps there.
    Crossing(u32),
}

/// The triangles of each solid that a part consists of, by their numbers in the part: solids overlap each other only where pieces
/// of the part do. One of them has all pieces that overlap no other, and each piece is with its cavities.
///
/// # Errors
/// What `refuse` makes of pieces that enclose nothing, are inside out, or are cavities that cross what they lie in;
/// [`Error::JoinFailed`], [`Error::Cancelled`].
pub(super) fn solids(
    surface: &Surface<'_>,
    refuse: impl Fn(Fault) -> Error,
    progress: Progress<'_>,
) -> Result<Vec<Vec<u32>>> {
    let pieces = surface.pieces();
    surface.flat(&pieces).map_or(Ok(()), |fault| Err(refuse(fault)))?;
    if pieces.len() < 2 {
        return Ok(pieces.into_iter().map(|piece| piece.triangles).collect());
    }
    let owners = surface.owners(&pieces).map_err(&refuse)?;
    let pairs = near_pairs(&pieces);
    let size = |&[a, b]: &[usize; 2]| pieces[a].triangles.len() + pieces[b].triangles.len();
    let lies = in_parallel(&pairs, size, progress, |&[a, b], progress| {
        progress.report(0.0)?;
        lie(surface, &pieces[a], &pieces[b])
    })?;
    let mut overlaps = vec![false; pieces.len()];
    // Whether a point on a piece is within one that touches it is left open.
    let mut beside = vec![vec![]; pieces.len()];
    for (&[a, b], lie) in pairs.iter().zip(lies) {
        let own = owners[a] == owners[b];
        match lie {
            Lie::Crossing(v) if own => {
                return Err(refuse((v, "a cavity of it crosses what it lies in, or another cavity,")));
            }
            Lie::Crossing(_) => (overlaps[owners[a]], overlaps[owners[b]]) = (true, true),
            Lie::Apart | Lie::Touching => {}
        }
        if own || lie != Lie::Touching {
            beside[a].push(b);
            beside[b].push(a);
        }
    }
    let is_within = |k: usize| {
        let at = surface.vertices[surface.vertex(&pieces[k]) as usize];
        beside[k].iter().map(|&other| surface.turns(&pieces[other], at)).sum::<f64>() > 0.5
    };
    let within = (0..pieces.len()).into_par_iter().map(is_within).collect::<Vec<_>>();
    if let Some(k) = (0..pieces.len()).find(|&k| pieces[k].is_cavity() && !within[k]) {
        return Err(refuse((surface.vertex(&pieces[k]), INSIDE_OUT)));
    }
    let alone = |k: usize| overlaps[k] || within[k];
    let mut solids: Vec<(usize, Vec<u32>)> = vec![];
    let mut place = vec![usize::MAX; pieces.len() + 1];
    for (k, piece) in pieces.iter().enumerate() {
        let own = if alone(owners[k]) { owners[k] } else { pieces.len() };
        if place[own] == usize::MAX {
            place[own] = solids.len();
            solids.push((own, vec![]));
        }
        solids[place[own]].1.extend(&piece.triangles);
    }
    let sorted = |(_, mut triangles): (usize, Vec<u32>)| {
        triangles.sort_unstable();
        triangles
    };
    Ok(solids.into_iter().map(sorted).collect())
}

type Boxed = GeomWithData<Rectangle<[f64; 3]>, usize>;

fn boxed(bounds: &Box3, data: usize) -> Boxed {
    Boxed::new(Rectangle::from_corners(bounds.low.into(), bounds.high.into()), data)
}

/// Pairs of pieces whose boxes overlap, ascending.
fn near_pairs(pieces: &[Piece]) -> Vec<[usize; 2]> {
    let tree =
        RTree::bulk_load(pieces.iter().enumerate().map(|(k, piece)| boxed(&piece.bounds, k)).collect());
    let candidates = tree.intersection_candidates_with_other_tree(&tree).map(|(a, b)| [a.data, b.data]);
    let overlap = |&[a, b]: &[usize; 2]| {
        let [own, other] = [&pieces[a].bounds, &pieces[b].bounds];
        let common = own.high.min(other.high) - own.low.max(other.low);
        let size = (own.high - own.low).max_element().max((other.high - other.low).max_element());
        a < b && common.min_element() > THIN * size
    };
    let mut pairs = candidates.filter(overlap).collect::<Vec<_>>();
    pairs.sort_unstable();
    pairs
}

fn lie(surface: &Surface<'_>, a: &Piece, b: &Piece) -> Result<Lie> {
    let (low, high) = (a.bounds.low.max(b.bounds.low), a.bounds.high.min(b.bounds.high));
    let common = Box3 { low, high };
    let around = |t: u32| Box3::around(surface.corners(t));
    let near = |piece: &Piece| {
        let own = piece.triangles.iter().copied();
        own.filter(|&t| around(t).meets(&common)).collect::<Vec<_>>()
    };
    let tree = RTree::bulk_load(near(b).into_iter().map(|t| boxed(&around(t), t as usize)).collect());
    let mut touching = None;
    for t in near(a) {
        let own = around(t);
        let corners = surface.triangles[t as usize];
        let mut crosses = false;
        for hit in tree.locate_in_envelope_intersecting(AABB::from_corners(own.low.into(), own.high.into())) {
            let other = surface.triangles[hit.data];
            if triangles_meet(surface.vertices, corners, other) {
                touching = touching.or(Some(corners[0]));
                crosses |= triangles_cross(surface.vertices, corners, other);
            }
        }
        if crosses {
            return Ok(Lie::Crossing(corners[0]));
        }
    }
    match touching {
        None => Ok(Lie::Apart),
        Some(v) if overlap(surface, a, b, v)? => Ok(Lie::Crossing(v)),
        Some(_) => Ok(Lie::Touching),
    }
}

/// Whether what two pieces that touch at a vertex enclose overlaps; for a solid one and a cavity neither may hold the other, too.
fn overlap(surface: &Surface<'_>, a: &Piece, b: &Piece, v: u32) -> Result<bool> {
    let turned = surface.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect::<Vec<_>>();
    let meshes = [a, b].map(|piece| {
        let triangles = if piece.is_cavity() { &turned[..] } else { surface.triangles };
        let mut mesh = MeshGL64 { num_prop: 3, run_index: vec![0], ..MeshGL64::default() };
        Surface { triangles, ..*surface }.add_run(&mut mesh, &piece.triangles, 0);
        mesh
    });
    let common = catch_unwind(AssertUnwindSafe(|| {
        let [a, b] = meshes.map(|mesh| Manifold::from_mesh_gl64(&mesh));
        a.boolean_with_engine(&b, OpType::Intersect, BooleanEngine::Exact).volume()
    }));
    let common = common.map_err(|_| {
        let reason = "the Boolean operation on pieces of one part that touch broke down";
        Error::JoinFailed { reason, at: surface.vertices[v as usize].into() }
    })?;
    let share = common / a.volume.abs().min(b.volume.abs());
    Ok(share > COMMON && (a.is_cavity() == b.is_cavity() || share < 1.0 - COMMON))
}
