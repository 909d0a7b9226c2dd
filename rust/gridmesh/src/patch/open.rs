//! One quad at a sharp corner of the drawing: the belt is opened there.
//!
//! The belt has two quads at every vertex of the rim, which bodies need; at a drawn corner each has half of its angle. In a
//! sheet one quad is better there. With c the vertex behind corner r, the belt's quads (c-1, c, r, r-1) and (c, c+1, r+1, r)
//! become (c-1, c, a, r-1), (c, c+1, r+1, b) and (c, a, r, b), where a and b are new on the rim before and behind r. A c of
//! three quads, where the lattice turns, becomes a regular vertex, so that a right angle has squares all around.

mod choose;
mod rim;

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::drawing::symmetry::Symmetry;
use crate::error::Result;
use crate::options::SketchOptions;
use crate::patch::deviation::Stray;
use crate::patch::judge::{CLOSE, Judge, Judgement, corners_of};
use crate::patch::mirror::{self, Partners};
use crate::patch::open::choose::{Belt, Opening};
use crate::patch::open::rim::{Opened, Sharpness};
use crate::patch::place::{QUAD_RINGS, in_units};
use crate::patch::placed::Placed;
use crate::patch::pockets::Fans;
use crate::path::mapping::Corner;
use crate::progress::Progress;
use crate::relax::{Band, Contour, RelaxOptions, Relaxation, Rim, Stars};

/// So often corners are taken back that cannot be opened, or have gained nothing.
const ROUNDS: usize = 8;

/// Vertices of quads at opened corners are done that move by less, in edges: squares show what is askew.
const TOLERANCE: f64 = 0.02;

/// The drawing may lie so much farther outside than before, in edges.
const MORE: f64 = 0.05;

/// The least corner of all may become so much sharper: it may have nothing to do with the corners opened.
const LEAST: f64 = 0.95;

/// A placement of belted quads with its sharp corners opened, and by how much it is not symmetric, in edges, if it is to be;
/// none if no corner is better so.
///
/// The same is proved of it as of the one given. Only vertices near opened corners have moved. `symmetry` comes with
/// the vertices that are each other's mirror images.
pub(crate) fn opened(
    contours: &[ClosedCurve],
    placed: &Placed,
    symmetry: Option<(&Symmetry, &Partners)>,
    options: &SketchOptions,
    progress: Progress<'_>,
) -> Result<Option<(Placed, Option<f64>)>> {
    let belt = Belt::new(placed, symmetry.map(|(_, partners)| partners));
    let mut openings = belt.openings();
    if openings.is_empty() {
        return Ok(None);
    }
    let lattice = &placed.patch.lattice;
    let drawn = in_units(contours, lattice);
    let corners = |contour| corners_of(contour, options.corner_angle, lattice.edge_length);
    let opener = Opener {
        contours,
        placed,
        options,
        lines: drawn.iter().map(|(points, arc)| Contour { points, arc }).collect(),
        found: contours.iter().map(corners).collect(),
        deviation: placed.max_deviation.max(CLOSE) + MORE,
    };
    let before = Sharpness::new(&placed.patch);
    let least = LEAST * before.least();
    for _ in 0..ROUNDS {
        if openings.is_empty() {
            break;
        }
        let opened = Opened::new(&belt, &openings, contours);
        let made = match (opener.relaxed(&opened, progress)?, symmetry) {
            (Ok(made), Some((symmetry, partners))) => {
                let partners = opened.partners(&belt, partners);
                mirror::symmetrised(contours, symmetry, &partners, made, options)
                    .map(|(made, error)| (made, Some(error)))
                    .map_err(|obstacle| vec![obstacle.at])
            }
            (made, _) => made.map(|made| (made, None)),
        };
        let worse: Vec<Opening> = match made {
            Ok((made, error)) => {
                let now = Sharpness::new(&made.patch);
                let faults: Vec<DVec2> = now.below(least).map(|v| made.patch.vertices[v]).collect();
                if !faults.is_empty() || made.lost() > placed.lost() {
                    belt.nearest(&openings, &faults)
                } else {
                    let is_worse = |one: &&Opening| {
                        !opened.keeps(&belt, &made.patch, one)
                            || opened.gain(&belt, (&before, &now), one) <= 0.0
                    };
                    let worse: Vec<Opening> = openings.iter().filter(is_worse).copied().collect();
                    if worse.is_empty() {
                        return Ok(Some((made, error)));
                    }
                    worse
                }
            }
            Err(faults) => belt.nearest(&openings, &faults),
        };
        openings.retain(|one| !worse.iter().any(|worse| belt.is_same(one, worse)));
    }
    Ok(None)
}

/// What opened quads are relaxed on, and held against.
struct Opener<'a> {
    contours: &'a [ClosedCurve],
    placed: &'a Placed,
    options: &'a SketchOptions,
    /// The contours in units of the lattice.
    lines: Vec<Contour<'a>>,
    /// Their corners.
    found: Vec<Vec<Corner>>,
    /// How far the drawing may lie outside, in edges.
    deviation: f64,
}

impl Opener<'_> {
    /// The placement of opened quads; or the places where it fails, as far as they are known.
    fn relaxed(
        &self,
        opened: &Opened,
        progress: Progress<'_>,
    ) -> Result<std::result::Result<Placed, Vec<DVec2>>> {
        let Opener { contours, placed, options, deviation, .. } = *self;
        let lattice = &placed.patch.lattice;
        let corners = <Band<4> as Stars>::corners(&opened.quads);
        let (lines, found) = (&self.lines, &self.found);
        let judge = Judge { contours, lattice, lines, found, corners: &corners, options, is_blunt: false };
        let mut fans = Fans::new(opened.positions.len(), &corners);
        let mut judged = |relaxation: &Relaxation<'_, 4>, rims: &[Rim]| {
            let vertices = relaxation.positions.iter().map(|&p| lattice.from_units(p)).collect();
            judge.judged(vertices, rims, &mut fans, progress)
        };
        let relaxed = RelaxOptions {
            rings: QUAD_RINGS,
            even_out: false,
            tolerance: TOLERANCE,
            ..RelaxOptions::default()
        };
        let mut rims = opened.rims.clone();
        let mut relaxation = Relaxation::<4>::new(&opened.quads, &opened.positions, lines, &rims, &relaxed)?;
        relaxation.settle_around(&opened.moved, progress)?;
        relaxation.store(&mut rims);
        let mut judgement = judged(&relaxation, &rims)?;
        // Where the drawing strays farther than it did, the rim is held nearer to it.
        let held = match &judgement {
            Judgement::Valid(made, strays, _) if made.max_deviation > deviation => {
                let mut strays = strays.clone();
                strays.retain(|stray| stray.distance > deviation * lattice.edge_length);
                judge.to_hold(strays, None, &rims)
            }
            Judgement::Far(strays) => judge.to_hold(strays.clone(), None, &rims),
            _ => Vec::new(),
        };
        if !held.is_empty() {
            relaxation.hold(&held, progress)?;
            relaxation.store(&mut rims);
            judgement = judged(&relaxation, &rims)?;
        }
        let places = |strays: &[Stray]| strays.iter().map(|stray| stray.point).collect::<Vec<_>>();
        Ok(match judgement {
            Judgement::Valid(mut made, mut strays, lost) => {
                strays.retain(|stray| stray.distance > deviation * lattice.edge_length);
                let mut faults = places(&strays);
                faults.extend(made.worn.iter().filter(|at| !placed.worn.contains(at)));
                if made.lost() > placed.lost() {
                    faults.extend(places(&lost));
                }
                made.patch.quads.clone_from(&opened.quads);
                if faults.is_empty() && made.lost() <= placed.lost() { Ok(*made) } else { Err(faults) }
            }
            Judgement::Inverted(obstacle) => Err(vec![obstacle.at]),
            Judgement::Far(strays) => Err(places(&strays)),
        })
    }
}
