//! 3D Tiles 1.1: a tree of tiles, each with a bounding box, a geometric error in metres and a file with its
//! content.
mod bounds;
mod content;
mod geo_place;
mod merge;
pub(crate) mod old_tile;
mod parse;
mod read;
pub(crate) mod scene;
mod subtree;
mod tileset;
mod write;

pub use crate::files::FileOpener;
pub use bounds::{aligned_box, content_bounds};
pub use content::content;
pub use geo_place::GeoPlace;
pub use read::read;
pub use tileset::{BoundingVolume, ImplicitTiling, Refine, Subdivision, Tile, Tileset};
pub use write::{InvalidTileset, TileFault, write};
