//! Any shape as one mesh at full precision, for verbs that work on triangles.
use crate::isosurface::SurfaceForm;
use crate::request::MeshRequest;
use crate::{MeshFailure, Shape, cage, field, isosurface, merged_parts};
use chordal::budget::advice::Message;
use chordal::budget::{Budget, Failure, JobError, Refusal, RefusalCode, Tolerance};
use chordal::math::Box3;
use chordal::{Bounded, Job, Mesh, convert};
use chordal_io::Format;

/// Triangles within a tolerance of a smooth shape, at full precision.
pub(crate) fn tessellate(
    shape: &Shape,
    length: Tolerance,
    bounds: Box3,
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<Bounded<Mesh>, JobError> {
    let budget = Budget::length(length);
    // A format that keeps every digit.
    let request = MeshRequest::new(budget, Format::Ply, bounds);
    let made = match shape {
        Shape::Patches { patches, .. } => {
            return convert::patches_to_mesh(patches, &budget, job).or_else(Failure::best_effort);
        }
        Shape::Cage(polygons) => cage::limit_surface(polygons, &request, job),
        Shape::Volume(sampled) => {
            let made = isosurface::mesh_volume(sampled, (&request.widened(), SurfaceForm::Cells), notes, job);
            made.map(|made| (made.scene, made.bound))
        }
        Shape::Field(field) => field::mesh_field(field, &request.widened(), notes, job),
        _ => Err(MeshFailure::refused(RefusalCode::Unsupported, "this shape has no triangles to work on")),
    };
    let unsupported = |message: Message| JobError::Refused(Refusal::new(RefusalCode::Unsupported, message));
    let (scene, bound) = made.map_err(|failure| match failure {
        MeshFailure::Cancelled => JobError::Cancelled,
        MeshFailure::Refused(refusal) => JobError::Refused(refusal),
        other => unsupported(other.message()),
    })?;
    let mesh = merged_parts::one_mesh(&scene).map(|mesh| mesh.into_owned());
    let mesh = mesh.map_err(|error| unsupported(error.to_string().into()))?;
    Ok(Bounded { shape: mesh, bound })
}
