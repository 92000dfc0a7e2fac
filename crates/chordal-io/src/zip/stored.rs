//! `write_stored`: a zip container of aligned, uncompressed entries, as USD packages are.
use super::directory::{END, LOCAL, ROW};
use super::writer::DATE;
use crate::WriteError;
use crate::text::grouped;
use flate2::Crc;
use std::io::Write;

/// Version 1.0 of the format, which has stored entries.
const VERSION: u16 = 10;
/// The multiple of bytes at which the content of an entry begins: defined by USD's package format.
const ALIGNMENT: u64 = 64;
/// The bytes of a local header before its name.
const LOCAL_BYTES: u64 = 30;
/// An extra field has a kind and a size, of two bytes each, before its own bytes.
const EXTRA_HEAD: u64 = 4;
/// The kind of the padding field in USD's own writer.
const PADDING_KIND: u16 = 0x1986;

/// Writes the entries in order. The same content gives the same bytes.
///
/// # Errors
/// If the sink fails, or the container would have 4 GiB or more.
pub(crate) fn write_stored(entries: &[(&str, &[u8])], out: &mut dyn Write) -> Result<(), WriteError> {
    let too_large = |n: u64| {
        WriteError::Unsupported(format!("a package ends at 4 GiB, and {} bytes are there", grouped(n)))
    };
    let size = |n: u64| u32::try_from(n).map_err(|_| too_large(n));
    let (mut at, mut directory) = (0_u64, Vec::new());
    for (name, content) in entries {
        let unpadded = at + LOCAL_BYTES + name.len() as u64 + EXTRA_HEAD;
        let padding = unpadded.next_multiple_of(ALIGNMENT) - unpadded;
        let mut crc = Crc::new();
        crc.update(content);
        let n = size(content.len() as u64)?.to_le_bytes();
        let mut header = Vec::new();
        let mut put = |bytes: &[u8]| header.extend_from_slice(bytes);
        put(&VERSION.to_le_bytes());
        // No flags, no compression, no time of day.
        put(&[0; 6]);
        put(&DATE.to_le_bytes());
        put(&crc.sum().to_le_bytes());
        put(&n);
        put(&n);
        put(&(name.len() as u16).to_le_bytes());
        directory.extend_from_slice(ROW);
        directory.extend_from_slice(&VERSION.to_le_bytes());
        directory.extend_from_slice(&header);
        // No extra field, no comment, the first disk, no file attributes.
        directory.extend_from_slice(&[0; 12]);
        directory.extend_from_slice(&size(at)?.to_le_bytes());
        directory.extend_from_slice(name.as_bytes());
        header.extend_from_slice(&((EXTRA_HEAD + padding) as u16).to_le_bytes());
        let extra =
            [&PADDING_KIND.to_le_bytes()[..], &(padding as u16).to_le_bytes(), &vec![0; padding as usize]];
        for bytes in [&LOCAL[..], &header, name.as_bytes(), &extra.concat(), content] {
            out.write_all(bytes)?;
            at += bytes.len() as u64;
        }
    }
    let n = u16::try_from(entries.len()).map_err(|_| {
        WriteError::Unsupported(format!("a package holds 65,535 files, not {}", entries.len()))
    })?;
    let n = n.to_le_bytes();
    out.write_all(&directory)?;
    let n_directory = size(directory.len() as u64)?.to_le_bytes();
    // The first disk, which is also the last, and no comment.
    for bytes in [&END[..], &[0; 4], &n, &n, &n_directory, &size(at)?.to_le_bytes(), &[0; 2]] {
        out.write_all(bytes)?;
    }
    Ok(out.flush()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_begins_at_a_multiple_of_64_bytes_whatever_its_name_and_size() {
        for n in 0..130 {
            let (name, content) = ("x".repeat(n + 1), vec![7; 3 * n]);
            let mut file = Vec::new();
            write_stored(&[(&name, &content), ("b.usda", b"#usda 1.0"), ("c", b"c")], &mut file).unwrap();
            let short = |at: usize| usize::from(u16::from_le_bytes([file[at], file[at + 1]]));
            let mut at = 0;
            for length in [content.len(), 9, 1] {
                assert_eq!(&file[at..at + 4], LOCAL);
                let start = at + 30 + short(at + 26) + short(at + 28);
                assert_eq!(start % 64, 0, "{n}");
                at = start + length;
            }
        }
    }
}
