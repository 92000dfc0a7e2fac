//! What only shows where all parts of a scene stand: parts that cross or touch, and parts that lie within others.
use super::witness::WitnessFacts;
use crate::flatten::{MergedParts, n_places};
use chordal::Job;
use chordal::budget::JobError;
use chordal::check::{Defect, MeshConnectivity, Witness, intersections_between, outward};
use chordal::explicit::Topology;
use chordal_io::Scene;

/// What was found of all places of parts together.
pub(super) struct SceneCheck {
    /// Pairs of triangles of different places that meet; none where the parts could not be put in one space.
    pub crossing: Option<u64>,
    /// The first of them.
    pub witnesses: Vec<WitnessFacts>,
    /// Whether all is wound outward when parts are cavities of those that they lie in; none where that is open.
    pub outward: Option<bool>,
}

impl SceneCheck {
    /// None where there is one place at most, so that the parts alone tell all.
    pub fn from_scene(scene: &Scene, topology: Topology, job: &Job) -> Result<Option<Self>, JobError> {
        if n_places(scene) < 2 {
            return Ok(None);
        }
        // A scene that cannot be put in one space has places of which nothing is known.
        let Ok(assembled) = MergedParts::from_scene(scene, topology) else {
            return Ok(Some(Self { crossing: None, witnesses: Vec::new(), outward: None }));
        };
        let place_of = |face| assembled.place_of(face) as u32;
        let found = intersections_between(&assembled.mesh, place_of, job)?;
        Ok(Some(Self {
            crossing: Some(found.count),
            witnesses: found.witnesses.iter().filter_map(|witness| facts(&assembled, witness)).collect(),
            outward: outward(
                &MeshConnectivity::new(&assembled.mesh, Topology::Indices).components_under(job)?,
            ),
        }))
    }
}

fn facts(assembled: &MergedParts, witness: &Witness) -> Option<WitnessFacts> {
    let chordal::check::MeshLocation::Faces([f, g]) = witness.place else { return None };
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
