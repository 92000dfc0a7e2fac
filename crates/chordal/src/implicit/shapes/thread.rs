//! Screw threads.
use super::{InvalidShape, axis_distance, finite, positive};
use crate::budget::Evidence;
use crate::implicit::construction::{Construction, SolidForm, ThreadProfile};
use crate::implicit::op::{Binary, Unary};
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
    /// The distance by which all its flanks are moved inwards; negative for the hole that it is screwed into.
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
        let unknown = || wrong(format!("a thread has a name like M6 or M6x0.75, not '{name}'"));
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
                let pitch_of = COARSE.iter().find(|[size, _]| *size == diameter).map(|[_, pitch]| *pitch);
                pitch_of.ok_or_else(|| {
                    wrong(format!("the coarse series has no {name}: add its pitch, as in {name}x1"))
                })?
            }
        };
        Ok(Self { diameter, pitch, clearance: 0.0 })
    }
}

/// A right-handed thread of the ISO basic profile (60°, ISO 68-1) along z, around the origin, cut off flat at
/// its ends: crests are an eighth and roots a quarter of the pitch wide. The value is a sign.
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
    let [_, _, z] = Expr::axes();
    let r = axis_distance();
    // Half-widths along z: of the crest, and of the flank, which rises by √3 of its width, since the flanks
    // enclose 60°. The flank moves by twice the clearance along r, which is once across it; the radii include
    // one of these.
    let core = CORE * minor;
    let side = |is_above| Expr::leaf(Arc::new(HelixRise { pitch, core, is_above }), Expr::axes());
    let at_crest = pitch / 16.0 - clearance / 3.0_f64.sqrt();
    let at_root = at_crest + (major - minor) / 3.0_f64.sqrt();
    if at_root <= 0.0 || at_root.is_nan() {
        return Err(InvalidShape::Number("a thread's clearance leaves nothing of its ridge".into()));
    }
    let flank = |is_above| (&r - major) + (side(is_above) - at_crest) * 3.0_f64.sqrt();
    let ridge = (&r - major).max(&flank(true)).max(&flank(false));
    let ends = z.abs() - half;
    let value = (&r - minor).min(&ridge).max(&ends);
    let wide = greater(major, minor);
    let bounds = Box3 { min: [-wide, -wide, -half], max: [wide, wide, half] };
    let profile = ThreadProfile { major, minor, pitch, at_crest, at_root };
    let construction = Construction::solid(SolidForm::Thread { profile, half })
        .zip(Construction::solid(SolidForm::Cuboid { half: [2.0 * wide, 2.0 * wide, half] }))
        .and_then(|(endless, ends)| endless.clipped(vec![ends]));
    // Turns that overlap up to their crests form a cylinder.
    let construction = construction.filter(|_| at_crest < 0.5 * pitch);
    let field = Field::new(value).known_construction(construction);
    Ok(field.known_distance(Distance::SIGN).known_bounds(bounds))
}

/// The share of the root's radius below which heights above the helix fade. Chosen: below 1, so that the core
/// alone decides there.
const CORE: f64 = 0.5;
/// The share of a turn in which a side falls back from the helix above to the one below. Chosen: its slope is
/// only twice that of the rise, and where the other side carries the surface it is lower by at least an
/// eighth of a turn.
const FALL: f64 = 1.0 / 3.0;

/// The height along z of a point above or below the nearest turn of the helix that starts on the positive x
/// axis: from minus to plus half of the pitch. Just beyond the middle between two turns it falls back, at a
/// finite slope, and the larger of both sides is the distance along z. Inside the core it fades to a quarter
/// of the pitch on the axis, where it would jump.
#[derive(Clone, Copy, Debug)]
struct HelixRise {
    pitch: f64,
    core: f64,
    is_above: bool,
}

impl HelixRise {
    /// The turns from the helix to the point on this side, from minus to plus a half.
    fn turns(self, [x, y, z]: [f64; 3]) -> f64 {
        let turns = z / self.pitch - elementary::atan2(y, x) / std::f64::consts::TAU;
        let turns = turns - turns.round();
        if self.is_above { turns } else { -turns }
    }

    /// The same values up to rounding as an expression.
    fn expr(self) -> Expr {
        let [x, y, z] = Expr::axes();
        let turns = z / self.pitch - Expr::binary(Binary::Atan2, &y, &x) / std::f64::consts::TAU;
        let turns = &turns - Expr::unary(Unary::Round, &turns);
        let turns = if self.is_above { turns } else { -turns };
        // Between its turning points the rise is below the fall, and beyond them it is above.
        let falling = (&turns + 0.5) * (-(1.0 - FALL) / FALL) + 0.5;
        let height = turns.max(&falling) * self.pitch;
        let middle = 0.25 * self.pitch;
        let share = ((x.square() + y.square()).sqrt() / self.core).min(&Expr::constant(1.0));
        share * (height - middle) + middle
    }

    /// A bound on its rounding: quotients of the height, and an angle of some units.
    fn rounding(self, z: f64) -> f64 {
        32.0 * f64::EPSILON * (z.abs() / self.pitch + 1.0)
    }

    /// The turns at the centre of a box, and the largest difference from them in the box. None near the axis.
    fn around(self, bounds: &Box3, radii: Interval) -> Option<[f64; 2]> {
        if !(radii.lo() > 0.0 && bounds.diagonal().is_finite()) {
            return None;
        }
        let centre = bounds.centre();
        // A step changes the turns by at most its length over 2π times the radius (1/6 is more than 1/2π),
        // plus its height over the pitch.
        let size = |k: usize| 0.5 * (bounds.max[k] - bounds.min[k]).next_up();
        let flat = sqrt_up(add_up(mul_up(size(0), size(0)), mul_up(size(1), size(1))));
        let reach = add_up(div_up(flat, mul_up(6.0, radii.lo())), div_up(size(2), self.pitch));
        let reach = add_up(reach, self.rounding(greater(bounds.min[2].abs(), bounds.max[2].abs())));
        // Derived: a few roundings, each of less than a step of the number.
        let stray = div_up(f64::EPSILON * (centre[0].abs() + centre[1].abs()), radii.lo());
        let reach = add_up(reach, stray);
        (reach < 0.5).then_some([self.turns(centre), reach])
    }

    /// The values in a box, in turns, before they fade, and their slope along the turns.
    fn side(self, bounds: &Box3, radii: Interval) -> (Interval, Interval) {
        let steep = -(1.0 - FALL) / FALL;
        let Some([turns, reach]) = self.around(bounds, radii) else {
            return (interval(-0.5, 0.5), interval(steep, 1.0));
        };
        let (low, high) = (add_down(turns, -reach), add_up(turns, reach));
        // The ends of the fall, in this turn and the next. Within rounding of an end, both sides count.
        let near = |turns: f64| low <= turns + LEAST && high >= turns - LEAST;
        let falls = near(-0.5) || near(0.5) || low < FALL - 0.5 || high > 0.5;
        let rises = high >= FALL - 0.5 - LEAST && low <= 0.5 + LEAST
            || low <= -0.5 + LEAST
            || high >= FALL + 0.5 - LEAST;
        let has_top = near(-0.5) || near(0.5);
        let has_bottom = near(FALL - 0.5) || near(FALL + 0.5);
        // Between its turning points the height is monotone: its extremes are at the ends, or there.
        let ends = [low, high].map(|turns| fold(turns - turns.round()));
        // Derived: some roundings of numbers below 1, times the slope.
        let rounding = LEAST * -steep;
        let lowest = if has_bottom { FALL - 0.5 } else { lesser(ends[0], ends[1]) } - rounding;
        let highest = if has_top { 0.5 } else { greater(ends[0], ends[1]) + rounding };
        let slope =
            interval(if falls { steep - rounding } else { 1.0 }, if rises { 1.0 } else { steep + rounding });
        (interval(greater(lowest, -0.5), lesser(highest, 0.5)), slope)
    }

    /// The share of the height that remains at a distance from the axis.
    fn share(self, radii: Interval) -> Interval {
        (radii / Interval::point(self.core)).min(Interval::point(1.0))
    }
}

/// Turns closer than this to an end of the fall may be on either side. Derived: 16 roundings of numbers below
/// 1.
const LEAST: f64 = 16.0 * f64::EPSILON;

/// The value of a leaf as an expression, if it is a side of a thread.
pub(super) fn helix_as_expr(leaf: &dyn Leaf) -> Option<Expr> {
    leaf.as_any()?.downcast_ref::<HelixRise>().map(|helix| helix.expr())
}

/// The height for turns from minus to plus a half: the turns themselves, or the falling part.
fn fold(turns: f64) -> f64 {
    if turns >= FALL - 0.5 { turns } else { 0.5 - (turns + 0.5) * ((1.0 - FALL) / FALL) }
}

/// The distances of a box from the axis.
fn radii(bounds: &Box3) -> Interval {
    let [x, y] = [0, 1].map(|k| interval(bounds.min[k], bounds.max[k]));
    let square = x.square() + y.square();
    interval(sqrt_down(greater(square.lo(), 0.0)), sqrt_up(square.hi()))
}

/// The interval, or all numbers if the ends form none.
fn interval(low: f64, high: f64) -> Interval {
    Interval::new(low, high).unwrap_or(Interval::ENTIRE)
}

impl Leaf for HelixRise {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        let middle = 0.25 * self.pitch;
        for (p, value) in points.iter().zip(out) {
            let height = fold(self.turns(*p)) * self.pitch;
            let r = (p[0] * p[0] + p[1] * p[1]).sqrt();
            *value = if r < self.core { middle + r / self.core * (height - middle) } else { height };
        }
        Ok(())
    }

    fn gradient_at(&self, points: &[[f64; 3]], out: &mut [[f64; 3]]) -> Result<LeafAnswer, LeafError> {
        let side = if self.is_above { 1.0 } else { -1.0 };
        for (p, gradient) in points.iter().zip(out) {
            let r = (p[0] * p[0] + p[1] * p[1]).sqrt();
            let turns = self.turns(*p);
            let slope = side * if turns >= FALL - 0.5 { 1.0 } else { -(1.0 - FALL) / FALL };
            // Inside the core the height is multiplied by r / core, which cancels the radius.
            let turn = slope * self.pitch / (std::f64::consts::TAU * greater(r, self.core));
            let fades = if r < self.core { (fold(turns) - 0.25) * self.pitch / self.core } else { 0.0 };
            let [cos, sin] = if r > 0.0 { [p[0] / r, p[1] / r] } else { [1.0, 0.0] };
            *gradient =
                [turn * sin + fades * cos, fades * sin - turn * cos, slope * lesser(r / self.core, 1.0)];
        }
        Ok(LeafAnswer::Given)
    }

    fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<LeafAnswer, LeafError> {
        let pitch = Interval::point(self.pitch);
        let middle = Interval::point(0.25 * self.pitch);
        for (bounds, range) in boxes.iter().zip(out) {
            let radii = radii(bounds);
            let height = self.side(bounds, radii).0 * pitch;
            *range =
                if radii.lo() > self.core { height } else { middle + self.share(radii) * (height - middle) };
        }
        Ok(LeafAnswer::Given)
    }

    fn gradient_over(&self, boxes: &[Box3], out: &mut [[Interval; 3]]) -> Result<LeafAnswer, LeafError> {
        // 2π is just above its rounded value.
        let tau =
            Interval::point(std::f64::consts::TAU).hull(Interval::point(std::f64::consts::TAU.next_up()));
        let [core, pitch] = [self.core, self.pitch].map(Interval::point);
        for (bounds, gradient) in boxes.iter().zip(out) {
            let radii = radii(bounds);
            let (turns, slope) = self.side(bounds, radii);
            let slope = if self.is_above { slope } else { -slope };
            let turn = slope * pitch / (tau * radii.max(core));
            let fades = (turns - Interval::point(0.25)) * pitch / core;
            let fades = match (radii.lo() <= self.core, radii.hi() >= self.core) {
                (true, true) => fades.hull(Interval::point(0.0)),
                (true, false) => fades,
                (false, _) => Interval::point(0.0),
            };
            let [cos, sin] = [0, 1].map(|k| {
                let unit = interval(-1.0, 1.0);
                let side = interval(bounds.min[k], bounds.max[k]);
                if radii.lo() > 0.0 { (side / radii).intersection(unit) } else { unit }
            });
            *gradient = [turn * sin + fades * cos, fades * sin - turn * cos, slope * self.share(radii)];
        }
        Ok(LeafAnswer::Given)
    }

    fn lipschitz(&self) -> Option<Lipschitz> {
        None
    }

    fn evidence(&self) -> Evidence {
        Evidence::Proved
    }

    fn as_any(&self) -> Option<&dyn std::any::Any> {
        Some(self)
    }
}
