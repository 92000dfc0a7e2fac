//! `CopyMesh`: the triangles of a displaced copy of a mesh: the mesh's own, and faces without area where a vertex
//! has several places.
//!
//! Where four faces of two boxes meet, one of which overhangs, some of their normals are opposite, and no place of
//! the vertex is outside of all of them: the copy needs an edge there. So such a vertex is cut into several at one
//! position, each of which belongs to some consecutive faces around it. Along an edge whose faces have different
//! vertices two triangles fill the gap, and a polygon does so at a vertex of three or more places. These have no area
//! in the mesh, whose boundary stays zero; displaced they are proved like all others.
use super::vertex_places::VertexPlaces;
use crate::explicit::Mesh;
use std::collections::BTreeMap;

/// A corner: a face of the mesh, and which of its three corners.
pub(super) type FaceCorner = (u32, u8);

/// The triangles of a copy.
#[derive(Clone, Debug)]
pub(super) struct CopyMesh {
    /// Positions in the mesh; those of further places of its vertices follow.
    pub positions: Vec<[f64; 3]>,
    /// The faces of the mesh, then those without area.
    pub faces: Vec<[u32; 3]>,
    /// By vertex the first one that it is tied to.
    pub ids: Vec<u32>,
    /// By face without area, a face of the mesh beside it.
    beside: Vec<u32>,
    n_own: usize,
    /// The faces around each vertex.
    around: VertexCorners,
    /// The corners whose constraints a vertex obeys.
    obeyed: VertexCorners,
}

impl CopyMesh {
    /// The triangles of the mesh itself, with tied vertices.
    pub fn new(mesh: &Mesh, ids: &[u32]) -> Self {
        let corners = own_corners(mesh.faces(), ids);
        let around = VertexCorners::new(&corners, mesh.positions().len());
        Self {
            positions: mesh.positions().to_vec(),
            faces: mesh.faces().to_vec(),
            ids: ids.to_vec(),
            beside: Vec::new(),
            n_own: mesh.faces().len(),
            obeyed: around.clone(),
            around,
        }
    }

    /// The triangles of the mesh where some vertices have several places; a vertex is named by its id.
    pub fn with_places(mesh: &Mesh, ids: &[u32], places: &BTreeMap<u32, VertexPlaces>) -> Self {
        let mut made = Self::new(mesh, ids);
        let mut obeyed = own_corners(mesh.faces(), ids);
        obeyed.retain(|(v, _)| !places.contains_key(v));
        for (vertex, of_vertex) in places {
            let first = made.positions.len() as u32;
            for (number, place) in of_vertex.places.iter().enumerate() {
                let row = first + number as u32;
                made.positions.push(mesh.positions()[*vertex as usize]);
                made.ids.push(row);
                obeyed.extend(place.obeyed.iter().map(|corner| (row, *corner)));
                for (face, corner) in &place.own {
                    made.faces[*face as usize][*corner as usize] = row;
                }
            }
        }
        for (vertex, of_vertex) in places {
            made.fill_edges(*vertex, of_vertex, |other| places.contains_key(&other), mesh);
            made.fill_vertex(of_vertex);
        }
        let n = made.positions.len();
        made.obeyed = VertexCorners::new(&obeyed, n);
        made.around = VertexCorners::new(&own_corners(&made.faces, &made.ids), n);
        made
    }

    /// Adds the triangles along the edges about a vertex. An edge between two such vertices is the lower one's.
    fn fill_edges(
        &mut self,
        vertex: u32,
        of_vertex: &VertexPlaces,
        has_places: impl Fn(u32) -> bool,
        mesh: &Mesh,
    ) {
        let ring = &of_vertex.ring;
        let row = |made: &Self, (face, corner): FaceCorner, by: u8| {
            made.ids[made.faces[face as usize][usize::from((corner + by) % 3)] as usize]
        };
        let n_before = self.ids.len();
        for (k, before) in ring.iter().enumerate() {
            let after = ring[(k + 1) % ring.len()];
            // The face after the edge runs along it from the vertex, the one before towards it.
            let other = mesh.faces()[after.0 as usize][usize::from((after.1 + 1) % 3)];
            let other = self.ids[other as usize];
            if has_places(other) && other < vertex {
                continue;
            }
            let (from, to) = (row(self, after, 0), row(self, after, 1));
            let (from_before, to_before) = (row(self, *before, 0), row(self, *before, 2));
            for triangle in [[to, from, from_before], [to, from_before, to_before]] {
                self.add(triangle, after.0);
            }
        }
        debug_assert_eq!(n_before, self.ids.len());
    }

    /// Adds the polygon of all places.
    fn fill_vertex(&mut self, of_vertex: &VertexPlaces) {
        let rows: Vec<u32> = of_vertex
            .places
            .iter()
            .map(|place| self.faces[place.own[0].0 as usize][usize::from(place.own[0].1)])
            .collect();
        for pair in rows[1..].windows(2) {
            self.add([rows[0], pair[0], pair[1]], of_vertex.ring[0].0);
        }
    }

    fn add(&mut self, [a, b, c]: [u32; 3], beside: u32) {
        if a != b && b != c && c != a {
            self.faces.push([a, b, c]);
            self.beside.push(beside);
        }
    }

    /// How many faces are those of the mesh.
    pub fn n_own(&self) -> usize {
        self.n_own
    }

    /// The face of the mesh that a face is, or is beside.
    pub fn own_face(&self, face: u32) -> u32 {
        match (face as usize).checked_sub(self.n_own) {
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
        let mut all: Vec<u32> = corners.map(|v| self.ids[v as usize]).collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

fn own_corners(faces: &[[u32; 3]], ids: &[u32]) -> Vec<(u32, FaceCorner)> {
    let of_face =
        |(f, face): (usize, &[u32; 3])| [0, 1, 2].map(|k| (ids[face[k as usize] as usize], (f as u32, k)));
    faces.iter().enumerate().flat_map(of_face).collect()
}

/// Lists of corners by vertex.
#[derive(Clone, Debug)]
struct VertexCorners {
    corners: Vec<FaceCorner>,
    starts: Vec<u32>,
}

impl VertexCorners {
    fn new(all: &[(u32, FaceCorner)], n_vertices: usize) -> Self {
        let mut starts = vec![0_u32; n_vertices + 1];
        all.iter().for_each(|(v, _)| starts[*v as usize + 1] += 1);
        (1..starts.len()).for_each(|k| starts[k] += starts[k - 1]);
        let mut at = starts.clone();
        let mut corners = vec![(0, 0); all.len()];
        for (v, corner) in all {
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
