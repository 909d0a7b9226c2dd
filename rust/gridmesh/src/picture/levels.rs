//! Marching squares: closed chains of the places where the level crosses from a pixel to its neighbour.

use glam::DVec2;

use crate::error::Result;
use crate::picture::field::Picture;
use crate::progress::Progress;

/// A crossing keeps this distance from both pixel centres, so that no two of them coincide.
const APART: f64 = 0.02;

/// Right, up, left, down.
const STEPS: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// Where the level crosses between a pixel inside and its neighbour outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crossing {
    /// Column of the pixel inside, from the left.
    pub x: i32,
    /// Its row, from below.
    pub y: i32,
    /// Where the neighbour outside is: to the right, above, to the left, below.
    pub side: u8,
}

impl Crossing {
    /// The step from the pixel inside to the one outside.
    pub fn step(self) -> (i32, i32) {
        STEPS[usize::from(self.side)]
    }

    /// The centre of the pixel inside.
    pub fn centre(self) -> DVec2 {
        DVec2::new(f64::from(self.x) + 0.5, f64::from(self.y) + 0.5)
    }

    /// The point at this distance from the centre of the pixel inside, towards the one outside.
    pub fn point(self, distance: f64) -> DVec2 {
        let (dx, dy) = self.step();
        self.centre() + distance * DVec2::new(f64::from(dx), f64::from(dy))
    }
}

/// The picture as inside and outside.
struct Level<'a> {
    picture: &'a Picture,
    threshold: f64,
}

impl Level<'_> {
    fn inside(&self, (x, y): (i32, i32)) -> bool {
        self.picture.at(x, y) >= self.threshold
    }

    /// The next crossing of a chain that has the inside on its left.
    fn next(&self, crossing: Crossing) -> Crossing {
        let Crossing { x, y, side } = crossing;
        let (ahead, back) = ((side + 1) % 4, (side + 3) % 4);
        let (step, forward) = (crossing.step(), STEPS[usize::from(ahead)]);
        let outside = (x + step.0, y + step.1);
        let left = (x + forward.0, y + forward.1);
        let right = (outside.0 + forward.0, outside.1 + forward.1);
        let around = Crossing { x, y, side: ahead };
        let across = Crossing { x: right.0, y: right.1, side: back };
        match (self.inside(left), self.inside(right)) {
            (true, true) => across,
            (true, false) => Crossing { x: left.0, y: left.1, side },
            (false, false) => around,
            // Two diagonal pixels inside: joined if the mean of the four is.
            (false, true) => {
                let sum =
                    [(x, y), outside, left, right].iter().map(|&(x, y)| self.picture.at(x, y)).sum::<f64>();
                if sum >= 4.0 * self.threshold { across } else { around }
            }
        }
    }
}

/// All chains of crossings of a level, each with the inside on its left, in the order of their lowest
/// leftmost pixels.
pub fn contours(picture: &Picture, threshold: f64, progress: Progress<'_>) -> Result<Vec<Vec<Crossing>>> {
    let level = Level { picture, threshold };
    let (width, height) = (picture.width(), picture.height());
    // Every chain has a crossing with the outside to its left: these are marked.
    let mut visited = vec![0_u64; (width * height).div_ceil(64)];
    let mut found = Vec::new();
    for y in 0..height {
        progress.report(y as f64 / height as f64)?;
        let mut before = false;
        for (x, &value) in picture.row(y).iter().enumerate() {
            let inside = f64::from(value) >= threshold;
            let at = y * width + x;
            if inside && !before && visited[at / 64] >> (at % 64) & 1 == 0 {
                let first = Crossing { x: x as i32, y: y as i32, side: 2 };
                let mut chain = Vec::new();
                let mut crossing = first;
                loop {
                    chain.push(crossing);
                    if crossing.side == 2 {
                        let at = crossing.y as usize * width + crossing.x as usize;
                        visited[at / 64] |= 1 << (at % 64);
                    }
                    if chain.len().is_multiple_of(65536) {
                        progress.report(y as f64 / height as f64)?;
                    }
                    crossing = level.next(crossing);
                    if crossing == first {
                        break;
                    }
                }
                found.push(chain);
            }
            before = inside;
        }
    }
    Ok(found)
}

/// Where the level crosses, linearly between the centres of the two pixels.
pub fn points(picture: &Picture, threshold: f64, chain: &[Crossing]) -> Vec<DVec2> {
    let place = |crossing: &Crossing| {
        let (dx, dy) = crossing.step();
        let inside = picture.at(crossing.x, crossing.y);
        let outside = picture.at(crossing.x + dx, crossing.y + dy);
        crossing.point(((inside - threshold) / (inside - outside)).clamp(APART, 1.0 - APART))
    };
    chain.iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::polygon::signed_area;

    fn chains(rows: &[&str], middle: f32) -> Vec<Vec<Crossing>> {
        let value = |c: char| {
            if c == '#' {
                1.0
            } else if c == '+' {
                middle
            } else {
                0.0
            }
        };
        let values = rows.iter().flat_map(|row| row.chars().map(value)).collect();
        contours(&Picture::new(rows[0].len(), rows.len(), values).unwrap(), 0.5, Progress::NONE).unwrap()
    }

    #[test]
    fn inside_lies_on_the_left() {
        let picture = Picture::new(3, 3, vec![1., 1., 1., 1., 0., 1., 1., 1., 1.]).unwrap();
        let chains = contours(&picture, 0.5, Progress::NONE).unwrap();
        let areas: Vec<f64> = chains.iter().map(|chain| signed_area(&points(&picture, 0.5, chain))).collect();
        // Level lines halfway between centres cut the corners of pixels.
        assert_eq!(areas, [8.5, -0.5]);
    }

    #[test]
    fn diagonal_pixels_are_joined_by_their_mean() {
        assert_eq!(chains(&["#.", ".#"], 0.0).len(), 1);
        assert_eq!(chains(&["#+.", "+.#"], 0.1).len(), 2);
        assert_eq!(chains(&["+.", ".#"], 0.6).len(), 2);
    }

    #[test]
    fn every_crossing_once() {
        let rows = ["..#..#", "##.#.#", "#.#.##", "#####."];
        let all: Vec<Crossing> = chains(&rows, 0.0).concat();
        let inside = |x: i32, y: i32| {
            let row = usize::try_from(3 - y).ok().and_then(|row| rows.get(row));
            row.is_some_and(|row| usize::try_from(x).is_ok_and(|x| row.as_bytes().get(x) == Some(&b'#')))
        };
        let mut expected = 0;
        for (x, y) in (0..6).flat_map(|x| (0..4).map(move |y| (x, y))) {
            for (dx, dy) in STEPS {
                expected += usize::from(inside(x, y) && !inside(x + dx, y + dy));
            }
        }
        assert_eq!(all.len(), expected);
        for (i, crossing) in all.iter().enumerate() {
            assert!(!all[..i].contains(crossing));
        }
    }
}
