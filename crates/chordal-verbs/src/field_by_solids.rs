//! `mesh_by_solids`: a field that is a combination of solids, by their triangles.
use crate::MeshFailure;
use crate::construction_by_booleans::{AssembledMesh, mesh_by_construction};
use crate::request::MeshRequest;
use crate::simplified_isosurface::{MadeMesh, simplified_without_crossings};
use crate::simplify::simplify_mesh;
use chordal::boolean::boolean_unchecked;
use chordal::budget::{Bound, Budget, Evidence, Failure, Reference, Tolerance};
use chordal::explicit::Topology;
use chordal::implicit::Field;
use chordal::implicit::construction::{Construction, ConstructionNode, SolidForm};
use chordal::{Bounded, Job, Mesh, convert};

/// The shares of a length within which solids are meshed, one after the other until the whole is proved. Chosen: what the
/// first leaves is for proofs of edges at which faces meet at some angle.
const SHARES: [f64; 2] = [0.7, 0.35];
/// Combinations of more solids are made within so many times the length first. Chosen: cuts of so many take some tenths of a
/// second, and of a few triangles each a small part of that.
const MANY: u64 = 64;
const COARSE: f64 = 16.0;

/// A combination of solids, whose triangles are cut along each other and judged as a whole, as few as the budget allows, with
/// what is to be said of them. None where some part has no triangles of its own, where cuts fail or leave nothing, and where
/// the surface is measured to be too far.
///
/// Solids that are cut by no others need no judge: their own bounds are known.
pub(crate) fn mesh_by_solids(
    field: &Field,
    request: &MeshRequest,
    job: &Job,
) -> Result<Option<MadeMesh>, MeshFailure> {
    let is_known = |own: &&Construction| !own.has_other() && !has_twist(own);
    let Some(construction) = field.construction().filter(is_known) else { return Ok(None) };
    let budget = &request.budget;
    let is_by_length = budget.pixels.is_none() && budget.triangles.is_none();
    // Materials are told apart by labels that cuts do not keep.
    if !is_by_length || !field.materials().is_empty() {
        return Ok(None);
    }
    // Vertices lie outside of round solids.
    let Some(asked) = budget.length else { return Ok(None) };
    let request = request.with_reach(asked.get());
    let Ok(inner) = request.reserve_rounding(request.rounding()) else { return Ok(None) };
    let Some(length) = inner.length else { return Ok(None) };
    let room = field.bounds();
    let made = |share: f64| {
        let own = Tolerance::new(share * length.get()).ok()?;
        mesh_by_construction(construction, &room, own, job).filter(|made| !made.mesh.faces().is_empty())
    };
    // What takes long may be stopped: then there is something, if coarse.
    let coarse = if construction.n_solids() > MANY { made(COARSE) } else { None };
    let judged = match made(SHARES[0]).or_else(|| coarse.filter(|_| job.is_finishing())) {
        None => return Ok(None),
        Some(AssembledMesh { mesh, off: Some(off) }) => {
            let own =
                |mesh, off| Ok(Bounded { shape: mesh, bound: Bound::proved(0.0, off, Reference::Field) });
            // Where nothing is cut the whole length is theirs.
            match made(1.0) {
                Some(AssembledMesh { mesh, off: Some(off) }) => own(mesh, off),
                _ => own(mesh, off),
            }
        }
        Some(first) => {
            let others = SHARES[1..].iter().map_while(|share| made(*share));
            let all = std::iter::once(first).chain(others);
            let mut meshes = all.map(|made| tidied(made.mesh, length, &request, job));
            convert::solids::judged_against_field(&mut meshes, field, (length, budget.require), job)
        }
    };
    let judged = match judged {
        Ok(judged) => judged,
        Err(Failure::Cancelled) => return Err(MeshFailure::Cancelled),
        // Nothing else would come nearer in the time that is left.
        Err(Failure::Unmet(best)) if job.is_finishing() => *best,
        Err(Failure::Unmet(_) | Failure::Refused(_)) => return Ok(None),
    };
    let (made, words) = with_fewer_triangles(judged, (&inner, length), &request, job)?;
    Ok(Some((request.snap(&made.shape, made.bound, job)?, words)))
}

/// A draft of a combination of solids: their triangles cut along each other, as nobody has judged them. None where some part
/// has no triangles of its own, and where cuts fail or leave nothing.
///
/// Its edges are sharp, and its triangles cross by roundings at most.
pub(crate) fn draft_by_solids(
    field: &Field,
    request: &MeshRequest,
    job: &Job,
) -> Result<Option<Bounded<Mesh>>, MeshFailure> {
    let Some(construction) = field.construction().filter(|own| !own.has_other()) else { return Ok(None) };
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
    let bound = Bound::with_evidence(0.0, None, Evidence::Estimated, Reference::Field);
    Ok(Some(request.snap(&mesh, bound, job)?))
}

/// The length of a draft as a share of the diagonal. Chosen: about a pixel where the shape fills the picture.
const DRAFT_SHARE: f64 = 1.0 / 1024.0;

/// Whether a part is twisted. Its closed form has even sections: measured, three times the triangles that the field's own way
/// leaves of a round thread, which collapses do not bring down without crossings.
fn has_twist(part: &Construction) -> bool {
    part.has(&|node| matches!(node, ConstructionNode::Solid(SolidForm::Twisted { .. })))
}

/// The share of a length within which cuts are tidied up. Cuts leave vertices on flat faces and triangles that are thinner
/// than any length that is asked for, above all where rods end in common balls. Measured: a wire in a zigzag has a third of
/// the triangles and half of the time that it has with a 64th; of the tests' 179 parts the sum falls by a fourteenth, and
/// no fewer are proved.
const TIDY_SHARE: f64 = 0.1;

/// The mesh without most of the triangles that cuts leave; what judges it does not ask how it came about.
fn tidied(mesh: Mesh, length: Tolerance, request: &MeshRequest, job: &Job) -> Mesh {
    let Ok(little) = Tolerance::new(TIDY_SHARE * length.get()) else { return mesh };
    let mesh = boolean_unchecked(&mesh, &[], Some(little), job).unwrap_or(mesh);
    match simplify_mesh(&mesh, (&Budget::length(little), request.effort), Topology::Indices, job) {
        Ok(made) => made.shape.mesh,
        Err(_) => mesh,
    }
}

/// Collapses within what a bound leaves of the length.
fn with_fewer_triangles(
    made: Bounded<Mesh>,
    (budget, length): (&Budget, Tolerance),
    request: &MeshRequest,
    job: &Job,
) -> Result<MadeMesh, MeshFailure> {
    if made.bound.at_most().is_none() {
        return Ok((made, None));
    }
    match simplified_without_crossings(made.clone(), (budget, length.get(), request.effort), job) {
        Ok(fewer) => Ok(fewer),
        Err(Failure::Cancelled) => Err(MeshFailure::Cancelled),
        Err(Failure::Unmet(_) | Failure::Refused(_)) => Ok((made, None)),
    }
}
