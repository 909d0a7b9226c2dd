//! Moves vertices of thin triangles, along the surface, to where the worst triangle around is rounder.

use glam::DVec3;

use super::local::{Local, quality};

/// Triangles below this quality are worth a move.
const THIN: f64 = 0.7;

/// Rounds over all vertices.
const ROUNDS: usize = 8;

/// Lengths of moves that are tried, in wanted edge lengths.
const STEPS: [f64; 3] = [0.16, 0.08, 0.03];

/// Directions that are tried.
const WAYS: usize = 8;

/// Moves vertices inside, at most a few tenths of an edge; no worst triangle at a vertex gets worse.
pub(crate) fn polish(local: &mut Local) {
    for _ in 0..ROUNDS {
        let mut moved = false;
        for v in local.border as u32..local.positions.len() as u32 {
            moved |= !local.fan(v).is_empty() && improve(local, v);
        }
        if !moved {
            break;
        }
    }
}

/// Moves one vertex; true if that was of use.
pub(crate) fn improve(local: &mut Local, v: u32) -> bool {
    let own = |p: DVec3, t: u32| {
        local.triangles[t as usize].map(|u| if u == v { p } else { local.positions[u as usize] })
    };
    let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
    let p = local.positions[v as usize];
    let sum = local.fan(v).iter().map(|&t| normal(own(p, t))).sum::<DVec3>();
    let Some(up) = sum.try_normalize() else { return false };
    // A triangle that faces away counts as worse than any. What is no better than `least` is not looked at to the end.
    let worst = |p: DVec3, least: f64| {
        let mut worst = f64::INFINITY;
        for &t in local.fan(v) {
            let corners = own(p, t);
            let it = quality(corners);
            worst = worst.min(if normal(corners).dot(up) > 0.0 { it } else { -it });
            if worst <= least {
                break;
            }
        }
        worst
    };
    let before = worst(p, f64::NEG_INFINITY);
    if before > THIN {
        return false;
    }
    let (e, f) = up.any_orthonormal_pair();
    let size = local.sizes[v as usize];
    let mut best = (before + 1e-3, p);
    for step in STEPS {
        for way in 0..WAYS {
            let t = std::f64::consts::TAU * way as f64 / WAYS as f64;
            let there = p + step * size * (libm::cos(t) * e + libm::sin(t) * f);
            let found = worst(there, best.0);
            if found > best.0 {
                best = (found, there);
            }
        }
    }
    local.positions[v as usize] = best.1;
    best.1 != p
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vertex_off_the_middle_comes_back() {
        let mut positions = (0..6)
            .map(|k| DVec3::new((f64::from(k) * 1.05).cos(), (f64::from(k) * 1.05).sin(), 0.0))
            .collect::<Vec<_>>();
        positions.push(DVec3::new(0.8, 0.1, 0.0));
        let triangles = (0..6).map(|k| [6, k, (k + 1) % 6]).collect::<Vec<_>>();
        let mut local = Local::new(positions, triangles, vec![0; 6], 6);
        local.sizes.fill(1.0);
        polish(&mut local);
        let centre = local.positions[6];
        assert!(centre.length() < 0.6 && centre.z == 0.0, "{centre}");
        assert!((0..6).all(|t| quality(local.corners(t)) > 0.65));
    }
}
