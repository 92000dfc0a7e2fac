//! Pictures as JPEG.
use crate::WriteError;
use crate::picture_size::check_size;
use chordal::render::Picture;
use std::io::Write;

/// Writes a picture as baseline JPEG, on a white background if it is transparent. Colours change a little:
/// JPEG is lossy.
///
/// Each pair of `text` is a comment, `keyword: text`; a text that is too long for one comment continues in
/// the next. The same picture and text give the same bytes as long as the version of the encoder is the same.
///
/// # Errors
/// [`WriteError::Unsupported`] for a picture without pixels, of more than 65,535 columns or rows, or whose
/// bytes do not fit its size; [`WriteError::Io`] if the sink fails.
///
/// ```
/// use chordal::render::Picture;
/// let picture = Picture { width: 1, height: 1, rgba: vec![255, 0, 0, 255] };
/// let mut file = Vec::new();
/// chordal_io::jpeg::write(&picture, &[("Software", "Chordal")], &mut file)?;
/// assert_eq!(&file[..3], b"\xFF\xD8\xFF");
/// # Ok::<(), chordal_io::WriteError>(())
/// ```
///
/// Source: ITU, *Recommendation T.81*, 1992; E. Hamilton, *JPEG File Interchange Format*, version 1.02, 1992.
pub fn write(picture: &Picture, text: &[(&str, &str)], out: &mut impl Write) -> Result<(), WriteError> {
    check_size(picture, "JPEG", u32::from(u16::MAX))?;
    let rgb: Vec<u8> = picture.rgba.chunks_exact(4).flat_map(on_white).collect();
    let mut file = Vec::new();
    let encoder = ::image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, QUALITY);
    let color = ::image::ExtendedColorType::Rgb8;
    ::image::ImageEncoder::write_image(encoder, &rgb, picture.width, picture.height, color).map_err(
        |error| match error {
            ::image::ImageError::IoError(error) => WriteError::Io(error),
            other => WriteError::Unsupported(other.to_string()),
        },
    )?;
    let (head, rest) = file.split_at(end_of_header(&file));
    out.write_all(head)?;
    for (keyword, text) in text {
        let comment = format!("{keyword}: {text}");
        for part in comment.as_bytes().chunks(MOST_COMMENT) {
            // The length counts its own two bytes.
            out.write_all(&[MARKER, COMMENT])?;
            out.write_all(&(part.len() as u16 + 2).to_be_bytes())?;
            out.write_all(part)?;
        }
    }
    Ok(out.write_all(rest)?)
}

/// From 1 to 100, on the scale of the Independent JPEG Group's encoder. Chosen: from 90 on, edges of a
/// triangle show no ringing at screen size.
const QUALITY: u8 = 90;

/// The byte before each marker, the markers of a comment and of JFIF's header: T.81, table B.1.
const MARKER: u8 = 0xFF;
const COMMENT: u8 = 0xFE;
const APP0: u8 = 0xE0;

/// The bytes of a comment: its length has 16 bits, and counts itself.
const MOST_COMMENT: usize = u16::MAX as usize - 2;

/// The end of the start-of-image marker and of the JFIF header that must follow it: two bytes for the first,
/// two for the marker of the second, whose length counts the rest.
fn end_of_header(file: &[u8]) -> usize {
    match file {
        [_, _, MARKER, APP0, high, low, ..] => 4 + usize::from(u16::from_be_bytes([*high, *low])),
        _ => 2,
    }
}

/// A pixel blended over white.
fn on_white(rgba: &[u8]) -> [u8; 3] {
    let alpha = u32::from(rgba[3]);
    // Adding 127, half of 255, rounds to the nearest.
    let over = |channel: u8| (u32::from(channel) * alpha + 255 * (255 - alpha) + 127) / 255;
    [rgba[0], rgba[1], rgba[2]].map(|channel| over(channel) as u8)
}
