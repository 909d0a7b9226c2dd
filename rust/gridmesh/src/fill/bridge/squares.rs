//! A tube of quads: rings of squares from one loop to the other.
//!
//! Where a ring has as many vertices as the one below, each of them lies above one. A *wedge* adds two: its vertex has two
//! above it, and between them the far corner of one more square, from which the wedge goes on in the next row. Where it
//! begins there are five neighbours, where it ends three, on the way four, as on a cone of right angles: so it costs
//! two poles, however many rows it goes through. One vertex more, where the loops' sum is odd, is that of a triangle; at
//! the end of a wedge it takes that pole away.

use super::tube::Tube;

/// Of the vertices of a ring this share may have a wedge, if that is enough.
const ROOMY: f64 = 0.5;

/// So many rows more are tried for loops of which one has many times the vertices of the other.
const MORE_ROWS: usize = 12;

/// Two vertices more in each row from `start` to before `end`, and with `half` one more in row `end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Wedge {
    start: usize,
    end: usize,
    half: bool,
}

impl Wedge {
    fn gain(self) -> usize {
        2 * (self.end - self.start) + usize::from(self.half)
    }
}

/// Which wedges there are; by the order in which they are to be spread evenly.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    length: usize,
    rows: usize,
    wedges: Vec<Wedge>,
}

impl Plan {
    /// The fewest wedges from a loop of `length` vertices to one of `more` more. `exact`: in as many rows and no more.
    pub fn new(length: usize, more: usize, rows: usize, exact: bool) -> Plan {
        let tries = if exact { 0 } else { MORE_ROWS };
        let roomy = (rows..=rows + tries).find_map(|rows| Plan::within(length, more, rows, ROOMY));
        let full = || (rows..=rows + tries).find_map(|rows| Plan::within(length, more, rows, 1.0));
        roomy.or_else(full).or_else(|| Plan::within(length, more, rows, f64::INFINITY)).unwrap_or(Plan {
            length,
            rows,
            wedges: vec![],
        })
    }

    /// `share`: of the vertices of a ring, how many may have a wedge.
    fn within(length: usize, more: usize, rows: usize, share: f64) -> Option<Plan> {
        let odd = more % 2 == 1;
        // Poles lie a row from the loops, unless fewer are needed without that.
        let spans = [(1, rows.saturating_sub(1)), (0, rows.saturating_sub(1)), (1, rows), (0, rows)];
        let mut best: Option<(usize, Plan)> = None;
        for (first, last) in spans {
            let Some(counts) = counts(length, more / 2, [first, last], share) else { continue };
            let wedges = wedges(&counts, first, last, rows, odd);
            let poles = |w: &Wedge| usize::from(w.end > w.start) + usize::from(!w.half || w.end == w.start);
            let poles = wedges.iter().map(poles).sum::<usize>();
            if best.as_ref().is_none_or(|best| poles < best.0) {
                best = Some((poles, Plan { length, rows, wedges }));
            }
        }
        best.map(|best| best.1)
    }

    /// What each wedge adds.
    fn gains(&self) -> impl Iterator<Item = f64> {
        self.wedges.iter().map(|wedge| wedge.gain() as f64)
    }
}

/// How many wedges go through each row from `first` to before `last`, as few as possible, such that all rows add
/// `pairs`: more from row to row as far as there is room, and then as many up to the last rows.
fn counts(length: usize, pairs: usize, [first, last]: [usize; 2], share: f64) -> Option<Vec<usize>> {
    if pairs == 0 {
        return Some(vec![0; last.saturating_sub(first)]);
    }
    let rows = last.checked_sub(first).filter(|&rows| rows > 0)?;
    let with = |most: usize| {
        let (mut length, mut sum) = (length, 0);
        let mut counts = Vec::with_capacity(rows);
        for _ in 0..rows {
            let room = (share * length as f64).floor().min(1e9) as usize;
            let count = most.min(room.max(1)).min(pairs);
            counts.push(count);
            sum += count;
            length += 2 * count;
        }
        (sum >= pairs).then_some((counts, sum))
    };
    let (mut low, mut high) = (pairs.div_ceil(rows), pairs);
    let mut found = with(high)?;
    while low < high {
        let middle = (low + high) / 2;
        match with(middle) {
            Some(fewer) => (found, high) = (fewer, middle),
            None => low = middle + 1,
        }
    }
    let (mut counts, sum) = found;
    // What is too much is left out at the first and the last of the fullest rows.
    let most = counts.iter().copied().max().unwrap_or(0);
    let start = counts.iter().position(|&count| count == most).unwrap_or(0);
    let spare = sum - pairs;
    let below = if start == 0 || counts[start - 1] < most { spare / 2 } else { 0 };
    counts[start..start + below].iter_mut().for_each(|count| *count -= 1);
    let end = counts.len();
    counts[end - (spare - below)..].iter_mut().for_each(|count| *count -= 1);
    Some(counts)
}

/// The wedges that go through the rows in these numbers, which rise and then fall by one at most.
fn wedges(counts: &[usize], first: usize, last: usize, rows: usize, odd: bool) -> Vec<Wedge> {
    let mut done = vec![];
    let mut open: std::collections::VecDeque<Wedge> = std::collections::VecDeque::new();
    for (k, &count) in counts.iter().chain(&[0]).enumerate() {
        let row = first + k;
        while open.len() > count {
            done.extend(open.pop_front().map(|wedge| Wedge { end: row, ..wedge }));
        }
        while open.len() < count {
            open.push_back(Wedge { start: row, end: last, half: false });
        }
    }
    if odd {
        // At the end of the wedge that ends nearest to the middle, or alone.
        let middle = (rows - 1) / 2;
        let ends = |w: &&mut Wedge| w.end < rows;
        match done.iter_mut().filter(ends).min_by_key(|w| w.end.abs_diff(middle)) {
            Some(wedge) => wedge.half = true,
            None => done.push(Wedge { start: middle, end: middle, half: true }),
        }
    }
    done.sort_by_key(|wedge| (wedge.start, wedge.end));
    done
}

/// A wedge where it is: its vertex in the present ring.
#[derive(Clone, Copy)]
struct Ray {
    wedge: usize,
    at: usize,
    /// Where around the axis it began.
    around: f64,
}

/// The tube of a plan. Vertex k of the lower loop is at `k / length` around; `places`: where those of the upper loop are,
/// ascending over less than one round; `level(gain)`, asked with more and more: the first place around by which the upper loop has gained so many
/// vertices on the lower one.
pub(super) fn squares(plan: &Plan, places: &[f64], level: impl FnMut(f64) -> f64) -> Tube {
    let (m, n, rows) = (plan.length, places.len(), plan.rows);
    let wishes = wishes(plan, level);
    let mut tube = Tube { rows: rows as f64, least: rows as f64, most: rows as f64, ..Tube::default() };
    let mut ring = (0..m as u32).collect::<Vec<_>>();
    let mut around = (0..m).map(|k| k as f64 / m as f64).collect::<Vec<_>>();
    let mut rays: Vec<Ray> = vec![];
    for row in 0..rows {
        let new = (0..plan.wedges.len()).filter(|&k| plan.wedges[k].start == row);
        begin(&mut rays, new, &around, &wishes);
        let first = m + n + tube.around.len();
        let above = raised(plan, row, &ring, &mut rays, first as u32, &mut tube);
        around = spread(&around, &rays, above);
        let top = row + 1 == rows;
        ring = (0..above as u32).map(|k| if top { m as u32 + k } else { first as u32 + k }).collect();
        if !top {
            tube.around.extend_from_slice(&around);
            tube.height.extend(std::iter::repeat_n((row + 1) as f64 / rows as f64, above));
        }
    }
    turned(&mut tube, m, &around, places);
    tube
}

/// Where around the axis each wedge should be: such that the two loops gain on each other alike all around.
fn wishes(plan: &Plan, mut level: impl FnMut(f64) -> f64) -> Vec<f64> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    // Those that begin or end together lie apart from each other.
    let mut order = (0..plan.wedges.len()).collect::<Vec<_>>();
    let key = |k: usize| (k as f64 * GOLDEN).fract();
    order.sort_by(|&a, &b| key(a).total_cmp(&key(b)));
    let gains = plan.gains().collect::<Vec<_>>();
    let mut before = 0.0;
    let mut wishes = vec![0.0; gains.len()];
    for k in order {
        wishes[k] = level(before + 0.5 * gains[k]).rem_euclid(1.0);
        before += gains[k];
    }
    wishes
}

/// Puts wedges at vertices of a ring: the nearest ones that have none yet.
fn begin(rays: &mut Vec<Ray>, new: impl Iterator<Item = usize>, around: &[f64], wishes: &[f64]) {
    let n = around.len();
    let mut taken = vec![false; n];
    rays.iter().for_each(|ray| taken[ray.at] = true);
    for wedge in new {
        let round = (wishes[wedge] - around[0]).floor();
        let wish = wishes[wedge] - round;
        let next = around.partition_point(|&x| x <= wish);
        let off = |k: usize| {
            let off = around[k] - wish;
            (off - off.round()).abs()
        };
        // Beside each other vertices are nearer and nearer.
        let near = (0..n)
            .map(|step| (next + n - 1 + if step % 2 == 0 { step / 2 } else { n - step.div_ceil(2) }) % n);
        let mut free = near.filter(|&k| !taken[k]);
        let at = match (free.next(), free.next()) {
            (Some(a), Some(b)) => {
                if off(b) < off(a) {
                    b
                } else {
                    a
                }
            }
            (Some(a), None) => a,
            _ => (next + n - 1) % n,
        };
        taken[at] = true;
        rays.push(Ray { wedge, at, around: around[at] });
    }
    rays.sort_by_key(|ray| ray.at);
}

/// The faces of a row above a ring; how many vertices the next one has, which begin with number `first`, or, in the last
/// row, with that of the upper loop.
fn raised(plan: &Plan, row: usize, ring: &[u32], rays: &mut [Ray], first: u32, tube: &mut Tube) -> usize {
    let n = ring.len();
    // The first and the last vertex above each.
    let mut above = Vec::with_capacity(n);
    let mut length = 0;
    let mut next = 0;
    let mut corners = vec![];
    let mut single = None;
    for at in 0..n {
        let start = length;
        while let Some(ray) = rays.get_mut(next).filter(|ray| ray.at == at) {
            let wedge = plan.wedges[ray.wedge];
            ray.at = length;
            if (wedge.start..wedge.end).contains(&row) {
                corners.push((at, length));
                ray.at = length + 1;
                length += 2;
            } else if wedge.half && wedge.end == row {
                single = Some((at, length));
                length += 1;
            }
            next += 1;
        }
        above.push((start, length));
        length += 1;
    }
    let last = row + 1 == plan.rows;
    let up = |k: usize| (k % length) as u32 + if last { plan.length as u32 } else { first };
    for at in 0..n {
        let beside = (at + 1) % n;
        tube.quads.push([ring[at], ring[beside], up(above[beside].0), up(above[at].1)]);
    }
    tube.quads.extend(corners.into_iter().map(|(at, k)| [ring[at], up(k + 2), up(k + 1), up(k)]));
    tube.triangles.extend(single.map(|(at, k)| [ring[at], up(k + 1), up(k)]));
    length
}

/// Where the vertices of the next ring are: those of wedges where these began, the others evenly between them.
fn spread(before: &[f64], rays: &[Ray], length: usize) -> Vec<f64> {
    let Some(last) = rays.last() else { return before.to_vec() };
    let mut around = vec![0.0; length];
    let mut from = (last.at as f64 - length as f64, last.around - 1.0);
    let wrapped = Ray { at: rays[0].at + length, around: rays[0].around + 1.0, ..rays[0] };
    for ray in rays.iter().chain([&wrapped]) {
        let to = (ray.at as f64, ray.around);
        let (start, end) = (from.0.max(0.0) as usize, ray.at.min(length));
        for (x, k) in around[start..end].iter_mut().zip(start..) {
            *x = from.1 + (k as f64 - from.0) / (to.0 - from.0).max(1.0) * (to.1 - from.1);
        }
        from = to;
    }
    around
}

/// Turns the upper loop to where its vertices suit those of the last ring best, and moves the vertices between along.
fn turned(tube: &mut Tube, m: usize, last: &[f64], places: &[f64]) {
    let n = places.len();
    let place = |k: i64| places[k.rem_euclid(n as i64) as usize] + k.div_euclid(n as i64) as f64;
    let off = |shift: i64| (0..n).map(move |k| (k, place(k as i64 + shift)));
    let squares = |shift: i64| off(shift).map(|(k, place)| (place - last[k]).powi(2)).sum::<f64>();
    let mean = off(0).map(|(k, place)| last[k] - place).sum::<f64>() / n as f64;
    let likely = (mean * n as f64).round() as i64;
    let shift =
        (likely - 1..=likely + 1).min_by(|&a, &b| squares(a).total_cmp(&squares(b))).unwrap_or(likely);
    let name = |v: u32| {
        let k = i64::from(v) - m as i64;
        if (0..n as i64).contains(&k) { (m as i64 + (k + shift).rem_euclid(n as i64)) as u32 } else { v }
    };
    tube.quads.iter_mut().flatten().for_each(|v| *v = name(*v));
    tube.triangles.iter_mut().flatten().for_each(|v| *v = name(*v));
    // How much further round the upper loop is, as a function of the place on the last ring.
    let ahead = |x: f64| {
        let round = (x - last[0]).floor();
        let within = x - round;
        let k = last.partition_point(|&it| it <= within).saturating_sub(1);
        let end = last.get(k + 1).copied().unwrap_or(last[0] + 1.0);
        let share = ((within - last[k]) / (end - last[k]).max(1e-12)).clamp(0.0, 1.0);
        let (low, high) = (place(k as i64 + shift), place(k as i64 + 1 + shift));
        round + low + share * (high - low)
    };
    for (around, height) in tube.around.iter_mut().zip(&tube.height) {
        *around += height * (ahead(*around) - *around);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tube::is_tube;
    use super::*;

    fn made(m: usize, n: usize, rows: usize) -> (Plan, Tube) {
        let plan = Plan::new(m, n - m, rows, true);
        let places = (0..n).map(|k| 0.3 + k as f64 / n as f64).collect::<Vec<_>>();
        let more = (n - m).max(1) as f64;
        let tube = squares(&plan, &places, |gain| gain / more);
        (plan, tube)
    }

    #[test]
    fn tubes_of_any_counts_are_quads_with_one_triangle_for_odd_sums() {
        for m in [3, 4, 5, 8, 13, 40] {
            for n in [m, m + 1, m + 2, m + 3, m + 7, 2 * m, 3 * m, 3 * m + 1, 10 * m, 10 * m + 3] {
                for rows in [1, 2, 3, 4, 7] {
                    let (_, tube) = made(m, n, rows);
                    assert_eq!(tube.triangles.len(), (m + n) % 2, "{m} {n} {rows}");
                    assert!(is_tube(&tube, m, n), "{m} {n} {rows}");
                    assert!(tube.around.iter().all(|x| x.is_finite()), "{m} {n} {rows}");
                }
            }
        }
    }

    /// Faces at each vertex between the loops, and at each of the loops.
    fn faces(tube: &Tube, loops: usize) -> (Vec<usize>, Vec<usize>) {
        let mut faces = vec![0; loops + tube.around.len()];
        tube.quads.iter().flatten().for_each(|&v| faces[v as usize] += 1);
        tube.triangles.iter().flatten().for_each(|&v| faces[v as usize] += 1);
        let inner = faces.split_off(loops);
        (faces, inner)
    }

    #[test]
    fn equal_counts_need_no_pole_and_others_two_for_each_wedge() {
        for (m, n, rows, poles) in [
            (20, 20, 5, 0),
            (20, 22, 5, 2),
            (20, 26, 5, 2),
            (20, 44, 8, 4),
            (20, 21, 5, 1),
            (20, 27, 5, 1),
            (20, 23, 5, 1),
        ] {
            let (_, tube) = made(m, n, rows);
            let (loops, inner) = faces(&tube, m + n);
            assert!(loops.iter().all(|&at| at == 2), "{n}: poles lie a row from the loops");
            assert_eq!(inner.iter().filter(|&&at| at != 4).count(), poles, "{n}");
            assert!(inner.iter().all(|at| (3..=5).contains(at)));
        }
        // One row has no vertex inside: each wedge goes from loop to loop.
        let (_, tube) = made(8, 16, 1);
        let (loops, _) = faces(&tube, 24);
        assert_eq!(loops.iter().filter(|&&at| at == 3).count(), 4);
        assert_eq!(loops.iter().filter(|&&at| at == 1).count(), 4);
    }

    #[test]
    fn a_small_loop_widens_over_several_rows() {
        let plan = Plan::new(5, 195, 6, false);
        assert_eq!(plan.gains().sum::<f64>(), 195.0);
        let places = (0..200).map(|k| f64::from(k) / 200.0).collect::<Vec<_>>();
        let tube = squares(&plan, &places, |gain| gain / 195.0);
        assert!(is_tube(&tube, 5, 200));
        let (loops, inner) = faces(&tube, 205);
        assert!(loops.iter().chain(&inner).all(|at| (1..=5).contains(at)), "no vertex of high valence");
    }
}
