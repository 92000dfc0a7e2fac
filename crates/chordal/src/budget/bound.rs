//! `Bound`: an enclosure of what was lost, against which truth, in which metric, and how it is known.
use crate::math::{add_up, sub_down};
use std::fmt;

/// How a bound is known, strongest first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Evidence {
    /// Mathematics covers every case that the code can reach, rounding included.
    Proved,
    /// Proved under what the user promised: each assumption in a sentence.
    ProvedIf(Vec<String>),
    /// Sampled: a bound from below only.
    Measured {
        /// How many samples were taken.
        samples: u64,
    },
    /// Neither proved nor sampled.
    Estimated,
}

impl Evidence {
    /// The evidence for a chain of two steps: the weaker one; assumptions add up, sample counts take the smaller.
    #[must_use]
    pub fn weaker(&self, other: &Self) -> Self {
        match (self, other) {
            (Self::ProvedIf(a), Self::ProvedIf(b)) => {
                let mut all = a.clone();
                all.extend(b.iter().filter(|sentence| !a.contains(sentence)).cloned());
                Self::ProvedIf(all)
            }
            (Self::Measured { samples: a }, Self::Measured { samples: b }) => {
                Self::Measured { samples: *a.min(b) }
            }
            (a, b) => a.max(b).clone(),
        }
    }

    /// Whether the evidence gives a bound from above.
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

/// What the length of a bound measures between the true shape and the one that was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// The larger of the two one-sided Hausdorff distances.
    Hausdorff,
    /// Between points of equal parameter; never smaller than the Hausdorff distance.
    Parametric,
    /// From the true shape to the made one only.
    OneSided,
}

impl Metric {
    /// The name in a report.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Hausdorff => "hausdorff",
            Self::Parametric => "parametric",
            Self::OneSided => "one-sided",
        }
    }

    fn weaker(self, other: Self) -> Self {
        match (self, other) {
            (Self::OneSided, _) | (_, Self::OneSided) => Self::OneSided,
            (Self::Parametric, Self::Parametric) => Self::Parametric,
            _ => Self::Hausdorff,
        }
    }
}

/// The true shape that a bound is against: the parsed f64 data, taken exactly.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reference {
    /// Paths of lines, cubic Bézier curves and arcs.
    Curves,
    /// Bicubic Bézier patches.
    BezierPatches,
    /// The surface that refining a cage converges to.
    LimitSurface,
    /// The triangles of the input.
    InputTriangles,
    /// The boundary of where a field is negative.
    Field,
    /// The level surface of the trilinear interpolant of a volume's samples.
    Trilinear,
}

impl Reference {
    /// The name in a report.
    #[must_use]
    pub fn as_str(&self) -> &'static str {
        match self {
            Self::Curves => "curves",
            Self::BezierPatches => "bezier patches",
            Self::LimitSurface => "limit surface",
            Self::InputTriangles => "input triangles",
            Self::Field => "field",
            Self::Trilinear => "trilinear interpolant",
        }
    }
}

/// An enclosure of the distance between the true shape and the one that was made.
///
/// By construction `0 ≤ at_least ≤ at_most`, and `at_most` is there exactly when the evidence bounds from above.
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
    /// What is measured.
    pub metric: Metric,
    /// Where the loss is worst, as far as is known.
    pub at: Option<[f64; 3]>,
    /// The largest distance on the screen in pixels, where a view was given and the evidence bounds from above.
    pub pixels: Option<f64>,
    /// The largest angle that was found between a triangle's normal and the shape's at its corners and in its middle, in degrees, where an
    /// angle was asked for. It is measured, whatever the evidence of the distance.
    pub angle_deg: Option<f64>,
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
    /// When not `0 ≤ at_least ≤ at_most < ∞`: the caller's proof is broken.
    #[must_use]
    pub fn proved(at_least: f64, at_most: f64, reference: Reference) -> Self {
        Self::with_evidence(at_least, Some(at_most), Evidence::Proved, reference)
    }

    /// A bound of any evidence.
    ///
    /// # Panics
    /// When `at_most` is missing although the evidence bounds from above, or is there although it does not, or
    /// when not `0 ≤ at_least ≤ at_most < ∞`.
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
        }
    }

    /// The distance is at least this.
    #[must_use]
    pub fn at_least(&self) -> f64 {
        self.at_least
    }

    /// The distance is at most this, where that is proved.
    #[must_use]
    pub fn at_most(&self) -> Option<f64> {
        self.at_most
    }

    /// How it is known.
    #[must_use]
    pub fn evidence(&self) -> &Evidence {
        &self.evidence
    }

    /// The bound for true shape → A → B from those for true shape → A (`self`) and A → B (`next`).
    ///
    /// Upper ends add, rounded up, and the weaker evidence wins; where the sum overflows nothing is bounded and the
    /// evidence is [`Evidence::Estimated`]. The lower end is what the triangle inequality leaves: `at_least` of one
    /// step minus `at_most` of the other. That step must speak the metric of the result (a parametric distance of at
    /// least 1 does not keep the shapes 1 apart), and the other must bound both directions. Pixels do not add here:
    /// they belong to a view and the caller converts the length again; nor do angles.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        let metric = self.metric.weaker(next.metric);
        let evidence = self.evidence.weaker(&next.evidence);
        // Nothing added to a length leaves it, exactly.
        let sum = self
            .at_most
            .zip(next.at_most)
            .map(|(a, b)| if a == 0.0 || b == 0.0 { a + b } else { add_up(a, b) });
        let (at_most, evidence) = match sum {
            Some(infinite) if !infinite.is_finite() => (None, Evidence::Estimated),
            sum => (sum, evidence),
        };
        let (first, second) = (self.left_by(next, metric), next.left_by(self, metric));
        let at = if self.at_most >= next.at_most { self.at.or(next.at) } else { next.at.or(self.at) };
        Self {
            at_least: if first > second { first } else { second },
            at_most,
            evidence,
            reference: self.reference.clone(),
            metric,
            at,
            pixels: None,
            angle_deg: None,
        }
    }

    /// What the step `other` cannot take back of this one's lower end, in `metric`.
    fn left_by(&self, other: &Self, metric: Metric) -> f64 {
        match other.at_most {
            Some(most) if self.metric == metric && other.metric != Metric::OneSided => {
                let left = sub_down(self.at_least, most);
                if left > 0.0 { left } else { 0.0 }
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
            None => write!(f, "at least {:.3e} ({})", self.at_least, self.evidence.as_str()),
        }
    }
}
