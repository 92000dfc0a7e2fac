//! `VerbRun`: a run of a verb that writes a file. Every such verb reads its input, writes and reports in the same way, and
//! adds its own part between these steps.
//!
//! ```text
//! start -> target -> read -> (the verb) -> made -> write -> report
//! ```
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::clock::Clock;
use crate::console::{Console, StdoutUse};
use crate::execution;
use crate::fault::{Exit, Fault};
use crate::input::InputSource;
use crate::load;
use crate::output::OutputTarget;
use crate::output_set_write::SetPlace;
use crate::overwrite::OverwritePolicy;
use crate::spelling::CommandLine;
use chordal::Job;
use chordal::budget::advice::{Message, Spell};
use chordal_verbs::report::{Certificate, Report, RunFacts};
use chordal_verbs::{Input, MeshFailure};
use std::path::PathBuf;

/// The arguments of every verb that writes a file.
#[derive(Clone, Copy, Debug)]
pub struct RunArgs<'a> {
    /// The input.
    pub input: &'a InputArgs,
    /// The output.
    pub output: &'a OutputArgs,
    /// Messages and the report.
    pub console: &'a ConsoleArgs,
}

impl RunArgs<'_> {
    /// The job that the arguments ask for.
    pub fn job(&self) -> Job {
        execution::job(self.input, self.output.threads, &Console::new(self.console))
    }
}

/// A run of a verb, from the checks before the work to the exit code.
pub struct VerbRun<'a> {
    /// The job of everything that is read and computed.
    pub job: Job,
    /// Messages and the report.
    pub console: Console,
    /// The error of a best result that is written although it does not meet the budget.
    pub unmet: Option<Fault>,
    verb: &'static str,
    args: RunArgs<'a>,
    clock: Clock,
    source: InputSource,
    stdout: StdoutUse,
    input_triangles: Option<u64>,
    /// The possible paths of the files that the input references.
    files_read: Vec<PathBuf>,
}

impl<'a> VerbRun<'a> {
    /// Starts a run.
    ///
    /// # Errors
    /// If output and report would both go to stdout.
    pub fn start(verb: &'static str, args: RunArgs<'a>) -> Result<Self, Fault> {
        Self::with_job(verb, args, args.job())
    }

    /// The same with a job of the caller, who may cancel it.
    pub fn with_job(verb: &'static str, args: RunArgs<'a>, job: Job) -> Result<Self, Fault> {
        let stdout = match (args.output.output.as_os_str() == "-", args.console.json) {
            (true, true) => return Err(Fault::usage("--json and '-o -' both write to stdout: choose one")),
            (true, false) => StdoutUse::HoldsData,
            (false, _) => StdoutUse::Free,
        };
        Ok(Self {
            job,
            console: Console::new(args.console),
            unmet: None,
            verb,
            args,
            clock: Clock::start(),
            source: InputSource::from_arg(&args.input.input),
            stdout,
            input_triangles: None,
            files_read: Vec::new(),
        })
    }

    /// The input.
    pub fn source(&self) -> &InputSource {
        &self.source
    }

    /// The name of the input in messages.
    pub fn name(&self) -> String {
        self.source.name()
    }

    /// The output file, checked before the input is read.
    pub fn target(&self) -> Result<OutputTarget, Fault> {
        self.target_over(self.args.output.existing())
    }

    /// The same with another policy for an existing file.
    pub fn target_over(&self, existing: OverwritePolicy) -> Result<OutputTarget, Fault> {
        OutputTarget::prepare(&self.args.output.output, existing, &self.source)
    }

    /// Reads the input, and refuses an output that is one of its files.
    pub fn read(&mut self) -> Result<Input, Fault> {
        let input = self.read_by(load::read)?;
        self.refuse_files(&input)?;
        Ok(input)
    }

    /// Reads the input in the verb's own way.
    pub fn read_by(
        &mut self,
        read: impl FnOnce(&InputArgs, &Job, &Console) -> Result<Input, Fault>,
    ) -> Result<Input, Fault> {
        let input = read(self.args.input, &self.job, &self.console)?;
        self.input_triangles = input.shape.n_triangles();
        self.files_read = load::files_beside(self.args.input, &input).collect();
        Ok(input)
    }

    /// Refuses an output that is one of the files of the input.
    pub fn refuse_files(&self, input: &Input) -> Result<(), Fault> {
        load::refuse_files(&self.args.output.output, self.args.input, input)
    }

    /// The result of the verb, or the error that ends the command.
    pub fn made<T>(&self, made: Result<T, MeshFailure>) -> Result<T, Fault>
    where
        Result<T, MeshFailure>: Spell,
    {
        made.spelled(&CommandLine).map_err(|failure| Fault::from_failure(&self.name(), &failure))
    }

    /// Continues with a best result if it is to be kept; `why` says why it does not meet the budget, if so.
    ///
    /// # Errors
    /// If it is not to be kept.
    pub fn keep_best(&mut self, why: Option<&Message>, is_kept: bool) -> Result<(), Fault> {
        let Some(why) = why else { return Ok(()) };
        let hint = if is_kept { "" } else { "; --keep-best writes it" };
        let fault = Fault::new(Exit::Budget, "unmet", format!("{}: {why}{hint}", self.name()));
        if !is_kept {
            return Err(fault);
        }
        self.unmet = Some(fault);
        Ok(())
    }

    /// Where a result goes that may be several files.
    pub fn place<'b>(&'b self, target: &'b OutputTarget, names_files: bool) -> SetPlace<'b> {
        let (input, beside) = (&*self.args.input.input, &*self.files_read);
        SetPlace { target, input, beside, console: &self.console, names_files }
    }

    /// Prints the notes, if verbose, of a verb whose summary does not list them.
    pub fn print_notes(&self, certificate: &Certificate) {
        certificate.notes.iter().for_each(|note| self.console.detail(note));
    }

    /// Prints the report or its summary; `output` and `bytes` are the name and the size of what was written.
    ///
    /// # Errors
    /// If stdout cannot be written, or a best result was kept that does not meet the budget.
    pub fn report(
        self,
        certificate: Certificate,
        (output, bytes): (String, u64),
        summary: impl FnOnce(&Report) -> String,
    ) -> Result<(), Fault> {
        let run = RunFacts {
            verb: self.verb,
            input: Some(self.name()),
            output: Some(output),
            bytes: Some(bytes),
            input_triangles: self.input_triangles,
            ..RunFacts::default()
        };
        let report = Report::new(certificate, self.clock.fill(run, &self.job));
        self.console.result(&report, &summary(&report), self.stdout)?;
        self.unmet.map_or(Ok(()), |fault| Err(Fault { reported: true, ..fault }))
    }
}
