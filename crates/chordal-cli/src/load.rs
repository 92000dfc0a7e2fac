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
use chordal_io::font::Letters;
use chordal_io::{Format, Limits, PolygonSurface};
use chordal_verbs::{FormatHint, Input, Shape, load_within, sha256};
use std::path::{Path, PathBuf};

/// Reads what `args` name on the threads of a job, tells its warnings, and adds what the user knows of its space.
pub fn read(args: &InputArgs, job: &Job, console: &Console) -> Result<Input, Fault> {
    RawInput::read(args, job)?.load(args, console)
}

/// Refuses an output that is one of the files that an input named.
///
/// # Errors
/// Then.
pub fn refuse_files(output: &Path, args: &InputArgs, input: &Input) -> Result<(), Fault> {
    let is_read = files_beside(args, input).any(|file| is_same_file(&file, output));
    if !is_read {
        return Ok(());
    }
    let message = format!("{}: the output is a file that the input names", output.display());
    Err(Fault::output("output-is-input", message))
}

/// Where the files stand that an input named, or may stand: beside it, or below a folder that is allowed.
pub fn files_beside(args: &InputArgs, input: &Input) -> impl Iterator<Item = PathBuf> {
    let folders =
        move || std::iter::once(parent(&args.input)).chain(args.allow.iter().map(|folder| &**folder));
    input.files.iter().flat_map(move |file| folders().map(|folder| folder.join(&file.path)))
}

/// Reads what `args` name for a format that may hold polygons: those that were cut into triangles are read
/// again as polygons, and `prefers` says of the polygons and the triangles whether these are kept.
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
        args.read.surface = Some(PolygonSurface::CatmullClark);
        // What is no cage stays triangles.
        if let Some(polygons) = raw.parse(&args).ok().filter(|polygons| prefers(polygons, &input)) {
            return Ok(raw.tell(polygons, console));
        }
    }
    Ok(raw.tell(input, console))
}

/// Reads another shape with the arguments of the first: what is said of fields or polygons holds if it is
/// such.
pub fn read_other(args: &InputArgs, job: &Job, console: &Console) -> Result<Input, Fault> {
    let bytes = RawInput::read(args, job)?;
    let format = bytes.format(args);
    bytes.load(&applicable_args(args, format), console)
}

/// As [`read_other`]; what is said of polygons holds only where `is_cage` says so of the digest of the bytes.
pub fn read_of_digest(
    args: &InputArgs,
    is_cage: impl Fn(&str) -> bool,
    job: &Job,
    console: &Console,
) -> Result<Input, Fault> {
    let bytes = RawInput::read(args, job)?;
    let mut own = applicable_args(args, bytes.format(args));
    if own.read.surface.is_some() && !is_cage(&sha256(&bytes.bytes)) {
        own.read.surface = None;
    }
    bytes.load(&own, console)
}

/// Reads the two shapes of a verb that compares. What is said of fields or polygons holds for those of the
/// two that are such, and everything else for both.
///
/// # Errors
/// When neither of them is what something is said of.
pub fn read_both(args: [&InputArgs; 2], job: &Job, console: &Console) -> Result<[Input; 2], Fault> {
    let [first, second] = args;
    let bytes = [RawInput::read(first, job)?, RawInput::read(second, job)?];
    let formats = [bytes[0].format(first), bytes[1].format(second)];
    let has_script = formats.contains(&Some(Format::Star));
    if first.read.text.is_some() && !formats.contains(&Some(Format::Ttf)) && !formats.contains(&None) {
        return Err(Fault::usage("--text is for fonts, and neither of the two is one"));
    }
    let has_field = has_script || formats.contains(&Some(Format::Vm));
    // A text that nobody knows is refused for that.
    if !first.read.set.is_empty() && !has_script && !formats.contains(&None) {
        return Err(Fault::usage("--set is for shape scripts, and neither of the two is one"));
    }
    if first.read.region.is_some() && !has_field && !formats.contains(&None) {
        return Err(Fault::usage("--region is for fields, and neither of the two is one"));
    }
    if first.read.surface.is_some() && !formats.contains(&Some(Format::Obj)) && !formats.contains(&None) {
        return Err(Fault::usage("--surface is for polygons (.obj), and neither of the two has any"));
    }
    let [a, b] = bytes;
    Ok([
        a.load(&applicable_args(first, formats[0]), console)?,
        b.load(&applicable_args(second, formats[1]), console)?,
    ])
}

/// Without what is for fields or for polygons, where this has none.
fn applicable_args(args: &InputArgs, format: Option<Format>) -> InputArgs {
    let mut args = args.clone();
    let read = &mut *args.read;
    if format != Some(Format::Star) {
        read.set.clear();
        read.region = read.region.filter(|_| format == Some(Format::Vm));
    }
    if format != Some(Format::Ttf) {
        (read.text, read.em) = (None, None);
        read.axes.clear();
    }
    read.surface = read.surface.filter(|_| format == Some(Format::Obj));
    args
}

/// An input before anybody knows what it is.
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
        let list = match &source {
            InputSource::File(path) => list_slices(path),
            InputSource::Stdin => None,
        };
        let folder = list.is_some();
        let bytes = list.map_or_else(|| source.read(limits(args).bytes), Ok)?;
        Ok(Self { name: source.name(), source, bytes, is_folder: folder, job: job.clone() })
    }

    fn hint<'a>(&'a self, args: &'a InputArgs, letters: Option<&'a Letters>) -> FormatHint<'a> {
        let is_file = matches!(self.source, InputSource::File(_)) && !self.is_folder;
        let name = is_file.then_some(self.name.as_str());
        FormatHint { name, format: args.read.from, set: &args.read.set, letters, region: args.read.region }
    }

    fn format(&self, args: &InputArgs) -> Option<Format> {
        self.hint(args, None).format_of(&self.bytes)
    }

    fn load(&self, args: &InputArgs, console: &Console) -> Result<Input, Fault> {
        self.parse(args).map(|input| self.tell(input, console))
    }

    /// Tells the warnings.
    fn tell(&self, input: Input, console: &Console) -> Input {
        // What a script says is no warning.
        let (said, warnings): (Vec<_>, Vec<_>) = input.warnings.iter().partition(|w| w.code == "script-said");
        console.warn(&self.name, &warnings);
        said.iter().for_each(|line| console.say(&format!("{}: {}", self.name, line.message)));
        input
    }

    fn parse(&self, args: &InputArgs) -> Result<Input, Fault> {
        let name = &self.name;
        let letters = args.read.letters();
        let limits = Limits { threads: self.job.threads, ..limits(args) };
        let mut open = |path: &str| match &self.source {
            // Files in a folder are beside its list.
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
    /// Refuses triangles that cannot be worked on within the limit of memory, before the work.
    fn check_memory(&self, input: &Input, args: &InputArgs) -> Result<(), Fault> {
        let (Shape::Scene(scene), Some(limit)) = (&input.shape, args.memory_limit()) else { return Ok(()) };
        let least = memory::least_for(scene, self.bytes.len() as u64);
        if least <= limit {
            return Ok(());
        }
        let n_triangles = input.shape.n_triangles().unwrap_or(0);
        let message = format!(
            "{}: {n_triangles} triangles and what is needed to work on them take {least} bytes of memory at least; the \
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
