//! Compatible curves: made to have the same degree and the same knots.
use super::NurbsCurve;
use super::curve::scaled_weights;
use super::knots::InvalidNurbs;
use crate::math::{greater, length, lesser};

/// The same curves with a common degree and knot vector, as ruled surfaces and lofts need: the highest
/// degree, clamped, over the domain of the first curve, with the knots of all.
///
/// Knots are the same if they are equal to the bit, after those of other domains are rounded into the domain
/// of the first; no knot is moved. Rounding is that of [`NurbsCurve::elevated`], [`NurbsCurve::with_domain`]
/// and [`NurbsCurve::with_knot`] for each knot of the others.
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
    let degree = curves.iter().fold(0, |highest, curve| curve.knots().degree().max(highest));
    let domain @ [from, to] = first.knots().domain();
    let fitted = |curve: &NurbsCurve<D>| {
        let curve = curve.clamped()?.elevated(degree - curve.knots().degree())?;
        if curve.knots().domain() == domain { Ok(curve) } else { curve.with_domain(from, to) }
    };
    let fitted: Vec<NurbsCurve<D>> = curves.iter().map(fitted).collect::<Result<_, InvalidNurbs>>()?;
    let inner = |curve: &NurbsCurve<D>| -> Vec<f64> {
        curve.knots().knots().iter().copied().filter(|t| from < *t && *t < to).collect()
    };
    let mut knots: Vec<f64> = Vec::new();
    for curve in &fitted {
        knots = union(&knots, &inner(curve));
    }
    fitted.iter().map(|curve| curve.with_knots(&missing(&knots, &inner(curve)))).collect()
}

/// A bound of the distance between a curve and its [`compatible`] version, at corresponding parameters.
///
/// Rounding is that of the steps, one for each knot and each degree. Knots over another domain are rounded by
/// up to `δ`, one unit in the last place of its larger end. The derivative of a spline by its knot `tₖ` is a
/// spline whose control points are `−(Pᵢ₊₁ − Pᵢ)/(tᵢ₊ₚ₊₁ − tᵢ₊₁)` (L. Piegl, W. Tiller, *Computing the
/// derivative of NURBS with respect to a knot*, 1998), and at most `2p` knots matter at a parameter, so that
/// numerator and denominator move by `2pδ` times the largest of these; doubled, since the quotients
/// themselves change meanwhile.
pub(super) fn compatible_slack<const D: usize>(from: &NurbsCurve<D>, to: &NurbsCurve<D>) -> f64 {
    let reach = from.control().as_flattened().iter().fold(0.0, |largest: f64, x| greater(x.abs(), largest));
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
    let lightest = weights.iter().fold(f64::INFINITY, |lightest: f64, w| lesser(*w, lightest));
    let mut steepest = 0.0;
    for i in 0..from.control().len() - 1 {
        let width = (from.knots().knots()[i + p + 1] - from.knots().knots()[i + 1]) * stretch;
        let [v, w] = [weights[i], weights[i + 1]];
        let [x, y] = [from.control()[i], from.control()[i + 1]];
        let step: [f64; D] = std::array::from_fn(|k| y[k] * w - x[k] * v);
        // Width 0 is a knot repeated as often as the degree, which moves with its equals.
        if width > 0.0 {
            steepest = greater((length(step) + D as f64 * reach * (w - v).abs()) / width, steepest);
        }
    }
    rounding + 4.0 * p as f64 * delta * steepest / lightest
}

/// Each number as often as in the one of the two sorted lists that has it more often.
fn union(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut merged = a.to_vec();
    merged.extend(missing(b, a));
    merged.sort_by(f64::total_cmp);
    merged
}

/// The entries of a sorted list that another one lacks, with repetitions.
fn missing(all: &[f64], present: &[f64]) -> Vec<f64> {
    let (mut missing_entries, mut at) = (Vec::new(), 0);
    for t in all {
        while at < present.len() && present[at] < *t {
            at += 1;
        }
        if at < present.len() && present[at] == *t {
            at += 1;
        } else {
            missing_entries.push(*t);
        }
    }
    missing_entries
}
