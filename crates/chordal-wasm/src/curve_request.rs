//! Reads the JSON of a request about curves, one value at a time.
use chordal::Bezier;
use chordal::explicit::parametric::Continuity;
use serde_json::{Map, Value};

/// The most segments of one polyline. Chosen: a page draws a few hundred.
pub(crate) const MOST_SEGMENTS: u64 = 4096;
/// The most counts of one ladder. Chosen: a page asks for some dozens.
const MOST_COUNTS: usize = 256;
/// The largest coordinate. Chosen: those of the page are below 100.
const LARGEST: f64 = 1e6;

/// A JSON object with known keys.
pub(crate) struct CurveRequest(Map<String, Value>);

/// One sentence about an invalid value.
pub(crate) type CurveRequestError = String;

impl CurveRequest {
    /// An object with no other keys than these.
    pub fn parse(bytes: &[u8], keys: &[&str]) -> Result<Self, CurveRequestError> {
        let value = serde_json::from_slice(bytes).map_err(|error| format!("a question is JSON: {error}"))?;
        let Value::Object(object) = value else { return Err("a question is a JSON object".to_owned()) };
        match object.keys().find(|key| !keys.contains(&key.as_str())) {
            Some(key) => {
                Err(format!("unknown key '{key}' in this question; the keys are {}", keys.join(", ")))
            }
            None => Ok(Self(object)),
        }
    }

    fn get(&self, key: &str) -> &Value {
        self.0.get(key).unwrap_or(&Value::Null)
    }

    /// A number from `low` to `high`.
    pub fn number(&self, key: &str, [low, high]: [f64; 2]) -> Result<f64, CurveRequestError> {
        let value = self.get(key);
        let number = value.as_f64().filter(|number| *number >= low && *number <= high);
        number.ok_or_else(|| format!("{key} is a number from {low} to {high}, not {value}"))
    }

    /// A number of segments.
    pub fn segments(&self, key: &str) -> Result<u64, CurveRequestError> {
        segments(key, self.get(key))
    }

    /// Numbers of segments.
    pub fn counts(&self, key: &str) -> Result<Vec<u64>, CurveRequestError> {
        let values = self.get(key).as_array().filter(|values| values.len() <= MOST_COUNTS);
        let values =
            values.ok_or_else(|| format!("{key} is a list of at most {MOST_COUNTS} numbers of segments"))?;
        values.iter().map(|value| segments(key, value)).collect()
    }

    /// Four control points in the plane.
    pub fn cubic(&self, key: &str) -> Result<Bezier<2>, CurveRequestError> {
        let wrong =
            || format!("{key} is a list of four points [x, y] whose coordinates are at most {LARGEST}");
        let points = self.get(key).as_array().filter(|points| points.len() == 4).ok_or_else(wrong)?;
        let mut control = [[0.0; 2]; 4];
        for (point, value) in control.iter_mut().zip(points) {
            let pair = value.as_array().filter(|pair| pair.len() == 2).ok_or_else(wrong)?;
            for (x, value) in point.iter_mut().zip(pair) {
                *x = value.as_f64().filter(|x| x.abs() <= LARGEST).ok_or_else(wrong)?;
            }
        }
        Ok(Bezier { control })
    }

    /// C0, C1, C2, or none.
    pub fn smoothness(&self, key: &str) -> Result<Option<Continuity>, CurveRequestError> {
        match self.get(key).as_str() {
            Some("none") => Ok(None),
            Some("C0") => Ok(Some(Continuity::C0)),
            Some("C1") => Ok(Some(Continuity::C1)),
            Some("C2") => Ok(Some(Continuity::C2)),
            _ => Err(format!("{key} is none, C0, C1 or C2")),
        }
    }

    /// Which curve leads.
    pub fn leader(&self, key: &str) -> Result<Leader, CurveRequestError> {
        match self.get(key).as_str() {
            Some("first") => Ok(Leader::First),
            Some("second") => Ok(Leader::Second),
            _ => Err(format!("{key} is first or second")),
        }
    }
}

/// The curve that keeps its control points while the other follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Leader {
    First,
    Second,
}

fn segments(key: &str, value: &Value) -> Result<u64, CurveRequestError> {
    let n = value.as_u64().filter(|n| (1..=MOST_SEGMENTS).contains(n));
    n.ok_or_else(|| format!("{key}: a number of segments is from 1 to {MOST_SEGMENTS}, not {value}"))
}
