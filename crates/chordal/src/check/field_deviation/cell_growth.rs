//! Whether the field grows throughout a cell, or in the parts into which planes and shared faces cut it.
//!
//! *Parts.* Let the zero set of a primitive p have no interior in the cell's box. The parts {p ≤ 0} and {p ≥ 0} of the
//! cell are closed, and may replace the cell in the lemma of [`super::cover`], each with a direction for flows inward
//! and one for flows outward. On a flow inward F < 0, so where p ≥ 0 it is never the value and counts as +∞; on a flow
//! outward F > 0, and where p ≤ 0 it counts as −∞; its complement likewise. At points of {p = 0} p does not have the
//! value, and the literal that has it is among the literals of both parts. (A start of F = 0 is moved off {p = 0}, next
//! to it in B*.) With several such primitives all cases of signs are enumerated; levels of one function have one more
//! than there are levels.
//!
//! This is used if p occurs together with its complement, as at a face of two stacked boxes; and if several
//! parallel planes pass a cell, as where a countersink is raised by a hundredth above its plate: no direction
//! suits two planes that face each other, but between them the sign is known.
//!
//! *Decided parts.* A part that planes bound is convex. If F has one sign in its interior, that interior is in one
//! component of A*, or of B*, and a flow that reaches the part has reached that component: it may end there,
//! and the mesh has to wind correctly around a point of the part.
use super::growth::direction;
use super::local_trees::{LiteralSides, LocalTree, MOST_CASES, by_height, by_value, has_thin_zeros};
use crate::implicit::{DualRange, Membership, Primitive};
use crate::math::{Box3, Interval, greater, lesser};

/// A tree that has the field's value in a cell, with the slopes of its primitives there.
pub(super) struct CellGrowth<'a, S> {
    pub local: &'a LocalTree,
    /// The slope of a primitive in the cell.
    pub slope: S,
    /// All primitives.
    pub primitives: &'a [Primitive],
    pub bounds: &'a Box3,
}

/// A primitive that has one sign in a part, and whether that is positive.
pub(super) type KnownSign = (u32, bool);

/// The parts into which a cell is cut, by the signs in each.
type CellCut = Vec<Vec<KnownSign>>;

/// A point of a component, around which the mesh has to wind correctly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WindingProbe {
    pub at: [f64; 3],
    pub side: Membership,
}

/// A part of a cell in which a flow may end.
#[derive(Clone, Debug)]
pub(super) struct DecidedPart {
    /// A point in the part, provided that the signs are proved there.
    pub probe: WindingProbe,
    pub signs: Vec<KnownSign>,
}

/// The flows of the lemma.
const FLOWS: [Membership; 2] = [Membership::Inside, Membership::Outside];

impl<'a, S: Fn(u32) -> &'a DualRange> CellGrowth<'a, S> {
    /// Whether all literals of a tree grow along some direction.
    pub fn has_direction(&self, tree: &LocalTree) -> bool {
        let gradient = |(p, falls): (u32, bool)| {
            let gradient = (self.slope)(p).gradient?;
            Some(if falls { gradient.map(|d| -d) } else { gradient })
        };
        let gradients: Option<Vec<[Interval; 3]>> = tree.literals().map(gradient).collect();
        gradients.is_some_and(|gradients| direction(&gradients).is_some())
    }

    /// The decided parts of the cell, provided that all its other parts have directions.
    pub fn parts(&self) -> Option<Vec<DecidedPart>> {
        let by_faces = self.mixed_cuts().and_then(|cuts| self.parts_by(&cuts));
        by_faces.or_else(|| self.parts_by(&self.plane_cuts()?))
    }

    fn parts_by(&self, cuts: &[CellCut]) -> Option<Vec<DecidedPart>> {
        let n_cases = cuts.iter().fold(1_usize, |n, cut| n.saturating_mul(cut.len()));
        if cuts.is_empty() || n_cases > 1 << MOST_CASES {
            return None;
        }
        let mut decided = Vec::new();
        for case in 0..n_cases {
            // The number of a case has a digit for each cut, which says in which of the parts of
            // that cut the case lies.
            let mut remaining_case = case;
            let mut signs: Vec<KnownSign> = Vec::new();
            for cut in cuts {
                signs.extend(&cut[remaining_case % cut.len()]);
                remaining_case /= cut.len();
            }
            for flow in FLOWS {
                if !self.flows(flow, &signs) {
                    // A point with given signs can be found only for one family of planes, on the diagonal
                    // across it.
                    decided.push(self.decided(flow, signs.clone()).filter(|_| cuts.len() == 1)?);
                }
            }
        }
        Some(decided)
    }

    /// Whether a primitive changes its sign in the cell.
    fn is_open(&self, p: u32) -> bool {
        let [low, high] = (self.slope)(p).value;
        low < 0.0 && high > 0.0
    }

    /// Cuts by the primitives that occur together with their complements; `None` if one of them may vanish
    /// on more than a surface.
    fn mixed_cuts(&self) -> Option<Vec<CellCut>> {
        let mixed: Vec<u32> = self.local.mixed().filter(|p| self.is_open(*p)).collect();
        let is_thin = mixed.iter().all(|p| has_thin_zeros((self.slope)(*p)));
        is_thin.then(|| mixed.into_iter().map(|p| vec![vec![(p, false)], vec![(p, true)]]).collect())
    }

    /// The same cuts and those by parallel planes; `None` if these are too near to each other to have an
    /// order.
    fn plane_cuts(&self) -> Option<Vec<CellCut>> {
        let mut cuts = self.mixed_cuts()?;
        let primitive = |p: u32| &self.primitives[p as usize];
        let mut families: Vec<Vec<u32>> = Vec::new();
        for p in self.local.primitives.iter().filter(|p| self.is_open(**p)) {
            match families.iter_mut().find(|family| primitive(family[0]).is_plane_along(primitive(*p))) {
                Some(family) => family.push(*p),
                None => families.push(vec![*p]),
            }
        }
        families.retain(|family| family.len() > 1);
        let is_thin = families.iter().flatten().all(|p| has_thin_zeros((self.slope)(*p)));
        if families.is_empty() || !is_thin {
            return None;
        }
        // A plane of a family is cut together with its family, and not once more on its own.
        cuts.retain(|cut| !families.iter().flatten().any(|p| *p == cut[0][0].0));
        for family in families {
            cuts.push(self.slabs(family)?);
        }
        Some(cuts)
    }

    /// The signs of parallel planes in the slabs into which they cut space.
    fn slabs(&self, family: Vec<u32>) -> Option<CellCut> {
        let primitive = |p: u32| &self.primitives[p as usize];
        let family = by_height(self.primitives, family)?;
        let slab = |above: usize| {
            // A slab lies above the `above` lowest planes and below the others; a primitive is
            // positive above its plane, unless its value falls with the height.
            let sign = |(k, p): (usize, &u32)| (*p, (k < above) != primitive(*p).falls());
            family.iter().enumerate().map(sign).collect()
        };
        Some((0..=family.len()).map(slab).collect())
    }

    /// Whether there is a direction for a flow inward, through negative values, or outward, through positive
    /// ones, if some primitives have given signs; or no flow is possible.
    fn flows(&self, flow: Membership, signs: &[KnownSign]) -> bool {
        let inward = flow == Membership::Inside;
        let is_positive = |p: u32| signs.iter().find(|(q, _)| *q == p).map(|(_, is_positive)| *is_positive);
        let (range, tree) = by_value(&self.local.tree, |p, falls| {
            let [low, high] = (self.slope)(p).value;
            let [low, high] = if falls { [-high, -low] } else { [low, high] };
            match is_positive(p).map(|is_positive| is_positive != falls) {
                None => [low, high],
                // With this sign it never has the value.
                Some(true) if inward => [f64::INFINITY; 2],
                Some(false) if !inward => [f64::NEG_INFINITY; 2],
                Some(true) => [0.0, high],
                Some(false) => [low, 0.0],
            }
        });
        let is_empty = if inward { range[0] >= 0.0 } else { range[1] < 0.0 };
        is_empty || self.has_direction(&LocalTree::new(tree))
    }

    /// The part as one in which a flow may end, provided that all of it is on the flow's side and bounded by
    /// planes.
    fn decided(&self, flow: Membership, signs: Vec<KnownSign>) -> Option<DecidedPart> {
        let primitive = |p: u32| &self.primitives[p as usize];
        let side_of = |p: &u32| match signs.iter().find(|(q, _)| q == p) {
            Some((_, true)) => LiteralSides::OUTSIDE,
            Some((_, false)) => LiteralSides::INSIDE,
            None => LiteralSides::from_range(&(self.slope)(*p).value),
        };
        let sides: Vec<LiteralSides> = self.local.primitives.iter().map(side_of).collect();
        let is_decided = self.local.membership_without_cracks(&sides) == flow;
        let is_convex = signs.iter().all(|(p, _)| primitive(*p).is_plane_along(primitive(*p)));
        if !is_decided || !is_convex {
            return None;
        }
        Some(DecidedPart { probe: WindingProbe { at: self.point_with(&signs)?, side: flow }, signs })
    }

    /// A point of the cell at which planes of one family seem to have given signs: on the diagonal along
    /// which they change most.
    fn point_with(&self, signs: &[KnownSign]) -> Option<[f64; 3]> {
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        let (first, _) = *signs.first()?;
        let is_turned =
            |p: u32| self.primitives[p as usize].falls() != self.primitives[first as usize].falls();
        for (p, is_positive) in signs {
            let [least, most] = (self.slope)(*p).value;
            let ([least, most], is_above) =
                if is_turned(*p) { ([-most, -least], !is_positive) } else { ([least, most], *is_positive) };
            let zero = -least / (most - least);
            if is_above { low = greater(zero, low) } else { high = lesser(zero, high) }
        }
        let part = 0.5 * low + 0.5 * high;
        let gradient = (self.slope)(first).gradient?;
        let Box3 { min, max } = self.bounds;
        let along = |k: usize| if gradient[k].lo() > 0.0 { part } else { 1.0 - part };
        (low < high).then(|| std::array::from_fn(|k| min[k] + along(k) * (max[k] - min[k])))
    }
}
