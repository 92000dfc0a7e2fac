//! Distances from points to triangles.
use super::box_tree::{BoxTree, around};
use super::vector::{Point, cross, distance, dot, norm, sub};

/// The point of a triangle by its barycentric weights.
pub fn on(t: [Point; 3], w: [f64; 3]) -> Point {
    std::array::from_fn(|k| w[0] * t[0][k] + w[1] * t[1][k] + w[2] * t[2][k])
}

/// The weights of the point of a triangle, degenerate or not, that is closest to `p`.
pub fn closest_weights(p: Point, t: [Point; 3]) -> [f64; 3] {
    let (ab, ac, ap) = (sub(t[1], t[0]), sub(t[2], t[0]), sub(p, t[0]));
    let normal = cross(ab, ac);
    let square = dot(normal, normal);
    let (v, w) = (dot(cross(ap, ac), normal) / square, dot(cross(ab, ap), normal) / square);
    // False (NaN) for triangles without area: then only the sides count.
    let inside = v >= 0.0 && w >= 0.0 && v + w <= 1.0;
    // For a thin triangle, with a sine below a tenth, the weights are too inexact to be used alone.
    if inside && square > 0.01 * dot(ab, ab) * dot(ac, ac) {
        return [1.0 - v - w, v, w];
    }
    let (mut best, mut least) = ([1.0, 0.0, 0.0], f64::INFINITY);
    let mut consider = |w: [f64; 3]| {
        let offset = sub(p, on(t, w));
        if dot(offset, offset) < least {
            (least, best) = (dot(offset, offset), w);
        }
    };
    if inside {
        let mut foot = [1.0 - v - w, v, w];
        consider(foot);
        // Refined from there: the relative error becomes its square, its third and its fourth power.
        for _ in 0..3 {
            let offset = sub(p, on(t, foot));
            let correction =
                |k: usize| dot(cross(sub(t[(k + 2) % 3], t[(k + 1) % 3]), offset), normal) / square;
            let moved: [f64; 3] = std::array::from_fn(|k| (foot[k] + correction(k)).max(0.0));
            foot = moved.map(|x| x / (moved[0] + moved[1] + moved[2]));
            consider(foot);
        }
    }
    for k in 0..3 {
        let (a, b) = (t[k], t[(k + 1) % 3]);
        let along = sub(b, a);
        let square = dot(along, along);
        let s = if square > 0.0 { (dot(sub(p, a), along) / square).clamp(0.0, 1.0) } else { 0.0 };
        let mut w = [0.0; 3];
        (w[k], w[(k + 1) % 3]) = (1.0 - s, s);
        consider(w);
    }
    best
}

/// The point of a triangle, degenerate or not, that is closest to `p`.
pub fn closest_on_triangle(p: Point, t: [Point; 3]) -> Point {
    on(t, closest_weights(p, t))
}

/// The distance from a point to a triangle.
pub fn distance_to_triangle(p: Point, t: [Point; 3]) -> f64 {
    distance(p, closest_on_triangle(p, t))
}

/// Triangles for distance queries.
pub struct Triangles {
    /// The corners of each triangle.
    pub corners: Vec<[Point; 3]>,
    tree: BoxTree,
}

impl From<Vec<[Point; 3]>> for Triangles {
    fn from(corners: Vec<[Point; 3]>) -> Self {
        let boxes: Vec<_> = corners.iter().map(|c| around(*c)).collect();
        Self { tree: BoxTree::new(&boxes), corners }
    }
}

impl Triangles {
    /// Triangles by indices of positions.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn new(positions: &[Point], faces: &[[u32; 3]]) -> Self {
        faces.iter().map(|f| f.map(|i| positions[i as usize])).collect::<Vec<_>>().into()
    }

    /// The distance of `p` and the nearest triangle; infinite without triangles. `guess` is the index of any
    /// triangle; a close one makes the search fast.
    pub fn nearest(&self, p: Point, guess: usize) -> (f64, usize) {
        let distance_to = |i: usize| distance_to_triangle(p, self.corners[i]);
        let Some(_) = self.corners.get(guess) else { return (f64::INFINITY, 0) };
        let mut nearest = (distance_to(guess), guess);
        self.tree.visit(p, nearest.0, |item, best| {
            let distance = distance_to(item);
            if distance < best {
                nearest = (distance, item);
            }
            nearest.0
        });
        nearest
    }

    /// The distance of `p`; infinite without triangles.
    pub fn distance(&self, p: Point) -> f64 {
        self.nearest(p, 0).0
    }

    /// All triangles within a distance of `p`.
    pub fn within(&self, p: Point, length: f64) -> Vec<usize> {
        let mut near = Vec::new();
        // The next larger number, so that boxes at exactly this distance are visited.
        let beyond = length.next_up();
        self.tree.visit(p, beyond, |item, best| {
            if distance_to_triangle(p, self.corners[item]) <= length {
                near.push(item);
            }
            best
        });
        near
    }

    /// The area of a triangle.
    pub fn area(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.corners[triangle];
        0.5 * norm(cross(sub(b, a), sub(c, a)))
    }

    /// The point of one triangle that is closest to `p`.
    pub fn closest_point(&self, p: Point, triangle: usize) -> Point {
        closest_on_triangle(p, self.corners[triangle])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Random;
    use crate::sampler::{add, scale};

    /// Regular triangles, needles, caps, and triangles without area.
    fn triangle(random: &mut Random, kind: usize) -> [Point; 3] {
        let [a, b, c] = [0; 3].map(|_| random.point());
        let along = |s: f64| add(scale(a, 1.0 - s), scale(b, s));
        let by = scale(c, random.power(-15.0, -1.0));
        match kind % 6 {
            0 => [a, b, add(a, by)],
            1 => [a, b, add(along(random.unit()), by)],
            2 => [a, b, along(0.5)],
            3 => [a; 3],
            _ => [a, b, c],
        }
    }

    #[test]
    fn no_point_of_a_triangle_is_closer_and_the_closest_is_found() {
        let mut random = Random::new(1);
        for case in 0..3000 {
            let t = triangle(&mut random, case);
            let p: Point = random.point_within(2.0);
            let w = closest_weights(p, t);
            assert!(w.iter().all(|x| *x >= 0.0) && (w.iter().sum::<f64>() - 1.0).abs() < 1e-15, "{w:?}");
            let distance_found = distance_to_triangle(p, t);
            // Some roundings of coordinates below 2 and 1.
            (0..300).for_each(|_| {
                assert!(
                    distance_found <= distance(p, on(t, random.weights())) + 1e-14,
                    "case {case}: {p:?} {t:?}"
                );
            });
            // Points with a known foot: on the triangle, and above it.
            let w = random.weights();
            let [q, n] = [on(t, w), cross(sub(t[1], t[0]), sub(t[2], t[0]))];
            // Measured: 1e-14, for needles 10¹⁴ times thinner than they are long, and below 1e-15 for most.
            assert!(distance_to_triangle(q, t) < 2e-14, "case {case}: {q:?} {t:?}");
            if norm(n) > 0.01 {
                let above = add(q, scale(n, 0.5 / norm(n)));
                assert!((distance_to_triangle(above, t) - 0.5).abs() < 1e-14, "case {case}");
            }
        }
    }

    #[test]
    fn the_tree_finds_what_looking_at_all_finds() {
        let mut random = Random::new(2);
        for n in [0, 1, 3, 50, 400] {
            let triangles: Vec<[Point; 3]> = (0..n)
                .map(|kind| {
                    let at: Point = random.point();
                    triangle(&mut random, kind).map(|p| add(at, scale(p, 0.1)))
                })
                .collect();
            let tree = Triangles::from(triangles.clone());
            for _ in 0..200 {
                let p: Point = random.point_within(1.5);
                let each: Vec<f64> = triangles.iter().map(|t| distance_to_triangle(p, *t)).collect();
                let least = each.iter().copied().fold(f64::INFINITY, f64::min);
                assert_eq!(tree.distance(p), least);
                let within: Vec<usize> = (0..n).filter(|i| each[*i] <= 0.5).collect();
                let mut found = tree.within(p, 0.5);
                found.sort_unstable();
                assert_eq!(found, within);
            }
        }
    }
}
