//! Sorts the faces around one edge by their angles, exactly, and pairs those that bound one solid.
use crate::check::is_collinear;
use crate::math::{Orientation, orient2d, orient3d};
use std::cmp::Ordering;

/// A face at an edge from `a` to `b`.
#[derive(Clone, Copy, Debug)]
pub(super) struct RadialFace {
    pub half_edge: u32,
    /// Its third corner.
    pub apex: [f64; 3],
    /// Whether it runs along the edge from `a` to `b`: then its back is on the side of smaller angles.
    pub is_up: bool,
}

/// Pairs of half-edges whose faces enclose a wedge of the inside that contains no other face to pair. So
/// if two solids touch along the edge, each gets its two faces.
pub(super) fn pair_faces(edge: [[f64; 3]; 2], faces: &mut [RadialFace]) -> Vec<[u32; 2]> {
    sort_by_angle(edge, faces);
    let mut pairs = Vec::new();
    // With growing angle, the inside starts at a face that runs along the edge downwards and ends at one that
    // runs upwards, like brackets.
    let mut open: Vec<u32> = Vec::new();
    let mut late: Vec<u32> = Vec::new();
    for face in faces.iter() {
        match (face.is_up, open.pop()) {
            (true, Some(start)) => pairs.push([start, face.half_edge]),
            (true, None) => late.push(face.half_edge),
            // No end, so the bracket that was taken off the stack stays open.
            (false, last) => {
                open.extend(last);
                open.push(face.half_edge);
            }
        }
    }
    // Brackets still open at the end are closed by faces before the first opening, since the order is
    // circular.
    pairs.extend(open.into_iter().rev().zip(late).map(|(start, end)| [start, end]));
    pairs
}

/// Sorts by the angle around the edge, starting at the first face that has an angle; faces at equal angles
/// keep their order.
fn sort_by_angle([a, b]: [[f64; 3]; 2], faces: &mut [RadialFace]) {
    let Some(first) = faces.iter().map(|face| face.apex).find(|&apex| !is_collinear(a, b, apex)) else {
        return;
    };
    // Seen from b towards a, with growing angles:
    //           1
    //      2 ───┼─── 0  (the first face)
    //           3
    let half = |apex: [f64; 3]| match orient3d(a, b, first, apex) {
        Orientation::Front => 1,
        Orientation::Back => 3,
        Orientation::Flat if is_across(a, b, [first, apex]) => 2,
        Orientation::Flat => 0,
    };
    faces.sort_by(|p, q| {
        let halves = [half(p.apex), half(q.apex)];
        // Within 1 and 3 angles differ by less than π, so the side of one face's plane on which the
        // other lies orders them. In 0 and 2 all angles are equal.
        halves[0].cmp(&halves[1]).then_with(|| match orient3d(a, b, p.apex, q.apex) {
            _ if halves[0] % 2 == 0 => Ordering::Equal,
            Orientation::Front => Ordering::Less,
            Orientation::Flat => Ordering::Equal,
            Orientation::Back => Ordering::Greater,
        })
    });
}

/// Whether two points in a plane that contains the line are on different sides of it.
fn is_across(a: [f64; 3], b: [f64; 3], points: [[f64; 3]; 2]) -> bool {
    [(0, 1), (1, 2), (2, 0)].into_iter().any(|(i, j)| {
        let side = |p: [f64; 3]| orient2d([a[i], a[j]], [b[i], b[j]], [p[i], p[j]]);
        let sides = points.map(side);
        sides[0] != Orientation::Flat && sides[0] == sides[1].flipped()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_wedges_each_gets_its_own_faces_wherever_the_order_starts() {
        // Around the z axis: inside from 0° to 90° and from 180° to 270°.
        let edge = [[0.0; 3], [0.0, 0.0, 1.0]];
        let face = |half_edge, x: f64, y: f64, is_up| RadialFace { half_edge, apex: [x, y, 0.5], is_up };
        let all = [
            face(1, 1.0, 0.0, false),
            face(2, 0.0, 1.0, true),
            face(3, -1.0, 0.0, false),
            face(4, 0.0, -1.0, true),
        ];
        for shift in 0..4 {
            let mut faces = all;
            faces.rotate_left(shift);
            let mut found = pair_faces(edge, &mut faces);
            found.sort_unstable();
            assert_eq!(found, [[1, 2], [3, 4]], "shift {shift}");
        }
        let mut fin = [all[0], all[1], face(5, 1.0, 1.0, true)];
        assert_eq!(pair_faces(edge, &mut fin), [[1, 5]]);
    }
}
