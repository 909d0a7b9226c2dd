//! What can go wrong, said so that the caller can mend it.

use std::fmt;

/// Result with [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why a call was refused. Nothing is returned half done.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// What holds the coordinate, such as `outline` or `hole 2`.
        what: String,
        /// Index of the point.
        point: usize,
    },
    /// The drawing is so large or small that areas leave the range of floating point.
    ExtremeSize {
        /// What was given, such as `outline` or `hole 2`.
        what: String,
        /// Its width or height.
        size: f64,
    },
    /// Fewer than three distinct points.
    TooFewPoints {
        /// What was given, such as `outline` or `hole 2`.
        what: String,
        /// Number of distinct points found.
        distinct: usize,
    },
    /// All points lie on one line, or the outline encloses nothing.
    ZeroArea {
        /// What was given, such as `outline` or `hole 2`.
        what: String,
    },
    /// Two segments of the input cross, touch or overlap.
    SelfIntersecting {
        /// What was given, such as `outline` or `hole 2`.
        what: String,
        /// Index of the first segment (it runs from this input point to the next).
        first: usize,
        /// Index of the second segment.
        second: usize,
        /// Where they meet, in the units of the drawing.
        at: [f64; 2],
    },
    /// The parts that a self-crossing outline encloses meet in single points only.
    Disconnected {
        /// What was given, such as `outline`.
        what: String,
        /// Number of parts.
        parts: usize,
    },
    /// A hole does not lie inside the outline, or meets the outline or another hole.
    HoleMisplaced {
        /// Index of the hole.
        hole: usize,
        /// What is wrong with it, such as `crosses the outline`.
        reason: String,
    },
    /// A mirror-symmetric mesh was asked for, of a drawing that is not symmetric.
    NotSymmetric {
        /// What is not, such as `outline` or `hole 2`.
        what: String,
        /// How far a point is from the mirror image of its partner; infinite if it has none.
        distance: f64,
        /// The distance allowed.
        allowed: f64,
        /// Where, in the units of the drawing.
        at: [f64; 2],
    },
    /// An option has a value that is not allowed.
    InvalidOption {
        /// Name of the option.
        name: &'static str,
        /// The value that was given.
        value: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// No chord-free lattice patch of about this size follows the drawing.
    TooCoarse {
        /// The number of triangles that was asked for.
        triangles: usize,
        /// The least number that works.
        least: usize,
    },
    /// The mesh asked for is larger than is supported.
    TooLarge {
        /// Triangles asked for (estimated from the area).
        triangles: f64,
        /// The largest number allowed.
        limit: f64,
    },
    /// No valid patch was found at any resolution tried.
    NoPatch {
        /// What stood in the way at the last resolution tried.
        reason: String,
        /// Where, in the units of the drawing.
        at: [f64; 2],
    },
    /// A linear solve failed.
    Solver {
        /// The stage, such as `inflation`.
        stage: &'static str,
        /// The solver's own words.
        reason: String,
    },
    /// The caller asked to stop.
    Cancelled,
}

impl Error {
    /// A stable word for each kind of error, for programs.
    pub fn kind(&self) -> &'static str {
        match self {
            Error::NotFinite { .. } => "not_finite",
            Error::ExtremeSize { .. } => "extreme_size",
            Error::TooFewPoints { .. } => "too_few_points",
            Error::ZeroArea { .. } => "zero_area",
            Error::SelfIntersecting { .. } => "self_intersecting",
            Error::Disconnected { .. } => "disconnected",
            Error::HoleMisplaced { .. } => "hole_misplaced",
            Error::NotSymmetric { .. } => "not_symmetric",
            Error::InvalidOption { .. } => "invalid_option",
            Error::TooCoarse { .. } => "too_coarse",
            Error::TooLarge { .. } => "too_large",
            Error::NoPatch { .. } => "no_patch",
            Error::Solver { .. } => "solver",
            Error::Cancelled => "cancelled",
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::NotFinite { what, point } => {
                write!(f, "point {point} of the {what} is NaN or infinite; all coordinates must be finite")
            }
            Error::ExtremeSize { what, size } => {
                write!(f, "the {what} is {size:.3e} across; allowed: 1e-60 to 1e60, scale the drawing")
            }
            Error::TooFewPoints { what, distinct } => {
                write!(
                    f,
                    "the {what} has {distinct} distinct points; at least 3 are needed, draw a closed shape"
                )
            }
            Error::ZeroArea { what } => {
                write!(f, "the {what} encloses no area: its points lie on one line; draw a closed shape")
            }
            Error::SelfIntersecting { what, first, second, at: [x, y] } => write!(
                f,
                "the {what} meets itself: segments {first} and {second} cross or touch at ({x:.6}, {y:.6}); \
                 draw an outline that does not cross itself"
            ),
            Error::Disconnected { what, parts } => write!(
                f,
                "the {what} encloses {parts} parts that meet only where it crosses itself; draw each of them \
                 as an outline of its own"
            ),
            Error::HoleMisplaced { hole, reason } => {
                write!(
                    f,
                    "hole {hole} {reason}; each hole must lie inside the outline and apart from the others"
                )
            }
            Error::NotSymmetric { what, distance, allowed, at: [x, y] } => {
                write!(f, "the {what} is not its own mirror image: near ({x:.6}, {y:.6}) ")?;
                if distance.is_finite() {
                    write!(f, "it is {distance:.3e} off")?;
                } else {
                    write!(f, "it has no partner across the axis")?;
                }
                write!(
                    f,
                    "; allowed: {allowed:.3e} (2 % of the drawing's size, 1.5 edge lengths); give another axis, \
                     or mesh it without mirror"
                )
            }
            Error::InvalidOption { name, value, allowed } => {
                write!(f, "{name} is {value}; allowed: {allowed}")
            }
            Error::TooCoarse { triangles, least } => write!(
                f,
                "{triangles} triangles are too few to follow this drawing; {least} work (or a smaller edge length)"
            ),
            Error::TooLarge { triangles, limit } => write!(
                f,
                "about {triangles:.3e} triangles were asked for; at most {limit:.3e} are supported, \
                 use a larger edge length"
            ),
            Error::NoPatch { reason, at: [x, y] } => {
                write!(
                    f,
                    "no valid mesh was found: {reason} near ({x:.6}, {y:.6}); simplify the drawing there"
                )
            }
            Error::Solver { stage, reason } => {
                write!(f, "the linear solve of the {stage} failed: {reason}")
            }
            Error::Cancelled => write!(f, "cancelled"),
        }
    }
}

impl std::error::Error for Error {}
