//! `chordal mesh --watch`: written again whenever a file changes, a preview first and the proof after it.
#![cfg(unix)]
use crate::common;

use common::{Folder, chordal, run};
use serde_json::Value;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Lines};
use std::process::{Child, ChildStderr, Command, Stdio};

/// A command that watches; it ends with the test.
struct Watcher {
    child: Child,
    stderr: Lines<BufReader<ChildStderr>>,
    folder: Folder,
}

impl Watcher {
    fn start(folder: Folder, input: &str) -> Self {
        let words =
            ["mesh", &folder.text(input), "-o", &folder.text("a.obj"), "--tol", "0.05", "--watch", "--json"];
        let out = File::create(folder.path("reports")).unwrap();
        let mut child = chordal(&words).stdout(out).stderr(Stdio::piped()).spawn().unwrap();
        let stderr = BufReader::new(child.stderr.take().unwrap()).lines();
        Self { child, stderr, folder }
    }

    /// What was said before it waits for the next change.
    fn until_it_waits(&mut self) -> Vec<String> {
        let lines = self.stderr.by_ref().map(Result::unwrap);
        lines.take_while(|line| !line.contains("waiting for a change")).collect()
    }

    /// For each report so far the evidence of its bound, or its error.
    fn ends(&self) -> Vec<String> {
        let text = fs::read_to_string(self.folder.path("reports")).unwrap();
        let reports = serde_json::Deserializer::from_str(&text).into_iter::<Value>().map(Result::unwrap);
        let end = |report: Value| {
            let of = |pointer| report.pointer(pointer).and_then(Value::as_str).map(str::to_owned);
            of("/certificate/bound/evidence").or_else(|| of("/error/code")).unwrap()
        };
        reports.map(end).collect()
    }

    /// The largest coordinate of what was written.
    fn reach(&self) -> f64 {
        let text = fs::read_to_string(self.folder.path("a.obj")).unwrap();
        let rows = text.lines().filter_map(|line| line.strip_prefix("v "));
        rows.flat_map(str::split_whitespace).map(|x| x.parse::<f64>().unwrap()).fold(0.0, f64::max)
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn a_script_is_meshed_again_after_each_change_of_it_and_of_what_it_loads() {
    let folder = Folder::new("watch");
    folder.file("size.star", "radius = 1\n");
    folder.file("a.star", "load(\"size.star\", \"radius\")\nsphere(radius)\n");
    let mut watcher = Watcher::start(folder, "a.star");
    watcher.until_it_waits();
    assert_eq!(watcher.ends(), ["estimated", "proved"]);
    assert!((watcher.reach() - 1.0).abs() < 0.06);
    // A loaded file.
    watcher.folder.file("size.star", "radius = 20\n");
    watcher.until_it_waits();
    assert_eq!(watcher.ends()[2..], ["estimated", "proved"]);
    assert!((watcher.reach() - 20.0).abs() < 0.06);
    // A mistake is told with its place, and what was made stays.
    watcher.folder.file("a.star", "sphere(radius)\n");
    let said = watcher.until_it_waits();
    assert!(said.iter().any(|line| line.contains("a.star: line 1") && line.contains("radius")), "{said:?}");
    assert_eq!(watcher.ends().len(), 5);
    assert!((watcher.reach() - 20.0).abs() < 0.06);
    // And mended.
    watcher.folder.file("a.star", "box(3, 3, 3)\n");
    watcher.until_it_waits();
    assert_eq!(watcher.ends()[5..], ["estimated", "proved"]);
    assert!((watcher.reach() - 1.5).abs() < 1e-6); // rounding of the file
    // Ctrl-C ends it as it ends any job.
    let id = watcher.child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    assert_eq!(watcher.child.wait().unwrap().code(), Some(130));
}

#[test]
fn a_change_ends_a_proof_that_is_not_needed_any_more() {
    let folder = Folder::new("watch-late");
    // Forty blends: the mesh takes most of a minute.
    let part = "move(smooth_union(sphere(1), box(1.5, 1.5, 1.5), 0.3), 1.5 * i, 0, 0)";
    folder.file("a.star", format!("union([{part} for i in range(40)])\n"));
    let mut watcher = Watcher::start(folder, "a.star");
    // As soon as it was read.
    std::thread::sleep(std::time::Duration::from_millis(300));
    watcher.folder.file("a.star", "sphere(2)\n");
    watcher.until_it_waits();
    let ends = watcher.ends();
    assert!(ends.len() < 4 && ends.ends_with(&["estimated".to_owned(), "proved".to_owned()]), "{ends:?}");
    assert!((watcher.reach() - 2.0).abs() < 0.06);
}

#[test]
fn what_cannot_be_watched_or_replaced_is_refused() {
    let folder = Folder::new("watch-refused");
    let script = folder.file("a.star", "sphere(1)\n");
    let taken = folder.file("a.obj", "v 0 0 0\n");
    run(&["mesh", &script, "-o", "-", "--to", "obj", "--tol", "0.1", "--watch"])
        .fails_with(2, &["--watch", "'-'"]);
    run(&["mesh", &script, "-o", &taken, "--tol", "0.1", "--watch"]).fails_with(4, &["a.obj", "--force"]);
    run(&["mesh", &script, "-o", &folder.text("b.obj"), "--watch"]).fails_with(2, &["--tol"]);
}
