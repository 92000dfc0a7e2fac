//! `mesh_by_solids`: a field that is a combination of solids, by their triangles.
use super::construction_by_booleans::{AssembledMesh, mesh_by_construction};
use crate::MeshFailure;
use crate::mesh::isosurface::simplified::{MeshWithNote, simplified_without_crossings};
use crate::mesh::request::MeshRequest;
use crate::simplify::simplify_mesh;
use chordal::boolean::boolean_unchecked;
use chordal::budget::{Bound, Budget, Evidence, Failure, Reference, Tolerance};
use chordal::explicit::Topology;
use chordal::implicit::Field;
use chordal::implicit::construction::{Construction, ConstructionNode, SolidForm};
use chordal::{Bounded, Job, Mesh, convert};

/// The shares of a length within which solids are meshed, one after the other until the result is proved. Chosen: the rest
/// of the length is for proofs at edges whose faces meet at an angle.
const SHARES: [f64; 2] = [0.7, 0.35];
/// Combinations of more solids are first meshed within a multiple of the length. Chosen: cuts of so many solids take some
/// tenths of a second, and with few triangles each only a small part of that.
const MANY: u64 = 64;
const COARSE: f64 = 16.0;

/// The triangles of a combination of solids, cut along each other and proved as a whole, as few as the budget allows, with a
/// note. `None` if a part has no triangles of its own, if cuts fail or leave nothing, or if the surface is measured to be
/// too far.
///
/// Solids that are not cut need no proof as a whole: their own bounds hold.
pub(crate) fn mesh_by_solids(
    field: &Field,
    request: &MeshRequest,
    job: &Job,
) -> Result<Option<MeshWithNote>, MeshFailure> {
    let is_known = |construction: &&Construction| !construction.has_other() && !has_twist(construction);
    let Some(construction) = field.construction().filter(is_known) else { return Ok(None) };
    let budget = &request.budget;
    let is_by_length = budget.pixels.is_none() && budget.triangles.is_none();
    // Cuts do not keep the labels that identify materials.
    if !is_by_length || !field.materials().is_empty() {
        return Ok(None);
    }
    // Vertices may be outside of round solids by the length.
    let Some(requested) = budget.length else { return Ok(None) };
    // Rounding is reserved for the larger box, since coordinates farther out are rounded by more.
    let request = request.with_reach(requested.get());
    let Ok(inner) = request.reserve_rounding(request.rounding()) else { return Ok(None) };
    let Some(length) = inner.length else { return Ok(None) };
    let room = field.bounds();
    let assembled = |share: f64| {
        let tolerance = Tolerance::new(share * length.get()).ok()?;
        mesh_by_construction(construction, &room, tolerance, job)
            .filter(|built| !built.mesh.faces().is_empty())
    };
    // A long job may be stopped: then there is at least a coarse result.
    let coarse = if construction.n_solids() > MANY { assembled(COARSE) } else { None };
    let judged = match assembled(SHARES[0]).or_else(|| coarse.filter(|_| job.is_finishing())) {
        None => return Ok(None),
        Some(AssembledMesh { mesh, off: Some(off) }) => {
            let with_bound =
                |mesh, off| Ok(Bounded { shape: mesh, bound: Bound::proved(0.0, off, Reference::Field) });
            // Without cuts, the solids may use the whole length.
            match assembled(1.0) {
                Some(AssembledMesh { mesh, off: Some(off) }) => with_bound(mesh, off),
                // Within more, the boxes may be too near to each other for solids to stay uncut; the finer mesh
                // holds.
                _ => with_bound(mesh, off),
            }
        }
        Some(first) => {
            let others = SHARES[1..].iter().map_while(|share| assembled(*share));
            // All of these are lazy: solids are meshed within the smaller share only if the judge refuses the mesh
            // before.
            let candidates = std::iter::once(first).chain(others);
            let mut meshes = candidates.map(|built| tidied(built.mesh, length, &request, job));
            convert::solids::judged_against_field(&mut meshes, field, (length, budget.require), job)
        }
    };
    let judged = match judged {
        Ok(judged) => judged,
        Err(Failure::Cancelled) => return Err(MeshFailure::Cancelled),
        // In the remaining time, nothing else would come nearer.
        Err(Failure::Unmet(best)) if job.is_finishing() => *best,
        Err(Failure::Unmet(_) | Failure::Refused(_)) => return Ok(None),
    };
    let (mesh, note) = with_fewer_triangles(judged, (&inner, length), &request, job)?;
    Ok(Some((request.snap(&mesh.shape, mesh.bound, job)?, note)))
}

/// A draft of a combination of solids: their triangles cut along each other, without a proof. `None` if a part has no
/// triangles of its own, or if cuts fail or leave nothing.
///
/// Its edges are sharp, and its triangles cross only by roundings.
pub(crate) fn draft_by_solids(
    field: &Field,
    request: &MeshRequest,
    job: &Job,
) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
    let Some(construction) = field.construction().filter(|construction| !construction.has_other()) else {
        return Ok(None);
    };
    if construction.n_solids() > MANY {
        return Ok(None);
    }
    let room = field.bounds();
    let Ok(length) = Tolerance::new(DRAFT_SHARE * room.diagonal()) else { return Ok(None) };
    let Some(AssembledMesh { mesh, .. }) = mesh_by_construction(construction, &room, length, job) else {
        return Ok(None);
    };
    let most = request.budget.triangles.unwrap_or(u64::MAX);
    if mesh.faces().is_empty() || mesh.faces().len() as u64 > most {
        return Ok(None);
    }
    // Estimated even if the solids have a bound: a draft that is called proved could not be told from the proof after
    // it.
    let bound = Bound::with_evidence(0.0, None, Evidence::Estimated, Reference::Field);
    Ok(Some(request.snap(&mesh, bound, job)?))
}

/// The length of a draft as a share of the diagonal. Chosen: about a pixel if the shape fills the picture.
const DRAFT_SHARE: f64 = 1.0 / 1024.0;

/// Whether a part is twisted. Its closed form has equal sections. Measured: for a round thread, three times the triangles of
/// meshing the field, and collapses do not reduce them without crossings.
fn has_twist(part: &Construction) -> bool {
    part.has(&|node| matches!(node, ConstructionNode::Solid(SolidForm::Twisted { .. })))
}

/// The share of a length within which cuts are tidied up. Cuts leave vertices on flat faces and triangles that are thinner
/// than any requested length, above all where rods end in common balls. Measured: with a tenth, a wire in a zigzag has a
/// third of the triangles and takes half of the time, compared with a 64th; over the tests' 179 parts, the sum of triangles
/// falls by a fourteenth, and no fewer parts are proved.
const TIDY_SHARE: f64 = 0.1;

/// Removes most of the thin triangles that cuts leave; this needs no bound, since the result is proved against the field.
fn tidied(mesh: Mesh, length: Tolerance, request: &MeshRequest, job: &Job) -> Mesh {
    let Ok(tolerance) = Tolerance::new(TIDY_SHARE * length.get()) else { return mesh };
    // Without an operand nothing is cut: the engine only merges triangles that are flat within the length.
    let mesh = boolean_unchecked(&mesh, &[], Some(tolerance), job).unwrap_or(mesh);
    match simplify_mesh(&mesh, (&Budget::length(tolerance), request.effort), Topology::Indices, job) {
        Ok(simplified) => simplified.shape.mesh,
        Err(_) => mesh,
    }
}

/// Collapses edges within the length that a bound leaves.
fn with_fewer_triangles(
    mesh: Bounded<Mesh>,
    (budget, length): (&Budget, Tolerance),
    request: &MeshRequest,
    job: &Job,
) -> Result<MeshWithNote, MeshFailure> {
    if mesh.bound.at_most().is_none() {
        return Ok((mesh, None));
    }
    match simplified_without_crossings(mesh.clone(), (budget, length.get(), request.effort), job) {
        Ok(fewer) => Ok(fewer),
        Err(Failure::Cancelled) => Err(MeshFailure::Cancelled),
        // Fewer triangles are a wish: a mesh that cannot be simplified keeps its own bound.
        Err(Failure::Unmet(_) | Failure::Refused(_)) => Ok((mesh, None)),
    }
}
