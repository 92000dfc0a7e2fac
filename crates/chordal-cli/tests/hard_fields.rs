//! Fields that took gigabytes or minutes, or got a wrong answer: each ends, in little memory, as it should.
use crate::common;

use common::{Folder, run};
use std::path::PathBuf;

/// What a run ends with.
#[derive(Clone, Copy)]
enum Ending {
    /// A mesh within the length, proved, of this many triangles at most.
    Proved(u64),
    /// The best mesh, and what it is off.
    Unmet,
    /// An exit code, and a sentence that says this.
    Refused(i32, &'static str),
}

/// The file, its length, and how it ends.
const INPUTS: [(&str, &str, Ending); 17] = [
    ("a_1041_mem.star", "5%", Ending::Proved(4000)),
    ("a_1057_mem.star", "5%", Ending::Unmet),
    ("a_1337_mem.star", "5%", Ending::Proved(200)),
    ("a_1442_mem.star", "5%", Ending::Proved(200)),
    ("a_1617_mem.star", "5%", Ending::Proved(200)),
    ("a_1757_mem.star", "5%", Ending::Proved(200)),
    ("a_461_timeout.star", "5%", Ending::Proved(100)),
    ("a_1393_timeout-mem.vm", "5%", Ending::Unmet),
    ("pole.vm", "5%", Ending::Unmet),
    ("a_798_timeout-mem.vm", "5%", Ending::Unmet),
    ("bomb_dag.vm", "5%", Ending::Proved(12)),
    ("constneg.vm", "5%", Ending::Proved(12)),
    ("q.vm", "5%", Ending::Proved(12)),
    ("displace_promise.star", "0.02", Ending::Proved(1000)),
    ("unmet_csg.star", "0.01", Ending::Proved(1000)),
    ("sphere1e300.star", "5%", Ending::Refused(3, "-1e300")),
    ("twistbig.star", "5%", Ending::Refused(5, "twist and repeat it less often")),
];

#[test]
fn fields_that_went_wrong_end_in_little_memory() {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    let root = std::env::var_os("CHORDAL_DATA").map_or_else(|| beside.into(), PathBuf::from).join("repro");
    if !root.is_dir() {
        eprintln!("SKIPPED: no test data beside the checkout (or set CHORDAL_DATA)");
        return;
    }
    let folder = Folder::new("hard-fields");
    let output = folder.text("a.ply");
    for (name, length, ending) in INPUTS {
        let input = root.join(name).to_str().unwrap().to_owned();
        let fixed = ["mesh", &input, "-o", &output, "--force", "--json", "--max-memory", "256M"];
        let made = run(&[&fixed[..], &["--tol", length]].concat());
        match ending {
            Ending::Proved(most) => {
                assert_eq!(made.code, 0, "{name}: {made:?}");
                let report = made.report();
                let evidence = report["certificate"]["bound"]["evidence"].as_str().expect("a word");
                assert!(evidence.starts_with("proved"), "{name}: {evidence}");
                let triangles = report["certificate"]["output"]["triangles"].as_u64().expect("a count");
                assert!(triangles <= most, "{name}: {triangles}");
                // Known on Linux only.
                let peak = report["run"]["peak_bytes"].as_u64().unwrap_or(0);
                assert!(peak <= 256 << 20, "{name}: {peak}");
            }
            Ending::Unmet => {
                assert_eq!(made.code, 5, "{name}: {made:?}");
                assert!(made.stderr.contains("the best reached is"), "{name}: {made:?}");
            }
            Ending::Refused(code, what) => {
                assert_eq!(made.code, code, "{name}: {made:?}");
                assert!(made.stderr.contains(what), "{name}: {made:?}");
            }
        }
    }
}
