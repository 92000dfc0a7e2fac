//! `Marks`: points and lines that stand beside the triangles of a part.
use crate::PackedAccessor;
use crate::rare_value::UsualValue;
use serde_json::{Map, Value};

/// Points or lines of a mesh of a glTF: a primitive that has no triangles. Like
/// [`SceneAssets`](crate::SceneAssets) they are carried from a reader to a writer, and nothing in between looks
/// inside: they are not measured, bounded, mended or made fewer.
#[derive(Clone, Debug, PartialEq)]
pub struct Marks {
    /// What glTF says of the primitive beside its material: mode, attributes, indices, morph targets, extras. Where
    /// glTF names accessors, these are indices of `accessors`.
    pub primitive: Map<String, Value>,
    /// The index of their material.
    pub material: Option<usize>,
    /// Their numbers, in the coordinates of the part.
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
