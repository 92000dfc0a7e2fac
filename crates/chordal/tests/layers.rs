//! Imports between the rooms of this crate only go down.
//!
//! Every token of every file below `src` is read, macro bodies, attributes and test modules included. A path
//! reaches another room only through the root of the crate (`crate`, `$crate`, enough `super`s, or the
//! crate's own name), so each path that starts so is resolved to the room it names. What cannot be resolved,
//! such as a name for the whole root, an unknown name at the root, or `crate::$room`, is refused and not
//! skipped.
use crate::gates;

use gates::paths::{Leaf, tree};
use gates::{Kind, Source, Token, expect_none};
use std::collections::BTreeMap;

/// The rooms with their storeys; rooms of one storey do not know each other.
const ROOMS: [(&str, u8); 11] = [
    ("math", 1),
    ("budget", 2),
    ("explicit", 3),
    ("implicit", 3),
    ("check", 4),
    ("convert", 5),
    ("boolean", 6),
    ("lod", 6),
    ("mend", 6),
    ("render", 6),
    ("prelude", 7),
];

/// The name by which the library knows itself.
const OWN_NAME: &str = "chordal";

fn storey(room: &str) -> Option<u8> {
    ROOMS.iter().find(|row| row.0 == room).map(|row| row.1)
}

/// What the root of the crate re-exports, with the room that it comes from.
type RootNames = BTreeMap<String, String>;

/// The room that a path named in `module` leads to: `None` for a path that does not go through the root or a
/// parent, an error where it cannot be told.
fn room_of(segments: &[String], module: &[String], names: &RootNames) -> Result<Option<String>, String> {
    let mut base: Vec<String> = match segments.first().map(String::as_str) {
        Some("crate" | OWN_NAME) => Vec::new(),
        Some("self" | "super") => module.to_vec(),
        _ => return Ok(None),
    };
    let from_crate = segments[0] == "crate" || segments[0] == OWN_NAME;
    let mut rest = &segments[usize::from(from_crate)..];
    while let Some(word @ ("self" | "super")) = rest.first().map(String::as_str) {
        if word == "super" && base.pop().is_none() {
            return Err("leads above the root".into());
        }
        rest = &rest[1..];
    }
    if let Some(room) = base.first() {
        return Ok(Some(room.clone()));
    }
    match rest.first().map(String::as_str) {
        None | Some("*") => Err("takes in the whole library, and so every room".into()),
        Some("$") => Err("leaves the room to a macro's caller".into()),
        Some(name) if storey(name).is_some() => Ok(Some(name.to_owned())),
        Some(name) => match names.get(name) {
            Some(room) => Ok(Some(room.clone())),
            None => {
                Err(format!("names '{name}' at the root, which is neither a room nor re-exported from one"))
            }
        },
    }
}

fn complaint_about(segments: &[String], module: &[String], names: &RootNames) -> Option<String> {
    let path = segments.join("::");
    let here = module.first()?;
    let to = match room_of(segments, module, names) {
        Ok(to) => to?,
        Err(reason) => return Some(format!("`{path}` {reason}")),
    };
    let down = storey(&to) < storey(here);
    (to != *here && !down).then(|| format!("`{path}` goes from room {here} to {to}; imports only go down"))
}

/// The module that a file below `src` is.
fn module_of(path: &str) -> Vec<String> {
    let inside = path.rsplit_once("src/").map_or(path, |parts| parts.1).trim_end_matches(".rs");
    let mut module: Vec<String> = inside.split('/').map(str::to_owned).collect();
    if module.last().is_some_and(|name| name == "mod" || name == "lib") {
        module.pop();
    }
    module
}

/// One walk over one file.
struct Walk<'a> {
    source: &'a Source,
    names: &'a RootNames,
    /// The module at the current token.
    module: Vec<String>,
    /// For every open bracket: whether it is a module's, and whether it is a macro definition's.
    open: Vec<(bool, bool)>,
    complaints: Vec<String>,
}

impl Walk<'_> {
    fn complain(&mut self, line: usize, sentence: &str) {
        self.complaints.push(self.source.complain(line, sentence));
    }

    fn run(mut self) -> Vec<String> {
        if let Some(room) = self.module.first()
            && storey(room).is_none()
        {
            let sentence = format!("'{room}' is no room");
            self.complain(1, &sentence);
        }
        let tokens = &self.source.tokens;
        let mut at = 0;
        while at < tokens.len() {
            at = self.step(tokens, at);
        }
        self.complaints
    }

    fn step(&mut self, tokens: &[Token], at: usize) -> usize {
        let is = |at: usize, text: &str| tokens.get(at).is_some_and(|token| token.is(text));
        let token = &tokens[at];
        self.refuse_side_doors(tokens, at);
        match token.kind {
            Kind::Open => self.enter(tokens, at),
            Kind::Close => self.leave(),
            Kind::Literal => self.read_literal(tokens, at),
            // `use<'a>` in a type captures lifetimes and names no path.
            Kind::Word if token.is("use") && !is(at + 1, "<") => {
                let (leaves, end) = tree(tokens, at + 1, &[]);
                self.check(&leaves, token.line);
                return end;
            }
            Kind::Word if starts_path(tokens, at) => {
                if self.open.iter().any(|bracket| bracket.1) && !(token.is("crate") || token.is(OWN_NAME)) {
                    self.complain(
                        token.line,
                        "a macro says `$crate`, not `super` or `self`: it runs elsewhere",
                    );
                }
                let (leaves, end) = tree(tokens, at, &[]);
                self.check(&leaves, token.line);
                return end;
            }
            _ => {}
        }
        at + 1
    }

    fn enter(&mut self, tokens: &[Token], at: usize) {
        let back = |n: usize| at.checked_sub(n).map(|at| &tokens[at]);
        let word = |n: usize, text: &str| back(n).is_some_and(|token| token.is(text));
        let module = tokens[at].is("{") && word(2, "mod");
        if module {
            let name = tokens[at - 1].text.clone();
            if self.module.is_empty() && storey(&name).is_none() {
                self.complain(tokens[at].line, &format!("'{name}' is no room"));
            }
            self.module.push(name);
        }
        self.open.push((module, word(2, "!") && word(3, "macro_rules")));
    }

    fn leave(&mut self) {
        if self.open.pop().is_some_and(|bracket| bracket.0) {
            self.module.pop();
        }
    }

    fn check(&mut self, leaves: &[Leaf], line: usize) {
        for leaf in leaves {
            if let Some(sentence) = complaint_about(&leaf.segments, &self.module, self.names) {
                self.complain(line, &sentence);
            }
        }
    }

    /// What would bring in another file or name unseen: `#[path]`, `#[macro_use]`, `include!`, a name for the
    /// root.
    fn refuse_side_doors(&mut self, tokens: &[Token], at: usize) {
        let is = |at: usize, text: &str| tokens.get(at).is_some_and(|token| token.is(text));
        let line = tokens[at].line;
        if is(at, "include") && is(at + 1, "!") {
            self.complain(line, "`include!` brings in a file unseen");
        }
        if is(at, "crate") && is(at + 1, "self") && !(is(at + 2, "as") && is(at + 3, OWN_NAME)) {
            self.complain(line, "`extern crate self` gives the root another name");
        }
        let opens_attribute = is(at, "[") && at > 0 && (is(at - 1, "#") || (at > 1 && is(at - 1, "!")));
        let end = tokens[at..].iter().position(|token| token.is("]")).map_or(at, |n| at + n);
        let side_door = |n| (is(n, "path") && is(n + 1, "=")) || is(n, "macro_use");
        if opens_attribute && (at..end).any(side_door) {
            self.complain(line, "`#[path]` and `#[macro_use]` bring in names unseen");
        }
    }

    /// A path in a text, as in `#[serde(with = "crate::convert")]`. Doc texts name rooms freely.
    fn read_literal(&mut self, tokens: &[Token], at: usize) {
        let text = tokens[at].text.trim_matches('"');
        let doc = at > 1 && tokens[at - 2].is("doc");
        if doc || !(text.contains("crate::") || text.contains("super::")) {
            return;
        }
        if text.parse::<proc_macro2::TokenStream>().is_ok() {
            let inner = Source::new(&self.source.path, text);
            let walk = Walk {
                source: &inner,
                names: self.names,
                module: self.module.clone(),
                open: Vec::new(),
                complaints: Vec::new(),
            };
            self.complaints.extend(walk.run());
        }
    }
}

/// Whether a path through the root or a parent starts here. A `crate` or `super` alone, as in `pub(crate)`,
/// is none.
fn starts_path(tokens: &[Token], at: usize) -> bool {
    let is = |at: usize, text: &str| tokens.get(at).is_some_and(|token| token.is(text));
    let starts = ["crate", "super", "self", OWN_NAME].iter().any(|word| is(at, word));
    starts && is(at + 1, ":") && is(at + 2, ":")
}

/// The names that `lib.rs` re-exports and the macros that `#[macro_export]` lifts to the root.
fn root_names(files: &[Source]) -> RootNames {
    let mut names = RootNames::new();
    for source in files {
        let module = module_of(&source.path);
        let tokens = &source.tokens;
        for at in 0..tokens.len() {
            let is = |n: usize, text: &str| tokens.get(at + n).is_some_and(|token| token.is(text));
            if is(0, "macro_export")
                && let Some(room) = module.first()
                && let Some(rules) = tokens[at..].iter().position(|token| token.is("macro_rules"))
                && let Some(name) = tokens.get(at + rules + 2)
            {
                names.insert(name.text.clone(), room.clone());
            }
            if module.is_empty() && is(0, "use") {
                names.extend(tree(tokens, at + 1, &[]).0.iter().filter_map(re_export));
            }
        }
    }
    names
}

fn re_export(leaf: &Leaf) -> Option<(String, String)> {
    let room = leaf.segments.iter().find(|name| !["crate", "self"].contains(&name.as_str()))?;
    storey(room)?;
    let name = leaf.alias.as_ref().or(leaf.segments.last())?;
    (name != "*" && name != "_").then(|| (name.clone(), room.clone()))
}

fn violations(files: &[Source]) -> Vec<String> {
    let names = root_names(files);
    files
        .iter()
        .flat_map(|source| {
            let module = module_of(&source.path);
            Walk { source, names: &names, module, open: Vec::new(), complaints: Vec::new() }.run()
        })
        .collect()
}

#[test]
fn rooms_import_only_downwards() {
    let files = gates::sources("crates/chordal/src");
    assert!(files.len() > 10, "the sources are there");
    expect_none(&violations(files));
}

/// The number of complaints about `text` as the file `path`, beside a root that re-exports a `Mesh`.
fn complaints(path: &str, text: &str) -> usize {
    let root = "pub mod math; pub use explicit::Mesh; pub use convert::{patches_to_mesh as build}; extern crate self as chordal;";
    let export = "#[macro_export] macro_rules! lifted { () => {} }";
    let files = [("src/lib.rs", root), ("src/check/law.rs", export), (path, text)];
    violations(&files.map(|(path, text)| Source::new(path, text))).len()
}

#[test]
fn every_form_of_going_up_or_across_is_found() {
    let box3 = [
        "use crate::convert;",
        "use crate::convert::patches_to_mesh;",
        "use crate::convert as c;",
        "use crate::{convert};",
        "use crate::{math::Interval, convert::{self as c}};",
        "use {crate::{check::{a}}};",
        "use super::super::convert::x;",
        "use super::super::{convert};",
        "use self::super::super::convert;",
        "use super::super::convert as c;",
        "use crate::*;",
        "use crate as root;",
        "use crate::{self as root};",
        "use super::super as root;",
        "use super::super::*;",
        "use chordal::convert;",
        "use ::chordal::convert;",
        "use crate::Mesh;",
        "use crate::build;",
        "use crate::unheard_of;",
        "use crate::r#convert;",
        "pub(crate) use crate::render::x;",
        "pub use crate::explicit;",
        "fn f() -> crate::explicit::Mesh { loop {} }",
        "fn f() { crate::convert::x(); }",
        "fn f() { let _ = <crate::explicit::Mesh as Default>::default(); }",
        "fn f(_: Vec<crate::Mesh>) {}",
        "fn f(x: X) { match x { crate::convert::X::A => {} } }",
        "impl crate::convert::T for X {}",
        "impl X for ::chordal::convert::T {}",
        "#[derive(crate::convert::D)] struct X;",
        "#[serde(with = \"crate::convert\")] struct X;",
        "mod inner { use super::super::super::convert; }",
        "fn f() { mod inner { fn g() { super::super::super::convert::x() } } }",
        "#[cfg(test)] mod tests { use crate::convert::x; }",
        "fn f() { println!(\"{}\", crate::convert::X); }",
        "fn f() { vec![crate::convert::X]; }",
        "macro_rules! m { () => { $crate::convert::x() } }",
        "macro_rules! m { ($room:ident) => { $crate::$room::x() } }",
        "macro_rules! m { () => { super::x() } }",
        "macro_rules! m { () => { use $crate::{math, lod::x}; } }",
        "make!(crate::{math, convert});",
        "crate::lifted!();",
        "extern crate self as other;",
        "#[path = \"../convert/x.rs\"] mod x;",
        "#[cfg_attr(unix, path = \"../convert/x.rs\")] mod x;",
        "include!(\"../convert/x.rs\");",
        "#[macro_use] mod inner {}",
        "pub(in crate::convert) struct X;",
    ];
    for text in box3 {
        assert_eq!(complaints("src/math/box3.rs", text), 1, "{text}");
    }
    for (path, text) in [
        ("src/math/mod.rs", "use super::convert;"),
        ("src/math/mod.rs", "use super::*;"),
        ("src/math.rs", "use super::budget::Job;"),
        ("src/explicit/mesh.rs", "use crate::implicit::Field;"),
        ("src/implicit/field.rs", "use crate::explicit::Mesh;"),
        ("src/check/bvh.rs", "use crate::convert::patches_to_mesh;"),
        ("src/lod/chain.rs", "use crate::render::x;"),
        ("src/render/ray.rs", "use crate::lod::x;"),
        ("src/utils.rs", ""),
        ("src/utils/mod.rs", ""),
        ("src/lib.rs", "mod utils { fn f() {} }"),
        ("src/lib.rs", "pub mod math { use crate::convert; }"),
        ("src/lib.rs", "pub mod math { pub mod deep { use super::super::convert; } }"),
    ] {
        assert_eq!(complaints(path, text), 1, "{path}: {text}");
    }
}

#[test]
fn going_down_and_staying_is_allowed() {
    for (path, text) in [
        ("src/lib.rs", "pub use convert::x; fn f() { convert::x(); crate::render::y() }"),
        ("src/math/box3.rs", "use super::{add_up, rounding::*}; use crate::math::Interval; use std::fmt;"),
        ("src/math/mod.rs", "mod tests { use super::*; use super::super::math::Box3; }"),
        (
            "src/budget/bound.rs",
            "use crate::math::{add_up, sub_down}; pub(crate) fn f() {} pub(super) fn g() {}",
        ),
        ("src/explicit/mesh.rs", "use crate::{budget::Job, math::{self, Box3}}; use super::Bezier;"),
        ("src/check/bvh.rs", "use crate::{Mesh, explicit as e}; fn f(self_: &e::Mesh) { crate::lifted!(); }"),
        ("src/convert/a_to_b.rs", "use crate::{Mesh, check, implicit::Field}; fn f() -> impl X + use<'a> {}"),
        ("src/render/ray.rs", "use crate::build; fn f() { glam::convert::x(); mine::crate_::y() }"),
        ("src/math/box3.rs", "//! Used by [`crate::convert`].\n/// See [`crate::convert`].\nstruct X;"),
        ("src/math/box3.rs", "macro_rules! m { () => { $crate::math::x() } }"),
    ] {
        assert_eq!(complaints(path, text), 0, "{path}: {text}");
    }
}
