//! `ArrayDecoder`: the bytes of one array, out of text, base64 or raw data, packed or not.
use super::document::{Appended, VtiArray, VtiDocument};
use crate::text::{grouped, is_space, show};
use crate::unpack_cap::UnpackCap;
use crate::volume::element::{Endian, SampleType};
use crate::volume::inflate::InflateReader;
use crate::volume::text_bytes::{check_count, text_bytes};
use crate::{FileLocation, ReadError};

/// The bytes unpacked at once.
const STEP: usize = 1 << 15;

/// How the arrays of a file are stored.
pub(super) struct ArrayDecoder<'d, 'a> {
    pub bytes: &'a [u8],
    pub document: &'d VtiDocument<'a>,
    pub endian: Endian,
    /// Bytes of a number in front of data: 4 or 8.
    pub header: usize,
    pub is_packed: bool,
}

impl ArrayDecoder<'_, '_> {
    /// The bytes of an array of `declared` samples; those of text are little-endian.
    ///
    /// # Errors
    /// When there are other bytes than so many, or they are damaged.
    pub(super) fn decode(
        &self,
        array: &VtiArray,
        element: SampleType,
        declared: u64,
    ) -> Result<Vec<u8>, ReadError> {
        let format = array.element.get("format").unwrap_or("ascii");
        let wanted = declared.saturating_mul(element.width() as u64);
        let text = &self.bytes[array.text.clone()];
        match format {
            "ascii" => {
                let place = FileLocation::Byte(array.text.end as u64);
                let bytes = text_bytes(text, element, array.text.start)?;
                check_count((bytes.len() / element.width()) as u64, declared, &place)?;
                Ok(bytes)
            }
            "binary" => {
                let mut data = BlockSource {
                    bytes: text,
                    at: 0,
                    start: array.text.start,
                    is_base64: true,
                    held: Vec::new(),
                };
                let bytes = self.blocks(&mut data, wanted)?;
                data.expect_end()?;
                Ok(bytes)
            }
            "appended" => {
                let mut data = self.appended(array)?;
                self.blocks(&mut data, wanted)
            }
            other => {
                let message = format!(
                    "the format {} is not known: ascii, binary and appended are",
                    show(other.as_bytes())
                );
                Err(self.document.error("unsupported", &array.element, message))
            }
        }
    }

    fn appended(&self, array: &VtiArray) -> Result<BlockSource<'_>, ReadError> {
        let wrong = |message: String| self.document.error("bad-offset", &array.element, message);
        let Some(Appended { start, is_base64 }) = self.document.appended else {
            return Err(wrong("the file has no appended data".to_owned()));
        };
        let said = self.document.need(&array.element, "offset")?;
        let offset = said.trim().parse::<usize>().ok().and_then(|offset| offset.checked_add(start));
        let at = offset.filter(|at| *at <= self.bytes.len());
        let at =
            at.ok_or_else(|| wrong(format!("the offset {} is not in the file", show(said.as_bytes()))))?;
        Ok(BlockSource { bytes: &self.bytes[at..], at: 0, start: at, is_base64, held: Vec::new() })
    }

    /// Data with its sizes in front.
    fn blocks(&self, data: &mut BlockSource<'_>, wanted: u64) -> Result<Vec<u8>, ReadError> {
        let place = data.place();
        let other_size = |there: u64| {
            let message =
                format!("the array has {} bytes, its samples take {}", grouped(there), grouped(wanted));
            Err(ReadError::new("size-mismatch", place.clone(), message))
        };
        if !self.is_packed {
            let there = self.number(data)?;
            return if there == wanted { data.take(there) } else { other_size(there) };
        }
        let (n_blocks, size, last) = (self.number(data)?, self.number(data)?, self.number(data)?);
        // The size of the last block is 0 where it is as large as the others.
        let n_whole = n_blocks.saturating_sub(u64::from(last > 0));
        let there = n_whole.checked_mul(size).and_then(|all| all.checked_add(last)).unwrap_or(u64::MAX);
        if there != wanted {
            return other_size(there);
        }
        let mut sizes = Vec::new();
        for _ in 0..n_blocks {
            crate::grow::push(&mut sizes, self.number(data)?)?;
        }
        data.restart();
        let mut all = Vec::new();
        for (block, n_packed) in sizes.into_iter().enumerate() {
            let is_last = block as u64 + 1 == n_blocks && last > 0;
            let place = data.place();
            let packed = data.take(n_packed)?;
            unpack(&packed, if is_last { last } else { size }, &place, &mut all)?;
        }
        Ok(all)
    }

    fn number(&self, data: &mut BlockSource<'_>) -> Result<u64, ReadError> {
        let bytes = data.take(self.header as u64)?;
        Ok(match self.header {
            4 => u64::from(u32::from_le_bytes(self.endian.array(&bytes))),
            _ => u64::from_le_bytes(self.endian.array(&bytes)),
        })
    }
}

/// Unpacks a block of `size` bytes to the end of `all`.
fn unpack(packed: &[u8], size: u64, place: &FileLocation, all: &mut Vec<u8>) -> Result<(), ReadError> {
    let refused = |code, message: String| ReadError::new(code, place.clone(), message);
    let cap = UnpackCap::VOLUME;
    let n_packed = packed.len() as u64;
    if cap.is_too_dense(size, n_packed) {
        return Err(refused("too-dense", format!("a block {}", cap.too_dense(n_packed))));
    }
    let mut inflater = InflateReader::zlib(packed, 0);
    let mut step = [0; STEP];
    let mut there = 0;
    loop {
        let n = inflater.fill(&mut step).map_err(|error| ReadError { place: place.clone(), ..error })?;
        there += n as u64;
        if there > size || n < STEP && there < size {
            let message = format!("a block does not unpack to its {} bytes", grouped(size));
            return Err(refused("size-mismatch", message));
        }
        all.try_reserve(n).map_err(|_| crate::grow::out_of_memory(all.len()))?;
        all.extend_from_slice(&step[..n]);
        if n < STEP {
            return Ok(());
        }
    }
}

/// Bytes that are read from front to back, plain or in base64.
struct BlockSource<'a> {
    bytes: &'a [u8],
    at: usize,
    /// The byte of the file at which they start.
    start: usize,
    is_base64: bool,
    /// Up to two decoded bytes that were not taken yet.
    held: Vec<u8>,
}

impl BlockSource<'_> {
    fn place(&self) -> FileLocation {
        FileLocation::Byte((self.start + self.at) as u64)
    }

    /// The next text in base64 begins: what is left of the last one is no data.
    fn restart(&mut self) {
        self.held.clear();
    }

    /// The next `n` bytes.
    fn take(&mut self, n: u64) -> Result<Vec<u8>, ReadError> {
        let truncated = |source: &Self| {
            let message = format!("the array is cut off: {} bytes more are expected", grouped(n));
            ReadError::new("truncated", source.place(), message)
        };
        let n = usize::try_from(n).ok().filter(|n| *n <= self.bytes.len() - self.at + self.held.len());
        let n = n.ok_or_else(|| truncated(self))?;
        if !self.is_base64 {
            let taken = self.bytes[self.at..self.at + n].to_vec();
            self.at += n;
            return Ok(taken);
        }
        let mut taken = std::mem::take(&mut self.held);
        taken.try_reserve(n).map_err(|_| crate::grow::out_of_memory(n))?;
        while taken.len() < n {
            if !self.group(&mut taken)? {
                return Err(truncated(self));
            }
        }
        self.held = taken.split_off(n);
        Ok(taken)
    }

    /// Decodes the next four letters; false at the end.
    fn group(&mut self, out: &mut Vec<u8>) -> Result<bool, ReadError> {
        let (mut bits, mut n_letters, mut n_pads) = (0_u32, 0, 0);
        while n_letters + n_pads < 4 {
            let Some(byte) = self.bytes.get(self.at).copied().filter(|b| *b != b'<') else {
                if n_letters == 0 {
                    return Ok(false);
                }
                return Err(ReadError::new("bad-base64", self.place(), "base64 that ends inside a byte"));
            };
            let six = match byte {
                _ if is_space(byte) => {
                    self.at += 1;
                    continue;
                }
                b'=' if n_letters >= 2 => {
                    n_pads += 1;
                    self.at += 1;
                    continue;
                }
                b'A'..=b'Z' if n_pads == 0 => byte - b'A',
                b'a'..=b'z' if n_pads == 0 => byte - b'a' + 26,
                b'0'..=b'9' if n_pads == 0 => byte - b'0' + 52,
                b'+' if n_pads == 0 => 62,
                b'/' if n_pads == 0 => 63,
                _ => {
                    let message = format!("{} is no letter of base64", show(&[byte]));
                    return Err(ReadError::new("bad-base64", self.place(), message));
                }
            };
            bits = bits << 6 | u32::from(six);
            n_letters += 1;
            self.at += 1;
        }
        bits <<= 6 * n_pads;
        // Four letters are three bytes, from the highest; each padding takes one away.
        out.extend_from_slice(&bits.to_be_bytes()[1..4 - n_pads]);
        Ok(true)
    }

    /// Checks that nothing but space follows.
    fn expect_end(&self) -> Result<(), ReadError> {
        match self.bytes[self.at..].iter().position(|b| !is_space(*b)) {
            None if self.held.is_empty() => Ok(()),
            _ => Err(ReadError::new(
                "trailing-bytes",
                self.place(),
                "the array has more bytes than its samples",
            )),
        }
    }
}
