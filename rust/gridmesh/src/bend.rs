//! The lattice bends: a conformal map takes the drawing to a plane in which its outline runs along the
//! directions of a straight lattice.
//!
//! The lattice is laid in that bent plane and its vertices are pulled back: inside, triangles stay
//! equilateral but for their size; outside, the steps are gone in which a straight lattice follows a
//! limb that runs askew. The map has derivative exp(u + i v). The rotation v is harmonic and turns
//! the outline's tangents into multiples of 60 degrees (of 90 for a lattice of squares), found by dynamic programming; u, the log of the
//! scale, is its harmonic conjugate; the map itself is the one whose gradient is nearest. All solves
//! are on a coarse triangulation of the drawing, the carrier.
//!
//! Everything is computed in the drawing's own frame (centred, turned by its farthest point, edges of
//! length one, rounded to a millionth of an edge), so that a drawing that is moved, turned or scaled
//! bends the same way.

pub(crate) mod carrier;
pub(crate) mod choose;
mod chords;
pub(crate) mod conformal;
pub mod directions;
mod follow;
mod grid;
pub(crate) mod image;
mod mirrored;
mod price;
pub mod shown;
mod sized;
mod straight;
mod tangents;
mod width;

use std::sync::Arc;

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::error::Result;
use crate::lattice::axial::Axial;
use crate::options::{CellShape, Density, SketchOptions};
use crate::path::outline::Outline;
use crate::path::placement::{Laid, Lattice, ROW_HEIGHT};
use crate::progress::Progress;
use carrier::{Carrier, Line};
use conformal::Operators;
use image::{BentContours, Image, WayBack};
use tangents::Tangents;
use width::{Wish, log_limbs, log_widths};

/// Coordinates in a drawing's own frame are multiples of this, in edges.
const GRAIN: f64 = 1.0 / 1_048_576.0;

/// Price of coarse limbs where thin parts shall be no coarser than on a straight lattice.
const MIND_LIMBS: f64 = 4.0;
/// The same where nothing is asked for, in meshes of so many triangles; in others in proportion, as a turn is a share of the
/// mesh, up to the last. With 2000 triangles .71 % of the vertices are irregular so, else .88 % (medians of 317 drawings). With
/// half of the last thin parts of 10,000 triangles have .97 times as many across as on a straight lattice, not 1.00.
const LIMBS: (f64, f64) = (0.4, 2000.0);
const MOST_LIMBS: f64 = 2.0;

/// Distances of a path on a bent lattice of triangles count so much of what they do on a straight one.
const BENT_SHARE: f64 = 0.1;

/// In outlines of triangles with so many edges and fewer; in longer ones less.
const EDGES: f64 = 150.0;

/// A drawing in its own frame, in edges, and the coarse triangulation that carries its maps.
pub(crate) struct Ground {
    /// From the drawing to its frame: [`Lattice::to_units`].
    frame: Lattice,
    lines: Vec<Line>,
    carrier: Carrier,
    /// Logarithm of the drawing's width at the carrier's boundary vertices.
    widths: Vec<f64>,
    /// Wishes for the number of triangles at the carrier's boundary vertices.
    densities: Option<Vec<f64>>,
    /// How much finer narrow parts are wished for.
    narrow: Option<f64>,
    /// Logarithm of the width of the limb at the carrier's boundary vertices; empty where sizes are asked for, and for quads.
    limbs: Vec<f64>,
    /// Price of limbs coarser than on a straight lattice, in turns for an edge of contour and a factor of e.
    price_of_limbs: f64,
    /// Some density was asked for, or the lattice is one of squares, whose limbs lose their corners where they are coarse.
    sizes_matter: bool,
    /// The first axis of the frame is an axis of symmetry.
    is_symmetric: bool,
    /// What lattice the plane is bent for.
    shape: CellShape,
}

impl Ground {
    /// `frame`: a point and a direction that move with the drawing, and the edge length. The lattice of
    /// the bent plane will be one of `shape`. None where the contours are too near to each other.
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::error::Error::Cancelled).
    pub(crate) fn new(
        contours: &[ClosedCurve],
        frame: Lattice,
        density: Option<&Density>,
        is_symmetric: bool,
        shape: CellShape,
        progress: Progress<'_>,
    ) -> Result<Option<Self>> {
        let lines: Vec<Line> = contours.iter().map(|contour| in_frame(contour, &frame)).collect();
        let Some(carrier) = Carrier::new(&lines, shape, progress)? else { return Ok(None) };
        let densities = match density {
            Some(Density::PerPoint(given)) => match densities(contours, &carrier, given) {
                None => return Ok(None),
                found => found,
            },
            _ => None,
        };
        let share = match density {
            Some(&Density::Width(share)) => Some(share),
            _ => None,
        };
        let narrow = share.filter(|&share| share > 0.0);
        let widths = log_widths(&carrier, progress)?;
        let (mut limbs, mut price_of_limbs) = (Vec::new(), 0.0);
        if shape == CellShape::Triangle && densities.is_none() && narrow.is_none() {
            limbs = log_limbs(&carrier, progress)?;
            let (each, count) = LIMBS;
            price_of_limbs = match share {
                Some(_) => MIND_LIMBS,
                None => (each * triangles_of(&carrier) / count).min(MOST_LIMBS),
            };
        }
        Ok(Some(Self {
            frame,
            lines,
            carrier,
            widths,
            densities,
            narrow,
            limbs,
            price_of_limbs,
            sizes_matter: density.is_some() || shape == CellShape::Quad,
            is_symmetric,
            shape,
        }))
    }

    /// The Laplacian of the carrier and what stands on its boundary, for [`choose::candidates`].
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::error::Error::Cancelled), [`Error::Solver`](crate::error::Error::Solver).
    pub(crate) fn operators(&self, progress: Progress<'_>) -> Result<Operators> {
        let tangents: Vec<Tangents> =
            self.lines.iter().map(|line| Tangents::new(&line.points, &line.arcs)).collect();
        Operators::new(&self.carrier, &self.widths, &tangents, self.shape, progress)
    }

    /// About how many triangles a straight lattice would have.
    fn triangles(&self) -> f64 {
        triangles_of(&self.carrier)
    }

    /// True if sizes are asked for.
    fn is_asked(&self) -> bool {
        self.narrow.is_some() || self.densities.is_some()
    }

    /// The sizes that are wished for; none where floors do.
    fn wish(&self) -> Option<Wish> {
        match &self.densities {
            Some(densities) => Some(Wish::of_densities(densities)),
            None if self.narrow.is_some() || self.shape == CellShape::Quad => {
                Some(Wish::of_narrowness(&self.widths, self.narrow.unwrap_or(1.0)))
            }
            None => None,
        }
    }
}

fn triangles_of(carrier: &Carrier) -> f64 {
    carrier.areas().iter().sum::<f64>() / (0.5 * ROW_HEIGHT)
}

/// A contour in a drawing's own frame.
fn in_frame(contour: &ClosedCurve, frame: &Lattice) -> Line {
    let rounded = |p: &DVec2| (frame.to_units(*p) / GRAIN).round() * GRAIN;
    Line::new(contour.points().iter().map(rounded).collect())
}

/// The wishes at input points, interpolated at the carrier's boundary vertices.
fn densities(contours: &[ClosedCurve], carrier: &Carrier, given: &[Vec<f64>]) -> Option<Vec<f64>> {
    let mut found = Vec::new();
    for (k, (contour, rim)) in contours.iter().zip(&carrier.rims).enumerate() {
        let given = given.get(k).filter(|given| !given.is_empty());
        for &s in &rim.arcs {
            let Some(given) = given else {
                found.push(1.0);
                continue;
            };
            let (segment, t) = contour.source(s / rim.length * contour.length());
            let (i, n) = (segment as usize, given.len());
            let (from, to) = (libm::log(*given.get(i)?), libm::log(*given.get((i + 1) % n)?));
            found.push(libm::exp(from + t * (to - from)));
        }
    }
    Some(found)
}

/// A bent drawing: contours to lay a straight lattice in, and the way back.
pub(crate) struct Bent {
    ground: Arc<Ground>,
    image: Arc<Image>,
    drawing: BentContours,
    /// How far it is bent, of what was asked for: 0 to 1.
    pub(crate) share: f64,
    /// The angle by which the drawing is turned as a whole.
    turn: f64,
    /// What its range of sizes is worth, in turns.
    pub(crate) price: f64,
    /// What its coarse limbs are worth, in turns, where it is compared with other bends.
    pub(crate) price_of_limbs: f64,
    /// Whether the map was made for another drawing.
    is_followed: bool,
}

impl Bent {
    /// The bent contours, in edges.
    pub(crate) fn contours(&self) -> &[ClosedCurve] {
        &self.drawing.contours
    }

    /// The direction of the axis of symmetry, which passes through the origin.
    pub(crate) fn axis(&self) -> DVec2 {
        DVec2::from_angle(self.turn)
    }

    /// What squared distances of a path count in the bent plane, in turns: less there, since the vertices come back to the
    /// drawing, and less the more edges the outline has: along a long side they add up to more than turns are worth. Halves, so
    /// that a drawing that is changed a little keeps its path.
    pub(crate) fn closeness(&self, options: &SketchOptions) -> f64 {
        let (share, edges) = match options.cells {
            CellShape::Triangle => (BENT_SHARE, EDGES),
            CellShape::Quad => (1.0, choose::EDGES),
        };
        let length: f64 = self.contours().iter().map(ClosedCurve::length).sum();
        let halvings = libm::log2(length / edges).round().max(0.0);
        share * libm::exp2(-halvings) * options.closeness
    }

    /// True if sizes were asked for.
    pub(crate) fn is_sized(&self) -> bool {
        self.ground.is_asked()
    }

    /// Largest over smallest local edge length.
    pub(crate) fn scale_range(&self) -> f64 {
        let (low, high) =
            self.image.u.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &u| (l.min(u), h.max(u)));
        libm::exp(high - low)
    }

    /// A lattice of the bent plane as it lies in the middle of the drawing: where positions are measured.
    pub(crate) fn lattice(&self, bent: &Lattice) -> Lattice {
        let frame = &self.ground.frame;
        Lattice {
            origin: frame.origin,
            angle: frame.angle + bent.angle - self.turn,
            edge_length: frame.edge_length * bent.edge_length,
        }
    }

    /// The outline with arc lengths of the drawing, in edges.
    pub(crate) fn outline(&self, outline: Outline, bent: &Lattice) -> Outline {
        let h = bent.edge_length;
        let drawn = |(contour, arcs): (usize, &Vec<f64>)| {
            arcs.iter().map(|s| self.drawing.drawn_arc(contour, s * h) / h).collect()
        };
        let arcs = outline.arcs.iter().enumerate().map(drawn).collect();
        Outline { arcs, ..outline }
    }

    /// Where lattice points lie in the drawing, in units of [`Bent::lattice`]; those of the outline's
    /// paths come first, and are taken back beside where they belong.
    pub(crate) fn positions<G: Laid>(
        &self,
        outline: &Outline,
        bent: &Lattice,
        points: &[Axial],
    ) -> Vec<DVec2> {
        let way = WayBack::new(&self.ground.carrier, &self.image);
        let lattice = self.lattice(bent);
        let known = outline.arcs.iter().enumerate().flat_map(|(k, arcs)| arcs.iter().map(move |&s| (k, s)));
        let mut known = known.map(Some).chain(std::iter::repeat(None));
        points
            .iter()
            .map(|&point| {
                let x = bent.from_units(G::units(point));
                let at = match known.next().flatten() {
                    Some((contour, s)) if !self.is_followed => way.beside(contour, s * bent.edge_length, x),
                    _ => way.at(x),
                };
                lattice.to_units(self.ground.frame.from_units(at))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
