//! Where tubes from several loops come together: around a point before all of them each tube ends in a circle.

use std::f64::consts::TAU;
use std::iter;

use glam::{DMat3, DQuat, DVec3};

use super::border::Several;
use crate::fill::bridge::align::Ring;
use crate::fill::bridge::{ALIKE, ahead, is_pipe, onward_of};
use crate::fill::loops::check::Checked;

/// How far tubes may be bent to come to a hub.
pub(super) struct Limits {
    /// The least cosine between the way a pipe goes on and that to the centre.
    ahead: f64,
    /// Whether tubes from pipes that are near keep their sizes.
    keeps_near: bool,
    /// The least factor by which circles are smaller than the tubes.
    smaller: f64,
    /// The least cosine between the way of a tube at the hub and that of an arc there: the ways are turned apart.
    spread: f64,
}

/// Tubes are as one would make them by hand.
pub(super) const STRAIGHT: Limits = Limits { ahead: 0.85, keeps_near: true, smaller: 0.5, spread: 0.8 };

/// Where there is nothing better.
pub(super) const BENT: Limits = Limits { ahead: 0.3, keeps_near: false, smaller: 0.35, spread: 0.2 };

/// The least cosine between the normal of a hole in a sheet and the way to the centre, one after the other. The later ones only where
/// all holes look the same way: the lower the centre, the more tubes lean over.
const LEANING: [f64; 3] = [0.7, 0.5, 0.35];

/// Circles take up this part of the angles between them.
pub(super) const SHARES: [f64; 3] = [0.6, 0.5, 0.7];

/// A hole in a sheet is a loop into which the surface goes on with at least this mean cosine. Around an island it goes on outwards.
const HOLE: f64 = 0.3;

/// By how much a tube is narrower than the hole in a sheet that it comes from.
const NECK: f64 = 0.75;

/// Circles are at most this far from the centre, in distances of the nearest loop.
const REACH: f64 = 0.6;

/// Factors by which circles are smaller than tubes are tried in such steps.
const STEP: f64 = 0.9;

/// Pipes are near the centre if they are nearer than so many of their radii, on average.
const FAR: f64 = 3.5;

/// Rounds in which ways are spread, and by how much more than is needed.
const ROUNDS: usize = 100;
const OVER: f64 = 1.05;

/// The weight that draws the centre to that of the loops, where the ways of the tubes do not tell.
const DRAWN: f64 = 0.01;

/// Where loops look the same way the centre is lifted in so many steps, up to so many times as far as loops are from their middle.
const LIFTS: usize = 25;
const HIGHEST: f64 = 2.5;

/// Where the tube from a loop ends.
pub(super) struct Circle {
    /// In the order of the loop's vertices.
    pub points: Vec<DVec3>,
    /// The way the tube goes on.
    pub way: DVec3,
}

/// What the hub knows of a loop.
struct Spoke {
    ring: Ring,
    /// The way the tube leaves.
    out: DVec3,
    /// Of the tube.
    radius: f64,
    is_pipe: bool,
}

/// A circle for each loop; none where there is no place for a hub. `share`: one of [`SHARES`].
pub(super) fn circles(several: &Several<'_>, limits: &Limits, share: f64) -> Option<Vec<Circle>> {
    // Outside the surfaces, or inside.
    let found = [1.0, -1.0].into_iter().find_map(|side| {
        let spokes = spokes(several, side)?;
        let alike = (0..spokes.len()).all(|b| (0..b).all(|a| spokes[a].out.dot(spokes[b].out) > ALIKE));
        let leaning = &LEANING[..if alike && side > 0.0 { LEANING.len() } else { 1 }];
        let centre = leaning.iter().find_map(|&least| centre(&spokes, [limits.ahead, least]))?;
        Some((spokes, centre))
    });
    let (spokes, centre) = found?;
    let Place { ways, distance, shrunk } = place(&spokes, centre, limits, share)?;
    let circle =
        |(spoke, &way): (&Spoke, &DVec3)| spoke.circle(way, centre - distance * way, shrunk * spoke.radius);
    Some(spokes.iter().zip(&ways).map(circle).collect())
}

impl Spoke {
    /// A circle around a way, with as many vertices as the loop, in the order that suits a tube from it.
    fn circle(&self, way: DVec3, middle: DVec3, radius: f64) -> Circle {
        let turn = DQuat::from_rotation_arc(self.out, way);
        let first = turn * (self.ring.points[0] - self.ring.centre);
        let across =
            first.reject_from_normalized(way).try_normalize().unwrap_or(way.any_orthonormal_vector());
        let up = if self.ring.axis.dot(self.out) > 0.0 { way } else { -way };
        let n = self.ring.points.len();
        let at = |k: usize| {
            let angle = TAU * k as f64 / n as f64;
            middle + radius * (libm::cos(angle) * across + libm::sin(angle) * up.cross(across))
        };
        Circle { points: (0..n).map(at).collect(), way }
    }
}

/// Tubes that leave sheets on one side of them. None if a loop is neither the end of a pipe nor a hole in a sheet, or tubes are turned
/// out and others in.
fn spokes(several: &Several<'_>, side: f64) -> Option<Vec<Spoke>> {
    let Several { vertices, rim, checked, .. } = *several;
    let spoke = |c: &Checked| {
        let ring = Ring::new(c.vertices.iter().map(|&v| vertices[v as usize]).collect());
        let onward = onward_of(&c.vertices, rim, vertices);
        let far = ring.points.iter().map(|p| p.distance(ring.centre)).sum::<f64>() / ring.points.len() as f64;
        if is_pipe(&onward) {
            let out = ahead(&onward).normalize();
            return Some(Spoke { ring, out, radius: far, is_pipe: true });
        }
        let inwards = |(&point, way): (&DVec3, &DVec3)| way.dot((ring.centre - point).normalize_or_zero());
        let mean = ring.points.iter().zip(&onward).map(inwards).sum::<f64>() / onward.len() as f64;
        let is_hole = mean >= HOLE && ring.axis != DVec3::ZERO;
        is_hole.then(|| Spoke { out: side * ring.axis, ring, radius: NECK * far, is_pipe: false })
    };
    let spokes = checked.iter().map(spoke).collect::<Option<Vec<_>>>()?;
    let turned = |spoke: &Spoke| spoke.ring.axis.dot(spoke.out);
    let alike = spokes.iter().all(|spoke| turned(spoke) * turned(&spokes[0]) > 0.0);
    alike.then_some(spokes)
}

/// The point that is nearest to the straight ways of all tubes, and before all loops. `ahead`: the least cosines for a pipe and a sheet.
fn centre(spokes: &[Spoke], ahead: [f64; 2]) -> Option<DVec3> {
    let n = spokes.len() as f64;
    let middle = spokes.iter().map(|spoke| spoke.ring.centre).sum::<DVec3>() / n;
    let (mut matrix, mut right) = (DMat3::from_diagonal(DVec3::splat(DRAWN * n)), DRAWN * n * middle);
    for Spoke { ring, out, .. } in spokes {
        let across = DMat3::IDENTITY - DMat3::from_cols(*out * out.x, *out * out.y, *out * out.z);
        matrix += across;
        right += across * ring.centre;
    }
    let found = matrix.inverse() * right;
    let before = |centre: DVec3| {
        let cosine = |spoke: &Spoke| spoke.out.dot((centre - spoke.ring.centre).normalize_or_zero());
        spokes.iter().all(|spoke| cosine(spoke) >= ahead[usize::from(!spoke.is_pipe)])
    };
    let spread = spokes.iter().map(|spoke| spoke.ring.centre.distance(middle)).fold(0.0, f64::max);
    let lift = (spokes.iter().map(|spoke| spoke.out).sum::<DVec3>() / n).normalize_or_zero();
    let step = |k: usize| middle + lift * (HIGHEST * spread * k as f64 / LIFTS as f64);
    iter::once(found).chain((0..=LIFTS).map(step)).find(|&centre| before(centre))
}

/// Where the circles are, apart from each other.
struct Place {
    /// The way of each tube there.
    ways: Vec<DVec3>,
    /// From the centre.
    distance: f64,
    shrunk: f64,
}

fn place(spokes: &[Spoke], centre: DVec3, limits: &Limits, share: f64) -> Option<Place> {
    let ways = spokes.iter().map(|spoke| {
        let chord = (centre - spoke.ring.centre).normalize_or_zero();
        // As an arc from the loop comes in.
        2.0 * spoke.out.dot(chord) * chord - spoke.out
    });
    let ways = ways.collect::<Vec<_>>();
    // The angles that two circles need between them.
    let needed = |distance: f64, shrunk: f64| {
        move |a: usize, b: usize| {
            let half = |k: usize| libm::atan(shrunk * spokes[k].radius / distance);
            (half(a) + half(b)) / share
        }
    };
    let nearest = spokes.iter().map(|spoke| spoke.ring.centre.distance(centre)).fold(f64::INFINITY, f64::min);
    let most = REACH * nearest;
    if are_apart(&ways, &needed(most, 1.0)) {
        let (mut good, mut bad) = (most, 0.0);
        for _ in 0..30 {
            let middle = 0.5 * (good + bad);
            if are_apart(&ways, &needed(middle, 1.0)) { good = middle } else { bad = middle }
        }
        return Some(Place { ways, distance: good, shrunk: 1.0 });
    }
    let off = spokes.iter().filter(|spoke| spoke.is_pipe);
    let off = off.map(|spoke| spoke.ring.centre.distance(centre) / spoke.radius).collect::<Vec<_>>();
    if limits.keeps_near && off.iter().sum::<f64>() < FAR * off.len() as f64 {
        return None;
    }
    let sizes = iter::successors(Some(1.0), |size| Some(STEP * size));
    sizes.take_while(|&shrunk| shrunk >= limits.smaller).find_map(|shrunk| {
        let spread = spread(&ways, &needed(most, shrunk))?;
        let near = spread.iter().zip(&ways).all(|(a, b)| a.dot(*b) >= limits.spread);
        near.then_some(Place { ways: spread, distance: most, shrunk })
    })
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    libm::acos(a.dot(b).clamp(-1.0, 1.0))
}

fn are_apart(ways: &[DVec3], needed: &impl Fn(usize, usize) -> f64) -> bool {
    (0..ways.len()).all(|b| (0..b).all(|a| angle(ways[a], ways[b]) >= needed(a, b)))
}

/// Turns directions away from each other until there are the needed angles between them.
fn spread(ways: &[DVec3], needed: &impl Fn(usize, usize) -> f64) -> Option<Vec<DVec3>> {
    let mut ways = ways.to_vec();
    for _ in 0..ROUNDS {
        if are_apart(&ways, needed) {
            return Some(ways);
        }
        for b in 0..ways.len() {
            for a in 0..b {
                let lack = OVER * needed(a, b) - angle(ways[a], ways[b]);
                if lack > 0.0 {
                    let [one, other] = [[a, b], [b, a]].map(|[k, from]| {
                        let away = -ways[from].reject_from_normalized(ways[k]);
                        let away = away.try_normalize().unwrap_or(ways[k].any_orthonormal_vector());
                        libm::cos(0.5 * lack) * ways[k] + libm::sin(0.5 * lack) * away
                    });
                    (ways[a], ways[b]) = (one.normalize(), other.normalize());
                }
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spoke(place: DVec3, out: DVec3) -> Spoke {
        let [x, y] = [out.any_orthonormal_vector(), out.cross(out.any_orthonormal_vector())];
        let at = |k: usize| {
            let t = TAU * k as f64 / 12.0;
            place + 0.2 * (t.cos() * x + t.sin() * y)
        };
        Spoke { ring: Ring::new((0..12).map(at).collect()), out, radius: 0.2, is_pipe: true }
    }

    #[test]
    fn the_centre_is_where_straight_ways_meet_and_none_is_behind_a_loop() {
        let there = DVec3::new(0.3, -0.2, 0.5);
        let ways = [DVec3::X, DVec3::new(-0.6, 0.8, 0.0), DVec3::new(0.0, -0.6, 0.8)];
        let spokes = ways.map(|way| spoke(there - 2.0 * way, way));
        let found = centre(&spokes, [0.85, 0.7]).unwrap();
        assert!(found.distance(there) < 0.05, "{found}");
        let away = ways.map(|way| spoke(there + 2.0 * way, way));
        assert!(centre(&away, [0.3, 0.3]).is_none());
    }

    #[test]
    fn above_loops_that_look_the_same_way_the_centre_is_as_low_as_they_may_lean() {
        let places = [DVec3::X, DVec3::new(-0.5, 0.8, 0.0), DVec3::new(-0.5, -0.8, 0.0)];
        let spokes = places.map(|place| spoke(place, DVec3::Z));
        let [low, high] = [0.5, 0.85].map(|least| centre(&spokes, [least, least]).unwrap());
        assert!(0.0 < low.z && low.z < high.z);
        let cosine = (high - places[0]).normalize().z;
        assert!((0.85..0.9).contains(&cosine), "{cosine}");
    }

    #[test]
    fn ways_are_turned_until_they_are_apart_and_no_more_than_that() {
        let ways = [DVec3::X, DVec3::new(1.0, 0.1, 0.0).normalize(), DVec3::new(1.0, 0.0, 0.1).normalize()];
        let needed = |_, _| 0.8;
        let spread = spread(&ways, &needed).unwrap();
        assert!(are_apart(&spread, &needed));
        assert!(spread.iter().all(|way| way.is_normalized() && way.dot(ways[0]) > 0.6), "{spread:?}");
        // Five are not farther apart than a right angle, all of them.
        let five = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y];
        assert!(super::spread(&five, &|_, _| 1.7).is_none());
    }

    #[test]
    fn circles_keep_apart_and_look_at_the_centre() {
        let ways = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y];
        let spokes = ways.map(|way| spoke(-2.0 * way, way));
        let Place { ways: found, distance, shrunk } = place(&spokes, DVec3::ZERO, &STRAIGHT, 0.6).unwrap();
        assert_eq!(shrunk, 1.0);
        assert!(found.iter().zip(ways).all(|(a, b)| a.distance(b) < 1e-9));
        // Half of the share of a right angle.
        assert!((distance - 0.2 / (0.15 * TAU / 2.0).tan()).abs() < 1e-6, "{distance}");
    }
}
