//! Drawings of every stage, as small SVG files (feature `svg`).
//!
//! A [`Picture`] is one panel in the units of the drawing; [`page`] puts panels side by side, with
//! titles, captions and one legend. Coordinates are rounded to a tenth of a pixel and written
//! relative to each other, so that a mesh costs about seven bytes an edge. Colours are CSS classes
//! which follow the reader's light or dark scheme. Equal input gives equal bytes.

mod ink;
mod page;
mod picture;

pub use self::ink::Ink;
pub use self::page::page;
pub use crate::svg::picture::Picture;
