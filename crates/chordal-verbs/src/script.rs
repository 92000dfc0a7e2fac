//! Shape scripts as an input, in builds with the interpreter.
use crate::Shape;
use chordal_io::{Limits, ReadError, Warning};

/// Runs a script to its shape, with its warnings, each code once.
#[cfg(feature = "script")]
pub(crate) fn shape(
    bytes: &[u8],
    set: &[(String, f64)],
    limits: &Limits,
) -> Result<(Shape, Vec<Warning>), ReadError> {
    use crate::{ImplicitShape, Parameter};
    use chordal_io::{FileLocation, Frame};
    use chordal_script::{RunOptions, run};

    let text = std::str::from_utf8(bytes).map_err(|error| {
        let place = FileLocation::Byte(error.valid_up_to() as u64);
        ReadError::new("not-utf8", place, "the script is not UTF-8: save it as UTF-8 or plain ASCII")
    })?;
    let mut options = RunOptions { set: set.iter().cloned().collect(), ..RunOptions::default() };
    let most = usize::try_from(limits.bytes).unwrap_or(usize::MAX);
    if most < options.limits.heap {
        options.limits.heap = most;
    }
    let script = run(text, &options, &Default::default()).map_err(|error| {
        let place = error
            .place
            .map_or(FileLocation::File, |(line, column)| FileLocation::LineColumn { line, column });
        let shown = error.excerpt().map_or_else(String::new, |excerpt| format!("\n{excerpt}"));
        ReadError::new(error.code, place, error.message + &shown)
    })?;
    let parameters = script.parameters.into_iter();
    let parameters =
        parameters.map(|p| Parameter { name: p.name, default: p.default, value: p.value }).collect();
    let mut warnings: Vec<Warning> = Vec::new();
    for warning in script.warnings {
        if let Some(known) = warnings.iter_mut().find(|known| known.code == warning.code) {
            known.count += 1;
            continue;
        }
        let (line, column) = warning.place;
        let place = FileLocation::LineColumn { line, column };
        warnings.push(Warning { code: warning.code, count: 1, place, message: warning.message.into() });
    }
    let frame = Frame::default();
    Ok((Shape::Field(ImplicitShape { field: script.field, region: None, frame, parameters }), warnings))
}

/// Refuses every script: this build has no interpreter.
#[cfg(not(feature = "script"))]
pub(crate) fn shape(
    bytes: &[u8],
    _: &[(String, f64)],
    limits: &Limits,
) -> Result<(Shape, Vec<Warning>), ReadError> {
    chordal_io::read(bytes, chordal_io::Format::Star, limits)
        .map(|loaded| (loaded.content.into(), loaded.warnings))
}
