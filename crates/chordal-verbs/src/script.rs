//! Shape scripts as an input, in builds with the interpreter.
use crate::InputFile;
use crate::Shape;
use chordal::Job;
use chordal_io::{FileOpener, Limits, ReadError, Warning};

/// A script's shape, the files that it named, and its warnings, each code of the script's own once.
pub(crate) struct LoadedScript {
    pub shape: Shape,
    pub files: Vec<InputFile>,
    pub warnings: Vec<Warning>,
}

/// What a script is run with.
pub(crate) struct ScriptContext<'a, 'b> {
    /// Its parameters.
    pub set: &'a [(String, f64)],
    pub open: Option<&'a mut FileOpener<'b>>,
    pub limits: &'a Limits,
    pub job: &'a Job,
}

/// Runs a script to its shape.
#[cfg(feature = "script")]
pub(crate) fn shape(bytes: &[u8], context: ScriptContext<'_, '_>) -> Result<LoadedScript, ReadError> {
    use crate::script_files::MeshFiles;
    use crate::{ImplicitShape, Parameter};
    use chordal_io::FileLocation;
    use chordal_script::{RunOptions, run_with_files};

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
    let files = MeshFiles::new(open, limits);
    let script = run_with_files(text, &options, &files, job).map_err(|error| {
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
    let read = files.into_read();
    warnings.extend(read.warnings);
    let frame = read.frame.unwrap_or_default();
    let shape = Shape::Field(ImplicitShape { field: script.field, region: None, frame, parameters });
    Ok(LoadedScript { shape, files: read.files, warnings })
}

/// Refuses every script: this build has no interpreter.
#[cfg(not(feature = "script"))]
pub(crate) fn shape(bytes: &[u8], context: ScriptContext<'_, '_>) -> Result<LoadedScript, ReadError> {
    let loaded = chordal_io::read(bytes, chordal_io::Format::Star, context.limits)?;
    Ok(LoadedScript { shape: loaded.content.into(), files: Vec::new(), warnings: loaded.warnings })
}
