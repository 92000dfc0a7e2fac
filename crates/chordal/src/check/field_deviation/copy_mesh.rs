//! `CopyMesh`: the triangles of a displaced copy of a mesh: those of the mesh, and faces without area at
//! vertices with several places.
//!
//! If four faces of two boxes meet, one of which overhangs, some of their normals are opposite, and no place
//! of the vertex is outside of all of them: the copy needs an edge there. So such a vertex is cut into
//! several at one position, each of which belongs to some consecutive faces around it. Along an edge whose
//! faces have different vertices two triangles fill the gap, and a polygon does so at a vertex of three or
//! more places. These have no area in the mesh, whose boundary stays zero; displaced they are proved like all
//! other faces.
use super::vertex_places::{FaceCorner, VertexPlaces};
use crate::explicit::Mesh;
use std::collections::BTreeMap;

/// The triangles of a copy.
#[derive(Clone, Debug)]
pub(super) struct CopyMesh {
    /// Positions in the mesh; those of the additional places of its vertices follow.
    pub positions: Vec<[f64; 3]>,
    /// The faces of the mesh, then the faces without area.
    pub faces: Vec<[u32; 3]>,
    /// By vertex: the first vertex to which it is tied.
    pub ids: Vec<u32>,
    /// By face without area: a face of the mesh beside it.
    beside: Vec<u32>,
    n_mesh_faces: usize,
    /// The faces around each vertex.
    around: VertexCorners,
    /// The corners whose constraints a vertex obeys.
    obeyed: VertexCorners,
}

impl CopyMesh {
    /// The triangles of the mesh itself, with tied vertices.
    pub fn new(mesh: &Mesh, ids: &[u32]) -> Self {
        let corners = mesh_corners(mesh.faces(), ids);
        let around = VertexCorners::new(&corners, mesh.positions().len());
        Self {
            positions: mesh.positions().to_vec(),
            faces: mesh.faces().to_vec(),
            ids: ids.to_vec(),
            beside: Vec::new(),
            n_mesh_faces: mesh.faces().len(),
            obeyed: around.clone(),
            around,
        }
    }

    /// The triangles of the mesh, some of whose vertices have several places; a vertex is named by its id.
    pub fn with_places(mesh: &Mesh, ids: &[u32], places: &BTreeMap<u32, VertexPlaces>) -> Self {
        let mut copy = Self::new(mesh, ids);
        // A vertex without several places obeys all of its corners.
        let mut obeyed = mesh_corners(mesh.faces(), ids);
        obeyed.retain(|(v, _)| !places.contains_key(v));
        for (vertex, vertex_places) in places {
            let first = copy.positions.len() as u32;
            for (number, place) in vertex_places.places.iter().enumerate() {
                let row = first + number as u32;
                copy.positions.push(mesh.positions()[*vertex as usize]);
                copy.ids.push(row);
                obeyed.extend(place.obeyed.iter().map(|corner| (row, *corner)));
                for (face, corner) in &place.corners {
                    copy.faces[*face as usize][*corner as usize] = row;
                }
            }
        }
        for (vertex, vertex_places) in places {
            copy.fill_edges(*vertex, vertex_places, |other| places.contains_key(&other), mesh);
            copy.fill_vertex(vertex_places);
        }
        let n = copy.positions.len();
        copy.obeyed = VertexCorners::new(&obeyed, n);
        copy.around = VertexCorners::new(&mesh_corners(&copy.faces, &copy.ids), n);
        copy
    }

    /// Adds the triangles along the edges around a vertex. An edge between two such vertices belongs to the
    /// lower one.
    fn fill_edges(
        &mut self,
        vertex: u32,
        vertex_places: &VertexPlaces,
        has_places: impl Fn(u32) -> bool,
        mesh: &Mesh,
    ) {
        let ring = &vertex_places.ring;
        let row = |copy: &Self, (face, corner): FaceCorner, by: u8| {
            copy.ids[copy.faces[face as usize][usize::from((corner + by) % 3)] as usize]
        };
        let n_before = self.ids.len();
        for (k, before) in ring.iter().enumerate() {
            let after = ring[(k + 1) % ring.len()];
            // The face after the edge runs along it away from the vertex, the face before runs towards the
            // vertex.
            let other = mesh.faces()[after.0 as usize][usize::from((after.1 + 1) % 3)];
            let other = self.ids[other as usize];
            if has_places(other) && other < vertex {
                continue;
            }
            //    to_before ──── to       as the faces before and after the edge have it. In the mesh both
            //        │       ╱   │       sides of this gap are one edge; in the copy two triangles fill it,
            //   from_before ── from      or one, or none, if the places are the same.
            let (from, to) = (row(self, after, 0), row(self, after, 1));
            let (from_before, to_before) = (row(self, *before, 0), row(self, *before, 2));
            for triangle in [[to, from, from_before], [to, from_before, to_before]] {
                self.add(triangle, after.0);
            }
        }
        debug_assert_eq!(n_before, self.ids.len());
    }

    /// Adds the polygon between all places of a vertex.
    fn fill_vertex(&mut self, vertex_places: &VertexPlaces) {
        let rows: Vec<u32> = vertex_places
            .places
            .iter()
            .map(|place| self.faces[place.corners[0].0 as usize][usize::from(place.corners[0].1)])
            .collect();
        for pair in rows[1..].windows(2) {
            self.add([rows[0], pair[0], pair[1]], vertex_places.ring[0].0);
        }
    }

    fn add(&mut self, [a, b, c]: [u32; 3], beside: u32) {
        if a != b && b != c && c != a {
            self.faces.push([a, b, c]);
            self.beside.push(beside);
        }
    }

    /// The number of faces that belong to the mesh.
    pub fn n_mesh_faces(&self) -> usize {
        self.n_mesh_faces
    }

    /// The face of the mesh that a face is, or beside which it is.
    pub fn mesh_face(&self, face: u32) -> u32 {
        match (face as usize).checked_sub(self.n_mesh_faces) {
            Some(added) => self.beside[added],
            None => face,
        }
    }

    /// The corners of a face in the mesh.
    pub fn corners(&self, face: u32) -> [[f64; 3]; 3] {
        self.faces[face as usize].map(|v| self.positions[v as usize])
    }

    /// The faces around a vertex.
    pub fn faces_around(&self, vertex: u32) -> impl Iterator<Item = u32> + use<'_> {
        self.around.of(vertex).iter().map(|(face, _)| *face)
    }

    /// The corners whose constraints a vertex obeys, all of faces of the mesh.
    pub fn corners_obeyed(&self, vertex: u32) -> &[FaceCorner] {
        self.obeyed.of(vertex)
    }

    /// The vertices of some faces, ascending.
    pub fn vertices_of(&self, faces: &[u32]) -> Vec<u32> {
        let corners = faces.iter().flat_map(|face| self.faces[*face as usize]);
        let mut vertices: Vec<u32> = corners.map(|v| self.ids[v as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }
}

fn mesh_corners(faces: &[[u32; 3]], ids: &[u32]) -> Vec<(u32, FaceCorner)> {
    let corners_of_face =
        |(f, face): (usize, &[u32; 3])| [0, 1, 2].map(|k| (ids[face[k as usize] as usize], (f as u32, k)));
    faces.iter().enumerate().flat_map(corners_of_face).collect()
}

/// Lists of corners by vertex.
#[derive(Clone, Debug)]
struct VertexCorners {
    corners: Vec<FaceCorner>,
    starts: Vec<u32>,
}

impl VertexCorners {
    fn new(entries: &[(u32, FaceCorner)], n_vertices: usize) -> Self {
        // A counting sort by vertex; corners of a vertex stay in the order of the faces.
        let mut starts = vec![0_u32; n_vertices + 1];
        entries.iter().for_each(|(v, _)| starts[*v as usize + 1] += 1);
        (1..starts.len()).for_each(|k| starts[k] += starts[k - 1]);
        let mut at = starts.clone();
        let mut corners = vec![(0, 0); entries.len()];
        for (v, corner) in entries {
            let slot = &mut at[*v as usize];
            corners[*slot as usize] = *corner;
            *slot += 1;
        }
        Self { corners, starts }
    }

    fn of(&self, vertex: u32) -> &[FaceCorner] {
        &self.corners[self.starts[vertex as usize] as usize..self.starts[vertex as usize + 1] as usize]
    }
}
