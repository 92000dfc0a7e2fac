//! Reads a tileset as one scene: the content of its finest tiles.
use super::merge::{SceneMerge, for_content};
use super::{Refine, Tile, content, read};
use crate::files::FileOpener;
use crate::matrix::{IDENTITY, product};
use crate::{FileLocation, Limits, ReadError, ReadOutcome};

/// Whether a text is a `tileset.json`.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    let names = |key: &[u8]| memchr::memmem::find(text, key).is_some();
    text.first() == Some(&b'{') && names(b"\"asset\"") && names(b"\"geometricError\"") && names(b"\"root\"")
}

/// Reads the triangles of the finest tiles of a tileset, and of the tiles that these add to: the shape as a
/// viewer shows it from nearby. y is up and the unit is the metre, as in the tiles' contents; transforms of
/// tiles are nodes, including that of the root, which may place it on the globe. Materials are dropped with a
/// warning.
///
/// # Errors
/// As for [`super::read()`] and [`content()`], with the name of the tile; for implicit tilings, whose tiles
/// are counted and not read; if the files of the tiles are not available.
pub(crate) fn read_scene(
    bytes: &[u8],
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
) -> Result<ReadOutcome, ReadError> {
    let Some(open) = open else {
        let message = "the tiles are not at hand: only their list was given";
        return Err(ReadError::new("detached", FileLocation::File, message));
    };
    let (tileset, warnings) = read(bytes, open, limits)?;
    let mut merge = SceneMerge::default();
    for warning in warnings {
        merge.warnings.count_many(warning.code, warning.count, || (warning.place, warning.message));
    }
    let mut left = limits.bytes.saturating_sub(bytes.len() as u64);
    let mut tiles: Vec<(&Tile, [f64; 16])> =
        vec![(&tileset.root, tileset.root.transform.as_deref().copied().unwrap_or(IDENTITY))];
    while let Some((tile, matrix)) = tiles.pop() {
        if tile.implicit.is_some() {
            let message = "the tiles of an implicit tiling are not read";
            return Err(ReadError::new("unsupported", FileLocation::File, message));
        }
        let is_shown = tile.children.is_empty() || tile.refine == Refine::Add;
        // An external tileset among the contents is a child of its own.
        for name in tile.contents.iter().filter(|name| is_shown && !name.ends_with(".json")) {
            let of_tile = |error: ReadError| ReadError {
                message: error.message.words(format_args!(" (in '{name}')")),
                place: FileLocation::File,
                ..error
            };
            let bytes = open(name).map_err(|why| {
                ReadError::new("file-missing", FileLocation::File, format!("'{name}' cannot be read: {why}"))
            })?;
            left = left.checked_sub(bytes.len() as u64).ok_or_else(|| {
                let what = format!("the files of the tileset exceed the limit of {} bytes", limits.bytes);
                ReadError::new("too-large", FileLocation::File, what)
            })?;
            let shown = content(&bytes, limits).map_err(of_tile)?;
            merge.add(shown, &for_content(&matrix)).map_err(of_tile)?;
        }
        for child in tile.children.iter().rev() {
            let child_matrix =
                child.transform.as_deref().map_or(matrix, |child_matrix| product(&matrix, child_matrix));
            tiles.push((child, child_matrix));
        }
    }
    merge.finish()
}
