//! Progress reports, cancelling, and the time of stages.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use crate::error::{Error, Result};

/// Hands fractions of the work done to a callback, which may ask to stop.
///
/// [`Progress::part`] gives a stage its share of the whole, so that stages report from 0 to 1 and
/// need not know of each other.
#[derive(Clone, Copy)]
pub struct Progress<'a> {
    callback: Option<&'a (dyn Fn(f64) -> bool + Sync)>,
    start: f64,
    length: f64,
    meter: Option<&'a Meter>,
}

/// Counts work in steps of an algorithm, which unlike time are the same for the same input, and bounds it.
#[derive(Debug)]
pub(crate) struct Meter {
    taken: AtomicU64,
    most: u64,
    is_hasty: bool,
}

impl Meter {
    /// For at most so many steps.
    pub(crate) fn new(most: u64) -> Self {
        Self { taken: AtomicU64::new(0), most, is_hasty: false }
    }

    /// The same for work that is given up where there is little hope.
    pub(crate) fn hasty(most: u64) -> Self {
        Self { is_hasty: true, ..Self::new(most) }
    }

    /// True if work is to be given up where there is little hope.
    pub(crate) fn is_hasty(&self) -> bool {
        self.is_hasty
    }

    /// Notes steps.
    pub(crate) fn add(&self, steps: u64) {
        self.taken.fetch_add(steps, Ordering::Relaxed);
    }

    /// The steps so far. Of work side by side only the sum at its end is determined.
    pub(crate) fn taken(&self) -> u64 {
        self.taken.load(Ordering::Relaxed)
    }

    /// How many steps are left.
    pub(crate) fn left(&self) -> u64 {
        self.most.saturating_sub(self.taken())
    }
}

impl<'a> Progress<'a> {
    /// Reports to nobody and is never cancelled.
    pub const NONE: Progress<'static> = Progress { callback: None, start: 0.0, length: 1.0, meter: None };

    /// Reports to `callback`, which returns false to cancel.
    pub fn new(callback: &'a (dyn Fn(f64) -> bool + Sync)) -> Self {
        Progress { callback: Some(callback), start: 0.0, length: 1.0, meter: None }
    }

    /// The share from `start` to `end` (both 0 to 1) of this progress.
    pub fn part(&self, start: f64, end: f64) -> Progress<'a> {
        Progress {
            callback: self.callback,
            start: self.start + start * self.length,
            length: (end - start) * self.length,
            meter: self.meter,
        }
    }

    /// The same, whose work is counted and bounded by a meter.
    pub(crate) fn metered(&self, meter: &'a Meter) -> Progress<'a> {
        Progress { meter: Some(meter), ..*self }
    }

    /// The meter of this work, if there is one.
    pub(crate) fn meter(&self) -> Option<&'a Meter> {
        self.meter
    }

    /// Reports that `fraction` (0 to 1) of this part is done.
    ///
    /// # Errors
    /// [`Error::Cancelled`] if the callback asks to stop.
    pub fn report(&self, fraction: f64) -> Result<()> {
        match self.callback {
            Some(callback) if !callback(self.start + fraction * self.length) => Err(Error::Cancelled),
            _ => Ok(()),
        }
    }
}

/// Time between two questions while work is done [`aside`].
const ASK_EVERY: Duration = Duration::from_millis(10);

/// Does work that cannot ask whether to go on, on a thread of its own, while this one asks.
///
/// If the answer is no, the work is left to end by itself, unheard. Without a callback it is done here.
///
/// # Errors
/// [`Error::Cancelled`] at once; [`Error::Internal`] if the work panics.
pub(crate) fn aside<T: Send + 'static>(
    progress: Progress<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T> {
    if progress.callback.is_none() {
        return Ok(work());
    }
    let work = Arc::new(Mutex::new(Some(work)));
    let take = |work: &Mutex<Option<_>>| work.lock().unwrap_or_else(PoisonError::into_inner).take();
    let (sender, made) = channel();
    let own = Arc::clone(&work);
    let thread = thread::Builder::new().spawn(move || {
        // Nobody waits for it any more once the answer was no.
        let _ = take(&own).map(|work: _| sender.send(work()));
    });
    if thread.is_err()
        && let Some(work) = take(&work)
    {
        return Ok(work());
    }
    loop {
        match made.recv_timeout(ASK_EVERY) {
            Ok(made) => return Ok(made),
            Err(RecvTimeoutError::Timeout) => progress.report(0.0)?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Error::Internal { reason: "a thread of a computation died" });
            }
        }
    }
}

/// Progress that only rises, for work that is done side by side or begins again.
///
/// What is lower than before is passed on as the highest fraction so far. Once the callback has asked to
/// stop it is not asked again, and all parts of the work hear of it.
pub(crate) struct Rising<'a> {
    progress: Progress<'a>,
    /// The highest fraction, and whether to stop.
    state: Mutex<(f64, bool)>,
}

impl<'a> Rising<'a> {
    pub(crate) fn new(progress: Progress<'a>) -> Self {
        Self { progress, state: Mutex::new((0.0, false)) }
    }

    /// Passes a fraction on; false asks to stop.
    pub(crate) fn report(&self, fraction: f64) -> bool {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.0 = state.0.max(fraction.min(1.0));
        state.1 = state.1 || self.progress.report(state.0).is_err();
        !state.1
    }
}

/// Seconds per stage, for reports.
pub(crate) struct Clock {
    since: Instant,
    /// Name and seconds of each stage, in the order of their first ends.
    pub(crate) seconds: Vec<(&'static str, f64)>,
}

impl Clock {
    /// Starts now.
    pub(crate) fn new() -> Self {
        Clock { since: Instant::now(), seconds: vec![] }
    }

    /// Ends a stage; one that is repeated counts whole.
    pub(crate) fn stage(&mut self, name: &'static str) {
        let elapsed = self.since.elapsed().as_secs_f64();
        match self.seconds.iter_mut().find(|(known, _)| *known == name) {
            Some((_, seconds)) => *seconds += elapsed,
            None => self.seconds.push((name, elapsed)),
        }
        self.since = Instant::now();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn rising_progress_never_falls_and_stops_for_good() {
        let seen = Mutex::new(Vec::new());
        let callback = |f: f64| {
            let mut seen = seen.lock().unwrap_or_else(PoisonError::into_inner);
            seen.push(f);
            seen.len() < 4
        };
        let rising = Rising::new(Progress::new(&callback));
        let answers = [0.2, 0.1, 0.5, 0.3, 0.9].map(|f| rising.report(f));
        assert_eq!(answers, [true, true, true, false, false]);
        assert_eq!(*seen.lock().unwrap_or_else(PoisonError::into_inner), [0.2, 0.2, 0.5, 0.5]);
    }

    #[test]
    fn work_aside_is_left_when_the_answer_is_no() {
        let asked = AtomicU64::new(0);
        let callback = |_: f64| asked.fetch_add(1, Ordering::Relaxed) < 2;
        let (go_on, wait) = channel::<()>();
        // Without an answer it would wait for ever.
        let made = aside(Progress::new(&callback), move || wait.recv().is_ok());
        assert_eq!(made, Err(Error::Cancelled));
        assert_eq!(asked.into_inner(), 3);
        drop(go_on);
        let yes = |_: f64| true;
        assert_eq!(aside(Progress::new(&yes), || 6 * 7), Ok(42));
        assert_eq!(aside(Progress::NONE, || 6 * 7), Ok(42));
    }

    #[test]
    fn parts_nest_and_false_cancels() {
        let seen = Mutex::new(Vec::new());
        let callback = |f: f64| {
            if let Ok(mut seen) = seen.lock() {
                seen.push(f);
            }
            f < 0.5
        };
        let progress = Progress::new(&callback);
        assert!(progress.part(0.2, 0.4).report(0.5).is_ok());
        assert!(matches!(progress.part(0.4, 0.8).part(0.5, 1.0).report(0.0), Err(Error::Cancelled)));
        drop(seen);
        assert!(Progress::NONE.report(1.0).is_ok());
    }
}
