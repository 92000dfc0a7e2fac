//! `MendedMesh`: the result of a repair: the mesh, the changes, and a bound on the movement of the surface.
use crate::Mesh;
use crate::budget::advice::Message;
use crate::budget::{Bound, JobError, Reference, Refusal, RefusalCode};
use crate::check::Finding;

/// The result of a repair.
#[derive(Clone, Debug, PartialEq)]
pub struct MendedMesh {
    /// The repaired mesh.
    pub mesh: Mesh,
    /// The changes, and the findings that were left; one entry for each kind of which there is any.
    pub changes: Vec<MendChange>,
    /// A bound on the movement of the surface: all faces, including those without area, compared with those
    /// of the input.
    pub bound: Bound,
}

/// One kind of change, with its count and first witnesses. The rows in the witnesses are those of the input.
#[derive(Clone, Debug, PartialEq)]
pub struct MendChange {
    /// A stable name, for programs: `turned_faces`, `filled_holes`, … The name of a kind that was found and
    /// not repaired starts with `left_`.
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

    /// The number of changes or findings of that kind.
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
    let nonempty = changes.into_iter().filter(|(_, finding)| !finding.is_none());
    nonempty.map(|(what, finding)| MendChange { what, finding }).collect()
}

pub(super) fn refusal(code: RefusalCode, message: impl Into<Message>) -> JobError {
    JobError::Refused(Refusal::new(code, message))
}
