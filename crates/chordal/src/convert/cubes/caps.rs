//! Caps: flat faces that close a shape where it reaches the border of the lattice.
//!
//! Each square of a capped border gets the polygon of its inside: its inside corners, which are vertices of a
//! separate kind, and the crossings of its sides. It is cut like the faces of cells, every run of inside
//! corners by itself. The sides between crossings are the segments at which cells end, each used once from
//! either side. A side from a corner is shared by its two squares, also around the edges of the lattice.
//! Around a corner the squares make a disc: four in a face of the lattice, four along an edge of it, three at
//! its corner. No polygon has a diagonal between two crossings, so none of its inner edges is an edge of a cell.
//! Hence the mesh stays a closed manifold.
use super::rule::Border;
use super::sign_bits::SignBits;

/// A square of the border: its corners counter-clockwise as seen from outside.
pub(super) type CapSquare = [[usize; 3]; 4];

/// The number of triangles of the caps.
pub(super) fn count(bits: &SignBits) -> u64 {
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

/// A corner of a polygon of a square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::convert) enum CapVertex {
    /// The square's corner of that number.
    Corner(usize),
    /// The crossing on the side from that corner to the next.
    Side(usize),
}

/// The polygons of a square with these corners inside, to be triangulated as fans from their first corners.
fn polygons(inside: [bool; 4]) -> Vec<Vec<CapVertex>> {
    if inside == [true; 4] {
        return vec![(0..4).map(CapVertex::Corner).collect()];
    }
    // A run of inside corners begins after an outside corner.
    let firsts = (0..4).filter(|&i| inside[i] && !inside[(i + 3) % 4]);
    let polygon = |first: usize| {
        let run = (1..4).find(|n| !inside[(first + n) % 4]).unwrap_or(1);
        let mut polygon: Vec<CapVertex> = (first..first + run).map(|i| CapVertex::Corner(i % 4)).collect();
        polygon.extend([CapVertex::Side((first + run - 1) % 4), CapVertex::Side((first + 3) % 4)]);
        polygon
    };
    firsts.map(polygon).collect()
}

/// The triangles of the polygons of a square, counter-clockwise from outside.
pub(in crate::convert) fn triangles(
    inside: [bool; 4],
    mut number: impl FnMut(CapVertex) -> u32,
    mut each: impl FnMut([u32; 3]),
) {
    for polygon in polygons(inside) {
        let numbers: Vec<u32> = polygon.into_iter().map(&mut number).collect();
        for pair in numbers[1..].windows(2) {
            each([numbers[0], pair[0], pair[1]]);
        }
    }
}

/// Visits the triangles of all caps, in the order in which they are written: the axis and the end of its
/// border, the first corner of its square along the next two axes, and its number there.
pub(super) fn for_each_triangle(bits: &SignBits, mut each: impl FnMut(usize, usize, [usize; 2], u8)) {
    for_each_square(bits, |square| {
        let (axis, end) = border_of(&square, bits.size);
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let first = [u, v].map(|k| square.iter().map(|at| at[k]).min().unwrap_or(0));
        let mut number = 0;
        triangles(
            square.map(|at| bits.is_inside(at)),
            |_| 0,
            |_| {
                each(axis, end, first, number);
                number += 1;
            },
        );
    });
}

/// The axis of a square's border, and its end of that axis.
fn border_of(square: &CapSquare, size: [usize; 3]) -> (usize, usize) {
    let axis = (0..3).find(|&k| square.iter().all(|at| at[k] == square[0][k])).unwrap_or(0);
    (axis, usize::from(square[0][axis] + 1 == size[axis]))
}

/// The squares of capped borders on a cell.
pub(super) fn squares_of(cell: [usize; 3], size: [usize; 3], border: [[Border; 2]; 3]) -> Vec<CapSquare> {
    let mut squares = Vec::new();
    for axis in 0..3 {
        let ends = [cell[axis] == 0, cell[axis] + 2 == size[axis]];
        for end in (0..2).filter(|end| ends[*end] && border[axis][*end] == Border::Capped) {
            squares.push(square(axis, end, [cell[(axis + 1) % 3], cell[(axis + 2) % 3]], size));
        }
    }
    squares
}

/// A square in the low or the high border of an axis, by its first corner along the next two axes.
fn square(axis: usize, end: usize, [p, q]: [usize; 2], size: [usize; 3]) -> CapSquare {
    let corner = |a: usize, b: usize| {
        let mut at = [0; 3];
        at[axis] = if end == 0 { 0 } else { size[axis] - 1 };
        at[(axis + 1) % 3] = p + a;
        at[(axis + 2) % 3] = q + b;
        at
    };
    let mut square = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
    if end == 0 {
        square.reverse();
    }
    square
}

/// Visits all squares of capped borders with an inside sample, in a fixed order.
pub(super) fn for_each_square(bits: &SignBits, mut each: impl FnMut(CapSquare)) {
    let size = bits.size;
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (end, border) in bits.capped_ends(axis).into_iter().enumerate() {
            if border == Border::Open {
                continue;
            }
            for q in 0..size[v] - 1 {
                for p in 0..size[u] - 1 {
                    let square = square(axis, end, [p, q], size);
                    if square.iter().any(|at| bits.is_inside(*at)) {
                        each(square);
                    }
                }
            }
        }
    }
}
