//! What [`mesh_sketch`](crate::sketch::mesh_sketch) can be asked for, and what it reports.

use glam::DVec2;

use crate::error::{Error, Result, told};

/// The largest mesh that is supported, in triangles of the flat patch.
pub const MAX_TRIANGLES: f64 = 20e6;

/// Triangles of the flat patch when nothing is asked for.
pub const DEFAULT_TRIANGLES: usize = 2000;
/// The same of quads: about as many vertices.
pub const DEFAULT_QUADS: usize = 1000;

/// The least number of triangles of the flat patch that is chosen.
pub const LEAST_CHOSEN: usize = 1000;

/// The largest number of triangles that is chosen, unless told otherwise.
pub const MOST_CHOSEN: usize = 20_000;

/// Drawn corners that turn by more than this are kept, unless told otherwise: 40 degrees.
pub const DEFAULT_CORNER_ANGLE: f64 = 40.0 * std::f64::consts::PI / 180.0;

/// How the lattice path along a contour is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoundaryMethod {
    /// The path of least cost for the lattice and the greatest distance.
    Optimal,
    /// The paper's growth and optimisation, sections IV-B to IV-D.
    Grown,
}

/// What to do with an outline that crosses itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SelfCrossing {
    /// Refuse it, naming the crossing.
    Error,
    /// Take its outer outline.
    Union,
}

/// A mirror axis for a symmetric mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mirror {
    /// The axis of the drawing's own symmetry, if it has one.
    Auto,
    /// The line through a point along a direction.
    Axis {
        /// A point of the axis.
        point: DVec2,
        /// Its direction; not zero.
        direction: DVec2,
    },
}

/// Where a drawing should have more triangles than elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub enum Density {
    /// In narrow parts, 0 to 1: at 1 they have up to eleven times the triangles, so far as others can be larger; at 0 they are
    /// about as fine as on a straight lattice, for some more irregular vertices.
    Width(f64),
    /// At each input point so many times the triangles of elsewhere: the outline's numbers, then those of
    /// the holes; a contour with no numbers has no wish.
    PerPoint(Vec<Vec<f64>>),
}

/// What the faces of a patch are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CellShape {
    /// Triangles of the triangular lattice.
    #[default]
    Triangle,
    /// Quadrilaterals of the square lattice.
    Quad,
}

impl CellShape {
    /// What several of them are called.
    pub const fn plural(self) -> &'static str {
        match self {
            CellShape::Triangle => "triangles",
            CellShape::Quad => "quads",
        }
    }
}

/// Options of [`mesh_sketch`](crate::sketch::mesh_sketch).
#[derive(Clone, Debug, PartialEq)]
pub struct SketchOptions {
    /// Edge length of the lattice in the units of the drawing; exclusive with `triangles`.
    pub edge_length: Option<f64>,
    /// Triangles, or quads, of the flat patch, 6 or more; 2000 triangles or 1000 quads if neither is given. Reached
    /// within 10 %, below 60 within 6, besides one more quad at each sharp corner: the report says how many there are.
    pub triangles: Option<usize>,
    /// What the patch is made of; `triangles` and `max_triangles` count these cells.
    pub cells: CellShape,
    /// Choose the number of triangles: five across the thinnest limb, but at least 1000 and at most
    /// `max_triangles`; where those cannot follow the drawing, the least number that can. Exclusive with
    /// `edge_length` and `triangles`.
    pub automatic: bool,
    /// The largest number that `automatic` chooses.
    pub max_triangles: usize,
    /// How the boundary is found.
    pub boundary: BoundaryMethod,
    /// Greatest distance of the lattice path from the curve, in edges: 0.5 to 4.
    pub max_distance: f64,
    /// Weight of the squared distance against a turn: 0 to 100.
    pub closeness: f64,
    /// Angle of the lattice in radians; `None` lets the drawing's tangents decide.
    pub angle: Option<f64>,
    /// A point of the lattice in the units of the drawing, for drawings that change step by step:
    /// with the edge length and the angle it keeps the lattice where it is. `None`: the centroid, and
    /// other places if that one gives no patch.
    pub origin: Option<DVec2>,
    /// Corners that turn by more than this (radians, 0 to pi) get a vertex of their own.
    pub corner_angle: f64,
    /// Mirror axis: the mesh is its own mirror image, topology and positions.
    pub mirror: Option<Mirror>,
    /// What to do with an outline that crosses itself.
    pub self_crossing: SelfCrossing,
    /// Search nodes spent on proving a boundary optimal whose first solution had conflicts, at most; a proof ends
    /// after 6 million states too, under a second, whatever this number. Not beside `mirror`.
    pub proof_nodes: usize,
    /// How far the lattice may bend with the drawing, 0 to 1; 0 is a straight lattice. Without effect
    /// beside a given `angle` or `origin` and with `boundary` grown.
    pub bend: f64,
    /// The wish for more triangles in some parts; only with `bend` above 0.
    pub density: Option<Density>,
    /// Whether to relax the interior; without it the patch shows the lattice as it was cut, and is
    /// refused ([`Error::Inverted`]) where that inverts triangles.
    pub relax: bool,
    /// Whether sharp convex corners of quads get a single quad ([`Patch::belted`](crate::patch::Patch::belted) has two at
    /// each); without it the patch is only fit for bodies, in less time. Without effect unless `relax` is on.
    pub open_corners: bool,
    /// Whether a drawing too thin for its mesh is told the least number of triangles that works. The
    /// search may take some seconds; without it such a drawing is refused at once.
    pub least: bool,
}

impl Default for SketchOptions {
    fn default() -> Self {
        Self {
            edge_length: None,
            triangles: None,
            cells: CellShape::Triangle,
            automatic: false,
            max_triangles: MOST_CHOSEN,
            boundary: BoundaryMethod::Optimal,
            max_distance: 1.5,
            closeness: 0.3,
            angle: None,
            origin: None,
            corner_angle: DEFAULT_CORNER_ANGLE,
            mirror: None,
            self_crossing: SelfCrossing::Error,
            proof_nodes: 0,
            bend: 1.0,
            density: None,
            relax: true,
            open_corners: true,
            least: true,
        }
    }
}

fn refuse(name: &'static str, value: f64, allowed: &'static str) -> Result<()> {
    Err(Error::InvalidOption { name, value: told(value), allowed })
}

impl SketchOptions {
    /// The defaults for quads.
    pub fn quads() -> Self {
        Self { cells: CellShape::Quad, ..Self::default() }
    }

    /// Checks every value by itself.
    ///
    /// # Errors
    /// [`Error::InvalidOption`].
    pub fn check(&self) -> Result<()> {
        self.check_size()?;
        if !(0.5..=4.0).contains(&self.max_distance) {
            return refuse("max_distance", self.max_distance, "0.5 to 4 edge lengths");
        }
        if !(0.0..=100.0).contains(&self.closeness) {
            return refuse("closeness", self.closeness, "0 to 100");
        }
        if !(0.0..=1.0).contains(&self.bend) {
            return refuse("bend", self.bend, "0 to 1");
        }
        self.check_density()?;
        self.check_place()?;
        if !(0.0..=std::f64::consts::PI).contains(&self.corner_angle) {
            return refuse("corner_angle", self.corner_angle, "0 to pi radians");
        }
        if self.cells == CellShape::Quad {
            self.check_quads()?;
        }
        if self.mirror.is_some() && self.boundary == BoundaryMethod::Grown {
            return Err(Error::InvalidOption {
                name: "mirror",
                value: "given, with boundary grown".to_owned(),
                allowed: "none, or boundary optimal: growth has no symmetric form",
            });
        }
        if self.mirror.is_some() && self.proof_nodes > 0 {
            return Err(Error::InvalidOption {
                name: "proof_nodes",
                value: format!("{}, beside mirror", self.proof_nodes),
                allowed: "0, or no mirror: symmetric boundaries are proved only where none conflicts",
            });
        }
        Ok(())
    }

    /// # Errors
    /// [`Error::InvalidOption`] or [`Error::TooLarge`] for the size of the cells or their number.
    fn check_size(&self) -> Result<()> {
        if self.edge_length.is_some() && self.triangles.is_some() {
            return Err(Error::InvalidOption {
                name: "triangles",
                value: "given beside edge_length".to_owned(),
                allowed: "one of edge_length and triangles, or neither",
            });
        }
        if self.automatic {
            let limit = self.max_triangles;
            if self.edge_length.is_some() || self.triangles.is_some() {
                return Err(Error::InvalidOption {
                    name: "triangles",
                    value: "automatic, and given".to_owned(),
                    allowed: "one of automatic, a number and an edge length",
                });
            }
            if limit < 6 {
                return refuse("max_triangles", limit as f64, "at least 6");
            }
            if limit as f64 > MAX_TRIANGLES {
                return Err(Error::TooLarge { triangles: limit as f64, limit: MAX_TRIANGLES });
            }
        }
        if let Some(h) = self.edge_length
            && !(h.is_finite() && h > 0.0)
        {
            return refuse("edge_length", h, "a finite length above 0");
        }
        if let Some(n) = self.triangles {
            if n < 6 {
                return refuse(self.cells.plural(), n as f64, "at least 6");
            }
            if n as f64 > MAX_TRIANGLES {
                return Err(Error::TooLarge { triangles: n as f64, limit: MAX_TRIANGLES });
            }
        }
        Ok(())
    }

    /// # Errors
    /// [`Error::InvalidOption`] for wishes of density that no lattice, or no drawing, can have.
    fn check_density(&self) -> Result<()> {
        // At 0 thin parts shall be as fine as on a straight lattice, which they are there.
        let is_asked = self.density.as_ref().is_some_and(|density| *density != Density::Width(0.0));
        if is_asked && self.bend == 0.0 {
            return Err(Error::InvalidOption {
                name: "density",
                value: "given, with bend 0".to_owned(),
                allowed: "none, or bend above 0: triangles of a straight lattice have one size",
            });
        }
        if let Some(Density::Width(share)) = self.density
            && !(0.0..=1.0).contains(&share)
        {
            return refuse("density", share, "a number from 0 to 1, or one for each point");
        }
        if let Some(Density::PerPoint(given)) = &self.density {
            if let Some(&wrong) = given.iter().flatten().find(|&&d| !(d.is_finite() && d > 0.0)) {
                return refuse("density", wrong, "finite numbers above 0");
            }
            if self.self_crossing == SelfCrossing::Union {
                let value = "numbers, beside self_crossing union".to_owned();
                let allowed = "'width' or none: the outer outline has other points";
                return Err(Error::InvalidOption { name: "density", value, allowed });
            }
        }
        Ok(())
    }

    /// # Errors
    /// [`Error::InvalidOption`] for the lattice's angle or origin.
    fn check_place(&self) -> Result<()> {
        if let Some(angle) = self.angle
            && !angle.is_finite()
        {
            return refuse("angle", angle, "a finite angle in radians, or none");
        }
        if let Some(origin) = self.origin {
            let value = || format!("{}, {}", told(origin.x), told(origin.y));
            if !origin.is_finite() {
                let allowed = "a point with finite coordinates, or none";
                return Err(Error::InvalidOption { name: "origin", value: value(), allowed });
            }
            if self.mirror.is_some() {
                let allowed = "none, with mirror: the lattice lies on the axis";
                return Err(Error::InvalidOption { name: "origin", value: value(), allowed });
            }
        }
        Ok(())
    }

    /// # Errors
    /// [`Error::InvalidOption`] for what quads cannot do.
    fn check_quads(&self) -> Result<()> {
        if self.boundary == BoundaryMethod::Grown {
            return Err(Error::InvalidOption {
                name: "boundary",
                value: "grown, with quads".to_owned(),
                allowed: "optimal, or triangles: growth is that of a triangular lattice",
            });
        }
        Ok(())
    }
}

/// What was done, in plain numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SketchReport {
    /// Triangles of the flat patch.
    pub triangles: usize,
    /// Quads of the flat patch.
    pub quads: usize,
    /// Vertices of the stitched body inside its two sheets whose valence is not four; 0 for triangles.
    pub poles: usize,
    /// The least number of them that a body of belted quads has; 0 for triangles.
    pub minimum_poles: usize,
    /// Vertices of the stitched body whose valence is not six.
    pub irregular: usize,
    /// The least number of them that any lattice body of this genus has.
    pub minimum_irregular: usize,
    /// Sum of absolute turns along the boundary (the paper's `err_dc`).
    pub turns: usize,
    /// `turns` before the grown boundary was straightened (section IV-D); they only fall.
    pub turns_before: Option<usize>,
    /// No traced boundary for this lattice and distance turns less, conflicts or not.
    pub turns_bound: Option<usize>,
    /// Turns plus `closeness` times the squared distances of the path, in edges.
    pub cost: f64,
    /// Lower bound of `cost`, if it was computed.
    pub cost_bound: Option<f64>,
    /// True if the boundary is proved to be the cheapest.
    pub optimal: bool,
    /// Greatest distance that the boundary was allowed, in edges.
    pub max_distance_used: f64,
    /// Greatest distance from the drawn curve to the mesh boundary, in edges; at most 2, or the
    /// drawing is refused.
    pub max_deviation: f64,
    /// Boundary edges that bridge an inlet of the drawing with mesh vertices in it: zero, or the
    /// drawing is refused, unless `relax` is off.
    pub bridged_inlets: usize,
    /// Smallest angle of the flat patch, in radians; of quads the smallest corner.
    pub min_angle: f64,
    /// Drawn corners sharper than `corner_angle`.
    pub corners: usize,
    /// Corners that got no vertex of their own.
    pub released_corners: usize,
    /// Triangles across the thinnest limb; `None` where no part is longer than it is wide, and unless the
    /// number of triangles was left to the drawing (`automatic`).
    pub across: Option<f64>,
    /// Input points dropped because they repeat their predecessor.
    pub repaired: usize,
    /// Greatest distance of a vertex from the mirror image of its partner, in edges: rounding, if the
    /// drawing is exactly symmetric. `None` without `mirror`.
    pub mirror_error: Option<f64>,
    /// How far the lattice is bent: 0 if it is straight.
    pub bend: f64,
    /// Largest over smallest local edge length of the lattice; 1 if it is straight.
    pub scale_range: f64,
    /// Lattice placements tried before one gave a valid patch.
    pub placements: usize,
    /// States that the searches for boundaries took, on all lattices: many where walls are so near to each other that
    /// their paths are in each other's way, and then the reason for a long time.
    pub search_states: u64,
    /// Seconds spent in each stage.
    pub seconds: Vec<(&'static str, f64)>,
}
