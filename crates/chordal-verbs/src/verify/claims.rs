//! The result of `verify`: every claim of a certificate with its verdict.
use serde::Serialize;

/// The name of this version of the report of `verify`, which `docs/schema/verify.schema.json` describes.
pub const VERIFY_SCHEMA: &str = "chordal.verify/1";

/// The verdict on a claim. The worst of all claims is the verdict on the certificate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClaimVerdict {
    /// It holds: it was proved or counted again.
    #[serde(rename = "re-proved")]
    Proved,
    /// It was neither proved nor refuted.
    #[serde(rename = "not re-proved")]
    Open,
    /// It is wrong.
    Refuted,
}

/// A claim of a certificate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimFacts {
    /// The claim, as a path in the certificate or a word of `docs/verify.md`.
    pub claim: String,
    /// The verdict.
    pub verdict: ClaimVerdict,
    /// Why it does not hold, or was not decided, in one sentence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// For a bound: the claimed upper end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub claimed: Option<f64>,
    /// For a bound: the ends of the distance that were proved again; the upper end is `None` if there is no bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found: Option<(f64, Option<f64>)>,
}

/// The report of `verify`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VerifyReport {
    /// [`VERIFY_SCHEMA`].
    pub schema: &'static str,
    /// The worst verdict.
    pub verdict: ClaimVerdict,
    /// All claims, in the order in which they were checked.
    pub claims: Vec<ClaimFacts>,
    /// The facts of the certificate that were not checked, as paths in it: the origin of the result, sentences, the
    /// request; and figures that neither the files nor a check within the limit of work can decide. Last the attributes of
    /// the file for which there is no comparison: "attributes/normal" and the like, "materials".
    pub unchecked: Vec<String>,
}

impl VerifyReport {
    pub(super) fn new(ClaimList { claims, passed }: ClaimList, mut unchecked: Vec<String>) -> Self {
        let verdict = claims.iter().map(|claim| claim.verdict).max().unwrap_or(ClaimVerdict::Open);
        unchecked.extend(passed);
        Self { schema: VERIFY_SCHEMA, verdict, claims, unchecked }
    }

    /// The first of the worst claims, for a summary.
    #[must_use]
    pub fn worst(&self) -> Option<&ClaimFacts> {
        self.claims.iter().find(|claim| claim.verdict == self.verdict)
    }
}

/// The claims so far.
#[derive(Debug, Default)]
pub(super) struct ClaimList {
    claims: Vec<ClaimFacts>,
    /// Figures and attributes that are left unchecked, mostly as paths in the certificate.
    passed: Vec<String>,
}

impl ClaimList {
    pub fn add(&mut self, claim: ClaimFacts) {
        self.claims.push(claim);
    }

    pub fn prove(&mut self, claim: &str) {
        self.say(claim, ClaimVerdict::Proved, None);
    }

    pub fn refute(&mut self, claim: &str, reason: impl Into<String>) {
        self.say(claim, ClaimVerdict::Refuted, Some(reason.into()));
    }

    pub fn open(&mut self, claim: &str, reason: impl Into<String>) {
        self.say(claim, ClaimVerdict::Open, Some(reason.into()));
    }

    /// Leaves a figure unchecked, which does not change the verdict.
    pub fn pass(&mut self, at: impl Into<String>) {
        self.passed.push(at.into());
    }

    /// Whether a figure at a path that starts so was left unchecked.
    pub fn has_passed(&self, below: &str) -> bool {
        self.passed.iter().any(|at| at.starts_with(below))
    }

    /// Adds a claim that is right or wrong.
    pub fn decide(&mut self, claim: &str, holds: bool, reason: &str) {
        if holds { self.prove(claim) } else { self.refute(claim, reason) }
    }

    /// Adds the claims of a part, under its name.
    pub fn extend_as(&mut self, name: &str, Self { claims, passed }: Self) {
        self.claims.extend(
            claims.into_iter().map(|facts| ClaimFacts { claim: format!("{name}/{}", facts.claim), ..facts }),
        );
        self.passed.extend(passed.into_iter().map(|path| format!("{name}/{path}")));
    }

    fn say(&mut self, claim: &str, verdict: ClaimVerdict, reason: Option<String>) {
        self.add(ClaimFacts { claim: claim.to_owned(), verdict, reason, claimed: None, found: None });
    }
}
