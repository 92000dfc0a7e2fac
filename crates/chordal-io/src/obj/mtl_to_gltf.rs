//! Converts the materials of a library to those of glTF.
//!
//! Colours are taken as linear: Wavefront does not define it, the programs that write most libraries, and
//! most converters, take `Kd` and `Ke` as they are (Blender's exporter and importer, obj2gltf, gltfpack,
//! assimp), and only three.js takes them as sRGB. Pictures of colours are sRGB in both formats.
use super::mtl::{EXTRAS, MtlLook, MtlMaterial, MtlValue, is_map};
use super::mtl_map::MtlMap;
use super::pictures::ObjPictures;
use crate::files;
use crate::notes::NamedNotes;
use serde_json::{Map, Value, json};

/// A material for which only the name is known.
pub(super) fn plain_material(name: &str) -> Value {
    json!({
        "name": name,
        "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 0.5 },
        "doubleSided": true,
    })
}

/// The context for the conversion of one material.
pub(super) struct MtlConverter<'c, 'a, 'b> {
    pub pictures: &'c mut ObjPictures<'a, 'b>,
    /// The path of the library.
    pub library: &'c str,
    pub notes: &'c mut NamedNotes,
}

/// A map whose picture was opened.
struct PlacedMap {
    map: MtlMap,
    picture: usize,
}

impl MtlConverter<'_, '_, '_> {
    /// The glTF material; statements that glTF cannot express are in its extras.
    pub fn convert(&mut self, material: &MtlMaterial) -> Value {
        let mut extras = Map::new();
        let mut pbr = Map::new();
        let mut object = Map::new();
        let mut extensions = Map::new();
        object.insert("name".to_owned(), json!(material.name));
        let look = MtlLook::new(material, material.text("map_Kd").is_some());
        let color = self.placed(material, "map_Kd");
        let is_see_through = self.has_own_opacity(material, color.as_ref()) || look.opacity < 1.0;
        if look.opacity == 0.0 {
            let what = "materials are wholly transparent (d 0 or Tr 1)";
            self.notes.add("material-invisible", what, &material.name);
        }
        if material.color("Kd").is_some() || look.opacity < 1.0 {
            let [r, g, b] = look.base;
            pbr.insert("baseColorFactor".to_owned(), json!([r, g, b, look.opacity]));
        }
        if let Some(placed) = &color {
            pbr.insert("baseColorTexture".to_owned(), self.texture(placed, "map_Kd", &mut extras));
        }
        self.metal(material, &look, &mut pbr, &mut extras);
        object.insert("pbrMetallicRoughness".to_owned(), Value::Object(pbr));
        self.normals(material, &mut object, &mut extras);
        self.emission(material, &look, &mut object, &mut extensions, &mut extras);
        if is_see_through {
            object.insert("alphaMode".to_owned(), json!("BLEND"));
        }
        // Faces of an OBJ are visible from both sides; a library cannot say otherwise.
        object.insert("doubleSided".to_owned(), json!(true));
        coats(material, &mut extensions);
        self.keep_the_rest(material, &look, &object, &mut extras);
        if !extensions.is_empty() {
            object.insert("extensions".to_owned(), Value::Object(extensions));
        }
        object.insert("extras".to_owned(), json!({ EXTRAS: extras }));
        Value::Object(object)
    }

    /// The map of a keyword, if its picture is available.
    fn placed(&mut self, material: &MtlMaterial, keyword: &str) -> Option<PlacedMap> {
        let map = MtlMap::parse(material.text(keyword)?)?;
        let picture = self.pictures.open(files::folder(self.library), &map.path, self.notes)?;
        Some(PlacedMap { map, picture })
    }

    /// A glTF texture of a map.
    fn texture(&mut self, placed: &PlacedMap, keyword: &str, extras: &mut Map<String, Value>) -> Value {
        let MtlMap { scale, offset, others, .. } = &placed.map;
        let mut texture = json!({ "index": self.pictures.texture(placed.picture, &placed.map) });
        if *scale != [1.0; 2] || *offset != [0.0; 2] {
            // MTL's v runs up and glTF's down: v' = s v + o becomes 1 - v' = s (1 - v) + (1 - s - o).
            let v = 1.0 - scale[1] - offset[1];
            texture["extensions"] =
                json!({ "KHR_texture_transform": { "offset": [offset[0], v], "scale": scale } });
        }
        if !others.is_empty() {
            let what = "options of maps that glTF cannot say are kept as extras only";
            self.notes.add("map-option", what, &format!("{keyword} {others} in {}", self.library));
            let options = extras.entry("options").or_insert_with(|| json!({}));
            options[keyword] = json!(others);
        }
        texture
    }

    /// Whether the opacity is the alpha channel of the colour picture.
    fn has_own_opacity(&self, material: &MtlMaterial, color: Option<&PlacedMap>) -> bool {
        let (Some(color), Some(map)) = (color, material.text("map_d").and_then(MtlMap::parse)) else {
            return false;
        };
        let folder = files::folder(self.library);
        let [opacity, color] =
            [&map.path, &color.map.path].map(|path| files::resolve_path(folder, path).ok());
        opacity.is_some() && opacity == color
    }

    /// `Pm` and `Pr` with their pictures.
    ///
    /// glTF takes roughness and metal from two channels of one picture. So a grey picture for roughness can
    /// be used if there is no metal, and a single picture for both can be used unchanged.
    fn metal(
        &mut self,
        material: &MtlMaterial,
        look: &MtlLook,
        pbr: &mut Map<String, Value>,
        extras: &mut Map<String, Value>,
    ) {
        let mut metal = material.number("Pm").map_or(0.0, |metal| metal.clamp(0.0, 1.0));
        let mut roughness = look.roughness;
        let path = |keyword| material.text(keyword).and_then(MtlMap::parse).map(|map| map.path);
        let [rough, metals] = [path("map_Pr"), path("map_Pm")];
        let fits = rough.is_some() && (rough == metals || metals.is_none() && metal == 0.0);
        if let Some(placed) = if fits { self.placed(material, "map_Pr") } else { None } {
            if material.number("Pr").is_none() {
                roughness = 1.0;
            }
            if metals.is_some() && material.number("Pm").is_none() {
                metal = 1.0;
            }
            pbr.insert("metallicRoughnessTexture".to_owned(), self.texture(&placed, "map_Pr", extras));
        }
        pbr.insert("metallicFactor".to_owned(), json!(metal));
        if roughness != 1.0 {
            pbr.insert("roughnessFactor".to_owned(), json!(roughness));
        }
    }

    /// The picture of `norm`, or of a bump map that is a normal map and not a height map.
    fn normals(
        &mut self,
        material: &MtlMaterial,
        object: &mut Map<String, Value>,
        extras: &mut Map<String, Value>,
    ) {
        for keyword in ["norm", "map_Bump", "bump"] {
            let Some(placed) = self.placed(material, keyword) else { continue };
            if keyword != "norm" && self.pictures.is_gray(placed.picture) {
                continue;
            }
            let mut texture = self.texture(&placed, keyword, extras);
            if let Some(scale) = placed.map.steepness {
                texture["scale"] = json!(scale);
            }
            object.insert("normalTexture".to_owned(), texture);
            if keyword != "norm" {
                extras.insert("normal".to_owned(), json!(keyword));
            }
            return;
        }
    }

    fn emission(
        &mut self,
        material: &MtlMaterial,
        look: &MtlLook,
        object: &mut Map<String, Value>,
        extensions: &mut Map<String, Value>,
        extras: &mut Map<String, Value>,
    ) {
        let mut emission = look.emission;
        if let Some(placed) = self.placed(material, "map_Ke") {
            object.insert("emissiveTexture".to_owned(), self.texture(&placed, "map_Ke", extras));
            if emission == [0.0; 3] {
                emission = [1.0; 3];
            }
        }
        let strongest = emission.into_iter().fold(1.0, |most: f64, x| if x > most { x } else { most });
        if strongest > 1.0 {
            extensions.insert(
                "KHR_materials_emissive_strength".to_owned(),
                json!({ "emissiveStrength": strongest }),
            );
        }
        if emission != [0.0; 3] {
            object.insert("emissiveFactor".to_owned(), json!(emission.map(|x| x / strongest)));
        }
    }

    /// Keeps the statements that the glTF object does not express.
    fn keep_the_rest(
        &mut self,
        material: &MtlMaterial,
        look: &MtlLook,
        object: &Map<String, Value>,
        extras: &mut Map<String, Value>,
    ) {
        let metals = material.text("map_Pm");
        let normal = extras.get("normal").and_then(Value::as_str).unwrap_or("norm").to_owned();
        let pbr = &object["pbrMetallicRoughness"];
        for (keyword, value) in &material.values {
            // What the object says exactly is not repeated in the extras: the writer takes it from
            // the object, where users may have changed it.
            let is_said = match (*keyword, value) {
                ("Kd", _) => material.color("Kd") == Some(look.base),
                ("d", MtlValue::Numbers(numbers)) => numbers[..] == [look.opacity],
                ("Ke", _) => {
                    // For a stronger emission, the product of factor and strength may be rounded.
                    let is_weak = look.emission.iter().all(|x| *x <= 1.0);
                    material.color("Ke") == Some(look.emission) && is_weak
                }
                ("Pr" | "Pm" | "Ps" | "Pc", MtlValue::Numbers(numbers)) => {
                    numbers.iter().all(|x| (0.0..=1.0).contains(x))
                }
                ("Pcr", MtlValue::Numbers(numbers)) => {
                    material.number("Pc").is_some_and(|coat| coat > 0.0)
                        && numbers.iter().all(|x| (0.0..=1.0).contains(x))
                }
                ("map_Kd", _) => !pbr["baseColorTexture"].is_null(),
                ("map_Ke", _) => object.contains_key("emissiveTexture"),
                ("map_Pr", _) => !pbr["metallicRoughnessTexture"].is_null(),
                ("map_Pm", _) => metals.is_some() && !pbr["metallicRoughnessTexture"].is_null(),
                ("norm" | "map_Bump" | "bump", _) => {
                    *keyword == normal && object.contains_key("normalTexture")
                }
                _ => false,
            };
            if is_said {
                continue;
            }
            extras.insert((*keyword).to_owned(), value.to_json());
            let MtlValue::Text(_) = value else { continue };
            let name = format!("{keyword} in {}", self.library);
            if !is_map(keyword) {
                let what = "values in forms that glTF cannot say are kept as extras only";
                self.notes.add("mtl-form", what, &name);
            } else if !(*keyword == "map_d" && object.contains_key("alphaMode")) {
                let what = "maps that have no place in a glTF material are kept as extras, without pictures";
                self.notes.add("map-skipped", what, &name);
            }
        }
    }
}

/// Sheen and clear coat.
fn coats(material: &MtlMaterial, extensions: &mut Map<String, Value>) {
    let number = |keyword| material.number(keyword).map(|x| x.clamp(0.0, 1.0));
    if let Some(sheen) = number("Ps").filter(|sheen| *sheen > 0.0) {
        extensions
            .insert("KHR_materials_sheen".to_owned(), json!({ "sheenColorFactor": [sheen, sheen, sheen] }));
    }
    if let Some(coat) = number("Pc").filter(|coat| *coat > 0.0) {
        let mut object = json!({ "clearcoatFactor": coat });
        if let Some(roughness) = number("Pcr") {
            object["clearcoatRoughnessFactor"] = json!(roughness);
        }
        extensions.insert("KHR_materials_clearcoat".to_owned(), object);
    }
}
