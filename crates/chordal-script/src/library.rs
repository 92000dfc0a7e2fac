//! The files that a script loads, parsed in the order in which they are evaluated.
use crate::files::{FileUse, MAIN, MOST_FILES, OpenedFile, ScriptFiles, check_name};
use crate::grammar::{Program, parse};
use crate::{Limits, ScriptError};
use chordal::Job;

/// A script and all that it loads, each after what it loads itself; the script is the last.
pub(crate) struct Library {
    pub programs: Vec<(String, Program)>,
    /// How many differences are right operands of a `|`, in all of them.
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

    fn add(
        &mut self,
        name: &str,
        text: &str,
        limits: &Limits,
        (files, job): (&dyn ScriptFiles, &Job),
        open: &mut Vec<String>,
    ) -> Result<(), ScriptError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let program = parse(text, name, self.n_cuts, limits).map_err(|error| error.of_file(name))?;
        self.n_cuts += program.cuts.len();
        open.push(name.to_owned());
        let loads: Vec<_> =
            program.module.loads().iter().map(|load| (load.module_id.to_owned(), load.span.span)).collect();
        for (wanted, span) in loads {
            let refused = |code, why: String| program.source.error(code, why, span).of_file(name);
            check_name(&wanted).map_err(|why| refused("script-file", why))?;
            if self.programs.iter().any(|(known, _)| *known == wanted) {
                continue;
            }
            if open.contains(&wanted) {
                let why = format!("'{wanted}' is loaded while it is being loaded itself");
                return Err(refused("script-file", why));
            }
            if open.len() + self.programs.len() >= MOST_FILES {
                return Err(refused("script-limit", format!("more than {MOST_FILES} files are loaded")));
            }
            let text = match files.open(&wanted, FileUse::Script, job) {
                Ok(OpenedFile::Script(text)) => text,
                Ok(OpenedFile::Shape(..)) => {
                    return Err(refused("script-file", format!("'{wanted}' is no script")));
                }
                Err(why) => {
                    return Err(refused("script-file", format!("'{wanted}' cannot be loaded: {why}")));
                }
            };
            self.add(&wanted, &text, limits, (files, job), open)?;
        }
        open.pop();
        self.programs.push((name.to_owned(), program));
        Ok(())
    }
}
