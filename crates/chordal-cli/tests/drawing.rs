//! `chordal mesh drawing.svg` and its neighbours, from end to end.
use crate::common;

use common::{Folder, TEAPOT, run};
use serde_json::Value;

const DRAWING: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/drawing.svg");

fn schema(name: &str) -> jsonschema::Validator {
    let path = format!("{}/../../docs/schema/{name}.schema.json", env!("CARGO_MANIFEST_DIR"));
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    jsonschema::meta::validate(&schema).unwrap();
    jsonschema::validator_for(&schema).unwrap()
}

#[track_caller]
fn follows(name: &str, value: &Value) {
    let schema = schema(name);
    let wrong: Vec<_> = schema.iter_errors(value).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_drawing_becomes_json_with_one_polyline_a_subpath_and_the_report() {
    let folder = Folder::new("drawing-json");
    let out = folder.text("drawing.json");
    let made = run(&["mesh", DRAWING, "--tol", "0.25", "-o", &out, "--json"]);
    assert_eq!(made.code, 0, "{made:?}");
    let report = made.report();
    follows("report", &report);
    let file: Value = serde_json::from_str(&std::fs::read_to_string(&out).unwrap()).unwrap();
    follows("polylines", &file);
    let lines = file["polylines"].as_array().unwrap();
    assert_eq!(lines.len(), 15);
    let sources: Vec<_> = lines.iter().map(|line| line["source"].as_u64().unwrap()).collect();
    assert_eq!(sources, [0, 1, 1, 1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 10]);
    // The report in the file is the certificate of the one on stdout, and nothing of this run.
    assert_eq!(file["report"]["certificate"], report["certificate"]);
    assert_eq!(file["report"].as_object().unwrap().len(), 2);
    let bound = report["certificate"]["bound"]["at_most"].as_f64().unwrap();
    assert!(bound <= 0.25 && bound > 0.2);
    let segments = report["certificate"]["output"]["segments"].as_u64().unwrap();
    let counted: usize = lines
        .iter()
        .map(|line| line["points"].as_array().unwrap().len() - usize::from(line["closed"] == false))
        .sum();
    assert_eq!(counted as u64, segments);
    // What is not drawn is told: on stderr and in the report.
    assert!(made.stderr.contains("strokes"), "{made:?}");
    assert_eq!(report["certificate"]["input"]["warnings"][0]["code"], "unsupported-stroke");
}

#[test]
fn a_drawing_becomes_triangles_a_drawing_and_a_picture() {
    let folder = Folder::new("drawing-glb");
    let (glb, svg, png) =
        (folder.text("drawing.glb"), folder.text("drawing.svg"), folder.text("drawing.png"));
    let made = run(&["mesh", DRAWING, "--tol", "0.25", "-o", &glb, "--json"]);
    follows("report", &made.report());
    assert_eq!(made.report()["certificate"]["valid"]["t_junctions"], 0);
    assert_eq!(&std::fs::read(&glb).unwrap()[..4], b"glTF");
    let made = run(&["mesh", DRAWING, "--tol", "0.25mm", "-o", &svg, "--json"]);
    follows("report", &made.report());
    let again = run(&["inspect", &svg, "--json"]).report();
    follows("report", &again);
    assert_eq!(again["certificate"]["output"], made.report()["certificate"]["output"]);
    assert_eq!(again["inspection"]["found"]["differs"], Value::Array(Vec::new()));
    let drawn = run(&["render", DRAWING, "-o", &png, "--size", "60x40", "--json"]);
    follows("report", &drawn.report());
}

#[test]
fn inspect_names_pieces_and_kinks() {
    let shown = run(&["inspect", DRAWING]);
    for part in [
        "11, 9 filled",
        "9 closed, 6 open",
        "20 cubics",
        "14 arcs",
        "kinks",
        "31 C0, 2 C1, 6 C2",
        "path 6 'bird', piece 0: 147.5° at (78, 126, 0)",
    ] {
        assert!(shown.stdout.contains(part), "no '{part}' in {shown:?}");
    }
    let report = run(&["inspect", DRAWING, "--json"]).report();
    follows("report", &report);
    assert_eq!(report["inspection"]["drawing"]["worst"][0]["name"], "bird");
    let folder = Folder::new("drawing-joins");
    let bends = folder.file(
        "bends.svg",
        "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0C10 0 20 10 20 20C20 30 30 40 40 40'/></svg>",
    );
    let shown = run(&["inspect", &bends]);
    let jump =
        "path 0, piece 1: curvature jumps by 0.133, from 0.0667 to 0.0667 on the other side at (20, 20, 0)";
    for part in ["0 kinks, 1 G1, 0 G2", "0 C0, 1 C1, 0 C2", jump] {
        assert!(shown.stdout.contains(part), "no '{part}' in {shown:?}");
    }
}

#[test]
fn a_comb_is_drawn_of_paths_that_bend_and_refused_for_what_has_none() {
    let folder = Folder::new("drawing-comb");
    let png = folder.text("comb.png");
    let drawn = run(&["render", DRAWING, "--show", "comb", "--size", "120x90", "-o", &png, "--json"]);
    let report = drawn.report();
    follows("report", &report);
    let notes = report["certificate"]["notes"].to_string();
    assert!(notes.contains("teeth are as long as the curvature times"), "{notes}");
    assert_eq!(&std::fs::read(&png).unwrap()[1..4], b"PNG");
    // More is drawn than by the paths alone: a circle of radius 2 has teeth of one length all around it.
    let circle =
        folder.file("c.svg", "<svg xmlns='http://www.w3.org/2000/svg'><circle r='2' fill='none'/></svg>");
    let report = run(&["render", &circle, "--show", "comb", "-o", &png, "--force", "--json"]).report();
    let notes = report["certificate"]["notes"].to_string();
    assert!(notes.contains("the largest curvature of a tooth is 5.000e-1"), "{notes}");
    let straight = folder.file("s.svg", "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0L3 4'/></svg>");
    let comb = |input: &str| run(&["render", input, "--show", "comb", "-o", &png, "--force"]);
    comb(&straight).fails_with(3, &["no path bends"]);
    comb(TEAPOT).fails_with(3, &["a curvature comb is drawn of the paths of a drawing", "patches"]);
}

#[test]
fn budgets_that_mean_nothing_for_the_output_are_usage_errors() {
    let folder = Folder::new("drawing-usage");
    let plain =
        folder.file("a.svg", "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0c0 1 1 1 1 0z'/></svg>");
    let (json, glb) = (folder.text("a.json"), folder.text("a.glb"));
    run(&["mesh", &plain, "--triangles", "9", "-o", &json]).fails_with(2, &["--segments 9"]);
    run(&["mesh", &plain, "--segments", "9", "-o", &glb]).fails_with(2, &["--triangles 9"]);
    run(&["mesh", &plain, "--tol", "1", "-o", &folder.text("a.bpt")]).fails_with(2, &["can only be read"]);
    run(&["mesh", &plain, "--segments", "0", "-o", &json]).fails_with(2, &["--segments"]);
    run(&["mesh", &plain, "--segments", "9", "-o", &json, "-q"]).succeeds();
    run(&["mesh", &plain, "--tol", "0.01", "--spacing", "even", "-o", &json, "-q", "--force"]).succeeds();
    assert_eq!(folder.names(), ["a.json", "a.svg"]);
}

#[test]
fn h77_a_bad_drawing_is_one_sentence_with_its_place_and_leaves_no_file() {
    let folder = Folder::new("drawing-bad");
    let bad =
        folder.file("bad.svg", "<svg xmlns='http://www.w3.org/2000/svg'>\n<path d='M0 0L1e999 0'/></svg>");
    let failed = run(&["mesh", &bad, "--tol", "1", "-o", &folder.text("a.json")]);
    failed.fails_with(3, &["bad.svg: line 2, column 15:", "1e999"]);
    assert_eq!(folder.names(), ["bad.svg"]);
    run(&["mesh", &bad, "--tol", "1", "-o", &folder.text("a.json"), "--drop-nonfinite", "-q"]).succeeds();
}
