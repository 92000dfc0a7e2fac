//! Screw threads.
use super::{InvalidShape, axis_distance, finite, positive};
use crate::budget::Evidence;
use crate::implicit::{Distance, Expr, Field, Leaf, LeafAnswer, LeafError, Lipschitz};
use crate::math::{
    Box3, Interval, add_down, add_up, div_up, elementary, greater, lesser, mul_up, sqrt_down, sqrt_up,
};
use std::sync::Arc;

/// A screw thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadForm {
    /// The outer diameter.
    pub diameter: f64,
    /// The height of one turn.
    pub pitch: f64,
    /// What is taken off all of its sides, as a distance across its flanks; negative for what it is screwed
    /// into.
    pub clearance: f64,
}

/// Pitches of the coarse series by diameter, in millimetres. Defined: ISO 261 and ISO 262.
const COARSE: [[f64; 2]; 26] = [
    [1.0, 0.25],
    [1.2, 0.25],
    [1.6, 0.35],
    [2.0, 0.4],
    [2.5, 0.45],
    [3.0, 0.5],
    [3.5, 0.6],
    [4.0, 0.7],
    [5.0, 0.8],
    [6.0, 1.0],
    [7.0, 1.0],
    [8.0, 1.25],
    [10.0, 1.5],
    [12.0, 1.75],
    [14.0, 2.0],
    [16.0, 2.0],
    [18.0, 2.5],
    [20.0, 2.5],
    [22.0, 2.5],
    [24.0, 3.0],
    [27.0, 3.0],
    [30.0, 3.5],
    [36.0, 4.0],
    [42.0, 4.5],
    [48.0, 5.0],
    [64.0, 6.0],
];

impl ThreadForm {
    /// A metric thread by its name: `M6`, of the coarse series, or `M6x0.75` with its pitch.
    ///
    /// # Errors
    /// When it is no such name, or the coarse series has no such diameter.
    pub fn from_name(name: &str) -> Result<Self, InvalidShape> {
        let wrong = |what: String| InvalidShape::Number(what);
        let unknown = || wrong(format!("a thread is '{name}', and must be a name as M6 or M6x0.75"));
        let numbers = name.strip_prefix('M').ok_or_else(unknown)?;
        let (diameter, pitch) = match numbers.split_once('x') {
            Some((diameter, pitch)) => (diameter, Some(pitch)),
            None => (numbers, None),
        };
        let number = |text: &str| text.parse::<f64>().ok().filter(|n| *n > 0.0 && n.is_finite());
        let diameter = number(diameter).ok_or_else(unknown)?;
        let pitch = match pitch {
            Some(pitch) => number(pitch).ok_or_else(unknown)?,
            None => {
                let known = COARSE.iter().find(|[of, _]| *of == diameter).map(|[_, pitch]| *pitch);
                known.ok_or_else(|| {
                    wrong(format!("the coarse series has no {name}: add its pitch, as in {name}x1"))
                })?
            }
        };
        Ok(Self { diameter, pitch, clearance: 0.0 })
    }
}

/// A right-handed thread of the ISO basic profile (60°, ISO 68-1) along z, around the origin, cut off flat at its
/// ends: crests an eighth and roots a quarter of the pitch wide. The value is a sign.
///
/// # Errors
/// When a number is not finite, the pitch or the height not above 0, or nothing is left at the root.
pub fn thread(form: ThreadForm, height: f64) -> Result<Field, InvalidShape> {
    let pitch = positive("a thread's pitch", form.pitch)?;
    let half = 0.5 * positive("a thread's height", height)?;
    let clearance = finite("a thread's clearance", form.clearance)?;
    let major = 0.5 * positive("a thread's diameter", form.diameter)? - clearance;
    // Defined by ISO 68-1: the triangle is √3/2 of the pitch high, and the thread 5/8 of that deep.
    let triangle = 0.5 * 3.0_f64.sqrt() * pitch;
    let minor = major - 0.625 * triangle;
    if minor <= 0.0 || minor.is_nan() {
        return Err(InvalidShape::Number(format!(
            "a thread has a radius of {minor} at its root, and must have some"
        )));
    }
    let [x, y, z] = Expr::axes();
    let r = axis_distance();
    // How far along z the crest is, and the flank, which rises by √3 of it: 60° between both. It was shifted by
    // twice the clearance along r, which is once across it, of which the radii have one.
    let apart = Expr::leaf(Arc::new(HelixRise { pitch }), [x, y, z.clone()]);
    let at_crest = pitch / 16.0 - clearance / 3.0_f64.sqrt();
    let at_root = at_crest + (major - minor) / 3.0_f64.sqrt();
    if at_root <= 0.0 || at_root.is_nan() {
        return Err(InvalidShape::Number("a thread's clearance leaves nothing of its ridge".into()));
    }
    let flank = (&r - major) + (apart - at_crest) * 3.0_f64.sqrt();
    let ridge = (&r - major).max(&flank);
    let ends = z.abs() - half;
    let value = (&r - minor).min(&ridge).max(&ends);
    let wide = greater(major, minor);
    let bounds = Box3 { min: [-wide, -wide, -half], max: [wide, wide, half] };
    Ok(Field::new(value).known_distance(Distance::SIGN).known_bounds(bounds))
}

/// How far along z the helix is that starts on the positive x axis: 0 on it, half of the pitch between two turns.
#[derive(Clone, Copy, Debug)]
struct HelixRise {
    pitch: f64,
}

impl HelixRise {
    /// The rise from the helix to the point, from minus to plus half of the pitch.
    fn rise(self, [x, y, z]: [f64; 3]) -> f64 {
        let turns = z / self.pitch - elementary::atan2(y, x) / std::f64::consts::TAU;
        (turns - turns.round()) * self.pitch
    }

    /// A bound on its rounding: quotients of the height, and an angle of some units, as parts of the pitch.
    fn rounding(self, z: f64) -> f64 {
        32.0 * f64::EPSILON * (z.abs() + self.pitch)
    }

    /// The distances of a box from the axis, and what is known of the rise in it: its centre's, and how far from it
    /// others are. None on the axis.
    fn around(self, bounds: &Box3) -> Option<(Interval, f64, f64)> {
        let [x, y] = [0, 1].map(|k| Interval::new(bounds.min[k], bounds.max[k]).unwrap_or(Interval::ENTIRE));
        let square = x.square() + y.square();
        if !(square.lo() > 0.0 && bounds.diagonal().is_finite()) {
            return None;
        }
        let radii = Interval::new(sqrt_down(square.lo()), sqrt_up(square.hi())).ok()?;
        let centre = bounds.centre();
        // A step turns by its length over the radius at most, and rises by its own height.
        let turned = div_up(self.pitch, mul_up(6.0, radii.lo()));
        let size = |k: usize| 0.5 * (bounds.max[k] - bounds.min[k]).next_up();
        let flat = sqrt_up(add_up(mul_up(size(0), size(0)), mul_up(size(1), size(1))));
        let reach =
            add_up(add_up(mul_up(turned, flat), size(2)), self.rounding(greater(centre[2].abs(), size(2))));
        // Derived: a few roundings, each of less than a step of the number.
        Some((radii, self.rise(centre), add_up(reach, f64::EPSILON * (centre[0].abs() + centre[1].abs()))))
    }
}

impl Leaf for HelixRise {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        points.iter().zip(out).for_each(|(p, value)| *value = self.rise(*p).abs());
        Ok(())
    }

    fn gradient_at(&self, points: &[[f64; 3]], out: &mut [[f64; 3]]) -> Result<LeafAnswer, LeafError> {
        for (p, gradient) in points.iter().zip(out) {
            let square = p[0] * p[0] + p[1] * p[1];
            let turn = self.pitch / (std::f64::consts::TAU * square);
            let sign = if self.rise(*p) < 0.0 { -1.0 } else { 1.0 };
            *gradient = if square > 0.0 { [sign * turn * p[1], -sign * turn * p[0], sign] } else { [0.0; 3] };
        }
        Ok(LeafAnswer::Given)
    }

    fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<LeafAnswer, LeafError> {
        let half = (0.5 * self.pitch).next_up();
        for (bounds, range) in boxes.iter().zip(out) {
            let all = Interval::new(0.0, half).unwrap_or(Interval::UNKNOWN);
            *range = match self.around(bounds) {
                Some((_, rise, reach)) => {
                    let (low, high) = (add_down(rise.abs(), -reach), add_up(rise.abs(), reach));
                    // Beyond the middle between two turns the next one is nearer.
                    let back = add_down(self.pitch, -high);
                    let low = lesser(low, back);
                    let ends = Interval::new(greater(low, 0.0), lesser(high, half));
                    ends.unwrap_or(all)
                }
                // On the axis it jumps.
                None => all.undefined(),
            };
        }
        Ok(LeafAnswer::Given)
    }

    fn gradient_over(&self, boxes: &[Box3], out: &mut [[Interval; 3]]) -> Result<LeafAnswer, LeafError> {
        let half = 0.5 * self.pitch;
        for (bounds, gradient) in boxes.iter().zip(out) {
            *gradient = [Interval::UNKNOWN; 3];
            let Some((radii, rise, reach)) = self.around(bounds) else { continue };
            let crosses = rise.abs() <= reach || add_up(rise.abs(), reach) >= half;
            let sign = if crosses {
                Interval::new(-1.0, 1.0).unwrap_or(Interval::ENTIRE)
            } else {
                Interval::point(if rise < 0.0 { -1.0 } else { 1.0 })
            };
            let [x, y] =
                [0, 1].map(|k| Interval::new(bounds.min[k], bounds.max[k]).unwrap_or(Interval::ENTIRE));
            let tau =
                Interval::point(std::f64::consts::TAU).hull(Interval::point(std::f64::consts::TAU.next_up()));
            let turn = Interval::point(self.pitch) / (tau * radii);
            let unit = Interval::new(-1.0, 1.0).unwrap_or(Interval::ENTIRE);
            let cosine = |side: Interval| (side / radii).intersection(unit);
            *gradient = [sign * turn * cosine(y), -(sign * turn * cosine(x)), sign];
        }
        Ok(LeafAnswer::Given)
    }

    fn lipschitz(&self) -> Option<Lipschitz> {
        None
    }

    fn evidence(&self) -> Evidence {
        Evidence::Proved
    }
}
