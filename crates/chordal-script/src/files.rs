//! `ShapeFiles`: shapes in files that a script names.
use chordal::Job;
use chordal::implicit::Field;

/// Reads the shapes that `mesh("part.stl")` in a script names. Scripts have no files of their own: which names
/// lead to a file is up to the program that runs them.
pub trait ShapeFiles {
    /// The triangles of a file as a field. The same name gives the same field.
    ///
    /// # Errors
    /// In one sentence, when the name leads to no file, or the file holds no triangles.
    fn mesh(&self, name: &str, job: &Job) -> Result<Field, String>;
}

/// No files at all.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFiles;

impl ShapeFiles for NoFiles {
    fn mesh(&self, name: &str, _: &Job) -> Result<Field, String> {
        Err(format!("'{name}' cannot be read: there are no files here"))
    }
}
