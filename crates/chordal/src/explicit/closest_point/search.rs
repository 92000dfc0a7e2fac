//! `SurfaceSearch`: the best-first search for one closest point.
use super::box_tree::{BoxTreeNode, distance_down};
use super::offset_patch::{OffsetPatch, SheetRectangle, hull_plane_bound};
use super::{SurfaceItem, SurfaceTree};
use crate::explicit::cage::limit::{ExtraordinaryQuad, QuadPatchTree};
use crate::math::{PriorityItem, greater, lesser};
use glam::DVec3;
use std::collections::BinaryHeap;

/// A part of the surface whose distance is not yet bounded well enough.
enum SurfaceCandidate<'t> {
    Node(u32),
    Patch(u32),
    Extraordinary(&'t ExtraordinaryQuad, SheetRectangle),
    /// Its bound cannot improve further.
    Settled,
}

/// The closest point found so far.
#[derive(Clone, Copy)]
pub(super) struct ClosestSoFar {
    /// Upper bound for the distance of the surface.
    pub up: f64,
    /// The point minus the query.
    pub point: DVec3,
    pub sheet: u32,
    pub at: [f64; 2],
    /// The rounding error included in `up`.
    error: f64,
    /// Whether the point is only approximate, in the hull of an extraordinary square.
    pub is_extraordinary: bool,
}

/// One query.
pub(super) struct SurfaceSearch<'t> {
    tree: &'t SurfaceTree,
    about: DVec3,
    /// Bounds this close to each other end the search.
    close_enough: f64,
    best: ClosestSoFar,
    open: BinaryHeap<PriorityItem<SurfaceCandidate<'t>>>,
    patches: Vec<OffsetPatch>,
}

/// The gap that rounding leaves between the bounds, as a multiple of the largest coordinate; 32 ε for a point
/// and 6 for each halving. Derived in `offset_patch.rs`.
const FLOOR: f64 = 64.0 * f64::EPSILON;
/// The bounds of a piece hardly get closer than this multiple of its rounding. Chosen: a smaller value
/// subdivides pieces in vain, a larger one leaves a wider gap between the bounds.
const ROUNDINGS: f64 = 4.0;
/// The most pieces that one query bounds; after that it returns its current bounds. This matters if many
/// points are equally close, as from the centre of a ball. Chosen: some milliseconds.
pub(super) const MOST_PIECES: usize = 4096;
/// Points of a ring that count as a piece, each time it is subdivided. Chosen so that the search makes
/// progress at vertices of hundreds of faces.
const RING: usize = 64;

impl<'t> SurfaceSearch<'t> {
    /// A search for a point in the tree's local coordinates.
    pub fn new(tree: &'t SurfaceTree, about: DVec3, tolerance: f64) -> Self {
        let size = greater(tree.size, about.abs().max_element());
        let close_enough = greater(tolerance, FLOOR * size);
        let best = ClosestSoFar {
            up: f64::INFINITY,
            point: DVec3::ZERO,
            sheet: 0,
            at: [0.0; 2],
            error: 0.0,
            is_extraordinary: false,
        };
        Self { tree, about, close_enough, best, open: BinaryHeap::new(), patches: Vec::new() }
    }

    /// The closest point found and a lower bound for the distance; None without sheets.
    pub fn run(mut self) -> Option<(ClosestSoFar, f64)> {
        let (bounds, root) = self.tree.boxes.root()?;
        self.push(distance_down(self.about.into(), &bounds), SurfaceCandidate::Node(root));
        let mut looked = 0;
        while let Some(PriorityItem { bound, item }) = self.open.pop() {
            let down = -bound;
            let is_near = self.best.up - down <= greater(self.close_enough, ROUNDINGS * self.best.error);
            if is_near || looked > MOST_PIECES {
                return Some((self.best, lesser(down, self.best.up)));
            }
            looked += match item {
                // Candidates come nearest first, so nothing that is still open is nearer than this
                // one, whose bounds have met.
                SurfaceCandidate::Settled => return Some((self.best, lesser(down, self.best.up))),
                SurfaceCandidate::Node(node) => {
                    self.expand_node(node, down);
                    0
                }
                SurfaceCandidate::Patch(piece) => {
                    self.bound_patch(piece, down);
                    1
                }
                SurfaceCandidate::Extraordinary(extraordinary, place) => {
                    self.divide(extraordinary, place, down)
                }
            };
        }
        // All other parts are farther.
        Some((self.best, self.best.up))
    }

    fn push(&mut self, down: f64, candidate: SurfaceCandidate<'t>) {
        if down <= self.best.up {
            self.open.push(PriorityItem { bound: -down, item: candidate });
        }
    }

    fn expand_node(&mut self, node: u32, down: f64) {
        match self.tree.boxes.node(node) {
            BoxTreeNode::Inner(children) => {
                for (bounds, child) in children {
                    self.push(distance_down(self.about.into(), &bounds), SurfaceCandidate::Node(child));
                }
            }
            BoxTreeNode::Leaf(item) => match &self.tree.items[item] {
                SurfaceItem::Patch { control, error, place } => {
                    self.patches.push(OffsetPatch::new(control, self.about, *error, *place));
                    self.push(down, SurfaceCandidate::Patch(self.patches.len() as u32 - 1));
                }
                SurfaceItem::Sheet(sheet) => {
                    let place = SheetRectangle { sheet: *sheet, u: [0.0, 1.0], v: [0.0, 1.0] };
                    if let Some(square) = self.tree.sheets[*sheet as usize].square() {
                        self.add_square(square, place, down);
                    }
                }
            },
        }
    }

    fn bound_patch(&mut self, number: u32, down: f64) {
        let piece = self.patches[number as usize];
        let closest = piece.bound_distance();
        if closest.up < self.best.up {
            let (sheet, at) = (piece.place.sheet, piece.place.at(closest.at));
            self.best = ClosestSoFar {
                up: closest.up,
                point: closest.point,
                sheet,
                at,
                error: piece.error,
                is_extraordinary: false,
            };
        }
        // What holds for the whole holds for this part of it.
        let lower = greater(down, closest.down);
        if closest.up - lower <= greater(self.close_enough, ROUNDINGS * piece.error) {
            self.push(lower, SurfaceCandidate::Settled);
            return;
        }
        // Farther than a point that is known.
        if lower > self.best.up {
            return;
        }
        for half in piece.halves(&closest) {
            let lower = greater(lower, half.plane_bound(closest.point));
            self.patches.push(half);
            self.push(lower, SurfaceCandidate::Patch(self.patches.len() as u32 - 1));
        }
    }

    /// Pushes the quarters of a square. Returns the number of pieces that this counts as.
    fn divide(&mut self, extraordinary: &'t ExtraordinaryQuad, place: SheetRectangle, down: f64) -> usize {
        let Ok(quarters) = extraordinary.quarters() else {
            self.push(down, SurfaceCandidate::Settled);
            return 1;
        };
        let [low, high] = place.halves(1);
        let [a, b] = low.halves(0);
        let [d, c] = high.halves(0);
        for (quarter, place) in quarters.iter().zip([a, b, c, d]) {
            self.add_square(quarter, place, down);
        }
        1 + extraordinary.ring().hull().len() / RING
    }

    fn add_square(&mut self, square: &'t QuadPatchTree, place: SheetRectangle, down: f64) {
        match square {
            QuadPatchTree::Regular(patches) => {
                let error = self.tree.local_error(patches.off);
                for piece in &patches.patches {
                    let control = piece.patch.control.map(|row| row.map(|p| self.tree.local(p)));
                    let inner = |[from, to]: [f64; 2], part: [f64; 2]| part.map(|x| from + (to - from) * x);
                    let place =
                        SheetRectangle { u: inner(place.u, piece.u), v: inner(place.v, piece.v), ..place };
                    let piece = OffsetPatch::new(&control, self.about, error, place);
                    let lower = greater(down, piece.plane_bound(piece.middle()));
                    self.patches.push(piece);
                    self.push(lower, SurfaceCandidate::Patch(self.patches.len() as u32 - 1));
                }
            }
            QuadPatchTree::Extraordinary(extraordinary) => {
                let hull = extraordinary.ring().hull().iter();
                let hull: Vec<DVec3> = hull.map(|p| DVec3::from(self.tree.local(*p)) - self.about).collect();
                let size = hull.iter().fold(0.0, |largest, p| greater(largest, p.abs().max_element()));
                // The differences are rounded once.
                let error =
                    self.tree.local_error(2.0 * extraordinary.ring().rounding()) + 2.0 * f64::EPSILON * size;
                let middle = hull.iter().fold(DVec3::ZERO, |sum, p| sum + *p) / hull.len() as f64;
                // Towards the middle of the hull, and towards the nearest point so far: either
                // plane may separate better.
                let by_plane = greater(
                    hull_plane_bound(&hull, middle, size),
                    hull_plane_bound(&hull, self.best.point, size),
                );
                let lower = greater(down, by_plane - error);
                // The surface of the square lies within the hull.
                let farthest = hull.iter().fold(0.0, |farthest, p| greater(farthest, p.length()));
                let up = farthest * (1.0 + 8.0 * f64::EPSILON) + error;
                if up < self.best.up {
                    let (sheet, at) = (place.sheet, place.at([0.5, 0.5]));
                    self.best = ClosestSoFar { up, point: middle, sheet, at, error, is_extraordinary: true };
                }
                let is_point = up - lower <= greater(self.close_enough, ROUNDINGS * error);
                self.push(
                    lower,
                    if is_point {
                        SurfaceCandidate::Settled
                    } else {
                        SurfaceCandidate::Extraordinary(extraordinary, place)
                    },
                );
            }
        }
    }
}
