//! `OctreeMesh`: the triangles of the cells of an octree, with shared vertices.
//!
//! Cells are meshed in groups with separate vertices; then the vertices of all groups are sorted by their places, so that
//! a place has one number. Vertices are in the order of their places, and triangles in the order of their cells, on any
//! number of threads.
use super::normals::SampleGradient;
use super::octree::OctreeCell;
use super::rule::{Border, Normals};
use super::transition_cells::{OctreeSurface, OctreeTriangle, OctreeVertex, VertexOrder};
use crate::budget::{Job, par_map};

/// Plain arrays.
pub(in crate::convert) struct OctreeMesh {
    pub positions: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
    /// One for each vertex, or none.
    pub normals: Vec<[f64; 3]>,
}

/// The triangles of some cells, and their vertices in order.
struct CellGroup {
    vertices: Vec<(VertexOrder, [f64; 3])>,
    normals: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
}

/// Cells in a group. Chosen: a group has a few thousand triangles.
const GROUP: usize = 1024;

impl OctreeMesh {
    /// The triangles of the cells that the surface passes, in the order of the cells, and then the triangles of all caps.
    pub(super) fn new(surface: &OctreeSurface<'_>, leaves: &[OctreeCell], job: &Job) -> Self {
        let capped = capped_leaves(surface);
        let cells: Vec<&[OctreeCell]> = leaves.chunks(GROUP).collect();
        let caps: Vec<&[OctreeCell]> = capped.chunks(GROUP).collect();
        let mut groups = par_map(job, &cells, |_, cells| {
            CellGroup::new(surface, |each| {
                for cell in cells.iter().filter(|_| !job.is_cancelled()) {
                    surface.for_each_triangle(*cell, &surface.values(*cell), &mut *each);
                }
            })
        });
        groups.extend(par_map(job, &caps, |_, cells| {
            CellGroup::new(surface, |each| {
                for cell in cells.iter().filter(|_| !job.is_cancelled()) {
                    surface.for_each_cap_triangle(*cell, &surface.values(*cell), &mut *each);
                }
            })
        }));
        Self::from_groups(&groups)
    }

    fn from_groups(groups: &[CellGroup]) -> Self {
        let mut all: Vec<(VertexOrder, u32, u32)> = Vec::new();
        for (group, CellGroup { vertices, .. }) in groups.iter().enumerate() {
            all.extend(vertices.iter().enumerate().map(|(at, vertex)| (vertex.0, group as u32, at as u32)));
        }
        // By place, so that the numbers do not depend on the groups.
        all.sort_unstable();
        let mut octree_mesh = Self { positions: Vec::new(), faces: Vec::new(), normals: Vec::new() };
        let mut numbers: Vec<Vec<u32>> = groups.iter().map(|group| vec![0; group.vertices.len()]).collect();
        let mut last = None;
        for (order, group, at) in all {
            let (group, at) = (group as usize, at as usize);
            if last != Some(order) {
                last = Some(order);
                octree_mesh.positions.push(groups[group].vertices[at].1);
                octree_mesh.normals.extend(groups[group].normals.get(at));
            }
            numbers[group][at] = octree_mesh.positions.len() as u32 - 1;
        }
        for (group, numbers) in groups.iter().zip(&numbers) {
            octree_mesh.faces.extend(group.faces.iter().map(|face| face.map(|v| numbers[v as usize])));
        }
        octree_mesh
    }
}

impl CellGroup {
    fn new(surface: &OctreeSurface<'_>, visit: impl FnOnce(&mut dyn FnMut(OctreeTriangle))) -> Self {
        let mut corners: Vec<OctreeVertex> = Vec::new();
        visit(&mut |triangle| corners.extend(triangle));
        let mut order: Vec<(VertexOrder, u32)> =
            corners.iter().enumerate().map(|(at, vertex)| (vertex.order(), at as u32)).collect();
        order.sort_unstable();
        let place = surface.place();
        let gradient = SampleGradient::new(surface.source, surface.affine, surface.rule);
        let mut group = Self { vertices: Vec::new(), normals: Vec::new(), faces: Vec::new() };
        let mut numbers = vec![0_u32; corners.len()];
        for (order, at) in order {
            if group.vertices.last().is_none_or(|last| last.0 != order) {
                let vertex = &corners[at as usize];
                group.vertices.push((order, vertex.point(&place, surface.rule.offset)));
                if surface.rule.normals == Normals::Gradient {
                    group.normals.push(gradient.normal_at(vertex.index()));
                }
            }
            numbers[at as usize] = group.vertices.len() as u32 - 1;
        }
        // A map that mirrors turns triangles inside out.
        let is_upright = surface.affine.orientation() > 0;
        let turned = |face: &[u32; 3]| if is_upright { *face } else { [face[0], face[2], face[1]] };
        group.faces = numbers.as_chunks::<3>().0.iter().map(turned).collect();
        group
    }
}

/// The leaves with a side in a capped border that has an inside corner.
fn capped_leaves(surface: &OctreeSurface<'_>) -> Vec<OctreeCell> {
    let border = &surface.rule.border;
    let size = surface.source.size();
    let is_capped = |cell: &OctreeCell, axis: usize, end: usize| {
        let last = ((size[axis] - 1) << cell.level) as u32 - 1;
        border[axis][end] == Border::Capped && cell.at[axis] == if end == 0 { 0 } else { last }
    };
    let has_cap = |cell: &OctreeCell| {
        let values = surface.values(*cell);
        (0..6).filter(|side| is_capped(cell, side / 2, side % 2)).any(|side| {
            let corners = (0..8).filter(|c: &usize| c >> (side / 2) & 1 == side % 2);
            corners.into_iter().any(|c| surface.rule.is_inside(values[c]))
        })
    };
    let [nx, ny, nz] = size.map(|n| n as u32 - 1);
    let mut leaves = Vec::new();
    let mut open = Vec::new();
    for k in 0..nz {
        for j in 0..ny {
            // Between its ends a row has a side in a border only if all of the row has one.
            let is_row = [j, k].contains(&0) || j + 1 == ny || k + 1 == nz;
            let step = if is_row || nx == 1 { 1 } else { nx as usize - 1 };
            for i in (0..nx).step_by(step) {
                open.push(OctreeCell { level: 0, at: [i, j, k] });
                while let Some(cell) = open.pop() {
                    if !(0..6).any(|side| is_capped(&cell, side / 2, side % 2)) {
                        continue;
                    }
                    if surface.halved.is_cell_halved(cell) {
                        open.extend(cell.parts().into_iter().rev());
                    } else if has_cap(&cell) {
                        leaves.push(cell);
                    }
                }
            }
        }
    }
    leaves
}
