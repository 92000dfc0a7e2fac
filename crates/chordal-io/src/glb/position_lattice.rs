//! `PositionLattice`: the lattice to which positions are rounded if a glTF stores them in 16 bits.
use crate::single_precision::power_of_two_below;
use crate::snapped_mesh::{SnappedMesh, distance_up};
use chordal::Mesh;
use chordal::math::{Box3, greater};

/// All points whose coordinates are multiples of a power of two.
///
/// Positions rounded to one lattice agree to the last bit wherever they agreed before: between levels of one
/// part, and between tiles of one level. A file stores such a point as three 16-bit numbers about a corner of
/// its own mesh, and a node scales them by the step. The step is a power of two, so that neither the writer
/// nor the reader rounds a second time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionLattice {
    step: f64,
}

/// The largest 16-bit number.
const MOST_STEPS: f64 = u16::MAX as f64;

/// The smallest and the largest step, 2⁻⁴² and 2⁴². Derived: viewers invert the transform of a node in single
/// precision, and the cube of its scale, or of the inverse, must be a normal number there.
const STEPS: [f64; 2] = [1.0 / 4_398_046_511_104.0, 4_398_046_511_104.0];

impl PositionLattice {
    /// The finest lattice on which 16 bits cover a box that is grown by `room` on each side.
    ///
    /// `None` if viewers could not compute with any suitable step: for an empty box, and for one smaller than
    /// about 1e-8 or larger than 1e17.
    ///
    /// ```
    /// use chordal::math::Box3;
    /// use chordal_io::glb::PositionLattice;
    /// let lattice = PositionLattice::for_box(&Box3 { min: [0.0; 3], max: [1.0; 3] }, 0.0).unwrap();
    /// assert_eq!(lattice.step(), 1.0 / 32768.0);
    /// ```
    #[must_use]
    pub fn for_box(bounds: &Box3, room: f64) -> Option<Self> {
        if bounds.is_empty() {
            return None;
        }
        let grown = Box3 { min: bounds.min.map(|x| x - room), max: bounds.max.map(|x| x + room) };
        let extent = (0..3).fold(0.0, |most, k| greater(grown.max[k] - grown.min[k], most));
        let [least, most] = STEPS;
        let finest = power_of_two_below(extent / MOST_STEPS);
        // A single point fits any lattice.
        if !extent.is_finite() || extent > 0.0 && finest < least {
            return None;
        }
        let mut step = greater(finest, least);
        // The corner is rounded down to single precision, from which 16 bits of the finest step may
        // not reach the far end.
        while step <= most {
            let lattice = Self { step };
            if lattice.corner(&grown).is_some() {
                return Some(lattice);
            }
            step *= 2.0;
        }
        None
    }

    /// The finest lattice for a mesh; see [`Self::for_box`].
    #[must_use]
    pub fn for_mesh(mesh: &Mesh) -> Option<Self> {
        Self::for_box(&mesh.bounds(), 0.0)
    }

    /// The distance of neighbours along an axis, a power of two.
    #[must_use]
    pub fn step(self) -> f64 {
        self.step
    }

    /// An upper bound of the distance by which rounding moves a point: half the diagonal of a cell, rounded
    /// up.
    #[must_use]
    pub fn worst(self) -> f64 {
        distance_up([0.0; 3], [0.5 * self.step; 3])
    }

    /// The mesh with its positions rounded. Rounding is idempotent, and points that coincided still do.
    #[must_use]
    pub fn snap(self, mesh: &Mesh) -> SnappedMesh {
        let positions: Vec<_> = mesh.positions().iter().map(|position| self.nearest(*position)).collect();
        let moved = mesh.positions().iter().zip(&positions);
        let moved_at_most = moved.fold(0.0, |most, (a, b)| greater(distance_up(*a, *b), most));
        // The steps are far below the largest number, so positions stay finite; equal positions stay equal.
        let mesh = mesh.with_positions(positions).expect("rounded positions are finite, and tied as before");
        SnappedMesh { mesh, origin: [0.0; 3], moved_at_most }
    }

    /// The nearest point of the lattice; zero has no sign.
    pub(crate) fn nearest(self, position: [f64; 3]) -> [f64; 3] {
        // Both products are exact. A number without digits below the step is one of its multiples.
        position.map(|x| (x / self.step).round() * self.step + 0.0)
    }

    /// The corner about which 16 bits cover everything in a box after rounding; it has single precision, as
    /// viewers read it. `None` if 16 bits are too few.
    pub(crate) fn corner(self, bounds: &Box3) -> Option<[f64; 3]> {
        if bounds.is_empty() {
            return None;
        }
        let (low, high) = (self.nearest(bounds.min), self.nearest(bounds.max));
        let corner = low.map(single_below);
        let reaches = |k: usize| {
            let far = (high[k] - corner[k]) / self.step;
            far <= MOST_STEPS && corner[k].is_finite()
        };
        (0..3).all(reaches).then_some(corner)
    }

    /// The stored numbers of a point about a corner.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(crate) fn stored(self, position: [f64; 3], corner: [f64; 3]) -> [u16; 3] {
        let nearest = self.nearest(position);
        // Whole numbers in the range, by the choice of the corner.
        std::array::from_fn(|k| ((nearest[k] - corner[k]) / self.step) as u16)
    }
}

/// The largest single-precision number that is not above a number. For a multiple of a step the result is
/// also a multiple, if that matters: if the number has more digits than single precision, the last digit of
/// the result is worth more than a step.
#[allow(clippy::cast_possible_truncation)]
fn single_below(x: f64) -> f64 {
    let nearest = x as f32;
    let below = if f64::from(nearest) > x { nearest.next_down() } else { nearest };
    f64::from(below) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cloud() -> impl Strategy<Value = Mesh> {
        let point = prop::array::uniform3(-1.0..1.0_f64);
        let exponent = prop::array::uniform4(-7.0..7.0_f64);
        let meshes =
            (prop::collection::vec(point.clone(), 1..20), point, exponent).prop_map(|(unit, centre, e)| {
                let at = |u: [f64; 3]| {
                    std::array::from_fn(|k| centre[k] * libm::pow(10.0, e[k]) + u[k] * libm::pow(10.0, e[3]))
                };
                Mesh::new(unit.into_iter().map(at).collect(), Vec::new()).expect("finite")
            });
        // Smaller meshes have no lattice, except a single point.
        meshes.prop_filter("too small for viewers", |mesh| {
            let bounds = mesh.bounds();
            let extent = (0..3).fold(0.0, |most, k| greater(bounds.max[k] - bounds.min[k], most));
            extent == 0.0 || extent / MOST_STEPS >= STEPS[0]
        })
    }

    proptest! {
        #[test]
        fn what_is_stored_is_what_was_rounded_to_the_last_bit(mesh in cloud()) {
            let lattice = PositionLattice::for_mesh(&mesh).expect("a lattice");
            let snapped = lattice.snap(&mesh);
            let corner = lattice.corner(&mesh.bounds()).expect("it fits");
            prop_assert_eq!(lattice.corner(&snapped.mesh.bounds()), Some(corner));
            prop_assert!(snapped.moved_at_most <= lattice.worst());
            for (&before, &after) in mesh.positions().iter().zip(snapped.mesh.positions()) {
                let stored = lattice.stored(after, corner);
                for k in 0..3 {
                    prop_assert_eq!(corner[k], f64::from(corner[k] as f32));
                    prop_assert_eq!(corner[k] + f64::from(stored[k]) * lattice.step(), after[k]);
                    // Rounding to the nearest moves by at most half a step. The difference of neighbours is
                    // exact.
                    prop_assert!((after[k] - before[k]).abs() <= 0.5 * lattice.step());
                }
            }
            let twice = lattice.snap(&snapped.mesh);
            prop_assert_eq!(twice.moved_at_most, 0.0);
            // A lattice computed again is this one or a finer one that contains all its points.
            let again = PositionLattice::for_mesh(&snapped.mesh).expect("a lattice");
            prop_assert_eq!(again.snap(&snapped.mesh).moved_at_most, 0.0);
        }

        #[test]
        fn no_finer_lattice_reaches(mesh in cloud()) {
            let lattice = PositionLattice::for_mesh(&mesh).expect("a lattice");
            let finer = PositionLattice { step: 0.5 * lattice.step() };
            let bounds = mesh.bounds();
            let [a, b, c] = [0, 1, 2].map(|k| bounds.max[k] - bounds.min[k]);
            let extent = a.max(b).max(c);
            // A finer lattice could not cover the mesh from any corner, or viewers could not compute with it.
            // A single point uses the finest allowed lattice.
            let too_fine = finer.step() < extent / MOST_STEPS || finer.step() < STEPS[0];
            prop_assert!(too_fine || finer.corner(&bounds).is_none());
        }
    }

    #[test]
    fn extents_that_viewers_cannot_scale_have_no_lattice() {
        let of = |side: f64| PositionLattice::for_box(&Box3 { min: [0.0; 3], max: [side; 3] }, 0.0);
        for (side, exists) in
            [(1e-30, false), (1e-9, false), (1e-7, true), (1e17, true), (1e19, false), (1e30, false)]
        {
            assert_eq!(of(side).is_some(), exists, "{side}");
        }
        assert_eq!(PositionLattice::for_box(&Box3::EMPTY, 0.0), None);
        let wide = Box3 { min: [-f64::MAX; 3], max: [f64::MAX; 3] };
        assert_eq!(PositionLattice::for_box(&wide, 0.0), None);
    }

    #[test]
    fn a_point_and_a_plane_have_a_lattice() {
        let point = Mesh::new(vec![[5e6 + 0.001, -3.0, 0.0]; 3], vec![[0, 1, 2]]).unwrap();
        let lattice = PositionLattice::for_mesh(&point).unwrap();
        assert!(lattice.snap(&point).moved_at_most <= 1e-5, "{lattice:?}");
        let plane = Box3 { min: [0.0, 0.0, 7.5], max: [2.0, 1.0, 7.5] };
        assert_eq!(PositionLattice::for_box(&plane, 0.0).unwrap().step(), 1.0 / 16384.0);
    }
}
