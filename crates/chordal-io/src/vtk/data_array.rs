//! `DataArray`: an array of numbers in a VTK XML file, and `ArrayDecoder`, which decodes it: text, base64 or
//! appended bytes, plain or packed by zlib or LZ4.
//!
//! Source: Kitware, *VTK File Formats*, "XML File Formats", 2005–2024; the byte streams as VTK 9 writes them
//! (`vtkXMLWriter`, `vtkXMLDataParser`).
use super::array_place::ArrayPlace;
use super::encoded_bytes::{BytePacking, EncodedBytes};
use super::lz4;
use super::number_array::NumberArray;
use crate::grow::{push_many, with_room};
use crate::text::{grouped, show};
use crate::unpack_cap::UnpackCap;
use crate::volume::element::{Endian, SampleType};
use crate::xml_text::place;
use crate::{Limits, ReadError};
use flate2::read::ZlibDecoder;
use std::borrow::Cow;
use std::io::{ErrorKind, Read};

/// The compression of the blocks of arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BlockCompressor {
    Zlib,
    Lz4,
}

/// The encoding of the bytes of a file's arrays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArrayEncoding {
    pub endian: Endian,
    /// The type of lengths and sizes before the bytes: `U32` or `U64`.
    pub header: SampleType,
    pub compressor: Option<BlockCompressor>,
}

/// The bytes after the last element of a file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AppendedBytes<'a> {
    pub bytes: &'a [u8],
    /// The offset in the file at which they start.
    pub start: u64,
    pub packing: BytePacking,
}

/// The location of an array's numbers.
#[derive(Clone, Debug)]
pub(crate) enum ArraySource<'a> {
    /// Text in the element, and its offset in the document.
    Text(Cow<'a, str>, usize),
    /// Base64 in the element, and its offset in the document.
    Base64(Cow<'a, str>, usize),
    /// An offset in the appended bytes.
    Appended(u64),
}

/// An array as declared by its element.
#[derive(Clone, Debug)]
pub(crate) struct DataArray<'a> {
    pub name: String,
    /// `None` for types other than numbers of whole bytes: strings, bits.
    pub kind: Option<SampleType>,
    pub n_components: usize,
    pub source: ArraySource<'a>,
    /// The offset in the document at which the element starts.
    pub at: usize,
}

/// The type for a name in a file.
pub(crate) fn number_type(name: &str) -> Option<SampleType> {
    Some(match name {
        "Int8" => SampleType::I8,
        "UInt8" => SampleType::U8,
        "Int16" => SampleType::I16,
        "UInt16" => SampleType::U16,
        "Int32" => SampleType::I32,
        "UInt32" => SampleType::U32,
        "Int64" => SampleType::I64,
        "UInt64" => SampleType::U64,
        "Float32" => SampleType::F32,
        "Float64" => SampleType::F64,
        _ => return None,
    })
}

/// The sizes of compressed blocks.
#[derive(Clone, Debug)]
struct BlockSizes {
    /// The unpacked sizes of each block but the last, and of the last.
    full: u64,
    last: u64,
    packed: Vec<u64>,
}

impl BlockSizes {
    /// The declared unpacked size of all blocks.
    fn n_unpacked(&self) -> u64 {
        let n_whole = (self.packed.len() as u64).saturating_sub(1);
        n_whole.saturating_mul(self.full).saturating_add(self.last)
    }
}

/// Compressed blocks after their sizes.
struct BlockStream<'s, 'b> {
    blocks: BlockSizes,
    stream: &'s mut EncodedBytes<'b>,
}

/// The bytes that are unpacked between two checks of the limits.
const STEP: usize = 1 << 14;

/// Decodes the arrays of one document, and counts their bytes.
#[derive(Clone, Debug)]
pub(crate) struct ArrayDecoder<'a> {
    /// The document, for locations.
    pub text: &'a str,
    pub encoding: ArrayEncoding,
    pub appended: Option<AppendedBytes<'a>>,
    /// The appended bytes that arrays may still use: each byte belongs to one array.
    left_appended: u64,
    /// The number of bytes that may still be unpacked.
    left: u64,
    /// The number of bytes that were unpacked.
    n_decoded: u64,
}

impl<'a> ArrayDecoder<'a> {
    pub(crate) fn new(
        text: &'a str,
        encoding: ArrayEncoding,
        appended: Option<AppendedBytes<'a>>,
        limits: &Limits,
    ) -> Self {
        let left_appended = appended.map_or(0, |appended| appended.bytes.len() as u64);
        Self { text, encoding, appended, left_appended, left: limits.bytes, n_decoded: 0 }
    }

    /// The number of bytes of all decoded arrays; for text, of the text itself.
    pub(crate) fn n_decoded(&self) -> u64 {
        self.n_decoded
    }

    /// An error at the element of an array.
    pub(crate) fn error(&self, array: &DataArray<'_>, code: &'static str, message: &str) -> ReadError {
        let message = format!("data array {}: {message}", show(array.name.as_bytes()));
        ReadError::new(code, place(self.text, array.at), message)
    }

    /// The numbers of an array.
    ///
    /// # Errors
    /// If it is truncated, damaged, beyond the appended bytes or over a limit; if it shares bytes with other
    /// arrays; or if its bytes are not whole numbers of its type.
    pub(crate) fn decode<'s>(&mut self, array: &'s DataArray<'a>) -> Result<NumberArray<'s>, ReadError>
    where
        'a: 's,
    {
        let Some(kind) = array.kind else {
            return Err(self.error(array, "type-unknown", "its type is none of numbers"));
        };
        if let ArraySource::Text(text, at) = &array.source {
            self.spend(array, text.len() as u64)?;
            return NumberArray::from_text(text, kind).map_err(|bad| {
                let message = format!("data array {}: {}", show(array.name.as_bytes()), bad.message);
                ReadError::new(bad.code, place(self.text, at + bad.at(text.as_bytes())), message)
            });
        }
        let bytes = self.bytes(array)?;
        if bytes.len() % kind.width() != 0 {
            let message = format!(
                "its {} bytes are no whole numbers of {} bytes",
                grouped(bytes.len() as u64),
                kind.width()
            );
            return Err(self.error(array, "wrong-width", &message));
        }
        Ok(NumberArray::Packed { kind, endian: self.encoding.endian, bytes })
    }

    /// The bytes of an array that is not text.
    pub(crate) fn bytes<'s>(&mut self, array: &'s DataArray<'a>) -> Result<Cow<'s, [u8]>, ReadError>
    where
        'a: 's,
    {
        self.unpack(array, None)
    }

    /// The bytes of an array that is not text and must have `n` of them.
    ///
    /// # Errors
    /// As [`Self::decode`], and `size-mismatch` before another number of bytes is unpacked.
    pub(crate) fn exact_bytes<'s>(
        &mut self,
        array: &'s DataArray<'a>,
        n: u64,
    ) -> Result<Cow<'s, [u8]>, ReadError>
    where
        'a: 's,
    {
        let bytes = self.unpack(array, Some(n))?;
        self.expect(array, bytes.len() as u64, Some(n))?;
        Ok(bytes)
    }

    /// Refuses an array with a wrong number of bytes.
    fn expect(&self, array: &DataArray<'_>, n: u64, wanted: Option<u64>) -> Result<(), ReadError> {
        match wanted {
            Some(wanted) if n != wanted => {
                let message = format!("it has {} bytes, and its values take {}", grouped(n), grouped(wanted));
                Err(self.error(array, "size-mismatch", &message))
            }
            _ => Ok(()),
        }
    }

    fn unpack<'s>(
        &mut self,
        array: &'s DataArray<'a>,
        wanted: Option<u64>,
    ) -> Result<Cow<'s, [u8]>, ReadError>
    where
        'a: 's,
    {
        let mut stream: EncodedBytes<'s> = match &array.source {
            ArraySource::Text(..) => return Err(self.error(array, "not-bytes", "it is text")),
            ArraySource::Base64(text, at) => {
                let stream =
                    EncodedBytes::new(text.as_bytes(), BytePacking::Base64, ArrayPlace::Text(self.text, *at));
                if stream.is_blank() {
                    return Ok(Cow::Borrowed(&[]));
                }
                stream
            }
            ArraySource::Appended(offset) => {
                let Some(appended) = self.appended else {
                    return Err(self.error(array, "no-appended-data", "the file has no appended data"));
                };
                let rest = usize::try_from(*offset).ok().and_then(|at| appended.bytes.get(at..));
                let Some(rest) = rest else {
                    let message = format!(
                        "its offset {} is beyond the {} bytes of the appended data",
                        grouped(*offset),
                        grouped(appended.bytes.len() as u64)
                    );
                    return Err(self.error(array, "offset-out-of-range", &message));
                };
                EncodedBytes::new(rest, appended.packing, ArrayPlace::Byte(appended.start + offset))
            }
        };
        let bytes = match self.encoding.compressor {
            None => {
                let n = self.size(&mut stream)?;
                self.expect(array, n, wanted)?;
                // Charged by the bytes that are there, whatever the header claims.
                self.spend(array, n.min(stream.n_left()))?;
                stream.take(n)?
            }
            Some(compressor) => {
                let blocks = self.block_sizes(&mut stream)?;
                self.expect(array, blocks.n_unpacked(), wanted)?;
                Cow::Owned(self.blocks(array, compressor, BlockStream { blocks, stream: &mut stream })?)
            }
        };
        if wanted.is_some() && matches!(array.source, ArraySource::Base64(..)) && !stream.is_blank() {
            return Err(self.error(array, "trailing-bytes", "it has more bytes than its values"));
        }
        // Each appended byte belongs to one array, or a small file could be decoded as often as it
        // names itself.
        if let ArraySource::Appended(_) = &array.source {
            match self.left_appended.checked_sub(stream.n_taken()) {
                Some(left) => self.left_appended = left,
                None => {
                    let message = "its bytes in the appended data are those of other arrays too";
                    return Err(self.error(array, "overlapping-arrays", message));
                }
            }
        }
        Ok(bytes)
    }

    /// Charges bytes that are decoded.
    fn spend(&mut self, array: &DataArray<'_>, n: u64) -> Result<(), ReadError> {
        self.n_decoded = self.n_decoded.saturating_add(n);
        match self.left.checked_sub(n) {
            Some(left) => self.left = left,
            None => {
                let message = "the data arrays unpack to more bytes than the limit";
                return Err(self.error(array, "too-large", message));
            }
        }
        Ok(())
    }

    /// The next length or size.
    fn size(&self, stream: &mut EncodedBytes<'_>) -> Result<u64, ReadError> {
        let kind = self.encoding.header;
        let bytes = stream.take(kind.width() as u64)?;
        Ok(match kind {
            SampleType::U64 => u64::from_le_bytes(self.encoding.endian.array(&bytes)),
            _ => u64::from(u32::from_le_bytes(self.encoding.endian.array(&bytes))),
        })
    }

    /// The sizes before the blocks: the number of blocks, the size of each and that of the last if it
    /// differs, and their packed sizes.
    fn block_sizes(&self, stream: &mut EncodedBytes<'_>) -> Result<BlockSizes, ReadError> {
        let n_blocks = self.size(stream)?;
        if n_blocks == 0 {
            return Ok(BlockSizes { full: 0, last: 0, packed: Vec::new() });
        }
        let (full, last) = (self.size(stream)?, self.size(stream)?);
        if n_blocks > stream.n_left() / self.encoding.header.width() as u64 {
            let message = format!("its {} blocks are more than bytes follow", grouped(n_blocks));
            return Err(ReadError::new("truncated", stream.place().location(), message));
        }
        let mut packed: Vec<u64> = with_room(n_blocks as usize)?;
        for _ in 0..n_blocks {
            packed.push(self.size(stream)?);
        }
        Ok(BlockSizes { full, last: if last > 0 { last } else { full }, packed })
    }

    /// Unpacks blocks.
    fn blocks(
        &mut self,
        array: &DataArray<'a>,
        compressor: BlockCompressor,
        packed: BlockStream<'_, '_>,
    ) -> Result<Vec<u8>, ReadError> {
        let BlockStream { blocks, stream } = packed;
        let mut unpacked = Vec::new();
        for (i, n_packed) in blocks.packed.iter().enumerate() {
            let is_last = i + 1 == blocks.packed.len();
            let n = if is_last { blocks.last } else { blocks.full };
            let block_place = stream.place();
            let packed = stream.take(*n_packed)?;
            if UnpackCap::VOLUME.is_too_dense(n, *n_packed) {
                let message = format!("block {i} {}", UnpackCap::VOLUME.too_dense(*n_packed));
                return Err(ReadError::new("too-dense", block_place.location(), message));
            }
            let before = unpacked.len() as u64;
            // A declared size is only an upper limit; memory grows with the bytes that are unpacked.
            let most = n.min(self.left);
            match compressor {
                BlockCompressor::Zlib => inflate(&packed, &mut unpacked, most, block_place)?,
                BlockCompressor::Lz4 => {
                    let most = usize::try_from(most).unwrap_or(usize::MAX);
                    lz4::unpack(&packed, &mut unpacked, most, block_place)?;
                }
            }
            let got = unpacked.len() as u64 - before;
            self.spend(array, got)?;
            if got != n {
                let message = format!(
                    "block {i} of data array {} unpacks to {} bytes, where its header says {}",
                    show(array.name.as_bytes()),
                    grouped(got),
                    grouped(n)
                );
                return Err(ReadError::new("size-mismatch", block_place.location(), message));
            }
        }
        Ok(unpacked)
    }
}

/// Appends an unpacked zlib stream to `out`, at most `most` bytes.
fn inflate(packed: &[u8], out: &mut Vec<u8>, most: u64, place: ArrayPlace<'_>) -> Result<(), ReadError> {
    let first = out.len();
    let mut inflater = ZlibDecoder::new(packed);
    let mut step = [0; STEP];
    loop {
        match inflater.read(&mut step) {
            Ok(0) => return Ok(()),
            Ok(n) => {
                let start = out.len();
                if (start - first + n) as u64 > most {
                    let message = format!("a block unpacks to more than the {} bytes allowed", grouped(most));
                    return Err(ReadError::new("too-large", place.location(), message));
                }
                push_many(out, 0, n)?;
                out[start..].copy_from_slice(&step[..n]);
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => {
                let message = format!("a block is damaged: {error}");
                return Err(ReadError::new("bad-deflate", place.location(), message));
            }
        }
    }
}
