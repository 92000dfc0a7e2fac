//! `Curve`: a path, an open or closed chain of smooth pieces.
use super::{AffineMap, CurveSegment};
use crate::math::{add_up, greater, lesser, mul_up};
use std::fmt;

/// A path in `D` dimensions: smooth pieces, each of which starts, bit for bit, where the previous one ends.
///
/// A closed path ends where it starts. A path may be a single point, without a piece.
///
/// ```
/// use chordal::explicit::{Bezier, Curve, CurveEnds, CurveSegment};
/// let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
/// let back = CurveSegment::Line([[1.0, 0.0], [0.0, 0.0]]);
/// let path = Curve::new(vec![CurveSegment::Cubic(arch), back], CurveEnds::Closed)?;
/// assert_eq!(path.at(0.5), [0.5, 0.75]); // half-way through the first piece
/// assert_eq!(path.at(1.5), [0.5, 0.0]); // half-way through the second
/// # Ok::<(), chordal::explicit::InvalidCurve>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Curve<const D: usize> {
    start: [f64; D],
    segments: Vec<CurveSegment<D>>,
    closed: bool,
    slack: f64,
}

/// Whether a path returns to its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveEnds {
    /// It ends where its last piece ends.
    Open,
    /// Its last piece ends where its first one starts.
    Closed,
}

impl From<bool> for CurveEnds {
    /// Closed if the condition holds.
    fn from(is_closed: bool) -> Self {
        if is_closed { Self::Closed } else { Self::Open }
    }
}

impl<const D: usize> Curve<D> {
    /// A path of at least one piece.
    ///
    /// # Errors
    /// When there is no piece, a number is not finite, a piece does not start where the previous one ends, or
    /// a closed path does not end where it starts.
    pub fn new(pieces: Vec<CurveSegment<D>>, ends: CurveEnds) -> Result<Self, InvalidCurve> {
        let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else {
            return Err(InvalidCurve::Empty);
        };
        if let Some(piece) = pieces.iter().position(|piece| !piece.is_finite()) {
            return Err(InvalidCurve::NotFinite { piece });
        }
        if let Some(before) = pieces.windows(2).position(|pair| pair[0].end() != pair[1].start()) {
            return Err(InvalidCurve::Gap { piece: before + 1 });
        }
        let closed = ends == CurveEnds::Closed;
        if closed && last.end() != first.start() {
            return Err(InvalidCurve::Gap { piece: 0 });
        }
        Ok(Self { start: first.start(), segments: pieces, closed, slack: 0.0 })
    }

    /// A path that is a single point.
    ///
    /// # Errors
    /// When the point is not finite.
    pub fn point(start: [f64; D]) -> Result<Self, InvalidCurve> {
        if start.iter().all(|x| x.is_finite()) {
            Ok(Self { start, segments: Vec::new(), closed: false, slack: 0.0 })
        } else {
            Err(InvalidCurve::NotFinite { piece: 0 })
        }
    }

    /// The same path with a known uncertainty: the exact path may be up to `slack` (≥ 0) away, because its
    /// numbers were rounded before. Every bound against the path includes it.
    #[must_use]
    pub fn with_slack(mut self, slack: f64) -> Self {
        self.slack = slack;
        self
    }

    /// The largest distance between the exact path and this one, caused by earlier rounding.
    #[must_use]
    pub fn slack(&self) -> f64 {
        self.slack
    }

    /// The start point.
    #[must_use]
    pub fn start(&self) -> [f64; D] {
        self.start
    }

    /// The end point.
    #[must_use]
    pub fn end(&self) -> [f64; D] {
        self.segments.last().map_or(self.start, CurveSegment::end)
    }

    /// Its pieces, in order.
    #[must_use]
    pub fn segments(&self) -> &[CurveSegment<D>] {
        &self.segments
    }

    /// Whether it is closed.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The point at `s`: its integer part is the index of the piece, its fraction the parameter on the piece.
    /// The number of pieces is the end.
    #[must_use]
    pub fn at(&self, s: f64) -> [f64; D] {
        let Some((piece, t)) = self.locate(s) else { return self.start };
        self.segments[piece].at(t)
    }

    /// The piece at `s` and the parameter there; `None` for a path that is a single point.
    #[must_use]
    pub fn locate(&self, s: f64) -> Option<(usize, f64)> {
        let last = self.segments.len().checked_sub(1)?;
        // A cast from float to integer saturates, and turns NaN into 0.
        let piece = (s as usize).min(last);
        let t = s - piece as f64;
        Some((piece, if t > 0.0 { lesser(t, 1.0) } else { 0.0 }))
    }

    /// The lowest and highest coordinates of a box that contains the path.
    #[must_use]
    pub fn bounds(&self) -> [[f64; D]; 2] {
        self.segments.iter().fold([self.start; 2], |[low, high], piece| {
            let [l, h] = piece.bounds();
            [std::array::from_fn(|k| lesser(l[k], low[k])), std::array::from_fn(|k| greater(h[k], high[k]))]
        })
    }

    /// The same path in reverse.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let pieces = self.segments.iter().rev().map(CurveSegment::reversed).collect();
        Self { start: self.end(), segments: pieces, closed: self.closed, slack: self.slack }
    }

    /// The path under an affine map. Its rounding is added to [`Curve::slack`].
    ///
    /// # Errors
    /// When a coordinate overflows.
    pub fn transformed(&self, map: &AffineMap<D>) -> Result<Self, InvalidCurve> {
        let [low, high] = self.bounds();
        let reach = low.iter().chain(&high).fold(0.0, |largest: f64, x| greater(x.abs(), largest));
        let offset = map.offset.iter().fold(0.0, |sum, x| add_up(sum, x.abs()));
        // A coordinate is a sum of D products and an offset: 2D roundings of half a step of the intermediate
        // values, which are at most stretch·√D·reach + offset; for all D coordinates. 4·D² ε covers this, and
        // twice that covers arcs.
        let through = add_up(mul_up(map.stretch(), mul_up(D as f64, reach)), offset);
        let rounding = mul_up(8.0 * (D * D) as f64 * f64::EPSILON, through);
        let slack = add_up(mul_up(map.stretch(), self.slack), rounding);
        let pieces: Vec<_> = self.segments.iter().map(|piece| piece.transformed(map)).collect();
        let start = map.point(self.start);
        if pieces.is_empty() {
            return Ok(Self { slack, ..Self::point(start)? });
        }
        if !slack.is_finite() {
            return Err(InvalidCurve::NotFinite { piece: 0 });
        }
        Ok(Self::new(pieces, self.closed.into())?.with_slack(slack))
    }
}

impl<const D: usize> From<super::Bezier<D>> for Curve<D> {
    /// The path of one piece. Its numbers are not checked here: arrows refuse numbers that are not finite.
    fn from(cubic: super::Bezier<D>) -> Self {
        Self {
            start: cubic.control[0],
            segments: vec![CurveSegment::Cubic(cubic)],
            closed: false,
            slack: 0.0,
        }
    }
}

/// The reason why pieces do not form a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InvalidCurve {
    /// There is no piece.
    Empty,
    /// A number is NaN or infinite.
    NotFinite {
        /// The index of the piece.
        piece: usize,
    },
    /// A piece does not start where the previous one ends (for the first piece: the last one of a closed
    /// path).
    Gap {
        /// The index of that piece.
        piece: usize,
    },
}

impl fmt::Display for InvalidCurve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("a path needs a piece"),
            Self::NotFinite { piece } => {
                write!(f, "piece {piece} of the path has a number that is not finite")
            }
            Self::Gap { piece } => {
                write!(f, "piece {piece} of the path does not start where the one before it ends")
            }
        }
    }
}

impl std::error::Error for InvalidCurve {}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(a: [f64; 2], b: [f64; 2]) -> CurveSegment<2> {
        CurveSegment::Line([a, b])
    }

    #[test]
    fn a_gap_is_refused_wherever_it_is() {
        let (a, b, c) = ([0.0, 0.0], [1.0, 0.0], [1.0, 1.0]);
        assert_eq!(Curve::<2>::new(vec![], CurveEnds::Open), Err(InvalidCurve::Empty));
        assert_eq!(
            Curve::new(vec![line(a, b), line(a, c)], CurveEnds::Open),
            Err(InvalidCurve::Gap { piece: 1 })
        );
        assert_eq!(
            Curve::new(vec![line(a, b), line(b, c)], CurveEnds::Closed),
            Err(InvalidCurve::Gap { piece: 0 })
        );
        assert_eq!(
            Curve::new(vec![line(a, [f64::NAN, 0.0])], CurveEnds::Open),
            Err(InvalidCurve::NotFinite { piece: 0 })
        );
        assert!(Curve::new(vec![line(a, b), line(b, a)], CurveEnds::Closed).is_ok());
    }

    #[test]
    fn a_parameter_outside_is_the_nearest_end() {
        let path =
            Curve::new(vec![line([0.0, 0.0], [1.0, 0.0]), line([1.0, 0.0], [1.0, 1.0])], CurveEnds::Open)
                .unwrap();
        for (s, point) in [
            (-1.0, [0.0, 0.0]),
            (0.25, [0.25, 0.0]),
            (1.0, [1.0, 0.0]),
            (1.5, [1.0, 0.5]),
            (2.0, [1.0, 1.0]),
            (9.0, [1.0, 1.0]),
            (f64::NAN, [0.0, 0.0]),
        ] {
            assert_eq!(path.at(s), point, "{s}");
        }
        assert_eq!(Curve::point([3.0, 4.0]).unwrap().at(0.5), [3.0, 4.0]);
    }

    #[test]
    fn a_map_takes_the_slack_along() {
        let path = Curve::new(vec![line([1.0, 0.0], [3.0, 0.0])], CurveEnds::Open).unwrap().with_slack(0.5);
        let map = AffineMap { columns: [[2.0, 0.0], [0.0, 2.0]], offset: [1.0, 1.0] };
        let moved = path.transformed(&map).unwrap();
        assert_eq!((moved.start(), moved.end()), ([3.0, 1.0], [7.0, 1.0]));
        assert!(moved.slack() >= 1.0 && moved.slack() < 1.5);
        assert_eq!(map.after(&map).point([1.0, 0.0]), [7.0, 3.0]);
    }
}
