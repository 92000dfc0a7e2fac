//! Distances by plain loops over all triangles, and the farthest point by samples and climbing. Nothing of the library.
use super::random::Random;

pub type Point = [f64; 3];
/// Triangles by their corners.
pub type Soup = Vec<[Point; 3]>;

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

fn to_segment(p: Point, a: Point, b: Point) -> f64 {
    let (ab, ap) = (sub(b, a), sub(p, a));
    let square = dot(ab, ab);
    let t = if square > 0.0 { (dot(ap, ab) / square).clamp(0.0, 1.0) } else { 0.0 };
    norm([ap[0] - t * ab[0], ap[1] - t * ab[1], ap[2] - t * ab[2]])
}

/// The distance from a point to a triangle: to the nearest point of a side, or to the foot on its plane, which is taken
/// as a point between the corners, so that a normal that is not well known costs little.
pub fn to_triangle(p: Point, [a, b, c]: [Point; 3]) -> f64 {
    let sides = to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a));
    let n = cross(sub(b, a), sub(c, a));
    let w = [(b, c), (c, a), (a, b)].map(|(from, to)| dot(cross(sub(to, from), sub(p, from)), n).max(0.0));
    let whole = w[0] + w[1] + w[2];
    if whole > 0.0 { sides.min(norm(sub(p, on([a, b, c], w)))) } else { sides }
}

pub fn to_soup(p: Point, soup: &Soup) -> f64 {
    soup.iter().fold(f64::INFINITY, |least, triangle| least.min(to_triangle(p, *triangle)))
}

fn on(triangle: [Point; 3], w: [f64; 3]) -> Point {
    let whole = w[0] + w[1] + w[2];
    std::array::from_fn(|k| (w[0] * triangle[0][k] + w[1] * triangle[1][k] + w[2] * triangle[2][k]) / whole)
}

/// The farthest distance from any point of `from` to `to` that samples find: corners, a lattice, random points, and a
/// climb from the best of each triangle that comes near the best of all.
pub fn farthest(from: &Soup, to: &Soup, random: &mut Random) -> f64 {
    let mut best = 0.0_f64;
    let mut of_each = Vec::new();
    for triangle in from {
        let mut top = (0.0, [1.0, 0.0, 0.0]);
        let mut try_at = |w: [f64; 3]| {
            let d = to_soup(on(*triangle, w), to);
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
            let [a, b] = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
            try_at(if a + b < 1.0 { [a, b, 1.0 - a - b] } else { [1.0 - a, 1.0 - b, a + b - 1.0] });
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
            let found = to_soup(on(triangle, trial), to);
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
