//! The patch in place of a strip: a tube, a fill, or the strip itself, with even triangles or as it is.

use std::cell::OnceCell;
use std::collections::BTreeSet;

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::site::Site;
use super::strips::Strip;
use super::take::{Taken, surroundings, take};
use super::tries::{Kind, Patch, Try, better};
use crate::error::{Error, Result};
use crate::fill::even::fair::{Beyond, fair};
use crate::fill::even::local::Local;
use crate::fill::even::polish::polish;
use crate::fill::even::regular::{regularize, regularize_beside};
use crate::fill::even::remesh::{Ground, flip_valences, mend_thin, remesh};
use crate::fill::even::slivers::mend_slivers;
use crate::fill::even::untangle::{Near, tangled, untangle};
use crate::fill::{BridgeOptions, Fill, FillOptions, bridge, fill_hole};
use crate::geometry::metrics::min_angle;
use crate::progress::Progress;

/// Rounds of flips and fairing.
const ROUNDS: usize = 3;

/// Times that a strip is made anew with shorter edges where it meets something.
const FINER: usize = 3;

/// So much of the volume of all parts but the largest may be gained or lost by a patch; it would not be a blend otherwise.
const CHANGED: f64 = 0.3;

/// A strip that wants more even triangles than so many, and so many times its own, stays as it is.
const MANY: (f64, f64) = (4_000.0, 3.0);

/// A strip with more triangles, or pairs of them, that meet something is not tried again with shorter or less regular edges: of 380 such
/// strips between meshes of things none came out well.
const HOPELESS: usize = 40;

/// How much shorter, and how far around in edge lengths, at full strength and fading out.
const SHORTER: f64 = 0.6;
const AROUND: [f64; 2] = [2.0, 6.0];

/// Times that triangles are made more regular anew, with more that stay as they are, and how far around what met something, in edge
/// lengths.
const HELD: usize = 4;
const BESIDE: f64 = 2.0;

/// Steps in which it is found how much of a faired patch the volume allows.
const HALVINGS: usize = 6;

/// A strip with what lies around it.
struct Place<'a> {
    site: &'a Site<'a>,
    strip: &'a Strip,
    /// The parts' vertices of its rims, and their numbers.
    border: Vec<u32>,
    place: FxHashMap<u32, u32>,
    near: OnceCell<Near>,
}

impl Site<'_> {
    /// Closes one strip.
    ///
    /// # Errors
    /// [`Error::JoinFailed`], [`Error::Cancelled`].
    pub fn close(&self, strip: &Strip, progress: Progress<'_>) -> Result<Patch> {
        let border = strip.border(&self.outside);
        let place = border.iter().zip(0..).map(|(&v, k)| (v, k)).collect();
        Place { site: self, strip, border, place, near: OnceCell::new() }.close(progress)
    }
}

impl Place<'_> {
    fn close(&self, progress: Progress<'_>) -> Result<Patch> {
        let strip = self.strip;
        let blend = self.site.options.blend > 0.0;
        let mut best = if blend { self.grid(progress.part(0.0, 0.3))? } else { None };
        if let Some(it) = best.take() {
            if it.is_good() {
                return Ok(it.patch);
            }
            let other = self.refined(&it.patch, progress.part(0.3, 0.5))?;
            let it = other.into_iter().fold(it, better);
            if it.is_fine() && it.is_even() {
                return Ok(it.patch);
            }
            best = Some(it);
        }
        if strip.sound
            && let Some(taken) = take(self.site, strip, !blend)
        {
            let kind = Kind::Strip;
            best = best.into_iter().chain(self.even(&taken, kind, progress.part(0.5, 0.8))?).reduce(better);
            if blend
                && !best.as_ref().is_some_and(Try::is_sound)
                && let Some(creased) = take(self.site, strip, true)
            {
                let creased = self.even(&creased, Kind::Crease, progress.part(0.8, 0.9))?;
                best = best.into_iter().chain(creased).reduce(better);
            }
            if !best.as_ref().is_some_and(Try::is_sound) {
                // What meets there does so in the parts.
                let own = self.tried(&taken.local, &[], Kind::Exact);
                best = best.into_iter().chain([own]).reduce(better);
            }
        }
        best.map(|it| it.patch).ok_or_else(|| {
            let reason = "what was taken away there has no border of whole edges";
            Error::JoinFailed { reason, at: strip.at.into() }
        })
    }

    /// What stays near the strip.
    fn near(&self) -> &Near {
        self.near.get_or_init(|| self.site.near(self.strip, &self.place))
    }

    /// A tube or a fill, where the strip is an annulus or a disk.
    fn grid(&self, progress: Progress<'_>) -> Result<Option<Try>> {
        let (site, strip) = (self.site, self.strip);
        let rim = |k: usize| &site.outside.rims[strip.rims[k]][..];
        let (vertices, kept) = (&site.parts.vertices[..], &site.kept[..]);
        let (made, kind) = match (strip.rims.len(), strip.euler) {
            (2, 0) => {
                let options = BridgeOptions { polygons: site.polygons.clone(), ..BridgeOptions::default() };
                (bridge(vertices, kept, rim(0), rim(1), &options, progress), Kind::Tube)
            }
            (1, 1) => {
                let options = FillOptions { polygons: site.polygons.clone(), ..FillOptions::default() };
                (fill_hole(vertices, kept, rim(0), &options, progress), Kind::Fill)
            }
            _ => return Ok(None),
        };
        match made {
            Ok(Fill { vertices, triangles, report, .. }) => Ok(Some(Try {
                patch: self.patch(kind, vertices, triangles),
                meetings: report.self_intersections,
                angle: report.min_angle,
                odd: report.irregular + report.irregular_loop,
                places: vec![],
            })),
            Err(Error::Cancelled) => Err(Error::Cancelled),
            // The strip itself is left to be tried.
            Err(_) => Ok(None),
        }
    }

    /// The triangles of a tube or a fill, made more regular and faired as strips are; `None` for those that have no vertices
    /// inside.
    fn refined(&self, patch: &Patch, progress: Progress<'_>) -> Result<Option<Try>> {
        if patch.vertices.is_empty() {
            return Ok(None);
        }
        let Some(mut local) = patch.local(self.site, &self.border) else { return Ok(None) };
        let beyond = surroundings(self.site, self.strip, &self.border, &self.place, &mut local);
        let ground = Ground::of(&local);
        regularize(&mut local, Some(&ground), progress.part(0.0, 0.4))?;
        let (local, bad) = self.smoothed(local, &beyond, progress.part(0.4, 1.0))?;
        Ok(Some(self.tried(&local, &bad, patch.kind)))
    }

    /// The strip with even triangles, faired unless the line is to stay; with shorter edges where that would meet something. `None` if
    /// there would be too many.
    fn even(&self, taken: &Taken, kind: Kind, progress: Progress<'_>) -> Result<Option<Try>> {
        let (mut given, beyond) = (taken.local.clone(), &taken.beyond);
        let ground = Ground::of(&given);
        let crease = kind == Kind::Crease || self.site.options.blend == 0.0;
        let many = MANY.0 + MANY.1 * given.triangles.len() as f64;
        let mut best: Option<Try> = None;
        for level in 0..=FINER {
            if given.even_triangles() > many {
                break;
            }
            let part =
                progress.part(level as f64 / (FINER + 1) as f64, (level + 1) as f64 / (FINER + 1) as f64);
            let mut local = given.clone();
            remesh(&mut local, &ground, part.part(0.0, 0.4))?;
            if local.triangles.len() as f64 > many {
                break;
            }
            let made = if crease {
                let bad = tangled(&local, self.near(), part.part(0.4, 1.0))?;
                self.tried(&local, &bad, kind)
            } else {
                self.regular(local, &ground, beyond, kind, part.part(0.4, 1.0))?
            };
            let (places, far) = (made.places.clone(), made.patch.far);
            let hopeless = made.meetings > HOPELESS
                || best.as_ref().is_some_and(|best| 2 * made.meetings > best.meetings);
            best = best.into_iter().chain([made]).reduce(better);
            if places.is_empty() || far || hopeless {
                break;
            }
            if crease && std::mem::take(&mut given.merges) {
                continue;
            }
            for v in given.border..given.positions.len() {
                let (p, size) = (given.positions[v], given.sizes[v]);
                let distance = places.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min) / size;
                let fade = ((distance - AROUND[0]) / (AROUND[1] - AROUND[0])).clamp(0.0, 1.0);
                given.sizes[v] *= SHORTER + (1.0 - SHORTER) * fade;
            }
        }
        Ok(best)
    }

    /// Even triangles, made more regular and faired; where that meets something, more regular only where it does not.
    fn regular(
        &self,
        plain: Local,
        ground: &Ground,
        beyond: &Beyond,
        kind: Kind,
        progress: Progress<'_>,
    ) -> Result<Try> {
        let mut local = plain.clone();
        regularize(&mut local, Some(ground), progress.part(0.0, 0.2))?;
        let (local, bad) = self.smoothed(local, beyond, progress.part(0.2, 0.4))?;
        let mut best = self.tried(&local, &bad, kind);
        if best.is_sound() || best.meetings > HOPELESS {
            return Ok(best);
        }
        let (sound, bad) = self.smoothed(plain, beyond, progress.part(0.4, 0.6))?;
        best = better(best, self.tried(&sound, &bad, kind));
        if !bad.is_empty() {
            return Ok(best);
        }
        match self.eased(&sound, beyond, progress.part(0.6, 1.0))? {
            Some(local) => Ok(better(best, self.tried(&local, &[], kind))),
            None => Ok(best),
        }
    }

    /// A finished patch that meets nothing, made more regular where that stays so.
    fn eased(&self, sound: &Local, beyond: &Beyond, progress: Progress<'_>) -> Result<Option<Local>> {
        let ground = Ground::of(sound);
        let (mut held, mut places): (Vec<u32>, Vec<DVec3>) = (vec![], vec![]);
        // How far from all places, in edge lengths.
        let far = |local: &Local, v: usize, places: &[DVec3]| {
            let near = places.iter().map(|q| q.distance(local.positions[v]));
            near.fold(f64::INFINITY, f64::min) / local.sizes[v]
        };
        for round in 0..HELD {
            let at = |k: usize| k as f64 / HELD as f64;
            let part = progress.part(at(round), at(round + 1));
            let mut local = sound.clone();
            regularize_beside(&mut local, Some(&ground), &held, part.part(0.0, 0.5))?;
            let bad = tangled(&local, self.near(), part.part(0.5, 0.6))?;
            if bad.is_empty() {
                let flat = local.positions.clone();
                let smooth = fair(&local, beyond, part.part(0.6, 0.8))?;
                for v in local.border..flat.len() {
                    let share = (far(&local, v, &places) / BESIDE - 1.0).clamp(0.0, 1.0);
                    local.positions[v] = flat[v].lerp(smooth[v], share);
                }
                if !untangle(&mut local, &flat, self.near(), polish, part.part(0.8, 0.9))?.is_empty() {
                    local.positions = flat;
                }
                mend_slivers(&mut local, self.near(), part.part(0.9, 1.0))?;
                return Ok(Some(local));
            }
            places.extend(bad.iter().map(|&t| middle(&local, t)));
            held = (0..sound.positions.len() as u32)
                .filter(|&v| far(sound, v as usize, &places) < BESIDE)
                .collect();
        }
        Ok(None)
    }

    /// With what triangles in place of the strip do to the volume.
    fn patch(&self, kind: Kind, vertices: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Patch {
        let Site { parts, union, .. } = self.site;
        let n = parts.vertices.len() as u32;
        // Both end at the same rims, so that any point may be the origin.
        let six =
            |[a, b, c]: [DVec3; 3]| (a - self.strip.at).dot((b - self.strip.at).cross(c - self.strip.at));
        let at = |v: u32| if v < n { parts.vertices[v as usize] } else { vertices[(v - n) as usize] };
        let own = |&t: &u32| union.triangles[t as usize].map(|v| union.vertices[v as usize]);
        let new = triangles.iter().map(|t| six(t.map(at))).sum::<f64>();
        let old = self.strip.triangles.iter().map(|t| six(own(t))).sum::<f64>();
        let of =
            self.strip.triangles.iter().map(|&t| union.solid(parts, t as usize)).collect::<BTreeSet<_>>();
        let volumes = of.into_iter().map(|solid| parts.solids[solid].volume).collect::<Vec<_>>();
        let smaller = volumes.iter().sum::<f64>() - volumes.iter().copied().fold(0.0, f64::max);
        let own = if volumes.len() > 1 { smaller } else { volumes.iter().sum() };
        let gained = (new - old) / 6.0;
        Patch {
            kind,
            vertices,
            triangles,
            gained,
            far: gained.abs() > (CHANGED * own).min(self.site.allowed),
        }
    }

    /// Fairs, as far as nothing meets by it; and the triangles that do.
    fn smoothed(
        &self,
        mut local: Local,
        beyond: &Beyond,
        progress: Progress<'_>,
    ) -> Result<(Local, Vec<u32>)> {
        let flat = local.positions.clone();
        for round in 0..ROUNDS {
            let at = |k: usize| 0.5 * k as f64 / ROUNDS as f64;
            local.positions = fair(&local, beyond, progress.part(at(round), at(round + 1)))?;
            flip_valences(&mut local);
        }
        local.positions = fair(&local, beyond, progress.part(0.5, 0.6))?;
        mend_thin(&mut local);
        self.lessened(&mut local, &flat);
        let bad = untangle(&mut local, &flat, self.near(), polish, progress.part(0.6, 0.95))?;
        if bad.is_empty() {
            mend_slivers(&mut local, self.near(), progress.part(0.95, 1.0))?;
        }
        Ok((local, bad))
    }

    /// Goes back to where all was before it was faired, as far as the volume asks for.
    fn lessened(&self, local: &mut Local, flat: &[DVec3]) {
        let faired = local.positions.clone();
        let much = |local: &Local| self.changed(local, Kind::Strip).gained.abs() > self.site.allowed;
        if !much(local) {
            return;
        }
        let mut share = [0.0, 1.0];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (share[0] + share[1]);
            for (p, (a, b)) in local.positions.iter_mut().zip(flat.iter().zip(&faired)) {
                *p = a.lerp(*b, middle);
            }
            share[usize::from(much(local))] = middle;
        }
        for (p, (a, b)) in local.positions.iter_mut().zip(flat.iter().zip(&faired)) {
            *p = a.lerp(*b, share[0]);
        }
    }

    /// The strip's triangles as the patch.
    fn changed(&self, local: &Local, kind: Kind) -> Patch {
        let n = self.site.parts.vertices.len() as u32;
        let m = local.border as u32;
        let name = |v: u32| if v < m { self.border[v as usize] } else { n + v - m };
        let vertices = local.positions[m as usize..].to_vec();
        self.patch(kind, vertices, local.triangles.iter().map(|t| t.map(name)).collect())
    }

    fn tried(&self, local: &Local, bad: &[u32], kind: Kind) -> Try {
        let off = |v: &u32| local.fan(*v).len() as i64 != local.wanted_at(*v);
        Try {
            patch: self.changed(local, kind),
            meetings: bad.len(),
            angle: min_angle(&local.positions, &local.triangles),
            odd: (0..local.positions.len() as u32).filter(off).count(),
            places: bad.iter().map(|&t| middle(local, t)).collect(),
        }
    }
}

/// The middle of a triangle.
fn middle(local: &Local, t: u32) -> DVec3 {
    local.corners(t).iter().sum::<DVec3>() / 3.0
}
