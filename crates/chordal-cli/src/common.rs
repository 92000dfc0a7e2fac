//! The steps that verbs share: read the input, make the job, say what went wrong.
use crate::args::{InputArgs, OutputArgs, TalkArgs};
use crate::fault::{Exit, Fault};
use crate::input::Source;
use crate::output::Existing;
use crate::signal;
use crate::talk::{Stdout, Talk};
use chordal::Job;
use chordal_io::Limits;
use chordal_verbs::{Hint, Input, MeshFailure, load};

/// Reads what `args` name, tells its warnings, and adds what the user knows of its space.
pub fn read(args: &InputArgs, talk: &Talk) -> Result<Input, Fault> {
    let source = Source::from_arg(&args.input);
    let name = source.name();
    let mut limits = Limits::default();
    limits.bytes = args.max_memory.map_or(limits.bytes, |most| most.min(limits.bytes));
    limits.lenient = args.lenient;
    limits.drop_nonfinite = args.drop_nonfinite;
    limits.index = args.index;
    let bytes = source.read(limits.bytes)?;
    let hint = Hint {
        name: matches!(source, Source::File(_)).then_some(name.as_str()),
        format: args.from,
        set: &args.set,
        region: args.region,
    };
    let mut input =
        load(&bytes, hint, &limits).map_err(|error| Fault::input(error.code, format!("{name}: {error}")))?;
    talk.warn(&name, &input.warnings);
    let frame = input.shape.frame_mut();
    frame.metres_per_unit = args.unit.map(|unit| unit.metres()).or(frame.metres_per_unit);
    frame.up = args.up.or(frame.up);
    Ok(input)
}

/// A job that obeys the command line and signals.
pub fn job(input: &InputArgs, output: Option<&OutputArgs>, talk: &Talk) -> Job {
    let mut job = Job::default().with_threads(output.map_or(0, |args| args.threads));
    job.memory_limit = input.max_memory.unwrap_or(job.memory_limit);
    signal::install(job.cancel_flag());
    talk.progress(job)
}

/// What `--force` says.
pub fn existing(args: &OutputArgs) -> Existing {
    if args.force { Existing::Replace } else { Existing::Keep }
}

/// Whether a summary can go to stdout.
pub fn stdout(output: &OutputArgs, talk: &TalkArgs) -> Result<Stdout, Fault> {
    match (output.output.as_os_str() == "-", talk.json) {
        (true, true) => Err(Fault::usage("--json and '-o -' both write to stdout: choose one")),
        (true, false) => Ok(Stdout::HoldsData),
        (false, _) => Ok(Stdout::Free),
    }
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
