//! What is written reads back, bit for bit.
use super::build::scene_of;
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic, face_normal, vertex_normals, with_tangents};
use chordal_io::{Axis, Format, Frame, Limits, Node, Part, RareValue, Scene, TextureOrigin, glb, snap};
use proptest::prelude::*;
use serde_json::{Value, json};

fn written(scene: &Scene, certificate: Option<&Value>) -> Vec<u8> {
    let mut bytes = Vec::new();
    glb::write(scene, certificate, &mut bytes).expect("written");
    bytes
}

fn again(scene: &Scene) -> (Scene, Vec<&'static str>) {
    scene_of(
        glb::read(&written(scene, None), &Limits::default()).unwrap_or_else(|e| panic!("{}: {e}", e.code)),
    )
}

/// What comes back, placed by its nodes.
fn placed(scene: &Scene) -> Mesh {
    let (scene, _) = again(scene);
    let mut parts = scene.world_meshes().expect("placed");
    assert_eq!(parts.len(), 1);
    parts.remove(0).1.into_owned()
}

fn bits(positions: &[[f64; 3]]) -> Vec<[u64; 3]> {
    // Zero loses its sign in the reader.
    positions.iter().map(|p| p.map(|x| (x + 0.0).to_bits())).collect()
}

pub fn cube() -> Mesh {
    let positions =
        (0..8).map(|i| std::array::from_fn(|k| if i >> k & 1 == 0 { -1.0 } else { 1.0 })).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    Mesh::new(positions, faces).expect("a cube")
}

/// Triangles over random points around a centre, twelve orders of magnitude of sizes and places.
fn any_mesh() -> impl Strategy<Value = Mesh> {
    let point = prop::array::uniform3(-1.0..1.0_f64);
    let exponents = prop::array::uniform4(-6.0..6.0_f64);
    (3..40_usize)
        .prop_flat_map(move |n| {
            let faces = prop::collection::vec(prop::array::uniform3(0..n as u32), 1..60);
            (prop::collection::vec(point.clone(), n), point.clone(), exponents.clone(), faces)
        })
        .prop_map(|(unit, direction, e, faces)| {
            let power = |x| libm::pow(10.0, x);
            let place =
                |u: &[f64; 3]| std::array::from_fn(|k| direction[k] * power(e[k]) + u[k] * power(e[3]));
            Mesh::new(unit.iter().map(place).collect(), faces).expect("finite")
        })
}

proptest! {
    #[test]
    fn positions_and_faces_come_back_to_the_last_bit(mesh in any_mesh()) {
        let snapped = snap(&mesh, Format::Glb).unwrap().mesh;
        for original in [&mesh, &snapped] {
            let back = placed(&Scene::from_mesh("m", original.clone(), Frame::default()));
            prop_assert_eq!(bits(back.positions()), bits(snapped.positions()));
            prop_assert_eq!(back.faces(), mesh.faces());
        }
    }

    #[test]
    fn a_z_up_scene_stands_up_without_rounding(mesh in any_mesh()) {
        let snapped = snap(&mesh, Format::Glb).unwrap().mesh;
        let frame = Frame { up: Some(Axis::Z), metres_per_unit: None, ..Frame::default() };
        let back = placed(&Scene::from_mesh("m", mesh, frame));
        let expected: Vec<_> = snapped.positions().iter().map(|p| [p[0], p[2], -p[1]]).collect();
        prop_assert_eq!(bits(back.positions()), bits(&expected));
    }

    #[test]
    fn the_same_scene_gives_the_same_bytes(mesh in any_mesh()) {
        let scene = Scene::from_mesh("m", mesh, Frame::default());
        prop_assert_eq!(written(&scene, None), written(&scene, None));
        // What was read writes to the same bytes again, where nothing but the mesh is in the file.
        let (back, warnings) = again(&scene);
        prop_assert!(warnings.is_empty(), "{:?}", warnings);
        let (twice, _) = again(&back);
        prop_assert_eq!(back, twice);
    }
}

#[test]
fn attributes_come_back_in_single_precision() {
    let cube = cube();
    let normals = vertex_normals(&cube);
    let stream = |semantic, width: usize, value: fn(usize) -> f64| Attribute {
        semantic,
        domain: Domain::Vertex,
        width,
        values: (0..8 * width).map(value).collect(),
    };
    let mesh = cube
        .with_attribute(Attribute::vertex_normals(&normals))
        .and_then(|m| m.with_attribute(stream(Semantic::TexCoord(0), 2, |i| i as f64 * 0.125)))
        .and_then(|m| m.with_attribute(stream(Semantic::TexCoord(1), 2, |i| -(i as f64))))
        .and_then(|m| m.with_attribute(stream(Semantic::Color(0), 4, |i| i as f64 / 32.0)))
        .and_then(|m| m.with_attribute(stream(Semantic::Custom("_heat".to_owned()), 1, |i| i as f64 * 1e-9)))
        .expect("attributes");
    let (back, warnings) = again(&Scene::from_mesh("cube", mesh.clone(), Frame::default()));
    assert!(warnings.is_empty(), "{warnings:?}");
    let back = &back.parts[0].mesh;
    assert_eq!(back.attributes().len(), 5);
    for attribute in mesh.attributes() {
        let found = back.attribute(&attribute.semantic).expect("kept");
        let rounded: Vec<f64> = attribute.values.iter().map(|x| f64::from(*x as f32)).collect();
        assert_eq!((found.width, &found.values), (attribute.width, &rounded), "{:?}", attribute.semantic);
    }
}

#[test]
fn attributes_of_corners_and_faces_double_vertices_where_they_differ() {
    let cube = cube();
    let normals: Vec<f64> =
        (0..12).flat_map(|f| [face_normal(cube.corners(f)).expect("area"); 3]).flatten().collect();
    let by_corner =
        Attribute { semantic: Semantic::Normal, domain: Domain::Corner, width: 3, values: normals };
    let creased = cube.clone().with_attribute(by_corner).expect("corners");
    let (back, _) = again(&Scene::from_mesh("creased", creased.clone(), Frame::default()));
    let mesh = &back.parts[0].mesh;
    assert_eq!((mesh.positions().len(), mesh.n_positions(), mesh.faces().len()), (24, 8, 12));
    let normals = mesh.attribute(&Semantic::Normal).expect("normals");
    for f in 0..12 {
        assert_eq!(mesh.corners(f), cube.corners(f));
        for vertex in mesh.faces()[f] {
            assert_eq!(normals.row(vertex as usize), face_normal(cube.corners(f)).expect("area"));
        }
    }
    // One colour a face, twice the same on each side: the diagonals of the sides stay shared.
    let group = Semantic::Group("side".to_owned());
    let values = (0..12).map(|f| f64::from(f / 2)).collect();
    let by_face = Attribute { semantic: group, domain: Domain::Face, width: 1, values };
    let grouped = cube.with_attribute(by_face).expect("faces");
    let (back, _) = again(&Scene::from_mesh("grouped", grouped, Frame::default()));
    assert_eq!(back.parts[0].mesh.positions().len(), 24);
    let side = back.parts[0].mesh.attribute(&Semantic::Custom("_side".to_owned())).expect("kept");
    assert_eq!(side.row(back.parts[0].mesh.faces()[11][0] as usize), [5.0]);
}

#[test]
fn a_vertex_without_a_normal_gets_an_axis() {
    let mesh =
        Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).expect("a triangle");
    let mesh = mesh.with_attribute(Attribute::vertex_normals(&[[0.0; 3], [f64::NAN; 3], [0.0, 3.0, 4.0]]));
    let (back, _) = again(&Scene::from_mesh("m", mesh.expect("normals"), Frame::default()));
    let normals = back.parts[0].mesh.attribute(&Semantic::Normal).expect("normals");
    let [six, eight] = [0.6_f32, 0.8].map(f64::from);
    assert_eq!(normals.values, [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, six, eight]);
}

#[test]
fn indices_are_short_while_the_restart_value_is_out_of_reach() {
    for (n, component) in [(65_535, 5123), (65_536, 5125)] {
        let positions = (0..n).map(|i| [f64::from(i % 256), f64::from(i / 256), 0.0]).collect();
        let mesh = Mesh::new(positions, vec![[0, 1, n as u32 - 1]]).expect("a triangle");
        let scene = Scene::from_mesh("m", mesh.clone(), Frame::default());
        let bytes = written(&scene, None);
        let json = String::from_utf8_lossy(&bytes);
        assert!(json.contains(&format!("\"componentType\":{component}")), "{n} vertices");
        assert_eq!(placed(&scene).faces(), mesh.faces());
    }
}

#[test]
fn the_certificate_travels_unchanged() {
    let certificate = json!({
        "version": "0.1.0", "bound": { "at_most": 0.1 + 0.2, "at_least": 5e-324, "evidence": "proved" },
        "output": { "vertices": 24, "triangles": 18_446_744_073_709_551_615_u64 - 18_446_744_073_709_551_600 },
        "notes": ["é \"quoted\" \\ 😀", null, true, -1, []]
    });
    let scene = Scene::from_mesh("cube", cube(), Frame::default());
    let bytes = written(&scene, Some(&certificate));
    let (back, warnings) = scene_of(glb::read(&bytes, &Limits::default()).expect("read"));
    assert_eq!(back.certificate, Some(certificate));
    assert!(warnings.is_empty());
    assert_eq!(again(&scene).0.certificate, None);
}

#[test]
fn nodes_names_and_instances_come_back() {
    let part = |name: &str, mesh| Part { name: name.to_owned(), mesh, indexed: true, ..Part::default() };
    let far = Mesh::new(
        cube().positions().iter().map(|p| [p[0] + 1e6, p[1], p[2]]).collect(),
        cube().faces().to_vec(),
    );
    let node = |name: &str, matrix, children, part| Node {
        name: name.to_owned(),
        matrix: RareValue::from(matrix),
        children,
        part,
        ..Node::default()
    };
    let identity = *Scene::from_mesh("", cube(), Frame::default()).nodes[0].matrix;
    let mut moved = identity;
    moved[12..15].copy_from_slice(&[0.1, -2.0, 1e-3]);
    let turned = [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 5.0, 6.0, 7.0, 1.0];
    let scene = Scene {
        parts: vec![part("cube", cube()), part("far", far.expect("a cube"))],
        nodes: vec![
            node("top", turned, vec![1, 2], Some(1)),
            node("left", moved, vec![], Some(0)),
            node("right", identity, vec![], Some(1)),
        ],
        roots: vec![0],
        frame: Frame {
            up: Some(Axis::Y),
            metres_per_unit: Some(1.0),
            texture_origin: Some(TextureOrigin::UpperLeft),
        },
        certificate: None,
        ..Scene::default()
    };
    let (back, warnings) = again(&scene);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(
        (back.roots.len(), back.nodes[0].name.as_str(), back.nodes[2].name.as_str()),
        (1, "top", "right")
    );
    assert_eq!(*back.nodes[0].matrix, turned);
    // The first cube keeps its place, the one far away gets a node for its origin.
    let before = scene.world_meshes().expect("placed");
    let after = back.world_meshes().expect("placed");
    let sorted = |parts: &[(&str, std::borrow::Cow<'_, Mesh>)]| {
        let mut all: Vec<_> =
            parts.iter().map(|(name, mesh)| ((*name).to_owned(), bits(mesh.positions()))).collect();
        all.sort();
        all
    };
    assert_eq!(sorted(&before), sorted(&after));
}

#[test]
fn a_unit_becomes_a_scale() {
    let frame = Frame { up: None, metres_per_unit: Some(0.001), ..Frame::default() };
    let back = placed(&Scene::from_mesh("cube", cube(), frame));
    assert_eq!(back.positions()[7], [0.001; 3]);
    let kilometres = Frame { up: Some(Axis::Z), metres_per_unit: Some(1000.0), ..Frame::default() };
    assert_eq!(
        placed(&Scene::from_mesh("cube", cube(), kilometres)).positions()[7],
        [1000.0, 1000.0, -1000.0]
    );
}

#[test]
fn nothing_is_written_as_nothing() {
    let empty = Scene::from_mesh("empty", Mesh::default(), Frame::default());
    let (back, _) = again(&empty);
    assert_eq!((back.parts.len(), back.nodes.len()), (0, 1));
    assert_eq!(again(&Scene::default()).0.nodes.len(), 0);
}

#[test]
fn what_gltf_cannot_hold_is_refused_with_a_sentence() {
    let refused = |scene: &Scene| {
        let mut bytes = Vec::new();
        let error = glb::write(scene, None, &mut bytes).map(|()| bytes.len()).expect_err("written");
        assert!(bytes.is_empty(), "half written");
        error.to_string()
    };
    let of = |mesh| Scene::from_mesh("m", mesh, Frame::default());
    let points = Mesh::new(vec![[0.0; 3]], vec![]).expect("a point");
    assert_eq!(refused(&of(points)), "part \"m\" has 1 points and no triangle");
    let huge = Mesh::new(vec![[0.0; 3], [1e39, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).expect("finite");
    assert!(refused(&of(huge)).contains("single precision"));
    let with = |semantic, width, value: f64| {
        let values = vec![value; 8 * width];
        let attribute = Attribute { semantic, domain: Domain::Vertex, width, values };
        refused(&of(cube().with_attribute(attribute).expect("fits")))
    };
    assert!(with(Semantic::Color(0), 3, 1.5).contains("COLOR_0"));
    assert!(with(Semantic::TexCoord(0), 3, 0.5).contains("3 numbers"));
    assert!(with(Semantic::TexCoord(0), 2, f64::NAN).contains("NaN"));
    assert!(with(Semantic::Group("g".to_owned()), 1, 16_777_217.0).contains("16777217"));
    let mut shear = of(cube());
    shear.nodes[0].matrix[4] = 0.5;
    assert_eq!(refused(&shear), "glTF cannot hold the transform of node 0");
    let mut looped = of(cube());
    looped.nodes[0].children = vec![0];
    assert!(refused(&looped).contains("no forest"));
    let mut astray = of(cube());
    astray.nodes[0].part = Some(7);
    assert!(refused(&astray).contains("no forest"));
    let mut unit = of(cube());
    unit.frame.metres_per_unit = Some(0.0);
    assert!(refused(&unit).contains("unit"));
}

#[test]
fn tangents_of_corners_double_the_vertices_where_mirrored_halves_meet() {
    // Two quads side by side, of which the second shows the texture of the first the other way round.
    let positions = (0..6).map(|i| [f64::from(i % 3), f64::from(i / 3), 0.0]).collect();
    let values = (0..6).flat_map(|i| [if i % 3 == 1 { 1.0 } else { 0.0 }, f64::from(i / 3)]).collect();
    let texture = Attribute { semantic: Semantic::TexCoord(0), domain: Domain::Vertex, width: 2, values };
    let normals = Attribute::vertex_normals(&[[0.0, 0.0, 1.0]; 6]);
    let faces = vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
    let mesh = Mesh::new(positions, faces)
        .and_then(|mesh| mesh.with_attribute(texture))
        .and_then(|mesh| mesh.with_attribute(normals))
        .expect("two quads");
    let mesh = with_tangents(&mesh, 0).expect("coordinates and normals").expect("few rows");
    let (back, _) = again(&Scene::from_triangle_soup("", mesh, Frame::default()));
    let part = &back.parts[0].mesh;
    assert_eq!((part.positions().len(), part.n_positions()), (8, 6));
    let tangents = part.attribute(&Semantic::Tangent).expect("tangents");
    for (face, expected) in [(0, [1.0, 0.0, 0.0, 1.0]), (2, [-1.0, 0.0, 0.0, -1.0])] {
        for row in part.faces()[face] {
            assert_eq!(tangents.row(row as usize), expected, "face {face}");
        }
    }
}
