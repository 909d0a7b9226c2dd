//! The mesh divided along the line where the swept surface meets it.

pub(crate) mod chains;
pub(crate) mod cross;
pub(crate) mod divider;
pub(crate) mod ended;
pub(crate) mod locate;
pub(crate) mod node;
pub(crate) mod parted;
pub(crate) mod split;
