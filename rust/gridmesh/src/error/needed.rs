//! What works where too little was asked for.

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
