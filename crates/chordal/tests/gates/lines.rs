//! What tokens do not tell: comments, where a statement starts, and what is test code.
use super::{Kind, Source, Token};
use std::collections::BTreeMap;

/// A comment on one line.
#[derive(Clone, Debug)]
pub struct Comment {
    /// From its first slash to the end of the line.
    pub text: String,
    /// Whether it stands alone on its line.
    pub alone: bool,
}

impl Comment {
    /// Whether it documents what follows or the file (`///`, `//!`).
    pub fn is_doc(&self) -> bool {
        self.text.starts_with("///") || self.text.starts_with("//!")
    }
}

/// The lines of a source file.
pub struct Lines<'a> {
    source: &'a Source,
    /// By line, counted from 1.
    pub comments: BTreeMap<usize, Comment>,
    /// For every token: the line on which its statement, item, field or match arm starts.
    starts: Vec<usize>,
    /// For every token: whether it belongs to a `#[test]` or `#[cfg(test)]` item.
    tests: Vec<bool>,
}

impl<'a> Lines<'a> {
    /// The lines of `source`.
    pub fn new(source: &'a Source) -> Self {
        let starts = statement_starts(&source.tokens);
        Self { source, comments: comments(source), starts, tests: test_code(&source.tokens) }
    }

    /// Whether the token belongs to test code.
    pub fn is_test(&self, token: usize) -> bool {
        self.tests[token]
    }

    /// The comments that speak of a token: behind it on its line, alone on the lines right above it, or in
    /// the same places of the line on which its statement starts. Those on the file as a whole (`//!`) do
    /// not. Empty when there is none.
    pub fn comment_on(&self, token: usize) -> String {
        let line = self.source.tokens[token].line;
        let own = |line: &usize| self.comments.get(line).filter(|comment| !comment.text.starts_with("//!"));
        let mut found = String::new();
        for line in [line, self.starts[token]] {
            found += own(&line).map_or("", |comment| &comment.text);
            let above = (1..line).rev().map_while(|line| own(&line).filter(|comment| comment.alone));
            above.for_each(|comment| found += &comment.text);
        }
        found
    }
}

impl Lines<'_> {
    /// The comments of the function around a token, from its documentation down to the token.
    pub fn comments_of_function(&self, token: usize) -> String {
        let tokens = &self.source.tokens;
        let named =
            |at: &usize| tokens[*at].is("fn") && tokens.get(at + 1).is_some_and(|t| t.kind == Kind::Word);
        let Some(function) = (0..token).rev().find(named) else { return String::new() };
        let lines = self.starts[function]..=tokens[token].line;
        self.comments.range(lines).map(|(_, comment)| comment.text.as_str()).collect()
    }
}

/// Between two tokens stand only blanks and comments, so what is not blank there is a comment.
fn comments(source: &Source) -> BTreeMap<usize, Comment> {
    let text = &source.text;
    let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
    let mut found = BTreeMap::new();
    let mut keep = |from: usize, part: &str| {
        let mut at = from;
        for piece in part.split_inclusive('\n') {
            let blank = piece.len() - piece.trim_start().len();
            if !piece.trim().is_empty() {
                let start = at + blank;
                let line = ends.partition_point(|end| *end < start) + 1;
                let before = text[..start].rsplit('\n').next().unwrap_or("");
                let comment = Comment { text: piece.trim().to_owned(), alone: before.trim().is_empty() };
                found.entry(line).or_insert(comment);
            }
            at += piece.len();
        }
    };
    let mut end = 0;
    for token in &source.tokens {
        if token.bytes.start >= end {
            keep(end, &text[end..token.bytes.start]);
        }
        let written = &text[token.bytes.clone()];
        if written.starts_with("//") {
            keep(token.bytes.start, written);
        }
        end = end.max(token.bytes.end);
    }
    keep(end, &text[end..]);
    found
}

fn statement_starts(tokens: &[Token]) -> Vec<usize> {
    // For every open bracket: whether it holds statements, and where the current one starts.
    let mut open: Vec<(bool, Option<usize>)> = vec![(true, None)];
    let mut starts = Vec::with_capacity(tokens.len());
    // Where an inner attribute ends, as a doc comment on the file is one; it belongs to no statement.
    let mut title_end = None;
    for (at, token) in tokens.iter().enumerate() {
        if reads(tokens, at, &["#", "!", "["]) {
            title_end = tokens[at..].iter().position(|token| token.is("]")).map(|n| at + n);
        }
        if token.kind == Kind::Close && open.len() > 1 {
            open.pop();
        }
        let frame = open.last_mut().expect("the file itself stays open");
        let start = *frame.1.get_or_insert(token.line);
        starts.push(start);
        let ends = token.is(";") || token.is(",") || token.is("}") || Some(at) == title_end;
        if frame.0 && ends {
            frame.1 = None;
        }
        if token.kind == Kind::Open {
            let block = token.is("{");
            open.push((block, (!block).then_some(start)));
        }
    }
    starts
}

/// Whether `words` stand at `tokens[at]`.
fn reads(tokens: &[Token], at: usize, words: &[&str]) -> bool {
    words.iter().enumerate().all(|(n, word)| tokens.get(at + n).is_some_and(|token| token.is(word)))
}

fn test_code(tokens: &[Token]) -> Vec<bool> {
    let mut tests = vec![false; tokens.len()];
    for at in 0..tokens.len() {
        let marked = reads(tokens, at, &["#", "[", "test", "]"])
            || reads(tokens, at, &["#", "[", "cfg", "(", "test", ")", "]"]);
        if marked {
            let end = item_end(tokens, at);
            tests[at..end].fill(true);
        }
    }
    tests
}

/// The index behind the item at `at`: behind its first block that stands in no other bracket, or its
/// semicolon.
fn item_end(tokens: &[Token], at: usize) -> usize {
    let mut depth = 0_usize;
    for (n, token) in tokens.iter().enumerate().skip(at) {
        match token.kind {
            Kind::Open => depth += 1,
            Kind::Close => {
                depth = depth.saturating_sub(1);
                if depth == 0 && token.is("}") {
                    return n + 1;
                }
            }
            _ if depth == 0 && token.is(";") => return n + 1,
            _ => {}
        }
    }
    tokens.len()
}
