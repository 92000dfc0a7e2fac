//! Reads Collada.
use super::build::ColladaBuilder;
use super::document::{ColladaDocument, UpAxis};
use super::reader::ColladaReader;
use crate::grow::push_large;
use crate::warnings::Warnings;
use crate::{Axis, Content, Frame, Limits, MATERIAL, ReadError, ReadOutcome, Scene, TextureOrigin};
use chordal::explicit::Semantic;

/// Reads the meshes of a COLLADA file: each geometry is a part, and the nodes of its visual scene place them.
///
/// Triangles, polylists, polygons, strips and fans become faces, cut into triangles. Normals, texture
/// coordinates and colours are values of corners. Materials become face groups; their diffuse colour is the
/// base colour, and pictures are kept as names, not opened. Skins and morphs cause a warning, and their
/// meshes are read at rest. Animations, cameras, lights and lines are skipped with a warning. A file in which
/// x is up is rotated by a root node, exactly.
///
/// # Errors
/// [`ReadError`] with the line and the column, if the text is not XML or has a document type, a referenced
/// object is missing, an index is out of range, or a node contains itself.
///
/// ```
/// use chordal_io::{Content, Limits, collada};
/// let file = br##"<COLLADA><asset><unit meter="0.01"/></asset><library_geometries><geometry id="g"><mesh>
///   <source id="p"><float_array>0 0 0 1 0 0 0 1 0</float_array><technique_common>
///     <accessor count="3" stride="3"/></technique_common></source>
///   <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
///   <triangles><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
/// </mesh></geometry></library_geometries></COLLADA>"##;
/// let Content::Scene(scene) = collada::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2]]);
/// assert_eq!(scene.frame.metres_per_unit, Some(0.01));
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
///
/// Source: Khronos, *COLLADA – Digital Asset Schema Release 1.4.1*, 2008, and *1.5.0*, 2008.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut warnings = Warnings::default();
    let text = crate::xml_text::text_of(bytes)?;
    let document = ColladaReader::new(text, limits, &mut warnings).read()?;
    let up = if document.up == UpAxis::Z { Axis::Z } else { Axis::Y };
    let frame = Frame {
        up: Some(up),
        metres_per_unit: Some(document.metres_per_unit),
        texture_origin: Some(TextureOrigin::LowerLeft),
    };
    let mut scene = Scene { frame, ..Scene::default() };
    let bindings = vec![None; document.geometries.len()];
    let mut builder = ColladaBuilder { document: &document, warnings: &mut warnings, bindings };
    builder.nodes(&mut scene)?;
    let bindings = builder.bindings;
    let ColladaDocument { looks, geometries, .. } = document;
    let mut n_unseen = 0;
    for (geometry, bound) in geometries.into_iter().zip(bindings) {
        n_unseen += u64::from(bound.is_none());
        let bound = bound.unwrap_or_default();
        // Without a binding, a symbol is the name of a material, as some programs write it.
        let number = |symbol: &str| {
            let target = bound.iter().find(|[of, _]| of == symbol).map_or(symbol, |[_, target]| target);
            looks.number(target).unwrap_or(0)
        };
        let part = geometry.part(&number, limits, &mut warnings)?;
        push_large(&mut scene.parts, part)?;
    }
    let has_scene = scene.nodes.iter().any(|node| node.part.is_some());
    warnings.count_all(
        "objects-not-shown",
        if has_scene { n_unseen } else { 0 },
        "the scene does not show all meshes",
    );
    let semantic = Semantic::Group(MATERIAL.to_owned());
    if scene.parts.iter().any(|part| part.mesh.attribute(&semantic).is_some()) {
        scene.groups.insert(MATERIAL.to_owned(), looks.names());
        *scene.assets = looks.assets();
    }
    if scene.parts.is_empty() {
        warnings.count_all("no-vertices", 1, "the file has no meshes");
    }
    Ok(ReadOutcome { content: Content::Scene(scene), warnings: warnings.into_list() })
}

/// Whether the text is a COLLADA document.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    /// The bytes in which the root must begin. Chosen: a declaration and comments may precede it.
    const LOOKED_AT: usize = 4096;
    let head = &text[..text.len().min(LOOKED_AT)];
    text.starts_with(b"<") && memchr::memmem::find(head, b"<COLLADA").is_some()
}
