//! Skins and morph targets: vertices carry them, and files hold them again.
use super::build::{glb_of, scene_of, strict, triangle};
use chordal::explicit::{Domain, Semantic};
use chordal_io::{Conformance, Limits, ReadError, ReadOutcome, Scene, glb};
use serde_json::{Value, json};

/// Joints of the skin: more than one attribute holds.
const N_JOINTS: usize = 20;

/// The joints of each vertex of a square and their weights.
const JOINTS: [[u8; 4]; 4] = [[0, 19, 0, 0], [19, 3, 7, 1], [0, 0, 0, 0], [1, 2, 16, 17]];
const WEIGHTS: [[f32; 4]; 4] =
    [[0.75, 0.25, 0.0, 0.0], [0.25, 0.25, 0.25, 0.25], [1.0, 0.0, 0.0, 0.0], [0.5, 0.25, 0.125, 0.125]];

/// How far two morph targets move the vertices.
const MOVES: [[[f32; 3]; 4]; 2] = [
    [[0.0, 0.0, 1.0], [0.0, 0.5, 0.0], [0.25, 0.0, 0.0], [0.0; 3]],
    [[0.0; 3], [0.0; 3], [0.0; 3], [-1.0, 2.0, -3.0]],
];

/// A buffer with views and accessors over it.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    fn add(&mut self, bytes: Vec<u8>, accessor: Value) -> usize {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        let mut accessor = accessor;
        accessor["bufferView"] = json!(self.views.len() - 1);
        self.accessors.push(accessor);
        self.bytes.extend(bytes);
        self.accessors.len() - 1
    }

    fn floats(&mut self, kind: &str, width: usize, values: &[f32], bounds: bool) -> usize {
        let mut accessor = json!({ "componentType": 5126, "count": values.len() / width, "type": kind });
        if bounds {
            let of = |k: usize, best: fn(f32, f32) -> f32| {
                values.iter().skip(k).step_by(width).copied().reduce(best).expect("some")
            };
            accessor["min"] = (0..width).map(|k| of(k, f32::min)).collect();
            accessor["max"] = (0..width).map(|k| of(k, f32::max)).collect();
        }
        self.add(values.iter().flat_map(|x| x.to_le_bytes()).collect(), accessor)
    }
}

/// A square that two nodes show, one with a skin, and an animation of its morph targets.
fn document() -> (Value, Vec<u8>) {
    let mut buffer = Buffer::default();
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0_f32]];
    let position = buffer.floats("VEC3", 3, square.as_flattened(), true);
    let joints = buffer
        .add(JOINTS.as_flattened().to_vec(), json!({ "componentType": 5121, "count": 4, "type": "VEC4" }));
    let weights = buffer.floats("VEC4", 4, WEIGHTS.as_flattened(), false);
    let targets: Vec<Value> = MOVES
        .iter()
        .map(|moves| json!({ "POSITION": buffer.floats("VEC3", 3, moves.as_flattened(), true) }))
        .collect();
    let indices = [0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()).collect();
    let indices = buffer.add(indices, json!({ "componentType": 5123, "count": 6, "type": "SCALAR" }));
    let mut one = [0.0_f32; 16];
    [0, 5, 10, 15].iter().for_each(|k| one[*k] = 1.0);
    let matrices = buffer.floats("MAT4", 16, &one.repeat(N_JOINTS), false);
    let times = buffer.floats("SCALAR", 1, &[0.0, 1.0], true);
    let keys = buffer.floats("SCALAR", 1, &[0.0, 0.0, 1.0, 0.5], false);
    // Nodes: a root, the skinned square, the plain one, joints.
    let mut nodes = vec![
        json!({ "children": (1..3 + N_JOINTS).collect::<Vec<_>>() }),
        json!({ "mesh": 0, "skin": 0, "weights": [0.5, 0.25] }),
        json!({ "mesh": 0, "translation": [3, 0, 0] }),
    ];
    nodes.extend((0..N_JOINTS).map(|joint| json!({ "name": format!("joint {joint}") })));
    let json = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": nodes,
        "meshes": [{
            "weights": [0, 1], "extras": { "targetNames": ["up", "away"] },
            "primitives": [{
                "attributes": { "POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights },
                "targets": targets, "indices": indices
            }]
        }],
        "skins": [{
            "joints": (3..3 + N_JOINTS).collect::<Vec<_>>(), "skeleton": 0, "inverseBindMatrices": matrices
        }],
        "animations": [{
            "channels": [{ "sampler": 0, "target": { "node": 1, "path": "weights" } }],
            "samplers": [{ "input": times, "output": keys }]
        }],
        "accessors": buffer.accessors, "bufferViews": buffer.views,
        "buffers": [{ "byteLength": buffer.bytes.len() }]
    });
    (json, buffer.bytes)
}

fn read((json, bin): &(Value, Vec<u8>)) -> Result<ReadOutcome, ReadError> {
    glb::read(&glb_of(&json.to_string(), bin), &strict())
}

fn again(scene: &Scene) -> Scene {
    let mut bytes = Vec::new();
    glb::write(scene, None, &mut bytes).expect("written");
    let (scene, warnings) = scene_of(glb::read(&bytes, &strict()).expect("read"));
    assert!(warnings.is_empty(), "{warnings:?}");
    scene
}

/// The weight of each joint at a vertex.
fn weights_at(scene: &Scene, vertex: usize) -> Vec<f64> {
    let mesh = &scene.parts[0].mesh;
    let is_weights = |semantic: &Semantic| matches!(semantic, Semantic::Blended(name) if name.starts_with("weights of joints"));
    let attributes = mesh.attributes().iter().filter(|attribute| is_weights(&attribute.semantic));
    attributes.flat_map(|attribute| attribute.row(vertex).to_vec()).collect()
}

#[test]
fn weights_of_joints_are_numbers_of_vertices() {
    let (scene, warnings) = scene_of(read(&document()).expect("read"));
    assert!(warnings.is_empty(), "{warnings:?}");
    for vertex in 0..4 {
        let mut expected = vec![0.0; N_JOINTS];
        for (joint, weight) in JOINTS[vertex].iter().zip(WEIGHTS[vertex]) {
            expected[usize::from(*joint)] += f64::from(weight);
        }
        assert_eq!(weights_at(&scene, vertex), expected, "vertex {vertex}");
    }
    let widths: Vec<_> = scene.parts[0].mesh.attributes().iter().map(|a| (a.domain, a.width)).collect();
    let all = |width| (Domain::Vertex, width);
    assert_eq!(widths, [all(3), all(3), all(16), all(4)]);
    for (target, moves) in MOVES.iter().enumerate() {
        let name = Semantic::Blended(format!("morph target {target} POSITION"));
        let found = scene.parts[0].mesh.attribute(&name).expect("there");
        assert!(found.values.iter().zip(moves.as_flattened()).all(|(a, b)| *a == f64::from(*b)));
    }
}

#[test]
fn skins_morph_targets_and_their_animations_are_written_again() {
    let (scene, _) = scene_of(read(&document()).expect("read"));
    let after = again(&scene);
    assert_eq!(after.parts, scene.parts);
    assert_eq!((&after.nodes, &after.assets), (&scene.nodes, &scene.assets));
    assert_eq!(scene.nodes[1].properties["skin"], 0);
    assert_eq!(scene.parts[0].properties.as_ref().expect("some")["extras"]["targetNames"][1], "away");
    assert_eq!(scene.assets.animations[0]["channels"][0]["target"]["path"], "weights");
    assert_eq!(again(&after), after);
}

#[test]
fn a_frame_of_its_own_moves_joints_along() {
    let (mut scene, _) = scene_of(read(&document()).expect("read"));
    scene.frame.up = Some(chordal_io::Axis::Z);
    let after = again(&scene);
    // One node more stands before all others.
    let joints = |scene: &Scene| scene.assets.skins[0]["joints"][0].as_u64();
    assert_eq!(joints(&after), joints(&scene).map(|joint| joint + 1));
    assert_eq!(after.nodes[4].name, "joint 0");
}

#[test]
fn a_vertex_keeps_its_heaviest_joints_and_weights_sum_to_one() {
    let (mut scene, _) = scene_of(read(&document()).expect("read"));
    let mesh = &scene.parts[0].mesh;
    let mut blended = chordal::Mesh::new(mesh.positions().to_vec(), mesh.faces().to_vec()).unwrap();
    for attribute in mesh.attributes() {
        let mut attribute = attribute.clone();
        if matches!(&attribute.semantic, Semantic::Blended(name) if name.contains("joints 0 to 15")) {
            // Six joints at vertex 0, of which the two lightest go; none at vertex 2.
            attribute.values[..16].fill(0.0);
            for (joint, weight) in [(2, 0.3), (4, 0.25), (6, 0.2), (8, 0.15), (10, 0.06), (12, 0.04)] {
                attribute.values[joint] = weight;
            }
            attribute.values[32..48].fill(0.0);
        } else if attribute.width == 4 {
            attribute.values.fill(0.0);
        }
        blended = blended.with_attribute(attribute).unwrap();
    }
    scene.parts[0].mesh = blended;
    let after = again(&scene);
    let at = weights_at(&after, 0);
    let found: Vec<usize> = (0..at.len()).filter(|joint| at[*joint] > 0.0).collect();
    assert_eq!(found, [2, 4, 6, 8]);
    assert!((at[2] - 0.3 / 0.9).abs() < 1e-6 && (at.iter().sum::<f64>() - 1.0).abs() < 1e-6);
    assert_eq!(weights_at(&after, 2)[0], 1.0);
}

#[test]
fn what_names_a_skin_or_targets_that_are_gone_is_left_out() {
    let (mut scene, _) = scene_of(read(&document()).expect("read"));
    let mesh = &scene.parts[0].mesh;
    scene.parts[0].mesh = chordal::Mesh::new(mesh.positions().to_vec(), mesh.faces().to_vec()).unwrap();
    let mut bytes = Vec::new();
    glb::write(&scene, None, &mut bytes).expect("written");
    let (after, warnings) = scene_of(glb::read(&bytes, &strict()).expect("read"));
    assert!(after.nodes.iter().all(|node| !node.properties.contains_key("skin")), "{warnings:?}");
    assert!(after.parts[0].properties.as_ref().is_none_or(|own| !own.contains_key("weights")));
}

#[test]
fn targets_that_not_all_primitives_have_are_warned_of() {
    let (mut json, bin) = document();
    let mut other = json["meshes"][0]["primitives"][0].clone();
    // Its second target moves other things than that of the first primitive does.
    other["attributes"]["_HEAT"] = json!(0);
    other["targets"] = json!([other["targets"][0], { "_HEAT": 0 }]);
    json["meshes"][0]["primitives"].as_array_mut().unwrap().push(other);
    let (scene, warnings) = scene_of(read(&(json, bin)).expect("read"));
    assert!(warnings.contains(&"morph-targets-ignored"), "{warnings:?}");
    assert!(scene.assets.animations.is_empty());
    again(&scene);
}

/// Each of these took time that grows with the square of the file.
#[test]
fn long_lists_of_targets_joints_and_roots_are_linear() {
    // Chosen: a hundred thousand squared is hours, and as many in a row is a moment.
    let n = 100_000;
    let lenient = Limits { conformance: Conformance::Lenient, ..Limits::default() };
    let ends = |json: &Value, bin: &[u8]| glb::read(&glb_of(&json.to_string(), bin), &lenient);
    let (mut json, bin) = triangle();
    json["meshes"][0]["primitives"][0]["targets"] = json!(vec![json!({ "POSITION": 0 }); n]);
    let (scene, _) = scene_of(ends(&json, &bin).expect("read"));
    assert_eq!(scene.parts[0].mesh.attributes().len(), n);
    let names: serde_json::Map<String, Value> = (0..n).map(|i| (format!("_A{i}"), json!(0))).collect();
    json["meshes"][0]["primitives"][0]["targets"] = json!([names]);
    assert!(scene_of(ends(&json, &bin).expect("read")).0.parts[0].mesh.attributes().is_empty());
    // Sets of joints, more than any skin has.
    let (mut json, bin) = triangle();
    json["skins"] = json!([{ "joints": [0] }]);
    for set in 0..n {
        for family in ["JOINTS", "WEIGHTS"] {
            json["meshes"][0]["primitives"][0]["attributes"][format!("{family}_{set}")] = json!(0);
        }
    }
    let _ = ends(&json, &bin);
    // All children of a node that the scene does not show.
    let (mut json, bin) = triangle();
    let children: Vec<usize> = (1..n).collect();
    let mut nodes = vec![json!({ "mesh": 0 }); n];
    nodes[0] = json!({ "children": children });
    json["nodes"] = json!(nodes);
    json["scenes"] = json!([{ "nodes": children }]);
    let (scene, warnings) = scene_of(ends(&json, &bin).expect("read"));
    assert!(warnings.contains(&"SCENE_NON_ROOT_NODE"), "{warnings:?}");
    assert_eq!((scene.roots.len(), scene.nodes[0].children.len()), (n - 1, 0));
}

/// Joints are read once before the vertices, which share them: that is charged, too, for each primitive.
#[test]
fn joints_that_are_named_again_and_again_are_refused_before_they_are_read_without_end() {
    let (mut json, bin) = triangle();
    let zeros =
        |kind: &str, component: u32| json!({ "componentType": component, "count": 1_000_000, "type": kind });
    json["accessors"] = json!([zeros("VEC3", 5126), zeros("VEC4", 5121), zeros("VEC4", 5126)]);
    let primitive = json!({ "attributes": { "POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2 } });
    json["meshes"] = json!([{ "primitives": vec![primitive; 10_000] }]);
    json["skins"] = json!([{ "joints": [0] }]);
    let lenient = Limits { conformance: Conformance::Lenient, ..Limits::default() };
    let error = glb::read(&glb_of(&json.to_string(), &bin), &lenient).map(|_| ()).expect_err("accepted");
    assert_eq!((error.code, error.place.to_string()), ("too-large", "/meshes/0".to_owned()), "{error}");
}
