//! `chordal verify`: certificates that are re-proved, and what it finds.
use crate::common;

use chordal_testkit::is_long;
use common::{CLOSED_OBJ, Folder, PATCH, TEAPOT, chordal, run};
use serde_json::Value;
use std::fs;

/// A cube as a cage, whose limit surface is smooth.
const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n\
    f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

/// What stands before each piece of a certificate in an OBJ.
const COMMENT: &str = "# chordal: ";

fn made(args: &[&str]) {
    let made = chordal(args).output().unwrap();
    assert!(made.status.success(), "{args:?}: {}", String::from_utf8_lossy(&made.stderr));
}

fn verdicts(report: &Value) -> Vec<(String, String)> {
    let text = |claim: &Value, key: &str| claim[key].as_str().unwrap().to_owned();
    let claims = report["claims"].as_array().unwrap();
    claims.iter().map(|claim| (text(claim, "claim"), text(claim, "verdict"))).collect()
}

#[test]
fn re_proves_meshes_of_patches_cages_fields_and_triangles_in_every_format_with_a_certificate() {
    let folder = Folder::new("verify-kinds");
    let patch = folder.file("patch.txt", PATCH);
    let field = folder.file("ball.star", "sphere(1) - move(sphere(0.5), 1, 0)\n");
    let cube = folder.file("cube.obj", CUBE);
    let solid = folder.file("solid.obj", CLOSED_OBJ);
    let sources = [
        (&patch, &["--tol", "1%", "--from", "bpt"][..]),
        (&field, &["--tol", "2%"]),
        (&cube, &["--tol", "2%", "--surface", "catmull-clark"]),
        (&solid, &["--tol", "1%"]),
    ];
    for (number, (input, how)) in sources.into_iter().enumerate() {
        let extensions = ["glb", "gltf", "ply", "obj", "off", "3mf", "usda", "vtp"];
        for (k, extension) in extensions.into_iter().enumerate() {
            // Each kind in two formats, and each format once.
            if !is_long() && k % 4 != number {
                continue;
            }
            let out = folder.path(&format!("out.{extension}")).to_str().unwrap().to_owned();
            made(&[&["mesh", input, "-o", &out, "--force"], how].concat());
            let as_read: &[&str] = if how.contains(&"catmull-clark") { &how[2..] } else { &[] };
            let found = run(&[&["verify", &out, "--json", "--against", input], as_read].concat());
            assert_eq!(found.code, 0, "{input} {extension}: {found:?}");
            assert_eq!(found.report()["verdict"], "re-proved");
        }
    }
}

#[test]
fn four_steps_are_re_proved_and_their_sum_is_no_less_than_the_distance_of_the_ends() {
    let folder = Folder::new("verify-four");
    let path = |name: &str| folder.path(name).to_str().unwrap().to_owned();
    let cage = folder.file("cage.obj", CUBE);
    let [smooth, grid, again, small] = ["smooth.ply", "grid.nrrd", "again.ply", "small.glb"].map(path);
    let (first, cells, last) = if is_long() { ("0.02", "16", "0.05") } else { ("0.05", "6", "0.1") };
    made(&["mesh", &cage, "--surface", "catmull-clark", "--tol", first, "-o", &smooth]);
    made(&["bake", &smooth, "--cells", cells, "--bound", "-o", &grid]);
    made(&["mesh", &grid, "-o", &again]);
    made(&["mesh", &again, "--tol", last, "-o", &small]);
    let mut args = vec!["verify", &small, "--surface", "catmull-clark", "--json", "-q", "--against"];
    args.extend([&cage[..], &smooth, &grid, &again]);
    let found = run(&args);
    assert_eq!(found.code, 0, "{found:?}");
    let inspected = run(&["inspect", &small, "--json"]).report();
    let certificate = &inspected["inspection"]["found"]["certificate"];
    let history = &certificate["history"];
    assert_eq!(history["steps"].as_array().unwrap().len(), 4, "{history:#}");
    assert_eq!(history["begins"]["code"], "no-certificate");
    let total = history["total"]["at_most"].as_f64().unwrap();
    let sum: f64 = (0..4).map(|k| history["steps"][k]["bound"]["at_most"].as_f64().unwrap()).sum();
    assert!(total >= sum && total <= sum * (1.0 + 1e-12), "{total} {sum}");
    assert_eq!(history["total"]["reference"], "limit surface");
    // A direct measurement of the ends.
    let direct = run(&["deviation", &small, &cage, "--surface", "catmull-clark", "--json"]).report();
    let measured = direct["certificate"]["bound"]["at_least"].as_f64().unwrap();
    assert!(measured > 0.0 && measured <= total, "{measured} {total}");
    // Without the files between, the steps are open; with another cage, a claim is wrong, as of one step below.
    let alone = run(&["verify", &small, "--surface", "catmull-clark", "--against", &cage]);
    alone_fails(&alone, 6, "was not given");
    if is_long() {
        let other = folder.file("other.obj", CUBE.replace("v 1 1 1\n", "v 1 1 1.5\n"));
        let mut swapped = args.clone();
        swapped[7] = &other;
        alone_fails(&run(&swapped), 1, "another input");
    }
}

fn alone_fails(found: &common::Run, code: i32, part: &str) {
    assert_eq!(found.code, code, "{found:?}");
    assert!(found.stderr.lines().count() == 1 && found.stderr.contains(part), "{found:?}");
}

/// The comments of an OBJ in which its certificate is, and what they say together.
fn certificate_in(content: &str) -> (String, String) {
    let is_piece = |line: &&str| line.starts_with(COMMENT);
    let lines: String = content.lines().filter(is_piece).map(|line| format!("{line}\n")).collect();
    assert!(content.contains(&lines), "they follow each other");
    let piece = |line: &str| line.strip_prefix(COMMENT)?.split_once(' ').map(|(_, piece)| piece.to_owned());
    let json = lines.lines().filter_map(piece).collect();
    (lines, json)
}

/// The same file with another certificate, in one line as earlier versions wrote it.
fn with_certificate(content: &str, json: &str) -> String {
    let (lines, _) = certificate_in(content);
    content.replacen(&lines, &format!("{COMMENT}{json}\n"), 1)
}

/// A teapot as text, whose numbers can be changed.
fn teapot(folder: &Folder) -> (String, String) {
    let out = folder.path("teapot.ply").to_str().unwrap().to_owned();
    made(&["mesh", TEAPOT, "--tol", "1%", "-o", &out]);
    let text = folder.path("teapot.obj").to_str().unwrap().to_owned();
    made(&["mesh", TEAPOT, "--tol", "1%", "-o", &text]);
    let content = fs::read_to_string(&text).unwrap();
    (text, content)
}

#[test]
fn finds_a_vertex_that_moved_by_one_step_a_flipped_face_and_an_edited_certificate() {
    let folder = Folder::new("verify-edits");
    let (path, content) = teapot(&folder);
    run(&["verify", &path, "--quiet", "--against", TEAPOT]).succeeds();
    let vertex = content.lines().find(|line| line.starts_with("v ")).unwrap();
    let numbers: Vec<f64> = vertex.split(' ').skip(1).take(3).map(|word| word.parse().unwrap()).collect();
    let moved = format!("v {} {} {}", numbers[0].next_up(), numbers[1], numbers[2]);
    let face = content.lines().find(|line| line.starts_with("f ")).unwrap();
    let corners: Vec<&str> = face.split(' ').skip(1).collect();
    let flipped = format!("f {} {} {}", corners[0], corners[2], corners[1]);
    let (_, json) = certificate_in(&content);
    let at_most = json.split("\"at_most\":").nth(1).unwrap().split(',').next().unwrap();
    let edited = |whole: &str, old: &str, new: &str| {
        assert!(whole.contains(old), "{old}");
        whole.replacen(old, new, 1)
    };
    for (edited, part) in [
        (edited(&content, vertex, &moved), "geometry"),
        (edited(&content, face, &flipped), "wrong"),
        (with_certificate(&content, &edited(&json, at_most, "1e-9")), "seal"),
        (with_certificate(&content, &edited(&json, "\"closed\":false", "\"closed\":true")), "seal"),
    ] {
        fs::write(&path, edited).unwrap();
        alone_fails(&run(&["verify", &path, "--quiet", "--against", TEAPOT]), 1, part);
    }
}

#[test]
fn finds_a_lie_that_was_sealed_again() {
    let folder = Folder::new("verify-liar");
    let (path, content) = teapot(&folder);
    let honest: Value = serde_json::from_str(&certificate_in(&content).1).unwrap();
    let lie = |change: &dyn Fn(&mut Value)| {
        let mut certificate = honest.clone();
        change(&mut certificate);
        certificate["seal"] = chordal_verbs::seal_of(&certificate).into();
        fs::write(&path, with_certificate(&content, &certificate.to_string())).unwrap();
        run(&["verify", &path, "--quiet", "--against", TEAPOT])
    };
    assert_eq!(lie(&|_| {}).code, 0, "sealing again changes nothing");
    // The bound in all three places, a hundredth of what it is.
    let smaller = lie(&|certificate| {
        let at_most = certificate["bound"]["at_most"].as_f64().unwrap() / 100.0;
        for at in ["/bound", "/history/steps/0/bound", "/history/total"] {
            let bound = certificate.pointer_mut(at).unwrap();
            bound["at_most"] = at_most.into();
            bound["at_least"] = 0.0.into();
        }
    });
    alone_fails(&smaller, 1, "at most is claimed");
    let total = lie(&|certificate| certificate["history"]["total"]["at_most"] = 1e-9.into());
    alone_fails(&total, 1, "history/total");
    let counts = lie(&|certificate| certificate["output"]["triangles"] = 12.into());
    alone_fails(&counts, 1, "output/triangles");
    let closed = lie(&|certificate| {
        certificate["valid"]["manifold"] = Value::from(!honest["valid"]["manifold"].as_bool().unwrap())
    });
    alone_fails(&closed, 1, "valid/manifold");
    let input = lie(&|certificate| certificate["history"]["steps"][0]["inputs"] = serde_json::json!([]));
    assert_ne!(input.code, 0);
    let two = lie(&|certificate| {
        let input = certificate["history"]["steps"][0]["inputs"][0].clone();
        certificate["history"]["steps"][0]["inputs"].as_array_mut().unwrap().push(input);
    });
    alone_fails(&two, 6, "combined 2 inputs");
    let evidence =
        lie(&|certificate| certificate["history"]["steps"][0]["bound"]["evidence"] = "measured".into());
    assert_eq!(evidence.code, 1, "{evidence:?}");
}

#[test]
fn a_report_serves_where_the_format_holds_no_certificate() {
    let folder = Folder::new("verify-report");
    let solid = folder.file("solid.obj", CLOSED_OBJ);
    let out = folder.path("out.stl").to_str().unwrap().to_owned();
    let made = run(&["convert", &solid, &out, "--json"]);
    let report = folder.file("report.json", &made.stdout);
    alone_fails(&run(&["verify", &out, "--against", &solid]), 2, "no certificate");
    let found = run(&["verify", &out, "--against", &solid, "--certificate", &report, "--json"]);
    assert_eq!(found.code, 0, "{found:?}");
    // By indices each of its triangles stands alone, which is counted as well.
    let unchecked = found.report()["unchecked"].to_string();
    assert!(!unchecked.contains("valid"), "{unchecked}");
    let claims = verdicts(&found.report());
    assert!(claims.contains(&("valid".to_owned(), "re-proved".to_owned())), "{claims:?}");
    let other = folder.file("other.obj", CLOSED_OBJ.replace("v 0 0 1", "v 0 0 1.5"));
    alone_fails(&run(&["verify", &out, "--against", &other, "--certificate", &report]), 1, "another input");
    let wrong = folder.file("wrong.json", "not json");
    alone_fails(&run(&["verify", &out, "--against", &solid, "--certificate", &wrong]), 3, "not a report");
}

#[test]
fn a_file_that_was_changed_between_two_steps_begins_a_new_history() {
    let folder = Folder::new("verify-break");
    let solid = folder.file("solid.obj", CLOSED_OBJ);
    let path = |name: &str| folder.path(name).to_str().unwrap().to_owned();
    let [first, second] = ["first.obj", "second.ply"].map(path);
    let begins = |args: &[&str]| {
        let report = run(&[args, &["--json", "--force"]].concat()).report();
        let history = report["certificate"]["history"].clone();
        let steps = history["steps"].as_array().unwrap().len();
        (steps, history["begins"]["code"].as_str().unwrap().to_owned())
    };
    assert_eq!(begins(&["convert", &solid, &first]), (1, "no-certificate".to_owned()));
    assert_eq!(begins(&["convert", &first, &second]), (2, "no-certificate".to_owned()));
    assert_eq!(begins(&["convert", &first, &second, "--unit", "mm"]), (2, "no-certificate".to_owned()));
    let text = fs::read_to_string(&first).unwrap();
    fs::write(&first, text.replacen("v 1 ", "v 1.5 ", 1)).unwrap();
    assert_eq!(begins(&["convert", &first, &second]), (1, "geometry".to_owned()));
    let edited = certificate_in(&text).1.replacen("\"closed\":true", "\"closed\":false", 1);
    fs::write(&first, with_certificate(&text, &edited)).unwrap();
    assert_eq!(begins(&["convert", &first, &second]), (1, "seal".to_owned()));
    // A glTF of millimetres is in metres: the bounds are in units of the file before.
    let glb = path("scaled.glb");
    fs::write(&first, text).unwrap();
    begins(&["convert", &solid, &glb, "--unit", "mm"]);
    assert_eq!(begins(&["convert", &glb, &second]), (1, "unit".to_owned()));
    run(&["verify", &glb, "--against", &solid]).succeeds();
}

#[test]
fn levels_of_detail_carry_their_histories_too() {
    let folder = Folder::new("verify-levels");
    let field = folder.file("ball.star", "sphere(1)\n");
    let path = |name: &str| folder.path(name).to_str().unwrap().to_owned();
    let [glb, tiles] = ["levels.glb", "tiles"].map(path);
    let length = if is_long() { "1%" } else { "3%" };
    let report = run(&["lod", &field, "--tol", length, "-o", &glb, "--json"]).report();
    run(&["verify", &glb, "--quiet", "--against", &field]).succeeds();
    let levels = report["certificate"]["levels"]["levels"].as_array().unwrap();
    assert!(levels.len() > 1 && levels.iter().all(|level| level["geometry"].is_string()), "{levels:#?}");
    made(&["lod", &field, "--tol", length, "-o", &tiles]);
    for (k, level) in levels.iter().enumerate() {
        let tile = format!("{tiles}/level_{k}.glb");
        let found = run(&["verify", &tile, "--against", &field, "--json"]);
        assert_eq!(found.code, 0, "{found:?}");
        let steps = run(&["inspect", &tile, "--json"]).report();
        let own = &steps["inspection"]["found"]["certificate"]["history"]["steps"][0];
        assert_eq!(own["output"]["geometry"], level["geometry"], "level {k}");
    }
}

#[test]
fn the_report_follows_its_schema() {
    let folder = Folder::new("verify-schema");
    let solid = folder.file("solid.obj", CLOSED_OBJ);
    let out = folder.path("out.ply").to_str().unwrap().to_owned();
    made(&["convert", &solid, &out]);
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/verify.schema.json");
    let schema: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    for against in [&solid, &out] {
        let report = run(&["verify", &out, "--against", against, "--json"]).report();
        assert!(schema.is_valid(&report), "{report:#}");
        assert!(verdicts(&report).iter().any(|(claim, _)| claim == "seal"));
    }
    let mut other = run(&["verify", &out, "--against", &solid, "--json"]).report();
    other["verdict"] = "fine".into();
    assert!(!schema.is_valid(&other));
}
