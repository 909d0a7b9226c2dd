//! What an operation on one mesh's loops works with.

use std::time::Instant;

use glam::DVec3;
use rustc_hash::FxHashSet;

use crate::error::{Error, Result};
use crate::fill::filled::Fill;
use crate::fill::loops::check::{check_loop, check_near};
use crate::fill::loops::mesh::Rim;
use crate::fill::loops::reserve::{groups, refuse_shared_edges};
use crate::fill::options::{FillOptions, Smooth};
use crate::fill::parallel::in_parallel;
use crate::progress::Progress;

/// Vertices this many rings of triangles around a loop must be finite.
pub(crate) const SOUND_RINGS: usize = 2;

pub(crate) struct Job<'a> {
    pub(crate) vertices: &'a [DVec3],
    pub(crate) triangles: &'a [[u32; 3]],
    pub(crate) options: &'a FillOptions,
}

impl Job<'_> {
    pub(crate) fn run(
        &self,
        loops: &[Result<Vec<u32>>],
        progress: Progress<'_>,
    ) -> Result<Vec<Result<Fill>>> {
        progress.report(0.0)?;
        self.options.check(self.triangles)?;
        let since = Instant::now();
        let n_vertices = self.vertices.len();
        let mut seeds = loops.iter().flatten().flatten().copied().collect::<Vec<_>>();
        seeds.retain(|&v| (v as usize) < n_vertices);
        let rings = match self.options.smooth {
            Smooth::Curvature => 2,
            _ => 1,
        };
        let rim = Rim::new(n_vertices, self.triangles, &seeds, rings)?;
        // The second ring is looked at only where something is wrong somewhere.
        let sound = self.vertices.iter().all(|p| p.is_finite());
        let wide =
            if sound { None } else { Some(Rim::new(n_vertices, self.triangles, &seeds, SOUND_RINGS)?) };
        let check = |loop_: &Result<Vec<u32>>| {
            let loop_ = loop_.as_ref().map_err(Clone::clone)?;
            let checked = check_loop(loop_, self.vertices, &rim)?;
            wide.as_ref().map_or(Ok(()), |wide| check_near(loop_, self.vertices, wide))?;
            Ok(checked)
        };
        let mut checked = loops.iter().map(check).collect::<Vec<_>>();
        refuse_shared_edges(&mut checked);
        let search = since.elapsed().as_secs_f64();
        progress.report(0.1)?;

        let groups = groups(&checked);
        let fill_group = |group: &Vec<usize>, progress: Progress<'_>| {
            // Fills of one group could repeat each other's edges: one after the other, each knows the edges
            // of those before.
            let mut reserved = FxHashSet::default();
            let mut fills = Vec::with_capacity(group.len());
            for (i, &k) in group.iter().enumerate() {
                let part = |i: usize| i as f64 / group.len() as f64;
                let here = progress.part(part(i), part(i + 1));
                let fill = match &checked[k] {
                    Ok(checked) => self.one(checked, &rim, &reserved, here),
                    Err(error) => Err(error.clone()),
                };
                match fill {
                    Ok(mut fill) => {
                        fill.report.seconds.insert(0, ("search", search));
                        let old = |e: &[u32; 2]| e.iter().all(|&v| (v as usize) < n_vertices);
                        reserved.extend(fill.sides().filter(old));
                        fills.push((k, Ok(fill)));
                    }
                    Err(Error::Cancelled) => return Err(Error::Cancelled),
                    Err(error) => fills.push((k, Err(error))),
                }
            }
            Ok(fills)
        };
        let here = progress.part(0.1, 0.8);
        let filled = match groups.as_slice() {
            [single] => vec![fill_group(single, here)?],
            several => {
                let vertices = |k: &usize| checked[*k].as_ref().map_or(1, |checked| checked.vertices.len());
                let size = |group: &Vec<usize>| group.iter().map(vertices).sum();
                in_parallel(several, size, here, fill_group)?
            }
        };
        let mut fills = filled.into_iter().flatten().collect::<Vec<_>>();
        fills.sort_unstable_by_key(|(k, _)| *k);
        let mut fills = fills.into_iter().map(|(_, fill)| fill).collect::<Vec<_>>();
        progress.report(0.8)?;
        self.count_meetings(&mut fills, progress.part(0.8, 1.0))?;
        progress.report(1.0)?;
        Ok(fills)
    }
}
