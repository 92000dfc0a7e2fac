//! Random bicubic patches of every kind that has ever been trouble, at every scale and place.
use super::frame::frame;
use chordal_testkit::Random;
use chordal_testkit::sampler::{Control, Point, add, distance, scale};

/// A patch with what it is, its size (the diagonal of its control points' box) and its seed.
#[derive(Clone, Debug)]
pub struct Shape {
    pub kind: &'static str,
    pub control: Control,
    pub size: f64,
    pub seed: u64,
}

pub type Maker = fn(&mut Random) -> Control;

/// What they are called and how they are made.
pub const KINDS: [(&str, Maker); 14] = [
    ("flat", |r| noisy(r, [0.15, 0.15, 0.0])),
    ("flat and folded over itself", |r| noisy(r, [0.8, 0.8, 0.0])),
    ("hilly", |r| noisy(r, [0.05, 0.05, 0.3])),
    ("noisy", |r| noisy(r, [0.15; 3])),
    ("wild", |r| noisy(r, [0.6; 3])),
    ("bent", bent),
    ("twisted", twisted),
    ("saddle", saddle),
    ("pole", |r| pole(r, 1)),
    ("two poles", |r| pole(r, 2)),
    ("pointed corner", corner),
    ("sliver", sliver),
    ("cusped side", cusped),
    ("cylinder", cylinder),
];

fn grid(of: impl Fn(usize, usize) -> Point) -> Control {
    std::array::from_fn(|i| std::array::from_fn(|j| of(i, j)))
}

fn noisy(r: &mut Random, strength: [f64; 3]) -> Control {
    let mut control = grid(|i, j| [j as f64 / 3.0, i as f64 / 3.0, 0.0]);
    for p in control.iter_mut().flatten() {
        *p = std::array::from_fn(|k| p[k] + strength[k] * r.between(-1.0, 1.0));
    }
    control
}

/// A cubic that follows a circular arc about the origin.
fn arc(angle: f64) -> [[f64; 2]; 4] {
    let k = 4.0 / 3.0 * (angle / 4.0).tan();
    let (s, c) = angle.sin_cos();
    [[1.0, 0.0], [1.0, k], [c + k * s, s - k * c], [c, s]]
}

fn bent(r: &mut Random) -> Control {
    let (profile, height, taper) = (arc(r.between(2.5, 5.5)), r.between(0.3, 2.0), r.between(-0.5, 0.5));
    grid(|i, j| {
        let wide = 1.0 + taper * i as f64 / 3.0;
        [profile[j][0] * wide, profile[j][1] * wide, height * i as f64 / 3.0]
    })
}

fn cylinder(r: &mut Random) -> Control {
    let (profile, height, slant) = (arc(r.between(0.2, 3.0)), r.between(0.1, 3.0), r.between(-0.5, 0.5));
    grid(|i, j| {
        let [x, y] = profile[j];
        [x, y, height * i as f64 / 3.0 + slant * x * (i as f64 - 1.5)]
    })
}

fn twisted(r: &mut Random) -> Control {
    let (turn, long) = (r.between(1.0, 6.3), r.between(0.3, 4.0));
    grid(|i, j| {
        let (s, c) = (turn * i as f64 / 3.0).sin_cos();
        [(j as f64 - 1.5) * c, (j as f64 - 1.5) * s, long * i as f64]
    })
}

fn saddle(r: &mut Random) -> Control {
    let [a, b, c] = [r.between(0.1, 1.0), r.between(0.1, 1.0), r.between(-1.0, 1.0)];
    grid(|i, j| {
        let (u, v) = (j as f64 / 1.5 - 1.0, i as f64 / 1.5 - 1.0);
        [u, v, a * u * u - b * v * v + c * u * v]
    })
}

/// Noise, with one side or two opposite sides pulled together, each to one point.
fn pole(r: &mut Random, n: usize) -> Control {
    let mut control = noisy(r, [0.2; 3]);
    let along = r.below(2) == 0;
    for end in [0, 3].into_iter().take(n) {
        let tip = [r.between(0.0, 1.0), end as f64 / 3.0, r.between(-1.0, 1.0)];
        for k in 0..4 {
            let (i, j) = if along { (end, k) } else { (k, end) };
            control[i][j] = tip;
        }
    }
    control
}

/// Sharply curved at one corner: its neighbours are close together.
fn corner(r: &mut Random) -> Control {
    let (mut control, near) = (noisy(r, [0.05; 3]), r.between(0.003, 0.1));
    control[0][0] = [0.0, 0.0, r.between(0.1, 0.8)];
    control[0][1] = [near, 0.0, 0.0];
    control[1][0] = [0.0, near, 0.0];
    control[1][1] = [near, near, 0.0];
    control
}

/// A thousand to a million times longer than wide.
fn sliver(r: &mut Random) -> Control {
    let thin = 10_f64.powf(r.between(-6.0, -3.0));
    noisy(r, [0.2; 3]).map(|row| row.map(|[x, y, z]| [x, thin * y, thin * z]))
}

/// Control points of a side that fall together or run backwards, so that its speed vanishes somewhere.
fn cusped(r: &mut Random) -> Control {
    let mut control = noisy(r, [0.15; 3]);
    match r.below(3) {
        0 => control[0][1] = control[0][0],
        1 => control[0] = [control[0][0], control[0][3], control[0][0], control[0][3]],
        _ => control[0] = [control[0][0], control[0][0], control[0][3], control[0][3]],
    }
    control
}

/// The diagonal of the box of the control points.
pub fn diagonal(control: &Control) -> f64 {
    let extreme = |f: fn(f64, f64) -> f64, start: f64| -> Point {
        std::array::from_fn(|k| control.iter().flatten().fold(start, |m, p| f(m, p[k])))
    };
    distance(extreme(f64::min, f64::INFINITY), extreme(f64::max, f64::NEG_INFINITY))
}

/// The shape of a seed: kinds take turns; turned at random, scaled by 1e-6 to 1e6, and in two of five cases
/// moved away by 10 to 1e5 times its size.
pub fn shape(seed: u64) -> Shape {
    let (kind, make) = KINDS[seed as usize % KINDS.len()];
    let mut r = Random::new(seed);
    let control = make(&mut r);
    let direction = r.direction();
    let axes = frame(&mut r, direction);
    let turned = |p: Point| add(scale(axes[0], p[0]), add(scale(axes[1], p[1]), scale(axes[2], p[2])));
    let factor = 10_f64.powf(r.between(-6.0, 6.0));
    let control = control.map(|row| row.map(|p| scale(turned(p), factor)));
    let size = diagonal(&control);
    let away = [0.0, 0.0, 0.0, 10.0, 1e5][r.below(5)];
    let offset = scale(r.direction(), away * size);
    Shape { kind, control: control.map(|row| row.map(|p| add(p, offset))), size, seed }
}
