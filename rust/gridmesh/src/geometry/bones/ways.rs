//! Which bones lie between two that do not touch.

use glam::DVec2;

/// Bones touch where ends of theirs are nearer than this share of the shorter one's length.
const TOUCHING: f64 = 0.01;

/// A place where bones meet, one of which turns.
#[derive(Debug, PartialEq)]
pub(super) struct Joint {
    pub at: DVec2,
    /// The bones that move with it, each of which hangs on it.
    pub moved: Vec<usize>,
    /// Those that stay where they are. Bones that hang on none of both may do either.
    pub kept: Vec<usize>,
}

/// Ways from bone to bone over joints.
pub(super) struct Ways {
    pub count: usize,
    /// The bone before the second one on the shortest way from the first; itself where there is no way.
    before: Vec<usize>,
    pub joints: Vec<Joint>,
}

impl Ways {
    pub fn new(bones: &[[DVec2; 2]]) -> Self {
        let count = bones.len();
        let at_end = |i: usize, end: DVec2, j: usize| {
            let shorter = bones[i][0].distance(bones[i][1]).min(bones[j][0].distance(bones[j][1]));
            i != j && bones[j].iter().any(|other| end.distance(*other) <= TOUCHING * shorter)
        };
        let touch = |i: usize, j: usize| bones[i].iter().any(|&end| at_end(i, end, j));
        let touching: Vec<Vec<usize>> =
            (0..count).map(|i| (0..count).filter(|&j| touch(i, j)).collect()).collect();
        let mut before: Vec<usize> = (0..count * count).map(|at| at % count).collect();
        for i in 0..count {
            let mut reached = vec![i];
            let mut k = 0;
            while let Some(&from) = reached.get(k) {
                for &to in &touching[from] {
                    if to != i && before[i * count + to] == to {
                        before[i * count + to] = from;
                        reached.push(to);
                    }
                }
                k += 1;
            }
        }
        let mut joints = Vec::new();
        for (i, ends) in bones.iter().enumerate() {
            for &at in ends {
                let there: Vec<usize> = (0..count).filter(|&j| at_end(i, at, j)).collect();
                let (moves, hangs) = (hanging(i, &there, &touching), hanging(i, &[], &touching));
                // Of two that meet, one turns; where bones go around in a ring none turns alone.
                let is_other_half = there.len() == 1 && there[0] < i;
                if !there.is_empty() && !is_other_half && !there.iter().any(|&j| moves[j]) {
                    let moved = (0..count).filter(|&j| moves[j]).collect();
                    let kept = (0..count).filter(|&j| hangs[j] && !moves[j]).collect();
                    joints.push(Joint { at, moved, kept });
                }
            }
        }
        Self { count, before, joints }
    }

    /// The bones between two that do not touch; none where there is no way.
    fn between(&self, i: usize, j: usize) -> Vec<usize> {
        let mut between = Vec::new();
        let mut at = self.before[i * self.count + j];
        while at != i && at != j && between.len() < self.count {
            between.push(at);
            at = self.before[i * self.count + at];
        }
        between
    }

    /// What two bones that do not touch share at a vertex, twice the product of their weights, goes to those between them in
    /// equal parts. The turns of a chain add up, and a mean of such turns alone would shrink what it moves.
    pub fn passed_on(&self, weights: &mut [f64], strongest: &[usize]) {
        let given: Vec<f64> = strongest.iter().map(|&k| weights[k]).collect();
        for (a, &i) in strongest.iter().enumerate() {
            for (b, &j) in strongest.iter().enumerate().skip(a + 1) {
                let between = self.between(i.min(j), i.max(j));
                let shared = given[a] * given[b];
                if between.is_empty() || shared == 0.0 {
                    continue;
                }
                weights[i] -= shared;
                weights[j] -= shared;
                let part = 2.0 * shared / between.len() as f64;
                between.into_iter().for_each(|k| weights[k] += part);
            }
        }
    }
}

/// The bone `i` and what hangs on it, without those at one of its ends.
fn hanging(i: usize, there: &[usize], touching: &[Vec<usize>]) -> Vec<bool> {
    let mut moved = vec![false; touching.len()];
    moved[i] = true;
    let mut reached = vec![i];
    while let Some(from) = reached.pop() {
        for &to in touching[from].iter().filter(|to| from != i || !there.contains(to)) {
            if !std::mem::replace(&mut moved[to], true) {
                reached.push(to);
            }
        }
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_moves_what_hangs_on_one_of_its_bones() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let chain =
            [[at(0.0, 0.0), at(1.0, 0.0)], [at(1.0, 0.0), at(2.0, 0.0)], [at(3.0, 0.0), at(2.0, 0.0)]];
        let alone = [[at(1.0, 0.1), at(2.0, 0.9)]];
        let ways = Ways::new(&[chain.as_slice(), &alone].concat());
        let joint = |x, moved: &[usize], kept: &[usize]| Joint {
            at: at(x, 0.0),
            moved: moved.to_vec(),
            kept: kept.to_vec(),
        };
        assert_eq!(ways.joints, [joint(1.0, &[0], &[1, 2]), joint(2.0, &[0, 1], &[2])]);
        // Three meet: each turns by itself. Three in a ring: none.
        let star =
            [[at(0.0, 0.0), at(1.0, 0.0)], [at(0.0, 0.0), at(0.0, 1.0)], [at(-1.0, 0.0), at(0.0, 0.0)]];
        assert_eq!(Ways::new(&star).joints.len(), 3);
        let ring = [[at(0.0, 0.0), at(1.0, 0.0)], [at(1.0, 0.0), at(0.0, 1.0)], [at(0.0, 1.0), at(0.0, 0.0)]];
        assert_eq!(Ways::new(&ring).joints, []);
    }

    #[test]
    fn what_the_ends_of_a_chain_share_goes_to_those_between() {
        let at = |x: f64| DVec2::new(x, 0.0);
        // A chain of four, one of them the wrong way round, and one that stands alone.
        let bones = [
            [at(0.0), at(1.0)],
            [at(2.0), at(1.0)],
            [at(2.0), at(3.0)],
            [at(3.0), at(4.0)],
            [at(9.0), at(10.0)],
        ];
        let ways = Ways::new(&bones);
        assert_eq!(ways.between(0, 1), []);
        assert_eq!(ways.between(0, 4), []);
        assert_eq!(ways.between(0, 2), [1]);
        assert_eq!(ways.between(0, 3), [2, 1]);
        let passed = |mut weights: [f64; 5]| {
            ways.passed_on(&mut weights, &[0, 1, 2, 3, 4]);
            weights
        };
        assert_eq!(passed([0.5, 0.5, 0.0, 0.0, 0.0]), [0.5, 0.5, 0.0, 0.0, 0.0]);
        assert_eq!(passed([0.5, 0.0, 0.5, 0.0, 0.0]), [0.25, 0.5, 0.25, 0.0, 0.0]);
        assert_eq!(passed([0.5, 0.0, 0.0, 0.5, 0.0]), [0.25, 0.25, 0.25, 0.25, 0.0]);
        assert_eq!(passed([0.5, 0.0, 0.0, 0.0, 0.5]), [0.5, 0.0, 0.0, 0.0, 0.5]);
        assert_eq!(passed([1.0, 0.0, 0.0, 0.0, 0.0]), [1.0, 0.0, 0.0, 0.0, 0.0]);
    }
}
