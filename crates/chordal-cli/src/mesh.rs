//! `chordal mesh`
use crate::args::{MeshArgs, SpacingArg};
use crate::clock::Clock;
use crate::common;
use crate::console::{Console, StdoutUse};
use crate::fault::Fault;
use crate::input::InputSource;
use crate::output::OutputTarget;
use crate::summary;
use chordal::budget::{PixelBudget, Reference};
use chordal_io::Format;
use chordal_verbs::report::{Certificate, Report, RunFacts};
use chordal_verbs::{BudgetSpec, MeshFailure, Shape, Spacing, extension, formats, mesh, refine};
use std::path::Path;

/// Reads, meshes, writes, reports.
pub fn run(args: &MeshArgs) -> Result<(), Fault> {
    let clock = Clock::start();
    let talk = Console::new(&args.console);
    let spec = spec(args)?;
    let to = output_format(&args.output.output, args.to)?;
    let stdout = common::stdout(&args.output, &args.console)?;
    let source = InputSource::from_arg(&args.input.input);
    let job = common::job(&args.input, Some(&args.output), &talk);
    let target = OutputTarget::prepare(&args.output.output, common::existing(&args.output), &source)?;
    let mut input = common::read(&args.input, &talk)?;
    args.volume.apply(&mut input.shape)?;
    if let Some(level) = args.level {
        let made = refine(input, (level, args.normals), to, &job);
        let outcome = made.map_err(|failure| common::fault(&source.name(), &failure, ""))?;
        let bytes = target.write(&mut |out| outcome.write(out))?;
        let run = common::run("mesh", source.name(), &target, bytes);
        return print_summary(outcome.certificate, clock.fill(run, &job), (&talk, stdout));
    }
    if !spec.has_limit() && !matches!(input.shape, Shape::Volume(_)) {
        return Err(Fault::usage(if matches!(input.shape, Shape::Cage(_)) { NO_LEVEL } else { NO_BUDGET }));
    }

    let name = source.name();
    let (outcome, unmet) = match mesh(input, &spec, to, &job) {
        Ok(outcome) => (outcome, None),
        Err(failure) => {
            let fault = common::fault(&name, &failure, &hint(args, &failure));
            match failure {
                MeshFailure::Unmet(best) if args.keep_best => (*best, Some(fault)),
                _ => return Err(fault),
            }
        }
    };
    let bytes = target.write(&mut |out| outcome.write(out))?;

    let run = common::run("mesh", name, &target, bytes);
    print_summary(outcome.certificate, clock.fill(run, &job), (&talk, stdout))?;
    unmet.map_or(Ok(()), |fault| Err(Fault { reported: true, ..fault }))
}

/// What would help where the budget was not met.
fn hint(args: &MeshArgs, failure: &MeshFailure) -> String {
    let MeshFailure::Unmet(best) = failure else { return String::new() };
    let mut hints: Vec<&str> = Vec::new();
    if !args.keep_best {
        hints.push("--keep-best writes it");
    }
    let is_field = best.bound.reference == Reference::Field;
    if is_field && best.bound.at_most().is_none() && args.require.is_none() {
        hints.push("--require measured asks for no proof");
    }
    hints.iter().map(|hint| format!("; {hint}")).collect()
}

/// Tells what was made.
fn print_summary(
    certificate: Certificate,
    run: RunFacts,
    (talk, stdout): (&Console, StdoutUse),
) -> Result<(), Fault> {
    let report = Report::new(certificate, RunFacts { verb: "mesh", ..run });
    report.certificate.notes.iter().for_each(|note| talk.detail(note));
    talk.result(&report.to_value(), &summary::mesh(&report), stdout)
}

/// What is said where nothing limits what may be lost. Volumes alone have a resolution of their own.
const NO_BUDGET: &str = "the following required arguments were not provided: \
    <--tol <LENGTH>|--px <PIXELS>|--triangles <N>|--segments <N>> (see --help)";

/// The same for a cage, whose polygons need none.
const NO_LEVEL: &str = "a cage becomes triangles within a budget (--tol, --px or --triangles), or polygons with --level N \
    (see --help)";

/// The budget, as far as it makes sense before the shape is known.
fn spec(args: &MeshArgs) -> Result<BudgetSpec, Fault> {
    let pixels = match (args.px, args.view) {
        (Some(pixels), Some(view)) => Some(PixelBudget { pixels, view }),
        (None, None) => None,
        (Some(_), None) => {
            return Err(Fault::usage("--px needs to know from where: --view \"1920x1080 fov=45 dist=4\""));
        }
        (None, Some(_)) => {
            return Err(Fault::usage("--view is for a budget in pixels: add --px, as in --px 1"));
        }
    };
    let spacing = match args.spacing {
        SpacingArg::Fewest => Spacing::Fewest,
        SpacingArg::Even => Spacing::Even,
    };
    Ok(BudgetSpec {
        length: args.tol,
        pixels,
        angle_deg: args.angle,
        triangles: args.triangles,
        segments: args.segments,
        spacing,
        normals: args.normals,
        require: args.require,
    })
}

/// The format to write: `--to`, else what the name says.
pub fn output_format(path: &Path, to: Option<Format>) -> Result<Format, Fault> {
    let name = path.display().to_string();
    let by_name = || extension(&name).and_then(Format::from_extension);
    let known = formats::output_names;
    let format = to.or_else(by_name).ok_or_else(|| {
        Fault::usage(format!("{name}: the name does not say the format; --to does, with {}", known()))
    })?;
    if formats::holds_triangles(format) || formats::holds_polylines(format) {
        return Ok(format);
    }
    Err(Fault::usage(format!("{format} is only read; what can be written is {}", known())))
}
