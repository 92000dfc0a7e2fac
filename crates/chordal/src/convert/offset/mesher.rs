//! Cells are cut until all samples of the triangles are near the surface.
use super::contour::{Contour, ContourMemo, contour};
use super::distance::{Hint, OffsetDistance};
use super::octree::{FINEST, Octree};
use crate::budget::{Job, JobError, par_map};
use crate::explicit::Mesh;
use crate::math::{Box3, greater};
use std::collections::{BTreeSet, HashSet}; // of no order that is seen

/// The size of the finest cells as a share of the tolerance. Chosen: a crease through them is off by less.
const FINEST_SHARE: f64 = 0.5;
/// The most rounds of cutting: a cell as large as the distance is cut to the finest size.
const ROUNDS: usize = 16;
/// Weights of the points of a triangle at which its distance is measured.
const POINTS: [[f64; 3]; 4] =
    [[1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]];
/// Triangles of a task.
const TASK: usize = 64;

/// The corners of triangles, by their bits. No result depends on the order of the hash set: it is asked, and not listed.
type NearTriangles = HashSet<[[u64; 3]; 3]>; // of no order that is seen

/// Makes triangles of the surface at a distance from a solid.
pub(crate) struct OffsetMesher {
    tree: Octree,
    known: ContourMemo,
    tolerance: f64,
}

impl OffsetMesher {
    /// For triangles whose samples are within a tolerance of the surface at the signed distance `by`.
    ///
    /// # Errors
    /// As for [`Bvh::build`](crate::explicit::query::Bvh::build).
    pub fn new(mesh: &Mesh, by: f64, tolerance: f64, job: &Job) -> Result<Self, JobError> {
        let distance = OffsetDistance::new(mesh, by, job)?;
        let bounds = mesh.bounds();
        let grow = greater(by, 0.0) * 1.01 + 2.0 * tolerance;
        let bounds = Box3 { min: bounds.min.map(|x| x - grow), max: bounds.max.map(|x| x + grow) };
        let tree = Octree::new(distance, &bounds, FINEST_SHARE * tolerance, tolerance, job);
        Ok(Self { tree, known: ContourMemo::default(), tolerance })
    }

    /// The triangles, after cells were cut until all of their samples are within the tolerance, or cells cannot be cut any
    /// more.
    ///
    /// # Errors
    /// If the job is cancelled.
    pub fn triangles(&mut self, job: &Job) -> Result<Mesh, JobError> {
        let Self { tree, known, tolerance } = self;
        let mut surface = contour(tree, known, job);
        let mut near = NearTriangles::default();
        for _ in 0..ROUNDS {
            if job.is_cancelled() {
                return Err(JobError::Cancelled);
            }
            let cut = leaves_to_cut(&surface, tree, *tolerance, &mut near, job);
            if cut.is_empty() || job.is_finishing() {
                break;
            }
            tree.cut(&cut, job);
            surface = contour(tree, known, job);
        }
        Ok(Mesh::new(surface.positions, surface.faces).expect("vertices are in finite cells"))
    }

    /// Cuts the cells around some points. Returns whether there is one that could be cut.
    pub fn cut_near(&mut self, points: &[[f64; 3]], job: &Job) -> bool {
        let leaves: BTreeSet<u32> = points.iter().filter_map(|p| self.tree.leaf_near(*p)).collect();
        let is_large = |leaf: &u32| self.tree.leaves[*leaf as usize].size > FINEST;
        let leaves: Vec<u32> = leaves.into_iter().filter(is_large).collect();
        self.tree.cut(&leaves, job);
        !leaves.is_empty()
    }
}

/// The leaves of triangles that are too far, the largest ones of each, and those whose vertex was not found. Triangles that
/// were near in an earlier round are not measured again.
fn leaves_to_cut(
    surface: &Contour,
    tree: &Octree,
    tolerance: f64,
    near: &mut NearTriangles,
    job: &Job,
) -> Vec<u32> {
    let corners = |number: usize| surface.faces[number].map(|v| surface.positions[v as usize]);
    let key = |number: usize| corners(number).map(|p| p.map(f64::to_bits));
    let new: Vec<usize> = (0..surface.faces.len()).filter(|number| !near.contains(&key(*number))).collect();
    let tasks: Vec<&[usize]> = new.chunks(TASK).collect();
    let is_far = par_map(job, &tasks, |_, numbers| {
        let mut hint = Hint::default();
        let mut is_far = |number: &usize| {
            let corners = corners(*number);
            POINTS.iter().any(|weights| {
                let at = std::array::from_fn(|k| (0..3).map(|c| weights[c] * corners[c][k]).sum());
                tree.distance().at(at, &mut hint).value.abs() > tolerance
            })
        };
        numbers.iter().map(&mut is_far).collect::<Vec<bool>>()
    });
    let mut cut: BTreeSet<u32> = surface.unsure.clone();
    for (number, is_far) in new.iter().zip(is_far.into_iter().flatten()) {
        if !is_far {
            near.insert(key(*number));
            continue;
        }
        let ring = surface.leaves[*number];
        let size = |leaf: &u32| tree.leaves[*leaf as usize].size;
        let largest = ring.iter().map(size).max();
        cut.extend(ring.iter().filter(|leaf| Some(size(leaf)) == largest));
    }
    cut.into_iter().filter(|leaf| tree.leaves[*leaf as usize].size > FINEST).collect()
}
