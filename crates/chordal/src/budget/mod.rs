//! Error budgets and bounds: the allowed error ([`Budget`]), the error of a result ([`Bound`]), the
//! conditions of a run ([`Job`]), and the settings and messages of a caller ([`Setting`], [`Message`]).
mod attribute_limits;
mod bound;
mod bounded;
mod cure;
mod job;
mod length;
mod lens;
mod limits;
mod message;
mod open_places;
mod parallel;
mod setting;
mod tolerance;
mod view;

pub(crate) use attribute_limits::AttributeLimits;
pub use bound::{Bound, Evidence, Metric, Reference};
pub use bounded::{Bounded, Failure, JobError, Refusal, RefusalCode};
pub(crate) use cure::Cure;
pub(crate) use job::ProofEffort;
pub use job::{Job, Progress};
pub use length::{InvalidLength, Length, Unit};
pub(crate) use lens::{Lens, PixelScale};
pub(crate) use limits::ErrorLimit;
pub use limits::{Budget, PixelBudget, RequiredEvidence, UnknownRequirement};
pub(crate) use message::{Message, Spell, Spelling};
pub(crate) use open_places::{OpenPlace, OpenPlaces, SurfaceContact};
pub use parallel::par_map;
pub(crate) use parallel::{both, over_chunks, par_map_owned};
pub(crate) use setting::Setting;
pub use tolerance::{InvalidTolerance, Tolerance, digits};
pub(crate) use view::{Camera, MinDistanceView, Projection, Screen};
pub use view::{Pixels, View};

/// Messages that advise settings, which each front end spells in its own way.
pub mod advice {
    pub use super::cure::Cure;
    pub use super::message::{Message, Spell, Spelling};
    pub use super::setting::Setting;
}

/// Limits on the attributes of simplified meshes.
pub mod attributes {
    pub use super::attribute_limits::{AttributeLimits, InvalidAttributeLimit};
}

/// Cameras, and how large a length is on their screen.
pub mod camera {
    pub use super::lens::{Lens, PixelScale};
    pub use super::view::{Camera, InvalidView, MinDistanceView, Projection, Screen};
}

/// Proofs that are tried after a result is computed: how much work they may take, and which places stay open.
pub mod proof {
    pub use super::job::ProofEffort;
    pub use super::open_places::{OpenPlace, OpenPlaces, SurfaceContact};
}
