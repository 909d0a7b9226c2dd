//! Whether a loop can be filled, and on which side.

use glam::DVec3;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use rustc_hash::FxHashMap;

use super::mesh::Rim;
use super::touching::closest;
use crate::error::{Error, LoopError, Result};

/// Loops up to this size are looked through pair by pair.
const FEW: usize = 24;

/// A loop that can be filled.
#[derive(Clone, Debug)]
pub(crate) struct Checked {
    /// The vertices in the direction of the patch's boundary (the patch on the left).
    pub vertices: Vec<u32>,
    /// True if that is against the direction given.
    pub reversed: bool,
    /// Edges whose only triangle is wound along the patch instead of against it.
    pub conflicts: usize,
    /// Edges that no triangle of the mesh has.
    pub wire: usize,
}

/// Checks a loop against the mesh around it and finds the direction of its patch: against that of
/// the triangles at the loop (of most of them, where they disagree); for a loop without triangles
/// the direction given.
///
/// # Errors
/// One kind for each way to be unfit, see the variants of [`Error`] constructed here.
pub(crate) fn check_loop(given: &[u32], positions: &[DVec3], rim: &Rim) -> Result<Checked> {
    let n = given.len();
    if let Some(&v) = given.iter().find(|&&v| v as usize >= positions.len()) {
        return Err(Error::IndexOutOfRange {
            what: "loop".into(),
            index: v as i32,
            vertices: positions.len(),
        });
    }
    if n < 3 {
        return Err(Error::Loops(LoopError::Short { number: None, vertices: n }));
    }
    for k in 0..n {
        if given[k] == given[(k + 1) % n] {
            return Err(Error::RepeatedVertex { vertex: given[k], first: k, second: (k + 1) % n });
        }
    }
    let mut sorted = given.to_vec();
    sorted.sort_unstable();
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Error::FigureEight { vertex: pair[0] });
    }
    let at = |v: u32| positions[v as usize];
    if let Some(&v) = given.iter().find(|&&v| !at(v).is_finite()) {
        return Err(Error::NotFinite { what: "mesh".into(), point: v as usize });
    }
    check_size(given, positions)?;
    let fans = given.iter().filter_map(|&v| rim.local(v)).flat_map(|v| rim.around(v));
    let near = fans.flat_map(|&t| rim.triangles[t as usize]).map(|v| rim.ids[v as usize]);
    if let Some(v) = near.into_iter().find(|&v| !at(v).is_finite()) {
        return Err(Error::NotFinite { what: "mesh".into(), point: v as usize });
    }
    check_touching(given, positions)?;

    let (mut along, mut against, mut wire) = (0, 0, 0);
    for k in 0..n {
        let edge @ [a, b] = [given[k], given[(k + 1) % n]];
        let (mut forward, mut backward) = (0, 0);
        if let (Some(a), Some(b)) = (rim.local(a), rim.local(b)) {
            for &t in rim.around(a) {
                let corners = rim.triangles[t as usize];
                for i in 0..3 {
                    forward += usize::from(corners[i] == a && corners[(i + 1) % 3] == b);
                    backward += usize::from(corners[i] == b && corners[(i + 1) % 3] == a);
                }
            }
        }
        match forward + backward {
            0 => wire += 1,
            1 => (along, against) = (along + forward, against + backward),
            2 => return Err(Error::FacesOnBothSides { edge }),
            _ => return Err(Error::NonManifold { edge, vertex: b }),
        }
    }
    let reversed = along > against;
    let mut vertices = given.to_vec();
    if reversed {
        vertices.reverse();
    }
    Ok(Checked { vertices, reversed, conflicts: along.min(against), wire })
}

/// Checks several loops, and that no vertex is in two of them.
///
/// # Errors
/// Those of [`check_loop`], and [`LoopError::Shared`].
pub(crate) fn check_loops<L: AsRef<[u32]>>(
    given: &[L],
    positions: &[DVec3],
    rim: &Rim,
) -> Result<Vec<Checked>> {
    let mut checked = Vec::with_capacity(given.len());
    for (number, loop_) in given.iter().enumerate() {
        checked.push(check_loop(loop_.as_ref(), positions, rim).map_err(|err| match err {
            Error::Loops(LoopError::Short { vertices, .. }) => {
                Error::Loops(LoopError::Short { number: Some(number), vertices })
            }
            other => other,
        })?);
    }
    let mut known = FxHashMap::default();
    for (number, loop_) in given.iter().enumerate() {
        for &vertex in loop_.as_ref() {
            if let Some(first) = known.insert(vertex, number) {
                return Err(Error::Loops(LoopError::Shared { vertex, loops: [first, number] }));
            }
        }
    }
    Ok(checked)
}

/// Refuses loops that have a vertex that is not finite among the triangles of `wide`, two rings around them.
pub(crate) fn check_near(given: &[u32], positions: &[DVec3], wide: &Rim) -> Result<()> {
    let corners = |v: u32| wide.around(v).iter().flat_map(|&t| wide.triangles[t as usize]);
    let beside = given.iter().filter_map(|&v| wide.local(v)).flat_map(corners);
    let near = beside.flat_map(corners).map(|v| wide.ids[v as usize]);
    match near.into_iter().find(|&v| !positions[v as usize].is_finite()) {
        Some(v) => Err(Error::NotFinite { what: "mesh".into(), point: v as usize }),
        None => Ok(()),
    }
}

/// Refuses loops whose areas and volumes would leave the range of floating point.
pub(crate) fn check_size(given: &[u32], positions: &[DVec3]) -> Result<()> {
    let (low, high) = given.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &v| {
        let p = positions[v as usize];
        (low.min(p), high.max(p))
    });
    let size = (high - low).max_element();
    let far = low.abs().max(high.abs()).max_element();
    if (size > 0.0 && size < 1e-60) || far > 1e60 {
        return Err(Error::ExtremeSize { what: "loop".into(), size: size.max(far) });
    }
    Ok(())
}

/// Refuses loops with edges of no length and loops that meet themselves: vertices on one point,
/// vertices on edges, edges that cross; up to rounding.
fn check_touching(given: &[u32], positions: &[DVec3]) -> Result<()> {
    let n = given.len();
    let at = |k: usize| positions[given[k % n] as usize];
    // Equal coordinates, by their bits; the sign of zero does not count.
    let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut seen = FxHashMap::default();
    for k in 0..n {
        if at(k) == at(k + 1) {
            return Err(Error::ZeroLengthEdge { edge: [given[k], given[(k + 1) % n]] });
        }
        if let Some(other) = seen.insert(key(at(k)), k) {
            return Err(Error::SelfTouching { first: given[other], second: given[k], at: at(k).into() });
        }
    }
    let apart = |i: usize, j: usize| (i + 1) % n != j && (j + 1) % n != i && i != j;
    let test = |i: usize, j: usize| -> Result<()> {
        match meeting(at(i), at(i + 1), at(j), at(j + 1)) {
            Some(p) if apart(i, j) => {
                Err(Error::SelfTouching { first: given[i], second: given[j], at: p.into() })
            }
            _ => Ok(()),
        }
    };
    if n <= FEW {
        for i in 0..n {
            for j in i + 1..n {
                test(i, j)?;
            }
        }
        return Ok(());
    }
    let rectangle =
        |k: usize| Rectangle::from_corners(at(k).min(at(k + 1)).into(), at(k).max(at(k + 1)).into());
    let boxes = (0..n).map(|k| GeomWithData::new(rectangle(k), k)).collect::<Vec<_>>();
    let tree: RTree<GeomWithData<Rectangle<[f64; 3]>, usize>> = RTree::bulk_load(boxes);
    for i in 0..n {
        let near = AABB::from_corners(at(i).min(at(i + 1)).into(), at(i).max(at(i + 1)).into());
        let mut others = tree.locate_in_envelope_intersecting(near).map(|b| b.data).collect::<Vec<_>>();
        others.sort_unstable();
        for j in others.into_iter().filter(|&j| j > i) {
            test(i, j)?;
        }
    }
    Ok(())
}

/// Where two segments meet, if they come as near as rounding allows to tell.
fn meeting(p: DVec3, q: DVec3, a: DVec3, b: DVec3) -> Option<DVec3> {
    let (x, y) = closest(p, q, a, b);
    let scale = [p, q, a, b].iter().fold(0.0, |m: f64, x| m.max(x.abs().max_element()));
    (x.distance(y) <= 8.0 * f64::EPSILON * scale).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(given: &[u32], positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> &'static str {
        let positions = positions.iter().map(|&p| p.into()).collect::<Vec<DVec3>>();
        let seeds = given.iter().copied().filter(|&v| (v as usize) < positions.len()).collect::<Vec<_>>();
        let rim = Rim::new(positions.len(), triangles, &seeds, 1).unwrap();
        check_loop(given, &positions, &rim).err().map_or("", |error| error.kind())
    }

    const SQUARE: [[f64; 3]; 5] =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, -1.0, 0.0]];

    #[test]
    fn each_fault_has_its_kind() {
        assert_eq!(kind(&[0, 1, 2, 3], &SQUARE, &[]), "");
        assert_eq!(kind(&[0, 1], &SQUARE, &[]), "too_few_points");
        assert_eq!(kind(&[0, 1, 7], &SQUARE, &[]), "index_out_of_range");
        assert_eq!(kind(&[0, 1, 1, 2], &SQUARE, &[]), "repeated_vertex");
        assert_eq!(kind(&[0, 1, 2, 3, 0], &SQUARE, &[]), "repeated_vertex");
        assert_eq!(kind(&[0, 1, 2, 1, 3], &SQUARE, &[]), "figure_eight");
        assert_eq!(kind(&[0, 2, 1, 3], &SQUARE, &[]), "self_touching");
        assert_eq!(kind(&[0, 1, 2, 3], &SQUARE, &[[0, 1, 2], [0, 4, 1]]), "faces_on_both_sides");
        assert_eq!(kind(&[0, 1, 2, 3], &SQUARE, &[[0, 1, 2], [0, 4, 1], [0, 1, 3]]), "non_manifold");
        let mut bad = SQUARE;
        bad[2][1] = f64::NAN;
        assert_eq!(kind(&[0, 1, 2, 3], &bad, &[]), "not_finite");
        let mut bad = SQUARE;
        bad[1] = bad[0];
        assert_eq!(kind(&[0, 1, 2, 3], &bad, &[]), "zero_length_edge");
        bad[1] = bad[3];
        assert_eq!(kind(&[0, 1, 2, 3], &bad, &[]), "self_touching");
    }

    #[test]
    fn the_patch_is_wound_against_most_neighbours() {
        let positions = SQUARE.map(DVec3::from);
        let rim = |t: &[[u32; 3]]| Rim::new(5, t, &[0, 1, 2, 3], 1).unwrap();
        let checked = check_loop(&[0, 1, 2, 3], &positions, &rim(&[[1, 0, 4]])).unwrap();
        assert_eq!((checked.vertices, checked.reversed, checked.wire), (vec![0, 1, 2, 3], false, 3));
        let checked = check_loop(&[0, 1, 2, 3], &positions, &rim(&[[0, 1, 4]])).unwrap();
        assert_eq!((checked.vertices, checked.reversed), (vec![3, 2, 1, 0], true));
        let mixed = [[0, 1, 4], [2, 1, 4], [2, 3, 4]];
        let checked = check_loop(&[0, 1, 2, 3], &positions, &rim(&mixed)).unwrap();
        assert_eq!((checked.reversed, checked.conflicts), (true, 1));
    }

    #[test]
    fn big_loops_are_searched_too() {
        let eight = (0..200).map(|k| {
            let t = 0.05 + f64::from(k) * std::f64::consts::TAU / 200.0;
            DVec3::new(t.sin(), (2.0 * t).sin(), 0.0)
        });
        let eight = eight.collect::<Vec<_>>();
        let loop_ = (0..200).collect::<Vec<_>>();
        let rim = Rim::default();
        assert_eq!(check_loop(&loop_, &eight, &rim).unwrap_err().kind(), "self_touching");
        let lifted = eight.iter().enumerate().map(|(k, p)| *p + DVec3::Z * 1e-3 * k as f64);
        assert!(check_loop(&loop_, &lifted.collect::<Vec<_>>(), &rim).is_ok());
    }
}
