//! Progress and cancelling across the language border.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use gridmesh::error::Result;
use gridmesh::progress::Progress;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::error::{Failure, guarded};
use crate::process;

/// How often signals (Ctrl-C) are looked for while no callback is called.
pub const SIGNALS_EVERY: Duration = Duration::from_millis(20);

/// Hands progress to a Python callable, listens for signals, and keeps what they raise.
pub struct Watch {
    callable: Option<Py<PyAny>>,
    raised: Mutex<Option<PyErr>>,
    next_look: Mutex<Instant>,
    stopped: AtomicBool,
}

impl Watch {
    /// Watches with `callable` or, if that is None, for signals only.
    pub fn new(callable: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        if let Some(callable) = callable
            && !callable.is_callable()
        {
            let found = callable.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "progress is of type {found}; allowed: a callable that takes a fraction and returns False to cancel, or None"
            )));
        }
        Ok(Self {
            callable: callable.map(|callable| callable.clone().unbind()),
            raised: Mutex::new(None),
            next_look: Mutex::new(Instant::now() + SIGNALS_EVERY),
            stopped: AtomicBool::new(false),
        })
    }

    /// True once the callable or a signal has asked to stop.
    pub fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// Runs `work` without the interpreter lock, handing it a progress that reports here.
    pub fn run<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(Progress<'_>) -> Result<T> + Send,
    ) -> PyResult<T> {
        let callback = |fraction| self.report(fraction);
        let work = || work(Progress::new(&callback));
        let result = py.detach(|| guarded(|| process::run(work, SIGNALS_EVERY, || self.listen())));
        self.finish(py, result)
    }

    /// The result, unless the callable or a signal handler raised an exception: then that.
    pub fn finish<T>(&self, py: Python<'_>, result: Result<T, Failure>) -> PyResult<T> {
        match self.raised.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some(raised) => Err(raised),
            None => result.map_err(|failure| failure.into_py(py)),
        }
    }

    /// Reports a fraction; false asks to stop.
    pub fn report(&self, fraction: f64) -> bool {
        if self.is_stopped() {
            return false;
        }
        if self.callable.is_none() && !self.is_time_to_look() {
            return true;
        }
        let go_on = Python::attach(|py| self.ask(py, fraction)).unwrap_or_else(|raised| {
            *self.raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(raised);
            false
        });
        if !go_on {
            self.stopped.store(true, Ordering::Relaxed);
        }
        go_on
    }

    /// Looks for signals, which Python delivers to its main thread alone.
    fn listen(&self) {
        if let Err(raised) = Python::attach(|py| py.check_signals()) {
            *self.raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(raised);
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    fn ask(&self, py: Python<'_>, fraction: f64) -> PyResult<bool> {
        py.check_signals()?;
        let Some(callable) = &self.callable else {
            return Ok(true);
        };
        let answer = callable.bind(py).call1((fraction,))?;
        // Only False itself (or numpy's) cancels: a callable that returns nothing goes on.
        Ok(answer.extract::<bool>().unwrap_or(true))
    }

    fn is_time_to_look(&self) -> bool {
        let mut next_look = self.next_look.lock().unwrap_or_else(PoisonError::into_inner);
        let now = Instant::now();
        let due = now >= *next_look;
        if due {
            *next_look = now + SIGNALS_EVERY;
        }
        due
    }
}
