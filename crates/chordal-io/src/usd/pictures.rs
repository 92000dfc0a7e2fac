//! `UsdPictures`: the pictures of materials, opened once each, as images and textures of glTF.
use super::stage::UsdStage;
use crate::side_file::picture_type;
use crate::{ImageContent, SceneAssets, SceneImage};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The wrap modes, with glTF's codes.
const WRAPS: [(&str, u32); 4] = [("clamp", 33071), ("black", 33071), ("mirror", 33648), ("repeat", 10497)];

/// The pictures so far.
#[derive(Default)]
pub(super) struct UsdPictures {
    images: Vec<SceneImage>,
    textures: Vec<Value>,
    samplers: Vec<Value>,
    /// The image of each path that was tried.
    tried: BTreeMap<String, Option<usize>>,
    has_webp: bool,
}

/// A picture with its wrapping along both axes.
pub(super) struct UsdPicture<'p> {
    pub asset: &'p str,
    /// The file that refers to it.
    pub layer: u32,
    pub wraps: [String; 2],
}

impl UsdPictures {
    /// The texture of a picture; `None`, with a note, if the picture is not available.
    pub(super) fn texture(
        &mut self,
        stage: &mut UsdStage<'_, '_>,
        picture: &UsdPicture<'_>,
    ) -> Option<usize> {
        let image = self.image(stage, picture)?;
        let number = |word: &String| {
            if word == "black" {
                let what = "pictures are black beyond their borders, where glTF repeats the border";
                stage.note("wrap-black", what, picture.asset);
            }
            WRAPS.iter().find(|(known, _)| known == word).map_or(WRAPS[3].1, |(_, number)| *number)
        };
        let wraps = [number(&picture.wraps[0]), number(&picture.wraps[1])];
        let is_webp = self.images[image].properties.get("mimeType") == Some(&json!("image/webp"));
        let mut texture = match is_webp {
            true => json!({ "extensions": { "EXT_texture_webp": { "source": image } } }),
            false => json!({ "source": image }),
        };
        self.has_webp |= is_webp;
        if wraps != [WRAPS[3].1; 2] {
            let sampler = json!({ "wrapS": wraps[0], "wrapT": wraps[1] });
            texture["sampler"] = json!(number_of(&mut self.samplers, sampler));
        }
        Some(number_of(&mut self.textures, texture))
    }

    fn image(&mut self, stage: &mut UsdStage<'_, '_>, picture: &UsdPicture<'_>) -> Option<usize> {
        let missing = "pictures could not be taken";
        let from = stage.layers[picture.layer as usize].path.clone();
        let path = match stage.files.resolve(&from, picture.asset) {
            Ok(path) => path,
            Err(why) => {
                stage.note("picture-missing", missing, &format!("{} ({why})", picture.asset));
                return None;
            }
        };
        if let Some(known) = self.tried.get(&path) {
            return *known;
        }
        let opened = stage.files.read(&path).and_then(|bytes| {
            let mime = picture_type(&bytes).filter(|mime| *mime != "image/ktx2");
            Ok((mime.ok_or("it is no PNG, JPEG or WebP")?, bytes))
        });
        let image = match opened {
            Ok((mime, bytes)) => {
                let mut properties = Map::new();
                properties.insert("name".to_owned(), json!(path));
                properties.insert("mimeType".to_owned(), json!(mime));
                self.images.push(SceneImage { properties, content: ImageContent::Bytes(bytes.into()) });
                Some(self.images.len() - 1)
            }
            Err(why) => {
                stage.note("picture-missing", missing, &format!("{path} ({why})"));
                None
            }
        };
        self.tried.insert(path, image);
        image
    }

    /// The assets of materials with these pictures.
    pub(super) fn into_assets(self, materials: Vec<Value>) -> SceneAssets {
        let Self { images, textures, samplers, has_webp, .. } = self;
        let required_extensions = if has_webp { vec!["EXT_texture_webp".to_owned()] } else { Vec::new() };
        SceneAssets { materials, textures, samplers, images, required_extensions, ..SceneAssets::default() }
    }
}

/// The index of an object in a list; a new object is appended.
fn number_of(list: &mut Vec<Value>, object: Value) -> usize {
    if let Some(at) = list.iter().position(|known| *known == object) {
        return at;
    }
    list.push(object);
    list.len() - 1
}
