//! `BooleanMesh`: the mesh of a combined solid, the origin of its faces, and their distance from it.
use super::BooleanOp;
use super::arrangement::CutSurface;
use super::operand::{BooleanSource, Operand};
use super::sides::{SideVerdict, compare_sides};
use crate::budget::{Bound, Evidence, Job, JobError, Metric, Reference, Refusal, RefusalCode, par_map};
use crate::check::distance_up;
use crate::explicit::Mesh;
use crate::math::greater;

/// A combined solid as a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct BooleanMesh {
    /// The surface: positions and faces alone.
    pub mesh: Mesh,
    /// For each face, the face of an operand from which it was cut.
    pub sources: Vec<BooleanSource>,
    /// The method that was used.
    pub method: BooleanMethod,
    /// A bound on the distance from the combined solid: see [`boolean`](super::boolean()).
    pub bound: Bound,
}

/// The method with which meshes were combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BooleanMethod {
    /// In floating point with symbolic perturbation.
    FloatingPoint,
    /// In rational numbers; the vertices of the result were rounded at the end.
    Rational,
}

impl BooleanMethod {
    /// The name in a report.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::FloatingPoint => "floating-point",
            Self::Rational => "rational",
        }
    }
}

/// Checks a surface against its operands and adds the bound.
pub(super) fn checked(
    surface: CutSurface,
    method: BooleanMethod,
    (operands, ops): (&[Operand], &[BooleanOp]),
    job: &Job,
) -> Result<BooleanMesh, JobError> {
    let CutSurface { positions, faces, sources } = surface;
    if faces.len() as u64 > job.triangle_limit {
        let message =
            format!("the result has {} triangles; the limit is {}", faces.len(), job.triangle_limit);
        return Err(JobError::Refused(Refusal::new(RefusalCode::TooManyTriangles, message)));
    }
    let mesh = Mesh::new(positions, faces).map_err(|invalid| {
        JobError::Refused(Refusal::new(RefusalCode::NotFinite, format!("the result is no mesh: {invalid}")))
    })?;
    // The distance to a triangle is convex, so it is largest at a corner of a piece cut from that triangle.
    let distances = par_map(job, &sources, |face, source| {
        let source_corners = operands[source.operand as usize].mesh.corners(source.face as usize);
        let corners = mesh.corners(face);
        let distance = corners
            .iter()
            .map(|p| distance_up(*p, &source_corners))
            .fold(0.0, |most, distance| greater(distance, most));
        (distance, corners)
    });
    let mut largest_distance = 0.0;
    let mut at = None;
    for (face_distance, corners) in distances {
        // NaN is no bound.
        if face_distance > largest_distance || face_distance.is_nan() {
            largest_distance = face_distance;
            at = Some(corners[0]);
        }
    }
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    let verdict = if largest_distance.is_finite() {
        compare_sides(&mesh, largest_distance, (operands, ops), job)?
    } else {
        SideVerdict::Wrong { at: at.unwrap_or_default() }
    };
    let bound = match verdict {
        SideVerdict::Agrees { n_points } => {
            let what = format!(
                "no region on the wrong side was missed by the {n_points} points whose winding numbers \
                 were compared"
            );
            let evidence = Evidence::ProvedIf(vec![what]);
            let mut bound = Bound::with_evidence(0.0, Some(largest_distance), evidence, Reference::Boolean);
            (bound.metric, bound.at) = (Metric::Solid, at);
            bound
        }
        SideVerdict::Wrong { at } => {
            let mut bound = Bound::with_evidence(0.0, None, Evidence::Estimated, Reference::Boolean);
            (bound.metric, bound.at) = (Metric::Solid, Some(at));
            bound
        }
    };
    Ok(BooleanMesh { mesh, sources, method, bound })
}
