//! Shape scripts and op lists on the command line.
use crate::common;

use chordal_testkit::is_long;
use common::{Folder, chordal, run};
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

#[test]
fn a_line_on_stdin_is_a_shape() {
    let mut child = chordal(&["inspect", "-", "--from", "star", "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("it starts");
    child.stdin.take().expect("a pipe").write_all(b"box(2,2,1) - cylinder(0.4,2)\n").expect("it reads");
    let run = common::Run::of(child.wait_with_output().expect("it ends"));
    run.succeeds();
    let report = run.report();
    assert_eq!(report["certificate"]["input"]["kind"], "field");
    let field = &report["inspection"]["field"];
    assert_eq!((&field["outside"], &field["inside"]), (&"lower bound".into(), &"exact distance".into()));
    assert_eq!(field["dimensions"], 3);
    assert_eq!(report["inspection"]["box"], serde_json::json!([[-1.0, -1.0, -0.5], [1.0, 1.0, 0.5]]));
}

#[test]
fn parameters_are_set_from_outside() {
    let folder = Folder::new("script-set");
    let file = folder.file("block.star", "r = param('r', 0.4)\nbox(2, 2, 1) - cylinder(r, 2)\n");
    let plain = run(&["inspect", &file]);
    plain.succeeds();
    assert!(plain.stdout.contains("r = 0.4\n"), "{}", plain.stdout);
    let set = run(&["inspect", &file, "--set", "r=0.5"]);
    set.succeeds();
    assert!(set.stdout.contains("r = 0.5 (default 0.4)"), "{}", set.stdout);
    run(&["inspect", &file, "--set", "q=1"]).fails_with(3, &["no parameter 'q'", "it has r"]);
    run(&["inspect", &file, "--set", "r"]).fails_with(2, &["r=0.5"]);
    let obj = folder.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    run(&["inspect", &obj, "--set", "r=1"]).fails_with(3, &["only scripts have parameters"]);
}

#[test]
fn what_is_wrong_with_a_script_is_shown() {
    let folder = Folder::new("script-wrong");
    let file = folder.file("wrong.star", "a = 1\nbox(1, a)\n");
    let wrong = run(&["inspect", &file]);
    // The sentence, the line, and a mark below its place.
    let shown = "wrong.star: line 2, column 1: box() needs 'z': call it as box(x, y, z)\nbox(1, a)\n^\n";
    assert!(wrong.code == 3 && wrong.stderr.ends_with(shown), "{wrong:?}");
    assert_eq!(wrong.stderr.lines().count(), 3, "{wrong:?}");
    let endless = folder.file("endless.star", "def f(n):\n    return f(n)\nf(1)\n");
    let endless = run(&["inspect", &endless]);
    assert!(
        endless.code == 3 && endless.stderr.contains("the call stack is deeper than 64 functions"),
        "{endless:?}"
    );
}

#[test]
fn a_union_of_which_the_last_shape_alone_is_cut_is_warned_about() {
    let folder = Folder::new("script-cut");
    let text = "plate = box(4, 4, 1)\nrib = box(1, 4, 2)\nhole = cylinder(0.2, 9)\n";
    let cut = folder.file("cut.star", format!("{text}plate | rib - hole\n"));
    let said = run(&["inspect", &cut, "--json"]);
    assert!(said.code == 0 && said.stderr.contains("last shape of the union"), "{said:?}");
    let warnings = &said.report()["certificate"]["input"]["warnings"];
    assert_eq!(warnings.as_array().unwrap().len(), 1, "{warnings}");
    let warning = &warnings[0];
    assert_eq!((&warning["code"], &warning["count"]), (&"last-operand-cut".into(), &1.into()));
    assert_eq!(warning["place"], "line 4, column 9");
    assert!(warning["message"].as_str().unwrap().contains("(a | b) - c"), "{warning}");
    let ply = folder.text("out.ply");
    let made = run(&["mesh", &cut, "--tol", "0.1", "-o", &ply]);
    assert_eq!(made.code, 0, "{made:?}");
    assert!(made.stderr.contains("cut.star: warning: '-' binds tighter than '|'"), "{made:?}");
    assert!(made.stderr.contains("line 4, column 9"), "{made:?}");
    for meant in ["plate | (rib - hole)", "(plate | rib) - hole"] {
        let file = folder.file("meant.star", format!("{text}{meant}\n"));
        let quiet = run(&["inspect", &file]);
        // Nothing is on stderr.
        quiet.succeeds();
    }
}

#[test]
fn op_lists_are_looked_at_in_their_box() {
    let folder = Folder::new("script-vm");
    let file = folder
        .file("disc.vm", "x var-x\ny var-y\nxx square x\nyy square y\nr add xx yy\no const 0.5\nd sub r o\n");
    let report = run(&["inspect", &file, "--json"]).report();
    assert_eq!(report["inspection"]["field"]["dimensions"], 2);
    assert_eq!(
        report["inspection"]["field"]["region"],
        serde_json::json!([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
    );
    assert!(report["certificate"]["notes"][0].as_str().is_some_and(|note| note.contains("--region")));
    let report = run(&["inspect", &file, "--region", "0,0,0 1,1,1", "--json"]).report();
    assert_eq!(
        report["inspection"]["field"]["region"],
        serde_json::json!([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    );
}

#[test]
fn the_examples_are_shapes() {
    let scripts = common::names(Path::new(EXAMPLES)).into_iter().filter_map(|name| {
        let stem = name.strip_suffix(".star")?;
        run(&["inspect", &example(stem)]).succeeds();
        Some(stem.to_owned())
    });
    let slow = SLOW.into_iter().map(|(name, _)| name);
    let mut meshed: Vec<_> = PLATES.into_iter().chain(HOUSINGS).chain(slow).collect();
    meshed.sort_unstable();
    assert_eq!(scripts.collect::<Vec<_>>(), meshed, "each is in one of the lists of what is meshed");
    assert_eq!(meshed.len(), 13);
}

const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
/// Examples that are meshed in seconds, in two lists as two tests share them.
const PLATES: [&str; 4] = ["angle_bracket", "badge", "block", "bracket"];
const HOUSINGS: [&str; 2] = ["enclosure", "gear"];
/// Those that take up to a minute, and their lengths. A thousandth of the walls of the gyroid, which are
/// many, is not reached in seconds.
const SLOW: [(&str, &str); 7] = [
    ("blobs", "0.1%"),
    ("creature", "0.1%"),
    ("gyroid", "0.05"),
    ("gyroid_cube", "0.1%"),
    ("sponge", "0.1%"),
    ("twisted_bolt", "0.1%"),
    ("vase", "0.1%"),
];

fn example(name: &str) -> String {
    format!("{EXAMPLES}/{name}.star")
}

/// Meshes an example, which has to be proved, and looks at the file that was written.
fn meshes_proved(folder: &Folder, name: &str, length: &str) {
    let output = folder.text("a.ply");
    let made = run(&["mesh", &example(name), "-o", &output, "--force", "--tol", length, "--json"]);
    assert_eq!(made.code, 0, "{name}: {made:?}");
    let report = made.report();
    let (bound, budget) = (&report["certificate"]["bound"], &report["certificate"]["budget"]);
    assert!(bound["evidence"].as_str().is_some_and(|word| word.starts_with("proved")), "{name}: {bound:#}");
    let (at_most, wanted) = (bound["at_most"].as_f64(), budget["length"].as_f64());
    assert!(at_most.expect("an upper end") <= wanted.expect("a length"), "{name}: {bound:#}");
    let inspected = run(&["inspect", &output, "--json"]);
    assert_eq!(inspected.code, 0, "{name}: {inspected:?}");
    let report = inspected.report();
    let valid = &report["certificate"]["valid"];
    assert!(valid["closed"] == true && valid["manifold"] == true, "{name}: {valid:#}");
}

#[test]
fn plates_with_holes_are_meshed_within_a_thousandth() {
    let folder = Folder::new("script-plates");
    for name in PLATES {
        meshes_proved(&folder, name, "0.1%");
    }
}

#[test]
fn housings_and_gears_are_meshed_within_a_thousandth() {
    let folder = Folder::new("script-housings");
    for name in HOUSINGS {
        meshes_proved(&folder, name, if is_long() { "0.1%" } else { "0.3%" });
    }
}

#[test]
fn all_other_examples_are_meshed_in_the_long_sweep() {
    let folder = Folder::new("script-slow");
    for (name, length) in SLOW.into_iter().filter(|_| is_long()) {
        meshes_proved(&folder, name, length);
    }
}

#[test]
fn a_drawing_becomes_closed_lines() {
    let folder = Folder::new("script-lines");
    let ring = folder.file(
        "ring.vm",
        "a var-x\nb var-y\nc square a\nd square b\ne add c d\nf sqrt e\ng const 0.5\nh sub f g\n",
    );
    let (json, svg) = (folder.text("ring.json"), folder.text("ring.svg"));
    for file in [&json, &svg] {
        let made =
            run(&["mesh", &ring, "--region", "-1,-1,-1 1,1,1", "--tol", "0.001", "-o", file, "--json"]);
        made.succeeds();
        let report = made.report();
        let bound = &report["certificate"]["bound"];
        assert_eq!(bound["evidence"], "proved");
        assert!(bound["at_most"].as_f64().is_some_and(|most| most <= 0.001));
    }
    assert!(std::fs::read_to_string(&svg).unwrap().contains("<path"));
    let inspected = run(&["inspect", &json, "--json"]);
    inspected.succeeds();
    // What depends on z is no drawing.
    let ball = folder.file("ball.star", "sphere(0.5)\n");
    run(&["mesh", &ball, "--tol", "0.01", "-o", &folder.text("ball.svg")])
        .fails_with(2, &["depend on z", "obj"]);
}

#[test]
fn each_shape_of_a_dictionary_becomes_a_part_with_its_bound() {
    let folder = Folder::new("script-bodies");
    let text = "print('two', 2)\n{'case': box(4, 3, 2) - box(3, 2, 9), 'lid': move(sphere(1), 6, 0)}\n";
    let file = folder.file("two.star", text);
    let glb = folder.text("two.glb");
    let made = run(&["mesh", &file, "--tol", "0.05", "-o", &glb, "--json"]);
    made.succeeds_saying("two.star: two 2\n");
    let report = made.report();
    assert_eq!(report["certificate"]["bound"]["evidence"], "proved", "{report}");
    let notes = report["certificate"]["notes"].to_string();
    assert!(notes.contains("'case': ") && notes.contains("'lid': ") && notes.contains("(proved)"), "{notes}");
    let said = &report["certificate"]["input"]["warnings"][0];
    assert_eq!((&said["code"], &said["message"]), (&"script-said".into(), &"two 2".into()));
    let parts = run(&["inspect", &glb, "--json"]);
    parts.succeeds();
    let written = std::fs::read(&glb).expect("it is there");
    for name in ["case", "lid"] {
        let quoted = format!("\"name\":\"{name}\"");
        assert!(written.windows(quoted.len()).any(|part| part == quoted.as_bytes()), "{name}");
    }
}

#[test]
fn files_beside_a_script_are_read_and_none_elsewhere() {
    let outside = Folder::new("script-outside");
    let secret = outside.file("secret.star", "r = 1\n");
    let folder = Folder::new("script-beside");
    folder.file("lib.star", "def post(h):\n    return cylinder(1, h)\n");
    let svg = "<svg xmlns='http://www.w3.org/2000/svg'><circle cx='0' cy='0' r='5'/></svg>";
    folder.file("disc.svg", svg);
    let text = "load('lib.star', 'post')\nextrude(svg('disc.svg', 0.01), 2) | post(8)\n";
    let file = folder.file("both.star", text);
    let made = run(&["inspect", &file, "--json"]);
    made.succeeds_saying("polygons within");
    let input = &made.report()["certificate"]["input"];
    assert!(input["warnings"].to_string().contains("polygons within"), "{input}");
    assert!(input.to_string().contains("disc.svg") && input.to_string().contains("lib.star"), "{input}");
    #[cfg(unix)]
    std::os::unix::fs::symlink(&secret, folder.path("link.star")).expect("a link");
    for (text, said) in [
        ("load('../secret.star', 'r')\nsphere(r)\n", "without '..'"),
        ("load('/etc/passwd', 'r')\nsphere(r)\n", "a path must be relative to the script's folder"),
        ("load('none.star', 'r')\nsphere(r)\n", "cannot be loaded: no such file"),
        ("load('link.star', 'r')\nsphere(r)\n", "link"),
        ("extrude(svg('lib.star', 1), 1)\n", "svg(): 'lib.star' cannot be used"),
    ] {
        let file = folder.file("wrong.star", text);
        let wrong = run(&["inspect", &file]);
        assert!(wrong.code == 3 && wrong.stderr.contains(said), "{text}: {wrong:?}");
    }
    assert!(!secret.is_empty());
}

/// The points of an OBJ, and the corners of its triangles.
fn triangles_of_obj(path: &str) -> Vec<[[f64; 3]; 3]> {
    let text = std::fs::read_to_string(path).unwrap();
    let rows = |word: &str| -> Vec<Vec<f64>> {
        let rows = text.lines().filter_map(|line| line.strip_prefix(word));
        rows.map(|row| row.split(' ').map(|x| x.split('/').next().unwrap().parse().unwrap()).collect())
            .collect()
    };
    let points = rows("v ");
    let corner = |row: f64| <[f64; 3]>::try_from(&points[row as usize - 1][..3]).unwrap();
    rows("f ").iter().map(|face| [0, 1, 2].map(|k| corner(face[k]))).collect()
}

#[test]
fn the_bound_of_a_mesh_counts_that_lines_stand_for_curves() {
    let folder = Folder::new("script-slack");
    let svg = "<svg xmlns='http://www.w3.org/2000/svg'><circle cx='0' cy='0' r='5'/></svg>";
    folder.file("disc.svg", svg);
    let out = folder.text("out.obj");
    let meshed = |text: &str, length: &str| {
        let file = folder.file("disc.star", text);
        let made = run(&["mesh", &file, "--tol", length, "-o", &out, "--force", "--json"]);
        assert!(made.code == 0 && made.stderr.contains("polygons within"), "{made:?}");
        let report = made.report();
        let most = report["certificate"]["bound"]["at_most"].as_f64().unwrap();
        (most, report["certificate"]["notes"].to_string())
    };
    for (scale, length) in [(1.0, "0.1"), (3.0, "0.2")] {
        let text = format!("move(scale(extrude(svg('disc.svg', 0.02), 3), {scale}), 1, 2)\n");
        let (most, notes) = meshed(&text, length);
        assert!(notes.contains("the bound includes the distance of straight lines"), "{notes}");
        // How far the middles of edges along the wall are from the circle, which nothing of the program says.
        let from_axis = |p: [f64; 3]| (p[0] - 1.0).hypot(p[1] - 2.0);
        let mut off: f64 = 0.0;
        for corners in
            triangles_of_obj(&out).into_iter().filter(|c| c.iter().any(|p| (p[2] - c[0][2]).abs() > 1.0))
        {
            for (a, b) in [0, 1, 2].map(|k| (corners[k], corners[(k + 1) % 3])) {
                if (a[2] - b[2]).abs() < 1e-9 {
                    let middle = from_axis([0, 1, 2].map(|k| (a[k] + b[k]) / 2.0));
                    off = off.max((5.0 * scale - middle).abs());
                }
            }
        }
        assert!(off > 0.001 && most >= off, "{most} {off}");
        assert!(most <= length.parse().unwrap(), "{most}");
    }
    // Where nothing counts it, it is said on the terminal.
    for (text, length, why) in [
        ("extrude(svg('disc.svg', 0.02), 3)\n", "0.03", "a shorter tolerance of theirs"),
        ("twist(extrude(svg('disc.svg', 0.02), 3), 3)\n", "0.2", "as by a blend or a twist"),
    ] {
        let (_, notes) = meshed(text, length);
        let file = folder.file("disc.star", text);
        let told = run(&["mesh", &file, "--tol", length, "-o", &out, "--force"]);
        for said in [notes, told.stdout] {
            assert!(said.contains("the bound does not include the distance of straight lines"), "{said}");
            assert!(said.contains(why), "{said}");
        }
    }
}

/// The JSON of a GLB.
fn json_of_glb(path: &str) -> serde_json::Value {
    let bytes = std::fs::read(path).expect("it is there");
    let n = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&bytes[20..20 + n]).expect("JSON")
}

const PAINTED: &str =
    "color(sphere(10), '#ff0000') | material(move(sphere(8), 9, 0), 'sea', [0, 0.5, 1], 0.25, 0.75)\n";

#[test]
fn materials_of_a_script_are_in_its_files() {
    let folder = Folder::new("script-materials");
    let file = folder.file("two.star", PAINTED);
    let glb = folder.text("two.glb");
    run(&["mesh", &file, "--tol", "0.1", "-o", &glb]).succeeds();
    let json = json_of_glb(&glb);
    let looks = json["materials"].as_array().expect("materials");
    let names: Vec<&str> = looks.iter().filter_map(|look| look["name"].as_str()).collect();
    assert_eq!(names, ["color-ff0000", "sea"]);
    let base = |k: usize| &looks[k]["pbrMetallicRoughness"];
    assert_eq!(base(0)["baseColorFactor"], serde_json::json!([1.0, 0.0, 0.0, 1.0]));
    assert_eq!((&base(1)["metallicFactor"], &base(1)["roughnessFactor"]), (&0.25.into(), &0.75.into()));
    // Half of what a screen shows is 0.214 of the light.
    let green = base(1)["baseColorFactor"][1].as_f64().expect("a number");
    assert!((green - 0.214_041).abs() < 1e-6, "{green}");
    let primitives = json["meshes"][0]["primitives"].as_array().expect("primitives");
    let used: Vec<_> = primitives.iter().filter_map(|one| one["material"].as_u64()).collect();
    assert_eq!(used, [0, 1]);
    // The balls meet in the plane x = 6.5, so caps of heights 16.5 and 10.5 are left: 2πrh.
    let parts = [(0_usize, 16.5), (1, 10.5)];
    let obj = folder.text("two.obj");
    run(&["mesh", &file, "--tol", "0.02", "-o", &obj]).succeeds();
    let areas = obj_areas(&std::fs::read_to_string(&obj).expect("it is there"));
    for (k, height) in parts {
        let radius = [10.0, 8.0][k];
        let expected = 2.0 * std::f64::consts::PI * radius * height;
        let found = areas[names[k]];
        assert!((found / expected - 1.0).abs() < 0.01, "{}: {found}, not {expected}", names[k]);
    }
    let library = std::fs::read_to_string(folder.text("two.mtl")).expect("it is there");
    assert!(library.contains("newmtl sea") && library.contains("Kd 1 0 0"), "{library}");
    let threemf = folder.text("two.3mf");
    run(&["mesh", &file, "--tol", "0.1", "-o", &threemf]).succeeds();
    let again = folder.text("again.glb");
    run(&["convert", &threemf, "-o", &again]).succeeds();
    let json = json_of_glb(&again);
    let kept: Vec<_> =
        json["materials"].as_array().expect("materials").iter().map(|look| &look["name"]).collect();
    assert_eq!(kept, names);
}

/// A star of twenty sides in the faces of a plate: its sides are all that the borders need.
#[test]
fn straight_borders_of_colours_take_few_triangles() {
    let folder = Folder::new("script-borders");
    let star = "pts = []\nfor k in range(20):\n    a = 2 * pi * k / 20 + 0.1\n    r = 10 if k % 2 == 0 else 5\n    \
        pts.append([r * cos(a), r * sin(a)])\ncolor(extrude(polygon(pts), 2), 'red') | color(box(30, 30, 2), 'white')\n";
    let file = folder.file("star.star", star);
    let obj = folder.text("star.obj");
    let report = run(&["mesh", &file, "--tol", "0.1", "-o", &obj, "--json"]).report();
    assert_eq!(report["certificate"]["bound"]["evidence"], "proved", "{report}");
    let text = std::fs::read_to_string(&obj).expect("it is there");
    // Each face has 20 corners of the star and 4 of the plate, which is 24 triangles outside and 18 inside; the sides 8.
    let n_faces = text.lines().filter(|line| line.starts_with("f ")).count();
    assert!(n_faces <= 92 + 32, "{n_faces}");
    let areas = obj_areas(&text);
    let red = 2.0 * 500.0 * (std::f64::consts::PI / 10.0).sin();
    for (name, expected) in [("color-ff0000", red), ("color-ffffff", 2.0 * 900.0 - red + 240.0)] {
        let found = areas[name];
        assert!((found / expected - 1.0).abs() < 0.005, "{name}: {found}, not {expected}: {areas:?}");
    }
}

/// The area of each material of an OBJ.
fn obj_areas(text: &str) -> std::collections::BTreeMap<String, f64> {
    let (mut points, mut areas, mut name) = (Vec::new(), std::collections::BTreeMap::new(), String::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.first() {
            Some(&"v") => points.push([1, 2, 3].map(|k: usize| words[k].parse::<f64>().expect("a number"))),
            Some(&"usemtl") => name = words[1].to_owned(),
            Some(&"f") => {
                let corner = |k: usize| words[k].split('/').next().and_then(|n| n.parse::<usize>().ok());
                let [a, b, c] = [1, 2, 3].map(|k| points[corner(k).expect("an index") - 1]);
                let [u, v] = [b, c].map(|p: [f64; 3]| [0, 1, 2].map(|k| p[k] - a[k]));
                let cross: [f64; 3] = std::array::from_fn(|k| {
                    u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]
                });
                let area = 0.5 * cross.iter().map(|x| x * x).sum::<f64>().sqrt();
                *areas.entry(name.clone()).or_insert(0.0) += area;
            }
            _ => {}
        }
    }
    areas
}

#[test]
fn what_is_no_colour_is_said_in_a_sentence_with_its_place() {
    let folder = Folder::new("script-colours");
    for (text, place, said) in [
        ("color(sphere(1), '#xyz')\n", "line 1, column 1", "not \"#xyz\""),
        ("color(sphere(1), '#12345')\n", "line 1, column 1", "not \"#12345\""),
        ("a = 1\ncolor(sphere(1), [1, 2, 3])\n", "line 2, column 1", "not numbers from 0 to 1"),
        ("color(sphere(1), [1, 0])\n", "line 1, column 1", "not a list of 2"),
        ("color(sphere(1), 7)\n", "line 1, column 1", "not a number"),
        ("material(sphere(1), '', 'red')\n", "line 1, column 1", "a name of 1 to 100 characters"),
        (
            "material(sphere(1), 'x', 'red', metallic=2)\n",
            "line 1, column 1",
            "a number from 0 to 1 for 'metallic', not 2",
        ),
        ("material(sphere(1), 'x', 'reddish')\n", "line 1, column 1", "not \"reddish\""),
    ] {
        let file = folder.file("wrong.star", text);
        let wrong = run(&["inspect", &file]);
        assert!(
            wrong.code == 3 && wrong.stderr.contains(place) && wrong.stderr.contains(said),
            "{text}: {wrong:?}"
        );
    }
}

#[test]
fn each_part_has_its_own_materials_and_a_boolean_keeps_them() {
    let folder = Folder::new("script-material-parts");
    let text = "{'a': color(sphere(2), 'red'), 'b': move(box(1, 1, 1), 5, 0), 'c': color(move(sphere(1), 9, 0), 'red')}\n";
    let (file, glb) = (folder.file("three.star", text), folder.text("three.glb"));
    run(&["mesh", &file, "--tol", "0.05", "-o", &glb]).succeeds();
    let json = json_of_glb(&glb);
    let names = |k: usize| {
        let primitive = &json["meshes"][k]["primitives"][0];
        primitive["material"]
            .as_u64()
            .map_or(serde_json::Value::Null, |at| json["materials"][at as usize]["name"].clone())
    };
    assert_eq!(
        [names(0), names(1), names(2)],
        ["color-ff0000".into(), serde_json::Value::Null, "color-ff0000".into()]
    );
    let body = folder.file("body.star", "color(box(10, 10, 4), 'navy')\n");
    let drill = folder.file("drill.star", "color(cylinder(2, 9), 'lime')\n");
    let cut = folder.text("cut.glb");
    run(&["mesh", &body, "--minus", &drill, "--tol", "0.05", "-o", &cut]).succeeds();
    let json = json_of_glb(&cut);
    let names: Vec<_> =
        json["materials"].as_array().expect("materials").iter().map(|look| look["name"].clone()).collect();
    assert_eq!(names, ["color-000080", "color-00ff00"]);
    assert_eq!(json["meshes"][0]["primitives"].as_array().map(Vec::len), Some(2));
    // Levels of detail go without.
    let levels = folder.text("levels.glb");
    run(&["lod", &file, "--tol", "0.05", "-o", &levels]).succeeds();
}
