//! Properties that can be required of a mesh, and the messages if it lacks them.
use crate::inspect_text::witness_texts;
use crate::numbers::grouped;
use chordal::check::Defect;
use chordal_verbs::report::ValidityFacts;
use clap::ValueEnum;

/// A property that can be required of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Requirement {
    /// Closed, manifold, oriented, outward and free of self-intersections
    Solid,
    /// There are triangles, and no edge has only one
    Closed,
    /// No edge has more than two triangles, and no vertex more than one fan of triangles
    Manifold,
    /// No edge has more than two triangles
    EdgeManifold,
    /// No vertex has more than one fan of triangles
    VertexManifold,
    /// Neighbouring triangles are wound consistently
    Oriented,
    /// Neighbouring triangles could be wound consistently
    Orientable,
    /// Every component faces away from its material, cavities inwards
    Outward,
    /// All triangles are connected by edges
    SingleComponent,
    /// No triangles cross, overlap or touch without being neighbours
    NoSelfIntersections,
    /// No vertex lies in the middle of an edge
    NoTJunctions,
    /// Every triangle has an area
    NoDegenerate,
    /// No two triangles have the same vertices, and no two vertices the same position
    NoDuplicates,
    /// No triangle is 100 times longer than high
    NoSlivers,
    /// Every vertex is used by a triangle
    NoUnused,
}

impl Requirement {
    /// Whether checking it needs the search for self-intersections.
    pub fn needs_deep_check(self) -> bool {
        matches!(self, Self::Solid | Self::NoSelfIntersections)
    }

    /// The single requirements that this one combines; empty if it is a single one.
    fn parts(self) -> &'static [Self] {
        match self {
            Self::Solid => &[
                Self::Closed,
                Self::EdgeManifold,
                Self::VertexManifold,
                Self::Oriented,
                Self::Outward,
                Self::NoSelfIntersections,
            ],
            Self::Manifold => &[Self::EdgeManifold, Self::VertexManifold],
            _ => &[],
        }
    }
}

/// The requirements that are not met, one sentence each, without repetitions.
///
/// Without a surface no requirement is met.
pub fn failures(valid: &ValidityFacts, required: &[Requirement]) -> Vec<String> {
    if !required.is_empty() && valid.counts.edges == 0 {
        let why = match valid.counts.collapsed_faces {
            0 => "there are no triangles to check",
            _ => "there is no surface to check: every triangle is collapsed",
        };
        return vec![why.to_owned()];
    }
    let single = required.iter().flat_map(|requirement| match requirement.parts() {
        [] => vec![*requirement],
        parts => parts.to_vec(),
    });
    let mut lines: Vec<String> = Vec::new();
    for line in single.flat_map(|requirement| failure(valid, requirement)) {
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    lines
}

fn failure(valid: &ValidityFacts, required: Requirement) -> Vec<String> {
    let (counts, anatomy) = (&valid.counts, valid.anatomy.as_ref());
    let texts = |what: &str, defects: &[Defect]| -> Vec<String> {
        defects.iter().filter_map(|defect| counted(valid, what, *defect)).collect()
    };
    match required {
        Requirement::Solid | Requirement::Manifold => Vec::new(),
        Requirement::Closed if !counts.closed && counts.boundary_edges == 0 => {
            vec!["not closed: every triangle of a part is collapsed".to_owned()]
        }
        Requirement::Closed => texts("not closed", &[Defect::BoundaryEdges]),
        Requirement::EdgeManifold => texts("not manifold", &[Defect::NonManifoldEdges]),
        Requirement::VertexManifold => texts("not manifold", &[Defect::NonManifoldVertices]),
        Requirement::Oriented => texts("not oriented", &[Defect::InconsistentEdges]),
        Requirement::Orientable if !counts.orientable => {
            vec!["not orientable: a component has only one side, like a Möbius strip".to_owned()]
        }
        Requirement::Orientable => Vec::new(),
        Requirement::Outward => match anatomy.and_then(|anatomy| anatomy.outward) {
            Some(true) => Vec::new(),
            Some(false) => texts("not outward", &[Defect::InsideOut]),
            None if !counts.closed || !counts.oriented => {
                vec!["not outward: a component has no inside, or its inside is not decided".to_owned()]
            }
            None => vec![
                "not outward: the outer side is not decided: a component has no volume or lies on another, or a part \
                lies within another"
                    .to_owned(),
            ],
        },
        Requirement::SingleComponent if counts.components != 1 => {
            vec![format!("not a single component: {} components", grouped(counts.components))]
        }
        Requirement::SingleComponent => Vec::new(),
        Requirement::NoSelfIntersections if valid.count(Defect::SelfIntersections).is_none() => {
            vec!["self-intersections are not known: the parts cannot be placed in one space".to_owned()]
        }
        Requirement::NoSelfIntersections => texts("self-intersecting", &[Defect::SelfIntersections]),
        Requirement::NoTJunctions => texts("T-junctions", &[Defect::TJunctions]),
        Requirement::NoDegenerate => texts("degenerate", &[Defect::ZeroAreaFaces]),
        Requirement::NoDuplicates => texts("duplicates", &[Defect::DuplicateFaces, Defect::DuplicateVertices]),
        Requirement::NoSlivers => texts("slivers", &[Defect::Slivers]),
        Requirement::NoUnused => texts("unused", &[Defect::UnusedVertices]),
    }
}

/// `not closed: 3 boundary edges, the first is edge 0-1 of triangle 0 at (0.5, 0, 0)`
fn counted(valid: &ValidityFacts, what: &str, defect: Defect) -> Option<String> {
    let count = valid.count(defect).filter(|count| *count > 0)?;
    let [singular, plural] = defect.words();
    let words = if count == 1 { singular } else { plural };
    let place = match witness_texts(defect.name(), valid).next() {
        Some(place) if count == 1 => format!(", {place}"),
        Some(place) => format!(", the first is {place}"),
        None => String::new(),
    };
    Some(format!("{what}: {} {words}{place}", grouped(count)))
}
