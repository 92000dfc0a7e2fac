//! `ObjPictures`: the pictures of material libraries, opened once each, as images and textures of glTF.
use super::mtl_map::MtlMap;
use crate::files::{self, FileOpener};
use crate::notes::NamedNotes;
use crate::side_file::picture_type;
use crate::{ImageContent, SceneAssets, SceneImage};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::Arc;

/// glTF's `CLAMP_TO_EDGE`.
const CLAMP: u32 = 33071;

/// The code and the sentence for files that were found at another place than stated.
pub(super) const FOUND_BY_NAME: &str = "found-by-name";
pub(super) const FOUND_BY_NAME_TEXT: &str =
    "files outside the folder were taken from it, where one has their name";

/// Files beside an OBJ, by paths below its folder.
pub(super) struct ObjFiles<'a, 'b> {
    open: &'a mut FileOpener<'b>,
    /// The number of bytes that may still be read.
    left: u64,
}

impl<'a, 'b> ObjFiles<'a, 'b> {
    pub fn new(open: &'a mut FileOpener<'b>, left: u64) -> Self {
        Self { open, left }
    }

    /// The bytes of a file, or the reason why they are not available.
    pub fn read(&mut self, path: &str) -> Result<Vec<u8>, String> {
        let bytes = (self.open)(path)?;
        let left = self.left.checked_sub(bytes.len() as u64);
        self.left = left.ok_or("all files together are over the limit")?;
        Ok(bytes)
    }
}

/// The name of a file without its folders.
pub(super) fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\', ':']).next().unwrap_or(path)
}

/// The pictures so far.
pub(super) struct ObjPictures<'a, 'b> {
    pub files: ObjFiles<'a, 'b>,
    opened: Vec<OpenedPicture>,
    /// The picture of each path that was tried.
    tried: BTreeMap<String, Option<usize>>,
    /// The texture of each picture, keyed by whether it is clamped.
    texture_indices: BTreeMap<(usize, bool), usize>,
    images: Vec<SceneImage>,
    textures: Vec<Value>,
    samplers: Vec<Value>,
    /// Whether some picture is WebP, which needs an extension.
    has_webp: bool,
}

/// A picture file.
struct OpenedPicture {
    path: String,
    mime: &'static str,
    bytes: Arc<[u8]>,
    /// Its index among the images, once a texture uses it.
    image: Option<usize>,
}

impl<'a, 'b> ObjPictures<'a, 'b> {
    pub fn new(files: ObjFiles<'a, 'b>) -> Self {
        Self {
            files,
            opened: Vec::new(),
            tried: BTreeMap::new(),
            texture_indices: BTreeMap::new(),
            images: Vec::new(),
            textures: Vec::new(),
            samplers: Vec::new(),
            has_webp: false,
        }
    }

    /// The picture at a path in the library's folder, or else below the folder of the OBJ. If the path leads
    /// out of it, only its file name is used.
    pub fn open(&mut self, folder: &str, path: &str, notes: &mut NamedNotes) -> Option<usize> {
        let outside = |notes: &mut NamedNotes| {
            let what = "pictures that are no files below the folder were not opened";
            notes.add("picture-outside", what, path);
            None
        };
        let Ok(inside) = files::resolve_path(folder, path) else {
            let by_name = files::resolve_path(folder, file_name(path)).ok();
            let by_name = by_name.filter(|_| !path.contains("://"));
            let Some(Ok(picture)) = by_name.map(|inside| self.open_inside(inside)) else {
                return outside(notes);
            };
            notes.add(FOUND_BY_NAME, FOUND_BY_NAME_TEXT, path);
            return Some(picture);
        };
        let above = files::resolve_path("", path).ok().filter(|above| *above != inside);
        let result = self.open_inside(inside);
        // If both fail, the error names the first place, where the picture should be.
        match result.or_else(|why| above.map_or(Err(None), |above| self.open_inside(above)).map_err(|_| why))
        {
            Ok(picture) => Some(picture),
            Err(why) => {
                let name = why.map_or_else(|| path.to_owned(), |why| format!("{path} ({why})"));
                notes.add("picture-missing", "pictures could not be taken", &name);
                None
            }
        }
    }

    /// The picture at a path below the top folder, or the reason why it is not available, unless that was
    /// reported before.
    fn open_inside(&mut self, path: String) -> Result<usize, Option<String>> {
        if let Some(known) = self.tried.get(&path) {
            return known.ok_or(None);
        }
        let opened = self.files.read(&path).and_then(|bytes| {
            let mime = picture_type(&bytes).filter(|mime| *mime != "image/ktx2");
            let mime = mime.ok_or("it is no PNG, JPEG or WebP")?;
            self.opened.push(OpenedPicture { path: path.clone(), mime, bytes: bytes.into(), image: None });
            Ok(self.opened.len() - 1)
        });
        self.tried.insert(path, opened.as_ref().ok().copied());
        opened.map_err(Some)
    }

    /// The texture of a picture.
    pub fn texture(&mut self, picture: usize, map: &MtlMap) -> usize {
        if let Some(known) = self.texture_indices.get(&(picture, map.is_clamped)) {
            return *known;
        }
        let image = self.number(picture);
        let is_webp = self.opened[picture].mime == "image/webp";
        self.has_webp |= is_webp;
        let mut texture = match is_webp {
            true => json!({ "extensions": { "EXT_texture_webp": { "source": image } } }),
            false => json!({ "source": image }),
        };
        if map.is_clamped {
            if self.samplers.is_empty() {
                self.samplers.push(json!({ "wrapS": CLAMP, "wrapT": CLAMP }));
            }
            texture["sampler"] = json!(0);
        }
        self.textures.push(texture);
        self.texture_indices.insert((picture, map.is_clamped), self.textures.len() - 1);
        self.textures.len() - 1
    }

    /// The number of a picture's image.
    fn number(&mut self, picture: usize) -> usize {
        let OpenedPicture { path, mime, bytes, image } = &mut self.opened[picture];
        *image.get_or_insert_with(|| {
            let mut properties = Map::new();
            properties.insert("name".to_owned(), json!(path));
            properties.insert("mimeType".to_owned(), json!(mime));
            let content = ImageContent::Bytes(Arc::clone(bytes));
            self.images.push(SceneImage { properties, content });
            self.images.len() - 1
        })
    }

    /// Whether a picture has one channel, so that it holds heights and not directions.
    pub fn is_gray(&self, picture: usize) -> bool {
        is_gray(&self.opened[picture].bytes)
    }

    /// The assets of materials with these pictures.
    pub fn into_assets(self, materials: Vec<Value>) -> SceneAssets {
        let Self { images, textures, samplers, has_webp, .. } = self;
        let required_extensions = if has_webp { vec!["EXT_texture_webp".to_owned()] } else { Vec::new() };
        SceneAssets { materials, textures, samplers, images, required_extensions, ..SceneAssets::default() }
    }
}

fn is_gray(bytes: &[u8]) -> bool {
    if picture_type(bytes) == Some("image/png") {
        // The colour type of the header: 0 is grey, 4 grey with opacity (PNG specification, 11.2.1).
        return matches!(bytes.get(25), Some(0 | 4));
    }
    if picture_type(bytes) != Some("image/jpeg") {
        return false;
    }
    // Each segment has a marker and a length, up to the frame header, whose eighth byte is the number of
    // components (ITU-T T.81, B.2.2).
    let mut at = 2;
    while let Some(&[0xff, marker, high, low, _, _, _, _, _, n_components]) = bytes.get(at..at + 10) {
        // c4, c8 and cc are tables and a reserved marker among the markers of frames.
        if matches!(marker, 0xc0..=0xcf) && !matches!(marker, 0xc4 | 0xc8 | 0xcc) {
            return n_components == 1;
        }
        // The length includes its own two bytes; a smaller one would stop the walk.
        at += 2 + usize::from(u16::from_be_bytes([high, low])).max(2);
    }
    false
}
