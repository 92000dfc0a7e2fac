//! Pictures from the command line.
use crate::common;

use common::{CLOSED_OBJ, Folder, PATCH, run};
use std::fs;

/// Columns and rows, from the header of a PNG.
fn size(png: &[u8]) -> [u32; 2] {
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    [16, 20].map(|at| u32::from_be_bytes(png[at..at + 4].try_into().unwrap()))
}

#[test]
fn draws_any_shape_in_any_way() {
    let folder = Folder::new("draws");
    let [patch, solid] = [folder.file("a.bpt", PATCH), folder.file("a.obj", CLOSED_OBJ)];
    let mut pictures = Vec::new();
    // All edges of the solid are sharp, so that it looks the same shaded and flat.
    let shows: [(&str, &[&str]); 2] =
        [(&patch, &["shaded", "flat", "wire", "normals"]), (&solid, &["shaded", "wire", "normals"])];
    for (input, shows) in shows {
        for show in shows {
            let output = folder.text("a.png");
            run(&["render", input, "-o", &output, "--show", show, "--size", "60x40", "--force", "-q"])
                .succeeds();
            let png = fs::read(&output).unwrap();
            assert_eq!(size(&png), [60, 40]);
            assert!(!pictures.contains(&png), "{input} {show} looks like another picture");
            pictures.push(png);
        }
    }
}

#[test]
fn the_camera_is_as_told_and_the_picture_the_same_on_any_number_of_threads() {
    let folder = Folder::new("camera");
    let input = folder.file("a.bpt", PATCH);
    let view = "50x30 fov=40 eye=6,-8,7 target=1.5,1.5,0";
    let pictures = ["1", "2"].map(|threads| {
        let output = folder.text(&format!("{threads}.png"));
        let args = ["render", &input, "-o", &output, "--view", view, "--threads", threads, "--json"];
        let made = run(&args);
        made.succeeds();
        let certificate = made.report()["certificate"].clone();
        assert_eq!(certificate["budget"]["pixels"], 0.5);
        assert!(certificate["bound"]["pixels"].as_f64().unwrap() <= 0.5, "{certificate}");
        (fs::read(&output).unwrap(), certificate)
    });
    assert_eq!(size(&pictures[0].0), [50, 30]);
    assert!(pictures[0] == pictures[1]);
}

#[test]
fn smooth_shapes_are_as_fine_as_told() {
    let folder = Folder::new("fine");
    let input = folder.file("a.bpt", PATCH);
    let triangles = |budget: &[&str]| {
        let output = folder.text("a.png");
        let args =
            [&["render", &input, "-o", &output, "--size", "40x30", "--force", "--json"], budget].concat();
        let made = run(&args);
        made.succeeds();
        made.report()["certificate"]["output"]["triangles"].as_u64().unwrap()
    };
    let usual = triangles(&[]);
    assert_eq!(triangles(&["--px", "0.5"]), usual);
    assert!(triangles(&["--px", "0.1"]) > usual);
    assert!(triangles(&["--tol", "1"]) < triangles(&["--tol", "0.001"]));
}

#[test]
fn an_eye_inside_the_shape_still_gets_a_picture() {
    let folder = Folder::new("inside");
    let input = folder.file("a.bpt", PATCH);
    let view = "40x30 fov=60 eye=1.5,1.5,0.9 target=0,0,0";
    let made = run(&["render", &input, "-o", &folder.text("a.png"), "--view", view, "--json"]);
    made.succeeds();
    let certificate = &made.report()["certificate"];
    assert!(certificate["notes"].to_string().contains("too close"), "{certificate}");
}

#[test]
fn pictures_that_make_no_sense_are_usage() {
    let folder = Folder::new("no-sense");
    let (input, output) = (folder.file("a.obj", CLOSED_OBJ), folder.text("a.png"));
    for size in ["0x10", "10", "axb", "-1x5"] {
        run(&["render", &input, "-o", &output, "--size", size]).fails_with(2, &["--size"]);
    }
    run(&["render", &input, "-o", &output, "--view", "10x10 fov=45 dist=4"])
        .fails_with(2, &["eye=", "target="]);
    run(&["render", &input, "-o", &output, "--show", "smell"]).fails_with(2, &["smell"]);
    run(&["render", &input, "-o", &output, "--size", "4000000000x4000000000"])
        .fails_with(5, &["a.obj: ", "bytes", "the limit is"]);
    assert_eq!(folder.names(), ["a.obj"]);
}

#[test]
fn backs_and_fronts_can_be_left_out() {
    let folder = Folder::new("culls");
    // Seen from the front (against y), the first triangle shows its face and the second its back.
    let obj = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 2 0 0\nv 3 0 0\nv 2 0 1\nf 1 2 3\nf 4 6 5\n";
    let input = folder.file("two.obj", obj);
    let output = folder.text("a.png");
    let pictures = ["none", "back", "front"].map(|cull| {
        run(&["render", &input, "-o", &output, "--cull", cull, "--size", "80x60", "--force", "-q"])
            .succeeds();
        fs::read(&output).unwrap()
    });
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2] && pictures[0] != pictures[2]);
    run(&["render", &input, "-o", &output, "--cull", "sides"]).fails_with(2, &["sides"]);
}

#[test]
fn overshade_counts_lanes_and_shows_them() {
    let folder = Folder::new("overshade");
    let schema = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: serde_json::Value = serde_json::from_str(&fs::read_to_string(schema).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    // The lower left half of a screen of 8 × 8 pixels, as in the library's own example, and its back behind
    // it.
    let front = "v -4 -4 0\nv 4 -4 0\nv -4 4 0\nv -4 -4 -1\nv 4 -4 -1\nv -4 4 -1\nf 1 2 3\nf 4 6 5\n";
    let input = folder.file("half.obj", front);
    let view = "8x8 height=8 eye=0,0,1 target=0,0,0";
    let output = folder.text("a.png");
    let shot = |more: &[&str]| {
        let args = ["render", &input, "-o", &output, "--show", "overshade", "--view", view, "--force"];
        let made = run(&[&args, more].concat());
        made.succeeds();
        made
    };
    let both = shot(&["--json"]).report();
    let wrong: Vec<_> = schema.iter_errors(&both).map(|e| e.to_string()).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    let facts = &both["certificate"]["overshade"];
    assert_eq!((&facts["covered_px"], &facts["in_view"]), (&28.into(), &2.into()), "{facts}");
    assert_eq!((&facts["visible"]["quads"], &facts["every"]["quads"]), (&10.into(), &20.into()), "{facts}");
    assert_eq!((&facts["flicker"], &facts["culled"]), (&0.0.into(), &"none".into()), "{facts}");
    let pictures = [&[][..], &["--cull", "back"]].map(|cull| {
        let made = shot(cull);
        assert!(
            made.stdout.contains("visible     10 quads, 30.0% of their lanes are helpers"),
            "{}",
            made.stdout
        );
        fs::read(&output).unwrap()
    });
    assert!(pictures[0] != pictures[1], "two lanes a pixel and one");
    let one = shot(&["--cull", "back", "--json"]).report();
    assert_eq!(one["certificate"]["overshade"]["every"]["quads"], 10);

    let field = folder.file("ball.star", "sphere(1)\n");
    run(&["render", &field, "-o", &output, "--show", "overshade", "--force"])
        .fails_with(3, &["no triangles to shade", "mesh it first"]);
}
