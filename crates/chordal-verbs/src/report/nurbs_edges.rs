//! The knots and edges of NURBS surfaces in the report; only from `inspect`.
use super::surface_edges::{EdgeMaximumFacts, GeometricEdgeCounts, MOST_EDGES, ParametricEdgeCounts};
use chordal::check::surfaces::{EdgeMaximum, NurbsJoin, NurbsLine, nurbs_edges};
use chordal::explicit::nurbs::TrimmedSurface;
use serde::Serialize;

/// The smoothness of NURBS surfaces across their knots and common edges.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct NurbsEdgeFacts {
    /// Lines of inner knots that were checked.
    pub knot_lines: u64,
    /// Sides that two surfaces share, or that one closed surface has twice.
    pub shared: u64,
    /// Sides without neighbour, of surfaces without loops.
    pub boundary: u64,
    /// Sides with more than one other side along them.
    pub branching: u64,
    /// Sides and lines that are one point.
    pub collapsed: u64,
    /// Shared sides with opposite fronts.
    pub opposed: u64,
    /// Both kinds of lines by apparent smoothness.
    pub geometric: GeometricEdgeCounts,
    /// Both kinds of lines by the derivatives across them.
    pub parametric: ParametricEdgeCounts,
    /// The worst of both kinds, at most [`MOST_EDGES`], the worst first.
    pub worst: Vec<NurbsJoinFacts>,
}

/// One line at which surfaces, or parts of one, meet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NurbsJoinFacts {
    /// The two surfaces, from 0 in the order of the file; the same one twice for its own knots and seams.
    pub surfaces: [u64; 2],
    /// The line of each.
    pub lines: [NurbsLineFacts; 2],
    /// The class Gn; `None` for a gap.
    pub geometric: Option<u8>,
    /// The class Cn; `None` for a gap.
    pub parametric: Option<u8>,
    /// The largest distance.
    pub position_gap: EdgeMaximumFacts,
    /// The largest angle between the normals; `None` if there is no tangent plane along the line.
    pub angle_deg: Option<EdgeMaximumFacts>,
    /// The largest difference of the curvatures across the line; `None` if there is no first derivative.
    pub curvature_gap: Option<EdgeMaximumFacts>,
}

/// The place of a line on a surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NurbsLineFacts {
    /// The parameter that is constant, "u" or "v".
    pub constant: &'static str,
    /// Its value.
    pub at: f64,
}

impl NurbsEdgeFacts {
    /// The facts of all surfaces.
    #[must_use]
    pub fn from_surfaces(surfaces: &[TrimmedSurface]) -> Self {
        let edges = nurbs_edges(surfaces);
        let mut facts = Self {
            knot_lines: edges.knot_lines.len() as u64,
            shared: edges.joins.len() as u64,
            boundary: edges.boundary.len() as u64,
            branching: edges.branching.len() as u64,
            collapsed: edges.collapsed.len() as u64,
            opposed: edges.joins.iter().filter(|join| !join.fronts_agree).count() as u64,
            ..Self::default()
        };
        let joins: Vec<&NurbsJoin> = edges.joins.iter().chain(&edges.knot_lines).collect();
        for join in &joins {
            facts.geometric.count(join.geometric);
            facts.parametric.count(join.parametric);
        }
        let mut worst: Vec<&NurbsJoin> = joins.into_iter().filter(|join| join.geometric != Some(2)).collect();
        // Stable, so that equally bad lines stay in order.
        worst.sort_by(|a, b| a.geometric.cmp(&b.geometric).then(badness(b).total_cmp(&badness(a))));
        facts.worst = worst.into_iter().take(MOST_EDGES).map(NurbsJoinFacts::new).collect();
        facts
    }
}

/// The number by which lines of one class are compared.
fn badness(join: &NurbsJoin) -> f64 {
    let value_of = |maximum: Option<EdgeMaximum>| maximum.map_or(f64::INFINITY, |maximum| maximum.value);
    match join.geometric {
        None => join.position_gap.value,
        Some(0) => value_of(join.angle_rad),
        Some(_) => value_of(join.curvature_gap),
    }
}

impl NurbsJoinFacts {
    fn new(join: &NurbsJoin) -> Self {
        let facts = |maximum: EdgeMaximum, value: f64| EdgeMaximumFacts {
            value,
            uv: join.lines[0].uv(maximum.t),
            at: maximum.at,
        };
        let line = |line: &NurbsLine| NurbsLineFacts {
            constant: if line.constant == 0 { "u" } else { "v" },
            at: line.at,
        };
        Self {
            surfaces: join.lines.map(|line| line.surface as u64),
            lines: join.lines.each_ref().map(line),
            geometric: join.geometric,
            parametric: join.parametric,
            position_gap: facts(join.position_gap, join.position_gap.value),
            angle_deg: join.angle_rad.map(|angle| facts(angle, angle.value.to_degrees())),
            curvature_gap: join.curvature_gap.map(|gap| facts(gap, gap.value)),
        }
    }
}
