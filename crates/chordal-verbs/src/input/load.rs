//! `load`: parses bytes to a shape, with the facts about the input that a report contains.
use super::file_extension::extension;
use super::script;
use super::script::ScriptContext;
use crate::provenance::composed::Composed;
use crate::provenance::digest::sha256;
use crate::provenance::field_digest::field_digest;
use crate::provenance::geometry_digest::geometry_digest;
use crate::report::{SourceFacts, SourceFileFacts};
use crate::{Shape, formats};
use chordal::Job;
use chordal::budget::advice::{Message, Setting};
use chordal::math::Box3;
use chordal_io::font::{Letters, read_letters};
use chordal_io::{
    FileLocation, FileOpener, ForeignFormat, Format, Limits, PolygonSurface, ReadError, Warning,
};
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

/// How to determine the format of some bytes, and options for reading them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FormatHint<'a> {
    /// The file's name; its extension counts.
    pub name: Option<&'a str>,
    /// The format, overriding name and content.
    pub format: Option<Format>,
    /// Values for a script's parameters.
    pub set: &'a [(String, f64)],
    /// The text that a font sets, and how.
    pub letters: Option<&'a Letters>,
    /// The box that clips a field, instead of the format's own.
    pub region: Option<Box3>,
}

impl FormatHint<'_> {
    /// The given format, else the format by the name, else by the content.
    #[must_use]
    pub fn format_of(self, bytes: &[u8]) -> Option<Format> {
        let extension = self.name.and_then(extension);
        // The list of a tileset is a JSON file, and its name does not tell it from other JSON files.
        let is_named =
            |format: &Format| *format != Format::Json || Format::sniff(bytes) != Some(Format::Tileset);
        let by_name = || extension.and_then(Format::from_packed_extension).filter(is_named);
        // A file of a foreign format may look like one of a format without a signature.
        let has_mark = |format: &Format| {
            format.has_signature() || extension.and_then(ForeignFormat::from_extension).is_none()
        };
        self.format.or_else(by_name).or_else(|| Format::sniff(bytes).filter(has_mark))
    }
}

/// A shape with its source.
#[derive(Clone, Debug)]
pub struct Input {
    /// The shape.
    pub shape: Shape,
    /// The format of the bytes.
    pub format: Format,
    /// The text that was set, if the file is a font.
    pub letters: Option<Letters>,
    /// The number of bytes.
    pub n_bytes: u64,
    /// The digest of the bytes.
    pub digest: InputDigest,
    /// The files beside it that were read, in the order of reading.
    pub files: Vec<InputFile>,
    /// Irregularities in the bytes.
    pub warnings: Vec<Warning>,
    /// The inputs that it was put together from, for triangles that were never a file.
    pub composed: Option<Arc<Composed>>,
    /// The script, if it is one and not too long to be carried by files that are made from it.
    pub source: Option<Arc<SourceFacts>>,
}

impl Input {
    /// A shape that was never a file; `format` is a format that could hold it.
    #[must_use]
    pub fn made(shape: Shape, format: Format) -> Self {
        Self {
            shape,
            format,
            letters: None,
            n_bytes: 0,
            digest: InputDigest::default(),
            files: Vec::new(),
            warnings: Vec::new(),
            composed: None,
            source: None,
        }
    }

    /// The SHA-256 of the bytes, in hexadecimal. For a shape that was never a file: the SHA-256 of its geometry or its
    /// formula, computed on the first call; `None` if there is no such digest, as for a function of the user.
    #[must_use]
    pub fn sha256(&self) -> Option<&str> {
        let compute = || match &self.shape {
            Shape::Field(implicit) => field_digest(implicit),
            other => geometry_digest(other).ok().flatten(),
        };
        self.digest.0.get_or_init(compute).as_deref()
    }
}

/// The cell of [`Input::sha256`]. By default it is computed on the first call.
#[derive(Clone, Debug, Default)]
pub struct InputDigest(OnceLock<Option<String>>);

impl From<String> for InputDigest {
    fn from(sha256: String) -> Self {
        Self(OnceLock::from(Some(sha256)))
    }
}

/// A file that an input names and that was read: a buffer or a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputFile {
    /// Its path below the folder of the input.
    pub path: String,
    /// The number of bytes.
    pub n_bytes: u64,
    /// Their SHA-256, in hexadecimal.
    pub sha256: String,
}

/// Reads any format that Chordal knows: the format given, else by the extension, else by the content.
///
/// Time and memory are linear in the bytes and capped by `limits`.
///
/// # Errors
/// If the format cannot be determined, or the bytes violate it; the error has the position.
///
/// ```
/// use chordal_verbs::{FormatHint, load};
/// let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
/// let input = load(obj, FormatHint { name: Some("triangle.obj"), ..FormatHint::default() }, &Default::default())?;
/// assert_eq!(input.shape.kind(), "triangles");
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn load(bytes: &[u8], hint: FormatHint, limits: &Limits) -> Result<Input, ReadError> {
    load_from(bytes, hint, None, limits, &job_of(limits))
}

/// As [`load`], for a file that may name other files beside it, which `open` returns: see
/// [`chordal_io::read_with`].
///
/// # Errors
/// As for [`load`]; also if a required file cannot be opened.
pub fn load_with(
    bytes: &[u8],
    hint: FormatHint,
    open: &mut FileOpener<'_>,
    limits: &Limits,
) -> Result<Input, ReadError> {
    load_from(bytes, hint, Some(open), limits, &job_of(limits))
}

/// As [`load_with`], for files that may take work to read (a script may build meshes): within the limits of a job, which
/// may be cancelled.
///
/// # Errors
/// As for [`load_with`].
pub fn load_within(
    bytes: &[u8],
    hint: FormatHint,
    open: &mut FileOpener<'_>,
    limits: &Limits,
    job: &Job,
) -> Result<Input, ReadError> {
    load_from(bytes, hint, Some(open), limits, job)
}

/// A job with no more memory than the limits allow for a file.
fn job_of(limits: &Limits) -> Job {
    let mut job = Job::default().with_threads(limits.threads);
    job.memory_limit = job.memory_limit.min(limits.bytes);
    job
}

fn load_from(
    bytes: &[u8],
    hint: FormatHint,
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
    job: &Job,
) -> Result<Input, ReadError> {
    let by_name = hint.name.and_then(extension).and_then(Format::from_packed_extension);
    // The name of a packed file says nothing about its content.
    let content = chordal_io::unpacked(bytes, hint.format.or(by_name), limits)?;
    // A file that begins like a foreign format is refused, whatever its name is.
    if let Some(foreign) = ForeignFormat::sniff(&content).filter(|_| hint.format.is_none()) {
        return Err(refuse_foreign(foreign));
    }
    let format = format_of(&content, hint)?;
    if let Some(surface) = limits.surface {
        check_surface(surface, format)?;
    }
    if hint.letters.is_some() && !format.is_font() {
        let message = Message::from("only fonts set letters: ").setting(Setting::Text);
        let message = message.words(format_args!(" does not apply to {format}"));
        return Err(ReadError::new("no-font", FileLocation::File, message));
    }
    let mut files: Vec<InputFile> = Vec::new();
    let mut scripts = BTreeMap::new();
    let mut open = open.map(|open| {
        |name: &str| {
            let path =
                chordal_io::with_stem(name, hint.name).ok_or("the name of the first file is not known")?;
            let path = &*path;
            let bytes = open(path)?;
            // A file that is named several times is one file of the input.
            if files.iter().all(|file| file.path != path) {
                let n_bytes = bytes.len() as u64;
                if format.is_script() && extension(path).and_then(Format::from_extension) == Some(format) {
                    scripts.insert(path.to_owned(), String::from_utf8_lossy(&bytes).into_owned());
                }
                files.push(InputFile { path: path.to_owned(), n_bytes, sha256: sha256(&bytes) });
            }
            Ok(bytes)
        }
    });
    let (mut shape, warnings) = if format.is_script() {
        let open = open.as_mut().map(|open| -> &mut FileOpener<'_> { open });
        let context = ScriptContext { set: hint.set, open, limits, job };
        script::shape(&content, context)?
    } else {
        if let Some((name, _)) = hint.set.first() {
            let message = format!("only scripts have parameters: there is no '{name}' to set in {format}");
            return Err(ReadError::new("unknown-parameter", FileLocation::File, message));
        }
        let loaded = match (hint.letters, &mut open) {
            (Some(letters), _) if format.is_font() => read_letters(&content, letters, limits)?,
            (_, Some(open)) => chordal_io::read_with(&content, format, open, limits)?,
            (_, None) => chordal_io::read(&content, format, limits)?,
        };
        (loaded.content.into(), loaded.warnings)
    };
    match (&mut shape, hint.region) {
        (_, None) => {}
        (Shape::Field(implicit), region) => implicit.region = region,
        (other, Some(_)) => {
            let message = format!("{} have their own size: a region is for fields", other.kind());
            return Err(ReadError::new("no-field", FileLocation::File, message));
        }
    }
    let letters = hint.letters.cloned();
    let sha256 = sha256(bytes);
    // A packed script has another digest than its text.
    let is_plain_script = format.is_script() && content.len() == bytes.len();
    let source = is_plain_script.then(|| source_facts((bytes, &sha256), hint, &files, scripts)).flatten();
    Ok(Input {
        shape,
        format,
        letters,
        n_bytes: bytes.len() as u64,
        digest: sha256.into(),
        files,
        warnings,
        composed: None,
        source: source.map(Arc::new),
    })
}

/// The facts of a script that was just run; `scripts` are the texts of those that it loads, by path. `None` if they are longer
/// than a file carries.
fn source_facts(
    (bytes, sha256): (&[u8], &str),
    hint: FormatHint<'_>,
    files: &[InputFile],
    mut scripts: BTreeMap<String, String>,
) -> Option<SourceFacts> {
    /// The name of a script that was never a file.
    const UNNAMED: &str = "script.star";
    let base_name = hint.name.and_then(|name| name.rsplit(['/', '\\']).next());
    let facts = |file: &InputFile| SourceFileFacts {
        path: file.path.clone(),
        sha256: file.sha256.clone(),
        text: scripts.remove(&file.path),
    };
    let source = SourceFacts {
        name: base_name.filter(|name| !name.is_empty()).unwrap_or(UNNAMED).to_owned(),
        sha256: sha256.to_owned(),
        text: String::from_utf8(bytes.to_vec()).ok()?,
        parameters: hint.set.iter().cloned().collect(),
        files: files.iter().map(facts).collect(),
    };
    source.fits().then_some(source)
}

/// Only OBJ and USD keep polygons; triangles of other formats are faceted anyway.
fn check_surface(surface: PolygonSurface, format: Format) -> Result<(), ReadError> {
    if format.may_hold_cages() || surface == PolygonSurface::Faceted && format.holds_triangles() {
        return Ok(());
    }
    let message = Message::from("only the polygons of an .obj or of USD can be a cage: ")
        .setting(Setting::Surface)
        .words(format_args!(" does not apply to {format}"));
    Err(ReadError::new("no-cage", FileLocation::File, message))
}

/// Refuses a foreign format by its name, with the usual way around.
fn refuse_foreign(foreign: &ForeignFormat) -> ReadError {
    let message = format!("this is {}, which is not read: {}", foreign.name, foreign.way);
    ReadError::new("foreign-format", FileLocation::File, message)
}

fn format_of(bytes: &[u8], hint: FormatHint) -> Result<Format, ReadError> {
    hint.format_of(bytes).ok_or_else(|| {
        let named = hint.name.and_then(extension).and_then(ForeignFormat::from_extension);
        if let Some(foreign) = named.filter(|_| !bytes.is_empty()) {
            return refuse_foreign(foreign);
        }
        let what = if bytes.is_empty() { "the file is empty" } else { "the content is of no known format" };
        let message = Message::from(what).words("; ").setting(Setting::From).words(" names the format: ");
        let message =
            message.words(format_args!("formats that can be read are {}", formats::readable_names()));
        ReadError::new("unknown-format", FileLocation::File, message)
    })
}
