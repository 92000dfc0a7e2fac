//! `arrange`: snap rounding of contours, which reroutes them to meet only at grid points.
//!
//! A cell is hot if a corner lies in it or two segments cross in it. Each segment becomes the chain of the
//! centres of the hot cells that it passes, in order. Then no two segments cross any more, and each contour
//! can be deformed into its chain without any of its points leaving its cell.
//!
//! Source: J. D. Hobby, *Practical segment intersection with finite precision output*, 1999.
use super::grid_box_tree::{GridBox, GridBoxTree};
use super::snap_grid::{GridPoint, side, turn};
use super::sweep::WindingPair;
use crate::budget::Job;

/// An edge of the arrangement, from its lower end (by x, then y) to its upper one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct GridEdge {
    pub from: GridPoint,
    pub to: GridPoint,
    /// The number of contours of each kind along it, minus those in the other direction. Not 0.
    pub winding: WindingPair,
}

/// A closed contour of the first kind (0) or the second (1).
#[derive(Clone, Debug, Default)]
pub(crate) struct GridContour {
    pub points: Vec<GridPoint>,
    pub kind: usize,
}

/// Why there is no arrangement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArrangeError {
    /// More pairs of segments lie close together than the limit.
    TooManyPairs,
    /// The job was cancelled.
    Cancelled,
}

/// The most pairs of close segments that are tested: per segment, and the smallest total limit. Chosen:
/// outlines of glyphs and maps have fewer than 10 per segment; at 20 ns a pair the total is about a second.
const PAIRS_EACH: u64 = 2_000;
const PAIRS_ALL: u64 = 50_000_000;

/// The edges of closed contours, in order, which meet only at their ends.
pub(crate) fn arrange(contours: &[GridContour], job: &Job) -> Result<Vec<GridEdge>, ArrangeError> {
    // Equal overlapping sides are merged, however many there are.
    let sides = summed(sides_of(contours));
    let segments: Vec<[GridPoint; 2]> = sides.iter().map(|side| [side.from, side.to]).collect();
    let mut hot = crossings(&segments, job)?;
    hot.extend(segments.iter().flatten());
    hot.sort_unstable();
    hot.dedup();
    let cells = GridBoxTree::new(hot.iter().map(|cell| around(*cell)).collect());
    let mut edges = Vec::with_capacity(segments.len());
    let mut chain = Vec::new();
    for (i, [a, b]) in segments.iter().enumerate() {
        if i % 4096 == 0 && job.is_cancelled() {
            return Err(ArrangeError::Cancelled);
        }
        chain.clear();
        // In half steps, so that the borders of cells are integers.
        let doubled = [doubled(*a), doubled(*b)];
        cells.along(doubled, |cell| {
            let cell = hot[cell as usize];
            if passes(doubled, cell) {
                chain.push(cell);
            }
        });
        // The tree reports cells in its own order.
        chain.sort_unstable_by_key(|cell| along([*a, *b], *cell));
        edges.extend(chain.windows(2).map(|pair| directed([pair[0], pair[1]], sides[i].winding)));
    }
    Ok(summed(edges))
}

fn sides_of(contours: &[GridContour]) -> Vec<GridEdge> {
    let sides = |GridContour { points, kind }: &GridContour| -> Vec<GridEdge> {
        let mut once = [0; 2];
        once[*kind] = 1;
        let next = points.iter().cycle().skip(1);
        points.iter().zip(next).filter(|(a, b)| a != b).map(|(a, b)| directed([*a, *b], once)).collect()
    };
    contours.iter().flat_map(sides).collect()
}

fn doubled(p: GridPoint) -> GridPoint {
    p.map(|x| 2 * x)
}

/// The box of a cell in half steps.
fn around(cell: GridPoint) -> GridBox {
    let middle = doubled(cell);
    GridBox { min: middle.map(|x| x - 1), max: middle.map(|x| x + 1) }
}

/// The cells in which the interiors of two segments cross.
fn crossings(segments: &[[GridPoint; 2]], job: &Job) -> Result<Vec<GridPoint>, ArrangeError> {
    let tree = GridBoxTree::new(segments.iter().map(|[a, b]| GridBox::around(*a, *b)).collect());
    let limit = PAIRS_ALL.max(PAIRS_EACH.saturating_mul(segments.len() as u64));
    let (mut n_pairs, mut stop) = (0_u64, None);
    let mut cells = Vec::new();
    tree.pairs(|one, other| {
        n_pairs += 1;
        if n_pairs.is_multiple_of(1 << 16) && job.is_cancelled() {
            stop = Some(ArrangeError::Cancelled);
        } else if n_pairs > limit {
            stop = Some(ArrangeError::TooManyPairs);
        }
        cells.extend(crossing(segments[one as usize], segments[other as usize]));
        stop.is_none()
    });
    stop.map_or(Ok(cells), Err)
}

/// The cell in which two segments cross, if each strictly separates the other's ends.
fn crossing([a, b]: [GridPoint; 2], [c, d]: [GridPoint; 2]) -> Option<GridPoint> {
    let parts = |[a, b]: [GridPoint; 2], [c, d]: [GridPoint; 2]| {
        let sides = (side(a, b, c), side(a, b, d));
        sides.0.is_ne() && sides.0 == sides.1.reverse()
    };
    if !parts([a, b], [c, d]) || !parts([c, d], [a, b]) {
        return None;
    }
    let [from_a, from_b] = [turn(c, d, a), turn(c, d, b)];
    // a + (b − a)·s with s = from_a / (from_a − from_b), between 0 and 1, rounded to the centre of its cell.
    let (over, under) = (from_a, from_a - from_b);
    let (over, under) = if under < 0 { (-over, -under) } else { (over, under) };
    // Halves are rounded up, since a cell includes its left and lower borders.
    let rounded = |k: usize| {
        let moved = 2 * i128::from(b[k] - a[k]) * over + under;
        a[k] + moved.div_euclid(2 * under) as i64
    };
    Some([rounded(0), rounded(1)])
}

/// Whether a segment, in half steps, passes a cell, which includes its left and lower borders but not the
/// other two.
fn passes([a, b]: [GridPoint; 2], cell: GridPoint) -> bool {
    let square = around(cell);
    let GridBox { min, max } = square;
    if !square.meets(&GridBox::around(a, b)) {
        return false;
    }
    // Ends lie on even numbers and borders on odd ones, so if boxes meet, their interiors do. Then the
    // segment passes the interior unless all corners are on one side; on the border it can only touch a
    // corner.
    let at_lower = side(a, b, min);
    let sides = [at_lower, side(a, b, [max[0], min[1]]), side(a, b, [min[0], max[1]]), side(a, b, max)];
    let (left, right) = (sides.iter().any(|side| side.is_gt()), sides.iter().any(|side| side.is_lt()));
    left && right || at_lower.is_eq()
}

/// The position of a cell along a segment, without a unit. Along each axis, cells that a segment passes are
/// in the order of its direction.
fn along([a, b]: [GridPoint; 2], cell: GridPoint) -> i128 {
    (0..2).map(|k| i128::from(b[k] - a[k]) * i128::from(cell[k] - a[k])).sum()
}

/// An edge with this winding in the direction from the first point to the second.
fn directed([a, b]: [GridPoint; 2], winding: WindingPair) -> GridEdge {
    if a < b {
        GridEdge { from: a, to: b, winding }
    } else {
        GridEdge { from: b, to: a, winding: winding.map(|w| -w) }
    }
}

/// Merges edges between the same points, and removes those that cancel.
fn summed(mut edges: Vec<GridEdge>) -> Vec<GridEdge> {
    edges.sort_unstable();
    edges.dedup_by(|next, merged| {
        let same = (next.from, next.to) == (merged.from, merged.to);
        if same {
            (0..2).for_each(|k| merged.winding[k] += next.winding[k]);
        }
        same
    });
    edges.retain(|edge| edge.winding != [0; 2]);
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arranged(contours: &[Vec<GridPoint>]) -> Result<Vec<GridEdge>, ArrangeError> {
        let first = |points: &Vec<GridPoint>| GridContour { points: points.clone(), kind: 0 };
        arrange(&contours.iter().map(first).collect::<Vec<_>>(), &Job::default())
    }

    /// Whether two edges meet anywhere except at common ends.
    fn collide(one: &GridEdge, other: &GridEdge) -> bool {
        let (a, b, c, d) = (one.from, one.to, other.from, other.to);
        let inside = |p: GridPoint, [a, b]: [GridPoint; 2]| {
            turn(a, b, p) == 0 && p != a && p != b && GridBox::around(a, b).meets(&GridBox::around(p, p))
        };
        crossing([a, b], [c, d]).is_some()
            || inside(c, [a, b])
            || inside(d, [a, b])
            || inside(a, [c, d])
            || inside(b, [c, d])
    }

    #[test]
    fn edges_of_random_contours_meet_only_at_their_ends() {
        let seed = 20_261_120_u64;
        println!("seed {seed}");
        let mut state = seed;
        let mut below = |n: i64| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 20) as i64 % n
        };
        for round in 0..2000 {
            // Small grids have many collinear points and nearby crossings.
            let size = [4, 9, 30, 1000, 1 << 35][round % 5];
            let n = 3 + below(12);
            let contour: Vec<GridPoint> =
                (0..n).map(|_| [below(size) - size / 2, below(size) - size / 2]).collect();
            let edges = arranged(std::slice::from_ref(&contour)).unwrap();
            for (i, one) in edges.iter().enumerate() {
                assert!(one.from < one.to);
                assert!(!edges[..i].iter().any(|other| collide(one, other)), "{contour:?}");
            }
            // In- and outgoing windings are equal at every point.
            let mut sums = std::collections::BTreeMap::new();
            for edge in &edges {
                *sums.entry(edge.from).or_insert(0) += edge.winding[0];
                *sums.entry(edge.to).or_insert(0) -= edge.winding[0];
            }
            assert!(sums.values().all(|sum| *sum == 0), "{contour:?}");
        }
    }

    #[test]
    fn contours_that_run_back_on_themselves_leave_nothing() {
        let there_and_back = vec![[0, 0], [10, 3], [20, 6], [10, 3]];
        assert_eq!(arranged(&[there_and_back]).unwrap(), []);
        let twice = vec![[0, 0], [4, 0], [0, 4], [0, 0], [4, 0], [0, 4]];
        assert!(arranged(&[twice]).unwrap().iter().all(|edge| edge.winding[0].abs() == 2));
    }
}
