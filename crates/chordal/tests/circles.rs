//! Files of a crate do not use each other in a circle.
use crate::gates;

use gates::paths::{Leaf, tree};
use gates::{Kind, Source, expect_none, sources};
use std::collections::{BTreeMap, BTreeSet};

/// The crates that are looked at. In `chordal-py` classes return each other by their nature (a source makes
/// an outcome, which is a source again), and PyO3 wants all methods of a class in one block.
const CRATES: [&str; 5] = ["chordal", "chordal-io", "chordal-script", "chordal-verbs", "chordal-cli"];

/// The module that a file below `src` is: `a/b.rs` and `a/b/mod.rs` are `a::b`, `lib.rs` is the root.
fn module_of(path: &str) -> Vec<String> {
    let inner = path.split_once("/src/").map_or(path, |(_, inner)| inner);
    let inner = inner.strip_suffix(".rs").unwrap_or(inner);
    let inner = inner.strip_suffix("/mod").unwrap_or(inner);
    match inner {
        "lib" | "main" => Vec::new(),
        _ => inner.split('/').map(str::to_owned).collect(),
    }
}

/// A path of a file that may lead to another one.
struct PathUse {
    leaf: Leaf,
    /// The module that it stands in: that of its file, or one that is written out inside it.
    module: Vec<String>,
    /// Whether it is a leaf of a `use` item, and so gives the module a name.
    is_import: bool,
}

/// All paths of a file that may lead to another one: the leaves of its `use` items, and paths from `crate` or
/// `super`.
fn paths_of(source: &Source) -> Vec<PathUse> {
    let tokens = &source.tokens;
    let mut module = module_of(&source.path);
    // For every open bracket: whether it is a module's.
    let mut open: Vec<bool> = Vec::new();
    let (mut paths, mut at) = (Vec::new(), 0);
    while at < tokens.len() {
        let token = &tokens[at];
        if token.kind == Kind::Open {
            let is_module = token.is("{") && at > 1 && tokens[at - 2].is("mod");
            if is_module {
                module.push(tokens[at - 1].text.clone());
            }
            open.push(is_module);
        } else if token.kind == Kind::Close && open.pop() == Some(true) {
            module.pop();
        }
        let is_import = token.is("use") && token.kind == Kind::Word;
        let starts = token.kind == Kind::Word
            && ["crate", "super", "self"].iter().any(|word| token.is(word))
            && tokens.get(at + 1).is_some_and(|next| next.is(":"));
        if is_import || starts {
            let (found, end) = tree(tokens, at + usize::from(is_import), &[]);
            paths.extend(found.into_iter().map(|mut leaf| {
                // `a::{self}` names a.
                if leaf.segments.len() > 1 && leaf.segments.last().is_some_and(|word| word == "self") {
                    leaf.segments.pop();
                }
                PathUse { leaf, module: module.clone(), is_import }
            }));
            at = end.max(at + 1);
        } else {
            at += 1;
        }
    }
    paths
}

/// The modules of a crate with what each has from elsewhere.
struct Crate {
    /// By module, those written out inside files included: its imports, by the name that they have there.
    names: BTreeMap<Vec<String>, BTreeMap<String, Vec<String>>>,
    /// The modules that are files.
    files: BTreeSet<Vec<String>>,
}

impl Crate {
    fn new(sources: &[Source]) -> Self {
        let files: BTreeSet<_> = sources.iter().map(|source| module_of(&source.path)).collect();
        let mut names: BTreeMap<_, BTreeMap<_, _>> =
            files.iter().map(|file| (file.clone(), BTreeMap::new())).collect();
        for PathUse { leaf, module, is_import } in sources.iter().flat_map(paths_of) {
            let to = absolute(&leaf.segments, &module);
            let of_module = names.entry(module).or_default();
            if let Some(name) = leaf.alias.or_else(|| leaf.segments.last().cloned()).filter(|_| is_import) {
                of_module.insert(name, to);
            }
        }
        Self { names, files }
    }

    /// The file in which what an absolute path names is defined; none where it is of another crate.
    fn home(&self, path: &[String]) -> Option<Vec<String>> {
        let mut home = self.module(path, 0)?;
        while !self.files.contains(&home) {
            home.pop()?;
        }
        (!home.is_empty()).then_some(home)
    }

    /// The module in which it is defined.
    fn module(&self, path: &[String], depth: usize) -> Option<Vec<String>> {
        let module =
            (0..=path.len()).rev().map(|n| &path[..n]).find(|module| self.names.contains_key(*module))?;
        let rest = &path[module.len()..];
        let Some(name) = rest.first() else { return Some(module.to_vec()) };
        // What the module has from another one is looked up there.
        let from = self.names[module].get(name).filter(|from| from.as_slice() != path && depth < 8);
        match from.and_then(|from| self.module(from, depth + 1)) {
            Some(home) if home != module => Some(home),
            _ if module.is_empty() => None,
            _ => Some(module.to_vec()),
        }
    }
}

/// A path from the root of the crate, where it starts with `crate`, `self`, `super` or a sibling.
fn absolute(segments: &[String], module: &[String]) -> Vec<String> {
    let mut base = match segments.first().map(String::as_str) {
        Some("crate") => return segments[1..].to_vec(),
        _ => module.to_vec(),
    };
    let mut rest = segments;
    while let Some(word @ ("self" | "super")) = rest.first().map(String::as_str) {
        if word == "super" {
            base.pop();
        }
        rest = &rest[1..];
    }
    base.extend_from_slice(rest);
    base
}

/// The files that each uses, without those above and below it, which share its folder's door.
fn uses(sources: &[Source]) -> BTreeMap<Vec<String>, BTreeSet<Vec<String>>> {
    let whole = Crate::new(sources);
    let mut all = BTreeMap::new();
    for source in sources {
        let file = module_of(&source.path);
        let homes = paths_of(source)
            .into_iter()
            .filter_map(|path| whole.home(&absolute(&path.leaf.segments, &path.module)));
        let is_other = |home: &Vec<String>| !home.starts_with(&file) && !file.starts_with(home);
        all.insert(file.clone(), homes.filter(is_other).collect());
    }
    all
}

/// The circles among files, each by its members.
fn circles(sources: &[Source]) -> Vec<String> {
    let uses = uses(sources);
    let reach = |start: &Vec<String>| {
        let (mut open, mut seen) = (vec![start], BTreeSet::new());
        while let Some(module) = open.pop() {
            for next in uses.get(module).into_iter().flatten() {
                if seen.insert(next) {
                    open.push(next);
                }
            }
        }
        seen
    };
    let reached: BTreeMap<&Vec<String>, BTreeSet<&Vec<String>>> =
        uses.keys().map(|m| (m, reach(m))).collect();
    let mut found = BTreeSet::new();
    for (module, reaches) in &reached {
        if reaches.contains(module) {
            let members =
                reaches.iter().filter(|other| reached.get(*other).is_some_and(|back| back.contains(module)));
            found.insert(members.map(|member| member.join("::")).collect::<Vec<_>>().join(", "));
        }
    }
    found.into_iter().collect()
}

#[test]
fn files_use_each_other_one_way() {
    let complaints: Vec<String> = CRATES
        .iter()
        .flat_map(|name| {
            let found = circles(sources(&format!("crates/{name}/src")));
            found.into_iter().map(move |circle| format!("{name}: a circle of {circle}"))
        })
        .collect();
    expect_none(&complaints);
}

#[test]
fn circles_are_found_also_through_the_root() {
    let files = |b: &str| {
        [
            Source::new("crates/x/src/lib.rs", "mod a; mod b; mod c; pub use a::A;"),
            Source::new("crates/x/src/a.rs", "use crate::b::B; pub struct A(B);"),
            Source::new("crates/x/src/b.rs", b),
            Source::new("crates/x/src/c/mod.rs", "mod d; pub struct C; use d::D;"),
            Source::new("crates/x/src/c/d.rs", "use super::C; pub struct D(C);"),
        ]
    };
    assert!(circles(&files("pub struct B;")).is_empty());
    assert_eq!(circles(&files("use crate::A; pub struct B;")), ["a, b"]);
    assert_eq!(circles(&files("pub struct B; fn f() { super::a::g() }")), ["a, b"]);
}

#[test]
fn circles_are_found_through_modules_inside_files() {
    let files = |root: &str, a: &str, b: &str| {
        ["lib", "a", "b"]
            .map(|name| format!("crates/x/src/{name}.rs"))
            .into_iter()
            .zip([root, a, b])
            .map(|(path, text)| Source::new(&path, text))
            .collect::<Vec<_>>()
    };
    let uses_b = "use crate::b::B; pub struct A(B);";
    let doors = "mod a; mod b; pub mod parts { pub use super::a::A; }";
    assert_eq!(circles(&files(doors, uses_b, "use crate::parts::A; pub struct B;")), ["a, b"]);
    let test = "pub struct B; #[cfg(test)] mod tests { use super::super::a::A; }";
    assert_eq!(circles(&files(doors, uses_b, test)), ["a, b"]);
    assert!(circles(&files(doors, uses_b, "pub struct B; mod tests { use super::B; }")).is_empty());
}
