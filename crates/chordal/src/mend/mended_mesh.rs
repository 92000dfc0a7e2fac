//! `MendedMesh`: the result of a repair: the mesh, what was changed, and how far the surface moved.
use super::limits::refusal;
use crate::Mesh;
use crate::budget::{Bound, JobError, Reference, RefusalCode};
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
