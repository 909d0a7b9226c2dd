//! Plain geometry that knows nothing of lattices: segments, intersections, measures of meshes.

pub(crate) mod active;
pub mod bones;
pub(crate) mod cholesky;
pub(crate) mod corner;
pub(crate) mod disjoint;
pub mod embed;
pub(crate) mod facet;
pub mod harmonic;
pub(crate) mod laplace;
pub(crate) mod lengthen;
pub(crate) mod march;
pub mod metrics;
pub(crate) mod polygon;
pub(crate) mod quadratic;
pub(crate) mod segments;
pub(crate) mod stars;
pub(crate) mod topology;
