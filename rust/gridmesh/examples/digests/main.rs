//! Digests of meshes and bodies, and of what is made of them, to be compared between systems and processors.
//!
//! Reads one drawing a line from standard input, `{"name": ..., "contours": [[[x, y], ...], ...]}`, and writes a line for each
//! kind of cells: the name, and digests (positions bit for bit, and faces) of the patch, its body, the body filled where a part
//! of it was taken away, cut in two, and joined with a copy beside it; `-` for what is refused.
//!
//! `cargo run --release --example digests < tests/peers/drawings.jsonl`

use std::error::Error;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{BufRead, stdin};

use glam::{DVec2, DVec3};
use gridmesh::cut::{Polygons, Sweep};
use gridmesh::join::Part;
use gridmesh::options::CellShape;
use gridmesh::{
    CutOptions, FillOptions, InflateOptions, JoinOptions, Progress, SketchOptions, Surface, cut, fill_holes,
    inflate, join, mesh_sketch,
};
use serde_json::Value;

fn main() -> Result<(), Box<dyn Error>> {
    for line in stdin().lock().lines() {
        let drawing: Value = serde_json::from_str(&line?)?;
        let name = drawing["name"].as_str().ok_or("a drawing has no name")?;
        let contours: Vec<Vec<[f64; 2]>> = serde_json::from_value(drawing["contours"].clone())?;
        let contours: Vec<Vec<DVec2>> =
            contours.into_iter().map(|contour| contour.into_iter().map(DVec2::from).collect()).collect();
        let (outline, holes) = contours.split_first().ok_or("a drawing has no outline")?;
        for cells in [CellShape::Triangle, CellShape::Quad] {
            let options = SketchOptions { cells, triangles: Some(2000), ..SketchOptions::default() };
            match mesh_sketch(outline, holes, &options, Progress::NONE) {
                Ok(sketch) => {
                    let patch = sketch.patch;
                    let flat: Vec<DVec3> = patch.vertices.iter().map(|p| p.extend(0.0)).collect();
                    let mut found = vec![Ok(digest(&flat, (&patch.triangles, &patch.quads)))];
                    match inflate(&patch, &InflateOptions::default(), Progress::NONE) {
                        Ok(body) => {
                            found.push(Ok(digest(&body.vertices, (&body.triangles, &body.quads))));
                            found.extend([filled(&body), halves(&body), joined(&body)]);
                        }
                        Err(error) => found.push(Err(error)),
                    }
                    let texts = found.into_iter().map(|d| d.map_or("-".into(), |d| format!("{d:016x}")));
                    println!("{name} {cells:?} {}", texts.collect::<Vec<_>>().join(" "));
                }
                Err(error) => println!("{name} {cells:?} {error}"),
            }
        }
    }
    Ok(())
}

fn digest(vertices: &[DVec3], faces: impl Hash) -> u64 {
    let mut digest = DefaultHasher::new();
    vertices.iter().for_each(|p| p.to_array().map(f64::to_bits).hash(&mut digest));
    faces.hash(&mut digest);
    digest.finish()
}

/// Of patches in place of every seventh part of the faces.
fn filled(body: &Surface) -> gridmesh::error::Result<u64> {
    let quads = body.quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let triangles: Vec<[u32; 3]> = body.triangles.iter().copied().chain(quads).collect();
    let open = &triangles[triangles.len() / 7..];
    let options = FillOptions::default();
    let fills = fill_holes(&body.vertices, open, None, &options, Progress::NONE)?;
    let digests = fills.into_iter().flatten().map(|fill| digest(&fill.vertices, fill.triangles));
    Ok(digest(&[], digests.collect::<Vec<_>>()))
}

/// Of the pieces that a stroke through the middle leaves.
fn halves(body: &Surface) -> gridmesh::error::Result<u64> {
    let (low, high) = bounds(body);
    let middle = 0.5 * (low + high);
    let stroke = [-1.0, -0.1, 0.2, 1.0].map(|t| middle + t * (high - low) * DVec3::new(1.0, 0.3 * t, 0.0));
    let (corners, offsets) = polygons(body);
    let faces = Polygons { corners: &corners, offsets: &offsets };
    let cut = cut(&body.vertices, faces, &stroke, &CutOptions::new(Sweep::Along(DVec3::Z)), Progress::NONE)?;
    let digests = cut.pieces.iter().map(|piece| digest(&piece.vertices, (&piece.corners, &piece.offsets)));
    Ok(digest(&[], digests.collect::<Vec<_>>()))
}

/// Of the body joined with a copy that is moved by a third of its size.
fn joined(body: &Surface) -> gridmesh::error::Result<u64> {
    let (low, high) = bounds(body);
    let moved: Vec<DVec3> = body.vertices.iter().map(|p| *p + (high - low) / 3.0).collect();
    let (corners, offsets) = polygons(body);
    let parts = [&body.vertices, &moved]
        .map(|vertices| Part { vertices, faces: Polygons { corners: &corners, offsets: &offsets } });
    let joined = join(&parts, &JoinOptions::default(), Progress::NONE)?;
    Ok(digest(&joined.vertices, (joined.corners, joined.offsets)))
}

fn bounds(body: &Surface) -> (DVec3, DVec3) {
    let at = body.vertices.iter().copied();
    at.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

fn polygons(body: &Surface) -> (Vec<u32>, Vec<u32>) {
    let corners = body.triangles.as_flattened().iter().chain(body.quads.as_flattened()).copied().collect();
    let ends = |count: usize, n: usize, from: usize| (1..=count).map(move |k| (from + k * n) as u32);
    let triangles = ends(body.triangles.len(), 3, 0);
    let quads = ends(body.quads.len(), 4, 3 * body.triangles.len());
    (corners, [0].into_iter().chain(triangles).chain(quads).collect())
}
