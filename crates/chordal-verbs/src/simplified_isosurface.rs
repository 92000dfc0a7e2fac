//! The isosurface of a volume, or those of its labels, with as few triangles as a budget allows: polygonized within a
//! share of the length, then simplified within what the polygonizer left of it.
use crate::MeshFailure;
use crate::simplify::simplify_mesh;
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Budget, Failure, JobError, Reference, Tolerance};
use chordal::convert::{self, Polygonize};
use chordal::explicit::Topology;
use chordal::implicit::Grid;
use chordal::lod::count::Effort;
use chordal::lod::simplify_conforming;
use chordal::math::{Box3, greater, sub_down};
use chordal::{Bounded, Job, Mesh};

/// The share of a length within which cells are halved; what they leave of it is for collapses. Chosen: each halving makes
/// four times the triangles, so that most of the length is for it.
const SHARE: f64 = 0.75;

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
) -> Result<(Bounded<Mesh>, Option<Message>), Failure<Mesh>> {
    let length = budget.length_in(bounds).unwrap_or(0.0);
    let within = |length: Tolerance| Budget { length: Some(length), pixels: None, ..*budget };
    let cells = match Tolerance::new(SHARE * length) {
        Ok(share) => Budget { triangles: None, ..within(share) },
        Err(_) if length == f64::INFINITY => Budget { triangles: None, ..*budget },
        // The polygonizer refuses what no length is left of, and says where.
        Err(_) => *budget,
    };
    let fine = convert::grid_to_mesh(grid, rule, Some(&cells), job).or_else(Failure::best_effort)?;
    simplified(fine, (budget, length, effort), job)
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
) -> Result<(Bounded<Mesh>, Option<Message>), Failure<Mesh>> {
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
