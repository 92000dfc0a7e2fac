//! The test of one cell: whether the solid's boundary in it has the same topology as with linear functions.
use super::growth::{GradientBox, grow_together};
use super::tetrahedra::Tetrahedra;
use crate::implicit::{Csg, CsgNode, CsgRestriction, CsgTree, DualRange, Membership, Primitive};
use crate::math::{cross, dot, greater, length, lesser};
use std::collections::{HashMap, hash_map};
use std::sync::Arc;

/// A CSG tree restricted to a region, with its primitives.
#[derive(Debug)]
pub(super) struct PrunedTree {
    pub tree: CsgTree,
    /// In ascending order.
    pub primitives: Vec<u32>,
    /// By index in `primitives`: their polarity in the tree.
    pub polarity: Vec<Polarity>,
}

/// Whether a primitive occurs plain in a tree, complemented, or both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Polarity {
    pub plain: bool,
    pub complemented: bool,
}

impl PrunedTree {
    pub fn new(tree: CsgTree) -> Self {
        let primitives = tree.primitives();
        let mut polarity = vec![Polarity::default(); primitives.len()];
        for node in tree.nodes() {
            match node {
                CsgNode::Primitive(p) => polarity[index_of(&primitives, *p)].plain = true,
                CsgNode::Complement(p) => polarity[index_of(&primitives, *p)].complemented = true,
                CsgNode::Union(_) | CsgNode::Intersection(_) => {}
            }
        }
        Self { tree, primitives, polarity }
    }

    /// Its approximate memory: its lists, and itself with its entry in the cache.
    fn bytes(&self) -> u64 {
        let of_lists =
            size_of_val(self.tree.nodes()) + size_of_val(&*self.primitives) + size_of_val(&*self.polarity);
        (of_lists + 2 * size_of::<Self>()) as u64
    }

    /// Whether some primitive that occurs both plain and complemented decides the tree on either side, with the
    /// same result. Then its zero set is no boundary, as between two solids that share a face.
    fn is_cancelled(&self) -> bool {
        let is_mixed = |polarity: &Polarity| polarity.plain && polarity.complemented;
        let mixed = self.primitives.iter().zip(&self.polarity).filter(|(_, polarity)| is_mixed(polarity));
        mixed.map(|(p, _)| *p).any(|p| {
            let with = |side: Membership| {
                let of = |q, is_complement| {
                    if q == p { side.complement_if(is_complement) } else { Membership::Unknown }
                };
                self.tree.restrict(of)
            };
            match (with(Membership::Inside), with(Membership::Outside)) {
                (CsgRestriction::Decided(a), CsgRestriction::Decided(b)) => a == b,
                _ => false,
            }
        })
    }
}

/// The trees of all cells, each stored once.
#[derive(Debug, Default)]
pub(super) struct PrunedTreeCache {
    /// By fingerprint: one of the trees with it.
    by_fingerprint: HashMap<u64, Arc<PrunedTree>>, // No order depends on it.
    bytes: u64,
}

impl PrunedTreeCache {
    /// The stored tree that equals `pruned`.
    pub fn intern(&mut self, pruned: Arc<PrunedTree>) -> Arc<PrunedTree> {
        match self.by_fingerprint.entry(pruned.tree.fingerprint()) {
            hash_map::Entry::Occupied(entry) if entry.get().tree == pruned.tree => Arc::clone(entry.get()),
            // Another tree with the same fingerprint: it is not shared, which only costs memory.
            hash_map::Entry::Occupied(_) => pruned,
            hash_map::Entry::Vacant(entry) => {
                self.bytes += pruned.bytes();
                entry.insert(Arc::clone(&pruned));
                pruned
            }
        }
    }

    /// Drops trees that no cell uses.
    pub fn remove_unused(&mut self) {
        let bytes = &mut self.bytes;
        self.by_fingerprint.retain(|_, pruned| {
            let is_used = Arc::strong_count(pruned) > 1;
            *bytes -= if is_used { 0 } else { pruned.bytes() };
            is_used
        });
    }

    /// The approximate memory of the trees.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// The index of a primitive in an ascending list that contains it.
pub(super) fn index_of(primitives: &[u32], p: u32) -> usize {
    if primitives.len() == 1 {
        0
    } else {
        primitives.binary_search(&p).expect("it is a primitive of the tree")
    }
}

/// The side to which a value of 0 belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ZeroSide {
    Outside,
    /// The primitive occurs only as its complement, and 0 is outside of that.
    Inside,
}

/// The side of 0, by primitive.
pub(super) fn zeros(csg: &Csg) -> Vec<ZeroSide> {
    let mut sides = vec![ZeroSide::Inside; csg.primitives().len()];
    for node in csg.tree().nodes() {
        if let CsgNode::Primitive(p) = node {
            sides[*p as usize] = ZeroSide::Outside;
        }
    }
    sides
}

impl ZeroSide {
    /// Whether a point with this value is inside; NaN is outside.
    pub fn is_inside(self, value: f64) -> bool {
        match self {
            Self::Outside => value < 0.0,
            Self::Inside => value <= 0.0,
        }
    }
}

/// The side of a primitive on which all values of a range lie.
pub(super) fn range_side([low, high]: [f64; 2], zero: ZeroSide) -> Membership {
    match zero {
        ZeroSide::Outside if low >= 0.0 => Membership::Outside,
        ZeroSide::Outside if high < 0.0 => Membership::Inside,
        ZeroSide::Inside if low > 0.0 => Membership::Outside,
        ZeroSide::Inside if high <= 0.0 => Membership::Inside,
        ZeroSide::Outside | ZeroSide::Inside => Membership::Unknown,
    }
}

/// The tree that remains if primitives have these sides; `None` if it is decided, or no boundary is left in it.
pub(super) fn prune(pruned: &Arc<PrunedTree>, sides: &[Membership]) -> Option<Arc<PrunedTree>> {
    if sides.iter().all(|side| *side == Membership::Unknown) {
        return (!pruned.is_cancelled()).then(|| Arc::clone(pruned));
    }
    // Its only primitive is decided, and so is the tree.
    if pruned.primitives.len() == 1 {
        return None;
    }
    let side = |p, is_complement| sides[index_of(&pruned.primitives, p)].complement_if(is_complement);
    match pruned.tree.restrict(side) {
        CsgRestriction::Decided(_) => None,
        CsgRestriction::Open(tree) => {
            Some(Arc::new(PrunedTree::new(tree))).filter(|rest| !rest.is_cancelled())
        }
    }
}

/// The sizes of a cell, and the least size.
#[derive(Clone, Copy)]
pub(super) struct CellSizes {
    /// The sides of the cell's box.
    pub widths: [f64; 3],
    /// The longest edge, before stretching.
    pub longest: f64,
    /// The longest edge below which cells are not cut, before stretching.
    pub floor: f64,
    /// By axis: the factor of the stretch.
    pub stretch: [f64; 3],
}

impl CellSizes {
    pub fn new(tetrahedra: &Tetrahedra, corners: [u32; 4], floor: f64) -> Self {
        Self {
            widths: tetrahedra.sides_of(tetrahedra.box_of(corners)),
            longest: tetrahedra.longest(corners),
            floor,
            stretch: tetrahedra.stretch(),
        }
    }
}

/// A cell with the data that its test needs.
pub(super) struct CellTest<'a> {
    pub csg: &'a Csg,
    pub pruned: &'a PrunedTree,
    /// By index in the tree's primitives.
    pub ranges: &'a [DualRange],
    /// Values at the cell's corners.
    pub values: &'a [[f64; 4]],
    /// The largest rounding errors of these values.
    pub noise: &'a [f64],
    /// Primitives assumed to have one side throughout; empty for none.
    pub idle: &'a [bool],
    pub sizes: CellSizes,
}

/// The radius of the smallest ball around a tetrahedron, relative to its longest edge. Derived: that of a
/// regular one, which is the worst, is √6/4.
const ENCLOSING: f64 = 0.612_372_5;
/// A primitive has to grow by this fraction of its middle gradient along its best direction, throughout the cell.
/// Measured on the models of the tests: with 0.3 there are a third more cells, with 0.2 hardly fewer, and coarser
/// triangles are split later.
const GROWTH: f64 = 0.25;
/// Two primitives that linear interpolation may move by more than this, relative to the floor of cells, may have more
/// than one crease in a cell, and the surface between the creases would be lost. Derived: the floor is at most half of the
/// largest error, and the bound of the interpolation error is some six times the error of evenly bent functions; kinks,
/// whose error is as large as the bound, are detected by vertices that end away from the surface. Measured: with 2,
/// parts with blends take two to five times as long as without this test, with 16 a third more.
const MOVED: f64 = 16.0;
/// A common zero of three linear functions with a barycentric coordinate below this counts as outside of the cell.
/// Chosen: 0 is the rim of the cell; the distance from it allows for the bending of the functions.
const OUTSIDE: f64 = -0.75;
/// Cells with more primitives are cut as long as that helps. Chosen: twice as many as meet in common
/// corners.
const MOST: usize = 16;
/// The most other primitives for which truth tables are made.
const MOST_OTHERS: usize = 6;
/// The rounding error of a bound by the mean value theorem, relative to the added terms. Derived: some tens
/// of roundings, with a reserve.
const SLACK: f64 = 1e-13;
/// The rounding errors of values in the cell may be this many times those at its corners. Chosen, with a reserve: if a
/// cell counted as decided and its neighbour found the other sign on their common face, there would be a hole.
const NOISE: f64 = 16.0;

impl CellTest<'_> {
    /// An upper bound of the difference between values in the cell and the linear interpolant of those at its corners:
    /// by the mean value theorem with gradients in a box, which differ from the box's middle by at most half its
    /// diagonal in length, and half its sides by axis.
    pub fn interpolation_error(&self, at: usize) -> f64 {
        let Some(gradient) = &self.ranges[at].gradient else { return f64::INFINITY };
        let half = gradient.each_ref().map(|d| 0.5 * (d.hi() - d.lo()));
        let by_axis = 0.5 * dot(half, self.sizes.widths);
        let stretched: [f64; 3] = std::array::from_fn(|k| self.sizes.stretch[k] * half[k]);
        let by_length = length(stretched) * ENCLOSING * self.sizes.longest;
        lesser(by_axis, by_length)
    }

    /// A range of values in the cell, tightened by those at the corners.
    pub fn value_range(&self, at: usize) -> [f64; 2] {
        let [low, high] = self.ranges[at].value;
        let [a, b] = min_max(&self.values[at]);
        let size = greater(-a, b);
        let stray = self.interpolation_error(at);
        let stray = stray + SLACK * (stray + size) + NOISE * self.noise[at];
        if stray.is_nan() || stray.is_infinite() {
            return [low, high];
        }
        let (a, b) = (a - stray, b + stray);
        [greater(a, low), lesser(b, high)]
    }

    /// Whether any undecided primitives that can vanish together grow along a common direction.
    pub fn is_resolved(&self) -> bool {
        let mut entries: Vec<ActivePrimitive> = Vec::with_capacity(self.pruned.primitives.len());
        for (at, range) in self.ranges.iter().enumerate() {
            if self.idle.get(at) == Some(&true) {
                continue;
            }
            let Some(gradient) = range.gradient.as_ref().and_then(GradientBox::from_range) else {
                return false;
            };
            if gradient.growth() < GROWTH {
                return false;
            }
            let polarity = self.pruned.polarity[at];
            if polarity.plain {
                entries.push(ActivePrimitive { at, gradient });
            }
            if polarity.complemented {
                entries.push(ActivePrimitive { at, gradient: gradient.negated() });
            }
        }
        if entries.len() <= 1 {
            return true;
        }
        if !self.creases_are_resolved(&entries) {
            return false;
        }
        let gradients: Vec<GradientBox> = entries.iter().map(|e| e.gradient).collect();
        // A direction along which all of them grow serves every subset, so pairs and triples need no test.
        if grow_together(&gradients) {
            return true;
        }
        if self.pruned.primitives.len() > MOST {
            return false;
        }
        self.pairs_and_triples_are_resolved(&entries)
    }

    /// Whether any two primitives have at most one crease that matters: one falls along a direction in which the
    /// other grows. If interpolation hardly moves them, nothing is lost between two creases.
    fn creases_are_resolved(&self, entries: &[ActivePrimitive]) -> bool {
        let moved: Vec<f64> = entries.iter().map(|entry| self.interpolation_distance(entry)).collect();
        let n = entries.len();
        (0..n).all(|a| {
            (0..a).all(|b| {
                let (x, y) = (&entries[a], &entries[b]);
                // In order of cost: truth tables come last.
                moved[a] + moved[b] <= MOVED * self.sizes.floor
                    || x.at == y.at
                    || self.primitive(x).is_parallel_to(self.primitive(y))
                    || grow_together(&[x.gradient, y.gradient.negated()])
                    || self.is_separated(x, y)
                    || !self.decide_together(x.at, y.at)
            })
        })
    }

    /// An estimate of the distance by which linear interpolation moves a primitive's zero set.
    fn interpolation_distance(&self, entry: &ActivePrimitive) -> f64 {
        self.interpolation_error(entry.at) / self.middle_slope(entry)
    }

    /// The length of the middle gradient.
    fn middle_slope(&self, entry: &ActivePrimitive) -> f64 {
        let gradient = self.ranges[entry.at].gradient.as_ref().expect("entries have gradients");
        length(gradient.each_ref().map(|d| 0.5 * (d.lo() + d.hi())))
    }

    fn pairs_and_triples_are_resolved(&self, entries: &[ActivePrimitive]) -> bool {
        // Pairs that never meet in the cell, or that do not both matter at one point.
        // By `a * n + b`, for b < a.
        let n = entries.len();
        let mut apart = vec![false; n * n];
        for a in 0..n {
            for b in 0..a {
                let (x, y) = (&entries[a], &entries[b]);
                if x.at == y.at
                    || self.primitive(x).is_parallel_to(self.primitive(y))
                    || self.is_separated(x, y)
                {
                    apart[a * n + b] = true;
                } else if !grow_together(&[x.gradient, y.gradient]) {
                    if self.decide_together(x.at, y.at) {
                        return false;
                    }
                    apart[a * n + b] = true;
                }
            }
        }
        // Larger sets need no test: moved by infinitesimals, no four planes of linear functions meet in a
        // point.
        for a in 0..n {
            for b in (0..a).filter(|b| !apart[a * n + b]) {
                for c in (0..b).filter(|c| !apart[a * n + c] && !apart[b * n + c]) {
                    let triple = [a, b, c].map(|k| entries[k]);
                    if !grow_together(&triple.map(|e| e.gradient)) && !self.meet_outside(&triple) {
                        return false;
                    }
                }
            }
        }
        true
    }

    fn primitive(&self, entry: &ActivePrimitive) -> &Primitive {
        &self.csg.primitives()[self.pruned.primitives[entry.at] as usize]
    }

    /// Whether x − y or x + y has one sign in all of the cell, both scaled to gradients of equal length.
    fn is_separated(&self, x: &ActivePrimitive, y: &ActivePrimitive) -> bool {
        // The signs of the plain functions, whatever the polarity, since only the zero sets have to be apart.
        let sign = |e: &ActivePrimitive| {
            let gradient = self.ranges[e.at].gradient.as_ref().expect("entries have gradients");
            if dot(e.gradient.middle, gradient.each_ref().map(|d| 0.5 * (d.lo() + d.hi()))) < 0.0 {
                -1.0
            } else {
                1.0
            }
        };
        // If the gradients of the plain functions have about the same direction, x − y hardly varies in the
        // cell; if they are opposite, x + y does.
        let same =
            sign(x) * sign(y) * if dot(x.gradient.middle, y.gradient.middle) > 0.0 { 1.0 } else { -1.0 };
        let scale = self.middle_slope(x) / self.middle_slope(y);
        let (p, q) = (&self.values[x.at], &self.values[y.at]);
        let reach = (1.0 + SLACK) * (self.interpolation_error(x.at) + scale * self.interpolation_error(y.at));
        let [low, high] = min_max(&std::array::from_fn(|k| p[k] - same * scale * q[k]));
        low > reach || high < -reach
    }

    /// Whether, for some sides of the other primitives, membership depends on both primitives.
    fn decide_together(&self, x: usize, y: usize) -> bool {
        let primitives = &self.pruned.primitives;
        let others: Vec<usize> = (0..primitives.len()).filter(|k| *k != x && *k != y).collect();
        if others.len() > MOST_OTHERS {
            return true;
        }
        // By bit: whether that other primitive is inside.
        (0..1_u32 << others.len()).any(|sides| {
            let inside = |in_x: bool, in_y: bool| {
                self.pruned.tree.contains(|p| {
                    let k = index_of(primitives, p);
                    if k == x {
                        in_x
                    } else if k == y {
                        in_y
                    } else {
                        sides >> place_of(&others, k) & 1 == 1
                    }
                })
            };
            let [p, q, r, s] =
                [(false, false), (false, true), (true, false), (true, true)].map(|(a, b)| inside(a, b));
            // Membership depends on x for some side of y, and on y for some side of x.
            (p != r || q != s) && (p != q || r != s)
        })
    }

    /// Whether the three linear functions vanish together far outside of the cell.
    fn meet_outside(&self, triple: &[ActivePrimitive; 3]) -> bool {
        let [p, q, r] = triple.map(|e| self.values[e.at]);
        let without = |v: &[f64; 4], k: usize| -> [f64; 3] {
            std::array::from_fn(|i| v[if i < k { i } else { i + 1 }])
        };
        // The minors of the 3 × 4 matrix of values, with alternating signs, are the barycentric coordinates
        // of the common zero up to a common factor.
        let weights: [f64; 4] = std::array::from_fn(|k| {
            let minor = dot(without(&p, k), cross(without(&q, k), without(&r, k)));
            if k % 2 == 0 { minor } else { -minor }
        });
        let sum: f64 = weights.iter().sum();
        // If the sum is 0, the common zero is at infinity, and some quotient is −∞.
        weights.iter().any(|w| w / sum < OUTSIDE)
    }
}

/// A primitive or its complement whose zero set may be boundary, by its index in the tree's primitives.
#[derive(Clone, Copy)]
struct ActivePrimitive {
    at: usize,
    gradient: GradientBox,
}

fn place_of(others: &[usize], index: usize) -> usize {
    others.iter().position(|k| *k == index).expect("it is one of the others")
}

fn min_max(values: &[f64; 4]) -> [f64; 2] {
    values
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [lesser(*v, low), greater(*v, high)])
}

/// The cells at each vertex, as linked lists in one store.
#[derive(Debug, Default)]
pub(super) struct CellsAtVertices {
    /// By vertex: its first node.
    first: Vec<u32>,
    /// A cell, and the next node.
    nodes: Vec<(u32, u32)>,
}

const NONE: u32 = u32::MAX;

impl CellsAtVertices {
    pub fn push(&mut self, vertex: u32, cell: u32) {
        let vertex = vertex as usize;
        if self.first.len() <= vertex {
            self.first.resize(vertex + 1, NONE);
        }
        self.nodes.push((cell, self.first[vertex]));
        self.first[vertex] = self.nodes.len() as u32 - 1;
    }

    pub fn cells_at(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let mut node = self.first.get(vertex as usize).copied().unwrap_or(NONE);
        std::iter::from_fn(move || {
            let (cell, next) = *self.nodes.get(node as usize)?;
            node = next;
            Some(cell)
        })
    }
}
