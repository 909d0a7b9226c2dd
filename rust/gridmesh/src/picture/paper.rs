//! Drawings on paper: what is not paper is covered.
//!
//! Light that falls unevenly on a sheet changes slowly: the brightness of the paper is a parabola of place, fitted
//! to the brightest pixels of blocks, without the blocks that a drawing darkens. Of chalk on a board all is the other way round.

use crate::error::Result;
use crate::geometry::cholesky::Pattern;
use crate::picture::field::Picture;
use crate::picture::threshold::otsu;
use crate::progress::Progress;

/// Blocks along the longer side.
const BLOCKS: usize = 24;

/// Fits, each without the blocks that are too dark for the one before.
const ROUNDS: usize = 8;

/// Blocks darker than this times the fit are drawn on.
const DRAWN: f64 = 0.93;

/// Paper that is darker than this in a channel is compared as if it had this much: what has no light at all tells nothing.
const LEAST: f64 = 0.05;

/// Of a picture of this contrast or less, nothing is drawn: the noise of a camera.
const CONTRAST: f64 = 0.06;

/// Dark paper is what so much of the rim of a picture shows, and so much of all of it.
const AROUND: (f64, f64) = (0.8, 0.5);

/// How much of each pixel is drawn on, from its red, green and blue (0 to 1), row by row from the top.
///
/// What is darker or more colourful than the paper counts, against the paper's own colour where it lies: 0 is
/// the typical paper, 1 the typical ink, where the two groups are those of `otsu`; a blank sheet is 0
/// throughout. If that is nearly all of the rim of the picture and most of the picture, the paper is dark, and what is brighter
/// counts. O(pixels).
///
/// # Errors
/// [`Error::PictureSize`](crate::error::Error::PictureSize) and
/// [`Error::PixelNotFinite`](crate::error::Error::PixelNotFinite).
pub fn coverage(width: usize, height: usize, colours: &[[f32; 3]]) -> Result<Picture> {
    Picture::check_size(width, height)?;
    let drawn = darker(width, height, |k, c| colours[k][c])?;
    if !is_around(&drawn) {
        return Ok(drawn);
    }
    let brighter = darker(width, height, |k, c| 1.0 - colours[k][c])?;
    let is_told = brighter.values().iter().any(|&value| value > 0.0) && !is_around(&brighter);
    Ok(if is_told { brighter } else { drawn })
}

/// How much darker than the paper each pixel is in the channel in which it is most, from 0, as typical paper, to 1, as typical ink.
fn darker(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> Result<Picture> {
    let mut drawn = vec![0.0_f32; width * height];
    for c in 0..3 {
        let channel = Picture::new(width, height, (0..width * height).map(|k| value(k, c)).collect())?;
        let light = Light::fit(&channel);
        for (k, (drawn, &value)) in drawn.iter_mut().zip(channel.values()).enumerate() {
            let paper = light.at((k % width) as f64, (k / width) as f64);
            let (least, short) = (paper.max(LEAST), (LEAST - paper).max(0.0) / LEAST);
            *drawn = drawn.max((1.0 - f64::from(value) / least - short).clamp(0.0, 1.0) as f32);
        }
    }
    stretch(Picture::new(width, height, drawn)?)
}

/// Whether what is drawn lies all around the rest.
fn is_around(drawn: &Picture) -> bool {
    let (width, height) = (drawn.width(), drawn.height());
    let (mut rim, mut rims, mut all) = (0_usize, 0_usize, 0_usize);
    for (k, &value) in drawn.values().iter().enumerate() {
        let (x, y) = (k % width, k / width);
        let is_rim = x == 0 || y == 0 || x + 1 == width || y + 1 == height;
        let is_drawn = value >= 0.5;
        rim += usize::from(is_rim && is_drawn);
        rims += usize::from(is_rim);
        all += usize::from(is_drawn);
    }
    rim as f64 >= AROUND.0 * rims as f64 && all as f64 >= AROUND.1 * (width * height) as f64
}

/// Stretches values so that the means of the two groups become 0 and 1.
fn stretch(picture: Picture) -> Result<Picture> {
    let threshold = otsu(&picture);
    let (mut low, mut high) = ((0.0, 0_usize), (0.0, 0_usize));
    for &value in picture.values() {
        let group = if f64::from(value) < threshold { &mut low } else { &mut high };
        group.0 += f64::from(value);
        group.1 += 1;
    }
    let paper = low.0 / low.1.max(1) as f64;
    let ink = high.0 / high.1.max(1) as f64;
    let (width, height) = (picture.width(), picture.height());
    if high.1 == 0 || low.1 == 0 || ink - paper < CONTRAST {
        return Picture::new(width, height, vec![0.0; width * height]);
    }
    let scaled = picture.values().iter().map(|&value| ((f64::from(value) - paper) / (ink - paper)) as f32);
    Picture::new(width, height, scaled.collect())
}

/// The brightness of the paper.
struct Light {
    coefficients: [f64; 6],
    size: [f64; 2],
}

impl Light {
    fn fit(channel: &Picture) -> Self {
        let (width, height) = (channel.width(), channel.height());
        let size = [width as f64, height as f64];
        let block = width.max(height).div_ceil(BLOCKS);
        let mut blocks: Vec<([f64; 2], f64)> = Vec::new();
        for top in (0..height).step_by(block) {
            for left in (0..width).step_by(block) {
                let (right, bottom) = ((left + block).min(width), (top + block).min(height));
                let mut values: Vec<f32> = (top..bottom)
                    .flat_map(|y| channel.values()[y * width + left..y * width + right].iter().copied())
                    .collect();
                // The upper quarter of the pixels: their least is above the noise of ink, below that of paper.
                let place = values.len() * 3 / 4;
                let (_, &mut bright, _) = values.select_nth_unstable_by(place, f32::total_cmp);
                let middle = [0.5 * (left + right) as f64 / size[0], 0.5 * (top + bottom) as f64 / size[1]];
                blocks.push((middle, f64::from(bright)));
            }
        }
        let brightest = blocks.iter().map(|block| block.1).fold(0.0, f64::max);
        let mut light = Self { coefficients: [brightest, 0.0, 0.0, 0.0, 0.0, 0.0], size };
        // From flat to curved, so that a large drawing is not taken for the paper's shade.
        for round in 0..ROUNDS {
            let dark = if round < 2 { 0.6 } else { DRAWN };
            let paper: Vec<_> =
                blocks.iter().filter(|(at, value)| *value >= dark * light.value(*at)).copied().collect();
            let terms = if paper.len() >= 24 && round >= 2 {
                6
            } else if paper.len() >= 6 {
                3
            } else {
                1
            };
            light.coefficients = least_squares(&paper, terms).unwrap_or(light.coefficients);
        }
        light
    }

    fn value(&self, at: [f64; 2]) -> f64 {
        powers(at).iter().zip(self.coefficients).map(|(power, coefficient)| power * coefficient).sum()
    }

    /// At a pixel, counted from the upper left corner.
    fn at(&self, x: f64, y: f64) -> f64 {
        self.value([(x + 0.5) / self.size[0], (y + 0.5) / self.size[1]])
    }
}

fn powers([x, y]: [f64; 2]) -> [f64; 6] {
    [1.0, x, y, x * x, x * y, y * y]
}

/// The polynomial of this many terms that fits best; `None` if there are too few blocks, or none fits.
fn least_squares(blocks: &[([f64; 2], f64)], terms: usize) -> Option<[f64; 6]> {
    if blocks.len() < terms {
        return None;
    }
    // The normal equations, of which the upper triangle is stored column by column.
    let column = |j: usize| j * (j + 1) / 2;
    let mut normal = vec![0.0; column(terms)];
    let mut coefficients = [0.0; 6];
    for &(at, value) in blocks {
        let powers = powers(at);
        for j in 0..terms {
            coefficients[j] += powers[j] * value;
            for i in 0..=j {
                normal[column(j) + i] += powers[i] * powers[j];
            }
        }
    }
    for j in 0..terms {
        normal[column(j) + j] += 1e-9;
    }
    let starts = (0..=terms).map(column).collect();
    let rows = (0..terms).flat_map(|j| 0..=j).collect();
    let pattern = Pattern::new("paper", starts, rows, Progress::NONE).ok()?;
    pattern.factor(normal, Progress::NONE).ok()?.solve(&mut coefficients[..terms], 1).ok()?;
    Some(coefficients)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheet lit from a corner, slightly yellow, with a disk of ink in a colour.
    fn sheet(ink: [f64; 3], radius: f64) -> Vec<[f32; 3]> {
        let pixel = |k: usize| {
            let (x, y) = ((k % 300) as f64, (k / 300) as f64);
            let light = 0.95 - 0.5 * (x / 300.0) * (y / 200.0) - 0.1 * x / 300.0;
            let paper = [1.0, 0.97, 0.9];
            let drawn = (x - 150.0).hypot(y - 100.0) < radius;
            [0, 1, 2].map(|c| (light * paper[c] * if drawn { ink[c] } else { 1.0 }) as f32)
        };
        (0..300 * 200).map(pixel).collect()
    }

    #[test]
    fn ink_is_told_from_shade() {
        for (ink, radius) in [([0.15, 0.15, 0.2], 60.0), ([0.95, 0.9, 0.2], 80.0), ([0.2, 0.6, 0.9], 20.0)] {
            let covered = coverage(300, 200, &sheet(ink, radius)).unwrap();
            for (k, &value) in covered.values().iter().enumerate() {
                let inside = ((k % 300) as f64 - 150.0).hypot((k / 300) as f64 - 100.0) < radius;
                assert_eq!(value >= 0.5, inside, "{ink:?} {k} {value}");
            }
        }
    }

    #[test]
    fn on_a_board_chalk_is_what_is_drawn() {
        let board = |k: usize, inside: f32| -> [f32; 3] {
            let (x, y) = ((k % 300) as f32, (k / 300) as f32);
            let light = 0.3 - 0.1 * x / 300.0;
            let drawn = (x - 150.0).hypot(y - 100.0) < 50.0;
            [0.6, 1.0, 0.7].map(|green| if drawn { inside } else { light * green })
        };
        let covered = coverage(300, 200, &(0..60_000).map(|k| board(k, 0.9)).collect::<Vec<_>>()).unwrap();
        for (k, &value) in covered.values().iter().enumerate() {
            let inside = ((k % 300) as f64 - 150.0).hypot((k / 300) as f64 - 100.0) < 50.0;
            assert_eq!(value >= 0.5, inside, "{k} {value}");
        }
        // A large drawing does not make its paper one.
        let dark: Vec<[f32; 3]> = sheet([0.2; 3], 95.0);
        let covered = coverage(300, 200, &dark).unwrap();
        assert!(covered.values()[100 * 300 + 150] >= 0.5 && covered.values()[0] < 0.5);
    }

    #[test]
    fn pure_colors_are_seen_on_black() {
        let inside = |k: usize| ((k % 300) as f64 - 150.0).hypot((k / 300) as f64 - 100.0) < 50.0;
        for color in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [0.8, 0.1, 0.1]] {
            let pixels: Vec<_> = (0..60_000).map(|k| if inside(k) { color } else { [0.0; 3] }).collect();
            let covered = coverage(300, 200, &pixels).unwrap();
            assert!(covered.values().iter().enumerate().all(|(k, &v)| (v >= 0.5) == inside(k)), "{color:?}");
        }
    }

    #[test]
    fn a_blank_sheet_has_nothing_on_it() {
        let covered = coverage(300, 200, &sheet([1.0; 3], 0.0)).unwrap();
        assert!(covered.values().iter().all(|&value| value == 0.0));
    }
}
