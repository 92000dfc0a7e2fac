//! Names of types are unique in their crate and say what the thing is; GLOSSARY.md names what is there.
use crate::gates;

use gates::{Kind, Source, Token, expect_none, files, root, sources};
use std::collections::{BTreeMap, BTreeSet};

/// Names that say a role in a sentence and not a thing.
const ROLES: [&str; 20] = [
    "Asked", "Done", "Entry", "Found", "Given", "Held", "Here", "Item", "Known", "Look", "Made", "Part",
    "Piece", "Place", "Rows", "Seen", "Taken", "Told", "Wanted", "Work",
];
/// Types that keep such a name, with the reason.
const EXCEPTIONS: [(&str, &str, &str); 3] = [
    ("chordal-py", "Asked", "the name of a TypedDict in the stubs, and in messages of TypeError"),
    ("chordal-py", "Wanted", "the same"),
    ("chordal-io", "Part", "a part of a scene, with its own mesh, as modelling programs say"),
];

/// The types that a file defines, with their lines; associated types of traits are none.
fn defined(source: &Source) -> Vec<(String, usize)> {
    let tokens = &source.tokens;
    let is_word = |at: usize| tokens.get(at).is_some_and(|token: &Token| token.kind == Kind::Word);
    let (mut found, mut inside) = (Vec::new(), Vec::new());
    let mut next_is_impl = false;
    for (at, token) in tokens.iter().enumerate() {
        let in_impl = inside.last().is_some_and(|is_impl| *is_impl);
        match token.text.as_str() {
            "impl" | "trait"
                if token.kind == Kind::Word && (token.text == "trait" || starts_item(tokens, at)) =>
            {
                next_is_impl = true;
            }
            "{" if token.kind == Kind::Open => {
                inside.push(next_is_impl);
                next_is_impl = false;
            }
            "}" if token.kind == Kind::Close => _ = inside.pop(),
            _ => {}
        }
        let defines = match token.text.as_str() {
            "struct" | "enum" | "trait" | "union" => token.kind == Kind::Word,
            "type" => token.kind == Kind::Word && !in_impl,
            _ => false,
        };
        let is_name = |name: &Token| name.text.starts_with(|c: char| c.is_ascii_uppercase());
        if defines && is_word(at + 1) && is_name(&tokens[at + 1]) {
            found.push((tokens[at + 1].text.clone(), token.line));
        }
    }
    found
}

/// Whether the `impl` at `at` starts a block, and is not a type such as `-> impl Fn()`.
fn starts_item(tokens: &[Token], at: usize) -> bool {
    at == 0
        || tokens[at - 1].is("}")
        || tokens[at - 1].is(";")
        || tokens[at - 1].is("]")
        || tokens[at - 1].is("unsafe")
        || tokens[at - 1].is("{")
}

/// What is wrong with the names of one crate's types.
fn misnamed(crate_name: &str, sources: &[Source]) -> Vec<String> {
    let mut places = BTreeMap::<String, Vec<String>>::new();
    let mut complaints = Vec::new();
    for source in sources {
        for (name, line) in defined(source) {
            let excused = EXCEPTIONS.iter().any(|(of, excused, _)| *of == crate_name && *excused == name);
            if ROLES.contains(&name.as_str()) && !excused {
                complaints.push(source.complain(line, &format!("`{name}` says a role: name the thing")));
            }
            places.entry(name).or_default().push(format!("{}:{line}", source.path));
        }
    }
    let twice = places.iter().filter(|(_, places)| places.len() > 1);
    complaints.extend(twice.map(|(name, places)| {
        format!("{crate_name}: {} types are called `{name}`: {}", places.len(), places.join(", "))
    }));
    complaints
}

#[test]
fn type_names_are_unique_in_their_crate_and_name_things() {
    let folders = std::fs::read_dir(root().join("crates")).expect("there are crates");
    let mut names: Vec<String> = folders
        .map(|entry| entry.expect("it can be read").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    let complaints: Vec<String> =
        names.iter().flat_map(|name| misnamed(name, sources(&format!("crates/{name}/src")))).collect();
    expect_none(&complaints);
}

#[test]
fn homonyms_and_roles_are_found() {
    let one =
        Source::new("a.rs", "struct Cell; trait Walk { type Item; } impl Walk for Cell { type Item = u8; }");
    let two = Source::new("b.rs", "fn f() -> impl Fn() { enum Cell {} } pub type Found = u8;");
    assert!(misnamed("x", std::slice::from_ref(&one)).is_empty());
    let complaints = misnamed("x", &[one, two]);
    assert_eq!(complaints.len(), 2, "{complaints:?}");
    assert!(
        complaints[0].contains("`Found` says a role") && complaints[1].contains("2 types are called `Cell`")
    );
}

/// The names in backquotes in the column *where* of a row of the glossary.
fn named(row: &str) -> impl Iterator<Item = &str> {
    let cell = row.split('|').nth(3).unwrap_or("");
    cell.split('`').skip(1).step_by(2)
}

/// What the sources hold: their files, and every word in them.
struct SourceNames {
    paths: Vec<String>,
    words: BTreeSet<String>,
}

impl SourceNames {
    fn read() -> Self {
        let paths: Vec<String> = files("crates", |name| name.ends_with(".rs"))
            .iter()
            .map(|path| path.strip_prefix(root()).unwrap_or(path).to_string_lossy().replace('\\', "/"))
            .collect();
        let all = sources("crates");
        let words = all.iter().flat_map(|source| &source.tokens).filter(|token| token.kind == Kind::Word);
        let mut words: BTreeSet<String> = words.map(|token| token.text.clone()).collect();
        // Modules are words too where they are used; a file that is not is known by its path.
        words.extend(
            paths.iter().filter_map(|path| Some(path.rsplit('/').next()?.strip_suffix(".rs")?.to_owned())),
        );
        Self { paths, words }
    }

    fn has(&self, name: &str) -> bool {
        if name.contains('/') || name.ends_with(".rs") {
            // A list in braces stands for several files.
            let (before, rest) = name.split_once('{').unwrap_or((name, "}"));
            let (list, after) = rest.split_once('}').unwrap_or((rest, ""));
            let is_file = |part: &str| {
                let file = format!("{before}{}{after}", part.trim());
                self.paths.iter().any(|path| path.contains(file.trim_end_matches('/')))
            };
            list.split(',').all(is_file)
        } else {
            name.split("::").all(|word| self.words.contains(word) || word == "crate")
        }
    }
}

/// Names of the glossary that nothing in the sources has.
fn unknown(glossary: &str, known: &SourceNames) -> Vec<String> {
    let rows = glossary.lines().filter(|line| line.starts_with("| **"));
    rows.flat_map(named)
        .filter(|name| !known.has(name))
        .map(|name| format!("GLOSSARY.md: there is no `{name}`"))
        .collect()
}

/// Names of types and source files in the sentences of a page that nothing in the sources has.
fn unknown_in_page(name: &str, page: &str, known: &SourceNames) -> Vec<String> {
    let is_word = |text: &str| text.chars().all(|c| c.is_alphanumeric() || c == '_' || c == ':');
    let is_type = |word: &str| {
        let is_camel = word.contains(|c: char| c.is_ascii_lowercase()) && !word.contains('_');
        word.starts_with(|c: char| c.is_ascii_uppercase()) && is_camel && word != "Makefile"
    };
    let is_file = |text: &str| text.ends_with(".rs") && !text.contains('*');
    let is_checked = |text: &&str| is_file(text) || is_word(text) && text.split("::").any(is_type);
    let mut in_code = false;
    let mut found = Vec::new();
    for (number, line) in page.lines().enumerate() {
        in_code ^= line.starts_with("```");
        if !in_code {
            let names = line.split('`').skip(1).step_by(2).filter(is_checked);
            let gone = names.filter(|text| !known.has(text));
            found.extend(gone.map(|text| format!("{name}:{}: there is no `{text}`", number + 1)));
        }
    }
    found
}

#[test]
fn the_glossary_and_the_pages_name_what_is_there() {
    let known = SourceNames::read();
    let glossary = std::fs::read_to_string(root().join("GLOSSARY.md")).expect("there is a glossary");
    assert!(glossary.lines().filter(|line| line.starts_with("| **")).count() > 50, "the rows are found");
    let mut complaints = unknown(&glossary, &known);
    // The pages of Python and of the studio name what other languages and protocols have.
    let mut pages =
        files("docs", |name| name.ends_with(".md") && !["python.md", "studio.md"].contains(&name));
    pages.extend(["README.md", "ARCHITECTURE.md"].map(|name| root().join(name)));
    assert!(pages.len() > 20, "the pages are found");
    for page in pages {
        let name = page.strip_prefix(root()).unwrap_or(&page).display().to_string();
        complaints.extend(unknown_in_page(&name, &std::fs::read_to_string(&page).unwrap(), &known));
    }
    expect_none(&complaints);
}

#[test]
fn unknown_names_of_the_glossary_are_found() {
    let words: BTreeSet<String> = ["Bvh", "check"].map(str::to_owned).into();
    let paths = ["crates/chordal/src/explicit/bvh/mod.rs", "crates/chordal/src/explicit/bvh/ray.rs"];
    let known = SourceNames { paths: paths.map(str::to_owned).into(), words };
    let row = "| **tree** | boxes | `Bvh`, `explicit/bvh`, `check::Nothing`, `bvh/gone.rs` | a book |";
    assert_eq!(unknown(row, &known).len(), 2);
    let page = "A `Bvh` in `bvh/{mod,ray}.rs` is no `Tree` of `bvh/{mod,gone}.rs`: `tol`.\n```\n`Tree`\n```";
    assert_eq!(unknown_in_page("a page", page, &known).len(), 2);
}
