//! The isosurface of a volume with as few triangles as a budget allows: polygonized within a share of the length,
//! then simplified within what the polygonizer left of it.
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Budget, Failure, JobError, Tolerance};
use chordal::convert::{self, Polygonize};
use chordal::explicit::Topology;
use chordal::implicit::Grid;
use chordal::lod::simplify;
use chordal::math::{Box3, sub_down};
use chordal::{Bounded, Job, Mesh};

/// The share of a length within which cells are halved; what they leave of it is for collapses. Chosen: each halving makes
/// four times the triangles, so that most of the length is for it.
const SHARE: f64 = 0.75;

/// The isosurface within a budget, with the bounds of both steps added, and a sentence that tells them apart.
///
/// # Errors
/// As for [`convert::grid_to_mesh`].
pub(crate) fn simplified_isosurface(
    grid: &Grid,
    rule: &Polygonize,
    (budget, bounds): (&Budget, &Box3),
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
    match simplify(&fine.shape, &rest, Topology::Indices, job).or_else(Failure::best_effort) {
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

/// What each of both steps made and cost.
fn two_steps(fine: &Bounded<Mesh>, simplified: &Bound, triangles: usize) -> Message {
    let length = |bound: &Bound| {
        bound.at_most().map_or_else(|| "no known length".to_owned(), |most| format!("{most:.3e}"))
    };
    let (before, lost) = (fine.shape.faces().len(), length(simplified));
    let of_cells = length(&fine.bound);
    format!("{before} triangles within {of_cells} of the interpolant were simplified to {triangles} within {lost} of them")
        .into()
}
