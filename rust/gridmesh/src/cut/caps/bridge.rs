//! Opens regions with holes: two lines of new vertices join each hole to what surrounds it, so that only simple
//! polygons are left, which the patches of fills are for.

use glam::DVec2;
use rustc_hash::FxHashSet;

use super::regions::{Region, Spot, is_within};
use crate::geometry::segments::segments_meet;

/// Vertices made on the way, numbered after all others.
pub(in crate::cut) struct Bridges<'a> {
    /// Edges between vertices that are there already, lower one first.
    pub taken: &'a FxHashSet<(u32, u32)>,
    /// Number of the first one.
    pub first: u32,
    /// The polygons shall have an even number of edges each, as far as there are even numbers to divide.
    pub even: bool,
    /// Place and height of each.
    pub spots: Vec<DVec2>,
}

/// An outline with its holes.
type Opened = (Vec<Spot>, Vec<Vec<Spot>>);

/// A line from one loop to another: its length, and its places in both.
type Link = (f64, usize, usize);

/// A line of vertices from one loop to another.
struct Bridge {
    /// Where it begins: a place in its loop.
    from: usize,
    /// Where it ends.
    to: usize,
    /// Its new vertices, without its ends.
    over: Vec<Spot>,
}

impl Bridges<'_> {
    /// Simple polygons, counter-clockwise, that cover a region; `None` if no way was found.
    pub fn open(&mut self, region: Region, width: f64) -> Option<Vec<Vec<Spot>>> {
        let mut pieces = vec![];
        match region {
            Region::Sheet { outline, holes } => self.open_sheet(outline, holes, &mut pieces)?,
            Region::Tube { lower, upper, holes } => {
                for (outline, holes) in self.open_tube(&lower, upper, holes, width)? {
                    self.open_sheet(outline, holes, &mut pieces)?;
                }
            }
        }
        Some(pieces)
    }

    fn open_sheet(
        &mut self,
        outline: Vec<Spot>,
        mut holes: Vec<Vec<Spot>>,
        pieces: &mut Vec<Vec<Spot>>,
    ) -> Option<()> {
        if holes.is_empty() {
            pieces.push(outline);
            return Some(());
        }
        // The hole nearest to the outline, from the vertex nearest to it.
        let (_, k) = (0..holes.len())
            .map(|k| {
                let near = links(&outline, &holes[k]);
                (near.iter().map(|l| l.0).fold(f64::INFINITY, f64::min), k)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        let hole = holes.swap_remove(k);
        let mut walls = edges(&outline);
        walls.extend(edges(&hole));
        walls.extend(holes.iter().flat_map(|h| edges(h)));
        let mut near = links(&outline, &hole);
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let first = *near.iter().find(|l| is_clear(&walls, outline[l.1].at, hole[l.2].at))?;
        walls.push([outline[first.1].at, hole[first.2].at]);
        let n = hole.len();
        let apart = |l: &Link| {
            let steps = (l.2 + n - first.2) % n;
            steps.min(n - steps)
        };
        let second = [n / 3, n / 6, 1].into_iter().find_map(|least| {
            let far = |l: &&(f64, usize, usize)| apart(l) >= least.max(1) && l.1 != first.1;
            near.iter().filter(far).find(|l| is_clear(&walls, outline[l.1].at, hole[l.2].at)).copied()
        });
        // The nearest vertex of the outline may be taken or hidden: look at all of them.
        let second = second.or_else(|| {
            let mut all = vec![];
            for i in (0..outline.len()).filter(|&i| i != first.1) {
                for j in (0..n).filter(|&j| j != first.2) {
                    all.push((outline[i].at.distance(hole[j].at), i, j));
                }
            }
            all.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
            all.into_iter().take(4000).find(|l| is_clear(&walls, outline[l.1].at, hole[l.2].at))
        })?;
        let [one, mut two] = [first, second].map(|(_, from, to)| {
            let over = self.bridge(&outline, from, &hole, to, 0);
            Bridge { from, to, over }
        });
        let divided =
            |one: &Bridge, two: &Bridge| [walk(&outline, &hole, two, one), walk(&outline, &hole, one, two)];
        let mut halves = divided(&one, &two);
        let mut shares = [vec![], vec![]];
        for other in holes {
            let k = usize::from(!is_within(&halves[0], other[0].at));
            shares[k].push(other);
        }
        if self.even && [0, 1].map(|k| is_odd(&halves[k], &shares[k])) == [true; 2] {
            self.spots.truncate(self.spots.len() - two.over.len());
            two.over = self.bridge(&outline, two.from, &hole, two.to, 1);
            halves = divided(&one, &two);
        }
        for (half, share) in halves.into_iter().zip(shares) {
            self.open_sheet(half, share, pieces)?;
        }
        Some(())
    }

    /// Cuts a tube along two lines into two sheets.
    fn open_tube(
        &mut self,
        lower: &[Spot],
        upper: Vec<Spot>,
        holes: Vec<Vec<Spot>>,
        width: f64,
    ) -> Option<[Opened; 2]> {
        let tube = Tube::new(lower, upper, width);
        let [first, second] = tube.links(&holes)?;
        let [one, mut two] = [first, second].map(|(_, from, to)| {
            let over = self.bridge(&tube.low, from, &tube.high, to, 0);
            Bridge { from, to, over }
        });
        let outlines = [tube.walk(&one, &two), tube.walk(&two, &one)];
        let mut sheets = outlines.map(|outline| (outline, vec![]));
        for hole in holes {
            let at = |shift: f64| hole[0].at + DVec2::new(shift, 0.0);
            let place = tube.shifts().into_iter().find_map(|shift| {
                let k = sheets.iter().position(|(outline, _)| is_within(outline, at(shift)))?;
                Some((k, shift))
            });
            let (k, shift) = place?;
            let moved = hole.iter().map(|s| Spot { at: s.at + DVec2::new(shift, 0.0), ..*s }).collect();
            sheets[k].1.push(moved);
        }
        if self.even && sheets.iter().all(|(outline, holes)| is_odd(outline, holes)) {
            self.spots.truncate(self.spots.len() - two.over.len());
            two.over = self.bridge(&tube.low, two.from, &tube.high, two.to, 1);
            [sheets[0].0, sheets[1].0] = [tube.walk(&one, &two), tube.walk(&two, &one)];
        }
        Some(sheets)
    }

    /// New vertices from one spot to another, about as far apart as the vertices at its ends, and `more`.
    fn bridge(&mut self, from: &[Spot], i: usize, to: &[Spot], j: usize, more: usize) -> Vec<Spot> {
        let beside = |around: &[Spot], k: usize| {
            let n = around.len();
            let p = around[k].at;
            let near = [around[(k + 1) % n].at, around[(k + n - 1) % n].at].map(|q| p.distance(q));
            near[0].min(near[1])
        };
        let (p, q) = (from[i].at, to[j].at);
        let step = 0.5 * (beside(from, i) + beside(to, j));
        let steps = (p.distance(q) / step.max(f64::MIN_POSITIVE)).round().clamp(1.0, 1000.0) as usize;
        let (a, b) = (from[i].node, to[j].node);
        let steps = if self.taken.contains(&(a.min(b), a.max(b))) { steps.max(2) } else { steps } + more;
        (1..steps)
            .map(|k| {
                let at = p.lerp(q, k as f64 / steps as f64);
                self.spots.push(at);
                Spot { node: self.first + self.spots.len() as u32 - 1, at }
            })
            .collect()
    }
}

/// Whether an outline and its holes have an odd number of edges in sum.
fn is_odd(outline: &[Spot], holes: &[Vec<Spot>]) -> bool {
    (outline.len() + holes.iter().map(Vec::len).sum::<usize>()) % 2 == 1
}

/// Two loops around a closed sheet, unrolled.
struct Tube {
    /// Both forward, beginning at about the same place, three times around.
    low: Vec<Spot>,
    high: Vec<Spot>,
    /// Vertices of each, once around.
    n: usize,
    m: usize,
    /// Of the unrolled sheet.
    width: f64,
}

impl Tube {
    fn new(lower: &[Spot], upper: Vec<Spot>, width: f64) -> Self {
        let begin = lower[0].at.x;
        let thrice = |around: &[Spot]| {
            let base = width * ((begin - around[0].at.x) / width).round();
            let turn = |k: f64| {
                around.iter().map(move |s| Spot { at: DVec2::new(s.at.x + (base + k * width), s.at.y), ..*s })
            };
            turn(-1.0).chain(turn(0.0)).chain(turn(1.0)).collect::<Vec<_>>()
        };
        let upper = upper.into_iter().rev().collect::<Vec<_>>();
        Tube { low: thrice(lower), high: thrice(&upper), n: lower.len(), m: upper.len(), width }
    }

    fn shifts(&self) -> [f64; 3] {
        [0.0, -self.width, self.width]
    }

    /// Two lines from the lower to the upper loop that meet nothing, about half around apart: lengths and places.
    fn links(&self, holes: &[Vec<Spot>]) -> Option<[Link; 2]> {
        let Tube { low, high, n, .. } = self;
        let mut walls = edges_open(low);
        walls.extend(edges_open(high));
        for h in holes {
            for shift in self.shifts() {
                walls.extend(edges(h).into_iter().map(|e| e.map(|p| p + DVec2::new(shift, 0.0))));
            }
        }
        let off = |i: usize, j: usize| low[i].at.distance_squared(high[j].at);
        let nearest = |i: usize| {
            let best = (0..high.len()).min_by(|&a, &b| off(i, a).total_cmp(&off(i, b)))?;
            is_clear(&walls, low[i].at, high[best].at).then(|| (off(i, best).sqrt(), i, best))
        };
        // Where the nearest vertex is behind others of its own loop, the nearest that is not.
        let in_sight = |i: usize| {
            let mut near = (0..high.len()).collect::<Vec<_>>();
            near.sort_by(|&a, &b| off(i, a).total_cmp(&off(i, b)));
            let best = near.into_iter().find(|&j| is_clear(&walls, low[i].at, high[j].at))?;
            Some((off(i, best).sqrt(), i, best))
        };
        // Of a long narrow tube one vertex may be the nearest to all: those straight above are not.
        let above = |i: usize| {
            let aside = |j: usize| (high[j].at.x - low[i].at.x).abs();
            let best = (0..high.len()).min_by(|&a, &b| aside(a).total_cmp(&aside(b)))?;
            is_clear(&walls, low[i].at, high[best].at).then(|| (off(i, best).sqrt(), i, best))
        };
        let each = *n..2 * n;
        self.two_of(&each.clone().filter_map(nearest).collect::<Vec<_>>())
            .or_else(|| self.two_of(&each.clone().filter_map(in_sight).collect::<Vec<_>>()))
            .or_else(|| self.two_of(&each.filter_map(above).collect::<Vec<_>>()))
    }

    /// The shortest of these lines, and one about half around from it that does not cross it.
    fn two_of(&self, links: &[Link]) -> Option<[Link; 2]> {
        let Tube { low, high, m, width, .. } = self;
        let apart = |l: &Link, other: &Link| l.1 != other.1 && l.2 % m != other.2 % m;
        let first = *links.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let middle = low[first.1].at.x + 0.5 * width;
        // Another one about half around.
        let rank = |l: &Link| {
            let x = low[l.1].at.x;
            let off = [x - middle, x + width - middle, x - width - middle];
            off.into_iter().map(f64::abs).fold(f64::INFINITY, f64::min)
        };
        let crosses = |l: &Link| {
            let own = [low[l.1].at, high[l.2].at];
            self.shifts().into_iter().any(|shift| {
                segments_meet(own, [low[first.1].at, high[first.2].at].map(|p| p + DVec2::new(shift, 0.0)))
            })
        };
        let second = *links
            .iter()
            .filter(|l| apart(l, &first) && !crosses(l))
            .min_by(|a, b| rank(a).total_cmp(&rank(b)))?;
        Some([first, second])
    }

    /// Forward on the lower loop from one bridge to the other, over that, back on the upper loop, and back over the first.
    fn walk(&self, back: &Bridge, out: &Bridge) -> Vec<Spot> {
        let Tube { low, high, n, m, width } = self;
        let beside = |spot: Spot, x: f64| Spot {
            at: DVec2::new(spot.at.x + width * ((x - spot.at.x) / width).round(), spot.at.y),
            ..spot
        };
        let forward = (0..=*n).map(|k| low[(back.from + k) % n]);
        let ahead = 1 + forward.clone().skip(1).take_while(|s| s.node != low[out.from].node).count();
        let backward = (0..=*m).map(|k| high[(out.to + 3 * m - k) % m]);
        let behind = 1 + backward.clone().skip(1).take_while(|s| s.node != high[back.to].node).count();
        let spots = forward
            .take(ahead + 1)
            .chain(out.over.iter().copied())
            .chain(backward.take(behind + 1))
            .chain(back.over.iter().rev().copied());
        let mut x = low[back.from].at.x;
        spots
            .map(|spot| {
                let spot = beside(spot, x);
                x = spot.at.x;
                spot
            })
            .collect()
    }
}

/// Along the outline from one bridge to the next, over that, along the hole, and back over the first.
fn walk(outline: &[Spot], hole: &[Spot], back: &Bridge, out: &Bridge) -> Vec<Spot> {
    let along = |around: &[Spot], from: usize, to: usize| {
        let n = around.len();
        let steps = (to + n - from) % n;
        (0..=steps).map(|k| around[(from + k) % n]).collect::<Vec<_>>()
    };
    let mut all = along(outline, back.from, out.from);
    all.extend(&out.over);
    all.extend(along(hole, out.to, back.to));
    all.extend(back.over.iter().rev());
    all
}

/// For each vertex of the hole the nearest one of the outline: distance, there, here.
fn links(outline: &[Spot], hole: &[Spot]) -> Vec<Link> {
    let nearest = |(j, h): (usize, &Spot)| {
        let best = (0..outline.len()).min_by(|&a, &b| {
            outline[a].at.distance_squared(h.at).total_cmp(&outline[b].at.distance_squared(h.at))
        });
        best.map(|i| (outline[i].at.distance(h.at), i, j))
    };
    hole.iter().enumerate().filter_map(nearest).collect()
}

fn edges(around: &[Spot]) -> Vec<[DVec2; 2]> {
    (0..around.len()).map(|k| [around[k].at, around[(k + 1) % around.len()].at]).collect()
}

fn edges_open(line: &[Spot]) -> Vec<[DVec2; 2]> {
    line.windows(2).map(|w| [w[0].at, w[1].at]).collect()
}

/// True if the segment meets none of the walls but those that end where it ends.
fn is_clear(walls: &[[DVec2; 2]], p: DVec2, q: DVec2) -> bool {
    let joins = |w: &[DVec2; 2]| w.iter().any(|&x| x == p || x == q);
    walls.iter().all(|w| {
        if joins(w) {
            // Not along it.
            let other = if w[0] == p || w[0] == q { w[1] } else { w[0] };
            let at = if w[0] == p || w[1] == p { p } else { q };
            let far = if at == p { q } else { p };
            other == far || (other - at).perp_dot(far - at) != 0.0 || (other - at).dot(far - at) < 0.0
        } else {
            !segments_meet(*w, [p, q])
        }
    })
}
