//! Decompression for USD's binary form: LZ4 blocks in chunks, and integers as differences.
//!
//! Source: Y. Collet, *LZ4 Block Format Description*, 2015 to 2022; the chunks and the integers are those of
//! Pixar's OpenUSD (`pxr/base/tf/fastCompression`, `pxr/usd/sdf/integerCoding`), 2017 to 2024.
use crate::ReadError;
use crate::grow::with_room;
use crate::{FileLocation, text::grouped};

/// The number of bytes that may still be unpacked.
#[derive(Debug)]
pub(super) struct UnpackBudget {
    left: std::cell::Cell<u64>,
}

/// The bytes that may be unpacked whatever the size of the file. Chosen: small enough for the memory that any
/// reader may take.
const SMALL: u64 = 2 << 20;
/// The most unpacked bytes for each byte of the file. Chosen: as for zip packages here; LZ4 packs at most 255
/// to 1.
const MOST_RATIO: u64 = 200;

impl UnpackBudget {
    pub(super) fn new(n_bytes: usize, limit: u64) -> Self {
        let allowance = SMALL + MOST_RATIO.saturating_mul(n_bytes as u64);
        Self { left: std::cell::Cell::new(allowance.min(limit)) }
    }

    /// Charges bytes that are about to be unpacked.
    ///
    /// # Errors
    /// `too-dense` if there are too many.
    pub(super) fn take(&self, n_bytes: u64, at: usize) -> Result<(), ReadError> {
        let left = self.left.get().checked_sub(n_bytes).ok_or_else(|| {
            let message = format!(
                "{} bytes unpack from here, which is more than the file may unpack to: {MOST_RATIO} times its size",
                grouped(n_bytes)
            );
            ReadError::new("too-dense", FileLocation::Byte(at as u64), message)
        })?;
        self.left.set(left);
        Ok(())
    }
}

/// Unpacks LZ4 chunks to at most `n` bytes, which the budget has allowed. `None` if they are damaged.
pub(super) fn unpack_chunks(packed: &[u8], n: usize) -> Result<Option<Vec<u8>>, ReadError> {
    let mut out = with_room(n)?;
    let Some((&n_chunks, mut rest)) = packed.split_first() else { return Ok(None) };
    if n_chunks == 0 {
        return Ok(lz4_block(rest, n, &mut out).map(|()| out));
    }
    for _ in 0..n_chunks {
        let Some((size, after)) = rest.split_first_chunk::<4>() else { return Ok(None) };
        let size = usize::try_from(i32::from_le_bytes(*size)).unwrap_or(usize::MAX);
        let Some(chunk) = after.get(..size) else { return Ok(None) };
        if lz4_block(chunk, n, &mut out).is_none() {
            return Ok(None);
        }
        rest = &after[size..];
    }
    Ok(Some(out))
}

/// The shortest match.
const LEAST_MATCH: usize = 4;
/// The value of a token's four bits that means that more bytes follow.
const MORE: usize = 15;

/// Appends one unpacked block, up to `most` bytes in all, for which memory is reserved.
fn lz4_block(packed: &[u8], most: usize, out: &mut Vec<u8>) -> Option<()> {
    let start = out.len();
    let mut at = 0;
    let length = |first: usize, at: &mut usize| {
        let mut n = first;
        if first == MORE {
            loop {
                let byte = *packed.get(*at)?;
                *at += 1;
                n = n.checked_add(usize::from(byte))?;
                if byte < u8::MAX {
                    break;
                }
            }
        }
        Some(n)
    };
    while at < packed.len() {
        let token = usize::from(packed[at]);
        at += 1;
        let n_literals = length(token >> 4, &mut at)?;
        let literals = packed.get(at..at.checked_add(n_literals)?)?;
        if literals.len() > most - out.len() {
            return None;
        }
        out.extend_from_slice(literals);
        at += n_literals;
        // The last sequence of a block has only literals.
        if at == packed.len() {
            return Some(());
        }
        let offset = usize::from(u16::from_le_bytes([*packed.get(at)?, *packed.get(at + 1)?]));
        at += 2;
        let n_match = length(token & MORE, &mut at)?.checked_add(LEAST_MATCH)?;
        if offset == 0 || offset > out.len() - start || n_match > most - out.len() {
            return None;
        }
        let from = out.len() - offset;
        // One byte at a time, since a match may overlap its own output.
        for i in 0..n_match {
            out.push(out[from + i]);
        }
    }
    Some(())
}

/// The largest size of `n` packed integers before LZ4: the common difference, two bits each, and the
/// integers.
pub(super) fn packed_size<const W: usize>(n: usize) -> Option<usize> {
    W.checked_add(n.checked_add(3)? / 4)?.checked_add(n.checked_mul(W)?)
}

/// Integers of W bytes, each the sum of the previous one and a difference: the common one, or one in three
/// sizes.
pub(super) fn integers<const W: usize>(bytes: &[u8], n: usize) -> Result<Option<Vec<i64>>, ReadError> {
    let mut out = with_room(n)?;
    // Four two-bit codes per byte.
    let n_codes = n.div_ceil(4);
    let (Some(common), Some(codes), Some(rest)) =
        (bytes.get(..W), bytes.get(W..W + n_codes), bytes.get(W + n_codes..))
    else {
        return Ok(None);
    };
    let common = signed(common);
    let (mut value, mut at) = (0_i64, 0);
    for i in 0..n {
        // The sizes are a quarter, a half and all of W bytes, but at least one byte and, for 64-bit integers,
        // at least two.
        let size = match codes[i / 4] >> (2 * (i % 4)) & 3 {
            0 => 0,
            1 => W / 4,
            2 => W / 2,
            _ => W,
        };
        let change = if size == 0 {
            common
        } else {
            let Some(raw) = rest.get(at..at + size) else { return Ok(None) };
            at += size;
            signed(raw)
        };
        value = value.wrapping_add(change);
        if W == 4 {
            // The writer's arithmetic wraps, too.
            value = i64::from(value as i32);
        }
        out.push(value);
    }
    Ok(Some(out))
}

/// A signed little-endian integer.
fn signed(raw: &[u8]) -> i64 {
    let bits = raw.iter().rev().fold(0_u64, |value, byte| value << 8 | u64::from(*byte));
    let shift = 64 - 8 * raw.len() as u32;
    (bits << shift) as i64 >> shift
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_copies_literals_and_what_came_before() {
        // Three literals, then nine bytes from three back, then one literal.
        let block = [0, 0x35, b'a', b'b', b'c', 3, 0, 0x10, b'x'];
        let out = unpack_chunks(&block, 13).unwrap().unwrap();
        assert_eq!(out, b"abcabcabcabcx");
        for broken in [&block[..4], &block[..6], &[0, 0x35, b'a', b'b', b'c', 4, 0, 0x10, b'x'], &[]] {
            assert_eq!(unpack_chunks(broken, 13).unwrap(), None);
        }
        assert_eq!(unpack_chunks(&block, 12).unwrap(), None);
    }

    #[test]
    fn integers_are_sums_of_differences() {
        // The common difference is 1; then −3 in one byte, and 300 in two.
        let bytes = [1, 0, 0, 0, 0b10_01_00_00, 0xFD, 0x2C, 0x01];
        assert_eq!(integers::<4>(&bytes, 4).unwrap().unwrap(), [1, 2, -1, 299]);
        assert_eq!(integers::<4>(&bytes[..7], 4).unwrap(), None);
        assert_eq!(integers::<4>(&bytes, 400).unwrap(), None);
    }
}
