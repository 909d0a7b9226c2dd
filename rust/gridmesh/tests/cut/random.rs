//! Random closed meshes, strokes and options. `GRIDMESH_CASES` says how many, `GRIDMESH_SEED` (0 to 255) which; with
//! `--nocapture` the outcome is counted and the slowest are named, in seconds of processor time.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::{DMat3, DVec3};
use gridmesh::cut::{Cut, CutOptions, Keep, Polygons, Sweep};
use gridmesh::fill::Smooth;
use gridmesh::geometry::metrics::check_mesh;
use gridmesh::options::CellShape;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

use crate::models::*;

/// What makes a case.
#[derive(Clone, Debug)]
struct Case {
    model: usize,
    detail: u32,
    turn: [f64; 3],
    scale: [f64; 3],
    stroke: usize,
    points: u32,
    place: [f64; 4],
    jitter: f64,
    sweep: usize,
    length: Option<f64>,
    gap: bool,
    smooth: usize,
    quads: bool,
    keep: usize,
    extend: bool,
}

fn cases() -> impl Strategy<Value = Case> {
    let unit = -1.0..1.0f64;
    let shape = (0..6usize, 4..24u32, [0.0..TAU, 0.0..TAU, 0.0..TAU], 0..8usize);
    let stroke = (0..5usize, 2..60u32, [unit.clone(), unit.clone(), unit.clone(), unit], 0..4usize);
    let faces = (0..5usize, any::<bool>());
    let options = (0..3usize, 0..4usize, 0..6usize, faces, 0..4usize, any::<bool>());
    (shape, stroke, options).prop_map(
        |((model, detail, turn, thin), (stroke, points, place, rough), options)| {
            let (sweep, length, gap, (smooth, quads), keep, extend) = options;
            Case {
                model,
                detail,
                turn,
                scale: [1.0, 1.0, [1.0, 1.0, 1.0, 1.0, 0.5, 0.1, 0.02, 1e-4][thin]],
                stroke,
                points,
                place,
                jitter: [0.0, 0.0, 1e-4, 1e-3][rough],
                sweep,
                length: [None, Some(0.1), Some(0.25), Some(0.8)][length],
                gap: gap == 0,
                smooth,
                quads,
                keep,
                extend,
            }
        },
    )
}

impl Case {
    fn mesh(&self) -> Mesh {
        let mut mesh = match self.model {
            0 => cube(),
            1 => prism(),
            2 => torus(self.detail + 4, self.detail / 2 + 3),
            3 => ball(self.detail),
            4 => {
                // Two parts.
                let (mut one, other) = (ball(self.detail), cube());
                let n = one.0.len() as u32;
                one.0.extend(other.0.iter().map(|p| *p + DVec3::new(1.6, 0.1, 0.0)));
                let from = one.1.len() as u32;
                one.1.extend(other.1.iter().map(|v| v + n));
                one.2.extend(other.2[1..].iter().map(|o| o + from));
                one
            }
            _ => boxes(self.detail),
        };
        let [x, y, z] = self.turn;
        let turn = DMat3::from_rotation_x(x) * DMat3::from_rotation_y(y) * DMat3::from_rotation_z(z);
        mesh.0.iter_mut().for_each(|p| *p = turn * (*p * DVec3::from_array(self.scale)));
        mesh
    }

    fn stroke(&self) -> Vec<DVec3> {
        let [x, y, slope, size] = self.place;
        let n = self.points.max(2);
        let noise = |k: u32| self.jitter * (f64::from(k * k % 17) / 17.0 - 0.5);
        let reach = [0.4, 3.5][usize::from(self.extend)];
        let at = |k: u32, y: &dyn Fn(f64) -> f64| {
            let t = reach * (2.0 * f64::from(k) / f64::from(n - 1) - 1.0);
            DVec3::new(x + t, 0.6 * self.place[1] + slope * t + y(t) + noise(k), 0.0)
        };
        match self.stroke {
            0 => vec![at(0, &|_| 0.0), at(n - 1, &|_| 0.0)],
            1 => (0..n).map(|k| at(k, &|t| 0.3 * (4.0 * t).sin())).collect(),
            2 => (0..n).map(|k| at(k, &|_| if k % 2 == 0 { 0.1 } else { -0.1 })).collect(),
            3 => (0..n).map(|k| at(k, &|_| 0.0)).collect(),
            _ => circle(x, y, 0.1 + 0.8 * size.abs(), n.max(3)),
        }
    }

    fn options(&self) -> CutOptions {
        let sweep = match self.sweep {
            0 => Sweep::Along(-DVec3::Z),
            1 => Sweep::Along(DVec3::new(0.2, -0.1, -1.0)),
            _ => Sweep::Through(DVec3::new(0.3, 0.2, 9.0)),
        };
        CutOptions {
            edge_length: self.length,
            gap: if self.gap { 0.03 } else { 0.0 },
            smooth: [Smooth::Flat, Smooth::Flat, Smooth::Flat, Smooth::Tangent, Smooth::Curvature]
                [self.smooth],
            keep: [Keep::Both, Keep::Both, Keep::Left, Keep::Right][self.keep],
            extend_ends: self.extend,
            cells: if self.quads { CellShape::Quad } else { CellShape::Triangle },
            ..CutOptions::new(sweep)
        }
    }
}

/// Boxes of different heights side by side on a common bottom plate: a comb.
fn boxes(teeth: u32) -> Mesh {
    let n = teeth % 5 + 2;
    let (mut vertices, mut quads) = (vec![], vec![]);
    // The outline of the comb, extruded.
    let mut outline = vec![DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, -1.0, 0.0)];
    for k in (0..n).rev() {
        let (low, high) =
            (-1.0 + 2.0 * f64::from(k) / f64::from(n), -1.0 + 2.0 * (f64::from(k) + 0.6) / f64::from(n));
        let top = 0.4 + 0.1 * f64::from(k % 3);
        outline.push(DVec3::new(if k == n - 1 { 1.0 } else { high }, top, 0.0));
        outline.push(DVec3::new(low, top, 0.0));
        if k > 0 {
            outline.push(DVec3::new(low, -0.5, 0.0));
            outline.push(DVec3::new(low - 0.8 / f64::from(n), -0.5, 0.0));
        }
    }
    let m = outline.len() as u32;
    for z in [-0.4, 0.4] {
        vertices.extend(outline.iter().map(|p| *p + DVec3::new(0.0, 0.0, z)));
    }
    for k in 0..m {
        quads.push([k, (k + 1) % m, (k + 1) % m + m, k + m]);
    }
    let mut corners = quads.concat();
    let mut offsets: Vec<u32> = (0..=m).map(|k| 4 * k).collect();
    corners.extend((0..m).rev());
    offsets.push(corners.len() as u32);
    corners.extend(m..2 * m);
    offsets.push(corners.len() as u32);
    Mesh(vertices, corners, offsets)
}

/// What a case breaks, if anything.
fn wrong(case: &Case, mesh: &Mesh, cut: &Cut) -> Option<String> {
    for piece in &cut.pieces {
        if let Some(edge) = open_edge(piece) {
            return Some(format!("{:?} is not closed at the edge {edge:?}", piece.side));
        }
        let check = check_mesh(piece.vertices.len(), &triangles(piece));
        if !(case.quads || check.watertight) {
            return Some(format!("{:?} is not closed: {check:?}", piece.side));
        }
        if piece.source_vertices.iter().flatten().any(|&v| v as usize >= mesh.0.len())
            || piece.source_weights.iter().any(|w| (w.iter().sum::<f64>() - 1.0).abs() > 1e-9)
        {
            return Some("sources".into());
        }
    }
    if let Some(reason) = wrong_caps(case, cut) {
        return Some(reason);
    }
    let report = &cut.report;
    let size = mesh.0.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let scale = report.volume.abs();
    if case.keep < 2 && !case.gap {
        let sum: f64 = report.volumes.iter().sum();
        let allowed = match case.length {
            None => 1e-6 * scale + 1e-12 * size.powi(3),
            Some(length) => 0.05 * scale + 0.05 * length * length * size,
        };
        if (sum - report.volume).abs() > allowed {
            return Some(format!("volumes {sum} {}", report.volume));
        }
        let [left, right] = &cut.pieces[..] else { return Some("pieces".into()) };
        if caps(left, false) != caps(right, true) {
            return Some("caps differ".into());
        }
    }
    let dust = 1e-3 * scale + 1e-12 * size.powi(3);
    if report.folded == 0 && report.uncapped == 0 && report.volumes.iter().any(|&v| v < -dust) {
        return Some(format!("volumes {:?}", report.volumes));
    }
    // Old vertices have their bits, and an exact cut leaves the faces that it does not meet.
    for piece in &cut.pieces {
        let faces = Polygons { corners: &piece.corners, offsets: &piece.offsets };
        for f in (0..faces.len()).filter(|&f| piece.source_face[f] >= 0) {
            let moved = faces.face(f).iter().find(|&&v| {
                let (from, weights) = (piece.source_vertices[v as usize], piece.source_weights[v as usize]);
                weights[0] == 1.0 && piece.vertices[v as usize] != mesh.0[from[0] as usize]
            });
            if let Some(v) = moved {
                return Some(format!("vertex {v} of the {:?} moved", piece.side));
            }
        }
    }
    if case.keep < 2 && !case.gap && case.length.is_none() {
        let (whole, all) = (untouched(mesh, cut).len(), mesh.faces().len());
        if whole + report.cut_faces != all {
            return Some(format!("{whole} faces are whole and {} cut, of {all}", report.cut_faces));
        }
    }
    None
}

/// What is wrong with the faces of the caps.
fn wrong_caps(case: &Case, cut: &Cut) -> Option<String> {
    let report = &cut.report;
    let piece = cut.pieces.first()?;
    let faces = Polygons { corners: &piece.corners, offsets: &piece.offsets };
    let caps = (0..faces.len()).filter(|&f| piece.source_face[f] < 0).map(|f| faces.face(f).len());
    let count = |n: usize| caps.clone().filter(|&corners| corners == n).count();
    let whole = if case.gap { None } else { Some([count(3), count(4)]) };
    if whole.is_some_and(|whole| whole != [report.cap_triangles, report.cap_quads]) {
        return Some(format!("{whole:?} faces in the caps, {report:?}"));
    }
    match case.quads {
        // A cap made in a simpler way may be several polygons.
        true if report.repeated == 0 && report.cap_triangles > report.caps => {
            Some(format!("{} triangles", report.cap_triangles))
        }
        false if report.cap_quads > 0 => Some(format!("{} quads", report.cap_quads)),
        _ => None,
    }
}

/// Processor time of this process, all threads; 0 where the system does not tell.
fn processor_seconds() -> f64 {
    const TICKS: f64 = 100.0;
    let told = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // After the name in parentheses: the 12th and the 13th field.
    let fields = told.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11).take(2);
    fields.filter_map(|field| field.parse::<f64>().ok()).sum::<f64>() / TICKS
}

#[test]
fn random_cuts_keep_their_promises() {
    let n = std::env::var("GRIDMESH_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(48);
    let outcome: RefCell<BTreeMap<String, usize>> = RefCell::default();
    let slow: RefCell<Vec<(f64, String)>> = RefCell::default();
    let seed = std::env::var("GRIDMESH_SEED").ok().and_then(|n| n.parse().ok()).unwrap_or(7);
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]);
    let config = Config { cases: n, failure_persistence: None, max_shrink_iters: 0, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, rng);
    let wrong_ones: RefCell<Vec<String>> = RefCell::default();
    let done = runner.run(&cases(), |case| {
        let mesh = case.mesh();
        let since = processor_seconds();
        let made = mesh.cut(&case.stroke(), &case.options());
        let seconds = processor_seconds() - since;
        let word = match made {
            Ok(cut) => match wrong(&case, &mesh, &cut) {
                None if cut.report.reduced_caps > 0 => "made, caps reduced".to_owned(),
                None => "made".to_owned(),
                Some(reason) => {
                    wrong_ones.borrow_mut().push(format!("{reason}: {case:?}"));
                    "wrong".to_owned()
                }
            },
            Err(error) => error.kind().to_owned(),
        };
        slow.borrow_mut().push((seconds, format!("{word} {case:?}")));
        *outcome.borrow_mut().entry(word).or_default() += 1;
        Ok(())
    });
    assert!(done.is_ok());
    let mut slow = slow.into_inner();
    slow.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("{:?}", outcome.borrow());
    for (seconds, case) in &slow[..10.min(slow.len())] {
        println!("{seconds:.2} s {case}");
    }
    let wrong_ones = wrong_ones.into_inner();
    assert!(
        wrong_ones.is_empty(),
        "{} of {n}: {}",
        wrong_ones.len(),
        wrong_ones[..3.min(wrong_ones.len())].join("\n")
    );
    let made: usize =
        outcome.borrow().iter().filter(|(word, _)| word.starts_with("made")).map(|(_, count)| count).sum();
    assert!(4 * made > n as usize, "{:?}", outcome.borrow());
}
