//! The arrow from faces, which are trimmed NURBS surfaces, to triangles: sewn where faces meet, proved.
use super::budget_search::length_from_pixels;
use super::nurbs::trimmed_mesh::{TrimmedMesh, mesh_within};
use super::nurbs_to_mesh::{check_surfaces, nurbs_to_mesh, refuse_slack, with_slack};
use crate::budget::{Bound, Bounded, Budget, Failure, Job, Reference, RefusalCode, Tolerance};
use crate::explicit::Mesh;
use crate::explicit::nurbs::TrimmedSurface;
use crate::math::{Box3, add_up, greater, lesser, sub_down};

/// The first length for a number of triangles, relative to the diagonal. Chosen: later tries correct it by the ratio of
/// the numbers.
const FIRST: f64 = 1e-2;
/// The most lengths that are tried for a number of triangles. Chosen: each costs a mesh.
const TRIES: usize = 8;
/// The search ends with a mesh that has this share of the allowed triangles. Chosen: a larger share costs more tries.
const CLOSE: f64 = 0.9;

/// Meshes trimmed NURBS surfaces within a budget, and sews them where they meet.
///
/// **Bound.** Two-sided Hausdorff distance between the union of the regions that the loops enclose, the loops included,
/// taken exactly as given, and the triangles, *proved*, rounding included. It is a sum: patches near the surfaces (as
/// [`nurbs_to_patches`](super::nurbs_to_patches)), polygons near the loops (`convert/nurbs/trim_loops.rs`), triangles near
/// the patches ([`patches_to_mesh`](super::patches_to_mesh)), and the distance by which sewing moves vertices.
///
/// **Mesh.** Without cracks within a face. Borders of faces that are nearer than a quarter of the allowed length, and than a
/// ten-thousandth of the diagonal, share vertices, whatever their parameters; so a solid's faces give a closed mesh.
/// Borders farther apart stay apart. Vertices have the surface's normals, and are split where these
/// differ by 1° or more.
///
/// **Budgets.** A length, pixels at a view, a number of triangles, or several of these. A single surface without loops is
/// meshed by [`nurbs_to_mesh`].
///
/// **Cost.** About 2 µs a triangle, and some 50 evaluations for each vertex of a loop that meets another.
///
/// # Errors
/// [`Failure::Refused`]: as for [`nurbs_to_mesh`]; loops that cross, run backwards (outer loops run counter-clockwise) or
/// enclose nothing. [`Failure::Unmet`] with the nearest mesh; [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Budget, Job, Tolerance, check, convert};
/// use chordal::explicit::{Topology, nurbs::{NurbsCurve, NurbsSurface, TrimmedSurface}};
/// // A cylinder with its two lids, squares of which a circle is left.
/// let side = NurbsSurface::cone([1.0, 0.0], [1.0, 2.0])?;
/// let lid = |height: f64| -> Result<TrimmedSurface, Box<dyn std::error::Error>> {
///     let edge = NurbsCurve::line([-2.0, -2.0, height], [2.0, -2.0, height])?;
///     let square = NurbsSurface::extruded(&edge, [0.0, 4.0, 0.0])?;
///     let circle = NurbsCurve::circle([0.5, 0.5], [[0.25, 0.0], [0.0, 0.25]])?;
///     Ok(TrimmedSurface::new(square, vec![circle.to_curve()?])?)
/// };
/// let faces = [side.into(), lid(2.0)?, lid(0.0)?.flipped()];
/// let budget = Budget::length(Tolerance::new(1e-2)?);
/// let bounded = convert::trimmed_surfaces_to_mesh(&faces, &budget, &Job::default()).unwrap();
/// assert!(bounded.bound.at_most().unwrap() <= 1e-2);
/// assert!(check::validity(&bounded.shape, Topology::Positions).closed);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn trimmed_surfaces_to_mesh(
    faces: &[TrimmedSurface],
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    if let [only] = faces
        && only.is_whole()
    {
        return nurbs_to_mesh(std::slice::from_ref(only.surface()), budget, job);
    }
    budget.check_for_surfaces().map_err(Failure::Refused)?;
    check_surfaces(faces.iter().map(TrimmedSurface::surface))?;
    if budget.angle_deg.is_some() {
        let message = "trimmed surfaces cannot be meshed to an angle yet: give a length or pixels";
        return Err(Failure::refused(RefusalCode::Unsupported, message));
    }
    let all = faces.iter().map(TrimmedSurface::bounds);
    let bounds = all.reduce(|a, b| a.union(b)).unwrap_or(Box3::EMPTY);
    let by_view = budget.pixels.map(|px| length_from_pixels(&bounds, &px)).transpose()?;
    let length = match (by_view, budget.length.map(Tolerance::get)) {
        (Some(a), Some(b)) => Some(lesser(a, b)),
        (one, other) => one.or(other),
    };
    let slack = faces.iter().fold(0.0, |most: f64, face| greater(face.surface().slack(), most));
    // The length that remains for patches, polygons and triangles.
    let remaining = length.map(|length| if slack == 0.0 { length } else { sub_down(length, slack) });
    refuse_slack(slack, length)?;
    job.run(|| {
        let most = budget.triangles.map(|n| n as usize);
        let mut mesh = match (remaining, most) {
            (Some(length), None) => mesh_within(faces, length, &bounds, job)?,
            (Some(length), Some(most)) => {
                let mesh = mesh_within(faces, length, &bounds, job)?;
                if mesh.mesh.faces().len() <= most { mesh } else { within_count(faces, most, &bounds, job)? }
            }
            (None, Some(most)) => within_count(faces, most, &bounds, job)?,
            // A budget without a limit was refused.
            (None, None) => return Err(Failure::refused(RefusalCode::Budget, "a budget needs a limit")),
        };
        let is_few = most.is_none_or(|most| mesh.mesh.faces().len() <= most);
        mesh.at_most = with_slack(mesh.at_most, slack);
        let is_near = length.is_none_or(|length| mesh.at_most <= length);
        let mesh = with_bound(mesh, budget, &bounds);
        mesh.met_if(is_few && is_near)
    })
}

fn with_bound(trimmed: TrimmedMesh, budget: &Budget, bounds: &Box3) -> Bounded<Mesh> {
    let mut bound = Bound::proved(0.0, trimmed.at_most, Reference::NurbsSurfaces);
    let hull = Box3 {
        min: bounds.min.map(|x| sub_down(x, trimmed.at_most)),
        max: bounds.max.map(|x| add_up(x, trimmed.at_most)),
    };
    bound.pixels = budget.pixels.and_then(|px| px.view.pixels_of(trimmed.at_most, &hull));
    bound.at = trimmed.worst;
    Bounded { shape: trimmed.mesh, bound }
}

/// The mesh with the smallest bound among several lengths that has at most `most` triangles; if none has, the mesh with
/// the fewest.
fn within_count(
    faces: &[TrimmedSurface],
    most: usize,
    bounds: &Box3,
    job: &Job,
) -> Result<TrimmedMesh, Failure<Mesh>> {
    let mut length = FIRST * bounds.diagonal();
    let mut best: Option<TrimmedMesh> = None;
    // The longest length that gave too many triangles, and the shortest that did not.
    let (mut too_short, mut fits) = (0.0, f64::INFINITY);
    for _ in 0..TRIES {
        let mesh = mesh_within(faces, length, bounds, job)?;
        let n = mesh.mesh.faces().len();
        let is_few = n <= most;
        *(if is_few { &mut fits } else { &mut too_short }) = length;
        let is_better = best.as_ref().is_none_or(|best| {
            let before = best.mesh.faces().len();
            if is_few && before <= most { mesh.at_most < best.at_most } else { n < before }
        });
        if is_better {
            best = Some(mesh);
        }
        if is_few && n as f64 >= CLOSE * most as f64 {
            break;
        }
        // The number of triangles grows like 1/length.
        let next = length * n as f64 / (0.95 * most as f64);
        let is_between = next > too_short && next < fits;
        length = match (is_between, fits.is_finite()) {
            (true, _) => next,
            (false, true) => 0.5 * (too_short + fits),
            (false, false) => 2.0 * too_short,
        };
    }
    best.ok_or(Failure::Cancelled)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::validity;
    use crate::explicit::Topology;
    use crate::explicit::nurbs::{NurbsCurve, NurbsSurface};

    fn circle(radius: f64, turn: f64) -> crate::explicit::Curve<2> {
        let axes = [[radius, 0.0], [0.0, radius * turn]];
        NurbsCurve::circle([0.5, 0.5], axes).unwrap().to_curve().unwrap()
    }

    fn square(height: f64) -> NurbsSurface {
        let edge = NurbsCurve::line([-2.0, -2.0, height], [2.0, -2.0, height]).unwrap();
        NurbsSurface::extruded(&edge, [0.0, 4.0, 0.0]).unwrap()
    }

    /// A pipe: two walls and two rings.
    fn pipe() -> Vec<TrimmedSurface> {
        let wall = |r: f64| TrimmedSurface::from(NurbsSurface::cone([r, 0.0], [r, 2.0]).unwrap());
        let ring = |height: f64| {
            TrimmedSurface::new(square(height), vec![circle(0.25, 1.0), circle(0.125, -1.0)]).unwrap()
        };
        vec![wall(1.0), wall(0.5).flipped(), ring(2.0), ring(0.0).flipped()]
    }

    #[test]
    fn a_pipe_is_closed_and_within_its_bound() {
        for tol in [1e-1, 1e-2, 1e-3, 1e-4] {
            let budget = Budget::length(Tolerance::new(tol).unwrap());
            let made = trimmed_surfaces_to_mesh(&pipe(), &budget, &Job::default()).unwrap();
            let valid = validity(&made.shape, Topology::Positions);
            assert!(valid.closed && valid.edge_manifold && valid.oriented, "{tol} {valid:?}");
        }
    }
}
