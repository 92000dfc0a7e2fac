//! Cages and refined polygons in the report.
use chordal::explicit::Cage;
use chordal::explicit::subdivision::{Boundary, CreasingMethod, INFINITELY_SHARP, LinearTexcoords};
use chordal::math::{greater, lesser};
use chordal_io::Polygons;
use serde::Serialize;
use std::collections::BTreeMap;

/// The counts of polygons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PolygonFacts {
    /// Polygons, holes included.
    pub faces: u64,
    /// Vertices.
    pub vertices: u64,
}

impl PolygonFacts {
    /// The counts of a cage.
    #[must_use]
    pub fn from_cage(cage: &Cage) -> Self {
        Self { faces: cage.n_faces() as u64, vertices: cage.positions().len() as u64 }
    }
}

/// How a cage was refined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RefinementFacts {
    /// Refinement levels.
    pub levels: u32,
    /// The subdivision scheme.
    pub scheme: &'static str,
    /// Edges that are still sharp.
    pub creases: u64,
    /// Vertices that are still sharp.
    pub corners: u64,
}

impl RefinementFacts {
    pub(crate) fn new(cage: &Cage, levels: u32) -> Self {
        let (creases, corners) = (cage.creases().len() as u64, cage.sharp_vertices().len() as u64);
        Self { levels, scheme: cage.scheme().name(), creases, corners }
    }
}

/// The facts about a cage; only from `inspect`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CageFacts {
    /// The scheme, as in "catmull-clark".
    pub scheme: &'static str,
    /// The boundary rule: "none", "edge-only" or "edge-and-corner".
    pub boundary: &'static str,
    /// How sharpness decreases: "uniform" or "chaikin".
    pub creasing: &'static str,
    /// The number of faces by their number of corners.
    pub faces_by_corners: BTreeMap<u64, u64>,
    /// Edges.
    pub edges: u64,
    /// Edges with one face.
    pub border_edges: u64,
    /// Non-manifold edges: with more than two faces, or with two that are wound against each other.
    pub crowded_edges: u64,
    /// Vertices without a face.
    pub isolated_vertices: u64,
    /// Extraordinary interior vertices by valence; 4 is regular, or 6 for Loop.
    pub irregular: BTreeMap<u64, u64>,
    /// The same on the boundary; there 3 is regular, or 4 for Loop.
    pub irregular_border: BTreeMap<u64, u64>,
    /// Sharp edges.
    pub creases: SharpnessFacts,
    /// Sharp vertices.
    pub corners: SharpnessFacts,
    /// Hole faces, which have no surface.
    pub holes: u64,
    /// Rows of texture coordinates that corners use; `None` if there are none.
    pub texcoords: Option<u64>,
    /// The places where refinement interpolates them linearly: "none", "corners-only", "corners-plus-1", "corners-plus-2",
    /// "boundaries" or "all"; `None` if there are none.
    pub texcoords_linear: Option<&'static str>,
}

/// Sharp elements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SharpnessFacts {
    /// Their number.
    pub count: u64,
    /// The number of infinitely sharp elements.
    pub infinite: u64,
    /// The least and the greatest finite sharpness; `None` if there is none.
    pub range: Option<[f64; 2]>,
}

impl SharpnessFacts {
    fn from_sharpness(sharp: impl Iterator<Item = f64>) -> Self {
        let mut facts = Self::default();
        for sharp in sharp {
            facts.count += 1;
            if sharp >= INFINITELY_SHARP {
                facts.infinite += 1;
                continue;
            }
            let [low, high] = facts.range.unwrap_or([sharp; 2]);
            facts.range = Some([lesser(sharp, low), greater(sharp, high)]);
        }
        facts
    }
}

impl CageFacts {
    pub(super) fn new(polygons: &Polygons) -> Self {
        let cage = &polygons.cage;
        let mut faces_by_corners = BTreeMap::new();
        cage.faces().for_each(|face| *faces_by_corners.entry(face.len() as u64).or_default() += 1);
        let mut facts = Self {
            scheme: cage.scheme().name(),
            boundary: match cage.boundary() {
                Boundary::None => "none",
                Boundary::EdgeOnly => "edge-only",
                Boundary::EdgeAndCorner => "edge-and-corner",
            },
            creasing: match cage.creasing() {
                CreasingMethod::Uniform => "uniform",
                CreasingMethod::Chaikin => "chaikin",
            },
            faces_by_corners,
            edges: 0,
            border_edges: 0,
            crowded_edges: 0,
            isolated_vertices: 0,
            irregular: BTreeMap::new(),
            irregular_border: BTreeMap::new(),
            creases: SharpnessFacts::from_sharpness(cage.creases().iter().map(|(_, sharp)| *sharp)),
            corners: SharpnessFacts::from_sharpness(cage.sharp_vertices().iter().map(|(_, sharp)| *sharp)),
            holes: cage.holes().len() as u64,
            texcoords: cage.texcoords().map(|texcoords| texcoords.values.len() as u64),
            texcoords_linear: cage.texcoords().map(|texcoords| linear_name(texcoords.linear)),
        };
        facts.count_edges(cage);
        facts
    }

    fn count_edges(&mut self, cage: &Cage) {
        // Each edge with the lower vertex first, and whether the face runs along it in that direction.
        let mut halves: Vec<([u32; 2], bool)> = Vec::new();
        for face in cage.faces() {
            for (k, &a) in face.iter().enumerate() {
                let b = face[(k + 1) % face.len()];
                halves.push((if a < b { [a, b] } else { [b, a] }, a < b));
            }
        }
        halves.sort_unstable();
        let mut valence = vec![0_u64; cage.positions().len()];
        let mut on_border = vec![false; cage.positions().len()];
        for edge in halves.chunk_by(|a, b| a.0 == b.0) {
            self.edges += 1;
            let is_border = edge.len() == 1;
            self.border_edges += u64::from(is_border);
            self.crowded_edges += u64::from(edge.len() > 2 || edge.len() == 2 && edge[0].1 == edge[1].1);
            for vertex in edge[0].0 {
                valence[vertex as usize] += 1;
                on_border[vertex as usize] |= is_border;
            }
        }
        // The valences within and on the border of a plane tiling by equal triangles, or by squares.
        let [inner, border] = if cage.scheme().is_for_triangles() { [6, 4] } else { [4, 3] };
        for (n, on_border) in valence.into_iter().zip(on_border) {
            match (n, on_border) {
                (0, _) => self.isolated_vertices += 1,
                (n, true) if n != border => *self.irregular_border.entry(n).or_default() += 1,
                (n, false) if n != inner => *self.irregular.entry(n).or_default() += 1,
                _ => {}
            }
        }
    }
}

/// The name of a rule for texture coordinates.
pub(crate) fn linear_name(linear: LinearTexcoords) -> &'static str {
    match linear {
        LinearTexcoords::None => "none",
        LinearTexcoords::CornersOnly => "corners-only",
        LinearTexcoords::CornersPlus1 => "corners-plus-1",
        LinearTexcoords::CornersPlus2 => "corners-plus-2",
        LinearTexcoords::Boundaries => "boundaries",
        LinearTexcoords::All => "all",
    }
}
