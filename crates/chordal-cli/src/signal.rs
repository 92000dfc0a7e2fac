//! What Ctrl-C and SIGTERM do: stop the job, remove what is unfinished, end processes that were started, exit
//! with 130.
use crate::fault::Exit;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// A file or a folder that a signal removes.
struct UnfinishedOutput {
    path: PathBuf,
    remove: RemoveOutput,
}

/// How it is removed.
pub type RemoveOutput = Box<dyn Fn(&Path) + Send>;

/// What is unfinished, in the order in which it was made. Whoever holds the lock may rename or remove it; the
/// handler holds it until the exit, so that nothing is committed after "interrupted" was said, and no failure
/// told.
static UNFINISHED: Mutex<Vec<UnfinishedOutput>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<UnfinishedOutput>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Creates what a signal removes, such that a signal comes either before there is one or after it is named: in
/// between it would stay.
pub fn create_unfinished<T>(
    path: &Path,
    remove: RemoveOutput,
    create: impl FnOnce() -> io::Result<T>,
) -> io::Result<T> {
    let mut guard = unfinished();
    let made = create()?;
    guard.push(UnfinishedOutput { path: path.to_owned(), remove });
    Ok(made)
}

/// A file is removed by its name.
pub fn remove_file(path: &Path) {
    let _ = std::fs::remove_file(path);
}

/// Says that there is nothing of this name to remove any more.
pub fn forget_unfinished(path: &Path) {
    unfinished().retain(|output| output.path != path);
}

/// Runs `commit` such that a signal comes either before it or after it.
pub fn without_interruption<T>(commit: impl FnOnce() -> T) -> T {
    let guard = unfinished();
    let done = commit();
    drop(guard);
    done
}

/// A process that was started, which its waiter and the handler share.
pub type SharedChild = Arc<Mutex<Child>>;

/// What a signal ends and removes. The handler holds the lock until the exit, so that nothing is started
/// after it.
static STARTED: Mutex<StartedChildren> = Mutex::new(StartedChildren { running: Vec::new(), folder: None });

struct StartedChildren {
    running: Vec<SharedChild>,
    /// Where the processes write, and nothing else stands.
    folder: Option<PathBuf>,
}

fn started() -> MutexGuard<'static, StartedChildren> {
    STARTED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Names the folder that a signal removes once the processes are ended.
pub fn set_work_folder(folder: Option<PathBuf>) {
    started().folder = folder;
}

/// Starts a process that a signal ends.
///
/// # Errors
/// When it cannot be started.
pub fn start_child(command: &mut Command) -> io::Result<SharedChild> {
    let mut all = started();
    let child = Arc::new(Mutex::new(command.spawn()?));
    all.running.push(Arc::clone(&child));
    Ok(child)
}

/// Says that a process is over.
pub fn forget_child(child: &SharedChild) {
    started().running.retain(|other| !Arc::ptr_eq(other, child));
}

/// Ends all processes, waits for their end, and removes what they wrote.
fn end_children(all: &mut StartedChildren) {
    for child in &all.running {
        let mut child = child.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = child.kill();
        let _ = child.wait();
    }
    if let Some(folder) = all.folder.take() {
        let _ = std::fs::remove_dir_all(folder);
    }
}

/// What the abort of a failed allocation writes to stdout, once something is to be written: prepared in advance, for
/// the handler may not allocate.
static SAID_OF_ABORTS: OnceLock<Vec<u8>> = OnceLock::new();

/// Makes an exit code of the abort with which a failed allocation ends the process. Lists whose length a file decides
/// are reserved in advance and end in a sentence; this is for the small ones between them. Where the runtime aborts for
/// another reason (a stack that ran over) it has said so on stderr, and the code is the same.
///
/// What is unfinished stays under its own name, as after a kill: nothing may be allocated any more to remove it.
#[cfg(unix)]
pub fn end_aborts_with_a_code() {
    let say = || {
        let mut rest = SAID_OF_ABORTS.get().map_or(&[][..], |text| &text[..]);
        while let Ok(written) = rustix::io::write(rustix::stdio::stdout(), rest) {
            rest = &rest[written..];
            if rest.is_empty() || written == 0 {
                break;
            }
        }
    };
    // SAFETY: `say` reads what was written before it was shared, and makes system calls for writing. It neither allocates
    // nor locks nor panics.
    let _ = unsafe { signal_hook::low_level::register(libc::SIGABRT, say) };
    let always = Arc::new(AtomicBool::new(true));
    // Actions run in the order in which they were registered. A system without such a handler keeps its own.
    let _ = signal_hook::flag::register_conditional_shutdown(libc::SIGABRT, Exit::Budget as i32, always);
}

/// From now on such an abort writes this to stdout first.
pub fn say_of_aborts(text: String) {
    let _ = SAID_OF_ABORTS.set(text.into_bytes());
}

/// Other systems have no such signal.
#[cfg(not(unix))]
pub fn end_aborts_with_a_code() {}

/// Installs the handler. It does not wait for the job, which could be in a long step or in a blocking read.
///
/// A second handler, or a system without signals, is no reason to fail: then the system's own handling stays,
/// and what a kill leaves behind is at most the unfinished file under its own name.
pub fn install(cancel: Arc<AtomicBool>) {
    let _ = ctrlc::set_handler(move || {
        cancel.store(true, Ordering::Relaxed);
        let all = unfinished();
        // What was made last may stand in what was made before.
        all.iter().rev().for_each(|output| (output.remove)(&output.path));
        let mut children = started();
        end_children(&mut children);
        let _ = writeln!(std::io::stderr(), "chordal: interrupted");
        std::process::exit(Exit::Interrupted as i32);
    });
}
