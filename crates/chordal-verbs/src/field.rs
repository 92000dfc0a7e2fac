//! Fields: meshed within a budget, and measured against triangles.
use crate::contact_lines::name_lines;
#[cfg(feature = "booleans")]
use crate::field_by_booleans::{cut_note, mesh_by_booleans};
#[cfg(feature = "booleans")]
use crate::field_by_solids::{draft_by_solids, mesh_by_solids};
use crate::field_looks::{renumber, with_materials};
use crate::field_slack::SlackRequest;
use crate::file_rows::unsupported;
use crate::report::OpenPlacesFacts;
use crate::request::MeshRequest;
use crate::simplified_isosurface::{MadeMesh, simplified, simplified_without_crossings};
use crate::{ImplicitShape, MeshFailure, ShapeLine};
use chordal::budget::advice::{Message, Setting};
use chordal::budget::proof::ProofEffort;
use chordal::budget::{Bound, Budget, Evidence, Failure, Metric, RefusalCode, RequiredEvidence, Tolerance};
use chordal::check::{self, FieldDeviation, Goal};
use chordal::explicit::Topology;
use chordal::implicit::Field;
use chordal::implicit::materials::SurfaceMaterial;
use chordal::math::{Box3, greater};
use chordal::{Bounded, Job, Mesh, convert};
use chordal_io::{Node, Scene};

/// The isosurface of a field at the precision of the format, with its bound.
///
/// # Errors
/// When the field is unbounded; as for [`convert::field_to_mesh`].
pub(crate) fn mesh_field(
    implicit: &ImplicitShape,
    request: &MeshRequest,
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    let mut materials = Vec::new();
    let (scene, bound) = mesh_parts(implicit, request, (&mut materials, notes), job)?;
    Ok((with_materials(scene, &materials).map_err(unsupported)?, bound))
}

/// A field with meshes by booleans, with its materials. None where it is meshed as a whole.
#[cfg(feature = "booleans")]
fn cut_along_meshes(
    field: &Field,
    request: &MeshRequest,
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
    if !convert::has_meshes(field) {
        return Ok(None);
    }
    let Some(made) = mesh_by_booleans(field, request, job)? else { return Ok(None) };
    notes.push(cut_note().into());
    let painted = convert::with_face_materials(made, field, job);
    painted.map(Some).map_err(|failure| MeshFailure::from_missed(failure, ""))
}

/// Without booleans every field is meshed as a whole.
#[cfg(not(feature = "booleans"))]
fn cut_along_meshes(
    _: &Field,
    _: &MeshRequest,
    _: &mut Vec<Message>,
    _: &Job,
) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
    Ok(None)
}

/// The same without the materials, which are added to a list.
fn mesh_parts(
    implicit: &ImplicitShape,
    request: &MeshRequest,
    (materials, notes): (&mut Vec<SurfaceMaterial>, &mut Vec<Message>),
    job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    if !implicit.bodies.is_empty() {
        return mesh_bodies(implicit, request, (materials, notes), job);
    }
    let field = finite(implicit)?;
    let within = SlackRequest::new(&field, request)?;
    let Bounded { shape: mesh, bound } = match cut_along_meshes(&field, &within.inner, notes, job)? {
        Some(made) => made,
        None => mesh_of_field((&field, &implicit.lines), &within.inner, notes, job)?,
    };
    let (bound, counted) = within.count(bound);
    notes.extend(counted);
    if let Some(region) = implicit.region {
        let [low, high] = [region.min, region.max];
        notes.push(
            format!("the shape is cut off at the box from {low:?} to {high:?}, and closed there").into(),
        );
    }
    // Formats with normals; other formats keep one row a vertex.
    let shaded = request.to.wants_normals();
    let mesh = if shaded { convert::with_gradient_normals(&mesh, &field, job)? } else { mesh };
    let mesh = renumber(mesh, &field, materials).map_err(unsupported)?;
    Ok((Scene::from_mesh("field", mesh, implicit.frame), bound))
}

/// Without booleans every field is meshed as a whole.
#[cfg(not(feature = "booleans"))]
fn mesh_by_solids(_: &Field, _: &MeshRequest, _: &Job) -> Result<Option<MadeMesh>, MeshFailure> {
    Ok(None)
}

/// Without booleans every draft is one of cubes.
#[cfg(not(feature = "booleans"))]
fn draft_by_solids(_: &Field, _: &MeshRequest, _: &Job) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
    Ok(None)
}

/// What there is at once of a field, in its colours: the triangles of the solids that it combines, or cubes.
fn draft(
    field: &Field,
    request: &MeshRequest,
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<Bounded<Mesh>, MeshFailure> {
    let made = match draft_by_solids(field, request, job)? {
        Some(made) => made,
        None => {
            let (made, words) = mesh_whole(field, request, job)?;
            notes.extend(words);
            if *made.bound.evidence() == Evidence::Estimated {
                notes.push(DRAFT.into());
            }
            made
        }
    };
    if field.materials().is_empty() {
        return Ok(made);
    }
    convert::with_face_materials(made, field, job).map_err(|failure| MeshFailure::from_missed(failure, ""))
}

/// What is said of a mesh that is measured although a proof was tried; `None` of others.
fn unproved_note(bound: &Bound) -> Option<Message> {
    if bound.evidence().bounds_above() {
        return None;
    }
    let what = match bound.open.as_deref() {
        None => {
            "no proof was begun: memory for the cells of the shape, or the time, ran out before; points all over its \
             triangles are measured"
                .to_owned()
        }
        // More work would prove nothing.
        Some(open) if open.count == 0 => {
            let why = OpenPlacesFacts::new(open);
            return Some(format!("not proved: {why}; points all over its triangles are measured").into());
        }
        Some(open) => format!(
            "not proved at {}; each triangle elsewhere is proved to be near the shape, and points all over are measured",
            OpenPlacesFacts::new(open)
        ),
    };
    Some(
        Message::from(what)
            .words("; ")
            .value(Setting::Effort, "best")
            .words(" goes on with the proof to its end"),
    )
}

/// The surface of a field: the triangles of the solids that it combines, or where it has others, or these are not proved, its
/// own. The lines of its script are for sentences.
fn mesh_of_field(
    (field, lines): (&Field, &[ShapeLine]),
    request: &MeshRequest,
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<Bounded<Mesh>, MeshFailure> {
    if request.budget.require == RequiredEvidence::Estimated {
        return draft(field, request, notes, job);
    }
    let is_proved = |made: &MadeMesh| made.0.bound.at_most().is_some();
    let is_enough = |made: &MadeMesh| is_proved(made) || request.budget.require == RequiredEvidence::Measured;
    let ways = BothWays::new(request, job);
    let (mut made, words) = match mesh_by_solids(field, request, &ways.limited())? {
        Some(made) if is_enough(&made) || !ways.has_second(field) || job.is_finishing() => made,
        None => mesh_whole(field, request, job)?,
        // The proof of a field ends at places where that of its solids does not.
        Some(made) => match mesh_whole(field, request, &ways.second()) {
            Err(MeshFailure::Cancelled) => return Err(MeshFailure::Cancelled),
            Ok(whole) if is_proved(&whole) => whole,
            _ => made,
        },
    };
    notes.extend(words);
    name_lines(&mut made.bound, lines);
    if field.evidence().bounds_above() && request.budget.require == RequiredEvidence::ProvedOrMeasured {
        notes.extend(unproved_note(&made.bound));
    }
    notes.extend(shape_notes(&made.shape, request, job));
    Ok(made)
}

/// The evaluations of the proof of solids, and then those of the way of a field where that proof did not end, if a proof is a
/// wish and no condition. Measured: of the tests' 179 parts the second proves 14 in no more, which takes up to six seconds; those
/// that it never proves took up to half a minute without a limit, and a lattice of 500 struts minutes.
const WORK: u64 = 1 << 24;
/// The most bytes of the cells of that way. Measured: what it proves takes up to half of it; cells of what it does not prove go
/// on to be halved for a minute.
const CELLS: u64 = 1 << 27;
/// Combinations of more solids are not tried in the second way. Measured: what it proves has up to 24, and of a lattice of 216
/// rods, which takes three seconds, it meshed 50 more in vain.
const MOST_SOLIDS: u64 = 64;
/// The share of a memory that these proofs may take. Measured: under a limit of 256 MB 275 were held where they took all of it,
/// and cuts of a thousand solids had left 100 of them behind.
const SHARE_OF_MEMORY: f64 = 0.5;

/// The conditions of a combination of solids by its triangles, and then, where some were made, by its field.
struct BothWays {
    job: Job,
    is_unlimited: bool,
}

impl BothWays {
    fn new(request: &MeshRequest, job: &Job) -> Self {
        let mut job = job.clone();
        job.memory_limit = (SHARE_OF_MEMORY * job.memory_limit as f64) as u64;
        let is_unlimited =
            request.budget.require == RequiredEvidence::Proved || job.proof_effort == ProofEffort::Full;
        Self { job, is_unlimited }
    }

    fn limited(&self) -> Job {
        if self.is_unlimited { self.job.clone() } else { self.job.with_work_limit(WORK) }
    }

    /// Whether it is worth while to try that of a field.
    fn has_second(&self, field: &Field) -> bool {
        self.is_unlimited || field.construction().is_none_or(|own| own.n_solids() <= MOST_SOLIDS)
    }

    /// For the way of a field.
    fn second(&self) -> Job {
        let mut job = self.limited();
        if !self.is_unlimited {
            job.memory_limit = job.memory_limit.min(CELLS);
        }
        job
    }
}

/// The surface of a field by itself, and what is to be said of it.
fn mesh_whole(field: &Field, request: &MeshRequest, job: &Job) -> Result<MadeMesh, MeshFailure> {
    let mut words = None;
    let made = request.run(job, |budget| {
        let way = if convert::has_meshes(field) { simplified_field } else { mesh_in_detail };
        let (made, said) = way(field, (budget, request), job)?;
        words = said;
        Ok(made)
    })?;
    Ok((made, words))
}

/// What is to be said of a draft of cubes, whose vertices move by themselves. To count what crosses takes as long as the draft.
pub(crate) const DRAFT: &str = "a draft: its triangles may cross each other, and `inspect` counts where";

/// What is to be said of the triangles of a shape, as they are written: ties that their digits make, and triangles that cross.
fn shape_notes(mesh: &Mesh, request: &MeshRequest, job: &Job) -> Vec<Message> {
    let mut notes = Vec::new();
    let ties = check::validity(mesh, Topology::Positions).non_manifold_edges.count;
    if ties > 0 {
        let message = format!(
            "{ties} edges have three triangles or more: parts of the shape touch there, or come nearer to each other than \
             the digits of {} tell apart",
            request.to
        );
        notes.push(message.into());
    }
    notes.extend(crossing_note(mesh, job));
    notes
}

/// What is to be said of triangles that cross: their bound holds all the same, but what fills solids, as slicers do, may trip
/// over them.
fn crossing_note(mesh: &Mesh, job: &Job) -> Option<Message> {
    let n_pairs = check::self_intersections(mesh, job).map_or(0, |found| found.count);
    let pairs = if n_pairs == 1 { "pair" } else { "pairs" };
    let message =
        Message::from(format!("triangles cross or touch each other in {n_pairs} {pairs}: `inspect` with "))
            .setting(Setting::SelfIntersections)
            .words(" shows where, and a shorter length may end that");
    (n_pairs > 0).then_some(message)
}

/// The coarsest length, relative to the diagonal of the bounds, for which a field is meshed; what a longer one has room for is
/// left to collapses. Chosen: about where details of ordinary parts begin to be as large as the length, so that cells miss
/// them, proofs do not end, and triangles become more instead of fewer.
const COARSEST: f64 = 0.01;

/// The surface of a field without meshes. Of a long length all but a hundredth of the size is for collapses of the triangles
/// that such a length needs; and of a shape in several materials, what is left of the length is for collapses of those that
/// lie along their borders.
fn mesh_in_detail(
    field: &Field,
    (budget, request): (&Budget, &MeshRequest),
    job: &Job,
) -> Result<MadeMesh, Failure<Mesh>> {
    let direct = || convert::field_to_mesh(field, budget, job);
    let coarsest = Tolerance::new(COARSEST * field.bounds().diagonal());
    let (Some(length), Ok(coarsest)) = (budget.length.map(Tolerance::get), coarsest) else {
        return direct().map(|made| (made, None));
    };
    // What is only measured leaves no length that could be added to.
    let is_proof_tried =
        matches!(budget.require, RequiredEvidence::Proved | RequiredEvidence::ProvedOrMeasured)
            && field.evidence().bounds_above();
    if !is_proof_tried || budget.pixels.is_some() || budget.triangles.is_some() {
        return direct().map(|made| (made, None));
    }
    let fine = if length > coarsest.get() {
        match convert::field_to_mesh(field, &Budget { length: Some(coarsest), ..*budget }, job) {
            Ok(fine) => fine,
            Err(Failure::Cancelled) => return Err(Failure::Cancelled),
            // What is missed within so little may be met within more.
            Err(_) => return direct().map(|made| (made, None)),
        }
    } else if field.materials().is_empty() {
        return direct().map(|made| (made, None));
    } else {
        direct()?
    };
    if fine.bound.at_most().is_none() {
        return Ok((fine, None));
    }
    simplified_without_crossings(fine, (budget, length, request.effort), job)
}

/// The share of a length within which signs on a lattice are polygonized; what that leaves is for collapses. Chosen: half
/// the step takes four times as long, and collapses undo the most of it.
const SHARE: f64 = 0.75;

/// The surface of a field with meshes: the fine triangles of a lattice, or the mesh itself, with as few of them as the
/// budget allows.
fn simplified_field(
    field: &Field,
    (budget, request): (&Budget, &MeshRequest),
    job: &Job,
) -> Result<MadeMesh, Failure<Mesh>> {
    let length = budget.length_in(&field.bounds()).unwrap_or(0.0);
    let fine = match Tolerance::new(SHARE * length) {
        Ok(share) => Budget { length: Some(share), pixels: None, triangles: None, ..*budget },
        // Only a number of triangles: more of them are made first, and the best are kept.
        Err(_) if length == f64::INFINITY => {
            Budget { triangles: budget.triangles.map(|most| most.saturating_mul(FINER)), ..*budget }
        }
        Err(_) => *budget,
    };
    let made = convert::field_to_mesh(field, &fine, job).or_else(Failure::best_effort)?;
    simplified(made, (budget, length, request.effort), job)
}

/// How many times as many triangles a lattice gets as are asked for. Chosen: then collapses have a choice.
const FINER: u64 = 16;

/// The bodies of a shape, each as a part with its own bound, which a note says; the bound is the largest.
fn mesh_bodies(
    implicit: &ImplicitShape,
    request: &MeshRequest,
    (materials, notes): (&mut Vec<SurfaceMaterial>, &mut Vec<Message>),
    job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    let (mut all, mut worst): (Scene, Option<Bound>) = (Scene::default(), None);
    all.frame = implicit.frame;
    for body in &implicit.bodies {
        let mut own_notes = Vec::new();
        let (mut scene, bound) =
            mesh_parts(&implicit.of_body(body), request, (materials, &mut own_notes), job)?;
        // What is said of one is said of all.
        own_notes.retain(|note| !notes.contains(note));
        notes.extend(own_notes);
        let n_triangles: usize = scene.parts.iter().map(|part| part.mesh.faces().len()).sum();
        let within = match bound.at_most() {
            Some(most) => format!("at most {most:.3e} ({})", bound.evidence().as_str()),
            None => bound.to_string(),
        };
        notes.push(format!("'{}': {n_triangles} triangles, bound {within}", body.name).into());
        for mut part in scene.parts.drain(..) {
            part.name.clone_from(&body.name);
            let node = Node { name: body.name.clone(), part: Some(all.parts.len()), ..Node::default() };
            all.roots.push(all.nodes.len());
            all.nodes.push(node);
            all.parts.push(part);
        }
        worst = Some(match worst {
            None => bound,
            Some(before) => wider(before, bound),
        });
    }
    let empty = || MeshFailure::refused(RefusalCode::Empty, "there is no shape");
    Ok((all, worst.ok_or_else(empty)?))
}

/// The bound that holds for two parts: the ends of the one whose upper end is larger, with the weaker evidence.
pub(crate) fn wider(a: Bound, b: Bound) -> Bound {
    let upper = |bound: &Bound| bound.at_most().unwrap_or(f64::INFINITY);
    let at_least = greater(a.at_least(), b.at_least());
    let at_most = a.at_most().zip(b.at_most()).map(|(a, b)| greater(a, b));
    let evidence = a.evidence().weaker(b.evidence());
    let angle_deg = a.angle_deg.zip(b.angle_deg).map(|(a, b)| greater(a, b));
    let (larger, other) = if upper(&b) > upper(&a) { (b, a) } else { (a, b) };
    let metric =
        if matches!(other.metric, Metric::OneSided | Metric::Solid) { other.metric } else { larger.metric };
    let pixels = larger.pixels.zip(other.pixels).map(|(a, b)| greater(a, b));
    let mut all = Bound::with_evidence(at_least, at_most, evidence, larger.reference);
    (all.metric, all.angle_deg, all.pixels) = (metric, angle_deg, pixels);
    all.open = match (larger.open, other.open) {
        (Some(a), Some(b)) => Some(Box::new(a.beside(&b))),
        (a, b) => a.or(b),
    };
    all
}

/// Coordinates up to this have finite squares and sums of squares: derived, 2^1024 is the largest double.
const LARGEST: f64 = 1e150;

/// The message for a field that cannot be meshed because it is unbounded.
pub(crate) fn endless() -> Message {
    Message::from("the shape has no end in some direction: cut it off at a box (")
        .value(Setting::Region, "-1,-1,-1 1,1,1")
        .words(")")
}

/// Whether it is a figure of the plane, which has ends there and none along z.
fn is_flat(field: &Field) -> bool {
    let Box3 { min, max } = field.bounds();
    let ends = [min[0], min[1], max[0], max[1]];
    ends.iter().all(|x| x.is_finite()) && !field.tape().axes()[2]
}

/// The same for a figure of the plane.
fn flat() -> Message {
    Message::from("the shape is flat, a figure of the plane without a height: extrude(shape, height) makes a solid of it, or ")
        .value(Setting::Region, "-1,-1,-1 1,1,1")
        .words(" cuts it off")
}

/// The field clipped to its region.
///
/// # Errors
/// When it is unbounded in some direction, or reaches so far that numbers overflow.
pub(crate) fn finite(implicit: &ImplicitShape) -> Result<Field, MeshFailure> {
    let field = implicit.solid();
    let bounds = field.bounds();
    if let Some(far) = bounds.min.iter().chain(&bounds.max).find(|x| x.is_finite() && x.abs() > LARGEST) {
        let message = format!(
            "the shape reaches to {far:e}, and squares of coordinates beyond {LARGEST:e} are no numbers any more: scale it down"
        );
        return Err(MeshFailure::refused(RefusalCode::NotFinite, message));
    }
    if bounds.is_empty() {
        return Err(MeshFailure::refused(
            RefusalCode::Empty,
            "there is no surface: nothing of the shape is within its box",
        ));
    }
    if !bounds.diagonal().is_finite() {
        let why = if is_flat(&field) { flat() } else { endless() };
        return Err(MeshFailure::refused(RefusalCode::Unsupported, why));
    }
    Ok(field)
}

/// The distance between triangles and the isosurface of a field.
pub(crate) fn deviation_of(
    mesh: &Mesh,
    implicit: &ImplicitShape,
    goal: &Goal,
    job: &Job,
) -> Result<FieldDeviation, MeshFailure> {
    let field = finite(implicit)?;
    if convert::has_meshes(&field) {
        let message = "a field with meshes is not measured against triangles in this version: mesh it first";
        return Err(MeshFailure::refused(RefusalCode::Unsupported, message));
    }
    Ok(check::field_deviation(mesh, &field, goal, job)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_that_cross_are_told() {
        let points = vec![
            [0.0, 0.0, 0.0],
            [4.0, 0.0, 0.0],
            [0.0, 4.0, 0.0],
            [1.0, 1.0, -1.0],
            [1.0, 1.0, 1.0],
            [9.0, 9.0, 0.0],
        ];
        let of = |faces| crossing_note(&Mesh::new(points.clone(), faces).unwrap(), &Job::default());
        assert_eq!(of(vec![[0, 1, 2]]).map(|note| note.to_string()), None);
        let said = of(vec![[0, 1, 2], [3, 4, 5]]).unwrap().to_string();
        assert!(said.starts_with("triangles cross or touch each other in 1 pair: "), "{said}");
    }
}
