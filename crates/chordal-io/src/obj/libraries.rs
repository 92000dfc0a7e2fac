//! `LibraryReader`: opens the material libraries of an OBJ, and converts the materials that its faces use to
//! assets.
use super::mtl::MtlReader;
use super::mtl_to_gltf::{MtlConverter, plain_material};
use super::pictures::{FOUND_BY_NAME, FOUND_BY_NAME_TEXT, ObjFiles, ObjPictures, file_name};
use crate::files::{self, FileOpener};
use crate::notes::NamedNotes;
use crate::text::text_of;
use crate::warnings::Warnings;
use crate::{Limits, SceneAssets};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// The bytes that a material takes as JSON, and each of its statements. Measured, and rounded up.
const MATERIAL_BYTES: u64 = 2048;
const STATEMENT_BYTES: u64 = 256;

/// The bytes that materials may take beyond a share of the bytes of their libraries. Derived: half of the
/// allowance that a reader has for any file.
const ALLOWED: u64 = 32 << 20;
/// That share. Derived: half of the 16 bytes that a reader may take for each byte.
const PER_BYTE: u64 = 8;

/// The libraries of an OBJ and the material names of its faces.
pub(super) struct LibraryRequest<'r> {
    /// The text after each `mtllib`.
    pub statements: &'r [Box<[u8]>],
    /// The names of the material groups, except the group of faces without a material.
    pub names: &'r [String],
    /// The size of the OBJ.
    pub n_bytes: u64,
}

/// The assets for the materials of faces: one for each name, in order, or none if no library could be read.
/// Missing files and materials are warnings.
pub(super) fn read_libraries(
    request: &LibraryRequest<'_>,
    open: &mut FileOpener<'_>,
    limits: &Limits,
    warnings: &mut Warnings,
) -> SceneAssets {
    let mut reader = LibraryReader {
        wanted: request.names.iter().enumerate().map(|(at, name)| (name.as_str(), at)).collect(),
        materials: vec![None; request.names.len()],
        pictures: ObjPictures::new(ObjFiles::new(open, limits.bytes.saturating_sub(request.n_bytes))),
        tried: BTreeSet::new(),
        is_any_read: false,
        left: Some(ALLOWED + PER_BYTE * request.n_bytes),
        notes: NamedNotes::default(),
    };
    if request.names.is_empty() {
        for statement in request.statements {
            let what = "material libraries were not opened, since no face names a material";
            reader.notes.add("mtllib-unused", what, &String::from_utf8_lossy(statement));
        }
    } else {
        request.statements.iter().for_each(|statement| reader.statement(&String::from_utf8_lossy(statement)));
    }
    let materials = reader.all_materials(request.names);
    reader.notes.report(warnings);
    materials.map_or_else(SceneAssets::default, |materials| reader.pictures.into_assets(materials))
}

struct LibraryReader<'r, 'a, 'b> {
    wanted: BTreeMap<&'r str, usize>,
    materials: Vec<Option<Value>>,
    pictures: ObjPictures<'a, 'b>,
    /// The libraries that were tried, by their paths below the folder.
    tried: BTreeSet<String>,
    is_any_read: bool,
    /// The number of bytes that materials may still take; `None` if they took too many.
    left: Option<u64>,
    notes: NamedNotes,
}

impl LibraryReader<'_, '_, '_> {
    /// Reads the libraries of a statement: one with spaces in its name, or several.
    fn statement(&mut self, rest: &str) {
        // First as one name, since names may have spaces.
        let Err(error) = self.library(rest) else { return };
        let names = names_of(rest);
        let (mut missing, mut n_found) = (Vec::new(), 0);
        for name in &names {
            let parts: Vec<&str> = name.split_whitespace().collect();
            let result = if *name == rest { None } else { Some(self.library(name)) };
            match result {
                Some(Ok(())) => n_found += 1,
                // A name with spaces, or several names without the ending `.mtl`.
                _ if parts.len() > 1 => {
                    for part in parts {
                        match self.library(part) {
                            Ok(()) => n_found += 1,
                            Err(error) => missing.push(error),
                        }
                    }
                }
                Some(Err(error)) => missing.push(error),
                None => {}
            }
        }
        // The whole was one name after all; the error of its pieces would only confuse.
        if n_found == 0 && names.len() < 2 {
            missing = vec![error];
        }
        missing.into_iter().for_each(|(code, what, name)| self.notes.add(code, what, &name));
    }

    /// Reads a library, once.
    ///
    /// # Errors
    /// The note to report if the library is not available.
    fn library(&mut self, name: &str) -> Result<(), (&'static str, &'static str, String)> {
        let bare = name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name);
        let inside = files::resolve_path("", bare).ok();
        let is_outside = inside.is_none();
        // If a path leads out of the folder, only its file name is used.
        let by_name =
            || if bare.contains("://") { None } else { files::resolve_path("", file_name(bare)).ok() };
        let Some(path) = inside.or_else(by_name) else {
            let what = "material libraries outside the folder were skipped";
            return Err(("mtllib-outside", what, name.to_owned()));
        };
        if self.tried.contains(&path) {
            return Ok(());
        }
        let bytes = self.pictures.files.read(&path).map_err(|why| {
            if is_outside {
                let what = "material libraries outside the folder were skipped";
                return ("mtllib-outside", what, name.to_owned());
            }
            let what = "material libraries could not be read; materials keep their names";
            ("mtllib-missing", what, format!("{name} ({why})"))
        })?;
        if is_outside {
            self.notes.add(FOUND_BY_NAME, FOUND_BY_NAME_TEXT, name);
        }
        // Counted before its materials are converted: they may take memory in proportion to it.
        self.left = self.left.map(|left| left.saturating_add(PER_BYTE * bytes.len() as u64));
        self.tried.insert(path.clone());
        match text_of(&bytes) {
            Ok(text) => {
                self.is_any_read = true;
                self.materials(text, &path);
            }
            Err(error) => {
                let what = "material libraries are no text; materials keep their names";
                self.notes.add("mtllib-unreadable", what, &format!("{path} ({error})"));
            }
        }
        Ok(())
    }

    fn materials(&mut self, text: &[u8], library: &str) {
        let mut reader = MtlReader::new(text, library);
        loop {
            let Self { wanted, materials, notes, .. } = self;
            let is_wanted = |name: &str| wanted.get(name).is_some_and(|at| materials[*at].is_none());
            let Some(material) = reader.next(is_wanted, notes) else { return };
            let Some(at) = self.wanted.get(material.name.as_str()).copied() else {
                let what = "materials that no face has were left out";
                self.notes.add("materials-unused", what, &material.name);
                continue;
            };
            if self.materials[at].is_some() {
                let what = "materials are described twice: the first description was taken";
                self.notes.add("material-twice", what, &material.name);
                continue;
            }
            let bytes = MATERIAL_BYTES + STATEMENT_BYTES * material.values.len() as u64;
            if !self.charge(bytes) {
                return;
            }
            let mut converter =
                MtlConverter { pictures: &mut self.pictures, library, notes: &mut self.notes };
            self.materials[at] = Some(converter.convert(&material));
        }
    }

    /// Whether `bytes` more may be taken.
    fn charge(&mut self, bytes: u64) -> bool {
        self.left = self.left.and_then(|left| left.checked_sub(bytes));
        self.left.is_some()
    }

    /// A material for each name; `None` if no library could be read, or all would take too much memory.
    fn all_materials(&mut self, names: &[String]) -> Option<Vec<Value>> {
        if !self.is_any_read {
            return None;
        }
        let mut materials = std::mem::take(&mut self.materials);
        for (name, material) in names.iter().zip(&mut materials) {
            if material.is_none() && self.charge(MATERIAL_BYTES) {
                let what = "materials that no library describes are plain";
                self.notes.add("material-missing", what, name);
                *material = Some(plain_material(name));
            }
        }
        if self.left.is_none() {
            let what = "descriptions of materials would take too much memory; materials keep their names";
            self.notes.add("materials-skipped", what, &format!("{} materials", names.len()));
        }
        self.left.is_some().then(|| materials.into_iter().flatten().collect())
    }
}

/// The names in a statement; a name with spaces must end in `.mtl`.
fn names_of(rest: &str) -> Vec<&str> {
    let mut names = Vec::new();
    let mut start = 0;
    for (at, _) in rest.match_indices(char::is_whitespace) {
        // A name may end only at its extension.
        let name = rest[start..at].trim();
        if name.len() > EXTENSION.len()
            && name.as_bytes()[name.len() - EXTENSION.len()..].eq_ignore_ascii_case(EXTENSION.as_bytes())
        {
            names.push(name);
            start = at;
        }
    }
    names.push(rest[start..].trim());
    names.retain(|name| !name.is_empty());
    names
}

const EXTENSION: &str = ".mtl";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_libraries_may_have_spaces() {
        assert_eq!(names_of("a b.mtl"), ["a b.mtl"]);
        assert_eq!(names_of("a.mtl b c.MTL d"), ["a.mtl", "b c.MTL", "d"]);
        assert_eq!(names_of(".mtl x"), [".mtl x"]);
        assert_eq!(names_of("  "), [""; 0]);
    }
}
