//! The samples of a frame that is packed. The coders are other libraries', in Rust without `unsafe`; what a
//! small file may make them allocate is bounded here.
use super::codestream_headers;
use super::run_lengths;
use super::slice::SliceFormat;
use super::transfer_syntax::PixelPacking;
use crate::text::grouped;
use crate::{FileLocation, ReadError};
use hayro_jpeg2000::{DecodeSettings, DecoderContext, Image};
use oxiarc_jpeg::{DecodeLimits, DecodeOptions, Decoder};

/// The most samples of a packed frame, so that no small file makes a decoder take much memory. Chosen: 4,096 by
/// 4,096, four times what scanners for small samples make.
const MOST_SAMPLES: u64 = 1 << 24;
/// The samples up to which the ratio is not checked. Chosen: 2,048 by 2,048, so that an empty slice is read.
const SMALL: u64 = 1 << 22;
/// The most samples for a packed byte, beyond `SMALL`. Chosen: as for packed volumes.
const RATIO: u64 = 1_000;
/// The most bits of a sample of JPEG 2000. Derived: the standard's own for DICOM is 16, and the decoder
/// computes in single precision, which holds integers of 24 bits.
const MOST_BITS: u8 = 16;

/// The samples of a frame as its packing holds them.
struct PackedSamples {
    /// Negative ones in two's complement.
    samples: Vec<u16>,
    /// The bits that the packing states for a sample.
    bits: u8,
    /// Whether the packing itself has a sign.
    is_signed: bool,
}

/// The little-endian samples of the frame whose `packed` bytes start `at` a byte of the file.
///
/// # Errors
/// If the packed bytes are damaged or truncated, hold another size than the file states, or would take too
/// much memory.
pub(super) fn unpack(
    packing: PixelPacking,
    (packed, at): (&[u8], usize),
    format: &SliceFormat,
) -> Result<Vec<u8>, ReadError> {
    let place = FileLocation::Byte(at as u64);
    if packing == PixelPacking::RunLengths {
        let size = (format.n_pixels(), format.element.width());
        return run_lengths::unpack((packed, at), size);
    }
    let (n, n_packed) = (format.n_pixels(), packed.len() as u64);
    if n > MOST_SAMPLES || n > SMALL && n > RATIO * n_packed {
        let message = format!(
            "a frame of {} samples in {} packed bytes is not unpacked: {} samples are the most, and beyond {} there \
             are at most {RATIO} for each byte",
            grouped(n),
            grouped(n_packed),
            grouped(MOST_SAMPLES),
            grouped(SMALL)
        );
        return Err(ReadError::new("too-dense", place, message));
    }
    let packed = match packing {
        PixelPacking::Jpeg => jpeg(packed, format),
        PixelPacking::JpegLs => jpeg_ls(packed, format),
        PixelPacking::Jpeg2000 => jpeg_2000(packed, format),
        PixelPacking::Plain | PixelPacking::RunLengths | PixelPacking::Unread(_) => {
            Err("are of a packing that is not read".to_owned())
        }
    };
    let PackedSamples { samples, bits, is_signed } = packed
        .map_err(|why| ReadError::new("bad-packing", place.clone(), format!("the packed pixels {why}")))?;
    if samples.len() as u64 != n {
        let message = format!("the packed pixels are {} samples; its size takes {n}", samples.len());
        return Err(ReadError::new("size-mismatch", place, message));
    }
    // Without a sign of its own, the sign is the highest bit of the packing, or the highest that the file states.
    let is_negative = |sample: &u16| u64::from(*sample) >> (bits.max(1) - 1) == 1;
    let is_unclear = format.is_signed() && !is_signed && u64::from(bits) < format.bits_stored;
    if is_unclear && samples.iter().any(is_negative) {
        let stated = format.bits_stored;
        let message = format!("the packed pixels have {bits} bits, and the file states {stated} with a sign");
        return Err(ReadError::new("size-mismatch", place, message));
    }
    let width = format.element.width();
    let mut bytes = crate::grow::with_room(samples.len() * width)?;
    for sample in samples {
        // Negative samples have 16 bits here, in two's complement: those of one byte are from 0xFF80 on.
        if width == 1 && sample > 0xFF && sample < 0xFF80 {
            let message = "the packed pixels have more bits than the file states";
            return Err(ReadError::new("size-mismatch", place, message));
        }
        // The bits above the stored ones of a negative sample are ones, which `decode` does not look at.
        let wide = if is_signed { sample as i16 as u32 } else { u32::from(sample) };
        bytes.extend_from_slice(&wide.to_le_bytes()[..width]);
    }
    Ok(bytes)
}

/// Whether a picture has the size that the file states.
fn check_size((width, height): (u64, u64), format: &SliceFormat) -> Result<(), String> {
    if (width, height) == (format.columns, format.rows) {
        return Ok(());
    }
    Err(format!("are {width} x {height} samples, and the file states {} x {}", format.columns, format.rows))
}

/// Samples of JPEG: baseline, extended or lossless, of up to 16 bits.
fn jpeg(packed: &[u8], format: &SliceFormat) -> Result<PackedSamples, String> {
    let broken = |error: oxiarc_jpeg::JpegError| format!("are no JPEG that is read: {error}");
    let limits = DecodeLimits {
        max_pixels: format.n_pixels(),
        max_components: 1,
        // One component that is not progressive is one scan.
        max_scans: 1,
        max_input_bytes: packed.len() as u64,
        ..DecodeLimits::default()
    };
    let options = DecodeOptions { limits, raw_components: true, ..DecodeOptions::default() };
    let mut decoder = Decoder::with_options(packed, options);
    let info = decoder.read_info().map_err(broken)?;
    check_size((u64::from(info.width), u64::from(info.height)), format)?;
    let samples = if info.precision > 8 {
        decoder.decode_u16().map_err(broken)?
    } else {
        decoder.decode().map_err(broken)?.into_iter().map(u16::from).collect()
    };
    Ok(PackedSamples { samples, bits: info.precision, is_signed: false })
}

/// Samples of JPEG-LS, of up to 16 bits.
fn jpeg_ls(packed: &[u8], format: &SliceFormat) -> Result<PackedSamples, String> {
    // Both have 16 bits in the file.
    let (columns, rows) = (format.columns as u32, format.rows as u32);
    let decoded = jpegls::decode(packed, columns, rows);
    let (samples, _, _) = decoded.map_err(|error| format!("are no JPEG-LS that is read: {error}"))?;
    let bits = bits_of_jpeg_ls(packed).ok_or("are no JPEG-LS that is read: it states no bits")?;
    Ok(PackedSamples { samples, bits, is_signed: false })
}

/// The bits of a sample of JPEG-LS, from 2 to 16: the first byte of the frame's header, which the decoder does not
/// hand out.
///
/// Source: ITU, *Recommendation T.87*, 1998, C.2.2.
fn bits_of_jpeg_ls(packed: &[u8]) -> Option<u8> {
    let mut at = 2;
    loop {
        let &[0xFF, marker, high, low, bits] = packed.get(at..at + 5)? else { return None };
        if marker == 0xF7 {
            return Some(bits).filter(|bits| (2..=16).contains(bits));
        }
        at += 2 + usize::from(u16::from_be_bytes([high, low]));
    }
}

/// Samples of a codestream of JPEG 2000. Lossy ones are rounded to integers.
///
/// Source: ITU, *Recommendation T.800*, 2019, A.5.1.
fn jpeg_2000(packed: &[u8], format: &SliceFormat) -> Result<PackedSamples, String> {
    // The decoder allocates tiles and precincts before it decodes one.
    let (is_signed, bits) = codestream_headers::check(packed, (format.columns, format.rows))?;
    if bits > MOST_BITS {
        return Err(format!("are of {bits} bits; up to {MOST_BITS} are read"));
    }
    let broken = |error: hayro_jpeg2000::DecodeError| format!("are no JPEG 2000 that is read: {error}");
    let settings = DecodeSettings { strict: true, ..DecodeSettings::default() };
    let packed = codestream_headers::completed(packed)?;
    let image = Image::new(&packed, &settings).map_err(broken)?;
    check_size((u64::from(image.width()), u64::from(image.height())), format)?;
    let mut context = DecoderContext::default();
    let decoded = image.decode(&mut context).map_err(broken)?;
    let [component] = decoded.components() else {
        return Err("are not one component of JPEG 2000".to_owned());
    };
    // The decoder adds half of the range to signed samples, too.
    let offset = if is_signed { 1_i32 << (bits - 1) } else { 0 };
    let most = (1_i32 << bits) - 1;
    let sample = |x: &f32| {
        // Saturates, and NaN is 0. Adding a half before the floor needs no function of the platform's.
        let rounded = (f64::from(*x) + 0.5).floor() as i32;
        (rounded.clamp(0, most) - offset) as u16
    };
    Ok(PackedSamples { samples: component.samples().iter().map(sample).collect(), bits, is_signed })
}
