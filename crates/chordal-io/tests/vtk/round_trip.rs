//! What is written as PolyData reads back.
use crate::common::{count, load_scene};
use chordal::Mesh;
use chordal::explicit::{Attribute, Cage, Domain, Semantic};
use chordal_io::{Format, Frame, Node, Polygons, Scene, TextureOrigin, losses, write, write_polygons};
use chordal_testkit::Random;
use serde_json::json;

fn stream(semantic: Semantic, domain: Domain, width: usize, values: Vec<f64>) -> Attribute {
    Attribute { semantic, domain, width, values }
}

fn written(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(scene, Some(&json!({"bound": 0.1, "text": "a\n<b> \u{e9}"})), Format::Vtp, &mut bytes)
        .expect("written");
    assert_eq!(Format::sniff(&bytes), Some(Format::Vtp));
    bytes
}

/// A number from all of the range of f64 now and then.
fn number(random: &mut Random) -> f64 {
    match random.below(6) {
        0 => [0.0, -0.0, 1e300, -1e300, 4e-324, 0.1][random.below(6)],
        _ => random.unit() * 20.0 - 10.0,
    }
}

fn random_mesh(random: &mut Random) -> Mesh {
    let n = 3 + random.below(30);
    let mut values = |n: usize| -> Vec<f64> { (0..n).map(|_| number(random)).collect() };
    let positions: Vec<[f64; 3]> = values(3 * n).chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    let [uv, weight, area] = [values(2 * n), values(n), values(4 * 2 * n)];
    let faces = (0..2 * n).map(|_| std::array::from_fn(|_| random.below(n) as u32)).collect();
    let colors = (0..3 * n).map(|_| random.below(256) as f64 / 255.0).collect();
    let shares = (0..8 * n).map(|_| random.unit()).collect();
    let ids = (0..n as u32).collect();
    Mesh::new(positions, faces)
        .and_then(|m| m.with_position_id(ids))
        .and_then(|m| m.with_attribute(stream(Semantic::TexCoord(0), Domain::Vertex, 2, uv)))
        .and_then(|m| m.with_attribute(stream(Semantic::Color(0), Domain::Vertex, 3, colors)))
        .and_then(|m| {
            m.with_attribute(stream(Semantic::Custom("a \"b\" <".into()), Domain::Vertex, 1, weight))
        })
        .and_then(|m| m.with_attribute(stream(Semantic::Custom("a".into()), Domain::Face, 4, area)))
        .and_then(|m| m.with_attribute(stream(Semantic::Color(1), Domain::Face, 4, shares)))
        .expect("valid")
}

/// A mesh with every number as its bits.
fn bits(mesh: &Mesh) -> Vec<u64> {
    let values = mesh.attributes().iter().flat_map(|a| &a.values);
    mesh.positions().as_flattened().iter().chain(values).map(|x| x.to_bits()).collect()
}

#[test]
fn meshes_come_back_to_the_last_bit() {
    let seed = 71;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for _ in 0..100 {
        let mesh = random_mesh(&mut random);
        let scene = Scene::from_mesh("x", mesh.clone(), Frame::default());
        assert_eq!(losses(&scene, Format::Vtp).unwrap(), []);
        let bytes = written(&scene);
        let (back, _) = load_scene(&bytes, Format::Vtp);
        assert_eq!(back.certificate, Some(json!({"bound": 0.1, "text": "a\n<b> \u{e9}"})));
        assert_eq!(bits(&back.parts[0].mesh), bits(&mesh));
        assert_eq!(back.parts[0].mesh, mesh);
        assert_eq!(written(&back), bytes, "the second time nothing changes");
    }
}

#[test]
fn parts_are_joined_with_all_that_some_have() {
    let triangle = |x: f64| {
        Mesh::new(vec![[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0]], vec![[0, 1, 2]]).expect("valid")
    };
    let colored = triangle(1.0)
        .with_attribute(stream(Semantic::Color(0), Domain::Vertex, 4, vec![0.5; 12]))
        .and_then(|m| m.with_attribute(stream(Semantic::TexCoord(0), Domain::Vertex, 2, vec![0.25; 6])))
        .and_then(|m| m.with_attribute(stream(Semantic::Custom("q".into()), Domain::Corner, 1, vec![1.0; 3])))
        .unwrap();
    let frame = Frame { texture_origin: Some(TextureOrigin::UpperLeft), ..Frame::default() };
    let mut scene = Scene::from_mesh("a", triangle(0.0), frame);
    scene.parts.push(Scene::from_mesh("b", colored, Frame::default()).parts.remove(0));
    let mut matrix = Node::default().matrix;
    (matrix[0], matrix[12]) = (-1.0, 5.0);
    scene.nodes.push(Node { part: Some(1), matrix, ..Node::default() });
    scene.roots.push(1);
    let lost: Vec<String> =
        losses(&scene, Format::Vtp).unwrap().iter().map(|w| w.message.to_string()).collect();
    assert_eq!(lost, ["VTP holds one part: all were joined", "VTP holds no values 'q' of corners"]);
    let (back, _) = load_scene(&written(&scene), Format::Vtp);
    let mesh = &back.parts[0].mesh;
    assert_eq!(mesh.positions()[3], [4.0, 0.0, 0.0]);
    // The mirrored part is wound the other way round.
    assert_eq!(mesh.faces(), [[0, 1, 2], [3, 5, 4]]);
    assert_eq!(mesh.attribute(&Semantic::Color(0)).unwrap().row(0), [1.0; 4]);
    assert_eq!(mesh.attribute(&Semantic::Color(0)).unwrap().row(3), [0.5; 4]);
    // Pictures begin at the other corner.
    assert_eq!(mesh.attribute(&Semantic::TexCoord(0)).unwrap().row(3), [0.25, 0.75]);
    assert_eq!(back.frame.texture_origin, Some(TextureOrigin::LowerLeft));
}

#[test]
fn polygons_stay_polygons() {
    let positions = vec![[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.5, 0.0]];
    let cage = Cage::new(positions.clone(), [vec![0, 1, 2, 3], vec![1, 4, 2]]).unwrap();
    let mut bytes = Vec::new();
    write_polygons(&Polygons::from_cage(cage, Frame::default()), Some(&json!(1)), Format::Vtp, &mut bytes)
        .unwrap();
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains("NumberOfPolys=\"2\""));
    let end: Vec<u8> = [4_i32, 7].iter().flat_map(|x| x.to_le_bytes()).collect();
    assert!(bytes.windows(8).any(|window| window == end), "the ends of a quad and a triangle");
    let (back, warnings) = load_scene(&bytes, Format::Vtp);
    assert_eq!(back.parts[0].mesh.positions(), positions);
    assert_eq!((back.parts[0].mesh.faces().len(), count(&warnings, "polygons-cut")), (3, 1));
    assert_eq!(back.certificate, Some(json!(1)));
}
