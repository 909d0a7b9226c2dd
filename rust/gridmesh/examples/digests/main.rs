//! Digests of meshes and bodies, to be compared between platforms.
//!
//! Reads one drawing a line from standard input, `{"name": ..., "contours": [[[x, y], ...], ...]}`, and writes a line for each
//! kind of cells: the name, a digest of the patch (positions bit for bit, and faces), and one of its body.
//!
//! `cargo run --release --example digests < tests/peers/drawings.jsonl`

use std::error::Error;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{BufRead, stdin};

use glam::DVec2;
use gridmesh::options::CellShape;
use gridmesh::{InflateOptions, Patch, Progress, SketchOptions, Surface, inflate, mesh_sketch};
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
            let digests = mesh_sketch(outline, holes, &options, Progress::NONE).and_then(|sketch| {
                let body = inflate(&sketch.patch, &InflateOptions::default(), Progress::NONE)?;
                Ok((of_patch(&sketch.patch), of_body(&body)))
            });
            match digests {
                Ok((patch, body)) => println!("{name} {cells:?} {patch:016x} {body:016x}"),
                Err(error) => println!("{name} {cells:?} {error}"),
            }
        }
    }
    Ok(())
}

fn of_patch(patch: &Patch) -> u64 {
    let mut digest = DefaultHasher::new();
    patch.vertices.iter().for_each(|p| p.to_array().map(f64::to_bits).hash(&mut digest));
    (&patch.triangles, &patch.quads).hash(&mut digest);
    digest.finish()
}

fn of_body(body: &Surface) -> u64 {
    let mut digest = DefaultHasher::new();
    body.vertices.iter().for_each(|p| p.to_array().map(f64::to_bits).hash(&mut digest));
    (&body.triangles, &body.quads).hash(&mut digest);
    digest.finish()
}
