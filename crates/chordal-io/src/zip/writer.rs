//! `ZipWriter`: writes a zip container. The same content gives the same bytes.
use super::directory::{END, LOCAL, ROW};
use crate::WriteError;
use crate::text::grouped;
use flate2::write::DeflateEncoder;
use flate2::{Compression, Crc};
use std::io::{BufWriter, Write};

/// Zlib's own default, which its authors chose as the balance of size and time.
const LEVEL: u32 = 6;
/// Version 2.0 of the format, the first with deflated entries.
const VERSION: u16 = 20;
/// The method of deflated entries.
const DEFLATED: u16 = 8;
/// The earliest date of the format, 1980-01-01: days from bit 0, months from bit 5, years from bit 9.
pub(super) const DATE: u16 = 1 | 1 << 5;

/// A container that is being written.
pub(crate) struct ZipWriter<'a> {
    out: &'a mut dyn Write,
    at: u64,
    directory: Vec<u8>,
    n_entries: u16,
}

/// Compresses bytes, and counts them and computes their checksum.
struct EntryPacker {
    encoder: DeflateEncoder<Vec<u8>>,
    crc: Crc,
    n: u64,
}

impl Write for EntryPacker {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let n = self.encoder.write(bytes)?;
        self.crc.update(&bytes[..n]);
        self.n += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        // Flushing the encoder would add a marker to the packed bytes.
        Ok(())
    }
}

impl<'a> ZipWriter<'a> {
    pub(crate) fn new(out: &'a mut dyn Write) -> Self {
        Self { out, at: 0, directory: Vec::new(), n_entries: 0 }
    }

    /// Writes an entry, whose packed bytes are held until it is complete.
    ///
    /// # Errors
    /// If the sink fails, writing the content fails, or either size does not fit 32 bits.
    pub(crate) fn entry(
        &mut self,
        name: &str,
        content: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        let encoder = DeflateEncoder::new(Vec::new(), Compression::new(LEVEL));
        let mut packer = BufWriter::new(EntryPacker { encoder, crc: Crc::new(), n: 0 });
        content(&mut packer)?;
        let EntryPacker { encoder, crc, n } = packer.into_inner().map_err(|error| error.into_error())?;
        let packed = encoder.finish()?;
        let too_large = |n: u64| {
            let n = grouped(n);
            WriteError::Unsupported(format!("3MF ends at 4 GiB here, and {name} takes {n} bytes"))
        };
        let size = |n: u64| u32::try_from(n).map_err(|_| too_large(n));
        let at = size(self.at)?;
        let mut header = Vec::new();
        let mut put = |bytes: &[u8]| header.extend_from_slice(bytes);
        put(&VERSION.to_le_bytes());
        // No flags.
        put(&[0; 2]);
        put(&DEFLATED.to_le_bytes());
        // The time of day.
        put(&[0; 2]);
        put(&DATE.to_le_bytes());
        put(&crc.sum().to_le_bytes());
        put(&size(packed.len() as u64)?.to_le_bytes());
        put(&size(n)?.to_le_bytes());
        put(&(name.len() as u16).to_le_bytes());
        // No extra field.
        put(&[0; 2]);
        for bytes in [&LOCAL[..], &header, name.as_bytes(), &packed] {
            self.out.write_all(bytes)?;
            self.at += bytes.len() as u64;
        }
        self.directory.extend_from_slice(ROW);
        self.directory.extend_from_slice(&VERSION.to_le_bytes());
        self.directory.extend_from_slice(&header);
        // No comment, the first disk, no file attributes.
        self.directory.extend_from_slice(&[0; 10]);
        self.directory.extend_from_slice(&at.to_le_bytes());
        self.directory.extend_from_slice(name.as_bytes());
        self.n_entries += 1;
        Ok(())
    }

    /// Writes the directory.
    ///
    /// # Errors
    /// If the sink fails, or the file is too large.
    pub(crate) fn finish(self) -> Result<(), WriteError> {
        let Ok(at) = u32::try_from(self.at) else {
            let message = format!("3MF ends at 4 GiB here, and the parts take {} bytes", grouped(self.at));
            return Err(WriteError::Unsupported(message));
        };
        let n = self.n_entries.to_le_bytes();
        let n_directory = (self.directory.len() as u32).to_le_bytes();
        self.out.write_all(&self.directory)?;
        // The first disk, which is also the last, and no comment.
        for bytes in [&END[..], &[0; 4], &n, &n, &n_directory, &at.to_le_bytes(), &[0; 2]] {
            self.out.write_all(bytes)?;
        }
        Ok(self.out.flush()?)
    }
}
