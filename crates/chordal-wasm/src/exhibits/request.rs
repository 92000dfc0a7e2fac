//! `ExhibitRequest`: the JSON of an exhibit's request, read one value at a time.
use serde_json::{Map, Value};

/// The largest coordinate. Chosen: those of the exhibits are below 100.
const LARGEST: f64 = 1e6;

/// A JSON object without its `exhibit`.
pub(super) struct ExhibitRequest(Map<String, Value>);

impl ExhibitRequest {
    /// The name of the exhibit, and the rest.
    pub fn parse(bytes: &[u8]) -> Result<(String, Self), String> {
        let value = serde_json::from_slice(bytes).map_err(|error| format!("a question is JSON: {error}"))?;
        let Value::Object(mut object) = value else { return Err("a question is a JSON object".to_owned()) };
        match object.shift_remove("exhibit") {
            Some(Value::String(name)) => Ok((name, Self(object))),
            _ => Err("a question names its exhibit".to_owned()),
        }
    }

    /// Refuses any other key.
    pub fn only(&self, keys: &[&str]) -> Result<(), String> {
        match self.0.keys().find(|key| !keys.contains(&key.as_str())) {
            Some(key) => {
                Err(format!("unknown key '{key}' in this question; the keys are {}", keys.join(", ")))
            }
            None => Ok(()),
        }
    }

    fn get(&self, key: &str) -> &Value {
        self.0.get(key).unwrap_or(&Value::Null)
    }

    /// A number from `low` to `high`.
    pub fn number(&self, key: &str, [low, high]: [f64; 2]) -> Result<f64, String> {
        let value = self.get(key);
        let number = value.as_f64().filter(|number| *number >= low && *number <= high);
        number.ok_or_else(|| format!("{key} is a number from {low} to {high}, not {value}"))
    }

    /// One of some words.
    pub fn word<'a>(&self, key: &str, words: &[&'a str]) -> Result<&'a str, String> {
        let word = self.get(key).as_str().and_then(|text| words.iter().find(|word| **word == text));
        word.copied().ok_or_else(|| format!("{key} is one of {}", words.join(", ")))
    }

    /// One of some words, or this one if none is given.
    pub fn word_or<'a>(&self, key: &str, words: &[&'a str], default: &'a str) -> Result<&'a str, String> {
        if self.0.contains_key(key) { self.word(key, words) } else { Ok(default) }
    }

    /// A point of D coordinates.
    pub fn point<const D: usize>(&self, key: &str) -> Result<[f64; D], String> {
        point(self.get(key)).ok_or_else(|| wrong_point::<D>(key))
    }

    /// From `low` to `high` points of D coordinates.
    pub fn points<const D: usize>(
        &self,
        key: &str,
        [low, high]: [usize; 2],
    ) -> Result<Vec<[f64; D]>, String> {
        let values = self.get(key).as_array().filter(|values| (low..=high).contains(&values.len()));
        let points = values.and_then(|values| values.iter().map(point).collect());
        points.ok_or_else(|| {
            format!("{key} is a list of {low} to {high} points of {D} coordinates of at most {LARGEST}")
        })
    }

    /// At most `below` indices below `below`.
    pub fn rows(&self, key: &str, below: usize) -> Result<Vec<u32>, String> {
        let values = self.get(key).as_array().filter(|values| values.len() <= below);
        let row = |value: &Value| value.as_u64().filter(|row| *row < below as u64).map(|row| row as u32);
        let rows = values.and_then(|values| values.iter().map(row).collect());
        rows.ok_or_else(|| format!("{key} is a list of whole numbers below {below}"))
    }

    /// At most `most` questions to exhibits.
    pub fn questions(&self, key: &str, most: usize) -> Result<&[Value], String> {
        let is_valid = |values: &&Vec<Value>| values.len() <= most && values.iter().all(Value::is_object);
        let values = self.get(key).as_array().filter(is_valid);
        values.map(Vec::as_slice).ok_or_else(|| format!("{key} is a list of at most {most} questions"))
    }

    /// At most `most` words.
    pub fn words(&self, key: &str, most: usize) -> Result<Vec<&str>, String> {
        let values = self.get(key).as_array().filter(|values| values.len() <= most);
        let words = values.and_then(|values| values.iter().map(Value::as_str).collect());
        words.ok_or_else(|| format!("{key} is a list of at most {most} words"))
    }
}

fn point<const D: usize>(value: &Value) -> Option<[f64; D]> {
    let values = value.as_array().filter(|values| values.len() == D)?;
    let mut coordinates = [0.0; D];
    for (x, value) in coordinates.iter_mut().zip(values) {
        *x = value.as_f64().filter(|x| x.abs() <= LARGEST)?;
    }
    Some(coordinates)
}

fn wrong_point<const D: usize>(key: &str) -> String {
    format!("{key} is a point of {D} coordinates of at most {LARGEST}")
}
