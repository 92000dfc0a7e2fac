//! `write`: encodes a shape in any format that can hold it, with its certificate if the format has room for
//! one.
use crate::{FileSet, Format, Frame, Polygons, Polylines, Scene, Volume, WriteError};
use chordal::implicit::SparseGrid;
use serde_json::Value;
use std::io::Write;

/// Writes a scene of triangles.
///
/// # Errors
/// If the sink fails, or the format cannot hold the scene.
///
/// ```
/// use chordal_io::{Content, Format, Limits, read, write};
/// let loaded = read(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", Format::Obj, &Limits::default())?;
/// let Content::Scene(scene) = loaded.content else { unreachable!() };
/// let mut file = Vec::new();
/// write(&scene, None, Format::Stl, &mut file)?;
/// assert_eq!(file.len(), 84 + 50);
/// assert!(write(&scene, None, Format::Svg, &mut file).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(
    scene: &Scene,
    certificate: Option<&Value>,
    format: Format,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let triangles = format.row().triangles.as_ref().ok_or_else(|| holds_no(format, "triangles"))?;
    (triangles.write)(scene, certificate, out)
}

/// Writes a scene of triangles as several files: a document called `stem` with the extension of the format,
/// and the files that it refers to, whose names begin with `stem`. Data for which the format has no separate
/// files is in the document; see [`Format::has_side_files`].
///
/// # Errors
/// As for [`write`].
///
/// ```
/// use chordal_io::{Content, Format, Limits, read, write_files};
/// let loaded = read(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", Format::Obj, &Limits::default())?;
/// let Content::Scene(scene) = loaded.content else { unreachable!() };
/// let files = write_files(&scene, None, Format::Gltf, "triangle")?;
/// assert_eq!(files.beside[0].name, "triangle.bin");
/// assert!(String::from_utf8(files.document)?.contains("\"uri\":\"triangle.bin\""));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_files<'a>(
    scene: &'a Scene,
    certificate: Option<&Value>,
    format: Format,
    stem: &str,
) -> Result<FileSet<'a>, WriteError> {
    let triangles = format.row().triangles.as_ref().ok_or_else(|| holds_no(format, "triangles"))?;
    if let Some(write_files) = triangles.write_files {
        return write_files(scene, certificate, stem);
    }
    let mut document = Vec::new();
    (triangles.write)(scene, certificate, &mut document)?;
    Ok(FileSet { document, beside: Vec::new() })
}

/// Writes polygons of any number of corners.
///
/// # Errors
/// If the sink fails, or the format cannot hold the polygons.
pub fn write_polygons(
    polygons: &Polygons,
    certificate: Option<&Value>,
    format: Format,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let triangles = format.row().triangles.as_ref();
    let polygon_format = triangles
        .and_then(|triangles| triangles.polygons.as_ref())
        .ok_or_else(|| holds_no(format, "polygons"))?;
    (polygon_format.write)(polygons, certificate, out)
}

/// Writes polygons as several files, as [`write_files`] does triangles.
///
/// # Errors
/// As for [`write_polygons`].
pub fn write_polygons_files<'a>(
    polygons: &'a Polygons,
    certificate: Option<&Value>,
    format: Format,
    stem: &str,
) -> Result<FileSet<'a>, WriteError> {
    let polygon_format = format.row().triangles.as_ref().and_then(|triangles| triangles.polygons.as_ref());
    if let Some(write_files) = polygon_format.and_then(|polygon_format| polygon_format.write_files) {
        return write_files(polygons, certificate, stem);
    }
    let mut document = Vec::new();
    write_polygons(polygons, certificate, format, &mut document)?;
    Ok(FileSet { document, beside: Vec::new() })
}

/// Writes polylines.
///
/// # Errors
/// If the sink fails, or the format cannot hold the polylines.
pub fn write_polylines(
    polylines: &Polylines,
    certificate: Option<&Value>,
    format: Format,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let held = format.row().polylines.as_ref().ok_or_else(|| holds_no(format, "polylines"))?;
    (held.write)(polylines, certificate, out)
}

/// Writes samples on a lattice.
///
/// # Errors
/// If the sink fails, or the format cannot hold the samples.
pub fn write_volume(
    volume: &Volume,
    certificate: Option<&Value>,
    format: Format,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let held = format.row().volumes.as_ref().ok_or_else(|| holds_no(format, "volume"))?;
    (held.write)(volume, certificate, out)
}

/// Writes sparse samples in bricks, without a dense copy in memory: `.nrrd` packed by gzip, `.npy` unpacked.
///
/// # Errors
/// If the sink fails, or the format cannot hold the samples.
pub fn write_sparse_volume(
    grid: &SparseGrid,
    frame: &Frame,
    certificate: Option<&Value>,
    (format, out): (Format, &mut dyn Write),
) -> Result<(), WriteError> {
    let held = format.row().volumes.as_ref().ok_or_else(|| holds_no(format, "volume"))?;
    (held.write_sparse)(grid, frame, certificate, out)
}

fn holds_no(format: Format, what: &str) -> WriteError {
    WriteError::Unsupported(format!("{format} holds no {what}"))
}
