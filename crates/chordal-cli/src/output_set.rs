//! Options for outputs of several files, checked before the work.
use crate::fault::Fault;
use crate::options::TableArgs;
use crate::output::OutputTarget;
use crate::overwrite::refuse_occupied;
use crate::spelling::CommandLine;
use chordal::budget::advice::Spell;
use chordal_io::Format;
use chordal_verbs::OutputForm;
use chordal_verbs::options::OutputOptions;

/// Arguments of verbs whose output may be several files.
pub type OutputSetArgs = TableArgs<OutputOptions>;

impl OutputSetArgs {
    /// The form of the output, checked as far as possible before the work.
    ///
    /// # Errors
    /// If an option does not fit the format, the target cannot be several files, or the buffer's file may not
    /// be written.
    pub fn form_for(&self, target: &OutputTarget, format: Format) -> Result<OutputForm, Fault> {
        let form = self.form(format).map_err(|why| Fault::usage(why.spelled(&CommandLine).to_string()))?;
        if self.is_separate {
            check_separate(target, format)?;
        }
        Ok(form)
    }
}

/// Checks that the output can be several files.
fn check_separate(target: &OutputTarget, format: Format) -> Result<(), Fault> {
    if !format.has_side_files() {
        return Err(Fault::usage(format!(
            "--separate is for .gltf, which names files beside it; {format} is one file"
        )));
    }
    match target {
        OutputTarget::Stdout => {
            Err(Fault::usage("--separate writes several files, which stdout cannot hold"))
        }
        OutputTarget::File { path, existing } => {
            let buffer = path.with_extension("bin");
            if buffer == *path {
                let name = path.display();
                return Err(Fault::usage(format!("{name}: this would be the name of the buffer beside it")));
            }
            refuse_occupied(&buffer, *existing)
        }
    }
}
