//! What primitives, the scene and the file say beside triangles: extras, variants of materials, no material.
use super::build::{glb_of, loaded, put, scene_of, triangle};
use chordal_io::{Limits, Scene, glb};
use serde_json::{Value, json};

/// Four primitives over one triangle: two of one material of which other things are said, one without a
/// material of which something is said, and one of which nothing is.
fn varied() -> (Value, Vec<u8>) {
    let (mut json, bin) = triangle();
    let variants = |mappings: Value| json!({ "KHR_materials_variants": { "mappings": mappings } });
    let primitive = |more: Value| {
        let mut primitive = json!({ "attributes": { "POSITION": 0 }, "indices": 1 });
        more.as_object().expect("members").iter().for_each(|(key, value)| primitive[key] = value.clone());
        primitive
    };
    for (at, value) in [
        (
            "/meshes/0/primitives",
            json!([
                primitive(json!({ "material": 1, "extras": { "seam": 1 },
                    "extensions": variants(json!([{ "material": 2, "variants": [0], "name": "m" }])) })),
                primitive(json!({ "material": 1, "extras": "another" })),
                primitive(json!({ "extensions": variants(json!([{ "material": 0, "variants": [1] }])) })),
                primitive(json!({ "material": 1 })),
            ]),
        ),
        ("/materials", json!([{ "name": "unshown" }, { "name": "usual" }, { "name": "beach" }])),
        (
            "/extensions",
            json!({ "KHR_materials_variants": { "variants": [
            { "name": "summer", "extras": { "v": 1 } }, { "name": "winter" }] } }),
        ),
        ("/extensionsUsed", json!(["KHR_materials_variants"])),
        ("/extras", json!({ "of": "file" })),
        ("/scenes/0/name", json!("stage")),
        ("/scenes/0/extras", json!([1, 2])),
    ] {
        put(&mut json, at, value);
    }
    (json, bin)
}

fn written(scene: &Scene) -> (Vec<u8>, Value) {
    let mut bytes = Vec::new();
    glb::write(scene, None, &mut bytes).expect("written");
    let end = 20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json = serde_json::from_slice(&bytes[20..end]).expect("JSON");
    (bytes, json)
}

/// The primitives of the first mesh without what their numbers are stored in.
fn said(json: &Value) -> Vec<Value> {
    let mut primitives = json["meshes"][0]["primitives"].as_array().expect("primitives").clone();
    for primitive in &mut primitives {
        let members = primitive.as_object_mut().expect("members");
        ["attributes", "indices"].iter().for_each(|key| drop(members.shift_remove(*key)));
    }
    primitives
}

#[test]
fn what_primitives_the_scene_and_the_file_say_is_written_again() {
    let (json, bin) = varied();
    let (scene, warnings) = loaded(&json, &bin);
    assert!(warnings.is_empty(), "{warnings:?}");
    let (bytes, out) = written(&scene);
    for at in ["/extensions", "/extensionsUsed", "/extras", "/scenes/0/name", "/scenes/0/extras"] {
        assert_eq!(out.pointer(at), json.pointer(at), "{at}");
    }
    let (mut before, after) = (said(&json), said(&out));
    // What no variant changes is glTF's default, said or not.
    before[2]["material"] = json!(3);
    assert_eq!(after, before);
    let materials = out["materials"].as_array().expect("materials");
    assert_eq!(materials[..3], json["materials"].as_array().expect("materials")[..]);
    assert_eq!(materials[3..], [json!({})]);
    let (again, warnings) = scene_of(glb::read(&bytes, &Limits::default()).expect("read"));
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(written(&again).0, bytes);
}

#[test]
fn materials_that_variants_name_are_used() {
    let (json, bin) = varied();
    let (scene, _) = loaded(&json, &bin);
    let mut scene = scene;
    // Without what a variant names, the first is used by no face and numbers change.
    let names_first = |value: &Value| value.to_string().contains("\"material\":0");
    scene.assets.face_kinds.retain(|_, kind| !kind.properties.get("extensions").is_some_and(names_first));
    let pruned = scene.with_used_materials().expect("pruned").into_owned();
    let (_, out) = written(&pruned);
    let names: Vec<&Value> =
        out["materials"].as_array().expect("materials").iter().map(|m| &m["name"]).collect();
    assert_eq!(names, [&json!("usual"), &json!("beach"), &Value::Null]);
    let first = &said(&out)[0];
    assert_eq!((&first["material"], &first["extras"]), (&json!(0), &json!({ "seam": 1 })));
    assert_eq!(first.pointer("/extensions/KHR_materials_variants/mappings/0/material"), Some(&json!(1)));
}

#[test]
fn faces_without_a_material_stay_without_one() {
    let (json, bin) = triangle();
    let (scene, _) = loaded(&json, &bin);
    let (bytes, out) = written(&scene);
    assert_eq!((said(&out), out.get("materials")), (vec![json!({})], None));
    assert_eq!(scene_of(glb::read(&bytes, &Limits::default()).expect("read")).0, scene);
    // Shapes that are no glTF get one that viewers show bright.
    let bare = Scene::from_part(scene.parts[0].clone(), scene.frame);
    assert_eq!(said(&written(&bare).1), [json!({ "material": 0 })]);
}

#[test]
fn other_scenes_are_named_in_a_warning() {
    let (mut json, bin) = triangle();
    put(&mut json, "/scenes/1", json!({ "name": "night" }));
    put(&mut json, "/accessors/0/extras", json!(1));
    let found = glb::read(&glb_of(&json.to_string(), &bin), &Limits::default()).expect("read");
    let said: Vec<String> = found.warnings.iter().map(|warning| warning.message.to_string()).collect();
    assert_eq!(
        said,
        ["what these say was not kept: extras of accessors, scenes beside the one that is shown"]
    );
}

#[test]
fn meshes_with_the_same_rows_share_them() {
    let (mut json, bin) = triangle();
    put(&mut json, "/materials", json!([{ "name": "a" }, { "name": "b" }]));
    let primitive =
        |material: usize| json!([{ "attributes": { "POSITION": 0 }, "indices": 1, "material": material }]);
    put(&mut json, "/meshes", json!([{ "primitives": primitive(0) }, { "primitives": primitive(1) }]));
    put(&mut json, "/nodes", json!([{ "mesh": 0 }, { "mesh": 1, "translation": [2, 0, 0] }]));
    put(&mut json, "/scenes/0/nodes", json!([0, 1]));
    let (scene, _) = loaded(&json, &bin);
    let (bytes, out) = written(&scene);
    assert_eq!(out["buffers"][0]["byteLength"], 44);
    assert_eq!(out["accessors"].as_array().map(Vec::len), Some(2));
    assert_eq!(scene_of(glb::read(&bytes, &Limits::default()).expect("read")).0, scene);
    // One number that differs is enough for rows of its own.
    let mut other = scene;
    let moved = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0_f64.next_up() + 1e-6, 0.0]];
    other.parts[1].mesh = chordal::Mesh::new(moved, vec![[0, 1, 2]]).expect("mesh");
    assert_eq!(written(&other).1["accessors"].as_array().map(Vec::len), Some(3));
}
