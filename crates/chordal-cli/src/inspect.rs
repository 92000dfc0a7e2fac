//! `chordal inspect`
use crate::args::{ConsoleArgs, InputArgs};
use crate::clock::Clock;
use crate::console::{Console, StdoutUse};
use crate::execution;
use crate::fault::{Exit, Fault};
use crate::input::InputSource;
use crate::inspect_text;
use crate::line_costs::line_costs;
use crate::load;
use crate::options::TableArgs;
use crate::require::{Requirement, failures};
use crate::spelling::CommandLine;
use crate::volume::VolumeArgs;
use chordal::Job;
use chordal::budget::advice::{Message, Spell};
use chordal::budget::{JobError, Length};
use chordal_io::font::{fonts_in, letters_in};
use chordal_verbs::options::InspectOptions;
use chordal_verbs::options::values::length;
use chordal_verbs::report::{RunFacts, ValidityFacts};
use chordal_verbs::{Input, Shape, SurfaceDepth, inspect, inspect_deeply, inspect_surface};
use clap::Args;

/// `chordal inspect`
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  chordal inspect part.stl
  chordal inspect part.stl --self-intersections
  chordal inspect part.stl --require solid
  chordal inspect part.star --cost
  chordal inspect brain.nii.gz --iso 60 --require closed")]
pub struct InspectArgs {
    /// Exit with code 1 unless the mesh has all of these properties
    #[arg(long, value_name = "WHAT", value_delimiter = ',')]
    pub require: Vec<Requirement>,

    #[command(flatten)]
    pub options: TableArgs<InspectOptions>,

    /// For a shape script: mesh the last shape of each line by itself within this length (default: 0.1% of
    /// the whole shape), and list triangles, seconds and bound
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    #[arg(num_args = 0..=1, require_equals = true, default_missing_value = "0.1%")]
    pub cost: Option<Length>,

    #[command(flatten)]
    pub volume: VolumeArgs,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// Reads, inspects, reports, and checks the requirements.
pub fn run(args: &InspectArgs) -> Result<(), Fault> {
    let clock = Clock::start();
    let console = Console::new(&args.console);
    let job = execution::job(&args.input, 0, &console);
    let (mut input, choices) = match load::read(&args.input, &job, &console) {
        Err(fault) if matches!(fault.code, "several-volumes" | "several-fonts" | "no-text") => {
            read_first(&args.input, fault, &job, &console)?
        }
        read => (read?, Vec::new()),
    };
    args.volume.apply(&mut input.shape)?;
    let source = InputSource::from_arg(&args.input.input);
    let name = source.name();
    let argument = match source {
        InputSource::Stdin => "-".to_owned(),
        InputSource::File(_) => name.clone(),
    };
    let deep =
        args.options.self_intersections || args.require.iter().any(|required| required.needs_deep_check());
    // Without any option for a surface, only the samples of a volume are inspected.
    let is_volume = matches!(input.shape, Shape::Volume(_));
    let has_surface = args.volume.named().is_some() || deep || !args.require.is_empty();
    let mut report = if is_volume && has_surface {
        let depth = if deep { SurfaceDepth::Deep } else { SurfaceDepth::Counts };
        inspect_surface(&input, depth, &job)
            .spelled(&CommandLine)
            .map_err(|failure| Fault::from_failure(&name, &failure))?
    } else if deep {
        inspect_deeply(&input, &job).spelled(&CommandLine).map_err(|stopped| fault(&name, &stopped))?
    } else {
        inspect(&input).spelled(&CommandLine)
    };
    choices.iter().for_each(|choice| console.say(&format!("{name}: {choice}")));
    report.certificate.notes.extend(choices.into_iter().map(Message::from));
    let input_triangles = input.shape.n_triangles();
    let lines = args.cost.map(|within| line_costs(&input, within, &job)).transpose()?;
    let run = RunFacts { input: Some(name.clone()), input_triangles, lines, ..report.run };
    report.run = clock.fill(run, &job);
    console.result(&report, &inspect_text::inspect(&report, &argument), StdoutUse::Free)?;
    check(&name, report.certificate.valid.as_ref(), &args.require)
}

/// Reads the first volume or font of a file that holds several. The sample text of a font is its name, or
/// some of its letters if it lacks letters of the name. Returns the input and sentences that list the
/// alternatives.
fn read_first(
    args: &InputArgs,
    fault: Fault,
    job: &Job,
    console: &Console,
) -> Result<(Input, Vec<String>), Fault> {
    let mut first = args.clone();
    first.read.index = args.read.index.or(Some(0));
    let mut choices = Vec::new();
    if fault.code == "several-volumes" {
        let line = fault.lines.first().cloned().unwrap_or_default();
        let name = InputSource::from_arg(&args.input).name();
        choices.push(line.strip_prefix(&format!("{name}: ")).unwrap_or(&line).to_owned());
        choices.push("this is the first".to_owned());
        // If the first one cannot be read either, the error that lists all of them is the better one.
        return load::read(&first, job, console).map(|input| (input, choices)).map_err(|_| fault);
    }
    let limits = load::limits(&first);
    let bytes = InputSource::from_arg(&args.input).read(limits.bytes)?;
    let Ok(fonts) = fonts_in(&bytes, &limits) else { return Err(fault) };
    let font =
        first.read.index.and_then(|index| usize::try_from(index).ok()).and_then(|index| fonts.get(index));
    let Some(name) = font.and_then(|font| font.split(", ").next()) else { return Err(fault) };
    choices.extend(fonts.iter().enumerate().map(|(i, font)| format!("font {i}: {font}")));
    let letters = letters_in(&bytes, &limits).unwrap_or_default();
    let texts = [
        (name.to_owned(), "the text is the font's name; --text sets another text".to_owned()),
        (
            letters.clone(),
            format!("the font lacks letters of its name, so the text is {letters}; --text sets another text"),
        ),
    ];
    for (text, sentence) in texts.into_iter().filter(|(text, _)| !text.is_empty()) {
        first.read.text = Some(text);
        if let Ok(input) = load::read(&first, job, console) {
            choices.push(sentence);
            return Ok((input, choices));
        }
    }
    // No text can be set: the list of fonts is all there is to show.
    Err(Fault { lines: fault.lines.into_iter().chain(choices).collect(), ..fault })
}

fn fault(name: &str, stopped: &JobError) -> Fault {
    match stopped {
        JobError::Cancelled => Fault::interrupted(),
        JobError::Refused(refusal) => {
            Fault::new(Exit::Budget, refusal.code.as_str(), format!("{name}: {}", refusal.message))
        }
    }
}

fn check(name: &str, valid: Option<&ValidityFacts>, required: &[Requirement]) -> Result<(), Fault> {
    let failed = |line: String| Fault::new(Exit::CheckFailed, "not-valid", line);
    let Some(valid) = valid else {
        return match required {
            [] => Ok(()),
            _ => Err(Fault {
                reported: true,
                ..failed(format!("{name}: there are no triangles to check: mesh the shape first"))
            }),
        };
    };
    let complaints = failures(valid, required);
    if complaints.is_empty() {
        return Ok(());
    }
    let lines = complaints.iter().map(|complaint| format!("{name}: {complaint}")).collect();
    Err(Fault { lines, reported: true, ..failed(String::new()) })
}
