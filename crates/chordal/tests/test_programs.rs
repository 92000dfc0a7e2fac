//! Every file in the `tests` folder of a crate is part of a test program. Cargo does not look for them by
//! itself (`autotests = false`), so a file that no program names would never run.
use crate::gates::{self, Source, expect_none};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The modules that a file declares without a body: the name, and the text of a `#[path]` before it.
fn declared(source: &Source) -> Vec<(String, Option<String>)> {
    let tokens = &source.tokens;
    let is = |at: usize, text: &str| tokens.get(at).is_some_and(|token| token.is(text));
    let (mut found, mut path) = (Vec::new(), None);
    for at in 0..tokens.len() {
        if is(at, "path") && is(at + 1, "=") {
            path = tokens.get(at + 2).map(|literal| literal.text.trim_matches('"').to_owned());
        }
        if is(at, "mod") && is(at + 2, ";") {
            found.push((tokens[at + 1].text.clone(), path.take()));
        }
    }
    found
}

/// The folder in which the modules of a file lie: its own for a root, a `mod.rs` and a file that is named by
/// `#[path]`, else the one of its name.
fn folder_of(file: &Path, is_root: bool) -> PathBuf {
    if is_root || file.ends_with("mod.rs") { file.with_file_name("") } else { file.with_extension("") }
}

/// A path without `x/..`.
fn plain(path: &Path) -> PathBuf {
    let mut parts = PathBuf::new();
    for part in path.components() {
        if part == std::path::Component::ParentDir { _ = parts.pop() } else { parts.push(part) }
    }
    parts
}

/// Every file that a program with this root is compiled from. `read` gives the text of a file that is there.
fn reached(root: &Path, read: &dyn Fn(&Path) -> Option<String>) -> BTreeSet<PathBuf> {
    let (mut open, mut found) = (vec![(root.to_owned(), true)], BTreeSet::new());
    while let Some((file, is_root)) = open.pop() {
        let Some(text) = read(&file) else { continue };
        for (name, path) in declared(&Source::new(&file.to_string_lossy(), &text)) {
            let folder = folder_of(&file, is_root);
            open.extend(match path {
                Some(path) => vec![(plain(&file.with_file_name("").join(path)), true)],
                None => vec![
                    (folder.join(format!("{name}.rs")), false),
                    (folder.join(&name).join("mod.rs"), false),
                ],
            });
        }
        found.insert(file);
    }
    found
}

/// The paths in the `[[test]]` tables of a manifest.
fn roots(manifest: &str) -> Vec<&str> {
    let tables = manifest.split("[[test]]").skip(1);
    tables.filter_map(|table| table.split("path = \"").nth(1)?.split('"').next()).collect()
}

#[test]
fn every_file_of_the_tests_is_in_a_program() {
    let read = |file: &Path| std::fs::read_to_string(file).ok();
    let (mut complaints, mut n_files) = (Vec::new(), 0);
    for manifest in gates::files("crates", |name| name == "Cargo.toml") {
        let text = read(&manifest).expect("a manifest is readable");
        if !text.contains("autotests = false") {
            continue;
        }
        let crate_folder = manifest.with_file_name("");
        let programs = roots(&text).into_iter().map(|root| reached(&crate_folder.join(root), &read));
        let all: BTreeSet<PathBuf> = programs.flatten().collect();
        for file in gates::files(&gates::relative(&crate_folder.join("tests")), |name| name.ends_with(".rs"))
        {
            n_files += 1;
            if !all.contains(&file) {
                complaints.push(format!("{}: no `mod` in a test program names it", gates::relative(&file)));
            }
        }
    }
    assert!(n_files > 100, "the tests are there");
    expect_none(&complaints);
}

#[test]
fn files_are_found_through_modules() {
    let read = |file: &Path| {
        let text = match file.to_str()? {
            "t/all.rs" => "mod a; pub mod b; #[path = \"../x/d.rs\"] mod c; mod inline { }",
            "t/a.rs" => "mod e;",
            "t/b/mod.rs" => "mod f;",
            "t/a/e.rs" | "t/b/f.rs" | "x/g.rs" | "t/left.rs" => "",
            "x/d.rs" => "mod g;",
            _ => return None,
        };
        Some(text.to_owned())
    };
    let found = reached(Path::new("t/all.rs"), &read);
    let expected = ["t/a.rs", "t/a/e.rs", "t/all.rs", "t/b/f.rs", "t/b/mod.rs", "x/d.rs", "x/g.rs"];
    assert_eq!(found, expected.iter().map(PathBuf::from).collect());
    assert_eq!(
        roots("[[test]]\nname = \"a\"\npath = \"t/a.rs\"\n[[test]]\npath = \"b.rs\"\n"),
        ["t/a.rs", "b.rs"]
    );
}
