//! Curves made to fit each other: the same degree and the same knots.
use super::NurbsCurve;
use super::knots::InvalidNurbs;

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
