//! What takes a closer look: components, which side is out, self-intersections, and what mends what was found.
use super::part_check::PartCheck;
use super::scene_check::SceneCheck;
use super::validity_counts::ValidityCounts;
use crate::flatten::IDENTITY;
use chordal::check::{Component, Cure, Facing, Finding, outward};
use chordal_io::Scene;
use serde::Serialize;

/// What `inspect` says of triangles beyond the counts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceFacts {
    /// Every component is wound with its material inside, cavities with it outside; none where a component has no
    /// inside, or it is not decided. Parts are taken one by one; where self-intersections were looked for, none as
    /// well where one lies within another, which may be its cavity.
    pub outward: Option<bool>,
    /// Components that are wound the other way.
    pub inside_out: u64,
    /// Pairs of triangles that meet where they should not, those of different places of parts among them; none where
    /// nobody asked, or the parts cannot be put in one space.
    pub self_intersections: Option<u64>,
    /// Triangles at a position, on average; none without triangles.
    pub triangles_per_vertex: Option<f64>,
    /// No node moves a part. Else all points, areas and volumes here are in the parts' own coordinates, which are not
    /// those of the scene's box.
    pub in_place: bool,
    /// The area of all triangles, each part once.
    pub area: f64,
    /// The volume inside, in cubed units; none unless the triangles are closed and oriented.
    pub volume: Option<f64>,
    /// The components with the most triangles, at most [`MOST_COMPONENTS`]; `components` counts all.
    pub component_list: Vec<ComponentFacts>,
    /// The cures that were tried on these triangles and help; none where nobody tried.
    #[serde(skip)]
    pub prescribed: Option<Vec<Cure>>,
}

/// The most components that are listed.
pub const MOST_COMPONENTS: usize = 32;

/// One component.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComponentFacts {
    /// The index of its part.
    pub part: u64,
    /// Its first triangle.
    pub first_face: u32,
    /// Its triangles.
    pub triangles: u64,
    /// Its edges.
    pub edges: u64,
    /// Its positions.
    pub positions: u64,
    /// Edges with one triangle.
    pub boundary_edges: u64,
    /// Closed strings of them.
    pub boundary_loops: u64,
    /// No edge has one triangle only.
    pub closed: bool,
    /// No edge has more than two triangles, and those at each position are one fan.
    pub manifold: bool,
    /// Neighbours agree on which side is out.
    pub oriented: bool,
    /// They could.
    pub orientable: bool,
    /// Positions − edges + triangles.
    pub euler: i64,
    /// Handles; none where that means nothing.
    pub genus: Option<u64>,
    /// Its area.
    pub area: f64,
    /// The volume inside, negative where the front looks inward; none without an inside.
    pub volume: Option<f64>,
    /// "outward", "inside-out", "undecided" or "no-inside".
    pub facing: &'static str,
    /// How many others enclose it; none where that is not decided.
    pub depth: Option<u32>,
    /// Its lowest and highest coordinates.
    #[serde(rename = "box")]
    pub bounds: [[f64; 3]; 2],
}

impl ComponentFacts {
    fn new(part: usize, component: &Component) -> Self {
        let has_inside = component.facing != Facing::NoInside;
        Self {
            part: part as u64,
            first_face: component.first_face,
            triangles: component.faces,
            edges: component.edges,
            positions: component.positions,
            boundary_edges: component.boundary_edges,
            boundary_loops: component.boundary_loops,
            closed: component.closed,
            manifold: component.manifold(),
            oriented: component.oriented,
            orientable: component.orientable,
            euler: component.euler,
            genus: component.genus,
            area: component.measure.area,
            volume: has_inside.then_some(component.measure.signed_volume),
            facing: component.facing.as_str(),
            depth: component.depth,
            bounds: [component.bounds.min, component.bounds.max],
        }
    }
}

impl SurfaceFacts {
    pub(super) fn new(parts: &[&PartCheck], counts: &ValidityCounts, scene: &Scene) -> Self {
        let sum = |f: fn(&PartCheck) -> f64| parts.iter().fold(0.0, |sum, part| sum + f(part));
        let crossing: Option<Vec<&Finding>> =
            parts.iter().map(|part| part.self_intersections.as_ref()).collect();
        let volume = sum(|part| part.found.measure.signed_volume);
        Self {
            outward: outward_of(parts),
            inside_out: parts.iter().map(|part| part.inside_out.count).sum(),
            self_intersections: crossing.map(|all| all.iter().map(|finding| finding.count).sum()),
            triangles_per_vertex: triangles_per_vertex(parts),
            in_place: scene.nodes.iter().all(|node| node.matrix == IDENTITY),
            area: sum(|part| part.found.measure.area),
            volume: (counts.closed && counts.oriented).then_some(volume),
            component_list: largest(parts),
            prescribed: None,
        }
    }

    /// Adds what only shows where all parts stand.
    pub(super) fn add_scene_check(&mut self, together: &SceneCheck) {
        let alone = self.self_intersections.unwrap_or(0);
        // Where parts could not be put together, those that were found are there, but that there are none is not known.
        self.self_intersections = match together.crossing {
            Some(crossing) => Some(alone + crossing),
            None => (alone > 0).then_some(alone),
        };
        // Parts within parts are bodies or cavities: only where both readings agree is it known which side is out.
        if self.outward == Some(true) && together.outward != Some(true) {
            self.outward = None;
        }
    }
}

/// As for one mesh, over all parts with triangles.
fn outward_of(parts: &[&PartCheck]) -> Option<bool> {
    let filled = parts.iter().filter(|part| !part.components.is_empty());
    let each: Vec<Option<bool>> = filled.map(|part| outward(&part.components)).collect();
    if each.contains(&Some(false)) {
        return Some(false);
    }
    (!each.is_empty() && !each.contains(&None)).then_some(true)
}

/// The mean over the positions of all parts that take part.
fn triangles_per_vertex(parts: &[&PartCheck]) -> Option<f64> {
    let found = || parts.iter().map(|part| &part.found);
    let faces: u64 = found().map(|found| found.triangles - found.collapsed_faces.count).sum();
    // Euler's formula the other way round: positions that take part are χ + edges − faces.
    let edges: u64 = found().map(|found| found.edges).sum();
    let positions = found().map(|found| found.euler).sum::<i64>() + edges as i64 - faces as i64;
    (positions > 0).then(|| 3.0 * faces as f64 / positions as f64)
}

fn largest(parts: &[&PartCheck]) -> Vec<ComponentFacts> {
    let all = parts.iter().enumerate();
    let all = all.flat_map(|(part, found)| found.components.iter().map(move |component| (part, component)));
    let mut all: Vec<(usize, &Component)> = all.collect();
    all.sort_by_key(|(part, component)| (std::cmp::Reverse(component.faces), *part, component.first_face));
    all.truncate(MOST_COMPONENTS);
    all.into_iter().map(|(part, component)| ComponentFacts::new(part, component)).collect()
}
