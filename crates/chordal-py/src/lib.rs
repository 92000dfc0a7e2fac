//! The compiled part of the Python package: translates Python's arguments into verbs. It holds no geometry.
//!
//! `python/chordal` is the other part: the public names, their documentation, and everything that is easier
//! in Python. Only plain values cross between the two: numbers, texts, bytes, JSON, and a few frozen objects
//! that hold shapes.
mod array;
mod block;
mod cage;
mod combine;
mod command;
mod conversion;
mod curve;
mod deviation;
mod failure;
mod levels;
mod mend;
mod outcome;
mod part;
mod path;
mod picture;
mod pool;
mod python_leaf;
mod rows;
mod scene;
mod scene_state;
mod script_value;
mod source;
mod spec;
mod spelling;
mod surface;
mod view;
mod volume;
mod work;

use pyo3::prelude::*;

/// The compiled part of chordal.
#[pymodule]
mod _chordal {
    #[pymodule_export]
    use super::block::{Block, block, joined, label_blocks};
    #[pymodule_export]
    use super::combine::combine;
    #[pymodule_export]
    use super::conversion::{Conversion, convert};
    #[pymodule_export]
    use super::deviation::{history, verified};
    #[pymodule_export]
    use super::levels::{Levels, levels};
    #[pymodule_export]
    use super::mend::mend;
    #[pymodule_export]
    use super::part::{BlockPart, join_parts, label_parts, part, tileset};
    #[pymodule_export]
    use super::path::{drawing_field, fit, path_at, path_facts, path_source, to_cubics};
    #[pymodule_export]
    use super::picture::{Picture, picture};
    #[pymodule_export]
    use super::scene::{
        composed_bound, scene_array, scene_facts, scene_image, scene_of_parts, scene_of_state, scene_state,
    };
    #[pymodule_export]
    use super::script_value::{ScriptValue, field_of, language, mesh_field, region_of, script};
    #[pymodule_export]
    use super::surface::{extruded, revolved, surface};
    #[pymodule_export]
    use super::volume::samples;
    #[pymodule_export]
    use super::{array::Array, cage::Cage, command::command, outcome::Outcome, source::Source, view::view};
    use chordal_io::Limits;
    use pyo3::prelude::*;

    /// The version, and the largest file that is read.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("VERSION", env!("CARGO_PKG_VERSION"))?;
        module.add("MOST_BYTES", Limits::default().bytes)
    }
}
