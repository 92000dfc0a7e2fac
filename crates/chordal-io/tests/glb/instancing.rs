//! `EXT_mesh_gpu_instancing`: a child for each row, all showing the same part.
use super::build::{glb_of, loaded, put, refused, scene_of, triangle};
use chordal_io::{Conformance, Limits, Scene, glb};
use serde_json::{Value, json};
use std::f64::consts::FRAC_1_SQRT_2;

const NAME: &str = "EXT_mesh_gpu_instancing";
const PLACE: &str = "/nodes/0/extensions/EXT_mesh_gpu_instancing";

/// A list of numbers: its component type, whether it is normalized, its width and its values.
struct Rows<'a>(u64, bool, usize, &'a [f64]);

const F32: u64 = 5126;
const I16: u64 = 5122;
const I8: u64 = 5120;

/// The triangle, shown by its node at places that are given.
fn placed(attributes: &[(&str, Rows<'_>)]) -> (Value, Vec<u8>) {
    let (mut json, mut bin) = triangle();
    let mut named = json!({});
    for (name, Rows(component, normalized, width, values)) in attributes {
        let (at, start) = (json["accessors"].as_array().expect("accessors").len(), bin.len());
        for x in *values {
            match *component {
                F32 => bin.extend((*x as f32).to_le_bytes()),
                I16 => bin.extend((*x as i16).to_le_bytes()),
                _ => bin.extend((*x as i8).to_le_bytes()),
            }
        }
        let length = bin.len() - start;
        bin.resize(bin.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": start, "byteLength": length });
        put(&mut json, &format!("/bufferViews/{at}"), view);
        let mut accessor = json!({
            "bufferView": at, "componentType": component, "count": values.len() / width,
            "type": (["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1]),
        });
        if *normalized {
            accessor["normalized"] = json!(true);
        }
        put(&mut json, &format!("/accessors/{at}"), accessor);
        named[name] = json!(at);
    }
    put(&mut json, "/buffers/0/byteLength", json!(bin.len()));
    put(&mut json, "/nodes/0/extensions", json!({ NAME: { "attributes": named } }));
    put(&mut json, "/nodes/0/translation", json!([0, 0, 100]));
    for list in ["/extensionsUsed", "/extensionsRequired"] {
        put(&mut json, list, json!([NAME]));
    }
    (json, bin)
}

/// The corners of each triangle that the scene shows.
fn shown(scene: &Scene) -> Vec<Vec<[f64; 3]>> {
    scene.world_meshes().expect("placed").iter().map(|(_, mesh)| mesh.positions().to_vec()).collect()
}

#[test]
fn rows_are_children_that_show_one_part() {
    let places = [1.0, 2.0, 3.0, -4.0, 5.0, 6.0];
    let turns = [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, 0.0, 0.0, 1.0];
    let sizes = [2.0, 3.0, 1.0, 1.0, 1.0, -1.0];
    let (json, bin) = placed(&[
        ("TRANSLATION", Rows(F32, false, 3, &places)),
        ("ROTATION", Rows(F32, false, 4, &turns)),
        ("SCALE", Rows(F32, false, 3, &sizes)),
    ]);
    let (scene, warnings) = loaded(&json, &bin);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!((scene.parts.len(), scene.nodes.len(), &scene.roots[..]), (1, 3, &[0][..]));
    assert_eq!((scene.nodes[0].part, &scene.nodes[0].children[..]), (None, &[1, 2][..]));
    assert!(scene.nodes[1..].iter().all(|node| node.part == Some(0) && node.name.is_empty()));
    // First the size, then a quarter turn about z, then the place, then the node's own place.
    let expected = [
        [[1.0, 2.0, 103.0], [1.0, 4.0, 103.0], [-5.0, 2.0, 103.0]],
        [[-4.0, 5.0, 106.0], [-3.0, 5.0, 106.0], [-4.0, 7.0, 106.0]],
    ];
    for (found, expected) in shown(&scene).iter().flatten().zip(expected.iter().flatten()) {
        assert!((0..3).all(|k| (found[k] - expected[k]).abs() < 1e-6), "{found:?} {expected:?}");
    }
    // A mirrored instance is wound the other way round.
    assert_eq!(scene.world_meshes().expect("placed")[1].1.faces(), [[0, 2, 1]]);
    let mut out = Vec::new();
    glb::write(&scene, None, &mut out).expect("written");
    let again = scene_of(glb::read(&out, &Limits::default()).expect("read")).0;
    assert_eq!(again.parts.len(), 1, "the mesh is written once");
    for (a, b) in shown(&again).iter().flatten().zip(shown(&scene).iter().flatten()) {
        assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-5), "{a:?} {b:?}");
    }
}

#[test]
fn quantized_rotations_turn_and_do_not_shear() {
    for (component, max) in [(I16, 32767.0), (I8, 127.0)] {
        // Sixty degrees about (1, 2, 2) / 3.
        let q: Vec<f64> = [1.0, 2.0, 2.0].iter().map(|x: &f64| x / 6.0).chain([0.75_f64.sqrt()]).collect();
        let stored: Vec<f64> = q.iter().map(|x| (x * max).round()).collect();
        let (json, bin) = placed(&[("ROTATION", Rows(component, true, 4, &stored))]);
        let matrix = *loaded(&json, &bin).0.nodes[1].matrix;
        let column = |k: usize| [matrix[4 * k], matrix[4 * k + 1], matrix[4 * k + 2]];
        for i in 0..3 {
            for j in 0..3 {
                let dot: f64 = (0..3).map(|k| column(i)[k] * column(j)[k]).sum();
                assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-12, "{i} {j}: {dot}");
            }
        }
        // The axis stays where it is.
        let moved = |row: usize| (matrix[row] + 2.0 * matrix[4 + row] + 2.0 * matrix[8 + row]) / 3.0;
        assert!((moved(0) - 1.0 / 3.0).abs() < 2.0 / max && (moved(1) - 2.0 / 3.0).abs() < 2.0 / max);
    }
}

#[test]
fn other_attributes_are_named() {
    let (mut json, bin) = placed(&[
        ("TRANSLATION", Rows(F32, false, 3, &[1.0; 6])),
        ("_ID", Rows(F32, false, 1, &[7.0, 8.0])),
        ("COLOR_0", Rows(F32, false, 3, &[1.0; 6])),
    ]);
    let (scene, warnings) = loaded(&json, &bin);
    assert_eq!((warnings, scene.nodes.len()), (vec!["instance-attribute-skipped"], 3));
    let limits = Limits::default();
    let warning = glb::read(&glb_of(&json.to_string(), &bin), &limits).expect("read").warnings.remove(0);
    assert_eq!((warning.count, warning.place.to_string()), (2, format!("{PLACE}/attributes/_ID")));
    // Where nothing else is said, they still tell how many there are, all at one place.
    put(&mut json, &format!("{PLACE}/attributes/TRANSLATION"), Value::Null);
    assert_eq!(shown(&loaded(&json, &bin).0).len(), 2);
    // Optional or required, it is read.
    put(&mut json, "/extensionsRequired", Value::Null);
    assert_eq!(loaded(&json, &bin).0.nodes.len(), 3);
    // No attribute, no instances; no mesh, none either.
    put(&mut json, &format!("{PLACE}/attributes"), json!({}));
    let (scene, warnings) = loaded(&json, &bin);
    assert_eq!((warnings, shown(&scene).len()), (vec!["instances-ignored"], 1));
    let (mut json, bin) = placed(&[("TRANSLATION", Rows(F32, false, 3, &[1.0; 6]))]);
    put(&mut json, "/nodes/0/mesh", Value::Null);
    let (scene, warnings) = loaded(&json, &bin);
    assert_eq!((warnings, scene.nodes.len()), (vec!["instances-ignored", "meshes-not-shown"], 1));
}

#[test]
fn an_instance_without_size_is_written_as_it_is() {
    let (json, bin) = placed(&[
        ("SCALE", Rows(F32, false, 3, &[1.0, 0.0, 1.0, 0.0, 0.0, 0.0])),
        ("ROTATION", Rows(F32, false, 4, &[0.6, 0.0, 0.0, 0.8, 0.0, 0.6, 0.0, 0.8])),
    ]);
    let scene = loaded(&json, &bin).0;
    let mut out = Vec::new();
    glb::write(&scene, None, &mut out).expect("written");
    let again = scene_of(glb::read(&out, &Limits::default()).expect("read")).0;
    let matrices = |scene: &Scene| scene.nodes[1..].iter().map(|node| *node.matrix).collect::<Vec<_>>();
    assert_eq!(matrices(&again), matrices(&scene));
}

#[test]
fn lower_levels_of_detail_have_no_instances() {
    let (mut json, bin) = placed(&[("TRANSLATION", Rows(F32, false, 3, &[1.0; 6]))]);
    // Node 1 becomes the first level, and the one with instances its lower one.
    put(
        &mut json,
        "/nodes/1",
        json!({ "name": "first", "mesh": 0, "extensions": { "MSFT_lod": { "ids": [0] } } }),
    );
    put(&mut json, "/extensionsUsed", json!([NAME, "MSFT_lod"]));
    put(&mut json, "/scenes/0/nodes", json!([1]));
    let (scene, warnings) = loaded(&json, &bin);
    assert_eq!((warnings, scene.nodes.len()), (vec!["lower-levels-skipped"], 1));
    // The other way round the instances are the first level; they follow the nodes that are left.
    put(&mut json, "/nodes/1/extensions", Value::Null);
    put(&mut json, "/nodes/0/extensions/MSFT_lod", json!({ "ids": [1] }));
    put(&mut json, "/scenes/0/nodes", json!([0]));
    let (scene, _) = loaded(&json, &bin);
    assert_eq!((scene.nodes.len(), &scene.nodes[0].children[..]), (3, &[1, 2][..]));
}

#[test]
fn what_cannot_place_a_mesh_is_refused() {
    let at = |name: &str| format!("{PLACE}/attributes/{name}");
    let one = |name: &'static str, rows: Rows<'_>| placed(&[(name, rows)]);
    let shorts = one("TRANSLATION", Rows(I16, true, 3, &[1.0, 2.0, 3.0, 0.0, 0.0, 0.0]));
    refused(&shorts.0, &shorts.1, "instances-format", &at("TRANSLATION"));
    let plane = one("SCALE", Rows(F32, false, 2, &[1.0, 2.0]));
    refused(&plane.0, &plane.1, "instances-format", &at("SCALE"));
    let raw = one("ROTATION", Rows(I8, false, 4, &[0.0, 0.0, 0.0, 1.0]));
    refused(&raw.0, &raw.1, "instances-format", &at("ROTATION"));
    let (json, bin) =
        placed(&[("TRANSLATION", Rows(F32, false, 3, &[0.0; 6])), ("SCALE", Rows(F32, false, 3, &[1.0; 9]))]);
    refused(&json, &bin, "instances-unequal", &at("SCALE"));
    for q in [[0.0; 4], [0.0, 0.0, 0.0, 2.0], [0.5, 0.5, 0.5, 0.4]] {
        let (json, bin) = one("ROTATION", Rows(F32, false, 4, &q));
        refused(&json, &bin, "ROTATION_NON_UNIT", &at("ROTATION"));
        let lenient = Limits { conformance: Conformance::Lenient, ..Limits::default() };
        let read = glb::read(&glb_of(&json.to_string(), &bin), &lenient);
        assert_eq!(read.is_err(), q == [0.0; 4], "zero is no rotation, whatever is forgiven");
    }
    let (json, bin) = one("TRANSLATION", Rows(F32, false, 3, &[f64::NAN, 0.0, 0.0]));
    refused(&json, &bin, "ACCESSOR_INVALID_FLOAT", "/accessors/2");
    let lenient = Limits { conformance: Conformance::Lenient, drop_nonfinite: true, ..Limits::default() };
    assert!(glb::read(&glb_of(&json.to_string(), &bin), &lenient).is_err());
    let (mut json, bin) = one("TRANSLATION", Rows(F32, false, 3, &[0.0; 6]));
    for (value, code) in [
        (json!(9), "UNRESOLVED_REFERENCE"),
        (json!(-1), "INVALID_INDEX"),
        (json!("x"), "TYPE_MISMATCH"),
        (json!(null), "TYPE_MISMATCH"),
    ] {
        if let Value::Object(map) = json.pointer_mut(&format!("{PLACE}/attributes")).expect("there") {
            map.insert("TRANSLATION".to_owned(), value);
        }
        refused(&json, &bin, code, &at("TRANSLATION"));
        assert!(glb::read(&glb_of(&json.to_string(), &bin), &lenient).is_err());
    }
    put(&mut json, &format!("{PLACE}/attributes"), Value::Null);
    refused(&json, &bin, "UNDEFINED_PROPERTY", PLACE);
}

#[test]
fn instances_without_bytes_are_limited() {
    // Rows that lie in no view take no bytes of the file.
    let (mut json, bin) = placed(&[("TRANSLATION", Rows(F32, false, 3, &[0.0; 3]))]);
    put(&mut json, "/accessors/2/bufferView", Value::Null);
    put(&mut json, "/accessors/2/count", json!(20_000_000));
    refused(&json, &bin, "too-large", &format!("{PLACE}/attributes"));
    put(&mut json, "/accessors/2/count", json!(1000));
    assert_eq!(loaded(&json, &bin).0.nodes.len(), 1001);
    let few = Limits { rows: 1000, ..Limits::default() };
    let error = glb::read(&glb_of(&json.to_string(), &bin), &few).map(|_| ()).expect_err("accepted");
    assert_eq!(error.code, "too-many-rows");
}

/// The JSON of a scene that is written.
fn written(scene: &Scene) -> (Value, Vec<u8>) {
    let mut out = Vec::new();
    glb::write(scene, None, &mut out).expect("written");
    let n = u32::from_le_bytes([out[12], out[13], out[14], out[15]]) as usize;
    (serde_json::from_slice(&out[20..20 + n]).expect("JSON"), out)
}

#[test]
fn instances_are_written_as_instances() {
    let half = (32767.0 * FRAC_1_SQRT_2).round();
    let (mut json, bin) = placed(&[
        ("TRANSLATION", Rows(F32, false, 3, &[1.0, 2.0, 3.0, -4.0, 0.1, 6.0])),
        ("ROTATION", Rows(I16, true, 4, &[0.0, 0.0, half, half, 0.0, 0.0, 0.0, 32767.0])),
        ("_ID", Rows(F32, false, 1, &[7.0, 8.0])),
    ]);
    // A child that is none of the instances, and an animation and a root after them in the list of nodes.
    put(&mut json, "/nodes/1", json!({ "name": "child", "translation": [0, 1, 0] }));
    put(&mut json, "/nodes/2", json!({ "name": "other", "mesh": 0 }));
    put(&mut json, "/nodes/0/children", json!([1]));
    put(&mut json, "/scenes/0/nodes", json!([0, 2]));
    let (scene, _) = loaded(&json, &bin);
    assert_eq!(scene.nodes.len(), 5);
    let (text, out) = written(&scene);
    assert_eq!(text["nodes"].as_array().expect("nodes").len(), 3);
    assert_eq!(text["extensionsRequired"], json!([NAME]));
    let attributes = &text["nodes"][0]["extensions"][NAME]["attributes"];
    assert_eq!(attributes.as_object().expect("attributes").len(), 3);
    assert_eq!(text["nodes"][0]["mesh"], text["nodes"][2]["mesh"]);
    let id = &text["accessors"][attributes["_ID"].as_u64().expect("an accessor") as usize];
    assert_eq!((&id["count"], &id["type"]), (&json!(2), &json!("SCALAR")));
    let (again, _) = scene_of(glb::read(&out, &Limits::default()).expect("read"));
    assert_eq!(again, scene);
    assert_eq!(written(&again).1, out, "the same bytes again");
}

#[test]
fn instances_that_were_changed_are_written_as_nodes() {
    let (json, bin) = placed(&[("TRANSLATION", Rows(F32, false, 3, &[1.0, 2.0, 3.0, -4.0, 5.0, 6.0]))]);
    let (scene, _) = loaded(&json, &bin);
    let moved = |change: fn(&mut Scene)| {
        let mut scene = scene.clone();
        change(&mut scene);
        let (text, out) = written(&scene);
        assert!(text.get("extensionsUsed").is_none() && text.get("extensionsRequired").is_none(), "{text}");
        let again = scene_of(glb::read(&out, &Limits::default()).expect("read")).0;
        assert_eq!(shown(&again), shown(&scene));
    };
    moved(|scene| scene.nodes[2].matrix[12] += 1.0);
    moved(|scene| scene.nodes[1].name = "first".to_owned());
    moved(|scene| scene.nodes[2].part = None);
    moved(|scene| {
        scene.nodes[0].children.pop();
    });
    moved(|scene| scene.assets.accessors.clear());
    moved(|scene| {
        // Its positions are stored about an origin that a node has to add: single precision has no
        // 1,000,000 + 1/1024, but both.
        let far = scene.parts[0].mesh.positions().iter().map(|p| p.map(|x| 1e6 + x / 1024.0)).collect();
        scene.parts[0].mesh = scene.parts[0].mesh.with_positions(far).expect("finite");
    });
}
