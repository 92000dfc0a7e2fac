//! `ObjSideFiles`: the material library and the pictures beside an OBJ.
use super::gltf_to_mtl::MtlWriter;
use super::names::{ObjNames, UniqueNames, one_line};
use super::pictures::file_name;
use super::{write_polygons_with_library, write_with_library};
use crate::side_file::{picture_extension, picture_extensions, picture_type};
use crate::{FileSet, ImageContent, Polygons, Scene, SceneAssets, SceneImage, SideFile, Warning, WriteError};
use chordal::budget::advice::Message;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Write;

/// The files that belong beside an OBJ.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjSideFiles<'a> {
    /// The name of the material library, for [`super::write_with_library`].
    pub library: String,
    /// The files, the library first. Names consist of letters, digits, `.`, `_` and `-`, without folders, and
    /// are unique ignoring case.
    pub files: Vec<SideFile<'a>>,
    /// The properties of materials that a library cannot express.
    pub lost: Vec<Warning>,
}

/// The material library and the pictures of a scene; `None` if it has no materials. Each name begins with
/// `stem`, the name of the OBJ without its extension.
///
/// Materials that came from a library are written with its statements. Those of another format get `Kd`, `d`,
/// `Ke`, `Ks`, `Ns` and the metal and roughness of the extension for physically based rendering (`Pm`, `Pr`).
/// Pictures are byte for byte those of the scene.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Frame, Scene, obj};
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let mut scene = Scene::from_mesh("", mesh, Frame::default());
/// assert_eq!(obj::side_files(&scene, "a"), None);
/// scene.assets.materials.push(serde_json::json!({ "name": "red", "extras": { "mtl": { "Kd": [1, 0, 0] } } }));
/// let beside = obj::side_files(&scene, "my shape").unwrap();
/// assert_eq!(beside.library, "my_shape.mtl");
/// let mut file = Vec::new();
/// obj::write_with_library(&scene, None, Some(&beside.library), &mut file)?;
/// assert!(file.starts_with(b"mtllib my_shape.mtl\nv 0 0 0\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn side_files<'a>(scene: &'a Scene, stem: &str) -> Option<ObjSideFiles<'a>> {
    of_materials(&scene.groups, &scene.assets, stem)
}

/// The properties of its materials that a library cannot express.
pub(crate) fn lost_looks(scene: &Scene) -> Vec<Message> {
    let beside = side_files(scene, "");
    beside.iter().flat_map(|beside| &beside.lost).map(|lost| lost.message.clone()).collect()
}

/// As [`side_files`], for a cage.
#[must_use]
pub fn side_files_of_polygons<'a>(polygons: &'a Polygons, stem: &str) -> Option<ObjSideFiles<'a>> {
    of_materials(&polygons.groups, &polygons.assets, stem)
}

/// Writes a scene and the files beside it; all names begin with `stem`.
///
/// # Errors
/// As for [`super::write`].
pub(crate) fn write_files<'a>(
    scene: &'a Scene,
    certificate: Option<&Value>,
    stem: &str,
) -> Result<FileSet<'a>, WriteError> {
    file_set(side_files(scene, stem), |library, out| write_with_library(scene, certificate, library, out))
}

/// As [`write_files`], for a cage.
///
/// # Errors
/// As for [`super::write_polygons`].
pub(crate) fn write_polygons_files<'a>(
    polygons: &'a Polygons,
    certificate: Option<&Value>,
    stem: &str,
) -> Result<FileSet<'a>, WriteError> {
    file_set(side_files_of_polygons(polygons, stem), |library, out| {
        write_polygons_with_library(polygons, certificate, library, out)
    })
}

fn file_set<'a>(
    beside: Option<ObjSideFiles<'a>>,
    write: impl FnOnce(Option<&str>, &mut dyn Write) -> Result<(), WriteError>,
) -> Result<FileSet<'a>, WriteError> {
    let mut document = Vec::new();
    write(beside.as_ref().map(|beside| &*beside.library), &mut document)?;
    Ok(FileSet { document, beside: beside.map(|beside| beside.files).unwrap_or_default() })
}

fn of_materials<'a>(
    groups: &BTreeMap<String, Vec<String>>,
    assets: &'a SceneAssets,
    stem: &str,
) -> Option<ObjSideFiles<'a>> {
    if assets.materials.is_empty() {
        return None;
    }
    let stem = safe(stem);
    let library = format!("{stem}.mtl");
    let mut taken = UniqueNames::default();
    // No picture may have the library's name.
    taken.unique(&library, "");
    let images = assets.images.iter();
    let names: Vec<String> = images.map(|image| picture_name(image, &stem, &mut taken)).collect();
    let mut writer = MtlWriter::new(assets, &names);
    let unique = ObjNames::new(groups, assets);
    // The first name is that of faces without a material.
    for (material, name) in assets.materials.iter().zip(&unique.materials[1..]) {
        writer.material(name, material);
    }
    writer.count_pictures();
    let MtlWriter { text, is_used, lost, .. } = writer;
    let mut files = vec![SideFile { name: library.clone(), bytes: Cow::Owned(text) }];
    for ((image, name), is_used) in assets.images.iter().zip(names).zip(is_used) {
        if let (ImageContent::Bytes(bytes), true) = (&image.content, is_used) {
            files.push(SideFile { name, bytes: Cow::Borrowed(bytes) });
        }
    }
    Some(ObjSideFiles { library, files, lost })
}

/// The file of an image: its name after the stem, or the file that the image refers to.
fn picture_name(image: &SceneImage, stem: &str, taken: &mut UniqueNames) -> String {
    let text = |member: &str| image.properties.get(member).and_then(Value::as_str);
    let bytes = match &image.content {
        ImageContent::Bytes(bytes) => bytes,
        ImageContent::Uri(uri) => return one_line(uri),
    };
    let ending = format!(".{}", picture_extension(picture_type(bytes).or(text("mimeType"))));
    let name = file_name(text("name").unwrap_or_default());
    let is_known =
        |ending: &str| picture_extensions().chain(["jpeg"]).any(|known| known.eq_ignore_ascii_case(ending));
    let bare = name.rsplit_once('.').filter(|(_, ending)| is_known(ending)).map_or(name, |(bare, _)| bare);
    // A picture that was written before already has the stem.
    let prefix = format!("{stem}_");
    let bare = bare.strip_prefix(&prefix).unwrap_or(bare);
    let bare = if bare.is_empty() { "picture".to_owned() } else { safe(bare) };
    taken.unique(&format!("{prefix}{bare}"), &ending)
}

/// The most characters of a name. Chosen: file systems allow 255 bytes, and endings are added.
const LONGEST: usize = 48;

/// A name that every file system and every reader of OBJ accepts.
fn safe(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '_' };
    let safe: String = name.chars().map(letter).take(LONGEST).collect();
    let safe = safe.trim_matches('.');
    if safe.is_empty() { "_".to_owned() } else { safe.to_owned() }
}
