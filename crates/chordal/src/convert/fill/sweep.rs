//! `sweep`: triangles of what edges enclose, from left to right. Every decision is exact.
//!
//! Between two neighbouring edges that the sweep line crosses lies an interval, inside or outside. Each one inside keeps
//! the chain of points to its left up to which it is triangulated; a point that the line comes to is joined with all
//! points of its chains that it sees.
//!
//! Source: S. Hertel, K. Mehlhorn, *Fast triangulation of simple polygons*, 1983.
use super::arrange::Edge;
use super::grid::{Point, turn};
use crate::explicit::FillRule;
use std::collections::VecDeque;

/// Triangles whose corners are points in a list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Filled {
    /// Corners; each is one of the ends of edges.
    pub points: Vec<Point>,
    /// Counter-clockwise, all with area.
    pub triangles: Vec<[u32; 3]>,
}

/// The triangles of what edges enclose by a rule. Edges are in order and meet only at their ends.
///
/// None if the triangles' area were not exactly that of what the edges enclose, which would be a fault of this file.
pub(crate) fn fill(edges: &[Edge], rule: FillRule) -> Option<Filled> {
    let mut sweep = Sweep::new(edges, rule);
    sweep.run();
    let border = sweep.border();
    let filled = if border.len() == edges.len() {
        sweep.filled
    } else {
        // Edges with the same on both sides would only cost triangles.
        let mut again = Sweep::new(&border, FillRule::NonZero);
        again.run();
        again.filled
    };
    (twice_area_of(&filled) == twice_area_within(&border)).then_some(filled)
}

fn twice_area_of(filled: &Filled) -> i128 {
    let corners = |t: &[u32; 3]| t.map(|i| filled.points[i as usize]);
    filled.triangles.iter().map(corners).map(|[a, b, c]| turn(a, b, c)).sum()
}

/// Of a border with its inside on the left of edges whose winding is 1.
fn twice_area_within(border: &[Edge]) -> i128 {
    let cross =
        |a: Point, b: Point| i128::from(a[0]) * i128::from(b[1]) - i128::from(a[1]) * i128::from(b[0]);
    border.iter().map(|edge| i128::from(edge.winding) * cross(edge.from, edge.to)).sum()
}

/// The points to the left of an interval, from its lower edge to its upper one, and which of them is the rightmost.
#[derive(Debug, Default)]
struct Chain {
    points: VecDeque<u32>,
    rightmost: usize,
}

/// An edge that the sweep line crosses, with the interval above it.
#[derive(Debug)]
struct Active {
    edge: u32,
    /// The winding number above it.
    above: i32,
    /// Of the interval above it, where that is inside.
    chain: Option<Chain>,
}

struct Sweep<'a> {
    edges: &'a [Edge],
    rule: FillRule,
    /// From the lowest to the highest.
    active: Vec<Active>,
    /// For each edge the winding numbers below and above it.
    sides: Vec<[i32; 2]>,
    filled: Filled,
}

impl<'a> Sweep<'a> {
    /// `edges` are in order, so that those that start at one point stand together.
    fn new(edges: &'a [Edge], rule: FillRule) -> Self {
        let sides = vec![[0; 2]; edges.len()];
        Self { edges, rule, active: Vec::new(), sides, filled: Filled::default() }
    }

    fn run(&mut self) {
        let edges = self.edges;
        let mut points: Vec<Point> = edges.iter().flat_map(|edge| [edge.from, edge.to]).collect();
        points.sort_unstable();
        points.dedup();
        let n_points = points.len() as u32;
        self.filled.points = points;
        let mut first = 0;
        for index in 0..n_points {
            let point = self.place(index);
            let n = edges[first..].iter().take_while(|edge| edge.from == point).count();
            let mut right: Vec<u32> = (first..first + n).map(|edge| edge as u32).collect();
            // From the lowest to the highest: the next one is to the left of the one before.
            right.sort_unstable_by(|a, b| {
                let ends = [edges[*a as usize].to, edges[*b as usize].to];
                0.cmp(&turn(point, ends[0], ends[1]))
            });
            first += n;
            self.point(point, index, &right);
        }
    }

    fn place(&self, point: u32) -> Point {
        self.filled.points[point as usize]
    }

    /// Edges that have inside on one side only, with inside on their left where their winding is 1.
    fn border(&self) -> Vec<Edge> {
        let inside = |winding: i32| i32::from(self.rule.holds(winding));
        let sides = self.edges.iter().zip(&self.sides);
        let all =
            sides.map(|(edge, [below, above])| Edge { winding: inside(*above) - inside(*below), ..*edge });
        all.filter(|edge| edge.winding != 0).collect()
    }

    /// Moves the line over a point: edges that end there leave, those that start there come.
    fn point(&mut self, at: Point, index: u32, right: &[u32]) {
        let edges = self.edges;
        let side = |active: &Active| {
            let edge = edges[active.edge as usize];
            turn(edge.from, edge.to, at)
        };
        let low = self.active.partition_point(|active| side(active) > 0);
        // Edges meet only at their ends: what the point lies on ends there.
        let n_left = self.active[low..].iter().take_while(|active| side(active) == 0).count();
        let mut left: Vec<Active> = self.active.splice(low..low + n_left, []).collect();
        let below = if low > 0 { self.active[low - 1].chain.take() } else { None };
        let outermost = left.pop();
        for closed in left.into_iter().filter_map(|active| active.chain) {
            self.close(closed, index);
        }
        let (below, above) = match outermost {
            Some(last) => (
                below.map(|chain| self.join_at_top(chain, index)),
                last.chain.map(|chain| self.join_at_bottom(chain, index)),
            ),
            None => self.split(below, index, right.is_empty()),
        };
        let mut winding = if low > 0 { self.active[low - 1].above } else { 0 };
        if right.is_empty() {
            if low > 0 {
                self.active[low - 1].chain = merged(below, above);
            }
            return;
        }
        if low > 0 {
            self.active[low - 1].chain = below;
        }
        let mut coming = Vec::with_capacity(right.len());
        for edge in right {
            let before = winding;
            winding += edges[*edge as usize].winding;
            self.sides[*edge as usize] = [before, winding];
            let inside = self.rule.holds(winding);
            let chain = inside.then(|| Chain { points: VecDeque::from([index]), rightmost: 0 });
            coming.push(Active { edge: *edge, above: winding, chain });
        }
        if let Some(last) = coming.last_mut()
            && last.chain.is_some()
            && above.is_some()
        {
            last.chain = above;
        }
        self.active.splice(low..low, coming);
    }

    fn corner(&self, [a, b, c]: [u32; 3]) -> i128 {
        turn(self.place(a), self.place(b), self.place(c))
    }

    /// Cuts a triangle off if it has area.
    fn cut(&mut self, corners: [u32; 3]) -> bool {
        let has_area = self.corner(corners) > 0;
        if has_area {
            self.filled.triangles.push(corners);
        }
        has_area
    }

    /// The lower edge of an interval ends at a point.
    fn join_at_bottom(&mut self, mut chain: Chain, at: u32) -> Chain {
        while let [Some(&a), Some(&b)] = [chain.points.front(), chain.points.get(1)] {
            if !self.cut([at, b, a]) {
                break;
            }
            chain.points.pop_front();
        }
        chain.points.push_front(at);
        chain.rightmost = 0;
        chain
    }

    /// The upper edge of an interval ends at a point.
    fn join_at_top(&mut self, mut chain: Chain, at: u32) -> Chain {
        while let Some(before) = chain.points.len().checked_sub(2) {
            let (a, b) = (chain.points[before + 1], chain.points[before]);
            if !self.cut([at, a, b]) {
                break;
            }
            chain.points.pop_back();
        }
        chain.points.push_back(at);
        chain.rightmost = chain.points.len() - 1;
        chain
    }

    /// Both edges of an interval end at a point: it sees what is left of the chain.
    fn close(&mut self, chain: Chain, at: u32) {
        self.join_at_bottom(chain, at);
    }

    /// A point inside an interval, where edges start: it is joined with the rightmost point to its left.
    fn split(&mut self, chain: Option<Chain>, at: u32, is_lone: bool) -> (Option<Chain>, Option<Chain>) {
        let Some(mut lower) = chain else { return (None, None) };
        if is_lone {
            return (Some(lower), None);
        }
        let upper = lower.points.split_off(lower.rightmost);
        lower.points.extend(upper.front().copied());
        let upper = Chain { points: upper, rightmost: 0 };
        (Some(self.join_at_top(lower, at)), Some(self.join_at_bottom(upper, at)))
    }
}

/// Two intervals become one behind the end of the edges between them; both chains have the point of that end.
fn merged(lower: Option<Chain>, upper: Option<Chain>) -> Option<Chain> {
    let (Some(mut lower), Some(mut upper)) = (lower, upper) else { return None };
    upper.points.pop_front();
    let rightmost = lower.points.len() - 1;
    if upper.points.len() <= lower.points.len() {
        lower.points.extend(upper.points);
        return Some(Chain { rightmost, ..lower });
    }
    while let Some(point) = lower.points.pop_back() {
        upper.points.push_front(point);
    }
    Some(Chain { points: upper.points, rightmost })
}

#[cfg(test)]
mod tests {
    use super::super::arrange::arrange;
    use super::*;
    use crate::budget::Job;

    fn filled(contours: &[Vec<Point>], rule: FillRule) -> Filled {
        fill(&arrange(contours, &Job::default()).unwrap(), rule).unwrap()
    }

    fn area(contours: &[Vec<Point>], rule: FillRule) -> i128 {
        twice_area_of(&filled(contours, rule)) / 2
    }

    fn square(x: i64, y: i64, size: i64) -> Vec<Point> {
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
        let star: Vec<Point> = (0..24)
            .map(|i| {
                let angle = f64::from(i) * std::f64::consts::PI / 12.0;
                let r = if i % 2 == 0 { 1000.0 } else { 300.0 };
                [(r * libm::cos(angle)) as i64, (r * libm::sin(angle)) as i64]
            })
            .collect();
        let made = filled(&[star], FillRule::NonZero);
        assert_eq!((made.points.len(), made.triangles.len()), (24, 22));
        assert_eq!(filled(&[vec![[0, 0], [1, 0]]], FillRule::NonZero), Filled::default());
    }

    /// How often contours wind around a point that is on none of them.
    fn winding(contours: &[Vec<Point>], p: Point) -> i32 {
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
    fn points_far_from_random_contours_are_covered_once_where_the_rule_says_and_nowhere_else() {
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
                contours.push((0..n).map(|_| [below(size), below(size)]).collect::<Vec<Point>>());
            }
            for rule in [FillRule::NonZero, FillRule::EvenOdd] {
                let made = filled(&contours, rule);
                for _ in 0..50 {
                    // Odd places of a grid twice as fine lie on no point of it.
                    let p = [2 * below(size) + 1, 2 * below(size) + 1];
                    let double = |q: Point| q.map(|x| 2 * x);
                    let doubled: Vec<Vec<Point>> =
                        contours.iter().map(|c| c.iter().map(|q| double(*q)).collect()).collect();
                    let near = doubled.iter().flat_map(|c| c.iter().zip(c.iter().cycle().skip(1)));
                    // Chains leave their segments by at most half a diagonal of a cell.
                    if near.into_iter().any(|(a, b)| distance_sq(*a, *b, p) <= 2.1) {
                        continue;
                    }
                    let covers = |t: &&[u32; 3]| {
                        let [a, b, c] = t.map(|i| double(made.points[i as usize]));
                        turn(a, b, p) > 0 && turn(b, c, p) > 0 && turn(c, a, p) > 0
                            || (turn(a, b, p) == 0 && turn(b, c, p) > 0 && turn(c, a, p) > 0 && a < b)
                            || (turn(b, c, p) == 0 && turn(c, a, p) > 0 && turn(a, b, p) > 0 && b < c)
                            || (turn(c, a, p) == 0 && turn(a, b, p) > 0 && turn(b, c, p) > 0 && c < a)
                    };
                    let times = made.triangles.iter().filter(covers).count();
                    let expected = usize::from(rule.holds(winding(&doubled, p)));
                    assert_eq!(times, expected, "{rule:?} {contours:?} {p:?}");
                }
            }
        }
    }

    fn distance_sq(a: Point, b: Point, p: Point) -> f64 {
        let d = [(b[0] - a[0]) as f64, (b[1] - a[1]) as f64];
        let q = [(p[0] - a[0]) as f64, (p[1] - a[1]) as f64];
        let t = ((q[0] * d[0] + q[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
        let t = if t.is_nan() { 0.0 } else { t };
        (q[0] - t * d[0]).powi(2) + (q[1] - t * d[1]).powi(2)
    }
}
