//! `Composed`: the inputs that triangles were put together from, so that results know their distance from the first shapes.
use crate::report::{ComposedFacts, HistoryFacts, HistoryStart, PlaceFacts, StepInput};
use crate::scene::placements::{
    IDENTITY, Matrix4, as_one_map, largest_reach, largest_stretch, map_rounding, nodes_rounding, scaled_up,
};
use chordal::math::{add_up, greater};
use chordal_io::{Scene, WriteError};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The largest depth of nested histories; beyond it a history starts anew. Chosen: readers of JSON give up at a depth of
/// about
/// 25.
const DEEPEST: usize = 12;

/// The inputs that triangles in memory were put together from, each with its place (a map) and its history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Composed {
    inputs: Vec<StepInput>,
    facts: ComposedFacts,
    /// The largest distance of the triangles from their exact places.
    off: f64,
    /// The sizes of the inputs, in the same order.
    sizes: Vec<InputSize>,
}

/// The properties of an input that determine the rounding of a map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct InputSize {
    /// The largest coordinates along each axis, without their signs.
    reach: [f64; 3],
    /// The largest distance by which the input's own nodes may round it.
    off: f64,
}

impl Composed {
    /// An input as it is, with its history.
    ///
    /// # Errors
    /// If its nodes are not a tree, or take coordinates out of range.
    pub(crate) fn of_one(input: StepInput, origin: HistoryFacts, scene: &Scene) -> Result<Self, WriteError> {
        let mut reach = [0.0; 3];
        for (_, mesh) in scene.world_meshes()? {
            let mesh_reach = largest_reach(&mesh.bounds());
            reach = std::array::from_fn(|k| greater(mesh_reach[k], reach[k]));
        }
        let size = InputSize { reach, off: nodes_rounding(scene) };
        let origin = if origin.depth() < DEEPEST { origin } else { begun_anew() };
        let places = vec![PlaceFacts { input: 0, map: None }];
        let facts = ComposedFacts { origins: vec![origin], places, rounding: 0.0 };
        Ok(Self { inputs: vec![input], facts, off: 0.0, sizes: vec![size] })
    }

    /// Several compositions next to each other, each below maps, of which the last is applied first; `off` is the largest
    /// distance of the triangles from their exact places. The maps are multiplied, and the rounding of that is counted, so
    /// that a long chain of maps stays one map. `None` if they lead out of range.
    pub(crate) fn placed(parts: &[(Vec<Matrix4>, &Self)], off: f64) -> Option<Self> {
        let mut composed =
            Self { inputs: Vec::new(), facts: ComposedFacts::default(), off, sizes: Vec::new() };
        let mut numbers: BTreeMap<Option<&str>, Vec<usize>> = BTreeMap::new();
        let (mut replay_error, mut product_error) = (0.0, 0.0);
        for (above, part) in parts {
            let mut indices = Vec::with_capacity(part.inputs.len());
            for (k, input) in part.inputs.iter().enumerate() {
                let (origin, size) = (&part.facts.origins[k], &part.sizes[k]);
                // The digest only finds candidates: the same bytes may have been read as another kind, or with
                // another history.
                let same = numbers.entry(input.sha256.as_deref()).or_default();
                let is_known = |at: &&usize| {
                    (&composed.inputs[**at], &composed.facts.origins[**at], &composed.sizes[**at])
                        == (input, origin, size)
                };
                let known = same.iter().find(is_known).copied();
                indices.push(known.unwrap_or_else(|| {
                    same.push(composed.inputs.len());
                    composed.inputs.push(input.clone());
                    composed.facts.origins.push(origin.clone());
                    composed.sizes.push(size.clone());
                    composed.inputs.len() - 1
                }));
            }
            for place in &part.facts.places {
                let InputSize { reach, off } = &composed.sizes[indices[place.input]];
                let (mut map, mut rounded) = (place.matrix(), 0.0);
                // From the innermost map outwards: each one stretches the rounding of those before it.
                for after in above.iter().rev() {
                    let (product, lost) = as_one_map(after, &map, *reach);
                    rounded = add(scaled_up(rounded, largest_stretch(after)), lost);
                    map = product;
                }
                if !map.iter().all(|entry| entry.is_finite()) {
                    return None;
                }
                product_error = greater(rounded, product_error);
                replay_error = greater(
                    add(scaled_up(*off, largest_stretch(&map)), map_rounding(&map, *reach)),
                    replay_error,
                );
                let map = (map != IDENTITY).then(|| rows_of(&map));
                composed.facts.places.push(PlaceFacts { input: indices[place.input], map });
            }
        }
        composed.off = add(off, product_error);
        // A verifier applies the maps again, with a rounding of its own, and compares that with these rounded triangles.
        composed.facts.rounding = add(composed.off, 2.0 * replay_error);
        composed.facts.rounding.is_finite().then_some(composed)
    }

    /// The files, or the facts that stand for them.
    pub(crate) fn inputs(&self) -> &[StepInput] {
        &self.inputs
    }

    /// The places and the histories of the inputs.
    #[must_use]
    pub fn facts(&self) -> &ComposedFacts {
        &self.facts
    }

    /// The largest distance of the triangles from their exact places.
    pub(crate) fn off(&self) -> f64 {
        self.off
    }
}

/// A sum, rounded up; adding nothing is exact.
fn add(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { a + b } else { add_up(a, b) }
}

/// The first three rows of a matrix, row by row.
fn rows_of(matrix: &Matrix4) -> [f64; 12] {
    std::array::from_fn(|k| matrix[k % 4 * 4 + k / 4])
}

fn begun_anew() -> HistoryFacts {
    let reason = "the history of the input goes back through too many files that were put together";
    HistoryFacts::new(HistoryStart::new("long", reason), Vec::new())
}
