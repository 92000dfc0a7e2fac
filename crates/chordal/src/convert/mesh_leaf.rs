//! The signed distance to a mesh, as a leaf of fields.
use crate::budget::{Evidence, Job, JobError, par_map_owned};
use crate::explicit::{Bvh, Mesh, PointLocation, WindingMoments, closest_on_triangle};
use crate::implicit::{Leaf, LeafAnswer, LeafError};
use crate::math::{
    Box3, Interval, add_up, difference, greater, length, mul_down, mul_up, sqrt_up, sub_down, sub_up,
};

/// Points in a task: at a microsecond each, enough to repay its start, and few enough for an even balance.
const TASK: usize = 1024;

/// A mesh with its bounding volume hierarchy and its winding moments.
#[derive(Clone, Debug)]
pub(super) struct MeshLeaf {
    bvh: Bvh,
    /// `None` for wires, which have no inside.
    sides: Option<WindingMoments>,
    job: Job,
    /// The error of distances, proportional to the mesh's own size.
    rounding: f64,
}

/// The result at the previous point, which speeds up the next.
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
        leaf.sides = Some(WindingMoments::new(mesh, &leaf.bvh));
        Ok(leaf)
    }

    /// The distance alone; no point is inside.
    pub(super) fn unsigned(mesh: &Mesh, job: &Job) -> Result<Self, JobError> {
        let bvh = Bvh::build(mesh, job)?;
        // The error is a few units in the last place of the extent; 64 are far more, and include the rounding
        // of coordinates.
        let bounds = bvh.bounds();
        let largest = bounds.min.iter().chain(&bounds.max).fold(0.0, |m: f64, x| greater(x.abs(), m));
        let rounding =
            if bounds.is_empty() { 0.0 } else { 64.0 * f64::EPSILON * (largest + bounds.diagonal()) };
        Ok(Self { bvh, sides: None, job: job.clone(), rounding })
    }

    /// Whether sides change at triangles only.
    pub(super) fn is_closed(&self) -> bool {
        self.sides.as_ref().is_none_or(|sides| sides.enclosure(&self.bvh).is_closed())
    }

    /// Whether `p` is inside; never beyond the box of the triangles.
    pub(super) fn is_inside(&self, p: [f64; 3]) -> bool {
        let Some(sides) = self.sides.as_ref().filter(|_| self.bvh.bounds().contains(p)) else { return false };
        let found = sides.enclosure(&self.bvh).inside(p);
        match found.side {
            PointLocation::Inside => true,
            PointLocation::Ambiguous => found.winding.value > 0.5,
            PointLocation::Outside | PointLocation::On => false,
        }
    }

    /// The distance at `p`, and what speeds up the next point; `None` without triangles or for a point that
    /// is not finite.
    pub(super) fn step(&self, p: [f64; 3], last: Option<PreviousPoint>) -> Option<PreviousPoint> {
        let (distance, row) = self.bvh.distance_with_hint(p, last.map_or(0, |last| last.row))?;
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
        // Far more than the roundings of a point and of its offsets.
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

    /// A lower and an upper bound of the distance from `p`, whatever was rounded.
    fn distance_range(&self, p: [f64; 3], row: u32) -> Option<[f64; 2]> {
        Some([self.bvh.closest_distance_down(p)?, self.bvh.distance_bounds(p, row)?[1]])
    }

    /// A range of the gradient in a box, from the triangles that may be nearest there.
    ///
    /// The gradient is `±(p − q)/|p − q|` with the closest point `q` of some triangle, and the offset from
    /// the closest point of a convex set changes by no more than `p` moves. A triangle that is nearest for
    /// some point of the box is no farther from the middle than the nearest one there plus the box's
    /// diameter.
    ///
    /// A computed closest point `q'` lies on the triangle, up to rounding, and not always near `q`: but the
    /// angle at `q` is not acute, so `|q − q'|² ≤ |p − q'|² − |p − q|²`, of which the last is bounded from
    /// below.
    fn gradient_range(&self, bounds: &Box3) -> [Interval; 3] {
        let unit = Interval::new(-1.0, 1.0).unwrap_or(Interval::ENTIRE);
        let middle = bounds.centre();
        let off = self.distance_error(middle);
        let radius = add_up(0.5 * bounds.diagonal(), off);
        let Some(here) = self.step(middle, None).filter(|_| radius.is_finite()) else { return [unit; 3] };
        let Some([_, nearest]) = self.bvh.distance_bounds(middle, here.row) else { return [unit; 3] };
        let reach = add_up(nearest, 2.0 * radius);
        let mut hull: Option<[Interval; 3]> = None;
        let mut touched = false;
        self.bvh.rows_near(middle, add_up(reach, off), |row| {
            let [down, _] = self.bvh.distance_bounds(middle, row).unwrap_or([0.0; 2]);
            if down > reach {
                return;
            }
            touched |= down <= radius;
            let offset = self.offset(middle, row);
            let size = length(offset);
            let most = add_up(size, off);
            let slack = sub_up(mul_up(most, most), mul_down(down, down));
            let slide = sqrt_up(greater(slack, 0.0));
            let play = add_up(radius, add_up(slide, off));
            let around =
                |x: f64| Interval::new(sub_down(x, play), add_up(x, play)).unwrap_or(Interval::ENTIRE);
            let sizes = around(size);
            let part =
                offset.map(|x| if sizes.lo() > 0.0 { (around(x) / sizes).intersection(unit) } else { unit });
            hull = Some(hull.map_or(part, |all| std::array::from_fn(|k| all[k].hull(part[k]))));
        });
        // Where a triangle may be in the box, both sides may be too.
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
            for (bounds, range) in boxes.iter().zip(out) {
                let middle = bounds.centre();
                let radius = add_up(0.5 * bounds.diagonal(), self.distance_error(middle));
                let found = self.step(middle, None).filter(|_| radius.is_finite());
                let found = found.and_then(|here| Some((here, self.distance_range(middle, here.row)?)));
                *range = found.map_or(Interval::ENTIRE, |(here, [down, up])| {
                    let reach = Interval::new(-radius, radius).unwrap_or(Interval::ENTIRE);
                    let size = Interval::new(down, up).unwrap_or(Interval::ENTIRE) + reach;
                    if !closed {
                        return size.hull(-size).undefined();
                    }
                    // The signed distance is continuous and changes by no more than the point moves.
                    if here.inside { -size } else { size }
                });
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
        if self.is_closed() {
            Evidence::Proved
        } else {
            let sentence =
                "the mesh is not closed, and inside of it is where its winding number is above a half";
            Evidence::ProvedIf(vec![sentence.into()])
        }
    }
}
