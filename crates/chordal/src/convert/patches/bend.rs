//! `Bend`: how strongly a patch bends over one tile, and the bound on triangles that follows from it.
//!
//! **The bound.** Let `S` be the patch over a triangle of its parameter plane with corners `p_i`, `T` the linear
//! map with `T(p_i) = S(p_i)`, `λ` barycentric coordinates, `d_ij = p_j − p_i`, `H` the second derivative of `S`
//! (a symmetric bilinear map into space), `H_c` any fixed such map. With Taylor's formula around `x` and
//! `Σ λ_i (p_i − x) = 0`,
//!
//! ```text
//! T(x) − S(x) = ½ Σ λ_i H̄_i[p_i−x, p_i−x] = Σ_{i<j} λ_i λ_j W_ij + R,    W_ij = ½ H_c[d_ij, d_ij],
//! |R| ≤ (du²·δ_uu + 2·du·dv·δ_uv + dv²·δ_vv) / 8,
//! ```
//!
//! where `H̄_i` averages `H` over the segment from `x` to `p_i`, `du × dv` is the box of the triangle and `δ`
//! bounds `|H − H_c|` over it: `Σ λ_i (u_i−u)² ≤ du²/4` by Popoviciu, the mixed term by Cauchy and Schwarz.
//!
//! **Sliding.** A distance between sets allows any pairing of points that covers both. Pair `S(x)` with
//! `T(ψ(x))`, `ψ(λ)_k = λ_k (1 + Σ_j ±s_kj λ_j)`, which moves `T` by `Σ λ_i λ_j s_ij (V_j − V_i)`. For
//! `|s_ij| ≤ 1` it is continuous, maps the triangle into itself, fixes its corners and maps every side to itself;
//! so on the boundary it has degree 1, and it covers the whole triangle. Choosing `s_ij` removes from `W_ij` its
//! part along the triangle's own edge `V_j − V_i`: only bending *across* an edge counts. What is left is at most
//! the maximum of `Σ λ_i λ_j w_ij` with `w_ij = |W_ij across|`, which [`worst_mix`] gives in closed form.
//!
//! The pairing lives on each triangle by itself, so the union over all triangles bounds the two-sided Hausdorff
//! distance of surface and mesh. A triangle of the parameter plane with two corners in one point of space (at a
//! pole) has a segment for an image; it is left out of the mesh, and its segment is a side of the triangle next
//! to it, so both directions still hold.
//!
//! Sources: D. Filip, R. Magedson, R. Markot, *Surface algorithms using bounds on derivatives*, 1986 (the bound by
//! second derivatives); T. Popoviciu, 1935 (the variance of a bounded variable). The sliding is Chordal's own.
//!
//! **Rounding.** Let `P` be the largest coordinate of the patch, `u = 2⁻⁵³`; errors in units of `u·P`, the worst case
//! being a tile of one cell. A control point of a part is six interpolations deep, 12. A second derivative's control
//! vectors have coordinates up to 24 (`uu`, `vv`) and 36 (`uv`) and are off by 360 and 540, its values by 624 and 972.
//! Hence half of it along a side of the cell is off by 360 and along a diagonal by 1956, a coordinate; as lengths across the
//! chord, by 716 and 3772. `worst_mix` makes at most a quarter of that, 943, and rounds by 144. Third derivatives have
//! lengths up to 48·√3 (`uuu`) and 144·√3 (`uuv`) and are off by 1538 and 4864, the remainder by 2016, and it rounds by
//! 623. A vertex (Bernstein form of a part, and a parameter off by `u`, at up to `6·√3·P` a unit) is off by 70, the sum
//! by 131. Together 3927, less than [`ROUNDING`] = 4096·u. A curve's vertex is off by as much of the *curve's* size, so
//! it is good for all patches that share it. Below the normal numbers a length, the root of a sum of squares, loses
//! at most `√(3·2⁻¹⁰⁷⁵) < 2⁻⁵³⁶`, a few of which are less than [`UNDERFLOW`].
use crate::explicit::Patch;
use glam::DVec3;

/// Rounding of a certified bound, as a share of the largest coordinate; derived above.
pub(super) const ROUNDING: f64 = 2048.0 * f64::EPSILON;

/// What underflow adds to it, a length: the root of the smallest normal number, 2⁻⁵¹¹; derived above.
pub(super) const UNDERFLOW: f64 = f64::from_bits(512 << 52);

/// The length that rounding may add to the distance of a patch from its triangles.
pub(crate) fn rounding(patch: &Patch) -> f64 {
    ROUNDING * patch.size() + UNDERFLOW
}

/// The second derivatives at one place: `uu`, `uv`, `vv`.
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
    let slide = if slide > 1.0 { 1.0 } else { slide };
    let slide = if slide < -1.0 { -1.0 } else { slide };
    (bend - chord * slide).length()
}

/// The maximum of `a·λ₁λ₂ + b·λ₂λ₃ + c·λ₃λ₁` over the triangle, for `a, b, c ≥ 0`.
///
/// Inside, the critical point has the value `abc/(2(ab+bc+ca) − (a²+b²+c²))` and lies in the triangle exactly when
/// `a, b, c` obey the triangle inequality; otherwise the maximum is a quarter of the largest, in the middle of its
/// side. With `a ≥ b ≥ c` the denominator is `(c−(a−b))·(c+(a−b)) + 2c(a+b−c)`, a sum of positive terms, each
/// computed to a few ulp (`a − b` is exact, because `b ≥ a/2` here), so nothing cancels. No value is above `a/3`, which
/// is what counts where the denominator underflows.
#[inline]
pub(crate) fn worst_mix(a: f64, b: f64, c: f64) -> f64 {
    let (a, b) = if a < b { (b, a) } else { (a, b) };
    let (b, c) = if b < c { (c, b) } else { (b, c) };
    let (a, b) = if a < b { (b, a) } else { (a, b) };
    let lead = a - b;
    if lead >= c {
        return 0.25 * a;
    }
    let inside = a * (b * (c / ((c - lead) * (c + lead) + 2.0 * c * (a + b - c))));
    if inside < a / 3.0 { inside } else { a / 3.0 }
}

/// The second derivatives of one tile's part as polynomials over its unit square, with bounds on the third.
pub(crate) struct Bend {
    uu: [[DVec3; 2]; 4],
    uv: [[DVec3; 3]; 3],
    vv: [[DVec3; 4]; 2],
    /// Bounds on |S_uuu|, |S_uuv|, |S_uvv|, |S_vvv|.
    third: [f64; 4],
}

/// One row of [`Bend`]: fixed `v`, polynomials in `u`.
pub(crate) struct BendRow {
    uu: [DVec3; 2],
    uv: [DVec3; 3],
    vv: [DVec3; 4],
}

impl Bend {
    /// From the control points of the part.
    pub(crate) fn new(part: &Patch) -> Self {
        let q: [[DVec3; 4]; 4] = part.control.map(|row| row.map(DVec3::from));
        let second = |a: DVec3, b: DVec3, c: DVec3| 6.0 * ((a - b) - (b - c));
        let uu = q.map(|r| [second(r[0], r[1], r[2]), second(r[1], r[2], r[3])]);
        let vv = [0, 1].map(|i| std::array::from_fn(|j| second(q[i][j], q[i + 1][j], q[i + 2][j])));
        let uv = std::array::from_fn(|i| {
            std::array::from_fn(|j| 9.0 * ((q[i + 1][j + 1] - q[i + 1][j]) - (q[i][j + 1] - q[i][j])))
        });
        let longest = |most: f64, d: DVec3| if d.length() > most { d.length() } else { most };
        let uuu = uu.iter().fold(0.0, |most, r| longest(most, r[1] - r[0]));
        let uuv = (0..3)
            .fold(0.0, |most, i| (0..2).fold(most, |most, j| longest(most, 3.0 * (uu[i + 1][j] - uu[i][j]))));
        let uvv = (0..2)
            .fold(0.0, |most, i| (0..3).fold(most, |most, j| longest(most, 3.0 * (vv[i][j + 1] - vv[i][j]))));
        let vvv = (0..4).fold(0.0, |most, j| longest(most, vv[1][j] - vv[0][j]));
        Self { uu, uv, vv, third: [uuu, uuv, uvv, vvv] }
    }

    /// The polynomials in `u` at `v`.
    pub(crate) fn row(&self, v: f64) -> BendRow {
        let s = 1.0 - v;
        let [b0, b1, b2, b3] = crate::explicit::bernstein(v);
        let (c0, c1, c2) = (s * s, 2.0 * s * v, v * v);
        BendRow {
            uu: std::array::from_fn(|j| {
                (self.uu[0][j] * b0 + self.uu[1][j] * b1) + (self.uu[2][j] * b2 + self.uu[3][j] * b3)
            }),
            uv: std::array::from_fn(|j| self.uv[0][j] * c0 + self.uv[1][j] * c1 + self.uv[2][j] * c2),
            vv: std::array::from_fn(|j| self.vv[0][j] * s + self.vv[1][j] * v),
        }
    }

    /// The second derivatives at `(u, v)` of the part.
    pub(crate) fn at(&self, u: f64, v: f64) -> Hessian {
        self.row(v).at(u)
    }

    /// The remainder `R` for a triangle whose box is `du × dv`, when `H_c` is taken at the middle of the box.
    #[inline]
    pub(crate) fn remainder(&self, du: f64, dv: f64) -> f64 {
        let [uuu, uuv, uvv, vvv] = self.third;
        let (uu, uv, vv) = (du * uuu + dv * uuv, du * uuv + dv * uvv, du * uvv + dv * vvv);
        (du * du * uu + 2.0 * du * dv * uv + dv * dv * vv) * 0.0625
    }
}

impl BendRow {
    /// The second derivatives at `u`.
    #[inline]
    pub(crate) fn at(&self, u: f64) -> Hessian {
        let s = 1.0 - u;
        let [b0, b1, b2, b3] = crate::explicit::bernstein(u);
        Hessian {
            uu: self.uu[0] * s + self.uu[1] * u,
            uv: self.uv[0] * (s * s) + self.uv[1] * (2.0 * s * u) + self.uv[2] * (u * u),
            vv: (self.vv[0] * b0 + self.vv[1] * b1) + (self.vv[2] * b2 + self.vv[3] * b3),
        }
    }
}
