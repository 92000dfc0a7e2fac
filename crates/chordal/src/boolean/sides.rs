//! Whether points beside the surface of a combined solid are on the side where the operands say they are.
use super::BooleanOp;
use super::operand::Operand;
use crate::budget::{Job, JobError, par_map};
use crate::explicit::{Bvh, Enclosure, Mesh, face_normal};
use crate::math::greater;

/// What the comparison found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SideVerdict {
    /// All compared points are where they should be, and the surface is closed.
    Agrees { n_points: u64 },
    /// This one is not, or the surface is not closed.
    Wrong { at: [f64; 3] },
}

/// The most faces of the result, and of all operands, beside which sides are compared; a decision: a tenth of
/// a second.
const MOST_FACES: usize = 512;

/// Compares winding numbers at points that are farther than `off` from all operands. There the result's are
/// constant as far as no triangle of an operand comes within `off`, since all of its triangles are within
/// `off` of those.
pub(super) fn compare_sides(
    mesh: &Mesh,
    off: f64,
    (operands, ops): (&[Operand], &[BooleanOp]),
    job: &Job,
) -> Result<SideVerdict, JobError> {
    let bvh = Bvh::build(mesh, job)?;
    let enclosure = Enclosure::new(mesh, &bvh);
    if !mesh.faces().is_empty() && !enclosure.is_closed() {
        return Ok(SideVerdict::Wrong { at: mesh.positions()[0] });
    }
    let n_operand_faces: usize = operands.iter().map(|operand| operand.faces.len()).sum();
    let mut triangles = spread(mesh.faces().len()).map(|face| mesh.corners(face)).collect::<Vec<_>>();
    let mut numbers = spread(n_operand_faces).peekable();
    let mut first = 0;
    for operand in operands {
        while let Some(face) = numbers.next_if(|face| face - first < operand.faces.len()) {
            triangles.push(operand.faces[face - first].map(|row| operand.points[row as usize]));
        }
        first += operand.faces.len();
    }
    let compared = par_map(job, &triangles, |_, corners| {
        if job.is_cancelled() {
            return [None; 2];
        }
        beside(*corners, off, operands).map(|p| {
            let p = p?;
            let mut inside = operands.iter().map(|operand| operand.contains(p));
            let first = inside.next()??;
            let mut ops = ops.iter();
            let wanted = inside.try_fold(first, |sum, own| Some(ops.next()?.holds(sum, own?)))?;
            let winding = enclosure.inside(p).winding.value;
            // The boundary of a solid winds once around its points, and not at all around others.
            Some((p, winding == if wanted { 1.0 } else { 0.0 }))
        })
    });
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    let mut n_points = 0;
    for (p, is_right) in compared.into_iter().flatten().flatten() {
        if !is_right {
            return Ok(SideVerdict::Wrong { at: p });
        }
        n_points += 1;
    }
    // Without a point nothing is known, unless there was nothing to combine.
    if n_points == 0 && !(n_operand_faces == 0 && mesh.faces().is_empty()) {
        return Ok(SideVerdict::Wrong { at: mesh.positions().first().copied().unwrap_or_default() });
    }
    Ok(SideVerdict::Agrees { n_points })
}

/// Numbers of `n` faces, evenly spread.
fn spread(n: usize) -> impl Iterator<Item = usize> {
    let most = n.min(MOST_FACES);
    (0..most).map(move |k| k * n / most)
}

/// Points on both sides of a triangle's middle that are farther than `off` from all operands, as near as a few
/// tries find them.
fn beside(corners: [[f64; 3]; 3], off: f64, operands: &[Operand]) -> [Option<[f64; 3]>; 2] {
    let Some(normal) = face_normal(corners) else { return [None; 2] };
    let [a, b, c] = corners;
    let middle: [f64; 3] = std::array::from_fn(|k| a[k] / 3.0 + b[k] / 3.0 + c[k] / 3.0);
    let length =
        |p: [f64; 3], q: [f64; 3]| (0..3).fold(0.0, |most: f64, k| greater((p[k] - q[k]).abs(), most));
    let size = [length(a, b), length(b, c), length(c, a)].into_iter().fold(0.0, |m, x| greater(x, m));
    // From a thousandth of the triangle's size on, thirty times as far with each try.
    let nearest = greater(4.0 * off, size / 1024.0);
    [1.0, -1.0].map(|side| {
        [1.0, 32.0, 1.0 / 32.0].into_iter().find_map(|factor| {
            let height = side * nearest * factor;
            let p = std::array::from_fn(|k| middle[k] + height * normal[k]);
            let is_clear = operands.iter().all(|operand| operand.distance_down(p) > off);
            is_clear.then_some(p)
        })
    })
}
