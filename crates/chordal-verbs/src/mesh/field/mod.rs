//! Fields: meshed within a budget, and measured against triangles.
#[cfg(feature = "booleans")]
mod by_booleans;
#[cfg(feature = "booleans")]
mod by_solids;
#[cfg(feature = "booleans")]
mod construction_by_booleans;
mod contact_lines;
mod looks;
pub(crate) mod slack;
use crate::mesh::isosurface::simplified::{MeshWithNote, simplified, simplified_without_crossings};
use crate::mesh::request::MeshRequest;
use crate::output::file_rows::unsupported;
use crate::report::OpenPlacesFacts;
use crate::{ImplicitShape, MeshFailure, ShapeLine};
#[cfg(feature = "booleans")]
use by_booleans::{cut_note, mesh_by_booleans};
#[cfg(feature = "booleans")]
use by_solids::{draft_by_solids, mesh_by_solids};
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
use contact_lines::name_lines;
use looks::{renumber, with_materials};
use slack::SlackRequest;

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

/// A field with meshes, by booleans, with its materials. `None` if it has to be meshed as a whole.
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
    let Some(mesh) = mesh_by_booleans(field, request, job)? else { return Ok(None) };
    notes.push(cut_note().into());
    let painted = convert::with_face_materials(mesh, field, job);
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

/// As [`mesh_field`], but adds the materials to a list instead of to the scene.
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
    let slack = SlackRequest::new(&field, request)?;
    let Bounded { shape: mesh, bound } = match cut_along_meshes(&field, &slack.inner, notes, job)? {
        Some(mesh) => mesh,
        None => mesh_of_field((&field, &implicit.lines), &slack.inner, notes, job)?,
    };
    let (bound, note) = slack.count(bound);
    notes.extend(note);
    if let Some(region) = implicit.region {
        let [low, high] = [region.min, region.max];
        notes.push(
            format!("the shape is cut off at the box from {low:?} to {high:?}, and closed there").into(),
        );
    }
    // Formats with normals get them; other formats keep one row a vertex.
    let shaded = request.to.wants_normals();
    let mesh = if shaded { convert::with_gradient_normals(&mesh, &field, job)? } else { mesh };
    let mesh = renumber(mesh, &field, materials).map_err(unsupported)?;
    Ok((Scene::from_mesh("field", mesh, implicit.frame), bound))
}

/// Without booleans every field is meshed as a whole.
#[cfg(not(feature = "booleans"))]
fn mesh_by_solids(_: &Field, _: &MeshRequest, _: &Job) -> Result<Option<MeshWithNote>, MeshFailure> {
    Ok(None)
}

/// Without booleans every draft is a mesh of cubes.
#[cfg(not(feature = "booleans"))]
fn draft_by_solids(_: &Field, _: &MeshRequest, _: &Job) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
    Ok(None)
}

/// A quick mesh of a field, in its colours: the triangles of the solids that it combines, or cubes.
fn draft(
    field: &Field,
    request: &MeshRequest,
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<Bounded<Mesh>, MeshFailure> {
    let mesh = match draft_by_solids(field, request, job)? {
        Some(mesh) => mesh,
        None => {
            let (mesh, note) = mesh_whole(field, request, job)?;
            notes.extend(note);
            if *mesh.bound.evidence() == Evidence::Estimated {
                notes.push(DRAFT.into());
            }
            mesh
        }
    };
    if field.materials().is_empty() {
        return Ok(mesh);
    }
    convert::with_face_materials(mesh, field, job).map_err(|failure| MeshFailure::from_missed(failure, ""))
}

/// A note on a mesh that is only measured although a proof was tried; `None` for other meshes.
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
            .words(" continues the proof to its end"),
    )
}

/// The surface of a field: meshed by the solids that it combines; or by the field itself, if it has other parts or the mesh
/// by solids is not proved. `lines` of the script are named in messages.
fn mesh_of_field(
    (field, lines): (&Field, &[ShapeLine]),
    request: &MeshRequest,
    notes: &mut Vec<Message>,
    job: &Job,
) -> Result<Bounded<Mesh>, MeshFailure> {
    if request.budget.require == RequiredEvidence::Estimated {
        return draft(field, request, notes, job);
    }
    let is_proved = |mesh: &MeshWithNote| mesh.0.bound.at_most().is_some();
    let is_enough =
        |mesh: &MeshWithNote| is_proved(mesh) || request.budget.require == RequiredEvidence::Measured;
    let limits = AttemptLimits::new(request, job);
    let (mut mesh, note) = match mesh_by_solids(field, request, &limits.by_solids())? {
        Some(mesh) if is_enough(&mesh) || !limits.tries_field(field) || job.is_finishing() => mesh,
        None => mesh_whole(field, request, job)?,
        // The proof by the field may succeed at places where the proof by its solids does not.
        // Whatever else this attempt ends in, a refusal included, the mesh by solids is complete and stays the
        // result.
        Some(mesh) => match mesh_whole(field, request, &limits.by_field()) {
            Err(MeshFailure::Cancelled) => return Err(MeshFailure::Cancelled),
            Ok(mesh_of_field) if is_proved(&mesh_of_field) => mesh_of_field,
            _ => mesh,
        },
    };
    notes.extend(note);
    name_lines(&mut mesh.bound, lines);
    if field.evidence().bounds_above() && request.budget.require == RequiredEvidence::ProvedOrMeasured {
        notes.extend(unproved_note(&mesh.bound));
    }
    notes.extend(shape_notes(&mesh.shape, request, job));
    Ok(mesh)
}

/// The evaluations for the proof by solids, and again for the proof by the field after it failed, if a proof is preferred
/// but not required. Measured: of the tests' 179 parts the second attempt proves 14 within this limit, in up to six
/// seconds; without a limit, parts that it never proves took up to half a minute, and a lattice of 500 struts minutes.
const WORK: u64 = 1 << 24;
/// The most bytes for the cells of the second attempt. Measured: parts that it proves take up to half of it; cells of other
/// parts were halved for another minute.
const CELLS: u64 = 1 << 27;
/// Combinations of more solids get no second attempt. Measured: the ones that it proves have up to 24 solids; for a lattice
/// of 216 rods, which takes three seconds by solids, it worked for 50 seconds more in vain.
const MOST_SOLIDS: u64 = 64;
/// The share of the memory that these proofs may take. Measured: under a limit of 256 MB, 275 MB were in use when they
/// could take all of it, of which 100 MB were left behind by cuts of a thousand solids.
const SHARE_OF_MEMORY: f64 = 0.5;

/// The limits of the two attempts at a combination of solids: by the triangles of the solids, and then by its field.
struct AttemptLimits {
    job: Job,
    is_unlimited: bool,
}

impl AttemptLimits {
    fn new(request: &MeshRequest, job: &Job) -> Self {
        let mut job = job.clone();
        job.memory_limit = (SHARE_OF_MEMORY * job.memory_limit as f64) as u64;
        let is_unlimited =
            request.budget.require == RequiredEvidence::Proved || job.proof_effort == ProofEffort::Full;
        Self { job, is_unlimited }
    }

    fn by_solids(&self) -> Job {
        if self.is_unlimited { self.job.clone() } else { self.job.with_work_limit(WORK) }
    }

    /// Whether the attempt by the field is worth its time.
    fn tries_field(&self, field: &Field) -> bool {
        self.is_unlimited
            || field.construction().is_none_or(|construction| construction.n_solids() <= MOST_SOLIDS)
    }

    fn by_field(&self) -> Job {
        let mut job = self.by_solids();
        if !self.is_unlimited {
            job.memory_limit = job.memory_limit.min(CELLS);
        }
        job
    }
}

/// The surface of a field by itself, with a note on it.
fn mesh_whole(field: &Field, request: &MeshRequest, job: &Job) -> Result<MeshWithNote, MeshFailure> {
    let mut note = None;
    let mesh = request.run(job, |budget| {
        let build = if convert::has_meshes(field) { simplified_field } else { mesh_in_detail };
        let (mesh, mesh_note) = build(field, (budget, request), job)?;
        note = mesh_note;
        Ok(mesh)
    })?;
    Ok((mesh, note))
}

/// The note on a draft of cubes, whose vertices move one by one. Counting the crossings would take as long as the draft.
pub(crate) const DRAFT: &str = "a draft: its triangles may cross each other, and `inspect` counts where";

/// Notes on the triangles of a shape as they are written: edges that rounding ties together, and triangles that cross.
fn shape_notes(mesh: &Mesh, request: &MeshRequest, job: &Job) -> Vec<Message> {
    let mut notes = Vec::new();
    // By positions and not by indices: rounding may have brought separate vertices to one place.
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

/// A note on triangles that cross: their bound holds all the same, but programs that fill solids, as slicers do, may trip
/// over them.
fn crossing_note(mesh: &Mesh, job: &Job) -> Option<Message> {
    let n_pairs = check::self_intersections(mesh, job).map_or(0, |crossings| crossings.count);
    let pairs = if n_pairs == 1 { "pair" } else { "pairs" };
    let message =
        Message::from(format!("triangles cross or touch each other in {n_pairs} {pairs}: `inspect` with "))
            .setting(Setting::SelfIntersections)
            .words(" shows where, and a shorter length may end that");
    (n_pairs > 0).then_some(message)
}

/// The coarsest length, relative to the diagonal of the bounds, for which a field is meshed; the rest of a longer length is
/// left to collapses. Chosen: about where details of ordinary parts begin to be as large as the length, so that cells miss
/// them, proofs fail, and triangles become more instead of fewer.
const COARSEST: f64 = 0.01;

/// The surface of a field without meshes. If the length is longer than a hundredth of the size, the shape is meshed within
/// that, and collapses of triangles get the rest; for a shape in several materials, collapses along the borders of these
/// get the rest of any length.
fn mesh_in_detail(
    field: &Field,
    (budget, request): (&Budget, &MeshRequest),
    job: &Job,
) -> Result<MeshWithNote, Failure<Mesh>> {
    let direct = || convert::field_to_mesh(field, budget, job);
    let coarsest = Tolerance::new(COARSEST * field.bounds().diagonal());
    let (Some(length), Ok(coarsest)) = (budget.length.map(Tolerance::get), coarsest) else {
        return direct().map(|mesh| (mesh, None));
    };
    // If the error is only measured, there is no bound to which collapses could add theirs.
    let is_proof_tried =
        matches!(budget.require, RequiredEvidence::Proved | RequiredEvidence::ProvedOrMeasured)
            && field.evidence().bounds_above();
    // Collapses get what is left as a length alone: a limit in pixels would be lost on the way.
    if !is_proof_tried || budget.pixels.is_some() || budget.triangles.is_some() {
        return direct().map(|mesh| (mesh, None));
    }
    let fine = if length > coarsest.get() {
        match convert::field_to_mesh(field, &Budget { length: Some(coarsest), ..*budget }, job) {
            Ok(fine) => fine,
            Err(Failure::Cancelled) => return Err(Failure::Cancelled),
            // The shorter length may be missed although the longer one can be met.
            Err(_) => return direct().map(|mesh| (mesh, None)),
        }
    } else if field.materials().is_empty() {
        return direct().map(|mesh| (mesh, None));
    } else {
        direct()?
    };
    if fine.bound.at_most().is_none() {
        return Ok((fine, None));
    }
    simplified_without_crossings(fine, (budget, length, request.effort), job)
}

/// The share of a length within which signs on a lattice are polygonized; collapses get the rest. Chosen: half the step
/// takes four times as long, and collapses undo most of the gain.
const SHARE: f64 = 0.75;

/// The surface of a field with meshes: the fine triangles of a lattice, or the mesh itself, with as few of them as the
/// budget allows.
fn simplified_field(
    field: &Field,
    (budget, request): (&Budget, &MeshRequest),
    job: &Job,
) -> Result<MeshWithNote, Failure<Mesh>> {
    let length = budget.length_in(&field.bounds()).unwrap_or(0.0);
    let fine = match Tolerance::new(SHARE * length) {
        Ok(share) => Budget { length: Some(share), pixels: None, triangles: None, ..*budget },
        // Only a number of triangles: more of them are built first, and collapses keep the best.
        Err(_) if length == f64::INFINITY => {
            Budget { triangles: budget.triangles.map(|most| most.saturating_mul(FINER)), ..*budget }
        }
        Err(_) => *budget,
    };
    // A lattice that misses its share is of use all the same: collapses get what its own bound leaves, not what the
    // share does.
    let mesh = convert::field_to_mesh(field, &fine, job).or_else(Failure::best_effort)?;
    simplified(mesh, (budget, length, request.effort), job)
}

/// How many times as many triangles a lattice gets as the budget allows. Chosen: so that collapses have a choice.
const FINER: u64 = 16;

/// The bodies of a shape, each as a part with a bound of its own in a note; the returned bound is the largest.
fn mesh_bodies(
    implicit: &ImplicitShape,
    request: &MeshRequest,
    (materials, notes): (&mut Vec<SurfaceMaterial>, &mut Vec<Message>),
    job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    let (mut merged, mut worst): (Scene, Option<Bound>) = (Scene::default(), None);
    merged.frame = implicit.frame;
    for body in &implicit.bodies {
        let mut body_notes = Vec::new();
        let (mut scene, bound) =
            mesh_parts(&implicit.of_body(body), request, (materials, &mut body_notes), job)?;
        // A note that several bodies share is given once.
        body_notes.retain(|note| !notes.contains(note));
        notes.extend(body_notes);
        let n_triangles: usize = scene.parts.iter().map(|part| part.mesh.faces().len()).sum();
        let bound_text = match bound.at_most() {
            Some(most) => format!("at most {most:.3e} ({})", bound.evidence().as_str()),
            None => bound.to_string(),
        };
        notes.push(format!("'{}': {n_triangles} triangles, bound {bound_text}", body.name).into());
        for mut part in scene.parts.drain(..) {
            part.name.clone_from(&body.name);
            let node = Node { name: body.name.clone(), part: Some(merged.parts.len()), ..Node::default() };
            merged.roots.push(merged.nodes.len());
            merged.nodes.push(node);
            merged.parts.push(part);
        }
        worst = Some(match worst {
            None => bound,
            Some(before) => wider(before, bound),
        });
    }
    let empty = || MeshFailure::refused(RefusalCode::Empty, "there is no shape");
    Ok((merged, worst.ok_or_else(empty)?))
}

/// The bound that holds for two parts: the ends of the bound with the larger upper end, with the weaker evidence.
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
    let mut merged = Bound::with_evidence(at_least, at_most, evidence, larger.reference);
    (merged.metric, merged.angle_deg, merged.pixels) = (metric, angle_deg, pixels);
    merged.open = match (larger.open, other.open) {
        (Some(a), Some(b)) => Some(Box::new(a.beside(&b))),
        (a, b) => a.or(b),
    };
    merged
}

/// Coordinates up to this have finite squares and sums of squares. Derived: 2^1024 is the largest double.
const LARGEST: f64 = 1e150;

/// The message for a field that cannot be meshed because it is unbounded.
pub(crate) fn endless() -> Message {
    Message::from("the shape has no end in some direction: cut it off at a box (")
        .value(Setting::Region, "-1,-1,-1 1,1,1")
        .words(")")
}

/// Whether the field is a figure of the plane: bounded there, and independent of z.
fn is_flat(field: &Field) -> bool {
    let Box3 { min, max } = field.bounds();
    let ends = [min[0], min[1], max[0], max[1]];
    ends.iter().all(|x| x.is_finite()) && !field.tape().axes()[2]
}

/// The message for a figure of the plane, which cannot be meshed without a height.
fn flat() -> Message {
    Message::from("the shape is flat, a figure of the plane without a height: extrude(shape, height) makes a solid of it, or ")
        .value(Setting::Region, "-1,-1,-1 1,1,1")
        .words(" cuts it off")
}

/// The field clipped to its region.
///
/// # Errors
/// If it is unbounded in some direction, or reaches so far that numbers overflow.
pub(crate) fn finite(implicit: &ImplicitShape) -> Result<Field, MeshFailure> {
    let field = implicit.solid();
    let bounds = field.bounds();
    // Infinite ends are no fault here: they are refused below, with the advice to cut the shape off.
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
        let note_of = |faces| crossing_note(&Mesh::new(points.clone(), faces).unwrap(), &Job::default());
        assert_eq!(note_of(vec![[0, 1, 2]]).map(|note| note.to_string()), None);
        let note = note_of(vec![[0, 1, 2], [3, 4, 5]]).unwrap().to_string();
        assert!(note.starts_with("triangles cross or touch each other in 1 pair: "), "{note}");
    }
}
