//! Bytes to nouns and back: every reader takes [`Limits`] and ends in a shape, a shape with listed warnings, or one
//! [`ReadError`] that names the place. No paths, no network, no panic.
mod assemble;
pub mod bpt;
mod certificate;
mod drawing;
mod error;
mod faces;
mod format;
pub mod glb;
mod groups;
mod grow;
mod json;
mod limits;
mod losses;
pub mod nii;
pub mod npy;
pub mod nrrd;
mod number;
pub mod obj;
mod placed;
pub mod ply;
pub mod png;
mod polygons;
mod read;
mod scene;
pub mod shape_json;
mod snap;
pub mod stl;
pub mod svg;
pub mod teaset;
mod text;
pub mod tiles;
pub mod vm;
mod volume;
mod warnings;
mod words;

pub use drawing::{Curves, Drawing, Drawn, Element, Polylines};
pub use error::{Place, ReadError, Warning, WriteError};
pub use format::{Format, UnknownFormat};
pub use limits::Limits;
pub use losses::{losses, losses_of_polygons};
pub use polygons::{PolygonSurface, Polygons};
pub use read::read;
pub use scene::{Axis, Content, Frame, Loaded, Node, Part, Scene};
pub use snap::{Snapped, TooWide, snap, worst_snap};
pub use volume::Volume;

/// The example of the page in `docs/` runs with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/tiles.md")]
struct Tiles;
