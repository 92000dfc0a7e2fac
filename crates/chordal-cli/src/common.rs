//! The steps that verbs share: read the input, make the job, say what went wrong.
use crate::args::{InputArgs, OutputArgs};
use crate::fault::{Exit, Fault};
use crate::input::Source;
use crate::output::Existing;
use crate::signal;
use crate::talk::Talk;
use chordal::Job;
use chordal::budget::{Code, Refusal};
use chordal_io::Limits;
use chordal_verbs::{Hint, Input, load};

/// Reads what `args` name, tells its warnings, and adds what the user knows of its space.
pub fn read(args: &InputArgs, talk: &Talk) -> Result<Input, Fault> {
    let source = Source::from_arg(&args.input);
    let name = source.name();
    let mut limits = Limits::default();
    limits.bytes = args.max_memory.map_or(limits.bytes, |most| most.min(limits.bytes));
    let bytes = source.read(limits.bytes)?;
    let hint = Hint { name: matches!(source, Source::File(_)).then_some(name.as_str()), format: args.from };
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

/// The fault of work that was refused.
pub fn refused(name: &str, refusal: &Refusal) -> Fault {
    let exit = match refusal.code {
        Code::NotFinite | Code::Empty | Code::Unsupported => Exit::Input,
        _ => Exit::Budget,
    };
    Fault::new(exit, refusal.code.as_str(), format!("{name}: {}", refusal.message))
}
