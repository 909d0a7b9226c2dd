//! Which parts of the swept surface lie inside the model: loops sorted into outlines, holes and tubes.

use glam::DVec2;

use super::loops::{Loop, Loops};
use crate::cut::divide::parted::Parted;
use crate::cut::sheet::Sheet;

/// A corner of a region: a vertex of the mesh, at a place of the line and a height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::cut) struct Spot {
    pub node: u32,
    pub at: DVec2,
}

/// A region to be capped.
pub(in crate::cut) enum Region {
    /// An outline, counter-clockwise, and holes in it, clockwise.
    Sheet { outline: Vec<Spot>, holes: Vec<Vec<Spot>> },
    /// Between two loops around a closed sheet: the lower one forward, the upper one backward; and holes.
    Tube { lower: Vec<Spot>, upper: Vec<Spot>, holes: Vec<Vec<Spot>> },
}

/// Regions, and whether the mesh is inside out.
pub(in crate::cut) struct Regions {
    pub regions: Vec<Region>,
    pub inverted: bool,
    pub uncapped: usize,
}

/// `more` are loops that are closed along a plane of symmetry.
pub(in crate::cut) fn find(
    vertices: &[glam::DVec3],
    parted: &Parted,
    sheet: &Sheet,
    loops: &Loops,
    more: Vec<Vec<Spot>>,
) -> Regions {
    let spots = |l: &Loop| {
        let spot = |(&node, &place): (&u32, &f64)| {
            let height = sheet.view.height(parted.position(vertices, node));
            Spot { node, at: DVec2::new(place, height) }
        };
        l.nodes.iter().zip(&l.places).map(spot).collect::<Vec<_>>()
    };
    let mut flat = vec![];
    let mut winding = vec![];
    let mut uncapped = 0;
    let mut total = 0.0;
    for l in &loops.closed {
        let spots = spots(l);
        match l.winding {
            0 => {
                total += area(&spots);
                flat.push(spots);
            }
            1 | -1 => {
                let height = spots.iter().map(|s| s.at.y).sum::<f64>() / spots.len() as f64;
                total -= f64::from(l.winding) * sheet.width() * height;
                winding.push((l.winding, height, spots));
            }
            _ => uncapped += 1,
        }
    }
    total += more.iter().map(|l| area(l)).sum::<f64>();
    flat.extend(more);
    let inverted = total < 0.0;
    if inverted {
        flat.iter_mut().for_each(|l| l.reverse());
        for (turn, _, spots) in &mut winding {
            *turn = -*turn;
            spots.reverse();
        }
    }
    let mut regions = vec![];
    winding.sort_by(|x, y| x.1.total_cmp(&y.1));
    let mut below: Option<Vec<Spot>> = None;
    for (turn, _, spots) in winding {
        match (turn, below.take()) {
            (1, None) => below = Some(spots),
            (1, Some(_)) => {
                uncapped += 1;
                below = Some(spots);
            }
            (_, Some(lower)) => regions.push(Region::Tube { lower, upper: spots, holes: vec![] }),
            (_, None) => uncapped += 1,
        }
    }
    uncapped += usize::from(below.is_some());

    let (outer, inner): (Vec<_>, Vec<_>) = flat.into_iter().partition(|l| area(l) >= 0.0);
    let mut sizes = vec![f64::INFINITY; regions.len()];
    for outline in outer {
        sizes.push(area(&outline));
        regions.push(Region::Sheet { outline, holes: vec![] });
    }
    let mut lone = vec![];
    for mut hole in inner {
        let around = (0..regions.len())
            .filter(|&k| regions[k].contains(&hole, sheet).is_some())
            .min_by(|&a, &b| sizes[a].total_cmp(&sizes[b]));
        match around.and_then(|k| Some((k, regions[k].contains(&hole, sheet)?))) {
            Some((k, shift)) => {
                hole.iter_mut().for_each(|s| s.at.x += shift);
                match &mut regions[k] {
                    Region::Sheet { holes, .. } | Region::Tube { holes, .. } => holes.push(hole),
                }
            }
            // Of a part that is inside out.
            None => lone.push(hole),
        }
    }
    regions.extend(lone.into_iter().map(|outline| Region::Sheet { outline, holes: vec![] }));
    Regions { regions, inverted, uncapped }
}

pub(in crate::cut) fn area(spots: &[Spot]) -> f64 {
    let n = spots.len();
    let origin = spots[0].at;
    (0..n).map(|k| (spots[k].at - origin).perp_dot(spots[(k + 1) % n].at - origin)).sum::<f64>() * 0.5
}

impl Region {
    /// The same with all places this many times as far along the line.
    pub fn stretched(mut self, by: f64) -> Self {
        let loops: Vec<&mut Vec<Spot>> = match &mut self {
            Region::Sheet { outline, holes } => std::iter::once(outline).chain(holes).collect(),
            Region::Tube { lower, upper, holes } => [lower, upper].into_iter().chain(holes).collect(),
        };
        loops.into_iter().flatten().for_each(|spot| spot.at.x *= by);
        self
    }

    /// Mean height of its corners.
    pub fn height(&self) -> f64 {
        let loops: Vec<&Vec<Spot>> = match self {
            Region::Sheet { outline, holes } => std::iter::once(outline).chain(holes).collect(),
            Region::Tube { lower, upper, holes } => [lower, upper].into_iter().chain(holes).collect(),
        };
        let count = loops.iter().map(|l| l.len()).sum::<usize>().max(1);
        loops.into_iter().flatten().map(|s| s.at.y).sum::<f64>() / count as f64
    }

    /// How far a loop must be moved along the line to lie within, if it does.
    fn contains(&self, inner: &[Spot], sheet: &Sheet) -> Option<f64> {
        let probes = [0, inner.len() / 3, 2 * inner.len() / 3].map(|k| inner[k].at);
        let most = |inside: &dyn Fn(DVec2) -> bool| probes.iter().filter(|p| inside(**p)).count() >= 2;
        match self {
            Region::Sheet { outline, .. } => {
                let turns: &[f64] = if sheet.closed { &[0.0, -1.0, 1.0] } else { &[0.0] };
                let shifts = turns.iter().map(|t| t * sheet.width());
                shifts.into_iter().find(|&shift| most(&|p| is_within(outline, p + DVec2::new(shift, 0.0))))
            }
            Region::Tube { lower, upper, .. } => {
                let width = sheet.width();
                most(&|p| height_at(lower, p.x, width) < p.y && p.y < height_at(upper, p.x, width))
                    .then_some(0.0)
            }
        }
    }
}

/// Even-odd.
pub(in crate::cut) fn is_within(outline: &[Spot], p: DVec2) -> bool {
    let n = outline.len();
    let mut inside = false;
    for k in 0..n {
        let (a, b) = (outline[k].at, outline[(k + 1) % n].at);
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    inside
}

/// Height of the vertex of a loop around the sheet that is nearest to a place.
fn height_at(around: &[Spot], place: f64, width: f64) -> f64 {
    let off = |s: &Spot| {
        let d = (s.at.x - place).rem_euclid(width);
        d.min(width - d)
    };
    around.iter().min_by(|a, b| off(a).total_cmp(&off(b))).map_or(0.0, |s| s.at.y)
}
