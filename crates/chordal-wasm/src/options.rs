//! What a caller asks for, from its JSON.
use chordal::budget::{Length, PixelBudget, Pixels, RequiredEvidence, Unit, View};
use chordal_io::glb::GltfPacking;
use chordal_io::{Axis, Format};
use chordal_verbs::formats::{self, in_words, names_where};
use chordal_verbs::{BudgetSpec, Normals, OutputForm};
use serde_json::{Map, Value};
use std::str::FromStr;

/// What a caller asks for.
#[derive(Clone, Debug)]
pub(crate) struct MeshOptions {
    pub name: Option<String>,
    pub from: Option<Format>,
    pub to: OutputForm,
    pub unit: Option<Unit>,
    pub up: Option<Axis>,
    pub spec: BudgetSpec,
    pub keep_best: bool,
}

/// The names of all options.
pub(crate) const KEYS: [&str; 15] = [
    "name",
    "from",
    "to",
    "unit",
    "up",
    "tol",
    "px",
    "view",
    "triangles",
    "segments",
    "normals",
    "require",
    "keep_best",
    "compress",
    "quantize",
];

impl MeshOptions {
    /// Reads the JSON object; what is wrong with it comes back in one sentence.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let value: Value =
            serde_json::from_slice(bytes).map_err(|error| format!("options are a JSON object: {error}"))?;
        let Value::Object(all) = value else { return Err("options are a JSON object".to_owned()) };
        if let Some(key) = all.keys().find(|key| !KEYS.contains(&key.as_str())) {
            return Err(format!("there is no option '{key}'; there are {}", KEYS.join(", ")));
        }
        let all = OptionReader(&all);
        let pixels = match (all.parsed::<Pixels>("px")?, all.parsed::<View>("view")?) {
            (Some(pixels), Some(view)) => Some(PixelBudget { pixels, view }),
            (None, None) => None,
            _ => return Err("px and view belong together".to_owned()),
        };
        let spec = BudgetSpec {
            length: all.parsed::<Length>("tol")?,
            pixels,
            triangles: all.count("triangles")?,
            segments: all.count("segments")?,
            normals: all.parsed::<Normals>("normals")?.unwrap_or_default(),
            require: all.parsed::<RequiredEvidence>("require")?,
            ..BudgetSpec::default()
        };
        if !spec.has_limit() {
            return Err("a budget is needed: tol, px with view, triangles or segments".to_owned());
        }
        let to: Format =
            all.parsed("to")?.ok_or("the option 'to' names the format to make, as in \"glb\"")?;
        if !to.holds_triangles() && !to.holds_polylines() {
            return Err(format!("{to} is only read; what can be written is {}", formats::output_names()));
        }
        let compress = all.text("compress")?;
        if let Some(codec) = compress.as_deref().filter(|codec| *codec != "meshopt") {
            return Err(format!("compress is \"meshopt\", not {codec}"));
        }
        let packing = GltfPacking { is_compressed: compress.is_some(), is_quantized: all.flag("quantize")? };
        if packing != GltfPacking::default() && !to.is_gltf() {
            let names = in_words(&names_where(Format::is_gltf), "and");
            return Err(format!("compress and quantize are for {names}; {to} holds plain numbers"));
        }
        Ok(Self {
            name: all.text("name")?,
            from: all.parsed("from")?,
            to: OutputForm { format: to, packing },
            unit: all.parsed::<Unit>("unit")?,
            up: all.axis("up")?,
            spec,
            keep_best: all.flag("keep_best")?,
        })
    }
}

/// Reads one value at a time; null is as good as nothing.
struct OptionReader<'a>(&'a Map<String, Value>);

impl OptionReader<'_> {
    fn get(&self, key: &str) -> Option<&Value> {
        self.0.get(key).filter(|value| !value.is_null())
    }

    /// A text; a number will do as well.
    fn text(&self, key: &str) -> Result<Option<String>, String> {
        match self.get(key) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text.clone())),
            Some(Value::Number(number)) => Ok(Some(number.to_string())),
            Some(other) => Err(format!("{key} is a text, not {other}")),
        }
    }

    fn parsed<T: FromStr<Err: ToString>>(&self, key: &str) -> Result<Option<T>, String> {
        let text = self.text(key)?;
        text.map(|text| text.parse().map_err(|error: T::Err| format!("{key}: {}", error.to_string())))
            .transpose()
    }

    fn axis(&self, key: &str) -> Result<Option<Axis>, String> {
        match self.text(key)?.as_deref() {
            None => Ok(None),
            Some("y") => Ok(Some(Axis::Y)),
            Some("z") => Ok(Some(Axis::Z)),
            Some(_) => Err(format!("{key} is y or z")),
        }
    }

    fn count(&self, key: &str) -> Result<Option<u64>, String> {
        let wrong = || format!("{key} is a whole number greater than 0");
        self.get(key).map(|value| value.as_u64().filter(|n| *n > 0).ok_or_else(wrong)).transpose()
    }

    fn flag(&self, key: &str) -> Result<bool, String> {
        self.get(key)
            .map_or(Ok(false), |value| value.as_bool().ok_or_else(|| format!("{key} is true or false")))
    }
}
