//! The picture: coverage by pixel.

use crate::error::{Error, Result};

/// The most pixels that a picture may have.
pub const MAX_PIXELS: usize = 100_000_000;

/// How far pixels are covered, 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: i32,
    height: i32,
    /// Row by row from the top.
    values: Vec<f32>,
}

impl Picture {
    /// Whether a picture of this size may be read, to be asked before it is decoded.
    ///
    /// # Errors
    /// [`Error::PictureSize`] if it has no pixel, or more than [`MAX_PIXELS`].
    pub fn check_size(width: usize, height: usize) -> Result<()> {
        match width.checked_mul(height) {
            Some(1..=MAX_PIXELS) => Ok(()),
            _ => Err(Error::PictureSize { width, height, limit: MAX_PIXELS }),
        }
    }

    /// A picture of `height` rows from the top, `width` values each; values are limited to 0 to 1.
    ///
    /// # Errors
    /// [`Error::PictureSize`] for sizes that are not allowed or do not fit the number of values, and
    /// [`Error::PixelNotFinite`].
    pub fn new(width: usize, height: usize, mut values: Vec<f32>) -> Result<Self> {
        Self::check_size(width, height)?;
        if values.len() != width * height {
            return Err(Error::PictureSize { width, height, limit: MAX_PIXELS });
        }
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            return Err(Error::PixelNotFinite { row: at / width, column: at % width });
        }
        values.iter_mut().for_each(|value| *value = value.clamp(0.0, 1.0));
        Ok(Self { width: width as i32, height: height as i32, values })
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width as usize
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height as usize
    }

    /// All values, row by row from the top.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The value of a pixel, counted from the lower left corner; 0 outside.
    pub(super) fn at(&self, x: i32, y: i32) -> f64 {
        if x < 0 || y < 0 || x >= self.width || y >= self.height {
            return 0.0;
        }
        f64::from(self.values[(self.height - 1 - y) as usize * self.width as usize + x as usize])
    }

    /// The values of a row, counted from below.
    pub(super) fn row(&self, y: usize) -> &[f32] {
        let first = (self.height() - 1 - y) * self.width();
        &self.values[first..first + self.width()]
    }
}
