//! `JobError`: why exact work, which has no bound, gave no result.
use super::{Failure, Refusal, Spell, Spelling};
use std::fmt;

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
