//! Loops that are joined two by two.

use glam::DVec3;

use super::align::Ring;
use super::options::BridgeOptions;
use super::rail::ahead;
use super::span::{onward_of, tube};
use crate::error::{Error, Result};
use crate::fill::filled::Fill;
use crate::fill::job::Job;
use crate::fill::loops::check::check_loops;
use crate::fill::loops::mesh::Rim;
use crate::fill::parallel::steady;
use crate::progress::Progress;

/// Two loops look away from each other if the surface goes on from both at less than 60 degrees to the way off the other.
const AWAY: f64 = 0.5;

/// Loops that turn their backs on each other cost at most so many times as much as those that face each other.
const TURNED: f64 = 100.0;

/// A tube of [`bridge_pairs`].
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// The two loops, by their place among those given.
    pub loops: [usize; 2],
    /// What joins them, or why nothing does.
    pub tube: Result<Fill>,
}

/// What pairing knows of a loop.
struct End {
    samples: Vec<DVec3>,
    centre: DVec3,
    /// See [`ahead`].
    onward: DVec3,
}

/// Whether two of some loops look away from each other, as both ends of a pipe do: one patch between all of them would have to
/// turn round and meet itself, where tubes between pairs of them need not.
///
/// # Errors
/// Those of [`bridge()`](super::bridge) for a loop.
pub fn look_apart(vertices: &[DVec3], triangles: &[[u32; 3]], loops: &[Vec<u32>]) -> Result<bool> {
    Ok(apart(vertices, triangles, loops)?.is_some())
}

/// The first two of some loops that look away from each other.
///
/// # Errors
/// Those of [`bridge()`](super::bridge) for a loop.
pub(in crate::fill) fn apart(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    loops: &[Vec<u32>],
) -> Result<Option<[usize; 2]>> {
    let ends = ends(vertices, triangles, loops)?;
    let away = |a: &End, b: &End| a.onward.dot((b.centre - a.centre).normalize_or_zero()) < -AWAY;
    let mut pairs = (0..ends.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
    Ok(pairs.find(|&[a, b]| away(&ends[a], &ends[b]) && away(&ends[b], &ends[a])))
}

/// Joins loops of a mesh two by two, each pair by a tube as [`bridge()`](super::bridge) makes it.
///
/// Those that are nearest and face each other best come first; of an odd number one is left over. Tubes count what they meet among the
/// earlier ones too.
///
/// # Errors
/// Those of [`bridge()`](super::bridge) for a loop or an option; what is wrong with one tube is in its [`Pair`].
pub fn bridge_pairs(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    loops: &[Vec<u32>],
    options: &BridgeOptions,
    progress: Progress<'_>,
) -> Result<Vec<Pair>> {
    steady(progress, |progress| {
        progress.report(0.0)?;
        let rest = options.rest(triangles)?;
        let pairs = paired(&ends(vertices, triangles, loops)?);
        let mut tubes = Vec::with_capacity(pairs.len());
        for (k, pair) in pairs.iter().enumerate() {
            let part = |k: usize| 0.1 + 0.7 * k as f64 / pairs.len() as f64;
            let given = pair.map(|k| loops[k].as_slice());
            match tube(vertices, triangles, given, options, &rest, progress.part(part(k), part(k + 1))) {
                Err(Error::Cancelled) => return Err(Error::Cancelled),
                made => tubes.push(made),
            }
        }
        Job { vertices, triangles, options: &rest }.count_meetings(&mut tubes, progress.part(0.8, 1.0))?;
        progress.report(1.0)?;
        Ok(pairs.into_iter().zip(tubes).map(|(loops, tube)| Pair { loops, tube }).collect())
    })
}

fn ends(vertices: &[DVec3], triangles: &[[u32; 3]], loops: &[Vec<u32>]) -> Result<Vec<End>> {
    let rim = Rim::new(vertices.len(), triangles, &loops.concat(), 1)?;
    check_loops(loops, vertices, &rim)?;
    let end = |loop_: &Vec<u32>| {
        let onward = onward_of(loop_, &rim, vertices);
        let ring = Ring::new(loop_.iter().map(|&v| vertices[v as usize]).collect());
        let samples = ring.samples().into_iter().map(|p| p + ring.centre).collect();
        End { samples, centre: ring.centre, onward: ahead(&onward) }
    };
    Ok(loops.iter().map(end).collect())
}

/// Pairs of ends, the cheapest first, each end in one pair at most.
fn paired(ends: &[End]) -> Vec<[usize; 2]> {
    let all = (0..ends.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
    let mut all = all.map(|pair| (cost(&ends[pair[0]], &ends[pair[1]]), pair)).collect::<Vec<_>>();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut free = vec![true; ends.len()];
    let mut pairs = vec![];
    for (_, [a, b]) in all {
        if free[a] && free[b] {
            (free[a], free[b]) = (false, false);
            pairs.push([a, b]);
        }
    }
    pairs
}

/// The distance of two ends, more the further a tube has to turn to get from one to the other.
fn cost(a: &End, b: &End) -> f64 {
    let ways = a.samples.iter().flat_map(|p| b.samples.iter().map(move |q| q - p));
    let way = ways.min_by(|v, w| v.length_squared().total_cmp(&w.length_squared())).unwrap_or_default();
    let along = way.normalize_or_zero();
    let turned = |cosine: f64| 1.0 / (0.5 * (1.0 + cosine)).max(1.0 / TURNED);
    way.length() * (turned(a.onward.dot(along)) + turned(-b.onward.dot(along)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::LoopError;

    /// Open pipes of one segment along z, each of (vertices around, radius, x, z from, z to), and their two rims each.
    fn pipes(them: &[(u32, f64, f64, f64, f64)]) -> (Vec<DVec3>, Vec<[u32; 3]>, Vec<Vec<u32>>) {
        let (mut vertices, mut triangles, mut loops) = (vec![], vec![], vec![]);
        for &(n, radius, x, from, to) in them {
            let first = vertices.len() as u32;
            for z in [from, to] {
                let start = vertices.len() as u32;
                vertices.extend((0..n).map(|k| {
                    let turn = std::f64::consts::TAU * f64::from(k) / f64::from(n);
                    DVec3::new(x + radius * turn.cos(), radius * turn.sin(), z)
                }));
                loops.push((start..start + n).collect());
            }
            for k in 0..n {
                let (a, b) = (first + k, first + (k + 1) % n);
                triangles.extend([[a, b, b + n], [a, b + n, a + n]]);
            }
        }
        (vertices, triangles, loops)
    }

    fn joined(them: &[(u32, f64, f64, f64, f64)]) -> Vec<([usize; 2], bool)> {
        let (vertices, triangles, loops) = pipes(them);
        assert!(look_apart(&vertices, &triangles, &loops).unwrap());
        let options = BridgeOptions { strict: true, ..BridgeOptions::default() };
        let pairs = bridge_pairs(&vertices, &triangles, &loops, &options, Progress::NONE).unwrap();
        let clear = |fill: &Fill| fill.report.folds == 0 && fill.report.self_intersections == 0;
        let mut found =
            pairs.into_iter().map(|p| (p.loops, p.tube.is_ok_and(|t| clear(&t)))).collect::<Vec<_>>();
        found.sort_unstable();
        found
    }

    #[test]
    fn ends_of_pipes_are_joined_two_by_two() {
        let beside = [(24, 1.0, -1.6, 0.0, 2.0), (32, 1.2, 1.6, 0.0, 2.2)];
        assert_eq!(joined(&beside), [([0, 2], true), ([1, 3], true)]);
        let nested = [(24, 1.0, 0.0, 0.0, 0.3), (32, 2.0, 0.0, 0.0, 0.3)];
        assert_eq!(joined(&nested), [([0, 2], true), ([1, 3], true)]);
        let far = [(24, 1.0, -8.0, 0.0, 1.0), (32, 1.2, 8.0, 0.0, 1.0)];
        assert_eq!(joined(&far), [([0, 2], true), ([1, 3], true)]);
        // The outer ends look away from each other: what joins them would run through the pipes.
        let above = [(24, 1.0, 0.0, 0.0, 2.0), (32, 1.2, 0.0, 3.5, 5.5)];
        assert_eq!(joined(&above), [([0, 3], false), ([1, 2], true)]);
    }

    #[test]
    fn ends_that_look_at_each_other_do_not_look_apart() {
        let (vertices, triangles, loops) = pipes(&[
            (16, 1.0, -1.6, -1.0, 0.0),
            (24, 1.0, 1.6, -1.0, 0.0),
            (31, 2.2, 0.0, 2.5, 3.5),
            (20, 1.0, 4.8, -1.0, 0.0),
        ]);
        let chosen = [&loops[1], &loops[3], &loops[4], &loops[7]].map(Clone::clone);
        assert!(!look_apart(&vertices, &triangles, &chosen[..3]).unwrap());
        assert!(!look_apart(&vertices, &triangles, &chosen).unwrap());
        assert!(!look_apart(&vertices, &[], &loops).unwrap(), "loops without faces");
        let twice = [loops[0].clone(), loops[0].clone()];
        let shared = LoopError::Shared { vertex: 0, loops: [0, 1] };
        assert_eq!(look_apart(&vertices, &triangles, &twice), Err(Error::Loops(shared)));
    }

    #[test]
    fn of_an_odd_number_one_is_left_over() {
        let (vertices, triangles, loops) = pipes(&[(24, 1.0, 0.0, 0.0, 2.0), (32, 1.2, 0.0, 3.5, 5.5)]);
        let options = BridgeOptions::default();
        let pairs = bridge_pairs(&vertices, &triangles, &loops[..3], &options, Progress::NONE).unwrap();
        assert_eq!(pairs.iter().map(|p| p.loops).collect::<Vec<_>>(), [[1, 2]]);
        assert_eq!(bridge_pairs(&vertices, &triangles, &[], &options, Progress::NONE), Ok(vec![]));
    }
}
