//! `SideFile`: a file beside another one that refers to it by a relative URI; pictures as such files.
use crate::files;
use crate::{ImageContent, SceneAssets};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// A file beside another one that refers to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SideFile<'a> {
    /// Its name, without a folder.
    pub name: String,
    /// All its bytes.
    pub bytes: Cow<'a, [u8]>,
}

/// One shape as several files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileSet<'a> {
    /// The file that refers to the others.
    pub document: Vec<u8>,
    /// The others, each with its own name.
    pub beside: Vec<SideFile<'a>>,
}

impl FileSet<'_> {
    /// The same set with all its bytes owned.
    #[must_use]
    pub fn into_owned(self) -> FileSet<'static> {
        let owned =
            |file: SideFile<'_>| SideFile { name: file.name, bytes: Cow::Owned(file.bytes.into_owned()) };
        FileSet { document: self.document, beside: self.beside.into_iter().map(owned).collect() }
    }
}

impl SceneAssets {
    /// The pictures of the assets as files called `{prefix}image_0.png` and so on, by their index in the list
    /// of images. Pictures with the same bytes share one file.
    ///
    /// ```
    /// use chordal_io::{ImageContent, SceneAssets, SceneImage};
    /// let properties = serde_json::Map::from_iter([("mimeType".to_owned(), "image/jpeg".into())]);
    /// let picture = SceneImage { properties, content: ImageContent::Bytes([0xff, 0xd8, 0xff].into()) };
    /// let assets = SceneAssets { images: vec![picture], ..SceneAssets::default() };
    /// assert_eq!(assets.picture_files("")[0].name, "image_0.jpg");
    /// let beside = assets.with_pictures_beside("");
    /// assert_eq!(beside.images[0].content, ImageContent::Uri("image_0.jpg".to_owned()));
    /// ```
    #[must_use]
    pub fn picture_files(&self, prefix: &str) -> Vec<SideFile<'_>> {
        let (mut files, mut seen) = (Vec::new(), BTreeSet::new());
        for (image, name) in self.images.iter().zip(self.picture_names(prefix)) {
            if let (ImageContent::Bytes(bytes), Some(name)) = (&image.content, name)
                && seen.insert(name.clone())
            {
                files.push(SideFile { name, bytes: Cow::Borrowed(bytes) });
            }
        }
        files
    }

    /// The same assets, whose images refer to the files of [`Self::picture_files`] instead of holding them.
    #[must_use]
    pub fn with_pictures_beside(&self, prefix: &str) -> Self {
        let mut assets = self.clone();
        for (image, name) in assets.images.iter_mut().zip(self.picture_names(prefix)) {
            if let Some(name) = name {
                image.content = ImageContent::Uri(uri_of(&name));
            }
        }
        assets
    }

    /// For each image the name of its file, if the image holds its bytes.
    fn picture_names(&self, prefix: &str) -> Vec<Option<String>> {
        let mut by_content: BTreeMap<&[u8], String> = BTreeMap::new();
        // Names used by images whose pictures are elsewhere must not be reused.
        let elsewhere = self.images.iter().filter_map(|image| match &image.content {
            ImageContent::Uri(uri) => files::resolve("", uri).ok(),
            ImageContent::Bytes(_) => None,
        });
        let elsewhere: BTreeSet<String> = elsewhere.collect();
        let mut names = Vec::with_capacity(self.images.len());
        for (i, image) in self.images.iter().enumerate() {
            names.push(match &image.content {
                ImageContent::Bytes(bytes) => {
                    let mime = image.properties.get("mimeType").and_then(|mime| mime.as_str());
                    let extension = picture_extension(mime);
                    let names =
                        (0..).map(|k| format!("{prefix}image_{}.{extension}", i + k * self.images.len()));
                    let mut free = names.filter(|name| !elsewhere.contains(name));
                    Some(by_content.entry(bytes).or_insert_with(|| free.next().unwrap_or_default()).clone())
                }
                ImageContent::Uri(_) => None,
            });
        }
        names
    }
}

/// The extensions of pictures, by media type.
const PICTURES: [(&str, &str); 6] = [
    ("image/png", "png"),
    ("image/jpeg", "jpg"),
    ("image/webp", "webp"),
    ("image/avif", "avif"),
    ("image/ktx2", "ktx2"),
    ("image/vnd-ms.dds", "dds"),
];

/// The media type of a picture by its first bytes, if glTF or its extensions allow it.
pub(crate) fn picture_type(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0xFF, 0xD8, 0xFF, ..] => Some("image/jpeg"),
        [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1A, b'\n', ..] => Some("image/png"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("image/webp"),
        [0xAB, b'K', b'T', b'X', b' ', b'2', b'0', 0xBB, b'\r', b'\n', 0x1A, b'\n', ..] => Some("image/ktx2"),
        _ => None,
    }
}

/// The media type of a picture by the extension of its name, which may be a URI.
pub(crate) fn picture_type_of_name(name: &str) -> Option<&'static str> {
    let (_, extension) = name.split(['?', '#']).next()?.rsplit_once('.')?;
    let extension = extension.to_ascii_lowercase();
    let extension = if extension == "jpeg" { "jpg" } else { &extension };
    PICTURES.iter().find(|(_, known)| *known == extension).map(|(mime, _)| *mime)
}

/// The extension of a picture of a media type.
pub(crate) fn picture_extension(mime: Option<&str>) -> &'static str {
    PICTURES.iter().find(|(known, _)| Some(*known) == mime).map_or("img", |(_, extension)| extension)
}

/// The extensions that pictures get when they are written as files.
///
/// ```
/// assert!(chordal_io::picture_extensions().any(|extension| extension == "png"));
/// ```
pub fn picture_extensions() -> impl Iterator<Item = &'static str> {
    PICTURES.iter().map(|(_, extension)| *extension).chain(["img"])
}

/// The stem of the names of files beside one called `stem`: without separators of folders and disks, and
/// without characters that some system does not allow in names.
pub(crate) fn side_stem(stem: &str) -> String {
    let is_plain = |c: &char| !c.is_control() && !"/\\:*?\"<>|".contains(*c);
    let safe: String = stem.chars().map(|c| if is_plain(&c) { c } else { '_' }).collect();
    if safe.is_empty() { "_".to_owned() } else { safe }
}

/// A name as a relative URI (RFC 3986): all but unreserved characters are escaped.
pub(crate) fn uri_of(name: &str) -> String {
    let mut uri = String::with_capacity(name.len());
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            uri.push_str(&format!("%{byte:02X}"));
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_beside_any_file_are_found_by_their_uris() {
        for stem in ["a", "a b", "ä%20#?", "x:y", "a\\b", ".hidden", "", "~", "100%"] {
            let name = side_stem(stem) + ".bin";
            let uri = uri_of(&name);
            assert!(uri.is_ascii(), "{uri}");
            assert_eq!(files::resolve("", &uri).ok(), Some(name), "{stem}");
        }
        assert_eq!(uri_of("a b.bin"), "a%20b.bin");
    }
}
