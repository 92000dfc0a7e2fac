//! `MeshSubtriangle`: a part of one triangle with what is known of the distance of its corners, and the bounds that follow.
use super::distance::{apart_up, distance_up, length_up};
use super::distance_surface::DistanceSurface;
use crate::math::DoubleDouble;

/// A point of one surface with a face of the other that is near it.
#[derive(Clone, Copy, Debug)]
pub(super) struct DistanceSample {
    pub at: [f64; 3],
    /// No more than this far from the other surface.
    pub up: f64,
    /// The face of the other surface that is nearest, up to rounding.
    pub face: u32,
}

/// A triangle whose points all belong to one triangle of a surface, but for `off`.
#[derive(Clone, Debug)]
pub(super) struct MeshSubtriangle {
    pub corners: [DistanceSample; 3],
    /// How far a point of the piece may be from the point of the surface that it stands for.
    pub off: f64,
    /// An upper bound on the distance of all of it that is known already.
    pub known: f64,
}

/// `1/√3` from above: no point of a triangle is farther than this share of its longest side from all three corners.
/// Around a corner's point of view: the farthest point from all corners is the circumcentre where that lies inside,
/// whose radius is then at most `longest/√3`; else a point on the longest side, at most half of it away from one of
/// two corners.
const COVERING: f64 = 0.577_350_269_189_626; // rounded up

impl MeshSubtriangle {
    /// The longest side, from above, and its number: from corner k to corner k + 1.
    pub fn longest(&self) -> (f64, usize) {
        let [a, b, c] = self.corners.map(|c| c.at);
        let sides = [apart_up(a, b), apart_up(b, c), apart_up(c, a)];
        let longest = (1..3).fold(0, |most, k| if sides[k] > sides[most] { k } else { most });
        (sides[longest], longest)
    }

    /// An upper bound on how far any point of the piece is from the other surface, from its corners alone; stops
    /// looking for a better one at `enough`.
    ///
    /// To one triangle, distance is a convex function, so that no point is farther than the farthest corner is; and
    /// no point is farther than its nearest corner plus the way there.
    pub fn bound_by_corners(&self, other: &DistanceSurface, enough: f64) -> f64 {
        let up = self.corners.map(|c| c.up);
        let farthest = larger(larger(up[0], up[1]), up[2]);
        let mut best = self.known;
        for k in 0..3 {
            let face = self.corners[k].face;
            if (0..k).any(|i| self.corners[i].face == face) {
                continue;
            }
            let triangle = other.mesh().corners(face as usize);
            let mut most = 0.0;
            for corner in &self.corners {
                let to = if corner.face == face { corner.up } else { distance_up(corner.at, &triangle) };
                most = larger(most, to);
                if most >= best {
                    break;
                }
            }
            best = smaller(best, self.with_slack(most));
            if best <= enough {
                return best;
            }
        }
        let (longest, _) = self.longest();
        let reached = (farthest + COVERING * longest) * (1.0 + 2.0 * f64::EPSILON); // three roundings
        smaller(best, self.with_slack(reached))
    }

    /// A bound for the piece made one for the part of the surface that it stands for.
    pub fn with_slack(&self, bound: f64) -> f64 {
        if self.off == 0.0 { bound } else { (bound + self.off).next_up() }
    }

    /// The two halves, cut through the middle of the longest side, whose distance `ask` tells; none where the side
    /// cannot be halved any more.
    pub fn halves(&self, ask: impl FnOnce([f64; 3]) -> DistanceSample) -> Option<[Self; 2]> {
        let (_, k) = self.longest();
        let [from, to, apex] = [k, (k + 1) % 3, (k + 2) % 3].map(|i| self.corners[i]);
        let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * from.at[k] + 0.5 * to.at[k]);
        if middle == from.at || middle == to.at {
            return None;
        }
        // Halves are exact; what their sum lost to rounding is known exactly too. The middle stands for that of two
        // points that are each off by no more than `off`.
        let lost: [f64; 3] =
            std::array::from_fn(|k| DoubleDouble::two_sum(0.5 * from.at[k], 0.5 * to.at[k]).lo);
        let off = if lost == [0.0; 3] { self.off } else { (self.off + length_up(lost)).next_up() };
        let middle = ask(middle);
        let half = |corners| Self { corners, off, known: self.known };
        Some([half([from, middle, apex]), half([middle, to, apex])])
    }
}

pub(in super::super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

pub(super) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}
