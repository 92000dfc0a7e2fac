//! `SamplesByFace`: points of the original surface, each held by one face of the simplified surface.
use super::local_tolerance::LocalTolerance;
use super::surface::{Compaction, NONE};
use crate::explicit::distance_sq_to_triangle;
use crate::math::{cross, difference, dot, greater};

/// A sample stays with its face if it is within half of the allowed distance from it; as a factor of squares.
/// Chosen: a larger value searches for nearer faces more often.
pub(super) const NEAR: f64 = 4.0;

/// Points whose distance from the surface must stay within the tolerance, in lists by face.
///
/// They only guide the simplification and prove nothing: `check::deviation` proves the points between them at
/// the end.
#[derive(Clone)]
pub(super) struct SamplesByFace {
    samples: Vec<Sample>,
    /// By face: its first sample.
    first: Vec<u32>,
    round: u32,
    /// The pending reassignments of a collapse: samples with their new faces.
    reassignments: Vec<(u32, u32)>,
    /// The squared distance at which the last query failed; 0 if it succeeded.
    pub failed_at_sq: f64,
    /// Over the triangles of the last query.
    prisms: Vec<Prism>,
}

/// All data of a sample together, since memory access limits the speed of queries.
#[derive(Clone, Copy)]
struct Sample {
    at: [f64; 3],
    /// The next sample of its face.
    next: u32,
    /// The face that holds it; [`NONE`] if that was removed.
    holder: u32,
    /// The round of its last query, and the face that would hold it after that.
    round: u32,
    pending: u32,
}

/// The region straight above and below a triangle.
#[derive(Clone, Copy)]
struct Prism {
    /// The planes of the sides, ≥ 0 inside.
    sides: [([f64; 3], f64); 3],
    /// The plane of the triangle, with a unit normal; NaN for needles and triangles without area.
    plane: ([f64; 3], f64),
}

impl Prism {
    fn over([a, b, c]: [[f64; 3]; 3]) -> Self {
        let (ab, ac, bc) = (difference(b, a), difference(c, a), difference(c, b));
        let normal = cross(ab, ac);
        let square = dot(normal, normal);
        let longest = greater(greater(dot(ab, ab), dot(ac, ac)), dot(bc, bc));
        // For a needle everything below becomes NaN, so that all comparisons are false and no point is above
        // it.
        let by = if square > NEEDLE * longest * longest { 1.0 / square.sqrt() } else { f64::NAN };
        let normal = normal.map(|x| x * by);
        let side = |from: [f64; 3], along: [f64; 3]| {
            let inward = cross(normal, along);
            (inward, -dot(inward, from))
        };
        let sides = [side(a, ab), side(b, bc), side(c, ac.map(|x| -x))];
        Self { sides, plane: (normal, -dot(normal, a)) }
    }

    /// The squared distance from the triangle, rounded, for points in the prism; infinite for other points.
    #[inline]
    fn height_sq(&self, p: [f64; 3]) -> f64 {
        let over = |(normal, offset): &([f64; 3], f64)| dot(*normal, p) + offset;
        let [u, v, w] = self.sides.each_ref().map(over);
        let height = over(&self.plane);
        if u >= 0.0 && v >= 0.0 && w >= 0.0 { height * height } else { f64::INFINITY }
    }
}

/// A triangle is a needle if the square of its doubled area is below this fraction of the fourth power of its
/// longest edge. Chosen: the heights above other triangles lose few digits.
const NEEDLE: f64 = 1.0 / 65536.0;

impl SamplesByFace {
    /// Without samples.
    pub fn new(n_faces: usize) -> Self {
        Self {
            samples: Vec::new(),
            first: vec![NONE; n_faces],
            round: 0,
            reassignments: Vec::new(),
            failed_at_sq: 0.0,
            prisms: Vec::new(),
        }
    }

    /// The number of faces, including removed ones.
    pub fn n_faces(&self) -> usize {
        self.first.len()
    }

    /// The number of samples.
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// The position of a sample.
    #[inline]
    pub fn at(&self, sample: u32) -> [f64; 3] {
        self.samples[sample as usize].at
    }

    /// The positions of all samples.
    pub fn points(&self) -> impl Iterator<Item = [f64; 3]> {
        self.samples.iter().map(|sample| sample.at)
    }

    pub fn add(&mut self, at: [f64; 3], face: u32) {
        let sample = self.samples.len() as u32;
        let next = std::mem::replace(&mut self.first[face as usize], sample);
        self.samples.push(Sample { at, next, holder: face, round: 0, pending: NONE });
    }

    /// The faces that hold the samples, by sample.
    pub fn holders(&self) -> impl Iterator<Item = u32> {
        self.samples.iter().map(|sample| sample.holder)
    }

    /// Some of the samples, with the faces that hold them among `n_faces` faces, or [`NONE`].
    pub fn some(&self, samples: &[u32], holders: &[u32], n_faces: usize) -> Self {
        let mut some = Self::new(n_faces);
        let sample = |s: &u32| Sample { at: self.at(*s), next: NONE, holder: NONE, round: 0, pending: NONE };
        some.samples = samples.iter().map(sample).collect();
        some.assign(holders);
        some
    }

    /// Drops samples; the others keep their order.
    pub fn retain(&mut self, is_kept: &[bool]) {
        let holders: Vec<u32> =
            self.holders().zip(is_kept).filter(|(_, is_kept)| **is_kept).map(|(face, _)| face).collect();
        let mut flags = is_kept.iter();
        self.samples.retain(|_| flags.next() == Some(&true));
        self.samples.shrink_to_fit();
        self.assign(&holders);
    }

    /// Assigns every sample to a face, or to [`NONE`].
    pub fn assign(&mut self, holders: &[u32]) {
        self.first.fill(NONE);
        for (i, (sample, face)) in self.samples.iter_mut().zip(holders).enumerate() {
            sample.holder = *face;
            if *face != NONE {
                sample.next = std::mem::replace(&mut self.first[*face as usize], i as u32);
            }
        }
    }

    /// Renumbers the faces; removed faces hold nothing.
    pub fn compact(&mut self, compaction: &Compaction) {
        self.first = compaction.faces(&self.first).collect();
        for sample in self.samples.iter_mut().filter(|sample| sample.holder != NONE) {
            sample.holder = compaction.new_face[sample.holder as usize];
        }
    }

    /// Undoes [`Self::compact`].
    pub fn expand(&mut self, compaction: &Compaction) {
        self.first = compaction.by_old_face(&self.first, NONE);
        self.samples.iter_mut().for_each(|sample| sample.holder = compaction.old_face(sample.holder));
    }

    /// The samples of a face.
    pub fn of_face(&self, face: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.first[face as usize];
        std::iter::successors((first != NONE).then_some(first), |s| {
            let next = self.samples[*s as usize].next;
            (next != NONE).then_some(next)
        })
    }

    /// Whether all samples of `old` faces are close enough to the `new` triangles; records the nearest
    /// triangle of each.
    pub fn try_reassign(
        &mut self,
        old: &[u32],
        new: &[(u32, [[f64; 3]; 3])],
        tolerance: &LocalTolerance,
    ) -> bool {
        let Self { samples, first, round, reassignments, failed_at_sq, prisms } = self;
        reassignments.clear();
        *failed_at_sq = 0.0;
        *round += 1;
        prisms.clear();
        prisms.extend(new.iter().map(|(_, triangle)| Prism::over(*triangle)));
        for &face in old {
            let own_triangle = new.iter().position(|(f, _)| *f == face);
            let mut sample = first[face as usize];
            let mut before = NONE;
            while sample != NONE {
                let p = samples[sample as usize].at;
                let mut best = (f64::INFINITY, NONE);
                // Usually a sample is straight above its current face, or else above another one.
                let offer = |best: &mut (f64, u32), k: usize| {
                    let d = prisms[k].height_sq(p);
                    if d < best.0 {
                        *best = (d, new[k].0);
                    }
                };
                match own_triangle {
                    Some(own_triangle) => offer(&mut best, own_triangle),
                    None => (0..new.len()).for_each(|k| offer(&mut best, k)),
                }
                if !tolerance.holds_sample(sample, best.0 * NEAR) {
                    let offer = |best: &mut (f64, u32), (face, corners): &(u32, [[f64; 3]; 3])| {
                        let d = distance_sq_to_triangle(p, *corners);
                        if d < best.0 {
                            *best = (d, *face);
                        }
                    };
                    // Points beside the prisms need true distances: first from the own triangle, then from
                    // the others.
                    own_triangle.into_iter().for_each(|own_triangle| offer(&mut best, &new[own_triangle]));
                    if !tolerance.holds_sample(sample, best.0 * NEAR) {
                        new.iter().filter(|(f, _)| *f != face).for_each(|new| offer(&mut best, new));
                    }
                }
                // If the square of the tolerance overflows, any distance is allowed, but there must be a
                // triangle.
                if best.1 == NONE || !tolerance.holds_sample(sample, best.0) {
                    // Moved to the front, since other collapses there will fail at the same sample.
                    if before != NONE {
                        samples[before as usize].next = samples[sample as usize].next;
                        samples[sample as usize].next = std::mem::replace(&mut first[face as usize], sample);
                    }
                    *failed_at_sq = best.0;
                    return false;
                }
                reassignments.push((sample, best.1));
                let entry = &mut samples[sample as usize];
                (entry.round, entry.pending) = (*round, best.1);
                before = sample;
                sample = entry.next;
            }
        }
        true
    }

    /// Carries out the reassignments found by [`SamplesByFace::try_reassign`], for the same old faces.
    pub fn commit(&mut self, old: &[u32]) {
        for face in old {
            self.first[*face as usize] = NONE;
        }
        for &(sample, face) in &self.reassignments {
            let moved = &mut self.samples[sample as usize];
            moved.next = std::mem::replace(&mut self.first[face as usize], sample);
            moved.holder = face;
        }
    }

    /// The samples visited by [`SamplesByFace::try_reassign`], with the faces that would hold them.
    pub fn reassignments(&self) -> &[(u32, u32)] {
        &self.reassignments
    }

    /// The face that holds a sample.
    pub fn holder(&self, sample: u32) -> u32 {
        self.samples[sample as usize].holder
    }

    /// The face that would hold a sample after the pending collapse, if that affects the sample.
    #[inline]
    pub fn pending_holder(&self, sample: u32) -> Option<u32> {
        let Sample { round, pending, .. } = self.samples[sample as usize];
        (round == self.round).then_some(pending)
    }

    /// The face that would hold a sample after the pending collapse.
    pub fn holder_after(&self, sample: u32) -> u32 {
        self.pending_holder(sample).unwrap_or_else(|| self.holder(sample))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn a_height_is_the_distance_or_there_is_none() {
        let mut random = Random::new(5);
        let mut over = 0;
        for _ in 0..2000 {
            let triangle = [random.point(), random.point(), random.point()];
            let p = random.point();
            let (height, distance) =
                (Prism::over(triangle).height_sq(p), distance_sq_to_triangle(p, triangle));
            if height < f64::INFINITY {
                over += 1;
                assert!((height - distance).abs() <= 1e-12 * (1.0 + distance), "{height} and {distance}");
            }
        }
        assert!(over > 100, "{over}");
        let needle = [[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1e-9, 0.0]];
        assert_eq!(Prism::over(needle).height_sq([0.5, 0.0, 1.0]), f64::INFINITY);
        assert_eq!(Prism::over([[1.0; 3]; 3]).height_sq([1.0; 3]), f64::INFINITY);
    }
}
