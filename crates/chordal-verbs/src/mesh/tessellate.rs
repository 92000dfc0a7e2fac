//! Any shape as one mesh at full precision, for verbs that work on triangles.
use super::isosurface::SurfaceForm;
use super::request::MeshRequest;
use super::{cage, field, isosurface};
use crate::scene::drop_attributes::without_attributes;
use crate::scene::merged_parts;
use crate::{MeshFailure, Shape};
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
    // Callers do not have the list to which the numbers of materials refer.
    let is_lost = |semantic: &Semantic| {
        matches!(shape, Shape::Field(_)) && *semantic == Semantic::Group(MATERIAL.to_owned())
    };
    let mesh = if mesh.attributes().iter().any(|attribute| is_lost(&attribute.semantic)) {
        without_attributes(&mesh, is_lost).map_err(|error| unsupported(error.to_string().into()))?
    } else {
        mesh.into_owned()
    };
    Ok(Bounded { shape: mesh, bound })
}

/// The same triangles as a scene, with the materials of the shape.
pub(crate) fn tessellate_scene(
    shape: &Shape,
    length: Tolerance,
    bounds: Box3,
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<(Scene, Bound), JobError> {
    let budget = Budget::length(length);
    // PLY keeps every digit.
    let request = MeshRequest::new(budget, Format::Ply, bounds);
    let result = match shape {
        Shape::Patches { patches, .. } => {
            let mesh = convert::patches_to_mesh(patches, &budget, job).or_else(Failure::best_effort)?;
            return Ok((Scene::from_mesh("patches", mesh.shape, *shape.frame()), mesh.bound));
        }
        Shape::Surfaces { surfaces, .. } => {
            let mesh =
                convert::trimmed_surfaces_to_mesh(surfaces, &budget, job).or_else(Failure::best_effort)?;
            return Ok((Scene::from_mesh("surfaces", mesh.shape, *shape.frame()), mesh.bound));
        }
        Shape::Cage(polygons) => cage::limit_surface(polygons, &request, job),
        Shape::Volume(sampled) => {
            let surface =
                isosurface::mesh_volume(sampled, (&request.widened(), SurfaceForm::Cells), notes, job);
            surface.map(|surface| (surface.scene, surface.bound))
        }
        Shape::Field(field) => field::mesh_field(field, &request.widened(), notes, job),
        _ => Err(MeshFailure::refused(RefusalCode::Unsupported, "this shape has no triangles to work on")),
    };
    result.map_err(|failure| match failure {
        MeshFailure::Cancelled => JobError::Cancelled,
        MeshFailure::Refused(refusal) => JobError::Refused(refusal),
        // A usage error keeps its code for every verb.
        MeshFailure::Length(_) | MeshFailure::Usage(_) => {
            JobError::Refused(Refusal::new(RefusalCode::Usage, failure.message()))
        }
        other => JobError::Refused(Refusal::new(RefusalCode::Unsupported, other.message())),
    })
}
