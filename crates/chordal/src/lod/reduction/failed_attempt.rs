//! `FailedAttempt`: what is kept of an attempt that was too far from the original in some places.
use super::super::attribute_guard::AttributeGuard;
use super::super::edge_collapse::PastCollapse;
use super::super::error_monitor::ErrorMonitor;
use super::super::local_tolerance::LocalTolerance;
use super::super::surface::{Compaction, HalfEdgeSurface, NONE};
use super::MeshReduction;
use crate::budget::{Job, JobError};
use crate::check::ViolationReport;

/// How often collapses without a monitor are tried, each time without places that were too far off before. Chosen.
const ROUNDS: u32 = 4;

/// The surface that an attempt led to, and how.
pub(in crate::lod) struct FailedAttempt {
    pub surface: HalfEdgeSurface,
    pub at: Vec<[f64; 3]>,
    /// By vertex: the one into which it was collapsed, or itself.
    pub merged_into: Vec<u32>,
    pub face_cost: Vec<f32>,
    pub log: Vec<PastCollapse>,
    pub monitor: Option<ErrorMonitor>,
    pub attribute_guard: Option<AttributeGuard>,
    /// By number in the mesh that was made: the face of the surface.
    pub faces: Vec<u32>,
}

/// Where attempts begin: after collapses that no monitor looked at, as long as these do not stand in the way.
pub(in crate::lod) struct AttemptStart<'a> {
    slight: Option<(MeshReduction<'a>, SlightCollapses)>,
    /// Each attempt is to halve the number of places that are too far.
    most_places: usize,
}

impl<'a> AttemptStart<'a> {
    pub fn new(slight: Option<(MeshReduction<'a>, SlightCollapses)>) -> Self {
        Self { slight, most_places: usize::MAX }
    }

    /// The state in which attempts begin; `start` is that before everything.
    pub fn from<'b>(&'b self, start: &'b MeshReduction<'a>) -> &'b MeshReduction<'a> {
        self.slight.as_ref().map_or(start, |(from, _)| from)
    }

    /// After an attempt that was too far off in `places`: begins before the collapses without a monitor, where more of
    /// the same does not help.
    pub fn follow(&mut self, tried: &mut FailedAttempt, places: &ViolationReport) {
        if places.count() > self.most_places {
            self.leave_slight(tried);
        }
        self.most_places = places.count() / 2;
    }

    /// Begins before the collapses without a monitor.
    pub fn leave_slight(&mut self, tried: &mut FailedAttempt) {
        if let Some((_, collapses)) = self.slight.take() {
            tried.prepend(&collapses);
        }
    }
}

/// Collapses that no monitor looked at, with the numbers of what they left.
pub(in crate::lod) struct SlightCollapses {
    log: Vec<PastCollapse>,
    merged_into: Vec<u32>,
    kept: Option<Compaction>,
}

impl MeshReduction<'_> {
    /// The mesh after collapses whose cost is such a share of what is allowed that no monitor looked at them, as long as
    /// there are more than `faces`; `None` where that is not close enough.
    pub fn after_slight(
        &self,
        (share, faces): (f64, usize),
        room: &LocalTolerance,
        job: &Job,
    ) -> Result<Option<(Self, SlightCollapses)>, JobError> {
        let mut held: Vec<u32> = Vec::new();
        for _ in 0..ROUNDS {
            let mut reduction = self.clone();
            match reduction.run_slight((share, &held), faces, room, job)? {
                Ok(()) => {
                    let slight = reduction.compact_slight();
                    return Ok(Some((reduction, slight)));
                }
                Err(far) => held.extend(far),
            }
        }
        Ok(None)
    }

    /// Leaves out what [`Self::run_slight`] removed; what it did is returned.
    pub fn compact_slight(&mut self) -> SlightCollapses {
        let log = self.engine.log.take().unwrap_or_default();
        let merged_into = self.engine.merged_into.clone();
        SlightCollapses { log, merged_into, kept: self.compact() }
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

    /// Counts collapses before the attempt as its own, in the numbers of their start.
    pub fn prepend(&mut self, slight: &SlightCollapses) {
        let mut log = slight.log.clone();
        if let Some(kept) = &slight.kept {
            log.extend(self.log.iter().map(|past| past.before(kept)));
            self.surface = self.surface.before(kept);
            self.at = kept.by_old_vertex(&self.at, [0.0; 3]);
            self.face_cost = kept.by_old_face(&self.face_cost, 0.0);
            self.faces.iter_mut().for_each(|face| *face = kept.old_face(*face));
            self.monitor.iter_mut().for_each(|monitor| monitor.samples.expand(kept));
            let merged_into =
                slight.merged_into.iter().zip(&kept.new_vertex).map(|(before, new)| match *new {
                    NONE => *before,
                    new => kept.old_vertex(self.merged_into[new as usize]),
                });
            self.merged_into = merged_into.collect();
        } else {
            log.append(&mut self.log);
        }
        self.log = log;
    }

    /// By vertex: whether it belongs to a face that is too far from the original, or that stands for one of the original
    /// that is; with `rings` of edges around these.
    pub fn vertices_at(&self, places: &ViolationReport, rings: u32) -> Vec<bool> {
        let surface = &self.surface;
        let mut is_far = vec![false; self.at.len()];
        let mut found: Vec<u32> =
            places.violations[1].iter().map(|far| self.faces[far.face as usize]).collect();
        if let Some(monitor) = &self.monitor {
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
}
