//! Splines as the referee knows them: by the recursion of Cox and de Boor over all knots, nothing shared.
use chordal_testkit::Random;

/// The basis functions of a degree at `t`: one for each control point.
pub fn basis(knots: &[f64], degree: usize, t: f64) -> Vec<f64> {
    let last = knots.len() - 1;
    // Half-open pieces; the end belongs to the last one that is not empty.
    let end = knots[last - degree];
    let is_in = |k: usize| {
        let full = knots[k] < knots[k + 1];
        full && (knots[k] <= t && t < knots[k + 1] || t == end && knots[k + 1] == end)
    };
    let mut row: Vec<f64> = (0..last).map(|k| f64::from(u8::from(is_in(k)))).collect();
    for p in 1..=degree {
        let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        row = (0..last - p)
            .map(|k| {
                share(t - knots[k], knots[k + p] - knots[k]) * row[k]
                    + share(knots[k + p + 1] - t, knots[k + p + 1] - knots[k + 1]) * row[k + 1]
            })
            .collect();
    }
    row
}

/// The parameter at a place from 0 to 1 of the whole spline, in which each piece has an equal share.
pub fn parameter(knots: &[f64], degree: usize, place: f64) -> f64 {
    let mut ends = knots[degree..knots.len() - degree].to_vec();
    ends.dedup();
    let n = ends.len() - 1;
    let at = place * n as f64;
    let piece = (at as usize).min(n - 1);
    let part = at - piece as f64;
    (1.0 - part) * ends[piece] + part * ends[piece + 1]
}

/// Knots of a random kind: clamped or not, even or not, repeated or not.
pub fn random_knots(random: &mut Random, degree: usize, n_control: usize) -> Vec<f64> {
    let inner = n_control - degree - 1;
    let (mut inside, mut at) = (Vec::new(), 0.0);
    let even = random.below(2) == 0;
    while inside.len() < inner {
        at += if even { 1.0 } else { random.power(-1.3, 0.3) };
        let times = if random.below(4) == 0 { 1 + random.below(degree) } else { 1 };
        inside.extend(std::iter::repeat_n(at, times.min(inner - inside.len())));
    }
    let end = at + 1.0;
    let clamped = random.below(4) > 0;
    let outside = |k: usize| if clamped { 0.0 } else { k as f64 };
    let before = (1..=degree).rev().map(|k| -outside(k));
    let after = (1..=degree).map(|k| end + outside(k));
    before.chain([0.0]).chain(inside.iter().copied()).chain([end]).chain(after).collect()
}

/// Weights of 1, or of 3 to 20 times as much and as little.
pub fn random_weights(random: &mut Random, n: usize) -> Vec<f64> {
    let most = [0.0, 0.5, 1.3][random.below(3)];
    (0..n).map(|_| random.power(-most, most)).collect()
}

/// Points on a random walk, at a random place and scale.
pub fn random_points<const D: usize>(random: &mut Random, n: usize) -> Vec<[f64; D]> {
    let scale = random.power(-3.0, 3.0);
    let away = scale * [0.0, 10.0][random.below(2)];
    let mut at: [f64; D] = random.point_within(away);
    let mut walk = || {
        let step: [f64; D] = random.point_within(scale);
        at = std::array::from_fn(|k| at[k] + step[k]);
        at
    };
    (0..n).map(|_| walk()).collect()
}
