//! `check_size`: the check of a picture's size that all writers share.
use crate::WriteError;
use chordal::render::Picture;

/// Refuses a picture without pixels, with sides longer than the format allows, or whose bytes do not fit its
/// size.
pub(crate) fn check_size(picture: &Picture, format: &str, most_side: u32) -> Result<(), WriteError> {
    let Picture { width, height, rgba } = picture;
    let unsupported = |message: String| Err(WriteError::Unsupported(message));
    if *width == 0 || *height == 0 || *width > most_side || *height > most_side {
        return unsupported(format!(
            "a {format} has 1 to {most_side} columns and rows, not {width}x{height}"
        ));
    }
    let expected = 4 * u128::from(*width) * u128::from(*height);
    if rgba.len() as u128 != expected {
        return unsupported(format!("{width}x{height} pixels are {expected} bytes, not {}", rgba.len()));
    }
    Ok(())
}
