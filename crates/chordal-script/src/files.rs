//! Files beside a script: how scripts use them, and the trait that opens them.
use chordal::Job;
use chordal::implicit::Field;
use std::collections::BTreeMap;
use std::fmt;

/// How a script uses a file.
#[derive(Clone, Debug, PartialEq)]
pub enum FileUse {
    /// As another script, by its text.
    Script,
    /// As a drawing: its filled area, as a 2D shape whose curves are polygons.
    Drawing {
        /// The largest distance between curves and polygons.
        tolerance: f64,
    },
    /// As a font: the letters of a text, as a 2D shape.
    Letters(FontText),
    /// As a mesh: its triangles, as a shape.
    Mesh,
    /// As a height map: the solid below the heights that the grey values of a picture stand for.
    Heights {
        /// Its sizes along x and y.
        size: [f64; 2],
        /// The height of white above black.
        height: f64,
        /// The height of black above the floor, which is at z = 0.
        base: f64,
    },
}

/// A text to be set in a font.
#[derive(Clone, Debug, PartialEq)]
pub struct FontText {
    /// The text.
    pub text: String,
    /// The length of the em.
    pub em: f64,
    /// The coordinates on the axes of a variable font, by their tags.
    pub axes: Vec<(String, f64)>,
    /// The largest distance between curves and the polygons that approximate them.
    pub tolerance: f64,
    /// The share of each line's advance width that lies left of x = 0.
    pub align: f64,
}

/// The content of an opened file.
#[derive(Clone, Debug)]
pub enum OpenedFile {
    /// The text of a script.
    Script(String),
    /// A shape, and notes about how it was built, in sentences.
    Shape(Field, Vec<String>),
}

/// Opens the files that a script refers to. Names are relative paths without `..`, with `/` between their
/// parts; an implementation has to ensure that no link leads out of the folder.
pub trait ScriptFiles {
    /// Opens a file, within the limits of the job.
    ///
    /// # Errors
    /// In a sentence without the name: why the file cannot be opened, or what is wrong with it.
    fn open(&self, name: &str, file_use: FileUse, job: &Job) -> Result<OpenedFile, String>;
}

/// Refuses all files: for scripts that are in no folder.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFiles;

impl ScriptFiles for NoFiles {
    fn open(&self, _: &str, _: FileUse, _: &Job) -> Result<OpenedFile, String> {
        Err("this script has no folder to read files from".to_owned())
    }
}

/// The name of the script itself, which no file can have.
pub(crate) const MAIN: &str = "";

/// The error of a file that cannot be used.
#[derive(Debug)]
pub(crate) struct FileError(pub String);

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for FileError {}

/// The most files that one script opens, including those that its files load. Chosen: more than scripts by
/// hand need; larger values let a small script keep its host reading.
pub(crate) const MOST_FILES: usize = 64;

/// The key of a file that was opened as a shape: its name, and its `FileUse` in `Debug` form.
pub(crate) type ShapeKey = (String, String);

/// The shapes of the files that were opened so far.
pub(crate) type OpenedShapes = BTreeMap<ShapeKey, Field>;

/// Checks that a name is the relative path of a file in the script's folder, or below it.
pub(crate) fn check_name(name: &str) -> Result<(), String> {
    let shown: String = name.chars().take(80).collect();
    let is_plain = |part: &str| !part.is_empty() && part != "." && part != "..";
    if name.len() > 400 || name.contains(['\\', ':', '\0']) || !name.split('/').all(is_plain) {
        return Err(format!(
            "'{shown}' is not allowed: a path must be relative to the script's folder, without '..'"
        ));
    }
    Ok(())
}
