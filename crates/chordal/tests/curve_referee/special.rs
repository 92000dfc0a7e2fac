//! Cubics at the edges of what numbers can do: large, small, far away, and all that coincides.
use super::families::shape;
use super::for_all;
use super::lengths::{Case, check, judge};
use super::truth::{Control, Path};
use chordal::convert::Spacing;
use chordal_testkit::Random;
use chordal_testkit::{cases, is_long};

const SPACINGS: [Spacing; 2] = [Spacing::Fewest, Spacing::Even];

/// All cubics of 15 families, moved or scaled.
fn mapped(seed: usize, scale: f64, offset: [f64; 2]) -> Path<2> {
    let control: Control<2> = shape::<2>(seed).control;
    let size = Path::cubic(control).size().max(1e-300);
    let unit = control.map(|p| p.map(|x| x / size));
    Path::cubic(unit.map(|p| std::array::from_fn(|k| scale * p[k] + offset[k])))
}

fn all(n: usize, path: impl Fn(usize) -> Path<2> + Sync, tolerances: &[f64]) -> Vec<Case> {
    let found = for_all(n, |seed| {
        let path = path(seed);
        let cases = tolerances.iter().flat_map(|tolerance| {
            SPACINGS
                .iter()
                .filter_map(|s| judge(format!("{s:?}, seed {seed}, {path:?}"), &path, *tolerance, *s))
        });
        cases.collect::<Vec<_>>()
    });
    let found: Vec<Case> = found.into_iter().flatten().collect();
    found.iter().for_each(check);
    found
}

#[test]
fn bounds_hold_at_every_scale() {
    for scale in [1e-120, 1e-100, 1e-60, 1e-6, 1e6, 1e60, 1e100, 1e140] {
        let found = all(60, |seed| mapped(seed, scale, [0.0; 2]), &[1e-1, 1e-3]);
        assert!(found.len() > 200, "only {} of 240 were within reach at {scale:e}", found.len());
    }
}

#[test]
fn the_same_shape_at_another_scale_has_the_same_points() {
    // Powers of two change no digit.
    let points = |seed: usize, exponent: i32| {
        let scale = 2_f64.powi(exponent);
        let control = shape::<2>(seed).control.map(|p| p.map(|x| x * scale));
        let path = Path::cubic(control);
        let made =
            super::flatten(&path, &super::length(1e-3 * path.size()), Spacing::Fewest).expect("within reach");
        made.shape.points.iter().map(|p| p.map(|x| x / scale)).collect::<Vec<_>>()
    };
    for seed in (0..150).filter(|seed| Path::cubic(shape::<2>(*seed).control).size() > 0.0) {
        for exponent in [-300, -20, 20, 300] {
            assert_eq!(points(seed, 0), points(seed, exponent), "seed {seed}, 2^{exponent}");
        }
    }
}

#[test]
fn bounds_hold_far_from_the_origin_down_to_rounding() {
    // Details of 1e-3 at 1e6: their own rounding is 1e-10, what the bound must add 5e-7.
    let path = |seed: usize| {
        let r = &mut Random::new(seed as u64);
        let offset = [r.between(-1e6, 1e6), 1e6];
        mapped(seed, 1e-3, offset)
    };
    let found = all(300, path, &[0.5, 1e-1, 1e-2, 2e-3, 6e-4]);
    assert!(found.len() > 2000, "{}", found.len());
    // Right at the end of what can be asked, rounding is nearly all of the bound.
    let edge = |seed: usize| {
        let r = &mut Random::new(seed as u64);
        mapped(seed, r.power(-9.0, -3.0), [3e5, r.between(-1e6, 1e6)])
    };
    let found = all(300, edge, &[1e3, 1.0, 0.7, 0.3, 0.1, 0.01]);
    let most = found
        .iter()
        .filter(|case| case.at_most > 0.0)
        .map(|case| case.measured / case.at_most)
        .fold(0.0, f64::max);
    eprintln!("far away: {} polylines, measured/at_most up to {most}", found.len());
}

#[test]
fn bounds_hold_where_coordinates_have_few_digits_or_many_sizes() {
    let path = |seed: usize| {
        let r = &mut Random::new(seed as u64);
        // Every coordinate has a size of its own; some cancel against others.
        let far = r.power(-3.0, 3.0);
        let mut coordinate = || match r.below(5) {
            0 => far,
            1 => -far,
            2 => far.next_up(),
            3 => far * r.power(-17.0, 0.0),
            _ => r.power(-20.0, 0.0),
        };
        Path::cubic(std::array::from_fn(|_| [coordinate(), coordinate()]))
    };
    all(cases(25), path, &[1e-1, 1e-3]);
    all(if is_long() { 250 } else { 5 }, path, &[1e-6]);
}

#[test]
fn bounds_hold_wherever_points_coincide() {
    // Four points of a row of three places and of a square: every way to coincide.
    let row =
        |seed: usize| Path::cubic(std::array::from_fn(|i| [(seed / 3_usize.pow(i as u32) % 3) as f64, 0.0]));
    let finest = if is_long() { 1e-5 } else { 1e-3 };
    // By default a third and a fourth of them, in steps that have no factor in common with their number.
    let (n_row, n_square) = if is_long() { (81, 256) } else { (27, 64) };
    all(n_row, |seed| row(10 * seed % 81), &[0.3, 1e-2, finest]);
    let square = |seed: usize| {
        let corner = |i: usize| seed / 4_usize.pow(i as u32) % 4;
        Path::cubic(std::array::from_fn(|i| [(corner(i) % 2) as f64, (corner(i) / 2) as f64]))
    };
    all(n_square, |seed| square(37 * seed % 256), &[0.3, 1e-2, finest]);
}

#[test]
fn a_curve_that_turns_back_on_a_line_reaches_as_far_as_it_goes() {
    // linebender/kurbo#426: there and back and there again.
    let path = Path::cubic([[0.0, 0.0], [2.0, 0.0], [-1.0, 0.0], [1.0, 0.0]]);
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let made =
            super::flatten(&path, &super::length(tolerance), Spacing::Fewest).expect("within reach").shape;
        let at = |t: f64| 6.0 * t * (1.0 - t).powi(2) - 3.0 * t * t * (1.0 - t) + t.powi(3);
        // The derivative 6 − 30t + 30t² vanishes at ½ ± √(1/20).
        let turns = [0.5 - 0.05_f64.sqrt(), 0.5 + 0.05_f64.sqrt()].map(at);
        for turn in turns {
            let least = made.points.iter().map(|p| (p[0] - turn).abs()).fold(f64::INFINITY, f64::min);
            assert!(least <= tolerance, "the turn at {turn} is missed by {least:e} at {tolerance:e}");
        }
        assert!(made.points.iter().all(|p| p[1] == 0.0));
    }
}
