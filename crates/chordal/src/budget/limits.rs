//! `Budget`: the allowed error, in units, in pixels at a view, in degrees, or as a number of triangles.
use super::lens::{Lens, PixelScale};
use super::{AttributeLimits, Bound, Pixels, Refusal, RefusalCode, Tolerance, View};
use crate::math::{Box3, lesser};
use std::fmt;
use std::str::FromStr;

/// The evidence that a result must carry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RequiredEvidence {
    /// A proved upper bound, rounding included.
    #[default]
    Proved,
    /// A proof if one is found with about as much work as the result itself took; otherwise a measurement of
    /// the whole result, with the places that are not proved ([`Bound::open`](super::Bound::open)).
    ProvedOrMeasured,
    /// A measurement is enough.
    Measured,
    /// A draft whose error is neither proved nor measured is enough.
    Estimated,
}

impl RequiredEvidence {
    /// The name in a command and in a report.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Proved => "proved",
            Self::ProvedOrMeasured => "proved-or-measured",
            Self::Measured => "measured",
            Self::Estimated => "estimated",
        }
    }
}

/// The error for a text that names no kind of evidence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownRequirement(String);

impl fmt::Display for UnknownRequirement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "'{}' is none of proved, proved-or-measured, measured and estimated", self.0)
    }
}

impl std::error::Error for UnknownRequirement {}

impl FromStr for RequiredEvidence {
    type Err = UnknownRequirement;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let variants = [Self::Proved, Self::ProvedOrMeasured, Self::Measured, Self::Estimated];
        let named = variants.into_iter().find(|require| require.as_str() == text);
        named.ok_or_else(|| UnknownRequirement(text.chars().take(40).collect())) // 40: fits in a message
    }
}

/// An error limit on the screen, at a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelBudget {
    /// The largest distance on the screen, in device pixels.
    pub pixels: Pixels,
    /// The view.
    pub view: View,
}

/// Optional limits. At least one of `length`, `pixels` and a count must be set; all that are set must hold.
///
/// ```
/// use chordal::{Budget, Tolerance};
/// let budget = Budget { triangles: Some(5000), ..Budget::length(Tolerance::new(0.01).unwrap()) };
/// assert!(budget.has_limit());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Budget {
    /// The largest distance to the true shape, in the shape's units.
    pub length: Option<Tolerance>,
    /// The largest distance on the screen.
    pub pixels: Option<PixelBudget>,
    /// The largest angle between the triangles' normals and the true ones, in degrees.
    pub angle_deg: Option<f64>,
    /// How far the attributes of a simplified mesh may be from those of the original.
    pub attributes: AttributeLimits,
    /// The largest number of triangles.
    pub triangles: Option<u64>,
    /// The largest number of polyline segments in total.
    pub segments: Option<u64>,
    /// The required evidence.
    pub require: RequiredEvidence,
}

impl Budget {
    /// A budget with a length limit only.
    #[must_use]
    pub fn length(length: Tolerance) -> Self {
        Self { length: Some(length), ..Self::default() }
    }

    /// A budget of pixels at a view.
    #[must_use]
    pub fn pixels(pixels: Pixels, view: View) -> Self {
        Self { pixels: Some(PixelBudget { pixels, view }), ..Self::default() }
    }

    /// A budget with a triangle limit only.
    #[must_use]
    pub fn triangles(limit: u64) -> Self {
        Self { triangles: Some(limit), ..Self::default() }
    }

    /// A budget with a segment limit only.
    #[must_use]
    pub fn segments(limit: u64) -> Self {
        Self { segments: Some(limit), ..Self::default() }
    }

    /// The length that the budget's length and pixel limits allow everywhere in `place`. Infinite if it has
    /// neither limit; `None` if `place` comes so close to the eye that no length is small enough.
    ///
    /// ```
    /// use chordal::{Budget, math::Box3};
    /// let place = Box3 { min: [-1.0; 3], max: [1.0; 3] };
    /// let budget = Budget::pixels("1px".parse()?, "1000x1000 fov=90 eye=0,0,6 target=0,0,0".parse()?);
    /// let length = budget.length_in(&place).unwrap(); // a pixel at a distance of 5, and in the corner of the picture
    /// assert!(length > 0.005 && length < 0.01);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn length_in(&self, place: &Box3) -> Option<f64> {
        let by_view = match &self.pixels {
            Some(PixelBudget { pixels, view }) => view.length_of(*pixels, place)?,
            None => f64::INFINITY,
        };
        let by_length = self.length.map_or(f64::INFINITY, Tolerance::get);
        Some(lesser(by_length, by_view))
    }

    /// Whether a bound keeps its length, its pixels and its angle. A bound without an upper end keeps nothing.
    pub(crate) fn is_met_by(&self, bound: &Bound) -> bool {
        let within = |value: Option<f64>, limit: Option<f64>| {
            limit.is_none_or(|limit| value.is_some_and(|value| value <= limit))
        };
        bound.at_most().is_some()
            && within(bound.at_most(), self.length.map(Tolerance::get))
            && within(bound.pixels, self.pixels.map(|limit| limit.pixels.get()))
            && within(bound.angle_deg, self.angle_deg)
    }

    /// Whether it has a limit that a mesh can be built for.
    #[must_use]
    pub fn has_limit(&self) -> bool {
        self.length.is_some() || self.pixels.is_some() || self.triangles.is_some()
    }

    /// Refuses a budget that no mesh of a smooth surface can be built for: one without a limit, with limits on
    /// attributes, or with an angle that is not in (0°, 180°].
    pub(crate) fn check_for_surfaces(&self) -> Result<(), Refusal> {
        if !self.has_limit() {
            let message = "a budget needs a length, pixels at a view, or a number of triangles";
            return Err(Refusal::new(RefusalCode::Budget, message));
        }
        if self.attributes.is_set() {
            let message = "limits on texture coordinates and normals apply only where triangles with such \
                 attributes are simplified";
            return Err(Refusal::new(RefusalCode::Budget, message));
        }
        match self.angle_deg {
            Some(angle) if !(angle > 0.0 && angle <= 180.0) => {
                let message = format!("an angle is above 0 degrees and at most 180, not {angle}");
                Err(Refusal::new(RefusalCode::Budget, message))
            }
            _ => Ok(()),
        }
    }

    /// Whether it has a limit that a polyline can be built for.
    #[must_use]
    pub fn limits_polylines(&self) -> bool {
        self.length.is_some() || self.pixels.is_some() || self.segments.is_some()
    }
}

/// The allowed error: a length and, for a camera, pixels, which allow more length farther away.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ErrorLimit {
    /// Infinite if only pixels are limited.
    length: f64,
    pixel_limit: Option<(Pixels, Lens)>,
}

impl ErrorLimit {
    /// The same length everywhere.
    pub fn uniform(length: f64) -> Self {
        Self { length, pixel_limit: None }
    }

    /// The limit of a budget in and around `place`. `None` if no length is small enough for any part of it.
    pub fn from_budget(budget: &Budget, place: &Box3) -> Option<Self> {
        match &budget.pixels {
            Some(PixelBudget { pixels, view: view @ View::Camera(_) }) => Some(Self {
                length: budget.length.map_or(f64::INFINITY, super::Tolerance::get),
                pixel_limit: Some((*pixels, view.lens())),
            }),
            _ => budget.length_in(place).map(Self::uniform),
        }
    }

    /// The length, if it is the same everywhere.
    pub fn constant(&self) -> Option<f64> {
        self.pixel_limit.is_none().then_some(self.length)
    }

    /// The length for all points of `place`; `None` if the eye is too close to some of them.
    pub fn at(&self, place: &Box3) -> Option<f64> {
        self.at_with_scale(place).0
    }

    /// [`ErrorLimit::at`], and the pixel scale of the place if there is a camera.
    pub fn at_with_scale(&self, place: &Box3) -> (Option<f64>, Option<PixelScale>) {
        let Some((pixels, lens)) = &self.pixel_limit else { return (Some(self.length), None) };
        let scale = lens.scale_at(place);
        let length = scale.length_of(*pixels).map(|visible| lesser(self.length, visible));
        (length, Some(scale))
    }
}
