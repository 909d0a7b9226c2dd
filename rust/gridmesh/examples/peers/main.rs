//! Meshers of the comparison in `tests/peers` that are written in Rust.
//!
//! Reads one request a line from standard input and answers each with one line:
//! `{"mesher": "spade", "contours": [[[x, y], ...], ...], "size": 0.1, "target": 2000, "mesh": true}`,
//! `size` being an edge length (a number of triangles for our own mesher). The answer holds the
//! processor seconds of the meshing alone, the number of triangles, and, if `mesh` was true, the mesh.

mod delaunay;
mod lattice;

use std::error::Error;
use std::io::{BufRead, Write, stdin, stdout};

use cpu_time::ProcessTime;
use glam::DVec2;
use gridmesh::options::{BoundaryMethod, SketchOptions};
use gridmesh::progress::Progress;
use gridmesh::sketch::mesh_sketch;
use serde_json::{Value, json};

/// What every mesher returns.
pub(crate) struct Mesh {
    pub(crate) vertices: Vec<[f64; 2]>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    for line in stdin().lock().lines() {
        let answer = match answer(&line?) {
            Ok(answer) => answer,
            Err(error) => json!({ "error": error.to_string() }),
        };
        println!("{answer}");
        stdout().flush()?;
    }
    Ok(())
}

fn answer(line: &str) -> Outcome<Value> {
    let request: Value = serde_json::from_str(line)?;
    let mesher = request["mesher"].as_str().ok_or("no mesher is named")?;
    let size = request["size"].as_f64().ok_or("no size is given")?;
    let target = request["target"].as_u64().ok_or("no number of triangles is given")? as usize;
    let contours: Vec<Vec<[f64; 2]>> = serde_json::from_value(request["contours"].clone())?;

    // Each mesher gets its points in its own type: converting them is not its work.
    let (mesh, seconds) = match mesher {
        "spade" => timed(&delaunay::input(&contours), |input| delaunay::refined(input, size, target))?,
        "lattice" => timed(&contours, |contours| lattice::mesh(contours, size))?,
        "optimal" => timed(&ours(&contours), |contours| sketch(contours, size, BoundaryMethod::Optimal))?,
        "grown" => timed(&ours(&contours), |contours| sketch(contours, size, BoundaryMethod::Grown))?,
        _ => return Err(format!("unknown mesher {mesher}").into()),
    };
    let mut answer = json!({ "seconds": seconds, "triangles": mesh.triangles.len() });
    if request["mesh"].as_bool() == Some(true) {
        answer["mesh"] = json!({ "vertices": mesh.vertices, "triangles": mesh.triangles });
    }
    Ok(answer)
}

fn timed<I>(input: &I, mesher: impl Fn(&I) -> Outcome<Mesh>) -> Outcome<(Mesh, f64)> {
    let start = ProcessTime::try_now()?;
    let mesh = mesher(input)?;
    Ok((mesh, start.try_elapsed()?.as_secs_f64()))
}

fn ours(contours: &[Vec<[f64; 2]>]) -> Vec<Vec<DVec2>> {
    contours.iter().map(|contour| contour.iter().map(|&p| DVec2::from_array(p)).collect()).collect()
}

/// Our own mesher at a fixed lattice angle, without a binding between.
fn sketch(contours: &[Vec<DVec2>], triangles: f64, boundary: BoundaryMethod) -> Outcome<Mesh> {
    let (outline, holes) = contours.split_first().ok_or("no contour")?;
    let triangles = Some(triangles.round() as usize);
    let options = SketchOptions { triangles, boundary, angle: Some(0.0), ..SketchOptions::default() };
    let patch = mesh_sketch(outline, holes, &options, Progress::NONE)?.patch;
    let vertices = patch.vertices.iter().map(DVec2::to_array).collect();
    Ok(Mesh { vertices, triangles: patch.triangles })
}
