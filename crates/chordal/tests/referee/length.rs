//! Bounds in units against the truth, on random patches at every tolerance.
use super::cracks::quilt;
use super::shapes::{KINDS, shape};
use super::{for_all, is_long, mesh_within, quantile};
use chordal_testkit::sampler::{Control, Surface, Triangles, measure};
use chordal_testkit::some;
use std::fmt;

/// One mesh, measured.
#[derive(Clone, Debug)]
pub struct Case {
    pub kind: &'static str,
    pub seed: u64,
    /// Relative to the size.
    pub tolerance: f64,
    pub budget: f64,
    pub at_least: f64,
    pub at_most: f64,
    /// What the sampler found, proved from below.
    pub measured: f64,
    /// How far off the sampler itself may be: its rounding.
    pub slack: f64,
}

impl Case {
    /// Whether the mesh is further away than `part` of what was promised.
    pub fn is_over(&self, part: f64) -> bool {
        self.measured > part * self.at_most + self.slack
    }

    /// Whether there was something to lose that rounding does not hide.
    pub fn is_lossy(&self) -> bool {
        self.measured > 1e3 * self.slack
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, seed, tolerance, budget, at_least, at_most, measured, slack } = self;
        write!(
            f,
            "{kind} (seed {seed}) at {tolerance:e}: measured {measured:e} ± {slack:e}, bound [{at_least:e}, {at_most:e}], budget {budget:e}"
        )
    }
}

/// Measures the library's mesh of one patch at a tolerance relative to its size.
pub fn judge(seed: u64, tolerance: f64) -> Case {
    let shape = shape(seed);
    let budget = tolerance * shape.size;
    let made = mesh_within(&[shape.control], budget);
    let surface = Surface::new(vec![shape.control]);
    let mesh = Triangles::new(made.shape.positions(), made.shape.faces());
    let measured = measure(&surface, &mesh).both();
    Case {
        kind: shape.kind,
        seed,
        tolerance,
        budget,
        at_least: made.bound.at_least(),
        at_most: made.bound.at_most().expect("proved"),
        measured,
        slack: rounding(&shape.control),
    }
}

/// The sampler's own rounding: some thirty operations on coordinates of this size, and what it leaves
/// unproved is taken off its claims, not put here.
pub fn rounding(control: &Control) -> f64 {
    let most = control.iter().flatten().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    64.0 * f64::EPSILON * most
}

/// The finest, where a mesh has 1e5 triangles, in the long sweep alone.
fn tolerances() -> &'static [f64] {
    let all = &[1e-1, 1e-2, 1e-3, 1e-4, 1e-5];
    if is_long() { all } else { &all[..4] }
}

/// One shape in 28 at the three coarse tolerances; at a fine one, where a mesh has 1e4 triangles, a single
/// one. All in the long sweep.
fn cases() -> Vec<(u64, f64)> {
    const SHAPES: u64 = 504;
    let every = |tolerance: f64| match tolerance {
        _ if is_long() => 1,
        t if t < 2e-4 => 2 * SHAPES,
        _ => 28,
    };
    let wanted = |&(seed, t): &(u64, f64)| (seed / 14 + seed) % every(t) == 0;
    let all = tolerances().iter().flat_map(|&t| (0..SHAPES).map(move |seed| (seed, t)));
    all.filter(wanted).collect()
}

/// at_most / measured of every case where something was lost, in order.
fn ratios<'a>(cases: impl IntoIterator<Item = &'a Case>) -> Vec<f64> {
    let lossy = cases.into_iter().filter(|case| case.is_lossy());
    let mut ratios: Vec<f64> = lossy.map(|case| case.at_most / case.measured).collect();
    ratios.sort_by(f64::total_cmp);
    ratios
}

/// The median over all, each tolerance with the same weight however many of its meshes were measured.
fn even_median(by_tolerance: &[Vec<f64>]) -> f64 {
    let weigh =
        |ratios: &Vec<f64>| ratios.iter().map(|r| (*r, 1.0 / ratios.len() as f64)).collect::<Vec<_>>();
    let mut all: Vec<(f64, f64)> = by_tolerance.iter().flat_map(weigh).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * by_tolerance.len() as f64;
    let mut sum = 0.0;
    let middle = all.iter().find(|(_, weight)| {
        sum += weight;
        sum >= half
    });
    middle.map_or(f64::NAN, |(ratio, _)| *ratio)
}

fn report(what: &str, ratios: &[f64]) {
    let [least, low, median, high, most] = [0.0, 0.1, 0.5, 0.9, 1.0].map(|q| quantile(ratios, q));
    eprintln!(
        "{what}: at_most/measured of {} lossy meshes: least {least:.3}, 10 % {low:.3}, median {median:.3}, \
         90 % {high:.3}, most {most:.3}",
        ratios.len()
    );
}

#[test]
fn no_mesh_is_further_from_its_patch_than_its_bound() {
    let list = cases();
    let cases = for_all(list.len(), |i| judge(list[i].0, list[i].1));
    for case in &cases {
        assert!(!case.is_over(1.0), "over its bound: {case}");
        assert!(case.at_most <= case.budget, "over its budget: {case}");
        // The distance that the library says it found, the sampler finds too (to its own precision of 1e-3).
        assert!(case.at_least <= case.measured * 1.002 + case.slack, "at_least is too high: {case}");
    }
    let at = |tolerance: f64| cases.iter().filter(move |case| case.tolerance == tolerance);
    let by_tolerance: Vec<Vec<f64>> = tolerances().iter().map(|tolerance| ratios(at(*tolerance))).collect();
    for (tolerance, ratios) in tolerances().iter().zip(&by_tolerance) {
        report(&format!("{tolerance:e}"), ratios);
    }
    for (kind, _) in KINDS {
        report(kind, &ratios(at(1e-3).filter(|case| case.kind == kind)));
    }
    let median = even_median(&by_tolerance);
    eprintln!("all tolerances alike: median {median:.3}");
    assert!(median <= 2.0, "half of the bounds are more than {median} times the distance");
    // The referee sees a bound that is 30 % too small, wherever bounds are as tight as they are meant to be.
    for tolerance in [1e-3, 1e-4, 1e-5] {
        let (caught, all) = (at(tolerance).filter(|c| c.is_over(0.7)).count(), at(tolerance).count());
        eprintln!("{tolerance:e}: of bounds cut by 30 %, {caught} of {all} are caught");
        assert!(3 * caught >= all, "only {caught} of {all} cut bounds were caught at {tolerance:e}");
    }
}

#[test]
fn no_quilt_is_further_from_its_patches_than_its_bound() {
    // Neighbours that need different numbers of triangles are stitched; the bound holds there too.
    let cases: Vec<(u64, f64)> =
        some(0..12, 4).into_iter().flat_map(|seed| [3.0, 0.3, 0.03].map(|length| (seed, length))).collect();
    for_all(cases.len(), |i| {
        let (seed, length) = cases[i];
        let patches = quilt(3, seed);
        let made = mesh_within(&patches, length);
        let slack = patches.iter().map(rounding).fold(0.0, f64::max);
        let mesh = Triangles::new(made.shape.positions(), made.shape.faces());
        let measured = measure(&Surface::new(patches), &mesh).both();
        let at_most = made.bound.at_most().expect("proved");
        assert!(
            measured <= at_most + slack && at_most <= length,
            "quilt {seed}: {measured:e}, {:?}",
            made.bound
        );
        assert!(
            made.bound.at_least() <= measured * 1.002 + slack,
            "quilt {seed}: {measured:e}, {:?}",
            made.bound
        );
    });
}
