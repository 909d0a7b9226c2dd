//! Gives the line vertices of its own where it still crosses edges, and makes what that divides even again.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::{Line, distances, least};
use crate::error::Result;
use crate::fill::even::local::{Local, edge, quality};
use crate::fill::even::polish::improve;
use crate::fill::even::regular::regularize_along;
use crate::fill::even::remesh::{Ground, mend_thin};
use crate::geometry::disjoint::Disjoint;
use crate::progress::Progress;

/// The line's own vertices keep this share of an edge from both of its ends.
const ROOM: f64 = 0.4;

/// Edges at the line that are shorter go, in lengths of the edges around, if all triangles stay or become rounder than this.
const SHORT: f64 = 0.7;
const ROUND: f64 = 0.5;

/// No edge becomes longer by that.
const LONGEST: f64 = 1.6;

/// Steps that smooth the line, towards the middle between its vertices and back, so that it does not shrink.
///
/// Source: Taubin, *A signal processing approach to fair surface design*, 1995.
const STEPS: [f64; 6] = [0.5, -0.53, 0.5, -0.53, 0.5, -0.53];

/// No triangle becomes worse than this by it, unless it was before.
const POOR: f64 = 0.4;

impl Line<'_> {
    /// Divides all edges that the line crosses where it does; the side of each triangle, `None` if there is no such edge.
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::error::Error::Cancelled).
    pub(super) fn divide(&mut self, progress: Progress<'_>) -> Result<Option<Vec<usize>>> {
        let open = self.local.edges().into_iter().filter(|e| self.is_open(e[0], e[1])).collect::<Vec<_>>();
        if open.is_empty() {
            return Ok(None);
        }
        let ground = Ground::of(&self.local);
        open.into_iter().for_each(|e| self.divide_edge(e));
        let along = self.along();
        self.local.hard = along.iter().flat_map(|(&v, ends)| ends.iter().map(move |&u| edge(u, v))).collect();
        self.shorten();
        self.local.compact();
        regularize_along(&mut self.local, Some(&ground), progress)?;
        mend_thin(&mut self.local);
        self.smooth(&ground);
        Ok(Some(self.flooded()))
    }

    fn divide_edge(&mut self, [a, b]: [u32; 2]) {
        let [i, j] = [a, b].map(|v| self.nearest(v));
        let [p, q] = [a, b].map(|v| self.local.positions[v as usize]);
        let there = self.crossing(a, b).unwrap_or(0.5 * (p + q));
        let share = (there.distance(p) / p.distance(q).max(f64::MIN_POSITIVE)).clamp(ROOM, 1.0 - ROOM);
        let m = self.local.positions.len() as u32;
        self.local.split([a, b]);
        let place = p.lerp(q, share);
        self.local.positions[m as usize] = place;
        let mut off = distances(self.surfaces, place);
        let near = least(off.iter().copied());
        (off[i], off[j]) = (off[near], off[near]);
        self.off.push(off);
        self.on.insert(m);
    }

    /// The side of each triangle: what lies between hard lines is of the surface that is nearest to most of it.
    fn flooded(&self) -> Vec<usize> {
        let local = &self.local;
        let mut sets = Disjoint::new(local.triangles.len());
        for e in local.edges().into_iter().filter(|e| !local.hard.contains(e)) {
            if let [s, t] = *local.beside(e).as_slice() {
                sets.join(s, t);
            }
        }
        let mut sums: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
        let root = (0..local.triangles.len() as u32).map(|t| sets.root(t)).collect::<Vec<_>>();
        for (t, &root) in (0..).zip(&root) {
            let [a, b, c] = local.corners(t);
            let area = (b - a).cross(c - a).length();
            let off = distances(self.surfaces, (a + b + c) / 3.0);
            let sum = sums.entry(root).or_insert_with(|| vec![0.0; off.len()]);
            sum.iter_mut().zip(off).for_each(|(sum, off)| *sum += area * off);
        }
        root.iter().map(|root| least(sums[root].iter().copied())).collect()
    }

    /// Takes short edges at the line out.
    fn shorten(&mut self) {
        let lines = self.local.hard.iter().flatten().copied().collect::<BTreeSet<_>>();
        let at_line = |e: &[u32; 2]| e.iter().any(|v| lines.contains(v));
        let mut short = self
            .local
            .edges()
            .into_iter()
            .filter(at_line)
            .map(|e| (self.local.length(e), e))
            .collect::<Vec<_>>();
        short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (length, [a, b]) in short {
            if length >= SHORT {
                break;
            }
            if self.local.beside([a, b]).len() == 2 && self.local.length([a, b]) < SHORT {
                let _ = [(b, a), (a, b)].into_iter().any(|(from, into)| {
                    self.becomes_round(from, into) && self.local.collapse(from, into, LONGEST)
                });
            }
        }
    }

    /// Whether the triangles of a vertex that is moved into another one are round then, or rounder than before.
    fn becomes_round(&self, from: u32, into: u32) -> bool {
        let place = self.local.positions[into as usize];
        let worst = |moves: bool| {
            let fan = self.local.fan(from).iter().map(|&t| self.local.triangles[t as usize]);
            let stay = fan.filter(|own| !moves || !own.contains(&into));
            let at = |v: u32| if moves && v == from { place } else { self.local.positions[v as usize] };
            stay.map(|own| quality(own.map(at))).fold(1.0, f64::min)
        };
        worst(true) >= ROUND.min(worst(false))
    }

    /// Smooths the line within the surface; the vertices beside it make room.
    fn smooth(&mut self, ground: &Ground) {
        let mut along: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &[a, b] in &self.local.hard {
            along.entry(a).or_default().push(b);
            along.entry(b).or_default().push(a);
        }
        let first = self.local.border as u32;
        for step in STEPS {
            let moved = along.iter().filter(|(v, ends)| **v >= first && ends.len() == 2).map(|(&v, ends)| {
                let [p, a, b] = [v, ends[0], ends[1]].map(|u| self.local.positions[u as usize]);
                (v, p + step * (0.5 * (a + b) - p))
            });
            for (v, place) in moved.collect::<Vec<_>>() {
                let normals = self.local.fan(v).iter().map(|&t| self.local.corners(t));
                let up = normals.map(|[a, b, c]| (b - a).cross(c - a)).sum::<DVec3>();
                self.moves(v, ground.nearest(0, place, up), POOR);
            }
        }
        let near = along.keys().flat_map(|&v| self.local.neighbours(v)).collect::<BTreeSet<_>>();
        let thin = |local: &Local, v: u32| local.fan(v).iter().any(|&t| quality(local.corners(t)) < POOR);
        for v in near.into_iter().filter(|v| *v >= first) {
            if !along.contains_key(&v) || thin(&self.local, v) {
                improve(&mut self.local, v);
            }
        }
    }
}
