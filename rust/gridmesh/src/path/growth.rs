//! Growing a boundary from a seed (paper, section IV-B) and optimising it (section IV-D).

use std::collections::VecDeque;

use crate::error::Result;
use crate::lattice::axial::Axial;
use crate::lattice::boundary::{Boundary, Cell, Expansion, Journal};
use crate::lattice::dir::Dir;
use crate::path::raster::Raster;
use crate::progress::Progress;

/// Which refused points may become acceptable after an expansion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watch {
    /// Those beside the new point: enough if acceptance depends on the point and its link.
    Point,
    /// Those beside the ends of its arc too, whose turns have changed.
    Ends,
}

/// Expands the boundary breadth first by every valid adjacent point that `admit` lets in, until
/// none is left. Returns the number of points added.
///
/// The queue starts with the points beside the boundary, in the order of the path. A point that
/// was refused is looked at again when the boundary beside it changes. The boundary is simple and
/// closed after each step. O(1) for each point looked at.
///
/// # Errors
/// Only if cancelled.
pub fn grow(
    boundary: &mut Boundary,
    watch: Watch,
    mut admit: impl FnMut(&Boundary, &Expansion) -> bool,
    progress: Progress<'_>,
) -> Result<usize> {
    let mut queue: VecDeque<(Axial, usize)> = VecDeque::new();
    let mut waiting = vec![false; boundary.layout().len()];
    let enqueue = |point, cell: usize, waiting: &mut [bool], queue: &mut VecDeque<_>| {
        if !std::mem::replace(&mut waiting[cell], true) {
            queue.push_back((point, cell));
        }
    };
    for vertex in boundary.path() {
        boundary.outside_around(vertex, |point, cell| enqueue(point, cell, &mut waiting, &mut queue));
    }
    let mut added = 0;
    while let Some((point, cell)) = queue.pop_front() {
        waiting[cell] = false;
        let Some(expansion) = boundary.expansion(point) else { continue };
        if !admit(boundary, &expansion) {
            continue;
        }
        boundary.expand(&expansion);
        added += 1;
        if added % (1 << 16) == 0 {
            progress.report(0.5)?;
        }
        boundary.outside_beside(&expansion, |point, cell| enqueue(point, cell, &mut waiting, &mut queue));
        if watch == Watch::Ends {
            for end in [expansion.first, expansion.first.rotate(-expansion.edges)] {
                boundary.outside_around(point + end, |point, cell| {
                    enqueue(point, cell, &mut waiting, &mut queue)
                });
            }
        }
    }
    Ok(added)
}

/// Grows a patch from the deepest seed to the curve (section IV-B).
///
/// A point joins when it lies inside and none of its edges to the boundary meets the curve. The
/// result may contain chords: see [`clear_chords`]. `None` if the curve has no room for a seed.
///
/// # Errors
/// Only if cancelled.
pub fn grow_inside(raster: &Raster, progress: Progress<'_>) -> Result<Option<Boundary>> {
    let seed = raster.seed().and_then(|seed| Boundary::hexagon(raster.layout().clone(), seed));
    let Some(mut boundary) = seed else {
        return Ok(None);
    };
    let within = |_: &Boundary, expansion: &Expansion| raster.is_free(expansion.point, expansion.beside);
    grow(&mut boundary, Watch::Point, within, progress)?;
    Ok(Some(boundary))
}

/// Removes chords by growing the patch on both sides of them (section IV-D, first phase; figures 5
/// and 9). Returns a vertex at a chord that could not be removed.
///
/// A chord goes when one of its ends becomes interior, that is, when all outer neighbours of the
/// end have joined: the end with fewer of them first. `admit` limits how far. (The paper removes a
/// vertex of valence two "by adding a single triangle"; that leaves the chord between its two
/// neighbours unless one of those becomes interior.)
pub fn clear_chords(boundary: &mut Boundary, admit: impl Fn(Axial) -> bool) -> Result<(), Axial> {
    // Each round encloses at least one boundary vertex for good, or is the last.
    let mut waiting: VecDeque<Axial> = boundary.path().into();
    let mut stuck = Vec::new();
    while let Some(vertex) = waiting.pop_front() {
        let Some(other) = boundary.chord(vertex) else {
            continue;
        };
        let mut ends = [vertex, other];
        ends.sort_by_key(|&end| boundary.outer_neighbours(end).count());
        let mut changed = Vec::new();
        if ends.iter().any(|&end| enclose(boundary, end, &admit, &mut changed)) {
            // New chords can only start at the points that joined; the old ones of this vertex may stay.
            waiting.extend(changed);
            waiting.push_back(vertex);
            waiting.append(&mut stuck.drain(..).collect());
        } else {
            stuck.push(vertex);
        }
    }
    match stuck.into_iter().find(|&vertex| boundary.chord(vertex).is_some()) {
        Some(vertex) => Err(vertex),
        None => Ok(()),
    }
}

/// Makes a boundary vertex interior by adding its outer neighbours; all or nothing.
fn enclose(
    boundary: &mut Boundary,
    vertex: Axial,
    admit: &impl Fn(Axial) -> bool,
    changed: &mut Vec<Axial>,
) -> bool {
    let mut journal = Journal::default();
    let before = changed.len();
    while boundary.is_boundary(vertex) {
        let outer: Vec<Axial> = boundary.outer_neighbours(vertex).collect();
        // The neighbours next to the path can always be tried first from either end.
        let next = outer
            .iter()
            .filter(|&&p| admit(p))
            .filter_map(|&p| boundary.expansion(p))
            .max_by_key(|expansion| expansion.edges);
        match next {
            Some(expansion) => {
                boundary.expand_logged(&expansion, &mut journal);
                changed.push(expansion.point);
            }
            None => {
                boundary.roll_back(journal);
                changed.truncate(before);
                return false;
            }
        }
    }
    true
}

/// Grows the boundary wherever that lowers its bend (section IV-D, second phase), and across the
/// local minima of figure 13. Returns the number of points added.
///
/// Only points that cover at least two boundary edges join, so that no chord arises. `admit` is
/// the paper's maximum distance. The bend falls with every step, hence this ends.
///
/// # Errors
/// Only if cancelled.
pub fn straighten(
    boundary: &mut Boundary,
    admit: impl Fn(Axial) -> bool,
    progress: Progress<'_>,
) -> Result<usize> {
    let mut added = 0;
    loop {
        let lowers = |boundary: &Boundary, expansion: &Expansion| {
            expansion.edges >= 2 && boundary.bend_change(expansion) < 0 && admit(expansion.point)
        };
        added += grow(boundary, Watch::Ends, lowers, progress)?;
        let filled = fill_steps(boundary, &admit);
        if filled == 0 {
            return Ok(added);
        }
        added += filled;
    }
}

/// Fills the parallelogram beside each convex, concave, convex sequence of turns (figure 13).
///
/// Between `p1`, `p2` and `p3` the path is straight; the parallelogram ends at
/// `p4 = p1 + p3 - p2`. All of it is filled or nothing, and only if the bend really falls: a fill
/// that is refused midway would otherwise be tried for ever.
fn fill_steps(boundary: &mut Boundary, admit: &impl Fn(Axial) -> bool) -> usize {
    let mut added = 0;
    for start in boundary.path() {
        added += fill_step(boundary, start, admit).unwrap_or(0);
    }
    added
}

fn fill_step(boundary: &mut Boundary, p1: Axial, admit: &impl Fn(Axial) -> bool) -> Option<usize> {
    if boundary.turn(p1)? != 1 {
        return None;
    }
    let (first_dir, first_steps, p2) = straight_run(boundary, p1)?;
    if boundary.turn(p2)? != -1 {
        return None;
    }
    let (second_dir, second_steps, p3) = straight_run(boundary, p2)?;
    if boundary.turn(p3)? != 1 || !admit(p1 + (p3 - p2)) {
        return None;
    }
    let bend = boundary.bend();
    let mut journal = Journal::default();
    // From the concave corner outwards, row by row.
    for i in 1..=first_steps {
        for j in 1..=second_steps {
            let point = p2 - first_dir.offset() * i + second_dir.offset() * j;
            let expansion = boundary.expansion(point).filter(|e| e.edges >= 2 && admit(point));
            match expansion {
                Some(expansion) => boundary.expand_logged(&expansion, &mut journal),
                None => {
                    boundary.roll_back(journal);
                    return None;
                }
            }
        }
    }
    if boundary.bend() >= bend {
        boundary.roll_back(journal);
        return None;
    }
    Some((first_steps * second_steps) as usize)
}

/// Follows the boundary from a vertex to the next one that turns: direction, steps, that vertex.
fn straight_run(boundary: &Boundary, from: Axial) -> Option<(Dir, i32, Axial)> {
    let Cell::Boundary { leave, .. } = boundary.cell(from) else {
        return None;
    };
    let mut at = from + leave;
    let mut steps = 1;
    while boundary.turn(at)? == 0 {
        at = at + leave;
        steps += 1;
        if at == from {
            return None;
        }
    }
    Some((leave, steps, at))
}
