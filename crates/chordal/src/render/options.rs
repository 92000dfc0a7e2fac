//! `RenderOptions`: what a picture shows, from where, and how finely.
use crate::budget::{Camera, Screen};

/// What a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RenderStyle {
    /// The lit surface, smooth by the mesh's own normals; without any, smooth across edges of less than 30°.
    #[default]
    Shaded,
    /// The lit triangles as they are.
    Flat,
    /// The triangles' edges over a light surface, hidden lines removed.
    Wire,
    /// The normal as a colour: −1 … 1 of x, y, z as 0 … 255 of red, green, blue, not gamma-corrected.
    Normals,
    /// The reflection of striped walls in the surface. The stripes jump at edges, bend where only tangent
    /// planes agree, and run on smoothly where curvatures agree. Normals are as in [`RenderStyle::Shaded`].
    Zebra,
    /// The number of lanes that a graphics processor launches for each pixel: see
    /// [`super::render_overshade`].
    Overshade,
}

/// Which sides of triangles are culled, as graphics processors do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CullMode {
    /// No culling: both sides are shown, in different colours.
    #[default]
    None,
    /// Culls back faces: what is seen from inside is a hole. A triangle wound the wrong way opens one.
    Back,
    /// Culls front faces: the inside of what is turned away is shown.
    Front,
}

/// The axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// The second axis, as in glTF; the front looks along z.
    Y,
    /// The third axis, as in most CAD; the front looks against y.
    #[default]
    Z,
}

impl UpAxis {
    /// The unit vector up.
    #[must_use]
    pub fn direction(self) -> [f64; 3] {
        match self {
            Self::Y => [0.0, 1.0, 0.0],
            Self::Z => [0.0, 0.0, 1.0],
        }
    }

    /// The unit vector out of the front.
    #[must_use]
    pub fn front(self) -> [f64; 3] {
        match self {
            Self::Y => [0.0, 0.0, 1.0],
            Self::Z => [0.0, -1.0, 0.0],
        }
    }
}

/// A viewpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Viewpoint {
    /// From the front, a little from the right and from above, so that the mesh fills the picture: see
    /// [`super::frame`].
    Automatic(Screen),
    /// From this camera.
    Camera(Camera),
}

/// What is behind the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// A light backdrop, and a ground under the mesh that takes its shadow.
    #[default]
    Studio,
    /// Nothing; where the mesh would cast a shadow on the ground, black of that opacity.
    Shadow,
    /// Nothing at all.
    Transparent,
}

/// The options of a picture.
///
/// ```
/// use chordal::render::{RenderOptions, RenderStyle};
/// let options = RenderOptions { show: RenderStyle::Wire, ..RenderOptions::sized(640, 480) };
/// assert_eq!(options.samples, 3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderOptions {
    /// What is shown.
    pub show: RenderStyle,
    /// What is culled. Culled faces still cast shadows.
    pub cull: CullMode,
    /// The viewpoint.
    pub viewpoint: Viewpoint,
    /// The axis that points up: for the light, the ground and the automatic viewpoint.
    pub up: UpAxis,
    /// What is behind the mesh.
    pub background: Background,
    /// `samples²` rays per pixel; 1 to 16.
    pub samples: u32,
}

impl RenderOptions {
    /// The defaults at a size in pixels.
    #[must_use]
    pub fn sized(width_px: u32, height_px: u32) -> Self {
        Self {
            show: RenderStyle::default(),
            cull: CullMode::default(),
            viewpoint: Viewpoint::Automatic(Screen { width_px, height_px }),
            up: UpAxis::default(),
            background: Background::default(),
            samples: 3,
        }
    }
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self::sized(1280, 960)
    }
}
