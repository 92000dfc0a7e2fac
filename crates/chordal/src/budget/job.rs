//! `Job`: the conditions under which long work runs: cancellation, progress, threads, memory.
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

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

/// How far a proof is taken that is tried after the result is there ([`ProvedOrMeasured`](super::RequiredEvidence)).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProofEffort {
    /// About as far as the work goes that the result itself took, and some seconds at least. It is counted in evaluations
    /// and not by a clock, so that the same input has the same proof everywhere.
    #[default]
    Share,
    /// To its end.
    Full,
}

/// A limit of what may be evaluated, and what was.
#[derive(Debug)]
struct WorkLimit {
    done: AtomicU64,
    most: u64,
    /// Of what it is a part of.
    whole: Option<Arc<WorkLimit>>,
}

impl WorkLimit {
    fn left(&self) -> u64 {
        self.most.saturating_sub(self.done.load(Ordering::Relaxed))
    }

    fn is_used_up(&self) -> bool {
        self.done.load(Ordering::Relaxed) > self.most
    }
}

/// A limit, and those that it is a part of.
fn with_wholes(work: Option<&Arc<WorkLimit>>) -> impl Iterator<Item = &WorkLimit> {
    std::iter::successors(work.map(Arc::as_ref), |own| own.whole.as_deref())
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
    /// How far a proof is taken where a measurement would do.
    pub proof_effort: ProofEffort,
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

    /// Asks the job, from any thread, to end soon with the best that it has: a shape whose error is known as far as it is by
    /// then. Meshing of fields heeds it; other work goes on to its end. What it leads to depends on when it was called.
    pub fn finish(&self) {
        self.finish.store(true, Ordering::Relaxed);
    }

    /// The flag behind [`Job::finish`], for a timer.
    #[must_use]
    pub fn finish_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.finish)
    }

    /// Whether the job was asked to end with the best that it has.
    #[must_use]
    pub fn is_finishing(&self) -> bool {
        self.finish.load(Ordering::Relaxed)
    }

    /// The same job for a part of its work that ends after about so many evaluations of one point, as proofs and the judges of
    /// [`check`](crate::check) count them: then they say what is known by then, which holds. What it counts is counted
    /// for the job that it is of, too, with whose evaluations it ends, and it is cancelled with it.
    ///
    /// ```
    /// use chordal::Job;
    /// assert_eq!(Job::default().with_work_limit(1 << 20).work_left(), 1 << 20);
    /// assert_eq!(Job::default().work_left(), u64::MAX);
    /// ```
    #[must_use]
    pub fn with_work_limit(&self, most: u64) -> Self {
        let work = WorkLimit { done: AtomicU64::new(0), most, whole: self.work.clone() };
        Self { work: Some(Arc::new(work)), ..self.clone() }
    }

    /// Counts evaluations. To be called where no other thread evaluates for the same part: what follows depends on it.
    pub(crate) fn count_work(&self, n: u64) {
        with_wholes(self.work.as_ref()).for_each(|work| {
            work.done.fetch_add(n, Ordering::Relaxed);
        });
    }

    /// How many evaluations are left, of those that [`Job::with_work_limit`] allows.
    #[must_use]
    pub fn work_left(&self) -> u64 {
        with_wholes(self.work.as_ref()).map(WorkLimit::left).min().unwrap_or(u64::MAX)
    }

    /// Whether what is going on should end with what it has: it has used up its evaluations, or the job is to finish.
    pub(crate) fn is_over(&self) -> bool {
        self.is_finishing() || with_wholes(self.work.as_ref()).any(WorkLimit::is_used_up)
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
