//! `PatchDerivatives`: bounds on the derivatives of a patch over one tile, and the distance bound for
//! triangles.
//!
//! **The bound.** Let `S` be the patch over a triangle of its parameter plane with corners `p_i`, `T` the
//! linear map with `T(p_i) = S(p_i)`, `λ` barycentric coordinates, `d_ij = p_j − p_i`. Let `Q` be the
//! polynomial of degree three that has the derivatives of `S` up to the third at the middle of the triangle's
//! box, `H` its second derivative (a symmetric bilinear map into space) and `C` its third. On a side, `Q` is
//! a cubic, whose distance from its chord is `μ(1−μ)` times half its second derivative in the middle and
//! `(2μ−1)/12` of its third; inside, only a multiple of `λ_1 λ_2 λ_3` remains, which the value at the centroid
//! determines. With `m_ij` the middle of a side and `q_i` the corners relative to the centroid,
//!
//! ```text
//! T(x) − S(x) = Σ_{i<j} λ_i λ_j W_ij + t(x) + R,    W_ij = ½ H(m_ij)[d_ij, d_ij],
//! t(x) = Σ_{i<j} λ_i λ_j (λ_j − λ_i) C[d_ij, d_ij, d_ij] / 12 − 9/4 · λ_1 λ_2 λ_3 C[q_1, q_2, q_3],
//! |R| ≤ (du²·δ_uu + 2·du·dv·δ_uv + dv²·δ_vv) / 8 ≤ (4·du³·dv·|S_uuuv| + 6·du²·dv²·|S_uuvv| + 4·du·dv³·|S_uvvv|) / 64,
//! ```
//!
//! `du × dv` the box of the triangle. For the remainder take Taylor's formula for `E = S − Q` around `x`;
//! since `Σ λ_i (p_i − x) = 0`, the triangle differs from `E` by `½ Σ λ_i H̄_i[p_i−x, p_i−x]`, `H̄_i` a mean
//! of the second derivative of `E` over the segment from `x` to `p_i`. `δ` bounds that;
//! `Σ λ_i (u_i−u)² ≤ du²/4` by Popoviciu, the mixed term by Cauchy and Schwarz. The derivatives of `E` up to
//! the third vanish in the middle, so `δ` is half of the largest fourth derivatives along two steps of at
//! most half the box (those by u or v four times are 0). `t` is at most the sum of the `|C[d, d, d]|` times
//! `1/(72√3)`, and a twelfth of `|C[q_1, q_2, q_3]|`.
//!
//! **Sliding.** A distance between sets allows any pairing of points that covers both. Pair `S(x)` with
//! `T(ψ(x))`, `ψ(λ)_k = λ_k (1 + Σ_j ±s_kj λ_j)`, which moves `T` by `Σ λ_i λ_j s_ij (V_j − V_i)`. For
//! `|s_ij| ≤ 1` it is continuous, maps the triangle into itself, fixes its corners and maps every side to
//! itself; so on the boundary it has degree 1, and it covers the whole triangle. Choosing `s_ij` removes from
//! `W_ij` its part along the triangle's own edge `V_j − V_i`: only bending *across* an edge remains. It is at
//! most the maximum of `Σ λ_i λ_j w_ij` with `w_ij = |W_ij across|`, which [`max_barycentric_quadratic`]
//! gives in closed form.
//!
//! The pairing is defined on each triangle separately, so the union over all triangles bounds the two-sided
//! Hausdorff distance of surface and mesh. A triangle of the parameter plane with two corners at one point of
//! space (at a pole) has a segment for an image. It is left out of the mesh, and its segment is a side of the
//! triangle next to it, so both directions still hold.
//!
//! Sources: D. Filip, R. Magedson, R. Markot, *Surface algorithms using bounds on derivatives*, 1986 (the
//! bound by second derivatives); T. Popoviciu, 1935 (the variance of a bounded variable). The sliding is
//! Chordal's own.
//!
//! **Rounding.** Let `P` be the largest coordinate of the patch, `u = 2⁻⁵³`; errors in units of `u·P`, the
//! worst case being a tile of one cell. A control point of a part is six interpolations deep, 12. A second
//! derivative's control vectors have coordinates up to 24 (`uu`, `vv`) and 36 (`uv`) and errors of 360 and
//! 540, its values of 624 and 972. Third derivatives have lengths up to 48·√3 (`uuu`) and 144·√3 (`uuv`) and
//! errors of 1538 and 4864; fourth ones of 9300 (`uuuv`) and 19,700 (`uuvv`). Hence the error of half a
//! second derivative along a side is less than 3772 as a length, wherever the side lies in the box: along a
//! diagonal of the box its middle is the box's, a side along the box is half of it away and has only a
//! quarter of `uuv` more, and between those both shrink. `max_barycentric_quadratic` makes at most a third of
//! that, 1258, and rounds by 144. The error of `t` is 0.00802·35,400 + 7200/12 < 900, that of `R` (8·9300 +
//! 6·19,700)/64 < 3010, and they round by 200 and 1000. The error of a vertex (Bernstein form of a part, and
//! a parameter off by `u`, at up to `6·√3·P` per unit) is 70, that of the sum 200. Together 6782, less than
//! [`ROUNDING`] = 8192·u. The error of a curve's vertex is as large in terms of the *curve's* size, so it
//! holds for all patches that share it. Below the normal numbers a length, the root of a sum of squares,
//! loses at most `√(3·2⁻¹⁰⁷⁵) < 2⁻⁵³⁶`, a few of which are less than [`UNDERFLOW`].
use crate::explicit::Patch;
use crate::math::{greater, lesser};
use glam::DVec3;

/// Rounding error of a proved bound, as a fraction of the largest coordinate; derived above.
pub(super) const ROUNDING: f64 = 4096.0 * f64::EPSILON;

/// The contribution of underflow, a length: the root of the smallest normal number, 2⁻⁵¹¹; derived above.
pub(crate) const UNDERFLOW: f64 = f64::from_bits(512 << 52);

/// The length that rounding may add to the distance of a patch from its triangles.
pub(crate) fn rounding(patch: &Patch) -> f64 {
    ROUNDING * patch.size() + UNDERFLOW
}

/// The second derivatives at one point: `uu`, `uv`, `vv`.
#[derive(Clone, Copy)]
pub(crate) struct Hessian {
    pub(crate) uu: DVec3,
    pub(crate) uv: DVec3,
    pub(crate) vv: DVec3,
}

impl Hessian {
    /// `½ H[d, d]` for a step `(du, dv)` in the parameter plane.
    #[inline]
    pub(crate) fn half_along(&self, du: f64, dv: f64) -> DVec3 {
        self.uu * (0.5 * du * du) + self.uv * (du * dv) + self.vv * (0.5 * dv * dv)
    }
}

/// The length of `bend` across `chord`: what remains after sliding along the chord by at most its length.
#[inline]
pub(crate) fn across(bend: DVec3, chord: DVec3) -> f64 {
    let chord_sq = chord.length_squared();
    if chord_sq == 0.0 {
        return bend.length();
    }
    let slide = bend.dot(chord) / chord_sq;
    let slide = lesser(1.0, slide);
    let slide = greater(-1.0, slide);
    (bend - chord * slide).length()
}

/// The maximum of `a·λ₁λ₂ + b·λ₂λ₃ + c·λ₃λ₁` over the triangle, for `a, b, c ≥ 0`.
///
/// Inside, the critical point has the value `abc/(2(ab+bc+ca) − (a²+b²+c²))` and lies in the triangle exactly
/// when `a, b, c` satisfy the triangle inequality; otherwise the maximum is a quarter of the largest, in the
/// middle of its side. With `a ≥ b ≥ c` the denominator is `(c−(a−b))·(c+(a−b)) + 2c(a+b−c)`, a sum of
/// positive terms, each computed to a few ulp (`a − b` is exact, because `b ≥ a/2` here), so nothing cancels.
/// No value is above `a/3`, which is used if the denominator underflows.
#[inline]
pub(crate) fn max_barycentric_quadratic(a: f64, b: f64, c: f64) -> f64 {
    let (a, b) = if a < b { (b, a) } else { (a, b) };
    let (b, c) = if b < c { (c, b) } else { (b, c) };
    let (a, b) = if a < b { (b, a) } else { (a, b) };
    let lead = a - b;
    // No triangle inequality: `a ≥ b + c`.
    if lead >= c {
        return 0.25 * a;
    }
    let inside = a * (b * (c / ((c - lead) * (c + lead) + 2.0 * c * (a + b - c))));
    lesser(inside, a / 3.0)
}

/// The second and third derivatives of one tile's part as polynomials over its unit square, with bounds on
/// the fourth.
pub(crate) struct PatchDerivatives {
    uu: [[DVec3; 2]; 4],
    uv: [[DVec3; 3]; 3],
    vv: [[DVec3; 4]; 2],
    uuu: [DVec3; 4],
    uuv: [[DVec3; 2]; 3],
    uvv: [[DVec3; 3]; 2],
    vvv: [DVec3; 4],
    /// Bounds on |S_uuuv|, |S_uuvv|, |S_uvvv|.
    fourth: [f64; 3],
}

/// One row of [`PatchDerivatives`]: fixed `v`, polynomials in `u`.
pub(crate) struct PatchDerivativeRow {
    uu: [DVec3; 2],
    uv: [DVec3; 3],
    vv: [DVec3; 4],
    uuu: DVec3,
    uuv: [DVec3; 2],
    uvv: [DVec3; 3],
    vvv: [DVec3; 4],
}

/// The second and third derivatives at one point.
#[derive(Clone, Copy)]
pub(crate) struct ThirdOrderJet {
    pub(crate) second: Hessian,
    uuu: DVec3,
    uuv: DVec3,
    uvv: DVec3,
    vvv: DVec3,
}

impl ThirdOrderJet {
    /// Half the second derivative along a step, at an offset `(mu, mv)` from the point.
    #[inline]
    pub(crate) fn half_along(&self, [du, dv]: [f64; 2], [mu, mv]: [f64; 2]) -> DVec3 {
        let uu = self.second.uu + (self.uuu * mu + self.uuv * mv);
        let uv = self.second.uv + (self.uuv * mu + self.uvv * mv);
        let vv = self.second.vv + (self.uvv * mu + self.vvv * mv);
        Hessian { uu, uv, vv }.half_along(du, dv)
    }

    /// The third derivative along three steps.
    #[inline]
    fn third(&self, [a, b, c]: [[f64; 2]; 3]) -> DVec3 {
        self.uuu * (a[0] * b[0] * c[0])
            + self.uuv * (a[0] * b[0] * c[1] + a[0] * b[1] * c[0] + a[1] * b[0] * c[0])
            + self.uvv * (a[0] * b[1] * c[1] + a[1] * b[0] * c[1] + a[1] * b[1] * c[0])
            + self.vvv * (a[1] * b[1] * c[1])
    }

    /// The contribution of third derivatives to the bound of a triangle, beyond that of the second
    /// derivatives in the middles of its sides. `corners` are offsets from the point.
    #[inline]
    pub(crate) fn third_order_bound(&self, corners: [[f64; 2]; 3]) -> f64 {
        let [a, b, c] = corners;
        let step = |p: [f64; 2], q: [f64; 2]| [q[0] - p[0], q[1] - p[1]];
        let along = |d: [f64; 2]| self.third([d, d, d]).length();
        let middle = [(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0];
        let inside = self.third(corners.map(|corner| step(middle, corner))).length();
        CUBIC * (along(step(a, b)) + along(step(b, c)) + along(step(c, a))) + inside / 12.0
    }
}

/// A little more than 1/(72·√3), the largest `μ(1−μ)|1−2μ|/12`.
const CUBIC: f64 = 0.008_02;

impl PatchDerivatives {
    /// Computes the derivatives from the control points of the part.
    pub(crate) fn new(part: &Patch) -> Self {
        let q: [[DVec3; 4]; 4] = part.control.map(|row| row.map(DVec3::from));
        let second = |a: DVec3, b: DVec3, c: DVec3| 6.0 * ((a - b) - (b - c));
        let uu = q.map(|r| [second(r[0], r[1], r[2]), second(r[1], r[2], r[3])]);
        let vv: [[DVec3; 4]; 2] =
            [0, 1].map(|i| std::array::from_fn(|j| second(q[i][j], q[i + 1][j], q[i + 2][j])));
        let uv = std::array::from_fn(|i| {
            std::array::from_fn(|j| 9.0 * ((q[i + 1][j + 1] - q[i + 1][j]) - (q[i][j + 1] - q[i][j])))
        });
        let uuu = uu.map(|r| r[1] - r[0]);
        let uuv: [[DVec3; 2]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| 3.0 * (uu[i + 1][j] - uu[i][j])));
        let uvv: [[DVec3; 3]; 2] =
            std::array::from_fn(|i| std::array::from_fn(|j| 3.0 * (vv[i][j + 1] - vv[i][j])));
        let vvv: [DVec3; 4] = std::array::from_fn(|j| vv[1][j] - vv[0][j]);
        // In Bernstein form no value is longer than the longest control vector.
        let longest = |most: f64, d: DVec3| greater(d.length(), most);
        let uuuv = (0..3).fold(0.0, |most, i| longest(most, 3.0 * (uuu[i + 1] - uuu[i])));
        let uuvv = (0..2).fold(0.0, |most, i| {
            (0..2).fold(most, |most, j| longest(most, 2.0 * (uuv[i + 1][j] - uuv[i][j])))
        });
        let uvvv = (0..3).fold(0.0, |most, j| longest(most, 3.0 * (vvv[j + 1] - vvv[j])));
        Self { uu, uv, vv, uuu, uuv, uvv, vvv, fourth: [uuuv, uuvv, uvvv] }
    }

    /// The polynomials in `u` at `v`.
    pub(crate) fn row(&self, v: f64) -> PatchDerivativeRow {
        let s = 1.0 - v;
        let [b0, b1, b2, b3] = crate::explicit::bernstein(v);
        let (c0, c1, c2) = (s * s, 2.0 * s * v, v * v);
        PatchDerivativeRow {
            uu: std::array::from_fn(|j| {
                (self.uu[0][j] * b0 + self.uu[1][j] * b1) + (self.uu[2][j] * b2 + self.uu[3][j] * b3)
            }),
            uv: std::array::from_fn(|j| self.uv[0][j] * c0 + self.uv[1][j] * c1 + self.uv[2][j] * c2),
            vv: std::array::from_fn(|j| self.vv[0][j] * s + self.vv[1][j] * v),
            uuu: (self.uuu[0] * b0 + self.uuu[1] * b1) + (self.uuu[2] * b2 + self.uuu[3] * b3),
            uuv: std::array::from_fn(|j| self.uuv[0][j] * c0 + self.uuv[1][j] * c1 + self.uuv[2][j] * c2),
            uvv: std::array::from_fn(|j| self.uvv[0][j] * s + self.uvv[1][j] * v),
            vvv: self.vvv,
        }
    }

    /// The derivatives at `(u, v)` of the part.
    pub(crate) fn at(&self, u: f64, v: f64) -> ThirdOrderJet {
        self.row(v).at(u)
    }

    /// The remainder `R` for a triangle whose box is `du × dv`, if the derivatives are taken in its middle.
    #[inline]
    pub(crate) fn remainder(&self, du: f64, dv: f64) -> f64 {
        let [uuuv, uuvv, uvvv] = self.fourth;
        let (square, product) = (du * du * uuuv + dv * dv * uvvv, du * dv);
        (4.0 * square * product + 6.0 * (product * product) * uuvv) / 64.0
    }

    /// The bound of one triangle by its corners in the parameter plane and in space, with the derivatives at the middle of
    /// its box; without rounding, which [`rounding`] covers.
    pub(crate) fn triangle_bound(&self, corners: [[f64; 2]; 3], at: [DVec3; 3]) -> f64 {
        let range = |k: usize| {
            let [x, y, z] = corners.map(|corner| corner[k]);
            let (low, high) = if x < y { (x, y) } else { (y, x) };
            (lesser(z, low), greater(z, high))
        };
        let (u, v) = (range(0), range(1));
        let middle = [0.5 * (u.0 + u.1), 0.5 * (v.0 + v.1)];
        let jet = self.at(middle[0], middle[1]);
        let corners = corners.map(|corner| [corner[0] - middle[0], corner[1] - middle[1]]);
        let side = |i: usize, j: usize| {
            let ([pu, pv], [qu, qv]) = (corners[i], corners[j]);
            let bend = jet.half_along([qu - pu, qv - pv], [0.5 * (pu + qu), 0.5 * (pv + qv)]);
            across(bend, at[j] - at[i])
        };
        let slack = 4.0 * f64::EPSILON; // the error of a parameter is at most an ulp of 1 at each end
        max_barycentric_quadratic(side(0, 1), side(1, 2), side(2, 0))
            + jet.third_order_bound(corners)
            + self.remainder(u.1 - u.0 + slack, v.1 - v.0 + slack)
    }
}

impl PatchDerivativeRow {
    /// The derivatives at `u`.
    #[inline]
    pub(crate) fn at(&self, u: f64) -> ThirdOrderJet {
        let s = 1.0 - u;
        let [b0, b1, b2, b3] = crate::explicit::bernstein(u);
        let (c0, c1, c2) = (s * s, 2.0 * s * u, u * u);
        let cubic = |q: &[DVec3; 4]| (q[0] * b0 + q[1] * b1) + (q[2] * b2 + q[3] * b3);
        let square = |q: &[DVec3; 3]| q[0] * c0 + q[1] * c1 + q[2] * c2;
        ThirdOrderJet {
            second: Hessian {
                uu: self.uu[0] * s + self.uu[1] * u,
                uv: square(&self.uv),
                vv: cubic(&self.vv),
            },
            uuu: self.uuu,
            uuv: self.uuv[0] * s + self.uuv[1] * u,
            uvv: square(&self.uvv),
            vvv: cubic(&self.vvv),
        }
    }
}
