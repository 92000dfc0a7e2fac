//! `sweep`: a sweep-line triangulation of the region enclosed by edges, from left to right. Every decision is
//! exact.
//!
//! Between two neighbouring edges on the sweep line lies an interval, inside or outside. Each inside interval
//! keeps the monotone chain of points that bounds its triangulated part on the left. A new point is joined to
//! all visible points of its chains.
//!
//! Edges are given as pairs of points. If a point lies on an edge that does not end there, or edges overlap,
//! they are split at that point, which moves no point. Edges are tested for crossing whenever they become
//! neighbours (Shamos and Hoey): so a result without an error proves that no edges cross.
//!
//! Sources: S. Hertel, K. Mehlhorn, *Fast triangulation of simple polygons*, 1983; M. Shamos, D. Hoey,
//! *Geometric intersection problems*, 1976.
use super::chains::{MonotoneChain, MonotoneChains};
use super::status::SweepStatus;
use crate::explicit::FillRule;
use std::cmp::Ordering;

/// The predicate of the sweep's points.
pub(crate) trait SweepPoint: Copy {
    /// The side of the line from `a` to `b` on which `c` lies: left is greater. Exact.
    fn turn(a: Self, b: Self, c: Self) -> Ordering;
}

/// An edge between two points, from the earlier to the later one in the sweep's order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SweepEdge {
    pub from: u32,
    pub to: u32,
    /// The numbers of contours of the first and of the second kind along it, minus those in the other
    /// direction.
    pub winding: WindingPair,
}

/// Winding numbers of contours of two kinds.
pub(crate) type WindingPair = [i32; 2];

/// The rule that decides what is inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum InsideRule {
    /// By a fill rule, for contours of the first kind.
    Fill(FillRule),
    /// Inside contours of the first kind and outside those of the second kind, the holes.
    LessHoles,
}

impl InsideRule {
    fn holds(self, winding: WindingPair) -> bool {
        match self {
            Self::Fill(rule) => rule.holds(winding[0]),
            Self::LessHoles => winding[0] != 0 && winding[1] == 0,
        }
    }
}

/// Two edges cross at a point that is not an end of either.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct EdgeCrossing;

/// The result of a sweep.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct SweepResult {
    /// Indices of points; counter-clockwise, all with area.
    pub triangles: Vec<[u32; 3]>,
    /// The edges between inside and outside. The winding of the first kind is 1 if the inside is on their
    /// left, −1 if it is on their right.
    pub border: Vec<SweepEdge>,
    /// The number of points at which more than two edges meet, or that lie inside an edge.
    pub touching: usize,
    /// The number of edges, or parts, that overlap others.
    pub overlapping: usize,
    /// The number of edges, or parts, with inside or outside on both sides.
    pub useless: usize,
    /// The number of edges, or parts, next to a region with a negative winding number.
    pub backwards: usize,
}

/// Triangulates the region that `edges` enclose. `points` are distinct and sorted by x, then y.
///
/// # Errors
/// [`EdgeCrossing`], as soon as one is found.
pub(crate) fn sweep<P: SweepPoint>(
    points: &[P],
    edges: Vec<SweepEdge>,
    rule: InsideRule,
) -> Result<SweepResult, EdgeCrossing> {
    let mut first = Sweep::new(points, edges, rule);
    first.run()?;
    let border = first.border();
    let useless = first.n_edges - border.len();
    let triangles = if useless == 0 {
        first.triangles
    } else {
        // Edges with the inside, or the outside, on both sides would only add triangles.
        let mut border_sweep = Sweep::new(points, border.clone(), InsideRule::Fill(FillRule::NonZero));
        border_sweep.run()?;
        border_sweep.triangles
    };
    let (touching, overlapping) = (first.touching, first.overlapping);
    let is_backwards = |sides: &&[WindingPair; 2]| sides.as_flattened().iter().any(|winding| *winding < 0);
    let backwards = first.sides.iter().flatten().filter(is_backwards).count();
    Ok(SweepResult { triangles, border, touching, overlapping, useless, backwards })
}

/// Marks a missing edge.
const NONE: u32 = u32::MAX;

struct Sweep<'a, P> {
    points: &'a [P],
    edges: Vec<SweepEdge>,
    rule: InsideRule,
    /// For each point the first of the edges that start there, and for each edge the next one.
    first: Vec<u32>,
    next: Vec<u32>,
    /// The edges that the line crosses, from the lowest to the highest.
    active: SweepStatus,
    /// For each edge the winding numbers below and above it; `None` until the line reaches it.
    sides: Vec<Option<[WindingPair; 2]>>,
    /// For each active edge the chain of the interval above it, if that is inside.
    above: Vec<Option<MonotoneChain>>,
    chains: MonotoneChains,
    left: Vec<u32>,
    right: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    /// The number of edges, parts included, without those that cancelled out.
    n_edges: usize,
    touching: usize,
    overlapping: usize,
}

impl<'a, P: SweepPoint> Sweep<'a, P> {
    fn new(points: &'a [P], edges: Vec<SweepEdge>, rule: InsideRule) -> Self {
        let n = edges.len();
        let mut sweep = Self {
            points,
            rule,
            first: vec![NONE; points.len()],
            next: vec![NONE; n],
            active: SweepStatus::default(),
            sides: vec![None; n],
            above: vec![None; n],
            chains: MonotoneChains::default(),
            left: Vec::new(),
            right: Vec::new(),
            triangles: Vec::with_capacity(n),
            edges,
            n_edges: 0,
            touching: 0,
            overlapping: 0,
        };
        // In reverse, so that lists have the order of the edges.
        (0..n as u32).rev().for_each(|edge| sweep.start(edge));
        sweep
    }

    fn start(&mut self, edge: u32) {
        let from = self.edges[edge as usize].from as usize;
        self.next[edge as usize] = std::mem::replace(&mut self.first[from], edge);
    }

    fn run(&mut self) -> Result<(), EdgeCrossing> {
        (0..self.points.len() as u32).try_for_each(|at| self.process_point(at))
    }

    fn border(&self) -> Vec<SweepEdge> {
        let inside = |winding: WindingPair| i32::from(self.rule.holds(winding));
        let reached = self.edges.iter().zip(&self.sides).filter_map(|(edge, sides)| Some((edge, (*sides)?)));
        let all = reached
            .map(|(edge, [below, above])| SweepEdge { winding: [inside(above) - inside(below), 0], ..*edge });
        all.filter(|edge| edge.winding[0] != 0).collect()
    }

    fn turn(&self, a: u32, b: u32, c: u32) -> Ordering {
        P::turn(self.points[a as usize], self.points[b as usize], self.points[c as usize])
    }

    /// Moves the line over a point: removes the edges that end there and adds those that start there.
    fn process_point(&mut self, at: u32) -> Result<(), EdgeCrossing> {
        // 1. Find the edges that end here, and split those that pass.
        let (points, edges) = (self.points, &self.edges);
        let point = points[at as usize];
        let side = |edge: u32| {
            let SweepEdge { from, to, .. } = edges[edge as usize];
            if to == at {
                Ordering::Equal
            } else {
                P::turn(points[from as usize], points[to as usize], point)
            }
        };
        let position = self.active.take(side, &mut self.left);
        self.gather_starting(at);
        let mut is_passed = false;
        for k in 0..self.left.len() {
            let edge = self.left[k];
            if self.edges[edge as usize].to != at {
                is_passed = true;
                self.cut_edge(edge, at);
            }
        }
        self.sort_right(at);
        if self.left.is_empty() && self.right.is_empty() {
            // No edge has this point, or all edges that start here cancelled out.
            return Ok(());
        }
        self.touching += usize::from(is_passed || self.left.len() + self.right.len() > 2);
        // 2. Close the intervals on the left.
        let low = self.active.before(position);
        let below = low.and_then(|low| self.above[low as usize].take());
        let outermost = self.left.pop();
        for k in 0..self.left.len() {
            if let Some(chain) = self.above[self.left[k] as usize].take() {
                self.join_at_bottom(chain, at);
            }
        }
        self.left.clear();
        let (below, above) = match outermost {
            Some(last) => {
                let last = self.above[last as usize].take();
                (
                    below.map(|chain| self.join_at_top(chain, at)),
                    last.map(|chain| self.join_at_bottom(chain, at)),
                )
            }
            None => self.split(below, at),
        };
        // 3. Open the intervals on the right.
        if self.right.is_empty() {
            if let Some(low) = low {
                self.above[low as usize] =
                    below.zip(above).map(|(below, above)| self.chains.merge(below, above));
            }
            let high = self.active.at(position);
            return low.zip(high).map_or(Ok(()), |(low, high)| self.expect_apart(low, high));
        }
        if let Some(low) = low {
            self.above[low as usize] = below;
        }
        self.begin(at, low, above);
        let (lowest, highest) = (self.right[0], self.right[self.right.len() - 1]);
        let high = self.active.at(position);
        self.active.insert(position, &self.right);
        if let Some(low) = low {
            self.expect_apart(low, lowest)?;
        }
        high.map_or(Ok(()), |high| self.expect_apart(highest, high))
    }

    /// Collects the edges that start at a point.
    fn gather_starting(&mut self, at: u32) {
        self.right.clear();
        let mut edge = self.first[at as usize];
        while edge != NONE {
            self.right.push(edge);
            edge = self.next[edge as usize];
        }
    }

    /// Ends an edge at a point on it; the remaining part starts there.
    fn cut_edge(&mut self, edge: u32, at: u32) {
        let edge_before = self.edges[edge as usize];
        self.edges[edge as usize].to = at;
        let remainder = self.add(SweepEdge { from: at, ..edge_before });
        self.right.push(remainder);
    }

    fn add(&mut self, edge: SweepEdge) -> u32 {
        let index = self.edges.len() as u32;
        self.edges.push(edge);
        self.next.push(NONE);
        self.sides.push(None);
        self.above.push(None);
        index
    }

    /// Sorts the edges that start at a point from the lowest to the highest, and merges overlapping ones.
    fn sort_right(&mut self, at: u32) {
        if self.right.len() < 2 {
            return;
        }
        let mut right = std::mem::take(&mut self.right);
        let (points, edges) = (self.points, &self.edges);
        let to = |edge: u32| edges[edge as usize].to;
        let end = |edge: u32| points[to(edge) as usize];
        let turn = |a: u32, b: u32| P::turn(points[at as usize], end(a), end(b));
        // Each edge is to the left of the previous one; of overlapping ones the shortest comes first.
        right.sort_unstable_by(|a, b| turn(*a, *b).reverse().then(to(*a).cmp(&to(*b))));
        let is_tied = |pair: &[u32]| turn(pair[0], pair[1]) == Ordering::Equal;
        if right.windows(2).any(is_tied) {
            self.merge_ties(at, &mut right);
        }
        self.right = right;
    }

    fn merge_ties(&mut self, at: u32, right: &mut Vec<u32>) {
        let mut merged: Vec<u32> = Vec::with_capacity(right.len());
        for &edge in right.iter() {
            let SweepEdge { to, winding, .. } = self.edges[edge as usize];
            let previous =
                merged.last().copied().map(|previous| (previous, self.edges[previous as usize].to));
            match previous {
                Some((previous, end)) if self.turn(at, end, to) == Ordering::Equal => {
                    self.overlapping += 1;
                    (0..2).for_each(|k| self.edges[previous as usize].winding[k] += winding[k]);
                    if to != end {
                        let remainder = self.add(SweepEdge { from: end, to, winding });
                        self.start(remainder);
                    }
                }
                _ => merged.push(edge),
            }
        }
        merged.retain(|edge| self.edges[*edge as usize].winding != [0; 2]);
        *right = merged;
    }

    /// Sets the winding numbers and chains of the edges that start at a point.
    fn begin(&mut self, at: u32, low: Option<u32>, above: Option<MonotoneChain>) {
        let sides_below = low.and_then(|low| self.sides[low as usize]);
        let mut winding = sides_below.map_or([0; 2], |[_, above]| above);
        let last = self.right.len() - 1;
        self.n_edges += self.right.len();
        for k in 0..=last {
            let edge = self.right[k] as usize;
            let before = winding;
            (0..2).for_each(|kind| winding[kind] += self.edges[edge].winding[kind]);
            self.sides[edge] = Some([before, winding]);
            // Intervals between two of the edges begin at this point; the one above the last edge
            // continues the interval that the point lies in, and its chain.
            self.above[edge] = match above {
                Some(chain) if k == last && self.rule.holds(winding) => Some(chain),
                _ => self.rule.holds(winding).then(|| self.chains.one(at)),
            };
        }
    }

    /// Rejects two neighbours that cross farther to the right. If one only touches the other, the line will
    /// reach that point.
    fn expect_apart(&self, low: u32, high: u32) -> Result<(), EdgeCrossing> {
        let (low, high) = (self.edges[low as usize], self.edges[high as usize]);
        // Points are numbered in the order of the sweep, so the edge whose right end has the lower number ends
        // first. It must end on its own side of the other edge.
        let crosses = match low.to.cmp(&high.to) {
            Ordering::Equal => false,
            Ordering::Less => self.turn(high.from, high.to, low.to) == Ordering::Greater,
            Ordering::Greater => self.turn(low.from, low.to, high.to) == Ordering::Less,
        };
        if crosses { Err(EdgeCrossing) } else { Ok(()) }
    }

    /// Adds a triangle if it has area.
    fn cut_triangle(&mut self, [a, b, c]: [u32; 3]) -> bool {
        let has_area = self.turn(a, b, c) == Ordering::Greater;
        if has_area {
            self.triangles.push([a, b, c]);
        }
        has_area
    }

    /// The lower edge of an interval ends at a point. If the upper one ends there too, the entire chain is
    /// visible.
    fn join_at_bottom(&mut self, mut chain: MonotoneChain, at: u32) -> MonotoneChain {
        while let Some([a, b]) = self.chains.lowest(&chain) {
            if !self.cut_triangle([at, b, a]) {
                break;
            }
            self.chains.drop_lowest(&mut chain);
        }
        self.chains.add_lowest(&mut chain, at);
        chain
    }

    /// The upper edge of an interval ends at a point.
    fn join_at_top(&mut self, mut chain: MonotoneChain, at: u32) -> MonotoneChain {
        while let Some([a, b]) = self.chains.highest(&chain) {
            if !self.cut_triangle([at, a, b]) {
                break;
            }
            self.chains.drop_highest(&mut chain);
        }
        self.chains.add_highest(&mut chain, at);
        chain
    }

    /// A point inside an interval, where edges start: it is joined to the rightmost point to its left.
    fn split(
        &mut self,
        chain: Option<MonotoneChain>,
        at: u32,
    ) -> (Option<MonotoneChain>, Option<MonotoneChain>) {
        let Some(chain) = chain else { return (None, None) };
        let (lower, upper) = self.chains.split(chain);
        (Some(self.join_at_top(lower, at)), Some(self.join_at_bottom(upper, at)))
    }
}
