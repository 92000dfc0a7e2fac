//! What a graphics processor shades, as a report says it.
use chordal::View;
use chordal::budget::Camera;
use chordal::check::{Flicker, Overshade, ShadingCounts};
use chordal::explicit::HitSides;
use serde::Serialize;

/// What a mesh costs a graphics processor at a view.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OvershadeFacts {
    /// The camera, as `--view` takes it.
    pub view: String,
    /// Which sides are left out: "none", "back" or "front".
    pub culled: &'static str,
    /// Triangles of which something is on the screen and not culled.
    pub in_view: u64,
    /// Those that cover no pixel's centre.
    pub missed: u64,
    /// Those whose area on the screen is less than a pixel's.
    pub micro: u64,
    /// Pixels whose centre at least one triangle covers.
    pub covered_px: u64,
    /// What is shaded when every triangle is, hidden or not.
    pub every: ShadingFacts,
    /// What is shaded after a depth pre-pass.
    pub visible: ShadingFacts,
    /// Lanes of the visible a covered pixel.
    pub ratio: f64,
    /// The root of the mean square of what pixels change by when the view moves by less than a pixel, of the way from
    /// black to white.
    pub flicker: f64,
    /// The pixels that this was looked at: those that are covered wherever the view moves to.
    pub flicker_px: u64,
}

/// Quads and their lanes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShadingFacts {
    /// Pairs of a triangle and a pixel that it is shaded at.
    pub fragments: u64,
    /// Pairs of a triangle and a quad of pixels in which it has a fragment.
    pub quads: u64,
    /// Four a quad.
    pub lanes: u64,
    /// Lanes without a fragment.
    pub helpers: u64,
    /// Their share.
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
    pub fn new(found: &Overshade, flicker: &Flicker, camera: &Camera, sides: HitSides) -> Self {
        Self {
            view: View::Camera(*camera).to_string(),
            culled: match sides {
                HitSides::Both => "none",
                HitSides::Front => "back",
                HitSides::Back => "front",
            },
            in_view: found.in_view,
            missed: found.missed,
            micro: found.micro,
            covered_px: found.covered_px,
            every: ShadingFacts::new(&found.every),
            visible: ShadingFacts::new(&found.visible),
            ratio: found.ratio(),
            flicker: flicker.rms,
            flicker_px: flicker.n_pixels,
        }
    }
}
