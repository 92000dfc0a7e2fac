//! `in_draw_order`: a mesh whose triangles and vertices stand in the order that compresses, and draws, best.
use super::material_runs::material_runs;
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, InvalidMesh, cache_order, fetch_order};

/// The same triangles with the vertices that they share close to each other, in vertices by their first use.
/// Triangles of one material stay together. The mesh is as [`split`](super::split) makes it.
///
/// Linear in the size of the mesh.
pub(super) fn in_draw_order(mesh: &Mesh) -> Result<Mesh, InvalidMesh> {
    let mut faces: Vec<[u32; 3]> = Vec::with_capacity(mesh.faces().len());
    for (_, n) in material_runs(mesh) {
        let run = &mesh.faces()[faces.len()..][..n];
        faces.extend(cache_order(run).into_iter().map(|i| run[i as usize]));
    }
    let mut old = fetch_order(&faces);
    let n_vertices = mesh.positions().len();
    let mut new = vec![u32::MAX; n_vertices];
    old.iter().zip(0..).for_each(|(vertex, place)| new[*vertex as usize] = place);
    // What no triangle uses comes last.
    for (vertex, place) in (0..n_vertices as u32).zip(&mut new).filter(|(_, place)| **place == u32::MAX) {
        *place = old.len() as u32;
        old.push(vertex);
    }
    faces.iter_mut().flatten().for_each(|vertex| *vertex = new[*vertex as usize]);
    let positions = old.iter().map(|vertex| mesh.positions()[*vertex as usize]).collect();
    let ids = old.iter().map(|vertex| mesh.position_of(*vertex)).collect();
    let mut ordered = Mesh::new(positions, faces)?.with_position_id(ids)?;
    for attribute in mesh.attributes() {
        let values = match attribute.domain {
            Domain::Vertex => {
                old.iter().flat_map(|vertex| attribute.row(*vertex as usize)).copied().collect()
            }
            // Of faces there are materials alone, the same over each run.
            Domain::Face | Domain::Corner => attribute.values.clone(),
        };
        ordered = ordered.with_attribute(Attribute { values, ..attribute.clone() })?;
    }
    Ok(ordered)
}
