//! `chordal bake`
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::fault::Fault;
use crate::numbers::{RoundingDirection, grouped, point, short};
use crate::options::TableArgs;
use crate::output_format::volume_format;
use crate::summary::{self, SummaryLines};
use crate::verb_run::{RunArgs, VerbRun};
use chordal_verbs::bake;
use chordal_verbs::options::BakeOptions;
use chordal_verbs::report::{DistanceGridFacts, Report};
use clap::Args;

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
pub struct BakeArgs {
    #[command(flatten)]
    pub options: TableArgs<BakeOptions>,

    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// Reads, samples, writes, reports.
pub fn run(args: &BakeArgs) -> Result<(), Fault> {
    let to = volume_format(&args.output.output, args.options.to)?;
    let run_args = RunArgs { input: &args.input, output: &args.output, console: &args.console };
    let mut run = VerbRun::start("bake", run_args)?;
    let target = run.target()?;
    let input = run.read()?;
    // clap requires one of the two.
    let spec = args.options.spec();
    let spec = spec.ok_or_else(|| Fault::usage("give either --cells or --tol, which set the resolution"))?;
    let outcome = run.made(bake(input, &spec, to, &run.job))?;
    run.keep_best(outcome.unmet.as_ref(), args.options.keep_best)?;
    let solidity = outcome.certificate.verb.grid().and_then(|facts| facts.solid.as_ref());
    if let Some(solidity) = solidity.filter(|solidity| !solidity.is_solid) {
        run.console.warn(&run.name(), &[&solidity.sentence]);
    }
    let bytes = target.write(&mut |out| outcome.write(out))?;
    run.print_notes(&outcome.certificate);
    run.report(outcome.certificate, (target.name(), bytes), summary_text)
}

fn summary_text(report: &Report) -> String {
    let mut lines = SummaryLines::of_run(&report.run);
    if let Some(facts) = report.certificate.verb.grid() {
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
