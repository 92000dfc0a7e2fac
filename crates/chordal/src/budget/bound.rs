//! `Bound`: an enclosure of the error of a result, with its metric, its reference shape and its evidence.
use super::OpenPlaces;
use crate::math::{add_up, greater, mul_down, mul_up, sub_down};
use std::fmt;

/// How a bound is known, strongest first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Evidence {
    /// Proved for every case that the code can reach, rounding included.
    Proved,
    /// Proved under assumptions, each stated in a sentence: the user's, or that no region was missed.
    ProvedIf(Vec<String>),
    /// Sampled: a lower bound only.
    Measured {
        /// How many samples were taken.
        samples: u64,
    },
    /// Neither proved nor sampled.
    Estimated,
}

impl Evidence {
    /// The evidence for a chain of two steps: the weaker of the two. Assumptions are joined; the smaller
    /// sample count is kept.
    #[must_use]
    pub fn weaker(&self, other: &Self) -> Self {
        match (self, other) {
            (Self::ProvedIf(a), Self::ProvedIf(b)) => {
                let mut sentences = a.clone();
                sentences.extend(b.iter().filter(|sentence| !a.contains(sentence)).cloned());
                Self::ProvedIf(sentences)
            }
            (Self::Measured { samples: a }, Self::Measured { samples: b }) => {
                Self::Measured { samples: *a.min(b) }
            }
            // Kinds are declared from the strongest to the weakest.
            (a, b) => a.max(b).clone(),
        }
    }

    /// Whether the evidence gives an upper bound.
    #[must_use]
    pub fn bounds_above(&self) -> bool {
        matches!(self, Self::Proved | Self::ProvedIf(_))
    }

    /// The name in a report.
    #[must_use]
    pub fn as_str(&self) -> &'static str {
        match self {
            Self::Proved => "proved",
            Self::ProvedIf(_) => "proved-if",
            Self::Measured { .. } => "measured",
            Self::Estimated => "estimated",
        }
    }
}

/// The quantity that a bound measures between the true shape and the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// The larger of the two one-sided Hausdorff distances.
    Hausdorff,
    /// The distance between points of equal parameter; never smaller than the Hausdorff distance.
    Parametric,
    /// From the true shape to the result only.
    OneSided,
    /// For solids: a point farther than this from the surface of the true shape, and from those of the
    /// operands if there are any, is inside the result if and only if it is inside the true shape. A thin tip
    /// or gap may be longer than this.
    Solid,
}

impl Metric {
    /// The name in a report.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Hausdorff => "hausdorff",
            Self::Parametric => "parametric",
            Self::OneSided => "one-sided",
            Self::Solid => "solid",
        }
    }

    fn weaker(self, other: Self) -> Self {
        match (self, other) {
            (Self::Solid, _) | (_, Self::Solid) => Self::Solid,
            (Self::OneSided, _) | (_, Self::OneSided) => Self::OneSided,
            (Self::Parametric, Self::Parametric) => Self::Parametric,
            _ => Self::Hausdorff,
        }
    }
}

/// The true shape that a bound refers to: the parsed f64 data, taken exactly.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reference {
    /// Paths of lines, cubic Bézier curves and arcs.
    Curves,
    /// Points.
    InputPoints,
    /// Bicubic Bézier patches.
    BezierPatches,
    /// Rational B-spline surfaces.
    NurbsSurfaces,
    /// The limit surface of a control cage.
    LimitSurface,
    /// The triangles of the input.
    InputTriangles,
    /// The boundary of the region where a field is negative.
    Field,
    /// The isosurface of the trilinear interpolant of a volume's samples.
    Trilinear,
    /// The union, difference or intersection of the solids that several meshes bound.
    Boolean,
    /// Several of these, next to each other.
    Several,
}

impl Reference {
    /// The name in a report.
    #[must_use]
    pub fn as_str(&self) -> &'static str {
        match self {
            Self::Curves => "curves",
            Self::InputPoints => "input points",
            Self::BezierPatches => "bezier patches",
            Self::NurbsSurfaces => "nurbs surfaces",
            Self::LimitSurface => "limit surface",
            Self::InputTriangles => "input triangles",
            Self::Field => "field",
            Self::Trilinear => "trilinear interpolant",
            Self::Boolean => "boolean",
            Self::Several => "several shapes",
        }
    }
}

/// An enclosure of the distance between the true shape and the result.
///
/// By construction `0 ≤ at_least ≤ at_most`, and `at_most` is set exactly when the evidence gives an upper
/// bound.
///
/// ```
/// use chordal::budget::{Bound, Reference};
/// let first = Bound::proved(0.1, 0.2, Reference::BezierPatches);
/// let second = Bound::proved(0.0, 0.05, Reference::InputTriangles);
/// let chain = first.then(&second); // lengths add
/// assert!(chain.at_most().unwrap() >= 0.25 && chain.at_least() >= 0.04);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    at_least: f64,
    at_most: Option<f64>,
    evidence: Evidence,
    /// The true shape.
    pub reference: Reference,
    /// The measured quantity.
    pub metric: Metric,
    /// The point where the error is largest, as far as known.
    pub at: Option<[f64; 3]>,
    /// The largest distance on the screen in pixels, if a view was given and the evidence gives an upper
    /// bound.
    pub pixels: Option<f64>,
    /// The largest angle found between a triangle's normal and the shape's normal at its corners and in its
    /// middle, in degrees. Set if the budget limits an angle. It is measured, whatever the evidence of the
    /// distance.
    pub angle_deg: Option<f64>,
    /// The places left unproved. Either the evidence is [`Evidence::Measured`] for the whole, or the bound
    /// proved for the whole exceeds the length that was asked for.
    pub open: Option<Box<OpenPlaces>>,
}

impl Bound {
    /// Nothing was lost.
    #[must_use]
    pub fn exact(reference: Reference) -> Self {
        Self::proved(0.0, 0.0, reference)
    }

    /// A proved two-sided Hausdorff distance in `[at_least, at_most]`.
    ///
    /// # Panics
    /// Unless `0 ≤ at_least ≤ at_most < ∞`: otherwise the caller's proof is broken.
    #[must_use]
    pub fn proved(at_least: f64, at_most: f64, reference: Reference) -> Self {
        Self::with_evidence(at_least, Some(at_most), Evidence::Proved, reference)
    }

    /// A bound of any evidence.
    ///
    /// # Panics
    /// When `at_most` is missing although the evidence gives an upper bound, when it is set although the
    /// evidence gives none, or unless `0 ≤ at_least ≤ at_most < ∞`.
    #[must_use]
    pub fn with_evidence(
        at_least: f64,
        at_most: Option<f64>,
        evidence: Evidence,
        reference: Reference,
    ) -> Self {
        assert_eq!(
            at_most.is_some(),
            evidence.bounds_above(),
            "a bound from above needs proof, and proof gives one"
        );
        assert!(at_least >= 0.0 && at_least.is_finite(), "at_least is {at_least}");
        assert!(at_most.is_none_or(|most| at_least <= most && most.is_finite()), "{at_least} > {at_most:?}");
        Self {
            at_least,
            at_most,
            evidence,
            reference,
            metric: Metric::Hausdorff,
            at: None,
            pixels: None,
            angle_deg: None,
            open: None,
        }
    }

    /// The lower bound of the distance.
    #[must_use]
    pub fn at_least(&self) -> f64 {
        self.at_least
    }

    /// The upper bound of the distance, if one is proved.
    #[must_use]
    pub fn at_most(&self) -> Option<f64> {
        self.at_most
    }

    /// How the bound is known.
    #[must_use]
    pub fn evidence(&self) -> &Evidence {
        &self.evidence
    }

    /// A bound for all parts of a shape: the largest of theirs. Its lower end is 0, since a point far from
    /// its own part may be near another one. `None` without parts.
    #[must_use]
    pub fn of_parts<'a>(parts: impl Iterator<Item = &'a Self>) -> Option<Self> {
        let most_of = |bound: &Self| bound.at_most.unwrap_or(f64::INFINITY);
        let farthest = parts.fold(None, |farthest: Option<&Self>, part| match farthest {
            Some(before) if most_of(before) >= most_of(part) => Some(before),
            _ => Some(part),
        })?;
        Some(Self { at_least: 0.0, pixels: None, ..farthest.clone() })
    }

    /// The bound for true shape → A → B from those for true shape → A (`self`) and A → B (`next`).
    ///
    /// Upper bounds add, rounded up, and the weaker evidence is kept; if the sum overflows, there is no upper
    /// bound and the evidence is [`Evidence::Estimated`]. The lower bound follows from the triangle
    /// inequality: `at_least` of one step minus `at_most` of the other. The metric of that step must be the
    /// metric of the result (a parametric distance of at least 1 does not keep the shapes 1 apart), and the
    /// other step must bound both directions. Pixels do not add here, because they belong to a view: the
    /// caller converts the length again. Angles do not add either. Nor does [`Metric::Solid`], unless the
    /// other step is exact: that two surfaces are near each other says nothing about the sides of points.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        let metric = self.metric.weaker(next.metric);
        let evidence = self.evidence.weaker(&next.evidence);
        // Adding 0 to a length leaves it exact.
        let sum = self
            .at_most
            .zip(next.at_most)
            .map(|(a, b)| if a == 0.0 || b == 0.0 { a + b } else { add_up(a, b) });
        let loses_sides =
            |this: &Self, other: &Self| this.metric == Metric::Solid && other.at_most != Some(0.0);
        let (at_most, evidence) = match sum {
            Some(infinite) if !infinite.is_finite() => (None, Evidence::Estimated),
            Some(_) if loses_sides(self, next) || loses_sides(next, self) => (None, Evidence::Estimated),
            sum => (sum, evidence),
        };
        let (first, second) =
            (self.remaining_lower_bound(next, metric), next.remaining_lower_bound(self, metric));
        let at = if self.at_most >= next.at_most { self.at.or(next.at) } else { next.at.or(self.at) };
        Self {
            at_least: greater(first, second),
            at_most,
            evidence,
            reference: self.reference.clone(),
            metric,
            at,
            pixels: None,
            angle_deg: None,
            open: self.open.clone().or_else(|| next.open.clone()),
        }
    }

    /// The bound for two shapes next to each other, from the bound of each.
    ///
    /// The upper end is the larger one, with the weaker evidence and the weaker metric. The lower end is 0,
    /// since a point far from its own shape may be near the other one. If only one of the two metrics is
    /// [`Metric::Solid`] and the other shape is not exact, nothing bounds both.
    ///
    /// ```
    /// use chordal::budget::{Bound, Reference};
    /// let (ball, box_of_triangles) = (Bound::proved(0.1, 0.2, Reference::Field), Bound::exact(Reference::InputTriangles));
    /// let both = ball.beside(&box_of_triangles);
    /// assert_eq!((both.at_least(), both.at_most(), both.reference), (0.0, Some(0.2), Reference::Several));
    /// ```
    #[must_use]
    pub fn beside(&self, other: &Self) -> Self {
        let loses_sides = |this: &Self, other: &Self| {
            this.metric == Metric::Solid && other.metric != Metric::Solid && other.at_most != Some(0.0)
        };
        let farther = if self.at_most >= other.at_most { self } else { other };
        let both = self.at_most.zip(other.at_most).map(|(a, b)| greater(a, b));
        let (at_most, evidence) = if loses_sides(self, other) || loses_sides(other, self) {
            (None, Evidence::Estimated)
        } else {
            (both, self.evidence.weaker(&other.evidence))
        };
        Self {
            at_least: 0.0,
            at_most,
            evidence,
            reference: if self.reference == other.reference {
                self.reference.clone()
            } else {
                Reference::Several
            },
            metric: self.metric.weaker(other.metric),
            at: farther.at,
            pixels: None,
            angle_deg: None,
            open: match (&self.open, &other.open) {
                (Some(a), Some(b)) => Some(Box::new(a.beside(b))),
                (a, b) => a.clone().or_else(|| b.clone()),
            },
        }
    }

    /// The bound after an affine map of both shapes that stretches lengths by a factor in
    /// `[shortest, longest]`. Places, pixels and angles are dropped. Without an upper end if that overflows.
    ///
    /// ```
    /// use chordal::budget::{Bound, Reference};
    /// let twice = Bound::proved(0.1, 0.2, Reference::Field).stretched(2.0, 2.0);
    /// assert!(twice.at_least() <= 0.2 && twice.at_most().unwrap() >= 0.4);
    /// ```
    #[must_use]
    pub fn stretched(&self, shortest: f64, longest: f64) -> Self {
        // An exact shape stays exact, and a rotation or a translation costs nothing: rounding up
        // would add a step at every node of a scene.
        let at_most = self.at_most.map(|most| match (most, longest) {
            (0.0, _) | (_, 1.0) => most,
            _ => mul_up(most, longest),
        });
        let is_out_of_range = at_most.is_some_and(|most| !most.is_finite());
        let at_least = if shortest == 1.0 { self.at_least } else { mul_down(self.at_least, shortest) };
        // A lower bound that overflows bounds nothing.
        let at_least = if at_least.is_finite() { greater(at_least, 0.0) } else { 0.0 };
        Self {
            at_least,
            at_most: at_most.filter(|_| !is_out_of_range),
            evidence: if is_out_of_range { Evidence::Estimated } else { self.evidence.clone() },
            at: None,
            pixels: None,
            angle_deg: None,
            open: None,
            ..self.clone()
        }
    }

    /// The bound after points of the result moved by at most `distance`. It holds for [`Metric::Solid`] too:
    /// the moved surface lies within the sum of both lengths of the true shape's and the operands' surfaces;
    /// farther away no side changes.
    ///
    /// ```
    /// use chordal::budget::{Bound, Reference};
    /// let moved = Bound::proved(0.1, 0.2, Reference::Field).moved_by(0.05);
    /// assert!(moved.at_least() <= 0.05 && moved.at_most().unwrap() >= 0.25);
    /// ```
    #[must_use]
    pub fn moved_by(&self, distance: f64) -> Self {
        if distance == 0.0 {
            return self.clone();
        }
        // An exact result is off by the distance itself; the rounded sum would be more.
        let most = self.at_most.map(|most| if most == 0.0 { distance } else { add_up(most, distance) });
        let is_known = most.is_none_or(f64::is_finite);
        let least = sub_down(self.at_least, distance);
        Self {
            at_least: greater(least, 0.0),
            at_most: most.filter(|_| is_known),
            evidence: if is_known { self.evidence.clone() } else { Evidence::Estimated },
            pixels: None,
            angle_deg: None,
            ..self.clone()
        }
    }

    /// The part of this step's lower bound, in `metric`, that remains after the step `other`.
    fn remaining_lower_bound(&self, other: &Self, metric: Metric) -> f64 {
        // The triangle inequality: the other step takes back no more than it moves. That needs a
        // bound for the points of both surfaces, in the same metric.
        match other.at_most {
            Some(most)
                if self.metric == metric && !matches!(other.metric, Metric::OneSided | Metric::Solid) =>
            {
                let remaining = sub_down(self.at_least, most);
                greater(remaining, 0.0)
            }
            _ => 0.0,
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.at_most {
            Some(most) => {
                write!(f, "between {:.3e} and {:.3e} ({})", self.at_least, most, self.evidence.as_str())
            }
            None if matches!(self.evidence, Evidence::Measured { .. }) => {
                write!(f, "{:.3e} at the farthest point looked at (measured)", self.at_least)
            }
            None => write!(f, "at least {:.3e} ({})", self.at_least, self.evidence.as_str()),
        }
    }
}
