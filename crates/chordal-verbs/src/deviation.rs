//! `deviation`: how far two shapes are apart, certified from both sides.
use crate::report::{BoundFacts, Certificate, DeviationFacts, Report, RunFacts, Verdict};
use crate::{Input, MeshFailure, Shape, field, flatten};
use chordal::budget::{Bound, Length, Reference, Refusal, RefusalCode, Tolerance};
use chordal::check::{self, Goal, OneSidedDistance};
use chordal::explicit::Cage;
use chordal::math::{add_up, sub_down};
use chordal::{Budget, Job, Mesh, convert};
use std::borrow::Cow;

/// How well the distance of two shapes is to be known, with lengths as a person gives them.
///
/// A percentage is one of the diagonal of the second shape's box, which is the one that the other is measured against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviationSpec {
    /// The upper end may be this share above the lower one.
    pub relative: f64,
    /// It may be this length above.
    pub absolute: Option<Length>,
    /// Whether the distance is at most this is what matters: stop as soon as that is known.
    pub max: Option<Length>,
}

impl Default for DeviationSpec {
    fn default() -> Self {
        Self { relative: Goal::default().relative, absolute: None, max: None }
    }
}

/// The Hausdorff distance between the surfaces of two shapes, as an interval that is proved, with the worst places.
///
/// Triangle meshes are taken as they are: all parts of a scene, each where it stands. Bézier patches are meshed on the
/// way, more finely until what that loses, which is added at both ends, leaves what was asked for, or a millionth of
/// their size is reached. Attributes are not compared. Coordinates are
/// compared as numbers: frames that differ are told in the notes.
///
/// Cost: about 3 µs a vertex of either shape on one core.
///
/// # Errors
/// When a shape has no surface, or a length has no meaning for it; as for [`chordal::check::deviation`].
///
/// ```
/// use chordal_verbs::{DeviationSpec, FormatHint, deviation, load};
/// let read = |text: &str| load(text.as_bytes(), FormatHint { name: Some("a.obj"), ..FormatHint::default() }, &Default::default());
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
    let found = measure(a.shape, b.shape, (&goal, job), &mut certificate)?;
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

/// Measures two surfaces of triangles, or triangles against a field.
fn measure(
    a: Shape,
    b: Shape,
    (goal, job): (&Goal, &Job),
    certificate: &mut Certificate,
) -> Result<DeviationBounds, MeshFailure> {
    let (field, other, turned) = match (a, b) {
        (Shape::Field(_), Shape::Field(_)) => {
            let message = "one of the two has to have triangles: mesh a field first".to_owned();
            return Err(MeshFailure::Refused(Refusal { code: RefusalCode::Unsupported, message }));
        }
        (Shape::Field(field), other) => (field, other, true),
        (other, Shape::Field(field)) => (field, other, false),
        (a, b) => return ComparedPair::from_shapes(a, b, certificate)?.measure(goal, job),
    };
    let ComparedSurface::Triangles(mesh, off) = ComparedSurface::from_shape(other, certificate)? else {
        let message = "only triangles are measured against a field: mesh the other shape first".to_owned();
        return Err(MeshFailure::Refused(Refusal { code: RefusalCode::Unsupported, message }));
    };
    let found = field::deviation_of(&mesh, &field, goal, job)?;
    let [forward, backward] = [found.forward, found.backward].map(|side| widen(side, off));
    let [forward, backward] = if turned { [backward, forward] } else { [forward, backward] };
    let bound = if off == 0.0 {
        found.bound
    } else {
        // Triangles that stand a little off where they belong.
        found.bound.then(&Bound::proved(0.0, off, Reference::InputTriangles))
    };
    Ok(DeviationBounds { bound, forward, backward, reached: found.reached, share: 0.0 })
}

fn frames_differ(a: &Input, b: &Input) -> Option<String> {
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
    Some(format!("the two shapes differ in {what}; their coordinates are compared as they are"))
}

/// A shape as something with a surface to measure.
enum ComparedSurface {
    /// Triangles, and how far they may be from where they belong.
    Triangles(Mesh, f64),
    /// Patches and their diagonal.
    Patches(Vec<chordal::Patch>, f64),
    /// A cage and its diagonal.
    Cage(Box<Cage>, f64),
}

/// Triangles, how far they are from the true surface at most, and which that is.
type ApproximateMesh<'a> = (Cow<'a, Mesh>, f64, Reference);

impl ComparedSurface {
    fn from_shape(shape: Shape, certificate: &mut Certificate) -> Result<Self, MeshFailure> {
        let diagonal = shape.diagonal()?;
        match shape {
            Shape::Scene(scene) => {
                let placed = flatten::flatten(scene)?;
                if placed.left_out > 0 {
                    let note = format!("parts that stand nowhere were left out ({}x)", placed.left_out);
                    certificate.notes.push(note);
                }
                let mesh = flatten::one_mesh(&placed.scene)?.into_owned();
                Ok(Self::Triangles(mesh, placed.moved_at_most))
            }
            Shape::Patches { patches, .. } => Ok(Self::Patches(patches, diagonal)),
            Shape::Cage(polygons) => Ok(Self::Cage(Box::new(polygons.cage), diagonal)),
            Shape::Volume(_) => {
                let message = "a volume has no triangles to measure: mesh it first".to_owned();
                Err(MeshFailure::Refused(Refusal { code: RefusalCode::Unsupported, message }))
            }
            Shape::Field(_) => {
                let message = "a field has no triangles to measure: mesh it first".to_owned();
                Err(MeshFailure::Refused(Refusal { code: RefusalCode::Unsupported, message }))
            }
            Shape::Drawing(_) | Shape::Curves(_) => {
                let message = "curves have no surface to measure: mesh them first".to_owned();
                Err(MeshFailure::Refused(Refusal { code: RefusalCode::Unsupported, message }))
            }
        }
    }

    /// The triangles, how far they are from the true surface at most, and which that is.
    fn within(&self, share: f64, job: &Job) -> Result<ApproximateMesh<'_>, MeshFailure> {
        match self {
            Self::Triangles(mesh, off) => Ok((Cow::Borrowed(mesh), *off, Reference::InputTriangles)),
            Self::Patches(_, diagonal) | Self::Cage(_, diagonal) => {
                let tolerance = Tolerance::new(share * diagonal).map_err(|_| {
                    let message = "the shape has no size".to_owned();
                    MeshFailure::Refused(Refusal { code: RefusalCode::Empty, message })
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

/// What was measured, with what meshing on the way lost.
pub(crate) struct DeviationBounds {
    pub bound: Bound,
    pub forward: OneSidedDistance,
    pub backward: OneSidedDistance,
    pub reached: bool,
    /// The share of their diagonals to which smooth shapes were meshed.
    share: f64,
}

/// Two surfaces.
pub(crate) struct ComparedPair([ComparedSurface; 2]);

/// Shares of the diagonal to which patches are meshed: first, and at the finest.
const FIRST: f64 = 1e-4;
const FINEST: f64 = 1e-6;
/// Of the gap between the ends, what meshing may take: at each end, in each surface.
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
            let least =
                if forward.at_least > backward.at_least { forward.at_least } else { backward.at_least };
            let most = if forward.at_most > backward.at_most { forward.at_most } else { backward.at_most };
            let near = most <= (1.0 + goal.relative) * least
                || goal.absolute.is_some_and(|length| most <= least + length.get());
            let decided = goal.max.is_some_and(|max| least > max.get() || most <= max.get());
            if exact || decided || near && goal.max.is_none() || share <= FINEST {
                let mut bound = Bound::proved(least, most, reference);
                bound.at = found.bound.at;
                let reached = if exact { found.reached } else { near || decided };
                return Ok(DeviationBounds { bound, forward, backward, reached, share });
            }
            // The next share is one that should do, if the distance stays what it seems to be.
            let aim = OF_GAP * goal.relative * least / off * share;
            let next = if aim > FINEST && aim < 0.25 * share { aim } else { 0.1 * share };
            share = if next > FINEST { next } else { FINEST };
        }
    }
}

/// The goal for meshes that are up to `off` away from what they stand for: half the gap is theirs.
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
    OneSidedDistance {
        at_least: if least > 0.0 { least } else { 0.0 },
        at_most: add_up(side.at_most, off),
        ..side
    }
}
