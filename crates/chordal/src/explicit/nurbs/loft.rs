//! Lofts: surfaces through a sequence of curves.
//!
//! The sections are made [`compatible`], and a spline in the other direction interpolates their weighted
//! control points and weights, column by column, at the same parameters for all columns. So the surface
//! contains each section at its parameter.
//!
//! *Slack.* With the matrix `A` of the basis functions at the parameters, the exact control points solve
//! `A·c = b`. The computed ones leave a residual; they are off by `|A⁻¹|` times that, and so is every mean of
//! them. For an open loft `A` is totally positive, so that the signs of its inverse alternate and `|A⁻¹|` is
//! the largest entry of the solution for `b = (1, −1, 1, …)`; for a closed loft the inverse is computed.
//! Either is known up to its own residual `ρ < 1`, which adds a factor of `1/(1 − ρ)`. The roundings of the
//! sections enter as parts of `b`.
//!
//! Source: L. Piegl, W. Tiller, *The NURBS Book*, 2nd ed., 1997, 10.3; C. de Boor, A. Pinkus, 1977 (total
//! positivity).
use super::compatible::compatible_slack;
use super::interpolate::{averaged_knots, solved};
use super::knots::{InvalidNurbs, KnotVector};
use super::{NurbsCurve, NurbsSurface, compatible};
use crate::explicit::CurveEnds;
use crate::math::{distance, greater, length, lesser};

/// The most sections of a closed loft, whose matrix is not banded. Chosen: a second of one slow core.
const MOST_AROUND: usize = 1000;

/// The spline across the sections: its knots, the parameters of the sections, and the data for solving.
struct AcrossSections {
    knots: KnotVector,
    parameters: Vec<f64>,
    /// For a closed loft: the inverse of its matrix. For both kinds: a bound of the norm of the inverse.
    inverse: Option<Vec<Vec<f64>>>,
    norm: f64,
}

impl NurbsSurface {
    /// The surface through sections, which are its curves of constant `v`: `u` runs along them, and `v` from
    /// one to the next, by a spline of `degree` with the highest smoothness that the knots permit. A closed
    /// loft continues from the last section to the first. The parameter of a section, from 0 to 1, is the sum
    /// of the chords before it, averaged over all control points. Weights of a section matter only up to a
    /// factor, which is chosen so that the largest is 1. The surface equals the first and the last section of
    /// an open loft, to the bit of their [`compatible`] form, and the others up to rounding;
    /// [`NurbsSurface::slack`] bounds its distance from the exact surface.
    ///
    /// Cost: `n·p²` operations per control point for `n` sections, and `n³` once for a closed loft.
    ///
    /// # Errors
    /// When there are not more sections than the degree, two successive ones are equal, parameters are too
    /// uneven, a weight between sections would not be above 0, or a closed loft has an even degree or more
    /// than 1000 sections.
    ///
    /// ```
    /// use chordal::explicit::{CurveEnds, nurbs::{NurbsCurve, NurbsSurface}};
    /// let ring = |r: f64, z: f64| NurbsCurve::circle([0.0, 0.0, z], [[r, 0.0, 0.0], [0.0, r, 0.0]]);
    /// let vase = NurbsSurface::lofted(&[ring(2.0, 0.0)?, ring(3.0, 2.0)?, ring(1.0, 4.0)?], 2, CurveEnds::Open)?;
    /// assert_eq!(vase.at(0.25, 1.0), [0.0, 1.0, 4.0]);
    /// assert!(vase.slack() < 1e-12);
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn lofted(sections: &[NurbsCurve<3>], degree: usize, ends: CurveEnds) -> Result<Self, InvalidNurbs> {
        KnotVector::clamped(degree, sections.len())?;
        let fitted = compatible(sections)?;
        let slack = sections.iter().zip(&fitted).map(|(a, b)| compatible_slack(a, b)).fold(0.0, greater);
        let across = AcrossSections::new(&fitted, degree, ends)?;
        let rows: Vec<Vec<[f64; 4]>> = fitted.iter().map(weighted_row).collect();
        let (width, n) = (rows[0].len(), rows.len());
        let (mut columns, mut missed) = (Vec::with_capacity(width), [0.0; 2]);
        for i in 0..width {
            let right: Vec<[f64; 4]> = rows.iter().map(|row| row[i]).collect();
            let mut column = across.solve(&right)?;
            // Equal weights stay equal: those that the solver rounds apart would make a polynomial
            // surface rational.
            if right.iter().all(|x| x[3] == right[0][3]) {
                column.iter_mut().for_each(|x| x[3] = right[0][3]);
            }
            missed = across.largest_residual(&column, &right, missed);
            columns.push(across.clamped(column)?);
        }
        let height = columns[0].len();
        let (mut control, mut weights) = (Vec::new(), Vec::new());
        for j in 0..height {
            for (i, column) in columns.iter().enumerate() {
                let [x, y, z, w] = column[j];
                if w <= 0.0 {
                    return Err(InvalidNurbs::SwungWeight { column: i, weight: w });
                }
                // Multiplying by weights and dividing again would move the end curves.
                control.push(match (ends, j) {
                    (CurveEnds::Open, 0) => fitted[0].control()[i],
                    (CurveEnds::Open, j) if j + 1 == height => fitted[n - 1].control()[i],
                    _ => [x / w, y / w, z / w],
                });
                weights.push(w);
            }
        }
        let knots = match ends {
            CurveEnds::Open => across.knots.clone(),
            CurveEnds::Closed => clamped_knots(&across.knots)?,
        };
        let surface = Self::new([fitted[0].knots().clone(), knots], control, weights)?;
        let slack = across.slack(&surface, missed, slack);
        Ok(surface.with_slack(slack))
    }
}

/// The points times their weights, scaled so that the largest weight is 1, and the weights.
fn weighted_row(curve: &NurbsCurve<3>) -> Vec<[f64; 4]> {
    let heaviest = curve.weights().iter().fold(0.0, |heaviest: f64, w| greater(*w, heaviest));
    let pairs = curve.control().iter().zip(curve.weights());
    pairs.map(|([x, y, z], w)| (x, y, z, w / heaviest)).map(|(x, y, z, w)| [x * w, y * w, z * w, w]).collect()
}

/// The knots over the same domain, with both ends repeated `p + 1` times.
fn clamped_knots(knots: &KnotVector) -> Result<KnotVector, InvalidNurbs> {
    let (p, [from, to]) = (knots.degree(), knots.domain());
    let mut clamped = vec![from; p + 1];
    clamped.extend(knots.knots().iter().filter(|t| from < **t && **t < to));
    clamped.extend(vec![to; p + 1]);
    KnotVector::new(p, clamped)
}

/// For each section, the share of the chord to the next section, averaged over the control points; including
/// the chord back to the first section if the loft is closed.
fn mean_chords(sections: &[NurbsCurve<3>], ends: CurveEnds) -> Vec<f64> {
    let n = sections.len();
    let n_chords = if ends == CurveEnds::Closed { n } else { n - 1 };
    let chord = |i: usize, k: usize| distance(sections[(k + 1) % n].control()[i], sections[k].control()[i]);
    let mut sums = vec![0.0; n_chords];
    for i in 0..sections[0].control().len() {
        let chords: Vec<f64> = (0..n_chords).map(|k| chord(i, k)).collect();
        let total: f64 = chords.iter().sum();
        // A control point that all sections share has no chords.
        if total > 0.0 {
            sums.iter_mut().zip(chords).for_each(|(sum, chord)| *sum += chord / total);
        }
    }
    let total: f64 = sums.iter().sum();
    sums.iter().map(|sum| if total > 0.0 { sum / total } else { 0.0 }).collect()
}

impl AcrossSections {
    fn new(sections: &[NurbsCurve<3>], degree: usize, ends: CurveEnds) -> Result<Self, InvalidNurbs> {
        let n = sections.len();
        let mut parameters = vec![0.0];
        for (index, chord) in mean_chords(sections, ends).into_iter().enumerate() {
            let next = parameters[index] + chord;
            // The chord vanishes beside the others.
            if next <= parameters[index] {
                return Err(InvalidNurbs::SameSections(index));
            }
            parameters.push(next);
        }
        // The sum of the chords is 1 only up to rounding.
        if let Some(last) = parameters.last_mut() {
            *last = 1.0;
        }
        if let Some(index) = parameters.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(InvalidNurbs::SameSections(index));
        }
        if ends == CurveEnds::Open {
            let knots = averaged_knots(&parameters, degree)?;
            let mut across = Self { knots, parameters, inverse: None, norm: f64::INFINITY };
            let signs: Vec<[f64; 4]> = (0..n).map(|k| [if k % 2 == 0 { 1.0 } else { -1.0 }; 4]).collect();
            let solution = solved(&across.knots, &across.parameters, &signs)?;
            let [residual, _] = across.largest_residual(&solution, &signs, [0.0; 2]);
            let largest = solution.iter().fold(0.0, |largest: f64, x| greater(x[0].abs(), largest));
            across.norm = norm_within(largest, residual).ok_or(InvalidNurbs::Uneven(0))?;
            return Ok(across);
        }
        if degree.is_multiple_of(2) {
            return Err(InvalidNurbs::EvenDegree(degree));
        }
        if n > MOST_AROUND {
            return Err(InvalidNurbs::ManySections { found: n, most: MOST_AROUND });
        }
        parameters.pop();
        // Starts `degree` knots before 0; adding entire turns keeps indices positive.
        let around = |k: usize| {
            let at = k + n * degree - degree;
            parameters[at % n] + ((at / n) as f64 - degree as f64)
        };
        let knots = KnotVector::new(degree, (0..n + 2 * degree + 1).map(around).collect())?;
        let mut across = Self { knots, parameters, inverse: None, norm: f64::INFINITY };
        let matrix: Vec<Vec<f64>> = (0..n).map(|k| across.row(k)).collect();
        let inverse = inverted(&matrix).ok_or(InvalidNurbs::Uneven(0))?;
        let largest_sum =
            |rows: &[Vec<f64>]| rows.iter().map(|row| row.iter().map(|x| x.abs()).sum()).fold(0.0, greater);
        let inverse_norm = largest_sum(&inverse);
        // A⁻¹ = Z·(A·Z)⁻¹: the difference of A·Z from the identity, with the rounding of its sums of up to p
        // + 1 terms.
        let difference: Vec<Vec<f64>> = matrix
            .iter()
            .enumerate()
            .map(|(i, row)| {
                let entry = |j: usize| {
                    let terms = row.iter().zip(&inverse).filter(|(a, _)| **a != 0.0);
                    let sum: f64 = terms.clone().map(|(a, z)| a * z[j]).sum();
                    let size: f64 = terms.map(|(a, z)| (a * z[j]).abs()).sum();
                    (sum - f64::from(u8::from(i == j))).abs() + across.rounding() * size
                };
                (0..n).map(entry).collect()
            })
            .collect();
        across.norm = norm_within(inverse_norm, largest_sum(&difference)).ok_or(InvalidNurbs::Uneven(0))?;
        across.inverse = Some(inverse);
        Ok(across)
    }

    /// The rounding of a value of the spline, relative to the sum of the sizes of its terms. Derived: each
    /// basis function takes three roundings per degree and the sum one per term; doubled as a margin.
    fn rounding(&self) -> f64 {
        (8 * self.knots.degree() + 16) as f64 * f64::EPSILON
    }

    /// The basis functions at the parameter of a section, by control point of a closed loft.
    fn row(&self, section: usize) -> Vec<f64> {
        let n = self.parameters.len();
        let (first, values) = self.knots.basis(self.parameters[section]);
        let mut row = vec![0.0; n];
        values.iter().enumerate().for_each(|(k, value)| row[(first + k) % n] += value);
        row
    }

    fn solve(&self, right: &[[f64; 4]]) -> Result<Vec<[f64; 4]>, InvalidNurbs> {
        let Some(inverse) = &self.inverse else { return solved(&self.knots, &self.parameters, right) };
        let times = |row: &Vec<f64>| {
            let terms = row.iter().zip(right);
            terms.fold([0.0; 4], |sum, (z, b)| std::array::from_fn(|c| sum[c] + z * b[c]))
        };
        Ok(inverse.iter().map(times).collect())
    }

    /// The larger of the residuals so far and those of these control points: for weighted points, and for
    /// weights.
    fn largest_residual(&self, control: &[[f64; 4]], right: &[[f64; 4]], before: [f64; 2]) -> [f64; 2] {
        let n = control.len();
        let mut largest = before;
        for (t, b) in self.parameters.iter().zip(right) {
            let (first, values) = self.knots.basis(*t);
            let (mut sum, mut size) = ([0.0; 4], [0.0; 4]);
            for (k, value) in values.iter().enumerate() {
                let x = control[(first + k) % n];
                (0..4).for_each(|c| sum[c] += value * x[c]);
                (0..4).for_each(|c| size[c] += value * x[c].abs());
            }
            let residual: [f64; 4] =
                std::array::from_fn(|c| (sum[c] - b[c]).abs() + self.rounding() * size[c]);
            largest = [
                greater(length([residual[0], residual[1], residual[2]]), largest[0]),
                greater(residual[3], largest[1]),
            ];
        }
        largest
    }

    /// The control points of a clamped spline; those of a closed loft end with the first one.
    fn clamped(&self, column: Vec<[f64; 4]>) -> Result<Vec<[f64; 4]>, InvalidNurbs> {
        if self.inverse.is_none() {
            return Ok(column);
        }
        let n = column.len();
        let around: Vec<[f64; 4]> = (0..self.knots.n_control()).map(|k| column[k % n]).collect();
        let ones = vec![1.0; around.len()];
        let curve = NurbsCurve::new(self.knots.clone(), around, ones)?.clamped()?;
        let mut control = curve.control().to_vec();
        if let Some(last) = control.len().checked_sub(1) {
            control[last] = control[0];
        }
        Ok(control)
    }

    /// A bound of the distance of the surface from the exact one, from the residuals of its control points
    /// and the slack of the sections.
    fn slack(&self, surface: &NurbsSurface, [points, weights]: [f64; 2], sections: f64) -> f64 {
        let reach = surface.control().as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
        let lightest = surface.weights().iter().fold(f64::INFINITY, |least: f64, w| lesser(*w, least));
        // A weight of a section has two roundings of its quotient, a product another one.
        let weight_error = if reach > 0.0 { sections / reach } else { 0.0 } + 4.0 * f64::EPSILON;
        let point_error = sections + 8.0 * f64::EPSILON * reach;
        // A closed loft was clamped: 2p knots at each end, of 16 roundings each.
        let clamping = match self.inverse {
            Some(_) => 64.0 * self.knots.degree() as f64 * f64::EPSILON,
            None => 0.0,
        };
        let numerator_error = self.norm * (points + point_error) + clamping * reach;
        let denominator_error = self.norm * (weights + weight_error) + clamping;
        // |X/W − x/w| ≤ (|X − x| + |x/w|·|W − w|)/W, plus the rounding of the quotients; doubled for the
        // roundings of this sum.
        2.0 * ((numerator_error + 2.0 * reach * denominator_error) / lightest + 8.0 * f64::EPSILON * reach)
    }
}

/// A bound of the norm of the exact inverse, from the computed norm and its relative residual; `None` if
/// there is none.
fn norm_within(computed: f64, residual: f64) -> Option<f64> {
    // Chosen: beyond it the matrix is nearly singular.
    (residual <= 0.5 && computed.is_finite()).then(|| computed / (1.0 - residual) * (1.0 + 1e-9))
}

/// The inverse of a matrix by Gauss–Jordan elimination with the largest pivots.
fn inverted(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    let mut left = matrix.to_vec();
    let mut right: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for k in 0..n {
        let pivot = (k..n).fold(k, |best, i| if left[i][k].abs() > left[best][k].abs() { i } else { best });
        left.swap(k, pivot);
        right.swap(k, pivot);
        let pivot_value = left[k][k];
        if pivot_value == 0.0 || !pivot_value.is_finite() {
            return None;
        }
        for row in [&mut left[k], &mut right[k]] {
            row.iter_mut().for_each(|x| *x /= pivot_value);
        }
        let (pivot_left, pivot_right) = (left[k].clone(), right[k].clone());
        for i in (0..n).filter(|i| *i != k) {
            let factor = left[i][k];
            if factor != 0.0 {
                left[i].iter_mut().zip(&pivot_left).for_each(|(x, y)| *x -= factor * y);
                right[i].iter_mut().zip(&pivot_right).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(radius: f64, height: f64) -> NurbsCurve<3> {
        NurbsCurve::circle([0.0, 0.0, height], [[radius, 0.0, 0.0], [0.0, radius, 0.0]]).unwrap()
    }

    #[test]
    fn impossible_lofts_are_refused() {
        let [a, b] = [ring(1.0, 0.0), ring(2.0, 1.0)];
        let refused = |sections: &[NurbsCurve<3>], degree, ends| {
            NurbsSurface::lofted(sections, degree, ends).unwrap_err()
        };
        let open = CurveEnds::Open;
        assert_eq!(refused(&[a.clone(), b.clone()], 2, open), InvalidNurbs::TooFew { degree: 2, points: 2 });
        assert_eq!(refused(&[a.clone(), a.clone(), b.clone()], 1, open), InvalidNurbs::SameSections(0));
        let three = [a.clone(), b.clone(), ring(1.0, 2.0)];
        assert_eq!(refused(&three, 2, CurveEnds::Closed), InvalidNurbs::EvenDegree(2));
        // One corner far heavier than its neighbours: a parabola through 1, 1e-3, 1 dips below 0 in control
        // points.
        let heavy = |weight: f64, z: f64| {
            let knots = KnotVector::clamped(2, 3).unwrap();
            NurbsCurve::new(knots, vec![[0.0, 0.0, z], [1.0, 1.0, z], [2.0, 0.0, z]], vec![1.0, weight, 1.0])
                .unwrap()
        };
        let dips = refused(&[heavy(1.0, 0.0), heavy(1e-3, 1.0), heavy(1.0, 2.0)], 2, open);
        assert!(matches!(dips, InvalidNurbs::SwungWeight { column: 1, weight } if weight < 0.0), "{dips}");
    }

    #[test]
    fn the_norm_of_the_inverse_is_that_of_all_its_entries() {
        let sections: Vec<_> = [0.0, 1.0, 3.0, 3.5, 7.0].map(|z| ring(1.0 + 0.1 * z, z)).into();
        let across = AcrossSections::new(&sections, 3, CurveEnds::Open).unwrap();
        let matrix: Vec<Vec<f64>> = (0..5)
            .map(|k| {
                let (first, values) = across.knots.basis(across.parameters[k]);
                let mut row = vec![0.0; 5];
                values.iter().enumerate().filter(|(_, x)| **x != 0.0).for_each(|(j, x)| row[first + j] = *x);
                row
            })
            .collect();
        let inverse = inverted(&matrix).unwrap();
        let norm = inverse.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, greater);
        assert!((norm - across.norm).abs() < 1e-6 * norm && norm > 1.0, "{norm} {}", across.norm);
    }
}
