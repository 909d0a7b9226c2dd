//! Harmonic functions on triangle meshes in space, with given values at some of the vertices.

use glam::DVec3;

use super::cholesky::Pattern;
use super::disjoint::Disjoint;
use crate::error::{Error, Result};
use crate::progress::Progress;

/// In triangles whose doubled area is a smaller share of their squared sides, edges have the same weights. Cotangents above
/// its inverse would be lost to rounding beside those of other triangles.
const THINNEST: f64 = 1e-6;

/// Replaces the values of the vertices `free` by harmonic ones: those with the least Dirichlet energy for the values of the
/// others, by linear finite elements (cotangent weights). On a flat mesh what is linear at the fixed vertices is linear everywhere.
///
/// `values` has `columns` numbers for each vertex, row by row. New values are kept within the range of those of the
/// triangles' fixed vertices, which a harmonic function may leave by a little where triangles are obtuse. Free vertices
/// that no chain of edges joins to a fixed one keep their values. O(n log n) in practice.
///
/// # Errors
/// [`Error::IndexOutOfRange`] if a triangle or `free` names a vertex that does not exist; [`Error::NotFinite`] for positions
/// and values at fixed vertices; [`Error::Solver`].
///
/// Source: Pinkall and Polthier, *Computing Discrete Minimal Surfaces and Their Conjugates*, 1993.
pub fn harmonic(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    free: &[u32],
    values: &mut [f64],
    columns: usize,
) -> Result<()> {
    let n = vertices.len();
    if let Some(point) = vertices.iter().position(|p| !p.is_finite()) {
        return Err(Error::NotFinite { what: "mesh".to_owned(), point });
    }
    let unknown = unknowns(n, triangles, free)?;
    let edges = weighted_edges(vertices, triangles, &unknown);
    let n_free = unknown.iter().flatten().count();
    if n_free == 0 || columns == 0 {
        return Ok(());
    }
    for (v, row) in values.chunks_exact(columns).enumerate() {
        if unknown[v].is_none() && row.iter().any(|x| !x.is_finite()) {
            return Err(Error::NotFinite { what: "values".to_owned(), point: v });
        }
    }
    let (mut col_ptr, mut row_idx) = (vec![0], Vec::new());
    let mut upper: Vec<(usize, usize, f64)> = Vec::new();
    let mut diagonal = vec![0.0; n_free];
    let mut rhs = vec![0.0; n_free * columns];
    for &(i, v, weight) in &edges {
        diagonal[i] += weight;
        match unknown[v as usize] {
            Some(j) if j < i => upper.push((i, j, -weight)),
            Some(_) => {}
            None => {
                for c in 0..columns {
                    rhs[c * n_free + i] += weight * values[v as usize * columns + c];
                }
            }
        }
    }
    let mut entries = Vec::with_capacity(upper.len() + n_free);
    let mut rest = upper.as_slice();
    for (i, &sum) in diagonal.iter().enumerate() {
        let (row, after) = rest.split_at(rest.partition_point(|e| e.0 <= i));
        rest = after;
        for &(_, j, weight) in row {
            row_idx.push(j);
            entries.push(weight);
        }
        row_idx.push(i);
        entries.push(sum);
        col_ptr.push(row_idx.len());
    }
    Pattern::new("extension", col_ptr, row_idx, Progress::NONE)?
        .factor(entries, Progress::NONE)?
        .solve(&mut rhs, columns)?;
    write_back(triangles, &unknown, &rhs, values, columns);
    Ok(())
}

/// Numbers of the free vertices that a chain of edges joins to a fixed one.
fn unknowns(n: usize, triangles: &[[u32; 3]], free: &[u32]) -> Result<Vec<Option<usize>>> {
    let check = |what: &str, index: u32| {
        if (index as usize) < n {
            Ok(())
        } else {
            Err(Error::IndexOutOfRange { what: what.to_owned(), index: index as i32, vertices: n })
        }
    };
    triangles.iter().flatten().try_for_each(|&v| check("triangles", v))?;
    free.iter().try_for_each(|&v| check("free", v))?;
    let mut is_free = vec![false; n];
    free.iter().for_each(|&v| is_free[v as usize] = true);
    let mut sets = Disjoint::new(n);
    for t in triangles {
        for k in 0..3 {
            sets.join(t[k], t[(k + 1) % 3]);
        }
    }
    let mut is_held = vec![false; n];
    for &v in triangles.iter().flatten().filter(|&&v| !is_free[v as usize]) {
        is_held[sets.root(v) as usize] = true;
    }
    let mut count = 0;
    let mut number = |v: usize| {
        (is_free[v] && is_held[sets.root(v as u32) as usize]).then(|| {
            count += 1;
            count - 1
        })
    };
    Ok((0..n).map(&mut number).collect())
}

/// For each edge from an unknown its number, the vertex at the other end and the cotangent weight; sorted.
fn weighted_edges(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    unknown: &[Option<usize>],
) -> Vec<(usize, u32, f64)> {
    let mut edges: Vec<(usize, u32, f64)> = Vec::new();
    for t in triangles {
        let [p, q, o] = t.map(|v| vertices[v as usize]);
        let doubled = (q - p).cross(o - p).length();
        let squared = p.distance_squared(q) + q.distance_squared(o) + o.distance_squared(p);
        let is_thin = doubled <= THINNEST * squared;
        for k in 0..3 {
            let [a, b, opposite] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
            let [p, q, o] = [a, b, opposite].map(|v| vertices[v as usize]);
            let weight = if is_thin { 1.0 } else { (p - o).dot(q - o) / doubled };
            edges.extend(unknown[a as usize].map(|i| (i, b, weight)));
            edges.extend(unknown[b as usize].map(|i| (i, a, weight)));
        }
    }
    // Stable, so that the weights of an edge are added in the order of its triangles.
    edges.sort_by_key(|&(i, v, _)| (i, unknown[v as usize].map_or(usize::MAX, |j| j), v));
    edges.dedup_by(|next, kept| {
        let is_same = (next.0, next.1) == (kept.0, kept.1);
        if is_same {
            kept.2 += next.2;
        }
        is_same
    });
    edges
}

/// Puts the solution in, within the range of the fixed vertices.
fn write_back(
    triangles: &[[u32; 3]],
    unknown: &[Option<usize>],
    solution: &[f64],
    values: &mut [f64],
    columns: usize,
) {
    let n_free = solution.len() / columns;
    let fixed: Vec<u32> =
        triangles.iter().flatten().copied().filter(|&v| unknown[v as usize].is_none()).collect();
    for c in 0..columns {
        let of_fixed = fixed.iter().map(|&v| values[v as usize * columns + c]);
        let (low, high) =
            of_fixed.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        for (v, i) in unknown.iter().enumerate() {
            if let Some(i) = i {
                values[v * columns + c] = solution[c * n_free + i].max(low).min(high);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of `n` by `n` cells, and its inner vertices.
    fn square(n: u32) -> (Vec<DVec3>, Vec<[u32; 3]>, Vec<u32>) {
        let at = |i: u32, j: u32| i * (n + 1) + j;
        let points = |k: u32| DVec3::new(f64::from(k / (n + 1)), f64::from(k % (n + 1)), 0.0);
        let mut triangles = Vec::new();
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
        let inner = (1..n).flat_map(|i| (1..n).map(move |j| at(i, j))).collect();
        ((0..(n + 1) * (n + 1)).map(points).collect(), triangles, inner)
    }

    #[test]
    fn what_is_linear_at_the_rim_is_linear_inside() {
        let (vertices, triangles, inner) = square(9);
        let exact: Vec<f64> = vertices.iter().flat_map(|p| [3.0 * p.x - p.y, p.x + 2.0]).collect();
        let mut values = exact.clone();
        inner.iter().for_each(|&v| values[2 * v as usize..][..2].fill(-99.0));
        harmonic(&vertices, &triangles, &inner, &mut values, 2).unwrap();
        assert!(values.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    #[test]
    fn values_stay_within_those_of_the_rim() {
        let (mut vertices, triangles, inner) = square(6);
        for (k, p) in vertices.iter_mut().enumerate() {
            p.z = 4.0 * (k as f64 * 1.7).sin();
        }
        let mut values: Vec<f64> = (0..vertices.len()).map(|k| (k % 2) as f64).collect();
        harmonic(&vertices, &triangles, &inner, &mut values, 1).unwrap();
        assert!(values.iter().all(|x| (0.0..=1.0).contains(x)));
        assert!(inner.iter().any(|&v| values[v as usize] > 0.05 && values[v as usize] < 0.95));
    }

    #[test]
    fn triangles_without_area_are_no_obstacle() {
        let (mut vertices, triangles, inner) = square(6);
        let at = |i: usize, j: usize| i * 7 + j;
        vertices[at(2, 2)] = vertices[at(2, 3)];
        vertices[at(4, 4)] = vertices[at(5, 4)].lerp(vertices[at(4, 3)], 0.5); // on an edge of another triangle
        for k in 1..6 {
            vertices[at(k, 5)] = vertices[at(3, 5)] + DVec3::X * (k as f64 * 1e-9);
        }
        let mut values: Vec<f64> = (0..vertices.len()).map(|k| (k / 7) as f64).collect();
        inner.iter().for_each(|&v| values[v as usize] = -99.0);
        harmonic(&vertices, &triangles, &inner, &mut values, 1).unwrap();
        assert!(values.iter().all(|x| (0.0..=6.0).contains(x)));
        let within = [at(1, 1), at(3, 2), at(5, 3)].map(|v| values[v]);
        assert!(within[0] + 0.5 < within[1] && within[1] + 0.5 < within[2], "{within:?}");
    }

    #[test]
    fn without_a_rim_nothing_changes_and_bad_numbers_are_named() {
        let (vertices, triangles, _) = square(2);
        let all: Vec<u32> = (0..vertices.len() as u32).collect();
        let mut values = vec![7.0; vertices.len()];
        harmonic(&vertices, &triangles, &all, &mut values, 1).unwrap();
        assert_eq!(values, vec![7.0; vertices.len()]);
        let wrong = harmonic(&vertices, &triangles, &[99], &mut values, 1).unwrap_err();
        assert_eq!(wrong.kind(), "index_out_of_range");
    }
}
