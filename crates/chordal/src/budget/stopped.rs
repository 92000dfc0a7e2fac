//! `Stopped`: why exact work (nothing lost, so no bound) gave no result.
use super::{Failure, Refusal};
use std::fmt;

/// The ways in which a [`Job`](super::Job) ends without a result where no budget is involved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// The work was not started, or not finished, for this reason.
    Refused(Refusal),
    /// The job was asked to stop.
    Cancelled,
}

impl<T> From<Stopped> for Failure<T> {
    fn from(stopped: Stopped) -> Self {
        match stopped {
            Stopped::Refused(refusal) => Self::Refused(refusal),
            Stopped::Cancelled => Self::Cancelled,
        }
    }
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(refusal) => f.write_str(&refusal.message),
            Self::Cancelled => f.write_str("cancelled"),
        }
    }
}

impl std::error::Error for Stopped {}
