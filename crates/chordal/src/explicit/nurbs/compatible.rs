//! Curves made to fit each other: the same degree and the same knots.
use super::NurbsCurve;
use super::curve::scaled_weights;
use super::knots::InvalidNurbs;
use crate::math::{greater, length, lesser};

/// The same curves with one degree and one knot vector for all of them, as ruled surfaces and lofts need: all of the highest
/// degree, clamped, over the domain of the first one, with the knots of all.
///
/// Knots are the same where they are equal to the bit, after those of other domains were rounded into that of the first;
/// none is moved. Rounding as of [`NurbsCurve::elevated`], [`NurbsCurve::with_domain`] and [`NurbsCurve::with_knot`] for each
/// knot of the others.
///
/// # Errors
/// When knots are too close to stay apart in the domain of the first curve, or a number overflows.
///
/// ```
/// use chordal::explicit::nurbs::{NurbsCurve, NurbsSurface, compatible};
/// let line = NurbsCurve::bezier(vec![[2.0, 0.0, 1.0], [-2.0, 0.0, 1.0]])?;
/// let arch = NurbsCurve::arc([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 0.0, std::f64::consts::PI)?;
/// let curves = compatible(&[line, arch])?;
/// assert_eq!(curves[0].knots(), curves[1].knots());
/// assert!(NurbsSurface::ruled(&curves[0], &curves[1]).is_ok());
/// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
/// ```
pub fn compatible<const D: usize>(curves: &[NurbsCurve<D>]) -> Result<Vec<NurbsCurve<D>>, InvalidNurbs> {
    let Some(first) = curves.first() else { return Ok(Vec::new()) };
    let degree = curves.iter().fold(0, |most, curve| curve.knots().degree().max(most));
    let domain @ [from, to] = first.knots().domain();
    let fitted = |curve: &NurbsCurve<D>| {
        let curve = curve.clamped()?.elevated(degree - curve.knots().degree())?;
        if curve.knots().domain() == domain { Ok(curve) } else { curve.with_domain(from, to) }
    };
    let fitted: Vec<NurbsCurve<D>> = curves.iter().map(fitted).collect::<Result<_, InvalidNurbs>>()?;
    let inner = |curve: &NurbsCurve<D>| -> Vec<f64> {
        curve.knots().knots().iter().copied().filter(|t| from < *t && *t < to).collect()
    };
    let mut all: Vec<f64> = Vec::new();
    for curve in &fitted {
        all = union(&all, &inner(curve));
    }
    fitted.iter().map(|curve| curve.with_knots(&missing(&all, &inner(curve)))).collect()
}

/// How far a curve that [`compatible`] made may be from the one that it was made of, at parameters that correspond.
///
/// Rounding is that of its steps, of which each knot and each degree is one. Knots over another domain are rounded by up to
/// `δ`, one unit in the last place of its larger end. The derivative of a spline by its knot `tₖ` is a spline whose control
/// points are `−(Pᵢ₊₁ − Pᵢ)/(tᵢ₊ₚ₊₁ − tᵢ₊₁)` (L. Piegl, W. Tiller, *Computing the derivative of NURBS with respect to a
/// knot*, 1998), and `2p` knots at most matter at a parameter, so that numerator and denominator move by `2pδ` of the largest
/// of these; twice as much covers that the quotients themselves change on the way.
pub(super) fn compatible_slack<const D: usize>(from: &NurbsCurve<D>, to: &NurbsCurve<D>) -> f64 {
    let reach = from.control().as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
    let (p, q) = (from.knots().degree(), to.knots().degree());
    if from.knots() == to.knots() {
        return 0.0;
    }
    let steps = 16 * (to.control().len() + 2 * p) + 20 * (q + 2) * (q - p);
    let rounding = steps as f64 * f64::EPSILON * reach;
    let [[a, b], [c, d]] = [from.knots().domain(), to.knots().domain()];
    if [a, b] == [c, d] {
        return rounding;
    }
    let delta = f64::EPSILON * greater(c.abs(), d.abs());
    let stretch = (d - c) / (b - a);
    let weights = scaled_weights(from.weights());
    let least = weights.iter().fold(f64::INFINITY, |least: f64, w| lesser(*w, least));
    let mut steepest = 0.0;
    for i in 0..from.control().len() - 1 {
        let width = (from.knots().knots()[i + p + 1] - from.knots().knots()[i + 1]) * stretch;
        let [v, w] = [weights[i], weights[i + 1]];
        let [x, y] = [from.control()[i], from.control()[i + 1]];
        let step: [f64; D] = std::array::from_fn(|k| y[k] * w - x[k] * v);
        // No width: a knot as often as the degree, which moves with its equals.
        if width > 0.0 {
            steepest = greater((length(step) + D as f64 * reach * (w - v).abs()) / width, steepest);
        }
    }
    rounding + 4.0 * p as f64 * delta * steepest / least
}

/// Each number as often as in the one of two sorted lists that has it more often.
fn union(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut all = a.to_vec();
    all.extend(missing(b, a));
    all.sort_by(f64::total_cmp);
    all
}

/// What a sorted list has more than another one.
fn missing(all: &[f64], there: &[f64]) -> Vec<f64> {
    let (mut rest, mut at) = (Vec::new(), 0);
    for t in all {
        while at < there.len() && there[at] < *t {
            at += 1;
        }
        if at < there.len() && there[at] == *t {
            at += 1;
        } else {
            rest.push(*t);
        }
    }
    rest
}
