//! Materials, textures, pictures, cameras, lights and animations go through a scene untouched.
use super::build::{glb_of, loaded, put, scene_of, triangle};
use chordal::Mesh;
use chordal::explicit::{Attribute, Semantic};
use chordal_io::{
    Content, FileLocation, Format, ImageContent, Limits, MATERIAL, Scene, glb, read, read_with,
};
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// A picture of one pixel.
pub(super) const PNG: &[u8] = &[
    0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1A, b'\n', 0, 0, 0, 13, b'I', b'H', b'D', b'R', 0, 0, 0, 1, 0, 0,
    0, 1, 8, 0, 0, 0, 0, 0x3A, 0x7E, 0x9B, 0x55, 0, 0, 0, 10, b'I', b'D', b'A', b'T', 0x78, 0xDA, 0x63, 0xF8,
    0x0F, 0, 1, 1, 1, 0, 0x1B, 0xB6, 0xEE, 0x56, 0, 0, 0, 0, b'I', b'E', b'N', b'D', 0xAE, 0x42, 0x60, 0x82,
];

/// Two primitives of one mesh in two materials with a texture, a camera, a light, an animation, extras.
pub(super) fn furnished() -> (Value, Vec<u8>) {
    let (mut json, mut bin) = triangle();
    let mut view = |bytes: &[u8]| {
        bin.resize(bin.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len() });
        bin.extend(bytes);
        view
    };
    let floats = |numbers: &[f32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let views = [
        view(PNG),
        view(&floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0])),
        view(&floats(&[0.0, 0.5])),
        view(&floats(&[0.0, 0.0, 0.0, 1.0, 2.0, 3.0])),
    ];
    for (i, view) in views.into_iter().enumerate() {
        put(&mut json, &format!("/bufferViews/{}", 2 + i), view);
    }
    put(&mut json, "/bufferViews/3/target", json!(34962));
    put(&mut json, "/buffers/0/byteLength", json!(bin.len()));
    for (i, accessor) in [
        json!({ "bufferView": 3, "componentType": 5126, "count": 3, "type": "VEC2" }),
        json!({ "bufferView": 4, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0.0], "max": [0.5] }),
        json!({ "bufferView": 5, "componentType": 5126, "count": 2, "type": "VEC3" }),
    ]
    .into_iter()
    .enumerate()
    {
        put(&mut json, &format!("/accessors/{}", 2 + i), accessor);
    }
    let primitive = |material: usize| json!({ "attributes": { "POSITION": 0, "TEXCOORD_0": 2 }, "indices": 1, "material": material });
    for (at, value) in [
        ("/meshes/0/primitives", json!([primitive(1), primitive(0)])),
        ("/asset/copyright", json!("CC0")),
        ("/images", json!([{ "name": "pixel", "bufferView": 2, "mimeType": "image/png" }])),
        ("/samplers", json!([{ "wrapS": 33071 }])),
        ("/textures", json!([{ "source": 0, "sampler": 0 }])),
        (
            "/materials",
            json!([
                { "name": "painted", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } }, "extras": { "a": 1 } },
                { "name": "lit", "extensions": { "KHR_materials_unlit": {} }, "doubleSided": true },
            ]),
        ),
        ("/cameras", json!([{ "type": "perspective", "perspective": { "yfov": 0.75, "znear": 0.125 } }])),
        (
            "/nodes",
            json!([
                { "name": "top", "children": [1, 2], "mesh": 0, "rotation": [0.0, 0.6, 0.0, 0.8], "scale": [1.0, 1.0, 1.0], "extras": { "b": [2] } },
                { "name": "eye", "camera": 0, "translation": [0.0, 0.0, 5.0] },
                { "name": "lamp", "extensions": { "KHR_lights_punctual": { "light": 0 } }, "matrix":
                    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 7.0, 8.0, 9.0, 1.0] },
            ]),
        ),
        (
            "/animations",
            json!([{
                "name": "slide",
                "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }],
                "samplers": [{ "input": 3, "output": 4 }],
            }]),
        ),
        ("/extensions", json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } })),
        ("/extensionsUsed", json!(["KHR_materials_unlit", "KHR_lights_punctual"])),
    ] {
        put(&mut json, at, value);
    }
    (json, bin)
}

/// The furnished scene as it comes back: each of the two primitives has vertices of its own.
pub(super) fn with_own_vertices(scene: &Scene) -> Scene {
    let mesh = &scene.parts[0].mesh;
    let attribute = |semantic: Semantic| mesh.attribute(&semantic).expect("there").clone();
    let set = attribute(Semantic::TexCoord(0));
    let set = Attribute { values: set.values.repeat(2), ..set };
    let groups = attribute(Semantic::Group(MATERIAL.to_owned()));
    let mesh = Mesh::new(mesh.positions().repeat(2), vec![[0, 1, 2], [3, 4, 5]])
        .and_then(|mesh| mesh.with_position_id(vec![0, 1, 2, 0, 1, 2]))
        .and_then(|mesh| mesh.with_attribute(set))
        .and_then(|mesh| mesh.with_attribute(groups))
        .expect("a mesh");
    let mut scene = scene.clone();
    scene.parts[0].mesh = mesh;
    scene
}

fn written(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    glb::write(scene, None, &mut bytes).expect("written");
    bytes
}

#[test]
fn everything_beside_the_meshes_reads_back_as_it_was() {
    let (json, bin) = furnished();
    let (scene, warnings) = loaded(&json, &bin);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(scene.assets.materials[..], json["materials"].as_array().unwrap()[..]);
    assert_eq!(scene.assets.images[0].content, ImageContent::Bytes(PNG.into()));
    assert_eq!(scene.assets.about["copyright"], "CC0");
    let groups = scene.parts[0].mesh.attribute(&Semantic::Group(MATERIAL.to_owned())).expect("groups");
    assert_eq!(groups.values, [2.0, 1.0]);
    let (again, warnings) = scene_of(glb::read(&written(&scene), &Limits::default()).expect("read"));
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(again, with_own_vertices(&scene));
    // The file says of its nodes what the first one said: turns stay turns, and no matrix takes their place.
    let bytes = written(&scene);
    let text = String::from_utf8_lossy(&bytes);
    for said in ["\"rotation\":[0.0,0.6,0.0,0.8]", "\"camera\":0", "\"copyright\":\"CC0\"", "\"b\":[2]"] {
        assert!(text.contains(said), "{said} in {text}");
    }
}

#[test]
fn faces_of_one_material_become_one_primitive_with_vertices_of_its_own() {
    let (json, bin) = furnished();
    let (mut scene, _) = loaded(&json, &bin);
    let mesh = scene.parts[0].mesh.clone();
    let groups = mesh.attribute(&Semantic::Group(MATERIAL.to_owned())).expect("groups").clone();
    let faces: Vec<[u32; 3]> = mesh.faces().iter().chain(mesh.faces()).copied().collect();
    let mut four = Mesh::new(mesh.positions().to_vec(), faces).expect("faces");
    four = four.with_attribute(Attribute { values: vec![2.0, 1.0, 0.0, 2.0], ..groups }).expect("groups");
    four = four.with_attribute(mesh.attribute(&Semantic::TexCoord(0)).expect("set").clone()).expect("set");
    scene.parts[0].mesh = four;
    let bytes = written(&scene);
    let end = 20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: Value = serde_json::from_slice(&bytes[20..end]).expect("JSON");
    let primitives = json["meshes"][0]["primitives"].as_array().expect("primitives");
    let said: Vec<(u64, u64)> = primitives
        .iter()
        .map(|primitive| {
            let indices = primitive["indices"].as_u64().expect("indices") as usize;
            (
                primitive["material"].as_u64().expect("material"),
                json["accessors"][indices]["count"].as_u64().unwrap(),
            )
        })
        .collect();
    // The third material is the plain one of faces without any.
    assert_eq!(said, [(1, 6), (0, 3), (2, 3)]);
    let positions: BTreeSet<u64> = primitives
        .iter()
        .map(|primitive| primitive["attributes"]["POSITION"].as_u64().expect("positions"))
        .collect();
    assert_eq!(positions.len(), 3, "{primitives:?}");
    assert!(positions.iter().all(|at| json["accessors"][*at as usize]["count"] == 3));
    let (again, _) = scene_of(glb::read(&bytes, &Limits::default()).expect("read"));
    let groups = again.parts[0].mesh.attribute(&Semantic::Group(MATERIAL.to_owned())).expect("groups");
    assert_eq!(groups.values, [2.0, 2.0, 1.0, 0.0]);
}

#[test]
fn a_gltf_is_read_from_its_files_or_from_itself() {
    let (mut json, bin) = furnished();
    let (scene, _) = loaded(&json, &bin);
    put(&mut json, "/buffers/0/uri", json!("data/shape%20one.bin"));
    put(&mut json, "/images", json!([{ "name": "pixel", "uri": "pixel.png", "mimeType": "image/png" }]));
    let text = json.to_string();
    assert_eq!(Format::sniff(text.as_bytes()), Some(Format::Gltf));
    let mut open = |path: &str| match path {
        "data/shape one.bin" => Ok(bin.clone()),
        "pixel.png" => Ok(PNG.to_vec()),
        other => Err(format!("no {other}")),
    };
    let limits = Limits::default();
    let found = read_with(text.as_bytes(), Format::Gltf, &mut open, &limits).expect("read");
    let (outer, warnings) = scene_of(found);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(outer, scene);
    let mut embedded = Vec::new();
    glb::write_embedded(&scene, None, &mut embedded).expect("written");
    let (inner, warnings) = scene_of(read(&embedded, Format::Gltf, &limits).expect("read"));
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(inner, with_own_vertices(&scene));
}

#[test]
fn files_outside_the_folder_are_refused_and_a_picture_that_is_missing_is_a_warning() {
    let (mut json, bin) = furnished();
    let limits = Limits::default();
    for (uri, code) in [
        ("../shape.bin", "outside-folder"),
        ("/etc/passwd", "outside-folder"),
        ("%2e%2e/shape.bin", "outside-folder"),
        ("https://example.org/shape.bin", "no-network"),
        ("file:///etc/passwd", "no-network"),
    ] {
        put(&mut json, "/buffers/0/uri", json!(uri));
        let mut open = |path: &str| -> Result<Vec<u8>, String> { panic!("{path} was opened") };
        let error = read_with(json.to_string().as_bytes(), Format::Gltf, &mut open, &limits).expect_err(uri);
        assert_eq!(
            (error.code, error.place),
            (code, FileLocation::Pointer("/buffers/0/uri".to_owned())),
            "{uri}"
        );
    }
    put(&mut json, "/buffers/0/uri", json!("shape.bin"));
    let mut gone = |_: &str| Err("it is gone".to_owned());
    let error = read_with(json.to_string().as_bytes(), Format::Gltf, &mut gone, &limits).expect_err("gone");
    assert_eq!((error.code, error.to_string().contains("it is gone")), ("missing-file", true));
    // All files together are below the limit.
    let small = Limits { bytes: 100_000, ..limits };
    let mut large = |_: &str| Ok(vec![0; 200_000]);
    let error = read_with(json.to_string().as_bytes(), Format::Gltf, &mut large, &small).expect_err("large");
    assert_eq!(error.code, "too-large");
    put(&mut json, "/images", json!([{ "uri": "pixel.png", "mimeType": "image/png" }]));
    let mut open =
        |path: &str| if path == "shape.bin" { Ok(bin.clone()) } else { Err("it is gone".to_owned()) };
    let found = read_with(json.to_string().as_bytes(), Format::Gltf, &mut open, &limits).expect("read");
    assert_eq!(found.warnings.iter().map(|warning| warning.code).collect::<Vec<_>>(), ["picture-missing"]);
    let Content::Scene(scene) = found.content else { panic!("no scene") };
    assert_eq!(scene.assets.images[0].content, ImageContent::Uri("pixel.png".to_owned()));
}

#[test]
fn the_certificate_of_the_file_that_was_read_does_not_stay() {
    let (mut json, bin) = triangle();
    put(&mut json, "/asset/extras", json!({ "chordal": { "bound": 1 }, "more": 2 }));
    let scene = scene_of(glb::read(&glb_of(&json.to_string(), &bin), &Limits::default()).expect("read")).0;
    assert_eq!(Value::Object(scene.assets.about.clone()), json!({ "extras": { "more": 2 } }));
    let again = scene_of(glb::read(&written(&scene), &Limits::default()).expect("read")).0;
    assert_eq!(again.certificate, None);
}
