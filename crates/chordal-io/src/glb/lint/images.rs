//! Rules for images; only their first bytes are checked.
use super::buffers::{BufferViewUse, UseTable};
use super::extensions::ExtensionHost;
use super::{GltfLint, uri};
use crate::glb::json::JsonValue;
use crate::glb::model::{GltfImage, GltfModel, item};
use crate::side_file::picture_type;

/// Why the first bytes of an image are invalid.
enum ImageError {
    /// The bytes end too early.
    End,
    /// Not a known type of image.
    Unknown,
    /// Bytes that are invalid for the type of the image.
    Invalid(&'static str),
}

impl<'a> GltfImage<'a> {
    /// The declared type, or else the detected one.
    pub(super) fn mime(&self) -> Option<&'a str> {
        self.mime.or(self.detected)
    }
}

impl<'a> GltfLint<'a> {
    pub(super) fn image(&mut self, map: &'a JsonValue) -> GltfImage<'a> {
        let view = self.index(map, "bufferView", false);
        let mime = self.text(map, "mimeType", false);
        let uri = self.text(map, "uri", false);
        if view.is_some() && mime.is_none() {
            self.issue_below("UNSATISFIED_DEPENDENCY", "bufferView", "mimeType is missing");
        }
        if view.is_some() == uri.is_some() {
            self.issue_here("ONE_OF_MISMATCH", "an image has either bufferView or uri");
        }
        let mut data = None;
        match uri.and_then(uri::data_uri) {
            Some(Ok(found)) if type_of(&found.bytes) == Some(&*found.mime) => data = Some(found.bytes),
            Some(Ok(_)) => {
                self.issue_below("INVALID_URI", "uri", "the data are of another type than the URI says")
            }
            Some(Err(what)) => self.issue_below("INVALID_URI", "uri", what),
            None if uri.is_some_and(uri::is_invalid) => {
                self.issue_below("INVALID_URI", "uri", "the URI is invalid")
            }
            None => {}
        }
        self.name(map);
        self.extensions(map, ExtensionHost::Other);
        let extended = map.get("extensions").is_some_and(|extensions| !extensions.entries().is_empty());
        GltfImage { view, uri, mime, data, extended, detected: None }
    }

    pub(super) fn link_images(&mut self, model: &GltfModel<'a>, uses: &mut UseTable) {
        for (i, image) in model.images.iter().enumerate() {
            let Some(view) = image.as_ref().and_then(|image| image.view) else { continue };
            self.within_path(&["images".into(), i.into()], |lint| {
                if !lint.resolved("bufferViews", view, "bufferView".into()) {
                    return;
                }
                lint.use_view(uses, Some(view), BufferViewUse::Image, "bufferView");
                if item(&model.views, Some(view)).is_some_and(|view| view.stride.is_some()) {
                    lint.issue_below(
                        "IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE",
                        "bufferView",
                        "images have no byteStride",
                    );
                }
            });
        }
    }

    /// Checks the first bytes of images. Images in other files are not opened.
    pub(super) fn check_images(&mut self, model: &mut GltfModel<'a>) {
        let webp = self.declares("EXT_texture_webp");
        for i in 0..model.images.len() {
            let Some(image) = &model.images[i] else { continue };
            let bytes = image.data.as_deref().or_else(|| model.view_bytes(image.view));
            let (Some(bytes), false) = (bytes, image.extended) else { continue };
            if !self.charge(bytes.len() as u64) {
                continue;
            }
            let (detected, declared, in_view) = (sniff_image(bytes), image.mime, image.data.is_none());
            self.within_path(&["images".into(), i.into()], |lint| match &detected {
                Ok(mime) => {
                    if *mime == "image/webp" && !webp {
                        lint.issue_here("IMAGE_NON_ENABLED_MIME_TYPE", "WebP needs an extension");
                    }
                    if let Some(declared) = declared.filter(|declared| declared != mime) {
                        let key = if in_view { "bufferView" } else { "uri" };
                        let what = format!("the image is {mime} and not {declared}");
                        lint.issue("IMAGE_MIME_TYPE_INVALID", Some(key.into()), || what);
                    }
                }
                Err(ImageError::End) => lint.issue_here("IMAGE_UNEXPECTED_EOS", "the image ends too early"),
                Err(ImageError::Invalid(what)) => lint.issue_here("IMAGE_DATA_INVALID", what),
                // The validator only warns about these.
                Err(ImageError::Unknown) => {}
            });
            if let Some(image) = &mut model.images[i] {
                image.detected = detected.ok();
            }
        }
    }
}

/// The type by the first bytes; the shortest picture has this many.
fn type_of(bytes: &[u8]) -> Option<&'static str> {
    bytes.get(..14).and_then(picture_type)
}

fn sniff_image(bytes: &[u8]) -> Result<&'static str, ImageError> {
    let mime = type_of(bytes).ok_or(ImageError::Unknown)?;
    match mime {
        "image/jpeg" => jpeg(bytes)?,
        "image/png" => png(bytes)?,
        "image/webp" => webp(bytes)?,
        _ => return Err(ImageError::Unknown),
    }
    Ok(mime)
}

/// Follows the segments to the one that holds the size.
fn jpeg(bytes: &[u8]) -> Result<(), ImageError> {
    let mut rest = bytes;
    loop {
        let skip = rest.iter().position(|b| !is_padding(*b)).ok_or(ImageError::End)?;
        let marker = rest[skip];
        let [high, low] = *rest.get(skip + 1..skip + 3).ok_or(ImageError::End)? else {
            return Err(ImageError::End);
        };
        let length = usize::from(high) << 8 | usize::from(low);
        if length < 2 {
            return Err(ImageError::Invalid("a JPEG segment has no length"));
        }
        let is_frame = (marker & 0xF0 == 0xC0 && ![0xC4, 0xC8, 0xCC].contains(&marker)) || marker == 0xDE;
        let data = rest.get(skip + 3..skip + 1 + length).ok_or(ImageError::End)?;
        if is_frame {
            return match data.get(5) {
                Some(1 | 3) => Ok(()),
                _ => Err(ImageError::Invalid("a JPEG has neither one nor three channels")),
            };
        }
        rest = &rest[skip + 1 + length..];
    }
}

/// Whether a marker has no segment, or the byte is padding before a marker.
fn is_padding(byte: u8) -> bool {
    matches!(byte, 0x01 | 0xD0..=0xD7 | 0xD8..=0xD9 | 0xFF)
}

/// Follows the chunks to the image data.
fn png(bytes: &[u8]) -> Result<(), ImageError> {
    let mut rest = bytes.get(8..).ok_or(ImageError::End)?;
    let mut has_header = false;
    loop {
        let (length, kind) = rest.get(..8).ok_or(ImageError::End)?.split_at(4);
        let length = length.iter().fold(0_usize, |n, byte| n << 8 | usize::from(*byte));
        let expected = match kind {
            b"IHDR" => Some(13),
            b"cHRM" => Some(32),
            b"sRGB" => Some(1),
            b"pHYs" => Some(9),
            b"gAMA" => Some(4),
            _ => None,
        };
        if expected.is_some_and(|n| n != length) {
            return Err(ImageError::Invalid("a PNG chunk has the wrong length"));
        }
        if kind == b"IDAT" {
            return if has_header { Ok(()) } else { Err(ImageError::Invalid("a PNG has no header")) };
        }
        has_header |= kind == b"IHDR";
        rest = rest.get(8..).and_then(|r| r.get(length.checked_add(4)?..)).ok_or(ImageError::End)?;
    }
}

fn webp(bytes: &[u8]) -> Result<(), ImageError> {
    match bytes.get(12..16).ok_or(ImageError::End)? {
        b"VP8L" if bytes.len() >= 25 => Ok(()),
        b"VP8 " | b"VP8X" if bytes.len() >= 30 => Ok(()),
        b"VP8L" | b"VP8 " | b"VP8X" => Err(ImageError::End),
        _ => Err(ImageError::Invalid("a WebP has the wrong header")),
    }
}
