//! `Bounded`: a shape with a bound on its error, and the reasons why there may be none.
use super::{Bound, Message, Spell, Spelling};
use std::fmt;

/// The return value of every lossy arrow.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounded<T> {
    /// The result.
    pub shape: T,
    /// How far the result is from the true shape.
    pub bound: Bound,
}

impl<T> Bounded<T> {
    /// Converts the shape and keeps the bound; `f` must not add an error.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Bounded<U> {
        Bounded { shape: f(self.shape), bound: self.bound }
    }

    /// The result of an arrow: itself if the budget is met, else [`Failure::Unmet`] with it.
    ///
    /// # Errors
    /// If the budget is not met.
    pub(crate) fn met_if(self, is_met: bool) -> Result<Self, Failure<T>> {
        if is_met { Ok(self) } else { Err(Failure::Unmet(Box::new(self))) }
    }
}

/// Why there is no result that meets the budget.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure<T> {
    /// The budget was not met; this is the best result.
    Unmet(Box<Bounded<T>>),
    /// The work was not started or not finished, for this reason.
    Refused(Refusal),
    /// The job was cancelled.
    Cancelled,
}

/// A reason for refusing work, with a stable code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// A stable code, for programs.
    pub code: RefusalCode,
    /// One sentence, for people.
    pub message: Message,
}

impl Refusal {
    /// A refusal with a message of one sentence.
    pub fn new(code: RefusalCode, message: impl Into<Message>) -> Self {
        Self { code, message: message.into() }
    }
}

impl Spell for Refusal {
    fn spell(&mut self, spelling: &dyn Spelling) {
        self.message.spell(spelling);
    }
}

/// Stable names of the reasons for a [`Refusal`]. A released code keeps its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RefusalCode {
    /// The budget has no limit, or one that this arrow cannot honour.
    Budget,
    /// The budget needs more triangles than the job allows.
    TooManyTriangles,
    /// The budget needs more memory than the job allows.
    TooMuchMemory,
    /// A number of the input is NaN or infinite, or becomes so on the way.
    NotFinite,
    /// The input is empty.
    Empty,
    /// The budget is smaller than the error of the input's own rounding.
    BelowPrecision,
    /// The floating-point environment flushes subnormals, so nothing can be proved.
    FlushesSubnormals,
    /// The shape comes so close to the eye that no pixel bound exists.
    TooClose,
    /// This kind of shape does not support the operation.
    Unsupported,
    /// A function supplied by the user failed.
    LeafFailed,
    /// The request has no meaning for this shape, or is incomplete.
    Usage,
}

impl RefusalCode {
    /// The stable text.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Budget => "budget",
            Self::TooManyTriangles => "too-many-triangles",
            Self::TooMuchMemory => "too-much-memory",
            Self::NotFinite => "not-finite",
            Self::Empty => "empty",
            Self::BelowPrecision => "below-precision",
            Self::FlushesSubnormals => "flushes-subnormals",
            Self::TooClose => "too-close",
            Self::Unsupported => "unsupported",
            Self::LeafFailed => "leaf-failed",
            Self::Usage => "usage",
        }
    }
}

impl<T> Failure<T> {
    /// A refusal with a message of one sentence.
    pub fn refused(code: RefusalCode, message: impl Into<Message>) -> Self {
        Self::Refused(Refusal::new(code, message))
    }

    /// The best result, even if it misses the budget.
    ///
    /// # Errors
    /// When there is no result at all.
    pub fn best_effort(self) -> Result<Bounded<T>, JobError> {
        match self {
            Self::Unmet(best) => Ok(*best),
            Self::Refused(refusal) => Err(JobError::Refused(refusal)),
            Self::Cancelled => Err(JobError::Cancelled),
        }
    }

    /// The stable code: that of the refusal, `unmet` or `cancelled`.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Unmet(_) => "unmet",
            Self::Refused(refusal) => refusal.code.as_str(),
            Self::Cancelled => "cancelled",
        }
    }
}

impl<T> fmt::Display for Failure<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unmet(best) => write!(f, "the budget was not met; the best reached is {}", best.bound),
            Self::Refused(refusal) => f.write_str(&refusal.message),
            Self::Cancelled => f.write_str("cancelled"),
        }
    }
}

impl<T: fmt::Debug> std::error::Error for Failure<T> {}

/// The reasons why a [`Job`](super::Job) without a budget ends without a result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobError {
    /// The work was not started or not finished, for this reason.
    Refused(Refusal),
    /// The job was cancelled.
    Cancelled,
}

impl<T> From<JobError> for Failure<T> {
    fn from(stopped: JobError) -> Self {
        match stopped {
            JobError::Refused(refusal) => Self::Refused(refusal),
            JobError::Cancelled => Self::Cancelled,
        }
    }
}

impl Spell for JobError {
    fn spell(&mut self, spelling: &dyn Spelling) {
        match self {
            Self::Refused(refusal) => refusal.spell(spelling),
            Self::Cancelled => {}
        }
    }
}

impl fmt::Display for JobError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(refusal) => f.write_str(&refusal.message),
            Self::Cancelled => f.write_str("cancelled"),
        }
    }
}

impl std::error::Error for JobError {}
