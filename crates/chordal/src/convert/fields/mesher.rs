//! `FieldMesher`: meshes a field in steps: adaptive cells, the boundary in them, its improvement.
use super::extract::extract;
use super::field_sampler::FieldSampler;
use super::grid::{FieldGrid, FieldGridError, FieldGridStatus, GridOptions};
use super::improve::{BlockedPlace, ImproveError, LabelledSurface, SurfaceImprover};
use super::sizing::SizingPoint;
use crate::budget::{Failure, Job, Progress, RefusalCode, RequiredEvidence, Tolerance};
use crate::explicit::Mesh;
use crate::implicit::{Dual, LeafError, PrimitiveEvaluator, Tape};
use crate::math::{Box3, greater, length, lesser};

/// The most times that cells are cut again where vertices of the surface are blocked. Measured: twice was
/// enough on all models of the tests.
const MOST_CUTS: usize = 3;
/// The same if there were at most [`FEW_CUT`] places the last time. Measured: along a crease in coarse cells the blocked
/// place moves on by one cell each time, until the crease ends.
const MOST_CUTS_OF_FEW: usize = 12;
/// Up to this many places are few. Chosen: so few cost little time.
const FEW_CUT: usize = 32;
/// Cells are not cut again for edges that stay stuck while triangles are refined, unless cutting has reduced their number by
/// this factor. Measured: of the walls of a gyroid 160 were stuck, and 140 in smaller cells.
const HELPED: usize = 2;
/// The most times that cells are cut again after triangles were improved. Measured: one was enough.
const MOST_LATE: usize = 2;
/// Cells are not cut again if more vertices than this are blocked: the function has poles there, or is noise.
/// Measured: 750 on a drawing of letters.
const MOST_TIGHT: usize = 4096;
/// Cells are not cut a second time for less than one vertex in this many faces: later steps make room for them, or the proof
/// reports them. Chosen: all cells would be polygonized again, and all vertices placed.
const FEW_TIGHT: usize = 4096;
/// Cells are not cut again for vertices away from the surface if they are more than one in this many: the function jumps
/// there. Measured: one in 200 on a gyroid in a cube, one in 8 at the meeting of 48 balls.
const ASTRAY: usize = 6;
/// Cells are kept for another attempt while triangles are improved if they take at most the inverse of this of the memory.
/// Chosen: another attempt with larger grids takes long as well.
const KEPT_SHARE: u64 = 64;
/// Cells are cut again even for few vertices if their distance from the surface is this many times the allowed one. Chosen:
/// smaller excesses are left to the proof.
const FAR: f64 = 1.25;
/// The longest edge of cells, relative to the longest side of the bounds. Chosen: ranges decide which cells
/// are cut, so that large ones cost nothing.
const COARSEST: f64 = 0.5;
/// The same if functions are sampled. Chosen: features of a tenth of the bounds are found.
const SAMPLED: f64 = 1.0 / 24.0;
/// Cells are not cut below this fraction of the tolerance. Chosen: smaller cells would only cost time.
const FLOOR: f64 = 0.5;
/// At coarse tolerances, cells are cut down to this fraction of the longest side of the bounds, so that the shape gets the
/// cells that it needs. Chosen: finer details seldom matter at such tolerances.
const DETAIL: f64 = 1.0 / 512.0;
/// The smallest meaningful length, relative to the largest coordinate. Chosen: proofs need a margin for some
/// hundred roundings.
const FINEST: f64 = 1.0 / (1_u64 << 42) as f64;
/// Error estimates of coarse faces are too high by at most about this. Measured on the models of the tests:
/// by 1.2 to 3 where most faces have to be split.
const OVERESTIMATE: f64 = 4.0;
/// The approximate bytes of a face while it is improved and proved: half-edges, samples, both copies and
/// their trees.
const BYTES_A_FACE: u64 = 800;

/// The limits of a mesh of a field.
#[derive(Clone, Copy, Debug)]
pub(in crate::convert) struct FieldMeshGoal {
    /// The largest distance from the surface.
    pub length: Option<Tolerance>,
    /// The most triangles.
    pub triangles: Option<u64>,
    /// The evidence that is accepted.
    pub require: RequiredEvidence,
}

/// The region and the job of meshing a field.
pub(super) struct FieldMesher<'a> {
    pub bounds: Box3,
    /// Whether some function has no ranges of its slopes, and is sampled.
    pub is_sampled: bool,
    /// The tape of the field's sign.
    pub tape: &'a Tape,
    pub job: &'a Job,
}

/// The result of [`FieldMesher::improved_surface`].
pub(super) struct ImprovedSurface<'a> {
    pub surface: SurfaceImprover<'a>,
    /// How completely its cells were refined.
    pub extent: FieldGridStatus,
}

/// Vertices or faces away from the surface.
#[derive(Default)]
struct Astray {
    places: Vec<BlockedPlace>,
    /// How many of them are far away.
    n_far: usize,
}

impl From<FieldGridError> for Failure<Mesh> {
    fn from(error: FieldGridError) -> Self {
        match error {
            FieldGridError::Leaf(leaf) => leaf_failure(leaf),
            FieldGridError::Cancelled => Self::Cancelled,
        }
    }
}

impl From<ImproveError> for Failure<Mesh> {
    fn from(error: ImproveError) -> Self {
        match error {
            ImproveError::Leaf(error) => leaf_failure(error),
            ImproveError::Cancelled => Self::Cancelled,
            ImproveError::TooMany(most) => {
                let message = format!("the budget needs more than {most} triangles, which is the limit");
                Self::refused(RefusalCode::TooManyTriangles, message)
            }
            ImproveError::TooLarge(bytes) => {
                Self::refused(RefusalCode::TooMuchMemory, too_large(bytes as f64))
            }
            // Extracted surfaces are manifold, unless coordinates have too few digits to separate their
            // vertices.
            ImproveError::NotManifold => Self::refused(
                RefusalCode::BelowPrecision,
                "the shape has details that are too small for the digits of its coordinates: move it to \
                 the origin if it is far from there; twist and repeat it less often",
            ),
        }
    }
}

/// The error if neighbouring cells disagree about their common face: only an inconsistent leaf can cause it.
fn contradiction() -> LeafError {
    LeafError::new(
        "a leaf contradicts itself: a value lies outside of the range that it gave for a box around the \
         point, two calls gave different values for one point, or it is negative outside of the bounds \
         that it was given",
    )
}

fn too_large(bytes: f64) -> String {
    /// 2²⁰.
    const MIB: f64 = (1_u64 << 20) as f64;
    format!(
        "the budget needs more than {:.0} MiB of memory, which is more than this job may have: allow a larger error, or \
         more memory",
        bytes / MIB
    )
}

pub(in crate::convert) fn leaf_failure(error: LeafError) -> Failure<Mesh> {
    Failure::refused(RefusalCode::LeafFailed, error.message)
}

/// The longest side of a box.
pub(super) fn longest(bounds: &Box3) -> f64 {
    (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, |a, b| greater(b, a))
}

impl<'a> FieldMesher<'a> {
    /// Builds cells, extracts the boundary in them and improves it: a surface of few triangles near that of the field, as
    /// far as samples show. Cells are cut again where other sheets keep vertices from their targets, and where edges
    /// cannot be split.
    pub fn improved_surface(
        &self,
        mut evaluator: PrimitiveEvaluator<'a>,
        tol: f64,
    ) -> Result<ImprovedSurface<'a>, Failure<Mesh>> {
        let report = |stage, done: usize| {
            self.job.report(Progress { stage, done: done as u64, total: 1 + MOST_CUTS_OF_FEW as u64 });
        };
        report("cells", 0);
        let options = self.grid_options(tol);
        let mut grid = FieldGrid::build(&mut evaluator, options, self.job)?;
        let mut cuts = if grid.extent() == FieldGridStatus::Exhausted { MOST_CUTS } else { 0 };
        let (mut n_cut, mut n_stuck, mut n_late) = (usize::MAX, usize::MAX, 0);
        let (mut surface, is_improved) = loop {
            report("surface", cuts);
            let raw = extract(&grid, self.job);
            if raw.faces.is_empty() {
                let message = match grid.extent() {
                    FieldGridStatus::Whole if self.is_sampled => {
                        "there is no surface to mesh: no sample is inside. The field is known only at its \
                         samples, which are a 42nd of the longest side of its bounds apart, or less along \
                         short sides: tighter bounds or a Lipschitz constant may reveal a surface"
                    }
                    FieldGridStatus::Whole => {
                        "there is no surface to mesh: nothing is inside, the field is nowhere negative within the \
                         box of the shape"
                    }
                    FieldGridStatus::CutShort | FieldGridStatus::Exhausted => {
                        "no surface was found with as many cells as this job may have: more memory or \
                         tighter bounds may reveal one"
                    }
                };
                return Err(Failure::refused(RefusalCode::Empty, message));
            }
            let start = LabelledSurface { positions: raw.positions, faces: raw.faces, labels: raw.labels };
            let has_leaves = evaluator.csg().primitives().iter().any(|p| p.tape().has_leaves());
            let mut surface = match SurfaceImprover::new(&start, evaluator, tol, self.job) {
                Err(ImproveError::NotManifold) if has_leaves => return Err(leaf_failure(contradiction())),
                result => result?,
            };
            drop(start);
            let mut tight = surface.blocked().to_vec();
            let most_cuts = if n_cut <= FEW_CUT { MOST_CUTS_OF_FEW } else { MOST_CUTS };
            let may_cut = cuts < most_cuts && !self.job.is_finishing();
            let mut misses = if may_cut { self.astray(&surface)? } else { Astray::default() };
            let n_more = MOST_TIGHT.saturating_sub(tight.len());
            tight.extend(misses.places.drain(..).take(n_more));
            // The cost of another attempt grows with the number of faces, so a few vertices do not justify one.
            let n_raw = surface.n_faces();
            // If too many vertices are blocked, smaller cells would not help.
            let is_enough = |tight: &[BlockedPlace], n_far: usize| {
                let are_few = cuts > 0 && n_far == 0 && tight.len() * FEW_TIGHT < n_raw;
                !may_cut || tight.is_empty() || tight.len() > MOST_TIGHT || are_few
            };
            if is_enough(&tight, misses.n_far) {
                // Estimates for coarse faces may be too high by this factor; the real number is checked later.
                self.check_size(surface.estimated_faces()? / OVERESTIMATE)?;
                tight = surface.refine()?;
                let n_before = std::mem::replace(&mut n_stuck, tight.len());
                if n_stuck > FEW_CUT && n_stuck > n_before / HELPED {
                    tight.clear();
                }
                // The vertices of the finer surface may detect parts that all coarse ones missed.
                misses = if may_cut { self.astray(&surface)? } else { Astray::default() };
                if misses.n_far > 0 && tight.len() + misses.places.len() <= MOST_TIGHT {
                    tight.append(&mut misses.places);
                }
            }
            if is_enough(&tight, misses.n_far) {
                // If cells cannot be cut again, their memory is freed before triangles are improved.
                if !may_cut || n_late == MOST_LATE || grid.bytes() > self.job.memory_limit / KEPT_SHARE {
                    break (surface, false);
                }
                surface.improve()?;
                // Beside stuck edges, faces may lie across a crease, or edges be split on the wrong surface.
                misses = self.astray(&surface)?;
                let across = self.astray_faces(&surface)?;
                misses.n_far += across.n_far;
                misses.places.extend(across.places);
                if misses.n_far == 0 {
                    break (surface, true);
                }
                n_late += 1;
                tight = misses.places;
            }
            let half =
                |place: &BlockedPlace| SizingPoint { at: place.at, size: 0.5 * grid.size_of(place.extent) };
            let places: Vec<SizingPoint> = tight.iter().map(half).collect();
            n_cut = tight.len();
            cuts += 1;
            report("cells", cuts);
            evaluator = surface.into_evaluator();
            grid.refine(&mut evaluator, &places)?;
        };
        let extent = grid.extent();
        drop(grid);
        if !is_improved {
            surface.improve()?;
        }
        self.check_size(surface.n_faces() as f64)?;
        Ok(ImprovedSurface { surface, extent })
    }

    /// Vertices that are on their primitives but away from the surface: cells are so coarse that other primitives end at
    /// the wrong places, or are missed.
    fn astray(&self, surface: &SurfaceImprover) -> Result<Astray, Failure<Mesh>> {
        let vertices = surface.vertices();
        let points = vertices.iter().map(|v| surface.position(*v)).collect();
        self.astray_of(surface, points, |k| surface.place_of(vertices[k]))
    }

    /// Faces whose middles are away from the surface.
    fn astray_faces(&self, surface: &SurfaceImprover) -> Result<Astray, Failure<Mesh>> {
        let faces = surface.faces();
        let points = faces.iter().map(|face| surface.middle_of_face(*face)).collect();
        self.astray_of(surface, points, |k| surface.place_of_face(faces[k]))
    }

    fn astray_of(
        &self,
        surface: &SurfaceImprover,
        points: Vec<[f64; 3]>,
        place_of: impl Fn(usize) -> BlockedPlace,
    ) -> Result<Astray, Failure<Mesh>> {
        if self.is_sampled {
            return Ok(Astray::default());
        }
        let sampler = FieldSampler { tape: self.tape, job: self.job };
        let slopes = sampler.duals(&points).map_err(leaf_failure)?;
        let is_farther =
            |slope: &Dual<f64>, distance: f64| slope.value.abs() > distance * length(slope.gradient);
        let aim = surface.aim();
        let astray: Vec<usize> = (0..points.len()).filter(|k| is_farther(&slopes[*k], aim)).collect();
        if astray.len() > MOST_TIGHT || ASTRAY * astray.len() > points.len() {
            return Ok(Astray::default());
        }
        let n_far = astray.iter().filter(|k| is_farther(&slopes[**k], FAR * aim)).count();
        Ok(Astray { places: astray.into_iter().map(place_of).collect(), n_far })
    }

    fn grid_options(&self, tol: f64) -> GridOptions {
        let (floor, detail) = (FLOOR * tol, DETAIL * self.longest());
        GridOptions {
            bounds: self.bounds,
            floor: lesser(detail, floor),
            coarsest: if self.is_sampled { SAMPLED } else { COARSEST } * self.longest(),
        }
    }

    /// The longest side of the bounds.
    pub fn longest(&self) -> f64 {
        longest(&self.bounds)
    }

    /// The most faces that the job allows.
    pub fn most_faces(&self) -> u64 {
        self.job.triangle_limit.min(self.job.memory_limit / BYTES_A_FACE)
    }

    /// Refuses lengths below the precision of the coordinates.
    pub fn check_precision(&self, length: f64) -> Result<(), Failure<Mesh>> {
        let corners = self.bounds.min.iter().chain(&self.bounds.max);
        let largest = corners.fold(0.0, |most: f64, x| greater(x.abs(), most));
        if length >= FINEST * largest {
            return Ok(());
        }
        let message = format!(
            "{length:e} is too little beside coordinates of {largest:e}, which have 16 digits: move the shape to the origin, \
             or allow a larger length"
        );
        Err(Failure::refused(RefusalCode::BelowPrecision, message))
    }

    /// Refuses more faces than the job allows.
    pub fn check_size(&self, needs: f64) -> Result<(), Failure<Mesh>> {
        let limit = self.job.triangle_limit as f64;
        if needs > limit {
            let message = format!("the budget needs about {needs:.1e} triangles; the limit is {limit:.1e}");
            return Err(Failure::refused(RefusalCode::TooManyTriangles, message));
        }
        let bytes = BYTES_A_FACE as f64 * needs;
        if bytes > self.job.memory_limit as f64 {
            let message = format!("about {needs:.1e} triangles: {}", too_large(bytes));
            return Err(Failure::refused(RefusalCode::TooMuchMemory, message));
        }
        Ok(())
    }
}
