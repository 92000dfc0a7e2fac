//! The public items of the library are those of a list that is committed, and few of its types are in front.
use crate::gates;

use gates::root;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use syn::{Item, UseTree, Visibility};

/// The list, beside this file; `CHORDAL_WRITE_PUBLIC_ITEMS=1` writes it anew.
const LIST: &str = "crates/chordal/tests/public_items.txt";
/// The most types that stand in the modules themselves, and not in one of their submodules; a decision.
const MOST_IN_FRONT: usize = 94;

/// The names that a tree of `use` brings in.
fn leaves(tree: &UseTree, out: &mut Vec<String>) {
    match tree {
        UseTree::Path(path) => leaves(&path.tree, out),
        UseTree::Name(name) => out.push(name.ident.to_string()),
        UseTree::Rename(rename) => out.push(rename.rename.to_string()),
        UseTree::Group(group) => group.items.iter().for_each(|tree| leaves(tree, out)),
        UseTree::Glob(_) => panic!("a glob re-exports names that nobody sees: name them"),
    }
}

/// The public name of an item that defines one.
fn defined(item: &Item) -> Option<String> {
    let (visibility, name) = match item {
        Item::Fn(item) => (&item.vis, &item.sig.ident),
        Item::Struct(item) => (&item.vis, &item.ident),
        Item::Enum(item) => (&item.vis, &item.ident),
        Item::Trait(item) => (&item.vis, &item.ident),
        Item::Type(item) => (&item.vis, &item.ident),
        Item::Const(item) => (&item.vis, &item.ident),
        Item::Static(item) => (&item.vis, &item.ident),
        _ => return None,
    };
    matches!(visibility, Visibility::Public(_)).then(|| name.to_string())
}

/// Collects the public items of a module, whose files lie in `folder`.
fn collect(items: &[Item], module: &str, folder: &Path, out: &mut BTreeSet<String>) {
    for item in items {
        match item {
            Item::Use(tree) if matches!(tree.vis, Visibility::Public(_)) => {
                let mut names = Vec::new();
                leaves(&tree.tree, &mut names);
                out.extend(names.into_iter().map(|name| format!("{module}::{name}")));
            }
            Item::Mod(inner) if matches!(inner.vis, Visibility::Public(_)) => {
                let path = format!("{module}::{}", inner.ident);
                let folder = folder.join(inner.ident.to_string());
                match &inner.content {
                    Some((_, items)) => collect(items, &path, &folder, out),
                    None => {
                        let files = [folder.with_extension("rs"), folder.join("mod.rs")];
                        let file = files.iter().find(|file| file.is_file()).expect("a module has a file");
                        collect(&parsed(file), &path, &folder, out);
                    }
                }
            }
            Item::Macro(rule) if rule.attrs.iter().any(|a| a.path().is_ident("macro_export")) => {
                out.extend(rule.ident.iter().map(|name| format!("chordal::{name}!")));
            }
            other => out.extend(defined(other).map(|name| format!("{module}::{name}"))),
        }
    }
}

fn parsed(file: &Path) -> Vec<Item> {
    syn::parse_file(&std::fs::read_to_string(file).unwrap()).unwrap().items
}

fn public_items() -> BTreeSet<String> {
    let source: PathBuf = root().join("crates/chordal/src");
    let mut out = BTreeSet::new();
    collect(&parsed(&source.join("lib.rs")), "chordal", &source, &mut out);
    out
}

/// A type or trait: its name starts with a capital and is not all capitals.
fn is_type(path: &str) -> bool {
    let name = path.rsplit("::").next().unwrap();
    name.starts_with(|c: char| c.is_ascii_uppercase()) && name.contains(|c: char| c.is_ascii_lowercase())
}

#[test]
fn the_public_items_are_those_of_the_list() {
    let text: String = public_items().iter().map(|item| format!("{item}\n")).collect();
    if std::env::var_os("CHORDAL_WRITE_PUBLIC_ITEMS").is_some() {
        std::fs::write(root().join(LIST), &text).unwrap();
    }
    let list = std::fs::read_to_string(root().join(LIST)).unwrap();
    let [now, before] = [&text, &list].map(|text| text.lines().collect::<BTreeSet<_>>());
    let added: Vec<_> = now.difference(&before).collect();
    let gone: Vec<_> = before.difference(&now).collect();
    assert!(
        added.is_empty() && gone.is_empty(),
        "public items differ from {LIST}: added {added:#?}, gone {gone:#?}; if that is meant, write the list anew"
    );
}

#[test]
fn few_types_are_in_front() {
    let items = public_items();
    let in_front =
        |path: &&String| is_type(path) && path.matches("::").count() <= 2 && !path.contains("prelude");
    let names: BTreeSet<_> = items.iter().filter(in_front).map(|path| path.rsplit("::").next()).collect();
    assert!(names.len() > MOST_IN_FRONT / 2, "this test has lost its way: {} types", names.len());
    assert!(
        names.len() <= MOST_IN_FRONT,
        "{} types stand in front, over {MOST_IN_FRONT}: put experts' parts into a named submodule",
        names.len()
    );
}
