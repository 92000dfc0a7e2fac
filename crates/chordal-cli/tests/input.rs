//! Inputs that are no files, and files that are wrong.
use crate::common;

use common::{Folder, PATCH, Run, chordal, run};
use std::io::Write;
use std::process::Stdio;

#[test]
fn h28_what_is_no_file_is_refused_before_it_is_read() {
    let folder = Folder::new("h28");
    let output = folder.text("out.glb");
    let here = folder.text(".");
    run(&["mesh", &here, "-o", &output, "--tol", "1"]).fails_with(3, &["folder"]);
    run(&["mesh", &folder.text("no.bpt"), "-o", &output, "--tol", "1"])
        .fails_with(3, &["no.bpt: ", "no such file or directory"]);
    run(&["inspect", &folder.file("empty.obj", "")]).fails_with(3, &["empty.obj: ", "empty"]);
    run(&["inspect", &folder.file("blank", "  \n \n")]).fails_with(3, &["blank: "]);
    run(&["inspect", &folder.file("byte", "x")]).fails_with(3, &["byte: ", "--from"]);
    run(&["inspect", &folder.file("wrong.glb", PATCH)]).fails_with(3, &["wrong.glb: "]);
    run(&["mesh", &folder.file("a.docx", "x y z"), "-o", &output, "--tol", "1"]).fails_with(3, &["a.docx: "]);
}

#[cfg(unix)]
#[test]
fn h28_devices_and_pipes_are_refused_without_waiting_for_them() {
    let folder = Folder::new("h28-devices");
    run(&["inspect", "/dev/zero"]).fails_with(3, &["/dev/zero: ", "device"]);
    run(&["inspect", "/dev/null"]).fails_with(3, &["/dev/null: ", "device"]);
    let pipe = folder.text("pipe");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    if !made.is_ok_and(|status| status.success()) {
        eprintln!("SKIPPED: h28 on a pipe, because there is no mkfifo");
        return;
    }
    // Nobody writes to it: whoever opens it to read waits for ever.
    run(&["inspect", &pipe]).fails_with(3, &["pipe: ", "device, pipe or socket"]);
}

#[test]
fn h71_patches_that_are_odd_are_meshed_or_refused_with_their_place() {
    let folder = Folder::new("h71");
    let mesh = |name: &str, text: String| {
        let (input, output) = (folder.file(name, text), folder.text("out.obj"));
        run(&["mesh", &input, "-o", &output, "--tol", "0.01", "--json", "--force"])
    };
    let one = |points: [[f64; 3]; 16]| {
        let rows: Vec<_> = points.iter().map(|p| format!("{} {} {}", p[0], p[1], p[2])).collect();
        format!("1\n3 3\n{}\n", rows.join("\n"))
    };
    let grid =
        |f: &dyn Fn(f64, f64) -> [f64; 3]| one(std::array::from_fn(|i| f((i % 4) as f64, (i / 4) as f64)));

    for (name, value) in [("nan.bpt", "nan"), ("inf.bpt", "inf"), ("big.bpt", "1e999")] {
        let refused = mesh(name, PATCH.replacen("1 1 2", &format!("1 {value} 2"), 1));
        assert_eq!(refused.code, 3, "{refused:?}");
        refused.fails_with(3, &[name, "line "]);
    }
    mesh("short.bpt", PATCH[..60].to_owned()).fails_with(3, &["short.bpt: "]);
    mesh("many.bpt", PATCH.replacen('1', "1000000000", 1)).fails_with(3, &["many.bpt: "]);

    // All control points equal: nothing to see, and said so or meshed to nothing; no panic and no NaN.
    let point = mesh("point.bpt", one([[1.0, 2.0, 3.0]; 16]));
    assert!([0, 3].contains(&point.code), "{point:?}");
    // A pole, a cusp, a patch that folds back on itself.
    let pole = mesh("pole.bpt", grid(&|u, v| [u * v, v, 0.0]));
    let cusp = mesh("cusp.bpt", grid(&|u, v| [[0.0, 3.0, 0.0, 3.0][u as usize], v, 0.0]));
    let fold = mesh("fold.bpt", grid(&|u, v| [if u > 1.5 { 3.0 - u } else { u }, v, u]));
    for (name, made) in [("pole", pole), ("cusp", cusp), ("fold", fold)] {
        assert_eq!(made.code, 0, "{name}: {made:?}");
        let certificate = &made.report()["certificate"];
        assert_eq!(certificate["valid"]["collapsed_faces"], 0, "{name}: {certificate}");
        assert!(certificate["bound"]["at_most"].as_f64().unwrap() <= 0.01, "{name}: {certificate}");
    }
    assert!(!std::fs::read_to_string(folder.path("out.obj")).unwrap().to_lowercase().contains("nan"));
}

#[test]
fn reads_stdin_and_writes_stdout() {
    let folder = Folder::new("stdio");
    let input = folder.file("a.bpt", PATCH);
    let output = folder.text("a.ply");
    run(&["mesh", &input, "-o", &output, "--tol", "0.01", "-q"]).succeeds();

    let mut command = chordal(&["mesh", "-", "-o", "-", "--to", "ply", "--tol", "0.01", "-q"]);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(PATCH.as_bytes()).unwrap();
    let piped = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8_lossy(&piped.stderr), "");
    assert_eq!(piped.stdout, std::fs::read(output).unwrap());
}

#[test]
fn a_summary_never_mixes_with_data() {
    let folder = Folder::new("mix");
    let input = folder.file("a.bpt", PATCH);
    let made = run(&["mesh", &input, "-o", "-", "--to", "obj", "--tol", "0.1"]);
    assert_eq!(made.code, 0);
    assert!(made.stdout.contains("\nf ") && !made.stdout.contains("triangles "), "{made:?}");
    assert!(made.stderr.contains("triangles "), "{made:?}");
    run(&["mesh", &input, "-o", "-", "--to", "obj", "--tol", "0.1", "--json"])
        .fails_with(2, &["--json", "stdout"]);
    run(&["mesh", &input, "-o", "-", "--tol", "0.1"]).fails_with(2, &["--to"]);
}

#[test]
fn a_file_above_the_memory_limit_is_refused() {
    let folder = Folder::new("limit");
    let input = folder.file("a.bpt", PATCH);
    run(&["inspect", &input, "--max-memory", "10"]).fails_with(3, &["a.bpt: ", "limit"]);
    let mut command = chordal(&["inspect", "-", "--max-memory", "10"]);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // It may stop reading before all is written.
    let _ = child.stdin.take().unwrap().write_all(PATCH.as_bytes());
    Run::of(child.wait_with_output().unwrap()).fails_with(3, &["stdin: ", "10 bytes"]);
}
