//! `chordal bake`
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::fault::Fault;
use crate::numbers::{RoundingDirection, grouped, point, short};
use crate::output_format::volume_format;
use crate::summary::{self, SummaryLines};
use crate::verb_run::{RunArgs, VerbRun};
use chordal::budget::Length;
use chordal_io::Format;
use chordal_verbs::options::values::length;
use chordal_verbs::report::{DistanceGridFacts, Report};
use chordal_verbs::{BakeResolution, BakeSpec, bake};
use clap::{ArgGroup, Args};

/// `chordal bake`
#[derive(Args, Debug)]
#[command(after_help = "\
Samples are f64, negative inside. A mesh that is not solid is baked too; a warning says how inside and outside were
decided. Fields, cages, patches and volumes become triangles first, unless a field's own values are distances.

Examples:
  chordal bake part.stl --cells 128 -o part.nrrd
  chordal bake part.stl --cells 512 --band 3 -o part.npy
  chordal bake part.star --tol 0.1% --band 3 --sparse -o part.nrrd
  chordal bake scan.ply --cells 200 -o scan.nrrd && chordal mesh scan.nrrd -o closed.ply")]
#[command(group(ArgGroup::new("resolution").required(true).args(["cells", "tol"])))]
pub struct BakeArgs {
    /// Output format, npy or nrrd, if not the one that the file name implies
    #[arg(long, value_name = "FORMAT")]
    pub to: Option<Format>,

    /// Number of cells along the longest side of the bounding box, without the margin
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub cells: Option<u64>,

    /// As many cells as it takes to prove that the zero surface of the samples' interpolant is within this
    /// length of the shape: 0.01, 0.1mm, or 0.1% of the diagonal of its bounding box
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    pub tol: Option<Length>,

    /// If --tol is not met, write the best result; the exit code is still 5
    #[arg(long, requires = "tol")]
    pub keep_best: bool,

    /// Exact distances only within W cells of the surface; elsewhere the width of this band, with a sign
    #[arg(long, value_name = "W", value_parser = band, allow_hyphen_values = true)]
    pub band: Option<f64>,

    /// Store only the band, in memory and in the file: for grids that would not fit into memory
    #[arg(long, requires = "band")]
    pub sparse: bool,

    /// Prove how far the zero surface of the samples' interpolant is from the shape, so that bounds of later
    /// results include it; --tol always does
    #[arg(long)]
    pub bound: bool,

    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

fn band(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(width) if width > 0.0 && width <= 1e6 => Ok(width),
        _ => Err("a band is a number of cells, above 0 and at most a million".to_owned()),
    }
}

/// Reads, samples, writes, reports.
pub fn run(args: &BakeArgs) -> Result<(), Fault> {
    let to = volume_format(&args.output.output, args.to)?;
    let run_args = RunArgs { input: &args.input, output: &args.output, console: &args.console };
    let mut run = VerbRun::start("bake", run_args)?;
    let target = run.target()?;
    let input = run.read()?;
    let resolution = match (args.cells, args.tol) {
        (Some(cells), None) => BakeResolution::Cells(cells as usize),
        (None, Some(length)) => BakeResolution::Within(length),
        _ => return Err(Fault::usage("give either --cells or --tol, which set the resolution")),
    };
    let spec = BakeSpec { resolution, band: args.band, is_sparse: args.sparse, is_bounded: args.bound };
    let outcome = run.made(bake(input, &spec, to, &run.job))?;
    run.keep_best(outcome.unmet.as_ref(), args.keep_best)?;
    let solidity = outcome.certificate.baked.as_ref().and_then(|facts| facts.solid.as_ref());
    if let Some(solidity) = solidity.filter(|solidity| !solidity.is_solid) {
        run.console.warn(&run.name(), &[&solidity.sentence]);
    }
    let bytes = target.write(&mut |out| outcome.write(out))?;
    run.print_notes(&outcome.certificate);
    run.report(outcome.certificate, (target.name(), bytes), summary_text)
}

fn summary_text(report: &Report) -> String {
    let mut lines = SummaryLines::of_run(&report.run);
    if let Some(facts) = &report.certificate.baked {
        add_grid(&mut lines, facts);
    }
    lines.add_if("surface", report.certificate.bound.as_ref().map(summary::bound));
    lines.finish_run(&report.run)
}

fn add_grid(lines: &mut SummaryLines, facts: &DistanceGridFacts) {
    let [x, y, z] = facts.size.map(grouped);
    lines.add(
        "samples",
        format!("{x} x {y} x {z} of f64, {} apart", short(facts.spacing, RoundingDirection::Nearest)),
    );
    lines.add("origin", point(facts.origin));
    let band = facts.band.map(|band| {
        format!(
            "{} samples within {} are distances",
            grouped(facts.distances),
            short(band, RoundingDirection::Nearest)
        )
    });
    lines.add_if("band", band);
    let route = match facts.route {
        "field" => "to the surface of the field, by its own values",
        "tessellation" => "to a triangle mesh of the shape",
        _ => "to the triangles",
    };
    lines.add("distances", route);
    let error_text = |most: f64, evidence: &str| {
        format!("off by at most {} ({evidence})", short(most, RoundingDirection::Up))
    };
    lines.add_if("samples off", facts.off_at_most.map(|most| error_text(most, facts.evidence)));
    let interpolant = facts.interpolant.as_ref();
    lines.add_if("between them", interpolant.map(|facts| error_text(facts.at_most, facts.evidence)));
    if let Some([stored, all]) = facts.bricks {
        lines.add("bricks", format!("{} of {} are stored", grouped(stored), grouped(all)));
    }
    let Some(solid) = &facts.solid else { return };
    let sides = if solid.closed { "certain" } else { "by winding numbers, certain only away from holes" };
    lines.add("sides", sides);
    lines.add("solid", if solid.is_solid { "yes" } else { "no" });
}
