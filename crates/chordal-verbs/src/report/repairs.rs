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
    /// What was changed, and what was found and left: names with `left_`.
    pub changes: Vec<ChangeFacts>,
    /// How far this repair alone moved the surface.
    pub bound: BoundFacts,
}

/// One kind of change.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChangeFacts {
    /// Stable, for programs.
    pub what: &'static str,
    /// How often it occurs.
    pub count: u64,
    /// The first witnesses, in the rows of the part before this repair; of additions, in those after it.
    pub witnesses: Vec<WitnessFacts>,
}

impl RepairFacts {
    /// Adds the changes of one more part.
    pub(crate) fn add(&mut self, part: usize, mended: &MendedMesh) {
        for change in &mended.changes {
            let at = self.changes.iter().position(|known| known.what == change.what).unwrap_or_else(|| {
                self.changes.push(ChangeFacts { what: change.what, count: 0, witnesses: Vec::new() });
                self.changes.len() - 1
            });
            let known = &mut self.changes[at];
            known.count += change.finding.count;
            let room = MAX_WITNESSES - known.witnesses.len();
            let facts =
                change.finding.witnesses.iter().map(|witness| witness_facts(change.what, part, witness));
            known.witnesses.extend(facts.take(room));
        }
    }
}
