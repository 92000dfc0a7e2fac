//! The closest point of the surface, with bounds of the distance from both sides.
use super::super::{Dual, LeafError};
use super::octree::{FieldOctree, FieldOctreeError};
use crate::budget::{Job, par_map};
use crate::math::{Box3, Interval, dot, greater, length, lesser, unit};
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// The closest point of the surface to a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldClosestPoint {
    /// A point at the surface: the inside end of a bracket, whose other end is outside.
    pub place: [f64; 3],
    /// A lower bound of the distance: interval arithmetic proves that closer parts of space are on one side.
    pub at_least: f64,
    /// An upper bound of the distance: within it there are a point outside and one inside.
    pub at_most: f64,
}

/// Steps along the gradient to a first point. Chosen: walks that need more seldom converge.
const STEPS: usize = 24;
/// The most boxes that are divided for one query.
const MOST_PARTS: usize = 4096;
/// Halvings of a bracket: as many as a number has binary digits, and some more.
const HALVINGS: usize = 60;

/// The closest point to each query, with its distance enclosed to the fraction `within` if possible. `None`
/// if no point was found: there is no surface in the cells, or no step across it shows a change of sign.
///
/// A point is found by steps along the gradient from the query and from the nearest cells, and bracketed.
/// Then boxes are divided, the nearest first, until no closer box may contain the surface.
///
/// # Errors
/// When a leaf fails.
pub fn closest_points(
    cells: &FieldOctree,
    points: &[[f64; 3]],
    within: f64,
    job: &Job,
) -> Result<Vec<Option<FieldClosestPoint>>, FieldOctreeError> {
    let results = par_map(job, points, |_, p| FieldClosestSearch { cells, point: *p, within }.run());
    results.into_iter().map(|result| result.map_err(FieldOctreeError::from)).collect()
}

struct FieldClosestSearch<'a> {
    cells: &'a FieldOctree,
    point: [f64; 3],
    within: f64,
}

/// A box that may contain surface, ordered by its distance; equal ones by age.
struct CandidateBox {
    distance: f64,
    age: usize,
    bounds: Box3,
    tape: u32,
}

impl PartialEq for CandidateBox {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for CandidateBox {}
impl PartialOrd for CandidateBox {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for CandidateBox {
    fn cmp(&self, other: &Self) -> Ordering {
        self.distance.total_cmp(&other.distance).then(self.age.cmp(&other.age))
    }
}

impl FieldClosestSearch<'_> {
    fn run(&self) -> Result<Option<FieldClosestPoint>, LeafError> {
        let mut best: Option<FieldClosestPoint> = None;
        self.try_start(self.point, &mut best)?;
        let mut open: BinaryHeap<Reverse<CandidateBox>> = (self.cells.cells.iter().enumerate())
            .map(|(age, cell)| {
                let (bounds, tape) = (cell.bounds, cell.tape);
                Reverse(CandidateBox { distance: self.distance_to(&bounds), age, bounds, tape })
            })
            .collect();
        let mut age = open.len();
        let mut at_least = f64::INFINITY;
        for parts in 0.. {
            let Some(Reverse(part)) = open.pop() else { break };
            // Boxes come in the order of their distance: one that is not near enough ends the search.
            let farthest = best.map_or(f64::INFINITY, |best| best.at_most);
            if part.distance >= farthest * (1.0 - self.within) || parts >= MOST_PARTS {
                at_least = part.distance;
                break;
            }
            // A surface point in this box would be the closest so far.
            self.try_start(part.bounds.centre(), &mut best)?;
            age = self.divide(&part, &mut open, age)?;
        }
        Ok(best.map(|best| {
            let at_least = lesser(at_least, best.at_most);
            FieldClosestPoint { at_least, ..best }
        }))
    }

    fn divide(
        &self,
        part: &CandidateBox,
        open: &mut BinaryHeap<Reverse<CandidateBox>>,
        mut age: usize,
    ) -> Result<usize, LeafError> {
        let tape = &self.cells.tapes[part.tape as usize];
        let middle = part.bounds.centre();
        let eighths: Vec<Box3> = (0..8)
            .map(|i| {
                let ends = |k: usize| {
                    let b = &part.bounds;
                    if i >> k & 1 == 0 { [b.min[k], middle[k]] } else { [middle[k], b.max[k]] }
                };
                Box3 { min: [0, 1, 2].map(|k| ends(k)[0]), max: [0, 1, 2].map(|k| ends(k)[1]) }
            })
            .collect();
        let mut ranges = [Interval::UNKNOWN; 8];
        tape.over(&eighths, &mut ranges)?;
        for (bounds, range) in eighths.into_iter().zip(ranges) {
            // An interval that ends at 0 stays open: the surface is where the sign changes, and neighbouring
            // closed boxes share it.
            let clear = range.is_empty() || range.lo() > 0.0 || (range.hi() < 0.0 && range.is_defined());
            if !clear {
                age += 1;
                let distance = self.distance_to(&bounds);
                open.push(Reverse(CandidateBox { distance, age, bounds, tape: part.tape }));
            }
        }
        Ok(age)
    }

    /// The distance to a box, lowered by its own rounding.
    fn distance_to(&self, b: &Box3) -> f64 {
        let offset: [f64; 3] = std::array::from_fn(|k| {
            let (below, above) = (b.min[k] - self.point[k], self.point[k] - b.max[k]);
            let gap = greater(below, above);
            greater(gap, 0.0)
        });
        length(offset) * (1.0 - 8.0 * f64::EPSILON)
    }

    /// Walks from a point to the surface and along it towards the query, and keeps the bracket if it is
    /// nearer. If that leads over an edge, tries the surface below the point itself.
    fn try_start(&self, from: [f64; 3], best: &mut Option<FieldClosestPoint>) -> Result<(), LeafError> {
        if !self.descend(from, 0.5, best)? {
            self.descend(from, 0.0, best)?;
        }
        Ok(())
    }

    /// Whether a walk found the surface, by steps of this share along the tangent plane towards the query.
    fn descend(
        &self,
        from: [f64; 3],
        share: f64,
        best: &mut Option<FieldClosestPoint>,
    ) -> Result<bool, LeafError> {
        let tape = self.cells.tape();
        let mut slope = [Dual { value: 0.0, gradient: [0.0; 3] }];
        let mut x = from;
        for _ in 0..STEPS {
            tape.gradient_at(&[x], &mut slope)?;
            let g = slope[0].gradient;
            let (Some(n), value) = (unit(g), slope[0].value) else { break };
            let length = dot(g, n);
            let down = value / length;
            if !down.is_finite() {
                break;
            }
            let closest: [f64; 3] = std::array::from_fn(|k| x[k] - n[k] * down);
            // Along the tangent plane.
            let offset: [f64; 3] = std::array::from_fn(|k| self.point[k] - closest[k]);
            let up = dot(offset, n);
            let next: [f64; 3] = std::array::from_fn(|k| closest[k] + share * (offset[k] - n[k] * up));
            let moved: [f64; 3] = std::array::from_fn(|k| next[k] - x[k]);
            x = next;
            // Less than a few roundings of a coordinate: the walk has converged.
            if dot(moved, moved).sqrt() <= 4.0 * f64::EPSILON * self.cells.size {
                break;
            }
        }
        tape.gradient_at(&[x], &mut slope)?;
        let Some(n) = unit(slope[0].gradient) else { return Ok(false) };
        // Steps across the surface, starting at 2⁻⁴⁰ of the size, are widened until the sign changes.
        let mut width = self.cells.size / 1_099_511_627_776.0;
        for _ in 0..12 {
            let ends = [-1.0, 1.0].map(|side| std::array::from_fn(|k| x[k] + side * width * n[k]));
            let mut values = [0.0; 2];
            tape.at(&ends, &mut values)?;
            let inside = [values[0] < 0.0, values[1] < 0.0];
            if inside == [true, false] {
                self.bisect(ends, best)?;
                return Ok(true);
            }
            width *= 4.0;
        }
        Ok(false)
    }

    fn bisect(
        &self,
        [inside, outside]: [[f64; 3]; 2],
        best: &mut Option<FieldClosestPoint>,
    ) -> Result<(), LeafError> {
        let (mut a, mut b) = (inside, outside);
        for _ in 0..HALVINGS {
            let middle: [f64; 3] = std::array::from_fn(|k| a[k] + 0.5 * (b[k] - a[k]));
            // No point lies between the ends.
            if middle == a || middle == b {
                break;
            }
            let mut value = [0.0];
            self.cells.tape().at(&[middle], &mut value)?;
            if value[0] < 0.0 { a = middle } else { b = middle }
        }
        let distance = |p: [f64; 3]| {
            let offset: [f64; 3] = std::array::from_fn(|k| p[k] - self.point[k]);
            // Rounded up: a length has six roundings.
            length(offset) * (1.0 + 8.0 * f64::EPSILON)
        };
        let (to_a, to_b) = (distance(a), distance(b));
        let at_most = greater(to_a, to_b);
        if best.is_none_or(|best| at_most < best.at_most) {
            *best = Some(FieldClosestPoint { place: a, at_least: 0.0, at_most });
        }
        Ok(())
    }
}
