//! Boxes, and half-spaces that are cut off outside of a box.
use super::FormMesh;
use crate::math::{Box3, cross, dot, greater, length, unit};

/// The faces of a box; its corner `k` is at the maximum along x, y, z if bit 0, 1, 2 of `k` is set.
const FACES: [[u32; 3]; 12] = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 6],
    [0, 1, 4],
    [1, 5, 4],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [3, 7, 5],
];

pub(super) fn cuboid(half: [f64; 3]) -> FormMesh {
    between(half.map(|h| -h), half)
}

fn between(min: [f64; 3], max: [f64; 3]) -> FormMesh {
    let corner =
        |k: usize| std::array::from_fn(|axis| if k >> axis & 1 == 1 { max[axis] } else { min[axis] });
    FormMesh { positions: (0..8).map(corner).collect(), faces: FACES.to_vec(), error: 0.0 }
}

/// The distance of the other sides from the middle of the box, in diagonals of the box. Chosen: any number above 1 will do.
const BEYOND: f64 = 2.0;

/// All points below a plane, as a cuboid whose other sides are outside of `room`. It has no faces if all of `room` is well
/// above the plane. `None` if `room` has no finite size.
pub(super) fn half_space(normal: [f64; 3], offset: f64, room: &Box3) -> Option<FormMesh> {
    let (centre, size) = (room.centre(), BEYOND * room.diagonal());
    let size = if size > 0.0 { size } else { 1.0 };
    // The depth of the middle below the plane.
    let depth = offset - dot(normal, centre);
    if !(size.is_finite() && depth.is_finite()) {
        return None;
    }
    if depth < -size {
        return Some(FormMesh { positions: Vec::new(), faces: Vec::new(), error: 0.0 });
    }
    // All of the room is well below the plane.
    if depth > size {
        return Some(between(centre.map(|x| x - size), centre.map(|x| x + size)));
    }
    if let Some(k) = (0..3).find(|k| normal[*k].abs() == 1.0) {
        // Exact for planes across an axis.
        let (mut min, mut max) = (centre.map(|x| x - size), centre.map(|x| x + size));
        if normal[k] > 0.0 {
            max[k] = offset
        } else {
            min[k] = -offset
        }
        return Some(between(min, max));
    }
    // Two directions along the plane.
    let flattest = (0..3).fold(0, |best, k| if normal[k].abs() < normal[best].abs() { k } else { best });
    let axis: [f64; 3] = std::array::from_fn(|k| f64::from(u8::from(k == flattest)));
    let u = unit(cross(normal, axis))?;
    let v = cross(normal, u);
    let corner = |k: usize| {
        let along = |bit: usize| if k >> bit & 1 == 1 { size } else { -size };
        let height = if k >> 2 & 1 == 1 { depth } else { -size };
        std::array::from_fn(|i| centre[i] + (along(0) * u[i] + along(1) * v[i] + height * normal[i]))
    };
    // The normal is a unit vector up to rounding, which is multiplied by the distance from the middle.
    let far = greater(length(centre), size);
    let error = 32.0 * f64::EPSILON * far;
    Some(FormMesh { positions: (0..8).map(corner).collect(), faces: FACES.to_vec(), error })
}
