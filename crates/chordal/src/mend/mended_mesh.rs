//! `MendedMesh`: the result of a repair: the mesh, what was changed, and how far the surface moved.
use crate::Mesh;
use crate::budget::{Bound, Job, JobError, Message, Reference, Refusal, RefusalCode};
use crate::check::Finding;

/// The result of a repair.
#[derive(Clone, Debug, PartialEq)]
pub struct MendedMesh {
    /// The repaired mesh.
    pub mesh: Mesh,
    /// What was changed, and what was found but left; one entry for each kind that was found at all.
    pub changes: Vec<MendChange>,
    /// How far the surface moved: all faces, those without area included, against those of the input.
    pub bound: Bound,
}

/// One kind of change, with its count and first witnesses. Rows in the witnesses are those of the input.
#[derive(Clone, Debug, PartialEq)]
pub struct MendChange {
    /// Stable, for programs: `turned_faces`, `filled_holes`, … A kind that was found and not repaired starts
    /// with `left_`.
    pub what: &'static str,
    /// The count, and the first witnesses.
    pub finding: Finding,
}

impl MendedMesh {
    /// The unchanged mesh.
    pub(super) fn unchanged(mesh: &Mesh) -> Self {
        Self::exact(mesh.clone(), [])
    }

    /// A surface that did not move.
    pub(super) fn exact<const N: usize>(mesh: Mesh, changes: [(&'static str, Finding); N]) -> Self {
        Self { mesh, changes: nonempty_changes(changes), bound: Bound::exact(Reference::InputTriangles) }
    }

    /// A surface whose points moved by at most `at_most`, in both directions.
    pub(super) fn moved<const N: usize>(
        mesh: Mesh,
        changes: [(&'static str, Finding); N],
        at_most: f64,
    ) -> Result<Self, JobError> {
        if !at_most.is_finite() {
            return Err(refusal(
                RefusalCode::NotFinite,
                "the surface would move further than the largest number",
            ));
        }
        let bound = Bound::proved(0.0, at_most, Reference::InputTriangles);
        Ok(Self { mesh, changes: nonempty_changes(changes), bound })
    }

    /// How often changes of that kind were made or found.
    #[must_use]
    pub fn count(&self, what: &str) -> u64 {
        self.changes.iter().find(|change| change.what == what).map_or(0, |change| change.finding.count)
    }

    /// Whether nothing was changed.
    #[must_use]
    pub fn is_unchanged(&self) -> bool {
        self.changes.iter().all(|change| change.what.starts_with("left_"))
    }
}

fn nonempty_changes<const N: usize>(changes: [(&'static str, Finding); N]) -> Vec<MendChange> {
    let met = changes.into_iter().filter(|(_, found)| !found.is_none());
    met.map(|(what, found)| MendChange { what, finding: found }).collect()
}

/// Checks whether a repair may start: the job is not cancelled, and its memory limit is sufficient.
pub(super) fn check_limits(mesh: &Mesh, job: &Job) -> Result<(), JobError> {
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    // Counted: a face and its sources 64 bytes, in and out 24, twins and sets 48; a row and its source 48, in
    // and out 56.
    let attributes: usize = mesh.attributes().iter().map(|attribute| attribute.values.len()).sum();
    let bytes = 136 * mesh.faces().len() + 104 * mesh.positions().len() + 16 * attributes;
    if bytes as u64 > job.memory_limit {
        let limit = job.memory_limit;
        return Err(refusal(
            RefusalCode::TooMuchMemory,
            format!("mending needs about {bytes} bytes; the limit is {limit}"),
        ));
    }
    Ok(())
}

pub(super) fn refusal(code: RefusalCode, message: impl Into<Message>) -> JobError {
    JobError::Refused(Refusal::new(code, message))
}
