//! Shape scripts as an input, in builds with the interpreter.
use crate::Shape;
use chordal::Job;
use chordal_io::{FileOpener, Limits, ReadError, Warning};

/// The conditions under which a script runs.
#[cfg_attr(
    not(feature = "script"),
    expect(dead_code, reason = "builds without the interpreter refuse scripts")
)]
pub(crate) struct ScriptContext<'a, 'b> {
    /// Its parameters.
    pub set: &'a [(String, f64)],
    pub open: Option<&'a mut FileOpener<'b>>,
    pub limits: &'a Limits,
    pub job: &'a Job,
}

/// Runs a script to its shape.
#[cfg(feature = "script")]
pub(crate) fn shape(
    bytes: &[u8],
    context: ScriptContext<'_, '_>,
) -> Result<(Shape, Vec<Warning>), ReadError> {
    use super::script_files::FilesBeside;
    use crate::{ImplicitShape, Parameter, ShapeBody, ShapeLine};
    use chordal_io::FileLocation;
    use chordal_script::{RunOptions, run_with};

    let ScriptContext { set, open, limits, job } = context;
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let place = FileLocation::Byte(error.valid_up_to() as u64);
        ReadError::new("not-utf8", place, "the script is not UTF-8: save it as UTF-8 or plain ASCII")
    })?;
    let mut options = RunOptions { set: set.iter().cloned().collect(), ..RunOptions::default() };
    let most = usize::try_from(limits.bytes).unwrap_or(usize::MAX);
    if most < options.limits.heap {
        options.limits.heap = most;
    }
    let files = FilesBeside::new(open, limits);
    let script = run_with(text, &options, &files, job).map_err(|error| {
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
        if let Some(earlier) = warnings.iter_mut().find(|earlier| earlier.code == warning.code) {
            earlier.count += 1;
            continue;
        }
        let (line, column) = warning.place;
        let place = FileLocation::LineColumn { line, column };
        warnings.push(Warning { code: warning.code, count: 1, place, message: warning.message.into() });
    }
    let read = files.into_read();
    warnings.extend(read.warnings);
    let frame = read.frame.unwrap_or_default();
    for line in script.said {
        // Equal lines are not merged: each is an output of its own.
        warnings.push(Warning {
            code: "script-said",
            count: 1,
            place: FileLocation::File,
            message: line.into(),
        });
    }
    let bodies =
        script.bodies.into_iter().map(|body| ShapeBody { name: body.name, field: body.field }).collect();
    let lines =
        script.steps.into_iter().map(|step| ShapeLine { line: step.line, field: step.field }).collect();
    let field = script.field;
    Ok((Shape::Field(ImplicitShape { field, region: None, frame, parameters, bodies, lines }), warnings))
}

/// Refuses every script: this build has no interpreter.
#[cfg(not(feature = "script"))]
pub(crate) fn shape(
    bytes: &[u8],
    context: ScriptContext<'_, '_>,
) -> Result<(Shape, Vec<Warning>), ReadError> {
    chordal_io::read(bytes, chordal_io::Format::Star, context.limits)
        .map(|loaded| (loaded.content.into(), loaded.warnings))
}
