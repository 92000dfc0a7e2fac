//! `ValidityCounts`: the counts of a validity check in the report.
use super::part_check::PartCheck;
use chordal::check::Defect;
use serde::Serialize;

/// The counts of [`chordal::check::Validity`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ValidityCounts {
    /// There are triangles, and in each part with triangles no edge has only one.
    pub closed: bool,
    /// No edge has more than two triangles, and the triangles at each position are one fan.
    pub manifold: bool,
    /// Adjacent triangles are wound consistently.
    pub oriented: bool,
    /// They can be wound consistently: no part is a Möbius strip.
    pub orientable: bool,
    /// Edges with one triangle.
    pub boundary_edges: u64,
    /// Closed loops of boundary edges.
    pub boundary_loops: u64,
    /// Open chains of boundary edges, which end at non-manifold edges.
    pub boundary_chains: u64,
    /// Edges with three triangles or more.
    pub non_manifold_edges: u64,
    /// Positions with two fans or more.
    pub non_manifold_vertices: u64,
    /// Boundary vertices that lie exactly in the interior of a boundary edge of others.
    pub t_junctions: u64,
    /// Edges whose two triangles have opposite winding.
    pub inconsistent_edges: u64,
    /// Triangles that repeat the positions of an earlier one.
    pub duplicate_faces: u64,
    /// Duplicates that are wound the other way.
    pub opposite_faces: u64,
    /// Triangles with two corners at one position.
    pub collapsed_faces: u64,
    /// Triangles of exactly zero area, including all collapsed ones.
    pub zero_area_faces: u64,
    /// Triangles with an area that are more than 100 times longer than high.
    pub slivers: u64,
    /// Positions at the point of an earlier one; 0 if equal points count as one position.
    pub duplicate_vertices: u64,
    /// Vertices that no triangle uses.
    pub unused_vertices: u64,
    /// Sets of triangles that are connected by edges.
    pub components: u64,
    /// Edges.
    pub edges: u64,
    /// The Euler characteristic: positions − edges + triangles, without collapsed triangles and unused positions.
    pub euler: i64,
    /// Handles of all components together; `None` if the genus is undefined.
    pub genus: Option<u64>,
}

impl ValidityCounts {
    pub(super) fn from_check(
        PartCheck { validity, t_junctions, duplicate_vertices, .. }: &PartCheck,
    ) -> Self {
        Self {
            closed: validity.closed,
            manifold: validity.manifold(),
            oriented: validity.oriented,
            orientable: validity.orientable,
            boundary_edges: validity.boundary_edges.count,
            boundary_loops: validity.boundary_loops,
            boundary_chains: validity.boundary_chains,
            non_manifold_edges: validity.non_manifold_edges.count,
            non_manifold_vertices: validity.non_manifold_vertices.count,
            t_junctions: t_junctions.count,
            inconsistent_edges: validity.inconsistent_edges.count,
            duplicate_faces: validity.duplicate_faces.count,
            opposite_faces: validity.opposite_faces.count,
            collapsed_faces: validity.collapsed_faces.count,
            zero_area_faces: validity.zero_area_faces.count,
            slivers: validity.slivers.count,
            duplicate_vertices: duplicate_vertices.count,
            unused_vertices: validity.unused_vertices.count,
            components: validity.components,
            edges: validity.edges,
            euler: validity.euler,
            genus: validity.genus,
        }
    }

    pub(super) fn total<'a>(parts: impl Iterator<Item = &'a PartCheck> + Clone) -> Self {
        let mut filled = parts.clone().filter(|part| part.validity.triangles > 0).peekable();
        let mut sum = parts.map(Self::from_check).reduce(Self::plus).unwrap_or(Self::NONE);
        // Parts without triangles do not count as closed, nor do they make the scene open.
        sum.closed = filled.peek().is_some() && filled.all(|part| part.validity.closed);
        sum
    }

    pub(super) fn count(&self, defect: Defect) -> Option<u64> {
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

    /// The counts of no parts.
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
