//! The arrow from a closed mesh to the surface at a distance from it. It is here, and not in `convert`, since triangles are left
//! out before the proof: proved as they are made, they would take ten times as long.
use super::simplify::{simplify, simplify_by_planes};
use crate::budget::{Bound, Bounded, Budget, Failure, Job, RefusalCode, Tolerance};
use crate::check::{self, OffsetSource, OffsetVerdict, offset_deviation_from};
use crate::convert::OffsetMesher;
use crate::explicit::{Mesh, Topology, is_closed};
use crate::math::{Box3, add_up, greater, lesser, sub_down};

/// The share of the length within which samples of the triangles have to be. Chosen: with more, fewer shapes are proved; with
/// less, it takes longer.
const SHARE: f64 = 0.45;
/// The share for leaving triangles out; the rest is for the proof. Chosen.
const SIMPLIFIED: f64 = 0.3;
/// The share for leaving out those of flat parts first, by the mean of their distances from planes: they are most, and take no
/// proof.
const FLAT: f64 = 0.03;
/// A proof has this share less of the length than is claimed: who proves it again, from rounded coordinates, needs a little.
const SLACK: f64 = 1.0 / 64.0;
/// The most proofs. Chosen: after a few, what is open is a contact.
const PROOFS: usize = 3;

/// The surface at the signed distance `by` from a solid that a mesh bounds: outward where it is positive, inward where it
/// is negative.
///
/// **What it is.** Outward, the boundary of all points that are nearer to the solid than `by`: edges and corners become
/// round, valleys stay sharp, gaps narrower than 2·`by` close. Inward, the boundary of all points that are deeper in the
/// solid than −`by`: mitres are sharp, valleys become round, walls thinner than −2·`by` vanish. It is the whole boundary,
/// with that of hidden voids.
///
/// **Bound.** The Hausdorff distance, in both directions, between the triangles and that surface, *proved*
/// ([`offset_deviation`](crate::check::offset_deviation)). Where a wall vanishes, or a gap closes, at just this distance,
/// nobody can tell within rounding: then the whole mesh is measured, and such places are listed.
///
/// **Mesh.** Closed and manifold, with vertices on sharp edges, and simplified within a share of the tolerance.
///
/// **Cost.** Some 100 µs a cell: cells are about as large as the distance, and smaller along sharp edges and where the
/// tolerance asks for it. Memory: some 3 kB for each.
///
/// # Errors
/// [`Failure::Refused`] if the mesh is not closed, the distance is 0 or not finite, the budget has no length, or nothing is
/// left of the solid; [`Failure::Unmet`] with the best mesh if the length is not met or not proved; [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Budget, Job, Mesh, Tolerance, check, lod};
/// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let tetrahedron = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
/// let budget = Budget::length(Tolerance::new(0.01)?);
/// let wider = lod::mesh_to_offset(&tetrahedron, 0.1, &budget, &Job::default()).unwrap();
/// assert!(wider.bound.at_most().unwrap() <= 0.01);
/// let volume = |mesh: &Mesh| check::findings::measure(mesh).signed_volume;
/// assert!(volume(&wider.shape) > volume(&tetrahedron));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Sources: J. Steiner's parallel bodies, 1840, for what it is; the sources in `convert/offset/` for the triangles.
pub fn mesh_to_offset(
    mesh: &Mesh,
    by: f64,
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let refused = |code: RefusalCode, message: String| Err(Failure::refused(code, message));
    if !by.is_finite() || by == 0.0 {
        return refused(RefusalCode::Usage, format!("an offset is a length other than 0, not {by}"));
    }
    if mesh.faces().is_empty() {
        return refused(RefusalCode::Empty, "there is no triangle to move".into());
    }
    if !is_closed(mesh) {
        let message = "the mesh is not closed, so that it has no inside to move its surface from";
        return refused(RefusalCode::Unsupported, message.into());
    }
    // Where pixels are the limit, they are those of the result, which may be nearer to the eye than the solid.
    let (bounds, grow) = (mesh.bounds(), greater(by, 0.0));
    let bounds =
        Box3 { min: bounds.min.map(|x| sub_down(x, grow)), max: bounds.max.map(|x| add_up(x, grow)) };
    let Some(length) = budget.length_in(&bounds).and_then(|length| Tolerance::new(length).ok()) else {
        return refused(RefusalCode::Budget, "an offset needs a length: a tolerance or pixels".into());
    };
    let Bounded { shape, bound } = search(mesh, by, length, job)?;
    if shape.faces().is_empty() {
        let message = format!("nothing is left: no point of the solid is deeper than {}", -by);
        return refused(RefusalCode::Empty, message);
    }
    let is_met = bound.at_most().is_some_and(|most| most <= length.get());
    Bounded { shape, bound }.met_if(is_met)
}

/// The best triangles that were found, with their bound.
fn search(mesh: &Mesh, by: f64, length: Tolerance, job: &Job) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let source = OffsetSource::new(mesh, by, job)?;
    let mut mesher = OffsetMesher::new(source.mesh(), by, SHARE * length.get(), job)?;
    let mut best: Option<(Mesh, OffsetVerdict)> = None;
    for proof in 1..=PROOFS {
        let shape = simplified(&mesher.triangles(job)?, length, job)?;
        let verdict = offset_deviation_from(&shape, &source, (1.0 - SLACK) * length.get(), job)?;
        let open = verdict.open.clone();
        if best.as_ref().is_none_or(|(_, best)| open.len() < best.open.len()) {
            best = Some((shape, verdict));
        }
        if open.is_empty() || proof == PROOFS || job.is_finishing() || !mesher.cut_near(&open, job) {
            break;
        }
    }
    let (shape, OffsetVerdict { bound, .. }) = best.expect("there is at least one proof");
    let bound = match bound.at_most() {
        Some(most) => {
            let claimed = lesser(add_up(most, SLACK * length.get()), length.get());
            Bound::with_evidence(bound.at_least(), Some(claimed), bound.evidence().clone(), bound.reference)
        }
        None => bound,
    };
    Ok(Bounded { shape, bound })
}

/// The same surface by fewer triangles.
fn simplified(mesh: &Mesh, length: Tolerance, job: &Job) -> Result<Mesh, Failure<Mesh>> {
    if mesh.faces().is_empty() {
        return Ok(mesh.clone());
    }
    let flat = simplify_by_planes(mesh, FLAT * length.get(), job)?;
    let Ok(share) = Tolerance::new(SIMPLIFIED * length.get()) else { return Ok(flat) };
    match simplify(&flat, &Budget::length(share), Topology::Indices, job) {
        // Simplification keeps a surface near, and may fold it where two parts of it are nearer to each other.
        Ok(simple) if check::self_intersections(&simple.shape.mesh, job)?.count == 0 => Ok(simple.shape.mesh),
        Err(Failure::Cancelled) => Err(Failure::Cancelled),
        // What cannot be simplified is as near as before.
        Ok(_) | Err(_) => Ok(flat),
    }
}
