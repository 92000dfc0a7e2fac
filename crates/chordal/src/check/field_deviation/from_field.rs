//! From the surface of a field to a mesh.
//!
//! Boxes with a change of sign are looked at from large to small. Let B be one, c its middle, and E a larger box around it
//! in which the field is Lipschitz with gradients in G and grows along n at a rate of g > 0. With u and v across n, the
//! column N = {c + a·u + b·v + s·n: |a| ≤ A, |b| ≤ A', |s| ≤ H} over the shadow of B shall lie in E.
//!
//! Let δ be the largest |F| on the triangles that meet E. If F > δ on the top of N (s = H) and F < −δ on its bottom,
//! the mesh meets neither; and if the mesh winds differently often around the middle of the top and that of the
//! bottom, every line along n from bottom to top crosses the mesh: both ends of the line see what the middles see, as top and
//! bottom are connected and free of the mesh. Now let p be a point of the surface in B, and t = δ/g. On its line, F is
//! above δ from p + t·n upwards, and below −δ from p − t·n downwards, so the mesh is crossed between the two: it is
//! within t of p.
//!
//! By the mean value theorem F at c + a·u + b·v + s·n is at least `F(c) + g·s − A·|G·u| − A'·|G·v|` for s ≥ 0, which says how
//! high H must be; and |s| of any p of the surface in B is at most `(|F(c)| + A·|G·u| + A'·|G·v|)/g`.
//!
//! Where that fails (edges of opposite turn, places where the field stands still, meshes that are not closed) a box is
//! settled by the distance of its middle to the mesh, plus its half diagonal; or it is cut in eight.
use super::slope::{Growth, dot, exactly, is_lipschitz, step};
use crate::explicit::{Bvh, Enclosure};
use crate::implicit::{LeafError, Slope, Tape};
use crate::math::{Box3, Interval, add_up, div_up, mul_up, sub_down};

/// The mesh as the search sees it.
pub(super) struct Target<'a> {
    pub bvh: &'a Bvh,
    pub enclosure: &'a Enclosure<'a>,
    /// The largest |F| on each face, ∞ where it is not known.
    pub strays: &'a [f64],
    /// What is near enough.
    pub enough: f64,
}

/// What was found out about a box.
#[derive(Clone, Copy, Debug)]
pub(super) enum Found {
    /// The surface does not come here.
    Nothing,
    /// Every point of the surface in it is this close to the mesh.
    Near(f64),
    /// Not known yet.
    Open,
}

/// Half of E's side, as a share of half of B's: columns across the diagonal of a cube fit in with room for their height.
const ROOM: f64 = 2.25;
/// By how much the axes of a column may be off from being of length 1 and across each other, rounded as they are: derived
/// as some 20 roundings of half a step each, with a thousandfold margin.
const CROOKED: f64 = 1e-12;

/// Which boxes the surface may come to.
pub(super) fn crossed(tape: &Tape, boxes: &[Box3]) -> Result<Vec<bool>, LeafError> {
    let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
    tape.over(boxes, &mut ranges)?;
    // Where a part of the expression has no value the range says nothing, and no value counts as outside.
    Ok(ranges.iter().map(|range| !(range.is_defined() && (range.lo() >= 0.0 || range.hi() < 0.0))).collect())
}

/// Looks at every box.
pub(super) fn look(tape: &Tape, boxes: &[Box3], target: &Target) -> Result<Vec<Found>, LeafError> {
    let mut found = vec![Found::Open; boxes.len()];
    if target.enclosure.is_closed() {
        by_columns(tape, boxes, target, &mut found)?;
    }
    for (found, bounds) in found.iter_mut().zip(boxes) {
        if matches!(found, Found::Open) {
            *found = by_distance(bounds, target);
        }
    }
    Ok(found)
}

fn by_columns(tape: &Tape, boxes: &[Box3], target: &Target, found: &mut [Found]) -> Result<(), LeafError> {
    let about: Vec<Box3> = boxes.iter().map(roomy).collect();
    let middles: Vec<Box3> = boxes.iter().map(Box3::centre).map(|c| Box3 { min: c, max: c }).collect();
    let unknown = Slope { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] };
    let mut slopes = vec![unknown; boxes.len()];
    tape.gradient_over(&about, &mut slopes)?;
    let mut values = vec![Interval::UNKNOWN; boxes.len()];
    tape.over(&middles, &mut values)?;
    for (k, found) in found.iter_mut().enumerate() {
        let column = Column { of: &boxes[k], about: &about[k], slope: &slopes[k], value: values[k] };
        *found = column.look(target);
    }
    Ok(())
}

/// Settles a box that is small beside what is near enough.
fn by_distance(bounds: &Box3, target: &Target) -> Found {
    let half = 0.5 * bounds.diagonal();
    if half >= target.enough {
        return Found::Open;
    }
    let far = distance_of(bounds, target);
    if far <= target.enough { Found::Near(far) } else { Found::Open }
}

/// How far a point of the box is from the mesh at most: its middle, and half its diagonal.
pub(super) fn distance_of(bounds: &Box3, target: &Target) -> f64 {
    let middle = target.bvh.closest_distance_up(bounds.centre()).unwrap_or(f64::INFINITY);
    // The middle is rounded: it is off by less than two steps of the largest coordinate in each direction.
    add_up(middle, add_up(mul_up(0.5, bounds.diagonal()), mul_up(4.0 * f64::EPSILON, reach(bounds))))
}

/// How far every point of the box is from the mesh at least.
pub(super) fn at_least(bounds: &Box3, target: &Target) -> f64 {
    let middle = target.bvh.closest_distance_down(bounds.centre()).unwrap_or(0.0);
    // The middle is rounded: it is off by less than two steps of the largest coordinate in each direction.
    sub_down(middle, add_up(mul_up(0.5, bounds.diagonal()), mul_up(4.0 * f64::EPSILON, reach(bounds))))
}

fn reach(bounds: &Box3) -> f64 {
    bounds.min.iter().chain(&bounds.max).fold(0.0, |most: f64, x| if x.abs() > most { x.abs() } else { most })
}

/// E.
pub(super) fn roomy(bounds: &Box3) -> Box3 {
    let c = bounds.centre();
    let half = |k: usize| ROOM * 0.5 * (bounds.max[k] - bounds.min[k]);
    Box3 { min: std::array::from_fn(|k| c[k] - half(k)), max: std::array::from_fn(|k| c[k] + half(k)) }
}

struct Column<'a> {
    of: &'a Box3,
    about: &'a Box3,
    slope: &'a Slope<Interval>,
    value: Interval,
}

impl Column<'_> {
    fn look(&self, target: &Target) -> Found {
        let range = self.slope.value;
        if range.is_defined() && (range.lo() >= 0.0 || range.hi() < 0.0) {
            return Found::Nothing;
        }
        if !is_lipschitz(self.slope) || !self.value.is_defined() {
            return Found::Open;
        }
        let Some(growth) = Growth::of(self.slope) else { return Found::Open };
        let mut strays = 0.0;
        target.bvh.about(self.about, |face| {
            let of_face = target.strays[face as usize];
            strays = if of_face > strays { of_face } else { strays };
        });
        let steps = growth.steps_for(strays);
        let near = mul_up(steps, growth.length);
        if near > target.enough || near.is_nan() {
            return Found::Open;
        }
        match self.height(&growth, steps) {
            Some(height) if self.separated(&growth, height, strays, target) => Found::Near(near),
            _ => Found::Open,
        }
    }

    /// H, if the column lies in E with it.
    fn height(&self, growth: &Growth, steps: f64) -> Option<f64> {
        let n = growth.along;
        let (u, v) = across(n);
        let c = self.of.centre();
        let half: [f64; 3] = std::array::from_fn(|k| {
            let (low, high) = (c[k] - self.of.min[k], self.of.max[k] - c[k]);
            (if low > high { low } else { high }).next_up()
        });
        let size = add_up(add_up(half[0], half[1]), half[2]);
        let shadow = |d: [f64; 3]| {
            let sum = (0..3).fold(0.0, |sum, k| add_up(sum, mul_up(d[k].abs(), half[k])));
            add_up(sum, mul_up(CROOKED, size))
        };
        let (a, b) = (shadow(u), shadow(v));
        let tilt = |d: [f64; 3]| dot(self.slope.gradient, exactly(d)).magnitude();
        let sideways = add_up(mul_up(a, tilt(u)), mul_up(b, tilt(v)));
        let base = div_up(add_up(self.value.magnitude(), sideways), growth.rate);
        // A little more, so that the rounded middles of top and bottom are beyond δ as well.
        let height = mul_up(add_up(base, steps), 1.0 + CROOKED);
        // δ > 0 is needed for the strict side.
        let height = add_up(height, mul_up(CROOKED, size));
        let fits = (0..3).all(|k| {
            let side =
                add_up(add_up(mul_up(u[k].abs(), a), mul_up(v[k].abs(), b)), mul_up(n[k].abs(), height));
            side <= sub_down(c[k], self.about.min[k]) && side <= sub_down(self.about.max[k], c[k])
        });
        fits.then_some(height)
    }

    /// Whether the mesh winds differently around the middles of top and bottom, which are beyond δ.
    fn separated(&self, growth: &Growth, height: f64, strays: f64, target: &Target) -> bool {
        let c = self.of.centre();
        let at = |s: f64| -> [f64; 3] { std::array::from_fn(|k| c[k] + s * growth.along[k]) };
        let (top, bottom) = (at(height), at(-height));
        let value = |p: [f64; 3]| self.value + dot(self.slope.gradient, step(p, c));
        if !(self.about.contains(top) && self.about.contains(bottom)) {
            return false;
        }
        if !(value(top).lo() > strays && value(bottom).hi() < -strays) {
            return false;
        }
        let winding = |p: [f64; 3]| target.enclosure.inside(p).winding.value;
        let (above, below) = (winding(top), winding(bottom));
        // NaN on the surface itself, which differs from nothing.
        above.is_finite() && below.is_finite() && above != below
    }
}

/// Two directions across `n`, all three of length 1 and across each other up to rounding.
fn across(n: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let least = (0..3).fold(0, |best, k| if n[k].abs() < n[best].abs() { k } else { best });
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let u = unit(crate::math::cross(n, axis));
    (u, unit(crate::math::cross(n, u)))
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let norm = crate::math::dot(v, v).sqrt();
    v.map(|x| x / norm)
}
