//! The toll: what may be lost ([`Budget`]), what was lost ([`Bound`]), and under which conditions work runs ([`Job`]).
mod allowed;
mod bound;
mod bounded;
mod job;
mod length;
mod lens;
mod limits;
mod parallel;
mod stopped;
mod tolerance;
mod view;

pub(crate) use allowed::Allowed;
pub use bound::{Bound, Evidence, Metric, Reference};
pub use bounded::{Bounded, Code, Failure, Refusal};
pub use job::{Job, Progress};
pub use length::{InvalidLength, Length, Unit};
pub use lens::{Lens, Sight};
pub use limits::{Budget, PixelBudget, Require, UnknownRequirement};
pub use parallel::par_map;
pub(crate) use parallel::par_map_owned;
pub use stopped::Stopped;
pub use tolerance::{InvalidTolerance, Tolerance};
pub use view::{Camera, Closest, InvalidView, Pixels, Projection, Screen, View};
