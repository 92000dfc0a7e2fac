//! Watertight ray queries: no gaps between triangles that share an edge or a corner.
use super::frame::{down, up};
use super::{Bvh, BvhNode, BvhTriangle, LAST, LEAF, STACK, WIDTH};
use crate::math::{Box3, exponent, greater, lesser, power_of_two};

/// The points `origin + t · direction` for `t_min ≤ t ≤ t_max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at `t = 0`.
    pub origin: [f64; 3],
    /// The step for `t = 1`; of any length but 0.
    pub direction: [f64; 3],
    /// The smallest `t`, ≥ 0.
    pub t_min: f64,
    /// The largest `t`; may be infinite.
    pub t_max: f64,
}

impl Ray {
    /// The ray from `origin` without end.
    #[must_use]
    pub fn new(origin: [f64; 3], direction: [f64; 3]) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f64::INFINITY }
    }

    /// The point at `t`, rounded.
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; 3] {
        std::array::from_fn(|k| self.origin[k] + t * self.direction[k])
    }
}

/// The intersection of a ray with a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The parameter on the ray, rounded.
    pub t: f64,
    /// The face; the lowest of those hit at the same `t`.
    pub face: u32,
    /// The barycentric coordinates in the face: ≥ 0, with sum 1 up to rounding.
    pub barycentric: [f64; 3],
    /// Whether the ray comes from the front, where the corners appear counter-clockwise.
    pub front: bool,
}

/// The sides of triangles that a ray can hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum HitSides {
    /// Both.
    #[default]
    Both,
    /// Only fronts: back faces are culled.
    Front,
    /// Only backs: front faces are culled.
    Back,
}

impl HitSides {
    #[inline]
    pub(crate) fn accepts(self, front: bool) -> bool {
        match self {
            Self::Both => true,
            Self::Front => front,
            Self::Back => !front,
        }
    }
}

/// The data of a ray for the test with a triangle: the axes permuted and sheared so that the ray is the z
/// axis.
///
/// Source: S. Woop, C. Benthin, I. Wald, *Watertight ray/triangle intersection*, 2013.
struct ShearedRay {
    origin: [f64; 3],
    axes: [usize; 3],
    shear: [f64; 3],
}

/// A ray's parameter and barycentric coordinates on a triangle, in scaled coordinates.
#[derive(Clone, Copy)]
struct TriangleHit {
    t: f64,
    barycentric: [f64; 3],
    front: bool,
}

impl ShearedRay {
    fn new(origin: [f64; 3], direction: [f64; 3]) -> Self {
        let z = (1..3).fold(0, |z, k| if direction[k].abs() > direction[z].abs() { k } else { z });
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        // The swap preserves the orientation if the ray runs against its axis.
        if direction[z] < 0.0 {
            (x, y) = (y, x);
        }
        let shear = [direction[x] / direction[z], direction[y] / direction[z], 1.0 / direction[z]];
        Self { origin, axes: [x, y, z], shear }
    }

    /// The intersection with a triangle for `t_min ≤ t ≤ t_max`.
    ///
    /// Each corner is projected independently, and the edge functions compare two rounded products each.
    /// Since rounding is monotonic, they never have the wrong sign; at worst they are 0, and then exact
    /// arithmetic decides. So triangles that share projected corners leave no gap between them.
    #[inline]
    fn intersect(&self, corners: [[f64; 3]; 3], t_min: f64, t_max: f64) -> Option<TriangleHit> {
        let [ix, iy, iz] = self.axes;
        let project = |p: [f64; 3]| {
            let z = p[iz] - self.origin[iz];
            let x = (p[ix] - self.origin[ix]) - self.shear[0] * z;
            let y = (p[iy] - self.origin[iy]) - self.shear[1] * z;
            [x, y, z]
        };
        let [a, b, c] = [project(corners[0]), project(corners[1]), project(corners[2])];
        let mut u = c[0] * b[1] - c[1] * b[0];
        let mut v = a[0] * c[1] - a[1] * c[0];
        let mut w = b[0] * a[1] - b[1] * a[0];
        if u == 0.0 || v == 0.0 || w == 0.0 {
            [u, v, w] = [(c, b), (a, c), (b, a)].map(|(p, q)| exact_cross(p, q));
        }
        // Of either orientation: the sign of the sum tells the side afterwards.
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        if sum == 0.0 {
            return None;
        }
        let barycentric = [u / sum, v / sum, w / sum];
        let depth = barycentric[0] * a[2] + barycentric[1] * b[2] + barycentric[2] * c[2];
        let t = depth * self.shear[2];
        (t >= t_min && t <= t_max).then_some(TriangleHit { t, barycentric, front: sum > 0.0 })
    }
}

/// `p.x·q.y − p.y·q.x` with the exact sign.
#[cold]
fn exact_cross(p: [f64; 3], q: [f64; 3]) -> f64 {
    let coord = |p: [f64; 3]| robust::Coord { x: p[0], y: p[1] };
    robust::orient2d(coord(p), coord(q), robust::Coord { x: 0.0, y: 0.0 })
}

/// The data of a ray for the test with boxes: local, in f32 and rounded so that no box is missed.
struct RaySlabs {
    /// By axis: the end of the box (low 0, high 1) where the ray enters.
    enter: [usize; 3],
    /// The origin, rounded forwards along the ray and backwards.
    ahead: [f32; 3],
    behind: [f32; 3],
    /// The inverse direction, its magnitude rounded down and up.
    inverse_down: [f32; 3],
    inverse_up: [f32; 3],
}

/// Relative slack. Derived: the four roundings of 2⁻²⁴ (difference, inverse, product, `t` of the origin) of
/// each end.
const SLACK: f32 = 1.0 + 1.0 / (1 << 20) as f32;

impl RaySlabs {
    /// `origin` is local and exact to `error`. `inverse` belongs to a direction whose largest component is
    /// between 1 and 2, without negative zeros.
    #[inline]
    fn new(origin: [f64; 3], inverse: [f64; 3], error: f64) -> Self {
        let mut slabs = Self {
            enter: [0; 3],
            ahead: [0.0; 3],
            behind: [0.0; 3],
            inverse_down: [0.0; 3],
            inverse_up: [0.0; 3],
        };
        for k in 0..3 {
            let (low, high) = (down(origin[k] - error), up(origin[k] + error));
            let forward = inverse[k] > 0.0;
            slabs.enter[k] = usize::from(!forward);
            (slabs.behind[k], slabs.ahead[k]) = if forward { (low, high) } else { (high, low) };
            // Two steps of f32 each way: for the conversion and for this product.
            const STEPS: f32 = 2.0 * f32::EPSILON;
            let near = inverse[k] as f32;
            let lowest = near * (1.0 - STEPS);
            // Finite also along an axis to which the ray is perpendicular, so that 0 times it is 0
            // and not NaN.
            slabs.inverse_down[k] = lowest.clamp(-f32::MAX, f32::MAX);
            slabs.inverse_up[k] = near * (1.0 + STEPS);
        }
        slabs
    }

    /// The entry parameter for each box, at most `limit`; ∞ where the ray misses.
    #[inline]
    fn enter(&self, node: &BvhNode, limit: f32) -> [f32; WIDTH] {
        let mut enter = [0.0_f32; WIDTH];
        let mut leave = [limit; WIDTH];
        for k in 0..3 {
            let (first, second) =
                (&node.bounds[k][self.enter[k] & 1], &node.bounds[k][(self.enter[k] & 1) ^ 1]);
            for lane in 0..WIDTH {
                let t = (first[lane] - self.ahead[k]) * self.inverse_down[k];
                enter[lane] = greater(t, enter[lane]);
                // NaN, from 0·∞ in the plane of a slab, leaves the value unchanged.
                let t = (second[lane] - self.behind[k]) * self.inverse_up[k] * SLACK;
                leave[lane] = lesser(t, leave[lane]);
            }
        }
        std::array::from_fn(|lane| if enter[lane] <= leave[lane] { enter[lane] } else { f32::INFINITY })
    }
}

/// A ray in the coordinates of the tree.
struct LocalRay {
    sheared: ShearedRay,
    slabs: RaySlabs,
    /// Scaled `t` at which the ray enters the vicinity of the mesh: the origin of the slabs' own `t`.
    start: f64,
    /// World `t` per scaled `t`.
    unit: f64,
    t_min: f64,
    t_max: f64,
}

impl Bvh {
    /// The first triangle that the ray hits. `None` if there is none, for a direction that is 0 or not
    /// finite, and for an origin that is not finite or beyond 10³⁰⁰ extents.
    ///
    /// The query is watertight: a ray through an edge or a corner that triangles share hits one of them,
    /// unless it is on the silhouette of the mesh. Front and back faces are treated alike; see
    /// [`Hit::front`]. Triangles without area are never hit.
    ///
    /// Source: S. Woop, C. Benthin, I. Wald, *Watertight ray/triangle intersection*, 2013, in f64, with exact
    /// signs instead of a wider fallback.
    #[must_use]
    pub fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        self.first_hit_on(ray, HitSides::Both)
    }

    /// [`Bvh::first_hit`] among the triangles that the ray hits on one of `sides`; it passes through all
    /// others.
    #[must_use]
    pub fn first_hit_on(&self, ray: &Ray, sides: HitSides) -> Option<Hit> {
        let mut cast = self.cast(ray)?;
        let mut best: Option<(TriangleHit, u32)> = None;
        self.traverse(&mut cast, |cast, triangle| {
            let Some(meeting) = cast.sheared.intersect(self.corners_of(triangle), cast.t_min, cast.t_max)
            else {
                return false;
            };
            let face = triangle.face & !LAST;
            if !sides.accepts(meeting.front) {
                return false;
            }
            // `t_max` was lowered to the best, so what is accepted is as near at least; among
            // equally near ones the lower face counts.
            if best.is_none_or(|(closest, closest_face)| meeting.t < closest.t || face < closest_face) {
                cast.t_max = meeting.t;
                best = Some((meeting, face));
            }
            false
        });
        best.map(|(meeting, face)| Hit {
            t: meeting.t * cast.unit,
            face,
            barycentric: meeting.barycentric,
            front: meeting.front,
        })
    }

    /// Whether the ray hits any triangle, as for shadow rays; cheaper than [`Bvh::first_hit`].
    #[must_use]
    pub fn any_hit(&self, ray: &Ray) -> bool {
        let Some(mut cast) = self.cast(ray) else { return false };
        let mut met = false;
        self.traverse(&mut cast, |cast, triangle| {
            met = cast.sheared.intersect(self.corners_of(triangle), cast.t_min, cast.t_max).is_some();
            met
        });
        met
    }

    #[inline]
    fn cast(&self, ray: &Ray) -> Option<LocalRay> {
        let largest = |v: [f64; 3]| v.iter().fold(0.0, |m, x| greater(x.abs(), m));
        let size = largest(ray.direction);
        let usable = size > 0.0 && ray.direction.iter().all(|x| x.is_finite());
        if self.nodes.is_empty() || !usable {
            return None;
        }
        // Powers of two scale the direction to a size between 1 and 2; two steps, since one may overflow.
        // Adding 0 turns −0 into 0.
        let shift = 1 - exponent(size);
        let [half, other_half] = [shift / 2, shift - shift / 2].map(power_of_two);
        let direction = ray.direction.map(|x| x * half * other_half + 0.0);
        let origin = self.frame.scaled(ray.origin);
        let unit = half / self.frame.scale * other_half;
        let local: [f64; 3] = std::array::from_fn(|k| origin[k] - self.frame.middle[k]);
        if !local.iter().all(|x| x.is_finite()) {
            return None;
        }
        let inverse = direction.map(|x| 1.0 / x);
        // The projected corners of triangles, the origin and the entry point are off by a few units of 2⁻⁵³
        // of the distance between them.
        let error = (largest(local) + 4.0) * (1.0 / (1_u64 << 46) as f64);
        let start = start(&self.local, error, local, inverse)?;
        let nearer: [f64; 3] = std::array::from_fn(|k| local[k] + start * direction[k]);
        Some(LocalRay {
            sheared: ShearedRay::new(origin, direction),
            slabs: RaySlabs::new(nearer, inverse, error),
            start,
            unit,
            t_min: ray.t_min / unit,
            t_max: ray.t_max / unit,
        })
    }

    /// Visits triangles whose boxes the ray meets before `cast.t_max`, nearest boxes first, until `visit`
    /// returns true.
    #[inline]
    fn traverse(&self, cast: &mut LocalRay, mut visit: impl FnMut(&mut LocalRay, &BvhTriangle) -> bool) {
        let limit_of = |cast: &LocalRay| {
            let limit = (cast.t_max - cast.start) as f32;
            // Slack at both ends: `t` was rounded, and the entry into a box is rounded too.
            if limit < f32::MAX { limit * (SLACK * SLACK) + f32::EPSILON } else { f32::MAX }
        };
        let mut limit = limit_of(cast);
        let mut stack = [(0.0_f32, 0_u32); STACK];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (enter, child) = stack[height];
            if enter > limit {
                continue;
            }
            if child & LEAF != 0 {
                let mut row = (child & !LEAF) as usize;
                loop {
                    let triangle = &self.triangles[row];
                    if visit(cast, triangle) {
                        return;
                    }
                    if triangle.face & LAST != 0 {
                        break;
                    }
                    row += 1;
                }
                // A hit in the leaf may have shortened the ray.
                limit = limit_of(cast);
                continue;
            }
            let node = &self.nodes[child as usize];
            let enters = cast.slabs.enter(node, limit);
            let bottom = height;
            for (enter, child) in enters.into_iter().zip(node.child) {
                if enter < f32::INFINITY {
                    // Insertion, farthest first: the nearest child is on top and is opened next.
                    let mut at = height;
                    while at > bottom && stack[at - 1].0 < enter {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = (enter, child);
                    height += 1;
                }
            }
        }
    }
}

/// The `t ≥ 0` at which a ray enters a box widened by `error`, 0 from inside; `None` if it never does.
#[inline]
fn start(bounds: &Box3, error: f64, origin: [f64; 3], inverse: [f64; 3]) -> Option<f64> {
    let (mut enter, mut leave) = (0.0, f64::INFINITY);
    for k in 0..3 {
        let low = (bounds.min[k] - error - origin[k]) * inverse[k];
        let high = (bounds.max[k] + error - origin[k]) * inverse[k];
        let (first, second) = if inverse[k] < 0.0 { (high, low) } else { (low, high) };
        // NaN, from 0·∞ in the plane of a slab, leaves the value unchanged.
        enter = greater(first, enter);
        leave = lesser(second, leave);
    }
    (enter <= leave && enter < f64::MAX).then_some(enter)
}
