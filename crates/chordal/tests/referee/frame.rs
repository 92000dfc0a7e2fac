//! Axes across a given direction, turned at random.
use chordal_testkit::Random;
use chordal_testkit::sampler::{Point, cross, dot, norm, scale, sub};

/// Three perpendicular unit vectors, the first as given.
pub fn frame(random: &mut Random, first: Point) -> [Point; 3] {
    let first = scale(first, 1.0 / norm(first));
    loop {
        let other = random.direction();
        let across = sub(other, scale(first, dot(first, other)));
        if norm(across) > 0.1 {
            let second = scale(across, 1.0 / norm(across));
            return [first, second, cross(first, second)];
        }
    }
}
