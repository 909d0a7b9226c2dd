//! Joins closed meshes to one, with even triangles where they meet.
//!
//! [`join()`] does it all. `parts` checks and numbers what is given, `pieces` and `overlap` find pieces of one part that overlap
//! each other and are joined as parts of their own, `union` finds out by an exact Boolean operation what is within
//! other parts and where surfaces meet, `collar` which faces lie near that, `rims` makes the borders of what stays simple loops,
//! `strips` finds the pieces of the union between them. For each one `patch` makes a tube or a fill, or, where it is neither an
//! annulus nor a disk, takes the piece itself (`take`); triangles are made even there with what `fill::even` has, or stay as they are
//! where no other patch will do. `assemble` puts all together and proves it closed.

mod assemble;
mod border;
mod collar;
mod fans;
mod options;
mod overlap;
mod parts;
mod patch;
mod pieces;
mod rims;
mod site;
mod strips;
mod take;
mod tries;
mod union;

pub use self::assemble::Joined;
use self::collar::{Curves, Left};
pub use self::options::{Border, JoinOptions, JoinReport};
pub use self::parts::Part;
use self::parts::Parts;
use self::pieces::volume;
use self::rims::Outside;
use self::site::Site;
use self::strips::{Strip, strips};
use self::tries::{Kind, Patch};
use self::union::Union;
use crate::error::{Error, Result};
use crate::fill::parallel::{in_parallel, steady};
use crate::geometry::disjoint::Disjoint;
use crate::progress::{Clock, Progress};

/// Times that the blend of curves in one collar is halved, until each has its own.
const HALVED: usize = 2;

/// The volume may grow or shrink by such a share of the exact union's; with wider blends than the default one by more, as what they
/// fill grows with the square of their width.
const GAINED: f64 = 0.03;

/// Times that the blend of curves becomes narrower whose patches would meet something, or be no blend but most of a part,
/// and how much; and how much where the volume changes too much.
const NARROWED: usize = 3;
const TIGHT: f64 = 0.5;
const SLIM: f64 = 0.7;

/// Joins closed meshes: one closed mesh of what is in any of them.
///
/// Where two surfaces meet, all faces within `blend` edge lengths of the line, to both sides along the surface, make room for one
/// patch, smooth to both sides: a lattice tube between two rims, a grid patch in one, otherwise the union's own surface with
/// even triangles, faired. With `blend` 0 the line stays as a crease, with even edges along it. Where the parts' faces are so large
/// that a patch would meet something or take most of a part away, the blend becomes narrower; so it does where the volume would
/// differ from the exact union's by more than 3 %, times the square of a blend wider than the default one. If that does not help the line
/// stays as a crease, and in the end the union's own triangles stay.
///
/// The result is closed and manifold and has the topology of the exact union; this is checked. Elsewhere all vertices and faces are
/// those of the parts, bit for bit, quads and polygons too (a part given inside out is turned; where faces of a part meet in a
/// vertex or along an edge alone, each side gets a vertex of its own). Parts that meet no other stay
/// pieces of their own, parts within others vanish; the report counts both. Where the collars of two lines would run
/// into each other, they become narrower; if that is not enough, they become one.
///
/// Patches may meet each other or the parts where these leave too little room; the report counts this and `strict` refuses it.
/// The same input gives the same bytes for any number of threads. Takes about 30 ms for a pair of parts of 2000 triangles.
///
/// # Errors
/// [`Error::InvalidOption`]; [`Error::NotFinite`], [`Error::ExtremeSize`], [`Error::InvalidFace`],
/// [`Error::IndexOutOfRange`] and [`Error::TooFewPoints`] for what is no mesh, [`Error::NotClosed`] for what is not closed;
/// [`Error::JoinFailed`] where parts meet in a way that leaves no room for a patch; [`Error::JoinIntersects`] if `strict`;
/// [`Error::TooLarge`] above 20 million triangles; [`Error::Cancelled`].
///
/// ```
/// use glam::DVec3;
/// use gridmesh::cut::Polygons;
/// use gridmesh::join::{JoinOptions, Part, join};
/// use gridmesh::Progress;
///
/// # fn main() -> Result<(), gridmesh::Error> {
/// // Two bars of 12 by 2 by 2 squares that cross.
/// let bar = |size: [i32; 3]| {
///     let (mut vertices, mut corners) = (Vec::<DVec3>::new(), vec![]);
///     let mut number = |p: DVec3| {
///         vertices.iter().position(|&q| q == p).unwrap_or_else(|| { vertices.push(p); vertices.len() - 1 }) as u32
///     };
///     for axis in 0..3 {
///         let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
///         for (side, i, j) in [-1, 1].into_iter().flat_map(|side| {
///             (-size[u]..size[u]).flat_map(move |i| (-size[v]..size[v]).map(move |j| (side, i, j)))
///         }) {
///             let mut face = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(a, b)| {
///                 let mut p = DVec3::ZERO;
///                 (p[axis], p[u], p[v]) = (f64::from(side * size[axis]), f64::from(a), f64::from(b));
///                 number(p)
///             });
///             if side < 0 {
///                 face.reverse();
///             }
///             corners.extend(face);
///         }
///     }
///     let offsets = (0..=corners.len() as u32).step_by(4).collect::<Vec<_>>();
///     (vertices, corners, offsets)
/// };
/// let (a, b) = (bar([12, 3, 3]), bar([2, 2, 12]));
/// let part = |bar: &'static (Vec<DVec3>, Vec<u32>, Vec<u32>)| Part {
///     vertices: &bar.0,
///     faces: Polygons { corners: &bar.1, offsets: &bar.2 },
/// };
/// let parts = [a, b].map(|bar| part(Box::leak(Box::new(bar))));
/// let joined = join(&parts, &JoinOptions::default(), Progress::NONE)?;
/// assert_eq!((joined.report.components, joined.report.genus, joined.report.collars), (1, 0, 2));
/// # Ok(())
/// # }
/// ```
///
/// Source: the union is that of the crate `manifold-rust` (after Manifold, by Emmett Lalish and others); lattice tubes as of
/// [`bridge`](crate::fill::bridge()).
pub fn join(parts: &[Part<'_>], options: &JoinOptions, progress: Progress<'_>) -> Result<Joined> {
    steady(progress, |progress| joined(parts, options, progress))
}

fn joined(given: &[Part<'_>], options: &JoinOptions, progress: Progress<'_>) -> Result<Joined> {
    options.check(given.len())?;
    if given.is_empty() {
        let allowed = "one closed mesh or more";
        return Err(Error::InvalidOption { name: "parts", value: "empty".into(), allowed });
    }
    progress.report(0.0)?;
    let mut clock = Clock::new();
    let parts = &Parts::new(given, progress.part(0.0, 0.05))?;
    clock.stage("check");
    let union = Union::new(parts, progress.part(0.05, 0.4))?;
    clock.stage("union");
    let seams = union.seams(parts);
    let left = Left::new(parts, &union, &seams);
    let curves = Curves::new(parts, &union, &seams);
    let mut report = JoinReport {
        turned: parts.turned,
        separated: parts.separated,
        curves: curves.count,
        overlapping: parts.overlapping(),
        ..JoinReport::default()
    };
    (report.alone, report.swallowed) = apart(parts, &union, &seams);
    let stage = Stage { parts, union: &union, left: &left, curves: &curves, seams: &seams, options };
    clock.stage("lines");
    let mut most = vec![1.0; curves.count];
    let enclosed = volume(&union.vertices, &union.triangles);
    let mut rounds = if options.blend > 0.0 { NARROWED } else { 0 };
    let mut from = 0.4;
    let allowed = stage.allowed(enclosed);
    let mut each = f64::INFINITY;
    let mut before = None;
    let Closed { site, strips, mut patches } = loop {
        let to = 0.5 * (from + 0.9);
        let closed = stage.closed(&most, each, before, progress.part(from, to))?;
        let scales = stage.narrowed(&most, allowed, &closed);
        let done = each.is_finite() || options.blend == 0.0 || gained(&closed.patches).abs() <= allowed;
        if rounds > 0 && scales != most {
            most = scales;
            rounds -= 1;
        } else if done {
            break closed;
        } else {
            // No narrower blend changes the volume less: patches that do not change it that much at all.
            each = share(allowed, &closed.patches);
            rounds = 0;
        }
        before = Some(closed);
        from = to;
    };
    clock.stage("patches");
    let sides = match options.border {
        Border::None => vec![],
        _ => border(&site, &strips, &mut patches, progress.part(0.9, 0.9))?,
    };
    clock.stage("border");
    let patches = strips.into_iter().map(|strip| strip.rims).zip(patches).collect::<Vec<_>>();
    let last = progress.part(0.9, 1.0);
    let mut made = Joined::new(&site, &patches, &sides, report, last)?;
    clock.stage("assemble");
    made.report.seconds = clock.seconds;
    progress.report(1.0)?;
    Ok(made)
}

/// Lets the line between the parts run along edges of all patches; the part of each of their triangles.
fn border(
    site: &Site<'_>,
    strips: &[Strip],
    patches: &mut [Patch],
    progress: Progress<'_>,
) -> Result<Vec<i32>> {
    let each =
        strips.iter().zip(patches).map(|(strip, patch)| border::straighten(site, strip, patch, progress));
    Ok(each.collect::<Result<Vec<_>>>()?.concat())
}

/// Strips and what takes their place.
struct Closed<'a> {
    site: Site<'a>,
    strips: Vec<Strip>,
    patches: Vec<Patch>,
}

/// What the collars are made from.
struct Stage<'a> {
    parts: &'a Parts,
    union: &'a Union,
    left: &'a Left,
    curves: &'a Curves,
    seams: &'a [([u32; 2], [u32; 2])],
    options: &'a JoinOptions,
}

impl<'a> Stage<'a> {
    fn attempt(&self, scales: &[f64]) -> Result<(Outside, Vec<Strip>)> {
        let gone = self.curves.near(self.parts, self.left, self.options, scales);
        let outside = Outside::new(self.parts, self.left, gone);
        let mut found = strips(self.parts, self.union, &outside)?;
        let mut owner = vec![0; self.union.triangles.len()];
        for (k, strip) in found.iter().enumerate() {
            strip.triangles.iter().for_each(|&t| owner[t as usize] = k);
        }
        for ((_, [t, _]), &curve) in self.seams.iter().zip(&self.curves.seams) {
            found[owner[*t as usize]].curves.push(curve);
        }
        for strip in &mut found {
            strip.curves.sort_unstable();
            strip.curves.dedup();
        }
        Ok((outside, found))
    }

    /// The strips and what takes their place, if the blend of each curve is at most so many times what is asked for, and each
    /// patch but the exact one may change the volume by `allowed`. Those of before, if the same faces stay.
    fn closed(
        &self,
        most: &[f64],
        allowed: f64,
        before: Option<Closed<'a>>,
        progress: Progress<'_>,
    ) -> Result<Closed<'a>> {
        let &Stage { parts, union, seams, options, .. } = self;
        let (outside, strips) = self.collars(most, progress.part(0.0, 0.2))?;
        if let Some(before) = before
            && before.site.allowed == allowed
            && before.site.outside.faces == outside.faces
        {
            return Ok(before);
        }
        let (mut kept, mut polygons) = (vec![], vec![]);
        for (&t, &f) in parts.triangles.iter().zip(&parts.face_of) {
            if outside.faces[f as usize] {
                kept.push(t);
                polygons.push(f);
            }
        }
        let site = Site { parts, union, seams, outside, options, kept, polygons, allowed };
        let each = |strip: &Strip, progress: Progress<'_>| site.close(strip, progress);
        let closing = progress.part(0.2, 1.0);
        let patches = match strips.as_slice() {
            [strip] => vec![each(strip, closing)?],
            _ => in_parallel(&strips, |strip| strip.triangles.len(), closing, each)?,
        };
        Ok(Closed { site, strips, patches })
    }

    /// By how much all patches together may change the volume of the union, which is `enclosed`.
    fn allowed(&self, enclosed: f64) -> f64 {
        let wide = (self.options.blend / JoinOptions::default().blend).max(1.0);
        GAINED * wide * wide * enclosed
    }

    /// How much of the blend of each curve to take instead: less where a patch is no blend, or much of the volume that is gained
    /// more than `allowed`.
    fn narrowed(&self, most: &[f64], allowed: f64, closed: &Closed<'_>) -> Vec<f64> {
        let Closed { strips, patches, .. } = closed;
        let gained = gained(patches);
        let much = gained.abs() > allowed;
        let mut scales = most.to_vec();
        for (strip, patch) in strips.iter().zip(patches) {
            let scale = if [Kind::Crease, Kind::Exact].contains(&patch.kind) {
                TIGHT
            } else if much && patch.gained / gained > 0.5 / patches.len() as f64 {
                // More than half of an equal share.
                SLIM
            } else {
                continue;
            };
            strip.curves.iter().for_each(|&c| scales[c] = most[c] * scale);
        }
        scales
    }

    /// What stays, and the strips between; collars of several curves, and those that are not annuli, are made narrower as
    /// long as that helps.
    fn collars(&self, most: &[f64], progress: Progress<'_>) -> Result<(Outside, Vec<Strip>)> {
        let mut scales = most.to_vec();
        let simple = |strip: &Strip| {
            strip.sound && strip.rims.len() == 2 && strip.euler == 0 && strip.curves.len() == 1
        };
        for round in 0..=HALVED {
            progress.report(round as f64 / (HALVED + 1) as f64)?;
            let made = self.attempt(&scales)?;
            let narrow = made.1.iter().filter(|s| !simple(s)).collect::<Vec<_>>();
            if narrow.is_empty() {
                return Ok(made);
            }
            if round == HALVED {
                break;
            }
            narrow.iter().flat_map(|s| &s.curves).for_each(|&c| scales[c] *= 0.5);
        }
        // Those for which it did not help have all the blend that they can have.
        let narrow = self.attempt(&scales)?;
        let mut wide_scales = scales.clone();
        for strip in narrow.1.iter().filter(|s| !simple(s)) {
            strip.curves.iter().for_each(|&c| wide_scales[c] = most[c]);
        }
        let wide = self.attempt(&wide_scales)?;
        Ok(if wide.1.iter().all(|s| s.sound) { wide } else { narrow })
    }
}

/// What the volume gains by all patches.
fn gained(patches: &[Patch]) -> f64 {
    patches.iter().map(|patch| patch.gained).sum()
}

/// The most that each patch may gain or lose, if all that do so with the sum may gain or lose `allowed`: what some do not need is
/// left for the others.
fn share(allowed: f64, patches: &[Patch]) -> f64 {
    let sign = gained(patches).signum();
    let mut wanted = patches.iter().map(|patch| (patch.gained * sign).max(0.0)).collect::<Vec<_>>();
    wanted.sort_by(f64::total_cmp);
    let (mut left, mut count) = (allowed, wanted.len());
    for own in wanted {
        if own > left / count as f64 {
            break;
        }
        (left, count) = (left - own, count - 1);
    }
    left / count.max(1) as f64
}

/// How many parts meet no other one, and of how many, or pieces of them that overlap others, nothing is left.
fn apart(parts: &Parts, union: &Union, seams: &[([u32; 2], [u32; 2])]) -> (usize, usize) {
    let count = parts.len();
    let mut sets = Disjoint::new(count);
    let mut left = vec![false; parts.solids.len()];
    (0..union.triangles.len()).for_each(|t| left[union.solid(parts, t)] = true);
    let part = |t: u32| parts.solids[union.solid(parts, t as usize)].part as u32;
    seams.iter().for_each(|&(_, [s, t])| sets.join(part(s), part(t)));
    let mut sizes = vec![0; count];
    (0..count as u32).for_each(|p| sizes[sets.root(p) as usize] += 1);
    let mut is_left = vec![false; count];
    parts.solids.iter().zip(&left).for_each(|(solid, &own)| is_left[solid.part] |= own);
    let alone = (0..count as u32).filter(|&p| is_left[p as usize] && sizes[sets.root(p) as usize] == 1);
    (alone.count(), left.iter().filter(|l| !**l).count())
}
