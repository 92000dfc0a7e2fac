//! `chordal mesh`
use crate::args::{AttributeArgs, ConsoleArgs, InputArgs, OutputArgs, angle, length};
use crate::boolean::BooleanArgs;
use crate::clock::Clock;
use crate::console::{Console, StdoutUse};
use crate::deadline::Deadline;
use crate::execution;
use crate::fault::Fault;
use crate::input::InputSource;
use crate::load;
use crate::output::OutputTarget;
use crate::output_format::output_format;
use crate::output_set::OutputSetArgs;
use crate::output_set_write::SetPlace;
use crate::overwrite::OverwritePolicy;
use crate::run_outcome;
use crate::spelling::CommandLine;
use crate::summary;
use crate::volume::VolumeArgs;
use chordal::Job;
use chordal::budget::advice::Spell;
use chordal::budget::proof::ProofEffort;
use chordal::budget::{Bound, Length, PixelBudget, Pixels, Reference, RequiredEvidence, View};
use chordal_io::Format;
use chordal_verbs::report::{Certificate, Report, RunFacts};
use chordal_verbs::{
    BudgetSpec, Effort, MeshFailure, Normals, Shape, Spacing, mesh, mesh_boolean, needs_budget, parse_time,
    refine, time_limit,
};
use clap::{ArgGroup, Args, ValueEnum};
use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

/// `chordal mesh`
#[derive(Args, Debug)]
#[command(group = ArgGroup::new("budget").args(["tol", "px", "triangles", "segments"]).multiple(true))]
#[command(after_help = "\
Examples:
  chordal mesh teapot.bpt --tol 0.001 -o teapot.obj
  chordal mesh teapot.bpt --px 1 --view \"1920x1080 fov=45 dist=4\" -o teapot.glb
  chordal mesh teapot.bpt --triangles 5000 -o teapot.stl
  chordal mesh painted.glb --tol 0.5% -o painted.gltf --separate
  chordal mesh drawing.svg --tol 0.25 -o drawing.json
  chordal mesh drawing.svg --tol 0.25 -o drawing.glb
  chordal mesh drawing.svg --extrude 2 --tol 0.25 -o drawing.stl
  chordal mesh font.ttf --text Word --em 10 --extrude 2 --tol 0.01 -o word.stl
  chordal mesh font.ttf --text Word --em 10 --extrude 2 --bevel 0.1 --tol 0.01 -o word.stl
  chordal mesh brain.nii.gz --iso 60 -o brain.glb
  chordal mesh liver_mask.nii.gz --smooth 0.8vox --tol 3mm -o liver.glb
  chordal mesh organs.nii.gz --labels all --tol 2mm -o organs.glb
  chordal mesh cage.obj --level 2 -o refined.obj
  chordal mesh part.stl --minus hole.stl --union rib.glb -o whole.stl
  chordal mesh part.star --tol 0.1% -o part.stl --watch")]
pub struct MeshArgs {
    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub set: OutputSetArgs,

    #[command(flatten)]
    pub budget: BudgetArgs,

    #[command(flatten)]
    pub boolean: BooleanArgs,

    #[command(flatten)]
    pub result: ResultArgs,

    #[command(flatten)]
    pub volume: VolumeArgs,

    /// Mesh again whenever the input changes, or a file that it uses: a script's draft first and then its
    /// proved mesh, unless --require says which. Ctrl-C stops
    #[arg(long)]
    pub watch: bool,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// What may be lost.
#[derive(Args, Debug)]
#[command(next_help_heading = "Budget")]
pub struct BudgetArgs {
    /// Maximum distance to the true shape: 0.1, 0.1mm, or 0.05% of the diagonal of its bounding box
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    pub tol: Option<Length>,

    /// Maximum distance on the screen of --view, in device pixels
    #[arg(long, value_name = "PIXELS", allow_hyphen_values = true)]
    pub px: Option<Pixels>,

    /// The camera that --px is for: "1920x1080 fov=45 dist=4" for any direction, at least 4 units from the
    /// bounding box; "1920x1080 fov=45 eye=1,2,3 target=0,0,0" for one position; height=LENGTH instead of fov
    /// for an orthographic camera
    #[arg(long, value_name = "VIEW")]
    pub view: Option<View>,

    /// For smooth surfaces, with another limit: maximum angle between the normals of the triangles and those
    /// of the shape, e.g. 5deg
    #[arg(long, value_name = "ANGLE", value_parser = angle, requires = "budget", allow_hyphen_values = true)]
    pub angle: Option<f64>,

    #[command(flatten)]
    pub attributes: AttributeArgs,

    /// Maximum number of triangles: the best mesh with at most N
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub triangles: Option<u64>,

    /// For curves to polylines (.svg, .json): maximum number of segments in total
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub segments: Option<u64>,

    /// Evidence required for a field: proved (exit code 5 if it is not), measured (faster, by sampling), or
    /// estimated (an instant draft, without a bound). By default the proof may take about as long as the
    /// mesh, and what it leaves open is measured. Other shapes are always proved
    #[arg(long, value_name = "EVIDENCE")]
    pub require: Option<RequiredEvidence>,

    /// Write the best result even if the budget is not met, as always for fields; the exit code is still 5
    #[arg(long)]
    pub keep_best: bool,
}

/// What is made.
#[derive(Args, Debug)]
#[command(next_help_heading = "Result")]
pub struct ResultArgs {
    /// Output format, if not the one that the file name implies
    #[arg(long, value_name = "FORMAT")]
    pub to: Option<Format>,

    /// For curves: the fewest segments within the budget, or equal steps of each piece's parameter
    #[arg(long, value_name = "HOW", default_value = "fewest")]
    pub spacing: SpacingArg,

    /// For a field: best takes its proof to the end, however long that is. For a mesh or a volume with
    /// --triangles alone: best, the default, has the least error; fast takes about a tenth of the time for
    /// two to three times the error
    #[arg(long, value_name = "HOW")]
    pub effort: Option<EffortArg>,

    /// For a field: write the best result after this time, e.g. 20s or 2m. Default: 60s, or no limit with
    /// --require proved or --effort best
    #[arg(long, value_name = "TIME", value_parser = parse_time)]
    pub within: Option<Duration>,

    /// Normals of triangles: those of the shape or, for .obj, .glb, .gltf, .usda and .usdz, crease=30deg if
    /// it has none and is not from a .glb or .gltf (auto); keep (none are added); flat; smooth; crease=ANGLE
    /// (smooth up to that angle); groups (the smoothing groups of an .obj)
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub normals: Normals,

    /// For a drawing or letters: extrude to solids of this height, which stand on z = 0; 2, 2mm, or 10% of
    /// the diagonal of the bounding box
    #[arg(long, value_name = "LENGTH", value_parser = length, conflicts_with = "level", allow_hyphen_values = true)]
    pub extrude: Option<Length>,

    /// With --extrude: bevel the edges of both ends at 45°, this wide and less than half the height; if a
    /// stroke is narrower than two bevels, they meet in a ridge
    #[arg(long, value_name = "LENGTH", value_parser = length, requires = "extrude", allow_hyphen_values = true)]
    pub bevel: Option<Length>,

    /// For a polygon cage (.obj): write its polygons after N rounds of subdivision instead of its smooth
    /// surface; 0 keeps them
    #[arg(long, value_name = "N", conflicts_with = "budget")]
    pub level: Option<u32>,
}

/// How the ends of segments are placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SpacingArg {
    /// As few segments as possible, or nearly
    Fewest,
    /// Equal steps of the parameter
    Even,
}

/// How much work a count of triangles is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EffortArg {
    /// The best result, however long it takes
    Best,
    /// A good result in a fraction of the time
    Fast,
}

/// How the work is done, this time.
pub struct MeshRound<'a> {
    /// The conditions.
    pub job: &'a Job,
    /// What happens to a file that has the output's name.
    pub existing: OverwritePolicy,
    /// The evidence that is asked for.
    pub require: Option<RequiredEvidence>,
    /// Told where the files stand that were read beside the input.
    pub on_files: &'a dyn Fn(Vec<PathBuf>),
}

/// Reads, meshes, writes, reports.
pub fn run(args: &MeshArgs) -> Result<(), Fault> {
    let job = job(args);
    let existing = execution::existing(&args.output);
    run_once(args, &MeshRound { job: &job, existing, require: args.budget.require, on_files: &|_| () })
}

/// The job that the command line asks for.
pub fn job(args: &MeshArgs) -> Job {
    let mut job = execution::job(&args.input, Some(&args.output), &Console::new(&args.console));
    if args.result.effort == Some(EffortArg::Best) {
        job.proof_effort = ProofEffort::Full;
    }
    job
}

/// The same as one of several times.
pub fn run_once(args: &MeshArgs, round: &MeshRound) -> Result<(), Fault> {
    let clock = Clock::start();
    let console = Console::new(&args.console);
    let spec = BudgetSpec { require: round.require, ..spec(args)? };
    let to = output_format(&args.output.output, args.result.to)?;
    let stdout = execution::stdout(&args.output, &args.console)?;
    let source = InputSource::from_arg(&args.input.input);
    let job = round.job;
    let target = OutputTarget::prepare(&args.output.output, round.existing, &source)?;
    args.boolean.refuse_output(&args.output.output)?;
    args.set.check(&target, to)?;
    let place = |names_files: bool| SetPlace {
        target: &target,
        input: &args.input.input,
        console: &console,
        names_files,
    };
    let mut input = load::read(&args.input, job, &console)?;
    load::refuse_files(&args.output.output, &args.input, &input)?;
    (round.on_files)(load::files_beside(&args.input, &input).collect());
    args.volume.apply(&mut input.shape)?;
    let input_triangles = input.shape.n_triangles();
    if let Some(level) = args.result.level {
        let made = refine(input, (level, args.result.normals), args.set.form(to), job).spelled(&CommandLine);
        let outcome = made.map_err(|failure| run_outcome::fault(&source.name(), &failure, ""))?;
        let one = &mut |out: &mut dyn Write| outcome.write(out);
        let place = place(outcome.names_files());
        let bytes = args.set.write(&place, &outcome.certificate, one, |stem| outcome.write_files(stem))?;
        let run = run_outcome::facts("mesh", source.name(), target.name(), bytes);
        return print_summary(outcome.certificate, clock.fill(run, job), &console, stdout);
    }
    let others = args.boolean.read(&args.input, job, &console)?;
    (round.on_files)(args.boolean.files_beside(&args.input, &others));
    if others.is_empty() && !spec.has_limit() && needs_budget(&input.shape, args.result.normals) {
        return Err(Fault::usage(if matches!(input.shape, Shape::Cage(_)) { NO_LEVEL } else { NO_BUDGET }));
    }

    let name = source.name();
    let form = args.set.form(to);
    if !others.is_empty() && args.result.extrude.is_some() {
        return Err(Fault::usage("--extrude makes a solid of its own: write it, and combine the file"));
    }
    let limit = time_limit(&input.shape, args.result.within, round.require, job.proof_effort);
    let deadline = limit.map(|within| Deadline::start(job, within, Some(console)));
    let made = if others.is_empty() {
        mesh(input, &spec, form, job)
    } else {
        mesh_boolean(input, others, &spec, form, job)
    };
    drop(deadline);
    let (outcome, unmet) = match made.spelled(&CommandLine) {
        Ok(outcome) => (outcome, None),
        Err(failure) => {
            let fault = run_outcome::fault(&name, &failure, &hint(args, &failure));
            match failure {
                MeshFailure::Unmet(best) if args.budget.keep_best || is_field(&best.bound) => {
                    (*best, Some(fault))
                }
                _ => return Err(fault),
            }
        }
    };
    let one = &mut |out: &mut dyn Write| outcome.write(out);
    let place = place(outcome.names_files());
    let bytes = args.set.write(&place, &outcome.certificate, one, |stem| outcome.write_files(stem))?;

    let run = RunFacts { input_triangles, ..run_outcome::facts("mesh", name, target.name(), bytes) };
    print_summary(outcome.certificate, clock.fill(run, job), &console, stdout)?;
    unmet.map_or(Ok(()), |fault| Err(Fault { reported: true, ..fault }))
}

/// Of parts as code the best is always written: there is no other.
fn is_field(bound: &Bound) -> bool {
    bound.reference == Reference::Field
}

/// What would help where the budget was not met.
fn hint(args: &MeshArgs, failure: &MeshFailure) -> String {
    let MeshFailure::Unmet(best) = failure else { return String::new() };
    let mut hints: Vec<&str> = Vec::new();
    if is_field(&best.bound) {
        hints.push("it is written all the same");
        let wants_proof = args.budget.require == Some(RequiredEvidence::Proved);
        // Of a proof that was tried it is known where it did not end.
        let was_tried = best.bound.open.is_some() || best.bound.evidence().bounds_above();
        if args.budget.require.is_none() && !was_tried {
            hints.push(
                "memory for its cells, or the time, ran out before a proof: --within 5m gives it longer, --max-memory more \
                 cells",
            );
        } else if wants_proof || args.budget.require.is_none() {
            hints.push("--require measured asks for no proof");
        }
    } else if !args.budget.keep_best {
        hints.push("--keep-best writes it");
    }
    let smoothed = best.certificate.smoothed.as_ref();
    let fits = smoothed
        .and_then(|facts| facts.fits.as_ref())
        .map(|fits| format!("--smooth {fits} alone is within it"));
    hints.extend(fits.as_deref());
    hints.iter().map(|hint| format!("; {hint}")).collect()
}

/// Tells what was made.
fn print_summary(
    certificate: Certificate,
    run: RunFacts,
    console: &Console,
    stdout: StdoutUse,
) -> Result<(), Fault> {
    let report = Report::new(certificate, RunFacts { verb: "mesh", ..run });
    report.certificate.notes.iter().for_each(|note| console.detail(note));
    console.result(&report, &summary::mesh(&report), stdout)
}

/// What is said where nothing limits what may be lost. Volumes alone have a resolution of their own.
const NO_BUDGET: &str = "the following required arguments were not provided: \
    <--tol <LENGTH>|--px <PIXELS>|--triangles <N>|--segments <N>> (see --help)";

/// The same for a cage, whose polygons need none.
const NO_LEVEL: &str = "a cage becomes triangles within a budget (--tol, --px or --triangles), or polygons with --level N \
    (see --help)";

/// The budget, as far as it makes sense before the shape is known.
fn spec(args: &MeshArgs) -> Result<BudgetSpec, Fault> {
    let pixels = match (args.budget.px, args.budget.view) {
        (Some(pixels), Some(view)) => Some(PixelBudget { pixels, view }),
        (None, None) => None,
        (Some(_), None) => {
            return Err(Fault::usage("--px needs to know from where: --view \"1920x1080 fov=45 dist=4\""));
        }
        (None, Some(_)) => {
            return Err(Fault::usage("--view is for a budget in pixels: add --px, as in --px 1"));
        }
    };
    let spacing = match args.result.spacing {
        SpacingArg::Fewest => Spacing::Fewest,
        SpacingArg::Even => Spacing::Even,
    };
    let effort = match args.result.effort {
        Some(EffortArg::Best) | None => Effort::Best,
        Some(EffortArg::Fast) => Effort::Fast,
    };
    Ok(BudgetSpec {
        length: args.budget.tol,
        pixels,
        angle_deg: args.budget.angle,
        attributes: args.budget.attributes.limits(),
        triangles: args.budget.triangles,
        segments: args.budget.segments,
        spacing,
        effort,
        extrude: args.result.extrude,
        bevel: args.result.bevel,
        normals: args.result.normals,
        require: args.budget.require,
    })
}
