//! From the points of a mesh to the surface of a field.
//!
//! A piece of a triangle lies in a box E with a margin of `reach` on all sides. Let the field be Lipschitz in
//! E with gradients in G, and grow along a direction n at a rate of g > 0. By the mean value theorem every
//! point q of the piece has `F(q) ∈ F(c) + G·(q − c)`, which is linear in q and so largest at a corner; δ is
//! the largest |F| that remains. From q one reaches a change of sign within δ/g along n, forwards or
//! backwards, which is a point of ∂{F < 0}; the segment to it lies in E as long as δ/g ≤ reach, less the
//! distance of q from the piece.
//!
//! If a field has no rate (ridges that meet, stationary points), two points of opposite signs replace it:
//! the segment between them crosses the boundary, so no point of the piece is farther from it than from the
//! farther of the two.
//!
//! Pieces are split at rounded midpoints, so their points are slightly off the triangle
//! ([`SLACK`]); that is added if it makes a bound wider.
//!
//! If a whole piece lies on one side, say F ≥ 0 on it, one direction suffices: along n with `∂F/∂n ≤ −g`
//! in a box that holds the piece and the piece moved by t·n, F is negative from δ/g on, if δ/g < t. So ridges
//! of the field on the other side of the piece do not matter ([`bound_along_gradient`]).
//!
//! A bound for a piece holds for its parts, and so does a [`SurfaceBall`], a point of the surface that may be
//! anywhere.
//!
//! Conversely, F has no zero within |F(c)| / max|G| of the middle c, as far as E reaches: the surface is at
//! least so far.
use super::slope::{
    GrowthRate, distance_up, dot, exactly, inflated, is_inside, is_lipschitz, is_outside, steepest, step,
};
use super::surface_ball::{SurfaceBall, min_with_ball};
use crate::implicit::{Dual, LeafError, Tape};
use crate::math::{
    Box3, Interval, add_up, div_down, div_up, greater, length_up, lesser, mul_up, sub_down, unit_and_length,
};

/// An open piece of a face.
#[derive(Clone, Debug)]
pub(super) struct FieldSubtriangle {
    pub corners: [[f64; 3]; 3],
    pub face: u32,
    /// The margin around it in which the surface is searched.
    reach: f64,
    cuts: u32,
    /// The upper bound of the piece of which it is a part.
    parent_at_most: f64,
    witness: Option<SurfaceBall>,
}

/// The bounds of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct SubtriangleBounds {
    /// Some point of it is at least this far from the surface.
    pub at_least: f64,
    /// No point of it is farther; ∞ if unknown.
    pub at_most: f64,
    /// The largest |F| on it.
    pub residual: f64,
    /// Its centroid.
    pub at: [f64; 3],
    /// The estimated distance of the surface.
    estimate: f64,
    /// A longer reach with which it might be settled.
    retry_reach: Option<f64>,
    /// The nearest surface point found.
    witness: Option<SurfaceBall>,
    /// Whether its centroid was probed.
    pub probed: bool,
}

impl SubtriangleBounds {
    /// Takes a witness if it gives a smaller bound.
    pub fn tighten(&mut self, piece: &FieldSubtriangle, witness: Option<SurfaceBall>) {
        let far = min_with_ball(f64::INFINITY, witness, &piece.corners, piece.slack());
        if far < min_with_ball(f64::INFINITY, self.witness, &piece.corners, piece.slack()) {
            self.witness = witness;
        }
        self.at_most = lesser(self.at_most, far);
    }
}

/// The distance of a point of a piece from the triangle from which it was cut, relative to the largest
/// coordinate: derived from [`MOST_CUTS`] + 2 roundings of half a step in each coordinate, 26 · ½ · √3 · ε,
/// with a margin for the sums.
const SLACK: f64 = 32.0 * f64::EPSILON;
/// The most bisections of a piece.
pub(super) const MOST_CUTS: u32 = 24;

impl FieldSubtriangle {
    /// An upper bound on the distance of its points from the triangle.
    pub fn slack(&self) -> f64 {
        let reach = self.corners.as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
        mul_up(SLACK, reach)
    }

    pub fn from_face(corners: [[f64; 3]; 3], face: u32) -> Self {
        let bounds = Box3::from_points(&corners);
        // A guess: if it is too short, a longer one is tried.
        let reach = extent(&bounds) / 4.0;
        let mut piece = Self { corners, face, reach, cuts: 0, parent_at_most: f64::INFINITY, witness: None };
        let least = 2.0 * piece.slack();
        if piece.reach < least {
            piece.reach = least;
        }
        piece
    }

    pub fn middle(&self) -> [f64; 3] {
        std::array::from_fn(|k| (self.corners[0][k] + self.corners[1][k] + self.corners[2][k]) / 3.0)
    }

    /// The box E.
    pub fn search_box(&self) -> Box3 {
        inflated(&Box3::from_points(&self.corners), self.reach)
    }

    /// The piece with no more margin than rounding needs.
    pub fn without_margin(self) -> Self {
        Self { reach: 2.0 * self.slack(), ..self }
    }

    /// Splits the piece at the midpoint of its longest side, or retries it with a longer reach.
    pub fn subdivide(mut self, bounds: &SubtriangleBounds, into: &mut Vec<Self>) {
        (self.parent_at_most, self.witness) = (bounds.at_most, bounds.witness);
        if let Some(reach) = bounds.retry_reach {
            into.push(Self { reach, cuts: self.cuts + 1, ..self });
            return;
        }
        let span = extent(&Box3::from_points(&self.corners)) / 8.0;
        let reach = greater(1.5 * bounds.estimate, span);
        let reach = greater(reach, 2.0 * self.slack());
        into.extend(self.halves().map(|half| Self { reach, ..half }));
    }

    /// The halves at the midpoint of the longest side.
    pub fn halves(self) -> [Self; 2] {
        let side = |k: usize| {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 3]);
            (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>()
        };
        let longest = (0..3).fold(0, |best, k| if side(k) > side(best) { k } else { best });
        let [a, b, c] = [0, 1, 2].map(|k| self.corners[(longest + k) % 3]);
        let half = std::array::from_fn(|k| 0.5 * a[k] + 0.5 * b[k]);
        [[a, half, c], [half, b, c]].map(|corners| Self { corners, cuts: self.cuts + 1, ..self.clone() })
    }

    /// Whether it is small compared to a length.
    pub fn is_within(&self, length: f64) -> bool {
        extent(&Box3::from_points(&self.corners)) < 0.5 * length
    }

    /// Its longest extent along an axis.
    pub fn extent(&self) -> f64 {
        extent(&Box3::from_points(&self.corners))
    }

    /// How many times it was split.
    pub fn cuts(&self) -> u32 {
        self.cuts
    }
}

fn extent(bounds: &Box3) -> f64 {
    (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, |most, side| greater(side, most))
}

/// Bounds every piece.
pub(super) fn bound_all(
    tape: &Tape,
    pieces: &[FieldSubtriangle],
) -> Result<Vec<SubtriangleBounds>, LeafError> {
    let unknown = Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] };
    let boxes: Vec<Box3> = pieces.iter().map(FieldSubtriangle::search_box).collect();
    let mut slopes = vec![unknown; pieces.len()];
    tape.gradient_over(&boxes, &mut slopes)?;
    let middles: Vec<Box3> =
        pieces.iter().map(FieldSubtriangle::middle).map(|c| Box3 { min: c, max: c }).collect();
    let mut values = vec![Interval::UNKNOWN; pieces.len()];
    tape.over(&middles, &mut values)?;
    Ok((0..pieces.len()).map(|k| bound_one(&pieces[k], &slopes[k], values[k])).collect())
}

fn bound_one(piece: &FieldSubtriangle, slope: &Dual<Interval>, value: Interval) -> SubtriangleBounds {
    let at = piece.middle();
    let range_magnitude = slope.value.magnitude();
    let mut bounds = SubtriangleBounds {
        at_least: 0.0,
        at_most: piece.parent_at_most,
        residual: range_magnitude,
        at,
        estimate: 0.0,
        retry_reach: None,
        witness: None,
        probed: false,
    };
    bounds.tighten(piece, piece.witness);
    if !is_lipschitz(slope) || !value.is_defined() {
        return bounds;
    }
    // The slope is at most the steepest gradient in E, so F cannot reach 0 on a shorter way; beyond
    // E nothing is known.
    let least = if value.contains(0.0) { 0.0 } else { lesser(value.lo().abs(), value.hi().abs()) };
    let far = div_down(least, steepest(slope));
    let slack = piece.slack();
    let far = sub_down(lesser(far, piece.reach), slack);
    bounds.at_least = greater(far, 0.0);
    // Both hold; the first is better on small pieces, the second on large ones.
    bounds.residual = lesser(over_corners(piece, slope, value).magnitude(), range_magnitude);
    let Some(growth) = GrowthRate::along_gradient(slope) else { return bounds };
    let steps = growth.steps_for(bounds.residual);
    let far = mul_up(steps, growth.length);
    bounds.estimate = far;
    // The points of the triangle are off those of the piece by the slack, and so is the end of the segment.
    if add_up(far, slack) <= piece.reach {
        bounds.at_most = lesser(bounds.at_most, far);
    // The way leaves E. A box with more room may still have a rate, as long as it is not much
    // larger.
    } else if far < 4.0 * piece.reach && piece.cuts < 4 {
        bounds.retry_reach = Some(1.25 * far);
    }
    bounds
}

/// Bounds pieces on one side of the surface if the field falls, or rises, all along the way to it.
pub(super) fn bound_along_gradient(
    tape: &Tape,
    pieces: &[&FieldSubtriangle],
    bounds: &mut [SubtriangleBounds],
) -> Result<(), LeafError> {
    let middles: Vec<[f64; 3]> = pieces.iter().map(|piece| piece.middle()).collect();
    let mut slopes = vec![Dual { value: 0.0, gradient: [0.0; 3] }; pieces.len()];
    tape.gradient_at(&middles, &mut slopes)?;
    let moves: Vec<([f64; 3], f64)> = pieces
        .iter()
        .zip(&slopes)
        .map(|(piece, slope)| {
            // To first order; a quarter more, and a quarter of the piece, so that the far end lies
            // beyond the surface.
            let seems = slope.value.abs() / crate::math::length(slope.gradient);
            let far = 1.25 * seems + 0.25 * piece.extent();
            let along = if slope.value < 0.0 { 1.0 } else { -1.0 };
            (direction_or_z(slope.gradient).map(|x| along * x), if far.is_finite() { far } else { 0.0 })
        })
        .collect();
    let boxes: Vec<Box3> = pieces
        .iter()
        .zip(&moves)
        .map(|(piece, (direction, distance))| {
            let start_box = inflated(&Box3::from_points(&piece.corners), piece.slack());
            start_box.union(translated(&start_box, *direction, *distance))
        })
        .collect();
    let mut around = vec![Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] }; boxes.len()];
    tape.gradient_over(&boxes, &mut around)?;
    let points: Vec<Box3> = middles.iter().map(|c| Box3 { min: *c, max: *c }).collect();
    let mut values = vec![Interval::UNKNOWN; points.len()];
    tape.over(&points, &mut values)?;
    for (k, slope) in around.iter().enumerate() {
        if !is_lipschitz(slope) || !values[k].is_defined() {
            continue;
        }
        let (piece, (direction, distance)) = (pieces[k], moves[k]);
        let values_on_piece = over_corners(piece, slope, values[k]);
        let rise = dot(slope.gradient, exactly(direction));
        let rate = if values_on_piece.lo() >= 0.0 {
            -rise.hi()
        } else if values_on_piece.hi() < 0.0 {
            rise.lo()
        } else {
            continue;
        };
        let residual = values_on_piece.magnitude();
        let steps = div_up(residual, rate);
        // The sign changes before the end of the box over which the rate holds.
        if rate > 0.0 && steps < distance {
            bounds[k].at_most = lesser(bounds[k].at_most, mul_up(steps, length_up(direction.map(f64::abs))));
            bounds[k].residual = lesser(bounds[k].residual, residual);
        }
    }
    Ok(())
}

/// The box moved, with a margin for rounding.
fn translated(bounds: &Box3, direction: [f64; 3], distance: f64) -> Box3 {
    Box3 {
        min: std::array::from_fn(|k| (bounds.min[k] + (distance * direction[k]).next_down()).next_down()),
        max: std::array::from_fn(|k| (bounds.max[k] + (distance * direction[k]).next_up()).next_up()),
    }
}

/// The range of values on a piece and on the part of the triangle for which it stands.
fn over_corners(piece: &FieldSubtriangle, slope: &Dual<Interval>, value: Interval) -> Interval {
    let at = piece.middle();
    let changes = piece.corners.map(|corner| dot(slope.gradient, step(corner, at)));
    let values = value + changes[0].hull(changes[1]).hull(changes[2]);
    let slack = mul_up(steepest(slope), piece.slack());
    Interval::from_endpoints(sub_down(values.lo(), slack), add_up(values.hi(), slack))
}

/// Directions in which the opposite sign is searched: axes and diagonals.
const AROUND: [[f64; 3]; 14] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
    [0.577, 0.577, 0.577],
    [0.577, 0.577, -0.577],
    [0.577, -0.577, 0.577],
    [0.577, -0.577, -0.577],
    [-0.577, 0.577, 0.577],
    [-0.577, 0.577, -0.577],
    [-0.577, -0.577, 0.577],
    [-0.577, -0.577, -0.577],
];

/// Bounds pieces whose range of gradients is wide: the whole piece is moved along the gradient at its
/// centroid, and against it. If one copy is outside and the other inside, the boundary is between them for
/// every point of the piece.
///
/// The step is the sufficient distance or, if the surface seems farther, a little more than its estimated
/// distance.
pub(super) fn bound_by_shift(
    tape: &Tape,
    pieces: &[&FieldSubtriangle],
    bounds: &mut [SubtriangleBounds],
    enough: f64,
) -> Result<(), LeafError> {
    let middles: Vec<[f64; 3]> = pieces.iter().map(|piece| piece.middle()).collect();
    let mut slopes = vec![Dual { value: 0.0, gradient: [0.0; 3] }; pieces.len()];
    tape.gradient_at(&middles, &mut slopes)?;
    let directions: Vec<[f64; 3]> = slopes.iter().map(|slope| direction_or_z(slope.gradient)).collect();
    let steps = pieces.iter().zip(&slopes).map(|(piece, slope)| {
        let seems = slope.value.abs() / crate::math::length(slope.gradient);
        // Half the piece in addition, since one end of it may be closer to the surface than the other.
        let far = 1.02 * seems + 0.5 * extent(&Box3::from_points(&piece.corners));
        // A little less than what is enough, as the length of the rounded direction is rounded up.
        if far.is_finite() && far > enough { far } else { 0.999 * enough }
    });
    let steps: Vec<f64> = steps.collect();
    let mut boxes = Vec::with_capacity(2 * pieces.len());
    for (piece, (direction, distance)) in pieces.iter().zip(directions.iter().zip(&steps)) {
        let start_box = inflated(&Box3::from_points(&piece.corners), piece.slack());
        boxes.extend([
            translated(&start_box, *direction, *distance),
            translated(&start_box, *direction, -distance),
        ]);
    }
    let mut values = vec![Interval::UNKNOWN; boxes.len()];
    tape.over(&boxes, &mut values)?;
    for (k, ends) in values.chunks_exact(2).enumerate() {
        let opposite = is_outside(ends[0]) && is_inside(ends[1]) || is_inside(ends[0]) && is_outside(ends[1]);
        if opposite {
            // The step, and the slack of the piece.
            let far = add_up(mul_up(steps[k], length_up(directions[k].map(f64::abs))), pieces[k].slack());
            bounds[k].at_most = lesser(bounds[k].at_most, far);
        }
        if bounds[k].estimate == 0.0 {
            bounds[k].estimate = steps[k];
        }
    }
    Ok(())
}

/// A vector scaled to length 1 up to rounding; the z axis if it has no direction.
fn direction_or_z(v: [f64; 3]) -> [f64; 3] {
    let (unit, length) = unit_and_length(v);
    if length > 0.0 && length.is_finite() { unit } else { [0.0, 0.0, 1.0] }
}

/// Bounds pieces without a direction of growth by two points of opposite signs, about `within` from their
/// centroids.
pub(super) fn bound_by_samples(
    tape: &Tape,
    pieces: &[&FieldSubtriangle],
    bounds: &mut [SubtriangleBounds],
    within: f64,
) -> Result<(), LeafError> {
    let mut points = Vec::with_capacity(pieces.len() * (2 * AROUND.len() + 3));
    for piece in pieces {
        let c = piece.middle();
        points.extend(piece.corners);
        for share in [0.3, 0.9] {
            points.extend(
                AROUND.iter().map(|d| -> [f64; 3] { std::array::from_fn(|k| c[k] + share * within * d[k]) }),
            );
        }
    }
    let boxes: Vec<Box3> = points.iter().map(|p| Box3 { min: *p, max: *p }).collect();
    let mut values = vec![Interval::UNKNOWN; boxes.len()];
    tape.over(&boxes, &mut values)?;
    let each = points.len() / pieces.len().max(1);
    for (k, piece) in pieces.iter().enumerate() {
        let far = |p: [f64; 3]| {
            piece.corners.iter().map(|c| distance_up(*c, p)).fold(0.0, |most, d| greater(d, most))
        };
        // One point is enough for all of the piece: the distance to it is largest at a corner.
        let (mut inside, mut outside) = (f64::INFINITY, f64::INFINITY);
        for i in k * each..(k + 1) * each {
            if is_inside(values[i]) {
                inside = lesser(inside, far(points[i]));
            } else if is_outside(values[i]) {
                outside = lesser(outside, far(points[i]));
            }
        }
        // The surface crosses the segment between the two points, and no point of that is farther
        // than its farther end.
        let distance = add_up(greater(inside, outside), piece.slack());
        bounds[k].at_most = lesser(bounds[k].at_most, distance);
    }
    Ok(())
}
