//! `Surface`: a mesh together with its topology, worked out once for all questions about it.
use super::components::{Component, components_of, components_under};
use super::duplicates::duplicate_positions;
use super::finding::Finding;
use super::t_junctions::t_junctions_of;
use super::validity::{Validity, validity_of};
use crate::budget::{Job, Stopped, Tolerance};
use crate::explicit::{Mesh, Topology, Twin, Twins, previous_in_face};
use std::borrow::Cow;

/// A mesh, the position of each of its rows, and the neighbours of its faces: what several questions need alike.
///
/// Linear time, about 25 ms per million triangles on one core, and 12 bytes a triangle and 4 a row.
///
/// ```
/// use chordal::{Mesh, check::Surface, explicit::Topology};
/// let mesh = Mesh::new(vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], vec![[0, 1, 2]])?;
/// let surface = Surface::new(&mesh, Topology::Indices);
/// assert_eq!(surface.validity().components, 1);
/// assert_eq!(surface.components()[0].boundary_loops, 1);
/// # Ok::<(), chordal::explicit::InvalidMesh>(())
/// ```
pub struct Surface<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) topology: Topology,
    pub(super) ids: Option<Cow<'a, [u32]>>,
    pub(super) twins: Twins,
}

/// A mesh seen both ways, by its own indices and by bit-identical positions.
pub struct BothWays<'a> {
    /// By indices.
    pub by_indices: Surface<'a>,
    /// By positions; none where that is the same, with no two positions at one place.
    pub by_positions: Option<Surface<'a>>,
    /// Positions by index at the same place as an earlier one, `−0.0` and `0.0` taken as equal.
    pub duplicate_vertices: Finding,
}

impl<'a> Surface<'a> {
    /// Works out who is whose neighbour in `mesh`, two rows being one position where `topology` says so.
    #[must_use]
    pub fn new(mesh: &'a Mesh, topology: Topology) -> Self {
        Self::with_ids(mesh, topology, topology.ids(mesh))
    }

    fn with_ids(mesh: &'a Mesh, topology: Topology, ids: Option<Cow<'a, [u32]>>) -> Self {
        let twins = Twins::with_ids(mesh, ids.as_deref());
        Self { mesh, topology, ids, twins }
    }

    /// Both ways to see `mesh`, at the cost of one where they are the same.
    #[must_use]
    pub fn both_ways(mesh: &'a Mesh) -> BothWays<'a> {
        let by_bits = Topology::Positions.ids(mesh);
        let duplicate_vertices = duplicate_positions(mesh, by_bits.as_deref().unwrap_or_default());
        let differ = !duplicate_vertices.is_none();
        BothWays {
            by_indices: Self::new(mesh, Topology::Indices),
            by_positions: differ.then(|| Self::with_ids(mesh, Topology::Positions, by_bits)),
            duplicate_vertices,
        }
    }

    /// What holds of it: [`super::validity`].
    #[must_use]
    pub fn validity(&self) -> Validity {
        validity_of(self)
    }

    /// What holds of each component: [`super::components`].
    #[must_use]
    pub fn components(&self) -> Vec<Component> {
        components_of(self)
    }

    /// The same under the conditions of a job: its threads and its memory are those of the tree of boxes that several
    /// components which may enclose each other need, and it can be cancelled there.
    ///
    /// # Errors
    /// [`Stopped::Refused`] where that tree would be too large for the job
    /// ([`Bvh::build`](crate::explicit::Bvh::build)), and [`Stopped::Cancelled`] when the job was.
    pub fn components_under(&self, job: &Job) -> Result<Vec<Component>, Stopped> {
        components_under(self, job)
    }

    /// Vertices in the middle of an edge: [`super::t_junctions`].
    #[must_use]
    pub fn t_junctions(&self, within: Option<Tolerance>) -> Finding {
        t_junctions_of(self, within)
    }

    /// What makes two rows one position.
    #[must_use]
    pub fn topology(&self) -> Topology {
        self.topology
    }

    /// The position of a row.
    #[inline]
    pub(super) fn id(&self, row: u32) -> u32 {
        self.ids.as_ref().map_or(row, |ids| ids[row as usize])
    }

    /// The row at which a half-edge starts.
    #[inline]
    pub(super) fn origin_row(&self, half_edge: u32) -> u32 {
        self.mesh.faces()[half_edge as usize / 3][half_edge as usize % 3]
    }

    /// The position at which a half-edge starts.
    #[inline]
    pub(super) fn origin(&self, half_edge: u32) -> u32 {
        self.id(self.origin_row(half_edge))
    }

    /// The position across the face from a half-edge.
    #[inline]
    pub(super) fn apex(&self, half_edge: u32) -> u32 {
        self.origin(previous_in_face(half_edge))
    }

    /// The three half-edges of a face; `None` when it has two corners at one position.
    #[inline]
    pub(super) fn half_edges(&self, face: u32) -> Option<[u32; 3]> {
        let first = 3 * face;
        (self.twins.get(first) != Twin::Collapsed).then_some([first, first + 1, first + 2])
    }

    pub(super) fn n_faces(&self) -> u32 {
        self.mesh.faces().len() as u32
    }
}
