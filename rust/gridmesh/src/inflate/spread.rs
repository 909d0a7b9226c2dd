//! Slides vertices along the lifted surface until its triangles are even.

use glam::{DVec2, DVec3};

use super::field::{Field, Place};
use crate::patch::Loop;

/// Turning angle in radians from which on a corner of the outline is re-entrant enough for a crease.
const RE_ENTRANT: f64 = 0.5;

/// The front of a body: a graph over the flat patch.
pub(crate) struct Front {
    /// Positions in the plane; the boundary's are the patch's.
    pub flat: Vec<DVec2>,
    /// Heights, zero on the boundary, positive inside.
    pub height: Vec<f64>,
    /// Where each interior vertex lies in the flat patch, from `first` on.
    pub place: Vec<Place>,
    /// First interior vertex.
    pub first: usize,
    /// Moves that were shortened so that no triangle of the projection turned over.
    pub shortened: usize,
}

impl Front {
    /// The lifted patch, no vertex moved sideways.
    pub fn new(field: &Field<'_>, first: usize) -> Self {
        let mut place = vec![Place { triangle: 0, weights: [0.0; 3] }; field.vertices.len() - first];
        for (t, corners) in field.triangles.iter().enumerate() {
            for k in 0..3 {
                if let Some(slot) = (corners[k] as usize).checked_sub(first) {
                    place[slot].triangle = t as u32;
                    place[slot].weights = [0.0; 3];
                    place[slot].weights[k] = 1.0;
                }
            }
        }
        let height = field.value.iter().map(|f| f.sqrt()).collect();
        Front { flat: field.vertices.to_vec(), height, place, first, shortened: 0 }
    }

    fn position(&self, v: usize) -> DVec3 {
        self.flat[v].extend(self.height[v])
    }
}

/// Slides every vertex down the slope of the field to where the lifted surface nearly keeps the
/// angles of the flat patch.
///
/// Stereographic projection sends the squared height `f` of a sphere of radius `R` to
/// `f (1 - t) / (1 + t)^2`, where `t = 1 - f / R^2` is also `s^2 / (f + s^2)` with `s` half the slope
/// of `f`: so read it needs no circle, and at the silhouette of any drawing the height becomes the
/// distance from it. In a limb, which is stretched across only, vertices move less: `limb` is 0
/// where the surface is round and 1 in a limb.
pub(crate) fn unrolled_heights(field: &Field<'_>, limb: &[f64]) -> Vec<f64> {
    let height = |v: usize| {
        let half = 0.25 * field.gradient[v].length_squared();
        let t = half / (field.value[v] + half);
        let k = 3.0 - 1.7 * limb[v];
        (field.value[v] * (1.0 - t) / (1.0 + (k - 1.0) * t + (4.0 - k) * t * t)).sqrt()
    };
    (0..field.value.len()).map(|v| if field.value[v] > 0.0 { height(v) } else { 0.0 }).collect()
}

/// Slides every vertex down the slope by `share` of the way from its height to `goal`.
pub(crate) fn slide(
    front: &mut Front,
    field: &Field<'_>,
    goal: &[f64],
    crease: &[Option<Crease>],
    share: f64,
    depth: f64,
    least_area: f64,
) {
    let first = front.first;
    let target = (first..front.flat.len())
        .map(|v| {
            let height = front.height[v] + share * (goal[v] - front.height[v]);
            let (mut point, mut place) = (front.flat[v], front.place[v - first]);
            if let Some(crease) = &crease[v] {
                let away = point - crease.corner;
                let onto = crease.corner + crease.inward * away.dot(crease.inward);
                let next = point + share * (onto - point);
                if let Some(found) = field.locate(next, place.triangle) {
                    (point, place) = (next, found);
                }
            }
            for _ in 0..2 {
                let (value, gradient) = field.at(point, place);
                let direction = match &crease[v] {
                    Some(crease) => crease.corner - point,
                    None => -gradient,
                };
                let direction = direction.normalize_or_zero();
                let slope = -gradient.dot(direction);
                let fall = value - height * height;
                // The root near zero of fall = slope s + bend s^2; a sphere's field bends so.
                let root = slope * slope + 4.0 * depth * depth * fall;
                if !(slope > 0.0 && root > 0.0) {
                    break;
                }
                let mut way = 2.0 * fall / (slope + root.sqrt());
                if let Some(crease) = &crease[v] {
                    way = way.min(0.9 * (crease.corner - point).length());
                }
                let next = point + direction * way;
                let Some(found) = field.locate(next, place.triangle) else { break };
                (point, place) = (next, found);
            }
            point
        })
        .collect::<Vec<_>>();
    settle(front, field, &target, least_area);
}

/// Where the body has a crease above a re-entrant corner of the outline.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crease {
    corner: DVec2,
    inward: DVec2,
    cos_limit: f64,
}

impl Crease {
    /// Whether the two sides of the corner are both seen from `point`.
    fn holds(&self, point: DVec2) -> bool {
        let away = point - self.corner;
        away.dot(self.inward) >= self.cos_limit * away.length()
    }
}

/// For each vertex the re-entrant corner that it is to stand above, if any.
///
/// Above such a corner the body has a crease. A mesh that is a graph over the drawing follows it
/// only if one of the corner's neighbours lies on it: the innermost one is chosen.
pub(crate) fn creases(field: &Field<'_>, loops: &[Loop], first: usize) -> Vec<Option<Crease>> {
    let mut creases = vec![None; field.vertices.len()];
    for contour in loops {
        let (start, n) = (contour.start as usize, contour.len());
        for k in 0..n {
            let corner = field.vertices[start + k];
            let to_next = (field.vertices[start + (k + 1) % n] - corner).normalize_or_zero();
            let to_previous = (field.vertices[start + (k + n - 1) % n] - corner).normalize_or_zero();
            let turn = (-to_previous).angle_to(to_next);
            if turn > -tune().crease {
                continue;
            }
            let inward = (-to_next - to_previous).try_normalize().unwrap_or(to_next.perp());
            let inner = field.topology.near[field.topology.range(start + k)]
                .iter()
                .map(|&v| v as usize)
                .filter(|&v| v >= first)
                .map(|v| (v, (field.vertices[v] - corner).normalize_or_zero().dot(inward)))
                .reduce(|best, other| if other.1 > best.1 { other } else { best });
            let cos_limit = to_next.dot(inward).abs();
            if let Some((v, _)) = inner {
                creases[v] = Some(Crease { corner, inward, cos_limit });
            }
        }
    }
    creases
}

/// The point of the plane below the foot of `point` on the surface `z^2 = field`.
fn project(field: &Field<'_>, point: DVec3, triangle: u32) -> Option<DVec2> {
    let mut point = point;
    let mut triangle = triangle;
    for _ in 0..2 {
        let place = field.locate(point.truncate(), triangle)?;
        triangle = place.triangle;
        let (value, gradient) = field.at(point.truncate(), place);
        let slope = (-gradient).extend(2.0 * point.z);
        point -= (point.z * point.z - value) / slope.length_squared().max(f64::MIN_POSITIVE) * slope;
    }
    field.locate(point.truncate(), triangle).map(|_| point.truncate())
}

/// Moves the vertices in the plane as far towards `target` as the triangles allow.
fn settle(front: &mut Front, field: &Field<'_>, target: &[DVec2], least_area: f64) {
    const HALVINGS: u32 = 6;
    let first = front.first;
    let n = target.len();
    let mut share = vec![1.0; n];
    let mut flat = front.flat.clone();
    let mut place = front.place.clone();
    let mut moved: Vec<u32> = (0..n as u32).collect();
    for round in 0.. {
        for &slot in &moved {
            let slot = slot as usize;
            let v = first + slot;
            (flat[v], place[slot]) = (front.flat[v], front.place[slot]);
            if share[slot] > 0.0 {
                let wanted = front.flat[v].lerp(target[slot], share[slot]);
                if let Some(found) = field.locate(wanted, front.place[slot].triangle) {
                    (flat[v], place[slot]) = (wanted, found);
                }
            }
        }
        let mut bad = vec![];
        for corners in field.triangles {
            let [a, b, c] = corners.map(|v| flat[v as usize]);
            if (b - a).perp_dot(c - a) >= least_area {
                continue;
            }
            bad.extend(
                corners.iter().filter_map(|&v| (v as usize).checked_sub(first)).map(|slot| slot as u32),
            );
        }
        bad.sort_unstable();
        bad.dedup();
        bad.retain(|&slot| share[slot as usize] > 0.0);
        if bad.is_empty() {
            break;
        }
        for &slot in &bad {
            let share = &mut share[slot as usize];
            *share = if round < HALVINGS { 0.5 * *share } else { 0.0 };
        }
        front.shortened += bad.len();
        moved = bad;
    }
    for slot in 0..n {
        front.height[first + slot] = field.at(flat[first + slot], place[slot]).0.sqrt();
    }
    front.flat = flat;
    front.place = place;
}

/// One sweep over the vertices, each moved along the surface to where its triangles are best.
///
/// A triangle's badness is the sum of its squared sides over its area, both seen in the tangent
/// plane of the vertex: convex in the vertex's position there. One Newton step, weighted by the
/// badness itself so that the worst triangles count most, is taken and shortened until no triangle
/// falls below `least_area` in projection.
pub(crate) fn sweep(front: &mut Front, field: &Field<'_>, creases: &[Option<Crease>], least_area: f64) {
    for v in front.first..front.flat.len() {
        let slot = v - front.first;
        let (_, gradient) = field.at(front.flat[v], front.place[slot]);
        let normal = (-gradient).extend(2.0 * front.height[v]).normalize_or(DVec3::Z);
        let (e, f) = normal.any_orthonormal_pair();
        let here = front.position(v);
        let fan = field.topology.fan(v);
        let mut slope = DVec2::ZERO;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        let mut reach = 0.0;
        for &[i, j] in fan {
            let (a, b) = (front.position(i as usize) - here, front.position(j as usize) - here);
            reach += a.length();
            let mut sides = a.length_squared() + b.length_squared() + (b - a).length_squared();
            let cross = a.cross(b);
            let mut area = cross.length();
            let mut facing = cross / area;
            if !(cross.dot(normal) > tune().steep * area) {
                // Folded: seen in the tangent plane, where it has to unfold.
                facing = normal;
                area = cross.dot(normal);
            }
            area = area.max(tune().floor * sides);
            let widen = (a - b).cross(facing);
            let mut ds = -2.0 * (a + b);
            let mut extra = DVec2::ZERO;
            if (i as usize) < front.first && (j as usize) < front.first {
                // Triangles on the silhouette are to be flatter, see above.
                let m = widen.normalize_or_zero();
                let height = a.dot(m);
                sides += tune().flatter * height * height;
                ds -= 2.0 * tune().flatter * height * m;
                extra = (2.0 * tune().flatter).sqrt() * DVec2::new(m.dot(e), m.dot(f));
            }
            let ds = DVec2::new(ds.dot(e), ds.dot(f));
            let da = DVec2::new(widen.dot(e), widen.dot(f));
            let weight = (sides / area / 3.46).powf(tune().power);
            slope += weight * (ds - da * (sides / area)) / area;
            let k = weight / area;
            let (m, n) = (1.0 / area, 2.0 * sides / (area * area));
            xx += k * (4.0 + extra.x * extra.x - 2.0 * m * ds.x * da.x + n * da.x * da.x);
            yy += k * (4.0 + extra.y * extra.y - 2.0 * m * ds.y * da.y + n * da.y * da.y);
            xy += k * (extra.x * extra.y - m * (ds.x * da.y + ds.y * da.x) + n * da.x * da.y);
        }
        let determinant = xx * yy - xy * xy;
        if !(determinant > 0.0) {
            continue;
        }
        let u = -DVec2::new(yy * slope.x - xy * slope.y, xx * slope.y - xy * slope.x) / determinant;
        let u = u.clamp_length_max(0.5 * reach / fan.len() as f64);
        let Some(target) = project(field, here + u.x * e + u.y * f, front.place[slot].triangle) else {
            continue;
        };
        let before = worst(front, fan, here);
        let mut share = 1.0;
        for _ in 0..4 {
            let point = front.flat[v].lerp(target, share);
            let fits = creases[v]
                .as_ref()
                .is_none_or(|crease| crease.holds(point) || !crease.holds(front.flat[v]))
                && fan.iter().all(|&[a, b]| {
                    (front.flat[a as usize] - point).perp_dot(front.flat[b as usize] - point) >= least_area
                });
            if fits {
                let Some(place) = field.locate(point, front.place[slot].triangle) else { break };
                let height = field.at(point, place).0.sqrt();
                let after = worst(front, fan, point.extend(height));
                if after >= before || after > tune().good {
                    front.flat[v] = point;
                    front.place[slot] = place;
                    front.height[v] = height;
                    break;
                }
            } else {
                front.shortened += 1;
            }
            share *= 0.5;
        }
    }
}

/// Least ratio of twice the area to the sum of the squared sides of the triangles around a vertex at
/// `point`; 0.29 if they are equilateral.
fn worst(front: &Front, fan: &[[u32; 2]], point: DVec3) -> f64 {
    let ratio = |&[a, b]: &[u32; 2]| {
        let (a, b) = (front.position(a as usize) - point, front.position(b as usize) - point);
        a.cross(b).length() / (a.length_squared() + b.length_squared() + (b - a).length_squared())
    };
    fan.iter().map(ratio).fold(f64::INFINITY, f64::min)
}

pub(crate) struct Tune {
    pub steep: f64,
    pub floor: f64,
    pub flatter: f64,
    pub crease: f64,
    pub legs: usize,
    pub between: usize,
    pub sweeps: usize,
    pub good: f64,
    pub power: f64,
}
pub(crate) fn tune() -> &'static Tune {
    static T: std::sync::OnceLock<Tune> = std::sync::OnceLock::new();
    fn g<T: std::str::FromStr>(n: &str, d: T) -> T {
        std::env::var(n).ok().and_then(|s| s.parse().ok()).unwrap_or(d)
    }
    T.get_or_init(|| Tune {
        steep: g("STEEP", 0.2),
        floor: g("FLOOR", 0.02),
        flatter: g("FLATTER", 1.25),
        crease: g("CREASE", 0.5),
        legs: g("LEGS", 3),
        between: g("BETWEEN", 1),
        sweeps: g("SWEEPS", 3),
        good: g("GOOD", 0.2),
        power: g("POWER", 1.0),
    })
}
