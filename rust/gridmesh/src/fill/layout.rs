//! A loop of space laid out in the plane.

pub(crate) mod develop;
pub(crate) mod lobes;
pub(crate) mod span;
pub(crate) mod thin;
pub(crate) mod unroll;
