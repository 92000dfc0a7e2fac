//! `field_deviation`: the Hausdorff distance between a mesh and the surface of a field, certified from both
//! sides.
mod at_point;
mod backward;
mod cell_growth;
mod copy_mesh;
mod cover;
mod displacement;
mod face_side_cache;
mod face_sides;
mod forward;
mod from_field;
mod from_mesh;
mod from_sandwich;
mod growth;
mod local_trees;
mod probe;
mod prover;
mod regions;
mod sampled;
mod sandwich;
mod slope;
mod surface_ball;
mod vertex_places;
mod walls;

use super::deviation::{Goal, OneSidedDistance};
use crate::budget::{Bound, Evidence, Job, JobError, Message, Reference, Refusal, RefusalCode};
use crate::explicit::{Bvh, Enclosure, Mesh};
use crate::implicit::{Field, LeafError, Tape};
use crate::math::{Box3, flushes_subnormals, greater, lesser};
pub use at_point::field_deviation_at;
pub(crate) use prover::{SandwichProver, SandwichVerdict};
pub(crate) use sampled::MeasuredDeviation;
pub(crate) use sandwich::{SandwichGoal, is_hopeless};

use backward::BackwardDistance;
use forward::ForwardDistance;
use from_field::TargetMesh;
use from_mesh::{FieldSubtriangle, SubtriangleBounds};

/// The deviation between a mesh and the surface of a field.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldDeviation {
    /// The Hausdorff distance between the two.
    pub bound: Bound,
    /// From the points of the mesh to the surface of the field.
    pub forward: OneSidedDistance,
    /// From the points of the field's surface to the mesh.
    pub backward: OneSidedDistance,
    /// Whether the goal was reached. The bound holds even if it was not.
    pub reached: bool,
    /// Pieces of triangles without any proved surface point nearby. If there are any, there is no upper
    /// bound.
    pub unresolved: u64,
}

/// Pieces in one task.
const CHUNK: usize = 256;
/// The same for fields with leaves, which are evaluated in larger batches.
const LEAF_CHUNK: usize = 1 << 16;
/// Work units of one box, which is evaluated with the whole field. Chosen: as for a piece of a triangle,
/// without its search.
const POINTS_A_BOX: u64 = 16;
/// The rounding of a distance that is 0, relative to the largest coordinate: derived from the slack of pieces
/// (32 ε), taken twice.
const FLOOR: f64 = 64.0 * f64::EPSILON;

/// Encloses the Hausdorff distance between a mesh and the surface of a field, the boundary of the region in
/// which it is negative.
///
/// *What it covers.* All points of both surfaces, rounding included, for any mesh. The field is given by its
/// [`Field::sign`], and its [`Field::bounds`] are trusted: outside of them there is no surface. The surface
/// is the boundary of the interior of the closure of the points with negative values: if two solids share a
/// face, as stacked boxes do, there is no surface between them, as [`Csg`](crate::implicit::Csg) describes.
/// If a leaf of the field has no interval evaluation, nothing can be proved, and the result is measured: a
/// lower bound alone, from the distances of points of the field's surface found near the centroids of the
/// triangles.
///
/// A closed oriented mesh is checked by the signs of the field's primitives on two displaced copies of it,
/// one outside and one inside, and by cells over the bounds that prove that no part of the surface is missed.
/// If that proves nothing, and for open meshes, boxes around triangles and around the field's surface are
/// compared with the values of the whole field.
///
/// *Cost.* With copies 50 to 250 interval evaluations of primitives for each triangle, more for a tight
/// bound, and cells in proportion to the details of the shape, for any bound. The result does not depend on
/// the number of threads.
///
/// # Errors
/// [`JobError::Refused`] with [`RefusalCode::Unsupported`] for a field without finite bounds, with
/// [`RefusalCode::Empty`] for a mesh without faces, with [`RefusalCode::LeafFailed`] if a leaf fails, and as
/// for [`crate::check::deviation`]; [`JobError::Cancelled`].
///
/// ```
/// use chordal::check::{Goal, field_deviation};
/// use chordal::implicit::{Expr, Field};
/// use chordal::math::Box3;
/// use chordal::{Job, Mesh};
/// let [x, y, z] = Expr::axes();
/// let ball = Field::new(x.square() + y.square() + z.square() - 1.0)
///     .with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] });
/// // An octahedron in the ball: its faces are 1 - 1/√3 from the sphere.
/// let axes = [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
/// let faces = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
/// let mesh = Mesh::new(axes.to_vec(), faces)?;
/// let found = field_deviation(&mesh, &ball, &Goal::default(), &Job::default())?;
/// let truth = 1.0 - 1.0 / 3.0_f64.sqrt();
/// assert!(found.bound.at_least() <= truth && truth <= found.bound.at_most().unwrap());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source: the copies and the cells are derived in `check/field_deviation/sandwich.rs` and `cover.rs`; the
/// boxes around the two surfaces in `check/field_deviation/from_mesh.rs` and `from_field.rs`; the mean value
/// theorem for generalized gradients is G. Lebourg's, 1975.
pub fn field_deviation(
    mesh: &Mesh,
    field: &Field,
    goal: &Goal,
    job: &Job,
) -> Result<FieldDeviation, JobError> {
    job.run(|| {
        if flushes_subnormals() {
            let message =
                "the floating-point environment flushes subnormal numbers, so that nothing can be proved";
            return refused(RefusalCode::FlushesSubnormals, message);
        }
        if mesh.faces().is_empty() {
            return refused(RefusalCode::Empty, "the mesh has no triangle, so nothing is near it");
        }
        let bounds = field.bounds();
        if bounds.is_empty() || !bounds.diagonal().is_finite() {
            let message = "the field has no finite bounds to look for its surface in";
            return refused(RefusalCode::Unsupported, message);
        }
        let tape = Tape::new(field.sign());
        if !field.evidence().bounds_above() {
            return Ok(sampled::measured(mesh, (field, &tape), (f64::INFINITY, 0), job)?.whole);
        }
        let bvh = Bvh::build(mesh, job)?;
        let floor = FLOOR * reach(mesh, &bounds);
        let search =
            FieldDeviationSearch { mesh, tape, evidence: field.evidence(), bounds, goal, job, floor };
        let enclosure = Enclosure::new(mesh, &bvh);
        // Only a closed mesh has an inside and an outside for the two copies.
        let sandwich_result =
            if enclosure.is_closed() { from_sandwich::sandwich_deviation(&search, &bvh)? } else { None };
        if let Some(result) = &sandwich_result
            && result.reached
        {
            return Ok(result.clone());
        }
        let (forward, backward) = search.both_directions(&bvh, &enclosure)?;
        let box_result = search.conclusion(&forward, &backward, &bvh);
        Ok(sandwich_result
            .map_or_else(|| box_result.clone(), |sandwich| search.better_of(&sandwich, &box_result)))
    })
}

/// The bound of a proved mesh from its verdict, with a lower bound from a few of the worst faces; `None` if
/// the lower bound contradicts the verdict.
pub(crate) fn sandwich_bound(
    mesh: &Mesh,
    field: &Field,
    verdict: &SandwichVerdict,
    job: &Job,
) -> Result<Option<Bound>, JobError> {
    let (tape, bounds) = (Tape::new(field.sign()), field.bounds());
    let goal = Goal::default();
    let bvh = Bvh::build(mesh, job)?;
    let floor = FLOOR * reach(mesh, &bounds);
    let evidence = field.evidence();
    from_sandwich::bound_from_verdict(
        &FieldDeviationSearch { mesh, tape, bounds, goal: &goal, job, floor, evidence },
        verdict,
        &bvh,
    )
}

/// Measures the deviation of a mesh from the surface of a field by samples alone, even if a proof is
/// possible, and finds the faces from which samples of the surface are farther than a length. Each round of a
/// search takes different samples.
pub(crate) fn measured_field_deviation(
    mesh: &Mesh,
    field: &Field,
    (length, round): (f64, u64),
    job: &Job,
) -> Result<MeasuredDeviation, JobError> {
    sampled::measured(mesh, (field, &Tape::new(field.sign())), (length, round), job)
}

fn refused<T>(code: RefusalCode, message: impl Into<Message>) -> Result<T, JobError> {
    Err(JobError::Refused(Refusal::new(code, message)))
}

fn leaf_failure(error: LeafError) -> JobError {
    JobError::Refused(Refusal::new(RefusalCode::LeafFailed, error.message))
}

/// Applies `look` to selected pieces and updates their bounds.
fn refine_some(
    indices: &[usize],
    pieces: &[FieldSubtriangle],
    bounds: &mut [SubtriangleBounds],
    look: impl FnOnce(&[&FieldSubtriangle], &mut [SubtriangleBounds]) -> Result<(), LeafError>,
) -> Result<(), LeafError> {
    if indices.is_empty() {
        return Ok(());
    }
    let selected: Vec<&FieldSubtriangle> = indices.iter().map(|k| &pieces[*k]).collect();
    let mut selected_bounds: Vec<SubtriangleBounds> = indices.iter().map(|k| bounds[*k]).collect();
    look(&selected, &mut selected_bounds)?;
    indices.iter().zip(selected_bounds).for_each(|(k, tightened)| bounds[*k] = tightened);
    Ok(())
}

/// The largest coordinate of a mesh and a box.
fn reach(mesh: &Mesh, bounds: &Box3) -> f64 {
    let extent = mesh.bounds().union(*bounds);
    extent.min.iter().chain(&extent.max).fold(0.0, |most: f64, x| greater(most, x.abs()))
}

/// The share of the allowed gap between the bounds that the direction from the mesh may take.
const FORWARD_SHARE: f64 = 0.6;
/// The same share in a first rough search: with a goal of a tenth, the bound may be twice the lower one.
const ROUGH_SHARE: f64 = 10.0;

struct FieldDeviationSearch<'a> {
    mesh: &'a Mesh,
    tape: Tape,
    evidence: Evidence,
    bounds: Box3,
    goal: &'a Goal,
    job: &'a Job,
    floor: f64,
}

impl FieldDeviationSearch<'_> {
    /// The upper bound that suffices for every point if the distance of some point is `least`.
    fn sufficient_distance(&self, least: f64) -> f64 {
        let wanted = match self.goal.max {
            Some(max) => max.get(),
            None => {
                let relative = least * (1.0 + greater(self.goal.relative, 0.0));
                greater(relative, self.goal.absolute.map_or(0.0, |length| least + length.get()))
            }
        };
        greater(wanted, self.floor)
    }

    fn both_directions(
        &self,
        bvh: &Bvh,
        enclosure: &Enclosure,
    ) -> Result<(ForwardDistance, BackwardDistance), JobError> {
        let from_field = |forward: &ForwardDistance| {
            // Without an upper bound in this direction there is none for both.
            if forward.unresolved > 0 {
                return Ok(BackwardDistance { least: 0.0, most: f64::INFINITY, at: forward.at });
            }
            let mut target = TargetMesh { bvh, enclosure, residuals: &forward.residuals, tolerance: 0.0 };
            self.backward(forward, &mut target)
        };
        if self.goal.max.is_some() {
            let forward = self.forward(0.0, FORWARD_SHARE)?;
            let backward = from_field(&forward)?;
            return Ok((forward, backward));
        }
        // One direction is often much farther than the other, as at edges replaced by bevels; then the other
        // direction needs no tight bound. So both are first searched roughly.
        let forward = self.forward(0.0, ROUGH_SHARE)?;
        let backward = from_field(&forward)?;
        let least = greater(forward.least, backward.least);
        if forward.most <= self.aim(least, FORWARD_SHARE) || forward.unresolved > 0 {
            return Ok((forward, backward));
        }
        let mut closer = self.forward(least, FORWARD_SHARE)?;
        closer.most = lesser(closer.most, forward.most);
        if forward.least > closer.least {
            (closer.least, closer.at) = (forward.least, forward.at);
        }
        let again = from_field(&closer)?;
        // Keep the better of each bound, since both hold.
        let backward = BackwardDistance {
            least: greater(again.least, backward.least),
            most: lesser(again.most, backward.most),
            at: again.at,
        };
        Ok((closer, backward))
    }

    /// The upper bound to aim at for points of the mesh: a little less than would suffice, to leave a margin
    /// for the other direction.
    fn aim(&self, least: f64, share: f64) -> f64 {
        let enough = self.sufficient_distance(least);
        if self.goal.max.is_some() {
            return enough;
        }
        greater(least + share * (enough - least), self.floor)
    }

    fn check_cancelled(&self) -> Result<(), JobError> {
        if self.job.is_cancelled() { Err(JobError::Cancelled) } else { Ok(()) }
    }

    fn conclusion(
        &self,
        forward: &ForwardDistance,
        backward: &BackwardDistance,
        bvh: &Bvh,
    ) -> FieldDeviation {
        let nearest = |p: [f64; 3]| bvh.closest_point(p).map_or(p, |closest| closest.point);
        let one_sided = |at_least: f64, most: f64, from: [f64; 3], to: [f64; 3]| OneSidedDistance {
            at_least,
            at_most: greater(most, at_least),
            from,
            to,
        };
        let from_mesh = one_sided(forward.least, forward.most, forward.at, forward.at);
        let from_field = one_sided(backward.least, backward.most, backward.at, nearest(backward.at));
        let most = greater(from_mesh.at_most, from_field.at_most);
        let is_bounded = forward.unresolved == 0 && most.is_finite();
        let evidence = if is_bounded {
            self.evidence.clone()
        } else {
            Evidence::Measured { samples: self.mesh.faces().len() as u64 }
        };
        let least = greater(from_mesh.at_least, from_field.at_least);
        let mut bound = Bound::with_evidence(least, is_bounded.then_some(most), evidence, Reference::Field);
        bound.at = Some(if backward.most > forward.most { backward.at } else { forward.at });
        // With a limit the goal is reached as soon as the side of the limit is known.
        let beyond = self.goal.max.is_some_and(|max| least > max.get());
        let reached = is_bounded && most <= self.sufficient_distance(least) || beyond;
        FieldDeviation {
            bound,
            forward: from_mesh,
            backward: from_field,
            reached,
            unresolved: forward.unresolved,
        }
    }
}

impl FieldDeviationSearch<'_> {
    /// Combines the better of each bound, since both hold.
    fn better_of(&self, a: &FieldDeviation, b: &FieldDeviation) -> FieldDeviation {
        let one_sided = |a: OneSidedDistance, b: OneSidedDistance| {
            let farther = if b.at_least > a.at_least { b } else { a };
            OneSidedDistance { at_most: greater(lesser(a.at_most, b.at_most), farther.at_least), ..farther }
        };
        let (forward, backward) = (one_sided(a.forward, b.forward), one_sided(a.backward, b.backward));
        let least = greater(forward.at_least, backward.at_least);
        let most = greater(forward.at_most, backward.at_most);
        let mut bound = Bound::with_evidence(least, Some(most), a.bound.evidence().clone(), Reference::Field);
        bound.at = if b.bound.at_least() > a.bound.at_least() { b.bound.at } else { a.bound.at };
        let reached = b.reached || most <= self.sufficient_distance(least);
        FieldDeviation { bound, forward, backward, reached, unresolved: 0 }
    }
}

/// A cube around a box, with a small margin.
fn cube(bounds: &Box3) -> Box3 {
    let c = bounds.centre();
    let half = (0..3).map(|k| greater(bounds.max[k] - c[k], c[k] - bounds.min[k])).fold(0.0, greater);
    let half = (half * (1.0 + 1.0 / 1024.0)).next_up();
    let half = if half > 0.0 { half } else { f64::MIN_POSITIVE };
    let cube = Box3 { min: c.map(|x| (x - half).next_down()), max: c.map(|x| (x + half).next_up()) };
    cube.union(*bounds)
}

/// The 4 × 4 × 4 sub-boxes of the box, which share their faces bit for bit.
fn sub_boxes(bounds: &Box3) -> impl Iterator<Item = Box3> + use<> {
    let bounds = *bounds;
    let at = move |k: usize, i: usize| match i {
        0 => bounds.min[k],
        4 => bounds.max[k],
        _ => {
            let share = i as f64 / 4.0;
            (1.0 - share) * bounds.min[k] + share * bounds.max[k]
        }
    };
    (0..64_usize).map(move |n| {
        let index = [n % 4, n / 4 % 4, n / 16];
        Box3 {
            min: std::array::from_fn(|k| at(k, index[k])),
            max: std::array::from_fn(|k| at(k, index[k] + 1)),
        }
    })
}

#[cfg(test)]
mod flush_tests;
#[cfg(test)]
mod tests;
