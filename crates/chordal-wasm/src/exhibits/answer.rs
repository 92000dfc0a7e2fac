//! `ExhibitAnswer`: facts as JSON, and large arrays as bytes beside them.
use crate::outcome::Outcome;
use chordal::Mesh;
use serde_json::{Value, json};

/// What an exhibit is told.
#[derive(Debug, Default)]
pub(super) struct ExhibitAnswer {
    /// The facts; arrays stand there by their place in `bytes`.
    pub facts: Value,
    bytes: Vec<u8>,
}

impl ExhibitAnswer {
    /// Facts alone.
    pub fn new(facts: Value) -> Self {
        Self { facts, bytes: Vec::new() }
    }

    /// Keeps single-precision numbers, as they are drawn; returns where.
    pub fn floats<'a>(&mut self, numbers: impl IntoIterator<Item = &'a f64>) -> Value {
        let start = self.bytes.len();
        numbers.into_iter().for_each(|x| self.bytes.extend((*x as f32).to_le_bytes()));
        json!({ "f32": [start, (self.bytes.len() - start) / size_of::<f32>()] })
    }

    /// Keeps row numbers; returns where.
    pub fn rows<'a>(&mut self, rows: impl IntoIterator<Item = &'a u32>) -> Value {
        let start = self.bytes.len();
        rows.into_iter().for_each(|row| self.bytes.extend(row.to_le_bytes()));
        json!({ "u32": [start, (self.bytes.len() - start) / size_of::<u32>()] })
    }

    /// Keeps positions and faces.
    pub fn mesh(&mut self, mesh: &Mesh) -> Value {
        let positions = self.floats(mesh.positions().as_flattened());
        json!({ "positions": positions, "indices": self.rows(mesh.faces().as_flattened()) })
    }

    /// As an outcome: the facts stand where a report stands.
    pub fn into_outcome(self) -> Outcome {
        Outcome { report: self.facts.to_string().into_bytes(), bytes: self.bytes, ..Outcome::default() }
    }
}
