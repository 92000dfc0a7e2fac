//! What is said of a run of a verb: the facts of its report, or the fault.
use crate::fault::{Exit, Fault};
use chordal_verbs::MeshFailure;
use chordal_verbs::report::RunFacts;

/// A run of a verb that made one thing of another and wrote it.
pub fn facts(verb: &'static str, input: String, output: String, bytes: u64) -> RunFacts {
    RunFacts { verb, input: Some(input), output: Some(output), bytes: Some(bytes), ..RunFacts::default() }
}

/// The fault of a verb that failed on the input of that name. `best` is said where a best result is at hand.
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
