//! What the tests of the command share: folders of their own, small inputs, and running the binary.
#![allow(dead_code, reason = "each test file uses its own part of this")]

use chordal_testkit::corpus;
pub use chordal_testkit::{Folder, names};
use serde_json::Value;
use std::process::{Command, Output, Stdio};

/// The shipped teapot.
pub const TEAPOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/teapot.bpt");

/// A file with one bent patch.
pub const PATCH: &str = "1\n3 3\n\
    0 0 0\n1 0 0\n2 0 0\n3 0 0\n0 1 0\n1 1 2\n2 1 2\n3 1 0\n\
    0 2 0\n1 2 2\n2 2 2\n3 2 0\n0 3 0\n1 3 0\n2 3 0\n3 3 0\n";

/// A tetrahedron without its floor: three triangles, one loop of three boundary edges.
pub const OPEN_OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// A tetrahedron.
pub const CLOSED_OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// A box of triangles as an .obj.
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> String {
    let mut text = String::new();
    for i in 0..8_usize {
        let [x, y, z] = [0, 1, 2].map(|k| if i >> k & 1 == 1 { high[k] } else { low[k] });
        text += &format!("v {x} {y} {z}\n");
    }
    for [a, b, c, d] in [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]] {
        text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    text
}

/// A number of a report.
pub fn number(report: &Value, at: &str) -> f64 {
    report.pointer(at).and_then(Value::as_f64).unwrap_or_else(|| panic!("no number at {at}: {report:#}"))
}

/// The signed volume of a written file.
pub fn volume(path: &str) -> f64 {
    number(&run(&["inspect", path, "--json"]).report(), "/certificate/valid/volume")
}

/// A file of `repro` in the test data: inputs that were handled badly. Nothing where there is no such folder.
pub fn repro(name: &str) -> Option<String> {
    corpus::find(&format!("repro/{name}"))?.to_str().map(str::to_owned)
}

/// The command, not yet run.
pub fn chordal(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_chordal"));
    command.args(args).stdin(Stdio::null());
    command
}

/// The command, run.
pub fn run(args: &[&str]) -> Run {
    Run::of(chordal(args).output().unwrap())
}

/// What a run came to.
#[derive(Debug)]
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    pub fn of(output: Output) -> Self {
        Self {
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// Ended with `code` and one sentence that holds every one of `parts`, and nothing that only programmers
    /// know.
    pub fn fails_with(&self, code: i32, parts: &[&str]) {
        assert_eq!(self.code, code, "{self:?}");
        assert_eq!(self.stderr.lines().count(), 1, "one sentence: {self:?}");
        assert!(self.stderr.starts_with("chordal: "), "{self:?}");
        for part in parts {
            assert!(self.stderr.contains(part), "no '{part}' in {self:?}");
        }
        for part in ["panicked", "unwrap", "index out of bounds", "RUST_BACKTRACE", "os error"] {
            assert!(!self.stderr.contains(part), "'{part}' in {self:?}");
        }
    }

    /// Ended with `code`, and a sentence with the line that it is about below it.
    pub fn fails_showing(&self, code: i32, parts: &[&str]) {
        assert_eq!(self.code, code, "{self:?}");
        let sentence = self.stderr.lines().next().unwrap_or_default();
        assert!(sentence.starts_with("chordal: ") && self.stderr.lines().count() == 3, "{self:?}");
        parts.iter().for_each(|part| assert!(sentence.contains(part), "no '{part}' in {self:?}"));
    }

    /// Ended well, and said this on the way.
    pub fn succeeds_saying(&self, part: &str) {
        assert!(self.code == 0 && self.stderr.contains(part), "no '{part}' in {self:?}");
    }

    /// Ended well, and quietly.
    pub fn succeeds(&self) {
        assert_eq!((self.code, self.stderr.as_str()), (0, ""), "{self:?}");
    }

    /// The report on stdout.
    pub fn report(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
}
