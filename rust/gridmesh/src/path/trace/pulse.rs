//! Counts the work of searches, and asks from time to time whether to go on.

use crate::progress::{Meter, Progress};

/// States between two questions: about a millisecond.
const EVERY: u64 = 1 << 14;

/// The work done so far, in states taken from queues: the same for the same input, unlike time.
pub(super) struct Pulse<'a> {
    progress: Progress<'a>,
    pub taken: u64,
    next: u64,
    limit: u64,
    is_stopped: bool,
}

impl<'a> Pulse<'a> {
    pub fn new(progress: Progress<'a>) -> Self {
        Self { progress, taken: 0, next: EVERY, limit: u64::MAX, is_stopped: false }
    }

    /// Notes some work; true if it is to stop.
    #[inline]
    pub fn beat(&mut self, work: u64) -> bool {
        self.taken += work;
        if self.taken >= self.next {
            self.ask();
        }
        self.is_stopped
    }

    /// From now on so much work is allowed as a boundary with so many states may be worth. Of the drawings
    /// that were measured one with a result, a long sliver, took more than half of it, all others less. Where the
    /// meter has less left than that, it is less.
    pub fn limit(&mut self, states: usize) {
        let left = self.progress.meter().map_or(u64::MAX, Meter::left);
        self.limit = self.taken + left.min(12_000_000) + 6 * states as u64;
    }

    /// True if a search is to be given up where there is little hope.
    pub fn is_hasty(&self) -> bool {
        self.progress.meter().is_some_and(Meter::is_hasty)
    }

    /// Takes the limit back.
    pub fn unlimit(&mut self) {
        self.limit = u64::MAX;
    }

    /// True once more work was done than is allowed.
    pub fn is_spent(&self) -> bool {
        self.taken > self.limit
    }

    /// True once the caller has asked to stop: what was found since is not to be trusted.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    fn ask(&mut self) {
        self.next = self.taken + EVERY;
        self.is_stopped = self.is_stopped || self.progress.report(0.0).is_err();
    }
}

impl Drop for Pulse<'_> {
    fn drop(&mut self) {
        if let Some(meter) = self.progress.meter() {
            meter.add(self.taken);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use glam::DVec2;

    use super::super::graph::Graph;
    use super::super::prices::Prices;
    use super::super::search::Search;
    use super::super::straightest::fewest_turns;
    use super::*;
    use crate::path::band::Band;
    use crate::path::target::Target;

    fn graph() -> Graph {
        let n = 12_000;
        let wave = |i: u32| {
            let t = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
            (700.0 + 90.0 * (9.0 * t).sin()) * DVec2::from_angle(t)
        };
        let points: Vec<DVec2> = (0..n).map(wave).collect();
        Graph::new(&Band::new(&Target { points, step: 0.4 }, 1.5), 0.3)
    }

    #[test]
    fn searches_ask_at_least_once_in_so_many_states() {
        let asked = AtomicU64::new(0);
        let callback = |_: f64| asked.fetch_add(1, Ordering::Relaxed) < u64::MAX;
        let graph = graph();
        let mut search = Search::new(Pulse::new(Progress::new(&callback)));
        let potential = search.potential(&graph);
        let found = search.closed(&graph, &potential, &Prices::none(graph.n_nodes()), u32::MAX);
        let turns = fewest_turns(&graph, u32::MAX, &mut search.pulse);
        let taken = search.pulse.taken;
        assert!(found.is_some() && turns < u32::MAX && taken > 8 * EVERY, "{taken}");
        assert!((asked.load(Ordering::Relaxed) + 1) * EVERY >= taken);
    }

    #[test]
    fn a_search_that_is_told_to_stop_does() {
        let graph = graph();
        let callback = |_: f64| false;
        let mut search = Search::new(Pulse::new(Progress::new(&callback)));
        search.potential(&graph);
        assert!(search.pulse.is_stopped() && search.pulse.taken <= EVERY);
    }
}
