//! Verdicts of gltf-validator 2.0.0-dev.3.10 over changes of a document with every kind of object.
use super::build::{every_object, glb_of, put, read, strict, triangle};
use chordal_io::{Conformance, Content, FileLocation, Format, Limits, glb};
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Changes of the document, and the errors that the validator then finds, each a code and a pointer.
struct Verdict {
    changes: Vec<(String, Value)>,
    errors: Vec<(String, String)>,
}

fn verdicts() -> Vec<Verdict> {
    let rows: Vec<Value> =
        serde_json::from_str(include_str!("../data/validator_verdicts.json")).expect("JSON");
    let text = |value: &Value| value.as_str().expect("a text").to_owned();
    let pairs = |value: &Value| value.as_array().expect("a list").clone();
    rows.iter()
        .map(|row| Verdict {
            changes: pairs(&row[0]).iter().map(|change| (text(&change[0]), change[1].clone())).collect(),
            errors: pairs(&row[1]).iter().map(|error| (text(&error[0]), text(&error[1]))).collect(),
        })
        .collect()
}

/// Puts values at pointers; the text `DELETE` takes out what is there.
fn changed(changes: &[(String, Value)]) -> (Value, Vec<u8>) {
    let (mut json, bin) = every_object();
    for (at, value) in changes {
        let (parent, key) = at.rsplit_once('/').expect("a pointer");
        let delete = *value == json!("DELETE");
        match json.pointer_mut(parent).expect("there") {
            Value::Object(map) if delete => {
                map.shift_remove(key);
            }
            Value::Object(map) => {
                map.insert(key.to_owned(), value.clone());
            }
            Value::Array(list) => {
                let i: usize = key.parse().expect("an index");
                if delete {
                    list.remove(i);
                } else if i < list.len() {
                    list[i] = value.clone();
                } else {
                    list.push(value.clone());
                }
            }
            other => panic!("{parent} is {other}"),
        }
    }
    (json, bin)
}

#[test]
fn changes_are_judged_as_the_validator_judges_them() {
    let mut codes = BTreeSet::new();
    for Verdict { changes, errors } in verdicts() {
        let (json, bin) = changed(&changes);
        match read(&json, &bin) {
            Ok(_) => assert!(errors.is_empty(), "{changes:?} was accepted, not refused for {:?}", errors[0]),
            Err(error) => {
                let is_it = |(code, at): &(String, String)| {
                    *code == error.code && error.place == FileLocation::Pointer(at.clone())
                };
                let found = (error.code, &error.place);
                assert!(errors.iter().any(is_it), "{changes:?}: {found:?} is none of {errors:?}");
                codes.insert(error.code);
            }
        }
    }
    assert!(codes.len() >= 85, "only {} codes: {codes:?}", codes.len());
}

#[test]
fn a_gltf_with_its_buffer_beside_it_is_judged_at_the_same_places() {
    let mut n = [0, 0];
    for Verdict { changes, errors } in verdicts() {
        let (mut json, bin) = changed(&changes);
        if let Some(Value::Object(buffer)) = json.pointer_mut("/buffers/0") {
            buffer.entry("uri").or_insert(json!("every_object.bin"));
        }
        let mut open = |path: &str| match path {
            "every_object.bin" => Ok(bin.clone()),
            other => Err(format!("there is no {other}")),
        };
        let read = chordal_io::read_with(json.to_string().as_bytes(), Format::Gltf, &mut open, &strict());
        n[usize::from(errors.is_empty())] += 1;
        match read {
            Ok(_) => assert!(errors.is_empty(), "{changes:?} was accepted"),
            Err(error) => {
                let is_it = |(code, at): &(String, String)| {
                    *code == error.code && error.place == FileLocation::Pointer(at.clone())
                };
                assert!(errors.iter().any(is_it), "{changes:?}: {} at {}", error.code, error.place);
            }
        }
    }
    assert_eq!(n, [268, 159], "refused and valid");
}

#[test]
fn what_viewers_accept_is_warned_of_and_written_without_an_error() {
    let mut codes = BTreeSet::new();
    for Verdict { changes, errors } in verdicts() {
        let (json, bin) = changed(&changes);
        let Ok(loaded) = glb::read(&glb_of(&json.to_string(), &bin), &Limits::default()) else { continue };
        let is_warned = |code: &str| loaded.warnings.iter().any(|warning| warning.code == code);
        let warned: Vec<_> = errors.iter().map(|(code, _)| code.clone()).filter(|c| is_warned(c)).collect();
        assert!(errors.is_empty() || !warned.is_empty(), "{changes:?}: {:?}", loaded.warnings);
        codes.extend(warned);
        let is_dropped = loaded.warnings.iter().any(|warning| warning.code == "assets-dropped");
        assert!(!is_dropped, "{changes:?}");
        let Content::Scene(scene) = loaded.content else { panic!("no scene") };
        let mut out = Vec::new();
        glb::write(&scene, None, &mut out).expect("written");
        if let Err(error) = glb::read(&out, &strict()) {
            panic!("{changes:?}, written: {}: {error}", error.code);
        }
    }
    assert!(codes.len() >= 12, "only {codes:?}");
}

#[test]
fn factors_are_clamped_and_scenes_name_roots() {
    let (mut json, bin) = every_object();
    let factor = "/materials/0/pbrMetallicRoughness/baseColorFactor";
    let colour = |x: f64| json!([x, 0.5, 0.25, 1]);
    put(&mut json, factor, colour(1.000_000_12));
    let read = |json: &Value| {
        let loaded = glb::read(&glb_of(&json.to_string(), &bin), &Limits::default()).expect("read");
        let warnings: Vec<_> = loaded.warnings.iter().map(|w| (w.code, w.place.to_string())).collect();
        let Content::Scene(scene) = loaded.content else { panic!("no scene") };
        (scene, warnings)
    };
    let (scene, warnings) = read(&json);
    assert!(warnings.contains(&("VALUE_NOT_IN_RANGE", format!("{factor}/0"))), "{warnings:?}");
    let names = |material: &&Value| material["pbrMetallicRoughness"]["baseColorFactor"] == colour(1.0);
    assert!(scene.assets.materials.iter().any(|material| names(&material)), "{:?}", scene.assets.materials);
    // Neither more materials nor other numbers: only a whole 1 in place of what is beyond it.
    put(&mut json, factor, colour(1.0));
    assert_eq!(read(&json).0.assets, scene.assets);
}

#[test]
fn a_scene_that_names_a_child_shows_it_once() {
    let (mut json, bin) = triangle();
    put(&mut json, "/nodes", json!([{ "children": [1] }, { "mesh": 0 }, { "children": [3] }, { "mesh": 0 }]));
    let shown = |json: &mut Value, roots: Value| {
        put(json, "/scenes", json!([{ "nodes": roots }]));
        put(json, "/scene", json!(0));
        let loaded = glb::read(&glb_of(&json.to_string(), &bin), &Limits::default()).expect("read");
        assert_eq!(loaded.warnings[0].code, "SCENE_NON_ROOT_NODE", "{:?}", loaded.warnings);
        let Content::Scene(scene) = loaded.content else { panic!("no scene") };
        let mut out = Vec::new();
        glb::write(&scene, None, &mut out).expect("written");
        glb::read(&out, &strict()).expect("read strictly");
        (scene.roots.clone(), scene.world_meshes().expect("placed").len())
    };
    assert_eq!(shown(&mut json, json!([0, 1])), (vec![0], 1));
    assert_eq!(shown(&mut json, json!([1, 0])), (vec![0], 1));
    assert_eq!(shown(&mut json, json!([1])), (vec![1], 1));
    assert_eq!(shown(&mut json, json!([1, 2, 3])), (vec![1, 2], 2));
}

#[test]
fn leniency_makes_warnings_of_errors_that_do_not_touch_triangles() {
    let limits = Limits { conformance: Conformance::Lenient, ..Limits::default() };
    let elsewhere =
        ["/animations", "/skins", "/cameras", "/images", "/textures", "/materials", "/extensions/"];
    let mut n_forgiven = 0;
    for Verdict { changes, errors } in verdicts() {
        let is_elsewhere = |at: &str| elsewhere.iter().any(|list| at.starts_with(list));
        if errors.is_empty()
            || !errors.iter().all(|(_, at)| is_elsewhere(at))
            || !changes.iter().all(|(at, _)| is_elsewhere(at))
        {
            continue;
        }
        let (json, bin) = changed(&changes);
        match glb::read(&glb_of(&json.to_string(), &bin), &limits) {
            Ok(loaded) => {
                n_forgiven += 1;
                let is_warned = |code: &str| loaded.warnings.iter().any(|warning| warning.code == code);
                assert!(errors.iter().all(|(code, _)| is_warned(code)), "{changes:?}: {:?}", loaded.warnings);
            }
            Err(error) => panic!("{changes:?}: {error}"),
        }
    }
    assert!(n_forgiven >= 70, "only {n_forgiven}");
}
