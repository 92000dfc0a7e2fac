//! `snap`: rounds positions to those that a format stores. Snap first, then validate and bound the snapped
//! mesh.
use crate::Polygons;
use crate::format::Format;
use crate::format_columns::PositionPrecision;
use crate::single_precision::{origin_of, restore, store};
use crate::snapped_mesh::{SnappedMesh, distance_up};
use chordal::Mesh;
use chordal::math::greater;
use std::fmt;

/// A coordinate outside the range of single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateOverflow {
    /// The coordinate.
    pub value: f64,
}

impl fmt::Display for CoordinateOverflow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "coordinate {:e} is outside single precision, whose limit is {:e}", self.value, f32::MAX)
    }
}

impl std::error::Error for CoordinateOverflow {}

/// Returns the mesh with every position as it reads back from `format`.
///
/// OBJ, PLY and OFF hold f64 exactly, STL rounds to f32, GLB rounds to f32 about an origin that it chooses.
/// Snapping is idempotent. `moved_at_most` covers all rounding, including the rounding when a reader adds the
/// origin.
///
/// Linear in the number of vertices.
///
/// # Errors
/// [`CoordinateOverflow`] if a coordinate overflows single precision.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Format, snap};
///
/// let mesh = Mesh::new(vec![[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let snapped = snap(&mesh, Format::Glb)?;
/// assert_eq!(snapped.mesh.positions()[0][0], f64::from(0.1_f32));
/// assert!(snapped.moved_at_most < 2e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn snap(mesh: &Mesh, format: Format) -> Result<SnappedMesh, CoordinateOverflow> {
    let origin = match format.precision() {
        PositionPrecision::Double => {
            return Ok(SnappedMesh { mesh: mesh.clone(), origin: [0.0; 3], moved_at_most: 0.0 });
        }
        PositionPrecision::Single => [0.0; 3],
        PositionPrecision::SingleAboutOrigin => origin_of(mesh),
    };
    let mut moved_at_most = 0.0;
    let mut positions = Vec::with_capacity(mesh.positions().len());
    for &position in mesh.positions() {
        let snapped = snapped(position, origin)?;
        moved_at_most = greater(distance_up(position, snapped), moved_at_most);
        positions.push(snapped);
    }
    // The positions are finite, and equal ones stay equal, so the mesh accepts them.
    let mesh = mesh.with_positions(positions).map_err(|_| CoordinateOverflow { value: f64::INFINITY })?;
    Ok(SnappedMesh { mesh, origin, moved_at_most })
}

/// A position as it reads back if it is stored about an origin.
fn snapped(position: [f64; 3], origin: [f64; 3]) -> Result<[f64; 3], CoordinateOverflow> {
    let snapped: [f64; 3] = std::array::from_fn(|k| restore(origin[k], store(origin[k], position[k])));
    match (0..3).find(|k| !snapped[*k].is_finite()) {
        Some(k) => Err(CoordinateOverflow { value: position[k] }),
        None => Ok(snapped),
    }
}

/// An upper bound of the distance by which rounding to a format moves a vertex of polygons; 0 if every bit is
/// kept. The text of a file may have more digits than the number type of its format.
///
/// # Errors
/// [`CoordinateOverflow`] if a coordinate overflows single precision.
///
/// ```
/// use chordal::explicit::Cage;
/// use chordal_io::{Format, Frame, Polygons, polygon_rounding};
/// let square = vec![[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let polygons = Polygons::from_cage(Cage::new(square, [[0, 1, 2, 3]])?, Frame::default());
/// assert_eq!(polygon_rounding(&polygons, Format::Obj)?, 0.0);
/// assert!((1e-9..2e-9).contains(&polygon_rounding(&polygons, Format::Usda)?));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn polygon_rounding(polygons: &Polygons, format: Format) -> Result<f64, CoordinateOverflow> {
    if format.precision() == PositionPrecision::Double {
        return Ok(0.0);
    }
    polygons.cage.positions().iter().try_fold(0.0, |most, position| {
        Ok(greater(distance_up(*position, snapped(*position, [0.0; 3])?), most))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worst_snap;
    use proptest::prelude::*;

    fn cloud(centre: [f64; 3], size: f64, unit: &[[f64; 3]]) -> Mesh {
        let positions =
            unit.iter().map(|u| std::array::from_fn(|k| centre[k] + size * u[k])).collect::<Vec<_>>();
        Mesh::new(positions, Vec::new()).expect("finite")
    }

    /// Points in the unit cube, with a centre and a size over twelve orders of magnitude each.
    fn any_cloud() -> impl Strategy<Value = Mesh> {
        let point = prop::array::uniform3(-1.0..1.0_f64);
        let exponent = prop::array::uniform4(-6.0..6.0_f64);
        (prop::collection::vec(point.clone(), 1..20), point, exponent).prop_map(|(unit, direction, e)| {
            let centre = std::array::from_fn(|k| direction[k] * libm::pow(10.0, e[k]));
            cloud(centre, libm::pow(10.0, e[3]), &unit)
        })
    }

    proptest! {
        #[test]
        fn snapping_twice_moves_nothing(mesh in any_cloud()) {
            for format in [Format::Glb, Format::Stl, Format::Obj, Format::Ply, Format::Off] {
                let once = snap(&mesh, format).unwrap();
                let twice = snap(&once.mesh, format).unwrap();
                prop_assert_eq!(twice.moved_at_most, 0.0);
                prop_assert_eq!(&twice.mesh, &once.mesh);
            }
        }

        #[test]
        fn the_bound_before_covers_the_bound_after_covers_what_moved(mesh in any_cloud()) {
            for format in [Format::Glb, Format::Stl] {
                let snapped = snap(&mesh, format).unwrap();
                prop_assert!(snapped.moved_at_most <= worst_snap(&mesh.bounds(), format));
                let wider = mesh.bounds().with([0.0; 3]);
                prop_assert!(worst_snap(&mesh.bounds(), format) <= worst_snap(&wider, format));
                for (a, b) in mesh.positions().iter().zip(snapped.mesh.positions()) {
                    // Differences of neighbours are exact, and the root of the sum of their squares has at
                    // most three roundings: 2⁻⁵⁰ allows for eight.
                    let d = (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>().sqrt();
                    prop_assert!(d * (1.0 - 4.0 * f64::EPSILON) <= snapped.moved_at_most);
                }
            }
        }

        #[test]
        fn what_is_stored_about_the_origin_is_what_reads_back(mesh in any_cloud()) {
            let snapped = snap(&mesh, Format::Glb).unwrap();
            for p in snapped.mesh.positions() {
                for (&o, &x) in snapped.origin.iter().zip(p) {
                    prop_assert_eq!(o, f64::from(o as f32));
                    prop_assert_eq!(restore(o, store(o, x)), x);
                }
            }
        }
    }

    #[test]
    fn a_part_far_from_zero_keeps_its_detail() {
        // A cube of 10 mm at UTM coordinates: stored about zero, single precision would move it by half a
        // metre.
        let corners: Vec<_> =
            (0..8).map(|i| std::array::from_fn(|k| if i >> k & 1 == 0 { 0.0 } else { 0.01 })).collect();
        let mesh = cloud([5e6, 4.5e6, 100.0], 1.0, &corners);
        let glb = snap(&mesh, Format::Glb).unwrap();
        let stl = snap(&mesh, Format::Stl).unwrap();
        assert!(glb.moved_at_most < 2e-9, "moved by {:e}", glb.moved_at_most);
        assert!(stl.moved_at_most > 1e-3);
    }

    #[test]
    fn numbers_that_fit_stay_where_they_are() {
        let single = [[-0.0, 1e-40, 0.1], [3e38, 1.0, -1.0_f32]];
        let mesh = Mesh::new(single.map(|p| p.map(f64::from)).to_vec(), Vec::new()).unwrap();
        let snapped = snap(&mesh, Format::Glb).unwrap();
        assert_eq!((snapped.origin, snapped.moved_at_most), ([0.0; 3], 0.0));
        assert_eq!(snapped.mesh.positions()[0][0].to_bits(), mesh.positions()[0][0].to_bits());
    }

    #[test]
    fn what_overflows_is_refused_and_announced() {
        let mesh = cloud([0.0; 3], 1.0, &[[1e39, 0.0, 0.0]]);
        for format in [Format::Glb, Format::Stl] {
            assert_eq!(snap(&mesh, format), Err(CoordinateOverflow { value: 1e39 }));
            assert_eq!(worst_snap(&mesh.bounds(), format), f64::INFINITY);
        }
        assert_eq!(snap(&mesh, Format::Ply).unwrap().moved_at_most, 0.0);
    }

    #[test]
    fn the_empty_mesh_snaps_to_itself() {
        for format in [Format::Glb, Format::Stl, Format::Obj] {
            assert_eq!(snap(&Mesh::default(), format).unwrap().moved_at_most, 0.0);
            assert_eq!(worst_snap(&Mesh::default().bounds(), format), 0.0);
        }
    }
}
