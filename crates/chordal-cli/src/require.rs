//! What a mesh can be required to be, and what is said where it is not.
use crate::inspect_text::witness_texts;
use crate::numbers::grouped;
use chordal::check::Defect;
use chordal_verbs::report::ValidityFacts;
use clap::ValueEnum;

/// What a mesh can be required to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Requirement {
    /// Closed, manifold, oriented, outward and free of self-intersections
    Solid,
    /// There are triangles, and no edge has one only
    Closed,
    /// No edge has more than two triangles, and no vertex more than one fan of them
    Manifold,
    /// No edge has more than two triangles
    EdgeManifold,
    /// No vertex has more than one fan of triangles
    VertexManifold,
    /// Neighbours agree on which side is out
    Oriented,
    /// Neighbours could agree on which side is out
    Orientable,
    /// Every component has its material inside, cavities outside
    Outward,
    /// All triangles hang together by edges
    SingleComponent,
    /// No triangles cross, overlap or touch where they should not
    NoSelfIntersections,
    /// No vertex lies in the middle of an edge
    NoTJunctions,
    /// No triangle is without area
    NoDegenerate,
    /// No triangle is there twice, and no two vertices are at one place
    NoDuplicates,
    /// No triangle is 100 times longer than high
    NoSlivers,
    /// Every vertex has a triangle
    NoUnused,
}

impl Requirement {
    /// Whether it takes the search for self-intersections.
    pub fn needs_deep_check(self) -> bool {
        matches!(self, Self::Solid | Self::NoSelfIntersections)
    }

    /// The same, as requirements of one thing each.
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

/// What is wrong, one sentence for each thing that was required, each once.
///
/// Nothing that can be required holds where there is no surface.
pub fn failures(valid: &ValidityFacts, required: &[Requirement]) -> Vec<String> {
    if !required.is_empty() && valid.counts.edges == 0 {
        let why = match valid.counts.collapsed_faces {
            0 => "there are no triangles to check",
            _ => "there is no surface to check: every triangle is collapsed",
        };
        return vec![why.to_owned()];
    }
    let single = required.iter().flat_map(|whole| match whole.parts() {
        [] => vec![*whole],
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
    let of = |what: &str, defects: &[Defect]| -> Vec<String> {
        defects.iter().filter_map(|defect| counted(valid, what, *defect)).collect()
    };
    match required {
        Requirement::Solid | Requirement::Manifold => Vec::new(),
        Requirement::Closed if !counts.closed && counts.boundary_edges == 0 => {
            vec!["not closed: every triangle of a part is collapsed".to_owned()]
        }
        Requirement::Closed => of("not closed", &[Defect::BoundaryEdges]),
        Requirement::EdgeManifold => of("not manifold", &[Defect::NonManifoldEdges]),
        Requirement::VertexManifold => of("not manifold", &[Defect::NonManifoldVertices]),
        Requirement::Oriented => of("not oriented", &[Defect::InconsistentEdges]),
        Requirement::Orientable if !counts.orientable => {
            vec!["not orientable: a component has one side only, as a Möbius strip".to_owned()]
        }
        Requirement::Orientable => Vec::new(),
        Requirement::Outward => match anatomy.and_then(|anatomy| anatomy.outward) {
            Some(true) => Vec::new(),
            Some(false) => of("not outward", &[Defect::InsideOut]),
            None if !counts.closed || !counts.oriented => {
                vec!["not outward: a component has no inside, or none that is decided".to_owned()]
            }
            None => vec![
                "not outward: which side is out is not decided: a component has no volume, or lies on another, or a \
                 part lies within another"
                    .to_owned(),
            ],
        },
        Requirement::SingleComponent if counts.components != 1 => {
            vec![format!("not a single component: {} components", grouped(counts.components))]
        }
        Requirement::SingleComponent => Vec::new(),
        Requirement::NoSelfIntersections if valid.count(Defect::SelfIntersections).is_none() => {
            vec!["self-intersections are not known: the parts cannot be put in one space".to_owned()]
        }
        Requirement::NoSelfIntersections => of("self-intersecting", &[Defect::SelfIntersections]),
        Requirement::NoTJunctions => of("T-junctions", &[Defect::TJunctions]),
        Requirement::NoDegenerate => of("degenerate", &[Defect::ZeroAreaFaces]),
        Requirement::NoDuplicates => of("duplicates", &[Defect::DuplicateFaces, Defect::DuplicateVertices]),
        Requirement::NoSlivers => of("slivers", &[Defect::Slivers]),
        Requirement::NoUnused => of("unused", &[Defect::UnusedVertices]),
    }
}

/// `not closed: 3 boundary edges, the first is edge 0-1 of triangle 0 at (0.5, 0, 0)`
fn counted(valid: &ValidityFacts, what: &str, defect: Defect) -> Option<String> {
    let count = valid.count(defect).filter(|count| *count > 0)?;
    let [one, several] = defect.words();
    let words = if count == 1 { one } else { several };
    let place = match witness_texts(defect.name(), valid).next() {
        Some(place) if count == 1 => format!(", {place}"),
        Some(place) => format!(", the first is {place}"),
        None => String::new(),
    };
    Some(format!("{what}: {} {words}{place}", grouped(count)))
}
