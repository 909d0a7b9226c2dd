//! Targets for joined bodies, holes with several loops, quads, bent lattices, pictures and their meshes.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};
use gridmesh::body::inflate::InflateOptions;
use gridmesh::body::surface::Surface;
use gridmesh::cut::Polygons;
use gridmesh::cutout::{CutoutOptions, CutoutRim, mesh_cutout};
use gridmesh::drawing::combine;
use gridmesh::error::Error;
use gridmesh::fill::{
    BridgeOptions, Fill, FillOptions, Pair, bridge, bridge_pairs, fill_hole, fill_loops, look_apart,
};
use gridmesh::geometry::metrics::check_mesh;
use gridmesh::join::{JoinOptions, Part, join as joined};
use gridmesh::options::{CellShape, Density};
use gridmesh::picture::decode::decode_image;
use gridmesh::picture::{Picture, TraceOptions, trace_image};
use gridmesh::sketch::mesh_sketch;

use super::bounded;
use super::cases::Case;

/// The edges of faces that have a face on one side alone; no two faces may run along an edge the same way.
fn open_edges<'a>(faces: impl Iterator<Item = &'a [u32]>) -> usize {
    let mut edges = BTreeSet::new();
    for face in faces {
        for (&a, &b) in face.iter().zip(face.iter().cycle().skip(1)) {
            assert!(a != b, "a face repeats a vertex");
            assert!(edges.insert([a, b]), "two faces run along an edge the same way");
        }
    }
    edges.iter().filter(|&&[a, b]| !edges.contains(&[b, a])).count()
}

/// The boundary loops of triangles, as their holes run; none where more than two open edges meet in a vertex.
fn loops(triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let edges: BTreeSet<[u32; 2]> =
        triangles.iter().flat_map(|t| [0, 1, 2].map(|k| [t[k], t[(k + 1) % 3]])).collect();
    let mut next: BTreeMap<u32, u32> = BTreeMap::new();
    for &[a, b] in edges.iter().filter(|&&[a, b]| !edges.contains(&[b, a])) {
        if next.insert(b, a).is_some() {
            return Vec::new();
        }
    }
    let mut found = Vec::new();
    while let Some((&first, _)) = next.iter().next() {
        let (mut ring, mut at) = (Vec::new(), first);
        while let Some(after) = next.remove(&at) {
            ring.push(at);
            at = after;
        }
        if at != first {
            return Vec::new();
        }
        found.push(ring);
    }
    found
}

/// Patches on bent lattices, of triangles and quads, with sizes wished for.
pub fn bent(data: &[u8]) {
    let mut case = Case::new(data);
    let (outline, holes, mut options) = (case.polygon(), case.holes(), case.sketch_options());
    options.least = false;
    options.angle = None;
    options.bend = case.share();
    options.cells = if case.chance() { CellShape::Quad } else { CellShape::Triangle };
    options.density = match case.below(3) {
        0 => None,
        1 => Some(Density::Width(case.share())),
        _ => Some(Density::PerPoint(vec![outline.iter().map(|_| 0.5 + 4.0 * case.share()).collect()])),
    };
    let Some(sketch) = bounded(|progress| mesh_sketch(&outline, &holes, &options, progress)) else { return };
    let patch = &sketch.patch;
    assert!(patch.vertices.iter().all(|p| p.is_finite()));
    let rims: usize = patch.loops.iter().map(|l| l.source.len()).sum();
    let open = match options.cells {
        CellShape::Triangle => open_edges(patch.triangles.iter().map(|t| &t[..])),
        CellShape::Quad => open_edges(patch.quads.iter().map(|q| &q[..])),
    };
    assert_eq!(open, rims);
    if options.cells == CellShape::Triangle {
        let check = check_mesh(patch.vertices.len(), &patch.triangles);
        assert_eq!((check.bad_edges, check.bad_vertices, check.components), (0, 0, 1));
    }
}

/// Promises of a fill of loops with so many edges together.
fn filled(fill: &Fill, loops: usize, edges: usize) {
    assert!(fill.vertices.iter().all(|p| p.is_finite()));
    let faces = fill.triangles.iter().map(|t| &t[..]).chain(fill.quads.iter().map(|q| &q[..]));
    assert_eq!(open_edges(faces), edges);
    if fill.quads.is_empty() {
        let n = 1 + fill.triangles.iter().flatten().max().map_or(0, |&v| v as usize);
        let check = check_mesh(n, &fill.triangles);
        assert_eq!((check.bad_edges, check.bad_vertices, check.bad_triangles), (0, 0, 0));
        assert_eq!((check.components, check.boundaries, check.genus), (1, loops, 0));
    } else {
        assert_eq!(fill.triangles.len(), edges % 2);
    }
}

fn cells(case: &mut Case<'_>) -> CellShape {
    if case.chance() { CellShape::Quad } else { CellShape::Triangle }
}

/// Tubes between loops, and patches of several.
pub fn several(data: &[u8]) {
    let mut case = Case::new(data);
    let (vertices, triangles) = case.mesh();
    let mut found = loops(&triangles);
    found.truncate(2 + case.below(4));
    let edges = found.iter().map(Vec::len).sum();
    let smooth = case.smooth();
    if case.chance() {
        let options = BridgeOptions {
            smooth,
            rows: case.chance().then(|| case.below(12)),
            twist: case.share(),
            cells: cells(&mut case),
            ..BridgeOptions::default()
        };
        let [one, other] = &found[..] else {
            in_pairs(&vertices, &triangles, &found, &options);
            return;
        };
        let made = bounded(|progress| bridge(&vertices, &triangles, one, other, &options, progress));
        if let Some(fill) = made {
            filled(&fill, 2, edges);
        }
        return;
    }
    let options = FillOptions { smooth, cells: cells(&mut case), ..FillOptions::default() };
    if let Some(fill) = bounded(|progress| fill_loops(&vertices, &triangles, &found, &options, progress)) {
        filled(&fill, found.len(), edges);
    }
}

/// Tubes between pairs of loops.
fn in_pairs(vertices: &[DVec3], triangles: &[[u32; 3]], loops: &[Vec<u32>], options: &BridgeOptions) {
    let apart = look_apart(vertices, triangles, loops);
    let pairs = bounded(|progress| bridge_pairs(vertices, triangles, loops, options, progress));
    let Some(pairs) = pairs else { return };
    assert!(apart.is_ok(), "loops that are joined are no loops");
    assert_eq!(pairs.len(), loops.len() / 2);
    for Pair { loops: [one, other], tube } in pairs {
        if let Ok(fill) = tube {
            filled(&fill, 2, loops[one].len() + loops[other].len());
        }
    }
}

/// Fills with quads.
pub fn quads(data: &[u8]) {
    let mut case = Case::new(data);
    let (vertices, triangles) = case.mesh();
    let polygons = if case.chance() { (0..triangles.len() as u32).map(|t| t / 2).collect() } else { vec![] };
    let options = FillOptions {
        cells: CellShape::Quad,
        smooth: case.smooth(),
        polygons,
        sharp: case.chance().then(|| case.share()),
        ..FillOptions::default()
    };
    for ring in loops(&triangles).iter().take(3) {
        let made = bounded(|progress| fill_hole(&vertices, &triangles, ring, &options, progress));
        let Some(fill) = made else { continue };
        filled(&fill, 1, ring.len());
        assert_eq!(fill.triangles.len(), ring.len() % 2, "quads alone, or one triangle beside them");
    }
}

/// Closed meshes joined.
pub fn join(data: &[u8]) {
    let mut case = Case::new(data);
    let n = 2 + case.below(2);
    let meshes: Vec<_> = (0..n).map(|_| case.closed()).collect();
    let numbers: Vec<(Vec<u32>, Vec<u32>)> = meshes
        .iter()
        .map(|(_, triangles)| {
            let offsets = (0..=triangles.len() as u32).map(|f| 3 * f).collect();
            (triangles.iter().flatten().copied().collect(), offsets)
        })
        .collect();
    let parts: Vec<Part<'_>> = meshes
        .iter()
        .zip(&numbers)
        .map(|((vertices, _), (corners, offsets))| Part { vertices, faces: Polygons { corners, offsets } })
        .collect();
    let options = JoinOptions { blend: case.share(), ..JoinOptions::default() };
    let Some(made) = bounded(|progress| joined(&parts, &options, progress)) else { return };
    assert!(made.vertices.iter().all(|p| p.is_finite()));
    let faces = (0..made.offsets.len().saturating_sub(1)).map(|f| made.face(f));
    assert_eq!(open_edges(faces), 0);
    assert!(made.corners.iter().all(|&v| (v as usize) < made.vertices.len()));
}

/// Files of pictures, and outlines of small pictures.
pub fn picture(data: &[u8]) {
    if let Ok(decoded) = decode_image(data) {
        assert_eq!(decoded.pixels.len(), 4 * decoded.width * decoded.height);
    }
    let mut case = Case::new(data);
    let (width, height) = (1 + case.below(40), 1 + case.below(40));
    let values = (0..width * height).map(|_| case.share() as f32).collect();
    let Ok(picture) = Picture::new(width, height, values) else { return };
    let options =
        TraceOptions { smooth: 4.0 * case.share(), min_area: 8.0 * case.share(), ..TraceOptions::default() };
    let Some(traced) = bounded(|progress| trace_image(&picture, &options, progress)) else { return };
    for part in traced.parts {
        assert!(part.outline.len() >= 3 && part.outline.iter().all(|p| p.is_finite()));
        assert!(part.holes.iter().flatten().all(|p| p.is_finite()));
    }
}

/// Meshes of all parts of small pictures, and of drawings.
pub fn cutout(data: &[u8]) {
    let mut case = Case::new(data);
    let parts = if case.chance() { traced(&mut case) } else { drawn(&mut case) };
    let rim = match case.below(3) {
        0 => CutoutRim::On,
        1 => CutoutRim::Across,
        _ => CutoutRim::Around { margin: 0.1 + 2.0 * case.share() },
    };
    let options = CutoutOptions {
        number: 1 + case.below(120),
        cells: cells(&mut case),
        rim,
        faint: 1.0 + case.share(),
        body: case.chance().then(InflateOptions::default),
        most: 1.0 + 8.0 * case.share(),
    };
    let Some(made) = bounded(|progress| mesh_cutout(&parts, &options, progress)) else { return };
    assert_eq!(made.surfaces.len(), parts.len());
    for (surface, part) in made.surfaces.iter().zip(&parts) {
        match surface {
            Ok(surface) => shown(surface, part, &options),
            Err(error) => assert!(!matches!(error, Error::Internal { .. }), "{error}"),
        }
    }
}

/// Promises of the mesh of a part.
fn shown(surface: &Surface, part: &combine::Part, options: &CutoutOptions) {
    let n = surface.vertices.len();
    assert!(surface.vertices.iter().all(|p| p.is_finite()) && surface.uv.iter().all(|p| p.is_finite()));
    let is_quads = options.cells == CellShape::Quad;
    assert_eq!((surface.triangles.is_empty(), surface.quads.is_empty()), (is_quads, !is_quads));
    let faces = || surface.triangles.iter().map(|t| &t[..]).chain(surface.quads.iter().map(|q| &q[..]));
    assert!(faces().flatten().all(|&v| (v as usize) < n));
    let rims: usize = surface.silhouette.iter().map(Vec::len).sum();
    assert_eq!(open_edges(faces()), if options.body.is_some() { 0 } else { rims });
    let halves: Vec<[u32; 3]> =
        faces().flat_map(|face| (2..face.len()).map(|k| [face[0], face[k - 1], face[k]])).collect();
    let check = check_mesh(n, &halves);
    assert_eq!((check.bad_edges, check.bad_vertices, check.bad_triangles), (0, 0, 0));
    assert_eq!(check.components, 1);
    if options.body.is_some() {
        assert!(check.watertight && surface.report.watertight && surface.report.volume > 0.0);
    } else {
        assert_eq!(check.boundaries, surface.silhouette.len());
        for t in surface.triangles.iter() {
            let [a, b, c] = t.map(|v| surface.vertices[v as usize].truncate());
            assert!((b - a).perp_dot(c - a) > 0.0, "an inverted triangle");
        }
    }
    if options.rim == CutoutRim::On {
        assert_eq!(surface.silhouette.len(), 1 + part.holes.len());
        let size = part.outline.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        for &v in surface.silhouette.iter().flatten() {
            let point = surface.vertices[v as usize].truncate();
            let away = part.holes.iter().chain([&part.outline]).map(|ring| distance(ring, point));
            assert!(away.fold(f64::INFINITY, f64::min) <= 1e-9 * size, "a rim beside the outline");
        }
    }
}

/// How far a point is from a ring.
fn distance(ring: &[DVec2], point: DVec2) -> f64 {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    let away = edges.map(|(&a, &b)| {
        let length = (b - a).length_squared();
        let t = if length > 0.0 { ((point - a).dot(b - a) / length).clamp(0.0, 1.0) } else { 0.0 };
        point.distance(a + t * (b - a))
    });
    away.fold(f64::INFINITY, f64::min)
}

/// The parts of a picture of few pixels, in which these are often alike.
fn traced(case: &mut Case<'_>) -> Vec<combine::Part> {
    let (width, height) = (1 + case.below(24), 1 + case.below(24));
    let blocks: Vec<f64> = (0..64).map(|_| (2.0 * case.share() - 0.5).clamp(0.0, 1.0)).collect();
    let values = (0..width * height).map(|k| blocks[8 * (k / width / 3) + k % width / 3] as f32).collect();
    let Ok(picture) = Picture::new(width, height, values) else { return Vec::new() };
    let options = TraceOptions { min_area: 4.0, margin: 2.0 * case.share(), ..TraceOptions::default() };
    bounded(|progress| trace_image(&picture, &options, progress)).map_or(Vec::new(), |traced| traced.parts)
}

/// A few drawings, which may meet each other or be empty.
fn drawn(case: &mut Case<'_>) -> Vec<combine::Part> {
    let n = case.below(4);
    let scale = if case.chance() { 1.0 } else { 16.0 };
    let mut part = |k: usize| {
        let shift = DVec2::new(6.0 * k as f64, 0.0);
        let moved = |ring: Vec<DVec2>| ring.iter().map(|&p| scale * (p + shift)).collect();
        combine::Part { outline: moved(case.polygon()), holes: case.holes().into_iter().map(moved).collect() }
    };
    (0..n).map(&mut part).collect()
}
