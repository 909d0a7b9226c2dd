//! What the mesh of a part of a picture may lack, and what it is worth to lack less.

use crate::cover::Covering;
use crate::cutout::options::{CutoutOptions, CutoutRim, Finer};
use crate::drawing::combine::Part;
use crate::drawing::curve::bounds;
use crate::geometry::polygon::{SIZES, perimeter, signed_area};

/// Binary logarithm of the times as many cells that a mesh may have to cut off no more than it may; the more it cuts off
/// the more may be spent.
const WORTH_CUT_OFF: f64 = 1.0;

/// The same for a mesh whose area is as much again as it may be.
const WORTH_AREA: f64 = 2.0;

/// The most that is spent for what is cut off, by meshes that are to cover. With less, gross cuts are left.
const MOST_CUT_OFF: f64 = 5.0;

/// The same across outlines.
const MOST_CUT_OFF_ACROSS: f64 = 3.0;

/// The same for the area. With half of it bodies have a tenth fewer faces, and seven of fifty overlap their pictures by less
/// than 99 %, not one.
const MOST_AREA: f64 = 1.6;

/// What is spent for a body with an edge that is short in a texture.
const WORTH_SHORT: f64 = 1.5;

/// Meshes of fewer cells may lack more, in proportion: edges leave an area out that grows as the square of their length.
const FEW: f64 = 500.0;

/// Parts of whose outlines this many pixels stay outside, beyond the slack, are meshed finer: middles of pixels lie
/// deeper inside. Outlines pass the middles by a sixth of a pixel at most, and the slack is a quarter at a margin of one.
const CUT_OFF: f64 = 0.58;

/// The same for rims across the outline, in pixels.
const CUT_OFF_ACROSS: f64 = 0.5;

/// And in edge lengths, if that is more: they are to follow large pictures no closer than small ones.
const CUT_OFF_EDGES: f64 = 0.14;

/// This share of a sprite may be empty, what lies in the margin included.
const EMPTY: f64 = 0.03;

/// So much larger than their outlines sprites may be whatever lies in the margin.
const EMPTY_AT_LEAST: f64 = 0.007;

/// Width, in pixels, of the part of a margin in which soft rims of pictures are seen.
const SOFT: f64 = 0.5;

/// The share for bodies with a margin, whose rims are opaque: seen from the front they overlap their pictures by 99 % where
/// that can be held.
const EMPTY_OF_BODY: f64 = 0.01;

/// Without a margin this much of the area may lie between mesh and outline: the least and the most that is allowed.
const BETWEEN: [f64; 2] = [0.004, 0.006];

/// Width, in pixels, of the seam along an outline in which pixels lie on the other side as it is: small pictures are
/// allowed less.
const PIXELS: f64 = 0.03;

/// What the mesh of a part may lack.
pub(super) struct Allowed {
    /// The area of the part.
    drawn: f64,
    /// The area between mesh and outline; of the mesh beyond it, if it is to cover.
    area: f64,
    /// How far tips may reach beyond the mesh.
    pub(super) cut_off: f64,
    across: bool,
}

/// What a mesh lacks, each as the binary logarithm of the times as many cells that may be spent to lack it no more.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lacks {
    cut_off: f64,
    area: f64,
    short: f64,
}

impl Lacks {
    /// The sum of it all.
    pub(super) fn sum(&self) -> f64 {
        self.cut_off + self.area + self.short
    }

    /// The same, of a mesh with a short edge, too.
    pub(super) fn with_short(self) -> Self {
        Self { short: WORTH_SHORT, ..self }
    }

    /// What is worth most, if anything is.
    pub(super) fn gravest(&self) -> Option<Finer> {
        let all = [(self.short, Finer::Short), (self.area, Finer::Area), (self.cut_off, Finer::CutOff)];
        let (worth, finer) = all.into_iter().max_by(|(a, _), (b, _)| a.total_cmp(b))?;
        (worth > 0.0).then_some(finer)
    }

    #[cfg(test)]
    pub(super) fn of_area(area: f64) -> Self {
        Self { area, ..Self::default() }
    }
}

/// The measures of the parts of a picture.
pub(super) struct Measures {
    /// By part, its area: that of its outline without its holes; 0 if that is no area of a drawing that can be meshed.
    pub(super) areas: Vec<f64>,
    /// By part, the length of its contours.
    rims: Vec<f64>,
    /// The sums of both.
    pub(super) area: f64,
    rim: f64,
}

impl Measures {
    pub(super) fn of(parts: &[Part]) -> Self {
        let counted = |part: &Part, value: f64| {
            let (low, high) = bounds(&part.outline);
            if value > 0.0 && SIZES.contains(&(high - low).max_element()) { value } else { 0.0 }
        };
        let area = |part: &Part| {
            let holes: f64 = part.holes.iter().map(|hole| signed_area(hole).abs()).sum();
            counted(part, signed_area(&part.outline).abs() - holes)
        };
        let rim = |part: &Part| {
            let holes: f64 = part.holes.iter().map(|hole| perimeter(hole)).sum();
            counted(part, perimeter(&part.outline) + holes)
        };
        let areas: Vec<f64> = parts.iter().map(area).collect();
        let rims: Vec<f64> = parts.iter().map(rim).collect();
        let area: f64 = areas.iter().sum();
        // Without any, each part is refused for a reason of its own, whatever its share.
        Self { area: if area > 0.0 { area } else { 1.0 }, rim: rims.iter().sum(), areas, rims }
    }

    /// What the mesh of a part may lack: of the share of the picture that may be lost by a mesh of `number` cells in all as much as
    /// it has of the outlines.
    ///
    /// So the sizes of the parts differ little: edges of one length lose about as much anywhere along outlines. Of rims that
    /// are fainter than edges more may be cut off.
    pub(super) fn allowed(&self, k: usize, number: f64, options: &CutoutOptions) -> Allowed {
        let fewer = (FEW / number).max(1.0);
        let across = !matches!(options.rim, CutoutRim::Around { .. });
        let share = match options.rim {
            CutoutRim::Around { margin } if options.body.is_none() => {
                let in_margin = (margin - SOFT).max(0.0) * self.rim / self.area;
                (EMPTY * fewer - in_margin).max(EMPTY_AT_LEAST)
            }
            CutoutRim::Around { .. } => EMPTY_OF_BODY * fewer,
            CutoutRim::Across | CutoutRim::On if options.body.is_some() => {
                let [least, most] = BETWEEN;
                (most - PIXELS * self.rim / self.area).max(least) * fewer
            }
            CutoutRim::Across | CutoutRim::On => (EMPTY * fewer).max(EMPTY_AT_LEAST),
        };
        let edge_length = options.edge_length(self.area, number);
        let pixels = if across { CUT_OFF_ACROSS.max(CUT_OFF_EDGES * edge_length) } else { CUT_OFF };
        Allowed {
            drawn: self.areas[k],
            area: share * self.area * self.rims[k] / self.rim,
            cut_off: options.faint * pixels,
            across,
        }
    }
}

impl Allowed {
    /// What a mesh lacks.
    pub(super) fn lacks(&self, covering: &Covering) -> Lacks {
        let outside = covering.outside;
        let mut more = covering.sketch.patch.area() - self.drawn;
        let mut cut_off = libm::log2(outside.max(1e-9) / self.cut_off).max(0.0);
        if self.across {
            // What lies between within an inlet that is filled is told by the area alone; a tip that is cut off counts as a square, too.
            let beyond = (outside - self.cut_off).max(0.0);
            more = (covering.between * self.drawn).max(more.abs()) + beyond * beyond;
        } else if cut_off > 0.0 {
            cut_off += WORTH_CUT_OFF;
        }
        let most = if self.across { MOST_CUT_OFF_ACROSS } else { MOST_CUT_OFF };
        let area = WORTH_AREA * libm::log2(more.max(1e-9) / self.area).max(0.0);
        Lacks { cut_off: cut_off.min(most), area: area.min(MOST_AREA), short: 0.0 }
    }
}
