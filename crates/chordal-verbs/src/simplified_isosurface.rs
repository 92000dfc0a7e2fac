//! The isosurface of a volume, or those of its labels, with as few triangles as a budget allows: polygonized within a
//! share of the length, then simplified within what the polygonizer left of it.
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

/// The shares of a length within which cells are halved, one after the other; what they leave of it is for collapses. Chosen:
/// each halving makes four times the triangles, so that most of the length is for it; the triangles of finer cells leave
/// more of it, and often fewer triangles in the end.
const SHARES: [f64; 3] = [0.75, 0.375, 0.1875];

/// The most triangles of cells after which a smaller share is tried. Chosen: that has up to sixteen times as many, of 15 µs
/// each.
const FEW: usize = 20_000;

/// A mesh, and what is to be said of it.
pub(crate) type MadeMesh = (Bounded<Mesh>, Option<Message>);

/// What simplification takes for each triangle that it begins with. Measured: 700 to 1,050 bytes.
pub(crate) const BYTES_OF_TRIANGLE: u64 = 1050;

/// A job with at most as many triangles as can be simplified within its memory.
pub(crate) fn room_to_simplify(job: &Job) -> Job {
    let mut with_room = job.clone();
    with_room.triangle_limit = job.triangle_limit.min(job.memory_limit / BYTES_OF_TRIANGLE);
    with_room
}

/// The isosurface within a budget, with the bounds of both steps added, and a sentence that tells them apart. `effort` is for
/// a count alone.
///
/// # Errors
/// As for [`convert::grid_to_mesh`].
pub(crate) fn simplified_isosurface(
    grid: &Grid,
    rule: &Polygonize,
    (budget, bounds, effort): (&Budget, &Box3, Effort),
    job: &Job,
) -> Result<MadeMesh, Failure<Mesh>> {
    let length = budget.length_in(bounds).unwrap_or(0.0);
    let within = |length: Tolerance| Budget { length: Some(length), pixels: None, ..*budget };
    let excess = |made: &Bounded<Mesh>| {
        let over = made.bound.at_most().map_or(f64::INFINITY, |most| greater(sub_up(most, length), 0.0));
        (over, made.shape.faces().len())
    };
    let mut best: Option<(Bounded<Mesh>, Option<Message>)> = None;
    for share in SHARES {
        let cells = match Tolerance::new(share * length) {
            Ok(share) => Budget { triangles: None, ..within(share) },
            Err(_) if length == f64::INFINITY => Budget { triangles: None, ..*budget },
            // The polygonizer refuses what no length is left of, and says where.
            Err(_) => *budget,
        };
        let fine = match (polygonized(grid, rule, &cells, job), &best) {
            (Ok(fine), _) => fine,
            (Err(JobError::Refused(_)), Some(_)) => break,
            (Err(stopped), _) => return Err(stopped.into()),
        };
        let n_cells = fine.shape.faces().len();
        let is_reached = fine.bound.at_most().is_some_and(|most| most <= share * length);
        let made = simplified(fine, (budget, length, effort), job)?;
        if best.as_ref().is_none_or(|(best, _)| excess(&made.0) < excess(best)) {
            best = Some(made);
        }
        // Finer cells than these are out of reach, or too many to be tried for fewer triangles.
        if !is_reached || n_cells > FEW || length == f64::INFINITY {
            break;
        }
    }
    best.ok_or_else(|| Failure::refused(RefusalCode::Empty, "there is no surface"))
}

/// The triangles of cells, as many as can be simplified; where the lattice's own are more, these.
fn polygonized(grid: &Grid, rule: &Polygonize, cells: &Budget, job: &Job) -> Result<Bounded<Mesh>, JobError> {
    let made = |job: &Job| convert::grid_to_mesh(grid, rule, Some(cells), job).or_else(Failure::best_effort);
    match made(&room_to_simplify(job)) {
        Err(JobError::Refused(refusal)) if refusal.code == RefusalCode::TooManyTriangles => made(job),
        made => made,
    }
}

/// Triangles within what their own bound leaves of a budget, whose length is `length`, and a sentence that tells the two
/// steps apart. `effort` is for a count alone.
///
/// # Errors
/// When the job is cancelled.
pub(crate) fn simplified(
    fine: Bounded<Mesh>,
    (budget, length, effort): (&Budget, f64, Effort),
    job: &Job,
) -> Result<MadeMesh, Failure<Mesh>> {
    let within = |length: Tolerance| Budget { length: Some(length), pixels: None, ..*budget };
    // Of no limit an unlimited one is left, and not the largest number.
    let rest = if length == f64::INFINITY {
        *budget
    } else {
        match Tolerance::new(sub_down(length, fine.bound.at_most().unwrap_or(f64::INFINITY))) {
            Ok(left) => within(left),
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
    if rest.length.is_none() && rest.triangles.is_none_or(|most| most >= n_faces) {
        return Ok((fine, None));
    }
    let made = simplify_mesh(&fine.shape, (&rest, effort), Topology::Indices, job);
    match made.or_else(Failure::best_effort) {
        Ok(made) => {
            let words = two_steps(&fine, &made.bound, made.shape.mesh.faces().len());
            let bound = fine.bound.then(&made.bound);
            Ok((Bounded { shape: made.shape.mesh, bound }, Some(words)))
        }
        Err(JobError::Cancelled) => Err(Failure::Cancelled),
        // What cannot be simplified stays as it is, with its own bound.
        Err(JobError::Refused(why)) => {
            let words = Message::from("the triangles were not simplified: ").message(&why.message);
            Ok((fine, Some(words)))
        }
    }
}

/// The same of triangles that do not cross each other, and must not afterwards; collapses look at distances alone. Where some
/// cross, half of the length counts, and so on, so that what is met within a length is met within twice as much with no more
/// triangles; at last they stay as they are.
///
/// # Errors
/// When the job is cancelled, or has no memory to look for crossings.
pub(crate) fn simplified_without_crossings(
    fine: Bounded<Mesh>,
    (budget, length, effort): (&Budget, f64, Effort),
    job: &Job,
) -> Result<MadeMesh, Failure<Mesh>> {
    let mut length = length;
    while fine.bound.at_most().is_some_and(|most| most < length) {
        let made = simplified(fine.clone(), (budget, length, effort), job)?;
        if check::self_intersections(&made.0.shape, job)?.count == 0 {
            return Ok(made);
        }
        length *= 0.5;
    }
    Ok((fine, None))
}

/// The meshes of labels within a budget, with the bounds of both steps added, and the same triangles on both sides of a
/// border between two labels. Cells are not halved: what the length does not have room for is left as it is.
///
/// # Errors
/// When the job is cancelled.
pub(crate) fn simplified_labels(
    meshes: Vec<Bounded<Mesh>>,
    (budget, bounds): (&Budget, &Box3),
    job: &Job,
) -> Result<(Vec<Bounded<Mesh>>, Option<Message>), MeshFailure> {
    let length = budget.length_in(bounds).unwrap_or(0.0);
    let of_cells = largest(meshes.iter().map(|made| &made.bound));
    // Of no limit an unlimited one is left, and not the largest number.
    let left = if length == f64::INFINITY { length } else { sub_down(length, of_cells) };
    let rest = match Tolerance::new(left) {
        Ok(left) => Budget { length: Some(left), pixels: None, ..*budget },
        Err(_) if left == f64::INFINITY => Budget { pixels: None, ..*budget },
        Err(_) => return Ok((meshes, None)),
    };
    let count = |meshes: &[Mesh]| meshes.iter().map(|mesh| mesh.faces().len()).sum::<usize>();
    let (shapes, bounds): (Vec<Mesh>, Vec<Bound>) =
        meshes.into_iter().map(|Bounded { shape, bound }| (shape, bound)).unzip();
    let before = count(&shapes);
    if rest.length.is_none() && rest.triangles.is_none_or(|most| most >= before as u64) {
        let meshes = shapes.into_iter().zip(bounds).map(|(shape, bound)| Bounded { shape, bound });
        return Ok((meshes.collect(), None));
    }
    match simplify_conforming(&shapes, &rest, job).or_else(Failure::best_effort) {
        Ok(Bounded { shape: made, .. }) => {
            let lost = largest(made.iter().map(|made| &made.bound));
            let after: usize = made.iter().map(|made| made.shape.faces().len()).sum();
            let words = format!(
                "{before} triangles within {of_cells:.3e} of the interpolants of labels were simplified to {after} within \
                 {lost:.3e} of them, the same on both sides of a border between two labels"
            );
            let both = |(of_cells, made): (Bound, Bounded<Mesh>)| {
                let bound = of_cells.then(&made.bound);
                Bounded { shape: made.shape, bound }
            };
            Ok((bounds.into_iter().zip(made).map(both).collect(), Some(words.into())))
        }
        Err(JobError::Cancelled) => Err(MeshFailure::Cancelled),
        // What cannot be simplified stays as it is, with its own bound.
        Err(JobError::Refused(why)) => {
            let words = Message::from("the triangles were not simplified: ").message(&why.message);
            let meshes = shapes.into_iter().zip(bounds).map(|(shape, bound)| Bounded { shape, bound });
            Ok((meshes.collect(), Some(words)))
        }
    }
}

/// The largest upper end.
fn largest<'a>(bounds: impl Iterator<Item = &'a Bound>) -> f64 {
    bounds.map(|bound| bound.at_most().unwrap_or(f64::INFINITY)).fold(0.0, |most, x| greater(x, most))
}

/// What each of both steps made and cost.
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
