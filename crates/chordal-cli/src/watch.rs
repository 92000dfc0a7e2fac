//! `--watch` of `chordal mesh`: meshes again whenever an input file changes, until a signal ends the process.
use crate::console::{self, Console};
use crate::fault::{Exit, Fault};
use crate::mesh::{self, MeshArgs, MeshRound};
use crate::overwrite::OverwritePolicy;
use chordal::Job;
use chordal::budget::RequiredEvidence;
use chordal_io::Format;
use chordal_verbs::FormatHint;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, SystemTime};

/// The interval at which files are checked. Chosen: hardly noticeable as a delay, and next to no work.
const INTERVAL: Duration = Duration::from_millis(150);

/// Meshes and waits for a change, in a loop.
///
/// # Errors
/// If the command line is invalid or the output cannot be written, which a change of the input cannot fix.
pub fn run(args: &MeshArgs) -> Result<(), Fault> {
    let names = [&args.input.input, &args.output.output].into_iter().chain(args.boolean.paths());
    if names.into_iter().any(|name| name.as_os_str() == "-") {
        return Err(Fault::usage("--watch needs files, which it reads again: '-' is none"));
    }
    let console = Console::new(&args.console);
    let files = WatchedFiles::default();
    let mut existing = args.output.existing();
    loop {
        // Stamps are taken before the files are read, so that a change during the reading counts as one
        // after it.
        files.forget();
        files.add([&args.input.input].into_iter().chain(args.boolean.paths()).cloned());
        for require in attempts(args) {
            match attempt(args, (require, existing), &files) {
                // From now on the output is this command's own.
                Ok(()) => existing = OverwritePolicy::Replace,
                // A change of the files cancelled the job.
                // A signal ends the process by itself, without coming back here.
                Err(fault) if fault.exit == Exit::Interrupted => break,
                Err(fault) if matches!(fault.exit, Exit::Input | Exit::Budget) => {
                    // The best result was written nevertheless.
                    if fault.reported {
                        existing = OverwritePolicy::Replace;
                    }
                    console::fail(&fault, args.console.json);
                    break;
                }
                Err(fault) => return Err(fault),
            }
        }
        // Otherwise the next round begins at once, and the line would be wrong.
        if !files.have_changed() {
            console.say("waiting for a change; Ctrl-C stops");
        }
        files.wait_for_change();
    }
}

/// The evidence to require, in order: a field gets a quick draft first.
fn attempts(args: &MeshArgs) -> Vec<Option<RequiredEvidence>> {
    let name = args.input.input.to_string_lossy();
    let hint = FormatHint { name: Some(&name), format: args.input.read.from, ..FormatHint::default() };
    let is_field = hint.format_of(&[]).is_some_and(Format::holds_fields);
    match args.options.require() {
        None if is_field && args.boolean.operands.is_empty() => vec![Some(RequiredEvidence::Estimated), None],
        require => vec![require],
    }
}

/// Meshes once; a change of the files cancels it.
fn attempt(
    args: &MeshArgs,
    (require, existing): (Option<RequiredEvidence>, OverwritePolicy),
    files: &WatchedFiles,
) -> Result<(), Fault> {
    let job = mesh::job(args);
    let is_over = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| files.cancel_on_change(&job, &is_over));
        let result = mesh::run_once(
            args,
            &MeshRound { job: &job, existing, require, on_files: &|paths| files.add(paths) },
        );
        // The scope waits for the other thread, which would watch for ever.
        is_over.store(true, Ordering::Relaxed);
        result
    })
}

/// The watched files, with their stamps when they were read.
#[derive(Debug, Default)]
struct WatchedFiles(Mutex<BTreeMap<PathBuf, Option<FileStamp>>>);

/// The modification time and the size of a file; `None` if there is no file.
type FileStamp = (SystemTime, u64);

impl WatchedFiles {
    /// Watches more files.
    fn add(&self, paths: impl IntoIterator<Item = PathBuf>) {
        let mut files = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for path in paths {
            let stamp = stamp(&path);
            // The first stamp stays: a file that is named again may have changed since it was read.
            files.entry(path).or_insert(stamp);
        }
    }

    fn forget(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }

    fn have_changed(&self) -> bool {
        let files = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        files.iter().any(|(path, seen)| stamp(path) != *seen)
    }

    fn cancel_on_change(&self, job: &Job, is_over: &AtomicBool) {
        while !is_over.load(Ordering::Relaxed) {
            if self.have_changed() {
                return job.cancel();
            }
            // Shorter than the interval: the end of a job waits for this thread.
            thread::sleep(INTERVAL / 10);
        }
    }

    /// Returns when files have changed and then stayed the same for an interval: editors write in several
    /// steps.
    fn wait_for_change(&self) {
        while !self.have_changed() {
            thread::sleep(INTERVAL);
        }
        // A copy, since the lock is not to be held while this sleeps.
        let paths: Vec<PathBuf> =
            self.0.lock().unwrap_or_else(PoisonError::into_inner).keys().cloned().collect();
        let stamps = || paths.iter().map(|path| stamp(path)).collect::<Vec<_>>();
        let mut seen = stamps();
        loop {
            thread::sleep(INTERVAL);
            let now = stamps();
            if now == seen {
                return;
            }
            seen = now;
        }
    }
}

fn stamp(path: &Path) -> Option<FileStamp> {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}
