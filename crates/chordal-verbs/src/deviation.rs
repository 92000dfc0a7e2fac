//! `deviation`: the distance between two shapes, certified from both sides.
use crate::merged_parts;
use crate::report::{BoundFacts, Certificate, DeviationFacts, Report, RunFacts, Verdict};
use crate::{Input, MeshFailure, Shape, field, flatten};
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Length, Reference, RefusalCode, Tolerance};
use chordal::check::{self, Goal, OneSidedDistance};
use chordal::explicit::Cage;
use chordal::math::{add_up, greater, sub_down};
use chordal::{Budget, Job, Mesh, convert};
use std::borrow::Cow;

/// The precision of a distance between two shapes, with lengths as a user gives them.
///
/// A percentage is one of the diagonal of the second shape's box: the second shape is the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviationSpec {
    /// The allowed gap above the lower bound, relative to it.
    pub relative: f64,
    /// The allowed gap as a length.
    pub absolute: Option<Length>,
    /// A limit: only whether the distance exceeds it matters, so the search stops as soon as that is known.
    pub max: Option<Length>,
}

impl Default for DeviationSpec {
    fn default() -> Self {
        Self { relative: Goal::default().relative, absolute: None, max: None }
    }
}

/// The Hausdorff distance between the surfaces of two shapes, as a proved interval, with the worst points.
///
/// Triangle meshes are taken as they are: all parts of a scene, each in its placement. Bézier patches are
/// meshed on the way. They are meshed more finely until their bound, which widens the interval at both ends,
/// leaves the required precision, or until a millionth of their size is reached. Attributes are not compared.
/// Coordinates are compared as numbers; the notes say where frames differ.
///
/// Cost: about 3 µs a vertex of either shape on one core.
///
/// # Errors
/// When a shape has no surface, or a length has no meaning for it; as for [`chordal::check::deviation`].
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
    let found = measure(a.shape, b.shape, &goal, job, &mut certificate)?;
    certificate.bound = Some(BoundFacts::new(&found.bound));
    let verdict = goal.max.map(|max| Verdict::from_bound(&found.bound, max));
    let facts = DeviationFacts {
        against,
        forward: found.forward.into(),
        backward: found.backward.into(),
        diagonal,
        reached: found.reached,
        max: goal.max.map(Tolerance::get),
        verdict,
    };
    let run = RunFacts { verb: "deviation", ..RunFacts::default() };
    Ok(Report { deviation: Some(facts), ..Report::new(certificate, run) })
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
            let message = "one of the two has to have triangles: mesh a field first".to_owned();
            return Err(MeshFailure::refused(RefusalCode::Unsupported, message));
        }
        (Shape::Field(field), other) => (field, other, true),
        (other, Shape::Field(field)) => (field, other, false),
        (a, b) => return ComparedPair::from_shapes(a, b, certificate)?.measure(goal, job),
    };
    let ComparedSurface::Triangles(mesh, off) = ComparedSurface::from_shape(other, certificate)? else {
        let message = "only triangles are measured against a field: mesh the other shape first".to_owned();
        return Err(MeshFailure::refused(RefusalCode::Unsupported, message));
    };
    let found = field::deviation_of(&mesh, &field, goal, job)?;
    let [forward, backward] = [found.forward, found.backward].map(|side| widen(side, off));
    let [forward, backward] = if turned { [backward, forward] } else { [forward, backward] };
    let bound = if off == 0.0 {
        found.bound
    } else {
        // The transforms moved the triangles by at most `off`.
        found.bound.then(&Bound::proved(0.0, off, Reference::InputTriangles))
    };
    Ok(DeviationBounds { bound, forward, backward, reached: found.reached, share: 0.0 })
}

fn frames_differ(a: &Input, b: &Input) -> Option<Message> {
    let (a, b) = (a.shape.frame(), b.shape.frame());
    let differ = |known: Option<bool>| known == Some(true);
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
    /// A cage and its diagonal.
    Cage(Box<Cage>, f64),
}

/// Triangles, their largest distance from the true surface, and which surface that is.
type ApproximateMesh<'a> = (Cow<'a, Mesh>, f64, Reference);

impl ComparedSurface {
    fn from_shape(shape: Shape, certificate: &mut Certificate) -> Result<Self, MeshFailure> {
        let diagonal = shape.diagonal()?;
        match shape {
            Shape::Scene(scene) => {
                let placed = flatten::flatten(scene)?;
                certificate.notes.extend(placed.note());
                let mesh = merged_parts::one_mesh(&placed.scene)?.into_owned();
                Ok(Self::Triangles(mesh, placed.moved_at_most))
            }
            Shape::Patches { patches, .. } => Ok(Self::Patches(patches, diagonal)),
            Shape::Cage(polygons) => Ok(Self::Cage(Box::new(polygons.cage), diagonal)),
            Shape::Volume(_) => {
                let message = "a volume has no triangles to measure: mesh it first".to_owned();
                Err(MeshFailure::refused(RefusalCode::Unsupported, message))
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

    /// Triangles within `share` of the diagonal, their largest distance from the true surface, and which
    /// surface that is.
    fn within(&self, share: f64, job: &Job) -> Result<ApproximateMesh<'_>, MeshFailure> {
        match self {
            Self::Triangles(mesh, off) => Ok((Cow::Borrowed(mesh), *off, Reference::InputTriangles)),
            Self::Patches(_, diagonal) | Self::Cage(_, diagonal) => {
                let tolerance = Tolerance::new(share * diagonal).map_err(|_| {
                    let message = "the shape has no size".to_owned();
                    MeshFailure::refused(RefusalCode::Empty, message)
                })?;
                let budget = Budget::length(tolerance);
                let made = match self {
                    Self::Cage(cage, _) => chordal::convert::cage_to_mesh(cage, &budget, job),
                    Self::Patches(patches, _) => convert::patches_to_mesh(patches, &budget, job),
                    Self::Triangles(mesh, off) => {
                        return Ok((Cow::Borrowed(mesh), *off, Reference::InputTriangles));
                    }
                };
                let missed = "the shape cannot be meshed finely enough: ";
                let made = made.map_err(|failure| MeshFailure::from_missed(failure, missed))?;
                let off = made.bound.at_most().unwrap_or(f64::INFINITY);
                Ok((Cow::Owned(made.shape), off, made.bound.reference))
            }
        }
    }

    fn is_exact(&self) -> bool {
        matches!(self, Self::Triangles(..))
    }
}

/// The measured distances, with the loss of meshing included.
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

/// Fractions of the diagonal to which patches are meshed: first, and at the finest.
const FIRST: f64 = 1e-4;
const FINEST: f64 = 1e-6;
/// The fraction of the gap that meshing may take: at each end, in each surface.
const OF_GAP: f64 = 0.1;

impl ComparedPair {
    /// The surfaces of two shapes; notes of the certificate say what is left out.
    pub fn from_shapes(a: Shape, b: Shape, certificate: &mut Certificate) -> Result<Self, MeshFailure> {
        Ok(Self([ComparedSurface::from_shape(a, certificate)?, ComparedSurface::from_shape(b, certificate)?]))
    }

    /// The triangles that were measured.
    pub fn meshes(&self, found: &DeviationBounds, job: &Job) -> Result<[Cow<'_, Mesh>; 2], MeshFailure> {
        Ok([self.0[0].within(found.share, job)?.0, self.0[1].within(found.share, job)?.0])
    }

    pub fn measure(&self, goal: &Goal, job: &Job) -> Result<DeviationBounds, MeshFailure> {
        let surfaces = &self.0;
        let exact = surfaces.iter().all(ComparedSurface::is_exact);
        let mut share = FIRST;
        loop {
            let [(a, a_off, _), (b, b_off, reference)] =
                [surfaces[0].within(share, job)?, surfaces[1].within(share, job)?];
            let off = if a_off + b_off == 0.0 { 0.0 } else { add_up(a_off, b_off) };
            let inner = if exact { *goal } else { tighten_goal(goal, off) };
            let found = check::deviation(&a, &b, &inner, job)?;
            let [forward, backward] = [found.forward, found.backward].map(|side| widen(side, off));
            let least = greater(forward.at_least, backward.at_least);
            let most = greater(forward.at_most, backward.at_most);
            let near = most <= (1.0 + goal.relative) * least
                || goal.absolute.is_some_and(|length| most <= least + length.get());
            let decided = goal.max.is_some_and(|max| least > max.get() || most <= max.get());
            if exact || decided || near && goal.max.is_none() || share <= FINEST {
                let mut bound = Bound::proved(least, most, reference);
                bound.at = found.bound.at;
                let reached = if exact { found.reached } else { near || decided };
                return Ok(DeviationBounds { bound, forward, backward, reached, share });
            }
            // A fraction that should do, if the distance stays at its current estimate.
            let aim = OF_GAP * goal.relative * least / off * share;
            let next = if aim > FINEST && aim < 0.25 * share { aim } else { 0.1 * share };
            share = greater(next, FINEST);
        }
    }
}

/// The goal for meshes that are up to `off` away from their surfaces: half of the gap is left to meshing.
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
