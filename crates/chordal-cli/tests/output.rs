//! Outputs that cannot or should not be written: whatever was there before is still there, and nothing else.
use crate::common;

use common::{CLOSED_OBJ, Folder, PATCH, names, run};
use std::fs;

#[test]
fn h79_an_output_that_exists_needs_force() {
    let folder = Folder::new("h79-exists");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.file("a.obj", "old"));
    let args = ["mesh", &input, "-o", &output, "--tol", "0.1"];
    run(&args).fails_with(4, &["a.obj: ", "--force"]);
    assert_eq!(fs::read(&output).unwrap(), b"old");
    assert_eq!(run(&[&args[..], &["--force"]].concat()).code, 0);
    assert!(fs::read_to_string(&output).unwrap().contains("\nf "));
    assert_eq!(folder.names(), ["a.bpt", "a.obj"]);
}

#[test]
fn h79_the_output_is_never_the_input() {
    let folder = Folder::new("h79-same");
    let input = folder.file("a.obj", CLOSED_OBJ);
    let around = folder.text(&format!("../{}/a.obj", folder.name()));
    for output in [&input, &around] {
        run(&["mesh", &input, "-o", output, "--tol", "0.1", "--force"])
            .fails_with(4, &["the output is the input"]);
    }
    #[cfg(unix)]
    {
        let link = folder.text("link.obj");
        fs::hard_link(&input, &link).unwrap();
        run(&["mesh", &input, "-o", &link, "--tol", "0.1", "--force"])
            .fails_with(4, &["the output is the input"]);
    }
    assert_eq!(fs::read_to_string(&input).unwrap(), CLOSED_OBJ);
}

#[cfg(unix)]
#[test]
fn h79_links_devices_and_folders_are_no_outputs() {
    let folder = Folder::new("h79-link");
    let (input, target) = (folder.file("a.bpt", PATCH), folder.file("target.obj", "old"));
    let [link, dangling] = ["link.obj", "dangling.obj"].map(|name| folder.text(name));
    std::os::unix::fs::symlink(&target, &link).unwrap();
    std::os::unix::fs::symlink(folder.text("nowhere"), &dangling).unwrap();
    for output in [&link, &dangling] {
        run(&["mesh", &input, "-o", output, "--tol", "0.1", "--force"]).fails_with(4, &["symbolic link"]);
    }
    for output in ["/dev/full", "/dev/null"] {
        run(&["mesh", &input, "-o", output, "--to", "obj", "--tol", "0.1", "--force"])
            .fails_with(4, &[output, "device"]);
    }
    run(&["mesh", &input, "-o", &folder.text(""), "--to", "obj", "--tol", "0.1", "--force"])
        .fails_with(4, &["folder"]);
    assert_eq!(fs::read(&target).unwrap(), b"old");
    assert_eq!(folder.names(), ["a.bpt", "dangling.obj", "link.obj", "target.obj"]);
}

#[test]
fn h79_a_folder_that_cannot_be_written_is_known_before_the_work() {
    let folder = Folder::new("h79-folder");
    let input = folder.file("a.bpt", PATCH);
    let missing = folder.text("no/such/folder/a.obj");
    // The tolerance would need more triangles than there may be: the folder is asked first.
    run(&["mesh", &input, "-o", &missing, "--tol", "1e-12"])
        .fails_with(4, &["a.obj: ", "no such file or directory"]);
    let under_a_file = folder.text("a.bpt/a.obj");
    run(&["mesh", &input, "-o", &under_a_file, "--tol", "0.1"]).fails_with(4, &["a.obj: "]);
    #[cfg(target_os = "linux")]
    run(&["mesh", &input, "-o", "/proc/a.obj", "--tol", "0.1"]).fails_with(4, &["/proc/a.obj: "]);
    assert_eq!(folder.names(), ["a.bpt"]);
}

/// A disk that is full, as far as a process without rights can have one: a limit on the size of files.
#[cfg(unix)]
#[test]
fn h79_a_write_that_fails_leaves_the_old_file_and_no_other() {
    let folder = Folder::new("h79-full");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.file("a.obj", "old"));
    // In blocks of 512 bytes or, with some shells, 1,024; the file will have about 200 kB.
    let script = r#"trap '' XFSZ; ulimit -f 8; exec "$0" "$@""#;
    let args = ["mesh", &input, "-o", &output, "--tol", "1e-3", "--force"];
    let made = std::process::Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_chordal")])
        .args(args)
        .output()
        .unwrap();
    common::Run::of(made).fails_with(4, &["a.obj: ", "file too large"]);
    assert_eq!(fs::read(&output).unwrap(), b"old");
    assert_eq!(folder.names(), ["a.bpt", "a.obj"]);
    // Without the limit the same command works, so it was the limit.
    assert_eq!(run(&args).code, 0);
    assert!(fs::metadata(&output).unwrap().len() > 8 * 1024);
}

#[test]
fn an_output_needs_a_format_that_holds_triangles() {
    let folder = Folder::new("format");
    let input = folder.file("a.bpt", PATCH);
    for output in ["a.docx", "a", "b.bpt"] {
        run(&["mesh", &input, "-o", &folder.text(output), "--tol", "0.1"])
            .fails_with(2, &["obj, ply, stl, glb, gltf, off, 3mf, vtp, usda, usdz"]);
    }
    assert_eq!(folder.names(), ["a.bpt"]);
}

#[test]
fn writes_completions_and_manual_pages() {
    let folder = Folder::new("docs");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let made = run(&["completions", shell]);
        made.succeeds();
        assert!(made.stdout.contains("keep-best"), "{shell}");
    }
    let pages = folder.text("man");
    run(&["man", "-o", &pages]).succeeds();
    let found = names(&folder.path("man"));
    for page in ["chordal.1", "chordal-mesh.1", "chordal-inspect.1", "chordal-render.1"] {
        assert!(found.iter().any(|name| name == page), "{page} in {found:?}");
        assert!(fs::read_to_string(folder.path("man").join(page)).unwrap().starts_with(".ie"), "{page}");
    }
}

#[test]
fn pictures_are_what_their_names_say() {
    let folder = Folder::new("picture-name");
    let input = folder.file("a.obj", CLOSED_OBJ);
    run(&["render", &input, "-o", &folder.text("a.gif")])
        .fails_with(2, &["a.gif", "PNG", ".png", ".jpg", ".webp"]);
    // A mesh has no picture's name.
    run(&["mesh", &input, "--tol", "1", "-o", &folder.text("a.jpg")]).fails_with(2, &["a.jpg", "picture"]);
    assert_eq!(folder.names(), ["a.obj"]);
    for (name, start) in [
        ("a.PNG", &b"\x89PNG\r\n\x1a\n"[..]),
        ("a.jpg", b"\xFF\xD8\xFF\xE0"),
        ("a.JPEG", b"\xFF\xD8\xFF\xE0"),
        ("a.webp", b"RIFF"),
    ] {
        run(&["render", &input, "--size", "8x8", "-o", &folder.text(name)]).succeeds();
        let bytes = fs::read(folder.path(name)).unwrap();
        assert!(bytes.starts_with(start), "{name}");
        // The certificate travels in the file; that of a PNG is packed.
        let text = String::from_utf8_lossy(&bytes);
        assert!(name == "a.PNG" || text.contains("chordal: {"), "{name}");
    }
}

#[test]
fn new_normals_need_no_budget() {
    let folder = Folder::new("normals-alone");
    let (input, output) = (folder.file("a.obj", CLOSED_OBJ), folder.text("b.obj"));
    let made = run(&["mesh", &input, "--normals", "flat", "-o", &output, "--json"]);
    made.succeeds();
    let report = made.report();
    assert_eq!(report["certificate"]["bound"]["at_most"], 0.0);
    let faces = |text: &str| text.lines().filter(|line| line.starts_with("f ")).count();
    assert_eq!(report["certificate"]["output"]["triangles"], faces(CLOSED_OBJ));
    assert!(fs::read_to_string(&output).unwrap().contains("\nvn "));
    run(&["mesh", &input, "--normals", "keep", "-o", &folder.text("c.obj")]).fails_with(2, &["--tol"]);
}

#[cfg(unix)]
#[test]
fn escape_sequences_in_names_do_not_reach_the_terminal() {
    let folder = Folder::new("escape");
    let input = folder.file("a\u{1b}[31m.obj", CLOSED_OBJ);
    for run in [run(&["inspect", &input]), run(&["inspect", &folder.text("none\u{1b}[31m.obj")])] {
        assert!(!run.stdout.contains('\u{1b}') && !run.stderr.contains('\u{1b}'), "{run:?}");
        assert!([&run.stdout, &run.stderr].iter().any(|text| text.contains("u{1b}")), "{run:?}");
    }
}

#[test]
fn large_numbers_are_written_with_an_exponent() {
    let folder = Folder::new("digits");
    let input = folder.file("a.obj", "v 1e-300 0 0\nv 1e300 0 0\nv 0 1e300 0\nf 1 2 3\n");
    let made = run(&["mesh", &input, "--tol", "1%", "-o", &folder.text("b.obj"), "-v"]);
    assert_eq!(made.code, 0, "{made:?}");
    assert!(made.stderr.contains("e300") && !made.stderr.contains("00000000"), "{}", made.stderr);
}
