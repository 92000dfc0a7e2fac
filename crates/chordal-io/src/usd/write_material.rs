//! Converts materials of glTF to USD's preview surfaces, and writes them.
use super::write_text::{UsdNames, UsdaWriter, display_name, quoted, tuple};
use crate::number::ShortestDecimal;
use crate::{ImageContent, SceneAssets, WriteError};
use serde_json::Value;
use std::collections::BTreeSet;

/// The default wrap mode of glTF.
const REPEAT: u64 = 10497;
/// USD's names of wrap modes, by glTF's codes.
const WRAPS: [(u64, &str); 3] = [(33071, "clamp"), (33648, "mirror"), (REPEAT, "repeat")];

/// The materials of a scene, with unique names.
pub(super) struct UsdMaterialWriter<'a> {
    assets: &'a SceneAssets,
    /// The names of prims, by material index.
    pub names: Vec<String>,
    /// The path of the prim that holds them.
    pub scope: String,
    /// Properties that no input can express, as sentences.
    pub lost: BTreeSet<String>,
}

/// A picture connected to an input.
struct TextureUse<'v> {
    /// The name of its shader.
    name: &'static str,
    info: &'v Value,
    scale: [f64; 4],
    /// Whether its values are colours.
    is_color: bool,
}

impl<'a> UsdMaterialWriter<'a> {
    pub(super) fn new(assets: &'a SceneAssets, scope: String) -> Self {
        let mut taken = UsdNames::default();
        let name = |material: &Value| taken.unique(material["name"].as_str().unwrap_or_default(), "Material");
        let names = assets.materials.iter().map(name).collect();
        Self { assets, names, scope, lost: BTreeSet::new() }
    }

    /// The path of a material.
    pub(super) fn path(&self, material: usize) -> Option<String> {
        Some(format!("{}/{}", self.scope, self.names.get(material)?))
    }

    /// Whether a material is visible from both sides.
    pub(super) fn is_double_sided(&self, material: usize) -> bool {
        self.assets.materials.get(material).is_some_and(|found| found["doubleSided"] == true)
    }

    /// Writes all of them.
    pub(super) fn write(&mut self, writer: &mut UsdaWriter<'_>) -> Result<(), WriteError> {
        for (at, material) in self.assets.materials.iter().enumerate() {
            let name = self.names[at].clone();
            let shown = material["name"].as_str().unwrap_or_default();
            writer.open("Material", &name, &display_name(shown, &name))?;
            let path = format!("{}/{name}", self.scope);
            writer.line(&format!("token outputs:surface.connect = <{path}/Surface.outputs:surface>"))?;
            self.surface(material, &path, writer)?;
            writer.close()?;
        }
        Ok(())
    }

    fn surface(
        &mut self,
        material: &Value,
        path: &str,
        writer: &mut UsdaWriter<'_>,
    ) -> Result<(), WriteError> {
        let mut textures = Vec::new();
        writer.open("Shader", "Surface", &[])?;
        writer.line("uniform token info:id = \"UsdPreviewSurface\"")?;
        let pbr = &material["pbrMetallicRoughness"];
        let base = numbers(&pbr["baseColorFactor"], [1.0; 4]);
        let mode = material["alphaMode"].as_str().unwrap_or("OPAQUE");
        // glTF ignores the alpha of opaque materials.
        let opacity = if mode == "OPAQUE" { 1.0 } else { base[3] };
        let color = &pbr["baseColorTexture"];
        if color.is_object() {
            let texture = TextureUse { name: "BaseColor", info: color, scale: base, is_color: true };
            writer.line(&connected("color3f", "diffuseColor", path, "BaseColor.outputs:rgb"))?;
            if mode != "OPAQUE" {
                writer.line(&connected("float", "opacity", path, "BaseColor.outputs:a"))?;
            }
            textures.push(texture);
        } else {
            writer.line(&format!("color3f inputs:diffuseColor = {}", tuple(&base[..3])))?;
            writer.line(&format!("float inputs:opacity = {}", ShortestDecimal(opacity)))?;
        }
        if mode == "MASK" {
            // A half is glTF's default.
            let cutoff = material["alphaCutoff"].as_f64().unwrap_or(0.5);
            writer.line(&format!("float inputs:opacityThreshold = {}", ShortestDecimal(cutoff)))?;
        }
        // Written even if they are glTF's defaults, since those of USD are others.
        let metal = pbr["metallicFactor"].as_f64().unwrap_or(1.0);
        let rough = pbr["roughnessFactor"].as_f64().unwrap_or(1.0);
        let metal_rough = &pbr["metallicRoughnessTexture"];
        if metal_rough.is_object() {
            let scale = [1.0, rough, metal, 1.0];
            textures.push(TextureUse {
                name: "MetallicRoughness",
                info: metal_rough,
                scale,
                is_color: false,
            });
            writer.line(&connected("float", "metallic", path, "MetallicRoughness.outputs:b"))?;
            writer.line(&connected("float", "roughness", path, "MetallicRoughness.outputs:g"))?;
        } else {
            writer.line(&format!("float inputs:metallic = {}", ShortestDecimal(metal)))?;
            writer.line(&format!("float inputs:roughness = {}", ShortestDecimal(rough)))?;
        }
        let normal = &material["normalTexture"];
        if normal.is_object() {
            // Values from 0 to 1 in the picture are directions from -1 to 1.
            textures.push(TextureUse {
                name: "Normal",
                info: normal,
                scale: [2.0, 2.0, 2.0, 1.0],
                is_color: false,
            });
            writer.line(&connected("normal3f", "normal", path, "Normal.outputs:rgb"))?;
            self.lose(normal["scale"].as_f64().unwrap_or(1.0) != 1.0, "strengths of normal maps");
        }
        let occlusion = &material["occlusionTexture"];
        if occlusion.is_object() {
            textures.push(TextureUse {
                name: "Occlusion",
                info: occlusion,
                scale: [1.0; 4],
                is_color: false,
            });
            writer.line(&connected("float", "occlusion", path, "Occlusion.outputs:r"))?;
            self.lose(occlusion["strength"].as_f64().unwrap_or(1.0) != 1.0, "strengths of occlusion");
        }
        let strength = material.pointer("/extensions/KHR_materials_emissive_strength/emissiveStrength");
        let strength = strength.and_then(Value::as_f64).unwrap_or(1.0);
        let [r, g, b] = numbers(&material["emissiveFactor"], [0.0; 3]).map(|x| x * strength);
        let glow = &material["emissiveTexture"];
        if glow.is_object() {
            textures.push(TextureUse { name: "Emissive", info: glow, scale: [r, g, b, 1.0], is_color: true });
            writer.line(&connected("color3f", "emissiveColor", path, "Emissive.outputs:rgb"))?;
        } else if [r, g, b] != [0.0; 3] {
            writer.line(&format!("color3f inputs:emissiveColor = {}", tuple(&[r, g, b])))?;
        }
        self.extensions(material, writer)?;
        writer.line("token outputs:surface")?;
        writer.close()?;
        textures.iter().try_for_each(|texture| self.texture(texture, path, writer))
    }

    fn lose(&mut self, is_lost: bool, what: &str) {
        if is_lost {
            self.lost.insert(format!("USDA's preview surfaces have no {what}"));
        }
    }

    fn extensions(&mut self, material: &Value, writer: &mut UsdaWriter<'_>) -> Result<(), WriteError> {
        let Some(extensions) = material["extensions"].as_object() else { return Ok(()) };
        for (name, extension) in extensions {
            let number =
                |member: &str, usual: f64| ShortestDecimal(extension[member].as_f64().unwrap_or(usual));
            match name.as_str() {
                "KHR_materials_emissive_strength" => {}
                "KHR_materials_ior" => writer.line(&format!("float inputs:ior = {}", number("ior", 1.5)))?,
                "KHR_materials_clearcoat" => {
                    writer.line(&format!("float inputs:clearcoat = {}", number("clearcoatFactor", 0.0)))?;
                    let roughness = number("clearcoatRoughnessFactor", 0.0);
                    writer.line(&format!("float inputs:clearcoatRoughness = {roughness}"))?;
                    let has_pictures =
                        ["clearcoatTexture", "clearcoatRoughnessTexture", "clearcoatNormalTexture"];
                    let has_pictures = has_pictures.iter().any(|member| extension[*member].is_object());
                    self.lose(has_pictures, "pictures of clear coat");
                }
                other => self.lose(true, other),
            }
        }
        Ok(())
    }

    /// Writes the shaders of a picture.
    fn texture(
        &mut self,
        texture: &TextureUse<'_>,
        path: &str,
        writer: &mut UsdaWriter<'_>,
    ) -> Result<(), WriteError> {
        let TextureUse { name, info, scale, is_color } = texture;
        let set = info["texCoord"].as_u64().unwrap_or(0);
        let varname = if set == 0 { "st".to_owned() } else { format!("st{set}") };
        let moved = &info["extensions"]["KHR_texture_transform"];
        let (reader, mover) = (format!("{name}Reader"), format!("{name}Transform"));
        writer.open("Shader", &reader, &[])?;
        writer.line("uniform token info:id = \"UsdPrimvarReader_float2\"")?;
        writer.line(&format!("string inputs:varname = {}", quoted(&varname)))?;
        writer.line("float2 outputs:result")?;
        writer.close()?;
        let mut source = format!("{path}/{reader}.outputs:result");
        if moved.is_object() {
            let size = numbers(&moved["scale"], [1.0; 2]);
            let offset = numbers(&moved["offset"], [0.0; 2]);
            self.lose(moved["rotation"].as_f64().unwrap_or(0.0) != 0.0, "rotations of pictures (here)");
            writer.open("Shader", &mover, &[])?;
            writer.line("uniform token info:id = \"UsdTransform2d\"")?;
            writer.line(&format!("float2 inputs:in.connect = <{source}>"))?;
            writer.line(&format!("float2 inputs:scale = {}", tuple(&size)))?;
            // glTF's v runs down and USD's up, as in `material.rs`.
            let offset = [offset[0], 1.0 - size[1] - offset[1]];
            writer.line(&format!("float2 inputs:translation = {}", tuple(&offset)))?;
            writer.line("float2 outputs:result")?;
            writer.close()?;
            source = format!("{path}/{mover}.outputs:result");
        }
        let object = info["index"].as_u64().and_then(|index| self.assets.textures.get(index as usize));
        let object = object.unwrap_or(&Value::Null);
        let image = object["source"]
            .as_u64()
            .or(object.pointer("/extensions/EXT_texture_webp/source").and_then(Value::as_u64));
        let image = image.and_then(|image| self.assets.images.get(image as usize));
        writer.open("Shader", name, &[])?;
        writer.line("uniform token info:id = \"UsdUVTexture\"")?;
        match image.map(|image| &image.content) {
            Some(ImageContent::Uri(uri)) => {
                // An @ in the name would end the path.
                writer.line(&format!("asset inputs:file = @./{}@", uri.replace('@', "%40")))?
            }
            _ => self.lose(true, "pictures, unless they are written beside it"),
        }
        writer.line(&format!("float2 inputs:st.connect = <{source}>"))?;
        let sampler =
            object["sampler"].as_u64().and_then(|sampler| self.assets.samplers.get(sampler as usize));
        for (input, member) in [("wrapS", "wrapS"), ("wrapT", "wrapT")] {
            let wrap = sampler.and_then(|sampler| sampler[member].as_u64()).unwrap_or(REPEAT);
            let word = WRAPS.iter().find(|(number, _)| *number == wrap).map_or("repeat", |(_, word)| *word);
            writer.line(&format!("token inputs:{input} = \"{word}\""))?;
        }
        let space = if *is_color { "sRGB" } else { "raw" };
        writer.line(&format!("token inputs:sourceColorSpace = \"{space}\""))?;
        if *scale != [1.0; 4] {
            writer.line(&format!("float4 inputs:scale = {}", tuple(scale)))?;
        }
        // Channels from 0 to 1 stand for numbers from −1 to 1.
        if *name == "Normal" {
            writer.line("float4 inputs:bias = (-1, -1, -1, 0)")?;
        }
        for (kind, output) in
            [("float3", "rgb"), ("float", "r"), ("float", "g"), ("float", "b"), ("float", "a")]
        {
            writer.line(&format!("{kind} outputs:{output}"))?;
        }
        writer.close()
    }
}

fn connected(kind: &str, input: &str, path: &str, output: &str) -> String {
    format!("{kind} inputs:{input}.connect = <{path}/{output}>")
}

fn numbers<const N: usize>(value: &Value, usual: [f64; N]) -> [f64; N] {
    let list = value.as_array().filter(|list| list.len() == N);
    list.map_or(usual, |list| std::array::from_fn(|k| list[k].as_f64().unwrap_or(usual[k])))
}
