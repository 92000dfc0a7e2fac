//! HOSTILE.md rows 36 to 47: data, nodes, other files, compression.
use super::build::{
    every_object, glb_of, loaded, put, read, refused, refused_unless_lenient, scene_of, triangle,
    triangle_with,
};
use chordal_io::{Conformance, FileLocation, Limits, glb};
use serde_json::{Value, json};

/// The triangle with a sparse accessor over its positions.
fn sparse(indices: [u16; 2], count: Value) -> (Value, Vec<u8>) {
    let (mut json, mut bin) = triangle();
    indices.iter().for_each(|i| bin.extend(i.to_le_bytes()));
    [0.0_f32, 0.0, 7.0, 0.0, 2.0, 9.0].iter().for_each(|x| bin.extend(x.to_le_bytes()));
    put(&mut json, "/buffers/0/byteLength", json!(72));
    put(&mut json, "/bufferViews/2", json!({ "buffer": 0, "byteOffset": 44, "byteLength": 4 }));
    put(&mut json, "/bufferViews/3", json!({ "buffer": 0, "byteOffset": 48, "byteLength": 24 }));
    let indices = json!({ "bufferView": 2, "componentType": 5123 });
    let sparse = json!({ "count": count, "indices": indices, "values": { "bufferView": 3 } });
    put(&mut json, "/accessors/0/sparse", sparse);
    put(&mut json, "/accessors/0/max", json!([1, 2, 9]));
    (json, bin)
}

#[test]
fn h36_sparse_accessors() {
    let (json, bin) = sparse([0, 2], json!(2));
    let positions = loaded(&json, &bin).0.parts.remove(0).mesh.positions().to_vec();
    assert_eq!(positions, [[0.0, 0.0, 7.0], [1.0, 0.0, 0.0], [0.0, 2.0, 9.0]]);
    let huge = sparse([0, 2], json!(1_u64 << 61));
    refused(&huge.0, &huge.1, "ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE", "/accessors/0/sparse/count");
    let limits = Limits { conformance: Conformance::Lenient, ..Limits::default() };
    for (indices, code) in [
        ([0, 3], "ACCESSOR_SPARSE_INDEX_OOB"),
        ([2, 0], "ACCESSOR_SPARSE_INDICES_NON_INCREASING"),
        ([1, 1], "ACCESSOR_SPARSE_INDICES_NON_INCREASING"),
    ] {
        let (json, bin) = sparse(indices, json!(2));
        refused(&json, &bin, code, "/accessors/0/sparse");
        let error = glb::read(&glb_of(&json.to_string(), &bin), &limits).map(|_| ()).expect_err("accepted");
        let place = FileLocation::Pointer("/meshes/0/primitives/0/attributes/POSITION".to_owned());
        assert_eq!((error.code, error.place), (code, place));
    }
}

#[test]
fn h37_accessors_without_bytes_are_zeros() {
    let (mut json, bin) = triangle();
    put(&mut json, "/accessors/0/bufferView", Value::Null);
    let target = json!([{ "POSITION": 0 }]);
    put(&mut json, "/meshes/0/primitives/0/targets", target);
    let (scene, warnings) = loaded(&json, &bin);
    assert_eq!(scene.parts[0].mesh.positions(), [[0.0; 3]; 3]);
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn h38_indices_out_of_range() {
    let (json, bin) = triangle();
    let pointer = "/meshes/0/primitives/0/indices";
    let lenient = Limits { conformance: Conformance::Lenient, ..Limits::default() };
    for (index, code, what) in [
        (3_u16, "ACCESSOR_INDEX_OOB", "index 2 is 3, there are 3 vertices"),
        (65_534, "ACCESSOR_INDEX_OOB", "index 2 is 65534, there are 3 vertices"),
    ] {
        let mut bin = bin.clone();
        bin[40..42].copy_from_slice(&index.to_le_bytes());
        assert!(refused(&json, &bin, code, pointer).contains(what));
        // It stays an error for the lenient: triangles would be lost.
        let error = glb::read(&glb_of(&json.to_string(), &bin), &lenient).map(|_| ()).expect_err("accepted");
        assert_eq!((error.code, &*error.message), (code, what));
    }
    let mut restart = bin.clone();
    restart[36..42].fill(0xFF);
    let error = read(&json, &restart).map(|_| ()).expect_err("accepted");
    assert_eq!(error.code, "ACCESSOR_INDEX_OOB");
    // With enough vertices the largest index is in range, and means "restart".
    let (mut json, _) = triangle();
    let mut bin = vec![0_u8; 256 * 12];
    bin.extend([0, 1, 255, 0]);
    put(
        &mut json,
        "/accessors/0",
        json!({
            "bufferView": 0, "componentType": 5126, "count": 256, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 0]
        }),
    );
    put(&mut json, "/accessors/1/componentType", json!(5121));
    put(&mut json, "/bufferViews/0/byteLength", json!(3072));
    put(&mut json, "/bufferViews/1", json!({ "buffer": 0, "byteOffset": 3072, "byteLength": 3 }));
    put(&mut json, "/buffers/0/byteLength", json!(3076));
    refused(&json, &bin, "ACCESSOR_INDEX_PRIMITIVE_RESTART", pointer);
}

fn nodes(list: Value) -> (Value, Vec<u8>) {
    let (mut json, bin) = triangle();
    put(&mut json, "/nodes", list);
    put(&mut json, "/scenes", Value::Null);
    put(&mut json, "/scene", Value::Null);
    (json, bin)
}

#[test]
fn h39_nodes_that_are_no_forest() {
    let doubling: Vec<Value> = (0..40_usize)
        .map(|i| {
            // Two nodes a level, each with both of the next: 2²⁰ ways down.
            let next = [(i / 2 + 1) * 2, (i / 2 + 1) * 2 + 1];
            if i < 38 { json!({ "children": next }) } else { json!({ "mesh": 0 }) }
        })
        .collect();
    for (list, code, pointer) in [
        (json!([{ "mesh": 0, "children": [0] }]), "NODE_LOOP", "/nodes/0"),
        (json!([{ "children": [1] }, { "mesh": 0, "children": [0] }]), "NODE_LOOP", "/nodes/0"),
        (
            json!([{ "children": [2] }, { "children": [2] }, { "mesh": 0 }]),
            "NODE_PARENT_OVERRIDE",
            "/nodes/1/children/0",
        ),
        (json!([{ "children": [1, 1] }, { "mesh": 0 }]), "DUPLICATE_ELEMENTS", "/nodes/0/children/1"),
        (Value::Array(doubling), "NODE_PARENT_OVERRIDE", "/nodes/1/children/0"),
    ] {
        let (json, bin) = nodes(list);
        refused(&json, &bin, code, pointer);
        if code != "DUPLICATE_ELEMENTS" {
            let limits = Limits { conformance: Conformance::Lenient, ..Limits::default() };
            let error =
                glb::read(&glb_of(&json.to_string(), &bin), &limits).map(|_| ()).expect_err("accepted");
            assert_eq!(error.code, code);
        }
    }
    let (json, bin) = triangle_with(&[("/nodes", json!([{ "mesh": 0 }, { "children": [0] }]))]);
    refused(&json, &bin, "SCENE_NON_ROOT_NODE", "/scenes/0/nodes/0");
}

#[test]
fn h39_a_deep_chain_loads() {
    let n = 100_000;
    let chain: Vec<Value> = (0..n)
        .map(|i| {
            if i + 1 < n {
                json!({ "translation": [0, 0, 1], "children": [i + 1] })
            } else {
                json!({ "mesh": 0 })
            }
        })
        .collect();
    let (json, bin) = nodes(Value::Array(chain));
    let (scene, warnings) = loaded(&json, &bin);
    assert_eq!((scene.nodes.len(), scene.roots.len(), warnings.len()), (n, 1, 0));
    let placed = scene.world_meshes().expect("placed");
    assert_eq!(placed[0].1.positions()[1], [1.0, 0.0, (n - 1) as f64]);
    let mut bytes = Vec::new();
    glb::write(&scene, None, &mut bytes).expect("written");
}

#[test]
fn h40_a_skin_whose_joint_wears_it() {
    let (mut json, bin) = every_object();
    put(&mut json, "/skins/0/joints", json!([7]));
    put(&mut json, "/skins/0/skeleton", json!(7));
    put(&mut json, "/meshes/0/primitives/0/attributes/JOINTS_0", Value::Null);
    put(&mut json, "/meshes/0/primitives/0/attributes/WEIGHTS_0", Value::Null);
    refused_unless_lenient(&json, &bin, "NODE_SKIN_WITH_NON_SKINNED_MESH", "/nodes/7");
    let (mut json, bin) = every_object();
    put(&mut json, "/skins/0/joints", json!([1, 5, 7]));
    put(&mut json, "/skins/0/skeleton", Value::Null);
    refused_unless_lenient(&json, &bin, "SKIN_NO_COMMON_ROOT", "/skins/0/joints");
}

/// The error of a file whose only buffer is elsewhere.
fn external(uri: &str) -> chordal_io::ReadError {
    let (mut json, bin) = triangle();
    put(&mut json, "/buffers/0/uri", json!(uri));
    read(&json, &bin).map(|_| ()).expect_err(uri)
}

#[test]
fn h41_other_files_are_never_opened() {
    let mut uris: Vec<String> =
        ["../x.bin", "/etc/passwd", "file:///etc/passwd", "%2e%2e/x", "C:\\x.bin", "a\0b", "%ff"]
            .map(str::to_owned)
            .to_vec();
    uris.push("A..B.bin".to_owned());
    // A file that is there, as any other, is not looked at.
    uris.push(file!().to_owned());
    for uri in uris {
        let error = external(&uri);
        assert_eq!(error.code, "external-buffer", "{uri}");
        let place = FileLocation::Pointer("/meshes/0/primitives/0/attributes/POSITION".to_owned());
        assert_eq!(error.place, place);
        assert!(error.message.contains("another file") || error.message.contains("no network"), "{error}");
    }
    // Geometry that lies in the file itself does not need them.
    let (mut json, bin) = triangle();
    put(&mut json, "/buffers/1", json!({ "uri": "../other.bin", "byteLength": 4 }));
    put(&mut json, "/images", json!([{ "uri": "../../../etc/passwd" }]));
    assert_eq!(loaded(&json, &bin).1, ["picture-missing"]);
}

#[test]
fn h42_the_network_is_never_asked() {
    for uri in ["http://localhost:1/x.bin", "https://example.org/x.bin", "ftp://example.org/x"] {
        assert!(external(uri).message.ends_with("no network"), "{uri}");
    }
}

#[test]
fn h43_shell_text_is_a_name() {
    for uri in ["a`touch x`", "$(reboot).bin", "a;b|c", "a\nb"] {
        let error = external(uri);
        assert_eq!(error.code, "external-buffer");
        assert!(error.message.contains("another file"), "{error}");
    }
}

#[test]
fn h44_data_uris() {
    let (mut json, bin) = triangle();
    let base64 = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAAAAABAAIAAAA=";
    put(&mut json, "/buffers/0/byteLength", json!(42));
    for mime in ["application/octet-stream", "application/gltf-buffer"] {
        put(&mut json, "/buffers/0/uri", json!(format!("data:{mime};base64,{base64}")));
        let inside = loaded(&json, &[]).0;
        put(&mut json, "/buffers/0/uri", Value::Null);
        assert_eq!(inside, loaded(&json, &bin).0);
    }
    for (uri, code) in [
        (format!("data:text/plain;base64,{base64}"), "BUFFER_DATA_URI_MIME_TYPE_INVALID"),
        ("data:application/octet-stream;base64,AAAAA".to_owned(), "INVALID_URI"),
        ("data:application/octet-stream;base64,AA A=".to_owned(), "INVALID_URI"),
        (format!("data:application/octet-stream;base64,{}\n{}", &base64[..8], &base64[8..]), "INVALID_URI"),
        ("data:application/octet-stream;base64,!!!!".to_owned(), "INVALID_URI"),
        ("data:application/octet-stream".to_owned(), "INVALID_URI"),
    ] {
        put(&mut json, "/buffers/0/uri", json!(uri));
        refused(&json, &bin, code, "/buffers/0/uri");
    }
    put(&mut json, "/buffers/0/uri", json!("data:application/octet-stream;base64,AAAA"));
    refused(&json, &bin, "BUFFER_BYTE_LENGTH_MISMATCH", "/buffers/0");
    // What a data URI decodes to is smaller than the JSON, which has a limit of its own.
    let limits = Limits { bytes: 16 << 20, ..Limits::default() };
    put(
        &mut json,
        "/buffers/0/uri",
        json!(format!("data:application/octet-stream;base64,{}", "A".repeat(2 << 20))),
    );
    let error = glb::read(&glb_of(&json.to_string(), &[]), &limits).map(|_| ()).expect_err("accepted");
    assert_eq!(error.code, "too-large");
}

#[test]
fn h45_extensions_that_are_required_and_not_known() {
    for name in ["KHR_node_hoverability_of_cubes", "ACME_cubes"] {
        let names = json!([name]);
        let (json, bin) =
            triangle_with(&[("/extensionsUsed", names.clone()), ("/extensionsRequired", names)]);
        let message = refused(&json, &bin, "unsupported-extension", "/extensionsRequired/0");
        assert!(message.contains(name));
        let limits = Limits { conformance: Conformance::Lenient, ..Limits::default() };
        assert!(glb::read(&glb_of(&json.to_string(), &bin), &limits).is_err());
    }
    let names = json!(["KHR_texture_transform", "KHR_materials_unlit"]);
    let (json, bin) = triangle_with(&[("/extensionsUsed", names.clone()), ("/extensionsRequired", names)]);
    assert!(read(&json, &bin).is_ok());
}

#[test]
fn h46_copies_beside_compressed_data_are_checked_like_others() {
    let draco = json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": { "POSITION": 0 } } });
    let (mut json, mut bin) = triangle_with(&[("/extensionsUsed", json!(["KHR_draco_mesh_compression"]))]);
    put(&mut json, "/meshes/0/primitives/0/extensions", draco);
    let (_, warnings) = loaded(&json, &bin);
    assert_eq!(warnings, ["draco-copy-ignored"]);
    bin[40] = 9;
    refused(&json, &bin, "ACCESSOR_INDEX_OOB", "/meshes/0/primitives/0/indices");
    // Without a copy the stream is needed, whether the extension is required or not: here it is none.
    put(&mut json, "/accessors/0/bufferView", Value::Null);
    put(&mut json, "/meshes/0/primitives/0/indices", Value::Null);
    let pointer = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
    assert!(refused(&json, &bin, "draco-stream", pointer).contains("cannot be decoded"));
    // A view that is compressed has no copy: what it unpacks to is read, here not a stream at all.
    let meshopt = json!({ "EXT_meshopt_compression": {
        "buffer": 0, "byteLength": 40, "byteStride": 12, "count": 3, "mode": "ATTRIBUTES"
    } });
    let (mut json, bin) = triangle_with(&[("/extensionsUsed", json!(["EXT_meshopt_compression"]))]);
    put(&mut json, "/bufferViews/0/extensions", meshopt);
    let pointer = "/bufferViews/0/extensions/EXT_meshopt_compression";
    assert!(refused(&json, &bin, "meshopt-stream", pointer).contains("0xa0"));
}

#[test]
fn h47_numbers_that_are_wrong() {
    let (json, bin) = triangle();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut bin = bin.clone();
        bin[12..16].copy_from_slice(&bad.to_le_bytes());
        refused(&json, &bin, "ACCESSOR_INVALID_FLOAT", "/accessors/0");
        // Lenient or not, a mesh has no such vertices, unless they are to be dropped.
        let bytes = glb_of(&json.to_string(), &bin);
        let lenient = Limits { conformance: Conformance::Lenient, ..Limits::default() };
        assert!(glb::read(&bytes, &lenient).is_err());
        let dropping = Limits { drop_nonfinite: true, ..Limits::default() };
        let (scene, warnings) = scene_of(glb::read(&bytes, &dropping).expect("dropped"));
        let mesh = &scene.parts[0].mesh;
        assert_eq!((mesh.positions().len(), mesh.faces().len()), (2, 0));
        assert_eq!(warnings, ["ACCESSOR_INVALID_FLOAT", "not-finite"]);
    }
    for (key, code) in [("min", "ACCESSOR_MIN_MISMATCH"), ("max", "ACCESSOR_MAX_MISMATCH")] {
        let (json, bin) = triangle_with(&[(&format!("/accessors/0/{key}"), json!([0, 0.5, 0]))]);
        let first = if key == "min" { 1 } else { 0 };
        refused_unless_lenient(&json, &bin, code, &format!("/accessors/0/{key}/{first}"));
    }
    let (json, mut bin) = every_object();
    // The second view holds four unit normals; the third, tangents.
    bin[48..60].fill(0);
    refused_unless_lenient(
        &json,
        &bin,
        "ACCESSOR_VECTOR3_NON_UNIT",
        "/meshes/0/primitives/0/attributes/NORMAL",
    );
    let (json, mut bin) = every_object();
    bin[96..112].fill(0);
    refused_unless_lenient(
        &json,
        &bin,
        "ACCESSOR_VECTOR3_NON_UNIT",
        "/meshes/0/primitives/0/attributes/TANGENT",
    );
}
