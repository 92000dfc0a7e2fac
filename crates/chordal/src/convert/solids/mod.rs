//! Solids whose surfaces are known in closed form as triangles, and triangles of combinations of solids judged against
//! their fields.
//!
//! Nothing is searched here: how many triangles a round surface takes for a length follows from its sagitta, and the
//! bound from the numbers of the mesh. What combines the meshes ([`boolean`](crate::boolean)) comes after.
mod arcs;
mod extruded;
mod judge;
mod placed;
mod polyhedra;
mod profile;
mod revolved;
mod rounded;
mod split;
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
    /// What surfaces may be off by.
    pub length: Tolerance,
    /// A box that holds the whole: what has no ends is cut off well outside of it.
    pub room: Box3,
}

/// What a claim is above the distance that is known, as a share of it, so that those who prove it again have room: they look
/// at displaced copies of the mesh, and a claim without room would take them endless cuts. Chosen: few more triangles.
const CLAIM_ROOM: f64 = 1.0 / 16.0;
/// The share of a length that counts are chosen for: without that room. Chosen: what is left is for rounding.
const SHARE: f64 = (1.0 - 1.0 / (1 << 20) as f64) / (1.0 + CLAIM_ROOM);

/// Rounding of the coordinates of one solid relative to its largest one: derived, a sine or cosine (2 u), its angle
/// (3 u, of at most π/2), a product and two sums are below 12 u; twice that.
const ROUNDING: f64 = 12.0 * f64::EPSILON;

impl SolidMesher {
    /// The surface of a solid in its own coordinates. None for what has no mesh of its own: plane shapes that cross
    /// themselves, curved profiles that cross the axis they are turned about, a ring that meets itself, twists whose walls are
    /// thinner than the length so that they would cross, and what would take more than 65,536 segments a turn or a million
    /// quads.
    ///
    /// **Bound.** The Hausdorff distance between the surface and the triangles, *proved*, rounding included. Polyhedra are
    /// exact but for rounding. Round walls have vertices on both axes, where others may be flush with them, and outside
    /// between these; rounded boxes have all of them on the surface, balls and capsules outside. The bound of round
    /// surfaces is a sixteenth above what is known of them, which is room for those who prove it again. Half-spaces and threads
    /// have no ends: theirs holds in the room, and between the heights of the form.
    ///
    /// **Triangles.** Closed, manifold, all facing outwards. **Cost.** Linear in the triangles.
    ///
    /// ```
    /// use chordal::convert::solids::SolidMesher;
    /// use chordal::implicit::{construction::ConstructionNode, shapes};
    /// use chordal::{Tolerance, check};
    /// let drill = shapes::cylinder(2.0, 10.0)?;
    /// let Some(ConstructionNode::Solid(form)) = drill.construction().map(|made| made.node()) else { panic!() };
    /// let mesher = SolidMesher { length: Tolerance::new(0.01)?, room: drill.bounds() };
    /// let made = mesher.mesh(form).expect("a cylinder has a mesh");
    /// assert!(made.bound.at_most().unwrap() <= 0.01);
    /// let volume = check::findings::measure(&made.shape).signed_volume;
    /// assert!((volume - 40.0 * std::f64::consts::PI).abs() < 1.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn mesh(&self, form: &SolidForm) -> Option<Bounded<Mesh>> {
        let length = SHARE * self.length.get();
        let made = match form {
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
        let bounded = made.bounded()?;
        // Walls of a twist that are thinner than its bound may change places.
        let may_cross = matches!(form, SolidForm::Twisted { .. });
        if may_cross && self_intersections(&bounded.shape, &Job::default()).ok()?.count > 0 {
            return None;
        }
        // The counts were chosen for it.
        bounded.bound.at_most().is_some_and(|most| most <= self.length.get()).then_some(bounded)
    }

    /// A mesh under a map that keeps shapes: a rotation, a mirror, a translation, one scale. The bound is scaled, and
    /// holds what rounding moves.
    #[must_use]
    pub fn placed(made: &Bounded<Mesh>, map: &Affine3) -> Option<Bounded<Mesh>> {
        placed::placed(made, map)
    }
}

/// Triangles of a solid, and what they are off by but for rounding.
struct FormMesh {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    /// The distance of the exact vertices' triangles from the surface, and of copies on one side of it, rounded up.
    off: f64,
}

impl FormMesh {
    /// The mesh with its bound. None where a coordinate is not finite.
    fn bounded(self) -> Option<Bounded<Mesh>> {
        let reach = self.positions.as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
        let most = add_up(mul_up(self.off, 1.0 + CLAIM_ROOM), mul_up(ROUNDING, reach));
        let mesh = Mesh::new(self.positions, self.faces).ok()?;
        Some(Bounded { shape: mesh, bound: Bound::proved(0.0, most, Reference::Field) })
    }
}
