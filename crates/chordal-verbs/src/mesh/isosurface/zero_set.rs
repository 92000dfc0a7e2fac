//! The surface of samples on a lattice at a level: as a field, and its distance from triangles.
use crate::input::volume::reaches_border;
use crate::{ImplicitShape, MeshFailure};
use chordal::budget::{Bound, Tolerance};
use chordal::check;
use chordal::convert::Inside;
use chordal::implicit::evaluation::{SampleGrid, Trilinear};
use chordal::implicit::{Expr, Field};
use chordal::math::{Box3, greater};
use chordal::{Job, Mesh};
use chordal_io::Frame;
use std::sync::Arc;

/// The interpolant of samples as a field, negative inside of the surface at a level; `None` if a sample is not a number, or
/// the surface reaches the border, beyond which there are no samples.
pub(crate) fn level_field<G: SampleGrid + Clone + 'static>(
    grid: &G,
    level: f64,
    inside: Inside,
) -> Option<Field> {
    if !is_finite(grid) || reaches_border(grid, level, inside) {
        return None;
    }
    let leaf = Expr::leaf(Arc::new(Trilinear::new(grid.clone())), Expr::axes());
    let expr = match inside {
        Inside::Low if level == 0.0 => leaf,
        Inside::Low => leaf - level,
        Inside::High => -leaf + level,
    };
    let last = grid.size().map(|n| (n - 1) as f64);
    let corner = |corner: usize| {
        grid.affine().at(std::array::from_fn(|k| if corner >> k & 1 == 1 { last[k] } else { 0.0 }))
    };
    let corners: Vec<[f64; 3]> = (0..8).map(corner).collect();
    // Everything inside is within the box, so that clipping the field there changes nothing, and gives it known bounds.
    let region = Some(Box3::from_points(&corners));
    Some(ImplicitShape::new(Field::new(expr), region, Frame::default()).solid())
}

/// The two-sided distance between triangles and the zero set of the interpolant of samples, by a judge that does not depend
/// on how the samples were computed; `None` if nothing can be proved.
///
/// The judge only decides on limits, of which the first of a few shares of the spacing that holds is returned; the distance
/// itself would take some fifty times as long.
pub(crate) fn zero_set_distance<G: SampleGrid>(
    grid: &G,
    mesh: &Mesh,
    job: &Job,
) -> Result<Option<Bound>, MeshFailure> {
    let rows = grid.affine().rows();
    let spacing =
        [rows[0][0], rows[1][1], rows[2][2]].into_iter().fold(0.0, |most, x| greater(x.abs(), most));
    for share in SHARES {
        let Ok(max) = Tolerance::new(share * spacing) else { continue };
        if let Some(bound) = check::zero_set_deviation(mesh, grid, max, job)? {
            return Ok(Some(bound));
        }
    }
    Ok(None)
}

fn is_finite<G: SampleGrid>(grid: &G) -> bool {
    let [nx, ny, nz] = grid.size();
    (0..nz).all(|k| (0..ny).all(|j| (0..nx).all(|i| grid.sample([i, j, k]).is_finite())))
}

/// Shares of the spacing of samples. Chosen: smooth surfaces are within the first share; sharp corners are cut off by
/// several. The third is derived: the interpolant of true distances is off by at most √3/2 of the spacing on its own
/// surface, rounded up.
const SHARES: [f64; 6] = [0.125, 0.5, 0.875, 2.0, 4.0, 8.0];
