//! Which contours bound the same island, and which islands are large enough.

use crate::error::Result;
use crate::picture::levels::Crossing;
use crate::progress::Progress;

/// A connected part of the picture: its outline, then its holes.
#[derive(Clone, Debug)]
pub struct Island {
    pub contours: Vec<Vec<Crossing>>,
}

/// Islands, largest first, and what was too small.
#[derive(Clone, Debug)]
pub struct Islands {
    pub islands: Vec<Island>,
    pub dropped_islands: usize,
    pub dropped_holes: usize,
}

/// Sorts contours into islands and leaves out islands and holes of a small area.
///
/// Each run of pixels inside, in a row, ends in two crossings, whose contours bound the same island.
pub fn sort(contours: Vec<Vec<Crossing>>, min_area: f64, progress: Progress<'_>) -> Result<Islands> {
    let areas: Vec<f64> = contours.iter().map(|contour| area(contour)).collect();
    progress.report(0.2)?;
    let owner = owners(&contours);
    progress.report(0.8)?;
    let mut outlines: Vec<usize> = (0..contours.len()).filter(|&k| areas[k] > 0.0).collect();
    outlines.sort_by(|&a, &b| areas[b].total_cmp(&areas[a]).then(a.cmp(&b)));
    let mut place = vec![usize::MAX; contours.len()];
    let (mut islands, mut dropped_islands, mut dropped_holes) = (Vec::<Island>::new(), 0, 0);
    for &outline in &outlines {
        if areas[outline] < min_area {
            dropped_islands += 1;
        } else {
            place[owner[outline]] = islands.len();
            islands.push(Island { contours: Vec::new() });
        }
    }
    let mut contours: Vec<Option<Vec<Crossing>>> = contours.into_iter().map(Some).collect();
    let holes = (0..contours.len()).filter(|&k| areas[k] <= 0.0);
    for k in outlines.iter().copied().chain(holes) {
        let Some(island) = islands.get_mut(place[owner[k]]) else { continue };
        if areas[k] <= 0.0 && -areas[k] < min_area {
            dropped_holes += 1;
        } else {
            island.contours.extend(contours[k].take());
        }
    }
    Ok(Islands { islands, dropped_islands, dropped_holes })
}

/// Area in whole pixels: positive for outlines, negative for holes.
fn area(contour: &[Crossing]) -> f64 {
    // Runs of pixels: each ends in a crossing to the right, and begins after one to the left.
    let signed = |crossing: &Crossing| match crossing.side {
        0 => i64::from(crossing.x) + 1,
        2 => -i64::from(crossing.x),
        _ => 0,
    };
    contour.iter().map(signed).sum::<i64>() as f64
}

/// For each contour the number of a contour that stands for its island.
fn owners(contours: &[Vec<Crossing>]) -> Vec<usize> {
    let mut ends: Vec<(i32, i32, u32)> = Vec::new();
    for (k, contour) in contours.iter().enumerate() {
        for crossing in contour.iter().filter(|crossing| crossing.side.is_multiple_of(2)) {
            ends.push((crossing.y, 2 * crossing.x + i32::from(crossing.side == 0), k as u32));
        }
    }
    ends.sort_unstable();
    let mut parent: Vec<usize> = (0..contours.len()).collect();
    for pair in ends.chunks_exact(2) {
        let (a, b) = (root(&mut parent, pair[0].2 as usize), root(&mut parent, pair[1].2 as usize));
        parent[a.max(b)] = a.min(b);
    }
    (0..contours.len()).map(|k| root(&mut parent, k)).collect()
}

fn root(parent: &mut [usize], mut k: usize) -> usize {
    while parent[k] != k {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    k
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{field::Picture, levels};

    fn islands(rows: &[&str], min_area: f64) -> (Vec<usize>, usize, usize) {
        let values = rows.iter().flat_map(|row| row.chars().map(|c| if c == '#' { 1.0 } else { 0.0 }));
        let picture = Picture::new(rows[0].len(), rows.len(), values.collect()).unwrap();
        let contours = levels::contours(&picture, 0.5, Progress::NONE).unwrap();
        let sorted = sort(contours, min_area, Progress::NONE).unwrap();
        let counts = sorted.islands.iter().map(|island| island.contours.len()).collect();
        (counts, sorted.dropped_islands, sorted.dropped_holes)
    }

    #[test]
    fn holes_go_to_their_islands() {
        let rows = [
            "#######..",
            "#..#..#.#",
            "#.##..#..",
            "#######..",
            ".........",
            "###.###..",
            "#.#.###..",
            "###......",
        ];
        assert_eq!(islands(&rows, 0.0), (vec![3, 2, 1, 1], 0, 0));
        assert_eq!(islands(&rows, 3.5), (vec![2, 1, 1], 1, 2));
    }

    #[test]
    fn an_island_in_a_hole_is_its_own() {
        let rows = ["#####", "#...#", "#.#.#", "#...#", "#####"];
        assert_eq!(islands(&rows, 0.0), (vec![2, 1], 0, 0));
    }
}
