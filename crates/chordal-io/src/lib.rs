//! Bytes to nouns and back: every reader takes [`Limits`] and ends in a shape, a shape with listed warnings, or one
//! [`ReadError`] that names the place. No paths, no network, no panic.
mod error;
mod format;
pub mod glb;
mod limits;
mod scene;
mod snap;

pub use error::{Place, ReadError, Warning, WriteError};
pub use format::Format;
pub use limits::Limits;
pub use scene::{Axis, Content, Frame, Loaded, Node, Part, Scene};
pub use snap::{Snapped, TooWide, snap, worst_snap};
