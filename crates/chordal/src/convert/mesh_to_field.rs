//! Meshes to fields: the distance to the triangles, negative inside.
use super::mesh_leaf::MeshLeaf;
use crate::budget::{Job, Stopped};
use crate::check::{Finding, measure, self_intersections, validity};
use crate::explicit::{Mesh, Topology};
use crate::implicit::{Distance, Expr, Field};
use std::fmt;
use std::sync::Arc;

/// A mesh as a field, and whether it is a solid at all.
#[derive(Clone, Debug)]
pub struct MeshField {
    /// The distance to the triangles, negative inside.
    pub field: Field,
    /// What the mesh is.
    pub solid: Solid,
}

/// Whether a mesh bounds a solid, and what keeps it from that.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Whether as many triangles run one way as the other along every edge, by position. Only then is a side known for
    /// sure; otherwise inside is where the generalized winding number is above a half.
    pub closed: bool,
    /// Edges with one triangle only.
    pub boundary_edges: u64,
    /// Edges with more than two triangles.
    pub non_manifold_edges: u64,
    /// Edges whose two triangles run the same way.
    pub inconsistent_edges: u64,
    /// Whether neighbours can be turned so that all agree; a Möbius strip cannot.
    pub orientable: bool,
    /// Pairs of triangles that meet where they should not.
    pub self_intersections: u64,
    /// Whether it is closed and its front is inside: nothing is inside of it then.
    pub inside_out: bool,
    /// Whether it has no triangles.
    pub empty: bool,
}

impl Solid {
    /// What `mesh` is.
    ///
    /// # Errors
    /// As for [`self_intersections`].
    pub fn of(mesh: &Mesh, closed: bool, job: &Job) -> Result<Self, Stopped> {
        let found = validity(mesh, Topology::Positions);
        let count = |finding: &Finding| finding.count;
        Ok(Self {
            closed,
            boundary_edges: count(&found.boundary_edges),
            non_manifold_edges: count(&found.non_manifold_edges),
            inconsistent_edges: count(&found.inconsistent_edges),
            orientable: found.orientable,
            self_intersections: count(&self_intersections(mesh, job)?),
            inside_out: closed && measure(mesh).signed_volume < 0.0,
            empty: mesh.faces().is_empty(),
        })
    }

    /// Whether it is one: closed, right side out, and nowhere through itself.
    #[must_use]
    pub fn is_solid(&self) -> bool {
        self.closed && !self.inside_out && !self.empty && self.self_intersections == 0
    }
}

impl fmt::Display for Solid {
    /// One sentence.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_solid() {
            return f.write_str("the mesh is a solid");
        }
        let mut faults = Vec::new();
        let mut add = |n: u64, what: &str| {
            if n > 0 {
                faults.push(format!("{n} {what}"));
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
            "inside is where it winds around a point more often than not at all"
        } else {
            "inside is where its winding number is above a half, and away from holes only that is sure"
        };
        write!(f, "the mesh is not a solid: {}; {sides}", faults.join(", "))
    }
}

/// The field of a mesh: at every point the distance to the nearest triangle, negative inside.
///
/// **Value.** The distance is that of the nearest triangle and never scaled; it is off by a few units in the last place
/// of the distance and the mesh's extent. The side comes from the winding number: for closed meshes (see
/// [`Enclosure`](crate::explicit::Enclosure)) a whole number, counted by exact predicates, and every answer is right
/// however the mesh goes through itself; for others the generalized winding number, inside being above a half within the
/// box of the triangles. An exact
/// distance for solids; a bound for closed meshes that go through themselves, whose inner walls are no surface; for
/// meshes that are not closed only a sign, since sides change where there is no triangle.
///
/// **Ranges** are proved for closed meshes: they hold the true distances, whatever was rounded, and leave room for the
/// rounding of computed ones. For others they are, under the promise that the mesh is meant as the
/// winding number takes it, and never claim to be continuous.
///
/// **Cost.** A tree of boxes and moments, the search for self-intersections; about 1 µs a point near others.
///
/// # Errors
/// As for [`Bvh::build`](crate::explicit::Bvh::build).
///
/// ```
/// use chordal::{Job, Mesh, convert::mesh_to_field};
/// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let made = mesh_to_field(&Mesh::new(corners.clone(), faces.clone()).unwrap(), &Job::default())?;
/// assert!(made.solid.is_solid());
/// assert_eq!(made.field.expr().at([0.25, 0.25, -2.0]).unwrap(), 2.0);
/// assert_eq!(made.field.expr().at([0.25, 0.25, 0.125]).unwrap(), -0.125);
///
/// let open = mesh_to_field(&Mesh::new(corners, faces[1..].to_vec()).unwrap(), &Job::default())?;
/// assert!(open.solid.to_string().starts_with("the mesh is not a solid: 3 edges have one triangle only"));
/// # Ok::<(), chordal::budget::Stopped>(())
/// ```
///
/// Sources: J. Bærentzen, H. Aanæs, *Signed distance computation using the angle weighted pseudonormal*, 2005, for what
/// a side is; ours is by winding numbers, which need no normals: A. Jacobson et al., 2013.
pub fn mesh_to_field(mesh: &Mesh, job: &Job) -> Result<MeshField, Stopped> {
    let leaf = MeshLeaf::new(mesh, job)?;
    let solid = Solid::of(mesh, leaf.is_closed(), job)?;
    let distance = match (solid.is_solid(), solid.closed && !solid.empty) {
        (true, _) => Distance::EXACT,
        (_, true) => Distance::BOUND,
        _ => Distance::SIGN,
    };
    let bounds = mesh.bounds();
    let field =
        Field::new(Expr::leaf(Arc::new(leaf), Expr::axes())).known_distance(distance).known_bounds(bounds);
    Ok(MeshField { field, solid })
}
