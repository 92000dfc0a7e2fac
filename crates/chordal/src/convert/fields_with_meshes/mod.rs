//! From a field with meshes among its leaves to triangles.
//!
//! The distance to a mesh has kinks everywhere around it, so nothing grows steadily across more than a
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
/// The most lattices for one length, each of half the step of the one before. A thin part between the samples
/// of one lattice may be met by the next.
const MOST_HALVINGS: usize = 2;
/// Cells along the longest side of the first lattice for a number of triangles.
const FIRST_CELLS: f64 = 48.0;
/// The most lattices for a number of triangles.
const MOST_TRIALS: usize = 6;
/// A mesh with this fraction of the allowed triangles is good enough. Chosen: the count goes in steps.
const GOOD_COUNT: f64 = 0.8;

type MeshResult = Result<Bounded<Mesh>, Failure<Mesh>>;

/// Whether the surface of a field depends on triangles that have an inside.
pub fn has_meshes(field: &Field) -> bool {
    ExprGraph::from_expr(field.sign()).terms().iter().any(|term| {
        let Term::Leaf(leaf, _) = term else { return false };
        leaf.as_any().and_then(|any| any.downcast_ref::<MeshLeaf>()).is_some_and(MeshLeaf::has_sides)
    })
}

/// Whether some mesh is not a solid: then it may have triangles that are no part of the surface.
fn has_walls(field: &Field) -> bool {
    ExprGraph::from_expr(field.sign()).terms().iter().any(|term| {
        let Term::Leaf(leaf, _) = term else { return false };
        let mesh = leaf.as_any().and_then(|any| any.downcast_ref::<MeshLeaf>());
        mesh.and_then(MeshLeaf::source).is_some_and(|source| !source.is_solid)
    })
}

/// Finds a mesh within the limits, or the best.
pub(in crate::convert) fn search(field: &Field, wanted: &FieldMeshGoal, job: &Job) -> MeshResult {
    let made = search_plain(field, wanted, job);
    let csg = Csg::from_expr(field.sign());
    match FaceMaterials::new(&csg, job) {
        Some(materials) => materials.paint(made, wanted.length),
        None => made,
    }
}

/// Gives the faces of a field's mesh the numbers of their materials, as the group `material`: each that of the surface
/// that is nearest to its middle. A field without materials leaves the mesh as it is.
///
/// # Errors
/// Where a leaf of the field fails.
pub fn with_face_materials(
    made: Bounded<Mesh>,
    field: &Field,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let csg = Csg::from_expr(field.sign());
    match FaceMaterials::new(&csg, job) {
        Some(materials) => materials.paint(Ok(made), None),
        None => Ok(made),
    }
}

/// The same without materials.
fn search_plain(field: &Field, wanted: &FieldMeshGoal, job: &Job) -> MeshResult {
    if !field.evidence().bounds_above() {
        let message = "a function whose ranges are not known is not meshed together with triangles";
        return Err(Failure::refused(RefusalCode::Unsupported, message));
    }
    if let Some(placed) = PlacedMesh::from_field(field) {
        let made = placed.triangles(field)?;
        let most = wanted.triangles.unwrap_or(u64::MAX);
        let fits = made.shape.faces().len() as u64 <= most.min(job.triangle_limit);
        if fits || wanted.length.is_some() {
            return judged(made, wanted);
        }
    }
    match (wanted.length, wanted.triangles) {
        (Some(length), _) => judged(by_length(field, length, job)?, wanted),
        (None, Some(most)) => by_count(field, most.min(job.triangle_limit), job),
        (None, None) => Err(Failure::refused(RefusalCode::Budget, "the budget has no length and no count")),
    }
}

/// The mesh, or that it is beyond the budget.
fn judged(made: Bounded<Mesh>, wanted: &FieldMeshGoal) -> MeshResult {
    let fits = wanted.triangles.is_none_or(|most| made.shape.faces().len() as u64 <= most);
    let near =
        wanted.length.is_none_or(|length| made.bound.at_most().is_some_and(|most| most <= length.get()));
    if fits && near { Ok(made) } else { Err(Failure::Unmet(Box::new(made))) }
}

/// The best of a few lattices.
fn by_length(field: &Field, length: Tolerance, job: &Job) -> MeshResult {
    let upper = |made: &Bounded<Mesh>| made.bound.at_most().unwrap_or(f64::INFINITY);
    // √3 steps are the diagonal of a cell.
    let mut step = SHARE * length.get() / sqrt_up(3.0);
    let mut best: Option<Bounded<Mesh>> = None;
    for _ in 0..MOST_HALVINGS {
        match (on_lattice(field, step, length.get(), job), &best) {
            (Ok(made), _) if upper(&made) <= length.get() => return Ok(made),
            (Ok(made), Some(old)) if upper(old) <= upper(&made) => {}
            (Ok(made), _) => best = Some(made),
            // A finer lattice is beyond the limits: what there is is the best.
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

/// The finest lattice found with at most `most` triangles, whose number goes like 1 over the square of the
/// step.
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
        let mut limited = job.clone();
        limited.triangle_limit = job.triangle_limit.min(most.saturating_mul(64));
        let made = match on_lattice(field, step, f64::INFINITY, &limited) {
            Ok(made) => made,
            // So many that their number says little.
            Err(Failure::Refused(why)) if why.code == RefusalCode::TooManyTriangles => {
                too_fine = greater(step, too_fine);
                // Sixteen times as many triangles as four steps.
                step *= 4.0;
                continue;
            }
            Err(Failure::Refused(_)) if best.is_some() => break,
            Err(failure) => return Err(failure),
        };
        let ratio = made.shape.faces().len() as f64 / most as f64;
        let current = step;
        if ratio <= 1.0 {
            let is_finer = best.as_ref().is_none_or(|(old, _)| step < *old);
            if is_finer {
                best = Some((step, made));
            }
            if ratio > GOOD_COUNT {
                break;
            }
        } else {
            too_fine = greater(step, too_fine);
        }
        // A little coarser than predicted.
        step *= 1.02 * greater(ratio, 1.0 / 256.0).sqrt();
        let is_known = step <= too_fine || best.as_ref().is_some_and(|(old, _)| step >= *old);
        if is_known {
            let coarse = best.as_ref().map_or(4.0 * current, |(old, _)| *old);
            step = (coarse * greater(too_fine, coarse / 16.0)).sqrt();
        }
    }
    best.map(|(_, made)| made).ok_or_else(|| {
        Failure::refused(RefusalCode::Budget, format!("{most} triangles are too few for the shape"))
    })
}

/// The mesh of one lattice with its bound. Parts of the surface that no triangle is near are looked at more
/// closely until they are within `enough`.
fn on_lattice(field: &Field, step: f64, enough: f64, job: &Job) -> MeshResult {
    let lattice = SignLattice::sample(field, step, job)?;
    let mesh = lattice.polygonize(job)?;
    let goal = CoverGoal { enough, has_walls: has_walls(field) };
    let cover = surface_cover::farthest(field, &lattice, &mesh, &goal, job)?;
    let most = greater(cover.most, lattice.cell_diagonal());
    // Samples are off their places by rounding, and so are vertices.
    let most = add_up(most, mul_up(2.0, lattice.rounding()));
    let mut evidence = field.evidence();
    if cover.n_walls > 0 {
        // What the proof needs is that the boxes hold no surface. Whoever made the mesh knows of films and gaps, and of boxes
        // nothing.
        let sentence = format!(
            "nothing of the shape that lies along the triangles of a mesh which is open or crosses itself is thinner than \
             {:.1e}: no film, no gap and no bump that all samples around miss ({} places look as if there could be one)",
            lattice.cell_diagonal(),
            cover.n_walls
        );
        evidence = evidence.weaker(&Evidence::ProvedIf(vec![sentence]));
    }
    if lattice.n_doubtful() > 0 {
        let sentence = format!(
            "the signs of the field at {} samples, which rounding may decide, are as computed",
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
