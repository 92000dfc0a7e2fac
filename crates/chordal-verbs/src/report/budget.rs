//! The budget in the report.
use chordal::budget::camera::Projection;
use chordal::budget::{Budget, View};
use serde::Serialize;

/// A [`Budget`] in the report: lengths are absolute, in whatever way they were given.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BudgetFacts {
    /// The largest distance to the true shape.
    pub length: Option<f64>,
    /// The largest distance on the screen, in device pixels.
    pub pixels: Option<f64>,
    /// The view that the pixels are for.
    pub view: Option<ViewFacts>,
    /// The largest angle to the true normals, in degrees.
    pub angle_deg: Option<f64>,
    /// The largest distance to the texture coordinates of the input.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texcoord: Option<f64>,
    /// The largest angle to the normals of the input, in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal_deg: Option<f64>,
    /// The most triangles.
    pub triangles: Option<u64>,
    /// The most segments of polylines.
    pub segments: Option<u64>,
}

impl BudgetFacts {
    /// The facts of a budget.
    #[must_use]
    pub fn new(budget: &Budget) -> Self {
        Self {
            length: budget.length.map(|length| length.get()),
            pixels: budget.pixels.map(|pixels| pixels.pixels.get()),
            view: budget.pixels.map(|pixels| ViewFacts::new(&pixels.view)),
            angle_deg: budget.angle_deg,
            texcoord: budget.attributes.texcoord(),
            normal_deg: budget.attributes.normal_deg(),
            triangles: budget.triangles,
            segments: budget.segments,
        }
    }
}

/// A [`View`] in the report. The view can be restored from `text`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ViewFacts {
    /// The view in the syntax of the command line.
    pub text: String,
    /// "camera" for one eye, "closest" for every eye at that distance or farther.
    pub kind: &'static str,
    /// Columns of the screen.
    pub width_px: u32,
    /// Rows of the screen.
    pub height_px: u32,
    /// The vertical field of view in degrees; `None` for parallel rays.
    pub fov_y_deg: Option<f64>,
    /// The height of the picture in the shape's units, for parallel rays.
    pub height: Option<f64>,
    /// The nearest distance to the shape's box, for "closest".
    pub distance: Option<f64>,
    /// The position of the eye, for "camera".
    pub eye: Option<[f64; 3]>,
    /// The point in the middle of the picture, for "camera".
    pub target: Option<[f64; 3]>,
    /// The up direction of the picture, for "camera".
    pub up: Option<[f64; 3]>,
    /// The near plane: depth below which nothing is drawn, for "camera".
    pub near: Option<f64>,
}

impl ViewFacts {
    /// The facts of a view.
    #[must_use]
    pub fn new(view: &View) -> Self {
        let (projection, screen) = match view {
            View::Camera(camera) => (camera.projection, camera.screen),
            View::MinDistance(closest) => (closest.projection, closest.screen),
        };
        let (fov_y_deg, height) = match projection {
            Projection::Perspective { fov_y_deg } => (Some(fov_y_deg), None),
            Projection::Orthographic { height } => (None, Some(height)),
        };
        let (camera, closest) = match view {
            View::Camera(camera) => (Some(camera), None),
            View::MinDistance(closest) => (None, Some(closest)),
        };
        Self {
            text: view.to_string(),
            kind: if camera.is_some() { "camera" } else { "closest" },
            width_px: screen.width_px,
            height_px: screen.height_px,
            fov_y_deg,
            height,
            distance: closest.map(|view| view.distance),
            eye: camera.map(|view| view.eye),
            target: camera.map(|view| view.target),
            up: camera.map(|view| view.up),
            near: camera.map(|view| view.near),
        }
    }
}
