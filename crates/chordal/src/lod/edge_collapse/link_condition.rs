//! The conditions under which the surface stays manifold if an edge is collapsed.
use super::{CollapseVertexKind, EdgeCollapser};
use crate::explicit::{next_in_face, previous_in_face};
use crate::lod::surface::NONE;

impl EdgeCollapser {
    /// The position of the mesh that a vertex represents: the same one for all fans that are tied there.
    #[inline]
    fn position_of(&self, v: u32) -> u32 {
        if self.has_fans { self.first_fan[self.source_vertex[v as usize] as usize] } else { v }
    }

    /// The link condition: the ends of the edge have no common neighbours except the apexes of its faces, and
    /// no apex loses its last face.
    pub(super) fn satisfies_link_condition(&mut self, h: u32) -> bool {
        //         c            c and d are the apexes of the edge's faces. A further common neighbour e would
        //       /   \          have two edges to the point that a and b become.
        //  e — a — — b — e
        //       \   /
        //         d
        let s = &self.surface;
        let (a, b) = (s.start[h as usize], s.end(h));
        let across = s.twin[h as usize];
        // An edge across the surface between two points of a border would become a point at which two parts
        // only touch.
        if across != NONE && s.is_border(a) && s.is_border(b) {
            return false;
        }
        self.round += 1;
        let round = self.round;
        let mut n_common = 0;
        // A vertex on a border has one neighbour more than faces: the start of the last incoming half-edge.
        let mut last = NONE;
        for g in self.surface.one_ring(a) {
            let end = self.position_of(self.surface.end(g));
            self.visited[end as usize] = round;
            last = g;
        }
        let open = |last: u32| {
            let arrives = previous_in_face(last);
            (self.surface.twin[arrives as usize] == NONE).then(|| self.surface.start[arrives as usize])
        };
        if let Some(v) = open(last) {
            let v = self.position_of(v);
            self.visited[v as usize] = round;
        }
        last = NONE;
        for g in self.surface.one_ring(b) {
            n_common += usize::from(self.visited[self.position_of(self.surface.end(g)) as usize] == round);
            last = g;
        }
        if let Some(v) = open(last) {
            n_common += usize::from(self.visited[self.position_of(v) as usize] == round);
        }
        let sides = if across == NONE { 1 } else { 2 };
        n_common == sides
            && [h, across].into_iter().take(sides).all(|side| self.keeps_apex_valence(side))
            && self.keeps_locked_fans_apart(a, b)
    }

    /// Whether no new edge can coincide with another edge of the mesh: between two locked vertices, or from
    /// a locked vertex to a neighbour of another fan at its position.
    fn keeps_locked_fans_apart(&self, a: u32, b: u32) -> bool {
        let tied = |v: u32| self.kind[v as usize] == CollapseVertexKind::Locked;
        if !tied(a) && !tied(b) {
            return true;
        }
        let (stays, goes) = if tied(a) { (a, b) } else { (b, a) };
        let around = |v: u32| {
            let s = &self.surface;
            s.one_ring(v).flat_map(move |g| [s.end(g), s.start[previous_in_face(g) as usize]])
        };
        let position = self.position_of(stays);
        let is_other_fan = |v: u32| v != stays && self.position_of(v) == position;
        // The new edges lead from `stays` to the neighbours of `goes`.
        around(goes).filter(|v| *v != stays).all(|v| !tied(v) && !around(v).any(is_other_fan))
    }

    /// Whether the apex of a face keeps enough neighbours: three inside the surface, two at a border.
    fn keeps_apex_valence(&self, side: u32) -> bool {
        let (next, previous) = (next_in_face(side), previous_in_face(side));
        // Otherwise two feature lines would become one.
        if self.is_kept_line(next) && self.is_kept_line(previous) {
            return false;
        }
        let apex = self.surface.start[previous as usize];
        // The apex loses one face, and with it one neighbour.
        let needed = if self.surface.is_border(apex) { 2 } else { 4 };
        self.surface.one_ring(apex).take(needed).count() == needed
    }
}
