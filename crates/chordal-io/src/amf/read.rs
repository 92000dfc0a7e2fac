//! Reads AMF.
use super::build::AmfNodeBuilder;
use super::document::{AmfDocument, AmfReader};
use super::object::VOLUME;
use crate::grow::push_large;
use crate::text::show;
use crate::unpack_cap::UnpackCap;
use crate::warnings::Warnings;
use crate::zip::directory::{LOCAL, ZipDirectory, ZipNames};
use crate::zip::unpack::ZipUnpacker;
use crate::{Axis, Content, FileLocation, Frame, Limits, MATERIAL, ReadError, ReadOutcome, Scene};
use chordal::explicit::Semantic;
use std::borrow::Cow;

/// Reads an AMF file, zipped or not. Objects are parts; nodes place them and the constellations that are in
/// no other.
///
/// Materials and volumes (of an object that has several) become face groups with their names. Colours of
/// triangles, vertices, volumes, objects and materials, in this order of precedence, become colours of
/// corners. Triangles curved by normals and edges are read as flat ones, with a warning; textures, mixed
/// materials and colours by formulas are skipped with a warning.
///
/// # Errors
/// [`ReadError`] with the line and the column, or the byte of the zip file, if the text is not XML or has a
/// document type, if an object, a material or a vertex is missing, or if a constellation contains itself.
///
/// ```
/// use chordal_io::{Content, Limits, amf};
/// let vertex = |x: i32, y: i32| format!("<vertex><coordinates><x>{x}</x><y>{y}</y><z>0</z></coordinates></vertex>");
/// let file = format!(
///     "<amf unit=\"inch\"><object id=\"1\"><mesh><vertices>{}{}{}</vertices><volume>\
///      <triangle><v1>0</v1><v2>1</v2><v3>2</v3></triangle></volume></mesh></object></amf>",
///     vertex(0, 0), vertex(1, 0), vertex(0, 1)
/// );
/// let Content::Scene(scene) = amf::read(file.as_bytes(), &Limits::default())?.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2]]);
/// assert_eq!(scene.frame.metres_per_unit, Some(0.0254));
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
///
/// Source: ISO/ASTM 52915:2020, *Specification for additive manufacturing file format (AMF) Version 1.2*.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut warnings = Warnings::default();
    let (bytes, entry) = unzipped(bytes, limits, &mut warnings)?;
    let text = crate::xml_text::text_of(&bytes)?;
    let document = AmfReader::new(text, &entry, limits, &mut warnings).read()?;
    let AmfDocument { metres_per_unit, objects, constellations, targets, mut names, material_names } =
        document;
    let frame = Frame { up: Some(Axis::Z), metres_per_unit: Some(metres_per_unit), ..Frame::default() };
    let mut scene = Scene { frame, ..Scene::default() };
    AmfNodeBuilder { constellations: &constellations, targets: &targets, n_objects: objects.len() }
        .nodes(&mut scene)?;
    for object in objects {
        let part = object.part(&mut names, limits, &mut warnings)?;
        push_large(&mut scene.parts, part)?;
    }
    for (kind, list) in [(MATERIAL, material_names), (VOLUME, names.volumes)] {
        let semantic = Semantic::Group(kind.to_owned());
        if scene.parts.iter().any(|part| part.mesh.attribute(&semantic).is_some()) {
            let names = std::iter::once(String::new()).chain(list).collect();
            scene.groups.insert(kind.to_owned(), names);
        }
    }
    if scene.parts.is_empty() {
        warnings.count_all("no-vertices", 1, "the file has no objects");
    }
    Ok(ReadOutcome { content: Content::Scene(scene), warnings: warnings.into_list() })
}

/// The bytes of the document, and the name of its zip entry.
fn unzipped<'a>(
    bytes: &'a [u8],
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<(Cow<'a, [u8]>, String), ReadError> {
    if !bytes.starts_with(LOCAL) {
        return Ok((Cow::Borrowed(bytes), String::new()));
    }
    let directory = ZipDirectory::read(bytes, ZipNames::AnyCase)?;
    let Some(entry) = directory.entries.iter().find(|entry| is_amf(&entry.name)) else {
        let message = "the zip file has no entry that is an .amf";
        return Err(ReadError::new("not-amf", FileLocation::File, message));
    };
    for other in directory.entries.iter().filter(|other| other.name != entry.name) {
        warnings.count("parts-ignored", || {
            let message =
                format!("other entries of the zip file were not read, {} first", show(other.name.as_bytes()));
            (FileLocation::File, message)
        });
    }
    let content = ZipUnpacker::new(bytes, UnpackCap::MODEL, limits).unpack(entry)?;
    Ok((Cow::Owned(content), entry.name.clone()))
}

fn is_amf(name: &str) -> bool {
    name.to_ascii_lowercase().ends_with(".amf")
}

/// Whether the content is an AMF document, or a zip file that holds one.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    /// The bytes in which the root must begin. Chosen: a declaration and comments may precede it.
    const LOOKED_AT: usize = 4096;
    if bytes.starts_with(LOCAL) {
        return ZipDirectory::read(bytes, ZipNames::AnyCase)
            .is_ok_and(|directory| directory.entries.iter().any(|entry| is_amf(&entry.name)));
    }
    let text = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes);
    let start = text.iter().position(|b| !crate::text::is_space(*b)).unwrap_or(text.len());
    let head = &text[start..text.len().min(start + LOOKED_AT)];
    let has_root = |name: &[u8]| {
        memchr::memmem::find(head, name)
            .and_then(|at| head.get(at + name.len()))
            .is_some_and(|next| crate::text::is_space(*next) || *next == b'>')
    };
    head.starts_with(b"<") && (has_root(b"<amf") || has_root(b"<AMF"))
}
