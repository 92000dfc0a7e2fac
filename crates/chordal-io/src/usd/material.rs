//! Converts materials of USD's preview surface to those of glTF.
//!
//! Source: Pixar Animation Studios, *UsdPreviewSurface Specification* 2.6, openusd.org, 2023.
use super::pictures::{UsdPicture, UsdPictures};
use super::stage::{StagePrim, StageSource, UsdStage};
use super::value::{UsdNumbers, UsdValue};
use crate::ReadError;
use chordal::math::greater;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The most connections that are followed in a row. Chosen: chains in real files are a few long.
const MOST_STEPS: usize = 16;

/// The materials so far.
#[derive(Default)]
pub(super) struct UsdMaterials {
    pub pictures: UsdPictures,
    pub materials: Vec<Value>,
    pub names: Vec<String>,
    /// The primary texture coordinates of each material.
    pub texcoords: Vec<Option<String>>,
    /// The number of each path, from 1 on, with separate entries for one-sided and two-sided materials.
    numbers: BTreeMap<UsdMaterialKey, u32>,
    /// The same, by the prims that a material is composed of, since instances have their own paths.
    of_sources: BTreeMap<UsdMaterialSources, u32>,
}

/// The prims that a material is composed of.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct UsdMaterialSources {
    sources: Vec<StageSource>,
    is_double_sided: bool,
}

/// A material as bound to a mesh.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct UsdMaterialKey {
    pub path: String,
    pub is_double_sided: bool,
}

/// The value of a shader's input.
enum ShaderInput {
    Numbers(UsdNumbers),
    Word(String),
    /// The output of another shader.
    Output(StagePrim, String),
}

/// A texture of a material, with the channel in use.
struct ShaderTexture {
    info: Value,
    channel: String,
    scale: [f64; 4],
    bias: [f64; 4],
    file: String,
}

impl UsdMaterials {
    /// The number of a material, from 1 on; 0 for none.
    ///
    /// # Errors
    /// If its values are damaged.
    pub(super) fn number(
        &mut self,
        stage: &mut UsdStage<'_, '_>,
        key: &UsdMaterialKey,
    ) -> Result<u32, ReadError> {
        if let Some(known) = self.numbers.get(key) {
            return Ok(*known);
        }
        let number = match stage.prim_at(&key.path)? {
            Some(prim) if stage.type_name(&prim) == "Material" => {
                // A material is known by its sources: several paths may lead to one.
                let sources = prim.sources.iter().map(|source| StageSource { map: 0, ..*source }).collect();
                let sources = UsdMaterialSources { sources, is_double_sided: key.is_double_sided };
                if let Some(known) = self.of_sources.get(&sources) {
                    self.numbers.insert(key.clone(), *known);
                    return Ok(*known);
                }
                self.of_sources.insert(sources, self.materials.len() as u32 + 1);
                let mut reader = MaterialReader { stage, pictures: &mut self.pictures, texcoords: None };
                let mut material = reader.convert(&prim)?;
                if key.is_double_sided {
                    material["doubleSided"] = json!(true);
                }
                let texcoords = reader.texcoords;
                self.names.push(stage.name(&prim));
                self.texcoords.push(texcoords);
                self.materials.push(material);
                self.materials.len() as u32
            }
            _ => {
                let what = "materials that meshes name are not there";
                stage.note("material-missing", what, &key.path);
                0
            }
        };
        self.numbers.insert(key.clone(), number);
        Ok(number)
    }

    /// The primary texture coordinates of a material.
    pub(super) fn texcoords(&self, number: u32) -> Option<&String> {
        self.texcoords.get((number as usize).checked_sub(1)?)?.as_ref()
    }
}

struct MaterialReader<'m, 'a, 'b> {
    stage: &'m mut UsdStage<'a, 'b>,
    pictures: &'m mut UsdPictures,
    texcoords: Option<String>,
}

impl MaterialReader<'_, '_, '_> {
    fn convert(&mut self, prim: &StagePrim) -> Result<Value, ReadError> {
        let mut object = Map::new();
        object.insert("name".to_owned(), json!(self.stage.name(prim)));
        let surface = self.input(prim, "outputs:surface")?;
        let Some(ShaderInput::Output(shader, _)) = surface else {
            return Ok(self.unknown(prim, "no surface", object));
        };
        let kind = self.stage.word(&shader, "info:id")?.unwrap_or_default();
        if kind != "UsdPreviewSurface" {
            return Ok(self.unknown(prim, &kind, object));
        }
        self.surface(prim, &shader, &mut object)?;
        for output in ["outputs:displacement", "outputs:volume"] {
            if !self.stage.targets(prim, output).is_empty() {
                self.unread(prim, output.trim_start_matches("outputs:"));
            }
        }
        Ok(Value::Object(object))
    }

    fn unknown(&mut self, prim: &StagePrim, kind: &str, mut object: Map<String, Value>) -> Value {
        let what = "materials that are no preview surfaces keep their names alone";
        self.stage.note("materials-unread", what, &format!("{} ({kind})", prim.path));
        object.insert(
            "pbrMetallicRoughness".to_owned(),
            json!({ "metallicFactor": 0.0, "roughnessFactor": 0.5 }),
        );
        Value::Object(object)
    }

    fn unread(&self, prim: &StagePrim, what: &str) {
        let sentence = "inputs of materials that glTF cannot say were left out";
        self.stage.note("inputs-skipped", sentence, &format!("{what} of {}", prim.path));
    }

    /// An input or output: its value, or its connection.
    fn input(&mut self, prim: &StagePrim, name: &str) -> Result<Option<ShaderInput>, ReadError> {
        let (mut prim, mut name) = (prim.clone(), name.to_owned());
        for _ in 0..MOST_STEPS {
            let target = self.stage.targets(&prim, &name).into_iter().next();
            let Some(target) = target else {
                let value = self.stage.attribute(&prim, &name)?.and_then(|found| found.value);
                return Ok(match value.map(|value| value.into_owned()) {
                    Some(UsdValue::Numbers(numbers)) => Some(ShaderInput::Numbers(numbers)),
                    Some(UsdValue::Words(words)) => {
                        words.first().map(|word| ShaderInput::Word(word.to_string()))
                    }
                    _ => None,
                });
            };
            let Some((path, property)) = target.rsplit_once('.') else { return Ok(None) };
            let Some(next) = self.stage.prim_at(path)? else {
                self.stage.note("connection-missing", "connections lead to nothing", &target);
                return Ok(None);
            };
            let output = property.strip_prefix("outputs:");
            if let Some(output) = output.filter(|_| self.stage.type_name(&next) == "Shader") {
                return Ok(Some(ShaderInput::Output(next, output.to_owned())));
            }
            (prim, name) = (next, property.to_owned());
        }
        Ok(None)
    }

    /// One or more numbers; `usual` if the file gives none.
    fn value<const N: usize>(
        &mut self,
        shader: &StagePrim,
        name: &str,
        usual: [f64; N],
    ) -> Result<[f64; N], ReadError> {
        Ok(match self.input(shader, name)? {
            Some(ShaderInput::Numbers(numbers)) => {
                numbers.first().filter(|row| row.iter().all(|x| x.is_finite()))
            }
            _ => None,
        }
        .unwrap_or(usual))
    }

    /// The texture connected to an input.
    fn texture(
        &mut self,
        prim: &StagePrim,
        shader: &StagePrim,
        name: &str,
    ) -> Result<Option<ShaderTexture>, ReadError> {
        let Some(ShaderInput::Output(texture, channel)) = self.input(shader, name)? else { return Ok(None) };
        let kind = self.stage.word(&texture, "info:id")?.unwrap_or_default();
        if kind != "UsdUVTexture" {
            self.unread(prim, &format!("{kind} of {name}"));
            return Ok(None);
        }
        let Some(ShaderInput::Word(file)) = self.input(&texture, "inputs:file")? else {
            self.unread(prim, &format!("a texture without a file of {name}"));
            return Ok(None);
        };
        let layer = self.stage.layer_of(&texture, "inputs:file");
        let mut wraps = [String::new(), String::new()];
        for (wrap, name) in wraps.iter_mut().zip(["inputs:wrapS", "inputs:wrapT"]) {
            if let Some(ShaderInput::Word(word)) = self.input(&texture, name)? {
                *wrap = word;
            }
        }
        let picture = UsdPicture { asset: &file, layer, wraps };
        let Some(index) = self.pictures.texture(self.stage, &picture) else { return Ok(None) };
        let mut info = json!({ "index": index });
        self.coordinates(prim, &texture, &mut info)?;
        let scale = self.value(&texture, "inputs:scale", [1.0; 4])?;
        let bias = self.value(&texture, "inputs:bias", [0.0; 4])?;
        Ok(Some(ShaderTexture { info, channel, scale, bias, file }))
    }

    /// The texture coordinates of a texture, and their transform.
    fn coordinates(
        &mut self,
        prim: &StagePrim,
        texture: &StagePrim,
        info: &mut Value,
    ) -> Result<(), ReadError> {
        let Some(ShaderInput::Output(mut shader, _)) = self.input(texture, "inputs:st")? else {
            return Ok(());
        };
        if self.stage.word(&shader, "info:id")?.as_deref() == Some("UsdTransform2d") {
            let scale = self.value(&shader, "inputs:scale", [1.0; 2])?;
            let offset = self.value(&shader, "inputs:translation", [0.0; 2])?;
            if self.value(&shader, "inputs:rotation", [0.0])? != [0.0] {
                self.unread(prim, "the rotation of a texture");
            }
            if scale != [1.0; 2] || offset != [0.0; 2] {
                // USD's v runs up and glTF's down: v' = s v + o becomes 1 - v' = s (1 - v) + (1 - s - o).
                let v = 1.0 - scale[1] - offset[1];
                info["extensions"] =
                    json!({ "KHR_texture_transform": { "offset": [offset[0], v], "scale": scale } });
            }
            let Some(ShaderInput::Output(reader, _)) = self.input(&shader, "inputs:in")? else {
                return Ok(());
            };
            shader = reader;
        }
        if let Some(ShaderInput::Word(name)) = self.input(&shader, "inputs:varname")? {
            match &self.texcoords {
                None => self.texcoords = Some(name),
                Some(first) if *first != name => {
                    self.unread(prim, &format!("a second set of texture coordinates, {name}"))
                }
                Some(_) => {}
            }
        }
        Ok(())
    }

    /// Reports the scale and bias of a texture, unless they are as expected.
    fn check_scale(&self, prim: &StagePrim, texture: &ShaderTexture, bias: f64) {
        if texture.bias[..3] != [bias; 3] {
            self.unread(prim, &format!("the bias of {}", texture.file));
        }
    }

    fn surface(
        &mut self,
        prim: &StagePrim,
        shader: &StagePrim,
        object: &mut Map<String, Value>,
    ) -> Result<(), ReadError> {
        let mut pbr = Map::new();
        let mut extensions = Map::new();
        // The defaults are those of the specification.
        let mut base = self.value(shader, "inputs:diffuseColor", [0.18; 3])?;
        let mut opacity = self.value(shader, "inputs:opacity", [1.0])?[0];
        let color = self.texture(prim, shader, "inputs:diffuseColor")?;
        let clear = self.texture(prim, shader, "inputs:opacity")?;
        if let Some(color) = &color {
            self.check_scale(prim, color, 0.0);
            base = [color.scale[0], color.scale[1], color.scale[2]];
            pbr.insert("baseColorTexture".to_owned(), color.info.clone());
        }
        // glTF has colour and opacity in one picture.
        let is_of_picture = match (&clear, &color) {
            (Some(clear), Some(color)) => clear.file == color.file && clear.channel == "a",
            _ => false,
        };
        if let (Some(clear), true) = (&clear, is_of_picture) {
            opacity = clear.scale[3];
        } else if clear.is_some() {
            self.unread(prim, "opacity in a picture of its own");
        }
        pbr.insert("baseColorFactor".to_owned(), json!([base[0], base[1], base[2], opacity]));
        self.metal(prim, shader, &mut pbr)?;
        object.insert("pbrMetallicRoughness".to_owned(), Value::Object(pbr));
        let threshold = self.value(shader, "inputs:opacityThreshold", [0.0])?[0];
        if threshold > 0.0 {
            object.insert("alphaMode".to_owned(), json!("MASK"));
            object.insert("alphaCutoff".to_owned(), json!(threshold));
        } else if opacity < 1.0 || is_of_picture {
            object.insert("alphaMode".to_owned(), json!("BLEND"));
        }
        if let Some(mut normal) = self.texture(prim, shader, "inputs:normal")? {
            // A picture in bytes is scaled by 2 and shifted by -1; one with signed values is not.
            if normal.scale[0] == 2.0 {
                self.check_scale(prim, &normal, -1.0);
            } else {
                self.unread(prim, &format!("the scale of {}", normal.file));
            }
            object.insert("normalTexture".to_owned(), normal.info.take());
        }
        if let Some(mut occlusion) = self.texture(prim, shader, "inputs:occlusion")? {
            if occlusion.channel != "r" {
                self.unread(prim, &format!("occlusion in channel {}", occlusion.channel));
            } else {
                object.insert("occlusionTexture".to_owned(), occlusion.info.take());
            }
        }
        self.emission(prim, shader, object, &mut extensions)?;
        self.coat(prim, shader, &mut extensions)?;
        for (name, usual) in [("useSpecularWorkflow", 0.0), ("displacement", 0.0)] {
            if self.value(shader, &format!("inputs:{name}"), [usual])? != [usual] {
                self.unread(prim, name);
            }
        }
        if !extensions.is_empty() {
            object.insert("extensions".to_owned(), Value::Object(extensions));
        }
        Ok(())
    }

    /// Metalness and roughness: glTF takes them from the blue and green channels of one picture.
    fn metal(
        &mut self,
        prim: &StagePrim,
        shader: &StagePrim,
        pbr: &mut Map<String, Value>,
    ) -> Result<(), ReadError> {
        let mut metal = self.value(shader, "inputs:metallic", [0.0])?[0];
        // A half is the default of the specification.
        let mut roughness = self.value(shader, "inputs:roughness", [0.5])?[0];
        let metals = self.texture(prim, shader, "inputs:metallic")?;
        let rough = self.texture(prim, shader, "inputs:roughness")?;
        let is_in = |texture: &ShaderTexture, channel: &str| texture.channel == channel;
        let fits = match (&metals, &rough) {
            (None, None) => true,
            (Some(metals), None) => is_in(metals, "b"),
            (None, Some(rough)) => is_in(rough, "g") || (metal == 0.0 && is_in(rough, "r")),
            (Some(metals), Some(rough)) => {
                metals.file == rough.file && is_in(metals, "b") && is_in(rough, "g")
            }
        };
        // A picture for only one of them would also change the other, unless that is 0 or the picture is
        // grey.
        let is_alone = metals.is_some() != rough.is_some();
        if !fits || (is_alone && !(rough.is_some() && metal == 0.0)) {
            self.unread(prim, "pictures of metal and roughness that are not one");
        } else if let Some(texture) = rough.as_ref().or(metals.as_ref()) {
            metal = metals.as_ref().map_or(metal, |texture| texture.scale[2]);
            roughness = rough.as_ref().map_or(roughness, |texture| texture.scale[1]);
            pbr.insert("metallicRoughnessTexture".to_owned(), texture.info.clone());
        }
        pbr.insert("metallicFactor".to_owned(), json!(metal));
        pbr.insert("roughnessFactor".to_owned(), json!(roughness));
        Ok(())
    }

    fn emission(
        &mut self,
        prim: &StagePrim,
        shader: &StagePrim,
        object: &mut Map<String, Value>,
        extensions: &mut Map<String, Value>,
    ) -> Result<(), ReadError> {
        let mut emission = self.value(shader, "inputs:emissiveColor", [0.0; 3])?;
        if let Some(texture) = self.texture(prim, shader, "inputs:emissiveColor")? {
            self.check_scale(prim, &texture, 0.0);
            emission = [texture.scale[0], texture.scale[1], texture.scale[2]];
            object.insert("emissiveTexture".to_owned(), texture.info);
        }
        let strongest = emission.into_iter().fold(1.0, greater);
        if strongest > 1.0 {
            let strength = json!({ "emissiveStrength": strongest });
            extensions.insert("KHR_materials_emissive_strength".to_owned(), strength);
        }
        if emission != [0.0; 3] {
            object.insert("emissiveFactor".to_owned(), json!(emission.map(|x| x / strongest)));
        }
        Ok(())
    }

    /// Clear coat, and the index of refraction.
    fn coat(
        &mut self,
        prim: &StagePrim,
        shader: &StagePrim,
        extensions: &mut Map<String, Value>,
    ) -> Result<(), ReadError> {
        for name in ["clearcoat", "clearcoatRoughness", "ior", "specularColor", "displacement"] {
            if let Some(ShaderInput::Output(..)) = self.input(shader, &format!("inputs:{name}"))? {
                self.unread(prim, &format!("a picture of {name}"));
            }
        }
        let [coat] = self.value(shader, "inputs:clearcoat", [0.0])?;
        if coat > 0.0 {
            // A hundredth is the default of the specification.
            let [roughness] = self.value(shader, "inputs:clearcoatRoughness", [0.01])?;
            let coat = json!({ "clearcoatFactor": coat, "clearcoatRoughnessFactor": roughness });
            extensions.insert("KHR_materials_clearcoat".to_owned(), coat);
        }
        // One and a half is the default of both formats.
        let [ior] = self.value(shader, "inputs:ior", [1.5])?;
        if ior != 1.5 {
            extensions.insert("KHR_materials_ior".to_owned(), json!({ "ior": ior }));
        }
        Ok(())
    }
}
