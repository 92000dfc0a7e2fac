//! `BooleanMesh`: the mesh of a combined solid, where its faces come from, and how far they are from there.
use super::BooleanOp;
use super::arrangement::CutSurface;
use super::operand::Operand;
use super::sides::{SideVerdict, compare_sides};
use crate::budget::{Bound, Evidence, Job, JobError, Metric, Reference, Refusal, RefusalCode, par_map};
use crate::check::distance_up;
use crate::explicit::Mesh;
use crate::math::greater;

/// A combined solid as a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct BooleanMesh {
    /// Its surface: positions and faces alone.
    pub mesh: Mesh,
    /// For each face, the face of an operand that it was cut from.
    pub sources: Vec<BooleanSource>,
    /// What made it.
    pub method: BooleanMethod,
    /// How far it is from the combined solid: see [`boolean`](super::boolean()).
    pub bound: Bound,
}

/// A face of an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BooleanSource {
    /// 0 for the first mesh, then 1 more for each step.
    pub operand: u32,
    /// Its face there.
    pub face: u32,
}

/// How meshes were combined.
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

/// Checks a surface against its operands and gives it its bound.
pub(super) fn checked(
    made: CutSurface,
    method: BooleanMethod,
    (operands, ops): (&[Operand], &[BooleanOp]),
    job: &Job,
) -> Result<BooleanMesh, JobError> {
    let CutSurface { positions, faces, sources } = made;
    if faces.len() as u64 > job.triangle_limit {
        let message =
            format!("the result has {} triangles; the limit is {}", faces.len(), job.triangle_limit);
        return Err(JobError::Refused(Refusal::new(RefusalCode::TooManyTriangles, message)));
    }
    let mesh = Mesh::new(positions, faces).map_err(|invalid| {
        JobError::Refused(Refusal::new(RefusalCode::NotFinite, format!("the result is no mesh: {invalid}")))
    })?;
    // The distance to a triangle is convex, so that it is largest at a corner of what was cut from it.
    let offs = par_map(job, &sources, |face, source| {
        let own = operands[source.operand as usize].mesh.corners(source.face as usize);
        let corners = mesh.corners(face);
        let off = corners.iter().map(|p| distance_up(*p, &own)).fold(0.0, |most, off| greater(off, most));
        (off, corners)
    });
    let mut off = 0.0;
    let mut at = None;
    for (face_off, corners) in offs {
        // A distance that is no number is no bound.
        if face_off > off || face_off.is_nan() {
            off = face_off;
            at = Some(corners[0]);
        }
    }
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    let verdict = if off.is_finite() {
        compare_sides(&mesh, off, (operands, ops), job)?
    } else {
        SideVerdict::Wrong { at: at.unwrap_or_default() }
    };
    let bound = match verdict {
        SideVerdict::Agrees { n_points } => {
            let what = format!(
                "no region is on the wrong side that has none of the {n_points} points whose winding numbers were \
                 compared"
            );
            let evidence = Evidence::ProvedIf(vec![what]);
            let mut bound = Bound::with_evidence(0.0, Some(off), evidence, Reference::Boolean);
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
