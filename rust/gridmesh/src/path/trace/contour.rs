//! A contour as the search for a path sees it: its graph and its prices.

use crate::lattice::grid::Triangular;
use crate::path::trace::graph::Graph;
use crate::path::trace::search::Potential;

/// One contour: what its path is searched on.
pub(super) struct Contour<G = Triangular> {
    pub graph: Graph<G>,
    pub potential: Potential,
}
