//! The joint weights and morph targets of a mesh as they read back from glTF.
use super::VertexStorage;
use super::deformation::{IN_A_SET, short_weights, skin_sets, weights_of};
use chordal::Mesh;
use chordal::explicit::{Attribute, InvalidMesh, Semantic};

/// A mesh with its joint weights and morph targets as they read back from glTF: only the heaviest joints of
/// each vertex, with weights that sum to 1, in single precision, or in 16 bits if the storage is quantized.
///
/// # Errors
/// None for a valid mesh: an error means that the mesh was invalid before.
pub fn round_deformation(mesh: &Mesh, storage: Option<&VertexStorage>) -> Result<Mesh, InvalidMesh> {
    let mut sets = skin_sets(mesh);
    let short = if storage.is_some() { short_weights(&mut sets) } else { Vec::new() };
    let followed = weights_of(mesh);
    let mut rounded = Mesh::new(mesh.positions().to_vec(), mesh.faces().to_vec())?;
    if let Some(ids) = mesh.position_id() {
        rounded = rounded.with_position_id(ids.to_vec())?;
    }
    for attribute in mesh.attributes() {
        let mut values = attribute.values.clone();
        match &attribute.semantic {
            Semantic::Blended(name) if name.starts_with("morph target ") => {
                values.iter_mut().for_each(|x| *x = f64::from(*x as f32));
            }
            Semantic::Blended(_) => {
                let own = followed.iter().find(|(.., own)| std::ptr::eq(*own, attribute));
                let first = own.map_or(usize::MAX, |(first, ..)| *first);
                // The sets may have fewer joints at a vertex than the attribute; what they left out
                // is 0 in the file.
                if own.is_some() {
                    values.fill(0.0);
                }
                for (s, set) in sets.iter().enumerate() {
                    for (at, (joint, weight)) in set.joints.iter().zip(&set.weights).enumerate() {
                        let column = usize::from(*joint).checked_sub(first);
                        let Some(column) = column.filter(|column| *column < attribute.width) else {
                            continue;
                        };
                        let weight = short
                            .get(s)
                            .map_or(f64::from(*weight), |short| f64::from(short[at]) / f64::from(u16::MAX));
                        values[at / IN_A_SET * attribute.width + column] += weight;
                    }
                }
            }
            _ => {}
        }
        rounded = rounded.with_attribute(Attribute { values, ..attribute.clone() })?;
    }
    Ok(rounded)
}
