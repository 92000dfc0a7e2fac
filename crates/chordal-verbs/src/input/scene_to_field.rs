//! The triangles of a scene as a field, for scripts and Python.
use crate::scene::{flatten, merged_parts};
use chordal::Job;
use chordal::budget::{JobError, Refusal, RefusalCode};
use chordal::convert::mesh_to_field;
use chordal::implicit::Field;
use chordal_io::{Scene, WriteError};

/// The signed distance to the triangles of a scene, with notes.
#[derive(Clone, Debug)]
pub struct SceneField {
    /// The field, in the scene's coordinates.
    pub field: Field,
    /// A code and a sentence for each note: placements that rounded corners, a mesh that is not a solid.
    pub notes: Vec<(&'static str, String)>,
}

/// The most bytes for each triangle of a mesh as a field: its boxes, moments, corners and the copy of it. Measured: a tree
/// and its moments take 160.
const BYTES_A_TRIANGLE: u64 = 400;

/// The signed distance to all triangles that a scene shows: see [`chordal::convert::mesh_to_field`].
///
/// # Errors
/// If there are no triangles, more than the job allows, or more than fit its memory; if the nodes are not a tree or take
/// coordinates out of range.
pub fn scene_to_field(scene: Scene, job: &Job) -> Result<SceneField, JobError> {
    let refused = |code, message: String| JobError::Refused(Refusal::new(code, message));
    let unplaced = |error: WriteError| refused(RefusalCode::Unsupported, error.to_string());
    let flattened = flatten::flatten(scene).map_err(unplaced)?;
    let mesh = merged_parts::one_mesh(&flattened.scene).map_err(unplaced)?.into_owned();
    let n_faces = mesh.faces().len() as u64;
    if n_faces == 0 {
        return Err(refused(RefusalCode::Empty, "it has no triangles".to_owned()));
    }
    if n_faces > job.triangle_limit {
        let limit = job.triangle_limit;
        let message = format!("it has {n_faces} triangles; the limit is {limit}");
        return Err(refused(RefusalCode::TooManyTriangles, message));
    }
    let bytes = BYTES_A_TRIANGLE * n_faces;
    if bytes > job.memory_limit {
        let limit = job.memory_limit;
        let message = format!("{n_faces} triangles take {bytes} bytes of memory; the limit is {limit}");
        return Err(refused(RefusalCode::TooMuchMemory, message));
    }
    let mut notes = Vec::new();
    if flattened.moved_at_most > 0.0 {
        let moved = flattened.moved_at_most;
        notes.push(("placements-rounded", format!("placing its parts rounded corners by up to {moved:e}")));
    }
    let converted = mesh_to_field(&mesh, job)?;
    if !converted.solid.is_solid() {
        notes.push(("mesh-not-solid", converted.solid.to_string()));
    }
    Ok(SceneField { field: converted.field, notes })
}
