//! The arrow from a mesh to a field: the distance to the triangles, negative inside.
use super::mesh_leaf::{MeshLeaf, MeshSource};
use crate::budget::{Bound, Job, JobError};
use crate::check::{Finding, measure, self_intersections, validity};
use crate::explicit::{Mesh, Topology};
use crate::implicit::{Distance, Expr, Field};
use std::fmt;
use std::sync::Arc;

/// A mesh as a field, with a report on whether it is a solid.
#[derive(Clone, Debug)]
pub struct MeshField {
    /// The distance to the triangles, negative inside.
    pub field: Field,
    /// Whether the mesh is a solid.
    pub solid: SolidReport,
}

/// Whether a mesh bounds a solid, and the defects that keep it from doing so.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidReport {
    /// Whether along every edge, by position, as many triangles run one way as the other. Only then the inside is
    /// certain; otherwise it is the region where the generalized winding number is above a half.
    pub closed: bool,
    /// Edges with only one triangle.
    pub boundary_edges: u64,
    /// Edges with more than two triangles.
    pub non_manifold_edges: u64,
    /// Edges whose two triangles run the same way.
    pub inconsistent_edges: u64,
    /// Whether triangles can be reversed so that all neighbours agree; impossible for a Möbius strip.
    pub orientable: bool,
    /// Pairs of triangles that intersect.
    pub self_intersections: u64,
    /// Whether it is closed and its front faces inward: then no point is inside it.
    pub inside_out: bool,
    /// Whether it has no triangles.
    pub empty: bool,
}

impl SolidReport {
    /// Examines `mesh`.
    ///
    /// # Errors
    /// As for [`self_intersections`].
    pub fn from_mesh(mesh: &Mesh, closed: bool, job: &Job) -> Result<Self, JobError> {
        let edges = validity(mesh, Topology::Positions);
        let count = |finding: &Finding| finding.count;
        Ok(Self {
            closed,
            boundary_edges: count(&edges.boundary_edges),
            non_manifold_edges: count(&edges.non_manifold_edges),
            inconsistent_edges: count(&edges.inconsistent_edges),
            orientable: edges.orientable,
            self_intersections: count(&self_intersections(mesh, job)?),
            inside_out: closed && measure(mesh).signed_volume < 0.0,
            empty: mesh.faces().is_empty(),
        })
    }

    /// Whether the mesh is a solid: closed, right side out, not empty, without self-intersections.
    #[must_use]
    pub fn is_solid(&self) -> bool {
        self.closed && !self.inside_out && !self.empty && self.self_intersections == 0
    }
}

impl fmt::Display for SolidReport {
    /// One sentence.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_solid() {
            return f.write_str("the mesh is a solid");
        }
        let mut faults = Vec::new();
        let mut add = |n: u64, fault: &str| {
            if n > 0 {
                faults.push(format!("{n} {fault}"));
            }
        };
        if !self.closed {
            add(self.boundary_edges, "edges have one triangle only");
            add(self.non_manifold_edges, "edges have more than two");
            add(self.inconsistent_edges, "edges have two that run the same way");
        }
        add(self.self_intersections, "pairs of triangles go through each other");
        if self.inside_out {
            faults.push("it is inside out, so that nothing is inside".into());
        }
        if !self.orientable {
            faults.push("it has one side only".into());
        }
        if self.empty {
            faults.push("it has no triangles".into());
        }
        let sides = if self.closed {
            "points whose winding number is above 0 count as inside"
        } else {
            "points whose winding number is above a half count as inside, which is sure only away from holes"
        };
        write!(f, "the mesh is not a solid: {}; {sides}", faults.join(", "))
    }
}

/// Turns a mesh into a field: the distance to the nearest triangle, negative inside.
///
/// **Value.** The distance is that to the nearest triangle, never scaled, with an error of a few units in the last
/// place of the distance and the mesh's extent. The side comes from the winding number. For closed meshes
/// (see [`Enclosure`](crate::explicit::Enclosure)) it is a whole number, counted by exact predicates, and
/// right even if the mesh intersects itself. For other meshes it is the generalized winding number; points in the
/// box of the triangles where it is above a half are inside. The distance is exact for solids. It is a bound for
/// closed meshes that intersect themselves, since their inner walls are not part of the surface. For meshes that
/// are not closed only the sign is meaningful, since the side also changes away from triangles.
///
/// **Ranges** are proved for closed meshes: they contain the true distances and the computed ones. For other meshes
/// they hold on the condition that the winding number defines the inside, and never claim continuity.
///
/// **Cost.** Building a tree of boxes and moments, and the search for self-intersections; then about 1 µs a point,
/// if consecutive points are near each other.
///
/// # Errors
/// As for [`Bvh::build`](crate::explicit::Bvh::build).
///
/// ```
/// use chordal::{Job, Mesh, convert::mesh_to_field};
/// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let converted = mesh_to_field(&Mesh::new(corners.clone(), faces.clone()).unwrap(), &Job::default())?;
/// assert!(converted.solid.is_solid());
/// assert_eq!(converted.field.expr().at([0.25, 0.25, -2.0]).unwrap(), 2.0);
/// assert_eq!(converted.field.expr().at([0.25, 0.25, 0.125]).unwrap(), -0.125);
///
/// let open = mesh_to_field(&Mesh::new(corners, faces[1..].to_vec()).unwrap(), &Job::default())?;
/// assert!(open.solid.to_string().starts_with("the mesh is not a solid: 3 edges have one triangle only"));
/// # Ok::<(), chordal::budget::JobError>(())
/// ```
///
/// Sources: J. Bærentzen, H. Aanæs, *Signed distance computation using the angle weighted pseudonormal*,
/// 2005, for the definition of sides; here they are computed by winding numbers, which need no normals:
/// A. Jacobson et al., 2013.
pub fn mesh_to_field(mesh: &Mesh, job: &Job) -> Result<MeshField, JobError> {
    mesh_standing_for(mesh, None, job)
}

/// As [`mesh_to_field`], for a mesh that approximates another surface; `lost` is its bound to that surface.
pub(super) fn mesh_standing_for(mesh: &Mesh, lost: Option<Bound>, job: &Job) -> Result<MeshField, JobError> {
    let leaf = MeshLeaf::new(mesh, job)?;
    let solid = SolidReport::from_mesh(mesh, leaf.is_closed(), job)?;
    let distance = match (solid.is_solid(), solid.closed && !solid.empty) {
        (true, _) => Distance::EXACT,
        (_, true) => Distance::BOUND,
        _ => Distance::SIGN,
    };
    let bounds = mesh.bounds();
    let source = MeshSource { mesh: mesh.clone(), is_solid: solid.is_solid(), lost };
    let leaf = leaf.with_source(source);
    let field =
        Field::new(Expr::leaf(Arc::new(leaf), Expr::axes())).known_distance(distance).known_bounds(bounds);
    Ok(MeshField { field, solid })
}
