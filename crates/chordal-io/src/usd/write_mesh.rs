//! Writes a part as a mesh of USD: points, faces, normals, colours, texture coordinates and subsets.
use super::write_material::UsdMaterialWriter;
use super::write_text::{UsdNames, UsdaWriter, display_name, quoted, transform, tuple};
use crate::instances::first_rows;
use crate::{Frame, MATERIAL, Node, TextureOrigin, WriteError};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use std::collections::BTreeMap;

/// A part and the context for writing it.
pub(super) struct UsdPartRequest<'a> {
    pub mesh: &'a Mesh,
    pub frame: &'a Frame,
    pub subsets: &'a UsdSubsets<'a>,
    pub node: &'a Node,
}

/// The groups of faces of a mesh.
pub(super) struct UsdSubsets<'a> {
    list: Vec<UsdSubset<'a>>,
    /// The material of all faces, if there is a single one.
    material_of_all: Option<usize>,
    is_double_sided: bool,
}

/// Faces of one group.
struct UsdSubset<'a> {
    kind: &'a str,
    name: String,
    faces: Vec<usize>,
    /// The index of its material, from 0 on.
    material: Option<usize>,
}

impl<'a> UsdSubsets<'a> {
    /// The groups in the attributes of faces.
    pub(super) fn new(
        attributes: &'a [Attribute],
        names: &'a BTreeMap<String, Vec<String>>,
        materials: &UsdMaterialWriter<'_>,
    ) -> Self {
        let mut subsets = Self { list: Vec::new(), material_of_all: None, is_double_sided: false };
        for attribute in attributes {
            let Semantic::Group(kind) = &attribute.semantic else { continue };
            if attribute.domain != Domain::Face || attribute.width != 1 {
                continue;
            }
            let mut faces: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
            for (face, number) in attribute.values.iter().enumerate() {
                faces.entry(*number as u64).or_default().push(face);
            }
            let n_groups = faces.len();
            for (number, faces) in faces.into_iter().filter(|(number, _)| *number > 0) {
                let material =
                    Some(number as usize - 1).filter(|at| kind == MATERIAL && *at < materials.names.len());
                subsets.is_double_sided |= material.is_some_and(|at| materials.is_double_sided(at));
                // Group 0 was counted as well, so a single group has all faces.
                if n_groups == 1 && material.is_some() {
                    subsets.material_of_all = material;
                    continue;
                }
                let name = names.get(kind).and_then(|names| names.get(number as usize));
                let name = name.cloned().unwrap_or_else(|| format!("{kind}_{number}"));
                subsets.list.push(UsdSubset { kind, name, faces, material });
            }
        }
        subsets
    }

    /// The metadata of the prim.
    pub(super) fn about(&self) -> Option<String> {
        let is_bound = self.material_of_all.is_some();
        is_bound.then(|| "prepend apiSchemas = [\"MaterialBindingAPI\"]".to_owned())
    }

    /// Writes the bindings and the subsets.
    pub(super) fn write(
        &self,
        materials: &UsdMaterialWriter<'_>,
        writer: &mut UsdaWriter<'_>,
    ) -> Result<(), WriteError> {
        if self.is_double_sided {
            writer.line("uniform bool doubleSided = 1")?;
        }
        if let Some(path) = self.material_of_all.and_then(|material| materials.path(material)) {
            writer.line(&format!("rel material:binding = <{path}>"))?;
        }
        // A face has one number of each kind, so the subsets of a family never overlap.
        let mut families: Vec<&str> = Vec::new();
        for subset in &self.list {
            let family = if subset.material.is_some() { "materialBind" } else { subset.kind };
            if !families.contains(&family) && is_identifier(family) {
                families.push(family);
                let name = format!("subsetFamily:{family}:familyType");
                writer.line(&format!("uniform token {name} = \"nonOverlapping\""))?;
            }
        }
        let mut names = UsdNames::default();
        for subset in &self.list {
            let name = names.unique(&subset.name, "Subset");
            let mut about = display_name(&subset.name, &name);
            let path = subset.material.and_then(|material| materials.path(material));
            if path.is_some() {
                about.push("prepend apiSchemas = [\"MaterialBindingAPI\"]".to_owned());
            }
            writer.open("GeomSubset", &name, &about)?;
            writer.line("uniform token elementType = \"face\"")?;
            let family = if path.is_some() { "materialBind" } else { subset.kind };
            writer.line(&format!("uniform token familyName = {}", quoted(family)))?;
            writer.rows("int[] indices", 1, subset.faces.iter().map(|face| *face as f64), "")?;
            if let Some(path) = path {
                writer.line(&format!("rel material:binding = <{path}>"))?;
            }
            writer.close()?;
        }
        Ok(())
    }
}

/// Whether a word is allowed in the name of an attribute.
fn is_identifier(word: &str) -> bool {
    word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && !word.starts_with(|c: char| c.is_ascii_digit())
}

/// Writes the content of a part's prim.
pub(super) fn part(
    request: &UsdPartRequest<'_>,
    materials: &UsdMaterialWriter<'_>,
    writer: &mut UsdaWriter<'_>,
) -> Result<(), WriteError> {
    let mesh = request.mesh;
    writer.line("uniform token subdivisionScheme = \"none\"")?;
    transform(&request.node.matrix, writer)?;
    let first = first_rows(mesh);
    let mut numbers = vec![0_u32; first.len()];
    let mut points = Vec::new();
    for (row, first) in first.iter().enumerate() {
        if *first as usize == row {
            numbers[row] = points.len() as u32;
            points.push(mesh.positions()[row]);
        } else {
            numbers[row] = numbers[*first as usize];
        }
    }
    extent(mesh, writer)?;
    writer.rows("point3f[] points", 3, points.as_flattened().iter().copied(), "")?;
    writer.rows("int[] faceVertexCounts", 1, mesh.faces().iter().map(|_| 3.0), "")?;
    let corners = mesh.faces().as_flattened().iter().map(|row| f64::from(numbers[*row as usize]));
    writer.rows("int[] faceVertexIndices", 1, corners, "")?;
    let is_split = points.len() < first.len();
    for attribute in mesh.attributes() {
        stream(request, attribute, is_split, writer)?;
    }
    request.subsets.write(materials, writer)
}

/// Writes the box of a mesh.
fn extent(mesh: &Mesh, writer: &mut UsdaWriter<'_>) -> Result<(), WriteError> {
    let bounds = mesh.bounds();
    if bounds.is_empty() {
        return Ok(());
    }
    writer.line(&format!("float3[] extent = [{}, {}]", tuple(&bounds.min), tuple(&bounds.max)))
}

/// Writes normals, colours or texture coordinates.
fn stream(
    request: &UsdPartRequest<'_>,
    attribute: &Attribute,
    is_split: bool,
    writer: &mut UsdaWriter<'_>,
) -> Result<(), WriteError> {
    let Attribute { semantic, domain, width, values } = attribute;
    let (start, kept) = match (semantic, width) {
        (Semantic::Normal, 3) => ("normal3f[] primvars:normals".to_owned(), 3),
        (Semantic::Color(0), 3 | 4) => ("color3f[] primvars:displayColor".to_owned(), 3),
        (Semantic::TexCoord(0), 2) => ("texCoord2f[] primvars:st".to_owned(), 2),
        (Semantic::TexCoord(1), 2) => ("texCoord2f[] primvars:st1".to_owned(), 2),
        _ => return Ok(()),
    };
    // Rows at one position became one point, so values of vertices go to corners, by the index of
    // the old row.
    let is_by_row = *domain == Domain::Vertex && is_split;
    let interpolation = match domain {
        Domain::Vertex if !is_split => "vertex",
        Domain::Vertex | Domain::Corner => "faceVarying",
        Domain::Face => "uniform",
    };
    let end = format!(" (interpolation = \"{interpolation}\")");
    let turns = matches!(semantic, Semantic::TexCoord(_)) && request.frame.turns_v(TextureOrigin::LowerLeft);
    let value = |(at, x): (usize, &f64)| if turns && at % 2 == 1 { 1.0 - x } else { *x };
    let rows = values.chunks_exact(*width);
    let kept_values = rows.clone().flat_map(|row| row[..kept].iter().enumerate().map(value));
    writer.rows(&start, kept, kept_values, &end)?;
    let indices = |writer: &mut UsdaWriter<'_>, name: &str| {
        let rows = request.mesh.faces().as_flattened().iter().map(|row| f64::from(*row));
        writer.rows(&format!("int[] {name}:indices"), 1, rows, "")
    };
    let name = start.split(' ').nth(1).unwrap_or_default();
    if is_by_row {
        indices(writer, name)?;
    }
    if *width > kept {
        writer.rows("float[] primvars:displayOpacity", 1, rows.map(|row| row[3]), &end)?;
        if is_by_row {
            indices(writer, "primvars:displayOpacity")?;
        }
    }
    Ok(())
}
