//! The knots and edges of NURBS surfaces in the report; only from `inspect`.
use super::surface_edges::{EdgeMaximumFacts, GeometricEdgeCounts, MOST_EDGES, ParametricEdgeCounts};
use chordal::check::surfaces::{EdgeMaximum, NurbsJoin, NurbsLine, nurbs_edges};
use chordal::explicit::nurbs::TrimmedSurface;
use serde::Serialize;

/// How smooth NURBS surfaces are across their knots, and how they meet.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct NurbsEdgeFacts {
    /// Lines of inner knots that were looked at.
    pub knot_lines: u64,
    /// Sides that two surfaces share, or one that closes.
    pub shared: u64,
    /// Sides without neighbour, of surfaces without loops.
    pub boundary: u64,
    /// Sides that more than one other side runs along.
    pub branching: u64,
    /// Sides and lines that are one point.
    pub collapsed: u64,
    /// Shared sides across which the fronts disagree.
    pub opposed: u64,
    /// Both kinds of lines by apparent smoothness.
    pub geometric: GeometricEdgeCounts,
    /// Both kinds of lines by the derivatives across them.
    pub parametric: ParametricEdgeCounts,
    /// The worst of both, at most [`MOST_EDGES`], the worst first.
    pub worst: Vec<NurbsJoinFacts>,
}

/// One line.
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
    /// The largest angle between the normals; `None` where there is no tangent plane along the line.
    pub angle_deg: Option<EdgeMaximumFacts>,
    /// The largest difference of the curvatures across the line; `None` where there is no first derivative.
    pub curvature_gap: Option<EdgeMaximumFacts>,
}

/// Where a line is.
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
        let found = nurbs_edges(surfaces);
        let mut facts = Self {
            knot_lines: found.knot_lines.len() as u64,
            shared: found.joins.len() as u64,
            boundary: found.boundary.len() as u64,
            branching: found.branching.len() as u64,
            collapsed: found.collapsed.len() as u64,
            opposed: found.joins.iter().filter(|join| !join.fronts_agree).count() as u64,
            ..Self::default()
        };
        let all: Vec<&NurbsJoin> = found.joins.iter().chain(&found.knot_lines).collect();
        for join in &all {
            facts.geometric.count(join.geometric);
            facts.parametric.count(join.parametric);
        }
        let mut worst: Vec<&NurbsJoin> = all.into_iter().filter(|join| join.geometric != Some(2)).collect();
        // Stable, so that lines that are as bad stay in order.
        worst.sort_by(|a, b| a.geometric.cmp(&b.geometric).then(badness(b).total_cmp(&badness(a))));
        facts.worst = worst.into_iter().take(MOST_EDGES).map(NurbsJoinFacts::new).collect();
        facts
    }
}

/// What lines of one class are compared by.
fn badness(join: &NurbsJoin) -> f64 {
    let known = |maximum: Option<EdgeMaximum>| maximum.map_or(f64::INFINITY, |maximum| maximum.value);
    match join.geometric {
        None => join.position_gap.value,
        Some(0) => known(join.angle_rad),
        Some(_) => known(join.curvature_gap),
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
