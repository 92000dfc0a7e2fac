//! Pictures as PNG, and greyscale images read from PNG.
use crate::picture_size::check_size;
use crate::text::grouped;
use crate::{FileLocation, Limits, ReadError, WriteError};
use chordal::render::Picture;
use std::io::{Cursor, Write};

/// Writes a picture as PNG, 8-bit sRGB; without alpha if the picture is opaque.
///
/// `text` holds pairs of a keyword and UTF-8 text, written to `iTXt` chunks before the pixels. A keyword is 1
/// to 79 printable characters of Latin-1 without leading, trailing or double spaces, as the PNG specification
/// says ("Software", "Description", …). The same picture and text give the same bytes as long as the version
/// of the encoder is the same.
///
/// # Errors
/// [`WriteError::Unsupported`] for a picture without pixels or whose bytes do not fit its size, for a keyword
/// that PNG does not allow, and for text with a NUL; [`WriteError::Io`] if the sink fails.
///
/// ```
/// use chordal::render::Picture;
/// let picture = Picture { width: 1, height: 1, rgba: vec![255, 0, 0, 255] };
/// let mut file = Vec::new();
/// chordal_io::png::write(&picture, &[("Software", "Chordal")], &mut file)?;
/// assert_eq!(&file[..8], b"\x89PNG\r\n\x1a\n");
/// # Ok::<(), chordal_io::WriteError>(())
/// ```
///
/// Source: W3C, *Portable Network Graphics (PNG) Specification*, third edition, 2025.
pub fn write(picture: &Picture, text: &[(&str, &str)], out: &mut impl Write) -> Result<(), WriteError> {
    let Picture { width, height, rgba } = picture;
    let unsupported = |message: String| Err(WriteError::Unsupported(message));
    check_size(picture, "PNG", MOST_SIDE)?;
    let mut encoder = ::png::Encoder::new(out, *width, *height);
    let opaque = picture.is_opaque();
    encoder.set_color(if opaque { ::png::ColorType::Rgb } else { ::png::ColorType::Rgba });
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_compression(::png::Compression::Balanced);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    for (keyword, text) in text {
        if !is_keyword(keyword) {
            return unsupported(format!("'{keyword}' is no keyword of PNG: 1 to 79 printable characters"));
        }
        if text.contains('\0') {
            return unsupported(format!("the text of '{keyword}' contains a NUL, which ends text in PNG"));
        }
        encoder.add_itxt_chunk((*keyword).to_owned(), (*text).to_owned()).map_err(error)?;
    }
    let mut writer = encoder.write_header().map_err(error)?;
    if opaque {
        let rgb: Vec<u8> = rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        writer.write_image_data(&rgb).map_err(error)?;
    } else {
        writer.write_image_data(rgba).map_err(error)?;
    }
    writer.finish().map_err(error)
}

/// A greyscale picture, used as heights.
#[derive(Clone, Debug, PartialEq)]
pub struct Greys {
    /// The number of columns.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
    /// From 0 (black) to 1 (white), row by row from the top.
    pub values: Vec<f64>,
}

/// The most pixels that are read. Chosen: a square of 2,048, which is 8 million triangles as heights.
const MOST_PIXELS: u64 = 1 << 22;
/// The most bytes that the decoder holds beside the pixels. Chosen: room for as many pixels at 16 bytes.
const MOST_BYTES: u64 = 1 << 26;

/// Reads a greyscale picture of 1 to 16 bits, or a colour picture whose three channels are equal. Values are
/// taken unchanged, whatever the file's gamma; alpha is ignored.
///
/// # Errors
/// If the bytes are not a PNG or a broken one, or the picture has colours, more than 4,194,304 pixels, or
/// more bytes than the limits allow.
pub fn read_greys(bytes: &[u8], limits: &Limits) -> Result<Greys, ReadError> {
    let refused = |code, message: String| ReadError::new(code, FileLocation::File, message);
    let broken = |error: ::png::DecodingError| refused("bad-picture", format!("this is no PNG: {error}"));
    let most = usize::try_from(limits.bytes.min(MOST_BYTES)).unwrap_or(usize::MAX);
    // The decoder's own limit holds what it needs itself; the pixels are counted below, before they
    // are allocated.
    let mut decoder = ::png::Decoder::new_with_limits(Cursor::new(bytes), ::png::Limits { bytes: most });
    decoder.set_transformations(::png::Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    let mut reader = decoder.read_info().map_err(broken)?;
    let (width, height) = (reader.info().width, reader.info().height);
    let n_pixels = u64::from(width) * u64::from(height);
    if n_pixels > MOST_PIXELS {
        let most = grouped(MOST_PIXELS);
        let message = format!("the picture has {} pixels; the limit is {most}", grouped(n_pixels));
        return Err(refused("too-large", message));
    }
    let size = reader.output_buffer_size().filter(|size| *size as u64 <= limits.bytes);
    let size = size.ok_or_else(|| refused("too-large", "the picture takes too much memory".to_owned()))?;
    let mut samples = vec![0; size];
    let frame = reader.next_frame(&mut samples).map_err(broken)?;
    let is_wide = frame.bit_depth == ::png::BitDepth::Sixteen;
    let n_channels = frame.color_type.samples();
    let n_bytes = if is_wide { 2 } else { 1 };
    let mut values = Vec::with_capacity(n_pixels as usize);
    for (k, pixel) in samples.chunks_exact(n_channels * n_bytes).take(n_pixels as usize).enumerate() {
        let channel = |c: usize| match is_wide {
            true => f64::from(u16::from_be_bytes([pixel[2 * c], pixel[2 * c + 1]])) / f64::from(u16::MAX),
            false => f64::from(pixel[c]) / f64::from(u8::MAX),
        };
        if n_channels >= 3 && (channel(0) != channel(1) || channel(1) != channel(2)) {
            let (row, column) = (k / width as usize + 1, k % width as usize + 1);
            let message = format!("the picture is not grey: it has a colour at row {row}, column {column}");
            return Err(refused("coloured", message));
        }
        values.push(channel(0));
    }
    Ok(Greys { width, height, values })
}

/// PNG's limit on columns and rows, 2³¹ − 1.
const MOST_SIDE: u32 = i32::MAX as u32;

/// Whether PNG allows the keyword: 11.3.3.1 of the specification.
fn is_keyword(keyword: &str) -> bool {
    let printable = |c: char| matches!(c, ' '..='~' | '\u{a1}'..='\u{ff}');
    (1..=79).contains(&keyword.chars().count())
        && keyword.chars().all(printable)
        && keyword.trim_matches(' ') == keyword
        && !keyword.contains("  ")
}

fn error(error: ::png::EncodingError) -> WriteError {
    match error {
        ::png::EncodingError::IoError(error) => WriteError::Io(error),
        other => WriteError::Unsupported(other.to_string()),
    }
}
