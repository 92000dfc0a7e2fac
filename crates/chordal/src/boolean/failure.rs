//! `BooleanError`: the reason why there is no boolean.
use crate::budget::JobError;
use std::fmt;

/// The reason why there is no boolean.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BooleanError {
    /// An operand, counted from 0, bounds no solid.
    NotClosed {
        /// The operand: 0 is the first mesh, 1 that of the first step.
        operand: usize,
        /// Edges with one triangle.
        boundary_edges: u64,
    },
    /// The work was refused or cancelled.
    Stopped(JobError),
}

impl From<JobError> for BooleanError {
    fn from(stopped: JobError) -> Self {
        Self::Stopped(stopped)
    }
}

impl fmt::Display for BooleanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotClosed { operand, boundary_edges: 0 } => {
                write!(
                    f,
                    "operand {operand} bounds no solid: some edge has unequal numbers of faces in its two directions"
                )
            }
            Self::NotClosed { operand, boundary_edges } => {
                write!(f, "operand {operand} bounds no solid: {boundary_edges} edges have one triangle only")
            }
            Self::Stopped(stopped) => stopped.fmt(f),
        }
    }
}

impl std::error::Error for BooleanError {}
