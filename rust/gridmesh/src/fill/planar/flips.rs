//! Edge flips that make valences regular.

use glam::DVec2;
use rustc_hash::FxHashMap;

use crate::error::Result;
use crate::progress::Progress;

/// Flips edges while that brings valences nearer to six (inside) or to what the loop's vertices
/// want, and leaves no sharp triangle. No new edge between loop vertices is one that is taken.
pub(in crate::fill) fn improve_valences(
    positions: &[DVec2],
    triangles: &mut [[u32; 3]],
    wanted: &[i32],
    taken: &dyn Fn(usize, usize) -> bool,
    progress: Progress<'_>,
) -> Result<()> {
    const ASK_EVERY: usize = 1 << 13;
    let n = wanted.len();
    let mut owner: FxHashMap<(u32, u32), u32> = FxHashMap::default();
    let mut valence = vec![0i32; positions.len()];
    valence[..n].fill(1);
    for (i, t) in triangles.iter().enumerate() {
        for k in 0..3 {
            owner.insert((t[k], t[(k + 1) % 3]), i as u32);
            valence[t[k] as usize] += 1;
        }
    }
    let ideal = |v: u32| wanted.get(v as usize).copied().unwrap_or(6);
    for _ in 0..8 {
        let mut flips = 0;
        for i in 0..triangles.len() {
            if i % ASK_EVERY == 0 {
                progress.report(0.0)?;
            }
            for k in 0..3 {
                let (a, b, c) = (triangles[i][k], triangles[i][(k + 1) % 3], triangles[i][(k + 2) % 3]);
                let Some(&j) = owner.get(&(b, a)) else { continue };
                let Some(d) = triangles[j as usize].into_iter().find(|&v| v != a && v != b) else { continue };
                if owner.contains_key(&(c, d)) || owner.contains_key(&(d, c)) {
                    continue;
                }
                let (low, high) = (c.min(d) as usize, c.max(d) as usize);
                if high < n && taken(low, high) {
                    continue;
                }
                let off = |v: u32, by: i32| (valence[v as usize] + by - ideal(v)).pow(2);
                let now = off(a, 0) + off(b, 0) + off(c, 0) + off(d, 0);
                let then = off(a, -1) + off(b, -1) + off(c, 1) + off(d, 1);
                let can_spare = |v: u32| valence[v as usize] > if (v as usize) < n { 2 } else { 4 };
                if then >= now || !can_spare(a) || !can_spare(b) {
                    continue;
                }
                let [pa, pb, pc, pd] = [a, b, c, d].map(|v| positions[v as usize]);
                let before = shape(pa, pb, pc).min(shape(pb, pa, pd));
                let after = shape(pa, pd, pc).min(shape(pd, pb, pc));
                if after < 0.45 && after < before {
                    continue;
                }
                for edge in [(a, b), (b, a)] {
                    owner.remove(&edge);
                }
                triangles[i] = [a, d, c];
                triangles[j as usize] = [d, b, c];
                for (t, [x, y, z]) in [(i as u32, [a, d, c]), (j, [d, b, c])] {
                    owner.insert((x, y), t);
                    owner.insert((y, z), t);
                    owner.insert((z, x), t);
                }
                valence[a as usize] -= 1;
                valence[b as usize] -= 1;
                valence[c as usize] += 1;
                valence[d as usize] += 1;
                flips += 1;
                break;
            }
        }
        if flips == 0 {
            break;
        }
    }
    Ok(())
}

/// Area by squared edges: one for an equilateral triangle, negative if inverted.
pub(in crate::fill) fn shape(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let edges = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
    (b - a).perp_dot(c - a) * 2.0 * 3f64.sqrt() / edges.max(1e-300)
}
