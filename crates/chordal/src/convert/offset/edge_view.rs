//! Whether the triangles around a crossed edge stay between its ends, so that they cross no others.

/// Points around an edge, seen along it.
pub(super) struct EdgeView {
    axis: usize,
    low: [f64; 3],
    high: f64,
    /// Whether polygons run clockwise.
    is_reversed: bool,
}

impl EdgeView {
    pub fn new([low, high]: [[f64; 3]; 2], axis: usize, is_reversed: bool) -> Self {
        Self { axis, low, high: high[axis], is_reversed }
    }

    /// The coordinates across the edge, and the height along it.
    fn seen(&self, p: [f64; 3]) -> ([f64; 2], f64) {
        let (u, w) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        ([p[u] - self.low[u], p[w] - self.low[w]], p[self.axis])
    }

    fn turn(&self, a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if self.is_reversed { -area } else { area }
    }

    /// The height at which a triangle meets the edge's line, if it does.
    fn height(&self, triangle: [[f64; 3]; 3]) -> Option<f64> {
        let [(a, x), (b, y), (c, z)] = triangle.map(|p| self.seen(p));
        let weights = [self.turn([0.0; 2], b, c), self.turn([0.0; 2], c, a), self.turn([0.0; 2], a, b)];
        let sum: f64 = weights.iter().sum();
        if sum <= 0.0 || weights.iter().any(|weight| *weight < 0.0) {
            return None;
        }
        Some((weights[0] * x + weights[1] * y + weights[2] * z) / sum)
    }

    fn is_between(&self, height: f64) -> bool {
        height > self.low[self.axis] && height < self.high
    }

    /// Whether a triangle meets the edge between its ends.
    pub fn holds(&self, triangle: [[f64; 3]; 3]) -> bool {
        self.height(triangle).is_some_and(|height| self.is_between(height))
    }

    /// Whether the two triangles of a quad, cut from its first to its third corner, stay within the tetrahedra of the
    /// edge and each side of the quad: they face one way, one of them meets the edge between its ends, and the diagonal
    /// is between the tetrahedra's sides where it passes the corner that is not in that triangle.
    pub fn holds_quad(&self, quad: [[f64; 3]; 4]) -> bool {
        let [(a, x), (b, y), (c, z), (d, w)] = quad.map(|p| self.seen(p));
        if self.turn(a, b, c) <= 0.0 || self.turn(a, c, d) <= 0.0 {
            return false;
        }
        let (height, (across, across_height)) = match self.height([quad[0], quad[1], quad[2]]) {
            Some(height) => (height, (d, w)),
            None => match self.height([quad[0], quad[2], quad[3]]) {
                Some(height) => (height, (b, y)),
                None => return false,
            },
        };
        if !self.is_between(height) {
            return false;
        }
        // Where the ray from the edge to that corner meets the diagonal: at `s` of the way to the corner, and at
        // `t` of the diagonal.
        let along = [c[0] - a[0], c[1] - a[1]];
        let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
        let base = cross(across, along);
        if base == 0.0 {
            return false;
        }
        let (s, t) = (cross(a, along) / base, cross(a, across) / base);
        if !(0.0..=1.0).contains(&s) || !(0.0..=1.0).contains(&t) {
            return false;
        }
        let diagonal = x + t * (z - x);
        let side = |end: f64| end + s * (across_height - end);
        diagonal >= side(self.low[self.axis]) && diagonal <= side(self.high)
    }
}
