//! The counts of an output.
use super::PolygonFacts;
use chordal::Mesh;
use chordal::explicit::{Curve, CurveSegment, Topology};
use chordal_io::Polylines;
use serde::Serialize;

/// The counts of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Output {
    /// Triangles.
    Triangles(TriangleFacts),
    /// Polylines.
    Polylines(PolylineFacts),
    /// Polygons.
    Polygons(PolygonFacts),
}

impl Output {
    /// The counts of triangles, if the output is triangles.
    #[must_use]
    pub fn triangles(&self) -> Option<&TriangleFacts> {
        match self {
            Self::Triangles(facts) => Some(facts),
            Self::Polylines(_) | Self::Polygons(_) => None,
        }
    }

    /// The counts of polylines, if the output is polylines.
    #[must_use]
    pub fn polylines(&self) -> Option<&PolylineFacts> {
        match self {
            Self::Triangles(_) | Self::Polygons(_) => None,
            Self::Polylines(facts) => Some(facts),
        }
    }

    /// The counts of polygons, if the output is polygons.
    #[must_use]
    pub fn polygons(&self) -> Option<&PolygonFacts> {
        match self {
            Self::Polygons(facts) => Some(facts),
            Self::Triangles(_) | Self::Polylines(_) => None,
        }
    }
}

/// The counts of polylines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PolylineFacts {
    /// Polylines.
    pub polylines: u64,
    /// Points; the first of a closed polyline counts once.
    pub points: u64,
    /// Segments, including the closing ones.
    pub segments: u64,
}

impl PolylineFacts {
    /// The counts of all polylines.
    #[must_use]
    pub fn from_polylines(polylines: &Polylines) -> Self {
        let [points, segments] = polylines.counts();
        Self { polylines: polylines.len() as u64, points, segments }
    }

    /// The counts of curves that are all straight, as they read back from a file of polylines; `None` for other curves.
    #[must_use]
    pub fn from_straight_curves<const D: usize>(curves: &[Curve<D>]) -> Option<Self> {
        let mut facts = Self { polylines: curves.len() as u64, ..Self::default() };
        for curve in curves {
            if !curve.segments().iter().all(|piece| matches!(piece, CurveSegment::Line(_))) {
                return None;
            }
            let segments = curve.segments().len() as u64;
            facts.segments += segments;
            facts.points += if curve.is_closed() { segments } else { segments + 1 };
        }
        Some(facts)
    }
}

/// The counts of triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct TriangleFacts {
    /// Rows of positions; vertices that differ only in attributes count separately.
    pub vertices: u64,
    /// Distinct positions, as defined by the topology in `valid`.
    pub positions: u64,
    /// Triangles.
    pub triangles: u64,
}

impl TriangleFacts {
    /// The counts of one mesh.
    #[must_use]
    pub fn from_mesh(mesh: &Mesh, topology: Topology) -> Self {
        let n_vertices = mesh.positions().len();
        let positions = topology.ids(mesh).map_or(n_vertices, |ids| {
            let mut used = vec![false; n_vertices];
            ids.iter().for_each(|id| used[*id as usize] = true);
            used.iter().filter(|used| **used).count()
        });
        Self {
            vertices: n_vertices as u64,
            positions: positions as u64,
            triangles: mesh.faces().len() as u64,
        }
    }
}
