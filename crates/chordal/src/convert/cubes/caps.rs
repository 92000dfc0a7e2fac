//! Flat faces that close a shape where it reaches the border of the lattice.
//!
//! Each square of a capped border gets the polygon of its inside: its inside corners, which are vertices of a kind of
//! their own, and the crossings of its sides, cut as the faces of cells are, every run of inside corners by itself. The
//! sides between crossings are the segments where cells end, each used once from either side. A side from a corner
//! is shared by the two squares at it, around the edges of the lattice too. Around a corner the squares make a disc: four
//! in a face of the lattice, four along an edge of it, three at its corner. No polygon has a diagonal between two crossings,
//! so none of its inner edges is one of a cell. Hence the whole stays a closed manifold.
use super::bits::Bits;
use super::march::Plan;
use super::rule::Border;
use crate::implicit::Affine;

/// A square of the border: its corners counter-clockwise as seen from outside.
type Square = [[usize; 3]; 4];

/// How many triangles the caps have.
pub(super) fn count(bits: &Bits) -> u64 {
    let mut count = 0;
    for_each_square(bits, |square| {
        let inside = square.map(|at| bits.is_inside(at));
        count += match inside {
            [false, false, false, false] => 0,
            [true, false, true, false] | [false, true, false, true] => 2,
            _ => {
                let corners = inside.iter().filter(|inside| **inside).count() as u64;
                if corners == 4 { 2 } else { corners }
            }
        };
    });
    count
}

/// Writes the triangles of the caps.
pub(super) fn write(plan: &Plan, affine: &Affine, faces: &mut [[u32; 3]]) {
    let upright = affine.orientation() > 0;
    let mut out = faces.iter_mut();
    for_each_square(&plan.bits, |square| {
        let inside = square.map(|at| plan.bits.is_inside(at));
        let mut fan = |polygon: &[u32]| {
            for pair in polygon[1..].windows(2) {
                if let Some(out) = out.next() {
                    *out =
                        if upright { [polygon[0], pair[0], pair[1]] } else { [polygon[0], pair[1], pair[0]] };
                }
            }
        };
        let corner = |i: usize| plan.vertex(3, square[i % 4]);
        let side = |i: usize| crossing(plan, square[i % 4], square[(i + 1) % 4]);
        if inside == [true; 4] {
            return fan(&[corner(0), corner(1), corner(2), corner(3)]);
        }
        // A run of inside corners begins where the corner before is outside.
        for first in (0..4).filter(|&i| inside[i] && !inside[(i + 3) % 4]) {
            let mut polygon = vec![];
            let mut i = first;
            while inside[i % 4] {
                polygon.push(corner(i));
                i += 1;
            }
            polygon.push(side(i - 1));
            polygon.push(side(first + 3));
            fan(&polygon);
        }
    });
}

/// The vertex between two neighbouring samples of different sides.
fn crossing(plan: &Plan, a: [usize; 3], b: [usize; 3]) -> u32 {
    let axis = (0..3).find(|&k| a[k] != b[k]).unwrap_or(0);
    plan.vertex(axis, if a[axis] < b[axis] { a } else { b })
}

/// All squares of capped borders that hold an inside sample, in an order of their own.
fn for_each_square(bits: &Bits, mut each: impl FnMut(Square)) {
    let size = bits.size;
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (end, border) in bits.capped_ends(axis).into_iter().enumerate() {
            if border == Border::Open {
                continue;
            }
            for q in 0..size[v] - 1 {
                for p in 0..size[u] - 1 {
                    let corner = |a: usize, b: usize| {
                        let mut at = [0; 3];
                        at[axis] = if end == 0 { 0 } else { size[axis] - 1 };
                        at[u] = p + a;
                        at[v] = q + b;
                        at
                    };
                    let mut square = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    if end == 0 {
                        square.reverse();
                    }
                    if square.iter().any(|at| bits.is_inside(*at)) {
                        each(square);
                    }
                }
            }
        }
    }
}
