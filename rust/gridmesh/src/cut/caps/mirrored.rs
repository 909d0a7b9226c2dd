//! Cut lines of a mesh that is half of a symmetric one: those that end at the plane of symmetry are closed along it.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashSet;

use super::loops::Loops;
use super::regions::Spot;
use crate::cut::caps::capper::key;
use crate::cut::divide::node::Node;
use crate::cut::divide::parted::Parted;
use crate::cut::options::Mirror;
use crate::cut::sheet::Sheet;

/// Open lines, closed along planes.
#[derive(Default)]
pub(in crate::cut) struct Seams {
    pub outlines: Vec<Vec<Spot>>,
    /// New vertices on the planes; they are numbered from a given number on.
    pub vertices: Vec<Node>,
    /// Edges on the planes.
    pub edges: FxHashSet<(u32, u32)>,
}

/// A ray nearly along the plane meets it nowhere in particular.
const ALONG: f64 = 1e-3;

/// Closes the open lines whose two ends lie on one of the planes.
pub(in crate::cut) fn close(
    vertices: &[DVec3],
    parted: &Parted,
    sheet: &Sheet,
    loops: &Loops,
    mirrors: &[Mirror],
    first: u32,
) -> Seams {
    let mut seams = Seams::default();
    for (nodes, places) in &loops.open {
        let at = |k: usize| parted.position(vertices, nodes[k]);
        let (start, end) = (at(0), at(nodes.len() - 1));
        let holds = |m: &&Mirror| [start, end].iter().all(|p| m.off(*p).abs() <= m.within);
        let Some(mirror) = mirrors.iter().find(holds) else { continue };
        let spot = |k: usize| Spot { node: nodes[k], at: DVec2::new(places[k], sheet.view.height(at(k))) };
        let mut outline = (0..nodes.len()).map(spot).collect::<Vec<_>>();
        let length: f64 = (1..nodes.len()).map(|k| at(k - 1).distance(at(k))).sum();
        let step = length / (nodes.len() - 1) as f64;
        let (from, to) = (outline[outline.len() - 1].at, outline[0].at);
        let steps = (start.distance(end) / step.max(f64::MIN_POSITIVE)).round().clamp(2.0, 1e5) as usize;
        let mut before = nodes[nodes.len() - 1];
        for k in 1..steps {
            let share = k as f64 / steps as f64;
            let mut spot = from.lerp(to, share);
            // Where the ray at this place of the line meets the plane.
            let ray = sheet.lift(spot.x, 1.0) - sheet.lift(spot.x, 0.0);
            let slope = ray.dot(mirror.normal);
            if slope.abs() > ALONG * ray.length() {
                spot.y = -mirror.off(sheet.lift(spot.x, 0.0)) / slope;
            }
            let position = sheet.lift(spot.x, spot.y);
            let position = position - mirror.off(position) * mirror.normal;
            let node = first + seams.vertices.len() as u32;
            seams.vertices.push(Node { position, source: [u32::MAX; 3], weights: [1.0, 0.0, 0.0] });
            seams.edges.insert(key(before, node));
            outline.push(Spot { node, at: spot });
            before = node;
        }
        seams.edges.insert(key(before, nodes[0]));
        seams.outlines.push(outline);
    }
    seams
}
