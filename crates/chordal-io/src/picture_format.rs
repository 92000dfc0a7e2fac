//! `PictureFormat`: the formats that pictures are written in.
use crate::{WriteError, jpeg, png, webp};
use chordal::render::Picture;
use std::io::Write;

/// A format of pictures.
///
/// ```
/// use chordal_io::PictureFormat;
/// assert_eq!(PictureFormat::from_extension("JPG"), Some(PictureFormat::Jpeg));
/// assert_eq!(PictureFormat::from_extension("gif"), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureFormat {
    /// Lossless.
    #[default]
    Png,
    /// Small, for photographs: lossy, and without transparency.
    Jpeg,
    /// Lossless.
    Webp,
}

impl PictureFormat {
    /// The format of an extension, in any case.
    #[must_use]
    pub fn from_extension(extension: &str) -> Option<Self> {
        match &*extension.to_ascii_lowercase() {
            "png" => Some(Self::Png),
            "jpg" | "jpeg" => Some(Self::Jpeg),
            "webp" => Some(Self::Webp),
            _ => None,
        }
    }

    /// Writes a picture with pairs of a keyword and a text: see [`png::write`], [`jpeg::write`], [`webp::write`].
    ///
    /// # Errors
    /// [`WriteError::Unsupported`] for a picture or a text that the format cannot hold, [`WriteError::Io`] if
    /// the sink fails.
    pub fn write(
        self,
        picture: &Picture,
        text: &[(&str, &str)],
        out: &mut impl Write,
    ) -> Result<(), WriteError> {
        match self {
            Self::Png => png::write(picture, text, out),
            Self::Jpeg => jpeg::write(picture, text, out),
            Self::Webp => webp::write(picture, text, out),
        }
    }
}
