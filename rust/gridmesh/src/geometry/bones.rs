//! Weights of the vertices of a flat mesh for the bones that are to bend it.

mod bends;
mod heat;
mod ways;

use glam::DVec2;

use self::bends::ease;
use self::heat::Heat;
use self::ways::Ways;
use super::disjoint::Disjoint;
use super::march::{Around, march};
use super::polygon::SIZES;
use crate::error::{Error, Result, told};
use crate::progress::Progress;

/// Options of [`bone_weights`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightOptions {
    /// The most bones that move a vertex, 1 or more.
    pub most: usize,
    /// How far a joint reaches into the limbs, relative to half their width, 0.01 to 100.
    pub reach: f64,
}

impl Default for WeightOptions {
    fn default() -> Self {
        Self { most: 4, reach: 1.0 }
    }
}

/// Bones whose distances differ by less than this share of the limb's half width are equally near.
const EQUALLY_NEAR: f64 = 0.1;

/// So many of the strongest bones at a vertex are looked at for bones between them.
const SHARING: usize = 6;

/// Weights below this are dropped.
const LEAST: f64 = 1e-4;

/// Times at most that heat spreads anew where triangles would be pressed together: three are enough for most meshes, and of the
/// others more help hardly any.
const ROUNDS: usize = 8;

/// How much each bone moves each vertex of a flat mesh: a row for each vertex, a number for each bone.
///
/// Rows sum to 1 up to rounding, have no negative numbers, and at most `most` that are not 0. Distances are measured within the mesh, so that a
/// bone has no hold on a limb that is near in the plane but far in the drawing. Away from joints the
/// nearest bone has nearly all of the weight; at joints it passes from bone to bone over `reach` times half the
/// width of the limb, which is the distance to the bone and to the rim together; over more where triangles would be pressed
/// together when a joint is bent, as far from it in a ring. Where bones pull that do not touch each other, those
/// between them in the chain do so, too. Parts of the mesh that no bone
/// meets follow the bone that is nearest to them as a whole. O(b n log n) in practice.
///
/// # Errors
/// [`Error::NotFinite`], [`Error::ExtremeSize`], [`Error::IndexOutOfRange`], [`Error::InvalidOption`] (also without bones), [`Error::Solver`], [`Error::Cancelled`].
///
/// Source: the heat equilibrium of Baran and Popović, *Automatic rigging and animation of 3D characters*, 2007, with a
/// heat transfer that depends on the limb's width alone and distances within the drawing.
pub fn bone_weights(
    vertices: &[DVec2],
    triangles: &[[u32; 3]],
    bones: &[[DVec2; 2]],
    options: &WeightOptions,
    progress: Progress<'_>,
) -> Result<Vec<f64>> {
    check(vertices, triangles, bones, options)?;
    let (n, b) = (vertices.len(), bones.len());
    let around = Around::new(n, triangles);
    let mut near = Vec::with_capacity(b * n);
    for (k, bone) in bones.iter().enumerate() {
        progress.report(0.6 * k as f64 / b as f64)?;
        near.extend(march(vertices, triangles, &around, seeds(vertices, triangles, bone)));
    }
    follow_as_a_whole(vertices, triangles, bones, &mut near);
    let rim = rim(triangles).into_iter().map(|v| (v, 0.0));
    let rim = march(vertices, triangles, &around, rim);
    let finest = longest_edges(vertices, triangles);
    let mut wanted = vec![0.0; b * n];
    let mut transfer = vec![1.0; n];
    for v in 0..n {
        let least = (0..b).map(|k| near[k * n + v]).fold(f64::INFINITY, f64::min);
        let half = (least + if rim[v].is_finite() { rim[v] } else { 0.0 }).max(finest[v]);
        let mut sum = 0.0;
        for k in 0..b {
            let farther = near[k * n + v] - least;
            wanted[k * n + v] = (1.0 - farther / (EQUALLY_NEAR * half)).max(0.0);
            sum += wanted[k * n + v];
        }
        (0..b).for_each(|k| wanted[k * n + v] /= sum);
        transfer[v] = (options.reach * half).powi(-2);
    }
    progress.report(0.7)?;
    let heat = Heat::new(vertices, triangles, &transfer)?;
    let ways = Ways::new(bones);
    let mut eased = vec![1.0; triangles.len()];
    let mut round = 0;
    loop {
        let found = strongest(&heat.settled(&eased, &wanted, b)?, n, &ways, options.most);
        if round == ROUNDS || !ease(&ways.joints, options.reach, vertices, triangles, &found, &mut eased) {
            progress.report(1.0)?;
            return Ok(found);
        }
        round += 1;
        progress.report(0.7 + 0.3 * round as f64 / (ROUNDS + 1) as f64)?;
    }
}

fn check(
    vertices: &[DVec2],
    triangles: &[[u32; 3]],
    bones: &[[DVec2; 2]],
    options: &WeightOptions,
) -> Result<()> {
    if let Some(point) = vertices.iter().position(|p| !p.is_finite()) {
        return Err(Error::NotFinite { what: "mesh".to_owned(), point });
    }
    if let Some(bone) = bones.iter().position(|ends| !ends.iter().all(|p| p.is_finite())) {
        return Err(Error::NotFinite { what: "bones".to_owned(), point: bone });
    }
    let far =
        |points: &mut dyn Iterator<Item = &DVec2>| points.map(|p| p.abs().max_element()).fold(0.0, f64::max);
    for (what, size) in
        [("mesh", far(&mut vertices.iter())), ("set of bones", far(&mut bones.iter().flatten()))]
    {
        if size > *SIZES.end() {
            return Err(Error::ExtremeSize { what: what.to_owned(), size });
        }
    }
    if let Some(&v) = triangles.iter().flatten().find(|&&v| v as usize >= vertices.len()) {
        let (what, index) = ("triangles".to_owned(), v as i32);
        return Err(Error::IndexOutOfRange { what, index, vertices: vertices.len() });
    }
    let invalid = |name, value: String, allowed| Err(Error::InvalidOption { name, value, allowed });
    if bones.is_empty() {
        return invalid("bones", "empty".to_owned(), "one bone or more");
    }
    if options.most == 0 {
        return invalid("most", options.most.to_string(), "1 or more bones for a vertex");
    }
    if !(0.01..=100.0).contains(&options.reach) {
        return invalid("reach", told(options.reach), "a number from 0.01 to 100");
    }
    Ok(())
}

/// Corners of the triangles that the bone meets, and their distances from it.
fn seeds<'a>(
    vertices: &'a [DVec2],
    triangles: &'a [[u32; 3]],
    &[head, tail]: &'a [DVec2; 2],
) -> impl Iterator<Item = (u32, f64)> + 'a {
    let (low, high) = (head.min(tail), head.max(tail));
    let is_met = move |corners: &[u32; 3]| {
        let corners = corners.map(|v| vertices[v as usize]);
        let (least, most) =
            (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
        least.cmple(high).all() && most.cmpge(low).all() && meets(corners, head, tail)
    };
    let met = triangles.iter().filter(move |corners| is_met(corners));
    met.flatten().map(move |&v| (v, to_segment(vertices[v as usize], head, tail)))
}

/// Whether a segment meets a triangle of either orientation: what is left of it when all three sides have cut it.
fn meets(corners: [DVec2; 3], head: DVec2, tail: DVec2) -> bool {
    let turn = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).signum();
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for k in 0..3 {
        let (p, side) = (corners[k], corners[(k + 1) % 3] - corners[k]);
        let (a, b) = (turn * side.perp_dot(head - p), turn * side.perp_dot(tail - p));
        if a < 0.0 && b < 0.0 {
            return false;
        }
        if a < 0.0 {
            from = from.max(a / (a - b));
        } else if b < 0.0 {
            to = to.min(a / (a - b));
        }
    }
    from <= to
}

fn to_segment(p: DVec2, head: DVec2, tail: DVec2) -> f64 {
    let along = tail - head;
    let squared = along.length_squared();
    let t = if squared > 0.0 { ((p - head).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(head + t * along)
}

/// Gives each part of the mesh that no bone meets to the bone that is nearest to one of its vertices.
fn follow_as_a_whole(vertices: &[DVec2], triangles: &[[u32; 3]], bones: &[[DVec2; 2]], near: &mut [f64]) {
    let n = vertices.len();
    let mut sets = Disjoint::new(n);
    for t in triangles {
        sets.join(t[0], t[1]);
        sets.join(t[1], t[2]);
    }
    let mut nearest = vec![(f64::INFINITY, usize::MAX); n];
    let is_left = |v: usize, near: &[f64]| (0..bones.len()).all(|k| near[k * n + v].is_infinite());
    let left: Vec<usize> = (0..n).filter(|&v| is_left(v, near)).collect();
    for &v in &left {
        let part = &mut nearest[sets.root(v as u32) as usize];
        for (k, &[head, tail]) in bones.iter().enumerate() {
            let distance = to_segment(vertices[v], head, tail);
            if distance < part.0 {
                *part = (distance, k);
            }
        }
    }
    for &v in &left {
        let (_, bone) = nearest[sets.root(v as u32) as usize];
        if bone < bones.len() {
            near[bone * n + v] = to_segment(vertices[v], bones[bone][0], bones[bone][1]);
        }
    }
}

/// Vertices of edges that have one triangle.
fn rim(triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut edges: Vec<[u32; 2]> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    let single = edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 1);
    single.flat_map(|same| same[0]).collect()
}

/// The longest edge at each vertex, below which nothing changes gradually; above 0 everywhere.
fn longest_edges(vertices: &[DVec2], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut longest = vec![0.0_f64; vertices.len()];
    for corners in triangles {
        for k in 0..3 {
            let [a, b] = [corners[k], corners[(k + 1) % 3]].map(|v| v as usize);
            let length = vertices[a].distance(vertices[b]);
            longest[a] = longest[a].max(length);
            longest[b] = longest[b].max(length);
        }
    }
    longest.iter_mut().for_each(|length| *length = if *length > 0.0 { *length } else { 1.0 });
    longest
}

/// By vertex, the strongest alone, summing to 1.
fn strongest(weights: &[f64], n: usize, ways: &Ways, most: usize) -> Vec<f64> {
    let bones = ways.count;
    let mut kept = vec![0.0; n * bones];
    let mut order: Vec<usize> = Vec::with_capacity(bones);
    let mut here = vec![0.0; bones];
    for v in 0..n {
        (0..bones).for_each(|k| here[k] = weights[k * n + v]);
        sort(&mut order, &here);
        ways.passed_on(&mut here, &order[..SHARING.min(bones)]);
        sort(&mut order, &here);
        order.truncate(most);
        let strongest = here[order[0]];
        order.retain(|&k| here[k] >= LEAST.min(strongest));
        let sum: f64 = order.iter().map(|&k| here[k]).sum();
        for &k in &order {
            kept[v * bones + k] = here[k] / sum;
        }
    }
    kept
}

/// The bones from the strongest to the weakest.
fn sort(order: &mut Vec<usize>, weights: &[f64]) {
    order.clear();
    order.extend(0..weights.len());
    order.sort_by(|&j, &k| weights[k].total_cmp(&weights[j]));
}
