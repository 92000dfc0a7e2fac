//! The container: a header, a JSON chunk, and an optional BIN chunk.
use super::leniency::is_tolerated_code;
use super::report::GlbWarnings;
use super::{BIN_CHUNK, JSON_CHUNK, MAGIC};
use crate::{FileLocation, Limits, ReadError};

/// The two chunks that are read.
pub(super) struct GlbChunks<'a> {
    /// The JSON.
    pub json: &'a [u8],
    /// The offset in the file at which it begins.
    pub json_at: u64,
    /// The container of the JSON.
    pub container: GltfContainer<'a>,
}

/// The container of a glTF's JSON, which decides where the bytes of a buffer without a URI are.
#[derive(Clone, Copy, Debug)]
pub(super) enum GltfContainer<'a> {
    /// A `.gltf` file: it has no such bytes.
    Json,
    /// A GLB: they are in its BIN chunk, if it has one.
    Binary(Option<&'a [u8]>),
}

/// Splits a GLB file into chunks. Errors of gltf-validator are errors, its warnings are listed.
///
/// # Errors
/// At the byte where the container is invalid.
pub(super) fn chunks<'a>(
    bytes: &'a [u8],
    limits: &Limits,
    report: &mut GlbWarnings,
) -> Result<GlbChunks<'a>, ReadError> {
    match split(bytes, 4, report) {
        Err(error) if is_tolerated_code(error.code, limits) => {
            // The second attempt drops one rule, that lengths are multiples of four; if that
            // doesn't help, the first error is the better one.
            let Ok(chunks) = split(bytes, 1, report) else { return Err(error) };
            report.add(error.code, error.place, error.message);
            Ok(chunks)
        }
        result => result,
    }
}

/// The same for chunks whose lengths are multiples of `step`.
fn split<'a>(bytes: &'a [u8], step: usize, report: &mut GlbWarnings) -> Result<GlbChunks<'a>, ReadError> {
    let word = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let error =
        |code, at: usize, what: String| Err(ReadError::new(code, FileLocation::Byte(at as u64), what));
    let (Some(magic), Some(version), Some(length)) = (word(0), word(4), word(8)) else {
        let what = format!("{} bytes are too few for the GLB header of 12", bytes.len());
        return error("GLB_UNEXPECTED_END_OF_HEADER", bytes.len(), what);
    };
    if magic != MAGIC {
        return error(
            "GLB_INVALID_MAGIC",
            0,
            format!("the file begins with {magic:#010x} and not with \"glTF\""),
        );
    }
    if version != 2 {
        return error("GLB_INVALID_VERSION", 4, format!("GLB version {version} is not read, only 2"));
    }
    let length = length as usize;
    if length <= 12 {
        return error(
            "GLB_LENGTH_TOO_SMALL",
            8,
            format!("the header says {length} bytes, it takes 12 itself"),
        );
    }
    // 0                      12            20       20 + n
    // | magic version length | n kind      | data   | n kind | data | …
    let (mut json, mut bin, mut n_chunks) = (None, None, 0);
    let mut at = 12;
    // To the end that the header names: what follows it is no chunk.
    while at < bytes.len() && at != length {
        let (Some(n), Some(kind)) = (word(at), word(at + 4)) else {
            return error(
                "GLB_UNEXPECTED_END_OF_CHUNK_HEADER",
                bytes.len(),
                "a chunk's header is cut off".to_owned(),
            );
        };
        let n = n as usize;
        if !n.is_multiple_of(step) {
            return error("GLB_CHUNK_LENGTH_UNALIGNED", at, format!("chunk length {n} is no multiple of 4"));
        }
        let start = at + 8;
        if n > length.saturating_sub(start) {
            return error(
                "GLB_CHUNK_TOO_BIG",
                at,
                format!("a chunk of {n} bytes exceeds the file's {length}"),
            );
        }
        if n_chunks == 0 && kind != JSON_CHUNK {
            return error(
                "GLB_UNEXPECTED_FIRST_CHUNK",
                at,
                format!("the first chunk is {kind:#010x} and not JSON"),
            );
        }
        let Some(data) = bytes.get(start..).and_then(|rest| rest.get(..n)) else {
            let what = format!("the file ends inside a chunk of {n} bytes");
            return error("GLB_UNEXPECTED_END_OF_CHUNK_DATA", bytes.len(), what);
        };
        match kind {
            JSON_CHUNK if json.is_some() => {
                return error("GLB_DUPLICATE_CHUNK", at, "a second JSON chunk".to_owned());
            }
            JSON_CHUNK if n == 0 => {
                return error("GLB_EMPTY_CHUNK", at, "the JSON chunk is empty".to_owned());
            }
            JSON_CHUNK => json = Some((data, start as u64)),
            BIN_CHUNK if bin.is_some() => {
                return error("GLB_DUPLICATE_CHUNK", at, "a second BIN chunk".to_owned());
            }
            BIN_CHUNK if n_chunks > 1 => {
                return error("GLB_UNEXPECTED_BIN_CHUNK", at, "the BIN chunk is not the second".to_owned());
            }
            BIN_CHUNK => bin = Some(data),
            _ => {
                let what = format!("a chunk of unknown type {kind:#010x} was skipped");
                report.add("GLB_UNKNOWN_CHUNK_TYPE", FileLocation::Byte(at as u64), what);
            }
        }
        n_chunks += 1;
        at = start + n;
    }
    if at < bytes.len() {
        let what = format!("{} extra bytes follow the end that the header names", bytes.len() - at);
        report.add("GLB_EXTRA_DATA", FileLocation::Byte(at as u64), what);
    } else if at != length {
        let what = format!("the header says {length} bytes, the file has {}", bytes.len());
        return error("GLB_LENGTH_MISMATCH", bytes.len(), what);
    }
    let Some((json, json_at)) = json else {
        return error("GLB_UNEXPECTED_END_OF_CHUNK_HEADER", bytes.len(), "there is no JSON chunk".to_owned());
    };
    Ok(GlbChunks { json, json_at, container: GltfContainer::Binary(bin) })
}
