//! Budgets of segments: never more than asked, and the more the better.
use super::chains::chain;
use super::families::shape;
use super::lengths::check_order;
use super::measure::{Look, measure};
use super::truth::{Part, Path};
use super::{Made, cases, flatten, for_all};
use chordal::convert::Spacing;
use chordal::{Budget, Failure, Tolerance};

const COUNTS: [u64; 12] = [1, 2, 3, 4, 5, 8, 13, 40, 41, 42, 300, 1000];

/// The segments that a path needs at least: one for every piece that is not a point, three for more than half
/// a turn.
fn needed<const D: usize>(path: &Path<D>) -> u64 {
    let of = |part: &Part<D>| match part {
        Part::Arc(round) if round.sweep.abs() > 3.0 => 3,
        _ => 1,
    };
    path.parts.iter().map(of).sum()
}

/// Checks one polyline of a count; its bound, if there are enough.
fn judge<const D: usize>(name: &str, path: &Path<D>, most: u64, made: Made<D>) -> Option<f64> {
    let enough = made.is_ok();
    let made = match made {
        Ok(made) => {
            assert!(made.shape.n_segments() as u64 <= most, "{name}: {} for {most}", made.shape.n_segments());
            made
        }
        Err(Failure::Unmet(best)) => {
            assert!(needed(path) > most, "{name}: {most} is enough for {} pieces", path.parts.len());
            *best
        }
        Err(failure) => panic!("{name}: {failure}"),
    };
    check_order(name, path, &made.shape);
    let (measured, at_most) =
        (measure(path, &made.shape, Look::Quick).both(), made.bound.at_most().expect("proved"));
    assert!(measured <= at_most + path.slack(), "{name} in {most}: {measured:e} > {at_most:e}");
    enough.then_some(at_most)
}

/// The bounds of a path for more and more segments; how much worse than with fewer the worst is.
fn ladder<const D: usize>(name: &str, path: &Path<D>, spacing: Spacing) -> f64 {
    let (mut before, mut worst) = (f64::INFINITY, 1.0_f64);
    for most in COUNTS {
        let name = format!("{name}, {spacing:?}");
        let made = flatten(path, &Budget::segments(most), spacing);
        let Some(at_most) = judge(&name, path, most, made) else { continue };
        worst = worst.max(at_most / before);
        before = before.min(at_most);
    }
    worst
}

#[test]
fn a_count_is_kept_and_more_segments_are_hardly_ever_worse() {
    let worse = for_all(cases(40), |seed| {
        let shape = shape::<2>(seed);
        let path = Path::cubic(shape.control);
        let name = format!("{} (seed {seed})", shape.kind);
        if path.size() == 0.0 {
            return 1.0;
        }
        if seed % 4 == 0 {
            // Equal steps of one cubic are what was asked for: one more may be worse, and the bound is
            // checked all the same.
            ladder(&name, &path, Spacing::Even);
            return ladder(&format!("path (seed {seed})"), &chain::<3>(seed), Spacing::Fewest);
        }
        ladder(&name, &path, Spacing::Fewest)
    });
    let most = worse.iter().copied().fold(1.0, f64::max);
    let some = worse.iter().filter(|by| **by > 1.0).count();
    eprintln!(
        "of {} ladders {some} have a bound that is worse with more segments, by × {most:.3} at most",
        worse.len()
    );
    // Where a curve turns back, longest steps are not the best ones, and a rung that is passed over may hold
    // a better polyline of fewer segments: measured 16 of 400.
    assert!(20 * some <= worse.len(), "{some} of {} ladders, × {most}", worse.len());
}

#[test]
fn equal_steps_of_one_cubic_are_as_many_as_asked() {
    for seed in 0..60 {
        let path = Path::cubic(shape::<2>(15 * seed).control);
        for n in [1, 2, 7, 64] {
            let made = flatten(&path, &Budget::segments(n), Spacing::Even).expect("n steps").shape;
            let places: Vec<f64> = (0..=n).map(|i| i as f64 / n as f64).collect();
            assert_eq!(made.places, places);
        }
    }
}

#[test]
fn a_length_and_a_count_hold_together_or_the_best_is_shown() {
    let (mut kept, mut unmet) = (0, 0);
    for seed in 0..300 {
        let path = Path::cubic(shape::<2>(seed).control);
        let (size, most) = (path.size(), [3, 9, 30][seed % 3]);
        for relative in [1e-1, 1e-2, 1e-3] {
            if size == 0.0 {
                continue;
            }
            let length = relative * size;
            let budget =
                Budget { segments: Some(most), ..Budget::length(Tolerance::new(length).expect("positive")) };
            match flatten(&path, &budget, Spacing::Fewest) {
                Ok(made) => {
                    kept += 1;
                    assert!(
                        made.bound.at_most().expect("proved") <= length
                            && made.shape.n_segments() as u64 <= most
                    );
                }
                Err(Failure::Unmet(best)) => {
                    unmet += 1;
                    assert!(
                        best.bound.at_most().expect("proved") > length
                            && best.shape.n_segments() as u64 <= most
                    );
                    // It really cannot be done: with the length alone there are more.
                    let alone = flatten(&path, &super::length(length), Spacing::Fewest).expect("a length");
                    assert!(alone.shape.n_segments() as u64 > most, "seed {seed}");
                }
                Err(failure) => panic!("{failure}"),
            }
        }
    }
    assert!(kept > 100 && unmet > 100, "{kept} kept, {unmet} not");
}
