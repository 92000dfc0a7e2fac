//! Runs a verb in its own process, so that a crash does not affect other files.
use super::job::JobEnd;
use crate::signal;
use std::io::{self, Read};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::PoisonError;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Runs a command to its end, or until the timeout.
///
/// # Errors
/// If it cannot be started.
pub fn run(command: &mut Command, timeout: Option<Duration>) -> io::Result<JobEnd> {
    let started = Instant::now();
    let child =
        signal::start_child(command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()))?;
    let lock = || child.lock().unwrap_or_else(PoisonError::into_inner);
    let stdout = lock().stdout.take();
    let stderr = lock().stderr.take();
    let (sender, receiver) = channel();
    let mut end = JobEnd::default();
    let status = thread::scope(|scope| {
        let other = sender.clone();
        // Both at once: a process that has filled one pipe waits until somebody reads it.
        let stdout = scope.spawn(move || drain(stdout, &sender));
        let stderr = scope.spawn(move || drain(stderr, &other));
        // Both streams close when the process ends. Waiting for them instead of for the process leaves its
        // lock free, so that the signal handler can end it.
        for _ in 0..2 {
            let left = timeout.map(|timeout| timeout.saturating_sub(started.elapsed()));
            let waited = match left {
                Some(left) => receiver.recv_timeout(left),
                None => receiver.recv().map_err(RecvTimeoutError::from),
            };
            if waited == Err(RecvTimeoutError::Timeout) {
                // Fails harmlessly if the process has just ended by itself.
                let _ = lock().kill();
                end.timed_out(timeout);
                break;
            }
        }
        end.stdout = stdout.join().unwrap_or_default();
        end.stderr = stderr.join().unwrap_or_default();
        lock().wait()
    });
    signal::forget_child(&child);
    let status = status?;
    if end.why.is_none() {
        end.exit = status.code();
        end.why = if end.exit.is_none() { Some(signal_text(status)) } else { None };
    }
    Ok(end)
}

/// Reads to the end, and signals it.
fn drain(source: Option<impl Read>, sender: &Sender<()>) -> Vec<u8> {
    let mut bytes = Vec::new();
    if let Some(mut source) = source {
        // After an error the bytes read so far are kept.
        let _ = source.read_to_end(&mut bytes);
    }
    let _ = sender.send(());
    bytes
}

#[cfg(unix)]
fn signal_text(status: ExitStatus) -> String {
    use std::os::unix::process::ExitStatusExt;
    let by = status.signal().map_or_else(String::new, |number| format!(" by signal {number}"));
    format!("the process was ended{by}, as when memory runs out")
}

#[cfg(not(unix))]
fn signal_text(_: ExitStatus) -> String {
    "the process was ended from outside".to_owned()
}
