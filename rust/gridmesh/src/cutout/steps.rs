//! The numbers of cells that parts of pictures are meshed with.

/// The steps of a decade: the same whatever is asked for, so that fewer asked for never give more.
const STEPS: [f64; 24] = [
    1.0, 1.1, 1.2, 1.35, 1.5, 1.65, 1.8, 2.0, 2.25, 2.5, 2.75, 3.0, 3.3, 3.6, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5,
    7.0, 7.5, 8.0, 9.0,
];

/// Times the number asked for up to which every step is tried; beyond it every fourth.
const EVERY: f64 = 16.0;

/// No more cells than these are tried beyond [`EVERY`] times the number asked for.
const MOST_CELLS: f64 = 100_000.0;

/// One of the numbers of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Step(u32);

impl Step {
    /// The one nearest to a number of at least one.
    pub(super) fn nearest(number: f64) -> Self {
        let away = |step: &Self| libm::log(step.number() / number).abs();
        let (mut decade, mut power) = (0, 10.0);
        while power <= number {
            (decade, power) = (decade + 1, 10.0 * power);
        }
        let count = STEPS.len() as u32;
        let near = (count * decade..=count * (decade + 1)).map(Self);
        near.min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(Self(0))
    }

    /// Its number of cells.
    pub(super) fn number(self) -> f64 {
        let (decade, k) = (self.0 / STEPS.len() as u32, self.0 % STEPS.len() as u32);
        (0..decade).fold(STEPS[k as usize], |number, _| 10.0 * number)
    }

    /// The next one.
    pub(super) fn next(self) -> Self {
        Self(self.0 + 1)
    }

    /// Those from this one on that are tried where `number` cells are asked for, up to `most` times as many.
    pub(super) fn tried(self, number: f64, most: f64) -> impl Iterator<Item = Self> {
        let last = Self::last(number, most);
        (self.0..=last.0)
            .map(Self)
            .filter(move |step| step.0 % 4 == 0 || step.number() <= EVERY * number || *step == last)
    }

    fn last(number: f64, most: f64) -> Self {
        Self::nearest((EVERY.min(most) * number).max((most * number).min(MOST_CELLS)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_near_every_number() {
        for number in (6..20_000).step_by(7) {
            let step = Step::nearest(f64::from(number));
            let ratio = step.number() / f64::from(number);
            assert!((ratio - 1.0).abs() < 0.065, "{number}");
            assert!(step < step.next() && step.number() < step.next().number());
        }
        for number in [1.0, 10.0, 100.0, 300.0, 500.0, 1000.0, 2500.0, 1e6] {
            assert_eq!(Step::nearest(number).number(), number);
        }
    }

    #[test]
    fn steps_go_as_far_for_few_cells_as_for_many() {
        for number in [400.0, 500.0, 1000.0, 2000.0, 3000.0] {
            assert_eq!(Step::last(number, 250.0).number(), MOST_CELLS);
            assert_eq!(Step::last(number, 1.0), Step::nearest(number));
        }
        assert_eq!(Step::last(1e6, 250.0).number(), 1.65e7);
    }

    #[test]
    fn the_steps_tried_rise_to_the_last() {
        for number in [6.0, 130.0, 2000.0] {
            let first = Step::nearest(number);
            let tried: Vec<Step> = first.tried(number, 250.0).collect();
            assert_eq!(tried.first(), Some(&first));
            assert_eq!(tried.last(), Some(&Step::last(number, 250.0)));
            assert!(tried.is_sorted());
            assert_eq!(first.tried(number, 1.0).collect::<Vec<_>>(), [first]);
        }
    }
}
