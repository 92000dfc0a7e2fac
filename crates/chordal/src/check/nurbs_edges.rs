//! The edges of NURBS surfaces: their smoothness across knots, and the sides at which two of them meet.
use super::edge_join::{CrossBoundary, EdgeMaximum, EdgePair, STEPS, largest};
use super::nurbs_line::{NurbsBoundary, NurbsLine, SAMPLES};
use crate::explicit::nurbs::{BezierNet, NurbsSurface, TrimmedSurface};
use crate::math::{Box3, distance, greater, lesser};

/// The continuity across a line of one NURBS surface, or across a line at which two of them meet.
///
/// As [`EdgeJoin`](super::surfaces::EdgeJoin) for patches, with the parameters of the surfaces: C1 and C2 compare
/// derivatives by these. Classes and maxima are *measured*, at 33 points of each piece of the line and by a search around
/// the largest; a difference within rounding counts as 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NurbsJoin {
    /// The lines that meet; for knots inside a surface, the same line twice.
    pub lines: [NurbsLine; 2],
    /// Whether the fronts are on the same side. All other results are measured as if they were.
    pub fronts_agree: bool,
    /// The largest distance between corresponding points.
    pub position_gap: EdgeMaximum,
    /// The largest angle between the normals; `None` if there is no tangent plane anywhere on the line. `t`
    /// is the parameter along the first line here and below.
    pub angle_rad: Option<EdgeMaximum>,
    /// The largest difference of the normal curvatures across the line.
    pub curvature_gap: Option<EdgeMaximum>,
    /// Cn, at most 2; `None` for a gap.
    pub parametric: Option<u8>,
    /// Gn, at most 2; `None` for a gap.
    pub geometric: Option<u8>,
}

/// The lines of NURBS surfaces, by what they join.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NurbsEdges {
    /// Across the inner knots of each surface, in order: first those of `u`, then those of `v`.
    pub knot_lines: Vec<NurbsJoin>,
    /// Lines at which the sides of two surfaces, or of one that closes, meet all along.
    pub joins: Vec<NurbsJoin>,
    /// Sides without neighbour.
    pub boundary: Vec<NurbsLine>,
    /// Sides along which more than one other side runs.
    pub branching: Vec<NurbsLine>,
    /// Sides and knot lines that are one point.
    pub collapsed: Vec<NurbsLine>,
}

/// Sides nearer than this share of the shorter one meet, as those of patches do (`surface_edges.rs`).
const NEAR: f64 = 1.0 / 1024.0;
/// A gap of less than this share of the largest coordinate counts as 0. Chosen: more than some roundings of
/// evaluation, and the rounding of files with ten digits.
const MEET: f64 = 1e-9;
/// Positions of points of one side that are searched on another one.
const TRIES: [f64; 5] = [0.0, 0.21, 0.5, 0.77, 1.0];

/// Finds the inner knots of surfaces and the sides that they share, and measures the smoothness of the
/// surfaces there.
///
/// Sides meet if the points of each are on the other one, within a 1,024th of the shorter, for any
/// parameters; if their parameters differ, points are compared with the nearest. A side that is only a part
/// of another one is boundary. The edges of trimmed surfaces are not examined, and of their knots only those
/// within the box of their loops.
///
/// Time: up to 1 ms for each piece of each line, and for pairs of sides whose boxes meet.
///
/// ```
/// use chordal::{check, explicit::nurbs::NurbsSurface};
/// let torus = NurbsSurface::torus(2.0, 0.5)?;
/// let edges = check::surfaces::nurbs_edges(&[torus.into()]);
/// // Quarters of circles in each direction, and both seams: curvature goes on.
/// assert_eq!((edges.knot_lines.len(), edges.joins.len(), edges.boundary.len()), (6, 2, 0));
/// assert!(edges.knot_lines.iter().chain(&edges.joins).all(|join| join.geometric == Some(2)));
/// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
/// ```
#[must_use]
pub fn nurbs_edges(surfaces: &[TrimmedSurface]) -> NurbsEdges {
    let nets: Vec<BezierNet<'_>> = surfaces.iter().map(|face| face.surface().bezier_net()).collect();
    let mut edges = NurbsEdges::default();
    let mut sides: Vec<SurfaceSide<'_>> = Vec::new();
    for (index, (face, net)) in surfaces.iter().zip(&nets).enumerate() {
        let surface = face.surface();
        let size = size_of(surface);
        for (constant, [from, to]) in inner_box(face).into_iter().enumerate() {
            let knots = &surface.knots()[constant];
            let beside = |piece: usize, end: usize| NurbsBoundary::new(surface, net, constant, (piece, end));
            for piece in 1..knots.n_pieces() {
                // Reversed, so that both sides of the line run the same way, as two separate
                // surfaces do after `met`.
                let (before, after) = (beside(piece - 1, 1), beside(piece, 0).reversed());
                let line = before.line(index);
                // Knots outside the loops' box are not on the surface.
                if line.at <= from || to <= line.at {
                    continue;
                }
                if is_point(&before, size) {
                    edges.collapsed.push(line);
                    continue;
                }
                let join = NurbsJoin { fronts_agree: true, ..joined([before, after], [line; 2], 2.0 * size) };
                edges.knot_lines.push(join);
            }
            // The sides of a trimmed surface's rectangle are not its border.
            if face.loops().is_empty() {
                for side in [beside(0, 0), beside(knots.n_pieces() - 1, 1)] {
                    let line = side.line(index);
                    if is_point(&side, size) {
                        edges.collapsed.push(line);
                    } else {
                        sides.push(SurfaceSide::new(side, line, size, face.is_flipped()));
                    }
                }
            }
        }
    }
    add_joins(&sides, &mut edges);
    edges
}

/// A side of a surface, with points of it.
struct SurfaceSide<'a> {
    boundary: NurbsBoundary<'a>,
    line: NurbsLine,
    /// The largest coordinate of the surface.
    size: f64,
    is_flipped: bool,
    bounds: Box3,
    near: f64,
}

impl<'a> SurfaceSide<'a> {
    fn new(boundary: NurbsBoundary<'a>, line: NurbsLine, size: f64, is_flipped: bool) -> Self {
        let points: Vec<[f64; 3]> =
            (0..=SAMPLES).map(|k| boundary.jet(k as f64 / SAMPLES as f64).point).collect();
        let long = points.windows(2).fold(0.0, |sum, pair| sum + distance(pair[1], pair[0]));
        let near = NEAR * long;
        let hull = Box3::from_points(&points);
        // Curves between samples bulge by less than the distance of the samples.
        let margin = near + long / SAMPLES as f64;
        let bounds = Box3 { min: hull.min.map(|x| x - margin), max: hull.max.map(|x| x + margin) };
        Self { boundary, line, size, is_flipped, bounds, near }
    }

    /// The other side, in the direction of this one, and whether it runs counter-clockwise against this one;
    /// `None` if they do not meet.
    fn met(&self, other: &Self) -> Option<(NurbsBoundary<'a>, bool)> {
        let near = lesser(self.near, other.near);
        let distance =
            |a: &NurbsBoundary<'_>, b: &NurbsBoundary<'_>, t: f64| distance(a.jet(t).point, b.jet(t).point);
        // The same parameters, forwards or backwards: the usual case.
        let farthest = |candidate: &NurbsBoundary<'_>| {
            TRIES.iter().map(|t| distance(&self.boundary, candidate, *t)).fold(0.0, greater)
        };
        let directions = [other.boundary.clone(), other.boundary.reversed()];
        let [same, against] = directions.each_ref().map(farthest);
        let [forwards, backwards] = directions;
        // Only an exact correspondence counts, since a small gap between equal parameters need not be one
        // between the sides.
        let exact = MEET * greater(self.size, other.size);
        if lesser(same, against) <= exact {
            let is_against = against <= same;
            return Some((if is_against { backwards } else { forwards }, is_against));
        }
        // Otherwise the ends must meet, and points between them must be on the other side.
        let ends = |candidate: &NurbsBoundary<'a>| {
            greater(distance(&self.boundary, candidate, 0.0), distance(&self.boundary, candidate, 1.0))
                <= near
        };
        let by_middle = |candidate: &NurbsBoundary<'a>| {
            // Sides of one curve may have different parameters; the other one is then looked up by
            // the nearest point. Its direction in the middle tells whether it still runs along,
            // which nearness alone does not.
            let beside_it = candidate.beside(&self.boundary);
            let is_near = TRIES.iter().all(|t| distance(&self.boundary, &beside_it, *t) <= near);
            let runs = beside_it.jet(0.5).along;
            let with = self.boundary.jet(0.5).along;
            let is_along = runs[0] * with[0] + runs[1] * with[1] + runs[2] * with[2] > 0.0;
            (is_near && is_along).then_some(beside_it)
        };
        for (candidate, is_against) in [(&backwards, true), (&forwards, false)] {
            if ends(candidate)
                && let Some(beside_it) = by_middle(candidate)
            {
                return Some((beside_it, is_against));
            }
        }
        None
    }
}

fn add_joins(sides: &[SurfaceSide<'_>], edges: &mut NurbsEdges) {
    // Sorted from left to right, so that only overlapping boxes are compared.
    let mut order: Vec<usize> = (0..sides.len()).collect();
    order.sort_by(|a, b| sides[*a].bounds.min[0].total_cmp(&sides[*b].bounds.min[0]));
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    for (position, first) in order.iter().enumerate() {
        let a = &sides[*first].bounds;
        for second in &order[position + 1..] {
            let b = &sides[*second].bounds;
            if b.min[0] > a.max[0] {
                break;
            }
            let meets = (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k]);
            // By number, since the order of the sweep is not that of the report.
            let (i, j) = (*first.min(second), *first.max(second));
            if meets && sides[i].met(&sides[j]).is_some() {
                pairs.push((i, j));
            }
        }
    }
    pairs.sort_unstable();
    let mut uses = vec![0; sides.len()];
    pairs.iter().for_each(|(i, j)| {
        uses[*i] += 1;
        uses[*j] += 1;
    });
    for (i, j) in pairs {
        let [a, b] = [&sides[i], &sides[j]];
        // Three surfaces at one line are not joined two by two: they are listed as branching.
        if uses[i] > 1 || uses[j] > 1 {
            continue;
        }
        let Some((other, is_against)) = a.met(b) else { continue };
        let size = a.size + b.size;
        let join = joined([a.boundary.clone(), other], [a.line, b.line], size);
        // Sides of surfaces with a common front run against each other. A trimmed surface may have
        // its front turned, which exchanges the two cases; if both are turned, nothing changes.
        let fronts_agree = is_against != (a.is_flipped != b.is_flipped);
        edges.joins.push(NurbsJoin { fronts_agree, ..join });
    }
    for (side, n) in sides.iter().zip(&uses) {
        match n {
            0 => edges.boundary.push(side.line),
            1 => {}
            _ => edges.branching.push(side.line),
        }
    }
}

/// The join of two boundaries that run in the same direction.
fn joined(sides: [NurbsBoundary<'_>; 2], lines: [NurbsLine; 2], size: f64) -> NurbsJoin {
    let roundings = sides.each_ref().map(|side| side.roundings(size));
    let edge = EdgePair { sides, roundings: [0, 1].map(|k| greater(roundings[0][k], roundings[1][k])) };
    let first = edge.sides[0].clone();
    let at = |maximum: (f64, f64)| EdgeMaximum {
        value: maximum.1,
        t: first.parameter(maximum.0),
        at: first.jet(maximum.0).point,
    };
    let steps = first.steps(STEPS);
    let gap = largest(&steps, |t| Some(edge.gap(t))).unwrap_or_default();
    let is_shared = gap.1 <= MEET * size;
    let angles = largest(&edge.approached(&steps), |t| edge.angle(t));
    let bends = largest(&steps, |t| edge.curvature_gap(t));
    let class = match (angles, bends) {
        (Some((_, 0.0)), Some((_, 0.0))) => 2,
        (Some((_, 0.0)), _) => 1,
        _ => 0,
    };
    let parametric = || {
        let (mut slopes, mut curves) = (0.0, 0.0);
        for t in &steps {
            let [a, b] = edge.sides.each_ref().map(|side| side.jet(*t));
            // Both derivatives point into their own surfaces.
            slopes = greater(distance(a.across, b.across.map(|x| -x)), slopes);
            curves = greater(distance(a.bend, b.bend), curves);
        }
        match (slopes <= edge.roundings[0], curves <= edge.roundings[1]) {
            (false, _) => 0,
            (true, false) => 1,
            (true, true) => 2,
        }
    };
    NurbsJoin {
        lines,
        fronts_agree: true,
        // A gap within rounding of evaluation and file is none, so that the class of continuity
        // counts.
        position_gap: at(if is_shared { (gap.0, 0.0) } else { gap }),
        angle_rad: angles.map(at),
        curvature_gap: bends.map(at),
        parametric: is_shared.then(parametric),
        geometric: is_shared.then_some(class),
    }
}

fn size_of(surface: &NurbsSurface) -> f64 {
    surface.control().as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most))
}

/// Whether a line is a single point, up to rounding.
fn is_point(side: &NurbsBoundary<'_>, size: f64) -> bool {
    let first = side.jet(0.0).point;
    // Chosen: more than some roundings of evaluation.
    TRIES.iter().all(|t| distance(side.jet(*t).point, first) <= 1e-13 * size)
}

/// By parameter: the range of a surface's loops; everything without loops.
fn inner_box(face: &TrimmedSurface) -> [[f64; 2]; 2] {
    let whole_plane = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
    if face.loops().is_empty() {
        return whole_plane;
    }
    let empty = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    face.loops().iter().map(crate::explicit::Curve::bounds).fold(empty, |loops_box, [low, high]| {
        [0, 1].map(|k| [lesser(low[k], loops_box[k][0]), greater(high[k], loops_box[k][1])])
    })
}
