//! Rules for materials and textures.
use super::extensions::{ExtensionHost, textures_of};
use super::{GltfLint, IntegerRule, NumberRule, PointerToken};
use crate::glb::json::JsonValue;
use crate::glb::model::{GltfImage, GltfMaterial, GltfModel, GltfTexture, item};

impl<'a> GltfLint<'a> {
    pub(super) fn material(&mut self, map: &'a JsonValue) -> GltfMaterial {
        let mut material = GltfMaterial::default();
        if let Some(pbr) = self.object(map, "pbrMetallicRoughness", false) {
            self.within("pbrMetallicRoughness", |lint| {
                lint.numbers(pbr, "baseColorFactor", 4, (0.0, 1.0));
                lint.texture_info(pbr, "baseColorTexture", &mut material);
                lint.number(pbr, "metallicFactor", NumberRule::UNIT);
                lint.number(pbr, "roughnessFactor", NumberRule::UNIT);
                lint.texture_info(pbr, "metallicRoughnessTexture", &mut material);
                lint.extensions(pbr, ExtensionHost::Other);
            });
        }
        material.has_normal_texture = self.texture_info(map, "normalTexture", &mut material);
        material.needs_tangents = material.has_normal_texture;
        self.texture_info(map, "occlusionTexture", &mut material);
        self.texture_info(map, "emissiveTexture", &mut material);
        self.numbers(map, "emissiveFactor", 3, (0.0, 1.0));
        self.text(map, "alphaMode", false);
        self.number(map, "alphaCutoff", NumberRule::AT_LEAST_0);
        self.flag(map, "doubleSided");
        let extensions = self.extensions(map, ExtensionHost::Material);
        self.each_extension(extensions, |lint, name, value| {
            lint.material_extension(name, value);
            for texture in textures_of(name) {
                let is_there = lint.texture_info(value, texture, &mut material);
                material.needs_tangents |= is_there && *texture == "anisotropyTexture";
            }
        });
        self.name(map);
        material
    }

    /// Parses a reference to a texture. Returns whether there is one.
    fn texture_info(&mut self, map: &'a JsonValue, key: &'a str, material: &mut GltfMaterial) -> bool {
        let Some(info) = self.object(map, key, false) else { return false };
        self.within(key, |lint| {
            if let Some(index) = lint.index(info, "index", true) {
                lint.resolved("textures", index, "index".into());
            }
            let mut sets = vec![lint.integer(info, "texCoord", IntegerRule::default()).or(0)];
            match key {
                "normalTexture" | "clearcoatNormalTexture" => {
                    lint.number(info, "scale", NumberRule::ANY);
                }
                "occlusionTexture" => {
                    lint.number(info, "strength", NumberRule::UNIT);
                }
                _ => {}
            }
            let extensions = lint.extensions(info, ExtensionHost::TextureInfo);
            lint.each_extension(extensions, |lint, _, value| sets.push(lint.texture_transform(value)));
            for set in sets.into_iter().flatten() {
                if material.texcoord.as_ref().is_none_or(|(highest, _)| set > *highest) {
                    material.texcoord = Some((set, lint.pointer(None)));
                }
            }
        });
        true
    }

    pub(super) fn texture(&mut self, map: &'a JsonValue) -> GltfTexture {
        self.reference(map, "sampler", "samplers");
        let source = self.reference(map, "source", "images");
        self.name(map);
        let mut webp = None;
        let extensions = self.extensions(map, ExtensionHost::Texture);
        self.each_extension(extensions, |lint, _, value| webp = lint.reference(value, "source", "images"));
        GltfTexture { source, webp }
    }

    /// Checks that the images of textures have types that all viewers support.
    pub(super) fn link_textures(&mut self, model: &GltfModel<'a>) {
        for (i, texture) in model.textures.iter().enumerate() {
            let Some(texture) = texture else { continue };
            let plain = [(None, texture.source, &["image/jpeg", "image/png"][..])];
            let webp = [(Some("EXT_texture_webp"), texture.webp, &["image/webp"][..])];
            for (extension, source, types) in plain.into_iter().chain(webp) {
                let mime = item(&model.images, source).and_then(GltfImage::mime);
                let Some(mime) = mime.filter(|mime| !types.contains(mime)) else { continue };
                let mut path = vec![PointerToken::Key("textures"), i.into()];
                path.extend(
                    extension
                        .iter()
                        .flat_map(|name| [PointerToken::Key("extensions"), PointerToken::Key(name)]),
                );
                self.within_path(&path, |lint| {
                    let what = format!("the image is {mime}");
                    lint.issue("TEXTURE_INVALID_IMAGE_MIME_TYPE", Some("source".into()), || what);
                });
            }
        }
    }
}
