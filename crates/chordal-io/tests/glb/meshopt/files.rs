//! Files as gltfpack writes them: compressed, quantized, with the mesh at many places.
use super::super::build::{glb_of, put, scene_of, strict};
use super::{attribute, encode};
use chordal::Mesh;
use chordal::explicit::Semantic;
use chordal_io::{Conformance, Content, FileLocation, Limits, Scene, glb, read_with};
use chordal_testkit::{Random, corpus};
use serde_json::{Value, json};
use std::f64::consts::TAU;

const EXT: &[u8] = include_bytes!("../../data/torus_ext_meshopt.glb");
const KHR: &[u8] = include_bytes!("../../data/torus_khr_meshopt.glb");

fn read(file: &[u8]) -> (Scene, Vec<&'static str>) {
    scene_of(glb::read(file, &Limits::default()).unwrap_or_else(|error| panic!("{error} ({})", error.code)))
}

/// The JSON and the buffer of a file.
fn taken_apart(file: &[u8]) -> (Value, Vec<u8>) {
    let n = u32::from_le_bytes([file[12], file[13], file[14], file[15]]) as usize;
    (serde_json::from_slice(&file[20..20 + n]).expect("JSON"), file[28 + n..].to_vec())
}

/// The torus of radii 2 and 1 about y: the distance of a point from it, its normal there, and its parameters.
fn torus([x, y, z]: [f64; 3]) -> (f64, [f64; 3], [f64; 2]) {
    let from_axis = (x * x + z * z).sqrt();
    let (across, radius) = (from_axis - 2.0, (from_axis - 2.0).hypot(y));
    let normal = [across / radius * x / from_axis, y / radius, across / radius * z / from_axis];
    (radius - 1.0, normal, [z.atan2(x) / TAU, y.atan2(across) / TAU])
}

#[test]
fn every_attribute_of_a_packed_torus() {
    for (file, tolerance) in [(EXT, 0.5 / 255.0), (KHR, 1.0 / 127.0)] {
        let (scene, warnings) = read(file);
        assert_eq!(warnings, ["picture-missing"], "nothing else is left out");
        let part = &scene.parts[0];
        let mesh: &Mesh = &part.mesh;
        assert_eq!((part.name.as_str(), mesh.positions().len(), mesh.faces().len()), ("torus", 190, 324));
        let row = |semantic: Semantic, i: usize| mesh.attribute(&semantic).expect("there").row(i).to_vec();
        for (i, stored) in mesh.positions().iter().enumerate() {
            // The node undoes the quantization: 14 bits over six units.
            let at = stored.map(|x| x * 6.0 / 16383.0 - 3.0);
            assert!(stored.iter().all(|x| x.fract() == 0.0));
            let (off, normal, [u, v]) = torus(at);
            assert!(off.abs() < 4e-4, "{at:?} is {off} from the torus");
            let found = row(Semantic::Normal, i);
            assert!((0..3).all(|k| (found[k] - normal[k]).abs() < 0.02), "{found:?} {normal:?}");
            // The material's transform undoes what is stored as a share of 4095 in 16 bits.
            let uv = row(Semantic::TexCoord(0), i).iter().map(|x| x * 65535.0 / 4095.0).collect::<Vec<_>>();
            let wraps = |a: f64, b: f64| (a - b - (a - b).round()).abs() < 5e-4;
            assert!(wraps(uv[0], u) && wraps(uv[1], v), "{uv:?} {u} {v}");
            let color = row(Semantic::Color(0), i);
            let expected = [f64::midpoint(normal[0], 1.0), f64::midpoint(normal[1], 1.0), uv[0], uv[1]];
            // Positions and coordinates are rounded too, and brightness takes the rounding of three numbers.
            let near = (0..4).all(|k| (color[k] - expected[k]).abs() < 3.0 * tolerance + 2e-3);
            assert!(near, "{color:?} {expected:?}");
        }
        // Each face looks outwards: its corners are in the order that was packed.
        for f in 0..mesh.faces().len() {
            let [a, b, c] = mesh.corners(f).map(|p| p.map(|x| x * 6.0 / 16383.0 - 3.0));
            let (d, e) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
            let cross = [d[1] * e[2] - d[2] * e[1], d[2] * e[0] - d[0] * e[2], d[0] * e[1] - d[1] * e[0]];
            let normal = torus([0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0)).1;
            assert!((0..3).map(|k| cross[k] * normal[k]).sum::<f64>() > 0.0, "face {f}");
        }
        let texture = &scene.assets.materials[0]["pbrMetallicRoughness"]["baseColorTexture"];
        let scale = texture["extensions"]["KHR_texture_transform"]["scale"][0].as_f64();
        assert_eq!(scale, Some(65535.0 / 4095.0));
        // Times and turns are kept, unpacked.
        let times: Vec<f32> = scene.assets.accessors[0]
            .bytes
            .chunks(4)
            .map(|x| f32::from_le_bytes([x[0], x[1], x[2], x[3]]))
            .collect();
        assert_eq!(times, (0..24).map(|i| i as f32 / 8.0).collect::<Vec<_>>());
        assert_eq!(scene.assets.accessors[1].bytes.len(), 24 * 8);
        // And what is written says nothing of the compression; places are one node, as they were.
        let mut out = Vec::new();
        glb::write(&scene, None, &mut out).expect("written");
        let text = String::from_utf8_lossy(&out);
        assert!(!text.contains("meshopt") && text.contains("KHR_texture_"));
        assert!(text.contains("EXT_mesh_gpu_instancing"));
        let again = read(&out).0;
        assert_eq!(again.world_meshes().expect("placed").len(), 25);
    }
    // The two files hold the same but for colours.
    let (ext, khr) = (read(EXT).0, read(KHR).0);
    assert_eq!(ext.parts[0].mesh.positions(), khr.parts[0].mesh.positions());
    assert_eq!(ext.parts[0].mesh.faces(), khr.parts[0].mesh.faces());
    assert_eq!(ext.nodes, khr.nodes);
    assert_eq!(ext.assets.accessors, khr.assets.accessors);
}

#[test]
fn instances_that_are_packed() {
    let (scene, _) = read(EXT);
    let crowd = &scene.nodes[3];
    assert_eq!((crowd.name.as_str(), crowd.part, crowd.children.len()), ("crowd", None, 24));
    for (i, child) in crowd.children.iter().enumerate() {
        let (matrix, part) = (*scene.nodes[*child].matrix, scene.nodes[*child].part);
        assert_eq!(part, Some(0));
        // Fifteen bits of the largest of three numbers are kept, and of the others as much as they share.
        let place = [0, 1, 2].map(|k| if (3 * i + k) % 3 == 0 { 5 * (3 * i + k) } else { 3 * i + k });
        let place = [place[0] as f64, place[1] as f64 / 7.0 - 3.0, place[2] as f64 / 7.0 - 3.0];
        let largest = place.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
        assert!((0..3).all(|k| (matrix[12 + k] - place[k]).abs() <= largest / 8192.0), "{place:?}");
        let (a, b) = (0.3 * i as f64, 0.2 * i as f64);
        let (w, n) = (a.cos(), [b.cos(), 0.6 * b.sin(), 0.8 * b.sin()].map(|x| x * a.sin()));
        // The first column of the rotation about n.
        let column = [
            1.0 - 2.0 * (n[1] * n[1] + n[2] * n[2]),
            2.0 * (n[0] * n[1] + n[2] * w),
            2.0 * (n[0] * n[2] - n[1] * w),
        ];
        assert!((0..3).all(|k| (matrix[k] - column[k]).abs() < 3e-3), "{i}: {column:?} {matrix:?}");
        let length: f64 = matrix[..3].iter().map(|x| x * x).sum();
        assert!((length - 1.0).abs() < 1e-12, "rotations do not stretch");
    }
}

#[test]
fn data_rules_hold_for_what_is_unpacked() {
    let (json, bin) = taken_apart(EXT);
    let refused = |json: &Value, code: &str, place: &str| {
        let error = glb::read(&glb_of(&json.to_string(), &bin), &strict()).map(|_| ());
        let error = error.expect_err("accepted");
        assert_eq!((error.code, &error.place), (code, &FileLocation::Pointer(place.to_owned())), "{error}");
    };
    let mut bounds = json.clone();
    put(&mut bounds, "/accessors/0/max/1", json!(16383));
    refused(&bounds, "ACCESSOR_MAX_MISMATCH", "/accessors/0/max/1");
    // Fewer vertices than indices name.
    let mut few = json.clone();
    for (i, count) in [(0, 150), (1, 150), (2, 150), (3, 150)] {
        put(&mut few, &format!("/accessors/{i}/count"), json!(count));
    }
    put(&mut few, "/accessors/0/min", json!([0, 0, 0]));
    let error = glb::read(
        &glb_of(&few.to_string(), &bin),
        &Limits { conformance: Conformance::Lenient, ..Limits::default() },
    );
    let error = error.map(|_| ()).expect_err("accepted");
    assert_eq!(error.code, "ACCESSOR_INDEX_OOB");
    // A normal that is none: the stream of texture coordinates in its place.
    let mut normals = json.clone();
    put(&mut normals, "/accessors/1/bufferView", json!(2));
    put(&mut normals, "/accessors/2/bufferView", json!(1));
    refused(&normals, "ACCESSOR_VECTOR3_NON_UNIT", "/meshes/0/primitives/0/attributes/NORMAL");
}

#[test]
fn the_fallback_is_not_looked_at() {
    let (mut json, bin) = taken_apart(EXT);
    let expected = read(EXT).0;
    // A copy that is there, and says something else; a copy in a file that is nowhere.
    put(&mut json, "/buffers/1/uri", json!("data:application/octet-stream;base64,AAAA"));
    put(&mut json, "/buffers/1/byteLength", json!(3));
    for view in json["bufferViews"].as_array_mut().expect("views") {
        view["byteOffset"] = json!(0);
    }
    let error = glb::read(&glb_of(&json.to_string(), &bin), &strict()).map(|_| ());
    assert_eq!(error.expect_err("accepted").code, "BUFFER_VIEW_TOO_LONG", "views still lie in their buffer");
    put(&mut json, "/buffers/1/byteLength", json!(100_000));
    put(&mut json, "/buffers/1/uri", json!("nowhere.bin"));
    let mut asked = Vec::new();
    let mut open = |name: &str| {
        asked.push(name.to_owned());
        Err("nothing is here".to_owned())
    };
    let file = glb_of(&json.to_string(), &bin);
    let format = chordal_io::Format::Glb;
    let loaded = read_with(&file, format, &mut open, &Limits::default()).expect("read");
    assert_eq!(asked, ["torus.png"]);
    let Content::Scene(scene) = loaded.content else { panic!("no scene") };
    assert_eq!(scene.parts, expected.parts);
    // In a glTF without a container the first buffer may be the one that is not there.
    let packed = encode::vertices(&[9; 40], 4, 0, &mut Random::new(2));
    let mut json = packed.document("EXT_meshopt_compression");
    json["buffers"].as_array_mut().expect("buffers").swap(0, 1);
    put(&mut json, "/bufferViews/0/buffer", json!(0));
    put(&mut json, "/bufferViews/0/extensions/EXT_meshopt_compression/buffer", json!(1));
    put(&mut json, "/buffers/1/uri", json!("stream.bin"));
    let mut open = |_: &str| Ok(packed.stream.clone());
    let text = json.to_string();
    let loaded = read_with(text.as_bytes(), chordal_io::Format::Gltf, &mut open, &Limits::default());
    assert!(loaded.is_ok(), "{:?}", loaded.map(|_| ()));
    // Without the file its rows are skipped, as those of any view are.
    let warnings = scene_of(glb::read(text.as_bytes(), &Limits::default()).expect("read")).1;
    assert!(warnings.contains(&"attribute-skipped"), "{warnings:?}");
}

#[test]
fn a_broken_view_that_no_triangle_needs_is_forgiven() {
    let (json, mut bin) = taken_apart(EXT);
    let times = json["bufferViews"][4]["extensions"]["EXT_meshopt_compression"]["byteOffset"].clone();
    bin[times.as_u64().expect("an offset") as usize] = 0;
    let file = glb_of(&json.to_string(), &bin);
    let error = glb::read(&file, &strict()).map(|_| ()).expect_err("accepted");
    let place = "/bufferViews/4/extensions/EXT_meshopt_compression";
    let found = (error.code, error.place);
    assert_eq!(found, ("meshopt-stream", FileLocation::Pointer(place.to_owned())));
    let lenient = Limits { conformance: Conformance::Lenient, ..Limits::default() };
    let (scene, warnings) = scene_of(glb::read(&file, &lenient).expect("read"));
    assert!(warnings.contains(&"meshopt-stream"), "{warnings:?}");
    assert_eq!((scene.parts[0].mesh.faces().len(), scene.assets.animations.len()), (324, 0));
    assert_eq!(scene.assets.materials.len(), 1, "materials are sound");
    // One that triangles need is not.
    let (json, mut bin) = taken_apart(EXT);
    bin[0] = 0;
    let file = glb_of(&json.to_string(), &bin);
    let error = glb::read(&file, &lenient).map(|_| ()).expect_err("accepted");
    assert_eq!(error.code, "meshopt-stream", "{error}");
    assert!(error.to_string().contains("bufferView 0"), "{error}");
}

#[test]
fn pictures_and_sparse_rows_can_be_packed() {
    let mut random = Random::new(8);
    // Rows 2 and 5 of eight become others, and both lists are packed.
    let (indices, values) = ([2, 5], [1, 2, 3, 4, 5, 6, 7, 8_u8]);
    let index = encode::sequence(&indices, 2, 1, &mut random);
    let value = encode::vertices(&values, 4, 1, &mut random);
    let name = "KHR_meshopt_compression";
    let mut json = value.document(name);
    let view = json!({ "buffer": 1, "byteLength": 4, "extensions": { name: {
        "buffer": 0, "byteOffset": value.stream.len(), "byteLength": index.stream.len(), "byteStride": 2,
        "count": 2, "mode": "INDICES" } } });
    json["bufferViews"].as_array_mut().expect("views").push(view);
    for i in 0..2 {
        put(&mut json, &format!("/accessors/{i}/count"), json!(8));
    }
    put(&mut json, "/accessors/1/bufferView", Value::Null);
    let sparse = json!({ "count": 2, "indices": { "bufferView": 1, "componentType": 5123 },
        "values": { "bufferView": 0 } });
    put(&mut json, "/accessors/1/sparse", sparse);
    let bin = [value.stream, index.stream].concat();
    put(&mut json, "/buffers/0/byteLength", json!(bin.len()));
    let found = attribute(&glb_of(&json.to_string(), &bin), &Limits::default()).expect("read");
    let mut expected = [0; 32];
    expected[8..12].copy_from_slice(&values[..4]);
    expected[20..24].copy_from_slice(&values[4..]);
    assert_eq!(found, expected);
    // A picture's bytes, four at a time.
    let mut picture = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\x01\0\0\0\x01\x08\x02\0\0\0\x90wS\xde".to_vec();
    picture
        .extend(b"\0\0\0\x0cIDATx\x9cc\xf8\xcf\xc0\0\0\x03\x01\x01\0\xc9\xfe\x92\xef\0\0\0\0IEND\xaeB`\x82");
    picture.resize(picture.len().next_multiple_of(4), 0);
    let packed = encode::vertices(&picture, 4, 1, &mut random);
    let mut json = packed.document(name);
    put(&mut json, "/images", json!([{ "bufferView": 0, "mimeType": "image/png" }]));
    put(&mut json, "/textures", json!([{ "source": 0 }]));
    put(&mut json, "/meshes/0/primitives/0/attributes", json!({ "POSITION": 0 }));
    put(&mut json, "/accessors/1", json!({ "componentType": 5121, "type": "VEC4", "count": 1 }));
    let scene = read(&glb_of(&json.to_string(), &packed.stream)).0;
    let chordal_io::ImageContent::Bytes(bytes) = &scene.assets.images[0].content else { panic!("no bytes") };
    assert_eq!(bytes[..], picture[..]);
}

#[test]
fn the_pirate_of_meshoptimizer_is_its_own_obj() {
    let (Some(packed), Some(plain)) = (
        corpus::find("gltf/meshoptimizer/demo/pirate.glb"),
        corpus::find("gltf/meshoptimizer/demo/pirate.obj"),
    ) else {
        return;
    };
    let (scene, warnings) = read(&std::fs::read(packed).expect("readable"));
    assert!(warnings.is_empty(), "{warnings:?}");
    let placed = scene.world_meshes().expect("placed");
    let mesh = &placed[0].1;
    let text = std::fs::read_to_string(plain).expect("readable");
    let numbers = |line: &str| -> Vec<f64> { line.split(' ').filter_map(|x| x.parse().ok()).collect() };
    let of = |kind: &str| -> Vec<Vec<f64>> {
        text.lines().filter_map(|line| line.strip_prefix(kind)).map(numbers).collect()
    };
    let positions = of("v ");
    let corners = text.lines().filter(|line| line.starts_with("f ")).map(|line| line.split(' ').count() - 1);
    assert_eq!(mesh.faces().len(), corners.map(|n| n - 2).sum::<usize>());
    assert_eq!(mesh.positions().len(), 2887);
    // 14 bits over 1.9 units: a step of 1.16e-4, and single precision of the node.
    let step = 0.5 * 1.162_821_79e-4 + 1e-6;
    for p in mesh.positions() {
        let is_near = |q: &Vec<f64>| (0..3).all(|k| (p[k] - q[k]).abs() <= step);
        assert!(positions.iter().any(is_near), "{p:?} is no vertex");
    }
    let normals = mesh.attribute(&Semantic::Normal).expect("normals");
    for row in normals.values.chunks(3) {
        let length: f64 = row.iter().map(|x| x * x).sum();
        assert!((length.sqrt() - 1.0).abs() < 0.007, "{row:?}");
    }
}
