//! `MtlMaterial`: the materials of a library (`.mtl`), as a list of its statements.
use super::statements::ObjStatements;
use crate::notes::NamedNotes;
use crate::text::{LineTokens, number};
use serde_json::{Map, Value};

/// The value after a keyword.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum MtlValue {
    /// One to three finite numbers.
    Numbers(Vec<f64>),
    /// Any other text, trimmed: the picture of a map with its options, a colour in another form.
    Text(String),
}

/// The syntax of a keyword's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MtlKind {
    /// Three numbers, or one that applies to all channels.
    Color,
    /// One number.
    Number,
    /// Options and the name of a picture.
    Map,
}

use MtlKind::{Color, Map as Picture, Number};

/// The supported statements: those of Wavefront and of the extension for physically based rendering.
pub(super) const KEYWORDS: [(&str, MtlKind); 37] = [
    ("Kd", Color),
    ("Ka", Color),
    ("Ks", Color),
    ("Ke", Color),
    ("Tf", Color),
    ("Km", Color),
    ("Ns", Number),
    ("d", Number),
    ("Tr", Number),
    ("Ni", Number),
    ("illum", Number),
    ("sharpness", Number),
    ("Pr", Number),
    ("Pm", Number),
    ("Ps", Number),
    ("Pc", Number),
    ("Pcr", Number),
    ("aniso", Number),
    ("anisor", Number),
    ("map_Kd", Picture),
    ("map_Ka", Picture),
    ("map_Ks", Picture),
    ("map_Ke", Picture),
    ("map_Ns", Picture),
    ("map_d", Picture),
    ("map_Tr", Picture),
    ("map_Bump", Picture),
    ("bump", Picture),
    ("norm", Picture),
    ("disp", Picture),
    ("decal", Picture),
    ("refl", Picture),
    ("map_refl", Picture),
    ("map_Pr", Picture),
    ("map_Pm", Picture),
    ("map_Ps", Picture),
    ("map_aat", Picture),
];

/// Whether a keyword introduces a map.
pub(super) fn is_map(keyword: &str) -> bool {
    KEYWORDS.iter().any(|(known, kind)| *known == keyword && *kind == Picture)
}

/// The member of a material's extras that holds statements without a counterpart in glTF.
pub(super) const EXTRAS: &str = "mtl";

/// One material.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MtlMaterial {
    pub name: String,
    /// Keywords in the spelling of [`KEYWORDS`], in the order of first occurrence, each with its last value.
    pub values: Vec<(&'static str, MtlValue)>,
}

impl MtlMaterial {
    pub fn get(&self, keyword: &str) -> Option<&MtlValue> {
        self.values.iter().find(|(known, _)| *known == keyword).map(|(_, value)| value)
    }

    /// The numbers after a keyword.
    pub fn numbers(&self, keyword: &str) -> Option<&[f64]> {
        match self.get(keyword)? {
            MtlValue::Numbers(numbers) => Some(numbers),
            MtlValue::Text(_) => None,
        }
    }

    pub fn number(&self, keyword: &str) -> Option<f64> {
        self.numbers(keyword)?.first().copied()
    }

    /// A colour; a single number applies to all three channels.
    pub fn color(&self, keyword: &str) -> Option<[f64; 3]> {
        match *self.numbers(keyword)? {
            [gray] => Some([gray; 3]),
            [r, g, b] => Some([r, g, b]),
            _ => None,
        }
    }

    /// The options and the picture of a map.
    pub fn text(&self, keyword: &str) -> Option<&str> {
        match self.get(keyword)? {
            MtlValue::Text(text) => Some(text),
            MtlValue::Numbers(_) => None,
        }
    }

    pub fn set(&mut self, keyword: &'static str, value: MtlValue) {
        match self.values.iter_mut().find(|(known, _)| *known == keyword) {
            Some(known) => known.1 = value,
            None => self.values.push((keyword, value)),
        }
    }

    /// The statements kept in the extras of a glTF material.
    ///
    /// Only known statements are taken, since the file may be from another program.
    pub fn from_extras(extras: &Map<String, Value>) -> Self {
        let mut material = Self::default();
        for (key, value) in extras {
            let Some((keyword, kind)) = KEYWORDS.into_iter().find(|(known, _)| known == key) else {
                continue;
            };
            let value = match value {
                Value::String(text) => MtlValue::Text(text.clone()),
                Value::Number(number) => MtlValue::Numbers(number.as_f64().into_iter().collect()),
                Value::Array(items) => MtlValue::Numbers(items.iter().filter_map(Value::as_f64).collect()),
                _ => continue,
            };
            let is_sound = match &value {
                MtlValue::Numbers(numbers) => match kind {
                    Color => matches!(numbers.len(), 1 | 3),
                    Number => numbers.len() == 1,
                    Picture => false,
                },
                MtlValue::Text(text) => !text.is_empty(),
            };
            if is_sound {
                material.set(keyword, value);
            }
        }
        material
    }
}

impl MtlValue {
    /// The JSON form that is kept in extras.
    pub fn to_json(&self) -> Value {
        // Whole numbers are written without a point. Defined: up to 2⁵³, f64 holds all of them.
        const WHOLE: f64 = 9_007_199_254_740_992.0;
        let number = |x: &f64| match *x {
            x if x.abs() < WHOLE && x == x.trunc() => Value::from(x as i64),
            x => Value::from(x),
        };
        match self {
            Self::Numbers(numbers) => match &numbers[..] {
                [one] => number(one),
                all => all.iter().map(number).collect(),
            },
            Self::Text(text) => Value::from(text.as_str()),
        }
    }
}

/// Reads the materials of a library, one at a time.
pub(super) struct MtlReader<'a> {
    statements: ObjStatements<'a>,
    /// The path of the library, for notes.
    library: &'a str,
    /// The name of the next material, if it was already read.
    next: Option<String>,
    is_started: bool,
}

impl<'a> MtlReader<'a> {
    pub fn new(text: &'a [u8], library: &'a str) -> Self {
        Self { statements: ObjStatements::new(text), library, next: None, is_started: false }
    }

    /// The next material; if `is_wanted` is false, only its name is read.
    pub fn next(&mut self, is_wanted: impl Fn(&str) -> bool, notes: &mut NamedNotes) -> Option<MtlMaterial> {
        if !self.is_started {
            self.is_started = true;
            // Statements before the first name.
            self.rest_of(MtlMaterial::default(), |_| true, notes);
        }
        let name = self.next.take()?;
        Some(self.rest_of(MtlMaterial { name, ..MtlMaterial::default() }, is_wanted, notes))
    }

    /// Reads up to the next name.
    fn rest_of(
        &mut self,
        mut material: MtlMaterial,
        is_wanted: impl Fn(&str) -> bool,
        notes: &mut NamedNotes,
    ) -> MtlMaterial {
        let is_wanted = is_wanted(&material.name);
        while let Some((line, statement)) = self.statements.next() {
            let mut words = LineTokens::new(statement);
            let Some(word) = words.next().filter(|word| !word.starts_with(b"#")) else { continue };
            if word.eq_ignore_ascii_case(b"newmtl") {
                self.next = Some(String::from_utf8_lossy(words.rest()).into_owned());
                break;
            }
            if !is_wanted {
                continue;
            }
            let place = || format!("{} in line {line} of {}", word.escape_ascii(), self.library);
            let entry = KEYWORDS.into_iter().find(|(entry, _)| word.eq_ignore_ascii_case(entry.as_bytes()));
            match entry {
                None => notes.add("mtl-unknown", "statements that are not known were skipped", &place()),
                Some((keyword, kind)) => match value(kind, words) {
                    Some(value) => material.set(keyword, value),
                    None => {
                        let what = "statements whose values are none of theirs were skipped";
                        notes.add("mtl-value", what, &place());
                    }
                },
            }
        }
        material
    }
}

/// The value of a statement; `None` if it is invalid.
fn value(kind: MtlKind, words: LineTokens) -> Option<MtlValue> {
    let text = || {
        let text = String::from_utf8_lossy(words.rest()).into_owned();
        (!text.is_empty()).then_some(MtlValue::Text(text))
    };
    let most = match kind {
        Color => 3,
        Number => 1,
        Picture => return text(),
    };
    let first = words.clone().next()?;
    // Colours as a spectrum or in CIE's space; `d -halo 0.5`.
    if matches!(first, b"spectral" | b"xyz" | b"-halo") {
        return text();
    }
    // Some programs write the opacity as a fourth number of a colour.
    let numbers: Vec<f64> = words.clone().take(most).map_while(number).filter(|x| x.is_finite()).collect();
    let n_words = words.take(most).count();
    (numbers.len() == n_words && matches!(n_words, 1 | 3)).then_some(MtlValue::Numbers(numbers))
}

/// The appearance of a material, as far as glTF can express it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MtlLook {
    pub base: [f64; 3],
    pub opacity: f64,
    pub emission: [f64; 3],
    pub roughness: f64,
}

impl MtlLook {
    /// `has_picture`: a picture is multiplied with the colour. Programs that write black beside a picture
    /// mean the picture, not black.
    pub fn new(material: &MtlMaterial, has_picture: bool) -> Self {
        let unit = |x: f64| x.clamp(0.0, 1.0);
        let base = material.color("Kd").unwrap_or([1.0; 3]).map(unit);
        let opacity = match (material.get("d"), material.number("Tr")) {
            (Some(MtlValue::Numbers(numbers)), _) => numbers.first().copied(),
            (Some(MtlValue::Text(halo)), _) => halo.split_whitespace().nth(1).and_then(|x| x.parse().ok()),
            (None, through) => through.map(|through| 1.0 - through),
        };
        let opacity = opacity.filter(|x| x.is_finite()).map_or(1.0, unit);
        let emission = material.color("Ke").unwrap_or_default().map(|x| if x > 0.0 { x } else { 0.0 });
        Self {
            base: if has_picture && base == [0.0; 3] { [1.0; 3] } else { base },
            opacity,
            emission,
            roughness: roughness(material),
        }
    }
}

/// The roughness of glTF: `Pr`, or that of a highlight with the exponent `Ns`.
///
/// A highlight with exponent n is about as wide as Beckmann's distribution with α² = 2 / (n + 2) (B. Walter,
/// S. Marschner, H. Li, K. Torrance, *Microfacet Models for Refraction through Rough Surfaces*, 2007, section
/// 5.2), and glTF's α is the square of its roughness (specification, appendix B). Without a highlight (a
/// black `Ks`, or an illumination model that has none) a surface is rough.
fn roughness(material: &MtlMaterial) -> f64 {
    if let Some(roughness) = material.number("Pr") {
        return roughness.clamp(0.0, 1.0);
    }
    let is_dull = material.color("Ks") == Some([0.0; 3])
        || material.number("illum").is_some_and(|model| model == 0.0 || model == 1.0);
    match material.number("Ns") {
        Some(exponent) if !is_dull && exponent > 0.0 => (2.0 / (exponent + 2.0)).sqrt().sqrt(),
        _ => 1.0,
    }
}

/// The exponent of a highlight that is as wide as that of a roughness: the inverse of the above, up to 1,000,
/// where Wavefront's scale ends.
pub(super) fn exponent(roughness: f64) -> f64 {
    const MOST: f64 = 1000.0;
    let alpha_sq = roughness * roughness * roughness * roughness;
    let exponent = 2.0 / alpha_sq - 2.0;
    if exponent < MOST { if exponent > 0.0 { exponent } else { 0.0 } } else { MOST }
}
