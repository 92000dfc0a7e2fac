//! `OutputTarget`: the destination of the output, checked before the work.
use crate::fault::Fault;
use crate::input::InputSource;
use crate::overwrite::{OverwritePolicy, refuse_input, refuse_occupied};
use crate::temp_output::TempOutput;
use std::path::{Path, PathBuf};

/// The destination of the output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OutputTarget {
    /// `-`.
    Stdout,
    /// A file.
    File {
        /// The path.
        path: PathBuf,
        /// What happens to an existing file.
        existing: OverwritePolicy,
    },
}

impl OutputTarget {
    /// `-` is stdout; anything else is a path. It is checked as far as possible, so that a long job does not
    /// fail at its end because a folder cannot be written.
    ///
    /// # Errors
    /// If the output cannot, or may not, be written.
    pub fn prepare(arg: &Path, existing: OverwritePolicy, input: &InputSource) -> Result<Self, Fault> {
        if arg.as_os_str() == "-" {
            return Ok(Self::Stdout);
        }
        refuse_input(arg, input)?;
        refuse_occupied(arg, existing)?;
        // Only to see that the folder can be written, before any work.
        drop(TempOutput::create(arg)?);
        Ok(Self::File { path: arg.to_owned(), existing })
    }

    /// The name in messages and reports.
    pub fn name(&self) -> String {
        match self {
            Self::Stdout => "stdout".to_owned(),
            Self::File { path, .. } => path.display().to_string(),
        }
    }
}
