//! Meshes of solids whose surfaces are known in closed form, and proofs of meshes of combined solids against their
//! fields.
//!
//! There is no search here: the number of triangles of a round surface for a length follows from its sagitta, and the
//! bound from the numbers of the mesh. The meshes are then combined by [`boolean`](crate::boolean).
mod arcs;
mod extruded;
mod judge;
mod placed;
mod polyhedra;
mod profile;
mod revolved;
mod rounded;
mod thread;
mod twisted;

use crate::budget::{Bound, Bounded, Job, Reference, Tolerance};
use crate::check::self_intersections;
use crate::explicit::Mesh;
use crate::implicit::Affine3;
use crate::implicit::construction::SolidForm;
use crate::math::{Box3, add_up, greater, mul_up};

pub use super::fields_with_meshes::{SolidNode, SolidTree};
pub use judge::judged_against_field;

/// Meshes solids within a length.
#[derive(Clone, Copy, Debug)]
pub struct SolidMesher {
    /// The largest distance between a mesh and its surface.
    pub length: Tolerance,
    /// A box around the whole model: infinite solids are cut off well outside of it.
    pub room: Box3,
}

/// The margin between the stated bound and the known distance, as a share of the distance. A later proof against the field
/// looks at displaced copies of the mesh, and without a margin would split without end. Chosen: it costs few triangles.
const PROOF_MARGIN: f64 = 1.0 / 16.0;
/// The share of the length for which numbers of triangles are chosen: without that margin. Chosen: 2⁻²⁰ is left for rounding.
const SHARE: f64 = (1.0 - 1.0 / (1 << 20) as f64) / (1.0 + PROOF_MARGIN);

/// Rounding of the coordinates of one solid relative to its largest one: derived, a sine or cosine (2 u), its angle
/// (3 u, of at most π/2), a product and two sums are below 12 u; twice that.
const ROUNDING: f64 = 12.0 * f64::EPSILON;

impl SolidMesher {
    /// The surface of a solid in its own coordinates. `None` for solids without such a mesh: plane shapes that cross
    /// themselves, curved profiles that cross their axis of revolution, a ring that meets itself, twists whose walls are so
    /// thin that their triangles would cross, and solids that would take more than 65,536 segments a turn or a million
    /// quads.
    ///
    /// **Bound.** The Hausdorff distance between the surface and the triangles, *proved*, rounding included. Polyhedra are
    /// exact up to rounding. Round walls have vertices on the surface on both axes, where flat sides may be flush with them,
    /// and outside of it in between; rounded boxes have all vertices on the surface, balls and capsules outside. The bound of
    /// round surfaces is a sixteenth larger than their distance, as a margin for later proofs. Half-spaces and threads are
    /// infinite: their bounds hold in `room`, and between the heights of the form.
    ///
    /// **Triangles.** Closed, manifold, all facing outwards. **Cost.** Linear in the triangles.
    ///
    /// ```
    /// use chordal::convert::solids::SolidMesher;
    /// use chordal::implicit::{construction::ConstructionNode, shapes};
    /// use chordal::{Tolerance, check};
    /// let drill = shapes::cylinder(2.0, 10.0)?;
    /// let Some(ConstructionNode::Solid(form)) = drill.construction().map(|construction| construction.node()) else { panic!() };
    /// let mesher = SolidMesher { length: Tolerance::new(0.01)?, room: drill.bounds() };
    /// let bounded = mesher.mesh(form).expect("a cylinder has a mesh");
    /// assert!(bounded.bound.at_most().unwrap() <= 0.01);
    /// let volume = check::findings::measure(&bounded.shape).signed_volume;
    /// assert!((volume - 40.0 * std::f64::consts::PI).abs() < 1.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn mesh(&self, form: &SolidForm) -> Option<Bounded<Mesh>> {
        let length = SHARE * self.length.get();
        let form_mesh = match form {
            SolidForm::Cuboid { half } => polyhedra::cuboid(*half),
            SolidForm::HalfSpace { normal, offset } => polyhedra::half_space(*normal, *offset, &self.room)?,
            SolidForm::Cone { bottom, top, half } => revolved::cone([*bottom, *top], *half, length)?,
            SolidForm::Sphere { radius } => rounded::rounded_cuboid([0.0; 3], *radius, length)?,
            SolidForm::RoundedCuboid { half, radius } => rounded::rounded_cuboid(*half, *radius, length)?,
            SolidForm::Capsule { ends, radius } => rounded::capsule(*ends, *radius, length)?,
            SolidForm::Torus { major, minor } => revolved::torus(*major, *minor, length)?,
            SolidForm::Extruded { profile, half } => extruded::extruded(profile, *half, length)?,
            SolidForm::Revolved { profile, place } => revolved::revolved(profile, place.as_ref(), length)?,
            SolidForm::Tapered { profile, place, half, factor } => {
                twisted::tapered((profile, place.as_ref()), *half, *factor, length)?
            }
            SolidForm::Twisted { profile, place, heights, radians } => {
                twisted::twisted((profile, place.as_ref()), *heights, *radians, length)?
            }
            SolidForm::Thread { profile, half } => thread::thread(profile, *half, length)?,
        };
        let bounded = form_mesh.bounded()?;
        // Opposite walls of a twist that is thinner than its bound may cross.
        let may_cross = matches!(form, SolidForm::Twisted { .. });
        if may_cross && self_intersections(&bounded.shape, &Job::default()).ok()?.count > 0 {
            return None;
        }
        // The numbers of triangles were chosen for that length; this guards against rounding.
        bounded.bound.at_most().is_some_and(|most| most <= self.length.get()).then_some(bounded)
    }

    /// A mesh under a similarity: a rotation, a mirror, a translation, a uniform scale. The bound is scaled, and includes the
    /// rounding of the map.
    #[must_use]
    pub fn placed(mesh: &Bounded<Mesh>, map: &Affine3) -> Option<Bounded<Mesh>> {
        placed::placed(mesh, map)
    }
}

/// The triangles of a solid, and their error without rounding.
struct FormMesh {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    /// The distance between the surface and the triangles of exact vertices, and copies of them on one side of the
    /// surface, rounded up.
    error: f64,
}

impl FormMesh {
    /// The mesh with its bound; `None` if a coordinate is not finite.
    fn bounded(self) -> Option<Bounded<Mesh>> {
        let reach = self.positions.as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
        let most = add_up(mul_up(self.error, 1.0 + PROOF_MARGIN), mul_up(ROUNDING, reach));
        let mesh = Mesh::new(self.positions, self.faces).ok()?;
        Some(Bounded { shape: mesh, bound: Bound::proved(0.0, most, Reference::Field) })
    }
}
