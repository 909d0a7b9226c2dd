//! Threads after a fork.
//!
//! A process made by `fork` has only the thread that called it: the shared pool of threads of its parent is
//! there in memory, but nobody works in it, and whoever hands it work waits for ever. So a child does its
//! work in a pool of its own.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, OnceLock, TryLockError};
use std::thread;
use std::time::Duration;

use gridmesh::error::{Error, Result};
use rayon::{ThreadPool, ThreadPoolBuilder};

/// The process that uses the shared pool: the first that worked.
static FIRST: OnceLock<u32> = OnceLock::new();

/// The pool of a forked process, and which process that is.
static OWN: Mutex<Option<(u32, &'static ThreadPool)>> = Mutex::new(None);

/// Runs `work` in this thread, or in a forked process within a pool of its own.
///
/// There the calling thread calls `meanwhile` every so often until the work is done.
///
/// # Errors
/// Those of `work`, and [`Error::Solver`] if no thread can be had.
pub fn run<T: Send>(
    work: impl FnOnce() -> Result<T> + Send,
    every: Duration,
    meanwhile: impl Fn(),
) -> Result<T> {
    let process = std::process::id();
    let first = *FIRST.get_or_init(|| {
        // Every thread of the pool looks for work once: a fork while one of them still sets up what all threads share would
        // leave that half done in the child.
        rayon::broadcast(|_| rayon::yield_now());
        process
    });
    if first == process {
        return work();
    }
    let pool = pool_of(process)?;
    let (done, wait) = channel::<()>();
    thread::scope(|scope| {
        let worker = scope.spawn(move || {
            let _done = done;
            pool.install(work)
        });
        while wait.recv_timeout(every) == Err(RecvTimeoutError::Timeout) {
            meanwhile();
        }
        // A panic goes on in the caller, who turns it into an error.
        worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// The pool of this process. That of its parent is left alone: its threads are not there to be ended.
fn pool_of(process: u32) -> Result<&'static ThreadPool> {
    let new = || -> Result<&'static ThreadPool> {
        let pool = ThreadPoolBuilder::new().build();
        let pool = pool.map_err(|err| Error::Solver { stage: "thread pool", reason: err.to_string() })?;
        Ok(Box::leak(Box::new(pool)))
    };
    let mut own = match OWN.try_lock() {
        Ok(own) => own,
        Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
        // Held by another thread, perhaps one of the parent that is no more: better not to wait.
        Err(TryLockError::WouldBlock) => return new(),
    };
    match *own {
        Some((known, pool)) if known == process => Ok(pool),
        _ => {
            let pool = new()?;
            *own = Some((process, pool));
            Ok(pool)
        }
    }
}
