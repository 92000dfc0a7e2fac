//! `unpacked`: the content of a gzipped file of any format; limits are checked during decompression.
use crate::text::grouped;
use crate::volume::inflate::{InflateReader, MAGIC};
use crate::{FileLocation, Format, Limits, ReadError};
use std::borrow::Cow;

/// The number of bytes unpacked at once.
const STEP: usize = 1 << 16;

/// The content of a file: unpacked if it is gzipped, else the bytes themselves. `format` is the format, if it
/// is known. NIfTI stays packed, because its reader unpacks only the bytes that it needs.
///
/// The content of meshes, drawings and texts may have 16 MiB or 200 times the packed bytes read so far,
/// volumes 1 GiB or 1,000 times these, and nothing may have more than [`Limits::bytes`].
///
/// # Errors
/// If the packed bytes are damaged or truncated, unpack to too much, or are packed twice.
///
/// ```
/// use chordal_io::{Limits, unpacked};
/// use std::io::Write;
/// let mut file = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
/// file.write_all(b"v 0 0 0\n")?;
/// assert_eq!(*unpacked(&file.finish()?, None, &Limits::default())?, *b"v 0 0 0\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn unpacked<'a>(
    bytes: &'a [u8],
    format: Option<Format>,
    limits: &Limits,
) -> Result<Cow<'a, [u8]>, ReadError> {
    if !bytes.starts_with(&MAGIC) || format.is_some_and(|format| format.row().unpacks) {
        return Ok(Cow::Borrowed(bytes));
    }
    let format = format.or_else(|| Format::sniff(bytes));
    // An unknown format is treated as a mesh, the stricter kind.
    let cap = format.unwrap_or(Format::Obj).row().cap;
    let mut inflater = InflateReader::gzip(bytes, 0);
    let mut content: Vec<u8> = Vec::new();
    let mut step = vec![0; STEP];
    loop {
        let n = inflater.fill(&mut step)?;
        let size = content.len() as u64 + n as u64;
        if size > limits.bytes {
            let message =
                format!("the file unpacks to more than the limit of {} bytes", grouped(limits.bytes));
            return Err(ReadError::new("too-large", inflater.place(), message));
        }
        // The ratio to the bytes read so far: compared with the whole file, a bomb of 10 MB would fill 2 GB
        // first.
        let n_read = (bytes.len() - inflater.rest().len()) as u64;
        if cap.is_too_dense(size, n_read) {
            let message = format!("the part of the file read so far {}", cap.too_dense(n_read));
            return Err(ReadError::new("too-dense", inflater.place(), message));
        }
        // By halves: doubling would ask for up to twice the limit of memory at the end.
        if content.capacity() - content.len() < n {
            let more = n.max(content.len() / 2);
            content.try_reserve_exact(more).map_err(|_| crate::grow::out_of_memory(content.len()))?;
        }
        content.extend_from_slice(&step[..n]);
        // The inflater fills the buffer unless the stream ends.
        if n < STEP {
            break;
        }
    }
    if content.starts_with(&MAGIC) {
        let message = "the file is packed twice by gzip: unpack it once";
        return Err(ReadError::new("packed-twice", FileLocation::Byte(0), message));
    }
    Ok(Cow::Owned(content))
}
