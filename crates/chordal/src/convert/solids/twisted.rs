//! Plane shapes whose section changes with the height: tapers and twists.
use super::FormMesh;
use super::extruded::raised;
use super::profile::{ProfileLoops, scale_of};
use crate::implicit::Affine3;
use crate::implicit::construction::PlanarForm;
use crate::math::elementary::{sin, sin_cos};
use crate::math::{add_up, greater, mul_up};
use std::f64::consts::FRAC_PI_4;

/// The share of a length that a curved section of a twist may use. Chosen: the twist uses the other half.
const SHARE: f64 = 0.5;
/// The most sections. Chosen: as many as a turn has sides.
const MOST: f64 = 65_536.0;
/// The most quads. Chosen: some hundred megabytes.
const MOST_QUADS: f64 = 1_048_576.0;
/// The factor between the numbers of sections of successive attempts. Chosen: near enough to the fewest triangles.
const GROWTH: f64 = 1.0625;

/// A solid whose section is scaled linearly from the lower to the upper end. Straight sides sweep planes, and the error of a
/// section is scaled with it.
pub(super) fn tapered(
    (profile, place): (&PlanarForm, Option<&Affine3>),
    half: f64,
    factor: f64,
    length: f64,
) -> Option<FormMesh> {
    let widest = greater(factor, 1.0);
    let section = ProfileLoops::new(profile, length / widest / scale_of(place))?.placed(place);
    let at = |z: f64, scale: f64| move |p: [f64; 2]| [scale * p[0], scale * p[1], z];
    raised(&section.loops, &[at(-half, 1.0), at(half, factor)], mul_up(section.error, widest))
}

/// A solid whose section turns by `radians` for each unit of height.
///
/// Between two sections that are turned by the angle a, points of the same height and place on a side are paired. The distance
/// between a helix at the radius r and its chord is at most r (1 − cos(a/2)). The chords along a side of the length w span a
/// saddle, and two triangles deviate from that by a quarter of the twist of its sides, at most w sin(a/2) / 2.
pub(super) fn twisted(
    (profile, place): (&PlanarForm, Option<&Affine3>),
    [low, high]: [f64; 2],
    radians: f64,
    length: f64,
) -> Option<FormMesh> {
    let is_straight = matches!(profile, PlanarForm::Contours(_) | PlanarForm::Rectangle { radius: 0.0, .. });
    let share = if is_straight { length } else { SHARE * length };
    let section = ProfileLoops::new(profile, share / scale_of(place))?.placed(place);
    let reach = |p: &[f64; 2]| (p[0] * p[0] + p[1] * p[1]).sqrt();
    let widest = section.loops.iter().flatten().fold(0.0, |most: f64, p| greater(reach(p), most));
    // Derived: an angle has an error of three roundings of its size, a sine or cosine of one more.
    let most_turned = radians.abs() * greater(low.abs(), high.abs());
    let rounding = mul_up(widest, 8.0 * f64::EPSILON * (1.0 + most_turned));
    let remaining = length - section.error - rounding;
    let fit = TwistFit { widest, angle: radians.abs() * (high - low), length: remaining };
    let sides: Vec<f64> = section.loops.iter().flat_map(|ring| side_lengths(ring)).collect();
    let n = fit.fewest(&sides)?;
    let loops: Vec<Vec<[f64; 2]>> =
        section.loops.iter().map(|ring| with_parts(ring, |w| fit.parts(n, w))).collect();
    let saddle = sides.iter().fold(0.0, |most: f64, w| greater(fit.saddle(n, *w) / fit.parts(n, *w), most));
    let error = mul_up(add_up(fit.helix(n), saddle), 1.0 + 64.0 * f64::EPSILON);
    let error = add_up(add_up(error, section.error), rounding);
    let at = |k: u32| {
        let z = if f64::from(k) == n { high } else { low + (high - low) * (f64::from(k) / n) };
        let (s, c) = sin_cos(radians * z);
        move |[x, y]: [f64; 2]| [c * x - s * y, s * x + c * y, z]
    };
    let sections: Vec<_> = (0..=n as u32).map(at).collect();
    raised(&loops, &sections, error)
}

/// Chooses the number of sections of a twist, and the number of parts of its sides.
struct TwistFit {
    /// The largest distance from the axis.
    widest: f64,
    /// The turn from end to end.
    angle: f64,
    /// The allowed sum of the errors of helices and saddles.
    length: f64,
}

impl TwistFit {
    /// The error of the chords of helices with `n` pieces.
    fn helix(&self, n: f64) -> f64 {
        let s = sin(0.25 * self.angle / n);
        2.0 * self.widest * s * s
    }

    /// The error of two triangles along an undivided side of length `w`.
    fn saddle(&self, n: f64, w: f64) -> f64 {
        0.5 * w * sin(0.5 * self.angle / n)
    }

    /// The number of parts of such a side.
    fn parts(&self, n: f64, w: f64) -> f64 {
        greater(1.0, (self.saddle(n, w) / (self.length - self.helix(n))).ceil())
    }

    /// The number of pieces with the fewest triangles: with more pieces, sides need fewer parts, up to a point.
    fn fewest(&self, sides: &[f64]) -> Option<f64> {
        let mut best: Option<[f64; 2]> = None;
        let mut n = greater(1.0, (self.angle / FRAC_PI_4).ceil());
        while n < MOST {
            if self.helix(n) < self.length {
                let triangles = n * sides.iter().map(|w| self.parts(n, *w)).sum::<f64>();
                match best {
                    Some([_, least]) if triangles > 2.0 * least => break,
                    Some([_, least]) if triangles >= least => {}
                    _ => best = Some([n, triangles]),
                }
            }
            n = (n * GROWTH).ceil();
        }
        best.filter(|[_, quads]| *quads <= MOST_QUADS).map(|[n, _]| n)
    }
}

fn side_lengths(points: &[[f64; 2]]) -> impl Iterator<Item = f64> {
    (0..points.len()).map(|k| {
        let [a, b] = [points[k], points[(k + 1) % points.len()]];
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        (x * x + y * y).sqrt()
    })
}

/// A loop with each side divided into as many parts as its length requires.
fn with_parts(points: &[[f64; 2]], parts_of: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let mut corners = Vec::new();
    for (k, w) in side_lengths(points).enumerate() {
        let [a, b] = [points[k], points[(k + 1) % points.len()]];
        let n = parts_of(w);
        let at = |i: u32| [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * (f64::from(i) / n));
        corners.push(a);
        corners.extend((1..n as u32).map(at));
    }
    corners
}
