//! No option of the command is spelled below the front ends: sentences hold a `Setting`, and a front end spells it.
use crate::gates;

use gates::lines::Lines;
use gates::{Kind, Source, expect_none, sources};

/// The crates below the front ends.
const BELOW: [&str; 4] = ["chordal", "chordal-io", "chordal-verbs", "chordal-script"];

/// Whether a text spells an option, or begins one: two hyphens before a letter, a placeholder or the end of a
/// literal. More hyphens are rules of tables, and those after `<!` open a comment of XML.
fn spells_option(text: &str) -> bool {
    text.match_indices("--").any(|(at, hyphens)| {
        let before = text[..at].chars().next_back();
        let after = text[at + hyphens.len()..].chars().next();
        let begins = after.is_some_and(|c| c.is_ascii_lowercase() || c == '{' || c == '"');
        begins && !before.is_some_and(|c| c == '-' || c == '!')
    })
}

/// Every literal and every comment of a file that spells an option.
fn spelled_options(source: &Source) -> Vec<String> {
    let literals = source.tokens.iter().filter(|token| token.kind == Kind::Literal);
    let lines = Lines::new(source);
    let plain = lines.comments.iter().filter(|(_, comment)| !comment.is_doc());
    let texts = literals.map(|token| (token.line, token.text.as_str()));
    texts
        .chain(plain.map(|(line, comment)| (*line, comment.text.as_str())))
        .filter(|(_, text)| spells_option(text))
        .map(|(line, _)| source.complain(line, "an option is spelled here; front ends spell a `Setting`"))
        .collect()
}

#[test]
fn options_are_spelled_by_shells_alone() {
    let below = BELOW.map(|name| sources(&format!("crates/{name}/src")));
    assert!(below.iter().all(|sources| !sources.is_empty()), "the crates are found");
    let complaints: Vec<String> = below.into_iter().flatten().flat_map(spelled_options).collect();
    expect_none(&complaints);
}

#[test]
fn spelled_options_are_found() {
    for text in [
        "const A: &str = \"give --unit, or none\";",
        "const A: &str = \"--lenient skips them\";",
        "const A: &str = \"one,\\n    --open leaves it\";",
        "fn f(name: &str) -> String { format!(\"--{name}\") }",
        "fn f(name: &str) -> String { [\"--\", name].concat() }",
        "fn f() { log!(r#\"the limit (--max-memory)\"#); }",
        "/// As `--view` takes it.\nfn f() {}",
        "fn f() {} // what --view takes",
        "#[cfg(test)]\nmod tests { fn f() { g(\"--iso\"); } }",
    ] {
        let source = Source::new("crates/chordal-io/src/x.rs", &format!("//! Title.\n{text}\n"));
        assert_eq!(spelled_options(&source).len(), 1, "{text}");
    }
    let title = Source::new("crates/chordal-io/src/x.rs", "//! What --from takes.\n");
    assert_eq!(spelled_options(&title).len(), 1);
}

#[test]
fn other_hyphens_are_left_alone() {
    for text in [
        "/// | a | b |\n/// |---|---|\n/// | 1 | 2 |\nfn f() {}",
        "fn f(text: &str) -> String { text.replace(\"<!--\", \" \").replace(\"-->\", \" \") }",
        "const A: [&str; 3] = [\"--1\", \"fill-holes\", \"a - b\"];",
        "// -------- a rule\nfn f(x: i32) -> i32 { 1 - -x }",
    ] {
        let source = Source::new("crates/chordal-io/src/x.rs", &format!("//! Title.\n{text}\n"));
        expect_none(&spelled_options(&source));
    }
}
