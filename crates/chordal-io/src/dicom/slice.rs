//! `SliceFormat`: the form of the samples of a slice.
use super::attributes::{
    BITS_ALLOCATED, BITS_STORED, COLUMNS, DicomAttributes, HIGH_BIT, IS_SIGNED, ROWS, SAMPLES,
};
use crate::volume::element::{Endian, SampleType};
use crate::{FileLocation, ReadError};

/// The storage format of a slice's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SliceFormat {
    pub columns: u64,
    pub rows: u64,
    pub bits_stored: u64,
    pub high_bit: u64,
    /// `Bool` for one bit a sample.
    pub element: SampleType,
    pub endian: Endian,
}

impl SliceFormat {
    /// The format that a file states for its pixels, which are `at` a byte.
    ///
    /// # Errors
    /// If it is colours, has a number of bits that is not read, or contradicts itself.
    pub(super) fn read(
        attributes: &DicomAttributes<'_>,
        endian: Endian,
        at: &FileLocation,
    ) -> Result<Self, ReadError> {
        let channels = attributes.short(SAMPLES).unwrap_or(1);
        if channels != 1 {
            let message = format!("{channels} samples a pixel are colours, and no volume");
            return Err(ReadError::new("several-channels", at.clone(), message));
        }
        let bits = attributes.need_short(BITS_ALLOCATED, "BitsAllocated")?;
        let is_signed = attributes.short(IS_SIGNED).unwrap_or(0) == 1;
        let element = match (bits, is_signed) {
            (1, false) => SampleType::Bool,
            (8, false) => SampleType::U8,
            (8, true) => SampleType::I8,
            (16, false) => SampleType::U16,
            (16, true) => SampleType::I16,
            (32, false) => SampleType::U32,
            (32, true) => SampleType::I32,
            _ => {
                let message = format!("samples of {bits} bits are not read: 8, 16 and 32 are");
                return Err(ReadError::new("unsupported", at.clone(), message));
            }
        };
        let bits_stored = attributes.short(BITS_STORED).unwrap_or(bits);
        let high_bit = attributes.short(HIGH_BIT).unwrap_or_else(|| bits_stored.saturating_sub(1));
        if bits_stored == 0 || high_bit >= bits || high_bit + 1 < bits_stored {
            let message = format!("{bits_stored} bits up to bit {high_bit} do not lie in {bits}");
            return Err(ReadError::new("bad-header", at.clone(), message));
        }
        let columns = attributes.need_short(COLUMNS, "Columns")?;
        let rows = attributes.need_short(ROWS, "Rows")?;
        Ok(Self { columns, rows, bits_stored, high_bit, element, endian })
    }

    /// Whether samples have a sign.
    pub(super) fn is_signed(&self) -> bool {
        matches!(self.element, SampleType::I8 | SampleType::I16 | SampleType::I32)
    }

    /// The samples of a slice.
    pub(super) fn n_pixels(&self) -> u64 {
        // Rows and columns have 16 bits each.
        self.columns * self.rows
    }

    /// The bytes of a slice of whole bytes.
    pub(super) fn n_bytes(&self) -> u64 {
        self.n_pixels() * self.element.width() as u64
    }

    /// Appends the samples as little-endian bytes, without the unused bits.
    pub(super) fn decode(&self, bytes: &[u8], out: &mut Vec<u8>) -> Result<(), ReadError> {
        out.try_reserve(bytes.len()).map_err(|_| crate::grow::out_of_memory(out.len()))?;
        let width = self.element.width();
        let is_signed = self.is_signed();
        // Both are counts of bits in a u64.
        let (left, right) = (63 - self.high_bit, 64 - self.bits_stored);
        for sample in bytes.chunks_exact(width) {
            let mut number = [0; 8];
            number[..width].copy_from_slice(sample);
            if self.endian == Endian::Big {
                number[..width].reverse();
            }
            let moved = u64::from_le_bytes(number) << left;
            let value = if is_signed { (moved as i64 >> right) as u64 } else { moved >> right };
            out.extend_from_slice(&value.to_le_bytes()[..width]);
        }
        Ok(())
    }
}
