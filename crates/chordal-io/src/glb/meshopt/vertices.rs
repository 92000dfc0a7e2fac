//! The vertex codec: rows of bytes as differences to the previous row, packed in groups of sixteen.
use super::packed_bytes::{PackedBytes, split};

/// Rows in a group. This and the next two: defined by the format.
pub(super) const GROUP: usize = 16;
/// The most rows in a block.
pub(super) const BLOCK_ROWS: usize = 256;
/// The most bytes that the rows of a block have.
pub(super) const BLOCK_BYTES: usize = 8192;

/// The least length of the tail by version; a shorter tail is padded with zeros at its start. Defined by the
/// format.
pub(super) const LEAST_TAIL: [usize; 2] = [32, 24];

/// The number of bits per difference in a group, by the two bits of the group's header.
pub(super) const BITS_V0: [u8; 4] = [0, 2, 4, 8];
/// The same in version 1, by the control mode of the byte.
const BITS_V1: [[u8; 4]; 2] = [[0, 1, 2, 4], [1, 2, 4, 8]];

/// The differences of one byte of each row in a block.
type BlockDeltas = [u8; BLOCK_ROWS];

/// How the four bytes of a channel are computed from those of the previous row.
#[derive(Clone, Copy)]
enum ChannelMode {
    /// Each byte by its own difference.
    Bytes,
    /// Two numbers of 16 bits, each by its own difference.
    Words,
    /// A number of 32 bits, by the exclusive or with the previous one, rotated left by this many bits.
    Xor(u32),
}

impl ChannelMode {
    fn from_byte(byte: u8) -> Result<Self, String> {
        Ok(match (byte & 0x0F, byte >> 4) {
            (0, 0) => Self::Bytes,
            (1, 0) => Self::Words,
            (2, rotation) => Self::Xor(u32::from(rotation)),
            _ => return Err(format!("{byte:#04x} is no mode of a channel")),
        })
    }

    /// The next four bytes of a channel.
    fn next(self, last: [u8; 4], delta: [u8; 4]) -> [u8; 4] {
        match self {
            Self::Bytes => std::array::from_fn(|k| last[k].wrapping_add(unzigzag(delta[k].into()) as u8)),
            Self::Words => {
                let word = |k: usize| {
                    let last = u16::from_le_bytes([last[k], last[k + 1]]);
                    let delta = u16::from_le_bytes([delta[k], delta[k + 1]]);
                    last.wrapping_add(unzigzag(delta)).to_le_bytes()
                };
                let ([a, b], [c, d]) = (word(0), word(2));
                [a, b, c, d]
            }
            Self::Xor(rotation) => {
                let changed = u32::from_le_bytes(delta).rotate_right(rotation);
                (u32::from_le_bytes(last) ^ changed).to_le_bytes()
            }
        }
    }
}

/// Differences are stored with the sign in the lowest bit. Decoding in 16 bits is correct for 8 bits too,
/// since only copies of the sign are cut off.
fn unzigzag(x: u16) -> u16 {
    (x >> 1) ^ (x & 1).wrapping_neg()
}

/// Decodes rows of `stride` bytes, a multiple of 4 up to 256.
pub(super) fn decode(stream: &[u8], stride: usize, out: &mut [u8]) -> Result<(), String> {
    let n_channels = stride / 4;
    let n_tail = |version: u8| stride + if version == 0 { 0 } else { n_channels };
    let padded = |version: u8| n_tail(version).max(LEAST_TAIL[usize::from(version)]);
    let (version, body, tail) = split(stream, 0xA0, padded)?;
    // A short tail is padded at its start, so the end is what counts.
    let (first_row, modes) = tail[tail.len() - n_tail(version)..].split_at(stride);
    let mut row = first_row.to_vec();
    let modes = if version == 0 {
        vec![ChannelMode::Bytes; n_channels]
    } else {
        modes.iter().map(|byte| ChannelMode::from_byte(*byte)).collect::<Result<_, _>>()?
    };
    let mut packed = PackedBytes(body);
    let block_rows = (BLOCK_BYTES / stride / GROUP * GROUP).min(BLOCK_ROWS);
    for block in out.chunks_mut(block_rows * stride) {
        let n = block.len() / stride;
        let controls = if version == 0 { None } else { Some(packed.take(n_channels)?) };
        for (channel, mode) in modes.iter().enumerate() {
            let mut deltas: [BlockDeltas; 4] = [[0; BLOCK_ROWS]; 4];
            for (k, deltas) in deltas.iter_mut().enumerate() {
                // Two bits of the channel's control byte for each of its four bytes.
                let control = controls.map(|controls| controls[channel] >> (2 * k) & 3);
                read_deltas(&mut packed, control, &mut deltas[..n.next_multiple_of(GROUP)], n)?;
            }
            let at = 4 * channel;
            let mut last = [row[at], row[at + 1], row[at + 2], row[at + 3]];
            for (i, row) in block.chunks_exact_mut(stride).enumerate() {
                last = mode.next(last, deltas.each_ref().map(|deltas| deltas[i]));
                row[at..at + 4].copy_from_slice(&last);
            }
            // The next block continues with differences to this row.
            row[at..at + 4].copy_from_slice(&last);
        }
    }
    packed.end()
}

/// Reads the differences of one byte position of a block of `n` rows into `deltas`, which holds zeros. There
/// is no control mode in version 0.
fn read_deltas(
    packed: &mut PackedBytes<'_>,
    control: Option<u8>,
    deltas: &mut [u8],
    n: usize,
) -> Result<(), String> {
    let bits = match control {
        None => BITS_V0,
        // All differences are 0.
        Some(2) => return Ok(()),
        // The differences are stored as they are.
        Some(3) => {
            deltas[..n].copy_from_slice(packed.take(n)?);
            return Ok(());
        }
        Some(control) => BITS_V1[usize::from(control & 1)],
    };
    let headers = packed.take((deltas.len() / GROUP).div_ceil(4))?;
    for (g, group) in deltas.chunks_exact_mut(GROUP).enumerate() {
        let header = headers[g / 4] >> (2 * (g % 4)) & 3;
        match bits[usize::from(header)] {
            0 => {}
            8 => group.copy_from_slice(packed.take(GROUP)?),
            bits => read_group(packed, bits, group)?,
        }
    }
    Ok(())
}

/// Reads a group of sixteen differences of 1, 2 or 4 bits. A difference with all bits set is an escape: its
/// byte follows after the sixteen.
fn read_group(packed: &mut PackedBytes<'_>, bits: u8, group: &mut [u8]) -> Result<(), String> {
    let per_byte = 8 / bits;
    let all_set = (1 << bits) - 1;
    let short = packed.take(GROUP / usize::from(per_byte))?;
    for (i, delta) in group.iter_mut().enumerate() {
        let place = i as u8 % per_byte;
        // Single bits are stored from the lowest up, others from the highest down.
        let shift = if bits == 1 { place } else { 8 - bits * (place + 1) };
        *delta = short[i / usize::from(per_byte)] >> shift & all_set;
        if *delta == all_set {
            *delta = packed.byte()?;
        }
    }
    Ok(())
}
