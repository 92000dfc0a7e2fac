//! The outline of unions and intersections of half-planes and discs, piece by piece, if its corners are certain.
//!
//! Let S be the boundary of {F < 0}, with the regularization of [`Csg`], and w the largest distance of a primitive's
//! zeros from its line or circle. Along a curve C, every other curve is near in a few intervals only.
//!
//! ```text
//!              ╱                  C: the line from left to right; the others cross it
//!   ──────[───╱───]─────────[──)──]──────
//!   outside  corner  outside  corner      [ ]: an interval with another curve near
//! ```
//!
//! **Outside of the intervals** every other curve is farther than 2w, so that its primitive has the sign of its
//! distance. The tree is evaluated with both signs of C's own primitive. If the results differ, a point of S is
//! within w of every point of C there; otherwise none is. **In the intervals** S may be anywhere. The undecided
//! intervals are gathered into corners: boxes that overlap. Each corner has to be the end of some stretch of S, and
//! stands for one vertex. So S and the loops through the vertices are within the size of the largest corner. If that
//! is too large, a curve is no line or circle, or it lies on another, there is no outline, and the caller samples.
// Long because reasons stand beside the steps that they explain.
use super::plane_function::{PlaneCurve, PlaneFunction};
use crate::budget::{Job, par_map};
use crate::explicit::DisjointSets;
use crate::implicit::{Csg, Expr, Membership};
use crate::math::elementary::atan2;
use crate::math::{Box3, greater, length, lesser};
use std::f64::consts::TAU;

/// Loops of stretches of lines and circles, with the filled side on the left.
pub(super) struct PlaneOutline {
    curves: Vec<PlaneCurve>,
    pub loops: Vec<Vec<OutlineEdge>>,
    /// The largest distance between the loops and the true outline.
    pub distance: f64,
}

/// A stretch of a curve, from one parameter to another, which may be less.
#[derive(Clone, Copy, Debug)]
pub(super) struct OutlineEdge {
    pub start: [f64; 2],
    curve: u32,
    from: f64,
    to: f64,
}

/// The most primitives. Defined: each curve is cut by all others.
const MOST_PRIMITIVES: usize = 400;
/// The most nodes of the tree times the square of the number of primitives: the tree is evaluated between any two
/// cuts. Chosen: about 2 s, since 745 million took 6.6 s; a union of 400 lines or circles takes a quarter of it.
const MOST_WORK: usize = 1 << 28;
/// Curves nearer than this fraction of the largest number are near. Derived: 256 roundings; coordinates, distances
/// and parameters take a dozen.
const SLACK: f64 = 256.0 * f64::EPSILON;
/// So are curves nearer than this many times the error of primitives. Derived: twice the error is needed on both
/// sides, and the same again for roundings.
const SLACK_OF_ERROR: f64 = 8.0;
/// Lengths between this and its inverse have squares with all digits, and so have their roundings. Defined: far from
/// the least and the largest number.
const LEAST: f64 = 1e-100;
/// Directions in a corner of several stretches differ by more than this angle. Defined: far above rounding.
const DISTINCT: f64 = 1.0 / (1_u64 << 20) as f64;
/// Curves with a smaller sine between them count as tangent. Defined, as above.
const TANGENT: f64 = 1.0 / (1_u64 << 20) as f64;
/// An interval with more undecided curves counts as open. Defined: both signs of each curve are tried.
const MOST_UNDECIDED: usize = 8;

impl PlaneOutline {
    /// The outline of an expression's negative set, which lies in a box; `None` if it is not certain, or if its
    /// distance is more than `most`.
    pub fn from_sign(sign: &Expr, bounds: &Box3, most: f64, job: &Job) -> Option<Self> {
        let csg = Csg::from_expr(sign);
        let (n, n_nodes) = (csg.primitives().len(), csg.tree().nodes().len());
        if n > MOST_PRIMITIVES || n * n > MOST_WORK / n_nodes {
            return None;
        }
        let functions: Vec<PlaneFunction> =
            csg.primitives().iter().map(PlaneFunction::from_primitive).collect::<Option<_>>()?;
        let centre = [0, 1].map(|k| 0.5 * (bounds.min[k] + bounds.max[k]));
        let radius = bounds.diagonal();
        let reach = functions.iter().fold(length(centre) + radius, |reach, function| match function.curve {
            PlaneCurve::Circle { centre, radius } => greater(length(centre) + radius, reach),
            _ => reach,
        });
        let in_range = LEAST < reach && reach < 1.0 / LEAST;
        if !in_range {
            return None;
        }
        let errors: Vec<f64> = functions.iter().map(|function| function.off_at_most(reach)).collect();
        if !errors.iter().all(|error| error.is_finite()) {
            return None;
        }
        let error = errors.into_iter().fold(0.0, |most: f64, x| greater(x, most));
        let by_rounding = SLACK * reach;
        let by_error = SLACK_OF_ERROR * (error + csg.weld());
        let slack = greater(by_rounding, by_error);
        let is_small = |function: &PlaneFunction| match function.curve {
            PlaneCurve::Circle { radius, .. } => radius < 16.0 * slack,
            _ => false,
        };
        let is_clear = slack < most && !functions.iter().any(is_small);
        if !is_clear {
            return None;
        }
        let arrangement = PlaneArrangement { csg: &csg, functions, slack, centre, radius };
        // If the rim is filled, the outline is not closed within the disc.
        if arrangement.is_filled_around() {
            return None;
        }
        let numbers: Vec<usize> = (0..arrangement.functions.len()).collect();
        let cuts: Vec<CutCurve> =
            par_map(job, &numbers, |_, i| if job.is_cancelled() { None } else { arrangement.cut(*i) })
                .into_iter()
                .collect::<Option<_>>()?;
        let corners = OutlineCorners::new(&arrangement, &cuts)?;
        // From a vertex to the end of its stretch and back, and rounding.
        let distance = 2.0 * corners.size + 4.0 * slack;
        let loops = corners.loops()?;
        let curves = arrangement.functions.iter().map(|function| function.curve).collect();
        let outline = Self { curves, loops, distance };
        (distance < most && !outline.loops.is_empty() && outline.is_within(bounds)).then_some(outline)
    }

    /// The curve of an edge.
    pub fn curve(&self, edge: &OutlineEdge) -> &PlaneCurve {
        &self.curves[edge.curve as usize]
    }

    /// Whether the outline is in a box, up to its distance.
    fn is_within(&self, bounds: &Box3) -> bool {
        let holds = |p: [f64; 2]| {
            (0..2).all(|k| p[k] >= bounds.min[k] - self.distance && p[k] <= bounds.max[k] + self.distance)
        };
        self.loops.iter().flatten().all(|edge| {
            let curve = self.curve(edge);
            let is_straight = matches!(curve, PlaneCurve::Line { .. });
            holds(edge.start) && (is_straight || edge.quarters().into_iter().all(|t| holds(curve.at(t))))
        })
    }
}

impl OutlineEdge {
    /// The angle of the edge around a circle.
    pub fn sweep(&self) -> f64 {
        (self.to - self.from).abs()
    }

    /// The parameter at a fraction of the edge.
    pub fn parameter(&self, part: f64) -> f64 {
        self.from + part * (self.to - self.from)
    }

    /// The multiples of a right angle along the edge.
    fn quarters(&self) -> Vec<f64> {
        let quarter = 0.25 * TAU;
        let (low, high) = (lesser(self.from, self.to), greater(self.from, self.to));
        let first = (low / quarter).ceil();
        (0..4).map(|k| quarter * (first + f64::from(k))).filter(|t| *t <= high).collect()
    }
}

/// An interval of a curve's parameter with other curves near.
struct NearStretch {
    ends: [f64; 2],
    others: Vec<u32>,
    /// Whether the tree is undecided in the interval.
    is_open: bool,
}

/// A stretch of a curve with the outline along it, in the outline's direction; and the intervals at both ends, none for
/// a circle without another curve near.
struct OutlineStretch {
    from: f64,
    to: f64,
    ends: Option<[usize; 2]>,
}

/// A curve, cut at the intervals with others near.
#[derive(Default)]
struct CutCurve {
    near: Vec<NearStretch>,
    stretches: Vec<OutlineStretch>,
}

struct PlaneArrangement<'a> {
    csg: &'a Csg,
    functions: Vec<PlaneFunction>,
    slack: f64,
    /// The disc to be searched.
    centre: [f64; 2],
    radius: f64,
}

impl PlaneArrangement<'_> {
    /// Whether each primitive is negative at a point that is near no curve.
    fn signs(&self, p: [f64; 2]) -> Vec<bool> {
        self.functions.iter().map(|function| function.is_negative(function.curve.distance(p) < 0.0)).collect()
    }

    /// Whether one of eight points on the border of the disc is filled.
    fn is_filled_around(&self) -> bool {
        let rim = PlaneCurve::Circle { centre: self.centre, radius: self.radius };
        (0..8).any(|k| {
            let signs = self.signs(rim.at(0.125 * TAU * f64::from(k)));
            self.csg.tree().contains(|p| signs[p as usize])
        })
    }

    /// `None` if another curve is near all of the curve, or if the outline leaves the disc.
    fn cut(&self, number: usize) -> Option<CutCurve> {
        let function = &self.functions[number];
        let window = match function.curve {
            PlaneCurve::Nowhere => return Some(CutCurve::default()),
            PlaneCurve::Line { .. } => match function.curve.within_disc(self.centre, self.radius) {
                Some(window) => Some(window),
                None => return Some(CutCurve::default()),
            },
            PlaneCurve::Circle { .. } => None,
        };
        let mut near = self.near(number, window)?;
        for interval in &mut near {
            interval.is_open = self.is_open(number, interval);
        }
        let n = near.len();
        // Each gap, with the intervals before and after it.
        let mut gaps: Vec<([f64; 2], [Option<usize>; 2])> = Vec::new();
        if let Some([low, high]) = window {
            for k in 0..=n {
                let from = if k == 0 { low } else { near[k - 1].ends[1] };
                let to = if k == n { high } else { near[k].ends[0] };
                gaps.push(([from, to], [k.checked_sub(1), (k < n).then_some(k)]));
            }
        } else if n == 0 {
            gaps.push(([0.0, TAU], [None, None]));
        } else {
            for k in 0..n {
                let next = (k + 1) % n;
                // The last gap of a circle goes through 0, into the next turn.
                let turn = if next <= k { TAU } else { 0.0 };
                gaps.push(([near[k].ends[1], near[next].ends[0] + turn], [Some(k), Some(next)]));
            }
        }
        let mut stretches = Vec::new();
        for ([from, to], beside) in gaps.into_iter().filter(|([from, to], _)| from < to) {
            // No other curve is near in a gap, so the signs at its middle hold in all of it.
            let signs = self.signs(function.curve.at(0.5 * (from + to)));
            let holds = |is_below: bool| {
                let sign = function.is_negative(is_below);
                self.csg.tree().contains(|p| if p as usize == number { sign } else { signs[p as usize] })
            };
            // The negative side of a curve is on its left.
            let (left, right) = (holds(true), holds(false));
            if left == right {
                continue;
            }
            let ends = match beside {
                [Some(a), Some(b)] => Some(if left { [a, b] } else { [b, a] }),
                [None, None] if window.is_none() => None,
                // The stretch reaches the rim of the disc.
                _ => return None,
            };
            let (from, to) = if left { (from, to) } else { (to, from) };
            stretches.push(OutlineStretch { from, to, ends });
        }
        Some(CutCurve { near, stretches })
    }

    /// The intervals with others near, in order; intervals that overlap are joined.
    fn near(&self, number: usize, window: Option<[f64; 2]>) -> Option<Vec<NearStretch>> {
        let curve = &self.functions[number].curve;
        let mut intervals: Vec<([f64; 2], u32)> = Vec::new();
        for (j, other) in self.functions.iter().enumerate().filter(|(j, _)| *j != number) {
            for [from, to] in curve.near(&other.curve, self.slack)? {
                let Some([low, high]) = window else {
                    let turns = TAU * (from / TAU).floor();
                    intervals.push(([from - turns, to - turns], j as u32));
                    continue;
                };
                // Cut off at the window: the middle of the interval tells whether it is open, and curves that cross it
                // beyond the window are not among the others.
                if to >= low && from <= high {
                    intervals.push(([greater(from, low), lesser(to, high)], j as u32));
                }
            }
        }
        intervals.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]).then(a.1.cmp(&b.1)));
        let mut near: Vec<NearStretch> = Vec::new();
        for (ends, other) in intervals {
            match near.last_mut() {
                Some(last) if ends[0] <= last.ends[1] => {
                    last.ends[1] = greater(ends[1], last.ends[1]);
                    last.others.push(other);
                }
                _ => near.push(NearStretch { ends, others: vec![other], is_open: false }),
            }
        }
        // Around a circle the last interval may reach the first, and then the next.
        while window.is_none() && near.len() > 1 && near[near.len() - 1].ends[1] - TAU >= near[0].ends[0] {
            let last = near.pop()?;
            let back = last.ends.map(|t| t - TAU);
            near[0].ends = [back[0], greater(back[1], near[0].ends[1])];
            near[0].others.extend(last.others);
            while near.len() > 1 && near[1].ends[0] <= near[0].ends[1] {
                let next = near.remove(1);
                near[0].ends[1] = greater(next.ends[1], near[0].ends[1]);
                near[0].others.extend(next.others);
            }
        }
        let is_whole =
            |interval: &NearStretch| window.is_none() && interval.ends[1] - interval.ends[0] >= TAU;
        if near.iter().any(is_whole) { None } else { Some(near) }
    }

    /// Whether the signs of the near curves make a difference.
    fn is_open(&self, number: usize, stretch: &NearStretch) -> bool {
        let [from, to] = stretch.ends;
        let signs = self.signs(self.functions[number].curve.at(0.5 * (from + to)));
        let mut near = stretch.others.clone();
        near.push(number as u32);
        near.sort_unstable();
        near.dedup();
        let side = |p: u32, is_complement: bool| {
            if near.binary_search(&p).is_ok() {
                Membership::Unknown
            } else if signs[p as usize] != is_complement {
                Membership::Inside
            } else {
                Membership::Outside
            }
        };
        if self.csg.tree().membership(side) != Membership::Unknown {
            return false;
        }
        if near.len() > MOST_UNDECIDED {
            return true;
        }
        // The signs of the near curves are the bits, those of the others are known.
        let holds = |bits: u32| {
            self.csg
                .tree()
                .contains(|p| near.binary_search(&p).map_or(signs[p as usize], |k| bits >> k & 1 == 1))
        };
        let first = holds(0);
        (1..1_u32 << near.len()).any(|bits| holds(bits) != first)
    }
}

/// A stretch of the outline with the corners that it joins.
struct CornerStretch {
    curve: u32,
    from: f64,
    to: f64,
    ends: [u32; 2],
}

/// The corners of the outline.
struct OutlineCorners<'a> {
    arrangement: &'a PlaneArrangement<'a>,
    vertices: Vec<[f64; 2]>,
    stretches: Vec<CornerStretch>,
    circles: Vec<OutlineEdge>,
    /// The diagonal of the largest corner.
    size: f64,
}

/// A box around an open interval of a curve.
struct CornerBox {
    min: [f64; 2],
    max: [f64; 2],
}

impl<'a> OutlineCorners<'a> {
    /// `None` if a corner is the end of no stretch.
    fn new(arrangement: &'a PlaneArrangement<'a>, cuts: &[CutCurve]) -> Option<Self> {
        let mut boxes: Vec<CornerBox> = Vec::new();
        let mut box_of: Vec<Vec<Option<u32>>> = Vec::with_capacity(cuts.len());
        for (number, cut) in cuts.iter().enumerate() {
            let curve = &arrangement.functions[number].curve;
            let mut row = Vec::with_capacity(cut.near.len());
            for one in &cut.near {
                row.push(one.is_open.then_some(boxes.len() as u32));
                if one.is_open {
                    let [from, to] = one.ends;
                    let middle = curve.at(0.5 * (from + to));
                    // No point of the piece is farther from its middle than half its length.
                    let half = 0.5 * curve.speed() * (to - from) + 2.0 * arrangement.slack;
                    let (min, max) = (middle.map(|x| x - half), middle.map(|x| x + half));
                    boxes.push(CornerBox { min, max });
                }
            }
            box_of.push(row);
        }
        let (label, n) = joined_boxes(&boxes);
        let (mut stretches, mut circles) = (Vec::new(), Vec::new());
        let mut curves_at: Vec<Vec<u32>> = vec![Vec::new(); n];
        for (number, cut) in cuts.iter().enumerate() {
            let curve = number as u32;
            for OutlineStretch { from, to, ends } in &cut.stretches {
                let Some(ends) = ends else {
                    let start = arrangement.functions[number].curve.at(*from);
                    circles.push(OutlineEdge { start, curve, from: *from, to: *to });
                    continue;
                };
                // No outline ends where the tree is decided: if a stretch does, the corner is not certain.
                let corner = |k: usize| box_of[number][ends[k]].map(|one| label[one as usize]);
                let ends = [corner(0)?, corner(1)?];
                ends.iter().for_each(|end| curves_at[*end as usize].push(curve));
                stretches.push(CornerStretch { curve, from: *from, to: *to, ends });
            }
        }
        if curves_at.iter().any(Vec::is_empty) {
            return None;
        }
        let (mut vertices, mut size) = (Vec::with_capacity(n), 0.0);
        let mut around = vec![([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]); n];
        for (one, corner) in boxes.iter().zip(&label) {
            let (min, max) = &mut around[*corner as usize];
            for k in 0..2 {
                (min[k], max[k]) = (lesser(one.min[k], min[k]), greater(one.max[k], max[k]));
            }
        }
        for ((min, max), curves) in around.into_iter().zip(&curves_at) {
            let far = length([max[0] - min[0], max[1] - min[1]]);
            size = greater(far, size);
            let middle = [0, 1].map(|k| 0.5 * (min[k] + max[k]));
            let crossing = arrangement.crossing(curves, middle);
            // The crossing of tangent curves may be far away; then the middle of the corner is its vertex.
            let is_in = |p: &[f64; 2]| (0..2).all(|k| min[k] <= p[k] && p[k] <= max[k]);
            vertices.push(crossing.filter(is_in).unwrap_or(middle));
        }
        Some(Self { arrangement, vertices, stretches, circles, size })
    }

    /// The closed loops of all stretches; `None` if they cannot be joined.
    fn loops(&self) -> Option<Vec<Vec<OutlineEdge>>> {
        let next = self.next_stretches()?;
        let mut seen = vec![false; next.len()];
        let mut loops: Vec<Vec<OutlineEdge>> = self.circles.iter().map(|edge| vec![*edge]).collect();
        for start in 0..next.len() {
            let (mut path, mut at) = (Vec::new(), start);
            while !seen[at] {
                seen[at] = true;
                path.push(self.edge(at));
                at = next[at];
            }
            if !path.is_empty() {
                loops.push(self.without_flat_corners(&path)?);
            }
        }
        let is_line = |edge: &OutlineEdge| matches!(self.curve(edge.curve), PlaneCurve::Line { .. });
        // A loop of lines alone needs three.
        let is_flat = |path: &Vec<OutlineEdge>| path.len() < 3 && path.iter().all(is_line);
        if loops.iter().any(is_flat) { None } else { Some(loops) }
    }

    fn curve(&self, number: u32) -> &PlaneCurve {
        &self.arrangement.functions[number as usize].curve
    }

    fn edge(&self, number: usize) -> OutlineEdge {
        let CornerStretch { curve, from, to, ends } = self.stretches[number];
        OutlineEdge { start: self.vertices[ends[0] as usize], curve, from, to }
    }

    /// For each stretch the number of the next.
    fn next_stretches(&self) -> Option<Vec<usize>> {
        let mut coming: Vec<Vec<usize>> = vec![Vec::new(); self.vertices.len()];
        let mut going = coming.clone();
        for (number, stretch) in self.stretches.iter().enumerate() {
            going[stretch.ends[0] as usize].push(number);
            coming[stretch.ends[1] as usize].push(number);
        }
        let mut next = vec![usize::MAX; self.stretches.len()];
        for (coming, going) in coming.iter().zip(&going) {
            match (coming.as_slice(), going.as_slice()) {
                ([one], [other]) => next[*one] = *other,
                (coming, going) if coming.len() == going.len() => {
                    for (one, other) in self.joined_by_angle(coming, going)? {
                        next[one] = other;
                    }
                }
                _ => return None,
            }
        }
        Some(next)
    }

    /// The filled side is on the left: seen from the corner, it lies clockwise of a coming stretch, up to the next
    /// going one.
    fn joined_by_angle(&self, coming: &[usize], going: &[usize]) -> Option<Vec<(usize, usize)>> {
        let outward = |number: usize, is_coming: bool| {
            let CornerStretch { curve, from, to, .. } = self.stretches[number];
            let [x, y] = self.curve(curve).direction(if is_coming { to } else { from });
            // From the corner, a coming stretch is seen backwards, and so is one against the parameter of its
            // curve.
            if (to > from) == is_coming { atan2(-y, -x) } else { atan2(y, x) }
        };
        let mut rays: Vec<(f64, usize, bool)> =
            coming.iter().map(|one| (outward(*one, true), *one, true)).collect();
        rays.extend(going.iter().map(|one| (outward(*one, false), *one, false)));
        rays.sort_by(|a, b| a.0.total_cmp(&b.0));
        let n = rays.len();
        let mut joined = Vec::with_capacity(coming.len());
        for k in 0..n {
            let (ray, after) = (rays[k], rays[(k + 1) % n]);
            let turn = if k + 1 == n { TAU } else { 0.0 };
            // Coming and going stretches have to alternate.
            if after.0 + turn - ray.0 < DISTINCT || after.2 == ray.2 {
                return None;
            }
            if after.2 {
                joined.push((after.1, ray.1));
            }
        }
        Some(joined)
    }

    /// A loop without the corners between edges of the same curve; `None` if it is on one curve but not around it.
    fn without_flat_corners(&self, path: &[OutlineEdge]) -> Option<Vec<OutlineEdge>> {
        let goes_on =
            |a: &OutlineEdge, b: &OutlineEdge| a.curve == b.curve && (a.to > a.from) == (b.to > b.from);
        let n = path.len();
        let first = (0..n).find(|k| !goes_on(&path[(k + n - 1) % n], &path[*k]));
        let Some(first) = first else {
            // Either all the way around, or a short arc with both ends in one corner.
            let one = path[0];
            let turn = if one.to > one.from { TAU } else { -TAU };
            // Parameters of successive stretches may differ by whole turns, which are not counted.
            let turns = (0..n).fold(0.0, |turns: f64, k| {
                let gap = (path[(k + 1) % n].from - path[k].to) / turn;
                turns + (path[k].to - path[k].from) / turn + (gap - gap.round())
            });
            let is_round = matches!(self.curve(one.curve), PlaneCurve::Circle { .. });
            let is_around = is_round && turns > 0.5 && turns < 1.5;
            return is_around.then(|| vec![OutlineEdge { to: one.from + turn, ..one }]);
        };
        let mut kept: Vec<OutlineEdge> = Vec::with_capacity(n);
        for k in 0..n {
            let edge = path[(first + k) % n];
            let is_same = kept.last().is_some_and(|last| goes_on(last, &edge));
            let Some(last) = kept.last_mut().filter(|_| is_same) else {
                kept.push(edge);
                continue;
            };
            let is_round = matches!(self.curve(edge.curve), PlaneCurve::Circle { .. });
            let gap = edge.from - last.to;
            let turns = if is_round { TAU * (gap / TAU).round() } else { 0.0 };
            // The next stretch of the same circle may be numbered a turn farther.
            last.to = edge.to - turns;
        }
        Some(kept)
    }
}

/// The number of each box's corner, a set of boxes joined by overlaps; and the number of corners.
fn joined_boxes(boxes: &[CornerBox]) -> (Vec<u32>, usize) {
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|a, b| boxes[*a].min[0].total_cmp(&boxes[*b].min[0]).then(a.cmp(b)));
    let mut sets = DisjointSets::new(boxes.len());
    for (k, a) in order.iter().enumerate() {
        let one = &boxes[*a];
        for b in order[k + 1..].iter().take_while(|b| boxes[**b].min[0] <= one.max[0]) {
            let other = &boxes[*b];
            if other.min[1] <= one.max[1] && one.min[1] <= other.max[1] {
                sets.union(*a as u32, *b as u32);
            }
        }
    }
    sets.labels()
}

impl PlaneArrangement<'_> {
    /// The steepest crossing of two of some curves near a point; lines along an axis keep their coordinate.
    fn crossing(&self, curves: &[u32], near: [f64; 2]) -> Option<[f64; 2]> {
        let unit = |number: u32, p: [f64; 2]| match self.functions[number as usize].curve {
            PlaneCurve::Line { normal, .. } => normal,
            PlaneCurve::Circle { centre, .. } => {
                let away = [p[0] - centre[0], p[1] - centre[1]];
                let far = length(away);
                away.map(|x| x / far)
            }
            PlaneCurve::Nowhere => [0.0; 2],
        };
        let sine = |a: u32, b: u32, p: [f64; 2]| {
            let ([a, b], [c, d]) = (unit(a, p), unit(b, p));
            a * d - b * c
        };
        let mut best: Option<(f64, [u32; 2])> = None;
        for (k, a) in curves.iter().enumerate() {
            for b in &curves[k + 1..] {
                let steep = sine(*a, *b, near).abs();
                if steep > TANGENT && best.is_none_or(|(most, _)| steep > most) {
                    best = Some((steep, [*a, *b]));
                }
            }
        }
        let (_, [a, b]) = best?;
        let curve = |number: u32| self.functions[number as usize].curve;
        let mut p = near;
        // Newton's steps from a distance of some roundings: two are enough.
        for _ in 0..3 {
            let (one, other) = (unit(a, p), unit(b, p));
            let (away, aside) = (curve(a).distance(p), curve(b).distance(p));
            let det = sine(a, b, p);
            p = [
                p[0] - (away * other[1] - aside * one[1]) / det,
                p[1] - (aside * one[0] - away * other[0]) / det,
            ];
        }
        // A line along an axis keeps its coordinate exactly, which the steps have rounded.
        for number in [a, b] {
            if let PlaneCurve::Line { normal: [x, y], offset } = curve(number) {
                p = [if y == 0.0 { x * offset } else { p[0] }, if x == 0.0 { y * offset } else { p[1] }];
            }
        }
        (p[0].is_finite() && p[1].is_finite()).then_some(p)
    }
}
