//! The columns of the table of formats: the readers and writers of a format, and the data that it holds.
use crate::drawing::Polylines;
use crate::error::{ReadError, WriteError};
use crate::files::FileOpener;
use crate::frame::{Axis, Frame};
use crate::scene::{ReadOutcome, Scene};
use crate::{FileSet, Limits, Polygons, Volume};
use chordal::budget::advice::Message;
use chordal::explicit::Attribute;
use chordal::implicit::SparseGrid;
use serde_json::Value;
use std::io::Write;

/// How a file arranges the vertices of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexRows {
    /// One row for each vertex of the mesh.
    Mesh,
    /// One row for each position. Attributes have their own rows, or are kept only where all vertices at a
    /// position have the same value.
    Positions,
    /// One row for each vertex; a vertex whose corners differ in an attribute is split.
    Split,
    /// Three rows for each triangle, in a single part without attributes.
    Soup,
}

/// The precision of the positions in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PositionPrecision {
    /// Double precision: every bit is kept.
    Double,
    /// Single precision.
    Single,
    /// Single precision about an origin that the writer chooses for every part.
    SingleAboutOrigin,
}

/// How a format holds polygons of any number of corners.
pub(crate) struct PolygonFormat {
    pub write: fn(&Polygons, Option<&Value>, &mut dyn Write) -> Result<(), WriteError>,
    /// Writes a document with files beside it, all named after a stem; `None` if the format has one file
    /// only.
    pub write_files: Option<PolygonSetWriter>,
    /// Whether texture coordinates, groups and subdivision tags are kept too.
    pub is_cage: bool,
}

/// How a format holds triangles.
pub(crate) struct TriangleFormat {
    pub write: fn(&Scene, Option<&Value>, &mut dyn Write) -> Result<(), WriteError>,
    /// Writes a document with files beside it, all named after a stem; `None` if the format has one file
    /// only.
    pub write_files: Option<FileSetWriter>,
    pub rows: VertexRows,
    pub precision: PositionPrecision,
    /// `None` if the format holds triangles only, so that polygons are cut.
    pub polygons: Option<PolygonFormat>,
    /// Whether materials are in separate files that the document names.
    pub has_materials_beside: bool,
    /// Whether the format keeps parts separate.
    pub has_parts: bool,
    /// Whether the format has nodes that place parts, so that instances share triangles.
    pub has_nodes: bool,
    /// Whether programs that read the format expect normals in the file, instead of computing their own.
    pub wants_normals: bool,
    pub has_certificate: bool,
    /// Whether a file may hold points without any triangle.
    pub holds_points: bool,
    /// Whether parts are names of faces in one mesh, whose vertices they share.
    pub shares_vertices: bool,
    /// Whether a triangle may not have the same corner twice.
    pub forbids_collapsed_faces: bool,
    /// The axis that is always up, so that the writer turns other scenes; `None` if each file has its own.
    pub up: Option<Axis>,
    /// Whether an attribute is kept; the second argument is, for each row, the first row of the same vertex.
    /// `None` if the writer itself reports what it leaves out.
    pub keeps: Option<fn(&Attribute, &[u32]) -> bool>,
    /// Other changes that the writer makes, and the properties of materials that it leaves out, as sentences.
    /// If this is `None` and the format has no separate files, the writer leaves out all materials.
    pub changes: Option<fn(&Scene) -> Vec<Message>>,
}

/// How a format holds polylines.
pub(crate) struct PolylineFormat {
    pub write: fn(&Polylines, Option<&Value>, &mut dyn Write) -> Result<(), WriteError>,
    /// Whether cubic curves are kept.
    pub holds_cubics: bool,
    /// Whether curves in space are kept.
    pub holds_space: bool,
    /// Whether y grows downwards.
    pub is_y_down: bool,
    /// Whether elements are kept: their names, how they are filled, the box of view.
    pub holds_elements: bool,
}

/// How a format holds samples on a lattice.
pub(crate) struct VolumeFormat {
    pub write: fn(&Volume, Option<&Value>, &mut dyn Write) -> Result<(), WriteError>,
    /// Writes samples in bricks, without a dense copy of them.
    pub write_sparse: SparseVolumeWriter,
    /// Whether a file holds the samples alone, as an array.
    pub is_array: bool,
    /// Whether there is a name for the unit of so many metres.
    pub names_unit: fn(f64) -> bool,
}

/// How a format is read.
#[derive(Clone, Copy)]
pub(crate) enum FormatReader {
    /// From one file.
    OneFile(fn(&[u8], &Limits) -> Result<ReadOutcome, ReadError>),
    /// From a file and the files that it names, if they can be opened.
    WithOthers(FileSetReader),
}

pub(crate) type SparseVolumeWriter =
    fn(&SparseGrid, &Frame, Option<&Value>, &mut dyn Write) -> Result<(), WriteError>;
pub(crate) type PolygonSetWriter =
    for<'a> fn(&'a Polygons, Option<&Value>, &str) -> Result<FileSet<'a>, WriteError>;
pub(crate) type FileSetWriter =
    for<'a> fn(&'a Scene, Option<&Value>, &str) -> Result<FileSet<'a>, WriteError>;
pub(crate) type FileSetReader =
    fn(&[u8], Option<&mut FileOpener<'_>>, &Limits) -> Result<ReadOutcome, ReadError>;
