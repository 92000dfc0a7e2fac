//! `SecondDerivativeBound`: bounds the distance of a polynomial over a triangle from the flat triangle
//! between three vertices.
//!
//! Let `S` be the quartic over a triangle of the parameter plane with corners `p_i`, `T` linear with
//! `T(p_i) = S(p_i)`, `λ` barycentric coordinates and `H` the second derivative of `S`. As in
//! `patches/derivative_bound.rs`, `T(x) − S(x) = ½ Σ λ_i H̄_i[p_i−x, p_i−x]`, where `H̄_i` averages `H` over
//! the segment from `x` to `p_i`. A symmetric bilinear map of the plane is determined by its values
//! `G_ij = H[p_j−p_i, p_j−p_i]` along the three sides: for a step `a` with barycentric parts
//! `a_1 + a_2 + a_3 = 0`, `H[a, a] = −Σ_{i<j} a_i a_j G_ij`. Let `C_ij` be fixed vectors and `ε_ij` bound
//! `|G_ij − C_ij|` over the triangle. Then
//!
//! ```text
//! T(x) − S(x) = Σ_{i<j} ½ λ_i λ_j C_ij + R,    |R| ≤ Σ_{i<j} ½ λ_i λ_j (1 + 2 λ_k) ε_ij ≤ Σ_{i<j} ε_ij / 8,
//! ```
//!
//! since the step from `x` to `p_i` has the parts `1 − λ_i` and `−λ_j`: the pair `i, j` collects
//! `λ_i (1−λ_i) λ_j + λ_j (1−λ_j) λ_i + λ_k λ_i λ_j`, and `λ_i λ_j (1 + 2 λ_k)` is largest in the middle of
//! the side. The `G_ij` are quadratic polynomials whose control points are 12 times the second differences of
//! those of `S`, so that the farthest of six from `C_ij` gives `ε_ij`.
//!
//! *Sliding*, from `patches/derivative_bound.rs`: only the part of `½ C_ij` across the side counts, as long
//! as the part along it is no longer than the side itself. The pairing that shows this covers the triangle,
//! so both directions are bounded.
//!
//! **Rounding.** With `P` the largest coordinate and errors in units of `2⁻⁵³ P`: a control point of a part
//! takes four means of three, one after another: 16. A second difference times 12 has an error of
//! 12·(4·16 + 8) + 48 = 912 for each coordinate, 1600 as a length. The half of it, across a side, has 950, and the
//! barycentric maximum takes a third of each; `ε` has 3200, and an eighth of three counts, 1200. Vertices have an
//! error of 40. The sum is below 4096, half of
//! [`LoopCellShape::rounding_error`](super::cell::LoopCellShape::rounding_error).
use crate::convert::patches::derivative_bound::{across, max_barycentric_quadratic};
use crate::explicit::cage::limit::Quartic;
use crate::math::greater;
use glam::DVec3;

/// A bound, and the bending of each side: the first from the first corner to the second.
pub(crate) struct SecondDerivativeBound {
    pub(crate) bound: f64,
    pub(crate) sides: [f64; 3],
}

/// The index of the control point `j` steps along row `k`.
fn control_index(j: usize, k: usize) -> usize {
    [0, 5, 9, 12, 14][k] + j
}

/// The control points of a quadratic polynomial, by rows.
const SIX: [[usize; 2]; 6] = [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [0, 2]];

/// For each side, the steps along rows and between rows from a second difference's first point to its first,
/// second and third.
const STEPS: [[[usize; 2]; 3]; 3] =
    [[[0, 0], [1, 0], [2, 0]], [[2, 0], [1, 1], [0, 2]], [[0, 2], [0, 1], [0, 0]]];

impl SecondDerivativeBound {
    /// The bound of a part against its vertices.
    pub(crate) fn from_quartic(part: &Quartic, corners: &[[f64; 3]; 3]) -> Self {
        let (mut sides, mut spread) = ([0.0; 3], 0.0);
        let mut by_side = [0.0; 3];
        for (side, steps) in STEPS.into_iter().enumerate() {
            let at = |base: [usize; 2], step: [usize; 2]| {
                DVec3::from(part.control[control_index(base[0] + step[0], base[1] + step[1])])
            };
            let seconds = SIX.map(|base| {
                let [a, b, c] = steps.map(|step| at(base, step));
                12.0 * ((a - b) - (b - c))
            });
            let (mut low, mut high) = (seconds[0], seconds[0]);
            for second in seconds {
                (low, high) = (low.min(second), high.max(second));
            }
            let centre = 0.5 * low + 0.5 * high;
            let distances = seconds.iter().map(|second| (*second - centre).length());
            let farthest = distances.fold(0.0, |most: f64, distance| greater(distance, most));
            let chord = DVec3::from(corners[(side + 1) % 3]) - DVec3::from(corners[side]);
            by_side[side] = across(0.5 * centre, chord);
            // Half of a second derivative comes in times λᵢ · λⱼ, which is ¼ at most.
            spread += farthest / 8.0;
            sides[side] = by_side[side] + 0.5 * farthest;
        }
        let [a, b, c] = by_side;
        Self { bound: max_barycentric_quadratic(a, b, c) + spread, sides }
    }
}
