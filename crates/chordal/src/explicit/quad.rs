//! `Quad`: four corners in space, their deviation from one plane, and the two diagonals.
use super::Triangle;
use crate::math::{Orientation, difference, length, orient3d};

/// Four corners in order; the front is counter-clockwise.
///
/// ```
/// use chordal::explicit::polygons::{Diagonal, Quad};
/// let tent = Quad { corners: [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]] };
/// assert_eq!(tent.bulge(), Some(0.5));
/// // The fold along 1–3 is sharper than that along 0–2: 37° and 35°.
/// assert_eq!(tent.flattest(), Diagonal::First);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    /// In order.
    pub corners: [[f64; 3]; 4],
}

/// One of the two diagonals that split a quad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Diagonal {
    /// From corner 0 to corner 2.
    First,
    /// From corner 1 to corner 3.
    Second,
}

impl Diagonal {
    /// The two triangles, as indices of the quad's corners.
    #[must_use]
    pub const fn triangles(self) -> [[u32; 3]; 2] {
        match self {
            Self::First => [[0, 1, 2], [0, 2, 3]],
            Self::Second => [[1, 2, 3], [1, 3, 0]],
        }
    }
}

/// Bends that differ by less count as equal, in radians. Derived: normals have an error of some units of 2⁻⁵³
/// in each coordinate, and their products and the arc tangent add as many again; 64 of them are allowed for.
const SAME_BEND: f64 = 32.0 * f64::EPSILON;

impl Quad {
    /// The signed distance of the fourth corner from the plane of the other three, positive to the front. It
    /// is exactly 0 if all lie in one plane, and `None` if the first three lie on one line.
    #[must_use]
    pub fn bulge(&self) -> Option<f64> {
        let [a, b, c, d] = self.corners;
        Triangle { corners: [a, b, c] }.height_of(d)
    }

    /// Whether the four corners lie in one plane, exactly.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        let [a, b, c, d] = self.corners;
        orient3d(a, b, c, d) == Orientation::Flat
    }

    /// The largest distance of a corner from the plane that is equally far from all four: half the distance
    /// between the lines of the diagonals. It is the same for any choice of the first corner. `None` if the
    /// diagonals are parallel.
    #[must_use]
    pub fn warp(&self) -> Option<f64> {
        let [a, b, c, d] = self.corners;
        // A triangle with sides parallel to the diagonals has their common normal. The height of `b` along
        // it, above the line of the first diagonal, is the distance between the lines.
        let (along, across) = (difference(c, a), difference(d, b));
        let plane = Triangle { corners: [[0.0; 3], along, across] };
        if self.is_flat() {
            return (!plane.is_degenerate()).then_some(0.0);
        }
        plane.height_of(difference(b, a)).map(|height| 0.5 * height.abs())
    }

    /// For each diagonal the angle between the normals of its two triangles: 0 if they are coplanar, π if one
    /// folds back onto the other, `None` if one has no area.
    #[must_use]
    pub fn bends_rad(&self) -> [Option<f64>; 2] {
        [Diagonal::First, Diagonal::Second].map(|diagonal| {
            let normal = |t: [u32; 3]| Triangle { corners: t.map(|k| self.corners[k as usize]) }.normal();
            let [first, second] = diagonal.triangles().map(normal);
            let ([a, b, c], [x, y, z]) = (first?, second?);
            let across = length([b * z - c * y, c * x - a * z, a * y - b * x]);
            Some(libm::atan2(across, (a * x + b * y) + c * z))
        })
    }

    /// The diagonal with the smaller bend. The first one if both bends are equal, as in a flat convex quad,
    /// or if neither diagonal gives two triangles with area. If only one does, it is that one.
    ///
    /// In a flat quad with a concave corner this is the diagonal that lies inside.
    #[must_use]
    pub fn flattest(&self) -> Diagonal {
        match self.bends_rad() {
            [Some(first), Some(second)] if second + SAME_BEND < first => Diagonal::Second,
            [None, Some(_)] => Diagonal::Second,
            _ => Diagonal::First,
        }
    }

    /// The difference of an attribute between the ends of each diagonal, as the length of the difference of
    /// its rows. The diagonal with the smaller one shows less of a ridge in the attribute.
    ///
    /// ```
    /// use chordal::explicit::polygons::Quad;
    /// let heights: [&[f64]; 4] = [&[0.0], &[3.0], &[1.0], &[-1.0]];
    /// assert_eq!(Quad::differences(heights), [1.0, 4.0]);
    /// ```
    #[must_use]
    pub fn differences(rows: [&[f64]; 4]) -> [f64; 2] {
        [[0, 2], [1, 3]].map(|[from, to]| {
            let pairs = rows[from].iter().zip(rows[to]);
            pairs.fold(0.0, |sum, (a, b)| sum + (b - a) * (b - a)).sqrt()
        })
    }
}
