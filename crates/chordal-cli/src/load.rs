//! Reads the shapes that arguments name.
use crate::args::InputArgs;
use crate::beside::{read_allowed, read_beside};
use crate::console::Console;
use crate::fault::{Exit, Fault};
use crate::folder::{list_slices, tileset_in};
use crate::input::InputSource;
use crate::memory;
use crate::overwrite::{is_same_file, parent};
use crate::spelling::CommandLine;
use chordal::Job;
use chordal::budget::RefusalCode;
use chordal::budget::advice::Spell;
use chordal::explicit::subdivision::Scheme;
use chordal_io::font::Letters;
use chordal_io::{Format, Limits, PolygonSurface};
use chordal_verbs::{FormatHint, Input, Shape, load_within, sha256};
use std::path::{Path, PathBuf};

/// Reads the input that `args` name, prints its warnings, and applies `--unit` and `--up`.
pub fn read(args: &InputArgs, job: &Job, console: &Console) -> Result<Input, Fault> {
    RawInput::read(args, job)?.load(args, console)
}

/// Refuses an output that is one of the files that an input references.
///
/// # Errors
/// If it is one of these files.
pub fn refuse_files(output: &Path, args: &InputArgs, input: &Input) -> Result<(), Fault> {
    let is_read = files_beside(args, input).any(|file| is_same_file(&file, output));
    if !is_read {
        return Ok(());
    }
    let message = format!("{}: the output is a file that the input references", output.display());
    Err(Fault::output("output-is-input", message))
}

/// The possible paths of the files that an input references: beside it, or below an allowed folder.
pub fn files_beside(args: &InputArgs, input: &Input) -> impl Iterator<Item = PathBuf> {
    let folders =
        move || std::iter::once(parent(&args.input)).chain(args.allow.iter().map(|folder| &**folder));
    input.files.iter().flat_map(move |file| folders().map(|folder| folder.join(&file.path)))
}

/// Reads an input for a format that may hold polygons. If polygons were cut into triangles, the input is read
/// again as a cage; `prefers(polygons, triangles)` says whether the polygons are used.
pub fn read_polygons(
    args: &InputArgs,
    job: &Job,
    console: &Console,
    prefers: impl Fn(&Input, &Input) -> bool,
) -> Result<Input, Fault> {
    let raw = RawInput::read(args, job)?;
    let input = raw.parse(args)?;
    let was_cut = input.format == Format::Obj && input.warnings.iter().any(|w| w.code == "polygons-cut");
    if was_cut && args.read.surface.is_none() {
        let mut args = args.clone();
        args.read.surface = Some(PolygonSurface::Limit(Scheme::default()));
        // An input that is no valid cage stays triangles.
        if let Some(polygons) = raw.parse(&args).ok().filter(|polygons| prefers(polygons, &input)) {
            return Ok(raw.print_warnings(polygons, console));
        }
    }
    Ok(raw.print_warnings(input, console))
}

/// Reads another shape with the arguments of the first. Options for fields, fonts or polygons apply only if
/// it is one.
pub fn read_other(args: &InputArgs, job: &Job, console: &Console) -> Result<Input, Fault> {
    let raw = RawInput::read(args, job)?;
    let format = raw.format(args);
    raw.load(&applicable_args(args, format), console)
}

/// As [`read_other`], but `--surface` applies only if `is_cage` accepts the digest of the bytes.
pub fn read_of_digest(
    args: &InputArgs,
    is_cage: impl Fn(&str) -> bool,
    job: &Job,
    console: &Console,
) -> Result<Input, Fault> {
    let raw = RawInput::read(args, job)?;
    let mut applicable = applicable_args(args, raw.format(args));
    if applicable.read.surface.is_some() && !is_cage(&sha256(&raw.bytes)) {
        applicable.read.surface = None;
    }
    raw.load(&applicable, console)
}

/// Reads the two shapes of a verb that compares. Options for fields, fonts or polygons apply only to inputs
/// of that kind; all others apply to both.
///
/// # Errors
/// If an option applies to neither input.
pub fn read_both(args: [&InputArgs; 2], job: &Job, console: &Console) -> Result<[Input; 2], Fault> {
    let [first, second] = args;
    let inputs = [RawInput::read(first, job)?, RawInput::read(second, job)?];
    let formats = [inputs[0].format(first), inputs[1].format(second)];
    // An input of unknown format passes here; loading refuses it with a better message.
    let none = |is_so: fn(Format) -> bool| formats.iter().all(|format| format.is_some_and(|f| !is_so(f)));
    if first.read.text.is_some() && none(Format::is_font) {
        return Err(Fault::usage("--text is for fonts, and neither of the two is one"));
    }
    if !first.read.set.is_empty() && none(Format::is_script) {
        return Err(Fault::usage("--set is for shape scripts, and neither of the two is one"));
    }
    if first.read.region.is_some() && none(Format::holds_fields) {
        return Err(Fault::usage("--region is for fields, and neither of the two is one"));
    }
    if first.read.surface.is_some() && none(|format| format == Format::Obj) {
        return Err(Fault::usage("--surface is for polygons (.obj), and neither of the two has any"));
    }
    let [a, b] = inputs;
    Ok([
        a.load(&applicable_args(first, formats[0]), console)?,
        b.load(&applicable_args(second, formats[1]), console)?,
    ])
}

/// The arguments without options for other kinds of inputs than `format`.
fn applicable_args(args: &InputArgs, format: Option<Format>) -> InputArgs {
    let mut args = args.clone();
    let read = &mut *args.read;
    let is = |is_so: fn(Format) -> bool| format.is_some_and(is_so);
    if !is(Format::is_script) {
        read.set.clear();
        read.region = read.region.filter(|_| is(Format::holds_fields));
    }
    if !is(Format::is_font) {
        (read.text, read.em) = (None, None);
        read.axes.clear();
    }
    // A file of USD says itself which of its polygons are a cage.
    read.surface = read.surface.filter(|_| format == Some(Format::Obj));
    args
}

/// The bytes of an input before its format is known.
struct RawInput {
    source: InputSource,
    name: String,
    bytes: Vec<u8>,
    /// Whether the bytes are the list of the slices in a folder.
    is_folder: bool,
    /// The conditions of reading it.
    job: Job,
}

impl RawInput {
    fn read(args: &InputArgs, job: &Job) -> Result<Self, Fault> {
        let mut source = InputSource::from_arg(&args.input);
        if let InputSource::File(path) = &mut source
            && let Some(list) = tileset_in(path)
        {
            *path = list;
        }
        let slices = match &source {
            InputSource::File(path) => list_slices(path),
            InputSource::Stdin => None,
        };
        let folder = slices.is_some();
        let bytes = slices.map_or_else(|| source.read(limits(args).bytes), Ok)?;
        Ok(Self { name: source.name(), source, bytes, is_folder: folder, job: job.clone() })
    }

    fn hint<'a>(&'a self, args: &'a InputArgs, letters: Option<&'a Letters>) -> FormatHint<'a> {
        let is_file = matches!(self.source, InputSource::File(_)) && !self.is_folder;
        // The ending of a folder's name is no format.
        let name = is_file.then_some(self.name.as_str());
        FormatHint { name, format: args.read.from, set: &args.read.set, letters, region: args.read.region }
    }

    fn format(&self, args: &InputArgs) -> Option<Format> {
        self.hint(args, None).format_of(&self.bytes)
    }

    fn load(&self, args: &InputArgs, console: &Console) -> Result<Input, Fault> {
        self.parse(args).map(|input| self.print_warnings(input, console))
    }

    /// Prints the warnings.
    fn print_warnings(&self, input: Input, console: &Console) -> Input {
        // What a script prints is no warning.
        let (printed, warnings): (Vec<_>, Vec<_>) =
            input.warnings.iter().partition(|w| w.code == "script-said");
        console.warn(&self.name, &warnings);
        printed.iter().for_each(|line| console.say(&format!("{}: {}", self.name, line.message)));
        input
    }

    fn parse(&self, args: &InputArgs) -> Result<Input, Fault> {
        let name = &self.name;
        let letters = args.read.letters();
        let limits = Limits { threads: self.job.threads, ..limits(args) };
        let mut open = |path: &str| match &self.source {
            // `read_beside` takes a file in the folder; the list itself is no file.
            InputSource::File(folder) if self.is_folder => {
                read_beside(&folder.join("list"), path, limits.bytes)
            }
            InputSource::File(first) => match read_beside(first, path, limits.bytes) {
                Err(why) => read_allowed(&args.allow, path, limits.bytes).unwrap_or(Err(why)),
                read => read,
            },
            InputSource::Stdin => {
                let nowhere = || Err("stdin is in no folder".to_owned());
                read_allowed(&args.allow, path, limits.bytes).unwrap_or_else(nowhere)
            }
        };
        let mut input =
            load_within(&self.bytes, self.hint(args, letters.as_ref()), &mut open, &limits, &self.job)
                .spelled(&CommandLine)
                .map_err(|error| Fault::input(error.code, format!("{name}: {error}")))?;
        self.check_memory(&input, args)?;
        args.read.complete(input.shape.frame_mut());
        Ok(input)
    }
}

impl RawInput {
    /// Refuses triangles that are too many for the memory limit, before the work.
    fn check_memory(&self, input: &Input, args: &InputArgs) -> Result<(), Fault> {
        let (Shape::Scene(scene), Some(limit)) = (&input.shape, args.memory_limit()) else { return Ok(()) };
        let least = memory::least_for(scene, self.bytes.len() as u64);
        if least <= limit {
            return Ok(());
        }
        let n_triangles = input.shape.n_triangles().unwrap_or(0);
        let message = format!(
            "{}: {n_triangles} triangles need at least {least} bytes of memory to be processed; the \
             limit is {limit} (--max-memory)",
            self.name
        );
        Err(Fault::new(Exit::Budget, RefusalCode::TooMuchMemory.as_str(), message))
    }
}

pub fn limits(args: &InputArgs) -> Limits {
    let mut limits = args.read.limits(Limits::default());
    limits.bytes = args.memory_limit().map_or(limits.bytes, |most| most.min(limits.bytes));
    limits.level = args.level;
    limits
}
