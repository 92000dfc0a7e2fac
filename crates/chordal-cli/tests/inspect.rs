//! `chordal inspect` on sick files: each finding with its count, its place by number, and its cure.
mod common;

use common::{CLOSED_OBJ, Folder, run};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicU32, Ordering};

/// A cube from 0 to 1 whose floor is the last two triangles; the front is outside.
const CUBE: [[u32; 3]; 12] = [
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
    [0, 2, 3],
    [0, 3, 1],
];

fn corners(offset: f64) -> Vec<[f64; 3]> {
    (0..8).map(|i| [0, 1, 2].map(|k| f64::from(i >> k & 1) + offset)).collect()
}

/// OBJ text; the file counts from 1.
fn obj(points: &[[f64; 3]], faces: &[[u32; 3]]) -> String {
    let points = points.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = faces.iter().map(|face| {
        let [a, b, c] = face.map(|i| i + 1);
        format!("f {a} {b} {c}\n")
    });
    points.chain(faces).collect()
}

fn inspected(text: &str, options: &[&str]) -> Value {
    // Tests run side by side, each with files of its own.
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let folder = Folder::new(&format!("sick-{}", NUMBER.fetch_add(1, Ordering::Relaxed)));
    let run = run(&[&["inspect", &folder.file("sick.obj", text), "--json", "-q"], options].concat());
    run.succeeds();
    run.report()
}

/// What a report says of one finding: its count and cures, and the rows of its first witness.
fn finding(report: &Value, of: &str) -> Value {
    let found = report["inspection"]["findings"].as_array().unwrap().iter().find(|f| f["of"] == of);
    let found = found.unwrap_or_else(|| panic!("no {of} in {report:#}"));
    let witnesses = report["certificate"]["valid"]["witnesses"].as_array().unwrap();
    let first = witnesses.iter().find(|witness| witness["of"] == of).unwrap();
    assert_eq!(found["count"], report["certificate"]["valid"][of], "{of}");
    json!([found["count"], found["cures"], first["vertices"], first["faces"]])
}

/// The names of all findings.
fn names(report: &Value) -> Vec<&str> {
    let findings = report["inspection"]["findings"].as_array().unwrap();
    findings.iter().map(|finding| finding["of"].as_str().unwrap()).collect()
}

#[test]
fn a_healthy_solid_has_nothing_to_mend() {
    let folder = Folder::new("healthy");
    let cube = folder.file("cube.obj", obj(&corners(0.0), &CUBE));
    let shown =
        run(&["inspect", &cube, "--self-intersections", "--require", "solid,single-component,no-slivers"]);
    shown.succeeds();
    for line in [
        "  surface     area 6, volume 1, genus 0, Euler number 2, 4.5 triangles a vertex",
        "  is          closed, manifold, oriented, outward, free of self-intersections",
        "  found       nothing to mend",
    ] {
        assert!(shown.stdout.contains(line), "{}", shown.stdout);
    }
    assert!(!shown.stdout.contains("cure"), "{}", shown.stdout);
}

#[test]
fn h58_a_moebius_strip_has_one_side_and_no_cure_for_that() {
    let points = [[3.0, 0.0, 0.0], [1.0, 2.0, 1.0], [-2.0, 2.0, -1.0], [-2.0, -2.0, 1.0], [1.0, -2.0, -1.0]];
    let strip = obj(&points, &[[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]]);
    let report = inspected(&strip, &[]);
    let valid = &report["certificate"]["valid"];
    assert_eq!((&valid["orientable"], &valid["outward"]), (&false.into(), &Value::Null));
    assert_eq!(names(&report), ["inconsistent_edges", "boundary_edges"]);
    let found = finding(&report, "inconsistent_edges");
    assert_eq!(found[1], json!([]));
    assert!(report["inspection"]["findings"][0]["advice"].as_str().unwrap().contains("one side only"));
    // Filled, it would still have no inside.
    assert_eq!(finding(&report, "boundary_edges"), json!([5, [], [2, 0], [0]]));
}

#[test]
fn h57_an_edge_with_three_faces_is_named_with_all_three() {
    let points = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]];
    let report = inspected(&obj(&points, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]), &[]);
    let found = finding(&report, "non_manifold_edges");
    assert_eq!(found, json!([1, ["--split-nonmanifold"], [0, 1], [0, 1, 2]]));
}

#[test]
fn h57_an_hourglass_is_named_by_its_waist() {
    let (mut points, mut faces) = (corners(0.0), CUBE.to_vec());
    points.extend(&corners(1.0)[1..]);
    // The second cube's lowest corner is the first one's highest.
    faces.extend(CUBE.map(|face| face.map(|i| if i == 0 { 7 } else { i + 7 })));
    let report = inspected(&obj(&points, &faces), &["--self-intersections"]);
    assert_eq!(names(&report), ["non_manifold_vertices"]);
    assert_eq!(finding(&report, "non_manifold_vertices"), json!([1, ["--split-nonmanifold"], [7], []]));
    assert_eq!(report["certificate"]["valid"]["outward"], true);
    // Split, the two waists are duplicates that nobody should weld again.
    let split: Vec<[u32; 3]> = CUBE.into_iter().chain(CUBE.map(|face| face.map(|i| i + 8))).collect();
    let report = inspected(&obj(&[corners(0.0), corners(1.0)].concat(), &split), &[]);
    assert_eq!(names(&report), ["duplicate_vertices"]);
    assert_eq!(finding(&report, "duplicate_vertices"), json!([1, [], [8, 7], []]));
}

#[test]
fn h57_a_t_junction_is_named_by_vertex_edge_and_face() {
    let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, -1.0, 0.0]];
    let report = inspected(&obj(&points, &[[0, 1, 2], [0, 4, 3], [3, 4, 1]]), &[]);
    assert_eq!(finding(&report, "t_junctions"), json!([1, ["--resolve-t-junctions"], [3, 0, 1], [0]]));
    // The boundary there is a crack before it is a hole.
    assert_eq!(finding(&report, "boundary_edges")[1], json!(["--resolve-t-junctions"]));
}

#[test]
fn h58_a_flipped_face_is_found_by_its_edges_and_can_be_turned() {
    let mut faces = CUBE;
    faces[4].swap(0, 1);
    let report = inspected(&obj(&corners(0.0), &faces), &[]);
    assert_eq!(names(&report), ["inconsistent_edges"]);
    let found = finding(&report, "inconsistent_edges");
    assert_eq!((&found[0], &found[1]), (&3.into(), &json!(["--orient"])));
    for witness in report["certificate"]["valid"]["witnesses"].as_array().unwrap() {
        assert!(witness["faces"].as_array().unwrap().contains(&4.into()), "{witness}");
    }
}

#[test]
fn a_cube_without_its_floor_has_one_loop_to_fill() {
    let report = inspected(&obj(&corners(0.0), &CUBE[..10]), &[]);
    assert_eq!(names(&report), ["boundary_edges"]);
    assert_eq!(finding(&report, "boundary_edges"), json!([4, ["--fill-holes"], [0, 1], [2]]));
    let valid = &report["certificate"]["valid"];
    assert_eq!((&valid["boundary_loops"], &valid["volume"]), (&1.into(), &Value::Null));
}

#[test]
fn h58_inside_out_and_nested_shells() {
    let turned = CUBE.map(|[a, b, c]| [a, c, b]);
    let report = inspected(&obj(&corners(0.0), &turned), &[]);
    assert_eq!(finding(&report, "inside_out"), json!([1, ["--orient"], [], [0]]));
    assert_eq!(report["certificate"]["valid"]["volume"], -1.0);
    // A shell within: wound inward it is a cavity, outward it is inside out.
    let inner: Vec<[f64; 3]> = corners(0.0).iter().map(|p| p.map(|x| 0.25 + 0.5 * x)).collect();
    let points = [corners(0.0), inner].concat();
    for (shell, outward) in [(turned, true), (CUBE, false)] {
        let faces: Vec<[u32; 3]> = CUBE.into_iter().chain(shell.map(|face| face.map(|i| i + 8))).collect();
        let report = inspected(&obj(&points, &faces), &[]);
        let valid = &report["certificate"]["valid"];
        assert_eq!(valid["outward"], outward);
        assert_eq!(
            (&valid["component_list"][0]["depth"], &valid["component_list"][1]["depth"]),
            (&0.into(), &1.into())
        );
        assert_eq!(names(&report).is_empty(), outward);
    }
}

#[test]
fn h60_overlapping_solids_are_counted_only_when_asked() {
    let points = [corners(0.0), corners(0.5)].concat();
    let faces: Vec<[u32; 3]> = CUBE.into_iter().chain(CUBE.map(|face| face.map(|i| i + 8))).collect();
    let text = obj(&points, &faces);
    let plain = inspected(&text, &[]);
    assert_eq!(plain["certificate"]["valid"]["self_intersections"], Value::Null);
    assert!(names(&plain).is_empty());
    let deep = inspected(&text, &["--self-intersections"]);
    let found = finding(&deep, "self_intersections");
    assert!(found[0].as_u64().unwrap() >= 6 && found[1] == json!([]), "{found}");
    assert_eq!((&found[2], found[3].as_array().unwrap().len()), (&json!([]), 2));
    assert!(deep["inspection"]["findings"][0]["advice"].is_string());
}

#[test]
fn h56_duplicates_and_lonely_vertices_are_counted_and_nothing_is_merged() {
    let mut points = corners(0.0);
    points.extend([[1.0, 1.0, 1.0], [9.0, 9.0, 9.0]]);
    let mut faces = CUBE.to_vec();
    // One corner by another number, one face twice and once back to back.
    faces[0] = [4, 5, 8];
    faces.extend([faces[10], [faces[11][0], faces[11][2], faces[11][1]]]);
    let report = inspected(&obj(&points, &faces), &[]);
    assert_eq!(finding(&report, "duplicate_vertices"), json!([1, ["--weld"], [8, 7], []]));
    assert_eq!(finding(&report, "duplicate_faces"), json!([2, ["--drop-duplicates"], [], [12, 10]]));
    assert_eq!(report["certificate"]["valid"]["opposite_faces"], 1);
    assert_eq!(finding(&report, "unused_vertices"), json!([1, ["--drop-unused"], [9], []]));
    assert_eq!(finding(&report, "boundary_edges")[1], json!(["--weld"]));
    assert_eq!(report["certificate"]["output"]["vertices"], 10);
}

#[test]
fn h55_points_lines_and_needles_are_told_apart() {
    let points = [
        [1.0, 1.0, 1.0],
        [1.0, 1.0, 1.0],
        [2.0, 2.0, 2.0],
        [3.0, 3.0, 3.0],
        [1e12, 0.0, 0.0],
        [5e11, 1.0, 0.0],
        [0.0; 3],
    ];
    let report = inspected(&obj(&points, &[[0, 0, 1], [0, 2, 3], [6, 4, 5]]), &["--self-intersections"]);
    // What is dropped leaves its vertices behind.
    assert_eq!(
        finding(&report, "collapsed_faces"),
        json!([1, ["--drop-degenerate", "--drop-unused"], [], [0]])
    );
    assert_eq!(finding(&report, "zero_area_faces"), json!([2, ["--drop-degenerate"], [], [0]]));
    assert_eq!(finding(&report, "slivers"), json!([1, [], [], [2]]));
    // All in one point: counted, and nothing is not a number.
    let point = inspected(&obj(&[[7.0; 3]; 3], &[[0, 1, 2]]), &["--self-intersections"]);
    assert_eq!(point["certificate"]["valid"]["area"], 0.0);
    assert_eq!(finding(&point, "zero_area_faces")[0], 1);
}

#[test]
fn h54_huge_tiny_and_far_coordinates_change_no_verdict() {
    let place = |place: &dyn Fn(f64) -> f64| {
        let points: Vec<[f64; 3]> = corners(0.0).iter().map(|p| p.map(place)).collect();
        inspected(&obj(&points, &CUBE), &["--self-intersections"])
    };
    let scaled = [1e30, 1e-30, 1e-300].map(|scale| place(&|x| x * scale));
    let far = place(&|x| x * 0.001953125 + 5e6);
    let signed = place(&|x| if x == 0.0 { -0.0 } else { x });
    for report in scaled.iter().chain([&far, &signed]) {
        let valid = &report["certificate"]["valid"];
        assert!(names(report).is_empty(), "{:#}", report["inspection"]);
        assert_eq!((&valid["outward"], &valid["self_intersections"]), (&true.into(), &0.into()));
    }
    // Tiny and huge in one mesh: a needle, but no nonsense.
    let mixed = inspected(
        &obj(&[[0.0; 3], [1e30, 0.0, 0.0], [0.0, 1e-30, 0.0]], &[[0, 1, 2]]),
        &["--self-intersections"],
    );
    assert_eq!(names(&mixed), ["boundary_edges", "slivers"]);
}

#[test]
fn the_letter_names_place_meaning_and_cure() {
    let folder = Folder::new("letter");
    let file = folder.file("open.obj", obj(&corners(0.0), &CUBE[..10]));
    let shown = run(&["inspect", &file]);
    shown.succeeds();
    let wanted = format!(
        "\n  4 boundary edges in 1 loop: the surface ends there, so that it has no inside; what fills it may cross the \
         surface, which `inspect --self-intersections` tells afterwards\n\
         \x20   where     edge 0-1 of triangle 2 at (0.5, 0, 0)\n\
         \x20             edge 3-2 of triangle 5 at (0.5, 1, 0)\n\
         \x20             and 2 more\n\
         \x20   cure      --fill-holes\n\
         \n  to mend     chordal mend {file} --fill-holes -o OUT\n"
    );
    assert!(shown.stdout.ends_with(&wanted), "{}", shown.stdout);
    assert!(shown.stdout.contains("  is not      closed\n"), "{}", shown.stdout);
}

#[test]
fn every_requirement_names_count_and_place() {
    let folder = Folder::new("requirements");
    let fails = |text: &str, required: &str, says: &str| {
        let failed = run(&["inspect", &folder.file("a.obj", text), "--require", required, "-q"]);
        assert!(failed.code == 1 && failed.stdout.is_empty(), "{failed:?}");
        assert!(failed.stderr.lines().all(|line| line.contains("a.obj: ")), "{failed:?}");
        assert!(failed.stderr.contains(says), "{failed:?}");
    };
    let open = obj(&corners(0.0), &CUBE[..10]);
    fails(
        &open,
        "closed",
        "not closed: 4 boundary edges, the first is edge 0-1 of triangle 2 at (0.5, 0, 0)",
    );
    fails(&open, "outward", "not outward: a component has no inside");
    fails(&open, "solid", "not closed: 4 boundary edges");
    let turned = obj(&corners(0.0), &CUBE.map(|[a, b, c]| [a, c, b]));
    fails(&turned, "outward", "not outward: 1 component inside out, triangle 0 at (0.666667, 0.333333, 1)");
    let two: Vec<[u32; 3]> = CUBE.into_iter().chain(CUBE.map(|face| face.map(|i| i + 8))).collect();
    let crossing = obj(&[corners(0.0), corners(0.5)].concat(), &two);
    fails(&crossing, "no-self-intersections", "self-intersecting: ");
    fails(&crossing, "solid", "self-intersecting: ");
    fails(&crossing, "single-component", "not a single component: 2 components");
    let fin = format!("{CLOSED_OBJ}v 5 5 5\nf 1 2 5\n");
    fails(
        &fin,
        "edge-manifold",
        "not manifold: 1 edge of three triangles or more, edge 1-0 of triangles 0, 1, 4 at",
    );
    fails(&fin, "vertex-manifold", "not manifold: 2 vertices of several fans, the first is vertex ");
    let spoilt = format!("{open}v 0 0 0\nv 2 2 2\nv 4 4 4\nf 9 10 11\nv 9 9 9\nf 1 2 6\nf 1 2 6\n");
    fails(&spoilt, "no-degenerate", "degenerate: 1 triangle of no area, triangle 10 at");
    fails(&spoilt, "no-duplicates", "duplicates: 2 repeated triangles, the first is triangles 11, 2 at");
    fails(&spoilt, "no-duplicates", "duplicates: 1 duplicate vertex, vertex 8, equal to 0, at (0, 0, 0)");
    fails(&spoilt, "no-unused", "unused: 1 unused vertex, vertex 11 at (9, 9, 9)");
    let strip = obj(&corners(0.0), &[[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]]);
    fails(&strip, "orientable", "not orientable: a component has one side only");
    fails(&strip, "oriented", "not oriented: ");
    let needle = obj(&[[0.0; 3], [1.0, 0.0, 0.0], [0.5, 0.001, 0.0]], &[[0, 1, 2]]);
    fails(&needle, "no-slivers", "slivers: 1 sliver, triangle 0 at");
    let split = obj(
        &[[0.0; 3], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, -1.0, 0.0]],
        &[[0, 1, 2], [0, 4, 3], [3, 4, 1]],
    );
    fails(
        &split,
        "no-t-junctions",
        "T-junctions: 1 T-junction, vertex 3 on edge 0-1 of triangle 0 at (1, 0, 0)",
    );
    let all = "solid,closed,manifold,edge-manifold,vertex-manifold,oriented,orientable,outward,single-component,\
        no-self-intersections,no-t-junctions,no-degenerate,no-duplicates,no-slivers,no-unused";
    run(&["inspect", &folder.file("cube.obj", obj(&corners(0.0), &CUBE)), "--require", all, "-q"]).succeeds();
}
