//! The distance of a result from its reference, by judges that do not depend on how the result was built.
use crate::input::volume::{ValueRange, VolumeShape};
use crate::mesh::field;
use crate::mesh::isosurface::zero_set::level_field;
use crate::scene::frame_nodes::without_frame_nodes;
use crate::scene::placements::distance_up;
use crate::scene::{flatten, merged_parts};
use crate::{Input, MeshFailure, Shape};
use chordal::budget::proof::ProofEffort;
use chordal::budget::{Bound, Failure, JobError, Metric, Reference, Tolerance};
use chordal::check::{self, Goal, OneSidedDistance};
use chordal::convert::has_meshes;
use chordal::convert::{self, Inside};
use chordal::explicit::Cage;
use chordal::explicit::nurbs::{NurbsSurface, TrimmedSurface};
use chordal::explicit::query::Bvh;
use chordal::implicit::Field;
use chordal::math::{add_up, greater, sub_down};
use chordal::{Budget, Job, Mesh};
use chordal_io::{Frame, Scene};
use std::collections::BTreeSet;

/// A result and its reference.
pub(super) struct BoundJudge<'a> {
    pub reference: &'a Input,
    pub result: &'a Input,
    /// The frame of the lengths in the certificate of the result.
    pub frame: &'a Frame,
    pub job: &'a Job,
    /// The requested gap between both ends; `None` if it only matters whether the claim holds.
    relative: Option<f64>,
}

/// The most evaluations of one point by a judge: counted, so that a verdict does not depend on the machine.
#[derive(Clone, Copy)]
pub(super) struct JudgeLimit {
    /// The base number.
    pub least: u64,
    /// The additional number for each triangle.
    pub a_triangle: u64,
}

impl JudgeLimit {
    /// For the check of a claim. Chosen: some ten seconds of one core; for each triangle eight times the evaluations for a
    /// tight bound between copies of a mesh, or 64 triangles of a tessellation of a smooth surface.
    pub const OF_CLAIM: Self = Self { least: 1 << 29, a_triangle: 1 << 15 };
    /// For the lower end of a distance, which decides on no promise. Chosen: about a second, and an eighth for each
    /// triangle.
    pub const CLOSER: Self = Self { least: 1 << 26, a_triangle: 1 << 12 };
}

/// The result of a judge.
pub(super) enum JudgedBound {
    /// The distance, enclosed.
    Between(Bound),
    /// There is no judge for these two shapes, or it gave up; the reason in one sentence.
    Unable(String),
}

/// Triangles in the frame of a certificate, with the largest distance by which transforms moved them through rounding.
pub(super) struct JudgedMesh {
    pub mesh: Mesh,
    pub moved: f64,
}

impl JudgedMesh {
    fn new(scene: Scene) -> Result<Self, MeshFailure> {
        let flattened = flatten::flatten(scene)?;
        let mesh = merged_parts::one_mesh(&flattened.scene)?.into_owned();
        Ok(Self { mesh, moved: flattened.moved_at_most })
    }
}

impl JudgedBound {
    /// The lower end, if there is one.
    pub fn at_least(&self) -> Option<f64> {
        match self {
            Self::Between(bound) => Some(bound.at_least()),
            Self::Unable(_) => None,
        }
    }
}

impl<'a> BoundJudge<'a> {
    pub fn new([reference, result]: [&'a Input; 2], frame: &'a Frame, job: &'a Job) -> Self {
        Self { reference, result, frame, job, relative: None }
    }

    /// The same judge, but until both ends differ by no more than this share.
    pub fn closely(&self, relative: f64) -> Self {
        Self { relative: Some(relative), ..*self }
    }

    /// The goal of a check if the claim is at most `max`.
    fn goal(&self, max: Option<Tolerance>) -> Goal {
        match self.relative {
            Some(relative) => Goal { relative, ..Goal::default() },
            None => Goal { max, ..Goal::default() },
        }
    }

    /// The distance between the two shapes, close enough to decide on the claim if possible.
    pub fn judge(&self, claimed: &Bound) -> Result<JudgedBound, MeshFailure> {
        let max = claimed.at_most().and_then(|most| Tolerance::new(most).ok());
        if claimed.metric == Metric::Parametric {
            return unable("the claim is for points of equal parameter, which the file does not hold");
        }
        // A distance says nothing of sides, unless it is 0: then both surfaces are the same.
        if claimed.metric == Metric::Solid && claimed.at_most() != Some(0.0) {
            return unable("the claim is for sides, and there is no judge for these");
        }
        // Only `bake` turns triangles into a volume: here the triangles are the reference.
        if let (Shape::Scene(read), Shape::Volume(written)) = (&self.reference.shape, &self.result.shape) {
            let mesh = JudgedMesh::new(read.clone())?;
            return self.against_volume((&mesh, written), &self.goal(max), claimed);
        }
        let Shape::Scene(written) = &self.result.shape else {
            return unable(&format!(
                "there is no judge of {} against {}",
                self.result.shape.kind(),
                self.reference.shape.kind()
            ));
        };
        let mesh = self.result_triangles(written)?;
        let goal = self.goal(max);
        match &self.reference.shape {
            Shape::Scene(read) => self.against_triangles(&mesh, read, claimed, &goal),
            Shape::Patches { patches, .. } => {
                let deviation = check::patch_deviation(&mesh.mesh, patches, &goal, self.job);
                conclude(deviation.map(|d| (d.bound, d.backward)), mesh.moved, claimed)
            }
            Shape::Surfaces { surfaces, .. } => self.against_surfaces(&mesh, surfaces, claimed),
            Shape::Cage(polygons) => self.against_cage(&mesh, &polygons.cage, claimed, &goal),
            Shape::Field(implicit) if !implicit.bodies.is_empty() => {
                self.against_bodies(&mesh, implicit, claimed, &goal)
            }
            Shape::Field(implicit) => match field::finite(implicit) {
                Ok(solid) if has_meshes(&solid) => unable("there is no judge of a field with meshes in it"),
                Ok(solid) => {
                    let deviation = check::field_deviation(&mesh.mesh, &solid, &goal, self.job);
                    conclude(deviation.map(|d| (d.bound, d.backward)), mesh.moved, claimed)
                }
                Err(failure) => unable(&failure.to_string()),
            },
            Shape::Volume(sampled) => self.against_volume((&mesh, sampled), &goal, claimed),
            Shape::Drawing(_) | Shape::Curves(_) => {
                unable("there is no judge of triangles against the outlines that they fill")
            }
        }
    }

    /// The triangles that were read and those that were written; `None` if one of both has none.
    pub fn triangles(&self) -> Result<Option<[JudgedMesh; 2]>, MeshFailure> {
        let (Shape::Scene(read), Shape::Scene(written)) = (&self.reference.shape, &self.result.shape) else {
            return Ok(None);
        };
        Ok(Some([JudgedMesh::new(read.clone())?, self.result_triangles(written)?]))
    }

    /// A lower bound for the distance of the triangles from their reference, from one point near both; `None` if no judge
    /// can evaluate a single point. The distances of the point itself are subtracted.
    pub fn seen_from(&self, p: [f64; 3], claimed: &Bound) -> Result<Option<f64>, MeshFailure> {
        let Shape::Scene(written) = &self.result.shape else { return Ok(None) };
        let result = self.result_triangles(written)?;
        let mesh = &result.mesh;
        let mut moved = vec![result.moved];
        // The distances from the result to the true shape, and back.
        let of_field = |solid: &Field| check::field_deviation_at(mesh, solid, p, self.job);
        let seen = match &self.reference.shape {
            Shape::Scene(read) => {
                let reference = JudgedMesh::new(read.clone())?;
                moved.push(reference.moved);
                triangles_at([mesh, &reference.mesh], p, self.job).map(Some)
            }
            Shape::Patches { patches, .. } => check::patch_deviation_at(mesh, patches, p, self.job).map(Some),
            Shape::Cage(polygons) => check::cage_deviation_at(mesh, &polygons.cage, p, self.job).map(Some),
            Shape::Field(implicit) if implicit.bodies.is_empty() => {
                let solid = field::finite(implicit).ok().filter(|solid| !has_meshes(solid));
                solid.map(|solid| of_field(&solid)).transpose()
            }
            Shape::Volume(sampled) => {
                let level = level_of(sampled);
                let solid = level.and_then(|(at, inside)| level_field(&sampled.volume.grid, at, inside));
                solid.map(|solid| of_field(&solid)).transpose()
            }
            _ => Ok(None),
        };
        let [back, forth] = match seen {
            Ok(Some(seen)) => seen,
            Err(JobError::Cancelled) => return Err(MeshFailure::Cancelled),
            Ok(None) | Err(JobError::Refused(_)) => return Ok(None),
        };
        // From the true shape to the result; for a two-sided distance also the other way.
        let least = match claimed.metric {
            Metric::OneSided => forth,
            Metric::Hausdorff => greater(forth, back),
            Metric::Parametric | Metric::Solid => return Ok(None),
        };
        let moved = moved.into_iter().filter(|moved| *moved > 0.0);
        Ok(Some(greater(moved.fold(least, sub_down), 0.0)))
    }

    /// As [`Self::judge`], with limited work, unless the job takes proofs to their ends; also returns whether the limit
    /// ended it.
    pub fn judge_within(
        &self,
        limit: JudgeLimit,
        claimed: &Bound,
    ) -> Result<(JudgedBound, bool), MeshFailure> {
        if self.job.proof_effort == ProofEffort::Full {
            return Ok((self.judge(claimed)?, false));
        }
        let n_triangles =
            [self.reference, self.result].into_iter().map(|input| input.shape.n_triangles().unwrap_or(0));
        let n_triangles = n_triangles.fold(0, u64::saturating_add);
        let most = limit.least.saturating_add(limit.a_triangle.saturating_mul(n_triangles));
        let job = self.job.with_work_limit(most);
        let judged = BoundJudge { job: &job, ..*self }.judge(claimed)?;
        Ok((judged, job.work_left() == 0))
    }

    /// The triangles of the result, as they were before a glTF rotated and scaled them.
    fn result_triangles(&self, scene: &Scene) -> Result<JudgedMesh, MeshFailure> {
        JudgedMesh::new(without_frame_nodes(scene, self.result.format, self.frame).into_owned())
    }

    /// Compares with patches near whole surfaces, or with triangles nearer to trimmed ones: their distance is proved anew
    /// and counted as a displacement of the triangles.
    fn against_surfaces(
        &self,
        mesh: &JudgedMesh,
        faces: &[TrimmedSurface],
        claimed: &Bound,
    ) -> Result<JudgedBound, MeshFailure> {
        /// The share of a claim for patches near the surfaces. Chosen: meshing takes a tenth of the length for them.
        const NEAR: f64 = 1.0 / 64.0;
        /// The share of a claim for triangles near trimmed surfaces. Chosen: claims are some 10 % above the true distance,
        /// and a smaller share takes more triangles.
        const NEARER: f64 = 1.0 / 48.0;
        let within = |part: f64| claimed.at_most().and_then(|most| Tolerance::new(part * most).ok());
        let Some((near, nearer)) = within(NEAR).zip(within(NEARER)) else {
            return unable("the claim has no upper bound");
        };
        if faces.iter().any(|face| !face.loops().is_empty()) {
            // The construction of the surfaces may have cost more than the share, so its slack is added afterwards.
            let slack = faces.iter().fold(0.0, |most: f64, face| greater(face.surface().slack(), most));
            let faces: Vec<TrimmedSurface> = faces.iter().map(|face| face.clone().with_slack(0.0)).collect();
            let reference = convert::trimmed_surfaces_to_mesh(&faces, &Budget::length(nearer), self.job);
            let reference = reference.or_else(Failure::best_effort)?;
            let lost = reference.bound.at_most().unwrap_or(f64::INFINITY);
            let lost = if slack == 0.0 { lost } else { add_up(lost, slack) };
            let moved = add_up(mesh.moved, lost);
            let remaining = claimed.at_most().map(|most| sub_down(most, moved));
            let max = remaining.and_then(|remaining| Tolerance::new(remaining).ok());
            let deviation = check::deviation(&mesh.mesh, &reference.shape, &self.goal(max), self.job);
            return conclude(deviation.map(|d| (d.bound, d.backward)), moved, claimed);
        }
        let surfaces: Vec<NurbsSurface> = faces.iter().map(|face| face.surface().clone()).collect();
        let fitted = match convert::nurbs_to_patches(&surfaces, near, self.job) {
            Ok(patches) => patches,
            Err(failure) => failure.best_effort()?,
        };
        let lost = fitted.bound.at_most().unwrap_or(f64::INFINITY);
        let remaining = claimed.at_most().map(|most| sub_down(most, add_up(lost, mesh.moved)));
        let max = remaining.and_then(|remaining| Tolerance::new(remaining).ok());
        let deviation = check::patch_deviation(&mesh.mesh, &fitted.shape, &self.goal(max), self.job);
        conclude(deviation.map(|d| (d.bound, d.backward)), add_up(mesh.moved, lost), claimed)
    }

    fn against_triangles(
        &self,
        mesh: &JudgedMesh,
        read: &Scene,
        claimed: &Bound,
        goal: &Goal,
    ) -> Result<JudgedBound, MeshFailure> {
        let reference = JudgedMesh::new(read.clone())?;
        let moved = if mesh.moved == 0.0 { reference.moved } else { add_up(mesh.moved, reference.moved) };
        // From the reference to the result, which is all that a one-sided claim says.
        if is_part_of(&reference.mesh, &mesh.mesh)
            && (claimed.metric == Metric::OneSided || is_part_of(&mesh.mesh, &reference.mesh))
        {
            return Ok(JudgedBound::Between(Bound::proved(0.0, moved, Reference::InputTriangles)));
        }
        // If faces correspond, no point moves farther than the corners of its face.
        let by_corners = corners_moved(&mesh.mesh, &reference.mesh);
        if let Some(most) = by_corners
            .map(|most| add_up(most, moved))
            // It is only an upper end: it proves a claim, but cannot refute one, and does not come closer.
            .filter(|most| self.relative.is_none() && Some(*most) <= claimed.at_most())
        {
            return Ok(JudgedBound::Between(Bound::proved(0.0, most, Reference::InputTriangles)));
        }
        let deviation = check::deviation(&mesh.mesh, &reference.mesh, goal, self.job);
        conclude(deviation.map(|d| (d.bound, d.backward)), moved, claimed)
    }

    fn against_cage(
        &self,
        mesh: &JudgedMesh,
        cage: &Cage,
        claimed: &Bound,
        goal: &Goal,
    ) -> Result<JudgedBound, MeshFailure> {
        let deviation = check::cage_deviation(&mesh.mesh, cage, goal, self.job);
        conclude(deviation.map(|d| (d.bound, d.backward)), mesh.moved, claimed)
    }

    /// Compares triangles with the surface of samples at a level.
    fn against_volume(
        &self,
        (mesh, sampled): (&JudgedMesh, &VolumeShape),
        goal: &Goal,
        claimed: &Bound,
    ) -> Result<JudgedBound, MeshFailure> {
        let Some((level, inside)) = level_of(sampled) else {
            return unable(
                "there is no judge of the surfaces of labels, smoothed masks and samples without a level",
            );
        };
        // First the judge of a baked grid and its triangles, which is far faster if it succeeds.
        if let (0.0, Inside::Low, Some(max)) = (level, inside, goal.max)
            && let Some(mut bound) =
                check::zero_set_deviation(&mesh.mesh, &sampled.volume.grid, max, self.job)?
        {
            let most =
                bound.at_most().map(|most| if mesh.moved == 0.0 { most } else { add_up(most, mesh.moved) });
            bound = Bound::with_evidence(0.0, most, bound.evidence().clone(), bound.reference);
            bound.metric = claimed.metric;
            if most.zip(claimed.at_most()).is_some_and(|(most, claimed)| most <= claimed) {
                return Ok(JudgedBound::Between(bound));
            }
        }
        let Some(solid) = level_field(&sampled.volume.grid, level, inside) else {
            return unable("a sample is not a number, or the surface reaches the border of the samples");
        };
        let deviation = check::field_deviation(&mesh.mesh, &solid, goal, self.job);
        conclude(deviation.map(|d| (d.bound, d.backward)), mesh.moved, claimed)
    }
}

/// Lower bounds for the distance from the first of two meshes to the second and back, from one point near both.
fn triangles_at(meshes: [&Mesh; 2], p: [f64; 3], job: &Job) -> Result<[f64; 2], JobError> {
    let from_p = |mesh: &Mesh| -> Result<Option<[f64; 2]>, JobError> {
        let bvh = Bvh::build(mesh, job)?;
        Ok(bvh.closest_distance_down(p).zip(bvh.closest_distance_up(p)).map(|(low, high)| [low, high]))
    };
    let Some((a, b)) = from_p(meshes[0])?.zip(from_p(meshes[1])?) else { return Ok([0.0; 2]) };
    Ok([greater(sub_down(b[0], a[1]), 0.0), greater(sub_down(a[0], b[1]), 0.0)])
}

/// The level of the surface of a volume, and its inside, with the defaults of `mesh`.
fn level_of(sampled: &VolumeShape) -> Option<(f64, Inside)> {
    let surface = &sampled.surface;
    if surface.labels.is_some() || surface.smooth.is_some() {
        return None;
    }
    let range = ValueRange::from_samples(sampled.volume.grid.samples());
    let level =
        surface.level.or_else(|| range.suggest(&sampled.volume).map(|suggestion| suggestion.level))?;
    Some((level, surface.inside.unwrap_or_else(|| range.default_side(level, &sampled.volume))))
}

/// The distance in the metric of the claim, with the displacement by transforms.
pub(super) fn conclude(
    deviation: Result<(Bound, OneSidedDistance), JobError>,
    moved: f64,
    claimed: &Bound,
) -> Result<JudgedBound, MeshFailure> {
    let (bound, backward) = match deviation {
        Ok(deviation) => deviation,
        Err(JobError::Cancelled) => return Err(MeshFailure::Cancelled),
        Err(JobError::Refused(refusal)) => return unable(&refusal.message.to_string()),
    };
    let (least, most) = match claimed.metric {
        // From the true shape to the result: `backward`, since the judge's second shape is the true one.
        Metric::OneSided => (backward.at_least, bound.at_most().map(|_| backward.at_most)),
        _ => (bound.at_least(), bound.at_most()),
    };
    let bound = Bound::with_evidence(least, most, bound.evidence().clone(), bound.reference);
    conclude_bound(&bound, moved, claimed)
}

/// A bound in the metric of the claim, with the displacement by transforms.
pub(super) fn conclude_bound(bound: &Bound, moved: f64, claimed: &Bound) -> Result<JudgedBound, MeshFailure> {
    let least = bound.at_least();
    let least = if moved == 0.0 { least } else { greater(sub_down(least, moved), 0.0) };
    let most = bound.at_most().map(|most| if moved == 0.0 { most } else { add_up(most, moved) });
    let mut judged = Bound::with_evidence(least, most, bound.evidence().clone(), bound.reference.clone());
    judged.metric = claimed.metric;
    Ok(JudgedBound::Between(judged))
}

pub(super) fn unable(reason: &str) -> Result<JudgedBound, MeshFailure> {
    Ok(JudgedBound::Unable(reason.to_owned()))
}

/// Whether every face of the first mesh is a face of the second, with either winding.
fn is_part_of(part: &Mesh, whole: &Mesh) -> bool {
    let faces: BTreeSet<[[u64; 3]; 3]> =
        (0..whole.faces().len()).map(|face| corner_bits(whole, face)).collect();
    (0..part.faces().len()).all(|face| faces.contains(&corner_bits(part, face)))
}

/// The corners of a face by their bits, sorted; both zeros are equal.
fn corner_bits(mesh: &Mesh, face: usize) -> [[u64; 3]; 3] {
    let mut corners = mesh.corners(face).map(|corner| corner.map(|x| (x + 0.0).to_bits()));
    corners.sort_unstable();
    corners
}

/// The largest distance of a corner from the same corner of the same face; `None` if there are different numbers of faces.
fn corners_moved(a: &Mesh, b: &Mesh) -> Option<f64> {
    if a.faces().len() != b.faces().len() {
        return None;
    }
    let mut most = 0.0;
    for face in 0..a.faces().len() {
        for (p, q) in a.corners(face).into_iter().zip(b.corners(face)) {
            most = greater(distance_up(p, q), most);
        }
    }
    Some(most)
}
