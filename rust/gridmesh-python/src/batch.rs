//! Many drawings at once.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;

use glam::DVec2;
use gridmesh::body::inflate::{InflateOptions, inflate};
use gridmesh::body::stitch::stitch;
use gridmesh::body::surface::Surface;
use gridmesh::error::{Error, Result};
use gridmesh::options::SketchOptions;
use gridmesh::progress::Progress;
use gridmesh::sketch::mesh_sketch;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use crate::error::{Failure, guarded};
use crate::watch::{SIGNALS_EVERY, Watch};

/// One drawing: its outline and holes.
pub struct Drawing {
    pub outline: Vec<DVec2>,
    pub holes: Vec<Vec<DVec2>>,
}

/// What is done with every drawing.
pub struct Job {
    pub sketch: SketchOptions,
    /// None: only stitched.
    pub inflate: Option<InflateOptions>,
    /// None: as many as there are processors.
    pub threads: Option<usize>,
}

impl Job {
    /// Works on all drawings, `None` being one that could not be read. Results are in order.
    ///
    /// The calling thread only waits, reports to `watch` and listens for signals (Python delivers
    /// them to its main thread alone), while a pool of threads works.
    pub fn run(
        &self,
        drawings: &[Option<Drawing>],
        watch: &Watch,
    ) -> Result<Vec<Option<Result<Surface, Failure>>>> {
        let threads = self.threads.map_or(0, |threads| threads.min(drawings.len().max(1)));
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|err| Error::Solver { stage: "thread pool", reason: err.to_string() })?;
        let done = AtomicUsize::new(0);
        let (finished, wait) = channel::<()>();
        thread::scope(|scope| {
            let worker = scope.spawn(|| {
                let _finished = finished;
                pool.install(|| {
                    drawings
                        .par_iter()
                        .map(|drawing| {
                            let result = drawing.as_ref().map(|drawing| guarded(|| self.one(drawing, watch)));
                            done.fetch_add(1, Ordering::Relaxed);
                            result
                        })
                        .collect()
                })
            });
            while wait.recv_timeout(SIGNALS_EVERY) == Err(RecvTimeoutError::Timeout) {
                watch.report(done.load(Ordering::Relaxed) as f64 / drawings.len().max(1) as f64);
            }
            let results = worker.join();
            if watch.is_stopped() || !watch.report(1.0) {
                return Err(Error::Cancelled);
            }
            results.map_err(|_| Error::Solver { stage: "thread pool", reason: "a worker thread died".into() })
        })
    }

    fn one(&self, drawing: &Drawing, watch: &Watch) -> Result<Surface> {
        let go_on = |_| !watch.is_stopped();
        let progress = Progress::new(&go_on);
        progress.report(0.0)?;
        let sketch = mesh_sketch(&drawing.outline, &drawing.holes, &self.sketch, progress)?;
        match &self.inflate {
            Some(options) => inflate(&sketch.patch, options, progress),
            None => Ok(stitch(&sketch.patch)),
        }
    }
}
