//! Pictures of shapes, ray-traced and the same on every machine.
mod color;
mod eye;
mod heat;
mod light;
mod normals;
mod options;
mod pattern;
mod picture;
mod surface;
mod trace;

pub use eye::frame;
pub use heat::Against;
pub use options::{Background, Cull, Options, Show, Up, Viewpoint};
pub use picture::Picture;
pub use trace::{render, render_against};
