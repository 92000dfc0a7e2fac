//! `Quadric`: the weighted sum of squared distances to a set of planes, as a function of the point.
use crate::math::{dot, greater};

/// `p·A·p + 2 b·p + c`: the cost of a point by its distances from the planes.
///
/// Source: M. Garland, P. Heckbert, *Surface simplification using quadric error metrics*, 1997; weights by
/// area and the planes along borders: M. Garland, *Quadric-based polygonal surface simplification*, 1999.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Quadric {
    /// xx, yy, zz, xy, xz, yz of the symmetric matrix.
    a: [f64; 6],
    b: [f64; 3],
    c: f64,
}

/// The weight that pulls the best point to the middle of an edge, as a fraction of the trace: where planes
/// leave a direction open, the middle decides. Measured on a torus and on scanned shapes: a hundred times
/// more or less makes no noticeable difference. Small, so that planes of little weight still decide.
const PULL: f64 = 1e-6;

impl Quadric {
    /// The quadric of one plane through `p` with a unit `normal`.
    #[inline]
    pub fn from_plane(normal: [f64; 3], p: [f64; 3], weight: f64) -> Self {
        let [x, y, z] = normal;
        let d = -dot(normal, p);
        let w = normal.map(|n| n * weight);
        Self {
            a: [w[0] * x, w[1] * y, w[2] * z, w[0] * y, w[0] * z, w[1] * z],
            b: w.map(|n| n * d),
            c: weight * d * d,
        }
    }

    #[inline]
    pub fn add(&mut self, other: &Self) {
        for k in 0..6 {
            self.a[k] += other.a[k];
        }
        for k in 0..3 {
            self.b[k] += other.b[k];
        }
        self.c += other.c;
    }

    #[inline]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        sum.add(other);
        sum
    }

    /// The sum of the weights of all planes.
    #[inline]
    pub fn weight(&self) -> f64 {
        self.a[0] + self.a[1] + self.a[2]
    }

    /// Half the gradient at a point.
    #[inline]
    fn half_gradient(&self, p: [f64; 3]) -> [f64; 3] {
        let [xx, yy, zz, xy, xz, yz] = self.a;
        [
            xx * p[0] + xy * p[1] + xz * p[2] + self.b[0],
            xy * p[0] + yy * p[1] + yz * p[2] + self.b[1],
            xz * p[0] + yz * p[1] + zz * p[2] + self.b[2],
        ]
    }

    /// The value at a point, never below 0.
    #[inline]
    pub fn at(&self, p: [f64; 3]) -> f64 {
        // p·A·p + 2 b·p + c = (A·p + b)·p + b·p + c, which rounding may make negative.
        let g = self.half_gradient(p);
        let value = dot(g, p) + dot(self.b, p) + self.c;
        greater(value, 0.0)
    }

    /// The point near `middle` with the least value, and that value. In directions that the planes leave
    /// open, it stays close to `middle`.
    #[inline]
    pub fn minimizer(&self, middle: [f64; 3]) -> ([f64; 3], f64) {
        let [xx, yy, zz, xy, xz, yz] = self.a;
        let pull = PULL * (xx + yy + zz);
        let (x, y, z) = (xx + pull, yy + pull, zz + pull);
        // The adjugate of the matrix, which is positive definite because of the pull, unless everything is 0.
        let (m00, m01, m02) = (y * z - yz * yz, xz * yz - xy * z, xy * yz - xz * y);
        let (m11, m12, m22) = (x * z - xz * xz, xy * xz - x * yz, x * y - xy * xy);
        let det = x * m00 + xy * m01 + xz * m02;
        if det.is_nan() || det <= 0.0 {
            return (middle, self.at(middle));
        }
        let over = -1.0 / det;
        let step = |from: [f64; 3]| -> [f64; 3] {
            let g = self.half_gradient(from);
            [
                from[0] + (m00 * g[0] + m01 * g[1] + m02 * g[2]) * over,
                from[1] + (m01 * g[0] + m11 * g[1] + m12 * g[2]) * over,
                from[2] + (m02 * g[0] + m12 * g[1] + m22 * g[2]) * over,
            ]
        };
        // Repeated, so that the pull leaves almost no distance to the point where the planes do meet.
        let p = step(step(step(middle)));
        if p.iter().any(|x| !x.is_finite()) {
            return (middle, self.at(middle));
        }
        (p, self.at(p))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_meet_in_the_best_point() {
        let corner = [0.25, -0.5, 2.0];
        let mut q = Quadric::default();
        for n in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.6, 0.8]] {
            q.add(&Quadric::from_plane(n, corner, 2.0));
        }
        let (p, least) = q.minimizer([0.25, -0.5, 2.001]);
        assert!((0..3).all(|k| (p[k] - corner[k]).abs() < 1e-5), "{p:?}");
        assert!(least < 1e-9);
        // One unit off the first plane costs its weight.
        assert!((q.at([1.25, -0.5, 2.0]) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn one_plane_leaves_the_middle_where_it_is_beside_it() {
        let q = Quadric::from_plane([0.0, 0.0, 1.0], [0.0; 3], 3.0);
        let (p, least) = q.minimizer([5.0, 7.0, 0.5]);
        assert_eq!((p[0], p[1]), (5.0, 7.0));
        assert!(p[2].abs() < 1e-3 && least < 1e-5);
        assert_eq!(Quadric::default().minimizer([1.0; 3]), ([1.0; 3], 0.0));
    }
}
