//! From a field with meshes among its leaves to triangles.
//!
//! The distance to a mesh has kinks everywhere around it, so no function grows steadily across more than a
//! triangle, and a proof by growth (`convert/fields`) would take cells as small as the triangles. Two other
//! ways need less:
//!
//! - A field that *is* one solid mesh, moved, turned or scaled, is its triangles (`placed_mesh.rs`).
//! - Otherwise the sign on a lattice is polygonized (`sign_lattice.rs`), and ranges of the field prove where
//!   its surface may be (`surface_cover.rs`). That needs no gradient, so sides may also change where an open
//!   mesh has no triangle.
mod placed_mesh;
mod sign_lattice;
mod solid_tree;
mod surface_cover;

use super::fields::{FaceMaterials, FieldMeshGoal};
use super::mesh_leaf::MeshLeaf;
use crate::budget::{Bound, Bounded, Evidence, Failure, Job, Reference, RefusalCode, Tolerance};
use crate::explicit::Mesh;
use crate::implicit::{Csg, ExprGraph, Field, LeafError, Term};
use crate::math::{Box3, add_up, greater, mul_up, sqrt_up};
use placed_mesh::PlacedMesh;
use sign_lattice::SignLattice;
use surface_cover::CoverGoal;

pub use solid_tree::{SolidNode, SolidTree};

/// The diagonal of a cell as a fraction of the length. Chosen: the rest is for parts of the surface in cells
/// without triangles.
const SHARE: f64 = 0.85;
/// The most lattices for one length, each of half the step of the one before. Chosen: a thin part between the samples
/// of one lattice may be found by the next.
const MOST_HALVINGS: usize = 2;
/// Cells along the longest side of the first lattice for a number of triangles. Chosen: later tries correct it.
const FIRST_CELLS: f64 = 48.0;
/// The most lattices for a number of triangles. Chosen: each costs a mesh.
const MOST_TRIALS: usize = 6;
/// A mesh with this fraction of the allowed triangles ends the search. Chosen: the count changes in steps.
const GOOD_COUNT: f64 = 0.8;

type MeshResult = Result<Bounded<Mesh>, Failure<Mesh>>;

/// Whether the surface of a field depends on triangles that have an inside.
pub fn has_meshes(field: &Field) -> bool {
    ExprGraph::from_expr(field.sign()).terms().iter().any(|term| {
        let Term::Leaf(leaf, _) = term else { return false };
        leaf.as_any().and_then(|any| any.downcast_ref::<MeshLeaf>()).is_some_and(MeshLeaf::has_sides)
    })
}

/// Whether some mesh is not a solid: then some of its triangles may be inner walls, which are not part of the surface.
fn has_walls(field: &Field) -> bool {
    ExprGraph::from_expr(field.sign()).terms().iter().any(|term| {
        let Term::Leaf(leaf, _) = term else { return false };
        let mesh = leaf.as_any().and_then(|any| any.downcast_ref::<MeshLeaf>());
        mesh.and_then(MeshLeaf::source).is_some_and(|source| !source.is_solid)
    })
}

/// Finds a mesh within the limits; otherwise the failure has the best mesh.
pub(in crate::convert) fn search(field: &Field, goal: &FieldMeshGoal, job: &Job) -> MeshResult {
    let mesh = search_plain(field, goal, job);
    let csg = Csg::from_expr(field.sign());
    match FaceMaterials::new(&csg, job) {
        Some(materials) => materials.paint(mesh, goal.length),
        None => mesh,
    }
}

/// Gives the faces of a field's mesh the numbers of their materials, as the group `material`: a face has the material of
/// the surface that is nearest to its middle. If the field has no materials, the mesh stays as it is.
///
/// # Errors
/// If a leaf of the field fails.
pub fn with_face_materials(
    mesh: Bounded<Mesh>,
    field: &Field,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let csg = Csg::from_expr(field.sign());
    match FaceMaterials::new(&csg, job) {
        Some(materials) => materials.paint(Ok(mesh), None),
        None => Ok(mesh),
    }
}

/// [`search`] without materials.
fn search_plain(field: &Field, goal: &FieldMeshGoal, job: &Job) -> MeshResult {
    if !field.evidence().bounds_above() {
        let message = "a function without known ranges cannot be meshed together with triangles";
        return Err(Failure::refused(RefusalCode::Unsupported, message));
    }
    if let Some(placed) = PlacedMesh::from_field(field) {
        let mesh = placed.triangles(field)?;
        let most = goal.triangles.unwrap_or(u64::MAX);
        let fits = mesh.shape.faces().len() as u64 <= most.min(job.triangle_limit);
        // Within a length, the triangles themselves are the best mesh, however many they are.
        if fits || goal.length.is_some() {
            return judged(mesh, goal);
        }
    }
    match (goal.length, goal.triangles) {
        (Some(length), _) => judged(by_length(field, length, job)?, goal),
        (None, Some(most)) => by_count(field, most.min(job.triangle_limit), job),
        (None, None) => Err(Failure::refused(RefusalCode::Budget, "the budget has no length and no count")),
    }
}

/// The mesh if it is within the budget, otherwise [`Failure::Unmet`] with it.
fn judged(mesh: Bounded<Mesh>, goal: &FieldMeshGoal) -> MeshResult {
    let fits = goal.triangles.is_none_or(|most| mesh.shape.faces().len() as u64 <= most);
    let near = goal.length.is_none_or(|length| mesh.bound.at_most().is_some_and(|most| most <= length.get()));
    mesh.met_if(fits && near)
}

/// The best of a few lattices.
fn by_length(field: &Field, length: Tolerance, job: &Job) -> MeshResult {
    let upper = |mesh: &Bounded<Mesh>| mesh.bound.at_most().unwrap_or(f64::INFINITY);
    // √3 steps are the diagonal of a cell.
    let mut step = SHARE * length.get() / sqrt_up(3.0);
    let mut best: Option<Bounded<Mesh>> = None;
    for _ in 0..MOST_HALVINGS {
        match (on_lattice(field, step, length.get(), job), &best) {
            (Ok(mesh), _) if upper(&mesh) <= length.get() => return Ok(mesh),
            (Ok(mesh), Some(best_mesh)) if upper(best_mesh) <= upper(&mesh) => {}
            (Ok(mesh), _) => best = Some(mesh),
            // A finer lattice exceeds the job's limits: the last mesh is the best.
            (Err(Failure::Refused(_)), Some(_)) => break,
            (Err(failure), _) => return Err(failure),
        }
        if job.is_finishing() && best.is_some() {
            break;
        }
        step *= 0.5;
    }
    best.ok_or_else(|| Failure::refused(RefusalCode::Empty, "there is no surface: no sample is inside"))
}

/// The mesh of the finest lattice found that has at most `most` triangles. The search assumes that their number grows
/// like 1/step².
fn by_count(field: &Field, most: u64, job: &Job) -> MeshResult {
    let Box3 { min, max } = field.bounds();
    let longest = (0..3).fold(0.0, |far, k| greater(max[k] - min[k], far));
    let mut step = longest / FIRST_CELLS;
    let mut best: Option<(f64, Bounded<Mesh>)> = None;
    let mut too_fine = 0.0;
    for _ in 0..MOST_TRIALS {
        if job.is_finishing() && best.is_some() {
            break;
        }
        // A lattice that is far too fine is given up early.
        let mut limited = job.clone();
        limited.triangle_limit = job.triangle_limit.min(most.saturating_mul(64));
        let mesh = match on_lattice(field, step, f64::INFINITY, &limited) {
            Ok(mesh) => mesh,
            // So many that the number is of no use for a prediction.
            Err(Failure::Refused(refusal)) if refusal.code == RefusalCode::TooManyTriangles => {
                too_fine = greater(step, too_fine);
                // A step four times as large gives a sixteenth of the triangles.
                step *= 4.0;
                continue;
            }
            Err(Failure::Refused(_)) if best.is_some() => break,
            Err(failure) => return Err(failure),
        };
        let ratio = mesh.shape.faces().len() as f64 / most as f64;
        let current = step;
        if ratio <= 1.0 {
            let is_finer = best.as_ref().is_none_or(|(old, _)| step < *old);
            if is_finer {
                best = Some((step, mesh));
            }
            if ratio > GOOD_COUNT {
                break;
            }
        } else {
            too_fine = greater(step, too_fine);
        }
        // A little coarser than predicted, to stay below the limit.
        step *= 1.02 * greater(ratio, 1.0 / 256.0).sqrt();
        let is_outside = step <= too_fine || best.as_ref().is_some_and(|(old, _)| step >= *old);
        // The prediction contradicts what is known: a step halfway between, by ratio, is tried instead.
        if is_outside {
            let coarse = best.as_ref().map_or(4.0 * current, |(old, _)| *old);
            step = (coarse * greater(too_fine, coarse / 16.0)).sqrt();
        }
    }
    best.map(|(_, mesh)| mesh).ok_or_else(|| {
        Failure::refused(RefusalCode::Budget, format!("{most} triangles are too few for the shape"))
    })
}

/// The mesh of one lattice with its bound. Boxes with parts of the surface that are far from all triangles are halved
/// until they are within `enough`.
fn on_lattice(field: &Field, step: f64, enough: f64, job: &Job) -> MeshResult {
    let lattice = SignLattice::sample(field, step, job)?;
    let mesh = lattice.polygonize(job)?;
    let goal = CoverGoal { enough, has_walls: has_walls(field) };
    let cover = surface_cover::farthest(field, &lattice, &mesh, &goal, job)?;
    let most = greater(cover.most, lattice.cell_diagonal());
    // Rounding moves both samples and vertices.
    let most = add_up(most, mul_up(2.0, lattice.rounding()));
    let mut evidence = field.evidence();
    if cover.n_walls > 0 {
        // The proof assumes that these boxes contain no surface. The condition is worded for the author of the mesh, who knows
        // about films and gaps, not about boxes.
        let sentence = format!(
            "along the triangles of a mesh that is open or crosses itself, nothing is thinner than {:.1e}: \
             no film, gap or bump lies between the samples ({} places could have one)",
            lattice.cell_diagonal(),
            cover.n_walls
        );
        evidence = evidence.weaker(&Evidence::ProvedIf(vec![sentence]));
    }
    if lattice.n_doubtful() > 0 {
        let sentence = format!(
            "the computed signs of the field are right at {} samples where rounding could change them",
            lattice.n_doubtful()
        );
        evidence = evidence.weaker(&Evidence::ProvedIf(vec![sentence]));
    }
    let mut bound = Bound::with_evidence(0.0, Some(most), evidence, Reference::Field);
    bound.at = cover.at;
    Ok(Bounded { shape: mesh, bound })
}

fn leaf_failure(error: &LeafError) -> Failure<Mesh> {
    Failure::refused(RefusalCode::LeafFailed, error.to_string())
}
