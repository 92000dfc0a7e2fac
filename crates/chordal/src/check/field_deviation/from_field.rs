//! From the surface of a field to a mesh.
//!
//! Boxes with a change of sign are examined from large to small. Let B be one, n a direction along which the
//! field grows, u and v perpendicular to it, and c a point on the line along n through the middle of B, about
//! where the surface meets it. Let E be a box around B and around the column N = {c + a·u + b·v + s·n: |a| ≤
//! A, |b| ≤ A', |s| ≤ H} over the shadow of B. In E the field shall be Lipschitz with gradients in G, and
//! grow along n at a rate of g > 0.
//!
//! Let δ be the largest |F| on the triangles that meet E. If F > δ on the top of N (s = H) and F < −δ on its
//! bottom, the mesh meets neither; and if the winding numbers of the mesh around the middle of the top and
//! that of the bottom differ, every line along n from bottom to top crosses the mesh: both ends of the line
//! have the winding numbers of the middles, as top and bottom are connected and free of the mesh. Now let p
//! be a point of the surface in B, and t = δ/g. On its line, F is above δ from p + t·n upwards, and below −δ
//! from p − t·n downwards, so the mesh is crossed between the two: it is within t of p.
//!
//! By the mean value theorem F at c + a·u + b·v + s·n is at least `F(c) + g·s − A·|G·u| − A'·|G·v|` for s ≥
//! 0, which determines how high H must be; and |s| of any p of the surface in B is at most
//! `(|F(c)| + A·|G·u| + A'·|G·v|)/g`. n, c and E are chosen in rounded arithmetic; the quantities in the
//! argument are computed from those choices.
//!
//! If that fails (edges of opposite turn, stationary points of the field, meshes that are not closed), a
//! box is settled by the distance of its middle to the mesh, plus its half diagonal; or it is split.
use super::slope::{GrowthRate, dot, exactly, is_lipschitz, step};
use super::sub_boxes;
use crate::explicit::{Bvh, Enclosure};
use crate::implicit::{Dual, LeafError, Tape};
use crate::math::{
    Box3, Interval, add_up, cross, div_up, greater, lesser, mul_up, sub_down, unit_and_length,
};

/// The mesh, with the data that the search needs.
pub(super) struct TargetMesh<'a> {
    pub bvh: &'a Bvh,
    pub enclosure: &'a Enclosure<'a>,
    /// The largest |F| on each face; ∞ if unknown.
    pub residuals: &'a [f64],
    /// The sufficient distance.
    pub tolerance: f64,
}

impl TargetMesh<'_> {
    /// The largest |F| on the faces that may meet a box; `None` if there is no face.
    fn residual_in(&self, bounds: &Box3) -> Option<f64> {
        let mut most = None;
        self.bvh.faces_in_box(bounds, |face| {
            let of_face = self.residuals[face as usize];
            if most.is_none_or(|most| of_face > most) {
                most = Some(of_face);
            }
        });
        most
    }
}

/// The verdict on a box.
#[derive(Clone, Copy, Debug)]
pub(super) enum BoxVerdict {
    /// The surface does not pass through the box.
    Nothing,
    /// Every point of the surface in the box is this close to the mesh, proved by a column.
    Near(f64),
    /// Every point of the surface in the box is this close to the mesh, by the distance of its centre.
    Open(f64),
}

/// The size of the domain in which a tape is valid, as a multiple of the box: E of a part (a quarter as
/// large) reaches no farther than 3/8 + [`MOST_ROOM`]/8 of its side from its middle, exactly 15/16.
const ROOM: f64 = 2.25;
/// The largest size of E as a multiple of B.
const MOST_ROOM: f64 = 4.5;
/// The height of a column in addition to the mesh's residual, as a share of half of the side of B. Measured:
/// columns over smooth shapes need it if boxes are small enough for everything else.
const BENT: f64 = 0.5;
/// The surface seems to miss the box if it is at more than this multiple of a corner's distance from the
/// centre.
const SEEMS_OFF: f64 = 1.1;
/// A column within this factor of the sufficient distance is refined.
const WORTH: f64 = 2.0;
/// Margin beside a column for the rounding of its sides, as a share: derived as some 20 steps, with a margin
/// of 10⁵. It decides only how often columns fit.
const ASIDE: f64 = 1e-9;
/// The deviation of a column's axes from orthonormality, rounded as they are: derived as some 20 roundings of
/// half a step each, with a thousandfold margin.
const CROOKED: f64 = 1e-12;

/// Whether the surface may pass through each box.
pub(super) fn may_cross(tape: &Tape, boxes: &[Box3]) -> Result<Vec<bool>, LeafError> {
    let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
    tape.over(boxes, &mut ranges)?;
    // If a part of the expression is undefined, the range proves nothing: undefined values count as outside.
    Ok(ranges.iter().map(|range| !(range.is_defined() && (range.lo() >= 0.0 || range.hi() < 0.0))).collect())
}

/// Bounds every box.
pub(super) fn bound_boxes(
    tape: &Tape,
    boxes: &[Box3],
    target: &TargetMesh,
) -> Result<Vec<BoxVerdict>, LeafError> {
    let mut verdicts = vec![None; boxes.len()];
    let middles: Vec<[f64; 3]> = boxes.iter().map(Box3::centre).collect();
    let mut at = vec![Dual { value: 0.0, gradient: [0.0; 3] }; boxes.len()];
    tape.gradient_at(&middles, &mut at)?;
    by_slopes(tape, boxes, &at, &mut verdicts)?;
    if target.enclosure.is_closed() {
        by_columns(tape, boxes, &at, target, &mut verdicts)?;
    }
    let far = |(verdict, bounds): (Option<BoxVerdict>, &Box3)| {
        verdict.unwrap_or_else(|| BoxVerdict::Open(distance_of(bounds, target)))
    };
    Ok(verdicts.into_iter().zip(boxes).map(far).collect())
}

/// Whether the field, extrapolated from its centre, seems to have no zero in the box.
fn seems_off(bounds: &Box3, slope: &Dual<f64>) -> bool {
    let steep = crate::math::length(slope.gradient);
    slope.value.abs() > SEEMS_OFF * 0.5 * bounds.diagonal() * steep
}

/// Finds the boxes that the surface seems to miss and, by the mean value theorem about their centres, does
/// miss: in small boxes that is sharper than the range of a long expression, whose parts vary independently.
fn by_slopes(
    tape: &Tape,
    boxes: &[Box3],
    at: &[Dual<f64>],
    verdicts: &mut [Option<BoxVerdict>],
) -> Result<(), LeafError> {
    let missed: Vec<usize> = (0..boxes.len()).filter(|k| seems_off(&boxes[*k], &at[*k])).collect();
    let missed_boxes: Vec<Box3> = missed.iter().map(|k| boxes[*k]).collect();
    let mut slopes = vec![Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] }; missed.len()];
    tape.gradient_over(&missed_boxes, &mut slopes)?;
    let middles: Vec<Box3> = missed_boxes.iter().map(Box3::centre).map(|c| Box3 { min: c, max: c }).collect();
    let mut values = vec![Interval::UNKNOWN; missed.len()];
    tape.over(&middles, &mut values)?;
    for ((k, bounds), (slope, value)) in missed.into_iter().zip(&missed_boxes).zip(slopes.iter().zip(values))
    {
        let c = bounds.centre();
        // All steps from the centre to points of the box, rounded outward.
        let steps = [0, 1, 2].map(|i| step(bounds.min, c)[i].hull(step(bounds.max, c)[i]));
        let range = value + dot(slope.gradient, steps);
        if is_lipschitz(slope) && value.is_defined() && !range.contains(0.0) {
            verdicts[k] = Some(BoxVerdict::Nothing);
        }
    }
    Ok(())
}

fn by_columns(
    tape: &Tape,
    boxes: &[Box3],
    at: &[Dual<f64>],
    target: &TargetMesh,
    verdicts: &mut [Option<BoxVerdict>],
) -> Result<(), LeafError> {
    // A column crosses the mesh, so without faces nearby there is no column.
    let near: Vec<(usize, f64)> = boxes
        .iter()
        .enumerate()
        .filter(|(k, _)| verdicts[*k].is_none())
        .filter_map(|(k, bounds)| target.residual_in(&tape_domain(bounds)).map(|residual| (k, residual)))
        .collect();
    let columns: Vec<(usize, FieldColumn)> = near
        .iter()
        .filter_map(|(k, residual)| Some((*k, FieldColumn::over(&boxes[*k], &at[*k], *residual)?)))
        .collect();
    let search_boxes: Vec<Box3> = columns.iter().map(|(_, column)| column.search_box).collect();
    let unknown = Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] };
    let mut slopes = vec![unknown; columns.len()];
    tape.gradient_over(&search_boxes, &mut slopes)?;
    let centres: Vec<Box3> =
        columns.iter().map(|(_, column)| Box3 { min: column.centre, max: column.centre }).collect();
    let mut values = vec![Interval::UNKNOWN; columns.len()];
    tape.over(&centres, &mut values)?;
    let mut monotone: Vec<(usize, Box<MonotoneColumn>)> = Vec::new();
    for ((k, column), (slope, value)) in columns.into_iter().zip(slopes.into_iter().zip(values)) {
        match column.classify(slope, value, target) {
            ColumnVerdict::Nothing => verdicts[k] = Some(BoxVerdict::Nothing),
            ColumnVerdict::Blocked => {}
            ColumnVerdict::Monotone(column) => monotone.push((k, column)),
        }
    }
    sharpen(tape, &mut monotone, target.tolerance)?;
    for (k, column) in monotone {
        verdicts[k] = column.verdict(target);
    }
    Ok(())
}

/// Evaluates the gradient over the parts of E, if the range over all of E gives slightly too slow a growth:
/// that range is a box, whose width along n includes the variation across n.
fn sharpen(tape: &Tape, columns: &mut [(usize, Box<MonotoneColumn>)], enough: f64) -> Result<(), LeafError> {
    let loose: Vec<usize> = (0..columns.len()).filter(|k| columns[*k].1.near > enough).collect();
    // In batches that need little memory.
    for batch in loose.chunks(64) {
        let parts: Vec<Box3> =
            batch.iter().flat_map(|k| sub_boxes(&columns[*k].1.column.search_box)).collect();
        let unknown = Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] };
        let mut slopes = vec![unknown; parts.len()];
        tape.gradient_over(&parts, &mut slopes)?;
        for (k, slopes) in batch.iter().zip(slopes.chunks_exact(64)) {
            columns[*k].1.sharpen(slopes);
        }
    }
    Ok(())
}

/// An upper bound on the distance of points of the box from the mesh: that of its centre plus half its
/// diagonal.
pub(super) fn distance_of(bounds: &Box3, target: &TargetMesh) -> f64 {
    let middle = target.bvh.closest_distance_up(bounds.centre()).unwrap_or(f64::INFINITY);
    // The centre is rounded: it is off by less than two steps of the largest coordinate along each axis.
    add_up(middle, add_up(mul_up(0.5, bounds.diagonal()), mul_up(4.0 * f64::EPSILON, reach(bounds))))
}

/// A lower bound on the distance of points of the box from the mesh.
pub(super) fn at_least(bounds: &Box3, target: &TargetMesh) -> f64 {
    let middle = target.bvh.closest_distance_down(bounds.centre()).unwrap_or(0.0);
    // The centre is rounded: it is off by less than two steps of the largest coordinate along each axis.
    sub_down(middle, add_up(mul_up(0.5, bounds.diagonal()), mul_up(4.0 * f64::EPSILON, reach(bounds))))
}

fn reach(bounds: &Box3) -> f64 {
    bounds.min.iter().chain(&bounds.max).fold(0.0, |most: f64, x| greater(x.abs(), most))
}

/// The box in which the tape of a box is valid, for its parts as well.
pub(super) fn tape_domain(bounds: &Box3) -> Box3 {
    scaled_about_centre(bounds, ROOM)
}

fn scaled_about_centre(bounds: &Box3, times: f64) -> Box3 {
    let c = bounds.centre();
    let half = |k: usize| times * 0.5 * (bounds.max[k] - bounds.min[k]);
    Box3 { min: std::array::from_fn(|k| c[k] - half(k)), max: std::array::from_fn(|k| c[k] + half(k)) }
}

/// A column with its box.
struct FieldColumn {
    centre: [f64; 3],
    /// n, u and v.
    axes: [[f64; 3]; 3],
    /// A and A'.
    halves: [f64; 2],
    /// The sum of the sides of B and of the distance to its middle.
    size: f64,
    /// E.
    search_box: Box3,
}

impl FieldColumn {
    /// Chooses a column from the field's slope at the middle of B; `None` if it is not promising.
    fn over(bounds: &Box3, slope: &Dual<f64>, residual: f64) -> Option<Self> {
        let c = bounds.centre();
        let steep = crate::math::length(slope.gradient);
        //         n ↑   ┌───────────┐   F > δ: the mesh misses this lid …
        //               │  ┌─────┐  │
        //             ~~~~~~~B~~~~~~~~  the surface; the mesh is somewhere beside it, within δ/g
        //               │  └─────┘  │
        //               └───────────┘   F < −δ: … and this one, and winds differently around the two
        // A first-order guess of where the surface meets the axis of the column.
        let shift = -slope.value / steep;
        let half: [f64; 3] =
            std::array::from_fn(|k| greater(c[k] - bounds.min[k], bounds.max[k] - c[k]).next_up());
        let side = greater(half[0], greater(half[1], half[2]));
        // The surface seems to pass beyond the corners of B, so it is not in it.
        if !(steep > 0.0 && shift.is_finite() && shift.abs() <= 2.0 * side) {
            return None;
        }
        let n = slope.gradient.map(|x| x / steep);
        let (u, v) = across(n);
        let centre: [f64; 3] = std::array::from_fn(|k| c[k] + shift * n[k]);
        let size = add_up(add_up(add_up(half[0], half[1]), half[2]), shift.abs());
        let shadow = |d: [f64; 3]| {
            let sum = (0..3).fold(0.0, |sum, k| add_up(sum, mul_up(d[k].abs(), half[k])));
            // The vector from the middle to the centre is along n up to rounding.
            let aside = dot(step(centre, c), exactly(d)).magnitude();
            add_up(add_up(sum, aside), mul_up(CROOKED, size))
        };
        let halves = [shadow(u), shadow(v)];
        // As high as the triangles nearby require, with a margin for curvature.
        let height = 1.25 * residual / steep + BENT * side;
        // As wide as `height` will require, with a margin for rounding.
        let extent = |k: usize| u[k].abs() * halves[0] + v[k].abs() * halves[1] + n[k].abs() * height;
        let reach = |k: usize| (1.0 + ASIDE) * extent(k);
        let column = Box3 {
            min: std::array::from_fn(|k| centre[k] - reach(k)),
            max: std::array::from_fn(|k| centre[k] + reach(k)),
        };
        let search_box = bounds.union(column);
        let largest = scaled_about_centre(bounds, MOST_ROOM);
        let fits = largest.contains(search_box.min) && largest.contains(search_box.max);
        fits.then_some(Self { centre, axes: [n, u, v], halves, size, search_box })
    }

    fn classify(self, slope: Dual<Interval>, value: Interval, target: &TargetMesh) -> ColumnVerdict {
        let range = slope.value;
        if range.is_defined() && (range.lo() >= 0.0 || range.hi() < 0.0) {
            return ColumnVerdict::Nothing;
        }
        if !is_lipschitz(&slope) || !value.is_defined() {
            return ColumnVerdict::Blocked;
        }
        let Some(growth) = GrowthRate::along_direction(&slope, self.axes[0]) else {
            return ColumnVerdict::Blocked;
        };
        // The residual over all faces that meet E, which may be more than the faces from which E was chosen.
        let Some(residual) = target.residual_in(&self.search_box) else { return ColumnVerdict::Blocked };
        let near = mul_up(growth.steps_for(residual), growth.length);
        if near > WORTH * target.tolerance || near.is_nan() {
            return ColumnVerdict::Blocked;
        }
        ColumnVerdict::Monotone(Box::new(MonotoneColumn {
            column: self,
            slope,
            value,
            growth,
            residual,
            near,
        }))
    }
}

/// The verdict on a box by its column.
enum ColumnVerdict {
    /// The surface does not pass through it.
    Nothing,
    /// The field may be stationary, or the mesh's residual is too large.
    Blocked,
    Monotone(Box<MonotoneColumn>),
}

/// A column in which the field grows.
struct MonotoneColumn {
    column: FieldColumn,
    slope: Dual<Interval>,
    /// F(c).
    value: Interval,
    growth: GrowthRate,
    /// δ.
    residual: f64,
    /// t, as a length.
    near: f64,
}

impl MonotoneColumn {
    /// Replaces the growth by the slowest one over the parts of E, if that is faster.
    fn sharpen(&mut self, slopes: &[Dual<Interval>]) {
        let axis = exactly(self.column.axes[0]);
        let slowest = slopes.iter().fold(f64::INFINITY, |least, slope| {
            let rate = if is_lipschitz(slope) { dot(slope.gradient, axis).lo() } else { 0.0 };
            lesser(rate, least)
        });
        if slowest > self.growth.rate && slowest < f64::INFINITY {
            self.growth.rate = slowest;
            self.near = mul_up(self.growth.steps_for(self.residual), self.growth.length);
        }
    }

    fn verdict(&self, target: &TargetMesh) -> Option<BoxVerdict> {
        let height = self.height()?;
        self.separated(height, target).then_some(BoxVerdict::Near(self.near))
    }

    /// H, if the column of that height lies in E.
    fn height(&self) -> Option<f64> {
        let FieldColumn { centre: c, axes: [n, u, v], halves: [a, b], size, search_box } = &self.column;
        let (a, b) = (*a, *b);
        let tilt = |d: &[f64; 3]| dot(self.slope.gradient, exactly(*d)).magnitude();
        let sideways = add_up(mul_up(a, tilt(u)), mul_up(b, tilt(v)));
        let base = div_up(add_up(self.value.magnitude(), sideways), self.growth.rate);
        let steps = self.growth.steps_for(self.residual);
        // A little more, so that the rounded middles of top and bottom are usually beyond δ, which is tested.
        let height = mul_up(add_up(base, steps), 1.0 + CROOKED);
        // δ > 0 is needed for the strict side.
        let height = add_up(height, mul_up(CROOKED, *size));
        let fits = (0..3).all(|k| {
            let side =
                add_up(add_up(mul_up(u[k].abs(), a), mul_up(v[k].abs(), b)), mul_up(n[k].abs(), height));
            side <= sub_down(c[k], search_box.min[k]) && side <= sub_down(search_box.max[k], c[k])
        });
        fits.then_some(height)
    }

    /// Whether the winding numbers differ around the middles of top and bottom, at which F is beyond δ.
    fn separated(&self, height: f64, target: &TargetMesh) -> bool {
        let FieldColumn { centre: c, axes, search_box, .. } = &self.column;
        let at = |s: f64| -> [f64; 3] { std::array::from_fn(|k| c[k] + s * axes[0][k]) };
        let (top, bottom) = (at(height), at(-height));
        let value = |p: [f64; 3]| self.value + dot(self.slope.gradient, step(p, *c));
        if !(search_box.contains(top) && search_box.contains(bottom)) {
            return false;
        }
        if !(value(top).lo() > self.residual && value(bottom).hi() < -self.residual) {
            return false;
        }
        let winding = |p: [f64; 3]| target.enclosure.inside(p).winding.value;
        let (above, below) = (winding(top), winding(bottom));
        // NaN on the surface itself does not count as different.
        above.is_finite() && below.is_finite() && above != below
    }
}

/// Two directions perpendicular to `n`; all three are orthonormal up to rounding.
fn across(n: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let least = (0..3).fold(0, |best, k| if n[k].abs() < n[best].abs() { k } else { best });
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let u = unit_and_length(cross(n, axis)).0;
    (u, unit_and_length(cross(n, u)).0)
}
