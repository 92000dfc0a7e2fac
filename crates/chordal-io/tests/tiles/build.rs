//! Tilesets made by hand, and folders in memory.
use chordal_io::tiles::{self, Tile, Tileset};
use chordal_io::{FileLocation, Limits, ReadError, Warning};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A cube about zero.
pub fn cube(half: f64) -> [f64; 12] {
    [0.0, 0.0, 0.0, half, 0.0, 0.0, 0.0, half, 0.0, 0.0, 0.0, half]
}

/// Levels of one tile each, with such errors, coarsest first.
pub fn chain(errors: &[f64]) -> Tile {
    let mut levels = errors.iter().enumerate().rev();
    let tile = |(i, error): (usize, &f64)| Tile {
        geometric_error: *error,
        ..Tile::leaf(cube(1.0), &format!("{i}.glb"))
    };
    let finest = tile(levels.next().expect("a level"));
    levels.fold(finest, |child, level| Tile { children: vec![child], ..tile(level) })
}

/// The same as a tileset.
pub fn tileset(errors: &[f64]) -> Tileset {
    Tileset { geometric_error: 4.0, root: chain(errors), extras: None }
}

/// A tile as JSON.
pub fn tile_json(error: f64) -> Value {
    json!({ "boundingVolume": { "box": cube(1.0) }, "geometricError": error })
}

/// A tileset as JSON around a root.
pub fn tileset_json(root: Value) -> Value {
    let mut root = root;
    if root.get("refine").is_none() {
        root["refine"] = json!("REPLACE");
    }
    json!({ "asset": { "version": "1.1" }, "geometricError": 16.0, "root": root })
}

/// Files by their paths.
pub type Folder = BTreeMap<String, Vec<u8>>;

/// Reads a tileset in a folder.
pub fn read_in(folder: &Folder, bytes: &[u8]) -> Result<(Tileset, Vec<Warning>), ReadError> {
    let mut open = |path: &str| folder.get(path).cloned().ok_or_else(|| "no such file".to_owned());
    tiles::read(bytes, &mut open, &Limits::default())
}

/// Reads a tileset alone.
pub fn read(json: &Value) -> Result<(Tileset, Vec<Warning>), ReadError> {
    read_in(&Folder::new(), json.to_string().as_bytes())
}

/// The code and place of what must be refused.
#[track_caller]
pub fn refused<T: std::fmt::Debug>(outcome: Result<T, ReadError>) -> (&'static str, String) {
    let error = outcome.expect_err("refused");
    let text = error.to_string();
    for word in ["unwrap", "index out of bounds", "panicked"] {
        assert!(!text.contains(word), "{text}");
    }
    let place = match error.place {
        FileLocation::Pointer(pointer) => pointer,
        other => other.to_string(),
    };
    (error.code, place)
}
