//! `MeshFailure`: why a verb returned no result within the budget.
use crate::MeshOutcome;
use crate::report::{OpenPlacesFacts, Output};
use chordal::budget::advice::Message;
use chordal::budget::proof::OpenPlaces;
use chordal::budget::{Failure, InvalidLength, JobError, Refusal, RefusalCode};
use chordal_io::{CoordinateOverflow, WriteError};
use std::fmt;

/// Why a verb returned no result within the budget.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshFailure {
    /// The length has no meaning for this shape.
    Length(InvalidLength),
    /// The request has no meaning for this shape.
    Usage(Message),
    /// The budget was not met; this is the best result that was reached.
    Unmet(Box<MeshOutcome>),
    /// The work was refused or stopped, for this reason.
    Refused(Refusal),
    /// A coordinate does not fit the format.
    TooWide(CoordinateOverflow),
    /// The job was asked to stop.
    Cancelled,
}

impl MeshFailure {
    /// A refusal with a stable code and one sentence.
    pub(crate) fn refused(code: RefusalCode, message: impl Into<Message>) -> Self {
        Self::Refused(Refusal::new(code, message))
    }

    /// For results that are useless outside the budget: turns the miss into a refusal whose sentence starts with `what`.
    pub(crate) fn from_missed<T>(failure: Failure<T>, what: &str) -> Self {
        match failure {
            Failure::Unmet(best) => Self::refused(RefusalCode::Budget, format!("{what}{}", best.bound)),
            Failure::Refused(refusal) => Self::Refused(refusal),
            Failure::Cancelled => Self::Cancelled,
        }
    }

    /// Its sentence, with the settings that it mentions.
    pub(crate) fn message(&self) -> Message {
        match self {
            Self::Length(why) => why.message(),
            Self::Usage(why) => why.clone(),
            Self::Refused(refusal) => refusal.message.clone(),
            Self::Unmet(_) | Self::TooWide(_) | Self::Cancelled => self.to_string().into(),
        }
    }

    /// A stable code, for programs.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Length(_) => "length",
            Self::Usage(_) => "usage",
            Self::Unmet(_) => "unmet",
            Self::Refused(refusal) => refusal.code.as_str(),
            Self::TooWide(_) => "too-wide",
            Self::Cancelled => "cancelled",
        }
    }

    /// The exit code of a command: 2 usage, 3 input, 4 output, 5 budget, 130 interrupted.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Length(_) | Self::Usage(_) | Self::Refused(Refusal { code: RefusalCode::Usage, .. }) => 2,
            Self::Refused(Refusal {
                code: RefusalCode::NotFinite | RefusalCode::Empty | RefusalCode::Unsupported,
                ..
            }) => 3,
            Self::TooWide(_) => 4,
            Self::Unmet(_) | Self::Refused(_) => 5,
            Self::Cancelled => 130,
        }
    }
}

/// The transforms of a scene cannot be applied.
impl From<WriteError> for MeshFailure {
    fn from(error: WriteError) -> Self {
        Self::refused(RefusalCode::Unsupported, error.to_string())
    }
}

impl From<JobError> for MeshFailure {
    fn from(stopped: JobError) -> Self {
        match stopped {
            JobError::Refused(refusal) => Self::Refused(refusal),
            JobError::Cancelled => Self::Cancelled,
        }
    }
}

impl From<CoordinateOverflow> for MeshFailure {
    fn from(overflow: CoordinateOverflow) -> Self {
        Self::TooWide(overflow)
    }
}

impl fmt::Display for MeshFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(why) => why.fmt(f),
            Self::Usage(why) => why.fmt(f),
            Self::Unmet(best) => {
                let output = match best.certificate.output {
                    Some(Output::Polylines(lines)) => format!("{} segments", lines.segments),
                    Some(Output::Polygons(polygons)) => format!("{} faces", polygons.faces),
                    Some(Output::Triangles(mesh)) => format!("{} triangles", mesh.triangles),
                    None => "nothing".to_owned(),
                };
                f.write_str("the budget was not met; the best reached is ")?;
                match (best.bound.at_most(), best.bound.at_least()) {
                    (Some(_), _) => write!(f, "{} with {output}", best.bound)?,
                    (None, least) if least > 0.0 => {
                        write!(f, "off by {least:.3e} or more, without an upper bound, with {output}")?;
                    }
                    _ => write!(f, "without an upper bound, with {output}")?,
                }
                let open = best.bound.open.as_deref();
                // A tangent contact is the reason; the worst place would add nothing.
                let at = best.bound.at.filter(|_| open.and_then(OpenPlaces::tangent).is_none());
                if let Some([x, y, z]) = at {
                    write!(f, "; the worst known place is about ({x:.4e}, {y:.4e}, {z:.4e})")?;
                }
                if let Some(open) = open {
                    write!(f, "; {}", OpenPlacesFacts::new(open).why_unproved())?;
                }
                best.certificate.stayed.iter().try_for_each(|why| write!(f, "; {why}"))
            }
            Self::Refused(refusal) => refusal.message.fmt(f),
            Self::TooWide(why) => why.fmt(f),
            Self::Cancelled => f.write_str("cancelled"),
        }
    }
}

impl std::error::Error for MeshFailure {}
