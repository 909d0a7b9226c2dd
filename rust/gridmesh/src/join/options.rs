//! What can be chosen about a joint, and what is told of it.

use crate::error::{Error, Result, told};

/// Options of [`join`](super::join()).
#[derive(Clone, Debug, PartialEq)]
pub struct JoinOptions {
    /// Edge lengths to each side of the line where two surfaces meet that are taken away and blended; 0 keeps the line as a
    /// crease.
    pub blend: f64,
    /// The edge length that `blend` counts in; `None`: of each part its own near the line.
    pub edge_length: Option<f64>,
    /// Refuse joints that meet themselves or the parts, instead of counting that.
    pub strict: bool,
    /// Which lines run along edges of the patches.
    pub border: Border,
}

/// Where surfaces of two parts meet: whether the line runs along edges of the patch there, for borders of colours without teeth. It is
/// then told for each new triangle on which part's side of the line it lies.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Border {
    /// Nowhere; nothing is told.
    #[default]
    None,
    /// Between all parts.
    Parts,
    /// Between parts of different colours, one number for each part. New triangles between parts of one colour belong to the nearest.
    Colors(Vec<u32>),
}

impl Border {
    /// The colour of a part.
    pub(super) fn color(&self, part: usize) -> u32 {
        match self {
            Border::Colors(colors) => colors.get(part).copied().unwrap_or(0),
            Border::None | Border::Parts => part as u32,
        }
    }
}

impl Default for JoinOptions {
    fn default() -> Self {
        JoinOptions { blend: 2.0, edge_length: None, strict: false, border: Border::None }
    }
}

/// The widest blend allowed.
const WIDEST: f64 = 1000.0;

impl JoinOptions {
    /// Refuses values that are not allowed for so many parts.
    pub(super) fn check(&self, parts: usize) -> Result<()> {
        if !(0.0..=WIDEST).contains(&self.blend) {
            let allowed = "a number from 0 to 1000, of edge lengths";
            return Err(Error::InvalidOption { name: "blend", value: told(self.blend), allowed });
        }
        if let Some(length) = self.edge_length.filter(|l| !(l.is_finite() && *l > 0.0)) {
            let allowed = "a number above 0, or nothing";
            return Err(Error::InvalidOption { name: "edge_length", value: told(length), allowed });
        }
        if let Border::Colors(colors) = &self.border
            && colors.len() != parts
        {
            let (value, allowed) = (colors.len().to_string(), "as many numbers as parts");
            return Err(Error::InvalidOption { name: "border", value, allowed });
        }
        Ok(())
    }
}

/// Numbers about a joined mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JoinReport {
    /// Connected pieces of the result.
    pub components: usize,
    /// Sum of the pieces' genera.
    pub genus: i32,
    /// Parts that meet no other one: pieces of their own.
    pub alone: usize,
    /// Parts, and pieces of parts that overlap others of the same part, of which nothing is left, since they lie within others.
    pub swallowed: usize,
    /// Pieces of parts that overlap others of the same part, and were joined as parts of their own.
    pub overlapping: usize,
    /// Parts given inside out, which were turned.
    pub turned: usize,
    /// Vertices added where faces of a part meet in a vertex or along an edge alone, so that each side has its own.
    pub separated: usize,
    /// Closed lines in which surfaces meet, and lines that branch, each with all its branches.
    pub curves: usize,
    /// Patches between the parts.
    pub collars: usize,
    /// Of those, tubes between two rims.
    pub tubes: usize,
    /// Of those, patches in one rim.
    pub fills: usize,
    /// Of those, patches with the line as a crease, since any blend would meet something, or take most of a part away.
    pub creased: usize,
    /// Of those, triangles of the exact union as they are: any other patch would meet something, or take most of a part away.
    pub exact: usize,
    /// New triangles.
    pub collar_triangles: usize,
    /// New vertices.
    pub collar_vertices: usize,
    /// New vertices with a valence other than six.
    pub collar_irregular: usize,
    /// Vertices of the result that are irregular: with other than six triangles, a corner of a quad counted one and a half.
    pub irregular: usize,
    /// Smallest angle of a new triangle, in radians; of none 0.
    pub min_angle: f64,
    /// Pairs of triangles, at least one of them new and not of the exact union, that meet where they should not.
    pub self_intersections: usize,
    /// Volume enclosed.
    pub volume: f64,
    /// Volume of the exact union.
    pub exact_volume: f64,
    /// Seconds spent in each stage.
    pub seconds: Vec<(&'static str, f64)>,
}
