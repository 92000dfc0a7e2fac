//! Reports: every one follows the schema, and a certificate depends on nothing but input, version and budget.
use crate::common;

use common::{CLOSED_OBJ, Folder, OPEN_OBJ, PATCH, TEAPOT, run};
use serde_json::Value;

fn schema() -> jsonschema::Validator {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema/report.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    jsonschema::meta::validate(&schema).unwrap();
    jsonschema::validator_for(&schema).unwrap()
}

#[track_caller]
fn follows(schema: &jsonschema::Validator, report: &Value) {
    let wrong: Vec<_> = schema.iter_errors(report).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(wrong.is_empty(), "{wrong:#?}\n{report:#}");
}

#[test]
fn every_report_follows_the_schema() {
    let folder = Folder::new("schema");
    let schema = schema();
    let (patch, open) = (folder.file("a.bpt", PATCH), folder.file("open.obj", OPEN_OBJ));
    let view = "1920x1080 fov=45 dist=4";
    let eye = "640x480 height=9 eye=5,5,5 target=0,0,0 near=1";
    let glb = folder.text("a.glb");
    let budgets: [&[&str]; 5] = [
        &["--tol", "0.1"],
        &["--tol", "1%", "--triangles", "100000"],
        &["--tol", "3mm", "--unit", "cm", "--up", "z"],
        &["--px", "1", "--view", view],
        &["--px", "1", "--view", eye],
    ];
    for budget in budgets {
        let made = run(&[&["mesh", &patch, "-o", &glb, "--force", "--json"], budget].concat());
        made.succeeds();
        follows(&schema, &made.report());
    }
    for input in [&patch, &open, &glb] {
        let inspected = run(&["inspect", input, "--json"]);
        inspected.succeeds();
        follows(&schema, &inspected.report());
    }
    let drawn = run(&["render", &glb, "-o", &folder.text("a.png"), "--size", "40x30", "--json"]);
    drawn.succeeds();
    follows(&schema, &drawn.report());

    let failed = run(&["mesh", &patch, "-o", &folder.text("b.obj"), "--tol", "1e-30", "--json"]);
    failed.fails_with(5, &["a.bpt"]);
    follows(&schema, &failed.report());
    assert_eq!(failed.report()["error"]["exit"], 5);
}

#[test]
fn a_texture_that_slides_is_said() {
    let folder = Folder::new("slides");
    let at = |i: u32| f64::from(i) / 20.0;
    let places: Vec<[f64; 2]> = (0..21).flat_map(|i| (0..21).map(move |j| [at(i), at(j)])).collect();
    let mut obj = String::new();
    for [x, y] in &places {
        obj += &format!("v {x} {y} {}\nvt {} {}\n", 0.1 * x * x, x * x, y * y);
    }
    for (i, j) in (0..20).flat_map(|i| (0..20).map(move |j| (i, j))) {
        let [a, b, c, d] = [0, 21, 22, 1].map(|step| 21 * i + j + step + 1);
        obj += &format!("f {a}/{a} {b}/{b} {c}/{c}\nf {a}/{a} {c}/{c} {d}/{d}\n");
    }
    let (input, output) = (folder.file("a.obj", &obj), folder.text("b.glb"));
    let args = ["mesh", &input, "-o", &output, "--tol", "1%", "--force"];
    let made = run(&[&args[..], &["--json"]].concat());
    made.succeeds();
    follows(&schema(), &made.report());
    let facts = &made.report()["certificate"]["attributes"][0];
    assert_eq!((&facts["name"], &facts["unit"]), (&"texcoord 0".into(), &"value".into()));
    assert!(facts["largest"].as_f64().is_some_and(|largest| largest > 0.01 && largest < 0.5), "{facts}");
    let told = run(&args);
    told.succeeds();
    assert!(
        told.stderr.contains("texcoord 0 off up to 0.") || told.stdout.contains("texcoord 0 off up to 0."),
        "{told:?}"
    );
}

#[test]
fn the_schema_refuses_what_is_no_report() {
    let folder = Folder::new("refuses");
    let schema = schema();
    let patch = folder.file("a.bpt", PATCH);
    let good = run(&["mesh", &patch, "-o", &folder.text("a.obj"), "--tol", "0.1", "--json"]).report();
    follows(&schema, &good);
    let broken: [(&str, Value); 7] = [
        ("/certificate/bound/at_most", Value::Null),
        ("/certificate/bound/evidence", "believed".into()),
        ("/certificate/valid/closed", 1.into()),
        ("/certificate/valid/other", Value::Null),
        ("/certificate/budget/length", 0.into()),
        ("/certificate/input/sha256", "abc".into()),
        ("/schema", "chordal.report/2".into()),
    ];
    for (pointer, value) in broken {
        let mut report = good.clone();
        *report.pointer_mut(pointer).unwrap() = value;
        assert!(!schema.is_valid(&report), "{pointer}");
    }
    for object in ["", "/certificate", "/certificate/valid", "/certificate/bound", "/run"] {
        let mut report = good.clone();
        report.pointer_mut(object).unwrap().as_object_mut().unwrap().insert("more".into(), 1.into());
        assert!(!schema.is_valid(&report), "a new key in '{object}'");
    }
}

#[test]
fn a_certificate_travels_in_the_file_and_is_found_again() {
    let folder = Folder::new("travels");
    let (patch, glb) = (folder.file("a.bpt", PATCH), folder.text("a.glb"));
    let made = run(&["mesh", &patch, "-o", &glb, "--tol", "0.01", "--json"]).report();
    let inspected = run(&["inspect", &glb, "--json"]).report();
    let found = &inspected["inspection"]["found"];
    assert_eq!(found["certificate"], made["certificate"]);
    assert_eq!(found["differs"], Value::Array(Vec::new()), "{inspected:#}");
    // The teapot touches itself at a point, so that its positions are fewer by bits than by indices.
    let teapot = folder.text("teapot.glb");
    run(&["mesh", TEAPOT, "-o", &teapot, "--tol", "0.01", "-q"]).succeeds();
    let inspected = run(&["inspect", &teapot, "--json"]).report();
    assert_eq!(inspected["inspection"]["found"]["differs"], Value::Array(Vec::new()), "{inspected:#}");

    let shown = run(&["inspect", &glb]);
    assert!(shown.stdout.contains("(proved)"), "{shown:?}");
}

#[test]
fn a_certificate_says_the_same_whatever_the_name_place_and_threads() {
    let folder = Folder::new("same");
    let (a, b) = (folder.file("a.bpt", PATCH), folder.file("b.bpt", PATCH));
    let make = |input: &str, output: &str, threads: &str| {
        let output = folder.text(output);
        let made = run(&["mesh", input, "-o", &output, "--tol", "1e-4", "--threads", threads, "--json"]);
        made.succeeds();
        (made.report(), std::fs::read(output).unwrap())
    };
    let (first, second) = (make(&a, "1.glb", "1"), make(&b, "2.glb", "2"));
    assert_eq!(first.0["certificate"], second.0["certificate"]);
    assert!(first.1 == second.1, "the same bytes");
    assert_eq!((&first.0["run"]["threads"], &second.0["run"]["threads"]), (&1.into(), &2.into()));
    // The digest is that of the bytes.
    assert_eq!(first.0["certificate"]["input"]["sha256"], chordal_verbs::sha256(PATCH.as_bytes()));
}

#[test]
fn what_is_certified_is_what_reads_back() {
    let folder = Folder::new("reads-back");
    // A roof whose two sides have normals and groups of their own, and a vertex that no face names.
    let roof = "v 0 0 0\nv 1 0 0\nv 0 1 1\nv 1 1 1\nv 0 2 0\nv 1 2 0\nv 7 7 7\nvn 0 -1 1\nvn 0 1 1\nusemtl a\n\
        f 1//1 2//1 4//1 3//1\nusemtl b\nf 3//2 4//2 6//2 5//2\n";
    for (name, text) in
        [("a.bpt", PATCH), ("open.obj", OPEN_OBJ), ("closed.obj", CLOSED_OBJ), ("roof.obj", roof)]
    {
        let input = folder.file(name, text);
        for extension in ["obj", "ply", "stl", "glb"] {
            let output = folder.text(&format!("{name}.{extension}"));
            let made = run(&["mesh", &input, "-o", &output, "--tol", "0.02", "--json"]).report();
            let read = run(&["inspect", &output, "--json"]).report();
            assert_eq!(
                made["certificate"]["output"]["triangles"],
                read["certificate"]["output"]["triangles"]
            );
            let (certified, counted) = (&made["certificate"]["valid"], &read["certificate"]["valid"]);
            for (key, value) in certified.as_object().unwrap().iter().filter(|(key, _)| *key != "other") {
                assert_eq!(value, &counted[key], "{output}: {key}");
            }
        }
    }
}

#[test]
fn requirements_make_inspect_a_check() {
    let folder = Folder::new("require");
    let (open, closed) = (folder.file("open.obj", OPEN_OBJ), folder.file("closed.obj", CLOSED_OBJ));
    run(&["inspect", &closed, "--require", "closed,manifold,oriented", "-q"]).succeeds();
    run(&["inspect", &open, "--require", "manifold,oriented", "-q"]).succeeds();
    run(&["inspect", &open, "--require", "closed,manifold", "-q"]).fails_with(
        1,
        &["open.obj: not closed: 3 boundary edges, the first is edge 0-1 of triangle 0 at (0.5, 0, 0)"],
    );
    let turned = folder.file("turned.obj", CLOSED_OBJ.replace("f 1 3 2", "f 1 2 3"));
    run(&["inspect", &turned, "--require", "oriented", "-q"]).fails_with(1, &["not oriented: 3 edges"]);
    let fin = folder.file("fin.obj", format!("{CLOSED_OBJ}v 5 5 5\nf 1 2 5\n"));
    let both = run(&["inspect", &fin, "--require", "manifold,closed", "-q"]);
    // The edge of the fin, the two vertices at its ends, and its own two edges.
    assert_eq!((both.code, both.stderr.lines().count()), (1, 3), "{both:?}");
    run(&["inspect", &closed, "--require", "pretty"]).fails_with(2, &["pretty"]);
    let patch = folder.file("a.bpt", PATCH);
    run(&["inspect", &patch, "--require", "closed", "-q"]).fails_with(1, &["no triangles"]);
    // The report is still there for programs.
    let json = run(&["inspect", &open, "--require", "closed", "--json"]);
    assert_eq!((json.code, &json.report()["certificate"]["valid"]["closed"]), (1, &false.into()));
}

#[test]
fn the_schema_knows_every_format() {
    let schema: Value = serde_json::from_str(
        &std::fs::read_to_string(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../docs/schema/report.schema.json"
        ))
        .unwrap(),
    )
    .unwrap();
    let named = &schema["$defs"]["input"]["properties"]["format"]["enum"];
    let named: Vec<&str> = named.as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    let formats: Vec<String> = chordal_io::Format::all().map(|format| format.to_string()).collect();
    assert!(formats.len() > 20);
    assert!(formats.iter().all(|format| named.contains(&format.as_str())), "{formats:?} in {named:?}");
}
