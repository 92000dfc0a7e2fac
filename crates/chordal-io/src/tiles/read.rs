//! The tileset reader: the tree of one file, and of the files that it refers to.
use super::parse::{self, RawTileset, UnresolvedTile};
use super::subtree::{self, TileCoordinates};
use super::{ImplicitTiling, Refine, Tile, Tileset};
use crate::files::{self, FileOpener};
use crate::warnings::Warnings;
use crate::{Conformance, FileLocation, Limits, ReadError, Warning};
use std::collections::BTreeSet;

/// Reads a tileset, 1.0 or 1.1, with the external tilesets of its tiles and the subtrees of its implicit
/// tilings; `open` returns those files. Contents other than tilesets are not opened.
///
/// Paths in the result are relative to the first file's folder. If the content of a tile is a tileset, the
/// root of that tileset becomes the tile's last child; a tileset that occurs again is counted and not opened
/// again. Geometric errors must not grow towards the leaves, unless [`Limits::conformance`] turns this into a
/// warning. Other data of a tileset (metadata, styles, tighter volumes of contents, request volumes) is
/// counted, not kept.
///
/// Linear in the bytes of all files, whose sum is limited by [`Limits::bytes`]; [`Limits::depth`] limits
/// nesting.
///
/// # Errors
/// [`ReadError`] with the byte or JSON pointer, and the file's name unless it is the first: not a tileset,
/// errors that grow, a URI with a scheme or one that leaves the folder, tilesets that contain themselves, a
/// file that is missing or compressed, a subtree with the wrong number of bits, a required extension.
///
/// ```
/// use chordal_io::{Limits, tiles};
/// let cube = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
/// let tileset = tiles::Tileset { geometric_error: 1.0, root: tiles::Tile::leaf(cube, "a.glb"), extras: None };
/// let bytes = tiles::write(&tileset)?;
/// let (read, warnings) = tiles::read(&bytes, &mut |path| Err(format!("no {path}")), &Limits::default())?;
/// assert_eq!((read, warnings.len()), (tileset, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(
    bytes: &[u8],
    open: &mut FileOpener<'_>,
    limits: &Limits,
) -> Result<(Tileset, Vec<Warning>), ReadError> {
    let mut reader = TilesetReader {
        open,
        limits,
        warnings: Warnings::default(),
        chain: Vec::new(),
        seen: BTreeSet::new(),
        left: limits.bytes,
        n_tiles: 0,
    };
    reader.charge(bytes.len() as u64)?;
    let tileset = reader.tileset(bytes, "", None)?;
    Ok((tileset, reader.warnings.into_list()))
}

struct TilesetReader<'r, 'o> {
    open: &'r mut FileOpener<'o>,
    limits: &'r Limits,
    warnings: Warnings,
    /// The paths of the enclosing tilesets; the first has an empty one.
    chain: Vec<String>,
    /// Tilesets that were opened already.
    seen: BTreeSet<String>,
    /// The number of bytes that may still be read.
    left: u64,
    /// The number of tiles in all files.
    n_tiles: u64,
}

/// The values that a tile inherits from its parent and its file.
#[derive(Clone, Copy)]
struct ParentTile<'a> {
    error: f64,
    refine: Refine,
    /// The folder of the file.
    folder: &'a str,
}

type TilesetResult<T> = Result<T, ReadError>;

impl TilesetReader<'_, '_> {
    /// Charges bytes that are about to be read.
    fn charge(&mut self, n: u64) -> TilesetResult<()> {
        match self.left.checked_sub(n) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => {
                let what =
                    format!("the files of the tileset exceed the limit of {} bytes", self.limits.bytes);
                Err(ReadError::new("too-large", FileLocation::File, what))
            }
        }
    }

    /// Reads one file, below a tile with the geometric error `above`. The path is empty for the first file.
    fn tileset(&mut self, bytes: &[u8], path: &str, above: Option<f64>) -> TilesetResult<Tileset> {
        let RawTileset { mut tileset, pending } = parse::parse(bytes, self.limits, &mut self.warnings)?;
        self.n_tiles += pending.len() as u64;
        if self.n_tiles > self.limits.rows {
            let what = format!("more tiles than the limit of {}", self.limits.rows);
            return Err(ReadError::new("too-many-rows", FileLocation::File, what));
        }
        let tileset_error = tileset.geometric_error;
        if let Some(error) = above.filter(|error| tileset_error > *error) {
            self.check_error(tileset_error, error, "/geometricError")?;
        }
        if pending.first().is_some_and(|root| root.refine.is_none()) {
            self.warnings.count("refine-missing", || {
                let what = "the root does not say how it is refined; it is taken to be replaced".to_owned();
                (FileLocation::Pointer("/root".to_owned()), what)
            });
        }
        let above = ParentTile { error: tileset_error, refine: Refine::Replace, folder: files::folder(path) };
        self.tile(&mut tileset.root, &mut pending.into_iter(), above, &mut "/root".to_owned())?;
        Ok(tileset)
    }

    /// Refuses or counts a geometric error that grows towards the leaves.
    fn check_error(&mut self, error: f64, above: f64, pointer: &str) -> TilesetResult<()> {
        let what = format!("the error of {error} m is above that of the tile before it, {above} m");
        let place = FileLocation::Pointer(pointer.to_owned());
        if self.limits.conformance != Conformance::Lenient {
            return Err(ReadError::new("error-increases", place, what));
        }
        self.warnings.count("error-increases", || (place, what));
        Ok(())
    }

    /// Completes a tile and its descendants.
    fn tile(
        &mut self,
        tile: &mut Tile,
        pending: &mut std::vec::IntoIter<UnresolvedTile>,
        above: ParentTile<'_>,
        pointer: &mut String,
    ) -> TilesetResult<()> {
        let UnresolvedTile { rule, refine } = pending.next().unwrap_or_default();
        tile.refine = refine.unwrap_or(above.refine);
        if tile.geometric_error > above.error {
            self.check_error(tile.geometric_error, above.error, &format!("{pointer}/geometricError"))?;
        }
        let below = ParentTile { error: tile.geometric_error, refine: tile.refine, ..above };
        let length = pointer.len();
        for i in 0..tile.children.len() {
            pointer.push_str(&format!("/children/{i}"));
            self.tile(&mut tile.children[i], pending, below, pointer)?;
            pointer.truncate(length);
        }
        let is_list = tile.contents.len() > 1;
        let mut tilesets = Vec::new();
        for (i, content) in tile.contents.iter_mut().enumerate() {
            let key = if is_list {
                format!("{pointer}/contents/{i}/uri")
            } else {
                format!("{pointer}/content/uri")
            };
            let written = if rule.is_some() { root_uri(content) } else { content.clone() };
            let path = resolved(above.folder, &written, &key)?;
            if rule.is_some() {
                // The template is kept; its paths were already checked to be below the folder.
                continue;
            }
            *content = path;
            if content.ends_with(".json") {
                tilesets.extend(self.external(content, tile.geometric_error, &key)?);
            }
        }
        // Only after the loop over the children: the list `pending` has no entries for tiles of
        // other files, which were completed with their own.
        tile.children.extend(tilesets);
        if let Some(rule) = rule {
            let key = format!("{pointer}/implicitTiling/subtrees/uri");
            tile.implicit = Some(self.implicit(&rule, above.folder, &key)?);
        }
        Ok(())
    }

    /// The root of a tile's external tileset, unless it was opened before.
    fn external(&mut self, path: &str, error: f64, pointer: &str) -> TilesetResult<Option<Tile>> {
        let place = || FileLocation::Pointer(pointer.to_owned());
        if self.chain.iter().any(|file| file == path) {
            let what = format!("the tileset '{path}' contains itself");
            return Err(ReadError::new("tileset-cycle", place(), what));
        }
        // A chain of files takes stack, as nesting does.
        if self.chain.len() >= MOST_FILES.min(self.limits.depth) {
            let what = format!("tilesets in tilesets, {} deep, exceed the limit", self.chain.len() + 1);
            return Err(ReadError::new("too-deep", place(), what));
        }
        if !self.seen.insert(path.to_owned()) {
            self.warnings.count("tileset-named-again", || {
                (place(), "tilesets that several tiles name were looked at once".to_owned())
            });
            return Ok(None);
        }
        let bytes = self.file(path).map_err(|error| ReadError { place: place(), ..error })?;
        self.chain.push(path.to_owned());
        let tileset = self.tileset(&bytes, path, Some(error)).map_err(|error| error_in_file(path, error))?;
        self.chain.pop();
        Ok(Some(tileset.root))
    }

    fn file(&mut self, path: &str) -> TilesetResult<Vec<u8>> {
        let bytes = (self.open)(path).map_err(|why| {
            ReadError::new("file-missing", FileLocation::File, format!("'{path}' cannot be read: {why}"))
        })?;
        self.charge(bytes.len() as u64)?;
        Ok(bytes)
    }

    /// Reads the subtrees of an implicit tiling.
    fn implicit(
        &mut self,
        rule: &parse::ImplicitTilingJson,
        folder: &str,
        pointer: &str,
    ) -> TilesetResult<ImplicitTiling> {
        let place = || FileLocation::Pointer(pointer.to_owned());
        let axes: &[&str] = match rule.subdivision {
            super::Subdivision::Quadtree => &["{level}", "{x}", "{y}"],
            super::Subdivision::Octree => &["{level}", "{x}", "{y}", "{z}"],
        };
        // Otherwise many subtrees would be the same file, and a small file could be read without end.
        if let Some(name) = axes.iter().find(|name| !rule.template.contains(**name)) {
            return Err(ReadError::new("bad-template", place(), format!("the template has no {name}")));
        }
        let n_levels = rule.available_levels as usize;
        let mut tiling = ImplicitTiling {
            subdivision: rule.subdivision,
            subtree_levels: rule.subtree_levels,
            n_subtrees: 0,
            n_tiles: vec![0; n_levels],
            n_contents: vec![0; n_levels],
        };
        let mut open = vec![TileCoordinates { level: 0, place: [0; 3] }];
        while let Some(at) = open.pop() {
            let path = resolved(folder, &at.uri(&rule.template), pointer)?;
            let bytes = self.file(&path).map_err(|error| ReadError { place: place(), ..error })?;
            let limits = self.limits;
            let mut other = |uri: &str| {
                let path = resolved(self::files::folder(&path), uri, "")?;
                self.file(&path)
            };
            let below = subtree::read(&bytes, rule, at, &mut tiling, limits, &mut other);
            open.extend(below.map_err(|error| error_in_file(&path, error))?.into_iter().rev());
        }
        Ok(tiling)
    }
}

/// The deepest nesting of external tilesets. Chosen: far more than in practice, and a few hundred kilobytes
/// of stack.
const MOST_FILES: usize = 16;

/// The path that a URI resolves to.
fn resolved(folder: &str, written: &str, pointer: &str) -> TilesetResult<String> {
    files::resolve(folder, written).map_err(|outside| {
        let place = FileLocation::Pointer(pointer.to_owned());
        ReadError::new(outside.code(), place, format!("'{written}' {}", outside.reason()))
    })
}

/// The path of a template for the first tile.
fn root_uri(template: &str) -> String {
    TileCoordinates { level: 0, place: [0; 3] }.uri(template)
}

/// Adds the path of a referenced file to its error.
fn error_in_file(path: &str, error: ReadError) -> ReadError {
    ReadError { message: error.message.words(format_args!(" (in '{path}')")), ..error }
}
