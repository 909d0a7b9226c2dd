//! What can be wrong with loops, alone or among others.

use std::fmt;

/// Why loops cannot be filled or joined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoopError {
    /// A loop has fewer than three vertices.
    #[error(fmt = short)]
    Short {
        /// Its place among those given, if there are several.
        number: Option<usize>,
        /// How many it has.
        vertices: usize,
    },
    /// Two loops have a vertex in common.
    #[error(
        "loops {} and {} both pass through vertex {vertex}; split it, or choose loops that are apart",
        .loops[0], .loops[1]
    )]
    Shared {
        /// The vertex.
        vertex: u32,
        /// The places of the loops among those given.
        loops: [usize; 2],
    },
    /// Two loops lie on each other, all along or in places.
    #[error(
        "loops {} and {} touch at vertices {} and {}, near ({:.6}, {:.6}, {:.6}): no face fits between them there; \
         merge the vertices by distance, or move one of the loops away",
        .loops[0], .loops[1], .vertices[0], .vertices[1], .at[0], .at[1], .at[2]
    )]
    Touching {
        /// The places of the loops among those given.
        loops: [usize; 2],
        /// A vertex of each, or the first vertex of an edge.
        vertices: [u32; 2],
        /// Where they touch.
        at: [f64; 3],
    },
    /// One patch was asked for between loops of which two look away from each other.
    #[error(
        "loops {} and {}, around vertices {} and {}, look away from each other, as both ends of a pipe do: one patch between \
         all the loops would meet itself; join them in pairs, or choose loops that face each other",
        .loops[0], .loops[1], .vertices[0], .vertices[1]
    )]
    LookApart {
        /// The places of the loops among those given.
        loops: [usize; 2],
        /// A vertex of each.
        vertices: [u32; 2],
    },
}

impl LoopError {
    pub(super) fn kind(&self) -> &'static str {
        match self {
            LoopError::Short { .. } => "too_few_points",
            LoopError::Shared { .. } => "figure_eight",
            LoopError::Touching { .. } => "loops_touch",
            LoopError::LookApart { .. } => "fill_intersects",
        }
    }
}

fn short(number: &Option<usize>, vertices: &usize, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match number {
        Some(number) => write!(
            f,
            "loop {number} has {vertices} vertices; at least 3 are needed, name all vertices around the hole in order"
        ),
        None => write!(
            f,
            "the loop has {vertices} vertices; at least 3 are needed, name all vertices around the hole in order"
        ),
    }
}
