//! Scripts that GLB and 3MF carry: written out, proved again, left out.
use crate::common;

use common::{CLOSED_OBJ, Folder, run};
use serde_json::{Value, json};
use std::fs;

/// A plate with a hole, whose size is a parameter.
const PLATE: &str = "r = param('r', 0.4)\nbox(2, 2, 1) - cylinder(r, 2)\n";

fn found(file: &str) -> Value {
    run(&["inspect", file, "--json"]).report()["inspection"]["found"]["certificate"].clone()
}

/// Whether so many claims of a name were made, and all of them were re-proved.
fn is_proved(report: &Value, name: &str, n: usize) -> bool {
    let claims = report["claims"].as_array().unwrap();
    let claims: Vec<_> = claims.iter().filter(|claim| claim["claim"] == name).collect();
    claims.len() == n && claims.iter().all(|claim| claim["verdict"] == "re-proved")
}

#[test]
fn a_file_carries_its_script_and_is_proved_from_it_alone() {
    let folder = Folder::new("carried");
    let script = folder.file("plate.star", PLATE);
    for extension in ["glb", "gltf", "3mf"] {
        let out = folder.text(&format!("out.{extension}"));
        run(&["mesh", &script, "--set", "r=0.5", "--tol", "1%", "-o", &out, "--quiet"]).succeeds();
        let source = &found(&out)["sources"][0];
        assert_eq!(source["name"], "plate.star");
        assert_eq!((&source["text"], &source["parameters"]), (&PLATE.into(), &json!({ "r": 0.5 })));
        let folder_name = folder.text("");
        assert!(!source.to_string().contains(&folder_name), "no path of this machine: {source}");
        let shown = run(&["inspect", &out]);
        assert!(shown.stdout.contains("plate.star, 2 lines --set r=0.5"), "{}", shown.stdout);
        fs::rename(&script, folder.path("gone")).unwrap();
        let verified = run(&["verify", &out, "--json"]);
        fs::rename(folder.path("gone"), &script).unwrap();
        assert_eq!(verified.code, 0, "{verified:?}");
        assert_eq!(verified.report()["verdict"], "re-proved");
        let back = folder.text("back.star");
        run(&["convert", &out, &back, "--force", "--quiet"]).succeeds();
        assert_eq!(fs::read_to_string(&back).unwrap(), PLATE);
    }
}

#[test]
fn the_same_script_and_parameters_give_the_same_bytes() {
    let folder = Folder::new("carried-same");
    let script = folder.file("plate.star", PLATE);
    let [a, b] = ["a.3mf", "b.3mf"].map(|name| folder.text(name));
    for out in [&a, &b] {
        run(&["mesh", &script, "--tol", "1%", "-o", out, "--quiet"]).succeeds();
    }
    assert_eq!(fs::read(a).unwrap(), fs::read(b).unwrap());
}

#[test]
fn no_source_leaves_the_script_out_and_the_proof_needs_the_file() {
    let folder = Folder::new("carried-not");
    let script = folder.file("plate.star", PLATE);
    for (verb, extension) in [("mesh", "glb"), ("mesh", "3mf"), ("lod", "glb")] {
        let out = folder.text(&format!("{verb}.{extension}"));
        run(&[verb, &script, "--tol", "1%", "-o", &out, "--no-source", "--quiet"]).succeeds();
        assert_eq!(found(&out).get("sources"), None);
        run(&["verify", &out]).fails_with(2, &["carries no script", "--against"]);
        let named = run(&["verify", &out, "--against", &script, "--json"]);
        assert_eq!(named.report()["verdict"], "re-proved", "{named:?}");
        run(&["convert", &out, &folder.text("back.star")]).fails_with(2, &["carries no script"]);
    }
    // Formats whose certificate stands in comments carry none, and neither does what was no script.
    let ply = folder.text("out.ply");
    run(&["mesh", &script, "--tol", "1%", "-o", &ply, "--quiet"]).succeeds();
    assert_eq!(found(&ply).get("sources"), None);
    let solid = folder.file("solid.obj", CLOSED_OBJ);
    let glb = folder.text("solid.glb");
    run(&["mesh", &solid, "--tol", "1%", "-o", &glb, "--quiet"]).succeeds();
    assert_eq!(found(&glb).get("sources"), None);
}

#[test]
fn later_steps_pass_the_script_on_and_a_changed_file_does_not() {
    let folder = Folder::new("carried-on");
    let script = folder.file("plate.star", PLATE);
    let [glb, threemf, levels] = ["a.glb", "b.3mf", "c.glb"].map(|name| folder.text(name));
    run(&["mesh", &script, "--tol", "1%", "-o", &glb, "--quiet"]).succeeds();
    run(&["convert", &glb, &threemf, "--quiet"]).succeeds();
    assert_eq!(found(&threemf)["sources"][0]["text"], PLATE);
    // The step between needs its file; the script does not.
    let verified = run(&["verify", &threemf, "--against", &glb, "--json"]);
    assert_eq!(verified.report()["verdict"], "re-proved", "{verified:?}");
    run(&["lod", &script, "--tol", "1%", "-o", &levels, "--quiet"]).succeeds();
    assert_eq!(found(&levels)["sources"][0]["text"], PLATE);
    run(&["convert", &glb, &threemf, "--no-source", "--force", "--quiet"]).succeeds();
    assert_eq!(found(&threemf).get("sources"), None);
    // Another text in the file breaks the seal, so that nothing is passed on and nothing is proved.
    let text = String::from_utf8_lossy(&fs::read(&glb).unwrap()).into_owned();
    assert!(text.contains("box(2, 2, 1)"));
    let edited: Vec<u8> = {
        let mut bytes = fs::read(&glb).unwrap();
        let at = bytes.windows(12).position(|window| window == b"box(2, 2, 1)").expect("it is plain JSON");
        bytes[at + 4] = b'3';
        bytes
    };
    fs::write(&glb, edited).unwrap();
    let verified = run(&["verify", &glb, "--json"]);
    assert_eq!((verified.code, &verified.report()["verdict"]), (1, &"refuted".into()), "{verified:?}");
    run(&["convert", &glb, &threemf, "--force", "--quiet"]).succeeds();
    assert_eq!(found(&threemf).get("sources"), None);
}

#[test]
fn a_kept_certificate_is_that_of_the_first_step_and_proved_from_the_script_alone() {
    let folder = Folder::new("carried-kept");
    let script = folder.file("plate.star", PLATE);
    let glb = folder.text("a.glb");
    run(&["mesh", &script, "--tol", "1%", "-o", &glb, "--quiet"]).succeeds();
    let first = found(&glb);
    for extension in ["3mf", "ply", "obj"] {
        let out = folder.text(&format!("b.{extension}"));
        run(&["convert", &glb, &out, "--keep-certificate", "--quiet"]).succeeds();
        let kept = found(&out);
        assert_eq!(kept["bound"], first["bound"]);
        assert_eq!(kept["history"]["steps"].as_array().unwrap().len(), 1);
        assert_eq!(kept.get("sources").is_some(), extension == "3mf");
        let [read, was] =
            [&out, &glb].map(|file| run(&["inspect", file, "--json"]).report()["inspection"]["box"].clone());
        assert_eq!(read, was, "nothing is turned or scaled");
        let verified = run(&["verify", &out, "--against", &script, "--json"]);
        assert_eq!(verified.report()["verdict"], "re-proved", "{verified:?}");
    }
    let verified = run(&["verify", &folder.text("b.3mf")]);
    assert_eq!(verified.code, 0, "{verified:?}");
    let bare = folder.text("bare.3mf");
    run(&["convert", &glb, &bare, "--keep-certificate", "--no-source", "--quiet"]).succeeds();
    let verified = run(&["verify", &bare, "--against", &script]);
    assert!(verified.code == 0 && found(&bare).get("sources").is_none(), "{verified:?}");
    let solid = folder.file("solid.obj", CLOSED_OBJ);
    run(&["convert", &solid, &folder.text("c.glb"), "--keep-certificate"])
        .fails_with(2, &["no certificate to keep"]);
}

#[test]
fn scripts_that_a_script_loads_are_carried_as_text_and_other_files_by_name() {
    let folder = Folder::new("carried-beside");
    folder.file("lib.star", "def peg(h):\n    return cylinder(0.3, h)\n");
    folder.file("solid.obj", CLOSED_OBJ);
    let text = "load('lib.star', 'peg')\nbox(2, 2, 1) | peg(3) | mesh('solid.obj')\n";
    let script = folder.file("with.star", text);
    let out = folder.text("with.glb");
    run(&["mesh", &script, "--tol", "2%", "-o", &out, "--quiet"]).succeeds();
    let files = found(&out)["sources"][0]["files"].clone();
    let texts: Vec<_> =
        files.as_array().unwrap().iter().map(|file| (&file["path"], file.get("text").is_some())).collect();
    assert_eq!(texts, [(&json!("lib.star"), true), (&json!("solid.obj"), false)]);
    fs::remove_file(folder.path("lib.star")).unwrap();
    // Both are read again; no judge proves the bound of a field with a mesh.
    assert!(is_proved(&run(&["verify", &out, "--json"]).report(), "input", 1));
    fs::remove_file(folder.path("solid.obj")).unwrap();
    run(&["verify", &out]).fails_showing(3, &["solid.obj"]);
}

#[test]
fn a_cut_carries_the_scripts_of_all_its_operands() {
    let folder = Folder::new("carried-cut");
    let a = folder.file("a.star", "box(2, 2, 1)\n");
    let b = folder.file("b.star", "move(sphere(0.5), 0.3, 0.2, 0.5)\n");
    let out = folder.text("cut.glb");
    run(&["mesh", &a, "--minus", &b, "--tol", "1%", "-o", &out, "--quiet"]).succeeds();
    let names: Vec<_> =
        found(&out)["sources"].as_array().unwrap().iter().map(|source| source["name"].clone()).collect();
    assert_eq!(names, ["a.star", "b.star"]);
    // No judge proves such a step, but both inputs are there.
    assert!(is_proved(&run(&["verify", &out, "--json"]).report(), "input", 2));
}
