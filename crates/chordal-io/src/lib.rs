//! Readers and writers of shape files. Every reader takes [`Limits`] and returns a shape, a shape with listed
//! warnings, or one [`ReadError`] with its location. No paths, no network, no panics.
pub mod amf;
mod assemble;
mod assets;
pub mod bpt;
mod certificate;
pub mod dicom;
mod drawing;
mod error;
mod faces;
mod files;
mod forest;
mod format;
mod frame;
pub mod glb;
mod groups;
mod grow;
mod instances;
mod json;
mod limits;
mod losses;
pub mod mha;
pub mod nii;
pub mod npy;
pub mod nrrd;
mod number;
pub mod obj;
pub mod off;
pub mod ply;
pub mod png;
mod polygons;
mod read;
mod scene;
pub mod shape_json;
mod side_file;
mod single_precision;
mod snap;
pub mod stl;
pub mod svg;
pub mod teaset;
mod text;
pub mod threemf;
pub mod tiles;
mod unpack_cap;
mod unpacked;
mod used_assets;
pub mod vm;
mod volume;
pub mod vti;
pub mod vtk;
mod warnings;
mod word_reader;
mod write;
mod xml_elements;
mod xml_text;
mod zip;

pub use assets::{ImageContent, MATERIAL, PackedAccessor, SceneAssets, SceneImage};
pub use drawing::{Curves, Drawing, DrawingElement, PathSet, Polylines};
pub use error::{FileLocation, ReadError, Warning, WriteError};
pub use files::FileOpener;
pub use format::{Format, PositionPrecision, UnknownFormat, VertexRows};
pub use frame::{Axis, Frame, TextureOrigin};
pub use limits::{Conformance, Limits};
pub use losses::{losses, losses_of_polygons};
pub use polygons::{PolygonSurface, Polygons};
pub use read::{read, read_with};
pub use scene::{Content, Node, Part, ReadOutcome, Scene};
pub use side_file::{FileSet, SideFile, picture_extensions};
pub use snap::{CoordinateOverflow, SnappedMesh, snap, worst_snap};
pub use unpacked::unpacked;
pub use volume::Volume;
pub use write::{write, write_files, write_polygons, write_polygons_files, write_polylines, write_volume};

/// Runs the example of the page in `docs/` with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/tiles.md")]
struct Tiles;
