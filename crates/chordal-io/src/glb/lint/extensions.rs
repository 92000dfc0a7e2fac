//! Extensions that the validator knows, and the objects that may have them.
use super::{GltfLint, IntegerRule, NumberRule, PointerToken};
use crate::glb::json::JsonValue;
use std::collections::BTreeSet;

/// An object that may have extensions.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum ExtensionHost {
    Root,
    Node,
    Material,
    Primitive,
    Texture,
    TextureInfo,
    ChannelTarget,
    /// An object for which the validator knows no extension.
    Other,
}

/// The extensions that the validator knows, and the objects that may have them.
const KNOWN: [(&str, &[ExtensionHost]); 18] = [
    ("EXT_texture_webp", &[ExtensionHost::Texture]),
    ("KHR_animation_pointer", &[ExtensionHost::ChannelTarget]),
    ("KHR_lights_punctual", &[ExtensionHost::Root, ExtensionHost::Node]),
    ("KHR_materials_anisotropy", &[ExtensionHost::Material]),
    ("KHR_materials_clearcoat", &[ExtensionHost::Material]),
    ("KHR_materials_dispersion", &[ExtensionHost::Material]),
    ("KHR_materials_emissive_strength", &[ExtensionHost::Material]),
    ("KHR_materials_ior", &[ExtensionHost::Material]),
    ("KHR_materials_iridescence", &[ExtensionHost::Material]),
    ("KHR_materials_pbrSpecularGlossiness", &[ExtensionHost::Material]),
    ("KHR_materials_sheen", &[ExtensionHost::Material]),
    ("KHR_materials_specular", &[ExtensionHost::Material]),
    ("KHR_materials_transmission", &[ExtensionHost::Material]),
    ("KHR_materials_unlit", &[ExtensionHost::Material]),
    ("KHR_materials_variants", &[ExtensionHost::Root, ExtensionHost::Primitive]),
    ("KHR_materials_volume", &[ExtensionHost::Material]),
    (QUANTIZATION, &[]),
    ("KHR_texture_transform", &[ExtensionHost::TextureInfo]),
];

/// The only known extension that must be required if it is used, since the file cannot be read without it.
pub(super) const QUANTIZATION: &str = "KHR_mesh_quantization";

impl<'a> GltfLint<'a> {
    /// Records the extensions that a document declares.
    pub(super) fn declare(&mut self, used: &[&'a str], required: &[&'a str]) {
        self.declared = used.iter().copied().collect();
        let needed: BTreeSet<&str> = required.iter().copied().collect();
        if let Some(i) = used.iter().position(|name| *name == QUANTIZATION)
            && !needed.contains(QUANTIZATION)
        {
            self.within("extensionsUsed", |lint| {
                lint.issue_below("NON_REQUIRED_EXTENSION", i, "KHR_mesh_quantization cannot be optional");
            });
        }
        for (i, name) in required.iter().enumerate() {
            if self.declares(name) {
                continue;
            }
            self.within("extensionsRequired", |lint| {
                lint.issue("UNUSED_EXTENSION_REQUIRED", Some(i.into()), || {
                    format!("extension {name} is required and not in extensionsUsed")
                });
            });
        }
    }

    /// Whether a document declares an extension.
    pub(super) fn declares(&self, name: &str) -> bool {
        self.declared.contains(name)
    }

    /// The extensions of an object that are known and allowed there. Extras are not checked.
    pub(super) fn extensions(
        &mut self,
        map: &'a JsonValue,
        at: ExtensionHost,
    ) -> Vec<(&'static str, &'a JsonValue)> {
        let mut out = Vec::new();
        let Some(all) = self.object(map, "extensions", false) else { return out };
        self.within("extensions", |lint| {
            for (name, value) in all.entries() {
                let value = matches!(value, JsonValue::Object(_)).then_some(value);
                if value.is_none() {
                    lint.mismatch(name, "object");
                }
                let entry = KNOWN.iter().find(|(entry, _)| **entry == **name);
                match entry.filter(|_| lint.declares(name)) {
                    None if !lint.declares(name) => {
                        lint.issue_below(
                            "UNDECLARED_EXTENSION",
                            &**name,
                            "the extension is not in extensionsUsed",
                        );
                    }
                    // Declared but not known: nothing inside it can be checked.
                    None => {}
                    Some((_, places)) if !places.contains(&at) => {
                        lint.issue_below(
                            "UNEXPECTED_EXTENSION_OBJECT",
                            &**name,
                            "the extension has no place here",
                        );
                    }
                    Some((entry, _)) => out.extend(value.map(|value| (*entry, value))),
                }
            }
        });
        out
    }

    /// Visits extensions, each with its own pointer.
    pub(super) fn each_extension(
        &mut self,
        extensions: Vec<(&'static str, &'a JsonValue)>,
        mut look: impl FnMut(&mut Self, &'static str, &'a JsonValue),
    ) {
        self.within("extensions", |lint| {
            for (name, value) in extensions {
                lint.within(name, |lint| {
                    lint.extensions(value, ExtensionHost::Other);
                    look(lint, name, value);
                });
            }
        });
    }

    /// Checks lights and variants, which are extensions of the root.
    pub(super) fn root_extensions(&mut self, root: &'a JsonValue) {
        let extensions = self.extensions(root, ExtensionHost::Root);
        self.each_extension(extensions, |lint, name, value| match name {
            "KHR_lights_punctual" => lint.items_of(value, "lights", Self::light),
            _ => lint.items_of(value, "variants", |lint, variant| {
                lint.text(variant, "name", true);
                lint.extensions(variant, ExtensionHost::Other);
            }),
        });
    }

    pub(super) fn items_of(
        &mut self,
        map: &'a JsonValue,
        key: &'a str,
        look: impl Fn(&mut Self, &'a JsonValue),
    ) {
        for (i, item) in self.objects(map, key).unwrap_or_default().iter().enumerate() {
            self.within(key, |lint| lint.within(i, |lint| look(lint, item)));
        }
    }

    fn light(&mut self, light: &'a JsonValue) {
        self.numbers(light, "color", 3, (0.0, 1.0));
        self.number(light, "intensity", NumberRule::AT_LEAST_0);
        self.number(light, "range", NumberRule::ABOVE_0);
        self.name(light);
        if self.text(light, "type", true) == Some("spot")
            && let Some(spot) = self.object(light, "spot", true)
        {
            self.within("spot", |lint| lint.spot(spot));
        }
        self.extensions(light, ExtensionHost::Other);
    }

    fn spot(&mut self, spot: &'a JsonValue) {
        use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
        // The inner angle stays below the right angle by one floating-point step.
        let inner = NumberRule { min: 0.0, max: FRAC_PI_2.next_down(), ..NumberRule::ANY };
        let inner = self.number(spot, "innerConeAngle", inner).or(0.0);
        let outer =
            self.number(spot, "outerConeAngle", NumberRule { above: 0.0, max: FRAC_PI_2, ..NumberRule::ANY });
        if let (Some(inner), Some(outer)) = (inner, outer.or(FRAC_PI_4))
            && outer <= inner
        {
            let place = Some("outerConeAngle".into());
            self.issue("KHR_LIGHTS_PUNCTUAL_LIGHT_SPOT_ANGLES", place, || {
                format!("{outer} is not above {inner}")
            });
        }
        self.extensions(spot, ExtensionHost::Other);
    }

    /// Resolves an index into a list of a root extension.
    pub(super) fn extension_reference(
        &mut self,
        path: [&'a str; 2],
        index: Option<usize>,
        below: PointerToken<'a>,
    ) {
        let [name, list] = path;
        let extension = self.root_extensions.and_then(|map| map.get(name)).filter(|_| self.declares(name));
        let Some(extension) = extension else {
            self.issue("UNSATISFIED_DEPENDENCY", None, || format!("/extensions/{name} is missing"));
            return;
        };
        let Some(index) = index else { return };
        let items = extension.get(list).and_then(JsonValue::items);
        if !matches!(items.and_then(|items| items.get(index)), Some(JsonValue::Object(_))) {
            self.issue("UNRESOLVED_REFERENCE", Some(below), || format!("{list} has no object {index}"));
        }
    }

    /// Checks the numbers and colours of a material extension. The caller checks its textures.
    pub(super) fn material_extension(&mut self, name: &str, map: &'a JsonValue) {
        let above_1 = NumberRule { min: 1.0, ..NumberRule::ANY };
        let reals: &[(&str, NumberRule)] = match name {
            "KHR_materials_anisotropy" => {
                &[("anisotropyStrength", NumberRule::UNIT), ("anisotropyRotation", NumberRule::ANY)]
            }
            "KHR_materials_clearcoat" => {
                &[("clearcoatFactor", NumberRule::UNIT), ("clearcoatRoughnessFactor", NumberRule::UNIT)]
            }
            "KHR_materials_dispersion" => &[("dispersion", NumberRule::AT_LEAST_0)],
            "KHR_materials_emissive_strength" => &[("emissiveStrength", NumberRule::AT_LEAST_0)],
            // Below 1 only 0 is allowed, which the extension gives a meaning of its own.
            "KHR_materials_ior" => &[("ior", NumberRule { except: Some(0.0), ..above_1 })],
            "KHR_materials_iridescence" => &[
                ("iridescenceFactor", NumberRule::UNIT),
                ("iridescenceIor", above_1),
                ("iridescenceThicknessMinimum", NumberRule::AT_LEAST_0),
                ("iridescenceThicknessMaximum", NumberRule::AT_LEAST_0),
            ],
            "KHR_materials_pbrSpecularGlossiness" => &[("glossinessFactor", NumberRule::UNIT)],
            "KHR_materials_sheen" => &[("sheenRoughnessFactor", NumberRule::UNIT)],
            "KHR_materials_specular" => &[("specularFactor", NumberRule::UNIT)],
            "KHR_materials_transmission" => &[("transmissionFactor", NumberRule::UNIT)],
            "KHR_materials_volume" => {
                &[("attenuationDistance", NumberRule::ABOVE_0), ("thicknessFactor", NumberRule::AT_LEAST_0)]
            }
            _ => &[],
        };
        for (key, rule) in reals {
            self.number(map, key, *rule);
        }
        let colours: &[(&str, usize, f64)] = match name {
            "KHR_materials_pbrSpecularGlossiness" => &[("diffuseFactor", 4, 1.0), ("specularFactor", 3, 1.0)],
            "KHR_materials_sheen" => &[("sheenColorFactor", 3, 1.0)],
            "KHR_materials_specular" => &[("specularColorFactor", 3, f64::INFINITY)],
            "KHR_materials_volume" => &[("attenuationColor", 3, 1.0)],
            _ => &[],
        };
        for (key, length, max) in colours {
            self.numbers(map, key, *length, (0.0, *max));
        }
    }

    /// The texture coordinate set by which `KHR_texture_transform` overrides the texture's own.
    pub(super) fn texture_transform(&mut self, map: &'a JsonValue) -> Option<u64> {
        self.any_numbers::<2>(map, "offset");
        self.number(map, "rotation", NumberRule::ANY);
        self.any_numbers::<2>(map, "scale");
        self.integer(map, "texCoord", IntegerRule::default()).value()
    }
}

/// The texture fields of a material extension.
pub(super) fn textures_of(name: &str) -> &'static [&'static str] {
    match name {
        "KHR_materials_anisotropy" => &["anisotropyTexture"],
        "KHR_materials_clearcoat" => {
            &["clearcoatTexture", "clearcoatRoughnessTexture", "clearcoatNormalTexture"]
        }
        "KHR_materials_iridescence" => &["iridescenceTexture", "iridescenceThicknessTexture"],
        "KHR_materials_pbrSpecularGlossiness" => &["diffuseTexture", "specularGlossinessTexture"],
        "KHR_materials_sheen" => &["sheenColorTexture", "sheenRoughnessTexture"],
        "KHR_materials_specular" => &["specularTexture", "specularColorTexture"],
        "KHR_materials_transmission" => &["transmissionTexture"],
        "KHR_materials_volume" => &["thicknessTexture"],
        _ => &[],
    }
}
