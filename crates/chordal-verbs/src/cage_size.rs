//! The size of a cage's limit surface, for lengths given as a percentage of it.
use chordal::Job;
use chordal::budget::{Budget, Failure, Tolerance};
use chordal::convert::cage_to_mesh;
use chordal::math::{Box3, add_up, sub_down};
use chordal_io::Polygons;

/// The precision of that size, as a fraction of the diagonal of the control points. Chosen: quick to mesh, and fine enough
/// for a percentage.
const SIZE_SHARE: f64 = 1e-3;

/// A box that the surface certainly spans: the box of a mesh of it, less the mesh's bound. Along an axis without a certain
/// extent its width is 0.
pub(crate) fn inner_box(polygons: &Polygons) -> Box3 {
    let control = Box3::from_points(polygons.cage.positions());
    let Ok(tolerance) = Tolerance::new(SIZE_SHARE * control.diagonal()) else { return Box3::EMPTY };
    let mesh = match cage_to_mesh(&polygons.cage, &Budget::length(tolerance), &Job::default()) {
        Ok(mesh) => mesh,
        Err(Failure::Unmet(best)) => *best,
        Err(Failure::Refused(_) | Failure::Cancelled) => return Box3::EMPTY,
    };
    let Some(error) = mesh.bound.at_most() else { return Box3::EMPTY };
    let Box3 { min, max } = mesh.shape.bounds();
    let low = min.map(|x| add_up(x, error));
    let high = max.map(|x| sub_down(x, error));
    if (0..3).any(|k| low[k] > high[k]) {
        // Thinner than twice the bound of the mesh: the surface may be flat along that axis.
        let middle = |k: usize| 0.5 * min[k] + 0.5 * max[k];
        let flat = |k: usize| low[k] > high[k];
        return Box3 {
            min: [0, 1, 2].map(|k| if flat(k) { middle(k) } else { low[k] }),
            max: [0, 1, 2].map(|k| if flat(k) { middle(k) } else { high[k] }),
        };
    }
    Box3 { min: low, max: high }
}
