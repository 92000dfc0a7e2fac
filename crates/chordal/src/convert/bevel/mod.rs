//! The arrow from outlines to bevelled solids: their filled regions, raised to a height, with the upper and lower edges cut
//! off at 45°.
mod border;
mod plane;
mod roof;

use super::budget_search::length_within;
use super::outlines_to_mesh::outlines_to_mesh;
use super::outlines_to_solid::LARGEST;
use super::upright_solid::FanFaces;
use crate::budget::{Bound, Bounded, Budget, Evidence, Failure, Job, Reference, RefusalCode, Tolerance};
use crate::explicit::{Mesh, Outline};
use crate::math::{Box3, add_up, greater, lesser, mul_up, sub_down};
use roof::{Roof, RoofLimits};

/// The share of the error for the polygons that replace contours; the rest is for the bevel over these. Chosen: with it,
/// letters take about the fewest triangles.
const FLAT_SHARE: f64 = 0.375;

/// The height of a bevelled solid, and the width of its bevels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bevel {
    /// The solid is between z = 0 and this.
    pub height: f64,
    /// The reach of the bevels into the region, and down and up the walls. Below half of the height.
    pub width: f64,
}

/// Turns outlines into solids between the planes z = 0 and z = `height`, as
/// [`outlines_to_solid`](super::outlines_to_solid), whose edges at both planes are cut off at 45°: over a point of the
/// region that is `d` from its border, the solid ends `width − d` below the upper plane, and above the lower one as
/// much, if `d` is less than the width. In a part narrower than two widths, bevels meet in a ridge. Outer corners get
/// flats that meet in an edge, inner corners a part of a cone.
///
/// **Bound.** Two-sided Hausdorff distance to the surface of that solid, rounding included: √2 times the distance of the
/// polygons from the contours, and the distance of the triangles from the bevel over the polygons. *Proved* if no part of the
/// region and no gap in it comes or goes with the polygons, that is, if their borders are as near to each other as the
/// contours are.
///
/// **Triangles.** The solid is closed, each edge has two triangles, and all face outwards. Solids of different outlines
/// stay separate.
///
/// **Budgets.** A length, or pixels at a view.
///
/// **Cost.** About 25 µs a triangle.
///
/// # Errors
/// [`Failure::Refused`]: as for [`outlines_to_solid`](super::outlines_to_solid); a width that is not above 0 and below half
/// of the height; a budget of triangles. [`Failure::Unmet`] with the best mesh; [`Failure::Cancelled`].
///
/// ```
/// use chordal::convert::{self, bevels::Bevel};
/// use chordal::explicit::{Curve, CurveEnds, CurveSegment, FillRule, Outline};
/// use chordal::{Budget, Job, Tolerance};
/// let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
/// let sides = corners.windows(2).map(|ends| CurveSegment::Line([ends[0], ends[1]])).collect();
/// let outline = Outline { contours: vec![Curve::new(sides, CurveEnds::Closed)?], rule: FillRule::NonZero };
/// let budget = Budget::length(Tolerance::new(1e-3)?);
/// let bevel = Bevel { height: 3.0, width: 1.0 };
/// let block = convert::outlines_to_bevelled_solid(&[outline], bevel, &budget, &Job::default()).expect("reachable").shape;
/// // Two frustums of a pyramid on a plate.
/// let volume = 2.0 * (16.0 + 4.0 + 8.0) / 3.0 + 16.0;
/// assert!((chordal::check::findings::measure(&block).signed_volume - volume).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn outlines_to_bevelled_solid(
    outlines: &[Outline],
    bevel: Bevel,
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let Bevel { height, width } = bevel;
    let refused = |message: String| Failure::refused(RefusalCode::Budget, message);
    if !(height > 0.0 && height < LARGEST) {
        return Err(refused(format!(
            "a solid over outlines has a height above 0 and below {LARGEST:e}, not {height}"
        )));
    }
    if !(width > 0.0 && width < 0.5 * height) {
        return Err(refused(format!(
            "a bevel is wider than 0 and narrower than half of the height {height}, not {width}"
        )));
    }
    if budget.triangles.is_some() {
        return Err(refused(
            "a bevelled solid takes a length or pixels at a view, not a number of triangles".into(),
        ));
    }
    let place = solid_box(outlines, height);
    let length = length_within(budget, &place, "solid")?
        .ok_or_else(|| refused("a budget for bevelled solids needs a length or pixels at a view".into()))?;
    job.run(|| {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        let (mut most, mut is_met) = (0.0, true);
        for outline in outlines {
            let solid = solid(outline, bevel, length.get(), job)?;
            let first = u32::try_from(positions.len()).ok();
            let first = first.filter(|first| solid.positions.len() < (u32::MAX - first) as usize);
            let first = first.ok_or_else(|| {
                Failure::refused(RefusalCode::TooManyTriangles, "the solid has more vertices than 2^32 - 1")
            })?;
            positions.extend(solid.positions);
            faces.extend(solid.faces.into_iter().map(|face| face.map(|i| i + first)));
            most = greater(most, solid.error);
            is_met &= solid.error <= length.get();
        }
        let mesh = Mesh::new(positions, faces)
            .map_err(|error| Failure::refused(RefusalCode::TooManyTriangles, error.to_string()))?;
        let promise =
            "no part of the outlines and no gap in them appears or vanishes in the polygons that replace them";
        let evidence = Evidence::ProvedIf(vec![promise.into()]);
        let mut bound = Bound::with_evidence(0.0, Some(most), evidence, Reference::Curves);
        bound.pixels = budget.pixels.as_ref().and_then(|asked| asked.view.pixels_of(most, &place));
        let bounded = Bounded { shape: mesh, bound };
        bounded.met_if(is_met)
    })
}

/// The box of solids over outlines.
fn solid_box(outlines: &[Outline], height: f64) -> Box3 {
    outlines.iter().flat_map(|outline| &outline.contours).fold(Box3::EMPTY, |all, contour| {
        let [[x, y], [right, top]] = contour.bounds();
        all.union(Box3 { min: [x, y, 0.0], max: [right, top, height] })
    })
}

/// The solid over one outline.
struct BevelledSolid {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    error: f64,
}

fn solid(outline: &Outline, bevel: Bevel, length: f64, job: &Job) -> Result<BevelledSolid, Failure<Mesh>> {
    let Bevel { height, width } = bevel;
    let share = Tolerance::new(FLAT_SHARE * length)
        .map_err(|error| Failure::refused(RefusalCode::BelowPrecision, error.to_string()))?;
    let flat = outlines_to_mesh(std::slice::from_ref(outline), &Budget::length(share), job)?;
    // Derived: let d be the distance of the borders. The distances of a common point of both regions from the two borders
    // differ by at most d, and a point of only one region is within d of both borders: at most √2·d in plane and height.
    let of_polygons = mul_up(std::f64::consts::SQRT_2.next_up(), flat.bound.at_most().unwrap_or(0.0));
    let fans = FanFaces::new(flat.shape.faces());
    let point = |i: &u32| {
        let [x, y, _] = flat.shape.positions()[*i as usize];
        [x, y]
    };
    let points: Vec<[f64; 2]> = fans.origins.iter().map(point).collect();
    let reach = points.as_flattened().iter().fold(height, |most, x| greater(most, x.abs()));
    // Derived: distances and lengths along directions take fewer than 40 roundings of at most four times the largest
    // coordinate, and heights two; each is 2⁻⁵³ of it.
    // Squares below the least number vanish, and with them lengths below 2⁻⁵³⁶.
    let rounding = 128.0 * f64::EPSILON * reach + 1e-160;
    let allowed = sub_down(length, of_polygons);
    // Chosen: a budget is in reach if rounding takes at most a quarter of it.
    if allowed < 4.0 * rounding {
        let message = format!(
            "{length:e} is less than the possible rounding error of solids of this size, {rounding:.1e}"
        );
        return Err(Failure::refused(RefusalCode::BelowPrecision, message));
    }
    let limits = RoofLimits { width, rounding, allowed };
    let mut roof = Roof::new(points, &fans.faces, &fans.border, limits, job);
    roof.bend(&fans.border)?;
    roof.refine()?;
    let n = roof.plane.n_triangles() as u32;
    let of_roof = (0..n).fold(0.0, |most, t| greater(most, roof.error(t)));
    let points = roof.plane.points.iter().zip(&roof.heights);
    let lower = points.clone().map(|(p, h)| [p[0], p[1], width - h]);
    // The same numbers at the top as in the walls: the height of the border is 0.
    let upper = points.map(|(p, h)| [p[0], p[1], lesser(height, (height - width) + h)]);
    let n_points =
        u32::try_from(roof.plane.points.len()).ok().filter(|n| *n < u32::MAX / 2).ok_or_else(|| {
            Failure::refused(RefusalCode::TooManyTriangles, "the solid has more vertices than 2^32 - 1")
        })?;
    let top = |i: u32| i + n_points;
    let mut faces = Vec::with_capacity(2 * (n as usize + fans.border.len()));
    faces.extend((0..n).map(|t| roof.plane.triangle(t)).map(|[a, b, c]| [a, c, b]));
    faces.extend((0..n).map(|t| roof.plane.triangle(t).map(top)));
    faces.extend(fans.border.iter().flat_map(|[a, b]| [[*a, *b, top(*b)], [*a, top(*b), top(*a)]]));
    // Sums of heights are rounded once more.
    let error = add_up(of_polygons, add_up(of_roof, rounding));
    Ok(BevelledSolid { positions: lower.chain(upper).collect(), faces, error })
}
