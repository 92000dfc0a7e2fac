//! `chordal mend`: what was asked for is mended, and the report says what.
use crate::common;

use common::{CLOSED_OBJ, Folder, OPEN_OBJ, PATCH, run};
use serde_json::{Value, json};

fn follows_the_schema(report: &Value) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    let wrong: Vec<_> = schema.iter_errors(report).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(wrong.is_empty(), "{wrong:#?}\n{report:#}");
}

/// A tetrahedron without its floor: one face turned, one repeated, a vertex apart.
const SICK_OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 9 9 9\nf 1 2 4\nf 2 3 4\nf 3 4 1\nf 1 2 4\n";

/// Cubes of these sizes in each other, all outward.
fn nested_obj(sizes: &[f64]) -> String {
    let mut obj = String::new();
    for (n, size) in sizes.iter().enumerate() {
        for corner in 0..8 {
            let at = [0, 1, 2].map(|k| if corner >> k & 1 == 1 { size / 2.0 } else { -size / 2.0 });
            obj += &format!("v {} {} {}\n", at[0], at[1], at[2]);
        }
        for quad in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            let [a, b, c, d] = quad.map(|corner| 8 * n + corner + 1);
            obj += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
        }
    }
    obj
}

#[test]
fn a_body_within_another_stays_solid_and_cavities_are_asked_for() {
    let folder = Folder::new("mend-nested");
    let (input, out) = (folder.file("nested.obj", nested_obj(&[2.0, 1.0])), folder.text("out.obj"));
    for (more, volume, change, words) in [
        (&[][..], 9.0, "left_nested_shells", "--nested cavity"),
        (&["--nested", "keep"], 9.0, "left_nested_shells", "taken as solid"),
        (&["--nested", "cavity"], 7.0, "turned_nested_shells", "--nested keep"),
    ] {
        let made = run(&[&["mend", &input, "-o", &out, "--force", "--all", "--json"], more].concat());
        assert_eq!(made.code, 0, "{made:?}");
        let report = made.report();
        follows_the_schema(&report);
        let certificate = &report["certificate"];
        let mended = certificate["mended"].to_string();
        assert!(mended.contains(change), "{more:?}: {mended}");
        assert!(certificate["notes"].to_string().contains(words), "{more:?}: {}", certificate["notes"]);
        let inspected = run(&["inspect", &out, "--json"]).report();
        let found = inspected.pointer("/certificate/valid/volume").and_then(Value::as_f64);
        let found = found.unwrap_or_else(|| panic!("a volume: {inspected:#}"));
        assert!((found - volume).abs() < 1e-9, "{more:?}: {found}");
    }
    // It is about what is turned.
    run(&["mend", &input, "-o", &out, "--force", "--weld", "--nested", "cavity"])
        .fails_with(2, &["--orient"]);
}

#[test]
fn a_hole_is_filled_and_the_report_says_so() {
    let folder = Folder::new("mend-fill");
    let (open, out) = (folder.file("open.obj", OPEN_OBJ), folder.text("out.obj"));
    let made = run(&["mend", &open, "-o", &out, "--fill-holes", "--json"]);
    made.succeeds();
    let report = made.report();
    follows_the_schema(&report);
    let certificate = &report["certificate"];
    assert_eq!(certificate["valid_before"]["closed"], false);
    assert_eq!(certificate["valid"]["closed"], true);
    assert_eq!(certificate["mended"][0]["cure"], "fill-holes");
    assert_eq!(certificate["mended"][0]["changes"][0]["what"], "filled_holes");
    assert_eq!(certificate["bound"]["metric"], "one-sided");
    assert_eq!(certificate["bound"]["at_most"], 0.0);
    assert_eq!(run(&["inspect", &out, "--require", "closed,manifold,oriented"]).code, 0);
    // A limit on the edges leaves it.
    let left = run(&["mend", &open, "-o", &out, "--force", "--fill-holes=2", "--json"]).report();
    assert_eq!(left["certificate"]["mended"][0]["changes"][0]["what"], "left_holes");
    assert_eq!(left["certificate"]["bound"]["metric"], "hausdorff");
}

#[test]
fn all_cures_run_in_their_order_whatever_the_order_of_the_arguments() {
    let folder = Folder::new("mend-all");
    let (sick, out) = (folder.file("sick.obj", SICK_OBJ), folder.text("out.ply"));
    let flags = [
        "--drop-unused",
        "--fill-holes",
        "--orient",
        "--split-nonmanifold",
        "--resolve-t-junctions",
        "--drop-degenerate",
        "--drop-duplicates",
        "--weld",
    ];
    let made = run(&[&["mend", &sick, "-o", &out, "--json"], &flags[..]].concat());
    assert_eq!(made.code, 0);
    let report = made.report();
    follows_the_schema(&report);
    let cures: Vec<&str> = report["certificate"]["mended"]
        .as_array()
        .unwrap()
        .iter()
        .map(|facts| facts["cure"].as_str().unwrap())
        .collect();
    let order = [
        "weld",
        "drop-duplicates",
        "drop-degenerate",
        "resolve-t-junctions",
        "split-nonmanifold",
        "orient",
        "fill-holes",
        "orient",
        "drop-unused",
    ];
    assert_eq!(cures, order);
    assert_eq!(report["certificate"]["output"], json!({"vertices": 4, "positions": 4, "triangles": 4}));
    assert_eq!(run(&["inspect", &out, "--require", "closed,manifold,oriented"]).code, 0);
    // All of them have one name, and those that say more say it beside that.
    let bytes = std::fs::read(folder.path("out.ply")).unwrap();
    let all = run(&["mend", &sick, "-o", &out, "--force", "--all", "--json"]);
    assert_eq!(all.code, 0);
    assert_eq!(all.report()["certificate"], report["certificate"]);
    assert!(std::fs::read(folder.path("out.ply")).unwrap() == bytes);
    let few = run(&["mend", &sick, "-o", &out, "--force", "--all", "--fill-holes=2", "--json"]).report();
    assert_eq!(few["certificate"]["valid"]["closed"], false);
    let told = run(&["mend", &sick, "-o", &out, "--force", "--orient", "--drop-unused"]);
    assert_eq!(told.code, 0);
    for part in ["orient: ", "dropped 1 vertex", "before ", "after "] {
        assert!(told.stdout.contains(part), "no '{part}' in {}", told.stdout);
    }
}

#[test]
fn before_and_after_count_what_inspect_counts_and_say_what_they_leave_out() {
    let folder = Folder::new("mend-left");
    let out = folder.text("out.obj");
    let tell = |name: &str, text: &str| {
        run(&["mend", &folder.file(name, text), "-o", &out, "--force", "--drop-unused"]).stdout
    };
    let needle = tell("needle.obj", "v 0 0 0\nv 1 0 0\nv 0.5 0.001 0\nv 9 9 9\nf 1 2 3\n");
    assert!(needle.contains("  before      3 boundary edges, 1 sliver, 1 unused vertex\n"), "{needle}");
    assert!(needle.contains("  after       3 boundary edges, 1 sliver\n"), "{needle}");
    // Wound inside out, which no count of edges shows.
    let turned =
        CLOSED_OBJ.replace("f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4", "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1");
    let turned = tell("turned.obj", &turned);
    assert_eq!(run(&["inspect", &out, "--require", "outward"]).code, 1);
    assert!(!turned.contains("nothing to mend"), "{turned}");
    assert!(turned.contains("  after       none of the checked faults\n"), "{turned}");
    assert!(turned.contains("not checked: components inside out, self-intersections\n"), "{turned}");
}

#[test]
fn a_certificate_in_a_file_says_of_which_side_its_bound_is() {
    let folder = Folder::new("mend-one-sided");
    let (open, out) = (folder.file("open.obj", OPEN_OBJ), folder.text("out.glb"));
    run(&["mend", &open, "-o", &out, "--fill-holes"]).succeeds();
    let shown = run(&["inspect", &out]);
    assert!(
        shown.stdout.contains("(proved, of the source; what was added is not counted)"),
        "{}",
        shown.stdout
    );
}

#[test]
fn a_split_that_the_format_ties_again_is_said_and_an_empty_result_is_refused() {
    let folder = Folder::new("mend-ties");
    let fan =
        folder.file("fan.obj", "v 0 0 0\nv 0 0 1\nv 1 0 0\nv -1 1 0\nv -1 -1 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n");
    for (out, is_said) in [("out.stl", true), ("out.glb", true), ("out.obj", false), ("out.ply", false)] {
        let told = run(&["mend", &fan, "-o", &folder.text(out), "--split-nonmanifold"]);
        assert_eq!(told.code, 0);
        assert_eq!(told.stdout.contains("merges equal positions"), is_said, "{out}: {}", told.stdout);
    }
    let points = folder.file("points.obj", "v 0 0 0\nv 1 0 0\n");
    let refused = run(&["mend", &points, "-o", &folder.text("none.obj"), "--drop-unused"]);
    assert_eq!(refused.code, 3);
    assert!(refused.stderr.contains("nothing would be left"), "{}", refused.stderr);
    assert!(!std::path::Path::new(&folder.text("none.obj")).exists());
}

#[test]
fn a_length_is_one_of_the_scene_and_its_moves_are_in_the_bound() {
    let folder = Folder::new("mend-weld");
    let nearly = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0.001 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 4 5 6\n";
    let (input, out) = (folder.file("nearly.obj", nearly), folder.text("out.glb"));
    let made = run(&["mend", &input, "-o", &out, "--weld=2mm", "--unit", "m", "--json"]);
    assert_eq!(made.code, 0);
    let certificate = &made.report()["certificate"];
    follows_the_schema(&made.report());
    assert_eq!(certificate["mended"][0]["within"], 0.002);
    assert_eq!(certificate["mended"][0]["changes"][0]["count"], 2);
    let most = certificate["bound"]["at_most"].as_f64().unwrap();
    assert!((0.001..0.001_001).contains(&most), "{most}");
    assert_eq!(certificate["valid"]["boundary_edges"], 4);
}

#[test]
fn what_makes_no_sense_is_refused_in_a_sentence() {
    let folder = Folder::new("mend-refuse");
    let (good, patch) = (folder.file("a.obj", CLOSED_OBJ), folder.file("a.bpt", PATCH));
    let out = folder.text("out.obj");
    run(&["mend", &good, "-o", &out]).fails_with(2, &["--weld"]);
    run(&["mend", &good, "-o", &out, "--weld=-1"]).fails_with(2, &["--weld"]);
    run(&["mend", &good, "-o", &out, "--fill-holes=many"]).fails_with(2, &["many"]);
    run(&["mend", &good, "-o", &folder.text("out.svg"), "--weld"]).fails_with(2, &["svg"]);
    run(&["mend", &patch, "-o", &out, "--weld"]).fails_with(2, &["patches", "mesh them first"]);
    assert!(!folder.path("out.obj").exists());
}

#[test]
fn a_soup_is_welded_for_a_format_with_indices() {
    let folder = Folder::new("mend-stl");
    let good = folder.file("a.obj", CLOSED_OBJ);
    let (soup, out) = (folder.text("a.stl"), folder.text("out.obj"));
    run(&["mend", &good, "-o", &soup, "--orient"]).succeeds();
    run(&["mend", &soup, "-o", &out, "--weld"]).succeeds();
    assert_eq!(std::fs::read_to_string(&out).unwrap().lines().filter(|l| l.starts_with("v ")).count(), 4);
}

#[test]
fn a_print_without_a_unit_is_told_its_size() {
    let folder = Folder::new("mend-print");
    // A box of 2 by 1 by 0.5 inches with a face too few, as a STL says it: without a unit.
    let corner = |i: usize| format!("vertex {} {} {}", 2 * (i & 1), i >> 1 & 1, 0.5 * (i >> 2 & 1) as f64);
    let faces = [
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
    ];
    let facets = faces.map(|face| {
        format!("facet normal 0 0 0\nouter loop\n{}\nendloop\nendfacet\n", face.map(corner).join("\n"))
    });
    let scan = folder.file("scan.stl", format!("solid s\n{}endsolid s\n", facets.concat()));
    let out = folder.text("print.3mf");
    let told = run(&["mend", &scan, "-o", &out, "--all"]);
    assert_eq!(told.code, 0);
    for words in
        ["closed      yes", "filled 1 hole", "millimetres were taken, 2 x 1 x 0.5 mm", "--unit says another"]
    {
        assert!(told.stdout.contains(words), "{words}: {}", told.stdout);
    }
    let told = run(&["mend", &scan, "-o", &out, "--all", "--unit", "in", "--force"]);
    assert_eq!(told.code, 0);
    assert!(!told.stdout.contains("--unit"), "{}", told.stdout);
    let again = run(&["inspect", &out, "--json", "--require", "solid"]);
    again.succeeds();
    assert_eq!(again.report()["certificate"]["frame"]["metres_per_unit"], 0.0254);
}
