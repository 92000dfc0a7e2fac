//! `NearbySearch`: bounds of single faces by a search among a few faces that correspond to their
//! surroundings.
use super::super::violations::ProximityChecker;
use super::images::VertexImage;
use super::surface::{FanSurface, NONE};
use crate::budget::{Job, par_map};
use crate::explicit::Mesh;

/// One of the two surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Source,
    Result,
}

/// A part of a surface bounds the distance to it from above. So a face is compared only with those faces of
/// the other surface that the images of its vertices point to, which are few.
pub(super) struct NearbySearch<'a> {
    source: &'a FanSurface,
    result: &'a FanSurface,
    images: &'a [VertexImage],
    /// By face of the result: the start of the vertices of the source whose images it holds; one more entry
    /// at the end.
    first: Vec<u32>,
    vertices: Vec<u32>,
}

/// Faces that share one small tree. Chosen: consecutive faces are mostly close together, but fewer of a
/// larger number are.
const CHUNK: usize = 64;

impl<'a> NearbySearch<'a> {
    pub fn new(source: &'a FanSurface, result: &'a FanSurface, images: &'a [VertexImage]) -> Self {
        let mut first = vec![0_u32; result.n_faces() + 1];
        // A counting sort by face: counts, their running sums, then each vertex into the next free
        // slot of its face, which keeps the order of the vertices.
        let known = || images.iter().enumerate().filter(|(_, image)| image.face != NONE);
        known().for_each(|(_, image)| first[image.face as usize + 1] += 1);
        for face in 0..result.n_faces() {
            first[face + 1] += first[face];
        }
        let mut free = first.clone();
        let mut vertices = vec![0; first[result.n_faces()] as usize];
        for (v, image) in known() {
            let slot = &mut free[image.face as usize];
            vertices[*slot as usize] = v as u32;
            *slot += 1;
        }
        Self { source, result, images, first, vertices }
    }

    /// For each face, a bound on the distance of its points if one of at most `enough` is found.
    pub fn bounds(&self, faces: &[u32], side: Side, (enough, job): (f64, &Job)) -> Vec<Option<f64>> {
        let chunks: Vec<&[u32]> = faces.chunks(CHUNK).collect();
        let parts = par_map(job, &chunks, |_, faces| self.bounds_of_chunk(faces, side, (enough, job)));
        parts.concat()
    }

    fn bounds_of_chunk(&self, faces: &[u32], side: Side, (enough, job): (f64, &Job)) -> Vec<Option<f64>> {
        let (own, other) = match side {
            Side::Source => (self.source, self.result),
            Side::Result => (self.result, self.source),
        };
        let mut near: Vec<u32> = faces.iter().flat_map(|face| self.nearby(*face, side)).collect();
        near.sort_unstable();
        near.dedup();
        if job.is_cancelled() || near.is_empty() {
            return vec![None; faces.len()];
        }
        let positions: Vec<[f64; 3]> = near.iter().flat_map(|face| other.corners(*face)).collect();
        let rows = (0..near.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let Some(checker) = ProximityChecker::from_small_mesh(Mesh::by_construction(positions, rows)) else {
            return vec![None; faces.len()];
        };
        faces.iter().map(|face| checker.distance_within(own.corners(*face), &enough)).collect()
    }

    /// Faces of the other surface near a face; some occur more than once.
    fn nearby(&self, face: u32, side: Side) -> Vec<u32> {
        let around = |surface: &FanSurface, face: u32| {
            surface.vertices(face).map(|v| surface.ring(v).map(|h| h / 3).collect::<Vec<_>>()).concat()
        };
        match side {
            Side::Source => {
                let labels = self.source.vertices(face).map(|v| self.images[v as usize].face);
                labels.into_iter().filter(|f| *f != NONE).flat_map(|f| around(self.result, f)).collect()
            }
            Side::Result => {
                let labelled = |f: u32| {
                    let [from, to] = [f, f + 1].map(|f| self.first[f as usize] as usize);
                    self.vertices[from..to].iter().flat_map(|v| self.source.ring(*v).map(|h| h / 3))
                };
                around(self.result, face).into_iter().flat_map(labelled).collect()
            }
        }
    }
}
