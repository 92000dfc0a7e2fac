//! All placements of a scene's parts as one mesh in world coordinates.
use super::placements::parts_in_order;
use crate::output::file_rows::unsupported;
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic, Topology, position_id_by_bits};
use chordal_io::{Scene, WriteError};
use std::borrow::Cow;

/// All placements of a scene as one mesh in world coordinates, for rendering: with normals if every part has some, and
/// without any other attribute.
///
/// # Errors
/// When the nodes are no tree, take coordinates out of range, or show more than one mesh can hold.
pub(crate) fn one_mesh(scene: &Scene) -> Result<Cow<'_, Mesh>, WriteError> {
    let mut placed = scene.world_meshes()?;
    if placed.len() == 1 {
        return Ok(placed.remove(0).1);
    }
    let meshes: Vec<&Mesh> = placed.iter().map(|(_, mesh)| mesh.as_ref()).collect();
    let mesh = concatenated(&meshes)?;
    let normals: Option<Vec<_>> = meshes.iter().map(|mesh| corner_normals(mesh)).collect();
    let Some(normals) = normals else { return Ok(Cow::Owned(mesh)) };
    let attribute =
        Attribute { semantic: Semantic::Normal, domain: Domain::Corner, width: 3, values: normals.concat() };
    mesh.with_attribute(attribute).map(Cow::Owned).map_err(unsupported)
}

/// All placements as one mesh in world coordinates, with the faces of each.
pub(crate) struct MergedParts {
    /// Its indices tie only equal positions within the same part.
    pub mesh: Mesh,
    /// The part of each placement, with its first face, in the order of the faces.
    pub places: Vec<(usize, u32)>,
}

impl MergedParts {
    /// Merges all placements.
    ///
    /// # Errors
    /// As [`one_mesh`].
    pub fn from_scene(scene: &Scene, topology: Topology) -> Result<Self, WriteError> {
        let mut meshes = Vec::new();
        let (mut places, mut first) = (Vec::new(), 0);
        for ((_, mesh), part) in scene.world_meshes()?.into_iter().zip(parts_in_order(scene)) {
            places.push((part, first));
            first += mesh.faces().len() as u32;
            let mesh = mesh.into_owned();
            let welded = match topology {
                Topology::Indices => mesh,
                Topology::Positions => weld_exact(&mesh)?,
            };
            meshes.push(welded);
        }
        let mesh = concatenated(&meshes.iter().collect::<Vec<_>>())?;
        Ok(Self { mesh, places })
    }

    /// The placement of a face.
    pub fn place_of(&self, face: u32) -> usize {
        // The last that starts at or before the face: placements without faces start where the next one does.
        self.places.partition_point(|(_, first)| *first <= face) - 1
    }

    /// The part of a face, and the face's index there.
    pub fn in_part(&self, face: u32) -> (usize, u32) {
        let (part, first) = self.places[self.place_of(face)];
        (part, face - first)
    }
}

/// The same faces, with each corner at the first row of equal coordinates.
fn weld_exact(mesh: &Mesh) -> Result<Mesh, WriteError> {
    let ids = position_id_by_bits(mesh.positions());
    let faces = mesh.faces().iter().map(|face| face.map(|row| ids[row as usize])).collect();
    Mesh::new(mesh.positions().to_vec(), faces).map_err(unsupported)
}

/// The normals at the corners of every face, if the mesh has any.
fn corner_normals(mesh: &Mesh) -> Option<Vec<f64>> {
    let normals = mesh.attribute(&Semantic::Normal).filter(|normals| normals.width == 3)?;
    let row = |face: usize, k: usize| match normals.domain {
        Domain::Vertex => mesh.faces()[face][k] as usize,
        Domain::Corner => 3 * face + k,
        Domain::Face => face,
    };
    let corners = (0..mesh.faces().len()).flat_map(|face| [0, 1, 2].map(|k| row(face, k)));
    Some(corners.flat_map(|row| normals.row(row).iter().copied()).collect())
}

/// Concatenates the positions and faces of all meshes; positions stay tied as in each.
pub(crate) fn concatenated(meshes: &[&Mesh]) -> Result<Mesh, WriteError> {
    let (mut positions, mut faces, mut ids) = (Vec::new(), Vec::new(), Vec::new());
    for mesh in meshes {
        // Saturated indices mean more positions than a mesh may have, which `Mesh::new` then refuses.
        let first = u32::try_from(positions.len()).unwrap_or(u32::MAX);
        faces.extend(mesh.faces().iter().map(|face| face.map(|i| first.saturating_add(i))));
        let n = mesh.positions().len() as u32;
        ids.extend((0..n).map(|i| first.saturating_add(mesh.position_of(i))));
        positions.extend_from_slice(mesh.positions());
    }
    Mesh::new(positions, faces).and_then(|mesh| mesh.with_position_id(ids)).map_err(unsupported)
}
