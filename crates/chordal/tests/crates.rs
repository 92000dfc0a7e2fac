//! What the crates of the workspace depend on: each other only downwards, and others only under a licence
//! that `deny.toml` allows.
use crate::gates;

use gates::expect_none;
use serde_json::Value;
use std::process::Command;

/// The crates with their storeys; crates of one storey do not know each other. The Python package carries the
/// command, so it stands above it.
const CRATES: [(&str, u8); 8] = [
    (TESTKIT, 0),
    ("chordal", 1),
    ("chordal-io", 2),
    ("chordal-script", 2),
    ("chordal-verbs", 3),
    ("chordal-cli", 4),
    ("chordal-py", 5),
    ("chordal-wasm", 4),
];

/// What only tests may depend on, and what depends on nothing: it judges the others.
const TESTKIT: &str = "chordal-testkit";

fn storey(name: &str) -> Option<u8> {
    CRATES.iter().find(|row| row.0 == name).map(|row| row.1)
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or("")
}

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("cargo metadata writes a list here")
}

/// The output of a tool that comes with the compiler.
fn output_of(tool: &str, arguments: &[&str]) -> String {
    let output = Command::new(tool).args(arguments).current_dir(gates::root()).output().expect("it runs");
    assert!(output.status.success(), "{tool}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn metadata(arguments: &[&str]) -> Value {
    let all = [&["metadata", "--offline", "--format-version", "1"], arguments].concat();
    serde_json::from_str(&output_of(env!("CARGO"), &all)).expect("cargo metadata writes JSON")
}

/// Every dependency, be it for the build or the tests, that does not lead down, or takes what is for tests to
/// where no test is.
fn upward_dependencies(metadata: &Value) -> Vec<String> {
    let mut complaints = Vec::new();
    for package in list(&metadata["packages"]) {
        let name = text(&package["name"]);
        let Some(own) = storey(name) else {
            complaints.push(format!("crate {name} has no place in the picture"));
            continue;
        };
        for dependency in list(&package["dependencies"]) {
            let other = text(&dependency["name"]);
            let ours = other == "chordal" || other.starts_with("chordal-");
            if name == TESTKIT {
                complaints.push(format!("crate {name} depends on {other}; what judges depends on nothing"));
            } else if other == TESTKIT && text(&dependency["kind"]) != "dev" {
                complaints.push(format!("crate {name} depends on {other} outside its tests"));
            } else if ours && storey(other).is_none_or(|theirs| theirs >= own) {
                complaints.push(format!("crate {name} depends on {other}; dependencies only go down"));
            }
        }
    }
    complaints
}

/// The texts in `allow = [ … ]` of deny.toml.
fn allowed_licences(deny: &str) -> Vec<&str> {
    let list =
        deny.split_once("allow = [").and_then(|parts| parts.1.split_once(']')).expect("an allow list").0;
    list.split('"').skip(1).step_by(2).collect()
}

/// Whether an SPDX expression (or the older `A/B`) can be met with the allowed licences alone: one side of
/// every `OR`, both sides of every `AND`.
fn is_met(expression: &str, allowed: &[&str]) -> bool {
    let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let (met, end) = either(&words, 0, allowed);
    met && end == words.len()
}

fn either(words: &[&str], at: usize, allowed: &[&str]) -> (bool, usize) {
    let (mut met, mut at) = both(words, at, allowed);
    while words.get(at) == Some(&"OR") {
        let (more, end) = both(words, at + 1, allowed);
        (met, at) = (met | more, end);
    }
    (met, at)
}

fn both(words: &[&str], at: usize, allowed: &[&str]) -> (bool, usize) {
    let (mut met, mut at) = one(words, at, allowed);
    while words.get(at) == Some(&"AND") {
        let (more, end) = one(words, at + 1, allowed);
        (met, at) = (met & more, end);
    }
    (met, at)
}

fn one(words: &[&str], at: usize, allowed: &[&str]) -> (bool, usize) {
    match words.get(at..) {
        Some(["(", ..]) => {
            let (met, end) = either(words, at + 1, allowed);
            (met && words.get(end) == Some(&")"), end + 1)
        }
        Some([name, "WITH", exception, ..]) => {
            (allowed.contains(&format!("{name} WITH {exception}").as_str()), at + 3)
        }
        Some([name, ..]) => (allowed.contains(name), at + 1),
        _ => (false, at),
    }
}

/// Every package whose licence cannot be met.
fn refused_licences(metadata: &Value, allowed: &[&str]) -> Vec<String> {
    list(&metadata["packages"])
        .iter()
        .filter(|package| !is_met(text(&package["license"]), allowed))
        .map(|package| {
            format!("{}: licence {} is not in deny.toml", text(&package["name"]), package["license"])
        })
        .collect()
}

#[test]
fn crates_depend_only_downwards() {
    expect_none(&upward_dependencies(&metadata(&["--no-deps"])));
}

#[test]
fn every_dependency_has_an_allowed_licence() {
    let version = output_of("rustc", &["-vV"]);
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).expect("rustc names its host");
    let metadata = metadata(&["--locked", "--filter-platform", host]);
    assert!(list(&metadata["packages"]).len() > 20, "the dependencies are there");
    let deny = std::fs::read_to_string(gates::root().join("deny.toml")).expect("deny.toml is there");
    expect_none(&refused_licences(&metadata, &allowed_licences(&deny)));
}

/// The crates that a package depends on by a lock file, where the package is in it.
fn locked_dependencies<'a>(lock: &'a str, name: &str) -> Option<Vec<&'a str>> {
    let head = format!("name = \"{name}\"\n");
    let package = lock.split("[[package]]\n").find(|package| package.starts_with(&head))?;
    let entries = package.split_once("dependencies = [").map_or("", |(_, rest)| rest);
    let words = entries.lines().map(|line| line.trim().trim_matches(['"', ',']));
    Some(words.filter_map(|entry| entry.split(' ').next()).collect())
}

/// Every dependency of a crate that a lock file has the crate without.
fn unlocked_dependencies(metadata: &Value, lock: &str) -> Vec<String> {
    let mut complaints = Vec::new();
    for package in list(&metadata["packages"]) {
        let name = text(&package["name"]);
        let Some(locked) = locked_dependencies(lock, name) else { continue };
        for dependency in list(&package["dependencies"]) {
            let is_always = dependency["kind"].is_null()
                && dependency["optional"] == false
                && dependency["target"].is_null();
            let other = text(&dependency["name"]);
            if is_always && !locked.contains(&other) {
                complaints.push(format!("bench/Cargo.lock: {name} without {other}"));
            }
        }
    }
    complaints
}

#[test]
fn the_benches_lock_what_the_crates_depend_on() {
    let lock = std::fs::read_to_string(gates::root().join("bench/Cargo.lock")).expect("the benches have one");
    let metadata = metadata(&["--no-deps"]);
    expect_none(&unlocked_dependencies(&metadata, &lock));
    assert!(!unlocked_dependencies(&metadata, &lock.replace("\"read-fonts\",", "")).is_empty());
}

#[test]
fn a_crate_that_depends_upwards_is_found() {
    let metadata = |name: &str, on: &str| serde_json::json!({"packages": [{"name": name, "dependencies": [{"name": on, "kind": "dev"}]}]});
    for (name, on) in [
        ("chordal", "chordal-io"),
        ("chordal-io", "chordal-verbs"),
        ("chordal-io", "chordal-script"),
        ("chordal-wasm", "chordal-cli"),
        ("chordal-verbs", "chordal-unheard-of"),
        ("chordal-testkit", "chordal"),
        ("chordal-testkit", "libm"),
        ("another", "serde"),
    ] {
        assert_eq!(upward_dependencies(&metadata(name, on)).len(), 1, "{name} on {on}");
    }
    assert!(upward_dependencies(&metadata("chordal-cli", "chordal")).is_empty());
    assert!(upward_dependencies(&metadata("chordal", "libm")).is_empty());
    assert!(upward_dependencies(&metadata("chordal", "chordal-testkit")).is_empty());
    let mut outside_tests = metadata("chordal", "chordal-testkit");
    outside_tests["packages"][0]["dependencies"][0]["kind"] = Value::Null;
    assert_eq!(upward_dependencies(&outside_tests).len(), 1);
}

#[test]
fn a_licence_that_is_not_allowed_is_found() {
    let allowed =
        allowed_licences("allow = [\n  \"MIT\",\n  \"Apache-2.0\", \"Apache-2.0 WITH LLVM-exception\"\n]\n");
    for good in [
        "MIT",
        "MIT OR GPL-3.0",
        "GPL-3.0/MIT",
        "(MIT OR LGPL-2.1) AND Apache-2.0",
        "Apache-2.0 WITH LLVM-exception",
    ] {
        assert!(is_met(good, &allowed), "{good}");
    }
    for bad in [
        "",
        "MPL-2.0",
        "MIT AND GPL-3.0",
        "(MIT OR MPL-2.0) AND GPL-3.0",
        "GPL-3.0 OR MIT AND LGPL-2.1",
        "MIT WITH unheard-of",
        "MIT GPL-3.0",
        "(MIT",
    ] {
        assert!(!is_met(bad, &allowed), "{bad}");
    }
    let metadata = serde_json::json!({"packages": [{"name": "a", "license": "MPL-2.0"}, {"name": "b", "license": null}]});
    assert_eq!(refused_licences(&metadata, &allowed).len(), 2);
}
