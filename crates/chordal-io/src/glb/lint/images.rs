//! Images: only their first bytes are looked at.
use super::buffers::{Use, Uses};
use super::extensions::At;
use super::{Lint, uri};
use crate::glb::json::Json;
use crate::glb::model::{Image, Model, View, item};

/// Why the first bytes of an image are not right.
enum Broken {
    /// The bytes end too early.
    End,
    /// No known type of image.
    Unknown,
    /// Bytes that such an image cannot have.
    Invalid(&'static str),
}

impl<'a> Image<'a> {
    /// The type that the file says, or else the one that the bytes have.
    pub(super) fn mime(&self) -> Option<&'a str> {
        self.mime.or(self.found)
    }
}

impl<'a> Lint<'a> {
    pub(super) fn image(&mut self, map: &'a Json) -> Image<'a> {
        let view = self.index(map, "bufferView", false);
        let mime = self.text(map, "mimeType", false);
        let uri = self.text(map, "uri", false);
        if view.is_some() && mime.is_none() {
            self.at("UNSATISFIED_DEPENDENCY", "bufferView", "mimeType is missing");
        }
        if view.is_some() == uri.is_some() {
            self.here("ONE_OF_MISMATCH", "an image has either bufferView or uri");
        }
        let mut data = None;
        match uri.and_then(uri::data_uri) {
            Some(Ok(found)) if type_of(&found.bytes) == Some(&*found.mime) => data = Some(found.bytes),
            Some(Ok(_)) => self.at("INVALID_URI", "uri", "the data are of another type than the URI says"),
            Some(Err(what)) => self.at("INVALID_URI", "uri", what),
            None if uri.is_some_and(uri::is_invalid) => self.at("INVALID_URI", "uri", "the URI is invalid"),
            None => {}
        }
        self.name(map);
        self.extensions(map, At::Other);
        let extended = map.get("extensions").is_some_and(|all| !all.entries().is_empty());
        Image { view, mime, data, extended, found: None }
    }

    pub(super) fn link_images(&mut self, model: &Model<'a>, uses: &mut Uses) {
        for (i, image) in model.images.iter().enumerate() {
            let Some(view) = image.as_ref().and_then(|image| image.view) else { continue };
            self.below(&["images".into(), i.into()], |lint| {
                if !lint.resolved("bufferViews", view, "bufferView".into()) {
                    return;
                }
                lint.use_view(uses, Some(view), Use::Image, "bufferView");
                if item(&model.views, Some(view)).is_some_and(|view| view.stride.is_some()) {
                    lint.at("IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE", "bufferView", "images have no byteStride");
                }
            });
        }
    }

    /// Looks at the first bytes of images. Those in other files are not opened.
    pub(super) fn look_at_images(&mut self, model: &mut Model<'a>) {
        let webp = self.declares("EXT_texture_webp");
        for i in 0..model.images.len() {
            let Some(image) = &model.images[i] else { continue };
            let bytes = image.data.as_deref().or_else(|| view_bytes(model, image.view));
            let (Some(bytes), false) = (bytes, image.extended) else { continue };
            if !self.works(bytes.len() as u64) {
                continue;
            }
            let (found, said, in_view) = (look(bytes), image.mime, image.data.is_none());
            self.below(&["images".into(), i.into()], |lint| match &found {
                Ok(mime) => {
                    if *mime == "image/webp" && !webp {
                        lint.here("IMAGE_NON_ENABLED_MIME_TYPE", "WebP needs an extension");
                    }
                    if let Some(said) = said.filter(|said| said != mime) {
                        let key = if in_view { "bufferView" } else { "uri" };
                        let what = format!("the image is {mime} and not {said}");
                        lint.issue("IMAGE_MIME_TYPE_INVALID", Some(key.into()), || what);
                    }
                }
                Err(Broken::End) => lint.here("IMAGE_UNEXPECTED_EOS", "the image ends too early"),
                Err(Broken::Invalid(what)) => lint.here("IMAGE_DATA_INVALID", what),
                // The validator warns of these only.
                Err(Broken::Unknown) => {}
            });
            if let Some(image) = &mut model.images[i] {
                image.found = found.ok();
            }
        }
    }
}

fn view_bytes<'m>(model: &'m Model<'_>, view: Option<usize>) -> Option<&'m [u8]> {
    let View { buffer, offset, length, .. } = item(&model.views, view)?;
    let data = item(&model.buffers, *buffer)?.data.as_deref()?;
    let start = usize::try_from((*offset)?).ok()?;
    data.get(start..)?.get(..usize::try_from((*length)?).ok()?)
}

/// The type by the first bytes.
fn type_of(bytes: &[u8]) -> Option<&'static str> {
    match bytes.get(..14)? {
        [0xFF, 0xD8, 0xFF, ..] => Some("image/jpeg"),
        [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1A, b'\n', ..] => Some("image/png"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', b'V', b'P'] => Some("image/webp"),
        [0xAB, b'K', b'T', b'X', b' ', b'2', b'0', 0xBB, b'\r', b'\n', 0x1A, b'\n', ..] => Some("image/ktx2"),
        _ => None,
    }
}

fn look(bytes: &[u8]) -> Result<&'static str, Broken> {
    let mime = type_of(bytes).ok_or(Broken::Unknown)?;
    match mime {
        "image/jpeg" => jpeg(bytes)?,
        "image/png" => png(bytes)?,
        "image/webp" => webp(bytes)?,
        _ => return Err(Broken::Unknown),
    }
    Ok(mime)
}

/// Follows the segments to the one that holds the size.
fn jpeg(bytes: &[u8]) -> Result<(), Broken> {
    let mut rest = bytes;
    loop {
        let skip = rest.iter().position(|b| !is_padding(*b)).ok_or(Broken::End)?;
        let marker = rest[skip];
        let [high, low] = *rest.get(skip + 1..skip + 3).ok_or(Broken::End)? else { return Err(Broken::End) };
        let length = usize::from(high) << 8 | usize::from(low);
        if length < 2 {
            return Err(Broken::Invalid("a JPEG segment has no length"));
        }
        let is_frame = (marker & 0xF0 == 0xC0 && ![0xC4, 0xC8, 0xCC].contains(&marker)) || marker == 0xDE;
        let data = rest.get(skip + 3..skip + 1 + length).ok_or(Broken::End)?;
        if is_frame {
            return match data.get(5) {
                Some(1 | 3) => Ok(()),
                _ => Err(Broken::Invalid("a JPEG has neither one nor three channels")),
            };
        }
        rest = &rest[skip + 1 + length..];
    }
}

/// Markers without a segment, and the byte that may fill the space before a marker.
fn is_padding(byte: u8) -> bool {
    matches!(byte, 0x01 | 0xD0..=0xD7 | 0xD8..=0xD9 | 0xFF)
}

/// Follows the chunks to the picture.
fn png(bytes: &[u8]) -> Result<(), Broken> {
    let mut rest = bytes.get(8..).ok_or(Broken::End)?;
    let mut has_header = false;
    loop {
        let (length, kind) = rest.get(..8).ok_or(Broken::End)?.split_at(4);
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
            return Err(Broken::Invalid("a PNG chunk has the wrong length"));
        }
        if kind == b"IDAT" {
            return if has_header { Ok(()) } else { Err(Broken::Invalid("a PNG has no header")) };
        }
        has_header |= kind == b"IHDR";
        rest = rest.get(8..).and_then(|r| r.get(length.checked_add(4)?..)).ok_or(Broken::End)?;
    }
}

fn webp(bytes: &[u8]) -> Result<(), Broken> {
    match bytes.get(12..16).ok_or(Broken::End)? {
        b"VP8L" if bytes.len() >= 25 => Ok(()),
        b"VP8 " | b"VP8X" if bytes.len() >= 30 => Ok(()),
        b"VP8L" | b"VP8 " | b"VP8X" => Err(Broken::End),
        _ => Err(Broken::Invalid("a WebP has the wrong header")),
    }
}
