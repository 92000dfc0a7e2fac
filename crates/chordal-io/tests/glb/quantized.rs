//! What is written in fewer bits (`KHR_mesh_quantization`) reads back as what was rounded, to the last bit.
use super::build::scene_of;
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal_io::glb::{GltfPacking, PositionLattice, VertexStorage, write};
use chordal_io::{Frame, Limits, Node, Part, Scene, glb, read_with};
use chordal_testkit::Random;
use serde_json::Value;

const SMALL: GltfPacking = GltfPacking { is_compressed: false, is_quantized: true };

/// A strip of triangles with normals, texture coordinates and colours, its corners about `centre`.
fn strip(random: &mut Random, n: usize, centre: [f64; 3], size: f64) -> Mesh {
    let positions: Vec<[f64; 3]> = (0..n)
        .map(|_| {
            let p: [f64; 3] = random.point();
            [0, 1, 2].map(|k| centre[k] + size * p[k])
        })
        .collect();
    let faces = (0..n as u32 - 2).map(|i| [i, i + 1, i + 2]).collect();
    let normals = (0..n).flat_map(|_| random.direction::<3>()).collect();
    let texcoords = (0..2 * n).map(|_| random.unit()).collect();
    let colours = (0..4 * n).map(|_| random.below(256) as f64 / 255.0).collect();
    let attribute = |semantic, width, values| Attribute { semantic, domain: Domain::Vertex, width, values };
    Mesh::new(positions, faces)
        .and_then(|mesh| mesh.with_attribute(attribute(Semantic::Normal, 3, normals)))
        .and_then(|mesh| mesh.with_attribute(attribute(Semantic::TexCoord(0), 2, texcoords)))
        .and_then(|mesh| mesh.with_attribute(attribute(Semantic::Color(0), 4, colours)))
        .expect("a strip")
}

/// The positions of every part where the nodes put them, in the order of the nodes, by sums and products that are
/// exact for scales by powers of two.
fn placed(scene: &Scene) -> Vec<Vec<[f64; 3]>> {
    let mut open: Vec<(usize, Vec<[f64; 16]>)> = scene.roots.iter().rev().map(|r| (*r, Vec::new())).collect();
    let mut all = Vec::new();
    while let Some((node, above)) = open.pop() {
        let node = &scene.nodes[node];
        let chain: Vec<[f64; 16]> = above.iter().copied().chain([*node.matrix]).collect();
        if let Some(part) = node.part {
            let apply = |p: [f64; 3], m: &[f64; 16]| {
                [0, 1, 2].map(|k| m[k] * p[0] + m[4 + k] * p[1] + m[8 + k] * p[2] + m[12 + k])
            };
            let positions = scene.parts[part].mesh.positions().iter();
            all.push(positions.map(|p| chain.iter().rev().fold(*p, apply)).collect());
        }
        open.extend(node.children.iter().rev().map(|child| (*child, chain.clone())));
    }
    all
}

fn file_of(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(scene, None, &mut bytes).expect("written");
    bytes
}

fn read_back(bytes: &[u8]) -> Scene {
    let (scene, warnings) = scene_of(glb::read(bytes, &Limits::default()).expect("readable"));
    assert_eq!(warnings, [""; 0]);
    scene
}

fn json_of(file: &[u8]) -> Value {
    let n = u32::from_le_bytes([file[12], file[13], file[14], file[15]]) as usize;
    serde_json::from_slice(&file[20..20 + n]).expect("JSON")
}

fn small(mesh: Mesh) -> Scene {
    Scene { packing: SMALL, ..Scene::from_mesh("part", mesh, Frame::default()) }
}

#[test]
fn rounded_positions_and_attributes_come_back_to_the_last_bit() {
    let mut random = Random::new(7);
    let centres = [[0.0; 3], [3.0, -7.0, 0.5], [5e6, -4.5e6, 100.0]];
    for centre in centres {
        for size in [1e-3, 1.0, 250.0] {
            for is_compressed in [false, true] {
                let mesh = strip(&mut random, 40, centre, size);
                let storage = VertexStorage::of(&mesh);
                let lattice = storage.lattice.expect("a lattice");
                let rounded = storage.round_attributes(&lattice.snap(&mesh).mesh).expect("rounded");
                let mut scene = small(rounded.clone());
                scene.packing.is_compressed = is_compressed;
                let back = read_back(&file_of(&scene));
                let mut found = placed(&back).remove(0);
                let mut expected = rounded.positions().to_vec();
                if is_compressed {
                    // Vertices come in another order.
                    found.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
                    expected.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
                }
                assert_eq!(found, expected, "{centre:?} {size}");
                if !is_compressed {
                    assert_eq!(back.parts[0].mesh.attributes(), rounded.attributes());
                }
                // What was not rounded before is rounded alike as it is written.
                let mut raw = small(mesh);
                raw.packing.is_compressed = is_compressed;
                if !is_compressed {
                    assert_eq!(placed(&read_back(&file_of(&raw)))[0], rounded.positions());
                }
            }
        }
    }
}

#[test]
fn a_second_time_moves_nothing() {
    let mesh = strip(&mut Random::new(11), 40, [3.0, 4.0, 5.0], 2.0);
    let once = read_back(&file_of(&small(mesh)));
    let twice = read_back(&file_of(&Scene { packing: SMALL, ..once.clone() }));
    assert_eq!(placed(&twice), placed(&once));
    assert_eq!(twice.parts[0].mesh.attributes(), once.parts[0].mesh.attributes());
}

#[test]
fn numbers_have_the_forms_that_are_said_and_the_extension_is_required() {
    let mesh = strip(&mut Random::new(13), 40, [0.0; 3], 1.0);
    let json = json_of(&file_of(&small(mesh.clone())));
    for list in ["extensionsUsed", "extensionsRequired"] {
        assert_eq!(json[list], serde_json::json!(["KHR_mesh_quantization"]));
    }
    let attributes = json["meshes"][0]["primitives"][0]["attributes"].as_object().expect("attributes");
    let form = |name: &str| {
        let accessor = &json["accessors"][attributes[name].as_u64().expect("an index") as usize];
        let view = &json["bufferViews"][accessor["bufferView"].as_u64().expect("a view") as usize];
        (
            accessor["componentType"].as_u64().expect("a type"),
            accessor["normalized"] == true,
            view["byteStride"].as_u64().unwrap_or(0),
        )
    };
    assert_eq!(form("POSITION"), (5123, false, 8));
    assert_eq!(form("NORMAL"), (5120, true, 4));
    assert_eq!(form("TEXCOORD_0"), (5123, true, 0));
    assert_eq!(form("COLOR_0"), (5121, true, 0));
    let plain = json_of(&file_of(&Scene { packing: GltfPacking::default(), ..small(mesh) }));
    assert!(plain["extensionsUsed"].is_null());
}

#[test]
fn nodes_place_instances_cameras_and_children_as_before() {
    let mut random = Random::new(17);
    let mesh = strip(&mut random, 12, [100.0, 0.0, 0.0], 1.0);
    let lattice = PositionLattice::for_mesh(&mesh).expect("a lattice");
    let mut scene = small(lattice.snap(&mesh).mesh);
    let scaled = |s: f64, x: f64| {
        let mut matrix = Node::default().matrix;
        (matrix[0], matrix[5], matrix[10], matrix[12]) = (s, s, s, x);
        matrix
    };
    scene.nodes[0].matrix = scaled(4.0, 1.0);
    scene.nodes[0].children = vec![1];
    scene.nodes.push(Node { matrix: scaled(0.5, -2.0), part: Some(0), ..Node::default() });
    scene.nodes.push(Node { matrix: scaled(-2.0, 0.0), part: Some(0), ..Node::default() });
    scene.roots.push(2);
    let plain = Scene { packing: GltfPacking::default(), ..scene.clone() };
    let back = read_back(&file_of(&scene));
    let sorted = |scene: &Scene| {
        let mut all = placed(scene);
        all.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        all
    };
    assert_eq!(sorted(&back), sorted(&plain));
    // The nodes of the scene keep their own transforms; what undoes the rounding is below them.
    for (before, after) in scene.nodes.iter().zip(&back.nodes) {
        assert_eq!((&before.matrix, after.part), (&after.matrix, None));
    }
    assert_eq!(json_of(&file_of(&scene))["meshes"].as_array().map(Vec::len), Some(1));
}

#[test]
fn odd_extents_have_an_answer() {
    let mut random = Random::new(19);
    let flat = |mesh: Mesh| {
        let positions = mesh.positions().iter().map(|p| [p[0], p[1], 7.25]).collect();
        mesh.with_positions(positions).expect("flat")
    };
    let point = |mesh: Mesh| {
        let positions = vec![[1.0, 2.0, 3.0]; mesh.positions().len()];
        mesh.with_positions(positions).expect("a point")
    };
    for (size, is_short) in [(1e-30, false), (1e-6, true), (1e15, true), (1e30, false)] {
        let mesh = strip(&mut random, 12, [0.0; 3], size);
        let scene = small(mesh.clone());
        let json = json_of(&file_of(&scene));
        let position = json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().expect("one");
        let component = &json["accessors"][position as usize]["componentType"];
        assert_eq!(*component == 5123, is_short, "{size}");
        let back = placed(&read_back(&file_of(&scene))).remove(0);
        for (a, b) in back.iter().zip(mesh.positions()) {
            assert!((0..3).all(|k| (a[k] - b[k]).abs() <= size / 16384.0), "{size}: {a:?} {b:?}");
        }
    }
    for mesh in [flat(strip(&mut random, 12, [0.0; 3], 1.0)), point(strip(&mut random, 12, [0.0; 3], 1.0))] {
        let rounded = VertexStorage::of(&mesh).lattice.expect("a lattice").snap(&mesh).mesh;
        let scene = small(mesh);
        assert_eq!(placed(&read_back(&file_of(&scene)))[0], rounded.positions());
    }
}

#[test]
fn parts_on_one_lattice_keep_their_shared_corners() {
    // Two halves of one strip, as tiles have them: each is stored about a corner of its own.
    let mut random = Random::new(23);
    let whole = strip(&mut random, 60, [12.0, -3.0, 8.0], 5.0);
    let lattice = PositionLattice::for_mesh(&whole).expect("a lattice");
    let positions = lattice.snap(&whole).mesh.positions().to_vec();
    let half = |range: std::ops::Range<usize>| {
        let faces = (0..range.len() as u32 - 2).map(|i| [i, i + 1, i + 2]).collect();
        let mesh = Mesh::new(positions[range].to_vec(), faces).expect("half");
        Part { mesh, storage: Some(Box::new(VertexStorage::with_lattice(Some(lattice)))), ..Part::default() }
    };
    let read = |part: Part| {
        let scene = Scene { packing: SMALL, ..Scene::from_part(part, Frame::default()) };
        placed(&read_back(&file_of(&scene))).remove(0)
    };
    let (first, second) = (read(half(0..32)), read(half(28..60)));
    assert_eq!(first[28..], second[..4]);
    assert_eq!([&first[..28], &second[..]].concat(), positions);
}

#[test]
fn a_level_that_16_bits_do_not_reach_stays_exact_in_single_precision() {
    let mesh = strip(&mut Random::new(29), 40, [10.0, 20.0, 30.0], 5.0);
    let finer = mesh.positions().iter().map(|p| p.map(|x| x / 8.0)).collect();
    let lattice = PositionLattice::for_mesh(&mesh.with_positions(finer).expect("finer")).expect("a lattice");
    let rounded = lattice.snap(&mesh).mesh;
    let storage = Some(VertexStorage::with_lattice(Some(lattice)));
    let part = Part { mesh: rounded.clone(), storage: storage.map(Box::new), ..Part::default() };
    let file = file_of(&Scene { packing: SMALL, ..Scene::from_part(part, Frame::default()) });
    assert_eq!(placed(&read_back(&file))[0], rounded.positions());
}

#[test]
fn files_of_fewer_bits_are_smaller_and_smaller_still_compressed() {
    let mesh = strip(&mut Random::new(31), 2000, [0.0; 3], 1.0);
    let size = |is_quantized, is_compressed| {
        let packing = GltfPacking { is_compressed, is_quantized };
        file_of(&Scene { packing, ..small(mesh.clone()) }).len()
    };
    // A vertex has 20 bytes in place of 48, and two of its three indices are shared.
    assert!(size(true, false) * 3 < size(false, false) * 2);
    assert!(size(true, true) < size(true, false).min(size(false, true)));
}

#[test]
fn the_reader_of_other_openers_takes_it_too() {
    let mesh = strip(&mut Random::new(37), 12, [0.0; 3], 1.0);
    let mut text = Vec::new();
    glb::write_embedded(&small(mesh), None, &mut text).expect("written");
    let mut nothing_beside = |name: &str| Err(format!("'{name}' is not asked for"));
    let read =
        read_with(&text, chordal_io::Format::Gltf, &mut nothing_beside, &Limits::default()).expect("read");
    assert_eq!(scene_of(read).0.parts[0].mesh.faces().len(), 10);
}
