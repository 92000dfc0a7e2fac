//! What two surfaces have in common bit by bit: vertices and whole faces, whose distance is 0 without a question.
use super::distance_surface::DistanceSurface;
use super::subtriangle::DistanceSample;
use crate::budget::{Job, par_map};
use crate::explicit::{Mesh, position_id_by_bits};

/// Points asked in one task.
pub(super) const CHUNK: usize = 1 << 12;
/// No face has it.
const NONE: u32 = u32::MAX;

/// One number for each position of two meshes, equal where the coordinates are.
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

    /// A face of each position on side `which`, the first; [`NONE`] where no face has it.
    fn first_faces(&self, mesh: &Mesh, which: usize) -> Vec<u32> {
        let mut first = vec![NONE; self.n];
        for (face, rows) in mesh.faces().iter().enumerate() {
            for &row in rows {
                let first = &mut first[self.ids[which][row as usize] as usize];
                if *first == NONE {
                    *first = face as u32;
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

/// The vertices of one side, each with its distance to the other, and the faces that have to be looked at.
pub(super) struct VertexDistances {
    /// By the number of the position; what no face uses is not asked about.
    corners: Vec<DistanceSample>,
    ids: Vec<u32>,
    /// Faces that the other side does not have as well.
    pub faces: Vec<u32>,
}

impl VertexDistances {
    /// Asks `other` about every vertex of side `which` that a face uses.
    pub fn measure(
        common: &SharedPositionIds,
        sides: [&DistanceSurface; 2],
        which: usize,
        job: &Job,
    ) -> Self {
        let meshes = sides.map(DistanceSurface::mesh);
        let (own, other) = (meshes[which], sides[1 - which]);
        let mine = common.first_faces(own, which);
        let theirs = common.first_faces(other.mesh(), 1 - which);
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
        let asked = par_map(job, &chunks, |_, chunk| {
            let ask = |id: &u32| other.sample(corners[*id as usize].at);
            if job.is_cancelled() { Vec::new() } else { chunk.iter().map(ask).collect() }
        });
        for (id, corner) in open.iter().zip(asked.into_iter().flatten()) {
            corners[*id as usize] = corner;
        }
        let all = 0..own.faces().len() as u32;
        let some_shared = mine.iter().zip(&theirs).any(|(a, b)| *a != NONE && *b != NONE);
        let faces = if some_shared {
            let shared = common.shared_faces(meshes, which);
            all.filter(|face| !shared[*face as usize]).collect()
        } else {
            all.collect()
        };
        Self { corners, ids: common.ids[which].clone(), faces }
    }

    /// A vertex of the mesh by its row.
    pub fn corner(&self, row: u32) -> DistanceSample {
        self.corners[self.ids[row as usize] as usize]
    }

    /// The vertex that is farthest from the other side, as far as can be seen.
    pub fn farthest(&self) -> Option<DistanceSample> {
        let asked = self.corners.iter().filter(|corner| corner.face != NONE);
        asked.copied().reduce(|far, corner| if corner.up > far.up { corner } else { far })
    }
}
