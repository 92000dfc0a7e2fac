//! The signed distance to a mesh, as a leaf of fields.
use super::open_boundary::OpenBoundary;
use crate::budget::{Bound, Evidence, Job, JobError, par_map, par_map_owned};
use crate::explicit::{Bvh, Mesh, PointLocation, WindingMoments, closest_on_triangle};
use crate::implicit::{Leaf, LeafAnswer, LeafError};
use crate::math::{
    Box3, Interval, add_up, difference, greater, length, mul_down, mul_up, sqrt_up, sub_down, sub_up,
};
use std::sync::Arc;

/// Points in a task: at a microsecond each, enough to repay its start, and few enough for an even balance.
const TASK: usize = 1024;
/// The errors within which a winding number near a half is computed, one after the other, before it is summed
/// triangle by triangle. Chosen: each costs several times as much as the one before.
const WITHIN: [f64; 3] = [1.0 / 16.0, 1.0 / 256.0, 1.0 / 4096.0];

/// A mesh with its bounding volume hierarchy and its winding moments.
#[derive(Clone, Debug)]
pub(super) struct MeshLeaf {
    bvh: Bvh,
    /// `None` for wires, which have no inside.
    moments: Option<WindingMoments>,
    job: Job,
    /// The error of distances, proportional to the mesh's own size.
    rounding: f64,
    /// The open edges, around which the side changes without a triangle.
    border: OpenBoundary,
    /// Points around an open mesh with known sides.
    beacons: Option<Arc<Beacons>>,
    /// The mesh, if it is kept.
    source: Option<Arc<MeshSource>>,
}

/// The mesh of a leaf, with facts about it.
#[derive(Clone, Debug)]
pub(super) struct MeshSource {
    pub mesh: Mesh,
    /// Whether its triangles are the boundary of its inside.
    pub is_solid: bool,
    /// Its distance from the surface that it stands for, if it stands for another.
    pub lost: Option<Bound>,
}

/// A step away from the nearest triangle, as a fraction of its distance. Chosen: the next ball is then nearly twice
/// as large, and contains the step with a margin for rounding.
const CLIMB: f64 = 0.9;
/// The least growth of a ball for which a further step is tried. Chosen: each step costs a closest-point query.
const GROWN: f64 = 1.25;
/// The most steps. Chosen: then balls have grown by a thousand.
const MOST_CLIMBS: usize = 12;

/// Points on a lattice over the box of an open mesh, with their sides. They are computed once, so that no query depends
/// on earlier ones.
#[derive(Clone, Debug)]
struct Beacons {
    low: [f64; 3],
    step: f64,
    size: [usize; 3],
    moments: Vec<Option<OpenSide>>,
}

/// Beacons along the longest side. Chosen: all of them take as long as a hundredth of a mesh's lattice.
const BEACONS: f64 = 24.0;

impl Beacons {
    /// The beacons at the corners of the cell around a point.
    fn around(&self, p: [f64; 3]) -> impl Iterator<Item = &OpenSide> {
        let first: [usize; 3] = std::array::from_fn(|k| {
            let cell = ((p[k] - self.low[k]) / self.step).floor().clamp(0.0, self.size[k] as f64 - 1.0);
            // Clamped, hence in range.
            cell as usize
        });
        (0..8_usize).filter_map(move |corner| {
            let at: [usize; 3] =
                std::array::from_fn(|k| (first[k] + (corner >> k & 1)).min(self.size[k] - 1));
            self.moments[at[0] + self.size[0] * (at[1] + self.size[1] * at[2])].as_ref()
        })
    }
}

/// A point away from the triangles of an open mesh, and its side.
#[derive(Clone, Copy, Debug)]
struct OpenSide {
    point: [f64; 3],
    /// No triangle is nearer.
    distance: f64,
    /// A lower bound of the difference between its winding number and a half.
    margin: f64,
    is_inside: bool,
}

/// The result at the previous point, which speeds up the query at the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct PreviousPoint {
    point: [f64; 3],
    distance: f64,
    inside: bool,
    row: u32,
}

impl MeshLeaf {
    pub(super) fn new(mesh: &Mesh, job: &Job) -> Result<Self, JobError> {
        let mut leaf = Self::unsigned(mesh, job)?;
        leaf.moments = Some(WindingMoments::new(mesh, &leaf.bvh));
        if !leaf.is_closed() {
            leaf.border = OpenBoundary::new(mesh);
            leaf.beacons = leaf.place_beacons().map(Arc::new);
        }
        Ok(leaf)
    }

    /// The same leaf, with its mesh.
    pub(super) fn with_source(self, source: MeshSource) -> Self {
        Self { source: Some(Arc::new(source)), ..self }
    }

    /// Its mesh, if it was kept.
    pub(super) fn source(&self) -> Option<&MeshSource> {
        self.source.as_deref()
    }

    /// Whether it has an inside; wires have none.
    pub(super) fn has_sides(&self) -> bool {
        self.moments.is_some()
    }

    /// A leaf of the unsigned distance: no point is inside.
    pub(super) fn unsigned(mesh: &Mesh, job: &Job) -> Result<Self, JobError> {
        let bvh = Bvh::build(mesh, job)?;
        // The error is a few units in the last place of the extent; 64 are far more, and cover the rounding of
        // coordinates.
        let bounds = bvh.bounds();
        let largest = bounds.min.iter().chain(&bounds.max).fold(0.0, |m: f64, x| greater(x.abs(), m));
        let rounding =
            if bounds.is_empty() { 0.0 } else { 64.0 * f64::EPSILON * (largest + bounds.diagonal()) };
        let border = OpenBoundary::default();
        Ok(Self { bvh, moments: None, job: job.clone(), rounding, border, beacons: None, source: None })
    }

    /// Whether the side changes at triangles only.
    pub(super) fn is_closed(&self) -> bool {
        self.moments.as_ref().is_none_or(|moments| moments.enclosure(&self.bvh).is_closed())
    }

    /// Whether `p` is inside; never beyond the box of the triangles.
    pub(super) fn is_inside(&self, p: [f64; 3]) -> bool {
        let Some(moments) = self.moments.as_ref().filter(|_| self.bvh.bounds().contains(p)) else {
            return false;
        };
        let enclosure = moments.enclosure(&self.bvh);
        let located = enclosure.inside(p);
        match located.side {
            PointLocation::Inside => true,
            PointLocation::Outside | PointLocation::On => false,
            PointLocation::Ambiguous => {
                let mut winding = located.winding;
                for within in [WITHIN[1], WITHIN[2], 0.0] {
                    if (winding.value - 0.5).abs() > winding.off_at_most {
                        break;
                    }
                    winding = enclosure.winding_number(p, within).unwrap_or(winding);
                }
                winding.value > 0.5
            }
        }
    }

    /// The side of all points of the ball around `p`, if it is certain: no triangle is nearer than `distance`, which
    /// is more than the radius, and the winding number does not reach a half in the ball. `known` are earlier points with
    /// their sides, which often decide.
    fn side_of_ball(
        &self,
        (p, radius): ([f64; 3], f64),
        (distance, row): (f64, u32),
        known: &mut [Option<OpenSide>; 2],
    ) -> Option<bool> {
        let bounds = self.bvh.bounds();
        let gap = |k: usize| greater(sub_down(bounds.min[k], p[k]), sub_down(p[k], bounds.max[k]));
        // Nothing beyond the box of the triangles is inside. A gap has an error of less than four units in its last place.
        let beyond = (0..3).any(|k| gap(k) > radius);
        let within = (0..3).all(|k| gap(k) < -radius * (1.0 + 8.0 * f64::EPSILON));
        if beyond {
            return Some(false);
        }
        if distance <= radius {
            return None;
        }
        let is_inside = self.side_of_point((p, radius), (distance, row), known)?;
        // Beyond the box all points are outside; so a ball that is inside has to be within it.
        (!is_inside || within).then_some(is_inside)
    }

    /// The beacons: lattice points at which the winding number is proved to differ from a half. `None` for a mesh without
    /// extent.
    fn place_beacons(&self) -> Option<Beacons> {
        let Box3 { min: low, max } = self.bvh.bounds();
        let longest = (0..3).fold(0.0, |most, k| greater(max[k] - low[k], most));
        let step = longest / BEACONS;
        if !(step > 0.0 && step.is_finite()) {
            return None;
        }
        let size: [usize; 3] = std::array::from_fn(|k| ((max[k] - low[k]) / step).ceil() as usize + 1);
        let n: usize = size.iter().product();
        let enclosure = self.moments.as_ref()?.enclosure(&self.bvh);
        let rows: Vec<usize> = (0..n).collect();
        let moments = par_map(&self.job, &rows, |_, row| {
            let at = [row % size[0], row / size[0] % size[1], row / (size[0] * size[1])];
            let point: [f64; 3] = std::array::from_fn(|k| low[k] + step * at[k] as f64);
            let (distance, _) = self.bvh.distance_with_hint(point, 0)?;
            let distance = sub_down(distance, self.distance_error(point));
            let winding = enclosure.winding_number(point, WITHIN[0]).filter(|_| distance > 0.0)?;
            let margin = sub_down((winding.value - 0.5).abs(), winding.off_at_most);
            (margin > 0.0).then_some(OpenSide { point, distance, margin, is_inside: winding.value > 0.5 })
        });
        Some(Beacons { low, step, size, moments })
    }

    /// The side of all points within `radius` of `p`, all of them off the triangles, by the winding number.
    ///
    /// Winding numbers cost far more than distances, most of all near triangles. So the point climbs away from its
    /// nearest triangle, from one empty ball to the next: along the path the winding number changes by no more than
    /// the open edges allow. If the path meets the ball of a point with a known side, that point decides.
    ///
    /// ```text
    ///        . - ~ - .
    ///     .      at     .     each ball is empty and overlaps the one before;
    ///    .      /        .    path = radius + length of the steps so far
    ///     . .  p  .  .  .
    /// ________\_/____________ triangles
    /// ```
    fn side_of_point(
        &self,
        (p, radius): ([f64; 3], f64),
        (distance, row): (f64, u32),
        known: &mut [Option<OpenSide>; 2],
    ) -> Option<bool> {
        // A factor far above all roundings of the distances and of their sums.
        const SHARE: f64 = 1.0 + 1.0 / (1_u64 << 30) as f64;
        let (mut at, mut empty, mut row, mut path) = (p, distance, row, radius);
        for _ in 0..MOST_CLIMBS {
            let beacons = self.beacons.iter().flat_map(|beacons| beacons.around(at));
            let decisive = known.iter().flatten().chain(beacons).find(|other| {
                let between = length(difference(at, other.point)) * SHARE;
                between < other.distance + empty
                    && self.border.most_change(other.point, (between + path) * SHARE) < other.margin
            });
            if let Some(other) = decisive {
                return Some(other.is_inside);
            }
            let offset = self.offset(at, row);
            let size = length(offset);
            // CLIMB < 1 keeps the step within the empty ball in spite of rounding.
            let step = CLIMB * empty;
            let next: [f64; 3] = std::array::from_fn(|k| at[k] + step * (offset[k] / size));
            let Some((next_distance, nearest)) = self.bvh.distance_with_hint(next, row) else { break };
            let next_distance = sub_down(next_distance, self.distance_error(next));
            // The ball stops growing as soon as another triangle is as near.
            let is_larger = next_distance > GROWN * empty;
            if !is_larger {
                break;
            }
            path = (path + length(difference(next, at))) * SHARE;
            (at, empty, row) = (next, next_distance, nearest);
        }
        let enclosure = self.moments.as_ref()?.enclosure(&self.bvh);
        // Winding numbers are cheaper away from the triangles, but on the way there they change, too. So the
        // point itself comes second.
        for (from, empty, path) in [(at, empty, path), (p, distance, radius)] {
            let change = self.border.most_change(from, path);
            if change.is_nan() || change >= 1.0 {
                continue;
            }
            for within in WITHIN {
                let Some(winding) = enclosure.winding_number(from, within) else { continue };
                let margin = sub_down((winding.value - 0.5).abs(), winding.off_at_most);
                if margin > change {
                    let is_inside = winding.value > 0.5;
                    // One for each side: the next balls are often near the last one of their side.
                    known[usize::from(is_inside)] =
                        Some(OpenSide { point: from, distance: empty, margin, is_inside });
                    return Some(is_inside);
                }
                // More digits cannot raise the margin above the change.
                if (winding.value - 0.5).abs() + winding.off_at_most <= change {
                    break;
                }
            }
        }
        None
    }

    /// The distance and side at `p`, to be passed to the next query; `None` without triangles or for a point that is
    /// not finite.
    pub(super) fn step(&self, p: [f64; 3], last: Option<PreviousPoint>) -> Option<PreviousPoint> {
        self.step_within(p, last, f64::INFINITY)
    }

    /// [`MeshLeaf::step`], but if no triangle is within `reach`, the distance is `reach`, rounded.
    pub(super) fn step_within(
        &self,
        p: [f64; 3],
        last: Option<PreviousPoint>,
        reach: f64,
    ) -> Option<PreviousPoint> {
        let (distance, row) = self.bvh.distance_within(p, last.map_or(0, |last| last.row), reach)?;
        let inside = match last {
            // Two overlapping balls without triangles lie on one side, if the mesh is closed.
            Some(last) if self.is_on_same_side(&last, p, distance) => last.inside,
            _ => self.is_inside(p),
        };
        Some(PreviousPoint { point: p, distance, inside, row })
    }

    /// Whether the empty balls around two points certainly overlap, and sides only change at triangles.
    fn is_on_same_side(&self, last: &PreviousPoint, p: [f64; 3], distance: f64) -> bool {
        // A factor far above all roundings of the distances and of their sum.
        const SHARE: f64 = 1.0 + 1.0 / (1_u64 << 30) as f64;
        let between = length(difference(p, last.point));
        self.is_closed() && between * SHARE + 4.0 * self.rounding < last.distance + distance
    }

    /// The largest error of the computed distance at `p`.
    fn distance_error(&self, p: [f64; 3]) -> f64 {
        let size = p.iter().fold(0.0, |m: f64, x| greater(x.abs(), m));
        // 64 units in the last place: far more than the roundings of a point and of its offsets.
        add_up(self.rounding, 64.0 * f64::EPSILON * size)
    }

    fn sample(&self, points: &[[f64; 3]], out: &mut [f64]) {
        let mut last = None;
        for (p, value) in points.iter().zip(out) {
            match self.step(*p, last) {
                Some(here) => {
                    *value = here.value();
                    last = Some(here);
                }
                None => *value = if p.iter().all(|x| x.is_finite()) { f64::MAX } else { f64::NAN },
            }
        }
    }

    /// `p` minus its closest point on a triangle.
    fn offset(&self, p: [f64; 3], row: u32) -> [f64; 3] {
        let (corners, _) = self.bvh.triangle_of(row);
        let w = closest_on_triangle(p, corners);
        std::array::from_fn(|k| {
            (w[0] * (p[k] - corners[0][k]) + w[1] * (p[k] - corners[1][k])) + w[2] * (p[k] - corners[2][k])
        })
    }

    fn gradient_near(&self, p: [f64; 3], last: Option<PreviousPoint>) -> ([f64; 3], Option<PreviousPoint>) {
        let Some(here) = self.step(p, last) else { return ([f64::NAN; 3], None) };
        let sign = if here.inside { -1.0 } else { 1.0 };
        let offset = self.offset(p, here.row);
        let size = length(offset);
        let gradient = if size > self.rounding {
            offset.map(|x| sign * (x / size))
        } else {
            // On a triangle the gradient is its normal.
            let (corners, _) = self.bvh.triangle_of(here.row);
            let n =
                crate::math::cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
            let size = length(n);
            n.map(|x| if size > 0.0 { x / size } else { 0.0 })
        };
        (gradient, Some(here))
    }

    /// A proved lower and upper bound of the distance from `p`.
    fn distance_range(&self, p: [f64; 3], row: u32) -> Option<[f64; 2]> {
        Some([self.bvh.closest_distance_down(p)?, self.bvh.distance_bounds(p, row)?[1]])
    }

    /// A range of the gradient in a box, from the triangles that may be nearest to one of its points.
    ///
    /// The gradient is `±(p − q)/|p − q|` with the closest point `q` of some triangle, and the offset from
    /// the closest point of a convex set changes by no more than `p` moves. A triangle that is nearest for
    /// some point of the box is no farther from the middle than the nearest one there plus the box's
    /// diameter.
    ///
    /// A computed closest point `q'` lies on the triangle, up to rounding, but not always near `q`. Since the angle
    /// at `q` is not acute, `|q − q'|² ≤ |p − q'|² − |p − q|²`, where the last term is bounded from below.
    fn gradient_range(&self, bounds: &Box3) -> [Interval; 3] {
        let unit = Interval::new(-1.0, 1.0).unwrap_or(Interval::ENTIRE);
        let middle = bounds.centre();
        let error = self.distance_error(middle);
        let radius = add_up(0.5 * bounds.diagonal(), error);
        let Some(here) = self.step(middle, None).filter(|_| radius.is_finite()) else { return [unit; 3] };
        let Some([_, nearest]) = self.bvh.distance_bounds(middle, here.row) else { return [unit; 3] };
        let reach = add_up(nearest, 2.0 * radius);
        let mut hull: Option<[Interval; 3]> = None;
        let mut touched = false;
        self.bvh.rows_near(middle, add_up(reach, error), |row| {
            let [down, _] = self.bvh.distance_bounds(middle, row).unwrap_or([0.0; 2]);
            if down > reach {
                return;
            }
            touched |= down <= radius;
            let offset = self.offset(middle, row);
            let size = length(offset);
            let most = add_up(size, error);
            let slack = sub_up(mul_up(most, most), mul_down(down, down));
            let along_triangle = sqrt_up(greater(slack, 0.0));
            let radius_of_offsets = add_up(radius, add_up(along_triangle, error));
            let around = |x: f64| {
                Interval::new(sub_down(x, radius_of_offsets), add_up(x, radius_of_offsets))
                    .unwrap_or(Interval::ENTIRE)
            };
            let sizes = around(size);
            let directions =
                offset.map(|x| if sizes.lo() > 0.0 { (around(x) / sizes).intersection(unit) } else { unit });
            hull = Some(hull.map_or(directions, |all| std::array::from_fn(|k| all[k].hull(directions[k]))));
        });
        // If a triangle may be in the box, so may points of both sides.
        let hull = hull.filter(|_| !touched).unwrap_or([unit; 3]);
        if here.inside { hull.map(|x| -x) } else { hull }
    }
}

impl PreviousPoint {
    pub(super) fn value(&self) -> f64 {
        if self.inside { -self.distance } else { self.distance }
    }

    pub(super) fn distance(&self) -> f64 {
        self.distance
    }

    /// Whether `p` is so near that it is certainly on the same side, and farther than `band` from every
    /// triangle.
    pub(super) fn is_beyond(&self, p: [f64; 3], band: f64) -> bool {
        // A factor far above the rounding of the distances.
        const SHARE: f64 = 1.0 + 1.0 / (1_u64 << 30) as f64;
        (length(difference(p, self.point)) + band) * SHARE < self.distance
    }
}

impl Leaf for MeshLeaf {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        let tasks = points.chunks(TASK).zip(out.chunks_mut(TASK)).collect();
        par_map_owned(&self.job, tasks, |(points, out): (&[[f64; 3]], &mut [f64])| self.sample(points, out));
        Ok(())
    }

    fn gradient_at(&self, points: &[[f64; 3]], out: &mut [[f64; 3]]) -> Result<LeafAnswer, LeafError> {
        let tasks = points.chunks(TASK).zip(out.chunks_mut(TASK)).collect();
        par_map_owned(&self.job, tasks, |(points, out): (&[[f64; 3]], &mut [[f64; 3]])| {
            let mut last = None;
            for (p, gradient) in points.iter().zip(out) {
                (*gradient, last) = self.gradient_near(*p, last);
            }
        });
        Ok(LeafAnswer::Given)
    }

    fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<LeafAnswer, LeafError> {
        let closed = self.is_closed();
        let tasks = boxes.chunks(TASK).zip(out.chunks_mut(TASK)).collect();
        par_map_owned(&self.job, tasks, |(boxes, out): (&[Box3], &mut [Interval])| {
            let (mut last, mut known, mut row) = (None, [None; 2], 0);
            for (bounds, range) in boxes.iter().zip(out) {
                *range = Interval::ENTIRE;
                let middle = bounds.centre();
                let radius = add_up(0.5 * bounds.diagonal(), self.distance_error(middle));
                if !radius.is_finite() {
                    continue;
                }
                let around = |[down, up]: [f64; 2]| {
                    let reach = Interval::new(-radius, radius).unwrap_or(Interval::ENTIRE);
                    Interval::new(down, up).unwrap_or(Interval::ENTIRE) + reach
                };
                if closed {
                    let Some(here) = self.step(middle, last) else { continue };
                    last = Some(here);
                    if let Some(ends) = self.distance_range(middle, here.row) {
                        // The signed distance is continuous and changes by no more than the point moves.
                        *range = if here.inside { -around(ends) } else { around(ends) };
                    }
                    continue;
                }
                let Some((_, near)) = self.bvh.distance_with_hint(middle, row) else { continue };
                row = near;
                let Some(ends) = self.distance_range(middle, row) else { continue };
                let size = around(ends);
                *range = match self.side_of_ball((middle, radius), (ends[0], row), &mut known) {
                    // All points of the ball have this side, so only the distance varies.
                    Some(true) => -size,
                    Some(false) => size,
                    // The side may change without a triangle, so the value may jump.
                    None => size.hull(-size).undefined(),
                };
            }
        });
        Ok(LeafAnswer::Given)
    }

    fn gradient_over(&self, boxes: &[Box3], out: &mut [[Interval; 3]]) -> Result<LeafAnswer, LeafError> {
        if !self.is_closed() {
            return Ok(LeafAnswer::None);
        }
        let tasks = boxes.chunks(TASK).zip(out.chunks_mut(TASK)).collect();
        par_map_owned(&self.job, tasks, |(boxes, out): (&[Box3], &mut [[Interval; 3]])| {
            boxes.iter().zip(out).for_each(|(bounds, gradient)| *gradient = self.gradient_range(bounds));
        });
        Ok(LeafAnswer::Given)
    }

    fn evidence(&self) -> Evidence {
        let moments = if self.is_closed() {
            Evidence::Proved
        } else {
            let sentence =
                "the mesh is not closed, and points whose winding number is above a half count as inside";
            Evidence::ProvedIf(vec![sentence.into()])
        };
        let Some(lost) = self.source().and_then(|source| source.lost.as_ref()) else { return moments };
        let most = lost.at_most().unwrap_or(f64::INFINITY);
        let sentence = format!(
            "a shape whose distance was computed anew is replaced by triangles, which are up to {most:e} \
             away from it"
        );
        moments.weaker(&Evidence::ProvedIf(vec![sentence])).weaker(lost.evidence())
    }

    fn as_any(&self) -> Option<&dyn std::any::Any> {
        Some(self)
    }
}
