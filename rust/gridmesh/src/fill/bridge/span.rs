//! Two loops and the tube between them.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashSet;

use super::align::{Ring, best_fit, facing};
use super::choose::{Bank, Chooser, Chosen};
use super::loft::Loft;
use super::necks::{is_handle, ways};
use super::options::BridgeOptions;
use super::rail::onward;
use super::refit::{edge, reversed, work_positions};
use super::settle::settle;
use crate::error::{Error, Result};
use crate::fill::filled::{Bridged, Fill, Leaving, Shape};
use crate::fill::job::SOUND_RINGS;
use crate::fill::layout::unroll::Unrolling;
use crate::fill::loops::check::{Checked, check_loops, check_near};
use crate::fill::loops::mesh::Rim;
use crate::fill::loops::reserve::{edges, wanted};
use crate::fill::loops::touching::check_apart;
use crate::fill::options::{FillOptions, Smooth};
use crate::fill::report::{FillReport, Grid};
use crate::fill::surface::faces::{cut, good_corner};
use crate::fill::surface::fit::{folds, rim_angle};
use crate::fill::surface::patchwork::Patchwork;
use crate::options::CellShape;
use crate::progress::{Clock, Progress};

/// A surface that folds is tried with its curves pulled this tight, one after the other.
const PULLS: [f64; 3] = [0.6, 0.35, 0.15];

/// A lattice whose least angle is below this, in radians, is compared with rings of any lengths.
const THIN: f64 = 0.2;

/// Faces of a tube that turn from those around it by more than this go on as an edge, not smoothly.
const SMOOTH: f64 = 0.5;

/// A tube that does not know yet what it meets.
pub(in crate::fill) fn tube(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    given: [&[u32]; 2],
    options: &BridgeOptions,
    rest: &FillOptions,
    progress: Progress<'_>,
) -> Result<Fill> {
    let seeds = given.concat();
    let rim =
        Rim::new(vertices.len(), triangles, &seeds, if options.smooth == Smooth::Curvature { 2 } else { 1 })?;
    let checked = check_loops(&given, vertices, &rim)?;
    check_apart(&given, vertices)?;
    if vertices.iter().any(|p| !p.is_finite()) {
        let wide = Rim::new(vertices.len(), triangles, &seeds, SOUND_RINGS)?;
        given.iter().try_for_each(|loop_| check_near(loop_, vertices, &wide))?;
    }
    progress.report(0.12)?;
    let Ok(both) = <[Checked; 2]>::try_from(checked) else {
        return Err(Error::Internal { reason: "two loops are not two" });
    };
    let span = Span::new(vertices, &rim, both, options);
    span.fill(rest, progress.part(0.12, 1.0))
}

/// Two loops, put the way round that suits both.
pub(super) struct Span<'a> {
    vertices: &'a [DVec3],
    rim: &'a Rim,
    options: &'a BridgeOptions,
    /// As the patch's boundary runs.
    loops: [Checked; 2],
    /// The loop with fewer vertices.
    lower: usize,
    conflicts: usize,
    /// See [`onward`], for both loops.
    onward: [Vec<DVec3>; 2],
    /// In which the tube may leave the loops, the best first.
    ways: Vec<Leaving>,
}

/// A tube in space.
struct Attempt {
    shape: Shape,
    lattice: bool,
    rows: f64,
    /// The least corner and the greatest one.
    angles: [f64; 2],
    folds: usize,
}

impl<'a> Span<'a> {
    pub fn new(
        vertices: &'a [DVec3],
        rim: &'a Rim,
        mut loops: [Checked; 2],
        options: &'a BridgeOptions,
    ) -> Span<'a> {
        let lower = usize::from(loops[1].vertices.len() < loops[0].vertices.len());
        let mut conflicts = loops[0].conflicts + loops[1].conflicts;
        let [low, high] = rings(&loops, lower, vertices);
        let faced = |k: usize| loops[k].vertices.len() - loops[k].wire;
        let facing = facing(&low, &high);
        let free = |k: usize| faced(k) == 0;
        let onward = |k: usize| match options.smooth {
            Smooth::Flat => vec![DVec3::ZERO; loops[k].vertices.len()],
            _ => onward_of(&loops[k].vertices, rim, vertices),
        };
        let mut onward = [onward(0), onward(1)];
        // Which side of a loop is outside its faces tell.
        let both_faced = !free(0) && !free(1);
        let handle = both_faced && is_handle(&low, &high, onward.each_ref().map(Vec::as_slice));
        if !handle && (facing <= -1.0 || (facing < 0.0 && !both_faced)) {
            // The loop with fewer faces gives way.
            let turned = usize::from(faced(1) <= faced(0));
            conflicts += faced(turned) - 2 * loops[turned].conflicts;
            loops[turned].vertices.reverse();
            loops[turned].reversed ^= true;
            onward[turned].reverse();
        }
        let ways = if both_faced {
            let [low, high] = rings(&loops, lower, vertices);
            ways(&low, &high, onward.each_ref().map(Vec::as_slice))
        } else {
            vec![Leaving::Direct]
        };
        Span { vertices, rim, options, loops, lower, conflicts, onward, ways }
    }

    pub fn fill(&self, rest: &FillOptions, progress: Progress<'_>) -> Result<Fill> {
        let mut clock = Clock::new();
        let banks = self.banks(&rest.polygons);
        let part = |k: usize| k as f64 / self.ways.len() as f64;
        let mut best = self.attempt(&banks, self.ways[0], &mut clock, progress.part(0.0, part(1)))?;
        // Where its loops zigzag, or lie far off, the surface does not come round well enough out of a sheet.
        for (k, &way) in self.ways.iter().enumerate().skip(1) {
            let rank = self.rank(&best);
            if rank <= (0, 1.0) {
                break;
            }
            let other = self.attempt(&banks, way, &mut clock, progress.part(part(k), part(k + 1)))?;
            if self.rank(&other) < rank {
                best = other;
            }
        }
        Ok(self.finish(best, clock))
    }

    /// How bad a tube is: its folds; and its corners and the edge along its rim, good up to 1.
    fn rank(&self, tube: &Attempt) -> (usize, f64) {
        let good = good_corner(self.options.cells);
        let edge = rim_angle(&tube.shape.work, &tube.shape.positions) / SMOOTH;
        (tube.folds, edge.max(good / tube.angles[0].max(f64::MIN_POSITIVE)))
    }

    /// The best tube that leaves the loops in one way.
    fn attempt(
        &self,
        banks: &[Bank; 2],
        leaving: Leaving,
        clock: &mut Clock,
        progress: Progress<'_>,
    ) -> Result<Attempt> {
        let [lower, upper] = banks;
        let joined = self.joined();
        let apart = |tube: &Chosen| {
            let m = lower.around.len() as u32;
            let both = m + upper.around.len() as u32;
            let sides = tube.tube.facets().flat_map(|t| edges(&t));
            !sides.filter(|[a, b]| *a < m && *b >= m && *b < both).any(|[a, b]| joined.contains(&[a, b - m]))
        };
        let (below, above) = (&self.onward[self.lower], reversed(&self.onward[1 - self.lower]));
        let pulled = |pull: f64| Loft::new(&edge(lower, below), &edge(upper, &above), pull, leaving);
        let loft = pulled(1.0);
        clock.stage("surface");
        let mut chosen = None;
        // Where the mesh joins the loops already, a row more keeps them apart.
        for least in [1, 2] {
            let cells = self.options.cells;
            let chooser = Chooser::new(lower, upper, &loft, self.options.rows, least, cells)?;
            let found = match cells {
                CellShape::Quad => chooser.squares(),
                CellShape::Triangle => {
                    chooser.lattice(progress.part(0.0, 0.6))?.unwrap_or_else(|| chooser.stacked())
                }
            };
            if apart(&found) {
                chosen = Some((chooser, found));
                break;
            }
        }
        let Some((chooser, found)) = chosen else {
            return Err(Error::NoPatch {
                reason: "every tube repeats an edge of the mesh".into(),
                at: self.vertices[self.loops[0].vertices[0] as usize].truncate().to_array(),
            });
        };
        clock.stage("grid");
        let mut best = self.placed(banks, &loft, &found, progress.part(0.6, 0.8))?;
        for (k, pull) in PULLS.into_iter().enumerate() {
            if best.folds == 0 {
                break;
            }
            let at = |k: usize| 0.8 + 0.1 * k as f64 / PULLS.len() as f64;
            let other = self.placed(banks, &pulled(pull), &found, progress.part(at(k), at(k + 1)))?;
            if other.folds < best.folds {
                best = other;
            }
        }
        let bad = best.folds > 0 || best.angles[0] < THIN;
        if self.options.cells == CellShape::Triangle && best.lattice && bad {
            let other = chooser.stacked();
            if apart(&other) {
                let other = self.placed(banks, &loft, &other, progress.part(0.9, 1.0))?;
                if other.folds < best.folds
                    || (other.folds == best.folds && other.angles[0] > 1.5 * best.angles[0])
                {
                    best = other;
                }
            }
        }
        clock.stage("fair");
        Ok(best)
    }

    /// The two loops run to the right, the lower one first.
    fn banks(&self, polygons: &[u32]) -> [Bank; 2] {
        let [low, high] = rings(&self.loops, self.lower, self.vertices);
        let wants = |k: usize| {
            let wanted = wanted(&self.loops[k].vertices, self.rim, polygons).into_iter();
            wanted.map(|edges| i64::from(edges - 1).clamp(2, 6)).collect::<Vec<_>>()
        };
        let twist = self.options.twist / std::f64::consts::TAU - best_fit(&low, &high);
        let lower = Bank { around: low.shares.clone(), ring: low, wanted: wants(self.lower) };
        let around = high.shares.iter().map(|share| share + twist).collect();
        let upper = Bank { around, ring: high, wanted: reversed(&wants(1 - self.lower)) };
        [lower, upper]
    }

    /// Edges of the mesh from one loop to the other: by the place in the lower and in the upper one.
    fn joined(&self) -> FxHashSet<[u32; 2]> {
        let upper = reversed(&self.loops[1 - self.lower].vertices);
        let places: rustc_hash::FxHashMap<u32, u32> = upper.iter().zip(0..).map(|(&v, k)| (v, k)).collect();
        let mut joined = FxHashSet::default();
        for (&v, k) in self.loops[self.lower].vertices.iter().zip(0..) {
            let near = self.rim.local(v).map(|v| self.rim.neighbours(v)).unwrap_or_default();
            let near = near.into_iter().map(|u| self.rim.ids[u as usize]);
            let loose = self.rim.loose.iter().filter(|edge| edge.contains(&v));
            for u in near.chain(loose.flatten().copied()) {
                joined.extend(places.get(&u).map(|&place| [k, place]));
            }
        }
        joined
    }

    fn placed(
        &self,
        banks: &[Bank; 2],
        loft: &Loft,
        chosen: &Chosen,
        progress: Progress<'_>,
    ) -> Result<Attempt> {
        let [lower, upper] = banks;
        let (m, n) = (lower.around.len(), upper.around.len());
        let tube = &chosen.tube;
        // Numbers of the tube's vertices in the patch.
        let first = self.loops[0].vertices.len();
        let number = |v: u32| {
            let v = v as usize;
            let at = |loop_: usize, k: usize| if loop_ == 0 { k } else { first + k };
            let place = if v < m {
                at(self.lower, v)
            } else if v < m + n {
                at(1 - self.lower, m + n - 1 - v)
            } else {
                v
            };
            place as u32
        };
        let loop_ = self.loops.iter().flat_map(|l| l.vertices.iter().copied()).collect::<Vec<_>>();
        let mut flat = vec![DVec2::ZERO; m + n + tube.around.len()];
        for (k, &around) in lower.around.iter().chain(&upper.around).enumerate() {
            flat[number(k as u32) as usize] = DVec2::new(around, if k < m { 0.0 } else { 1.0 });
        }
        // Edges grow evenly from loop to loop.
        let grow = (upper.ring.length * m as f64) / (lower.ring.length * n as f64);
        for (v, (&around, &height)) in tube.around.iter().zip(&tube.height).enumerate() {
            let even = (grow - 1.0).abs() < 1e-3;
            let height = if even { height } else { (libm::pow(grow, height) - 1.0) / (grow - 1.0) };
            flat[m + n + v] = DVec2::new(around, height);
        }
        let mut spots = flat[m + n..].iter().map(|p| loft.at(p.x, p.y)).collect::<Vec<_>>();
        let at = |v: u32| {
            let v = v as usize;
            loop_.get(v).map_or_else(|| spots[v - m - n].point, |&name| self.vertices[name as usize])
        };
        let halves = tube.quads.iter().flat_map(|quad| cut(quad.map(number), at));
        let triangles = halves.chain(tube.triangles.iter().map(|t| t.map(number))).collect::<Vec<_>>();
        let rings = if self.options.smooth == Smooth::Curvature { 2 } else { 1 };
        let mut work = Patchwork::new(&loop_, spots.len(), &triangles, self.rim, rings)?;
        work.later = vec![first];
        let work = work.of_quads(tube.quads.len());
        let mut positions = work_positions(&work, &loop_, self.vertices);
        for (position, spot) in positions[m + n..work.end].iter_mut().zip(&spots) {
            *position = spot.point;
        }
        settle(&work, loft, &mut flat, &mut spots, &mut positions, progress)?;
        let mut shape = Shape {
            work,
            loop_,
            reversed: self.loops[0].reversed,
            bridged: vec![Bridged {
                first,
                reversed: self.loops[1].reversed,
                pull: loft.pull,
                leaving: loft.leaving,
            }],
            flat,
            smooth: self.options.smooth,
            vertices: self.vertices.len(),
            positions,
            creases: vec![],
        };
        if self.options.smooth == Smooth::Curvature {
            shape.positions = shape.curved(shape.positions.clone(), progress)?;
        }
        if shape.positions.iter().any(|p| !p.is_finite()) {
            return Err(Error::Solver { stage: "bridge", reason: "a vertex is not finite".into() });
        }
        let angles = shape.work.corner_range(&shape.positions);
        let folds = folds(&shape.work, &shape.positions);
        Ok(Attempt { shape, lattice: chosen.lattice, rows: tube.rows, angles, folds })
    }

    fn finish(&self, attempt: Attempt, clock: Clock) -> Fill {
        let Attempt { shape, lattice, rows, angles: [min_angle, max_angle], folds } = attempt;
        let work = &shape.work;
        let loops = self.loops.iter().map(|l| l.vertices.as_slice());
        let [irregular, irregular_loop] = work.irregular(loops, self.rim, &self.options.polygons);
        let report = FillReport {
            triangles: work.single().len(),
            quads: work.quads,
            vertices: work.inner().len(),
            irregular,
            irregular_loop,
            grid: if lattice { Grid::Lattice } else { Grid::Graded },
            rows: rows.round() as usize,
            folded: false,
            rim_angle: rim_angle(work, &shape.positions),
            unrolling: Unrolling::default(),
            distortion: 0.0,
            winding_conflicts: self.conflicts,
            wire_edges: self.loops.iter().map(|l| l.wire).sum(),
            min_angle,
            max_angle,
            folds,
            self_intersections: 0,
            creases: 0,
            creases_kept: 0,
            repaired: 0,
            seconds: clock.seconds,
        };
        let given = |l: &Checked| if l.reversed { reversed(&l.vertices) } else { l.vertices.clone() };
        Fill::of(self.loops.iter().flat_map(given).collect(), shape, report)
    }
}

/// See [`onward`], for a loop of a mesh.
pub(in crate::fill) fn onward_of(loop_: &[u32], rim: &Rim, vertices: &[DVec3]) -> Vec<DVec3> {
    let apex = |k: usize| {
        let (a, b) = (rim.local(loop_[k])?, rim.local(loop_[(k + 1) % loop_.len()])?);
        let fan = rim.around(a).iter().map(|&t| rim.triangles[t as usize]);
        let triangle = fan.into_iter().find(|t| t.contains(&b))?;
        let v = triangle.into_iter().find(|&v| v != a && v != b)?;
        Some(vertices[rim.ids[v as usize] as usize])
    };
    let apexes = (0..loop_.len()).map(apex).collect::<Vec<_>>();
    let points = loop_.iter().map(|&v| vertices[v as usize]).collect::<Vec<_>>();
    onward(&points, &apexes)
}

/// The two loops run to the right, the lower one first.
fn rings(loops: &[Checked; 2], lower: usize, vertices: &[DVec3]) -> [Ring; 2] {
    let ring = |k: usize| Ring::new(loops[k].vertices.iter().map(|&v| vertices[v as usize]).collect());
    [ring(lower), ring(1 - lower).reversed()]
}
