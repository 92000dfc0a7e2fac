//! `PatchGrid`: one patch at many parameters at once, bit-identical to evaluating one at a time.
//!
//! The kernels are loops over parameters in separate arrays. Their bodies are plain scalar code with the
//! operations of [`Patch::at`] and [`Patch::tangents`] in the same order. Without closures or iterators in
//! its body, such a loop is vectorized completely. Calling `Patch::at` in the loop was tried: it vectorized
//! or not (2 or 14 ns a point) depending on the compiler's inlining. Eight-wide arrays with operators were
//! tried: slower by 1.4 to 2.7 times.
use super::Patch;
use super::bezier::bernstein;
use super::patch::{front, largest};
use crate::math::lesser;
use crate::math::simd::{self, Isa, Kernel};

/// Parameters per block: enough to fill the widest registers, few enough to stay in the first-level cache.
const BLOCK: usize = 64;

/// A patch that is evaluated at many parameters on one instruction set. Results are bit-identical to
/// [`Patch::at`] and [`Patch::normal`] on every set.
///
/// ```
/// use chordal::Patch;
/// use chordal::explicit::parametric::PatchGrid;
/// let patch = Patch::flat([0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
/// let mut points = [[0.0; 3]; 2];
/// PatchGrid::new(&patch).points(&[[0.5, 0.5], [1.0, 0.0]], &mut points);
/// assert_eq!(points, [patch.at(0.5, 0.5), patch.at(1.0, 0.0)]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct PatchGrid<'a> {
    patch: &'a Patch,
    isa: Isa,
}

impl<'a> PatchGrid<'a> {
    /// Evaluates `patch` on the instruction set chosen by [`simd::isa`].
    #[must_use]
    pub fn new(patch: &'a Patch) -> Self {
        Self { patch, isa: simd::isa() }
    }

    /// The same patch on another instruction set, for tests.
    #[must_use]
    pub fn on(self, isa: Isa) -> Self {
        Self { isa, ..self }
    }

    /// `points[i] = patch.at(u, v)` for `uv[i] = [u, v]`.
    ///
    /// # Panics
    /// When `uv` and `points` differ in length.
    pub fn points(&self, uv: &[[f64; 2]], points: &mut [[f64; 3]]) {
        assert_eq!(uv.len(), points.len(), "one point for each parameter");
        simd::dispatch(self.isa, PatchPointsKernel { patch: self.patch, uv, points });
    }

    /// Like [`PatchGrid::points`], and `normals[i] = patch.normal(u, v)`.
    ///
    /// # Panics
    /// When `uv`, `points` and `normals` differ in length.
    pub fn points_and_normals(
        &self,
        uv: &[[f64; 2]],
        points: &mut [[f64; 3]],
        normals: &mut [Option<[f64; 3]>],
    ) {
        self.points(uv, points);
        assert_eq!(uv.len(), normals.len(), "one normal for each parameter");
        simd::dispatch(self.isa, PatchNormalsKernel { patch: self.patch, uv, normals });
    }
}

struct PatchPointsKernel<'a> {
    patch: &'a Patch,
    uv: &'a [[f64; 2]],
    points: &'a mut [[f64; 3]],
}

impl Kernel for PatchPointsKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { patch, uv, points } = self;
        for (uv, points) in uv.chunks(BLOCK).zip(points.chunks_mut(BLOCK)) {
            let [u, v] = side_by_side(uv);
            let (mut x, mut y, mut z) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
            for i in 0..BLOCK {
                [x[i], y[i], z[i]] = point(&patch.control, bernstein(u[i]), bernstein(v[i]));
            }
            for (i, point) in points.iter_mut().enumerate() {
                *point = [x[i], y[i], z[i]];
            }
        }
    }
}

struct PatchNormalsKernel<'a> {
    patch: &'a Patch,
    uv: &'a [[f64; 2]],
    normals: &'a mut [Option<[f64; 3]>],
}

impl Kernel for PatchNormalsKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { patch, uv, normals } = self;
        let shortest = patch.least_tangent();
        for (uv, normals) in uv.chunks(BLOCK).zip(normals.chunks_mut(BLOCK)) {
            let [u, v] = side_by_side(uv);
            let (mut x, mut y, mut z) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
            let (mut shorter, mut scale) = ([0.0; BLOCK], [0.0; BLOCK]);
            for i in 0..BLOCK {
                let (by_u, by_v) = tangents(&patch.control, u[i], v[i]);
                ([x[i], y[i], z[i]], scale[i]) = front(by_u, by_v);
                let (a, b) = (largest(by_u), largest(by_v));
                shorter[i] = lesser(a, b);
            }
            for (i, normal) in normals.iter_mut().enumerate() {
                // Only the regular case is handled here; `patch.normal` handles all others, NaN included.
                let plain = shorter[i] > shortest && scale[i] > 0.0 && scale[i] < f64::INFINITY;
                *normal = if plain { Some([x[i], y[i], z[i]]) } else { patch.normal(u[i], v[i]) };
            }
        }
    }
}

/// Up to [`BLOCK`] parameters as separate arrays, padded with zeros whose results are discarded.
#[inline(always)]
fn side_by_side(uv: &[[f64; 2]]) -> [[f64; BLOCK]; 2] {
    let (mut us, mut vs) = ([0.0; BLOCK], [0.0; BLOCK]);
    for (i, [u, v]) in uv.iter().enumerate() {
        (us[i], vs[i]) = (*u, *v);
    }
    [us, vs]
}

type PatchControl = [[[f64; 3]; 4]; 4];

/// `Σ w_i·p_i`, in the order of [`super::Bezier::at`].
#[inline(always)]
fn blend(w: [f64; 4], p: [f64; 4]) -> f64 {
    (w[0] * p[0] + w[1] * p[1]) + (w[2] * p[2] + w[3] * p[3])
}

/// Coordinate `k` of row `i` as a curve in `u`.
#[inline(always)]
fn row(c: &PatchControl, [i, k]: [usize; 2], w: [f64; 4]) -> f64 {
    blend(w, [c[i][0][k], c[i][1][k], c[i][2][k], c[i][3][k]])
}

/// Coordinate `k` of column `j` as a curve in `v`.
#[inline(always)]
fn column(c: &PatchControl, [j, k]: [usize; 2], w: [f64; 4]) -> f64 {
    blend(w, [c[0][j][k], c[1][j][k], c[2][j][k], c[3][j][k]])
}

/// Coordinate `k` of the point, from the weights in `u` and in `v`.
#[inline(always)]
fn coordinate(c: &PatchControl, k: usize, [u, v]: [[f64; 4]; 2]) -> f64 {
    blend(v, [row(c, [0, k], u), row(c, [1, k], u), row(c, [2, k], u), row(c, [3, k], u)])
}

#[inline(always)]
fn point(c: &PatchControl, u: [f64; 4], v: [f64; 4]) -> [f64; 3] {
    [coordinate(c, 0, [u, v]), coordinate(c, 1, [u, v]), coordinate(c, 2, [u, v])]
}

/// The weights of the differences in the first derivative, as in [`super::Bezier::tangent`].
#[inline(always)]
fn slopes(t: f64) -> [f64; 3] {
    let s = 1.0 - t;
    [3.0 * s * s, 6.0 * s * t, 3.0 * t * t]
}

#[inline(always)]
fn slope(w: [f64; 3], p: [f64; 4]) -> f64 {
    w[0] * (p[1] - p[0]) + w[1] * (p[2] - p[1]) + w[2] * (p[3] - p[2])
}

/// Coordinate `k` of the derivative by `u`, from its slopes and the weights in `v`.
#[inline(always)]
fn slope_u(c: &PatchControl, k: usize, (u, v): ([f64; 3], [f64; 4])) -> f64 {
    slope(u, [column(c, [0, k], v), column(c, [1, k], v), column(c, [2, k], v), column(c, [3, k], v)])
}

/// Coordinate `k` of the derivative by `v`, from the weights in `u` and its slopes.
#[inline(always)]
fn slope_v(c: &PatchControl, k: usize, (u, v): ([f64; 4], [f64; 3])) -> f64 {
    slope(v, [row(c, [0, k], u), row(c, [1, k], u), row(c, [2, k], u), row(c, [3, k], u)])
}

#[inline(always)]
fn tangents(c: &PatchControl, u: f64, v: f64) -> ([f64; 3], [f64; 3]) {
    let (for_u, for_v) = ((slopes(u), bernstein(v)), (bernstein(u), slopes(v)));
    (
        [slope_u(c, 0, for_u), slope_u(c, 1, for_u), slope_u(c, 2, for_u)],
        [slope_v(c, 0, for_v), slope_v(c, 1, for_v), slope_v(c, 2, for_v)],
    )
}
