//! `MeshReduction`: a mesh during simplification, from its preparation to each extracted result.
mod failed_attempt;
mod reduced_mesh;
mod retry;

pub(super) use failed_attempt::{AttemptStart, FailedAttempt, UnmonitoredCollapses};

use super::attribute_guard::AttributeGuard;
use super::edge_collapse::{
    CollapseVertexKind, EdgeCollapser, StopCriterion, face_standing_for, representative,
};
use super::error_monitor::{CheckLevel, ErrorMonitor};
use super::local_tolerance::{LocalTolerance, ReductionFrame};
use super::surface::{Compaction, HalfEdgeSurface, ManifoldSplit, NONE};
use super::wedges::Wedges;
use crate::budget::{AttributeLimits, ErrorLimit, Job, JobError};
use crate::check::{ProximityChecker, ViolationReport};
use crate::explicit::{DisjointSets, Mesh, Topology};
use crate::math::{Box3, distance, greater, lesser};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::AddAssign;
use std::sync::Arc;

/// Parts of a mesh that could not be simplified, and parts that were dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReductionStats {
    /// Vertices that are fixed because edges with three faces, inconsistently wound faces or several fans
    /// meet there.
    pub locked_vertices: u64,
    /// Faces without area that were dropped; the remaining surface passes them within the length.
    pub degenerate_faces: u64,
    /// Faces without area that stay as they were, because no other part of the surface passes near enough.
    pub kept_degenerate_faces: u64,
    /// If all attempts failed and the mesh stays as it was for that length: the faces of either mesh that the
    /// last attempt left too far from the other, or not proved to be near.
    pub unsettled_faces: u64,
    /// Separate components that were removed, since they are so small or so close to others that the budget
    /// covers their absence.
    pub dropped_components: u64,
}

impl AddAssign for ReductionStats {
    fn add_assign(&mut self, other: Self) {
        self.locked_vertices += other.locked_vertices;
        self.degenerate_faces += other.degenerate_faces;
        self.kept_degenerate_faces += other.kept_degenerate_faces;
        self.unsettled_faces += other.unsettled_faces;
        self.dropped_components += other.dropped_components;
    }
}

#[derive(Clone)]
pub(super) struct MeshReduction<'a> {
    mesh: &'a Mesh,
    frame: ReductionFrame,
    engine: EdgeCollapser,
    /// By vertex at the start: one of its rows of the mesh.
    row: Arc<[u32]>,
    /// By row of the mesh: its vertex at the start, or [`NONE`].
    vertex_of_row: Arc<[u32]>,
    /// By vertex at the start: the vertex into which it was collapsed before the last compaction, or
    /// [`NONE`].
    vertex_of_start: Vec<u32>,
    /// By face: its number in the mesh.
    source_face: Vec<u32>,
    /// Whether the mesh is a part of a larger one: other parts may be attached at its locked vertices.
    is_region: bool,
    pub stats: ReductionStats,
}

impl<'a> MeshReduction<'a> {
    pub fn new(mesh: &'a Mesh, topology: Topology) -> Self {
        Self::from_region(mesh, topology, &[], &AttributeLimits::default())
    }

    /// A part of a larger mesh. The rows marked by `stays` are fixed, with all edges and values between them.
    /// Rows of one position are marked alike; an empty list means a whole mesh. Normals that jump by more
    /// than half their limit are kept apart.
    pub fn from_region(mesh: &'a Mesh, topology: Topology, stays: &[bool], limits: &AttributeLimits) -> Self {
        let is_part = !stays.is_empty();
        let ids = topology.ids(mesh);
        let ManifoldSplit { surface, first_fan, is_locked: mut is_tied, row, n_collapsed: collapsed } =
            HalfEdgeSurface::from_mesh(mesh, ids.as_deref());
        let mut vertex_of_row = vec![NONE; mesh.positions().len()];
        for (row, v) in mesh.faces().as_flattened().iter().zip(&surface.start).filter(|(_, v)| **v != NONE) {
            vertex_of_row[*row as usize] = *v;
        }
        let used = mesh.faces().as_flattened().iter().map(|row| &mesh.positions()[*row as usize]);
        let frame = ReductionFrame::from_bounds(&Box3::from_points(used));
        let at: Vec<[f64; 3]> =
            row.iter().map(|row| frame.in_frame(mesh.positions()[*row as usize])).collect();
        // Only those at which the surface is no manifold: rows that neighbours share are added below.
        let tied_vertices = is_tied.iter().filter(|tied| **tied).count() as u64;
        let stays = |row: u32| stays.get(row as usize).copied().unwrap_or(false);
        is_tied.iter_mut().zip(&row).for_each(|(tied, row)| *tied |= stays(*row));
        let (wedges, is_line) = Wedges::from_mesh(mesh, &surface, stays, limits);
        let kind = vertex_kinds(&surface, &is_line, &is_tied);
        let mut engine = EdgeCollapser::new(surface, at, kind, is_line);
        engine.wedges = wedges;
        engine.has_fans = first_fan.iter().zip(0..).any(|(first, v)| *first != v);
        engine.first_fan = first_fan.into();
        let stats = ReductionStats {
            locked_vertices: tied_vertices,
            degenerate_faces: collapsed as u64,
            ..ReductionStats::default()
        };
        let vertex_of_start = (0..row.len() as u32).collect();
        let source_face = (0..mesh.faces().len() as u32).collect();
        let (row, vertex_of_row) = (row.into(), vertex_of_row.into());
        Self {
            mesh,
            frame,
            engine,
            row,
            vertex_of_row,
            vertex_of_start,
            source_face,
            is_region: is_part,
            stats,
        }
    }

    /// The number of remaining faces.
    pub fn n_faces(&self) -> usize {
        self.engine.surface.n_faces
    }

    /// Whether there is no surface, since every face has two corners at one position.
    pub fn is_empty(&self) -> bool {
        self.n_faces() == 0
    }

    /// Drops removed faces and vertices if they are the majority, and forgets the recorded collapses.
    pub fn compact(&mut self) -> Option<Compaction> {
        self.engine.log = None;
        if self.n_faces() > self.source_face.len() / 2 {
            return None;
        }
        let Self { engine, vertex_of_start, source_face, .. } = self;
        for v in vertex_of_start.iter_mut().filter(|v| **v != NONE) {
            *v = representative(&mut engine.merged_into, *v);
        }
        let compaction = engine.compact();
        for v in vertex_of_start.iter_mut().filter(|v| **v != NONE) {
            *v = compaction.new_vertex[*v as usize];
        }
        *source_face = compaction.faces(source_face).collect();
        Some(compaction)
    }

    /// Starts to monitor the distance; called before anything is collapsed.
    pub fn start_monitor(&mut self, job: &Job) -> Result<(), JobError> {
        let surface = &self.engine.surface;
        let edges = || {
            (0..surface.start.len() as u32)
                .filter(|h| surface.start[*h as usize] != NONE && *h < surface.twin[*h as usize])
                .map(|h| (h, [surface.start[h as usize], surface.end(h)].map(|v| self.engine.at[v as usize])))
        };
        // Long edges get sample points in addition to their ends, so that gaps are at most about the mean
        // edge length.
        let (sum, n) = edges().fold((0.0, 0.0), |(sum, n), (_, [p, q])| (sum + distance(q, p), n + 1.0));
        let mut points = Vec::new();
        for (h, [p, q]) in edges() {
            let gaps = distance(q, p) * n / sum;
            let more = if gaps < f64::from(MOST_ON_EDGE) { gaps as u32 } else { MOST_ON_EDGE };
            for i in 1..=more {
                let t = f64::from(i) / f64::from(more + 1);
                points.push((std::array::from_fn(|k| p[k] + t * (q[k] - p[k])), h));
            }
        }
        self.engine.monitor = Some(ErrorMonitor::new(surface, &self.engine.at, &points, job)?);
        Ok(())
    }

    /// Drops samples that are not needed for larger lengths.
    pub fn thin_out_samples(&mut self) {
        self.engine.monitor.iter_mut().for_each(ErrorMonitor::thin_out);
    }

    /// Limits the change of attributes from the values they have now; called before anything is collapsed.
    pub fn start_attribute_guard(&mut self, limits: &AttributeLimits) {
        let EdgeCollapser { surface, wedges, at, attribute_guard, .. } = &mut self.engine;
        *attribute_guard =
            wedges.as_ref().map(|wedges| AttributeGuard::new(surface, wedges, at.len(), limits));
    }

    /// Whether there are attributes with limits.
    pub fn guards_attributes(&self) -> bool {
        self.engine.attribute_guard.is_some()
    }

    /// Resets the usable shares of the limits of attributes, for a larger length.
    pub fn reset_attribute_shares(&mut self) {
        self.engine.attribute_guard.iter_mut().for_each(AttributeGuard::reset);
    }

    /// Lowers the usable shares of the limits of attributes where the mesh of an earlier attempt exceeded
    /// them: around faces of the original, and around faces of that mesh.
    pub fn tighten_attributes(&mut self, failed: &FailedAttempt, beyond: &[Vec<u32>; 2]) {
        let (Some(guard), Some(before), Some(then)) =
            (&mut self.engine.attribute_guard, &failed.attribute_guard, &failed.monitor)
        else {
            return;
        };
        let original = beyond[0].iter().flat_map(|face| then.original_corners(*face)).filter(|v| *v != NONE);
        let mut samples: Vec<u32> = original.collect();
        for face in &beyond[1] {
            samples.extend(then.samples_around(&failed.surface, failed.faces[*face as usize]));
        }
        guard.tighten(before, samples);
    }

    /// Resets all check levels, for a larger length.
    pub fn reset_check_levels(&mut self) {
        if let Some(watch) = &mut self.engine.monitor {
            watch.check_levels.clear();
        }
    }

    /// Raises the check levels where the mesh of an earlier attempt was too far from the original.
    /// `more` gives the next level after a change of a given cost.
    pub fn raise_check_levels(
        &mut self,
        failed: &FailedAttempt,
        report: &ViolationReport,
        more: impl Fn(CheckLevel, f32) -> CheckLevel,
    ) {
        let (Some(watch), Some(then)) = (&mut self.engine.monitor, &failed.monitor) else { return };
        let earlier = then.all_check_levels();
        let mut levels = earlier.clone();
        let mut mark = |sample: u32, cost: f32| {
            let level = &mut levels[sample as usize];
            *level = level.stricter(more(earlier[sample as usize], cost));
        };
        let cost_of = |face: u32| failed.face_cost[face as usize];
        for far in &report.violations[0] {
            // Faces of the original. Earlier levels of detail may have removed the face that stands for one.
            let corners = then.original_corners(far.face);
            // A face that was dropped at the start has no vertices here.
            if corners[0] != NONE {
                let holders =
                    corners.map(|v| then.samples.holder(v)).into_iter().filter(|face| *face != NONE);
                let cost = holders.map(cost_of).reduce(lesser).unwrap_or(0.0);
                corners.into_iter().for_each(|v| mark(v, cost));
            }
        }
        for far in &report.violations[1] {
            let face = failed.faces[far.face as usize];
            let near = then.samples_near(&failed.surface, face);
            near.into_iter().for_each(|sample| mark(sample, cost_of(face)));
        }
        watch.check_levels = levels;
    }

    /// A fraction of the world limit, in local coordinates.
    pub fn local_tolerance(&self, allowed: &ErrorLimit, share: f64) -> LocalTolerance {
        match (allowed.constant(), &self.engine.monitor) {
            (Some(length), _) => LocalTolerance::uniform(self.frame.local_length(share * length)),
            (None, Some(watch)) => {
                let points: Vec<[f64; 3]> = watch.samples.points().collect();
                LocalTolerance::varying(allowed, (self.frame, share), &points)
            }
            (None, None) => LocalTolerance::varying(allowed, (self.frame, share), &self.engine.at),
        }
    }

    /// Freezes faces that are too close to the eye, since no proof would accept a change there.
    pub fn freeze_too_close(&mut self, tolerance: &LocalTolerance) {
        if tolerance.is_constant() {
            return;
        }
        let Some(mut monitor) = self.engine.monitor.take() else { return };
        let EdgeCollapser { surface, at, .. } = &self.engine;
        let mut levels = monitor.all_check_levels();
        for face in self.faces() {
            let corners = surface.corners(face).map(|v| at[v as usize]);
            if tolerance.is_too_close(&Box3::from_points(&corners)) {
                for sample in monitor.samples_near(surface, face) {
                    levels[sample as usize] = CheckLevel::Frozen;
                }
            }
        }
        monitor.check_levels = levels;
        self.engine.monitor = Some(monitor);
    }

    /// Collapses edges until `faces` are left, or no collapse fits into the tolerance.
    pub fn run(&mut self, faces: usize, tolerance: &LocalTolerance, job: &Job) -> Result<(), JobError> {
        let until = StopCriterion { faces, tolerance, share: None };
        // The collapses are recorded, since another attempt may repeat most of them.
        self.engine.log = self.engine.monitor.is_some().then(Vec::new);
        if self.run_engine(&until, job) { Ok(()) } else { Err(JobError::Cancelled) }
    }

    /// Collapses edges whose mean distance from planes of the original stays within the tolerance. Nobody looks at the
    /// original itself.
    pub fn run_by_planes(&mut self, tolerance: &LocalTolerance, job: &Job) -> Result<(), JobError> {
        let until = StopCriterion { faces: 0, tolerance, share: Some(1.0) };
        if self.run_engine(&until, job) { Ok(()) } else { Err(JobError::Cancelled) }
    }

    /// Continues from the current state, with a larger tolerance.
    pub fn run_on(&mut self, faces: usize, tolerance: &LocalTolerance, job: &Job) -> Result<(), JobError> {
        let until = StopCriterion { faces, tolerance, share: None };
        if self.run_engine(&until, job) { Ok(()) } else { Err(JobError::Cancelled) }
    }

    /// Runs the collapses. A large surface is divided into regions, provided that each region contains all
    /// data for its decisions, and that no number of faces has to be met.
    fn run_engine(&mut self, until: &StopCriterion<'_>, job: &Job) -> bool {
        let knows_all = self.engine.monitor.as_ref().is_none_or(|monitor| monitor.check_levels.is_empty())
            && !self.guards_attributes()
            && until.tolerance.is_constant();
        if knows_all && (until.faces == 0 || until.share.is_some()) {
            self.engine.run_in_regions(until, job)
        } else {
            self.engine.run(until, job)
        }
    }

    /// The largest mean distance of a vertex from the planes of the original that it represents, in world
    /// coordinates, rounded: less than [`MEAN_DISTANCE_ROUNDING`] of the extent counts as 0.
    pub fn largest_mean_distance(&self) -> f64 {
        let EdgeCollapser { surface, quadric, at, .. } = &self.engine;
        let vertices = (0..at.len()).filter(|v| surface.outgoing[*v] != NONE && quadric[*v].weight() > 0.0);
        let square = |v: usize| quadric[v].at(at[v]) / quadric[v].weight();
        self.frame.world_length(vertices.map(square).fold(0.0, |most, x| greater(x, most)).sqrt())
    }

    /// The diagonal of the box around all vertices, in world coordinates, rounded.
    pub fn diagonal(&self) -> f64 {
        self.frame.world_length(Box3::from_points(&self.engine.at).diagonal())
    }

    /// A uniform tolerance of a world length.
    pub fn uniform_tolerance(&self, length: f64) -> LocalTolerance {
        LocalTolerance::uniform(self.frame.local_length(length))
    }

    /// Collapses edges that cost so little that most of them need no monitor: their mean distance from planes
    /// of the original is below a fraction `share` of the tolerance. The given vertices stay fixed. Fails
    /// with vertices of the original that are too far from the surface afterwards, and those around them.
    pub fn run_unmonitored(
        &mut self,
        (share, fixed_vertices): (f64, &[u32]),
        faces: usize,
        tolerance: &LocalTolerance,
        job: &Job,
    ) -> Result<Result<(), Vec<u32>>, JobError> {
        // Without its monitor the engine checks no distances.
        let Some(mut monitor) = self.engine.monitor.take() else { return Ok(Ok(())) };
        let EdgeCollapser { is_held, merged_into, .. } = &mut self.engine;
        is_held.fill(false);
        let still_there =
            fixed_vertices.iter().map(|v| self.vertex_of_start[*v as usize]).filter(|v| *v != NONE);
        still_there.for_each(|v| is_held[representative(merged_into, v) as usize] = true);
        let until = StopCriterion { faces, tolerance, share: Some(share) };
        self.engine.log = Some(Vec::new());
        if !self.run_engine(&until, job) {
            return Err(JobError::Cancelled);
        }
        let EdgeCollapser { surface, at, merged_into, is_held, .. } = &mut self.engine;
        is_held.fill(false);
        let near = |v: u32| face_standing_for(surface, merged_into, self.vertex_of_start[v as usize]);
        let assigned = monitor.assign_nearest(surface, at, near, (tolerance, job));
        let assigned = assigned.map_err(|far| monitor.around(far));
        self.engine.monitor = Some(monitor);
        Ok(assigned)
    }

    /// Removes small components that are separate from all others and close enough to these: their absence
    /// is no larger error than the tolerance.
    pub fn drop_small_components(&mut self, tolerance: &LocalTolerance, job: &Job) -> Result<(), JobError> {
        let faces = self.faces();
        let engine = &self.engine;
        let mut sets = DisjointSets::new(engine.at.len());
        for face in &faces {
            let [a, b, c] = engine.surface.corners(*face);
            sets.union(a, b);
            sets.union(b, c);
        }
        // Positions that are tied in the mesh belong to one component.
        let mut first_at = vec![NONE; engine.first_fan.len()];
        for v in faces.iter().flat_map(|face| engine.surface.corners(*face)) {
            let first = &mut first_at[engine.first_fan[engine.source_vertex[v as usize] as usize] as usize];
            if *first == NONE {
                *first = v;
            }
            sets.union(v, *first);
        }
        let mut bounds: BTreeMap<u32, Box3> = BTreeMap::new();
        for face in &faces {
            let [a, b, c] = engine.surface.corners(*face);
            let corners = Box3::from_points(&[a, b, c].map(|v| engine.at[v as usize]));
            let component_bounds = bounds.entry(sets.find(a)).or_insert(Box3::EMPTY);
            *component_bounds = component_bounds.union(corners);
        }
        // A component within a length of another one can only be that thin, and a long thin component is
        // kept.
        let small = |b: &Box3| b.diagonal() <= SMALL * tolerance.for_box(b);
        let mut dust: BTreeSet<u32> =
            bounds.iter().filter(|(_, b)| small(b)).map(|(root, _)| *root).collect();
        // Components that continue outside this part are kept as well.
        let tied = |v: &u32| self.is_region && engine.kind[*v as usize] == CollapseVertexKind::Locked;
        for v in faces.iter().flat_map(|face| engine.surface.corners(*face)).filter(tied) {
            dust.remove(&sets.find(v));
        }
        // Nothing would be left.
        if dust.is_empty() || dust.len() == bounds.len() {
            return Ok(());
        }
        let is_dust =
            |sets: &mut DisjointSets, face: u32| dust.contains(&sets.find(engine.surface.corners(face)[0]));
        let (small, others): (Vec<u32>, Vec<u32>) =
            faces.into_iter().partition(|face| is_dust(&mut sets, *face));
        let others = others.iter().map(|face| engine.surface.corners(*face)).collect();
        let others =
            ProximityChecker::new(Cow::Owned(Mesh::by_construction(engine.at.clone(), others)), job)?;
        let mut near: BTreeMap<u32, bool> = BTreeMap::new();
        for face in &small {
            let corners = engine.surface.corners(*face);
            let is_near = near.entry(sets.find(corners[0])).or_insert(true);
            let samples = engine
                .monitor
                .iter()
                .flat_map(|watch| watch.samples.of_face(*face).map(|s| watch.samples.at(s)));
            let mut points = samples.chain(corners.map(|v| engine.at[v as usize]));
            // Nothing is removed where an earlier attempt deviated too much.
            let closely = engine
                .monitor
                .as_ref()
                .is_some_and(|watch| watch.check_level(&[*face]) != CheckLevel::Sampled);
            // Points come first, since they cost less than the proof of the whole face.
            *is_near = *is_near && !closely && points.all(|p| tolerance.holds(p, others.distance_sq(p)));
            *is_near = *is_near && others.is_within(corners.map(|v| engine.at[v as usize]), tolerance);
        }
        self.stats.dropped_components += near.values().filter(|near| **near).count() as u64;
        for face in small {
            if near.get(&sets.find(self.engine.surface.corners(face)[0])) == Some(&true) {
                self.engine.surface.remove_face(face);
            }
        }
        Ok(())
    }

    /// The remaining faces, in their order in the extracted mesh.
    fn faces(&self) -> Vec<u32> {
        self.engine.surface.faces()
    }

    /// For each row of the original mesh a face of the current one near it, by its number in
    /// [`Self::mesh`]; [`NONE`] if there is none.
    pub fn near_faces(&mut self) -> Vec<u32> {
        let mut number = vec![NONE; self.engine.surface.start.len() / 3];
        for (i, face) in self.faces().into_iter().enumerate() {
            number[face as usize] = i as u32;
        }
        let rows = Arc::clone(&self.vertex_of_row);
        let near = rows.iter().map(|v| match *v {
            NONE => NONE,
            v => {
                // The vertices are the first samples. The face of a removed component has no number.
                let holder = self.engine.monitor.as_ref().map(|monitor| monitor.samples.holder(v));
                if let Some(face) = holder {
                    return if face == NONE { NONE } else { number[face as usize] };
                }
                let EdgeCollapser { surface, merged_into, .. } = &mut self.engine;
                match face_standing_for(surface, merged_into, self.vertex_of_start[v as usize]) {
                    NONE => NONE,
                    face => number[face as usize],
                }
            }
        });
        near.collect()
    }
}

/// The rounding of sums of squares of numbers up to 1, as a length. Chosen: with a factor of 64 in reserve.
pub(super) const MEAN_DISTANCE_ROUNDING: f64 = 1e-6;
/// The largest size of a removed component, as a multiple of the tolerance. Chosen: a ball of that size that
/// touches the remaining surface is twice as high as allowed.
const SMALL: f64 = 4.0;
/// The largest number of sample points on a long edge: a mesh of few large faces gets 7 to 49 on each.
const MOST_ON_EDGE: u32 = 7;

fn vertex_kinds(surface: &HalfEdgeSurface, is_line: &[bool], is_tied: &[bool]) -> Vec<CollapseVertexKind> {
    let kind_of = |(v, tied): (usize, &bool)| {
        if *tied {
            return CollapseVertexKind::Locked;
        }
        let v = v as u32;
        let lines =
            surface.one_ring(v).filter(|h| surface.twin[*h as usize] != NONE && is_line[*h as usize]).count();
        let borders = if surface.is_border(v) { 2 } else { 0 };
        // Two lines at a vertex are one that passes it; one ends there, and more meet there.
        match lines + borders {
            0 => CollapseVertexKind::Smooth,
            2 => CollapseVertexKind::Feature,
            _ => CollapseVertexKind::Corner,
        }
    };
    is_tied.iter().enumerate().map(kind_of).collect()
}
