//! From samples on a lattice to triangles: `grid_to_mesh`.
use super::cubes::bound::{Farthest, Proof};
use super::cubes::finer::Finer;
use super::cubes::march::{Coordinate, Marched, Plan, march, refused};
use super::cubes::normals::gradient_normals;
use super::cubes::rule::{Normals, Polygonize};
use super::cubes::source::{Bricks, Dense, Source};
use super::field_to_mesh::length_on;
use crate::budget::{Bound, Bounded, Budget, Code, Evidence, Failure, Job, Reference, Stopped, Tolerance};
use crate::explicit::{Attribute, Mesh};
use crate::implicit::{Affine, Grid, Samples, SparseGrid, with_samples};
use crate::math::{Box3, add_up, cross, dot, flushes_subnormals, length, mul_up, sub_down};
use std::sync::atomic::Ordering;

/// The level surface of a grid's trilinear interpolant, as triangles.
///
/// **Bound.** The two-sided Hausdorff distance between the mesh and the boundary of what is inside of the interpolant, within the
/// lattice's box; *proved*, rounding included (`convert/cubes/bound.rs`). Where the interpolant runs steadily through a
/// few cells it falls with the square of the step; a cell where it does not (a thin wall, a saddle, noise) counts with its
/// diagonal.
///
/// **Mesh.** Closed and manifold always, from combinatorics alone, but for the border of the lattice where that is
/// open. One vertex for each edge of the lattice whose samples are on different sides, at least a margin from both: samples
/// that equal the level are outside and make neither flat triangles nor coinciding ones. The margin, 2⁻²⁰ of an
/// edge, is in the bound. A mirrored lattice turns the triangles around, so that the front is outside.
///
/// **Budgets.** Without one the mesh is that of the lattice, with the bound that it has. With a length, cells that the surface passes are
/// halved on the interpolant until the bound holds. A number of triangles is a limit.
///
/// **Cost.** O(samples) to compare them and O(triangles) for the rest; a bit a sample and a byte a passed cell beside input
/// and output. On all threads of the job, with the same bytes on any number.
///
/// # Errors
/// [`Failure::Refused`]: no surface, or an axis of one sample ([`Code::Empty`], with the reason); a level or transform that is not
/// finite or beyond 1e150 ([`Code::NotFinite`]); steps that are lost beside the coordinates ([`Code::BelowPrecision`]); a
/// margin outside of 2⁻³⁰ to ¼, or a budget in degrees ([`Code::Unsupported`]); a lattice too close to the eye for pixels
/// ([`Code::TooClose`]); more triangles or bytes than the
/// job allows; an environment that flushes subnormals. [`Failure::Unmet`] with the best mesh. [`Failure::Cancelled`].
///
/// ```
/// use chordal::convert::{Polygonize, grid_to_mesh};
/// use chordal::implicit::{Affine, Grid, Samples};
/// use chordal::Job;
/// // One voxel of a mask: an octahedron.
/// let mut mask = vec![0_u8; 27];
/// mask[13] = 1;
/// let grid = Grid::new([3; 3], Samples::U8(mask), Affine::IDENTITY)?;
/// let made = grid_to_mesh(&grid, &Polygonize::above(0.5), None, &Job::default()).expect("a surface");
/// assert_eq!((made.shape.positions().len(), made.shape.faces().len()), (6, 8));
/// assert!(made.bound.at_most().is_some());
/// # Ok::<(), chordal::implicit::InvalidGrid>(())
/// ```
///
/// Source: W. E. Lorensen, H. E. Cline, *Marching cubes*, 1987; W. Schroeder and others, *Flying Edges*, 2015.
pub fn grid_to_mesh(
    grid: &Grid,
    rule: &Polygonize,
    budget: Option<&Budget>,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    with_samples!(grid.samples(), values => {
        let source = Dense { values, size: grid.size(), rule: *rule };
        made(&source, grid.affine(), (rule, budget, numbers(grid.samples())), job)
    })
}

/// [`grid_to_mesh`] of samples in bricks: the same mesh, bit for bit, as from the same samples in one array.
///
/// # Errors
/// As for [`grid_to_mesh`].
pub fn sparse_grid_to_mesh(
    grid: &SparseGrid,
    rule: &Polygonize,
    budget: Option<&Budget>,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    made(&Bricks { grid, rule: *rule }, grid.affine(), (rule, budget, (grid.largest(), None)), job)
}

/// What is asked for: the rule, the budget, and what the samples are like.
type Asked<'a> = (&'a Polygonize, Option<&'a Budget>, (f64, Option<u32>));

fn made<S: Source>(
    source: &S,
    affine: &Affine,
    (rule, budget, numbers): Asked,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    check(source.size(), affine, rule)?;
    let bounds = bounds(source.size(), affine, rule);
    let length = allowed(budget, &bounds)?;
    let most = budget.and_then(|budget| budget.triangles).unwrap_or(u64::MAX);
    let wanted = Wanted { length, most, numbers };
    let mut made = job.run(|| refined(source, affine, (rule, &wanted), job))?;
    if let (Some(px), Some(most)) = (budget.and_then(|budget| budget.pixels), made.bound.at_most()) {
        made.bound.pixels = px.view.pixels_of(most, &made.shape.bounds().union(bounds));
    }
    Ok(made)
}

/// What a mesh is refined for.
struct Wanted {
    length: f64,
    /// Triangles.
    most: u64,
    numbers: (f64, Option<u32>),
}

/// The box of a lattice.
fn bounds(size: [usize; 3], affine: &Affine, rule: &Polygonize) -> Box3 {
    (0..8).fold(Box3::EMPTY, |all, corner| {
        let last = |k: usize| if corner >> k & 1 == 1 { (size[k] - 1) as f64 } else { 0.0 };
        all.with(affine.at([0, 1, 2].map(|k| rule.offset[k] as f64 + last(k))))
    })
}

/// Halves cells until the budget's length holds.
fn refined<S: Source>(
    source: &S,
    coarse: &Affine,
    (rule, wanted): (&Polygonize, &Wanted),
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let Wanted { length, most, numbers } = *wanted;
    let mut best = meshed(source, coarse, rule, (length, job))?;
    for halvings in 1..=MOST_HALVINGS {
        let triangles = best.shape.faces().len() as u64;
        if triangles > most || reached(&best) <= length {
            break;
        }
        // Halved cells have four times the triangles, or nearly.
        if 3 * triangles > most.min(job.triangle_limit) {
            break;
        }
        let finer = Finer::new(source, rule, halvings, numbers);
        let Some(affine) = finer.affine(coarse) else { break };
        let rule = Polygonize { offset: rule.offset.map(|i| i << halvings), ..*rule };
        if check(finer.size(), &affine, &rule).is_err() {
            break;
        }
        match finer_mesh(&finer, &affine, &rule, (length, job)) {
            // A cell without a steady slope keeps its diagonal, which halves with it.
            Ok(next) if reached(&next) < reached(&best) => best = next,
            Ok(_) | Err(Stopped::Refused(_)) => break,
            Err(Stopped::Cancelled) => return Err(Failure::Cancelled),
        }
    }
    let fits = best.shape.faces().len() as u64 <= most && reached(&best) <= length;
    if fits { Ok(best) } else { Err(Failure::Unmet(Box::new(best))) }
}

/// How often cells are halved at most: 4,096 for one.
const MOST_HALVINGS: u32 = 12;

fn reached(made: &Bounded<Mesh>) -> f64 {
    made.bound.at_most().unwrap_or(f64::INFINITY)
}

/// The mesh of a finer lattice. Where its values are rounded, either the proof holds for all values that they may stand for,
/// or it is under the promise that they are taken as they are.
fn finer_mesh(
    finer: &Finer<'_>,
    affine: &Affine,
    rule: &Polygonize,
    (length, job): (f64, &Job),
) -> Result<Bounded<Mesh>, Stopped> {
    let enough = enough(length, affine, rule, finer.size());
    let Marched { positions, faces, plan } = march::<f64, _>(finer, affine, rule, job)?;
    let proof = || Proof::new(finer, affine, rule, lost(affine, rule, finer.size())).with_enough(enough);
    let farthest = proof().farthest(&plan, job);
    let sure = finer.slack == 0.0 || !finer.unsure.load(Ordering::Relaxed);
    let farthest = if finer.slack == 0.0 || !sure {
        farthest
    } else {
        proof().with_slack(finer.slack).farthest(&plan, job)
    };
    if job.is_cancelled() {
        return Err(Stopped::Cancelled);
    }
    let evidence = if sure {
        Evidence::Proved
    } else {
        Evidence::ProvedIf(vec![
            "values of the interpolant between samples are taken as rounded to f64".into(),
        ])
    };
    let mesh = with_normals(Mesh::by_construction(positions, faces), finer, affine, (rule, &plan, job));
    Ok(Bounded { shape: mesh, bound: bound(farthest, evidence, (affine, rule), finer.size()) })
}

/// The largest size of a sample, and the bits of samples that are whole numbers.
#[allow(clippy::useless_conversion, reason = "one body for every type of samples")]
fn numbers(samples: &Samples) -> (f64, Option<u32>) {
    let bits = match samples {
        Samples::F32(_) | Samples::F64(_) => None,
        whole => Some(8 * whole.width() as u32),
    };
    let largest = with_samples!(samples, values => {
        values.iter().map(|v| f64::from(*v).abs()).map(|v| if v == f64::INFINITY { f64::MAX } else { v }).fold(0.0, |most, v| if v > most { v } else { most })
    });
    (largest, bits)
}

/// Triangles as plain arrays, without a bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface<P> {
    /// n × 3 coordinates.
    pub positions: Vec<[P; 3]>,
    /// m × 3 indices into the positions; counter-clockwise is the front.
    pub faces: Vec<[u32; 3]>,
}

/// The name of a vertex in the lattice of a whole volume: blocks that share samples give their common vertices the same
/// name and the same position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VertexKey {
    /// The sample at the vertex, or the lower one of its edge.
    pub lattice: [i64; 3],
    /// How often the lattice was halved.
    pub level: u8,
    /// 0, 1 and 2 on an edge along that axis, 3 at the sample itself.
    pub kind: u8,
    /// The label whose surface it is on, in volumes of labels.
    pub sheet: u32,
}

/// The surface of a grid as plain arrays of f64 or f32: what [`grid_to_mesh`] makes, without its bound.
///
/// Closed and manifold by indices, always; in f32 vertices that are closer than its last place may coincide, see
/// [`Polygonize::MARGIN_F32`].
///
/// Cost: as for [`grid_to_mesh`] without the bound.
///
/// # Errors
/// [`Stopped::Refused`] and [`Stopped::Cancelled`] as for [`grid_to_mesh`].
pub fn grid_to_triangles<P: Coordinate>(
    grid: &Grid,
    rule: &Polygonize,
    job: &Job,
) -> Result<Surface<P>, Stopped> {
    check(grid.size(), grid.affine(), rule)?;
    job.run(|| {
        with_samples!(grid.samples(), values => {
            let source = Dense { values, size: grid.size(), rule: *rule };
            let Marched { positions, faces, .. } = march::<P, _>(&source, grid.affine(), rule, job)?;
            Ok(Surface { positions, faces })
        })
    })
}

/// The names of the vertices that [`grid_to_mesh`] (without a budget) and [`grid_to_triangles`] make, in their order.
///
/// Cost: O(samples) to compare them, 40 bytes a vertex.
///
/// # Errors
/// As for [`grid_to_triangles`].
pub fn vertex_keys(grid: &Grid, rule: &Polygonize, job: &Job) -> Result<Vec<VertexKey>, Stopped> {
    check(grid.size(), grid.affine(), rule)?;
    job.run(|| {
        with_samples!(grid.samples(), values => {
            let source = Dense { values, size: grid.size(), rule: *rule };
            let plan = Plan::new(&source, rule, job)?;
            Ok(plan.for_each_vertex(job, |kind, at| VertexKey {
                lattice: [0, 1, 2].map(|k| rule.offset[k] + at[k] as i64),
                level: 0,
                kind: kind as u8,
                sheet: 0,
            }))
        })
    })
}

/// The mesh of any source, with its bound.
pub(super) fn meshed<S: Source>(
    source: &S,
    affine: &Affine,
    rule: &Polygonize,
    (length, job): (f64, &Job),
) -> Result<Bounded<Mesh>, Stopped> {
    let enough = enough(length, affine, rule, source.size());
    let Marched { positions, faces, plan } = march::<f64, S>(source, affine, rule, job)?;
    if faces.is_empty() {
        return Err(refused(Code::Empty, no_surface(source, rule, &plan)));
    }
    let farthest = Proof::new(source, affine, rule, lost(affine, rule, source.size()))
        .with_enough(enough)
        .farthest(&plan, job);
    if job.is_cancelled() {
        return Err(Stopped::Cancelled);
    }
    let mesh = with_normals(Mesh::by_construction(positions, faces), source, affine, (rule, &plan, job));
    Ok(Bounded { shape: mesh, bound: bound(farthest, Evidence::Proved, (affine, rule), source.size()) })
}

fn with_normals<S: Source>(
    mesh: Mesh,
    source: &S,
    affine: &Affine,
    (rule, plan, job): (&Polygonize, &Plan, &Job),
) -> Mesh {
    if rule.normals == Normals::None {
        return mesh;
    }
    let normals = gradient_normals(source, affine, rule, (plan, job));
    mesh.with_attribute(Attribute::vertex_normals(&normals)).expect("one normal for each vertex")
}

/// What a bound in exact coordinates is for the vertices as written.
pub(super) fn bound(
    farthest: Farthest,
    evidence: Evidence,
    (affine, rule): (&Affine, &Polygonize),
    size: [usize; 3],
) -> Bound {
    let most = add_up(farthest.most, moved(affine, rule, size));
    let least = if farthest.least < most { farthest.least } else { most };
    let mut bound = Bound::with_evidence(least, Some(most), evidence, Reference::Trilinear);
    let at = farthest.at.map(|i| i as f64 + 0.5);
    let there = affine.at([0, 1, 2].map(|k| at[k] + rule.offset[k] as f64));
    bound.at = Some(farthest.seen.unwrap_or(there));
    bound
}

/// How far the vertices that are written are from the interpolant's own zeros.
fn moved(affine: &Affine, rule: &Polygonize, size: [usize; 3]) -> f64 {
    let edge = affine.steps().map(length).into_iter().fold(0.0, |most, l| if l > most { l } else { most });
    // A place on an edge has three roundings and the margin; the rest are those of the transform.
    let moved = mul_up(mul_up(edge, 1.0 + 8.0 * f64::EPSILON), add_up(rule.margin, 4.0 * f64::EPSILON));
    add_up(moved, rounding(affine, rule, size))
}

fn lost(affine: &Affine, rule: &Polygonize, size: [usize; 3]) -> (f64, f64) {
    (moved(affine, rule, size), rounding(affine, rule, size))
}

/// Of a bound no less than this is needed, where a length is asked for.
fn enough(length: f64, affine: &Affine, rule: &Polygonize, size: [usize; 3]) -> f64 {
    let left = sub_down(length, moved(affine, rule, size));
    if left > 0.0 && length.is_finite() { left } else { 0.0 }
}

/// How far rounding moves a vertex: each coordinate is three products and three sums of a place that is rounded once, eight roundings
/// of no more than the sum of their sizes; √3 of that is below twice.
fn rounding(affine: &Affine, rule: &Polygonize, size: [usize; 3]) -> f64 {
    let far = [0, 1, 2].map(|k| {
        let (low, high) = (rule.offset[k] as f64, rule.offset[k] as f64 + size[k] as f64);
        if low.abs() > high.abs() { low.abs() } else { high.abs() }
    });
    let sizes =
        affine.rows().map(|[a, b, c, d]| a.abs() * far[0] + b.abs() * far[1] + c.abs() * far[2] + d.abs());
    let most = sizes.into_iter().fold(0.0, |most, size| if size > most { size } else { most });
    // Twice eight half units in the last place.
    8.0 * f64::EPSILON * most
}

/// Why there is no triangle.
fn no_surface<S: Source>(source: &S, rule: &Polygonize, plan: &Plan) -> String {
    let [nx, ny, nz] = source.size();
    let side = if rule.inside == super::cubes::rule::Inside::High { "above" } else { "below" };
    if plan.is_inside([0; 3]) {
        return format!(
            "every sample is {side} the level {}, and the border is open: there is no surface",
            rule.level
        );
    }
    let (mut low, mut high, mut unknown) = (f64::INFINITY, f64::NEG_INFINITY, 0_u64);
    for index in (0..nx * ny * nz).map(|at| [at % nx, at / nx % ny, at / (nx * ny)]) {
        let sample = source.at(index);
        unknown += u64::from(sample.is_nan());
        low = if sample < low { sample } else { low };
        high = if sample > high { sample } else { high };
    }
    let no_numbers = if unknown > 0 { format!(", and {unknown} are no number") } else { String::new() };
    if low > high {
        return format!("none of the {unknown} samples is a number: there is no surface");
    }
    format!(
        "no sample is {side} the level {}: they lie between {low} and {high}{no_numbers}; there is no surface",
        rule.level
    )
}

/// Numbers beyond this are refused: products of them must stay below 1e308.
const LARGEST: f64 = 1e150;

pub(super) fn check(size: [usize; 3], affine: &Affine, rule: &Polygonize) -> Result<(), Stopped> {
    if let Some(axis) = size.iter().position(|n| *n < 2) {
        let message =
            format!("index {axis} has one sample, so the lattice has no cells: pad it to give it thickness");
        return Err(refused(Code::Empty, message));
    }
    // The rounding of the farthest corner, in units of its last place, is eight times its size.
    let far = rounding(affine, rule, size) / f64::EPSILON;
    if !(rule.level.abs() <= LARGEST && far <= LARGEST) {
        return Err(refused(Code::NotFinite, format!("a level or a coordinate is beyond {LARGEST:e}")));
    }
    // Exact: powers of two.
    if !(rule.margin >= 1.0 / 1_073_741_824.0 && rule.margin <= 0.25) {
        return Err(refused(
            Code::Unsupported,
            format!("a margin of {} is not between 2^-30 and 1/4", rule.margin),
        ));
    }
    let [a, b, c] = affine.steps();
    let volume = dot(a, cross(b, c)).abs();
    let widest = [cross(b, c), cross(c, a), cross(a, b)]
        .map(length)
        .into_iter()
        .fold(0.0, |m, l| if l > m { l } else { m });
    // Half of the flattest triangle that the margin leaves is derived to be wider than an eighth of margin times width.
    let apart = 0.125 * rule.margin * (volume / widest);
    if apart.is_nan() || rounding(affine, rule, size) > apart {
        let message = "the lattice's steps are too small beside its coordinates: vertices would coincide";
        return Err(refused(Code::BelowPrecision, message.into()));
    }
    if flushes_subnormals() {
        let message = "this process flushes subnormal numbers to zero, so nothing can be proved in it";
        return Err(refused(Code::FlushesSubnormals, message.into()));
    }
    Ok(())
}

/// The length that a budget allows anywhere in the box; infinite where it says none.
fn allowed(budget: Option<&Budget>, bounds: &Box3) -> Result<f64, Failure<Mesh>> {
    let Some(budget) = budget else { return Ok(f64::INFINITY) };
    if budget.angle_deg.is_some() {
        return Err(Failure::refused(Code::Unsupported, "an angle is no budget for volumes in this version"));
    }
    let length = budget.length.map_or(f64::INFINITY, Tolerance::get);
    let Some(px) = &budget.pixels else { return Ok(length) };
    let seen = length_on(bounds, px)?;
    Ok(if seen < length { seen } else { length })
}
