//! Readers and writers of shape files. Every reader takes [`Limits`] and returns a shape, a shape with listed
//! warnings, or one [`ReadError`] with its location. No paths, no network, no panics.
pub mod amf;
mod assemble;
mod assets;
pub mod bpt;
mod certificate;
pub mod collada;
pub mod dicom;
mod drawing;
mod error;
mod faces;
mod files;
mod foreign;
mod forest;
mod format;
mod format_columns;
mod frame;
pub mod glb;
mod groups;
mod grow;
mod instances;
pub mod jpeg;
mod json;
mod limits;
mod losses;
mod marks;
mod matrix;
pub mod mha;
pub mod nii;
mod notes;
pub mod npy;
pub mod nrrd;
mod number;
pub mod obj;
pub mod off;
mod picture_format;
mod picture_size;
mod plain_text;
pub mod ply;
pub mod png;
mod polygons;
mod rare_value;
mod read;
mod scene;
pub mod shape_json;
mod short_decimal;
mod side_file;
mod single_precision;
pub mod slc;
mod snap;
mod snapped_mesh;
pub mod stl;
pub mod svg;
pub mod teaset;
mod text;
pub mod threemf;
pub mod tiles;
mod unknown_format;
mod unpack_cap;
mod unpacked;
pub mod usd;
mod used_assets;
pub mod vm;
mod volume;
pub mod vti;
pub mod vtk;
mod warnings;
pub mod webp;
mod word_reader;
mod worst_snap;
mod write;
mod xml_elements;
mod xml_text;
mod zip;

pub use assets::{FaceKind, ImageContent, MATERIAL, PackedAccessor, SceneAssets, SceneImage, plain_material};
pub use drawing::{Curves, Drawing, DrawingElement, PathSet, Polylines};
pub use error::{FileLocation, ReadError, Warning, WriteError};
pub use files::FileOpener;
pub use foreign::ForeignFormat;
pub use format::Format;
pub use format_columns::{PositionPrecision, VertexRows};
pub use frame::{Axis, Frame, TextureOrigin};
pub use limits::{Conformance, Limits};
pub use losses::{losses, losses_of_polygons};
pub use marks::Marks;
pub use picture_format::PictureFormat;
pub use polygons::{PolygonSurface, Polygons};
pub use rare_value::{RareValue, UsualValue};
pub use read::{read, read_with};
pub use scene::{Content, Node, Part, ReadOutcome, Scene};
pub use side_file::{FileSet, SideFile, picture_extensions};
pub use snap::{CoordinateOverflow, polygon_rounding, snap};
pub use snapped_mesh::SnappedMesh;
pub use unknown_format::UnknownFormat;
pub use unpacked::unpacked;
pub use volume::Volume;
pub use volume::label_table::LabelLook;
pub use worst_snap::worst_snap;
pub use write::{
    write, write_files, write_polygons, write_polygons_files, write_polylines, write_sparse_volume,
    write_volume,
};

/// Runs the example of the page in `docs/` with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/tiles.md")]
struct Tiles;
