//! `chordal mesh --union --minus --intersect`: solids combined from files, with what they carry.
use crate::common;

use common::{CLOSED_OBJ, Folder, OPEN_OBJ, TEAPOT, number, run, volume};
use serde_json::Value;

/// A box as an .obj, with a material.
fn cuboid(low: [f64; 3], high: [f64; 3], material: &str) -> String {
    format!("usemtl {material}\n{}", common::cuboid(low, high))
}

#[test]
fn options_apply_from_left_to_right() {
    let folder = Folder::new("boolean-order");
    let a = folder.file("a.obj", cuboid([0.0; 3], [4.0; 3], "red"));
    let b = folder.file("b.obj", cuboid([1.0, 1.0, -1.0], [3.0, 3.0, 5.0], "green"));
    let c = folder.file("c.obj", cuboid([0.0, 0.0, 1.0], [4.0, 4.0, 2.0], "blue"));
    let [first, second] = [folder.text("first.obj"), folder.text("second.obj")];
    let made = run(&["mesh", &a, "--minus", &b, "--union", &c, "-o", &first, "--json"]);
    made.succeeds();
    let report = made.report();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    assert!(schema.is_valid(&report), "{report:#}");
    assert_eq!(report["certificate"]["bound"]["evidence"], "proved-if");
    assert_eq!(report["certificate"]["boolean"]["operands"][1]["op"], "difference");
    assert_eq!(report["certificate"]["valid"]["closed"], true, "{report:#}");
    run(&["mesh", &a, "--union", &c, "--minus", &b, "-o", &second]).succeeds();
    let close = |path: &str, wanted: f64| {
        let found = volume(path);
        assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
    };
    close(&first, 64.0 - 16.0 + 4.0);
    close(&second, 48.0);
    let written = std::fs::read_to_string(&first).unwrap();
    for material in ["usemtl red", "usemtl green", "usemtl blue"] {
        assert!(written.contains(material), "{material}");
    }
    let text = run(&["mesh", &a, "--intersect", &b, "-o", &second, "--force"]);
    text.succeeds();
    assert!(text.stdout.contains("by intersection, in floating-point arithmetic"), "{}", text.stdout);
}

#[test]
fn materials_become_primitives_with_their_looks() {
    let folder = Folder::new("boolean-looks");
    let look = |name: &str, color: &str| format!("newmtl {name}\nKd {color}\n");
    folder.file("a.mtl", look("red", "1 0 0"));
    folder.file("b.mtl", look("green", "0 1 0"));
    let with = |name: &str, solid: String| format!("mtllib {name}.mtl\n{solid}");
    let a = folder.file("a.obj", with("a", cuboid([0.0; 3], [2.0; 3], "red")));
    let b = folder.file("b.obj", with("b", cuboid([1.0; 3], [3.0; 3], "green")));
    let out = folder.text("out.gltf");
    run(&["mesh", &a, "--minus", &b, "-o", &out]).succeeds();
    let gltf: Value = serde_json::from_slice(&std::fs::read(&out).unwrap()).unwrap();
    let primitives = gltf["meshes"][0]["primitives"].as_array().unwrap();
    let mut colors: Vec<String> = primitives
        .iter()
        .map(|primitive| {
            let material = &gltf["materials"][primitive["material"].as_u64().unwrap() as usize];
            material["pbrMetallicRoughness"]["baseColorFactor"].to_string()
        })
        .collect();
    colors.sort();
    assert_eq!(colors, ["[0.0,1.0,0.0,1.0]", "[1.0,0.0,0.0,1.0]"]);
}

#[test]
fn other_shapes_are_meshed_within_the_budget_first() {
    let folder = Folder::new("boolean-field");
    let a = folder.file("a.obj", cuboid([-1.0; 3], [1.0; 3], "red"));
    let ball = folder.file("ball.star", "sphere(1.2)\n");
    let out = folder.text("out.stl");
    run(&["mesh", &a, "--minus", &ball, "-o", &out]).fails_with(5, &["ball.star", "within a length"]);
    let made = run(&["mesh", &a, "--minus", &ball, "--tol", "0.01", "-o", &out, "--json"]);
    made.succeeds();
    let report = made.report();
    assert_eq!(report["certificate"]["bound"]["metric"], "solid");
    let most = number(&report, "/certificate/bound/at_most");
    assert!((1e-4..=0.01).contains(&most), "{most}");
    // Eight corners: the cube less the ball, plus its six caps of height 0.2.
    let cap = std::f64::consts::PI * 0.04 * (3.0 * 1.2 - 0.2) / 3.0;
    let wanted = 8.0 - (4.0 / 3.0 * std::f64::consts::PI * 1.2_f64.powi(3) - 6.0 * cap);
    let found = volume(&out);
    assert!((found - wanted).abs() < 0.01 * 4.0 * std::f64::consts::PI * 1.44, "{found} {wanted}");
}

#[test]
fn an_open_scan_less_a_field_is_a_solid_that_prints() {
    let folder = Folder::new("boolean-open");
    // A box without its lid, and a ball that takes a bite out of its floor.
    let whole = cuboid([-1.0; 3], [1.0; 3], "red");
    let lidless: Vec<&str> = whole.lines().filter(|line| !["f 5 6 8", "f 5 8 7"].contains(line)).collect();
    let open = folder.file("open.obj", lidless.join("\n"));
    let ball = folder.file("ball.star", "move(sphere(0.5), 0, 0, -1)\n");
    let out = folder.text("out.stl");
    run(&["mesh", &open, "--minus", &ball, "-o", &out]).fails_with(5, &["ball.star", "within a length"]);
    let made = run(&["mesh", &open, "--minus", &ball, "--tol", "0.4", "-o", &out, "--json"]);
    made.succeeds();
    let report = made.report();
    let valid = &report["certificate"]["valid"];
    for what in ["closed", "manifold", "oriented"] {
        assert_eq!(valid[what], true, "{what}: {report:#}");
    }
    assert_eq!(report["certificate"]["bound"]["evidence"], "proved-if");
    assert!(number(&report, "/certificate/bound/at_most") <= 0.4);
    let notes = report["certificate"]["notes"].to_string();
    assert!(notes.contains("winding number is above a half"), "{notes}");
}

#[test]
fn bad_operands_are_sentences() {
    let folder = Folder::new("boolean-bad");
    let whole = folder.file("whole.obj", CLOSED_OBJ);
    let open = folder.file("open.obj", OPEN_OBJ);
    let drawing =
        folder.file("line.svg", "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0L1 1'/></svg>");
    let out = folder.text("out.stl");
    run(&["mesh", &whole, "--minus", &whole, "-o", &out]).fails_with(3, &["nothing would be left"]);
    run(&["mesh", &whole, "--minus", &drawing, "-o", &out]).fails_with(2, &["line.svg", "bound no solid"]);
    run(&["mesh", &whole, "--minus", "missing.stl", "-o", &out]).fails_with(3, &["missing.stl"]);
    run(&["mesh", &whole, "--minus", &open, "-o", &out])
        .fails_with(3, &["open.obj", "3 edges have one", "a length"]);
    run(&["mesh", &whole, "--minus", &open, "-o", &open, "--force"])
        .fails_with(4, &["the output is the input"]);
    let [metres, inches] = [folder.text("metres.glb"), folder.text("inches.3mf")];
    run(&["convert", &whole, &metres]).succeeds();
    run(&["convert", &whole, &inches, "--unit", "in", "-q"]).succeeds();
    for words in [&[&*metres][..], &[&*whole, "--unit", "mm"]] {
        let found = run(&[&["mesh"], words, &["--union", &inches, "-o", &out]].concat());
        found.fails_with(2, &["inches.3mf: a unit is 0.0254 m there", "--unit"]);
    }
    run(&["mesh", TEAPOT, "--minus", &whole, "-o", &out]).fails_with(5, &["within a length"]);
    let triangles = run(&["mesh", &whole, "--minus", &open, "--triangles", "9", "-o", &out]);
    assert_eq!(triangles.code, 2, "{triangles:?}");
}
