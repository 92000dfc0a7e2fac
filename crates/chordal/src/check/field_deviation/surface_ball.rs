//! Balls that certainly contain a point of a field's surface.
//!
//! The segment between a point inside and a point outside meets the boundary of {F < 0}, whatever F does
//! there: neither slope nor continuity is required. So two such points, each with a sign that a range proves,
//! make a ball around the midpoint of their segment that holds a point of the surface. No point of a triangle
//! is farther from the surface than the distance of its farthest corner to the ball's centre plus the ball's
//! radius, because the distance to one point is convex.
use super::slope::{distance_up, is_inside, is_outside};
use crate::implicit::{Dual, LeafError, Tape};
use crate::math::{Box3, Interval, add_up, greater, lesser, mul_up};

/// A ball that contains a point of the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceBall {
    pub at: [f64; 3],
    pub radius: f64,
}

impl SurfaceBall {
    /// An upper bound on the distance of `p` from the surface.
    pub fn distance_up(&self, p: [f64; 3]) -> f64 {
        add_up(distance_up(p, self.at), self.radius)
    }

    /// An upper bound on the distance of the triangle from the surface.
    pub fn farthest_of(&self, corners: &[[f64; 3]; 3]) -> f64 {
        corners.iter().fold(0.0, |most, corner| greater(most, self.distance_up(*corner)))
    }
}

/// Steps along the gradient.
const STEPS: usize = 8;
/// Each step overshoots by this factor, so that it ends on the other side of a surface that is nearly flat.
const BEYOND: f64 = 1.05;
/// Bisections of the bracket found.
const HALVINGS: usize = 8;

/// Steps from each point to the surface along the gradient; `None` if that leads nowhere. `sizes`
/// gives for each point the length of the smallest worthwhile step.
pub(super) fn project_to_surface(
    tape: &Tape,
    points: &[[f64; 3]],
    sizes: &[f64],
) -> Result<Vec<Option<SurfaceBall>>, LeafError> {
    let mut at: Vec<[f64; 3]> = points.to_vec();
    let mut brackets: Vec<Option<[[f64; 3]; 2]>> = vec![None; points.len()];
    let mut open: Vec<usize> = (0..points.len()).collect();
    let mut inside = vec![false; points.len()];
    let mut before = at.clone();
    let (mut points_now, mut slopes) = (Vec::new(), Vec::new());
    for step in 0..STEPS {
        if open.is_empty() {
            break;
        }
        points_now.clear();
        points_now.extend(open.iter().map(|k| at[*k]));
        slopes.clear();
        slopes.resize(points_now.len(), Dual { value: 0.0, gradient: [0.0; 3] });
        tape.gradient_at(&points_now, &mut slopes)?;
        let mut still_open = Vec::new();
        for (k, slope) in open.iter().copied().zip(&slopes) {
            let is_in = slope.value < 0.0;
            if step == 0 {
                inside[k] = is_in;
            // The last step crossed the surface.
            } else if is_in != inside[k] {
                brackets[k] = Some([before[k], at[k]]);
                continue;
            }
            let steep = crate::math::length(slope.gradient);
            let least = sizes[k] / 64.0;
            // Near the surface Newton's steps shrink to nothing without ever crossing it, so they
            // have a least length.
            let far = greater(BEYOND * slope.value.abs() / steep, least);
            if far.is_finite() && steep > 0.0 {
                let along = if is_in { far / steep } else { -far / steep };
                before[k] = at[k];
                at[k] = std::array::from_fn(|i| at[k][i] + along * slope.gradient[i]);
                still_open.push(k);
            }
        }
        open = still_open;
    }
    let bracketed: Vec<usize> = (0..points.len()).filter(|k| brackets[*k].is_some()).collect();
    let found_brackets: Vec<[[f64; 3]; 2]> = bracketed.iter().filter_map(|k| brackets[*k]).collect();
    let mut witnesses = vec![None; points.len()];
    for (k, witness) in bracketed.into_iter().zip(certify_brackets(tape, found_brackets)?) {
        witnesses[k] = witness;
    }
    Ok(witnesses)
}

/// Bisects brackets, and proves the signs of their final ends.
pub(super) fn certify_brackets(
    tape: &Tape,
    mut brackets: Vec<[[f64; 3]; 2]>,
) -> Result<Vec<Option<SurfaceBall>>, LeafError> {
    let mut values = vec![0.0; brackets.len()];
    let starts: Vec<[f64; 3]> = brackets.iter().map(|bracket| bracket[0]).collect();
    tape.at(&starts, &mut values)?;
    let first: Vec<bool> = values.iter().map(|value| *value < 0.0).collect();
    for _ in 0..HALVINGS {
        let middles: Vec<[f64; 3]> = brackets.iter().map(middle).collect();
        tape.at(&middles, &mut values)?;
        for (k, value) in values.iter().enumerate() {
            // The middle replaces the end whose sign it has, so the ends keep different signs.
            brackets[k][usize::from((*value < 0.0) != first[k])] = middles[k];
        }
    }
    let ends: Vec<Box3> = brackets.iter().flatten().map(|p| Box3 { min: *p, max: *p }).collect();
    let mut signs = vec![Interval::UNKNOWN; ends.len()];
    tape.over(&ends, &mut signs)?;
    // A point where F is 0 may be in a closed crack, with no surface nearby.
    let is_above = |sign: Interval| is_outside(sign) && sign.lo() > 0.0;
    let sure = |signs: &[Interval]| {
        is_inside(signs[0]) && is_above(signs[1]) || is_above(signs[0]) && is_inside(signs[1])
    };
    let ball = |bracket: &[[f64; 3]; 2]| {
        let at = middle(bracket);
        // The midpoint is rounded; the segment lies within the distance of the farther of its ends.
        SurfaceBall { at, radius: greater(distance_up(at, bracket[0]), distance_up(at, bracket[1])) }
    };
    Ok(brackets
        .iter()
        .zip(signs.chunks_exact(2))
        .map(|(bracket, signs)| sure(signs).then(|| ball(bracket)))
        .collect())
}

fn middle([a, b]: &[[f64; 3]; 2]) -> [f64; 3] {
    std::array::from_fn(|k| 0.5 * a[k] + 0.5 * b[k])
}

/// Witnesses from all over a box, for pieces without one nearby.
pub(super) struct SurfaceBalls(Vec<SurfaceBall>);

/// The numbers of samples along a side of the two lattices on which signs are evaluated.
const SIDES: [usize; 2] = [17, 65];
/// The most witnesses kept.
const KEPT: usize = 512;

impl SurfaceBalls {
    /// Finds witnesses between neighbours of opposite signs on a lattice over the box.
    pub fn sample_box(tape: &Tape, bounds: &Box3) -> Result<Self, LeafError> {
        let mut witnesses = Vec::new();
        // The fine lattice is for fields whose surface slips through the coarse one.
        for n in SIDES {
            let at = |k: usize, i: usize| {
                let share = i as f64 / (n - 1) as f64;
                (1.0 - share) * bounds.min[k] + share * bounds.max[k]
            };
            let points: Vec<[f64; 3]> =
                (0..n * n * n).map(|i| [at(0, i % n), at(1, i / n % n), at(2, i / (n * n))]).collect();
            let mut values = vec![0.0; points.len()];
            tape.at(&points, &mut values)?;
            let mut brackets = Vec::new();
            for i in 0..points.len() {
                for (axis, stride) in [1, n, n * n].into_iter().enumerate() {
                    if i / stride % n + 1 < n && (values[i] < 0.0) != (values[i + stride] < 0.0) {
                        debug_assert!(points[i][axis] <= points[i + stride][axis]);
                        brackets.push([points[i], points[i + stride]]);
                    }
                }
            }
            // Evenly over the box, since neighbouring brackets witness the same part of the
            // surface.
            let stride = brackets.len().div_ceil(KEPT).max(1);
            let brackets = brackets.into_iter().step_by(stride).collect();
            witnesses = certify_brackets(tape, brackets)?.into_iter().flatten().collect();
            if !witnesses.is_empty() {
                break;
            }
        }
        Ok(Self(witnesses))
    }

    /// The best witness for a triangle.
    pub fn nearest(&self, corners: &[[f64; 3]; 3]) -> Option<SurfaceBall> {
        let mut best = (f64::INFINITY, None);
        for witness in &self.0 {
            let far = witness.farthest_of(corners);
            if far < best.0 {
                best = (far, Some(*witness));
            }
        }
        best.1
    }
}

/// The smaller one of a known bound and the bound by a witness.
pub(super) fn min_with_ball(
    bound: f64,
    witness: Option<SurfaceBall>,
    corners: &[[f64; 3]; 3],
    slack: f64,
) -> f64 {
    witness.map_or(bound, |witness| lesser(bound, add_up(witness.farthest_of(corners), mul_up(2.0, slack))))
}
