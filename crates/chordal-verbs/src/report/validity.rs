//! Whether triangles are sound, as a report says it: counts by one meaning of "the same position", and by the other.
use super::part_check::{CheckDepth, CountError, PartCheck, TopologyChecks};
use super::scene_check::SceneCheck;
use super::{FindingFacts, SurfaceFacts, TriangleFacts};
use crate::formats::topology;
use chordal::check::{Cure, Defect, Validity};
use chordal::explicit::Topology;
use chordal_io::{Format, Scene, WriteError};
use serde::Serialize;

/// What holds of all parts of a scene together, counted twice.
///
/// Where a format names positions by indices of its own, those decide which edges meet; elsewhere bit-identical
/// positions do. The other count stands in `other`: where the two differ, a reader that looks at the file in the
/// other way sees another surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ValidityFacts {
    /// What made two rows the same position: "indices" or "positions".
    pub topology: &'static str,
    /// The counts by that.
    #[serde(flatten)]
    pub counts: ValidityCounts,
    /// The counts by the other.
    pub other: OtherCounts,
    /// What takes a search; only from `inspect`.
    #[serde(flatten)]
    pub anatomy: Option<SurfaceFacts>,
    /// The counts of each part; only from `inspect`, where there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartValidity>,
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
    pub counts: ValidityCounts,
}

/// The counts of one part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartValidity {
    /// The index of the part.
    pub part: u64,
    /// Its name in the file.
    pub name: String,
    /// The counts.
    #[serde(flatten)]
    pub counts: ValidityCounts,
}

/// What [`Validity`] counts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ValidityCounts {
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
    /// Boundary vertices that lie exactly inside a boundary edge of others.
    pub t_junctions: u64,
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
    /// Triangles with an area that are more than 100 times longer than high.
    pub slivers: u64,
    /// Positions at the place of an earlier one; none where equal places are one position.
    pub duplicate_vertices: u64,
    /// Vertices that no triangle names.
    pub unused_vertices: u64,
    /// Sets of triangles that hang together by edges.
    pub components: u64,
    /// Edges.
    pub edges: u64,
    /// Positions − edges + triangles, of those that take part.
    pub euler: i64,
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
    /// The part of the second triangle, where two places of parts meet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other_part: Option<u64>,
    /// Rows of the positions.
    pub vertices: Vec<u32>,
    /// Rows of the triangles.
    pub faces: Vec<u32>,
    /// A point there, in the part's own coordinates; in the scene's where two places of parts meet.
    pub at: [f64; 3],
}

/// How much there is of the triangles of a scene, and whether they are sound.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CountedTriangles {
    pub output: TriangleFacts,
    pub valid: ValidityFacts,
}

impl ValidityFacts {
    /// Where there is something to repair, keeps which repairs helped when they were tried.
    pub(crate) fn prescribe(&mut self, recommend: impl FnOnce() -> Option<Vec<Cure>>) {
        if self.anatomy.as_ref().is_some_and(|anatomy| FindingFacts::has_repairable(self, anatomy)) {
            let prescribed = recommend();
            self.anatomy.iter_mut().for_each(|anatomy| anatomy.prescribed.clone_from(&prescribed));
        }
    }
}

impl CountedTriangles {
    /// What is counted of a scene, without witnesses.
    pub fn from_scene(scene: &Scene, format: Format) -> Result<Self, WriteError> {
        let parts: Result<Vec<_>, _> =
            scene.parts.iter().map(|part| TopologyChecks::quick(&part.mesh, format)).collect();
        Ok(Self::total(&parts?, topology(format)))
    }

    /// The same in full.
    pub fn thorough(scene: &Scene, format: Format, look: CheckDepth) -> Result<Self, CountError> {
        let mut parts = Vec::new();
        for part in &scene.parts {
            parts.push(TopologyChecks::thorough(&part.mesh, format, look)?);
        }
        let mut counted = Self::total(&parts, topology(format));
        if parts.len() > 1 {
            let part = |(i, both): (usize, &TopologyChecks)| PartValidity {
                part: i as u64,
                name: scene.parts[i].name.clone(),
                counts: ValidityCounts::from_check(&both.own),
            };
            counted.valid.parts = parts.iter().enumerate().map(part).collect();
        }
        let own: Vec<&PartCheck> = parts.iter().map(|part| &part.own).collect();
        let mut anatomy = SurfaceFacts::new(&own, &counted.valid.counts, scene);
        let witnesses = own.iter().enumerate().flat_map(|(i, found)| found.witnesses(i));
        let mut witnesses: Vec<_> = witnesses.collect();
        if let CheckDepth::Deep(job) = look
            && let Some(together) =
                SceneCheck::from_scene(scene, topology(format), job).map_err(CountError::Stopped)?
        {
            anatomy.add_scene_check(&together);
            witnesses.extend(together.witnesses);
        }
        counted.valid.anatomy = Some(anatomy);
        counted.valid.witnesses = Some(witnesses);
        Ok(counted)
    }

    fn total(parts: &[TopologyChecks], topology: Topology) -> Self {
        let sum = |f: fn(&Validity) -> u64| parts.iter().map(|part| f(&part.own.found)).sum();
        let output = TriangleFacts {
            vertices: sum(|part| part.vertices),
            positions: sum(|part| part.positions),
            triangles: sum(|part| part.triangles),
        };
        let other = OtherCounts {
            topology: other_topology(topology).as_str(),
            counts: ValidityCounts::total(parts.iter().map(|part| &part.other)),
        };
        let valid = ValidityFacts {
            topology: topology.as_str(),
            counts: ValidityCounts::total(parts.iter().map(|part| &part.own)),
            other,
            anatomy: None,
            parts: Vec::new(),
            witnesses: None,
        };
        Self { output, valid }
    }
}

pub(super) fn other_topology(topology: Topology) -> Topology {
    match topology {
        Topology::Indices => Topology::Positions,
        Topology::Positions => Topology::Indices,
    }
}

impl ValidityFacts {
    /// Whether every component is wound outward; `None` where that is not decided, or was not looked at.
    #[must_use]
    pub fn outward(&self) -> Option<bool> {
        self.anatomy.as_ref().and_then(|anatomy| anatomy.outward)
    }

    /// Whether there are triangles at all: points alone are no surface of which anything holds.
    #[must_use]
    pub fn has_triangles(&self) -> bool {
        self.counts.edges > 0 || self.counts.collapsed_faces > 0
    }

    /// How often a defect was met; `None` where it was not looked for.
    #[must_use]
    pub fn count(&self, defect: Defect) -> Option<u64> {
        let anatomy = self.anatomy.as_ref();
        match defect {
            Defect::InsideOut => anatomy.map(|anatomy| anatomy.inside_out),
            Defect::SelfIntersections => anatomy.and_then(|anatomy| anatomy.self_intersections),
            _ => self.counts.count(defect),
        }
    }
}

impl ValidityCounts {
    fn from_check(PartCheck { found, t_junctions, duplicate_vertices, .. }: &PartCheck) -> Self {
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
            t_junctions: t_junctions.count,
            inconsistent_edges: found.inconsistent_edges.count,
            duplicate_faces: found.duplicate_faces.count,
            opposite_faces: found.opposite_faces.count,
            collapsed_faces: found.collapsed_faces.count,
            zero_area_faces: found.zero_area_faces.count,
            slivers: found.slivers.count,
            duplicate_vertices: duplicate_vertices.count,
            unused_vertices: found.unused_vertices.count,
            components: found.components,
            edges: found.edges,
            euler: found.euler,
            genus: found.genus,
        }
    }

    fn total<'a>(parts: impl Iterator<Item = &'a PartCheck> + Clone) -> Self {
        let mut filled = parts.clone().filter(|part| part.found.triangles > 0).peekable();
        let mut sum = parts.map(Self::from_check).reduce(Self::plus).unwrap_or(Self::NONE);
        // Of parts without triangles, none is closed, and none keeps the others from being so.
        sum.closed = filled.peek().is_some() && filled.all(|part| part.found.closed);
        sum
    }

    fn count(&self, defect: Defect) -> Option<u64> {
        let count = match defect {
            Defect::BoundaryEdges => self.boundary_edges,
            Defect::NonManifoldEdges => self.non_manifold_edges,
            Defect::NonManifoldVertices => self.non_manifold_vertices,
            Defect::TJunctions => self.t_junctions,
            Defect::InconsistentEdges => self.inconsistent_edges,
            Defect::DuplicateFaces => self.duplicate_faces,
            Defect::DuplicateVertices => self.duplicate_vertices,
            Defect::CollapsedFaces => self.collapsed_faces,
            Defect::ZeroAreaFaces => self.zero_area_faces,
            Defect::Slivers => self.slivers,
            Defect::UnusedVertices => self.unused_vertices,
            Defect::InsideOut | Defect::SelfIntersections => return None,
        };
        Some(count)
    }

    /// The counts of no part at all.
    const NONE: Self = Self {
        closed: false,
        manifold: true,
        oriented: true,
        orientable: true,
        boundary_edges: 0,
        boundary_loops: 0,
        boundary_chains: 0,
        non_manifold_edges: 0,
        non_manifold_vertices: 0,
        t_junctions: 0,
        inconsistent_edges: 0,
        duplicate_faces: 0,
        opposite_faces: 0,
        collapsed_faces: 0,
        zero_area_faces: 0,
        slivers: 0,
        duplicate_vertices: 0,
        unused_vertices: 0,
        components: 0,
        edges: 0,
        euler: 0,
        genus: Some(0),
    };

    fn plus(self, other: Self) -> Self {
        Self {
            closed: self.closed && other.closed,
            manifold: self.manifold && other.manifold,
            oriented: self.oriented && other.oriented,
            orientable: self.orientable && other.orientable,
            boundary_edges: self.boundary_edges + other.boundary_edges,
            boundary_loops: self.boundary_loops + other.boundary_loops,
            boundary_chains: self.boundary_chains + other.boundary_chains,
            non_manifold_edges: self.non_manifold_edges + other.non_manifold_edges,
            non_manifold_vertices: self.non_manifold_vertices + other.non_manifold_vertices,
            t_junctions: self.t_junctions + other.t_junctions,
            inconsistent_edges: self.inconsistent_edges + other.inconsistent_edges,
            duplicate_faces: self.duplicate_faces + other.duplicate_faces,
            opposite_faces: self.opposite_faces + other.opposite_faces,
            collapsed_faces: self.collapsed_faces + other.collapsed_faces,
            zero_area_faces: self.zero_area_faces + other.zero_area_faces,
            slivers: self.slivers + other.slivers,
            duplicate_vertices: self.duplicate_vertices + other.duplicate_vertices,
            unused_vertices: self.unused_vertices + other.unused_vertices,
            components: self.components + other.components,
            edges: self.edges + other.edges,
            euler: self.euler + other.euler,
            genus: self.genus.zip(other.genus).map(|(a, b)| a + b),
        }
    }
}
