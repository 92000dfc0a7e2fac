//! `ModelPackage`: the parts of a 3MF file by name, and the relationships between them.
use super::namespace::{ModelElements, ModelNamespace};
use crate::text::show;
use crate::unpack_cap::UnpackCap;
use crate::warnings::Warnings;
use crate::xml_elements::{XmlElements, XmlStep};
use crate::zip::directory::{ZipDirectory, ZipNames, unsafe_name};
use crate::zip::unpack::ZipUnpacker;
use crate::{FileLocation, Limits, ReadError};

/// The list of the parts' content types, which every package has.
pub(super) const CONTENT_TYPES: &str = "[Content_Types].xml";
/// The relationships of the package as a whole.
pub(super) const ROOT_RELATIONSHIPS: &str = "_rels/.rels";
/// The type of the relationship to the model.
pub(super) const MODEL_RELATIONSHIP: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
/// The usual name of the model.
pub(super) const MODEL: &str = "3D/3dmodel.model";

/// A 3MF file.
pub(super) struct ModelPackage<'a> {
    directory: ZipDirectory,
    unpacker: ZipUnpacker<'a>,
    is_used: Vec<bool>,
    limits: &'a Limits,
}

/// An entry in a part with relationships.
struct PartRelationship {
    kind: String,
    target: String,
    place: FileLocation,
}

impl<'a> ModelPackage<'a> {
    /// Opens a file.
    ///
    /// # Errors
    /// As for [`ZipDirectory::read`].
    pub(super) fn new(bytes: &'a [u8], limits: &'a Limits) -> Result<Self, ReadError> {
        let directory = ZipDirectory::read(bytes, ZipNames::AnyCase)?;
        let is_used = vec![false; directory.entries.len()];
        Ok(Self { directory, unpacker: ZipUnpacker::new(bytes, UnpackCap::MODEL, limits), is_used, limits })
    }

    /// The name of the part that the package declares as the model.
    ///
    /// # Errors
    /// If there is none, or a relationship leads out of the package.
    pub(super) fn model(&mut self, warnings: &mut Warnings) -> Result<String, ReadError> {
        match self.directory.find(CONTENT_TYPES) {
            Some(entry) => self.is_used[entry] = true,
            None => warnings.count("no-content-types", || {
                (
                    FileLocation::File,
                    format!("the package does not say what its parts are: no {CONTENT_TYPES}"),
                )
            }),
        }
        let relationships = self.relationships("")?;
        if let Some(relationship) = relationships.iter().find(|r| r.kind == MODEL_RELATIONSHIP) {
            return part_name("", &relationship.target).map_err(|what| {
                let message = format!(
                    "{ROOT_RELATIONSHIPS}: the model {} {what}",
                    show(relationship.target.as_bytes())
                );
                ReadError::new("external-link", relationship.place.clone(), message)
            });
        }
        if self.directory.find(MODEL).is_none() {
            let message = "the package names no 3D model: this is a zip file of another kind";
            return Err(ReadError::new("not-3mf", FileLocation::File, message));
        }
        warnings.count("no-model-relationship", || {
            (FileLocation::File, format!("the package names no model, and {MODEL} was taken for it"))
        });
        Ok(MODEL.to_owned())
    }

    /// The text of a part whose relationships stay in the package.
    ///
    /// # Errors
    /// If it is missing, cannot be unpacked, or has a relationship to something outside.
    pub(super) fn model_text(&mut self, part: &str, place: &FileLocation) -> Result<Vec<u8>, ReadError> {
        self.relationships(part)?;
        let Some(entry) = self.directory.find(part) else {
            let message = format!("the part {} is not in the package", show(part.as_bytes()));
            return Err(ReadError::new("missing-part", place.clone(), message));
        };
        self.is_used[entry] = true;
        self.unpacker.unpack(&self.directory.entries[entry])
    }

    /// The relationships of a part, or of the package for the empty name. Empty if there is no such part.
    fn relationships(&mut self, part: &str) -> Result<Vec<PartRelationship>, ReadError> {
        let (folder, file) = part.rsplit_once('/').map_or(("", part), |(folder, file)| (folder, file));
        let between = if folder.is_empty() { "" } else { "/" };
        let name = format!("{folder}{between}_rels/{file}.rels");
        let Some(entry) = self.directory.find(&name) else { return Ok(Vec::new()) };
        self.is_used[entry] = true;
        let bytes = self.unpacker.unpack(&self.directory.entries[entry])?;
        let text = crate::xml_text::text_of(&bytes)?;
        let mut elements: ModelElements = XmlElements::new(text, &name, self.limits);
        let mut relationships = Vec::new();
        while let Some(step) = elements.next()? {
            let XmlStep::Start(element) = step else { continue };
            if element.local != "Relationship" || element.namespace != ModelNamespace::Relationships {
                continue;
            }
            let target = elements.need("Target")?.to_owned();
            if elements.get("TargetMode").is_some_and(|mode| mode.eq_ignore_ascii_case("External")) {
                let message = format!(
                    "the link {} leaves the package, and nothing is fetched",
                    show(target.as_bytes())
                );
                return Err(elements.error("external-link", message));
            }
            let kind = elements.get("Type").unwrap_or("").to_owned();
            relationships.push(PartRelationship { kind, target, place: elements.place() });
        }
        Ok(relationships)
    }

    /// Counts the parts that were never read.
    pub(super) fn count_ignored(&self, warnings: &mut Warnings) {
        for (entry, _) in self.directory.entries.iter().zip(&self.is_used).filter(|(_, used)| !**used) {
            let extension = entry.name.rsplit('.').next().unwrap_or("").to_ascii_lowercase();
            let (code, what) = match extension.as_str() {
                "png" | "jpg" | "jpeg" => ("pictures-ignored", "pictures in the package were not kept"),
                "rels" => continue,
                "model" => ("models-ignored", "models that nothing refers to were not read"),
                _ => ("parts-ignored", "other parts of the package (settings, scripts) were not read or run"),
            };
            warnings.count(code, || {
                let message = format!("{what}, {} first", show(entry.name.as_bytes()));
                (FileLocation::File, message)
            });
        }
    }
}

/// The absolute name of the part that a reference in another part points to.
///
/// # Errors
/// The error in the reference.
pub(super) fn part_name(from: &str, target: &str) -> Result<String, &'static str> {
    let name = match target.strip_prefix('/') {
        Some(absolute) => absolute.to_owned(),
        None => match from.rsplit_once('/') {
            Some((folder, _)) => format!("{folder}/{target}"),
            None => target.to_owned(),
        },
    };
    // With a colon in its first segment, a reference is a URI with a scheme.
    let first = target.split('/').next().unwrap_or("");
    if first.contains(':') {
        return Err("leaves the package, and nothing is fetched");
    }
    match unsafe_name(&name) {
        Some(what) => Err(what),
        None => Ok(name),
    }
}
