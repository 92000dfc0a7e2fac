//! `RasterTriangle`: a fixed-point triangle on the screen and the pixel centres that it covers, exact in
//! integers.
//!
//! With corners up to `MOST` steps from the origin, differences are below 1.5 · 2³⁰, and an edge function,
//! two of their products, is below 4.5 · 2⁶⁰ < 2⁶³.

/// Steps along the side of a pixel: 8 sub-pixel bits, as Direct3D requires
/// (`D3D12_SUBPIXEL_FRACTIONAL_BIT_COUNT`).
pub(super) const STEPS: i64 = 256;
/// The largest coordinate, in steps: the guard band of 2²¹ pixels and half a screen of 2²⁰, with a margin.
pub(super) const MOST: f64 = 1.5 * (1_u64 << 29) as f64;

/// A corner on the screen.
#[derive(Clone, Copy, Debug)]
pub(super) struct RasterVertex {
    /// Columns and rows in steps, from the top left of the screen.
    pub at: [i32; 2],
    /// Larger is nearer to the eye, and linear on the screen; NaN for a vertex out of range, which has no
    /// position.
    pub nearness: f64,
}

/// A triangle with area.
pub(super) struct RasterTriangle {
    edges: [EdgeFunction; 3],
    /// The nearness at the start corner of each edge.
    nearness: [f64; 3],
    /// Twice the area in squared steps, > 0.
    pub area: i64,
    /// Whether it appears counter-clockwise.
    pub front: bool,
    /// Columns and rows whose centres lie in its bounding box: first, and one past the last.
    columns: [i64; 2],
    pub rows: [i64; 2],
}

/// An edge function: a line through a corner; it is positive inside the triangle.
#[derive(Clone, Copy)]
struct EdgeFunction {
    from: [i64; 2],
    run: [i64; 2],
}

impl EdgeFunction {
    fn new(from: [i64; 2], to: [i64; 2]) -> Self {
        Self { from, run: [to[0] - from[0], to[1] - from[1]] }
    }

    fn at(&self, [x, y]: [i64; 2]) -> i64 {
        self.run[0] * (y - self.from[1]) - self.run[1] * (x - self.from[0])
    }

    /// The top-left rule: a centre on the line belongs to the triangle if the line is a left one (the
    /// inside is at its right) or a horizontal one at the top (the inside is below). Rows run down.
    fn is_top_left(&self) -> bool {
        self.run[1] < 0 || (self.run[1] == 0 && self.run[0] > 0)
    }
}

impl RasterTriangle {
    /// The triangle relative to pixel centres moved by `shift`, in steps; `None` without area.
    pub fn new(spots: &[RasterVertex; 3], shift: [i64; 2]) -> Option<Self> {
        let corner_at = |k: usize| [0, 1].map(|axis| i64::from(spots[k].at[axis]) - shift[axis]);
        // Exact, see the top of the file. Rows run downwards on the screen, so the sign is opposite
        // to that in space.
        let signed = EdgeFunction::new(corner_at(0), corner_at(1)).at(corner_at(2));
        // The inside is positive if the corners appear clockwise.
        let order = if signed < 0 { [0, 2, 1] } else { [0, 1, 2] };
        let corners = order.map(corner_at);
        let range = |axis: usize| {
            let values = corners.map(|c| c[axis]);
            let (low, high) =
                (values[0].min(values[1]).min(values[2]), values[0].max(values[1]).max(values[2]));
            // Centres are half a pixel after each pixel's start.
            [(low + STEPS / 2 - 1).div_euclid(STEPS), (high - STEPS / 2).div_euclid(STEPS) + 1]
        };
        (signed != 0).then(|| Self {
            edges: [0, 1, 2].map(|k| EdgeFunction::new(corners[k], corners[(k + 1) % 3])),
            nearness: order.map(|k| spots[k].nearness),
            area: signed.abs(),
            front: signed < 0,
            columns: range(0),
            rows: range(1),
        })
    }

    /// The columns whose centres the triangle covers in a row: first, and one past the last; equal if
    /// there are none.
    pub fn span(&self, row: i64) -> [i64; 2] {
        let [mut first, mut end] = self.columns;
        for edge in &self.edges {
            let at_zero = edge.at([STEPS / 2, row * STEPS + STEPS / 2]);
            // Inside if `slack − step·column ≥ 0`.
            let (slack, step) = (at_zero - i64::from(!edge.is_top_left()), edge.run[1] * STEPS);
            if step > 0 {
                // Columns up to ⌊slack / step⌋, and from ⌈slack / step⌉ for a negative step; both
                // divisions round down, so the second one is negated twice.
                end = end.min(slack.div_euclid(step) + 1);
            } else if step < 0 {
                first = first.max(-slack.div_euclid(-step));
            } else if slack < 0 {
                end = first;
            }
        }
        [first, end.max(first)]
    }

    /// The same, clipped to a screen of that width.
    pub fn span_within(&self, row: i64, width: i64) -> [i64; 2] {
        let [first, end] = self.span(row);
        let first = first.max(0);
        [first, end.min(width).max(first)]
    }

    /// The nearness at the centre of a pixel.
    pub fn nearness(&self, [column, row]: [i64; 2]) -> f64 {
        let centre = [column * STEPS + STEPS / 2, row * STEPS + STEPS / 2];
        let [n0, n1, n2] = self.nearness;
        let (w1, w2) = (self.edges[2].at(centre) as f64, self.edges[0].at(centre) as f64);
        n0 + (w1 * (n1 - n0) + w2 * (n2 - n0)) / self.area as f64
    }

    /// Whether it has a point in common with a screen of that size in pixels.
    pub fn meets(&self, size: [i64; 2]) -> bool {
        let [width, height] = size.map(|n| n * STEPS);
        self.edges.iter().all(|edge| {
            // The corner of the screen where the function is largest.
            let far = [if edge.run[1] < 0 { width } else { 0 }, if edge.run[0] > 0 { height } else { 0 }];
            edge.at(far) >= 0
        })
    }
}

/// Whether the bounding box of three corners meets a screen of that size in pixels.
pub(super) fn box_meets(spots: &[RasterVertex; 3], size: [i64; 2]) -> bool {
    (0..2).all(|axis| {
        let values = spots.map(|spot| i64::from(spot.at[axis]));
        values.iter().any(|x| *x >= 0) && values.iter().any(|x| *x <= size[axis] * STEPS)
    })
}

/// The runs of quads, as first columns and one past the last, that two spans in the rows of one pair touch;
/// they have no quad in common.
pub(super) fn quad_runs(spans: [[i64; 2]; 2]) -> [[i64; 2]; 2] {
    let runs = spans.map(|[first, end]| if first < end { [first / 2, (end + 1) / 2] } else { [0, 0] });
    let [[a, b], [c, d]] = runs;
    if a == b || c == d || b < c || d < a { runs } else { [[a.min(c), b.max(d)], [0, 0]] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spots(corners: [[i32; 2]; 3]) -> [RasterVertex; 3] {
        corners.map(|at| RasterVertex { at, nearness: 1.0 })
    }

    #[test]
    fn the_largest_coordinates_stay_in_range() {
        let m = MOST as i32;
        let corners = [[-m, -m], [m, -m], [m, m], [-m, m]];
        for k in 0..4 {
            let triangle =
                RasterTriangle::new(&spots([0, 1, 2].map(|j| corners[(k + j) % 4])), [0, 0]).unwrap();
            assert_eq!(triangle.area, (2 * i64::from(m)).pow(2));
            let row = [-m, 0, m].map(|y| triangle.span(i64::from(y) / STEPS));
            assert!(row[1][0] < row[1][1]);
        }
    }

    #[test]
    fn runs_of_a_pair_of_rows_share_no_quad() {
        assert_eq!(quad_runs([[0, 4], [4, 8]]), [[0, 4], [0, 0]]);
        assert_eq!(quad_runs([[1, 3], [7, 9]]), [[0, 2], [3, 5]]);
        assert_eq!(quad_runs([[3, 4], [2, 3]]), [[1, 2], [0, 0]]);
        assert_eq!(quad_runs([[5, 5], [2, 3]]), [[0, 0], [1, 2]]);
    }

    #[test]
    fn a_triangle_beside_the_screen_does_not_meet_it_though_its_box_does() {
        let step = STEPS as i32;
        let beside = spots([[14 * step, -5 * step], [14 * step, 14 * step], [-5 * step, 14 * step]]);
        assert!(box_meets(&beside, [8, 8]) && RasterTriangle::new(&beside, [0, 0]).unwrap().meets([8, 8]));
        assert!(box_meets(&beside, [4, 4]) && !RasterTriangle::new(&beside, [0, 0]).unwrap().meets([4, 4]));
    }
}
