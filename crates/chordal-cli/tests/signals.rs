//! Signals at any moment: the output is the old file or the whole new one.
#![cfg(unix)]
mod common;

use common::{Folder, TEAPOT, chordal, run};
use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// A job of about a second, which writes some megabytes.
fn start(output: &str) -> Child {
    let args = ["mesh", TEAPOT, "-o", output, "--tol", "2e-5", "--force", "-q"];
    chordal(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn send(signal: &str, child: &Child) {
    // The process may be over by now, which is one of the moments to try.
    let _ = Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status();
}

/// The bytes that the job writes when nobody disturbs it.
fn undisturbed(folder: &Folder) -> Vec<u8> {
    let output = folder.text("undisturbed.ply");
    assert!(start(&output).wait().unwrap().success());
    fs::read(output).unwrap()
}

#[test]
fn h80_a_signal_at_any_moment_leaves_the_old_file_or_the_whole_new_one() {
    let folder = Folder::new("h80-polite");
    let new = undisturbed(&folder);
    let output = folder.file("a.ply", "old");
    let mut interrupted = 0;
    // Moments spread over the job, whatever its speed is here; none of them is expected to hit anything.
    for step in 0..16 {
        let signal = if step % 2 == 0 { "-INT" } else { "-TERM" };
        fs::write(&output, "old").unwrap();
        let mut child = start(&output);
        sleep(Duration::from_millis(25 * step));
        send(signal, &child);
        let code = child.wait().unwrap().code();
        let found = fs::read(&output).unwrap();
        match code {
            Some(0) => assert!(found == new, "{signal} after {step} steps: done, but another file"),
            // Before the handler stands, the system's own handling ends the process, and nothing was begun.
            Some(130) | None => {
                interrupted += 1;
                assert!(found == b"old" || found == new, "{signal} after {step} steps: half a file");
            }
            other => panic!("{signal} after {step} steps: exit {other:?}"),
        }
        assert_eq!(folder.names(), ["a.ply", "undisturbed.ply"], "{signal} after {step} steps");
    }
    assert!(interrupted > 0, "no signal came before the end of any job");
}

#[test]
fn h80_a_kill_at_any_moment_leaves_the_old_file_or_the_whole_new_one() {
    let folder = Folder::new("h80-kill");
    let new = undisturbed(&folder);
    let output = folder.file("a.ply", "old");
    for step in 0..16 {
        fs::write(&output, "old").unwrap();
        let mut child = start(&output);
        sleep(Duration::from_millis(25 * step));
        send("-KILL", &child);
        child.wait().unwrap();
        let found = fs::read(&output).unwrap();
        assert!(found == b"old" || found == new, "after {step} steps: half a file");
        // What a kill leaves behind says by its name what it is.
        let left: Vec<_> =
            folder.names().into_iter().filter(|n| n != "a.ply" && n != "undisturbed.ply").collect();
        assert!(left.iter().all(|name| name.starts_with(".chordal-") && name.ends_with(".tmp")), "{left:?}");
    }
    // The job is done again as if nothing had been.
    run(&["mesh", TEAPOT, "-o", &output, "--tol", "2e-5", "--force", "-q"]).succeeds();
    assert!(fs::read(&output).unwrap() == new);
}

#[test]
fn h80_two_jobs_on_one_output_leave_one_whole_file() {
    let folder = Folder::new("h80-two");
    let new = undisturbed(&folder);
    let output = folder.text("a.ply");
    let mut children: Vec<_> = (0..3).map(|_| start(&output)).collect();
    for child in &mut children {
        assert!(child.wait().unwrap().success());
    }
    assert!(fs::read(&output).unwrap() == new);
    assert_eq!(folder.names(), ["a.ply", "undisturbed.ply"]);
}
