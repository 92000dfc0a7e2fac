//! Plane shapes whose section changes with the height: tapers and twists.
use super::FormMesh;
use super::extruded::raised;
use super::profile::{ProfileLoops, scale_of};
use crate::implicit::Affine3;
use crate::implicit::construction::PlanarForm;
use crate::math::elementary::{sin, sin_cos};
use crate::math::{add_up, greater, mul_up};
use std::f64::consts::FRAC_PI_4;

/// The share of a length that a curved section takes of a twist. Chosen: both take some.
const SHARE: f64 = 0.5;
/// The most sections. Chosen: as many as a turn has sides.
const MOST: f64 = 65_536.0;
/// The most quads beside them. Chosen: some hundred megabytes.
const MOST_QUADS: f64 = 1_048_576.0;
/// By how many times the sections of one attempt are more than those of the one before. Chosen: near enough to the fewest.
const GROWTH: f64 = 1.0625;

/// A section that grows evenly from the lower to the upper end. Its straight sides sweep planes, and what a section is off by
/// grows with it.
pub(super) fn tapered(
    (profile, place): (&PlanarForm, Option<&Affine3>),
    half: f64,
    factor: f64,
    length: f64,
) -> Option<FormMesh> {
    let widest = greater(factor, 1.0);
    let section = ProfileLoops::new(profile, length / widest / scale_of(place))?.placed(place);
    let at = |z: f64, scale: f64| move |p: [f64; 2]| [scale * p[0], scale * p[1], z];
    raised(&section.loops, &[at(-half, 1.0), at(half, factor)], mul_up(section.off, widest))
}

/// A section that turns by `radians` from one height to the next whole one.
///
/// Between two sections that are turned by the angle a, points of the same height and place of a side pair up. On a helix at
/// the distance r from the axis its chord is off by r (1 − cos(a/2)) at most. The chords along a side of the length w span a
/// saddle, and two triangles are off that by a quarter of the twist of its sides, w sin(a/2) / 2 at most.
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
    // Derived: an angle is off by three roundings of its size, a sine or cosine by one more.
    let most_turned = radians.abs() * greater(low.abs(), high.abs());
    let rounding = mul_up(widest, 8.0 * f64::EPSILON * (1.0 + most_turned));
    let fit = TwistFit { widest, angle: radians.abs() * (high - low), left: length - section.off - rounding };
    let sides: Vec<f64> = section.loops.iter().flat_map(|own| side_lengths(own)).collect();
    let n = fit.fewest(&sides)?;
    let loops: Vec<Vec<[f64; 2]>> =
        section.loops.iter().map(|own| with_parts(own, |w| fit.parts(n, w))).collect();
    let saddle = sides.iter().fold(0.0, |most: f64, w| greater(fit.saddle(n, *w) / fit.parts(n, *w), most));
    let off = mul_up(add_up(fit.helix(n), saddle), 1.0 + 64.0 * f64::EPSILON);
    let off = add_up(add_up(off, section.off), rounding);
    let at = |k: u32| {
        let z = if f64::from(k) == n { high } else { low + (high - low) * (f64::from(k) / n) };
        let (s, c) = sin_cos(radians * z);
        move |[x, y]: [f64; 2]| [c * x - s * y, s * x + c * y, z]
    };
    let sections: Vec<_> = (0..=n as u32).map(at).collect();
    raised(&loops, &sections, off)
}

/// How many sections a twist takes, and how many parts its sides.
struct TwistFit {
    /// The largest distance from the axis.
    widest: f64,
    /// The turn from end to end.
    angle: f64,
    /// What helices and saddles may be off by together.
    left: f64,
}

impl TwistFit {
    /// What chords of helices are off by with so many pieces.
    fn helix(&self, n: f64) -> f64 {
        let s = sin(0.25 * self.angle / n);
        2.0 * self.widest * s * s
    }

    /// What two triangles beside a whole side of a length are off by.
    fn saddle(&self, n: f64, w: f64) -> f64 {
        0.5 * w * sin(0.5 * self.angle / n)
    }

    /// The parts of such a side.
    fn parts(&self, n: f64, w: f64) -> f64 {
        greater(1.0, (self.saddle(n, w) / (self.left - self.helix(n))).ceil())
    }

    /// The number of pieces with the fewest triangles: more of them let sides have fewer parts, up to some number.
    fn fewest(&self, sides: &[f64]) -> Option<f64> {
        let mut best: Option<[f64; 2]> = None;
        let mut n = greater(1.0, (self.angle / FRAC_PI_4).ceil());
        while n < MOST {
            if self.helix(n) < self.left {
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

/// A loop with each side in as many parts as its length asks for.
fn with_parts(points: &[[f64; 2]], parts_of: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let mut all = Vec::new();
    for (k, w) in side_lengths(points).enumerate() {
        let [a, b] = [points[k], points[(k + 1) % points.len()]];
        let n = parts_of(w);
        let at = |i: u32| [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * (f64::from(i) / n));
        all.push(a);
        all.extend((1..n as u32).map(at));
    }
    all
}
