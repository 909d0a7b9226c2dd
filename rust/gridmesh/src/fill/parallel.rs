//! Progress of work that many threads share, or that is done in parts of unknown length.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::progress::Progress;

/// Time between two reports while other threads work.
const REPORT_EVERY: Duration = Duration::from_millis(20);

/// Runs `work` with a progress that never falls, whatever `work` reports.
pub(crate) fn steady<T>(progress: Progress<'_>, work: impl FnOnce(Progress<'_>) -> Result<T>) -> Result<T> {
    // The bits of numbers that are not negative are ordered as the numbers are.
    let most = AtomicU64::new(0);
    let callback = |fraction: f64| {
        let fraction = fraction.clamp(0.0, 1.0);
        let before = f64::from_bits(most.fetch_max(fraction.to_bits(), Ordering::Relaxed));
        progress.report(fraction.max(before)).is_ok()
    };
    work(Progress::new(&callback))
}

/// What `each` makes of the items, in order, in parallel; `weight` says how much work an item is.
///
/// Only the calling thread reports, at short intervals, while others work: who listens may belong to it. (On
/// a thread of a pool that would leave the pool without it; there the threads report themselves, one at a time.)
///
/// # Errors
/// [`Error::Cancelled`], within the time that `each` takes between two reports of its own.
pub(crate) fn in_parallel<I: Sync, T: Send>(
    items: &[I],
    weight: impl Fn(&I) -> usize + Sync,
    progress: Progress<'_>,
    each: impl Fn(&I, Progress<'_>) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let total = items.iter().map(&weight).sum::<usize>().max(1);
    let (done, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let fraction = || done.load(Ordering::Relaxed) as f64 / total as f64;
    let work = |go_on: &(dyn Fn(f64) -> bool + Sync)| {
        let one = |item: &I| {
            let made = each(item, Progress::new(go_on));
            done.fetch_add(weight(item), Ordering::Relaxed);
            made
        };
        items.par_iter().map(one).collect::<Result<Vec<T>>>()
    };
    if rayon::current_thread_index().is_some() {
        let turn = Mutex::new(());
        return work(&|_| {
            let _turn = turn.lock().unwrap_or_else(PoisonError::into_inner);
            progress.report(fraction()).is_ok()
        });
    }
    let (finished, wait) = channel::<()>();
    thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let _finished = finished;
            work(&|_| !stopped.load(Ordering::Relaxed))
        });
        let mut heard = Ok(());
        while wait.recv_timeout(REPORT_EVERY) == Err(RecvTimeoutError::Timeout) {
            if heard.is_ok() {
                heard = progress.report(fraction());
                stopped.store(heard.is_err(), Ordering::Relaxed);
            }
        }
        let made = worker.join().unwrap_or(Err(Error::Internal { reason: "a thread of a fill died" }));
        heard.and(made)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steady_progress_never_falls() {
        let seen = Mutex::new(vec![]);
        let callback = |fraction: f64| {
            seen.lock().unwrap().push(fraction);
            fraction < 0.9
        };
        let work = |progress: Progress<'_>| {
            progress.report(0.5)?;
            progress.part(0.0, 0.2).report(1.0)?;
            progress.report(0.95)
        };
        assert_eq!(steady(Progress::new(&callback), work), Err(Error::Cancelled));
        assert_eq!(*seen.lock().unwrap(), [0.5, 0.5, 0.95]);
    }

    #[test]
    fn work_of_many_threads_is_heard_and_stopped() {
        let caller = thread::current().id();
        let seen = Mutex::new(vec![]);
        let callback = |fraction: f64| {
            assert_eq!(thread::current().id(), caller);
            seen.lock().unwrap().push(fraction);
            fraction < 0.5
        };
        // Work that ends only when it is told to, but for the first items.
        let each = |&k: &usize, progress: Progress<'_>| {
            if k < 10 {
                return Ok(k);
            }
            loop {
                progress.report(0.0)?;
                thread::yield_now();
            }
        };
        let items = (0..12).collect::<Vec<_>>();
        assert_eq!(in_parallel(&items, |_| 1, Progress::new(&callback), each), Err(Error::Cancelled));
        assert!(seen.lock().unwrap().is_sorted());
        // However often it is asked on a busy machine.
        let go_on = |_: f64| true;
        assert_eq!(in_parallel(&items[..10], |_| 1, Progress::new(&go_on), each), Ok((0..10).collect()));
    }

    #[test]
    fn inside_a_pool_of_one_thread_it_ends_too() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let square = |k: &usize, progress: Progress<'_>| progress.report(0.0).map(|()| k * k);
        let squares = pool.install(|| in_parallel(&[1, 2, 3], |_| 1, Progress::NONE, square));
        assert_eq!(squares, Ok(vec![1, 4, 9]));
    }
}
