//! Extensions that the validator knows, and where they may stand.
use super::{Lint, Real, Step, Whole};
use crate::glb::json::Json;
use std::collections::BTreeSet;

/// An object that may carry extensions.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum At {
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

/// The extensions that the validator knows, and their places.
const KNOWN: [(&str, &[At]); 18] = [
    ("EXT_texture_webp", &[At::Texture]),
    ("KHR_animation_pointer", &[At::ChannelTarget]),
    ("KHR_lights_punctual", &[At::Root, At::Node]),
    ("KHR_materials_anisotropy", &[At::Material]),
    ("KHR_materials_clearcoat", &[At::Material]),
    ("KHR_materials_dispersion", &[At::Material]),
    ("KHR_materials_emissive_strength", &[At::Material]),
    ("KHR_materials_ior", &[At::Material]),
    ("KHR_materials_iridescence", &[At::Material]),
    ("KHR_materials_pbrSpecularGlossiness", &[At::Material]),
    ("KHR_materials_sheen", &[At::Material]),
    ("KHR_materials_specular", &[At::Material]),
    ("KHR_materials_transmission", &[At::Material]),
    ("KHR_materials_unlit", &[At::Material]),
    ("KHR_materials_variants", &[At::Root, At::Primitive]),
    ("KHR_materials_volume", &[At::Material]),
    (QUANTIZATION, &[]),
    ("KHR_texture_transform", &[At::TextureInfo]),
];

/// The only known extension that changes what a file without it means, so that it cannot be optional.
pub(super) const QUANTIZATION: &str = "KHR_mesh_quantization";

impl<'a> Lint<'a> {
    /// Notes the extensions that a document names.
    pub(super) fn declare(&mut self, used: &[&'a str], required: &[&'a str]) {
        self.declared = used.iter().copied().collect();
        let needed: BTreeSet<&str> = required.iter().copied().collect();
        if let Some(i) = used.iter().position(|name| *name == QUANTIZATION)
            && !needed.contains(QUANTIZATION)
        {
            self.within("extensionsUsed", |lint| {
                lint.at("NON_REQUIRED_EXTENSION", i, "KHR_mesh_quantization cannot be optional");
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

    /// Whether a document names an extension.
    pub(super) fn declares(&self, name: &str) -> bool {
        self.declared.contains(name)
    }

    /// The extensions of an object that are known and may stand there. Extras may be anything.
    pub(super) fn extensions(&mut self, map: &'a Json, at: At) -> Vec<(&'static str, &'a Json)> {
        let mut out = Vec::new();
        let Some(all) = self.object(map, "extensions", false) else { return out };
        self.within("extensions", |lint| {
            for (name, value) in all.entries() {
                let value = matches!(value, Json::Object(_)).then_some(value);
                if value.is_none() {
                    lint.mismatch(name, "object");
                }
                let known = KNOWN.iter().find(|(known, _)| **known == **name);
                match known.filter(|_| lint.declares(name)) {
                    None if !lint.declares(name) => {
                        lint.at("UNDECLARED_EXTENSION", &**name, "the extension is not in extensionsUsed");
                    }
                    None => {}
                    Some((_, places)) if !places.contains(&at) => {
                        lint.at("UNEXPECTED_EXTENSION_OBJECT", &**name, "the extension has no place here");
                    }
                    Some((known, _)) => out.extend(value.map(|value| (*known, value))),
                }
            }
        });
        out
    }

    /// Looks into extensions, each with its own pointer.
    pub(super) fn each_extension(
        &mut self,
        found: Vec<(&'static str, &'a Json)>,
        mut look: impl FnMut(&mut Self, &'static str, &'a Json),
    ) {
        self.within("extensions", |lint| {
            for (name, value) in found {
                lint.within(name, |lint| {
                    lint.extensions(value, At::Other);
                    look(lint, name, value);
                });
            }
        });
    }

    /// Lights and variants, which stand at the root.
    pub(super) fn root_extensions(&mut self, root: &'a Json) {
        let found = self.extensions(root, At::Root);
        self.each_extension(found, |lint, name, value| match name {
            "KHR_lights_punctual" => lint.items_of(value, "lights", Self::light),
            _ => lint.items_of(value, "variants", |lint, variant| {
                lint.text(variant, "name", true);
                lint.extensions(variant, At::Other);
            }),
        });
    }

    pub(super) fn items_of(&mut self, map: &'a Json, key: &'a str, look: impl Fn(&mut Self, &'a Json)) {
        for (i, item) in self.objects(map, key).unwrap_or_default().iter().enumerate() {
            self.within(key, |lint| lint.within(i, |lint| look(lint, item)));
        }
    }

    fn light(&mut self, light: &'a Json) {
        self.reals(light, "color", 3, (0.0, 1.0));
        self.real(light, "intensity", Real::AT_LEAST_0);
        self.real(light, "range", Real::ABOVE_0);
        self.name(light);
        if self.text(light, "type", true) == Some("spot")
            && let Some(spot) = self.object(light, "spot", true)
        {
            self.within("spot", |lint| lint.spot(spot));
        }
        self.extensions(light, At::Other);
    }

    fn spot(&mut self, spot: &'a Json) {
        use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
        // The inner angle stays below the right angle by the step that separates two numbers there.
        let inner = Real { min: 0.0, max: FRAC_PI_2.next_down(), ..Real::ANY };
        let inner = self.real(spot, "innerConeAngle", inner).or(0.0);
        let outer = self.real(spot, "outerConeAngle", Real { above: 0.0, max: FRAC_PI_2, ..Real::ANY });
        if let (Some(inner), Some(outer)) = (inner, outer.or(FRAC_PI_4))
            && outer <= inner
        {
            let place = Some("outerConeAngle".into());
            self.issue("KHR_LIGHTS_PUNCTUAL_LIGHT_SPOT_ANGLES", place, || {
                format!("{outer} is not above {inner}")
            });
        }
        self.extensions(spot, At::Other);
    }

    /// An index into a list of a root extension.
    pub(super) fn extension_reference(&mut self, path: [&'a str; 2], index: Option<usize>, below: Step<'a>) {
        let [name, list] = path;
        let extension = self.root_extensions.and_then(|all| all.get(name)).filter(|_| self.declares(name));
        let Some(extension) = extension else {
            self.issue("UNSATISFIED_DEPENDENCY", None, || format!("/extensions/{name} is missing"));
            return;
        };
        let Some(index) = index else { return };
        let items = extension.get(list).and_then(Json::items);
        if !matches!(items.and_then(|items| items.get(index)), Some(Json::Object(_))) {
            self.issue("UNRESOLVED_REFERENCE", Some(below), || format!("{list} has no object {index}"));
        }
    }

    /// The numbers and colours of a material extension. Textures are looked at by the caller.
    pub(super) fn material_extension(&mut self, name: &str, map: &'a Json) {
        let above_1 = Real { min: 1.0, ..Real::ANY };
        let reals: &[(&str, Real)] = match name {
            "KHR_materials_anisotropy" => {
                &[("anisotropyStrength", Real::UNIT), ("anisotropyRotation", Real::ANY)]
            }
            "KHR_materials_clearcoat" => {
                &[("clearcoatFactor", Real::UNIT), ("clearcoatRoughnessFactor", Real::UNIT)]
            }
            "KHR_materials_dispersion" => &[("dispersion", Real::AT_LEAST_0)],
            "KHR_materials_emissive_strength" => &[("emissiveStrength", Real::AT_LEAST_0)],
            "KHR_materials_ior" => &[("ior", Real { except: Some(0.0), ..above_1 })],
            "KHR_materials_iridescence" => &[
                ("iridescenceFactor", Real::UNIT),
                ("iridescenceIor", above_1),
                ("iridescenceThicknessMinimum", Real::AT_LEAST_0),
                ("iridescenceThicknessMaximum", Real::AT_LEAST_0),
            ],
            "KHR_materials_pbrSpecularGlossiness" => &[("glossinessFactor", Real::UNIT)],
            "KHR_materials_sheen" => &[("sheenRoughnessFactor", Real::UNIT)],
            "KHR_materials_specular" => &[("specularFactor", Real::UNIT)],
            "KHR_materials_transmission" => &[("transmissionFactor", Real::UNIT)],
            "KHR_materials_volume" => {
                &[("attenuationDistance", Real::ABOVE_0), ("thicknessFactor", Real::AT_LEAST_0)]
            }
            _ => &[],
        };
        for (key, rule) in reals {
            self.real(map, key, *rule);
        }
        let colours: &[(&str, usize, f64)] = match name {
            "KHR_materials_pbrSpecularGlossiness" => &[("diffuseFactor", 4, 1.0), ("specularFactor", 3, 1.0)],
            "KHR_materials_sheen" => &[("sheenColorFactor", 3, 1.0)],
            "KHR_materials_specular" => &[("specularColorFactor", 3, f64::INFINITY)],
            "KHR_materials_volume" => &[("attenuationColor", 3, 1.0)],
            _ => &[],
        };
        for (key, length, max) in colours {
            self.reals(map, key, *length, (0.0, *max));
        }
    }

    /// Another coordinate set by `KHR_texture_transform`.
    pub(super) fn texture_transform(&mut self, map: &'a Json) -> Option<u64> {
        self.any_reals::<2>(map, "offset");
        self.real(map, "rotation", Real::ANY);
        self.any_reals::<2>(map, "scale");
        self.whole(map, "texCoord", Whole::default()).value()
    }
}

/// The textures of a material extension.
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
