//! Paths of many pieces of all kinds, open and closed, and many paths at once.
use super::families::shape;
use super::lengths::{check, judge};
use super::truth::{Part, Path, Round};
use super::{for_all, length};
use chordal::convert::{Spacing, curves_to_polylines};
use chordal::{Budget, Job};
use chordal_testkit::{Random, is_long};

/// A path of 1 to 12 pieces, some of them points.
pub fn chain<const D: usize>(seed: usize) -> Path<D> {
    let r = &mut Random::new(seed as u64 + 4242);
    let (n, first) = (1 + r.below(12), r.point());
    let mut at: [f64; D] = first;
    let mut parts = Vec::new();
    for i in 0..n {
        let to: [f64; D] = if r.below(8) == 0 { at } else { r.point() };
        let part = match r.below(6) {
            0 => Part::Line([at, to]),
            1 => {
                // Half a turn about the middle; its ends are those of the path.
                let centre = std::array::from_fn(|k| 0.5 * (at[k] + to[k]));
                let axes = [std::array::from_fn(|k| at[k] - centre[k]), r.point()];
                let sweep = std::f64::consts::PI * [1.0, -1.0][r.below(2)];
                Part::Arc(Round { centre, axes, start: 0.0, sweep, ends: Some([at, to]) })
            }
            2 => Part::Cubic([at, at, to, to]),
            _ => {
                let inner = shape::<D>(15 * seed + i).control;
                let by = if r.below(2) == 0 { 1.0 } else { 1e-3 };
                Part::Cubic([
                    at,
                    inner[1].map(|x| by * x.clamp(-9.0, 9.0)),
                    inner[2].map(|x| by * x.clamp(-9.0, 9.0)),
                    to,
                ])
            }
        };
        parts.push(part);
        at = to;
    }
    let closed = r.below(2) == 0;
    if closed {
        parts.push(Part::Line([at, first]));
    }
    Path { parts, closed }
}

#[test]
fn no_polyline_is_further_from_its_path_than_its_bound() {
    for_all(if is_long() { 6000 } else { 200 }, |seed| {
        for tolerance in [1e-1, 1e-2, 1e-4] {
            for spacing in [Spacing::Fewest, Spacing::Even] {
                let name = format!("path (seed {seed})");
                let (found, size) = if seed % 2 == 0 {
                    let path = chain::<2>(seed);
                    (judge(name, &path, tolerance, spacing), path.size())
                } else {
                    let path = chain::<3>(seed);
                    (judge(name, &path, tolerance, spacing), path.size())
                };
                if size == 0.0 {
                    // All its pieces are the same point.
                    continue;
                }
                let mut case = found.expect("within reach");
                // Arcs have no more digits than the slack allows for.
                case.measured = (case.measured - case.slack).max(0.0);
                check(&case);
            }
        }
    });
}

#[test]
fn many_paths_are_each_what_they_are_alone() {
    let paths: Vec<Path<2>> = (0..200).map(chain).collect();
    let curves: Vec<_> = paths.iter().map(Path::library).collect();
    for spacing in [Spacing::Fewest, Spacing::Even] {
        let budget = length(1e-3);
        let together = curves_to_polylines(&curves, &budget, &Job::default(), spacing).expect("within reach");
        let mut most = 0.0_f64;
        for (path, made) in paths.iter().zip(&together.shape) {
            let alone = super::flatten(path, &budget, spacing).expect("within reach");
            assert_eq!(&alone.shape, made);
            most = most.max(alone.bound.at_most().expect("proved"));
        }
        assert_eq!(together.bound.at_most(), Some(most));
    }
    let none = curves_to_polylines::<2>(&[], &Budget::segments(5), &Job::default(), Spacing::Fewest)
        .expect("nothing to do");
    assert!(none.shape.is_empty() && none.bound.at_most() == Some(0.0));
}

#[test]
fn what_was_lost_before_is_in_the_bound() {
    for slack in [1e-9, 1e-3, 0.05] {
        for seed in 0..40 {
            let curve = chain::<2>(seed).library().with_slack(slack);
            let job = Job::default().with_threads(1);
            let made = chordal::convert::curve_to_polyline(&curve, &length(0.1), &job).expect("within reach");
            let at_most = made.bound.at_most().expect("proved");
            assert!(at_most <= 0.1 && at_most >= slack);
            // What was found may be undone by what was lost.
            assert!(made.bound.at_least() <= (at_most - slack).max(0.0));
        }
    }
}
