//! Puts meshes together as one, with the attributes of their vertices, corners and faces.
use super::merged_parts::concatenated;
use crate::output::file_rows::unsupported;
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal_io::WriteError;

/// Several meshes as one.
pub(crate) struct MergedMesh {
    pub mesh: Mesh,
    /// Whether an attribute was left out: some meshes lack it, and it has no default value.
    pub is_partial: bool,
}

/// Concatenates meshes with their attributes. If some lack an attribute, colours are white there, texture coordinates and
/// groups zero; any other attribute is left out.
///
/// # Errors
/// If there are more rows than one mesh can hold.
pub(crate) fn merge(meshes: &[&Mesh]) -> Result<MergedMesh, WriteError> {
    let mut mesh = concatenated(meshes)?;
    let mut is_partial = false;
    let mut semantics: Vec<&Semantic> = Vec::new();
    for attribute in meshes.iter().flat_map(|mesh| mesh.attributes()) {
        if !semantics.contains(&&attribute.semantic) {
            semantics.push(&attribute.semantic);
        }
    }
    for semantic in semantics {
        match merged_attribute(meshes, semantic) {
            Some(attribute) => mesh = mesh.with_attribute(attribute).map_err(unsupported)?,
            None => is_partial = true,
        }
    }
    Ok(MergedMesh { mesh, is_partial })
}

/// One attribute of all meshes; `None` if it cannot be completed.
fn merged_attribute(meshes: &[&Mesh], semantic: &Semantic) -> Option<Attribute> {
    let attributes: Vec<Option<&Attribute>> = meshes.iter().map(|mesh| mesh.attribute(semantic)).collect();
    let filling = match semantic {
        Semantic::Color(_) => Some(1.0),
        Semantic::TexCoord(_) | Semantic::Group(_) => Some(0.0),
        Semantic::Normal | Semantic::Tangent | Semantic::Custom(_) | Semantic::Blended(_) => None,
    };
    let present = || attributes.iter().flatten();
    let width = present().map(|attribute| attribute.width).max()?;
    // A colour without alpha is opaque; other attributes of different widths have different meanings.
    let is_color = matches!(semantic, Semantic::Color(_));
    if present().any(|attribute| attribute.width != width && !is_color) {
        return None;
    }
    if filling.is_none() && attributes.iter().any(Option::is_none) {
        return None;
    }
    let first = present().next()?.domain;
    let domain = if present().all(|attribute| attribute.domain == first) { first } else { Domain::Corner };
    let mut values = Vec::new();
    for (mesh, attribute) in meshes.iter().zip(&attributes) {
        let n_rows = match domain {
            Domain::Vertex => mesh.positions().len(),
            Domain::Corner => 3 * mesh.faces().len(),
            Domain::Face => mesh.faces().len(),
        };
        let Some(attribute) = attribute else {
            values.resize(values.len() + n_rows * width, filling.unwrap_or_default());
            continue;
        };
        for row in 0..n_rows {
            let row_values = attribute.row(source_row(mesh, attribute.domain, domain, row));
            values.extend_from_slice(row_values);
            // Only rows of colours are ever shorter than the width, by their alpha: they are opaque.
            values.resize(values.len() + width - row_values.len(), 1.0);
        }
    }
    Some(Attribute { semantic: semantic.clone(), domain, width, values })
}

/// The row of an attribute's domain `from` for a row of `domain`, which is the same or the corners.
fn source_row(mesh: &Mesh, from: Domain, domain: Domain, row: usize) -> usize {
    match from {
        from if from == domain => row,
        Domain::Vertex => mesh.faces()[row / 3][row % 3] as usize,
        Domain::Corner => row,
        Domain::Face => row / 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(z: f64) -> Mesh {
        Mesh::new(vec![[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]], vec![[0, 1, 2]]).unwrap()
    }

    fn with(mesh: Mesh, semantic: Semantic, domain: Domain, width: usize, values: &[f64]) -> Mesh {
        mesh.with_attribute(Attribute { semantic, domain, width, values: values.to_vec() }).unwrap()
    }

    #[test]
    fn what_one_mesh_lacks_is_white_or_zero_and_what_has_no_usual_value_is_left_out() {
        let colors = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
        let a = with(triangle(0.0), Semantic::Color(0), Domain::Vertex, 3, &colors);
        let a = with(a, Semantic::Group("material".into()), Domain::Face, 1, &[2.0]);
        let a = with(a, Semantic::Custom("_HEAT".into()), Domain::Vertex, 1, &[1.0, 2.0, 3.0]);
        let b = with(triangle(1.0), Semantic::TexCoord(0), Domain::Vertex, 2, &[0.5; 6]);
        let merged = merge(&[&a, &b]).unwrap();
        assert!(merged.is_partial);
        let values = |semantic| merged.mesh.attribute(&semantic).map(|attribute| attribute.values.clone());
        assert_eq!(values(Semantic::Color(0)).unwrap(), [&colors[..], &[1.0; 9]].concat());
        assert_eq!(values(Semantic::Group("material".into())).unwrap(), [2.0, 0.0]);
        assert_eq!(values(Semantic::TexCoord(0)).unwrap(), [[0.0; 6], [0.5; 6]].concat());
        assert_eq!(values(Semantic::Custom("_HEAT".into())), None);
    }

    #[test]
    fn one_attribute_at_vertices_here_and_at_corners_there_is_at_corners() {
        let a = with(triangle(0.0), Semantic::Color(0), Domain::Vertex, 3, &[0.25; 9]);
        let b = with(triangle(1.0), Semantic::Color(0), Domain::Face, 4, &[0.5, 0.5, 0.5, 0.75]);
        let merged = merge(&[&a, &b]).unwrap();
        let color = merged.mesh.attribute(&Semantic::Color(0)).unwrap();
        assert_eq!((color.domain, color.width), (Domain::Corner, 4));
        assert_eq!(color.row(0), [0.25, 0.25, 0.25, 1.0]);
        assert_eq!(color.row(5), [0.5, 0.5, 0.5, 0.75]);
    }
}
