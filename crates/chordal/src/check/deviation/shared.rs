//! The vertices and faces that two surfaces share bit by bit: their distance is 0 without a query.
use super::distance_surface::{DistanceSample, DistanceSurface};
use crate::budget::{Job, par_map};
use crate::explicit::{Mesh, position_id_by_bits};

/// Points queried in one task.
pub(super) const CHUNK: usize = 1 << 12;
/// No face uses the position.
const NONE: u32 = u32::MAX;

/// An id for each position of two meshes, equal for equal coordinates.
pub(super) struct SharedPositionIds {
    ids: [Vec<u32>; 2],
    n: usize,
}

impl SharedPositionIds {
    pub fn from_meshes(meshes: [&Mesh; 2]) -> Self {
        let positions = [meshes[0].positions(), meshes[1].positions()].concat();
        let mut ids = position_id_by_bits(&positions);
        let second = ids.split_off(meshes[0].positions().len());
        Self { ids: [ids, second], n: positions.len() }
    }

    /// For each position of a side, the first of the given faces that uses it; [`NONE`] if there is none.
    fn first_faces(&self, mesh: &Mesh, side: usize, faces: impl Iterator<Item = u32>) -> Vec<u32> {
        let mut first = vec![NONE; self.n];
        for face in faces {
            for row in mesh.faces()[face as usize] {
                let first = &mut first[self.ids[side][row as usize] as usize];
                if *first == NONE {
                    *first = face;
                }
            }
        }
        first
    }

    fn key(&self, rows: [u32; 3], side: usize) -> [u32; 3] {
        let mut key = rows.map(|row| self.ids[side][row as usize]);
        key.sort_unstable();
        key
    }

    /// For each face of a side, whether the other side has a face with the same three positions.
    fn shared_faces(&self, meshes: [&Mesh; 2], side: usize) -> Vec<bool> {
        let other = 1 - side;
        let mut keys: Vec<_> = meshes[other].faces().iter().map(|rows| self.key(*rows, other)).collect();
        keys.sort_unstable();
        let has = |rows: &[u32; 3]| keys.binary_search(&self.key(*rows, side)).is_ok();
        meshes[side].faces().iter().map(has).collect()
    }
}

/// The vertices of one side with their distances to the other, and the faces to be checked.
pub(super) struct VertexDistances {
    /// By position id; positions that no face uses are not queried.
    corners: Vec<DistanceSample>,
    ids: Vec<u32>,
    /// Faces that the other side does not share.
    pub faces: Vec<u32>,
}

impl VertexDistances {
    /// Queries the other side for every vertex of a side that a face uses.
    pub fn measure(
        position_ids: &SharedPositionIds,
        sides: [&DistanceSurface; 2],
        side: usize,
        job: &Job,
    ) -> Self {
        let faces = 0..sides[side].mesh().faces().len() as u32;
        Self::of_faces(position_ids, sides, (side, faces.collect()), job)
    }

    /// Like [`Self::measure`], for the vertices of some faces.
    pub fn of_faces(
        position_ids: &SharedPositionIds,
        sides: [&DistanceSurface; 2],
        (side, faces): (usize, Vec<u32>),
        job: &Job,
    ) -> Self {
        let meshes = sides.map(DistanceSurface::mesh);
        let (mesh, other) = (meshes[side], sides[1 - side]);
        let own_first = position_ids.first_faces(mesh, side, faces.iter().copied());
        let other_first =
            position_ids.first_faces(other.mesh(), 1 - side, 0..other.mesh().faces().len() as u32);
        let mut corners = vec![DistanceSample { at: [0.0; 3], up: 0.0, face: NONE }; position_ids.n];
        let mut open = Vec::new();
        for (row, &id) in position_ids.ids[side].iter().enumerate() {
            let corner = &mut corners[id as usize];
            if own_first[id as usize] == NONE || corner.face != NONE {
                continue;
            }
            *corner = DistanceSample { at: mesh.positions()[row], up: 0.0, face: other_first[id as usize] };
            // Marked, so that another row of the same position is not queried again; the sample
            // replaces the mark.
            if corner.face == NONE {
                corner.face = NONE - 1;
                open.push(id);
            }
        }
        let chunks: Vec<&[u32]> = open.chunks(CHUNK).collect();
        let samples = par_map(job, &chunks, |_, chunk| {
            let sample = |id: &u32| other.sample(corners[*id as usize].at);
            if job.is_cancelled() { Vec::new() } else { chunk.iter().map(sample).collect() }
        });
        for (id, corner) in open.iter().zip(samples.into_iter().flatten()) {
            corners[*id as usize] = corner;
        }
        // A face is shared only if its vertices are, so without one the faces need not be compared.
        let some_shared = own_first.iter().zip(&other_first).any(|(a, b)| *a != NONE && *b != NONE);
        let faces = if some_shared {
            let shared = position_ids.shared_faces(meshes, side);
            faces.into_iter().filter(|face| !shared[*face as usize]).collect()
        } else {
            faces
        };
        Self { corners, ids: position_ids.ids[side].clone(), faces }
    }

    /// A vertex of the mesh by its row.
    pub fn corner(&self, row: u32) -> DistanceSample {
        self.corners[self.ids[row as usize] as usize]
    }

    /// The vertex with the largest upper bound on its distance from the other side.
    pub fn farthest(&self) -> Option<DistanceSample> {
        let queried = self.corners.iter().filter(|corner| corner.face != NONE);
        queried.copied().reduce(|far, corner| if corner.up > far.up { corner } else { far })
    }
}
