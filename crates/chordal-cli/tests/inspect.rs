//! `chordal inspect` on sick files: each finding with its count, its place by number, and its cure.
use crate::common;

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
    let first = &report["inspection"]["findings"][0];
    assert!(first["advice"].as_str().unwrap().contains("one side only"));
    // Readers of other languages look their sentences up by these.
    assert_eq!(first["advice_code"], "inconsistent_edges");
    assert_eq!(first["sentences"], json!([{ "code": "inconsistent_edges" }]));
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
        "\n  4 boundary edges in 1 loop: the surface ends there, so that it has no inside; the filling may cross the \
         surface, which `inspect --self-intersections` shows afterwards\n\
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
    fails(&strip, "orientable", "not orientable: a component has only one side");
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

/// A GLB of cubes as meshes of their own, each from its lowest corner to the highest, moved by a node.
fn glb(cubes: &[([f32; 2], [f32; 3])]) -> Vec<u8> {
    let mut bin: Vec<u8> = CUBE.as_flattened().iter().flat_map(|i| (*i as u16).to_le_bytes()).collect();
    let (mut views, mut accessors) = (vec![json!({"buffer": 0, "byteLength": 72})], Vec::new());
    accessors.push(json!({"bufferView": 0, "componentType": 5123, "count": 36, "type": "SCALAR"}));
    let (mut meshes, mut nodes) = (Vec::new(), Vec::new());
    for (i, ([low, high], moved)) in cubes.iter().enumerate() {
        views.push(json!({"buffer": 0, "byteOffset": bin.len(), "byteLength": 96}));
        let side = |bit: u32| if bit == 1 { *high } else { *low };
        let points = (0..8_u32).flat_map(|i| [0, 1, 2].map(|k| side(i >> k & 1)));
        bin.extend(points.flat_map(f32::to_le_bytes));
        accessors.push(json!({"bufferView": i + 1, "componentType": 5126, "count": 8, "type": "VEC3",
            "min": [low, low, low], "max": [high, high, high]}));
        meshes.push(json!({"primitives": [{"attributes": {"POSITION": i + 1}, "indices": 0}]}));
        nodes.push(json!({"mesh": i, "translation": moved}));
    }
    let roots: Vec<usize> = (0..cubes.len()).collect();
    let mut text = json!({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": roots}], "nodes": nodes,
        "meshes": meshes, "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": bin.len()}]})
    .to_string();
    text.push_str(&" ".repeat(text.len().wrapping_neg() % 4));
    let mut file = b"glTF".to_vec();
    let words = [2, (12 + 8 + text.len() + 8 + bin.len()) as u32, text.len() as u32];
    file.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    [&file, &b"JSON"[..], text.as_bytes(), &(bin.len() as u32).to_le_bytes(), b"BIN\0", &bin].concat()
}

#[test]
fn h60_parts_that_cross_touch_or_nest_are_not_solid() {
    let folder = Folder::new("parts");
    let unit = [0.0, 1.0];
    let solid = |name: &str, cubes: &[([f32; 2], [f32; 3])]| {
        run(&["inspect", &folder.file(name, glb(cubes)), "--require", "solid"])
    };
    let apart = solid("apart.glb", &[(unit, [0.0; 3]), (unit, [2.0, 0.0, 0.0])]);
    apart.succeeds();
    assert!(apart.stdout.contains("outward, free of self-intersections"), "{}", apart.stdout);
    // Only where they stand do they cross.
    let crossing = solid("crossing.glb", &[(unit, [4.0, 0.0, 0.0]), (unit, [4.5, 0.5, 0.5])]);
    assert!(crossing.code == 1 && crossing.stderr.contains("self-intersecting: "), "{crossing:?}");
    for words in [" of part 0 and triangle ", " of part 1 at (", " in the scene"] {
        assert!(crossing.stderr.contains(words), "{crossing:?}");
    }
    assert!(crossing.stdout.contains("  is not      free of self-intersections\n"), "{}", crossing.stdout);
    let same = solid("same.glb", &[(unit, [0.0; 3]), (unit, [0.0; 3])]);
    assert!(same.stderr.contains("self-intersecting: 12 self-intersections"), "{same:?}");
    let touching = solid("touching.glb", &[(unit, [0.0; 3]), (unit, [1.0, 0.5, 0.0])]);
    assert!(touching.code == 1 && touching.stderr.contains("self-intersecting: "), "{touching:?}");
    let nested = solid("nested.glb", &[([0.0, 4.0], [0.0; 3]), (unit, [1.0; 3])]);
    assert!(nested.code == 1 && nested.stderr.contains("a part lies within another"), "{nested:?}");
    assert!(!nested.stdout.contains("outward,"), "{}", nested.stdout);
    // Stretched so far that no number holds it: what is not known is not held.
    let (moved, huge) = (r#""translation":[9.0,0.0,0.0]"#, r#""scale":[1e308,1.0,1.0]"#);
    let mut file = glb(&[([0.0, 4.0], [9.0, 0.0, 0.0]), (unit, [0.0; 3])]);
    let at = file.windows(moved.len()).position(|text| text == moved.as_bytes()).unwrap();
    file[at..at + moved.len()].copy_from_slice(format!("{huge:<width$}", width = moved.len()).as_bytes());
    let lost = run(&["inspect", &folder.file("lost.glb", file), "--require", "solid"]);
    assert!(lost.code == 1 && lost.stderr.contains("self-intersections are not known"), "{lost:?}");
    assert!(!lost.stdout.contains("free of"), "{}", lost.stdout);
}

#[test]
fn h55_points_without_triangles_are_nothing_and_need_nothing() {
    let folder = Folder::new("points");
    let points = folder.file("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    let shown = run(&["inspect", &points, "--self-intersections"]);
    assert_eq!(shown.code, 0);
    assert!(shown.stdout.ends_with("  surface     no triangles: points only\n"), "{}", shown.stdout);
    assert!(!shown.stdout.contains("drawing") && !shown.stdout.contains("mend"), "{}", shown.stdout);
    // Three corners in one row: a triangle that covers nothing.
    let collapsed = folder.file("collapsed.obj", "v 0 0 0\nf 1 1 1\n");
    let shown = run(&["inspect", &collapsed]).stdout;
    assert!(shown.contains("  1 collapsed triangle: ") && !shown.contains("  is "), "{shown}");
    for required in
        ["closed", "manifold", "oriented", "outward", "no-slivers", "no-unused", "no-self-intersections"]
    {
        let failed = run(&["inspect", &points, "--require", required, "-q"]);
        failed.fails_with(1, &["points.obj: there are no triangles to check"]);
        let failed = run(&["inspect", &collapsed, "--require", required, "-q"]);
        failed.fails_with(1, &["collapsed.obj: there is no surface to check: every triangle is collapsed"]);
    }
}

#[test]
fn the_letter_is_right_for_one_and_for_several_and_for_standard_input() {
    let folder = Folder::new("one-and-several");
    let letter = |text: &str| run(&["inspect", &folder.file("words.obj", text)]).stdout;
    let shown = letter("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nv 6 6 6\nf 1 2 3\n");
    assert!(shown.contains(", 1 triangle a vertex\n"), "{shown}");
    assert!(shown.contains("\n  2 unused vertices: no triangle has a corner there\n"), "{shown}");
    // A tetrahedron in which every triangle has corners of its own.
    let corners = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].as_flattened().iter();
    let rows = corners.map(|i| ["v 0 0 0\n", "v 1 0 0\n", "v 0 1 0\n", "v 0 0 1\n"][*i]);
    let apart: String = rows.chain(["f 1 2 3\nf 4 5 6\nf 7 8 9\nf 10 11 12\n"]).collect();
    let shown = letter(&apart);
    assert!(shown.contains("              no boundary edges where vertices meet by positions\n"), "{shown}");
    let mut child = common::chordal(&["inspect", "-", "--from", "obj"]);
    child.stdin(std::fs::File::open(folder.text("words.obj")).unwrap());
    let shown = common::Run::of(child.output().unwrap());
    assert!(shown.stdout.contains("chordal mend - --"), "{shown:?}");
}

#[test]
fn a_format_without_indices_is_sized_by_its_positions() {
    let folder = Folder::new("sizes");
    let (cube, soup) = (folder.file("cube.obj", obj(&corners(0.0), &CUBE)), folder.text("cube.stl"));
    run(&["mend", &cube, "-o", &soup, "--orient"]).succeeds();
    let shown = [&cube, &soup].map(|file| run(&["inspect", file]).stdout);
    for shown in &shown {
        assert!(shown.contains("  geometry    168 B indexed, 432 B unindexed\n"), "{shown}");
        assert!(shown.contains("  drawing     0.67 vertices a triangle"), "{shown}");
    }
}

#[test]
fn a_seam_that_is_open_by_a_rounding_is_named_and_welding_within_its_gap_closes_it() {
    // A sphere by longitude and latitude, whose last meridian is at sin(2π), which is not 0.
    let (n, m) = (24, 12);
    let mut text = String::new();
    for (j, i) in (0..=m).flat_map(|j| (0..=n).map(move |i| (j, i))) {
        let [t, p] = [f64::from(j) / f64::from(m), 2.0 * f64::from(i) / f64::from(n)]
            .map(|x| x * std::f64::consts::PI);
        text += &format!("v {} {} {}\n", t.sin() * p.cos(), t.sin() * p.sin(), t.cos());
    }
    for (j, i) in (0..m).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let a = j * (n + 1) + i + 1;
        let [b, c, d] = [a + 1, a + n + 1, a + n + 2];
        if j > 0 {
            text += &format!("f {a} {c} {b}\n");
        }
        if j + 1 < m {
            text += &format!("f {b} {c} {d}\n");
        }
    }
    let folder = Folder::new("inspect-seam");
    let (input, output) = (folder.file("sphere.obj", &text), folder.text("mended.obj"));
    let made = run(&["inspect", &input]);
    let tolerance = made.stdout.split("--weld=").nth(1).and_then(|rest| rest.split('`').next());
    let tolerance = tolerance.unwrap_or_else(|| panic!("{}", made.stdout));
    assert!(tolerance.parse::<f64>().is_ok_and(|gap| gap > 1e-17 && gap < 1e-15), "{tolerance}");
    let report = run(&["inspect", &input, "--json"]).report();
    let seams = &report["certificate"]["valid"]["open_seams"];
    let vertices = seams["vertices"].as_u64();
    assert!(
        vertices.is_some_and(|n| n >= 20)
            && seams["gap"].as_f64().is_some_and(|gap| gap <= tolerance.parse().unwrap()),
        "{seams}"
    );
    let findings = report["inspection"]["findings"].as_array().unwrap();
    let open = findings.iter().find(|found| found["of"] == "boundary_edges").unwrap();
    let values = json!({ "vertices": vertices.unwrap().to_string(), "within": tolerance });
    assert_eq!(open["sentences"][1], json!({ "code": "nearly-joined", "values": values }));
    let welded = run(&["mend", &input, &format!("--weld={tolerance}"), "--drop-degenerate", "-o", &output]);
    assert_eq!(welded.code, 0, "{welded:?}");
    let report = run(&["inspect", &output, "--json"]).report();
    let valid = &report["certificate"]["valid"];
    assert!(valid["closed"] == true && valid["open_seams"].is_null(), "{valid}");
}

#[test]
fn the_lines_of_a_script_are_listed_with_what_they_take() {
    let folder = Folder::new("line-costs");
    let script = "arm = move(box(9, 2, 2), 5, 0, 0)\nball = sphere(3)\nhalf = plane([0, 0, 1], 0)\n\
                  parts = [\n    rotate_z(arm, 60 * k)\n    for k in range(6)\n]\nunion(parts + [ball])\n";
    let file = folder.file("star.star", script);
    let found = run(&["inspect", &file, "--cost=0.05", "--json", "-q"]);
    found.succeeds();
    let report = found.report();
    let lines = report["run"]["lines"].as_array().unwrap();
    let numbers: Vec<&Value> = lines.iter().map(|line| &line["line"]).collect();
    assert_eq!(numbers, [&json!(1), &json!(2), &json!(3), &json!(5), &json!(8), &Value::Null], "{lines:#?}");
    assert_eq!(lines[0]["triangles"], 12);
    assert!(lines[1]["bound"]["at_most"].as_f64().unwrap() <= 0.05, "{lines:#?}");
    assert!(lines[2]["triangles"].is_null() && lines[2]["reason"].as_str().unwrap().contains("no end"));
    // The whole is what the last line ends with.
    assert_eq!(lines[4]["triangles"], lines[5]["triangles"]);
    assert!(lines.iter().all(|line| line["seconds"].as_f64().unwrap() >= 0.0));
    let text = run(&["inspect", &file, "--cost"]);
    text.succeeds();
    assert!(text.stdout.contains("line 1") && text.stdout.contains("whole"), "{}", text.stdout);
    let endless = folder.file("endless.star", "plane([0, 0, 1], 0)\n");
    let found = run(&["inspect", &endless, "--cost"]);
    assert!(found.code == 2 && found.stderr.contains("--cost=0.1"), "{}", found.stderr);
    // Without lines there is nothing to list.
    let mesh = run(&["inspect", &folder.file("cube.obj", CLOSED_OBJ), "--cost"]);
    assert_eq!(mesh.code, 2, "{}", mesh.stderr);
    assert!(mesh.stderr.contains("shape scripts"), "{}", mesh.stderr);
}
