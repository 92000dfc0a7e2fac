//! Gzip, decoded in pieces: only the requested bytes are held, however much a file unpacks to.
use crate::text::grouped;
use crate::{FileLocation, ReadError};
use flate2::bufread::MultiGzDecoder;
use std::io::{ErrorKind, Read};

/// The two bytes that a gzip stream starts with.
pub(crate) const MAGIC: [u8; 2] = [0x1f, 0x8b];

/// The most bytes of samples for one packed byte. The format's own maximum is 1,032 (RFC 1951: 258 bytes by
/// two bits); only nearly constant samples come close to it.
const MOST_RATIO: u64 = 1_000;
/// Chosen: 1024³ labels of a byte. Volumes up to this size are read whatever their ratio, such as a mask of
/// one organ.
const SMALL: u64 = 1 << 30;

/// Refuses a declared number of bytes if more samples than any that were measured would come from each packed
/// byte.
pub(crate) fn check_ratio(declared: Option<u64>, packed: u64, place: &FileLocation) -> Result<(), ReadError> {
    let declared = declared.unwrap_or(u64::MAX);
    if declared <= SMALL || declared <= MOST_RATIO.saturating_mul(packed) {
        return Ok(());
    }
    let message = format!(
        "the header declares {} bytes of samples, more than {MOST_RATIO} times the {} packed bytes of the file: it is cut off, \
         or nearly all of it is one value",
        grouped(declared),
        grouped(packed)
    );
    Err(ReadError::new("too-dense", place.clone(), message))
}

/// A gzip stream in memory.
pub(crate) struct GzipReader<'a> {
    inner: MultiGzDecoder<&'a [u8]>,
    /// The length of the packed bytes, and their start in the file.
    packed: usize,
    start: u64,
}

impl<'a> GzipReader<'a> {
    /// The stream in `packed`, which starts at byte `start` of the file.
    pub(crate) fn new(packed: &'a [u8], start: u64) -> Self {
        Self { inner: MultiGzDecoder::new(packed), packed: packed.len(), start }
    }

    /// Fills as much of `buffer` as there are bytes.
    pub(crate) fn fill(&mut self, buffer: &mut [u8]) -> Result<usize, ReadError> {
        let mut filled = 0;
        while filled < buffer.len() {
            match self.inner.read(&mut buffer[filled..]) {
                Ok(0) => break,
                Ok(n) => filled += n,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.broken(&error)),
            }
        }
        Ok(filled)
    }

    /// The byte of the file up to which it was read.
    pub(crate) fn place(&self) -> FileLocation {
        FileLocation::Byte(self.start + (self.packed - self.inner.get_ref().len()) as u64)
    }

    fn broken(&self, error: &std::io::Error) -> ReadError {
        if error.kind() == ErrorKind::UnexpectedEof {
            let end = grouped(self.start + self.packed as u64);
            let message = format!("the gzip data is cut off: the file ends after {end} bytes");
            return ReadError::new("truncated", self.place(), message);
        }
        ReadError::new("bad-gzip", self.place(), format!("the gzip data is damaged: {error}"))
    }
}

/// Up to `most` unpacked bytes, or the bytes themselves where they are not packed.
pub(crate) fn peek(bytes: &[u8], most: usize) -> Vec<u8> {
    if !bytes.starts_with(&MAGIC) {
        return bytes[..bytes.len().min(most)].to_vec();
    }
    let mut first = vec![0; most];
    let n = GzipReader::new(bytes, 0).fill(&mut first).unwrap_or(0);
    first.truncate(n);
    first
}
