//! `chordal inspect`
use crate::args::InspectArgs;
use crate::clock::Clock;
use crate::common;
use crate::fault::{Exit, Fault};
use crate::input::Source;
use crate::letter;
use crate::require::{Requirement, complaints};
use crate::talk::{Stdout, Talk};
use chordal::budget::Stopped;
use chordal_verbs::report::{Run, Valid};
use chordal_verbs::{inspect, inspect_deeply};

/// Reads, inspects, reports, and checks what is required.
pub fn run(args: &InspectArgs) -> Result<(), Fault> {
    let clock = Clock::start();
    let talk = Talk::new(&args.talk);
    let job = common::job(&args.input, None, &talk);
    let input = common::read(&args.input, &talk)?;
    let source = Source::from_arg(&args.input.input);
    let name = source.name();
    let argument = match source {
        Source::Stdin => "-".to_owned(),
        Source::File(_) => name.clone(),
    };
    let deep = args.self_intersections || args.require.iter().any(|required| required.looks_deep());
    let mut report = if deep {
        inspect_deeply(&input, &job).map_err(|stopped| fault(&name, &stopped))?
    } else {
        inspect(&input)
    };
    let run = Run { input: Some(name.clone()), ..report.run };
    report.run = clock.fill(run, &job);
    talk.result(&report.to_value(), &letter::inspect(&report, &argument), Stdout::Free)?;
    check(&name, report.certificate.valid.as_ref(), &args.require)
}

fn fault(name: &str, stopped: &Stopped) -> Fault {
    match stopped {
        Stopped::Cancelled => Fault::interrupted(),
        Stopped::Refused(refusal) => {
            Fault::new(Exit::Budget, refusal.code.as_str(), format!("{name}: {}", refusal.message))
        }
    }
}

fn check(name: &str, valid: Option<&Valid>, required: &[Requirement]) -> Result<(), Fault> {
    let failed = |line: String| Fault::new(Exit::CheckFailed, "not-valid", line);
    let Some(valid) = valid else {
        return match required {
            [] => Ok(()),
            _ => Err(Fault {
                reported: true,
                ..failed(format!("{name}: there are no triangles to check: mesh it first"))
            }),
        };
    };
    let complaints = complaints(valid, required);
    if complaints.is_empty() {
        return Ok(());
    }
    let lines = complaints.iter().map(|complaint| format!("{name}: {complaint}")).collect();
    Err(Fault { lines, reported: true, ..failed(String::new()) })
}
