//! Shapes as they are read: from files, scripts, drawings, lattices of heights.
pub(crate) mod carried;
pub(crate) mod drawing_regions;
pub(crate) mod drawing_to_field;
pub(crate) mod file_extension;
#[cfg(feature = "script")]
pub(crate) mod heights_to_mesh;
pub(crate) mod implicit;
pub(crate) mod load;
pub(crate) mod scene_to_field;
pub(crate) mod script;
#[cfg(feature = "script")]
pub(crate) mod script_files;
pub(crate) mod shape;
pub(crate) mod smoothing_width;
pub(crate) mod volume;
