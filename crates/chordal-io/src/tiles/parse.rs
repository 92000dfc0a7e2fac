//! Parses the JSON of one tileset into its tree, without opening other files.
use super::content::refuse_gzip;
use super::{BoundingVolume, Refine, Subdivision, Tile, Tileset};
use crate::grow::push_large;
use crate::json::JsonReader;
use crate::warnings::Warnings;
use crate::{Limits, ReadError};
use serde_json::Value;

/// The implicit tiling of a tile, as written in the file.
pub(super) struct ImplicitTilingJson {
    pub subdivision: Subdivision,
    pub subtree_levels: u32,
    pub available_levels: u32,
    pub template: String,
}

/// The fields of a tile that depend on its parent or its file.
#[derive(Default)]
pub(super) struct UnresolvedTile {
    pub rule: Option<ImplicitTilingJson>,
    /// `None` inherits the parent's value, which may be written after its children.
    pub refine: Option<Refine>,
}

/// A tileset with its URIs as written, and the unresolved fields of its tiles, in the order of
/// [`Tileset::tiles`].
pub(super) struct RawTileset {
    pub tileset: Tileset,
    pub pending: Vec<UnresolvedTile>,
}

/// The memory for extras in addition to a share of the file. Chosen: a small text may become a hundred times
/// its size.
const EXTRAS_BYTES: u64 = 16 << 20;

/// The most memory that a value of extras takes. Derived: itself and its key, in a list with as much spare
/// capacity.
const VALUE_BYTES: u64 = 256;

struct TilesetParser<'p> {
    warnings: &'p mut Warnings,
    limits: &'p Limits,
    pending: Vec<UnresolvedTile>,
    extras_left: u64,
}

type TileParseResult<T> = Result<T, ReadError>;

/// Parses a tileset.
///
/// # Errors
/// With the byte or the pointer, if it is not JSON or not a tileset.
pub(super) fn parse(bytes: &[u8], limits: &Limits, warnings: &mut Warnings) -> TileParseResult<RawTileset> {
    refuse_gzip(bytes)?;
    let extras_left = EXTRAS_BYTES + 8 * bytes.len() as u64;
    let mut parser = TilesetParser { warnings, limits, pending: Vec::new(), extras_left };
    let mut json = JsonReader::new(bytes, limits)?;
    let (mut version, mut error, mut root, mut extras) = (None, None, None, None);
    json.object(|json, key| {
        match key {
            "asset" => json.object(|json, key| match key {
                "version" => {
                    version = Some(version_of(json)?);
                    Ok(())
                }
                _ => json.skip(),
            })?,
            "geometricError" => error = Some(error_of(json)?),
            "root" => root = Some(parser.tile(json)?),
            "extras" => extras = parser.extras(json)?,
            "extensionsRequired" => refuse_extensions(json)?,
            "extensionsUsed" => json.skip()?,
            _ => parser.ignore(json)?,
        }
        Ok(())
    })?;
    let missing =
        |json: &JsonReader<'_>, what: &str| json.error("missing", format!("the tileset has no {what}"));
    if version.is_none() {
        return Err(missing(&json, "asset.version"));
    }
    let geometric_error = error.ok_or_else(|| missing(&json, "geometricError"))?;
    let root = root.ok_or_else(|| missing(&json, "root"))?;
    json.end()?;
    Ok(RawTileset { tileset: Tileset { geometric_error, root, extras }, pending: parser.pending })
}

fn version_of(json: &mut JsonReader<'_>) -> TileParseResult<()> {
    let version = json.string()?;
    if matches!(version.as_str(), "1.0" | "1.1") {
        return Ok(());
    }
    Err(json.error("unsupported", format!("3D Tiles {version:?} is not read, only 1.0 and 1.1")))
}

fn error_of(json: &mut JsonReader<'_>) -> TileParseResult<f64> {
    let error = json.number()?;
    if error >= 0.0 {
        return Ok(error);
    }
    Err(json.error("out-of-range", format!("an error of {error} m is negative")))
}

fn refuse_extensions(json: &mut JsonReader<'_>) -> TileParseResult<()> {
    json.array(|json, _| {
        let name = json.string()?;
        // It only declares that contents may be glTF, which 1.1 always allows.
        if name == "3DTILES_content_gltf" {
            return Ok(());
        }
        Err(json.error("unsupported", format!("extension {name} is required and not read")))
    })?;
    Ok(())
}

/// Reads exactly `N` numbers.
fn numbers<const N: usize>(json: &mut JsonReader<'_>) -> TileParseResult<[f64; N]> {
    let mut values = [0.0; N];
    let n = json.array(|json, i| {
        let value = json.number()?;
        if let Some(slot) = usize::try_from(i).ok().and_then(|i| values.get_mut(i)) {
            *slot = value;
        }
        Ok(())
    })?;
    if n != N as u64 {
        return Err(json.error("wrong-length", format!("{n} numbers where {N} should stand")));
    }
    Ok(values)
}

fn volume(json: &mut JsonReader<'_>) -> TileParseResult<BoundingVolume> {
    let mut volume = None;
    json.object(|json, key| {
        match key {
            // A box wins over the others, in whatever order they are.
            "box" => volume = Some(BoundingVolume::Box(numbers(json)?)),
            "region" => volume = volume.or(Some(BoundingVolume::Region(numbers(json)?))),
            "sphere" => {
                let sphere: [f64; 4] = numbers(json)?;
                if sphere[3] < 0.0 {
                    return Err(json.error("out-of-range", format!("a radius of {} is negative", sphere[3])));
                }
                volume = volume.or(Some(BoundingVolume::Sphere(sphere)));
            }
            _ => json.skip()?,
        }
        Ok(())
    })?;
    volume.ok_or_else(|| json.error("unsupported", "the volume is neither a box, a region nor a sphere"))
}

impl TilesetParser<'_> {
    /// Skips and counts an unused property.
    fn ignore(&mut self, json: &mut JsonReader<'_>) -> TileParseResult<()> {
        let place = json.place();
        self.warnings.count("tiles-metadata-ignored", || {
            (place, "metadata, extensions and other properties of tiles were not kept".to_owned())
        });
        json.skip()
    }

    fn extras(&mut self, json: &mut JsonReader<'_>) -> TileParseResult<Option<Value>> {
        let place = json.place();
        let text = json.raw()?;
        // Each value but the first follows one of these; those inside strings only make the count larger.
        let n_values = 1 + text.iter().filter(|b| matches!(b, b',' | b'[' | b'{')).count() as u64;
        let taken = text.len() as u64 + n_values * VALUE_BYTES;
        let parsed = match self.extras_left.checked_sub(taken) {
            Some(left) => {
                self.extras_left = left;
                serde_json::from_slice(text).ok()
            }
            None => None,
        };
        if parsed.is_none() {
            self.warnings.count("extras-dropped", || {
                (place, "extras were not kept: they take too much memory, or nest too deep".to_owned())
            });
        }
        Ok(parsed)
    }

    fn tile(&mut self, json: &mut JsonReader<'_>) -> TileParseResult<Tile> {
        let at = self.pending.len();
        if at as u64 >= self.limits.rows {
            return Err(
                json.error("too-many-rows", format!("more tiles than the limit of {}", self.limits.rows))
            );
        }
        // Before the children are read, so that the list is in the order in which `read.rs` walks
        // the tree.
        push_large(&mut self.pending, UnresolvedTile::default())?;
        let (mut bounds, mut error) = (None, None);
        let (mut transform, mut extras, mut contents) = (None, None, Vec::new());
        let mut children: Vec<Tile> = Vec::new();
        let mut named = None;
        json.object(|json, key| {
            match key {
                "boundingVolume" => bounds = Some(volume(json)?),
                "geometricError" => error = Some(error_of(json)?),
                "refine" => self.pending[at].refine = Some(refine_of(json)?),
                "transform" => transform = Some(Box::new(affine(json)?)),
                "content" | "contents" if named.as_ref().is_some_and(|n: &String| n != key) => {
                    return Err(json.error("duplicate-key", "a tile has either content or contents"));
                }
                "content" => {
                    named = Some(key.to_owned());
                    contents.push(self.content(json)?);
                }
                "contents" => {
                    named = Some(key.to_owned());
                    json.array(|json, _| {
                        contents.push(self.content(json)?);
                        Ok(())
                    })?;
                }
                "children" => {
                    json.array(|json, _| {
                        let child = self.tile(json)?;
                        push_large(&mut children, child)
                    })?;
                    // Most lists are short, and there can be many of them.
                    children.shrink_to_fit();
                }
                "implicitTiling" => self.pending[at].rule = Some(rule(json)?),
                "extras" => extras = self.extras(json)?,
                _ => self.ignore(json)?,
            }
            Ok(())
        })?;
        contents.shrink_to_fit();
        let missing = |what: &str| json.error("missing", format!("the tile has no {what}"));
        Ok(Tile {
            volume: bounds.ok_or_else(|| missing("boundingVolume"))?,
            geometric_error: error.ok_or_else(|| missing("geometricError"))?,
            refine: Refine::Replace,
            transform,
            contents,
            children,
            implicit: None,
            extras,
        })
    }

    fn content(&mut self, json: &mut JsonReader<'_>) -> TileParseResult<String> {
        let mut uri = None;
        json.object(|json, key| {
            match key {
                // Version 0.0 had `url`, and some files that declare 1.0 still do.
                "uri" | "url" => uri = Some(json.string()?),
                // A tighter volume of the content, which the tile's own volume replaces.
                "boundingVolume" => json.skip()?,
                _ => self.ignore(json)?,
            }
            Ok(())
        })?;
        uri.ok_or_else(|| json.error("missing", "the content has no uri"))
    }
}

fn refine_of(json: &mut JsonReader<'_>) -> TileParseResult<Refine> {
    let text = json.string()?;
    match text.as_str() {
        "REPLACE" => Ok(Refine::Replace),
        "ADD" => Ok(Refine::Add),
        _ => Err(json.error("bad-value", format!("refine {text:?} is neither \"REPLACE\" nor \"ADD\""))),
    }
}

fn affine(json: &mut JsonReader<'_>) -> TileParseResult<[f64; 16]> {
    let matrix: [f64; 16] = numbers(json)?;
    if [matrix[3], matrix[7], matrix[11], matrix[15]] != [0.0, 0.0, 0.0, 1.0] {
        return Err(json.error("bad-value", "the transform is not affine: its last row is not 0 0 0 1"));
    }
    Ok(matrix)
}

/// Reads a number of levels. It fits into 32 bits; tiles more than 62 halvings deep cannot be numbered.
fn levels(json: &mut JsonReader<'_>) -> TileParseResult<u32> {
    let number = json.number()?;
    if number.fract() != 0.0 || !(1.0..=62.0).contains(&number) {
        return Err(json.error("out-of-range", format!("{number} levels: from 1 to 62 can be read")));
    }
    // A whole number up to 62.
    Ok(number as u32)
}

fn rule(json: &mut JsonReader<'_>) -> TileParseResult<ImplicitTilingJson> {
    let (mut subdivision, mut subtree_levels, mut available_levels, mut template) = (None, None, None, None);
    json.object(|json, key| {
        match key {
            "subdivisionScheme" => {
                let scheme = json.string()?;
                subdivision = Some(match scheme.as_str() {
                    "QUADTREE" => Subdivision::Quadtree,
                    "OCTREE" => Subdivision::Octree,
                    _ => return Err(json.error("bad-value", format!("{scheme:?} is no known subdivision"))),
                });
            }
            "subtreeLevels" => subtree_levels = Some(levels(json)?),
            "availableLevels" => available_levels = Some(levels(json)?),
            "subtrees" => json.object(|json, key| match key {
                "uri" => {
                    template = Some(json.string()?);
                    Ok(())
                }
                _ => json.skip(),
            })?,
            _ => json.skip()?,
        }
        Ok(())
    })?;
    let missing = |what: &str| json.error("missing", format!("implicitTiling has no {what}"));
    Ok(ImplicitTilingJson {
        subdivision: subdivision.ok_or_else(|| missing("subdivisionScheme"))?,
        subtree_levels: subtree_levels.ok_or_else(|| missing("subtreeLevels"))?,
        available_levels: available_levels.ok_or_else(|| missing("availableLevels"))?,
        template: template.ok_or_else(|| missing("subtrees.uri"))?,
    })
}
