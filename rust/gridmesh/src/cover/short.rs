//! Ends of short edges moved apart.

use std::collections::BTreeSet;

use glam::DVec2;

use crate::patch::Patch;

/// Edges shorter than this, in mean lengths of the patch's edges, are made longer: a third shows in a texture.
const SHORT: f64 = 0.36;

/// How often all short edges are gone through.
const PASSES: usize = 3;

/// Corners of faces may become as small as this (15 degrees) for a longer edge, or stay as small as they are.
const THINNEST: f64 = 0.26;

/// Directions of moves, in radians from straight away.
const ASIDE: [f64; 5] = [0.0, 0.6, -0.6, 1.2, -1.2];

/// Steps of a move that is too large, each half as long as the one before.
const HALVINGS: usize = 3;

/// Moves the ends of short edges apart where no face suffers, interior ones rather than those of the boundary.
///
/// `may` decides about moves of boundary vertices, after they were made.
pub(super) fn lengthened(patch: &mut Patch, mut may: impl FnMut(&Patch, usize) -> bool) {
    let n_boundary = patch.n_boundary();
    let edges: Vec<[usize; 2]> = sides(patch).collect::<BTreeSet<_>>().into_iter().collect();
    let length = |patch: &Patch, [a, b]: [usize; 2]| patch.vertices[a].distance(patch.vertices[b]);
    let mean = edges.iter().map(|&edge| length(patch, edge)).sum::<f64>() / edges.len().max(1) as f64;
    let wanted = SHORT * mean;
    for _ in 0..PASSES {
        let short: Vec<[usize; 2]> =
            edges.iter().copied().filter(|&edge| length(patch, edge) < wanted).collect();
        if short.is_empty() {
            break;
        }
        for edge in short {
            let mut ends = [edge, [edge[1], edge[0]]];
            ends.sort_by_key(|&[moved, _]| moved < n_boundary);
            for [moved, other] in ends {
                let missing = 1.01 * wanted - length(patch, edge);
                if missing <= 0.0 {
                    break;
                }
                let before = patch.vertices[moved];
                let away = (before - patch.vertices[other]).normalize_or(DVec2::X);
                let (thinnest, shortest) = around(patch, moved);
                let moves = (0..HALVINGS).flat_map(|step| {
                    let far = missing * 0.5f64.powi(step as i32);
                    ASIDE.map(|turn| far * DVec2::from_angle(turn).rotate(away))
                });
                for by in moves {
                    patch.vertices[moved] = before + by;
                    let (thin, short) = around(patch, moved);
                    let is_sound = thin >= thinnest.min(THINNEST) && short >= shortest.min(wanted);
                    let is_longer = patch.vertices[moved].distance(patch.vertices[other])
                        > before.distance(patch.vertices[other]);
                    if is_sound && is_longer && (moved >= n_boundary || may(patch, moved)) {
                        break;
                    }
                    patch.vertices[moved] = before;
                }
            }
        }
    }
}

/// Least corner (radians; below 0 if one is inverted or concave) of the faces at a vertex, and their shortest side at it.
pub(super) fn around(patch: &Patch, vertex: usize) -> (f64, f64) {
    let (mut thinnest, mut shortest) = (f64::INFINITY, f64::INFINITY);
    for face in faces(patch).filter(|face| face.contains(&(vertex as u32))) {
        let n = face.len();
        let place = |k: usize| patch.vertices[face[k % n] as usize];
        for (k, &corner) in face.iter().enumerate() {
            let (ahead, back) = (place(k + 1) - place(k), place(k + n - 1) - place(k));
            thinnest = thinnest.min(ahead.angle_to(back));
            if corner as usize == vertex {
                shortest = shortest.min(ahead.length()).min(back.length());
            }
        }
    }
    (thinnest, shortest)
}

/// Mean length of the sides of all faces.
pub(super) fn mean_side(patch: &Patch) -> f64 {
    let (mut sum, mut count) = (0.0, 0usize);
    for [a, b] in sides(patch) {
        sum += patch.vertices[a].distance(patch.vertices[b]);
        count += 1;
    }
    sum / count.max(1) as f64
}

fn faces(patch: &Patch) -> impl Iterator<Item = &[u32]> {
    patch.triangles.iter().map(|t| &t[..]).chain(patch.quads.iter().map(|q| &q[..]))
}

/// The sides of all faces, the smaller vertex first.
fn sides(patch: &Patch) -> impl Iterator<Item = [usize; 2]> + '_ {
    faces(patch).flat_map(|face| {
        (0..face.len()).map(|k| {
            let (a, b) = (face[k] as usize, face[(k + 1) % face.len()] as usize);
            [a.min(b), a.max(b)]
        })
    })
}
