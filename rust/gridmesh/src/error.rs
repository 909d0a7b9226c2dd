//! What can go wrong, said so that the caller can mend it.

mod kind;
mod several;
mod words;

pub use self::several::LoopError;
pub use self::words::Needed;
use self::words::{no_such_face, not_a_disk, not_symmetric, out_of_range, too_coarse};
pub(crate) use self::words::{told, told_all};

/// Result with [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why a call was refused. Nothing is returned half done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A coordinate is NaN or infinite.
    #[error("point {point} of the {what} is NaN or infinite; all coordinates must be finite")]
    NotFinite {
        /// What holds the coordinate, such as `outline` or `hole 2`.
        what: String,
        /// Index of the point.
        point: usize,
    },
    /// The drawing is so large or small that areas leave the range of floating point.
    #[error(
        "the {what} is {size:.3e} across; allowed: 1e-30 to 1e30 (meshes and loops in space: 1e-60 to \
         1e60), scale it"
    )]
    ExtremeSize {
        /// What was given, such as `outline` or `hole 2`.
        what: String,
        /// Its width or height.
        size: f64,
    },
    /// Fewer than three distinct points.
    #[error("the {what} has {distinct} distinct points; at least 3 are needed, draw a closed shape")]
    TooFewPoints {
        /// What was given, such as `outline` or `hole 2`.
        what: String,
        /// Number of distinct points found.
        distinct: usize,
    },
    /// All points lie on one line, or the outline encloses nothing.
    #[error("the {what} encloses no area: its points lie on one line; draw a closed shape")]
    ZeroArea {
        /// What was given, such as `outline` or `hole 2`.
        what: String,
    },
    /// Two segments of the input cross, touch or overlap.
    #[error(
        "the {what} meets itself: segments {first} and {second} cross or touch at ({:.6}, {:.6}); draw \
         an outline that does not cross itself",
        .at[0], .at[1]
    )]
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
    #[error(
        "the {what} encloses {parts} parts that meet only where it crosses itself; draw each of them as \
         an outline of its own"
    )]
    Disconnected {
        /// What was given, such as `outline`.
        what: String,
        /// Number of parts.
        parts: usize,
    },
    /// A hole does not lie inside the outline, or meets the outline or another hole.
    #[error("hole {hole} {reason}; each hole must lie inside the outline and apart from the others")]
    HoleMisplaced {
        /// Index of the hole.
        hole: usize,
        /// What is wrong with it, such as `crosses the outline`.
        reason: String,
    },
    /// A mirror-symmetric mesh was asked for, of a drawing that is not symmetric.
    #[error(fmt = not_symmetric)]
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
    #[error("{name} is {value}; allowed: {allowed}")]
    InvalidOption {
        /// Name of the option.
        name: &'static str,
        /// The value that was given.
        value: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// No chord-free lattice patch of about this size follows the drawing.
    #[error(fmt = too_coarse)]
    TooCoarse {
        /// The number of triangles, or of quads, that was asked for.
        triangles: usize,
        /// What it is the number of: "triangles" or "quads".
        cells: &'static str,
        /// What is known of the number that would do.
        needed: Needed,
    },
    /// The mesh asked for is larger than is supported.
    #[error(
        "about {triangles:.0} triangles were asked for; at most {limit:.0} are supported, use fewer (or a larger edge length)"
    )]
    TooLarge {
        /// Triangles asked for (estimated from the area).
        triangles: f64,
        /// The largest number allowed.
        limit: f64,
    },
    /// No valid patch was found at any resolution tried.
    #[error(
        "no valid mesh was found: {reason} near ({:.6}, {:.6}); simplify the drawing there",
        .at[0], .at[1]
    )]
    NoPatch {
        /// What stood in the way at the last resolution tried.
        reason: String,
        /// Where, in the units of the drawing.
        at: [f64; 2],
    },
    /// A linear solve failed.
    #[error("the linear solve of the {stage} failed: {reason}")]
    Solver {
        /// The stage, such as `inflation`.
        stage: &'static str,
        /// The solver's own words.
        reason: String,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// Without relaxation some triangles of the patch are inverted.
    #[error(
        "without relaxation triangles are inverted, one of them near ({:.6}, {:.6}); leave relax on, or \
         use more triangles",
        .at[0], .at[1]
    )]
    Inverted {
        /// A corner of one of them, in the units of the drawing.
        at: [f64; 2],
    },
    /// The library contradicts itself: a bug, whatever the input.
    #[error("a bug in gridmesh, please report it with this input: {reason}")]
    Internal {
        /// What should not be.
        reason: &'static str,
    },
    /// A vertex number that does not exist.
    #[error(fmt = out_of_range)]
    IndexOutOfRange {
        /// What names it, such as `loop` or `triangle 7`.
        what: String,
        /// The number given.
        index: i32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A loop names a vertex twice in a row.
    #[error(
        "the loop names vertex {vertex} twice in a row (places {first} and {second}); name each vertex once"
    )]
    RepeatedVertex {
        /// The vertex.
        vertex: u32,
        /// Its first place in the loop.
        first: usize,
        /// Its second place in the loop.
        second: usize,
    },
    /// A loop passes through a vertex twice.
    #[error("the loop passes through vertex {vertex} twice, like a figure eight; fill its parts one by one")]
    FigureEight {
        /// The vertex.
        vertex: u32,
    },
    /// Edges that should form loops meet three or more in a vertex.
    #[error(
        "{edges} of the edges meet in vertex {vertex}; a loop has two at each vertex, deselect the others"
    )]
    Branching {
        /// The vertex.
        vertex: u32,
        /// The number of edges there.
        edges: usize,
    },
    /// Edges that should form a loop end.
    #[error(
        "the edges form an open chain from vertex {} to vertex {}; join its ends to a closed loop",
        .ends[0], .ends[1]
    )]
    OpenChain {
        /// Two vertices with one edge each.
        ends: [u32; 2],
    },
    /// Two neighbours on a loop lie on the same point.
    #[error(
        "the loop's edge from vertex {} to vertex {} has no length; merge the two vertices",
        .edge[0], .edge[1]
    )]
    ZeroLengthEdge {
        /// The two vertices.
        edge: [u32; 2],
    },
    /// Two vertices of a loop that are not neighbours lie on the same point, or a vertex lies on or an
    /// edge crosses an edge that it does not belong to.
    #[error(
        "the loop touches itself at vertices {first} and {second}, near ({:.6}, {:.6}, {:.6}); merge or \
         move apart what meets there",
        .at[0], .at[1], .at[2]
    )]
    SelfTouching {
        /// A vertex, or the first vertex of an edge, of the loop.
        first: u32,
        /// Another one.
        second: u32,
        /// Where they meet.
        at: [f64; 3],
    },
    /// An edge of a loop has faces on both sides already.
    #[error(
        "the loop's edge from vertex {} to vertex {} has faces on both sides; there is no hole, choose \
         edges of one face",
        .edge[0], .edge[1]
    )]
    FacesOnBothSides {
        /// The two vertices.
        edge: [u32; 2],
    },
    /// An edge joins more than two faces, or more than two would result.
    #[error(
        "the border stops at vertex {vertex} after the edge from vertex {} to vertex {}: an edge there \
         joins more than two faces; delete the surplus ones",
        .edge[0], .edge[1]
    )]
    NonManifold {
        /// The two vertices.
        edge: [u32; 2],
        /// Where the border ends because of it.
        vertex: u32,
    },
    /// Two loops of one call use the same edge.
    #[error(
        "loop {second} uses the edge from vertex {} to vertex {} like loop {first}; give each loop edge \
         to one loop",
        .edge[0], .edge[1]
    )]
    SharedEdge {
        /// The two vertices.
        edge: [u32; 2],
        /// The loop that came first.
        first: usize,
        /// The loop that is refused.
        second: usize,
    },
    /// Faces that were to be replaced do not form a disk.
    #[error(fmt = not_a_disk)]
    NotADisk {
        /// Their number.
        faces: usize,
        /// Their number of borders.
        borders: usize,
    },
    /// A face number that does not exist.
    #[error(fmt = no_such_face)]
    FaceOutOfRange {
        /// The number given.
        index: i32,
        /// How many faces there are.
        faces: usize,
    },
    /// Loops that cannot be filled or joined.
    #[error(transparent)]
    Loops(LoopError),
    /// The fill meets itself or the mesh, which was not to be.
    #[error(
        "the fill would meet itself or the mesh in {pairs} pairs of triangles, first near ({:.6}, {:.6}, \
         {:.6}); split the loop there, or allow it",
        .at[0], .at[1], .at[2]
    )]
    FillIntersects {
        /// Pairs of triangles that meet.
        pairs: usize,
        /// A point of one of them.
        at: [f64; 3],
    },
    /// A face is not a polygon.
    #[error(
        "face {face} is not allowed: {reason}; each face needs three or more different vertices in order"
    )]
    InvalidFace {
        /// The face.
        face: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A stroke has too few distinct points, as it is seen, to cut along.
    #[error(
        "the stroke has {distinct} distinct points as it is seen along the cut; an open one needs 2, a \
         closed one 3: draw across the model, or cut along another direction"
    )]
    StrokeTooShort {
        /// Number of distinct points seen.
        distinct: usize,
    },
    /// A stroke does not divide the mesh.
    #[error(
        "the stroke does not divide the mesh: all of it lies on one side, continued ends included; draw \
         across the model"
    )]
    StrokeMisses,
    /// Nothing but slices that are too thin would come off by a cut.
    #[error(
        "the mesh ends along the stroke already: a slice thinner than {least:.6} would come off; draw the stroke farther \
         from its border, or ask for shorter edges"
    )]
    SliceTooThin {
        /// Least thickness of a slice.
        least: f64,
    },
    /// A cut would have more edges or triangles than is supported.
    #[error(
        "the cut would get about {number:.0} {what}; at most {limit:.0} are supported, use a larger edge length"
    )]
    CutTooLarge {
        /// What there would be too many of: `edges along its lines` or `triangles in its caps`.
        what: &'static str,
        /// Their number, estimated.
        number: f64,
        /// The largest number allowed.
        limit: f64,
    },
    /// A point is not in front of the eye.
    #[error(
        "point {point} of the {what} is not in front of the eye; move the eye back, or cut along a \
         direction"
    )]
    BehindEye {
        /// What has the point: `mesh` or `stroke`.
        what: &'static str,
        /// Its number.
        point: usize,
    },
    /// Rounding leaves no consistent cut.
    #[error(
        "the mesh cannot be cut here: {reason}, near ({:.6}, {:.6}, {:.6}); move the stroke a little, or \
         merge vertices that nearly coincide there",
        .at[0], .at[1], .at[2]
    )]
    CutFailed {
        /// What stands in the way.
        reason: &'static str,
        /// Where.
        at: [f64; 3],
    },
    /// What a stroke crosses without its ends continued hangs together around the cut.
    #[error(
        "what the stroke crosses still hangs together around the cut, near ({:.6}, {:.6}, {:.6}); draw \
         it across all that must come apart, or let its ends be extended",
        .at[0], .at[1], .at[2]
    )]
    StillJoined {
        /// Where.
        at: [f64; 3],
    },
    /// A part that is to be joined is no closed surface.
    #[error(
        "part {part} is not closed and manifold: {reason} near vertex {vertex} at ({:.6}, {:.6}, {:.6}); \
         fill its holes and merge doubled vertices, or delete the surplus faces",
        .at[0], .at[1], .at[2]
    )]
    NotClosed {
        /// The part.
        part: usize,
        /// What is wrong.
        reason: &'static str,
        /// A vertex there.
        vertex: u32,
        /// Where.
        at: [f64; 3],
    },
    /// Parts meet in a way that has no closed surface around it.
    #[error(
        "the parts cannot be joined here: {reason}, near ({:.6}, {:.6}, {:.6}); move one of them a little, \
         blend less, or give them shorter edges there",
        .at[0], .at[1], .at[2]
    )]
    JoinFailed {
        /// What stands in the way.
        reason: &'static str,
        /// Where.
        at: [f64; 3],
    },
    /// A joint meets itself or the mesh, which was not to be.
    #[error(
        "the joints meet themselves or the parts in {pairs} pairs of triangles, first near ({:.6}, {:.6}, \
         {:.6}); blend less, move a part, or allow it",
        .at[0], .at[1], .at[2]
    )]
    JoinIntersects {
        /// Pairs of triangles that meet.
        pairs: usize,
        /// A point of one of them.
        at: [f64; 3],
    },
    /// A picture has no pixels, or too many.
    #[error("the picture is {width} by {height} pixels; allowed: 1 to {limit} pixels in all, scale it")]
    PictureSize {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// The most pixels allowed.
        limit: usize,
    },
    /// A file of a picture cannot be read.
    #[error("the picture cannot be read: {reason}; allowed: PNG, JPEG and WebP, each of one picture")]
    PictureFormat {
        /// What is wrong with it.
        reason: String,
    },
    /// A value of a picture is NaN or infinite.
    #[error(
        "the pixel in row {row}, column {column} of the picture is NaN or infinite; all values must be finite"
    )]
    PixelNotFinite {
        /// Its row, from the top.
        row: usize,
        /// Its column, from the left.
        column: usize,
    },
}
