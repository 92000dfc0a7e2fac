//! Collapses in all regions of a large surface in parallel, then along the lines between them.
use super::super::region_tree::halve;
use super::super::surface::{HalfEdgeSurface, NONE, RegionNumbers, SurfaceRegion};
use super::{CollapseVertexKind, EdgeCollapser, PastCollapse, StopCriterion};
use crate::budget::{Job, par_map};

/// The most faces of one region. Measured: a smaller number leaves more triangles along lines between
/// regions, a larger one occupies fewer threads.
const MOST_FACES: usize = 65_536;
/// A region with more samples is divided as well, unless it has few faces. Chosen: it limits the memory and
/// time of a region.
const MOST_SAMPLES: usize = 131_072;
const LEAST_FACES: usize = 16_384;

/// The remaining faces of a surface by region, and the vertices that stay fixed while each region is
/// collapsed by itself.
struct CollapseRegions {
    /// By region: its faces, ascending.
    faces: Vec<Vec<u32>>,
    /// By vertex: whether it has faces in several regions, or is locked.
    is_between: Vec<bool>,
}

impl CollapseRegions {
    /// `None` if one region holds all faces.
    fn new(engine: &EdgeCollapser, most_faces: usize) -> Option<Self> {
        let EdgeCollapser { surface, at, kind, monitor, .. } = engine;
        let n_samples = |faces: &[u32]| {
            let n_held =
                |face: &u32| monitor.as_ref().map_or(0, |monitor| monitor.samples.of_face(*face).count());
            faces.iter().map(n_held).sum::<usize>()
        };
        let middle = |face: u32| {
            let [a, b, c] = surface.corners(face).map(|v| at[v as usize]);
            std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
        };
        let centres: Vec<[f64; 3]> = (0..(surface.start.len() / 3) as u32)
            // Removed faces are in no region, so any centre will do.
            .map(|face| if surface.corners(face)[0] == NONE { [0.0; 3] } else { middle(face) })
            .collect();
        let mut open = vec![surface.faces()];
        let mut faces = Vec::new();
        while let Some(mut region) = open.pop() {
            let is_large = region.len() > most_faces
                || (region.len() > LEAST_FACES && n_samples(&region) > MOST_SAMPLES);
            if is_large {
                let middle = halve(&mut region, &centres);
                let second_half = region.split_off(middle);
                open.extend([second_half, region]);
            } else {
                // Ascending, since `put_back` searches in it.
                region.sort_unstable();
                faces.push(region);
            }
        }
        if faces.len() == 1 {
            return None;
        }
        // Vertices of several regions stay, so that regions fit together whatever is collapsed in each.
        let mut region_of = vec![NONE; at.len()];
        let mut is_between: Vec<bool> = kind.iter().map(|kind| *kind == CollapseVertexKind::Locked).collect();
        for (number, region) in (0..).zip(&faces) {
            for v in region.iter().flat_map(|face| surface.corners(*face)) {
                let previous = std::mem::replace(&mut region_of[v as usize], number);
                is_between[v as usize] |= previous != NONE && previous != number;
            }
        }
        Some(Self { faces, is_between })
    }
}

/// A region, with its arrays.
struct RegionCollapser {
    engine: EdgeCollapser,
    region: SurfaceRegion,
    /// By row of its corners' values, and by sample of its monitor: the numbers in the whole surface.
    rows: Option<Vec<u32>>,
    samples: Option<Vec<u32>>,
}

/// A collapsed region, without its monitor.
struct CollapsedRegion {
    engine: EdgeCollapser,
    region: SurfaceRegion,
    rows: Option<Vec<u32>>,
    /// Samples, with the faces that hold them in the numbers of the whole surface.
    holders: Vec<(u32, u32)>,
}

impl EdgeCollapser {
    /// Like [`Self::run`], in parallel within regions of a large surface, then between them. Each region
    /// stops at its share of the number of faces. The result does not depend on the number of threads.
    pub fn run_in_regions(&mut self, until: &StopCriterion<'_>, job: &Job) -> bool {
        self.run_in_regions_of(MOST_FACES, until, job)
    }

    fn run_in_regions_of(&mut self, most_faces: usize, until: &StopCriterion<'_>, job: &Job) -> bool {
        let Some(CollapseRegions { faces, is_between }) = CollapseRegions::new(self, most_faces) else {
            return self.run(until, job);
        };
        let engine = &*self;
        let n_samples = engine.monitor.as_ref().map_or(0, |monitor| monitor.samples.len());
        let numbers = RegionNumbers::new(engine.at.len().max(engine.surface.start.len() / 3).max(n_samples));
        let collapsed = par_map(job, &faces, |_, faces| {
            if job.is_cancelled() {
                return None;
            }
            let mut region = RegionCollapser::new(engine, (faces, &numbers), &is_between);
            let share = faces.len() as f64 / engine.surface.n_faces as f64;
            let until = StopCriterion { faces: (share * until.faces as f64) as usize, ..*until };
            region.engine.run(&until, job).then(|| region.finish())
        });
        let Some(collapsed) = collapsed.into_iter().collect::<Option<Vec<CollapsedRegion>>>() else {
            return false;
        };
        let mut holders: Vec<u32> =
            self.monitor.as_ref().map_or_else(Vec::new, |monitor| monitor.samples.holders().collect());
        // In the order of the regions, whatever thread has finished first.
        for region in collapsed {
            region.holders.iter().for_each(|(sample, face)| holders[*sample as usize] = *face);
            self.put_back(region);
        }
        self.monitor.iter_mut().for_each(|monitor| monitor.samples.assign(&holders));
        // Only edges at the vertices that were fixed until now are still open.
        self.enqueue_around(&is_between);
        self.empty_queue(until, job)
    }

    /// Takes over a collapsed region.
    fn put_back(&mut self, collapsed: CollapsedRegion) {
        let CollapsedRegion { engine, region, rows, .. } = collapsed;
        self.surface.put_back(&engine.surface, &region);
        for (local, v) in region.vertices.iter().map(|v| *v as usize).enumerate() {
            self.at[v] = engine.at[local];
            self.quadric[v] = engine.quadric[local];
            self.kind[v] = engine.kind[local];
            self.source_vertex[v] = engine.source_vertex[local];
            self.is_original[v] = engine.is_original[local];
            self.feature_deviation[v] = engine.feature_deviation[local];
            let into = engine.merged_into[local] as usize;
            if into != local {
                self.merged_into[v] = region.vertices[into];
            }
        }
        for (local, face) in region.faces.iter().map(|face| *face as usize).enumerate() {
            self.face_cost[face] = engine.face_cost[local];
            for k in 0..3 {
                self.is_line[3 * face + k] = engine.is_line[3 * local + k];
                self.refused_within[3 * face + k] = engine.refused_within[3 * local + k];
            }
        }
        if let (Some(wedges), Some(part), Some(rows)) = (&mut self.wedges, &engine.wedges, &rows) {
            wedges.put_back(part, rows, &region);
        }
        if let (Some(log), Some(more)) = (&mut self.log, engine.log) {
            log.extend(more.iter().map(|past| past.in_whole(&region)));
        }
    }
}

impl RegionCollapser {
    fn new(engine: &EdgeCollapser, (faces, numbers): (&[u32], &RegionNumbers), is_between: &[bool]) -> Self {
        let (surface, region) = engine.surface.region(faces, numbers);
        // Fans at one position are found by its number in the whole mesh.
        let n_visited = if engine.has_fans { engine.visited.len() } else { region.vertices.len() };
        let (wedges, rows) = engine.wedges.as_ref().map(|wedges| wedges.region(&region)).unzip();
        let (monitor, samples) =
            engine.monitor.as_ref().map(|monitor| monitor.region(&region, numbers)).unzip();
        let vertices = || region.vertices.iter().map(|v| *v as usize);
        let half_edges = || region.half_edges().map(|h| h as usize);
        let engine = EdgeCollapser {
            at: vertices().map(|v| engine.at[v]).collect(),
            quadric: vertices().map(|v| engine.quadric[v]).collect(),
            kind: vertices().map(|v| engine.kind[v]).collect(),
            source_vertex: vertices().map(|v| engine.source_vertex[v]).collect(),
            first_fan: engine.first_fan.clone(),
            has_fans: engine.has_fans,
            is_line: half_edges().map(|h| engine.is_line[h]).collect(),
            monitor,
            wedges,
            // A surface with a guard is not divided.
            attribute_guard: None,
            is_original: vertices().map(|v| engine.is_original[v]).collect(),
            feature_deviation: vertices().map(|v| engine.feature_deviation[v]).collect(),
            merged_into: (0..region.vertices.len() as u32).collect(),
            log: engine.log.is_some().then(Vec::new),
            face_cost: region.faces.iter().map(|face| engine.face_cost[*face as usize]).collect(),
            is_held: vertices().map(|v| is_between[v] || engine.is_held[v]).collect(),
            refused_within: half_edges().map(|h| engine.refused_within[h]).collect(),
            is_queued: vec![false; surface.start.len()],
            queue: super::BucketQueue::new(),
            visited: vec![0; n_visited],
            round: 0,
            after: Vec::new(),
            opposite: Vec::new(),
            before: Vec::new(),
            surface,
        };
        Self { engine, region, rows, samples }
    }

    /// Frees the arrays that are not put back.
    fn finish(self) -> CollapsedRegion {
        let Self { mut engine, region, rows, samples } = self;
        let holders = match (engine.monitor.take(), samples) {
            (Some(monitor), Some(samples)) => {
                let holder = |(local, sample): (u32, u32)| {
                    let face = monitor.samples.holder(local);
                    // Other samples are held by faces of other regions.
                    (face != NONE).then(|| (sample, region.faces[face as usize]))
                };
                (0..).zip(samples).filter_map(holder).collect()
            }
            _ => Vec::new(),
        };
        engine.queue = super::BucketQueue::new();
        (engine.is_held, engine.is_queued, engine.visited) = Default::default();
        CollapsedRegion { engine, region, rows, holders }
    }
}

impl PastCollapse {
    /// The same collapse in the numbers of the whole surface.
    fn in_whole(&self, region: &SurfaceRegion) -> Self {
        let h = region.half_edge(self.collapse.h);
        let ends = self.ends.map(|v| region.vertices[v as usize]);
        Self { collapse: super::EdgeCollapse { h, ..self.collapse }, ends }
    }
}

impl HalfEdgeSurface {
    /// Some faces, ascending, as a separate surface. It has a border where other faces adjoin; a vertex there
    /// has only one of its fans, and stays fixed.
    fn region(&self, faces: &[u32], numbers: &RegionNumbers) -> (Self, SurfaceRegion) {
        let mut vertices: Vec<u32> = faces.iter().flat_map(|face| self.corners(*face)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let region = SurfaceRegion { faces: faces.to_vec(), vertices };
        let start: Vec<u32> = numbers.of(&region.vertices, |local| {
            region.half_edges().map(|h| local[self.start[h as usize] as usize]).collect()
        });
        let (twin, mut outgoing): (Vec<u32>, Vec<u32>) = numbers.of(faces, |local| {
            let half_edge = |h: u32| match h {
                NONE => NONE,
                h => match local[h as usize / 3] {
                    NONE => NONE,
                    face => 3 * face + h % 3,
                },
            };
            let twin = region.half_edges().map(|h| half_edge(self.twin[h as usize])).collect();
            (twin, region.vertices.iter().map(|v| half_edge(self.outgoing[*v as usize])).collect())
        });
        // Where a region ends, a vertex gets a border: its outgoing half-edge has to be the one on it.
        for (h, v) in (0..).zip(&start) {
            let out = &mut outgoing[*v as usize];
            if twin[h as usize] == NONE && (*out == NONE || twin[*out as usize] != NONE) {
                *out = h;
            }
        }
        (Self { start, twin, outgoing, n_faces: faces.len() }, region)
    }

    /// Takes over the collapsed surface of [`Self::region`]. The edges along its border are unchanged.
    fn put_back(&mut self, collapsed: &Self, region: &SurfaceRegion) {
        let old_vertex = |v: u32| if v == NONE { NONE } else { region.vertices[v as usize] };
        let is_inside = |h: u32| region.faces.binary_search(&(h / 3)).is_ok();
        for (local, h) in region.half_edges().enumerate() {
            let twin = self.twin[h as usize];
            if collapsed.twin[local] != NONE {
                self.twin[h as usize] = region.half_edge(collapsed.twin[local]);
            // Without a twin in the region, the old twin stays if it is in another region. It is lost if the
            // face was removed, or if the twin was in this region, too.
            } else if twin != NONE && (collapsed.start[local] == NONE || is_inside(twin)) {
                self.twin[h as usize] = NONE;
            }
            self.start[h as usize] = old_vertex(collapsed.start[local]);
        }
        for (outgoing, v) in collapsed.outgoing.iter().zip(&region.vertices) {
            // An outgoing half-edge in another region is still there.
            if is_inside(self.outgoing[*v as usize]) {
                self.outgoing[*v as usize] =
                    if *outgoing == NONE { NONE } else { region.half_edge(*outgoing) };
            }
        }
        self.n_faces -= region.faces.len() - collapsed.n_faces;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explicit::{Mesh, distance_sq_to_triangle};
    use crate::lod::error_monitor::ErrorMonitor;
    use crate::lod::local_tolerance::LocalTolerance;
    use chordal_testkit::Random;

    /// A sheet of hills with holes, or rolled up to a tube.
    fn sheet(n: u32, is_tube: bool, random: &mut Random) -> EdgeCollapser {
        let columns = if is_tube { n } else { n + 1 };
        let at = |i: u32, j: u32, noise: f64| {
            let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            let z = 0.1 * libm::sin(9.0 * x) * libm::cos(7.0 * y) + noise;
            let turn = std::f64::consts::TAU * y;
            if is_tube { [x, (0.3 + z) * libm::cos(turn), (0.3 + z) * libm::sin(turn)] } else { [x, y, z] }
        };
        let mut positions = Vec::new();
        for i in 0..=n {
            (0..columns).for_each(|j| positions.push(at(i, j, 0.004 * random.unit())));
        }
        let row = |i: u32, j: u32| columns * i + j % columns;
        let cell = |i: u32, j: u32| {
            let [a, b, c, d] = [row(i, j), row(i + 1, j), row(i + 1, j + 1), row(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        let mut faces: Vec<[u32; 3]> = (0..n).flat_map(|i| (0..n).flat_map(move |j| cell(i, j))).collect();
        faces.retain(|_| random.below(40) > 0);
        let mesh = Mesh::new(positions, faces).unwrap();
        let split = HalfEdgeSurface::from_mesh(&mesh, None);
        let at = split.row.iter().map(|row| mesh.positions()[*row as usize]).collect();
        let is_line = vec![false; split.surface.start.len()];
        let kind = |(v, is_locked): (u32, &bool)| match (is_locked, split.surface.is_border(v)) {
            (true, _) => CollapseVertexKind::Locked,
            (_, true) => CollapseVertexKind::Feature,
            _ => CollapseVertexKind::Smooth,
        };
        let kind = (0..).zip(&split.is_locked).map(kind).collect();
        let mut engine = EdgeCollapser::new(split.surface, at, kind, is_line);
        engine.has_fans = split.first_fan.iter().zip(0..).any(|(first, v)| *first != v);
        engine.first_fan = split.first_fan.into();
        engine
    }

    fn assert_is_surface(surface: &HalfEdgeSurface) {
        let mut n_around = vec![0; surface.outgoing.len()];
        for h in 0..surface.start.len() as u32 {
            let (v, twin) = (surface.start[h as usize], surface.twin[h as usize]);
            if v == NONE {
                assert_eq!(twin, NONE);
                continue;
            }
            n_around[v as usize] += 1;
            assert!(twin == NONE || surface.twin[twin as usize] == h);
            assert!(
                twin == NONE || (surface.start[twin as usize] == surface.end(h) && surface.end(twin) == v)
            );
            assert!(twin != NONE || surface.is_border(v), "{h}");
        }
        for (v, n) in (0..).zip(n_around) {
            match surface.outgoing[v as usize] {
                NONE => assert_eq!(n, 0),
                h => assert!(surface.start[h as usize] == v && surface.one_ring(v).count() == n),
            }
        }
        assert_eq!(surface.n_faces, surface.faces().len());
    }

    #[test]
    fn regions_leave_one_surface_that_its_log_leads_to() {
        let mut random = Random::new(3);
        let job = Job::default();
        for trial in 0..40 {
            let before = sheet(24, trial % 2 == 0, &mut random);
            assert_is_surface(&before.surface);
            let until =
                StopCriterion { faces: 0, tolerance: &LocalTolerance::uniform(0.02), share: Some(0.1) };
            let mut after = before.clone();
            after.log = Some(Vec::new());
            assert!(after.run_in_regions_of(100, &until, &job));
            assert_is_surface(&after.surface);
            assert!(after.surface.n_faces < before.surface.n_faces);
            let mut again = before.clone();
            let mut is_open = vec![false; before.at.len()];
            again.replay(after.log.as_ref().unwrap(), &mut is_open);
            assert!(!is_open.contains(&true));
            assert_eq!(again.surface.start, after.surface.start);
            assert_eq!(again.surface.twin, after.surface.twin);
            assert_eq!(again.at, after.at);
            assert_eq!(again.merged_into, after.merged_into);
        }
    }

    #[test]
    fn what_is_known_of_a_collapse_is_what_a_look_finds() {
        let mut random = Random::new(4);
        let mut n_left_out = 0;
        for trial in 0..40 {
            let before = sheet(24, trial % 2 == 0, &mut random);
            let until =
                StopCriterion { faces: 0, tolerance: &LocalTolerance::uniform(0.02), share: Some(0.2) };
            let mut after = before.clone();
            after.log = Some(Vec::new());
            assert!(after.run_in_regions_of(200, &until, &Job::default()));
            let log = after.log.unwrap();
            let is_open: Vec<bool> = before.at.iter().map(|_| random.below(60) == 0).collect();
            // With a look at every collapse.
            let (mut looked, mut opened) = (before.clone(), is_open.clone());
            for past in &log {
                let h = past.collapse.h;
                let is_same = [looked.surface.start[h as usize], looked.surface.end(h)] == past.ends;
                let is_closed = !past.ends.iter().any(|v| opened[*v as usize]);
                if is_same
                    && is_closed
                    && looked.satisfies_link_condition(h)
                    && looked.flips_no_face(&past.collapse)
                {
                    looked.apply(&past.collapse);
                } else {
                    past.ends.iter().for_each(|v| opened[*v as usize] = true);
                    n_left_out += 1;
                }
            }
            let (mut again, mut is_open) = (before.clone(), is_open);
            again.replay(&log, &mut is_open);
            assert_is_surface(&again.surface);
            assert_eq!(is_open, opened);
            assert_eq!(again.surface.start, looked.surface.start);
            assert_eq!(again.at, looked.at);
        }
        assert!(n_left_out > 400, "{n_left_out}");
    }

    #[test]
    fn samples_stay_with_faces_that_are_close() {
        let mut random = Random::new(5);
        let room = LocalTolerance::uniform(0.01);
        for trial in 0..10 {
            let mut engine = sheet(24, trial % 2 == 0, &mut random);
            let job = Job::default();
            let points = engine.at.clone();
            engine.monitor = Some(ErrorMonitor::new(&engine.surface, &engine.at, &[], &job).unwrap());
            let n_before = engine.surface.n_faces;
            let until = StopCriterion { faces: 0, tolerance: &room, share: None };
            assert!(engine.run_in_regions_of(200, &until, &job));
            assert_is_surface(&engine.surface);
            assert!(engine.surface.n_faces < n_before / 2);
            let mut monitor = engine.monitor.take().unwrap();
            for thinned in [false, true] {
                if thinned {
                    monitor.thin_out();
                }
                let mut n_held = 0;
                for face in engine.surface.faces() {
                    let corners = engine.surface.corners(face).map(|v| engine.at[v as usize]);
                    for sample in monitor.samples.of_face(face) {
                        assert_eq!(monitor.samples.holder(sample), face);
                        assert!(distance_sq_to_triangle(points[sample as usize], corners) <= 0.01 * 0.01);
                        n_held += 1;
                    }
                }
                assert_eq!(n_held, points.len());
            }
        }
    }

    #[test]
    fn a_cancelled_job_leaves_the_surface() {
        let mut engine = sheet(24, false, &mut Random::new(6));
        let start = engine.surface.start.clone();
        let job = Job::default();
        job.cancel();
        let until = StopCriterion { faces: 0, tolerance: &LocalTolerance::uniform(0.01), share: None };
        assert!(!engine.run_in_regions_of(200, &until, &job));
        assert_eq!(engine.surface.start, start);
    }
}
