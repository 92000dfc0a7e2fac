//! `deviation`: the distance between two shapes, certified from both sides.
use crate::mesh::field;
use crate::mesh::isosurface::surface_of;
use crate::report::{BoundFacts, Certificate, DeviationFacts, ExaminationFacts, Report, RunFacts, Verdict};
use crate::scene::flatten;
use crate::scene::merged_parts;
use crate::{Input, MeshFailure, Shape, VolumeShape};
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Length, Reference, RefusalCode, Tolerance};
use chordal::check::{self, Goal, OneSidedDistance};
use chordal::explicit::Cage;
use chordal::explicit::nurbs::TrimmedSurface;
use chordal::math::{add_up, greater, lesser, sub_down};
use chordal::{Budget, Job, Mesh, convert};
use std::borrow::Cow;

/// The precision of a distance between two shapes, with lengths as a user gives them.
///
/// Percentages are relative to the diagonal of the second shape's box: the second shape is the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviationSpec {
    /// The allowed gap above the lower bound, relative to it.
    pub relative: f64,
    /// The allowed gap as a length.
    pub absolute: Option<Length>,
    /// A limit: the search stops as soon as it is known whether the distance exceeds the limit.
    pub max: Option<Length>,
}

impl Default for DeviationSpec {
    fn default() -> Self {
        Self { relative: Goal::default().relative, absolute: None, max: None }
    }
}

/// The Hausdorff distance between the surfaces of two shapes, as a proved interval, with the worst points.
///
/// Triangle meshes are taken as they are: all parts of a scene, each in its placement. The surface of a volume that its
/// [`crate::SurfaceSpec`] chooses, Bézier patches and cages are meshed for the comparison. They are meshed more finely until
/// their bound, which widens the interval at both ends, leaves the required precision, or until a millionth of their size is
/// reached. Attributes are not compared. Coordinates are compared as numbers; notes mention different frames.
///
/// Cost: about 3 µs a vertex of either shape on one core.
///
/// # Errors
/// If a shape has no surface, or a length has no meaning for it; as for [`chordal::check::deviation`].
///
/// ```
/// use chordal_verbs::{DeviationSpec, FormatHint, deviation, load};
/// let hint = FormatHint { name: Some("a.obj"), ..FormatHint::default() };
/// let read = |text: &str| load(text.as_bytes(), hint, &Default::default());
/// let a = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")?;
/// let b = read("v 0 0 2\nv 1 0 2\nv 0 1 2\nf 1 2 3\n")?;
/// let report = deviation(a, b, &DeviationSpec::default(), &Default::default())?;
/// let bound = report.certificate.bound.unwrap();
/// assert!(bound.at_least <= 2.0 && bound.at_most.unwrap() >= 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn deviation(a: Input, b: Input, spec: &DeviationSpec, job: &Job) -> Result<Report, MeshFailure> {
    let mut certificate = Certificate::from_input(&a);
    let diagonal = b.shape.diagonal()?;
    let length = |length: Length| -> Result<Tolerance, MeshFailure> {
        length.resolve(diagonal, b.shape.frame().metres_per_unit).map_err(MeshFailure::Length)
    };
    let goal = Goal {
        relative: spec.relative,
        absolute: spec.absolute.map(length).transpose()?,
        max: spec.max.map(length).transpose()?,
    };
    certificate.notes.extend(frames_differ(&a, &b));
    let against = crate::report::InputFacts::from_input(&b);
    let measured = measure(a.shape, b.shape, &goal, job, &mut certificate)?;
    certificate.bound = Some(BoundFacts::new(&measured.bound));
    let verdict = goal.max.map(|max| Verdict::from_bound(&measured.bound, max));
    let facts = DeviationFacts {
        against,
        forward: measured.forward.into(),
        backward: measured.backward.into(),
        diagonal,
        reached: measured.reached,
        max: goal.max.map(Tolerance::get),
        verdict,
    };
    let run = RunFacts { verb: "deviation", ..RunFacts::default() };
    let examined = Some(ExaminationFacts::Deviation(Box::new(facts)));
    Ok(Report { examined, ..Report::new(certificate, run) })
}

/// Measures two triangle surfaces, or triangles against a field.
fn measure(
    a: Shape,
    b: Shape,
    goal: &Goal,
    job: &Job,
    certificate: &mut Certificate,
) -> Result<DeviationBounds, MeshFailure> {
    let (field, other, turned) = match (a, b) {
        (Shape::Field(_), Shape::Field(_)) => {
            let message = "two fields cannot be compared: mesh one of them first".to_owned();
            return Err(MeshFailure::refused(RefusalCode::Unsupported, message));
        }
        (Shape::Field(field), other) => (field, other, true),
        (other, Shape::Field(field)) => (field, other, false),
        (a, b) => return ComparedPair::from_shapes([a, b], certificate, job)?.measure(goal, job),
    };
    let (mesh, error, reference) = match ComparedSurface::from_shape(other, certificate, job)? {
        ComparedSurface::Triangles(mesh, error) => (mesh, error, Reference::InputTriangles),
        ComparedSurface::Volume(sampled) => {
            let NativeSurface { mesh, off: error, reference } = sampled.native;
            (mesh, error, reference)
        }
        ComparedSurface::Patches(..) | ComparedSurface::Surfaces(..) | ComparedSurface::Cage(..) => {
            let message = "only triangles are measured against a field: mesh the other shape first";
            return Err(MeshFailure::refused(RefusalCode::Unsupported, message));
        }
    };
    let measured = field::deviation_of(&mesh, &field, goal, job)?;
    let [forward, backward] = [measured.forward, measured.backward].map(|side| widen(side, error));
    let [forward, backward] = if turned { [backward, forward] } else { [forward, backward] };
    let bound = if error == 0.0 {
        measured.bound
    } else {
        // The triangles are at most `error` from their true surface, because of transforms or the resolution of a lattice.
        measured.bound.then(&Bound::proved(0.0, error, reference))
    };
    Ok(DeviationBounds { bound, forward, backward, reached: measured.reached, share: 0.0 })
}

fn frames_differ(a: &Input, b: &Input) -> Option<Message> {
    let (a, b) = (a.shape.frame(), b.shape.frame());
    let differ = |comparison: Option<bool>| comparison == Some(true);
    let units = differ(a.metres_per_unit.zip(b.metres_per_unit).map(|(a, b)| a != b));
    let up = differ(a.up.zip(b.up).map(|(a, b)| a != b));
    let what = match (units, up) {
        (true, true) => "their unit and the axis that is up",
        (true, false) => "their unit",
        (false, true) => "the axis that is up",
        (false, false) => return None,
    };
    Some(format!("the two shapes differ in {what}; their coordinates are compared as they are").into())
}

/// A surface to measure.
enum ComparedSurface {
    /// Triangles, and the bound of their displacement by transforms.
    Triangles(Mesh, f64),
    /// Patches and their diagonal.
    Patches(Vec<chordal::Patch>, f64),
    /// NURBS surfaces and their diagonal.
    Surfaces(Vec<TrimmedSurface>, f64),
    /// A cage and its diagonal.
    Cage(Box<Cage>, f64),
    /// A volume.
    Volume(Box<SampledSurface>),
}

/// A volume, its diagonal, and the triangles of its surface at the resolution of the lattice.
struct SampledSurface {
    sampled: VolumeShape,
    diagonal: f64,
    native: NativeSurface,
}

/// Triangles at the resolution of a lattice, their largest distance from the interpolant, and the kind of that surface.
struct NativeSurface {
    mesh: Mesh,
    off: f64,
    reference: Reference,
}

impl SampledSurface {
    /// The factor by which triangles may have to come nearer to the interpolant than at the resolution of the lattice.
    /// Chosen: that takes some sixteen times as many triangles.
    const FINER: f64 = 16.0;

    /// Triangles within `share` of the diagonal, or at the lattice's resolution if these are near enough, or if finer ones
    /// are not possible.
    fn within(&self, share: f64, job: &Job) -> Result<ApproximateMesh<'_>, MeshFailure> {
        let native = (Cow::Borrowed(&self.native.mesh), self.native.off, self.native.reference.clone());
        let length = greater(share * self.diagonal, self.native.off / Self::FINER);
        // Labels and smoothed masks have one resolution.
        let Ok(tolerance) = Tolerance::new(length) else { return Ok(native) };
        let surface = &self.sampled.surface;
        if length >= self.native.off || surface.labels.is_some() || surface.smooth.is_some() {
            return Ok(native);
        }
        match surface_of(&self.sampled, Budget::length(tolerance), &mut Vec::new(), job) {
            Ok((scene, bound)) => {
                let mesh = merged_parts::one_mesh(&scene)?.into_owned();
                Ok((Cow::Owned(mesh), bound.at_most().unwrap_or(f64::INFINITY), bound.reference))
            }
            Err(MeshFailure::Cancelled) => Err(MeshFailure::Cancelled),
            Err(_) => Ok(native),
        }
    }
}

/// Triangles, their largest distance from the true surface, and the kind of that surface.
type ApproximateMesh<'a> = (Cow<'a, Mesh>, f64, Reference);

impl ComparedSurface {
    fn from_shape(shape: Shape, certificate: &mut Certificate, job: &Job) -> Result<Self, MeshFailure> {
        let diagonal = shape.diagonal()?;
        match shape {
            Shape::Scene(scene) => {
                let flattened = flatten::flatten(scene)?;
                certificate.notes.extend(flattened.note());
                let mesh = merged_parts::one_mesh(&flattened.scene)?.into_owned();
                Ok(Self::Triangles(mesh, flattened.moved_at_most))
            }
            Shape::Patches { patches, .. } => Ok(Self::Patches(patches, diagonal)),
            Shape::Surfaces { surfaces, .. } => Ok(Self::Surfaces(surfaces, diagonal)),
            Shape::Cage(polygons) => Ok(Self::Cage(Box::new(polygons.cage), diagonal)),
            Shape::Volume(sampled) => {
                let (scene, bound) = surface_of(&sampled, Budget::default(), &mut certificate.notes, job)?;
                let mesh = merged_parts::one_mesh(&scene)?.into_owned();
                let off = bound.at_most().unwrap_or(f64::INFINITY);
                let native = NativeSurface { mesh, off, reference: bound.reference };
                Ok(Self::Volume(Box::new(SampledSurface { sampled, diagonal, native })))
            }
            Shape::Field(_) => {
                let message = "a field has no triangles to measure: mesh it first".to_owned();
                Err(MeshFailure::refused(RefusalCode::Unsupported, message))
            }
            Shape::Drawing(_) | Shape::Curves(_) => {
                let message = "curves have no surface to measure: mesh them first".to_owned();
                Err(MeshFailure::refused(RefusalCode::Unsupported, message))
            }
        }
    }

    /// Triangles within `share` of the diagonal, their largest distance from the true surface, and the kind of that surface.
    fn within(&self, share: f64, job: &Job) -> Result<ApproximateMesh<'_>, MeshFailure> {
        match self {
            Self::Triangles(mesh, off) => Ok((Cow::Borrowed(mesh), *off, Reference::InputTriangles)),
            Self::Volume(sampled) => sampled.within(share, job),
            Self::Patches(_, diagonal) | Self::Surfaces(_, diagonal) | Self::Cage(_, diagonal) => {
                // The share may be that of the other shape's lattice, which says nothing of this one.
                let tolerance = Tolerance::new(lesser(share, FIRST) * diagonal).map_err(|_| {
                    let message = "the shape has no size".to_owned();
                    MeshFailure::refused(RefusalCode::Empty, message)
                })?;
                let budget = Budget::length(tolerance);
                let mesh = match self {
                    Self::Cage(cage, _) => chordal::convert::cage_to_mesh(cage, &budget, job),
                    Self::Patches(patches, _) => convert::patches_to_mesh(patches, &budget, job),
                    Self::Surfaces(surfaces, _) => convert::trimmed_surfaces_to_mesh(surfaces, &budget, job),
                    Self::Triangles(mesh, off) => {
                        return Ok((Cow::Borrowed(mesh), *off, Reference::InputTriangles));
                    }
                    Self::Volume(sampled) => return sampled.within(share, job),
                };
                let missed = "the shape cannot be meshed finely enough: ";
                let mesh = mesh.map_err(|failure| MeshFailure::from_missed(failure, missed))?;
                let off = mesh.bound.at_most().unwrap_or(f64::INFINITY);
                Ok((Cow::Owned(mesh.shape), off, mesh.bound.reference))
            }
        }
    }

    fn is_exact(&self) -> bool {
        matches!(self, Self::Triangles(..))
    }
}

/// The measured distances, with the error of meshing included.
pub(crate) struct DeviationBounds {
    pub bound: Bound,
    pub forward: OneSidedDistance,
    pub backward: OneSidedDistance,
    pub reached: bool,
    /// The fraction of their diagonals to which smooth shapes were meshed.
    share: f64,
}

/// Two surfaces to compare.
pub(crate) struct ComparedPair([ComparedSurface; 2]);

/// Fractions of the diagonal to which patches are meshed: the first, and the finest. Chosen: a finer start costs time,
/// a coarser end precision.
const FIRST: f64 = 1e-4;
const FINEST: f64 = 1e-6;
/// The fraction of the gap that meshing may take, at each end and for each surface. Chosen: most of the gap is left for the
/// search.
const OF_GAP: f64 = 0.1;

impl ComparedPair {
    /// The surfaces of two shapes; notes of the certificate list the data that are left out.
    pub fn from_shapes(
        [a, b]: [Shape; 2],
        certificate: &mut Certificate,
        job: &Job,
    ) -> Result<Self, MeshFailure> {
        let a = ComparedSurface::from_shape(a, certificate, job)?;
        Ok(Self([a, ComparedSurface::from_shape(b, certificate, job)?]))
    }

    /// The triangles that were measured.
    pub fn meshes(&self, measured: &DeviationBounds, job: &Job) -> Result<[Cow<'_, Mesh>; 2], MeshFailure> {
        Ok([self.0[0].within(measured.share, job)?.0, self.0[1].within(measured.share, job)?.0])
    }

    pub fn measure(&self, goal: &Goal, job: &Job) -> Result<DeviationBounds, MeshFailure> {
        let surfaces = &self.0;
        let exact = surfaces.iter().all(ComparedSurface::is_exact);
        let sampled = |surface: &ComparedSurface| match surface {
            ComparedSurface::Volume(sampled) => Some(sampled.native.off / sampled.diagonal),
            _ => None,
        };
        // The first triangles of a volume are those at the lattice's own resolution.
        let native = surfaces.iter().filter_map(sampled).fold(0.0, |most, share| greater(share, most));
        let mut share = if native > 0.0 { native } else { FIRST };
        let mut last_off = f64::INFINITY;
        loop {
            let [(a, a_off, _), (b, b_off, reference)] =
                [surfaces[0].within(share, job)?, surfaces[1].within(share, job)?];
            let off = if a_off + b_off == 0.0 { 0.0 } else { add_up(a_off, b_off) };
            let inner = if exact { *goal } else { tighten_goal(goal, off) };
            let measured = check::deviation(&a, &b, &inner, job)?;
            let [forward, backward] = [measured.forward, measured.backward].map(|side| widen(side, off));
            let least = greater(forward.at_least, backward.at_least);
            let most = greater(forward.at_most, backward.at_most);
            let near = most <= (1.0 + goal.relative) * least
                || goal.absolute.is_some_and(|length| most <= least + length.get());
            let decided = goal.max.is_some_and(|max| least > max.get() || most <= max.get());
            // Finer triangles were refused, or a volume has only those of its lattice: another round would repeat
            // this one.
            let stuck = off >= last_off;
            last_off = off;
            // With a limit, ends that are near each other do not suffice: it may lie between them.
            if exact || decided || near && goal.max.is_none() || share <= FINEST || stuck {
                // The distances of both meshes from their surfaces are in `off`, by which both ends were widened.
                let mut bound = Bound::proved(least, most, reference);
                bound.at = measured.bound.at;
                let reached = if exact { measured.reached } else { near || decided };
                return Ok(DeviationBounds { bound, forward, backward, reached, share });
            }
            // The fraction that is enough if the distance stays at its current estimate.
            let aim = OF_GAP * goal.relative * least / off * share;
            let next = if aim > FINEST && aim < 0.25 * share { aim } else { 0.1 * share };
            share = greater(next, FINEST);
        }
    }
}

/// The goal for meshes that are up to `off` away from their surfaces: half of the gap is left for meshing.
fn tighten_goal(goal: &Goal, off: f64) -> Goal {
    let max = goal.max.and_then(|max| Tolerance::new(sub_down(max.get(), off)).ok());
    let absolute = goal.absolute.and_then(|length| Tolerance::new(0.5 * length.get()).ok());
    Goal { relative: 0.5 * goal.relative, absolute, max }
}

fn widen(side: OneSidedDistance, off: f64) -> OneSidedDistance {
    if off == 0.0 {
        return side;
    }
    let least = sub_down(side.at_least, off);
    OneSidedDistance { at_least: greater(least, 0.0), at_most: add_up(side.at_most, off), ..side }
}
