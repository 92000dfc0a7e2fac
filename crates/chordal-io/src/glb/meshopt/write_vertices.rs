//! The encoder of rows, in version 0 of the format, which every reader supports.
use super::vertices::{BITS_V0, BLOCK_BYTES, BLOCK_ROWS, GROUP, LEAST_TAIL};

/// Encodes at least one row of `stride` bytes, a multiple of 4 up to 256, as the smallest stream of this
/// version. Linear in the number of bytes.
pub(super) fn encode(rows: &[u8], stride: usize) -> Vec<u8> {
    let first = &rows[..stride];
    let mut last = first.to_vec();
    let mut out = Vec::with_capacity(rows.len() / 2 + 64);
    out.push(0xA0);
    let block_rows = (BLOCK_BYTES / stride / GROUP * GROUP).min(BLOCK_ROWS);
    let mut deltas = [0_u8; BLOCK_ROWS];
    for block in rows.chunks(block_rows * stride) {
        let n = block.len() / stride;
        let n_padded = n.next_multiple_of(GROUP);
        for (k, last) in last.iter_mut().enumerate() {
            for (delta, byte) in deltas.iter_mut().zip(block.iter().skip(k).step_by(stride)) {
                *delta = zigzag(byte.wrapping_sub(*last));
                *last = *byte;
            }
            deltas[n..n_padded].fill(0);
            put_column(&deltas[..n_padded], &mut out);
        }
    }
    out.resize(out.len() + LEAST_TAIL[0].saturating_sub(stride), 0);
    out.extend_from_slice(first);
    out
}

/// A difference with its sign in the lowest bit.
fn zigzag(delta: u8) -> u8 {
    (delta << 1) ^ (delta >> 7).wrapping_neg()
}

/// Writes the differences of one byte of each row in a block: two header bits per group, then the groups.
fn put_column(deltas: &[u8], out: &mut Vec<u8>) {
    let at = out.len();
    out.resize(at + (deltas.len() / GROUP).div_ceil(4), 0);
    for (g, group) in deltas.chunks_exact(GROUP).enumerate() {
        let size = |bits: u8| match bits {
            0 if group.iter().all(|delta| *delta == 0) => 0,
            0 => usize::MAX,
            8 => GROUP,
            // Sixteen differences take 2 · `bits` bytes; each that doesn't fit is an escape with a
            // byte of its own.
            bits => 2 * usize::from(bits) + group.iter().filter(|delta| **delta >= all_set(bits)).count(),
        };
        let choice = (0..BITS_V0.len()).min_by_key(|choice| size(BITS_V0[*choice])).unwrap_or(3);
        out[at + g / 4] |= (choice as u8) << (2 * (g % 4));
        match BITS_V0[choice] {
            0 => {}
            8 => out.extend_from_slice(group),
            bits => put_group(group, bits, out),
        }
    }
}

/// The escape value with `bits` bits, after which a whole byte follows.
fn all_set(bits: u8) -> u8 {
    (1 << bits) - 1
}

/// Writes a group of sixteen differences of 2 or 4 bits, the first in the highest bits.
fn put_group(group: &[u8], bits: u8, out: &mut Vec<u8>) {
    let most = all_set(bits);
    let short = |byte: u8, delta: &u8| byte << bits | (*delta).min(most);
    out.extend(group.chunks_exact(usize::from(8 / bits)).map(|deltas| deltas.iter().fold(0, short)));
    out.extend(group.iter().filter(|delta| **delta >= most));
}
