//! `Quad`: four corners in space, how far they are from one plane, and its two diagonals.
use super::Triangle;
use crate::math::{Orientation, difference, length, orient3d};

/// Four corners in order; counter-clockwise is the front.
///
/// ```
/// use chordal::explicit::{Diagonal, Quad};
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

/// The two ways to cut a quad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Diagonal {
    /// From corner 0 to corner 2.
    First,
    /// From corner 1 to corner 3.
    Second,
}

impl Diagonal {
    /// The triangles on both sides, as places in the quad.
    #[must_use]
    pub const fn triangles(self) -> [[u32; 3]; 2] {
        match self {
            Self::First => [[0, 1, 2], [0, 2, 3]],
            Self::Second => [[1, 2, 3], [1, 3, 0]],
        }
    }
}

/// Bends that differ by less count as equal, in radians: normals come with some units of 2⁻⁵³ in each coordinate, and
/// their products and the arc tangent with as many again; 64 of them are allowed for.
const SAME_BEND: f64 = 32.0 * f64::EPSILON;

impl Quad {
    /// How far the fourth corner bulges out of the plane of the other three, positive to the front. 0 exactly where all
    /// lie in one plane; `None` where the first three lie on one line.
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

    /// The largest distance of a corner from the plane that is as far from all four: half the distance between the two
    /// diagonals' lines. It does not depend on which corner comes first. `None` where the diagonals have one direction.
    #[must_use]
    pub fn warp(&self) -> Option<f64> {
        let [a, b, c, d] = self.corners;
        // A triangle whose sides run like the diagonals has the normal of both; `b` is as high over the first one's
        // line as the lines are apart.
        let (along, across) = (difference(c, a), difference(d, b));
        let plane = Triangle { corners: [[0.0; 3], along, across] };
        if self.is_flat() {
            return (!plane.is_degenerate()).then_some(0.0);
        }
        plane.height_of(difference(b, a)).map(|height| 0.5 * height.abs())
    }

    /// The angle between the normals of the two triangles for each diagonal, 0 where they lie flat, π where one folds
    /// back on the other; `None` where one has no area.
    #[must_use]
    pub fn bends_rad(&self) -> [Option<f64>; 2] {
        [Diagonal::First, Diagonal::Second].map(|diagonal| {
            let normal = |t: [u32; 3]| Triangle { corners: t.map(|k| self.corners[k as usize]) }.normal();
            let [one, other] = diagonal.triangles().map(normal);
            let ([a, b, c], [x, y, z]) = (one?, other?);
            let across = length([b * z - c * y, c * x - a * z, a * y - b * x]);
            Some(libm::atan2(across, (a * x + b * y) + c * z))
        })
    }

    /// The diagonal that bends least. The first one where both bend alike, as in a flat convex quad, and where neither
    /// gives two triangles with area; the one that does where the other does not.
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

    /// How much an attribute differs between the ends of each diagonal: the lengths of the differences of its rows. The
    /// diagonal with the smaller one shows the attribute with less of a ridge.
    ///
    /// ```
    /// use chordal::explicit::Quad;
    /// let heights: [&[f64]; 4] = [&[0.0], &[3.0], &[1.0], &[-1.0]];
    /// assert_eq!(Quad::differences(heights), [1.0, 4.0]);
    /// ```
    #[must_use]
    pub fn differences(rows: [&[f64]; 4]) -> [f64; 2] {
        [[0, 2], [1, 3]].map(|[from, to]| {
            let both = rows[from].iter().zip(rows[to]);
            both.fold(0.0, |sum, (a, b)| sum + (b - a) * (b - a)).sqrt()
        })
    }
}
