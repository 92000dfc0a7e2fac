//! Pictures of shapes: ray-traced, and the same on every machine.
mod camera;
mod color;
mod comb_picture;
mod drawing;
mod field;
mod field_picture;
mod heat_map;
mod light;
mod light_grid;
mod line_depths;
mod normals;
mod options;
mod overshade;
mod picture;
mod picture_tile;
mod render_mesh;
mod sample_pattern;
mod trace;
mod traced_surface;
mod zebra;

pub use camera::frame;
pub use options::{Background, CullMode, RenderOptions, RenderStyle, UpAxis, Viewpoint};
pub use overshade::{DARKEST_LANES, render_overshade};
pub use picture::Picture;
pub use trace::{render, render_against};

/// Pictures of paths in the plane.
pub mod drawings {
    pub use super::comb_picture::{CombPicture, render_comb};
}

/// Pictures of fields, and the surfaces with which they are compared.
pub mod fields {
    pub use super::field::{frame_field, render_field};
    pub use super::field_picture::{FieldPicture, FieldRenderError};
    pub use super::heat_map::ReferenceSurface;
}
