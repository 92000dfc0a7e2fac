//! Where samples on a lattice are at a level: as a field, and how far that surface is from triangles.
use crate::volume::reaches_border;
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

/// The interpolant of samples as a field, negative inside of the surface at a level; `None` where a sample is no
/// number or the surface reaches the border, beyond which the samples say nothing.
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
    // All that is inside is within the box, so that cutting the field off there changes nothing, and makes it known.
    let region = Some(Box3::from_points(&corners));
    Some(ImplicitShape::new(Field::new(expr), region, Frame::default()).solid())
}

/// The distance between triangles and where the interpolant of samples vanishes, both ways, judged without knowing
/// how the samples were made; `None` where nothing can be proved.
///
/// A limit is asked for and not the distance itself, which would take some fifty times as long: the first of a few
/// shares of the spacing that holds.
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

/// Shares of the spacing of samples: smooth surfaces are within the first; the third is the most that the interpolant
/// of true distances can be off on its own surface, √3/2 of it, rounded up; sharp corners are cut off by several. Chosen,
/// but for the third.
const SHARES: [f64; 6] = [0.125, 0.5, 0.875, 2.0, 4.0, 8.0];
