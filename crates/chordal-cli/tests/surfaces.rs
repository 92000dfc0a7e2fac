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
