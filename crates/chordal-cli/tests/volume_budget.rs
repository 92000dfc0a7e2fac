//! Volumes within a budget: cells are cut where it takes that, triangles are simplified within the rest, and the report
//! says what each step did.
use crate::common;
use chordal_testkit::is_long;
use common::{Folder, run};
use serde_json::Value;

/// A ball of 8-bit samples, a mask.
fn ball_mask(n: usize) -> Vec<u8> {
    let header = format!(
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: {n} {n} {n}\nencoding: raw\nspace: RAS\n\
         space directions: (1,0,0) (0,1,0) (0,0,1)\nspace units: \"mm\" \"mm\" \"mm\"\n\n"
    );
    let middle = (n as f64 - 1.0) / 2.0;
    let inside = |at: usize| {
        let from = |i: usize| (i as f64 - middle) * (i as f64 - middle);
        u8::from(from(at % n) + from(at / n % n) + from(at / (n * n)) < 0.15 * (n * n) as f64)
    };
    header.into_bytes().into_iter().chain((0..n * n * n).map(inside)).collect()
}

#[track_caller]
fn meshed(input: &str, output: &str, more: &[&str]) -> Value {
    let made = run(&[&["mesh", input, "-o", output, "--force", "--json"], more].concat());
    assert_eq!(made.code, 0, "{made:?}");
    made.report()
}

fn number(report: &Value, pointer: &str) -> f64 {
    report.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} in {report:#}"))
}

#[test]
fn a_length_leaves_few_triangles_with_both_proofs_added() {
    let folder = Folder::new("volume-budget");
    let input = folder.file("ball.nrrd", ball_mask(if is_long() { 24 } else { 12 }));
    let output = folder.text("ball.ply");
    let native = meshed(&input, &output, &[]);
    let lengths: &[&str] = if is_long() { &["1.5", "0.7", "0.4"] } else { &["1.5", "0.7"] };
    for length in lengths {
        let report = meshed(&input, &output, &["--tol", &format!("{length}mm")]);
        assert!(number(&report, "/certificate/bound/at_most") <= length.parse().unwrap());
        assert_eq!(report["certificate"]["bound"]["evidence"], "proved");
        assert_eq!(report["certificate"]["bound"]["reference"], "trilinear interpolant");
        let valid = &report["certificate"]["valid"];
        assert!(
            valid["closed"] == true && valid["manifold"] == true && valid["oriented"] == true,
            "{valid:#}"
        );
        let notes = report["certificate"]["notes"].to_string();
        assert!(notes.contains("of the interpolant were simplified to"), "{notes}");
        let triangles = |report: &Value| number(report, "/certificate/output/triangles");
        assert!(*length == "0.4" || triangles(&report) < 0.5 * triangles(&native), "{length}");
    }
    // What is nearer to the truth takes half a minute to tell.
    let most = if is_long() { "0.4mm" } else { "0.9mm" };
    run(&["deviation", &output, &input, "--max", most, "-q"]).succeeds();
}

#[test]
fn a_count_is_reached_with_the_bound_that_it_costs() {
    let folder = Folder::new("volume-count");
    let (n, first, too_short) = if is_long() { (20, 400_u32, "0.3mm") } else { (10, 200, "0.6mm") };
    let input = folder.file("ball.nrrd", ball_mask(n));
    let output = folder.text("ball.ply");
    for count in [first, 100, 20] {
        let report = meshed(&input, &output, &["--triangles", &count.to_string()]);
        let triangles = number(&report, "/certificate/output/triangles");
        assert!(
            triangles <= f64::from(count) && triangles >= f64::from(count) - 4.0,
            "{triangles} of {count}"
        );
        assert_eq!(report["certificate"]["valid"]["closed"], true);
        assert!(number(&report, "/certificate/bound/at_most") < 10.0);
    }
    // A length that so few triangles do not keep.
    run(&["mesh", &input, "-o", &output, "--force", "--tol", too_short, "--triangles", "20"])
        .fails_with(5, &["budget"]);
}

#[test]
fn levels_that_memory_does_not_allow_are_told_and_kept_where_asked() {
    let folder = Folder::new("volume-memory");
    // A third of the samples and half of the memory.
    let (n, memory) = if is_long() { (12, "8M") } else { (8, "4M") };
    let input = folder.file("ball.nrrd", ball_mask(n));
    let output = folder.text("ball.glb");
    let asked = ["lod", &input, "-o", &output, "--force", "--tol", "0.02mm", "--max-memory", memory];
    run(&asked).fails_with(5, &["was not met", "--keep-best"]);
    assert!(!std::path::Path::new(&output).exists());
    let kept = run(&[&asked[..], &["--keep-best", "--json"]].concat());
    assert_eq!(kept.code, 5, "{kept:?}");
    let report = kept.report();
    let most = number(&report, "/certificate/bound/at_most");
    assert!(most > 0.02 && most < 1.8, "{most}: a cell has a diagonal of 1.74");
    assert!(std::path::Path::new(&output).exists());
    // With memory it is met.
    run(&["lod", &input, "-o", &output, "--force", "--tol", "0.2mm", "-q"]).succeeds();
}
