//! `chordal inspect`
use crate::args::{InspectArgs, Requirement};
use crate::clock::Clock;
use crate::common;
use crate::fault::{Exit, Fault};
use crate::input::Source;
use crate::numbers;
use crate::summary;
use crate::talk::{Stdout, Talk};
use chordal_verbs::inspect;
use chordal_verbs::report::{Run, Valid};

/// Reads, inspects, reports, and checks what is required.
pub fn run(args: &InspectArgs) -> Result<(), Fault> {
    let clock = Clock::start();
    let talk = Talk::new(&args.talk);
    let job = common::job(&args.input, None, &talk);
    let input = common::read(&args.input, &talk)?;
    let name = Source::from_arg(&args.input.input).name();
    let mut report = inspect(&input);
    let run = Run { input: Some(name.clone()), ..report.run };
    report.run = clock.fill(run, &job);
    talk.result(&report.to_value(), &summary::inspect(&report), Stdout::Free)?;
    check(&name, report.certificate.valid.as_ref(), &args.require)
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
    let lines: Vec<_> = required
        .iter()
        .filter_map(|requirement| {
            complaint(valid, *requirement).map(|complaint| format!("{name}: {complaint}"))
        })
        .collect();
    if lines.is_empty() {
        return Ok(());
    }
    Err(Fault { lines, reported: true, ..failed(String::new()) })
}

/// What is wrong, with the number of places and the first of them.
fn complaint(valid: &Valid, required: Requirement) -> Option<String> {
    let counts = &valid.counts;
    let place = |of: &str| {
        let first = valid.witnesses.iter().flatten().find(|witness| witness.of == of);
        first.map_or_else(String::new, |witness| format!(", the first at {}", numbers::point(witness.at)))
    };
    let [edges, vertices] = [counts.non_manifold_edges, counts.non_manifold_vertices];
    match required {
        Requirement::Closed if !counts.closed && counts.boundary_edges == 0 => {
            Some("not closed: there are no triangles".to_owned())
        }
        Requirement::Closed if !counts.closed => {
            Some(format!("not closed: {} boundary edges{}", counts.boundary_edges, place("boundary_edges")))
        }
        Requirement::Manifold if edges > 0 => Some(format!(
            "not manifold: {edges} edges with three triangles or more{}",
            place("non_manifold_edges")
        )),
        Requirement::Manifold if vertices > 0 => Some(format!(
            "not manifold: {vertices} vertices with several fans{}",
            place("non_manifold_vertices")
        )),
        Requirement::Oriented if !counts.oriented => Some(format!(
            "not oriented: {} edges whose triangles are wound against each other{}",
            counts.inconsistent_edges,
            place("inconsistent_edges")
        )),
        _ => None,
    }
}
