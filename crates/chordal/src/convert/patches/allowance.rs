//! `Allowance`: the error that tiles may have, and the reasons why no mesh can meet it.
use crate::budget::{Failure, Lens, Pixels, RefusalCode};
use crate::explicit::{Mesh, Patch};
use crate::math::{Box3, greater, lesser};
use glam::DVec3;

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
    /// Parts that face the eye, or face away from it, as a whole may have a larger error.
    pub(crate) outline: Option<OutlineAllowance>,
}

/// More error where the outline cannot be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OutlineAllowance {
    pub(crate) eye: [f64; 3],
    /// The factor of the allowed length there, at least 1.
    pub(crate) elsewhere: f64,
}

impl OutlineAllowance {
    /// Whether no normal of the part is at a right angle to the line of sight, so that no point of it is on the outline.
    /// The normal is a combination, with weights that are not negative, of the cross products of the differences of
    /// control points along u with those along v. The control points may be off by `slip`, the rounding of the part.
    pub(crate) fn is_clear(&self, part: &Patch, slip: f64) -> bool {
        let point = |i: usize, j: usize| DVec3::from(part.control[i][j]);
        let bounds = part.bounds();
        let centre = DVec3::from(bounds.centre());
        let sight = DVec3::from(self.eye) - centre;
        // Every point of the part is within its box.
        let radius = 0.5 * (DVec3::from(bounds.max) - DVec3::from(bounds.min)).length() + 2.0 * slip;
        let (mut front, mut back) = (true, true);
        for i in 0..4 {
            for j in 0..3 {
                let first = point(i, j + 1) - point(i, j);
                for (k, l) in (0..3).flat_map(|k| (0..4).map(move |l| (k, l))) {
                    let second = point(k + 1, l) - point(k, l);
                    let normal = first.cross(second);
                    let toward = normal.dot(sight);
                    // A difference is off by two slips, which the product multiplies by the other difference. Twice that
                    // contains the roundings here: a slip is 4096 of those of a coordinate.
                    let off = 4.0 * slip * (first.length() + second.length() + 2.0 * slip);
                    let least = normal.length() * radius + off * (sight.length() + radius);
                    front &= toward >= least;
                    back &= -toward >= least;
                }
            }
        }
        front || back
    }
}

impl Allowance {
    /// A length everywhere.
    pub(crate) fn from_length(length: f64) -> Self {
        Self { length: Some(length), pixels: None, normal_deviation: None, share: 1.0, outline: None }
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

    /// The length that is allowed for a part.
    pub(crate) fn over(&self, part: &Patch, slip: f64) -> Option<f64> {
        let length = self.at(&part.bounds())?;
        match &self.outline {
            Some(outline) if outline.is_clear(part, slip) => {
                Some(greater(length, outline.elsewhere * length))
            }
            _ => Some(length),
        }
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
