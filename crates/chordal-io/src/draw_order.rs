//! `for_vertex_caches`: orders the triangles and vertices of a mesh so that it draws fast and compresses
//! well.
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, InvalidMesh, Semantic, cache_misses, cache_order, fetch_order};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The size of the post-transform cache for which orders are compared, in vertices. Chosen: among the sizes
/// of graphics processors, the one that published reports use.
const CACHE: u32 = 16;

/// The mesh in the order in which a graphics processor shades the fewest vertices twice, if that is better
/// than its present order. Triangles of the same groups, above all of the same material, become consecutive;
/// then vertices are sorted by first use. Attributes and position ids follow.
///
/// Nearly linear in the size of the mesh.
///
/// # Errors
/// None for a valid mesh: an error means that the mesh was invalid before.
///
/// ```
/// use chordal::Mesh;
/// use chordal::explicit::acmr;
/// use chordal_io::for_vertex_caches;
/// // Cells of a lattice row by row: the next row comes when the last one has left the cache.
/// let at = |i: u32| [f64::from(i % 51), f64::from(i / 51), 0.0];
/// let cells = (0..50 * 50).map(|i| i + i / 50).flat_map(|a| [[a, a + 1, a + 52], [a, a + 52, a + 51]]);
/// let mesh = Mesh::new((0..51 * 51).map(at).collect(), cells.collect())?;
/// let ordered = for_vertex_caches(&mesh)?;
/// assert!(acmr(mesh.faces(), 16) > 1.0 && acmr(ordered.faces(), 16) < 0.75);
/// # Ok::<(), chordal::explicit::InvalidMesh>(())
/// ```
pub fn for_vertex_caches(mesh: &Mesh) -> Result<Cow<'_, Mesh>, InvalidMesh> {
    let order = draw_order(mesh);
    let faces = faces_in(&order, mesh);
    if cache_misses(&faces, CACHE) >= cache_misses(mesh.faces(), CACHE) {
        return Ok(Cow::Borrowed(mesh));
    }
    reordered(mesh, &order, faces).map(Cow::Owned)
}

/// The same triangles, reordered so that triangles with common vertices are close to each other; vertices are
/// sorted by first use. Triangles of the same groups are consecutive.
///
/// Nearly linear in the size of the mesh.
pub(crate) fn in_draw_order(mesh: &Mesh) -> Result<Mesh, InvalidMesh> {
    let order = draw_order(mesh);
    let faces = faces_in(&order, mesh);
    reordered(mesh, &order, faces)
}

/// The order of faces: groups in the order of their first faces; inside each group the order for caches.
fn draw_order(mesh: &Mesh) -> Vec<u32> {
    let groups = groups_of_faces(mesh);
    if groups.iter().all(|group| *group == 0) {
        return cache_order(mesh.faces());
    }
    let mut faces: Vec<u32> = (0..groups.len() as u32).collect();
    faces.sort_by_key(|face| groups[*face as usize]);
    let mut order = Vec::with_capacity(faces.len());
    // Vertices are renumbered inside each group, so that many small groups take no longer than one.
    let mut number = vec![u32::MAX; mesh.positions().len()];
    for run in faces.chunk_by(|a, b| groups[*a as usize] == groups[*b as usize]) {
        let mut vertices = Vec::new();
        let mut local_index = |vertex: u32| {
            let number = &mut number[vertex as usize];
            if *number == u32::MAX {
                *number = vertices.len() as u32;
                vertices.push(vertex);
            }
            *number
        };
        let local_faces: Vec<[u32; 3]> =
            run.iter().map(|face| mesh.faces()[*face as usize].map(&mut local_index)).collect();
        order.extend(cache_order(&local_faces).into_iter().map(|i| run[i as usize]));
        // Only what this group has set: clearing all would take every group as long as the whole mesh.
        vertices.into_iter().for_each(|vertex| number[vertex as usize] = u32::MAX);
    }
    order
}

/// For each face the number of its combination of groups; numbers follow the first faces.
fn groups_of_faces(mesh: &Mesh) -> Vec<u32> {
    let mut groups = vec![0_u32; mesh.faces().len()];
    let of_faces = |attribute: &&Attribute| {
        let is_group = matches!(attribute.semantic, Semantic::Group(_));
        is_group && attribute.domain == Domain::Face && attribute.width == 1
    };
    for attribute in mesh.attributes().iter().filter(of_faces) {
        let mut numbers = BTreeMap::new();
        for (group, value) in groups.iter_mut().zip(&attribute.values) {
            let next = numbers.len() as u32;
            *group = *numbers.entry((*group, value.to_bits())).or_insert(next);
        }
    }
    groups
}

fn faces_in(order: &[u32], mesh: &Mesh) -> Vec<[u32; 3]> {
    order.iter().map(|face| mesh.faces()[*face as usize]).collect()
}

/// The mesh with its faces in the given order (`faces` is sorted already), and its vertices by first use.
fn reordered(mesh: &Mesh, order: &[u32], mut faces: Vec<[u32; 3]>) -> Result<Mesh, InvalidMesh> {
    let mut old = fetch_order(&faces);
    let n_vertices = mesh.positions().len();
    let mut new = vec![u32::MAX; n_vertices];
    old.iter().zip(0..).for_each(|(vertex, place)| new[*vertex as usize] = place);
    // Unused vertices come last.
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
        // The rows of one vertex or face are consecutive.
        let (order, n) = match attribute.domain {
            Domain::Vertex => (&old[..], attribute.width),
            Domain::Face => (order, attribute.width),
            Domain::Corner => (order, 3 * attribute.width),
        };
        let values = order.iter().flat_map(|i| &attribute.values[*i as usize * n..][..n]).copied().collect();
        ordered = ordered.with_attribute(Attribute { values, ..attribute.clone() })?;
    }
    Ok(ordered)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MATERIAL;
    use chordal::explicit::acmr;

    /// A lattice of cells row by row, with values at vertices, faces and corners, and bands of two materials.
    fn lattice() -> Mesh {
        const N: u32 = 30;
        let cells =
            (0..N * N).map(|i| i + i / N).flat_map(|a| [[a, a + 1, a + N + 2], [a, a + N + 2, a + N + 1]]);
        let faces: Vec<[u32; 3]> = cells.collect();
        let n_vertices = (N + 1) * (N + 1);
        let at = |i: u32| [f64::from(i % (N + 1)), f64::from(i / (N + 1)), 0.0];
        let named = |name: &str, domain, width, values| Attribute {
            semantic: Semantic::Custom(name.into()),
            domain,
            width,
            values,
        };
        let n_faces = faces.len() as u32;
        let numbers = |n: u32| (0..n).map(f64::from).collect::<Vec<f64>>();
        // Bands of ten cells.
        let material = (0..n_faces).map(|face| f64::from(face / 2 % N / 10 % 2)).collect();
        let semantic = Semantic::Group(MATERIAL.into());
        let mesh = Mesh::new((0..n_vertices).map(at).collect(), faces).unwrap();
        [
            Attribute { semantic, domain: Domain::Face, width: 1, values: material },
            named("_VERTEX", Domain::Vertex, 1, numbers(n_vertices)),
            named("_FACE", Domain::Face, 1, numbers(n_faces)),
            named("_CORNER", Domain::Corner, 2, numbers(6 * n_faces)),
        ]
        .into_iter()
        .try_fold(mesh, Mesh::with_attribute)
        .unwrap()
    }

    #[test]
    fn everything_goes_along_and_materials_come_together() {
        let mesh = lattice();
        let ordered = for_vertex_caches(&mesh).unwrap();
        assert!(acmr(ordered.faces(), CACHE) < 0.9 * acmr(mesh.faces(), CACHE));
        let values = |mesh: &Mesh, name: &str| {
            mesh.attributes()
                .iter()
                .find(|own| own.semantic == Semantic::Custom(name.into()))
                .unwrap()
                .clone()
        };
        let material = ordered.attribute(&Semantic::Group(MATERIAL.into())).unwrap();
        assert!(material.values.is_sorted(), "they stand together");
        let old_material = mesh.attribute(&Semantic::Group(MATERIAL.into())).unwrap();
        let (of_vertex, of_face) = (values(&ordered, "_VERTEX"), values(&ordered, "_FACE"));
        let of_corner = values(&ordered, "_CORNER");
        let mut seen = vec![false; mesh.faces().len()];
        for (face, corners) in ordered.faces().iter().enumerate() {
            let old = of_face.row(face)[0] as usize;
            assert!(!std::mem::replace(&mut seen[old], true), "each once");
            assert_eq!(material.row(face), old_material.row(old));
            for (k, vertex) in corners.iter().enumerate() {
                assert_eq!(of_vertex.row(*vertex as usize)[0], f64::from(mesh.faces()[old][k]));
                assert_eq!(of_corner.row(3 * face + k)[0], (6 * old + 2 * k) as f64);
            }
            assert_eq!(ordered.corners(face), mesh.corners(old));
        }
        assert!(seen.into_iter().all(|seen| seen));
    }

    #[test]
    fn a_mesh_that_gains_nothing_stays_as_it_is() {
        let strip =
            Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0; 3]], vec![[0, 1, 2], [2, 1, 3]]);
        assert!(matches!(for_vertex_caches(&strip.unwrap()).unwrap(), Cow::Borrowed(_)));
    }
}
