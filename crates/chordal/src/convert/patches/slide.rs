//! `Facet`: a triangle of a tile, and by how much it is off the surface once what lies in its own plane has slid away.
//!
//! [`super::bend`] pairs `S(x)` with points of the same triangle. A distance between sets allows more. Let `K` be triangles glued along edges,
//! two at each, `T` the map of `K` onto the mesh that is linear on each, and `Ψ` a continuous map of `K` into itself that can be shrunk to the
//! identity while every edge that is not glued (that is *cut*) stays within itself. Then `Ψ` has degree 1, so it covers `K`, and the largest
//! distance of `S(x)` from `T(Ψ(x))` bounds both directions.
//!
//! **The map.** On a triangle with the unit normal `n` let `D = S − T` and `D°` its part in the triangle's plane. `Ψ` moves `x` by
//!
//! ```text
//! v(x) = D°(x) + Σ (1 − λ_k)² γ_ij(x_ij) b_ij,
//! ```
//!
//! and on over an edge into the plane of the neighbour, if that leaves the triangle. The sum is over edges `ij`, `b_ij` the unit vector across
//! one into the triangle, `x_ij` the point of the edge that `x` is on the way to from the vertex `k`. On an edge that is cut `γ = −D·b`, so that `v` runs
//! along it. On one that is glued to a triangle with `n'`, `b'` the mean of both sides: `γ = −D·(b + b')/2`, so that in the hinge laid flat
//! both have the same `v` there; `|b + b'| = |n − n'|`. A term vanishes on the other two edges. With `g` the surface along the edge as a function from 0 to 1,
//! `|γ| ≤ μ(1−μ) p` at the share `μ` of the edge, `p` the largest `½|g''·b|`, or `½|g''·(b + b')|/2`; so a term is at most `λ_i λ_j p`.
//!
//! **It stays in the triangle or its neighbour.** Let `η` bound the part of `H[d, d]` in the plane over all `d` in the triangle. With Taylor's formula
//! around `x` (as in [`super::bend`]) the derivative of `D°` along the way from an edge to the opposite vertex is at most `η`; so `|D°| ≤ η(1 − λ_i)` for each
//! `i`. For a cut edge `p ≤ η/2`; for one glued with `|n − n'| ≤ 1/2`, `p ≤ ζ/4`, `ζ` the largest `½|g''|`. Hence `|v| ≤ ω(1 − λ_i)`, and the part of
//! `v` across an edge differs from that at `x_ij` by at most `ω λ_k`, with `ω = η + 3/2·max(η/2, ζ/4)` and so with the *reach* `7η/4 + 3ζ/8`.
//! Edges are glued only if the reach of both triangles is at most `κ = 0.45` of the least height `h` of both.
//! Then over a cut edge nothing leaves: `v` moves `λ_k` down by at most `κλ_k`. Where a path leaves over `ij`, `1 − λ_i` has fallen to no less than
//! `(1 − κ)` of what it was, and the distance to the neighbour's edge at `i` is at least `(1 − κ)(1 − λ_i) h`; what is left of the path is
//! at most `κ(1 − λ_i) h`, which is less: it ends in the neighbour, and passes no vertex. Shorter moves do the same, which is the shrinking. At vertices `v` is 0.
//!
//! **The distance.** In the triangle it is made of `D·n`, along `n`, which is at most a mix of the `|W_ij·n|` (as in [`super::bend`]) and the
//! remainder's part along `n`; and of the sum above, across. What goes over the edge `ij` gets beyond it by at most `λ_i λ_j q`, `q` the largest
//! `½|g''|` across the edge (the share that `λ_k` takes off is more than what `ω` adds), and the plane turns there: by `|n − n'|` of that along `n` and
//! half of `|n − n'|²` of it across. With the maxima `N` and `P` of both mixes the distance is at most `√(N² + P²)`. Along an edge, half a second
//! derivative differs from that in the middle of the triangle by four times the remainder at most.
//!
//! This is Chordal's own. A triangle's computed normal is off by less than 12 roundings, of its longest edge over `h`, and turns `D°`, which is at most `κh`:
//! that and the turns are less than 200 roundings of the largest coordinate.
use super::bend::{Hessian, across, worst_mix};
use glam::DVec3;

/// A triangle as the proof needs it. Its edge `k` runs from its corner `k` to the next.
#[derive(Clone, Copy)]
pub(crate) struct Facet {
    /// The unit normal; zero where the triangle cannot be glued to others.
    normal: DVec3,
    /// The least height.
    height: f64,
    /// How far `v` may go.
    reach: Reach,
    edges: [Bent; 3],
    /// Bounds on the remainder: along the normal, and in all.
    remainder: [f64; 2],
}

/// An edge: its vector in space, and half the second derivative along it.
#[derive(Clone, Copy)]
pub(crate) struct Bent {
    pub(crate) chord: DVec3,
    pub(crate) bend: DVec3,
}

/// The surface around a triangle: the sides of its box, the second derivatives in its middle, and bounds on the remainder: along a
/// unit vector near its normal, and in all.
pub(crate) struct Around {
    pub(crate) sides: [f64; 2],
    pub(crate) hessian: Hessian,
    pub(crate) near: DVec3,
    pub(crate) remainder: [f64; 2],
}

/// What an edge adds to the distance: along the triangle's normal, and across it.
#[derive(Clone, Copy, Default)]
pub(crate) struct Left {
    along: f64,
    beside: f64,
}

/// The farthest reach, as a share of the least height: κ, less than a half.
const FARTHEST: f64 = 0.45;
/// The sharpest turn over an edge that is glued, as the distance of the unit normals; the proof takes no more.
const SHARPEST: f64 = 0.5;
/// A triangle whose least height is a smaller share of its longest edge is never glued; chosen, far above rounding.
const LEAST_HEIGHT: f64 = 1e-6;

/// How far `v` may go: along edges as a share of them, elsewhere as a length, and in all.
#[derive(Clone, Copy, Default)]
struct Reach {
    along: f64,
    aside: f64,
    slip: f64,
}

impl Reach {
    /// Whether it ends in a triangle or its neighbour, if none has a height below this.
    #[inline]
    fn is_short(&self, height: f64) -> bool {
        let aside = self.aside / height;
        let left = 1.0 - self.along - aside;
        left > 0.0 && left - self.along - aside - aside * (self.slip / height) / left >= 0.05
    }
}

impl Bent {
    /// The same edge the other way.
    #[inline]
    pub(crate) fn turned(self) -> Self {
        Self { chord: -self.chord, bend: self.bend }
    }

    /// Its bend without what is along it.
    #[inline]
    fn aside(&self) -> DVec3 {
        self.bend - self.chord * (self.bend.dot(self.chord) / self.chord.length_squared())
    }
}

impl Facet {
    /// From the edges; lengths times `unit` are in the range where four of them may be multiplied.
    #[inline]
    pub(crate) fn new(edges: [Bent; 3], around: &Around, unit: f64) -> Self {
        let [of_it, all] = around.remainder;
        let mut facet =
            Self { normal: DVec3::ZERO, height: 0.0, reach: Reach::default(), edges, remainder: [0.0, all] };
        let [a, b, c] = edges.map(|edge| edge.chord * unit);
        let area = a.cross(b);
        let (doubled, squares) = (area.length(), [a, b, c].map(DVec3::length_squared));
        let longest = larger(squares[0], larger(squares[1], squares[2]));
        if !(doubled > LEAST_HEIGHT * longest) {
            return facet;
        }
        let normal = area / doubled;
        let height = doubled / longest.sqrt() / unit;
        let (mut along, mut aside, mut slip, mut off) = (0.0, 0.0, 0.0, 0.0);
        for (edge, square) in edges.iter().zip([a, b, c].map(DVec3::length_squared)) {
            let chord = square.sqrt() / unit;
            let (way, rest) = (edge.bend.dot(edge.chord).abs() / chord, edge.aside());
            let lift = rest.dot(normal);
            let (flat, lift) = ((rest - normal * lift).length(), lift.abs());
            (along, slip) = (larger(along, way / chord), larger(slip, way));
            (aside, off) = (larger(aside, flat), larger(off, lift + 0.25 * flat));
        }
        let aside = aside + 0.25 * (off + 5.0 * all);
        let reach = Reach { along, aside: aside + 10.0 * all, slip: slip + aside };
        if !reach.is_short(height) {
            return facet;
        }
        let tilted = of_it + (normal - around.near).length() * all;
        facet.remainder[0] = if tilted < all { tilted } else { all };
        (facet.normal, facet.height, facet.reach) = (normal, height, reach);
        facet
    }

    /// What an edge adds at which it is glued to another triangle; `None` where it has to be cut.
    #[inline]
    pub(crate) fn glued(&self, k: usize, other: &Self) -> Option<Left> {
        let turn = (self.normal - other.normal).length();
        let height = if self.height < other.height { self.height } else { other.height };
        if !(turn <= SHARPEST && self.reach.is_short(height) && other.reach.is_short(height)) {
            return None;
        }
        let along = self.edges[k].bend.dot(self.normal).abs();
        let [of_it, all] = self.remainder.map(|part| 4.0 * part);
        let whole = self.edges[k].aside().length() + all;
        let mean = 0.5 * turn * (along + of_it + 0.5 * turn * whole);
        Some(Left { along: along + turn * whole, beside: mean + 0.5 * turn * turn * whole })
    }

    /// The bound, from what its edges add; those of which nothing is said are cut.
    #[inline]
    pub(crate) fn bound(&self, edges: &[Option<Left>; 3]) -> f64 {
        let plain = || {
            let [a, b, c] = self.edges.map(|edge| across(edge.bend, edge.chord));
            worst_mix(a, b, c) + self.remainder[1]
        };
        if !self.is_free() {
            return plain();
        }
        let [a, b, c] = [0, 1, 2].map(|k| edges[k].unwrap_or_else(|| self.cut(k)));
        let along = worst_mix(a.along, b.along, c.along) + self.remainder[0];
        let beside = worst_mix(a.beside, b.beside, c.beside);
        let bound = (along * along + beside * beside).sqrt();
        if edges.iter().any(Option::is_some) {
            return bound;
        }
        let plain = plain();
        if plain < bound { plain } else { bound }
    }

    #[inline]
    fn cut(&self, k: usize) -> Left {
        let rest = self.edges[k].aside();
        let along = rest.dot(self.normal);
        Left { along: along.abs(), beside: (rest - self.normal * along).length() + 4.0 * self.remainder[1] }
    }

    /// Whether it may be glued.
    #[inline]
    fn is_free(&self) -> bool {
        self.height > 0.0
    }
}

#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
