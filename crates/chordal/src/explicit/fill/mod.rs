//! Filling contours: snap rounding to a grid, so that they meet only at its points, and a sweep that
//! triangulates.
pub(crate) mod arrange;
mod chains;
mod grid_box_tree;
pub(crate) mod snap_grid;
mod status;
pub(crate) mod sweep;

use arrange::GridEdge;
use snap_grid::{GridPoint, turn};
use std::cmp::Ordering;
use sweep::{InsideRule, SweepEdge, SweepPoint, sweep};

/// Triangles over a list of points.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct FillTriangles {
    /// The corners; each is an end of an edge.
    pub points: Vec<GridPoint>,
    /// Counter-clockwise, all with area.
    pub triangles: Vec<[u32; 3]>,
}

impl SweepPoint for GridPoint {
    #[inline]
    fn turn(a: Self, b: Self, c: Self) -> Ordering {
        snap_grid::side(a, b, c)
    }
}

/// Triangulates the region that edges enclose by a rule. Edges are in order and meet only at their ends.
///
/// None if edges cross or the triangles' area is not exactly that of the enclosed region, which would be a
/// bug in this module.
pub(crate) fn fill(edges: &[GridEdge], rule: InsideRule) -> Option<FillTriangles> {
    let mut points: Vec<GridPoint> = edges.iter().flat_map(|edge| [edge.from, edge.to]).collect();
    points.sort_unstable();
    points.dedup();
    let index = |p: GridPoint| points.binary_search(&p).map_or(u32::MAX, |i| i as u32);
    let indexed = edges.iter().map(|edge| SweepEdge {
        from: index(edge.from),
        to: index(edge.to),
        winding: edge.winding,
    });
    let swept = sweep(&points, indexed.collect(), rule).ok()?;
    let within = twice_area_within(&points, &swept.border);
    let filled = FillTriangles { points, triangles: swept.triangles };
    (twice_area_of(&filled) == within).then_some(filled)
}

fn twice_area_of(filled: &FillTriangles) -> i128 {
    let corners = |t: &[u32; 3]| t.map(|i| filled.points[i as usize]);
    filled.triangles.iter().map(corners).map(|[a, b, c]| turn(a, b, c)).sum()
}

/// Twice the area within a border; the inside is on the left of edges with winding 1.
fn twice_area_within(points: &[GridPoint], border: &[SweepEdge]) -> i128 {
    let cross = |a: GridPoint, b: GridPoint| {
        i128::from(a[0]) * i128::from(b[1]) - i128::from(a[1]) * i128::from(b[0])
    };
    let ends = |edge: &SweepEdge| [edge.from, edge.to].map(|i| points[i as usize]);
    border
        .iter()
        .map(|edge| (i128::from(edge.winding[0]), ends(edge)))
        .map(|(w, [a, b])| w * cross(a, b))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::arrange::{GridContour, arrange};
    use super::*;
    use crate::budget::Job;
    use crate::explicit::FillRule;

    fn filled(contours: &[Vec<GridPoint>], rule: FillRule) -> FillTriangles {
        let contours: Vec<GridContour> =
            contours.iter().map(|points| GridContour { points: points.clone(), kind: 0 }).collect();
        fill(&arrange(&contours, &Job::default()).unwrap(), InsideRule::Fill(rule)).unwrap()
    }

    fn area(contours: &[Vec<GridPoint>], rule: FillRule) -> i128 {
        twice_area_of(&filled(contours, rule)) / 2
    }

    fn square(x: i64, y: i64, size: i64) -> Vec<GridPoint> {
        vec![[x, y], [x + size, y], [x + size, y + size], [x, y + size]]
    }

    #[test]
    fn rules_differ_where_contours_overlap() {
        let two = [square(0, 0, 10), square(5, 5, 10)];
        assert_eq!(area(&two, FillRule::NonZero), 175);
        assert_eq!(area(&two, FillRule::EvenOdd), 150);
        let mut hole = square(2, 2, 4);
        hole.reverse();
        let holed = [square(0, 0, 10), hole];
        assert_eq!(area(&holed, FillRule::NonZero), 84);
        assert_eq!(area(&holed, FillRule::EvenOdd), 84);
        let nested = [square(0, 0, 10), square(2, 2, 4)];
        assert_eq!(area(&nested, FillRule::NonZero), 100);
        assert_eq!(filled(&nested, FillRule::NonZero).triangles.len(), 2);
        // A bow tie: two triangles that meet at the crossing.
        let bow = [vec![[0, 0], [10, 10], [10, 0], [0, 10]]];
        assert_eq!(area(&bow, FillRule::NonZero), 50);
        assert_eq!(area(&bow, FillRule::EvenOdd), 50);
    }

    #[test]
    fn a_polygon_of_n_corners_gives_two_triangles_fewer() {
        let star: Vec<GridPoint> = (0..24)
            .map(|i| {
                let angle = f64::from(i) * std::f64::consts::PI / 12.0;
                let r = if i % 2 == 0 { 1000.0 } else { 300.0 };
                [(r * libm::cos(angle)) as i64, (r * libm::sin(angle)) as i64]
            })
            .collect();
        let triangles = filled(&[star], FillRule::NonZero);
        assert_eq!((triangles.points.len(), triangles.triangles.len()), (24, 22));
        assert_eq!(filled(&[vec![[0, 0], [1, 0]]], FillRule::NonZero), FillTriangles::default());
    }

    /// The winding number of contours around a point that is on none of them.
    fn winding(contours: &[Vec<GridPoint>], p: GridPoint) -> i32 {
        let sides = contours.iter().flat_map(|c| c.iter().zip(c.iter().cycle().skip(1)));
        sides.fold(0, |sum, (a, b)| {
            if (a[1] <= p[1]) == (b[1] <= p[1]) {
                return sum;
            }
            let left = turn(*a, *b, p) > 0;
            sum + i32::from(left && b[1] > p[1]) - i32::from(!left && b[1] <= p[1])
        })
    }

    #[test]
    fn points_far_from_random_contours_are_covered_once_if_inside_and_never_if_outside() {
        let seed = 77_u64;
        println!("seed {seed}");
        let mut state = seed;
        let mut below = |n: i64| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 20) as i64 % n
        };
        for round in 0..600 {
            let size = [8, 40, 1 << 20][round % 3];
            let mut contours = Vec::new();
            for _ in 0..1 + below(3) {
                let n = 3 + below(20);
                contours.push((0..n).map(|_| [below(size), below(size)]).collect::<Vec<GridPoint>>());
            }
            for rule in [FillRule::NonZero, FillRule::EvenOdd] {
                let triangles = filled(&contours, rule);
                for _ in 0..50 {
                    // Odd coordinates of a grid twice as fine lie on no point of it.
                    let p = [2 * below(size) + 1, 2 * below(size) + 1];
                    let double = |q: GridPoint| q.map(|x| 2 * x);
                    let doubled: Vec<Vec<GridPoint>> =
                        contours.iter().map(|c| c.iter().map(|q| double(*q)).collect()).collect();
                    let near = doubled.iter().flat_map(|c| c.iter().zip(c.iter().cycle().skip(1)));
                    // Chains deviate from their segments by at most half a diagonal of a cell.
                    if near.into_iter().any(|(a, b)| distance_sq(*a, *b, p) <= 2.1) {
                        continue;
                    }
                    let covers = |t: &&[u32; 3]| {
                        let [a, b, c] = t.map(|i| double(triangles.points[i as usize]));
                        turn(a, b, p) > 0 && turn(b, c, p) > 0 && turn(c, a, p) > 0
                            || (turn(a, b, p) == 0 && turn(b, c, p) > 0 && turn(c, a, p) > 0 && a < b)
                            || (turn(b, c, p) == 0 && turn(c, a, p) > 0 && turn(a, b, p) > 0 && b < c)
                            || (turn(c, a, p) == 0 && turn(a, b, p) > 0 && turn(b, c, p) > 0 && c < a)
                    };
                    let times = triangles.triangles.iter().filter(covers).count();
                    let expected = usize::from(rule.holds(winding(&doubled, p)));
                    assert_eq!(times, expected, "{rule:?} {contours:?} {p:?}");
                }
            }
        }
    }

    fn distance_sq(a: GridPoint, b: GridPoint, p: GridPoint) -> f64 {
        let d = [(b[0] - a[0]) as f64, (b[1] - a[1]) as f64];
        let q = [(p[0] - a[0]) as f64, (p[1] - a[1]) as f64];
        let t = ((q[0] * d[0] + q[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
        let t = if t.is_nan() { 0.0 } else { t };
        (q[0] - t * d[0]).powi(2) + (q[1] - t * d[1]).powi(2)
    }
}
