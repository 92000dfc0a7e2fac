//! The libraries of real files.
use super::said;
use crate::common::count;
use chordal_io::{Content, Format, Limits, MATERIAL, Scene, Warning, glb, obj, read_with};
use chordal_testkit::corpus;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

fn load(path: &Path) -> Option<(Scene, Vec<Warning>)> {
    let bytes = std::fs::read(path).expect("readable");
    let folder = path.parent().expect("a folder");
    let mut open = |name: &str| {
        let full = folder.join(name);
        assert!(!name.contains("..") && full.starts_with(folder), "{name}");
        std::fs::read(full).map_err(|error| error.kind().to_string())
    };
    let found = read_with(&bytes, Format::Obj, &mut open, &Limits::default()).ok()?;
    match found.content {
        Content::Scene(scene) => Some((scene, found.warnings)),
        _ => None,
    }
}

/// The names of a library and of the faces of an OBJ, by a reading that shares nothing with the readers.
fn names(path: &Path, keyword: &str) -> Vec<String> {
    let text = String::from_utf8_lossy(&std::fs::read(path).expect("readable")).into_owned();
    let line = |line: &str| line.trim_start().strip_prefix(keyword).map(|rest| rest.trim().to_owned());
    let mut names: Vec<String> = Vec::new();
    for name in text.split(['\n', '\r']).filter_map(line).filter(|name| !name.is_empty()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

#[test]
fn every_library_is_read_with_its_obj() {
    let Some(data) = corpus::find("") else { return };
    let (mut n_libraries, mut n_described) = (0, 0);
    let mut objs: Vec<PathBuf> = Vec::new();
    for folder in ["mesh", "corner", "topology", "batch", "gltf"] {
        let is_obj = |path: &PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
        objs.extend(corpus::files(&data.join(folder)).into_iter().filter(is_obj));
    }
    for path in objs {
        let Some(library) = names(&path, "mtllib ").first().map(|name| path.with_file_name(name)) else {
            continue;
        };
        let Some((scene, warnings)) = load(&path) else { continue };
        if !library.exists() {
            let told = said(&warnings, "mtllib-missing").to_owned() + said(&warnings, "mtllib-unused");
            assert!(!told.is_empty(), "{}: {warnings:?}", path.display());
            continue;
        }
        n_libraries += 1;
        let used = names(&path, "usemtl ");
        let (known, materials) = (names(&library, "newmtl "), &scene.assets.materials);
        if scene.groups.contains_key(MATERIAL) {
            assert_eq!(materials.len(), used.len(), "{}", path.display());
        }
        for (material, name) in materials.iter().zip(&used) {
            assert_eq!(material["name"], json!(name), "{}", path.display());
            assert_eq!(material["extras"].is_object(), known.contains(name), "{}: {name}", path.display());
            n_described += usize::from(known.contains(name));
        }
        // What was read can be written everywhere.
        if !materials.is_empty() {
            let mut bytes = Vec::new();
            glb::write(&scene, None, &mut bytes).expect("written");
            glb::read(&bytes, &Limits::default())
                .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert!(obj::side_files(&scene, "x").is_some());
        }
    }
    assert!(n_libraries >= 31 && n_described >= 128, "{n_libraries} libraries, {n_described} materials");
}

#[test]
fn some_libraries_say_what_their_text_says() {
    let Some(data) = corpus::find("corner/assimp/test/models/OBJ") else { return };
    let material = |scene: &Scene, name: &str| -> Value {
        let found = scene.assets.materials.iter().find(|material| material["name"] == name);
        found.unwrap_or_else(|| panic!("{name}")).clone()
    };
    let (scene, warnings) = load(&data.join("spider.obj")).expect("read");
    // Four of the five materials are used.
    assert_eq!(scene.assets.materials.len(), 4);
    assert!(said(&warnings, "materials-unused").ends_with(": Brusttex"), "{warnings:?}");
    let skin = material(&scene, "Skin");
    assert_eq!(skin["pbrMetallicRoughness"]["baseColorFactor"], json!([0.827451, 0.792157, 0.772549, 1.0]));
    assert_eq!(
        skin["extras"]["mtl"],
        json!({ "Ka": [0.2, 0.2, 0.2], "Ks": [0, 0, 0], "Ns": 0, "map_Kd": ".\\wal67ar_small.jpg" })
    );
    assert_eq!(count(&warnings, "picture-missing"), 4);
    assert!(said(&warnings, "picture-missing").contains("SpiderTex.jpg"));

    let (scene, warnings) = load(&data.join("box_mat_with_spaces.obj")).expect("read");
    assert_eq!(scene.groups[MATERIAL][1], "Material name with many, many spaces");
    assert_eq!(
        scene.assets.materials[0]["pbrMetallicRoughness"],
        json!({ "baseColorFactor": [0.2, 0.2, 0.2, 1.0], "metallicFactor": 0.0 })
    );
    assert_eq!(count(&warnings, "materials-unused"), 11);

    let (scene, _) = load(&data.join("regr01.obj")).expect("read");
    let windows = material(&scene, "Windows");
    assert_eq!(windows["pbrMetallicRoughness"]["baseColorFactor"], json!([0.6, 0.7, 0.8, 0.5]));
    assert_eq!(windows["alphaMode"], "BLEND");

    let (scene, warnings) = load(&data.join("cube_usemtl.obj")).expect("read");
    assert_eq!(said(&warnings, "material-missing"), "materials that no library describes are plain: mtl3");
    let shiny = material(&scene, "mtl");
    // 2 / (200 + 2) = 1 / 101
    let roughness = shiny["pbrMetallicRoughness"]["roughnessFactor"].as_f64().unwrap();
    assert!((roughness.powi(4) - 1.0 / 101.0).abs() < 1e-15);

    let (_, warnings) = load(&data.join("mtl_different_folder.obj")).expect("read");
    assert!(said(&warnings, "picture-missing").contains("image.jpg"));

    let Some(kitchen) = corpus::find("batch/blendswap-cc0/blendswap-cc-0/kitchenaid/kitchenaid.obj") else {
        return;
    };
    let (scene, _) = load(&kitchen).expect("read");
    let glass = material(&scene, "Kitchenaid_Glass");
    assert_eq!(glass["pbrMetallicRoughness"]["baseColorFactor"], json!([0.64, 0.64, 0.64, 0.7]));
    let roughness = glass["pbrMetallicRoughness"]["roughnessFactor"].as_f64().unwrap();
    assert!((roughness.powi(4) - 2.0 / 98.078431).abs() < 1e-15);
}
