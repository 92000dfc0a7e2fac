//! The last step of the verbs: checks a result in the form in which its format holds it, and completes the report.
use super::file_rows::{to_file_rows, unsupported};
use super::format_rounding::{single_precision_note, storage_within};
use super::notes::packing_note;
use crate::mesh::request::MeshRequest;
use crate::provenance::geometry_digest::{polylines_digest, written_digest};
use crate::report::{BoundFacts, BudgetFacts, Certificate, CountedTriangles, Output, PolylineFacts};
use crate::scene::placements::part_scales;
use crate::scene::shown_parts::max_bound;
use crate::{MeshFailure, MeshOutcome, Tessellation};
use chordal::budget::{Bound, Evidence, PixelBudget, Reference, RequiredEvidence, Tolerance};
use chordal::explicit::Topology;
use chordal::math::lesser;
use chordal::{Job, mend};
use chordal_io::{Polylines, Scene, Warning, losses};

pub(crate) const NOT_MET: &str = "the budget was not met: this is the best that was reached";

/// Checks triangles in the form in which the format holds them, as the last step of a verb.
///
/// # Errors
/// If the budget is not met, with the outcome nevertheless; if the format cannot hold the triangles.
pub(crate) fn finish_triangles(
    mut scene: Scene,
    mut bound: Bound,
    request: &MeshRequest,
    mut certificate: Certificate,
) -> Result<MeshOutcome, MeshFailure> {
    let to = request.to;
    scene.packing = request.packing;
    certificate.notes.extend(packing_note(scene.stored, request.form()));
    if request.form().is_quantized() {
        round_attributes(&mut scene, request)?;
        certificate.notes.extend(single_precision_note(&scene.parts));
    }
    certificate.notes.extend(losses(&scene, to)?.iter().map(Warning::counted));
    // From here on rows are those of the file: what is counted, dropped and digested below is what a reader finds.
    let mut scene = to_file_rows(scene, to)?;
    // Before the bound is final, since it grows if no other triangle has the edge that such a face covered.
    if to.forbids_collapsed_faces() {
        let moved = drop_collapsed_faces(&mut scene)?;
        if moved.at_most() != Some(0.0) {
            // A triangle without area has no normal, so that the bound on angles still holds.
            let angle_deg = bound.angle_deg;
            bound = bound.then(&moved);
            bound.angle_deg = angle_deg;
        }
    }
    bound.pixels = pixels_of(request, &bound);
    certificate.bound = Some(BoundFacts::new(&bound));
    let counted = CountedTriangles::from_scene(&scene, to)?;
    let triangles = counted.output.triangles;
    certificate.output = Some(Output::Triangles(counted.output));
    certificate.valid = Some(counted.valid);
    certificate.conclude(("triangles", to), written_digest(&scene, to));
    let budget = &request.budget;
    let met = lengths_are_met(request, &bound)
        && bound.angle_deg.zip(budget.angle_deg).is_none_or(|(angle, limit)| angle <= limit)
        && budget.triangles.is_none_or(|most| triangles <= most);
    if !met {
        certificate.notes.push(NOT_MET.into());
    }
    let outcome = MeshOutcome { made: Tessellation::Triangles(scene), format: to, bound, certificate };
    if met { Ok(outcome) } else { Err(MeshFailure::Unmet(Box::new(outcome))) }
}

/// Rounds the attributes of all parts, new normals included, to the precision of their storage.
fn round_attributes(scene: &mut Scene, request: &MeshRequest) -> Result<(), MeshFailure> {
    for part in &mut scene.parts {
        let lattice = request.lattice.filter(|_| !part.is_deformed());
        let storage =
            part.storage.get_or_insert_with(|| Box::new(storage_within(lattice, &request.budget.attributes)));
        part.mesh = storage.round_attributes(&part.mesh).map_err(unsupported)?;
    }
    Ok(())
}

/// Checks polylines, as the last step of a verb.
pub(crate) fn finish_polylines(
    polylines: Polylines,
    mut bound: Bound,
    request: &MeshRequest,
    mut certificate: Certificate,
) -> Result<MeshOutcome, MeshFailure> {
    bound.pixels = pixels_of(request, &bound);
    certificate.budget = Some(BudgetFacts::new(&request.budget));
    certificate.bound = Some(BoundFacts::new(&bound));
    let facts = PolylineFacts::from_polylines(&polylines);
    certificate.output = Some(Output::Polylines(facts));
    let met =
        lengths_are_met(request, &bound) && request.budget.segments.is_none_or(|most| facts.segments <= most);
    let kind = if matches!(polylines, Polylines::Plane(_)) { "drawing" } else { "curves" };
    certificate.conclude((kind, request.to), Some(polylines_digest(&polylines)));
    if !met {
        certificate.notes.push(NOT_MET.into());
    }
    let outcome =
        MeshOutcome { made: Tessellation::Polylines(polylines), format: request.to, bound, certificate };
    if met { Ok(outcome) } else { Err(MeshFailure::Unmet(Box::new(outcome))) }
}

/// The bound on the screen: the smaller of the conversion's own bound and the projection of the length in space.
fn pixels_of(request: &MeshRequest, bound: &Bound) -> Option<f64> {
    let view = request.budget.pixels?.view;
    let of_length = bound.at_most().and_then(|most| view.pixels_of(most, &request.bounds));
    match (bound.pixels, of_length) {
        (Some(a), Some(b)) => Some(lesser(a, b)),
        (a, b) => a.or(b),
    }
}

/// Whether a bound is within the length and the pixels of the budget. If a measurement suffices and there is no proof, the
/// measured error is compared.
fn lengths_are_met(request: &MeshRequest, bound: &Bound) -> bool {
    let MeshRequest { budget, bounds, .. } = request;
    let is_measured = matches!(bound.evidence(), Evidence::Measured { .. });
    // A draft has no bound that could be compared.
    if budget.require == RequiredEvidence::Estimated && *bound.evidence() == Evidence::Estimated {
        return true;
    }
    let measured = budget.require != RequiredEvidence::Proved && is_measured;
    let length = if measured { Some(bound.at_least()) } else { bound.at_most() };
    let pixels = match budget.pixels {
        Some(PixelBudget { view, .. }) if measured => view.pixels_of(bound.at_least(), bounds),
        _ => bound.pixels,
    };
    let within = |most: Option<f64>, limit: Option<f64>| {
        limit.is_none_or(|limit| most.is_some_and(|most| most <= limit))
    };
    within(length, budget.length.map(Tolerance::get))
        && within(pixels, budget.pixels.map(|px| px.pixels.get()))
}

/// Drops such triangles from a scene whose rows are those of its file. Returns a bound for how far the surface moved: 0 if
/// other triangles have the edges that they covered.
pub(crate) fn drop_collapsed_faces(scene: &mut Scene) -> Result<Bound, MeshFailure> {
    let stretch = part_scales(scene);
    let mut bound = Bound::exact(Reference::InputTriangles);
    for (part, stretch) in scene.parts.iter_mut().zip(stretch) {
        // By indices: what the format forbids is a triangle with the same corner twice.
        let mended = mend::drop_collapsed(&part.mesh, Topology::Indices, &Job::default())?;
        if !mended.is_unchanged() {
            bound = max_bound(bound, &mended.bound, stretch)?;
            part.mesh = mended.mesh;
        }
    }
    Ok(bound)
}
