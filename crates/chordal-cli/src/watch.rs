//! `--watch` of `chordal mesh`: meshes again whenever a file that the result was made of changes, until a signal
//! ends the process.
use crate::console::{self, Console};
use crate::execution;
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

/// How often files are looked at. Chosen: sooner than one notices, and next to no work.
const INTERVAL: Duration = Duration::from_millis(150);

/// Meshes, waits for a change, and so on.
///
/// # Errors
/// When the command line makes no sense or the output cannot be written: what a change of the input cannot mend.
pub fn run(args: &MeshArgs) -> Result<(), Fault> {
    let names = [&args.input.input, &args.output.output].into_iter().chain(args.boolean.paths());
    if names.into_iter().any(|name| name.as_os_str() == "-") {
        return Err(Fault::usage("--watch needs files that it can look at again: '-' is none"));
    }
    let console = Console::new(&args.console);
    let files = WatchedFiles::default();
    let mut existing = execution::existing(&args.output);
    loop {
        files.forget();
        files.add([&args.input.input].into_iter().chain(args.boolean.paths()).cloned());
        for require in attempts(args) {
            match attempt(args, (require, existing), &files) {
                Ok(()) => existing = OverwritePolicy::Replace,
                // The files changed in the middle.
                Err(fault) if fault.exit == Exit::Interrupted => break,
                Err(fault) if matches!(fault.exit, Exit::Input | Exit::Budget) => {
                    // The best result was written all the same.
                    if fault.reported {
                        existing = OverwritePolicy::Replace;
                    }
                    console::fail(&fault, args.console.json);
                    break;
                }
                Err(fault) => return Err(fault),
            }
        }
        if !files.have_changed() {
            console.say("waiting for a change; Ctrl-C ends");
        }
        files.wait_for_change();
    }
}

/// What evidence is asked for, one after the other: of a field a draft is there at once.
fn attempts(args: &MeshArgs) -> Vec<Option<RequiredEvidence>> {
    let name = args.input.input.to_string_lossy();
    let hint = FormatHint { name: Some(&name), format: args.input.read.from, ..FormatHint::default() };
    let is_field = matches!(hint.format_of(&[]), Some(Format::Star | Format::Vm));
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
        let made = mesh::run_once(
            args,
            &MeshRound { job: &job, existing, require, on_files: &|paths| files.add(paths) },
        );
        is_over.store(true, Ordering::Relaxed);
        made
    })
}

/// Files, and as what they were read.
#[derive(Debug, Default)]
struct WatchedFiles(Mutex<BTreeMap<PathBuf, Option<FileStamp>>>);

/// When a file was changed last, and its size; `None` stands for no file.
type FileStamp = (SystemTime, u64);

impl WatchedFiles {
    /// Names more files.
    fn add(&self, paths: impl IntoIterator<Item = PathBuf>) {
        let mut files = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for path in paths {
            let stamp = stamp(&path);
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
            // As long as a short job takes at most, so that it does not wait for this.
            thread::sleep(INTERVAL / 10);
        }
    }

    /// Returns when files have changed, and change no more: editors write in several steps.
    fn wait_for_change(&self) {
        while !self.have_changed() {
            thread::sleep(INTERVAL);
        }
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
