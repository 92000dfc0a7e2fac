//! `Patch`: one bicubic Bézier patch.
use super::Bezier;
use super::bezier::{bernstein, lerp};
use crate::math::{Box3, greater};
use std::cmp::Ordering;

/// A bicubic Bézier patch: `S(u, v) = Σ B_i(v)·B_j(u)·control[i][j]`, with `u` along a row and `v` from row
/// to row.
///
/// Its front is the side that `S_u × S_v` points to.
///
/// ```
/// use chordal::Patch;
/// let patch = Patch::flat([0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
/// assert_eq!(patch.at(0.5, 0.5), [1.0, 0.5, 0.0]);
/// assert_eq!(patch.normal(0.5, 0.5), Some([0.0, 0.0, 1.0]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Four rows of four control points.
    pub control: [[[f64; 3]; 4]; 4],
}

/// One of the four boundary curves of a patch, in their order around its front.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PatchSide {
    /// `v = 0`, from `u = 0` to 1.
    Bottom,
    /// `u = 1`, from `v = 0` to 1.
    Right,
    /// `v = 1`, from `u = 1` to 0.
    Top,
    /// `u = 0`, from `v = 1` to 0.
    Left,
}

impl PatchSide {
    /// All four, counter-clockwise.
    pub const ALL: [Self; 4] = [Self::Bottom, Self::Right, Self::Top, Self::Left];

    /// `(u, v)` of the patch at the parameter `t` of the side, which runs counter-clockwise.
    #[must_use]
    pub fn uv(self, t: f64) -> [f64; 2] {
        match self {
            Self::Bottom => [t, 0.0],
            Self::Right => [1.0, t],
            Self::Top => [1.0 - t, 1.0],
            Self::Left => [0.0, 1.0 - t],
        }
    }
}

impl Patch {
    /// The flat, uniformly parametrized patch with corner `origin` and sides `along_u` and `along_v`.
    #[must_use]
    pub fn flat(origin: [f64; 3], along_u: [f64; 3], along_v: [f64; 3]) -> Self {
        let point = |i: usize, j: usize, k: usize| {
            origin[k] + along_u[k] * (j as f64 / 3.0) + along_v[k] * (i as f64 / 3.0)
        };
        Self {
            control: std::array::from_fn(|i| {
                std::array::from_fn(|j| std::array::from_fn(|k| point(i, j, k)))
            }),
        }
    }

    /// The point at `(u, v)` by the Bernstein form.
    #[inline]
    #[must_use]
    pub fn at(&self, u: f64, v: f64) -> [f64; 3] {
        self.combine(&bernstein(u), &bernstein(v))
    }

    /// The point at `(u, v)` by repeated linear interpolation: the oracle of [`Patch::at`].
    #[must_use]
    pub fn at_de_casteljau(&self, u: f64, v: f64) -> [f64; 3] {
        Bezier { control: self.control.map(|row| Bezier { control: row }.de_casteljau(u).point) }
            .de_casteljau(v)
            .point
    }

    fn combine(&self, along_u: &[f64; 4], along_v: &[f64; 4]) -> [f64; 3] {
        // `patch_grid.rs` repeats these operations in the same order, so that both give the same
        // bits: a change here needs one there.
        std::array::from_fn(|k| {
            let row = |r: &[[f64; 3]; 4]| {
                (along_u[0] * r[0][k] + along_u[1] * r[1][k]) + (along_u[2] * r[2][k] + along_u[3] * r[3][k])
            };
            let c = &self.control;
            (along_v[0] * row(&c[0]) + along_v[1] * row(&c[1]))
                + (along_v[2] * row(&c[2]) + along_v[3] * row(&c[3]))
        })
    }

    /// The derivatives by `u` and by `v` at `(u, v)`.
    #[must_use]
    pub fn tangents(&self, u: f64, v: f64) -> [[f64; 3]; 2] {
        let across = |t: f64, line: [[f64; 3]; 4]| Bezier { control: line }.at(t);
        let columns: [[[f64; 3]; 4]; 4] =
            std::array::from_fn(|j| std::array::from_fn(|i| self.control[i][j]));
        let by_u = Bezier { control: columns.map(|column| across(v, column)) }.tangent(u);
        let by_v = Bezier { control: self.control.map(|row| across(u, row)) }.tangent(v);
        [by_u, by_v]
    }

    /// The second derivatives `S_uu`, `S_uv`, `S_vv` at `(u, v)`.
    #[must_use]
    pub fn second_derivatives(&self, u: f64, v: f64) -> [[f64; 3]; 3] {
        let rows = |f: &dyn Fn(Bezier<3>) -> [f64; 3]| Bezier {
            control: self.control.map(|row| f(Bezier { control: row })),
        };
        [
            rows(&|row| row.second_derivative(u)).at(v),
            rows(&|row| row.tangent(u)).tangent(v),
            rows(&|row| row.at(u)).second_derivative(v),
        ]
    }

    /// The unit normal of the front at `(u, v)`; at a pole, where one tangent vanishes, its limit from inside
    /// the patch. `None` if both tangents vanish or are parallel.
    #[must_use]
    pub fn normal(&self, u: f64, v: f64) -> Option<[f64; 3]> {
        let [by_u, by_v] = self.tangents(u, v);
        let shortest = self.least_tangent();
        let vanishes = |tangent| largest(tangent) <= shortest;
        let mixed = || self.second_derivatives(u, v)[1];
        // Away from the pole into the patch, S_u grows like ±(v − v0)·S_uv (and S_v like ±(u − u0)·S_uv).
        let inward = |t: f64| if t > 0.5 { -1.0 } else { 1.0 };
        let (unit, scale) = match (vanishes(by_u), vanishes(by_v)) {
            (false, false) => front(by_u, by_v),
            (true, false) => front(mixed().map(|x| inward(v) * x), by_v),
            (false, true) => front(by_u, mixed().map(|x| inward(u) * x)),
            (true, true) => return None,
        };
        (scale > 0.0 && scale.is_finite()).then_some(unit)
    }

    /// A tangent shorter than this is its own rounding error and has no direction: 16 products and sums of
    /// the patch's size.
    pub(super) fn least_tangent(&self) -> f64 {
        64.0 * f64::EPSILON * self.size()
    }

    /// The tensor-product blossom, with three arguments for each of `u` and `v`.
    #[must_use]
    pub fn blossom(&self, u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
        let column = self.control.map(|row| Bezier { control: row }.blossom(u[0], u[1], u[2]));
        Bezier { control: column }.blossom(v[0], v[1], v[2])
    }

    /// The part over `[u0, u1] × [v0, v1]`, reparametrized to the unit square.
    #[must_use]
    pub fn part(&self, [u0, u1]: [f64; 2], [v0, v1]: [f64; 2]) -> Self {
        let rows = self.control.map(|row| Bezier { control: row }.part(u0, u1).control);
        let columns: [[[f64; 3]; 4]; 4] = std::array::from_fn(|j| {
            Bezier { control: std::array::from_fn(|i| rows[i][j]) }.part(v0, v1).control
        });
        Self { control: std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i])) }
    }

    /// The halves left and right of the middle, split in `u`.
    #[must_use]
    pub fn halves_u(&self) -> [Self; 2] {
        let split = self.control.map(|row| Bezier { control: row }.split(0.5));
        [0, 1].map(|half| Self { control: split.map(|row| row[half].control) })
    }

    /// The halves below and above the middle, split in `v`.
    #[must_use]
    pub fn halves_v(&self) -> [Self; 2] {
        let c = &self.control;
        let middle = |a: &[[f64; 3]; 4], b: &[[f64; 3]; 4]| std::array::from_fn(|j| lerp(a[j], b[j], 0.5));
        let first: [[[f64; 3]; 4]; 3] = [middle(&c[0], &c[1]), middle(&c[1], &c[2]), middle(&c[2], &c[3])];
        let second = [middle(&first[0], &first[1]), middle(&first[1], &first[2])];
        let point = middle(&second[0], &second[1]);
        [
            Self { control: [c[0], first[0], second[0], point] },
            Self { control: [point, second[1], first[2], c[3]] },
        ]
    }

    /// The boundary curve of a side, in the direction of [`PatchSide`].
    #[must_use]
    pub fn side(&self, side: PatchSide) -> Bezier<3> {
        let c = &self.control;
        let control = match side {
            PatchSide::Bottom => c[0],
            PatchSide::Right => [c[0][3], c[1][3], c[2][3], c[3][3]],
            PatchSide::Top => [c[3][3], c[3][2], c[3][1], c[3][0]],
            PatchSide::Left => [c[3][0], c[2][0], c[1][0], c[0][0]],
        };
        Bezier { control }
    }

    /// The same patch, turned so that `side` is its bottom. Its front stays.
    ///
    /// ```
    /// use chordal::Patch;
    /// use chordal::explicit::parametric::PatchSide;
    /// let patch = Patch::flat([0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    /// let turned = patch.turned(PatchSide::Right);
    /// assert_eq!(turned.side(PatchSide::Bottom), patch.side(PatchSide::Right));
    /// assert_eq!(turned.normal(0.5, 0.5), patch.normal(0.5, 0.5));
    /// ```
    #[must_use]
    pub fn turned(&self, side: PatchSide) -> Self {
        let c = &self.control;
        let point = |row: usize, k: usize| match side {
            PatchSide::Bottom => c[row][k],
            PatchSide::Right => c[k][3 - row],
            PatchSide::Top => c[3 - row][3 - k],
            PatchSide::Left => c[3 - k][row],
        };
        Self { control: std::array::from_fn(|row| std::array::from_fn(|k| point(row, k))) }
    }

    /// The bounding box of the control points, which contains the patch.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        Box3::from_points(self.control.iter().flatten())
    }

    /// The largest absolute coordinate of the control points.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.control.iter().flatten().flatten().fold(0.0, |largest, x| greater(x.abs(), largest))
    }

    /// Whether every coordinate is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.control.iter().flatten().flatten().all(|x| x.is_finite())
    }
}

/// The unit vector along `a × b`, and the largest coordinate of the product. The vector is valid only when
/// that coordinate is > 0 and finite.
#[inline(always)]
pub(super) fn front(a: [f64; 3], b: [f64; 3]) -> ([f64; 3], f64) {
    let cross = [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]];
    // Scale first, so that the squares do not underflow for tiny patches.
    let scale = largest(cross);
    let [x, y, z] = [cross[0] / scale, cross[1] / scale, cross[2] / scale];
    let inverse = 1.0 / (x * x + y * y + z * z).sqrt();
    ([x * inverse, y * inverse, z * inverse], scale)
}

/// The largest absolute value.
#[inline(always)]
pub(super) fn largest([x, y, z]: [f64; 3]) -> f64 {
    greater(x.abs(), greater(y.abs(), z.abs()))
}

/// A side of a sheet that equals or contains a shared curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PatchEdgeUse {
    pub(crate) sheet: u32,
    pub(crate) side: PatchSide,
    /// Whether the side runs against the curve.
    pub(crate) reversed: bool,
}

/// For each curve, the sides that equal it: their four control points are equal bit for bit, forwards or
/// backwards. Sides that are single points are left out. In the order of the first use of each curve.
///
/// By sorting: O(n log n) for n patches.
pub(crate) fn shared_sides(patches: &[Patch]) -> Vec<Vec<PatchEdgeUse>> {
    let mut sides: Vec<(Bezier<3>, PatchEdgeUse)> = Vec::with_capacity(4 * patches.len());
    for (patch, shape) in patches.iter().enumerate() {
        for side in PatchSide::ALL {
            let curve = shape.side(side);
            if curve.is_point() {
                continue;
            }
            // The smaller of the two directions stands for both.
            let back = curve.reversed();
            let reversed = compare(&back, &curve) == Ordering::Less;
            let used = PatchEdgeUse { sheet: patch as u32, side, reversed };
            sides.push((if reversed { back } else { curve }, used));
        }
    }
    sides.sort_by(|a, b| compare(&a.0, &b.0).then((a.1.sheet, a.1.side).cmp(&(b.1.sheet, b.1.side))));
    let runs = sides.chunk_by(|a, b| compare(&a.0, &b.0) == Ordering::Equal);
    let mut edges: Vec<Vec<PatchEdgeUse>> = runs.map(|run| run.iter().map(|f| f.1).collect()).collect();
    // In the order of the input, so that vertices are numbered in file order.
    edges.sort_by_key(|uses| (uses[0].sheet, uses[0].side));
    edges
}

fn compare(a: &Bezier<3>, b: &Bezier<3>) -> Ordering {
    let (a, b) = (a.control.as_flattened(), b.control.as_flattened());
    a.iter().zip(b).map(|(x, y)| x.total_cmp(y)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
}
