//! `Library`: a script and the files that it loads, parsed, in the order of their evaluation.
use crate::files::{FileUse, MAIN, MOST_FILES, OpenedFile, ScriptFiles, check_name};
use crate::grammar::{Program, parse};
use crate::{Limits, ScriptError};
use chordal::Job;

/// A script and the files that it loads. Each program follows those that it loads itself; the main script is
/// the last.
pub(crate) struct Library {
    pub programs: Vec<(String, Program)>,
    /// The number of differences that are right operands of a `|`, in all programs.
    pub n_cuts: usize,
}

impl Library {
    pub fn new(
        text: &str,
        limits: &Limits,
        (files, job): (&dyn ScriptFiles, &Job),
    ) -> Result<Self, ScriptError> {
        let mut library = Self { programs: Vec::new(), n_cuts: 0 };
        library.add(MAIN, text, limits, (files, job), &mut Vec::new())?;
        Ok(library)
    }

    /// Adds a file after the files that it loads. `loading` is the chain of files that are being loaded.
    fn add(
        &mut self,
        name: &str,
        text: &str,
        limits: &Limits,
        (files, job): (&dyn ScriptFiles, &Job),
        loading: &mut Vec<String>,
    ) -> Result<(), ScriptError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let program = parse(text, name, self.n_cuts, limits).map_err(|error| error.of_file(name))?;
        self.n_cuts += program.cuts.len();
        loading.push(name.to_owned());
        let loads: Vec<_> =
            program.module.loads().iter().map(|load| (load.module_id.to_owned(), load.span.span)).collect();
        for (path, span) in loads {
            let error = |code, why: String| program.source.error(code, why, span).of_file(name);
            check_name(&path).map_err(|why| error("script-file", why))?;
            // Added already, through another file: a file is evaluated once.
            if self.programs.iter().any(|(loaded, _)| *loaded == path) {
                continue;
            }
            if loading.contains(&path) {
                let why =
                    format!("'{path}' is loaded in a cycle: it loads this file, directly or through others");
                return Err(error("script-file", why));
            }
            if loading.len() + self.programs.len() >= MOST_FILES {
                return Err(error("script-limit", format!("the script loads more than {MOST_FILES} files")));
            }
            let text = match files.open(&path, FileUse::Script, job) {
                Ok(OpenedFile::Script(text)) => text,
                Ok(OpenedFile::Shape(..)) => {
                    return Err(error("script-file", format!("'{path}' is not a script")));
                }
                Err(why) => {
                    return Err(error("script-file", format!("'{path}' cannot be loaded: {why}")));
                }
            };
            self.add(&path, &text, limits, (files, job), loading)?;
        }
        loading.pop();
        self.programs.push((name.to_owned(), program));
        Ok(())
    }
}
