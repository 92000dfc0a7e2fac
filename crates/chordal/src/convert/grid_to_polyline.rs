//! The arrow from samples on a plane lattice to isolines: `grid_to_polyline`.
use super::cubes::marching_cubes::refusal;
use super::cubes::marching_squares::isolines;
use super::cubes::rule::{LatticeTransform, Polygonize};
use crate::budget::{Bound, Bounded, Failure, Job, Reference, RefusalCode};
use crate::explicit::Polyline;
use crate::implicit::Grid;
use crate::math::{add_up, greater, length, mul_up};

/// Traces the level curves of a grid of one plane of samples. The polylines are closed or end at the border,
/// with inside on the left unless the lattice is mirrored.
///
/// Points are x and y in space; the caller has to make sure that z is constant in the plane. Of a [`Polygonize`],
/// only the level, the inside, the offset and the margin are used.
///
/// **Bound.** The two-sided Hausdorff distance to the boundary of the bilinear interpolant's inside within
/// the lattice: the longest diagonal of a square, *proved* as for [`grid_to_mesh`](super::grid_to_mesh).
///
/// **Cost.** O(samples).
///
/// # Errors
/// [`Failure::Refused`]: not one plane of samples ([`RefusalCode::Unsupported`]), no curve or no square
/// ([`RefusalCode::Empty`]), numbers that are not finite ([`RefusalCode::NotFinite`]).
/// [`Failure::Cancelled`].
///
/// ```
/// use chordal::convert::{Polygonize, grid_to_polyline};
/// use chordal::implicit::{Affine3, Grid, Samples};
/// use chordal::Job;
/// let grid = Grid::new([3, 3, 1], Samples::U8(vec![0, 0, 0, 0, 1, 0, 0, 0, 0]), Affine3::IDENTITY)?;
/// let lines = grid_to_polyline(&grid, &Polygonize::above(0.5), &Job::default()).expect("a curve").shape;
/// assert!(lines.len() == 1 && lines[0].closed && lines[0].points.len() == 4);
/// # Ok::<(), chordal::implicit::InvalidGrid>(())
/// ```
pub fn grid_to_polyline(
    grid: &Grid,
    rule: &Polygonize,
    job: &Job,
) -> Result<Bounded<Vec<Polyline<2>>>, Failure<Vec<Polyline<2>>>> {
    let [nx, ny, nz] = grid.size();
    if nz != 1 {
        let message = format!("level curves need a single plane of samples, and there are {nz}");
        return Err(Failure::refused(RefusalCode::Unsupported, message));
    }
    let transform = LatticeTransform::new(grid.affine(), rule.offset);
    let corner_sizes =
        [[0.0, 0.0], [nx as f64, 0.0], [0.0, ny as f64], [nx as f64, ny as f64]].map(|[i, j]| {
            let at =
                transform.at([i + rule.offset[0] as f64, j + rule.offset[1] as f64, rule.offset[2] as f64]);
            at[0].abs() + at[1].abs()
        });
    if !(rule.level.is_finite() && corner_sizes.iter().all(|x| *x < LARGEST)) {
        return Err(Failure::refused(
            RefusalCode::NotFinite,
            format!("a level or a coordinate is beyond {LARGEST:e}"),
        ));
    }
    let lines = isolines([nx, ny], |[i, j]| rule.is_inside(grid.sample([i, j, 0])));
    if job.is_cancelled() {
        return Err(Failure::Cancelled);
    }
    if lines.is_empty() {
        let message = format!("all samples are on one side of the level {}: there is no curve", rule.level);
        return Err(refusal(RefusalCode::Empty, message).into());
    }
    let shape = lines.into_iter().map(|(line, closed)| {
        let point = |(axis, [i, j]): (usize, [usize; 2])| {
            let ahead = [i + usize::from(axis == 0), j + usize::from(axis == 1), 0];
            let mut index = [transform.global(0, i), transform.global(1, j), transform.global(2, 0)];
            index[axis] += rule.crossing(grid.sample([i, j, 0]), grid.sample(ahead));
            let [x, y, _] = transform.at(index);
            [x, y]
        };
        Polyline { points: line.into_iter().map(point).collect(), places: Vec::new(), closed }
    });
    let [a, b, _] = grid.affine().steps();
    let diagonal = |sign: f64| length([a[0] + sign * b[0], a[1] + sign * b[1]]);
    let longest = greater(diagonal(1.0), diagonal(-1.0));
    let largest = corner_sizes.into_iter().fold(0.0, |most, x| greater(x, most));
    // A point is moved by the margin, on an edge no longer than the diagonal, and by a few roundings of its
    // coordinates.
    let moved_by =
        add_up(mul_up(longest, rule.margin), mul_up(16.0 * f64::EPSILON, add_up(largest, longest)));
    // The length itself is rounded six times.
    let most = add_up(mul_up(longest, 1.0 + 4.0 * f64::EPSILON), moved_by);
    Ok(Bounded { shape: shape.collect(), bound: Bound::proved(0.0, most, Reference::Trilinear) })
}

/// Numbers beyond this are refused: products of them must stay below 1e308.
const LARGEST: f64 = 1e150;
