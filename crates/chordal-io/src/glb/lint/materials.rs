//! Materials and textures.
use super::extensions::{At, textures_of};
use super::{Lint, Real, Step, Whole};
use crate::glb::json::Json;
use crate::glb::model::{Image, Material, Model, Texture, item};

impl<'a> Lint<'a> {
    pub(super) fn material(&mut self, map: &'a Json) -> Material {
        let mut material = Material::default();
        if let Some(pbr) = self.object(map, "pbrMetallicRoughness", false) {
            self.within("pbrMetallicRoughness", |lint| {
                lint.reals(pbr, "baseColorFactor", 4, (0.0, 1.0));
                lint.texture_info(pbr, "baseColorTexture", &mut material);
                lint.real(pbr, "metallicFactor", Real::UNIT);
                lint.real(pbr, "roughnessFactor", Real::UNIT);
                lint.texture_info(pbr, "metallicRoughnessTexture", &mut material);
                lint.extensions(pbr, At::Other);
            });
        }
        material.has_normal_texture = self.texture_info(map, "normalTexture", &mut material);
        material.needs_tangents = material.has_normal_texture;
        self.texture_info(map, "occlusionTexture", &mut material);
        self.texture_info(map, "emissiveTexture", &mut material);
        self.reals(map, "emissiveFactor", 3, (0.0, 1.0));
        self.text(map, "alphaMode", false);
        self.real(map, "alphaCutoff", Real::AT_LEAST_0);
        self.flag(map, "doubleSided");
        let found = self.extensions(map, At::Material);
        self.each_extension(found, |lint, name, value| {
            lint.material_extension(name, value);
            for texture in textures_of(name) {
                let is_there = lint.texture_info(value, texture, &mut material);
                material.needs_tangents |= is_there && *texture == "anisotropyTexture";
            }
        });
        self.name(map);
        material
    }

    /// A reference to a texture; whether there is one.
    fn texture_info(&mut self, map: &'a Json, key: &'a str, material: &mut Material) -> bool {
        let Some(info) = self.object(map, key, false) else { return false };
        self.within(key, |lint| {
            if let Some(index) = lint.index(info, "index", true) {
                lint.resolved("textures", index, "index".into());
            }
            let mut sets = vec![lint.whole(info, "texCoord", Whole::default()).or(0)];
            match key {
                "normalTexture" | "clearcoatNormalTexture" => {
                    lint.real(info, "scale", Real::ANY);
                }
                "occlusionTexture" => {
                    lint.real(info, "strength", Real::UNIT);
                }
                _ => {}
            }
            let found = lint.extensions(info, At::TextureInfo);
            lint.each_extension(found, |lint, _, value| sets.push(lint.texture_transform(value)));
            for set in sets.into_iter().flatten() {
                if material.texcoord.as_ref().is_none_or(|(highest, _)| set > *highest) {
                    material.texcoord = Some((set, lint.pointer(None)));
                }
            }
        });
        true
    }

    pub(super) fn texture(&mut self, map: &'a Json) -> Texture {
        self.reference(map, "sampler", "samplers");
        let source = self.reference(map, "source", "images");
        self.name(map);
        let mut webp = None;
        let found = self.extensions(map, At::Texture);
        self.each_extension(found, |lint, _, value| webp = lint.reference(value, "source", "images"));
        Texture { source, webp }
    }

    /// Whether the images of textures have types that every viewer reads.
    pub(super) fn link_textures(&mut self, model: &Model<'a>) {
        for (i, texture) in model.textures.iter().enumerate() {
            let Some(texture) = texture else { continue };
            let plain = [(None, texture.source, &["image/jpeg", "image/png"][..])];
            let webp = [(Some("EXT_texture_webp"), texture.webp, &["image/webp"][..])];
            for (extension, source, types) in plain.into_iter().chain(webp) {
                let mime = item(&model.images, source).and_then(Image::mime);
                let Some(mime) = mime.filter(|mime| !types.contains(mime)) else { continue };
                let mut path = vec![Step::Key("textures"), i.into()];
                path.extend(extension.iter().flat_map(|name| [Step::Key("extensions"), Step::Key(name)]));
                self.below(&path, |lint| {
                    let what = format!("the image is {mime}");
                    lint.issue("TEXTURE_INVALID_IMAGE_MIME_TYPE", Some("source".into()), || what);
                });
            }
        }
    }
}
