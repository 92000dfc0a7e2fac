//! A mesher of the simplest kind, with a bound that is known by another way: what the referee is tried on.
use chordal_testkit::sampler::{Control, Point, add, distance, evaluate, quarters, scale, sub};

/// `2·4^levels` triangles of a patch over even squares.
pub fn naive_mesh(control: &Control, levels: u32) -> (Vec<Point>, Vec<[u32; 3]>) {
    let n = 1 << levels;
    let at = |k: u32| f64::from(k) / f64::from(n);
    let positions = (0..(n + 1) * (n + 1)).map(|p| evaluate(control, [at(p % (n + 1)), at(p / (n + 1))]));
    let square = |c: u32| {
        let low = c / n * (n + 1) + c % n;
        [[low, low + 1, low + n + 2], [low, low + n + 2, low + n + 1]]
    };
    (positions.collect(), (0..n * n).flat_map(square).collect())
}

/// A bound on its distance from the patch: over each square the patch minus each of the two triangles, as
/// maps of (u, v), stays in the hull of the differences of their control points; cut finer, that comes close
/// to the supremum.
pub fn naive_bound(control: &Control, levels: u32) -> f64 {
    if levels > 0 {
        return quarters(control).iter().map(|(part, _)| naive_bound(part, levels - 1)).fold(0.0, f64::max);
    }
    let [a, b, c, d] = [control[0][0], control[0][3], control[3][3], control[3][0]];
    let plane = |from: Point, by_u: Point, by_v: Point| [from, by_u, by_v];
    let lower = plane(a, sub(b, a), sub(c, b));
    let upper = plane(a, sub(c, d), sub(d, a));
    off(control, [lower, upper], [0.0, 0.0], 1.0)
}

/// How far the part over the square at `at` is from the planes that are over it.
fn off(part: &Control, planes: [[Point; 3]; 2], at: [f64; 2], side: f64) -> f64 {
    if side > 1.0 / 16.0 {
        let cut = |(q, [u, v]): &(Control, [f64; 2])| {
            off(q, planes, [at[0] + side * u, at[1] + side * v], side / 2.0)
        };
        return quarters(part).iter().map(cut).fold(0.0, f64::max);
    }
    // Below the diagonal v ≤ u, above it v ≥ u; on it both count.
    let over = [at[1] < at[0] + side, at[0] < at[1] + side];
    let from = |[start, by_u, by_v]: [Point; 3]| {
        let away = |n: usize| {
            let (u, v) = (at[0] + side * (n % 4) as f64 / 3.0, at[1] + side * (n / 4) as f64 / 3.0);
            distance(part[n / 4][n % 4], add(start, add(scale(by_u, u), scale(by_v, v))))
        };
        (0..16).map(away).fold(0.0, f64::max)
    };
    (0..2).filter(|&k| over[k]).map(|k| from(planes[k])).fold(0.0, f64::max)
}
