//! What the gates share: the sources of the workspace as flat lists of tokens, and the way they complain.
#![allow(dead_code, reason = "each gate uses its own part of this")]
pub mod lines;
pub mod paths;

use proc_macro2::{Delimiter, Span, TokenStream, TokenTree};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A word, keywords included, without `r#`.
    Word,
    /// One character of punctuation.
    Punct,
    /// `(`, `[` or `{`.
    Open,
    /// `)`, `]` or `}`.
    Close,
    /// A number, a text or a character, as written.
    Literal,
}

/// One token of a source file, macro bodies and attributes included.
#[derive(Clone, Debug)]
pub struct Token {
    /// What it is.
    pub kind: Kind,
    /// As written.
    pub text: String,
    /// Its line, counted from 1.
    pub line: usize,
    /// Its bytes in the file; those of the whole comment for the tokens that a doc comment turns into.
    pub bytes: Range<usize>,
}

impl Token {
    /// Whether it reads so and is no literal.
    pub fn is(&self, text: &str) -> bool {
        self.kind != Kind::Literal && self.text == text
    }
}

/// A Rust file.
pub struct Source {
    /// Relative to the root of the workspace, with `/`.
    pub path: String,
    /// The text.
    pub text: String,
    /// All tokens in order: nothing of the file is hidden in a tree, so nothing can be missed in one.
    pub tokens: Vec<Token>,
}

impl Source {
    /// The file of that path and text.
    pub fn new(path: &str, text: &str) -> Self {
        let mut tokens = Vec::new();
        let stream = text.parse().unwrap_or_else(|error| panic!("{path} is not Rust: {error}"));
        flatten(stream, &mut tokens);
        Self { path: path.to_owned(), text: text.to_owned(), tokens }
    }

    /// One complaint: path, line, sentence.
    pub fn complain(&self, line: usize, sentence: &str) -> String {
        format!("{}:{line}: {sentence}", self.path)
    }
}

fn flatten(stream: TokenStream, into: &mut Vec<Token>) {
    for tree in stream {
        let mut push = |kind, text: String, span: Span| {
            into.push(Token { kind, text, line: span.start().line, bytes: span.byte_range() });
        };
        let span = tree.span();
        match tree {
            TokenTree::Ident(word) => {
                push(Kind::Word, word.to_string().trim_start_matches("r#").to_owned(), span);
            }
            TokenTree::Punct(punct) => push(Kind::Punct, punct.as_char().to_string(), span),
            TokenTree::Literal(literal) => push(Kind::Literal, literal.to_string(), span),
            TokenTree::Group(group) => {
                let (open, close) = match group.delimiter() {
                    Delimiter::Parenthesis => ("(", ")"),
                    Delimiter::Bracket => ("[", "]"),
                    Delimiter::Brace => ("{", "}"),
                    Delimiter::None => ("", ""),
                };
                push(Kind::Open, open.to_owned(), group.span_open());
                let end = group.span_close();
                flatten(group.stream(), into);
                let bytes = end.byte_range();
                into.push(Token { kind: Kind::Close, text: close.to_owned(), line: end.end().line, bytes });
            }
        }
    }
}

/// The root of the workspace that the tests run in; cargo says at run time where that is.
pub fn root() -> PathBuf {
    let here = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
    Path::new(&here).ancestors().nth(2).expect("the crate lies two folders below the root").to_owned()
}

/// Every file below `folder` (relative to the root) for whose name `wanted` holds, sorted; folders that git
/// ignores are left out. A folder that is not there has no files.
pub fn files(folder: &str, wanted: fn(&str) -> bool) -> Vec<PathBuf> {
    const IGNORED: [&str; 6] = ["target", "out", "node_modules", ".git", ".venv", "__pycache__"];
    let mut found = Vec::new();
    let mut open = vec![root().join(folder)];
    while let Some(folder) = open.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for entry in entries {
            let entry = entry.unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
            let name = entry.file_name().to_string_lossy().into_owned();
            let kind = entry.file_type().unwrap_or_else(|error| panic!("{name}: {error}"));
            if IGNORED.contains(&name.as_str()) {
                continue;
            }
            if kind.is_dir() {
                open.push(entry.path());
            } else if kind.is_file() && wanted(&name) {
                found.push(entry.path());
            }
        }
    }
    found.sort();
    found
}

/// Every file that git tracks and that is there; every file where there is no git, as in a downloaded
/// archive.
pub fn tracked() -> Vec<PathBuf> {
    let git = Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output();
    let Some(listed) = git.ok().filter(|output| output.status.success()) else { return files("", |_| true) };
    let names = String::from_utf8_lossy(&listed.stdout).into_owned();
    names.split_terminator('\0').map(|name| root().join(name)).filter(|file| file.is_file()).collect()
}

/// `file` relative to the root, with `/`.
pub fn relative(file: &Path) -> String {
    let inside = file.strip_prefix(root()).expect("a file of the workspace");
    inside.to_string_lossy().replace('\\', "/")
}

/// Every Rust file that a gate looks at, in order of the paths, taken apart once for all gates.
static SOURCES: LazyLock<Vec<Source>> = LazyLock::new(|| {
    let read = |file: &PathBuf| std::fs::read_to_string(file).expect("a Rust file is readable UTF-8");
    let folders = ["bench", "crates", "examples", "fuzz"];
    let files = folders.iter().flat_map(|folder| files(folder, |name| name.ends_with(".rs")));
    files.map(|file| Source::new(&relative(&file), &read(&file))).collect()
});

/// Every Rust file below `folder`, which is one of those or lies in one.
pub fn sources(folder: &str) -> &'static [Source] {
    let is_below = |source: &Source| Path::new(&source.path).starts_with(folder);
    let first = SOURCES.iter().position(is_below).unwrap_or(SOURCES.len());
    let n = SOURCES[first..].iter().take_while(|source| is_below(source)).count();
    &SOURCES[first..first + n]
}

/// Fails with all complaints, one a line.
pub fn expect_none(complaints: &[String]) {
    assert!(complaints.is_empty(), "\n{}\n", complaints.join("\n"));
}
