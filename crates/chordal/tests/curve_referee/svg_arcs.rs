//! Arcs from their ends, as SVG gives them, against the ellipse in numbers of twice the digits.
use super::double::Double;
use chordal::convert::curve_to_polyline;
use chordal::explicit::parametric::SvgArcShape;
use chordal::explicit::{Arc, Curve, CurveEnds, CurveSegment};
use chordal::{Budget, Job, Tolerance};
use chordal_testkit::{Random, cases};

/// Sine and cosine: Taylor's series of a small part of the angle, doubled again and again.
fn sin_cos(angle: f64) -> [Double; 2] {
    const HALVINGS: i32 = 10;
    let x = Double::from(angle * 0.5_f64.powi(HALVINGS));
    let square = x.times(x);
    let (mut sin, mut cos): (Double, Double) = (0.0.into(), 0.0.into());
    for k in (0..12).rev() {
        let next = |n: f64| square.over(((n + 1.0) * (n + 2.0)).into());
        let k = f64::from(k);
        sin = Double::from(1.0).minus(next(2.0 * k + 1.0).times(sin));
        cos = Double::from(1.0).minus(next(2.0 * k).times(cos));
    }
    sin = sin.times(x);
    for _ in 0..HALVINGS {
        let double = sin.times(cos);
        (sin, cos) = (double.plus(double), cos.times(cos).minus(sin.times(sin)));
    }
    [sin, cos]
}

/// The true ellipse and the middle of the arc.
struct Ellipse {
    centre: [Double; 2],
    sin_cos: [Double; 2],
    radii: [Double; 2],
    middle: [Double; 2],
}

impl Ellipse {
    fn new(from: [f64; 2], step: [Double; 2], shape: &SvgArcShape) -> Self {
        let half: Double = 0.5.into();
        let half_step = step.map(|x| x.times(half));
        let sin_cos = sin_cos(shape.rotation_rad);
        let [sin, cos] = sin_cos;
        // From the middle of the chord to the start, which is minus half the step.
        let minus = |x: Double| Double::from(0.0).minus(x);
        let [x, y] = half_step.map(minus);
        let turned = [x.times(cos).plus(y.times(sin)), y.times(cos).minus(x.times(sin))];
        let p = [0, 1].map(|k| turned[k].over(shape.radii[k].into()));
        let square = p[0].times(p[0]).plus(p[1].times(p[1]));
        let left = Double::from(1.0).minus(square);
        let grown = if left.value() <= 0.0 { square.root() } else { 1.0.into() };
        let height = if left.value() <= 0.0 { 0.0.into() } else { left.root() };
        let length = square.root();
        let across = [p[1].over(length), minus(p[0]).over(length)];
        let side = if shape.large == shape.positive { -1.0 } else { 1.0 };
        let away = Double::from(if shape.large { side } else { -side });
        let radii = shape.radii.map(|r| Double::from(r).times(grown));
        let back = |u: [Double; 2]| {
            let [x, y] = [u[0].times(radii[0]), u[1].times(radii[1])];
            [x.times(cos).minus(y.times(sin)), x.times(sin).plus(y.times(cos))]
        };
        let c = back(across.map(|x| x.times(height).times(side.into())));
        let w = back(across.map(|x| x.times(away)));
        let centre = [0, 1].map(|k| Double::from(from[k]).plus(half_step[k]).plus(c[k]));
        Self { centre, sin_cos, radii, middle: [0, 1].map(|k| centre[k].plus(w[k])) }
    }

    /// The distance of a point that is near: what is missing to 1, over its slope.
    fn distance(&self, p: [f64; 2]) -> f64 {
        let [sin, cos] = self.sin_cos;
        let d = [0, 1].map(|k| Double::from(p[k]).minus(self.centre[k]));
        let u = [
            d[0].times(cos).plus(d[1].times(sin)).over(self.radii[0]),
            d[1].times(cos).minus(d[0].times(sin)).over(self.radii[1]),
        ];
        let off = u[0].times(u[0]).plus(u[1].times(u[1])).minus(1.0.into()).value();
        let slope = 2.0 * (u[0].over(self.radii[0]).value()).hypot(u[1].over(self.radii[1]).value());
        (off / slope).abs()
    }
}

/// A random arc: its start, its step and its shape. Chords are long, short, or nearly as long as the ellipse allows.
fn random_arc(random: &mut Random) -> ([f64; 2], [f64; 2], SvgArcShape) {
    let size = 10_f64.powf(3.0 * random.unit() - 1.0);
    let (angle, rotation_rad) =
        (6.0 * random.unit(), if random.unit() < 0.3 { 0.0 } else { 3.0 * random.unit() });
    let step = [size * angle.cos(), size * angle.sin()];
    let radius = size * 10_f64.powf(6.5 * random.unit() - 0.5);
    let radii = match random.unit() {
        kind if kind < 0.4 => [radius; 2],
        kind if kind < 0.8 => [radius, radius * 10_f64.powf(2.0 * random.unit() - 1.0)],
        // Half the chord, so that it is nearly half a circle, or exactly.
        _ => [0.5 * size; 2],
    };
    let [large, positive] = [0; 2].map(|_| random.unit() < 0.5);
    let from = [0; 2].map(|_| 200.0 * random.unit());
    (from, step, SvgArcShape { radii, rotation_rad, large, positive })
}

#[test]
fn points_of_an_arc_from_its_ends_are_on_the_ellipse() {
    let (mut worst, mut largest_slack) = (0.0_f64, 0.0_f64);
    for seed in 0..cases(20_000) {
        let mut random = Random::new(seed as u64);
        let (from, step, shape) = random_arc(&mut random);
        let arc = Arc::through_step(from, step, &shape).expect("an arc");
        let truth = Ellipse::new(from, step.map(Double::from), &shape);
        // What an evaluation may lose, of coordinates, the ends' and the height's: as flattening counts it.
        let [low, high] = arc.bounds();
        let reach: f64 = [0, 1].map(|k| low[k].abs().max(high[k].abs())).iter().sum();
        let may = arc.slack() + 64.0 * f64::EPSILON * reach;
        for i in 0..=16 {
            let off = truth.distance(arc.at(f64::from(i) / 16.0));
            assert!(off <= may, "seed {seed}: {shape:?} from {from:?} by {step:?}: {off} > {may}");
            worst = worst.max(off / may);
        }
        let middle = arc.at(0.5);
        let off = [0, 1].map(|k| truth.middle[k].minus(middle[k].into()).value());
        assert!(off[0].hypot(off[1]) <= may, "seed {seed}: the middle is off by {off:?}, which {may} denies");
        if shape.radii[0] == shape.radii[1] && !shape.large {
            largest_slack = largest_slack.max(arc.slack() / reach);
        }
    }
    // However long the radius: measured 1.5e-13, at half a circle.
    assert!(largest_slack < 1e-12, "{largest_slack}");
    assert!(worst > 1e-3, "the slack is far more than what is lost: {worst}");
}

#[test]
fn an_arc_of_a_radius_of_a_million_chords_keeps_a_length_of_its_ten_millionth() {
    for seed in 0..cases(400) {
        let mut random = Random::new(seed as u64);
        let (from, step, shape) = random_arc(&mut random);
        let shape = SvgArcShape { large: false, ..shape };
        let arc = Arc::through_step(from, step, &shape).expect("an arc");
        let truth = Ellipse::new(from, step.map(Double::from), &shape);
        let curve = Curve::new(vec![CurveSegment::Arc(arc)], CurveEnds::Open).expect("a path");
        for tolerance in [1e-4, 1e-7] {
            let budget = Budget::length(Tolerance::new(tolerance).expect("a length"));
            let made = curve_to_polyline(&curve, &budget, &Job::default()).expect("a polyline");
            assert!(made.bound.at_most().expect("a bound") <= tolerance);
            for pair in made.shape.points.windows(2) {
                let middle = [0, 1].map(|k| 0.5 * pair[0][k] + 0.5 * pair[1][k]);
                let off = truth.distance(middle);
                assert!(off <= tolerance * 1.001, "seed {seed}: {off} at {tolerance}");
            }
        }
    }
}

#[test]
fn a_crown_survives_a_way_there_and_back() {
    let shape = SvgArcShape { radii: [3e6, 1e6], rotation_rad: 0.4, large: false, positive: true };
    let arc = Arc::through([1.0, 2.0], [3.0, 1.0], &shape).expect("an arc");
    let curve = Curve::new(vec![CurveSegment::Arc(arc)], CurveEnds::Open).expect("a path");
    let turned = curve.reversed();
    for i in 0..=8 {
        let t = f64::from(i) / 8.0;
        let (p, q) = (curve.at(t), turned.at(1.0 - t));
        assert!((p[0] - q[0]).hypot(p[1] - q[1]) < 1e-15, "{p:?} {q:?}");
        let h = 1e-4;
        let along = curve.segments()[0].tangent(t);
        if t > 0.0 && t < 1.0 {
            let (a, b) = (curve.at(t - h), curve.at(t + h));
            let slope = [0, 1].map(|k| (b[k] - a[k]) / (2.0 * h));
            assert!((slope[0] - along[0]).hypot(slope[1] - along[1]) < 1e-9);
        }
    }
    assert!(turned.slack() == curve.slack() && curve.slack() < 1e-12);
}
