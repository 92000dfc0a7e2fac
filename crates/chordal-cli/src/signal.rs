//! The handler of Ctrl-C and SIGTERM: it stops the job, removes unfinished outputs, ends child processes, and
//! exits with 130.
use crate::fault::Exit;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// A file or a folder that the handler removes.
struct UnfinishedOutput {
    path: PathBuf,
    remove: RemoveOutput,
}

/// Removes an unfinished output.
pub type RemoveOutput = Box<dyn Fn(&Path) + Send>;

/// Unfinished outputs, in the order of their creation. Outputs are renamed or removed only under this lock.
/// The handler holds it until the exit, so that after "interrupted" nothing is committed and no error is
/// printed.
static UNFINISHED: Mutex<Vec<UnfinishedOutput>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<UnfinishedOutput>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Creates an unfinished output under the lock: a signal between its creation and its registration would
/// leave it behind.
pub fn create_unfinished<T>(
    path: &Path,
    remove: RemoveOutput,
    create: impl FnOnce() -> io::Result<T>,
) -> io::Result<T> {
    // The handler waits for this lock, so that it either finds the output registered or comes before it
    // exists.
    let mut guard = unfinished();
    let output = create()?;
    guard.push(UnfinishedOutput { path: path.to_owned(), remove });
    Ok(output)
}

/// Removes a file.
pub fn remove_file(path: &Path) {
    let _ = std::fs::remove_file(path);
}

/// Unregisters an output that is finished or removed.
pub fn forget_unfinished(path: &Path) {
    unfinished().retain(|output| output.path != path);
}

/// Runs `commit` so that the handler runs either before it or after it.
pub fn without_interruption<T>(commit: impl FnOnce() -> T) -> T {
    let guard = unfinished();
    let result = commit();
    drop(guard);
    result
}

/// A child process, shared between its waiter and the handler.
pub type SharedChild = Arc<Mutex<Child>>;

/// The child processes that the handler ends. It holds the lock until the exit, so that no further one is
/// started.
static STARTED: Mutex<StartedChildren> = Mutex::new(StartedChildren { running: Vec::new(), folder: None });

struct StartedChildren {
    running: Vec<SharedChild>,
    /// The folder that only these processes write to.
    folder: Option<PathBuf>,
}

fn started() -> MutexGuard<'static, StartedChildren> {
    STARTED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sets the folder that the handler removes once the processes have ended.
pub fn set_work_folder(folder: Option<PathBuf>) {
    started().folder = folder;
}

/// Starts a process that the handler ends.
///
/// # Errors
/// If it cannot be started.
pub fn start_child(command: &mut Command) -> io::Result<SharedChild> {
    let mut children = started();
    let child = Arc::new(Mutex::new(command.spawn()?));
    children.running.push(Arc::clone(&child));
    Ok(child)
}

/// Unregisters a process that has ended.
pub fn forget_child(child: &SharedChild) {
    started().running.retain(|other| !Arc::ptr_eq(other, child));
}

/// Kills all processes, waits for their end, and removes their folder.
fn end_children(children: &mut StartedChildren) {
    for child in &children.running {
        // Each process is waited for: one that still runs could write into the folder while it is
        // removed.
        let mut child = child.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = child.kill();
        let _ = child.wait();
    }
    if let Some(folder) = children.folder.take() {
        let _ = std::fs::remove_dir_all(folder);
    }
}

/// The text that the handler of an abort writes to stdout, if any. Prepared in advance, since the handler
/// must not allocate.
static ABORT_TEXT: OnceLock<Vec<u8>> = OnceLock::new();

/// Makes the abort after a failed allocation end with an exit code. Lists whose length depends on a file are
/// reserved in advance, and their failure ends with a message; this is for all smaller allocations. If the
/// runtime aborts for another reason, as a stack overflow, it has printed so to stderr, and the code is the
/// same.
///
/// Unfinished outputs stay under their temporary names, as after a kill: removing them would allocate.
#[cfg(unix)]
pub fn end_aborts_with_a_code() {
    let write_text = || {
        let mut rest = ABORT_TEXT.get().map_or(&[][..], |text| &text[..]);
        // A pipe may take a part at a time; if it is closed, nobody reads the rest.
        while let Ok(written) = rustix::io::write(rustix::stdio::stdout(), rest) {
            rest = &rest[written..];
            if rest.is_empty() || written == 0 {
                break;
            }
        }
    };
    // SAFETY: `write_text` only reads a text that is set once, and makes `write` system calls. It neither
    // allocates nor locks nor panics.
    let _ = unsafe { signal_hook::low_level::register(libc::SIGABRT, write_text) };
    let always = Arc::new(AtomicBool::new(true));
    // Actions run in the order of registration, so the text is written before the exit. If registering fails,
    // the system's own handling stays.
    let _ = signal_hook::flag::register_conditional_shutdown(libc::SIGABRT, Exit::Budget as i32, always);
}

/// Sets the text that an abort writes to stdout.
pub fn say_of_aborts(text: String) {
    let _ = ABORT_TEXT.set(text.into_bytes());
}

/// Other systems have no SIGABRT.
#[cfg(not(unix))]
pub fn end_aborts_with_a_code() {}

/// Installs the handler. It does not wait for the job, which could be in a long step or in a blocking read.
///
/// A failure, as with a second handler or without signals, is ignored: then the system's own handling stays,
/// and a kill leaves at most an unfinished file under its temporary name.
pub fn install(cancel: Arc<AtomicBool>) {
    let _ = ctrlc::set_handler(move || {
        // First of all, so that work that goes on during the removal ends by itself.
        cancel.store(true, Ordering::Relaxed);
        let outputs = unfinished();
        // In reverse order, since a later output may be inside an earlier one.
        outputs.iter().rev().for_each(|output| (output.remove)(&output.path));
        let mut children = started();
        end_children(&mut children);
        let _ = writeln!(std::io::stderr(), "chordal: interrupted");
        std::process::exit(Exit::Interrupted as i32);
    });
}
