//! `run`: long work without the GIL, which Ctrl-C stops and which reports progress to a Python function.
use crate::failure;
use crate::pool::pool;
use chordal::Job;
use chordal::budget::Progress;
use chordal_cli::memory;
use pyo3::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, channel};
use std::time::{Duration, Instant};

/// The interval at which the waiting thread checks for signals. Chosen: a fifth of the tenth of a second
/// within which Ctrl-C should work.
const LOOK: Duration = Duration::from_millis(20);

/// How long the waiting thread polls before it sleeps. Measured: about the time to wake a thread. Negligible
/// beside [`LOOK`].
const AWAKE: Duration = Duration::from_micros(50);

/// After this time without progress the last report is repeated. Chosen: users should see that work goes on;
/// more often would only cost time.
const SILENCE: Duration = Duration::from_secs(1);

/// A Python function that receives progress.
pub(crate) struct ProgressListener {
    function: Py<PyAny>,
    /// The last report; at first the verb, with nothing done.
    last: Progress,
    last_time: Instant,
}

impl ProgressListener {
    /// A listener; the stage is `verb` until the work reports another.
    pub(crate) fn new(function: Option<Py<PyAny>>, verb: &'static str) -> Option<Self> {
        let last = Progress { stage: verb, done: 0, total: 1 };
        function.map(|function| Self { function, last, last_time: Instant::now() })
    }

    /// Calls the function.
    fn report(&mut self, py: Python<'_>, progress: Progress) -> PyResult<()> {
        (self.last, self.last_time) = (progress, Instant::now());
        self.function.call1(py, (progress.stage, progress.done, progress.total)).map(drop)
    }

    /// Reports new progress, or repeats the last report after a long silence.
    fn update(&mut self, py: Python<'_>, progress: Option<Progress>) -> PyResult<()> {
        match progress {
            Some(progress) => self.report(py, progress),
            None if self.last_time.elapsed() >= SILENCE => self.report(py, self.last),
            None => Ok(()),
        }
    }
}

/// A message of the work to the waiting thread.
enum WorkMessage<T> {
    Progress(Progress),
    Done(T),
    Panicked,
}

/// Runs `work` on the thread pool and waits for it without the GIL.
///
/// Python's signal handlers run meanwhile, every [`LOOK`]. If one of them or the progress function raises,
/// that exception is returned at once and unchanged; the work is cancelled and ends later by itself, since it
/// owns its data. Progress is reported from the calling thread: the verb at the start and at the end, the
/// work's reports in between (only the last of several at once), and the last one again after a [`SILENCE`].
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<ProgressListener>,
    work: impl FnOnce(&Job) -> T + Send + 'static,
) -> PyResult<T> {
    run_within(py, progress, None, work)
}

/// The same for work that is asked after `within` to end with its best result. The waiting thread checks the
/// clock, so no other thread is needed.
pub(crate) fn run_within<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<ProgressListener>,
    within: Option<Duration>,
    work: impl FnOnce(&Job) -> T + Send + 'static,
) -> PyResult<T> {
    // `None` if the time is beyond the range of the clock: then there is no limit.
    let end = within.and_then(|within| Instant::now().checked_add(within));
    let pool = pool(py).map_err(|error| failure::internal(py, &format!("no threads: {error}")))?;
    let (sender, receiver) = channel();
    let mut job = Job::default();
    job.memory_limit = memory_limit().unwrap_or(job.memory_limit);
    if progress.is_some() {
        let sender = sender.clone();
        // Sending fails once the caller has left, which is fine.
        job = job.with_progress(move |progress| drop(sender.send(WorkMessage::Progress(progress))));
    }
    let guard = CancelGuard(&job);
    let work_job = job.clone();
    pool.spawn(move || {
        // A job that panics in a pool of Rayon ends the process.
        let result = catch_unwind(AssertUnwindSafe(|| work(&work_job)));
        drop(sender.send(result.map_or(WorkMessage::Panicked, WorkMessage::Done)));
    });
    let result = wait(py, progress, receiver, || {
        if end.is_some_and(|end| Instant::now() >= end) {
            job.finish();
        }
    });
    if result.is_ok() {
        // The work is over, and there is nothing left to cancel.
        std::mem::forget(guard);
    }
    result
}

/// The memory limit of work. Determined once, since reading the system's files takes longer than some work.
fn memory_limit() -> Option<u64> {
    static LIMIT: OnceLock<Option<u64>> = OnceLock::new();
    *LIMIT.get_or_init(memory::default_limit)
}

/// The most points that are evaluated on the calling thread. Measured: that takes some microseconds, and
/// another thread would add fifty.
pub(crate) const FEW_POINTS: usize = 256;

/// Runs short work on this thread, without the GIL.
pub(crate) fn run_briefly<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| catch_unwind(AssertUnwindSafe(work))).map_err(|_| failure::internal(py, BROKEN))
}

/// Cancels the job if the caller leaves before its end.
struct CancelGuard<'a>(&'a Job);

impl Drop for CancelGuard<'_> {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

/// Waits for the result; `tick` is called every [`LOOK`].
fn wait<T: Send>(
    py: Python<'_>,
    mut progress: Option<ProgressListener>,
    mut messages: Receiver<WorkMessage<T>>,
    tick: impl Fn(),
) -> PyResult<T> {
    let first = progress.as_ref().map(|listener| listener.last);
    if let (Some(listener), Some(first)) = (&mut progress, first) {
        listener.report(py, first)?;
    }
    loop {
        // Without the GIL, for which the work itself may wait: it calls the Python functions in a shape.
        let update = py.detach(|| next_update(&mut messages));
        if let Some(listener) = &mut progress {
            listener.update(py, update.progress)?;
        }
        match update.end {
            Some(Ok(result)) => {
                if let (Some(listener), Some(first)) = (&mut progress, first) {
                    listener.report(py, Progress { done: first.total, ..first })?;
                }
                return Ok(result);
            }
            Some(Err(WorkPanic)) => return Err(failure::internal(py, BROKEN)),
            None => {
                tick();
                py.check_signals()?;
            }
        }
    }
}

/// The message if the work panics.
const BROKEN: &str = "this is a bug in the library; please report it with the call that led to it";

/// The messages since the last update.
struct WorkUpdate<T> {
    /// The last progress.
    progress: Option<Progress>,
    /// The result.
    end: Option<Result<T, WorkPanic>>,
}

/// The work panicked.
struct WorkPanic;

/// The first message. It is polled for a while first, since waking a sleeping thread takes longer.
/// `Err(true)` means that the work is gone, `Err(false)` that there is no message yet.
fn first_message<T>(messages: &Receiver<WorkMessage<T>>) -> Result<WorkMessage<T>, bool> {
    let start = Instant::now();
    while start.elapsed() < AWAKE {
        match messages.try_recv() {
            Ok(message) => return Ok(message),
            Err(TryRecvError::Disconnected) => return Err(true),
            // The working thread may be waiting for this very processor.
            Err(TryRecvError::Empty) => std::thread::yield_now(),
        }
    }
    messages.recv_timeout(LOOK).map_err(|error| error == RecvTimeoutError::Disconnected)
}

/// Collects all messages so far; waits at most [`LOOK`] for the first.
fn next_update<T>(messages: &mut Receiver<WorkMessage<T>>) -> WorkUpdate<T> {
    let mut update = WorkUpdate { progress: None, end: None };
    let mut next = first_message(messages);
    loop {
        match next {
            Ok(WorkMessage::Progress(progress)) => update.progress = Some(progress),
            Ok(WorkMessage::Done(result)) => update.end = Some(Ok(result)),
            Ok(WorkMessage::Panicked) | Err(true) => update.end = Some(Err(WorkPanic)),
            Err(false) => return update,
        }
        if update.end.is_some() {
            return update;
        }
        next = messages.try_recv().map_err(|error| error == TryRecvError::Disconnected);
    }
}
