//! The search for one foot: the most promising first.
use super::boxes::{Held, distance_down};
use super::piece::{Piece, Place, beyond, larger};
use super::{Item, SurfaceTree};
use crate::explicit::cage::limit::{Rough, Square};
use crate::math::Ranked;
use glam::DVec3;
use std::collections::BinaryHeap;

/// What is not yet known well enough.
enum Open<'t> {
    Node(u32),
    Piece(u32),
    Rough(&'t Rough, Place),
    /// Nothing better will be known of it.
    Settled,
}

/// The nearest place that was found.
#[derive(Clone, Copy)]
pub(super) struct Best {
    /// The surface is at most this far.
    pub up: f64,
    /// Its point minus the query.
    pub point: DVec3,
    pub sheet: u32,
    pub at: [f64; 2],
    /// How much of that is for rounding.
    off: f64,
    /// Whether the point is only near, in the hull of what is no patch.
    pub is_rough: bool,
}

/// One query.
pub(super) struct Search<'t> {
    tree: &'t SurfaceTree,
    about: DVec3,
    /// Ends that are so near to each other are near enough.
    enough: f64,
    best: Best,
    open: BinaryHeap<Ranked<Open<'t>>>,
    pieces: Vec<Piece>,
}

/// What rounding leaves between the ends, as a share of the largest coordinate; 32 ε for a point and 6 for each halving. Derived
/// beside the pieces.
const FLOOR: f64 = 64.0 * f64::EPSILON;
/// What is known of a piece is not much better than this many times its rounding; chosen.
const OFFS: f64 = 4.0;
/// Pieces looked at for one query, after which its ends are what they are: where many places are equally near, as from the middle of a
/// ball. Chosen: some milliseconds.
pub(super) const MOST_PIECES: usize = 4096;
/// Points of a ring that count as a piece, each time it is divided; chosen, so that vertices of hundreds of faces get somewhere.
const RING: usize = 64;

impl<'t> Search<'t> {
    /// For a point in the tree's own coordinates.
    pub fn new(tree: &'t SurfaceTree, about: DVec3, tolerance: f64) -> Self {
        let size = larger(tree.size, about.abs().max_element());
        let enough = larger(tolerance, FLOOR * size);
        let best =
            Best { up: f64::INFINITY, point: DVec3::ZERO, sheet: 0, at: [0.0; 2], off: 0.0, is_rough: false };
        Self { tree, about, enough, best, open: BinaryHeap::new(), pieces: Vec::new() }
    }

    /// The nearest place and a bound from below on the distance; none without sheets.
    pub fn run(mut self) -> Option<(Best, f64)> {
        let (bounds, root) = self.tree.boxes.root()?;
        self.push(distance_down(self.about.into(), &bounds), Open::Node(root));
        let mut looked = 0;
        while let Some(Ranked { bound, item }) = self.open.pop() {
            let down = -bound;
            let is_near = self.best.up - down <= larger(self.enough, OFFS * self.best.off);
            if is_near || looked > MOST_PIECES {
                return Some((self.best, smaller(down, self.best.up)));
            }
            looked += match item {
                Open::Settled => return Some((self.best, smaller(down, self.best.up))),
                Open::Node(node) => {
                    self.enter(node, down);
                    0
                }
                Open::Piece(piece) => {
                    self.look(piece, down);
                    1
                }
                Open::Rough(rough, place) => self.divide(rough, (place, down)),
            };
        }
        // Everything else is farther.
        Some((self.best, self.best.up))
    }

    fn push(&mut self, down: f64, what: Open<'t>) {
        if down <= self.best.up {
            self.open.push(Ranked { bound: -down, item: what });
        }
    }

    fn enter(&mut self, node: u32, down: f64) {
        match self.tree.boxes.held(node) {
            Held::Two(children) => {
                for (bounds, child) in children {
                    self.push(distance_down(self.about.into(), &bounds), Open::Node(child));
                }
            }
            Held::Item(item) => match &self.tree.items[item] {
                Item::Patch { control, off, place } => {
                    self.pieces.push(Piece::new(control, self.about, (*off, *place)));
                    self.push(down, Open::Piece(self.pieces.len() as u32 - 1));
                }
                Item::Sheet(sheet) => {
                    let place = Place { sheet: *sheet, u: [0.0, 1.0], v: [0.0, 1.0] };
                    if let Some(square) = self.tree.sheets[*sheet as usize].square() {
                        self.square(square, (place, down));
                    }
                }
            },
        }
    }

    fn look(&mut self, number: u32, down: f64) {
        let piece = self.pieces[number as usize];
        let seen = piece.look();
        if seen.up < self.best.up {
            let (sheet, at) = (piece.place.sheet, piece.place.at(seen.at));
            self.best = Best { up: seen.up, point: seen.point, sheet, at, off: piece.off, is_rough: false };
        }
        let known = larger(down, seen.down);
        if seen.up - known <= larger(self.enough, OFFS * piece.off) {
            self.push(known, Open::Settled);
            return;
        }
        if known > self.best.up {
            return;
        }
        for half in piece.halves(&seen) {
            let known = larger(known, half.beyond(seen.point));
            self.pieces.push(half);
            self.push(known, Open::Piece(self.pieces.len() as u32 - 1));
        }
    }

    /// The quarters of a square; how many pieces that is worth.
    fn divide(&mut self, rough: &'t Rough, (place, down): (Place, f64)) -> usize {
        let Ok(quarters) = rough.quarters() else {
            self.push(down, Open::Settled);
            return 1;
        };
        let [low, high] = place.halves(1);
        let [a, b] = low.halves(0);
        let [d, c] = high.halves(0);
        for (quarter, place) in quarters.iter().zip([a, b, c, d]) {
            self.square(quarter, (place, down));
        }
        1 + rough.ring().hull().len() / RING
    }

    fn square(&mut self, square: &'t Square, (place, down): (Place, f64)) {
        match square {
            Square::Patches(patches) => {
                let off = self.tree.local_off(patches.off);
                for piece in &patches.pieces {
                    let control = piece.patch.control.map(|row| row.map(|p| self.tree.local(p)));
                    let inner = |[from, to]: [f64; 2], part: [f64; 2]| part.map(|x| from + (to - from) * x);
                    let place = Place { u: inner(place.u, piece.u), v: inner(place.v, piece.v), ..place };
                    let piece = Piece::new(&control, self.about, (off, place));
                    let known = larger(down, piece.beyond(piece.middle()));
                    self.pieces.push(piece);
                    self.push(known, Open::Piece(self.pieces.len() as u32 - 1));
                }
            }
            Square::Rough(rough) => {
                let hull = rough.ring().hull().iter();
                let hull: Vec<DVec3> = hull.map(|p| DVec3::from(self.tree.local(*p)) - self.about).collect();
                let size = hull.iter().fold(0.0, |most, p| larger(most, p.abs().max_element()));
                // The differences are rounded once.
                let off = self.tree.local_off(2.0 * rough.ring().off()) + 2.0 * f64::EPSILON * size;
                let middle = hull.iter().fold(DVec3::ZERO, |sum, p| sum + *p) / hull.len() as f64;
                let by_plane = larger(beyond(&hull, middle, size), beyond(&hull, self.best.point, size));
                let known = larger(down, by_plane - off);
                // The surface of the square is somewhere in the hull.
                let farthest = hull.iter().fold(0.0, |most, p| larger(most, p.length()));
                let up = farthest * (1.0 + 8.0 * f64::EPSILON) + off;
                if up < self.best.up {
                    let (sheet, at) = (place.sheet, place.at([0.5, 0.5]));
                    self.best = Best { up, point: middle, sheet, at, off, is_rough: true };
                }
                let is_point = up - known <= larger(self.enough, OFFS * off);
                self.push(known, if is_point { Open::Settled } else { Open::Rough(rough, place) });
            }
        }
    }
}

fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}
