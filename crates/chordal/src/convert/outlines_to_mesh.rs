//! The arrow from outlines to triangles in the plane z = 0: the areas that are inside by the outlines' fill rules.
use super::budget_search::{remaining_pixels, too_close};
use super::curves::flatten::Spacing;
use super::curves_to_polylines;
use super::upright_solid::upright_solid;
use crate::budget::{Bound, Bounded, Budget, Failure, Job, Progress, RefusalCode, Tolerance};
use crate::explicit::fill::arrange::{ArrangeError, GridContour, arrange};
use crate::explicit::fill::snap_grid::SnapGrid;
use crate::explicit::fill::sweep::InsideRule;
use crate::explicit::fill::{FillTriangles, fill};
use crate::explicit::{Curve, CurveEnds, CurveSegment, FillRule, Mesh, Outline, Polyline};
use crate::math::{Box3, add_up, greater, lesser, sub_down};

/// Turns outlines into triangles in the plane z = 0. The area of an outline is determined by its fill rule; its
/// contours may cross themselves and each other. Overlapping outlines stay separate, in their order.
///
/// **Bound.** Two-sided Hausdorff distance between each contour and the closed polyline that replaces it,
/// *proved*, rounding included. So a point that is inside an outline and not under its triangles, or the
/// other way round, is no farther than the bound from one of its contours.
///
/// **Triangles.** Counter-clockwise, all with area; those of one outline do not overlap, share vertices, and
/// have no T-junctions. Open contours are closed by a straight line. An outline thinner than the bound can
/// vanish.
///
/// **Budgets.** A length, pixels at a view, a number of triangles, or several of these.
///
/// **Cost.** That of the polylines, and O((n + k) log n) for n segments that cross k times: about 1 µs a segment.
///
/// # Errors
/// [`Failure::Refused`]: as for [`curves_to_polylines`]; a length below the grid to which contours are rounded,
/// 2⁻³⁶ of the largest outline's extent or the spacing of numbers there; so many overlapping segments that their
/// crossings are not counted. [`Failure::Unmet`] with the best mesh; [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Budget, Job, Tolerance, convert};
/// use chordal::explicit::{Arc, Curve, CurveEnds, CurveSegment, FillRule, Outline};
/// let circle = |r: f64| {
///     let turn = Arc::new([0.0, 0.0], [[r, 0.0], [0.0, r]], 0.0, 2.0 * std::f64::consts::PI).unwrap();
///     Curve::new(vec![CurveSegment::Arc(turn.with_ends([[r, 0.0]; 2]))], CurveEnds::Closed).unwrap()
/// };
/// let ring = Outline { contours: vec![circle(2.0), circle(1.0)], rule: FillRule::EvenOdd };
/// let budget = Budget::length(Tolerance::new(1e-3).unwrap());
/// let bounded = convert::outlines_to_mesh(&[ring], &budget, &Job::default()).unwrap();
/// let area = chordal::check::findings::measure(&bounded.shape).area;
/// assert!((area - 3.0 * std::f64::consts::PI).abs() < 1e-3 * 6.0 * std::f64::consts::PI);
/// ```
///
/// Source: see `explicit/fill`: J. D. Hobby, 1999, and S. Hertel and K. Mehlhorn, 1983.
pub fn outlines_to_mesh(
    outlines: &[Outline],
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    ClosedOutlines::new(outlines, None)?.mesh(budget, job)
}

/// Outlines whose contours are all closed.
pub(super) struct ClosedOutlines {
    contours: Vec<Curve<2>>,
    /// For each outline the number of its contours, and its rule.
    outlines: Vec<(usize, FillRule)>,
    grids: Vec<SnapGrid>,
    /// The height of the solid over the outlines; `None` if the plane areas are meshed.
    height: Option<f64>,
    bounds: Box3,
}

/// Turns a failure of polylines into one of meshes.
fn mesh_failure(failure: Failure<Vec<Polyline<2>>>) -> Failure<Mesh> {
    match failure {
        Failure::Unmet(best) => Failure::refused(
            RefusalCode::Budget,
            format!("the budget was not met; the best outlines are {}", best.bound),
        ),
        Failure::Refused(refusal) => Failure::Refused(refusal),
        Failure::Cancelled => Failure::Cancelled,
    }
}

/// Beyond this, squares of differences leave the range of numbers; polylines refuse it too.
const LARGEST: f64 = 1e150;
/// The most segment counts that are tried for a number of triangles. Chosen: each costs a mesh.
const TRIES: u32 = 32;

impl ClosedOutlines {
    pub fn new(outlines: &[Outline], height: Option<f64>) -> Result<Self, Failure<Mesh>> {
        let mut closed = Self {
            contours: Vec::new(),
            outlines: Vec::new(),
            grids: Vec::new(),
            height,
            bounds: Box3::EMPTY,
        };
        for (index, outline) in outlines.iter().enumerate() {
            let mut hull: Option<[[f64; 2]; 2]> = None;
            for contour in &outline.contours {
                let [low, high] = contour.bounds();
                if low.iter().chain(&high).any(|x| x.is_nan() || x.abs() >= LARGEST) {
                    let message =
                        format!("outline {index} has a coordinate that is not finite or beyond {LARGEST:e}");
                    return Err(Failure::refused(RefusalCode::NotFinite, message));
                }
                hull = Some(hull.map_or([low, high], |[l, h]| {
                    [
                        [lesser(l[0], low[0]), lesser(l[1], low[1])],
                        [greater(h[0], high[0]), greater(h[1], high[1])],
                    ]
                }));
                closed.contours.push(closed_contour(contour));
            }
            let hull = hull.unwrap_or_default();
            closed.outlines.push((outline.contours.len(), outline.rule));
            closed.grids.push(SnapGrid::new(hull));
            let [[x, y], [right, top]] = hull;
            let max = [right, top, height.unwrap_or(0.0)];
            closed.bounds = closed.bounds.union(Box3 { min: [x, y, 0.0], max });
        }
        Ok(closed)
    }

    /// A box around the outlines, or the solid over them.
    pub fn bounds(&self) -> &Box3 {
        &self.bounds
    }

    /// The triangles within a budget.
    pub fn mesh(&self, budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, Failure<Mesh>> {
        job.run(|| match (budget.length.is_some() || budget.pixels.is_some(), budget.triangles) {
            (false, None) => Err(Failure::refused(
                RefusalCode::Budget,
                "a budget for outlines needs a length, pixels at a view, or triangles",
            )),
            (true, None) => self.mesh_within(budget, job),
            (true, Some(most)) => {
                let without_count = Budget { triangles: None, ..*budget };
                match self.mesh_within(&without_count, job) {
                    Ok(mesh) if mesh.shape.faces().len() as u64 <= most => Ok(mesh),
                    Ok(_) => {
                        let best = self.by_count(most, job)?;
                        // The finest mesh with so few triangles may still be within the length.
                        let by_length = Budget { length: budget.length, ..Budget::default() };
                        let is_met = budget.pixels.is_none() && by_length.is_met_by(&best.bound);
                        best.met_if(is_met)
                    }
                    Err(failure) => Err(failure),
                }
            }
            (false, Some(most)) => self.by_count(most, job),
        })
    }

    /// The largest distance by which rounding to the grids moves a point.
    fn snapping_error(&self) -> f64 {
        let errors = self.grids.iter().map(SnapGrid::moved_at_most);
        errors.fold(0.0, |most: f64, lost| greater(lost, most))
    }

    fn mesh_within(&self, budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, Failure<Mesh>> {
        let snapping = self.snapping_error();
        let polyline_budget = self.polyline_budget(budget, snapping)?;
        let polylines = curves_to_polylines(&self.contours, &polyline_budget, job, Spacing::Fewest)
            .map_err(mesh_failure)?;
        self.fill(polylines, budget, job)
    }

    /// The budget of the polylines: the given one, less the error of rounding to the grid.
    fn polyline_budget(&self, budget: &Budget, lost: f64) -> Result<Budget, Failure<Mesh>> {
        let too_small = |asked: String| {
            let message = format!(
                "{asked} is less than the error {lost:.1e} of rounding outlines of this size to a grid"
            );
            Failure::refused(RefusalCode::BelowPrecision, message)
        };
        let mut inner = *budget;
        if let Some(length) = budget.length {
            let remaining = Tolerance::new(sub_down(length.get(), lost));
            inner.length = Some(remaining.map_err(|_| too_small(length.to_string()))?);
        }
        if let Some(px) = budget.pixels {
            px.view.pixels_of(lost, &self.bounds).ok_or_else(|| too_close("drawing"))?;
            let remaining = remaining_pixels(&px, lost, &self.bounds);
            inner.pixels = Some(remaining.ok_or_else(|| too_small(px.pixels.to_string()))?);
        }
        Ok(inner)
    }

    /// The mesh of the finest polylines found that has at most `most` triangles.
    fn by_count(&self, most: u64, job: &Job) -> Result<Bounded<Mesh>, Failure<Mesh>> {
        let flatten = |segments: u64| match curves_to_polylines(
            &self.contours,
            &Budget::segments(segments),
            job,
            Spacing::Fewest,
        ) {
            Err(Failure::Unmet(best)) => Ok((false, *best)),
            Ok(polylines) => Ok((true, polylines)),
            Err(other) => Err(mesh_failure(other)),
        };
        // 1. A polygon of n corners has n − 2 triangles, and two more for each hole: start with that many
        // segments. A solid has these triangles twice, and two more for each side.
        let each = if self.height.is_some() { 4 } else { 1 };
        let (mut fits, mut fails) = (None, None::<u64>);
        let mut segments = (most / each).saturating_add(2);
        for _ in 0..TRIES {
            let (is_met, polylines) = flatten(segments)?;
            let mesh = self.fill(polylines, &Budget::default(), job)?;
            let n = mesh.shape.faces().len() as u64;
            if n <= most {
                // 2. Add segments while more triangles are allowed.
                let spare = (most - n) / each;
                let stop = spare == 0 || fails.is_some_and(|fails| fails <= segments + 1);
                fits = Some((segments, mesh));
                if stop {
                    break;
                }
                segments = match fails {
                    Some(fails) => segments + (fails - segments) / 2,
                    None => segments.saturating_add(spare),
                };
            } else if !is_met {
                // Even the fewest possible segments give too many triangles.
                return match fits {
                    Some((_, best)) => Ok(best),
                    None => Err(Failure::Unmet(Box::new(mesh))),
                };
            } else {
                fails = Some(segments);
                let excess = (n - most).div_ceil(each);
                let low = fits.as_ref().map_or(1, |(fits, _)| fits + 1);
                if low >= segments {
                    break;
                }
                let guess = segments.saturating_sub(excess);
                segments = if guess > low { guess } else { low + (segments - low) / 2 };
            }
        }
        match fits {
            Some((_, best)) => Ok(best),
            None => Err(Failure::Unmet(Box::new(self.fill(flatten(1)?.1, &Budget::default(), job)?))),
        }
    }

    /// Triangulates polylines, and bounds the error of both steps.
    fn fill(
        &self,
        polylines: Bounded<Vec<Polyline<2>>>,
        budget: &Budget,
        job: &Job,
    ) -> Result<Bounded<Mesh>, Failure<Mesh>> {
        let lost = self.snapping_error();
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        let mut remaining = polylines.shape.as_slice();
        let total = self.outlines.len() as u64;
        for (index, ((n, rule), grid)) in self.outlines.iter().zip(&self.grids).enumerate() {
            if job.is_cancelled() {
                return Err(Failure::Cancelled);
            }
            let (contours, after) = remaining.split_at(*n);
            remaining = after;
            let filled =
                fill_outline(contours, *rule, grid, job).map_err(|error| fill_failure(error, index))?;
            append(&filled, grid, &mut positions, &mut faces)?;
            job.report(Progress { stage: "fill", done: index as u64 + 1, total });
        }
        if let Some(height) = self.height {
            (positions, faces) = upright_solid(&positions, &faces, height)?;
        }
        let mesh = Mesh::new(positions, faces)
            .map_err(|error| Failure::refused(RefusalCode::TooManyTriangles, error.to_string()))?;
        let polyline_bound = polylines.bound;
        // Rounding to the grid may have moved the lines nearer to the curves, or farther away.
        let at_most = add_up(polyline_bound.at_most().unwrap_or(0.0), lost);
        let at_least = sub_down(polyline_bound.at_least(), lost);
        let at_least = greater(at_least, 0.0);
        let mut bound = Bound::proved(at_least, at_most, polyline_bound.reference);
        bound.at = polyline_bound.at;
        bound.pixels = match (budget.pixels, polyline_bound.pixels) {
            (Some(px), Some(pixels)) => {
                let lost_px = px.view.pixels_of(lost, &self.bounds);
                lost_px.and_then(|lost_px| px.view.pixels_of_two_steps(pixels, lost_px))
            }
            _ => None,
        };
        Ok(Bounded { shape: mesh, bound })
    }
}

/// The reason why an outline cannot be filled.
enum OutlineFillError {
    Stop(ArrangeError),
    Areas,
}

fn fill_outline(
    polylines: &[Polyline<2>],
    rule: FillRule,
    grid: &SnapGrid,
    job: &Job,
) -> Result<FillTriangles, OutlineFillError> {
    let snapped = |line: &Polyline<2>| GridContour {
        points: line.points.iter().map(|p| grid.snap(*p)).collect(),
        kind: 0,
    };
    let contours: Vec<_> = polylines.iter().map(snapped).collect();
    let edges = arrange(&contours, job).map_err(OutlineFillError::Stop)?;
    fill(&edges, InsideRule::Fill(rule)).ok_or(OutlineFillError::Areas)
}

fn fill_failure(error: OutlineFillError, index: usize) -> Failure<Mesh> {
    match error {
        OutlineFillError::Stop(ArrangeError::Cancelled) => Failure::Cancelled,
        OutlineFillError::Stop(ArrangeError::TooManyPairs) => Failure::refused(
            RefusalCode::TooManyTriangles,
            format!("so many segments of outline {index} overlap that their crossings are not computed"),
        ),
        OutlineFillError::Areas => Failure::refused(
            RefusalCode::Unsupported,
            format!(
                "the triangles of outline {index} do not have the area that it encloses: a fault in the program"
            ),
        ),
    }
}

/// Appends the triangles of one outline, with their points.
fn append(
    filled: &FillTriangles,
    grid: &SnapGrid,
    positions: &mut Vec<[f64; 3]>,
    faces: &mut Vec<[u32; 3]>,
) -> Result<(), Failure<Mesh>> {
    const NONE: u32 = u32::MAX;
    let mut number = vec![NONE; filled.points.len()];
    for triangle in &filled.triangles {
        let mut face = [0; 3];
        for (corner, i) in face.iter_mut().zip(triangle) {
            let row = &mut number[*i as usize];
            if *row == NONE {
                *row = u32::try_from(positions.len()).ok().filter(|n| *n < NONE).ok_or_else(|| {
                    Failure::refused(RefusalCode::TooManyTriangles, "more vertices than 2^32 - 1")
                })?;
                let [x, y] = grid.restore(filled.points[*i as usize]);
                positions.push([x, y, 0.0]);
            }
            *corner = *row;
        }
        faces.push(face);
    }
    Ok(())
}

/// Closes a contour with a straight line back to its start, if it needs one.
fn closed_contour(contour: &Curve<2>) -> Curve<2> {
    let (start, end) = (contour.start(), contour.end());
    if contour.is_closed() || contour.segments().is_empty() {
        return contour.clone();
    }
    let mut pieces = contour.segments().to_vec();
    if end != start {
        pieces.push(CurveSegment::Line([end, start]));
    }
    // The old pieces join as before, and the new piece by construction.
    Curve::new(pieces, CurveEnds::Closed)
        .map_or_else(|_| contour.clone(), |closed| closed.with_slack(contour.slack()))
}
