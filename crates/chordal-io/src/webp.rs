//! Pictures as WebP.
use crate::WriteError;
use crate::picture_size::check_size;
use crate::xml_text::escaped;
use chordal::render::Picture;
use std::fmt::Write as _;
use std::io::Write;

/// Writes a picture as lossless WebP; without alpha if the picture is opaque.
///
/// The pairs of `text` become the description in the metadata (XMP), one per line, as `keyword: text`. The
/// same picture and text give the same bytes as long as the version of the encoder is the same.
///
/// # Errors
/// [`WriteError::Unsupported`] for a picture without pixels, of more than 16,384 columns or rows, or whose
/// bytes do not fit its size; [`WriteError::Io`] if the sink fails.
///
/// ```
/// use chordal::render::Picture;
/// let picture = Picture { width: 1, height: 1, rgba: vec![255, 0, 0, 255] };
/// let mut file = Vec::new();
/// chordal_io::webp::write(&picture, &[("Software", "Chordal")], &mut file)?;
/// assert_eq!((&file[..4], &file[8..12]), (&b"RIFF"[..], &b"WEBP"[..]));
/// # Ok::<(), chordal_io::WriteError>(())
/// ```
///
/// Source: Google, *WebP Container Specification*, 2010 to 2025; Adobe, *XMP Specification*, part 1, 2012.
pub fn write(picture: &Picture, text: &[(&str, &str)], out: &mut impl Write) -> Result<(), WriteError> {
    check_size(picture, "WebP", MOST_SIDE)?;
    let opaque = picture.is_opaque();
    let rgb: Vec<u8>;
    let (pixels, color) = if opaque {
        rgb = picture.rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        (&rgb, ::image_webp::ColorType::Rgb8)
    } else {
        (&picture.rgba, ::image_webp::ColorType::Rgba8)
    };
    let mut encoder = ::image_webp::WebPEncoder::new(out);
    if !text.is_empty() {
        encoder.set_xmp_metadata(described(text).into_bytes());
    }
    encoder.encode(pixels, picture.width, picture.height, color).map_err(|error| match error {
        ::image_webp::EncodingError::IoError(error) => WriteError::Io(error),
        other => WriteError::Unsupported(other.to_string()),
    })
}

/// The limit of lossless WebP on columns and rows: 14 bits that count from 1.
const MOST_SIDE: u32 = 1 << 14;

/// XMP metadata with a text as the description of the picture.
fn described(text: &[(&str, &str)]) -> String {
    let mut lines = String::new();
    for (keyword, text) in text {
        // Writing to a string does not fail.
        let _ = writeln!(lines, "{keyword}: {text}");
    }
    format!(
        "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\
         <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\
         <rdf:Description rdf:about=\"\" xmlns:dc=\"http://purl.org/dc/elements/1.1/\"><dc:description><rdf:Alt>\
         <rdf:li xml:lang=\"x-default\">{}</rdf:li>\
         </rdf:Alt></dc:description></rdf:Description></rdf:RDF></x:xmpmeta>",
        escaped(lines.trim_end())
    )
}
