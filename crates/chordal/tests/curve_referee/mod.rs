//! The referee of curves: measures polylines against the curves they stand for, and shares no code with the
//! library.
//!
//! It evaluates cubics by de Casteljau's construction and arcs by the standard sine and cosine, looks for the
//! farthest points of both sides by itself, and takes the last distance in numbers of twice the digits.
//! `honesty` shows that it sees the mistakes it is there for. `CHORDAL_LONG=1` makes it measure ten times as
//! many curves.
mod arcs;
mod chains;
mod counts;
mod double;
mod families;
mod fewest;
mod honesty;
mod lengths;
mod measure;
mod pixels;
mod same;
mod special;
mod svg_arcs;
mod truth;
mod uniform;

use chordal::convert::{Spacing, curve_to_polyline, curve_to_polyline_evenly};
use chordal::explicit::Polyline;
use chordal::{Bounded, Budget, Failure, Job, Tolerance};
use chordal_testkit::cases;
use truth::Path;

/// A polyline with its bound, or why there is none.
type Made<const D: usize> = Result<Bounded<Polyline<D>>, Failure<Polyline<D>>>;

/// The library's polyline under a budget.
fn flatten<const D: usize>(path: &Path<D>, budget: &Budget, spacing: Spacing) -> Made<D> {
    let (curve, job) = (path.library(), Job::default().with_threads(1));
    match spacing {
        Spacing::Fewest => curve_to_polyline(&curve, budget, &job),
        Spacing::Even => curve_to_polyline_evenly(&curve, budget, &job),
    }
}

/// A budget of a length alone.
fn length(tolerance: f64) -> Budget {
    Budget::length(Tolerance::new(tolerance).expect("a positive length"))
}

/// Runs `work` for `0..n` on two threads and returns the results in order.
fn for_all<T: Send>(n: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let half = |parity: usize| (parity..n).step_by(2).map(&work).collect::<Vec<T>>();
    let [even, odd] = std::thread::scope(|scope| {
        let odd = scope.spawn(|| half(1));
        [half(0), odd.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))]
    });
    let (mut even, mut odd) = (even.into_iter(), odd.into_iter());
    (0..n).filter_map(|i| if i % 2 == 0 { even.next() } else { odd.next() }).collect()
}

/// The value at the fraction `q` of a list.
fn quantile(list: &mut [f64], q: f64) -> f64 {
    list.sort_by(f64::total_cmp);
    list[((list.len() - 1) as f64 * q).round() as usize]
}
