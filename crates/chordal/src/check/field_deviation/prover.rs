//! `SandwichProver`: proves meshes against one field, from both sides at once.
//!
//! A [`Sandwich`] of two displaced copies of the mesh bounds both directions, provided that each component of
//! the inside and of the outside is accounted for: the outer copy winds once around a point of each inner
//! one, and the inner copy does not wind around one of each outer one. The cells of a [`FieldCover`] list
//! such points.
//!
//! **Open cells.** A cell that the cover leaves open is as good as decided if the outer copy misses it and
//! winds once around it, and the inner copy misses it and does not wind around it: a flow that ends in the
//! cell ends in a component of A* around which the outer copy winds once, since it misses A*; likewise for
//! B*. So if solids touch, cells between both copies settle the place.
use super::cell_growth::WindingProbe;
use super::cover::FieldCover;
use super::leaf_failure;
use super::regions::SignRegions;
use super::sandwich::{ClosedMesh, Sandwich, SandwichGoal};
use crate::budget::{Job, JobError};
use crate::explicit::{Bvh, Enclosure, Mesh};
use crate::implicit::{Csg, LeafError, Membership, PrimitiveEvaluator};
use crate::math::{Box3, add_up, cross, difference, greater, sub_down};

/// The verdict on a mesh.
#[derive(Clone, Debug)]
pub(crate) struct SandwichVerdict {
    /// Faces whose copy was not proved to be outside, and faces whose copy was not proved to be inside;
    /// ascending.
    pub open: [Vec<u32>; 2],
    /// By face: an upper bound on the distance of its points from the surface, unless the face is open.
    pub bounds: Vec<f64>,
    /// The largest of these bounds.
    pub bound: f64,
    /// Points inside around which the mesh does not wind once, and points outside around which it winds.
    pub wrong: Vec<WindingProbe>,
    /// Boxes in which the mesh may miss a part of the surface.
    pub unresolved: Vec<Box3>,
}

impl SandwichVerdict {
    /// A verdict from faces alone, without the cells between copies.
    fn from_faces(open: [Vec<u32>; 2], bounds: Vec<f64>) -> Self {
        let bound = largest(&bounds);
        Self { open, bounds, bound, wrong: Vec::new(), unresolved: Vec::new() }
    }

    /// A point at which something is unproved, if there is any.
    pub fn first_unproved_point(&self, mesh: &Mesh) -> Option<[f64; 3]> {
        let face = self
            .open
            .iter()
            .flatten()
            .min()
            .map(|face| Box3::from_points(&mesh.corners(*face as usize)).centre());
        let unresolved = || self.unresolved.first().map(Box3::centre);
        face.or_else(|| self.wrong.first().map(|point| point.at)).or_else(unresolved)
    }

    /// Whether the mesh and the surface are proved to be within the bound from each other.
    pub fn is_proved(&self) -> bool {
        self.open.iter().all(Vec::is_empty) && self.wrong.is_empty() && self.unresolved.is_empty()
    }
}

/// Proves meshes against one field; each further mesh is cheaper than the first.
pub(crate) struct SandwichProver<'a> {
    evaluator: PrimitiveEvaluator<'a>,
    cover: FieldCover,
    regions: SignRegions,
    job: &'a Job,
}

/// The first cover's cells are no smaller than this share of its cube; cells still open are examined with
/// each mesh. Chosen: a smaller value costs more at first, a larger one more for each mesh.
const FIRST_FLOOR: f64 = 1.0 / 128.0;
/// The size of cells between both copies, as a share of the bound. Chosen: the copies are up to twice the
/// bound apart, so that a cell of a quarter usually fits.
const CELL_SHARE: f64 = 0.125;
/// The same if few cells are left: about points where surfaces nearly touch, smaller cells resolve more.
const LEAST_CELL_SHARE: f64 = 1.0 / 256.0;
/// The most cells that count as few. Chosen: a larger value examines smaller cells for more meshes.
const FEW_CELLS: usize = 4096;

impl<'a> SandwichProver<'a> {
    /// The number of primitive ranges evaluated so far.
    #[cfg(test)]
    pub fn n_boxes(&self) -> u64 {
        self.evaluator.n_boxes()
    }

    /// Builds the first cover of the field.
    pub fn new(csg: &'a Csg, bounds: &Box3, job: &'a Job) -> Result<Self, LeafError> {
        let evaluator = PrimitiveEvaluator::new(csg, bounds, job);
        let mut cover = FieldCover::new(&evaluator, bounds, job.memory_limit);
        let domain = cover.domain();
        let mut evaluator = PrimitiveEvaluator::new(csg, &domain, job);
        let floor = FIRST_FLOOR * (domain.max[0] - domain.min[0]);
        let mut regions = SignRegions::new(&evaluator, &domain, job.memory_limit);
        cover.refine(&mut evaluator, &mut regions, |_, size| size > floor)?;
        Ok(Self { evaluator, cover, regions, job })
    }

    /// Proves a mesh. A mesh is closed if at each edge, by index or by position, equally many half-edges run
    /// in each direction; all faces of one that is not closed are open.
    pub fn prove(&mut self, mesh: &Mesh, goal: &SandwichGoal) -> Result<SandwichVerdict, JobError> {
        let weld = self.evaluator.csg().weld();
        if weld == 0.0 {
            return self.prove_tree(mesh, goal);
        }
        // Levels that were merged into one differ from the field's by so much.
        let within = goal.limit.map(|limit| greater(sub_down(limit, weld), 0.0));
        let mut verdict = self.prove_tree(mesh, &SandwichGoal { limit: within, ..*goal })?;
        verdict.bounds.iter_mut().for_each(|bound| *bound = add_up(*bound, weld));
        verdict.bound = largest(&verdict.bounds);
        Ok(verdict)
    }

    /// Proves a mesh against the tree of primitives, closer and then with wider copies.
    fn prove_tree(&mut self, mesh: &Mesh, goal: &SandwichGoal) -> Result<SandwichVerdict, JobError> {
        let verdict = self.prove_once(mesh, goal)?;
        let is_hidden = verdict.open.iter().all(Vec::is_empty) && !verdict.unresolved.is_empty();
        match goal.wider().filter(|_| is_hidden && !self.job.is_over()) {
            Some(wider) => {
                let wide = self.prove_once(mesh, &wider)?;
                // A caller that splits faces may split those that are in the way of copies farther apart.
                let is_worth = goal.faces_first && !wide.open.iter().all(Vec::is_empty);
                Ok(if wide.is_proved() || is_worth { wide } else { verdict })
            }
            None => Ok(verdict),
        }
    }

    fn prove_once(&mut self, mesh: &Mesh, goal: &SandwichGoal) -> Result<SandwichVerdict, JobError> {
        let Some(tied) = ClosedMesh::from_mesh(mesh) else {
            let faces: Vec<u32> = (0..mesh.faces().len() as u32).collect();
            let bounds = vec![f64::INFINITY; faces.len()];
            let open = [faces.clone(), faces];
            return Ok(SandwichVerdict::from_faces(open, bounds));
        };
        let sandwich =
            Sandwich::build(&mut self.regions, &mut self.evaluator, &tied, goal).map_err(leaf_failure)?;
        let is_closed = sandwich.open.iter().all(Vec::is_empty);
        // The caller will split these faces, which changes the copies: looking at cells would be
        // wasted.
        if !is_closed && goal.faces_first {
            return Ok(SandwichVerdict::from_faces(sandwich.open, sandwich.bounds));
        }
        let bound = largest(&sandwich.bounds);
        let copies = sandwich.copies;
        let bvhs = [Bvh::build(&copies[0], self.job)?, Bvh::build(&copies[1], self.job)?];
        let copy_pair = SandwichCopies {
            meshes: [&copies[0], &copies[1]],
            bvhs: [&bvhs[0], &bvhs[1]],
            enclosures: [Enclosure::new(&copies[0], &bvhs[0]), Enclosure::new(&copies[1], &bvhs[1])],
        };
        let mut refine = |share: f64| {
            // A cell that the copies settle need not be divided, however large it is.
            let is_worth = |bounds: &Box3, size: f64| size > share * bound && !copy_pair.proves_cell(bounds);
            self.cover.refine(&mut self.evaluator, &mut self.regions, is_worth).map_err(leaf_failure)?;
            Ok::<usize, JobError>(self.cover.open.len())
        };
        if is_closed && refine(CELL_SHARE)? <= FEW_CELLS {
            refine(LEAST_CELL_SHARE)?;
        }
        let open = self.cover.open.iter().map(|cell| self.cover.bounds_of(&self.cover.cells[*cell as usize]));
        let unresolved = open.filter(|bounds| !copy_pair.proves_cell(bounds)).collect();
        let wrong =
            self.cover.winding_probes().into_iter().filter(|point| !copy_pair.is_right(point)).collect();
        Ok(SandwichVerdict { open: sandwich.open, bounds: sandwich.bounds, bound, wrong, unresolved })
    }
}

fn largest(bounds: &[f64]) -> f64 {
    bounds.iter().fold(0.0, |most, x| greater(*x, most))
}

/// The outer and the inner copy.
struct SandwichCopies<'a> {
    meshes: [&'a Mesh; 2],
    bvhs: [&'a Bvh; 2],
    enclosures: [Enclosure<'a>; 2],
}

/// The required winding numbers: of the outer copy around inside points, and of the inner copy around outside
/// points.
const WINDINGS: [f64; 2] = [1.0, 0.0];

impl SandwichCopies<'_> {
    fn winding(&self, copy: usize, at: [f64; 3]) -> f64 {
        self.enclosures[copy].inside(at).winding.value
    }

    fn is_right(&self, point: &WindingProbe) -> bool {
        let copy = usize::from(point.side == Membership::Outside);
        self.winding(copy, point.at) == WINDINGS[copy]
    }

    /// Whether a cell is between both copies, so that nothing is missed in it.
    fn proves_cell(&self, bounds: &Box3) -> bool {
        let centre = bounds.centre();
        (0..2).all(|copy| {
            let mut is_free = true;
            self.bvhs[copy].faces_in_box(bounds, |face| {
                is_free = is_free && is_separated(bounds, &self.meshes[copy].corners(face as usize));
            });
            is_free && self.winding(copy, centre) == WINDINGS[copy]
        })
    }
}

/// Rounding of a comparison, relative to the largest coordinate times the axis: derived, some ten roundings
/// of numbers up to twice that.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Whether no point of the triangle is in the box; `false` if that is uncertain.
pub(super) fn is_separated(bounds: &Box3, corners: &[[f64; 3]; 3]) -> bool {
    let outside = |k: usize| {
        corners.iter().all(|p| p[k] < bounds.min[k]) || corners.iter().all(|p| p[k] > bounds.max[k])
    };
    if (0..3).any(outside) {
        return true;
    }
    let centre = bounds.centre();
    let half: [f64; 3] = std::array::from_fn(|k| 0.5 * (bounds.max[k] - bounds.min[k]));
    let local = corners.map(|p| difference(p, centre));
    let coordinates = corners.as_flattened().iter().chain(&bounds.min).chain(&bounds.max);
    let reach = coordinates.fold(0.0, |most: f64, x| greater(x.abs(), most));
    let separates = |axis: [f64; 3]| {
        let along = local.map(|p| axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2]);
        let size = axis[0].abs() + axis[1].abs() + axis[2].abs();
        let radius = (0..3).fold(0.0, |sum, k| sum + axis[k].abs() * half[k]);
        let far = radius + ROUNDING * size * reach;
        along.iter().all(|x| *x > far) || along.iter().all(|x| *x < -far)
    };
    // Two convex bodies are apart along a normal of a face of either, or along a product of two of
    // their edges. Those of the box were tried above; here come the triangle's normal and the
    // products of its sides with the axes.
    let sides: [[f64; 3]; 3] = std::array::from_fn(|k| difference(local[(k + 1) % 3], local[k]));
    if separates(cross(sides[0], sides[1])) {
        return true;
    }
    sides
        .iter()
        .any(|[x, y, z]| separates([0.0, *z, -y]) || separates([-z, 0.0, *x]) || separates([*y, -x, 0.0]))
}
