//! Checks across the parts of a scene in world coordinates: parts that cross or touch, and parts that lie within others.
use super::part_check::WitnessFacts;
use crate::scene::merged_parts::MergedParts;
use crate::scene::placements::n_places;
use chordal::Job;
use chordal::budget::JobError;
use chordal::check::findings::{MeshConnectivity, Witness};
use chordal::check::{Defect, intersections_between, outward};
use chordal::explicit::Topology;
use chordal_io::Scene;

/// The combined check of all placements.
pub(super) struct SceneCheck {
    /// Pairs of intersecting triangles of different placements; `None` if the transforms could not be applied.
    pub crossing: Option<u64>,
    /// The first of these pairs.
    pub witnesses: Vec<WitnessFacts>,
    /// Whether everything is wound outward, with parts taken as cavities of parts that enclose them; `None` if that is
    /// undecided.
    pub outward: Option<bool>,
}

impl SceneCheck {
    /// Returns `None` if there is at most one placement, so that the check of each part is complete.
    pub fn from_scene(scene: &Scene, topology: Topology, job: &Job) -> Result<Option<Self>, JobError> {
        if n_places(scene) < 2 {
            return Ok(None);
        }
        // Without applied transforms, nothing is known of the placements.
        let Ok(assembled) = MergedParts::from_scene(scene, topology) else {
            return Ok(Some(Self { crossing: None, witnesses: Vec::new(), outward: None }));
        };
        let place_of = |face| assembled.place_of(face) as u32;
        let crossings = intersections_between(&assembled.mesh, place_of, job)?;
        Ok(Some(Self {
            crossing: Some(crossings.count),
            witnesses: crossings.witnesses.iter().filter_map(|witness| facts(&assembled, witness)).collect(),
            outward: outward(
                &MeshConnectivity::new(&assembled.mesh, Topology::Indices).components_under(job)?,
            ),
        }))
    }
}

fn facts(assembled: &MergedParts, witness: &Witness) -> Option<WitnessFacts> {
    let chordal::check::findings::MeshLocation::Faces([f, g]) = witness.place else { return None };
    let [(part, f), (other, g)] = [f, g].map(|face| assembled.in_part(face));
    Some(WitnessFacts {
        of: Defect::SelfIntersections.name(),
        part: part as u64,
        other_part: Some(other as u64),
        vertices: Vec::new(),
        faces: vec![f, g],
        at: witness.at,
    })
}
