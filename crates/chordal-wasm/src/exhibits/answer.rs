//! `ExhibitAnswer`: facts as JSON, with large arrays as bytes.
use crate::outcome::Outcome;
use chordal::Mesh;
use serde_json::{Value, json};

/// The answer to an exhibit.
#[derive(Debug, Default)]
pub(super) struct ExhibitAnswer {
    /// The facts; arrays are references into `bytes`.
    pub facts: Value,
    bytes: Vec<u8>,
}

impl ExhibitAnswer {
    /// Facts without arrays.
    pub fn new(facts: Value) -> Self {
        Self { facts, bytes: Vec::new() }
    }

    /// Adds numbers in single precision, as they are drawn; returns the reference.
    pub fn floats<'a>(&mut self, numbers: impl IntoIterator<Item = &'a f64>) -> Value {
        let start = self.bytes.len();
        numbers.into_iter().for_each(|x| self.bytes.extend((*x as f32).to_le_bytes()));
        json!({ "f32": [start, (self.bytes.len() - start) / size_of::<f32>()] })
    }

    /// Adds indices; returns the reference.
    pub fn rows<'a>(&mut self, rows: impl IntoIterator<Item = &'a u32>) -> Value {
        let start = self.bytes.len();
        rows.into_iter().for_each(|row| self.bytes.extend(row.to_le_bytes()));
        json!({ "u32": [start, (self.bytes.len() - start) / size_of::<u32>()] })
    }

    /// Adds positions and faces.
    pub fn mesh(&mut self, mesh: &Mesh) -> Value {
        let positions = self.floats(mesh.positions().as_flattened());
        json!({ "positions": positions, "indices": self.rows(mesh.faces().as_flattened()) })
    }

    /// Adds the edges of faces, each once, as the positions of their two ends.
    pub fn edges(&mut self, positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Value {
        let sides = |face: &[u32; 3]| [[face[0], face[1]], [face[1], face[2]], [face[2], face[0]]];
        let mut edges: Vec<[u32; 2]> =
            faces.iter().flat_map(sides).map(|[a, b]| if a < b { [a, b] } else { [b, a] }).collect();
        edges.sort_unstable();
        edges.dedup();
        self.floats(edges.iter().flatten().flat_map(|row| &positions[*row as usize]))
    }

    /// As an outcome, with the facts as its report.
    pub fn into_outcome(self) -> Outcome {
        Outcome { report: self.facts.to_string().into_bytes(), bytes: self.bytes, ..Outcome::default() }
    }
}
