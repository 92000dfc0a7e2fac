//! Writes packages of USD, `.usdz`: the text form and its pictures in one file.
use super::write::write_files;
use super::write_polygons::write_polygons_files;
use crate::zip::write_stored;
use crate::{FileSet, Polygons, Scene, WriteError};
use serde_json::Value;
use std::io::Write;

/// What the layer of a package is called, and its pictures begin with. A name of its own would make the bytes
/// depend on a path.
const STEM: &str = "scene";

/// Writes a scene as [`super::write`] does, with its pictures, as one package. Entries are stored as they are
/// and aligned, so that readers map them.
///
/// # Errors
/// As for [`super::write`]; also when the package would have 4 GiB or more.
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
    // The first entry is what a reader opens.
    let entries: Vec<(&str, &[u8])> = first.into_iter().chain(beside).collect();
    write_stored(&entries, out)
}
