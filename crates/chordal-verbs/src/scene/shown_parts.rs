//! `ShownParts`: the distance of changed parts from the original ones, as the scene shows them; and
//! the bound of a scene from the bounds of its parts.
use super::placements::{
    IDENTITY, Matrix4, distance_up, largest_reach, largest_stretch, map_rounding, scaled_up,
};
use crate::MeshFailure;
use chordal::budget::{Bound, JobError, Metric, Reference, RefusalCode, Tolerance};
use chordal::check::Goal;
use chordal::explicit::{Attribute, Domain, InvalidMesh, Semantic};
use chordal::math::{add_up, greater, lesser, sub_down};
use chordal::{Job, Mesh, check};
use chordal_io::{RestPose, RestPoses, Scene};

/// The placements and poses of the parts of a scene before they change.
///
/// A transform stretches a bound by a factor. A skin poses each vertex by a map of its own, so that a bound between meshes
/// is of little use for their poses: these are compared directly.
pub(crate) struct ShownParts<'a> {
    poses: RestPoses<'a>,
    /// By part: the nodes that show it in a pose, and the largest factor by which other nodes lengthen it; 0 without any.
    places: Vec<(Vec<usize>, f64)>,
}

impl<'a> ShownParts<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let poses = scene.rest_poses();
        let mut places = vec![(Vec::new(), 0.0); scene.parts.len()];
        for place in crate::scene::placements::part_placements(scene) {
            let (posed, plain): &mut (Vec<usize>, f64) = &mut places[place.part];
            match poses.is_posed(place.node) {
                true => posed.push(place.node),
                false => *plain = greater(place.stretch(), *plain),
            }
        }
        Self { poses, places }
    }

    /// Whether a skin or morph targets pose a part somewhere.
    pub fn is_posed(&self, part: usize) -> bool {
        self.places.get(part).is_some_and(|(posed, _)| !posed.is_empty())
    }

    /// The pose of a part's mesh at the first node that poses it.
    ///
    /// # Errors
    /// If the mesh is not that of the part.
    pub fn first_pose(&self, part: usize, mesh: &Mesh) -> Result<Option<RestPose>, MeshFailure> {
        let Some((posed, _)) = self.places.get(part) else { return Ok(None) };
        let Some(node) = posed.first() else { return Ok(None) };
        Ok(self.poses.pose_of(*node, mesh)?)
    }

    /// A bound for the distance of a part from the original one, wherever the scene shows it, given the bound `own` in its
    /// own coordinates. `limit` is the length for which the result decides something, if any: above it, the bound may be
    /// rough.
    ///
    /// Cost: linear in the vertices, if all joints together move a part nearly as one map does; otherwise that of
    /// [`check::deviation`] for each node.
    pub fn moved(
        &self,
        part: usize,
        [before, after]: [&Mesh; 2],
        own: f64,
        (limit, job): (Option<f64>, &Job),
    ) -> Result<f64, MeshFailure> {
        let (posed, plain) = &self.places[part];
        let mut most = scaled_up(own, *plain);
        for node in posed {
            let poses = self.poses.pose_of(*node, before)?.zip(self.poses.pose_of(*node, after)?);
            let Some((was, is)) = poses else { return Ok(f64::INFINITY) };
            let moved = moved_in_pose([(before, &was), (after, &is)], own, (limit, job))?;
            most = greater(moved, most);
        }
        Ok(most)
    }
}

/// The name of the attribute that holds the positions of the file while a mesh is in its pose.
const OWN_POSITIONS: &str = "own positions";

/// A mesh in a pose, with its own positions as an attribute.
pub(crate) fn in_pose(mesh: &Mesh, pose: &RestPose) -> Result<Mesh, InvalidMesh> {
    let own_positions = Attribute {
        semantic: Semantic::Blended(OWN_POSITIONS.to_owned()),
        domain: Domain::Vertex,
        width: 3,
        values: mesh.positions().iter().flatten().copied().collect(),
    };
    mesh.with_positions(pose.positions.clone())?.with_attribute(own_positions)
}

/// The inverse of [`in_pose`]: the mesh at its own positions again.
pub(crate) fn out_of_pose(posed: &Mesh) -> Result<Mesh, InvalidMesh> {
    let semantic = Semantic::Blended(OWN_POSITIONS.to_owned());
    let is_own = |attribute: &&Attribute| attribute.semantic == semantic;
    let own_positions =
        posed.attributes().iter().find(is_own).map_or(&[][..], |own_positions| &own_positions.values);
    let positions = own_positions.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    posed
        .with_only(posed.attributes().iter().filter(|attribute| !is_own(attribute)).cloned())?
        .with_positions(positions)
}

/// A bound for the distance between two meshes in their poses.
fn moved_in_pose(
    [(before, was), (after, is)]: [(&Mesh, &RestPose); 2],
    own: f64,
    (limit, job): (Option<f64>, &Job),
) -> Result<f64, MeshFailure> {
    let rounding = add_up(was.rounding, is.rounding);
    let by_vertex = moved_by_vertex([(before, was), (after, is)]).map(|moved| add_up(moved, rounding));
    // 1. All joints together may move the part nearly as one map does.
    let map = was.first_map();
    let map_error = add_up(distance_from_map(before, was, &map), distance_from_map(after, is, &map));
    let by_map = add_up(scaled_up(own, largest_stretch(&map)), map_error);
    let quick = by_vertex.map_or(by_map, |moved| lesser(moved, by_map));
    let suffices = match limit {
        Some(limit) => quick <= limit,
        // Chosen: the error of the map is then at most an eighth of the bound.
        None => map_error <= 0.125 * quick,
    };
    if suffices || by_vertex.is_some() {
        return Ok(quick);
    }
    // 2. Otherwise the poses are compared like any two meshes.
    // The rounding of both poses is added to what is measured, which therefore gets less than the limit.
    let max = limit.map(|limit| sub_down(limit, rounding)).and_then(|limit| Tolerance::new(limit).ok());
    let meshes = [is.posed(after)?, was.posed(before)?];
    match check::deviation(&meshes[0], &meshes[1], &Goal { max, ..Goal::default() }, job) {
        Ok(measured) => {
            let compared = measured.bound.at_most().map_or(f64::INFINITY, |most| add_up(most, rounding));
            Ok(lesser(compared, quick))
        }
        Err(JobError::Cancelled) => Err(MeshFailure::Cancelled),
        Err(JobError::Refused(_)) => Ok(quick),
    }
}

/// The largest distance that a vertex moved, if no face changed: then no point of a face moved farther.
fn moved_by_vertex([(before, was), (after, is)]: [(&Mesh, &RestPose); 2]) -> Option<f64> {
    let is_same = before.faces() == after.faces() && was.positions.len() == is.positions.len();
    let moved = || was.positions.iter().zip(&is.positions).map(|(p, q)| distance_up(*p, *q));
    is_same.then(|| moved().fold(0.0, greater))
}

/// A bound for the distance of a pose from one map of all vertices.
fn distance_from_map(mesh: &Mesh, pose: &RestPose, map: &Matrix4) -> f64 {
    let moved = |p: [f64; 3]| {
        let row = |k: usize| map[k] * p[0] + map[4 + k] * p[1] + map[8 + k] * p[2] + map[12 + k];
        [row(0), row(1), row(2)]
    };
    let pairs = mesh.positions().iter().zip(&pose.positions);
    let distances =
        pairs.map(|(p, q)| if *map == IDENTITY { distance_up(*p, *q) } else { distance_up(moved(*p), *q) });
    let rounded = map_rounding(map, largest_reach(&mesh.bounds()));
    add_up(add_up(distances.fold(0.0, greater), rounded), pose.rounding)
}

/// The larger of two bounds, of which the second is in the coordinates of a part.
pub(crate) fn max_bound(all: Bound, part: &Bound, stretch: f64) -> Result<Bound, MeshFailure> {
    let one_sided = [&all, part].iter().any(|bound| bound.metric == Metric::OneSided);
    let at_most = all.at_most().zip(part.at_most()).map(|(all, part)| {
        let part = scaled_up(part, stretch);
        greater(all, part)
    });
    if at_most.is_some_and(|most| !most.is_finite()) {
        return Err(MeshFailure::refused(
            RefusalCode::NotFinite,
            "the transforms of the scene take its coordinates out of range",
        ));
    }
    let evidence = all.evidence().weaker(part.evidence());
    let mut wider = Bound::with_evidence(0.0, at_most, evidence, Reference::InputTriangles);
    wider.metric = if one_sided { Metric::OneSided } else { Metric::Hausdorff };
    Ok(wider)
}
