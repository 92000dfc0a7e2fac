//! The work of a batch: runs a process for each file, several at once, records each result, and puts outputs
//! in place.
use super::job::{BatchJob, JobEnd, JobFault};
use super::manifest::{Manifest, ManifestEntries, ManifestEntry};
use super::plan::BatchItem;
use super::runner::BatchRunner;
use super::tally::{BatchProgress, BatchTally};
use super::verb::BatchVerb;
use crate::console::Console;
use crate::fault::{Exit, Fault, plainly};
use crate::input::InputSource;
use crate::overwrite::{OverwritePolicy, refuse_input, refuse_occupied};
use chordal_verbs::sha256_of;
use serde_json::Value;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, Scope};
use std::time::{Duration, Instant};

/// The most files whose errors are printed; the manifest has all. Chosen: more would push the first off a
/// screen.
const MOST_PRINTED: u64 = 10;

/// The settings for all files of a batch.
#[derive(Debug)]
pub struct BatchWork<'a> {
    /// Runs the processes.
    pub runner: BatchRunner<'a>,
    /// The verb.
    pub verb: BatchVerb,
    /// The verb with its options, as in the manifest.
    pub words: Vec<String>,
    /// The options for each process's share of threads and memory.
    pub share: Vec<String>,
    /// The output folder.
    pub folder: &'a Path,
    /// The folder that processes write to before outputs are put in place.
    pub work_folder: PathBuf,
    /// The time limit of a process.
    pub timeout: Option<Duration>,
    /// What happens to existing files that no batch wrote.
    pub existing: OverwritePolicy,
    /// Whether files are processed again that are done already.
    pub redo: bool,
    /// The entries of earlier runs.
    pub entries: &'a ManifestEntries,
    /// Set by a signal.
    pub cancel: &'a AtomicBool,
    /// Prints messages.
    pub console: &'a Console,
}

/// The outcome of one file.
enum ItemEnd {
    /// It was done by an earlier run.
    Skipped(Box<ManifestEntry>),
    /// It was processed now; the path is that of its output in the work folder, if there is one.
    Done(Box<ManifestEntry>, Option<PathBuf>),
    /// A signal stopped the batch, or no file can be processed any more.
    Stopped(Fault),
}

/// The state that the threads share.
struct BatchState {
    manifest: Manifest,
    tally: BatchTally,
    progress: BatchProgress,
    /// Why no further item is started.
    fault: Option<Fault>,
    /// The number of items that were started.
    n_started: usize,
    /// The number of threads, each of which waits for the end of an item.
    n_threads: usize,
}

impl BatchWork<'_> {
    /// Processes all items, as many at once as the runner takes, and returns the counts.
    ///
    /// # Errors
    /// If the manifest cannot be written, a cluster fails, or a signal stopped the batch.
    pub fn run(&self, items: &[BatchItem], manifest: Manifest) -> Result<BatchTally, Fault> {
        let sizes: Vec<u64> = items
            .iter()
            .map(|item| fs::metadata(&item.file.path).map_or(0, |metadata| metadata.len()))
            .collect();
        let state = Mutex::new(BatchState {
            manifest,
            tally: BatchTally { files: items.len() as u64, ..BatchTally::default() },
            progress: BatchProgress::new(sizes.iter().sum(), self.console.shows_progress()),
            fault: None,
            n_started: 0,
            n_threads: 0,
        });
        let shared = SharedWork { work: self, items, sizes: &sizes, state: &state };
        thread::scope(|scope| shared.start_threads(scope));
        let state = state.into_inner().unwrap_or_else(PoisonError::into_inner);
        state.progress.finish();
        state.fault.map_or(Ok(state.tally), Err)
    }

    /// The entry of an earlier run with the same bytes, words and version, if its output still exists.
    pub fn is_done(&self, item: &BatchItem) -> Option<&ManifestEntry> {
        let entry = self.entries.by_input.get(&item.input_name).filter(|_| !self.redo)?;
        // Files that the input or an option refers to are in no entry, and are not compared.
        let is_same = entry.exit == Some(0)
            && entry.words == self.words
            && entry.version == VERSION
            && entry.output == item.output_name;
        let has = |path: &Path, sha256: &Option<String>| sha256.is_some() && digest(path).ok() == *sha256;
        let output = self.folder.join(&item.output);
        // Digests come last, since they read both files as a whole.
        (is_same && has(&item.file.path, &entry.input_sha256) && has(&output, &entry.output_sha256))
            .then_some(entry)
    }

    fn item(&self, number: usize, item: &BatchItem) -> ItemEnd {
        if let Some(entry) = self.is_done(item) {
            return ItemEnd::Skipped(Box::new(entry.clone()));
        }
        let started = Instant::now();
        let mut entry = ManifestEntry {
            input: item.input_name.clone(),
            version: VERSION.to_owned(),
            words: self.words.clone(),
            output: item.output_name.clone(),
            ..ManifestEntry::default()
        };
        let fail = |mut entry: ManifestEntry, fault: &Fault| {
            entry.input_sha256 = digest(&item.file.path).ok();
            entry.exit = Some(fault.exit as i32);
            entry.code = Some(fault.code.to_owned());
            entry.error = Some(fault.lines.join("; "));
            entry.seconds = started.elapsed().as_secs_f64();
            ItemEnd::Done(Box::new(entry), None)
        };
        let output = self.folder.join(&item.output);
        let input = InputSource::File(item.file.path.clone());
        // Before the work, to save it; checked again when the output is put in place.
        let refused =
            refuse_input(&output, &input).and_then(|()| refuse_occupied(&output, self.existing(item)));
        if let Err(fault) = refused {
            return fail(entry, &fault);
        }
        let end = match self.runner.run(&self.job(number, item)) {
            Ok(end) => end,
            Err(JobFault::File(fault)) => return fail(entry, &fault),
            Err(JobFault::Batch(fault)) => return ItemEnd::Stopped(fault),
        };
        if self.cancel.load(Ordering::Relaxed) || end.exit == Some(Exit::Interrupted as i32) {
            return ItemEnd::Stopped(Fault::interrupted());
        }
        let output = end.output.clone();
        if self.verb.is_report()
            && is_report(&end.stdout)
            && let Err(error) = fs::write(&output, &end.stdout)
        {
            return fail(
                entry,
                &Fault::output("unwritable", format!("{}: {}", output.display(), plainly(&error))),
            );
        }
        describe(&mut entry, &end);
        // A killed process may leave an incomplete file, which is no output.
        entry.output_sha256 = end.exit.and_then(|_| digest(&output).ok());
        // From the report if there is one: that is of the bytes that were really read.
        entry.input_sha256 = entry.input_sha256.take().or_else(|| digest(&item.file.path).ok());
        if entry.exit == Some(0) && entry.output_sha256.is_none() {
            return fail(entry, &Fault::output("no-output", "the verb succeeded but wrote no output"));
        }
        entry.seconds = end.seconds.unwrap_or_else(|| started.elapsed().as_secs_f64());
        let output = entry.output_sha256.is_some().then_some(output);
        ItemEnd::Done(Box::new(entry), output)
    }

    /// What happens to existing files of an item's names.
    fn existing(&self, item: &BatchItem) -> OverwritePolicy {
        let is_ours = self.entries.outputs.contains(&item.output_name);
        if is_ours { OverwritePolicy::Replace } else { self.existing }
    }

    fn job(&self, number: usize, item: &BatchItem) -> BatchJob<'_> {
        let tail = self.share.iter().chain(&self.words[1..]).map(OsString::from).collect();
        BatchJob {
            number,
            input: item.file.path.clone(),
            name: item.output.file_name().unwrap_or_default().to_owned(),
            is_report: self.verb.is_report(),
            head: child_words(self.verb, &item.file.path),
            tail,
            work_folder: &self.work_folder,
            timeout: self.timeout,
        }
    }

    /// Records a file and then puts its output in place. A kill between the two leaves an entry without an
    /// output, so the file is processed again.
    fn record(
        &self,
        item: &BatchItem,
        end: ItemEnd,
        bytes: u64,
        state: &mut BatchState,
    ) -> Result<(), Fault> {
        let (entry, is_skipped) = match end {
            ItemEnd::Stopped(fault) => return Err(fault),
            ItemEnd::Skipped(entry) => (entry, true),
            ItemEnd::Done(mut entry, temp_output) => {
                state.manifest.append(&entry)?;
                let output = self.folder.join(&item.output);
                let placed =
                    temp_output.map_or(Ok(()), |temp| put_in_place(&temp, &output, self.existing(item)));
                if let Err(fault) = placed {
                    entry.output_sha256 = None;
                    entry.exit = Some(fault.exit as i32);
                    entry.code = Some(fault.code.to_owned());
                    entry.error = Some(fault.lines.join("; "));
                    // A second line, which replaces the first one for whoever reads the manifest.
                    state.manifest.append(&entry)?;
                }
                (entry, false)
            }
        };
        state.tally.add(&entry, is_skipped);
        state.progress.advance(bytes, is_skipped, &state.tally);
        let seconds = entry.seconds;
        state.progress.aside(|| match &entry.error {
            _ if is_skipped => self.console.detail(&format!("{}: already done", entry.input)),
            Some(error) if state.tally.not_met() <= MOST_PRINTED => {
                self.console.failure(&error_text(&entry, error));
            }
            Some(error) => self.console.detail(&error_text(&entry, error)),
            None => self.console.detail(&format!("{} -> {}: {seconds:.2} s", entry.input, entry.output)),
        });
        Ok(())
    }
}

/// The version of this program; outputs of other versions are made again.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The data of all threads.
#[derive(Clone, Copy)]
struct SharedWork<'a, 'b> {
    work: &'a BatchWork<'b>,
    items: &'a [BatchItem],
    sizes: &'a [u64],
    state: &'a Mutex<BatchState>,
}

impl<'scope> SharedWork<'scope, '_> {
    /// Starts threads up to the number of files that the runner takes at once, or that are left.
    fn start_threads(self, scope: &'scope Scope<'scope, '_>) {
        let mut state = lock(self.state);
        // At most as many threads as items are running or left.
        let wanted = self.work.runner.at_once().min(self.items.len() - state.n_started + state.n_threads);
        while state.n_threads < wanted && state.fault.is_none() {
            state.n_threads += 1;
            scope.spawn(move || self.run_items(scope));
        }
    }

    /// Runs one item after the other, until there are no more, or the runner takes fewer at once. If the
    /// runner takes more, starts more threads: a cluster grows and shrinks.
    fn run_items(self, scope: &'scope Scope<'scope, '_>) {
        while let Some(number) = self.next() {
            let item = &self.items[number];
            let end = self.work.item(number, item);
            {
                // The lock is given back before other threads are started, which needs it again.
                let mut state = lock(self.state);
                if let Err(fault) = self.work.record(item, end, self.sizes[number], &mut state) {
                    state.fault.get_or_insert(fault);
                }
            }
            self.start_threads(scope);
        }
    }

    /// The next item for this thread; `None` if the thread should end.
    fn next(self) -> Option<usize> {
        let mut state = lock(self.state);
        let is_wanted = state.n_threads <= self.work.runner.at_once() && state.fault.is_none();
        if !is_wanted || state.n_started == self.items.len() {
            state.n_threads -= 1;
            return None;
        }
        state.n_started += 1;
        Some(state.n_started - 1)
    }
}

/// The words of the verb for one file, before those of its output.
pub fn child_words(verb: BatchVerb, input: &Path) -> Vec<OsString> {
    // A name with a leading `-` would be taken for an option.
    let is_dashed = input.as_os_str().as_encoded_bytes().starts_with(b"-");
    let input = if is_dashed { Path::new(".").join(input) } else { input.to_owned() };
    vec![verb.name().into(), input.into(), "--json".into()]
}

/// The error message, which names the file if the verb's error does not.
fn error_text(entry: &ManifestEntry, error: &str) -> String {
    if error.contains(&entry.input) { error.to_owned() } else { format!("{}: {error}", entry.input) }
}

fn lock(state: &Mutex<BatchState>) -> MutexGuard<'_, BatchState> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

fn digest(path: &Path) -> io::Result<String> {
    sha256_of(&mut File::open(path)?)
}

/// Whether a process printed a report.
fn is_report(stdout: &[u8]) -> bool {
    let report: Option<Value> = serde_json::from_slice(stdout).ok();
    report.is_some_and(|report| report.get("certificate").is_some())
}

/// Fills an entry from the report and the end of a process.
fn describe(entry: &mut ManifestEntry, end: &JobEnd) {
    let report: Value = serde_json::from_slice(&end.stdout).unwrap_or_default();
    let text = |pointer: &str| report.pointer(pointer).and_then(Value::as_str).map(str::to_owned);
    let count = |pointer: &str| report.pointer(pointer).and_then(Value::as_u64);
    entry.exit = end.exit;
    entry.input_sha256 = text("/certificate/input/sha256");
    entry.bound = report.pointer("/certificate/bound/at_most").and_then(Value::as_f64);
    entry.triangles_in = count("/run/input_triangles");
    entry.triangles_out = count("/certificate/output/triangles");
    entry.code = end.code.clone().or_else(|| text("/error/code"));
    if end.exit == Some(0) {
        return;
    }
    let messages = report.pointer("/error/messages").and_then(Value::as_array);
    let messages: Vec<&str> = messages.into_iter().flatten().filter_map(Value::as_str).collect();
    let message = (!messages.is_empty()).then(|| messages.join("; "));
    entry.error = end.why.clone().or(message).or_else(|| last_line(&end.stderr));
    entry.error.get_or_insert_with(|| format!("the process ended with {}", end.exit.unwrap_or_default()));
}

/// The last line of stderr, without the program's prefix.
fn last_line(stderr: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(stderr);
    let line = text.lines().rev().find(|line| !line.trim().is_empty())?;
    Some(line.strip_prefix("chordal: ").unwrap_or(line).to_owned())
}

/// Moves an output to its path, after its side files: a material library, a buffer, images.
fn put_in_place(temp_output: &Path, output: &Path, existing: OverwritePolicy) -> Result<(), Fault> {
    let folder = output.parent().unwrap_or(Path::new("."));
    let staging = temp_output.parent().unwrap_or(Path::new("."));
    let failed = |path: &Path| {
        let name = path.display().to_string();
        move |error: io::Error| Fault::output("unwritable", format!("{name}: {}", plainly(&error)))
    };
    fs::create_dir_all(folder).map_err(failed(folder))?;
    let mut beside = Vec::new();
    for entry in fs::read_dir(staging).map_err(failed(staging))? {
        let path = entry.map_err(failed(staging))?.path();
        if path != temp_output {
            beside.push((folder.join(path.file_name().unwrap_or_default()), path));
        }
    }
    beside.sort();
    // All are checked before the first one moves.
    beside.iter().try_for_each(|(to, _)| refuse_occupied(to, existing))?;
    for (to, path) in &beside {
        fs::rename(path, to).map_err(failed(to))?;
    }
    fs::rename(temp_output, output).map_err(failed(output))?;
    // The folder is empty now.
    let _ = fs::remove_dir(staging);
    Ok(())
}
