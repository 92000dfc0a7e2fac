//! The edges of patches in the report; only from `inspect`.
use chordal::Patch;
use chordal::check::surfaces::{EdgeJoin, EdgeMaximum, surface_edges};
use chordal::explicit::parametric::PatchSide;
use serde::Serialize;

/// The smoothness at the edges between patches.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SurfaceEdgeFacts {
    /// Edges of two sides.
    pub shared: u64,
    /// Sides without neighbour.
    pub boundary: u64,
    /// Curves that are the side of three patches or more.
    pub branching: u64,
    /// Sides that are one point.
    pub collapsed: u64,
    /// Shared edges with opposite fronts of the patches.
    pub opposed: u64,
    /// The shared edges by apparent smoothness.
    pub geometric: GeometricEdgeCounts,
    /// The shared edges by the derivatives across them.
    pub parametric: ParametricEdgeCounts,
    /// The worst edges, at most [`MOST_EDGES`], the worst first: gaps by their width, then kinks by their angle, then
    /// edges where the curvature jumps.
    pub worst: Vec<EdgeFacts>,
}

/// Shared edges by apparent smoothness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct GeometricEdgeCounts {
    /// The sides are not quite one curve.
    pub gaps: u64,
    /// The tangent plane jumps: a kink.
    pub g0: u64,
    /// The tangent plane is continuous and the curvature jumps.
    pub g1: u64,
    /// Tangent plane and curvature are continuous.
    pub g2: u64,
}

/// Shared edges by the derivatives across them; gaps are not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ParametricEdgeCounts {
    /// The first derivative jumps.
    pub c0: u64,
    /// The first derivative is continuous and the second jumps.
    pub c1: u64,
    /// Both are continuous.
    pub c2: u64,
}

/// One edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EdgeFacts {
    /// The two patches, from 0 in the order of the file.
    pub patches: [u64; 2],
    /// The side of each: "bottom" (v = 0), "right" (u = 1), "top" (v = 1) or "left" (u = 0).
    pub sides: [&'static str; 2],
    /// The class Gn; `None` for a gap.
    pub geometric: Option<u8>,
    /// The class Cn; `None` for a gap.
    pub parametric: Option<u8>,
    /// The largest distance of the two sides.
    pub position_gap: EdgeMaximumFacts,
    /// The largest angle between the normals; `None` if a patch has no tangent plane along the edge.
    pub angle_deg: Option<EdgeMaximumFacts>,
    /// The largest difference of the curvatures across the edge; `None` if a patch has no first derivative there.
    pub curvature_gap: Option<EdgeMaximumFacts>,
}

/// The largest value along an edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EdgeMaximumFacts {
    /// The value.
    pub value: f64,
    /// Its place on the first patch: u and v.
    pub uv: [f64; 2],
    /// The point.
    pub at: [f64; 3],
}

/// The most edges that are listed. Chosen: a report stays readable.
pub const MOST_EDGES: usize = 32;

impl SurfaceEdgeFacts {
    /// The facts of all edges of patches.
    #[must_use]
    pub fn from_patches(patches: &[Patch]) -> Self {
        let edges = surface_edges(patches);
        let mut facts = Self {
            shared: edges.joins.len() as u64,
            boundary: edges.boundary.len() as u64,
            branching: edges.branching.len() as u64,
            collapsed: edges.collapsed.len() as u64,
            opposed: edges.joins.iter().filter(|join| !join.fronts_agree).count() as u64,
            ..Self::default()
        };
        for join in &edges.joins {
            facts.geometric.count(join.geometric);
            facts.parametric.count(join.parametric);
        }
        let mut worst: Vec<&EdgeJoin> = edges.joins.iter().filter(|join| join.geometric != Some(2)).collect();
        // Stable, so that equally bad edges stay in the order of the file.
        // Gaps come first: they have no class, and `None` is less than any.
        worst.sort_by(|a, b| a.geometric.cmp(&b.geometric).then(badness(b).total_cmp(&badness(a))));
        facts.worst = worst.into_iter().take(MOST_EDGES).map(EdgeFacts::new).collect();
        facts
    }
}

impl GeometricEdgeCounts {
    /// Counts an edge of a class; `None` is a gap.
    pub(super) fn count(&mut self, class: Option<u8>) {
        *match class {
            None => &mut self.gaps,
            Some(0) => &mut self.g0,
            Some(1) => &mut self.g1,
            Some(_) => &mut self.g2,
        } += 1;
    }
}

impl ParametricEdgeCounts {
    /// Counts an edge of a class; gaps are not counted.
    pub(super) fn count(&mut self, class: Option<u8>) {
        match class {
            None => {}
            Some(0) => self.c0 += 1,
            Some(1) => self.c1 += 1,
            Some(_) => self.c2 += 1,
        }
    }
}

/// The number by which edges of one class are compared.
fn badness(join: &EdgeJoin) -> f64 {
    let value_of = |maximum: Option<EdgeMaximum>| maximum.map_or(f64::INFINITY, |maximum| maximum.value);
    match join.geometric {
        None => join.position_gap.value,
        Some(0) => value_of(join.angle_rad),
        Some(_) => value_of(join.curvature_gap),
    }
}

impl EdgeFacts {
    fn new(join: &EdgeJoin) -> Self {
        let facts = |maximum: EdgeMaximum, value: f64| EdgeMaximumFacts {
            value,
            uv: join.sides[0].side.uv(maximum.t),
            at: maximum.at,
        };
        Self {
            patches: join.sides.map(|id| id.patch as u64),
            sides: join.sides.map(|id| side_name(id.side)),
            geometric: join.geometric,
            parametric: join.parametric,
            position_gap: facts(join.position_gap, join.position_gap.value),
            angle_deg: join.angle_rad.map(|angle| facts(angle, angle.value.to_degrees())),
            curvature_gap: join.curvature_gap.map(|gap| facts(gap, gap.value)),
        }
    }
}

const fn side_name(side: PatchSide) -> &'static str {
    match side {
        PatchSide::Bottom => "bottom",
        PatchSide::Right => "right",
        PatchSide::Top => "top",
        PatchSide::Left => "left",
    }
}
