//! `chordal mesh --offset` and `--hollow`: another surface of a closed mesh, its report, and how it is proved again.
use crate::common;

use common::{Folder, number, run, volume};
use serde_json::Value;

/// A box of triangles with the low corner at 0.
fn cuboid(high: [f64; 3]) -> String {
    common::cuboid([0.0; 3], high)
}

/// Runs `mesh`, checks the report's form, and returns it.
fn meshed(args: &[&str]) -> Value {
    let made = run(&[&["mesh"][..], args, &["--json"]].concat());
    made.succeeds();
    let report = made.report();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    assert!(schema.is_valid(&report), "{report:#}");
    assert_eq!(report["certificate"]["valid"]["closed"], true, "{report:#}");
    report
}

#[test]
fn a_hollow_box_has_a_wall_of_that_thickness_and_is_proved_again() {
    let folder = Folder::new("offset-hollow");
    let solid = folder.file("box.obj", cuboid([30.0, 20.0, 10.0]));
    let out = folder.text("hollow.ply");
    let report = meshed(&[&solid, "--hollow", "2", "-o", &out]);
    assert_eq!(report["certificate"]["bound"]["evidence"], "proved");
    assert!(number(&report, "/certificate/bound/at_most") <= 0.1, "a twentieth of the wall");
    assert_eq!(report["certificate"]["offset"]["kind"], "hollow");
    // Inward the box stays a box: its mitres are sharp.
    let wall = 30.0 * 20.0 * 10.0 - 26.0 * 16.0 * 6.0;
    assert!((volume(&out) - wall).abs() < 1e-3 * wall, "{}", volume(&out));
    run(&["verify", &out, "--against", &solid]).succeeds();
    // A shape with a thinner wall is another one.
    let other = folder.file("other.obj", cuboid([30.0, 20.0, 10.5]));
    run(&["verify", &out, "--against", &other]).fails_with(1, &[]);
}

#[test]
fn an_offset_is_proved_again_and_a_false_one_is_not() {
    let folder = Folder::new("offset-verify");
    let solid = folder.file("box.obj", cuboid([3.0, 2.0, 1.0]));
    let out = folder.text("out.ply");
    let report = meshed(&[&solid, "--offset", "0.25", "--tol", "0.01", "-o", &out]);
    assert_eq!(report["certificate"]["bound"]["reference"], "field");
    run(&["verify", &out, "--against", &solid]).succeeds();
    // Steps after it go on from the offset surface.
    let smaller = folder.text("smaller.ply");
    meshed(&[&out, "--tol", "0.05", "-o", &smaller]);
    run(&["verify", &smaller, "--against", &out, "--against", &solid]).succeeds();
    let inward = folder.text("inward.stl");
    meshed(&[&solid, "--offset=-0.25", "-o", &inward]);
    assert!((volume(&inward) - 2.5 * 1.5 * 0.5).abs() < 1e-4, "{}", volume(&inward));
}

#[test]
fn millimetres_of_an_stl_are_assumed_and_said() {
    let folder = Folder::new("offset-stl");
    let [stl, out] = [folder.text("box.stl"), folder.text("print.3mf")];
    let solid = folder.file("box.obj", cuboid([30.0, 20.0, 10.0]));
    run(&["convert", &solid, &stl]).succeeds();
    let report = meshed(&[&stl, "--hollow", "2mm", "-o", &out]);
    let notes = report["certificate"]["notes"].to_string();
    assert!(notes.contains("millimetres"), "{notes}");
    run(&["mesh", &solid, "--hollow", "2mm", "-o", &out, "--force"]).fails_with(2, &["unit"]);
}

#[test]
fn pixels_and_lattices_are_those_of_the_larger_result() {
    let folder = Folder::new("offset-pixels");
    let solid = folder.file("box.obj", cuboid([1.0; 3]));
    let out = folder.text("out.glb");
    // From the camera's place the result fills twice the angle of the solid.
    let view = "1920x1080 fov=45 eye=9,0.5,0.5 target=0.5,0.5,0.5";
    let report = meshed(&[&solid, "--offset", "4", "--px", "1", "--view", view, "--quantize", "-o", &out]);
    assert!(number(&report, "/certificate/bound/pixels") <= 1.0, "{report:#}");
    // The nearest point is 4 away, where a pixel is that long.
    let pixel = 4.0 * 2.0 * (22.5_f64).to_radians().tan() / 1080.0;
    assert!(number(&report, "/certificate/bound/at_most") <= 1.01 * pixel, "{report:#}");
    run(&["verify", &out, "--against", &solid]).succeeds();
}

#[test]
fn what_has_no_offset_is_said_in_a_sentence() {
    let folder = Folder::new("offset-refused");
    let solid = folder.file("box.obj", cuboid([3.0, 2.0, 1.0]));
    let whole = cuboid([3.0, 2.0, 1.0]);
    let open = folder.file("open.obj", whole.rsplit_once("f ").expect("it has faces").0);
    let script = folder.file("ball.star", "sphere(1)\n");
    let out = folder.text("out.ply");
    for (args, part) in [
        (&[&solid, "--hollow", "1"][..], "leaves no cavity"),
        (&[&solid, "--offset=-0.6"], "nothing is left"),
        (&[&open, "--offset", "0.1"], "not closed"),
        (&[&script, "--offset", "0.1"], "offset(shape, distance)"),
        (&[&solid, "--offset", "0"], "greater than 0"),
        (&[&solid, "--hollow=-1"], "greater than 0"),
        (&[&solid, "--hollow", "nan"], "a length is a number"),
        // Nothing that was asked for is left out without a word.
        (&[&solid, "--offset", "0.1", "--union", &solid], "of one solid"),
        (&[&solid, "--offset", "0.1", "--tol", "0.01", "--angle", "5deg"], "takes a length or pixels"),
    ] {
        let made = run(&[&["mesh"][..], args, &["-o", &out]].concat());
        assert!(made.code != 0 && made.stderr.contains(part), "{args:?}: {}", made.stderr);
        assert!(!std::path::Path::new(&out).exists());
    }
}
