//! `SubtriangleProjection`: projects a piece and points near it along the piece's normal.
use super::subtriangle::MeshSubtriangle;
use crate::math::{
    Orientation, cross, difference, distance, dot, greater, length, lesser, orient2d, unit_and_length,
};

/// A projection; `piece` is the image of the piece, counter-clockwise.
pub(super) struct SubtriangleProjection {
    origin: [f64; 3],
    axes: [[f64; 3]; 2],
    pub piece: [[f64; 2]; 3],
}

impl SubtriangleProjection {
    /// `None` for a piece whose image has no inside.
    pub fn along_normal(piece: &MeshSubtriangle) -> Option<Self> {
        let [a, b, c] = piece.corners.map(|corner| corner.at);
        let x = direction(difference(b, a))?;
        let normal = direction(cross(x, difference(c, a)))?;
        let axes = [x, cross(normal, x)];
        let mut projection = Self { origin: a, axes, piece: [[0.0; 2]; 3] };
        let [a, b, c] = [a, b, c].map(|p| projection.project(p));
        match orient2d(a, b, c) {
            Orientation::Front => projection.piece = [a, b, c],
            Orientation::Back => projection.piece = [a, c, b],
            Orientation::Flat => return None,
        }
        Some(projection)
    }

    /// The image of a point: it depends on the point alone.
    #[inline]
    pub fn project(&self, p: [f64; 3]) -> [f64; 2] {
        let from = difference(p, self.origin);
        [dot(self.axes[0], from), dot(self.axes[1], from)]
    }

    /// Whether a segment may meet the inside of the piece. It does not if one side of the piece has the
    /// segment beyond it, or if the segment's line has the whole piece on one side; one of these holds for
    /// every segment that does not meet it.
    pub fn crosses(&self, [p, q]: [[f64; 2]; 2]) -> bool {
        let t = &self.piece;
        let outside = |point: [f64; 2], k: usize| orient2d(t[k], t[(k + 1) % 3], point) != Orientation::Front;
        if (0..3).any(|k| outside(p, k) && outside(q, k)) {
            return false;
        }
        let sides = t.map(|corner| orient2d(p, q, corner));
        sides.contains(&Orientation::Front) && sides.contains(&Orientation::Back)
    }

    /// An upper bound on how deep a segment reaches into the piece. For each side of the piece the deeper end of
    /// the segment counts, and of the three sides the one with the least depth. Two products and their
    /// difference have a rounding of less than 4 ε of their largest possible value.
    pub fn depth(&self, segment: [[f64; 2]; 2]) -> f64 {
        let t = &self.piece;
        (0..3).fold(f64::INFINITY, |least, k| {
            let (a, e) = (t[k], difference(t[(k + 1) % 3], t[k]));
            // Rounded up, as above; positive inside the side.
            let inward = |p: [f64; 2]| {
                let [x, y] = difference(p, a);
                (e[0] * y - e[1] * x) + 4.0 * f64::EPSILON * (e[0].abs() + e[1].abs()) * (x.abs() + y.abs())
            };
            let deeper = greater(inward(segment[0]), inward(segment[1]));
            // The length of the side has 4 roundings and is rounded down; the quotient has 2, and is rounded up.
            let depth = deeper / (length(e) * (1.0 - 4.0 * f64::EPSILON)) * (1.0 + f64::EPSILON);
            let depth = greater(depth, f64::MIN_POSITIVE);
            lesser(depth, least)
        })
    }

    /// An upper bound on the distance of any point of the piece from the part deeper than `trim`, if one of
    /// the `images` covers the centre; `None` if none does, or nothing is certainly that deep.
    pub fn trimmed(
        &self,
        trim: f64,
        piece: &MeshSubtriangle,
        mut images: impl Iterator<Item = [[f64; 2]; 3]>,
    ) -> Option<f64> {
        let t = &self.piece;
        // The centre of the inscribed circle is the mean of the corners, each weighted by the side across.
        let sides: [f64; 3] = std::array::from_fn(|k| distance(t[(k + 2) % 3], t[(k + 1) % 3]));
        let perimeter = sides[0] + sides[1] + sides[2];
        let centre: [f64; 2] = std::array::from_fn(|k| {
            (sides[0] * t[0][k] + sides[1] * t[1][k] + sides[2] * t[2][k]) / perimeter
        });
        // The radius, rounded down: the distance of the rounded centre to each side is at least this, and the
        // true centre, which is the farthest from the sides of all points, is at least as deep.
        let radius = (0..3).fold(f64::INFINITY, |least, k| {
            let (a, e) = (t[k], difference(t[(k + 1) % 3], t[k]));
            let [x, y] = difference(centre, a);
            let inward =
                (e[0] * y - e[1] * x) - 4.0 * f64::EPSILON * (e[0].abs() + e[1].abs()) * (x.abs() + y.abs());
            let depth = inward / (length(e) * (1.0 + 4.0 * f64::EPSILON)) * (1.0 - f64::EPSILON);
            lesser(depth, least)
        });
        // The centre itself must be inside of the shrunk piece.
        if radius.is_nan() || radius <= trim {
            return None;
        }
        // A centre on the border of an image is covered: the neighbour across covers the points beside it.
        let covered = images.any(|image| {
            let orientation = orient2d(image[0], image[1], image[2]);
            orientation != Orientation::Flat
                && (0..3).all(|k| orient2d(image[k], image[(k + 1) % 3], centre) != orientation.flipped())
        });
        let (longest, _) = piece.longest();
        covered.then(|| trim / radius * longest * (1.0 + 4.0 * f64::EPSILON)) // three roundings
    }

    /// Whether the insides of a triangle and of the piece intersect.
    pub fn overlaps(&self, face: [[f64; 2]; 3]) -> bool {
        let apart = |a: &[[f64; 2]; 3], b: &[[f64; 2]; 3], front: Orientation| {
            (0..3).any(|k| b.iter().all(|p| orient2d(a[k], a[(k + 1) % 3], *p) != front))
        };
        let front = orient2d(face[0], face[1], face[2]);
        !apart(&self.piece, &face, Orientation::Front) && !apart(&face, &self.piece, front)
    }
}

/// A vector scaled to a length of about 1; `None` for one without direction.
fn direction(v: [f64; 3]) -> Option<[f64; 3]> {
    let (unit, length) = unit_and_length(v);
    (length > 0.0 && length.is_finite()).then_some(unit)
}
