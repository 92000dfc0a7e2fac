//! `MeshSubtriangle`: a part of a triangle with distance samples at its corners, and the bounds that follow.
use super::distance::{apart_up, distance_up, length_up};
use super::distance_surface::{DistanceSample, DistanceSurface};
use crate::math::{DoubleDouble, greater, lesser};

/// A triangle whose points stand for points of one triangle of a surface, each at most `slack` away.
#[derive(Clone, Debug)]
pub(super) struct MeshSubtriangle {
    pub corners: [DistanceSample; 3],
    /// An upper bound on the distance of a point of the piece from the surface point for which it stands.
    pub slack: f64,
    /// An upper bound on the distance of the whole piece from the other surface.
    pub at_most: f64,
}

/// `1/√3` rounded up: no point of a triangle is farther than this share of its longest side from all three
/// corners. If the circumcentre lies inside, it is the farthest point from all corners, and its radius is at
/// most `longest/√3`; else that point is on the longest side, at most half of it away from one of two
/// corners.
const COVERING: f64 = 0.577_350_269_189_626; // rounded up

impl MeshSubtriangle {
    /// The longest side, rounded up, and its number `k`: it runs from corner k to corner k + 1.
    pub fn longest(&self) -> (f64, usize) {
        let [a, b, c] = self.corners.map(|c| c.at);
        let sides = [apart_up(a, b), apart_up(b, c), apart_up(c, a)];
        let longest = (1..3).fold(0, |most, k| if sides[k] > sides[most] { k } else { most });
        (sides[longest], longest)
    }

    /// An upper bound on the distance of the piece from the other surface, from its corners alone; stops
    /// as soon as the bound is at most `enough`.
    ///
    /// The distance to one triangle is a convex function, so no point is farther than the farthest corner.
    /// And no point is farther than its nearest corner plus the distance to that corner.
    pub fn bound_by_corners(&self, other: &DistanceSurface, enough: f64) -> f64 {
        let up = self.corners.map(|c| c.up);
        let farthest = greater(greater(up[0], up[1]), up[2]);
        let mut best = self.at_most;
        for k in 0..3 {
            let face = self.corners[k].face;
            // The same face gives the same bound.
            if (0..k).any(|i| self.corners[i].face == face) {
                continue;
            }
            let triangle = other.mesh().corners(face as usize);
            let mut most = 0.0;
            for corner in &self.corners {
                let distance =
                    if corner.face == face { corner.up } else { distance_up(corner.at, &triangle) };
                most = greater(most, distance);
                if most >= best {
                    break;
                }
            }
            best = lesser(best, self.with_slack(most));
            if best <= enough {
                return best;
            }
        }
        let (longest, _) = self.longest();
        let reached = (farthest + COVERING * longest) * (1.0 + 2.0 * f64::EPSILON); // three roundings
        lesser(best, self.with_slack(reached))
    }

    /// Turns a bound for the piece into one for the part of the surface for which it stands.
    pub fn with_slack(&self, bound: f64) -> f64 {
        if self.slack == 0.0 { bound } else { (bound + self.slack).next_up() }
    }

    /// The two halves, split at the midpoint of the longest side; `sample` measures the distance there.
    /// `None` if the side is too short to be split.
    pub fn halves(&self, sample: impl FnOnce([f64; 3]) -> DistanceSample) -> Option<[Self; 2]> {
        let (_, k) = self.longest();
        let [from, to, apex] = [k, (k + 1) % 3, (k + 2) % 3].map(|i| self.corners[i]);
        let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * from.at[k] + 0.5 * to.at[k]);
        if middle == from.at || middle == to.at {
            return None;
        }
        // Halving is exact, and the rounding error of the sum is known exactly. The midpoint stands for the
        // midpoint of two surface points, each at most `slack` away from its end.
        let lost: [f64; 3] =
            std::array::from_fn(|k| DoubleDouble::two_sum(0.5 * from.at[k], 0.5 * to.at[k]).lo);
        let slack = if lost == [0.0; 3] { self.slack } else { (self.slack + length_up(lost)).next_up() };
        let middle = sample(middle);
        let half = |corners| Self { corners, slack, at_most: self.at_most };
        Some([half([from, middle, apex]), half([middle, to, apex])])
    }
}
