//! Reads 3MF.
use super::build::NodeBuilder;
use super::model::{ModelReader, ModelSet};
use super::package::ModelPackage;
use super::properties::MATERIAL;
use crate::zip::directory::{LOCAL, ZipDirectory, ZipNames};
use crate::{Axis, Content, FileLocation, Frame, Limits, ReadError, ReadOutcome, Scene};
use chordal::explicit::Semantic;

/// Reads a 3MF file: each mesh becomes a part, each item and component a node.
///
/// Positions are exactly the numbers of the file, in its unit; z is up. Base materials and colour groups
/// become the colours of corners, as sRGB bytes divided by 255, and materials also the face attribute
/// `Group("material")`, with their names in [`Scene::groups`]. Objects in other model parts of the package
/// (production extension) are read. Textures, composites, slices and beam lattices are counted as warnings,
/// and so are all other parts of the package: settings and scripts are neither read nor run. The certificate
/// is a metadata entry.
///
/// A package may unpack to at most 1 GiB, an entry to 512 MiB, and above 16 MiB to at most 200 times its
/// packed bytes; a package has at most 10,000 entries.
///
/// # Errors
/// [`ReadError`] with the byte of the package, or the line and column of the part that the message names, if
/// the package is damaged, exceeds a limit, or has names that are repeated or lead out of it; a part is not
/// XML or has a document type; a referenced object, property or part is missing; an object is a component of
/// itself; a link leaves the package; or an extension that changes the shape is required.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Content, Frame, Limits, Scene, threemf};
/// let mesh = Mesh::new(vec![[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let frame = Frame { metres_per_unit: Some(0.001), ..Frame::default() };
/// let mut file = Vec::new();
/// threemf::write(&Scene::from_mesh("part", mesh.clone(), frame), None, &mut file)?;
/// let Content::Scene(scene) = threemf::read(&file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!((&scene.parts[0].mesh, &*scene.parts[0].name), (&mesh, "part"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source: 3MF Consortium, *3D Manufacturing Format: Core Specification and Reference Guide* 1.3, 2021;
/// *Materials and Properties Extension* 1.2; *Production Extension* 1.1; ECMA-376-2, *Open Packaging
/// Conventions*, 2021.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut set = ModelSet::default();
    let mut package = ModelPackage::new(bytes, limits)?;
    let root = package.model(&mut set.warnings)?;
    set.document(&root, FileLocation::File);
    let mut documents = Vec::new();
    // Models name further models while they are read, so the list grows.
    while documents.len() < set.documents.len() {
        let number = documents.len();
        let (name, place) = (set.documents[number].clone(), set.places[number].clone());
        let bytes = package.model_text(&name, &place)?;
        let text = crate::xml_text::text_of(&bytes)
            .map_err(|error| ReadError { message: format!("{name}: {}", &*error.message).into(), ..error })?;
        documents.push(ModelReader::new(text, number as u32, &name, limits, &mut set).read()?);
    }
    let (first, others) = match documents.split_first() {
        Some((first, others)) => (Some(first), others),
        None => (None, &[][..]),
    };
    let metres_per_unit = first.map(|first| first.metres_per_unit);
    for (other, name) in others.iter().zip(&set.documents[1..]) {
        if Some(other.metres_per_unit) != metres_per_unit {
            let message = format!("{name}: the model has another unit than the root model");
            return Err(ReadError::new("units-differ", FileLocation::File, message));
        }
    }
    let mut scene = Scene {
        frame: Frame { up: Some(Axis::Z), metres_per_unit, ..Frame::default() },
        certificate: first.and_then(|first| first.certificate.clone()),
        ..Scene::default()
    };
    NodeBuilder::new(&set, &documents)?.nodes(&mut scene)?;
    let n_items: usize = others.iter().map(|other| other.items.len()).sum();
    set.warnings.count_all(
        "items-ignored",
        n_items as u64,
        "items of other models than the root are not built",
    );
    let ModelSet { parts, materials, mut warnings, .. } = set;
    scene.parts = parts;
    let mut is_shown = vec![false; scene.parts.len()];
    scene.nodes.iter().filter_map(|node| node.part).for_each(|part| is_shown[part] = true);
    let n_unseen = is_shown.iter().filter(|shown| !**shown).count();
    warnings.count_all("objects-not-shown", n_unseen as u64, "the build does not show all meshes");
    let semantic = Semantic::Group(MATERIAL.to_owned());
    if scene.parts.iter().any(|part| part.mesh.attribute(&semantic).is_some()) {
        let names = std::iter::once(String::new()).chain(materials).collect();
        scene.groups.insert(MATERIAL.to_owned(), names);
    }
    package.count_ignored(&mut warnings);
    Ok(ReadOutcome { content: Content::Scene(scene), warnings: warnings.into_list() })
}

/// Whether the content is a zip file with a model, and not another kind of zip file.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    /// The bytes that are searched for names if the end of the file, with the directory, is missing.
    const LOOKED_AT: usize = 4096;
    if !bytes.starts_with(LOCAL) {
        return false;
    }
    match ZipDirectory::read(bytes, ZipNames::AnyCase) {
        Ok(directory) => directory.entries.iter().any(|entry| is_model(&entry.name)),
        Err(_) => {
            let head = &bytes[..bytes.len().min(LOOKED_AT)];
            memchr::memmem::find(head, b"3D/").is_some()
        }
    }
}

fn is_model(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    name.starts_with("3d/") || name.ends_with(".model")
}
