//! What a call came to.
use crate::options::Options;
use chordal::Job;
use chordal_io::Limits;
use chordal_verbs::{Hint, MeshFailure, MeshOutcome, load, mesh as mesh_verb};

/// What a call came to: a file with its certificate, or a sentence; with `keep_best`, both.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// 0, or an exit code of the command.
    pub(crate) exit: u8,
    /// The file.
    pub(crate) bytes: Vec<u8>,
    /// The certificate, or the answer to a question, as JSON.
    pub(crate) report: Vec<u8>,
    /// One sentence.
    pub(crate) error: Vec<u8>,
}

impl Outcome {
    fn failed(exit: u8, error: impl ToString) -> Self {
        Self { exit, error: error.to_string().into_bytes(), ..Self::default() }
    }

    fn made(made: &MeshOutcome) -> Self {
        let mut bytes = Vec::new();
        match made.write(&mut bytes) {
            Ok(()) => Self {
                bytes,
                report: made.certificate.to_value().to_string().into_bytes(),
                ..Self::default()
            },
            Err(error) => Self::failed(4, error),
        }
    }
}

/// The answer to a page's question, which stands in the report's place.
pub(crate) fn answer(answer: Result<serde_json::Value, String>) -> Outcome {
    match answer {
        Ok(answer) => Outcome { report: answer.to_string().into_bytes(), ..Outcome::default() },
        Err(error) => Outcome::failed(2, error),
    }
}

/// Turns the shape in `input` into triangles.
pub(crate) fn mesh(input: &[u8], options: &[u8]) -> Outcome {
    let options = match Options::parse(options) {
        Ok(options) => options,
        Err(error) => return Outcome::failed(2, error),
    };
    let hint = Hint { name: options.name.as_deref(), format: options.from };
    let mut input = match load(input, hint, &Limits::default()) {
        Ok(input) => input,
        Err(error) => return Outcome::failed(3, error),
    };
    let frame = input.shape.frame_mut();
    frame.metres_per_unit = options.unit.map(|unit| unit.metres()).or(frame.metres_per_unit);
    frame.up = options.up.or(frame.up);
    match mesh_verb(input, &options.spec, options.to, &Job::default()) {
        Ok(made) => Outcome::made(&made),
        Err(failure) => {
            let error = Outcome::failed(failure.exit_code(), &failure);
            match failure {
                MeshFailure::Unmet(best) if options.keep_best => {
                    Outcome { exit: error.exit, error: error.error, ..Outcome::made(&best) }
                }
                _ => error,
            }
        }
    }
}
