//! The farthest point of one surface from another, by samples and climbing.
use chordal_testkit::Random;
use chordal_testkit::sampler::{Triangles, on};

/// Weights that sum to 1, of some that do not.
fn shares(w: [f64; 3]) -> [f64; 3] {
    w.map(|x| x / (w[0] + w[1] + w[2]))
}

/// The farthest distance from any point of `from` to `to` that samples find: corners, a lattice, random
/// points, and a climb from the best of each triangle that comes near the best of all.
pub fn farthest(from: &Triangles, to: &Triangles, random: &mut Random) -> f64 {
    let mut best = 0.0_f64;
    let mut of_each = Vec::new();
    for triangle in &from.corners {
        let mut top = (0.0, [1.0, 0.0, 0.0]);
        let mut try_at = |w: [f64; 3]| {
            let d = to.distance(on(*triangle, shares(w)));
            if d > top.0 {
                top = (d, w);
            }
        };
        for i in 0..=4 {
            for j in 0..=4 - i {
                try_at([f64::from(i), f64::from(j), f64::from(4 - i - j)]);
            }
        }
        for _ in 0..8 {
            try_at(random.weights());
        }
        best = best.max(top.0);
        of_each.push((top, *triangle));
    }
    of_each.sort_by(|a, b| b.0.0.total_cmp(&a.0.0));
    for ((mut d, mut w), triangle) in of_each.into_iter().take(6) {
        let mut step = 0.2;
        for _ in 0..60 {
            let trial: [f64; 3] = std::array::from_fn(|k| (w[k] + random.between(-step, step)).max(0.0));
            if trial.iter().sum::<f64>() <= 0.0 {
                continue;
            }
            let found = to.distance(on(triangle, shares(trial)));
            if found > d {
                (d, w) = (found, trial);
            } else {
                step *= 0.9;
            }
        }
        best = best.max(d);
    }
    best
}
