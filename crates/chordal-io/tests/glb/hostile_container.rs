//! HOSTILE.md rows 30 to 35: the container, the JSON, and numbers too large for arithmetic.
use super::build::{glb_of, put, read, refused, scene_of, strict, triangle, triangle_with};
use chordal_io::{Conformance, FileLocation, Limits, ReadError, glb};
use serde_json::json;

fn error_of(bytes: &[u8]) -> ReadError {
    // The container cannot be forgiven.
    let limits = Limits { conformance: Conformance::Lenient, ..Limits::default() };
    let strict = glb::read(bytes, &strict()).map(|_| ()).expect_err("accepted");
    assert_eq!(glb::read(bytes, &limits).map(|_| ()).expect_err("accepted"), strict);
    strict
}

fn patched(bytes: &[u8], at: usize, word: u32) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
    bytes
}

fn a_file() -> Vec<u8> {
    let (json, bin) = triangle();
    glb_of(&json.to_string(), &bin)
}

#[test]
fn h30_lengths_in_the_header() {
    let file = a_file();
    for (bytes, code, place) in [
        (Vec::new(), "GLB_UNEXPECTED_END_OF_HEADER", 0),
        (b"glTF".to_vec(), "GLB_UNEXPECTED_END_OF_HEADER", 4),
        (patched(&file[..12], 8, 0), "GLB_LENGTH_TOO_SMALL", 8),
        (patched(&file, 8, 0), "GLB_LENGTH_TOO_SMALL", 8),
        (patched(&file, 8, 11), "GLB_LENGTH_TOO_SMALL", 8),
        (patched(&file[..12], 8, 12), "GLB_LENGTH_TOO_SMALL", 8),
        (patched(&file, 8, u32::MAX), "GLB_LENGTH_MISMATCH", file.len() as u64),
        (patched(&file, 0, 0x4654_6C68), "GLB_INVALID_MAGIC", 0),
        (patched(&file, 4, 1), "GLB_INVALID_VERSION", 4),
    ] {
        let error = error_of(&bytes);
        assert_eq!((error.code, error.place), (code, FileLocation::Byte(place)));
    }
}

#[test]
fn h31_chunks() {
    let file = a_file();
    let n_json = u32::from_le_bytes(file[12..16].try_into().expect("four bytes"));
    let bin_at = 20 + n_json as usize;
    let mut two_bins = file.clone();
    two_bins.extend_from_slice(&file[bin_at..]);
    let two_bins = patched(&two_bins, 8, two_bins.len() as u32);
    let mut two_jsons = file.clone();
    two_jsons.extend_from_slice(&file[12..bin_at]);
    let two_jsons = patched(&two_jsons, 8, two_jsons.len() as u32);
    for (bytes, code) in [
        (patched(&file, 12, n_json + 1000), "GLB_CHUNK_TOO_BIG"),
        (patched(&file, 12, u32::MAX - 3), "GLB_CHUNK_TOO_BIG"),
        (patched(&file, 12, n_json - 1), "GLB_CHUNK_LENGTH_UNALIGNED"),
        (patched(&file, 16, 0x004E_4942), "GLB_UNEXPECTED_FIRST_CHUNK"),
        (two_bins, "GLB_DUPLICATE_CHUNK"),
        (two_jsons, "GLB_DUPLICATE_CHUNK"),
        (patched(&file[..20], 8, 20), "GLB_CHUNK_TOO_BIG"),
        (file[..file.len() - 8].to_vec(), "GLB_UNEXPECTED_END_OF_CHUNK_DATA"),
        (file[..bin_at + 3].to_vec(), "GLB_UNEXPECTED_END_OF_CHUNK_HEADER"),
    ] {
        assert_eq!(error_of(&bytes).code, code);
    }
    // An unknown chunk in between makes the BIN chunk the third.
    let mut unknown = file[..bin_at].to_vec();
    unknown.extend(b"\x04\0\0\0ABCDwxyz");
    let mut third = unknown.clone();
    third.extend_from_slice(&file[bin_at..]);
    assert_eq!(error_of(&patched(&third, 8, third.len() as u32)).code, "GLB_UNEXPECTED_BIN_CHUNK");
    // At the end it is skipped, and so are bytes after the end.
    let mut odd = file.clone();
    odd.extend(b"\x04\0\0\0ABCDwxyz");
    let mut odd = patched(&odd, 8, odd.len() as u32);
    odd.extend([1, 2, 3]);
    let (scene, warnings) = scene_of(glb::read(&odd, &Limits::default()).expect("read"));
    assert_eq!(scene.parts[0].mesh.faces().len(), 1);
    assert_eq!(warnings, ["GLB_UNKNOWN_CHUNK_TYPE", "GLB_EXTRA_DATA"]);
}

#[test]
fn h32_json_of_great_depth_and_size_and_with_keys_that_come_twice() {
    let deep = format!("{{\"a\":{}1{}}}", "[".repeat(200_000), "]".repeat(200_000));
    let error = error_of(&glb_of(&deep, &[]));
    assert_eq!((error.code, error.place), ("INVALID_JSON", FileLocation::Byte(20 + 5 + 127)));
    assert!(error.message.contains("deeper than the limit of 128"));
    // 300 MB of JSON are refused before they are looked at.
    let large = " ".repeat(300 << 20);
    let error = error_of(&glb_of(&large, &[]));
    assert_eq!((error.code, error.place), ("too-large", FileLocation::Byte(20)));
    drop(large);
    let small = Limits { bytes: 4096, ..Limits::default() };
    assert_eq!(
        glb::read(&glb_of(&" ".repeat(300), &[]), &small).map(|_| ()).expect_err("accepted").code,
        "too-large"
    );
    let twice = r#"{"asset":{"version":"2.0"},"asset":{"version":"2.0"}}"#;
    assert!(error_of(&glb_of(twice, &[])).message.contains("\"asset\" comes twice"));
    let proto = r#"{"asset":{"version":"2.0","extras":{"__proto__":{"polluted":1}}},"__proto__":{}}"#;
    assert!(glb::read(&glb_of(proto, &[]), &Limits::default()).is_ok());
}

#[test]
fn h33_values_of_the_wrong_type() {
    for (at, value, code, pointer) in [
        ("/scene", json!("0"), "TYPE_MISMATCH", "/scene"),
        ("/scene", json!(9), "UNRESOLVED_REFERENCE", "/scene"),
        ("/asset", json!(null), "UNDEFINED_PROPERTY", "/"),
        ("/asset", json!([]), "TYPE_MISMATCH", "/asset"),
        ("/asset/version", json!(2.0), "TYPE_MISMATCH", "/asset/version"),
        ("/asset/version", json!("two"), "PATTERN_MISMATCH", "/asset/version"),
        ("/asset/version", json!("3.0"), "UNKNOWN_ASSET_MAJOR_VERSION", "/asset/version"),
        ("/nodes", json!({}), "TYPE_MISMATCH", "/nodes"),
        ("/nodes", json!([]), "EMPTY_ENTITY", "/nodes"),
        ("/nodes/0", json!(7), "TYPE_MISMATCH", "/nodes/0"),
        ("/nodes/0/mesh", json!(-1), "INVALID_INDEX", "/nodes/0/mesh"),
        ("/nodes/0/mesh", json!(1e30), "UNRESOLVED_REFERENCE", "/nodes/0/mesh"),
        ("/accessors/0/count", json!(2.5), "TYPE_MISMATCH", "/accessors/0/count"),
        ("/meshes/0/primitives", json!({}), "TYPE_MISMATCH", "/meshes/0/primitives"),
    ] {
        let (json, bin) = triangle_with(&[(at, value)]);
        refused(&json, &bin, code, pointer);
    }
    let error = error_of(&glb_of("[1,2]", &[]));
    assert_eq!((error.code, error.place), ("TYPE_MISMATCH", FileLocation::Pointer("/".to_owned())));
}

#[test]
fn h34_counts_past_all_memory() {
    for count in [json!(4_294_967_295_u64), json!(9_007_199_254_740_992_u64), json!(i64::MAX), json!(1e300)] {
        let (json, bin) = triangle_with(&[("/accessors/0/count", count.clone())]);
        refused(&json, &bin, "ACCESSOR_TOO_LONG", "/accessors/0");
        // Without a view the rows are zeros, and only limits can stop them.
        let (mut json, bin) = triangle_with(&[("/accessors/0/count", count)]);
        put(&mut json, "/accessors/0/bufferView", json!(null));
        put(&mut json, "/meshes/0/primitives/0/indices", json!(null));
        refused(&json, &bin, "too-many-rows", "/accessors/0/count");
        // Nobody has to use them.
        put(&mut json, "/meshes/0/primitives/0/attributes", json!({ "_A": 1 }));
        refused(&json, &bin, "too-many-rows", "/accessors/0/count");
    }
    // Within the limit of rows, but not of bytes.
    let (mut json, bin) = triangle_with(&[("/accessors/0/count", json!(100_000_000))]);
    put(&mut json, "/accessors/0/bufferView", json!(null));
    put(&mut json, "/meshes/0/primitives/0/indices", json!(null));
    let limits = Limits { bytes: 1 << 30, ..Limits::default() };
    let error = glb::read(&glb_of(&json.to_string(), &bin), &limits).map(|_| ()).expect_err("accepted");
    assert_eq!(error.code, "too-many-rows");
    // A thousand primitives over the same million zeros are one block of vertices, with other attributes
    // many.
    put(&mut json, "/accessors/0/count", json!(1_000_000));
    put(&mut json, "/accessors/2", json!({ "componentType": 5126, "count": 1_000_000, "type": "SCALAR" }));
    let primitive = |i: usize| json!({ "mode": 5, "attributes": { "POSITION": 0, format!("_{i}"): 2 } });
    put(&mut json, "/meshes/0/primitives", (0..1000).map(primitive).collect());
    let limits = Limits { bytes: 1 << 28, ..Limits::default() };
    let error = glb::read(&glb_of(&json.to_string(), &bin), &limits).map(|_| ()).expect_err("accepted");
    assert_eq!(error.code, "too-large");
}

#[test]
fn h34_accessors_that_read_the_same_bytes_again_and_again() {
    let (mut json, mut bin) = triangle();
    bin.resize(12_000, 0);
    put(&mut json, "/buffers/0/byteLength", json!(12_000));
    put(&mut json, "/bufferViews/2", json!({ "buffer": 0, "byteLength": 12_000 }));
    for i in 2..102 {
        let accessor = json!({ "bufferView": 2, "componentType": 5126, "count": 1000, "type": "VEC3", "min": [0, 0, 0], "max": [1, 2, 0] });
        put(&mut json, &format!("/accessors/{i}"), accessor);
    }
    assert!(read(&json, &bin).is_ok());
    // A hundred times twelve thousand bytes.
    let limits = Limits { bytes: 1_000_000, ..Limits::default() };
    let error = glb::read(&glb_of(&json.to_string(), &bin), &limits).map(|_| ()).expect_err("accepted");
    assert_eq!((error.code, error.place), ("too-large", FileLocation::Pointer("/accessors/85".to_owned())));
}

#[test]
fn h35_offsets_and_strides_that_would_wrap() {
    for (at, value, code, pointer) in [
        ("/bufferViews/0/byteOffset", json!(i64::MAX), "BUFFER_VIEW_TOO_LONG", "/bufferViews/0/byteOffset"),
        ("/bufferViews/0/byteLength", json!(i64::MAX), "BUFFER_VIEW_TOO_LONG", "/bufferViews/0/byteLength"),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), "BUFFER_VIEW_TOO_LONG", "/bufferViews/0/byteOffset"),
        ("/bufferViews/0/byteStride", json!(1_u64 << 62), "VALUE_NOT_IN_RANGE", "/bufferViews/0/byteStride"),
        ("/bufferViews/0/byteStride", json!(14), "VALUE_MULTIPLE_OF", "/bufferViews/0/byteStride"),
        ("/bufferViews/0/byteStride", json!(8), "ACCESSOR_SMALL_BYTESTRIDE", "/accessors/0"),
        ("/accessors/0/byteOffset", json!(i64::MAX - 3), "ACCESSOR_TOO_LONG", "/accessors/0/byteOffset"),
        ("/accessors/0/byteOffset", json!(2), "ACCESSOR_OFFSET_ALIGNMENT", "/accessors/0/byteOffset"),
        ("/accessors/0/byteOffset", json!(-4), "VALUE_NOT_IN_RANGE", "/accessors/0/byteOffset"),
        ("/bufferViews/1/byteOffset", json!(35), "ACCESSOR_TOTAL_OFFSET_ALIGNMENT", "/accessors/1"),
        ("/buffers/0/byteLength", json!(i64::MAX), "BUFFER_BYTE_LENGTH_MISMATCH", "/buffers/0"),
    ] {
        let (json, bin) = triangle_with(&[(at, value)]);
        refused(&json, &bin, code, pointer);
    }
    let (json, bin) = triangle();
    assert!(read(&json, &bin).is_ok());
}
