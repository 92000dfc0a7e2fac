//! Reads USD.
use super::build::UsdBuilder;
use super::files::UsdFiles;
use super::forms::layer;
use super::stage::UsdStage;
use crate::warnings::Warnings;
use crate::{FileOpener, Limits, ReadError, ReadOutcome};
use std::borrow::Cow;

/// Reads a single USD file: text, binary, or a package, recognised by content.
///
/// Meshes become parts, and the prims above them nodes. If all meshes are subdivided by the same rules they
/// become one cage instead, transformed by their nodes.
///
/// # Errors
/// As for `read_with`.
///
/// ```
/// use chordal_io::{Content, Limits, usd};
/// let file = br#"#usda 1.0
/// ( metersPerUnit = 1 upAxis = "Z" )
/// def Mesh "triangle" {
///     uniform token subdivisionScheme = "none"
///     point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
///     int[] faceVertexCounts = [3]
///     int[] faceVertexIndices = [0, 1, 2]
/// }"#;
/// let Content::Scene(scene) = usd::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!((&*scene.parts[0].name, scene.parts[0].mesh.faces()), ("triangle", &[[0, 1, 2]][..]));
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    read_with(bytes, None, limits)
}

/// Reads a USD file and the files that it refers to, if they can be opened.
///
/// # Errors
/// [`ReadError`] at the line of a text or the byte of a binary file, if it is truncated or damaged, nested
/// too deeply, or unpacks to too much; if counts and indices of a mesh are inconsistent; or if arcs form a
/// cycle.
pub(crate) fn read_with(
    bytes: &[u8],
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
) -> Result<ReadOutcome, ReadError> {
    let (root, files) = if bytes.starts_with(crate::zip::directory::LOCAL) {
        let (files, first) = UsdFiles::package(bytes, limits)?;
        (layer(Cow::Owned(first.bytes), &first.path, limits)?, files)
    } else {
        (layer(Cow::Borrowed(bytes), "", limits)?, UsdFiles::beside(open, bytes.len(), limits))
    };
    let mut stage = UsdStage::new(root, files, limits)?;
    let mut warnings = Warnings::default();
    let content = UsdBuilder::new(&mut stage).build(&mut warnings)?;
    Ok(ReadOutcome { content, warnings: warnings.into_list() })
}
