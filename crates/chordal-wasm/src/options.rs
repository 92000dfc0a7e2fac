//! `MeshCall`: a call of `mesh`, from its JSON. Its keys are the options of the tables that all front ends read,
//! with `_` for `-`.
use crate::spelling::JsonKeys;
use chordal::budget::advice::Spell;
use chordal_verbs::formats;
use chordal_verbs::options::{MeshOptions, OptionRow, OptionTable, OptionValues, OutputOptions, ReadOptions};
use chordal_verbs::{BudgetSpec, OutputForm, SurfaceSpec};
use serde_json::{Map, Value};

/// A call of `mesh`.
#[derive(Clone, Debug)]
pub(crate) struct MeshCall {
    pub name: Option<String>,
    pub read: ReadOptions,
    pub to: OutputForm,
    pub output: OutputOptions,
    pub spec: BudgetSpec,
    pub keep_best: bool,
    /// The options for the surface of a volume, if any is given.
    pub surface: Option<SurfaceSpec>,
    /// The first of their keys.
    pub surface_key: Option<String>,
}

/// The keys that are in no table.
const OWN_KEYS: [&str; 1] = ["name"];
/// Options that a module without a clock and with one file as its result cannot serve.
const NOT_HERE: [&str; 3] = ["within", "level", "separate"];

/// The names of all keys.
pub(crate) fn keys() -> impl Iterator<Item = String> {
    let output = OutputOptions::ROWS.iter().map(|row| row.name);
    let reading = ReadOptions::ROWS.iter().map(|row| row.name);
    let budget = MeshOptions::ROWS.iter().map(|row| row.name);
    let surface = SurfaceSpec::ROWS.iter().map(|row| row.name);
    let names = output.chain(reading).chain(budget).chain(surface).filter(|name| !NOT_HERE.contains(name));
    OWN_KEYS.into_iter().chain(names).map(|name| name.replace('-', "_"))
}

impl MeshCall {
    /// Reads the JSON object. The error is one sentence.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let value: Value =
            serde_json::from_slice(bytes).map_err(|error| format!("options are a JSON object: {error}"))?;
        let Value::Object(object) = value else { return Err("options are a JSON object".to_owned()) };
        if let Some(key) = object.keys().find(|key| !keys().any(|known| known == **key)) {
            let known: Vec<String> = keys().collect();
            return Err(format!("there is no option '{key}'; the options are {}", known.join(", ")));
        }
        let reader = OptionReader(&object);
        let options: MeshOptions = reader.request()?.unwrap_or_default();
        let spec = options.spec().map_err(|why| why.spelled(&JsonKeys).to_string())?;
        if !spec.has_limit() {
            return Err(MeshOptions::no_limit().spelled(&JsonKeys).to_string());
        }
        let to = options.to.ok_or("the option 'to' names the format to make, as in \"glb\"")?;
        if !to.holds_triangles() && !to.holds_polylines() {
            return Err(format!(
                "{to} can only be read; formats that can be written are {}",
                formats::output_names()
            ));
        }
        let output: OutputOptions = reader.request()?.unwrap_or_default();
        let to = output.form(to).map_err(|why| why.spelled(&JsonKeys).to_string())?;
        Ok(Self {
            name: reader.text("name")?,
            read: reader.request()?.unwrap_or_default(),
            to,
            output,
            spec,
            keep_best: options.keep_best,
            surface: reader.request()?,
            surface_key: reader.first_key::<SurfaceSpec>(),
        })
    }
}

/// Reads one value at a time; null counts as missing.
struct OptionReader<'a>(&'a Map<String, Value>);

impl OptionReader<'_> {
    /// The request from the options of a table, if any of them is given.
    fn request<S: OptionTable>(&self) -> Result<Option<S>, String> {
        let mut request = None;
        for row in S::ROWS {
            let key = row.name.replace('-', "_");
            let texts = match self.get(&key) {
                // As in `"set": ["r=1", "h=2"]`.
                Some(Value::Array(values)) if row.is_repeatable => {
                    let text = |value: &Value| value.as_str().map(str::to_owned);
                    let texts: Option<Vec<String>> = values.iter().map(text).collect();
                    texts.ok_or_else(|| format!("{key} is a list of texts"))?
                }
                _ => self.text_for(row, &key)?.into_iter().collect(),
            };
            for text in texts {
                let request = request.get_or_insert_with(S::default);
                (row.set)(request, &text).map_err(|why| format!("{key}: {why}"))?;
            }
        }
        Ok(request)
    }

    /// The first key of a table that is given.
    fn first_key<S: OptionTable>(&self) -> Option<String> {
        let mut keys = S::ROWS.iter().map(|row| row.name.replace('-', "_"));
        // A flag that is false is as good as missing.
        keys.find(|key| self.get(key).is_some_and(|value| *value != Value::Bool(false)))
    }

    /// The text of an option's value, empty for a flag that is set.
    fn text_for<S>(&self, row: &OptionRow<S>, key: &str) -> Result<Option<String>, String> {
        if row.values == OptionValues::Flag {
            return Ok(self.flag(key)?.then(String::new));
        }
        match self.get(key) {
            // As in `"labels": [1, 2]`.
            Some(Value::Array(values)) => {
                let texts: Vec<String> = values.iter().map(Value::to_string).collect();
                Ok(Some(texts.join(",")))
            }
            _ => self.text(key),
        }
    }

    fn get(&self, key: &str) -> Option<&Value> {
        self.0.get(key).filter(|value| !value.is_null())
    }

    /// A text; a number is converted to text.
    fn text(&self, key: &str) -> Result<Option<String>, String> {
        match self.get(key) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text.clone())),
            Some(Value::Number(number)) => Ok(Some(number.to_string())),
            Some(other) => Err(format!("{key} is a text, not {other}")),
        }
    }

    fn flag(&self, key: &str) -> Result<bool, String> {
        self.get(key)
            .map_or(Ok(false), |value| value.as_bool().ok_or_else(|| format!("{key} is true or false")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_option_of_the_tables_is_a_key() {
        let call = MeshCall::parse(
            br#"{"to": "glb", "tol": "0.1%", "px": 1, "view": "100x100 fov=45 dist=4", "angle": "5deg", "uv_error": "1%",
                "normal_error": 10, "triangles": 500, "require": "measured", "effort": "fast", "spacing": "even",
                "normals": "flat", "extrude": "2mm", "bevel": 0.1, "keep_best": true, "labels": [1, 2], "open": true, "unit": "mm",
                "set": ["r=1", "h=2"], "compress": "meshopt", "quantize": true}"#,
        )
        .expect("all are keys");
        assert!(call.keep_best && call.spec.bevel.is_some() && call.spec.attributes.is_set());
        assert!(call.to.packing.is_compressed && call.to.packing.is_quantized);
        assert_eq!(call.read.set.len(), 2);
        assert_eq!(call.surface_key.as_deref(), Some("labels"));
        let surface = call.surface.expect("labels are given");
        assert_eq!(surface.labels.map(|labels| format!("{labels:?}")), Some("Listed([1, 2])".to_owned()));
    }

    #[test]
    fn tells_the_key_that_is_wrong() {
        let error = |json: &str| MeshCall::parse(json.as_bytes()).expect_err("it is wrong");
        assert!(error(r#"{"to": "glb", "tol": -1}"#).starts_with("tol: "));
        assert!(
            error(r#"{"to": "glb", "tol": 1, "within": "5s"}"#).starts_with("there is no option 'within'")
        );
        let packed = error(r#"{"to": "stl", "tol": 1, "quantize": true}"#);
        assert_eq!(packed, "\"quantize\" is for .glb and .gltf; stl holds plain numbers");
        assert!(error(r#"{"to": "glb", "tol": 1, "compress": "draco"}"#).starts_with("compress: 'meshopt'"));
        assert!(error(r#"{"to": "glb", "px": 1}"#).contains("\"view\": \"1920x1080"));
        assert!(error(r#"{"to": "glb", "normals": "flat"}"#).starts_with("a budget is needed"));
    }
}
