//! `FailedAttempt`: the data of an attempt that was too far from the original in some places.
use super::super::attribute_guard::AttributeGuard;
use super::super::edge_collapse::PastCollapse;
use super::super::error_monitor::ErrorMonitor;
use super::super::local_tolerance::LocalTolerance;
use super::super::surface::{Compaction, HalfEdgeSurface, NONE};
use super::MeshReduction;
use crate::budget::{Job, JobError};
use crate::check::ViolationReport;

/// How often collapses without a monitor are tried; each time vertices that were too far before stay fixed.
/// Chosen: a larger number rarely succeeds.
const ROUNDS: u32 = 4;

/// The surface of a failed attempt, and the collapses that led to it.
pub(in crate::lod) struct FailedAttempt {
    pub surface: HalfEdgeSurface,
    pub at: Vec<[f64; 3]>,
    /// By vertex: the vertex into which it was collapsed, or itself.
    pub merged_into: Vec<u32>,
    pub face_cost: Vec<f32>,
    pub log: Vec<PastCollapse>,
    pub monitor: Option<ErrorMonitor>,
    pub attribute_guard: Option<AttributeGuard>,
    /// By face of the extracted mesh: its number in the surface.
    pub faces: Vec<u32>,
}

/// The state in which attempts begin: after collapses without a monitor, unless these turn out to be the
/// problem.
pub(in crate::lod) struct AttemptStart<'a> {
    unmonitored: Option<(MeshReduction<'a>, UnmonitoredCollapses)>,
    /// Each attempt is expected to halve the number of faces that are too far.
    most_violations: usize,
}

impl<'a> AttemptStart<'a> {
    pub fn new(unmonitored: Option<(MeshReduction<'a>, UnmonitoredCollapses)>) -> Self {
        Self { unmonitored, most_violations: usize::MAX }
    }

    /// The state in which attempts begin; `start` is the state before all collapses.
    pub fn state<'b>(&'b self, start: &'b MeshReduction<'a>) -> &'b MeshReduction<'a> {
        self.unmonitored.as_ref().map_or(start, |(state, _)| state)
    }

    /// After a failed attempt: if it did not reduce the number of violations by half, further attempts begin
    /// before the collapses without a monitor.
    pub fn after_failure(&mut self, failed: &mut FailedAttempt, report: &ViolationReport) {
        if report.count() > self.most_violations {
            self.drop_unmonitored(failed);
        }
        self.most_violations = report.count() / 2;
    }

    /// Makes further attempts begin before the collapses without a monitor.
    pub fn drop_unmonitored(&mut self, failed: &mut FailedAttempt) {
        if let Some((_, collapses)) = self.unmonitored.take() {
            failed.prepend(&collapses);
        }
    }
}

/// Collapses without a monitor, with the numbers of the remaining parts.
pub(in crate::lod) struct UnmonitoredCollapses {
    log: Vec<PastCollapse>,
    merged_into: Vec<u32>,
    compaction: Option<Compaction>,
}

impl MeshReduction<'_> {
    /// The mesh after collapses without a monitor, whose cost is below a share of the tolerance, as long as
    /// there are more than `faces`; `None` if the result is not close enough.
    pub fn after_unmonitored(
        &self,
        (share, faces): (f64, usize),
        tolerance: &LocalTolerance,
        job: &Job,
    ) -> Result<Option<(Self, UnmonitoredCollapses)>, JobError> {
        let mut fixed_vertices: Vec<u32> = Vec::new();
        for _ in 0..ROUNDS {
            let mut reduction = self.clone();
            match reduction.run_unmonitored((share, &fixed_vertices), faces, tolerance, job)? {
                Ok(()) => {
                    let unmonitored = reduction.compact_unmonitored();
                    return Ok(Some((reduction, unmonitored)));
                }
                Err(far) => fixed_vertices.extend(far),
            }
        }
        Ok(None)
    }

    /// Drops the parts removed by [`Self::run_unmonitored`]; returns its collapses.
    pub fn compact_unmonitored(&mut self) -> UnmonitoredCollapses {
        let log = self.engine.log.take().unwrap_or_default();
        let merged_into = self.engine.merged_into.clone();
        UnmonitoredCollapses { log, merged_into, compaction: self.compact() }
    }
}

impl FailedAttempt {
    pub fn new(attempt: MeshReduction<'_>) -> Self {
        let engine = attempt.engine;
        Self {
            faces: engine.surface.faces(),
            surface: engine.surface,
            at: engine.at,
            merged_into: engine.merged_into,
            face_cost: engine.face_cost,
            log: engine.log.unwrap_or_default(),
            monitor: engine.monitor,
            attribute_guard: engine.attribute_guard,
        }
    }

    /// Puts collapses before the attempt in front of its own, in the numbers of their start.
    pub fn prepend(&mut self, unmonitored: &UnmonitoredCollapses) {
        let mut log = unmonitored.log.clone();
        if let Some(compaction) = &unmonitored.compaction {
            log.extend(self.log.iter().map(|past| past.before(compaction)));
            self.surface = self.surface.before(compaction);
            self.at = compaction.by_old_vertex(&self.at, [0.0; 3]);
            self.face_cost = compaction.by_old_face(&self.face_cost, 0.0);
            self.faces.iter_mut().for_each(|face| *face = compaction.old_face(*face));
            self.monitor.iter_mut().for_each(|monitor| monitor.samples.expand(compaction));
            let merged_into =
                unmonitored.merged_into.iter().zip(&compaction.new_vertex).map(|(before, new)| match *new {
                    NONE => *before,
                    new => compaction.old_vertex(self.merged_into[new as usize]),
                });
            self.merged_into = merged_into.collect();
        } else {
            log.append(&mut self.log);
        }
        self.log = log;
    }

    /// By vertex: whether it belongs to a face that is too far from the original, or that represents a face
    /// of the original that is; or whether it is within `rings` edges of such a vertex.
    pub fn vertices_at(&self, report: &ViolationReport, rings: u32) -> Vec<bool> {
        let surface = &self.surface;
        let mut is_far = vec![false; self.at.len()];
        let mut faces: Vec<u32> =
            report.violations[1].iter().map(|far| self.faces[far.face as usize]).collect();
        if let Some(monitor) = &self.monitor {
            for far in &report.violations[0] {
                let corners = monitor.original_corners(far.face).into_iter().filter(|v| *v != NONE);
                faces.extend(corners.map(|v| monitor.samples.holder(v)));
            }
        }
        let is_there = |face: &u32| *face != NONE && surface.corners(*face)[0] != NONE;
        let mut vertices: Vec<u32> =
            faces.into_iter().filter(is_there).flat_map(|face| surface.corners(face)).collect();
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
}
