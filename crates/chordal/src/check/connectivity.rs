//! `MeshConnectivity`: a mesh with its topology, computed once for all checks.
use super::components::{Component, component_of_faces, components_of, components_under};
use super::duplicates::duplicate_positions;
use super::finding::Finding;
use super::open_seams::{OpenSeams, open_seams_of};
use super::t_junctions::t_junctions_of;
use super::validity::{Validity, validity_of};
use crate::budget::{Job, JobError, Tolerance};
use crate::explicit::{Mesh, Topology, Twin, Twins, previous_in_face};
use std::borrow::Cow;

/// A mesh, the position of each of its rows, and the neighbours of its faces: the common input of several
/// checks.
///
/// Linear time, about 25 ms per million triangles on one core, and 12 bytes a triangle and 4 a row.
///
/// ```
/// use chordal::Mesh;
/// use chordal::check::findings::MeshConnectivity;
/// use chordal::explicit::Topology;
/// let mesh = Mesh::new(vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], vec![[0, 1, 2]])?;
/// let surface = MeshConnectivity::new(&mesh, Topology::Indices);
/// assert_eq!(surface.validity().components, 1);
/// assert_eq!(surface.components()[0].boundary_loops, 1);
/// # Ok::<(), chordal::explicit::InvalidMesh>(())
/// ```
pub struct MeshConnectivity<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) topology: Topology,
    pub(super) ids: Option<Cow<'a, [u32]>>,
    pub(super) twins: Twins,
}

/// The connectivity of a mesh by its indices and by bit-identical positions.
pub struct ConnectivityPair<'a> {
    /// By indices.
    pub by_indices: MeshConnectivity<'a>,
    /// By positions; `None` if that is the same because no two positions have the same coordinates.
    pub by_positions: Option<MeshConnectivity<'a>>,
    /// Positions by index with the same coordinates as an earlier one, with `−0.0` equal to `0.0`.
    pub duplicate_vertices: Finding,
}

impl<'a> MeshConnectivity<'a> {
    /// Computes the adjacency of the faces of `mesh`; `topology` says which rows are one
    /// position.
    #[must_use]
    pub fn new(mesh: &'a Mesh, topology: Topology) -> Self {
        Self::with_ids(mesh, topology, topology.ids(mesh))
    }

    fn with_ids(mesh: &'a Mesh, topology: Topology, ids: Option<Cow<'a, [u32]>>) -> Self {
        let twins = Twins::with_ids(mesh, ids.as_deref());
        Self { mesh, topology, ids, twins }
    }

    /// Both connectivities of `mesh`, at the cost of one if they are the same.
    #[must_use]
    pub fn by_indices_and_positions(mesh: &'a Mesh) -> ConnectivityPair<'a> {
        let by_bits = Topology::Positions.ids(mesh);
        let duplicate_vertices = duplicate_positions(mesh, by_bits.as_deref().unwrap_or_default());
        let differ = !duplicate_vertices.is_none();
        ConnectivityPair {
            by_indices: Self::new(mesh, Topology::Indices),
            by_positions: differ.then(|| Self::with_ids(mesh, Topology::Positions, by_bits)),
            duplicate_vertices,
        }
    }

    /// The properties of the mesh: [`super::validity`].
    #[must_use]
    pub fn validity(&self) -> Validity {
        validity_of(self)
    }

    /// The connected components: [`super::components`].
    #[must_use]
    pub fn components(&self) -> Vec<Component> {
        components_of(self)
    }

    /// The same under the limits of a job: its threads and memory apply to the bounding volume hierarchy that
    /// is needed if several components may enclose each other, during which the job can be cancelled.
    ///
    /// # Errors
    /// [`JobError::Refused`] if that hierarchy would be too large for the job
    /// ([`Bvh::build`](crate::explicit::Bvh::build)), and [`JobError::Cancelled`] if the job was cancelled.
    pub fn components_under(&self, job: &Job) -> Result<Vec<Component>, JobError> {
        components_under(self, job)
    }

    /// For each face the row of its component in [`components`](Self::components). Linear in the faces.
    #[must_use]
    pub fn component_of_faces(&self) -> Vec<u32> {
        component_of_faces(self)
    }

    /// Vertices in the interior of an edge: [`super::t_junctions`].
    #[must_use]
    pub fn t_junctions(&self, within: Option<Tolerance>) -> Finding {
        t_junctions_of(self, within)
    }

    /// Boundary vertices that nearly coincide with others: within a 1024th of the boundary edges there, and a 65,536th
    /// of the diagonal of the mesh's box. n log n for n of them.
    #[must_use]
    pub fn open_seams(&self) -> OpenSeams {
        open_seams_of(self)
    }

    /// The rule by which two rows are one position.
    #[must_use]
    pub fn topology(&self) -> Topology {
        self.topology
    }

    /// The position of a row.
    #[inline]
    pub(super) fn id(&self, row: u32) -> u32 {
        self.ids.as_ref().map_or(row, |ids| ids[row as usize])
    }

    /// The row at the origin of a half-edge.
    #[inline]
    pub(super) fn origin_row(&self, half_edge: u32) -> u32 {
        self.mesh.faces()[half_edge as usize / 3][half_edge as usize % 3]
    }

    /// The position at the origin of a half-edge.
    #[inline]
    pub(super) fn origin(&self, half_edge: u32) -> u32 {
        self.id(self.origin_row(half_edge))
    }

    /// The position opposite to a half-edge in its face.
    #[inline]
    pub(super) fn apex(&self, half_edge: u32) -> u32 {
        self.origin(previous_in_face(half_edge))
    }

    /// The three half-edges of a face; `None` if two of its corners have one position.
    #[inline]
    pub(super) fn half_edges(&self, face: u32) -> Option<[u32; 3]> {
        let first = 3 * face;
        (self.twins.get(first) != Twin::Collapsed).then_some([first, first + 1, first + 2])
    }

    pub(super) fn n_faces(&self) -> u32 {
        self.mesh.faces().len() as u32
    }
}
