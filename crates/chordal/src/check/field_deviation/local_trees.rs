//! CSG trees that are valid in a part of space: few of them, shared by many cells and pieces.
//!
//! **Closed cracks.** Where a primitive p and its complement are joined, as by two stacked boxes, `{F < 0}`
//! lacks the zero set of p though both sides of it are inside. Let f be continuous near a set X, and let the
//! tree be *inside* on X with p taken as inside, and *inside* with p taken as outside. Then X without {f = 0}
//! is inside, and if {f = 0} has no interior, X lies in the closure of {F < 0}. If the tree is *outside* with
//! either, X is outside, {f = 0} included: a tree is monotone in its literals, and where f = 0 both p and its
//! complement are outside. So for a few such primitives all cases are enumerated.
//!
//! **Parallel surfaces.** Primitives that are levels of one function t have an order: what is below the lower
//! of two levels is below the upper one, however near they are. So the sides of a few of them are enumerated
//! as well, without those that contradict the order. The argument above holds for the remaining cases: a
//! point off all zero sets has the sides of one of them, and where t is at a level, both sides of that level
//! occur with the sides of the others.
use crate::implicit::csg::LevelFunction;
use crate::implicit::{Csg, CsgNode, CsgRestriction, CsgTree, DualRange, Membership, Primitive};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// The sides of a primitive and of its complement on which a set lies. Where the primitive is 0, both are
/// outside; so a set where it is at most 0 may be outside its complement without being inside itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LiteralSides {
    plain: Membership,
    complement: Membership,
}

impl LiteralSides {
    pub const INSIDE: Self = Self { plain: Membership::Inside, complement: Membership::Outside };
    pub const OUTSIDE: Self = Self { plain: Membership::Outside, complement: Membership::Inside };
    pub const UNKNOWN: Self = Self { plain: Membership::Unknown, complement: Membership::Unknown };

    /// From the range of all values.
    pub fn from_range([low, high]: &[f64; 2]) -> Self {
        let side = |is_inside, is_outside| match (is_inside, is_outside) {
            (true, _) => Membership::Inside,
            (_, true) => Membership::Outside,
            _ => Membership::Unknown,
        };
        Self { plain: side(*high < 0.0, *low >= 0.0), complement: side(*low > 0.0, *high <= 0.0) }
    }

    /// The same, but unknown if the range contains 0.
    pub fn off_zero(range: &[f64; 2]) -> Self {
        let [low, high] = range;
        if *low > 0.0 || *high < 0.0 { Self::from_range(range) } else { Self::UNKNOWN }
    }

    pub fn membership_of(&self, is_complement: bool) -> Membership {
        if is_complement { self.complement } else { self.plain }
    }

    /// Whether one of the sides is unknown.
    pub fn is_open(&self) -> bool {
        self.plain == Membership::Unknown || self.complement == Membership::Unknown
    }
}

/// A tree with its primitives.
#[derive(Clone, Debug)]
pub(super) struct LocalTree {
    pub tree: CsgTree,
    /// Ascending.
    pub primitives: Vec<u32>,
    /// By primitive: whether it occurs in the tree as itself (1), and as its complement (2).
    kinds: Vec<u8>,
    /// Indices in `primitives` of the primitives that occur as themselves and as their complements.
    mixed: Vec<u32>,
    /// Indices in `primitives` of the primitives that are parallel to another one there, with their positions
    /// in that order.
    parallel: Vec<(u32, LevelOrder)>,
}

/// The position of a primitive among the levels of one function.
#[derive(Clone, Copy, Debug)]
struct LevelOrder {
    /// The number of the function.
    family: u32,
    /// Lower levels have lower ranks.
    rank: u32,
    /// Whether the primitive falls as the function grows.
    falls: bool,
}

impl LevelOrder {
    /// By primitive: its position, if it is parallel to others.
    fn of_all(primitives: &[Primitive]) -> Arc<[Option<Self>]> {
        let mut orders = vec![None; primitives.len()];
        for (number, family) in level_families(primitives).into_iter().enumerate() {
            let Some(family) = by_height(primitives, family) else { continue };
            for (rank, p) in family.iter().enumerate() {
                let falls = primitives[*p as usize].falls();
                orders[*p as usize] = Some(Self { family: number as u32, rank: rank as u32, falls });
            }
        }
        orders.into()
    }

    /// Whether the sides of two primitives contradict each other.
    fn contradicts(&self, is_inside: bool, other: &Self, is_inside_other: bool) -> bool {
        let (is_below, is_below_other) = (is_inside != self.falls, is_inside_other != other.falls);
        self.family == other.family && (self.rank < other.rank) == is_below && is_below != is_below_other
    }
}

/// The most primitives whose cases are enumerated: 2⁴ evaluations of a tree.
pub(super) const MOST_CASES: usize = 4;

impl LocalTree {
    pub fn new(tree: CsgTree) -> Self {
        Self::with_orders(tree, &[])
    }

    /// A tree with the known orders of primitives, by their numbers.
    fn with_orders(tree: CsgTree, orders: &[Option<LevelOrder>]) -> Self {
        let primitives = tree.primitives();
        let order_of = |p: &u32| orders.get(*p as usize).copied().flatten();
        let has_other = |p: u32, family| {
            primitives.iter().any(|q| *q != p && order_of(q).is_some_and(|o| o.family == family))
        };
        let parallel = (0_u32..).zip(&primitives).filter_map(|(index, p)| Some((index, order_of(p)?, *p)));
        let parallel = parallel.filter(|(_, order, p)| has_other(*p, order.family));
        let parallel = parallel.map(|(index, order, _)| (index, order)).collect();
        // Bit 1 for the primitive, bit 2 for its complement: 3 means that it occurs as both.
        let mut kinds = vec![0_u8; primitives.len()];
        for node in tree.nodes() {
            let (p, kind) = match node {
                CsgNode::Primitive(p) => (p, 1),
                CsgNode::Complement(p) => (p, 2),
                CsgNode::Union(_) | CsgNode::Intersection(_) => continue,
            };
            kinds[primitives.binary_search(p).expect("all are listed")] |= kind;
        }
        let mixed = (0..primitives.len() as u32).filter(|k| kinds[*k as usize] == 3).collect();
        Self { tree, primitives, kinds, mixed, parallel }
    }

    /// An estimate of its memory: its lists, itself and its entry in a table.
    fn bytes(&self) -> u64 {
        let of_lists = size_of_val(self.tree.nodes())
            + size_of_val(&*self.primitives)
            + size_of_val(&*self.kinds)
            + size_of_val(&*self.mixed)
            + size_of_val(&*self.parallel);
        (of_lists + 2 * size_of::<Self>()) as u64
    }

    /// The distinct literals: primitives, and whether they occur as their complements.
    pub fn literals(&self) -> impl Iterator<Item = (u32, bool)> + use<'_> {
        let occurrences = self.primitives.iter().zip(&self.kinds);
        occurrences.flat_map(|(p, kinds)| {
            [(*p, false), (*p, true)]
                .into_iter()
                .filter(move |(_, is_complement)| kinds >> u8::from(*is_complement) & 1 == 1)
        })
    }

    /// The primitives that occur in the tree as themselves and as their complements.
    pub fn mixed(&self) -> impl Iterator<Item = u32> + use<'_> {
        self.mixed.iter().map(|index| self.primitives[*index as usize])
    }

    /// The index of a primitive in the list.
    pub fn index_of(&self, primitive: u32) -> usize {
        self.primitives.binary_search(&primitive).expect("a primitive of the tree")
    }

    /// The side of a set, up to closed cracks, from the sides of the primitives in the order of the list.
    pub fn membership(&self, sides: &[LiteralSides], slopes: &[DualRange]) -> Membership {
        let plain = self.membership_without_cracks(sides);
        if plain != Membership::Unknown || self.mixed.is_empty() && self.parallel.is_empty() {
            return plain;
        }
        let open = self.cases(sides);
        if open.is_empty() || open.len() > MOST_CASES {
            return Membership::Unknown;
        }
        let mut of_case = sides.to_vec();
        let mut common_side = None;
        for case in (0..1_u32 << open.len()).filter(|case| is_consistent(&open, *case)) {
            for (bit, (k, _)) in open.iter().enumerate() {
                of_case[*k] = if is_inside(case, bit) { LiteralSides::INSIDE } else { LiteralSides::OUTSIDE };
            }
            let side = self.membership_without_cracks(&of_case);
            if side == Membership::Unknown || common_side.is_some_and(|common| common != side) {
                return Membership::Unknown;
            }
            common_side = Some(side);
        }
        // A closed crack may be counted as inside only if nothing of the inside is lost with it, so
        // if the zero sets have no interior. For the outside the argument needs no such thing.
        match common_side {
            Some(Membership::Inside) if !open.iter().all(|(k, _)| has_thin_zeros(&slopes[*k])) => {
                Membership::Unknown
            }
            Some(side) => side,
            None => Membership::Unknown,
        }
    }

    /// The open primitives whose cases decide more than their ranges, by index, with their order: those that
    /// occur as themselves and as their complements, and those with a parallel primitive that is open too.
    fn cases(&self, sides: &[LiteralSides]) -> Vec<(usize, Option<LevelOrder>)> {
        let is_open = |index: u32| sides[index as usize].is_open();
        let open: Vec<(u32, LevelOrder)> =
            self.parallel.iter().copied().filter(|(k, _)| is_open(*k)).collect();
        let order_of = |index: u32| {
            let order = open.iter().find(|(k, _)| *k == index)?.1;
            open.iter().any(|(k, other)| *k != index && other.family == order.family).then_some(order)
        };
        let of_parallel = open.iter().map(|(k, _)| *k).filter(|k| order_of(*k).is_some());
        let mut indices: Vec<u32> =
            self.mixed.iter().copied().filter(|k| is_open(*k)).chain(of_parallel).collect();
        indices.sort_unstable();
        indices.dedup();
        indices.into_iter().map(|k| (k as usize, order_of(k))).collect()
    }

    /// The side of a set, without closing cracks.
    pub fn membership_without_cracks(&self, sides: &[LiteralSides]) -> Membership {
        self.tree.membership(|p, is_complement| sides[self.index_of(p)].membership_of(is_complement))
    }
}

/// Whether a case takes a primitive as inside.
fn is_inside(case: u32, number: usize) -> bool {
    case >> number & 1 == 1
}

/// Whether a case respects the order of parallel primitives.
fn is_consistent(open: &[(usize, Option<LevelOrder>)], case: u32) -> bool {
    let ordered =
        || open.iter().enumerate().filter_map(|(bit, (_, order))| Some((is_inside(case, bit), (*order)?)));
    ordered().all(|(is_inside, order)| {
        ordered().all(|(is_inside_other, other)| !order.contradicts(is_inside, &other, is_inside_other))
    })
}

/// The families of primitives that are levels of one function, without families of a single one.
fn level_families(primitives: &[Primitive]) -> Vec<Vec<u32>> {
    let mut by_function: BTreeMap<LevelFunction, Vec<u32>> = BTreeMap::new();
    for (number, primitive) in (0_u32..).zip(primitives) {
        if let Some(function) = primitive.level_function() {
            by_function.entry(function).or_default().push(number);
        }
    }
    by_function.into_values().filter(|family| family.len() > 1).collect()
}

/// Levels of one function in their order; `None` if two of them are too near to each other to have one.
pub(super) fn by_height(primitives: &[Primitive], mut family: Vec<u32>) -> Option<Vec<u32>> {
    let primitive = |p: u32| &primitives[p as usize];
    family.sort_by(|a, b| primitive(*a).height().total_cmp(&primitive(*b).height()));
    family.windows(2).all(|pair| primitive(pair[0]).is_parallel_to(primitive(pair[1]))).then_some(family)
}

/// Whether the zero set has no interior: along some axis the function grows everywhere, or falls.
pub(super) fn has_thin_zeros(slope: &DualRange) -> bool {
    slope.gradient.is_some_and(|g| g.iter().any(|d| d.lo() > 0.0 || d.hi() < 0.0))
}

/// Trees by index, each stored once.
#[derive(Clone, Debug)]
pub(super) struct LocalTrees {
    trees: Vec<LocalTree>,
    /// Maps a tree's fingerprint to one of the trees that have it.
    numbers: HashMap<u64, u32>, // No order depends on it.
    bytes: u64,
    /// By primitive.
    orders: Arc<[Option<LevelOrder>]>,
}

impl LocalTrees {
    /// The whole tree gets index 0.
    pub fn new(csg: &Csg) -> Self {
        let orders = LevelOrder::of_all(csg.primitives());
        // No order depends on it.
        let mut trees = Self { trees: Vec::new(), numbers: HashMap::new(), bytes: 0, orders };
        trees.push(csg.tree().clone());
        trees
    }

    pub fn get(&self, number: u32) -> &LocalTree {
        &self.trees[number as usize]
    }

    /// The memory of all trees.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The index of the tree that remains once some sides are known; `number` itself if nothing is decided.
    pub fn restricted(&mut self, number: u32, sides: &[LiteralSides]) -> Result<u32, Membership> {
        if sides.iter().all(|side| *side == LiteralSides::UNKNOWN) {
            return Ok(number);
        }
        let local = self.get(number);
        match local.tree.restrict(|p, is_complement| sides[local.index_of(p)].membership_of(is_complement)) {
            CsgRestriction::Decided(side) => Err(side),
            CsgRestriction::Open(tree) => Ok(self.push(tree)),
        }
    }

    /// The index of the tree without operands that never have its value, from ranges in the order of its
    /// primitives.
    pub fn by_value(&mut self, number: u32, ranges: &[[f64; 2]]) -> u32 {
        let local = self.get(number);
        let range_of = |p: u32, is_complement: bool| {
            let [low, high] = ranges[local.index_of(p)];
            if is_complement { [-high, -low] } else { [low, high] }
        };
        let (_, tree) = by_value(&local.tree, range_of);
        if tree.nodes().len() == local.tree.nodes().len() { number } else { self.push(tree) }
    }

    fn push(&mut self, tree: CsgTree) -> u32 {
        let hash = tree.fingerprint();
        // Different trees may have one fingerprint, so only equal trees are shared; after a
        // collision the later tree is stored, and found from then on.
        if let Some(number) = self.numbers.get(&hash).filter(|number| self.get(**number).tree == tree) {
            return *number;
        }
        let local = LocalTree::with_orders(tree, &self.orders);
        self.bytes += local.bytes();
        self.trees.push(local);
        let number = self.trees.len() as u32 - 1;
        self.numbers.insert(hash, number);
        number
    }

    /// Removes all trees except the first `n`.
    pub fn truncate(&mut self, n: usize) {
        for (number, local) in self.trees.iter().enumerate().skip(n) {
            self.bytes -= local.bytes();
            let hash = local.tree.fingerprint();
            if self.numbers.get(&hash) == Some(&(number as u32)) {
                self.numbers.remove(&hash);
            }
        }
        self.trees.truncate(n);
    }

    pub fn len(&self) -> usize {
        self.trees.len()
    }
}

/// The range of a tree's value in a region, from the ranges of its literals (a primitive, and whether it
/// occurs as its complement), and a tree that has the same value at every point: without the operands of
/// minima that are above another operand throughout, and those of maxima that are below.
pub(super) fn by_value(tree: &CsgTree, range_of: impl Fn(u32, bool) -> [f64; 2]) -> ([f64; 2], CsgTree) {
    let mut stack: Vec<([f64; 2], Vec<CsgNode>)> = Vec::new();
    for node in tree.nodes() {
        let result = match *node {
            CsgNode::Primitive(p) => (range_of(p, false), vec![*node]),
            CsgNode::Complement(p) => (range_of(p, true), vec![*node]),
            CsgNode::Union(n) | CsgNode::Intersection(n) => {
                let is_union = matches!(node, CsgNode::Union(_));
                let operands = stack.split_off(stack.len() - n as usize);
                // A union is a minimum, an intersection a maximum; both are monotone, so ends give
                // ends.
                let pick = |a: f64, b: f64| if (b < a) == is_union { b } else { a };
                let range = operands[1..]
                    .iter()
                    .fold(operands[0].0, |[a, b], ([c, d], _)| [pick(a, *c), pick(b, *d)]);
                let may = |[low, high]: [f64; 2]| if is_union { low <= range[1] } else { high >= range[0] };
                let mut n_kept = 0;
                let mut nodes = Vec::new();
                for (operand_range, below) in operands {
                    if may(operand_range) {
                        n_kept += 1;
                        nodes.extend(below);
                    }
                }
                // An operator with one operand is that operand.
                if n_kept > 1 {
                    nodes.push(if is_union { CsgNode::Union(n_kept) } else { CsgNode::Intersection(n_kept) });
                }
                (range, nodes)
            }
        };
        stack.push(result);
    }
    let (range, nodes) = stack.pop().expect("a tree has one result");
    (range, CsgTree::new(nodes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::implicit::{Expr, PrimitiveEvaluator};
    use crate::math::Box3;

    /// The side of a box on which nothing is decided, but for the order of parallel primitives.
    fn side(sign: &Expr, at: [f64; 3]) -> Membership {
        let csg = Csg::from_expr(sign);
        let mut trees = LocalTrees::new(&csg);
        let bounds = Box3 { min: at.map(|x| x - 0.5), max: at.map(|x| x + 0.5) };
        let job = crate::Job::default();
        let mut evaluator = PrimitiveEvaluator::new(&csg, &bounds, &job);
        let local = trees.get(0).clone();
        let questions: Vec<(u32, Box3)> = local.primitives.iter().map(|p| (*p, bounds)).collect();
        let slopes = evaluator.dual_ranges(&questions).unwrap();
        let sides: Vec<LiteralSides> =
            slopes.iter().map(|slope| LiteralSides::from_range(&slope.value)).collect();
        assert!(sides.iter().all(LiteralSides::is_open) && trees.restricted(0, &sides) == Ok(0));
        local.membership(&sides, &slopes)
    }

    #[test]
    fn parallel_surfaces_keep_their_order_however_near_they_are() {
        let [x, y, z] = Expr::axes();
        let level = |height: f64| &z - height;
        let ring = |radius: f64| (x.square() + y.square()).sqrt() - radius;
        let (low, high) = (level(0.0), level(1e-6));
        let (inner, outer) = (ring(3.0), ring(3.0 + 1e-6));
        let at = [3.0, 0.0, 0.0];
        for (a, b) in [(&low, &high), (&inner, &outer)] {
            // Below the lower one and above the upper one is nothing, and each point is in one of the other two.
            assert_eq!(side(&a.max(&-b), at), Membership::Outside);
            assert_eq!(side(&b.min(&-a), at), Membership::Inside);
            assert_eq!(side(&b.max(&-a), at), Membership::Unknown);
            assert_eq!(side(&a.min(&-b), at), Membership::Unknown);
        }
        // Three levels, the middle one both ways; and two families at a time.
        let middle = level(5e-7);
        assert_eq!(side(&low.max(&-&high).min(&middle.max(&low).max(&-&high)), at), Membership::Outside);
        assert_eq!(side(&low.max(&-&high).min(&inner.max(&-&outer)), at), Membership::Outside);
        assert_eq!(side(&low.max(&-&high).min(&inner.max(&-&low)), at), Membership::Unknown);
        // Levels whose difference is less than their roundings may be have no order.
        let r = (x.square() + y.square()).sqrt();
        let (one, same) = ((&r - 3.1) * 3.0, &r * 3.0 - (3.1 * 3.0 + 4.0 * f64::EPSILON));
        assert_eq!(side(&one.max(&-&same), at), Membership::Unknown);
    }
}
