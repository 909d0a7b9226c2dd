//! One patch for three loops or more.
//!
//! No lattice fits them all: the loops are joined to one polygon (`tour`), which is triangulated with the least bending and area
//! (`polygon`), and the triangles are made even on that surface and smooth to what lies beyond (`even`).

mod polygon;
mod tour;

use glam::{DVec2, DVec3};
use rustc_hash::{FxHashMap, FxHashSet};

use self::polygon::{Outline, triangulated};
use self::tour::{Loops, turned};
use crate::error::{Error, Result};
use crate::fill::even::fair::{Beyond, fair};
use crate::fill::even::local::{Local, edge};
use crate::fill::even::polish::polish;
use crate::fill::even::regular::regularize;
use crate::fill::even::remesh::{Ground, adapt, flip_valences, mend_thin, refine, remesh};
use crate::fill::even::untangle::{Near, tangled, unfold, untangle};
use crate::fill::filled::{Bridged, Fill, Shape};
use crate::fill::job::{Job, SOUND_RINGS};
use crate::fill::layout::unroll::Unrolling;
use crate::fill::loops::check::{Checked, check_loop, check_near};
use crate::fill::loops::mesh::Rim;
use crate::fill::loops::reserve::wanted;
use crate::fill::one::outside;
use crate::fill::options::{FillOptions, Smooth};
use crate::fill::report::{FillReport, Grid};
use crate::fill::surface::fair::Membrane;
use crate::fill::surface::fit::{Faults, LEAST_WEIGHT, folds, rim_angle};
use crate::fill::surface::meet::Box3;
use crate::fill::surface::patchwork::Patchwork;
use crate::geometry::metrics::min_angle;
use crate::options::CellShape;
use crate::progress::{Clock, Progress};

/// Rounds of fairing and flips.
const ROUNDS: usize = 3;

/// Times at most that the triangles are made even on a surface that is made smooth.
const SHAPED: usize = 10;

/// A round that changes the number of vertices by less than this share is the last.
const SETTLED: f64 = 0.02;

/// See [`fill_loops`](super::fill_loops), for three or more.
pub(super) fn fill_several(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    loops: &[Vec<u32>],
    options: &FillOptions,
    progress: Progress<'_>,
) -> Result<Fill> {
    progress.report(0.0)?;
    options.check(triangles)?;
    if options.cells == CellShape::Quad {
        let (name, value) = ("cells", format!("quads, with {} loops", loops.len()));
        return Err(Error::InvalidOption { name, value, allowed: "triangles, with several loops" });
    }
    let seeds = loops.concat();
    let rings = if options.smooth == Smooth::Curvature { 2 } else { 1 };
    let rim = Rim::new(vertices.len(), triangles, &seeds, rings)?;
    let mut checked = loops.iter().map(|l| check_loop(l, vertices, &rim)).collect::<Result<Vec<_>>>()?;
    if vertices.iter().any(|p| !p.is_finite()) {
        let wide = Rim::new(vertices.len(), triangles, &seeds, SOUND_RINGS)?;
        loops.iter().try_for_each(|l| check_near(l, vertices, &wide))?;
    }
    let mut known = FxHashSet::default();
    if let Some(&vertex) = seeds.iter().find(|&&v| !known.insert(v)) {
        return Err(Error::FigureEight { vertex });
    }
    progress.report(0.1)?;
    let spanning = tour::spanning(&checked, vertices);
    turned(&mut checked, &spanning, vertices);
    let span = Several { vertices, triangles, rim: &rim, options, checked: &checked };
    let fill = span.fill(&spanning, rings, progress.part(0.1, 0.8))?;
    let mut fills = [Ok(fill)];
    Job { vertices, triangles, options }.count_meetings(&mut fills, progress.part(0.8, 1.0))?;
    let [fill] = fills;
    progress.report(1.0)?;
    fill
}

/// The loops, as the patch's boundary runs.
struct Several<'a> {
    vertices: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    rim: &'a Rim,
    options: &'a FillOptions,
    checked: &'a [Checked],
}

impl Several<'_> {
    fn fill(&self, spanning: &[[usize; 2]], rings: usize, progress: Progress<'_>) -> Result<Fill> {
        let mut clock = Clock::new();
        let loop_ = self.checked.iter().flat_map(|c| c.vertices.iter().copied()).collect::<Vec<_>>();
        let at = loop_.iter().map(|&v| self.vertices[v as usize]).collect::<Vec<_>>();
        let taken = self.taken(&loop_);
        let loops = Loops::new(self.checked.iter().map(|c| c.vertices.len()));
        let outside = self
            .checked
            .iter()
            .flat_map(|c| outside(&c.vertices, self.rim, self.vertices))
            .collect::<Vec<_>>();
        let outline = Outline { loops: &loops, at: &at, outside: &outside, taken: &taken };
        let (positions, triangles) = triangulated(&outline, spanning, progress.part(0.0, 0.3))?;
        clock.stage("surface");
        let mut local = Local::new(positions, triangles, vec![], loop_.len());
        local.sides = vec![0; local.triangles.len()];
        local.taken = taken;
        self.size(&loops, &mut local);
        let beyond = self.beyond(&loops, &loop_);
        let place: FxHashMap<u32, u32> = loop_.iter().zip(0..).map(|(&v, k)| (v, k)).collect();
        let near = |local: &Local| {
            Near::new(Box3::around(local.positions.iter().copied()), self.vertices, self.triangles, &place)
        };
        let is_flat = self.options.smooth == Smooth::Flat;
        if is_flat {
            let ground = Ground::of(&local);
            remesh(&mut local, &ground, progress.part(0.3, 0.5))?;
            regularize(&mut local, Some(&ground), progress.part(0.5, 0.6))?;
        } else {
            self.shaped(&mut local, &beyond, progress.part(0.3, 0.5))?;
            regularize(&mut local, None, progress.part(0.5, 0.6))?;
            let near = near(&local);
            unfold(&mut local, &near, progress.part(0.6, 0.65))?;
        }
        clock.stage("grid");
        let even = local.positions.clone();
        if !is_flat {
            for round in 0..=ROUNDS {
                let part = |k: usize| 0.65 + 0.15 * k as f64 / (ROUNDS + 1) as f64;
                if round > 0 {
                    flip_valences(&mut local);
                    mend_thin(&mut local);
                }
                local.positions = fair(&local, &beyond, progress.part(part(round), part(round + 1)))?;
            }
        }
        let near = near(&local);
        untangle(&mut local, &even, &near, polish, progress.part(0.8, 0.85))?;
        let faired = local.positions.clone();
        let mut work =
            Patchwork::new(&loop_, local.positions.len() - loop_.len(), &local.triangles, self.rim, rings)?;
        work.later = loops.starts[1..].to_vec();
        let mut shape = Shape {
            flat: vec![DVec2::ZERO; work.end],
            work,
            loop_,
            reversed: self.checked[0].reversed,
            bridged: (loops.starts[1..].iter().zip(&self.checked[1..]))
                .map(|(&first, checked)| Bridged { first, reversed: checked.reversed })
                .collect(),
            smooth: self.options.smooth,
            vertices: self.vertices.len(),
            positions: vec![],
            creases: vec![],
        };
        shape.positions = self.placed(&shape, &even, &faired, progress.part(0.85, 0.95))?;
        self.mended(&mut shape, &mut local, &even, &near, progress.part(0.95, 1.0))?;
        clock.stage("fair");
        Ok(self.finish(shape, clock))
    }

    /// Makes the triangles even on a surface that is made smooth: shape and triangles depend on each other. Fairing spreads the
    /// vertices too: to project them to a surface with two sheets close to each other would mix these up.
    fn shaped(&self, local: &mut Local, beyond: &Beyond, progress: Progress<'_>) -> Result<()> {
        refine(local);
        for round in 0..SHAPED {
            let part = progress.part(round as f64 / SHAPED as f64, (round + 1) as f64 / SHAPED as f64);
            local.positions = fair(local, beyond, part)?;
            let before = local.positions.len() as f64;
            adapt(local);
            if round > 1 && (local.positions.len() as f64 - before).abs() < SETTLED * before {
                break;
            }
        }
        Ok(())
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

    /// Edges that the mesh has between vertices of the loops, by their places.
    fn taken(&self, loop_: &[u32]) -> FxHashSet<[u32; 2]> {
        let places: FxHashMap<u32, u32> = loop_.iter().zip(0..).map(|(&v, k)| (v, k)).collect();
        let mut taken = FxHashSet::default();
        for (&v, k) in loop_.iter().zip(0..) {
            let near = self.rim.local(v).map(|v| self.rim.neighbours(v)).unwrap_or_default();
            let near = near.into_iter().map(|u| self.rim.ids[u as usize]);
            let loose = self.rim.loose.iter().filter(|edge| edge.contains(&v));
            for u in near.chain(loose.flatten().copied()).filter(|&u| u != v) {
                taken.extend(places.get(&u).map(|&place| edge(k, place)));
            }
        }
        taken
    }

    /// Wanted edge lengths and numbers of triangles.
    fn size(&self, loops: &Loops, local: &mut Local) {
        for v in 0..local.border {
            let length = |a: usize, b: usize| local.positions[a].distance(local.positions[b]);
            local.sizes[v] = 0.5 * (length(v, loops.next(v)) + length(v, loops.before(v)));
        }
        let inner = local.border..local.positions.len();
        for v in inner {
            let (mut sum, mut weights) = (0.0, 0.0);
            for k in 0..local.border {
                let squared = local.positions[k].distance_squared(local.positions[v]);
                let weight = 1.0 / squared.max(f64::MIN_POSITIVE);
                sum += weight * local.sizes[k];
                weights += weight;
            }
            local.sizes[v] = sum / weights;
        }
        let of = |checked: &Checked| wanted(&checked.vertices, self.rim, &self.options.polygons);
        let edges = self.checked.iter().flat_map(of);
        local.wanted = edges.map(|edges| (edges - 1).clamp(1, 5) as usize).collect();
    }

    /// What lies beyond each vertex of the loops.
    fn beyond(&self, loops: &Loops, loop_: &[u32]) -> Beyond {
        let of = |k: usize| {
            let beside = [loop_[loops.before(k)], loop_[loops.next(k)]];
            let near = self.rim.local(loop_[k]).map(|v| self.rim.neighbours(v)).unwrap_or_default();
            let near = near.into_iter().map(|u| self.rim.ids[u as usize]).filter(|u| !beside.contains(u));
            near.fold((DVec3::ZERO, 0), |(sum, n), u| (sum + self.vertices[u as usize], n + 1))
        };
        (0..loop_.len()).map(of).collect()
    }

    /// The smoothest positions of all that meet least.
    fn placed(
        &self,
        shape: &Shape,
        even: &[DVec3],
        faired: &[DVec3],
        progress: Progress<'_>,
    ) -> Result<Vec<DVec3>> {
        let work = &shape.work;
        let mut around = vec![DVec3::ZERO; work.len()];
        for (k, &v) in work.outer.iter().enumerate() {
            around[work.end + k] = self.vertices[v as usize];
        }
        let all = |own: &[DVec3]| [own, &around[work.end..]].concat();
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
            match shape.bend(&mut bent, None, &mut vec![], progress.part(0.0, 0.5)) {
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
        for choice in choices.into_iter().filter(|choice| choice.iter().all(|p| p.is_finite())) {
            let most = best.as_ref().map_or(usize::MAX, |best| best.0.meetings + 1);
            let faults = Faults::of(work, &choice, most, progress.part(0.5, 1.0))?;
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

    fn finish(&self, shape: Shape, clock: Clock) -> Fill {
        let work = &shape.work;
        let own = &work.triangles[..work.n_patch];
        let irregular = |v: &usize| work.range(*v).len() != 6;
        let report = FillReport {
            triangles: own.len(),
            vertices: work.inner().len(),
            irregular: work.inner().filter(irregular).count(),
            irregular_loop: (0..work.n).filter(irregular).count(),
            grid: Grid::Even,
            rim_angle: rim_angle(work, &shape.positions),
            unrolling: Unrolling::default(),
            winding_conflicts: self.checked.iter().map(|c| c.conflicts).sum(),
            wire_edges: self.checked.iter().map(|c| c.wire).sum(),
            min_angle: min_angle(&shape.positions, own),
            folds: folds(work, &shape.positions),
            seconds: clock.seconds,
            ..FillReport::default()
        };
        let given = |c: &Checked| {
            let mut vertices = c.vertices.clone();
            if c.reversed {
                vertices.reverse();
            }
            vertices
        };
        Fill::of(self.checked.iter().flat_map(given).collect(), shape, report)
    }
}
