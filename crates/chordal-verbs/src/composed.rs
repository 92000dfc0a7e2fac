//! `Composed`: what triangles were put together of, so that what is made of them knows how far it is from the truth.
use crate::placements::{
    IDENTITY, Matrix4, as_one_map, largest_reach, largest_stretch, map_rounding, nodes_rounding, scaled_up,
};
use crate::report::{ComposedFacts, HistoryFacts, HistoryStart, PlaceFacts, StepInput};
use chordal::math::{add_up, greater};
use chordal_io::{Scene, WriteError};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How many histories may be within each other before one begins anew. Chosen: readers of JSON give up at some 25.
const DEEPEST: usize = 12;

/// What triangles that never were a file were put together of: inputs where maps take them, with their histories.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Composed {
    inputs: Vec<StepInput>,
    facts: ComposedFacts,
    /// The triangles are no farther than this from where exact numbers would take them.
    off: f64,
    /// Of each input.
    sizes: Vec<InputSize>,
}

/// What the rounding of a map depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct InputSize {
    /// The largest coordinates along each axis, without their signs.
    reach: [f64; 3],
    /// How far its own nodes may round it.
    off: f64,
}

impl Composed {
    /// An input as it is, with its history.
    ///
    /// # Errors
    /// When its nodes are no tree, or take coordinates out of range.
    pub(crate) fn of_one(input: StepInput, origin: HistoryFacts, scene: &Scene) -> Result<Self, WriteError> {
        let mut reach = [0.0; 3];
        for (_, mesh) in scene.world_meshes()? {
            let own = largest_reach(&mesh.bounds());
            reach = std::array::from_fn(|k| greater(own[k], reach[k]));
        }
        let size = InputSize { reach, off: nodes_rounding(scene) };
        let origin = if origin.depth() < DEEPEST { origin } else { begun_anew() };
        let places = vec![PlaceFacts { input: 0, map: None }];
        let facts = ComposedFacts { origins: vec![origin], places, rounding: 0.0 };
        Ok(Self { inputs: vec![input], facts, off: 0.0, sizes: vec![size] })
    }

    /// Several of these next to each other, each below maps, the last of them first: triangles that are off by no more than a
    /// length. The maps become one, and what that rounds is counted: no chain of them makes it large. `None` where they lead
    /// out of range.
    pub(crate) fn placed(parts: &[(Vec<Matrix4>, &Self)], off: f64) -> Option<Self> {
        let mut all = Self { inputs: Vec::new(), facts: ComposedFacts::default(), off, sizes: Vec::new() };
        let mut numbers: BTreeMap<Option<&str>, Vec<usize>> = BTreeMap::new();
        let (mut judged, mut merged) = (0.0, 0.0);
        for (above, part) in parts {
            let mut own = Vec::with_capacity(part.inputs.len());
            for (k, input) in part.inputs.iter().enumerate() {
                let (origin, size) = (&part.facts.origins[k], &part.sizes[k]);
                let same = numbers.entry(input.sha256.as_deref()).or_default();
                let is_known = |at: &&usize| {
                    (&all.inputs[**at], &all.facts.origins[**at], &all.sizes[**at]) == (input, origin, size)
                };
                let known = same.iter().find(is_known).copied();
                own.push(known.unwrap_or_else(|| {
                    same.push(all.inputs.len());
                    all.inputs.push(input.clone());
                    all.facts.origins.push(origin.clone());
                    all.sizes.push(size.clone());
                    all.inputs.len() - 1
                }));
            }
            for place in &part.facts.places {
                let InputSize { reach, off } = &all.sizes[own[place.input]];
                let (mut map, mut rounded) = (place.matrix(), 0.0);
                for after in above.iter().rev() {
                    let (one, lost) = as_one_map(after, &map, *reach);
                    rounded = add(scaled_up(rounded, largest_stretch(after)), lost);
                    map = one;
                }
                if !map.iter().all(|entry| entry.is_finite()) {
                    return None;
                }
                merged = greater(rounded, merged);
                judged =
                    greater(add(scaled_up(*off, largest_stretch(&map)), map_rounding(&map, *reach)), judged);
                let map = (map != IDENTITY).then(|| rows_of(&map));
                all.facts.places.push(PlaceFacts { input: own[place.input], map });
            }
        }
        all.off = add(off, merged);
        // Who puts them together again rounds, too, and compares what is rounded: on the way there and back.
        all.facts.rounding = add(all.off, 2.0 * judged);
        all.facts.rounding.is_finite().then_some(all)
    }

    /// The files, or what stands for them.
    pub(crate) fn inputs(&self) -> &[StepInput] {
        &self.inputs
    }

    /// Where they stand, and how they came about.
    #[must_use]
    pub fn facts(&self) -> &ComposedFacts {
        &self.facts
    }

    /// How far the triangles may be from where exact numbers would take them.
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
