//! The outline of lines and arcs as closed polylines within the budget.
use super::plane_function::PlaneCurve;
use super::plane_outline::{OutlineEdge, PlaneOutline};
use super::search::ContourGoal;
use crate::budget::{Bound, Bounded, Failure, Job, Reference};
use crate::explicit::Polyline;
use crate::implicit::Field;
use crate::math::elementary::{asin, sin};
use crate::math::{add_up, greater, lesser};
use std::f64::consts::PI;

type PlaneLines = Vec<Polyline<2>>;

/// The outline is taken if its corners are certain to this part of the length. Chosen: arcs have the other three
/// quarters.
const PART: f64 = 0.25;
/// If only segments are counted: to this part of the extent. Defined: too small to be seen.
const FINE: f64 = 1.0 / (1_u64 << 20) as f64;
/// The fraction of the remaining length for sagittas. Derived: their computation takes a dozen roundings.
const SAGITTA_SHARE: f64 = 1.0 - 1.0 / (1_u64 << 20) as f64;
/// The most segments. Defined: as in `search.rs`.
const MOST_SEGMENTS: f64 = (1_u64 << 24) as f64;
/// The memory of a segment. Defined: as in `search.rs`; far more than its points.
const BYTES: f64 = 256.0;
/// Halvings of the interval of a sagitta's exponent.
const HALVINGS: usize = 48;

/// The outline of a field's negative set; `None` if it does not consist of lines and arcs.
pub(in crate::convert) fn outline_lines(
    field: &Field,
    goal: &ContourGoal,
    job: &Job,
) -> Option<Result<Bounded<PlaneLines>, Failure<PlaneLines>>> {
    let evidence = field.evidence();
    if !evidence.bounds_above() {
        return None;
    }
    let bounds = field.bounds();
    let extent = bounds.diagonal();
    let certain = goal.length.map_or(FINE * extent, |length| PART * length);
    let outline = PlaneOutline::from_sign(field.sign(), &bounds, certain, job)?;
    let sagitta = match (goal.length, goal.segments) {
        (Some(length), _) => SAGITTA_SHARE * (length - outline.distance),
        (None, Some(most)) => least_sagitta(&outline, most as f64, extent)?,
        (None, None) => return None,
    };
    let n = n_segments(&outline, sagitta);
    if n > MOST_SEGMENTS || BYTES * n > job.memory_limit as f64 {
        return None;
    }
    let (shape, sagitta_bound) = cut(&outline, sagitta);
    let n: u64 = shape.iter().map(|line| line.n_segments() as u64).sum();
    let bound =
        Bound::with_evidence(0.0, Some(add_up(sagitta_bound, outline.distance)), evidence, Reference::Field);
    let outline_in_lines = Bounded { shape, bound };
    let fits = goal.segments.is_none_or(|most| n <= most);
    Some(outline_in_lines.met_if(fits))
}

/// The segments of an edge of a loop.
fn n_pieces(outline: &PlaneOutline, edge: &OutlineEdge, n_edges: usize, sagitta: f64) -> f64 {
    let PlaneCurve::Circle { radius, .. } = outline.curve(edge) else { return 1.0 };
    // A loop has at least three segments, and none spans more than half of a circle.
    let least = match n_edges {
        1 => 3.0,
        2 => 2.0,
        _ => greater((edge.sweep() / PI).ceil(), 1.0),
    };
    let share = lesser(0.5 * sagitta / radius, 0.5);
    let step = 4.0 * asin(share.sqrt());
    greater((edge.sweep() / step).ceil(), least)
}

fn n_segments(outline: &PlaneOutline, sagitta: f64) -> f64 {
    let of_loop = |path: &Vec<OutlineEdge>| {
        path.iter().fold(0.0, |n, edge| n + n_pieces(outline, edge, path.len(), sagitta))
    };
    outline.loops.iter().fold(0.0, |n, path| n + of_loop(path))
}

/// The least sagitta for so many segments.
fn least_sagitta(outline: &PlaneOutline, most: f64, extent: f64) -> Option<f64> {
    // 2⁻⁴⁰ of the extent: a smaller sagitta would be lost in rounding.
    let (mut low, mut high) = (extent / (1_u64 << 40) as f64, extent);
    if n_segments(outline, high) > most {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = low.sqrt() * high.sqrt();
        if n_segments(outline, middle) > most {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(high)
}

/// The polylines, and the largest sagitta, rounded up.
fn cut(outline: &PlaneOutline, sagitta: f64) -> (PlaneLines, f64) {
    let (mut lines, mut far) = (Vec::with_capacity(outline.loops.len()), 0.0);
    for path in &outline.loops {
        let mut points = Vec::new();
        for edge in path {
            let n = n_pieces(outline, edge, path.len(), sagitta);
            let curve = outline.curve(edge);
            points.push(edge.start);
            points.extend((1..n as u64).map(|k| curve.at(edge.parameter(k as f64 / n))));
            if let PlaneCurve::Circle { radius, .. } = curve {
                let half = sin(0.25 * edge.sweep() / n);
                // The product takes a dozen roundings.
                let high = 2.0 * radius * half * half * (1.0 + 16.0 * f64::EPSILON);
                far = greater(high, far);
            }
        }
        lines.push(Polyline { points, places: Vec::new(), closed: true });
    }
    (lines, far)
}
