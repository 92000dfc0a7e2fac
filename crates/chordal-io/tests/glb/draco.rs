//! Primitives that are compressed by `KHR_draco_mesh_compression`.
use super::build::{base64, glb_of, put, strict};
use chordal::explicit::Semantic;
use chordal_io::{Conformance, Content, FileLocation, Limits, ReadError, ReadOutcome, Scene, glb};
use chordal_testkit::{Random, corpus};
use serde_json::{Value, json};

const PLACE: &str = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";

/// A row of `tests/data/draco_streams.json`: a stream and what it decodes to. `tests/web/draco_fixtures.mjs` made
/// them with Google's encoder and decoder, and `tests/web/draco.mjs` compares them with the decoder that three.js
/// ships.
#[derive(Clone)]
struct KnownStream {
    name: String,
    stream: Vec<u8>,
    faces: Vec<[u32; 3]>,
    n_points: usize,
    /// The numbers of each attribute by its number in the stream.
    values: [Vec<f64>; 4],
}

/// Name, component type, type, numbers a row, by the number in the stream.
const ATTRIBUTES: [(&str, u32, &str, usize); 4] = [
    ("POSITION", 5126, "VEC3", 3),
    ("NORMAL", 5126, "VEC3", 3),
    ("TEXCOORD_0", 5126, "VEC2", 2),
    ("COLOR_0", 5121, "VEC4", 4),
];

fn known_streams() -> Vec<KnownStream> {
    let rows: Vec<Value> = serde_json::from_str(include_str!("../data/draco_streams.json")).expect("JSON");
    let bytes = |value: &Value| base64(value.as_str().expect("a text"));
    let words = |bytes: Vec<u8>| -> Vec<[u8; 4]> { bytes.as_chunks().0.to_vec() };
    let known = rows.iter().map(|row| {
        let values = ATTRIBUTES.map(|(name, component, ..)| {
            let bytes = bytes(&row["attributes"][name]["values"]);
            match component {
                5126 => words(bytes).into_iter().map(|word| f64::from(f32::from_le_bytes(word))).collect(),
                _ => bytes.into_iter().map(|byte| f64::from(byte) / 255.0).collect(),
            }
        });
        let corners: Vec<u32> = words(bytes(&row["indices"])).into_iter().map(u32::from_le_bytes).collect();
        KnownStream {
            name: row["name"].as_str().expect("a name").to_owned(),
            stream: bytes(&row["stream"]),
            faces: corners.as_chunks().0.to_vec(),
            n_points: row["n_points"].as_u64().expect("a count") as usize,
            values,
        }
    });
    known.collect()
}

impl KnownStream {
    /// A document whose one primitive is in the stream alone.
    fn document(&self) -> Value {
        let name = "KHR_draco_mesh_compression";
        let accessors = ATTRIBUTES.map(|(attribute, component, kind, _)| {
            let normalized = component == 5121;
            let mut rows = json!({
                "componentType": component, "type": kind, "count": self.n_points, "normalized": normalized,
            });
            if attribute == "POSITION" {
                // As exporters write them: from before the stream rounded the positions.
                put(&mut rows, "/min", json!([-1.01, -1.01, -1.01]));
                put(&mut rows, "/max", json!([1.01, 1.01, 1.01]));
            }
            rows
        });
        let mut accessors = accessors.to_vec();
        accessors.push(json!({ "componentType": 5123, "type": "SCALAR", "count": 3 * self.faces.len() }));
        json!({
            "asset": { "version": "2.0" }, "extensionsUsed": [name], "extensionsRequired": [name],
            "buffers": [{ "byteLength": self.stream.len() }],
            "bufferViews": [{ "buffer": 0, "byteLength": self.stream.len() }],
            "accessors": accessors,
            "meshes": [{ "primitives": [{
                "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "COLOR_0": 3 }, "indices": 4,
                "extensions": { name: {
                    "bufferView": 0, "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "COLOR_0": 3 }
                } },
            }] }],
            "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }],
        })
    }

    fn read(&self, document: &Value, limits: &Limits) -> Result<ReadOutcome, ReadError> {
        glb::read(&glb_of(&document.to_string(), &self.stream), limits)
    }

    #[track_caller]
    fn refused(&self, document: &Value, limits: &Limits, code: &str) -> String {
        let error = self.read(document, limits).map(|_| ()).expect_err("accepted");
        let place = FileLocation::Pointer(PLACE.to_owned());
        assert_eq!((error.code, &error.place), (code, &place), "{error}");
        error.to_string()
    }
}

fn scene(loaded: ReadOutcome) -> Scene {
    let Content::Scene(scene) = loaded.content else { panic!("no scene") };
    scene
}

#[test]
fn streams_decode_as_google_decodes_them() {
    let known = known_streams();
    assert_eq!(known.len(), 8);
    for stream in &known {
        let loaded =
            stream.read(&stream.document(), &strict()).unwrap_or_else(|e| panic!("{}: {e}", stream.name));
        assert_eq!(loaded.warnings, [], "{}", stream.name);
        let scene = scene(loaded);
        let mesh = &scene.parts[0].mesh;
        assert_eq!(mesh.faces(), stream.faces, "{}", stream.name);
        let flat: Vec<f64> = mesh.positions().iter().flatten().copied().collect();
        assert_eq!(flat, stream.values[0], "{}", stream.name);
        let named = [Semantic::Normal, Semantic::TexCoord(0), Semantic::Color(0)];
        for (semantic, values) in named.iter().zip(&stream.values[1..]) {
            let attribute = mesh.attribute(semantic).unwrap_or_else(|| panic!("no {semantic:?}"));
            assert_eq!(&attribute.values, values, "{} {semantic:?}", stream.name);
        }
    }
}

#[test]
fn primitives_share_streams_and_keep_what_is_plain() {
    let stream = &known_streams()[0];
    let mut document = stream.document();
    let primitive = document.pointer("/meshes/0/primitives/0").expect("there").clone();
    put(&mut document, "/meshes/0/primitives/1", primitive);
    let twice = scene(stream.read(&document, &strict()).expect("shared"));
    assert_eq!(twice.parts[0].mesh.faces().len(), 2 * stream.faces.len());
    assert_eq!(twice.parts[0].mesh.positions().len(), stream.n_points);
    // Where the file gives another count of points, it is the stream that viewers show.
    let mut document = stream.document();
    put(&mut document, "/accessors/1/count", json!(3));
    let scene = scene(stream.read(&document, &strict()).expect("another count"));
    let normals = scene.parts[0].mesh.attribute(&Semantic::Normal).expect("normals");
    assert_eq!(normals.values, stream.values[1]);
}

#[test]
fn what_a_stream_is_not_is_refused_at_its_primitive() {
    let stream = &known_streams()[1];
    let change = |at: &str, value: Value| {
        let mut document = stream.document();
        put(&mut document, at, value);
        document
    };
    let at = |key: &str| format!("{PLACE}/{key}");
    for (at, value, message) in [
        (at("attributes/NORMAL"), json!(9), "no attribute 9"),
        (at("attributes/NORMAL"), json!(2), "2 numbers, its accessor 3"),
        ("/accessors/3/componentType".to_owned(), json!(5123), "Uint8"),
        ("/bufferViews/0/byteLength".to_owned(), json!(stream.stream.len() - 40), "cannot be decoded"),
    ] {
        let found = stream.refused(&change(&at, value), &strict(), "draco-stream");
        assert!(found.contains(message), "{found}");
    }
    let strip = change("/meshes/0/primitives/0/mode", json!(5));
    stream.refused(&strip, &strict(), "unsupported-extension");
    for (at, value) in
        [(at("bufferView"), json!(7)), (at("bufferView"), Value::Null), (at("attributes"), json!([]))]
    {
        assert!(stream.read(&change(&at, value), &strict()).is_err());
    }
    // Leniency does not make up triangles.
    let lenient = Limits { conformance: Conformance::Lenient, ..Limits::default() };
    let broken = change("/bufferViews/0/byteLength", json!(stream.stream.len() - 40));
    assert_eq!(stream.read(&broken, &lenient).map(|_| ()).expect_err("accepted").code, "draco-stream");
    // What is decoded counts against the limits: a few bytes can stand for millions of triangles.
    let rows = Limits { rows: 5, ..strict() };
    stream.refused(&stream.document(), &rows, "too-large");
    let bytes = Limits { bytes: 4096, ..strict() };
    assert!(stream.read(&stream.document(), &bytes).is_err());
}

#[test]
fn broken_streams_end_in_an_error_or_a_mesh() {
    let (mut random, mut n_read) = (Random::new(5), 0);
    for seed in known_streams() {
        for _ in 0..chordal_testkit::cases(400) {
            let mut broken = seed.clone();
            for _ in 0..1 + random.below(3) {
                let at = random.below(broken.stream.len());
                broken.stream[at] = random.below(256) as u8;
            }
            if random.below(8) == 0 {
                broken.stream.truncate(1 + random.below(broken.stream.len()));
            }
            match broken.read(&broken.document(), &Limits::default()) {
                Ok(_) => n_read += 1,
                Err(error) => assert!(!error.to_string().is_empty()),
            }
        }
    }
    assert!(n_read > 100, "only {n_read} were read: the bytes that change do not matter");
}

#[test]
fn a_box_of_khronos_is_the_same_with_and_without() {
    let Some(folder) = corpus::find("gltf/khronos/testdata/Box/glTF_Binary") else { return };
    let read = |name: &str| {
        let bytes = std::fs::read(folder.join(name)).expect("readable");
        scene(glb::read(&bytes, &strict()).unwrap_or_else(|error| panic!("{name}: {error}")))
    };
    let (packed, plain) = (read("Box_Draco.glb"), read("Box.glb"));
    let corners = |scene: &Scene| -> Vec<Vec<[i64; 3]>> {
        let mesh = &scene.parts[0].mesh;
        // The stream has eleven bits a coordinate over one unit.
        let corner = |v: u32| mesh.positions()[v as usize].map(|x| (x * 512.0).round() as i64);
        let mut faces: Vec<Vec<_>> = mesh.faces().iter().map(|face| face.map(corner).to_vec()).collect();
        for face in &mut faces {
            let first = (0..3).min_by_key(|k| face[*k]).expect("a corner");
            face.rotate_left(first);
        }
        faces.sort();
        faces
    };
    assert_eq!(corners(&packed), corners(&plain));
    assert_eq!(packed.nodes.len(), plain.nodes.len());
}

#[test]
fn a_file_of_draco_is_what_its_stream_holds() {
    for known in known_streams() {
        let Ok(ReadOutcome { content: Content::Scene(scene), .. }) =
            chordal_io::read(&known.stream, chordal_io::Format::Drc, &Limits::default())
        else {
            panic!("{}", known.name)
        };
        assert_eq!(chordal_io::Format::sniff(&known.stream), Some(chordal_io::Format::Drc));
        let mesh = &scene.parts[0].mesh;
        assert_eq!(mesh.faces(), known.faces, "{}", known.name);
        assert_eq!(mesh.positions().as_flattened(), known.values[0], "{}", known.name);
        let of = |semantic: &Semantic| mesh.attributes().iter().find(|one| one.semantic == *semantic);
        let all = [Semantic::Normal, Semantic::TexCoord(0), Semantic::Color(0)];
        for (semantic, values) in all.iter().zip(&known.values[1..]).skip(1) {
            assert_eq!(of(semantic).map(|one| &one.values), Some(values), "{} {semantic:?}", known.name);
        }
        assert!(of(&Semantic::Normal).is_some(), "{}", known.name);
    }
}

#[test]
fn a_damaged_file_of_draco_is_an_error() {
    let known = known_streams().swap_remove(0);
    let code = |bytes: &[u8]| {
        chordal_io::read(bytes, chordal_io::Format::Drc, &Limits::default()).err().map(|error| error.code)
    };
    assert!(code(b"DRACO").is_some() && code(&known.stream[..known.stream.len() / 2]).is_some());
    assert_eq!(code(b"v 0 0 0"), Some("bad-magic"));
    let mut points = known.stream.clone();
    points[7] = 0;
    assert_eq!(code(&points), Some("no-triangles"));
    let small = Limits { bytes: known.stream.len() as u64, ..Limits::default() };
    let error = chordal_io::read(&known.stream, chordal_io::Format::Drc, &small).unwrap_err();
    assert_eq!(error.code, "too-large");
    // No change of a byte is more than an error.
    let mut random = Random::new(66);
    for _ in 0..300 {
        let mut bytes = known.stream.clone();
        let at = random.below(bytes.len());
        bytes[at] ^= 1 << random.below(8);
        let _ = chordal_io::read(&bytes, chordal_io::Format::Drc, &Limits::default());
    }
}
