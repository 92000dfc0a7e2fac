//! The arrow from samples on a lattice to triangles: `grid_to_mesh`.
use super::budget_search::length_from_pixels;
use super::cubes::bound::{IsosurfaceDistance, IsosurfaceProof};
use super::cubes::marching_cubes::{Coordinate, Isosurface, MarchingPlan, march, refusal};
use super::cubes::normals::gradient_normals;
use super::cubes::refinement::{
    LevelLattice, MOST_HALVINGS, OctreeMesh, RefinedIsosurface, RefinementGoal, has_keys, refine,
};
use super::cubes::rule::{Normals, Polygonize};
use super::cubes::source::{BrickSamples, DenseSamples, SampleSource};
use crate::budget::{
    Bound, Bounded, Budget, Evidence, Failure, Job, JobError, Reference, RefusalCode, Tolerance,
};
use crate::explicit::{Attribute, Mesh};
use crate::implicit::{Affine3, Grid, Samples, SparseGrid, with_samples};
use crate::math::{Box3, add_up, cross, dot, flushes_subnormals, greater, length, lesser, mul_up, sub_down};

/// Meshes the isosurface of a grid's trilinear interpolant.
///
/// **Bound.** The two-sided Hausdorff distance between the mesh and the boundary of the interpolant's inside,
/// within the lattice's box; *proved*, rounding included (`convert/cubes/bound.rs`). Where the interpolant is
/// steadily monotone through a few cells, the bound falls with the square of the step. For other cells (a thin
/// wall, a saddle, noise) the bound is their diagonal.
///
/// **Mesh.** Always closed and manifold, by combinatorics alone, except at an open border of the lattice.
/// Each edge of the lattice whose samples are on different sides has one vertex, at least a margin away from
/// both. Samples that equal the level are outside and make neither flat triangles nor coinciding ones. The
/// bound includes the margin, 2⁻²⁰ of an edge. On a mirrored lattice the triangles are reversed, so that their
/// front is outside.
///
/// **Budgets.** Without one, the mesh is that of the lattice, with whatever bound it has. With a length, cells
/// whose own bound is larger are halved on the interpolant, and so are their parts, until the bound holds; other
/// cells stay as they are (`convert/cubes/refinement.rs`). The mesh is closed between cells of different levels,
/// too (`transition_cells.rs`). A number of triangles is a limit.
///
/// **Cost.** O(samples) to compare them and O(triangles) for the rest; a bit a sample and a byte for each cell
/// with surface, beside input and output. Halving takes time and memory in proportion to the halved cells and
/// those around them, in up to 12 rounds. It runs on all threads of the job, with the same bytes on any number.
///
/// # Errors
/// [`Failure::Refused`]: no surface, or an axis of one sample ([`RefusalCode::Empty`], with the reason); a
/// level or transform that is not finite or beyond 1e150 ([`RefusalCode::NotFinite`]); steps so small beside the
/// coordinates that rounding loses them ([`RefusalCode::BelowPrecision`]); a margin outside of 2⁻³⁰ to ¼, or a budget in
/// degrees ([`RefusalCode::Unsupported`]); a lattice too close to the eye for pixels
/// ([`RefusalCode::TooClose`]); more triangles or bytes than the job allows; an environment that flushes
/// subnormals. [`Failure::Unmet`] with the best mesh. [`Failure::Cancelled`].
///
/// ```
/// use chordal::convert::{Polygonize, grid_to_mesh};
/// use chordal::implicit::{Affine3, Grid, Samples};
/// use chordal::Job;
/// // One voxel of a mask: an octahedron.
/// let mut mask = vec![0_u8; 27];
/// mask[13] = 1;
/// let grid = Grid::new([3; 3], Samples::U8(mask), Affine3::IDENTITY)?;
/// let bounded = grid_to_mesh(&grid, &Polygonize::above(0.5), None, &Job::default()).expect("a surface");
/// assert_eq!((bounded.shape.positions().len(), bounded.shape.faces().len()), (6, 8));
/// assert!(bounded.bound.at_most().is_some());
/// # Ok::<(), chordal::implicit::InvalidGrid>(())
/// ```
///
/// Source: W. E. Lorensen, H. E. Cline, *Marching cubes*, 1987; W. Schroeder and others, *Flying
/// Edges*, 2015.
pub fn grid_to_mesh(
    grid: &Grid,
    rule: &Polygonize,
    budget: Option<&Budget>,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    with_samples!(grid.samples(), values => {
        let source = DenseSamples { values, size: grid.size(), rule: *rule };
        mesh_source(&source, grid.affine(), (rule, budget, sample_precision(grid.samples())), job)
    })
}

/// Like [`grid_to_mesh`], for samples in bricks: the mesh is the same, bit for bit, as from one array.
///
/// # Errors
/// As for [`grid_to_mesh`].
pub fn sparse_grid_to_mesh(
    grid: &SparseGrid,
    rule: &Polygonize,
    budget: Option<&Budget>,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    mesh_source(
        &BrickSamples { grid, rule: *rule },
        grid.affine(),
        (rule, budget, (grid.largest(), None)),
        job,
    )
}

/// The rule, the budget, and the largest size and the bits of the samples.
type PolygonizeInputs<'a> = (&'a Polygonize, Option<&'a Budget>, (f64, Option<u32>));

fn mesh_source<S: SampleSource>(
    source: &S,
    affine: &Affine3,
    (rule, budget, numbers): PolygonizeInputs,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    check(source.size(), affine, rule)?;
    let bounds = bounds(source.size(), affine, rule);
    let length = allowed_length(budget, &bounds)?;
    let most = budget.and_then(|budget| budget.triangles).unwrap_or(u64::MAX);
    let goal = GridMeshGoal { length, most, sample_precision: numbers };
    let mut mesh = job.run(|| refine_to_budget(source, affine, rule, &goal, job))?;
    if let (Some(px), Some(most)) = (budget.and_then(|budget| budget.pixels), mesh.bound.at_most()) {
        mesh.bound.pixels = px.view.pixels_of(most, &mesh.shape.bounds().union(bounds));
    }
    Ok(mesh)
}

/// The limits that the mesh is refined for.
struct GridMeshGoal {
    length: f64,
    /// The most triangles.
    most: u64,
    sample_precision: (f64, Option<u32>),
}

/// The box of a lattice.
fn bounds(size: [usize; 3], affine: &Affine3, rule: &Polygonize) -> Box3 {
    (0..8).fold(Box3::EMPTY, |all, corner| {
        let last = |k: usize| if corner >> k & 1 == 1 { (size[k] - 1) as f64 } else { 0.0 };
        all.with(affine.at([0, 1, 2].map(|k| rule.offset[k] as f64 + last(k))))
    })
}

/// Halves cells until the bound is within the budget's length, at the latest when their diagonal is. Even if one
/// halving does not improve a cell's bound, the next one may.
fn refine_to_budget<S: SampleSource>(
    source: &S,
    affine: &Affine3,
    rule: &Polygonize,
    goal: &GridMeshGoal,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let GridMeshGoal { length, most, .. } = *goal;
    let is_met =
        |mesh: &Bounded<Mesh>| mesh.shape.faces().len() as u64 <= most && upper_bound(mesh) <= length;
    let refined = if length.is_finite() { refined_mesh(source, affine, rule, goal, job)? } else { None };
    let best = match refined {
        Some(mesh) if is_met(&mesh) => mesh,
        refined => {
            let coarse = mesh_isosurface(source, affine, rule, length, job)?;
            refined.filter(|mesh| upper_bound(mesh) < upper_bound(&coarse)).unwrap_or(coarse)
        }
    };
    let is_met = is_met(&best);
    best.met_if(is_met)
}

/// The mesh with cells halved as far as needed and allowed. `None` if the mesh of the lattice itself has too many
/// triangles, or no cell has samples on both sides.
fn refined_mesh<S: SampleSource>(
    source: &S,
    affine: &Affine3,
    rule: &Polygonize,
    goal: &GridMeshGoal,
    job: &Job,
) -> Result<Option<Bounded<Mesh>>, JobError> {
    let GridMeshGoal { length, most, sample_precision } = *goal;
    let levels = level_lattices(source.size(), affine, rule, length);
    if levels.is_empty() || MarchingPlan::new(source, rule, job)?.triangles as u64 > most {
        return Ok(None);
    }
    let triangles = lesser(most, job.triangle_limit);
    let refinement =
        RefinementGoal { levels: &levels, length, triangles, bytes: job.memory_limit, sample_precision };
    let refined = refine(source, (affine, rule), &refinement, job);
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    let Some(refined) = refined else { return Ok(None) };
    let mesh = match bounded_mesh(refined) {
        (Some(shape), bound) => Bounded { shape, bound },
        (None, bound) => {
            let Isosurface { positions, faces, plan } = march::<f64, S>(source, affine, rule, job)?;
            let shape = Mesh::by_construction(positions, faces);
            Bounded { shape: with_normals(shape, source, affine, rule, &plan, job), bound }
        }
    };
    // Caps are counted only now, and numbers of half-edges have 31 bits.
    let n_triangles = mesh.shape.faces().len() as u64;
    let is_allowed = n_triangles <= triangles && n_triangles <= u64::from(u32::MAX) / 6;
    Ok(is_allowed.then_some(mesh))
}

/// The lattice and its halvings, until a cell's diagonal is within the length, or rounding would lose the steps
/// beside the coordinates.
fn level_lattices(size: [usize; 3], affine: &Affine3, rule: &Polygonize, length: f64) -> Vec<LevelLattice> {
    let mut levels = Vec::new();
    for level in 0..=MOST_HALVINGS as u32 {
        let parts = f64::from(1_u32 << level);
        let finer = size.map(|n| ((n - 1) << level) + 1);
        // Indices are exact in f64.
        let has_indices = (0..3).all(|k| rule.offset[k].unsigned_abs() < 1 << 40) && has_keys(finer);
        let rows = affine.rows().map(|[a, b, c, d]| [a / parts, b / parts, c / parts, d]);
        let Ok(affine) = Affine3::new(rows) else { break };
        let rule = Polygonize { offset: rule.offset.map(|i| i << level), ..*rule };
        if !has_indices || check(finer, &affine, &rule).is_err() {
            break;
        }
        let errors = vertex_errors(&affine, &rule, finer);
        levels.push(LevelLattice::new(affine, rule, errors, length));
        if levels.last().is_some_and(|level| level.is_within(length)) {
            break;
        }
    }
    levels
}

/// A refined mesh, if cells were halved, and the bound. If a rounded value between samples is so near to the
/// level that its side is uncertain, the bound holds on the condition that the rounded values are the interpolant.
fn bounded_mesh(refined: RefinedIsosurface) -> (Option<Mesh>, Bound) {
    let evidence = if refined.is_sure {
        Evidence::Proved
    } else {
        Evidence::ProvedIf(vec![
            "values of the interpolant between samples are taken as rounded to f64".into(),
        ])
    };
    let mut bound = Bound::with_evidence(refined.least, Some(refined.most), evidence, Reference::Trilinear);
    bound.at = Some(refined.at);
    let mesh = refined.mesh.map(|OctreeMesh { positions, faces, normals }| {
        let mesh = Mesh::by_construction(positions, faces);
        if normals.is_empty() {
            return mesh;
        }
        mesh.with_attribute(Attribute::vertex_normals(&normals)).expect("one normal for each vertex")
    });
    (mesh, bound)
}

fn upper_bound(mesh: &Bounded<Mesh>) -> f64 {
    mesh.bound.at_most().unwrap_or(f64::INFINITY)
}

/// The largest magnitude of a sample, and the bits of integer samples.
#[allow(clippy::useless_conversion, reason = "one body for every type of samples")]
fn sample_precision(samples: &Samples) -> (f64, Option<u32>) {
    let bits = match samples {
        Samples::F32(_) | Samples::F64(_) => None,
        integers => Some(8 * integers.width() as u32),
    };
    let largest = with_samples!(samples, values => {
        let finite = |v: f64| if v == f64::INFINITY { f64::MAX } else { v };
        values.iter().fold(0.0, |most, v| greater(finite(f64::from(*v).abs()), most))
    });
    (largest, bits)
}

/// A triangle mesh as plain arrays, without a bound.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleArrays<P> {
    /// n × 3 coordinates.
    pub positions: Vec<[P; 3]>,
    /// m × 3 indices into the positions; counter-clockwise is the front.
    pub faces: Vec<[u32; 3]>,
}

/// The key of a vertex in the lattice of a whole volume. Blocks that share samples give a common vertex the
/// same key and the same position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VertexKey {
    /// The sample at the vertex, or the lower one of its edge.
    pub lattice: [i64; 3],
    /// How often the lattice was halved.
    pub level: u8,
    /// 0, 1 or 2 on an edge along that axis, 3 at the sample itself.
    pub kind: u8,
    /// The label whose surface the vertex is on, in volumes of labels.
    pub sheet: u32,
}

/// Meshes a grid into plain arrays of f64 or f32: the mesh of [`grid_to_mesh`], without its bound.
///
/// Always closed and manifold by indices. In f32, vertices closer than its last place may coincide, see
/// [`Polygonize::MARGIN_F32`].
///
/// Cost: as for [`grid_to_mesh`] without the bound.
///
/// # Errors
/// [`JobError::Refused`] and [`JobError::Cancelled`] as for [`grid_to_mesh`].
pub fn grid_to_triangles<P: Coordinate>(
    grid: &Grid,
    rule: &Polygonize,
    job: &Job,
) -> Result<TriangleArrays<P>, JobError> {
    check(grid.size(), grid.affine(), rule)?;
    job.run(|| {
        with_samples!(grid.samples(), values => {
            let source = DenseSamples { values, size: grid.size(), rule: *rule };
            let Isosurface { positions, faces, .. } = march::<P, _>(&source, grid.affine(), rule, job)?;
            Ok(TriangleArrays { positions, faces })
        })
    })
}

/// The keys of the vertices of [`grid_to_mesh`] (without a budget) and [`grid_to_triangles`], in their order.
///
/// Cost: O(samples) to compare them, 40 bytes a vertex.
///
/// # Errors
/// As for [`grid_to_triangles`].
pub fn vertex_keys(grid: &Grid, rule: &Polygonize, job: &Job) -> Result<Vec<VertexKey>, JobError> {
    check(grid.size(), grid.affine(), rule)?;
    job.run(|| {
        with_samples!(grid.samples(), values => {
            let source = DenseSamples { values, size: grid.size(), rule: *rule };
            let plan = MarchingPlan::new(&source, rule, job)?;
            Ok(plan.for_each_vertex(job, |kind, at| VertexKey {
                lattice: [0, 1, 2].map(|k| rule.offset[k] + at[k] as i64),
                level: 0,
                kind: kind as u8,
                sheet: 0,
            }))
        })
    })
}

/// Meshes any sample source, with a bound.
pub(super) fn mesh_isosurface<S: SampleSource>(
    source: &S,
    affine: &Affine3,
    rule: &Polygonize,
    length: f64,
    job: &Job,
) -> Result<Bounded<Mesh>, JobError> {
    let enough = sufficient_length(length, affine, rule, source.size());
    let Isosurface { positions, faces, plan } = march::<f64, S>(source, affine, rule, job)?;
    if faces.is_empty() {
        return Err(refusal(RefusalCode::Empty, no_surface(source, rule, &plan)));
    }
    let farthest = IsosurfaceProof::new(source, affine, rule, vertex_errors(affine, rule, source.size()))
        .with_enough(enough)
        .max_distance(&plan, job);
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    let mesh = with_normals(Mesh::by_construction(positions, faces), source, affine, rule, &plan, job);
    Ok(Bounded { shape: mesh, bound: bound(farthest, Evidence::Proved, affine, rule, source.size()) })
}

fn with_normals<S: SampleSource>(
    mesh: Mesh,
    source: &S,
    affine: &Affine3,
    rule: &Polygonize,
    plan: &MarchingPlan,
    job: &Job,
) -> Mesh {
    if rule.normals == Normals::None {
        return mesh;
    }
    let normals = gradient_normals(source, affine, rule, plan, job);
    mesh.with_attribute(Attribute::vertex_normals(&normals)).expect("one normal for each vertex")
}

/// Turns a bound in exact coordinates into one for the vertices as written.
pub(super) fn bound(
    farthest: IsosurfaceDistance,
    evidence: Evidence,
    affine: &Affine3,
    rule: &Polygonize,
    size: [usize; 3],
) -> Bound {
    let most = add_up(farthest.most, vertex_displacement(affine, rule, size));
    let least = lesser(farthest.least, most);
    let mut bound = Bound::with_evidence(least, Some(most), evidence, Reference::Trilinear);
    let middle = farthest.at.map(|i| i as f64 + 0.5);
    let cell_center = affine.at([0, 1, 2].map(|k| middle[k] + rule.offset[k] as f64));
    bound.at = Some(farthest.witness.unwrap_or(cell_center));
    bound
}

/// An upper bound of the distance between the written vertices and the interpolant's own zeros.
fn vertex_displacement(affine: &Affine3, rule: &Polygonize, size: [usize; 3]) -> f64 {
    let edge = affine.steps().map(length).into_iter().fold(0.0, |most, l| greater(l, most));
    // A position on an edge has three roundings and the margin; the rest are those of the transform.
    let along_edge = mul_up(mul_up(edge, 1.0 + 8.0 * f64::EPSILON), add_up(rule.margin, 4.0 * f64::EPSILON));
    add_up(along_edge, rounding_error(affine, rule, size))
}

pub(super) fn vertex_errors(affine: &Affine3, rule: &Polygonize, size: [usize; 3]) -> (f64, f64) {
    (vertex_displacement(affine, rule, size), rounding_error(affine, rule, size))
}

/// The bound in exact coordinates that suffices for `length`; 0 if none does.
fn sufficient_length(length: f64, affine: &Affine3, rule: &Polygonize, size: [usize; 3]) -> f64 {
    let remaining = sub_down(length, vertex_displacement(affine, rule, size));
    if remaining > 0.0 && length.is_finite() { remaining } else { 0.0 }
}

/// An upper bound of a vertex's move by rounding. Each coordinate is three products and three sums of a
/// position that is rounded once: eight roundings of no more than the sum of their sizes; √3 times that is less
/// than twice.
fn rounding_error(affine: &Affine3, rule: &Polygonize, size: [usize; 3]) -> f64 {
    let far = [0, 1, 2].map(|k| {
        let (low, high) = (rule.offset[k] as f64, rule.offset[k] as f64 + size[k] as f64);
        greater(low.abs(), high.abs())
    });
    let sizes =
        affine.rows().map(|[a, b, c, d]| a.abs() * far[0] + b.abs() * far[1] + c.abs() * far[2] + d.abs());
    let most = sizes.into_iter().fold(0.0, |most, size| greater(size, most));
    // Twice eight half units in the last place.
    8.0 * f64::EPSILON * most
}

/// The message that says why there are no triangles.
fn no_surface<S: SampleSource>(source: &S, rule: &Polygonize, plan: &MarchingPlan) -> String {
    let [nx, ny, nz] = source.size();
    let side = if rule.inside == super::cubes::rule::Inside::High { "above" } else { "below" };
    if plan.is_inside([0; 3]) {
        return format!(
            "every sample is {side} the level {}, and the border is open: there is no surface",
            rule.level
        );
    }
    let (mut low, mut high, mut n_nan) = (f64::INFINITY, f64::NEG_INFINITY, 0_u64);
    for index in (0..nx * ny * nz).map(|k| [k % nx, k / nx % ny, k / (nx * ny)]) {
        let sample = source.at(index);
        n_nan += u64::from(sample.is_nan());
        low = lesser(sample, low);
        high = greater(sample, high);
    }
    let no_numbers = if n_nan > 0 { format!(", and {n_nan} are no number") } else { String::new() };
    if low > high {
        return format!("none of the {n_nan} samples is a number: there is no surface");
    }
    format!(
        "no sample is {side} the level {}: they lie between {low} and {high}{no_numbers}; there is no surface",
        rule.level
    )
}

/// Numbers beyond this are refused: products of them must stay below 1e308.
const LARGEST: f64 = 1e150;

pub(super) fn check(size: [usize; 3], affine: &Affine3, rule: &Polygonize) -> Result<(), JobError> {
    if let Some(axis) = size.iter().position(|n| *n < 2) {
        let message =
            format!("index {axis} has one sample, so the lattice has no cells: pad it to give it thickness");
        return Err(refusal(RefusalCode::Empty, message));
    }
    // The rounding of the farthest corner, in units of its last place, is eight times its size.
    let far = rounding_error(affine, rule, size) / f64::EPSILON;
    if !(rule.level.abs() <= LARGEST && far <= LARGEST) {
        return Err(refusal(
            RefusalCode::NotFinite,
            format!("a level or a coordinate is beyond {LARGEST:e}"),
        ));
    }
    // Exact: powers of two.
    if !(rule.margin >= 1.0 / 1_073_741_824.0 && rule.margin <= 0.25) {
        return Err(refusal(
            RefusalCode::Unsupported,
            format!("a margin of {} is not between 2^-30 and 1/4", rule.margin),
        ));
    }
    let [a, b, c] = affine.steps();
    let volume = dot(a, cross(b, c)).abs();
    let widest =
        [cross(b, c), cross(c, a), cross(a, b)].map(length).into_iter().fold(0.0, |m, l| greater(l, m));
    // Derived: with that margin, half of the flattest triangle is wider than an eighth of margin times width.
    let narrowest = 0.125 * rule.margin * (volume / widest);
    if narrowest.is_nan() || rounding_error(affine, rule, size) > narrowest {
        let message = "the lattice's steps are too small beside its coordinates: vertices would coincide";
        return Err(refusal(RefusalCode::BelowPrecision, message.into()));
    }
    if flushes_subnormals() {
        let message = "this process flushes subnormal numbers to zero, so nothing can be proved in it";
        return Err(refusal(RefusalCode::FlushesSubnormals, message.into()));
    }
    Ok(())
}

/// The length that a budget allows anywhere in the box; infinite without a length or pixels.
fn allowed_length(budget: Option<&Budget>, bounds: &Box3) -> Result<f64, Failure<Mesh>> {
    let Some(budget) = budget else { return Ok(f64::INFINITY) };
    if budget.angle_deg.is_some() {
        return Err(Failure::refused(
            RefusalCode::Unsupported,
            "an angle is no budget for volumes in this version",
        ));
    }
    let length = budget.length.map_or(f64::INFINITY, Tolerance::get);
    let Some(px) = &budget.pixels else { return Ok(length) };
    let from_pixels = length_from_pixels(bounds, px)?;
    Ok(lesser(from_pixels, length))
}
