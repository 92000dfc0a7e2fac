//! Converts the materials of a scene to the text of a material library.
use super::mtl::{EXTRAS, MtlLook, MtlMaterial, MtlValue, exponent, is_map};
use super::mtl_map::MtlMap;
use super::names::one_line;
use super::pictures::file_name;
use crate::number::put_double;
use crate::{FileLocation, ImageContent, SceneAssets, Warning};
use serde_json::{Map, Value};

/// glTF's `CLAMP_TO_EDGE` and `REPEAT`.
const CLAMP: u64 = 33071;
const REPEAT: u64 = 10497;

/// Writes a material library.
pub(super) struct MtlWriter<'a> {
    assets: &'a SceneAssets,
    /// The file of each image.
    files: &'a [String],
    /// Whether each file is referred to.
    pub is_used: Vec<bool>,
    pub text: Vec<u8>,
    pub lost: Vec<Warning>,
}

impl<'a> MtlWriter<'a> {
    pub fn new(assets: &'a SceneAssets, files: &'a [String]) -> Self {
        let is_used = vec![false; files.len()];
        Self { assets, files, is_used, text: Vec::new(), lost: Vec::new() }
    }

    pub fn lose(&mut self, what: &str) {
        let message = format!("MTL holds no {what}");
        match self.lost.iter_mut().find(|lost| *lost.message == message) {
            Some(known) => known.count += 1,
            None => self.lost.push(Warning {
                code: "not-written",
                count: 1,
                place: FileLocation::File,
                message: message.into(),
            }),
        }
    }

    /// Adds a material under a name. The statements of its library are written again if glTF still has the
    /// same values. A material of another format gets statements for both old and new programs.
    pub fn material(&mut self, name: &str, material: &Value) {
        if !self.text.is_empty() {
            self.text.push(b'\n');
        }
        self.line("newmtl", name);
        let extras = material["extras"][EXTRAS].as_object();
        let empty = Map::new();
        let original = MtlMaterial::from_extras(extras.unwrap_or(&empty));
        let pbr = &material["pbrMetallicRoughness"];
        let look =
            MtlLook::new(&original, !pbr["baseColorTexture"].is_null() || original.text("map_Kd").is_some());
        let numbers = |value: &Value| -> Vec<f64> {
            value.as_array().map_or_else(Vec::new, |items| items.iter().filter_map(Value::as_f64).collect())
        };
        let factor = numbers(&pbr["baseColorFactor"]);
        let [r, g, b, opacity] = factor[..] else {
            return self.rest(material, &original, &look, [1.0; 4], extras.is_none());
        };
        self.rest(material, &original, &look, [r, g, b, opacity], true);
    }

    fn rest(
        &mut self,
        material: &Value,
        original: &MtlMaterial,
        look: &MtlLook,
        [r, g, b, opacity]: [f64; 4],
        has_color: bool,
    ) {
        let extras = material["extras"][EXTRAS].as_object();
        let pbr = &material["pbrMetallicRoughness"];
        let factor = |value: &Value, default: f64| value.as_f64().unwrap_or(default);
        let metal = factor(&pbr["metallicFactor"], 1.0);
        let roughness = factor(&pbr["roughnessFactor"], 1.0);
        // What still looks as it was read keeps the text of its library; what was changed is
        // written anew. `written` keeps the loop below from repeating either.
        let mut written: Vec<&str> = Vec::new();
        if original.color("Kd").is_some() && look.base == [r, g, b] {
            self.original_statements(original, &["Kd"], &mut written);
        } else if has_color {
            self.numbers("Kd", &[r, g, b]);
            written.push("Kd");
        }
        if (original.get("d").is_some() || original.get("Tr").is_some()) && look.opacity == opacity {
            self.original_statements(original, &["d", "Tr"], &mut written);
        } else {
            if extras.is_none() || opacity != 1.0 {
                self.numbers("d", &[opacity]);
            }
            written.extend(["d", "Tr"]);
        }
        let emission = emission(material);
        if original.color("Ke").is_some() && look.emission == emission {
            self.original_statements(original, &["Ke"], &mut written);
        } else {
            if emission != [0.0; 3] {
                self.numbers("Ke", &emission);
            }
            written.push("Ke");
        }
        // Without extras the material is from no library, so no statement is left out for being
        // absent there.
        if extras.is_none() {
            // The reflectance of glTF at normal incidence (specification, appendix B.2), for programs that do
            // not support metal and roughness.
            const DIELECTRIC: f64 = 0.04;
            let specular = [r, g, b].map(|x| DIELECTRIC + (x - DIELECTRIC) * metal);
            self.numbers("Ks", &specular);
            self.numbers("Ns", &[exponent(roughness)]);
            self.numbers("illum", &[2.0]);
        }
        if extras.is_none() || (look.roughness != roughness) {
            self.numbers("Pr", &[roughness]);
            written.push("Pr");
        }
        let is_unchanged = original.number("Pm").is_some_and(|x| x.clamp(0.0, 1.0) == metal);
        if !is_unchanged && (extras.is_none() || metal != 0.0) {
            self.numbers("Pm", &[metal]);
            written.push("Pm");
        }
        self.coats(&material["extensions"], &mut written);
        for (keyword, _) in original.values.iter().filter(|(keyword, _)| !is_map(keyword)) {
            self.original_statements(original, &[keyword], &mut written);
        }
        self.maps(material, original, metal);
        self.count_lost(material);
    }

    /// Writes statements as in the source library, each once.
    fn original_statements(
        &mut self,
        original: &MtlMaterial,
        keywords: &[&'static str],
        written: &mut Vec<&str>,
    ) {
        for keyword in keywords {
            let Some(value) = original.get(keyword).filter(|_| !written.contains(keyword)) else { continue };
            match value {
                MtlValue::Numbers(numbers) => self.numbers(keyword, numbers),
                MtlValue::Text(text) => self.line(keyword, text),
            }
            written.push(keyword);
        }
    }

    fn coats(&mut self, extensions: &Value, written: &mut Vec<&str>) {
        let sheen = &extensions["KHR_materials_sheen"]["sheenColorFactor"];
        if let Some(sheen) = sheen[0].as_f64() {
            self.numbers("Ps", &[sheen]);
            written.push("Ps");
        }
        let coat = &extensions["KHR_materials_clearcoat"];
        for (keyword, member) in [("Pc", "clearcoatFactor"), ("Pcr", "clearcoatRoughnessFactor")] {
            if let Some(value) = coat[member].as_f64() {
                self.numbers(keyword, &[value]);
                written.push(keyword);
            }
        }
    }

    fn maps(&mut self, material: &Value, original: &MtlMaterial, metal: f64) {
        let extras = &material["extras"][EXTRAS];
        let pbr = &material["pbrMetallicRoughness"];
        let normal = extras["normal"].as_str().filter(|keyword| is_map(keyword)).unwrap_or("norm");
        let color = &pbr["baseColorTexture"];
        self.texture("map_Kd", color, extras);
        if !extras.is_object() && material["alphaMode"] == "BLEND" {
            self.texture("map_d", color, extras);
        }
        self.texture("map_Ke", &material["emissiveTexture"], extras);
        self.texture(normal, &material["normalTexture"], extras);
        let rough = &pbr["metallicRoughnessTexture"];
        self.texture("map_Pr", rough, extras);
        if metal != 0.0 {
            self.texture("map_Pm", rough, extras);
        }
        for (keyword, value) in original.values.iter().filter(|(keyword, _)| is_map(keyword)) {
            let MtlValue::Text(text) = value else { continue };
            let line = self.with_file(text);
            self.line(keyword, &line);
        }
    }

    /// A map as in the source library, with the name of the written picture file, if there is one.
    fn with_file(&mut self, text: &str) -> String {
        let renamed = MtlMap::parse(text).and_then(|map| {
            let path = map.path.replace('\\', "/");
            let path = path.trim_start_matches("./");
            let is_at = |name: &str| name == path || name.ends_with(&format!("/{path}"));
            let images = self.assets.images.iter();
            let image = images.map(|image| image.properties.get("name")).position(|name| {
                name.and_then(Value::as_str).is_some_and(|name| is_at(name) && !file_name(name).is_empty())
            })?;
            Some((text.rfind(&map.path)?, image))
        });
        match renamed {
            Some((at, image)) => {
                self.is_used[image] = true;
                format!("{}{}", text[..at].trim_end_matches('"'), self.files[image])
            }
            None => text.to_owned(),
        }
    }

    /// Writes a texture, if there is one.
    fn texture(&mut self, keyword: &str, info: &Value, extras: &Value) {
        let at = |value: &Value| value.as_u64().and_then(|at| usize::try_from(at).ok());
        let Some(texture) = at(&info["index"]).and_then(|at| self.assets.textures.get(at)) else { return };
        let of_extensions = texture["extensions"].as_object().into_iter().flat_map(Map::values);
        let source = of_extensions.map(|extension| &extension["source"]).find_map(at);
        let Some(image) = at(&texture["source"]).or(source).filter(|image| *image < self.files.len()) else {
            return self.lose("textures without a picture");
        };
        self.is_used[image] = true;
        let mut line = Vec::new();
        let transform = &info["extensions"]["KHR_texture_transform"];
        let pair =
            |member: &str, default: f64| [0, 1].map(|k| transform[member][k].as_f64().unwrap_or(default));
        let ([su, sv], [ou, ov]) = (pair("scale", 1.0), pair("offset", 0.0));
        // The inverse of the reader's formula: v runs up here.
        let ov = 1.0 - sv - ov;
        for (option, [u, v], default) in [("-s", [su, sv], 1.0), ("-o", [ou, ov], 0.0)] {
            if [u, v] != [default; 2] {
                line.extend_from_slice(option.as_bytes());
                for x in [u, v, default] {
                    line.push(b' ');
                    put_double(&mut line, x + 0.0);
                }
                line.push(b' ');
            }
        }
        let is_turned = transform["rotation"].as_f64().is_some_and(|angle| angle != 0.0);
        let has_other_set = [&info["texCoord"], &transform["texCoord"]].iter().any(|set| at(set) > Some(0));
        let sampler = at(&texture["sampler"]).and_then(|at| self.assets.samplers.get(at));
        let wraps = ["wrapS", "wrapT"]
            .map(|member| sampler.and_then(|sampler| sampler[member].as_u64()).unwrap_or(REPEAT));
        if wraps == [CLAMP; 2] {
            line.extend_from_slice(b"-clamp on ");
        }
        let mut text = String::from_utf8_lossy(&line).into_owned();
        if let Some(scale) = info["scale"].as_f64() {
            text += &format!("-bm {scale:?} ");
        }
        if let Some(others) = extras["options"][keyword].as_str() {
            text += &format!("{others} ");
        }
        text += &self.files[image];
        self.line(keyword, &text);
        for (is_lost, what) in [
            (is_turned, "textures that are turned"),
            (has_other_set, "textures by another set of texture coordinates than the first"),
            (wraps != [CLAMP; 2] && wraps != [REPEAT; 2], "textures that are mirrored, or end on two sides"),
        ] {
            if is_lost {
                self.lose(what);
            }
        }
    }

    /// Counts the properties of a material that no statement can express.
    fn count_lost(&mut self, material: &Value) {
        if !material["occlusionTexture"].is_null() {
            self.lose("occlusion textures");
        }
        if material["alphaMode"] == "MASK" {
            self.lose("opacity that ends at a threshold");
        }
        let members = |value: &Value| -> Vec<(String, Value)> {
            let members = value.as_object().into_iter().flatten();
            members.map(|(key, value)| (key.clone(), value.clone())).collect()
        };
        for (name, extension) in members(&material["extensions"]) {
            let supported: &[&str] = match name.as_str() {
                "KHR_materials_emissive_strength" => &["emissiveStrength"],
                "KHR_materials_clearcoat" => &["clearcoatFactor", "clearcoatRoughnessFactor"],
                "KHR_materials_sheen" if is_gray(&extension) => &["sheenColorFactor"],
                _ => &[],
            };
            if members(&extension).iter().any(|(key, _)| !supported.contains(&key.as_str()))
                || supported.is_empty()
            {
                self.lose(&format!("all that {} says", one_line(&name)));
            }
        }
        if members(&material["extras"]).iter().any(|(key, _)| key != EXTRAS) {
            self.lose("extras of materials");
        }
    }

    fn numbers(&mut self, keyword: &str, numbers: &[f64]) {
        self.text.extend_from_slice(keyword.as_bytes());
        for number in numbers {
            self.text.push(b' ');
            put_double(&mut self.text, *number);
        }
        self.text.push(b'\n');
    }

    fn line(&mut self, keyword: &str, rest: &str) {
        let line = format!("{keyword} {}\n", one_line(rest));
        self.text.extend_from_slice(line.as_bytes());
    }

    /// Counts pictures that no material uses, and those in files that were not opened.
    pub fn count_pictures(&mut self) {
        for (image, is_used) in self.assets.images.iter().zip(self.is_used.clone()) {
            if !is_used {
                self.lose("pictures that no material shows");
            } else if matches!(image.content, ImageContent::Uri(_)) {
                self.lose("pictures that were not opened: their names were written");
            }
        }
    }
}

/// The emission: the factor times its strength.
fn emission(material: &Value) -> [f64; 3] {
    let strength = &material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"];
    let strength = strength.as_f64().unwrap_or(1.0);
    [0, 1, 2].map(|k| material["emissiveFactor"][k].as_f64().unwrap_or(0.0) * strength)
}

fn is_gray(sheen: &Value) -> bool {
    let color = &sheen["sheenColorFactor"];
    color[0] == color[1] && color[1] == color[2]
}
