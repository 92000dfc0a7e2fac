//! `simplify`: a mesh with fewer triangles, within a budget.
use super::error_monitor::CheckLevel;
use super::local_tolerance::LocalTolerance;
use super::reduction::{AttemptStart, FailedAttempt, MeshReduction, ReductionStats, UnmonitoredCollapses};
use super::simplified_mesh::{CLOSE, SHARE, SimplifiedMesh, SimplifyFailure, bounded, unchanged};
use super::simplify_to_count::{Effort, simplify_to_count};
use super::wedges::is_carried;
use super::zero_area::ZeroAreaFaces;
use crate::budget::{
    AttributeLimits, Bounded, Budget, ErrorLimit, Failure, Job, JobError, PixelBudget, RefusalCode, Tolerance,
};
use crate::check::findings::AttributeDeviation;
use crate::check::{
    Goal, MappedPair, NearFaces, ViolationReport, attribute_deviation_within, deviation, tolerance_violations,
};
use crate::explicit::{Mesh, Semantic, Topology};
use crate::math::{Box3, lesser};

/// The same surface with as few triangles as a budget allows.
///
/// With a length or pixels, the result is within that of `mesh`, in both directions, and has few triangles
/// for that length. With a triangle count alone, it has at most that many, and about the error that a length
/// with this count would have: [`simplify_to_count`] with [`Effort::Best`]. With both, it is within the length, and
/// [`Failure::Unmet`] if it has more triangles than the count.
///
/// *What the bound covers.* The two-sided Hausdorff distance between all points of both surfaces, proved,
/// rounding included, on the triangles that are returned: by a map between both surfaces, and for faces that
/// it does not cover as by [`check::deviation`](crate::check::deviation). Its ends are within a tenth of each
/// other; for a length not closer than a hundredth of it, for a count not closer than a billionth of the
/// diagonal. Not covered: the angles of normals, and attribute values between the points of a feature line.
///
/// *Pixels.* For an eye anywhere ([`View::MinDistance`](crate::View::MinDistance)) they are one length. For a
/// camera the length depends on the place: far away, behind the eye and off the axis, a pixel is a longer
/// one. The proof goes piece by piece. For a piece of a face of either surface, with the box `B` around it,
/// every point has a point of the other surface within a proved length `l`, so on the screen the two are at
/// most [`View::pixels_of`](crate::View::pixels_of)`(l, B)` apart, if either is visible. `bound.pixels` is
/// the largest such number over the pieces of all faces of both surfaces; the length of the bound is still
/// the largest of all lengths. Faces that both surfaces share have no error. If a face reaches the plane of
/// the eye, there is no bound for any length, and the face stays as it is.
///
/// *What is preserved.* A closed manifold stays one: an edge is collapsed only if the surface stays manifold
/// (link condition) and no face flips. Borders, and lines at which texture coordinates, colours, materials or
/// normals (by more than 30°) jump, stay lines, within the length if there is one; vertices move along them,
/// with the values on either side. Normals of flat shading are recomputed from the new faces. Where the mesh
/// is non-manifold or inconsistently wound it stays as it is; [`ReductionStats`] counts the vertices that
/// this fixes. A separate component is removed only if a length covers its absence, never for a count. A face
/// without area that joins no two others is dropped if the length covers its absence, and stays as it is
/// otherwise; if there are such faces, the bound starts at 0.
///
/// *Attributes.* With [`AttributeLimits`] beside a length or pixels, texture coordinates and normals are
/// within them as [`attribute_deviation`] measures it, at four samples a face of either mesh; if no attempt
/// achieves that, the mesh stays as it is. Measured, not proved.
///
/// *Inputs.* n × 3 positions, m × 3 indices; `topology` says which rows are one position. Attributes are
/// preserved.
///
/// *Cost.* 3 to 17 µs a triangle on one core on smooth shapes, 15 to 25 µs on scans, 35 to 50 µs if faces are
/// needles, as in parts that CAD programs triangulated; 700 to 1,050 bytes a triangle. Large meshes are
/// collapsed in regions on all threads, with the same result on any number of them. [`Effort::Fast`] reaches
/// a count in less time.
///
/// # Errors
/// [`Failure::Unmet`] with the best result if a count cannot be reached; [`RefusalCode::Budget`] without a
/// limit or with an angle; [`RefusalCode::Empty`] without a triangle; [`RefusalCode::TooClose`] if all
/// faces come so close to the eye that no pixel bound exists; the refusals of
/// [`check::deviation`](crate::check::deviation).
///
/// ```
/// use chordal::{Budget, Job, Mesh, Tolerance, explicit::Topology, lod::simplify};
/// // A flat square of 800 triangles needs few.
/// let row = |i: u32| (0..21).map(move |j| [f64::from(i), f64::from(j), 0.0]);
/// let positions = (0..21).flat_map(row).collect();
/// let cell = |i: u32| (0..20).flat_map(move |j| { let a = 21 * i + j; [[a, a + 21, a + 22], [a, a + 22, a + 1]] });
/// let mesh = Mesh::new(positions, (0..20).flat_map(cell).collect())?;
/// let budget = Budget::length(Tolerance::new(1e-6)?);
/// let simplified = simplify(&mesh, &budget, Topology::Indices, &Job::default()).expect("reachable");
/// assert!(simplified.shape.mesh.faces().len() <= 8);
/// assert!(simplified.bound.at_most().unwrap() <= 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Sources: M. Garland, P. Heckbert, *Surface simplification using quadric error metrics*, 1997; H. Hoppe,
/// *New quadric metric for simplifying meshes with appearance attributes*, 1999, for the wedges; T. Dey, H.
/// Edelsbrunner, S. Guha, D. Nekhayev, *Topology preserving edge contraction*, 1999. Assigning points of the
/// original to faces: R. Klein, G. Liebich, W. Straßer, *Mesh reduction with error control*, 1996. The map: J. Cohen,
/// D. Manocha, M. Olano, *Simplifying polygonal models using successive mappings*, 1997.
pub fn simplify(
    mesh: &Mesh,
    budget: &Budget,
    topology: Topology,
    job: &Job,
) -> Result<Bounded<SimplifiedMesh>, SimplifyFailure> {
    if budget.angle_deg.is_some() {
        let message = "simplification has no budget for angles: it bounds the distance between two surfaces";
        return Err(Failure::refused(RefusalCode::Budget, message));
    }
    if mesh.faces().is_empty() {
        return Err(Failure::refused(RefusalCode::Empty, "there is no triangle to simplify"));
    }
    let bounds = mesh.bounds();
    let Some(allowed) =
        ErrorLimit::from_budget(budget, &bounds).filter(|allowed| has_bounded_face(allowed, mesh))
    else {
        let message = "the mesh comes so close to the eye that there is no bound in pixels";
        return Err(Failure::refused(RefusalCode::TooClose, message));
    };
    let mut simplified = if allowed.constant() == Some(f64::INFINITY) {
        match budget.triangles {
            Some(_) if budget.attributes.is_set() => {
                let message = "limits on attributes need a length or pixels beside them";
                return Err(Failure::refused(RefusalCode::Budget, message));
            }
            Some(most) => return simplify_to_count(mesh, most, Effort::Best, topology, job),
            None => {
                return Err(Failure::refused(
                    RefusalCode::Budget,
                    "the budget has no limit: no length, no pixels, no triangles",
                ));
            }
        }
    } else {
        let attributes = budget.attributes;
        let input = |mesh| SimplifyInput { mesh, topology, fixed_rows: &[], limit: allowed, attributes, job };
        match ZeroAreaFaces::set_aside(mesh, topology) {
            Some(faces) => faces.restore(simplify_within(&input(&faces.rest))?, Some(&allowed), job)?,
            None => simplify_within(&input(mesh))?,
        }
    };
    if let Some(PixelBudget { view, .. }) = &budget.pixels {
        // Both bounds are proved: the largest one over the pieces, each for its place, and the one for the
        // largest distance anywhere in the bounding box.
        let pixels_of_length = simplified.bound.at_most().and_then(|most| view.pixels_of(most, &bounds));
        simplified.bound.pixels = match (simplified.bound.pixels, pixels_of_length) {
            (Some(a), Some(b)) => Some(lesser(a, b)),
            (a, b) => a.or(b),
        };
    }
    if budget.triangles.is_some_and(|most| simplified.shape.mesh.faces().len() as u64 > most) {
        return Err(Failure::Unmet(Box::new(simplified)));
    }
    Ok(simplified)
}

/// Whether some face is at a place where a length is allowed.
fn has_bounded_face(allowed: &ErrorLimit, mesh: &Mesh) -> bool {
    let face = |face: usize| allowed.at(&Box3::from_points(&mesh.corners(face))).is_some();
    // A length for the whole box holds for every face, and takes one query.
    allowed.at(&mesh.bounds()).is_some() || (0..mesh.faces().len()).any(face)
}

/// Fewer triangles whose mean distance from planes of the original is within a length; how far they are from it is for the
/// caller to find out. A tenth of the time of [`simplify`].
pub(super) fn simplify_by_planes(mesh: &Mesh, mean: f64, job: &Job) -> Result<Mesh, JobError> {
    let mut reduction = MeshReduction::new(mesh, Topology::Indices);
    if reduction.is_empty() {
        return Ok(mesh.clone());
    }
    let tolerance = reduction.uniform_tolerance(mean);
    reduction.run_by_planes(&tolerance, job)?;
    Ok(reduction.mesh())
}

/// A mesh, and the length within which it is to be simplified.
pub(super) struct SimplifyInput<'a> {
    pub mesh: &'a Mesh,
    pub topology: Topology,
    /// By row, for a part of a larger mesh: whether it is fixed, since other parts share it. Empty for a
    /// whole mesh.
    pub fixed_rows: &'a [bool],
    pub limit: ErrorLimit,
    pub attributes: AttributeLimits,
    pub job: &'a Job,
}

/// The most attempts, each with stricter checks where the previous one deviated too much.
/// Measured: up to 6 are needed.
const ATTEMPTS: u32 = 14;
/// The fraction of a length that collapses without a monitor may cost. Chosen: a larger one has to be undone
/// more often, a smaller one saves less time.
const SLIGHT: f64 = 0.25;
/// From this attempt on, the parts where the previous one deviated too much are frozen. Chosen: a smaller
/// number gives up earlier on triangles that could still be saved.
const LAST_LOOK: u32 = 8;

/// As few triangles as fit within a length.
pub(super) fn simplify_within(input: &SimplifyInput<'_>) -> Result<Bounded<SimplifiedMesh>, JobError> {
    let mut simplifier = ProgressiveSimplifier::new(input)?;
    let simplified = simplifier.simplify_within(&input.limit, input.job)?;
    Ok(simplified.unwrap_or_else(|| simplifier.unchanged()))
}

/// A mesh that is simplified step by step, within growing lengths. Each result is proved against the original
/// mesh.
pub(super) struct ProgressiveSimplifier<'a> {
    mesh: &'a Mesh,
    topology: Topology,
    /// The state of the last proof that succeeded.
    proved: MeshReduction<'a>,
    /// Whether any proof has succeeded.
    is_proved: bool,
    attributes: AttributeLimits,
    /// With this many triangles there are few enough.
    enough: usize,
}

impl<'a> ProgressiveSimplifier<'a> {
    pub fn new(input: &SimplifyInput<'a>) -> Result<Self, JobError> {
        let SimplifyInput { mesh, topology, fixed_rows, attributes, job, .. } = *input;
        let mut proved = MeshReduction::from_region(mesh, topology, fixed_rows, &attributes);
        if !proved.is_empty() {
            proved.start_monitor(job)?;
            if attributes.is_set() {
                proved.start_attribute_guard(&attributes);
            }
        }
        Ok(Self { mesh, topology, proved, is_proved: false, attributes, enough: 0 })
    }

    /// The same, but it stops once at most this many triangles are left.
    pub fn with_enough(self, enough: usize) -> Self {
        Self { enough, ..self }
    }

    /// By row of the last result: the row of the original mesh that is fixed there, or the largest number.
    pub fn fixed_rows(&self) -> Vec<u32> {
        self.proved.fixed_rows()
    }

    /// The original mesh.
    pub fn unchanged(&self) -> Bounded<SimplifiedMesh> {
        unchanged(self.mesh, ReductionStats { degenerate_faces: 0, ..self.proved.stats })
    }

    /// As few triangles as fit within `allowed`, which is nowhere less than in the last call; `None` if none
    /// were found, or no fewer than the last time.
    pub fn simplify_within(
        &mut self,
        allowed: &ErrorLimit,
        job: &Job,
    ) -> Result<Option<Bounded<SimplifiedMesh>>, JobError> {
        if self.proved.is_empty() {
            return Ok(None);
        }
        let mesh = self.mesh;
        self.proved.stats.unsettled_faces = 0;
        let tolerance = self.proved.local_tolerance(allowed, SHARE);
        let mut failed: Option<(FailedAttempt, ViolationReport, [Vec<u32>; 2])> = None;
        // After a first level, few collapses are slight for the next one.
        let unmonitored = if self.is_proved { None } else { self.unmonitored_collapses(&tolerance, job)? };
        let mut start = AttemptStart::new(unmonitored);
        for attempt in 1..=ATTEMPTS {
            if let Some((failed, report, _)) = &mut failed {
                start.after_failure(failed, report);
                if attempt == LAST_LOOK {
                    start.drop_unmonitored(failed);
                }
            }
            let from = start.state(&self.proved);
            // Most of an attempt from the same state can be repeated.
            let retried = failed.as_mut().filter(|_| !from.guards_attributes());
            let retried =
                retried.map(|(failed, report, _)| from.retry(failed, report, (&tolerance, attempt - 2)));
            let is_again = retried.is_some();
            let mut reduction = retried.unwrap_or_else(|| from.clone());
            match &failed {
                None => {
                    reduction.reset_check_levels();
                    reduction.reset_attribute_shares();
                    reduction.freeze_too_close(&tolerance);
                }
                Some((failed, report, beyond)) => {
                    let more = if attempt < LAST_LOOK { CheckLevel::escalate } else { CheckLevel::freeze };
                    reduction.raise_check_levels(failed, report, more);
                    reduction.tighten_attributes(failed, beyond);
                }
            }
            if is_again {
                // In the last attempts the open parts stay as they were.
                if attempt < LAST_LOOK {
                    reduction.run_open(self.enough, &tolerance, job)?;
                }
            } else {
                reduction.run(self.enough, &tolerance, job)?;
            }
            reduction.drop_small_components(&tolerance, job)?;
            // If nothing was dropped or collapsed, the mesh is unchanged.
            let is_known =
                self.is_proved || (reduction.stats.degenerate_faces == 0 && !self.attributes.is_set());
            if is_known && reduction.n_faces() == self.proved.n_faces() {
                return Ok(None);
            }
            let simplified = reduction.mesh();
            // For one length both surfaces are mapped; for lengths that depend on the place they are
            // searched.
            let near = reduction.near_faces();
            let near = NearFaces { by_row: &near, topology: self.topology };
            let mapped = allowed
                .constant()
                .map(|length| MappedPair::new(mesh, &simplified, (near, length), job))
                .transpose()?;
            let report = match (&mapped, allowed.constant()) {
                (Some(mapped), Some(length)) => mapped.violations(length, job)?,
                _ => tolerance_violations(mesh, &simplified, allowed, job)?,
            };
            if report.is_empty() {
                let (attributes, beyond) = self.attribute_deviation(&simplified, report.at_most, job)?;
                if beyond.iter().any(|faces| !faces.is_empty()) {
                    failed = Some((FailedAttempt::new(reduction), report, beyond));
                    continue;
                }
                // A deviation far below the length need not be known to a tenth of itself.
                let close = |length| Tolerance::new(CLOSE * lesser(length, mesh.bounds().diagonal())).ok();
                let absolute = allowed.constant().and_then(close);
                let goal = Goal { absolute, ..Goal::default() };
                let deviation_found = match mapped {
                    Some(mapped) => mapped.deviation(report.at_most, &goal, job)?,
                    None => deviation(mesh, &simplified, &goal, job)?,
                };
                let mut simplified = bounded(simplified, &deviation_found, report.at_most, reduction.stats);
                simplified.shape.attributes = attributes;
                let by_place = allowed.constant().is_none() && report.pixels.is_finite();
                simplified.bound.pixels = by_place.then_some(report.pixels);
                let _ = reduction.compact();
                reduction.thin_out_samples();
                (self.proved, self.is_proved) = (reduction, true);
                return Ok(Some(simplified));
            }
            failed = Some((FailedAttempt::new(reduction), report, Default::default()));
        }
        let n_unsettled = failed.map_or(0, |(_, report, _)| report.count());
        self.proved.stats.unsettled_faces = n_unsettled as u64;
        Ok(None)
    }

    /// The mesh after collapses that cost so little that they need no monitor; `None` if it is not close
    /// enough.
    fn unmonitored_collapses(
        &self,
        tolerance: &LocalTolerance,
        job: &Job,
    ) -> Result<Option<(MeshReduction<'a>, UnmonitoredCollapses)>, JobError> {
        if self.proved.guards_attributes() || !tolerance.is_constant() {
            return Ok(None);
        }
        self.proved.after_unmonitored((SLIGHT, self.enough), tolerance, job)
    }

    /// The deviation of attributes with limits from those of the original, and the faces of either mesh
    /// beyond the limits. Lines between charts may have moved by `moved`.
    fn attribute_deviation(
        &self,
        simplified: &Mesh,
        moved: f64,
        job: &Job,
    ) -> Result<(Vec<AttributeDeviation>, [Vec<u32>; 2]), JobError> {
        if !self.attributes.is_set() {
            return Ok(Default::default());
        }
        let normals = self.mesh.attribute(&Semantic::Normal);
        // Normals of flat shading are recomputed from the faces: no limit holds for them.
        let has_own_normals = normals.is_some_and(|normals| is_carried(self.mesh, normals));
        let limit = |semantic: &Semantic| match semantic {
            Semantic::TexCoord(_) => self.attributes.texcoord(),
            Semantic::Normal if has_own_normals => self.attributes.normal_deg(),
            _ => None,
        };
        attribute_deviation_within(self.mesh, simplified, Tolerance::new(moved).ok(), &limit, job)
    }
}
