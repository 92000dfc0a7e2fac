//! Proves the steps of a history again one by one, and their sum.
use super::attributes::AttributeJudge;
use super::bound_judge::{BoundJudge, JudgeLimit, JudgedBound};
use super::claims::{ClaimFacts, ClaimList, ClaimVerdict};
use super::composed_reference::ComposedReference;
use super::offset::judge_offset;
use crate::provenance::geometry_digest::{digest_in_frame, geometry_digest};
use crate::provenance::origin::{InputOrigin, embedded_certificate, stated_frame};
use crate::report::{ComposedFacts, HistoryFacts, HistoryStart, StepBound, StepFacts, StepInput, gap};
use crate::{Input, MeshFailure};
use chordal::Job;
use chordal::budget::{Bound, Evidence};
use chordal::math::{add_up, greater, lesser, sub_down};
use chordal_io::Frame;
use serde_json::{Value, json};
use std::cell::OnceCell;

/// The name of the claims about the history of a file; names of claims about nested histories begin with it.
pub(super) const HISTORY: &str = "history";

/// A history, and the files to which it refers.
pub(super) struct ProvedSteps<'a> {
    /// The name of the claims about it.
    pub name: &'a str,
    /// The file that the last step wrote.
    pub out: &'a Input,
    /// The frame of its lengths.
    pub frame: Frame,
    /// Its certificate; `None` if only its history is known.
    pub certificate: Option<&'a Value>,
    /// The facts of its certificate about a baked grid.
    pub baked: Option<&'a Value>,
    /// The point at which the last step lost most, according to its certificate.
    pub witness: Option<[f64; 3]>,
    pub history: &'a HistoryFacts,
    pub against: &'a [GivenFile<'a>],
    pub job: &'a Job,
}

/// A file to verify against.
pub(super) struct GivenFile<'a> {
    file: &'a Input,
    geometry: OnceCell<Option<String>>,
}

impl<'a> GivenFile<'a> {
    pub fn new(file: &'a Input) -> Self {
        Self { file, geometry: OnceCell::new() }
    }

    /// Whether it is the input that a step names: by its bytes, or by its geometry for an input that was never a file.
    fn is(&self, input: &StepInput) -> bool {
        let geometry = || self.geometry.get_or_init(|| geometry_digest(&self.file.shape).ok().flatten());
        let is_of_kind = input.kind == self.file.shape.kind();
        match input.sha256.as_deref() {
            // Without a digest it may be any file of the kind: the judge of the bound decides.
            None => is_of_kind,
            stated => self.file.sha256() == stated || is_of_kind && geometry().as_deref() == stated,
        }
    }
}

/// The input and the output of a step.
struct StepEnds<'a> {
    read: &'a Input,
    written: &'a Input,
    /// If inputs were put together: the rounding of that, and the rounding of putting them together again.
    rounding: [f64; 2],
    /// The point at which the step lost most, according to the certificate.
    witness: Option<[f64; 3]>,
}

impl<'a> ProvedSteps<'a> {
    pub fn check(&self, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        // The sum of the bounds, and that each step continues the one before it.
        let flaw = self.history.flaw();
        let is_consistent = flaw.is_none();
        claims.decide("history/total", is_consistent, &flaw.unwrap_or_default());
        self.check_files(claims);
        self.check_start(claims)?;
        // A history that contradicts itself is refuted by that. Its maps may even name inputs that it does not have,
        // and these are looked up below.
        if is_consistent {
            self.check_steps(claims)?;
            self.check_total(claims)?;
        }
        Ok(())
    }

    /// Checks that the history goes back as far as the certificate of its first input.
    fn check_start(&self, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        let HistoryFacts { steps, begins, .. } = self.history;
        let claim = format!("{}/begins", self.name);
        match steps.first() {
            Some(first) if first.composed.is_some() => {
                let reason = "its first step read a composition, and the history states otherwise";
                claims.decide(&claim, begins.code == "composed", reason);
            }
            Some(first) => {
                if let [input] = &first.inputs[..]
                    && let Some(read) = self.find_input(input)
                {
                    check_beginning(&claim, begins, (read, Some(first)), claims);
                }
            }
            None => {}
        }
        Ok(())
    }

    fn check_steps(&self, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        let steps = &self.history.steps;
        for (k, step) in steps.iter().enumerate() {
            let name = format!("{}/steps/{k}", self.name);
            let next = steps.get(k + 1);
            let written = match next.map(|next| next.inputs.first()) {
                None => self.out,
                Some(next) => match next.and_then(|next| self.find_input(next)) {
                    Some(written) => written,
                    None => {
                        claims.open(&name, format!("the file that {} wrote was not given", words_of(step)));
                        continue;
                    }
                },
            };
            let composed;
            let witness = self.witness.filter(|_| next.is_none());
            let ends = if let Some(facts) = &step.composed {
                let Some(parts) = self.parts_of(&name, step, facts, claims)? else { continue };
                let frame = self.frame_of(written, next.is_none());
                composed = match ComposedReference::new(facts, &parts, frame, self.job)? {
                    Ok(composed) => composed,
                    Err(reason) => {
                        claims.open(&name, reason);
                        continue;
                    }
                };
                if facts.rounding > MOST_ROUNDED * composed.rounding {
                    let reason = "more was rounded on the way than this map and these coordinates explain";
                    claims.open(&format!("{name}/composed/rounding"), reason);
                }
                let rounding = [facts.rounding, composed.nodes_rounding];
                StepEnds { read: &composed.input, written, rounding, witness }
            } else if let [input] = &step.inputs[..] {
                let Some(read) = self.find_input(input) else {
                    claims.open(&name, not_given(step, input));
                    continue;
                };
                StepEnds { read, written, rounding: [0.0; 2], witness }
            } else {
                let n = step.inputs.len();
                let reason =
                    format!("{} combined {n} inputs, and no judge proves such a step", words_of(step));
                claims.open(&name, reason);
                continue;
            };
            if next.is_some() {
                self.check_link(&name, step, written, claims)?;
            }
            check_kinds(&name, step, (ends.read, written), claims);
            let frame = self.frame_of(written, next.is_none());
            let is_decided = self.check_bound(&name, step, &ends, &frame, claims)?;
            if !is_decided {
                claims.pass(format!("{}/bound/at_least", path_of(&name)));
            }
            if !is_decided && next.is_none() && self.name == HISTORY {
                claims.pass("bound/at_least");
            }
            if let Some(baked) = self.baked.filter(|_| next.is_none()) {
                super::baked::check_baked(baked, (ends.read, written), ends.rounding, claims, self.job)?;
            }
            if let Some(certificate) = self.certificate.filter(|_| next.is_none()) {
                let offset = step.offset.as_ref().map(|offset| json!(offset));
                if offset.is_some() || certificate.get("offset").is_some() {
                    let is_same = certificate.get("offset") == offset.as_ref();
                    claims.decide("offset", is_same, "it is another one than that of the last step");
                }
                // The input was put together in the frame that the certificate states, so that it confirms nothing.
                let stating = [Some(written), Some(ends.read).filter(|_| step.composed.is_none())];
                pass_frame(&frame, stating, claims);
                let bound = step.bound.as_ref().and_then(|bound| bound.at_most).unwrap_or(0.0);
                let moved = ends.rounding.into_iter().fold(bound, add_up);
                let (is_composed, verb, read) = (step.composed.is_some(), &step.verb[..], ends.read);
                let (frame, job) = (&frame, self.job);
                AttributeJudge { certificate, read, written, frame, moved, verb, is_composed, job }
                    .check(claims)?;
            }
        }
        // If a lower end in a step is unchecked, so is that in the sum.
        let path = path_of(self.name);
        let has_lower_end = self.history.total.as_ref().is_some_and(|total| total.at_least > 0.0);
        if has_lower_end && claims.has_passed(&format!("{path}/steps/")) {
            claims.pass(format!("{path}/total/at_least"));
        }
        Ok(())
    }

    /// The inputs that a step put together, each with its own history proved; `None` if one was not given.
    fn parts_of(
        &self,
        name: &str,
        step: &StepFacts,
        facts: &'a ComposedFacts,
        claims: &mut ClaimList,
    ) -> Result<Option<Vec<&'a Input>>, MeshFailure> {
        let mut parts = Vec::with_capacity(step.inputs.len());
        for (k, (input, origin)) in step.inputs.iter().zip(&facts.origins).enumerate() {
            let Some(part) = self.find_input(input) else {
                // Goes on, so that all missing files are named at once.
                claims.open(name, not_given(step, input));
                continue;
            };
            parts.push(part);
            let name_of_part = format!("{name}/origins/{k}");
            let Some(last) = origin.steps.last() else {
                check_beginning(&format!("{name_of_part}/begins"), &origin.begins, (part, None), claims);
                continue;
            };
            self.check_link(&name_of_part, last, part, claims)?;
            let frame = self.frame_of(part, false);
            let origin_steps = ProvedSteps {
                name: &name_of_part,
                out: part,
                frame,
                certificate: None,
                baked: None,
                witness: None,
                history: origin,
                ..*self
            };
            origin_steps.check_start(claims)?;
            origin_steps.check_steps(claims)?;
        }
        Ok((parts.len() == step.inputs.len()).then_some(parts))
    }

    /// Checks that every given file is one that the history names, with the same files beside it.
    fn check_files(&self, claims: &mut ClaimList) {
        let inputs = self.history.inputs();
        for given in self.against {
            let file = given.file;
            let named: Vec<_> = inputs.iter().filter(|input| given.is(input)).collect();
            let beside: Vec<&String> = file.files.iter().map(|file| &file.sha256).collect();
            let short = short(file.sha256());
            if named.is_empty() && inputs.iter().all(|input| self.find_input(input).is_some()) {
                // An additional file that is not needed.
                continue;
            }
            if named.is_empty() {
                let kind = file.shape.kind();
                let reason = format!(
                    "the certificate is for another input: it names none with {short}, the {kind} to verify against"
                );
                claims.refute("input", reason);
            } else if named.iter().any(|input| input.files.iter().collect::<Vec<_>>() != beside) {
                claims.refute("input", format!("the files beside the input with {short} are different"));
            } else {
                claims.prove("input");
            }
        }
    }

    /// The file that a step read, by its digest.
    fn find_input(&self, input: &StepInput) -> Option<&'a Input> {
        let mut matching = self.against.iter().filter(|given| given.is(input)).map(|given| given.file);
        let first = matching.next();
        // Without a digest, a choice among several files is not known.
        first.filter(|_| input.sha256.is_some() || matching.next().is_none())
    }

    /// Checks that the file between two steps holds the geometry that the first step wrote.
    fn check_link(
        &self,
        name: &str,
        step: &StepFacts,
        written: &Input,
        claims: &mut ClaimList,
    ) -> Result<(), MeshFailure> {
        let frame = self.frame_of(written, false);
        let digest = digest_in_frame(&written.shape, written.format, &frame)?;
        let holds = digest.is_some() && digest == step.output.geometry;
        let claim = format!("{name}/output");
        claims.decide(&claim, holds, "the next step read a file with another geometry than this one wrote");
        Ok(())
    }

    fn frame_of(&self, written: &Input, is_last: bool) -> Frame {
        if is_last {
            return self.frame;
        }
        embedded_certificate(&written.shape).map_or(Frame::default(), stated_frame)
    }

    /// Checks the bound of a step. Returns false if the upper end was decided but the lower end could not be.
    fn check_bound(
        &self,
        name: &str,
        step: &StepFacts,
        ends: &StepEnds<'_>,
        frame: &Frame,
        claims: &mut ClaimList,
    ) -> Result<bool, MeshFailure> {
        let claim = format!("{name}/bound");
        let (is, stated) = (ends.read.shape.frame(), (frame.up, frame.metres_per_unit));
        let differs = is.up.zip(stated.0).is_some_and(|(a, b)| a != b)
            || is.metres_per_unit.zip(stated.1).is_some_and(|(a, b)| a != b);
        if differs {
            claims.refute(
                "frame",
                "the certificate states another unit or another axis that is up than its input",
            );
        }
        // A step without a bound claims nothing.
        let Some(stated) = &step.bound else { return Ok(true) };
        let Some(bound) = stated.bound() else {
            claims.refute(&claim, "the bound in the certificate is not valid");
            return Ok(true);
        };
        // The bound is against a composition with its own rounding, and the judge has another composition.
        let bound = widened(&bound, ends.rounding);
        let judge = BoundJudge::new([ends.read, ends.written], frame, self.job);
        if let Some(offset) = &step.offset {
            let judged = match judge.triangles()? {
                Some(meshes) => judge_offset(&meshes, offset, &bound, self.job)?,
                None => JudgedBound::Unable("only triangles have an offset".to_owned()),
            };
            claims.add(verdict_on(claim, stated, &bound, (judged, false)));
            // The lower end is what samples showed, and nothing is promised by it.
            return Ok(false);
        }
        let (judged, is_cut_short) = judge.judge_within(JudgeLimit::OF_CLAIM, &bound)?;
        let least = judged.at_least();
        claims.add(verdict_on(claim.clone(), stated, &bound, (judged, is_cut_short)));
        check_least(&format!("{claim}/at_least"), &bound, (least, judge, ends.witness), claims)
    }

    /// Checks that the distance between the ends of a chain is no more than the sum of its steps.
    fn check_total(&self, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        let HistoryFacts { steps, total, .. } = self.history;
        let (Some(total), Some([first])) = (total, steps.first().map(|step| &step.inputs[..])) else {
            return Ok(());
        };
        // The first input was moved, or has another surface, so that the distance to it is a different one.
        let is_moved = steps[0].composed.is_some() || steps.iter().any(|step| step.offset.is_some());
        let Some(read) = self.find_input(first).filter(|_| steps.len() > 1 && !is_moved) else {
            return Ok(());
        };
        let Some(bound) = total.bound() else { return Ok(()) };
        let judge = BoundJudge::new([read, self.out], &self.frame, self.job);
        let judged = judge.judge_within(JudgeLimit::OF_CLAIM, &bound)?;
        let facts = verdict_on("history/total/direct".to_owned(), total, &bound, judged);
        // The steps alone prove the sum. This check of the ends is an additional one, and if no judge can decide it, it is
        // left out.
        if facts.verdict != ClaimVerdict::Open {
            claims.add(facts);
        }
        Ok(())
    }
}

/// Checks the claimed lower end: by the judge of the upper end, by the point where most was lost, and by one more precise
/// check. Returns whether it was decided; a still more precise check may cost far more than the work on the result.
fn check_least(
    claim: &str,
    claimed: &Bound,
    (shown, judge, witness): (Option<f64>, BoundJudge<'_>, Option<[f64; 3]>),
    claims: &mut ClaimList,
) -> Result<bool, MeshFailure> {
    /// The share by which both ends may differ. Chosen: that of `deviation`; a hundredth took minutes for limit surfaces
    /// and fields whose step took seconds.
    const CLOSER: f64 = 0.1;
    /// Judges of the same points round differently, see `with_margin` for simplified triangles.
    const MARGIN: f64 = 1.0 - 1.0 / (1_u64 << 40) as f64;
    let Some(mut shown) = shown.filter(|_| claimed.at_least() > 0.0) else { return Ok(true) };
    let needed = MARGIN * claimed.at_least();
    if let Some(p) = witness.filter(|_| shown < needed) {
        shown = greater(judge.seen_from(p, claimed)?.unwrap_or(0.0), shown);
    }
    if shown < needed
        && let (JudgedBound::Between(judged), _) =
            judge.closely(CLOSER).judge_within(JudgeLimit::CLOSER, claimed)?
    {
        if let Some(most) = judged.at_most().filter(|most| *most < claimed.at_least()) {
            let reason = format!("the shapes are no more than {most:?} apart, less than is claimed at least");
            claims.refute(claim, reason);
            return Ok(true);
        }
        shown = greater(judged.at_least(), shown);
    }
    let is_shown = shown >= needed;
    if is_shown {
        claims.prove(claim);
    }
    Ok(is_shown)
}

/// Lists the stated frame as unchecked if neither the file nor its input states one.
fn pass_frame(stated: &Frame, stating: [Option<&Input>; 2], claims: &mut ClaimList) {
    let frames: Vec<&Frame> = stating.into_iter().flatten().map(|input| input.shape.frame()).collect();
    if stated.up.is_some() && frames.iter().all(|frame| frame.up.is_none()) {
        claims.pass("frame/up");
    }
    if stated.metres_per_unit.is_some() && frames.iter().all(|frame| frame.metres_per_unit.is_none()) {
        claims.pass("frame/metres_per_unit");
    }
}

/// The path in the certificate of the subject of a claim.
fn path_of(claim: &str) -> String {
    claim.replace("/origins/", "/composed/origins/")
}

/// How many times the rounding of one map may have been rounded altogether: at each move, and in the comparison from both
/// sides. Chosen: some twenty moves; still far too small to be seen.
const MOST_ROUNDED: f64 = 64.0;

/// A short form of a digest.
fn short(sha256: Option<&str>) -> String {
    /// Digits that are shown. Chosen: enough to tell files apart.
    const SHORT: usize = 12;
    sha256.map_or("no digest".to_owned(), |digest| {
        format!("SHA-256 {}…", digest.get(..SHORT).unwrap_or(digest))
    })
}

/// Checks the reason why a history has no step before an input, by the certificate of the input.
fn check_beginning(
    claim: &str,
    begins: &HistoryStart,
    (read, next): (&Input, Option<&StepFacts>),
    claims: &mut ClaimList,
) {
    /// Reasons that also depend on how the input was read, or on how much a file holds, which the files do not show.
    const BY_READING: [&str; 9] =
        ["seal", "unreadable", "geometry", "unit", "kind", "surface", "bound", "several-inputs", "long"];
    let origin = InputOrigin::from_input(read);
    let broken = origin.steps.last().zip(next).and_then(|(before, next)| gap(before, next));
    let actual = if origin.steps.is_empty() { Some(origin.begins.code) } else { broken.map(|gap| gap.code) };
    if actual.as_deref() == Some(&begins.code[..]) {
        claims.prove(claim);
    } else if BY_READING.contains(&&begins.code[..]) {
        let reason = format!("that it begins there because of '{}' was not seen in the input", begins.code);
        claims.open(claim, reason);
    } else if let Some(actual) = actual {
        let reason =
            format!("the history begins there for another reason: '{actual}' and not '{}'", begins.code);
        claims.refute(claim, reason);
    } else {
        let n = origin.steps.len();
        claims
            .refute(claim, format!("the certificate of the input has {n} steps before, which are left out"));
    }
}

/// Checks that the files are of the kinds that the step names, and its bound is against a shape of that kind.
fn check_kinds(name: &str, step: &StepFacts, (read, written): (&Input, &Input), claims: &mut ClaimList) {
    let stated = step.inputs.first().map_or("", |input| &input.kind);
    let kind = read.shape.kind();
    if stated != kind {
        let reason = format!("the step read its input as {stated}, and it was read as {kind} now");
        claims.refute(&format!("{name}/input"), reason);
    }
    // A reader may cut polygons into triangles; the judge of the bound accounts for that.
    let (stated, actual) = (&step.output.kind[..], written.shape.kind());
    if stated != actual && (stated, actual) != ("cage", "triangles") {
        claims.refute(
            &format!("{name}/output"),
            format!("the step wrote {stated}, and the file holds {actual}"),
        );
    }
    let reference = match (kind, written.shape.kind()) {
        _ if step.offset.is_some() => "field",
        ("triangles", _) => "input triangles",
        ("patches", _) => "bezier patches",
        ("surfaces", _) => "nurbs surfaces",
        ("field", _) => "field",
        ("volume", _) => "trilinear interpolant",
        ("drawing" | "curves", _) => "curves",
        // Polygons that stay polygons are compared with the polygons; otherwise they represent their limit surface.
        ("cage", "cage") => "input triangles",
        ("cage", _) => "limit surface",
        _ => return,
    };
    let kept_polygons = kind == "cage" && step.output.kind == "cage";
    let is_right = |bound: &StepBound| {
        bound.reference == reference
            || kept_polygons && ["input triangles", "limit surface"].contains(&&bound.reference[..])
    };
    if step.bound.as_ref().is_some_and(|bound| !is_right(bound)) {
        let reason = format!("its bound is not against the {kind} that it read");
        claims.refute(&format!("{name}/reference"), reason);
    }
}

/// The reason of a claim that stays open because its judge used up its work.
const CUT_SHORT: &str =
    "it was not checked to its end, which takes more work than is allowed: the best effort has no limit";

/// The verdict on a claimed bound by a judged distance.
fn verdict_on(
    claim: String,
    stated: &StepBound,
    bound: &Bound,
    (judged, is_cut_short): (JudgedBound, bool),
) -> ClaimFacts {
    let claimed = stated.at_most;
    let (verdict, reason, ends) = match judged {
        JudgedBound::Unable(reason) => (ClaimVerdict::Open, Some(reason), None),
        JudgedBound::Between(enclosed) => {
            let ends = Some((enclosed.at_least(), enclosed.at_most()));
            let (verdict, reason) = match compare(bound, &enclosed) {
                (ClaimVerdict::Open, _) if is_cut_short => (ClaimVerdict::Open, Some(CUT_SHORT.to_owned())),
                decided => decided,
            };
            (verdict, reason, ends)
        }
    };
    ClaimFacts { claim, verdict, reason, claimed, found: ends }
}

fn compare(claimed: &Bound, judged: &Bound) -> (ClaimVerdict, Option<String>) {
    let (least, most) = (judged.at_least(), judged.at_most());
    let refuted = |reason: String| (ClaimVerdict::Refuted, Some(reason));
    let open = |reason: &str| (ClaimVerdict::Open, Some(reason.to_owned()));
    if most.is_some_and(|most| most < claimed.at_least()) {
        return refuted(format!(
            "the shapes are no more than {most:?} apart, less than is claimed at least",
            most = most.unwrap_or(0.0)
        ));
    }
    let Some(limit) = claimed.at_most() else {
        return open("the certificate claims no upper bound, so that there is nothing to prove");
    };
    if least > limit {
        return refuted(format!("the shapes are at least {least:?} apart, and {limit:?} at most is claimed"));
    }
    if most.is_none_or(|most| most > limit) {
        return open("the judge could not prove that the shapes are as close as is claimed");
    }
    let is_as_strong = match (claimed.evidence(), judged.evidence()) {
        (_, Evidence::Proved) => true,
        (Evidence::ProvedIf(stated), Evidence::ProvedIf(needs)) => {
            needs.iter().all(|need| stated.contains(need))
        }
        _ => false,
    };
    if !is_as_strong {
        return open("the judge's proof rests on promises that the certificate does not name");
    }
    (ClaimVerdict::Proved, None)
}

fn not_given(step: &StepFacts, input: &StepInput) -> String {
    match input.sha256.as_deref() {
        Some(sha256) => {
            format!("the input of {}, with {}, was not given", words_of(step), short(Some(sha256)))
        }
        None => format!(
            "the input of {} has no digest, so that it can only be identified if just one {} is given",
            words_of(step),
            input.kind
        ),
    }
}

/// Converts a bound against triangles that are `rounding` away from the exact ones into a bound against triangles that are
/// `again` away from the exact ones.
fn widened(bound: &Bound, [rounding, again]: [f64; 2]) -> Bound {
    if rounding == 0.0 && again == 0.0 {
        return bound.clone();
    }
    let at_least = greater(sub_down(bound.at_least(), add_up(rounding, again)), 0.0);
    let at_most = bound.at_most().map(|most| {
        let most = sub_down(add_up(most, rounding), again);
        lesser(greater(most, 0.0), f64::MAX)
    });
    let mut wider =
        Bound::with_evidence(at_least, at_most, bound.evidence().clone(), bound.reference.clone());
    wider.metric = bound.metric;
    wider
}

/// A step in words.
fn words_of(step: &StepFacts) -> String {
    let inputs: Vec<&str> = step.inputs.iter().map(|input| &input.kind[..]).collect();
    format!("{} from {} to {}", step.verb, inputs.join(" and "), step.output.kind)
}
