//! Booleans of triangle meshes: the union, difference and intersection of the solids that they bound, as a
//! mesh whose faces lie on those of the operands.
//!
//! ```
//! use chordal::boolean::{BooleanOp, BooleanStep, boolean};
//! use chordal::{Job, Mesh, check};
//! let tetrahedron = |x: f64| {
//!     let corners = vec![[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0]];
//!     Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
//! };
//! let (a, b) = (tetrahedron(0.0)?, tetrahedron(0.25)?);
//! let combined = boolean(&a, &[BooleanStep { op: BooleanOp::Difference, mesh: &b }], &Job::default())?;
//! let volume = check::findings::measure(&combined.mesh).signed_volume;
//! assert!((volume - (1.0 - 0.75_f64.powi(3)) / 6.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod arrangement;
mod attributes;
mod operand;
mod point_survey;
mod result;
mod sides;
mod unchecked;

use crate::budget::{Job, JobError, Refusal, RefusalCode, par_map};
use crate::check::self_intersections;
use crate::explicit::Mesh;
use arrangement::{Engine, EngineFailure, combine};
use operand::{BooleanError, Operand};
use result::BooleanMethod;

pub use result::BooleanMesh;
pub use unchecked::boolean_unchecked;

/// The origin of a result, and the reasons why there is none.
pub mod provenance {
    pub use super::operand::{BooleanError, BooleanSource};
    pub use super::result::BooleanMethod;
}

/// The way in which a solid is combined with the previous one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BooleanOp {
    /// The points in either solid.
    Union,
    /// The points in the first solid and not in the second.
    Difference,
    /// The points in both solids.
    Intersection,
}

impl BooleanOp {
    /// The name in a report.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Union => "union",
            Self::Difference => "difference",
            Self::Intersection => "intersection",
        }
    }

    /// Whether a point is in the result, given whether it is in the first and in the second solid.
    pub(crate) fn holds(self, first: bool, second: bool) -> bool {
        match self {
            Self::Union => first || second,
            Self::Difference => first && !second,
            Self::Intersection => first && second,
        }
    }
}

/// One more operand, and the operation to apply.
#[derive(Clone, Copy, Debug)]
pub struct BooleanStep<'a> {
    /// The operation with the result so far as its first operand.
    pub op: BooleanOp,
    /// The operand.
    pub mesh: &'a Mesh,
}

/// Combines solids, from left to right: `((first op₁ mesh₁) op₂ mesh₂) …`. A point is inside an operand if
/// its winding number is positive, even if faces cross or overlap; vertices are tied by their coordinates.
/// Touching and coplanar faces, equal operands, nested shells and empty results need no special treatment:
/// results are closed, of oriented triangles.
///
/// **Method.** Operands without self-intersections, whose edges have two triangles each, are combined in
/// floating point with symbolic perturbation, which always gives a manifold; other operands, and results that
/// fail the check below, in exact rational arithmetic, which takes ten to forty times as long on boxes that
/// overlap. [`BooleanMesh::method`] says which was used.
///
/// **Bound.** With either method the result is checked. `at_most` bounds the distance of every triangle of
/// the result from the triangle of an operand from which it was cut, rounding included. So in a connected
/// region farther than `at_most` from the operands' triangles, all points are on one side. In such regions the
/// exact winding numbers of result and operands are compared at up to 2,048 points beside the triangles of
/// both. The evidence is [`ProvedIf`](crate::Evidence::ProvedIf): every wrong region contains one of these
/// points. The metric is [`Solid`](crate::budget::Metric::Solid): a point farther than `at_most` from the
/// operands' triangles is on the right side. The bound is 0 if no vertex had to be rounded. If the check finds
/// a point on the wrong side, the evidence is [`Estimated`](crate::Evidence::Estimated).
///
/// Only positions and faces are used: for attributes see [`BooleanMesh::with_attributes`].
///
/// # Errors
/// [`BooleanError::NotClosed`] if along some edge unequal numbers of triangles run in the two directions; the
/// refusals of a job: memory, triangles, and an arrangement of more intersections than the job's memory
/// holds; cancellation.
///
/// Source of the methods: E. Lalish, *Manifold*, after J. Smith, N. Dodgson, *A topologically robust
/// algorithm for Boolean operations on polyhedral shapes using approximate arithmetic*, 2007; and H. Barki,
/// G. Guennebaud, S. Foufou, *Exact, robust, and efficient regularized Booleans on general 3D meshes*, 2015;
/// both by the crate `manifold-rust`.
pub fn boolean(first: &Mesh, steps: &[BooleanStep], job: &Job) -> Result<BooleanMesh, BooleanError> {
    boolean_snapped(first, steps, &|_| Ok(()), job)
}

/// Rounds positions to the precision of a file.
type SnapPositions<'a> = dyn Fn(&mut [[f64; 3]]) -> Result<(), JobError> + 'a;

/// [`boolean()`] for a file that stores fewer digits: `snap` rounds the positions of the result before it is
/// checked, so that the bound is that of the rounded mesh.
///
/// # Errors
/// Those of [`boolean()`], and those of `snap`.
pub fn boolean_snapped(
    first: &Mesh,
    steps: &[BooleanStep],
    snap: &SnapPositions,
    job: &Job,
) -> Result<BooleanMesh, BooleanError> {
    let meshes: Vec<&Mesh> = std::iter::once(first).chain(steps.iter().map(|step| step.mesh)).collect();
    let ops: Vec<BooleanOp> = steps.iter().map(|step| step.op).collect();
    check_limits(&meshes, job)?;
    let operands = par_map(job, &meshes, |number, mesh| Operand::new(number, mesh, job));
    let operands: Vec<Operand> = operands.into_iter().collect::<Result<_, _>>()?;
    // The fast engine is right for closed solids that face outwards and do not cross themselves.
    // Its result counts only if the check gives it a bound; otherwise exact arithmetic cuts the
    // meshes again. That a job was cancelled shows in either case.
    let simple = operands.iter().all(|operand| operand.is_simple);
    if simple && let Ok(mut surface) = combine(&operands, &ops, Engine::FloatingPoint, job) {
        snap(&mut surface.positions)?;
        let checked = result::checked(surface, BooleanMethod::FloatingPoint, (&operands, &ops), job)?;
        if checked.bound.evidence().bounds_above() {
            return Ok(checked);
        }
    }
    check_crossings(&meshes, job)?;
    match combine(&operands, &ops, Engine::Rational, job) {
        Ok(mut surface) => {
            snap(&mut surface.positions)?;
            Ok(result::checked(surface, BooleanMethod::Rational, (&operands, &ops), job)?)
        }
        Err(EngineFailure::Cancelled) => Err(JobError::Cancelled.into()),
        Err(EngineFailure::Failed(why)) => {
            let message = format!("the meshes could not be cut along each other: {why}");
            Err(JobError::Refused(Refusal::new(RefusalCode::Unsupported, message)).into())
        }
    }
}

/// Refuses work that would need more memory than the job allows, before it starts.
fn check_limits(meshes: &[&Mesh], job: &Job) -> Result<(), JobError> {
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    let n_faces = meshes.iter().fold(0_u64, |n, mesh| n + mesh.faces().len() as u64);
    let bytes = n_faces.saturating_mul(BYTES_A_FACE);
    if bytes > job.memory_limit {
        let limit = job.memory_limit;
        let message =
            format!("combining {n_faces} triangles needs about {bytes} bytes; the limit is {limit}");
        return Err(JobError::Refused(Refusal::new(RefusalCode::TooMuchMemory, message)));
    }
    Ok(())
}

/// Measured on pairs of spheres of 262,144 and 1,048,576 triangles: 790 and 820, inputs included; half as
/// much added.
const BYTES_A_FACE: u64 = 1200;

/// Refuses an arrangement whose intersections alone would exceed the job's memory: in the worst case all
/// triangles cross each other.
fn check_crossings(meshes: &[&Mesh], job: &Job) -> Result<(), JobError> {
    // As one mesh, so that the crossings of an operand with itself count too.
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for mesh in meshes {
        let first = positions.len() as u32;
        positions.extend_from_slice(mesh.positions());
        faces.extend(mesh.faces().iter().map(|face| face.map(|row| row + first)));
    }
    let joined = Mesh::by_construction(positions, faces);
    let n_pairs = self_intersections(&joined, job)?.count;
    let bytes = n_pairs.saturating_mul(BYTES_A_CROSSING);
    if bytes > job.memory_limit {
        let limit = job.memory_limit;
        let message = format!(
            "{n_pairs} pairs of triangles cross each other: cutting them exactly needs about {bytes} bytes; the limit \
             is {limit}"
        );
        return Err(JobError::Refused(Refusal::new(RefusalCode::TooMuchMemory, message)));
    }
    Ok(())
}

/// Chosen for two points of three rational coordinates, their segments, and the pieces of both triangles; a
/// chain of 200 boxes that cross each other took 44 MB.
const BYTES_A_CROSSING: u64 = 8192;
