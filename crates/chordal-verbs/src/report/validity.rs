//! The validity of triangles in the report: counts by one definition of "the same position", and by the
//! other.
use super::TriangleFacts;
use super::part_check::{CheckDepth, CountError, PartCheck, TopologyChecks, WitnessFacts};
use super::scene_check::SceneCheck;
use super::surface::SurfaceFacts;
use super::validity_counts::ValidityCounts;
use crate::scene::merged_parts::MergedParts;
use chordal::check::{Defect, Validity};
use chordal::explicit::Topology;
use chordal_io::{Format, Scene, WriteError};
use serde::Serialize;

/// The validity of all parts of a scene together, counted twice.
///
/// If a format has its own indices of positions, these decide which edges meet; otherwise bit-identical positions do. The
/// other count is in `other`: if the two differ, a reader that uses the other definition sees a different surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ValidityFacts {
    /// The definition of the same position: "indices" or "positions".
    pub topology: &'static str,
    /// The counts by that definition.
    #[serde(flatten)]
    pub counts: ValidityCounts,
    /// The counts by the other definition.
    pub other: OtherCounts,
    /// Results that take a search; only from `inspect`.
    #[serde(flatten)]
    pub anatomy: Option<SurfaceFacts>,
    /// The counts of each part; only from `inspect`, and only if there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartValidity>,
    /// The first witnesses; only from `inspect`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub witnesses: Option<Vec<WitnessFacts>>,
}

/// The counts by the definition that the format does not use.
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

/// The triangle counts of a scene, and their validity.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CountedTriangles {
    pub output: TriangleFacts,
    pub valid: ValidityFacts,
}

impl CountedTriangles {
    /// The counts of a scene, without witnesses; counts it as one part if its file is read as one: an OBJ only names its
    /// objects.
    pub fn from_scene(scene: &Scene, format: Format) -> Result<Self, WriteError> {
        if scene.parts.len() > 1 && format.is_one_mesh() {
            // A reader of the file finds one mesh, and counts its edges and positions across the parts.
            let merged = MergedParts::from_scene(scene, Topology::Indices)?.mesh;
            return Ok(Self::total(&[TopologyChecks::quick(&merged, format)?], format.topology()));
        }
        let parts: Result<Vec<_>, _> =
            scene.parts.iter().map(|part| TopologyChecks::quick(&part.mesh, format)).collect();
        Ok(Self::total(&parts?, format.topology()))
    }

    /// As [`Self::from_scene`], with components and witnesses, and self-intersections if requested.
    pub fn thorough(scene: &Scene, format: Format, depth: CheckDepth) -> Result<Self, CountError> {
        let mut parts = Vec::new();
        for part in &scene.parts {
            parts.push(TopologyChecks::thorough(&part.mesh, format, depth)?);
        }
        let mut counted = Self::total(&parts, format.topology());
        if parts.len() > 1 {
            let part = |(i, checks): (usize, &TopologyChecks)| PartValidity {
                part: i as u64,
                name: scene.parts[i].name.clone(),
                counts: ValidityCounts::from_check(&checks.own),
            };
            counted.valid.parts = parts.iter().enumerate().map(part).collect();
        }
        let checks: Vec<&PartCheck> = parts.iter().map(|part| &part.own).collect();
        let mut anatomy = SurfaceFacts::new(&checks, &counted.valid.counts, scene);
        let witnesses = checks.iter().enumerate().flat_map(|(i, check)| check.witnesses(i));
        let mut witnesses: Vec<_> = witnesses.collect();
        if let CheckDepth::Deep(job) = depth
            && let Some(scene_check) =
                SceneCheck::from_scene(scene, format.topology(), job).map_err(CountError::Stopped)?
        {
            anatomy.add_scene_check(&scene_check);
            witnesses.extend(scene_check.witnesses);
        }
        counted.valid.anatomy = Some(anatomy);
        counted.valid.witnesses = Some(witnesses);
        Ok(counted)
    }

    fn total(parts: &[TopologyChecks], topology: Topology) -> Self {
        let sum = |f: fn(&Validity) -> u64| parts.iter().map(|part| f(&part.own.validity)).sum();
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
    /// Whether every component is wound outward; `None` if that is undecided or unchecked.
    #[must_use]
    pub fn outward(&self) -> Option<bool> {
        self.anatomy.as_ref().and_then(|anatomy| anatomy.outward)
    }

    /// Whether there are triangles at all: points alone are not a surface.
    #[must_use]
    pub fn has_triangles(&self) -> bool {
        self.counts.edges > 0 || self.counts.collapsed_faces > 0
    }

    /// The count of a defect; `None` if it was not searched for.
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
