//! A part as code always becomes a file: what is known of it is said, and the exit code follows what was asked for.
use crate::common;

use chordal_testkit::is_long;
use common::{Folder, run};

/// A ball cut out of a box: curved and with a crease.
const PART: &str = "box(4, 4, 2) - move(sphere(1.2), 0, 0, 1)\n";

#[test]
fn time_that_ends_leaves_a_closed_mesh_that_is_measured() {
    let folder = Folder::new("answers-within");
    let (input, output) = (folder.file("a.star", PART), folder.text("a.ply"));
    let made = run(&["mesh", &input, "--tol", "0.001", "--within", "1ms", "-o", &output, "--json"]);
    // Whether a thousandth is reached by then depends on the machine.
    assert!([0, 5].contains(&made.code), "{made:?}");
    let certificate = &made.report()["certificate"];
    assert_eq!(
        (&certificate["valid"]["closed"], &certificate["valid"]["manifold"]),
        (&true.into(), &true.into())
    );
    assert!(certificate["output"]["triangles"].as_u64().unwrap() > 12, "{certificate}");
    assert!(folder.path("a.ply").exists());
}

#[test]
fn a_proof_that_is_asked_for_and_not_found_is_a_failure_with_a_file() {
    let folder = Folder::new("answers-required");
    let (input, output) = (folder.file("a.star", PART), folder.text("a.ply"));
    let asked = ["mesh", &input, "--tol", "0.001", "--require", "proved", "--within", "1ms", "-o", &output];
    let made = run(&[&asked[..], &["--json"]].concat());
    made.fails_with(
        5,
        &["a.star: the budget was not met", "the result is written nevertheless", "--require measured"],
    );
    assert_eq!(made.report()["certificate"]["bound"]["evidence"], "measured");
    assert!(folder.path("a.ply").exists());
}

#[test]
fn an_ordinary_part_is_proved_without_being_asked() {
    let folder = Folder::new("answers-proved");
    let (input, output) = (folder.file("a.star", PART), folder.text("a.ply"));
    let made = run(&["mesh", &input, "--tol", "0.01", "-o", &output, "--json"]);
    made.succeeds();
    let bound = &made.report()["certificate"]["bound"];
    assert!(bound["evidence"] == "proved" && bound.get("open").is_none(), "{bound}");
    assert!(bound["at_most"].as_f64().unwrap() <= 0.01);
}

#[test]
fn a_time_has_a_unit() {
    let folder = Folder::new("answers-time");
    let (input, output) = (folder.file("a.star", PART), folder.text("a.ply"));
    for time in ["5", "-1s", "0s", "soon", "1e999s"] {
        let made = run(&["mesh", &input, "--tol", "0.01", &format!("--within={time}"), "-o", &output]);
        made.fails_with(2, &["--within", "as in 20s, 2m or 500ms"]);
    }
    assert_eq!(folder.names(), ["a.star"]);
}

/// The place that is left open is as long as the wall, which belongs to what is cut out.
#[test]
fn a_post_that_touches_the_wall_of_a_tray_is_named_with_what_made_the_wall() {
    let folder = Folder::new("answers-tray");
    let text = "body = box(40, 24, 15)\npocket = move(box(36, 20, 15), 0, 0, 2)\n\
        tray = difference(body, pocket)\npost = move(cylinder(3, 13), 14, 7, 0)\nunion(tray, post)\n";
    let (input, output) = (folder.file("a.star", text), folder.text("a.ply"));
    let names = |notes: &str| {
        assert!(
            notes.contains("two surfaces touch at (14.0000, 10.0000") && notes.contains("lines 2 and 4"),
            "{notes}"
        );
    };
    let said = run(&["mesh", &input, "--tol", "0.5", "-o", &output]);
    said.succeeds();
    names(&said.stdout);
    if is_long() {
        let made = run(&["mesh", &input, "--tol", "0.1", "-o", &output, "--json", "--force"]);
        made.succeeds();
        names(&made.report()["certificate"]["notes"].to_string());
    }
}

#[test]
fn solids_that_touch_are_named_with_their_lines() {
    let folder = Folder::new("answers-touching");
    let text = "body = box(10, 10, 10)\npost = move(cylinder(3, 10), 8, 0, 0)\nbody | post\n";
    let (input, output) = (folder.file("a.star", text), folder.text("a.ply"));
    let length = if is_long() { "0.1" } else { "0.5" };
    let made = run(&["mesh", &input, "--tol", length, "-o", &output, "--json"]);
    made.succeeds();
    let report = made.report();
    let contact = &report["certificate"]["bound"]["open"]["largest"][0]["contact"];
    assert_eq!(contact["kind"], "tangent", "{report}");
    assert!((contact["at"][0].as_f64().unwrap() - 5.0).abs() < 0.02, "{contact}");
    let notes = report["certificate"]["notes"].to_string();
    assert!(notes.contains("two surfaces touch at (5.0") && notes.contains("lines 1 and 2"), "{notes}");
    // What stands in the terminal is looked at above, too.
    if is_long() {
        let said = run(&["mesh", &input, "--tol", "0.1", "-o", &output, "--force"]);
        said.succeeds();
        assert!(said.stdout.contains("two surfaces touch at (5.0"), "{}", said.stdout);
    }
    // The same where nothing but a proof will do, instead of some place that is far.
    let asked = ["mesh", &input, "--tol", "0.1", "--require", "proved", "-o", &output, "--force", "--json"];
    let strict = run(&asked);
    strict.fails_with(5, &["not proved at", "two surfaces touch at (5.0", "lines 1 and 2", "overlap them"]);
    assert!(!strict.stderr.contains("the worst known place"), "{}", strict.stderr);
    let report = strict.report();
    let places = report["certificate"]["bound"]["open"]["largest"].as_array().unwrap();
    let lines = |place: &&serde_json::Value| place["contact"]["lines"] == serde_json::json!([1, 2]);
    assert!(places.iter().any(|place| lines(&place)), "{report}");
    // What helps, as the note says.
    let text = text.replace(", 8, 0, 0)", ", 7.9, 0, 0)");
    let made =
        run(&["mesh", &folder.file("b.star", &text), "--tol", length, "-o", &output, "--force", "--json"]);
    made.succeeds();
    assert_eq!(made.report()["certificate"]["bound"]["evidence"], "proved");
}
