//! Triangles in the rows of a format, so that counts match those of a reader of the file.
use chordal::Mesh;
use chordal::explicit::{InvalidMesh, position_id_by_bits};
use chordal_io::{Format, Scene, VertexRows, WriteError, for_vertex_caches, glb};
use std::borrow::Cow;

/// The scene in the rows of its file. glTF has separate vertices for corners with different attributes and materials, in an
/// order that graphics processors draw fast wherever the triangles come from. STL has separate vertices for every corner, a
/// single part and no attributes.
///
/// # Errors
/// If there are more rows than one mesh can hold.
pub(crate) fn to_file_rows(mut scene: Scene, to: Format) -> Result<Scene, WriteError> {
    match to.vertex_rows() {
        VertexRows::Soup => {
            let soup = soup(&scene)?;
            return Ok(Scene::from_triangle_soup("", soup, scene.frame));
        }
        VertexRows::Split => {
            for part in &mut scene.parts {
                let split = glb::split(&part.mesh).map_err(unsupported)?;
                let ordered = match for_vertex_caches(&split).map_err(unsupported)? {
                    Cow::Owned(ordered) => Some(ordered),
                    Cow::Borrowed(_) => None,
                };
                let new_mesh = match split {
                    Cow::Owned(split) => Some(ordered.unwrap_or(split)),
                    Cow::Borrowed(_) => ordered,
                };
                if let Some(mesh) = new_mesh {
                    part.mesh = mesh;
                }
            }
        }
        VertexRows::Mesh | VertexRows::Positions => {}
    }
    Ok(scene)
}

/// Puts the triangles that a verb has built into an order that graphics processors draw fast, whatever the format. Triangles
/// that pass through a verb unchanged keep the order of their file, which may have a meaning there.
///
/// # Errors
/// Never for parts of a scene: the error type allows a mesh to refuse attributes, and these were valid before.
pub(crate) fn order_new_triangles(scene: &mut Scene) -> Result<(), WriteError> {
    for part in &mut scene.parts {
        order_new_mesh(&mut part.mesh)?;
    }
    Ok(())
}

/// The same for one mesh.
pub(crate) fn order_new_mesh(mesh: &mut Mesh) -> Result<(), WriteError> {
    let ordered = match for_vertex_caches(mesh).map_err(unsupported)? {
        Cow::Owned(ordered) => ordered,
        Cow::Borrowed(_) => return Ok(()),
    };
    *mesh = ordered;
    Ok(())
}

/// The position rows of a mesh in a file of that format. OBJ has one row for tied positions, and its attributes have rows of
/// their own. GLB does not state which rows are tied, so that a reader ties rows with equal positions.
pub(crate) fn rows_of(mesh: &Mesh, format: Format) -> Result<Cow<'_, Mesh>, WriteError> {
    match (format.vertex_rows(), mesh.position_id()) {
        (VertexRows::Positions, Some(id)) => merged(mesh, id).map(Cow::Owned).map_err(unsupported),
        (VertexRows::Split, _) => tied_by_places(mesh).map_err(unsupported),
        _ => Ok(Cow::Borrowed(mesh)),
    }
}

/// The triangles with rows of equal positions tied; borrowed if these are tied already.
fn tied_by_places(mesh: &Mesh) -> Result<Cow<'_, Mesh>, InvalidMesh> {
    let ids = position_id_by_bits(mesh.positions());
    if (0..).zip(&ids).all(|(row, id)| mesh.position_of(row) == *id) {
        return Ok(Cow::Borrowed(mesh));
    }
    // Adding zero removes the sign of −0, which would make a different position.
    let positions = mesh.positions().iter().map(|p| p.map(|x| x + 0.0)).collect();
    Mesh::new(positions, mesh.faces().to_vec())?.with_position_id(ids).map(Cow::Owned)
}

pub(crate) fn unsupported(error: InvalidMesh) -> WriteError {
    WriteError::Unsupported(error.to_string())
}

fn merged(mesh: &Mesh, id: &[u32]) -> Result<Mesh, InvalidMesh> {
    let mut number = vec![u32::MAX; id.len()];
    let mut positions = Vec::new();
    for (row, id) in id.iter().enumerate() {
        let number = &mut number[*id as usize];
        if *number == u32::MAX {
            *number = positions.len() as u32;
            positions.push(mesh.positions()[row]);
        }
    }
    let faces = mesh.faces().iter().map(|face| face.map(|i| number[id[i as usize] as usize])).collect();
    Mesh::new(positions, faces)
}

fn soup(scene: &Scene) -> Result<Mesh, WriteError> {
    let meshes = || scene.parts.iter().map(|part| &part.mesh);
    let n_faces: usize = meshes().map(|mesh| mesh.faces().len()).sum();
    // Indices wrap only with more positions than a mesh may have, which `Mesh::new` then refuses.
    let faces = (0..n_faces as u32).map(|face| [0, 1, 2].map(|k| face.wrapping_mul(3).wrapping_add(k)));
    let corners = meshes().flat_map(|mesh| (0..mesh.faces().len()).flat_map(|face| mesh.corners(face)));
    Mesh::new(corners.collect(), faces.collect()).map_err(unsupported)
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_io::Frame;

    /// Two triangles sharing an edge, whose rows are doubled and tied, and an unused row.
    fn tied() -> Mesh {
        let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        Mesh::new(vec![a, b, c, b, c, d, d], vec![[0, 1, 2], [4, 3, 5]])
            .and_then(|mesh| mesh.with_position_id(vec![0, 1, 2, 1, 2, 5, 6]))
            .unwrap()
    }

    #[test]
    fn obj_has_one_row_for_rows_that_are_tied() {
        let mesh = tied();
        let rows = rows_of(&mesh, Format::Obj).unwrap();
        assert_eq!(rows.positions().len(), 5);
        assert_eq!(rows.faces(), [[0, 1, 2], [2, 1, 3]]);
        assert!(matches!(rows_of(&mesh, Format::Ply).unwrap(), Cow::Borrowed(_)));
    }

    #[test]
    fn glb_has_the_rows_at_one_position_tied() {
        let mesh = tied();
        let rows = rows_of(&mesh, Format::Glb).unwrap();
        assert_eq!(rows.position_id().unwrap(), [0, 1, 2, 1, 2, 5, 5]);
        let signs = Mesh::new(vec![[0.0; 3], [-0.0, 0.0, 0.0]], Vec::new()).unwrap();
        assert_eq!(rows_of(&signs, Format::Glb).unwrap().position_id().unwrap(), [0, 0]);
        let plain = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0]], Vec::new()).unwrap();
        assert!(matches!(rows_of(&plain, Format::Glb).unwrap(), Cow::Borrowed(_)));
    }

    #[test]
    fn stl_has_three_rows_a_triangle_and_one_part() {
        let mut scene = Scene::from_mesh("a", tied(), Frame::default());
        scene.parts.extend(Scene::from_mesh("b", tied(), Frame::default()).parts);
        let soup = to_file_rows(scene, Format::Stl).unwrap();
        let mesh = &soup.parts[0].mesh;
        assert_eq!((soup.parts.len(), mesh.positions().len()), (1, 12));
        assert_eq!(mesh.corners(3), tied().corners(1));
    }
}
