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
        /// The number of triangles, or of quads, that was asked for.
        triangles: usize,
        /// What it is the number of: "triangles" or "quads".
        cells: &'static str,
        /// What is known of the number that would do.
        needed: Needed,
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
    /// Without relaxation some triangles of the patch are inverted.
    Inverted {
        /// A corner of one of them, in the units of the drawing.
        at: [f64; 2],
    },
    /// The library contradicts itself: a bug, whatever the input.
    Internal {
        /// What should not be.
        reason: &'static str,
    },
    /// A vertex number that does not exist.
    IndexOutOfRange {
        /// What names it, such as `loop` or `triangle 7`.
        what: String,
        /// The number given.
        index: i32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A loop names a vertex twice in a row.
    RepeatedVertex {
        /// The vertex.
        vertex: u32,
        /// Its first place in the loop.
        first: usize,
        /// Its second place in the loop.
        second: usize,
    },
    /// A loop passes through a vertex twice.
    FigureEight {
        /// The vertex.
        vertex: u32,
    },
    /// Edges that should form loops meet three or more in a vertex.
    Branching {
        /// The vertex.
        vertex: u32,
        /// The number of edges there.
        edges: usize,
    },
    /// Edges that should form a loop end.
    OpenChain {
        /// Two vertices with one edge each.
        ends: [u32; 2],
    },
    /// Two neighbours on a loop lie on the same point.
    ZeroLengthEdge {
        /// The two vertices.
        edge: [u32; 2],
    },
    /// Two vertices of a loop that are not neighbours lie on the same point, or a vertex lies on or an
    /// edge crosses an edge that it does not belong to.
    SelfTouching {
        /// A vertex, or the first vertex of an edge, of the loop.
        first: u32,
        /// Another one.
        second: u32,
        /// Where they meet.
        at: [f64; 3],
    },
    /// An edge of a loop has faces on both sides already.
    FacesOnBothSides {
        /// The two vertices.
        edge: [u32; 2],
    },
    /// An edge joins more than two faces, or more than two would result.
    NonManifold {
        /// The two vertices.
        edge: [u32; 2],
        /// Where the border ends because of it.
        vertex: u32,
    },
    /// Two loops of one call use the same edge.
    SharedEdge {
        /// The two vertices.
        edge: [u32; 2],
        /// The loop that came first.
        first: usize,
        /// The loop that is refused.
        second: usize,
    },
    /// Faces that were to be replaced do not form a disk.
    NotADisk {
        /// Their number of borders.
        borders: usize,
    },
    /// The fill meets itself or the mesh, which was not to be.
    FillIntersects {
        /// Pairs of triangles that meet.
        pairs: usize,
        /// A point of one of them.
        at: [f64; 3],
    },
    /// A face is not a polygon.
    InvalidFace {
        /// The face.
        face: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A stroke has too few distinct points, as it is seen, to cut along.
    StrokeTooShort {
        /// Number of distinct points seen.
        distinct: usize,
    },
    /// A stroke does not divide the mesh.
    StrokeMisses,
    /// A point is not in front of the eye.
    BehindEye {
        /// What has the point: `mesh` or `stroke`.
        what: &'static str,
        /// Its number.
        point: usize,
    },
    /// Rounding leaves no consistent cut.
    CutFailed {
        /// What stands in the way.
        reason: &'static str,
        /// Where.
        at: [f64; 3],
    },
    /// What a stroke crosses without its ends continued hangs together around the cut.
    StillJoined {
        /// Where.
        at: [f64; 3],
    },
    /// A picture has no pixels, or too many.
    PictureSize {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// The most pixels allowed.
        limit: usize,
    },
    /// A value of a picture is NaN or infinite.
    PixelNotFinite {
        /// Its row, from the top.
        row: usize,
        /// Its column, from the left.
        column: usize,
    },
}

/// What is known of the number of triangles that a drawing needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needed {
    /// This number works, and none that is a tenth smaller was found to.
    Least(usize),
    /// Numbers up to this one were tried, and none of them works.
    MoreThan(usize),
    /// It was not searched for.
    Unknown,
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
            Error::Inverted { .. } => "inverted",
            Error::Internal { .. } => "internal",
            Error::IndexOutOfRange { .. } => "index_out_of_range",
            Error::RepeatedVertex { .. } => "repeated_vertex",
            Error::FigureEight { .. } => "figure_eight",
            Error::Branching { .. } => "branching",
            Error::OpenChain { .. } => "open_chain",
            Error::ZeroLengthEdge { .. } => "zero_length_edge",
            Error::SelfTouching { .. } => "self_touching",
            Error::FacesOnBothSides { .. } => "faces_on_both_sides",
            Error::NonManifold { .. } => "non_manifold",
            Error::SharedEdge { .. } => "shared_edge",
            Error::FillIntersects { .. } => "fill_intersects",
            Error::NotADisk { .. } => "not_a_disk",
            Error::InvalidFace { .. } => "invalid_face",
            Error::StrokeTooShort { .. } => "stroke_too_short",
            Error::StrokeMisses => "stroke_misses",
            Error::BehindEye { .. } => "behind_eye",
            Error::CutFailed { .. } => "cut_failed",
            Error::StillJoined { .. } => "still_joined",
            Error::PictureSize { .. } => "picture_size",
            Error::PixelNotFinite { .. } => "not_finite",
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
                write!(
                    f,
                    "the {what} is {size:.3e} across; allowed: 1e-30 to 1e30 (meshes and loops in space: 1e-60 to 1e60), \
                     scale it"
                )
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
            Error::NotSymmetric { what, distance, allowed, at: [x, y] } if distance.is_finite() => write!(
                f,
                "the {what} is not its own mirror image: near ({x:.6}, {y:.6}) it is {distance:.3e} off; \
                 allowed: {allowed:.3e} (2 % of the drawing's size, 1.5 edge lengths); give another axis, \
                 or mesh it without mirror"
            ),
            Error::NotSymmetric { what, allowed, at: [x, y], .. } => write!(
                f,
                "the {what} is not its own mirror image: near ({x:.6}, {y:.6}) it has no partner across the axis; \
                 allowed: {allowed:.3e} (2 % of the drawing's size, 1.5 edge lengths); give another axis, \
                 or mesh it without mirror"
            ),
            Error::InvalidOption { name, value, allowed } => {
                write!(f, "{name} is {value}; allowed: {allowed}")
            }
            Error::TooCoarse { triangles, cells, needed } => {
                match *cells {
                    "quads" => write!(f, "{triangles} quads are too few to follow this drawing; ")?,
                    _ => write!(f, "{triangles} triangles are too few to follow this drawing; ")?,
                }
                match needed {
                    Needed::Least(least) => write!(f, "{least} work (or a smaller edge length)"),
                    Needed::MoreThan(tried) => write!(
                        f,
                        "none that work were found up to {tried}, use more or draw its thin parts wider"
                    ),
                    Needed::Unknown => write!(f, "use more (or a smaller edge length)"),
                }
            }
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
            Error::Inverted { at: [x, y] } => write!(
                f,
                "without relaxation triangles are inverted, one of them near ({x:.6}, {y:.6}); \
                 leave relax on, or use more triangles"
            ),
            Error::Internal { reason } => {
                write!(f, "a bug in gridmesh, please report it with this input: {reason}")
            }
            Error::IndexOutOfRange { what, index, vertices } => write!(
                f,
                "the {what} names vertex {index}; allowed: 0 to {}, one of the {vertices} vertices given",
                vertices.saturating_sub(1)
            ),
            Error::RepeatedVertex { vertex, first, second } => write!(
                f,
                "the loop names vertex {vertex} twice in a row (places {first} and {second}); \
                 name each vertex once"
            ),
            Error::FigureEight { vertex } => write!(
                f,
                "the loop passes through vertex {vertex} twice, like a figure eight; fill its parts one by one"
            ),
            Error::Branching { vertex, edges } => write!(
                f,
                "{edges} of the edges meet in vertex {vertex}; a loop has two at each vertex, deselect the others"
            ),
            Error::OpenChain { ends: [a, b] } => write!(
                f,
                "the edges form an open chain from vertex {a} to vertex {b}; join its ends to a closed loop"
            ),
            Error::ZeroLengthEdge { edge: [a, b] } => write!(
                f,
                "the loop's edge from vertex {a} to vertex {b} has no length; merge the two vertices"
            ),
            Error::SelfTouching { first, second, at: [x, y, z] } => write!(
                f,
                "the loop touches itself at vertices {first} and {second}, near ({x:.6}, {y:.6}, {z:.6}); \
                 merge or move apart what meets there"
            ),
            Error::FacesOnBothSides { edge: [a, b] } => write!(
                f,
                "the loop's edge from vertex {a} to vertex {b} has faces on both sides; \
                 there is no hole, choose edges of one face"
            ),
            Error::NonManifold { edge: [a, b], vertex } => write!(
                f,
                "the border stops at vertex {vertex} after the edge from vertex {a} to vertex {b}: \
                 an edge there joins more than two faces; delete the surplus ones"
            ),
            Error::SharedEdge { edge: [a, b], first, second } => write!(
                f,
                "loop {second} uses the edge from vertex {a} to vertex {b} like loop {first}; \
                 give each loop edge to one loop"
            ),
            Error::NotADisk { borders } => write!(
                f,
                "the faces have {borders} borders or touch themselves; choose one connected region without holes"
            ),
            Error::FillIntersects { pairs, at: [x, y, z] } => write!(
                f,
                "the fill would meet itself or the mesh in {pairs} pairs of triangles, \
                 first near ({x:.6}, {y:.6}, {z:.6}); split the loop there, or allow it"
            ),
            Error::InvalidFace { face, reason } => write!(
                f,
                "face {face} is not allowed: {reason}; each face needs three or more different vertices in order"
            ),
            Error::StrokeTooShort { distinct } => write!(
                f,
                "the stroke has {distinct} distinct points as it is seen along the cut; an open one needs 2, a closed one 3: \
                 draw across the model, or cut along another direction"
            ),
            Error::StrokeMisses => write!(
                f,
                "the stroke does not divide the mesh: all of it lies on one side, continued ends included; \
                 draw across the model"
            ),
            Error::BehindEye { what, point } => write!(
                f,
                "point {point} of the {what} is not in front of the eye; move the eye back, or cut along a direction"
            ),
            Error::CutFailed { reason, at: [x, y, z] } => write!(
                f,
                "the mesh cannot be cut here: {reason}, near ({x:.6}, {y:.6}, {z:.6}); move the stroke a little, \
                 or merge vertices that nearly coincide there"
            ),
            Error::StillJoined { at: [x, y, z] } => write!(
                f,
                "what the stroke crosses still hangs together around the cut, near ({x:.6}, {y:.6}, {z:.6}); \
                 draw it across all that must come apart, or let its ends be extended"
            ),
            Error::PictureSize { width, height, limit } => write!(
                f,
                "the picture is {width} by {height} pixels; allowed: 1 to {limit} pixels in all, scale it"
            ),
            Error::PixelNotFinite { row, column } => write!(
                f,
                "the pixel in row {row}, column {column} of the picture is NaN or infinite; all values must be finite"
            ),
        }
    }
}

impl std::error::Error for Error {}
