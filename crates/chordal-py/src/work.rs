//! `run`: long work without Python's lock, which Ctrl-C ends and which reports to a Python function.
use crate::failure;
use crate::pool::pool;
use chordal::Job;
use chordal::budget::Progress;
use chordal_cli::memory;
use pyo3::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, channel};
use std::time::Duration;

/// How often a waiting thread looks whether somebody wants to stop; a fifth of the tenth of a second in which Ctrl-C
/// has to be obeyed.
const LOOK: Duration = Duration::from_millis(20);

/// What comes from the work.
enum Message<T> {
    Progress(Progress),
    Done(T),
    Broken,
}

/// Runs `work` on the threads of this process and waits for it without Python's lock.
///
/// Python's signal handlers run meanwhile, every [`LOOK`]. If one raises, or the function for progress does, that
/// exception comes back at once and unchanged; the work is told to stop and ends by itself, on what it owns.
/// Progress is told from the thread that called; of steps that follow each other closely, the last.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Job) -> T + Send + 'static,
) -> PyResult<T> {
    let pool = pool(py).map_err(|error| failure::internal(py, &format!("no threads: {error}")))?;
    let (sender, receiver) = channel();
    let mut job = Job::default();
    job.memory_limit = memory::share().unwrap_or(job.memory_limit);
    if progress.is_some() {
        let sender = sender.clone();
        // Nobody listens any more once a caller has left.
        job = job.with_progress(move |progress| drop(sender.send(Message::Progress(progress))));
    }
    let on_leaving = Cancel(&job);
    let own = job.clone();
    pool.spawn(move || {
        let done = catch_unwind(AssertUnwindSafe(|| work(&own)));
        drop(sender.send(done.map_or(Message::Broken, Message::Done)));
    });
    let done = wait(py, progress, receiver);
    if done.is_ok() {
        std::mem::forget(on_leaving);
    }
    done
}

/// Cancels the job of whoever leaves before its end.
struct Cancel<'a>(&'a Job);

impl Drop for Cancel<'_> {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

fn wait<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    mut messages: Receiver<Message<T>>,
) -> PyResult<T> {
    loop {
        let news = py.detach(|| news(&mut messages));
        if let (Some(sink), Some(told)) = (&progress, news.progress) {
            sink.call1(py, (told.stage, told.done, told.total))?;
        }
        match news.end {
            Some(Ok(done)) => return Ok(done),
            Some(Err(Broken)) => return Err(failure::internal(py, BROKEN)),
            None => py.check_signals()?,
        }
    }
}

const BROKEN: &str =
    "the library broke a promise that it makes to itself; please report what was asked of it";

/// What has come since the last time.
struct News<T> {
    /// The last that was told of progress.
    progress: Option<Progress>,
    /// The result.
    end: Option<Result<T, Broken>>,
}

/// The work panicked.
struct Broken;

/// Waits for news, but not for long.
fn news<T>(messages: &mut Receiver<Message<T>>) -> News<T> {
    let mut news = News { progress: None, end: None };
    let mut next = messages.recv_timeout(LOOK).map_err(|error| error == RecvTimeoutError::Disconnected);
    loop {
        match next {
            Ok(Message::Progress(told)) => news.progress = Some(told),
            Ok(Message::Done(done)) => news.end = Some(Ok(done)),
            Ok(Message::Broken) | Err(true) => news.end = Some(Err(Broken)),
            Err(false) => return news,
        }
        if news.end.is_some() {
            return news;
        }
        next = messages.try_recv().map_err(|error| error == TryRecvError::Disconnected);
    }
}
