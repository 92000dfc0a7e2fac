//! Any shape as one mesh at full precision, for verbs that work on triangles.
use crate::drop_attributes::without_attributes;
use crate::isosurface::SurfaceForm;
use crate::request::MeshRequest;
use crate::{MeshFailure, Shape, cage, field, isosurface, merged_parts};
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Budget, Failure, JobError, Refusal, RefusalCode, Tolerance};
use chordal::explicit::Semantic;
use chordal::math::Box3;
use chordal::{Bounded, Job, Mesh, convert};
use chordal_io::{Format, MATERIAL, Scene};

/// Triangles within a tolerance of a smooth shape, at full precision, without materials.
pub(crate) fn tessellate(
    shape: &Shape,
    length: Tolerance,
    bounds: Box3,
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<Bounded<Mesh>, JobError> {
    let (scene, bound) = tessellate_scene(shape, length, bounds, notes, job)?;
    let unsupported = |message: Message| JobError::Refused(Refusal::new(RefusalCode::Unsupported, message));
    let mesh = merged_parts::one_mesh(&scene).map_err(|error| unsupported(error.to_string().into()))?;
    // Numbers of materials that nobody knows here.
    let is_lost = |semantic: &Semantic| {
        matches!(shape, Shape::Field(_)) && *semantic == Semantic::Group(MATERIAL.to_owned())
    };
    let mesh = if mesh.attributes().iter().any(|one| is_lost(&one.semantic)) {
        without_attributes(&mesh, is_lost).map_err(|error| unsupported(error.to_string().into()))?
    } else {
        mesh.into_owned()
    };
    Ok(Bounded { shape: mesh, bound })
}

/// The same as a scene, with the materials of the shape.
pub(crate) fn tessellate_scene(
    shape: &Shape,
    length: Tolerance,
    bounds: Box3,
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<(Scene, Bound), JobError> {
    let budget = Budget::length(length);
    // A format that keeps every digit.
    let request = MeshRequest::new(budget, Format::Ply, bounds);
    let made = match shape {
        Shape::Patches { patches, .. } => {
            let made = convert::patches_to_mesh(patches, &budget, job).or_else(Failure::best_effort)?;
            return Ok((Scene::from_mesh("patches", made.shape, *shape.frame()), made.bound));
        }
        Shape::Surfaces { surfaces, .. } => {
            let made =
                convert::trimmed_surfaces_to_mesh(surfaces, &budget, job).or_else(Failure::best_effort)?;
            return Ok((Scene::from_mesh("surfaces", made.shape, *shape.frame()), made.bound));
        }
        Shape::Cage(polygons) => cage::limit_surface(polygons, &request, job),
        Shape::Volume(sampled) => {
            let made = isosurface::mesh_volume(sampled, (&request.widened(), SurfaceForm::Cells), notes, job);
            made.map(|made| (made.scene, made.bound))
        }
        Shape::Field(field) => field::mesh_field(field, &request.widened(), notes, job),
        _ => Err(MeshFailure::refused(RefusalCode::Unsupported, "this shape has no triangles to work on")),
    };
    made.map_err(|failure| match failure {
        MeshFailure::Cancelled => JobError::Cancelled,
        MeshFailure::Refused(refusal) => JobError::Refused(refusal),
        // The same code whichever verb asks.
        MeshFailure::Length(_) | MeshFailure::Usage(_) => {
            JobError::Refused(Refusal::new(RefusalCode::Usage, failure.message()))
        }
        other => JobError::Refused(Refusal::new(RefusalCode::Unsupported, other.message())),
    })
}
