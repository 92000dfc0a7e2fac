//! Polygon cages through the command: what is taken for one, refining, inspecting, and what is refused.
use crate::common;

use common::{CLOSED_OBJ, Folder, PATCH, Run, run};
use serde_json::Value;
use std::fs;

const CUBE: &str = "v -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 -1\nv 1 -1 -1\n\
    g front\nf 1 2 4 3\nf 3 4 6 5\nf 5 6 8 7\nf 7 8 2 1\ng sides\nf 2 8 6 4\nf 7 1 3 5\n";
const CREASES: &str =
    "t crease 2/1/0 0 1 2.5\nt crease 2/1/0 1 3 10\nt corner 1/1/0 7 1.5\nt interpolateboundary 1/0/0 2\n";

#[track_caller]
fn report(run: &Run) -> Value {
    assert_eq!(run.code, 0, "{run:?}");
    let report = run.report();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<String> = schema.iter_errors(&report).map(|error| error.to_string()).collect();
    assert_eq!(errors, [""; 0], "{report:#}");
    report
}

/// Positions, faces and tags of a file, by its lines alone.
fn lines<'a>(text: &'a str, keyword: &str) -> Vec<&'a str> {
    text.lines().filter_map(|line| line.strip_prefix(keyword)).collect()
}

fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

/// Faces as points, from the lowest corner of each, in order; so near to the lattice of 2⁻²⁰ that rounding
/// takes none across.
fn surface(text: &str) -> Vec<Vec<[i64; 3]>> {
    let on_lattice = |x: &f64| (x * f64::from(1 << 20)).round() as i64;
    let points: Vec<[i64; 3]> = lines(text, "v ")
        .iter()
        .map(|line| numbers(line).iter().map(on_lattice).collect::<Vec<_>>().try_into().unwrap())
        .collect();
    let face = |line: &&str| {
        let mut face: Vec<[i64; 3]> = numbers(line).iter().map(|v| points[*v as usize - 1]).collect();
        let lowest = (0..face.len()).min_by_key(|k| face[*k]).unwrap();
        face.rotate_left(lowest);
        face
    };
    let mut faces: Vec<_> = lines(text, "f ").iter().map(face).collect();
    faces.sort();
    faces
}

#[test]
fn a_level_writes_quads_and_what_is_left_of_creases() {
    let folder = Folder::new("cage-level");
    let cage = folder.file("cube.obj", format!("{CUBE}{CREASES}"));
    let out = folder.text("out.obj");
    let made = report(&run(&["mesh", &cage, "--level", "1", "-o", &out, "--json"]));
    let certificate = &made["certificate"];
    assert_eq!(certificate["input"]["kind"], "cage");
    assert_eq!(certificate["output"], serde_json::json!({"faces": 24, "vertices": 26}));
    let refined = serde_json::json!({"levels": 1, "scheme": "catmull-clark", "creases": 4, "corners": 1});
    assert_eq!(certificate["refined"], refined);
    let text = fs::read_to_string(&out).unwrap();
    assert!(lines(&text, "f ").iter().all(|face| face.split_whitespace().count() == 4));
    // Vertices 0, 1 and 3 keep their numbers; the edges 0-1 and 1-3 are the first two that faces come to.
    let tags = [
        "crease 2/1/0 0 8 1.5",
        "crease 2/1/0 1 8 1.5",
        "crease 2/1/0 1 9 10",
        "crease 2/1/0 3 9 10",
        "corner 1/1/0 7 0.5",
    ];
    let written = lines(&text, "t ");
    assert!(tags.iter().all(|tag| written.contains(tag)), "{written:?}");
    assert_eq!(
        written.iter().filter(|tag| tag.starts_with("cr") || tag.starts_with("co")).count(),
        tags.len()
    );
    // Groups go to the parts of each face.
    let front = text.split("g sides\n").next().unwrap();
    assert_eq!((lines(front, "f ").len(), lines(&text, "f ").len()), (16, 24));
    assert!(text.contains("g front\n"));
}

#[test]
fn one_round_and_one_round_are_two_rounds() {
    let folder = Folder::new("cage-rounds");
    let cage = folder.file("cube.obj", format!("{CUBE}{CREASES}"));
    let open = folder.file("open.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 1\nv 2 1 1\nf 1 2 3 4\nf 2 5 6 3\nt interpolateboundary 1/0/0 1\n");
    let loops = folder.file("loop.obj", CLOSED_OBJ);
    for (cage, surface_option) in
        [(&cage, "catmull-clark"), (&cage, "bilinear"), (&open, "catmull-clark"), (&loops, "loop")]
    {
        let [once, again, twice] = ["once.obj", "again.obj", "twice.obj"].map(|name| folder.text(name));
        run(&["mesh", cage, "--surface", surface_option, "--level", "1", "-o", &once, "--force", "-q"])
            .succeeds();
        // The scheme is in the file.
        run(&["mesh", &once, "--level", "1", "-o", &again, "--force", "-q"]).succeeds();
        run(&["mesh", cage, "--surface", surface_option, "--level", "2", "-o", &twice, "--force", "-q"])
            .succeeds();
        let [again, twice] = [again, twice].map(|name| fs::read_to_string(name).unwrap());
        assert_eq!(surface(&again).len(), surface(&twice).len());
        assert!(surface(&again) == surface(&twice), "{cage} {surface_option}");
        let tags = |text: &str| {
            lines(text, "t ")
                .iter()
                .filter(|tag| tag.starts_with("co"))
                .map(|tag| tag.to_string())
                .collect::<Vec<_>>()
        };
        assert_eq!(tags(&again), tags(&twice));
    }
}

#[test]
fn level_0_keeps_polygons_tags_and_texture_coordinates() {
    let folder = Folder::new("cage-keep");
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3 4/3\nt interpolateboundary 1/0/0 1\n\
        t facevaryinginterpolateboundary 1/0/0 3\nt crease 2/1/0 0 1 0.1\n";
    let cage = folder.file("a.obj", text);
    let out = folder.text("b.obj");
    run(&["mesh", &cage, "--level", "0", "-o", &out, "-q"]).succeeds();
    let written = fs::read_to_string(&out).unwrap();
    let (certificate, rest): (Vec<&str>, Vec<&str>) =
        written.split_inclusive('\n').partition(|line| line.starts_with("# chordal: "));
    assert!(certificate[0].starts_with("# chordal: 1/") && certificate.iter().all(|line| line.len() <= 201));
    assert_eq!(rest.concat(), text);
    // The certificate fits what it stands in.
    let found = &report(&run(&["inspect", &out, "--json"]))["inspection"]["found"];
    assert_eq!(found["differs"], serde_json::json!([]));
}

#[test]
fn formats_of_triangles_get_triangles_and_say_so() {
    let folder = Folder::new("cage-triangles");
    let cage = folder.file("cube.obj", CUBE);
    for (name, vertices) in [("a.glb", 26), ("a.stl", 144)] {
        let out = folder.text(name);
        let args = [
            "mesh",
            &cage,
            "--surface",
            "catmull-clark",
            "--level",
            "1",
            "-o",
            &out,
            "--normals",
            "smooth",
            "--json",
        ];
        let certificate = report(&run(&args))["certificate"].clone();
        assert_eq!(certificate["output"]["triangles"], 48, "{name}");
        assert_eq!(certificate["output"]["vertices"], vertices, "{name}");
        assert_eq!(certificate["valid"]["closed"], true, "{name}");
        let notes = certificate["notes"].to_string();
        assert!(notes.contains("holds triangles alone: polygons were cut into them"), "{notes}");
        let read = report(&run(&["inspect", &out, "--json"]));
        assert_eq!(read["certificate"]["output"]["triangles"], 48, "{name}");
    }
    let ply = folder.text("a.ply");
    let certificate =
        report(&run(&["mesh", &cage, "--surface", "catmull-clark", "--level", "1", "-o", &ply, "--json"]));
    assert_eq!(certificate["certificate"]["output"]["faces"], 24);
    let read = report(&run(&["inspect", &ply, "--json"]));
    assert_eq!(read["certificate"]["output"]["triangles"], 48);
    // A hole has no triangles.
    let holed = folder.file("holed.obj", format!("{CUBE}t hole 1/0/0 5\n"));
    let glb = folder.text("holed.glb");
    let certificate = report(&run(&["mesh", &holed, "--level", "2", "-o", &glb, "--json"]));
    assert_eq!(certificate["certificate"]["output"]["triangles"], 2 * 5 * 16);
}

#[test]
fn tags_or_the_option_decide_and_nothing_changes_without_them() {
    let folder = Folder::new("cage-decide");
    let (plain, tagged) =
        (folder.file("plain.obj", CUBE), folder.file("tagged.obj", format!("{CUBE}{CREASES}")));
    let kind =
        |args: &[&str]| report(&run(&[args, &["--json"]].concat()))["certificate"]["input"]["kind"].clone();
    assert_eq!(kind(&["inspect", &plain]), "triangles");
    assert_eq!(kind(&["inspect", &tagged]), "cage");
    assert_eq!(kind(&["inspect", &plain, "--surface", "catmull-clark"]), "cage");
    assert_eq!(kind(&["inspect", &tagged, "--surface", "faceted"]), "triangles");
    let out = folder.text("out.ply");
    let faceted =
        report(&run(&["mesh", &tagged, "--surface", "faceted", "--tol", "1", "-o", &out, "--json"]));
    assert_eq!(faceted["certificate"]["output"]["triangles"], 12);
    assert_eq!(faceted["certificate"]["bound"]["at_most"], 0.0);
    // What is said of polygons holds for those of two shapes that are such.
    let ply = report(&run(&["deviation", &out, &tagged, "--surface", "faceted", "--json"]));
    assert_eq!(ply["certificate"]["bound"]["at_most"], 0.0);
}

#[test]
fn inspect_says_what_a_cage_is() {
    let folder = Folder::new("cage-inspect");
    let fan = "v 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\nv 1 1 -1\nv 9 9 9\nf 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 2\nf 3 2 6\n";
    let tags =
        "t crease 4/2/0 0 1 0 2 10 0.5\nt corner 2/1/0 3 4 3\nt hole 1/0/0 1\nt creasemethod 0/0/1 chaikin\n";
    let cage = folder.file("fan.obj", format!("{fan}{tags}"));
    let said = report(&run(&["inspect", &cage, "--json"]));
    let facts = &said["inspection"]["cage"];
    let expected = serde_json::json!({
        "scheme": "catmull-clark", "boundary": "edge-only", "creasing": "chaikin",
        "faces_by_corners": {"3": 5}, "edges": 10, "border_edges": 5, "crowded_edges": 0, "isolated_vertices": 1,
        "irregular": {}, "irregular_border": {"2": 1, "4": 2},
        "creases": {"count": 2, "infinite": 1, "range": [0.5, 0.5]},
        "corners": {"count": 2, "infinite": 0, "range": [3.0, 3.0]},
        "holes": 1, "texcoords": null, "texcoords_linear": null
    });
    assert_eq!(facts, &expected);
    let letter = run(&["inspect", &cage, "-q"]).stdout + &run(&["inspect", &cage]).stdout;
    for words in [
        "cage, obj",
        "scheme      catmull-clark",
        "border      edge-only, 5 edges",
        "polygons    5 triangles",
        "valences    irregular on the border: 1 of 2, 2 of 4 edges",
        "creases     2 edges: 1 for ever, 1 of sharpness 0.5, chaikin",
        "corners     2 vertices: 2 of sharpness 3",
        "holes       1 face",
        "isolated    1 vertex",
    ] {
        assert!(letter.contains(words), "no '{words}' in\n{letter}");
    }
}

#[test]
fn the_page_shows_what_is_printed() {
    let folder = Folder::new("cage-page");
    let page = include_str!("../../../docs/cages.md");
    let (_, example) = page.split_once("$ cat sheet.obj\n").unwrap();
    let (sheet, said) = example.split_once("$ chordal inspect sheet.obj\n").unwrap();
    let (said, _) = said.split_once("$ chordal mesh").unwrap();
    folder.file("sheet.obj", sheet);
    let printed = common::chordal(&["inspect", "sheet.obj"]).current_dir(folder.path("")).output().unwrap();
    assert_eq!(String::from_utf8(printed.stdout).unwrap(), said);
}

#[test]
fn what_makes_no_sense_is_refused_in_one_sentence() {
    let folder = Folder::new("cage-refused");
    let plain = folder.file("plain.obj", CUBE);
    let cage = folder.file("cage.obj", format!("{CUBE}{CREASES}"));
    let patch = folder.file("a.bpt", PATCH);
    let out = folder.text("out.obj");
    let fails = |args: &[&str], code: i32, words: &[&str]| {
        run(&[args, &["-q", "-o", &out]].concat()).fails_with(code, words)
    };
    fails(&["mesh", &plain, "--level", "1"], 2, &["--surface catmull-clark makes them one"]);
    fails(
        &["mesh", &patch, "--level", "1"],
        2,
        &["--level is for polygon cages (.obj, .usda, .usdc or .usdz), and the input holds patches"],
    );
    fails(&["mesh", &cage], 2, &["within a budget (--tol, --px or --triangles), or polygons with --level N"]);
    fails(
        &["mesh", &plain, "--surface", "loop", "--level", "1"],
        3,
        &["plain.obj", "line 10", "this face has 4 corners: --surface catmull-clark takes any"],
    );
    fails(
        &["mesh", &patch, "--surface", "loop", "--tol", "1"],
        3,
        &["only the polygons of an .obj or of USD can be a cage"],
    );
    fails(
        &["mesh", &cage, "--level", "1", "--normals", "flat"],
        2,
        &["polygons are written without normals"],
    );
    let svg = folder.text("out.svg");
    run(&["mesh", &cage, "--level", "1", "-o", &svg])
        .fails_with(2, &["cages become polygons or triangles, which svg does not hold"]);
    // Before the work: 24 corners, four times as many faces a round.
    fails(&["mesh", &cage, "--level", "15"], 5, &["15 rounds would give 6442450944 faces"]);
    fails(&["mesh", &cage, "--level", "4000000000"], 5, &["more faces than can be counted"]);
    fails(
        &["mesh", &cage, "--level", "8", "--max-memory", "16M"],
        5,
        &["393216 faces", "the limit is 16777216 (--max-memory)"],
    );
    let broken = folder.file("broken.obj", format!("{CUBE}t crease 2/1/0 0 7 1\n"));
    fails(
        &["mesh", &broken, "--level", "1"],
        3,
        &["broken.obj: line 17: there is no edge between vertices 0 and 7"],
    );
    fails(&["mend", &cage, "--drop-degenerate"], 2, &["--surface faceted takes the polygons as triangles"]);
    assert!(!folder.names().contains(&"out.obj".to_owned()));
}

/// A square of two quads whose texture is cut between them.
const CUT: &str = "v 0 0 0\nv 1 0 0\nv 2 0 1\nv 0 1 0\nv 1 1 0\nv 2 1 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    vt 2 0\nvt 3 0\nvt 3 1\nvt 2 1\nf 1/1 2/2 5/3 4/4\nf 2/5 3/6 6/7 5/8\nt interpolateboundary 1/0/0 1\n\
    t facevaryinginterpolateboundary 1/0/0 1\n";

#[test]
fn texture_coordinates_are_refined_and_meshed() {
    let folder = Folder::new("cage-texture");
    let cage = folder.file("cut.obj", CUT);
    let once = folder.text("once.obj");
    let made = report(&run(&["mesh", &cage, "--level", "1", "-o", &once, "--json"]));
    assert!(!made["certificate"]["notes"].to_string().contains("texture"), "{made}");
    let text = fs::read_to_string(&once).unwrap();
    // Of each face its corners, the middles of its sides and its own.
    assert_eq!(text.lines().filter(|line| line.starts_with("vt ")).count(), 18);
    assert!(text.contains("\nt facevaryinginterpolateboundary 1/0/0 1\n"));
    assert!(text.lines().filter(|line| line.starts_with("f ")).all(|line| line.matches('/').count() == 4));
    let twice = folder.text("twice.obj");
    run(&["mesh", &once, "--level", "1", "-o", &twice, "-q"]).succeeds();
    let said = run(&["inspect", &twice]).stdout;
    assert!(said.contains("texcoords   50, linear: corners-only"), "{said}");
    for (name, seam) in [("smooth.glb", &["--tol", "0.01"]), ("polygons.glb", &["--level", "2"])] {
        let out = folder.text(name);
        let made = report(&run(&["mesh", &cage, seam[0], seam[1], "-o", &out, "--json"]));
        let file = fs::read(&out).unwrap();
        assert!(file.windows(10).any(|window| window == b"TEXCOORD_0"), "{name}");
        let output = &made["certificate"]["output"];
        assert!(output["vertices"].as_u64() > output["positions"].as_u64(), "{name} {output}");
    }
}
