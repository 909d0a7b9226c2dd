//! A patch of triangles for every second vertex of a loop, each cut into three quads: for loops that no lattice fits.
//!
//! The vertices between lie where the edges of the triangles at the loop are cut. An odd loop keeps one edge of two
//! neighbours of the triangles' loop whole: the triangle there becomes a quad and the odd triangle.

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::cells::Cells;
use crate::error::{Error, Result};
use crate::fill::planar::flat::{FlatOptions, fill_flat};
use crate::progress::Progress;

/// Badness beyond which such patches are tried.
pub(super) const WORSE: f64 = 4.0;

/// Loops of fewer vertices get a row of quads first, so that no edge joins two of them.
const SMALL: usize = 12;

/// Patches that leave out the odd or the even vertices, or, of an odd loop, with the triangle at its longest edge.
pub(super) fn candidates(points: &[DVec2], wanted: &[f64], progress: Progress<'_>) -> Result<Vec<Cells>> {
    let n = points.len();
    let length = |k: &usize| points[*k].distance(points[(k + 1) % n]);
    let whole = (0..n).max_by(|a, b| length(a).total_cmp(&length(b)).then(b.cmp(a))).unwrap_or(0);
    let starts = if n.is_multiple_of(2) { vec![0, 1] } else { vec![(whole + 1) % n] };
    let mut found = vec![];
    for start in starts {
        let coarse: Vec<usize> = (0..n.div_ceil(2)).map(|k| (start + 2 * k) % n).collect();
        if coarse.len() < 3 {
            continue;
        }
        let some: Vec<DVec2> = coarse.iter().map(|&k| points[k]).collect();
        let valences: Vec<i32> = coarse.iter().map(|&k| wanted[k].round() as i32 + 1).collect();
        let made = match fill_flat(&some, &valences, &|_, _| false, &FlatOptions::default(), progress) {
            Err(Error::NoPatch { .. } | Error::Solver { .. }) => continue,
            made => made?,
        };
        let cut = Cut::of(points, &coarse, &made.patch.interior, &made.patch.triangles);
        if n <= SMALL {
            found.push(cut.behind_a_row(points));
        }
        found.push(cut.cells(n));
    }
    Ok(found)
}

/// Triangles cut into quads.
struct Cut {
    positions: Vec<DVec2>,
    quads: Vec<[u32; 4]>,
    odd: Option<[u32; 3]>,
}

impl Cut {
    fn of(points: &[DVec2], coarse: &[usize], interior: &[DVec2], triangles: &[[u32; 3]]) -> Cut {
        let (n, m) = (points.len(), coarse.len());
        let mut cut = Cut { positions: [points, interior].concat(), quads: vec![], odd: None };
        let name = |v: u32| match coarse.get(v as usize) {
            Some(&v) => v as u32,
            None => (n + v as usize - m) as u32,
        };
        let mut middles: FxHashMap<[u32; 2], u32> = FxHashMap::default();
        // Those of the loop, but for an edge that stays whole.
        for k in 0..m {
            let (a, b) = (coarse[k], coarse[(k + 1) % m]);
            if (a + 2) % n == b {
                middles.insert([a.min(b) as u32, a.max(b) as u32], ((a + 1) % n) as u32);
            }
        }
        let whole = (n % 2 == 1).then(|| [coarse[m - 1] as u32, coarse[0] as u32]);
        for t in triangles {
            let t = t.map(name);
            let side = whole.and_then(|[a, b]| (0..3).find(|&k| t[k] == a && t[(k + 1) % 3] == b));
            let mut middle = |a: u32, b: u32| {
                *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    let at = |v: u32| cut.positions[v as usize];
                    let new = 0.5 * (at(a) + at(b));
                    cut.positions.push(new);
                    cut.positions.len() as u32 - 1
                })
            };
            if let Some(k) = side {
                let [a, b, c] = [0, 1, 2].map(|ahead| t[(k + ahead) % 3]);
                let (right, left) = (middle(b, c), middle(c, a));
                cut.quads.push([a, b, right, left]);
                cut.odd = Some([left, right, c]);
                continue;
            }
            let between = [0, 1, 2].map(|k| middle(t[k], t[(k + 1) % 3]));
            let centre = t.iter().map(|&v| cut.positions[v as usize]).sum::<DVec2>() / 3.0;
            cut.positions.push(centre);
            let centre = cut.positions.len() as u32 - 1;
            cut.quads.extend((0..3).map(|k| [t[k], between[k], centre, between[(k + 2) % 3]]));
        }
        cut
    }

    fn cells(self, n: usize) -> Cells {
        Cells::free(n, self.quads, self.odd, self.positions)
    }

    /// The same within a row of quads.
    fn behind_a_row(&self, points: &[DVec2]) -> Cells {
        let n = points.len();
        let centre = points.iter().sum::<DVec2>() / n as f64;
        let inward = self.positions.iter().map(|&p| centre + 0.5 * (p - centre));
        let positions = points.iter().copied().chain(inward).collect();
        let row = (0..n).map(|i| [i, (i + 1) % n, n + (i + 1) % n, n + i].map(|v| v as u32));
        let inside = self.quads.iter().map(|quad| quad.map(|v| v + n as u32));
        Cells::free(n, row.chain(inside).collect(), self.odd.map(|t| t.map(|v| v + n as u32)), positions)
    }
}
