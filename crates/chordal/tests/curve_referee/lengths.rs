//! Bounds in units against the truth, on random cubics of all kinds at every tolerance.
use super::families::shape;
use super::measure::{Look, distance, measure, witnessed};
use super::truth::{Part, Path};
use super::{flatten, for_all, length, quantile};
use chordal::budget::RefusalCode;
use chordal::convert::Spacing;
use chordal::convert::batch::BezierCutter;
use chordal::explicit::Polyline;
use chordal::{Bezier, Failure, Tolerance};
use chordal_testkit::is_long;
use std::fmt;

/// One polyline, measured.
#[derive(Clone, Debug)]
pub struct Case {
    pub name: String,
    /// Relative to the size.
    pub tolerance: f64,
    pub budget: f64,
    pub at_least: f64,
    pub at_most: f64,
    pub measured: f64,
    /// How far off the referee may be where it does not count with twice the digits.
    pub slack: f64,
    pub segments: usize,
}

impl Case {
    /// Whether the polyline is further away than `part` of what was promised. The last distance has twice the
    /// digits, so that only arcs and the way back need slack.
    pub fn is_over(&self, part: f64) -> bool {
        self.measured * (1.0 - 1e-14) > part * self.at_most
    }

    /// Whether there was something to lose that rounding does not hide.
    pub fn is_lossy(&self) -> bool {
        self.measured > 1e4 * self.slack
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, tolerance, budget, at_least, at_most, measured, slack, segments } = self;
        write!(
            f,
            "{name} at {tolerance:e}: measured {measured:e} ± {slack:e} of {segments} segments, bound [{at_least:e}, {at_most:e}], budget {budget:e}"
        )
    }
}

/// Whether a polyline is one of its path: from end to end, in order, on the path, with a vertex wherever a
/// piece ends.
pub fn check_order<const D: usize>(name: &str, path: &Path<D>, made: &Polyline<D>) {
    let (points, places) = (&made.points, &made.places);
    let n = points.len();
    assert_eq!(n, places.len(), "{name}: a place for each point");
    assert_eq!(made.closed, path.closed, "{name}");
    // The ends of an arc that were not given are a sine and a cosine, here those of another library.
    let same = |part: &Part<D>, end: [f64; D], point: &[f64; D]| match part {
        Part::Arc(round) if round.ends.is_none() => distance(end, *point) <= path.slack(),
        _ => end == *point,
    };
    let last = path.parts[path.parts.len() - 1];
    assert!(same(&path.parts[0], path.parts[0].ends()[0], &points[0]), "{name}: the start");
    assert!(made.closed || same(&last, last.ends()[1], &points[n - 1]), "{name}: the end");
    assert!(places.windows(2).all(|pair| pair[0] < pair[1]), "{name}: places grow");
    let distinct = |a: &[f64; D], b: &[f64; D]| a != b;
    assert!(points.windows(2).all(|pair| distinct(&pair[0], &pair[1])), "{name}: points differ");
    assert!(!made.closed || n == 1 || distinct(&points[n - 1], &points[0]), "{name}: points differ");
    for (point, place) in points.iter().zip(places) {
        let part = (place.floor() as usize).min(path.parts.len() - 1);
        let t = place - part as f64;
        let ends = path.parts[part].ends();
        let on = if t == 0.0 {
            ends[0]
        } else if t == 1.0 {
            ends[1]
        } else {
            path.parts[part].at(t)
        };
        // A place in the path has fewer digits than its parameter: some ulp of the number of pieces, times
        // the speed.
        let blur = 8.0 * path.size() * path.parts.len() as f64 * f64::EPSILON;
        assert!(distance(on, *point) <= path.slack() + blur, "{name}: the point at {place} is on the path");
    }
    for (index, part) in path.parts.iter().enumerate() {
        let start = part.ends()[0];
        assert!(points.iter().any(|p| same(part, start, p)), "{name}: piece {index} starts at a vertex");
    }
}

/// Measures one polyline; none where rounding alone is more than the budget.
pub fn judge<const D: usize>(name: String, path: &Path<D>, tolerance: f64, spacing: Spacing) -> Option<Case> {
    let budget = tolerance * path.size();
    if budget == 0.0 {
        return None;
    }
    let made = match flatten(path, &length(budget), spacing) {
        Ok(made) => made,
        Err(Failure::Refused(why))
            if why.code == RefusalCode::BelowPrecision && budget < 1e3 * path.slack() =>
        {
            return None;
        }
        Err(failure) => panic!("{name} at {tolerance:e} of {:e}: {failure}", path.size()),
    };
    check_order(&name, path, &made.shape);
    let at_least = made.bound.at_least();
    let mut measured = measure(path, &made.shape, Look::Quick).both();
    if at_least > measured {
        // A place that the samples missed: the library says where it is.
        let at = made.bound.at.expect("a distance was found somewhere");
        let at = std::array::from_fn(|k| at[k]);
        measured = measured
            .max(witnessed(path, &made.shape, at))
            .max(measure(path, &made.shape, Look::Close).both());
    }
    let at_most = made.bound.at_most().expect("proved");
    let promised = promised_by_cutter(&name, path, budget, spacing, &made.shape);
    Some(Case {
        name,
        tolerance,
        budget,
        at_least,
        at_most: at_most.min(promised),
        measured,
        slack: path.slack(),
        segments: made.shape.n_segments(),
    })
}

/// What the cutter for inner loops promises of a cubic, and that its points are those of the path.
fn promised_by_cutter<const D: usize>(
    name: &str,
    path: &Path<D>,
    budget: f64,
    spacing: Spacing,
    made: &Polyline<D>,
) -> f64 {
    let [Part::Cubic(control)] = path.parts[..] else { return f64::INFINITY };
    let tolerance = Tolerance::new(budget).expect("a positive length");
    let mut cutter = BezierCutter::new(tolerance, spacing).expect("a sane machine");
    let mut points = vec![control[0]];
    let bound = cutter.append(&Bezier { control }, &mut points);
    let bound = bound.unwrap_or_else(|failure| panic!("{name}: {failure}"));
    // A path has no two equal points in a row.
    points.dedup();
    assert!(points == made.points, "{name}: {} and {} points", points.len(), made.points.len());
    assert!(bound <= budget, "{name}: {bound:e} > {budget:e}");
    bound
}

/// What must hold for every case.
pub fn check(case: &Case) {
    assert!(!case.is_over(1.0), "over its bound: {case}");
    assert!(case.at_most <= case.budget, "over its budget: {case}");
    // What the library says it found, the referee finds too.
    assert!(case.at_least <= case.measured * (1.0 + 1e-6) + case.slack, "at_least is too high: {case}");
}

const TOLERANCES: [f64; 5] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5];

fn judge_seed(seed: usize, spacing: Spacing) -> Vec<Case> {
    // Equal steps are the more, the finer: by default every third shape has the last.
    let is_whole = spacing == Spacing::Fewest || seed.is_multiple_of(3) || is_long();
    let tolerances = if is_whole { &TOLERANCES[..] } else { &TOLERANCES[..4] };
    let cases = tolerances.iter().filter_map(|tolerance| {
        // The plane and space in turn, for every kind.
        if (seed / 15).is_multiple_of(2) {
            let shape = shape::<2>(seed);
            judge(format!("{} (seed {seed})", shape.kind), &Path::cubic(shape.control), *tolerance, spacing)
        } else {
            let shape = shape::<3>(seed);
            judge(
                format!("{} (seed {seed}, in space)", shape.kind),
                &Path::cubic(shape.control),
                *tolerance,
                spacing,
            )
        }
    });
    cases.collect()
}

fn sweep(n: usize, spacing: Spacing) -> Vec<Case> {
    let all = for_all(n, |seed| judge_seed(seed, spacing));
    let all: Vec<Case> = all.into_iter().flatten().collect();
    all.iter().for_each(check);
    all
}

fn report(what: &str, cases: &[&Case]) -> f64 {
    let mut ratios: Vec<f64> =
        cases.iter().filter(|c| c.is_lossy()).map(|c| c.at_most / c.measured).collect();
    let n = ratios.len();
    let [least, low, median, high, most] = [0.0, 0.1, 0.5, 0.9, 1.0].map(|q| quantile(&mut ratios, q));
    eprintln!(
        "{what}: at_most/measured of {n} lossy polylines of {}: least {least:.6}, 10 % {low:.4}, median {median:.4}, 90 % {high:.3}, \
         most {most:.2}",
        cases.len()
    );
    median
}

/// The referee sees bounds that are cut.
fn check_teeth(cases: &[&Case]) {
    let lossy: Vec<_> = cases.iter().filter(|case| case.is_lossy()).collect();
    for (part, least) in [(0.9, 0.5), (0.7, 0.75)] {
        let caught = lossy.iter().filter(|case| case.is_over(part)).count();
        let share = caught as f64 / lossy.len() as f64;
        eprintln!("of bounds cut to {part}, {caught} of {} are caught", lossy.len());
        assert!(share >= least, "only {caught} of {} bounds cut to {part} were caught", lossy.len());
    }
}

#[test]
fn no_polyline_is_further_from_its_cubic_than_its_bound() {
    let all = sweep(if is_long() { 21_000 } else { 700 }, Spacing::Fewest);
    let every: Vec<&Case> = all.iter().collect();
    for tolerance in TOLERANCES {
        let here: Vec<&Case> = all.iter().filter(|case| case.tolerance == tolerance).collect();
        let median = report(&format!("{tolerance:e}"), &here);
        assert!(median <= 1.3, "half of the bounds are more than {median} times the distance");
    }
    let mut kinds: Vec<&str> = all.iter().map(|case| case.name.split(" (").next().unwrap_or("")).collect();
    kinds.sort_unstable();
    kinds.dedup();
    for kind in kinds {
        let here: Vec<&Case> =
            all.iter().filter(|case| case.name.starts_with(&format!("{kind} ("))).collect();
        report(kind, &here);
    }
    check_teeth(&every);
}

#[test]
fn no_polyline_of_equal_steps_is_further_from_its_cubic_than_its_bound() {
    let all = sweep(if is_long() { 420 } else { 30 }, Spacing::Even);
    let every: Vec<&Case> = all.iter().collect();
    let median = report("equal steps", &every);
    assert!(median <= 1.3, "half of the bounds are more than {median} times the distance");
}
