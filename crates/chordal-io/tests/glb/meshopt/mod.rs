//! Views that are compressed by `EXT_meshopt_compression` and `KHR_meshopt_compression`.
mod encode;
mod files;
mod filters;
mod hostile;
mod streams;
mod written;

use super::build::{base64, glb_of};
use chordal::explicit::Semantic;
use chordal_io::{Content, Limits, ReadError, glb};
use serde_json::{Value, json};

/// A stream, and what a file says of it.
#[derive(Clone, Debug)]
pub struct PackedRows {
    pub mode: String,
    pub filter: String,
    pub stride: usize,
    pub count: usize,
    pub stream: Vec<u8>,
}

impl PackedRows {
    fn new(mode: &str, stride: usize, count: usize, stream: Vec<u8>) -> Self {
        Self { mode: mode.to_owned(), filter: "NONE".to_owned(), stride, count, stream }
    }

    fn extension(&self) -> Value {
        json!({
            "buffer": 0, "byteLength": self.stream.len(), "byteStride": self.stride, "count": self.count,
            "mode": self.mode, "filter": self.filter,
        })
    }

    /// A file whose points at the origin carry the rows, four bytes each, as an attribute `_B`.
    fn document(&self, name: &str) -> Value {
        let n = self.stride * self.count;
        assert_eq!(n % 4, 0, "rows of four bytes");
        json!({
            "asset": { "version": "2.0" }, "extensionsUsed": [name], "extensionsRequired": [name],
            "buffers": [
                { "byteLength": self.stream.len().max(1) },
                { "byteLength": n.max(1), "extensions": { name: { "fallback": true } } },
            ],
            "bufferViews": [
                { "buffer": 1, "byteLength": n.max(1), "extensions": { name: self.extension() } },
            ],
            "accessors": [
                { "componentType": 5126, "type": "VEC3", "count": (n / 4).max(1), "min": [0, 0, 0], "max": [0, 0, 0] },
                { "bufferView": 0, "componentType": 5121, "type": "VEC4", "count": (n / 4).max(1) },
            ],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "_B": 1 } }] }],
            "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }],
        })
    }

    fn file(&self, name: &str) -> Vec<u8> {
        glb_of(&self.document(name).to_string(), &self.stream)
    }

    /// What the reader unpacks.
    fn unpacked(&self) -> Result<Vec<u8>, ReadError> {
        attribute(&self.file("KHR_meshopt_compression"), &Limits::default())
    }
}

/// The bytes of the attribute `_B` of a file's first part.
fn attribute(file: &[u8], limits: &Limits) -> Result<Vec<u8>, ReadError> {
    let loaded = glb::read(file, limits)?;
    let Content::Scene(scene) = loaded.content else { panic!("no scene") };
    let rows = scene.parts[0].mesh.attribute(&Semantic::Custom("_B".to_owned())).expect("_B");
    Ok(rows.values.iter().map(|x| *x as u8).collect())
}

/// A row of `tests/data/meshopt_streams.json`: a stream and what it decodes to.
/// `tests/web/meshopt_fixtures.mjs` made them with meshoptimizer's encoder, and `tests/web/meshopt.mjs`
/// compares them with three.js.
struct KnownStream {
    name: String,
    packed: PackedRows,
    decoded: Vec<u8>,
}

fn known_streams() -> Vec<KnownStream> {
    let rows: Vec<Value> =
        serde_json::from_str(include_str!("../../data/meshopt_streams.json")).expect("JSON");
    let text = |row: &Value, key: &str| row[key].as_str().expect("a text").to_owned();
    let size = |row: &Value, key: &str| row[key].as_u64().expect("a number") as usize;
    rows.iter()
        .map(|row| {
            let stream = base64(&text(row, "stream"));
            let (stride, count) = (size(row, "stride"), size(row, "count"));
            let packed =
                PackedRows { mode: text(row, "mode"), filter: text(row, "filter"), stride, count, stream };
            KnownStream { name: text(row, "name"), packed, decoded: base64(&text(row, "decoded")) }
        })
        .collect()
}
