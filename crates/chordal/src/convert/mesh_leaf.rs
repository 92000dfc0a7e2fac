//! The signed distance to a mesh, as a leaf of fields.
use crate::budget::{Evidence, Job, Stopped, par_map_owned};
use crate::explicit::{Bvh, Mesh, Soundings, Whereabouts, nearest_on_triangle};
use crate::implicit::{Answer, Leaf, LeafError};
use crate::math::{Box3, Interval, add_up, difference, length, mul_down, mul_up, sqrt_up, sub_down, sub_up};

/// Points in a task: at a microsecond each, worth its start, and few enough to share out evenly.
const TASK: usize = 1024;

/// A mesh, its tree, and what tells its sides.
#[derive(Clone, Debug)]
pub(super) struct MeshLeaf {
    bvh: Bvh,
    /// `None` for wires, which have no inside.
    sides: Option<Soundings>,
    job: Job,
    /// What distances are off by, a share of the mesh's own size.
    rounding: f64,
}

/// What is known where the last point was.
#[derive(Clone, Copy, Debug)]
pub(super) struct Last {
    point: [f64; 3],
    distance: f64,
    inside: bool,
    row: u32,
}

impl MeshLeaf {
    pub(super) fn new(mesh: &Mesh, job: &Job) -> Result<Self, Stopped> {
        let mut leaf = Self::wire(mesh, job)?;
        leaf.sides = Some(Soundings::new(mesh, &leaf.bvh));
        Ok(leaf)
    }

    /// The distance alone, inside of nothing.
    pub(super) fn wire(mesh: &Mesh, job: &Job) -> Result<Self, Stopped> {
        let bvh = Bvh::build(mesh, job)?;
        // A few units in the last place of the extent; 64 are far more, and coordinates are rounded before.
        let bounds = bvh.bounds();
        let largest =
            bounds.min.iter().chain(&bounds.max).fold(0.0, |m: f64, x| if x.abs() > m { x.abs() } else { m });
        let rounding =
            if bounds.is_empty() { 0.0 } else { 64.0 * f64::EPSILON * (largest + bounds.diagonal()) };
        Ok(Self { bvh, sides: None, job: job.clone(), rounding })
    }

    /// Whether sides change at triangles only.
    pub(super) fn is_closed(&self) -> bool {
        self.sides.as_ref().is_none_or(|sides| sides.on(&self.bvh).is_closed())
    }

    /// Whether `p` is inside; never beyond the box of the triangles.
    pub(super) fn is_inside(&self, p: [f64; 3]) -> bool {
        let Some(sides) = self.sides.as_ref().filter(|_| self.bvh.bounds().contains(p)) else { return false };
        let found = sides.on(&self.bvh).inside(p);
        match found.side {
            Whereabouts::Inside => true,
            Whereabouts::Ambiguous => found.winding.value > 0.5,
            Whereabouts::Outside | Whereabouts::On => false,
        }
    }

    /// The distance at `p`, and everything that helps with the next point; `None` without triangles or for a point that is
    /// not finite.
    pub(super) fn step(&self, p: [f64; 3], last: Option<Last>) -> Option<Last> {
        let (distance, row) = self.bvh.distance_near(p, last.map_or(0, |last| last.row))?;
        let inside = match last {
            // Two balls without triangles that overlap lie on one side, if the mesh is closed.
            Some(last) if self.joins(&last, p, distance) => last.inside,
            _ => self.is_inside(p),
        };
        Some(Last { point: p, distance, inside, row })
    }

    /// Whether the empty balls around two points overlap for sure, and sides only change at triangles.
    fn joins(&self, last: &Last, p: [f64; 3], distance: f64) -> bool {
        // A share that is far more than all roundings of the distances and of their sum.
        const SHARE: f64 = 1.0 + 1.0 / (1_u64 << 30) as f64;
        let between = length(difference(p, last.point));
        self.is_closed() && between * SHARE + 4.0 * self.rounding < last.distance + distance
    }

    /// How far the computed distance at `p` may be off.
    fn off(&self, p: [f64; 3]) -> f64 {
        let size = p.iter().fold(0.0, |m: f64, x| if x.abs() > m { x.abs() } else { m });
        // Far more than the roundings of a point and of its offsets.
        add_up(self.rounding, 64.0 * f64::EPSILON * size)
    }

    fn run(&self, points: &[[f64; 3]], out: &mut [f64]) {
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

    /// `p` minus its nearest point on a triangle.
    fn offset(&self, p: [f64; 3], row: u32) -> [f64; 3] {
        let (corners, _) = self.bvh.triangle_of(row);
        let w = nearest_on_triangle(p, corners);
        std::array::from_fn(|k| {
            (w[0] * (p[k] - corners[0][k]) + w[1] * (p[k] - corners[1][k])) + w[2] * (p[k] - corners[2][k])
        })
    }

    fn slope_at(&self, p: [f64; 3], last: Option<Last>) -> ([f64; 3], Option<Last>) {
        let Some(here) = self.step(p, last) else { return ([f64::NAN; 3], None) };
        let sign = if here.inside { -1.0 } else { 1.0 };
        let offset = self.offset(p, here.row);
        let size = length(offset);
        let gradient = if size > self.rounding {
            offset.map(|x| sign * (x / size))
        } else {
            // On a triangle: across it.
            let (corners, _) = self.bvh.triangle_of(here.row);
            let n =
                crate::math::cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
            let size = length(n);
            n.map(|x| if size > 0.0 { x / size } else { 0.0 })
        };
        (gradient, Some(here))
    }

    /// What the distance from `p` is at least and at most, whatever was rounded.
    fn between(&self, p: [f64; 3], row: u32) -> Option<[f64; 2]> {
        Some([self.bvh.closest_distance_down(p)?, self.bvh.distance_between(p, row)?[1]])
    }

    /// A range of the gradient in a box, of triangles that may be nearest there.
    ///
    /// The gradient is `±(p − q)/|p − q|` with the nearest point `q` of some triangle, and the offset from the nearest point
    /// of a convex set changes by no more than one moves. A triangle that is nearest for some point of the box is no farther
    /// from the middle than the nearest one there and the box's diameter.
    ///
    /// A computed nearest point `q'` lies on the triangle, up to rounding, and not always near `q`: but the angle at `q` is
    /// not acute, so `|q − q'|² ≤ |p − q'|² − |p − q|²`, of which the last is bounded from below.
    fn slope_over(&self, bounds: &Box3) -> [Interval; 3] {
        let unit = Interval::new(-1.0, 1.0).unwrap_or(Interval::ENTIRE);
        let middle = bounds.centre();
        let off = self.off(middle);
        let radius = add_up(0.5 * bounds.diagonal(), off);
        let Some(here) = self.step(middle, None).filter(|_| radius.is_finite()) else { return [unit; 3] };
        let Some([_, nearest]) = self.bvh.distance_between(middle, here.row) else { return [unit; 3] };
        let reach = add_up(nearest, 2.0 * radius);
        let mut hull: Option<[Interval; 3]> = None;
        let mut touched = false;
        self.bvh.around(middle, add_up(reach, off), |row| {
            let [down, _] = self.bvh.distance_between(middle, row).unwrap_or([0.0; 2]);
            if down > reach {
                return;
            }
            touched |= down <= radius;
            let offset = self.offset(middle, row);
            let size = length(offset);
            let most = add_up(size, off);
            let slack = sub_up(mul_up(most, most), mul_down(down, down));
            let slide = sqrt_up(if slack > 0.0 { slack } else { 0.0 });
            let play = add_up(radius, add_up(slide, off));
            let around =
                |x: f64| Interval::new(sub_down(x, play), add_up(x, play)).unwrap_or(Interval::ENTIRE);
            let sizes = around(size);
            let part =
                offset.map(|x| if sizes.lo() > 0.0 { (around(x) / sizes).intersection(unit) } else { unit });
            hull = Some(hull.map_or(part, |all| std::array::from_fn(|k| all[k].hull(part[k]))));
        });
        // Where a triangle may be in the box, so may both sides.
        let hull = hull.filter(|_| !touched).unwrap_or([unit; 3]);
        if here.inside { hull.map(|x| -x) } else { hull }
    }
}

impl Last {
    pub(super) fn value(&self) -> f64 {
        if self.inside { -self.distance } else { self.distance }
    }

    pub(super) fn distance(&self) -> f64 {
        self.distance
    }

    /// Whether `p` is so near that it is certainly on the same side, and farther than `band` from every triangle.
    pub(super) fn is_beyond(&self, p: [f64; 3], band: f64) -> bool {
        // A share that is far more than the rounding of the distances.
        const SHARE: f64 = 1.0 + 1.0 / (1_u64 << 30) as f64;
        (length(difference(p, self.point)) + band) * SHARE < self.distance
    }
}

impl Leaf for MeshLeaf {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        let tasks = points.chunks(TASK).zip(out.chunks_mut(TASK)).collect();
        par_map_owned(&self.job, tasks, |(points, out): (&[[f64; 3]], &mut [f64])| self.run(points, out));
        Ok(())
    }

    fn gradient_at(&self, points: &[[f64; 3]], out: &mut [[f64; 3]]) -> Result<Answer, LeafError> {
        let tasks = points.chunks(TASK).zip(out.chunks_mut(TASK)).collect();
        par_map_owned(&self.job, tasks, |(points, out): (&[[f64; 3]], &mut [[f64; 3]])| {
            let mut last = None;
            for (p, gradient) in points.iter().zip(out) {
                (*gradient, last) = self.slope_at(*p, last);
            }
        });
        Ok(Answer::Given)
    }

    fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<Answer, LeafError> {
        let closed = self.is_closed();
        let tasks = boxes.chunks(TASK).zip(out.chunks_mut(TASK)).collect();
        par_map_owned(&self.job, tasks, |(boxes, out): (&[Box3], &mut [Interval])| {
            for (bounds, range) in boxes.iter().zip(out) {
                let middle = bounds.centre();
                let radius = add_up(0.5 * bounds.diagonal(), self.off(middle));
                let found = self.step(middle, None).filter(|_| radius.is_finite());
                let found = found.and_then(|here| Some((here, self.between(middle, here.row)?)));
                *range = found.map_or(Interval::ENTIRE, |(here, [down, up])| {
                    let reach = Interval::new(-radius, radius).unwrap_or(Interval::ENTIRE);
                    let size = Interval::new(down, up).unwrap_or(Interval::ENTIRE) + reach;
                    if !closed {
                        return size.hull(-size).undefined();
                    }
                    // The signed distance is continuous and changes by no more than one moves.
                    if here.inside { -size } else { size }
                });
            }
        });
        Ok(Answer::Given)
    }

    fn gradient_over(&self, boxes: &[Box3], out: &mut [[Interval; 3]]) -> Result<Answer, LeafError> {
        if !self.is_closed() {
            return Ok(Answer::None);
        }
        let tasks = boxes.chunks(TASK).zip(out.chunks_mut(TASK)).collect();
        par_map_owned(&self.job, tasks, |(boxes, out): (&[Box3], &mut [[Interval; 3]])| {
            boxes.iter().zip(out).for_each(|(bounds, gradient)| *gradient = self.slope_over(bounds));
        });
        Ok(Answer::Given)
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
