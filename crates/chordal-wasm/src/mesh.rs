//! Meshes a shape from the bytes of a file to the bytes of another.
use crate::options::MeshCall;
use crate::outcome::Outcome;
use crate::spelling::{AsCommand, JsonKeys};
use chordal::Job;
use chordal::budget::advice::Spell;
use chordal_io::Limits;
use chordal_verbs::options::not_a_volume;
use chordal_verbs::{FormatHint, MeshFailure, MeshOutcome, Shape, load, mesh as mesh_verb};

/// Turns the shape in `input` into triangles.
pub(crate) fn mesh(input: &[u8], options: &[u8]) -> Outcome {
    let options = match MeshCall::parse(options) {
        Ok(options) => options,
        Err(error) => return Outcome::failed(2, error),
    };
    let letters = options.read.letters();
    let hint = FormatHint {
        name: options.name.as_deref(),
        format: options.read.from,
        set: &options.read.set,
        letters: letters.as_ref(),
        region: options.read.region,
    };
    let mut input = match load(input, hint, &options.read.limits(Limits::default())) {
        Ok(input) => input,
        Err(error) => return Outcome::failed(3, error.spelled(&JsonKeys)),
    };
    options.read.complete(input.shape.frame_mut());
    if let Some(surface) = options.surface {
        let Shape::Volume(sampled) = &mut input.shape else {
            let key = options.surface_key.unwrap_or_default();
            return Outcome::failed(2, not_a_volume(&key, &input.shape));
        };
        sampled.surface = surface;
    }
    match mesh_verb(input, &options.spec, options.to, &Job::default()) {
        Ok(mut outcome) => {
            options.output.strip(&mut outcome.certificate);
            mesh_outcome(outcome)
        }
        Err(failure) => {
            let (exit, sentence) = (failure.exit_code(), failure.to_string());
            match failure {
                MeshFailure::Unmet(best) if options.keep_best => {
                    Outcome { exit, error: sentence.into_bytes(), ..mesh_outcome(*best) }
                }
                other => Outcome::failed(exit, other.spelled(&JsonKeys)),
            }
        }
    }
}

fn mesh_outcome(outcome: MeshOutcome) -> Outcome {
    let mut outcome = outcome.spelled(&AsCommand);
    if outcome.names_files() {
        // A call returns only one file.
        let note = format!("the materials of {} are separate files: they were left out", outcome.format);
        outcome.certificate.notes.push(note.into());
    }
    let mut bytes = Vec::new();
    match outcome.write(&mut bytes) {
        Ok(()) => Outcome {
            bytes,
            report: outcome.certificate.to_value().to_string().into_bytes(),
            ..Outcome::default()
        },
        Err(error) => Outcome::failed(4, error),
    }
}
