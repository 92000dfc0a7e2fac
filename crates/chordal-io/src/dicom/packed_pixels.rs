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
    let samples = match packing {
        PixelPacking::Jpeg => jpeg(packed, format),
        PixelPacking::JpegLs => jpeg_ls(packed, format),
        PixelPacking::Jpeg2000 => jpeg_2000(packed, format),
        PixelPacking::Plain | PixelPacking::RunLengths | PixelPacking::Unread(_) => {
            Err("are of a packing that is not read".to_owned())
        }
    };
    let samples = samples
        .map_err(|why| ReadError::new("bad-packing", place.clone(), format!("the packed pixels {why}")))?;
    if samples.len() as u64 != n {
        let message = format!("the packed pixels are {} samples; its size takes {n}", samples.len());
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
        bytes.extend_from_slice(&u32::from(sample).to_le_bytes()[..width]);
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
fn jpeg(packed: &[u8], format: &SliceFormat) -> Result<Vec<u16>, String> {
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
    if info.precision > 8 {
        return decoder.decode_u16().map_err(broken);
    }
    Ok(decoder.decode().map_err(broken)?.into_iter().map(u16::from).collect())
}

/// Samples of JPEG-LS, of up to 16 bits.
fn jpeg_ls(packed: &[u8], format: &SliceFormat) -> Result<Vec<u16>, String> {
    // Both have 16 bits in the file.
    let (columns, rows) = (format.columns as u32, format.rows as u32);
    let decoded = jpegls::decode(packed, columns, rows);
    decoded.map(|(samples, _, _)| samples).map_err(|error| format!("are no JPEG-LS that is read: {error}"))
}

/// Samples of a codestream of JPEG 2000. Lossy ones are rounded to integers.
///
/// Source: ITU, *Recommendation T.800*, 2019, A.5.1.
fn jpeg_2000(packed: &[u8], format: &SliceFormat) -> Result<Vec<u16>, String> {
    // The decoder allocates tiles and precincts before it decodes one.
    let (is_signed, bits) = codestream_headers::check(packed, (format.columns, format.rows))?;
    if bits > MOST_BITS {
        return Err(format!("are of {bits} bits; up to {MOST_BITS} are read"));
    }
    let broken = |error: hayro_jpeg2000::DecodeError| format!("are no JPEG 2000 that is read: {error}");
    let settings = DecodeSettings { strict: true, ..DecodeSettings::default() };
    let image = Image::new(packed, &settings).map_err(broken)?;
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
    Ok(component.samples().iter().map(sample).collect())
}
