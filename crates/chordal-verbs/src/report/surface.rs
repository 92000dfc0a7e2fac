//! The detailed part of a validity check: components, orientation, self-intersections, and repairs.
use super::part_check::PartCheck;
use super::scene_check::SceneCheck;
use super::validity_counts::ValidityCounts;
use crate::scene::placements::IDENTITY;
use chordal::budget::advice::{Cure, Message, Setting};
use chordal::check::findings::Finding;
use chordal::check::{Component, Facing, outward};
use chordal::math::greater;
use chordal_io::Scene;
use serde::Serialize;

/// The facts of `inspect` about triangles, beyond the counts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceFacts {
    /// Whether every component is wound with its material inside, and cavities with it outside. `None` if a component has no
    /// inside, or if that is undecided. Parts are checked one by one; if self-intersections were searched for, it is also
    /// `None` if one part lies within another, which may be its cavity.
    pub outward: Option<bool>,
    /// Components that are wound inside out.
    pub inside_out: u64,
    /// Pairs of intersecting triangles, including those of different placements; `None` if they were not searched for, or
    /// the transforms cannot be applied.
    pub self_intersections: Option<u64>,
    /// Boundaries that nearly coincide; `None` if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub open_seams: Option<OpenSeamFacts>,
    /// The average number of triangles at a position; `None` without triangles.
    pub triangles_per_vertex: Option<f64>,
    /// Whether no node moves a part. Otherwise all points, areas and volumes here are in the parts' own coordinates, which
    /// differ from those of the scene's box.
    pub in_place: bool,
    /// The area of all triangles, each part once.
    pub area: f64,
    /// The enclosed volume, in cubed units; `None` unless the triangles are closed and oriented.
    pub volume: Option<f64>,
    /// The components with the most triangles, at most [`MOST_COMPONENTS`]; `components` counts all.
    pub component_list: Vec<ComponentFacts>,
    /// The repairs that helped when tried on these triangles; `None` if none were tried.
    #[serde(skip)]
    pub prescribed: Option<Vec<Cure>>,
}

/// Boundary vertices that nearly coincide with others, so that the surface looks closed but is not.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OpenSeamFacts {
    /// The vertices, over all parts.
    pub vertices: u64,
    /// The largest distance of one of them from its nearest neighbour: welding within it closes the seams. In the
    /// coordinates of its part.
    pub gap: f64,
}

impl OpenSeamFacts {
    fn total(parts: &[&PartCheck]) -> Option<Self> {
        let seams = || parts.iter().map(|part| &part.open_seams);
        let vertices = seams().map(|seams| seams.vertices.count).sum();
        (vertices > 0).then(|| Self { vertices, gap: seams().map(|seams| seams.gap).fold(0.0, greater) })
    }

    /// The tolerance that closes the seams: two digits, rounded up.
    pub(super) fn tolerance(&self) -> String {
        let rounded = |x: f64| format!("{x:.1e}");
        let is_enough = |text: &String| text.parse::<f64>().is_ok_and(|x| x >= self.gap);
        Some(rounded(self.gap)).filter(is_enough).unwrap_or_else(|| rounded(1.06 * self.gap))
    }

    /// The meaning of the seams.
    pub(super) fn meaning(&self) -> Message {
        let tolerance = self.tolerance();
        let words = format!(
            "the surface ends there, so that it has no inside; {} of its boundary vertices are within {tolerance} of others, \
             which `mend ",
            self.vertices
        );
        Message::from(words).value(Setting::Cure(Cure::Weld), &tolerance).words("` joins")
    }
}

/// The most components that are listed. Chosen: a report stays readable.
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
    /// Boundary loops.
    pub boundary_loops: u64,
    /// No edge has one triangle only.
    pub closed: bool,
    /// No edge has more than two triangles, and the triangles at each position are one fan.
    pub manifold: bool,
    /// Adjacent triangles are wound consistently.
    pub oriented: bool,
    /// Its triangles can be wound consistently.
    pub orientable: bool,
    /// The Euler characteristic: positions − edges + triangles.
    pub euler: i64,
    /// Handles; `None` if the genus is undefined.
    pub genus: Option<u64>,
    /// Its area.
    pub area: f64,
    /// The enclosed volume, negative if the front faces inward; `None` without an inside.
    pub volume: Option<f64>,
    /// "outward", "inside-out", "undecided" or "no-inside".
    pub facing: &'static str,
    /// The number of components that enclose it; `None` if that is undecided.
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
        let volume = sum(|part| part.validity.measure.signed_volume);
        Self {
            outward: outward_of(parts),
            inside_out: parts.iter().map(|part| part.inside_out.count).sum(),
            self_intersections: crossing.map(|pairs| pairs.iter().map(|finding| finding.count).sum()),
            open_seams: OpenSeamFacts::total(parts),
            triangles_per_vertex: triangles_per_vertex(parts),
            in_place: scene.nodes.iter().all(|node| *node.matrix == IDENTITY),
            area: sum(|part| part.validity.measure.area),
            volume: (counts.closed && counts.oriented).then_some(volume),
            component_list: largest(parts),
            prescribed: None,
        }
    }

    /// Adds the check across the parts of the scene.
    pub(super) fn add_scene_check(&mut self, scene_check: &SceneCheck) {
        let alone = self.self_intersections.unwrap_or(0);
        // If transforms could not be applied, the intersections that were found count, but that there are none is not known.
        self.self_intersections = match scene_check.crossing {
            Some(crossing) => Some(alone + crossing),
            None => (alone > 0).then_some(alone),
        };
        // Parts within parts are bodies or cavities: the outside is only known if both readings agree.
        if self.outward == Some(true) && scene_check.outward != Some(true) {
            self.outward = None;
        }
    }
}

/// The orientation over all parts with triangles, as for one mesh.
fn outward_of(parts: &[&PartCheck]) -> Option<bool> {
    let filled = parts.iter().filter(|part| !part.components.is_empty());
    let orientations: Vec<Option<bool>> = filled.map(|part| outward(&part.components)).collect();
    if orientations.contains(&Some(false)) {
        return Some(false);
    }
    (!orientations.is_empty() && !orientations.contains(&None)).then_some(true)
}

/// The mean over the used positions of all parts.
fn triangles_per_vertex(parts: &[&PartCheck]) -> Option<f64> {
    let validities = || parts.iter().map(|part| &part.validity);
    let faces: u64 = validities().map(|validity| validity.triangles - validity.collapsed_faces.count).sum();
    // Euler's formula, solved for the used positions: χ + edges − faces.
    let edges: u64 = validities().map(|validity| validity.edges).sum();
    let positions = validities().map(|validity| validity.euler).sum::<i64>() + edges as i64 - faces as i64;
    (positions > 0).then(|| 3.0 * faces as f64 / positions as f64)
}

fn largest(parts: &[&PartCheck]) -> Vec<ComponentFacts> {
    let components = parts.iter().enumerate().flat_map(|(part, check)| {
        let components = check.components.iter();
        components.map(move |component| (part, component))
    });
    let mut largest: Vec<(usize, &Component)> = components.collect();
    largest
        .sort_by_key(|(part, component)| (std::cmp::Reverse(component.faces), *part, component.first_face));
    largest.truncate(MOST_COMPONENTS);
    largest.into_iter().map(|(part, component)| ComponentFacts::new(part, component)).collect()
}
