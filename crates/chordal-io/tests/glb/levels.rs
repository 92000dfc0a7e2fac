//! Levels of detail in one GLB: the first is read, the others are counted, and circles of them are refused.
use super::build::{glb_of, put, triangle};
use chordal::Mesh;
use chordal_io::glb::{self, GlbLevel, write_levels};
use chordal_io::{Axis, Content, FileLocation, Frame, Limits, ReadError, Scene, Warning};
use serde_json::{Value, json};

/// A strip of `n` triangles.
fn strip(n: u32) -> Mesh {
    let positions = (0..n + 2).map(|i| [f64::from(i / 2), f64::from(i % 2), 0.5]).collect();
    let faces = (0..n).map(|i| if i % 2 == 0 { [i, i + 2, i + 1] } else { [i, i + 1, i + 2] }).collect();
    Mesh::new(positions, faces).expect("valid")
}

fn scene(n: u32) -> Scene {
    let frame = Frame { up: Some(Axis::Z), metres_per_unit: Some(0.5), ..Frame::default() };
    Scene::from_mesh(&format!("strip {n}"), strip(n), frame)
}

fn written(levels: &[GlbLevel<'_>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_levels(levels, &mut bytes).expect("written");
    bytes
}

fn json_of(glb: &[u8]) -> Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&glb[20..20 + length]).expect("JSON")
}

fn read(bytes: &[u8]) -> Result<(Scene, Vec<Warning>), ReadError> {
    let loaded = glb::read(bytes, &Limits::default())?;
    let Content::Scene(scene) = loaded.content else { panic!("no scene") };
    Ok((scene, loaded.warnings))
}

#[test]
fn the_first_level_is_shown_and_the_others_stand_beside_it() {
    let scenes = [scene(40), scene(10), scene(2)];
    let certificates = [json!({ "bound": 0.1 }), json!({ "bound": 0.2 }), Value::Null];
    let coverage = [0.5, 0.125, 0.0];
    let levels: Vec<GlbLevel<'_>> = (0..3)
        .map(|i| GlbLevel {
            scene: &scenes[i],
            certificate: Some(&certificates[i]).filter(|c| !c.is_null()),
            coverage: coverage[i],
        })
        .collect();
    let bytes = written(&levels);
    assert_eq!(bytes, written(&levels));

    let json = json_of(&bytes);
    assert_eq!(json["extensionsUsed"], json!(["MSFT_lod"]));
    assert_eq!(json.get("extensionsRequired"), None);
    assert_eq!(json["scenes"], json!([{ "nodes": [0] }]));
    let top = &json["nodes"][0];
    assert_eq!(top["extras"]["MSFT_screencoverage"], json!(coverage));
    assert_eq!(json["asset"]["extras"]["chordal"]["levels"], json!(certificates));
    let ids = top["extensions"]["MSFT_lod"]["ids"].as_array().expect("ids").clone();
    let names: Vec<&Value> =
        ids.iter().map(|id| &json["nodes"][id.as_u64().expect("id") as usize]["name"]).collect();
    assert_eq!(names, ["level 1", "level 2"]);

    // What is read is what the first level alone reads back as, below one more node.
    let (found, warnings) = read(&bytes).expect("read");
    let mut alone = Vec::new();
    glb::write(&scenes[0], None, &mut alone).expect("written");
    let (expected, _) = read(&alone).expect("read");
    assert_eq!(found.parts, expected.parts);
    let placed = |scene: &Scene| scene.world_meshes().expect("placed")[0].1.clone().into_owned();
    assert_eq!(placed(&found), placed(&expected));
    assert_eq!(found.nodes.len(), expected.nodes.len() + 1);
    assert_eq!(found.certificate, Some(certificates[0].clone()));
    let codes: Vec<_> = warnings.iter().map(|w| (w.code, w.count)).collect();
    assert_eq!(codes, [("lower-levels-skipped", 2)]);

    // The other levels hold what they alone would: the file is as long as its parts say.
    let n_indices = |i: usize| {
        let accessor = json["meshes"][i]["primitives"][0]["indices"].as_u64().expect("indices") as usize;
        json["accessors"][accessor]["count"].as_u64()
    };
    assert_eq!([0, 1, 2].map(n_indices), [Some(120), Some(30), Some(6)]);
}

#[test]
fn a_single_level_is_a_plain_file() {
    let scene = scene(3);
    let certificate = json!({ "bound": 1 });
    let mut plain = Vec::new();
    glb::write(&scene, Some(&certificate), &mut plain).expect("written");
    assert_eq!(written(&[GlbLevel { scene: &scene, certificate: Some(&certificate), coverage: 0.0 }]), plain);
}

#[test]
fn levels_out_of_order_are_refused() {
    let scene = scene(3);
    let level = |coverage| GlbLevel { scene: &scene, certificate: None, coverage };
    for (levels, words) in [
        (vec![], "no level"),
        (vec![level(0.5), level(0.5)], "level 1 is not shown on less"),
        (vec![level(0.25), level(0.5)], "level 1 is not shown on less"),
        (vec![level(f64::NAN)], "level 0 is shown from NaN"),
        (vec![level(0.5), level(-0.1)], "level 1 is shown from -0.1"),
        (vec![level(1.5), level(0.1)], "level 0 is shown from 1.5"),
    ] {
        let mut out = Vec::new();
        let error = write_levels(&levels, &mut out).expect_err("refused").to_string();
        assert!(error.contains(words) && out.is_empty(), "{error}");
    }
}

/// The triangle under several nodes, of which each names the lower levels given.
fn nodes_with(ids: &[&[usize]]) -> Value {
    let nodes = ids.iter().map(|ids| match ids {
        [] => json!({ "mesh": 0 }),
        ids => json!({ "mesh": 0, "extensions": { "MSFT_lod": { "ids": ids } } }),
    });
    let mut json = triangle().0;
    put(&mut json, "/nodes", nodes.collect());
    put(&mut json, "/extensionsUsed", json!(["MSFT_lod"]));
    json
}

#[track_caller]
fn refused(json: &Value) -> (&'static str, String) {
    let error = read(&glb_of(&json.to_string(), &triangle().1)).expect_err("refused");
    let FileLocation::Pointer(pointer) = error.place else { panic!("{error}") };
    (error.code, pointer)
}

#[test]
fn h74_levels_in_a_circle_are_refused() {
    let pointer = "/nodes/0/extensions/MSFT_lod/ids".to_owned();
    assert_eq!(refused(&nodes_with(&[&[0]])), ("lod-cycle", pointer.clone()));
    assert_eq!(refused(&nodes_with(&[&[1], &[0]])), ("lod-cycle", pointer.clone()));
    assert_eq!(refused(&nodes_with(&[&[1], &[2], &[0]])), ("lod-cycle", pointer.clone()));
    // A child whose lower level is its parent.
    let mut json = nodes_with(&[&[], &[0]]);
    put(&mut json, "/nodes/0/children", json!([1]));
    assert_eq!(refused(&json), ("lod-cycle", "/nodes/1/extensions/MSFT_lod/ids".to_owned()));
    // Lists that share a level are none.
    let json = nodes_with(&[&[1, 2], &[2], &[]]);
    let (scene, warnings) = read(&glb_of(&json.to_string(), &triangle().1)).expect("read");
    assert_eq!((scene.nodes.len(), scene.parts.len()), (1, 1));
    assert_eq!(warnings.iter().find(|w| w.code == "lower-levels-skipped").map(|w| w.count), Some(3));
}

#[test]
fn h74_levels_that_are_not_there_are_refused() {
    let at = |k: usize| format!("/nodes/0/extensions/MSFT_lod/ids/{k}");
    assert_eq!(refused(&nodes_with(&[&[1]])), ("UNRESOLVED_REFERENCE", at(0)));
    assert_eq!(refused(&nodes_with(&[&[1, 7], &[]])), ("UNRESOLVED_REFERENCE", at(1)));
    for wrong in [json!([-1]), json!([0.5]), json!(["1"]), json!([null])] {
        let mut json = nodes_with(&[&[1], &[]]);
        put(&mut json, "/nodes/0/extensions/MSFT_lod/ids", wrong);
        assert_eq!(refused(&json), ("UNRESOLVED_REFERENCE", at(0)));
    }
    for wrong in [json!([]), json!(1), json!({})] {
        let mut json = nodes_with(&[&[1], &[]]);
        put(&mut json, "/nodes/0/extensions/MSFT_lod/ids", wrong);
        assert_eq!(refused(&json), ("UNDEFINED_PROPERTY", "/nodes/0/extensions/MSFT_lod/ids".to_owned()));
    }
}

#[test]
fn a_lower_level_that_the_scene_shows_too_is_kept() {
    let mut json = nodes_with(&[&[1, 2], &[], &[]]);
    put(&mut json, "/scenes/0/nodes", json!([0, 1]));
    let (scene, _) = read(&glb_of(&json.to_string(), &triangle().1)).expect("read");
    assert_eq!((scene.nodes.len(), scene.roots), (2, vec![0, 1]));
    // Without scenes the roots are shown, and a lower level is no root.
    let mut json = nodes_with(&[&[1], &[]]);
    put(&mut json, "/scenes", Value::Null);
    put(&mut json, "/scene", Value::Null);
    let (scene, _) = read(&glb_of(&json.to_string(), &triangle().1)).expect("read");
    assert_eq!((scene.nodes.len(), scene.roots), (1, vec![0]));
}
