//! The validity of one part of a scene, by both definitions of "the same position".
use crate::output::file_rows::rows_of;
use chordal::Mesh;
use chordal::budget::JobError;
use chordal::check::findings::{Finding, MeshConnectivity, MeshLocation, OpenSeams, Witness};
use chordal::check::{Component, Defect, Validity, inside_out, self_intersections};
use chordal::explicit::Topology;
use chordal_io::{Format, WriteError};
use serde::Serialize;
use std::convert::Infallible;

/// The depth of a check.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CheckDepth<'a> {
    /// Components with their properties, and witnesses.
    Full,
    /// Self-intersections as well, under the conditions of a job.
    Deep(&'a chordal::Job),
}

/// The reason why triangles could not be counted.
#[derive(Debug)]
pub(crate) enum CountError {
    /// The scene cannot be expressed in the rows of the format.
    Unwritten,
    /// The search for self-intersections was stopped.
    Stopped(JobError),
}

/// The validity of one part by one topology.
#[derive(Clone)]
pub(super) struct PartCheck {
    pub validity: Validity,
    pub t_junctions: Finding,
    pub duplicate_vertices: Finding,
    pub components: Vec<Component>,
    pub inside_out: Finding,
    pub open_seams: OpenSeams,
    /// `None` if they were not searched for.
    pub self_intersections: Option<Finding>,
}

/// The validity by the format's own topology, and by the other one.
pub(super) struct TopologyChecks {
    pub own: PartCheck,
    pub other: PartCheck,
}

impl TopologyChecks {
    /// Checks everything that needs no search.
    pub fn quick(mesh: &Mesh, format: Format) -> Result<Self, WriteError> {
        let mesh = rows_of(mesh, format)?;
        let Ok(checks) = Self::new(&mesh, format.topology(), |_, _| Ok::<(), Infallible>(()));
        Ok(checks)
    }

    /// Checks the components as well, and self-intersections if requested.
    pub fn thorough(mesh: &Mesh, format: Format, depth: CheckDepth) -> Result<Self, CountError> {
        let mesh = rows_of(mesh, format).map_err(|_| CountError::Unwritten)?;
        let mut checks = Self::new(&mesh, format.topology(), |surface, checked| {
            checked.components = match depth {
                CheckDepth::Full => surface.components(),
                CheckDepth::Deep(job) => surface.components_under(job).map_err(CountError::Stopped)?,
            };
            checked.open_seams = surface.open_seams();
            checked.inside_out = inside_out(&mesh, &checked.components);
            Ok(())
        })?;
        if let CheckDepth::Deep(job) = depth {
            checks.own.self_intersections =
                Some(self_intersections(&mesh, job).map_err(CountError::Stopped)?);
        }
        Ok(checks)
    }

    /// Checks by both topologies; `examine` checks the format's own topology in more depth.
    fn new<E>(
        mesh: &Mesh,
        own: Topology,
        examine: impl Fn(&MeshConnectivity, &mut PartCheck) -> Result<(), E>,
    ) -> Result<Self, E> {
        let connectivity = MeshConnectivity::by_indices_and_positions(mesh);
        let check = |surface: &MeshConnectivity, topology| {
            let mut checked = PartCheck::from_surface(surface);
            if topology == own {
                examine(surface, &mut checked)?;
            }
            Ok(checked)
        };
        let mut by_indices = check(&connectivity.by_indices, Topology::Indices)?;
        by_indices.duplicate_vertices = connectivity.duplicate_vertices;
        let by_positions = match &connectivity.by_positions {
            Some(surface) => check(surface, Topology::Positions)?,
            // Both topologies are equal: copies the check, so that only `examine` costs time.
            None => {
                let mut same = by_indices.clone();
                same.validity.topology = Topology::Positions;
                if own == Topology::Positions {
                    examine(&connectivity.by_indices, &mut same)?;
                }
                same
            }
        };
        Ok(match own {
            Topology::Indices => Self { own: by_indices, other: by_positions },
            Topology::Positions => Self { own: by_positions, other: by_indices },
        })
    }
}

impl PartCheck {
    fn from_surface(surface: &MeshConnectivity) -> Self {
        Self {
            validity: surface.validity(),
            t_junctions: surface.t_junctions(None),
            duplicate_vertices: Finding::default(),
            components: Vec::new(),
            inside_out: Finding::default(),
            open_seams: OpenSeams::default(),
            self_intersections: None,
        }
    }

    fn finding(&self, defect: Defect) -> Option<&Finding> {
        let validity = &self.validity;
        match defect {
            Defect::BoundaryEdges => Some(&validity.boundary_edges),
            Defect::NonManifoldEdges => Some(&validity.non_manifold_edges),
            Defect::NonManifoldVertices => Some(&validity.non_manifold_vertices),
            Defect::TJunctions => Some(&self.t_junctions),
            Defect::InconsistentEdges => Some(&validity.inconsistent_edges),
            Defect::InsideOut => Some(&self.inside_out),
            Defect::SelfIntersections => self.self_intersections.as_ref(),
            Defect::DuplicateFaces => Some(&validity.duplicate_faces),
            Defect::DuplicateVertices => Some(&self.duplicate_vertices),
            Defect::CollapsedFaces => Some(&validity.collapsed_faces),
            Defect::ZeroAreaFaces => Some(&validity.zero_area_faces),
            Defect::Slivers => Some(&validity.slivers),
            Defect::UnusedVertices => Some(&validity.unused_vertices),
        }
    }

    /// The first witnesses of every defect.
    pub fn witnesses(&self, part: usize) -> Vec<WitnessFacts> {
        let named = Defect::ALL.iter().map(|defect| (defect.name(), self.finding(*defect)));
        let opposite = ("opposite_faces", Some(&self.validity.opposite_faces));
        let mut facts = Vec::new();
        let seams = ("open_seam_vertices", Some(&self.open_seams.vertices));
        for (of, finding) in named.chain([opposite, seams]) {
            for witness in finding.into_iter().flat_map(|finding| &finding.witnesses) {
                facts.push(witness_facts(of, part, witness));
            }
        }
        facts
    }
}

/// One occurrence of a defect. All numbers are rows of the part's arrays.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WitnessFacts {
    /// The name of its count.
    pub of: &'static str,
    /// The index of the part.
    pub part: u64,
    /// The part of the second triangle, if two placements intersect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other_part: Option<u64>,
    /// Rows of the positions.
    pub vertices: Vec<u32>,
    /// Rows of the triangles.
    pub faces: Vec<u32>,
    /// A point there, in the part's own coordinates; in world coordinates if two placements intersect.
    pub at: [f64; 3],
}

/// A witness of the count `of`, in the given part.
pub(super) fn witness_facts(of: &'static str, part: usize, witness: &Witness) -> WitnessFacts {
    let (vertices, faces) = rows(&witness.place);
    WitnessFacts { of, part: part as u64, other_part: None, vertices, faces, at: witness.at }
}

fn rows(place: &MeshLocation) -> (Vec<u32>, Vec<u32>) {
    match place {
        MeshLocation::Vertex(vertex) => (vec![*vertex], Vec::new()),
        MeshLocation::RepeatedVertex { vertex, of } => (vec![*vertex, *of], Vec::new()),
        MeshLocation::Edge { vertices, faces } => (vertices.to_vec(), faces.clone()),
        MeshLocation::Face(face) => (Vec::new(), vec![*face]),
        MeshLocation::Repeated { face, of } => (Vec::new(), vec![*face, *of]),
        MeshLocation::Faces(faces) => (Vec::new(), faces.to_vec()),
        MeshLocation::OnEdge { vertex, edge, face } => (vec![*vertex, edge[0], edge[1]], vec![*face]),
        // A kind of witness that is newer than this list keeps its point and its name.
        _ => (Vec::new(), Vec::new()),
    }
}
