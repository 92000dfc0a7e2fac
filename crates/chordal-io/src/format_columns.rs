//! The columns of the table of formats: what reads a format and writes it, and what it holds.
use crate::drawing::Polylines;
use crate::error::{ReadError, WriteError};
use crate::files::FileOpener;
use crate::scene::{ReadOutcome, Scene};
use crate::{FileSet, Limits, Polygons, Volume};
use chordal::budget::advice::Message;
use chordal::explicit::Attribute;
use serde_json::Value;
use std::io::Write;

/// How the vertices of triangles lie in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexRows {
    /// One row for each vertex of the mesh.
    Mesh,
    /// One row for each position; attributes have rows of their own, or are kept where vertices of one
    /// position agree in them.
    Positions,
    /// One row for each vertex, split where corners differ in an attribute.
    Split,
    /// Three rows for each triangle, and one part without attributes.
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
    /// Writes a document of a stem with files beside it; none where all is in one file.
    pub write_files: Option<PolygonSetWriter>,
    /// Whether texture coordinates, groups and subdivision tags are kept too.
    pub is_cage: bool,
}

/// How a format holds triangles.
pub(crate) struct TriangleFormat {
    pub write: fn(&Scene, Option<&Value>, &mut dyn Write) -> Result<(), WriteError>,
    /// Writes a document of a stem with files beside it; none where all is in one file.
    pub write_files: Option<FileSetWriter>,
    pub rows: VertexRows,
    pub precision: PositionPrecision,
    /// None where polygons are cut into triangles.
    pub polygons: Option<PolygonFormat>,
    /// Whether materials are in files beside the document, which names them.
    pub has_materials_beside: bool,
    /// Whether parts stay apart.
    pub has_parts: bool,
    /// Whether nodes place parts, so that instances share triangles.
    pub has_nodes: bool,
    /// Whether readers of it want normals rather than compute their own.
    pub wants_normals: bool,
    pub has_certificate: bool,
    /// Whether a file may hold points and no triangle.
    pub holds_points: bool,
    /// Whether an attribute is kept, with the first of all rows that are the same vertex; none where the writer
    /// itself reports what it leaves out.
    pub keeps: Option<fn(&Attribute, &[u32]) -> bool>,
    /// What else the writer changes, and what it leaves out of the looks of materials, in sentences. Where there
    /// is none and no file beside the document, it leaves out all looks.
    pub changes: Option<fn(&Scene) -> Vec<Message>>,
}

/// How a format is read.
#[derive(Clone, Copy)]
pub(crate) enum FormatReader {
    /// From one file.
    OneFile(fn(&[u8], &Limits) -> Result<ReadOutcome, ReadError>),
    /// From a file and those that it names, where they can be opened.
    WithOthers(FileSetReader),
}

pub(crate) type PolygonSetWriter =
    for<'a> fn(&'a Polygons, Option<&Value>, &str) -> Result<FileSet<'a>, WriteError>;
pub(crate) type FileSetWriter =
    for<'a> fn(&'a Scene, Option<&Value>, &str) -> Result<FileSet<'a>, WriteError>;
pub(crate) type FileSetReader =
    fn(&[u8], Option<&mut FileOpener<'_>>, &Limits) -> Result<ReadOutcome, ReadError>;
pub(crate) type PolylineWriter = fn(&Polylines, Option<&Value>, &mut dyn Write) -> Result<(), WriteError>;
pub(crate) type VolumeWriter = fn(&Volume, Option<&Value>, &mut dyn Write) -> Result<(), WriteError>;
