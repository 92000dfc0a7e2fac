//! Distance from points to a triangle mesh.
use super::tree::{Tree, around};
use super::vector::{Point, add, cross, distance, dot, scale, sub};

/// Triangles to which distances are asked.
pub struct Triangles {
    pub corners: Vec<[Point; 3]>,
    tree: Tree,
}

fn closest_on_segment(p: Point, a: Point, b: Point) -> Point {
    let along = sub(b, a);
    let square = dot(along, along);
    let t = if square > 0.0 { (dot(sub(p, a), along) / square).clamp(0.0, 1.0) } else { 0.0 };
    add(scale(a, 1.0 - t), scale(b, t))
}

/// The point of a triangle, degenerate or not, that is closest to `p`.
pub fn closest_on_triangle(p: Point, [a, b, c]: [Point; 3]) -> Point {
    let (ab, ac, ap) = (sub(b, a), sub(c, a), sub(p, a));
    let normal = cross(ab, ac);
    let square = dot(normal, normal);
    let (v, w) = (dot(cross(ap, ac), normal) / square, dot(cross(ab, ap), normal) / square);
    // Not so (NaN) for triangles without area: then only the sides count.
    let inside = v >= 0.0 && w >= 0.0 && v + w <= 1.0;
    let plane = add(a, add(scale(ab, v), scale(ac, w)));
    // A thin triangle's normal is too inexact to trust it alone: sine below 1e-3.
    if inside && square > 1e-6 * dot(ab, ab) * dot(ac, ac) {
        return plane;
    }
    let sides = [[a, b], [b, c], [c, a]].map(|[s, e]| closest_on_segment(p, s, e));
    let away = |q: Point| dot(sub(p, q), sub(p, q));
    let nearer = |x: Point, y: Point| if away(y) < away(x) { y } else { x };
    sides.into_iter().fold(if inside { plane } else { sides[0] }, nearer)
}

impl Triangles {
    pub fn new(positions: &[Point], faces: &[[u32; 3]]) -> Self {
        let corners: Vec<_> = faces.iter().map(|f| f.map(|i| positions[i as usize])).collect();
        let boxes: Vec<_> = corners.iter().map(|c| around(*c)).collect();
        Self { tree: Tree::new(&boxes), corners }
    }

    /// The distance of `p` and the triangle that has it. `guess`, any triangle, makes it fast when it is close.
    pub fn nearest(&self, p: Point, guess: usize) -> (f64, usize) {
        let of = |i: usize| distance(p, closest_on_triangle(p, self.corners[i]));
        let Some(_) = self.corners.get(guess) else { return (f64::INFINITY, 0) };
        let mut found = (of(guess), guess);
        self.tree.visit(p, found.0, |item, best| {
            let away = of(item);
            if away < best {
                found = (away, item);
            }
            found.0
        });
        found
    }

    /// The point of one triangle that is closest to `p`.
    pub fn closest_point(&self, p: Point, triangle: usize) -> Point {
        closest_on_triangle(p, self.corners[triangle])
    }
}
