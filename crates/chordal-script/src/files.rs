//! Files beside a script: what it may ask for, and who opens them.
use chordal::Job;
use chordal::implicit::Field;
use std::collections::BTreeMap;
use std::fmt;

/// What a script wants of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum FileUse {
    /// Its text, as another script.
    Script,
    /// The regions that a drawing fills, as a shape of the plane: its curves as polygons within a length.
    Drawing {
        /// The length.
        tolerance: f64,
    },
    /// The letters of a text in a font, as a shape of the plane.
    Letters(FontText),
    /// Its triangles as a shape.
    Mesh,
    /// The solid below the heights that the greys of a picture are.
    Heights {
        /// How wide it is along x and y.
        size: [f64; 2],
        /// How far white is above black.
        height: f64,
        /// How far black is above the floor, which is at z = 0.
        base: f64,
    },
}

/// What a script has a font set.
#[derive(Clone, Debug, PartialEq)]
pub struct FontText {
    /// The text.
    pub text: String,
    /// The length of the em.
    pub em: f64,
    /// Where axes of the font are, by their tags.
    pub axes: Vec<(String, f64)>,
    /// The length within which curves are polygons.
    pub tolerance: f64,
    /// The share of each line's advance width that stands left of x = 0.
    pub align: f64,
}

/// What a file was found to be.
#[derive(Clone, Debug)]
pub enum OpenedFile {
    /// The text of a script.
    Script(String),
    /// A shape, and sentences about what it was made of.
    Shape(Field, Vec<String>),
}

/// Opens the files that a script names beside it. The names are relative paths without `..`, with `/` between
/// their parts; whoever opens them sees to it that no link leads elsewhere.
pub trait ScriptFiles {
    /// A file by its name, within the limits of the job.
    ///
    /// # Errors
    /// As a sentence without the name: why it cannot be had, or what is wrong with it.
    fn open(&self, name: &str, wanted: FileUse, job: &Job) -> Result<OpenedFile, String>;
}

/// No files at all, for scripts that come from nowhere.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFiles;

impl ScriptFiles for NoFiles {
    fn open(&self, _: &str, _: FileUse, _: &Job) -> Result<OpenedFile, String> {
        Err("this script is in no folder".to_owned())
    }
}

/// The name of the script itself, which no file can have.
pub(crate) const MAIN: &str = "";

/// A file cannot be had.
#[derive(Debug)]
pub(crate) struct FileError(pub String);

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for FileError {}

/// The most files that one script opens, those of its files included. Chosen.
pub(crate) const MOST_FILES: usize = 64;

/// A file that was opened as a shape: its name, and in words what it was opened for.
pub(crate) type ShapeKey = (String, String);

/// The shapes of the files that were opened so far.
pub(crate) type OpenedShapes = BTreeMap<ShapeKey, Field>;

/// Whether it is the path of a file beside the script or below its folder.
pub(crate) fn check_name(name: &str) -> Result<(), String> {
    let shown: String = name.chars().take(80).collect();
    let is_plain = |part: &str| !part.is_empty() && part != "." && part != "..";
    if name.len() > 400 || name.contains(['\\', ':', '\0']) || !name.split('/').all(is_plain) {
        return Err(format!("'{shown}' is not the relative path of a file beside the script, without '..'"));
    }
    Ok(())
}
