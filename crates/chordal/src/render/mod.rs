//! Pictures of shapes, ray-traced and the same on every machine.
mod color;
mod drawing;
mod eye;
mod field;
mod heat;
mod light;
mod normals;
mod options;
mod overshade;
mod pattern;
mod picture;
mod surface;
mod trace;
mod zebra;

pub use eye::frame;
pub use field::{FieldPicture, NotDrawn, frame_field, render_field};
pub use heat::Against;
pub use options::{Background, Cull, Options, Show, Up, Viewpoint};
pub use overshade::{DARKEST_LANES, render_overshade};
pub use picture::Picture;
pub use trace::{render, render_against};
