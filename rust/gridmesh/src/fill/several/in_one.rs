//! A patch in one: triangles laid over all loops, made even and smooth.

use glam::{DVec2, DVec3};

use super::border::{Border, Several};
use super::polygon::{Outline, triangulated};
use super::rings;
use crate::error::{Error, Result};
use crate::fill::even::fair::{Beyond, fair};
use crate::fill::even::local::Local;
use crate::fill::even::polish::polish;
use crate::fill::even::regular::regularize;
use crate::fill::even::remesh::{Ground, adapt, flip_valences, mend_thin, refine, remesh};
use crate::fill::even::untangle::{Near, tangled, unfold, untangle};
use crate::fill::filled::{Bridged, Leaving, Shape};
use crate::fill::options::{FillOptions, Smooth};
use crate::fill::surface::fair::Membrane;
use crate::fill::surface::fit::{Faults, LEAST_WEIGHT, folds};
use crate::fill::surface::meet::Box3;
use crate::fill::surface::patchwork::Patchwork;
use crate::options::CellShape;
use crate::progress::{Clock, Progress};

/// Rounds of fairing and flips.
const ROUNDS: usize = 3;

/// Times at most that the triangles are made even on a surface that is made smooth.
const SHAPED: usize = 10;

/// A smooth surface that has so many times the vertices of an earlier one has no end to its growth.
const GROWN: usize = 3;

/// A round that changes the number of vertices by less than this share is the last.
const SETTLED: f64 = 0.02;

impl Several<'_> {
    /// Triangles laid over the loops, and how many fallbacks it took.
    pub(super) fn in_one(&self, clock: &mut Clock, progress: Progress<'_>) -> Result<(Shape, usize)> {
        let border = self.border();
        let mut shape = self.made(&border, clock, progress.part(0.0, 0.6))?;
        let mut repaired = 0;
        if self.options.smooth != Smooth::Flat && self.meets(&shape, progress.part(0.6, 0.65))? {
            // Where the surfaces around cannot go on a film may do.
            let options = FillOptions { smooth: Smooth::Flat, ..self.options.clone() };
            let film = Several { options: &options, ..*self };
            let other = film.made(&border, clock, progress.part(0.65, 0.95))?;
            if !self.meets(&other, progress.part(0.95, 1.0))? {
                (shape, repaired) = (Shape { smooth: self.options.smooth, ..other }, 1);
            }
        }
        clock.stage("fair");
        Ok((shape, repaired))
    }

    /// Whether a patch meets itself or what is around it.
    fn meets(&self, shape: &Shape, progress: Progress<'_>) -> Result<bool> {
        Ok(shape.faults(&shape.positions, 1, progress)?.meetings > 0)
    }

    /// The patch, in its place.
    fn made(&self, border: &Border, clock: &mut Clock, progress: Progress<'_>) -> Result<Shape> {
        if self.options.cells == CellShape::Quad {
            return self.quads(border, clock, progress);
        }
        let (mut local, even) = self.even(border, clock, progress.part(0.0, 0.85))?;
        let work = self.patchwork(border, local.positions.len(), &local.triangles)?;
        let mut shape = self.shape(border, work);
        shape.positions = self.placed(&shape, &even, &local.positions, progress.part(0.85, 0.95))?;
        let near = self.near(border, &local);
        self.mended(&mut shape, &mut local, &even, &near, progress.part(0.95, 1.0))?;
        Ok(shape)
    }

    /// Even triangles between the places of a border on a surface that is smooth to what lies beyond, and where they were
    /// before the last smoothing.
    pub(super) fn even(
        &self,
        border: &Border,
        clock: &mut Clock,
        progress: Progress<'_>,
    ) -> Result<(Local, Vec<DVec3>)> {
        let Border { loops, at, outside, taken, beyond, .. } = border;
        let outline = Outline { loops, at, outside, taken };
        let (positions, triangles) = triangulated(&outline, self.spanning, progress.part(0.0, 0.35))?;
        clock.stage("surface");
        let mut local = border.local(positions.clone(), triangles.clone());
        // Nothing smooths a surface that has to turn round and meets itself from the first.
        if self.apart.is_some()
            && !tangled(&local, &self.near(border, &local), progress.part(0.35, 0.35))?.is_empty()
        {
            self.refuse_apart()?;
        }
        let mut is_flat = self.options.smooth == Smooth::Flat;
        if !is_flat && !self.shaped(&mut local, beyond, progress.part(0.35, 0.6))? {
            local = border.local(positions, triangles);
            is_flat = true;
        }
        if is_flat {
            let ground = Ground::of(&local);
            remesh(&mut local, &ground, progress.part(0.35, 0.6))?;
            regularize(&mut local, Some(&ground), progress.part(0.6, 0.7))?;
        } else {
            regularize(&mut local, None, progress.part(0.6, 0.7))?;
            let near = self.near(border, &local);
            unfold(&mut local, &near, progress.part(0.7, 0.76))?;
        }
        clock.stage("grid");
        let even = local.positions.clone();
        if !is_flat {
            for round in 0..=ROUNDS {
                let part = |k: usize| 0.76 + 0.18 * k as f64 / (ROUNDS + 1) as f64;
                if round > 0 {
                    flip_valences(&mut local);
                    mend_thin(&mut local);
                }
                local.positions = fair(&local, beyond, progress.part(part(round), part(round + 1)))?;
            }
        }
        let near = self.near(border, &local);
        untangle(&mut local, &even, &near, polish, progress.part(0.94, 1.0))?;
        Ok((local, even))
    }

    pub(super) fn near(&self, border: &Border, local: &Local) -> Near {
        let around = Box3::around(local.positions.iter().copied());
        Near::new(around, self.vertices, self.triangles, &border.place)
    }

    /// The patch of triangles over `end` vertices, and what is around it.
    pub(super) fn patchwork(&self, border: &Border, end: usize, triangles: &[[u32; 3]]) -> Result<Patchwork> {
        let rings = rings(self.options.smooth);
        let mut work =
            Patchwork::new(&border.vertices, end - border.vertices.len(), triangles, self.rim, rings)?;
        work.later = border.loops.starts[1..].to_vec();
        Ok(work)
    }

    /// What the patch is, but for positions.
    pub(super) fn shape(&self, border: &Border, work: Patchwork) -> Shape {
        Shape {
            flat: vec![DVec2::ZERO; work.end],
            bridged: (work.later.iter().zip(&self.checked[1..]))
                .map(|(&first, checked)| Bridged {
                    first,
                    reversed: checked.reversed,
                    pull: 1.0,
                    leaving: Leaving::Direct,
                })
                .collect(),
            work,
            loop_: border.vertices.clone(),
            reversed: self.checked[0].reversed,
            smooth: self.options.smooth,
            vertices: self.vertices.len(),
            positions: vec![],
            creases: vec![],
        }
    }

    /// Makes the triangles even on a surface that is made smooth: shape and triangles depend on each other. Fairing spreads the
    /// vertices too: to project them to a surface with two sheets close to each other would mix these up.
    ///
    /// False if there is no end to it: each smoother surface is larger, as where what lies beyond crosses itself.
    fn shaped(&self, local: &mut Local, beyond: &Beyond, progress: Progress<'_>) -> Result<bool> {
        refine(local);
        let mut least = local.positions.len();
        for round in 0..SHAPED {
            let part = progress.part(round as f64 / SHAPED as f64, (round + 1) as f64 / SHAPED as f64);
            local.positions = fair(local, beyond, part)?;
            let before = local.positions.len() as f64;
            adapt(local);
            least = least.min(local.positions.len());
            if local.positions.len() > GROWN * least {
                return Ok(false);
            }
            if round > 1 && (local.positions.len() as f64 - before).abs() < SETTLED * before {
                break;
            }
        }
        Ok(true)
    }

    /// Makes thin triangles of the patch in its place rounder, and takes back what meets something.
    fn mended(
        &self,
        shape: &mut Shape,
        local: &mut Local,
        even: &[DVec3],
        near: &Near,
        progress: Progress<'_>,
    ) -> Result<()> {
        let end = shape.work.end;
        local.positions = shape.positions[..end].to_vec();
        let before = tangled(local, near, progress.part(0.0, 0.3))?.len();
        let folds_before = folds(&shape.work, &shape.positions);
        let bad = untangle(local, even, near, polish, progress.part(0.3, 1.0))?;
        let mended = [&local.positions[..], &shape.positions[end..]].concat();
        if bad.len() <= before && folds(&shape.work, &mended) <= folds_before {
            shape.positions = mended;
        }
        Ok(())
    }

    /// The smoothest positions of all that meet least.
    pub(super) fn placed(
        &self,
        shape: &Shape,
        even: &[DVec3],
        faired: &[DVec3],
        progress: Progress<'_>,
    ) -> Result<Vec<DVec3>> {
        let own = &shape.work;
        // Quads are placed with a vertex in the middle of each.
        let centred = if own.quads > 0 { Some(shape.centred()?) } else { None };
        let solver = centred.as_ref().unwrap_or(shape);
        let work = &solver.work;
        let outer = work.outer.iter().map(|&v| self.vertices[v as usize]).collect::<Vec<_>>();
        let all = |positions: &[DVec3]| {
            let middle = |q: [u32; 4]| q.iter().map(|&v| positions[v as usize]).sum::<DVec3>() / 4.0;
            let middles = own.quads().map(middle);
            positions.iter().copied().chain(middles).chain(outer.iter().copied()).collect::<Vec<_>>()
        };
        let mut choices = vec![];
        if self.options.smooth == Smooth::Flat {
            let mut film = all(even);
            let weights = work.cotangents(&film).into_iter().map(|w| w.max(LEAST_WEIGHT)).collect::<Vec<_>>();
            let found =
                Membrane::new(work, progress)?.harmonic(&weights, |v| film[v].to_array(), progress)?;
            for (v, p) in work.inner().zip(found) {
                film[v] = p.into();
            }
            choices.push(film);
        } else {
            let mut bent = all(faired);
            match solver.bend(&mut bent, None, &mut vec![], progress.part(0.0, 0.5)) {
                Ok(()) => choices.push(bent),
                // Triangles without area spoil the equations.
                Err(Error::Solver { .. }) => {}
                Err(other) => return Err(other),
            }
            choices.push(all(faired));
            choices.push(all(&even.iter().zip(faired).map(|(p, q)| p.midpoint(*q)).collect::<Vec<_>>()));
        }
        choices.push(all(even));
        let mut best: Option<(Faults, Vec<DVec3>)> = None;
        for mut choice in choices.into_iter().filter(|choice| choice.iter().all(|p| p.is_finite())) {
            choice.drain(own.end..work.end);
            let most = best.as_ref().map_or(usize::MAX, |best| best.0.meetings + 1);
            let faults = shape.faults(&choice, most, progress.part(0.5, 1.0))?;
            if best.as_ref().is_none_or(|best| faults < best.0) {
                best = Some((faults, choice));
            }
            if best.as_ref().is_some_and(|best| best.0 == Faults::default()) {
                break;
            }
        }
        let found = best.ok_or(Error::Solver { stage: "fill", reason: "a vertex is not finite".into() })?;
        Ok(found.1)
    }
}
