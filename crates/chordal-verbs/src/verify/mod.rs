//! `verify`: re-proves the certificate of a written file, independently of how the file was built.
mod attribute_pair;
mod attributes;
mod baked;
mod bodies;
mod bound_judge;
mod claims;
mod composed_reference;
mod counts;
mod levels;
mod normals;
mod offset;
mod steps;
mod unchecked;

pub use claims::{ClaimFacts, ClaimVerdict, VERIFY_SCHEMA, VerifyReport};

use crate::provenance::geometry_digest::digest_in_frame;
use crate::provenance::origin::{embedded_certificate, stated_frame};
use crate::provenance::seal::{SEAL, seal_of};
use crate::report::{HistoryFacts, StepBound, StepInput};
use crate::scene::frame_nodes::may_be_in;
use crate::{Input, MeshFailure, Shape};
use chordal::Job;
use claims::ClaimList;
use serde_json::Value;
use steps::{GivenFile, HISTORY, ProvedSteps};

/// Re-proves the claims in the certificate of `out`, from `out` itself and from the files that it was built from,
/// `against`: its input, and for a history of several steps the files between, in any order.
///
/// The certificate is that in the file, or `given`: a report, or the certificate of one, for formats that hold none. Only
/// the judges of `chordal::check` are used; nothing is built again. Claims are: the seal over the certificate; the digest
/// of the geometry; the counts of the output, and whether it is closed and manifold; that an input is the one named in the
/// certificate; the bound of every step, and their sum; the deviations of attributes. Normals, texture coordinates and
/// colours without facts in the certificate are compared with those of the input, too. The verdict is
/// [`ClaimVerdict::Proved`] if every claim holds, [`ClaimVerdict::Refuted`] if one is wrong, otherwise
/// [`ClaimVerdict::Open`].
///
/// Cost: [`crate::deviation()`] for each step.
///
/// # Errors
/// [`MeshFailure::Usage`] if there is no certificate; [`MeshFailure::Cancelled`].
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::{BudgetSpec, ClaimVerdict, FormatHint, load, mesh, verify};
/// let read = |bytes: &[u8], name| load(bytes, FormatHint { name: Some(name), ..FormatHint::default() }, &Default::default());
/// let obj = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 0.001\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
/// let spec = BudgetSpec { length: Some("0.01".parse()?), ..BudgetSpec::default() };
/// let mut ply = Vec::new();
/// mesh(read(obj, "a.obj")?, &spec, Format::Ply, &Default::default())?.write(&mut ply)?;
/// let verified = verify(&read(&ply, "b.ply")?, None, &[read(obj, "a.obj")?], &Default::default())?;
/// assert_eq!(verified.verdict, ClaimVerdict::Proved);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn verify(
    out: &Input,
    given: Option<&Value>,
    against: &[Input],
    job: &Job,
) -> Result<VerifyReport, MeshFailure> {
    verify_levels((out, &[]), given, against, job)
}

/// As [`verify`], for a glTF whose coarser levels of detail were read as well: the first of them by
/// [`Limits::level`](chordal_io::Limits::level) 1, and so on for all of [`n_coarser_levels`]. The claims of each level are
/// re-proved; without the levels they stay open.
///
/// # Errors
/// As for [`verify`].
pub fn verify_levels(
    (out, coarser): (&Input, &[Input]),
    given: Option<&Value>,
    against: &[Input],
    job: &Job,
) -> Result<VerifyReport, MeshFailure> {
    let mut claims = ClaimList::default();
    let embedded = embedded_certificate(&out.shape);
    let given = given.map(in_report);
    let Some(certificate) = given.or(embedded) else {
        let message = "there is no certificate to verify: the file carries none, and no report was given";
        return Err(MeshFailure::Usage(message.into()));
    };
    if let (Some(given), Some(embedded)) = (given, embedded) {
        // Levels of detail in one file have fewer facts than the report, but the same history.
        let [given, embedded] = [given, embedded].map(|certificate| certificate.get("history").map(seal_of));
        if given == embedded {
            claims.prove("certificate");
        } else {
            claims.open("certificate", "the file carries another certificate than the one that was given");
        }
    }
    let against: Vec<GivenFile<'_>> = against.iter().map(GivenFile::new).collect();
    check_file(&CertifiedFile { file: out, certificate, against: &against }, &mut claims, job)?;
    levels::check((out, coarser), &against, &mut claims, job)?;
    Ok(VerifyReport::new(claims, unchecked::unchecked(certificate)))
}

/// A file, its certificate, and the files that it was built from.
struct CertifiedFile<'a> {
    file: &'a Input,
    certificate: &'a Value,
    against: &'a [GivenFile<'a>],
}

fn check_file(
    CertifiedFile { file: out, certificate, against }: &CertifiedFile<'_>,
    claims: &mut ClaimList,
    job: &Job,
) -> Result<(), MeshFailure> {
    check_seal(certificate, claims);
    unchecked::check_known(certificate, claims);
    counts::check(out, certificate, claims)?;
    check_frame(out, certificate, claims);
    match history(certificate) {
        Ok(history) => {
            check_geometry(out, certificate, &history, claims)?;
            check_last_step(certificate, &history, claims);
            let frame = stated_frame(certificate);
            let baked = certificate.get("baked").filter(|baked| !baked.is_null());
            let witness = certificate.pointer("/bound/at").and_then(point);
            let history = &history;
            let certificate = Some(*certificate);
            ProvedSteps { name: HISTORY, out, frame, certificate, baked, witness, history, against, job }
                .check(claims)?;
        }
        Err(reason) => claims.open("history", reason),
    }
    Ok(())
}

/// The number of coarser levels of detail that a file has beside the one that was read.
#[must_use]
pub fn n_coarser_levels(file: &Input) -> usize {
    match &file.shape {
        Shape::Scene(scene) => scene.coarser_levels,
        _ => 0,
    }
}

/// The inputs that are named by the certificate of `out`, or by the report that is `given` in its place: the files to verify
/// against, with the kinds of shapes as which they were read.
///
/// ```
/// use chordal_verbs::{FormatHint, inputs_to_verify, load};
/// let plain = load(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", FormatHint::default(), &Default::default())?;
/// assert!(inputs_to_verify(&plain, None).is_empty());
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
#[must_use]
pub fn inputs_to_verify(out: &Input, given: Option<&Value>) -> Vec<StepInput> {
    let certificate = given.map(in_report).or(embedded_certificate(&out.shape));
    let history = certificate.and_then(|certificate| history(certificate).ok());
    history.iter().flat_map(HistoryFacts::inputs).cloned().collect()
}

/// The certificate in a report, or the value itself if it is a certificate.
fn in_report(report: &Value) -> &Value {
    report.get("certificate").unwrap_or(report)
}

fn check_seal(certificate: &Value, claims: &mut ClaimList) {
    match certificate.get(SEAL).and_then(Value::as_str) {
        None => claims.refute("seal", "the certificate has no seal"),
        Some(seal) => claims.decide(
            "seal",
            seal == seal_of(certificate),
            "the certificate was edited: its seal is not that of its content",
        ),
    }
}

/// Checks that the certificate states a valid frame, and that the file can be in it.
fn check_frame(out: &Input, certificate: &Value, claims: &mut ClaimList) {
    let stated = certificate.get("frame").unwrap_or(&Value::Null);
    let is_axis = |up: &Value| up.is_null() || up == "y" || up == "z";
    let is_length = |unit: &Value| unit.is_null() || unit.as_f64().is_some_and(|unit| unit > 0.0);
    if !stated.is_object() {
        claims.refute("frame", "the certificate states no frame, which every certificate does");
    }
    if let Some(up) = stated.get("up").filter(|up| !is_axis(up)) {
        claims.refute("frame/up", format!("{up} is no axis that may be up: \"y\", \"z\" or null"));
    }
    if let Some(unit) = stated.get("metres_per_unit").filter(|unit| !is_length(unit)) {
        claims
            .refute("frame/metres_per_unit", format!("{unit} is no length of a unit: more than 0, or null"));
    }
    let Shape::Scene(scene) = &out.shape else { return };
    if !may_be_in(scene, out.format, &stated_frame(certificate)) {
        claims
            .refute("frame", "the certificate states another unit or another axis that is up than the file");
    }
}

/// A point from its three coordinates.
fn point(value: &Value) -> Option<[f64; 3]> {
    serde_json::from_value(value.clone()).ok()
}

/// The history in a certificate, if it can be read.
fn history(certificate: &Value) -> Result<HistoryFacts, &'static str> {
    let history = certificate.get("history").filter(|history| !history.is_null());
    let history = history.ok_or("the certificate has no history, like those of earlier versions")?;
    let history: HistoryFacts =
        serde_json::from_value(history.clone()).map_err(|_| "the history cannot be read")?;
    if history.steps.is_empty() { Err("the history has no step") } else { Ok(history) }
}

fn check_geometry(
    out: &Input,
    certificate: &Value,
    history: &HistoryFacts,
    claims: &mut ClaimList,
) -> Result<(), MeshFailure> {
    let stated = history.steps.last().and_then(|step| step.output.geometry.as_ref());
    let frame = stated_frame(certificate);
    let actual = digest_in_frame(&out.shape, out.format, &frame)?;
    match (stated, actual) {
        (Some(stated), Some(actual)) => claims.decide(
            "geometry",
            *stated == actual,
            "the file holds another geometry than in the certificate: it was changed afterwards",
        ),
        (None, _) => claims.open(
            "geometry",
            format!("the certificate has no digest: {} does not hold all of the geometry", out.format),
        ),
        (_, None) => {
            claims.refute("geometry", format!("the file holds {}, which has no digest", out.shape.kind()))
        }
    }
    Ok(())
}

/// Checks that the last step and the certificate, which have some facts in common, agree.
fn check_last_step(certificate: &Value, history: &HistoryFacts, claims: &mut ClaimList) {
    let Some(last) = history.steps.last() else { return };
    let fact = |at: &str| certificate.pointer(at).cloned().unwrap_or(Value::Null);
    let is_same_bound = match (&last.bound, fact("/bound")) {
        (None, Value::Null) => true,
        (Some(bound), facts) => is_same_bound(bound, &facts),
        _ => false,
    };
    claims.decide(
        "history/last/bound",
        is_same_bound,
        "the last step of the history has another bound than the certificate",
    );
    // The certificate itself has one input. A step that combined several, or read parts that were put together, has
    // others.
    if let ([input], None) = (&last.inputs[..], &last.composed) {
        let is_same = fact("/input/sha256").as_str() == input.sha256.as_deref()
            && fact("/input/kind") == input.kind.as_str()
            && fact("/input/format") == input.format.as_str()
            && digests_of(&fact("/input/files")) == input.files;
        claims.decide(
            "history/last/input",
            is_same,
            "the last step of the history has another input than the certificate",
        );
    }
}

/// The digests of files beside an input.
fn digests_of(files: &Value) -> Vec<&str> {
    let files = files.as_array().into_iter().flatten();
    files.map(|file| file.get("sha256").and_then(Value::as_str).unwrap_or("")).collect()
}

/// Whether the values of a step's bound are those of a certificate's bound.
fn is_same_bound(bound: &StepBound, facts: &Value) -> bool {
    let stated = serde_json::to_value(bound).unwrap_or_default();
    // By seals, which are of numbers in one form: another program may have written the certificate.
    let is_same =
        |(key, value): (&String, &Value)| facts.get(key).is_some_and(|fact| seal_of(fact) == seal_of(value));
    stated.as_object().is_some_and(|stated| stated.iter().all(is_same))
}
