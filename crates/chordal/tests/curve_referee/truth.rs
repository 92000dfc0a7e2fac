//! Paths as the referee knows them: control points, centres and angles, evaluated by its own arithmetic.
use super::double::Double;
use chordal::Bezier;
use chordal::explicit::{Arc, Curve, CurveSegment};

/// The control points of a cubic.
pub type Control<const D: usize> = [[f64; D]; 4];

/// One piece.
#[derive(Clone, Copy, Debug)]
pub enum Part<const D: usize> {
    Line([[f64; D]; 2]),
    Cubic(Control<D>),
    Arc(Round<D>),
}

/// An arc: centre, axes, first angle and the angle to the end.
#[derive(Clone, Copy, Debug)]
pub struct Round<const D: usize> {
    pub centre: [f64; D],
    pub axes: [[f64; D]; 2],
    pub start: f64,
    pub sweep: f64,
    /// The ends that it has been given; it is then known only as well as they fit.
    pub ends: Option<[[f64; D]; 2]>,
}

/// Pieces one after the other.
#[derive(Clone, Debug)]
pub struct Path<const D: usize> {
    pub parts: Vec<Part<D>>,
    pub closed: bool,
}

fn between<const D: usize>(a: [f64; D], b: [f64; D], t: f64) -> [f64; D] {
    std::array::from_fn(|k| a[k] + t * (b[k] - a[k]))
}

impl<const D: usize> Round<D> {
    fn at(&self, t: f64) -> [f64; D] {
        let (sin, cos) = (self.start + t * self.sweep).sin_cos();
        std::array::from_fn(|k| self.centre[k] + (cos * self.axes[0][k] + sin * self.axes[1][k]))
    }
}

impl<const D: usize> Part<D> {
    pub fn at(&self, t: f64) -> [f64; D] {
        match self {
            Self::Line([a, b]) => between(*a, *b, t),
            Self::Cubic([a, b, c, d]) => {
                let [ab, bc, cd] = [between(*a, *b, t), between(*b, *c, t), between(*c, *d, t)];
                between(between(ab, bc, t), between(bc, cd, t), t)
            }
            Self::Arc(round) => round.at(t),
        }
    }

    /// The point with twice the digits; of an arc only as good as sine and cosine.
    pub fn precisely_at(&self, t: f64) -> [Double; D] {
        let wide = |p: [f64; D]| p.map(Double::from);
        let between = |a: [Double; D], b: [Double; D]| -> [Double; D] {
            std::array::from_fn(|k| a[k].plus(b[k].minus(a[k]).times(t.into())))
        };
        match self {
            Self::Line([a, b]) => between(wide(*a), wide(*b)),
            Self::Cubic(control) => {
                let [a, b, c, d] = control.map(wide);
                let [ab, bc, cd] = [between(a, b), between(b, c), between(c, d)];
                between(between(ab, bc), between(bc, cd))
            }
            Self::Arc(round) => wide(round.at(t)),
        }
    }

    pub fn ends(&self) -> [[f64; D]; 2] {
        match self {
            Self::Line(ends) => *ends,
            Self::Cubic([a, _, _, d]) => [*a, *d],
            Self::Arc(round) => round.ends.unwrap_or([round.at(0.0), round.at(1.0)]),
        }
    }

    /// Points whose box holds the piece.
    fn corners(&self) -> Vec<[f64; D]> {
        match self {
            Self::Line(ends) => ends.to_vec(),
            Self::Cubic(control) => control.to_vec(),
            Self::Arc(round) => {
                let reach =
                    |k: usize| (round.axes[0][k].powi(2) + round.axes[1][k].powi(2)).sqrt() * 1.000_001;
                [-1.0, 1.0].map(|side| std::array::from_fn(|k| round.centre[k] + side * reach(k))).to_vec()
            }
        }
    }

    fn library(&self) -> CurveSegment<D> {
        match self {
            Self::Line(ends) => CurveSegment::Line(*ends),
            Self::Cubic(control) => CurveSegment::Cubic(Bezier { control: *control }),
            Self::Arc(round) => {
                let arc = Arc::new(round.centre, round.axes, round.start, round.sweep).expect("an arc");
                CurveSegment::Arc(round.ends.map_or(arc, |ends| arc.with_ends(ends)))
            }
        }
    }
}

impl<const D: usize> Path<D> {
    pub fn cubic(control: Control<D>) -> Self {
        Self { parts: vec![Part::Cubic(control)], closed: false }
    }

    pub fn arc(round: Round<D>) -> Self {
        Self { parts: vec![Part::Arc(round)], closed: false }
    }

    /// The path as the library has it.
    pub fn library(&self) -> Curve<D> {
        Curve::new(self.parts.iter().map(Part::library).collect(), self.closed.into()).expect("a path")
    }

    /// The lowest and highest coordinates.
    pub fn bounds(&self) -> [[f64; D]; 2] {
        let corners: Vec<_> = self.parts.iter().flat_map(Part::corners).collect();
        [f64::min, f64::max]
            .map(|pick| std::array::from_fn(|k| corners.iter().map(|p| p[k]).reduce(pick).expect("a piece")))
    }

    /// The diagonal of the box.
    pub fn size(&self) -> f64 {
        let [low, high] = self.bounds();
        let most = (0..D).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        if most == 0.0 {
            return 0.0;
        }
        // Scaled, so that no square leaves the range of numbers.
        most * (0..D).map(|k| ((high[k] - low[k]) / most).powi(2)).sum::<f64>().sqrt()
    }

    /// The referee's own rounding where it does not count with twice the digits: some thirty operations on
    /// coordinates of this size.
    pub fn slack(&self) -> f64 {
        let most = self.bounds().as_flattened().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let most = self.parts.iter().fold(most, |most, part| match part {
            Part::Arc(round) => round.centre.iter().fold(most, |most, x| most.max(x.abs())),
            _ => most,
        });
        64.0 * f64::EPSILON * most
    }
}
