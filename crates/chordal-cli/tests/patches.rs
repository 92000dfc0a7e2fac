//! `chordal inspect` on patches: how they meet, in words and in the report.
use crate::common;

use common::{Folder, PATCH, TEAPOT, run};
use serde_json::{Value, json};

/// Rows of four control points of the bilinear patch over three corners.
fn flat(origin: [f64; 3], along_u: [f64; 3], along_v: [f64; 3]) -> Value {
    let point = |i: u32, j: u32, k: usize| {
        origin[k] + along_u[k] * (f64::from(j) / 3.0) + along_v[k] * (f64::from(i) / 3.0)
    };
    let row = |i: u32| (0..4).map(|j| [0, 1, 2].map(|k| point(i, j, k))).collect::<Vec<_>>();
    json!((0..4).map(row).collect::<Vec<_>>())
}

#[track_caller]
fn follows_the_schema(report: &Value) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    let wrong: Vec<_> = schema.iter_errors(report).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn inspect_says_where_patches_kink_and_by_how_much() {
    let folder = Folder::new("patches-kink");
    let (s, c) = 30_f64.to_radians().sin_cos();
    let floor = flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    let ramp = flat([1.0, 0.0, 0.0], [c, 0.0, s], [0.0, 2.0, 0.0]);
    let beside = flat([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    // Its side on the floor's is bent by a thousandth of the floor's shortest side or less.
    let mut near = flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, -2.0, 0.0]);
    near[0][1][2] = json!(4e-4);
    near[0][2][2] = json!(4e-4);
    let file = json!({ "patches": [floor, ramp, beside, near] }).to_string();
    let input = folder.file("a.json", file);

    let shown = run(&["inspect", &input]);
    shown.succeeds();
    for part in [
        "edges       3 shared, 10 on the boundary",
        "fronts      disagree across 1 edge",
        "joins       1 gap, 1 kink, 0 G1, 1 G2",
        "1 C0, 0 C1, 1 C2",
        "patch 0 bottom, 3 bottom: gap of 3e-4 at (0.5, 0, 0), u 0.5, v 0",
        "patch 0 right, 1 left: 30° at (1, ",
    ] {
        assert!(shown.stdout.contains(part), "no '{part}' in {shown:?}");
    }

    let report = run(&["inspect", &input, "--json"]).report();
    follows_the_schema(&report);
    let edges = &report["inspection"]["edges"];
    assert_eq!(edges["geometric"], json!({ "gaps": 1, "g0": 1, "g1": 0, "g2": 1 }));
    let worst = edges["worst"].as_array().unwrap();
    assert_eq!(worst.len(), 2, "an edge that is G2 is not among the worst");
    assert_eq!((&worst[0]["patches"], &worst[0]["geometric"]), (&json!([0, 3]), &Value::Null));
    assert!((worst[0]["position_gap"]["value"].as_f64().unwrap() - 3e-4).abs() < 1e-15);
    assert_eq!((&worst[1]["patches"], &worst[1]["sides"]), (&json!([0, 1]), &json!(["right", "left"])));
    assert!((worst[1]["angle_deg"]["value"].as_f64().unwrap() - 30.0).abs() < 1e-13);
}

#[test]
fn inspect_of_the_teapot_finds_no_kink_and_the_foot_worst() {
    let report = run(&["inspect", TEAPOT, "--json"]).report();
    follows_the_schema(&report);
    let edges = &report["inspection"]["edges"];
    // Of 128 sides: 8 in the two poles, 16 where rims, handle and spout end.
    assert_eq!(
        (&edges["shared"], &edges["boundary"], &edges["collapsed"]),
        (&json!(52), &json!(16), &json!(8))
    );
    assert_eq!(edges["geometric"], json!({ "gaps": 0, "g0": 0, "g1": 20, "g2": 32 }));
    assert_eq!(edges["parametric"], json!({ "c0": 6, "c1": 46, "c2": 0 }));
    let worst = edges["worst"].as_array().unwrap();
    assert_eq!(
        (worst.len(), &worst[0]["patches"], &worst[0]["angle_deg"]["value"]),
        (20, &json!([8, 31]), &json!(0.0))
    );
    // In the plane of a profile: two thirds of the distances of the third control points from the tangent, 0.5 outwards
    // in the wall and 0.075 inwards in the floor, over the square of the first steps; most at u = 0.5, where the quarter
    // circles reach farthest.
    let truth = 2.0 / 3.0 * 0.575 / (0.075 * 0.075) * (1.065 * 2.0_f64.sqrt() / 1.5);
    assert!((worst[0]["curvature_gap"]["value"].as_f64().unwrap() - truth).abs() < 1e-9 * truth);
}

#[test]
fn a_patch_on_its_own_has_only_a_boundary_and_triangles_have_no_edges_of_patches() {
    let folder = Folder::new("patches-one");
    let shown = run(&["inspect", &folder.file("a.bpt", PATCH)]);
    assert!(shown.stdout.contains("edges       4 on the boundary") && !shown.stdout.contains("joins"));
    let report = run(&["inspect", &folder.file("a.obj", common::CLOSED_OBJ), "--json"]).report();
    follows_the_schema(&report);
    assert!(report["inspection"].get("edges").is_none());
}
