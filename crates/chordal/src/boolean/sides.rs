//! Whether points beside the surface of a combined solid are on the side that the operands define.
use super::BooleanOp;
use super::operand::Operand;
use super::point_survey::{PointSurvey, PointWinding};
use crate::budget::{Job, JobError};
use crate::explicit::{Mesh, face_normal, is_closed};
use crate::math::greater;

/// The result of the comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SideVerdict {
    /// All compared points are on the right side, and the surface is closed.
    Agrees { n_points: u64 },
    /// This point is on the wrong side, or the surface is not closed.
    Wrong { at: [f64; 3] },
}

/// The most faces of the result, and of all operands, beside which sides are compared. Chosen: it takes a
/// hundredth of a second.
const MOST_FACES: usize = 512;

/// The distances beside a face at which a point is tried, in units of the least useful distance.
const TRIES: [f64; 3] = [1.0, 32.0, 1.0 / 32.0];

/// Compares winding numbers at points that are farther than `length` from the triangles of all operands. All
/// triangles of the result are within `length` of these. So its winding number is constant in every connected
/// region that stays farther than `length` from them, and one point stands for its region.
pub(super) fn compare_sides(
    mesh: &Mesh,
    length: f64,
    (operands, ops): (&[Operand], &[BooleanOp]),
    job: &Job,
) -> Result<SideVerdict, JobError> {
    if !mesh.faces().is_empty() && !is_closed(mesh) {
        return Ok(SideVerdict::Wrong { at: mesh.positions()[0] });
    }
    let mut open = places(mesh, operands);
    let mut n_points = 0;
    for factor in TRIES {
        let points: Vec<[f64; 3]> = open.iter().map(|place| place.beside(length, factor)).collect();
        let survey = PointSurvey::new(&points);
        let around: Vec<Vec<PointWinding>> = operands
            .iter()
            .map(|operand| survey.windings(operand.faces.len(), |face| operand.corners(face), length, job))
            .collect();
        let of_result = survey.windings(mesh.faces().len(), |face| mesh.corners(face), 0.0, job);
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let mut unresolved = Vec::new();
        for (number, place) in open.into_iter().enumerate() {
            if around.iter().any(|operand| operand[number].is_near) {
                // This point tells nothing, but another distance from the same face may.
                unresolved.push(place);
                continue;
            }
            // More than one turn is inside too: an operand may overlap itself.
            let mut inside = around.iter().map(|operand| operand[number].number > 0);
            let first = inside.next().unwrap_or(false);
            let expected = inside.zip(ops).fold(first, |sum, (is_inside, op)| op.holds(sum, is_inside));
            // The boundary of a solid winds once around its points, and not at all around others.
            if of_result[number].number != i32::from(expected) {
                return Ok(SideVerdict::Wrong { at: points[number] });
            }
            n_points += 1;
        }
        open = unresolved;
    }
    // Without any point nothing is known, unless there was nothing to combine.
    let is_nothing = mesh.faces().is_empty() && operands.iter().all(|operand| operand.faces.is_empty());
    if n_points == 0 && !is_nothing {
        return Ok(SideVerdict::Wrong { at: mesh.positions().first().copied().unwrap_or_default() });
    }
    Ok(SideVerdict::Agrees { n_points })
}

/// One side of a triangle.
struct SidePlace {
    middle: [f64; 3],
    /// Of length 1, away from the triangle.
    away: [f64; 3],
    size: f64,
}

impl SidePlace {
    /// A point beside the middle, at least a thousandth of the triangle's size away.
    fn beside(&self, length: f64, factor: f64) -> [f64; 3] {
        let height = factor * greater(4.0 * length, self.size / 1024.0);
        std::array::from_fn(|k| self.middle[k] + height * self.away[k])
    }
}

/// Both sides of triangles of the result and of all operands, evenly spread.
fn places(mesh: &Mesh, operands: &[Operand]) -> Vec<SidePlace> {
    let mut sides: Vec<SidePlace> =
        spread(mesh.faces().len()).flat_map(|face| sides_of(mesh.corners(face))).flatten().collect();
    let n_faces: usize = operands.iter().map(|operand| operand.faces.len()).sum();
    // Faces are numbered through all operands; `first` is the number of this operand's first face.
    let mut numbers = spread(n_faces).peekable();
    let mut first = 0;
    for operand in operands {
        while let Some(face) = numbers.next_if(|face| face - first < operand.faces.len()) {
            sides.extend(sides_of(operand.corners(face - first)).into_iter().flatten());
        }
        first += operand.faces.len();
    }
    sides
}

/// Numbers of `n` faces, evenly spread.
fn spread(n: usize) -> impl Iterator<Item = usize> {
    let most = n.min(MOST_FACES);
    (0..most).map(move |k| k * n / most)
}

fn sides_of(corners: [[f64; 3]; 3]) -> [Option<SidePlace>; 2] {
    let Some(normal) = face_normal(corners) else { return [None, None] };
    let [a, b, c] = corners;
    let middle: [f64; 3] = std::array::from_fn(|k| a[k] / 3.0 + b[k] / 3.0 + c[k] / 3.0);
    let length =
        |p: [f64; 3], q: [f64; 3]| (0..3).fold(0.0, |most: f64, k| greater((p[k] - q[k]).abs(), most));
    let size = [length(a, b), length(b, c), length(c, a)].into_iter().fold(0.0, |m, x| greater(x, m));
    [1.0, -1.0].map(|side| Some(SidePlace { middle, away: normal.map(|x| side * x), size }))
}
