//! Files of pictures: PNG, JPEG and WebP, with limits that hold before anything is decoded.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use image::codecs::jpeg::JpegDecoder;
use image::codecs::png::PngDecoder;
use image::codecs::webp::WebPDecoder;
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, Limits};

use super::field::Picture;
use crate::error::{Error, Result};

/// Memory that a decoder may take beside the pixels.
const ROOM: u64 = 64 << 20;

/// Pixels of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Decoded {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue and alpha of each pixel, row by row from the top.
    pub pixels: Vec<u8>,
}

/// Decodes a PNG, JPEG or WebP file. Depths above 8 bits are rounded, grey and palettes become colours, CMYK is converted; colour
/// profiles and the orientation that a camera noted are not applied.
///
/// The size is read first: a picture of more than [`MAX_PIXELS`](super::MAX_PIXELS) is refused before memory is taken for it.
///
/// # Errors
/// [`Error::PictureSize`], and [`Error::PictureFormat`] for anything else that cannot be read in full: other formats,
/// damaged or cut off files, animations.
pub fn decode_image(bytes: &[u8]) -> Result<Decoded> {
    // The decoders are not ours; whatever a file does to them, it is the file that is refused.
    catch_unwind(AssertUnwindSafe(|| decoded(bytes)))
        .unwrap_or_else(|_| Err(refused("it breaks the decoder".to_owned())))
}

fn decoded(bytes: &[u8]) -> Result<Decoded> {
    if bytes.is_empty() {
        return Err(refused("it is empty".to_owned()));
    }
    let file = Cursor::new(bytes);
    let whole = |error: ImageError| refused(in_short(&error));
    match image::guess_format(bytes) {
        Ok(ImageFormat::Png) => {
            let decoder = PngDecoder::with_limits(file, limits()).map_err(whole)?;
            check_size(&decoder)?;
            if decoder.is_apng().map_err(whole)? {
                return Err(moving());
            }
            pixels(decoder)
        }
        Ok(ImageFormat::Jpeg) => {
            let decoder = JpegDecoder::new(file).map_err(whole)?;
            check_size(&decoder)?;
            if !has_end(bytes) {
                return Err(refused("it is cut off".to_owned()));
            }
            pixels(decoder)
        }
        Ok(ImageFormat::WebP) => {
            let decoder = WebPDecoder::new(file).map_err(whole)?;
            check_size(&decoder)?;
            if decoder.has_animation() {
                return Err(moving());
            }
            pixels(decoder)
        }
        _ => Err(refused("it is no PNG, JPEG or WebP".to_owned())),
    }
}

fn check_size(decoder: &impl ImageDecoder) -> Result<()> {
    let (width, height) = decoder.dimensions();
    Picture::check_size(width as usize, height as usize)
}

fn pixels(mut decoder: impl ImageDecoder) -> Result<Decoded> {
    let failed = |error: ImageError| refused(in_short(&error));
    decoder.set_limits(limits()).map_err(failed)?;
    let pixels = DynamicImage::from_decoder(decoder).map_err(failed)?.into_rgba8();
    let (width, height) = (pixels.width() as usize, pixels.height() as usize);
    Ok(Decoded { width, height, pixels: pixels.into_raw() })
}

fn limits() -> Limits {
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(16 * super::MAX_PIXELS as u64 + ROOM);
    limits
}

/// Whether the last scan of a JPEG has an end; decoders paint what is missing grey, without a word.
fn has_end(bytes: &[u8]) -> bool {
    let marker = |second: u8| move |pair: &[u8]| pair == [0xff, second];
    bytes.windows(2).rposition(marker(0xda)).is_some_and(|scan| bytes[scan..].windows(2).any(marker(0xd9)))
}

fn moving() -> Error {
    refused("it has more than one frame; save the one that is meant as a picture".to_owned())
}

fn refused(reason: String) -> Error {
    Error::PictureFormat { reason }
}

/// The innermost reason, on one line.
fn in_short(error: &ImageError) -> String {
    let mut innermost: &dyn std::error::Error = error;
    while let Some(source) = innermost.source() {
        innermost = source;
    }
    let text: String = innermost.to_string().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    format!("it is damaged ({})", text.trim_end_matches('.'))
}
