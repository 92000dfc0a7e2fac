//! `VerifyOptions`: the options of `verify`.
use super::effort::{EffortOptions, effort, proof_effort};
use super::{OptionRow, OptionSection, OptionTable};
use crate::Effort;
use chordal::budget::proof::ProofEffort;

/// A request to verify a certificate.
#[derive(Clone, Copy, Debug, Default)]
pub struct VerifyOptions {
    effort: Option<Effort>,
}

impl VerifyOptions {
    /// How far the checks are taken: to their end if the best was asked for.
    #[must_use]
    pub fn proof(&self) -> ProofEffort {
        proof_effort(self.effort)
    }
}

impl EffortOptions for VerifyOptions {
    fn effort(&mut self) -> &mut Option<Effort> {
        &mut self.effort
    }
}

impl OptionTable for VerifyOptions {
    const ROWS: &'static [OptionRow<Self>] = &[effort(
        "How far to go for the best result: best runs every check to its end. By default a check gets about as much work as \
         making the result took; a claim that is open then counts as not re-proved",
    )
    .under(OptionSection::Verb)
    .without_keyword()];
}
