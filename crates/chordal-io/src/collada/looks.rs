//! `ColladaLooks`: materials, their effects and images, converted to glTF materials.
use crate::{ImageContent, SceneAssets, SceneImage};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The diffuse colour of an effect.
#[derive(Clone, Debug, Default)]
pub(super) struct ColladaEffect {
    pub color: Option<[f64; 4]>,
    /// The sampler, or the image itself.
    pub texture: Option<String>,
    /// The references of samplers and surfaces.
    pub parameters: BTreeMap<String, String>,
}

/// A material.
#[derive(Clone, Debug, Default)]
pub(super) struct ColladaMaterial {
    pub id: String,
    pub name: String,
    pub effect: String,
}

/// All materials, effects and images of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct ColladaLooks {
    pub materials: Vec<ColladaMaterial>,
    pub effects: BTreeMap<String, ColladaEffect>,
    /// The path of each image.
    pub images: BTreeMap<String, String>,
}

/// The most steps from a texture to its image. Chosen: sampler, surface, image are usual.
const MOST_STEPS: usize = 4;

impl ColladaLooks {
    /// The number of a material by its id, from 1.
    pub(super) fn number(&self, id: &str) -> Option<u32> {
        self.materials.iter().position(|material| material.id == id).map(|index| index as u32 + 1)
    }

    /// The names of the material groups.
    pub(super) fn names(&self) -> Vec<String> {
        let name = |m: &ColladaMaterial| if m.name.is_empty() { m.id.clone() } else { m.name.clone() };
        std::iter::once(String::new()).chain(self.materials.iter().map(name)).collect()
    }

    /// The path of the image of an effect's texture.
    fn path<'a>(&'a self, effect: &'a ColladaEffect) -> Option<&'a str> {
        let mut name = effect.texture.as_deref()?;
        for _ in 0..MOST_STEPS {
            match effect.parameters.get(name) {
                Some(next) if next != name => name = next,
                _ => break,
            }
        }
        self.images.get(name).map(|path| &**path)
    }

    /// The materials with their colours; pictures are not opened, only their names are kept.
    pub(super) fn assets(&self) -> SceneAssets {
        let mut assets = SceneAssets::default();
        let mut texture_indices: BTreeMap<&str, usize> = BTreeMap::new();
        let plain = ColladaEffect::default();
        for (material, name) in self.materials.iter().zip(self.names().into_iter().skip(1)) {
            let effect = self.effects.get(&material.effect).unwrap_or(&plain);
            let mut pbr = Map::new();
            if let Some(color) = effect.color {
                pbr.insert("baseColorFactor".to_owned(), json!(color));
            }
            if let Some(path) = self.path(effect) {
                // A picture that several effects use is one texture.
                let texture = *texture_indices.entry(path).or_insert_with(|| {
                    let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
                    let content = ImageContent::Uri(file.to_owned());
                    assets.images.push(SceneImage { properties: Map::new(), content });
                    assets.textures.push(json!({ "source": assets.images.len() - 1 }));
                    assets.textures.len() - 1
                });
                pbr.insert("baseColorTexture".to_owned(), json!({ "index": texture }));
            }
            // Effects of COLLADA are plain surfaces, but glTF's default is metal.
            pbr.insert("metallicFactor".to_owned(), json!(0.0));
            let mut object = Map::new();
            object.insert("name".to_owned(), json!(name));
            object.insert("pbrMetallicRoughness".to_owned(), Value::Object(pbr));
            if effect.color.is_some_and(|color| color[3] < 1.0) {
                object.insert("alphaMode".to_owned(), json!("BLEND"));
            }
            assets.materials.push(Value::Object(object));
        }
        assets
    }
}
