//! Unpacks a block of LZ4, which VTK supports beside zlib.
//!
//! Source: Y. Collet, *LZ4 Block Format Description*, 2019.
use super::array_place::ArrayPlace;
use crate::ReadError;
use crate::grow::push_many;

/// The shortest match; the format's nibble counts from it.
const LEAST_MATCH: usize = 4;
/// The nibble after which more of a length follows, and the byte with the same meaning.
const LONG_NIBBLE: usize = 15;
const LONG_BYTE: u8 = 255;

/// Appends an unpacked block to `out`, at most `most` bytes.
///
/// # Errors
/// `bad-lz4` if it is damaged or longer.
pub(super) fn unpack(
    packed: &[u8],
    out: &mut Vec<u8>,
    most: usize,
    place: ArrayPlace<'_>,
) -> Result<(), ReadError> {
    let first = out.len();
    let bad = |what: &str| ReadError::new("bad-lz4", place.location(), format!("a block of LZ4 {what}"));
    let mut at = 0;
    let cut = "is cut off";
    loop {
        let token = usize::from(*packed.get(at).ok_or_else(|| bad(cut))?);
        at += 1;
        let n = length(packed, &mut at, token >> 4).ok_or_else(|| bad(cut))?;
        let literals = at.checked_add(n).and_then(|end| packed.get(at..end)).ok_or_else(|| bad(cut))?;
        if n > most - (out.len() - first) {
            return Err(bad("unpacks to more bytes than its header says"));
        }
        let start = out.len();
        push_many(out, 0, n)?;
        out[start..].copy_from_slice(literals);
        at += n;
        // Only the last sequence has no match.
        if at == packed.len() {
            return Ok(());
        }
        let offset = match packed.get(at..at + 2) {
            Some(pair) => usize::from(pair[0]) | usize::from(pair[1]) << 8,
            None => return Err(bad(cut)),
        };
        at += 2;
        if offset == 0 || offset > out.len() - first {
            return Err(bad("copies from before its start"));
        }
        let n = length(packed, &mut at, token & LONG_NIBBLE).and_then(|n| n.checked_add(LEAST_MATCH));
        let n = n.ok_or_else(|| bad(cut))?;
        if n > most - (out.len() - first) {
            return Err(bad("unpacks to more bytes than its header says"));
        }
        let from = out.len() - offset;
        push_many(out, 0, n)?;
        // A match may overlap its own output.
        (0..n).for_each(|i| out[from + offset + i] = out[from + i]);
    }
}

/// A length that begins in a nibble.
fn length(packed: &[u8], at: &mut usize, nibble: usize) -> Option<usize> {
    let mut n = nibble;
    if nibble == LONG_NIBBLE {
        loop {
            let more = *packed.get(*at)?;
            *at += 1;
            n = n.checked_add(usize::from(more))?;
            if more != LONG_BYTE {
                break;
            }
        }
    }
    Some(n)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unpacked(packed: &[u8], most: usize) -> Result<Vec<u8>, &'static str> {
        let mut out = b"before".to_vec();
        unpack(packed, &mut out, most, ArrayPlace::Byte(0)).map_err(|error| error.code)?;
        Ok(out.split_off(6))
    }

    #[test]
    fn a_block_is_literals_and_matches() {
        // "ab", then 6 bytes from 2 back, then "c".
        assert_eq!(unpacked(&[0x22, b'a', b'b', 2, 0, 0x10, b'c'], 9).unwrap(), b"ababababc");
        assert_eq!(unpacked(&[0x30, b'x', b'y', b'z'], 3).unwrap(), b"xyz");
        let long = [&[0xF0, 255, 1][..], &[7; 271]].concat();
        assert_eq!(unpacked(&long, 271).unwrap(), [7; 271]);
        assert_eq!(unpacked(&[0], 0).unwrap(), b"");
    }

    #[test]
    fn a_damaged_block_is_refused() {
        let bad: [&[u8]; 7] = [
            &[],
            &[0x30, 1, 2],
            &[0x10, 1, 2, 0],
            &[0x10, 1, 0, 0, 0],
            &[0x10, 1, 1],
            &[0xF0, 255],
            &[0x1F, 1, 1, 0, 255],
        ];
        for packed in bad {
            assert_eq!(unpacked(packed, 1000), Err("bad-lz4"), "{packed:?}");
        }
        assert_eq!(unpacked(&[0x22, b'a', b'b', 2, 0, 0x10, b'c'], 8), Err("bad-lz4"));
        assert_eq!(unpacked(&[0x22, b'a', b'b', 2, 0, 0x10, b'c'], 7), Err("bad-lz4"));
        assert_eq!(unpacked(&[0x22, b'a', b'b', 2, 0, 0x10, b'c'], 1), Err("bad-lz4"));
    }
}
