//! `SampleStream`: the bytes of samples, plain or packed.
use super::inflate::InflateReader;
use crate::text::grouped;
use crate::{FileLocation, ReadError};

/// A stream of bytes.
pub(crate) enum SampleStream<'a> {
    /// Plain bytes, up to the end of the file.
    Plain {
        /// All bytes of the file.
        file: &'a [u8],
        /// The offset of the next byte.
        at: usize,
    },
    /// Packed bytes.
    Packed(InflateReader<'a>),
}

impl<'a> SampleStream<'a> {
    /// The file from a byte on, or from its end if it is shorter.
    pub(crate) fn plain(file: &'a [u8], at: usize) -> Self {
        Self::Plain { file, at: at.min(file.len()) }
    }

    /// Fills as much of `buffer` as there are bytes.
    pub(crate) fn fill(&mut self, buffer: &mut [u8]) -> Result<usize, ReadError> {
        match self {
            Self::Plain { file, at } => {
                let n = buffer.len().min(file.len() - *at);
                buffer[..n].copy_from_slice(&file[*at..*at + n]);
                *at += n;
                Ok(n)
            }
            Self::Packed(inflater) => inflater.fill(buffer),
        }
    }

    /// Skips up to `n` bytes, and returns how many were there.
    pub(crate) fn skip(&mut self, n: u64) -> Result<u64, ReadError> {
        if let Self::Plain { file, at } = self {
            let step = usize::try_from(n).unwrap_or(usize::MAX).min(file.len() - *at);
            *at += step;
            return Ok(step as u64);
        }
        let mut buffer = [0; 1 << 14];
        let mut left = n;
        while left > 0 {
            let want = usize::try_from(left).unwrap_or(usize::MAX).min(buffer.len());
            let got = self.fill(&mut buffer[..want])?;
            left -= got as u64;
            if got < want {
                break;
            }
        }
        Ok(n - left)
    }

    /// The number of bytes left, if it is known without reading them.
    pub(crate) fn left(&self) -> Option<u64> {
        match self {
            Self::Plain { file, at } => Some((file.len() - *at) as u64),
            Self::Packed(_) => None,
        }
    }

    /// The bytes after the end of a packed stream, once it was read to its end.
    pub(crate) fn after(&self) -> u64 {
        match self {
            Self::Plain { .. } => 0,
            Self::Packed(inflater) => inflater.rest().len() as u64,
        }
    }

    /// The location of the next byte.
    pub(crate) fn place(&self) -> FileLocation {
        match self {
            Self::Plain { at, .. } => FileLocation::Byte(*at as u64),
            Self::Packed(inflater) => inflater.place(),
        }
    }

    /// The error for samples that end too early, after `there` of `declared` bytes.
    pub(crate) fn truncated(&self, there: u64, declared: u64) -> ReadError {
        let message = format!(
            "the samples are cut off: {} bytes are there, the header says {}",
            grouped(there),
            grouped(declared)
        );
        ReadError::new("truncated", self.place(), message)
    }
}
