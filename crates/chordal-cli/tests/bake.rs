//! Baking through the command: a closed mesh and back, one with a hole, what is refused.
use crate::common;

use common::{CLOSED_OBJ, Folder, OPEN_OBJ, Run, run};
use serde_json::Value;

/// A cube of side 2 about the origin.
const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

#[track_caller]
fn report(run: &Run) -> Value {
    assert_eq!(run.code, 0, "{run:?}");
    let report = run.report();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<String> = schema.iter_errors(&report).map(|error| error.to_string()).collect();
    assert_eq!(errors, [""; 0], "{report:#}");
    report
}

#[test]
fn a_cube_comes_back_from_its_distances() {
    let folder = Folder::new("bake-cube");
    let input = folder.file("cube.obj", CUBE);
    for band in [None, Some("2")] {
        let grid = folder.text("cube.nrrd");
        let mut args = vec!["bake", &input, "--cells", "20", "-o", &grid, "--json", "--force"];
        args.extend(band.iter().flat_map(|band| ["--band", *band]));
        let made = report(&run(&args));
        let baked = &made["certificate"]["baked"];
        assert_eq!(baked["solid"]["is_solid"], true);
        assert_eq!(baked["solid"]["sentence"], "the mesh is a solid");
        assert_eq!(baked["evidence"], "proved");
        assert!((baked["spacing"].as_f64().unwrap() - 0.1).abs() < 1e-12, "2 in 20 cells, but for rounding");
        assert!(baked["off_at_most"].as_f64().unwrap() < 1e-12, "a few last places: rounding");
        assert_eq!(baked["band"].is_null(), band.is_none());
        let all: u64 = baked["size"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).product();
        assert_eq!(baked["distances"].as_u64().unwrap() == all, band.is_none(), "{baked:#}");

        let back = folder.text("back.ply");
        let meshed = report(&run(&["mesh", &grid, "-o", &back, "--json", "--force"]));
        assert_eq!(meshed["certificate"]["valid"]["closed"], true);
        let seen = report(&run(&["inspect", &back, "--json"]));
        for k in 0..3 {
            let end = |side: usize| seen["inspection"]["box"][side][k].as_f64().unwrap();
            // The sides are where they were; nothing of a cube is between samples but its edges.
            assert!((end(0) + 1.0).abs() < 1e-6 && (end(1) - 1.0).abs() < 1e-6, "single precision: {seen:#}");
        }
    }
}

#[test]
fn an_array_of_numpy_has_the_distances_and_the_report_its_place() {
    let folder = Folder::new("bake-npy");
    let input = folder.file("corner.obj", CLOSED_OBJ);
    let output = folder.text("corner.npy");
    let made = report(&run(&["bake", &input, "--cells", "8", "-o", &output, "--json"]));
    let notes = made["certificate"]["notes"].to_string();
    assert!(notes.contains("npy holds no origin"), "{notes}");
    let seen = report(&run(&["inspect", &output, "--json"]));
    assert_eq!(seen["inspection"]["volume"]["samples"], "f64");
    assert_eq!(seen["inspection"]["volume"]["size"], made["certificate"]["baked"]["size"]);
}

#[test]
fn a_mesh_with_a_hole_says_that_it_is_no_solid() {
    let folder = Folder::new("bake-open");
    let input = folder.file("open.obj", OPEN_OBJ);
    let output = folder.text("open.nrrd");
    let run = run(&["bake", &input, "--cells", "8", "-o", &output]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.stderr.contains("not a solid: 3 edges have one triangle only"), "{run:?}");
    assert!(run.stdout.contains("certain only away from holes"), "{run:?}");
}

#[test]
fn what_is_no_mesh_or_no_lattice_is_refused() {
    let folder = Folder::new("bake-refused");
    let input = folder.file("corner.obj", CLOSED_OBJ);
    let [ply, nrrd] = ["a.ply", "a.nrrd"].map(|name| folder.text(name));
    let code = |args: &[&str]| run(args).code;
    assert_eq!(code(&["bake", &input, "--cells", "8", "-o", &ply]), 2);
    assert_eq!(code(&["bake", &input, "--cells", "0", "-o", &nrrd]), 2);
    assert_eq!(code(&["bake", &input, "--cells", "8", "--band", "-1", "-o", &nrrd]), 2);
    assert_eq!(code(&["bake", &input, "-o", &nrrd]), 2, "neither cells nor a length");
    assert_eq!(code(&["bake", &input, "--cells", "8", "--tol", "0.1", "-o", &nrrd]), 2, "both");
    assert_eq!(code(&["bake", &input, "--cells", "8", "--sparse", "-o", &nrrd]), 2, "sparse without a band");
    let curve = folder.file("a.svg", "<svg xmlns='http://www.w3.org/2000/svg'><circle r='1'/></svg>");
    run(&["bake", &curve, "--cells", "8", "-o", &nrrd]).fails_with(2, &["drawings bound no solid"]);
    run(&["bake", &input, "--cells", "100", "--max-memory", "1M", "-o", &nrrd])
        .fails_with(5, &["samples need", "bytes; the limit is 1048576"]);
    run(&["bake", &input, "--cells", "1000000", "-o", &nrrd])
        .fails_with(3, &["no lattice with 1000000 cells"]);
    assert_eq!(folder.names(), ["a.svg", "corner.obj"]);
}

#[test]
fn a_length_chooses_the_cells_for_any_shape() {
    let folder = Folder::new("bake-length");
    let shapes = [
        (folder.file("ball.star", "sphere(1)"), "none", 0.03, "field", "field"),
        (folder.file("box.star", "box(2, 2, 1)"), "none", 0.03, "field", "field"),
        (folder.file("cut.star", "box(2, 2, 1) - cylinder(0.4, 2)"), "none", 0.05, "tessellation", "field"),
        (folder.file("cage.obj", CUBE), "catmull-clark", 0.05, "tessellation", "limit surface"),
        (folder.file("cube.obj", CUBE), "none", 0.05, "triangles", "input triangles"),
    ];
    let grid = folder.text("grid.nrrd");
    for (shape, surface, length, route, reference) in shapes {
        let tol = length.to_string();
        let mut args = vec!["bake", &shape, "--tol", &tol, "-o", &grid, "--json", "--force"];
        if surface != "none" {
            args.extend(["--surface", surface]);
        }
        let made = report(&run(&args));
        let certificate = &made["certificate"];
        assert_eq!(certificate["baked"]["route"], route, "{shape}");
        assert_eq!(certificate["bound"]["evidence"], "proved", "{shape}");
        assert_eq!(certificate["bound"]["reference"], reference, "{shape}");
        assert!(certificate["bound"]["at_most"].as_f64().unwrap() <= length, "{shape}: {certificate:#}");
        assert_eq!(certificate["budget"]["length"].as_f64(), Some(length), "{shape}");
        let between = certificate["baked"]["interpolant"]["at_most"].as_f64().unwrap();
        let spacing = certificate["baked"]["spacing"].as_f64().unwrap();
        let off = certificate["baked"]["off_at_most"].as_f64().unwrap();
        assert!(between >= 0.866 * spacing && between <= 0.8661 * spacing + off, "{shape}: {certificate:#}");
    }
}

#[test]
fn what_a_length_claims_is_proved_again() {
    let folder = Folder::new("bake-length-verify");
    let (input, grid) = (folder.file("cube.obj", CUBE), folder.text("cube.nrrd"));
    report(&run(&["bake", &input, "--tol", "0.05", "-o", &grid, "--json"]));
    let verified = run(&["verify", &grid, "--against", &input]);
    assert_eq!(verified.code, 0, "{verified:?}");
    assert!(verified.stdout.contains("baked/interpolant"), "{verified:?}");
}

#[test]
fn an_unmet_length_keeps_the_best_where_it_is_asked_to() {
    let folder = Folder::new("bake-unmet");
    let (input, grid) = (folder.file("open.obj", OPEN_OBJ), folder.text("open.nrrd"));
    let args = ["bake", &input, "--tol", "0.1", "-o", &grid];
    run(&args).fails_with(5, &["the budget was not met", "mend them first", "--keep-best writes it"]);
    assert_eq!(folder.names(), ["open.obj"]);
    let kept = run(&[&args[..], &["--keep-best"]].concat());
    assert_eq!(kept.code, 5, "{kept:?}");
    assert_eq!(folder.names(), ["open.nrrd", "open.obj"]);
    // A cube through whose memory the lattice does not fit.
    let ball = folder.file("cut.star", "box(2, 2, 1) - cylinder(0.4, 2)");
    let small = run(&["bake", &ball, "--tol", "0.01", "--max-memory", "3M", "-o", &folder.text("a.nrrd")]);
    small.fails_with(5, &["the best reached is between", "--max-memory allows more"]);
}

#[test]
fn sparse_samples_are_the_dense_ones() {
    let folder = Folder::new("bake-sparse");
    let input = folder.file("cube.obj", CUBE);
    for format in ["nrrd", "npy"] {
        let [dense, sparse] = ["dense", "sparse"].map(|name| folder.text(&format!("{name}.{format}")));
        let args = |out, more: &[&'static str]| {
            let fixed = ["bake", input.as_str(), "--cells", "60", "--band", "2", "-o", out, "--json"];
            report(&run(&[&fixed[..], more].concat()))
        };
        let (all, some) = (args(&dense, &[]), args(&sparse, &["--sparse"]));
        let [stored, bricks] = [0, 1].map(|k| some["certificate"]["baked"]["bricks"][k].as_u64().unwrap());
        assert!(stored < bricks, "{some:#}");
        assert_eq!(all["certificate"]["baked"]["distances"], some["certificate"]["baked"]["distances"]);
        if format == "npy" {
            assert!(std::fs::read(&dense).unwrap() == std::fs::read(&sparse).unwrap());
        } else {
            // The digest is of the samples that a reader gets.
            let of =
                |report: &Value| report["certificate"]["history"]["steps"][0]["output"]["geometry"].clone();
            assert_eq!(of(&all), of(&some));
            let verified = run(&["verify", &sparse, "--against", &input]);
            assert!(verified.stdout.contains("re-proved   geometry"), "{verified:?}");
            assert!(3 * std::fs::metadata(&sparse).unwrap().len() < std::fs::metadata(&dense).unwrap().len());
        }
    }
}
