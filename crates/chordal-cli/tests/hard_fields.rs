//! Fields that took gigabytes or minutes, or got a wrong answer: each ends, in little memory, as it should.
use crate::common;

use chordal_testkit::is_long;
use common::{Folder, Run, repro, run};
use serde_json::Value;

/// What a run ends with.
#[derive(Clone, Copy)]
enum Ending {
    /// A mesh within the length, proved, of this many triangles at most.
    Proved(u64),
    /// A closed mesh without a proof: measured within the length, or the best with a bound beyond it.
    Unproved,
    /// An exit code, and a sentence that says this.
    Refused(i32, &'static str),
}

/// The file, its length, and how it ends.
type Row = (&'static str, &'static str, Ending);

const SCRIPTS: [Row; 11] = [
    ("a_1041_mem.star", "5%", Ending::Proved(4000)),
    ("a_1057_mem.star", "5%", Ending::Proved(200)),
    ("a_1337_mem.star", "5%", Ending::Proved(200)),
    ("a_1442_mem.star", "5%", Ending::Proved(200)),
    ("a_1617_mem.star", "5%", Ending::Proved(200)),
    ("a_1757_mem.star", "5%", Ending::Proved(200)),
    ("a_461_timeout.star", "5%", Ending::Proved(100)),
    ("displace_promise.star", "0.02", Ending::Proved(1000)),
    ("unmet_csg.star", "0.01", Ending::Proved(1000)),
    ("sphere1e300.star", "5%", Ending::Refused(3, "-1e300")),
    ("twistbig.star", "5%", Ending::Refused(5, "twist and repeat it less often")),
];

const OP_LISTS: [Row; 6] = [
    ("a_1393_timeout-mem.vm", "5%", Ending::Unproved),
    ("pole.vm", "5%", Ending::Unproved),
    ("a_798_timeout-mem.vm", "5%", Ending::Unproved),
    ("bomb_dag.vm", "5%", Ending::Proved(12)),
    ("constneg.vm", "5%", Ending::Proved(12)),
    ("q.vm", "5%", Ending::Proved(12)),
];

/// Scripts of which others of the same kind take less time. Measured: ten seconds in all.
const SLOW: [&str; 4] = ["a_1041_mem.star", "a_1057_mem.star", "a_1337_mem.star", "a_1757_mem.star"];

/// Menger's sponge and two of its mutants; as they are, each takes a minute.
const SPONGES: [Row; 3] = [
    ("a_61_timeout-mem.star", "5%", Ending::Proved(40_000)),
    ("a_1216_timeout-mem.star", "5%", Ending::Proved(40_000)),
    ("a_2616_timeout-mem.star", "5%", Ending::Proved(40_000)),
];

/// The most that a process may hold, in bytes: what is passed as `--max-memory`.
const MOST_MEMORY: u64 = 256 << 20;

/// Meshes a file and judges what it comes to.
fn ends_as_it_should(folder: &Folder, row: Row) {
    ends_with(folder, row, &[]);
}

/// The same, with options.
fn ends_with(folder: &Folder, (name, length, ending): Row, options: &[&str]) {
    let Some(input) = repro(name) else { return };
    let output = folder.text("a.ply");
    // Each thread takes memory of its own.
    let within = ["--tol", length, "--max-memory", "256M", "--threads", "2"];
    let fixed = ["mesh", &input, "-o", &output, "--force", "--json", "--keep-best"];
    let made = run(&[&fixed[..], &within, options].concat());
    match ending {
        Ending::Proved(most) => {
            let certificate = closed(name, &made, 0);
            is_proved_within_its_length(name, &certificate);
            let triangles = certificate["output"]["triangles"].as_u64().expect("a count");
            assert!(triangles <= most, "{name}: {triangles}");
        }
        Ending::Unproved => {
            assert!([0, 5].contains(&made.code), "{name}: {made:?}");
            let certificate = closed(name, &made, made.code);
            let wanted = certificate["budget"]["length"].as_f64().expect("a length");
            let bound = &certificate["bound"];
            if made.code == 0 {
                let at_least = bound["at_least"].as_f64().expect("a lower end");
                assert!(bound["evidence"] == "measured" && at_least <= wanted, "{name}: {bound:#}");
            } else {
                assert!(made.stderr.contains("the best reached is"), "{name}: {made:?}");
                let at_most = bound["at_most"].as_f64();
                assert!(at_most.is_none_or(|at_most| at_most > wanted), "{name}: {certificate:#}");
            }
        }
        Ending::Refused(code, what) => made.fails_with(code, &[what]),
    }
}

/// The certificate of a mesh that is closed and manifold, made in little memory.
fn closed(name: &str, made: &Run, code: i32) -> Value {
    assert_eq!(made.code, code, "{name}: {made:?}");
    let mut report = made.report();
    let valid = &report["certificate"]["valid"];
    assert!(valid["closed"] == true && valid["manifold"] == true, "{name}: {valid:#}");
    // Known on Linux only.
    let peak = report["run"]["peak_bytes"].as_u64().unwrap_or(0);
    assert!(peak <= MOST_MEMORY, "{name}: {peak}");
    report["certificate"].take()
}

fn is_proved_within_its_length(name: &str, certificate: &Value) {
    let evidence = certificate["bound"]["evidence"].as_str().expect("a word");
    assert!(evidence.starts_with("proved"), "{name}: {evidence}");
    let wanted = certificate["budget"]["length"].as_f64().expect("a length");
    let at_most = certificate["bound"]["at_most"].as_f64().expect("an upper end");
    assert!(at_most <= wanted, "{name}: {at_most} of {wanted}");
}

#[test]
fn scripts_that_went_wrong_end_in_little_memory() {
    let folder = Folder::new("hard-scripts");
    for row in SCRIPTS.into_iter().filter(|(name, ..)| is_long() || !SLOW.contains(name)) {
        ends_as_it_should(&folder, row);
    }
}

#[test]
fn op_lists_that_went_wrong_end_in_little_memory() {
    let folder = Folder::new("hard-op-lists");
    // The pole takes ten seconds at any length, and reaches its limits as the others do.
    for row in OP_LISTS.into_iter().filter(|(name, ..)| is_long() || *name != "pole.vm") {
        ends_as_it_should(&folder, row);
    }
}

#[test]
fn sponges_that_went_wrong_end_in_little_memory() {
    let folder = Folder::new("hard-sponges");
    // One round of holes fewer is the same kind of field, with a twentieth of its holes.
    let options: &[&str] = if is_long() { &[] } else { &["--set", "depth=2"] };
    for row in SPONGES {
        ends_with(&folder, row, options);
    }
}

#[test]
fn lengths_beyond_the_digits_of_coordinates_are_refused() {
    let folder = Folder::new("hard-lengths");
    let output = folder.text("a.ply");
    let sphere = |radius: &str, length: &str| {
        let input = folder.file("a.star", format!("sphere({radius})\n"));
        run(&["mesh", &input, "-o", &output, "--tol", length, "--json", "--force"])
    };
    let advice = "move the shape to the origin, or allow a larger length";
    sphere("1", "1e-30").fails_with(5, &["1e-30 is too little beside coordinates of 1e0", advice]);
    sphere("1e-30", "1e-46").fails_with(5, &["1e-46 is too little beside coordinates of 1e-30", advice]);
    sphere("1", "1e-12").fails_with(5, &["triangles", "limit"]);
    assert_eq!(folder.names(), ["a.star"]);
    // What is small as a whole has its digits.
    for length in ["0.1%", "1e-32"] {
        let made = sphere("1e-30", length);
        is_proved_within_its_length(length, &closed(length, &made, 0));
    }
}
