//! `OffColors`: colours of vertices or faces, which OFF writes as bytes or as fractions without
//! distinguishing them.
use crate::ReadError;
use crate::grow::{push, push_many};
use crate::number::put_count;
use crate::warnings::Warnings;
use chordal::explicit::{Attribute, Domain, Semantic};

/// The largest byte: Geomview divides whole numbers by it.
const BYTE: f64 = 255.0;

/// A colour as spelled in a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct OffColor {
    /// Three or four numbers; a missing alpha is 1.
    pub(super) channels: [f64; 4],
    pub(super) width: usize,
    /// Whether all of them are spelled as whole numbers.
    pub(super) is_whole: bool,
}

/// A row of whole numbers up to 1: either bytes of a nearly black colour, or fractions of a bright one.
#[derive(Debug)]
struct UndecidedColor {
    row: u32,
    width: u8,
}

/// The colours so far. Whole numbers are bytes if one of them is above 1, as in Geomview, and other numbers
/// are fractions. A row of zeros and ones is interpreted like the other rows; if these do not decide, as
/// fractions.
#[derive(Debug, Default)]
pub(super) struct OffColors {
    values: Vec<[f64; 4]>,
    undecided: Vec<UndecidedColor>,
    has_bytes: bool,
    has_fractions: bool,
    has_alpha: bool,
    n_out_of_range: u64,
    /// The number of rows before the first colour, and of rows without one after it.
    n_missing: u64,
}

impl OffColors {
    /// Adds `n_rows` rows of the same colour.
    pub(super) fn push(&mut self, color: OffColor, n_rows: usize) -> Result<(), ReadError> {
        if self.values.is_empty() {
            push_many(&mut self.values, [1.0; 4], self.n_missing as usize)?;
        }
        let OffColor { mut channels, width, is_whole } = color;
        self.has_alpha |= width == 4;
        let is_above = |limit: f64| channels[..width].iter().any(|x| *x > limit);
        let is_byte = is_whole && is_above(1.0);
        let limit = if is_byte { BYTE } else { 1.0 };
        let is_below = channels[..width].iter().any(|x| *x < 0.0);
        self.n_out_of_range += u64::from(is_below || is_above(limit));
        if is_byte {
            self.has_bytes = true;
            channels[..width].iter_mut().for_each(|x| *x /= BYTE);
        } else if is_whole {
            for row in 0..n_rows {
                let row = u32::try_from(self.values.len() + row).unwrap_or(u32::MAX);
                push(&mut self.undecided, UndecidedColor { row, width: width as u8 })?;
            }
        } else {
            self.has_fractions = true;
        }
        push_many(&mut self.values, channels, n_rows)
    }

    /// Adds rows without a colour.
    pub(super) fn push_missing(&mut self, n_rows: usize) -> Result<(), ReadError> {
        self.n_missing += n_rows as u64;
        if self.values.is_empty() { Ok(()) } else { push_many(&mut self.values, [1.0; 4], n_rows) }
    }

    /// The colours as an attribute; `None` if no row has one.
    pub(super) fn finish(mut self, domain: Domain, warnings: &mut Warnings) -> Option<Attribute> {
        if self.values.is_empty() {
            return None;
        }
        if self.has_bytes && !self.has_fractions {
            for UndecidedColor { row, width } in self.undecided {
                self.values[row as usize][..usize::from(width)].iter_mut().for_each(|x| *x /= BYTE);
            }
        }
        let white = "triangles of faces without a colour are white";
        warnings.count_all("colors-missing", self.n_missing, white);
        let outside = "colours are outside 0 to 1, or 0 to 255 in whole numbers; they were kept";
        warnings.count_all("colors-out-of-range", self.n_out_of_range, outside);
        let mut values = self.values.into_flattened();
        let width = if self.has_alpha { 4 } else { 3 };
        if !self.has_alpha {
            let mut at = 0;
            values.retain(|_| {
                at += 1;
                at % 4 != 0
            });
        }
        Some(Attribute { semantic: Semantic::Color(0), domain, width, values })
    }
}

/// The spelling of the colours of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OffColorSpelling {
    Bytes,
    Fractions,
}

impl OffColorSpelling {
    /// Bytes if they read back as exactly these channels, else fractions, which always do.
    pub(super) fn from_channels<'a>(channels: impl Iterator<Item = &'a f64>) -> Self {
        let mut is_plain = false;
        for channel in channels {
            match byte(*channel) {
                None => return Self::Fractions,
                Some(byte) => is_plain |= byte > 1,
            }
        }
        // Bytes would be taken for fractions if none of them is above 1.
        if is_plain { Self::Bytes } else { Self::Fractions }
    }

    /// Appends a channel.
    pub(super) fn put(self, line: &mut Vec<u8>, channel: f64) {
        line.push(b' ');
        match byte(channel).filter(|_| self == Self::Bytes) {
            Some(byte) => put_count(line, u64::from(byte)),
            // A point or an exponent distinguishes fractions from bytes.
            None => line.extend_from_slice(format!("{channel:?}").as_bytes()),
        }
    }
}

/// The byte that reads back as exactly this channel.
fn byte(channel: f64) -> Option<u8> {
    let nearest = (channel * BYTE).round();
    let byte = (0.0..=BYTE).contains(&nearest).then_some(nearest as u8)?;
    // Compared by bits: −0 is not a byte.
    ((f64::from(byte) / BYTE).to_bits() == channel.to_bits()).then_some(byte)
}
