//! What becomes of the statements of a material library.
use super::{Files, PNG, WEBP, jpeg, load, said, squares, values};
use crate::common::count;
use chordal_io::{Content, Format, ImageContent, Limits, MATERIAL, glb, read, read_with};
use serde_json::{Value, json};

/// The one material that a library describes in these statements.
fn material(statements: &str, files: &Files) -> (Value, Vec<chordal_io::Warning>) {
    let files = files.clone().with("a.mtl", format!("newmtl m\n{statements}\n"));
    let (scene, warnings, _) = load(&squares("a.mtl", &["m"]), &files);
    (scene.assets.materials[0].clone(), warnings)
}

#[test]
fn colours_and_numbers_become_those_of_gltf_and_what_it_cannot_say_stays_in_extras() {
    let (found, warnings) = material(
        "Ka 0.25 0 1\nKd 0.5 0.25 0\nKs 0.5 0.5 0.5\nKe 0 0.5 0\nNs 6\nNi 1.45\nd 0.75\nillum 2\nTf 1 1 1",
        &Files::default(),
    );
    assert_eq!(warnings.len(), 1, "the square is cut: {warnings:?}");
    assert_eq!(
        found,
        json!({
            "name": "m",
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.5, 0.25, 0.0, 0.75],
                "metallicFactor": 0.0,
                // (2 / (6 + 2))^(1/4)
                "roughnessFactor": 0.5_f64.sqrt(),
            },
            "emissiveFactor": [0.0, 0.5, 0.0],
            "alphaMode": "BLEND",
            "doubleSided": true,
            "extras": { "mtl": {
                "Ka": [0.25, 0, 1], "Ks": [0.5, 0.5, 0.5], "Ns": 6, "Ni": 1.45, "illum": 2, "Tf": [1, 1, 1],
            } },
        })
    );
    let (bare, _) = material("", &Files::default());
    assert_eq!(
        bare,
        json!({
            "name": "m",
            "pbrMetallicRoughness": { "metallicFactor": 0.0 },
            "doubleSided": true,
            "extras": { "mtl": {} },
        })
    );
}

#[test]
fn a_highlight_is_as_rough_as_its_exponent_says_where_there_is_one() {
    let roughness = |statements: &str| {
        let (found, _) = material(statements, &Files::default());
        found["pbrMetallicRoughness"]["roughnessFactor"].as_f64().unwrap_or(1.0)
    };
    assert_eq!(roughness("Ns 0"), 1.0);
    assert_eq!(roughness("Ns 30"), 0.5);
    assert_eq!(roughness("Ks 0 0 0\nNs 30"), 1.0, "without a highlight");
    assert_eq!(roughness("Ks 0\nNs 30"), 1.0);
    assert_eq!(roughness("illum 1\nNs 30"), 1.0);
    assert_eq!(roughness("Ns 30\nPr 0.25"), 0.25);
    assert_eq!(roughness("Ns -5"), 1.0);
    assert_eq!(roughness("Pr 7"), 1.0);
}

#[test]
fn opacity_is_d_or_what_tr_leaves() {
    let opacity = |statements: &str| {
        let (found, warnings) = material(statements, &Files::default());
        let factor = found["pbrMetallicRoughness"]["baseColorFactor"][3].as_f64();
        (factor, found["alphaMode"] == "BLEND", count(&warnings, "material-invisible"))
    };
    assert_eq!(opacity("Kd 1 1 1\nd 1"), (Some(1.0), false, 0));
    assert_eq!(opacity("d 0.5"), (Some(0.5), true, 0));
    assert_eq!(opacity("Tr 0.25"), (Some(0.75), true, 0));
    assert_eq!(opacity("Tr 0.25\nd 0.5"), (Some(0.5), true, 0));
    assert_eq!(opacity("d -halo 0.5"), (Some(0.5), true, 0));
    assert_eq!(opacity("Tr 1"), (Some(0.0), true, 1));
    assert_eq!(opacity("d 3"), (None, false, 0));
}

#[test]
fn the_extension_for_physically_based_rendering_is_read() {
    let (found, _) =
        material("Kd 1 0 0\nPr 0.25\nPm 0.5\nPs 0.125\nPc 1\nPcr 0.0625\naniso 0.5", &Files::default());
    assert_eq!(found["pbrMetallicRoughness"]["metallicFactor"], 0.5);
    assert_eq!(found["pbrMetallicRoughness"]["roughnessFactor"], 0.25);
    assert_eq!(
        found["extensions"],
        json!({
            "KHR_materials_sheen": { "sheenColorFactor": [0.125, 0.125, 0.125] },
            "KHR_materials_clearcoat": { "clearcoatFactor": 1.0, "clearcoatRoughnessFactor": 0.0625 },
        })
    );
    assert_eq!(found["extras"]["mtl"], json!({ "aniso": 0.5 }));
    let (strong, _) = material("Ke 4 2 0", &Files::default());
    assert_eq!(strong["emissiveFactor"], json!([1.0, 0.5, 0.0]));
    assert_eq!(strong["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 4.0);
}

#[test]
fn pictures_are_taken_byte_for_byte_and_once() {
    let files = Files::default()
        .with("a.mtl", "newmtl a\nmap_Kd tex/p.png\nmap_Ke .\\tex\\p.png\nnewmtl b\nmap_Kd -clamp on tex//p.png\nnorm n.jpg\nmap_Pr w.webp\n")
        .with("tex/p.png", PNG)
        .with("n.jpg", jpeg(3))
        .with("w.webp", WEBP);
    let (scene, warnings, asked) = load(&squares("a.mtl", &["a", "b"]), &files);
    assert_eq!(asked, ["a.mtl", "tex/p.png", "w.webp", "n.jpg"]);
    assert_eq!(warnings.iter().filter(|w| w.code != "polygons-cut").count(), 1, "{warnings:?}");
    let assets = &scene.assets;
    assert_eq!(assets.images.len(), 3);
    assert_eq!(assets.images[0].content, ImageContent::Bytes(PNG[..].into()));
    assert_eq!(
        Value::Object(assets.images[0].properties.clone()),
        json!({ "name": "tex/p.png", "mimeType": "image/png" })
    );
    assert_eq!(
        json!(assets.textures),
        json!([
            { "source": 0 },
            { "source": 0, "sampler": 0 },
            { "extensions": { "EXT_texture_webp": { "source": 1 } } },
            { "source": 2 },
        ])
    );
    assert_eq!(assets.samplers, [json!({ "wrapS": 33071, "wrapT": 33071 })]);
    let [a, b] = &assets.materials[..] else { panic!("two materials") };
    assert_eq!(a["pbrMetallicRoughness"]["baseColorTexture"], json!({ "index": 0 }));
    assert_eq!(
        (&a["emissiveTexture"], &a["emissiveFactor"]),
        (&json!({ "index": 0 }), &json!([1.0, 1.0, 1.0]))
    );
    assert_eq!(b["pbrMetallicRoughness"]["baseColorTexture"], json!({ "index": 1 }));
    assert_eq!(b["pbrMetallicRoughness"]["metallicRoughnessTexture"], json!({ "index": 2 }));
    assert_eq!(b["normalTexture"], json!({ "index": 3 }));
}

#[test]
fn a_picture_beside_black_is_not_black() {
    let files = Files::default().with("p.png", PNG);
    let factor = |statements: &str| {
        let (found, _) = material(statements, &files);
        (found["pbrMetallicRoughness"]["baseColorFactor"].clone(), found["extras"]["mtl"]["Kd"].clone())
    };
    assert_eq!(factor("Kd 0 0 0\nmap_Kd p.png"), (json!([1.0, 1.0, 1.0, 1.0]), json!([0, 0, 0])));
    assert_eq!(factor("Kd 0 0 0"), (json!([0.0, 0.0, 0.0, 1.0]), json!(null)));
    assert_eq!(factor("Kd 0.5 0.5 0.5\nmap_Kd p.png"), (json!([0.5, 0.5, 0.5, 1.0]), json!(null)));
}

#[test]
fn options_become_those_of_gltf_or_are_kept_and_named() {
    let files = Files::default().with("my p.png", PNG);
    let (found, warnings) =
        material("map_Kd -s 2 4 1 -o 0.5 0.25 -mm 0 2 -blendu off my p.png\nnorm -bm 0.5 my p.png", &files);
    // v' = 4 v + 0.25 for v upwards: 1 - v' = 4 (1 - v) - 3.25.
    assert_eq!(
        found["pbrMetallicRoughness"]["baseColorTexture"],
        json!({
            "index": 0,
            "extensions": { "KHR_texture_transform": { "offset": [0.5, -3.25], "scale": [2.0, 4.0] } },
        })
    );
    assert_eq!(found["normalTexture"], json!({ "index": 0, "scale": 0.5 }));
    assert_eq!(found["extras"]["mtl"]["options"]["map_Kd"], "-mm 0 2 -blendu off");
    assert!(said(&warnings, "map-option").contains("-mm 0 2 -blendu off"), "{warnings:?}");
}

#[test]
fn maps_without_a_place_in_gltf_are_kept_as_text_and_named() {
    let files = Files::default().with("p.png", PNG).with("q.png", PNG).with("gray.jpg", jpeg(1));
    let (found, warnings) = material(
        "map_Kd p.png\nmap_Ks q.png\nmap_d q.png\nmap_Bump -bm 2 gray.jpg\nmap_Pm q.png\nbump q.png",
        &files,
    );
    assert_eq!(
        found["extras"]["mtl"],
        json!({
            "normal": "bump", "map_Ks": "q.png", "map_d": "q.png", "map_Bump": "-bm 2 gray.jpg", "map_Pm": "q.png",
        })
    );
    assert_eq!(found["normalTexture"], json!({ "index": 1 }), "the bumps that have directions");
    assert!(found.get("alphaMode").is_none());
    let told = said(&warnings, "map-skipped");
    for name in ["map_Ks", "map_d", "map_Bump", "map_Pm"] {
        assert!(told.contains(name), "{name}: {told}");
    }
    // Opacity in the picture of the colour itself is glTF's.
    let (found, warnings) = material("map_Kd p.png\nmap_d ./p.png", &files);
    assert_eq!((&found["alphaMode"], count(&warnings, "map-skipped")), (&json!("BLEND"), 0));
    // Roughness alone beside metal would need a picture of two channels.
    let (found, warnings) = material("Pm 1\nmap_Pr q.png", &files);
    assert_eq!(count(&warnings, "map-skipped"), 1);
    assert!(found["pbrMetallicRoughness"].get("metallicRoughnessTexture").is_none());
    let (found, _) = material("map_Pm q.png\nmap_Pr q.png", &files);
    assert_eq!(
        found["pbrMetallicRoughness"],
        json!({ "metallicRoughnessTexture": { "index": 0 }, "metallicFactor": 1.0 })
    );
}

#[test]
fn libraries_may_be_several_and_have_spaces_in_their_names() {
    let files = Files::default()
        .with("a.mtl", "newmtl x\nKd 1 0 0\n")
        .with("my lib.mtl", "newmtl x\nKd 0 0 0\nnewmtl y\nKd 0 1 0\n")
        .with("c", "newmtl z\nKd 0 0 1\n");
    for line in
        ["a.mtl my lib.mtl c", "\"a.mtl\"\nmtllib my lib.mtl\nmtllib c", "a.mtl\nmtllib ./my lib.mtl c gone"]
    {
        let (scene, warnings, _) = load(&squares(line, &["z", "y", "x"]), &files);
        let colors: Vec<&Value> =
            scene.assets.materials.iter().map(|m| &m["pbrMetallicRoughness"]["baseColorFactor"]).collect();
        let expected =
            [json!([0.0, 0.0, 1.0, 1.0]), json!([0.0, 1.0, 0.0, 1.0]), json!([1.0, 0.0, 0.0, 1.0])];
        assert_eq!(colors, expected.iter().collect::<Vec<_>>(), "{line}");
        assert_eq!(count(&warnings, "material-twice"), 1, "the first library is searched first");
        assert_eq!(count(&warnings, "mtllib-missing"), u64::from(line.ends_with("gone")), "{warnings:?}");
        assert_eq!(scene.groups[MATERIAL], ["", "z", "y", "x"]);
        assert_eq!(values(&scene), [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
    }
}

#[test]
fn what_is_missing_is_a_warning_that_names_it() {
    let obj = squares("a.mtl", &["m", "n"]);
    let (scene, warnings, _) = load(&obj, &Files::default());
    assert_eq!(
        said(&warnings, "mtllib-missing"),
        "material libraries could not be read; materials keep their names: a.mtl (no such file)"
    );
    assert!(scene.assets.materials.is_empty());
    assert_eq!(scene.groups[MATERIAL], ["", "m", "n"]);
    let files = Files::default().with("a.mtl", "newmtl m\nmap_Kd p.png\nnewmtl o\nnewmtl p\n");
    let (scene, warnings, _) = load(&obj, &files);
    assert_eq!(said(&warnings, "picture-missing"), "pictures could not be taken: p.png (no such file)");
    assert_eq!(said(&warnings, "material-missing"), "materials that no library describes are plain: n");
    assert_eq!(said(&warnings, "materials-unused"), "materials that no face has were left out: o, p");
    assert_eq!(scene.assets.materials[0]["extras"]["mtl"], json!({ "map_Kd": "p.png" }));
    assert_eq!(scene.assets.materials[1]["name"], "n");
    assert!(scene.assets.textures.is_empty() && scene.assets.images.is_empty());
    let files = files.with("p.png", "BM is no picture of glTF");
    let (_, warnings, _) = load(&obj, &files);
    assert!(
        said(&warnings, "picture-missing").contains("p.png (it is no PNG, JPEG or WebP)"),
        "{warnings:?}"
    );
    let (_, warnings, asked) = load(&squares("a.mtl", &[]), &files);
    assert_eq!((asked.len(), said(&warnings, "mtllib-unused").ends_with(": a.mtl")), (0, true));
}

#[test]
fn plain_reading_opens_nothing_and_says_so() {
    let found = read(squares("a.mtl", &["m"]).as_bytes(), Format::Obj, &Limits::default()).expect("read");
    let Content::Scene(scene) = found.content else { panic!("a scene") };
    assert_eq!(
        said(&found.warnings, "mtllib-skipped"),
        "material libraries were not opened; materials keep their names"
    );
    assert_eq!((&scene.groups[MATERIAL][1], scene.assets.materials.len()), (&"m".to_owned(), 0));
    let mut bytes = Vec::new();
    glb::write(&scene, None, &mut bytes).expect("written");
    assert!(String::from_utf8_lossy(&bytes).contains("\"doubleSided\":true"), "the square is open");
}

#[test]
fn pictures_stand_beside_their_library_or_beside_the_obj() {
    let files = Files::default()
        .with("lib/a.mtl", "newmtl m\nmap_Kd p.png\nmap_Ke q.png\nnorm ../q.png\n")
        .with("lib/p.png", PNG)
        .with("q.png", jpeg(3));
    let (scene, warnings, asked) = load(&squares("lib\\a.mtl", &["m"]), &files);
    assert_eq!(asked, ["lib/a.mtl", "lib/p.png", "q.png", "lib/q.png"]);
    assert_eq!(count(&warnings, "picture-missing"), 0);
    assert_eq!(scene.assets.images.len(), 2);
}

#[test]
fn a_cage_has_its_materials_too() {
    let obj = format!("{}t interpolateboundary 1/0/0 1\n", squares("a.mtl", &["m"]));
    let files = Files::default().with("a.mtl", "newmtl m\nKd 1 0 0\n");
    let mut open = |path: &str| files.0.get(path).cloned().ok_or_else(String::new);
    let found = read_with(obj.as_bytes(), Format::Obj, &mut open, &Limits::default()).expect("read");
    let Content::Polygons(polygons) = found.content else { panic!("a cage") };
    assert_eq!(polygons.groups[MATERIAL], ["", "m"]);
    assert_eq!(
        polygons.assets.materials[0]["pbrMetallicRoughness"]["baseColorFactor"],
        json!([1.0, 0.0, 0.0, 1.0])
    );
}
