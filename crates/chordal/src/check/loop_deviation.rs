//! The deviation of a triangle of a Loop cage from its limit surface.
use crate::explicit::InvalidCage;
use crate::explicit::cage::limit::{ExtraordinaryTriangle, QUARTERS, Quartic, TrianglePatchTree};
use crate::math::{PriorityItem, branch_and_bound};
use glam::DVec3;
use std::cell::Cell;
use std::collections::BinaryHeap;

/// A bound within this factor of the distance at some parameter is close enough. Chosen: a smaller factor
/// takes more subdivisions.
const NEAR: f64 = 1.1;
/// Bounds within this multiple of their rounding are not subdivided either. Chosen: subdividing them gains
/// little.
const ROUNDINGS: f64 = 4.0;
/// Subdivision stops after this many pieces. Chosen: it bounds the time of a face whose bound converges
/// slowly.
pub(super) const MOST_PIECES: usize = 400;
/// Subdivisions after which hulls are below rounding.
const DEEPEST: usize = 45;

/// Whether subdividing a piece with this bound, rounding error and depth again would gain little over the
/// largest distance that is known to occur.
pub(super) fn is_close_enough(bound: f64, least: f64, rounding_error: f64, depth: usize) -> bool {
    bound <= NEAR * least + ROUNDINGS * rounding_error || depth > DEEPEST
}

/// A subpatch of the surface and the corresponding part of the triangle.
struct LoopSubpatch<'a> {
    /// The part of its bound that is due to rounding.
    rounding_error: f64,
    depth: usize,
    piece: LoopSubpatchKind<'a>,
}

enum LoopSubpatchKind<'a> {
    /// The polynomial minus the triangle.
    Difference(Box<Quartic>),
    Extraordinary(&'a ExtraordinaryTriangle, [DVec3; 3]),
}

/// The largest distance between points of both with the same parameters: an upper bound, close to the largest
/// known lower bound.
pub(super) fn parametric_distance(
    triangle: &TrianglePatchTree,
    corners: [DVec3; 3],
) -> Result<f64, InvalidCage> {
    let mut open = BinaryHeap::new();
    let mut least = 0.0_f64;
    push(&mut open, triangle, corners, 0, &mut least);
    let least = Cell::new(least);
    let is_settled = |worst: &PriorityItem<LoopSubpatch<'_>>, _| {
        is_close_enough(worst.bound, least.get(), worst.item.rounding_error, worst.item.depth)
    };
    branch_and_bound(open, MOST_PIECES, is_settled, |worst, open| {
        let mut best_least = least.get();
        let depth = worst.depth + 1;
        match worst.piece {
            LoopSubpatchKind::Difference(quartic) => {
                for quarter in quartic.quarters() {
                    open.push(difference(quarter, worst.rounding_error, depth, &mut best_least));
                }
            }
            LoopSubpatchKind::Extraordinary(extraordinary, [a, b, c]) => {
                let at = |[u, v]: [f64; 2]| a + u * (b - a) + v * (c - a);
                for (quarter, quarter_corners) in extraordinary.quarters()?.iter().zip(QUARTERS) {
                    push(open, quarter, quarter_corners.map(at), depth, &mut best_least);
                }
            }
        }
        least.set(best_least);
        Ok(())
    })
}

fn push<'a>(
    open: &mut BinaryHeap<PriorityItem<LoopSubpatch<'a>>>,
    triangle: &'a TrianglePatchTree,
    corners: [DVec3; 3],
    depth: usize,
    least: &mut f64,
) {
    // The points of the triangle are off by a dozen roundings of the largest coordinate.
    let largest = corners.iter().fold(0.0_f64, |most, c| most.max(c.abs().max_element()));
    let rounding = 64.0 * f64::EPSILON * largest;
    match triangle {
        TrianglePatchTree::Regular(polynomial) => {
            let [a, b, c] = corners;
            let mut quartic = polynomial.quartic;
            let mut index = 0;
            // The control points of the plane triangle as a quartic are its points at quarters, in
            // the same order of rows.
            for k in 0..5 {
                for j in 0..5 - k {
                    let flat = a + 0.25 * (f64::from(j) * (b - a) + f64::from(k) * (c - a));
                    quartic.control[index] = (DVec3::from(quartic.control[index]) - flat).into();
                    index += 1;
                }
            }
            open.push(difference(quartic, polynomial.off + rounding, depth, least));
        }
        TrianglePatchTree::Extraordinary(extraordinary) => {
            // As for quads: the one-ring's hull contains the limit, the corners contain the
            // triangle, and a distance is largest between two of their corners.
            let far = |point: &[f64; 3]| {
                let point = DVec3::from(*point);
                corners.iter().fold(0.0_f64, |most, corner| most.max((point - *corner).length()))
            };
            let ring = extraordinary.ring();
            let rounding_error = 2.0 * ring.rounding() + rounding + 64.0 * f64::EPSILON * ring.size();
            let bound = ring.hull().iter().fold(0.0_f64, |most, point| most.max(far(point))) + rounding_error;
            for (parameters, corner) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].into_iter().zip(corners) {
                if let Ok(jet) = extraordinary.at(parameters.0, parameters.1) {
                    *least = least.max((DVec3::from(jet.point) - corner).length());
                }
            }
            open.push(PriorityItem {
                bound,
                item: LoopSubpatch {
                    rounding_error,
                    depth,
                    piece: LoopSubpatchKind::Extraordinary(extraordinary, corners),
                },
            });
        }
    }
}

fn difference<'a>(
    quartic: Quartic,
    rounding_error: f64,
    depth: usize,
    least: &mut f64,
) -> PriorityItem<LoopSubpatch<'a>> {
    let long = |at: &[f64; 3]| DVec3::from(*at).length();
    let most = quartic.control.iter().fold(0.0_f64, |most, at| most.max(long(at)));
    for at in [quartic.control[0], quartic.control[4], quartic.control[14], quartic.point([1.0 / 3.0; 2])] {
        *least = least.max(long(&at));
    }
    PriorityItem {
        bound: most + rounding_error,
        item: LoopSubpatch { rounding_error, depth, piece: LoopSubpatchKind::Difference(Box::new(quartic)) },
    }
}
