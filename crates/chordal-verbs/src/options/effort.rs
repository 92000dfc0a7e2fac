//! The option `effort`, which `mesh` and `verify` share: how far to go for the best result.
use super::values::word;
use super::{OptionRow, OptionValues, store_some};
use crate::Effort;
use chordal::budget::proof::ProofEffort;

/// Requests with an effort.
pub(super) trait EffortOptions {
    fn effort(&mut self) -> &mut Option<Effort>;
}

const EFFORTS: OptionValues = OptionValues::Words(&[
    ("best", "The best result, however long it takes"),
    ("fast", "A good result in a fraction of the time"),
]);

/// The row; the help says what the effort of a verb is spent on.
pub(super) const fn effort<S: EffortOptions>(help: &'static str) -> OptionRow<S> {
    OptionRow::<S>::new("effort", (EFFORTS, "HOW"), help, |options, text| {
        store_some(options.effort(), word(text, &[("best", Effort::Best), ("fast", Effort::Fast)]))
    })
}

/// How far proofs are taken: to their end if the best was asked for.
pub(super) fn proof_effort(effort: Option<Effort>) -> ProofEffort {
    if effort == Some(Effort::Best) { ProofEffort::Full } else { ProofEffort::default() }
}
