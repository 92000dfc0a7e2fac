//! `Job`: the conditions under which long work runs: cancellation, progress, threads, memory.
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The progress of a job: `done` of `total` steps of the named stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is being done, as in "tessellate".
    pub stage: &'static str,
    /// Steps that are done.
    pub done: u64,
    /// Steps in all.
    pub total: u64,
}

type ProgressSink = Arc<dyn Fn(Progress) + Send + Sync>;

/// The conditions of a long-running call. The default never cancels, reports nothing, uses every thread and
/// sets no limit below the library's own.
///
/// The result of a job never depends on `threads`.
#[derive(Clone)]
pub struct Job {
    cancel: Arc<AtomicBool>,
    progress: Option<ProgressSink>,
    /// Number of threads; 0 means all that the machine offers.
    pub threads: usize,
    /// Approximate limit on the bytes held at once for what the job builds; work that would need more is
    /// refused before it starts.
    pub memory_limit: u64,
    /// Limit on the triangles of a result; a budget that would need more is refused before work starts.
    pub triangle_limit: u64,
}

impl Default for Job {
    fn default() -> Self {
        Self {
            cancel: Arc::default(),
            progress: None,
            threads: 0,
            memory_limit: 64 << 30,
            triangle_limit: 200_000_000,
        }
    }
}

impl Job {
    /// The same job with a sink for progress; it is called from worker threads.
    #[must_use]
    pub fn with_progress(mut self, sink: impl Fn(Progress) + Send + Sync + 'static) -> Self {
        self.progress = Some(Arc::new(sink));
        self
    }

    /// The same job on `threads` threads (0: all).
    #[must_use]
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = threads;
        self
    }

    /// Cancels the job, from any thread; it stops soon.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// The flag behind [`Job::cancel`], for a signal handler.
    #[must_use]
    pub fn cancel_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.cancel)
    }

    /// Whether the job was cancelled.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// Passes `progress` to the sink, if there is one.
    pub fn report(&self, progress: Progress) {
        if let Some(sink) = &self.progress {
            sink(progress);
        }
    }
}

impl fmt::Debug for Job {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Job")
            .field("cancelled", &self.is_cancelled())
            .field("threads", &self.threads)
            .field("memory_limit", &self.memory_limit)
            .field("triangle_limit", &self.triangle_limit)
            .finish_non_exhaustive()
    }
}
