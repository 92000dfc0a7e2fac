//! `Job`: the conditions under which long work runs: cancellation, progress, threads, memory.
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The progress of a job: `done` of `total` steps of the named stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The current stage, as in "tessellate".
    pub stage: &'static str,
    /// Finished steps.
    pub done: u64,
    /// Total steps.
    pub total: u64,
}

/// How much work may go into a proof that is tried once the result is there
/// ([`ProvedOrMeasured`](super::RequiredEvidence)).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProofEffort {
    /// About as much as the result itself took, and some seconds at least. Work is counted in evaluations
    /// instead of time, so that the same input gets the same proof everywhere.
    #[default]
    Share,
    /// As much as it needs.
    Full,
}

/// The number of evaluations so far, and the largest number allowed.
#[derive(Debug)]
struct WorkLimit {
    done: AtomicU64,
    limit: u64,
    /// The limit of the larger work that this is a part of.
    parent: Option<Arc<WorkLimit>>,
}

impl WorkLimit {
    fn remaining(&self) -> u64 {
        self.limit.saturating_sub(self.done.load(Ordering::Relaxed))
    }

    fn is_used_up(&self) -> bool {
        self.done.load(Ordering::Relaxed) > self.limit
    }
}

/// A limit and all limits that contain it, from the inside out.
fn with_ancestors(work: Option<&Arc<WorkLimit>>) -> impl Iterator<Item = &WorkLimit> {
    std::iter::successors(work.map(Arc::as_ref), |limit| limit.parent.as_deref())
}

type ProgressSink = Arc<dyn Fn(Progress) + Send + Sync>;

/// The conditions of a long-running call. The default never cancels, reports nothing, uses every thread and
/// sets no limit below the library's own.
///
/// The result of a job never depends on `threads`.
#[derive(Clone)]
pub struct Job {
    cancel: Arc<AtomicBool>,
    finish: Arc<AtomicBool>,
    progress: Option<ProgressSink>,
    work: Option<Arc<WorkLimit>>,
    /// How much work a proof may take before a measurement replaces it.
    pub proof_effort: ProofEffort,
    /// Number of threads; 0 means all that the machine offers.
    pub threads: usize,
    /// Approximate limit on the bytes that the job's results hold at once; work that would need more is
    /// refused before it starts.
    pub memory_limit: u64,
    /// Limit on the triangles of a result; a budget that would need more is refused before work starts.
    pub triangle_limit: u64,
}

impl Default for Job {
    fn default() -> Self {
        Self {
            cancel: Arc::default(),
            finish: Arc::default(),
            progress: None,
            work: None,
            proof_effort: ProofEffort::default(),
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

    /// Asks the job, from any thread, to end soon with its best result so far; its bound says how much is
    /// known of the error. Only meshing of fields heeds it; other work runs to its end. The result depends on
    /// the time of the call.
    pub fn finish(&self) {
        self.finish.store(true, Ordering::Relaxed);
    }

    /// The flag behind [`Job::finish`], for a timer.
    #[must_use]
    pub fn finish_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.finish)
    }

    /// Whether [`Job::finish`] was called.
    #[must_use]
    pub fn is_finishing(&self) -> bool {
        self.finish.load(Ordering::Relaxed)
    }

    /// The same job with a limit for a part of its work: it ends after about `most` evaluations, one for each
    /// point, as proofs and the comparisons of [`check`](crate::check) count them, and returns the bound
    /// reached by then, which holds. Evaluations also count towards the limit of this job; if that is used up
    /// or the job is cancelled, the part ends too.
    ///
    /// ```
    /// use chordal::Job;
    /// assert_eq!(Job::default().with_work_limit(1 << 20).work_left(), 1 << 20);
    /// assert_eq!(Job::default().work_left(), u64::MAX);
    /// ```
    #[must_use]
    pub fn with_work_limit(&self, most: u64) -> Self {
        let work = WorkLimit { done: AtomicU64::new(0), limit: most, parent: self.work.clone() };
        Self { work: Some(Arc::new(work)), ..self.clone() }
    }

    /// Counts evaluations. Call it only when no other thread evaluates for the same part: the work ends by this
    /// count, which must not depend on the timing of threads.
    pub(crate) fn count_work(&self, n: u64) {
        with_ancestors(self.work.as_ref()).for_each(|work| {
            work.done.fetch_add(n, Ordering::Relaxed);
        });
    }

    /// The number of evaluations left of those that [`Job::with_work_limit`] allows.
    #[must_use]
    pub fn work_left(&self) -> u64 {
        with_ancestors(self.work.as_ref()).map(WorkLimit::remaining).min().unwrap_or(u64::MAX)
    }

    /// Whether the current work should end with its best result: its evaluations are used up, or the job is
    /// to finish.
    pub(crate) fn is_over(&self) -> bool {
        self.is_finishing() || with_ancestors(self.work.as_ref()).any(WorkLimit::is_used_up)
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
            .field("finishing", &self.is_finishing())
            .field("threads", &self.threads)
            .field("memory_limit", &self.memory_limit)
            .field("triangle_limit", &self.triangle_limit)
            .finish_non_exhaustive()
    }
}
