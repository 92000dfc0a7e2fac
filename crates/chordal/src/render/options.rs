//! `RenderOptions`: the content, viewpoint and resolution of a picture.
use crate::budget::{Camera, Screen};

/// The content of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RenderStyle {
    /// The lit surface, smooth by the mesh's normals; without normals, smooth across edges of less than 30°.
    #[default]
    Shaded,
    /// The lit triangles, unsmoothed.
    Flat,
    /// The triangles' edges over a light surface, hidden lines removed.
    Wire,
    /// The normal as a colour: −1 … 1 of x, y, z as 0 … 255 of red, green, blue, not gamma-corrected.
    Normals,
    /// The reflection of striped walls in the surface. The stripes jump at edges, bend where only tangent
    /// planes agree, and continue smoothly where curvatures agree. Normals are as in [`RenderStyle::Shaded`].
    Zebra,
    /// The number of lanes that a graphics processor launches for each pixel: see
    /// [`super::render_overshade`].
    Overshade,
}

/// The sides of triangles that are culled, as by graphics processors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CullMode {
    /// No culling: both sides are shown, in different colours.
    #[default]
    None,
    /// Culls back faces: surfaces seen from inside are holes. A triangle wound the wrong way opens one.
    Back,
    /// Culls front faces: shows the inside of surfaces that are turned away.
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

/// The background behind the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// A light backdrop, and a ground under the mesh that receives its shadow.
    #[default]
    Studio,
    /// Transparent; the shadow of the mesh on the ground is black of its opacity.
    Shadow,
    /// Transparent, without a shadow.
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
    /// The content.
    pub show: RenderStyle,
    /// The sides that are culled. Culled faces still cast shadows.
    pub cull: CullMode,
    /// The viewpoint.
    pub viewpoint: Viewpoint,
    /// The axis that points up: for the light, the ground and the automatic viewpoint.
    pub up: UpAxis,
    /// The background behind the mesh.
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
