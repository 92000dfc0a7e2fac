//! Whether triangles are sound, as a report says it: counts by one meaning of "the same position", and by the other.
use chordal::check::{Finding, Place, Validity, validity};
use chordal::explicit::Topology;
use chordal_io::Scene;
use serde::Serialize;

/// What holds of all parts of a scene together, counted twice.
///
/// Where a format names positions by indices of its own, those decide which edges meet; elsewhere bit-identical
/// positions do. The other count stands in `other`: where the two differ, a reader that looks at the file in the
/// other way sees another surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Valid {
    /// What made two rows the same position: "indices" or "positions".
    pub topology: &'static str,
    /// The counts by that.
    #[serde(flatten)]
    pub counts: Counts,
    /// The counts by the other.
    pub other: OtherCounts,
    /// The counts of each part; only from `inspect`, where there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartValid>,
    /// The first places where something was found; only from `inspect`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub witnesses: Option<Vec<WitnessFacts>>,
}

/// The counts by the meaning that the format does not have.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OtherCounts {
    /// "indices" or "positions".
    pub topology: &'static str,
    /// The counts.
    #[serde(flatten)]
    pub counts: Counts,
}

/// The counts of one part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartValid {
    /// The index of the part.
    pub part: u64,
    /// Its name in the file.
    pub name: String,
    /// The counts.
    #[serde(flatten)]
    pub counts: Counts,
}

/// What [`Validity`] counts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Counts {
    /// There are triangles, and each part that has some has no edge with one triangle only.
    pub closed: bool,
    /// No edge has more than two triangles, and those at each position are one fan.
    pub manifold: bool,
    /// Neighbours agree on which side is out.
    pub oriented: bool,
    /// They could: no part is a Möbius strip.
    pub orientable: bool,
    /// Edges with one triangle.
    pub boundary_edges: u64,
    /// Closed strings of them.
    pub boundary_loops: u64,
    /// Open strings of them, which end at non-manifold edges.
    pub boundary_chains: u64,
    /// Edges with three triangles or more.
    pub non_manifold_edges: u64,
    /// Positions with two fans or more.
    pub non_manifold_vertices: u64,
    /// Edges whose two triangles are wound against each other.
    pub inconsistent_edges: u64,
    /// Triangles that have the positions of an earlier one.
    pub duplicate_faces: u64,
    /// Those of them that are wound the other way.
    pub opposite_faces: u64,
    /// Triangles with two corners at one position.
    pub collapsed_faces: u64,
    /// Triangles without area, exactly; of the collapsed ones, all.
    pub zero_area_faces: u64,
    /// Vertices that no triangle names.
    pub unused_vertices: u64,
    /// Sets of triangles that hang together by edges.
    pub components: u64,
    /// Edges.
    pub edges: u64,
    /// Handles of all components together; none where that means nothing.
    pub genus: Option<u64>,
}

/// One place where something was found. All numbers are rows of the part's arrays.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WitnessFacts {
    /// The name of the count that it belongs to.
    pub of: &'static str,
    /// The index of the part.
    pub part: u64,
    /// Rows of the positions.
    pub vertices: Vec<u32>,
    /// Rows of the triangles.
    pub faces: Vec<u32>,
    /// A point there, in the part's own coordinates.
    pub at: [f64; 3],
}

impl Valid {
    /// What holds of a scene, without witnesses.
    #[must_use]
    pub fn of(scene: &Scene, topology: Topology) -> Self {
        let (main, other) = both_ways(scene, topology);
        Self::summed(&main, &other, topology)
    }

    /// The same in full.
    #[must_use]
    pub fn in_full(scene: &Scene, topology: Topology) -> Self {
        let (main, other) = both_ways(scene, topology);
        let mut valid = Self::summed(&main, &other, topology);
        if scene.parts.len() > 1 {
            let part = |(i, found): (usize, &Validity)| PartValid {
                part: i as u64,
                name: scene.parts[i].name.clone(),
                counts: Counts::of(found),
            };
            valid.parts = main.iter().enumerate().map(part).collect();
        }
        valid.witnesses = Some(main.iter().enumerate().flat_map(|(i, found)| witnesses(i, found)).collect());
        valid
    }

    fn summed(main: &[Validity], other: &[Validity], topology: Topology) -> Self {
        Self {
            topology: topology.as_str(),
            counts: Counts::summed(main),
            other: OtherCounts { topology: opposite(topology).as_str(), counts: Counts::summed(other) },
            parts: Vec::new(),
            witnesses: None,
        }
    }
}

fn opposite(topology: Topology) -> Topology {
    match topology {
        Topology::Indices => Topology::Positions,
        Topology::Positions => Topology::Indices,
    }
}

fn both_ways(scene: &Scene, topology: Topology) -> (Vec<Validity>, Vec<Validity>) {
    let all = |topology| scene.parts.iter().map(|part| validity(&part.mesh, topology)).collect();
    (all(topology), all(opposite(topology)))
}

impl Counts {
    /// The counts of one part.
    #[must_use]
    pub fn of(found: &Validity) -> Self {
        Self {
            closed: found.closed,
            manifold: found.manifold(),
            oriented: found.oriented,
            orientable: found.orientable,
            boundary_edges: found.boundary_edges.count,
            boundary_loops: found.boundary_loops,
            boundary_chains: found.boundary_chains,
            non_manifold_edges: found.non_manifold_edges.count,
            non_manifold_vertices: found.non_manifold_vertices.count,
            inconsistent_edges: found.inconsistent_edges.count,
            duplicate_faces: found.duplicate_faces.count,
            opposite_faces: found.opposite_faces.count,
            collapsed_faces: found.collapsed_faces.count,
            zero_area_faces: found.zero_area_faces.count,
            unused_vertices: found.unused_vertices.count,
            components: found.components,
            edges: found.edges,
            genus: found.genus,
        }
    }

    fn summed(parts: &[Validity]) -> Self {
        let sum = |f: fn(&Validity) -> u64| parts.iter().map(f).sum();
        let filled = || parts.iter().filter(|part| part.triangles > 0);
        Self {
            closed: filled().next().is_some() && filled().all(|part| part.closed),
            manifold: parts.iter().all(Validity::manifold),
            oriented: parts.iter().all(|part| part.oriented),
            orientable: parts.iter().all(|part| part.orientable),
            boundary_edges: sum(|part| part.boundary_edges.count),
            boundary_loops: sum(|part| part.boundary_loops),
            boundary_chains: sum(|part| part.boundary_chains),
            non_manifold_edges: sum(|part| part.non_manifold_edges.count),
            non_manifold_vertices: sum(|part| part.non_manifold_vertices.count),
            inconsistent_edges: sum(|part| part.inconsistent_edges.count),
            duplicate_faces: sum(|part| part.duplicate_faces.count),
            opposite_faces: sum(|part| part.opposite_faces.count),
            collapsed_faces: sum(|part| part.collapsed_faces.count),
            zero_area_faces: sum(|part| part.zero_area_faces.count),
            unused_vertices: sum(|part| part.unused_vertices.count),
            components: sum(|part| part.components),
            edges: sum(|part| part.edges),
            genus: parts.iter().map(|part| part.genus).sum(),
        }
    }
}

fn witnesses(part: usize, found: &Validity) -> Vec<WitnessFacts> {
    let findings: [(&'static str, &Finding); 9] = [
        ("boundary_edges", &found.boundary_edges),
        ("non_manifold_edges", &found.non_manifold_edges),
        ("non_manifold_vertices", &found.non_manifold_vertices),
        ("inconsistent_edges", &found.inconsistent_edges),
        ("duplicate_faces", &found.duplicate_faces),
        ("opposite_faces", &found.opposite_faces),
        ("collapsed_faces", &found.collapsed_faces),
        ("zero_area_faces", &found.zero_area_faces),
        ("unused_vertices", &found.unused_vertices),
    ];
    let facts = |(of, finding): (&'static str, &Finding)| {
        let one = |witness: &chordal::check::Witness| {
            let (vertices, faces) = rows(&witness.place);
            WitnessFacts { of, part: part as u64, vertices, faces, at: witness.at }
        };
        finding.witnesses.iter().map(one).collect::<Vec<_>>()
    };
    findings.into_iter().flat_map(facts).collect()
}

fn rows(place: &Place) -> (Vec<u32>, Vec<u32>) {
    match place {
        Place::Vertex(vertex) => (vec![*vertex], Vec::new()),
        Place::Edge { vertices, faces } => (vertices.to_vec(), faces.clone()),
        Place::Face(face) => (Vec::new(), vec![*face]),
        Place::Repeated { face, of } => (Vec::new(), vec![*face, *of]),
        Place::OnEdge { vertex, edge, face } => (vec![*vertex, edge[0], edge[1]], vec![*face]),
        // A kind of place that is newer than this list has its point and its name.
        _ => (Vec::new(), Vec::new()),
    }
}
