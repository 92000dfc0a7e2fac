//! Outputs of several files: a folder of tiles, a glTF with files beside it. They are there as a whole or not at
//! all.
use crate::common;

use common::{CLOSED_OBJ, Folder, PATCH, TEAPOT, chordal, names, run};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Stdio};

/// A ball in two materials, one with a texture.
const PAINTED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/web/painted.gltf");

/// The files of a folder by name; none where there is no folder.
fn content(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    if !folder.exists() {
        return BTreeMap::new();
    }
    names(folder).into_iter().map(|name| (name.clone(), fs::read(folder.join(name)).unwrap())).collect()
}

/// Makes a folder hold these files and no others.
fn fill(folder: &Path, files: &BTreeMap<String, Vec<u8>>) {
    let _ = fs::remove_dir_all(folder);
    fs::create_dir(folder).unwrap();
    files.iter().for_each(|(name, bytes)| fs::write(folder.join(name), bytes).unwrap());
}

fn tiles_args<'a>(input: &'a str, output: &'a str, tol: &'a str) -> Vec<&'a str> {
    vec!["lod", input, "-o", output, "--tol", tol, "--tile-triangles", "20", "--force", "-q"]
}

fn start(args: &[&str]) -> Child {
    chordal(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// The files in the folder aside of a running job, as far as there is one.
fn n_aside(folder: &Folder) -> Option<usize> {
    let aside =
        folder.names().into_iter().find(|name| name.starts_with(".chordal-") && name.ends_with(".tmp"))?;
    // It may have its last name by now.
    Some(fs::read_dir(folder.path(&aside)).ok()?.count())
}

/// Waits until so many files stand aside, or the job is over.
fn wait_for(n_files: usize, folder: &Folder, child: &mut Child) {
    while n_aside(folder).is_none_or(|n| n < n_files) && child.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
}

#[cfg(unix)]
#[test]
fn a_kill_at_any_moment_leaves_the_old_folder_or_the_whole_new_one() {
    let folder = Folder::new("folder-kill");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.text("tiles/"));
    let made = |tol: &str| {
        run(&tiles_args(&input, &output, tol)).succeeds();
        content(&folder.path("tiles"))
    };
    let (old, new) = (made("0.02"), made("0.005"));
    assert!(old.len() > 1 && new.len() > old.len() + 10, "{} {}", old.len(), new.len());
    assert!(old.contains_key("tileset.json") && new["tileset.json"] != old["tileset.json"]);
    let n = new.len();
    let (mut hit, mut replaced) = (0, 0);
    let n_kills = if chordal_testkit::is_long() { 10 } else { 5 };
    for k in (0..n_kills).map(|step| step * n / (n_kills - 2)) {
        fill(&folder.path("tiles"), &old);
        let mut child = start(&tiles_args(&input, &output, "0.005"));
        // Beyond the last file: when all are there, and at the end.
        wait_for(k.min(n), &folder, &mut child);
        child.kill().unwrap();
        let was_killed = child.wait().unwrap().code().is_none();
        hit += usize::from(was_killed);
        let found = content(&folder.path("tiles"));
        assert!(found == old || found == new, "after {k} files: neither the old nor the new folder");
        replaced += usize::from(found == new);
        let left: Vec<String> =
            folder.names().into_iter().filter(|name| name != "a.bpt" && name != "tiles").collect();
        assert!(
            left.iter().all(|name| name.starts_with(".chordal-") || name == ".tiles.chordal-lock"),
            "{left:?}"
        );
    }
    assert!(
        2 * hit >= n_kills,
        "{hit} of {n_kills} kills came before the end of a job, of which {replaced} found it done"
    );
    // The job is done again as if nothing had been, and nothing is left of the killed ones.
    assert!(made("0.005") == new);
    assert_eq!(folder.names(), ["a.bpt", "tiles"]);
    // Nor of a folder that was never there.
    let _ = fs::remove_dir_all(folder.path("tiles"));
    let mut child = start(&tiles_args(&input, &output, "0.005"));
    wait_for(3, &folder, &mut child);
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!folder.path("tiles").exists() || content(&folder.path("tiles")) == new);
    assert!(made("0.02") == old);
    assert_eq!(folder.names(), ["a.bpt", "tiles"]);
}

#[cfg(unix)]
#[test]
fn a_signal_while_a_folder_is_written_leaves_nothing_beside_it() {
    let folder = Folder::new("folder-polite");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.text("tiles/"));
    run(&tiles_args(&input, &output, "0.02")).succeeds();
    let old = content(&folder.path("tiles"));
    let mut interrupted = 0;
    for (step, signal) in ["-INT", "-TERM", "-INT", "-TERM", "-INT"].into_iter().enumerate() {
        fill(&folder.path("tiles"), &old);
        let mut child = start(&tiles_args(&input, &output, "0.005"));
        wait_for(4 * step, &folder, &mut child);
        let kill = std::process::Command::new("kill").args([signal, &child.id().to_string()]).status();
        kill.unwrap();
        let done = common::Run::of(child.wait_with_output().unwrap());
        assert!(done.code == 130 || done.code == 0, "{done:?}");
        interrupted += usize::from(done.code == 130);
        assert!(done.code == 0 || content(&folder.path("tiles")) == old);
        assert_eq!(folder.names(), ["a.bpt", "tiles"], "{signal} after {step} steps");
    }
    assert!(interrupted > 0, "no signal came before the end of any job");
}

#[cfg(unix)]
#[test]
fn of_two_jobs_at_once_one_writes_the_folder_and_the_other_says_why_not() {
    let folder = Folder::new("folder-two");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.text("tiles"));
    let made: Vec<_> = ["0.02", "0.005"]
        .map(|tol| {
            run(&tiles_args(&input, &output, tol)).succeeds();
            content(&folder.path("tiles"))
        })
        .into();
    let mut first = start(&tiles_args(&input, &output, "0.005"));
    // The first has the folder from before its work on.
    wait_for(0, &folder, &mut first);
    let second = run(&tiles_args(&input, &output, "0.02"));
    let first = common::Run::of(first.wait_with_output().unwrap());
    first.succeeds();
    if second.code == 0 {
        // The first was done by then.
        assert!(content(&folder.path("tiles")) == made[0]);
    } else {
        second.fails_with(4, &["tiles", "another job is writing this folder"]);
        assert!(content(&folder.path("tiles")) == made[1]);
    }
    // However many there are, the folder is that of one of them.
    let many: Vec<Child> =
        (0..4).map(|k| start(&tiles_args(&input, &output, ["0.02", "0.005"][k % 2]))).collect();
    for child in many {
        let done = common::Run::of(child.wait_with_output().unwrap());
        assert!(done.code == 0 || done.code == 4, "{done:?}");
    }
    assert!(made.contains(&content(&folder.path("tiles"))));
    assert_eq!(folder.names(), ["a.bpt", "tiles"]);
}

#[test]
fn a_folder_with_anything_else_in_it_is_refused_by_name() {
    let folder = Folder::new("folder-foreign");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.text("tiles/"));
    for foreign in ["notes.txt", "tile_x.glb", "level_.glb", "image_0.exe", "sub/tile_0.glb", ".hidden"] {
        let path = folder.path("tiles").join(foreign);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, "mine").unwrap();
        let name = foreign.split('/').next().unwrap();
        for force in [&["--force"][..], &[]] {
            run(&[&["lod", &input, "-o", &output, "--tol", "0.1"], force].concat()).fails_with(4, &[name]);
        }
        assert_eq!(fs::read(&path).unwrap(), b"mine");
        fs::remove_dir_all(folder.path("tiles")).unwrap();
    }
    // An empty folder is nobody's, and keeps who may read it.
    fs::create_dir(folder.path("tiles")).unwrap();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(folder.path("tiles"), fs::Permissions::from_mode(0o750)).unwrap();
        run(&["lod", &input, "-o", &output, "--tol", "0.1", "-q"]).succeeds();
        run(&["lod", &input, "-o", &output, "--tol", "0.05", "-q", "--force"]).succeeds();
        assert_eq!(fs::metadata(folder.path("tiles")).unwrap().permissions().mode() & 0o777, 0o750);
        std::os::unix::fs::symlink(folder.path("tiles"), folder.path("link")).unwrap();
        run(&["lod", &input, "-o", &folder.text("link/"), "--force"]).fails_with(4, &["symbolic link"]);
        fs::remove_file(folder.path("link")).unwrap();
    }
    run(&["lod", &input, "-o", &folder.text("a.bpt/"), "--force"]).fails_with(4, &["a.bpt", "not a folder"]);
    // The folder that somebody works in cannot be exchanged under their feet.
    let here = folder.path("here");
    fs::create_dir(&here).unwrap();
    for name in [".", "../here", &folder.text("here")] {
        let mut command = chordal(&["lod", &input, "-o", name]);
        let made = common::Run::of(command.current_dir(&here).output().unwrap());
        made.fails_with(4, &["working folder", "inside"]);
    }
    let mut command = chordal(&["lod", &input, "-o", "in/side/", "--tol", "0.1", "-q"]);
    common::Run::of(command.current_dir(&here).output().unwrap()).succeeds();
    assert!(here.join("in/side/tileset.json").is_file());
}

#[test]
fn tiles_of_an_older_run_do_not_stay() {
    let folder = Folder::new("folder-stale");
    let (input, output) = (folder.file("a.bpt", PATCH), folder.text("tiles/"));
    run(&tiles_args(&input, &output, "0.005")).succeeds();
    let before = content(&folder.path("tiles"));
    run(&tiles_args(&input, &output, "0.1")).succeeds();
    let after = content(&folder.path("tiles"));
    assert!(after.len() < before.len());
    let list = String::from_utf8(after["tileset.json"].clone()).unwrap();
    assert!(
        after.keys().all(|name| name == "tileset.json" || list.contains(name.as_str())),
        "{:?}",
        after.keys()
    );
}

#[test]
fn a_picture_of_tiles_stands_once_beside_them() {
    let folder = Folder::new("folder-pictures");
    let output = folder.text("tiles/");
    run(&["lod", PAINTED, "-o", &output, "--tol", "0.5%", "--tile-triangles", "60", "-q"]).succeeds();
    let files = content(&folder.path("tiles"));
    let pictures: Vec<&String> = files.keys().filter(|name| name.starts_with("image_")).collect();
    assert_eq!(pictures, ["image_0.png"]);
    assert!(files["image_0.png"].starts_with(b"\x89PNG"));
    // A tile is read with it, and its certificate names it.
    let inspected = run(&["inspect", &folder.text("tiles/tile_0.glb"), "--json"]);
    inspected.succeeds();
    assert_eq!(inspected.report()["certificate"]["input"]["files"][0]["path"], "image_0.png");
    run(&["lod", PAINTED, "-o", &output, "--tol", "5%", "--force", "-q"]).succeeds();
    // What is read with an input is not replaced either.
    let text = fs::read_to_string(PAINTED).unwrap();
    let mut json: Value = serde_json::from_str(&text).unwrap();
    json["images"][0] = serde_json::json!({ "uri": "tiles/image_0.png", "mimeType": "image/png" });
    let input = folder.file("a.gltf", json.to_string());
    run(&["lod", &input, "-o", &output, "--force"]).fails_with(4, &["tiles", "input"]);
}

/// SHA-256 by a program of the system, where there is one.
fn sha256(path: &Path) -> Option<String> {
    let output = std::process::Command::new("sha256sum").arg(path).output().ok()?;
    String::from_utf8(output.stdout).ok()?.split(' ').next().map(str::to_owned)
}

#[test]
fn a_gltf_with_files_beside_it_comes_as_a_whole_and_reads_back() {
    let folder = Folder::new("separate");
    let verbs: [(&str, &[&str]); 3] =
        [("mesh", &["--tol", "2%"]), ("mend", &["--drop-unused"]), ("lod", &["--tol", "2%"])];
    for (verb, more) in verbs {
        let args = |name: &str, last: &[&str]| {
            let output = folder.text(name);
            run(&[&[verb, PAINTED, "-o", &output, "--json"], more, last].concat())
        };
        let made = args("x.gltf", &["--separate"]);
        made.succeeds();
        assert_eq!(folder.names(), ["x.bin", "x.gltf", "x_image_0.png"], "{verb}");
        let sizes: u64 =
            folder.names().iter().map(|name| fs::metadata(folder.path(name)).unwrap().len()).sum();
        assert_eq!(made.report()["run"]["bytes"], sizes);
        let json: Value = serde_json::from_slice(&fs::read(folder.path("x.gltf")).unwrap()).unwrap();
        assert_eq!(
            (&json["buffers"][0]["uri"], &json["images"][0]["uri"]),
            (&"x.bin".into(), &"x_image_0.png".into())
        );
        // The report of a reader covers every file, in the order in which they are read.
        let read = run(&["inspect", &folder.text("x.gltf"), "--json"]);
        // Of levels it says that it looks at the first alone.
        assert!(read.code == 0 && (verb == "lod" || read.stderr.is_empty()), "{read:?}");
        let files = read.report()["certificate"]["input"]["files"].clone();
        for (k, name) in ["x.bin", "x_image_0.png"].into_iter().enumerate() {
            assert_eq!(files[k]["path"], name);
            if let Some(sum) = sha256(&folder.path(name)) {
                assert_eq!(files[k]["sha256"], sum);
            }
        }
        assert_eq!(files.as_array().unwrap().len(), 2);
        // The same in one file says the same.
        let alone = args("y.gltf", &[]);
        alone.succeeds();
        assert_eq!(alone.report()["certificate"], made.report()["certificate"], "{verb}");
        let inspected = run(&["inspect", &folder.text("y.gltf"), "--json"]);
        assert_eq!(inspected.report()["certificate"]["output"], read.report()["certificate"]["output"]);
        assert_eq!(inspected.report()["certificate"]["input"].get("files"), None);
        fs::remove_file(folder.path("y.gltf")).unwrap();
        // One of them that is there keeps all from being written.
        for (gone, there) in [("x.gltf", "x.bin"), ("x.bin", "x_image_0.png")] {
            fs::remove_file(folder.path(gone)).unwrap();
            let before = content(folder.as_ref());
            args("x.gltf", &["--separate", "-q"]).fails_with(4, &[there, "--force"]);
            assert!(content(folder.as_ref()) == before);
        }
        args("x.gltf", &["--separate", "--force", "-q"]).succeeds();
        for name in folder.names() {
            fs::remove_file(folder.path(&name)).unwrap();
        }
    }
}

#[test]
fn compressed_files_are_smaller_and_hold_the_same() {
    let folder = Folder::new("compressed");
    let (plain, packed) = (folder.text("plain.glb"), folder.text("packed.glb"));
    run(&["mesh", TEAPOT, "--tol", "0.01", "-o", &plain, "-q"]).succeeds();
    run(&["mesh", TEAPOT, "--tol", "0.01", "--compress", "meshopt", "-o", &packed, "-q"]).succeeds();
    let size = |path: &str| std::fs::metadata(path).expect("there").len();
    assert!(size(&packed) < size(&plain) * 3 / 4, "{} of {}", size(&packed), size(&plain));
    let output = |path: &str| run(&["inspect", path, "--json"]).report()["certificate"]["output"].clone();
    assert_eq!(output(&packed)["triangles"], output(&plain)["triangles"]);
    let apart = run(&["deviation", &packed, &plain, "--json"]);
    assert_eq!(apart.code, 0, "{apart:?}");
    run(&["convert", &plain, &folder.text("b.ply"), "--compress", "meshopt"])
        .fails_with(2, &["--compress", ".glb", "ply"]);
}

#[test]
fn several_files_are_for_formats_and_places_that_have_them() {
    let folder = Folder::new("separate-usage");
    let input = folder.file("a.obj", CLOSED_OBJ);
    let mesh = |output: &str, more: &[&str]| {
        run(&[&["mesh", &input, "--tol", "0.1", "--separate", "-o", output][..], more].concat())
    };
    mesh(&folder.text("b.glb"), &[]).fails_with(2, &["--separate", ".gltf", "glb"]);
    mesh("-", &["--to", "gltf"]).fails_with(2, &["--separate", "stdout"]);
    mesh(&folder.text("b.bin"), &["--to", "gltf"]).fails_with(2, &["b.bin", "buffer"]);
    run(&["lod", &input, "-o", &folder.text("t/"), "--separate"]).fails_with(2, &["--separate", "tiles"]);
    assert_eq!(folder.names(), ["a.obj"]);
    // To stdout, all is in the text.
    let made = run(&["mesh", &input, "--tol", "0.1", "-o", "-", "--to", "gltf", "-q"]);
    let json: Value = serde_json::from_str(&made.stdout).unwrap();
    assert!(json["buffers"][0]["uri"].as_str().unwrap().starts_with("data:"), "{made:?}");
    // A file that was read is not replaced by one beside the output.
    mesh(&folder.text("x.gltf"), &["-q"]).succeeds();
    fs::rename(folder.path("x.gltf"), folder.path("y.gltf")).unwrap();
    let (from, to) = (folder.text("y.gltf"), folder.text("x.gltf"));
    let again = ["mesh", &from, "--tol", "0.1", "--separate", "--force", "-o", &to];
    run(&again).fails_with(4, &["x.bin", "input"]);
    assert_eq!(folder.names(), ["a.obj", "x.bin", "y.gltf"]);
}

#[test]
fn a_name_of_another_format_than_the_content_is_refused() {
    let folder = Folder::new("other-name");
    let input = folder.file("a.obj", CLOSED_OBJ);
    let stl = folder.text("b.stl");
    run(&["mesh", &input, "--tol", "0.1", "--to", "ply", "-o", &stl])
        .fails_with(2, &["b.stl", "--to", ".ply"]);
    run(&["mend", &input, "--orient", "--to", "ply", "-o", &stl]).fails_with(2, &["b.stl", "--to", ".ply"]);
    let npy = folder.text("b.npy");
    run(&["bake", &input, "--cells", "4", "--to", "nrrd", "-o", &npy]).fails_with(2, &["b.npy", ".nrrd"]);
    run(&["render", &input, "-o", &folder.text("b.gif")]).fails_with(2, &["b.gif"]);
    for (verb, more) in [("mesh", &["--tol", "0.1"][..]), ("bake", &["--cells", "4"]), ("lod", &[])] {
        run(&[&[verb, &input, "-o", &folder.text("b.jpg")], more].concat()).fails_with(2, &["b.jpg"]);
    }
    assert_eq!(folder.names(), ["a.obj"]);
    // A name that says nothing of formats is anybody's.
    run(&["mesh", &input, "--tol", "0.1", "--to", "ply", "-o", &folder.text("b.part"), "-q"]).succeeds();
    run(&["mesh", &input, "--tol", "0.1", "--to", "ply", "-o", &folder.text("b.PLY"), "-q"]).succeeds();
}

#[test]
fn levels_in_a_text_are_those_of_the_binary_file() {
    let folder = Folder::new("levels-text");
    let input = folder.file("a.bpt", PATCH);
    let [glb, gltf] = ["a.glb", "a.gltf"].map(|name| {
        let made = run(&["lod", &input, "-o", &folder.text(name), "--tol", "0.001", "--json"]);
        made.succeeds();
        made.report()["certificate"].clone()
    });
    assert_eq!(glb, gltf);
    let json: Value = serde_json::from_slice(&fs::read(folder.path("a.gltf")).unwrap()).unwrap();
    let levels = gltf["levels"]["levels"].as_array().unwrap().len();
    let nodes = json["nodes"].as_array().unwrap();
    let named = nodes.iter().find_map(|node| node["extensions"]["MSFT_lod"]["ids"].as_array());
    assert_eq!(named.unwrap().len(), levels - 1);
    assert!(json["buffers"][0]["uri"].as_str().unwrap().starts_with("data:"));
}
