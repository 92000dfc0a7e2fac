//! Any bytes as the stream of a primitive that is compressed by Draco: triangles or a typed error, no panic.
#![no_main]
use chordal_io::{Format, Limits, read};
use libfuzzer_sys::fuzz_target;

/// A primitive with all attributes in the stream.
const DOCUMENT: &str = r#"{"asset":{"version":"2.0"},"extensionsUsed":["KHR_draco_mesh_compression"],
"accessors":[{"componentType":5126,"type":"VEC3","count":3,"min":[0,0,0],"max":[1,1,1]},
{"componentType":5126,"type":"VEC3","count":3},{"componentType":5126,"type":"VEC2","count":3},
{"componentType":5121,"type":"VEC4","count":3,"normalized":true},{"componentType":5125,"type":"SCALAR","count":3}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3},"indices":4,
"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,
"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3}}}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"#;

fuzz_target!(|bytes: &[u8]| {
    let n = bytes.len();
    let mut json = format!(r#"{DOCUMENT}"buffers":[{{"byteLength":{n}}}],"bufferViews":[{{"buffer":0,"byteLength":{n}}}]}}"#);
    json.extend(std::iter::repeat_n(' ', json.len().next_multiple_of(4) - json.len()));
    let mut bin = bytes.to_vec();
    bin.resize(n.next_multiple_of(4), 0);
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((28 + json.len() as u32 + bin.len() as u32).to_le_bytes());
    for (kind, data) in [(b"JSON", json.as_bytes()), (b"BIN\0", &bin)] {
        file.extend((data.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(data);
    }
    let _ = read(&file, Format::Glb, &Limits { bytes: 1 << 28, ..Limits::default() });
});
