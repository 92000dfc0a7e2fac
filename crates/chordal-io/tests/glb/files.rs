//! glTF as several files, and assets without what no face uses.
use super::assets::{PNG, furnished, with_own_vertices};
use super::build::{loaded, scene_of};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal_io::glb::{GlbLevels, write_levels_embedded, write_levels_files};
use chordal_io::{
    FileSet, Format, Frame, ImageContent, Limits, MATERIAL, Node, Part, Scene, SceneAssets, SceneImage, glb,
    read, read_with, write_files,
};
use serde_json::{Map, Value, json};

/// What a reader finds in a set of files whose document stands in a folder with the others.
fn read_set(files: &FileSet<'_>) -> (Scene, Vec<String>) {
    let mut asked = Vec::new();
    let mut open = |path: &str| {
        asked.push(path.to_owned());
        let file = files.beside.iter().find(|file| file.name == path);
        file.map(|file| file.bytes.to_vec()).ok_or_else(|| format!("no {path}"))
    };
    let found = read_with(&files.document, Format::Gltf, &mut open, &Limits::default()).expect("read");
    let (scene, warnings) = scene_of(found);
    assert!(warnings.iter().all(|code| *code == "lower-levels-skipped"), "{warnings:?}");
    (scene, asked)
}

fn image(bytes: &[u8], mime: &str) -> SceneImage {
    let properties = Map::from_iter([("mimeType".to_owned(), json!(mime))]);
    SceneImage { properties, content: ImageContent::Bytes(bytes.into()) }
}

#[test]
fn a_gltf_with_its_files_beside_reads_back_as_the_same_scene() {
    let (json, bin) = furnished();
    let (scene, _) = loaded(&json, &bin);
    let files = write_files(&scene, Some(&json!({ "a": 1 })), Format::Gltf, "a b").expect("written");
    let names: Vec<&str> = files.beside.iter().map(|file| &*file.name).collect();
    assert_eq!(names, ["a b.bin", "a b_image_0.png"]);
    assert_eq!(*files.beside[1].bytes, *PNG);
    let text: Value = serde_json::from_slice(&files.document).expect("JSON");
    assert_eq!(text["buffers"][0]["uri"], "a%20b.bin");
    assert_eq!(text["buffers"][0]["byteLength"], files.beside[0].bytes.len());
    assert_eq!(
        text["images"],
        json!([{ "name": "pixel", "mimeType": "image/png", "uri": "a%20b_image_0.png" }])
    );
    let (again, asked) = read_set(&files);
    assert_eq!(asked, names);
    assert_eq!(again, Scene { certificate: Some(json!({ "a": 1 })), ..with_own_vertices(&scene) });
    // The same bytes again; and a stem that leads elsewhere leads nowhere.
    assert_eq!(write_files(&scene, Some(&json!({ "a": 1 })), Format::Gltf, "a b").expect("written"), files);
    let files = write_files(&scene, None, Format::Gltf, "../x:y").expect("written");
    assert!(files.beside.iter().all(|file| !file.name.contains(['/', ':'])), "{:?}", files.beside[0].name);
    assert_eq!(read_set(&files).0, with_own_vertices(&scene));
}

#[test]
fn pictures_of_the_same_bytes_are_one_file() {
    let (json, bin) = furnished();
    let (mut scene, _) = loaded(&json, &bin);
    let images = &mut scene.assets.images;
    images.insert(0, image(b"\xff\xd8\xff one", "image/jpeg"));
    images.push(image(PNG, "image/png"));
    images.push(SceneImage { properties: Map::new(), content: ImageContent::Uri("away.png".to_owned()) });
    let files = write_files(&scene, None, Format::Gltf, "s").expect("written");
    let names: Vec<&str> = files.beside.iter().map(|file| &*file.name).collect();
    assert_eq!(names, ["s.bin", "s_image_0.jpg", "s_image_1.png"]);
    let text: Value = serde_json::from_slice(&files.document).expect("JSON");
    let uris: Vec<&str> = (0..4).map(|i| text["images"][i]["uri"].as_str().expect("a URI")).collect();
    assert_eq!(uris, ["s_image_0.jpg", "s_image_1.png", "s_image_1.png", "away.png"]);
    // The name of a picture that was not read is not given to another one.
    scene.assets.images[3].content = ImageContent::Uri("s%5Fimage_1.png".to_owned());
    let files = write_files(&scene, None, Format::Gltf, "s").expect("written");
    assert_eq!(files.beside[2].name, "s_image_5.png");
}

#[test]
fn a_format_of_one_file_has_none_beside() {
    let (json, bin) = furnished();
    let (scene, _) = loaded(&json, &bin);
    assert!(Format::Gltf.has_side_files() && !Format::Glb.has_side_files());
    let files = write_files(&scene, None, Format::Glb, "s").expect("written");
    let mut bytes = Vec::new();
    glb::write(&scene, None, &mut bytes).expect("written");
    assert_eq!((files.document, files.beside.len()), (bytes, 0));
}

#[test]
fn levels_have_files_beside_or_all_in_one_text() {
    let (json, bin) = furnished();
    let (fine, _) = loaded(&json, &bin);
    let shows: Vec<usize> = fine.nodes.iter().filter_map(|node| node.part).collect();
    assert!(!shows.is_empty());
    let coarser: Vec<Vec<Part>> = fine.parts.iter().map(|part| vec![part.clone()]).collect();
    let share = |node: &Node| if node.part.is_some() { vec![0.5, 0.0] } else { Vec::new() };
    let coverages: Vec<Vec<f64>> = fine.nodes.iter().map(share).collect();
    let levels = GlbLevels { coarser: &coarser, coverages: &coverages, ..GlbLevels::one(&fine) };
    let files = write_levels_files(&levels, "l").expect("written");
    let names: Vec<&str> = files.beside.iter().map(|file| &*file.name).collect();
    assert_eq!(names, ["l.bin", "l_image_0.png"]);
    let (beside, _) = read_set(&files);
    let mut text = Vec::new();
    write_levels_embedded(&levels, &mut text).expect("written");
    assert!(!text.windows(5).any(|part| part == b".bin\""));
    let (inside, _) = scene_of(read(&text, Format::Gltf, &Limits::default()).expect("read"));
    let mut bytes = Vec::new();
    glb::write_levels(&levels, &mut bytes).expect("written");
    let (binary, _) = scene_of(glb::read(&bytes, &Limits::default()).expect("read"));
    assert_eq!(inside, binary);
    assert_eq!(beside, binary);
    let said: Value = serde_json::from_slice(&files.document).expect("JSON");
    let used = said["extensionsUsed"].as_array().expect("names");
    assert!(["KHR_materials_unlit", "MSFT_lod"].iter().all(|name| used.contains(&json!(name))), "{used:?}");
    // One level is a plain scene.
    let files = write_levels_files(&GlbLevels::one(&fine), "l").expect("written");
    assert_eq!(files, glb::write_files(&fine, None, "l").expect("written"));
}

/// Four faces in the materials of these groups.
fn in_groups(groups: [f64; 4], assets: SceneAssets) -> Scene {
    let corners: Vec<[f64; 3]> = (0..6).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect();
    let mesh = Mesh::new(corners, vec![[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 5]]).expect("a mesh");
    let semantic = Semantic::Group(MATERIAL.to_owned());
    let groups = Attribute { semantic, domain: Domain::Face, width: 1, values: groups.to_vec() };
    let mesh = mesh.with_attribute(groups).expect("groups");
    Scene { assets: Box::new(assets), ..Scene::from_mesh("", mesh, Frame::default()) }
}

/// Five materials: by number 0 a texture, 1 nothing, 2 two textures of which one in an extension, 3 the same
/// texture as 0, 4 a level of detail that is material 0.
fn five_materials() -> SceneAssets {
    SceneAssets {
        materials: vec![
            json!({ "name": "m0", "pbrMetallicRoughness": { "baseColorTexture": { "index": 2 } } }),
            json!({ "name": "m1" }),
            json!({ "name": "m2", "normalTexture": { "index": 3, "scale": 2.0 }, "extras": { "aTexture": { "index": 0 } },
                "extensions": { "KHR_materials_clearcoat": { "clearcoatTexture": { "index": 1 } } } }),
            json!({ "name": "m3", "emissiveTexture": { "index": 2 } }),
            json!({ "name": "m4", "extensions": { "MSFT_lod": { "ids": [0] } } }),
        ],
        textures: vec![
            json!({ "name": "t0", "source": 0 }),
            json!({ "name": "t1", "source": 1, "sampler": 1 }),
            json!({ "name": "t2", "source": 0, "sampler": 0, "extensions": { "EXT_texture_webp": { "source": 3 } } }),
            json!({ "name": "t3", "source": 2, "sampler": 1 }),
        ],
        samplers: vec![json!({ "name": "s0" }), json!({ "name": "s1" })],
        images: vec![
            image(b"0", "image/png"),
            image(b"1", "image/png"),
            image(b"2", "image/png"),
            image(b"3", "image/webp"),
        ],
        ..SceneAssets::default()
    }
}

/// What each material shows, by names and pictures and not by numbers.
fn shown(assets: &SceneAssets, material: &Value) -> Vec<String> {
    fn textures(value: &Value, key: &str, found: &mut Vec<u64>) {
        if let (true, Some(index)) = (key.ends_with("Texture"), value["index"].as_u64()) {
            found.push(index);
        }
        for (key, value) in value.as_object().into_iter().flatten().filter(|(key, _)| *key != "extras") {
            textures(value, key, found);
        }
    }
    let mut found = Vec::new();
    textures(material, "", &mut found);
    let picture = |at: &Value| match at.as_u64().map(|at| &assets.images[at as usize].content) {
        Some(ImageContent::Bytes(bytes)) => String::from_utf8_lossy(bytes).into_owned(),
        _ => "none".to_owned(),
    };
    found
        .into_iter()
        .map(|at| {
            let texture = &assets.textures[at as usize];
            let sampler = texture["sampler"].as_u64().map(|at| assets.samplers[at as usize]["name"].clone());
            let webp = picture(&texture["extensions"]["EXT_texture_webp"]["source"]);
            format!("{} {} {webp} {sampler:?}", texture["name"], picture(&texture["source"]))
        })
        .collect()
}

#[test]
fn what_no_face_uses_is_left_out_and_the_rest_shows_the_same() {
    let all = five_materials();
    // Groups, the materials and how many textures, samplers and images are left.
    for (groups, names, counts) in [
        ([3.0, 0.0, 3.0, 2.0], vec!["m1", "m2"], [2, 1, 2]),
        ([4.0, 4.0, 1.0, 1.0], vec!["m0", "m3"], [1, 1, 2]),
        ([5.0, 5.0, 5.0, 5.0], vec!["m0", "m4"], [1, 1, 2]),
        ([2.0, 2.0, 9.0, 2.0], vec!["m1"], [0, 0, 0]),
        ([0.0, 0.0, 0.0, 0.0], vec![], [0, 0, 0]),
    ] {
        let scene = in_groups(groups, all.clone());
        let pruned = scene.with_used_materials().expect("pruned");
        let left = &pruned.assets;
        let found: Vec<&str> =
            left.materials.iter().map(|material| material["name"].as_str().unwrap()).collect();
        assert_eq!(found, names, "{groups:?}");
        assert_eq!([left.textures.len(), left.samplers.len(), left.images.len()], counts, "{groups:?}");
        let new = pruned.parts[0].mesh.attribute(&Semantic::Group(MATERIAL.to_owned())).expect("groups");
        for (face, old) in groups.into_iter().enumerate() {
            let before = (old >= 1.0).then(|| all.materials.get(old as usize - 1)).flatten();
            let after = (new.values[face] >= 1.0).then(|| &left.materials[new.values[face] as usize - 1]);
            assert_eq!(before.map(|m| &m["name"]), after.map(|m| &m["name"]), "{groups:?} {face}");
            assert_eq!(before.map(|m| shown(&all, m)), after.map(|m| shown(left, m)), "{groups:?} {face}");
            assert_eq!(before.map(|m| &m["extras"]), after.map(|m| &m["extras"]));
        }
        assert_eq!(pruned.parts[0].mesh.faces(), scene.parts[0].mesh.faces());
    }
    let level = in_groups([5.0; 4], all.clone());
    let level = level.with_used_materials().expect("pruned");
    assert_eq!(level.assets.materials[1]["extensions"]["MSFT_lod"]["ids"], json!([0]));
}

#[test]
fn an_extension_that_may_name_textures_in_another_way_keeps_them_all() {
    let mut all = five_materials();
    all.materials[1]["extensions"] = json!({ "VENDOR_paint": { "layers": [0, 1] } });
    let scene = in_groups([2.0; 4], all.clone());
    let pruned = scene.with_used_materials().expect("pruned");
    assert_eq!(pruned.assets.materials, [all.materials[1].clone()]);
    assert_eq!((&pruned.assets.textures, &pruned.assets.images), (&all.textures, &all.images));
}

#[test]
fn names_without_looks_are_left_out_too_and_a_scene_that_uses_all_is_borrowed() {
    let names = ["", "oak", "elm", "fir"].map(str::to_owned).to_vec();
    let mut scene = in_groups([3.0, 3.0, 1.0, 3.0], SceneAssets::default());
    scene.groups.insert(MATERIAL.to_owned(), names);
    let pruned = scene.with_used_materials().expect("pruned");
    assert_eq!(pruned.groups[MATERIAL], ["", "oak", "fir"]);
    let groups = pruned.parts[0].mesh.attribute(&Semantic::Group(MATERIAL.to_owned())).expect("groups");
    assert_eq!(groups.values, [2.0, 2.0, 1.0, 2.0]);
    assert!(matches!(pruned.with_used_materials(), Ok(std::borrow::Cow::Borrowed(_))));
}

#[test]
fn a_picture_beside_a_gltf_need_not_say_its_type() {
    let ktx2 = b"\xABKTX 20\xBB\r\n\x1A\n and the rest".to_vec();
    let unknown = b"no picture that is known".to_vec();
    for (name, bytes, mime) in [
        ("n.ktx2", &ktx2, Some("image/ktx2")),
        ("n.bin", &ktx2, Some("image/ktx2")),
        ("n.DDS", &unknown, Some("image/vnd-ms.dds")),
        ("n.tga", &unknown, None),
    ] {
        let (mut json, bin) = super::build::triangle();
        super::build::put(&mut json, "/images", json!([{ "uri": name }]));
        super::build::put(&mut json, "/buffers/0/uri", json!("b.bin"));
        let mut open = |path: &str| Ok(if path == "b.bin" { bin.clone() } else { bytes.clone() });
        let text = json.to_string();
        let found = read_with(text.as_bytes(), Format::Gltf, &mut open, &Limits::default()).expect("read");
        let (scene, warnings) = scene_of(found);
        let image = &scene.assets.images[0];
        match mime {
            Some(mime) => {
                assert_eq!(image.content, ImageContent::Bytes(bytes[..].into()), "{name}");
                assert_eq!((image.properties["mimeType"].as_str(), &warnings[..]), (Some(mime), &[][..]));
            }
            None => assert_eq!(warnings, ["picture-unknown"]),
        }
    }
}

#[test]
fn a_buffer_without_a_uri_is_missed_where_it_is_needed_alone() {
    let (mut json, bin) = super::build::triangle();
    // The bytes are those of a second buffer.
    super::build::put(
        &mut json,
        "/buffers",
        json!([{ "byteLength": 4 }, { "byteLength": 44, "uri": "b.bin" }]),
    );
    for view in ["/bufferViews/0/buffer", "/bufferViews/1/buffer"] {
        super::build::put(&mut json, view, json!(1));
    }
    let mut open = |_: &str| Ok(bin.clone());
    let read = |json: &Value, open: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>| {
        read_with(json.to_string().as_bytes(), Format::Gltf, &mut |path: &str| open(path), &Limits::default())
    };
    let (scene, warnings) = scene_of(read(&json, &mut open).expect("read"));
    assert_eq!((scene.parts[0].mesh.faces().len(), warnings), (1, vec![]));
    super::build::put(&mut json, "/bufferViews/0/buffer", json!(0));
    super::build::put(&mut json, "/buffers/0/byteLength", json!(44));
    let error = read(&json, &mut open).expect_err("read");
    assert!(error.to_string().contains("buffer 0 has no data"), "{error}");
}
