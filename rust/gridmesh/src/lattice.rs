//! Integers: the lattices of triangles and of squares, closed paths on them, and the cells between them. No floating point.

pub mod assemble;
pub mod axial;
pub mod boundary;
pub mod cells;
pub mod dir;
pub mod grid;
pub mod reflection;
pub mod squares;
