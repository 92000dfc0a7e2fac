//! `CsgTree`: unions and intersections of primitives and their complements, as a list of nodes in postfix
//! order.
use std::hash::{DefaultHasher, Hash, Hasher};

/// Whether all points of a region are inside a solid, as far as known.
///
/// Source of the term: R. Tilove, *Set membership classification*, 1980.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Membership {
    /// All points are inside: values below 0.
    Inside,
    /// All points are outside: values of 0 and above, or undefined values.
    Outside,
    /// Undecided.
    Unknown,
}

impl Membership {
    /// The membership in a literal, from that in its primitive: the opposite one for the complement. This
    /// holds where the primitive is nowhere 0.
    #[inline]
    #[must_use]
    pub fn complement_if(self, is_complement: bool) -> Self {
        match (self, is_complement) {
            (Self::Inside, true) => Self::Outside,
            (Self::Outside, true) => Self::Inside,
            (side, _) => side,
        }
    }

    /// The membership of a point with this value.
    #[inline]
    #[must_use]
    pub fn from_value(value: f64) -> Self {
        if value < 0.0 { Self::Inside } else { Self::Outside }
    }
}

/// A node of a [`CsgTree`]. Operators take their operands from the results before them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CsgNode {
    /// The solid of a primitive.
    Primitive(u32),
    /// The complement of that solid.
    Complement(u32),
    /// The union of this many preceding results.
    Union(u32),
    /// The intersection of this many preceding results.
    Intersection(u32),
}

/// Unions and intersections of primitives and their complements.
///
/// The nodes are in postfix order: operands come before their operator, and the last node is the root. Trees
/// of any depth are evaluated without recursion. The value of a union is the minimum of its operands, of an
/// intersection the maximum, of a complement the negation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CsgTree {
    nodes: Vec<CsgNode>,
}

/// A tree restricted to a region.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CsgRestriction {
    /// All of the region is inside, or all of it is outside.
    Decided(Membership),
    /// The tree of the primitives that still matter there.
    Open(CsgTree),
}

impl CsgTree {
    /// A tree from nodes in postfix order.
    ///
    /// # Panics
    /// When they do not leave exactly one result.
    #[must_use]
    pub fn new(nodes: Vec<CsgNode>) -> Self {
        let mut depth = 0_u64;
        for node in &nodes {
            match node {
                CsgNode::Primitive(_) | CsgNode::Complement(_) => depth += 1,
                CsgNode::Union(n) | CsgNode::Intersection(n) => {
                    assert!(*n > 0 && u64::from(*n) <= depth, "an operator lacks operands");
                    depth -= u64::from(*n) - 1;
                }
            }
        }
        assert_eq!(depth, 1, "a tree has one result");
        Self { nodes }
    }

    /// The nodes in postfix order.
    #[must_use]
    pub fn nodes(&self) -> &[CsgNode] {
        &self.nodes
    }

    /// A hash for finding equal trees; different trees hardly ever share it.
    pub(crate) fn fingerprint(&self) -> u64 {
        let mut hasher = DefaultHasher::new(); // No result depends on it: equal trees are compared.
        self.nodes.hash(&mut hasher);
        hasher.finish()
    }

    /// The distinct primitives, ascending.
    #[must_use]
    pub fn primitives(&self) -> Vec<u32> {
        let index = |node: &CsgNode| match node {
            CsgNode::Primitive(p) | CsgNode::Complement(p) => Some(*p),
            CsgNode::Union(_) | CsgNode::Intersection(_) => None,
        };
        let mut indices: Vec<u32> = self.nodes.iter().filter_map(index).collect();
        indices.sort_unstable();
        indices.dedup();
        indices
    }

    /// The membership in the root, by three-valued logic, from that in the literals: `of` takes a literal as its
    /// primitive and whether it is the complement. At zeros of a primitive, its complement is outside as well.
    #[must_use]
    pub fn membership(&self, of: impl FnMut(u32, bool) -> Membership) -> Membership {
        self.fold(of, |sides, is_union| joined(sides.iter().copied(), is_union))
    }

    /// Whether a point is inside the solid of the root, from its primitives.
    #[must_use]
    pub fn contains(&self, mut of: impl FnMut(u32) -> bool) -> bool {
        self.fold(
            |p, complemented| of(p) != complemented,
            |sides, is_union| if is_union { sides.contains(&true) } else { !sides.contains(&false) },
        )
    }

    /// The value of the root: the minimum for unions, the maximum for intersections.
    #[must_use]
    pub fn value(&self, mut of: impl FnMut(u32) -> f64) -> f64 {
        let pick = |a: f64, b: f64, is_union: bool| if (b < a) == is_union { b } else { a };
        self.fold(
            |p, complemented| if complemented { -of(p) } else { of(p) },
            |values, is_union| values[1..].iter().fold(values[0], |a, b| pick(a, *b, is_union)),
        )
    }

    /// An interval `[low, high]` of the value of the root from intervals of the primitives.
    #[must_use]
    pub fn range(&self, mut of: impl FnMut(u32) -> [f64; 2]) -> [f64; 2] {
        self.fold(
            |p, complemented| {
                let [low, high] = of(p);
                if complemented { [-high, -low] } else { [low, high] }
            },
            |ranges, is_union| {
                let pick = |a: f64, b: f64| if (b < a) == is_union { b } else { a };
                ranges[1..].iter().fold(ranges[0], |[a, b], [c, d]| [pick(a, *c), pick(b, *d)])
            },
        )
    }

    /// The tree without its decided parts. `of` classifies a region against each literal: a primitive and
    /// whether it occurs as its complement.
    #[must_use]
    pub fn restrict(&self, mut of: impl FnMut(u32, bool) -> Membership) -> CsgRestriction {
        // For each result, the stack holds its membership and the first of its nodes in `nodes`. When an
        // operator is decided, its nodes are cut off again; when it is open, they stay, and the operator
        // follows.
        let mut nodes: Vec<CsgNode> = Vec::with_capacity(self.nodes.len());
        let mut stack: Vec<(Membership, usize)> = Vec::new();
        for node in &self.nodes {
            let start = nodes.len();
            match *node {
                CsgNode::Primitive(p) | CsgNode::Complement(p) => {
                    let side = of(p, matches!(node, CsgNode::Complement(_)));
                    if side == Membership::Unknown {
                        nodes.push(*node);
                    }
                    stack.push((side, start));
                }
                CsgNode::Union(n) | CsgNode::Intersection(n) => {
                    let is_union = matches!(node, CsgNode::Union(_));
                    let first = stack.len() - n as usize;
                    let side = joined(stack[first..].iter().map(|(side, _)| *side), is_union);
                    let start = stack[first].1;
                    let n_open =
                        stack[first..].iter().filter(|(side, _)| *side == Membership::Unknown).count();
                    stack.truncate(first);
                    // With one open operand there is no operator: that operand's nodes are the result.
                    if side != Membership::Unknown {
                        nodes.truncate(start);
                    } else if n_open > 1 {
                        let n = n_open as u32;
                        nodes.push(if is_union { CsgNode::Union(n) } else { CsgNode::Intersection(n) });
                    }
                    stack.push((side, start));
                }
            }
        }
        match stack.first() {
            Some((Membership::Unknown, _)) | None => CsgRestriction::Open(Self { nodes }),
            Some((side, _)) => CsgRestriction::Decided(*side),
        }
    }

    /// The literals that can determine the value of the root somewhere in a region, each as its primitive and
    /// whether it is the complement. `of` gives the interval of a primitive in the region. If `a < b`
    /// throughout, `b` never determines `min(a, b)`.
    #[must_use]
    pub fn active(&self, mut of: impl FnMut(u32) -> [f64; 2]) -> Vec<(u32, bool)> {
        let mut stack: Vec<ActiveResult> = Vec::new();
        for node in &self.nodes {
            match *node {
                CsgNode::Primitive(p) => stack.push(ActiveResult { range: of(p), active: vec![(p, false)] }),
                CsgNode::Complement(p) => {
                    let [low, high] = of(p);
                    stack.push(ActiveResult { range: [-high, -low], active: vec![(p, true)] });
                }
                CsgNode::Union(n) | CsgNode::Intersection(n) => {
                    let is_union = matches!(node, CsgNode::Union(_));
                    let operands = stack.split_off(stack.len() - n as usize);
                    stack.push(ActiveResult::joined(operands, is_union));
                }
            }
        }
        let mut active = stack.pop().map_or_else(Vec::new, |root| root.active);
        active.sort_unstable();
        active.dedup();
        active
    }

    /// Evaluates from the primitives up. `join` takes the operands and whether they form a union.
    fn fold<T>(&self, mut of: impl FnMut(u32, bool) -> T, join: impl Fn(&[T], bool) -> T) -> T {
        let mut stack: Vec<T> = Vec::with_capacity(16);
        for node in &self.nodes {
            let result = match *node {
                CsgNode::Primitive(p) => of(p, false),
                CsgNode::Complement(p) => of(p, true),
                CsgNode::Union(n) | CsgNode::Intersection(n) => {
                    let first = stack.len() - n as usize;
                    let result = join(&stack[first..], matches!(node, CsgNode::Union(_)));
                    stack.truncate(first);
                    result
                }
            };
            stack.push(result);
        }
        stack.pop().expect("a tree has one result")
    }
}

/// The result of a node in a region: the interval of its value, and the primitives that can determine it.
struct ActiveResult {
    range: [f64; 2],
    active: Vec<(u32, bool)>,
}

impl ActiveResult {
    fn joined(operands: Vec<Self>, is_union: bool) -> Self {
        let pick = |a: f64, b: f64| if (b < a) == is_union { b } else { a };
        let range = operands[1..]
            .iter()
            .fold(operands[0].range, |[a, b], other| [pick(a, other.range[0]), pick(b, other.range[1])]);
        // Of a minimum, the operands that are not above its upper end throughout.
        let is_active = |[low, high]: [f64; 2]| if is_union { low <= range[1] } else { high >= range[0] };
        let active = operands
            .into_iter()
            .filter(|operand| is_active(operand.range))
            .flat_map(|operand| operand.active)
            .collect();
        Self { range, active }
    }
}

/// The membership in a union or intersection.
pub(super) fn joined(sides: impl Iterator<Item = Membership>, is_union: bool) -> Membership {
    let (decides, otherwise) = if is_union {
        (Membership::Inside, Membership::Outside)
    } else {
        (Membership::Outside, Membership::Inside)
    };
    let mut membership = otherwise;
    for side in sides {
        if side == decides {
            return decides;
        }
        if side == Membership::Unknown {
            membership = Membership::Unknown;
        }
    }
    membership
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(a ∪ ¬b) ∩ c`.
    fn sample() -> CsgTree {
        CsgTree::new(vec![
            CsgNode::Primitive(0),
            CsgNode::Complement(1),
            CsgNode::Union(2),
            CsgNode::Primitive(2),
            CsgNode::Intersection(2),
        ])
    }

    #[test]
    fn memberships_values_and_ranges_agree() {
        let tree = sample();
        for bits in 0..8_u32 {
            let value = |p: u32| if bits >> p & 1 == 1 { -1.0 - f64::from(p) } else { 1.0 + f64::from(p) };
            let expected = tree.value(value);
            let side = |p, is_complement| Membership::from_value(value(p)).complement_if(is_complement);
            assert_eq!(tree.membership(side), Membership::from_value(expected));
            assert_eq!(tree.contains(|p| value(p) < 0.0), expected < 0.0);
            assert_eq!(tree.range(|p| [value(p); 2]), [expected; 2]);
            let active = tree.active(|p| [value(p); 2]);
            assert!(active.iter().any(|(p, not)| expected == if *not { -value(*p) } else { value(*p) }));
        }
    }

    #[test]
    fn restricting_keeps_what_still_decides() {
        let tree = sample();
        let restricted = |classify: fn(u32) -> Membership| {
            tree.restrict(|p, is_complement| classify(p).complement_if(is_complement))
        };
        let unknown = |_| Membership::Unknown;
        assert_eq!(restricted(unknown), CsgRestriction::Open(tree.clone()));
        let c_outside = |p| if p == 2 { Membership::Outside } else { Membership::Unknown };
        assert_eq!(restricted(c_outside), CsgRestriction::Decided(Membership::Outside));
        let b_inside = |p| if p == 1 { Membership::Inside } else { Membership::Unknown };
        let left = CsgTree::new(vec![CsgNode::Primitive(0), CsgNode::Primitive(2), CsgNode::Intersection(2)]);
        assert_eq!(restricted(b_inside), CsgRestriction::Open(left));
        let b_outside = |p| if p == 1 { Membership::Outside } else { Membership::Unknown };
        assert_eq!(restricted(b_outside), CsgRestriction::Open(CsgTree::new(vec![CsgNode::Primitive(2)])));
    }
}
