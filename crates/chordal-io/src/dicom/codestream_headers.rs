//! The headers of a codestream of JPEG 2000, which say how much a decoder allocates before it decodes.
//!
//! Source: ITU, *Recommendation T.800*, 2019, annex A.
use std::borrow::Cow;

/// The start of a codestream, and of its first marker segment.
const START: [u8; 4] = [0xFF, 0x4F, 0xFF, 0x51];
/// The most tiles. Defined by the standard, table A.4: numbers of tiles have 16 bits.
const MOST_TILES: u64 = 65_535;
/// The most decomposition levels. Defined by the standard, table A.15.
const MOST_LEVELS: u8 = 32;
/// The longest segment of step sizes of one component. Defined by the standard, A.6.5.
const LONGEST_STEPS: usize = 198;
/// The most blocks of coefficients, counted for each layer. Chosen: 32 times those that other programs make of
/// the largest frame in one layer, 64 by 64 coefficients each.
const MOST_BLOCKS: u64 = 1 << 17;

/// The marker segments that are looked into, all of the main header and of the headers of tile parts.
const SIZE: u8 = 0x51;
const STYLE: u8 = 0x52;
const STYLE_OF_COMPONENT: u8 = 0x53;
const STEPS: u8 = 0x5C;
const STEPS_OF_COMPONENT: u8 = 0x5D;
const REGION: u8 = 0x5E;
const TILE_PART: u8 = 0x90;
const DATA: u8 = 0x93;
const END: u8 = 0xD9;

/// The sign and the bits of the samples of a codestream that has one component, `size` samples and headers
/// that a decoder can afford.
///
/// # Errors
/// If there are more components, its headers are damaged, or a decoder would allocate far more than samples.
pub(super) fn check(packed: &[u8], size: (u64, u64)) -> Result<(bool, u8), String> {
    let header = packed.get(..45).filter(|header| header.starts_with(&START));
    let Some(header) = header else { return Err("are no codestream of JPEG 2000".to_owned()) };
    let n_components = number(&header[40..42]);
    let bits = (header[42] & 0x7F) + 1;
    if n_components != 1 {
        return Err(format!("are {n_components} components of {bits} bits; one is read"));
    }
    // Both sizes of the grid, the offset of the picture, the size of a tile, and the offset of the first one.
    let grid: [u64; 8] = std::array::from_fn(|k| number(&header[8 + 4 * k..12 + 4 * k]));
    let n_along = |k: usize| grid[k].saturating_sub(grid[6 + k]).div_ceil(grid[4 + k].max(1));
    if header[43..] != [1, 1] || n_along(0).saturating_mul(n_along(1)) > MOST_TILES {
        return Err(format!("are subsampled, or have more than {MOST_TILES} tiles"));
    }
    let mut most = BuildingBlocks::default();
    for_each_segment(packed, |marker, _, segment| most.add(marker, segment, size))?;
    let n_packets = most.precincts.saturating_mul(most.layers);
    // Every packet has a byte or more.
    if n_packets > packed.len() as u64 {
        return Err(format!("have {n_packets} packets in {} bytes", packed.len()));
    }
    let n_blocks = most.blocks.saturating_mul(most.layers);
    if n_blocks > MOST_BLOCKS {
        return Err(format!("have {n_blocks} blocks of coefficients; {MOST_BLOCKS} are the most"));
    }
    Ok((header[42] & 0x80 != 0, bits))
}

/// A codestream whose headers were checked, with the length of its last part of a tile and the marker of its end,
/// which some programs leave out. A part without a length is as long as the marker of the end says, or it could be
/// cut off.
///
/// # Errors
/// If its headers are damaged, or a part has no length and no end.
pub(super) fn completed(packed: &[u8]) -> Result<Cow<'_, [u8]>, String> {
    let mut unstated = None;
    let end = for_each_segment(packed, |marker, at, segment| {
        if marker == TILE_PART && number(&segment[2..6]) == 0 {
            unstated = Some(at);
        }
        Ok(())
    })?;
    if let Some(at) = unstated {
        let padded = packed.strip_suffix(&[0]).unwrap_or(packed);
        let body = [packed, padded].into_iter().find_map(|all| all.strip_suffix(&[0xFF, END]));
        let mut whole = body.ok_or_else(damaged)?.to_vec();
        let length = (whole.len() - at) as u32;
        whole[at + 6..at + 10].copy_from_slice(&length.to_be_bytes());
        whole.extend([0xFF, END]);
        return Ok(Cow::Owned(whole));
    }
    match packed.len().checked_sub(end) {
        // One byte is padding.
        Some(0 | 1) => Ok(Cow::Owned([&packed[..end], &[0xFF, END]].concat())),
        _ => Ok(Cow::Borrowed(packed)),
    }
}

/// The number in big-endian bytes.
fn number(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0, |number, byte| number << 8 | u64::from(*byte))
}

fn damaged() -> String {
    "have damaged headers of JPEG 2000".to_owned()
}

/// Calls `f` with the marker, the byte and the content of every segment of all headers, and returns the byte where
/// they end.
fn for_each_segment(
    packed: &[u8],
    mut f: impl FnMut(u8, usize, &[u8]) -> Result<(), String>,
) -> Result<usize, String> {
    let mut at = 2;
    let mut part_end = 0;
    while let Some(&[first, marker]) = packed.get(at..at + 2) {
        match (first, marker) {
            (0xFF, END) if at >= part_end => break,
            // The rest of a part of a tile is packed.
            (0xFF, DATA) if part_end > at => at = part_end,
            (0xFF, 0x30..=0x3F) => at += 2,
            (0xFF, _) if marker != DATA && marker != END => {
                let length = packed.get(at + 2..at + 4).map_or(0, number) as usize;
                if length < 2 {
                    return Err(damaged());
                }
                let segment = packed.get(at + 4..at + 2 + length).ok_or_else(damaged)?;
                f(marker, at, segment)?;
                if marker == TILE_PART {
                    // The second number is the length, or 0 for all that is left.
                    let n = number(&segment[2..6]) as usize;
                    part_end = if n == 0 { packed.len() } else { at + n };
                }
                at += 2 + length;
            }
            _ => return Err(damaged()),
        }
    }
    Ok(at)
}

/// The most layers, precincts, and blocks in a layer, that any header states.
#[derive(Default)]
struct BuildingBlocks {
    layers: u64,
    precincts: u64,
    blocks: u64,
}

impl BuildingBlocks {
    /// Takes a segment into account. Its length must be that of its content, so that no decoder sees other
    /// segments.
    fn add(&mut self, marker: u8, segment: &[u8], size: (u64, u64)) -> Result<(), String> {
        let is_whole = match marker {
            SIZE => segment.len() == 39,
            TILE_PART => segment.len() == 8,
            REGION => segment.len() == 3,
            STEPS | STEPS_OF_COMPONENT => {
                are_steps(&segment[usize::from(marker != STEPS).min(segment.len())..])
            }
            STYLE => segment.len() >= 10 && self.add_style(segment[0], &segment[5..], size),
            STYLE_OF_COMPONENT => segment.len() >= 7 && self.add_style(segment[1], &segment[2..], size),
            _ => true,
        };
        if marker == STYLE && is_whole {
            self.layers = self.layers.max(number(&segment[2..4]));
        }
        if is_whole { Ok(()) } else { Err(damaged()) }
    }

    /// Takes the levels, blocks and precincts of a style into account; `false` if they do not fill it.
    fn add_style(&mut self, flags: u8, style: &[u8], (width, height): (u64, u64)) -> bool {
        let (levels, precincts) = (style[0], &style[5..]);
        let has_precincts = flags & 1 == 1;
        let n = if has_precincts { usize::from(levels) + 1 } else { 0 };
        if levels > MOST_LEVELS || precincts.len() != n || style[1] > 8 || style[2] > 8 {
            return false;
        }
        // Both are binary logarithms, less 2.
        let block = 1_u64 << (style[1] + style[2] + 4);
        self.blocks = self.blocks.max((width * height).div_ceil(block));
        let of_level = |(k, logs): (usize, &u8)| {
            let scale = 1_u64 << (usize::from(levels) - k);
            let along = |size: u64, log: u8| size.div_ceil(scale).div_ceil(1 << log);
            along(width, logs & 0xF) * along(height, logs >> 4)
        };
        self.precincts = self.precincts.max(precincts.iter().enumerate().map(of_level).sum());
        true
    }
}

/// Whether a segment of step sizes has the length that their kind takes.
fn are_steps(segment: &[u8]) -> bool {
    let Some((kind, steps)) = segment.split_first() else { return false };
    let fits = match kind & 0x1F {
        0 => true,
        1 => steps.len() == 2,
        _ => steps.len() % 2 == 0,
    };
    fits && steps.len() < LONGEST_STEPS
}
