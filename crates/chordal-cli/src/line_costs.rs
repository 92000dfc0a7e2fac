//! `line_costs`: the cost of meshing the shape of each line of a script by itself, which shows its author the
//! expensive lines.
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

/// The time limit of a line; after it the best result so far counts. Chosen: a line that takes longer is
/// already known to be expensive.
const MOST: Duration = Duration::from_secs(20);

/// The costs of all lines in order and of the whole shape, each meshed within a length; percentages are of
/// the whole shape's diagonal.
pub fn line_costs(input: &Input, within: Length, job: &Job) -> Result<Vec<LineCostFacts>, Fault> {
    let Shape::Field(whole) = &input.shape else {
        return Err(Fault::usage("--cost is for shape scripts, and this input is none"));
    };
    let diagonal = whole.bounds().diagonal();
    if matches!(within, Length::Percent(_)) && !diagonal.is_finite() {
        let message = "the shape is unbounded in some direction, so a percentage of it is no length: give a length, as in \
            --cost=0.1";
        return Err(Fault::usage(message));
    }
    let length = within
        .resolve(diagonal, whole.frame.metres_per_unit)
        .map_err(|error| Fault::usage(error.spelled(&CommandLine).to_string()))?;
    let cost = |line: Option<u64>, times: usize, shape: ImplicitShape| {
        // A job of its own: a deadline ends the job that it is set for, and the next line has to start
        // afresh.
        let mut line_job = Job::default().with_threads(job.threads);
        line_job.memory_limit = job.memory_limit;
        let spec = BudgetSpec { length: Some(Length::Plain(length.get())), ..BudgetSpec::default() };
        let part = Input { shape: Shape::Field(shape), ..input.clone() };
        let (start, deadline) = (Instant::now(), Deadline::start(&line_job, MOST, None));
        let result = mesh(part, &spec, Format::Ply, &line_job).spelled(&CommandLine);
        drop(deadline);
        let seconds = start.elapsed().as_secs_f64();
        let facts = |outcome: Option<&MeshOutcome>, reason: Option<String>| LineCostFacts {
            line,
            times: times as u64,
            triangles: outcome
                .and_then(MeshOutcome::scene)
                .map(|scene| scene.parts.iter().map(|part| part.mesh.faces().len() as u64).sum()),
            seconds,
            bound: outcome.map(|outcome| BoundFacts::new(&outcome.bound)),
            reason,
        };
        match &result {
            Ok(outcome) => facts(Some(outcome), None),
            Err(MeshFailure::Unmet(best)) => facts(Some(best), None),
            Err(failure) => facts(None, Some(failure.to_string())),
        }
    };
    let mut costs = Vec::new();
    for line in whole.shapes_by_line() {
        let shape = ImplicitShape::new(line.field, whole.region, whole.frame);
        costs.push(cost(Some(line.line), line.times, shape));
    }
    costs.push(cost(None, 1, whole.clone()));
    Ok(costs)
}
