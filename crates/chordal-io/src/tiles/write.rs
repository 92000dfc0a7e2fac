//! The tileset writer.
use super::{BoundingVolume, Refine, Tile, Tileset};
use crate::files;
use serde_json::{Map, Value, json};
use std::fmt;

/// The most levels of children that are written. Chosen: a tree of so many halvings resolves the width of an
/// atom on Earth. Readers that stop at 128 levels of JSON, as ours does, still have 27 for the content of the
/// deepest tile.
const MOST_LEVELS: usize = 50;

/// How far a child's box may stick out of its parent's, relative to their positions and sizes. Each half axis
/// and centre was rounded once or twice, and so were the values that are computed from them here. Derived:
/// eight roundings of half a step.
const SLACK: f64 = 4.0 * f64::EPSILON;

/// Why a tileset cannot be written: the tile and its fault.
#[derive(Clone, Debug, PartialEq)]
pub struct InvalidTileset {
    /// A JSON pointer to the tile in the output; empty for the tileset as a whole.
    pub tile: String,
    /// The fault.
    pub fault: TileFault,
}

/// A fault of a tile.
#[derive(Clone, Debug, PartialEq)]
pub enum TileFault {
    /// A geometric error is negative, infinite or NaN.
    BadError(f64),
    /// The geometric error of a tile without children is not 0; a remaining error belongs into the extras.
    LeafError(f64),
    /// The geometric error is not below the parent's.
    NotDecreasing {
        /// The tile's.
        error: f64,
        /// The parent's.
        parent: f64,
    },
    /// The geometric error of the tileset is 0 or below the root's: a viewer would show nothing, or not
    /// begin.
    BadTilesetError {
        /// The tileset's.
        error: f64,
        /// The root's.
        root: f64,
    },
    /// The volume is not an axis-aligned box of finite numbers with non-negative half axes.
    NoBox,
    /// The box sticks out of the parent's.
    BoxOutside,
    /// The URI is not a plain relative path of a file below the tileset: letters, digits, `-`, `.`, `_`, `~`
    /// and `/`.
    BadUri(String),
    /// The tree is deeper than 50 levels.
    TooDeep,
    /// It has data that can only be read: a transform other than a rigid one of the root, or an implicit
    /// tiling.
    OnlyRead(&'static str),
}

impl fmt::Display for TileFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadError(error) => write!(f, "an error of {error} m is not finite or negative"),
            Self::LeafError(error) => write!(f, "a tile without children has an error of {error} m, not 0"),
            Self::NotDecreasing { error, parent } => {
                write!(f, "the error of {error} m is not below that of the parent, {parent} m")
            }
            Self::BadTilesetError { error, root } => {
                write!(f, "the tileset's error of {error} m is 0 or below that of its root, {root} m")
            }
            Self::NoBox => f.write_str("the volume is no box of finite numbers along the axes"),
            Self::BoxOutside => f.write_str("the box sticks out of that of the parent"),
            Self::BadUri(uri) => write!(f, "'{uri}' is no plain relative path of a file"),
            Self::TooDeep => write!(f, "the tree is deeper than {MOST_LEVELS} levels"),
            Self::OnlyRead(what) => write!(f, "{what} can be read and not written"),
        }
    }
}

impl fmt::Display for InvalidTileset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.tile.is_empty() { self.fault.fmt(f) } else { write!(f, "{}: {}", self.tile, self.fault) }
    }
}

impl std::error::Error for InvalidTileset {}

/// Writes the `tileset.json` of a tileset, version 1.1. The same tileset gives the same bytes.
///
/// The tileset must comply. Geometric errors are finite, 0 for tiles without children, and below the parent's
/// for all others; the tileset's is above 0 and not below the root's. Volumes are axis-aligned boxes, and a
/// child's is inside its parent's except for rounding; the root may be translated as a whole. File names are
/// plain relative paths. So a viewer that shows a tile if its error is at most so many pixels always finds
/// one, and every path down the tree gets finer at each step.
///
/// Linear in the number of tiles.
///
/// # Errors
/// [`InvalidTileset`] with the first tile that does not comply.
///
/// ```
/// use chordal::math::Box3;
/// use chordal_io::tiles::{Tile, Tileset, aligned_box, write};
/// let volume = aligned_box(&Box3 { min: [-1.0; 3], max: [1.0; 3] });
/// let fine = Tile::leaf(volume, "1.glb");
/// let root = Tile { geometric_error: 0.25, children: vec![fine], ..Tile::leaf(volume, "0.glb") };
/// let mut tileset = Tileset { geometric_error: 4.0, root, extras: None };
/// let text = String::from_utf8(write(&tileset)?)?;
/// assert!(text.starts_with(r#"{"asset":{"version":"1.1","generator":"Chordal"#));
///
/// tileset.root.children[0].geometric_error = 0.25;
/// assert_eq!(write(&tileset).unwrap_err().tile, "/root/children/0");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source: Open Geospatial Consortium, 3D Tiles Specification 1.1 (22-025r4), 2023.
pub fn write(tileset: &Tileset) -> Result<Vec<u8>, InvalidTileset> {
    let tileset_fault = |fault| InvalidTileset { tile: String::new(), fault };
    let (error, root) = (tileset.geometric_error, tileset.root.geometric_error);
    if !(error.is_finite() && error >= 0.0) {
        return Err(tileset_fault(TileFault::BadError(error)));
    }
    let root_tile = TilesetWriter { at: "/root".to_owned() }.tile(&tileset.root, None, 0)?;
    if !(error > 0.0 && error >= root) {
        return Err(tileset_fault(TileFault::BadTilesetError { error, root }));
    }
    let mut json = Map::new();
    let generator = concat!("Chordal ", env!("CARGO_PKG_VERSION"));
    json.insert("asset".to_owned(), json!({ "version": "1.1", "generator": generator }));
    json.insert("geometricError".to_owned(), json!(error));
    json.insert("root".to_owned(), root_tile);
    if let Some(extras) = &tileset.extras {
        json.insert("extras".to_owned(), extras.clone());
    }
    Ok(Value::Object(json).to_string().into_bytes())
}

/// The current position in the tree, as a JSON pointer.
struct TilesetWriter {
    at: String,
}

impl TilesetWriter {
    fn tile(&mut self, tile: &Tile, parent: Option<&Tile>, depth: usize) -> Result<Value, InvalidTileset> {
        let volume =
            check(tile, parent, depth).map_err(|fault| InvalidTileset { tile: self.at.clone(), fault })?;
        let mut json = Map::new();
        if let Some(matrix) = tile.transform.as_deref() {
            json.insert("transform".to_owned(), json!(matrix.map(|x| x + 0.0)));
        }
        // Adding zero removes the sign of −0, which JSON would show.
        json.insert("boundingVolume".to_owned(), json!({ "box": volume.map(|x| x + 0.0) }));
        json.insert("geometricError".to_owned(), json!(tile.geometric_error + 0.0));
        if parent.is_none_or(|parent| parent.refine != tile.refine) {
            let refine = if tile.refine == Refine::Replace { "REPLACE" } else { "ADD" };
            json.insert("refine".to_owned(), json!(refine));
        }
        match &tile.contents[..] {
            [] => {}
            [uri] => {
                json.insert("content".to_owned(), json!({ "uri": uri }));
            }
            many => {
                let many: Vec<Value> = many.iter().map(|uri| json!({ "uri": uri })).collect();
                json.insert("contents".to_owned(), json!(many));
            }
        }
        let mut children = Vec::with_capacity(tile.children.len());
        for (i, child) in tile.children.iter().enumerate() {
            let length = self.at.len();
            self.at.push_str(&format!("/children/{i}"));
            children.push(self.tile(child, Some(tile), depth + 1)?);
            self.at.truncate(length);
        }
        if !children.is_empty() {
            json.insert("children".to_owned(), Value::Array(children));
        }
        if let Some(extras) = &tile.extras {
            json.insert("extras".to_owned(), extras.clone());
        }
        Ok(Value::Object(json))
    }
}

/// Checks that a tile complies, and returns its box.
fn check(tile: &Tile, parent: Option<&Tile>, depth: usize) -> Result<[f64; 12], TileFault> {
    let error = tile.geometric_error;
    if depth > MOST_LEVELS {
        return Err(TileFault::TooDeep);
    }
    if !(error.is_finite() && error >= 0.0) {
        return Err(TileFault::BadError(error));
    }
    if let Some(parent) = parent.filter(|parent| error >= parent.geometric_error) {
        return Err(TileFault::NotDecreasing { error, parent: parent.geometric_error });
    }
    if tile.children.is_empty() && error != 0.0 {
        return Err(TileFault::LeafError(error));
    }
    let bends = tile.transform.as_deref().is_some_and(|matrix| parent.is_some() || !is_rigid(matrix));
    for (is_there, what) in [
        (bends, "a transform other than a rigid one of the root"),
        (tile.implicit.is_some(), "implicit tiling"),
    ] {
        if is_there {
            return Err(TileFault::OnlyRead(what));
        }
    }
    let volume = aligned(tile).ok_or(TileFault::NoBox)?;
    if parent.and_then(aligned).is_some_and(|outer| !is_inside(&volume, &outer)) {
        return Err(TileFault::BoxOutside);
    }
    let plain = |c: char| c.is_ascii_alphanumeric() || "-._~/".contains(c);
    match tile.contents.iter().find(|uri| !uri.chars().all(plain) || files::resolve("", uri).is_err()) {
        Some(uri) => Err(TileFault::BadUri(uri.clone())),
        None => Ok(volume),
    }
}

/// Whether a column-major matrix only translates and rotates, up to rounding: then errors and boxes keep
/// their size.
fn is_rigid(matrix: &[f64; 16]) -> bool {
    // A few roundings of a rotation's entries.
    const ROUNDING: f64 = 1e-14;
    let at = |column: usize, row: usize| matrix[4 * column + row % 3];
    let is_near = |x: f64, expected: f64| (x - expected).abs() <= ROUNDING;
    let product = |i: usize, j: usize| (0..3).map(|k| at(i, k) * at(j, k)).sum::<f64>();
    let is_square = (0..3).all(|i| (0..3).all(|j| is_near(product(i, j), f64::from(u8::from(i == j)))));
    // The third axis is the cross product of the others, so nothing is mirrored.
    let normal = |k: usize| at(0, k + 1) * at(1, k + 2) - at(0, k + 2) * at(1, k + 1);
    let is_rotation = is_square && (0..3).all(|k| is_near(normal(k), at(2, k)));
    let last_row = [matrix[3], matrix[7], matrix[11], matrix[15]];
    is_rotation && last_row == [0.0, 0.0, 0.0, 1.0] && matrix[12..15].iter().all(|x| x.is_finite())
}

/// The box of a tile, if it is axis-aligned.
fn aligned(tile: &Tile) -> Option<[f64; 12]> {
    let BoundingVolume::Box(volume) = tile.volume else { return None };
    let is_diagonal = (0..9).all(|i| if i % 4 == 0 { volume[3 + i] >= 0.0 } else { volume[3 + i] == 0.0 });
    (is_diagonal && volume.iter().all(|x| x.is_finite())).then_some(volume)
}

fn is_inside(inner: &[f64; 12], outer: &[f64; 12]) -> bool {
    (0..3).all(|k| {
        let (a, b) = (inner[k], outer[k]);
        let (half, room) = (inner[3 + 4 * k], outer[3 + 4 * k]);
        (a - b).abs() + half <= room + SLACK * (a.abs() + b.abs() + half + room)
    })
}
