//! `Marks`: points and lines beside the triangles of a part.
use crate::PackedAccessor;
use crate::rare_value::UsualValue;
use serde_json::{Map, Value};

/// Points or lines of a glTF mesh: a primitive without triangles. Like [`SceneAssets`](crate::SceneAssets)
/// they are passed from a reader to a writer, and nothing in between interprets them: they are not measured,
/// bounded, repaired or simplified.
#[derive(Clone, Debug, PartialEq)]
pub struct Marks {
    /// The properties of the glTF primitive other than its material: mode, attributes, indices, morph
    /// targets, extras. Accessor indices refer to `accessors`.
    pub primitive: Map<String, Value>,
    /// The index of their material.
    pub material: Option<usize>,
    /// Their numeric data, in the coordinates of the part.
    pub accessors: Vec<PackedAccessor>,
}

static NO_MARKS: Vec<Marks> = Vec::new();

impl UsualValue for Vec<Marks> {
    fn usual() -> &'static Self {
        &NO_MARKS
    }

    fn is_usual(&self) -> bool {
        self.is_empty()
    }
}
