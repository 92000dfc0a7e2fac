//! `resolve_t_junctions`: makes vertices in the middle of an edge corners of its face.
use super::cut_faces::{FaceCutter, VertexInsertion};
use super::mend_builder::{MendBuilder, MendFace, check_limits};
use super::mended_mesh::MendedMesh;
use crate::Mesh;
use crate::budget::{Job, JobError, Tolerance};
use crate::check::{Finding, MeshConnectivity, MeshLocation, Witness, has_zero_area, vertices_in_edges};
use crate::explicit::{Topology, next_in_face};
use crate::math::{add_up, greater, lesser, mul_up};

/// Cuts every face with a boundary vertex in the middle of one of its boundary edges so that the vertex
/// becomes a corner of it: the T-junctions that [`check::t_junctions`](crate::check::t_junctions) finds,
/// exactly or within a tolerance.
///
/// If vertices carry attributes, the new corner gets an additional row with the interpolated attributes of
/// the edge, tied to the vertex by position; normals and tangents are normalized again, group numbers are
/// those of the nearer end.
///
/// **Bound.** 0 when exact. Otherwise the largest distance of such a vertex from its edge, rounded up: the
/// edge is bent to the vertex, and all points of the face follow in proportion. The changes are
/// `resolved_t_junctions`, one for each vertex and edge, and `left_t_junctions`, if an edge would have got a
/// third face, or if the face has no area.
///
/// O(n log n) for n boundary edges, unless all of them pass through one small place.
///
/// # Errors
/// [`JobError`] if the job is cancelled or its memory limit is too low.
///
/// ```
/// use chordal::{Job, Mesh, check, explicit::Topology, mend};
/// let points = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, -1.0, 0.0]];
/// let mesh = Mesh::new(points, vec![[0, 1, 2], [0, 4, 3], [3, 4, 1]])?;
/// let mended = mend::resolve_t_junctions(&mesh, Topology::Indices, None, &Job::default())?;
/// assert_eq!(mended.mesh.faces()[..2], [[3, 1, 2], [3, 2, 0]]);
/// assert!(check::t_junctions(&mended.mesh, Topology::Indices, None).is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn resolve_t_junctions(
    mesh: &Mesh,
    topology: Topology,
    within: Option<Tolerance>,
    job: &Job,
) -> Result<MendedMesh, JobError> {
    check_limits(mesh, job)?;
    let ids = topology.ids(mesh);
    let id = |row: u32| ids.as_ref().map_or(row, |ids| ids[row as usize]);
    let mut insertions: Vec<VertexInsertion> = Vec::new();
    vertices_in_edges(&MeshConnectivity::new(mesh, topology), within, |rows, half_edge| {
        insertions.extend(rows.iter().map(|&row| VertexInsertion { half_edge, row }));
    });
    if insertions.is_empty() {
        return Ok(MendedMesh::unchanged(mesh));
    }
    insertions.sort_unstable_by_key(|insertion| (insertion.half_edge, insertion.row));
    let mut cutter = FaceCutter::new(mesh, &id, &insertions, |_| false);
    let mut draft = MendBuilder::without_faces(mesh);
    let (mut resolved, mut unresolved) = (Finding::default(), Finding::default());
    let mut most = 0.0;
    let mut by_face = insertions.chunk_by(|a, b| a.half_edge / 3 == b.half_edge / 3).peekable();
    for face in 0..mesh.faces().len() as u32 {
        let Some(insertions) = by_face.next_if(|of_face| of_face[0].half_edge / 3 == face) else {
            draft.faces.push(MendFace::from_mesh(mesh, face));
            continue;
        };
        // A face without area would be cut into several faces without area.
        let is_cut = if has_zero_area(mesh.corners(face as usize)) {
            draft.faces.push(MendFace::from_mesh(mesh, face));
            false
        } else {
            cutter.cut(face, insertions, &mut draft)
        };
        for insertion in insertions {
            let finding = if is_cut { &mut resolved } else { &mut unresolved };
            finding.add(|| witness(mesh, insertion));
            if let (Some(_), true) = (within, is_cut) {
                let distance = distance_up(mesh, insertion);
                most = greater(distance, most);
            }
        }
    }
    let changes = [("resolved_t_junctions", resolved), ("left_t_junctions", unresolved)];
    if changes[0].1.is_none() {
        return Ok(MendedMesh::exact(mesh.clone(), changes));
    }
    MendedMesh::moved(draft.finish()?, changes, most)
}

fn ends(mesh: &Mesh, half_edge: u32) -> [u32; 2] {
    [half_edge, next_in_face(half_edge)].map(|h| mesh.faces()[h as usize / 3][h as usize % 3])
}

fn witness(mesh: &Mesh, &VertexInsertion { half_edge, row }: &VertexInsertion) -> Witness {
    let location = MeshLocation::OnEdge { vertex: row, edge: ends(mesh, half_edge), face: half_edge / 3 };
    Witness { place: location, at: mesh.positions()[row as usize] }
}

/// An upper bound on the distance of a vertex from its edge: the distance to a point that is on the edge up
/// to rounding, plus that rounding.
fn distance_up(mesh: &Mesh, &VertexInsertion { half_edge, row }: &VertexInsertion) -> f64 {
    let [a, b] = ends(mesh, half_edge).map(|row| mesh.positions()[row as usize]);
    let p = mesh.positions()[row as usize];
    // Halved, so that the difference of two large numbers does not overflow, and divided by the
    // longest side of its box, so that squares stay in range. Both factors cancel in t.
    let along: [f64; 3] = std::array::from_fn(|k| 0.5 * b[k] - 0.5 * a[k]);
    let size = along.iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
    let along = along.map(|x| x / size);
    let from_a: [f64; 3] = std::array::from_fn(|k| (0.5 * p[k] - 0.5 * a[k]) / size);
    let t = crate::math::dot(from_a, along) / crate::math::dot(along, along);
    let t = lesser(1.0, t);
    let closest: [f64; 3] = std::array::from_fn(|k| (1.0 - t) * a[k] + t * b[k]);
    let reach = [a, b].as_flattened().iter().fold(0.0, |m: f64, x| greater(x.abs(), m));
    // For any t in [0, 1] the point is on the edge; each coordinate has four roundings of half a step of
    // `reach`, and the three together are at most √3 of that: below 4 whole steps. The smallest number covers
    // underflow.
    add_up(super::weld::distance_up(p, closest), add_up(mul_up(4.0 * f64::EPSILON, reach), f64::MIN_POSITIVE))
}
