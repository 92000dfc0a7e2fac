//! What STYLE.md asks of every file and a machine can see.
use crate::gates;

use gates::lines::{Comment, Lines};
use gates::paths::tree;
use gates::{Kind, Source, expect_none};
use std::path::Path;

/// From this many lines on a file says why it is long.
const LONG_LINES: usize = 600;
/// A file of more lines is refused.
const MOST_LINES: usize = 1000;
/// Words that say where a number comes from, for a comment that is not right beside it.
const ORIGINS: [&str; 7] = ["round", "Round", "last place", "half step", "derived", "measured", "exact"];
/// A number in code that is this small or smaller is taken for a tolerance.
const SMALL: f64 = 1e-4;

/// Where `unsafe` may stand: the SIMD kernels, the glue to other languages, and the handler of a signal.
const UNSAFE: [&str; 5] = [
    "crates/chordal/src/math/simd.rs",
    "crates/chordal/src/math/simd/",
    "crates/chordal-wasm/src/",
    "crates/chordal-py/src/",
    "crates/chordal-cli/src/signal.rs",
];

/// Crates that print nothing and reach for no file, socket or process; that is for front ends.
const SILENT: [&str; 3] = ["crates/chordal/src/", "crates/chordal-io/src/", "crates/chordal-verbs/src/"];

/// Everything that is wrong with a source file.
fn untidy(source: &Source) -> Vec<String> {
    let lines = Lines::new(source);
    let mut found = size_and_title(source, &lines);
    found.extend(unfinished(source, &lines));
    found.extend(commented_out(source, &lines));
    if source.path.contains("/src/") {
        found.extend(bare_epsilons(source, &lines));
        found.extend(misplaced_unsafe(source));
        found.extend(side_effects(source, &lines));
    }
    found
}

fn size_and_title(source: &Source, lines: &Lines) -> Vec<String> {
    let mut found = Vec::new();
    if !source.text.starts_with("//! ") {
        found.push(source.complain(1, "the first line says what the file is: `//! …`"));
    }
    let length = source.text.lines().count();
    let excused = lines.comments.values().any(|comment| comment.text.contains("Long because "));
    if length > MOST_LINES {
        found.push(source.complain(length, "more than 1000 lines: one noun per file"));
    } else if length > LONG_LINES && !excused {
        found.push(source.complain(length, "more than 600 lines, and no `// Long because …`"));
    }
    found
}

/// `todo!` and its like, tests that do not run, notes to oneself.
fn unfinished(source: &Source, lines: &Lines) -> Vec<String> {
    let tokens = &source.tokens;
    let is = |at: usize, text: &str| tokens.get(at).is_some_and(|token| token.is(text));
    let mut found = Vec::new();
    let mut complain = |line, what: &str| found.push(source.complain(line, what));
    let mut attribute_end = 0;
    for (at, token) in tokens.iter().enumerate() {
        if ["todo", "unimplemented", "dbg"].iter().any(|word| is(at, word)) && is(at + 1, "!") {
            complain(token.line, &format!("`{}!` is left", token.text));
        }
        if is(at, "#") && (is(at + 1, "[") || is(at + 2, "[")) {
            let depth = tokens[at..].iter().scan(0_i32, |depth, token| {
                *depth += i32::from(token.is("[")) - i32::from(token.is("]"));
                Some((*depth, token.is("]")))
            });
            let end = depth.skip(1).position(|(depth, closes)| depth == 0 && closes);
            attribute_end = at + end.map_or(0, |end| end + 1);
        }
        if at < attribute_end && is(at, "ignore") {
            complain(token.line, "a test is ignored");
        }
    }
    for (line, comment) in &lines.comments {
        let text = &comment.text;
        let words = || text.split(|c: char| !c.is_ascii_alphanumeric());
        if words().any(|word| ["TODO", "FIXME", "XXX", "HACK"].contains(&word)) {
            complain(*line, "a note to oneself is left; do it, or say it where users read it");
        }
        if comment.is_doc() && text.contains("```") && words().any(|word| word == "ignore") {
            complain(*line, "an example is ignored");
        }
        if text.starts_with("/*") {
            complain(*line, "comments are written with `//`");
        }
    }
    found
}

/// Comments that would compile: single lines that end in `;` or `{`, lone brackets, and blocks of several
/// lines.
fn commented_out(source: &Source, lines: &Lines) -> Vec<String> {
    let plain = |comment: &Comment| !comment.is_doc() && comment.text.starts_with("//");
    let body = |comment: &Comment| comment.text.trim_start_matches('/').trim().to_owned();
    let mut found = Vec::new();
    let mut block: Vec<(usize, String)> = Vec::new();
    let mut finish = |block: &mut Vec<(usize, String)>| {
        let joined: Vec<&str> = block.iter().map(|(_, text)| text.as_str()).collect();
        let whole = block.len() > 1 && is_code(&joined.join("\n"));
        let hit = block.iter().find(|(_, text)| whole || is_code(text));
        found.extend(hit.map(|(line, _)| source.complain(*line, "commented-out code")));
        block.clear();
    };
    for (line, comment) in &lines.comments {
        let follows = block.last().is_some_and(|(last, _)| last + 1 == *line) && comment.alone;
        if !follows {
            finish(&mut block);
        }
        if plain(comment) {
            block.push((*line, body(comment)));
        }
    }
    finish(&mut block);
    found
}

fn is_code(text: &str) -> bool {
    let compiles = |text: &str| syn::parse_str::<syn::Block>(&format!("{{ {text} }}")).is_ok();
    match text.chars().last() {
        Some(';') => compiles(text),
        // A line that opens a block is closed first, and given back the `if` or `match` that it was cut from.
        Some('{') => {
            let (loose, closed) = (text.trim_start_matches('}').trim(), format!("{text} }}"));
            compiles(&closed)
                || (loose.starts_with("else") && compiles(&format!("if x {{}} {loose} }}")))
                || compiles(&format!("match x {{ {closed} }}"))
        }
        Some('}') => text == "}" || (text.contains(';') && compiles(text)),
        _ => ["});", "})", ");", "},"].contains(&text),
    }
}

/// Small numbers and `EPSILON` without a word on where they come from: a comment right beside them, or one in
/// the same function that speaks of rounding, measuring or deriving. Tests are free to choose theirs.
fn bare_epsilons(source: &Source, lines: &Lines) -> Vec<String> {
    let small = |text: &str| {
        let digits = text.replace('_', "");
        let number = digits.trim_end_matches("f64").trim_end_matches("f32");
        number.parse::<f64>().is_ok_and(|value| value > 0.0 && value <= SMALL)
    };
    let explained = |at: usize| {
        let function = lines.comments_of_function(at);
        !lines.comment_on(at).is_empty() || ORIGINS.iter().any(|word| function.contains(word))
    };
    let tokens = source.tokens.iter().enumerate();
    tokens
        .filter(|(_, token)| (token.kind == Kind::Literal && small(&token.text)) || token.is("EPSILON"))
        .filter(|(at, _)| !lines.is_test(*at) && !explained(*at))
        .map(|(_, token)| {
            let text = &token.text;
            source.complain(token.line, &format!("`{text}`: say beside it where the number comes from"))
        })
        .collect()
}

fn misplaced_unsafe(source: &Source) -> Vec<String> {
    if UNSAFE.iter().any(|place| source.path.starts_with(place)) {
        return Vec::new();
    }
    let tokens = source.tokens.iter().filter(|token| token.is("unsafe"));
    tokens
        .map(|token| source.complain(token.line, "`unsafe` stands only in math/simd, FFI glue and signal.rs"))
        .collect()
}

/// Printing, files, sockets and processes where the library must not reach for them.
fn side_effects(source: &Source, lines: &Lines) -> Vec<String> {
    if !SILENT.iter().any(|place| source.path.starts_with(place)) {
        return Vec::new();
    }
    let tokens = &source.tokens;
    let is = |at: usize, text: &str| tokens.get(at).is_some_and(|token| token.is(text));
    let mut found = Vec::new();
    for (at, token) in tokens.iter().enumerate().filter(|(at, _)| !lines.is_test(*at)) {
        let prints =
            ["println", "eprintln", "print", "eprint"].iter().any(|word| is(at, word)) && is(at + 1, "!");
        let stream = ["stdout", "stderr", "stdin"].iter().any(|word| is(at, word)) && is(at + 1, "(");
        if prints || stream {
            found.push(source.complain(token.line, "library code prints nothing and reads no terminal"));
        }
        if is(at, "std") {
            let leaves = tree(tokens, at, &[]).0;
            // A process may ask which one it is.
            let asks_who = |segments: &[String]| segments == ["std", "process", "id"];
            let reaches = leaves.iter().any(|leaf| match leaf.segments.get(1).map(String::as_str) {
                Some("process") if asks_who(&leaf.segments) => false,
                Some("fs" | "net" | "process" | "os") => true,
                Some("*" | "self") => true,
                None => leaf.alias.is_some(),
                Some(_) => false,
            });
            if reaches {
                found.push(source.complain(token.line, "library code opens no file, socket or process"));
            }
        }
    }
    found
}

/// Folders of one machine, written so that this file does not hold them.
const MACHINE: [&str; 5] = [
    concat!("/ro", "ot/"),
    concat!("/ho", "me/"),
    concat!("/tm", "p/"),
    concat!("/Us", "ers/"),
    concat!(r"C:\Us", r"ers\"),
];

/// What follows the first of them in a JSON pointer into a tileset, whose first tile has that name.
const TILE_KEYS: [&str; 7] =
    ["boundingVolume", "children", "content", "geometricError", "implicitTiling", "refine", "transform"];

/// Lines of a text that name a folder of one machine. `~`, `$HOME` and the system's temporary folder by name
/// are the ways to say it.
fn machine_paths(path: &str, text: &str) -> Vec<String> {
    let is_pointer = |rest: &str| TILE_KEYS.iter().any(|key| rest.starts_with(key));
    let names = |line: &str, folder: &str| {
        line.split(folder).skip(1).any(|rest| folder != MACHINE[0] || !is_pointer(rest))
    };
    let named = |line: &str| MACHINE.iter().find(|folder| names(line, folder)).copied();
    text.lines()
        .enumerate()
        .filter_map(|(n, line)| {
            Some(format!("{path}:{}: '{}' is a path of one machine", n + 1, named(line)?))
        })
        .collect()
}

/// Links of a page, `[text](target)`, that lead to no file.
fn dead_links(path: &str, text: &str, exists: &dyn Fn(&Path) -> bool) -> Vec<String> {
    let here = Path::new(path).parent().unwrap_or(Path::new(""));
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|parts| parts.0);
    targets
        .filter(|target| !target.contains("://") && !target.starts_with('#'))
        .map(|target| target.split('#').next().unwrap_or(target))
        .filter(|target| !exists(&here.join(target)))
        .map(|target| format!("{path}: the link to '{target}' leads nowhere"))
        .collect()
}

#[test]
fn every_source_is_tidy() {
    let all: Vec<&Source> =
        ["crates", "bench", "fuzz", "examples"].iter().flat_map(|f| gates::sources(f)).collect();
    assert!(all.len() > 20, "the sources are there");
    expect_none(&all.into_iter().flat_map(untidy).collect::<Vec<_>>());
}

#[test]
fn the_architecture_fits_one_reading() {
    let text =
        std::fs::read_to_string(gates::root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md is there");
    assert!(text.lines().count() <= 150, "ARCHITECTURE.md has {} lines", text.lines().count());
}

#[test]
fn no_text_names_a_folder_of_one_machine() {
    let mut found = Vec::new();
    for file in gates::tracked() {
        let bytes = std::fs::read(&file).expect("a file of the workspace is readable");
        if let Ok(text) = String::from_utf8(bytes) {
            found.extend(machine_paths(&gates::relative(&file), &text));
        }
    }
    expect_none(&found);
}

#[test]
fn every_link_between_pages_leads_somewhere() {
    let root = gates::root();
    let mut found = Vec::new();
    for file in gates::files("", |name| name.ends_with(".md")) {
        let text = std::fs::read_to_string(&file).expect("a page is readable UTF-8");
        found.extend(dead_links(&gates::relative(&file), &text, &|target| root.join(target).exists()));
    }
    expect_none(&found);
}

/// The number of complaints about a file of that text, below its title.
fn complaints(path: &str, text: &str) -> usize {
    untidy(&Source::new(path, &format!("//! Title.\n{text}\n"))).len()
}

const MATH: &str = "crates/chordal/src/math/box3.rs";

#[test]
fn every_kind_of_untidiness_is_found() {
    for text in [
        "fn f() { todo!() }",
        "fn f() { unimplemented!(\"later\") }",
        "fn f() { dbg!(1); }",
        "#[test]\n#[ignore]\nfn t() {}",
        "#[ignore = \"slow\"]\nfn t() {}",
        "#[cfg_attr(debug_assertions, ignore)]\nfn t() {}",
        "// TODO: later",
        "/// FIXME\nfn f() {}",
        "/// ```ignore\n/// let x = 1;\n/// ```\nfn f() {}",
        "/* A block. */",
        "fn f() { g(/* by = */ 1) }",
        "// let x = 1;",
        "fn f() {} // g(x);",
        "// if x > 1 {",
        "// } else {",
        "// Some(x) => {",
        "// for x in 0..1 {",
        "// pub fn f(x: f64) -> f64 {",
        "// use crate::math;",
        "// }",
        "// let x = f(\n//     1,\n// );",
        "// fn f(x: f64) -> f64 {\n//     x\n// }",
        "const X: f64 = 1e-9;",
        "const X: f64 = 0.000_01;",
        "const X: f32 = 1.5E-7_f32;",
        "fn f() { g(1.0,\n\n 1e-4) }",
        "fn f(x: f64) -> bool { x < f64::EPSILON }",
        "/// Whether it is small.\nfn f(x: f64) -> bool {\n    let y = x;\n    y < f64::EPSILON\n}",
        "/// Rounded.\nfn g() {}\nfn f(x: f64) -> bool {\n    let y = x;\n    y < 1e-12\n}",
        "const A: f64 = 1e-9; // Measured on a million curves.\nconst B: f64 = 1e-8;",
        "fn f() { unsafe { g() } }",
        "unsafe fn f() {}",
        "fn f() { println!(\"x\"); }",
        "fn f() { eprint!(\"x\"); }",
        "fn f() { std::io::stdout(); }",
        "use std::fs;",
        "use std::{fmt, fs::File};",
        "use std::{fmt, io::Read, net};",
        "use ::std::net::TcpStream;",
        "use std::*;",
        "use std as s;",
        "use std::{self as s};",
        "fn f() { std::fs::read(x); }",
        "fn f() { std::process::exit(1) }",
    ] {
        assert_eq!(complaints(MATH, text), 1, "{text}");
    }
    let long = "\n".repeat(700);
    assert_eq!(complaints(MATH, &long), 1);
    assert_eq!(complaints(MATH, &"// Long because it is a table.\n".repeat(1100)), 1);
    assert_eq!(complaints("crates/chordal-verbs/src/input/load.rs", "fn f() { println!(); }"), 1);
    assert_eq!(complaints("crates/chordal-cli/src/main.rs", "fn f() { unsafe { g() } }"), 1);
    assert_eq!(untidy(&Source::new(MATH, "use std::fmt;\n")).len(), 1, "a file without a title");
}

#[test]
fn tidy_code_is_left_alone() {
    for text in [
        "/// How to do it later: see `todo`.\nfn f(ignore: bool) -> bool { ignore }",
        "// Prose that ends in a colon; or a semicolon;\n// and goes on {like this}.",
        "// The set {f < 0} is open.\nfn f() {}",
        "// Three roundings per product and sum, two for the difference.",
        "/// ```\n/// let x = 1;\n/// ```\nfn f() {}",
        "const URL: &str = \"http://example.org\"; const S: &str = \"// let x = 1;\";",
        "// Derived: half a unit in the last place.\nconst X: f64 = 1e-16;",
        "const X: f64 = 1e-9; // Measured.",
        "/// Three roundings of half a step.\nfn f(x: f64) -> f64 {\n    let y = 2.0;\n    x * y * f64::EPSILON\n}",
        "// Exact by definition of the units.\nconst UNITS: [f64; 2] = [\n    1e-6,\n    1e-9,\n];",
        "fn f(x: f64) -> f64 { x * 1e-3 + 1e9 + 0.0 }",
        "fn f() { std::io::Error::other(\"x\"); }\nuse std::{fmt, io::{self, Write}};",
        "#[cfg(test)]\nmod tests {\n    fn f() { println!(\"{}\", 1e-9); std::fs::read(\"x\"); }\n}",
        "#[test]\nfn t() { assert!(x < 1e-12); }",
    ] {
        let source = Source::new(MATH, &format!("//! Title.\n{text}\n"));
        expect_none(&untidy(&source));
    }
    assert_eq!(complaints(MATH, &format!("// Long because it is a table.{}", "\n".repeat(700))), 0);
    assert_eq!(complaints("crates/chordal/src/math/simd.rs", "unsafe fn f() {}"), 0);
    assert_eq!(complaints("crates/chordal-cli/src/main.rs", "use std::fs; fn f() { println!(); }"), 0);
    assert_eq!(complaints("crates/chordal/tests/law.rs", "fn f() { assert!(x < 1e-12) }"), 0);
}

#[test]
fn machine_paths_and_dead_links_are_found() {
    for folder in MACHINE {
        assert_eq!(machine_paths("a.md", &format!("see\n{folder}x\n")).len(), 1, "{folder}");
    }
    assert!(machine_paths("a.md", "see ../shared/data, ~/x and /etc/passwd").is_empty());
    let pointer = format!("{}children/0", MACHINE[0]);
    assert!(machine_paths("a.md", &format!("tile {pointer}")).is_empty());
    assert_eq!(machine_paths("a.md", &format!("{pointer} {}child", MACHINE[0])).len(), 1);
    let exists = |path: &Path| path == Path::new("docs/view.md") || path == Path::new("docs/../README.md");
    let page = "[a](view.md) [b](../README.md#top) [c](https://example.org/x) [d](#here)";
    assert!(dead_links("docs/budget.md", page, &exists).is_empty());
    assert_eq!(dead_links("docs/budget.md", "[a](gone.md) ![b](gone.png)", &exists).len(), 2);
}
