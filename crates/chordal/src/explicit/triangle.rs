//! `Triangle`: three corners in the plane or in space, with orientation, barycentric coordinates, area and
//! shape.
//!
//! Differences of coordinates are exact here, and products have twice the digits of f64. So the weights and
//! areas of thin triangles far from the origin keep their digits.
use super::{Attribute, Domain, Mesh, face_normal};
use crate::math::{
    DoubleDouble, Orientation, PointInTriangle, greater, lesser, orient2d, orient3d, triangle_contains,
    unit_scale,
};

/// Three corners in D dimensions; the front is counter-clockwise.
///
/// ```
/// use chordal::explicit::Triangle;
/// let triangle = Triangle { corners: [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]] };
/// assert_eq!(triangle.normal(), Some([0.0, 0.0, 1.0]));
/// assert_eq!(triangle.area(), 0.5);
/// assert_eq!(triangle.barycentric([0.75, 0.25, 9.0]), Some([0.25, 0.5, 0.25]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle<const D: usize> {
    /// In order.
    pub corners: [[f64; D]; 3],
}

/// A vector in double-double arithmetic.
type Wide3 = [DoubleDouble; 3];

const ZERO: DoubleDouble = DoubleDouble { hi: 0.0, lo: 0.0 };

impl<const D: usize> Triangle<D> {
    /// The triangle scaled so that its largest coordinate is near 1, and that scale, a power of two.
    fn scaled(&self) -> (Self, f64) {
        let scale = unit_scale(&self.corners);
        (Self { corners: self.corners.map(|p| p.map(|x| x * scale)) }, scale)
    }

    /// The squared lengths of the edges opposite to the corners.
    fn edges_sq(&self) -> [f64; 3] {
        let [a, b, c] = self.corners;
        [[b, c], [c, a], [a, b]].map(|[p, q]| (0..D).fold(0.0, |sum, k| sum + (q[k] - p[k]) * (q[k] - p[k])))
    }
}

impl Triangle<2> {
    /// The three edge functions: twice the signed areas that `point` spans with the edges opposite to the
    /// corners. All are positive inside a counter-clockwise triangle, and they add up to twice its area.
    ///
    /// The signs are exact, and exactly 0 on the lines of the edges. The sizes are rounded; if they leave the
    /// range of f64, only the signs are meaningful.
    ///
    /// ```
    /// use chordal::explicit::Triangle;
    /// let triangle = Triangle { corners: [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]] };
    /// assert_eq!(triangle.edge_functions([1.0, 1.0]), [8.0, 4.0, 4.0]);
    /// assert_eq!(triangle.edge_functions([2.0, 2.0])[0], 0.0);
    /// ```
    #[must_use]
    pub fn edge_functions(&self, point: [f64; 2]) -> [f64; 3] {
        let [a, b, c] = self.corners;
        [[b, c], [c, a], [a, b]].map(|[from, to]| {
            let size = cross2(from, to, point).hi;
            with_sign(size, orient2d(from, to, point))
        })
    }

    /// The exact location of `point`: [`triangle_contains`].
    #[must_use]
    pub fn position(&self, point: [f64; 2]) -> PointInTriangle {
        triangle_contains(self.corners, point)
    }

    /// The area, positive for counter-clockwise corners. The sign is exact.
    #[must_use]
    pub fn signed_area(&self) -> f64 {
        let (scaled, scale) = self.scaled();
        let [a, b, c] = scaled.corners;
        let [p, q, r] = self.corners;
        with_sign(0.5 * cross2(a, b, c).hi / scale / scale, orient2d(p, q, r))
    }

    /// The barycentric coordinates of `point`: see [`Triangle::barycentric`] in space.
    #[must_use]
    pub fn barycentric(&self, point: [f64; 2]) -> Option<[f64; 3]> {
        let [a, b, c] = self.corners;
        if orient2d(a, b, c) == Orientation::Flat {
            return None;
        }
        let (scaled, scale) = self.scaled();
        let p = point.map(|x| x * scale);
        let [a, b, c] = scaled.corners;
        weights([[b, c], [c, a], [a, b]].map(|[from, to]| cross2(from, to, p)))
    }
}

impl Triangle<3> {
    /// A face of a mesh.
    ///
    /// # Panics
    /// When the mesh has no such face.
    #[must_use]
    pub fn from_face(mesh: &Mesh, face: usize) -> Self {
        Self { corners: mesh.corners(face) }
    }

    /// The unit normal: [`face_normal`]. Swapping two corners reverses it.
    #[must_use]
    pub fn normal(&self) -> Option<[f64; 3]> {
        face_normal(self.corners)
    }

    /// Whether the corners lie on one line, exactly: the projections onto all three coordinate planes have no
    /// area.
    #[must_use]
    pub fn is_degenerate(&self) -> bool {
        (0..3).all(|k| {
            let [a, b, c] = self.corners.map(|p| [p[(k + 1) % 3], p[(k + 2) % 3]]);
            orient2d(a, b, c) == Orientation::Flat
        })
    }

    /// The area, with an error of a few units in the last place however thin the triangle is.
    #[must_use]
    pub fn area(&self) -> f64 {
        let (scaled, scale) = self.scaled();
        0.5 * size(scaled.doubled_area()) / scale / scale
    }

    /// `(b − a) × (c − a)`.
    fn doubled_area(&self) -> Wide3 {
        let [a, b, c] = self.corners;
        cross3(difference(b, a), difference(c, a))
    }

    /// The barycentric coordinates of the projection of `point` onto the triangle's plane: their sum is 1,
    /// and all are ≥ 0 if the projection lies inside. `None` for a triangle without area.
    ///
    /// The weights come from areas with twice the digits of f64. So they are accurate to a few units in the
    /// last place of the largest one, unless the triangle is thinner than 1 in 10¹⁵.
    #[must_use]
    pub fn barycentric(&self, point: [f64; 3]) -> Option<[f64; 3]> {
        if self.is_degenerate() {
            return None;
        }
        let (scaled, scale) = self.scaled();
        let p = point.map(|x| x * scale);
        let [a, b, c] = scaled.corners;
        let normal = scaled.doubled_area();
        let share = |[from, to]: [[f64; 3]; 2]| dot(normal, cross3(difference(from, p), difference(to, p)));
        weights([[b, c], [c, a], [a, b]].map(share))
    }

    /// The signed distance of `point` from the triangle's plane, positive in front of it; `None` without
    /// area. It is 0 exactly if the four points lie in one plane, and its sign is exact.
    #[must_use]
    pub fn height_of(&self, point: [f64; 3]) -> Option<f64> {
        let [a, b, c] = self.corners;
        if self.is_degenerate() {
            return None;
        }
        let (scaled, scale) = self.scaled();
        let normal = scaled.doubled_area();
        let along = dot(normal, difference(point.map(|x| x * scale), scaled.corners[0]));
        Some(with_sign(along.hi / size(normal) / scale, orient3d(a, b, c, point)))
    }

    /// The shape quality: `4√3 · area / (sum of the squared edges)`, from 0 for corners on one line to 1 for
    /// three equal edges. It has no unit. Translation, rotation, reflection and scaling leave it unchanged.
    ///
    /// Source: R. Bank, A. Weiser, *Some a posteriori error estimators for elliptic partial differential
    /// equations*, 1985.
    ///
    /// ```
    /// use chordal::explicit::Triangle;
    /// let half_square = Triangle { corners: [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] };
    /// assert!((half_square.quality() - 3.0_f64.sqrt() / 2.0).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn quality(&self) -> f64 {
        let (scaled, _) = self.scaled();
        let edges = scaled.edges_sq();
        let sum = edges[0] + edges[1] + edges[2];
        let share = 2.0 * 3.0_f64.sqrt() * size(scaled.doubled_area()) / sum;
        // The ratio is NaN if all corners coincide; the quality is 0 then.
        if share > 0.0 { lesser(share, 1.0) } else { 0.0 }
    }

    /// The ratio of the smallest height to the longest edge, from 0 for corners on one line to `√3/2` for
    /// three equal edges. Below some threshold the triangle is a sliver: 1/100 is a needle or a cap of 1 :
    /// 100. It has no unit. Translation, rotation, reflection and scaling leave it unchanged.
    #[must_use]
    pub fn slenderness(&self) -> f64 {
        let (scaled, _) = self.scaled();
        let longest_sq = scaled.edges_sq().into_iter().fold(0.0, |m, e| greater(e, m));
        let share = size(scaled.doubled_area()) / longest_sq;
        // The ratio is NaN if all corners coincide; the slenderness is 0 then.
        greater(share, 0.0)
    }
}

/// Writes the mean of three rows of an attribute by `weights` to `out`: linear over the triangle, exact at
/// its corners, and exact if the three rows are equal.
///
/// ```
/// use chordal::explicit::interpolate;
/// let mut colour = [0.0; 2];
/// interpolate([&[0.0, 7.0], &[1.0, 7.0], &[2.0, 7.0]], [0.5, 0.25, 0.25], &mut colour);
/// assert_eq!(colour, [0.75, 7.0]);
/// ```
pub fn interpolate(rows: [&[f64]; 3], weights: [f64; 3], out: &mut [f64]) {
    // Start at the row with the largest weight: the differences vanish at its corner.
    let base = (1..3).fold(0, |heaviest, k| if weights[k] > weights[heaviest] { k } else { heaviest });
    let (next, last) = ((base + 1) % 3, (base + 2) % 3);
    for (k, value) in out.iter_mut().enumerate() {
        let from = rows[base][k];
        *value = from + (weights[next] * (rows[next][k] - from) + weights[last] * (rows[last][k] - from));
    }
}

/// The rows of an attribute at the three corners of a face, for any domain.
///
/// # Panics
/// When the mesh has no such face, or the attribute belongs to another mesh.
#[must_use]
pub fn corner_rows<'a>(mesh: &Mesh, attribute: &'a Attribute, face: usize) -> [&'a [f64]; 3] {
    std::array::from_fn(|k| {
        attribute.row(match attribute.domain {
            Domain::Vertex => mesh.faces()[face][k] as usize,
            Domain::Corner => 3 * face + k,
            Domain::Face => face,
        })
    })
}

/// `(to − from) × (point − from)`, to about 2⁻¹⁰⁰ of its products.
fn cross2(from: [f64; 2], to: [f64; 2], point: [f64; 2]) -> DoubleDouble {
    let d = |p: [f64; 2], k: usize| DoubleDouble::two_sum(p[k], -from[k]);
    d(to, 0).times(d(point, 1)).minus(d(to, 1).times(d(point, 0)))
}

fn difference(a: [f64; 3], b: [f64; 3]) -> Wide3 {
    std::array::from_fn(|k| DoubleDouble::two_sum(a[k], -b[k]))
}

fn cross3(a: Wide3, b: Wide3) -> Wide3 {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i].times(b[j]).minus(a[j].times(b[i])))
}

fn dot(a: Wide3, b: Wide3) -> DoubleDouble {
    (0..3).fold(ZERO, |sum, k| sum.plus(a[k].times(b[k])))
}

fn size(v: Wide3) -> f64 {
    let [x, y, z] = v.map(|x| x.hi);
    let largest = [x, y, z].into_iter().fold(0.0, |m, x| greater(x.abs(), m));
    if largest == 0.0 {
        return 0.0;
    }
    // Divided by the largest coordinate, so that no square underflows.
    let [x, y, z] = [x / largest, y / largest, z / largest];
    largest * ((x * x + y * y) + z * z).sqrt()
}

/// The fractions of the sum; the largest is 1 minus the others, so that they add up to 1.
fn weights(parts: [DoubleDouble; 3]) -> Option<[f64; 3]> {
    let sum = parts[0].plus(parts[1]).plus(parts[2]);
    let mut weights = parts.map(|part| part.hi / sum.hi);
    if !weights.iter().all(|w| w.is_finite()) {
        return None;
    }
    let largest = (1..3).fold(0, |m, k| if weights[k].abs() > weights[m].abs() { k } else { m });
    weights[largest] = 1.0 - (weights[(largest + 1) % 3] + weights[(largest + 2) % 3]);
    Some(weights)
}

/// `size`, or the nearest number with the sign from an exact predicate.
fn with_sign(size: f64, side: Orientation) -> f64 {
    match side {
        Orientation::Flat => 0.0,
        Orientation::Front if size > 0.0 => size,
        Orientation::Front => f64::MIN_POSITIVE,
        Orientation::Back if size < 0.0 => size,
        Orientation::Back => -f64::MIN_POSITIVE,
    }
}
