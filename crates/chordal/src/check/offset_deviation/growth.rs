//! Whether the distance to the source has no local maximum where free points could hide.
//!
//! *Growth.* Let a cell have its middle c within ρ of all its points, and let d be the distance of c to the source. A face
//! that is nearest to some point of the cell has a distance of at most d + 2ρ from c. The way from a convex set's nearest
//! point to a point changes by no more than the point itself. So if o is the way from such a face to c, the way to any
//! point of the cell has a component of at least o·g − ρ along a unit vector g, and if that is above 0 for all such faces,
//! the distance grows along g throughout the cell.
use super::copies::{Copies, CopySide};
use super::{OffsetSource, hull};
use crate::budget::{Job, JobError, OpenPlace, par_map};
use crate::explicit::{Bvh, Mesh, WindingMoments, nearest_on_triangle};
use crate::math::{
    Box3, add_up, difference, distance, dot, greater, length, length_up, mul_down, mul_up, sub_up, unit,
};

/// A cube.
#[derive(Clone, Copy, Debug)]
struct GrowthCell {
    middle: [f64; 3],
    /// Half of the side.
    half: f64,
    /// Middles of parts are off by some roundings of the first cell's coordinates for each halving.
    slack: f64,
}

impl GrowthCell {
    /// The largest distance from the middle, rounding of corners included.
    fn radius(&self) -> f64 {
        add_up(mul_up(self.half, 1.732_050_807_568_878), self.slack)
    }

    fn place(&self) -> OpenPlace {
        OpenPlace { at: self.middle, size: 2.0 * self.radius(), area: 0.0, contact: None }
    }

    fn parts(&self) -> impl Iterator<Item = Self> + '_ {
        let half = 0.5 * self.half;
        (0..8_usize).map(move |c| Self {
            middle: std::array::from_fn(|k| self.middle[k] + if c >> k & 1 == 1 { half } else { -half }),
            half,
            slack: self.slack,
        })
    }
}

/// What is known of a cell.
enum Verdict {
    /// No free points, or they lead out of it.
    Settled,
    /// All of its points are free, but the near copy does not wind around it as it should.
    Missed,
    Unknown,
}

/// A cell larger than this share of the radius is not examined for growth: the ball around it could meet the source.
const LARGEST: f64 = 0.6;
/// The most faces near a cell that are examined before the cell is cut, unless it is small.
const MANY: usize = 2048;
/// Cells of a task.
const TASK: usize = 64;
/// Steps in the search for a direction.
const STEPS: usize = 24;
/// Cells smaller than this share of the limit are not cut.
const SMALLEST: f64 = 0.25;

/// Cells that could hide free points within the near copy.
pub(super) fn open_cells(
    copies: &Copies,
    source: &OffsetSource,
    limit: f64,
    job: &Job,
) -> Result<Vec<OpenPlace>, JobError> {
    let copy = copies.mesh(CopySide::Near);
    let bvh = Bvh::build(copy, job)?;
    let moments = WindingMoments::new(copy, &bvh);
    let enclosure = moments.enclosure(&bvh);
    let wanted = if source.is_outward { 0.0 } else { 1.0 };
    // Outside of the box there are no points of the near copy, and all free points there are joined to each other.
    let Box3 { min: low, max: high } =
        hull(&corners_of(&source.mesh).chain(corners_of(copy)).collect::<Vec<_>>());
    let half = 0.505 * (0..3).fold(0.0, |most, k| greater(high[k] - low[k], most));
    let middle = std::array::from_fn(|k| 0.5 * low[k] + 0.5 * high[k]);
    let largest = middle.iter().fold(half, |most: f64, x: &f64| greater(most, x.abs()));
    // Some roundings for each of at most fifty halvings.
    let first = GrowthCell { middle, half, slack: 64.0 * f64::EPSILON * largest };
    if !first.radius().is_finite() || !enclosure.is_closed() {
        return Ok(vec![first.place()]);
    }
    let mut level = vec![first];
    let mut open = Vec::new();
    while !level.is_empty() {
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let tasks: Vec<&[GrowthCell]> = level.chunks(TASK).collect();
        let verdicts = par_map(job, &tasks, |_, cells| {
            let mut row = 0;
            let is_outside_copy = |p| enclosure.inside(p).winding.value == wanted;
            cells
                .iter()
                .map(|cell| examine(cell, source, is_outside_copy, &mut row))
                .collect::<Vec<Verdict>>()
        });
        let mut next = Vec::new();
        for (cell, verdict) in level.iter().zip(verdicts.into_iter().flatten()) {
            match verdict {
                Verdict::Settled => {}
                Verdict::Missed => open.push(cell.place()),
                Verdict::Unknown if cell.half < SMALLEST * limit => open.push(cell.place()),
                Verdict::Unknown => next.extend(cell.parts()),
            }
        }
        level = next;
    }
    Ok(open)
}

fn examine(
    cell: &GrowthCell,
    source: &OffsetSource,
    is_outside_copy: impl Fn([f64; 3]) -> bool,
    row: &mut u32,
) -> Verdict {
    let radius = cell.radius();
    let Some([low, high]) = source.bvh.closest_distance_ends(cell.middle, row) else {
        // Without triangles all points are free, and the first cell is the whole of the near copy.
        return if source.mesh.faces().is_empty() { Verdict::Settled } else { Verdict::Unknown };
    };
    if add_up(high, radius) < source.radius {
        return Verdict::Settled;
    }
    if low > add_up(source.radius, radius) {
        let is_free = source.is_on_free_side(cell.middle);
        return if !is_free || is_outside_copy(cell.middle) { Verdict::Settled } else { Verdict::Missed };
    }
    let is_settled = radius <= LARGEST * source.radius && grows(cell.middle, radius, high, source)
        // On the other side all points are near.
        || low > radius && !source.is_on_free_side(cell.middle);
    if is_settled { Verdict::Settled } else { Verdict::Unknown }
}

fn corners_of(mesh: &Mesh) -> impl Iterator<Item = [f64; 3]> + '_ {
    (0..mesh.faces().len()).flat_map(|face| mesh.corners(face))
}

/// The way from a face to a point, and how far it may be off.
struct FaceWay {
    way: [f64; 3],
    off: f64,
}

/// A coordinate is too large.
struct NotFinite;

impl FaceWay {
    /// The way from the face of a row; none if it is surely farther than `reach`.
    fn new(at: [f64; 3], row: u32, reach: f64, source: &OffsetSource) -> Result<Option<Self>, NotFinite> {
        let [down, _] = source.bvh.distance_bounds(at, row).ok_or(NotFinite)?;
        if down > reach {
            return Ok(None);
        }
        let (corners, _) = source.bvh.triangle_of(row);
        let way = difference(at, nearest_on_triangle(at, corners));
        // A point of a convex set that is hardly farther than the nearest one is near that:
        // |q − q*|² ≤ |p − q|² − |p − q*|².
        let largest = corners.as_flattened().iter().chain(&at).fold(0.0, |most, x| greater(most, x.abs()));
        // The nearest point and the difference have fewer roundings than that.
        let rounding = 64.0 * f64::EPSILON * largest;
        let up = add_up(length_up(way), rounding);
        let off = add_up(sub_up(mul_up(up, up), mul_down(down, down)).sqrt().next_up(), rounding);
        if off.is_finite() { Ok(Some(Self { way, off })) } else { Err(NotFinite) }
    }
}

/// Whether the distance grows along some direction throughout a cell.
fn grows(middle: [f64; 3], radius: f64, distance_up: f64, source: &OffsetSource) -> bool {
    let reach = add_up(distance_up, mul_up(2.0, radius));
    let mut ways: Vec<FaceWay> = Vec::new();
    let mut n_near = 0;
    let mut is_known = true;
    source.bvh.rows_near(middle, reach, |row| {
        n_near += 1;
        if n_near > MANY {
            return;
        }
        match FaceWay::new(middle, row, reach, source) {
            Ok(way) => ways.extend(way),
            Err(NotFinite) => is_known = false,
        }
    });
    if n_near > MANY || !is_known {
        return false;
    }
    // The nearest way's direction, turned towards those that it does not suit.
    let Some(first) = ways.iter().reduce(|a, b| if length(b.way) < length(a.way) { b } else { a }) else {
        return false;
    };
    let Some(mut direction) = unit(first.way) else { return false };
    for _ in 0..STEPS {
        let spare = |way: &FaceWay| dot(way.way, direction) - way.off;
        let Some(worst) = ways.iter().reduce(|a, b| if spare(b) < spare(a) { b } else { a }) else {
            return false;
        };
        // The margin is far above the rounding of the product, whose factors are no longer than `reach` and 1.
        let rounding = 1e-12 * (reach + radius);
        if spare(worst) > (radius + rounding) * length(direction) * (1.0 + 1e-12) {
            return true;
        }
        let Some(towards) = unit(worst.way) else { return false };
        let turned = std::array::from_fn(|k| direction[k] + 0.5 * towards[k]);
        match unit(turned) {
            Some(unit) if distance(unit, direction) > 1e-12 => direction = unit,
            _ => return false,
        }
    }
    false
}
