//! What is written as 3MF reads back: positions to the last bit, names, instances, units, colours as bytes.
use crate::common::load_scene;
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal_io::{Axis, Format, Frame, Node, Part, Scene, WriteError, losses, threemf};
use proptest::prelude::*;
use serde_json::{Value, json};

const IDENTITY: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
const MILLIMETRES: Frame = Frame { up: Some(Axis::Z), metres_per_unit: Some(0.001), texture_origin: None };

fn written(scene: &Scene, certificate: Option<&Value>) -> Vec<u8> {
    let mut bytes = Vec::new();
    threemf::write(scene, certificate, &mut bytes).expect("written");
    assert_eq!(Format::sniff(&bytes), Some(Format::ThreeMf));
    bytes
}

fn back(scene: &Scene) -> Scene {
    load_scene(&written(scene, None), Format::ThreeMf).0
}

fn refused(scene: &Scene) -> String {
    match threemf::write(scene, None, &mut Vec::new()) {
        Err(WriteError::Unsupported(message)) => message,
        other => panic!("{other:?}"),
    }
}

fn node(name: &str, matrix: [f64; 16], children: Vec<usize>, part: Option<usize>) -> Node {
    Node { name: name.to_owned(), matrix: matrix.into(), children, part, ..Node::default() }
}

fn triangle() -> Mesh {
    Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap()
}

fn bits(points: &[[f64; 3]]) -> Vec<[u64; 3]> {
    points.iter().map(|p| p.map(f64::to_bits)).collect()
}

fn with(mesh: Mesh, semantic: Semantic, domain: Domain, width: usize, values: Vec<f64>) -> Mesh {
    mesh.with_attribute(Attribute { semantic, domain, width, values }).unwrap()
}

/// Numbers of any size, and now and then any bits.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -100.0..100.0_f64,
        1 => any::<u64>().prop_map(|b| { let x = f64::from_bits(b); if x.abs() < 1e300 { x } else { -0.0 } }),
    ]
}

fn any_mesh() -> impl Strategy<Value = Mesh> {
    let position = prop::array::uniform3(coordinate());
    // 3MF holds no triangle with a corner twice.
    let face =
        prop::sample::select(vec![[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2_u32]]);
    (prop::collection::vec(position, 3..20), prop::collection::vec(face, 1..20))
        .prop_map(|(positions, faces)| Mesh::new(positions, faces).unwrap())
}

fn any_matrix() -> impl Strategy<Value = [f64; 16]> {
    prop::array::uniform12(-10.0..10.0_f64).prop_map(|m| {
        std::array::from_fn(|i| if i % 4 < 3 { m[3 * (i / 4) + i % 4] } else { f64::from(i == 15) })
    })
}

/// Parts, each shown by nodes of a group that stands in several places; and in some unit.
fn any_scene() -> impl Strategy<Value = Scene> {
    let part =
        (any_mesh(), "\\PC*").prop_map(|(mesh, name)| Part { name, mesh, indexed: true, ..Part::default() });
    let leaf = (any_matrix(), "[a-z<>&\"' ]{0,5}", any::<prop::sample::Index>());
    let unit = prop::sample::select(vec![1e-6, 0.001, 0.01, 0.0254, 0.3048, 1.0]);
    let all = (prop::collection::vec(part, 1..4), prop::collection::vec((leaf, 0..3_usize), 1..12), unit);
    (all, any::<bool>()).prop_map(|((parts, leaves, unit), is_y_up)| {
        let mut nodes: Vec<Node> =
            (0..3).map(|i| node(&format!("group {i}"), IDENTITY, vec![], None)).collect();
        nodes[2].matrix[12] = 0.5;
        nodes[1].children.push(2);
        for ((matrix, name, part), parent) in leaves {
            let i = nodes.len();
            nodes[parent].children.push(i);
            nodes.push(node(&name, matrix, vec![], Some(part.index(parts.len()))));
        }
        let up = Some(if is_y_up { Axis::Y } else { Axis::Z });
        let frame = Frame { up, metres_per_unit: Some(unit), ..Frame::default() };
        Scene { parts, nodes, roots: vec![0, 1], frame, ..Scene::default() }
    })
}

proptest! {
    #[test]
    fn scenes_come_back_to_the_last_bit(scene in any_scene()) {
        let bytes = written(&scene, None);
        prop_assert_eq!(&bytes, &written(&scene, None));
        let (read, _) = load_scene(&bytes, Format::ThreeMf);
        prop_assert_eq!(read.frame, Frame { up: Some(Axis::Z), ..scene.frame });
        prop_assert_eq!(read.parts.len(), scene.parts.len());
        for (a, b) in read.parts.iter().zip(&scene.parts) {
            prop_assert_eq!(bits(a.mesh.positions()), bits(b.mesh.positions()));
            prop_assert_eq!(a.mesh.faces(), b.mesh.faces());
            prop_assert_eq!(&a.name, &b.name);
        }
        let (read, truth) = (read.world_meshes().unwrap(), scene.world_meshes().unwrap());
        prop_assert_eq!(read.len(), truth.len());
        for ((name, a), (other, b)) in read.iter().zip(&truth) {
            prop_assert_eq!(name, other);
            prop_assert_eq!(a.faces(), b.faces());
            for (p, q) in a.positions().iter().zip(b.positions()) {
                // (x, y, z) to (x, −z, y) where y is up. Zeros may have another sign.
                let turned = if scene.frame.up == Some(Axis::Y) { [q[0], -q[2], q[1]] } else { *q };
                prop_assert_eq!(*p, turned);
            }
        }
        // The second time nothing changes.
        let again = load_scene(&bytes, Format::ThreeMf).0;
        prop_assert_eq!(back(&again), again);
    }

    #[test]
    fn colours_come_back_as_bytes(
        mesh in any_mesh(),
        bytes in prop::collection::vec(any::<u8>(), 80 * 4),
        width in 3..5_usize,
        domain in prop::sample::select(vec![Domain::Vertex, Domain::Corner, Domain::Face]),
    ) {
        let (n, n_faces) = (mesh.positions().len(), mesh.faces().len());
        let rows = match domain { Domain::Vertex => n, Domain::Corner => 3 * n_faces, Domain::Face => n_faces };
        let values: Vec<f64> = bytes.iter().cycle().take(rows * width).map(|b| f64::from(*b) / 255.0).collect();
        let mesh = with(mesh, Semantic::Color(0), domain, width, values);
        let scene = Scene::from_mesh("", mesh.clone(), MILLIMETRES);
        let mut lost = losses(&scene, Format::ThreeMf).unwrap();
        // Some coordinates are over what lib3mf reads.
        lost.retain(|lost| !lost.message.to_string().contains("lib3mf"));
        prop_assert_eq!(lost, []);
        let read = back(&scene);
        let (truth, found) = (&mesh.attributes()[0], &read.parts[0].mesh.attributes()[0]);
        prop_assert_eq!((&found.semantic, found.domain, found.width), (&Semantic::Color(0), Domain::Corner, 4));
        for (f, face) in mesh.faces().iter().enumerate() {
            for (k, vertex) in face.iter().enumerate() {
                let row = match domain { Domain::Vertex => *vertex as usize, Domain::Corner => 3 * f + k, Domain::Face => f };
                let alpha = truth.row(row).get(3).copied().unwrap_or(1.0);
                prop_assert_eq!(found.row(3 * f + k), &[&truth.row(row)[..3], &[alpha]].concat()[..]);
            }
        }
    }
}

#[test]
fn vertices_that_are_tied_are_one_row() {
    let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let mesh = Mesh::new(vec![a, b, c, b, c, d], vec![[0, 1, 2], [4, 3, 5]])
        .and_then(|mesh| mesh.with_position_id(vec![0, 1, 2, 1, 2, 5]))
        .unwrap();
    let mesh = with(mesh, Semantic::Normal, Domain::Vertex, 3, [0.0, 0.0, 1.0].repeat(6));
    let scene = Scene::from_mesh("", mesh, MILLIMETRES);
    let read = back(&scene);
    assert_eq!(read.parts[0].mesh.positions(), [a, b, c, d]);
    assert_eq!(read.parts[0].mesh.faces(), [[0, 1, 2], [2, 1, 3]]);
    let lost = losses(&scene, Format::ThreeMf).unwrap();
    assert_eq!(
        lost.iter().map(|w| w.message.to_string()).collect::<Vec<_>>(),
        ["3MF holds no normals of vertices"]
    );
}

#[test]
fn instances_and_names_come_back_and_the_part_is_written_once() {
    let mut moved = IDENTITY;
    moved[12] = 3.0;
    let scene = Scene {
        parts: vec![Part { name: "leg".into(), mesh: triangle(), indexed: true, ..Part::default() }],
        nodes: vec![
            node("table", IDENTITY, vec![1, 2], None),
            node("left", IDENTITY, vec![], Some(0)),
            node("right", moved, vec![], Some(0)),
        ],
        roots: vec![0],
        frame: MILLIMETRES,
        ..Scene::default()
    };
    assert_eq!(back(&scene), scene);
    assert!(losses(&scene, Format::ThreeMf).unwrap().is_empty());
    assert!(Format::ThreeMf.has_nodes() && Format::ThreeMf.holds_triangles());
}

#[test]
fn a_node_with_a_part_and_children_becomes_an_object_of_both() {
    let mut nodes = vec![node("a", IDENTITY, vec![1, 2], Some(0)), node("", IDENTITY, vec![], Some(0))];
    nodes[1].matrix[14] = -2.0;
    // Nothing is shown here, so nothing is written.
    nodes.push(node("empty", IDENTITY, vec![], Some(1)));
    let part = |mesh| Part { name: "p".into(), mesh, indexed: true, ..Part::default() };
    let scene = Scene {
        parts: vec![part(triangle()), part(Mesh::default())],
        nodes,
        roots: vec![0],
        frame: MILLIMETRES,
        ..Scene::default()
    };
    let read = back(&scene);
    assert_eq!((read.parts.len(), read.nodes.len(), &*read.nodes[0].name), (1, 3, "a"));
    let positions = |scene: &Scene| {
        let shown = scene.world_meshes().unwrap();
        shown.iter().map(|(_, mesh)| mesh.positions().to_vec()).filter(|p| !p.is_empty()).collect::<Vec<_>>()
    };
    assert_eq!(positions(&read), positions(&scene));
}

/// Base colours of glTF, which are linear, are in sRGB in 3MF.
#[test]
fn base_colours_of_gltf_are_those_of_materials() {
    let mesh = Mesh::new(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 1]],
    )
    .unwrap();
    let mesh = with(mesh, Semantic::Group("material".to_owned()), Domain::Face, 1, vec![1.0, 2.0, 3.0]);
    let mut scene = Scene::from_mesh("m", mesh, MILLIMETRES);
    let names = ["", "half", "glass", "plain"].map(str::to_owned);
    scene.groups.insert("material".into(), names.to_vec());
    let factor = |factor: [f64; 4]| json!({ "baseColorFactor": factor });
    scene.assets.materials = vec![
        json!({ "name": "half", "pbrMetallicRoughness": factor([0.5, 0.0, 1.0, 0.25]) }),
        json!({ "name": "glass", "pbrMetallicRoughness": factor([0.002, 1.0, 1.0, 0.2]), "alphaMode": "BLEND" }),
        json!({ "name": "plain", "doubleSided": true }),
    ];
    let read = back(&scene);
    assert_eq!(read.groups["material"], names);
    // 0.5 is 0.7354 in sRGB, which is 188 of 255; 0.002 is on the straight piece, 12.92 · 0.002 · 255 = 6.6.
    let bytes = [[188, 0, 255, 255], [7, 255, 255, 51], [255; 4]];
    let colors = read.parts[0].mesh.attribute(&Semantic::Color(0)).unwrap();
    for (face, color) in bytes.iter().enumerate() {
        assert_eq!(colors.row(3 * face), color.map(|byte| f64::from(byte) / 255.0));
    }
    assert!(losses(&scene, Format::ThreeMf).unwrap().is_empty());
    scene.assets.materials[0]["pbrMetallicRoughness"]["metallicFactor"] = json!(0.5);
    let lost = losses(&scene, Format::ThreeMf).unwrap();
    assert!(lost.len() == 1 && lost[0].message.contains("base colours"), "{lost:?}");
}

#[test]
fn materials_come_back_with_their_names_and_colours() {
    let two = Mesh::new(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 1]],
    )
    .unwrap();
    let group = || Semantic::Group("material".to_owned());
    let material = with(two, group(), Domain::Face, 1, vec![1.0, 0.0, 2.0]);
    let [red, none, blue] = [[1.0, 0.0, 0.0, 1.0], [1.0; 4], [0.0, 0.0, 1.0, 0.2]];
    let colors = [[red; 3], [none; 3], [blue; 3]].concat().concat();
    let mesh = with(material.clone(), Semantic::Color(0), Domain::Corner, 4, colors.clone());
    let mut scene = Scene::from_mesh("m", mesh, MILLIMETRES);
    scene.groups.insert("material".into(), vec![String::new(), "red <1>".into(), "blue".into()]);
    let read = back(&scene);
    assert_eq!(read.groups, scene.groups);
    for attribute in scene.parts[0].mesh.attributes() {
        assert_eq!(read.parts[0].mesh.attribute(&attribute.semantic), Some(attribute));
    }
    assert!(losses(&scene, Format::ThreeMf).unwrap().is_empty());
    // A material of two colours is none of 3MF: colours stay, materials go, and it is said.
    let mut other = colors;
    other[0] = 0.6;
    let mesh = with(material, Semantic::Color(0), Domain::Corner, 4, other);
    let mut scene =
        Scene { parts: vec![Part { name: "m".into(), mesh, indexed: true, ..Part::default() }], ..scene };
    let read = back(&scene);
    assert!(read.groups.is_empty() && read.parts[0].mesh.attribute(&Semantic::Color(0)).is_some());
    let lost = losses(&scene, Format::ThreeMf).unwrap();
    assert!(lost[0].message.contains("materials not"), "{}", lost[0]);
    // Colours that are no bytes are rounded, and that is said.
    let mesh = with(triangle(), Semantic::Color(0), Domain::Vertex, 3, vec![0.3; 9]);
    scene = Scene::from_mesh("", mesh, MILLIMETRES);
    assert!(losses(&scene, Format::ThreeMf).unwrap()[0].message.contains("8 bits"));
    assert_eq!(
        back(&scene).parts[0].mesh.attributes()[0].row(0),
        [77.0 / 255.0, 77.0 / 255.0, 77.0 / 255.0, 1.0]
    );
}

#[test]
fn groups_without_names_are_numbered() {
    let mesh = with(triangle(), Semantic::Group("material".into()), Domain::Face, 1, vec![0.0]);
    let read = back(&Scene::from_mesh("", mesh, MILLIMETRES));
    assert_eq!(read.groups["material"], ["", "material_0"]);
}

#[test]
fn the_certificate_travels_to_the_last_bit() {
    let certificate = json!({
        "bound": { "at_most": 0.000_977_138_471_238_471_2, "at": [1.0, -0.1, 1e-300] },
        "notes": ["a line\nbreak, a \"quote\", <a> & an é \u{1}", ""],
    });
    let scene = Scene::from_mesh("", triangle(), MILLIMETRES);
    let (read, warnings) = load_scene(&written(&scene, Some(&certificate)), Format::ThreeMf);
    assert_eq!(read.certificate, Some(certificate));
    assert_eq!(warnings, []);
}

#[test]
fn units_that_3mf_lacks_are_refused_and_unknown_ones_are_taken_for_millimetres() {
    let mut scene = Scene::from_mesh("", triangle(), Frame::default());
    assert_eq!(back(&scene).frame, MILLIMETRES);
    let lost = losses(&scene, Format::ThreeMf).unwrap();
    assert!(lost[0].message.contains("millimetres were taken"), "{}", lost[0]);
    scene.frame.metres_per_unit = Some(1000.0);
    let message = refused(&scene);
    assert!(message.contains("no unit of 1000 m") && message.contains("micron, centimeter"), "{message}");
}

#[test]
fn scenes_that_3mf_cannot_hold_are_refused_by_name() {
    let mut perspective = Scene::from_mesh("", triangle(), MILLIMETRES);
    perspective.nodes[0].matrix[3] = 0.1;
    assert!(refused(&perspective).contains("node 0 has a matrix that is not affine"));
    let mut cycle = Scene::from_mesh("", triangle(), MILLIMETRES);
    cycle.nodes[0].children.push(0);
    assert!(refused(&cycle).contains("no forest"));
    let points = Mesh::new(vec![[0.0; 3]], Vec::new()).unwrap();
    assert!(refused(&Scene::from_mesh("cloud", points, MILLIMETRES)).contains("part \"cloud\" has 1 points"));
    assert_eq!(back(&Scene::default()).parts, []);
}

#[test]
fn triangles_with_a_corner_twice_are_left_out_and_named() {
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2e9, 0.0]];
    let scene = Scene::from_mesh("", Mesh::new(corners, vec![[0, 1, 2], [2, 2, 0]]).unwrap(), MILLIMETRES);
    assert_eq!(back(&scene).parts[0].mesh.faces(), [[0, 1, 2]]);
    let lost: Vec<String> =
        losses(&scene, Format::ThreeMf).unwrap().iter().map(|lost| lost.message.to_string()).collect();
    let limit = "lib3mf, which programs read 3MF by, refuses coordinates over 1,000,000,000";
    assert_eq!(lost, ["3MF holds no triangles with a corner twice", limit]);
}

/// The text of the model part, which the package holds packed.
fn model_text(scene: &Scene) -> String {
    let bytes = written(scene, None);
    let mut at = 0;
    // Local headers one after another: the sizes at 18 and 22, those of name and extra field at 26 and 28.
    while bytes[at..].starts_with(b"PK\x03\x04") {
        let u16_at = |k: usize| usize::from(u16::from_le_bytes([bytes[at + k], bytes[at + k + 1]]));
        let size = u16_at(18) | u16_at(20) << 16;
        let start = at + 30 + u16_at(26) + u16_at(28);
        let name = &bytes[at + 30..][..u16_at(26)];
        if name.ends_with(b".model") {
            let packed = &bytes[start..start + size];
            if u16_at(8) == 0 {
                return String::from_utf8(packed.to_vec()).unwrap();
            }
            let mut text = String::new();
            std::io::Read::read_to_string(&mut flate2::read::DeflateDecoder::new(packed), &mut text).unwrap();
            return text;
        }
        at = start + size;
    }
    panic!("no model")
}

#[test]
fn each_object_has_the_default_colour_of_most_of_its_triangles() {
    let mesh = |values: Vec<f64>| {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mesh = Mesh::new(positions, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]]).unwrap();
        with(mesh, Semantic::Group("material".to_owned()), Domain::Face, 1, values)
    };
    let parts = [vec![1.0, 1.0, 1.0], vec![2.0, 2.0, 2.0], vec![1.0, 3.0, 3.0]];
    let parts: Vec<Part> =
        parts.into_iter().map(|values| Part { mesh: mesh(values), ..Part::default() }).collect();
    let nodes = (0..3).map(|part| node("", IDENTITY, vec![], Some(part))).collect();
    let names = ["", "red", "green", "blue"].map(str::to_owned).to_vec();
    let groups = [("material".to_owned(), names)].into();
    let scene = Scene { parts, nodes, roots: vec![0, 1, 2], groups, frame: MILLIMETRES, ..Scene::default() };
    let text = model_text(&scene);
    let defaults: Vec<&str> = text
        .split("<object ")
        .skip(1)
        .map(|object| object.split("pindex=\"").nth(1).unwrap().split('"').next().unwrap())
        .collect();
    assert_eq!(defaults, ["0", "1", "2"], "{text}");
}

#[test]
fn a_part_without_triangles_is_left_out_beside_others() {
    let point =
        Part { name: "dust".to_owned(), mesh: Mesh::new(vec![[1.0; 3]], vec![]).unwrap(), ..Part::default() };
    let solid = Part { name: "solid".to_owned(), mesh: triangle(), ..Part::default() };
    let nodes = vec![node("", IDENTITY, vec![], Some(0)), node("", IDENTITY, vec![], Some(1))];
    let scene =
        Scene { parts: vec![point, solid], nodes, roots: vec![0, 1], frame: MILLIMETRES, ..Scene::default() };
    let found = back(&scene);
    assert_eq!((found.parts.len(), &*found.parts[0].name, found.nodes.len()), (1, "solid", 1));
    for format in [Format::ThreeMf, Format::Glb] {
        let said: Vec<String> =
            losses(&scene, format).unwrap().iter().map(|lost| lost.message.to_string()).collect();
        assert_eq!(said, ["the part 'dust' has no triangle: its points were left out"], "{format}");
    }
    let mut bytes = Vec::new();
    chordal_io::glb::write(&scene, None, &mut bytes).expect("written");
    let (glb, _) = load_scene(&bytes, Format::Glb);
    assert_eq!((glb.parts.len(), glb.world_meshes().unwrap().len()), (1, 1));
}
