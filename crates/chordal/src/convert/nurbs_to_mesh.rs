//! The arrow from NURBS surfaces to triangles: by way of bicubic patches, proved.
use super::budget_search::{length_from_pixels, remaining_pixels};
use super::nurbs::fit::fit;
use super::patches_to_mesh::patches_to_mesh;
use crate::budget::{Bound, Bounded, Budget, Failure, Job, Reference, RefusalCode, Tolerance};
use crate::explicit::nurbs::{HEAVIEST, NurbsSurface};
use crate::explicit::{Mesh, Patch};
use crate::math::{Box3, add_up, flushes_subnormals, greater, sub_down};

/// The share of an allowed length that the patches may use. Chosen: the number of triangles grows like 1 over the
/// remaining length.
const SHARE: f64 = 0.1;
/// The first lengths for a number of triangles, relative to the diagonal; the next is taken if the patches alone have too
/// many triangles. Chosen: one fine, one middling and one coarse length.
const FIRST: [f64; 3] = [1e-3, 1e-2, 1e-1];
/// Squares of differences of coordinates below this stay far from the largest number.
const LARGEST: f64 = 1e150;

/// Bicubic Bézier patches within a distance of NURBS surfaces.
///
/// **Bound.** Two-sided Hausdorff distance between the surfaces, taken exactly as given, and the patches, *proved*,
/// rounding and [`NurbsSurface::slack`] included; of points with the same parameters (`convert/nurbs/fit_error.rs`). A
/// polynomial surface of degree 3 at most is reproduced up to rounding.
///
/// **Patches.** Row by row, surface after surface. Within a surface neighbours have equal sides, bit for bit, also across
/// the seam of a closed surface; a side that is one point stays one point.
///
/// **Cost.** About 10 µs a patch for degree 2; errors fall with the fourth power of the number of patches along a side.
///
/// # Errors
/// [`Failure::Refused`]: no surface, a coordinate beyond 1e150, an environment that flushes subnormals.
/// [`Failure::Unmet`] with the nearest patches: the length is below rounding, or needs more patches than the job allows.
/// [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Job, Tolerance, convert, explicit::nurbs::NurbsSurface};
/// let torus = NurbsSurface::torus(2.0, 0.5)?;
/// let fit = |tol| convert::nurbs_to_patches(&[torus.clone()], Tolerance::new(tol).unwrap(), &Job::default()).unwrap();
/// let (coarse, fine) = (fit(1e-2), fit(1e-6));
/// assert!(fine.bound.at_most().unwrap() <= 1e-6);
/// // A ten-thousandth of the error costs ten times as many along each side.
/// assert!(fine.shape.len() < 200 * coarse.shape.len());
/// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
/// ```
pub fn nurbs_to_patches(
    surfaces: &[NurbsSurface],
    length: Tolerance,
    job: &Job,
) -> Result<Bounded<Vec<Patch>>, Failure<Vec<Patch>>> {
    check_surfaces(surfaces.iter())?;
    let bounded = job.run(|| {
        let mut patches =
            Bounded { shape: Vec::new(), bound: Bound::proved(0.0, 0.0, Reference::NurbsSurfaces) };
        let mut at_most = 0.0;
        for surface in surfaces {
            // Even if the surface's own slack uses up the length, the patches are fitted to the surface as given.
            let remaining = greater(sub_down(length.get(), surface.slack()), SHARE * length.get());
            let fitted = fit(surface, remaining, job);
            if job.is_cancelled() {
                return Err(Failure::Cancelled);
            }
            at_most = greater(with_slack(fitted.at_most, surface.slack()), at_most);
            patches.shape.extend(fitted.patches);
        }
        if at_most >= LARGEST || at_most.is_nan() {
            let message =
                "a patch near a surface would leave the range of numbers: the weights differ too much";
            return Err(Failure::refused(RefusalCode::NotFinite, message));
        }
        patches.bound = Bound::proved(0.0, at_most, Reference::NurbsSurfaces);
        Ok(patches)
    })?;
    let is_met = bounded.bound.at_most().is_some_and(|most| most <= length.get());
    bounded.met_if(is_met)
}

/// Meshes NURBS surfaces within a budget.
///
/// **Bound.** Two-sided Hausdorff distance between the union of the surfaces, taken exactly as given, and the triangles,
/// *proved*, rounding included: the sum of the bounds of [`nurbs_to_patches`] and [`patches_to_mesh`]. With a budget of
/// pixels the bound is also given in pixels at the view.
///
/// **Mesh.** As from [`patches_to_mesh`]: without cracks within a surface, and closed if the surface is. Surfaces that
/// touch along a side share no vertices yet.
///
/// **Budgets.** A length, pixels at a view, a number of triangles, or several of these.
///
/// **Cost.** That of [`patches_to_mesh`] and about 10 µs a patch.
///
/// # Errors
/// Those of [`patches_to_mesh`]; a budget of an angle is refused ([`RefusalCode::Unsupported`]).
///
/// ```
/// use chordal::{Budget, Job, Tolerance, check, convert, explicit::{Topology, nurbs::NurbsSurface}};
/// let torus = NurbsSurface::torus(2.0, 0.5)?;
/// let bounded = convert::nurbs_to_mesh(&[torus], &Budget::length(Tolerance::new(1e-2).unwrap()), &Job::default()).unwrap();
/// assert!(bounded.bound.at_most().unwrap() <= 1e-2);
/// assert!(check::validity(&bounded.shape, Topology::Positions).closed);
/// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
/// ```
pub fn nurbs_to_mesh(
    surfaces: &[NurbsSurface],
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    budget.check_for_surfaces().map_err(Failure::Refused)?;
    check_surfaces(surfaces.iter())?;
    if budget.angle_deg.is_some() {
        let message = "NURBS surfaces cannot be meshed to an angle yet: give a length or pixels";
        return Err(Failure::refused(RefusalCode::Unsupported, message));
    }
    let bounds = bounds_of(surfaces);
    let by_view = budget.pixels.map(|px| length_from_pixels(&bounds, &px)).transpose()?;
    let by_length = budget.length.map(Tolerance::get);
    let wanted = match (by_view, by_length) {
        (Some(a), Some(b)) => Some(if a < b { a } else { b }),
        (one, other) => one.or(other),
    };
    refuse_slack(surfaces.iter().map(NurbsSurface::slack).fold(0.0, greater), wanted)?;
    match wanted {
        Some(wanted) => mesh_at(surfaces, budget, SHARE * wanted, job),
        None => {
            let at = |share: f64| mesh_at(surfaces, budget, share * bounds.diagonal(), job);
            let first = FIRST[1..].iter().fold(at(FIRST[0]), |mesh, share| match mesh {
                Err(Failure::Unmet(_)) => at(*share),
                other => other,
            })?;
            let Some(reached) = first.bound.at_most() else { return Ok(first) };
            // Once more, with patches as near as the distance that was reached needs.
            match mesh_at(surfaces, budget, SHARE * reached, job) {
                Ok(again) if again.bound.at_most().is_some_and(|most| most < reached) => Ok(again),
                Err(Failure::Cancelled) => Err(Failure::Cancelled),
                _ => Ok(first),
            }
        }
    }
}

/// The mesh within a budget, by way of patches within a length.
fn mesh_at(
    surfaces: &[NurbsSurface],
    budget: &Budget,
    length: f64,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let below_precision = || {
        let message = "the budget is less than the possible rounding error at this distance from the origin";
        Failure::refused(RefusalCode::BelowPrecision, message)
    };
    let length = Tolerance::new(length).map_err(|_| below_precision())?;
    let fitted = match nurbs_to_patches(surfaces, length, job) {
        Ok(patches) => patches,
        // Patches that miss the length have a bound, too; what it leaves of the budget decides.
        Err(Failure::Unmet(best)) => *best,
        Err(Failure::Refused(refusal)) => return Err(Failure::Refused(refusal)),
        Err(Failure::Cancelled) => return Err(Failure::Cancelled),
    };
    let lost = fitted.bound.at_most().ok_or_else(below_precision)?;
    let mut remaining = *budget;
    if let Some(total) = budget.length {
        remaining.length =
            Some(Tolerance::new(sub_down(total.get(), lost).next_down()).map_err(|_| below_precision())?);
    }
    let bounds = around(&bounds_of(surfaces), lost);
    if let Some(px) = budget.pixels {
        remaining.pixels = Some(remaining_pixels(&px, lost, &bounds).ok_or_else(below_precision)?);
    }
    let join = |mesh: Bounded<Mesh>| {
        let mut bound = fitted.bound.then(&mesh.bound);
        bound.pixels = budget.pixels.and_then(|px| {
            px.view.pixels_of_two_steps(mesh.bound.pixels?, px.view.pixels_of(lost, &bounds)?)
        });
        bound.at = mesh.bound.at;
        Bounded { shape: mesh.shape, bound }
    };
    match patches_to_mesh(&fitted.shape, &remaining, job) {
        Ok(mesh) => {
            let mesh = join(mesh);
            // The bounds of both steps, and their sum, are rounded up, so that the total may exceed the length.
            let is_met = budget
                .length
                .is_none_or(|total| mesh.bound.at_most().is_some_and(|most| most <= total.get()));
            mesh.met_if(is_met)
        }
        Err(Failure::Unmet(best)) => Err(Failure::Unmet(Box::new(join(*best)))),
        other => other,
    }
}

/// Turns a bound to a surface as given into one to the exact surface. Without slack it stays the same, bit for bit.
pub(super) fn with_slack(at_most: f64, slack: f64) -> f64 {
    if slack == 0.0 { at_most } else { add_up(at_most, slack) }
}

/// Refuses a length that the slack of a surface uses up.
pub(super) fn refuse_slack(slack: f64, wanted: Option<f64>) -> Result<(), Failure<Mesh>> {
    match wanted.filter(|wanted| sub_down(*wanted, slack) <= 0.0) {
        None => Ok(()),
        Some(wanted) => {
            let message = format!(
                "the surfaces are known only to within {slack:.3e}, from how they were constructed, and \
                 the budget allows {wanted:.3e}"
            );
            Err(Failure::refused(RefusalCode::BelowPrecision, message))
        }
    }
}

fn bounds_of(surfaces: &[NurbsSurface]) -> Box3 {
    surfaces.iter().map(NurbsSurface::bounds).reduce(|a, b| a.union(b)).unwrap_or(Box3::EMPTY)
}

fn around(bounds: &Box3, margin: f64) -> Box3 {
    Box3 { min: bounds.min.map(|x| sub_down(x, margin)), max: bounds.max.map(|x| add_up(x, margin)) }
}

/// Refuses an empty list of surfaces, and numbers or environments that allow no proof.
pub(super) fn check_surfaces<'a, T>(
    mut surfaces: impl ExactSizeIterator<Item = &'a NurbsSurface>,
) -> Result<(), Failure<T>> {
    if surfaces.len() == 0 {
        return Err(Failure::refused(RefusalCode::Empty, "there are no surfaces"));
    }
    let is_in_range = |surface: &NurbsSurface| {
        surface.control().as_flattened().iter().all(|x| x.abs() < LARGEST)
            && surface.weights().iter().all(|w| *w < HEAVIEST && *w > 1.0 / HEAVIEST)
    };
    if let Some(index) = surfaces.position(|surface| !is_in_range(surface)) {
        let message = format!(
            "surface {index} has a coordinate beyond {LARGEST:e}, or a weight beyond {HEAVIEST:e} or its inverse"
        );
        return Err(Failure::refused(RefusalCode::NotFinite, message));
    }
    if flushes_subnormals() {
        let message = "this process flushes subnormal numbers to zero, so nothing can be proved in it";
        return Err(Failure::refused(RefusalCode::FlushesSubnormals, message));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::validity;

    #[test]
    fn a_torus_and_a_ball_are_closed_and_within_their_bound() {
        for (surface, radius) in
            [(NurbsSurface::torus(2.0, 0.5).unwrap(), Some(2.0)), (NurbsSurface::sphere(1.5).unwrap(), None)]
        {
            for length in [1e-1, 1e-3] {
                let mesh = nurbs_to_mesh(
                    std::slice::from_ref(&surface),
                    &Budget::length(Tolerance::new(length).unwrap()),
                    &Job::default(),
                )
                .unwrap();
                let bound = mesh.bound.at_most().unwrap();
                assert!(bound <= length);
                let valid = validity(&mesh.shape, crate::explicit::Topology::Positions);
                assert!(valid.closed && valid.edge_manifold && valid.oriented, "{valid:?}");
                let distance = |p: &[f64; 3]| match radius {
                    Some(ring) => {
                        let r = (p[0] * p[0] + p[1] * p[1]).sqrt() - ring;
                        ((r * r + p[2] * p[2]).sqrt() - 0.5).abs()
                    }
                    None => (crate::math::length(*p) - 1.5).abs(),
                };
                let mut worst = 0.0;
                for face in mesh.shape.faces() {
                    let [a, b, c] = face.map(|v| mesh.shape.positions()[v as usize]);
                    let middle = std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
                    worst = greater(distance(&middle), worst);
                }
                println!("{length} {bound} {worst} {}", mesh.shape.faces().len());
                assert!(worst <= bound && worst > 0.3 * bound, "{worst} {bound}");
            }
        }
    }
}
