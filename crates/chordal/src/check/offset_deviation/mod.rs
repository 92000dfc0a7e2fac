//! How far a mesh is from the surface at a given distance from another mesh, proved.
//!
//! Let S be a closed mesh, Ω the points around which it winds more than 0 times, r > 0. For an offset outward the *free*
//! points are those outside of Ω with a distance to S above r, for an offset inward those inside; the *near* points are
//! all points on the other side, and those with a distance below r. The offset surface L is the common boundary of both
//! sets.
//!
//! **Lemma.** Let M be a closed oriented triangle mesh, closed by its rows, M⁺ and M⁻ copies of it whose vertices are
//! displaced by t at most.
//! If
//! 1. all points of M⁺ are free, and all points of M⁻ are near,
//! 2. M⁺ winds a times around a vertex of each connected part of S,
//! 3. every free point can be joined, by free points, to one around which M⁻ winds b ≠ a times,
//!
//! then every point of M has one of L within t, and every point of L one of M.
//!
//! *Proof.* From a point of M⁻ over that of M to that of M⁺ run two segments of length t at most, from near points to
//! free ones: they meet L. For the other direction let p in L have no point of M within t. The straight motion M⁻ → M →
//! M⁺ misses p, and by compactness a ball around p, so both copies have the same winding number around all points of the
//! ball. The ball contains near and free points. From a near point, if its distance to S is at least r, it is on the
//! other side, and the segment to its nearest point of S consists of near points, as does the one from any other near
//! point; from there S itself, at distance 0, leads to a vertex: M⁺ misses all of them, so it winds a times around the
//! near point. M⁻ misses all free points, so by 3 it winds b times around the free one. ∎
//!
//! *Condition 1.* `clearance.rs`: the distance of a triangle of M⁺ to each face of S is bounded from below by a plane
//! between them, and that of a piece of M⁻ to one face from above by its corners.
//!
//! *Condition 3.* `growth.rs`: a cell whose middle is more than r and half of its diagonal away from S is free, and M⁻ is
//! asked about its middle. A cell nearer than that by as much is near. In each other cell the distance must grow along
//! some direction. Then a free point of such cells, and all that it is joined to within them, cannot have its largest
//! distance there: the set of these points is joined to a free cell.
mod clearance;
mod copies;
mod growth;

use super::components;
use crate::budget::{
    Bound, Evidence, Job, JobError, OpenPlace, OpenPlaces, Reference, Refusal, RefusalCode, par_map,
};
use crate::explicit::{Bvh, Mesh, PointLocation, Topology, WindingMoments, is_closed, nearest_on_triangle};
use crate::math::{Box3, cross, difference, greater, length, lesser, sub_down, unit};
use copies::{Copies, CopySide};

/// What is known of a mesh and an offset surface.
#[derive(Clone, Debug)]
pub(crate) struct OffsetVerdict {
    /// The bound, two-sided; measured if some place stayed open, with the largest of them.
    pub bound: Bound,
    /// A point of each place that is not proved.
    pub open: Vec<[f64; 3]>,
}

/// The mesh of which the distance is taken, prepared.
pub(crate) struct OffsetSource {
    /// Without faces that have a corner twice, which are no part of its boundary.
    mesh: Mesh,
    bvh: Bvh,
    moments: WindingMoments,
    /// The distance, above 0.
    radius: f64,
    is_outward: bool,
}

impl OffsetSource {
    pub fn new(mesh: &Mesh, by: f64, job: &Job) -> Result<Self, JobError> {
        let mesh = welded(mesh);
        let bvh = Bvh::build(&mesh, job)?;
        let moments = WindingMoments::new(&mesh, &bvh);
        Ok(Self { mesh, bvh, moments, radius: by.abs(), is_outward: by > 0.0 })
    }

    /// The mesh as it is looked at.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Whether a point that is not on the mesh is on the free side.
    fn is_on_free_side(&self, p: [f64; 3]) -> bool {
        let side = self.moments.enclosure(&self.bvh).inside(p).side;
        if self.is_outward { side == PointLocation::Outside } else { side == PointLocation::Inside }
    }

    /// The distance to the mesh minus the radius, positive where free, up to rounding.
    fn value(&self, p: [f64; 3], row: &mut u32) -> f64 {
        match self.bvh.distance_with_hint(p, *row) {
            Some((distance, nearest)) => {
                *row = nearest;
                distance - self.radius
            }
            None => f64::INFINITY,
        }
    }

    /// The way along which the distance to the mesh grows; 0 on the mesh.
    fn gradient(&self, p: [f64; 3], row: &mut u32) -> [f64; 3] {
        let Some((_, nearest)) = self.bvh.distance_with_hint(p, *row) else { return [0.0; 3] };
        *row = nearest;
        let (corners, _) = self.bvh.triangle_of(nearest);
        unit(difference(p, nearest_on_triangle(p, corners))).unwrap_or([0.0; 3])
    }
}

/// How far `surface` is from the surface at the signed distance `by` from the solid `source`, positive outward: proved to
/// be within some length of at most `limit`, if possible.
///
/// **What the bound covers.** Both directions: no point of `surface` is farther from the offset surface, and no point of the
/// offset surface is farther from `surface`. The offset surface is the boundary between the points that are nearer to the
/// solid than `by` and those that are farther, so hidden voids count. If a place is not proved, the bound is measured, and
/// lists such places.
///
/// **Cost.** Some 20 µs a triangle of `surface`, and 10 µs a cell of about a quarter of the distance's size along it.
///
/// # Errors
/// As for [`Bvh::build`](crate::explicit::query::Bvh::build).
///
/// ```
/// use chordal::{Job, Mesh, check};
/// let cube = |half: f64| {
///     let corner = |c: usize| [0, 1, 2].map(|k| if c >> k & 1 == 1 { half } else { -half });
///     let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
///     let faces = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
///     Mesh::new((0..8).map(corner).collect(), faces).unwrap()
/// };
/// // Inward, corners stay sharp.
/// let bound = check::offset_deviation(&cube(0.75), &cube(1.0), -0.25, 0.01, &Job::default())?;
/// assert!(bound.at_most().unwrap() <= 0.01);
/// # Ok::<(), chordal::budget::JobError>(())
/// ```
pub fn offset_deviation(
    surface: &Mesh,
    source: &Mesh,
    by: f64,
    limit: f64,
    job: &Job,
) -> Result<Bound, JobError> {
    Ok(offset_deviation_from(surface, &OffsetSource::new(source, by, job)?, limit, job)?.bound)
}

/// [`offset_deviation`] from a prepared source.
pub(crate) fn offset_deviation_from(
    surface: &Mesh,
    source: &OffsetSource,
    limit: f64,
    job: &Job,
) -> Result<OffsetVerdict, JobError> {
    if !(limit > 0.0 && limit.is_finite()) {
        let refusal = Refusal::new(RefusalCode::Usage, "a limit is a length above 0");
        return Err(JobError::Refused(refusal));
    }
    job.run(|| {
        let surface = &welded(surface);
        let copies = Copies::build(surface, source, limit, job);
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let mut places = copies.open_places();
        let is_closed = source.moments.enclosure(&source.bvh).is_closed() && is_closed(surface);
        if places.is_empty() && is_closed {
            places = winding_faults(&copies, source, job)?;
            places.extend(growth::open_cells(&copies, source, limit, job)?);
        }
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let open: Vec<[f64; 3]> = places.iter().map(|place| place.at).collect();
        let measured = copies.measured;
        let bound = if places.is_empty() && is_closed {
            let least = greater(sub_down(measured, rounding(surface, source)), 0.0);
            Bound::proved(lesser(least, copies.reach), copies.reach, Reference::Field)
        } else {
            let evidence = Evidence::Measured { samples: copies.n_samples() };
            let area = (0..surface.faces().len()).map(|face| area(surface.corners(face))).sum();
            let mut bound = Bound::with_evidence(measured, None, evidence, Reference::Field);
            bound.open = Some(Box::new(OpenPlaces::new(places, area)));
            bound
        };
        Ok(OffsetVerdict { bound, open })
    })
}

/// One row for each position, and no face that has a row twice: what is closed then has its displaced copies closed.
fn welded(mesh: &Mesh) -> Mesh {
    let ids = Topology::Positions.ids(mesh);
    let id = |v: u32| ids.as_ref().map_or(v, |ids| ids[v as usize]);
    let faces = mesh.faces().iter().map(|face| face.map(id)).filter(|[a, b, c]| a != b && b != c && c != a);
    Mesh::new(mesh.positions().to_vec(), faces.collect()).expect("the rows are the same")
}

/// How far a distance between both meshes may be rounded: some roundings of their coordinates.
fn rounding(surface: &Mesh, source: &OffsetSource) -> f64 {
    let coordinates = surface.positions().iter().chain(source.mesh.positions()).flatten();
    256.0 * f64::EPSILON * coordinates.fold(0.0, |most, x| greater(x.abs(), most))
}

fn area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    0.5 * length(cross(difference(b, a), difference(c, a)))
}

fn point_place(at: [f64; 3]) -> OpenPlace {
    OpenPlace { at, size: 0.0, area: 0.0, contact: None }
}

/// The parts of the source around which the free copy does not wind as it should, by a vertex of each.
fn winding_faults(copies: &Copies, source: &OffsetSource, job: &Job) -> Result<Vec<OpenPlace>, JobError> {
    let bvh = Bvh::build(copies.mesh(CopySide::Free), job)?;
    let moments = WindingMoments::new(copies.mesh(CopySide::Free), &bvh);
    let enclosure = moments.enclosure(&bvh);
    let wanted = if source.is_outward { 1.0 } else { 0.0 };
    if !enclosure.is_closed() {
        let first = copies.mesh(CopySide::Free).positions().first();
        return Ok(first.map(|p| point_place(*p)).into_iter().collect());
    }
    let parts = components(&source.mesh, Topology::Indices);
    let firsts: Vec<[f64; 3]> =
        parts.iter().map(|part| source.mesh.corners(part.first_face as usize)[0]).collect();
    let is_right = par_map(job, &firsts, |_, p| enclosure.inside(*p).winding.value == wanted);
    Ok(firsts
        .into_iter()
        .zip(is_right)
        .filter(|(_, is_right)| !is_right)
        .map(|(p, _)| point_place(p))
        .collect())
}

fn centroid([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
}

/// The box of some points.
fn hull<'p>(points: impl IntoIterator<Item = &'p [f64; 3]>) -> Box3 {
    let empty = Box3 { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };
    points.into_iter().fold(empty, |hull, p| Box3 {
        min: std::array::from_fn(|k| lesser(p[k], hull.min[k])),
        max: std::array::from_fn(|k| greater(p[k], hull.max[k])),
    })
}
