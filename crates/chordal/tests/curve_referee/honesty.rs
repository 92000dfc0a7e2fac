//! Whether the referee can be trusted: closed forms, and polylines that are broken on purpose.
use super::families::shape;
use super::measure::{Look, measure};
use super::truth::{Path, Round};
use super::{flatten, length};
use chordal::convert::Spacing;
use chordal::explicit::Polyline;
use chordal_testkit::Random;

fn polyline(points: &[[f64; 2]], places: &[f64]) -> Polyline<2> {
    Polyline { points: points.to_vec(), places: places.to_vec(), closed: false }
}

#[test]
fn measures_closed_forms() {
    let arch = Path::cubic([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]);
    let found = measure(&arch, &polyline(&[[0.0, 0.0], [1.0, 0.0]], &[0.0, 1.0]), Look::Quick);
    assert!((found.to_polyline - 0.75).abs() < 1e-12, "{found:?}");
    // A quarter of a circle loses r(1 − cos(π/4)).
    let quarter = std::f64::consts::FRAC_PI_2;
    let round =
        Round { centre: [0.0; 2], axes: [[2.0, 0.0], [0.0, 2.0]], start: 0.0, sweep: quarter, ends: None };
    let found = measure(&Path::arc(round), &polyline(&[[2.0, 0.0], [0.0, 2.0]], &[0.0, 1.0]), Look::Quick);
    assert!((found.to_polyline - 2.0 * (1.0 - 0.5_f64.sqrt())).abs() < 1e-12, "{found:?}");
    // x = 9t²(1−t) + t³ turns back where 18t − 24t² = 0.
    let back = Path::cubic([[0.0, 0.0], [0.0, 0.0], [3.0, 0.0], [1.0, 0.0]]);
    let t = 0.75_f64;
    let far = 9.0 * t * t * (1.0 - t) + t.powi(3) - 1.0;
    let found = measure(&back, &polyline(&[[0.0, 0.0], [1.0, 0.0]], &[0.0, 1.0]), Look::Quick);
    assert!((found.to_polyline - far).abs() < 1e-9, "{found:?} and {far}");
}

#[test]
fn measures_the_way_back_where_only_that_is_long() {
    let line = Path::cubic([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]);
    let spike = polyline(
        &[[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [1.0, 0.0], [3.0, 0.0]],
        &[0.0, 0.333, 0.3333, 0.33333, 1.0],
    );
    let found = measure(&line, &spike, Look::Close);
    // Sixteen points of each segment: the last but one before the tip is at 15/16.
    assert!(found.to_polyline < 1e-12 && found.to_path >= 2.0 * 15.0 / 16.0, "{found:?}");
}

#[test]
fn sees_a_vertex_out_of_place_and_one_that_is_missing() {
    let (mut moved, mut missing, mut all) = (0, 0, 0);
    for seed in (0..600).filter(|seed| Path::cubic(shape::<2>(*seed).control).size() > 0.0) {
        let path = Path::cubic(shape::<2>(seed).control);
        let made = flatten(&path, &length(1e-3 * path.size()), Spacing::Fewest).expect("within reach");
        let at_most = made.bound.at_most().expect("proved");
        let n = made.shape.points.len();
        if n < 5 {
            continue;
        }
        all += 1;
        let r = &mut Random::new(seed as u64);
        let victim = 1 + r.below(n - 2);
        let mut other = made.shape.clone();
        let by: [f64; 2] = r.direction();
        let point = other.points[victim];
        other.points[victim] = std::array::from_fn(|k| point[k] + 3.0 * at_most * by[k]);
        moved += usize::from(measure(&path, &other, Look::Quick).both() > at_most);
        let mut other = made.shape.clone();
        other.points.remove(victim);
        other.places.remove(victim);
        missing += usize::from(measure(&path, &other, Look::Quick).both() > at_most);
    }
    eprintln!("of {all} polylines, {moved} with a moved and {missing} with a missing vertex were caught");
    // A vertex may move along its segments, and one may be missing beside another: those change nothing.
    assert!(all > 300 && 5 * moved > 3 * all && 5 * missing > 4 * all, "{all}, {moved}, {missing}");
}
