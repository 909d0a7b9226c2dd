//! Caps: regions of the swept surface, unrolled, filled vertex for vertex, and rolled up again.

use glam::DVec2;
use rustc_hash::FxHashSet;

use super::bridge::Bridges;
use super::bulge::Bulged;
use super::loops::Loops;
use super::mirrored;
use super::regions::{self, Region, Spot};
use crate::cut::caps::capper::{Capper, Caps, LARGE};
use crate::cut::cutting::Cutting;
use crate::cut::divide::parted::Parted;
use crate::cut::report::{CutReport, Tally};
use crate::cut::sheet::Sheet;
use crate::error::{Error, Result};
use crate::fill::options::Smooth;
use crate::fill::parallel::in_parallel;
use crate::options::CellShape;
use crate::progress::Progress;

/// Polygons filled between two reports of progress.
const BATCH: usize = 16;

/// Closes the pieces along the cut, with the same faces for both.
pub(in crate::cut) fn close(
    cutting: Cutting<'_>,
    parted: &Parted,
    sheet: &Sheet,
    loops: &Loops,
    tally: &mut Tally,
    progress: Progress<'_>,
) -> Result<Caps> {
    let before = tally.report.clone();
    if let Some(caps) = close_with(false, cutting, parted, sheet, loops, tally, progress.part(0.0, 0.9))? {
        return Ok(caps);
    }
    // A cap bulges through the place of another one, which has to lie flat: then all leave room for that.
    tally.report = before;
    let caps = close_with(true, cutting, parted, sheet, loops, tally, progress.part(0.9, 1.0))?;
    caps.ok_or(Error::Internal { reason: "no caps were made" })
}

/// With `careful` each bulging cap leaves room for the others, if they come to lie flat. Without it `None` if one lies flat and
/// meets another.
fn close_with(
    careful: bool,
    cutting: Cutting<'_>,
    parted: &Parted,
    sheet: &Sheet,
    loops: &Loops,
    tally: &mut Tally,
    progress: Progress<'_>,
) -> Result<Option<Caps>> {
    let first = (parted.n_old + parted.nodes.len()) as u32;
    let seams = mirrored::close(cutting.vertices, parted, sheet, loops, &cutting.options.mirrors, first);
    tally.report.open_lines -= seams.outlines.len();
    let found = regions::find(cutting.vertices, parted, sheet, loops, seams.outlines);
    let mut capper = Capper {
        cutting,
        parted,
        sheet,
        edges: FxHashSet::default(),
        facets: FxHashSet::default(),
        first,
        caps: Caps::new(seams.vertices),
        seams: seams.edges,
    };
    capper.reserve();
    let report = &mut tally.report;
    report.uncapped = found.uncapped;
    report.caps = found.regions.len();
    let smooth = cutting.options.smooth;
    let (mut polygons, mut bulging, mut rings) = (vec![], vec![], vec![]);
    for region in found.regions {
        match region {
            Region::Sheet { outline, holes } if holes.is_empty() => {
                let is_seamed = outline.iter().any(|s| s.node >= first);
                let is_flat = smooth == Smooth::Flat || is_seamed;
                report.flat_caps += usize::from(smooth != Smooth::Flat && is_seamed);
                if is_flat { &mut polygons } else { &mut bulging }.push(outline);
            }
            ring => {
                report.rings += 1;
                report.flat_caps += usize::from(smooth != Smooth::Flat);
                match capper.ring(&ring, progress.part(0.0, 0.0))? {
                    Some((rim, patch)) => {
                        capper.roll_up(&rim, &patch, found.inverted, progress.part(0.0, 0.0))?;
                        rings.push(rim);
                    }
                    None => polygons.extend(opened(&mut capper, ring, report)?),
                }
            }
        }
    }
    fill_flat(&mut capper, &polygons, found.inverted, report, progress.part(0.0, 0.5))?;
    let mut flat = vec![];
    if careful {
        for outline in &bulging {
            let plan = capper.plan(outline, progress.part(0.5, 0.5))?;
            flat.push(capper.placed(outline, &plan.patch));
        }
    }
    for (k, outline) in bulging.iter().enumerate() {
        let here = k as f64 / bulging.len() as f64;
        let later = flat.get(k + 1..).unwrap_or_default();
        match capper.bulge(
            outline,
            later,
            found.inverted,
            progress.part(0.5 + 0.5 * here, 0.5 + 0.5 * here),
        )? {
            Bulged::Whole => continue,
            Bulged::Reduced => {
                report.reduced_caps += 1;
                continue;
            }
            Bulged::Flat => report.reduced_caps += 1,
        }
        let plan = capper.plan(outline, progress.part(1.0, 1.0))?;
        report.folded += usize::from(plan.folded);
        if !careful && capper.meets_caps(&capper.placed(outline, &plan.patch), progress.part(1.0, 1.0))? {
            return Ok(None);
        }
        capper.roll_up(outline, &plan.patch, found.inverted, progress)?;
    }
    capper.name_sources(polygons.iter().chain(&rings).flatten());
    progress.report(1.0)?;
    capper.prove()?;
    progress.report(1.0)?;
    capper.measure(tally);
    Ok(Some(capper.caps))
}

/// How many closed lines will have no cap.
pub(in crate::cut) fn uncapped(cutting: Cutting<'_>, parted: &Parted, sheet: &Sheet, loops: &Loops) -> usize {
    let first = (parted.n_old + parted.nodes.len()) as u32;
    let seams = mirrored::close(cutting.vertices, parted, sheet, loops, &cutting.options.mirrors, first);
    regions::find(cutting.vertices, parted, sheet, loops, seams.outlines).uncapped
}

/// Simple polygons that cover a region with holes, or one around a closed sheet.
fn opened(capper: &mut Capper<'_>, region: Region, report: &mut CutReport) -> Result<Vec<Vec<Spot>>> {
    let alone: Vec<Vec<Spot>> = match &region {
        Region::Sheet { outline, holes } => std::iter::once(outline).chain(holes).cloned().collect(),
        Region::Tube { .. } => vec![],
    };
    let mut bridges = Bridges {
        taken: &capper.edges,
        first: capper.first + capper.caps.vertices.len() as u32,
        even: capper.cutting.options.cells == CellShape::Quad,
        spots: vec![],
    };
    // An angle between rays of the eye as the length that it spans.
    let unit = if capper.sheet.view.central { region.height() } else { 1.0 };
    let opened = bridges.open(region.stretched(unit), unit * capper.sheet.width());
    let spots = bridges.spots;
    match opened {
        Some(mut opened) => {
            let new = spots.iter().map(|&at| capper.node(DVec2::new(at.x / unit, at.y))).collect::<Vec<_>>();
            capper.caps.vertices.extend(new);
            opened.iter_mut().flatten().for_each(|s| s.at.x /= unit);
            Ok(opened)
        }
        None if alone.is_empty() => Err(Error::CutFailed {
            reason: "the rim of a tunnel is too rough to be capped",
            at: capper.sheet.lift(0.0, 0.0).into(),
        }),
        None => {
            // Loops that are not apart: each is closed by itself.
            report.repeated += 1;
            Ok(alone)
        }
    }
}

/// Fills polygons of the unrolled sheet, in parallel, and rolls them up in order.
fn fill_flat(
    capper: &mut Capper<'_>,
    polygons: &[Vec<Spot>],
    inverted: bool,
    report: &mut CutReport,
    progress: Progress<'_>,
) -> Result<()> {
    let is_small = |a: &Vec<Spot>, b: &Vec<Spot>| a.len().max(b.len()) < LARGE;
    let batches = polygons.chunk_by(is_small).flat_map(|same| same.chunks(BATCH));
    let mut done = 0;
    for batch in batches {
        let part = |done: usize| done as f64 / polygons.len() as f64;
        let here = progress.part(part(done), part(done + batch.len()));
        here.report(0.0)?;
        done += batch.len();
        // Of several errors the first one counts, but for the wish to stop.
        let plan = |polygon: &Vec<Spot>, progress: Progress<'_>| match capper.plan(polygon, progress) {
            Err(Error::Cancelled) => Err(Error::Cancelled),
            plan => Ok(plan),
        };
        let plans: Vec<_> = match batch {
            [polygon] => vec![plan(polygon, progress.part(part(done), part(done)))?],
            _ => in_parallel(batch, Vec::len, here, plan)?,
        };
        for (polygon, plan) in batch.iter().zip(plans) {
            let mut plan = plan?;
            if capper.repeats(&[polygon], &plan.patch) {
                plan = capper.plan(polygon, progress.part(0.0, 0.0))?;
            }
            report.folded += usize::from(plan.folded);
            capper.roll_up(polygon, &plan.patch, inverted, here)?;
        }
    }
    Ok(())
}
