//! CSG trees that are valid in a part of space: few of them, shared by many cells and pieces.
//!
//! **Closed cracks.** Where a primitive p and its complement are joined, as by two stacked boxes, `{F < 0}`
//! lacks the zero set of p though both sides of it are inside. Let f be continuous near a set X, and let the
//! tree be *inside* on X with p taken as inside, and *inside* with p taken as outside. Then X without {f = 0}
//! is inside, and if {f = 0} has no interior, X lies in the closure of {F < 0}. If the tree is *outside* with
//! either, X is outside, {f = 0} included: a tree is monotone in its literals, and where f = 0 both p and its
//! complement are outside. So for a few such primitives all cases are enumerated.
use crate::implicit::{CsgNode, CsgRestriction, CsgTree, DualRange, Membership};
use std::collections::HashMap;

/// The sides of a primitive and of its complement on which a set is. Where the primitive is 0, both are
/// outside; so a set where it is at most 0 may be outside of its complement without being inside of itself.
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

    /// The same, unless the range holds 0.
    pub fn off_zero(range: &[f64; 2]) -> Self {
        let [low, high] = range;
        if *low > 0.0 || *high < 0.0 { Self::from_range(range) } else { Self::UNKNOWN }
    }

    pub fn membership_of(&self, falls: bool) -> Membership {
        if falls { self.complement } else { self.plain }
    }

    /// Whether one of them is not known.
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
    /// For each, whether it occurs in the tree as itself (1), and as its complement (2).
    kinds: Vec<u8>,
    /// Indices in `primitives` of those that occur as themselves and as their complements.
    mixed: Vec<u32>,
}

/// The most primitives of both kinds whose cases are enumerated: 2⁴ evaluations of a tree.
pub(super) const MOST_CASES: usize = 4;

impl LocalTree {
    pub fn new(tree: CsgTree) -> Self {
        let primitives = tree.primitives();
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
        Self { tree, primitives, kinds, mixed }
    }

    /// Its memory, about: its lists, and itself with its entry in a table.
    fn bytes(&self) -> u64 {
        let of_lists = size_of_val(self.tree.nodes())
            + size_of_val(&*self.primitives)
            + size_of_val(&*self.kinds)
            + size_of_val(&*self.mixed);
        (of_lists + 2 * size_of::<Self>()) as u64
    }

    /// The distinct literals: primitives, and whether they occur as their complements.
    pub fn literals(&self) -> impl Iterator<Item = (u32, bool)> + use<'_> {
        let both = self.primitives.iter().zip(&self.kinds);
        both.flat_map(|(p, kinds)| {
            [(*p, false), (*p, true)].into_iter().filter(move |(_, falls)| kinds >> u8::from(*falls) & 1 == 1)
        })
    }

    /// The primitives that occur in the tree as themselves and as their complements.
    pub fn mixed(&self) -> impl Iterator<Item = u32> + use<'_> {
        self.mixed.iter().map(|place| self.primitives[*place as usize])
    }

    /// The index of a primitive in the list.
    pub fn place(&self, primitive: u32) -> usize {
        self.primitives.binary_search(&primitive).expect("a primitive of the tree")
    }

    /// The side of a set, up to closed cracks, from the sides of the primitives in the order of the list.
    pub fn membership(&self, sides: &[LiteralSides], slopes: &[DualRange]) -> Membership {
        let plain = self.membership_without_cracks(sides);
        if plain != Membership::Unknown || self.mixed.is_empty() {
            return plain;
        }
        let is_open = |k: &&u32| sides[**k as usize].is_open();
        let open: Vec<usize> = self.mixed.iter().filter(is_open).map(|k| *k as usize).collect();
        if open.is_empty() || open.len() > MOST_CASES {
            return Membership::Unknown;
        }
        let mut of_case = sides.to_vec();
        let mut all = None;
        for case in 0..1_u32 << open.len() {
            for (bit, k) in open.iter().enumerate() {
                let is_inside = case >> bit & 1 == 1;
                of_case[*k] = if is_inside { LiteralSides::INSIDE } else { LiteralSides::OUTSIDE };
            }
            let side = self.membership_without_cracks(&of_case);
            if side == Membership::Unknown || all.is_some_and(|all| all != side) {
                return Membership::Unknown;
            }
            all = Some(side);
        }
        match all {
            Some(Membership::Inside) if !open.iter().all(|k| has_thin_zeros(&slopes[*k])) => {
                Membership::Unknown
            }
            Some(side) => side,
            None => Membership::Unknown,
        }
    }

    /// The same without closing cracks.
    pub fn membership_without_cracks(&self, sides: &[LiteralSides]) -> Membership {
        self.tree.membership(|p, falls| sides[self.place(p)].membership_of(falls))
    }
}

/// Whether the zero set has no interior: along some axis the function grows everywhere, or falls.
pub(super) fn has_thin_zeros(slope: &DualRange) -> bool {
    slope.gradient.is_some_and(|g| g.iter().any(|d| d.lo() > 0.0 || d.hi() < 0.0))
}

/// Trees by index, each stored once.
#[derive(Clone, Debug)]
pub(super) struct LocalTrees {
    all: Vec<LocalTree>,
    /// Maps a tree's fingerprint to one of the trees that have it.
    numbers: HashMap<u64, u32>, // No order depends on it.
    bytes: u64,
}

impl LocalTrees {
    /// The whole tree has index 0.
    pub fn new(whole: &CsgTree) -> Self {
        // No order depends on it.
        let mut trees = Self { all: Vec::new(), numbers: HashMap::new(), bytes: 0 };
        trees.push(whole.clone());
        trees
    }

    pub fn get(&self, number: u32) -> &LocalTree {
        &self.all[number as usize]
    }

    /// Their memory.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The index of the rest of a tree: its own if nothing is decided.
    pub fn restricted(&mut self, number: u32, sides: &[LiteralSides]) -> Result<u32, Membership> {
        if sides.iter().all(|side| *side == LiteralSides::UNKNOWN) {
            return Ok(number);
        }
        let local = self.get(number);
        match local.tree.restrict(|p, falls| sides[local.place(p)].membership_of(falls)) {
            CsgRestriction::Decided(side) => Err(side),
            CsgRestriction::Open(tree) => Ok(self.push(tree)),
        }
    }

    /// The index of the tree without operands that never have its value, from ranges in the order of the
    /// list.
    pub fn by_value(&mut self, number: u32, ranges: &[[f64; 2]]) -> u32 {
        let local = self.get(number);
        let of = |p: u32, falls: bool| {
            let [low, high] = ranges[local.place(p)];
            if falls { [-high, -low] } else { [low, high] }
        };
        let (_, tree) = by_value(&local.tree, of);
        if tree.nodes().len() == local.tree.nodes().len() { number } else { self.push(tree) }
    }

    fn push(&mut self, tree: CsgTree) -> u32 {
        let hash = tree.fingerprint();
        if let Some(number) = self.numbers.get(&hash).filter(|number| self.get(**number).tree == tree) {
            return *number;
        }
        let local = LocalTree::new(tree);
        self.bytes += local.bytes();
        self.all.push(local);
        let number = self.all.len() as u32 - 1;
        self.numbers.insert(hash, number);
        number
    }

    /// Removes all but the first `n`.
    pub fn truncate(&mut self, n: usize) {
        for (number, local) in self.all.iter().enumerate().skip(n) {
            self.bytes -= local.bytes();
            let hash = local.tree.fingerprint();
            if self.numbers.get(&hash) == Some(&(number as u32)) {
                self.numbers.remove(&hash);
            }
        }
        self.all.truncate(n);
    }

    pub fn len(&self) -> usize {
        self.all.len()
    }
}

/// The range of a tree's value in a region, from those of its literals (a primitive, and whether it occurs as
/// its complement), and a tree that has the same value at every point: without the operands of minima that
/// are above another one throughout, and those of maxima that are below.
pub(super) fn by_value(tree: &CsgTree, of: impl Fn(u32, bool) -> [f64; 2]) -> ([f64; 2], CsgTree) {
    let mut stack: Vec<([f64; 2], Vec<CsgNode>)> = Vec::new();
    for node in tree.nodes() {
        let result = match *node {
            CsgNode::Primitive(p) => (of(p, false), vec![*node]),
            CsgNode::Complement(p) => (of(p, true), vec![*node]),
            CsgNode::Union(n) | CsgNode::Intersection(n) => {
                let is_union = matches!(node, CsgNode::Union(_));
                let operands = stack.split_off(stack.len() - n as usize);
                let pick = |a: f64, b: f64| if (b < a) == is_union { b } else { a };
                let range = operands[1..]
                    .iter()
                    .fold(operands[0].0, |[a, b], ([c, d], _)| [pick(a, *c), pick(b, *d)]);
                let may = |[low, high]: [f64; 2]| if is_union { low <= range[1] } else { high >= range[0] };
                let mut kept = 0;
                let mut nodes = Vec::new();
                for (own, below) in operands {
                    if may(own) {
                        kept += 1;
                        nodes.extend(below);
                    }
                }
                if kept > 1 {
                    nodes.push(if is_union { CsgNode::Union(kept) } else { CsgNode::Intersection(kept) });
                }
                (range, nodes)
            }
        };
        stack.push(result);
    }
    let (range, nodes) = stack.pop().expect("a tree has one result");
    (range, CsgTree::new(nodes))
}
