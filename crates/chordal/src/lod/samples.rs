//! `SamplesByFace`: points of the original surface, each held by one face of the simplified surface.
use super::local_tolerance::LocalTolerance;
use super::surface::{Compaction, NONE};
use crate::explicit::distance_sq_to_triangle;

/// A sample that is within half of the allowed distance of the face that held it stays with it; squared. Chosen.
const NEAR: f64 = 4.0;

/// Points that must stay within the tolerance of the surface, in lists by face.
///
/// They only guide the simplification and prove nothing: `check::deviation` proves the points between them at
/// the end.
#[derive(Clone)]
pub(super) struct SamplesByFace {
    pub at: Vec<[f64; 3]>,
    /// By sample: the next one of its face.
    next: Vec<u32>,
    /// By face: its first sample.
    first: Vec<u32>,
    /// By sample: the face that holds it; [`NONE`] where that was removed.
    holder: Vec<u32>,
    /// By sample: the round of its last query, and the face that would hold it then.
    last_query: Vec<(u32, u32)>,
    round: u32,
    /// The pending reassignments of a collapse, until it is carried out: samples with their new faces.
    reassignments: Vec<(u32, u32)>,
}

impl SamplesByFace {
    /// Without samples.
    pub fn new(n_faces: usize) -> Self {
        Self {
            at: Vec::new(),
            next: Vec::new(),
            first: vec![NONE; n_faces],
            holder: Vec::new(),
            last_query: Vec::new(),
            round: 0,
            reassignments: Vec::new(),
        }
    }

    pub fn add(&mut self, at: [f64; 3], face: u32) {
        let sample = self.at.len() as u32;
        self.at.push(at);
        self.holder.push(face);
        self.last_query.push((0, NONE));
        self.next.push(self.first[face as usize]);
        self.first[face as usize] = sample;
    }

    /// Gives every sample to a face.
    pub fn assign(&mut self, holders: Vec<u32>) {
        self.first.fill(NONE);
        for (sample, face) in holders.iter().enumerate() {
            self.next[sample] = std::mem::replace(&mut self.first[*face as usize], sample as u32);
        }
        self.holder = holders;
    }

    /// Renumbers the faces; those that are gone hold nothing.
    pub fn compact(&mut self, kept: &Compaction) {
        self.first = kept.faces(&self.first).collect();
        self.holder
            .iter_mut()
            .filter(|face| **face != NONE)
            .for_each(|face| *face = kept.new_face[*face as usize]);
    }

    /// The samples of a face.
    pub fn of_face(&self, face: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.first[face as usize];
        std::iter::successors((first != NONE).then_some(first), |s| {
            let next = self.next[*s as usize];
            (next != NONE).then_some(next)
        })
    }

    /// Whether all samples of `old` faces are close enough to the `new` triangles; remembers the nearest
    /// triangle of each.
    pub fn try_reassign(&mut self, old: &[u32], new: &[(u32, [[f64; 3]; 3])], room: &LocalTolerance) -> bool {
        self.reassignments.clear();
        self.round += 1;
        for &face in old {
            let own = new.iter().find(|(f, _)| *f == face);
            let mut sample = self.first[face as usize];
            let mut before = NONE;
            while sample != NONE {
                let p = self.at[sample as usize];
                let mut best = (f64::INFINITY, NONE);
                let offer = |best: &mut (f64, u32), (face, corners): &(u32, [[f64; 3]; 3])| {
                    let d = distance_sq_to_triangle(p, *corners);
                    if d < best.0 {
                        *best = (d, *face);
                    }
                };
                // Mostly the face that held it still does.
                own.into_iter().for_each(|own| offer(&mut best, own));
                if !room.holds_sample(sample, best.0 * NEAR) {
                    new.iter().filter(|(f, _)| *f != face).for_each(|new| offer(&mut best, new));
                }
                if !room.holds_sample(sample, best.0) {
                    // Other collapses there will fail at the same one.
                    if before != NONE {
                        self.next[before as usize] = self.next[sample as usize];
                        self.next[sample as usize] =
                            std::mem::replace(&mut self.first[face as usize], sample);
                    }
                    return false;
                }
                self.reassignments.push((sample, best.1));
                self.last_query[sample as usize] = (self.round, best.1);
                before = sample;
                sample = self.next[sample as usize];
            }
        }
        true
    }

    /// Carries out the reassignments that [`SamplesByFace::try_reassign`] found, for the same old faces.
    pub fn commit(&mut self, old: &[u32]) {
        for face in old {
            self.first[*face as usize] = NONE;
        }
        for &(sample, face) in &self.reassignments {
            self.next[sample as usize] = self.first[face as usize];
            self.first[face as usize] = sample;
            self.holder[sample as usize] = face;
        }
    }

    /// The samples that [`SamplesByFace::try_reassign`] visited, with the faces that would hold them.
    pub fn reassignments(&self) -> &[(u32, u32)] {
        &self.reassignments
    }

    /// The face that holds a sample.
    pub fn holder(&self, sample: u32) -> u32 {
        self.holder[sample as usize]
    }

    /// The face that would hold a sample after the pending collapse, where that is another one or around it.
    #[inline]
    pub fn pending_holder(&self, sample: u32) -> Option<u32> {
        let (round, face) = self.last_query[sample as usize];
        (round == self.round).then_some(face)
    }

    /// The face that would hold a sample after the pending collapse.
    pub fn holder_after(&self, sample: u32) -> u32 {
        self.pending_holder(sample).unwrap_or(self.holder[sample as usize])
    }
}
