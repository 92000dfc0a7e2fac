//! `NumberArray`: the numbers of a data array, as packed bytes or parsed from text.
use crate::grow::with_room;
use crate::text::{IntegerError, integer, is_space, number, number_error, show};
use crate::volume::element::{Endian, SampleType, half};
use std::borrow::Cow;

/// The count of numbers converted at once. Chosen: few enough for the L1 cache, and whole rows of one to
/// four.
const BLOCK: usize = 3 << 8;

/// A list of numbers.
#[derive(Clone, Debug)]
pub(crate) enum NumberArray<'a> {
    /// As bytes.
    Packed { kind: SampleType, endian: Endian, bytes: Cow<'a, [u8]> },
    /// Parsed from text, for a floating-point type.
    Reals(Vec<f64>),
    /// Parsed from text, for an integer type.
    Integers(Vec<i64>),
}

/// A token of a text that is not a number of the array's type, with the code and the message.
#[derive(Clone, Debug)]
pub(crate) struct BadToken<'t> {
    pub token: &'t [u8],
    pub code: &'static str,
    pub message: String,
}

/// The whole numbers that a type holds, or `None` for a floating-point type.
fn range(kind: SampleType) -> Option<[i64; 2]> {
    Some(match kind {
        SampleType::Bool => [0, 1],
        SampleType::U8 => [0, i64::from(u8::MAX)],
        SampleType::I8 => [i64::from(i8::MIN), i64::from(i8::MAX)],
        SampleType::U16 => [0, i64::from(u16::MAX)],
        SampleType::I16 => [i64::from(i16::MIN), i64::from(i16::MAX)],
        SampleType::U32 => [0, i64::from(u32::MAX)],
        SampleType::I32 => [i64::from(i32::MIN), i64::from(i32::MAX)],
        // Larger numbers than an i64 holds are refused.
        SampleType::U64 => [0, i64::MAX],
        SampleType::I64 => [i64::MIN, i64::MAX],
        SampleType::F16 | SampleType::F32 | SampleType::F64 => return None,
    })
}

/// Reserves room for the numbers that were counted in a text.
fn room<'t, T>(n: usize) -> Result<Vec<T>, BadToken<'t>> {
    with_room(n).map_err(|error| BadToken {
        token: &[],
        code: error.code,
        message: error.message.to_string(),
    })
}

impl BadToken<'_> {
    /// Its offset in the text that contains it.
    pub(crate) fn at(&self, text: &[u8]) -> usize {
        (self.token.as_ptr() as usize).saturating_sub(text.as_ptr() as usize).min(text.len())
    }
}

impl NumberArray<'_> {
    /// No numbers.
    pub(crate) fn empty() -> Self {
        Self::Reals(Vec::new())
    }

    /// All numbers of a text, separated by space.
    pub(crate) fn from_text(text: &str, kind: SampleType) -> Result<Self, BadToken<'_>> {
        let tokens = || text.as_bytes().split(|b| is_space(*b)).filter(|token| !token.is_empty());
        Self::from_tokens(tokens(), tokens().count(), kind)
    }

    /// The numbers in tokens, with room for `n`, which the bytes of the file can hold. Numbers of a
    /// floating-point type are not rounded to it.
    pub(crate) fn from_tokens<'t>(
        tokens: impl Iterator<Item = &'t [u8]>,
        n: usize,
        kind: SampleType,
    ) -> Result<Self, BadToken<'t>> {
        let Some([low, high]) = range(kind) else {
            let mut reals = room(n)?;
            for token in tokens {
                match number(token) {
                    Some(value) => reals.push(value),
                    None => {
                        let message = number_error(token);
                        return Err(BadToken { token, code: "not-a-number", message });
                    }
                }
            }
            return Ok(Self::Reals(reals));
        };
        let mut integers = room(n)?;
        for token in tokens {
            match integer(token) {
                Ok(value) if (low..=high).contains(&value) => integers.push(value),
                Err(IntegerError::Spelling) => {
                    let message = format!("{} is not a whole number", show(token));
                    return Err(BadToken { token, code: "not-a-number", message });
                }
                _ => {
                    let message = format!("{} is outside its type, {low} to {high}", show(token));
                    return Err(BadToken { token, code: "value-out-of-range", message });
                }
            }
        }
        Ok(Self::Integers(integers))
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Packed { kind, bytes, .. } => bytes.len() / kind.width(),
            Self::Reals(list) => list.len(),
            Self::Integers(list) => list.len(),
        }
    }

    fn field<const N: usize>(&self, i: usize) -> [u8; N] {
        match self {
            Self::Packed { endian, bytes, .. } => endian.array(&bytes[N * i..]),
            Self::Reals(_) | Self::Integers(_) => [0; N],
        }
    }

    /// A number. Integers of 64 bits are rounded to the nearest f64.
    #[inline]
    pub(crate) fn real(&self, i: usize) -> f64 {
        match self {
            Self::Reals(list) => list[i],
            Self::Integers(list) => list[i] as f64,
            Self::Packed { kind: SampleType::F16, .. } => f64::from(half(u16::from_le_bytes(self.field(i)))),
            Self::Packed { kind: SampleType::F32, .. } => f64::from(f32::from_le_bytes(self.field(i))),
            Self::Packed { kind: SampleType::F64, .. } => f64::from_le_bytes(self.field(i)),
            Self::Packed { kind: SampleType::U64, .. } => u64::from_le_bytes(self.field(i)) as f64,
            Self::Packed { .. } => self.integer(i).unwrap_or(0) as f64,
        }
    }

    /// Visits the first `n` numbers in order, in blocks that never split rows of up to four.
    pub(crate) fn each_block(&self, n: usize, mut visit: impl FnMut(&[f64])) {
        let mut block = [0.0; BLOCK];
        for first in (0..n).step_by(BLOCK) {
            let n_here = (n - first).min(BLOCK);
            let numbers = &mut block[..n_here];
            match self {
                Self::Packed { kind: SampleType::F32, endian: Endian::Little, bytes } => {
                    let chunks = bytes[4 * first..].as_chunks().0;
                    numbers.iter_mut().zip(chunks).for_each(|(x, b)| *x = f64::from(f32::from_le_bytes(*b)));
                }
                Self::Packed { kind: SampleType::F64, endian: Endian::Little, bytes } => {
                    let chunks = bytes[8 * first..].as_chunks().0;
                    numbers.iter_mut().zip(chunks).for_each(|(x, b)| *x = f64::from_le_bytes(*b));
                }
                _ => numbers.iter_mut().zip(first..).for_each(|(x, i)| *x = self.real(i)),
            }
            visit(numbers);
        }
    }

    /// A whole number; `None` if the type is not an integer type, or the number does not fit an i64.
    #[inline]
    pub(crate) fn integer(&self, i: usize) -> Option<i64> {
        let Self::Packed { kind, .. } = self else {
            return match self {
                Self::Integers(list) => Some(list[i]),
                _ => None,
            };
        };
        match kind {
            SampleType::Bool | SampleType::U8 => Some(i64::from(u8::from_le_bytes(self.field(i)))),
            SampleType::I8 => Some(i64::from(i8::from_le_bytes(self.field(i)))),
            SampleType::U16 => Some(i64::from(u16::from_le_bytes(self.field(i)))),
            SampleType::I16 => Some(i64::from(i16::from_le_bytes(self.field(i)))),
            SampleType::U32 => Some(i64::from(u32::from_le_bytes(self.field(i)))),
            SampleType::I32 => Some(i64::from(i32::from_le_bytes(self.field(i)))),
            SampleType::U64 => i64::try_from(u64::from_le_bytes(self.field(i))).ok(),
            SampleType::I64 => Some(i64::from_le_bytes(self.field(i))),
            SampleType::F16 | SampleType::F32 | SampleType::F64 => None,
        }
    }

    /// Three whole numbers from `i` on; `None` under the conditions of [`Self::integer`].
    #[inline]
    pub(crate) fn three_integers(&self, i: usize) -> Option<[i64; 3]> {
        match self {
            Self::Packed { kind: SampleType::I32, endian: Endian::Little, bytes } => {
                let [a, b, c, ..] = bytes[4 * i..].as_chunks().0 else { return None };
                let integer = |bytes: &[u8; 4]| i64::from(i32::from_le_bytes(*bytes));
                Some([integer(a), integer(b), integer(c)])
            }
            Self::Packed { kind: SampleType::I64, endian: Endian::Little, bytes } => {
                let [a, b, c, ..] = bytes[8 * i..].as_chunks().0 else { return None };
                Some([i64::from_le_bytes(*a), i64::from_le_bytes(*b), i64::from_le_bytes(*c)])
            }
            _ => Some([self.integer(i)?, self.integer(i + 1)?, self.integer(i + 2)?]),
        }
    }

    /// Whether [`Self::real`] may round.
    pub(crate) fn is_wide(&self) -> bool {
        match self {
            Self::Packed { kind, .. } => matches!(kind, SampleType::I64 | SampleType::U64),
            Self::Integers(_) => true,
            Self::Reals(_) => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_reads_in_both_orders() {
        let little = |kind, bytes: &'static [u8]| NumberArray::Packed {
            kind,
            endian: Endian::Little,
            bytes: Cow::Borrowed(bytes),
        };
        let big = |kind, bytes: &'static [u8]| NumberArray::Packed {
            kind,
            endian: Endian::Big,
            bytes: Cow::Borrowed(bytes),
        };
        let two = [0x12, 0x34];
        assert_eq!(little(SampleType::U16, &[0x34, 0x12]).integer(0), Some(0x1234));
        assert_eq!(big(SampleType::U16, &[0x12, 0x34]).integer(0), Some(i64::from(u16::from_be_bytes(two))));
        assert_eq!(little(SampleType::I8, &[0, 0xff]).integer(1), Some(-1));
        assert_eq!(big(SampleType::I32, &[0xff, 0xff, 0xff, 0xfe]).real(0), -2.0);
        assert_eq!(big(SampleType::F32, &[0x3f, 0x80, 0, 0]).real(0), 1.0);
        assert_eq!(little(SampleType::F64, &[0, 0, 0, 0, 0, 0, 0xf0, 0x3f]).real(0), 1.0);
        assert_eq!(little(SampleType::U64, &[0xff; 8]).integer(0), None);
        assert_eq!(little(SampleType::U64, &[0xff; 8]).real(0), u64::MAX as f64);
        assert_eq!(little(SampleType::F32, &[0; 4]).integer(0), None);
    }

    #[test]
    fn many_at_once_are_those_one_by_one() {
        let bytes: Vec<u8> = (0..20_000_u32).map(|i| (i * i / 7) as u8).collect();
        for kind in [SampleType::U8, SampleType::I32, SampleType::I64, SampleType::F32, SampleType::F64] {
            for endian in [Endian::Little, Endian::Big] {
                let array = NumberArray::Packed { kind, endian, bytes: Cow::Borrowed(&bytes) };
                let n = array.len() - 1;
                let mut reals = Vec::new();
                array.each_block(n, |block| reals.extend(block.iter().map(|x| x.to_bits())));
                assert_eq!(reals, (0..n).map(|i| array.real(i).to_bits()).collect::<Vec<_>>(), "{kind:?}");
                for i in 0..n - 1 {
                    let one_by_one = [i, i + 1, i + 2].map(|i| array.integer(i));
                    assert_eq!(
                        array.three_integers(i).map(|three| three.map(Some)).unwrap_or_default(),
                        one_by_one
                    );
                }
            }
        }
    }

    #[test]
    fn text_is_held_against_its_type() {
        let read = NumberArray::from_text;
        assert_eq!(read(" 1\n-2\t3 ", SampleType::I8).unwrap().len(), 3);
        assert_eq!(read("1.5 nan", SampleType::F32).unwrap().real(0), 1.5);
        for (text, kind, code) in [
            ("1 300", SampleType::U8, "value-out-of-range"),
            ("1 2.5", SampleType::I32, "not-a-number"),
            ("1 x", SampleType::F64, "not-a-number"),
        ] {
            let bad = read(text, kind).unwrap_err();
            assert_eq!((bad.at(text.as_bytes()), bad.code), (2, code));
        }
    }
}
