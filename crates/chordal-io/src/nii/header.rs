//! The header of a NIfTI file: fields at fixed offsets, of version 1 (348 bytes) or 2 (540 bytes).
//!
//! Offsets are those of `nifti1.h` (R. W. Cox, 2003) and `nifti2.h` (2011), as published at
//! nifti.nimh.nih.gov.
use crate::volume::element::{Endian, SampleType};
use crate::volume::name_of;
use crate::{FileLocation, ReadError};
use chordal::budget::advice::Message;

/// Bytes of the header of version 1 and of version 2.
const SIZES: [usize; 2] = [348, 540];
/// The bytes after the header that tell whether extensions follow, before the samples.
const EXTENDER: usize = 4;
/// The most bytes of a header.
pub(super) const MOST: usize = SIZES[1];

/// The fields of a header.
pub(super) struct NiftiHeader {
    pub endian: Endian,
    pub element: SampleType,
    /// `dim`: the number of axes, then their sizes.
    pub dim: [i64; 8],
    /// The byte offset of `dim`.
    pub dim_at: usize,
    pub bits: i64,
    pub bits_at: usize,
    /// `pixdim`: the handedness of the quaternion, then the steps along the axes.
    pub pixdim: [f64; 8],
    pub pixdim_at: usize,
    /// Whether the samples are in a separate file with the same name and the extension `.img`.
    pub is_pair: bool,
    /// The byte at which samples start, in the unpacked file that holds them.
    pub offset: u64,
    pub slope: f64,
    pub inter: f64,
    pub slope_at: usize,
    pub units: i64,
    pub name: String,
    pub qform: i64,
    pub quaternion: [f64; 3],
    pub shift: [f64; 3],
    pub quaternion_at: usize,
    pub sform: i64,
    pub rows: [[f64; 4]; 3],
    pub rows_at: usize,
}

/// Detects version and byte order from the header size, which the first bytes hold.
fn kind(bytes: &[u8]) -> Option<(usize, Endian)> {
    let first: [u8; 4] = bytes.get(..4)?.try_into().ok()?;
    let is = |size: usize, number: i32| size as i64 == i64::from(number);
    (0..2).find_map(|version| {
        let size = SIZES[version];
        if is(size, i32::from_le_bytes(first)) {
            return Some((version, Endian::Little));
        }
        is(size, i32::from_be_bytes(first)).then_some((version, Endian::Big))
    })
}

/// Whether bytes look like a NIfTI file that is not gzipped.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    match kind(bytes) {
        Some((0, _)) => bytes.get(344..348).is_some_and(|magic| magic == b"n+1\0" || magic == b"ni1\0"),
        Some(_) => bytes.get(4..7).is_some_and(|magic| magic == b"n+2" || magic == b"ni2"),
        None => false,
    }
}

pub(super) fn header_error(code: &'static str, at: usize, message: impl Into<Message>) -> ReadError {
    ReadError::new(code, FileLocation::Byte(at as u64), message)
}

/// Access to the fields of a header, whose length was checked.
struct NiftiFields<'a> {
    bytes: &'a [u8],
    endian: Endian,
    /// Whether it is version 2, which has wider fields.
    is_wide: bool,
    is_pair: bool,
}

impl NiftiFields<'_> {
    fn i16(&self, at: usize) -> i64 {
        i64::from(i16::from_le_bytes(self.endian.array(&self.bytes[at..])))
    }

    fn i32(&self, at: usize) -> i64 {
        i64::from(i32::from_le_bytes(self.endian.array(&self.bytes[at..])))
    }

    fn i64(&self, at: usize) -> i64 {
        i64::from_le_bytes(self.endian.array(&self.bytes[at..]))
    }

    /// Number `k` of a list of floating-point numbers.
    fn real(&self, at: usize, k: usize) -> f64 {
        if self.is_wide {
            f64::from_le_bytes(self.endian.array(&self.bytes[at + 8 * k..]))
        } else {
            f64::from(f32::from_le_bytes(self.endian.array(&self.bytes[at + 4 * k..])))
        }
    }

    /// The first byte at which samples may start: after the header, if both are in one file.
    fn least_offset(&self, version: usize) -> usize {
        if self.is_pair { 0 } else { SIZES[version] + EXTENDER }
    }

    fn reals<const N: usize>(&self, at: usize) -> [f64; N] {
        std::array::from_fn(|k| self.real(at, k))
    }
}

impl NiftiHeader {
    /// Parses the header in the first bytes of an unpacked file.
    ///
    /// # Errors
    /// If it is not a header, or has an unsupported sample type.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, ReadError> {
        let Some((version, endian)) = kind(bytes) else {
            let message = "a NIfTI file starts with the size of its header, 348 or 540, in either byte order";
            return Err(header_error("bad-magic", 0, message));
        };
        let size = SIZES[version];
        if bytes.len() < size {
            let message = format!("the file ends in its header: {} bytes of {size}", bytes.len());
            return Err(ReadError::new("truncated", FileLocation::Byte(bytes.len() as u64), message));
        }
        let is_pair = check_magic(bytes, version)?;
        let f = NiftiFields { bytes, endian, is_wide: version == 1, is_pair };
        let header = if f.is_wide { Self::second(&f)? } else { Self::first(&f)? };
        Ok(header)
    }

    fn first(f: &NiftiFields) -> Result<Self, ReadError> {
        Ok(Self {
            endian: f.endian,
            element: element(f.i16(70), 70)?,
            dim: std::array::from_fn(|k| f.i16(40 + 2 * k)),
            dim_at: 40,
            bits: f.i16(72),
            bits_at: 72,
            pixdim: f.reals(76),
            pixdim_at: 76,
            is_pair: f.is_pair,
            offset: offset(f.real(108, 0), 108, f.least_offset(0))?,
            slope: f.real(112, 0),
            inter: f.real(116, 0),
            slope_at: 112,
            units: i64::from(f.bytes[123]),
            name: name_of(&f.bytes[148..228]),
            qform: f.i16(252),
            quaternion: f.reals(256),
            shift: f.reals(268),
            quaternion_at: 256,
            sform: f.i16(254),
            rows: [f.reals(280), f.reals(296), f.reals(312)],
            rows_at: 280,
        })
    }

    fn second(f: &NiftiFields) -> Result<Self, ReadError> {
        // Offsets that f64 cannot hold exactly are beyond any file.
        let start = f.i64(168) as f64;
        Ok(Self {
            endian: f.endian,
            element: element(f.i16(12), 12)?,
            dim: std::array::from_fn(|k| f.i64(16 + 8 * k)),
            dim_at: 16,
            bits: f.i16(14),
            bits_at: 14,
            pixdim: f.reals(104),
            pixdim_at: 104,
            is_pair: f.is_pair,
            offset: offset(start, 168, f.least_offset(1))?,
            slope: f.real(176, 0),
            inter: f.real(184, 0),
            slope_at: 176,
            units: f.i32(500),
            name: name_of(&f.bytes[240..320]),
            qform: f.i32(344),
            quaternion: f.reals(352),
            shift: f.reals(376),
            quaternion_at: 352,
            sform: f.i32(348),
            rows: [f.reals(400), f.reals(432), f.reals(464)],
            rows_at: 400,
        })
    }
}

/// Whether the samples are in another file.
fn check_magic(bytes: &[u8], version: usize) -> Result<bool, ReadError> {
    let (at, magic) = if version == 0 { (344, &bytes[344..348]) } else { (4, &bytes[4..12]) };
    match (version, magic) {
        (0, b"n+1\0") | (1, b"n+2\0\r\n\x1a\n") => Ok(false),
        (0, b"ni1\0") | (1, [b'n', b'i', b'2', ..]) => Ok(true),
        (1, [b'n', b'+', b'2', ..]) => Err(header_error(
            "bad-magic",
            at,
            "the line ends after n+2 were changed, as by a transfer as text; the samples are not whole either",
        )),
        _ => Err(header_error(
            "bad-magic",
            at,
            format!("{} is not the mark of a NIfTI file", crate::text::show(magic)),
        )),
    }
}

/// The byte at which samples start.
fn offset(start: f64, at: usize, least: usize) -> Result<u64, ReadError> {
    // 0 means the earliest possible offset.
    if start == 0.0 {
        return Ok(least as u64);
    }
    // No file is larger than 2⁵³ bytes, and f64 holds no odd numbers beyond.
    let is_place = start.fract() == 0.0 && start >= least as f64 && start < 9_007_199_254_740_992.0;
    if !is_place {
        let message = format!("samples cannot start at byte {start}: the header takes {least} bytes");
        return Err(header_error("bad-offset", at, message));
    }
    Ok(start as u64)
}

/// The sample type for a code of the standard.
fn element(code: i64, at: usize) -> Result<SampleType, ReadError> {
    let name = match code {
        2 => return Ok(SampleType::U8),
        4 => return Ok(SampleType::I16),
        8 => return Ok(SampleType::I32),
        16 => return Ok(SampleType::F32),
        64 => return Ok(SampleType::F64),
        256 => return Ok(SampleType::I8),
        512 => return Ok(SampleType::U16),
        768 => return Ok(SampleType::U32),
        1024 => return Ok(SampleType::I64),
        1280 => return Ok(SampleType::U64),
        1 => "single bits",
        32 | 1792 | 2048 => "complex numbers",
        128 | 2304 => "colours",
        1536 => "128-bit floating point",
        _ => "no known type",
    };
    let message = format!(
        "samples of type {code}, {name}, are not read: whole numbers of 8 to 64 bits, f32 and f64 are"
    );
    Err(header_error("unsupported-type", at, message))
}
