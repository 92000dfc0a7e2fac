//! Error budgets and bounds: the error that is allowed ([`Budget`]), the error that was made ([`Bound`]), and
//! the conditions of a run ([`Job`]); and what a caller sets or is told ([`Setting`], [`Message`]).
mod bound;
mod bounded;
mod cure;
mod error_limit;
mod job;
mod job_error;
mod length;
mod lens;
mod limits;
mod message;
mod parallel;
mod setting;
mod tolerance;
mod view;

pub use bound::{Bound, Evidence, Metric, Reference};
pub use bounded::{Bounded, Failure, Refusal, RefusalCode};
pub use cure::Cure;
pub(crate) use error_limit::ErrorLimit;
pub use job::{Job, Progress};
pub use job_error::JobError;
pub use length::{InvalidLength, Length, Unit};
pub use lens::{Lens, PixelScale};
pub use limits::{Budget, PixelBudget, RequiredEvidence, UnknownRequirement};
pub use message::{Message, Spell, Spelling};
pub use parallel::par_map;
pub(crate) use parallel::par_map_owned;
pub use setting::Setting;
pub use tolerance::{InvalidTolerance, Tolerance, digits};
pub use view::{Camera, InvalidView, MinDistanceView, Pixels, Projection, Screen, View};
