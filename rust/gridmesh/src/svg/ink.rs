//! What is drawn, and in which colours.

/// What a line, a face or a dot stands for; decides its colour and width.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ink {
    /// The edges of the lattice.
    Lattice,
    /// The curve as it was drawn.
    Drawing,
    /// The faired curve that steers the path.
    Target,
    /// The inside of a patch.
    Fill,
    /// Triangles that a stage has added.
    Added,
    /// The seed of the growth.
    Seed,
    /// Edges of triangles.
    Wire,
    /// The boundary.
    Path,
    /// Edges inside the patch between two boundary vertices.
    Chord,
    /// Lattice points near the curve.
    Band,
    /// From boundary vertices to their places on the curve.
    Mapped,
    /// Drawn corners that have a vertex of their own.
    Corner,
    /// Boundary vertices of patch valence two: the tips of single triangles.
    Tip,
    /// Boundary vertices of patch valence three.
    Three,
    /// Boundary vertices of patch valence five.
    Five,
    /// Boundary vertices of patch valence six.
    Six,
}

impl Ink {
    /// Class name, width of lines and dots (0: a face), colour on light and on dark paper.
    pub(super) fn style(self) -> (&'static str, f64, &'static str, &'static str) {
        match self {
            Ink::Lattice => ("l", 0.6, "#dbe1e8", "#27303b"),
            Ink::Drawing => ("d", 1.8, "#0f8a7e", "#2dd4bf"),
            Ink::Target => ("t", 1.1, "#d6409f", "#f778ba"),
            Ink::Fill => ("f", 0.0, "#e9eef4", "#1d2732"),
            Ink::Added => ("a", 0.0, "#fbe3a6", "#55471a"),
            Ink::Seed => ("s", 0.0, "#9fb3c8", "#48617c"),
            Ink::Wire => ("w", 0.6, "#8796a6", "#5d6e80"),
            Ink::Path => ("p", 1.5, "#1f2933", "#e6edf3"),
            Ink::Chord => ("c", 2.4, "#e0383e", "#ff6b6b"),
            Ink::Band => ("b", 4.0, "#8fa3b8", "#5d748c"),
            Ink::Mapped => ("m", 0.9, "#1f2933", "#e6edf3"),
            Ink::Corner => ("k", 9.0, "#0f8a7e", "#2dd4bf"),
            Ink::Tip => ("v2", 6.5, "#e0383e", "#ff6b6b"),
            Ink::Three => ("v3", 6.5, "#1f6feb", "#58a6ff"),
            Ink::Five => ("v5", 6.5, "#e8590c", "#ff9e3d"),
            Ink::Six => ("v6", 6.5, "#8a3ffc", "#c792ff"),
        }
    }

    pub(super) fn class(self) -> &'static str {
        self.style().0
    }

    pub(super) fn is_face(self) -> bool {
        self.style().1 == 0.0
    }

    pub(super) fn is_dot(self) -> bool {
        self >= Ink::Corner || self == Ink::Band
    }

    /// The ink of a boundary vertex that turns by so many times 60 degrees; none if it is regular
    /// after stitching.
    pub fn of_turn(turn: i32) -> Option<Ink> {
        match turn {
            2 => Some(Ink::Tip),
            1 => Some(Ink::Three),
            -1 => Some(Ink::Five),
            -2 => Some(Ink::Six),
            _ => None,
        }
    }
}
