//! `chordal batch`: one verb over many files, each in its own process.
mod bridge;
mod child;
mod glob;
mod inputs;
mod job;
mod manifest;
mod plan;
mod runner;
mod tally;
mod verb;
mod work;

use crate::args::{ConsoleArgs, bytes};
use crate::console::{Console, StdoutUse, print, printable};
use crate::fault::{Exit, Fault, plainly};
use crate::memory;
use crate::overwrite::OverwritePolicy;
use crate::program::Program;
use crate::signal;
use bridge::{Bridge, BridgeArgs};
use clap::Args;
use inputs::BatchInputs;
use job::output_words;
use manifest::{MANIFEST, Manifest, ManifestEntries};
use plan::{BatchItem, OutputNaming, plan};
use runner::BatchRunner;
use std::ffi::OsString;
use std::fmt::Write;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::{Duration, Instant};
use verb::BatchVerb;
use work::{BatchWork, child_words};

/// `chordal batch`
#[derive(Args, Debug)]
#[command(after_help = "\
Options of the verb come after '--', those of the batch before it. Patterns: '*' is any part of a name, '?' one
character, '**' any folders; quote them, or let the shell expand them. A folder stands for all files below it with a
known extension. Outputs have the relative paths of the inputs below DIR.

DIR/manifest.jsonl has one line for each file: hashes, words, exit code, bound, error. A file that was processed before
with the same bytes and words is skipped, so a stopped batch continues where it was. Exit code 1 means that some files
failed; the others are done.

Examples:
  chordal batch lod 'assets/**/*.glb' -o out -- --px 1
  chordal batch mesh parts -o web --to glb --jobs 4 -- --tol 0.1%
  chordal batch convert scans/*.ply -o printed --to 3mf -- --unit mm
  chordal batch inspect models -o reports -- --require solid")]
pub struct BatchArgs {
    /// The verb to run on each file
    #[arg(value_name = "VERB")]
    pub verb: BatchVerb,

    /// Files, folders and patterns
    #[arg(value_name = "IN", required = true)]
    pub inputs: Vec<PathBuf>,

    /// Folder for the outputs and the manifest; it is created if it does not exist
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,

    /// Extension of the outputs, e.g. glb, ply or 3mf, instead of the verb's usual one
    #[arg(long, value_name = "EXTENSION")]
    pub to: Option<String>,

    /// Folder that the paths of the inputs are relative to, instead of the current one
    #[arg(long, value_name = "FOLDER")]
    pub base: Option<PathBuf>,

    /// Keep the extension of the input in the name of the output: a.obj.glb
    #[arg(long)]
    pub keep_extension: bool,

    /// Number of files at once. Default: as many as there are cores, or threads of a cluster
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub jobs: Option<u64>,

    /// Maximum time for one file, in seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub timeout: Option<Duration>,

    /// Maximum memory for all files at once, e.g. 8G, shared evenly. Default: half of the machine's
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    pub max_memory: Option<u64>,

    /// Run on the workers of a Dask cluster, given its scheduler, e.g. tcp://10.0.0.1:8786. Workers need the
    /// same files and the same version; the command is that of the Python package
    #[arg(long, value_name = "ADDRESS")]
    pub dask: Option<String>,

    /// List the files and outputs, without running anything
    #[arg(long)]
    pub dry_run: bool,

    /// Process files again that are done already
    #[arg(long)]
    pub redo: bool,

    /// Overwrite outputs that were not written by a batch
    #[arg(long)]
    pub force: bool,

    /// Options of the verb
    #[arg(last = true, value_name = "OPTIONS", allow_hyphen_values = true)]
    pub options: Vec<String>,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

fn seconds(text: &str) -> Result<Duration, String> {
    let wrong = || "expected a number of seconds above 0, like 60 or 0.5".to_owned();
    let seconds: f64 = text.parse().map_err(|_| wrong())?;
    if seconds > 0.0 { Duration::try_from_secs_f64(seconds).map_err(|_| wrong()) } else { Err(wrong()) }
}

/// The services of the command that contains a batch.
#[derive(Clone, Copy)]
pub struct BatchCommand<'a> {
    /// How to start the command again.
    pub program: &'a Program,
    /// Refuses an invalid command line.
    pub check: &'a dyn Fn(Vec<OsString>) -> Result<(), Fault>,
}

/// The folder for locks and temporary files, below the output folder.
const WORK: &str = ".chordal-batch";

/// Finds the files, processes them, and prints the counts.
pub fn run(args: &BatchArgs, command: BatchCommand) -> Result<(), Fault> {
    let started = Instant::now();
    let console = Console::new(&args.console);
    let naming = OutputNaming {
        to: args.to.as_deref().map(|to| args.verb.extension_for(to)).transpose()?,
        keeps_extension: args.keep_extension,
    };
    let inputs = BatchInputs::expand(&args.inputs, args.base.as_deref(), &args.output)?;
    if inputs.left_out > 0 {
        let n = inputs.left_out;
        console.warn("folders", &[format!("files with an unknown extension were skipped ({n}x)")]);
    }
    let items = plan(inputs, args.verb, &naming)?;
    args.check_words(&items, command)?;
    let bridge = args.bridge_words(command.program)?;
    let cancel = Arc::new(AtomicBool::new(false));
    let lock = if args.dry_run { None } else { Some(BatchLock::acquire(&args.output)?) };
    signal::install(Arc::clone(&cancel));
    // Under the lock: another batch may have been adding lines until now.
    let entries = ManifestEntries::read(&args.output)?;
    if entries.n_wrong > 0 {
        let n = entries.n_wrong;
        console.warn(MANIFEST, &[format!("invalid lines were ignored ({n}x)")]);
    }
    let (runner, share) = args.runner(items.len(), command.program, bridge, &console)?;
    let work = BatchWork {
        runner,
        verb: args.verb,
        words: std::iter::once(args.verb.name().to_owned()).chain(args.options.iter().cloned()).collect(),
        share,
        folder: &args.output,
        work_folder: lock.as_ref().map_or_else(PathBuf::new, |lock| lock.work_folder.clone()),
        timeout: args.timeout,
        existing: OverwritePolicy::from_force(args.force),
        redo: args.redo,
        entries: &entries,
        cancel: &cancel,
        console: &console,
    };
    if args.dry_run {
        return print(&printable(&list(&work, &items)));
    }
    let manifest = Manifest::open(&args.output, &entries)?;
    let tally = work.run(&items, manifest)?;
    drop(lock);
    let path = args.output.join(MANIFEST).display().to_string();
    let seconds = started.elapsed().as_secs_f64();
    let text = tally.text(&args.output.display().to_string(), seconds);
    console.result(&tally.to_value(&path, seconds), &text, StdoutUse::Free)?;
    if tally.not_met() == 0 {
        return Ok(());
    }
    let message = format!("{} of {} files failed: the reasons are in {path}", tally.not_met(), tally.files);
    Err(Fault { reported: true, ..Fault::new(Exit::CheckFailed, "some-failed", message) })
}

impl BatchArgs {
    /// The words that start the client of the cluster, if `--dask` is given.
    fn bridge_words<'a>(&self, program: &'a Program) -> Result<Option<&'a [OsString]>, Fault> {
        match (&self.dask, &program.bridge) {
            (None, _) => Ok(None),
            (Some(_), Some(words)) => Ok(Some(words)),
            (Some(_), None) => Err(Fault::usage(
                "--dask needs the Python package: 'pip install chordal distributed', then 'python -m chordal batch' \
                instead of 'chordal batch'",
            )),
        }
    }

    /// The runner for a number of files, and the options for each process's share of threads and memory.
    fn runner<'a>(
        &self,
        n_files: usize,
        program: &'a Program,
        bridge: Option<&[OsString]>,
        console: &Console,
    ) -> Result<(BatchRunner<'a>, Vec<String>), Fault> {
        let given = self.jobs.map(|jobs| usize::try_from(jobs).unwrap_or(usize::MAX));
        let (Some(words), Some(address)) = (bridge, &self.dask) else {
            let jobs = given.unwrap_or_else(cores).min(n_files).max(1);
            let memory = self.max_memory.or_else(memory::default_limit).map(|bytes| bytes / jobs as u64);
            return Ok((
                BatchRunner::Here { program: &program.words, jobs },
                self.share(cores() / jobs, memory),
            ));
        };
        let shares_memory = self.max_memory.is_none() && !self.has_option("--max-memory");
        let bridge = Bridge::start(&BridgeArgs { program: words, address, jobs: given, shares_memory })?;
        if bridge.slots() == 0 {
            console.warn(address, &["the cluster has no workers: files wait until it has some"]);
        }
        // The share of memory is by the workers of this moment; a cluster that grows later does not
        // change it.
        let at_once = given.unwrap_or_else(|| bridge.slots()).max(1);
        // A cluster runs one process per thread of a worker.
        let share = self.share(1, self.max_memory.map(|bytes| bytes / at_once as u64));
        Ok((BatchRunner::Cluster(bridge), share))
    }

    /// Whether an option of the verb was given.
    fn has_option(&self, name: &str) -> bool {
        self.options.iter().any(|word| word.split('=').next() == Some(name))
    }

    /// The options for a number of threads and an amount of memory, unless the options of the verb set them.
    fn share(&self, threads: usize, memory: Option<u64>) -> Vec<String> {
        let mut share = Vec::new();
        // The verb of reports has no such option.
        if !self.verb.is_report() && !self.has_option("--threads") {
            share.extend(["--threads".to_owned(), threads.max(1).to_string()]);
        }
        if let Some(memory) = memory.filter(|_| !self.has_option("--max-memory")) {
            share.extend(["--max-memory".to_owned(), memory.max(1).to_string()]);
        }
        share
    }

    /// Refuses invalid options of the verb, once instead of for every file.
    fn check_words(&self, items: &[BatchItem], command: BatchCommand) -> Result<(), Fault> {
        for word in &self.options {
            let name = word.split('=').next().unwrap_or_default();
            if ["--to", "--output", "-o"].contains(&name) {
                let message = format!("{name} is an option of the batch: put it before the '--'");
                return Err(Fault::usage(message));
            }
        }
        let Some(item) = items.first() else { return Ok(()) };
        let mut words: Vec<OsString> = vec!["chordal".into()];
        words.extend(child_words(self.verb, &item.file.path));
        words.extend(output_words(self.verb.is_report(), &item.output));
        words.extend(self.share(1, None).iter().chain(&self.options).map(OsString::from));
        (command.check)(words)
    }
}

fn cores() -> usize {
    thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// The list of `--dry-run`.
fn list(work: &BatchWork, items: &[BatchItem]) -> String {
    let mut text = String::new();
    for item in items {
        let action = if work.is_done(item).is_some() { "skip" } else { "do  " };
        let (input, output) = (item.file.path.display(), work.folder.join(&item.output));
        // Writing to a text does not fail.
        let _ = writeln!(text, "{action} {input} -> {}", output.display());
    }
    text
}

/// The lock of an output folder. The system releases it when the process ends, even by a kill.
#[derive(Debug)]
struct BatchLock {
    /// Holds the lock as long as it is open.
    _file: File,
    /// A new folder for the processes of this batch.
    work_folder: PathBuf,
}

impl BatchLock {
    fn acquire(folder: &Path) -> Result<Self, Fault> {
        let batch_folder = folder.join(WORK);
        let failed = |error: std::io::Error| {
            Fault::output("unwritable", format!("{}: {}", folder.display(), plainly(&error)))
        };
        fs::create_dir_all(&batch_folder).map_err(failed)?;
        let file = File::options()
            .write(true)
            .create(true)
            .truncate(false)
            .open(batch_folder.join("lock"))
            .map_err(failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let message = format!("{}: another batch is using this folder", folder.display());
                return Err(Fault::output("locked", message));
            }
            Err(TryLockError::Error(error)) => return Err(failed(error)),
        }
        // Removes what a kill left. Processes of the killed batch may still be writing there, so this one
        // uses a new folder.
        for entry in fs::read_dir(&batch_folder).map_err(failed)?.flatten() {
            if entry.file_name() != "lock" {
                let _ = fs::remove_dir_all(entry.path());
            }
        }
        // The process number alone can occur again, on another machine or in a container; then a left-over
        // process of another batch could write into this one's folder.
        let mut random = [0; size_of::<u64>()];
        getrandom::fill(&mut random).map_err(|error| failed(std::io::Error::other(error)))?;
        let name = format!("{}-{:016x}", std::process::id(), u64::from_ne_bytes(random));
        let work_folder = batch_folder.join(name);
        fs::create_dir_all(&work_folder).map_err(failed)?;
        signal::set_work_folder(Some(work_folder.clone()));
        Ok(Self { _file: file, work_folder })
    }
}

impl Drop for BatchLock {
    fn drop(&mut self) {
        signal::set_work_folder(None);
        let _ = fs::remove_dir_all(&self.work_folder);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_of_time_is_a_number_of_seconds() {
        assert_eq!(seconds("0.5"), Ok(Duration::from_millis(500)));
        for text in ["", "0", "-1", "inf", "nan", "1h", "1e300"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }
}
