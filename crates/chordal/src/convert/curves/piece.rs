//! `Chords`: one piece of a path split into chords, with their number, parameters and deviations.
use super::chord::{ChordDeviation, CubicChords, arc_deviation, coordinate_reach, rounding_at, whole_steps};
use super::density::{FlattenScratch, Spreadable, spread_by_density};
use super::greedy;
use super::rational_chord::{self, RationalChords};
use crate::explicit::CurveSegment;
use crate::math::greater;
use crate::math::simd::{self, Kernel};

/// A piece, with the values that are common to its deviation bounds.
pub(crate) enum Chords<'a, const D: usize> {
    /// A piece that is one point. It is not evaluated in between, since rounding would scatter the points.
    Point,
    Line,
    Cubic(CubicChords<'a, D>),
    Arc(&'a crate::explicit::Arc<D>),
    Rational(RationalChords<'a, D>),
}

impl<'a, const D: usize> Chords<'a, D> {
    pub(crate) fn new(piece: &'a CurveSegment<D>) -> Self {
        match piece {
            CurveSegment::Cubic(cubic) if cubic.is_point() => Self::Point,
            CurveSegment::Line([a, b]) if a == b => Self::Point,
            CurveSegment::Line(_) => Self::Line,
            CurveSegment::Cubic(cubic) => Self::Cubic(CubicChords::new(cubic)),
            CurveSegment::Arc(arc) => Self::Arc(arc),
            CurveSegment::Rational(curve) => Self::Rational(RationalChords::new(curve)),
        }
    }

    /// The deviation of the chord from `a` to `b`, in exact arithmetic.
    pub(crate) fn deviation(&self, a: f64, b: f64) -> ChordDeviation {
        match self {
            Self::Point | Self::Line => ChordDeviation { at_most: 0.0, fraction: 0.5 },
            Self::Cubic(chords) => chords.deviation(a, b),
            Self::Arc(arc) => arc_deviation(arc, a, b),
            Self::Rational(chords) => chords.deviation(a, b),
        }
    }

    /// The largest deviation of chords between these parameters, and its parameter.
    pub(crate) fn worst(&self, places: &[f64]) -> (f64, f64) {
        let mut work = FlattenScratch::default();
        let worst_chord = match self {
            Self::Cubic(chords) => {
                simd::dispatch(simd::isa(), WorstKernel { chords, places, work: &mut work })
            }
            Self::Rational(chords) => {
                simd::dispatch(simd::isa(), WorstKernel { chords, places, work: &mut work })
            }
            Self::Point | Self::Line | Self::Arc(_) => {
                let deviations = places.windows(2).map(|ends| self.deviation(ends[0], ends[1]).at_most);
                deviations
                    .enumerate()
                    .fold((0.0, 0), |most, (i, loss)| if loss > most.0 { (loss, i) } else { most })
            }
        };
        let (at_most, chord) = worst_chord;
        let [a, b] = [places[chord], places[chord + 1]];
        (at_most, a + self.deviation(a, b).fraction * (b - a))
    }

    /// The number of equal steps that keeps the tolerance (Wang's formula), as a float: it may be huge.
    pub(crate) fn even_steps(&self, tolerance: f64) -> f64 {
        let steps = match self {
            Self::Point | Self::Line => return 1.0,
            Self::Cubic(chords) => return chords.even_steps(tolerance),
            Self::Rational(chords) => return chords.even_steps(tolerance),
            // sup |P''|/(8 N²), and no chord over more than half a turn.
            Self::Arc(arc) => {
                let [u, v] = arc.axes().map(|axis| axis.iter().fold(0.0, |sum, x| sum + x * x));
                let by_size = arc.sweep_rad().abs() * ((u + v).sqrt() / (8.0 * tolerance)).sqrt();
                let by_turn = arc.sweep_rad().abs() / 3.0;
                greater(by_size, by_turn)
            }
        };
        whole_steps(steps)
    }

    /// Parameters from 0 to 1, both included, with chords of at most `tolerance`, and nearly as few as
    /// possible.
    pub(crate) fn fewest(&self, tolerance: f64) -> Vec<f64> {
        let mut work = FlattenScratch::default();
        let is_spread = match self {
            Self::Cubic(chords) => {
                simd::dispatch(simd::isa(), SpreadKernel { chords, tolerance, work: &mut work })
            }
            Self::Rational(chords) => {
                simd::dispatch(simd::isa(), SpreadKernel { chords, tolerance, work: &mut work })
            }
            Self::Point | Self::Line | Self::Arc(_) => false,
        };
        if is_spread { work.places().to_vec() } else { self.greedy(tolerance) }
    }

    /// The greedy way: one chord after the other, each as long as possible.
    pub(crate) fn greedy(&self, tolerance: f64) -> Vec<f64> {
        // A little less than the formula allows, for the rounding of the formula.
        let sure = 0.999 / self.even_steps(tolerance);
        greedy::parameters(|a, b| self.deviation(a, b).at_most, sure, tolerance)
    }

    /// The fewest segments that have a finite bound.
    pub(crate) fn coarsest(&self) -> Vec<f64> {
        match self {
            Self::Point | Self::Line | Self::Cubic(_) | Self::Rational(_) => vec![0.0, 1.0],
            // No chord over more than half a turn; a full turn in two would be flat.
            Self::Arc(arc) => self.even(if arc.sweep_rad().abs() > 3.0 { 3 } else { 1 }),
        }
    }

    /// Parameters of `n` equal steps.
    pub(crate) fn even(&self, n: u64) -> Vec<f64> {
        let n = if matches!(self, Self::Point) { 1 } else { n };
        (0..=n).map(|i| i as f64 / n as f64).collect()
    }
}

struct SpreadKernel<'a, const D: usize, P> {
    chords: &'a P,
    tolerance: f64,
    work: &'a mut FlattenScratch<D>,
}

impl<const D: usize, P: Spreadable<D>> Kernel for SpreadKernel<'_, D, P> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        spread_by_density(self.chords, self.tolerance, usize::MAX, self.work).is_some()
    }
}

struct WorstKernel<'a, const D: usize, P> {
    chords: &'a P,
    places: &'a [f64],
    work: &'a mut FlattenScratch<D>,
}

impl<const D: usize, P: Spreadable<D>> Kernel for WorstKernel<'_, D, P> {
    type Output = (f64, usize);

    #[inline(always)]
    fn run(self) -> (f64, usize) {
        self.work.set_places(self.chords, self.places);
        self.work.worst_chord(self.chords)
    }
}

/// The rounding error that may be added to the deviation of any chord of the piece.
pub(crate) fn rounding<const D: usize>(piece: &CurveSegment<D>) -> f64 {
    let size = match piece {
        CurveSegment::Line(points) => coordinate_reach(points),
        CurveSegment::Cubic(cubic) => coordinate_reach(&cubic.control),
        CurveSegment::Rational(curve) => return rational_chord::rounding(curve),
        CurveSegment::Arc(arc) => arc.magnitudes().iter().fold(0.0, |sum, x| sum + x),
    };
    rounding_at(size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explicit::Bezier;
    use crate::explicit::nurbs::{KnotVector, NurbsCurve};
    use chordal_testkit::Random;

    #[test]
    fn the_fast_way_keeps_the_tolerance_with_hardly_more_chords_than_the_greedy_one() {
        let mut random = Random::new(7);
        // Measured 1.04, 1.06, 1.04 and 1.02: the greedy way puts one long chord across an inflection.
        for (tolerance, most) in [(1e-1, 1.06), (1e-2, 1.08), (1e-3, 1.06), (1e-4, 1.04)] {
            let (mut fast, mut greedy) = (0, 0);
            for _ in 0..500 {
                let control = std::array::from_fn(|_| [0; 2].map(|_| random.unit()));
                let piece = CurveSegment::Cubic(Bezier { control });
                let chords = Chords::new(&piece);
                let places = chords.fewest(tolerance);
                assert!(places.windows(2).all(|ends| ends[0] < ends[1]));
                let lossy =
                    |ends: &[f64]| chords.deviation(ends[0], ends[1]).at_most > tolerance * (1.0 + 1e-12);
                assert!(!places.windows(2).any(lossy), "{control:?} at {tolerance}");
                fast += places.len() - 1;
                greedy += chords.greedy(tolerance).len() - 1;
            }
            let ratio = fast as f64 / greedy as f64;
            assert!((0.999..most).contains(&ratio), "{fast} and {greedy} at {tolerance}");
        }
    }

    #[test]
    fn rational_pieces_are_spread_as_cubics_are() {
        let mut random = Random::new(8);
        // Measured 1.04, 1.03 and 1.02.
        for (tolerance, most) in [(1e-1, 1.08), (1e-2, 1.06), (1e-3, 1.04)] {
            let (mut fast, mut greedy) = (0, 0);
            for case in 0..200 {
                let degree = 2 + case % 5;
                let control: Vec<[f64; 2]> = (0..=degree).map(|_| [0; 2].map(|_| random.unit())).collect();
                let weights: Vec<f64> = (0..=degree).map(|_| libm::exp2(4.0 * random.unit() - 2.0)).collect();
                let ends = [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat();
                let knots = KnotVector::new(degree, ends).unwrap();
                let curve = NurbsCurve::new(knots, control, weights).unwrap().to_curve().unwrap();
                let chords = Chords::new(&curve.segments()[0]);
                let places = chords.fewest(tolerance);
                assert!(places.windows(2).all(|ends| ends[0] < ends[1]));
                let losses = places.windows(2).map(|ends| chords.deviation(ends[0], ends[1]).at_most);
                let worst = losses.fold(0.0, greater);
                assert!(worst <= tolerance * (1.0 + 1e-12), "{case} at {tolerance}: {worst}");
                // Blocks have the same arithmetic.
                assert!((chords.worst(&places).0 - worst).abs() <= 1e-14, "{case} at {tolerance}: {worst}");
                fast += places.len() - 1;
                greedy += chords.greedy(tolerance).len() - 1;
            }
            let ratio = fast as f64 / greedy as f64;
            assert!((0.999..most).contains(&ratio), "{fast} and {greedy} at {tolerance}");
        }
    }

    #[test]
    fn an_arc_of_a_circle_takes_the_fewest_equal_chords() {
        let arc = crate::explicit::Arc::new([1.0, 2.0], [[3.0, 0.0], [0.0, 3.0]], 0.5, 5.0).unwrap();
        let (piece, tolerance) = (CurveSegment::Arc(arc), 1e-3);
        let fewest = Chords::new(&piece).fewest(tolerance).len() - 1;
        let true_fewest = (5.0 / (2.0 * libm::acos(1.0 - tolerance / 3.0))).ceil() as usize;
        assert_eq!(fewest, true_fewest);
    }
}
