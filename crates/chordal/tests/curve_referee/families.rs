//! Random cubics of every kind that is hard in its own way.
use super::truth::Control;
use chordal_testkit::Random;

/// A cubic with the name of its kind.
#[derive(Clone, Debug)]
pub struct Shape<const D: usize> {
    pub kind: &'static str,
    pub control: Control<D>,
}

type Make<const D: usize> = fn(&mut Random) -> Control<D>;

fn plus<const D: usize>(a: [f64; D], by: f64, b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] + by * b[k])
}

/// Control points of the plane, put somewhere.
fn placed<const D: usize>(r: &mut Random, plane: [[f64; 2]; 4]) -> Control<D> {
    let (x, y): ([f64; D], [f64; D]) = (r.direction(), r.direction());
    plane.map(|p| plus(plus([0.0; D], p[0], x), p[1], y))
}

/// Moves every coordinate by up to `by`.
fn shaken<const D: usize>(r: &mut Random, control: Control<D>, by: f64) -> Control<D> {
    control.map(|p| plus(p, by, r.point()))
}

/// Nothing, or a little, down to the last digits.
fn little(r: &mut Random) -> f64 {
    if r.below(3) == 0 { 0.0 } else { r.power(-15.0, -1.0) }
}

fn even<const D: usize>(r: &mut Random) -> Control<D> {
    std::array::from_fn(|_| r.point())
}

fn far_inside<const D: usize>(r: &mut Random) -> Control<D> {
    let by = r.power(0.0, 4.0);
    [r.point(), r.point().map(|x| by * x), r.point().map(|x| by * x), r.point()]
}

fn nearly_straight<const D: usize>(r: &mut Random) -> Control<D> {
    let (a, d): ([f64; D], [f64; D]) = (r.point(), r.point());
    let along = std::array::from_fn(|k| d[k] - a[k]);
    let (s, t) = (r.between(0.1, 0.6), r.between(0.4, 0.9));
    let by = r.power(-12.0, -1.0);
    shaken(r, [a, plus(a, s, along), plus(a, t, along), d], by)
}

fn bow<const D: usize>(r: &mut Random) -> Control<D> {
    // A circle's quarter, more or less.
    let k = r.between(0.2, 0.9);
    placed(r, [[1.0, 0.0], [1.0, k], [k, 1.0], [0.0, 1.0]])
}

fn cusp<const D: usize>(r: &mut Random) -> Control<D> {
    let control = placed(r, [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0]]);
    let by = little(r);
    shaken(r, control, by)
}

fn cusp_anywhere<const D: usize>(r: &mut Random) -> Control<D> {
    // The derivative's control points so that it vanishes at t: d1 = −(s²·d0 + t²·d2)/(2st).
    let (d0, d2): ([f64; D], [f64; D]) = (r.point(), r.point());
    let t = r.between(0.05, 0.95);
    let s = 1.0 - t;
    let d1: [f64; D] = std::array::from_fn(|k| -(s * s * d0[k] + t * t * d2[k]) / (2.0 * s * t));
    let a: [f64; D] = r.point();
    let (b, by) = (plus(a, 1.0, d0), little(r));
    let c = plus(b, 1.0, d1);
    shaken(r, [a, b, c, plus(c, 1.0, d2)], by)
}

fn noose<const D: usize>(r: &mut Random) -> Control<D> {
    let (x, y) = (r.between(1.0, 5.0), r.between(0.3, 3.0));
    placed(r, [[0.0, 0.0], [x, y], [1.0 - x, y], [1.0, 0.0]])
}

fn turning_back<const D: usize>(r: &mut Random) -> Control<D> {
    // On a line, or nearly: linebender/kurbo#426.
    let by = little(r);
    let places: [f64; 4] = std::array::from_fn(|_| r.between(-2.0, 2.0));
    let control = placed(r, places.map(|x| [x, 0.0]));
    shaken(r, control, by)
}

fn no_chord<const D: usize>(r: &mut Random) -> Control<D> {
    let (a, b, c): ([f64; D], [f64; D], [f64; D]) = (r.point(), r.point(), r.point());
    let by = little(r);
    [a, b, c, plus(a, by, r.point())]
}

fn ends_in_its_ends<const D: usize>(r: &mut Random) -> Control<D> {
    let [a, b, c, d]: Control<D> = even(r);
    let by = little(r);
    let near = |r: &mut Random, p| plus(p, by, r.point());
    match r.below(4) {
        0 => [a, near(r, a), c, d],
        1 => [a, b, near(r, d), d],
        2 => [a, near(r, a), near(r, d), d],
        _ => [a, near(r, d), near(r, a), d],
    }
}

fn double_bend<const D: usize>(r: &mut Random) -> Control<D> {
    let (x, y) = (r.between(0.1, 0.9), r.between(0.01, 2.0));
    placed(r, [[0.0, 0.0], [x, y], [1.0 - x, -y], [1.0, 0.0]])
}

fn three_in_one<const D: usize>(r: &mut Random) -> Control<D> {
    let (p, by) = (r.point(), little(r));
    let mut control = shaken(r, [p; 4], by);
    control[r.below(4)] = r.point();
    control
}

fn lattice<const D: usize>(r: &mut Random) -> Control<D> {
    // All coincidences: equal points, right angles, turning back.
    std::array::from_fn(|_| std::array::from_fn(|_| r.below(3) as f64 - 1.0))
}

fn flat<const D: usize>(r: &mut Random) -> Control<D> {
    let by = r.power(-9.0, -1.0);
    even::<D>(r).map(|mut p| {
        p[1] *= by;
        p
    })
}

fn by_speed<const D: usize>(r: &mut Random) -> Control<D> {
    // Nearly all of the way in a small part of the parameter.
    let (a, d): ([f64; D], [f64; D]) = (r.point(), r.point());
    let by = r.power(-6.0, 0.0);
    [a, plus(a, by, r.point()), plus(a, 0.1 * by, r.point()), d]
}

/// All kinds.
fn kinds<const D: usize>() -> [(&'static str, Make<D>); 15] {
    [
        ("even", even),
        ("far inside", far_inside),
        ("nearly straight", nearly_straight),
        ("bow", bow),
        ("cusp", cusp),
        ("cusp anywhere", cusp_anywhere),
        ("noose", noose),
        ("turning back", turning_back),
        ("no chord", no_chord),
        ("ends in its ends", ends_in_its_ends),
        ("double bend", double_bend),
        ("three in one", three_in_one),
        ("lattice", lattice),
        ("flat", flat),
        ("by speed", by_speed),
    ]
}

/// The shape of a seed: each kind in turn; every third large, small or a little off the origin.
pub fn shape<const D: usize>(seed: usize) -> Shape<D> {
    let r = &mut Random::new(seed as u64);
    let kinds = kinds::<D>();
    let (kind, make) = kinds[seed % kinds.len()];
    let mut control = make(r);
    if r.below(3) == 0 {
        let (scale, offset): (f64, [f64; D]) = (r.power(-6.0, 6.0), r.point());
        let away = if r.below(2) == 0 { 0.0 } else { scale * r.power(0.0, 3.0) };
        control = control.map(|p| plus(p.map(|x| scale * x), away, offset));
    }
    Shape { kind, control }
}

/// A cubic whose second derivative is nowhere small against its largest, and which does not turn back: twice
/// as many steps, a quarter of the error.
pub fn regular(seed: usize) -> Control<2> {
    let r = &mut Random::new(seed as u64 + 1_000_000);
    // The legs turn the same way, by up to a right angle in all, at up to twice the speed.
    let (first, second) = (r.between(0.2, 0.8), r.between(0.2, 0.8));
    let mut at = [r.between(-1.0, 1.0), r.between(-1.0, 1.0)];
    let mut angle = r.between(0.0, std::f64::consts::TAU);
    let side = [1.0, -1.0][r.below(2)];
    let mut control = [at; 4];
    for (point, turn) in control[1..].iter_mut().zip([0.0, first, second]) {
        angle += side * turn;
        let speed = r.between(1.0, 1.5);
        at = [at[0] + speed * angle.cos(), at[1] + speed * angle.sin()];
        *point = at;
    }
    control
}
