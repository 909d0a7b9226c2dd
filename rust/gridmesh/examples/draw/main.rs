//! Draws how a sketch becomes a mesh, as SVG files.
//!
//! ```text
//! cargo run -p gridmesh --release --features svg --example draw -- tests/sketches/drawings/frog.json
//! ```
//!
//! writes one file for each stage of figure 1 of the paper, by the paper's growth, by the optimum and on a bent lattice,
//! to `target/drawings`. Other words draw other pictures: see [`USAGE`]. Only the public API is used.

mod bent;
mod scene;
mod stages;

use std::error::Error;
use std::path::PathBuf;

use glam::DVec2;
use gridmesh::options::BoundaryMethod;
use gridmesh::svg::{Ink, Picture, page};

use crate::scene::Scene;
use crate::stages::stages;

const USAGE: &str = "usage: draw [stages | strip | compare | gallery] [options] FILE...
  stages       a picture for each stage of each file (if nothing else is said)
  strip        all stages of one file in one picture
  compare      the paper's growth beside the optimum, for each file
  gallery      each file meshed by the optimum
  FILE         a sketch: {\"points\": [[x, y], ...]} and, if it has any, \"holes\": [[[x, y], ...], ...]
  --triangles  triangles of the flat patch, 600 if not given
  --columns    panels in a row
  --output     the picture; for stages the folder, target/drawings if not given";

const LEGEND: [(Ink, &str); 13] = [
    (Ink::Drawing, "drawing"),
    (Ink::Target, "what steers the path"),
    (Ink::Seed, "seed"),
    (Ink::Band, "where the path may go"),
    (Ink::Added, "added"),
    (Ink::Path, "boundary"),
    (Ink::Mapped, "from lattice to drawing"),
    (Ink::Chord, "chord"),
    (Ink::Corner, "corner kept"),
    (Ink::Tip, "patch valence 2"),
    (Ink::Three, "patch valence 3"),
    (Ink::Five, "valence 5"),
    (Ink::Six, "valence 6"),
];

type Anything<T> = Result<T, Box<dyn Error>>;

fn main() -> Anything<()> {
    let Arguments { what, triangles, columns, output, files } = arguments()?;
    let drawings = files.iter().map(read).collect::<Anything<Vec<Drawing>>>()?;
    let mut panels = Vec::new();
    for drawing in &drawings {
        match what.as_str() {
            "gallery" => panels.push(result(drawing, triangles, BoundaryMethod::Optimal, 220.0, 0.5)?),
            "compare" => {
                panels.push(result(drawing, triangles, BoundaryMethod::Grown, 420.0, 0.75)?);
                panels.push(result(drawing, triangles, BoundaryMethod::Optimal, 420.0, 0.75)?);
            }
            "strip" => panels.extend(stages(drawing, triangles, 330.0)?.into_iter().map(|stage| stage.1)),
            _ => {
                for (stage, panel) in stages(drawing, triangles, 640.0)? {
                    write(&output.join(format!("{}-{stage}.svg", drawing.name)), &[panel], 1)?;
                }
            }
        }
    }
    if panels.is_empty() { Ok(()) } else { write(&output, &panels, columns) }
}

fn write(path: &PathBuf, panels: &[Picture], columns: usize) -> Anything<()> {
    let picture = page(panels, columns, &LEGEND);
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    std::fs::write(path, &picture)?;
    println!("{} ({} kB)", path.display(), picture.len() / 1000);
    Ok(())
}

struct Arguments {
    what: String,
    triangles: usize,
    columns: usize,
    output: PathBuf,
    files: Vec<PathBuf>,
}

fn arguments() -> Anything<Arguments> {
    let mut words = std::env::args().skip(1).peekable();
    let what = words.next_if(|word| ["stages", "strip", "compare", "gallery"].contains(&word.as_str()));
    let what = what.unwrap_or_else(|| "stages".to_owned());
    let columns = match what.as_str() {
        "compare" => 2,
        "strip" => 4,
        _ => 5,
    };
    let output =
        if what == "stages" { "target/drawings".into() } else { format!("target/{what}.svg").into() };
    let mut found = Arguments { what, triangles: 600, columns, output, files: Vec::new() };
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} needs a value\n{USAGE}"));
        match word.as_str() {
            "--triangles" => found.triangles = value()?.parse()?,
            "--columns" => found.columns = value()?.parse()?,
            "--output" => found.output = value()?.into(),
            word if word.starts_with('-') => return Err(format!("what is {word}?\n{USAGE}").into()),
            _ => found.files.push(word.into()),
        }
    }
    if found.files.is_empty() { Err(USAGE.into()) } else { Ok(found) }
}

struct Drawing {
    name: String,
    outline: Vec<DVec2>,
    holes: Vec<Vec<DVec2>>,
}

fn read(path: &PathBuf) -> Anything<Drawing> {
    let data: serde_json::Value = serde_json::from_slice(&std::fs::read(path)?)?;
    let points = |value: &serde_json::Value| -> Anything<Vec<DVec2>> {
        let pairs: Vec<[f64; 2]> = serde_json::from_value(value.clone())?;
        Ok(pairs.into_iter().map(DVec2::from_array).collect())
    };
    let holes = data["holes"].as_array().into_iter().flatten().map(points).collect::<Anything<_>>()?;
    let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Drawing { name, outline: points(&data["points"])?, holes })
}

fn result(
    drawing: &Drawing,
    triangles: usize,
    boundary: BoundaryMethod,
    size: f64,
    weight: f64,
) -> Anything<Picture> {
    let scene = Scene::new(drawing, triangles, boundary, size, weight)?;
    Ok(match boundary {
        _ if size < 300.0 => scene.placed(&drawing.name),
        BoundaryMethod::Grown => scene.placed("The paper's growth"),
        BoundaryMethod::Optimal => scene.placed("The optimum"),
    })
}
