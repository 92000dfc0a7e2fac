//! `run`: long work without Python's lock, which Ctrl-C ends and which reports to a Python function.
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

/// How often a waiting thread looks whether somebody wants to stop; a fifth of the tenth of a second in which
/// Ctrl-C has to be obeyed.
const LOOK: Duration = Duration::from_millis(20);

/// For how long a waiting thread looks before it sleeps: about what it takes to wake one, measured. Nothing in a wait of
/// [`LOOK`].
const AWAKE: Duration = Duration::from_micros(50);

/// After so long without a word from the work the last one is said again: who waits sees that it goes on. Chosen.
const SILENCE: Duration = Duration::from_secs(1);

/// A Python function that is told of progress.
pub(crate) struct ProgressListener {
    function: Py<PyAny>,
    /// What was said last; at first the verb, with nothing done.
    last: Progress,
    said: Instant,
}

impl ProgressListener {
    /// A listener, which knows the work as `verb` until it says more itself.
    pub(crate) fn new(function: Option<Py<PyAny>>, verb: &'static str) -> Option<Self> {
        let last = Progress { stage: verb, done: 0, total: 1 };
        function.map(|function| Self { function, last, said: Instant::now() })
    }

    /// Calls the function.
    fn tell(&mut self, py: Python<'_>, told: Progress) -> PyResult<()> {
        (self.last, self.said) = (told, Instant::now());
        self.function.call1(py, (told.stage, told.done, told.total)).map(drop)
    }

    /// Passes news on, and where there are none for long says the last again.
    fn pass_on(&mut self, py: Python<'_>, news: Option<Progress>) -> PyResult<()> {
        match news {
            Some(told) => self.tell(py, told),
            None if self.said.elapsed() >= SILENCE => self.tell(py, self.last),
            None => Ok(()),
        }
    }
}

/// What comes from the work.
enum WorkMessage<T> {
    Progress(Progress),
    Done(T),
    Broken,
}

/// Runs `work` on the threads of this process and waits for it without Python's lock.
///
/// Python's signal handlers run meanwhile, every [`LOOK`]. If one raises, or the function for progress does,
/// that exception comes back at once and unchanged; the work is told to stop and ends by itself, on what it
/// owns. Progress is told from the thread that called: the verb at the start and at the end, what the work says in between (of
/// steps that follow each other closely the last), and the last again where the work says nothing for [`SILENCE`].
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<ProgressListener>,
    work: impl FnOnce(&Job) -> T + Send + 'static,
) -> PyResult<T> {
    run_within(py, progress, None, work)
}

/// The same for work that is told to end with the best that it has after so long. The thread that waits looks at the clock,
/// so that no other is needed.
pub(crate) fn run_within<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<ProgressListener>,
    within: Option<Duration>,
    work: impl FnOnce(&Job) -> T + Send + 'static,
) -> PyResult<T> {
    // A time beyond what the clock can tell never comes.
    let end = within.and_then(|within| Instant::now().checked_add(within));
    let pool = pool(py).map_err(|error| failure::internal(py, &format!("no threads: {error}")))?;
    let (sender, receiver) = channel();
    let mut job = Job::default();
    job.memory_limit = memory_limit().unwrap_or(job.memory_limit);
    if progress.is_some() {
        let sender = sender.clone();
        // Nobody listens any more once a caller has left.
        job = job.with_progress(move |progress| drop(sender.send(WorkMessage::Progress(progress))));
    }
    let on_leaving = CancelGuard(&job);
    let own = job.clone();
    pool.spawn(move || {
        let done = catch_unwind(AssertUnwindSafe(|| work(&own)));
        drop(sender.send(done.map_or(WorkMessage::Broken, WorkMessage::Done)));
    });
    let done = wait(py, progress, receiver, || {
        if end.is_some_and(|end| Instant::now() >= end) {
            job.finish();
        }
    });
    if done.is_ok() {
        std::mem::forget(on_leaving);
    }
    done
}

/// The memory that work may take. The system is asked once: its files take longer to read than many a piece of work.
fn memory_limit() -> Option<u64> {
    static LIMIT: OnceLock<Option<u64>> = OnceLock::new();
    *LIMIT.get_or_init(memory::default_limit)
}

/// Points that a call evaluates on the thread that calls: some microseconds of work, to which the way to another thread
/// and back would add fifty.
pub(crate) const FEW_POINTS: usize = 256;

/// Runs what is done at once, without Python's lock, on this thread.
pub(crate) fn run_briefly<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| catch_unwind(AssertUnwindSafe(work))).map_err(|_| failure::internal(py, BROKEN))
}

/// Cancels the job of whoever leaves before its end.
struct CancelGuard<'a>(&'a Job);

impl Drop for CancelGuard<'_> {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

/// Waits for the result; `look` is called every [`LOOK`].
fn wait<T: Send>(
    py: Python<'_>,
    mut progress: Option<ProgressListener>,
    mut messages: Receiver<WorkMessage<T>>,
    look: impl Fn(),
) -> PyResult<T> {
    let begun = progress.as_ref().map(|listener| listener.last);
    if let (Some(listener), Some(begun)) = (&mut progress, begun) {
        listener.tell(py, begun)?;
    }
    loop {
        let news = py.detach(|| next_update(&mut messages));
        if let Some(listener) = &mut progress {
            listener.pass_on(py, news.progress)?;
        }
        match news.end {
            Some(Ok(done)) => {
                if let (Some(listener), Some(begun)) = (&mut progress, begun) {
                    listener.tell(py, Progress { done: begun.total, ..begun })?;
                }
                return Ok(done);
            }
            Some(Err(WorkPanic)) => return Err(failure::internal(py, BROKEN)),
            None => {
                look();
                py.check_signals()?;
            }
        }
    }
}

const BROKEN: &str =
    "the library broke a promise that it makes to itself; please report what was asked of it";

/// What has come since the last time.
struct WorkUpdate<T> {
    /// The last that was told of progress.
    progress: Option<Progress>,
    /// The result.
    end: Option<Result<T, WorkPanic>>,
}

/// The work panicked.
struct WorkPanic;

/// The first message; a thread that sleeps is woken later than one that looks, so it looks for a while first.
fn first_message<T>(messages: &Receiver<WorkMessage<T>>) -> Result<WorkMessage<T>, bool> {
    let begun = Instant::now();
    while begun.elapsed() < AWAKE {
        match messages.try_recv() {
            Ok(message) => return Ok(message),
            Err(TryRecvError::Disconnected) => return Err(true),
            // The thread that works may be waiting for this very processor.
            Err(TryRecvError::Empty) => std::thread::yield_now(),
        }
    }
    messages.recv_timeout(LOOK).map_err(|error| error == RecvTimeoutError::Disconnected)
}

/// Waits for news, but not for long.
fn next_update<T>(messages: &mut Receiver<WorkMessage<T>>) -> WorkUpdate<T> {
    let mut news = WorkUpdate { progress: None, end: None };
    let mut next = first_message(messages);
    loop {
        match next {
            Ok(WorkMessage::Progress(told)) => news.progress = Some(told),
            Ok(WorkMessage::Done(done)) => news.end = Some(Ok(done)),
            Ok(WorkMessage::Broken) | Err(true) => news.end = Some(Err(WorkPanic)),
            Err(false) => return news,
        }
        if news.end.is_some() {
            return news;
        }
        next = messages.try_recv().map_err(|error| error == TryRecvError::Disconnected);
    }
}
