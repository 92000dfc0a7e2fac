//! The outcome of a run of a verb: the facts for its report, or the error.
use crate::fault::{Exit, Fault};
use chordal_verbs::MeshFailure;
use chordal_verbs::report::RunFacts;

/// The facts of a run that turned an input into an output.
pub fn facts(verb: &'static str, input: String, output: String, bytes: u64) -> RunFacts {
    RunFacts { verb, input: Some(input), output: Some(output), bytes: Some(bytes), ..RunFacts::default() }
}

/// The error of a verb that failed on an input. `best` is appended if there is a best result.
pub fn fault(name: &str, failure: &MeshFailure, best: &str) -> Fault {
    let exit = match failure.exit_code() {
        2 => Exit::Usage,
        3 => Exit::Input,
        4 => Exit::Output,
        130 => return Fault::interrupted(),
        _ => Exit::Budget,
    };
    let hint = if matches!(failure, MeshFailure::Unmet(_)) { best } else { "" };
    Fault::new(exit, failure.code(), format!("{name}: {failure}{hint}"))
}
