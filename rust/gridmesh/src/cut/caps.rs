//! The cut closed: regions of the swept surface, filled and rolled up again.

pub(crate) mod bridge;
pub(crate) mod bulge;
pub(crate) mod cap;
pub(crate) mod capper;
pub(crate) mod loops;
pub(crate) mod mirrored;
pub(crate) mod regions;
pub(crate) mod ring;
pub(crate) mod sources;
