//! Gzip, zlib and bare deflate, decoded in pieces: only the requested bytes are in memory, however much a
//! file unpacks to.
use crate::text::grouped;
use crate::unpack_cap::UnpackCap;
use crate::{FileLocation, ReadError};
use flate2::bufread::{DeflateDecoder, MultiGzDecoder, ZlibDecoder};
use std::io::{ErrorKind, Read};

/// The two bytes that a gzip stream starts with.
pub(crate) const MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Refuses a declared number of bytes if it is more samples per packed byte than in any measured file.
pub(crate) fn check_ratio(declared: Option<u64>, packed: u64, place: &FileLocation) -> Result<(), ReadError> {
    let declared = declared.unwrap_or(u64::MAX);
    let cap = UnpackCap::VOLUME;
    if !cap.is_too_dense(declared, packed) {
        return Ok(());
    }
    let message = format!(
        "the header declares {} bytes of samples, more than {} times the {} packed bytes of the file: it is cut off, \
         or nearly all of it is one value",
        grouped(declared),
        cap.ratio,
        grouped(packed)
    );
    Err(ReadError::new("too-dense", place.clone(), message))
}

/// The container of the deflated bytes.
enum Wrapper<'a> {
    /// Members of gzip (RFC 1952), in sequence.
    Gzip(MultiGzDecoder<&'a [u8]>),
    /// One stream of zlib (RFC 1950).
    Zlib(ZlibDecoder<&'a [u8]>),
    /// None (RFC 1951).
    Bare(DeflateDecoder<&'a [u8]>),
}

/// A packed stream in memory.
pub(crate) struct InflateReader<'a> {
    wrapper: Wrapper<'a>,
    /// The length of the packed bytes, and their start in the file.
    packed: usize,
    start: u64,
}

impl<'a> InflateReader<'a> {
    /// The gzip stream in `packed`, which starts at byte `start` of the file.
    pub(crate) fn gzip(packed: &'a [u8], start: u64) -> Self {
        Self { wrapper: Wrapper::Gzip(MultiGzDecoder::new(packed)), packed: packed.len(), start }
    }

    /// The zlib stream in `packed`.
    pub(crate) fn zlib(packed: &'a [u8], start: u64) -> Self {
        Self { wrapper: Wrapper::Zlib(ZlibDecoder::new(packed)), packed: packed.len(), start }
    }

    /// The deflated bytes in `packed`, without a header.
    pub(crate) fn deflate(packed: &'a [u8], start: u64) -> Self {
        Self { wrapper: Wrapper::Bare(DeflateDecoder::new(packed)), packed: packed.len(), start }
    }

    /// The stream in `packed`, of gzip or zlib.
    pub(crate) fn either(packed: &'a [u8], start: u64) -> Self {
        if packed.starts_with(&MAGIC) { Self::gzip(packed, start) } else { Self::zlib(packed, start) }
    }

    /// Fills as much of `buffer` as there are bytes.
    pub(crate) fn fill(&mut self, buffer: &mut [u8]) -> Result<usize, ReadError> {
        let mut filled = 0;
        while filled < buffer.len() {
            match self.step(&mut buffer[filled..]) {
                Ok(0) => break,
                Ok(n) => filled += n,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.broken(&error)),
            }
        }
        Ok(filled)
    }

    fn step(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        match &mut self.wrapper {
            Wrapper::Gzip(decoder) => decoder.read(buffer),
            Wrapper::Zlib(decoder) => decoder.read(buffer),
            Wrapper::Bare(decoder) => decoder.read(buffer),
        }
    }

    /// The packed bytes that were not read. After the end of a zlib stream they do not belong to it.
    pub(crate) fn rest(&self) -> &'a [u8] {
        match &self.wrapper {
            Wrapper::Gzip(decoder) => decoder.get_ref(),
            Wrapper::Zlib(decoder) => decoder.get_ref(),
            Wrapper::Bare(decoder) => decoder.get_ref(),
        }
    }

    /// The byte of the file up to which the stream was read.
    pub(crate) fn place(&self) -> FileLocation {
        FileLocation::Byte(self.start + (self.packed - self.rest().len()) as u64)
    }

    fn broken(&self, error: &std::io::Error) -> ReadError {
        let (code, name) = match self.wrapper {
            Wrapper::Gzip(_) => ("bad-gzip", "gzip"),
            Wrapper::Zlib(_) => ("bad-zlib", "zlib"),
            Wrapper::Bare(_) => ("bad-deflate", "deflated"),
        };
        if error.kind() == ErrorKind::UnexpectedEof {
            let end = grouped(self.start + self.packed as u64);
            let message = format!("the {name} data is cut off: the file ends after {end} bytes");
            return ReadError::new("truncated", self.place(), message);
        }
        ReadError::new(code, self.place(), format!("the {name} data is damaged: {error}"))
    }
}

/// Up to `most` unpacked bytes, or the bytes themselves if they are not packed.
pub(crate) fn peek(bytes: &[u8], most: usize) -> Vec<u8> {
    if !bytes.starts_with(&MAGIC) {
        return bytes[..bytes.len().min(most)].to_vec();
    }
    let mut first = vec![0; most];
    let n = InflateReader::gzip(bytes, 0).fill(&mut first).unwrap_or(0);
    first.truncate(n);
    first
}
