//! Writes USD packages, `.usdz`: the text form and its pictures in one file.
use super::write::write_files;
use super::write_polygons::write_polygons_files;
use crate::zip::write_stored;
use crate::{FileSet, Polygons, Scene, WriteError};
use serde_json::Value;
use std::io::Write;

/// The name of the layer in a package, and the prefix of its pictures. Chosen: a constant, so that the bytes
/// do not depend on a path.
const STEM: &str = "scene";

/// Writes a scene as [`super::write`] does, with its pictures, as one package. Entries are stored
/// uncompressed and aligned, so that readers can map them.
///
/// # Errors
/// As for [`super::write`]; also if the package would have 4 GiB or more.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Content, Frame, Limits, Scene, usd};
/// let mesh = Mesh::new(vec![[0.5, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let mut file = Vec::new();
/// usd::write_package(&Scene::from_mesh("part", mesh.clone(), Frame::default()), None, &mut file)?;
/// let Content::Scene(scene) = usd::read(&file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh, mesh);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source: Pixar Animation Studios, *Usdz File Format Specification* 1.3, 2021.
pub fn write_package(
    scene: &Scene,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    pack(&write_files(scene, certificate, STEM)?, out)
}

/// Writes a cage as [`super::write_polygons`] does, with its pictures, as one package.
///
/// # Errors
/// As for [`write_package`].
pub fn write_polygons_package(
    polygons: &Polygons,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    pack(&write_polygons_files(polygons, certificate, STEM)?, out)
}

fn pack(files: &FileSet<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let layer = format!("{STEM}.usda");
    let first = [(&*layer, &*files.document)];
    let beside = files.beside.iter().map(|file| (&*file.name, &*file.bytes));
    // Readers open the first entry.
    let entries: Vec<(&str, &[u8])> = first.into_iter().chain(beside).collect();
    write_stored(&entries, out)
}
