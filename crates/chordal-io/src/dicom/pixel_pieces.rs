//! `PixelPieces`: which pieces of packed pixels make which frame.
//!
//! Source: NEMA, *DICOM PS3.5*, 2024, annex A.4.
use super::elements::{DicomElement, fragments};
use crate::volume::element::Endian;
use crate::{FileLocation, ReadError};
use std::borrow::Cow;
use std::ops::Range;

/// The pieces of all frames.
pub(super) struct PixelPieces {
    /// For each piece, where its bytes are in the file.
    pieces: Vec<Range<usize>>,
    /// For each frame, its first piece, and after the last frame the number of pieces.
    firsts: Vec<usize>,
}

impl PixelPieces {
    /// Finds the pieces of `n_frames` frames. A frame is one piece, unless there is only one frame or a table
    /// says where frames start: the first item of the pixels, or an element of its own before them.
    ///
    /// # Errors
    /// If a piece is truncated, or the pieces of a frame cannot be told.
    pub(super) fn read(
        pixels: &DicomElement<'_>,
        long_table: Option<&DicomElement<'_>>,
        n_frames: usize,
    ) -> Result<Self, ReadError> {
        let items = fragments(pixels)?;
        let wrong = |message: String| {
            Err(ReadError::new("bad-header", FileLocation::Byte(pixels.at as u64), message))
        };
        let Some(((_, table), items)) = items.split_first() else {
            return wrong("the packed pixels have no table of offsets".to_owned());
        };
        let pieces: Vec<_> = items.iter().map(|(at, bytes)| *at..at + bytes.len()).collect();
        if pieces.len() < n_frames {
            return wrong(format!("{n_frames} frames are packed in {} pieces", pieces.len()));
        }
        if pieces.len() == n_frames {
            return Ok(Self { pieces, firsts: (0..=n_frames).collect() });
        }
        if n_frames == 1 {
            let n = pieces.len();
            return Ok(Self { pieces, firsts: vec![0, n] });
        }
        // Offsets count from the head of the first piece, which has 8 bytes.
        let Some(base) = pieces.first().map(|first| first.start - 8) else {
            return wrong("the packed pixels have no pieces".to_owned());
        };
        let offsets: Vec<u64> = match long_table {
            Some(long) => {
                long.value.chunks_exact(8).map(|x| u64::from_le_bytes(Endian::Little.array(x))).collect()
            }
            None => table
                .chunks_exact(4)
                .map(|x| u64::from(u32::from_le_bytes(Endian::Little.array(x))))
                .collect(),
        };
        let mut firsts = Vec::new();
        let mut piece = 0;
        for offset in &offsets {
            // Both are in order, so each piece is passed once.
            while pieces.get(piece).is_some_and(|place| ((place.start - 8 - base) as u64) < *offset) {
                piece += 1;
            }
            let is_start = pieces.get(piece).is_some_and(|place| (place.start - 8 - base) as u64 == *offset);
            if !is_start || firsts.last().is_some_and(|last| *last == piece) {
                return wrong(format!("the table of frames names byte {offset}, where no piece starts"));
            }
            firsts.push(piece);
        }
        if firsts.len() != n_frames || firsts.first() != Some(&0) {
            let (n, rows) = (pieces.len(), firsts.len());
            return wrong(format!(
                "{n_frames} frames are packed in {n} pieces, with a table of {rows} frames"
            ));
        }
        firsts.push(pieces.len());
        Ok(Self { pieces, firsts })
    }

    /// The bytes of all pieces.
    pub(super) fn n_bytes(&self) -> usize {
        self.pieces.iter().map(Range::len).sum()
    }

    /// The packed bytes of a frame of the file `bytes`, and where they start.
    pub(super) fn frame<'a>(&self, bytes: &'a [u8], frame: usize) -> (usize, Cow<'a, [u8]>) {
        let pieces = &self.pieces[self.firsts[frame]..self.firsts[frame + 1]];
        match pieces {
            [one] => (one.start, Cow::Borrowed(&bytes[one.clone()])),
            _ => {
                let all = pieces.iter().map(|piece| &bytes[piece.clone()]).collect::<Vec<_>>().concat();
                (pieces.first().map_or(0, |first| first.start), Cow::Owned(all))
            }
        }
    }
}
