//! The steps of a history, proved again one by one, and their sum.
use super::attributes::AttributeJudge;
use super::bound_judge::{BoundJudge, JudgedBound, LookLimit};
use super::claims::{ClaimFacts, ClaimList, ClaimVerdict};
use super::composed_reference::ComposedReference;
use crate::geometry_digest::{digest_in_frame, geometry_digest};
use crate::origin::{InputOrigin, embedded_certificate, stated_frame};
use crate::report::{ComposedFacts, HistoryFacts, HistoryStart, StepBound, StepFacts, StepInput, gap};
use crate::{Input, MeshFailure};
use chordal::Job;
use chordal::budget::{Bound, Evidence};
use chordal::math::{add_up, greater, lesser, sub_down};
use chordal_io::Frame;
use serde_json::Value;
use std::cell::OnceCell;

/// What the claims about the history of a file are called; those about histories in it begin so.
pub(super) const HISTORY: &str = "history";

/// A history, and the files that it speaks of.
pub(super) struct ProvedSteps<'a> {
    /// What the claims about it are called.
    pub name: &'a str,
    /// What the last step wrote.
    pub out: &'a Input,
    /// The frame of its lengths.
    pub frame: Frame,
    /// Its certificate; `None` where only its history is known.
    pub certificate: Option<&'a Value>,
    /// What its certificate says of a baked grid.
    pub baked: Option<&'a Value>,
    /// Where its certificate says that the last step lost most.
    pub witness: Option<[f64; 3]>,
    pub history: &'a HistoryFacts,
    pub against: &'a [GivenFile<'a>],
    pub job: &'a Job,
}

/// A file that was given.
pub(super) struct GivenFile<'a> {
    file: &'a Input,
    geometry: OnceCell<Option<String>>,
}

impl<'a> GivenFile<'a> {
    pub fn new(file: &'a Input) -> Self {
        Self { file, geometry: OnceCell::new() }
    }

    /// Whether it is one that a step names: by its bytes, or by its geometry for an input that never was a file.
    fn is(&self, input: &StepInput) -> bool {
        let geometry = || self.geometry.get_or_init(|| geometry_digest(&self.file.shape).ok().flatten());
        let is_of_kind = input.kind == self.file.shape.kind();
        match input.sha256.as_deref() {
            // It may be any: whether it is the one, the judge of the bound says.
            None => is_of_kind,
            said => self.file.sha256() == said || is_of_kind && geometry().as_deref() == said,
        }
    }
}

/// What a step read, and what it wrote.
struct StepEnds<'a> {
    read: &'a Input,
    written: &'a Input,
    /// Where inputs were put together: what that may round, and what putting them together again may.
    rounding: [f64; 2],
    /// Where the step is said to have lost most.
    witness: Option<[f64; 3]>,
}

impl<'a> ProvedSteps<'a> {
    pub fn check(&self, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        // The sum of the bounds, and that each step goes on where the one before it ended.
        let flaw = self.history.flaw();
        let holds_together = flaw.is_none();
        claims.decide("history/total", holds_together, &flaw.unwrap_or_default());
        self.check_files(claims);
        self.check_start(claims)?;
        if holds_together {
            self.check_steps(claims)?;
            self.check_total(claims)?;
        }
        Ok(())
    }

    /// The history goes back as far as the certificate of its first input does.
    fn check_start(&self, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        let HistoryFacts { steps, begins, .. } = self.history;
        let claim = format!("{}/begins", self.name);
        match steps.first() {
            Some(first) if first.composed.is_some() => {
                let reason = "its first step read what was put together, and the history says otherwise";
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
                    Err(why) => {
                        claims.open(&name, why);
                        continue;
                    }
                };
                if facts.rounding > MOST_ROUNDED * composed.rounding {
                    let reason = "more was rounded on the way than this map and these coordinates explain";
                    claims.open(&format!("{name}/composed/rounding"), reason);
                }
                let rounding = [facts.rounding, composed.off];
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
                // What was put together stands in the frame that the certificate states.
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
        // What nobody looked at in a step nobody looked at in the sum.
        let path = path_of(self.name);
        let is_said = self.history.total.as_ref().is_some_and(|total| total.at_least > 0.0);
        if is_said && claims.has_passed(&format!("{path}/steps/")) {
            claims.pass(format!("{path}/total/at_least"));
        }
        Ok(())
    }

    /// The inputs that a step put together, each with its own history proved; `None` where one was not given.
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
                claims.open(name, not_given(step, input));
                continue;
            };
            parts.push(part);
            let own = format!("{name}/origins/{k}");
            let Some(last) = origin.steps.last() else {
                check_beginning(&format!("{own}/begins"), &origin.begins, (part, None), claims);
                continue;
            };
            self.check_link(&own, last, part, claims)?;
            let frame = self.frame_of(part, false);
            let own = ProvedSteps {
                name: &own,
                out: part,
                frame,
                certificate: None,
                baked: None,
                witness: None,
                history: origin,
                ..*self
            };
            own.check_start(claims)?;
            own.check_steps(claims)?;
        }
        Ok((parts.len() == step.inputs.len()).then_some(parts))
    }

    /// Every file that was given is one that the history names, with the files beside it.
    fn check_files(&self, claims: &mut ClaimList) {
        let inputs = self.history.inputs();
        for given in self.against {
            let file = given.file;
            let named: Vec<_> = inputs.iter().filter(|input| given.is(input)).collect();
            let beside: Vec<&String> = file.files.iter().map(|file| &file.sha256).collect();
            let short = short(file.sha256());
            if named.is_empty() && inputs.iter().all(|input| self.find_input(input).is_some()) {
                // It is one more than is needed.
                continue;
            }
            if named.is_empty() {
                let kind = file.shape.kind();
                let reason = format!(
                    "the certificate is of another input: it names none with {short}, the {kind} to verify against"
                );
                claims.refute("input", reason);
            } else if named.iter().any(|input| input.files.iter().collect::<Vec<_>>() != beside) {
                claims.refute("input", format!("the files beside the input with {short} are other ones"));
            } else {
                claims.prove("input");
            }
        }
    }

    /// The file that a step read, by the digest of its bytes.
    fn find_input(&self, input: &StepInput) -> Option<&'a Input> {
        let mut found = self.against.iter().filter(|given| given.is(input)).map(|given| given.file);
        let first = found.next();
        // Of several without a digest nobody knows which it is.
        first.filter(|_| input.sha256.is_some() || found.next().is_none())
    }

    /// The file between two steps holds the geometry that the first of them wrote.
    fn check_link(
        &self,
        name: &str,
        step: &StepFacts,
        written: &Input,
        claims: &mut ClaimList,
    ) -> Result<(), MeshFailure> {
        let frame = self.frame_of(written, false);
        let found = digest_in_frame(&written.shape, written.format, &frame)?;
        let holds = found.is_some() && found == step.output.geometry;
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

    /// Whether all of the bound was decided on, or is open: its lower end may neither be shown nor be excluded.
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
        let Some(said) = &step.bound else { return Ok(true) };
        let Some(bound) = said.bound() else {
            claims.refute(&claim, "what the certificate says is no bound");
            return Ok(true);
        };
        // Of what was put together and rounded, from what is put together and rounded now.
        let bound = widened(&bound, ends.rounding);
        let judge = BoundJudge::new([ends.read, ends.written], frame, self.job);
        let (found, is_cut_short) = judge.judge_within(LookLimit::OF_CLAIM, &bound)?;
        let least = found.at_least();
        claims.add(verdict_on(claim.clone(), said, &bound, (found, is_cut_short)));
        check_least(&format!("{claim}/at_least"), &bound, (least, judge, ends.witness), claims)
    }

    /// The distance between the ends of a chain is no more than the sum of its steps.
    fn check_total(&self, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        let HistoryFacts { steps, total, .. } = self.history;
        let (Some(total), Some([first])) = (total, steps.first().map(|step| &step.inputs[..])) else {
            return Ok(());
        };
        // What was moved is elsewhere.
        let is_moved = steps[0].composed.is_some();
        let Some(read) = self.find_input(first).filter(|_| steps.len() > 1 && !is_moved) else {
            return Ok(());
        };
        let Some(bound) = total.bound() else { return Ok(()) };
        let judge = BoundJudge::new([read, self.out], &self.frame, self.job);
        let found = judge.judge_within(LookLimit::OF_CLAIM, &bound)?;
        let facts = verdict_on("history/total/direct".to_owned(), total, &bound, found);
        // Steps that were proved one by one prove the sum; that the ends are no farther apart is a second look,
        // and where no judge sees that far there is none.
        if facts.verdict != ClaimVerdict::Open {
            claims.add(facts);
        }
        Ok(())
    }
}

/// What is claimed at least: by what the judge of the upper end knows, by the point where most was lost, and by one closer look.
/// Whether it was shown, excluded, or is open with the bound; a closer look may cost far more than the work.
fn check_least(
    claim: &str,
    said: &Bound,
    (known, judge, witness): (Option<f64>, BoundJudge<'_>, Option<[f64; 3]>),
    claims: &mut ClaimList,
) -> Result<bool, MeshFailure> {
    /// The share by which both ends may differ; chosen, that of `deviation`. A hundredth took minutes for limit surfaces and
    /// fields of which the step took seconds.
    const CLOSER: f64 = 0.1;
    /// Judges of the same points round otherwise, see `with_room` of simplified triangles.
    const ROOM: f64 = 1.0 - 1.0 / (1_u64 << 40) as f64;
    let Some(mut known) = known.filter(|_| said.at_least() > 0.0) else { return Ok(true) };
    let needed = ROOM * said.at_least();
    if let Some(p) = witness.filter(|_| known < needed) {
        known = greater(judge.seen_from(p, said)?.unwrap_or(0.0), known);
    }
    if known < needed
        && let (JudgedBound::Between(judged), _) =
            judge.closely(CLOSER).judge_within(LookLimit::CLOSER, said)?
    {
        if let Some(most) = judged.at_most().filter(|most| *most < said.at_least()) {
            let reason = format!("the shapes are no more than {most:?} apart, less than is claimed at least");
            claims.refute(claim, reason);
            return Ok(true);
        }
        known = greater(judged.at_least(), known);
    }
    let is_shown = known >= needed;
    if is_shown {
        claims.prove(claim);
    }
    Ok(is_shown)
}

/// What a certificate says of its frame is left unchecked where neither the file nor what it was made of says it.
fn pass_frame(stated: &Frame, stating: [Option<&Input>; 2], claims: &mut ClaimList) {
    let frames: Vec<&Frame> = stating.into_iter().flatten().map(|input| input.shape.frame()).collect();
    if stated.up.is_some() && frames.iter().all(|frame| frame.up.is_none()) {
        claims.pass("frame/up");
    }
    if stated.metres_per_unit.is_some() && frames.iter().all(|frame| frame.metres_per_unit.is_none()) {
        claims.pass("frame/metres_per_unit");
    }
}

/// The path in the certificate of what a claim is about.
fn path_of(claim: &str) -> String {
    claim.replace("/origins/", "/composed/origins/")
}

/// So many times what one rounding of the map costs may have been rounded on the way: at each move, and it is looked at from both
/// sides. Chosen: some twenty moves; still far below what anybody sees.
const MOST_ROUNDED: f64 = 64.0;

/// A digest in short.
fn short(sha256: Option<&str>) -> String {
    /// Digits that are shown; chosen.
    const SHORT: usize = 12;
    sha256.map_or("no digest".to_owned(), |all| format!("SHA-256 {}…", all.get(..SHORT).unwrap_or(all)))
}

/// Why a history has no step before that of an input: what its certificate says is looked at again.
fn check_beginning(
    claim: &str,
    begins: &HistoryStart,
    (read, next): (&Input, Option<&StepFacts>),
    claims: &mut ClaimList,
) {
    /// What depends on how the input was read as well, or on how much a file holds: nothing of that is in the files.
    const BY_READING: [&str; 9] =
        ["seal", "unreadable", "geometry", "unit", "kind", "surface", "bound", "several-inputs", "long"];
    let origin = InputOrigin::from_input(read);
    let broken = origin.steps.last().zip(next).and_then(|(before, next)| gap(before, next));
    let found = if origin.steps.is_empty() { Some(origin.begins.code) } else { broken.map(|gap| gap.code) };
    if found.as_deref() == Some(&begins.code[..]) {
        claims.prove(claim);
    } else if BY_READING.contains(&&begins.code[..]) {
        let reason = format!("that it begins there because of '{}' was not seen in the input", begins.code);
        claims.open(claim, reason);
    } else if let Some(found) = found {
        let reason =
            format!("the history begins there by another reason: '{found}' and not '{}'", begins.code);
        claims.refute(claim, reason);
    } else {
        let n = origin.steps.len();
        claims
            .refute(claim, format!("the certificate of the input has {n} steps before, which are left out"));
    }
}

/// The files are of the kinds that the step names, and its bound is against a shape of such a kind.
fn check_kinds(name: &str, step: &StepFacts, (read, written): (&Input, &Input), claims: &mut ClaimList) {
    let said = step.inputs.first().map_or("", |input| &input.kind);
    let kind = read.shape.kind();
    if said != kind {
        let reason = format!("the step read its input as {said}, and it was read as {kind} now");
        claims.refute(&format!("{name}/input"), reason);
    }
    // A reader may cut polygons into triangles, which the judge of the bound then says.
    let (said, found) = (&step.output.kind[..], written.shape.kind());
    if said != found && (said, found) != ("cage", "triangles") {
        claims
            .refute(&format!("{name}/output"), format!("the step wrote {said}, and the file holds {found}"));
    }
    let reference = match (kind, written.shape.kind()) {
        ("triangles", _) => "input triangles",
        ("patches", _) => "bezier patches",
        ("surfaces", _) => "nurbs surfaces",
        ("field", _) => "field",
        ("volume", _) => "trilinear interpolant",
        ("drawing" | "curves", _) => "curves",
        // Polygons that stay polygons are those that were read, and else they stand for their limit surface.
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

/// Why a claim stays open whose judge used up its work.
const CUT_SHORT: &str =
    "it was not checked to its end, which takes more than a look may take: the best effort has no limit";

/// What a judged distance says of a claimed bound.
fn verdict_on(
    claim: String,
    said: &StepBound,
    bound: &Bound,
    (found, is_cut_short): (JudgedBound, bool),
) -> ClaimFacts {
    let claimed = said.at_most;
    let (verdict, reason, found) = match found {
        JudgedBound::Unable(why) => (ClaimVerdict::Open, Some(why), None),
        JudgedBound::Between(judged) => {
            let ends = Some((judged.at_least(), judged.at_most()));
            let (verdict, reason) = match compare(bound, &judged) {
                (ClaimVerdict::Open, _) if is_cut_short => (ClaimVerdict::Open, Some(CUT_SHORT.to_owned())),
                found => found,
            };
            (verdict, reason, ends)
        }
    };
    ClaimFacts { claim, verdict, reason, claimed, found }
}

fn compare(said: &Bound, judged: &Bound) -> (ClaimVerdict, Option<String>) {
    let (least, most) = (judged.at_least(), judged.at_most());
    let refuted = |reason: String| (ClaimVerdict::Refuted, Some(reason));
    let open = |reason: &str| (ClaimVerdict::Open, Some(reason.to_owned()));
    if most.is_some_and(|most| most < said.at_least()) {
        return refuted(format!(
            "the shapes are no more than {most:?} apart, less than is claimed at least",
            most = most.unwrap_or(0.0)
        ));
    }
    let Some(limit) = said.at_most() else {
        return open("the certificate claims no upper bound, so that there is nothing to prove");
    };
    if least > limit {
        return refuted(format!("the shapes are at least {least:?} apart, and {limit:?} at most is claimed"));
    }
    if most.is_none_or(|most| most > limit) {
        return open("the judge could not prove that the shapes are as close as is claimed");
    }
    let is_as_strong = match (said.evidence(), judged.evidence()) {
        (_, Evidence::Proved) => true,
        (Evidence::ProvedIf(said), Evidence::ProvedIf(needs)) => needs.iter().all(|need| said.contains(need)),
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
            "the input of {} has no digest, so that it can only be known where one {} is given",
            words_of(step),
            input.kind
        ),
    }
}

/// A bound of a result against triangles that lie `rounding` from exact ones, as one against others that lie `again` from these.
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
