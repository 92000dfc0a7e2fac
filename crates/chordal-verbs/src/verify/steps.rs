//! The steps of a history, proved again one by one, and their sum.
use super::bound_judge::{BoundJudge, JudgedBound};
use super::claims::{ClaimFacts, ClaimList, ClaimVerdict};
use crate::geometry_digest::digest_in_frame;
use crate::origin::{embedded_certificate, stated_frame};
use crate::report::{HistoryFacts, StepBound, StepFacts, StepInput, gap, sum};
use crate::{Input, MeshFailure};
use chordal::Job;
use chordal::budget::{Bound, Evidence};
use chordal_io::Frame;
use serde_json::Value;

/// A history, and the files that it speaks of.
pub(super) struct ProvedSteps<'a> {
    pub out: &'a Input,
    pub certificate: &'a Value,
    pub history: &'a HistoryFacts,
    pub against: &'a [Input],
    pub job: &'a Job,
}

impl ProvedSteps<'_> {
    pub fn check(&self, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        let steps = &self.history.steps;
        self.check_sum(claims);
        self.check_files(claims);
        for (k, step) in steps.iter().enumerate() {
            let name = format!("history/steps/{k}");
            let [input] = &step.inputs[..] else {
                let n = step.inputs.len();
                let reason =
                    format!("{} combined {n} inputs, and no judge proves such a step", words_of(step));
                claims.open(&name, reason);
                continue;
            };
            let next = steps.get(k + 1).map(|next| next.inputs.first());
            let (read, written) = match (self.find_input(input), next) {
                (Some(read), None) => (read, self.out),
                (Some(read), Some(next)) => match next.and_then(|next| self.find_input(next)) {
                    Some(written) => (read, written),
                    None => {
                        claims.open(&name, format!("the file that {} wrote was not given", words_of(step)));
                        continue;
                    }
                },
                (None, _) => {
                    let short = input.sha256.get(..SHORT).unwrap_or(&input.sha256);
                    let of = words_of(step);
                    claims.open(&name, format!("the input of {of}, with SHA-256 {short}…, was not given"));
                    continue;
                }
            };
            let is_last = next.is_none();
            if !is_last {
                self.check_link(&name, step, written, claims)?;
            }
            check_kinds(&name, step, (read, written), claims);
            let frame = self.frame_of(written, is_last);
            self.check_bound(&name, (step, read, written), &frame, claims)?;
            self.check_baked(k, (read, written), claims)?;
        }
        self.check_total(claims)
    }

    /// Every file that was given is one that the history names, with the files beside it.
    fn check_files(&self, claims: &mut ClaimList) {
        let inputs = || self.history.steps.iter().flat_map(|step| &step.inputs);
        for file in self.against {
            let named: Vec<_> = inputs().filter(|input| input.sha256 == file.sha256()).collect();
            let beside: Vec<&String> = file.files.iter().map(|file| &file.sha256).collect();
            let short = file.sha256().get(..SHORT).unwrap_or(file.sha256());
            if named.is_empty() {
                let kind = file.shape.kind();
                let reason = format!(
                    "the certificate is of another input: it names none with SHA-256 {short}…, the {kind} to verify against"
                );
                claims.refute("input", reason);
            } else if named.iter().any(|input| input.files.iter().collect::<Vec<_>>() != beside) {
                claims.refute(
                    "input",
                    format!("the files beside the input with SHA-256 {short}… are other ones"),
                );
            } else {
                claims.prove("input");
            }
        }
    }

    /// The sum of the bounds, and that each step goes on where the one before it ended.
    fn check_sum(&self, claims: &mut ClaimList) {
        let HistoryFacts { steps, total, .. } = self.history;
        let broken = steps.windows(2).find_map(|pair| gap(&pair[0], &pair[1]));
        let claim = "history/total";
        match broken {
            Some(start) => claims.refute(claim, start.reason),
            None => claims.decide(
                claim,
                *total == sum(steps),
                "the sum of the bounds of the steps is another one",
            ),
        }
    }

    /// The file that a step read, by the digest of its bytes.
    fn find_input(&self, input: &StepInput) -> Option<&Input> {
        self.against.iter().find(|file| file.sha256() == input.sha256)
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
            return stated_frame(self.certificate);
        }
        embedded_certificate(&written.shape).map_or(Frame::default(), stated_frame)
    }

    fn check_bound(
        &self,
        name: &str,
        (step, read, written): (&StepFacts, &Input, &Input),
        frame: &Frame,
        claims: &mut ClaimList,
    ) -> Result<(), MeshFailure> {
        let claim = format!("{name}/bound");
        let Some(said) = &step.bound else { return Ok(()) };
        let Some(bound) = said.bound() else {
            claims.refute(&claim, "what the certificate says is no bound");
            return Ok(());
        };
        let (is, stated) = (read.shape.frame(), (frame.up, frame.metres_per_unit));
        let differs = is.up.zip(stated.0).is_some_and(|(a, b)| a != b)
            || is.metres_per_unit.zip(stated.1).is_some_and(|(a, b)| a != b);
        if differs {
            claims.refute(
                "frame",
                "the certificate states another unit or another axis that is up than its input",
            );
        }
        let found = BoundJudge { reference: read, result: written, frame, job: self.job }.judge(&bound)?;
        claims.add(verdict_on(claim, said, &bound, found));
        Ok(())
    }

    /// What a certificate says of a baked grid, sample by sample; only of the file itself.
    fn check_baked(
        &self,
        k: usize,
        (read, written): (&Input, &Input),
        claims: &mut ClaimList,
    ) -> Result<(), MeshFailure> {
        let baked = self.certificate.get("baked").filter(|baked| !baked.is_null());
        match baked.filter(|_| k + 1 == self.history.steps.len()) {
            Some(baked) => super::bound_judge::check_baked(baked, (read, written), claims, self.job),
            None => Ok(()),
        }
    }

    /// The distance between the ends of a chain is no more than the sum of its steps.
    fn check_total(&self, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        let HistoryFacts { steps, total, .. } = self.history;
        let (Some(total), Some([first])) = (total, steps.first().map(|step| &step.inputs[..])) else {
            return Ok(());
        };
        let Some(read) = self.find_input(first).filter(|_| steps.len() > 1) else { return Ok(()) };
        let Some(bound) = total.bound() else { return Ok(()) };
        let frame = stated_frame(self.certificate);
        let found =
            BoundJudge { reference: read, result: self.out, frame: &frame, job: self.job }.judge(&bound)?;
        let facts = verdict_on("history/total/direct".to_owned(), total, &bound, found);
        // Steps that were proved one by one prove the sum; that the ends are no farther apart is a second look,
        // and where no judge sees that far there is none.
        if facts.verdict != ClaimVerdict::Open {
            claims.add(facts);
        }
        Ok(())
    }
}

/// Digits of a digest that are shown; chosen.
const SHORT: usize = 12;

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
    let reference = match kind {
        "triangles" => "input triangles",
        "patches" => "bezier patches",
        "field" => "field",
        _ => return,
    };
    if step.bound.as_ref().is_some_and(|bound| bound.reference != reference) {
        let reason = format!("its bound is not against the {kind} that it read");
        claims.refute(&format!("{name}/reference"), reason);
    }
}

/// What a judged distance says of a claimed bound.
fn verdict_on(claim: String, said: &StepBound, bound: &Bound, found: JudgedBound) -> ClaimFacts {
    let claimed = said.at_most;
    let (verdict, reason, found) = match found {
        JudgedBound::Unable(why) => (ClaimVerdict::Open, Some(why), None),
        JudgedBound::Between(judged) => {
            let ends = Some((judged.at_least(), judged.at_most()));
            let (verdict, reason) = compare(bound, &judged);
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

/// A step in words.
fn words_of(step: &StepFacts) -> String {
    let inputs: Vec<&str> = step.inputs.iter().map(|input| &input.kind[..]).collect();
    format!("{} from {} to {}", step.verb, inputs.join(" and "), step.output.kind)
}
