//! Our own sine and its kin: within the error that is claimed for them, against 200 bits.
use chordal::math::elementary::{self, single};
use chordal_testkit::Random;
use dashu_float::FBig;

/// A number of 200 bits, rounded to nearest.
type Big = FBig<dashu_float::round::mode::HalfEven, 2>;

/// Bits of the oracle: 53 and room for everything that a rounded oracle adds.
const BITS: usize = 200;

fn big(x: f64) -> Big {
    Big::try_from(x).expect("finite").with_precision(BITS).value()
}

/// Both signs, sizes from 2^low to 2^high.
fn sized(random: &mut Random, low: f64, high: f64) -> f64 {
    let size = (random.between(low, high) * std::f64::consts::LN_2).exp();
    if random.bits() & 1 == 0 { size } else { -size }
}

/// How far `found` is from `truth`, in u of the truth; what is below the smallest number is forgiven.
fn off(found: f64, truth: &Big) -> f64 {
    assert!(found.is_finite(), "{found} for {truth}");
    let size = truth.to_f64().value().abs();
    let error = (big(found) - truth).to_f64().value().abs();
    if error <= 5e-324 { 0.0 } else { error / size * 9_007_199_254_740_992.0 }
}

/// The largest error of a function over `arguments`, which must be below `claim`.
fn check(
    name: &str,
    claim: f64,
    arguments: impl Iterator<Item = f64>,
    f: fn(f64) -> f64,
    truth: fn(&Big) -> Big,
) {
    let mut worst = (0.0, 0.0);
    for x in arguments {
        let error = off(f(x), &truth(&big(x)));
        if error > worst.0 {
            worst = (error, x);
        }
    }
    assert!(worst.0 <= claim, "{name}({:e}) is off by {} u, claimed {claim}", worst.1, worst.0);
    // An oracle that agrees too well, or a claim that is much too wide, would be suspicious.
    assert!(
        worst.0 >= 0.5 && worst.0 * 5.0 >= claim,
        "{name}: worst {} u at {:e}, claimed {claim}",
        worst.0,
        worst.1
    );
}

/// Angles of all sizes, and those that are nearly multiples of a quarter turn.
fn angles(seed: u64) -> impl Iterator<Item = f64> {
    let mut random = Random::new(seed);
    (0..4000).map(move |k| {
        let near = (random.unit() * 65_000.0).floor() * std::f64::consts::FRAC_PI_2;
        match k % 8 {
            0 | 1 => sized(&mut random, -3.0, 3.0),
            2 => sized(&mut random, -60.0, 0.0),
            3 => sized(&mut random, 0.0, 17.0),
            4 => sized(&mut random, 17.0, 70.0),
            5 => sized(&mut random, 60.0, 1023.0),
            6 => {
                f64::from_bits(near.to_bits().wrapping_add(random.bits() % 3).wrapping_sub(1)).abs().max(1e-3)
            }
            // The f64 that is nearest of all to a multiple of π/2 (Kahan), and 29 quarter turns.
            _ => [5.319_372_648_326_541e255, 45.553_093_477_052][(k / 8) % 2],
        }
    })
}

#[test]
fn sines_cosines_and_tangents_are_within_their_claims() {
    check("sin", 2.0, angles(1), elementary::sin, Big::sin);
    check("cos", 2.0, angles(2), elementary::cos, Big::cos);
    check("tan", 6.0, angles(3), elementary::tan, Big::tan);
}

#[test]
fn exponentials_and_logarithms_are_within_their_claims() {
    let mut random = Random::new(4);
    let powers: Vec<f64> = (0..4000)
        .map(|k| match k % 4 {
            0 => sized(&mut random, -2.0, 9.4),
            1 => sized(&mut random, -40.0, 0.0),
            2 => random.unit() * 1440.0 - 735.0,
            _ => random.unit() - 0.5,
        })
        .collect();
    check("exp", 2.0, powers.into_iter().filter(|x| *x < 709.7 && *x > -745.0), elementary::exp, Big::exp);
    let mut random = Random::new(5);
    let arguments = (0..6000).map(|k| match k % 3 {
        0 => f64::from_bits(random.bits() >> 1 & 0x7fef_ffff_ffff_ffff).max(5e-324),
        1 => 1.0 + sized(&mut random, -40.0, -1.0),
        _ => 0.4 + 2.0 * random.unit(),
    });
    check("ln", 3.0, arguments, elementary::ln, Big::ln);
}

#[test]
fn angles_are_within_their_claims() {
    let mut random = Random::new(6);
    let sines: Vec<f64> = (0..3000)
        .map(|k| match k % 3 {
            0 => 2.0 * random.unit() - 1.0,
            1 => sized(&mut random, -60.0, 0.0),
            _ => {
                (1.0 - sized(&mut random, -50.0, -3.0).abs())
                    * if random.bits() & 1 == 0 { 1.0 } else { -1.0 }
            }
        })
        .filter(|x| x.abs() <= 1.0)
        .collect();
    check("asin", 10.0, sines.clone().into_iter(), elementary::asin, Big::asin);
    check("acos", 10.0, sines.into_iter(), elementary::acos, Big::acos);
    let mut random = Random::new(7);
    let mut worst = 0.0;
    for k in 0..6000 {
        let (y, x) = match k % 3 {
            0 => (sized(&mut random, -4.0, 4.0), sized(&mut random, -4.0, 4.0)),
            1 => (sized(&mut random, -1060.0, 1023.0), sized(&mut random, -1060.0, 1023.0)),
            _ => {
                let x = sized(&mut random, -1060.0, 1023.0);
                (x * sized(&mut random, -5.0, 5.0), x)
            }
        };
        if y.is_finite() {
            let error = off(elementary::atan2(y, x), &big(y).atan2(&big(x)));
            assert!(error <= 10.0, "atan2({y:e}, {x:e}) is off by {error} u");
            worst = if error > worst { error } else { worst };
        }
    }
    assert!(worst > 1.5, "{worst}");
}

#[test]
fn special_arguments_have_their_values() {
    use elementary::{acos, asin, atan, atan2, cos, exp, ln, sin, tan};
    let (inf, pi) = (f64::INFINITY, std::f64::consts::PI);
    for x in [f64::NAN, inf, -inf] {
        assert!(
            sin(x).is_nan() && cos(x).is_nan() && tan(x).is_nan() && asin(x).is_nan() && acos(x).is_nan()
        );
    }
    assert!(exp(f64::NAN).is_nan() && ln(f64::NAN).is_nan() && ln(-5e-324).is_nan() && ln(-inf).is_nan());
    assert_eq!((exp(0.0), exp(inf), exp(-inf), exp(710.0), exp(-746.0)), (1.0, inf, 0.0, inf, 0.0));
    assert_eq!((exp(-745.0), ln(0.0), ln(inf), ln(1.0)), (5e-324, -inf, inf, 0.0));
    assert_eq!((asin(1.0), asin(-1.0), acos(1.0), acos(-1.0)), (pi / 2.0, -pi / 2.0, 0.0, pi));
    assert_eq!(
        (atan(inf), atan(-inf), atan2(inf, -inf), atan2(-inf, inf)),
        (pi / 2.0, -pi / 2.0, 0.75 * pi, -pi / 4.0)
    );
    for f in [sin, tan, asin, atan] {
        assert!(f(0.0).to_bits() == 0 && f(-0.0).to_bits() == 1 << 63);
        assert_eq!((f(5e-324), f(-1e-310)), (5e-324, -1e-310));
    }
    for (y, x) in [
        (0.0, 0.0),
        (-0.0, 0.0),
        (0.0, -0.0),
        (-0.0, -0.0),
        (0.0, -1.0),
        (-0.0, -inf),
        (1.0, inf),
        (-1.0, -inf),
    ] {
        assert_eq!(atan2(y, x).to_bits(), libm::atan2(y, x).to_bits(), "{y} {x}");
    }
    assert!(
        atan2(f64::NAN, 1.0).is_nan() && atan2(0.0, f64::NAN).is_nan() && asin(1.0_f64.next_up()).is_nan()
    );
}

#[test]
fn the_f32_functions_are_as_near_as_they_say() {
    let mut random = Random::new(8);
    let mut worst = [0.0_f64; 7];
    for _ in 0..200_000 {
        let angle = sized(&mut random, -6.0, 12.6) as f32;
        let part = (2.0 * random.unit() - 1.0) as f32;
        let (a, b) = (sized(&mut random, -20.0, 20.0) as f32, sized(&mut random, -20.0, 20.0) as f32);
        let (power, positive) =
            ((170.0 * random.unit() - 85.0) as f32, sized(&mut random, -120.0, 120.0).abs() as f32);
        let f = f64::from;
        let relative = |found: f32, truth: f64| ((f(found) - truth) / truth).abs();
        let errors = [
            (f(single::sin(angle)) - f(angle).sin()).abs(),
            (f(single::cos(angle)) - f(angle).cos()).abs(),
            relative(single::exp(power), f(power).exp()),
            relative(single::ln(positive), f(positive).ln()),
            relative(single::atan2(a, b), f(a).atan2(f(b))),
            relative(single::asin(part), f(part).asin()),
            relative(single::acos(part), f(part).acos()),
        ];
        for (most, error) in worst.iter_mut().zip(errors) {
            *most = if error > *most { error } else { *most };
        }
    }
    let unit = 2.0_f64.powi(-23);
    assert!(worst[..2].iter().all(|error| *error <= unit), "{worst:?}");
    assert!(worst[2..].iter().all(|error| *error <= 4.0 * unit), "{worst:?}");
    assert!(single::sin(1e9).is_finite() && single::ln(-1.0).is_nan() && single::exp(200.0) == f32::INFINITY);
    assert_eq!(
        (single::ln(0.0), single::exp(-200.0), single::ln(1e-44) < -100.0),
        (f32::NEG_INFINITY, 0.0, true)
    );
}
