//! Signals at any moment: the output is the old file or the whole new one.
#![cfg(unix)]
use crate::common;

use common::{Folder, TEAPOT, chordal, run};
use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A job that takes a while and writes some megabytes.
fn start(output: &str) -> Child {
    let args = ["mesh", TEAPOT, "-o", output, "--tol", "2e-4", "--force", "-q"];
    chordal(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn send(signal: &str, child: &Child) {
    // The process may be over by now, which is one of the moments to try.
    let _ = Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status();
}

/// The bytes that the job writes when nobody disturbs it, and moments spread over the time that it takes here
/// and a little more. None of them is expected to hit anything: whatever it hits, the output must be whole.
fn undisturbed(folder: &Folder) -> (Vec<u8>, Vec<Duration>) {
    const MOMENTS: u32 = 10;
    let output = folder.text("undisturbed.ply");
    let started = Instant::now();
    assert!(start(&output).wait().unwrap().success());
    let took = started.elapsed();
    (fs::read(output).unwrap(), (0..MOMENTS).map(|step| took * step / (MOMENTS - 2)).collect())
}

#[test]
fn h80_a_signal_at_any_moment_leaves_the_old_file_or_the_whole_new_one() {
    let folder = Folder::new("h80-polite");
    let (new, moments) = undisturbed(&folder);
    let output = folder.file("a.ply", "old");
    let mut interrupted = 0;
    for (step, moment) in moments.into_iter().enumerate() {
        let signal = if step % 2 == 0 { "-INT" } else { "-TERM" };
        fs::write(&output, "old").unwrap();
        let mut child = start(&output);
        sleep(moment);
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
    let (new, moments) = undisturbed(&folder);
    let output = folder.file("a.ply", "old");
    for (step, moment) in moments.into_iter().enumerate() {
        fs::write(&output, "old").unwrap();
        let mut child = start(&output);
        sleep(moment);
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
    run(&["mesh", TEAPOT, "-o", &output, "--tol", "2e-4", "--force", "-q"]).succeeds();
    assert!(fs::read(&output).unwrap() == new);
}

#[test]
fn h80_two_jobs_on_one_output_leave_one_whole_file() {
    let folder = Folder::new("h80-two");
    let (new, _) = undisturbed(&folder);
    let output = folder.text("a.ply");
    let mut children: Vec<_> = (0..3).map(|_| start(&output)).collect();
    for child in &mut children {
        assert!(child.wait().unwrap().success());
    }
    assert!(fs::read(&output).unwrap() == new);
    assert_eq!(folder.names(), ["a.ply", "undisturbed.ply"]);
}

/// The limits go from one at which the program hardly starts to one at which it ends well.
#[cfg(target_os = "linux")]
#[test]
fn a_failed_allocation_is_an_exit_code_and_no_abort() {
    let folder = Folder::new("no-memory");
    folder.file("many.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{}", "f 1 2 3\n".repeat(500_000)));
    let program = chordal(&[]).get_program().to_owned();
    let limited = |kilobytes: usize, arguments: &[&std::ffi::OsStr]| {
        std::process::Command::new("sh")
            .args(["-c", &format!("ulimit -v {kilobytes}; exec \"$0\" \"$@\"")])
            .arg(&program)
            .args(arguments)
            .env("RAYON_NUM_THREADS", "1")
            .output()
            .unwrap()
    };
    // Address space in kilobytes, from where the program starts at all, which its own size decides: below that the
    // loader, the runtime or the handler itself finds no memory.
    let starts = (20_000..)
        .step_by(1_000)
        .find(|&kilobytes| limited(kilobytes, &["--version".as_ref()]).status.success());
    let starts = starts.unwrap();
    let mut seen = std::collections::BTreeSet::new();
    let (mut aborts, mut ended_well) = (0, 0);
    let out = folder.path("out.ply");
    let input = folder.path("many.obj");
    let job = ["convert".as_ref(), input.as_ref(), out.as_ref(), "--force".as_ref(), "--json".as_ref()];
    for kilobytes in (starts..starts + 200_000).step_by(10_000) {
        // With more it ends well, too.
        if ended_well == 3 && !chordal_testkit::is_long() {
            break;
        }
        let limited = limited(kilobytes, &job);
        let Some(code) = limited.status.code() else { panic!("{kilobytes} kB: {limited:?}") };
        seen.insert(code);
        ended_well += u32::from(code == 0);
        assert!([0, 3, 5].contains(&code), "{kilobytes} kB: {limited:?}");
        assert_eq!(out.exists(), code == 0, "{kilobytes} kB: {limited:?}");
        // Hardly started, it may have no memory for the report that is prepared.
        if code == 5 && kilobytes == starts && limited.stdout.is_empty() {
            continue;
        }
        let report: serde_json::Value = serde_json::from_slice(&limited.stdout)
            .unwrap_or_else(|error| panic!("{kilobytes} kB, {error}: {limited:?}"));
        let error = &report["error"];
        assert_eq!(error.is_null(), code == 0, "{report}");
        assert!(code == 0 || error["exit"] == code, "{report}");
        aborts += usize::from(error["code"] == "out-of-memory");
        let _ = std::fs::remove_file(&out);
    }
    assert!(seen.contains(&0) && seen.contains(&5), "{seen:?}");
    assert!(aborts > 0, "the handler was never asked");
}
