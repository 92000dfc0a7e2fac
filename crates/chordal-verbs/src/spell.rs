//! `Spell` for the results of verbs: a front end spells the settings in their messages and certificates.
use crate::report::{Certificate, ExaminationFacts, FindingFacts, Report, WarningFacts};
use crate::{
    BakeOutcome, ConvertOutcome, Input, LodOutcome, MeshFailure, MeshOutcome, RefineOutcome, RenderOutcome,
    ShaderOutcome, VerifyReport,
};
use chordal::budget::advice::{Spell, Spelling};

/// The warnings; certificates of results take them over from the input.
impl Spell for Input {
    fn spell(&mut self, spelling: &dyn Spelling) {
        self.warnings.spell(spelling);
    }
}

/// Implements [`Spell`] for outcomes by their certificates, which go into the files.
macro_rules! by_certificate {
    ($($outcome:ident)*) => {$(
        impl Spell for $outcome {
            fn spell(&mut self, spelling: &dyn Spelling) {
                self.certificate.spell(spelling);
            }
        }
    )*};
}

by_certificate! { ConvertOutcome MeshOutcome RefineOutcome RenderOutcome ShaderOutcome }

/// Implements [`Spell`] for outcomes that may miss the budget.
macro_rules! by_certificate_and_reason {
    ($($outcome:ident)*) => {$(
        impl Spell for $outcome {
            fn spell(&mut self, spelling: &dyn Spelling) {
                self.certificate.spell(spelling);
                if let Some(why) = &mut self.unmet {
                    why.spell(spelling);
                }
            }
        }
    )*};
}

by_certificate_and_reason! { BakeOutcome LodOutcome }

/// A report of `verify` advises no setting.
impl Spell for VerifyReport {
    fn spell(&mut self, _: &dyn Spelling) {}
}

impl Spell for MeshFailure {
    fn spell(&mut self, spelling: &dyn Spelling) {
        match self {
            Self::Length(why) => why.spell(spelling),
            Self::Usage(why) => why.spell(spelling),
            Self::Unmet(best) => best.spell(spelling),
            Self::Refused(refusal) => refusal.spell(spelling),
            Self::TooWide(_) | Self::Cancelled => {}
        }
    }
}

impl Spell for Certificate {
    fn spell(&mut self, spelling: &dyn Spelling) {
        self.input.warnings.spell(spelling);
        self.notes.spell(spelling);
        self.stayed.spell(spelling);
        self.warned.spell(spelling);
    }
}

impl Spell for WarningFacts {
    fn spell(&mut self, spelling: &dyn Spelling) {
        self.message.spell(spelling);
    }
}

impl Spell for Report {
    fn spell(&mut self, spelling: &dyn Spelling) {
        self.certificate.spell(spelling);
        if let Some(ExaminationFacts::Inspection(inspection)) = &mut self.examined {
            inspection.findings.spell(spelling);
        }
    }
}

impl Spell for FindingFacts {
    fn spell(&mut self, spelling: &dyn Spelling) {
        self.means.spell(spelling);
        self.options.spell(spelling);
        self.advice.spell(spelling);
    }
}
