//! Exact crossing of the upward ray from a point with a triangle: summed over a closed surface it gives the
//! winding number around the point.
use crate::math::{Orientation, PointInTriangle, orient2d, orient3d, triangle_contains};

/// The intersection of a triangle and the ray from a point along +z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RayCrossing {
    /// The ray misses the triangle.
    None,
    /// The ray passes from the back to the front: counts +1.
    FromBehind,
    /// The ray passes from the front to the back: counts −1.
    FromFront,
    /// The point lies on the triangle.
    On,
}

/// The intersection of a triangle and the ray from `p` along +z. Exact. A ray through an edge or a corner is
/// perturbed by an infinitesimal amount, to the same side for all triangles, so that sums over a closed
/// surface are right.
///
/// Source of the last step: H. Edelsbrunner, E. P. Mücke, *Simulation of simplicity*, 1990.
pub(crate) fn crossing(p: [f64; 3], corners: [[f64; 3]; 3]) -> RayCrossing {
    let [a, b, c] = corners;
    let reaches = |k: usize, far: fn(f64, f64) -> bool| corners.iter().any(|q| far(q[k], p[k]));
    // Most triangles are beside the ray or below its start, which comparisons decide.
    let above = reaches(2, |q, p| q >= p);
    if !above || !(0..2).all(|k| reaches(k, |q, p| q <= p) && reaches(k, |q, p| q >= p)) {
        return RayCrossing::None;
    }
    let side = orient3d(a, b, c, p);
    if side == Orientation::Flat && contains(corners, p) {
        return RayCrossing::On;
    }
    // Seen from above, counter-clockwise is front up:
    //    front up, p behind the plane: p is below, the ray comes from behind
    //    back up, p in front of it:    p is below, the ray comes from the front
    // In the other two cases the triangle is below the start of the ray.
    let flat = |[x, y, _]: [f64; 3]| [x, y];
    let turns = [(a, b), (b, c), (c, a)].map(|(q, r)| orient2d_perturbed(flat(q), flat(r), flat(p)));
    let front_up = turns == [Orientation::Front; 3];
    let back_up = turns == [Orientation::Back; 3];
    match side {
        Orientation::Back if front_up => RayCrossing::FromBehind,
        Orientation::Front if back_up => RayCrossing::FromFront,
        _ => RayCrossing::None,
    }
}

/// [`orient2d`] with `p` moved by (ε, ε²) for an infinitesimal ε: flat only if `a` and `b` are equal.
fn orient2d_perturbed(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> Orientation {
    let exact = orient2d(a, b, p);
    let by = |forwards: bool| if forwards { Orientation::Front } else { Orientation::Back };
    if exact != Orientation::Flat {
        exact
    } else if a[1] != b[1] {
        by(b[1] < a[1])
    } else if a[0] != b[0] {
        by(b[0] > a[0])
    } else {
        Orientation::Flat
    }
}

/// Whether a point in the plane of a triangle lies on it, including its sides.
fn contains(corners: [[f64; 3]; 3], p: [f64; 3]) -> bool {
    let flat = |x: usize, y: usize| (corners.map(|q| [q[x], q[y]]), [p[x], p[y]]);
    // Projects along an axis that keeps the triangle's area nonzero; a triangle without area is a segment in
    // all three projections.
    let projections = [(0, 1), (1, 2), (2, 0)].map(|(x, y)| flat(x, y));
    let orientation_in = |&([a, b, c], p): &([[f64; 2]; 3], [f64; 2])| {
        (orient2d(a, b, c) != Orientation::Flat)
            .then(|| triangle_contains([a, b, c], p) != PointInTriangle::Outside)
    };
    let within = |(corners, p): &([[f64; 2]; 3], [f64; 2])| {
        triangle_contains(*corners, *p) != PointInTriangle::Outside
    };
    projections.iter().find_map(orientation_in).unwrap_or_else(|| projections.iter().all(within))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The winding number of closed triangles around a point; `None` on one of them.
    fn winding(triangles: &[[[f64; 3]; 3]], p: [f64; 3]) -> Option<i32> {
        triangles.iter().try_fold(0, |sum, corners| match crossing(p, *corners) {
            RayCrossing::None => Some(sum),
            RayCrossing::FromBehind => Some(sum + 1),
            RayCrossing::FromFront => Some(sum - 1),
            RayCrossing::On => None,
        })
    }

    #[test]
    fn lattice_points_around_lattice_solids_are_placed_exactly() {
        let axes = [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [-4.0, 0.0, 0.0], [0.0, -4.0, 0.0]];
        let octahedron: Vec<[[f64; 3]; 3]> = (0..4)
            .flat_map(|i| {
                let (a, b) = (axes[i], axes[(i + 1) % 4]);
                [[a, b, [0.0, 0.0, 4.0]], [b, a, [0.0, 0.0, -4.0]]]
            })
            .collect();
        let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 1 { 2.0 } else { -2.0 });
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let cube: Vec<[[f64; 3]; 3]> = sides
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .map(|face| face.map(corner))
            .collect();
        let turned: Vec<_> = octahedron.iter().map(|[a, b, c]| [*b, *a, *c]).collect();
        let twice = [octahedron.clone(), octahedron.clone()].concat();
        for index in 0..11_i32.pow(3) {
            let at = [index % 11 - 5, index / 11 % 11 - 5, index / 121 - 5];
            let p = at.map(f64::from);
            let one = |distance: i32, reach: i32| match distance.cmp(&reach) {
                std::cmp::Ordering::Less => Some(1),
                std::cmp::Ordering::Equal => None,
                std::cmp::Ordering::Greater => Some(0),
            };
            let in_octahedron = one(at.iter().map(|x| x.abs()).sum(), 4);
            let in_cube = one(at.iter().map(|x| x.abs()).max().unwrap_or(0), 2);
            assert_eq!(winding(&octahedron, p), in_octahedron, "{at:?}");
            assert_eq!(winding(&cube, p), in_cube, "{at:?}");
            assert_eq!(winding(&turned, p), in_octahedron.map(|n| -n), "{at:?}");
            assert_eq!(winding(&twice, p), in_octahedron.map(|n| 2 * n), "{at:?}");
        }
    }

    #[test]
    fn a_point_beside_a_surface_by_its_last_bit_is_not_on_it() {
        let triangle = [[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [0.0, 3.0, 1.0]];
        assert_eq!(crossing([1.0, 1.0, 1.0], triangle), RayCrossing::On);
        assert_eq!(crossing([1.0, 1.0, 1.0_f64.next_down()], triangle), RayCrossing::FromBehind);
        assert_eq!(crossing([1.0, 1.0, 1.0_f64.next_up()], triangle), RayCrossing::None);
        assert_eq!(crossing([1.5, 1.5, 1.0], triangle), RayCrossing::On);
        assert_eq!(crossing([1.5, 1.5_f64.next_up(), 1.0], triangle), RayCrossing::None);
    }
}
