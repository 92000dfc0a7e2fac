//! `HermiteFit`: the cubic with given ends and end directions that is nearest to points between them.
//!
//! The two handle lengths are its only unknowns. Each point is compared with its nearest point of the cubic, only across
//! the cubic, because a shift along it changes nothing: the Gauss–Newton method for the sum of squares of the components
//! across, damped if a step does not help (K. Levenberg, 1944). For curves that bend one way this reaches the sixth order
//! of C. de Boor, K. Höllig and M. Sabin, *High accuracy geometric Hermite interpolation*, 1987.
//!
//! The fit proves nothing; the bound of the result is computed from its control points afterwards.
use super::least_squares::solve;
use crate::explicit::Bezier;
use crate::math::{difference, distance, dot, greater, lesser};

/// A cubic, and for each of the points its parameter on it.
#[derive(Clone, Debug)]
pub(crate) struct HermiteFit<const D: usize> {
    pub cubic: Bezier<D>,
    pub places: Vec<f64>,
}

/// The most steps. Chosen: convergence is quadratic, and random spans of curves took 5 to 9.
const MOST_STEPS: u32 = 24;
/// The least and the largest handle, as multiples of a third of the points' length. Chosen: shorter handles have no
/// direction, longer ones loop.
const HANDLES: [f64; 2] = [1e-3, 6.0];

struct HermiteProblem<'a, const D: usize> {
    /// The points relative to the first one, divided by their size.
    points: Vec<[f64; D]>,
    directions: &'a [[f64; D]; 2],
    total: f64,
}

/// The sum of squares at a pair of handles, its slope, and its curvature by Gauss and Newton.
struct HermiteCost {
    sum: f64,
    slope: [f64; 2],
    matrix: [[f64; 2]; 2],
}

/// The cubic from the first to the last point (three at least) along `directions`, unit vectors.
pub(crate) fn fit<const D: usize>(points: &[[f64; D]], directions: &[[f64; D]; 2]) -> HermiteFit<D> {
    let (first, last) = (points[0], points[points.len() - 1]);
    let size = points
        .iter()
        .fold(0.0, |size, p| (0..D).fold(size, |size: f64, k| greater((p[k] - first[k]).abs(), size)));
    let scaled: Vec<[f64; D]> =
        points.iter().map(|p| std::array::from_fn(|k| (p[k] - first[k]) / size)).collect();
    let mut places = chord_places(&scaled);
    let total = scaled.windows(2).fold(0.0, |sum, pair| sum + distance(pair[1], pair[0]));
    let problem = HermiteProblem { points: scaled, directions, total };
    let mut handles = [total / 3.0; 2];
    let mut cost = problem.cost(&handles, &mut places);
    // Damping: relative to the matrix' own diagonal. Chosen, as by D. Marquardt, 1963.
    let mut damping = 1e-6;
    for _ in 0..MOST_STEPS {
        let Some(next) = problem.step(&handles, &cost, damping) else { break };
        let mut moved = places.clone();
        let next_cost = problem.cost(&next, &mut moved);
        let gain = cost.sum - next_cost.sum;
        if gain >= 0.0 {
            // Chosen: further steps would change the distance by a millionth.
            let is_done = gain <= 1e-6 * cost.sum;
            (handles, places, cost) = (next, moved, next_cost);
            damping *= 0.1;
            if is_done {
                break;
            }
        } else if damping > 1e6 || gain.is_nan() {
            break;
        } else {
            damping *= 30.0;
        }
    }
    let handle = |from: [f64; D], direction: [f64; D], length: f64| {
        std::array::from_fn(|k| from[k] + length * size * direction[k])
    };
    let [a, b] = handles;
    let cubic =
        Bezier { control: [first, handle(first, directions[0], a), handle(last, directions[1], -b), last] };
    HermiteFit { cubic, places }
}

/// Parameters from 0 to 1 by chord length.
fn chord_places<const D: usize>(points: &[[f64; D]]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut places = vec![0.0];
    for pair in points.windows(2) {
        sum += distance(pair[1], pair[0]);
        places.push(sum);
    }
    places.iter().map(|x| if sum > 0.0 { x / sum } else { 0.0 }).collect()
}

impl<const D: usize> HermiteProblem<'_, D> {
    fn cubic(&self, [a, b]: &[f64; 2]) -> Bezier<D> {
        let (first, last) = (self.points[0], self.points[self.points.len() - 1]);
        let [t, u] = self.directions;
        Bezier {
            control: [
                first,
                std::array::from_fn(|k| first[k] + a * t[k]),
                std::array::from_fn(|k| last[k] - b * u[k]),
                last,
            ],
        }
    }

    /// Moves the parameters to the feet of the points, and adds up the squares of the components across the cubic.
    fn cost(&self, handles: &[f64; 2], places: &mut [f64]) -> HermiteCost {
        let cubic = self.cubic(handles);
        let mut cost = HermiteCost { sum: 0.0, slope: [0.0; 2], matrix: [[0.0; 2]; 2] };
        // The first and the last point are ends of the cubic, whatever the handles.
        for (point, place) in self.points.iter().zip(places.iter_mut()).skip(1).take(self.points.len() - 2) {
            *place = foot(&cubic, *point, *place);
            let s = *place;
            let offset = difference(cubic.at(s), *point);
            let tangent = cubic.tangent(s);
            let square = dot(tangent, tangent);
            let across = |v: [f64; D]| -> [f64; D] {
                let along = if square > 0.0 { dot(v, tangent) / square } else { 0.0 };
                std::array::from_fn(|k| v[k] - along * tangent[k])
            };
            let residual = across(offset);
            // The derivatives of the cubic's point by both handles.
            let (first, second) = (3.0 * (1.0 - s) * (1.0 - s) * s, -3.0 * (1.0 - s) * s * s);
            let derivative = [
                across(self.directions[0].map(|x| first * x)),
                across(self.directions[1].map(|x| second * x)),
            ];
            cost.sum += dot(residual, residual);
            for i in 0..2 {
                cost.slope[i] += dot(derivative[i], residual);
                for j in 0..2 {
                    cost.matrix[i][j] += dot(derivative[i], derivative[j]);
                }
            }
        }
        cost
    }

    fn step(&self, handles: &[f64; 2], cost: &HermiteCost, damping: f64) -> Option<[f64; 2]> {
        let mut matrix = cost.matrix;
        for (k, row) in matrix.iter_mut().enumerate() {
            // The small number damps a diagonal of 0 as well.
            row[k] += damping * row[k] + f64::MIN_POSITIVE;
        }
        let [[a], [b]] = solve(matrix, cost.slope.map(|x| [x]))?;
        let [least, most] = HANDLES.map(|part| part * self.total / 3.0);
        let within = |x: f64| greater(least, lesser(x, most));
        Some([within(handles[0] - a), within(handles[1] - b)])
    }
}

/// The parameter of a cubic's point that is nearest to a point, from a nearby parameter on: Newton's method on the
/// derivative of the squared distance.
pub(crate) fn foot<const D: usize>(cubic: &Bezier<D>, point: [f64; D], near: f64) -> f64 {
    let mut s = near;
    // Chosen: the given parameters are nearly right already.
    for _ in 0..4 {
        let offset = difference(cubic.at(s), point);
        let (tangent, bend) = (cubic.tangent(s), cubic.second_derivative(s));
        let square = dot(tangent, tangent);
        let curved = square + dot(offset, bend);
        // If the second derivative is too small or negative, the step uses the tangent alone.
        let second_derivative = if curved > 0.25 * square { curved } else { square };
        let step = dot(offset, tangent) / second_derivative;
        if !step.is_finite() {
            break;
        }
        let next = greater(0.0, lesser(s - step, 1.0));
        let moved = (next - s).abs();
        s = next;
        // Chosen: the next step would be within rounding.
        if moved < 1e-12 {
            break;
        }
    }
    s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::length;

    #[test]
    fn a_quarter_of_a_circle_is_met_better_than_by_the_usual_handles() {
        let points: Vec<[f64; 2]> = (0..=12)
            .map(|i| libm::sincos(f64::from(i) / 12.0 * std::f64::consts::FRAC_PI_2))
            .map(|(s, c)| [c, s])
            .collect();
        let fitted = fit(&points, &[[0.0, 1.0], [-1.0, 0.0]]);
        let worst = (0..=1000)
            .map(|i| length(fitted.cubic.at(f64::from(i) / 1000.0)) - 1.0)
            .fold(0.0, |most: f64, x| greater(x.abs(), most));
        // With handles of 4/3·tan(π/8) it is 2.73e-4; the best is 1.96e-4.
        assert!(worst < 2.5e-4, "{worst}");
        let [_, a, b, _] = fitted.cubic.control;
        assert!((a[1] - b[0]).abs() < 1e-9 && (a[1] - 0.552).abs() < 1e-3, "{a:?} {b:?}");
    }

    #[test]
    fn a_cubic_is_found_again_from_its_points() {
        let cubic = Bezier { control: [[0.0, 0.0, 1.0], [1.0, 2.0, 0.0], [3.0, 2.0, 1.0], [4.0, 0.0, 3.0]] };
        let points: Vec<_> = (0..=12).map(|i| cubic.at(f64::from(i) / 12.0)).collect();
        let directions = [cubic.tangent(0.0), cubic.tangent(1.0)].map(|t| t.map(|x| x / length(t)));
        let fitted = fit(&points, &directions);
        for (p, q) in cubic.control.iter().zip(fitted.cubic.control) {
            assert!(distance(*p, q) < 1e-5, "{p:?} {q:?}");
        }
    }
}
