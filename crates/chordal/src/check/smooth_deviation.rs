//! `patch_deviation`, `cage_deviation`: the deviation of any mesh from smooth surfaces, certified from both
//! sides.
//!
//! The surface is tessellated without cracks. The distance between the tessellation and the surface is
//! bounded without using the mesh, and added to the deviation of the two meshes that
//! [`deviation`](super::deviation()) proves. The tessellation is refined until that distance is a small part
//! of the goal. The lower bound does not suffer from it: a far point is measured again by its closest point
//! on the surface itself.
//!
//! No code of the arrows in `convert` is used, so that this can check them.
mod at_point;
mod patch_tessellation;

use super::deviation::{Deviation, Goal, OneSidedDistance, deviation, refused, two_sided};
use super::limit_deviation::{limit_deviation, sheet_deviations};
use crate::budget::{Job, JobError, Reference, RefusalCode, Tolerance, par_map};
use crate::explicit::cage::limit::QuadPatchTree;
use crate::explicit::{Bvh, Cage, InvalidCage, Mesh, Patch, SurfaceTree};
use crate::math::{add_up, difference, greater, length_up, lesser, mul_up, sub_down};
pub use at_point::{cage_deviation_at, patch_deviation_at};
use patch_tessellation::{LEFT_BY_LEVEL, PatchTessellation};

/// Encloses the Hausdorff distance between a mesh and Bézier patches: the largest distance from any point of
/// either to the nearest point of the other.
///
/// *What it covers.* Both bounds are proved, rounding included, for the exact triangles and the exact
/// patches, for any mesh. `forward` is from the mesh to the patches. Its worst points are on the
/// patches themselves.
///
/// *Cost.* That of [`deviation`](super::deviation()) against triangles that are some ten times as close to
/// the patches as the mesh is, with each part of a patch cut as often as its bending requires: more triangles
/// than an adaptive mesh within a budget would take. With a [`Goal::max`] that is some percent above the true
/// distance they are closer: the teapot's mesh for a hundredth of its size takes 0.2 seconds, that for a
/// thousandth 2, that for a five-thousandth 9. If four million triangles are too few, the goal is not
/// reached, but the bounds hold.
///
/// # Errors
/// As for [`deviation`](super::deviation()), and [`RefusalCode::NotFinite`] for patches.
///
/// ```
/// use chordal::{Budget, Job, Patch, Tolerance, check, convert};
/// let mut bump = Patch::flat([0.0; 3], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
/// for (i, j) in [(1, 1), (1, 2), (2, 1), (2, 2)] {
///     bump.control[i][j][2] = 1.0;
/// }
/// let mesh = convert::patches_to_mesh(&[bump], &Budget::length(Tolerance::new(1e-2)?), &Job::default()).unwrap();
/// let found = check::patch_deviation(&mesh.shape, &[bump], &check::Goal::default(), &Job::default())?;
/// assert!(found.reached && found.bound.at_least() <= mesh.bound.at_most().unwrap());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn patch_deviation(
    mesh: &Mesh,
    patches: &[Patch],
    goal: &Goal,
    job: &Job,
) -> Result<Deviation, JobError> {
    if patches.is_empty() {
        return refused(RefusalCode::Empty, "there is no patch, so nothing is near the mesh");
    }
    let tree = SurfaceTree::from_patches(patches, job)?;
    measured(mesh, &SmoothReference { shape: SmoothShape::Patches(patches), tree }, goal, job)
}

/// Encloses the Hausdorff distance between a mesh and the limit surface of a cage: the largest distance from
/// any point of either to the nearest point of the other.
///
/// *What it covers.* As [`patch_deviation`], including creases, borders, holes and irregular vertices.
///
/// *Cost.* As there, with the polygons of the refined cage as tessellation, at some ten microseconds each: a
/// cube at a thousandth of its size takes some seconds.
///
/// # Errors
/// As for [`deviation`](super::deviation()); [`RefusalCode::Unsupported`] for Loop's scheme,
/// [`RefusalCode::Empty`] for a cage without surface, [`RefusalCode::NotFinite`] if coordinates are beyond
/// 1e150.
///
/// ```
/// use chordal::{Job, Mesh, check, explicit::Cage};
/// let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -1.0 } else { 1.0 });
/// let sides: [&[u32]; 6] = [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
/// let cube = Cage::new((0..8).map(corner).collect(), sides)?;
/// let faces = sides.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect();
/// let mesh = Mesh::new((0..8).map(corner).collect(), faces)?;
/// let found = check::cage_deviation(&mesh, &cube, &check::Goal::default(), &Job::default())?;
/// // The corner of the cube goes to half of itself, and no point of it is farther from its limit.
/// let truth = 0.75_f64.sqrt();
/// assert!(found.bound.at_least() <= truth && truth <= found.bound.at_most().unwrap());
/// assert!(found.forward.at_least > 0.999 * truth);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cage_deviation(mesh: &Mesh, cage: &Cage, goal: &Goal, job: &Job) -> Result<Deviation, JobError> {
    let limit = cage.limit().or_else(invalid_cage)?;
    if limit.n_sheets() == 0 {
        return refused(
            RefusalCode::Empty,
            "the cage has no face with a surface, so nothing is near the mesh",
        );
    }
    let tree = SurfaceTree::from_limit(&limit, job)?;
    measured(mesh, &SmoothReference { shape: SmoothShape::Cage(cage), tree }, goal, job)
}

fn invalid_cage<T>(error: InvalidCage) -> Result<T, JobError> {
    let code = match error {
        InvalidCage::TooMany { .. } => RefusalCode::TooManyTriangles,
        _ => RefusalCode::NotFinite,
    };
    refused(code, error.to_string())
}

/// A smooth surface with its closest-point tree.
struct SmoothReference<'a> {
    shape: SmoothShape<'a>,
    tree: SurfaceTree,
}

enum SmoothShape<'a> {
    Patches(&'a [Patch]),
    Cage(&'a Cage),
}

/// The most triangles of a tessellation. Chosen: about a minute on one core and a gigabyte.
const MOST_CUTS: u64 = 1 << 22;
/// Work units of a triangle of a tessellation, including its comparison. Measured: three microseconds of
/// one core, of 25 to 30 nanoseconds a unit.
const POINTS_A_TRIANGLE: u64 = 128;
/// An estimate of the bytes for each triangle of the tessellation. Derived: 300 for comparing, and a hundred
/// for each corner of a quad's tables.
const BYTES_A_CUT: u64 = 500;
/// Triangles of the first tessellation, from which the necessary fineness is estimated. Chosen: fewer
/// estimate badly.
const FIRST_CUTS: u64 = 1 << 10;
/// The most rounds, each of which quarters the distance; the grid's indices allow no more.
const DEEPEST: u32 = 14;
/// The share of the gap between the two bounds that the tessellation may take. Chosen: finer ones cost more
/// than they save.
const SHARE_OF_GOAL: f64 = 0.5;
/// The number of triangles whose centroids are sampled first, to estimate the deviation of the mesh. Chosen:
/// more take longer than the estimate is worth.
const PILOT: usize = 1 << 10;

impl SmoothReference<'_> {
    /// The number of triangles of a level.
    fn count(&self, level: u32, job: &Job) -> u64 {
        let quads = match self.shape {
            SmoothShape::Patches(patches) => return PatchTessellation::new(patches, level, job).count(),
            // A refinement round makes a quad of each corner of a polygon.
            SmoothShape::Cage(cage) => cage.faces().map(|face| face.len() as u64).sum::<u64>() / 4 + 1,
        };
        2_u64.saturating_mul(quads).saturating_mul(4_u64.saturating_pow(level))
    }

    /// The most triangles that the job can hold and that can be indexed.
    fn limit(&self, job: &Job) -> u64 {
        lesser(lesser(job.triangle_limit, job.memory_limit / BYTES_A_CUT), u64::from(u32::MAX) / 4)
    }

    /// The first tessellation level that is informative.
    fn first_level(&self, job: &Job) -> Result<u32, JobError> {
        let least = match self.shape {
            SmoothShape::Patches(_) => 0,
            // Faces that are not quads have to be refined.
            SmoothShape::Cage(_) => 1,
        };
        let count = self.count(least, job);
        if count > self.limit(job) {
            let message =
                format!("cutting the surface takes {count} triangles; the job allows {}", self.limit(job));
            return refused(RefusalCode::TooManyTriangles, message);
        }
        Ok((least..self.deepest()).find(|level| self.count(*level, job) >= FIRST_CUTS).unwrap_or(least))
    }

    /// The factor of the distance to the surface from one level to the next.
    fn left_by_level(&self) -> f64 {
        match self.shape {
            SmoothShape::Patches(_) => LEFT_BY_LEVEL,
            SmoothShape::Cage(_) => 0.25,
        }
    }

    fn deepest(&self) -> u32 {
        match self.shape {
            SmoothShape::Patches(_) => 2 * DEEPEST,
            SmoothShape::Cage(_) => DEEPEST,
        }
    }

    /// The tessellation, and an upper bound on its two-sided distance to the surface.
    fn cut(&self, level: u32, job: &Job) -> Result<(Mesh, f64), JobError> {
        match self.shape {
            SmoothShape::Patches(patches) => PatchTessellation::new(patches, level, job).triangles(job),
            SmoothShape::Cage(cage) => cut_cage(cage, level, job),
        }
    }

    fn reference(&self) -> Reference {
        match self.shape {
            SmoothShape::Patches(_) => Reference::BezierPatches,
            SmoothShape::Cage(_) => Reference::LimitSurface,
        }
    }
}

/// The polygons after some refinement rounds. Most are close to the limit surface by equal parameters. Beside
/// an irregular vertex, parameters slide along the surface by a share of the polygons' size, which is far
/// more than their deviation. There the polygons are compared, as triangles, with those of some more rounds,
/// and only these by parameters.
fn cut_cage(cage: &Cage, level: u32, job: &Job) -> Result<(Mesh, f64), JobError> {
    let fine = cage.refined_times(level).or_else(invalid_cage)?;
    let limit = fine.limit().or_else(invalid_cage)?;
    let quads: Vec<usize> = (0..limit.n_sheets()).map(|sheet| limit.face_of(sheet).0).collect();
    let is_smooth = |square: &QuadPatchTree| matches!(square, QuadPatchTree::Regular(_));
    let by_parameters =
        sheet_deviations(&fine, |sheet| sheet.square().is_some_and(is_smooth), job).or_else(invalid_cage)?;
    let of_sheets = || quads.iter().copied().zip(&by_parameters);
    // Including the one-ring, in which parameters slide, too.
    let irregular = of_sheets().filter(|(_, distance)| distance.is_none()).map(|(quad, _)| quad);
    let beside = one_ring_mask(&fine, irregular);
    let rough_faces: Vec<usize> = quads.iter().copied().filter(|quad| beside[*quad]).collect();
    let smooth = of_sheets().filter(|(quad, _)| !beside[*quad]);
    // An irregular sheet has no distance by parameters, and is in the mask together with its
    // neighbours. `None` here would be a fault of the mask, and nothing must be proved from it.
    let mut distance = smooth.fold(0.0, |most, (quad, distance)| match distance {
        Some(distance) => greater(most, add_up(*distance, twist(&fine, quad))),
        None => f64::INFINITY,
    });
    if !rough_faces.is_empty() && !job.is_cancelled() {
        let count = 2 * rough_faces.len() as u64;
        // Each round quadruples the faces.
        let rounds = (1..MOST_ROUNDS).rev().find(|k| count << (2 * k) <= ROUGH_CUTS).unwrap_or(1);
        let finest = two_ring_cage(&fine, &rough_faces)
            .and_then(|part| part.refined_times(rounds))
            .or_else(invalid_cage)?;
        let kept_quads: Vec<usize> = (0..finest.n_faces())
            .filter(|face| finest.holes().binary_search(&(*face as u32)).is_err())
            .collect();
        let by_parameters =
            limit_deviation(&finest, job).or_else(invalid_cage)?.at_most().unwrap_or(f64::INFINITY);
        let by_parameters = add_up(
            by_parameters,
            kept_quads.iter().fold(0.0, |most, quad| greater(most, twist(&finest, *quad))),
        );
        let (coarse, finest) = (triangles_of(&fine, &rough_faces)?, triangles_of(&finest, &kept_quads)?);
        // No finer than what is added anyway, or a quarter of what the smooth part has.
        let goal = Goal {
            absolute: Tolerance::new(greater(by_parameters, 0.25 * distance)).ok(),
            ..Goal::default()
        };
        let beside = deviation(&coarse, &finest, &goal, job)?;
        distance = greater(distance, add_up(beside.bound.at_most().unwrap_or(f64::INFINITY), by_parameters));
    }
    let size = cage.positions().as_flattened().iter().fold(0.0, |most, x| greater(most, x.abs()));
    // A mean of k points in a row is off by k roundings, weights included, and means do not amplify earlier
    // errors.
    let most_corners = cage.faces().map(<[u32]>::len).fold(4, usize::max);
    let roundings = 4 * max_vertex_degree(cage) + 4 * most_corners + 64;
    let rounding = 2.0 * f64::from(level + MOST_ROUNDS) * roundings as f64 * f64::EPSILON * size;
    Ok((triangles_of(&fine, &quads)?, add_up(distance, rounding)))
}

/// The most additional rounds beside irregular vertices, and their most triangles. Chosen: distances there
/// shrink by 0.4 to 0.6 a round.
const MOST_ROUNDS: u32 = 6;
const ROUGH_CUTS: u64 = 1 << 17;

/// The faces with two rings of faces around them, which shape their limit surface and are marked as holes.
fn two_ring_cage(cage: &Cage, faces: &[usize]) -> Result<Cage, InvalidCage> {
    // Two rings: the limit over a face depends on its one-ring, and that of the outer vertices of
    // it on the next.
    let near = one_ring_mask(cage, faces.iter().copied());
    let chosen = one_ring_mask(cage, (0..cage.n_faces()).filter(|face| near[*face]));
    let chosen: Vec<usize> = (0..cage.n_faces()).filter(|face| chosen[*face]).collect();
    let mut vertices: Vec<u32> = chosen.iter().flat_map(|face| cage.face(*face)).copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    // The list is sorted, so the position in it is the number in the part.
    let local = |vertex: u32| vertices.partition_point(|v| *v < vertex) as u32;
    let mut edges: Vec<[u32; 2]> = Vec::new();
    for face in &chosen {
        let face_vertices = cage.face(*face);
        let pairs = (0..face_vertices.len())
            .map(|k| (face_vertices[k], face_vertices[(k + 1) % face_vertices.len()]));
        edges.extend(pairs.map(|(a, b)| if a < b { [a, b] } else { [b, a] }));
    }
    edges.sort_unstable();
    let creases = cage.creases().iter().filter(|(ends, _)| edges.binary_search(ends).is_ok());
    let creases: Vec<_> = creases.map(|(ends, sharp)| (ends.map(local), *sharp)).collect();
    let sharp = cage.sharp_vertices().iter().filter(|(vertex, _)| vertices.binary_search(vertex).is_ok());
    let sharp: Vec<_> = sharp.map(|(vertex, sharp)| (local(*vertex), *sharp)).collect();
    let is_kept = |face: &usize| faces.binary_search(face).is_ok();
    let holes = chosen.iter().enumerate().filter(|(_, face)| !is_kept(face)).map(|(k, _)| k as u32);
    let holes: Vec<u32> = holes.collect();
    let positions = vertices.iter().map(|vertex| cage.positions()[*vertex as usize]).collect();
    let faces = chosen.iter().map(|face| cage.face(*face).iter().map(|v| local(*v)).collect::<Vec<_>>());
    let part = Cage::new(positions, faces)?
        .with_scheme(cage.scheme())?
        .with_boundary(cage.boundary())
        .with_creasing(cage.creasing())
        .with_creases(&creases)?
        .with_sharp_vertices(&sharp)?
        .with_holes(&holes)?;
    Ok(if cage.lists_corners() { part.with_corners_listed() } else { part })
}

/// Marks these faces and all faces that share a vertex with one of them.
fn one_ring_mask(cage: &Cage, faces: impl Iterator<Item = usize>) -> Vec<bool> {
    let mut touched = vec![false; cage.positions().len()];
    faces.for_each(|face| cage.face(face).iter().for_each(|vertex| touched[*vertex as usize] = true));
    cage.faces().map(|vertices| vertices.iter().any(|vertex| touched[*vertex as usize])).collect()
}

/// The distance between the two triangles of a quad and its bilinear surface: a quarter of the twist.
fn twist(cage: &Cage, quad: usize) -> f64 {
    let &[a, b, c, d] = cage.face(quad) else { return f64::INFINITY };
    let at = |k: u32| cage.positions()[k as usize];
    mul_up(0.25, length_up(difference(difference(at(a), at(b)), difference(at(d), at(c)))))
}

fn triangles_of(cage: &Cage, quads: &[usize]) -> Result<Mesh, JobError> {
    let quad_vertices = quads.iter().filter_map(|quad| <&[u32; 4]>::try_from(cage.face(*quad)).ok());
    let faces = quad_vertices.flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    cut_mesh(cage.positions().to_vec(), faces)
}

/// The largest number of faces around a vertex, doubled for the edges of open fans.
fn max_vertex_degree(cage: &Cage) -> usize {
    let mut around = vec![0_u32; cage.positions().len()];
    cage.faces().flatten().for_each(|vertex| around[*vertex as usize] += 1);
    2 * around.into_iter().fold(4, u32::max) as usize
}

fn cut_mesh(points: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Result<Mesh, JobError> {
    Mesh::new(points, faces).or_else(|error| refused(RefusalCode::NotFinite, error.to_string()))
}

/// The current bounds for both directions.
struct TwoSidedDistance {
    forward: OneSidedDistance,
    backward: OneSidedDistance,
}

impl TwoSidedDistance {
    fn least(&self) -> f64 {
        greater(self.forward.at_least, self.backward.at_least)
    }

    fn most(&self) -> f64 {
        greater(self.forward.at_most, self.backward.at_most)
    }
}

fn measured(
    mesh: &Mesh,
    smooth: &SmoothReference<'_>,
    goal: &Goal,
    job: &Job,
) -> Result<Deviation, JobError> {
    job.run(|| {
        if mesh.faces().is_empty() {
            return refused(RefusalCode::Empty, "the mesh has no triangle, so nothing is near it");
        }
        let bvh = Bvh::build(mesh, job)?;
        let bounds = bvh.bounds().union(smooth.tree.bounds());
        let farthest = bounds.diagonal();
        if !farthest.is_finite() {
            return refused(RefusalCode::NotFinite, "the extent of the mesh and the surface overflows");
        }
        let reach = bounds.min.iter().chain(&bounds.max).fold(0.0, |most, x| greater(most, x.abs()));
        let wanted = SmoothGoal { goal, floor: FLOOR * reach };
        let sampler = SmoothSampler { smooth, bvh: &bvh };
        // What is known before any work: no two points are farther apart than the box of both is
        // long.
        let nothing = OneSidedDistance { at_least: 0.0, at_most: farthest, from: [0.0; 3], to: [0.0; 3] };
        let mut distances = TwoSidedDistance { forward: nothing, backward: nothing };
        sampler.probe_some_faces(mesh, &mut distances.forward, job);
        let mut level = smooth.first_level(job)?;
        let within_job = lesser(MOST_CUTS, smooth.limit(job));
        let levels =
            |distance, least| wanted.levels((distance, smooth.left_by_level(), smooth.deepest()), least);
        while !wanted.is_met(&distances) {
            // A round that would exceed the job's work is not begun, since half a tessellation
            // proves nothing.
            let affordable = job.work_left() / POINTS_A_TRIANGLE;
            let count = smooth.count(level, job);
            if count > affordable {
                break;
            }
            job.count_work(POINTS_A_TRIANGLE * count);
            let (cuts, distance) = smooth.cut(level, job)?;
            if job.is_cancelled() {
                return Err(JobError::Cancelled);
            }
            let most_cuts = lesser(within_job, job.work_left() / POINTS_A_TRIANGLE);
            let fits = |level: &u32| smooth.count(*level, job) <= most_cuts;
            // As fine as the goal requires, by the current estimate.
            let aim = lesser(level + levels(distance, distances.least()), smooth.deepest());
            // Without a comparison: a tessellation that is too coarse by estimate is not worth one.
            if let Some(finer) = (level + 1..=aim).rev().find(fits) {
                level = finer;
                continue;
            }
            let compared = deviation(mesh, &cuts, &wanted.goal_for_cuts(distance, distances.least()), job)?;
            sampler.take(&mut distances, &compared, distance);
            let n_more = levels(distance, distances.least());
            // The tessellation does not limit the result, so a finer one would not help.
            let is_stuck = !compared.reached && n_more == 0;
            let aim = lesser(level + greater(n_more, 1), smooth.deepest());
            let finer = (level + 1..=aim).rev().find(fits);
            match finer {
                Some(finer) if !is_stuck => level = finer,
                _ => break,
            }
        }
        let mut bound = two_sided(&distances.forward, &distances.backward);
        bound.reference = smooth.reference();
        let reached = wanted.is_met(&distances);
        Ok(Deviation { bound, forward: distances.forward, backward: distances.backward, reached })
    })
}

/// The gap that rounding leaves between the two bounds, relative to the largest coordinate: a little more
/// than the rings of limit surfaces need.
const FLOOR: f64 = 8192.0 * f64::EPSILON;

/// The goal, raised to the level of rounding if it is smaller.
struct SmoothGoal<'a> {
    goal: &'a Goal,
    floor: f64,
}

impl SmoothGoal<'_> {
    fn is_met(&self, distances: &TwoSidedDistance) -> bool {
        let (least, most) = (distances.least(), distances.most());
        match self.goal.max {
            Some(max) => least > max.get() || most <= max.get(),
            None => most - least <= greater(self.gap(least), self.floor),
        }
    }

    /// The allowed gap between the two bounds.
    fn gap(&self, least: f64) -> f64 {
        greater(self.goal.relative * least, self.goal.absolute.map_or(0.0, Tolerance::get))
    }

    /// The number of levels after which a tessellation that is `distance` from the surface is close enough,
    /// if each level leaves the given share of it.
    fn levels(&self, (distance, left_by_level, deepest): (f64, f64, u32), least: f64) -> u32 {
        let gap = self.goal.max.map_or(self.gap(least), |max| sub_down(max.get(), least));
        let wanted = greater(SHARE_OF_GOAL * gap, self.floor);
        // If no distance is known, no further levels.
        let (mut remaining, mut levels) = (if gap > 0.0 { distance } else { 0.0 }, 0);
        while remaining > wanted && levels < deepest {
            (remaining, levels) = (left_by_level * remaining, levels + 1);
        }
        levels
    }

    /// The goal for a tessellation up to `distance` from the surface: the part of the allowed gap that the
    /// tessellation leaves, and at least a part of `distance` itself.
    fn goal_for_cuts(&self, distance: f64, least: f64) -> Goal {
        let max = self.goal.max.and_then(|max| Tolerance::new(sub_down(max.get(), distance)).ok());
        let absolute = greater(0.9 * (self.gap(least) - distance), 0.25 * distance);
        Goal { relative: 0.0, absolute: Tolerance::new(absolute).ok(), max }
    }
}

/// Measures points against the smooth surface itself.
struct SmoothSampler<'a> {
    smooth: &'a SmoothReference<'a>,
    bvh: &'a Bvh,
}

impl SmoothSampler<'_> {
    /// A lower bound on the distance from the mesh to the surface, attained at a mesh point at or near
    /// `from`.
    fn forward_at(&self, from: [f64; 3], tolerance: Option<Tolerance>) -> Option<OneSidedDistance> {
        let beside = self.bvh.closest_distance_up(from)?;
        let closest = self.smooth.tree.closest_point(from, tolerance)?;
        let at_least = greater(sub_down(closest.at_least, beside), 0.0);
        Some(OneSidedDistance { at_least, at_most: f64::INFINITY, from, to: closest.point })
    }

    /// A lower bound on the distance from the surface to the mesh, at the surface point nearest to `near`.
    fn backward_at(&self, near: [f64; 3]) -> Option<OneSidedDistance> {
        let from = self.smooth.tree.closest_point(near, None)?.point;
        let beside = self.smooth.tree.closest_point(from, None)?.at_most;
        let at_least = greater(sub_down(self.bvh.closest_distance_down(from)?, beside), 0.0);
        let to = self.bvh.closest_point(from)?.point;
        Some(OneSidedDistance { at_least, at_most: f64::INFINITY, from, to })
    }

    /// Measures the centroids of some triangles.
    fn probe_some_faces(&self, mesh: &Mesh, forward: &mut OneSidedDistance, job: &Job) {
        let every = mesh.faces().len() / PILOT + 1;
        let faces: Vec<usize> = (0..mesh.faces().len()).step_by(every).collect();
        // A thousandth of the mesh's diagonal shows how far it is, or that it is very near.
        let tolerance = Tolerance::new(1e-3 * mesh.bounds().diagonal()).ok();
        let middles = par_map(job, &faces, |_, face| {
            let [a, b, c] = mesh.corners(*face);
            let middle = [0, 1, 2].map(|k| a[k] / 3.0 + b[k] / 3.0 + c[k] / 3.0);
            let closest = self.smooth.tree.closest_point(middle, tolerance);
            (middle, closest.map_or(0.0, |closest| closest.at_most))
        });
        let far = middles.into_iter().reduce(|far, other| if other.1 > far.1 { other } else { far });
        if let Some(lower) = far.and_then(|(middle, _)| self.forward_at(middle, None)) {
            improve(forward, lower);
        }
    }

    /// Merges the result for a tessellation that is up to `distance` from the surface.
    fn take(&self, distances: &mut TwoSidedDistance, compared: &Deviation, distance: f64) {
        let widened = |side: &OneSidedDistance| OneSidedDistance {
            at_least: greater(sub_down(side.at_least, distance), 0.0),
            at_most: add_up(side.at_most, distance),
            ..*side
        };
        improve(&mut distances.forward, widened(&compared.forward));
        improve(&mut distances.backward, widened(&compared.backward));
        if let Some(lower) = self.forward_at(compared.forward.from, None) {
            improve(&mut distances.forward, lower);
        }
        if let Some(lower) = self.backward_at(compared.backward.from) {
            improve(&mut distances.backward, lower);
        }
    }
}

/// Keeps the better of each bound, since both hold.
fn improve(best: &mut OneSidedDistance, other: OneSidedDistance) {
    if other.at_least >= best.at_least {
        (best.at_least, best.from, best.to) = (other.at_least, other.from, other.to);
    }
    if other.at_most < best.at_most {
        best.at_most = other.at_most;
    }
    // Both bounds are proved, so this changes nothing.
    best.at_most = greater(best.at_most, best.at_least);
}
