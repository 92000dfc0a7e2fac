//! Files made by hand.
use chordal_io::{Conformance, Content, FileLocation, Limits, ReadError, ReadOutcome, Scene, glb};
use serde_json::{Value, json};

/// A GLB of a JSON text and a buffer.
pub fn glb_of(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut chunks = Vec::new();
    for (kind, data, filler) in [(b"JSON", json.as_bytes(), b' '), (b"BIN\0", bin, 0)] {
        if data.is_empty() {
            continue;
        }
        let mut data = data.to_vec();
        data.resize(data.len().next_multiple_of(4), filler);
        chunks.extend((data.len() as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(data);
    }
    let mut file = b"glTF".to_vec();
    file.extend(2_u32.to_le_bytes());
    file.extend((12 + chunks.len() as u32).to_le_bytes());
    file.extend(chunks);
    file
}

/// A document with one object of each kind that the validator knows, which it accepts.
pub fn every_object() -> (Value, Vec<u8>) {
    let json = serde_json::from_str(include_str!("../data/every_object.gltf")).expect("JSON");
    (json, include_bytes!("../data/every_object.bin").to_vec())
}

/// One triangle with u16 indices.
pub fn triangle() -> (Value, Vec<u8>) {
    let mut bin = Vec::new();
    for x in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0] {
        bin.extend(x.to_le_bytes());
    }
    for i in [0_u16, 1, 2, 0] {
        bin.extend(i.to_le_bytes());
    }
    let json = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 2, 0] },
            { "bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36, "target": 34962 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 6, "target": 34963 }
        ],
        "buffers": [{ "byteLength": 44 }]
    });
    (json, bin)
}

/// The triangle's document with values put at JSON pointers; `Null` takes a key out.
pub fn triangle_with(changes: &[(&str, Value)]) -> (Value, Vec<u8>) {
    let (mut json, bin) = triangle();
    changes.iter().for_each(|(at, value)| put(&mut json, at, value.clone()));
    (json, bin)
}

/// Puts a value at a JSON pointer; `Null` takes a key out, and one past the end of a list appends.
pub fn put(json: &mut Value, at: &str, value: Value) {
    let (parent, key) = at.rsplit_once('/').expect("a pointer");
    match json.pointer_mut(parent).unwrap_or_else(|| panic!("no {parent}")) {
        Value::Object(map) if value.is_null() => {
            map.shift_remove(key);
        }
        Value::Object(map) => {
            map.insert(key.to_owned(), value);
        }
        Value::Array(list) => match list.get_mut(key.parse::<usize>().expect("an index")) {
            Some(item) => *item = value,
            None => list.push(value),
        },
        other => panic!("{parent} is {other}"),
    }
}

/// For readers who refuse whatever the validator calls an error.
pub fn strict() -> Limits {
    Limits { conformance: Conformance::Strict, ..Limits::default() }
}

/// Reads strictly.
pub fn read(json: &Value, bin: &[u8]) -> Result<ReadOutcome, ReadError> {
    glb::read(&glb_of(&json.to_string(), bin), &strict())
}

/// The scene and the warnings' codes.
pub fn loaded(json: &Value, bin: &[u8]) -> (Scene, Vec<&'static str>) {
    let loaded = read(json, bin).unwrap_or_else(|error| panic!("{}: {error}", error.code));
    scene_of(loaded)
}

pub fn scene_of(loaded: ReadOutcome) -> (Scene, Vec<&'static str>) {
    let Content::Scene(scene) = loaded.content else { panic!("no scene") };
    (scene, loaded.warnings.iter().map(|warning| warning.code).collect())
}

/// The code and the pointer of the error; both have to be as expected.
#[track_caller]
pub fn refused(json: &Value, bin: &[u8], code: &str, pointer: &str) -> String {
    let error = read(json, bin).map(|_| ()).expect_err("accepted");
    assert_eq!((error.code, &error.place), (code, &FileLocation::Pointer(pointer.to_owned())), "{error}");
    error.to_string()
}

/// The same, where leniency makes a warning of it.
#[track_caller]
pub fn refused_unless_lenient(json: &Value, bin: &[u8], code: &str, pointer: &str) -> Scene {
    refused(json, bin, code, pointer);
    let limits = Limits { conformance: Conformance::Lenient, ..Limits::default() };
    let loaded = glb::read(&glb_of(&json.to_string(), bin), &limits).expect("lenient");
    assert!(loaded.warnings.iter().any(|warning| warning.code == code), "{:?}", loaded.warnings);
    scene_of(loaded).0
}

/// The bytes of a text in base64.
pub fn base64(text: &str) -> Vec<u8> {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let (mut out, mut bits, mut n_bits) = (Vec::new(), 0_u32, 0);
    for byte in text.bytes().filter(|byte| *byte != b'=') {
        let digit = DIGITS.iter().position(|digit| *digit == byte).expect("a digit");
        bits = (bits << 6 | digit as u32) & 0xFFFF;
        n_bits += 6;
        if n_bits >= 8 {
            n_bits -= 8;
            out.push((bits >> n_bits) as u8);
        }
    }
    out
}
