//! `VoxelGrid`: the octree as a lattice, to find a point's cell in one step, and to skip empty space.
use crate::math::lesser;

/// A part of space: 8 consecutive children, a cell, or a part without surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FieldOctreeNode {
    Outside,
    Inside,
    Children(u32),
    Cell(u32),
}

/// The cube in equal voxels, as small as its smallest cells.
#[derive(Clone, Debug, Default)]
pub(super) struct VoxelGrid {
    /// Voxels along a side.
    pub across: u32,
    /// By z, y and x.
    voxels: Vec<u32>,
}

/// The content of a voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Voxel {
    /// All of it is on one side (1 outside, −1 inside), as are this many voxels around it in every direction.
    Side(i8, u32),
    /// A part of a cell.
    Cell(u32),
}

const CELL: u32 = 1 << 31;
const INSIDE: u32 = 1 << 30;

impl VoxelGrid {
    /// The voxels of an octree with this many levels below its root.
    pub fn from_octree(parts: &[FieldOctreeNode], levels: u32) -> Self {
        let across = 1 << levels;
        let n = across as usize;
        let mut voxels = vec![0; n * n * n];
        let mut open = vec![(0, [0, 0, 0], across)];
        while let Some((part, at, width)) = open.pop() {
            let value = match parts[part as usize] {
                FieldOctreeNode::Children(first) => {
                    let half = width / 2;
                    for i in 0..8 {
                        open.push((first + i, [0, 1, 2].map(|k| at[k] + half * (i >> k & 1)), half));
                    }
                    continue;
                }
                FieldOctreeNode::Outside => 0,
                FieldOctreeNode::Inside => INSIDE,
                FieldOctreeNode::Cell(cell) => CELL | cell,
            };
            for z in at[2]..at[2] + width {
                for y in at[1]..at[1] + width {
                    let row = (z as usize * n + y as usize) * n + at[0] as usize;
                    voxels[row..row + width as usize].fill(value);
                }
            }
        }
        for side in [0, INSIDE] {
            let distances = chessboard_distances(&voxels, side, n);
            for (voxel, distance) in voxels.iter_mut().zip(distances) {
                if *voxel == side && distance > 0 {
                    // All voxels that are nearer than the distance are on this side as well.
                    *voxel |= u32::from(distance) - 1;
                }
            }
        }
        Self { across, voxels }
    }

    /// The voxel at a position in units of voxels; beyond the cube, the nearest voxel.
    #[inline]
    pub fn at(&self, at: [f64; 3]) -> ([u32; 3], Voxel) {
        // A negative number becomes 0.
        let at = at.map(|x| (x as u32).min(self.across - 1));
        let n = self.across as usize;
        let content = self.voxels[(at[2] as usize * n + at[1] as usize) * n + at[0] as usize];
        let voxel = if content & CELL != 0 {
            Voxel::Cell(content & !CELL)
        } else {
            Voxel::Side(if content & INSIDE == 0 { 1 } else { -1 }, content & !INSIDE)
        };
        (at, voxel)
    }
}

/// The chessboard distance of each voxel to the nearest one that is not entirely on `side`; 0 for such voxels
/// themselves, and 255 if none is nearer. One pass up and one down, each with the neighbours that it has
/// already visited.
///
/// Source: A. Rosenfeld, J. Pfaltz, *Sequential operations in digital picture processing*, 1966.
fn chessboard_distances(voxels: &[u32], side: u32, n: usize) -> Vec<u8> {
    let mut distances: Vec<u8> = voxels.iter().map(|voxel| if *voxel == side { 255 } else { 0 }).collect();
    let least = |a: u8, b: u8| lesser(a, b);
    let mut near = vec![255; n];
    for up in [true, false] {
        for line in 0..n * n {
            let line = if up { line } else { n * n - 1 - line };
            let (z, y) = (line / n, line % n);
            // The lines before this one: three of the layer before, and one of this layer.
            let step =
                |x: usize, by: isize| x.checked_add_signed(if up { -by } else { by }).filter(|x| *x < n);
            let before = [(1, 1), (1, 0), (1, -1), (0, 1)];
            near.fill(255);
            for line in before.iter().filter_map(|(dz, dy)| Some(step(z, *dz)? * n + step(y, *dy)?)) {
                for (near, distance) in near.iter_mut().zip(&distances[line * n..line * n + n]) {
                    *near = least(*near, *distance);
                }
            }
            let line_distances = &mut distances[line * n..line * n + n];
            let mut last = 255;
            for i in 0..n {
                let x = if up { i } else { n - 1 - i };
                let beside =
                    least(if x > 0 { near[x - 1] } else { 255 }, if x + 1 < n { near[x + 1] } else { 255 });
                last = least(line_distances[x], least(least(near[x], beside), last).saturating_add(1));
                line_distances[x] = last;
            }
        }
    }
    distances
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voxels_know_how_far_their_side_goes() {
        // A cube of 8³ voxels, outside except for a cell of one voxel, a cell of 2³ and one of 2³ that is
        // inside.
        let mut parts = vec![FieldOctreeNode::Children(1)];
        parts.resize(9, FieldOctreeNode::Outside);
        let divide = |parts: &mut Vec<FieldOctreeNode>, part: usize| {
            let first = parts.len();
            parts[part] = FieldOctreeNode::Children(first as u32);
            parts.resize(first + 8, FieldOctreeNode::Outside);
            first
        };
        let low = divide(&mut parts, 1);
        parts[low + 7] = FieldOctreeNode::Cell(5);
        let lower = divide(&mut parts, low);
        parts[lower + 7] = FieldOctreeNode::Cell(6);
        let high = divide(&mut parts, 8);
        parts[high + 7] = FieldOctreeNode::Inside;
        let rooms = VoxelGrid::from_octree(&parts, 3);
        let all = (0..512).map(|i| [i % 8, i / 8 % 8, i / 64]);
        let kind = |p: [i32; 3]| match rooms.at(p.map(f64::from)).1 {
            Voxel::Side(side, _) => i32::from(side),
            Voxel::Cell(cell) => 10 + cell as i32,
        };
        assert_eq!((kind([1; 3]), kind([3; 3]), kind([7; 3]), kind([0; 3])), (16, 15, -1, 1));
        for p in all.clone() {
            let Voxel::Side(_, clear) = rooms.at(p.map(f64::from)).1 else { continue };
            let apart = |q: [i32; 3]| (0..3).map(|k| (p[k] - q[k]).abs()).max().unwrap_or(0);
            let truth =
                all.clone().filter(|q| kind(*q) != kind(p)).map(apart).min().expect("there are others");
            assert_eq!(clear as i32 + 1, truth, "{p:?}");
        }
    }
}
