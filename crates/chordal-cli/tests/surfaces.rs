//! NURBS surfaces in JSON, whole and trimmed, through the command.
use crate::common;

use common::{Folder, run};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// A cylinder of radius 1 and height 2: its wall, and two squares of which a disc is left.
fn cylinder() -> String {
    let w = FRAC_1_SQRT_2;
    let square = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]];
    let row = |z: i32| {
        let points: Vec<String> = square.iter().map(|[x, y]| format!("[{x}, {y}, {z}]")).collect();
        format!("[{}]", points.join(", "))
    };
    let weights = format!("[1, {w}, 1, {w}, 1, {w}, 1, {w}, 1]");
    let quarters = "[0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]";
    let wall = format!(
        r#"{{"degree": [2, 1], "knots": [{quarters}, [0, 0, 1, 1]], "control": [{}, {}], "weights": [{weights}, {weights}]}}"#,
        row(0),
        row(2)
    );
    let around: Vec<String> = square.iter().map(|[x, y]| format!("[{x}, {y}]")).collect();
    let lid = |z: i32, flip: bool| {
        format!(
            r#"{{"degree": [1, 1], "knots": [[-2, -2, 2, 2], [-2, -2, 2, 2]], "flip": {flip},
                "control": [[[-2, -2, {z}], [2, -2, {z}]], [[-2, 2, {z}], [2, 2, {z}]]],
                "trim": [[{{"degree": 2, "knots": {quarters}, "control": [{}], "weights": {weights}}}]]}}"#,
            around.join(", ")
        )
    };
    format!(r#"{{"surfaces": [{wall}, {}, {}]}}"#, lid(0, true), lid(2, false))
}

#[test]
fn trimmed_faces_become_a_closed_solid_whose_bound_is_proved_again() {
    let folder = Folder::new("surfaces-solid");
    let input = folder.file("cylinder.json", cylinder());
    for budget in [["--tol", "1e-3"], ["--triangles", "300"], ["--tol", "0.05%"]] {
        let out = folder.text("cylinder.glb");
        let made = run(&[&["mesh", &input, "-o", &out, "--json", "--force"], &budget[..]].concat());
        made.succeeds();
        let certificate = &made.report()["certificate"];
        assert_eq!(certificate["bound"]["evidence"], "proved", "{}", certificate["bound"]);
        let valid = &certificate["valid"];
        assert!(valid["closed"] == true && valid["manifold"] == true, "{budget:?} {certificate}");
        let at_most = certificate["bound"]["at_most"].as_f64().unwrap();
        let volume = certificate["valid"]["volume"].as_f64();
        assert!(volume.is_none_or(|v| (v - 2.0 * PI).abs() < 16.0 * at_most), "{volume:?} {at_most}");
        run(&["verify", &out, "--against", &input]).succeeds();
    }
    let seen = run(&["inspect", &input, "--json"]);
    seen.succeeds();
}

#[test]
fn loops_that_cannot_be_are_one_sentence() {
    let folder = Folder::new("surfaces-loops");
    for (loops, says) in [
        (
            "[[0.1, 0.1], [0.9, 0.9], [0.9, 0.1], [0.1, 0.8], [0.1, 0.1]]",
            "crosses itself or another one near u",
        ),
        ("[[0.1, 0.1], [0.1, 0.9], [0.9, 0.9], [0.1, 0.1]]", "trim loop 0 of surface 0 runs backwards"),
        ("[[0.1, 0.1], [0.9, 0.9]]", "curve 0 of a trim loop does not start where the one before it ends"),
    ] {
        let text = format!(
            r#"{{"surfaces": [{{"degree": [1, 1], "knots": [[0, 0, 1, 1], [0, 0, 1, 1]],
                "control": [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 1]]], "trim": [[{{"control": {loops}}}]]}}]}}"#
        );
        let input = folder.file("loops.json", text);
        run(&["mesh", &input, "--tol", "0.01", "-o", &folder.text("out.stl")]).fails_with(3, &[says]);
    }
}

/// Surfaces that are constructed from curves, and what of the bound is known of them.
const CONSTRUCTED: [(&str, &str); 7] = [
    (
        "loft",
        r#"{"loft": {"sections": [
            {"circle": {"centre": [0, 0, 0], "axes": [[2, 0, 0], [0, 2, 0]]}},
            {"circle": {"centre": [0, 0, 2], "axes": [[3, 0, 0], [0, 3, 0]]}},
            {"circle": {"centre": [0, 0, 4], "axes": [[1, 0, 0], [0, 1, 0]]}}]}}"#,
    ),
    (
        "coons",
        r#"{"coons": {"u": [{"through": [[0, 0, 0], [1, 0, 1], [2, 0, 0]]}, {"line": [[0, 3, 0], [2, 3, 0]]}],
            "v": [{"line": [[0, 0, 0], [0, 3, 0]]}, {"control": [[2, 0, 0], [3, 1, 0], [2, 3, 0]]}]}}"#,
    ),
    (
        "sweep",
        r#"{"sweep": {"profile": {"circle": {"centre": [0, 0], "axes": [[0.3, 0], [0, 0.3]]}},
            "path": {"through": [[0, 0, 0], [2, 0, 1], [3, 2, 2], [1, 3, 3], [0, 1, 4]]}}}"#,
    ),
    (
        "torus",
        r#"{"sweep": {"profile": {"circle": {"centre": [0, 0], "axes": [[0.5, 0], [0, 0.5]]}},
            "path": {"arc": {"centre": [0, 0, 0], "axes": [[2, 0, 0], [0, 2, 0]]}}}}"#,
    ),
    (
        "extrude",
        r#"{"extrude": {"profile": {"arc": {"centre": [0, 0], "axes": [[1, 0], [0, 1]], "sweep_deg": 90}},
            "along": [0, 0, 2]}}"#,
    ),
    ("revolve", r#"{"revolve": {"profile": {"control": [[1, 0], [2, 1], [1, 2]]}}}"#),
    (
        "ruled",
        r#"{"ruled": [{"line": [[0, 0, 0], [1, 0, 0]]}, {"through": [[0, 1, 1], [0.5, 1, 2], [1, 1, 1]]}]}"#,
    ),
];

#[test]
fn constructed_surfaces_are_meshed_in_one_command_and_proved_again() {
    let folder = Folder::new("surfaces-constructed");
    let length = if chordal_testkit::is_long() { "0.01" } else { "0.03" };
    for (name, surface) in CONSTRUCTED {
        let input = folder.file(&format!("{name}.json"), format!(r#"{{"surfaces": [{surface}]}}"#));
        let out = folder.text(&format!("{name}.glb"));
        let made = run(&["mesh", &input, "-o", &out, "--tol", length, "--json"]);
        made.succeeds();
        let certificate = &made.report()["certificate"];
        assert_eq!(certificate["bound"]["evidence"], "proved", "{name} {}", certificate["bound"]);
        assert!(certificate["bound"]["at_most"].as_f64().unwrap() <= length.parse().unwrap(), "{name}");
        assert_eq!(certificate["valid"]["closed"], name == "torus", "{name}");
        run(&["verify", &out, "--against", &input]).succeeds();
    }
}

#[test]
fn the_slack_of_a_sweep_is_part_of_every_bound() {
    let folder = Folder::new("surfaces-slack");
    let (_, sweep) = CONSTRUCTED[2];
    let with = |tolerance: &str| {
        let sweep = sweep.replace("\"path\"", &format!("\"tolerance\": {tolerance}, \"path\""));
        folder.file("slack.json", format!(r#"{{"surfaces": [{sweep}]}}"#))
    };
    let out = folder.text("slack.stl");
    // What the construction may be off is more than the mesh may be.
    let made = run(&["mesh", &with("1e-3"), "-o", &out, "--tol", "1e-5"]);
    made.fails_with(5, &["from how they were constructed"]);
    let made = run(&["mesh", &with("1e-3"), "-o", &out, "--tol", "2e-3", "--json", "--force"]);
    made.succeeds();
    let at_most = made.report()["certificate"]["bound"]["at_most"].as_f64().unwrap();
    assert!((1e-4..=2e-3).contains(&at_most), "{at_most}");
}

#[test]
fn constructions_that_cannot_be_are_one_sentence_with_their_place() {
    let folder = Folder::new("surfaces-wrong");
    let line = r#"{"line": [[0, 0, 0], [1, 0, 0]]}"#;
    for (surface, says) in [
        (
            format!(r#"{{"loft": {{"sections": [{line}, {line}]}}}}"#),
            "/surfaces/0/loft: section 0 and the next one are equal, so that their parameters would be too",
        ),
        (
            format!(r#"{{"loft": {{"sections": [{line}], "degree": 2}}}}"#),
            "/surfaces/0/loft: degree 2 needs 3 sections at least, and there are 1",
        ),
        (
            r#"{"loft": {"sections": [{"line": [[0, 0, 0]]}]}}"#.to_owned(),
            "/surfaces/0/loft/sections/0: 1 points where a line has 2",
        ),
        (
            r#"{"coons": {"u": [{"line": [[0, 0], [1, 0]]}, {"line": [[0, 1], [1, 1]]}],
                "v": [{"line": [[0, 0], [0, 1]]}, {"line": [[1, 0], [1, 1.5]]}]}}"#
                .to_owned(),
            "/surfaces/0/coons: the boundary curves do not meet at the end of both: they are 5e-1 apart",
        ),
        (
            format!(
                r#"{{"sweep": {{"profile": {line}, "path": {{"degree": 1, "control": [[0, 0, 0], [1, 0, 0], [1, 1, 0]]}}}}}}"#
            ),
            "/surfaces/0/sweep: the path has a kink of 90.000° at its parameter 1: split it there, or round it",
        ),
        (format!(r#"{{"sweep": {{"path": {line}}}}}"#), "/surfaces/0/sweep: there is no member \"profile\""),
        (
            format!(r#"{{"extrude": {{"profile": {line}, "along": [0, 1]}}}}"#),
            "/surfaces/0/extrude/along: 2 numbers where 3 are needed",
        ),
        (
            format!(r#"{{"revolve": {{"profile": {line}}}}}"#),
            "/surfaces/0/revolve/profile: 3 numbers a point where 2 are needed",
        ),
        (format!(r#"{{"ruled": [{line}]}}"#), "/surfaces/0/ruled: 1 curves where 2 are needed"),
        (
            format!(r#"{{"ruled": [{line}, {line}], "degree": [1, 1]}}"#),
            "/surfaces/0: a surface has \"ruled\" or control points, not both",
        ),
        (
            format!(r#"{{"ruled": [{line}, {line}], "loft": {{"sections": []}}}}"#),
            "/surfaces/0/loft: a surface has \"ruled\" or \"loft\", not both",
        ),
        (
            r#"{"revolve": {"profile": {"arc": {"axes": [[1, 0], [0, 1]]}}}}"#.to_owned(),
            "/surfaces/0/revolve/profile/arc: there is no member \"centre\"",
        ),
    ] {
        let input = folder.file("wrong.json", format!(r#"{{"surfaces": [{surface}]}}"#));
        run(&["mesh", &input, "--tol", "0.01", "-o", &folder.text("out.stl")]).fails_with(3, &[says]);
    }
}

#[test]
fn inspect_says_how_smooth_surfaces_are_and_where_they_are_worst() {
    let folder = Folder::new("surfaces-inspect");
    // A tube whose arc runs straight on into a plane: curvature jumps there; and a wall at a right angle.
    let arc = r#"{"extrude": {"profile": {"arc": {"centre": [0, 1], "axes": [[1, 0], [0, 1]], "start_deg": 180, "sweep_deg": 90}},
        "along": [0, 0, 2]}}"#;
    let floor = r#"{"ruled": [{"line": [[0, 0, 0], [3, 0, 0]]}, {"line": [[0, 0, 2], [3, 0, 2]]}]}"#;
    let wall = r#"{"ruled": [{"line": [[3, 0, 0], [3, 1, 0]]}, {"line": [[3, 0, 2], [3, 1, 2]]}]}"#;
    let input = folder.file("bend.json", format!(r#"{{"surfaces": [{arc}, {floor}, {wall}]}}"#));
    let seen = run(&["inspect", &input, "--json"]);
    seen.succeeds();
    let inspection = &seen.report()["inspection"];
    assert_eq!(inspection["surfaces"], 3);
    let edges = &inspection["surface_edges"];
    assert_eq!((&edges["shared"], &edges["boundary"]), (&2.into(), &8.into()), "{edges}");
    assert_eq!(edges["geometric"], serde_json::json!({"gaps": 0, "g0": 1, "g1": 1, "g2": 0}));
    let (kink, jump) = (&edges["worst"][0], &edges["worst"][1]);
    assert_eq!(kink["surfaces"], serde_json::json!([1, 2]));
    assert_eq!(kink["angle_deg"]["value"], 90.0);
    assert!((jump["curvature_gap"]["value"].as_f64().unwrap() - 1.0).abs() < 1e-9, "{jump}");
    let text = run(&["inspect", &input]);
    text.succeeds();
    for says in ["3", "2 shared, 8 on the boundary", "1 kink, 1 G1, 0 G2", "surface 1 at u 1, 2 at u 0: 90°"]
    {
        assert!(text.stdout.contains(says), "{says}: {}", text.stdout);
    }
}
