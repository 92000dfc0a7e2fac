//! Another attempt after one that was too far off in some places: what it did elsewhere is done again without a look.
use super::super::edge_collapse::{EdgeCollapser, StopCriterion, face_standing_for, representative};
use super::super::local_tolerance::LocalTolerance;
use super::super::surface::NONE;
use super::MeshReduction;
use crate::budget::{Job, JobError};
use crate::check::ViolationReport;

/// How often more is left open, where points of the original are too far from what was done again. Chosen.
const ROUNDS: u32 = 4;

impl<'a> MeshReduction<'a> {
    /// From the state in which `tried` began, what `tried` did, but for what led to faces that are too far from the other
    /// surface; `rings` of edges around these are left out as well. [`Self::run_open`] goes on from there. `None` where
    /// too little fits together.
    pub fn retry(
        &self,
        tried: &mut Self,
        places: &ViolationReport,
        (room, rings): (&LocalTolerance, u32),
    ) -> Option<Self> {
        let past = tried.engine.log.take()?;
        let mut is_far = tried.vertices_at(places, rings);
        for _ in 0..ROUNDS {
            let mut again = self.clone();
            again.engine.log = Some(Vec::with_capacity(past.len()));
            let merged_into = &mut tried.engine.merged_into;
            let mut is_open: Vec<bool> = (0..self.engine.at.len() as u32)
                .map(|v| is_far[representative(merged_into, v) as usize])
                .collect();
            again.engine.replay(&past, &mut is_open);
            let far = again.assign_as(tried, room);
            if far.is_empty() {
                return Some(again);
            }
            for v in far.into_iter().flat_map(|face| again.engine.surface.corners(face)) {
                is_far[representative(&mut tried.engine.merged_into, v) as usize] = true;
            }
        }
        None
    }

    /// Goes on with what [`Self::retry`] left open.
    pub fn run_open(&mut self, room: &LocalTolerance, job: &Job) -> Result<(), JobError> {
        let until = StopCriterion { faces: 0, tolerance: room, share: None };
        if self.engine.empty_queue(&until, job) { Ok(()) } else { Err(JobError::Cancelled) }
    }

    /// By vertex: whether it belongs to a face that is too far from the original, or that stands for one of the original
    /// that is.
    fn vertices_at(&self, places: &ViolationReport, rings: u32) -> Vec<bool> {
        let surface = &self.engine.surface;
        let mut is_far = vec![false; self.engine.at.len()];
        let faces = self.faces();
        let mut found: Vec<u32> = places.violations[1].iter().map(|far| faces[far.face as usize]).collect();
        if let Some(monitor) = &self.engine.monitor {
            for far in &places.violations[0] {
                let corners = monitor.original_corners(far.face).into_iter().filter(|v| *v != NONE);
                found.extend(corners.map(|v| monitor.samples.holder(v)));
            }
        }
        let is_there = |face: &u32| *face != NONE && surface.corners(*face)[0] != NONE;
        let mut vertices: Vec<u32> =
            found.into_iter().filter(is_there).flat_map(|face| surface.corners(face)).collect();
        for ring in 0..=rings {
            vertices.sort_unstable();
            vertices.dedup();
            vertices.iter().for_each(|v| is_far[*v as usize] = true);
            if ring < rings {
                vertices =
                    vertices.iter().flat_map(|v| surface.one_ring(*v)).map(|h| surface.end(h)).collect();
            }
        }
        is_far
    }

    /// Gives every sample the face that held it in `tried` where that is the same, and the nearest one, as far as a
    /// descent tells, elsewhere. Returns faces from which samples are too far.
    fn assign_as(&mut self, tried: &Self, room: &LocalTolerance) -> Vec<u32> {
        let (Some(mut monitor), Some(then)) = (self.engine.monitor.take(), &tried.engine.monitor) else {
            return Vec::new();
        };
        let (now, before) = (&self.engine, &tried.engine);
        let is_same: Vec<bool> = (0..(now.surface.start.len() / 3) as u32)
            .map(|face| {
                let corners = now.surface.corners(face);
                let is_at = |v: u32| now.at[v as usize] == before.at[v as usize];
                corners[0] != NONE
                    && corners == before.surface.corners(face)
                    && corners.into_iter().all(is_at)
            })
            .collect();
        let mut far = Vec::new();
        let mut holders = Vec::with_capacity(monitor.samples.len());
        for sample in 0..monitor.samples.len() as u32 {
            let held = then.samples.holder(sample);
            if held == NONE || is_same[held as usize] {
                holders.push(held);
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
            if !room.holds_sample(sample, distance_sq) {
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

    fn attempt<'a>(from: &MeshReduction<'a>, room: &LocalTolerance) -> MeshReduction<'a> {
        let mut tried = from.clone();
        tried.run(0, room, &Job::default()).unwrap();
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
        let mut from = MeshReduction::new(&mesh, Topology::Indices);
        from.start_monitor(&Job::default()).unwrap();
        let room = LocalTolerance::uniform(0.01);
        let mut tried = attempt(&from, &room);
        assert!(tried.n_faces() < 300);
        let mut again = from.retry(&mut tried, &places(&[], &[]), (&room, 0)).unwrap();
        assert_eq!(again.n_faces(), tried.n_faces());
        again.run_open(&room, &Job::default()).unwrap();
        assert_eq!(again.mesh(), tried.mesh());
        assert_eq!(again.near_faces(), tried.near_faces());
    }

    #[test]
    fn what_is_left_out_is_small_and_all_samples_stay_close() {
        let mesh = hills(24);
        let mut from = MeshReduction::new(&mesh, Topology::Indices);
        from.start_monitor(&Job::default()).unwrap();
        let room = LocalTolerance::uniform(0.01);
        let mut random = Random::new(2);
        for _ in 0..20 {
            let mut tried = attempt(&from, &room);
            let (n_before, n) = (tried.n_faces(), mesh.faces().len());
            let of_result = [random.below(n_before) as u32];
            let of_original = [random.below(n) as u32];
            let again = from.retry(&mut tried, &places(&of_original, &of_result), (&room, 1));
            let mut again = again.unwrap();
            assert!(n_before < again.n_faces() && again.n_faces() < n, "{}", again.n_faces());
            let made = again.mesh();
            for (p, face) in mesh.positions().iter().zip(again.near_faces()) {
                assert!(distance_sq_to_triangle(*p, made.corners(face as usize)) <= 0.0101 * 0.0101);
            }
            again.run_open(&room, &Job::default()).unwrap();
            assert!(again.n_faces() < n_before + n_before / 4, "{} of {n_before}", again.n_faces());
        }
    }
}
