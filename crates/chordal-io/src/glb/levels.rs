//! Writes levels of detail of a scene as one glTF, by `MSFT_lod`.
use super::level_set::GlbLevels;
use super::pack::{files_of, pack_embedded, with_document, write_file};
use crate::{FileSet, WriteError};
use std::io::Write;

/// Writes levels of detail as one GLB 2.0. The same levels give the same bytes.
///
/// The scene is written as by [`super::write`], with its nodes, materials, skins and animations. Each node
/// whose part has coarser levels refers to a node for each of them by the extension `MSFT_lod`, and has the
/// screen coverages as its extra `MSFT_screencoverage`. These nodes are not part of the scene, and have the
/// same transform. If the node has children, is animated, or shows a camera or a light, an extra child shows
/// the part and refers to the levels, since viewers that support the extension replace a whole node by a
/// level. The extension is not required, so a viewer that does not support it shows the finest level.
///
/// # Errors
/// As for [`super::write`]; also if there is not one coverage for each level, if coverages are not from 0 to
/// 1 or do not decrease, or if a coarser level has no triangles.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::glb::{GlbLevels, write_levels};
/// use chordal_io::{Frame, Part, Scene};
/// let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let fine = Mesh::new(corners.clone(), vec![[0, 1, 2], [0, 2, 3]])?;
/// let coarse = Mesh::new(corners[..3].to_vec(), vec![[0, 1, 2]])?;
/// let scene = Scene::from_mesh("square", fine, Frame::default());
/// let coarser = [vec![Part { mesh: coarse, ..Part::default() }]];
/// let coverages = [vec![0.25, 0.0]];
/// let levels = GlbLevels { coarser: &coarser, coverages: &coverages, ..GlbLevels::one(&scene) };
/// let mut bytes = Vec::new();
/// write_levels(&levels, &mut bytes)?;
/// assert_eq!(&bytes[..4], b"glTF");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source: Microsoft, MSFT_lod, glTF 2.0 vendor extension, 2017.
pub fn write_levels(levels: &GlbLevels<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    levels.check()?;
    with_document(levels, |document, json| write_file(document, json, out))
}

/// Writes the same as [`write_levels`] as a single-file JSON glTF, as [`super::write_embedded`] does.
///
/// # Errors
/// As for [`write_levels`], but without the limit of 4 GiB.
pub fn write_levels_embedded(levels: &GlbLevels<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    levels.check()?;
    with_document(levels, |document, json| pack_embedded(document, json, out))
}

/// Writes the same as [`write_levels`] as a JSON glTF with files beside it, as [`super::write_files`] does.
///
/// # Errors
/// As for [`write_levels`], but without the limit of 4 GiB.
pub fn write_levels_files<'a>(levels: &GlbLevels<'a>, stem: &str) -> Result<FileSet<'a>, WriteError> {
    levels.check()?;
    files_of(levels.scene, levels, stem)
}
