//! Contents of tiles: GLB is read, directly and inside tiles of 1.0; point clouds and vector data are refused
//! by name.
use super::old_tile;
use crate::{FileLocation, Limits, ReadError, ReadOutcome, glb};

/// Formats by their first four bytes, from 3D Tiles 1.0; 1.1 still allows them.
const OLD: [(&[u8; 4], &str); 2] = [(b"pnts", "pnts (Point Cloud)"), (b"vctr", "vctr (Vector Data)")];

/// The first two bytes of a gzip stream.
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// Reads the content of a tile. It is y-up, as GLB is; a viewer rotates it by (x, y, z) → (x, −z, y).
///
/// # Errors
/// As for [`glb::read`]; `unsupported` for other tile formats, by name; `compressed` for gzip, which belongs
/// to a server's transfer and not into a file.
///
/// ```
/// use chordal_io::{Limits, tiles};
/// let error = tiles::content(b"pnts\x01\0\0\0", &Limits::default()).unwrap_err();
/// assert_eq!(error.code, "unsupported");
/// ```
pub fn content(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    refuse_gzip(bytes)?;
    let error = |what: String| ReadError::new("unsupported", FileLocation::File, what);
    if let Some((_, name)) = OLD.iter().find(|(magic, _)| bytes.starts_with(*magic)) {
        return Err(error(format!("tiles in the format {name} are not read, only GLB is")));
    }
    if old_tile::looks_like(bytes) {
        return old_tile::read(bytes, limits);
    }
    if bytes.iter().find(|b| !crate::text::is_space(**b)) == Some(&b'{') {
        return Err(error(
            "this is JSON: a glTF with files beside it, or another tileset; only GLB is read".to_owned(),
        ));
    }
    glb::read(bytes, limits)
}

/// Refuses a gzipped file.
pub(super) fn refuse_gzip(bytes: &[u8]) -> Result<(), ReadError> {
    if bytes.starts_with(&GZIP) {
        let what = "the file is compressed by gzip, which is for a server to do, not for a file";
        return Err(ReadError::new("compressed", FileLocation::Byte(0), what));
    }
    Ok(())
}
