//! What a field has to obey, judged by values at points alone.
use chordal::implicit::evaluation::Dual;
use chordal::implicit::{DistanceQuality, Field};
use chordal::math::{Box3, Interval};
use chordal_testkit::Random;
use chordal_testkit::sampler::distance;

const REACH: f64 = 2.5;
const POINTS: usize = 1500;

/// Values are computed with some dozens of roundings on numbers up to 10: measured errors stay below 1e-13.
const ROUNDING: f64 = 1e-11;

fn values(field: &Field, points: &[[f64; 3]]) -> Vec<f64> {
    let mut out = vec![0.0; points.len()];
    field.tape().at(points, &mut out).expect("no leaf fails");
    out
}

pub fn obey(name: &str, field: &Field) {
    let seed = name.bytes().fold(5_u64, |h, b| h.wrapping_mul(31).wrapping_add(u64::from(b)));
    eprintln!("{name}: seed {seed}");
    let mut random = Random::new(seed);
    let points: Vec<[f64; 3]> = (0..POINTS).map(|_| random.point_within(REACH)).collect();
    let at = values(field, &points);
    let quality = |v: f64| if v >= 0.0 { field.distance().outside } else { field.distance().inside };
    signs(name, field, &points, &at);
    for (p, v) in points.iter().zip(&at) {
        assert!(!v.is_nan(), "{name}: no value at {p:?}");
        assert!(
            *v >= 0.0 || field.bounds().contains(*p),
            "{name}: {p:?} has {v} outside of {:?}",
            field.bounds()
        );
    }
    // No ball of the size of the value reaches the other side.
    let mut around = Vec::new();
    for (p, v) in points.iter().zip(&at) {
        for _ in 0..8 {
            let d = random.point_within(1.0);
            let length = distance(d, [0.0; 3]);
            let by = v.abs() * random.unit().powf(0.1) / length;
            around.push(std::array::from_fn(|k| p[k] + by * d[k]));
        }
    }
    for (k, w) in values(field, &around).into_iter().enumerate() {
        let (p, v) = (points[k / 8], at[k / 8]);
        if quality(v) >= DistanceQuality::Bound {
            assert!(w * v >= 0.0 || w.abs() < ROUNDING, "{name}: {v} at {p:?}, but {w} at {:?}", around[k]);
            if quality(w) >= DistanceQuality::Bound {
                let far = distance(p, around[k]);
                assert!(
                    (v - w).abs() <= far + ROUNDING,
                    "{name}: {v} at {p:?}, {w} at {:?}, {far} off",
                    around[k]
                );
            }
        }
    }
    exact(name, field, &points, &at);
    ranges(name, field, &mut random);
}

fn signs(name: &str, field: &Field, points: &[[f64; 3]], at: &[f64]) {
    let signs = values(&Field::new(field.sign().clone()), points);
    for ((p, v), s) in points.iter().zip(at).zip(signs) {
        assert!((*v < 0.0) == (s < 0.0) || v.abs() < ROUNDING, "{name}: {v} at {p:?}, and the sign is {s}");
    }
}

/// Where the value is the distance, going that far down the slope ends on the surface, and slopes are 1.
fn exact(name: &str, field: &Field, points: &[[f64; 3]], at: &[f64]) {
    const STEP: f64 = 1e-6;
    let chosen: Vec<usize> = (0..points.len())
        .filter(|k| {
            let side = if at[*k] >= 0.0 { field.distance().outside } else { field.distance().inside };
            side == DistanceQuality::Exact && at[*k].abs() > 1e-3
        })
        .collect();
    let mut around = Vec::new();
    for k in &chosen {
        for axis in 0..3 {
            for side in [-STEP, STEP] {
                let mut p = points[*k];
                p[axis] += side;
                around.push(p);
            }
        }
    }
    let around = values(field, &around);
    let slopes: Vec<[f64; 3]> = around
        .chunks(6)
        .map(|six| [0, 1, 2].map(|axis| (six[2 * axis + 1] - six[2 * axis]) / (2.0 * STEP)))
        .collect();
    let feet: Vec<[f64; 3]> = chosen
        .iter()
        .zip(&slopes)
        .map(|(k, slope)| std::array::from_fn(|axis| points[*k][axis] - at[*k] * slope[axis]))
        .collect();
    let ends = values(field, &feet);
    let off = |k: &usize| (distance(slopes[*k], [0.0; 3]) - 1.0).abs() > 1e-5 || ends[*k].abs() > 1e-5;
    let n_off = (0..chosen.len()).filter(off).count();
    // Differences across a kink are no slopes; kinks have no volume, but a step has a width.
    assert!(200 * n_off <= chosen.len(), "{name}: {n_off} of {} are no distances", chosen.len());
}

/// Ranges hold what is in them.
fn ranges(name: &str, field: &Field, random: &mut Random) {
    for expr in [field.expr(), field.sign()] {
        let tape = Field::new(expr.clone()).tape();
        let boxes: Vec<Box3> = (0..120)
            .map(|k| {
                let (p, size) = (random.point_within(REACH), if k % 2 == 0 { 0.5 } else { 0.01 });
                Box3 { min: p, max: p.map(|x| x + size * random.unit()) }
            })
            .collect();
        let unknown = Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] };
        let mut over = vec![unknown; boxes.len()];
        tape.gradient_over(&boxes, &mut over).expect("no leaf fails");
        for (bounds, range) in boxes.iter().zip(over) {
            let points: Vec<[f64; 3]> = (0..8)
                .map(|_| {
                    std::array::from_fn(|k| bounds.min[k] + (bounds.max[k] - bounds.min[k]) * random.unit())
                })
                .collect();
            let mut at = vec![Dual { value: 0.0, gradient: [0.0; 3] }; points.len()];
            tape.gradient_at(&points, &mut at).expect("no leaf fails");
            for (p, slope) in points.iter().zip(at) {
                let holds = |range: Interval, x: f64| {
                    x.is_nan() || (range.lo() <= x + ROUNDING && x - ROUNDING <= range.hi())
                };
                assert!(
                    holds(range.value, slope.value),
                    "{name}: {} at {p:?} in {}",
                    slope.value,
                    range.value
                );
                for k in 0..3 {
                    let (all, one) = (range.gradient[k], slope.gradient[k]);
                    assert!(holds(all, one), "{name}: slope {one} along {k} at {p:?} in {all}, {bounds:?}");
                }
            }
        }
    }
}
