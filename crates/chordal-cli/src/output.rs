//! `OutputTarget`: where output goes, checked before the work.
use crate::fault::Fault;
use crate::input::InputSource;
use crate::overwrite::{OverwritePolicy, refuse_input, refuse_occupied};
use crate::temp_output::TempOutput;
use std::path::{Path, PathBuf};

/// Where output goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OutputTarget {
    /// `-`.
    Stdout,
    /// A file.
    File {
        /// Its name.
        path: PathBuf,
        /// What happens to a file that already has it.
        existing: OverwritePolicy,
    },
}

impl OutputTarget {
    /// `-` is stdout; anything else is a path, checked now as far as that is possible: the work may take
    /// long, and a folder that cannot be written should be known before.
    ///
    /// # Errors
    /// When the output cannot, or should not, be written.
    pub fn prepare(arg: &Path, existing: OverwritePolicy, input: &InputSource) -> Result<Self, Fault> {
        if arg.as_os_str() == "-" {
            return Ok(Self::Stdout);
        }
        refuse_input(arg, input)?;
        refuse_occupied(arg, existing)?;
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
