//! `chordal convert`: the same shape in another format, and what that does not hold.
use crate::common;

use common::{CLOSED_OBJ, Folder, PATCH, run};
use serde_json::Value;
use std::fs;

/// Two squares that share a side.
const QUADS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nf 1 2 3 4\nf 2 5 6 3\n";

fn convert(folder: &Folder, input: &str, output: &str, options: &[&str]) -> Value {
    let (input, output) = (folder.text(input), folder.text(output));
    let made = run(&[&["convert", &input, &output, "--json"], options].concat());
    assert_eq!(made.code, 0, "{made:?}");
    let report = made.report();
    follows_the_schema(&report);
    report["certificate"].clone()
}

fn follows_the_schema(report: &Value) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    let wrong: Vec<_> = schema.iter_errors(report).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(wrong.is_empty(), "{wrong:#?}\n{report:#}");
}

fn notes(certificate: &Value) -> String {
    let notes = certificate["notes"].as_array().unwrap().iter().map(|note| note.as_str().unwrap());
    notes.collect::<Vec<_>>().join("\n")
}

/// The numbers of lines that start with a word.
fn rows(text: &str, word: &str) -> Vec<Vec<f64>> {
    let rows = text.lines().filter_map(|line| line.strip_prefix(word));
    rows.map(|row| row.split_whitespace().map(|x| x.parse().unwrap()).collect()).collect()
}

#[test]
fn triangles_stay_as_they_are_and_the_bound_is_the_rounding() {
    let folder = Folder::new("convert-triangles");
    let thirds = "v 0.1 0.2 0.3\nv 1.1 0 0\nv 0 1.7 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    folder.file("a.obj", thirds);
    // Triangles that a budget of nothing would not make fewer, nor the order another.
    let kept = convert(&folder, "a.obj", "b.obj", &[]);
    assert_eq!(
        (kept["bound"]["at_most"].as_f64(), kept["output"]["triangles"].as_u64()),
        (Some(0.0), Some(4))
    );
    let text = fs::read_to_string(folder.path("b.obj")).unwrap();
    assert_eq!((rows(&text, "v "), rows(&text, "f ")), (rows(thirds, "v "), rows(thirds, "f ")));
    let rounded = convert(&folder, "a.obj", "c.stl", &[]);
    let most = rounded["bound"]["at_most"].as_f64().unwrap();
    let moved = [0.1_f64, 0.2, 0.3, 1.1, 1.7].map(|x| (x - f64::from(x as f32)).abs());
    let longest = moved.iter().fold(0.0, |most: f64, x| most.max(*x));
    assert!(most >= longest && most <= 2.0 * longest, "{longest} {most}");
    assert_eq!(rounded["bound"]["evidence"], "proved");
    // No normals are made, and no names are lost on the way there and back.
    let glb = convert(&folder, "a.obj", "d.glb", &["--unit", "mm", "--up", "z"]);
    assert!(!notes(&glb).contains("normals"), "{}", notes(&glb));
    let back = convert(&folder, "d.glb", "e.obj", &[]);
    assert_eq!(back["output"]["triangles"], 4);
    for part in
        ["the certificate of the input, of a bound of at most", "obj holds no unit", "which axis is up"]
    {
        assert!(notes(&back).contains(part), "no '{part}' in {}", notes(&back));
    }
}

#[test]
fn what_a_format_does_not_hold_is_named_in_the_summary() {
    let folder = Folder::new("convert-losses");
    let input = folder.file("a.obj", format!("o one\n{CLOSED_OBJ}"));
    let told = run(&["convert", &input, &folder.text("a.ply"), "--unit", "mm"]);
    assert_eq!(told.code, 0);
    for part in ["triangles   4", "bound", "note        ply holds no unit: one is 0.001 m"] {
        assert!(told.stdout.contains(part), "no '{part}' in {}", told.stdout);
    }
}

#[test]
fn names_places_and_loose_vertices_are_named_where_they_are_lost() {
    let folder = Folder::new("convert-structure");
    folder.file("a.obj", format!("o one\n{CLOSED_OBJ}v 9 9 9\n"));
    let glb = convert(&folder, "a.obj", "a.glb", &["--up", "z"]);
    assert!(!notes(&glb).contains("nodes"), "{}", notes(&glb));
    // The file has a node that turns it.
    let stl = convert(&folder, "a.glb", "a.stl", &[]);
    assert!(notes(&stl).contains("stl holds no nodes or their names"), "{}", notes(&stl));
    let loose = convert(&folder, "a.obj", "b.stl", &[]);
    assert!(notes(&loose).contains("no vertices beside those of its triangles (1x)"), "{}", notes(&loose));
    assert!(!notes(&convert(&folder, "a.obj", "b.obj", &[])).contains("vertices"));
}

#[test]
fn polygons_stay_polygons_where_nothing_else_is_lost_by_it() {
    let folder = Folder::new("convert-polygons");
    folder.file("a.obj", QUADS);
    for output in ["a.ply", "a.off"] {
        let certificate = convert(&folder, "a.obj", output, &[]);
        assert_eq!(certificate["output"]["faces"], 2, "{output}");
        assert_eq!(notes(&certificate), "", "{output}");
    }
    assert!(
        fs::read_to_string(folder.path("a.off")).unwrap().lines().any(|line| line.starts_with("4 0 1 2 3"))
    );
    // In an obj they would become a cage: whoever wants that says so.
    let triangles = convert(&folder, "a.obj", "b.obj", &[]);
    assert_eq!(triangles["output"]["triangles"], 4);
    assert!(notes(&triangles).contains("--surface catmull-clark keeps the polygons"));
    let cage = convert(&folder, "a.obj", "c.obj", &["--surface", "catmull-clark"]);
    assert_eq!(cage["output"]["faces"], 2);
    assert!(fs::read_to_string(folder.path("c.obj")).unwrap().contains("t interpolateboundary"));
    // Normals are more than polygons keep in a ply.
    folder.file("n.obj", QUADS.replace("f 1 2 3 4", "vn 0 0 1\nf 1//1 2//1 3//1 4//1"));
    let normals = convert(&folder, "n.obj", "n.ply", &[]);
    assert_eq!(normals["output"]["triangles"], 4);
}

#[test]
fn straight_drawings_and_samples_go_to_where_they_are_held() {
    let folder = Folder::new("convert-lines");
    folder.file("a.svg", "<svg xmlns='http://www.w3.org/2000/svg'><path id='p' d='M0 0L1 0.1L1 1Z'/></svg>");
    let json = convert(&folder, "a.svg", "a.json", &[]);
    assert_eq!((&json["bound"]["at_most"], &json["output"]["segments"]), (&0.0.into(), &3.into()));
    for part in ["without names of elements (1x)", "y grows downwards"] {
        assert!(notes(&json).contains(part), "no '{part}' in {}", notes(&json));
    }
    convert(&folder, "a.json", "b.svg", &[]);
    assert!(fs::read_to_string(folder.path("b.svg")).unwrap().contains("d=\"M0 0L1 0.1 1 1Z\""));
    // Samples: to the bit, with their place where the format has one.
    let cube = folder.file("cube.obj", CLOSED_OBJ);
    run(&["bake", &cube, "-o", &folder.text("a.nrrd"), "--cells", "4", "-q"]).succeeds();
    let npy = convert(&folder, "a.nrrd", "a.npy", &[]);
    assert!(notes(&npy).contains("npy holds no origin"), "{}", notes(&npy));
    convert(&folder, "a.nrrd", "b.nrrd", &[]);
    assert_eq!(fs::read(folder.path("a.nrrd")).unwrap(), fs::read(folder.path("b.nrrd")).unwrap());
}

#[test]
fn curves_go_to_svg_as_cubics_and_arcs_become_some_within_a_length() {
    let folder = Folder::new("convert-cubics");
    // A bow of a cubic and a line, open and closed: to the last digit, and back.
    let bow = "<path d='M0 0C0 0.1 1 1 1 0L2 0.3'/><path d='M0 0C0 1 1 1 1 0Z'/>";
    folder.file("a.svg", format!("<svg xmlns='http://www.w3.org/2000/svg'>{bow}</svg>"));
    let same = convert(&folder, "a.svg", "b.svg", &[]);
    assert_eq!((&same["bound"]["at_most"], &same["output"]), (&0.0.into(), &Value::Null));
    assert!(notes(&same).contains("paths: 2, of 2 lines and 2 cubics"), "{}", notes(&same));
    let written = fs::read_to_string(folder.path("b.svg")).unwrap();
    for data in ["d=\"M0 0C0 0.1 1 1 1 0L2 0.3\"", "d=\"M0 0C0 1 1 1 1 0Z\""] {
        assert!(written.contains(data), "{written}");
    }
    convert(&folder, "b.svg", "c.svg", &[]);
    let data = |text: &str| text.lines().filter(|line| line.starts_with("<path")).collect::<String>();
    assert_eq!(data(&written), data(&fs::read_to_string(folder.path("c.svg")).unwrap()));
    // A circle, as an arc and as a rational spline.
    let circle = folder.file("circle.svg", "<svg xmlns='http://www.w3.org/2000/svg'><circle r='1'/></svg>");
    let half = std::f64::consts::FRAC_1_SQRT_2;
    folder.file(
        "rational.json",
        format!(
            "{{\"curves\": [{{\"degree\": 2, \"knots\": [0, 0, 0, 1, 1, 1], \"control\": [[1, 0], [1, 1], [0, 1]], \
             \"weights\": [1, {half}, 1]}}]}}"
        ),
    );
    run(&["convert", &circle, &folder.text("d.svg")])
        .fails_with(2, &["arcs and rational curves become cubics within a length", "--tol"]);
    assert!(!folder.path("d.svg").exists());
    for (name, length) in [("circle.svg", 1e-3), ("circle.svg", 1e-9), ("rational.json", 1e-6)] {
        let made = convert(&folder, name, "d.svg", &["--tol", &length.to_string(), "--force"]);
        let at_most = made["bound"]["at_most"].as_f64().unwrap();
        assert!(at_most > 0.0 && at_most <= length, "{name}: {at_most}");
        assert_eq!(made["bound"]["evidence"], "proved");
        // Points of the written cubics are on the unit circle within the bound.
        let written = fs::read_to_string(folder.path("d.svg")).unwrap();
        let data = written.split("d=\"M").nth(1).unwrap().split('"').next().unwrap().replace('Z', "");
        let mut pieces = data
            .split('C')
            .map(|piece| piece.split_whitespace().map(|x| x.parse::<f64>().unwrap()).collect::<Vec<f64>>());
        let mut from: [f64; 2] = pieces.next().unwrap().try_into().unwrap();
        let mut n_points = 0;
        for piece in pieces {
            let control = [from, [piece[0], piece[1]], [piece[2], piece[3]], [piece[4], piece[5]]];
            for step in 0..=100 {
                let t = f64::from(step) / 100.0;
                let basis =
                    [(1.0 - t).powi(3), 3.0 * t * (1.0 - t).powi(2), 3.0 * t * t * (1.0 - t), t.powi(3)];
                let [x, y] = [0, 1].map(|k| (0..4).map(|i| basis[i] * control[i][k]).sum::<f64>());
                assert!((x.hypot(y) - 1.0).abs() <= at_most, "{name}: {} {at_most}", x.hypot(y) - 1.0);
                n_points += 1;
            }
            from = control[3];
        }
        assert!(n_points > 100, "{written}");
    }
    run(&["convert", &circle, &folder.text("e.ply"), "--tol", "1"]).fails_with(2, &["chordal mesh"]);
    let straight =
        folder.file("line.svg", "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0L1 0'/></svg>");
    run(&["convert", &straight, &folder.text("e.json"), "--tol", "1"])
        .fails_with(2, &["--tol is for drawings written as svg"]);
}

#[test]
fn smooth_shapes_are_refused_with_the_verb_and_the_budget_that_make_triangles() {
    let folder = Folder::new("convert-smooth");
    let patch = folder.file("my a.bpt", PATCH);
    let field = folder.file("a.star", "sphere(1)");
    let curve = folder.file("a.svg", "<svg xmlns='http://www.w3.org/2000/svg'><circle r='1'/></svg>");
    let cage = folder.file("cage.obj", format!("{QUADS}t crease 2/1/0 0 1 2\n"));
    let out = |name: &str| folder.text(name);
    run(&["convert", &patch, &out("a.glb")]).fails_with(2, &["chordal mesh '", "my a.bpt'", "--tol"]);
    run(&["convert", &field, &out("a.ply")]).fails_with(2, &["fields", "chordal mesh", "--tol"]);
    run(&["convert", &curve, &out("a.json")]).fails_with(2, &["chordal mesh", "--tol"]);
    run(&["convert", &cage, &out("a.stl")]).fails_with(2, &["--tol", "--level 0"]);
    run(&["convert", &patch, &out("a.json")]).fails_with(2, &["json does not hold patches"]);
    run(&["convert", &cage, &out("a.nrrd")]).fails_with(2, &["nrrd does not hold polygons"]);
    run(&["convert", &cage, &out("a.nii")]).fails_with(2, &["can only be read"]);
    assert_eq!(folder.names(), ["a.star", "a.svg", "cage.obj", "my a.bpt"]);
}

#[test]
fn the_output_has_two_names_and_one_place() {
    let folder = Folder::new("convert-output");
    let input = folder.file("a.obj", CLOSED_OBJ);
    let output = folder.text("a.ply");
    run(&["convert", &input]).fails_with(2, &["OUT"]);
    run(&["convert", &input, &output, "-o", &output]).fails_with(2, &["-o"]);
    run(&["convert", &input, "-o", &output, "-q"]).succeeds();
    run(&["convert", &input, &output]).fails_with(4, &["--force"]);
    run(&["convert", &input, &output, "--force", "-q"]).succeeds();
    run(&["convert", &input, &input, "--force"]).fails_with(4, &["the output is the input"]);
    let piped = run(&["convert", &input, "-", "--to", "off", "-q"]);
    assert!(piped.stdout.starts_with("OFF"), "{piped:?}");
}

#[test]
fn an_obj_brings_its_materials_in_files_beside_it() {
    let folder = Folder::new("convert-materials");
    let painted = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/web/painted.gltf");
    let output = folder.text("ball.obj");
    let made = run(&["convert", painted, &output, "--json"]);
    assert_eq!(made.code, 0, "{made:?}");
    let text = fs::read_to_string(&output).unwrap();
    assert!(text.contains("\nmtllib ball.mtl\n") && text.contains("\nusemtl "), "{}", &text[..200]);
    let library = fs::read_to_string(folder.path("ball.mtl")).unwrap();
    let picture = library.lines().find_map(|line| line.strip_prefix("map_Kd ")).expect("a picture");
    let found = fs::read(folder.path(picture.split_whitespace().last().unwrap())).expect("the picture");
    assert!(found.starts_with(b"\x89PNG"));
    // The way back: the same two materials, and the same picture.
    let certificate = convert(&folder, "ball.obj", "again.glb", &[]);
    assert!(!notes(&certificate).contains("looks"), "{certificate:#}");
    let again = fs::read(folder.path("again.glb")).unwrap();
    assert!(again.windows(found.len()).any(|bytes| bytes == found), "the picture is in the GLB");
    // Neither a library that stands there is replaced unasked, nor is one lost on stdout without a word.
    assert_eq!(run(&["convert", painted, &output]).code, 4);
    fs::remove_file(&output).unwrap();
    assert_eq!(run(&["convert", painted, &output]).code, 4);
    assert!(!folder.path("ball.obj").exists());
    let piped = run(&["convert", painted, "-", "--to", "obj"]);
    assert!(piped.code == 0 && piped.stderr.contains("they were left out"), "{piped:?}");
}

#[test]
fn points_are_refused_where_only_triangles_are_held() {
    let folder = Folder::new("convert-points");
    let input = folder.file("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    let output = folder.text("a.stl");
    run(&["convert", &input, &output, "-q"])
        .fails_with(3, &["nothing was written", "3 points and no triangle", "stl"]);
    assert!(!fs::exists(&output).unwrap());
    for (name, points) in [("a.obj", "v 1 0 0\n"), ("a.off", "1 0 0\n"), ("a.ply", "element vertex 3\n")] {
        let output = folder.text(name);
        run(&["convert", &input, &output, "-q"]).succeeds();
        let text = String::from_utf8_lossy(&fs::read(&output).unwrap()).into_owned();
        assert!(text.contains(points), "{name}");
    }
    for name in ["a.glb", "a.3mf"] {
        run(&["convert", &input, &folder.text(name), "-q"]).fails_with(4, &["3 points and no triangle"]);
    }
}
