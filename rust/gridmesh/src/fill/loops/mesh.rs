//! The part of a mesh that a fill has to know: the triangles around its loops.

use rayon::prelude::*;

use crate::error::{Error, Result};

/// Triangles looked at by one thread at a time.
pub(crate) const CHUNK: usize = 1 << 16;

/// The triangles within some rings of given vertices, with vertices renumbered.
///
/// Triangles that repeat a vertex are left out: they have no area and no sides. Edges that they have are kept
/// apart, so that no patch repeats one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rim {
    /// Vertex numbers in the mesh, ascending; the place is the number here.
    pub ids: Vec<u32>,
    /// Triangles in the order of the mesh, with vertices as numbered here.
    pub triangles: Vec<[u32; 3]>,
    /// Their numbers in the mesh.
    pub numbers: Vec<u32>,
    /// Edges of triangles that repeat a vertex, by their numbers in the mesh.
    pub loose: Vec<[u32; 2]>,
    start: Vec<u32>,
    incident: Vec<u32>,
}

impl Rim {
    /// Collects all triangles that touch `seeds` or, for each further ring, a vertex of those
    /// collected before. Linear in the mesh, with a byte of memory for each of its vertices.
    ///
    /// # Errors
    /// [`Error::IndexOutOfRange`] if any triangle of the mesh or a seed names a vertex that does not
    /// exist.
    pub fn new(n_vertices: usize, triangles: &[[u32; 3]], seeds: &[u32], rings: usize) -> Result<Self> {
        let mut marked = vec![false; n_vertices];
        for &seed in seeds {
            match marked.get_mut(seed as usize) {
                Some(mark) => *mark = true,
                None => {
                    return Err(Error::IndexOutOfRange {
                        what: "loop".into(),
                        index: seed as i32,
                        vertices: n_vertices,
                    });
                }
            }
        }
        let mut found = touching(&marked, triangles)?;
        for _ in 1..rings {
            for v in found.iter().flat_map(|&t| triangles[t as usize]) {
                marked[v as usize] = true;
            }
            found = touching(&marked, triangles)?;
        }
        let mut loose = vec![];
        found.retain(|&t| {
            let t @ [a, b, c] = &triangles[t as usize];
            if repeats(t) {
                // Of such a triangle two corners differ, or none.
                loose.extend([[*a, *b], [*b, *c]].into_iter().find(|[u, v]| u != v));
            }
            !repeats(t)
        });
        Self::of(found.iter().map(|&t| triangles[t as usize]).collect(), found, loose)
    }

    /// All of the given triangles.
    fn of(mut triangles: Vec<[u32; 3]>, numbers: Vec<u32>, loose: Vec<[u32; 2]>) -> Result<Self> {
        let mut ids = triangles.iter().flatten().copied().collect::<Vec<_>>();
        ids.sort_unstable();
        ids.dedup();
        for corner in triangles.iter_mut().flatten() {
            *corner = place(&ids, *corner)? as u32;
        }
        let mut start = vec![0u32; ids.len() + 1];
        for &v in triangles.iter().flatten() {
            start[v as usize + 1] += 1;
        }
        for v in 0..ids.len() {
            start[v + 1] += start[v];
        }
        let mut fill = start.clone();
        let mut incident = vec![0; 3 * triangles.len()];
        for (t, corners) in triangles.iter().enumerate() {
            for &v in corners {
                incident[fill[v as usize] as usize] = t as u32;
                fill[v as usize] += 1;
            }
        }
        Ok(Rim { ids, triangles, numbers, loose, start, incident })
    }

    /// The number here of a vertex of the mesh, if it belongs to a triangle here.
    pub fn local(&self, id: u32) -> Option<u32> {
        self.ids.binary_search(&id).ok().map(|v| v as u32)
    }

    /// The triangles at a vertex, both as numbered here. Complete for the seeds and, with more rings,
    /// for all vertices but those of the last.
    pub fn around(&self, v: u32) -> &[u32] {
        &self.incident[self.start[v as usize] as usize..self.start[v as usize + 1] as usize]
    }

    /// The neighbours of a vertex (numbered here), ascending.
    pub fn neighbours(&self, v: u32) -> Vec<u32> {
        let mut near = self.around(v).iter().flat_map(|&t| self.triangles[t as usize]).collect::<Vec<_>>();
        near.sort_unstable();
        near.dedup();
        near.retain(|&u| u != v);
        near
    }
}

/// Numbers of the triangles with a marked vertex, ascending.
fn touching(marked: &[bool], triangles: &[[u32; 3]]) -> Result<Vec<u32>> {
    let scan = |(part, chunk): (usize, &[[u32; 3]])| {
        let mut found = vec![];
        for (k, t) in chunk.iter().enumerate() {
            let mut touches = false;
            for &v in t {
                match marked.get(v as usize) {
                    Some(&mark) => touches |= mark,
                    None => {
                        return Err(Error::IndexOutOfRange {
                            what: format!("triangle {}", part * CHUNK + k),
                            index: v as i32,
                            vertices: marked.len(),
                        });
                    }
                }
            }
            if touches {
                found.push((part * CHUNK + k) as u32);
            }
        }
        Ok(found)
    };
    let mut all = vec![];
    for part in in_chunks(triangles, scan) {
        all.append(&mut part?);
    }
    Ok(all)
}

/// What `scan` makes of each chunk of `triangles`, given with its number, in order; in parallel if there
/// are several.
pub(crate) fn in_chunks<T: Send>(
    triangles: &[[u32; 3]],
    scan: impl Fn((usize, &[[u32; 3]])) -> T + Send + Sync,
) -> Vec<T> {
    if triangles.len() <= CHUNK {
        // To wake the other threads takes longer.
        return vec![scan((0, triangles))];
    }
    triangles.par_chunks(CHUNK).enumerate().map(scan).collect()
}

/// Where a number is in an ascending list that has it.
pub(crate) fn place(numbers: &[u32], number: u32) -> Result<usize> {
    numbers.binary_search(&number).map_err(|_| Error::Internal { reason: "a vertex was not collected" })
}

/// True if a triangle names a vertex twice.
pub(crate) fn repeats(t: &[u32; 3]) -> bool {
    t[0] == t[1] || t[1] == t[2] || t[2] == t[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_grow() {
        // A strip of triangles: vertex i meets i + 1 and i + 2.
        let strip = (0..20u32).map(|i| [i, i + 1, i + 2]).collect::<Vec<_>>();
        let rim = Rim::new(22, &strip, &[10], 1).unwrap();
        assert_eq!(rim.ids, [8, 9, 10, 11, 12]);
        assert_eq!(rim.triangles, [[0, 1, 2], [1, 2, 3], [2, 3, 4]]);
        assert_eq!(rim.neighbours(rim.local(10).unwrap()), [0, 1, 3, 4]);
        assert_eq!(Rim::new(22, &strip, &[10], 2).unwrap().ids, (6..15).collect::<Vec<_>>());
        assert_eq!(rim.local(3), None);
        let folded = [strip.as_slice(), &[[10, 10, 3], [4, 5, 4], [7, 10, 7], [10, 10, 10]]].concat();
        let rim = Rim::new(22, &folded, &[10], 1).unwrap();
        assert_eq!((rim.triangles.len(), &rim.loose[..]), (3, &[[10, 3], [7, 10]][..]));
        let wrong = Rim::new(21, &strip, &[10], 1).unwrap_err();
        assert_eq!(wrong.kind(), "index_out_of_range");
        assert!(wrong.to_string().contains("triangle 19"), "{wrong}");
    }
}
