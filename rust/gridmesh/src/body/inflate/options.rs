//! How a patch is inflated: profiles, depths.

use crate::body::surface::UvLayout;

/// Shape of the body's cross-section.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Profile {
    /// A circle becomes a sphere, a long limb of half width `w` a bulge of height `1.41 w`.
    #[default]
    Round,
    /// A circle becomes a sphere, and a long limb a round tube: height about the half width.
    Even,
    /// A plateau with a rounded rim; the rim's radius, and so the height at depth one, is about a
    /// third of the radius of the largest circle that fits into the drawing.
    Flat,
    /// A tent: the height is the distance from the outline, slightly smoothed at the ridges. A
    /// circle becomes a cone as high as its radius. The silhouette is an edge.
    Peak,
}

/// How [`inflate`](crate::body::inflate::inflate) works.
#[derive(Clone, Debug, PartialEq)]
pub struct InflateOptions {
    /// Scales the height of both sides: 1e-9 to 1e9.
    pub depth: f64,
    /// Shape of the cross-section.
    pub profile: Profile,
    /// Depth of the front, in place of `depth`.
    pub front: Option<Side>,
    /// Depth of the back, in place of `depth`.
    pub back: Option<Side>,
    /// Reshapes the profile: values at evenly spaced arguments from 0 to 1 of a curve `c`. With `h` the
    /// height that the profile gives somewhere and `top` the largest of the body it becomes
    /// `top c(h / top)`. The first value is 0, the others positive; they may fall, for rings and dents.
    pub curve: Option<Vec<f64>>,
    /// Turning angle in radians from which on a drawn corner stays a corner; below it the stroke
    /// is taken for a coarsely drawn smooth one and the body is rounded there.
    pub corner_angle: f64,
    /// Where the back lies in the texture.
    pub uv: UvLayout,
    /// Of quads that will be subdivided by the rules of Catmull and Clark: the rim lies a little outside the
    /// drawing, so that the limit surface passes through the drawing where the rim's vertices were. Corners stay, and are
    /// to be creased; so is the whole rim of [`Profile::Peak`]. Triangles are left as they are.
    pub subdivided: bool,
}

impl Default for InflateOptions {
    fn default() -> Self {
        InflateOptions {
            depth: 1.0,
            profile: Profile::Round,
            front: None,
            back: None,
            curve: None,
            corner_angle: 40f64.to_radians(),
            uv: UvLayout::Apart,
            subdivided: false,
        }
    }
}

/// Depth of one side of a body.
#[derive(Clone, Debug, PartialEq)]
pub enum Side {
    /// The same everywhere; zero leaves the side flat.
    Uniform(f64),
    /// One value per input point of the outline, none negative: interpolated along the outline and
    /// extended smoothly (harmonically) inside. Contours of holes take what results there.
    PerPoint(Vec<f64>),
}

/// Depths, and the largest of one per point: heights beyond would leave the range in which areas and volumes
/// are computed, of drawings of any size.
pub(crate) const RANGE: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

pub(crate) const ALLOWED: &str = "a number from 1e-9 to 1e9";
