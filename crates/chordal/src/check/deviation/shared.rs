//! Vertices and whole faces that two surfaces share bit by bit, whose distance is 0 without a query.
use super::distance_surface::DistanceSurface;
use super::subtriangle::DistanceSample;
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
        let all = [meshes[0].positions(), meshes[1].positions()].concat();
        let mut ids = position_id_by_bits(&all);
        let second = ids.split_off(meshes[0].positions().len());
        Self { ids: [ids, second], n: all.len() }
    }

    /// The first of some faces at each position on side `which`; [`NONE`] where there is none.
    fn first_faces(&self, mesh: &Mesh, which: usize, faces: impl Iterator<Item = u32>) -> Vec<u32> {
        let mut first = vec![NONE; self.n];
        for face in faces {
            for row in mesh.faces()[face as usize] {
                let first = &mut first[self.ids[which][row as usize] as usize];
                if *first == NONE {
                    *first = face;
                }
            }
        }
        first
    }

    fn key(&self, rows: [u32; 3], which: usize) -> [u32; 3] {
        let mut key = rows.map(|row| self.ids[which][row as usize]);
        key.sort_unstable();
        key
    }

    /// For each face of side `which` whether the other side has one with the same three positions.
    fn shared_faces(&self, meshes: [&Mesh; 2], which: usize) -> Vec<bool> {
        let other = 1 - which;
        let mut keys: Vec<_> = meshes[other].faces().iter().map(|rows| self.key(*rows, other)).collect();
        keys.sort_unstable();
        let has = |rows: &[u32; 3]| keys.binary_search(&self.key(*rows, which)).is_ok();
        meshes[which].faces().iter().map(has).collect()
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
    /// Queries `other` for every vertex of side `which` that a face uses.
    pub fn measure(
        common: &SharedPositionIds,
        sides: [&DistanceSurface; 2],
        which: usize,
        job: &Job,
    ) -> Self {
        let all = 0..sides[which].mesh().faces().len() as u32;
        Self::of_faces(common, sides, (which, all.collect()), job)
    }

    /// The same for the vertices of some faces.
    pub fn of_faces(
        common: &SharedPositionIds,
        sides: [&DistanceSurface; 2],
        (which, asked): (usize, Vec<u32>),
        job: &Job,
    ) -> Self {
        let meshes = sides.map(DistanceSurface::mesh);
        let (own, other) = (meshes[which], sides[1 - which]);
        let mine = common.first_faces(own, which, asked.iter().copied());
        let theirs = common.first_faces(other.mesh(), 1 - which, 0..other.mesh().faces().len() as u32);
        let mut corners = vec![DistanceSample { at: [0.0; 3], up: 0.0, face: NONE }; common.n];
        let mut open = Vec::new();
        for (row, &id) in common.ids[which].iter().enumerate() {
            let corner = &mut corners[id as usize];
            if mine[id as usize] == NONE || corner.face != NONE {
                continue;
            }
            *corner = DistanceSample { at: own.positions()[row], up: 0.0, face: theirs[id as usize] };
            if corner.face == NONE {
                corner.face = NONE - 1;
                open.push(id);
            }
        }
        let chunks: Vec<&[u32]> = open.chunks(CHUNK).collect();
        let found = par_map(job, &chunks, |_, chunk| {
            let ask = |id: &u32| other.sample(corners[*id as usize].at);
            if job.is_cancelled() { Vec::new() } else { chunk.iter().map(ask).collect() }
        });
        for (id, corner) in open.iter().zip(found.into_iter().flatten()) {
            corners[*id as usize] = corner;
        }
        let some_shared = mine.iter().zip(&theirs).any(|(a, b)| *a != NONE && *b != NONE);
        let faces = if some_shared {
            let shared = common.shared_faces(meshes, which);
            asked.into_iter().filter(|face| !shared[*face as usize]).collect()
        } else {
            asked
        };
        Self { corners, ids: common.ids[which].clone(), faces }
    }

    /// A vertex of the mesh by its row.
    pub fn corner(&self, row: u32) -> DistanceSample {
        self.corners[self.ids[row as usize] as usize]
    }

    /// The vertex with the largest upper bound on its distance from the other side.
    pub fn farthest(&self) -> Option<DistanceSample> {
        let asked = self.corners.iter().filter(|corner| corner.face != NONE);
        asked.copied().reduce(|far, corner| if corner.up > far.up { corner } else { far })
    }
}
