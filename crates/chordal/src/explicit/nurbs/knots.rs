//! `KnotVector`: the parameters at which the pieces of a spline meet.
use super::BernsteinRow;
use std::fmt;

/// The knots of a B-spline and its degree.
///
/// `n` control points of degree `p` have `n + p + 1` knots, which do not decrease. The curve runs from knot
/// `p` to knot `n`. A knot that occurs `m` times leaves `p − m` continuous derivatives there.
///
/// ```
/// use chordal::explicit::nurbs::KnotVector;
/// let knots = KnotVector::clamped(3, 5)?;
/// assert_eq!(knots.knots(), [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0, 2.0]);
/// assert_eq!((knots.n_control(), knots.domain()), (5, [0.0, 2.0]));
/// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct KnotVector {
    degree: usize,
    knots: Vec<f64>,
    /// For each piece, the index of the knot at its start; pieces of length 0 are left out.
    spans: Vec<usize>,
}

/// The highest degree. Chosen: CAD systems stop at 25 or earlier; control points of higher degrees tell
/// little about a curve, and their binomial coefficients lose digits.
const MOST: usize = 30;
/// The largest knot. Chosen: far beyond any use; differences of knots near the largest number overflow, and
/// quotients by them lose all digits.
const FARTHEST: f64 = 1e150;

impl KnotVector {
    /// The knots of a spline of a degree.
    ///
    /// # Errors
    /// When the degree is 0 or beyond 30, a number is not finite, knots decrease or repeat more often than
    /// the degree (once more at the ends), or there are too few.
    pub fn new(degree: usize, knots: Vec<f64>) -> Result<Self, InvalidNurbs> {
        if degree == 0 || degree > MOST {
            return Err(InvalidNurbs::Degree(degree));
        }
        if let Some(index) = knots.iter().position(|x| !x.is_finite()) {
            return Err(InvalidNurbs::NotFinite { what: "knot", index });
        }
        if let Some(index) = knots.iter().position(|x| x.abs() > FARTHEST) {
            return Err(InvalidNurbs::Far(index));
        }
        if knots.len() < 2 * (degree + 1) {
            return Err(InvalidNurbs::TooFewKnots { degree, knots: knots.len() });
        }
        if let Some(before) = knots.windows(2).position(|pair| pair[0] > pair[1]) {
            return Err(InvalidNurbs::Decreasing(before + 1));
        }
        let n_control = knots.len() - degree - 1;
        let spans: Vec<usize> = (degree..n_control).filter(|k| knots[*k] < knots[k + 1]).collect();
        if spans.is_empty() {
            return Err(InvalidNurbs::NoLength);
        }
        let [from, to] = [knots[degree], knots[n_control]];
        // Two more than the degree: a control point would have no influence.
        if let Some(index) = (0..n_control).find(|k| knots[*k] == knots[k + degree + 1]) {
            return Err(InvalidNurbs::RepeatedEnd { index, degree });
        }
        // One more than the degree: the curve would jump.
        let too_often = |k: usize| knots[k] == knots[k + degree] && knots[k] > from && knots[k] < to;
        if let Some(index) = (0..knots.len() - degree).find(|k| too_often(*k)) {
            return Err(InvalidNurbs::Repeated { index, degree });
        }
        Ok(Self { degree, knots, spans })
    }

    /// Clamped uniform knots for this many control points: the curve starts and ends at the first and the
    /// last point.
    ///
    /// # Errors
    /// When there are not more control points than the degree, or the degree is 0 or beyond 30.
    pub fn clamped(degree: usize, n_control: usize) -> Result<Self, InvalidNurbs> {
        if n_control <= degree {
            return Err(InvalidNurbs::TooFew { degree, points: n_control });
        }
        let inner = n_control - degree;
        let knot = |k: usize| k.saturating_sub(degree).min(inner) as f64;
        Self::new(degree, (0..n_control + degree + 1).map(knot).collect())
    }

    /// Integer knots for this many control points, continued outside the domain: the curve runs from 0 to the
    /// number of its pieces, and does not start and end at its first and last point.
    ///
    /// # Errors
    /// When there are not more control points than the degree, or the degree is 0 or beyond 30.
    pub fn uniform(degree: usize, n_control: usize) -> Result<Self, InvalidNurbs> {
        if n_control <= degree {
            return Err(InvalidNurbs::TooFew { degree, points: n_control });
        }
        let before = degree.min(MOST + 1) as f64;
        Self::new(degree, (0..n_control + degree + 1).map(|k| k as f64 - before).collect())
    }

    /// The number of times that a number occurs among the knots.
    #[must_use]
    pub fn multiplicity(&self, t: f64) -> usize {
        self.knots.partition_point(|knot| *knot <= t) - self.knots.partition_point(|knot| *knot < t)
    }

    /// The degree of the pieces.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// All knots, with repetitions.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The number of control points.
    #[must_use]
    pub fn n_control(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// The number of pieces.
    #[must_use]
    pub fn n_pieces(&self) -> usize {
        self.spans.len()
    }

    /// The parameters at the start and at the end of the spline.
    #[must_use]
    pub fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.n_control()]]
    }

    /// The parameters at the start and at the end of a piece.
    #[must_use]
    pub fn piece(&self, piece: usize) -> [f64; 2] {
        let k = self.spans[piece];
        [self.knots[k], self.knots[k + 1]]
    }

    /// Whether the spline starts at its first control point, and ends at its last.
    pub(super) fn clamped_ends(&self) -> [bool; 2] {
        let (p, n) = (self.degree, self.n_control());
        // If the end knot has more repetitions, a later control point is the first one, or an earlier one the
        // last.
        let [first, last] = [self.spans[0], self.spans[self.spans.len() - 1]];
        [
            self.knots[1] == self.knots[p] && first == p,
            self.knots[n] == self.knots[n + p - 1] && last + 1 == n,
        ]
    }

    /// The piece at a parameter, and the position in it from 0 to 1; outside the domain, those of the nearer
    /// end.
    #[must_use]
    pub fn locate(&self, t: f64) -> (usize, f64) {
        let after = self.spans.partition_point(|k| self.knots[*k] <= t);
        let piece = after.saturating_sub(1);
        let [a, b] = self.piece(piece);
        let at = (t - a) / (b - a);
        (piece, if at > 0.0 { crate::math::lesser(at, 1.0) } else { 0.0 })
    }

    /// The parameter at a position from 0 to 1 in a piece.
    #[must_use]
    pub(crate) fn parameter(&self, piece: usize, at: f64) -> f64 {
        let [a, b] = self.piece(piece);
        // Exact at both ends, and never beyond them.
        crate::math::lesser(crate::math::greater((1.0 - at) * a + at * b, a), b)
    }

    /// The index of the knot before a piece, which is also that of the last control point that the piece
    /// depends on.
    pub(super) fn span(&self, piece: usize) -> usize {
        self.spans[piece]
    }

    /// The blossom of a piece: de Boor's algorithm with a separate parameter in each step, all within the
    /// piece. All steps are weighted means.
    pub(super) fn blossom<const N: usize>(
        &self,
        span: usize,
        control: &[[f64; N]],
        at: impl Fn(usize) -> f64,
    ) -> [f64; N] {
        let p = self.degree;
        let mut row = control[span - p..=span].to_vec();
        for r in 1..=p {
            let t = at(r - 1);
            for i in (r..=p).rev() {
                let (low, high) = (self.knots[span - p + i], self.knots[span + 1 + i - r]);
                // Both are computed separately: 1 − share would lose digits if weights balance a small share.
                let (second_share, first_share) = ((t - low) / (high - low), (high - t) / (high - low));
                row[i] = std::array::from_fn(|k| first_share * row[i - 1][k] + second_share * row[i][k]);
            }
        }
        row[p]
    }

    /// The control points of all pieces in Bernstein form; each piece begins with the last point of the
    /// previous one.
    pub(crate) fn to_bezier<const N: usize>(&self, control: &[[f64; N]]) -> Vec<[f64; N]> {
        let p = self.degree;
        let mut points = Vec::with_capacity(self.spans.len() * p + 1);
        for (piece, span) in self.spans.iter().enumerate() {
            let [a, b] = self.piece(piece);
            for j in usize::from(piece > 0)..=p {
                points.push(self.blossom(*span, control, |k| if k < j { b } else { a }));
            }
        }
        points
    }

    /// The coefficients of one piece in Bernstein form.
    pub(super) fn piece_row<const N: usize>(&self, control: &[[f64; N]], piece: usize) -> BernsteinRow<N> {
        let [a, b] = self.piece(piece);
        let at = |j: usize| self.blossom(self.spans[piece], control, |k| if k < j { b } else { a });
        BernsteinRow((0..=self.degree).map(at).collect())
    }
}

/// The reason why numbers do not describe a spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InvalidNurbs {
    /// The degree is 0 or beyond 30.
    Degree(usize),
    /// A knot, a control point or a weight is NaN or infinite.
    NotFinite {
        /// The kind of number.
        what: &'static str,
        /// Its index.
        index: usize,
    },
    /// The knot with this index is beyond 1e150.
    Far(usize),
    /// There are fewer than 2(p + 1) knots.
    TooFewKnots {
        /// The degree.
        degree: usize,
        /// The number of knots.
        knots: usize,
    },
    /// There are not more control points than the degree.
    TooFew {
        /// The degree.
        degree: usize,
        /// The number of control points.
        points: usize,
    },
    /// The knot with this index is less than the one before.
    Decreasing(usize),
    /// A knot in the middle occurs more often than the degree, and the curve would jump there.
    Repeated {
        /// The index of the first of them.
        index: usize,
        /// The degree.
        degree: usize,
    },
    /// A knot occurs more often than once more than the degree, even for an end.
    RepeatedEnd {
        /// The index of the first of them.
        index: usize,
        /// The degree.
        degree: usize,
    },
    /// The first and the last parameter are equal.
    NoLength,
    /// The number of control points or weights does not match the knots.
    Count {
        /// The kind of items.
        what: &'static str,
        /// The actual number.
        found: usize,
        /// The required number.
        needed: usize,
    },
    /// The weight with this index is 0 or less.
    Weight(usize),
    /// Two curves that must have the same knots have different ones.
    Knots,
    /// The radius of this control point of a profile is negative.
    Radius(usize),
    /// A parameter is not inside the domain.
    Outside {
        /// The parameter.
        t: f64,
        /// The domain.
        domain: [f64; 2],
    },
    /// A part or a domain does not start before it ends.
    Backwards {
        /// The start.
        from: f64,
        /// The end.
        to: f64,
    },
    /// There is no knot at this parameter inside the domain.
    NoKnot(f64),
    /// Without the knot the curve would be too far away.
    Moved {
        /// An upper bound of the distance.
        by: f64,
        /// The tolerance.
        limit: f64,
    },
    /// This point and the next are equal, and so would be their parameters.
    Coincident(usize),
    /// A path of a single point has no piece.
    SinglePoint,
    /// An arc has no sweep, or more than a full turn.
    Sweep(f64),
    /// The parameters around this point are too uneven: rounding destroys its control point.
    Uneven(usize),
    /// This section of a loft and the next are equal, and so would be their parameters.
    SameSections(usize),
    /// A closed loft has an even degree, which leaves the spline through its sections undefined.
    EvenDegree(usize),
    /// More sections than a closed loft may have.
    ManySections {
        /// The actual number.
        found: usize,
        /// The largest allowed number.
        most: usize,
    },
    /// The weights of sections differ so much that one between them would not be above 0.
    SwungWeight {
        /// The index of the control point within its section.
        column: usize,
        /// The weight.
        weight: f64,
    },
    /// Two boundary curves of a patch do not meet in a corner.
    Corner {
        /// The corner: 0 where both parameters start, 1 where `u` ends, 2 where `v` ends, 3 where both end.
        corner: usize,
        /// The distance between the ends of the two curves.
        gap: f64,
        /// The largest allowed distance.
        limit: f64,
    },
}

impl fmt::Display for InvalidNurbs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Degree(degree) => write!(f, "the degree is {degree}, and must be from 1 to {MOST}"),
            Self::NotFinite { what, index } => write!(f, "{what} {index} is not a finite number"),
            Self::Far(index) => write!(f, "knot {index} is beyond {FARTHEST:e}"),
            Self::TooFewKnots { degree, knots } => {
                write!(f, "degree {degree} needs {} knots at least, and there are {knots}", 2 * (degree + 1))
            }
            Self::TooFew { degree, points } => {
                write!(
                    f,
                    "degree {degree} needs {} control points at least, and there are {points}",
                    degree + 1
                )
            }
            Self::Decreasing(index) => write!(f, "knot {index} is less than the one before"),
            Self::Repeated { index, degree } => write!(
                f,
                "knot {index} occurs more often than the degree {degree}, so that the curve would jump there: split it in two"
            ),
            Self::RepeatedEnd { index, degree } => write!(
                f,
                "knot {index} occurs more than {} times, which is as often as degree {degree} allows at an end",
                degree + 1
            ),
            Self::NoLength => {
                f.write_str("the knots have no length: the first and the last parameter are equal")
            }
            Self::Count { what, found, needed } => write!(f, "{found} {what} where the knots need {needed}"),
            Self::Knots => f.write_str("the two curves have different degrees or knots"),
            Self::Radius(index) => write!(f, "the radius of control point {index} is negative"),
            Self::Outside { t, domain: [a, b] } => {
                write!(f, "the parameter {t} is not inside of the domain from {a} to {b}")
            }
            Self::Backwards { from, to } => {
                write!(f, "a part from {from} to {to} has no length: it must start before it ends")
            }
            Self::NoKnot(t) => write!(f, "there is no knot {t} inside of the domain"),
            Self::Moved { by, limit } => {
                write!(f, "without the knot the curve may be off by {by:e}, and the tolerance is {limit:e}")
            }
            Self::Coincident(index) => {
                write!(f, "point {index} and the next one are equal, so that their parameters would be too")
            }
            Self::Sweep(sweep_rad) => {
                write!(f, "the sweep of the arc is {sweep_rad}, and must be from −2π to 2π and not 0")
            }
            Self::Uneven(index) => {
                write!(f, "the parameters around point {index} are too uneven to solve for its control point")
            }
            Self::SameSections(index) => {
                write!(f, "section {index} and the next one are equal, so that their parameters would be too")
            }
            Self::EvenDegree(degree) => {
                write!(f, "a closed loft needs an odd degree across its sections, and {degree} is even")
            }
            Self::ManySections { found, most } => {
                write!(f, "a closed loft takes up to {most} sections, and there are {found}")
            }
            Self::SwungWeight { column, weight } => write!(
                f,
                "the weights of control point {column} differ so much between sections that one between them would be {weight:e}: \
                 weights must stay above 0"
            ),
            Self::Corner { corner, gap, limit } => {
                let at = [
                    "the start of both",
                    "the end of u and the start of v",
                    "the start of u and the end of v",
                ];
                let at = at.get(*corner).unwrap_or(&"the end of both");
                write!(
                    f,
                    "the boundary curves do not meet at {at}: they are {gap:e} apart, and may be {limit:e}"
                )
            }
            Self::SinglePoint => f.write_str("the path is a single point, without a piece"),
            Self::Weight(index) => write!(f, "weight {index} is not above 0"),
        }
    }
}

impl std::error::Error for InvalidNurbs {}
