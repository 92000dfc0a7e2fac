//! Error budgets and bounds: the error that is allowed ([`Budget`]), the error that was made ([`Bound`]), and
//! the conditions of a run ([`Job`]).
mod bound;
mod bounded;
mod error_limit;
mod job;
mod job_error;
mod length;
mod lens;
mod limits;
mod parallel;
mod tolerance;
mod view;

pub use bound::{Bound, Evidence, Metric, Reference};
pub use bounded::{Bounded, Failure, Refusal, RefusalCode};
pub(crate) use error_limit::ErrorLimit;
pub use job::{Job, Progress};
pub use job_error::JobError;
pub use length::{InvalidLength, Length, Unit};
pub use lens::{Lens, PixelScale};
pub use limits::{Budget, PixelBudget, RequiredEvidence, UnknownRequirement};
pub use parallel::par_map;
pub(crate) use parallel::par_map_owned;
pub use tolerance::{InvalidTolerance, Tolerance, digits};
pub use view::{Camera, InvalidView, MinDistanceView, Pixels, Projection, Screen, View};
