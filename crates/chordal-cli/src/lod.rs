//! `chordal lod`
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::fault::Fault;
use crate::input::InputSource;
use crate::load;
use crate::numbers::{RoundingDirection, grouped, short};
use crate::options::TableArgs;
use crate::output::OutputTarget;
use crate::output_folder::{FolderPlace, OutputFolder};
use crate::output_set::OutputSetArgs;
use crate::spelling::CommandLine;
use crate::summary::{SummaryLines, attribute};
use crate::temp_output::OutputWriter;
use crate::verb_run::{RunArgs, VerbRun};
use chordal::budget::advice::Spell;
use chordal_io::{Format, picture_extensions};
use chordal_verbs::formats::extensions_where;
use chordal_verbs::options::{LodContainer, LodOptions};
use chordal_verbs::report::{LevelFacts, LevelsFacts, Report};
use chordal_verbs::{Input, LodOutcome, extension, lod};
use clap::Args;
use std::path::Path;

/// `chordal lod`
#[derive(Args, Debug)]
#[command(after_help = "\
Each level is proved against the shape itself. Distances are those from the eye to the shape's box, in its own units.

Examples:
  chordal lod scan.ply --px 1 -o scan.glb
  chordal lod scan.ply --px 1 -o scan.gltf --separate
  chordal lod city.glb --px 1 --merge -o city_levels.glb
  chordal lod cage.obj --px 1 --nearest 2 -o tiles/
  chordal lod model.star --px 1 --tol 0.01% --view \"3840x2160 fov=60\" -o tiles/ --json")]
pub struct LodArgs {
    #[command(flatten)]
    pub options: TableArgs<LodOptions>,

    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub set: OutputSetArgs,

    #[command(flatten)]
    pub volume: crate::volume::VolumeArgs,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// Reads, builds levels, writes, reports.
pub fn run(args: &LodArgs) -> Result<(), Fault> {
    let options = &args.options;
    let form = LodForm::of(&args.output.output)?;
    if options.place.is_some() && form != LodForm::Tiles {
        return Err(Fault::usage("--at is for a folder of 3D Tiles: a glTF has no place on the Earth"));
    }
    let container = if form == LodForm::Tiles { LodContainer::Tiles } else { LodContainer::OneFile };
    let spec = options.spec(container, args.set.packing);
    let spec = spec.map_err(|why| Fault::usage(why.spelled(&CommandLine).to_string()))?;
    let run_args = RunArgs { input: &args.input, output: &args.output, console: &args.console };
    let mut run = VerbRun::start("lod", run_args)?;
    let output = LodOutput::prepare(args, form, &run)?;
    let mut input = run.read()?;
    args.volume.apply(&mut input.shape)?;
    // The folder is created only after the input was read.
    let output = output.open(args, &input)?;
    let mut outcome = run.made(lod(input, &spec, &run.job))?;
    run.keep_best(outcome.unmet.as_ref(), options.keep_best)?;
    args.set.strip(&mut outcome.certificate);
    let written = output.name();
    let bytes = output.write(args, &outcome, &run)?;
    run.print_notes(&outcome.certificate);
    run.report(outcome.certificate, (written, bytes), summary_text)
}

/// The file of a tileset that lists all others.
const LIST: &str = "tileset.json";

/// The form in which levels are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LodForm {
    /// A folder of tiles.
    Tiles,
    /// One glTF.
    OneFile(Format),
}

impl LodForm {
    /// The form for the name of an output.
    fn of(output: &Path) -> Result<Self, Fault> {
        let name = output.display().to_string();
        let is_folder = name.ends_with(std::path::is_separator) || output.is_dir();
        match extension(&name) {
            // Before its extension: a folder may have one as well.
            _ if is_folder => Ok(Self::Tiles),
            _ if name == "-" => Ok(Self::OneFile(Format::Glb)),
            None => Ok(Self::Tiles),
            Some(extension) => match Format::from_extension(extension) {
                Some(format) if format.is_gltf() => Ok(Self::OneFile(format)),
                _ => Err(Fault::usage(format!(
                    "{name}: levels of detail are written as {}, or into a folder as 3D Tiles: end its name with /",
                    extensions_where(Format::is_gltf, "or")
                ))),
            },
        }
    }
}

/// The output, checked before the input is read.
enum LodOutput {
    Tiles(FolderPlace),
    OneFile(OutputTarget, Format),
}

impl LodOutput {
    fn prepare(args: &LodArgs, form: LodForm, run: &VerbRun) -> Result<Self, Fault> {
        match form {
            LodForm::Tiles if args.set.is_separate => {
                Err(Fault::usage("--separate is for .gltf; a folder of tiles is several files anyway"))
            }
            LodForm::Tiles => {
                let output = &args.output.output;
                let place = FolderPlace::new(output, args.output.existing(), is_tileset_file)?;
                match run.source() {
                    InputSource::File(input) => refuse_inside(&place, input, output)?,
                    InputSource::Stdin => {}
                }
                Ok(Self::Tiles(place))
            }
            LodForm::OneFile(format) => {
                let target = run.target()?;
                args.set.form_for(&target, format)?;
                Ok(Self::OneFile(target, format))
            }
        }
    }

    /// Prepares the output for an input.
    fn open(self, args: &LodArgs, input: &Input) -> Result<OpenOutput, Fault> {
        let place = match self {
            Self::OneFile(target, format) => return Ok(OpenOutput::OneFile(target, format)),
            Self::Tiles(place) => place,
        };
        // The folder is replaced as a whole, with everything in it that the input refers to.
        load::files_beside(&args.input, input)
            .try_for_each(|file| refuse_inside(&place, &file, &args.output.output))?;
        let name = place.join(LIST).display().to_string();
        Ok(OpenOutput::Tiles(place.open()?, name))
    }
}

/// The output, ready to be written.
enum OpenOutput {
    /// A folder, and the path of its list.
    Tiles(OutputFolder, String),
    OneFile(OutputTarget, Format),
}

impl OpenOutput {
    /// The name in reports.
    fn name(&self) -> String {
        match self {
            Self::Tiles(_, list) => list.clone(),
            Self::OneFile(target, _) => target.name(),
        }
    }

    /// Writes all levels and returns the number of bytes.
    fn write(self, args: &LodArgs, outcome: &LodOutcome, run: &VerbRun) -> Result<u64, Fault> {
        match self {
            Self::Tiles(folder, _) => {
                let files = outcome
                    .tileset()
                    .map_err(|failure| Fault::from_failure(&run.name(), &failure.spelled(&CommandLine)))?;
                folder.write(&files, LIST)
            }
            Self::OneFile(target, format) => {
                let write_set = |stem: &str| outcome.write_files(stem);
                let write_single: OutputWriter = &mut |out| outcome.write(format, out);
                args.set.write(&run.place(&target, false), &outcome.certificate, write_single, write_set)
            }
        }
    }
}

/// Refuses a folder that contains a file of the input.
fn refuse_inside(place: &FolderPlace, file: &Path, output: &Path) -> Result<(), Fault> {
    if !place.holds(file) {
        return Ok(());
    }
    Err(Fault::output(
        "output-is-input",
        format!(
            "{}: the input is a tile or another file of this folder, which would be replaced; choose another folder",
            output.display()
        ),
    ))
}

/// Whether a name is that of a file of a tileset: the list, tiles, pictures.
fn is_tileset_file(name: &str) -> bool {
    let is_numbered = |start: &str, end: &str| {
        let number = name.strip_prefix(start).and_then(|rest| rest.strip_suffix(end)?.strip_suffix('.'));
        number.is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
    };
    name == LIST
        || is_numbered("level_", "glb")
        || is_numbered("tile_", "glb")
        || picture_extensions().any(|extension| is_numbered("image_", extension))
}

fn summary_text(report: &Report) -> String {
    let mut lines = SummaryLines::of_run(&report.run);
    if let Some(facts) = report.certificate.verb.levels() {
        levels(&mut lines, facts);
    }
    lines.finish_run(&report.run)
}

/// A level with more than this share of the triangles of the listed level above it is left out. Chosen: a
/// tile tree has dozens of such levels.
const WORTH_A_LINE: f64 = 0.8;

/// For each level whether it is listed: those that differ enough, and the last.
fn levels_to_list(facts: &LevelsFacts) -> Vec<bool> {
    let mut n_last = f64::INFINITY;
    let n = facts.levels.len();
    let is_listed_level = |(k, level): (usize, &LevelFacts)| {
        let is_listed = k + 1 == n || level.triangles as f64 <= WORTH_A_LINE * n_last;
        n_last = if is_listed { level.triangles as f64 } else { n_last };
        is_listed
    };
    facts.levels.iter().enumerate().map(is_listed_level).collect()
}

fn levels(lines: &mut SummaryLines, facts: &LevelsFacts) {
    let listed = levels_to_list(facts);
    for (k, level) in facts.levels.iter().enumerate().filter(|(k, _)| listed[*k]) {
        let from = level
            .distance
            .map_or("never".to_owned(), |d| format!("from {} on", short(d, RoundingDirection::Up)));
        lines.add(
            &format!("level {k}"),
            format!(
                "{} triangles{}, off by at most {} ({}), {from}",
                grouped(level.triangles),
                if level.tiles == 1 { String::new() } else { format!(" in {} tiles", level.tiles) },
                short(level.at_most, RoundingDirection::Up),
                level.evidence,
            ),
        );
        level.attributes.iter().for_each(|facts| lines.add("attribute", attribute(facts)));
    }
    let left_out = listed.iter().filter(|is_listed| !**is_listed).count();
    lines.add_if(
        "more",
        (left_out > 0).then(|| {
            format!(
                "{left_out} levels between these, each with few triangles less than the one above; --json lists all"
            )
        }),
    );
    let is_of_unlisted_level = |distance: f64| {
        facts.levels.iter().zip(&listed).any(|(level, listed)| !listed && level.distance == Some(distance))
    };
    for shown in facts.shown.iter().filter(|shown| !is_of_unlisted_level(shown.distance)) {
        let pixels = shown
            .pixels
            .map_or("no bound".to_owned(), |px| format!("{} px", short(px, RoundingDirection::Up)));
        lines.add(
            "at distance",
            format!(
                "{}: {} px across, level {}, {} triangles, at most {pixels}",
                short(shown.distance, RoundingDirection::Nearest),
                short(shown.covers_px, RoundingDirection::Nearest),
                shown.level,
                grouped(shown.triangles),
            ),
        );
    }
}
