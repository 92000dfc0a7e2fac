//! `chordal mesh`
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::boolean::BooleanArgs;
use crate::deadline::Deadline;
use crate::fault::Fault;
use crate::load;
use crate::options::TableArgs;
use crate::output_format::output_format;
use crate::output_set::OutputSetArgs;
use crate::overwrite::OverwritePolicy;
use crate::spelling::CommandLine;
use crate::summary;
use crate::verb_run::{RunArgs, VerbRun};
use crate::volume::VolumeArgs;
use chordal::Job;
use chordal::budget::advice::Spell;
use chordal::budget::{Bound, Reference, RequiredEvidence};
use chordal_verbs::options::MeshOptions;
use chordal_verbs::report::VerbFacts;
use chordal_verbs::{BudgetSpec, MeshFailure, Shape, mesh, mesh_boolean, needs_budget, refine, time_limit};
use clap::Args;
use std::path::PathBuf;

/// `chordal mesh`
#[derive(Args, Debug)]
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
    pub options: TableArgs<MeshOptions>,

    #[command(flatten)]
    pub boolean: BooleanArgs,

    #[command(flatten)]
    pub volume: VolumeArgs,

    /// Mesh again whenever the input or a file that it uses changes. For a script, first a draft and then the
    /// proved mesh, unless --require is given. Ctrl-C stops
    #[arg(long)]
    pub watch: bool,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// The settings of one run of `mesh`; `--watch` makes several.
pub struct MeshRound<'a> {
    /// The job.
    pub job: &'a Job,
    /// What happens to an existing output.
    pub existing: OverwritePolicy,
    /// The required evidence.
    pub require: Option<RequiredEvidence>,
    /// Receives the possible paths of the files that the inputs reference.
    pub on_files: &'a dyn Fn(Vec<PathBuf>),
}

/// Reads, meshes, writes, reports.
pub fn run(args: &MeshArgs) -> Result<(), Fault> {
    let (job, existing) = (job(args), args.output.existing());
    run_once(args, &MeshRound { job: &job, existing, require: args.options.require(), on_files: &|_| () })
}

/// The job that the command line asks for.
pub fn job(args: &MeshArgs) -> Job {
    let mut job = run_args(args).job();
    job.proof_effort = args.options.proof();
    job
}

fn run_args(args: &MeshArgs) -> RunArgs<'_> {
    RunArgs { input: &args.input, output: &args.output, console: &args.console }
}

/// Reads, meshes, writes, reports, with the settings of a round.
pub fn run_once(args: &MeshArgs, round: &MeshRound) -> Result<(), Fault> {
    let options = &args.options;
    let spec = options.spec().map_err(|why| Fault::usage(why.spelled(&CommandLine).to_string()))?;
    let spec = BudgetSpec { require: round.require, ..spec };
    let to = output_format(&args.output.output, options.to)?;
    let mut run = VerbRun::with_job("mesh", run_args(args), round.job.clone())?;
    // Outputs are checked before anything is read or computed, and again when they are written.
    let target = run.target_over(round.existing)?;
    args.boolean.refuse_output(&args.output.output)?;
    let form = args.set.form_for(&target, to)?;
    let mut input = run.read()?;
    (round.on_files)(load::files_beside(&args.input, &input).collect());
    args.volume.apply(&mut input.shape)?;
    if let Some(level) = options.level {
        let mut outcome = run.made(refine(input, (level, options.normals()), form, &run.job))?;
        args.set.strip(&mut outcome.certificate);
        let place = run.place(&target, outcome.names_files());
        let write_set = |stem: &str| outcome.write_files(stem);
        let bytes = args.set.write(&place, &outcome.certificate, &mut |out| outcome.write(out), write_set)?;
        run.print_notes(&outcome.certificate);
        return run.report(outcome.certificate, (target.name(), bytes), summary::mesh);
    }
    let operands = args.boolean.read(&args.input, &run.job, &run.console)?;
    (round.on_files)(args.boolean.files_beside(&args.input, &operands));
    if operands.is_empty() && !spec.has_limit() && needs_budget(&input.shape, options.normals()) {
        return Err(Fault::usage(match input.shape {
            Shape::Cage(_) => NO_LEVEL.to_owned(),
            _ => format!("{} (see --help)", MeshOptions::no_limit().spelled(&CommandLine)),
        }));
    }

    if !operands.is_empty() && options.extrudes() {
        return Err(Fault::usage("--extrude makes a new solid: write it to a file first, and combine that"));
    }
    let limit = time_limit(&input.shape, options.within, round.require, run.job.proof_effort);
    let deadline = limit.map(|within| Deadline::start(&run.job, within, Some(run.console)));
    let meshed = if operands.is_empty() {
        mesh(input, &spec, form, &run.job)
    } else {
        mesh_boolean(input, operands, &spec, form, &run.job)
    };
    // The limit is for the work: what is there is written, however long that takes.
    drop(deadline);
    let mut outcome = match meshed {
        Err(failure @ MeshFailure::Unmet(_)) => {
            let failure = failure.spelled(&CommandLine);
            let mut fault = Fault::from_failure(&run.name(), &failure);
            let hint = hint(args, &failure);
            fault.lines.iter_mut().for_each(|line| *line += &hint);
            match failure {
                MeshFailure::Unmet(best) if options.keep_best || is_field(&best.bound) => {
                    run.unmet = Some(fault);
                    *best
                }
                _ => return Err(fault),
            }
        }
        meshed => run.made(meshed)?,
    };
    args.set.strip(&mut outcome.certificate);
    let place = run.place(&target, outcome.names_files());
    let write_set = |stem: &str| outcome.write_files(stem);
    let bytes = args.set.write(&place, &outcome.certificate, &mut |out| outcome.write(out), write_set)?;
    run.print_notes(&outcome.certificate);
    run.report(outcome.certificate, (target.name(), bytes), summary::mesh)
}

/// Whether the shape is a field, whose best mesh is always written.
fn is_field(bound: &Bound) -> bool {
    bound.reference == Reference::Field
}

/// Advice for a budget that was not met.
fn hint(args: &MeshArgs, failure: &MeshFailure) -> String {
    let MeshFailure::Unmet(best) = failure else { return String::new() };
    let options = &args.options;
    let mut hints: Vec<&str> = Vec::new();
    if is_field(&best.bound) {
        hints.push("the result is written nevertheless");
        let wants_proof = options.require() == Some(RequiredEvidence::Proved);
        // A proof that was tried left its open places, or an upper bound.
        let was_tried = best.bound.open.is_some() || best.bound.evidence().bounds_above();
        if options.require().is_none() && !was_tried {
            hints.push(
                "the time, or the memory for its cells, ran out before the proof: --within 5m allows more time, \
                --max-memory more cells",
            );
        } else if wants_proof || options.require().is_none() {
            hints.push("--require measured asks for no proof");
        }
    } else if !options.keep_best {
        hints.push("--keep-best writes it");
    }
    let fits = match &best.certificate.verb {
        VerbFacts::Smoothed { smoothed } => smoothed.fits.as_ref(),
        _ => None,
    };
    let fits = fits.map(|fits| format!("--smooth {fits} alone is within it"));
    hints.extend(fits.as_deref());
    hints.iter().map(|hint| format!("; {hint}")).collect()
}

/// The error for a cage without a budget, which its polygons do not need.
const NO_LEVEL: &str = "a cage becomes triangles within a budget (--tol, --px or --triangles), or polygons with --level N \
    (see --help)";
