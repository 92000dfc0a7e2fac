//! Pictures as PNG.
use crate::WriteError;
use crate::picture_size::check_size;
use chordal::render::Picture;
use std::io::Write;

/// Writes a picture as PNG, 8-bit sRGB; without alpha where the picture is opaque.
///
/// `text` holds pairs of a keyword and UTF-8 text, written to `iTXt` chunks before the pixels. A keyword is 1
/// to 79 printable characters of Latin-1 without leading, trailing or double spaces, as the PNG specification
/// says ("Software", "Description", …). The same picture and text give the same bytes as long as the version
/// of the encoder is the same.
///
/// # Errors
/// [`WriteError::Unsupported`] for a picture without pixels or whose bytes do not fit its size, for a keyword
/// that PNG does not allow, and for text with a NUL; [`WriteError::Io`] when the sink fails.
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
