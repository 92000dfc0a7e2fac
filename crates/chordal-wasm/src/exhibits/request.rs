//! `ExhibitRequest`: what an exhibit is asked, one value at a time.
use serde_json::{Map, Value};

/// The largest coordinate: the exhibits' own are below 100.
const LARGEST: f64 = 1e6;

/// A JSON object without its `exhibit`.
pub(super) struct ExhibitRequest(Map<String, Value>);

impl ExhibitRequest {
    /// The name of the exhibit, and the rest.
    pub fn parse(bytes: &[u8]) -> Result<(String, Self), String> {
        let value = serde_json::from_slice(bytes).map_err(|error| format!("a question is JSON: {error}"))?;
        let Value::Object(mut all) = value else { return Err("a question is a JSON object".to_owned()) };
        match all.shift_remove("exhibit") {
            Some(Value::String(name)) => Ok((name, Self(all))),
            _ => Err("a question names its exhibit".to_owned()),
        }
    }

    /// Refuses any other key.
    pub fn only(&self, keys: &[&str]) -> Result<(), String> {
        match self.0.keys().find(|key| !keys.contains(&key.as_str())) {
            Some(key) => Err(format!("there is no '{key}' in this question; there are {}", keys.join(", "))),
            None => Ok(()),
        }
    }

    fn get(&self, key: &str) -> &Value {
        self.0.get(key).unwrap_or(&Value::Null)
    }

    /// A number from `low` to `high`.
    pub fn number(&self, key: &str, [low, high]: [f64; 2]) -> Result<f64, String> {
        let value = self.get(key);
        let found = value.as_f64().filter(|number| *number >= low && *number <= high);
        found.ok_or_else(|| format!("{key} is a number from {low} to {high}, not {value}"))
    }

    /// One of these words.
    pub fn word<'a>(&self, key: &str, words: &[&'a str]) -> Result<&'a str, String> {
        let found = self.get(key).as_str().and_then(|said| words.iter().find(|word| **word == said));
        found.copied().ok_or_else(|| format!("{key} is one of {}", words.join(", ")))
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
        let all = self.get(key).as_array().filter(|all| (low..=high).contains(&all.len()));
        let found = all.and_then(|all| all.iter().map(point).collect());
        found.ok_or_else(|| {
            format!("{key} is a list of {low} to {high} points of {D} coordinates of at most {LARGEST}")
        })
    }

    /// Row numbers below `below`, at most as many.
    pub fn rows(&self, key: &str, below: usize) -> Result<Vec<u32>, String> {
        let all = self.get(key).as_array().filter(|all| all.len() <= below);
        let row = |value: &Value| value.as_u64().filter(|row| *row < below as u64).map(|row| row as u32);
        let found = all.and_then(|all| all.iter().map(row).collect());
        found.ok_or_else(|| format!("{key} is a list of whole numbers below {below}"))
    }

    /// At most `most` questions to exhibits.
    pub fn questions(&self, key: &str, most: usize) -> Result<&[Value], String> {
        let all =
            self.get(key).as_array().filter(|all| all.len() <= most && all.iter().all(Value::is_object));
        all.map(Vec::as_slice).ok_or_else(|| format!("{key} is a list of at most {most} questions"))
    }

    /// Words of a list of at most `most`.
    pub fn words(&self, key: &str, most: usize) -> Result<Vec<&str>, String> {
        let all = self.get(key).as_array().filter(|all| all.len() <= most);
        let found = all.and_then(|all| all.iter().map(Value::as_str).collect());
        found.ok_or_else(|| format!("{key} is a list of at most {most} words"))
    }
}

fn point<const D: usize>(value: &Value) -> Option<[f64; D]> {
    let all = value.as_array().filter(|all| all.len() == D)?;
    let mut found = [0.0; D];
    for (x, value) in found.iter_mut().zip(all) {
        *x = value.as_f64().filter(|x| x.abs() <= LARGEST)?;
    }
    Some(found)
}

fn wrong_point<const D: usize>(key: &str) -> String {
    format!("{key} is a point of {D} coordinates of at most {LARGEST}")
}
