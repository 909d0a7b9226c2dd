//! The patch in place of a strip: a tube, a fill, or the strip itself with even triangles.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::fair::fair;
use super::local::Local;
use super::polish::polish;
use super::regular::regularize;
use super::remesh::{Ground, flip_valences, mend_thin, remesh};
use super::site::Site;
use super::strips::Strip;
use super::take::{Taken, surroundings, take};
use crate::error::{Error, Result};
use crate::fill::surface::meet::{Box3, MOST, count_meetings, near_boxes};
use crate::fill::{BridgeOptions, Fill, FillOptions, bridge, fill_hole};
use crate::geometry::metrics::min_angle;
use crate::progress::Progress;

/// A patch with a smaller angle, in radians, is compared with others.
const THIN: f64 = 0.15;

/// A tube with a smaller one is compared with its faired self.
const FINE: f64 = 0.35;

/// How much of the fairing is tried, where all of it makes a patch meet something.
const SHARES: [f64; 4] = [1.0, 0.6, 0.3, 0.0];

/// Rounds of flips and fairing.
const ROUNDS: usize = 3;

/// How a patch was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A lattice tube between two rims.
    Tube,
    /// A grid patch in one rim.
    Fill,
    /// The union's own surface, triangulated anew.
    Strip,
}

/// What takes the place of a strip.
#[derive(Clone)]
pub(super) struct Patch {
    pub kind: Kind,
    /// Its new vertices.
    pub vertices: Vec<DVec3>,
    /// Numbers from that of the parts' vertices on are the new vertices.
    pub triangles: Vec<[u32; 3]>,
}

/// A patch and what is wrong with it.
struct Try {
    patch: Patch,
    meetings: usize,
    angle: f64,
}

impl Try {
    fn is_good(&self) -> bool {
        self.meetings == 0 && self.angle > THIN
    }
}

/// That of two with fewer meetings, or with rounder triangles; the first of equal ones.
fn better(a: Try, b: Try) -> Try {
    if (a.meetings, -a.angle) <= (b.meetings, -b.angle) { a } else { b }
}

impl Site<'_> {
    /// Closes one strip.
    ///
    /// # Errors
    /// [`Error::JoinFailed`], [`Error::Cancelled`].
    pub fn close(&self, strip: &Strip, progress: Progress<'_>) -> Result<Patch> {
        let grid = if self.options.blend > 0.0 { self.grid(strip, progress.part(0.0, 0.4))? } else { None };
        let grid = match grid {
            Some(it) if it.is_good() && it.angle > FINE => return Ok(it.patch),
            Some(it) => match self.settled(strip, &it.patch, progress.part(0.4, 0.5))? {
                Some(other) => Some(better(it, other)),
                None => Some(it),
            },
            None => None,
        };
        if let Some(it) = grid.as_ref().filter(|it| it.is_good()) {
            return Ok(it.patch.clone());
        }
        let own = if strip.sound { self.even(strip, progress.part(0.5, 1.0))? } else { None };
        let best = match (grid, own) {
            (Some(a), Some(b)) => better(a, b),
            (Some(it), None) | (None, Some(it)) => it,
            (None, None) => {
                let reason = "what was taken away there has no border of whole edges";
                return Err(Error::JoinFailed { reason, at: strip.at.into() });
            }
        };
        Ok(best.patch)
    }

    /// A tube or a fill, where the strip is an annulus or a disk.
    fn grid(&self, strip: &Strip, progress: Progress<'_>) -> Result<Option<Try>> {
        let rim = |k: usize| &self.outside.rims[strip.rims[k]][..];
        let (vertices, kept) = (&self.parts.vertices[..], &self.kept[..]);
        let (made, kind) = match (strip.rims.len(), strip.euler) {
            (2, 0) => {
                let options = BridgeOptions { polygons: self.polygons.clone(), ..BridgeOptions::default() };
                (bridge(vertices, kept, rim(0), rim(1), &options, progress), Kind::Tube)
            }
            (1, 1) => {
                let options = FillOptions { polygons: self.polygons.clone(), ..FillOptions::default() };
                (fill_hole(vertices, kept, rim(0), &options, progress), Kind::Fill)
            }
            _ => return Ok(None),
        };
        match made {
            Ok(Fill { vertices, triangles, report, .. }) => Ok(Some(Try {
                patch: Patch { kind, vertices, triangles },
                meetings: report.self_intersections,
                angle: report.min_angle,
            })),
            Err(Error::Cancelled) => Err(Error::Cancelled),
            // The strip itself is left to be tried.
            Err(_) => Ok(None),
        }
    }

    /// The triangles of a tube or a fill, faired as strips are; `None` for those that have no vertices inside.
    fn settled(&self, strip: &Strip, patch: &Patch, progress: Progress<'_>) -> Result<Option<Try>> {
        if patch.vertices.is_empty() {
            return Ok(None);
        }
        let n = self.parts.vertices.len() as u32;
        let border =
            strip.rims.iter().flat_map(|&k| self.outside.rims[k].iter().copied()).collect::<Vec<_>>();
        let place: FxHashMap<u32, u32> = border.iter().zip(0..).map(|(&v, k)| (v, k)).collect();
        let m = border.len() as u32;
        let number = |v: u32| if v < n { place.get(&v).copied() } else { Some(m + v - n) };
        let mut triangles = Vec::with_capacity(patch.triangles.len());
        for t in &patch.triangles {
            let [Some(a), Some(b), Some(c)] = t.map(number) else { return Ok(None) };
            triangles.push([a, b, c]);
        }
        let rims = border.iter().map(|&v| self.parts.vertices[v as usize]);
        let positions = rims.chain(patch.vertices.iter().copied()).collect();
        let sides = vec![0; triangles.len()];
        let mut local = Local::new(positions, triangles, sides, border.len());
        let beyond = surroundings(self, strip, &border, &place, &mut local);
        local.positions = fair(&local, &beyond, progress)?;
        polish(&mut local);
        let angle = min_angle(&local.positions, &local.triangles);
        let vertices = local.positions[border.len()..].to_vec();
        let patch = Patch { vertices, triangles: patch.triangles.clone(), ..*patch };
        let meetings = self.meetings(&patch, progress)?;
        Ok(Some(Try { patch, meetings, angle }))
    }

    /// The strip with even triangles, faired unless the line is to stay.
    fn even(&self, strip: &Strip, progress: Progress<'_>) -> Result<Option<Try>> {
        let Some(Taken { mut local, beyond, border }) = take(self, strip) else { return Ok(None) };
        let ground = Ground::of(&local);
        remesh(&mut local, &ground, progress.part(0.0, 0.5))?;
        let n = self.parts.vertices.len() as u32;
        let crease = self.options.blend == 0.0;
        if !crease {
            regularize(&mut local, &ground, progress.part(0.5, 0.6))?;
        }
        let flat = local.positions.clone();
        if !crease {
            for round in 0..ROUNDS {
                let at = |k: usize| 0.6 + 0.3 * k as f64 / ROUNDS as f64;
                local.positions = fair(&local, &beyond, progress.part(at(round), at(round + 1)))?;
                flip_valences(&mut local);
            }
            local.positions = fair(&local, &beyond, progress.part(0.9, 0.9))?;
            mend_thin(&mut local);
            polish(&mut local);
        }
        let faired = local.positions.clone();
        let m = local.border as u32;
        let name = |v: u32| if v < m { border[v as usize] } else { n + v - m };
        let triangles = local.triangles.iter().map(|t| t.map(name)).collect::<Vec<_>>();
        let mut best: Option<Try> = None;
        for share in if crease { &SHARES[3..] } else { &SHARES[..] } {
            let positions = flat.iter().zip(&faired).map(|(a, b)| a.lerp(*b, *share)).collect::<Vec<_>>();
            let angle = min_angle(&positions, &local.triangles);
            let patch = Patch {
                kind: Kind::Strip,
                vertices: positions[m as usize..].to_vec(),
                triangles: triangles.clone(),
            };
            let meetings = self.meetings(&patch, progress.part(0.9, 1.0))?;
            if best.as_ref().is_none_or(|best| (meetings, -angle) < (best.meetings, -best.angle)) {
                best = Some(Try { patch, meetings, angle });
            }
            if meetings == 0 {
                break;
            }
        }
        Ok(best)
    }

    /// How often a patch meets itself or what stays.
    fn meetings(&self, patch: &Patch, progress: Progress<'_>) -> Result<usize> {
        let n = self.parts.vertices.len();
        let at = |v: u32| {
            let v = v as usize;
            if v < n { self.parts.vertices[v] } else { patch.vertices[v - n] }
        };
        let around = Box3::around(patch.triangles.iter().flatten().map(|&v| at(v)));
        let near = near_boxes(&[around], &self.parts.vertices, &self.kept);
        let old = near[0].iter().map(|&t| self.kept[t as usize]).collect::<Vec<_>>();
        Ok(count_meetings(at, &patch.triangles, &old, false, MOST, progress)?.0)
    }
}
