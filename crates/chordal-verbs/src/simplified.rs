//! Triangles into fewer triangles: what `mesh` does with a scene, part by part.
use crate::MeshFailure;
use crate::mesh::{refused, set_aside};
use crate::placed::{self, Assembled, Placed};
use crate::polylines::Asked;
use crate::report::{AttributeFacts, Certificate};
use crate::written::unsupported;
use chordal::budget::{Bound, Budget, Code, Failure, Reference, Stopped, Tolerance};
use chordal::check::attribute_deviation;
use chordal::explicit::{Attribute, Domain, Semantic, Topology};
use chordal::lod::{Kept, Simplified, simplify};
use chordal::math::{Box3, add_up, div_down};
use chordal::{Bounded, Job, Mesh};
use chordal_io::{Format, Part, Scene, snap, worst_snap};

/// The scene with fewer triangles within the budget, as it will be written, and the bound for all of it. What else is known
/// goes to the certificate.
pub(crate) fn simplified(
    scene: Scene,
    asked: &Asked,
    certificate: &mut Certificate,
    job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    let Certificate { notes, attributes, .. } = certificate;
    let Asked { budget, to, place, .. } = asked;
    let Placed { mut scene, moved_at_most: placed, left_out } =
        if *to == Format::Glb { Placed::as_it_is(scene) } else { placed::flattened(scene)? };
    if left_out > 0 {
        notes.push(format!("parts that stand nowhere in the scene were left out ({left_out}x)"));
    }
    if scene.parts.iter().all(|part| part.mesh.faces().is_empty()) {
        return Err(refused(Code::Empty, "there is no triangle to simplify"));
    }
    let stretch = placed::stretch_of_parts(&scene);
    // 1. What each part may lose, in its own coordinates: what is left when places and rounding took theirs.
    let length = length_for_all(budget, place)?;
    let lost = scene.parts.iter().zip(&stretch).fold(0.0, |most, (part, stretch)| {
        let lost = placed::scaled_up(worst_snap(&part.mesh.bounds(), *to), *stretch);
        if lost > most { lost } else { most }
    });
    let lost = if placed == 0.0 || lost == 0.0 { lost + placed } else { add_up(lost, placed) };
    let left = match length {
        Some(length) => set_aside(&Budget::length(length), lost, place, *to)?.length.map(Tolerance::get),
        None => None,
    };
    let counts = match budget.triangles {
        Some(most) if length.is_none() => Some(shares(&scene, most, job)?),
        _ => None,
    };
    // 2. Part by part.
    let before: usize = scene.parts.iter().map(|part| part.mesh.faces().len()).sum();
    let is_alone = placed::n_places(&scene) == 1;
    let mut all = Kept::default();
    let mut worst: Option<Bound> = None;
    for (k, (part, stretch)) in scene.parts.iter_mut().zip(&stretch).enumerate() {
        let count = counts.as_ref().map(|counts| counts[k]);
        let own = left.filter(|_| *stretch > 0.0).map(|length| div_down(length, *stretch));
        let Some(made) = one(part, (own, count), job)? else { continue };
        add(&mut all, made.shape.kept);
        let snapped = snap(&made.shape.mesh, *to).map_err(MeshFailure::TooWide)?;
        let step = Bound::proved(0.0, snapped.moved_at_most, Reference::InputTriangles);
        let bound = made.bound.then(&step);
        let before = std::mem::replace(&mut part.mesh, snapped.mesh);
        if part.mesh.faces().len() < before.faces().len() {
            notes.extend(measured(attributes, [&before, &part.mesh], &bound, job)?);
        }
        let most = placed::scaled_up(bound.at_most().unwrap_or(f64::INFINITY), *stretch);
        let most = if placed == 0.0 { most } else { add_up(most, placed) };
        if !most.is_finite() {
            let message = "the transforms of the scene take its coordinates out of range";
            return Err(refused(Code::NotFinite, message));
        }
        if worst.as_ref().is_none_or(|worst| worst.at_most() < Some(most)) {
            // What one part is off may be made up for by another, so that only one alone is known from below.
            let alone = is_alone && *stretch == 1.0 && placed == 0.0;
            let least = if alone { bound.at_least() } else { 0.0 };
            let mut of_all =
                Bound::proved(if least < most { least } else { most }, most, Reference::InputTriangles);
            of_all.at = bound.at.filter(|_| alone);
            worst = Some(of_all);
        }
    }
    let after: usize = scene.parts.iter().map(|part| part.mesh.faces().len()).sum();
    notes.push(format!("{before} triangles were simplified to {after}"));
    notes.extend(told(&all));
    Ok((scene, worst.unwrap_or_else(|| Bound::proved(0.0, 0.0, Reference::InputTriangles))))
}

/// The scene without the normals that it has, which will be computed anew: they are no reason to keep an edge.
pub(crate) fn without_normals(scene: &mut Scene) -> Result<(), MeshFailure> {
    for part in &mut scene.parts {
        let mesh = &part.mesh;
        let mut bare = Mesh::new(mesh.positions().to_vec(), mesh.faces().to_vec()).map_err(unsupported)?;
        if let Some(id) = mesh.position_id() {
            bare = bare.with_position_id(id.to_vec()).map_err(unsupported)?;
        }
        let stays = |a: &&Attribute| !matches!(a.semantic, Semantic::Normal | Semantic::Tangent);
        for attribute in mesh.attributes().iter().filter(stays) {
            bare = bare.with_attribute(attribute.clone()).map_err(unsupported)?;
        }
        part.mesh = bare;
    }
    Ok(())
}

/// Adds how far attributes went off on the way from one mesh to the other; a note where that is not known. Lines between
/// charts are within the bound of where they were.
fn measured(
    attributes: &mut Vec<AttributeFacts>,
    [before, after]: [&Mesh; 2],
    bound: &Bound,
    job: &Job,
) -> Result<Option<String>, MeshFailure> {
    let moved = bound.at_most().and_then(|most| Tolerance::new(most).ok());
    match attribute_deviation(before, after, moved, job) {
        Ok(found) => {
            found.iter().for_each(|found| AttributeFacts::add(attributes, found));
            Ok(None)
        }
        Err(Stopped::Cancelled) => Err(MeshFailure::Cancelled),
        Err(Stopped::Refused(refusal)) => {
            Ok(Some(format!("how far attributes went off was not measured: {}", refusal.message)))
        }
    }
}

/// The length that the budget allows everywhere.
fn length_for_all(budget: &Budget, place: &Box3) -> Result<Option<Tolerance>, MeshFailure> {
    let close =
        || refused(Code::TooClose, "the shape comes so close to the eye that there is no bound in pixels");
    let length = budget.length_in(place).ok_or_else(close)?;
    if length == f64::INFINITY {
        return Ok(None);
    }
    Tolerance::new(length).map(Some).map_err(|_| close())
}

/// One part with fewer triangles, or `None` where there is nothing to do.
fn one(
    part: &Part,
    (length, count): (Option<f64>, Option<u64>),
    job: &Job,
) -> Result<Option<Bounded<Simplified>>, MeshFailure> {
    let n_faces = part.mesh.faces().len() as u64;
    let length = length.filter(|length| *length > 0.0).and_then(|length| Tolerance::new(length).ok());
    let enough = count.is_none_or(|count| count >= n_faces);
    if n_faces == 0 || (length.is_none() && enough) {
        let bound = Bound::proved(0.0, 0.0, Reference::InputTriangles);
        let shape = Simplified { mesh: part.mesh.clone(), worst: None, kept: Kept::default() };
        return Ok((n_faces > 0).then_some(Bounded { shape, bound }));
    }
    let budget = Budget { length, triangles: count, ..Budget::default() };
    let topology = if part.indexed { Topology::Indices } else { Topology::Positions };
    match simplify(&part.mesh, &budget, topology, job) {
        Ok(made) => Ok(Some(made)),
        // Whether the whole is within the budget is judged for the whole.
        Err(Failure::Unmet(best)) => Ok(Some(*best)),
        Err(Failure::Refused(refusal)) => Err(MeshFailure::Refused(refusal)),
        Err(Failure::Cancelled) => Err(MeshFailure::Cancelled),
    }
}

/// How many triangles each part may have of `most` for all: as if all of them were one mesh, so that triangles stay where
/// they are worth most.
fn shares(scene: &Scene, most: u64, job: &Job) -> Result<Vec<u64>, MeshFailure> {
    let n_parts = scene.parts.len();
    if placed::n_places(scene) == 1 {
        return Ok(vec![most; n_parts]);
    }
    let Assembled { mesh, places } = Assembled::of(scene, Topology::Positions)?;
    let ends = places.iter().skip(1).map(|(_, first)| *first).chain([mesh.faces().len() as u32]);
    let mut of_face = Vec::with_capacity(mesh.faces().len());
    for (place, ((_, first), end)) in places.iter().zip(ends).enumerate() {
        of_face.extend((*first..end).map(|_| place as f64));
    }
    let place_of = Attribute {
        semantic: Semantic::Group(PLACE.to_owned()),
        domain: Domain::Face,
        width: 1,
        values: of_face,
    };
    let mesh = mesh.with_attribute(place_of.clone()).map_err(unsupported)?;
    let made = match simplify(&mesh, &Budget::triangles(most), Topology::Indices, job) {
        Ok(made) => made.shape.mesh,
        Err(Failure::Unmet(best)) => best.shape.mesh,
        Err(Failure::Refused(refusal)) => return Err(MeshFailure::Refused(refusal)),
        Err(Failure::Cancelled) => return Err(MeshFailure::Cancelled),
    };
    // A part that stands in several places has one number of triangles: the least that one of them got.
    let mut got = vec![0_u64; places.len()];
    if let Some(of_faces) = made.attribute(&place_of.semantic) {
        of_faces.values.iter().for_each(|place| got[*place as usize] += 1);
    }
    let mut counts = vec![u64::MAX; n_parts];
    for ((part, _), got) in places.iter().zip(got) {
        counts[*part] = counts[*part].min(got);
    }
    Ok(counts)
}

/// The name of the attribute that says of which place a triangle is.
const PLACE: &str = "place";

fn add(all: &mut Kept, one: Kept) {
    all.tied_vertices += one.tied_vertices;
    all.collapsed_faces += one.collapsed_faces;
    all.vanished_components += one.vanished_components;
}

/// What a reader should know of how it went.
fn told(kept: &Kept) -> Vec<String> {
    let mut notes = Vec::new();
    if kept.tied_vertices > 0 {
        notes.push(format!(
            "where the mesh is not a manifold or wound against itself it stays as it is: {} vertices; mend takes such \
             places apart",
            kept.tied_vertices
        ));
    }
    if kept.collapsed_faces > 0 {
        let n = kept.collapsed_faces;
        notes.push(format!("triangles with two corners at one position were left out ({n}x)"));
    }
    if kept.vanished_components > 0 {
        let n = kept.vanished_components;
        notes.push(format!("separate pieces that the budget covers were left out ({n}x)"));
    }
    notes
}
