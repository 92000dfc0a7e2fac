//! `field_deviation_at`: lower bounds on the deviation of a mesh from a field, from one given point.
use super::probe::{ProbeSharpness, probe_distances};
use super::slope::{distance_up, is_inside, is_outside};
use super::{POINTS_A_BOX, leaf_failure, reach};
use crate::budget::{Job, JobError};
use crate::explicit::{Bvh, Mesh};
use crate::implicit::{Dual, Field, Tape};
use crate::math::{Box3, Interval, greater, sub_down, unit_and_length};

/// Lower bounds on the distance from a mesh to the surface of a field, and from that surface to the mesh,
/// from one point near either: `[from the mesh, from the field]`, each 0 if the point proves nothing.
///
/// *What they cover.* Both are proved, rounding included, for any point. From the mesh it is the distance of
/// the point from the surface, less that from the mesh; from the field the other way round. Without proved
/// ranges both are 0.
///
/// *Cost.* The tree over the mesh and at most some hundred thousand evaluations: for a point at which the two
/// are claimed to be farthest apart, in place of a search for one as in
/// [`field_deviation`](super::field_deviation).
///
/// # Errors
/// [`JobError::Refused`] if a leaf of the field fails, and as for [`Bvh::build`].
///
/// ```
/// use chordal::check::field_deviation_at;
/// use chordal::implicit::{Expr, Field};
/// use chordal::math::Box3;
/// use chordal::{Job, Mesh};
/// let [x, y, z] = Expr::axes();
/// let ball = Field::new(x.square() + y.square() + z.square() - 1.0)
///     .with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] });
/// let axes = [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
/// let faces = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
/// let mesh = Mesh::new(axes.to_vec(), faces)?;
/// let truth = 1.0 - 1.0 / 3.0_f64.sqrt();
/// // The middle of a face, and the point of the sphere beyond it.
/// let [forward, _] = field_deviation_at(&mesh, &ball, [1.0 / 3.0; 3], &Job::default())?;
/// let [_, backward] = field_deviation_at(&mesh, &ball, [1.0 / 3.0_f64.sqrt(); 3], &Job::default())?;
/// assert!(0.99 * truth < forward && forward <= truth);
/// assert!(truth - 1e-12 < backward && backward <= truth);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn field_deviation_at(mesh: &Mesh, field: &Field, p: [f64; 3], job: &Job) -> Result<[f64; 2], JobError> {
    let bounds = field.bounds();
    let is_known = field.evidence().bounds_above() && bounds.diagonal().is_finite();
    if !is_known || mesh.faces().is_empty() || !p.iter().all(|x| x.is_finite()) {
        return Ok([0.0; 2]);
    }
    let (tape, bvh) = (Tape::new(field.sign()), Bvh::build(mesh, job)?);
    let Some((low, high)) = bvh.closest_distance_down(p).zip(bvh.closest_distance_up(p)) else {
        return Ok([0.0; 2]);
    };
    // Two points with different signs enclose the surface, and a range over points is a proof. So
    // the near side costs two evaluations a step; that nothing is nearer costs boxes.
    let surface_distance = surface_within(&tape, &bounds, p, reach(mesh, &bounds))?;
    job.count_work(POINTS_A_BOX * 2 * STEPS as u64);
    let backward = surface_distance.map_or(0.0, |distance| greater(sub_down(low, distance), 0.0));
    // If the surface is nearer than the mesh, the point proves nothing in the other direction.
    if surface_distance.is_some_and(|distance| distance <= high) {
        return Ok([0.0, backward]);
    }
    let most = surface_distance.unwrap_or_else(|| bounds.union(mesh.bounds()).diagonal());
    let probed = probe_distances(&tape, &[p], &[most], ProbeSharpness::CLOSE).map_err(leaf_failure)?;
    job.count_work(POINTS_A_BOX * probed.iter().map(|probed| probed.n_boxes).sum::<u64>());
    let forward = probed.first().map_or(0.0, |probed| greater(sub_down(probed.at_least, high), 0.0));
    Ok([forward, backward])
}

/// The number of step lengths at which the other side of the surface is searched. Derived: each is twice the
/// previous one, from the last place of the largest coordinate to all of it.
const STEPS: usize = f64::MANTISSA_DIGITS as usize;

/// An upper bound on the distance of a point from the surface, from two points beside it along the gradient
/// whose signs differ: the segment between them meets the boundary.
fn surface_within(tape: &Tape, bounds: &Box3, p: [f64; 3], size: f64) -> Result<Option<f64>, JobError> {
    let mut slope = [Dual { value: 0.0, gradient: [0.0; 3] }];
    tape.gradient_at(&[p], &mut slope).map_err(leaf_failure)?;
    let (unit, length) = unit_and_length(slope[0].gradient);
    if !(length > 0.0 && length.is_finite()) {
        return Ok(None);
    }
    // One unit in the last place of the largest coordinate.
    let mut step = f64::EPSILON * size;
    let mut pairs = Vec::with_capacity(STEPS);
    for _ in 0..STEPS {
        pairs.push(
            [step, -step].map(|offset| -> [f64; 3] { std::array::from_fn(|k| p[k] + offset * unit[k]) }),
        );
        step *= 2.0;
    }
    let ends: Vec<Box3> = pairs.iter().flatten().map(|p| Box3 { min: *p, max: *p }).collect();
    let mut signs = vec![Interval::UNKNOWN; ends.len()];
    tape.over(&ends, &mut signs).map_err(leaf_failure)?;
    // A point where F is 0 may be in a closed crack, with no surface nearby; and outside the bounds there is
    // none.
    let is_above = |sign: Interval| is_outside(sign) && sign.lo() > 0.0;
    let sides = |[a, b]: [Interval; 2]| is_inside(a) && is_above(b) || is_above(a) && is_inside(b);
    let bracket = pairs
        .iter()
        .zip(signs.chunks_exact(2))
        .find(|(ends, signs)| ends.iter().all(|end| bounds.contains(*end)) && sides([signs[0], signs[1]]));
    Ok(bracket.map(|(ends, _)| greater(distance_up(p, ends[0]), distance_up(p, ends[1]))))
}
