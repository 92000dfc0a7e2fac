//! Flattens many cubic Bézier curves at one tolerance, without further options, for inner loops.
use super::chord::{CubicChords, coordinate_reach, rounding_at, wang_steps};
use super::density::{FlattenScratch, spread_by_density};
use super::flatten::{LARGEST, Spacing};
use super::greedy;
use crate::budget::{Bound, Bounded, Failure, Job, Reference, RefusalCode, Tolerance, par_map};
use crate::explicit::Bezier;
use crate::math::simd::{self, Isa, Kernel};
use crate::math::{add_up, flushes_subnormals, greater, sub_down};

/// Flattens one cubic Bézier curve after the other at one tolerance, and reuses its buffers between them.
///
/// The points are those of [`curve_to_polyline`](super::super::curve_to_polyline), bit for bit, except that
/// successive points may be equal here: a curve that is one point gives two points.
///
/// ```
/// use chordal::{Bezier, Tolerance};
/// use chordal::convert::Spacing;
/// use chordal::convert::batch::BezierCutter;
/// let mut cutter = BezierCutter::new(Tolerance::new(0.01)?, Spacing::Fewest)?;
/// let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
/// let mut points = vec![arch.control[0]];
/// let bound = cutter.append(&arch, &mut points)?; // every point but the first one
/// assert!(bound <= 0.01 && points.len() == 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct BezierCutter<const D: usize> {
    tolerance: f64,
    spacing: Spacing,
    isa: Isa,
    work: FlattenScratch<D>,
}

/// A list of polylines in one list of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polylines<const D: usize> {
    /// The points of all polylines, one polyline after the other.
    pub points: Vec<[f64; D]>,
    /// The index of each polyline's first point; one more entry at the end.
    pub starts: Vec<usize>,
}

impl<const D: usize> Polylines<D> {
    /// The points of one polyline.
    #[must_use]
    pub fn polyline(&self, index: usize) -> &[[f64; D]] {
        &self.points[self.starts[index]..self.starts[index + 1]]
    }
}

/// The most chords of one curve. Chosen: so many take some GB.
const MOST: f64 = 1e8;

impl<const D: usize> BezierCutter<D> {
    /// A cutter for a tolerance.
    ///
    /// # Errors
    /// In an environment that flushes subnormals, so that no bound can be proved.
    pub fn new(tolerance: Tolerance, spacing: Spacing) -> Result<Self, Failure<()>> {
        if flushes_subnormals() {
            let message = "this process flushes subnormal numbers to zero, so nothing can be proved in it";
            return Err(Failure::refused(RefusalCode::FlushesSubnormals, message));
        }
        Ok(Self { tolerance: tolerance.get(), spacing, isa: simd::isa(), work: FlattenScratch::default() })
    }

    /// Appends all points of the polyline except its first one, which is the curve's start, and returns a proved
    /// bound of the two-sided Hausdorff distance between the curve and the polyline.
    ///
    /// With equal steps the bound is that of Wang's formula for the whole curve, a little larger than the bounds of
    /// the single chords.
    ///
    /// # Errors
    /// Coordinates that are not finite or beyond 1e150, a tolerance below rounding, more than 1e8 chords.
    pub fn append(&mut self, curve: &Bezier<D>, points: &mut Vec<[f64; D]>) -> Result<f64, Failure<()>> {
        simd::dispatch(self.isa, AppendKernel { cutter: self, curve, points })
    }

    #[inline(always)]
    fn cut(&mut self, curve: &Bezier<D>, points: &mut Vec<[f64; D]>) -> Result<f64, Failure<()>> {
        let size = coordinate_reach(&curve.control);
        let is_in_range = curve.control.as_flattened().iter().all(|x| x.abs() < LARGEST);
        if !is_in_range {
            return Err(out_of_range(size));
        }
        let rounding = rounding_at(size);
        // One step less, because the sum of deviation and rounding is rounded up again.
        let length = sub_down(self.tolerance.next_down(), rounding);
        if length <= 0.0 {
            return Err(below_rounding(self.tolerance, rounding));
        }
        let chords = CubicChords::new(curve);
        let loss = match self.spacing {
            Spacing::Even => append_evenly(&chords, length, points)?,
            Spacing::Fewest => {
                let loss = match spread_by_density(&chords, length, MOST as usize, &mut self.work) {
                    Some(loss) => loss,
                    None => self.greedy(&chords, length)?,
                };
                let axes = self.work.axes();
                let n = axes.first().map_or(1, |axis| axis.len());
                points.extend((1..n).map(|i| std::array::from_fn(|k| axes[k][i])));
                loss
            }
        };
        Ok(add_up(loss, rounding))
    }

    #[cold]
    fn greedy(&mut self, chords: &CubicChords<'_, D>, length: f64) -> Result<f64, Failure<()>> {
        let steps = chords.even_steps(length);
        if steps > MOST {
            return Err(too_many(steps));
        }
        let loss = |a: f64, b: f64| chords.deviation(a, b).at_most;
        let places = greedy::parameters(loss, 0.999 / steps, length); // 0.999: see `Chords::fewest`
        let worst = places.windows(2).map(|ends| loss(ends[0], ends[1])).fold(0.0, |a, b| greater(b, a));
        self.work.set_places(chords, &places);
        Ok(worst)
    }
}

/// Appends the points of equal steps, and returns the deviation by the formula.
#[inline(always)]
fn append_evenly<const D: usize>(
    chords: &CubicChords<'_, D>,
    length: f64,
    points: &mut Vec<[f64; D]>,
) -> Result<f64, Failure<()>> {
    let bend = chords.largest_second_difference();
    let steps = wang_steps(bend, length);
    if steps > MOST {
        return Err(too_many(steps));
    }
    let (n, cubic) = (steps as u32, chords.cubic());
    points.extend((1..n).map(|i| cubic.at(f64::from(i) / steps)));
    points.push(cubic.control[3]);
    // With the same margin for rounding as in `whole_steps`, of the square of the steps.
    Ok(0.75 * bend / (steps * steps) * (1.0 + f64::EPSILON * (64.0 + 8.0 * steps)))
}

struct AppendKernel<'a, 'b, const D: usize> {
    cutter: &'a mut BezierCutter<D>,
    curve: &'b Bezier<D>,
    points: &'a mut Vec<[f64; D]>,
}

impl<const D: usize> Kernel for AppendKernel<'_, '_, D> {
    type Output = Result<f64, Failure<()>>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        self.cutter.cut(self.curve, self.points)
    }
}

#[cold]
fn below_rounding<T>(tolerance: f64, rounding: f64) -> Failure<T> {
    let message =
        format!("the tolerance {tolerance:.3e} is below the possible rounding error {rounding:.3e}");
    Failure::refused(RefusalCode::BelowPrecision, message)
}

#[cold]
fn out_of_range<T>(size: f64) -> Failure<T> {
    let message =
        format!("the curve has a coordinate that is not finite or beyond {LARGEST:e}: its size is {size:e}");
    Failure::refused(RefusalCode::NotFinite, message)
}

#[cold]
fn too_many<T>(steps: f64) -> Failure<T> {
    let message = format!("the tolerance needs about {steps:.1e} segments; the limit is {MOST:.1e}");
    Failure::refused(RefusalCode::TooManyTriangles, message)
}

/// Curves per task of a thread.
const CHUNK: usize = 256;

/// Flattens many cubic Bézier curves at one tolerance, each into a polyline of its own, in their order.
///
/// **Bound.** Two-sided Hausdorff distance between each curve and its polyline, *proved*; that of the worst curve.
/// `at_least` is 0: nothing is measured.
///
/// **Determinism.** The same bytes on any number of threads and with every instruction set.
///
/// # Errors
/// As for [`BezierCutter`]; and if the job was cancelled.
///
/// ```
/// use chordal::{Bezier, Job, Tolerance, convert::{self, Spacing}};
/// let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
/// let bounded = convert::batch::beziers_to_polylines(&[arch; 3], Tolerance::new(0.01)?, &Job::default(), Spacing::Fewest)?;
/// assert_eq!(bounded.shape.starts, [0, 10, 20, 30]);
/// assert_eq!(bounded.shape.polyline(2).last(), Some(&[1.0, 0.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn beziers_to_polylines<const D: usize>(
    curves: &[Bezier<D>],
    tolerance: Tolerance,
    job: &Job,
    spacing: Spacing,
) -> Result<Bounded<Polylines<D>>, Failure<()>> {
    let cutter = BezierCutter::new(tolerance, spacing)?;
    let chunks: Vec<&[Bezier<D>]> = curves.chunks(CHUNK).collect();
    let cut = |_: usize, chunk: &&[Bezier<D>]| {
        if job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        let (mut cutter, mut polylines, mut worst) = (cutter.clone(), Polylines::default(), 0.0);
        for curve in *chunk {
            polylines.starts.push(polylines.points.len());
            polylines.points.push(curve.control[0]);
            let bound = cutter.append(curve, &mut polylines.points)?;
            worst = greater(bound, worst);
        }
        Ok((polylines, worst))
    };
    let parts = par_map(job, &chunks, cut);
    let (mut all, mut worst) = (Polylines::default(), 0.0);
    for part in parts {
        let (polylines, bound) = part?;
        let first = all.points.len();
        all.starts.extend(polylines.starts.iter().map(|start| first + start));
        all.points.extend(polylines.points);
        worst = greater(bound, worst);
    }
    all.starts.push(all.points.len());
    Ok(Bounded { shape: all, bound: Bound::proved(0.0, worst, Reference::Curves) })
}
