//! What the patches of a mesh meet, and films in place of smooth ones that meet something.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;

use super::filled::{Fill, Shape};
use super::job::Job;
use super::options::Smooth;
use super::parallel::in_parallel;
use super::report::FillReport;
use super::surface::around::is_around;
use super::surface::meet::{Box3, MOST, count_meetings, is_graph, near_boxes};
use crate::error::{Error, Result};
use crate::progress::Progress;

/// How often something meets, and where first.
type Meetings = (usize, Option<DVec3>);

impl Job<'_> {
    /// Counts what new triangles meet: the mesh, themselves, and those of fills that come before. A patch that continues
    /// the surface and meets something gives way to its film, if that meets nothing.
    pub(crate) fn count_meetings(&self, fills: &mut [Result<Fill>], progress: Progress<'_>) -> Result<()> {
        let since = Instant::now();
        let done = fills.iter().flatten().collect::<Vec<_>>();
        let mut counts = self.meetings(&done, progress.part(0.0, 0.5))?;
        if let Some(clear) = self.cleared(&done, &counts, progress.part(0.5, 0.8))? {
            let chosen = done.iter().zip(&clear).map(|(fill, film)| film.as_ref().unwrap_or(fill));
            counts = self.meetings(&chosen.collect::<Vec<_>>(), progress.part(0.8, 1.0))?;
            for (fill, film) in fills.iter_mut().flatten().zip(clear) {
                film.into_iter().for_each(|film| *fill = film);
            }
        }
        let seconds = since.elapsed().as_secs_f64();
        for (item, (pairs, at)) in fills.iter_mut().filter(|fill| fill.is_ok()).zip(counts) {
            if let Ok(fill) = item {
                fill.report.self_intersections = pairs;
                fill.report.seconds.push(("intersections", seconds));
            }
            if let (true, Some(at)) = (self.options.strict, at) {
                *item = Err(Error::FillIntersects { pairs, at: at.into() });
            }
        }
        Ok(())
    }

    /// For each fill that meets something its film, if that meets nothing while all these are films; nothing at all if
    /// no film helps.
    fn cleared(
        &self,
        fills: &[&Fill],
        counts: &[Meetings],
        progress: Progress<'_>,
    ) -> Result<Option<Vec<Option<Fill>>>> {
        let mut films = Vec::with_capacity(fills.len());
        for (k, (fill, (pairs, _))) in fills.iter().zip(counts).enumerate() {
            progress.report(0.5 * k as f64 / fills.len() as f64)?;
            films.push(if *pairs > 0 { fill.film(self.vertices, progress.part(0.0, 0.0))? } else { None });
        }
        if films.iter().all(Option::is_none) {
            return Ok(None);
        }
        let chosen = fills.iter().zip(&films).map(|(fill, film)| film.as_ref().unwrap_or(fill));
        let counts = self.meetings(&chosen.collect::<Vec<_>>(), progress.part(0.5, 1.0))?;
        for (film, (pairs, _)) in films.iter_mut().zip(counts) {
            film.take_if(|_| pairs > 0);
        }
        Ok(films.iter().any(Option::is_some).then_some(films))
    }

    /// What each of some fills meets.
    fn meetings(&self, fills: &[&Fill], progress: Progress<'_>) -> Result<Vec<Meetings>> {
        let n = self.vertices.len() as u32;
        let facets = fills.iter().map(|fill| fill.facets()).collect::<Vec<_>>();
        // New vertices of all fills get numbers of their own here.
        let mut first = vec![n];
        for fill in fills {
            first.push(first[first.len() - 1] + fill.vertices.len() as u32);
        }
        let owner = |v: u32| first.partition_point(|&f| f <= v) - 1;
        let position = |v: u32| {
            if v < n {
                self.vertices[v as usize]
            } else {
                let k = owner(v);
                fills[k].vertices[(v - first[k]) as usize]
            }
        };
        let named = |k: usize| -> Vec<[u32; 3]> {
            facets[k].iter().map(|t| t.map(|v| if v < n { v } else { v - n + first[k] })).collect()
        };
        let boxes = (0..fills.len())
            .map(|k| Box3::around(named(k).iter().flatten().map(|&v| position(v))))
            .collect::<Vec<_>>();
        let near = near_boxes(&boxes, self.vertices, self.triangles);
        let count = |&k: &usize, progress: Progress<'_>| {
            let mut others = near[k].iter().map(|&t| self.triangles[t as usize]).collect::<Vec<_>>();
            others.extend((0..k).filter(|&j| boxes[j].meets(&boxes[k])).flat_map(named));
            let shape = fills[k].shape.as_ref();
            let (around, positions, own) = shape.graph();
            let apart = match shape.bridged.as_slice() {
                [bridged] => is_around(positions, bridged.first, around.len(), own),
                [_, _, ..] => false,
                [] => is_graph(around, positions, own),
            };
            count_meetings(position, &named(k), &others, apart, MOST, progress)
        };
        match (0..fills.len()).collect::<Vec<_>>().as_slice() {
            [] => Ok(vec![]),
            [single] => Ok(vec![count(single, progress)?]),
            several => in_parallel(several, |&k| facets[k].len(), progress, count),
        }
    }
}

impl Fill {
    /// The patch of one loop as a film, for a mesh with vertices at `mesh`; none if it is one, or if there is none.
    fn film(&self, mesh: &[DVec3], progress: Progress<'_>) -> Result<Option<Fill>> {
        let shape = self.shape.as_ref();
        let is_film = shape.smooth == Smooth::Flat || shape.work.inner().is_empty();
        if is_film || !shape.bridged.is_empty() || !shape.creases.is_empty() {
            return Ok(None);
        }
        let mut shape = Shape { smooth: Smooth::Flat, ..shape.clone() };
        let solved = match shape.solve(mesh, progress) {
            Ok(solved) => solved,
            Err(Error::Cancelled) => return Err(Error::Cancelled),
            // The smooth patch stays.
            Err(_) => return Ok(None),
        };
        shape.positions = solved.positions;
        let [min_angle, max_angle] = shape.work.corner_range(&shape.positions);
        let report = FillReport {
            min_angle,
            max_angle,
            folds: solved.faults.folds,
            repaired: 1,
            ..self.report.clone()
        };
        let vertices = shape.positions[shape.work.inner()].to_vec();
        Ok(Some(Fill { vertices, report, shape: Arc::new(shape), ..self.clone() }))
    }
}
