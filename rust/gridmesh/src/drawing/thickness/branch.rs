//! Branches of a drawing's axis, and the limbs that they are.

use glam::DVec2;

/// A branch is left out if it is shorter than this times its width at the root.
const SALIENT: f64 = 0.9;

/// The tip of a limb, this part of its length, does not count: it may be as sharp as it likes.
const TIP: f64 = 0.5;

/// A limb is at least this many times as long as it is wide.
const LONG: f64 = 1.25;

/// Widths are means over a stretch of at least this part of the shortest limb.
const STRETCH: f64 = 0.5;

/// A limb ends where it is this many times as wide.
const WIDENED: f64 = 4.0;

/// The axis is measured with steps of at least this part of the shortest limb: it trembles with the line.
const STEP: f64 = 0.125;

/// A part of a drawing that is longer than it is wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// The middle of its thinnest place.
    pub at: DVec2,
    /// Its width there, the mean over a stretch as long as it is wide.
    pub width: f64,
    /// How long it is.
    pub length: f64,
}

/// A place on a branch.
#[derive(Clone, Copy, Debug)]
struct Chord {
    /// How far along the branch, from its tip or beginning.
    along: f64,
    width: f64,
    middle: DVec2,
    /// Of what lies behind it.
    area: f64,
}

/// Chords from a tip inwards, or between two places where branches meet.
#[derive(Clone, Debug)]
pub(super) struct Branch {
    chords: Vec<Chord>,
    /// The tip or the first middle.
    begin: DVec2,
    /// The farthest that a chord is from there, as the crow flies.
    reach: f64,
    /// The chord from which the next steps are measured.
    station: (f64, DVec2),
    /// Whether it begins and ends at a tip.
    tips: [bool; 2],
    /// How far from the farthest tip behind it its last chord is.
    pub(super) depth: f64,
    /// The length of the shortest limb.
    shortest: f64,
}

impl Branch {
    pub(super) fn from_tip(tip: DVec2, width: f64, middle: DVec2, area: f64, shortest: f64) -> Self {
        let along = tip.distance(middle);
        Branch {
            chords: vec![Chord { along, width, middle, area }],
            begin: tip,
            reach: along,
            station: (along, middle),
            tips: [true, false],
            depth: along,
            shortest,
        }
    }

    pub(super) fn from_fork(depth: f64, width: f64, middle: DVec2, shortest: f64) -> Self {
        Branch {
            chords: vec![Chord { along: 0.0, width, middle, area: 0.0 }],
            begin: middle,
            reach: 0.0,
            station: (0.0, middle),
            tips: [false, false],
            depth,
            shortest,
        }
    }

    fn last(&self) -> Chord {
        self.chords[self.chords.len() - 1]
    }

    /// Of what lies behind its last chord.
    pub(super) fn area(&self) -> f64 {
        self.last().area
    }

    /// Where its last chord is.
    pub(super) fn middle(&self) -> DVec2 {
        self.last().middle
    }

    /// Goes on over an area to a chord.
    pub(super) fn push(&mut self, width: f64, middle: DVec2, area: f64) {
        let last = self.last();
        let step = self.station.1.distance(middle);
        let along = last.along.max(self.station.0 + step);
        if step >= STEP * self.shortest {
            self.station = (along, middle);
        }
        self.reach = self.reach.max(self.begin.distance(middle));
        self.depth += along - last.along;
        self.chords.push(Chord { along, width, middle, area: last.area + area });
    }

    /// True for more than a corner or a bump on what lies behind its last chord, and more than a trembling pen makes.
    pub(super) fn is_salient(&self) -> bool {
        !self.tips[0] || self.reach >= self.shortest.max(SALIENT * self.last().width)
    }

    /// Which of several goes on where they meet: the last of these.
    pub(super) fn rank(&self) -> (bool, f64) {
        (self.is_salient(), self.last().along)
    }

    /// Goes on along another one that met its last chord, from there back to where that began; over an area between them.
    pub(super) fn meet(&mut self, other: &Branch, between: f64) {
        let last = self.last();
        let step = last.middle.distance(other.middle());
        let (begin, end) = (last.along + step, other.last());
        let turned = |chord: &Chord| Chord {
            along: begin + end.along - chord.along,
            area: last.area + between + end.area - chord.area,
            ..*chord
        };
        self.chords.extend(other.chords.iter().rev().map(turned));
        self.tips[1] = other.tips[0];
        if other.tips[0] {
            let (along, area) = (begin + end.along, last.area + between + end.area);
            self.chords.push(Chord { along, width: 0.0, middle: other.begin, area });
        }
    }

    /// The thinnest place that is longer than it is wide, and than the shortest limb.
    pub(super) fn limb(&self) -> Option<Limb> {
        if !self.is_salient() {
            return None;
        }
        let mut chords = self.chords.clone();
        if self.tips[0] {
            chords.insert(0, Chord { along: 0.0, width: 0.0, middle: self.begin, area: 0.0 });
        }
        let (first, last) = (chords[0].along, chords[chords.len() - 1].along);
        // Integral of the chords' widths along the branch.
        let mut sums = vec![0.0; chords.len()];
        for (k, pair) in chords.windows(2).enumerate() {
            sums[k + 1] = sums[k] + 0.5 * (pair[0].width + pair[1].width) * (pair[1].along - pair[0].along);
        }
        // That and the area, up to a place.
        let at = |along: f64| -> DVec2 {
            let k = chords.partition_point(|chord| chord.along < along).clamp(1, chords.len().max(2) - 1);
            let Some(b) = chords.get(k) else { return DVec2::ZERO };
            let a = chords[k - 1];
            let step = b.along - a.along;
            let t = if step > 0.0 { ((along - a.along) / step).clamp(0.0, 1.0) } else { 0.0 };
            DVec2::new(sums[k - 1], a.area).lerp(DVec2::new(sums[k], b.area), t)
        };
        // The mean width over a stretch as long as it is wide. Chords between notches are too short, and where the axis
        // turns into a wide part it runs along chords, over hardly any area: the larger of both.
        let stretch = |chord: &Chord| {
            let half = 0.5 * chord.width.max(STRETCH * self.shortest);
            (chord.along - half, chord.along + half)
        };
        let mean = |chord: &Chord| {
            let (low, high) = stretch(chord);
            let (low, high) = (low.max(first), high.min(last));
            if high > low { (at(high) - at(low)).max_element() / (high - low) } else { chord.width }
        };
        let places: Vec<(f64, f64)> = chords.iter().map(|chord| (chord.along, mean(chord))).collect();
        let ends = widened(&places, last);
        let turned: Vec<(f64, f64)> =
            places.iter().rev().map(|&(along, width)| (last - along, width)).collect();
        let begins = widened(&turned, last - first);
        let mut best: Option<Limb> = None;
        for (k, chord) in chords.iter().enumerate() {
            let (begin, end, width) = (last - begins[chords.len() - 1 - k], ends[k], places[k].1);
            let length = end - begin;
            let tips = [self.tips[0] && begin <= first, self.tips[1] && end >= last];
            // Of what lies between two tips each half is a limb.
            let halves = if tips == [true; 2] { 2.0 } else { 1.0 };
            let tip = TIP * length / halves;
            if tips[0] && chord.along - begin < tip || tips[1] && end - chord.along < tip {
                continue;
            }
            let (low, high) = stretch(chord);
            if low < first || high > last || length < self.shortest.max(halves * LONG * width) {
                continue;
            }
            if best.is_none_or(|best| width < best.width) {
                best = Some(Limb { at: chord.middle, width, length });
            }
        }
        best
    }
}

/// For each place, with how far along it is and its width, how far along it has become [`WIDENED`] times as wide, or ends.
fn widened(places: &[(f64, f64)], last: f64) -> Vec<f64> {
    let mut ends = vec![last; places.len()];
    // Places that still wait for a wider one, widest first: each new one serves the thinnest of them.
    let mut waiting: Vec<usize> = Vec::new();
    for (k, &(along, width)) in places.iter().enumerate() {
        while let Some(&j) = waiting.last()
            && width > WIDENED * places[j].1
        {
            ends[j] = along;
            waiting.pop();
        }
        // What is wider than this place and before it ends no later than this one widens enough.
        let place = waiting.partition_point(|&j| places[j].1 > width);
        waiting.insert(place, k);
    }
    ends
}
