//! Coons patches: the surface between four boundary curves, bilinearly blended.
//!
//! With `c₀, c₁` along `u` and `d₀, d₁` along `v`, and `s`, `t` the fractions of the two domains, it is
//! `(1−t)·c₀ + t·c₁ + (1−s)·d₀ + s·d₁` minus the bilinear surface through the corners. `s` and `t` are
//! splines over any knots, with the means of `p` of them as coefficients (Greville), so that polynomial
//! curves give a polynomial spline of their own degrees and knots.
//!
//! If curves have weights, let `W(u)` be the common denominator of `c₀` and `c₁` (their own if these are
//! equal up to a factor, otherwise their product) and `V(v)` that of `d₀` and `d₁`. Times `W·V` each term is
//! a polynomial in `u` times one in `v`, so the surface is rational, exactly, with one degree more than the
//! denominators. Its weights are those of `W·V`, products and means of weights above 0.
//!
//! *Slack.* The surface is linear in its curves, with factors from 0 to 1: if the curves along `u` are off by
//! `a` and those along `v` by `b`, the surface is off by at most `2(a + b)`, the corners included. Every
//! coefficient of the numerator is a sum of products of three terms with factors that add up to 1, each below
//! `R` times the coefficient of the denominator, with `R` the largest coordinate; rounding of pieces,
//! products and sums takes less than `64(p + q + 4)·ε` of each.
//!
//! Source: S. A. Coons, *Surfaces for computer-aided design of space forms*, 1967; L. Piegl, W. Tiller, *The
//! NURBS Book*, 2nd ed., 1997, 10.5; G. Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, 22.
use super::compatible::compatible_slack;
use super::curve::scaled_weights;
use super::knots::{InvalidNurbs, KnotVector};
use super::{NurbsCurve, NurbsSurface, binomials, compatible};
use crate::math::{distance, greater};

/// Ends of curves meet if they are this close, relative to the largest coordinate. Chosen: the rounding of
/// files with ten digits.
const MEET: f64 = 1e-9;

/// Polynomials in one parameter in Bernstein form, over one piece, all of the same degree.
struct BlendFactors {
    /// The numerators of the two curves along this parameter.
    curves: [Vec<[f64; 3]>; 2],
    /// The denominator.
    weights: Vec<f64>,
    /// The denominator times `1 − s`, and times `s`, for the fraction `s` of this domain.
    shares: [Vec<f64>; 2],
}

impl NurbsSurface {
    /// The Coons patch between four curves: two along `u`, at the start and at the end of `v`, and two along
    /// `v`, at the start and at the end of `u`.
    ///
    /// Curves may have any degrees, knots and weights; opposite ones are made [`compatible`]. The patch is
    /// exact, a polynomial spline if all curves are, otherwise rational, and [`NurbsSurface::slack`] bounds
    /// the rounding. Ends that are up to a billionth of the largest coordinate apart count as meeting: those
    /// of the curves along `v` are moved, and the gap is part of the slack.
    ///
    /// # Errors
    /// When curves do not meet in a corner, or different weights lead to a degree beyond 30: `2p + 1` for the
    /// two along one direction.
    ///
    /// ```
    /// use chordal::explicit::nurbs::{NurbsCurve, NurbsSurface};
    /// let arch = |y: f64| NurbsCurve::bezier(vec![[0.0, y, 0.0], [1.0, y, 2.0], [2.0, y, 0.0]]);
    /// let line = |x: f64| NurbsCurve::line([x, 0.0, 0.0], [x, 3.0, 0.0]);
    /// let tunnel = NurbsSurface::coons([&arch(0.0)?, &arch(3.0)?], [&line(0.0)?, &line(2.0)?])?;
    /// assert_eq!(tunnel.at(0.5, 0.5), [1.0, 1.5, 1.0]);
    /// let away = NurbsSurface::coons([&arch(0.0)?, &arch(3.0)?], [&line(0.0)?, &line(2.5)?]).unwrap_err();
    /// assert!(away.to_string().contains("they are 5e-1 apart"));
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn coons(along_u: [&NurbsCurve<3>; 2], along_v: [&NurbsCurve<3>; 2]) -> Result<Self, InvalidNurbs> {
        let (c, of_u) = facing(along_u)?;
        let (mut d, of_v) = facing(along_v)?;
        let coordinates = c.iter().chain(&d).flat_map(|curve| curve.control().as_flattened());
        let reach = coordinates.fold(0.0, |largest: f64, x| greater(x.abs(), largest));
        let corners = [0, 1].map(|j| [0, 1].map(|i| end(&c[j], i)));
        let mut gap = 0.0;
        for (j, row) in corners.iter().enumerate() {
            for (i, corner) in row.iter().enumerate() {
                let apart = distance(end(&d[i], j), *corner);
                if apart > MEET * reach {
                    return Err(InvalidNurbs::Corner { corner: i + 2 * j, gap: apart, limit: MEET * reach });
                }
                gap = greater(apart, gap);
            }
        }
        for (i, curve) in d.iter_mut().enumerate() {
            let (mut control, last) = (curve.control().to_vec(), curve.control().len() - 1);
            (control[0], control[last]) = (corners[0][i], corners[1][i]);
            *curve = NurbsCurve::new(curve.knots().clone(), control, curve.weights().to_vec())?;
        }
        let is_polynomial = c.iter().chain(&d).all(NurbsCurve::is_polynomial);
        let surface = if is_polynomial { polynomial(&c, &d, corners) } else { rational(&c, &d, corners) }?;
        let degrees: usize = surface.knots().iter().map(KnotVector::degree).sum();
        let rounding = 64.0 * (degrees + 4) as f64 * f64::EPSILON * 3.0 * reach;
        // Doubled for the roundings of this sum.
        Ok(surface.with_slack(2.0 * (2.0 * (of_u + of_v + gap) + rounding)))
    }
}

/// Two opposite curves made compatible and clamped, and a bound of the change.
fn facing(curves: [&NurbsCurve<3>; 2]) -> Result<([NurbsCurve<3>; 2], f64), InvalidNurbs> {
    let originals = curves.map(Clone::clone);
    let fitted = compatible(&originals)?;
    let slack = originals.iter().zip(&fitted).map(|(a, b)| compatible_slack(a, b)).fold(0.0, greater);
    let [Ok(a), Ok(b)] = [0, 1].map(|k| fitted.get(k).cloned().ok_or(InvalidNurbs::Knots)) else {
        return Err(InvalidNurbs::Knots);
    };
    Ok(([a, b], slack))
}

/// The first or the last point of a clamped curve.
fn end(curve: &NurbsCurve<3>, side: usize) -> [f64; 3] {
    curve.control()[side * (curve.control().len() - 1)]
}

/// The fraction of the domain, as a spline over the knots: 0 at the first control point, 1 at the last.
fn parts(knots: &KnotVector) -> Vec<f64> {
    let (p, [from, to]) = (knots.degree(), knots.domain());
    let part = |t: &f64| (t - from) / (to - from);
    (0..knots.n_control())
        .map(|i| knots.knots()[i + 1..=i + p].iter().map(part).sum::<f64>() / p as f64)
        .collect()
}

fn polynomial(
    c: &[NurbsCurve<3>; 2],
    d: &[NurbsCurve<3>; 2],
    corners: [[[f64; 3]; 2]; 2],
) -> Result<NurbsSurface, InvalidNurbs> {
    let knots = [c[0].knots().clone(), d[0].knots().clone()];
    let [along_u, along_v] = knots.each_ref().map(parts);
    let (n, m) = (along_u.len(), along_v.len());
    let mut control = Vec::with_capacity(n * m);
    for (j, t) in along_v.iter().enumerate() {
        for (i, s) in along_u.iter().enumerate() {
            control.push(match (i, j) {
                // The boundary exactly as given.
                (i, 0) => c[0].control()[i],
                (i, j) if j + 1 == m => c[1].control()[i],
                (0, j) => d[0].control()[j],
                (i, j) if i + 1 == n => d[1].control()[j],
                (i, j) => std::array::from_fn(|k| {
                    let across = (1.0 - t) * c[0].control()[i][k] + t * c[1].control()[i][k];
                    let along = (1.0 - s) * d[0].control()[j][k] + s * d[1].control()[j][k];
                    let row = |j: usize| (1.0 - s) * corners[j][0][k] + s * corners[j][1][k];
                    across + (along - ((1.0 - t) * row(0) + t * row(1)))
                }),
            });
        }
    }
    NurbsSurface::new(knots, control, vec![1.0; n * m])
}

fn rational(
    c: &[NurbsCurve<3>; 2],
    d: &[NurbsCurve<3>; 2],
    corners: [[[f64; 3]; 2]; 2],
) -> Result<NurbsSurface, InvalidNurbs> {
    let (of_u, of_v) = (BlendFactors::pieces(c), BlendFactors::pieces(d));
    let degree = |factors: &[BlendFactors]| factors[0].weights.len() - 1;
    let (p, q) = (degree(&of_u), degree(&of_v));
    let knots = [full_knots(c[0].knots(), p)?, full_knots(d[0].knots(), q)?];
    let (n, m) = (of_u.len() * p + 1, of_v.len() * q + 1);
    // Neighbouring pieces share a control point, which counts as the first of the later one; the
    // last of all has none later.
    let place = |k: usize, degree: usize, pieces: usize| {
        let piece = (k / degree).min(pieces - 1);
        (piece, k - piece * degree)
    };
    let (mut control, mut weights) = (Vec::with_capacity(n * m), Vec::with_capacity(n * m));
    for row in 0..m {
        let (b, j) = place(row, q, of_v.len());
        let v = &of_v[b];
        for column in 0..n {
            let (a, i) = place(column, p, of_u.len());
            let u = &of_u[a];
            let w = u.weights[i] * v.weights[j];
            let x: [f64; 3] = std::array::from_fn(|k| {
                let across = u.curves[0][i][k] * v.shares[0][j] + u.curves[1][i][k] * v.shares[1][j];
                let along = u.shares[0][i] * v.curves[0][j][k] + u.shares[1][i] * v.curves[1][j][k];
                let row = |t: usize| u.shares[0][i] * corners[t][0][k] + u.shares[1][i] * corners[t][1][k];
                across + (along - (v.shares[0][j] * row(0) + v.shares[1][j] * row(1)))
            });
            control.push(x.map(|x| x / w));
            weights.push(w);
        }
    }
    NurbsSurface::new(knots, control, weights)
}

/// The knots of the pieces with a degree: each knot inside the domain is repeated as often as the degree.
fn full_knots(knots: &KnotVector, degree: usize) -> Result<KnotVector, InvalidNurbs> {
    let [from, to] = knots.domain();
    let mut repeated = vec![from; degree + 1];
    (1..knots.n_pieces()).for_each(|k| repeated.extend(vec![knots.piece(k)[0]; degree]));
    repeated.extend(vec![to; degree + 1]);
    KnotVector::new(degree, repeated)
}

impl BlendFactors {
    /// The factors for two curves with the same knots, piece by piece.
    fn pieces(curves: &[NurbsCurve<3>; 2]) -> Vec<Self> {
        let (knots, [from, to]) = (curves[0].knots(), curves[0].knots().domain());
        let p = knots.degree();
        let scaled = curves.each_ref().map(|curve| scaled_weights(curve.weights()));
        let is_polynomial = curves.iter().all(NurbsCurve::is_polynomial);
        // Equal up to a factor: compared exactly, since taking the product instead is always correct.
        let is_equal = scaled[0] == scaled[1];
        let rows: [Vec<[f64; 4]>; 2] = [0, 1].map(|k| {
            let homogeneous = |(x, w): (&[f64; 3], &f64)| [x[0] * w, x[1] * w, x[2] * w, *w];
            let ones = vec![1.0; scaled[k].len()];
            let weights = if is_polynomial { &ones } else { &scaled[k] };
            knots.to_bezier(&curves[k].control().iter().zip(weights).map(homogeneous).collect::<Vec<_>>())
        });
        let piece = |index: usize| {
            let [x, y] = rows.each_ref().map(|row| &row[index * p..=(index + 1) * p]);
            let points = |row: &[[f64; 4]]| row.iter().map(|x| [x[0], x[1], x[2]]).collect::<Vec<_>>();
            let weights = |row: &[[f64; 4]]| row.iter().map(|x| [x[3]]).collect::<Vec<_>>();
            let (curves, denominator) = if is_polynomial {
                ([points(x), points(y)], vec![[1.0]])
            } else if is_equal {
                ([points(x), points(y)], weights(x))
            } else {
                let [v, w] = [weights(x), weights(y)];
                ([product(&points(x), &w), product(&points(y), &v)], product(&v, &w))
            };
            // The fractions at the ends of the piece. A product with one has a degree more than the
            // denominator, which is the number of its coefficients.
            let [a, b] = knots.piece(index).map(|t| (t - from) / (to - from));
            let degree = (curves[0].len() - 1).max(denominator.len());
            let share = |ends: [f64; 2]| flat(&raised(&product(&denominator, &ends.map(|x| [x])), degree));
            Self {
                curves: curves.map(|curve| raised(&curve, degree)),
                weights: flat(&raised(&denominator, degree)),
                shares: [share([1.0 - a, 1.0 - b]), share([a, b])],
            }
        };
        (0..knots.n_pieces()).map(piece).collect()
    }
}

fn flat(row: &[[f64; 1]]) -> Vec<f64> {
    row.iter().map(|[x]| *x).collect()
}

/// The product of two polynomials in Bernstein form.
fn product<const N: usize>(a: &[[f64; N]], b: &[[f64; 1]]) -> Vec<[f64; N]> {
    let (n, m) = (a.len() - 1, b.len() - 1);
    let [of_a, of_b, of_both] = [n, m, n + m].map(binomials);
    let mut product = vec![[0.0; N]; n + m + 1];
    for (i, x) in a.iter().enumerate() {
        for (j, [y]) in b.iter().enumerate() {
            let factor = of_a[i] * of_b[j] / of_both[i + j] * y;
            (0..N).for_each(|k| product[i + j][k] += factor * x[k]);
        }
    }
    product
}

/// The same polynomial with a higher degree.
fn raised<const N: usize>(row: &[[f64; N]], degree: usize) -> Vec<[f64; N]> {
    product(row, &vec![[1.0]; degree + 2 - row.len()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_of_a_disc_has_its_four_arcs_as_boundary() {
        // Four arcs of one circle, two of them with other weights: the denominators differ.
        let s = 0.5_f64.sqrt();
        let arc = |from: f64, sweep: f64| {
            let quarter = std::f64::consts::FRAC_PI_2;
            let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
            NurbsCurve::arc([0.0; 3], axes, from * quarter, sweep * quarter).unwrap()
        };
        let c = [arc(2.5, 1.0), arc(1.5, -1.0)];
        let d = [arc(2.5, -1.0), arc(-0.5, 1.0)];
        let other = NurbsCurve::new(c[1].knots().clone(), c[1].control().to_vec(), vec![1.0, 2.0 * s, 4.0]);
        let patch = NurbsSurface::coons([&c[0], &other.unwrap()], [&d[0], &d[1]]).unwrap();
        for k in 0..=16 {
            let t = f64::from(k) / 16.0;
            for [x, y, z] in [patch.at(t, 0.0), patch.at(t, 1.0), patch.at(0.0, t), patch.at(1.0, t)] {
                assert!((x.hypot(y) - 1.0).abs() < 1e-14 && z == 0.0, "{t} {x} {y}");
            }
        }
        // 2·64·(5 + 3 + 4)·ε·3·√2, as derived above, and the roundings of the corners.
        assert!(patch.slack() < 2e-12, "{:e}", patch.slack());
        assert_eq!(patch.knots().each_ref().map(KnotVector::degree), [5, 3]);
        let [x, y, _] = patch.at(0.5, 0.5);
        assert!(x.hypot(y) < 0.2, "{x} {y}");
    }
}
