//! The loops to be filled and the mesh around them.

pub(crate) mod check;
pub mod holes;
pub(crate) mod mesh;
pub mod outer;
pub(crate) mod reserve;
pub(crate) mod touching;
