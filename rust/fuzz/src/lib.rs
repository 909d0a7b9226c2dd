//! What each fuzz target does with its bytes: reads a case from them, runs it, and checks every promise that holds for any input.
//!
//! ```sh
//! cargo +nightly fuzz run --fuzz-dir rust/fuzz sketch     # bent, combine, cut, cutout, fill, join, picture, quads, regrid, several
//! ```
//!
//! The library's tests run the same functions on a fixed number of pseudorandom inputs (`rust/gridmesh/tests/fuzz.rs`); what
//! fuzzing found is kept there as named cases.

mod cases;
mod later;

use std::sync::atomic::{AtomicUsize, Ordering};

use gridmesh::body::inflate::{InflateOptions, inflate};
use gridmesh::cut::{CutOptions, Polygons};
use gridmesh::drawing::combine::{Combination, combine as combined};
use gridmesh::error::{Error, Result};
use gridmesh::fill::{FillOptions, fill_hole, fill_holes, regrid as regridded};
use gridmesh::geometry::metrics::check_mesh;
use gridmesh::progress::Progress;
use gridmesh::sketch::mesh_sketch;

use self::cases::Case;
pub use self::later::{bent, cutout, join, picture, quads, several};

/// Reports after which a case is given up: bounds its work.
const REPORTS: usize = 20_000;

/// Runs with a bound on the work. An internal error is a bug, whatever the input.
fn bounded<T>(work: impl FnOnce(Progress<'_>) -> Result<T>) -> Option<T> {
    let reports = AtomicUsize::new(0);
    let go_on = |_: f64| reports.fetch_add(1, Ordering::Relaxed) < REPORTS;
    match work(Progress::new(&go_on)) {
        Ok(done) => Some(done),
        Err(error) => {
            assert!(!matches!(error, Error::Internal { .. }), "{error}");
            None
        }
    }
}

/// Patches and bodies of random drawings.
pub fn sketch(data: &[u8]) {
    let mut case = Case::new(data);
    let (outline, holes, options) = (case.polygon(), case.holes(), case.sketch_options());
    let Some(sketch) = bounded(|progress| mesh_sketch(&outline, &holes, &options, progress)) else { return };
    let patch = &sketch.patch;
    let check = check_mesh(patch.vertices.len(), &patch.triangles);
    assert_eq!((check.bad_edges, check.bad_vertices, check.bad_triangles), (0, 0, 0));
    assert_eq!((check.components, check.boundaries), (1, patch.loops.len()));
    for &[a, b, c] in &patch.triangles {
        let [a, b, c] = [a, b, c].map(|v| patch.vertices[v as usize]);
        assert!((b - a).perp_dot(c - a) > 0.0, "an inverted triangle");
    }
    let Some(body) = bounded(|progress| inflate(patch, &InflateOptions::default(), progress)) else { return };
    assert!(body.report.watertight && body.vertices.iter().all(|p| p.is_finite()));
}

/// Fills of loops in random meshes.
pub fn fill(data: &[u8]) {
    let mut case = Case::new(data);
    let (vertices, triangles) = case.mesh();
    let options = FillOptions { smooth: case.smooth(), ..FillOptions::default() };
    let one = case.chance().then(|| case.numbers(vertices.len()));
    let filled = match one {
        Some(chosen) => bounded(|progress| fill_hole(&vertices, &triangles, &chosen, &options, progress))
            .map_or(Vec::new(), |fill| vec![fill]),
        None => bounded(|progress| fill_holes(&vertices, &triangles, None, &options, progress))
            .map_or(Vec::new(), |fills| fills.into_iter().flatten().collect()),
    };
    for fill in filled {
        let n = vertices.len() + fill.vertices.len();
        let check = check_mesh(n, &fill.triangles);
        assert_eq!((check.bad_edges, check.bad_vertices, check.bad_triangles), (0, 0, 0));
        assert_eq!((check.components, check.boundaries, check.boundary_edges), (1, 1, fill.loop_.len()));
        assert!(fill.vertices.iter().all(|p| p.is_finite()));
    }
}

/// Regions of random meshes meshed anew.
pub fn regrid(data: &[u8]) {
    let mut case = Case::new(data);
    let (vertices, triangles) = case.mesh();
    let faces = case.numbers(triangles.len());
    let options = FillOptions { smooth: case.smooth(), ..FillOptions::default() };
    let keep_shape = case.chance();
    let Some(done) =
        bounded(|progress| regridded(&vertices, &triangles, &faces, keep_shape, &options, progress))
    else {
        return;
    };
    let removed: Vec<bool> = (0..triangles.len()).map(|f| faces.contains(&(f as u32))).collect();
    let mut whole: Vec<[u32; 3]> =
        triangles.iter().zip(&removed).filter(|(_, gone)| !**gone).map(|(t, _)| *t).collect();
    let before = check_mesh(vertices.len(), &triangles);
    whole.extend(&done.fill.triangles);
    let after = check_mesh(vertices.len() + done.fill.vertices.len(), &whole);
    // Where more than two triangles meet in an edge of the region, those outside are left with open edges.
    assert!(before.bad_edges > 0 || before.boundary_edges == after.boundary_edges);
    assert!(after.bad_edges <= before.bad_edges && done.off.is_finite());
}

/// Cuts of random meshes.
pub fn cut(data: &[u8]) {
    let mut case = Case::new(data);
    let (vertices, triangles) = case.mesh();
    let corners: Vec<u32> = triangles.iter().flatten().copied().collect();
    let offsets: Vec<u32> = (0..=triangles.len() as u32).map(|f| 3 * f).collect();
    let faces = Polygons { corners: &corners, offsets: &offsets };
    let (stroke, options): (_, CutOptions) = (case.stroke(), case.cut_options());
    let Some(cut) = bounded(|progress| gridmesh::cut::cut(&vertices, faces, &stroke, &options, progress))
    else {
        return;
    };
    let was_closed = check_mesh(vertices.len(), &triangles).watertight;
    for piece in &cut.pieces {
        let n = piece.vertices.len();
        assert!(piece.corners.iter().all(|&v| (v as usize) < n));
        assert!(piece.source_vertices.iter().flatten().all(|&v| (v as usize) < vertices.len()));
        for (weights, point) in piece.source_weights.iter().zip(&piece.vertices) {
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-6 && point.is_finite());
        }
        if was_closed && options.cap && cut.report.uncapped == 0 {
            let mut edges: Vec<[u32; 2]> = Vec::new();
            for face in piece.offsets.windows(2) {
                let face = &piece.corners[face[0] as usize..face[1] as usize];
                edges.extend(face.iter().zip(face.iter().cycle().skip(1)).map(|(&a, &b)| [a, b]));
            }
            edges.sort_unstable();
            assert!(edges.windows(2).all(|w| w[0] != w[1]), "two faces run along an edge the same way");
            assert!(edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok()), "an open edge");
        }
    }
}

/// Drawings joined and cut from each other.
pub fn combine(data: &[u8]) {
    let mut case = Case::new(data);
    let (outline, holes, other) = (case.polygon(), case.holes(), case.polygon());
    let how = if case.chance() { Combination::Union } else { Combination::Difference };
    let Ok(parts) = combined(&outline, &holes, &other, how) else { return };
    for part in parts {
        assert!(part.outline.len() >= 3 && part.outline.iter().all(|p| p.is_finite()));
        assert!(part.holes.iter().flatten().all(|p| p.is_finite()));
    }
}
