//! Conversion of paths to one spline.
use super::knots::InvalidNurbs;
use super::{KnotVector, NurbsCurve};
use crate::explicit::{Curve, CurveSegment};

impl<const D: usize> NurbsCurve<D> {
    /// A path as one curve of the highest degree among its pieces. At the joins the knots are integers,
    /// repeated as often as the degree. So the position of a point on the path ([`Curve::at`]) is its
    /// parameter, except inside arcs, which are rational here.
    ///
    /// Rounding is that of [`NurbsCurve::elevated`] for pieces of lower degree and of [`NurbsCurve::arc`] for
    /// arcs; cubics among cubics keep their control points. [`Curve::slack`] is not carried over: the curve
    /// has no slack of its own. If pieces meet smoothly, [`NurbsCurve::without_spare_knots`] shortens the
    /// result.
    ///
    /// # Errors
    /// When the path is a single point, or a weight overflows.
    ///
    /// ```
    /// use chordal::explicit::{nurbs::NurbsCurve, spline};
    /// let path = spline::natural(&[[0.0, 0.0], [1.0, 2.0], [3.0, 1.0], [4.0, 4.0]])?;
    /// let curve = NurbsCurve::from_path(&path)?;
    /// assert_eq!((curve.knots().degree(), curve.at(1.5)), (3, path.at(1.5)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_path(path: &Curve<D>) -> Result<Self, InvalidNurbs> {
        let pieces: Vec<Self> = path.segments().iter().map(one_piece).collect::<Result<_, _>>()?;
        let degree = pieces.iter().fold(0, |highest, piece| piece.knots().degree().max(highest));
        let Some(first) = pieces.first() else { return Err(InvalidNurbs::SinglePoint) };
        let start = first.knots().domain()[0];
        let (mut knots, mut control, mut weights) = (vec![start; degree + 1], Vec::new(), Vec::new());
        for (index, piece) in pieces.iter().enumerate() {
            let piece = piece.elevated(degree - piece.knots().degree())?;
            let [from, to] = piece.knots().domain();
            // Maps the domain of the piece to 0 … 1; integers are exact.
            let at = |t: f64| index as f64 + (t - from) / (to - from);
            let piece_knots = piece.knots().knots();
            knots.extend(piece_knots[degree + 1..piece_knots.len() - 1].iter().map(|t| at(*t)));
            // The weights of a piece matter only up to a factor, which makes those at the join equal.
            let factor = weights.last().map_or(1.0, |last| last / piece.weights()[0]);
            let skipped = usize::from(index > 0);
            control.extend(&piece.control()[skipped..]);
            weights.extend(piece.weights()[skipped..].iter().map(|w| w * factor));
        }
        knots.push(knots[knots.len() - 1]);
        Self::new(KnotVector::new(degree, knots)?, control, weights)
    }
}

impl<const D: usize> TryFrom<&Curve<D>> for NurbsCurve<D> {
    type Error = InvalidNurbs;

    /// [`NurbsCurve::from_path`].
    fn try_from(path: &Curve<D>) -> Result<Self, InvalidNurbs> {
        Self::from_path(path)
    }
}

fn one_piece<const D: usize>(piece: &CurveSegment<D>) -> Result<NurbsCurve<D>, InvalidNurbs> {
    match piece {
        CurveSegment::Line(ends) => NurbsCurve::bezier(ends.to_vec()),
        CurveSegment::Cubic(cubic) => NurbsCurve::bezier(cubic.control.to_vec()),
        CurveSegment::Arc(arc) if arc.sweep_rad() == 0.0 => NurbsCurve::bezier(arc.ends().to_vec()),
        CurveSegment::Arc(arc) => {
            let spline = NurbsCurve::arc(arc.centre(), arc.axes(), arc.start_rad(), arc.sweep_rad())?;
            // Its ends are those of the path's piece, so that it meets its neighbours.
            let (mut control, last) = (spline.control().to_vec(), spline.control().len() - 1);
            [control[0], control[last]] = arc.ends();
            NurbsCurve::new(spline.knots().clone(), control, spline.weights().to_vec())
        }
        CurveSegment::Rational(curve) => {
            let (mut control, last) = (curve.control(), curve.degree());
            [control[0], control[last]] = curve.ends();
            NurbsCurve::new(KnotVector::clamped(last, last + 1)?, control, curve.control_weights())
        }
    }
}
