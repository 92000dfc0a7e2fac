//! `losses`: the data of a scene that a format cannot hold.
use crate::format_columns::TriangleFormat;
use crate::instances::{PartInstance, first_rows, part_instances};
use crate::{FileLocation, Format, MATERIAL, Part, Polygons, Scene, Warning, WriteError};
use chordal::Mesh;
use chordal::budget::advice::Message;
use chordal::explicit::subdivision::{Boundary, Scheme};
use chordal::explicit::{Attribute, Cage, Domain, Semantic};
use serde_json::{Map, Value};
use std::collections::BTreeSet;

/// The data that a format leaves out of a scene, counted in parts, so that nothing is lost silently. Rounding
/// is not counted. For GLB only points of parts without a triangle are listed; its writer reports all other
/// losses itself.
///
/// # Errors
/// [`WriteError::Unsupported`] if the writer would report the same.
///
/// ```
/// use chordal::{Mesh, explicit::Attribute};
/// use chordal_io::{Format, Frame, Scene, losses};
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?
///     .with_attribute(Attribute::vertex_normals(&[[0.0, 0.0, 1.0]; 3]))?;
/// let scene = Scene::from_mesh("", mesh, Frame::default());
/// assert!(losses(&scene, Format::Obj)?.is_empty());
/// assert_eq!(losses(&scene, Format::Stl)?[0].message, "STL holds no normals of vertices");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn losses(scene: &Scene, format: Format) -> Result<Vec<Warning>, WriteError> {
    let mut lost: Vec<Warning> = Vec::new();
    if format.has_parts() && !format.holds_points() {
        for part in scene.parts.iter().filter(|part| is_points_alone(part)) {
            let who = match &*part.name {
                "" => "a part without a name".to_owned(),
                name => format!("the part '{}'", name.escape_default()),
            };
            add(&mut lost, format!("{who} has no triangle: its points were left out").into());
        }
    }
    let Some(TriangleFormat {
        has_certificate,
        has_materials_beside,
        has_parts,
        keeps: Some(keeps),
        has_nodes,
        changes,
        ..
    }) = &format.row().triangles
    else {
        return Ok(lost);
    };
    let title = format.to_string().to_uppercase();
    let mut count = |message: String| add(&mut lost, message.into());
    if scene.certificate.is_some() && !has_certificate {
        count(format!("{title} holds no certificate"));
    }
    if !has_materials_beside && changes.is_none() {
        scene.assets.materials.iter().for_each(|_| count(format!("{title} holds no looks of materials")));
    }
    for (list, what) in [
        (&scene.assets.cameras, "cameras"),
        (&scene.assets.animations, "animations"),
        (&scene.assets.skins, "skins"),
    ] {
        list.iter().for_each(|_| count(format!("{title} holds no {what}")));
    }
    let n_marks: usize = scene.parts.iter().map(|part| part.marks.len()).sum();
    (0..n_marks)
        .for_each(|_| count(format!("{title} holds no points and lines{}", materials_of_marks(scene))));
    words_of(scene).for_each(|what| count(format!("{title} holds no {what}")));
    if let Some(changes) = changes {
        changes(scene).into_iter().for_each(|message| add(&mut lost, message));
    }
    let mut count = |message: String| add(&mut lost, message.into());
    let parts = if *has_nodes { Vec::new() } else { part_instances(scene)? };
    if *has_parts {
        let has_two =
            |placed: &&PartInstance<'_>| placed.name != placed.part.name && !placed.part.name.is_empty();
        let two = parts.iter().filter(has_two);
        two.for_each(|_| count(format!("{title} holds one name of a part: that of its node")));
    }
    if parts.len() > 1 && !has_parts {
        parts.iter().for_each(|_| count(format!("{title} holds one part: all were joined")));
    }
    // If nodes place parts, each part is written once, however often it is shown.
    let meshes: Vec<&Mesh> = match has_nodes {
        true => scene.parts.iter().map(|part| &part.mesh).collect(),
        false => parts.iter().map(|part| &part.part.mesh).collect(),
    };
    for mesh in meshes {
        let first_rows = first_rows(mesh);
        let is_lost = |attribute: &&Attribute| !keeps(attribute, &first_rows);
        for attribute in mesh.attributes().iter().filter(is_lost) {
            count(format!("{title} holds no {}", describe(attribute)));
        }
    }
    Ok(lost)
}

/// Whether a part has only points, and nothing that a format without points can show.
fn is_points_alone(part: &Part) -> bool {
    part.mesh.faces().is_empty() && !part.mesh.positions().is_empty() && part.marks.is_empty()
}

/// Refuses parts for a format without points if all of them are points, because the file would show nothing.
/// Points beside other parts are left out, and [`losses`] reports them.
///
/// # Errors
/// [`WriteError::Unsupported`] for the first such part.
pub(crate) fn refuse_points_alone(parts: &[Part]) -> Result<(), WriteError> {
    let shows = |part: &Part| !part.mesh.faces().is_empty() || !part.marks.is_empty();
    match parts.iter().find(|part| is_points_alone(part)) {
        Some(part) if !parts.iter().any(shows) => {
            let (name, n_points) = (&part.name, part.mesh.positions().len());
            Err(WriteError::Unsupported(format!("part \"{name}\" has {n_points} points and no triangle")))
        }
        _ => Ok(()),
    }
}

/// The materials used only by points and lines, as the end of a sentence.
fn materials_of_marks(scene: &Scene) -> String {
    let mut of_faces = BTreeSet::new();
    for part in &scene.parts {
        let groups = part.mesh.attribute(&Semantic::Group(MATERIAL.to_owned()));
        of_faces.extend(groups.into_iter().flat_map(|groups| &groups.values).map(|group| *group as usize));
    }
    let marks = scene.parts.iter().flat_map(|part| part.marks.iter());
    let marks_only: BTreeSet<usize> = marks
        .filter_map(|marks| marks.material)
        .filter(|material| !of_faces.contains(&(material + 1)))
        .collect();
    let name = |material: &usize| match scene.assets.materials.get(*material).map(|found| &found["name"]) {
        Some(Value::String(name)) => format!("'{}'", name.escape_default()),
        _ => format!("number {material}"),
    };
    let names: Vec<String> = marks_only.iter().map(name).collect();
    match names.as_slice() {
        [] => String::new(),
        [one] => format!(", and the material {one} is theirs alone"),
        _ => format!(", and the materials {} are theirs alone", names.join(", ")),
    }
}

/// Counts a loss under its sentence.
fn add(lost: &mut Vec<Warning>, message: Message) {
    match lost.iter_mut().find(|known| known.message == message) {
        Some(known) => known.count += 1,
        None => lost.push(Warning { code: "not-written", count: 1, place: FileLocation::File, message }),
    }
}

/// The metadata of a scene in glTF (names, extras), which no other format holds; one item for each object
/// that has it.
fn words_of(scene: &Scene) -> impl Iterator<Item = String> {
    let extras = |properties: &Map<String, Value>| properties.contains_key("extras");
    let of_parts =
        scene.parts.iter().filter_map(|part| part.properties.as_deref()).filter(move |p| extras(p));
    let of_nodes = scene.nodes.iter().map(|node| &*node.properties).filter(move |p| extras(p));
    let of_file = scene.assets.about.keys().map(|key| match &**key {
        "extras" => "extras of the file".to_owned(),
        key => format!("'{}' of the file", key.escape_default()),
    });
    let extensions = scene.assets.extensions.keys();
    of_parts
        .map(|_| "extras of meshes".to_owned())
        .chain(of_nodes.map(|_| "extras of nodes".to_owned()))
        .chain(of_file)
        .chain(extensions.map(|name| format!("extension '{}'", name.escape_default())))
}

/// The data left out of a cage that is written as polygons. USDA holds everything, OBJ everything but
/// materials' properties.
///
/// ```
/// use chordal::explicit::Cage;
/// use chordal_io::{Format, Frame, Polygons, losses_of_polygons};
/// let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let cage = Cage::new(square, [[0, 1, 2, 3]])?.with_creases(&[([0, 1], 2.5)])?;
/// let polygons = Polygons::from_cage(cage, Frame::default());
/// assert!(losses_of_polygons(&polygons, Format::Obj).is_empty());
/// assert_eq!(losses_of_polygons(&polygons, Format::Ply)[0].message, "PLY holds no subdivision tags");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn losses_of_polygons(polygons: &Polygons, format: Format) -> Vec<Warning> {
    let polygons_of = |held: &'static TriangleFormat| held.polygons.as_ref();
    let title = format.to_string().to_uppercase();
    let mut lost = Vec::new();
    let triangles = format.row().triangles.as_ref();
    let holds_looks =
        triangles.is_some_and(|triangles| triangles.has_nodes && triangles.has_materials_beside);
    if !polygons.assets.materials.is_empty() && !holds_looks {
        let message = format!("{title} holds no looks of materials").into();
        let count = polygons.assets.materials.len() as u64;
        lost.push(Warning { code: "not-written", count, place: FileLocation::File, message });
    }
    if format
        .row()
        .triangles
        .as_ref()
        .and_then(polygons_of)
        .is_some_and(|polygon_format| polygon_format.is_cage)
    {
        return lost;
    }
    let mut count = |what: String| {
        let message = format!("{title} holds no {what}");
        lost.push(Warning {
            code: "not-written",
            count: 1,
            place: FileLocation::File,
            message: message.into(),
        });
    };
    if has_tags(&polygons.cage) {
        count("subdivision tags".to_owned());
    }
    if polygons.cage.texcoords().is_some() {
        count("texture coordinates of corners of polygons".to_owned());
    }
    polygons.attributes.iter().for_each(|attribute| count(describe(attribute)));
    lost
}

/// Whether the surface of a cage depends on tags besides its polygons.
fn has_tags(cage: &Cage) -> bool {
    let is_plain = cage.scheme() == Scheme::CatmullClark && cage.boundary() == Boundary::EdgeOnly;
    !is_plain || !cage.creases().is_empty() || !cage.sharp_vertices().is_empty() || !cage.holes().is_empty()
}

fn describe(attribute: &Attribute) -> String {
    let what = match &attribute.semantic {
        Semantic::Normal => "normals".to_owned(),
        Semantic::Tangent => "tangents".to_owned(),
        Semantic::TexCoord(set) => format!("texture coordinates of set {set}"),
        Semantic::Color(set) => format!("colours of set {set}"),
        Semantic::Group(kind) => format!("groups '{}'", kind.escape_default()),
        Semantic::Custom(name) => format!("values '{}'", name.escape_default()),
        Semantic::Blended(_) => "skins and morph targets".to_owned(),
    };
    let domain = match attribute.domain {
        Domain::Vertex => "vertices",
        Domain::Corner => "corners",
        Domain::Face => "faces",
    };
    format!("{what} of {domain}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Frame, glb, obj};
    use serde_json::json;

    fn scene() -> Scene {
        let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
        Scene::from_mesh("mesh", mesh, Frame::default())
    }

    fn said(scene: &Scene, format: Format) -> Vec<String> {
        losses(scene, format).unwrap().iter().map(|lost| lost.message.to_string()).collect()
    }

    #[test]
    fn what_only_gltf_says_is_named() {
        let mut scene = scene();
        let extras: Map<String, Value> = [("extras".to_owned(), json!({ "a": 1 }))].into_iter().collect();
        scene.parts[0].properties = Some(Box::new(extras.clone()));
        scene.nodes[0].properties = extras.clone().into();
        scene.assets.about = extras;
        scene.assets.about.insert("copyright".to_owned(), json!("us"));
        scene.assets.extensions.insert("KHR_lights_punctual".to_owned(), json!({}));
        for format in [Format::Obj, Format::Usda, Format::Vtp] {
            let title = format.to_string().to_uppercase();
            let what = [
                "extras of meshes",
                "extras of nodes",
                "extras of the file",
                "'copyright' of the file",
                "extension 'KHR_lights_punctual'",
            ];
            let expected = what.map(|what| format!("{title} holds no {what}"));
            assert_eq!(said(&scene, format)[..5], expected);
        }
        assert!(said(&scene, Format::Glb).is_empty());
    }

    #[test]
    fn a_second_name_of_a_part_is_named() {
        let mut scene = scene();
        assert!(said(&scene, Format::Obj).is_empty());
        scene.nodes[0].name = "node".to_owned();
        assert_eq!(said(&scene, Format::Obj), ["OBJ holds one name of a part: that of its node"]);
    }

    #[test]
    fn names_of_groups_are_extras_of_a_gltf() {
        let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\no cube\nf 1 2 3\no tetra\nf 3 2 1\n";
        let outcome = obj::read(text, &crate::Limits::default()).unwrap();
        let crate::Content::Scene(scene) = outcome.content else { unreachable!() };
        let mut bytes = Vec::new();
        glb::write(&scene, None, &mut bytes).unwrap();
        let crate::Content::Scene(back) = glb::read(&bytes, &crate::Limits::default()).unwrap().content
        else {
            unreachable!()
        };
        assert_eq!(back.assets.about["extras"]["groups"], json!({ "o": ["", "cube", "tetra"] }));
    }

    #[test]
    fn an_empty_scene_comes_back_of_an_obj_with_a_certificate() {
        let mut bytes = Vec::new();
        obj::write(&Scene::default(), Some(&json!({ "name": "\u{e9}\u{1f600}" })), &mut bytes).unwrap();
        assert!(bytes.is_ascii());
        let crate::Content::Scene(back) = obj::read(&bytes, &crate::Limits::default()).unwrap().content
        else {
            unreachable!()
        };
        assert_eq!(back.certificate, Some(json!({ "name": "\u{e9}\u{1f600}" })));
    }
}
