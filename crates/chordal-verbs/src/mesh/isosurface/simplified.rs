//! The isosurface of a volume, or of each of its labels, with as few triangles as a budget allows: polygonized within a
//! share of the length, then simplified within the rest.
use crate::MeshFailure;
use crate::simplify::simplify_mesh;
use chordal::budget::advice::{Message, Setting};
use chordal::budget::{Bound, Budget, Failure, JobError, Reference, RefusalCode, Tolerance};
use chordal::check;
use chordal::convert::{self, Polygonize};
use chordal::explicit::Topology;
use chordal::implicit::Grid;
use chordal::lod::count::Effort;
use chordal::lod::simplify_conforming;
use chordal::math::{Box3, greater, sub_down, sub_up};
use chordal::{Bounded, Job, Mesh};

/// The shares of a length within which cells are halved, one after the other; the rest is for collapses. Chosen: each
/// halving makes four times the triangles, so that it gets most of the length; smaller shares leave more for collapses, and
/// often fewer triangles in the end.
const SHARES: [f64; 3] = [0.75, 0.375, 0.1875];

/// The most triangles of cells for which a smaller share is tried. Chosen: the smaller share has up to sixteen times as many
/// triangles, of 15 µs each.
const FEW: usize = 20_000;

/// A mesh, with a note on it.
pub(crate) type MeshWithNote = (Bounded<Mesh>, Option<Message>);

/// The memory of simplification for each triangle that it starts with. Measured: 700 to 1,050 bytes.
pub(crate) const BYTES_OF_TRIANGLE: u64 = 1050;

/// A job with at most as many triangles as can be simplified within its memory.
pub(crate) fn job_to_simplify(job: &Job) -> Job {
    let mut limited = job.clone();
    limited.triangle_limit = job.triangle_limit.min(job.memory_limit / BYTES_OF_TRIANGLE);
    limited
}

/// The isosurface within a budget, with the bounds of both steps added, and a note on each step. `effort` applies only to a
/// budget of a count alone.
///
/// # Errors
/// As for [`convert::grid_to_mesh`].
pub(crate) fn simplified_isosurface(
    grid: &Grid,
    rule: &Polygonize,
    (budget, bounds, effort): (&Budget, &Box3, Effort),
    job: &Job,
) -> Result<MeshWithNote, Failure<Mesh>> {
    let length = budget.length_in(bounds).unwrap_or(0.0);
    let within = |length: Tolerance| Budget { length: Some(length), pixels: None, ..*budget };
    // Compared as a pair: what the bound exceeds the length by comes first, and among equals fewer triangles.
    let excess = |mesh: &Bounded<Mesh>| {
        let excess = mesh.bound.at_most().map_or(f64::INFINITY, |most| greater(sub_up(most, length), 0.0));
        (excess, mesh.shape.faces().len())
    };
    let mut best: Option<(Bounded<Mesh>, Option<Message>)> = None;
    for share in SHARES {
        let cells = match Tolerance::new(share * length) {
            Ok(share) => Budget { triangles: None, ..within(share) },
            Err(_) if length == f64::INFINITY => Budget { triangles: None, ..*budget },
            // The polygonizer refuses a length of which nothing is left, and gives the reason.
            Err(_) => *budget,
        };
        let fine = match (polygonized(grid, rule, &cells, job), &best) {
            (Ok(fine), _) => fine,
            // The finer cells of a smaller share may be more than the job allows: the mesh of the larger share
            // stands.
            (Err(JobError::Refused(_)), Some(_)) => break,
            (Err(stopped), _) => return Err(stopped.into()),
        };
        let n_cells = fine.shape.faces().len();
        let is_reached = fine.bound.at_most().is_some_and(|most| most <= share * length);
        let simplified_mesh = simplified(fine, (budget, length, effort), job)?;
        if best.as_ref().is_none_or(|(best, _)| excess(&simplified_mesh.0) < excess(best)) {
            best = Some(simplified_mesh);
        }
        // Finer cells are out of reach, or too many to be tried for fewer triangles.
        if !is_reached || n_cells > FEW || length == f64::INFINITY {
            break;
        }
    }
    best.ok_or_else(|| Failure::refused(RefusalCode::Empty, "there is no surface"))
}

/// The triangles of cells, as many as can be simplified; if the lattice's own triangles are more, these.
fn polygonized(grid: &Grid, rule: &Polygonize, cells: &Budget, job: &Job) -> Result<Bounded<Mesh>, JobError> {
    let build = |job: &Job| convert::grid_to_mesh(grid, rule, Some(cells), job).or_else(Failure::best_effort);
    match build(&job_to_simplify(job)) {
        Err(JobError::Refused(refusal)) if refusal.code == RefusalCode::TooManyTriangles => build(job),
        build => build,
    }
}

/// Simplifies triangles within the part of a budget that their own bound leaves; `length` is the budget's length. Returns a
/// note on both steps. `effort` applies only to a budget of a count alone.
///
/// # Errors
/// If the job is cancelled.
pub(crate) fn simplified(
    fine: Bounded<Mesh>,
    (budget, length, effort): (&Budget, f64, Effort),
    job: &Job,
) -> Result<MeshWithNote, Failure<Mesh>> {
    let within = |length: Tolerance| Budget { length: Some(length), pixels: None, ..*budget };
    // An unlimited length stays unlimited, instead of becoming the largest number.
    let remaining = if length == f64::INFINITY {
        *budget
    } else {
        match Tolerance::new(sub_down(length, fine.bound.at_most().unwrap_or(f64::INFINITY))) {
            Ok(length) => within(length),
            Err(_) => return Ok((fine, None)),
        }
    };
    let n_faces = fine.shape.faces().len() as u64;
    let bytes = n_faces.saturating_mul(BYTES_OF_TRIANGLE);
    if bytes > job.memory_limit {
        let start = format!(
            "{n_faces} triangles were not simplified, which takes {bytes} bytes: the limit is {}; ",
            job.memory_limit
        );
        return Ok((fine, Some(Message::from(start).setting(Setting::MaxMemory).words(" raises it"))));
    }
    if remaining.length.is_none() && remaining.triangles.is_none_or(|most| most >= n_faces) {
        return Ok((fine, None));
    }
    let coarse = simplify_mesh(&fine.shape, (&remaining, effort), Topology::Indices, job);
    match coarse.or_else(Failure::best_effort) {
        Ok(coarse) => {
            let note = two_steps(&fine, &coarse.bound, coarse.shape.mesh.faces().len());
            let bound = fine.bound.then(&coarse.bound);
            Ok((Bounded { shape: coarse.shape.mesh, bound }, Some(note)))
        }
        Err(JobError::Cancelled) => Err(Failure::Cancelled),
        // If the triangles cannot be simplified, they stay, with their own bound.
        Err(JobError::Refused(refusal)) => {
            let note = Message::from("the triangles were not simplified: ").message(&refusal.message);
            Ok((fine, Some(note)))
        }
    }
}

/// As [`simplified`], for triangles that do not cross each other, and must not afterwards, since collapses only consider
/// distances. If some cross, tries half of the length, and so on. Halving makes results comparable: a budget of twice the
/// length never gives more triangles. If all attempts fail, the triangles stay as they are.
///
/// # Errors
/// If the job is cancelled, or has no memory to search for crossings.
pub(crate) fn simplified_without_crossings(
    fine: Bounded<Mesh>,
    (budget, length, effort): (&Budget, f64, Effort),
    job: &Job,
) -> Result<MeshWithNote, Failure<Mesh>> {
    let mut length = length;
    while fine.bound.at_most().is_some_and(|most| most < length) {
        let coarse = simplified(fine.clone(), (budget, length, effort), job)?;
        if check::self_intersections(&coarse.0.shape, job)?.count == 0 {
            return Ok(coarse);
        }
        length *= 0.5;
    }
    Ok((fine, None))
}

/// The meshes of labels within a budget, with the bounds of both steps added, and the same triangles on both sides of a
/// border between two labels. Cells are not halved: if the length has no room for collapses, the meshes stay as they are.
///
/// # Errors
/// If the job is cancelled.
pub(crate) fn simplified_labels(
    meshes: Vec<Bounded<Mesh>>,
    (budget, bounds): (&Budget, &Box3),
    job: &Job,
) -> Result<(Vec<Bounded<Mesh>>, Option<Message>), MeshFailure> {
    let length = budget.length_in(bounds).unwrap_or(0.0);
    let cell_bound = largest(meshes.iter().map(|mesh| &mesh.bound));
    // An unlimited length stays unlimited, instead of becoming the largest number.
    let left = if length == f64::INFINITY { length } else { sub_down(length, cell_bound) };
    let remaining = match Tolerance::new(left) {
        Ok(left) => Budget { length: Some(left), pixels: None, ..*budget },
        Err(_) if left == f64::INFINITY => Budget { pixels: None, ..*budget },
        Err(_) => return Ok((meshes, None)),
    };
    let count = |meshes: &[Mesh]| meshes.iter().map(|mesh| mesh.faces().len()).sum::<usize>();
    let (shapes, bounds): (Vec<Mesh>, Vec<Bound>) =
        meshes.into_iter().map(|Bounded { shape, bound }| (shape, bound)).unzip();
    let before = count(&shapes);
    if remaining.length.is_none() && remaining.triangles.is_none_or(|most| most >= before as u64) {
        let meshes = shapes.into_iter().zip(bounds).map(|(shape, bound)| Bounded { shape, bound });
        return Ok((meshes.collect(), None));
    }
    match simplify_conforming(&shapes, &remaining, job).or_else(Failure::best_effort) {
        Ok(Bounded { shape: coarse, .. }) => {
            let lost = largest(coarse.iter().map(|mesh| &mesh.bound));
            let after: usize = coarse.iter().map(|mesh| mesh.shape.faces().len()).sum();
            let note = format!(
                "{before} triangles within {cell_bound:.3e} of the interpolants of labels were simplified to {after} within \
                 {lost:.3e} of them, the same on both sides of a border between two labels"
            );
            let both = |(cells, coarse): (Bound, Bounded<Mesh>)| {
                let bound = cells.then(&coarse.bound);
                Bounded { shape: coarse.shape, bound }
            };
            Ok((bounds.into_iter().zip(coarse).map(both).collect(), Some(note.into())))
        }
        Err(JobError::Cancelled) => Err(MeshFailure::Cancelled),
        // If the triangles cannot be simplified, they stay, with their own bound.
        Err(JobError::Refused(refusal)) => {
            let note = Message::from("the triangles were not simplified: ").message(&refusal.message);
            let meshes = shapes.into_iter().zip(bounds).map(|(shape, bound)| Bounded { shape, bound });
            Ok((meshes.collect(), Some(note)))
        }
    }
}

/// The largest upper end.
fn largest<'a>(bounds: impl Iterator<Item = &'a Bound>) -> f64 {
    bounds.map(|bound| bound.at_most().unwrap_or(f64::INFINITY)).fold(0.0, |most, x| greater(x, most))
}

/// A note on the triangles and the error of both steps.
fn two_steps(fine: &Bounded<Mesh>, simplified: &Bound, triangles: usize) -> Message {
    let length = |bound: &Bound| {
        bound.at_most().map_or_else(|| "no known length".to_owned(), |most| format!("{most:.3e}"))
    };
    let (before, lost) = (fine.shape.faces().len(), length(simplified));
    let of_cells = length(&fine.bound);
    let surface = if fine.bound.reference == Reference::Field { "surface" } else { "interpolant" };
    format!("{before} triangles within {of_cells} of the {surface} were simplified to {triangles} within {lost} of them")
        .into()
}
