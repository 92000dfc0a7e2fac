//! What is written comes back.
use super::{file, polygons, scene, triangle};
use chordal::Mesh;
use chordal::explicit::subdivision::{Boundary, CornerTexcoords, CreasingMethod, LinearTexcoords, Scheme};
use chordal::explicit::{Attribute, Cage, Domain, Semantic};
use chordal_io::{
    Axis, Content, Format, Frame, ImageContent, Limits, MATERIAL, Node, Part, Polygons, Scene, SceneImage,
    TextureOrigin, losses, losses_of_polygons, read_with, usd, write_files,
};
use serde_json::{Map, json};

fn frame() -> Frame {
    Frame { up: Some(Axis::Z), metres_per_unit: Some(0.001), texture_origin: Some(TextureOrigin::LowerLeft) }
}

fn written(scene: &Scene) -> String {
    let mut bytes = Vec::new();
    usd::write(scene, Some(&json!({ "a\"b\\": ["\n", 1.5] })), &mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// Two triangles with everything that is kept; their corners at points 1 and 2 differ.
fn rich() -> Mesh {
    let points = vec![
        [0.1, -0.0, 1e-300],
        [1.0 / 3.0, 0.0, 5e6],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [1.0 / 3.0, 0.0, 5e6],
        [0.0, 1.0, 0.0],
    ];
    let stream = |semantic, domain, width: usize, rows: usize| Attribute {
        semantic,
        domain,
        width,
        values: (0..width * rows).map(|i| i as f64 / 64.0).collect(),
    };
    let normals = Attribute {
        semantic: Semantic::Normal,
        domain: Domain::Vertex,
        width: 3,
        values: [0.0, 0.6, 0.8].repeat(6),
    };
    Mesh::new(points, vec![[0, 1, 2], [3, 5, 4]])
        .and_then(|mesh| mesh.with_position_id(vec![0, 1, 2, 3, 1, 2]))
        .and_then(|mesh| mesh.with_attribute(normals))
        .and_then(|mesh| mesh.with_attribute(stream(Semantic::Color(0), Domain::Vertex, 4, 6)))
        .and_then(|mesh| mesh.with_attribute(stream(Semantic::TexCoord(0), Domain::Vertex, 2, 6)))
        .and_then(|mesh| {
            mesh.with_attribute(Attribute {
                semantic: Semantic::Group(MATERIAL.into()),
                domain: Domain::Face,
                width: 1,
                values: vec![2.0, 1.0],
            })
        })
        .unwrap()
}

#[test]
fn parts_nodes_and_attributes_keep_every_bit() {
    let mut scene_in = Scene { frame: frame(), ..Scene::default() };
    scene_in.parts = vec![
        Part { name: "ri ch".into(), mesh: rich(), indexed: true, ..Part::default() },
        Part {
            name: "plain".into(),
            mesh: Mesh::new(vec![[0.0; 3], [1.5, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap(),
            indexed: true,
            ..Part::default()
        },
    ];
    scene_in.groups.insert(MATERIAL.into(), vec![String::new(), "red".into(), "blue 1".into()]);
    scene_in.assets.materials = ["red", "blue 1"].map(|name| json!({ "name": name, "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.3, 0.5], "metallicFactor": 0.25, "roughnessFactor": 0.75 }, "alphaMode": "BLEND", "doubleSided": true })).to_vec();
    let mut matrix = *Node::default().matrix;
    (matrix[0], matrix[5], matrix[12]) = (-0.1, 0.3, 1.0 / 7.0);
    let node = |name: &str, part, children: &[usize]| Node {
        name: name.into(),
        part,
        children: children.to_vec(),
        ..Node::default()
    };
    scene_in.nodes = vec![
        node("top", None, &[1, 2, 3]),
        node("ri ch", Some(0), &[]),
        Node { matrix: matrix.into(), ..node("again", Some(0), &[]) },
        node("plain", Some(1), &[]),
    ];
    scene_in.roots = vec![0];
    scene_in.certificate = Some(json!({ "a\"b\\": ["\n", 1.5] }));
    let text = written(&scene_in);
    let back = scene(&text);
    // Rows of one point are in the order of their use.
    assert_eq!(back.nodes, scene_in.nodes);
    assert_eq!(
        (back.parts.len(), &back.parts[1], &back.certificate),
        (2, &scene_in.parts[1], &scene_in.certificate)
    );
    for face in 0..2 {
        let (a, b) = (&back.parts[0].mesh, &scene_in.parts[0].mesh);
        assert_eq!(
            a.corners(face).map(|p| p.map(f64::to_bits)),
            b.corners(face).map(|p| p.map(f64::to_bits))
        );
        for semantic in [Semantic::Normal, Semantic::Color(0), Semantic::TexCoord(0)] {
            for k in 0..3 {
                let row = |mesh: &Mesh| {
                    mesh.attribute(&semantic).unwrap().row(mesh.faces()[face][k] as usize).to_vec()
                };
                assert_eq!(row(a), row(b), "{semantic:?}");
            }
        }
        let name = |scene: &Scene| {
            let group = scene.parts[0].mesh.attribute(&Semantic::Group(MATERIAL.into())).unwrap().row(face)[0]
                as usize;
            (scene.groups[MATERIAL][group].clone(), scene.assets.materials[group - 1].clone())
        };
        assert_eq!(name(&back), name(&scene_in));
    }
    // What came back is written and read as it is.
    let again = scene(&written(&back));
    assert_eq!((&again.parts, &again.nodes, &again.assets), (&back.parts, &back.nodes, &back.assets));
    assert!(losses(&scene_in, Format::Usda).unwrap().is_empty(), "{:?}", losses(&scene_in, Format::Usda));
}

#[test]
fn several_roots_stand_below_one() {
    let mesh = || Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let mut two = Scene::from_mesh("1 a", mesh(), frame());
    two.nodes.push(Node { name: "1_a".into(), part: Some(0), ..Node::default() });
    two.roots.push(1);
    let back = scene(&written(&two));
    let names: Vec<&str> = back.nodes.iter().map(|node| &*node.name).collect();
    assert_eq!((names, back.roots.clone(), back.parts.len()), (vec!["Scene", "1 a", "1_a"], vec![0], 1));
    let unknown = losses(&Scene::from_mesh("a", mesh(), Frame::default()), Format::Usda).unwrap();
    assert_eq!(unknown.len(), 2, "a unit and an axis were taken");
    let empty = scene(&written(&Scene { frame: frame(), ..Scene::default() }));
    assert!(empty.parts.is_empty());
}

#[test]
fn pictures_stand_beside_and_come_back_byte_for_byte() {
    let png = b"\x89PNG\r\n\x1a\n0123456789";
    let mut scene_in = scene(&file(&triangle("m")));
    let group = Attribute {
        semantic: Semantic::Group(MATERIAL.into()),
        domain: Domain::Face,
        width: 1,
        values: vec![1.0],
    };
    scene_in.parts[0].mesh = scene_in.parts[0].mesh.clone().with_attribute(group).unwrap();
    scene_in.groups.insert(MATERIAL.into(), vec![String::new(), "tex".into()]);
    let properties: Map<_, _> =
        [("name".to_owned(), json!("pic")), ("mimeType".to_owned(), json!("image/png"))]
            .into_iter()
            .collect();
    scene_in.assets.images =
        vec![SceneImage { properties, content: ImageContent::Bytes(png.to_vec().into()) }];
    scene_in.assets.samplers = vec![json!({ "wrapS": 33071, "wrapT": 33648 })];
    scene_in.assets.textures = vec![json!({ "source": 0, "sampler": 0 })];
    let moved = json!({ "index": 0, "extensions": { "KHR_texture_transform": { "offset": [0.5, -3.25], "scale": [2.0, 4.0] } } });
    scene_in.assets.materials = vec![json!({
        "name": "tex",
        "pbrMetallicRoughness": { "baseColorTexture": moved, "baseColorFactor": [0.5, 1.0, 0.25, 1.0], "metallicRoughnessTexture": { "index": 0 }, "metallicFactor": 0.5, "roughnessFactor": 0.75 },
        "alphaMode": "MASK", "alphaCutoff": 0.25, "normalTexture": { "index": 0 }, "occlusionTexture": { "index": 0 },
        "emissiveTexture": { "index": 0 }, "emissiveFactor": [0.5, 1.0, 0.0],
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 }, "KHR_materials_clearcoat": { "clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25 }, "KHR_materials_ior": { "ior": 1.25 } },
    })];
    let set = write_files(&scene_in, None, Format::Usda, "a b@").unwrap();
    assert_eq!(
        (set.beside.len(), &*set.beside[0].name, &*set.beside[0].bytes),
        (1, "a_b__image_0.png", &png[..])
    );
    let mut open =
        |path: &str| if path == "a_b__image_0.png" { Ok(png.to_vec()) } else { Err("no".to_owned()) };
    let outcome = read_with(&set.document, Format::Usda, &mut open, &Limits::default()).unwrap();
    let Content::Scene(back) = outcome.content else { panic!("a scene") };
    assert_eq!(outcome.warnings, []);
    assert_eq!(back.assets.materials, scene_in.assets.materials);
    assert_eq!(
        (&back.assets.textures, &back.assets.samplers),
        (&scene_in.assets.textures, &scene_in.assets.samplers)
    );
    assert_eq!(back.assets.images[0].content, scene_in.assets.images[0].content);
}

#[test]
fn a_cage_comes_back_whole() {
    let points =
        (0..8).map(|i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -1.0 / 3.0 } else { 0.1 })).collect();
    let sides: [&[u32]; 5] = [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2]];
    let texcoords = CornerTexcoords {
        values: vec![[0.5, 0.25], [1.0 / 3.0, 2.0], [7.0, 8.0]],
        corners: (0..20).map(|i| i % 3).collect(),
        linear: LinearTexcoords::CornersPlus2,
    };
    let cage = Cage::new(points, sides)
        .and_then(|cage| cage.with_creases(&[([0, 1], 2.5), ([4, 5], 10.0)]))
        .and_then(|cage| cage.with_sharp_vertices(&[(7, 0.1)]))
        .and_then(|cage| cage.with_holes(&[1]))
        .and_then(|cage| cage.with_texcoords(texcoords))
        .map(|cage| {
            cage.with_boundary(Boundary::EdgeAndCorner)
                .with_creasing(CreasingMethod::Chaikin)
                .with_corners_listed()
        })
        .unwrap();
    let mut shape = Polygons::from_cage(cage, frame());
    shape.attributes.push(Attribute {
        semantic: Semantic::Color(0),
        domain: Domain::Vertex,
        width: 3,
        values: (0..24).map(|i| f64::from(i) / 32.0).collect(),
    });
    shape.attributes.push(Attribute {
        semantic: Semantic::Group("g".into()),
        domain: Domain::Face,
        width: 1,
        values: vec![1.0, 0.0, 2.0, 2.0, 1.0],
    });
    shape.groups.insert("g".into(), vec![String::new(), "left side".into(), "right".into()]);
    let mut bytes = Vec::new();
    usd::write_polygons(&shape, None, &mut bytes).unwrap();
    assert_eq!(polygons(std::str::from_utf8(&bytes).unwrap()), shape);
    assert!(losses_of_polygons(&shape, Format::Usda).is_empty());
    for scheme in [Scheme::CatmullClark, Scheme::Bilinear, Scheme::Loop] {
        for boundary in [Boundary::None, Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
            let cage = Cage::new(points, [[0, 1, 2]])
                .and_then(|cage| cage.with_scheme(scheme))
                .unwrap()
                .with_boundary(boundary);
            let mut bytes = Vec::new();
            usd::write_polygons(&Polygons::from_cage(cage.clone(), frame()), None, &mut bytes).unwrap();
            assert_eq!(polygons(std::str::from_utf8(&bytes).unwrap()).cage, cage);
        }
    }
}

#[test]
fn a_mesh_with_another_name_than_its_node_stands_below_it() {
    let mut named = Scene::from_mesh("mesh", rich(), frame());
    named.nodes[0].name = "node".to_owned();
    let back = scene(&written(&named));
    assert_eq!((&*back.nodes[0].name, &*back.parts[0].name), ("node", "mesh"));
}
