//! Approximate frames along a path that do not rotate about it: positions, derivatives, and transport along the path.
//!
//! A step is two reflections (W. Wang, B. Jüttler, D. Zheng, Y. Liu, *Computation of Rotation Minimizing Frames*, 2008); its
//! error has even powers of the step only, since the step back undoes it, and goes like the fourth. Results with three
//! numbers of steps cancel the fourth and the sixth power (L. F. Richardson, 1911). No bound of the error is needed here:
//! `frame_error.rs` bounds the error of the splines through these frames.
use crate::explicit::nurbs::{InvalidNurbs, NurbsCurve};
use crate::math::{cross, difference, dot, length};

/// A point of a path, its unit tangent with two derivatives, and its speed with one, by the parameter of the path.
#[derive(Clone, Copy, Debug)]
pub(in crate::convert) struct PathJet {
    pub point: [f64; 3],
    pub velocity: [f64; 3],
    pub acceleration: [f64; 3],
    pub tangent: [[f64; 3]; 3],
    pub speed: [f64; 2],
}

/// A vector and its first two derivatives.
pub(in crate::convert) type VectorJet = [[f64; 3]; 3];

fn plus(a: [f64; 3], by: f64, b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + by * b[k])
}

/// A vector of length 1 along another; the zero vector stays.
pub(in crate::convert) fn unit(v: [f64; 3]) -> [f64; 3] {
    crate::math::unit(v).unwrap_or(v)
}

/// The part of a vector across a direction, with length 1.
pub(in crate::convert) fn unit_across(v: [f64; 3], tangent: [f64; 3]) -> [f64; 3] {
    unit(plus(v, -dot(v, tangent), tangent))
}

/// The pieces of a curve between its knots, each as a curve.
pub(in crate::convert) fn pieces(path: &NurbsCurve<3>) -> Result<Vec<NurbsCurve<3>>, InvalidNurbs> {
    let piece = |k: usize| {
        let [a, b] = path.knots().piece(k);
        path.trimmed(a, b)?.clamped()
    };
    (0..path.knots().n_pieces()).map(piece).collect()
}

/// The jet of a piece at a parameter.
pub(in crate::convert) fn path_jet(piece: &NurbsCurve<3>, t: f64) -> PathJet {
    let derivatives = piece.derivatives(t, 3);
    let [point, d, dd, ddd] = [derivatives[0], derivatives[1], derivatives[2], derivatives[3]];
    let speed = length(d);
    let tangent = d.map(|x| x / speed);
    // From d = s·t: dd = s′·t + s·t′, and ddd = s″·t + 2·s′·t′ + s·t″.
    let grows = dot(tangent, dd);
    let turns: [f64; 3] = std::array::from_fn(|k| (dd[k] - grows * tangent[k]) / speed);
    let grows_more = dot(turns, dd) + dot(tangent, ddd);
    let bends = std::array::from_fn(|k| (ddd[k] - grows_more * tangent[k] - 2.0 * grows * turns[k]) / speed);
    PathJet { point, velocity: d, acceleration: dd, tangent: [tangent, turns, bends], speed: [speed, grows] }
}

/// The up vector after a step of a piece: by so many double reflections.
fn reflected(piece: &NurbsCurve<3>, [a, b]: [f64; 2], steps: usize, up: [f64; 3]) -> [f64; 3] {
    let at = |k: usize| {
        let t = a + (b - a) * (k as f64 / steps as f64);
        let derivatives = piece.derivatives(if k == steps { b } else { t }, 1);
        (derivatives[0], unit(derivatives[1]))
    };
    let (mut from, mut up) = (at(0), up);
    for k in 1..=steps {
        let to = at(k);
        let mirror = |v: [f64; 3], normal: [f64; 3]| {
            let square = dot(normal, normal);
            if square > 0.0 { plus(v, -2.0 * dot(v, normal) / square, normal) } else { v }
        };
        // A reflection across the chord, then one that takes the reflected tangent to the next tangent.
        let chord = difference(to.0, from.0);
        let (half, tangent) = (mirror(up, chord), mirror(from.1, chord));
        up = mirror(half, difference(to.1, tangent));
        from = to;
    }
    up
}

/// The angle from one vector to another about a direction, in radians.
pub(in crate::convert) fn angle_about(tangent: [f64; 3], from: [f64; 3], to: [f64; 3]) -> f64 {
    libm::atan2(dot(cross(from, to), tangent), dot(from, to))
}

/// A vector across a direction, turned about it.
pub(in crate::convert) fn turned(v: [f64; 3], tangent: [f64; 3], angle_rad: f64) -> [f64; 3] {
    let (sin, cos) = libm::sincos(angle_rad);
    let other = cross(tangent, v);
    std::array::from_fn(|k| cos * v[k] + sin * other[k])
}

/// The up vector at `b` that is `up` at `a`, without rotation about the path.
pub(in crate::convert) fn transported(piece: &NurbsCurve<3>, span: [f64; 2], up: [f64; 3]) -> [f64; 3] {
    let end = unit(piece.derivatives(span[1], 1)[1]);
    let tries = [2, 4, 8].map(|steps| unit_across(reflected(piece, span, steps, up), end));
    let angle = |k: usize| angle_about(end, tries[0], tries[k]);
    // Derived: halving the step divides the fourth power by 16, and the sixth by 64.
    let first = angle(1) + angle(1) / 15.0;
    let second = angle(2) + (angle(2) - angle(1)) / 15.0;
    unit_across(turned(tries[0], end, second + (second - first) / 63.0), end)
}

/// The length of a part of a piece, by Gauss' rule with five points.
pub(in crate::convert) fn part_length(piece: &NurbsCurve<3>, [a, b]: [f64; 2]) -> f64 {
    // Abscissas and weights of the rule, by definition.
    let outer = (5.0 + 2.0 * (10.0_f64 / 7.0).sqrt()).sqrt() / 3.0;
    let inner = (5.0 - 2.0 * (10.0_f64 / 7.0).sqrt()).sqrt() / 3.0;
    let root = 13.0 * 70.0_f64.sqrt();
    let (far, near) = ((322.0 - root) / 900.0, (322.0 + root) / 900.0);
    let rule = [(0.0, 128.0 / 225.0), (-inner, near), (inner, near), (-outer, far), (outer, far)];
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    half * rule.iter().map(|(x, w)| w * length(piece.derivatives(middle + half * x, 1)[1])).sum::<f64>()
}

/// The vectors to the side, up and ahead with their derivatives, of the frame with this up vector and a twist of `spread`
/// for each unit of length.
pub(in crate::convert) fn frame_jet(jet: &PathJet, up: [f64; 3], spread: f64) -> [VectorJet; 3] {
    let [t, dt, ddt] = jet.tangent;
    let [speed, grows] = jet.speed.map(|x| spread * x);
    // Of a vector v across the path with w = t×v: v′ = −(v·t′)t + k·w, with k the twist per parameter.
    let moving = |v: [f64; 3]| -> VectorJet {
        let w = cross(t, v);
        let slope = |v: [f64; 3], turn: [f64; 3]| plus(turn.map(|x| speed * x), -dot(v, dt), t);
        let dv = slope(v, w);
        let dw = slope(w, v.map(|x| -x));
        let along = dot(dv, dt) + dot(v, ddt);
        let ddv = std::array::from_fn(|k| -along * t[k] - dot(v, dt) * dt[k] + grows * w[k] + speed * dw[k]);
        [v, dv, ddv]
    };
    [moving(cross(up, t)), moving(up), jet.tangent]
}
