//! `Quartic`: a polynomial of degree four over a triangle, given by its Bézier control points.
use super::super::vertex_rule::CagePoint;

/// The control points in rows along u: those of row k belong to `(j/4, k/4)`, so that 0, 4 and 14 are the
/// corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quartic {
    pub control: [CagePoint; 15],
}

/// Barycentric coordinates in a triangle.
pub(crate) type QuarticBarycentric = [f64; 3];

/// Position, first derivatives and second derivatives.
pub(crate) type QuarticJet = (CagePoint, [CagePoint; 2], [CagePoint; 3]);

impl Quartic {
    pub fn at(&self, u: f64, v: f64) -> QuarticJet {
        let w = [1.0 - u - v, u, v];
        let cubic: [CagePoint; 10] = lower(&self.control, 4, w);
        let q: [CagePoint; 6] = lower(&cubic, 3, w);
        let p: [CagePoint; 3] = lower(&q, 2, w);
        let [point]: [CagePoint; 1] = lower(&p, 1, w);
        let first = [1, 2].map(|i| [0, 1, 2].map(|k| 4.0 * (p[i][k] - p[0][k])));
        let second = |a: usize, b: usize, c: usize, d: usize| {
            [0, 1, 2].map(|k| 12.0 * ((q[a][k] - q[b][k]) - (q[c][k] - q[d][k])))
        };
        (point, first, [second(2, 1, 1, 0), second(4, 1, 3, 0), second(5, 3, 3, 0)])
    }

    pub fn point(&self, [u, v]: [f64; 2]) -> CagePoint {
        self.at(u, v).0
    }

    /// The same surface over the triangle between three parameter points.
    pub fn part(&self, corners: [[f64; 2]; 3]) -> Self {
        let [a, b, c] = corners.map(|[u, v]| [1.0 - u - v, u, v]);
        // The control point of `aⁱbʲcᵏ` is the blossom at these arguments.
        let cubic = |w: QuarticBarycentric| -> [CagePoint; 10] { lower(&self.control, 4, w) };
        let (of_a, of_b, of_c) = (cubic(a), cubic(b), cubic(c));
        let square = |net: &[CagePoint; 10], w: QuarticBarycentric| -> [CagePoint; 6] { lower(net, 3, w) };
        let (aa, ab, ac) = (square(&of_a, a), square(&of_a, b), square(&of_a, c));
        let (bb, bc, cc) = (square(&of_b, b), square(&of_b, c), square(&of_c, c));
        let line = |net: &[CagePoint; 6], w: QuarticBarycentric| -> [CagePoint; 3] { lower(net, 2, w) };
        let linear = |net: [CagePoint; 3], w: QuarticBarycentric| lower::<3, 1>(&net, 1, w)[0];
        let (aaa, aab, aac) = (line(&aa, a), line(&aa, b), line(&aa, c));
        let (abb, abc, acc) = (line(&ab, b), line(&ab, c), line(&ac, c));
        let (bbb, bbc, bcc, ccc) = (line(&bb, b), line(&bb, c), line(&bc, c), line(&cc, c));
        let control = [
            linear(aaa, a),
            linear(aaa, b),
            linear(aab, b),
            linear(abb, b),
            linear(bbb, b),
            linear(aaa, c),
            linear(aab, c),
            linear(abb, c),
            linear(bbb, c),
            linear(aac, c),
            linear(abc, c),
            linear(bbc, c),
            linear(acc, c),
            linear(bcc, c),
            linear(ccc, c),
        ];
        Self { control }
    }

    /// The four parts between its corners and the midpoints of its sides: those at the corners, then the
    /// central one, rotated by half a turn.
    pub fn quarters(&self) -> [Self; 4] {
        QUARTERS.map(|corners| self.part(corners))
    }

    /// The control points of a side: from the first corner to the second, from the second to the third, or
    /// from the third to the first.
    pub fn side(&self, side: usize) -> [CagePoint; 5] {
        SIDES[side].map(|k| self.control[k])
    }
}

const SIDES: [[usize; 5]; 3] = [[0, 1, 2, 3, 4], [4, 8, 11, 13, 14], [14, 12, 9, 5, 0]];

/// The corners of the quarters of a triangle. Those at its corners have its orientation; the last one is
/// rotated by half a turn.
pub(crate) const QUARTERS: [[[f64; 2]; 3]; 4] = [
    [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]],
    [[0.5, 0.0], [1.0, 0.0], [0.5, 0.5]],
    [[0.0, 0.5], [0.5, 0.5], [0.0, 1.0]],
    [[0.5, 0.5], [0.0, 0.5], [0.5, 0.0]],
];

/// A step of de Casteljau's scheme, from `N` control points of degree `degree` to `M` of the next lower one.
fn lower<const N: usize, const M: usize>(
    net: &[CagePoint; N],
    degree: usize,
    w: QuarticBarycentric,
) -> [CagePoint; M] {
    let mut out = [[0.0; 3]; M];
    let (mut from, mut to) = (0, 0);
    for row in 0..degree {
        let above = from + degree + 1 - row;
        for j in 0..degree - row {
            let (a, b, c) = (net[from + j], net[from + j + 1], net[above + j]);
            out[to] = [0, 1, 2].map(|k| w[0] * a[k] + (w[1] * b[k] + w[2] * c[k]));
            to += 1;
        }
        from = above;
    }
    out
}
