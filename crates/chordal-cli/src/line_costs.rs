//! `line_costs`: what the shape of each line of a script takes to be meshed by itself, so that its author sees which one
//! costs.
use crate::deadline::Deadline;
use crate::fault::Fault;
use crate::spelling::CommandLine;
use chordal::Job;
use chordal::budget::Length;
use chordal::budget::advice::Spell;
use chordal_io::Format;
use chordal_verbs::report::{BoundFacts, LineCostFacts};
use chordal_verbs::{BudgetSpec, ImplicitShape, Input, MeshFailure, MeshOutcome, Shape, mesh};
use std::time::{Duration, Instant};

/// How long a line may take; then the best so far counts. Chosen: what takes longer is what one looks for.
const MOST: Duration = Duration::from_secs(20);

/// The costs of all lines, in their order, and of the whole, each within a length; percents are of the whole.
pub fn line_costs(input: &Input, within: Length, job: &Job) -> Result<Vec<LineCostFacts>, Fault> {
    let Shape::Field(whole) = &input.shape else {
        return Err(Fault::usage("--cost is for shape scripts: this input has no lines that make shapes"));
    };
    let diagonal = whole.bounds().diagonal();
    if matches!(within, Length::Percent(_)) && !diagonal.is_finite() {
        let line = "the shape has no end in some direction, so that no length is a share of it: say one, as in --cost=0.1";
        return Err(Fault::usage(line));
    }
    let length = within
        .resolve(diagonal, whole.frame.metres_per_unit)
        .map_err(|error| Fault::usage(error.spelled(&CommandLine).to_string()))?;
    let cost = |line: Option<u64>, times: usize, shape: ImplicitShape| {
        let mut own = Job::default().with_threads(job.threads);
        own.memory_limit = job.memory_limit;
        let spec = BudgetSpec { length: Some(Length::Plain(length.get())), ..BudgetSpec::default() };
        let part = Input { shape: Shape::Field(shape), ..input.clone() };
        let (began, deadline) = (Instant::now(), Deadline::start(&own, MOST, None));
        let made = mesh(part, &spec, Format::Ply, &own).spelled(&CommandLine);
        drop(deadline);
        let seconds = began.elapsed().as_secs_f64();
        let facts = |made: Option<&MeshOutcome>, reason: Option<String>| LineCostFacts {
            line,
            times: times as u64,
            triangles: made
                .and_then(MeshOutcome::scene)
                .map(|scene| scene.parts.iter().map(|part| part.mesh.faces().len() as u64).sum()),
            seconds,
            bound: made.map(|made| BoundFacts::new(&made.bound)),
            reason,
        };
        match &made {
            Ok(made) => facts(Some(made), None),
            Err(MeshFailure::Unmet(best)) => facts(Some(best), None),
            Err(failure) => facts(None, Some(failure.to_string())),
        }
    };
    let mut all = Vec::new();
    for one in whole.shapes_by_line() {
        let shape = ImplicitShape::new(one.field, whole.region, whole.frame);
        all.push(cost(Some(one.line), one.times, shape));
    }
    all.push(cost(None, 1, whole.clone()));
    Ok(all)
}
