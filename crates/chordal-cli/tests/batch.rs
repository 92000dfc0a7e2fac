//! `chordal batch`: many files, each by itself, and what is left of a run that was stopped.
use crate::common;

use common::{CLOSED_OBJ, Folder, PATCH, Run, chordal};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// Runs a batch inside a folder, so that names are as a user has them.
fn batch(folder: &Folder, words: &[&str]) -> Run {
    let mut command = chordal(&["batch"]);
    Run::of(command.args(words).current_dir(folder).output().unwrap())
}

/// The lines of the manifest, the last of which may be torn.
fn manifest(folder: &Folder, output: &str) -> Vec<Value> {
    let text = fs::read_to_string(folder.path(output).join("manifest.jsonl")).unwrap_or_default();
    text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}

fn summary(run: &Run) -> [u64; 6] {
    ["files", "met", "unmet", "refused", "failed", "skipped"].map(|name| run.report()[name].as_u64().unwrap())
}

fn sha256(path: impl AsRef<Path>) -> String {
    let output = std::process::Command::new("sha256sum").arg(path.as_ref()).output().unwrap();
    String::from_utf8(output.stdout).unwrap()[..64].to_owned()
}

/// Waits until something holds, or fails.
fn until(what: &str, holds: impl Fn() -> bool) {
    let started = Instant::now();
    while !holds() {
        assert!(started.elapsed() < Duration::from_secs(60), "{what} did not come");
        std::thread::yield_now();
    }
}

#[test]
fn every_file_gets_its_output_and_its_line() {
    let folder = Folder::new("batch-plain");
    fs::create_dir_all(folder.path("in/ä b/c")).unwrap();
    for name in ["in/one.obj", "in/ä b/zwei drei.obj", "in/ä b/c/-x.obj"] {
        folder.file(name, CLOSED_OBJ);
    }
    folder.file("in/notes.txt", "no shape");
    let done = batch(&folder, &["convert", "in/**/*.obj", "-o", "out", "--to", "stl", "--json"]);
    assert_eq!(done.code, 0, "{done:?}");
    assert_eq!(summary(&done), [3, 3, 0, 0, 0, 0]);
    let lines = manifest(&folder, "out");
    assert_eq!(lines.len(), 3);
    for line in &lines {
        let (input, output) = (line["input"].as_str().unwrap(), line["output"].as_str().unwrap());
        assert_eq!(output, input.replace(".obj", ".stl"));
        assert_eq!(line["input_sha256"], sha256(folder.path(input)));
        assert_eq!(line["output_sha256"], sha256(folder.path("out").join(output)));
        assert_eq!(line["words"], serde_json::json!(["convert"]));
        assert_eq!((&line["exit"], &line["error"], &line["bound"]), (&0.into(), &Value::Null, &0.0.into()));
        assert_eq!((&line["triangles_in"], &line["triangles_out"]), (&4.into(), &4.into()));
        // As the verb alone writes it.
        let alone = folder.text("alone.stl");
        common::run(&["convert", &folder.text(input), &alone, "--force", "-q"]).succeeds();
        assert_eq!(sha256(alone), line["output_sha256"].as_str().unwrap());
    }
    // Again: nothing to do. Other words: all of it.
    let again = batch(&folder, &["convert", "in", "-o", "out", "--to", "stl", "--json"]);
    assert_eq!(summary(&again), [3, 0, 0, 0, 0, 3]);
    assert!(again.stderr.contains("unknown extension were skipped (1x)"), "{again:?}");
    assert_eq!(manifest(&folder, "out").len(), 3);
    let other =
        batch(&folder, &["convert", "in/**", "-o", "out", "--to", "stl", "--json", "--", "--up", "z"]);
    assert_eq!((other.code, summary(&other)), (1, [4, 3, 0, 0, 1, 0]));
    // Outputs are no inputs, wherever they are.
    let inside = batch(&folder, &["convert", "in", "-o", "in/out", "--json", "-q"]);
    assert_eq!(summary(&inside), [3, 3, 0, 0, 0, 0]);
    assert_eq!(
        summary(&batch(&folder, &["convert", "in", "-o", "in/out", "--json", "-q"])),
        [3, 0, 0, 0, 0, 3]
    );
    assert!(folder.path("in/out/in/ä b/c/-x.glb").exists());
}

#[test]
fn a_changed_input_or_output_is_done_again_and_no_other_file_is_replaced() {
    let folder = Folder::new("batch-again");
    for name in ["a.obj", "b.obj", "c.obj"] {
        folder.file(name, CLOSED_OBJ);
    }
    let words = ["convert", "*.obj", "-o", "out", "--to", "ply", "--json"];
    fs::create_dir(folder.path("out")).unwrap();
    folder.file("out/c.ply", "mine");
    let first = batch(&folder, &words);
    assert_eq!((first.code, summary(&first)), (1, [3, 2, 0, 0, 1, 0]));
    assert!(first.stderr.contains("--force"), "{first:?}");
    assert_eq!(fs::read(folder.path("out/c.ply")).unwrap(), b"mine");
    folder.file("a.obj", CLOSED_OBJ.replace("v 1 0 0", "v 2 0 0"));
    fs::write(folder.path("out/b.ply"), "damaged").unwrap();
    let second = batch(&folder, &words);
    assert_eq!(summary(&second), [3, 2, 0, 0, 1, 0]);
    let forced = batch(&folder, &[&words[..], &["--force"]].concat());
    assert_eq!((forced.code, summary(&forced)), (0, [3, 1, 0, 0, 0, 2]));
    assert!(
        ["a", "b", "c"]
            .iter()
            .all(|name| fs::metadata(folder.path(&format!("out/{name}.ply"))).unwrap().len() > 99)
    );
    let redone = batch(&folder, &[&words[..], &["--redo"]].concat());
    assert_eq!(summary(&redone), [3, 3, 0, 0, 0, 0]);
    // Not even then is an input its own output.
    let own = batch(&folder, &["mend", "a.obj", "-o", ".", "--force", "--json", "--", "--orient"]);
    assert_eq!(summary(&own), [1, 0, 0, 0, 1, 0]);
    assert!(own.stderr.contains("the output is the input"), "{own:?}");
}

#[test]
fn one_broken_file_stops_nobody_and_the_exit_code_says_so() {
    let folder = Folder::new("batch-broken");
    folder.file("good.obj", CLOSED_OBJ);
    folder.file("patch.bpt", PATCH);
    folder.file("wrong.obj", "v 0 0 0\nf 1 2 3\n");
    folder.file("empty.stl", "");
    let done = batch(&folder, &["mesh", ".", "-o", "out", "--json", "--", "--tol", "0.01"]);
    assert_eq!((done.code, summary(&done)), (1, [4, 2, 0, 0, 2, 0]));
    let lines = manifest(&folder, "out");
    let line = |name: &str| lines.iter().find(|line| line["input"] == name).unwrap();
    assert_eq!((&line("wrong.obj")["exit"], &line("wrong.obj")["output_sha256"]), (&3.into(), &Value::Null));
    assert!(line("wrong.obj")["error"].as_str().unwrap().contains("line 2"), "{lines:?}");
    assert!(line("patch.bpt")["bound"].as_f64().unwrap() <= 0.01);
    assert_eq!(
        common::names(&folder.path("out")),
        [".chordal-batch", "good.glb", "manifest.jsonl", "patch.glb"]
    );
    // A budget that is not met is counted as such, and what --keep-best writes is kept.
    let words = ["mesh", "patch.bpt", "-o", "few", "--json", "--", "--tol", "1e-4", "--triangles", "4"];
    assert_eq!(summary(&batch(&folder, &words)), [1, 0, 1, 0, 0, 0]);
    assert_eq!(common::names(&folder.path("few")), [".chordal-batch", "manifest.jsonl"]);
    let kept = batch(&folder, &[&words[..], &["--keep-best"]].concat());
    assert_eq!((kept.code, summary(&kept)), (1, [1, 0, 1, 0, 0, 0]));
    assert!(folder.path("few/patch.glb").exists());
    // Reports are the output of 'inspect', also where a check fails.
    let reports = batch(&folder, &["inspect", "*.*", "-o", "reports", "--json", "--", "--require", "closed"]);
    assert_eq!((reports.code, summary(&reports)), (1, [4, 1, 0, 0, 3, 0]));
    let names = common::names(&folder.path("reports"));
    assert_eq!(names, [".chordal-batch", "good.json", "manifest.jsonl", "patch.json"]);
}

/// A process for each file takes half a minute for a thousand, so only the long tests take as many.
#[test]
fn h84_of_a_thousand_files_three_are_broken_and_the_report_names_them() {
    let n: u64 = if chordal_testkit::is_long() { 1000 } else { 100 };
    let folder = Folder::new("batch-thousand");
    let broken = [7, n / 2, n - 1];
    for i in 0..n {
        let text = if broken.contains(&i) { "v 0 0 0\nf 1 2 3\n" } else { CLOSED_OBJ };
        folder.file(&format!("{i:04}.obj"), text);
    }
    let done = batch(&folder, &["convert", ".", "-o", "out", "--json", "--to", "stl"]);
    assert_eq!((done.code, summary(&done)), (1, [n, n - 3, 0, 0, 3, 0]), "{done:?}");
    let lines = manifest(&folder, "out");
    assert_eq!(lines.len() as u64, n);
    let mut failed: Vec<&Value> = lines.iter().filter(|line| line["exit"] != 0).collect();
    failed.sort_by_key(|line| line["input"].to_string());
    for (line, i) in failed.iter().zip(broken) {
        assert_eq!((&line["input"], &line["exit"]), (&format!("{i:04}.obj").into(), &3.into()));
        assert!(line["error"].as_str().unwrap().contains("line 2"), "{line}");
    }
    assert_eq!(failed.len(), 3);
    let written = common::names(&folder.path("out")).iter().filter(|name| name.ends_with(".stl")).count();
    assert_eq!(written as u64, n - 3);
}

#[test]
fn a_batch_that_was_killed_goes_on_where_it_was() {
    let folder = Folder::new("batch-kill");
    fs::create_dir(folder.path("in")).unwrap();
    let names: Vec<String> = (0..12).map(|number| format!("{number:02}.bpt")).collect();
    for (number, name) in names.iter().enumerate() {
        // Each a little higher than the one before.
        folder.file(&format!("in/{name}"), PATCH.replace("1 1 2\n", &format!("1 1 {number}\n")));
    }
    let words = ["mesh", "in", "-o", "out", "--jobs", "1", "--json", "--", "--tol", "4e-5"];
    let mut command = chordal(&["batch"]);
    let mut child = command.args(words).current_dir(&folder).spawn().unwrap();
    until("a line", || !manifest(&folder, "out").is_empty());
    child.kill().unwrap();
    child.wait().unwrap();
    // A kill in the middle of a line.
    let path = folder.path("out/manifest.jsonl");
    let done = manifest(&folder, "out");
    assert!(done.len() < names.len(), "the kill came too late");
    let text = fs::read_to_string(&path).unwrap();
    let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
    fs::write(&path, format!("{whole}{}", "{\"input\":\"in/11.bpt\",\"inp")).unwrap();
    // No half file: what stands there is what its line says.
    let mut kept = 0;
    for line in &done {
        let output = folder.path("out").join(line["output"].as_str().unwrap());
        if output.exists() {
            assert_eq!(line["output_sha256"], sha256(&output));
            kept += 1;
        }
    }
    let on_disk = walk(&folder.path("out/in"));
    assert_eq!(on_disk, kept, "an output without a line");
    let resumed = batch(&folder, &words);
    assert_eq!((resumed.code, summary(&resumed)), (0, [12, 12 - kept, 0, 0, 0, kept]));
    let lines = manifest(&folder, "out");
    assert_eq!(lines.len() as u64, done.len() as u64 + 12 - kept, "the torn line is gone");
    // As if nothing had been.
    let whole = batch(&folder, &["mesh", "in", "-o", "other", "--json", "-q", "--", "--tol", "4e-5"]);
    assert_eq!(summary(&whole), [12, 12, 0, 0, 0, 0]);
    for name in &names {
        let name = name.replace("bpt", "glb");
        let [a, b] = ["out/in", "other/in"].map(|at| fs::read(folder.path(at).join(&name)).unwrap());
        assert!(a == b, "{name}");
    }
}

fn walk(folder: &Path) -> u64 {
    if folder.exists() { common::names(folder).len() as u64 } else { 0 }
}

/// A verb that takes long: distances at some ten million points, on one thread.
#[cfg(unix)]
const LONG: [&str; 4] = ["--cells", "250", "--threads", "1"];

/// Starts a batch that takes long, and waits until it holds its folder.
#[cfg(unix)]
fn start_long(folder: &Folder) -> std::process::Child {
    folder.file("long.obj", CLOSED_OBJ);
    let mut command = chordal(&["batch", "bake", "long.obj", "-o", "out", "--"]);
    let child = command
        .args(LONG)
        .current_dir(folder)
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    until("the manifest", || folder.path("out/manifest.jsonl").exists());
    child
}

/// The processes that one has started, by what Linux says of all.
#[cfg(unix)]
fn children_of(parent: u32) -> Vec<String> {
    let all = fs::read_dir("/proc").into_iter().flatten().flatten();
    let is_child = |path: &Path| {
        let stat = fs::read_to_string(path.join("stat")).unwrap_or_default();
        // The name of the program, in brackets, may hold anything; state and parent come after it.
        let after = stat.rsplit_once(')').map_or("", |parts| parts.1);
        after.split_whitespace().nth(1).is_some_and(|pid| pid.parse() == Ok(parent))
    };
    all.filter(|entry| is_child(&entry.path()))
        .filter_map(|entry| entry.file_name().into_string().ok())
        .collect()
}

#[cfg(unix)]
#[test]
fn a_second_batch_in_the_folder_is_refused_and_a_signal_stops_the_first_with_its_processes() {
    let folder = Folder::new("batch-lock");
    let first = start_long(&folder);
    batch(&folder, &["bake", "long.obj", "-o", "out", "--", "--cells", "4"])
        .fails_with(4, &["out: another batch is using this folder"]);
    // Where the system does not show its processes in files, nothing is seen of them here.
    if Path::new("/proc/self/stat").exists() {
        until("the process", || !children_of(first.id()).is_empty());
    }
    let children = children_of(first.id());
    let killed =
        std::process::Command::new("kill").args(["-TERM", &first.id().to_string()]).status().unwrap();
    assert!(killed.success());
    let ended = Run::of(first.wait_with_output().unwrap());
    assert_eq!((ended.code, ended.stderr.as_str()), (130, "chordal: interrupted\n"));
    for child in children {
        assert!(!Path::new("/proc").join(child).exists(), "a process goes on");
    }
    assert_eq!(common::names(&folder.path("out/.chordal-batch")), ["lock"]);
    assert_eq!(manifest(&folder, "out").len(), 0);
    // The lock went with the process.
    let next = batch(&folder, &["bake", "long.obj", "-o", "out", "--json", "--", "--cells", "4"]);
    assert_eq!(summary(&next), [1, 1, 0, 0, 0, 0]);
}

#[cfg(unix)]
#[test]
fn a_file_that_takes_too_long_is_stopped_and_the_others_are_done() {
    let folder = Folder::new("batch-timeout");
    folder.file("a.obj", CLOSED_OBJ);
    let words = ["bake", "a.obj", "-o", "out", "--timeout", "0.2", "--json", "--"];
    let stopped = batch(&folder, &[&words[..], &LONG].concat());
    assert_eq!((stopped.code, summary(&stopped)), (1, [1, 0, 0, 0, 1, 0]));
    let line = &manifest(&folder, "out")[0];
    assert_eq!((&line["exit"], &line["output_sha256"]), (&Value::Null, &Value::Null));
    assert!(line["error"].as_str().unwrap().contains("0.2 s"), "{line}");
    assert!(!folder.path("out/a.nrrd").exists());
}

#[test]
fn two_inputs_of_one_output_are_refused_before_anything_starts() {
    let folder = Folder::new("batch-names");
    fs::create_dir(folder.path("x")).unwrap();
    for name in ["x/a.obj", "x/b.obj"] {
        folder.file(name, CLOSED_OBJ);
    }
    folder.file("x/a.stl", "solid a\nendsolid a\n");
    batch(&folder, &["convert", "x", "-o", "out"])
        .fails_with(2, &["x/a.obj and x/a.stl", "--keep-extension"]);
    assert_eq!(folder.names(), ["x"]);
    let kept = batch(&folder, &["convert", "x/*.obj", "-o", "out", "--keep-extension", "--base", "x", "-q"]);
    assert_eq!(kept.code, 0, "{kept:?}");
    let names = common::names(&folder.path("out"));
    assert_eq!(names, [".chordal-batch", "a.obj.glb", "b.obj.glb", "manifest.jsonl"]);
}

#[test]
fn what_makes_no_sense_is_refused_in_a_sentence_before_anything_starts() {
    let folder = Folder::new("batch-refuse");
    folder.file("a.obj", CLOSED_OBJ);
    let refuses = |words: &[&str], code: i32, parts: &[&str]| batch(&folder, words).fails_with(code, parts);
    refuses(&["convert", "*.ply", "-o", "out"], 3, &["*.ply: no file matches"]);
    refuses(&["convert", "b.obj", "-o", "out"], 3, &["b.obj", "no such file"]);
    refuses(&["convert", "a.obj", "-o", "out", "--to", "bpt"], 2, &["--to bpt", "convert writes"]);
    refuses(&["mend", "a.obj", "-o", "out"], 2, &["--weld"]);
    refuses(&["mesh", "a.obj", "-o", "out", "--", "--tol", "wide"], 2, &["wide"]);
    refuses(&["convert", "a.obj", "-o", "out", "--", "--to", "ply"], 2, &["--to", "before the '--'"]);
    refuses(&["convert", "a.obj", "-o", "out", "--", "more.obj"], 2, &["cannot be used"]);
    refuses(&["mesh", "a.obj", "-o", "out", "--", "--tol", "1", "--watch"], 2, &["--watch"]);
    refuses(&["studio", "a.obj", "-o", "out"], 2, &["studio"]);
    refuses(&["convert", "a.obj", "-o", "a.obj"], 4, &["a.obj"]);
    refuses(&["convert", "a.obj", "-o", "out", "--base", "x"], 2, &["--base x"]);
    // A client of a cluster is Python's.
    refuses(&["convert", "a.obj", "-o", "out", "--dask", "tcp://a:1"], 2, &["--dask", "pip install chordal"]);
    assert_eq!(folder.names(), ["a.obj"]);
}

#[test]
fn a_dry_run_says_what_would_be_done_and_does_nothing() {
    let folder = Folder::new("batch-dry");
    for name in ["a.obj", "b.obj"] {
        folder.file(name, CLOSED_OBJ);
    }
    let dry = batch(&folder, &["convert", "a.obj", "b.obj", "-o", "out", "--dry-run"]);
    dry.succeeds();
    assert_eq!(dry.stdout, "do   a.obj -> out/a.glb\ndo   b.obj -> out/b.glb\n");
    assert_eq!(folder.names(), ["a.obj", "b.obj"]);
    assert_eq!(batch(&folder, &["convert", "b.obj", "-o", "out", "-q"]).code, 0);
    let dry = batch(&folder, &["convert", "*.obj", "-o", "out", "--dry-run"]);
    assert_eq!(dry.stdout, "do   a.obj -> out/a.glb\nskip b.obj -> out/b.glb\n");
}

#[test]
fn the_table_sums_up_what_was_done_now_and_before() {
    let folder = Folder::new("batch-table");
    for name in ["a.obj", "b.obj"] {
        folder.file(name, CLOSED_OBJ);
    }
    let words = ["mend", "*.obj", "-o", "out", "--jobs", "2", "--", "--orient"];
    for skipped in [false, true] {
        let told = batch(&folder, &words);
        told.succeeds();
        for part in ["files       2\n", "triangles   8 -> 8\n", "bound       at most 0\n", "seconds"] {
            assert!(told.stdout.contains(part), "no '{part}' in {}", told.stdout);
        }
        assert_eq!(told.stdout.contains("skipped     2\n"), skipped, "{}", told.stdout);
    }
    assert_eq!(common::names(&folder.path("out")), [".chordal-batch", "a.obj", "b.obj", "manifest.jsonl"]);
}

#[cfg(unix)]
#[test]
fn a_loop_of_links_ends() {
    let folder = Folder::new("batch-links");
    fs::create_dir(folder.path("a")).unwrap();
    folder.file("a/x.obj", CLOSED_OBJ);
    std::os::unix::fs::symlink("..", folder.path("a/up")).unwrap();
    std::os::unix::fs::symlink("nowhere.obj", folder.path("a/gone.obj")).unwrap();
    let done = batch(&folder, &["convert", "**/*.obj", "-o", "out", "--json"]);
    // A link to nothing is an input that cannot be read, and is not passed over.
    assert_eq!((done.code, summary(&done)), (1, [2, 1, 0, 0, 1, 0]));
}

/// An OBJ of a batch has its materials beside it, as outside of one.
#[test]
fn files_beside_an_output_come_along() {
    let folder = Folder::new("batch-beside");
    let painted = include_str!("../../../tests/web/painted.gltf");
    fs::create_dir(folder.path("in")).unwrap();
    folder.file("in/a ball.gltf", painted);
    folder.file("in/another.gltf", painted);
    let words = ["convert", "in", "-o", "out", "--to", "obj", "--base", "in", "--json"];
    let done = batch(&folder, &words);
    assert_eq!((done.code, summary(&done)), (0, [2, 2, 0, 0, 0, 0]), "{done:?}");
    for stem in ["a ball", "another"] {
        let text = fs::read_to_string(folder.path("out").join(format!("{stem}.obj"))).unwrap();
        let library = text.lines().find_map(|line| line.strip_prefix("mtllib ")).expect("a library");
        let library = fs::read_to_string(folder.path("out").join(library)).expect("the library");
        let picture = library.lines().find_map(|line| line.strip_prefix("map_Kd ")).expect("a picture");
        let picture = picture.split_whitespace().last().unwrap();
        assert!(fs::read(folder.path("out").join(picture)).unwrap().starts_with(b"\x89PNG"));
    }
    // Nothing is done again, and nothing is left where processes write.
    assert_eq!(summary(&batch(&folder, &words)), [2, 0, 0, 0, 0, 2]);
    let left: Vec<_> = fs::read_dir(folder.path("out/.chordal-batch")).unwrap().flatten().collect();
    assert!(left.iter().all(|entry| entry.file_name() == "lock"), "{left:?}");
}
