//! Bounds the distance between closed polylines and the curve of a field, both ways, by ranges.
//!
//! Let S be the boundary of {F < 0} in the plane.
//!
//! **From S to the lines:** if the range of F over a box has one sign, the box has no point of S except those that a
//! box beside it has too. The points of any other box are within the distance of its middle to some segment plus half
//! of its diagonal; boxes are quartered until that is small enough.
//!
//! **From the lines to S:** the points of a piece of a segment are within half of its length of its middle q. Between
//! a point that is certainly inside and a point that is certainly outside, by the range of F at each, there is a point
//! of S, no farther from q than the farther of the two. No property of F is used, not even continuity.
use super::trace::{ContourBlock, TracedContours};
use crate::budget::{Job, par_map};
use crate::implicit::LeafError;
use crate::math::{Box3, Interval, add_up, div_up, greater, length, length_up, lesser, sub_down};

/// The bounds of the distance, and the point of the upper bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContourDistance {
    pub most: f64,
    pub at: [f64; 2],
    /// A lower bound.
    pub least: f64,
    /// Whether some point is certainly inside.
    pub has_inside: bool,
}

/// Boxes are quartered down to this fraction of the aim, but not below `ROUNDINGS` times the rounding error.
const FINEST: f64 = 1.0 / 16.0;
const ROUNDINGS: f64 = 4.0;
/// Boxes evaluated in one call.
const AT_ONCE: usize = 256;
/// The most pieces of a segment.
const PIECES: f64 = 4096.0;
/// Rings of squares around the square of a point, searched for segments: at first, and at most; each retry takes four
/// times as many.
const RINGS: i64 = 2;
const MOST_RINGS: i64 = 512;

type ContourSegment = [[f64; 2]; 2];

struct ContourProver<'a> {
    traced: &'a TracedContours,
    /// Segments by the square that contains them, row by row.
    segments: Vec<([i64; 2], ContourSegment)>,
    aim: f64,
    /// A length above any distance in the region.
    largest: f64,
    /// The largest move of a point by rounding.
    rounding: f64,
}

/// The distance between the lines and the curve; above `aim` if that is not proved.
pub(super) fn prove(
    traced: &TracedContours,
    bounds: &Box3,
    aim: f64,
    job: &Job,
) -> Result<ContourDistance, LeafError> {
    let mut segments: Vec<([i64; 2], ContourSegment)> = traced
        .blocks
        .iter()
        .flat_map(|block| &block.segments)
        .map(|ends| {
            let segment = ends.map(|row| traced.points[row as usize]);
            let middle = [0, 1].map(|k| 0.5 * (segment[0][k] + segment[1][k]));
            (traced.lattice.square(middle), segment)
        })
        .collect();
    segments.sort_unstable_by(|a, b| {
        // Row by row, so that one search finds the squares of a row that are beside each other.
        [a.0[1], a.0[0]].cmp(&[b.0[1], b.0[0]]).then(a.1[0][0].total_cmp(&b.1[0][0]))
    });
    let reach = bounds.min.iter().chain(&bounds.max).fold(0.0, |m: f64, x| greater(x.abs(), m));
    // A dozen roundings of coordinates up to four times the largest, and underflow.
    let rounding = 32.0 * f64::EPSILON * reach + f64::MIN_POSITIVE;
    let largest = 2.0 * bounds.diagonal() + 8.0 * traced.lattice.step;
    let prover = ContourProver { traced, segments, aim, largest, rounding };
    let results = par_map(job, &traced.blocks, |_, block| prover.block(block, job));
    let mut far = ContourDistance { most: 0.0, at: traced.points[0], least: 0.0, has_inside: false };
    for result in results {
        let result = result?;
        far.has_inside |= result.has_inside;
        if result.most > far.most {
            (far.most, far.at) = (result.most, result.at);
        }
        far.least = greater(result.least, far.least);
    }
    // Without a point that is certainly inside there may be no curve at all.
    far.most = if far.has_inside { far.most } else { f64::INFINITY };
    Ok(far)
}

impl ContourDistance {
    fn include(&mut self, most: f64, at: [f64; 2], largest: f64) {
        let most = lesser(most, largest);
        if most > self.most {
            (self.most, self.at) = (most, at);
        }
    }
}

impl ContourProver<'_> {
    fn block(&self, block: &ContourBlock, job: &Job) -> Result<ContourDistance, LeafError> {
        let mut far = ContourDistance { most: 0.0, at: [0.0; 2], least: 0.0, has_inside: false };
        self.curve_to_lines(block, &mut far, job)?;
        self.lines_to_curve(block, &mut far)?;
        Ok(far)
    }

    fn curve_to_lines(
        &self,
        block: &ContourBlock,
        far: &mut ContourDistance,
        job: &Job,
    ) -> Result<(), LeafError> {
        let block_bounds = self.traced.lattice.bounds(block.place, 1, 0.0);
        let centre = [0, 1].map(|k| 0.5 * (block_bounds.min[k] + block_bounds.max[k]));
        let mut from_block_centre = None;
        let mut open =
            vec![[[block_bounds.min[0], block_bounds.min[1]], [block_bounds.max[0], block_bounds.max[1]]]];
        let mut ranges = Vec::new();
        // The smallest boxes first: a large distance is found soon, and then the other boxes need less depth.
        while !open.is_empty() && !job.is_cancelled() {
            let boxes = open.split_off(open.len().saturating_sub(AT_ONCE));
            let places: Vec<Box3> = boxes
                .iter()
                .map(|[low, high]| Box3 { min: [low[0], low[1], 0.0], max: [high[0], high[1], 0.0] })
                .collect();
            ranges.clear();
            ranges.resize(boxes.len(), Interval::UNKNOWN);
            block.tape.over(&places, &mut ranges)?;
            for ([low, high], range) in boxes.iter().zip(&ranges) {
                if range.is_defined() && (range.lo() >= 0.0 || range.hi() < 0.0) {
                    continue;
                }
                let middle = [0, 1].map(|k| 0.5 * (low[k] + high[k]));
                let half = add_up(length_up([middle[0] - low[0], middle[1] - low[1]]), self.rounding);
                let most = add_up(self.distance_to_lines(middle), half);
                // A box that is not farther than the largest distance so far cannot raise it.
                let enough = greater(self.aim, far.most);
                let finest = FINEST * enough;
                let least = ROUNDINGS * self.rounding;
                if most > enough && half > greater(finest, least) {
                    let [x, y] = middle;
                    open.extend([
                        [*low, middle],
                        [[x, low[1]], [high[0], y]],
                        [[low[0], y], [x, high[1]]],
                        [middle, *high],
                    ]);
                    continue;
                }
                if most > enough {
                    // Without a segment near, the distance is infinite. The way by the block's centre gives a
                    // finite bound, and its search is made once.
                    let from_centre =
                        *from_block_centre.get_or_insert_with(|| self.distance_to_any_line(centre));
                    let aside = length_up([middle[0] - centre[0], middle[1] - centre[1]]);
                    let by_centre = add_up(from_centre, add_up(aside, half));
                    far.include(lesser(by_centre, most), middle, self.largest);
                } else {
                    far.include(most, middle, self.largest);
                }
            }
        }
        Ok(())
    }

    /// The distance of a point to the nearest segment, rounded up, if it is within the aim; otherwise an
    /// upper bound, infinite without a segment near.
    fn distance_to_lines(&self, p: [f64; 2]) -> f64 {
        let near = self.distance_in_rings(p, RINGS);
        // Enough squares to hold all segments within the aim.
        let enough_rings = (self.aim / self.traced.lattice.step).ceil() as i64 + 1;
        let far = if near > self.aim && enough_rings > RINGS {
            self.distance_in_rings(p, enough_rings.min(MOST_RINGS))
        } else {
            near
        };
        add_up(far, self.rounding)
    }

    /// The distance of a point to some segment, rounded up; the nearest one, unless the search by squares misses it.
    fn distance_to_any_line(&self, p: [f64; 2]) -> f64 {
        let mut rings = RINGS;
        let mut near = self.distance_in_rings(p, rings);
        // A segment in a farther ring may be nearer than that.
        while near > rings as f64 * self.traced.lattice.step && rings < MOST_RINGS {
            rings *= 4;
            near = self.distance_in_rings(p, rings);
        }
        add_up(near, self.rounding)
    }

    /// The distance to the nearest segment in so many rings of squares.
    fn distance_in_rings(&self, p: [f64; 2], rings: i64) -> f64 {
        let [i, j] = self.traced.lattice.square(p);
        let key = |entry: &([i64; 2], ContourSegment)| [entry.0[1], entry.0[0]];
        let mut best = f64::INFINITY;
        for row in j - rings..=j + rings {
            let start = self.segments.partition_point(|entry| key(entry) < [row, i - rings]);
            for (_, [a, b]) in
                self.segments[start..].iter().take_while(|entry| key(entry) <= [row, i + rings])
            {
                let (d, q) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
                // Any t from 0 to 1 gives a point of the segment, so rounding can only enlarge the distance.
                let t = (q[0] * d[0] + q[1] * d[1]) / (d[0] * d[0] + d[1] * d[1]);
                let t = if t > 0.0 { lesser(t, 1.0) } else { 0.0 };
                let far = length_up([q[0] - t * d[0], q[1] - t * d[1]]);
                best = lesser(far, best);
            }
        }
        best
    }

    fn lines_to_curve(&self, block: &ContourBlock, far: &mut ContourDistance) -> Result<(), LeafError> {
        // The middle, the normal, and half of the length of each piece.
        let mut pieces: Vec<([f64; 2], [f64; 2], f64)> = Vec::new();
        for [a, b] in block.segments.iter().map(|ends| ends.map(|row| self.traced.points[row as usize])) {
            let d = [b[0] - a[0], b[1] - a[1]];
            let long = length_up(d);
            let n = (2.0 * long / self.aim).ceil();
            let n = lesser(n, PIECES);
            let across = [-d[1] / long, d[0] / long];
            for k in 0..n as usize {
                let t = (k as f64 + 0.5) / n;
                pieces.push((
                    [a[0] + t * d[0], a[1] + t * d[1]],
                    across,
                    add_up(div_up(0.5 * long, n), self.rounding),
                ));
            }
        }
        let mut distances = vec![[f64::INFINITY; 2]; pieces.len()];
        let mut ranges = vec![Interval::UNKNOWN; pieces.len()];
        // Inside is on the left. Steps are fractions of the aim; the last four are fractions of the piece
        // itself, for details so small or thin that the others pass over them.
        let steps_of_aim =
            [(0.125, 0), (0.5, 0), (0.96875, 0), (0.5, 1), (0.96875, 1), (0.5, 2), (0.96875, 2)];
        let steps_of_piece = [(1.0, 0), (0.25, 0), (0.0625, 0), (0.015_625, 0)];
        let steps =
            steps_of_aim.map(|step| (step, false)).into_iter().chain(steps_of_piece.map(|step| (step, true)));
        for ((part, turn), is_of_piece) in steps {
            if distances.iter().all(|s| s[0] < f64::INFINITY && s[1] < f64::INFINITY) {
                break;
            }
            for side in 0..2 {
                let points: Vec<Box3> = pieces
                    .iter()
                    .map(|(q, across, half)| {
                        let longest_step = if is_of_piece { *half } else { sub_down(self.aim, *half) };
                        // Beyond the aim the tape of the block may be wrong.
                        let longest_step = lesser(longest_step, self.aim);
                        let longest_step = greater(longest_step, 0.0);
                        let reach = part * longest_step * if side == 0 { 1.0 } else { -1.0 };
                        let [x, y] = *across;
                        // The direction across the piece, along it, or between the two.
                        let d = [[x, y], [y, -x], [0.7 * (x + y), 0.7 * (y - x)]][turn];
                        let p = [q[0] + reach * d[0], q[1] + reach * d[1], 0.0];
                        Box3 { min: p, max: p }
                    })
                    .collect();
                block.tape.over(&points, &mut ranges)?;
                for (((q, _, half), p), (distances, range)) in
                    pieces.iter().zip(&points).zip(distances.iter_mut().zip(&ranges))
                {
                    let side_of_point = if range.is_empty() || !range.is_defined() {
                        continue;
                    } else if range.hi() < 0.0 {
                        0
                    } else if range.lo() >= 0.0 {
                        1
                    } else {
                        continue;
                    };
                    let apart = length_up([p.min[0] - q[0], p.min[1] - q[1]]);
                    let apart = add_up(add_up(apart, self.rounding), *half);
                    far.has_inside |= side_of_point == 0;
                    distances[side_of_point] = lesser(apart, distances[side_of_point]);
                }
            }
        }
        for ((q, _, _), distances) in pieces.iter().zip(&distances) {
            far.include(greater(distances[0], distances[1]), *q, self.largest);
        }
        self.lower_bound(block, &pieces, far)
    }

    /// Raises the lower bound by boxes around middles of segments with one sign throughout.
    fn lower_bound(
        &self,
        block: &ContourBlock,
        pieces: &[([f64; 2], [f64; 2], f64)],
        far: &mut ContourDistance,
    ) -> Result<(), LeafError> {
        let mut ranges = vec![Interval::UNKNOWN; pieces.len()];
        for part in [0.0625, 0.125, 0.25, 0.5] {
            let reach = part * self.aim;
            if reach <= far.least {
                continue;
            }
            let boxes: Vec<Box3> = pieces
                .iter()
                .map(|(q, ..)| Box3 {
                    min: [q[0] - reach, q[1] - reach, 0.0],
                    max: [q[0] + reach, q[1] + reach, 0.0],
                })
                .collect();
            block.tape.over(&boxes, &mut ranges)?;
            let clear = |range: &Interval| {
                range.is_defined() && !range.is_empty() && (range.lo() >= 0.0 || range.hi() < 0.0)
            };
            // If even the smaller boxes have both signs, the larger ones do.
            if !ranges.iter().any(clear) {
                break;
            }
            far.least = sub_down(reach, self.rounding);
        }
        Ok(())
    }
}

/// The number of segments.
pub(super) fn count_segments(traced: &TracedContours) -> u64 {
    traced.lines.iter().map(|line| line.len() as u64).sum()
}

/// Estimates the largest distance of a segment's middle from the curve.
pub(super) fn estimate(traced: &TracedContours, job: &Job) -> Result<f64, LeafError> {
    use crate::implicit::Dual;
    let distances = par_map(job, &traced.blocks, |_, block| -> Result<f64, LeafError> {
        let points: Vec<[f64; 3]> = block
            .segments
            .iter()
            .map(|ends| {
                let [a, b] = ends.map(|row| traced.points[row as usize]);
                [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.0]
            })
            .collect();
        let mut slopes = vec![Dual { value: 0.0, gradient: [0.0; 3] }; points.len()];
        block.tape.gradient_at(&points, &mut slopes)?;
        Ok(slopes.iter().fold(0.0, |most, slope| {
            // To first order; where the gradient vanishes, this says nothing.
            let far = slope.value.abs() / length([slope.gradient[0], slope.gradient[1]]);
            if far.is_finite() && far > most { far } else { most }
        }))
    });
    distances.into_iter().try_fold(0.0, |most, one| one.map(|one| greater(one, most)))
}
