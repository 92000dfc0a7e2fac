//! A mesh together with its topology: what every count of the validity report looks at.
use crate::explicit::{Mesh, Topology, Twin, Twins, previous_in_face};
use std::borrow::Cow;

/// A mesh, the position of each of its rows, and the twins of its half-edges.
pub(super) struct Surface<'a> {
    pub mesh: &'a Mesh,
    pub ids: Option<Cow<'a, [u32]>>,
    pub twins: Twins,
}

impl<'a> Surface<'a> {
    pub fn new(mesh: &'a Mesh, topology: Topology) -> Self {
        let ids = topology.ids(mesh);
        let twins = Twins::with_ids(mesh, ids.as_deref());
        Self { mesh, ids, twins }
    }

    /// The position of a row.
    #[inline]
    pub fn id(&self, row: u32) -> u32 {
        self.ids.as_ref().map_or(row, |ids| ids[row as usize])
    }

    /// The row at which a half-edge starts.
    #[inline]
    pub fn origin_row(&self, half_edge: u32) -> u32 {
        self.mesh.faces()[half_edge as usize / 3][half_edge as usize % 3]
    }

    /// The position at which a half-edge starts.
    #[inline]
    pub fn origin(&self, half_edge: u32) -> u32 {
        self.id(self.origin_row(half_edge))
    }

    /// The position across the face from a half-edge.
    #[inline]
    pub fn apex(&self, half_edge: u32) -> u32 {
        self.origin(previous_in_face(half_edge))
    }

    /// The three half-edges of a face; `None` when it has two corners at one position.
    #[inline]
    pub fn half_edges(&self, face: u32) -> Option<[u32; 3]> {
        let first = 3 * face;
        (self.twins.get(first) != Twin::Collapsed).then_some([first, first + 1, first + 2])
    }

    pub fn n_faces(&self) -> u32 {
        self.mesh.faces().len() as u32
    }
}
