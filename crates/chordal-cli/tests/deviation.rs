//! `chordal deviation`: what it says, in both forms, and when it fails.
use crate::common;

use common::{CLOSED_OBJ, Folder, OPEN_OBJ, PATCH, TEAPOT, run};
use serde_json::Value;

/// A square at a height, cut along one diagonal.
fn square(z: f64) -> String {
    format!("v 0 0 {z}\nv 1 0 {z}\nv 1 1 {z}\nv 0 1 {z}\nf 1 2 3\nf 1 3 4\n")
}

fn number(report: &Value, at: &str) -> f64 {
    report.pointer(at).and_then(Value::as_f64).unwrap_or_else(|| panic!("no number at {at}: {report:#}"))
}

#[test]
fn says_both_ends_the_directions_and_the_worst_places() {
    let folder = Folder::new("deviation");
    let (a, b) = (folder.file("a.obj", square(0.0)), folder.file("b.obj", square(0.25)));
    let found = run(&["deviation", &a, &b, "--json"]);
    found.succeeds();
    let report = found.report();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    assert!(schema.is_valid(&report), "{report:#}");
    let ends =
        [number(&report, "/certificate/bound/at_least"), number(&report, "/certificate/bound/at_most")];
    assert!(ends[0] <= 0.25 && 0.25 <= ends[1] && ends[1] <= 1.1 * ends[0], "{ends:?}");
    assert_eq!(report["certificate"]["bound"]["evidence"], "proved");
    for side in ["forward", "backward"] {
        let at = |end: &str, k: usize| number(&report, &format!("/deviation/{side}/{end}/{k}"));
        assert_eq!((at("from", 2) - at("to", 2)).abs(), 0.25);
        assert_eq!((at("from", 0), at("from", 1)), (at("to", 0), at("to", 1)));
    }
    assert_eq!(report["run"]["verb"], "deviation");
    let text = run(&["deviation", &a, &b]);
    text.succeeds();
    for part in ["a.obj <-> ", "deviation   between 0.249", "(proved)", "there ", "back "] {
        assert!(text.stdout.contains(part), "{}", text.stdout);
    }
}

#[test]
fn a_limit_makes_it_a_check() {
    let folder = Folder::new("deviation-max");
    let (a, b) = (folder.file("a.obj", square(0.0)), folder.file("b.obj", square(0.25)));
    run(&["deviation", &a, &b, "--max", "0.26"]).succeeds();
    run(&["deviation", &a, &b, "--max", "20%"]).succeeds();
    let over = run(&["deviation", &a, &b, "--max", "0.2", "--json"]);
    over.fails_with(1, &["more than 0.2"]);
    assert_eq!(over.report()["deviation"]["verdict"], "exceeds");
    run(&["deviation", &a, &b, "--max", "300mm", "--unit", "m"]).succeeds();
    run(&["deviation", &a, &b, "--max", "300mm"]).fails_with(2, &["unit"]);
    run(&["deviation", &a, &b, "--max", "0"]).fails_with(2, &["--max"]);
    run(&["deviation", &a, &b, "--relative", "-1"]).fails_with(2, &["0 or more"]);
}

#[test]
fn nothing_is_away_from_itself_in_another_format() {
    let folder = Folder::new("deviation-same");
    let obj = folder.file("a.obj", CLOSED_OBJ);
    let stl = folder.text("a.stl");
    run(&["mesh", &obj, "-o", &stl, "--tol", "1"]).succeeds();
    let found = run(&["deviation", &stl, &obj, "--json"]);
    found.succeeds();
    assert_eq!(number(&found.report(), "/certificate/bound/at_most"), 0.0);
}

#[test]
fn a_mesh_of_patches_keeps_the_bound_of_its_own_certificate() {
    let folder = Folder::new("deviation-patches");
    let made = folder.text("teapot.obj");
    let meshed = run(&["mesh", TEAPOT, "-o", &made, "--tol", "0.02", "--json"]);
    meshed.succeeds();
    let said = number(&meshed.report(), "/certificate/bound/at_most");
    let least = number(&meshed.report(), "/certificate/bound/at_least");
    let found = run(&["deviation", &made, TEAPOT, "--json", "-q"]);
    found.succeeds();
    let report = found.report();
    let ends =
        [number(&report, "/certificate/bound/at_least"), number(&report, "/certificate/bound/at_most")];
    assert!(ends[0] <= said && least <= ends[1], "{ends:?} against [{least}, {said}]");
    assert!(ends[1] <= 1.1 * ends[0], "{ends:?}");
    assert_eq!(report["certificate"]["bound"]["reference"], "bezier patches");
    run(&["deviation", &made, TEAPOT, "--max", "0.02", "-q"]).succeeds();
    run(&["deviation", &made, TEAPOT, "--max", "0.001", "-q"]).fails_with(1, &["more than 0.001"]);
}

#[test]
fn what_has_no_surface_is_said() {
    let folder = Folder::new("deviation-none");
    let patch = folder.file("a.bpt", PATCH);
    let open = folder.file("open.obj", OPEN_OBJ);
    let points = folder.file("points.obj", "v 0 0 0\nv 1 0 0\n");
    let curves =
        folder.file("c.svg", "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0L1 0L1 1Z'/></svg>");
    run(&["deviation", &patch, &open]).succeeds();
    run(&["deviation", &open, &points, "-q"]).fails_with(3, &["second mesh has no triangle"]);
    run(&["deviation", &curves, &open]).fails_with(3, &["mesh them first"]);
    run(&["deviation", &open, "-", "--from", "obj"]).fails_with(3, &["stdin"]);
    run(&["deviation", "-", "-"]).fails_with(2, &["only one"]);
    run(&["deviation", &open]).fails_with(2, &["AGAINST"]);
}
