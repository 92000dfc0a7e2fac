//! Repairs in the report.
use super::{BoundFacts, WitnessFacts, witness_facts};
use chordal::check::findings::MAX_WITNESSES;
use chordal::mend::MendedMesh;
use serde::Serialize;

/// The changes of one repair, over all parts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RepairFacts {
    /// The name of the repair, as in "weld".
    pub cure: &'static str,
    /// Its length parameter, in the units of the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub within: Option<f64>,
    /// The changes, and with names in `left_` the defects that were found and left.
    pub changes: Vec<ChangeFacts>,
    /// The bound for how far this repair alone moved the surface.
    pub bound: BoundFacts,
}

/// One kind of change.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChangeFacts {
    /// Stable, for programs.
    pub what: &'static str,
    /// How often it occurs.
    pub count: u64,
    /// The first witnesses, in the rows of the part before this repair; for additions, in the rows after it.
    pub witnesses: Vec<WitnessFacts>,
}

impl RepairFacts {
    /// Adds the changes of one more part.
    pub(crate) fn add(&mut self, part: usize, mended: &MendedMesh) {
        for change in &mended.changes {
            let at = self.changes.iter().position(|listed| listed.what == change.what).unwrap_or_else(|| {
                self.changes.push(ChangeFacts { what: change.what, count: 0, witnesses: Vec::new() });
                self.changes.len() - 1
            });
            let listed = &mut self.changes[at];
            listed.count += change.finding.count;
            let room = MAX_WITNESSES - listed.witnesses.len();
            let facts =
                change.finding.witnesses.iter().map(|witness| witness_facts(change.what, part, witness));
            listed.witnesses.extend(facts.take(room));
        }
    }
}
