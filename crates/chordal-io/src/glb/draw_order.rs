//! `in_draw_order`: a mesh whose triangles and vertices stand in the order that compresses, and draws, best.
use super::material_runs::material_runs;
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, InvalidMesh, cache_misses, cache_order, fetch_order};
use std::borrow::Cow;

/// The post-transform cache that orders are compared for, in vertices. Chosen: of what graphics processors have, the
/// size that reports of sizes use.
const CACHE: u32 = 16;

/// The mesh in an order in which a graphics processor shades the fewest vertices again, where that is better than its
/// own: the triangles of each material, which stay together, then the vertices by their first use. Attributes and ties
/// go along. The mesh is as [`split`](super::split) makes it.
///
/// Linear in the size of the mesh. What was ordered once stays as it is.
///
/// # Errors
/// None for a mesh: that it refuses what it had is the error of the type.
pub fn for_vertex_caches(mesh: &Mesh) -> Result<Cow<'_, Mesh>, InvalidMesh> {
    let runs = material_runs(mesh);
    let mut is_better = false;
    let mut first = 0;
    for (_, n) in runs {
        let run = &mesh.faces()[first..][..n];
        first += n;
        let ordered: Vec<[u32; 3]> = cache_order(run).into_iter().map(|i| run[i as usize]).collect();
        is_better |= cache_misses(&ordered, CACHE) < cache_misses(run, CACHE);
    }
    if is_better { in_draw_order(mesh).map(Cow::Owned) } else { Ok(Cow::Borrowed(mesh)) }
}

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
    let mut ordered = Mesh::new(positions, faces)?;
    if mesh.position_id().is_some() {
        let ids = old.iter().map(|vertex| mesh.position_of(*vertex)).collect();
        ordered = ordered.with_position_id(ids)?;
    }
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
