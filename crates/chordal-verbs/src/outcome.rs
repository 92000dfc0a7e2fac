//! `MeshOutcome`: triangles or polylines at the precision of their format, with their certificate.
use crate::report::Certificate;
use chordal::budget::Bound;
use chordal_io::{FileSet, Format, Polylines, Scene, WriteError, write, write_files, write_polylines};
use std::io::Write;

/// A tessellation at the precision of its format, as a reader of the file gets it.
#[derive(Clone, Debug, PartialEq)]
pub enum Tessellation {
    /// Triangles.
    Triangles(Scene),
    /// Polylines, for formats that hold them.
    Polylines(Polylines),
}

/// Triangles or polylines at the precision of their format, with their bound and certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshOutcome {
    /// The tessellation to write.
    pub made: Tessellation,
    /// The output format.
    pub format: Format,
    /// The distance to the true shape, rounding to the format included.
    pub bound: Bound,
    /// The bound and more, for the file and the report.
    pub certificate: Certificate,
}

impl MeshOutcome {
    /// The triangles, if the tessellation has triangles.
    #[must_use]
    pub fn scene(&self) -> Option<&Scene> {
        match &self.made {
            Tessellation::Triangles(scene) => Some(scene),
            Tessellation::Polylines(_) => None,
        }
    }

    /// The polylines, if the tessellation has polylines.
    #[must_use]
    pub fn polylines(&self) -> Option<&Polylines> {
        match &self.made {
            Tessellation::Triangles(_) => None,
            Tessellation::Polylines(polylines) => Some(polylines),
        }
    }

    /// Writes the tessellation, with the certificate if the format can carry it.
    ///
    /// # Errors
    /// If the sink fails.
    pub fn write(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let certificate = self.certificate.to_value();
        match &self.made {
            Tessellation::Triangles(scene) => write(scene, Some(&certificate), self.format, out),
            Tessellation::Polylines(polylines) => {
                write_polylines(polylines, Some(&certificate), self.format, out)
            }
        }
    }

    /// Writes the same as a document called `stem`, with the files that it names, if the format has such files: see
    /// [`write_files`].
    ///
    /// # Errors
    /// If the format cannot hold it.
    pub fn write_files(&self, stem: &str) -> Result<FileSet<'_>, WriteError> {
        let certificate = self.certificate.to_value();
        match &self.made {
            Tessellation::Triangles(scene) => write_files(scene, Some(&certificate), self.format, stem),
            Tessellation::Polylines(_) => {
                let mut document = Vec::new();
                self.write(&mut document)?;
                Ok(FileSet { document, beside: Vec::new() })
            }
        }
    }

    /// Whether the document names other files: an OBJ names its materials.
    #[must_use]
    pub fn names_files(&self) -> bool {
        let Tessellation::Triangles(scene) = &self.made else { return false };
        self.format.names_files(&scene.assets)
    }
}
