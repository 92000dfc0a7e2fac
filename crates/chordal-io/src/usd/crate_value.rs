//! Values of USD's binary form, which are unpacked when they are needed.
//!
//! Source: Pixar's OpenUSD, `pxr/usd/sdf/crateFile` and `crateDataTypes.h`, 2016 to 2024, for the codes of
//! types and their layout.
use super::crate_tables::{CrateCursor, CrateTables};
use super::layer::UsdReference;
use super::value::{UsdNumbers, UsdValue};
use crate::grow::{push, with_room};
use crate::text::grouped;
use crate::{FileLocation, ReadError};

/// The upper bits of a value: it is an array, it is stored inline in the lower bits, it is compressed.
const IS_ARRAY: u64 = 1 << 63;
const IS_INLINED: u64 = 1 << 62;
const IS_PACKED: u64 = 1 << 61;
/// The number of lower bits, which hold the value or its offset; the type is above them.
const PAYLOAD_BITS: u32 = 48;
const PAYLOAD: u64 = (1 << PAYLOAD_BITS) - 1;
/// Arrays with fewer numbers are not compressed.
const LEAST_PACKED: usize = 16;
/// The version from which arrays have no rank, and the one from which their length has 64 bits.
const NO_RANK: u8 = 5;
const WIDE_LENGTH: u8 = 7;
/// The version from which payloads have time offsets.
const PAYLOAD_SHIFTS: u8 = 8;

/// The storage type of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CrateNumber {
    Byte,
    Int,
    Uint,
    Int64,
    Uint64,
    Half,
    Float,
    Double,
}

impl CrateNumber {
    fn n_bytes(self) -> usize {
        match self {
            Self::Byte => 1,
            Self::Half => 2,
            Self::Int | Self::Uint | Self::Float => 4,
            Self::Int64 | Self::Uint64 | Self::Double => 8,
        }
    }

    fn value(self, raw: &[u8]) -> f64 {
        let bits = raw.iter().rev().fold(0_u64, |value, byte| value << 8 | u64::from(*byte));
        match self {
            Self::Byte | Self::Uint | Self::Uint64 => bits as f64,
            Self::Int => f64::from(bits as u32 as i32),
            Self::Int64 => bits as i64 as f64,
            Self::Half => half(bits as u16),
            Self::Float => f64::from(f32::from_bits(bits as u32)),
            Self::Double => f64::from_bits(bits),
        }
    }
}

/// A number of 16 bits (IEEE 754-2019, binary16).
fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
    // Steps of a subnormal number are 2⁻²⁴; a fraction has ten bits, and the exponent has a bias of 15.
    let size = match exponent {
        0 => libm::ldexp(fraction, -24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => libm::ldexp(1024.0 + fraction, exponent - 25),
    };
    if bits >> 15 == 1 { -size } else { size }
}

/// The meaning of a type's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CrateKind {
    /// Rows of this many numbers; quaternions have their real part last.
    Numbers(CrateNumber, usize),
    Matrix(usize),
    Quaternion(CrateNumber),
    Token,
    String,
    TokenList,
    TimeSamples,
    Blocked,
    Other,
}

fn kind_of(value: u64) -> CrateKind {
    use CrateNumber::{Byte, Double, Float, Half, Int, Int64, Uint, Uint64};
    match value >> PAYLOAD_BITS & 0xFF {
        1 | 2 => CrateKind::Numbers(Byte, 1),
        3 => CrateKind::Numbers(Int, 1),
        4 => CrateKind::Numbers(Uint, 1),
        5 => CrateKind::Numbers(Int64, 1),
        6 => CrateKind::Numbers(Uint64, 1),
        7 => CrateKind::Numbers(Half, 1),
        8 => CrateKind::Numbers(Float, 1),
        9 | 56 => CrateKind::Numbers(Double, 1),
        10 => CrateKind::String,
        // The path of a file is also a token.
        11 | 12 => CrateKind::Token,
        n @ 13..=15 => CrateKind::Matrix(n as usize - 11),
        16 => CrateKind::Quaternion(Double),
        17 => CrateKind::Quaternion(Float),
        18 => CrateKind::Quaternion(Half),
        // Vectors of two, three and four numbers, each in four precisions.
        n @ 19..=30 => {
            let numbers = [Double, Float, Half, Int];
            CrateKind::Numbers(numbers[(n as usize - 19) % 4], (n as usize - 19) / 4 + 2)
        }
        41 => CrateKind::TokenList,
        46 => CrateKind::TimeSamples,
        51 => CrateKind::Blocked,
        _ => CrateKind::Other,
    }
}

/// The bytes of a file with its tables.
#[derive(Clone, Copy)]
pub(super) struct CrateValues<'a> {
    pub bytes: &'a [u8],
    pub tables: &'a CrateTables,
}

impl<'a> CrateValues<'a> {
    /// Whether a value holds time samples.
    pub(super) fn is_samples(value: u64) -> bool {
        kind_of(value) == CrateKind::TimeSamples
    }

    fn cursor(&self, value: u64) -> CrateCursor<'a> {
        CrateCursor::at(self.bytes, value & PAYLOAD)
    }

    /// Unpacks a value.
    ///
    /// # Errors
    /// At the byte where it is truncated or damaged, or unpacks to more than the file may.
    pub(super) fn unpack(&self, value: u64) -> Result<UsdValue, ReadError> {
        match kind_of(value) {
            CrateKind::Numbers(number, width) => self.numbers(value, number, width),
            CrateKind::Matrix(n) => self.matrix(value, n),
            CrateKind::Quaternion(number) => {
                let mut quaternions = self.numbers(value, number, 4)?;
                // The binary form has the real part last, the text form first.
                if let UsdValue::Numbers(numbers) = &mut quaternions {
                    numbers.values.chunks_exact_mut(4).for_each(|row| row.rotate_right(1));
                }
                Ok(quaternions)
            }
            CrateKind::Token | CrateKind::String | CrateKind::TokenList => {
                self.words(value).map(UsdValue::Words)
            }
            CrateKind::Blocked => Ok(UsdValue::Blocked),
            CrateKind::TimeSamples | CrateKind::Other => Ok(UsdValue::Other),
        }
    }

    fn numbers(&self, value: u64, number: CrateNumber, width: usize) -> Result<UsdValue, ReadError> {
        if value & IS_ARRAY != 0 {
            return self.array(value, number, width).map(UsdValue::Numbers);
        }
        let mut values = Vec::new();
        if value & IS_INLINED == 0 {
            let mut cursor = self.cursor(value);
            for _ in 0..width {
                values.push(number.value(cursor.take(number.n_bytes())?));
            }
        } else if width == 1 {
            let raw = (value as u32).to_le_bytes();
            // An inline number of 64 bits is stored in 32.
            let narrow = match number {
                CrateNumber::Double => CrateNumber::Float,
                CrateNumber::Int64 => CrateNumber::Int,
                CrateNumber::Uint64 => CrateNumber::Uint,
                other => other,
            };
            values.push(narrow.value(&raw[..narrow.n_bytes()]));
        } else {
            // One signed byte for each component.
            let raw = (value as u32).to_le_bytes();
            values.extend(raw[..width].iter().map(|byte| f64::from(*byte as i8)));
        }
        Ok(UsdValue::Numbers(UsdNumbers { width, values }))
    }

    fn matrix(&self, value: u64, n: usize) -> Result<UsdValue, ReadError> {
        if value & IS_ARRAY != 0 || value & IS_INLINED == 0 {
            return self.numbers(value, CrateNumber::Double, n * n);
        }
        // The diagonal of a matrix, one byte for each entry.
        let raw = (value as u32).to_le_bytes();
        let mut values = vec![0.0; n * n];
        for (i, byte) in raw[..n].iter().enumerate() {
            values[i * (n + 1)] = f64::from(*byte as i8);
        }
        Ok(UsdValue::Numbers(UsdNumbers { width: n * n, values }))
    }

    /// The length of an array; its elements follow.
    fn length(&self, cursor: &mut CrateCursor<'_>) -> Result<usize, ReadError> {
        if self.tables.version < NO_RANK {
            cursor.u32()?;
        }
        let n = if self.tables.version < WIDE_LENGTH { u64::from(cursor.u32()?) } else { cursor.u64()? };
        usize::try_from(n).ok().filter(|n| *n < u32::MAX as usize).ok_or_else(|| {
            cursor.error("too-many-rows", format!("an array of {} elements is too long", grouped(n)))
        })
    }

    fn array(&self, value: u64, number: CrateNumber, width: usize) -> Result<UsdNumbers, ReadError> {
        let empty = UsdNumbers { width, values: Vec::new() };
        if value & PAYLOAD == 0 {
            return Ok(empty);
        }
        let mut cursor = self.cursor(value);
        let n = self.length(&mut cursor)?;
        if value & IS_PACKED != 0 && n >= LEAST_PACKED && width == 1 {
            return self.packed_array(cursor, number, n);
        }
        let n_values = n.saturating_mul(width);
        let raw = cursor.take(n_values.saturating_mul(number.n_bytes()))?;
        // Many attributes may share the same bytes, so each use is counted.
        self.tables.budget.take(raw.len() as u64, cursor.at)?;
        let mut values = with_room(n_values)?;
        values.extend(raw.chunks_exact(number.n_bytes()).map(|raw| number.value(raw)));
        Ok(UsdNumbers { width, values })
    }

    fn packed_array(
        &self,
        mut cursor: CrateCursor<'_>,
        number: CrateNumber,
        n: usize,
    ) -> Result<UsdNumbers, ReadError> {
        let budget = &self.tables.budget;
        let as_f64 = |integers: Vec<i64>, convert: fn(i64) -> f64| {
            let mut values = with_room(integers.len())?;
            values.extend(integers.into_iter().map(convert));
            Ok::<_, ReadError>(values)
        };
        let values = match number {
            CrateNumber::Int => as_f64(cursor.integers::<4>(n, budget)?, |x| x as f64)?,
            CrateNumber::Uint => as_f64(cursor.integers::<4>(n, budget)?, |x| f64::from(x as u32))?,
            CrateNumber::Int64 => as_f64(cursor.integers::<8>(n, budget)?, |x| x as f64)?,
            CrateNumber::Uint64 => as_f64(cursor.integers::<8>(n, budget)?, |x| x as u64 as f64)?,
            CrateNumber::Byte => return Err(cursor.error("bad-value", "bytes are said to be packed")),
            // Floats that are whole numbers are packed as integers ('i'), few different ones as indices into
            // a table ('t').
            CrateNumber::Half | CrateNumber::Float | CrateNumber::Double => match cursor.u8()? {
                b'i' => as_f64(cursor.integers::<4>(n, budget)?, |x| x as f64)?,
                b't' => {
                    let n_table = cursor.u32()? as usize;
                    let raw = cursor.take(n_table.saturating_mul(number.n_bytes()))?;
                    let at = cursor.at;
                    let rows = cursor.integers::<4>(n, budget)?;
                    let mut values = with_room(n)?;
                    for row in rows {
                        let start =
                            usize::try_from(row).ok().and_then(|row| row.checked_mul(number.n_bytes()));
                        let raw = start.and_then(|start| raw.get(start..start + number.n_bytes()));
                        let raw = raw.ok_or_else(|| {
                            let message = format!("number {row} of a table of {n_table} is asked for");
                            ReadError::new("index-out-of-range", FileLocation::Byte(at as u64), message)
                        })?;
                        values.push(number.value(raw));
                    }
                    values
                }
                other => {
                    return Err(cursor.error("bad-value", format!("numbers are packed in a way {other}")));
                }
            },
        };
        Ok(UsdNumbers { width: 1, values })
    }

    /// Tokens or strings, one or an array.
    pub(super) fn words(&self, value: u64) -> Result<Vec<Box<str>>, ReadError> {
        let kind = kind_of(value);
        let word = |number: u32, at: usize| {
            let tables = self.tables;
            let text = if kind == CrateKind::String { tables.string(number) } else { tables.token(number) };
            text.map(Box::from).ok_or_else(|| {
                let message = format!("word {number} is beyond their table");
                ReadError::new("index-out-of-range", FileLocation::Byte(at as u64), message)
            })
        };
        let is_list = value & IS_ARRAY != 0 || kind == CrateKind::TokenList;
        if !is_list {
            // Writers always inline single words, so no other form is supported.
            return Ok(vec![word(value as u32, 0)?]);
        }
        if value & PAYLOAD == 0 {
            return Ok(Vec::new());
        }
        let mut cursor = self.cursor(value);
        let n = if kind == CrateKind::TokenList { cursor.count(4)? } else { self.length(&mut cursor)? };
        let mut words = Vec::new();
        for _ in 0..n {
            let at = cursor.at;
            let word = word(cursor.u32()?, at)?;
            self.tables.budget.take(4 + word.len() as u64, at)?;
            push(&mut words, word)?;
        }
        Ok(words)
    }

    /// The value of the first time sample.
    pub(super) fn first_sample(&self, value: u64) -> Result<Option<u64>, ReadError> {
        let mut cursor = self.cursor(value);
        // Times and values are stored elsewhere, each behind a relative offset.
        for is_values in [false, true] {
            let at = cursor.at as u64;
            let target = at.wrapping_add(cursor.u64()?);
            if is_values {
                let mut values = CrateCursor::at(self.bytes, target);
                return Ok(if values.u64()? == 0 { None } else { Some(values.u64()?) });
            }
            // After the times comes the relative offset of the values, then the values.
            cursor = CrateCursor::at(self.bytes, target);
            cursor.u64()?;
        }
        Ok(None)
    }

    /// The items of an edited list, which holds tokens or paths (4 bytes each) or references.
    pub(super) fn list_items(&self, value: u64) -> Result<Vec<UsdReference>, ReadError> {
        let mut cursor = self.cursor(value);
        let mut items = Vec::new();
        let kind = value >> PAYLOAD_BITS & 0xFF;
        match kind {
            // A vector of paths, and a single payload.
            40 => {
                for _ in 0..cursor.count(4)? {
                    push(&mut items, self.path_item(&mut cursor)?)?;
                }
                return Ok(items);
            }
            47 => {
                items.push(self.arc_item(&mut cursor, kind)?);
                return Ok(items);
            }
            34 | 35 | 55 => {}
            _ => return Ok(items),
        }
        // The lists that are present: explicit, added, prepended, appended; then deleted and ordered.
        let flags = cursor.u8()?;
        for flag in [2, 4, 32, 64] {
            if flags & flag == 0 {
                continue;
            }
            for _ in 0..cursor.count(4)? {
                let item = match kind {
                    34 => self.path_item(&mut cursor)?,
                    _ => self.arc_item(&mut cursor, kind)?,
                };
                push(&mut items, item)?;
            }
        }
        Ok(items)
    }

    fn path_item(&self, cursor: &mut CrateCursor<'_>) -> Result<UsdReference, ReadError> {
        let at = cursor.at;
        let number = cursor.u32()?;
        let path = self.tables.path(number).ok_or_else(|| {
            let message = format!("path {number} is not in their table, or too long");
            ReadError::new("index-out-of-range", FileLocation::Byte(at as u64), message)
        })?;
        self.tables.budget.take(path.len() as u64, at)?;
        Ok(UsdReference { asset: "".into(), path: path.into() })
    }

    /// A reference or payload.
    fn arc_item(&self, cursor: &mut CrateCursor<'_>, kind: u64) -> Result<UsdReference, ReadError> {
        let asset = self.tables.string(cursor.u32()?).unwrap_or_default().into();
        let number = cursor.u32()?;
        let path = self.tables.path(number).unwrap_or_default();
        self.tables.budget.take(path.len() as u64, cursor.at)?;
        let path = if path == "/" { String::new() } else { path };
        // A time offset of two 8-byte numbers, and the custom data of a reference.
        if kind == 35 || self.tables.version >= PAYLOAD_SHIFTS {
            cursor.take(16)?;
        }
        if kind == 35 && cursor.u64()? != 0 {
            return Err(cursor.error("custom-data", "references with data of their own are not read"));
        }
        Ok(UsdReference { asset, path: path.into() })
    }

    /// The string under a name in a dictionary.
    pub(super) fn string_in(&self, value: u64, name: &str) -> Result<Option<String>, ReadError> {
        if value & PAYLOAD == 0 {
            return Ok(None);
        }
        let mut cursor = self.cursor(value);
        // A name of 4 bytes, and the relative offset of the value in 8.
        for _ in 0..cursor.count(12)? {
            let key = cursor.u32()?;
            let at = cursor.at as u64;
            let target = at.wrapping_add(cursor.u64()?);
            if self.tables.string(key) == Some(name) {
                let value = CrateCursor::at(self.bytes, target).u64()?;
                let is_one = kind_of(value) == CrateKind::String && value & IS_ARRAY == 0;
                let words = if is_one { self.words(value)? } else { Vec::new() };
                return Ok(words.into_iter().next().map(String::from));
            }
        }
        Ok(None)
    }

    /// Pairs of strings: sets of variants with the selected variant.
    pub(super) fn selections(&self, value: u64) -> Result<Vec<[Box<str>; 2]>, ReadError> {
        let mut cursor = self.cursor(value);
        let mut pairs = Vec::new();
        // Two numbers of 4 bytes.
        for _ in 0..cursor.count(8)? {
            let pair = [cursor.u32()?, cursor.u32()?];
            let pair = pair.map(|number| Box::from(self.tables.string(number).unwrap_or_default()));
            push(&mut pairs, pair)?;
        }
        Ok(pairs)
    }
}
