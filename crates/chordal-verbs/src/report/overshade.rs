//! The shading cost on a graphics processor, in the report.
use chordal::View;
use chordal::budget::camera::Camera;
use chordal::check::shading::{Flicker, Overshade, ShadingCounts};
use chordal::explicit::query::HitSides;
use serde::Serialize;

/// The shading cost of a mesh at a view.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OvershadeFacts {
    /// The camera, in the syntax of a view.
    pub view: String,
    /// The culled sides: "none", "back" or "front".
    pub culled: &'static str,
    /// Triangles that are on the screen, at least in part, and not culled.
    pub in_view: u64,
    /// Triangles in view that cover no pixel centre.
    pub missed: u64,
    /// Triangles in view with an area on the screen below a pixel's.
    pub micro: u64,
    /// Pixels whose centre at least one triangle covers.
    pub covered_px: u64,
    /// The cost when every triangle is shaded, hidden or not.
    pub every: ShadingFacts,
    /// The cost after a depth pre-pass.
    pub visible: ShadingFacts,
    /// Lanes of `visible` per covered pixel.
    pub ratio: f64,
    /// The root mean square change of pixels when the view moves by less than a pixel, as a fraction of the
    /// range from black to white.
    pub flicker: f64,
    /// The pixels measured for `flicker`: those that stay covered wherever the view moves.
    pub flicker_px: u64,
}

/// Quads and their lanes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShadingFacts {
    /// Pairs of a triangle and a pixel in which it is shaded.
    pub fragments: u64,
    /// Pairs of a triangle and a quad of pixels in which it has a fragment.
    pub quads: u64,
    /// Four a quad.
    pub lanes: u64,
    /// Lanes without a fragment.
    pub helpers: u64,
    /// The fraction of lanes without a fragment.
    pub helper_share: f64,
}

impl ShadingFacts {
    fn new(shaded: &ShadingCounts) -> Self {
        Self {
            fragments: shaded.fragments,
            quads: shaded.quads,
            lanes: shaded.lanes(),
            helpers: shaded.helpers(),
            helper_share: shaded.helper_share(),
        }
    }
}

impl OvershadeFacts {
    /// The facts of a mesh at a camera.
    #[must_use]
    pub fn new(counts: &Overshade, flicker: &Flicker, camera: &Camera, sides: HitSides) -> Self {
        Self {
            view: View::Camera(*camera).to_string(),
            culled: match sides {
                HitSides::Both => "none",
                HitSides::Front => "back",
                HitSides::Back => "front",
            },
            in_view: counts.in_view,
            missed: counts.missed,
            micro: counts.micro,
            covered_px: counts.covered_px,
            every: ShadingFacts::new(&counts.every),
            visible: ShadingFacts::new(&counts.visible),
            ratio: counts.ratio(),
            flicker: flicker.rms,
            flicker_px: flicker.n_pixels,
        }
    }
}
