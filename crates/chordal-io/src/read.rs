//! `read`: decodes bytes of a known format into a shape.
use crate::format_columns::FormatReader;
use crate::text::grouped;
use crate::{FileLocation, FileOpener, Format, Limits, ReadError, ReadOutcome, unpacked};

/// Reads a file of `format` into its shape, and counts its oddities.
///
/// Time and memory grow with the bytes of the file, never with a count that it declares. The bound is 64
/// MiB + 16 times the bytes; or 16 times the 12 bytes of each triangle if a file packs triangles tighter than
/// that (long polygons, strips of one-byte indices); or 16 times the 16 bytes of each point that a path packs
/// tighter; or 16 times the 32 bytes of each control point of a Bézier patch, after it is halved; or 16 times
/// the unpacked bytes of a packed volume's samples, a packed model's parts or a gzipped file's content.
///
/// A gzipped file of any format is unpacked first ([`crate::unpacked`]); locations refer to the unpacked
/// content.
///
/// # Errors
/// One [`ReadError`] with its location. If the content looks like another format, the message names that
/// format.
///
/// ```
/// use chordal_io::{Content, Format, Limits, read};
///
/// let loaded = read(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", Format::Obj, &Limits::default())?;
/// let Content::Scene(scene) = loaded.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2]]);
///
/// let error = read(b"v 0 0 0\nf 1 2 3\n", Format::Obj, &Limits::default()).unwrap_err();
/// assert!(error.to_string().starts_with("line 2: "));
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], format: Format, limits: &Limits) -> Result<ReadOutcome, ReadError> {
    read_from(bytes, format, None, limits)
}

/// As [`read`], for a file that may refer to others beside it, as a `.gltf` to its buffers and pictures.
/// `open` returns them by their paths below the folder of the file. Paths outside that folder or on the
/// network are refused without a call.
///
/// [`Limits::bytes`] applies to the sum of all files.
///
/// # Errors
/// As for [`read`]; also if a file that the triangles need is not available.
///
/// ```
/// use chordal_io::{Format, Limits, read_with};
/// let json = br#"{"asset": {"version": "2.0"}, "buffers": [{"uri": "a.bin", "byteLength": 4}]}"#;
/// let mut asked = Vec::new();
/// let mut open = |path: &str| {
///     asked.push(path.to_owned());
///     Ok(vec![0; 4])
/// };
/// read_with(json, Format::Gltf, &mut open, &Limits::default())?;
/// assert_eq!(asked, ["a.bin"]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read_with(
    bytes: &[u8],
    format: Format,
    open: &mut FileOpener<'_>,
    limits: &Limits,
) -> Result<ReadOutcome, ReadError> {
    read_from(bytes, format, Some(open), limits)
}

fn read_from(
    bytes: &[u8],
    format: Format,
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
) -> Result<ReadOutcome, ReadError> {
    check_size(bytes, limits)?;
    let content = unpacked(bytes, Some(format), limits)?;
    let bytes = &*content;
    check_size(bytes, limits)?;
    let read = match format.row().read {
        Some(FormatReader::OneFile(read)) => read(bytes, limits),
        Some(FormatReader::WithOthers(read)) => read(bytes, open, limits),
        None => {
            let message = "a shape script is run, and nothing here runs it";
            return Err(ReadError::new("script", FileLocation::File, message));
        }
    };
    read.map_err(|mut error| {
        if let Some(other) = Format::sniff(bytes).filter(|other| *other != format) {
            error.message = error.message.words(format_args!("; the content looks like {other}"));
        }
        error
    })
}

/// Refuses an empty file, and one over the limit.
fn check_size(bytes: &[u8], limits: &Limits) -> Result<(), ReadError> {
    if bytes.iter().all(|b| crate::text::is_space(*b)) {
        let message = format!("the file is empty: {} bytes, none of them more than space", bytes.len());
        return Err(ReadError::new("empty", FileLocation::File, message));
    }
    let size = bytes.len() as u64;
    if size > limits.bytes {
        let message = format!("{} bytes are over the limit of {}", grouped(size), grouped(limits.bytes));
        return Err(ReadError::new("too-large", FileLocation::File, message));
    }
    Ok(())
}
