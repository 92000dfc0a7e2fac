//! `Allowance`: the error that tiles may have, and the reasons why no mesh can meet it.
use crate::budget::{Failure, Lens, Pixels, RefusalCode};
use crate::explicit::Mesh;
use crate::math::{Box3, lesser};

pub(crate) type TessellationFailure = Failure<Mesh>;

/// The error that is allowed at each place of the shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Allowance {
    pub(crate) length: Option<f64>,
    pub(crate) pixels: Option<(Pixels, Lens)>,
    /// The largest distance between the unit normals of the triangles and those of the shape.
    pub(crate) normal_deviation: Option<f64>,
    /// The share of the allowed length that is used, at most 1; the rest is reserved for later views.
    pub(crate) share: f64,
}

impl Allowance {
    /// A length everywhere.
    pub(crate) fn from_length(length: f64) -> Self {
        Self { length: Some(length), pixels: None, normal_deviation: None, share: 1.0 }
    }

    /// The length that is allowed in a box; `None` if the eye is too close for any.
    pub(crate) fn at(&self, bounds: &Box3) -> Option<f64> {
        let by_view = match &self.pixels {
            Some((pixels, lens)) => lens.scale_at(bounds).length_of(*pixels)?,
            None => f64::MAX,
        };
        let by_length = self.length.unwrap_or(f64::MAX);
        // With a share of at most 1, the rounded product is no more than the other factor.
        Some(self.share * lesser(by_length, by_view))
    }
}

/// The reason why no mesh can meet an allowance, with a box around the place.
#[derive(Clone, Copy, Debug)]
pub(crate) enum InfeasibleTolerance {
    /// The eye is so near that no length is small enough.
    TooClose(Box3),
    /// Adding cells does not converge.
    NoConvergence(Box3),
    /// Rounding alone exceeds the tolerance; the number is the rounding error.
    BelowRounding(Box3, f64),
}

/// The refusal of an allowance that no mesh can meet.
pub(crate) fn refuse_tolerance(obstacle: InfeasibleTolerance) -> TessellationFailure {
    let centre = |place: Box3| place.centre().map(|x| format!("{x:.4}")).join(", ");
    match obstacle {
        InfeasibleTolerance::TooClose(place) => {
            let place = centre(place);
            let message = format!(
                "the eye is too close to the shape near ({place}) for any bound in pixels; a camera can be given near=LENGTH"
            );
            Failure::refused(RefusalCode::TooClose, message)
        }
        InfeasibleTolerance::NoConvergence(place) => {
            let place = centre(place);
            let message = format!(
                "near ({place}) no number of triangles seems to be enough: the surface bends too sharply \
                 for this angle"
            );
            Failure::refused(RefusalCode::BelowPrecision, message)
        }
        InfeasibleTolerance::BelowRounding(place, rounding) => {
            let place = centre(place);
            let message = format!(
                "rounding near ({place}) alone can lose {rounding:.1e}, so no mesh in double precision can be proved to meet the budget"
            );
            Failure::refused(RefusalCode::BelowPrecision, message)
        }
    }
}
