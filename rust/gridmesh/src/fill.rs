//! Fills holes with grid patches whose boundary is the hole's, vertex for vertex.
//!
//! [`fill_hole`] fills one loop, [`fill_holes`] many; [`holes`] finds loops.

mod check;
mod develop;
mod exact;
mod fair;
mod fit;
pub(crate) mod flat;
mod flips;
mod graded;
mod grown;
pub mod holes;
mod lobes;
mod mean_value;
pub(crate) mod meet;
mod mesh;
mod one;
mod options;
mod parallel;
mod parts;
mod patchwork;
mod place;
mod quality;
mod regrid;
mod report;
mod reserve;
mod settle;
mod sharp;
mod small;
mod solver;
mod span;
mod sweep;
mod thin;
mod unroll;
mod walls;

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use rustc_hash::FxHashSet;

use self::check::{check_loop, check_near};
use self::meet::{Box3, MOST, count_meetings, is_graph, near_boxes};
use self::mesh::Rim;
pub use self::options::{FillOptions, Smooth};
use self::parallel::{in_parallel, steady};
pub use self::parts::FillParts;
use self::patchwork::Patchwork;
pub use self::regrid::{Regrid, regrid};
pub use self::report::{FillReport, Grid};
use self::reserve::{edges, groups, refuse_shared_edges};
pub use self::unroll::Unrolling;
use crate::error::{Error, Result};
use crate::progress::Progress;

/// Vertices this many rings of triangles around a loop must be finite.
const SOUND_RINGS: usize = 2;

/// A filled hole.
#[derive(Clone, Debug)]
pub struct Fill {
    /// The loop as it was given.
    pub loop_: Vec<u32>,
    /// The new vertices.
    pub vertices: Vec<DVec3>,
    /// The new triangles: numbers below that of the mesh's vertices are those, the following ones the new
    /// vertices in order. Wound against the triangles at the loop.
    pub triangles: Vec<[u32; 3]>,
    /// Numbers about it.
    pub report: FillReport,
    /// Edges of the patch along which a hard edge of the surroundings goes on, numbered as the triangles are.
    pub creases: Vec<[u32; 2]>,
    shape: Arc<Shape>,
}

/// What is needed to solve the same patch again.
#[derive(Clone, Debug)]
struct Shape {
    work: Patchwork,
    loop_: Vec<u32>,
    reversed: bool,
    flat: Vec<glam::DVec2>,
    smooth: Smooth,
    vertices: usize,
    positions: Vec<DVec3>,
    /// Hard edges; where there are some, `flat` has each planar part in a place of its own.
    creases: Vec<[u32; 2]>,
}

/// Fills one hole of a mesh, or a loop of edges without a mesh.
///
/// `loop_` holds the vertices of the hole's boundary in order, either way round, each once, at least three.
/// The result's boundary is exactly this loop: no vertex of it is moved and none is added, each of its
/// edges gets one new triangle, wound against its neighbour (against most of the neighbours, where they
/// disagree). The patch is a disk, and no new edge or face repeats one of the mesh. It may meet itself or
/// the mesh, as any filling of a knotted loop has to; the report counts this and `strict` refuses it.
///
/// With `sharp`, hard edges of the surroundings that run into the loop go on in the patch, if they meet in one line
/// or one point and the surface between them is planar; the report says how many do.
///
/// Work is local but for passes over the mesh that find the triangles near the loop. The same input
/// gives the same output for any number of threads.
///
/// # Errors
/// A loop that is not fit has its own variant for each reason: [`Error::IndexOutOfRange`],
/// [`Error::TooFewPoints`], [`Error::RepeatedVertex`], [`Error::FigureEight`], [`Error::NotFinite`],
/// [`Error::ExtremeSize`], [`Error::ZeroLengthEdge`], [`Error::SelfTouching`], [`Error::FacesOnBothSides`],
/// [`Error::NonManifold`]. [`Error::InvalidOption`]; [`Error::FillIntersects`] if `strict`; [`Error::Cancelled`].
/// Vertices within two rings of triangles around the loop have to be finite, wherever else they need not.
///
/// Source: Nealen et al. 2009, section V, for the patch. The paper leaves the positions of the inner
/// vertices to its surroundings (FiberMesh); here they come from [`Smooth`].
pub fn fill_hole(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    loop_: &[u32],
    options: &FillOptions,
    progress: Progress<'_>,
) -> Result<Fill> {
    let job = Job { vertices, triangles, options };
    let mut fills = steady(progress, |progress| job.run(&[Ok(loop_.to_vec())], progress))?;
    fills.pop().unwrap_or(Err(NO_ITEM))
}

const NO_ITEM: Error = Error::Internal { reason: "a loop has neither a fill nor an error" };

/// Fills the given loops, or all holes, as [`fill_hole`] does, in parallel.
///
/// Items come in the order of the loops. New vertices are numbered from the mesh's number of vertices
/// on in every item. A loop that cannot be filled does not stop the others. No new edge repeats one of
/// another fill.
///
/// # Errors
/// [`Error::IndexOutOfRange`] if a triangle of the mesh names a vertex that does not exist,
/// [`Error::Cancelled`]. Of an item: those of [`fill_hole`], and [`Error::SharedEdge`] if an earlier loop has
/// used one of its edges.
pub fn fill_holes(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    loops: Option<&[Vec<u32>]>,
    options: &FillOptions,
    progress: Progress<'_>,
) -> Result<Vec<Result<Fill>>> {
    let loops = match loops {
        Some(loops) => loops.iter().map(|l| Ok(l.clone())).collect(),
        None => {
            let mut found = holes::boundary_loops(vertices.len(), triangles)?;
            if let Some(most) = options.max_edges {
                found.retain(|l| l.as_ref().map_or(true, |l| l.len() <= most));
            }
            found
        }
    };
    steady(progress, |progress| Job { vertices, triangles, options }.run(&loops, progress))
}

struct Job<'a> {
    vertices: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    options: &'a FillOptions,
}

impl Job<'_> {
    fn run(&self, loops: &[Result<Vec<u32>>], progress: Progress<'_>) -> Result<Vec<Result<Fill>>> {
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
                        reserved.extend(fill.triangles.iter().flat_map(edges).filter(old));
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

    /// Counts what new triangles meet: the mesh, themselves, and those of fills that come before.
    fn count_meetings(&self, fills: &mut [Result<Fill>], progress: Progress<'_>) -> Result<()> {
        let since = Instant::now();
        let n = self.vertices.len() as u32;
        let done = fills.iter().flatten().map(|fill| {
            // New vertices of all fills get numbers of their own here.
            (fill.triangles.as_slice(), fill.vertices.as_slice(), fill.shape.as_ref())
        });
        let done = done.collect::<Vec<_>>();
        let mut first = vec![n];
        for (_, vertices, _) in &done {
            first.push(first[first.len() - 1] + vertices.len() as u32);
        }
        let owner = |v: u32| first.partition_point(|&f| f <= v) - 1;
        let position = |v: u32| {
            if v < n {
                self.vertices[v as usize]
            } else {
                let k = owner(v);
                done[k].1[(v - first[k]) as usize]
            }
        };
        let named = |k: usize| -> Vec<[u32; 3]> {
            done[k].0.iter().map(|t| t.map(|v| if v < n { v } else { v - n + first[k] })).collect()
        };
        let boxes = (0..done.len())
            .map(|k| Box3::around(named(k).iter().flatten().map(|&v| position(v))))
            .collect::<Vec<_>>();
        let near = near_boxes(&boxes, self.vertices, self.triangles);
        let count = |&k: &usize, progress: Progress<'_>| {
            let mut others = near[k].iter().map(|&t| self.triangles[t as usize]).collect::<Vec<_>>();
            others.extend((0..k).filter(|&j| boxes[j].meets(&boxes[k])).flat_map(named));
            let (around, positions, own) = done[k].2.graph();
            let apart = is_graph(around, positions, own);
            count_meetings(position, &named(k), &others, apart, MOST, progress)
        };
        let counts = match (0..done.len()).collect::<Vec<_>>().as_slice() {
            [] => vec![],
            [single] => vec![count(single, progress)?],
            several => in_parallel(several, |&k| done[k].0.len(), progress, count)?,
        };
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
}

impl Fill {
    /// Extends data at the loop (`columns` values for each of its vertices, in the order of the loop as
    /// given, row by row) to the new vertices: harmonically, one factorisation for all columns, each
    /// value within the range of its column.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] if the number of values does not fit, [`Error::NotFinite`].
    pub fn extend(&self, values: &[f64], columns: usize) -> Result<Vec<f64>> {
        self.shape.extend(values, columns)
    }

    /// The new vertices if those of the mesh were at `vertices`: the same triangles, solved again. For
    /// other poses of one mesh, such as shape keys; where the surroundings are equal, so is the result.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] if there are not as many vertices as before, [`Error::NotFinite`] for one near
    /// the loop.
    pub fn refit(&self, vertices: &[DVec3]) -> Result<Vec<DVec3>> {
        if vertices.len() != self.shape.vertices {
            return Err(Error::InvalidOption {
                name: "vertices",
                value: format!("of length {}", vertices.len()),
                allowed: "as many vertices as the filled mesh has",
            });
        }
        let near = self.shape.loop_.iter().chain(&self.shape.work.outer);
        if let Some(&v) = near.into_iter().find(|&&v| !vertices[v as usize].is_finite()) {
            return Err(Error::NotFinite { what: "mesh".into(), point: v as usize });
        }
        if !self.shape.creases.is_empty() {
            return self.shape.carried(vertices);
        }
        let positions = self.shape.solve(vertices, Progress::NONE)?.positions;
        Ok(positions[self.shape.work.inner()].to_vec())
    }
}

impl PartialEq for Fill {
    fn eq(&self, other: &Self) -> bool {
        self.vertices == other.vertices && self.triangles == other.triangles && self.loop_ == other.loop_
    }
}

/// Seconds per stage.
struct Clock {
    since: Instant,
    seconds: Vec<(&'static str, f64)>,
}

impl Clock {
    fn new() -> Self {
        Clock { since: Instant::now(), seconds: vec![] }
    }

    fn stage(&mut self, name: &'static str) {
        let elapsed = self.since.elapsed().as_secs_f64();
        match self.seconds.iter_mut().find(|(known, _)| *known == name) {
            Some((_, seconds)) => *seconds += elapsed,
            None => self.seconds.push((name, elapsed)),
        }
        self.since = Instant::now();
    }
}
