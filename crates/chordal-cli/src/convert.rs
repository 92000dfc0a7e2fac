//! `chordal convert`
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::carried;
use crate::fault::Fault;
use crate::inspect_text::quoted;
use crate::load;
use crate::options::TableArgs;
use crate::output_format::writable_format;
use crate::output_set::OutputSetArgs;
use crate::spelling::CommandLine;
use crate::summary::{self, SummaryLines};
use crate::verb_run::{RunArgs, VerbRun};
use chordal::budget::advice::Spell;
use chordal_verbs::options::ConvertOptions;
use chordal_verbs::report::Report;
use chordal_verbs::{
    MeshFailure, Shape, convert_certified, convert_within, extension, field_shader, needs_mesh,
    polygons_lose_no_more,
};
use clap::Args;
use std::path::{Path, PathBuf};

/// `chordal convert`
#[derive(Args, Debug)]
#[command(after_help = "\
Nothing is simplified, merged or repaired. The bound is the rounding of the format; data that the format cannot hold is
listed. To turn smooth shapes into triangles, use `mesh`, which takes a budget.

Examples:
  chordal convert part.stl part.3mf --unit mm
  chordal convert scene.gltf scene.glb
  chordal convert quads.obj quads.ply
  chordal convert drawing.json drawing.svg --tol 0.01
  chordal convert samples.npy samples.nrrd
  chordal convert part.glb part.star
  chordal convert part.glb part.3mf --keep-certificate
  chordal convert block.star block.glsl
  chordal convert part.obj -o - --to stl > part.stl")]
pub struct ConvertArgs {
    /// Output file; '-' writes to stdout. -o works as well
    #[arg(value_name = "OUT", index = 2, required_unless_present = "output_option")]
    pub output: Option<PathBuf>,

    /// Output file, as for the other verbs
    #[arg(
        short = 'o',
        long = "output",
        value_name = "OUT",
        conflicts_with = "output",
        help_heading = "Output"
    )]
    pub output_option: Option<PathBuf>,

    #[command(flatten)]
    pub options: TableArgs<ConvertOptions>,

    /// Overwrite the output if it exists
    #[arg(long, help_heading = "Output")]
    pub force: bool,

    /// Number of threads; 0 uses all. The result does not depend on it
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Output")]
    pub threads: usize,

    #[command(flatten)]
    pub set: OutputSetArgs,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// Reads, converts, writes, reports.
pub fn run(args: &ConvertArgs) -> Result<(), Fault> {
    // clap requires one of the two.
    let output = args.output.as_ref().or(args.output_option.as_ref());
    let output = output.ok_or_else(|| Fault::usage("no output was given: name a file"))?;
    let output_args = OutputArgs { output: output.clone(), force: args.force, threads: args.threads };
    let run_args = RunArgs { input: &args.input, output: &output_args, console: &args.console };
    // Texts that are no format of a shape: they cannot be asked for by --to, or read back as what was written.
    let ending = extension(&output.to_string_lossy()).unwrap_or_default().to_ascii_lowercase();
    match &*ending {
        "glsl" if args.options.to.is_none() => {
            return run_shader(args, output, VerbRun::start("convert", run_args)?);
        }
        "star" if args.options.to.is_none() => {
            return carried::write_script(VerbRun::start("convert", run_args)?);
        }
        _ => {}
    }
    let to = writable_format(output, args.options.to)?;
    let mut run = VerbRun::start("convert", run_args)?;
    let target = run.target()?;
    let form = args.set.form_for(&target, to)?;
    let prefers = |polygons: &_, triangles: &_| polygons_lose_no_more(polygons, triangles, to);
    let input = run.read_by(|input, job, console| load::read_polygons(input, job, console, prefers))?;
    run.refuse_files(&input)?;
    let name = run.name();
    if needs_mesh(&input.shape, to) {
        return Err(Fault::usage(mesh_advice(&input.shape, &name, output)));
    }
    let is_drawing = matches!(input.shape, Shape::Drawing(_));
    if args.options.length.is_some() && !(is_drawing && to.holds_cubics()) {
        return Err(Fault::usage("--tol is for drawings written as svg: other shapes are converted exactly"));
    }
    let hint = if args.options.length.is_none() && is_drawing { "; --tol 0.1% allows one" } else { "" };
    let converted = if args.options.keeps_certificate {
        convert_certified(input, form, &run.job)
    } else {
        convert_within(input, form, args.options.length, &run.job)
    };
    let mut outcome = match converted {
        Err(MeshFailure::Usage(why)) => {
            let why = why.spelled(&CommandLine);
            return Err(Fault::usage(format!("{name}: {why}{hint}")));
        }
        converted => run.made(converted)?,
    };
    args.set.strip(&mut outcome.certificate);
    let place = run.place(&target, outcome.names_files());
    let write_set = |stem: &str| outcome.write_files(stem);
    let bytes = args.set.write(&place, &outcome.certificate, &mut |out| outcome.write(out), write_set)?;
    run.report(outcome.certificate, (target.name(), bytes), summary_text)
}

/// Writes a field as functions for a graphics processor, named after the file.
fn run_shader(args: &ConvertArgs, output: &Path, mut run: VerbRun<'_>) -> Result<(), Fault> {
    if args.options.length.is_some() {
        return Err(Fault::usage("--tol is for drawings written as svg: a field is written as it is"));
    }
    let target = run.target()?;
    let input = run.read()?;
    let name = output.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let outcome = run.made(field_shader(&input, &name))?;
    let source = outcome.shader.source;
    let bytes = target.write(&mut |out| Ok(out.write_all(source.as_bytes())?))?;
    run.report(outcome.certificate, (target.name(), bytes), summary_text)
}

/// The command that turns the shape into one that the format can hold.
fn mesh_advice(shape: &Shape, input: &str, output: &Path) -> String {
    let output = quoted(&output.display().to_string());
    let command = format!("chordal mesh {} -o {output}", quoted(input));
    match shape {
        Shape::Volume(_) => {
            format!("{input}: to turn a volume into the triangles of an isosurface: {command}")
        }
        Shape::Cage(_) => format!(
            "{input}: this format holds no polygons: {command} --tol 0.1% makes triangles of the smooth surface; \
            --level 0 instead of --tol makes triangles of the polygons"
        ),
        Shape::Drawing(_) | Shape::Curves(_) => {
            format!("{input}: curves become polylines or triangles within a budget: {command} --tol 0.1%")
        }
        _ => format!("{input}: {} become triangles within a budget: {command} --tol 0.1%", kind(shape)),
    }
}

fn kind(shape: &Shape) -> &'static str {
    if matches!(shape, Shape::Field(_)) { "fields" } else { shape.kind() }
}

/// The summary: the output, its bound, and notes on data that the format cannot hold.
fn summary_text(report: &Report) -> String {
    let (certificate, run) = (&report.certificate, &report.run);
    let mut lines = SummaryLines::of_run(run);
    if let Some(output) = &certificate.output {
        summary::add_output(&mut lines, output);
    }
    lines.add_if("bound", certificate.bound.as_ref().map(summary::bound));
    certificate.notes.iter().for_each(|note| lines.add("note", &**note));
    lines.finish_run(run)
}
