//! The greedy way to place chord ends: each chord as long as its deviation bound allows.
//!
//! Among all polylines with their vertices on the curve, in order, whose chords each keep the tolerance, none
//! has fewer segments (up to the stopping precision of the search). It is slow, and the reference for the
//! fast way ([`super::density`]).

/// The precision of the farthest parameter, as a fraction of the step. Chosen: a thousandth of a step in each of a
/// thousand segments is one segment.
const CLOSE: f64 = 1e-3;

/// Parameters from 0 to 1, both included, such that `loss` of each step is at most `tolerance`.
///
/// `sure` is a step that always keeps the tolerance.
pub(crate) fn parameters(loss: impl Fn(f64, f64) -> f64, sure: f64, tolerance: f64) -> Vec<f64> {
    let mut places = vec![0.0];
    let mut a = 0.0;
    let mut step = 1.0;
    while a < 1.0 {
        let b = farthest(&loss, a, step, sure, tolerance);
        step = b - a;
        a = b;
        places.push(b);
    }
    places
}

/// The farthest end of a chord from `a`, searched first about a step away.
fn farthest(loss: &impl Fn(f64, f64) -> f64, a: f64, step: f64, sure: f64, tolerance: f64) -> f64 {
    if loss(a, 1.0) <= tolerance {
        return 1.0;
    }
    let mut good = if a + sure < 1.0 { a + sure } else { 0.5 * (a + 1.0) };
    let mut bad = 1.0;
    let mut guess = a + step;
    // A step of the smallest fraction is found in 60 halvings from anywhere.
    for _ in 0..60 {
        if bad - good <= CLOSE * (good - a) {
            break;
        }
        let inside = guess > good && guess < bad;
        let b = if inside { guess } else { 0.5 * (good + bad) };
        let deviation = loss(a, b);
        if deviation <= tolerance {
            good = b;
        } else {
            bad = b;
        }
        // The deviation grows with the square of the step; aim a little inside, then a little outside.
        let aim = if deviation <= tolerance { 1.0 + 0.25 * CLOSE } else { 1.0 - 0.25 * CLOSE };
        guess = a + (b - a) * (tolerance / deviation).sqrt() * aim;
    }
    good
}
