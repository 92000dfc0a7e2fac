//! The deviation of a control cage's polygons from its limit surface.
use super::loop_deviation::{self, MOST_PIECES, is_close_enough};
use crate::budget::{Bound, Job, Reference, par_map};
use crate::explicit::cage::limit::{ExtraordinaryQuad, LimitPatches, QuadPatchTree};
use crate::explicit::{Cage, InvalidCage, LimitSheet, Patch};
use crate::math::{PriorityItem, branch_and_bound, greater};
use glam::DVec3;
use std::cell::Cell;
use std::collections::BinaryHeap;

/// Bounds the distance of the polygons of a cage from its limit surface.
/// A triangle of Loop's scheme is flat. A quad is the bilinear surface between its corners. Any other polygon
/// consists of such quads, one for each corner, with the midpoints of its edges and its centre.
/// **Bound:** the two-sided Hausdorff distance is at most this, *proved*, rounding included. Each point of a
/// face is paired with the limit surface's point at the same parameters, and their difference is bounded by
/// its control points. It is subdivided until the bound is within a tenth of the least possible value, or
/// down to rounding. `at_least` is 0.
///
/// *Cost.* Some microseconds a face, on all threads of the job; about a millisecond beside an irregular
/// vertex with few edges, more beside one with many.
///
/// # Errors
/// [`InvalidCage::NotFinite`] if coordinates or their squares overflow.
///
/// ```
/// use chordal::{Job, check, explicit::Cage};
/// let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -1.0 } else { 1.0 });
/// let sides: [&[u32]; 6] = [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
/// let cube = Cage::new((0..8).map(corner).collect(), sides)?;
/// let far = |rounds: u32| check::limit_deviation(&cube.refined_times(rounds)?, &Job::default()).map(|b| b.at_most().unwrap());
/// // A corner of the cube is half of its diagonal away from its limit; every round leaves a quarter of that.
/// assert!(far(0)? >= 0.866 && far(0)? < 0.96);
/// assert!(far(3)? < 0.3 * far(2)?);
/// # Ok::<(), chordal::explicit::InvalidCage>(())
/// ```
pub fn limit_deviation(cage: &Cage, job: &Job) -> Result<Bound, InvalidCage> {
    let sheets = sheet_deviations(cage, |_| true, job)?;
    let most = sheets.into_iter().flatten().fold(0.0, |most, distance| greater(distance, most));
    Ok(Bound::proved(0.0, most, Reference::LimitSurface))
}

/// The same for each sheet, in order; `None` for sheets that `is_asked` rejects.
pub(super) fn sheet_deviations(
    cage: &Cage,
    is_asked: impl Fn(&LimitSheet) -> bool + Sync,
    job: &Job,
) -> Result<Vec<Option<f64>>, InvalidCage> {
    let limit = cage.limit()?;
    if let Some(row) = cage.positions().iter().position(|p| p.iter().any(|x| x.abs() > LARGEST)) {
        return Err(InvalidCage::NotFinite { row });
    }
    let numbers: Vec<usize> = (0..limit.n_sheets()).collect();
    let of_sheet = |sheet: usize| {
        let (face, corner) = limit.face_of(sheet);
        let corners = cage.face(face);
        let at = |k: usize| DVec3::from(cage.positions()[corners[k % corners.len()] as usize]);
        let n = corners.len();
        // A face with another number of corners is split at its middle, and has a sheet for each corner:
        //       corner+1
        //          │
        //         half ──── middle
        //          │          │
        //        corner ─── half ── corner−1
        let corners = if n == 4 {
            [at(0), at(1), at(2), at(3)]
        } else {
            let middle = (0..n).fold(DVec3::ZERO, |sum, k| sum + at(k) / n as f64);
            let half = |a: usize, b: usize| 0.5 * (at(a) + at(b));
            [at(corner), half(corner, corner + 1), middle, half(corner + n - 1, corner)]
        };
        let sheet = limit.sheet(sheet)?;
        let distance = is_asked(&sheet).then(|| match (sheet.square(), sheet.triangle()) {
            (Some(square), _) => parametric_distance(square, corners),
            (_, Some(triangle)) => loop_deviation::parametric_distance(triangle, [at(0), at(1), at(2)]),
            _ => Ok(0.0),
        });
        // Added whatever the distance is: a difference whose square underflows would count as none.
        Ok(distance.transpose()?.map(|distance| distance + UNDERFLOW))
    };
    par_map(job, &numbers, |_, sheet| of_sheet(*sheet)).into_iter().collect()
}

/// Beyond this, squares leave the range of numbers. Chosen as for meshes.
const LARGEST: f64 = 1e150;
/// Lengths below it may come out as 0, since their squares do: a little more than √(3·2⁻¹⁰²²).
const UNDERFLOW: f64 = 1e-153;

/// A subpatch of the surface and the corresponding corners of the polygon.
struct QuadSubpatch<'a> {
    /// The part of its bound that is due to rounding.
    rounding_error: f64,
    depth: usize,
    piece: QuadSubpatchKind<'a>,
    corners: [DVec3; 4],
}

enum QuadSubpatchKind<'a> {
    /// The patch minus the polygon, and its rounding error.
    Difference(Box<Patch>, f64),
    Extraordinary(&'a ExtraordinaryQuad),
}

fn parametric_distance(square: &QuadPatchTree, corners: [DVec3; 4]) -> Result<f64, InvalidCage> {
    let mut open = BinaryHeap::new();
    let mut least = 0.0_f64;
    push(&mut open, square, corners, 0, &mut least);
    // The largest distance known at some parameter. One closure raises it, the other reads it.
    let least = Cell::new(least);
    let is_settled = |worst: &PriorityItem<QuadSubpatch<'_>>, _| {
        is_close_enough(worst.bound, least.get(), worst.item.rounding_error, worst.item.depth)
    };
    branch_and_bound(open, MOST_PIECES, is_settled, |worst, open| {
        let mut best_least = least.get();
        match worst.piece {
            QuadSubpatchKind::Difference(patch, rounding_error) => {
                for half in patch.halves_u() {
                    for quarter in half.halves_v() {
                        open.push(difference(quarter, rounding_error, worst.depth + 1, &mut best_least));
                    }
                }
            }
            QuadSubpatchKind::Extraordinary(extraordinary) => {
                let [a, b, c, d] = worst.corners;
                // d----cd----c
                // |    |     |      In the order of the quarters; each begins with its lower left corner.
                // da-middle-bc
                // |    |     |
                // a----ab----b
                let middle = 0.25 * ((a + b) + (c + d));
                let [ab, bc, cd, da] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d), 0.5 * (d + a)];
                let quarters =
                    [[a, ab, middle, da], [ab, b, bc, middle], [middle, bc, c, cd], [da, middle, cd, d]];
                for (quarter, corners) in extraordinary.quarters()?.iter().zip(quarters) {
                    push(open, quarter, corners, worst.depth + 1, &mut best_least);
                }
            }
        }
        least.set(best_least);
        Ok(())
    })
}

fn push<'a>(
    open: &mut BinaryHeap<PriorityItem<QuadSubpatch<'a>>>,
    square: &'a QuadPatchTree,
    corners: [DVec3; 4],
    depth: usize,
    least: &mut f64,
) {
    match square {
        QuadPatchTree::Regular(LimitPatches { patches: pieces, off: rounding_error }) => {
            for piece in pieces {
                let flat = |u: f64, v: f64| {
                    let low = corners[0] + u * (corners[1] - corners[0]);
                    let high = corners[3] + u * (corners[2] - corners[3]);
                    low + v * (high - low)
                };
                let within = |[from, to]: [f64; 2], k: usize| from + (to - from) * (k as f64 / 3.0);
                // The control points of a bilinear surface are its points at thirds.
                let control = std::array::from_fn(|i| {
                    std::array::from_fn(|j| {
                        let at = DVec3::from(piece.patch.control[i][j]);
                        (at - flat(within(piece.u, j), within(piece.v, i))).into()
                    })
                });
                // The points of the polygon are off by a dozen roundings of the largest coordinate.
                let largest = corners.iter().fold(0.0_f64, |most, c| most.max(c.abs().max_element()));
                let rounding_error = rounding_error + 32.0 * f64::EPSILON * largest;
                open.push(difference(Patch { control }, rounding_error, depth, least));
            }
        }
        // Beside the extraordinary vertex there is no polynomial. The limit is within the hull of
        // its one-ring, and the polygon within the hull of its corners, so no two of their points
        // are farther apart than two of these.
        QuadPatchTree::Extraordinary(extraordinary) => {
            let hull = extraordinary.ring().hull();
            let far = |point: &[f64; 3]| {
                let point = DVec3::from(*point);
                corners.iter().fold(0.0_f64, |most, corner| most.max((point - *corner).length()))
            };
            let largest = extraordinary.ring().size();
            let rounding_error = 2.0 * extraordinary.ring().rounding() + 64.0 * f64::EPSILON * largest;
            let bound = hull.iter().fold(0.0_f64, |most, point| most.max(far(point))) + rounding_error;
            // Corners are points with the same parameters on both, so their distances are distances
            // that exist.
            for (place, corner) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].into_iter().zip(corners) {
                if let Ok(jet) = extraordinary.at(place.0, place.1) {
                    *least = least.max((DVec3::from(jet.point) - corner).length());
                }
            }
            open.push(PriorityItem {
                bound,
                item: QuadSubpatch {
                    rounding_error,
                    depth,
                    piece: QuadSubpatchKind::Extraordinary(extraordinary),
                    corners,
                },
            });
        }
    }
}

fn difference<'a>(
    patch: Patch,
    rounding_error: f64,
    depth: usize,
    least: &mut f64,
) -> PriorityItem<QuadSubpatch<'a>> {
    let long = |at: [f64; 3]| DVec3::from(at).length();
    let control = patch.control.as_flattened();
    // Control points bound the difference from above, as it lies in their hull; points of the
    // difference itself bound it from below.
    let most = control.iter().fold(0.0_f64, |most, at| most.max(long(*at)));
    let ends = [patch.control[0][0], patch.control[0][3], patch.control[3][0], patch.control[3][3]];
    for at in ends.into_iter().chain([patch.at(0.5, 0.5)]) {
        *least = least.max(long(at));
    }
    let bound = most + rounding_error;
    let (piece, corners) = (QuadSubpatchKind::Difference(Box::new(patch), rounding_error), [DVec3::ZERO; 4]);
    PriorityItem { bound, item: QuadSubpatch { rounding_error, depth, piece, corners } }
}
