//! `ObjNames`: the names of face groups as an OBJ and its library spell them.
use crate::{MATERIAL, SceneAssets};
use std::collections::{BTreeMap, BTreeSet};

/// The names of groups; names of materials are unique.
pub(super) struct ObjNames<'a> {
    groups: &'a BTreeMap<String, Vec<String>>,
    /// The names of materials by number; the one for no material is empty.
    pub materials: Vec<String>,
}

impl<'a> ObjNames<'a> {
    /// An OBJ refers to materials only by name, so unnamed ones and duplicates get new names.
    pub fn new(groups: &'a BTreeMap<String, Vec<String>>, assets: &SceneAssets) -> Self {
        let group_names = groups.get(MATERIAL).map_or(&[][..], |names| names);
        let mut taken = UniqueNames::default();
        let mut materials = vec![String::new()];
        for number in 1..group_names.len().max(assets.materials.len() + 1) {
            let material_name =
                assets.materials.get(number - 1).and_then(|material| material["name"].as_str());
            let name =
                one_line(group_names.get(number).map_or(material_name.unwrap_or_default(), |name| name));
            let name = if name.is_empty() { format!("{MATERIAL}_{number}") } else { name };
            materials.push(taken.unique(&name, ""));
        }
        Self { groups, materials }
    }

    /// The name for a value of a group attribute.
    pub fn name(&self, kind: &str, value: f64) -> String {
        if kind == "s" {
            return if value == 0.0 { "off".to_owned() } else { value.to_string() };
        }
        let names = if kind == MATERIAL { Some(&self.materials) } else { self.groups.get(kind) };
        // A value that is not an index or has no name is used as the name.
        match names.and_then(|names| names.get(value as usize)) {
            Some(name) => name.clone(),
            None if value == 0.0 => String::new(),
            None => format!("{kind}_{value}"),
        }
    }
}

/// A name that fits on one line; a backslash at its end would join it with the next line.
pub(super) fn one_line(name: &str) -> String {
    let name: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    name.trim().trim_end_matches('\\').trim_end().to_owned()
}

/// Issues unique names, ignoring case.
#[derive(Default)]
pub(super) struct UniqueNames {
    taken: BTreeSet<String>,
    /// The last number that was appended to a name.
    last: BTreeMap<String, u64>,
}

impl UniqueNames {
    /// The name with its ending, with a number between them if it was issued before.
    pub fn unique(&mut self, name: &str, ending: &str) -> String {
        let mut tried = format!("{name}{ending}");
        while !self.taken.insert(tried.to_lowercase()) {
            let last = self.last.entry(tried_key(name, ending)).or_insert(1);
            *last += 1;
            tried = format!("{name}_{last}{ending}");
        }
        tried
    }
}

fn tried_key(name: &str, ending: &str) -> String {
    format!("{name}{ending}").to_lowercase()
}
