//! Screw threads.
use super::{InvalidShape, axis_distance, finite, positive};
use crate::implicit::op::Unary;
use crate::implicit::{Distance, Expr, Field};
use crate::math::{Box3, greater};

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
    // Points turned back by their height, so that the crest is at the positive x axis.
    let angle = &z * (std::f64::consts::TAU / pitch);
    let [along_x, along_y] = [Unary::Cos, Unary::Sin].map(|turn| Expr::unary(turn, &angle));
    let across = along_x * &x + along_y * &y;
    let cosine = (across / &r).min(&1.0.into()).max(&(-1.0).into());
    // How far along z the crest is, and the flank, which rises by √3 of it: 60° between both. It was shifted by
    // twice the clearance along r, which is once across it, of which the radii have one.
    let apart = Expr::unary(Unary::Acos, &cosine) * (pitch / std::f64::consts::TAU);
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
