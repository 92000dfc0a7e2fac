//! Recorded collapses, most of which another attempt repeats.
use super::super::bucket_queue::BucketQueue;
use super::super::surface::{Compaction, NONE};
use super::{EdgeCollapse, EdgeCollapser};
use crate::explicit::previous_in_face;

/// A recorded collapse.
#[derive(Clone, Copy, Debug)]
pub(in crate::lod) struct PastCollapse {
    pub(super) collapse: EdgeCollapse,
    /// The vertices at the start and at the end of its edge.
    pub(super) ends: [u32; 2],
}

impl PastCollapse {
    /// The same collapse, in the numbers before a surface was compacted.
    pub fn before(&self, compaction: &Compaction) -> Self {
        let h = compaction.old_half_edge(self.collapse.h);
        Self {
            collapse: EdgeCollapse { h, ..self.collapse },
            ends: self.ends.map(|v| compaction.old_vertex(v)),
        }
    }
}

impl EdgeCollapser {
    /// Repeats the collapses of `past` from the state in which they began. Left out are those at open vertices,
    /// which are to be tried again, and those that have become impossible because others were left out; their
    /// vertices become open as well. No monitor checks the repeated ones. Afterwards the queue holds the edges
    /// of the open vertices.
    pub fn replay(&mut self, past: &[PastCollapse], is_open: &mut [bool]) {
        let monitor = self.monitor.take();
        // Collapses without a monitor do not forget refusals.
        self.refused_within.fill(0.0);
        for PastCollapse { collapse, ends } in past {
            let h = collapse.h;
            let is_same = self.surface.start[h as usize] == ends[0] && self.surface.end(h) == ends[1];
            let is_closed = !ends.iter().any(|v| is_open[*v as usize]);
            // If nothing around a collapse has changed, it is known to be allowed. With values at corners it
            // has to be checked again, since these depend on the faces.
            let is_known = self.wedges.is_none() && !self.is_beside(ends, is_open);
            let is_allowed =
                |this: &mut Self| this.satisfies_link_condition(h) && this.flips_no_face(collapse);
            if is_same && is_closed && (is_known || is_allowed(self)) {
                self.carry_out(collapse);
            } else {
                ends.iter().for_each(|v| is_open[*v as usize] = true);
            }
        }
        self.monitor = monitor;
        self.enqueue_around(is_open);
    }

    /// Whether one of the vertices shares an edge with an open vertex.
    fn is_beside(&self, vertices: &[u32; 2], is_open: &[bool]) -> bool {
        let surface = &self.surface;
        let sides = |g: u32| [surface.end(g), surface.start[previous_in_face(g) as usize]];
        let around = vertices.iter().flat_map(|v| surface.one_ring(*v)).flat_map(sides);
        around.into_iter().any(|v| is_open[v as usize])
    }

    /// Puts the edges of open vertices into the queue, and no others.
    pub(super) fn enqueue_around(&mut self, is_open: &[bool]) {
        self.queue = BucketQueue::new();
        self.is_queued.fill(false);
        for v in (0..self.at.len() as u32).filter(|v| is_open[*v as usize]) {
            let mut g = self.surface.outgoing[v as usize];
            let first = g;
            while g != NONE {
                self.enqueue(g);
                let arrives = previous_in_face(g);
                g = self.surface.twin[arrives as usize];
                // At a border, the only half-edge of the last edge arrives.
                if g == NONE {
                    self.enqueue(arrives);
                }
                g = if g == first { NONE } else { g };
            }
        }
    }
}
