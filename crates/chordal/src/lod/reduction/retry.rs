//! Another attempt after a failed one: its collapses are repeated without checks, except where it failed.
use super::super::edge_collapse::{EdgeCollapser, StopCriterion, face_standing_for, representative};
use super::super::local_tolerance::LocalTolerance;
use super::super::surface::NONE;
use super::{FailedAttempt, MeshReduction};
use crate::budget::{Job, JobError};
use crate::check::ViolationReport;

/// How often more collapses are undone if points of the original are too far from the repeated ones. Chosen:
/// a larger number rarely helps.
const ROUNDS: u32 = 2;

impl<'a> MeshReduction<'a> {
    /// From the state in which a failed attempt began, repeats its collapses, except for those that led to
    /// faces too far from the other surface, and those within `rings` edges of these. [`Self::run_open`]
    /// continues from there.
    pub fn retry(
        &self,
        failed: &mut FailedAttempt,
        report: &ViolationReport,
        (tolerance, rings): (&LocalTolerance, u32),
    ) -> Self {
        let mut is_far = failed.vertices_at(report, rings);
        let (mut retried, mut far) = self.replay_except(failed, &is_far, tolerance);
        for _ in 1..ROUNDS {
            if far.is_empty() {
                break;
            }
            for v in far.into_iter().flat_map(|face| retried.engine.surface.corners(face)) {
                is_far[representative(&mut failed.merged_into, v) as usize] = true;
            }
            (retried, far) = self.replay_except(failed, &is_far, tolerance);
        }
        retried
    }

    /// Repeats the collapses of an attempt, except at far vertices, in the numbers of its result; also
    /// returns the faces that are too far from points of the original.
    fn replay_except(
        &self,
        failed: &mut FailedAttempt,
        is_far: &[bool],
        tolerance: &LocalTolerance,
    ) -> (Self, Vec<u32>) {
        let mut retried = self.clone();
        retried.engine.log = Some(Vec::with_capacity(failed.log.len()));
        let mut is_open: Vec<bool> = (0..self.engine.at.len() as u32)
            .map(|v| is_far[representative(&mut failed.merged_into, v) as usize])
            .collect();
        retried.engine.replay(&failed.log, &mut is_open);
        let far = retried.assign_as(failed, tolerance);
        (retried, far)
    }

    /// Continues at the vertices that [`Self::retry`] left open.
    pub fn run_open(&mut self, faces: usize, tolerance: &LocalTolerance, job: &Job) -> Result<(), JobError> {
        let until = StopCriterion { faces, tolerance, share: None };
        if self.engine.empty_queue(&until, job) { Ok(()) } else { Err(JobError::Cancelled) }
    }

    /// Assigns every sample to the face that held it in the failed attempt if that face is unchanged, and
    /// otherwise to the nearest one, as far as a descent finds it. Returns the faces from which samples are
    /// too far.
    fn assign_as(&mut self, failed: &FailedAttempt, tolerance: &LocalTolerance) -> Vec<u32> {
        let (Some(mut monitor), Some(then)) = (self.engine.monitor.take(), &failed.monitor) else {
            return Vec::new();
        };
        let now = &self.engine;
        let is_same: Vec<bool> = (0..(now.surface.start.len() / 3) as u32)
            .map(|face| {
                let corners = now.surface.corners(face);
                // A vertex may have been moved elsewhere, although it has the same number.
                let is_at = |v: u32| now.at[v as usize] == failed.at[v as usize];
                corners[0] != NONE
                    && corners == failed.surface.corners(face)
                    && corners.into_iter().all(is_at)
            })
            .collect();
        let mut far = Vec::new();
        let mut holders = Vec::with_capacity(monitor.samples.len());
        for sample in 0..monitor.samples.len() as u32 {
            let holder = then.samples.holder(sample);
            // A triangle that is as it was is as near to its samples as it was.
            if holder == NONE || is_same[holder as usize] {
                holders.push(holder);
                continue;
            }
            let v = self.vertex_of_start[monitor.vertex_beside(sample) as usize];
            let EdgeCollapser { surface, merged_into, at, .. } = &mut self.engine;
            let near = face_standing_for(surface, merged_into, v);
            if near == NONE {
                holders.push(NONE);
                continue;
            }
            let (face, distance_sq) = surface.descend(near, monitor.samples.at(sample), at);
            if !tolerance.holds_sample(sample, distance_sq) {
                far.push(face);
            }
            holders.push(face);
        }
        monitor.samples.assign(&holders);
        self.engine.monitor = Some(monitor);
        far
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::ToleranceViolation;
    use crate::explicit::{Mesh, Topology, distance_sq_to_triangle};
    use chordal_testkit::Random;

    /// A square of `n` × `n` cells over hills.
    fn hills(n: u32) -> Mesh {
        let at = |i: u32, j: u32| {
            let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            [x, y, 0.1 * libm::sin(9.0 * x) * libm::cos(7.0 * y)]
        };
        let positions = (0..=n).flat_map(|i| (0..=n).map(move |j| at(i, j))).collect();
        let cell = |i: u32, j: u32| {
            let a = (n + 1) * i + j;
            [[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]]
        };
        Mesh::new(positions, (0..n).flat_map(|i| (0..n).flat_map(move |j| cell(i, j))).collect()).unwrap()
    }

    fn with_monitor(mesh: &Mesh) -> (MeshReduction<'_>, LocalTolerance) {
        let mut from = MeshReduction::new(mesh, Topology::Indices);
        from.start_monitor(&Job::default()).unwrap();
        (from, LocalTolerance::uniform(0.01))
    }

    fn attempt<'a>(from: &MeshReduction<'a>, tolerance: &LocalTolerance) -> MeshReduction<'a> {
        let mut tried = from.clone();
        tried.run(0, tolerance, &Job::default()).unwrap();
        tried
    }

    /// Violations at some faces of either surface.
    fn places(of_original: &[u32], of_result: &[u32]) -> ViolationReport {
        let far = |face: &u32| ToleranceViolation { face: *face, at: [0.0; 3], distance: 1.0 };
        let violations = [of_original, of_result].map(|faces| faces.iter().map(far).collect());
        ViolationReport { violations, at_most: 1.0, pixels: 0.0 }
    }

    #[test]
    fn without_places_everything_is_done_again() {
        let mesh = hills(24);
        let (from, tolerance) = with_monitor(&mesh);
        let mut tried = attempt(&from, &tolerance);
        assert!(tried.n_faces() < 300);
        let mut failed = FailedAttempt::new(tried.clone());
        let mut again = from.retry(&mut failed, &places(&[], &[]), (&tolerance, 0));
        assert_eq!(again.n_faces(), tried.n_faces());
        again.run_open(0, &tolerance, &Job::default()).unwrap();
        assert_eq!(again.mesh(), tried.mesh());
        assert_eq!(again.near_faces(), tried.near_faces());
    }

    #[test]
    fn collapses_without_a_monitor_are_done_again_as_well() {
        let mesh = hills(24);
        let (from, tolerance) = with_monitor(&mesh);
        for share in [0.02, 0.25] {
            let mut tried = from.clone();
            tried.run_unmonitored((share, &[]), 0, &tolerance, &Job::default()).unwrap().unwrap();
            let n_unmonitored = tried.n_faces();
            let unmonitored = tried.compact_unmonitored();
            tried.run(0, &tolerance, &Job::default()).unwrap();
            assert!(tried.n_faces() < n_unmonitored && n_unmonitored < mesh.faces().len());
            let mut failed = FailedAttempt::new(tried.clone());
            failed.prepend(&unmonitored);
            let mut again = from.retry(&mut failed, &places(&[], &[]), (&tolerance, 0));
            assert_eq!(again.mesh(), tried.mesh());
            assert_eq!(again.near_faces(), tried.near_faces());
            // A place far from others is opened down to what the collapses without a monitor did there.
            let open = from.retry(&mut failed, &places(&[], &[0]), (&tolerance, 0));
            assert!(tried.n_faces() < open.n_faces() && open.n_faces() < n_unmonitored.max(300));
        }
    }

    #[test]
    fn what_is_left_out_is_small_and_all_samples_stay_close() {
        let mesh = hills(24);
        let (from, tolerance) = with_monitor(&mesh);
        let mut random = Random::new(2);
        for _ in 0..20 {
            let tried = attempt(&from, &tolerance);
            let (n_before, n) = (tried.n_faces(), mesh.faces().len());
            let of_result = [random.below(n_before) as u32];
            let of_original = [random.below(n) as u32];
            let mut failed = FailedAttempt::new(tried);
            let mut again = from.retry(&mut failed, &places(&of_original, &of_result), (&tolerance, 1));
            assert!(n_before < again.n_faces() && again.n_faces() < n, "{}", again.n_faces());
            let made = again.mesh();
            for (p, face) in mesh.positions().iter().zip(again.near_faces()) {
                assert!(distance_sq_to_triangle(*p, made.corners(face as usize)) <= 0.0101 * 0.0101);
            }
            again.run_open(0, &tolerance, &Job::default()).unwrap();
            assert!(again.n_faces() < n_before + n_before / 4, "{} of {n_before}", again.n_faces());
        }
    }
}
