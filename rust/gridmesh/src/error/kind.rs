//! The word for each kind of error.

use super::Error;

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
            Error::TooLarge { .. } | Error::CutTooLarge { .. } => "too_large",
            Error::NoPatch { .. } => "no_patch",
            Error::Solver { .. } => "solver",
            Error::Cancelled => "cancelled",
            Error::Inverted { .. } => "inverted",
            Error::Internal { .. } => "internal",
            Error::IndexOutOfRange { .. } | Error::FaceOutOfRange { .. } => "index_out_of_range",
            Error::Loops(fault) => fault.kind(),
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
            Error::SliceTooThin { .. } => "slice_too_thin",
            Error::BehindEye { .. } => "behind_eye",
            Error::CutFailed { .. } => "cut_failed",
            Error::StillJoined { .. } => "still_joined",
            Error::NotClosed { .. } => "not_closed",
            Error::JoinFailed { .. } => "join_failed",
            Error::JoinIntersects { .. } => "join_intersects",
            Error::PictureSize { .. } => "picture_size",
            Error::PictureFormat { .. } => "picture_format",
            Error::PixelNotFinite { .. } => "not_finite",
        }
    }
}
