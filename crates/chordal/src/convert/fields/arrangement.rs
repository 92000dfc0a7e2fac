//! The boundary of a solid in one tetrahedron with linear primitives: the arrangement of their planes.
//!
//! Each plane's section of the tetrahedron is a convex polygon, which all other planes cut into pieces:
//!
//! ```text
//!            2            The section of plane i. Its sides lie on the facets f0, f1, f2 of the
//!           / \           tetrahedron; corner t is between side t − 1 and side t.
//!      f2  / P \  f1
//!         x──j──y         Plane j cuts it into P, with the sides f1, f2, j, and Q, with the
//!        /   Q   \        sides f0, f1, j, f2. The sign of j is negative on one of them.
//!       0---------1
//!           f0            x is identified as "planes i and j, on facet f2".
//! ```
//!
//! A piece belongs to the boundary if membership differs between both sides of its plane. Corners are
//! identified by the planes and facets on which they lie, never by coordinates, so a neighbour across f2 has
//! the same x. The side of a corner with respect to a plane is the exact sign of a determinant. Planes are
//! moved by infinitesimals, so no four of them meet in a point, and no three in a line.
//!
//! Only corners that are visible in the boundary are emitted: a crossing of two planes is left out if
//! membership does not depend on one of them there. So neighbours agree in their common facet, even if one of
//! them has already pruned that plane.
//!
//! Source of the idea: X. Du, Q. Zhou, N. Carr, T. Ju, *Robust Computation of Implicit Surface Networks for
//! Piecewise Linear Functions*, 2022.
// Long because figures stand beside the steps that they explain.
use crate::implicit::{CsgRestriction, CsgTree, Membership};
use crate::math::IntegerMap;
use crate::math::determinants::{perturbed_sign, sign2, sign3, sign4};
use std::cell::RefCell;
use std::cmp::Ordering;

/// A primitive whose sign changes in a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct LivePrimitive {
    pub primitive: u32,
    /// Integer values at the corners, none of them 0.
    pub values: [i64; 4],
    /// The sign of the infinitesimal that is added to its values.
    pub sense: i64,
}

/// A tetrahedron with linear primitives. The order of its corners gives it a positive volume.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinearCell<'a> {
    pub corners: [u32; 4],
    /// In ascending order of their numbers.
    pub live: &'a [LivePrimitive],
    pub tree: &'a CsgTree,
}

/// No vertex, no primitive.
pub(super) const NONE: u32 = u32::MAX;

/// The identity of a vertex of the boundary: the simplex and the primitives on which it lies. Cells that share the
/// simplex compute the same identity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct ArrangementVertex {
    /// The corners of the smallest simplex that contains it, ascending, then [`NONE`].
    pub simplex: [u32; 4],
    /// The primitives that vanish there, ascending, then [`NONE`].
    pub primitives: [u32; 3],
    /// Its sheet, if several sheets of the boundary touch there; otherwise 0.
    pub sheet: u32,
    /// For the midpoint between two corners on one crease: the third primitive of the other corner; [`NONE`] for
    /// all other vertices.
    pub other: u32,
}

/// Pieces of the boundary in some cells, each in one plane.
#[derive(Debug, Default)]
pub(super) struct BoundaryPatches {
    pub corners: Vec<ArrangementVertex>,
    /// The end of each loop in `corners`. Loops run counter-clockwise as seen from outside of the solid.
    pub loop_ends: Vec<u32>,
    /// By patch: its label, and the end of its loops in `loop_ends`.
    pub patches: Vec<(u32, u32)>,
}

/// The label of a primitive or of its complement.
pub(super) fn label_of(primitive: u32, is_complemented: bool) -> u32 {
    primitive << 1 | u32::from(is_complemented)
}

/// The signs of the live primitives, by index in the cell: a set bit is negative.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct SignVector {
    first: u128,
    /// The signs after the first 128; nearly always empty.
    rest: Vec<u128>,
}

impl SignVector {
    fn with(mut self, k: usize, is_negative: bool) -> Self {
        let word = match k / 128 {
            0 => &mut self.first,
            n => {
                if self.rest.len() < n {
                    self.rest.resize(n, 0);
                }
                &mut self.rest[n - 1]
            }
        };
        let bit = 1 << (k % 128);
        *word = if is_negative { *word | bit } else { *word & !bit };
        self
    }

    fn get(&self, k: usize) -> bool {
        let word = if k < 128 { self.first } else { self.rest.get(k / 128 - 1).copied().unwrap_or(0) };
        word >> (k % 128) & 1 == 1
    }
}

/// Up to this many primitives, membership is a truth table. Defined: 2⁶ bits are a word.
const TABLE: usize = 6;

/// Membership in the solid as a function of the signs of the live primitives.
enum MembershipTable {
    Table(u64),
    /// With a cache of earlier results.
    Tree(CsgTree, RefCell<IntegerMap<u128, bool>>), // No order depends on it.
}

/// A side of a piece, by where it lies: on the facet opposite a corner, or on the plane of a live primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ArrangementEdge {
    Facet(u8),
    Plane(u32),
}

/// A piece: a convex part of a plane. Corner `t` is between side `t − 1` and side `t`.
#[derive(Clone, Debug)]
struct ArrangementFace {
    sides: Vec<ArrangementEdge>,
    /// The signs of the other primitives.
    negative: SignVector,
}

/// The identity of a corner in the cell's own indices. The bit of a facet in `simplex` is cleared if the corner lies
/// on it, so that the set bits are the corners of the smallest simplex; `planes` ascend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ArrangementCorner {
    simplex: u8,
    planes: [u32; 3],
    sheet: u32,
    is_visible: bool,
}

impl LinearCell<'_> {
    /// Adds the boundary in this cell. `is_negative` gives the signs of the tree's other primitives, which are
    /// constant in it.
    pub fn boundary(&self, is_negative: impl Fn(u32) -> bool, into: &mut BoundaryPatches) {
        let Some(membership) = self.membership_table(is_negative) else { return };
        for i in 0..self.live.len() as u32 {
            if self.live.len() == 1 {
                let piece = ArrangementFace { sides: self.section(i), negative: SignVector::default() };
                self.emit(&membership, i, vec![piece], into);
                continue;
            }
            let mut pieces =
                vec![ArrangementFace { sides: self.section(i), negative: SignVector::default() }];
            // Every other live plane cuts, whether or not membership depends on it here. Leaving out planes
            // that do not matter was tried: neighbours disagreed on which these are, which left T-junctions
            // on their common facet.
            for j in (0..self.live.len() as u32).filter(|j| *j != i) {
                let mut parts = Vec::with_capacity(pieces.len() + 1);
                pieces.into_iter().for_each(|piece| self.cut(i, j, piece, &mut parts));
                pieces = parts;
            }
            self.emit(&membership, i, pieces, into);
        }
    }

    /// `None` if membership is the same throughout the cell.
    fn membership_table(&self, is_negative: impl Fn(u32) -> bool) -> Option<MembershipTable> {
        let live_index = |p: u32| self.live.binary_search_by_key(&p, |live| live.primitive).ok();
        if self.live.len() <= TABLE {
            // Bit `k` is the sign of live primitive `k`, as in `SignVector`, whose first word is thus an
            // index into the table.
            let inside = |sides: u64| {
                self.tree.contains(|p| live_index(p).map_or_else(|| is_negative(p), |k| sides >> k & 1 == 1))
            };
            let n = 1 << self.live.len();
            let table = (0..n).fold(0, |table, sides| table | u64::from(inside(sides)) << sides);
            // For six primitives the table fills the word, and a shift by 64 bits would overflow.
            let full = if n == 64 { u64::MAX } else { (1 << n) - 1 };
            return (table != 0 && table != full).then_some(MembershipTable::Table(table));
        }
        let side = |p: u32| match (live_index(p), is_negative(p)) {
            (Some(_), _) => Membership::Unknown,
            (None, true) => Membership::Inside,
            (None, false) => Membership::Outside,
        };
        match self.tree.restrict(|p, is_complement| side(p).complement_if(is_complement)) {
            CsgRestriction::Decided(_) => None,
            CsgRestriction::Open(tree) => Some(MembershipTable::Tree(tree, RefCell::default())),
        }
    }

    fn is_inside(&self, membership: &MembershipTable, signs: &SignVector) -> bool {
        match membership {
            MembershipTable::Table(table) => table >> (signs.first as u64) & 1 == 1,
            MembershipTable::Tree(tree, cache) => {
                let live_index = |p: u32| self.live.binary_search_by_key(&p, |live| live.primitive);
                let contains =
                    || tree.contains(|p| signs.get(live_index(p).expect("only live ones are left")));
                // The cache has no key for the signs after the first 128.
                if !signs.rest.is_empty() {
                    return contains();
                }
                *cache.borrow_mut().entry(signs.first).or_insert_with(contains)
            }
        }
    }

    /// The section of a plane with the cell, seen from where the primitive is positive.
    fn section(&self, i: u32) -> Vec<ArrangementEdge> {
        let negative = self.live[i as usize].values.map(|x| x < 0);
        let code = (0..4).fold(0, |code, k| code | usize::from(negative[k]) << k);
        SECTIONS[code].iter().filter(|f| **f < 4).map(|f| ArrangementEdge::Facet(*f)).collect()
    }

    /// Cuts a piece of plane `i` by plane `j`.
    fn cut(&self, i: u32, j: u32, piece: ArrangementFace, into: &mut Vec<ArrangementFace>) {
        let n = piece.sides.len();
        let negative: Vec<bool> =
            (0..n).map(|t| self.is_negative([piece.sides[(t + n - 1) % n], piece.sides[t]], i, j)).collect();
        // The piece is convex and no corner is on plane j, which is moved by an infinitesimal. So if the
        // signs at the corners differ, plane j crosses exactly two sides.
        if negative.iter().all(|x| *x == negative[0]) {
            into.push(ArrangementFace {
                negative: piece.negative.with(j as usize, negative[0]),
                sides: piece.sides,
            });
            return;
        }
        for keep_negative in [true, false] {
            let mut sides = Vec::with_capacity(n + 1);
            for t in 0..n {
                let (is_start_kept, is_end_kept) =
                    (negative[t] == keep_negative, negative[(t + 1) % n] == keep_negative);
                if is_start_kept || is_end_kept {
                    sides.push(piece.sides[t]);
                }
                // Plane j takes over where the border leaves the kept part; it is followed by the side on
                // which the border comes back.
                if is_start_kept && !is_end_kept {
                    sides.push(ArrangementEdge::Plane(j));
                }
            }
            into.push(ArrangementFace {
                sides,
                negative: piece.negative.clone().with(j as usize, keep_negative),
            });
        }
    }

    /// Whether primitive `j` is negative at the corner of plane `i` between two sides: the sign of the value of `j` at
    /// the common zero of the other planes, by Cramer's rule.
    fn is_negative(&self, sides: [ArrangementEdge; 2], i: u32, j: u32) -> bool {
        let row = |k: u32| &self.live[k as usize].values;
        let sense = |k: u32| self.live[k as usize].sense;
        let sign = match sides {
            [ArrangementEdge::Facet(f), ArrangementEdge::Facet(g)] => {
                let [a, b] = other_corners([f, g]);
                let pick = |k: u32| [row(k)[a], row(k)[b]];
                // On edge ab, primitive j has the value (i_a·j_b − i_b·j_a) / (i_a − i_b) where i is 0. Plane
                // i crosses the edge, so the denominator has the sign of i_a.
                let sign = perturbed_sign([pick(i), pick(j)], [i, j], [sense(i), sense(j)], sign2);
                if row(i)[a] < 0 { sign.reverse() } else { sign }
            }
            [ArrangementEdge::Facet(f), ArrangementEdge::Plane(k)]
            | [ArrangementEdge::Plane(k), ArrangementEdge::Facet(f)] => {
                let corners = other_corners([f]);
                let pick = |k: u32| corners.map(|c: usize| row(k)[c]);
                let rows = [pick(i), pick(k), pick(j)];
                let sign = perturbed_sign(rows, [i, k, j], [i, k, j].map(sense), sign3);
                // Minors of the rows are the barycentric weights up to a common factor. Weights have the sum
                // 1, so the factor is the determinant with a row of ones.
                divided_sign(sign, sign3([rows[0], rows[1], [1; 3]]))
            }
            [ArrangementEdge::Plane(k), ArrangementEdge::Plane(l)] => {
                let rows = [i, k, l, j].map(|k| *row(k));
                let sign = perturbed_sign(rows, [i, k, l, j], [i, k, l, j].map(sense), sign4);
                divided_sign(sign, sign4([rows[0], rows[1], rows[2], [1; 4]]))
            }
        };
        sign == Ordering::Less
    }

    /// Adds the pieces of plane `i` that belong to the boundary; connected pieces are merged to one patch.
    fn emit(
        &self,
        membership: &MembershipTable,
        i: u32,
        pieces: Vec<ArrangementFace>,
        into: &mut BoundaryPatches,
    ) {
        let mut kept: [Vec<ArrangementFace>; 2] = Default::default();
        for piece in pieces {
            // The signs of a piece are those of all other planes; the two sides of its own plane are tried.
            let inside = |is_negative| {
                self.is_inside(membership, &piece.negative.clone().with(i as usize, is_negative))
            };
            // Solid on the negative side, or on the positive side: the patch of a complement.
            let (below, above) = (inside(true), inside(false));
            if below != above {
                kept[usize::from(above)].push(piece);
            }
        }
        for (above, kept) in kept.into_iter().enumerate() {
            let corners: Vec<Vec<ArrangementCorner>> =
                kept.iter().map(|piece| self.corners(membership, i, piece, above == 1)).collect();
            for loops in merge_faces(&corners) {
                for mut ring in loops {
                    ring.retain(|corner| corner.is_visible);
                    // Sections are counter-clockwise as seen from the positive side, which is solid here.
                    if above == 1 {
                        ring.reverse();
                    }
                    self.push_ring(membership, i, &ring, &kept, into);
                    into.loop_ends.push(into.corners.len() as u32);
                }
                let label = label_of(self.live[i as usize].primitive, above == 1);
                into.patches.push((label, into.loop_ends.len() as u32));
            }
        }
    }

    fn push_ring(
        &self,
        membership: &MembershipTable,
        i: u32,
        ring: &[ArrangementCorner],
        kept: &[ArrangementFace],
        into: &mut BoundaryPatches,
    ) {
        for (t, corner) in ring.iter().enumerate() {
            into.corners.push(self.key(corner));
            let next = &ring[(t + 1) % ring.len()];
            // Ends on a facet differ by sheet already. Only two corners of three planes may be common to both
            // wedges of a crease.
            if corner.planes[2] != NONE && next.planes[2] != NONE {
                into.corners.extend(self.middle(membership, i, [corner, next], kept));
            }
        }
    }

    /// The corners of a piece.
    fn corners(
        &self,
        membership: &MembershipTable,
        i: u32,
        piece: &ArrangementFace,
        is_complemented: bool,
    ) -> Vec<ArrangementCorner> {
        let n = piece.sides.len();
        let corner = |t: usize| {
            // Each facet of the tetrahedron leaves out one of its four vertices.
            let (mut simplex, mut planes) = (15_u8, [i, NONE, NONE]);
            let mut n_planes = 1;
            for side in [piece.sides[(t + n - 1) % n], piece.sides[t]] {
                match side {
                    ArrangementEdge::Facet(f) => simplex &= !(1 << f),
                    ArrangementEdge::Plane(k) => {
                        planes[n_planes] = k;
                        n_planes += 1;
                    }
                }
            }
            planes[..n_planes].sort_unstable();
            let (sheet, is_visible) = self.sheet(membership, &planes[..n_planes], i, piece, is_complemented);
            ArrangementCorner { simplex, planes, sheet, is_visible }
        };
        (0..n).map(corner).collect()
    }

    /// The sheet of the boundary around a corner to which the piece belongs, and whether membership depends on all
    /// planes of the corner, so that the corner is visible.
    fn sheet(
        &self,
        membership: &MembershipTable,
        planes: &[u32],
        i: u32,
        piece: &ArrangementFace,
        is_complemented: bool,
    ) -> (u32, bool) {
        if planes.len() == 1 {
            return (0, true);
        }
        let pattern = self.octant_mask(membership, planes, &piece.negative);
        let matters = |r: usize| (0..1 << planes.len()).any(|o| pattern.at(o) != pattern.at(o ^ 1 << r));
        let is_visible = (0..planes.len()).all(matters);
        let plane = planes.iter().position(|k| *k == i).expect("it is on its own plane");
        // The octant of the solid beside the piece. On plane i itself, the solid is on the negative side
        // unless the patch is that of a complement.
        let negative = |k: u32| if k == i { !is_complemented } else { piece.negative.get(k as usize) };
        let solid = planes.iter().enumerate().fold(0, |o, (r, k)| o | usize::from(negative(*k)) << r);
        let sheet = match planes.len() {
            // Two solid wedges meet in the crease only; each gets a sheet of its own.
            2 if pattern.is_crossed() => 1 + (solid as u32 & 1),
            2 => 0,
            _ => pattern.sheet(plane, solid & !(1 << plane)),
        };
        (sheet, is_visible)
    }

    /// Membership by octant around a point where planes cross.
    fn octant_mask(&self, membership: &MembershipTable, planes: &[u32], signs: &SignVector) -> OctantMask {
        let inside = |octant: usize| {
            let signs = planes
                .iter()
                .enumerate()
                .fold(signs.clone(), |signs, (r, k)| signs.with(*k as usize, octant >> r & 1 == 1));
            self.is_inside(membership, &signs)
        };
        OctantMask((0..1 << planes.len()).fold(0, |mask, octant| mask | u8::from(inside(octant)) << octant))
    }

    /// An additional vertex between two corners of a crease along which the solid touches itself:
    ///
    /// ```text
    ///         q          solid where exactly one of p and q is negative; both wedges have the edge in the
    ///   solid |          middle, perhaps with the same two ends. The midpoint, one for each sheet, keeps
    ///   ------+------ p  their edges apart.
    ///         | solid
    /// ```
    fn middle(
        &self,
        membership: &MembershipTable,
        i: u32,
        ends: [&ArrangementCorner; 2],
        kept: &[ArrangementFace],
    ) -> Option<ArrangementVertex> {
        let [a, b] = ends.map(|end| end.planes);
        let common: Vec<u32> = a.into_iter().filter(|k| b.contains(k)).collect();
        let [p, q] = common[..] else { return None };
        let j = if p == i { q } else { p };
        let third =
            |planes: [u32; 3]| planes.into_iter().find(|k| !common.contains(k)).expect("three differ");
        let (a, b) = (third(a), third(b));
        // The piece whose side on plane j runs between the two corners.
        let has_side = |piece: &&ArrangementFace| {
            let n = piece.sides.len();
            let is_end = |t: usize, k: u32| piece.sides[t % n] == ArrangementEdge::Plane(k);
            (0..n).any(|t| {
                piece.sides[t] == ArrangementEdge::Plane(j)
                    && (is_end(t + 1, b) && is_end(t + n - 1, a) || is_end(t + 1, a) && is_end(t + n - 1, b))
            })
        };
        let piece = kept.iter().find(has_side)?;
        let pattern = self.octant_mask(membership, &[p, q], &piece.negative);
        if !pattern.is_crossed() {
            return None;
        }
        let inside =
            |is_negative| self.is_inside(membership, &piece.negative.clone().with(i as usize, is_negative));
        // The same name as in `sheet`: the sign of the first plane in the solid wedge.
        let first_negative = if p == i { inside(true) } else { piece.negative.get(p as usize) };
        // Ascending, so that the pieces on both planes, and both directions of the edge, give the same
        // identity.
        let [p, q, a, b] = [p, q, a.min(b), a.max(b)].map(|k| self.live[k as usize].primitive);
        let mut simplex = self.corners;
        simplex.sort_unstable();
        Some(ArrangementVertex {
            simplex,
            primitives: [p, q, a],
            sheet: 1 + u32::from(first_negative),
            other: b,
        })
    }

    fn key(&self, corner: &ArrangementCorner) -> ArrangementVertex {
        let mut simplex: [u32; 4] =
            std::array::from_fn(|k| if corner.simplex >> k & 1 == 1 { self.corners[k] } else { NONE });
        simplex.sort_unstable();
        let primitives =
            corner.planes.map(|k| if k == NONE { NONE } else { self.live[k as usize].primitive });
        ArrangementVertex { simplex, primitives, sheet: corner.sheet, other: NONE }
    }
}

/// Membership by octant around a point where two or three planes cross: bit `r` of an octant is set where
/// plane `r` is negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct OctantMask(u8);

impl OctantMask {
    fn at(self, octant: usize) -> bool {
        self.0 >> octant & 1 == 1
    }

    /// For two planes: whether two opposite wedges are solid and the other two are not.
    fn is_crossed(self) -> bool {
        matches!(self.0 & 15, 0b0110 | 0b1001)
    }

    /// The sheet around a crossing of three planes that contains the quarter of plane `r` beside an octant (bit `r` of
    /// the octant is 0). Sheets are named by the least number of their quarters.
    ///
    /// Each plane is divided into four quarters by the other two, and the crossing lines into half-lines. A sheet is a
    /// connected set of quarters that are boundary. Two quarters at a half-line are connected if they are the only
    /// ones there, or, if there are four, if they bound the same solid wedge.
    fn sheet(self, r: usize, octant: usize) -> u32 {
        let number = |r: usize, octant: usize| (8 * r + octant) as u32;
        let is_boundary = |r: usize, octant: usize| self.at(octant) != self.at(octant | 1 << r);
        let mut least = number(r, octant);
        let mut visited = 1_u32 << least;
        let mut pending = vec![(r, octant)];
        while let Some((r, octant)) = pending.pop() {
            least = least.min(number(r, octant));
            // The two half-lines at the rim of the quarter: each on plane t and on one side of plane s. The
            // candidates are the other three quarters there: one on the same plane, two on plane t.
            // As seen along the half-line:
            //
            //        (t, r positive)
            //               |
            //    (r, ..) --- --- (r, octant)      the candidates are the other three
            //               |
            //        (t, r negative)
            for (s, t) in [((r + 1) % 3, (r + 2) % 3), ((r + 2) % 3, (r + 1) % 3)] {
                let fixed = octant & 1 << s;
                let candidates =
                    [(r, (fixed | !octant & 1 << t) & !(1 << r)), (t, fixed), (t, fixed | 1 << r)];
                let n_boundary = candidates.iter().filter(|(r, octant)| is_boundary(*r, *octant)).count();
                let solid = if self.at(octant) { octant } else { octant | 1 << r };
                for (r, octant) in candidates.into_iter().filter(|(r, octant)| is_boundary(*r, *octant)) {
                    // Membership changes an even number of times around the half-line, so one or three of the
                    // others are boundary. If three are, two opposite wedges are solid, and the sheet goes on
                    // with the quarter on t that bounds the same wedge.
                    let is_next = n_boundary == 1 || r == t && (octant == solid || octant | 1 << t == solid);
                    let bit = 1 << number(r, octant);
                    if is_next && visited & bit == 0 {
                        visited |= bit;
                        pending.push((r, octant));
                    }
                }
            }
        }
        least
    }
}

/// The corners of a tetrahedron that lie on all of the facets: those that are opposite none of them.
fn other_corners<const F: usize, const N: usize>(facets: [u8; F]) -> [usize; N] {
    let mut corners = (0..4).filter(|k| !facets.contains(&(*k as u8)));
    std::array::from_fn(|_| corners.next().expect("facets differ"))
}

/// The sign of a quotient of determinants.
fn divided_sign(sign: Ordering, denominator: Ordering) -> Ordering {
    if denominator == Ordering::Less { sign.reverse() } else { sign }
}

/// The loops around pieces of one plane: a list of loops for each connected component.
///
/// ```text
///    ---->---+----->---      An edge between two pieces occurs in both, in opposite directions (twins).
///   |   P    |    Q    |     A loop follows edges without a twin. Where the next edge has one, it goes on
///   |        | ^       |     with the edge after the twin, until it comes to an edge without a twin.
///    ----<---+-----<---
/// ```
fn merge_faces(pieces: &[Vec<ArrangementCorner>]) -> Vec<Vec<Vec<ArrangementCorner>>> {
    if let [] | [_] = pieces {
        return pieces.iter().map(|ring| vec![ring.clone()]).collect();
    }
    let mut edges: Vec<(ArrangementCorner, ArrangementCorner, u32, u32)> = Vec::new();
    for (number, ring) in pieces.iter().enumerate() {
        for t in 0..ring.len() {
            edges.push((ring[t], ring[(t + 1) % ring.len()], number as u32, t as u32));
        }
    }
    edges.sort_unstable();
    let find = |a: &ArrangementCorner, b: &ArrangementCorner| {
        edges.binary_search_by(|edge| (edge.0, edge.1).cmp(&(*a, *b))).ok()
    };
    // The edge in the opposite direction, in the piece on its other side.
    let twin: Vec<Option<usize>> = edges.iter().map(|(a, b, ..)| find(b, a)).collect();
    let index = |piece: u32, t: u32| {
        let ring = &pieces[piece as usize];
        let t = t as usize % ring.len();
        find(&ring[t], &ring[(t + 1) % ring.len()]).expect("it is one of the edges")
    };
    let mut parents: Vec<usize> = (0..pieces.len()).collect();
    let root = |parents: &[usize], mut k: usize| {
        while parents[k] != k {
            k = parents[k];
        }
        k
    };
    for (edge, twin) in edges.iter().zip(&twin) {
        if let Some(twin) = twin {
            let (a, b) = (root(&parents, edge.2 as usize), root(&parents, edges[*twin].2 as usize));
            // The least piece becomes the root, so that the components are in the order of their first
            // pieces.
            parents[a.max(b)] = a.min(b);
        }
    }
    let mut loops: Vec<Vec<Vec<ArrangementCorner>>> = vec![Vec::new(); pieces.len()];
    let mut is_done = vec![false; edges.len()];
    for (piece, ring) in pieces.iter().enumerate() {
        for t in 0..ring.len() {
            let start = index(piece as u32, t as u32);
            if is_done[start] || twin[start].is_some() {
                continue;
            }
            let mut corners = Vec::new();
            let mut edge = start;
            loop {
                is_done[edge] = true;
                corners.push(edges[edge].0);
                let (_, _, piece, t) = edges[edge];
                edge = index(piece, t + 1);
                while let Some(across) = twin[edge] {
                    let (_, _, piece, t) = edges[across];
                    edge = index(piece, t + 1);
                }
                if edge == start {
                    break;
                }
            }
            loops[root(&parents, piece)].push(corners);
        }
    }
    loops.retain(|group| !group.is_empty());
    loops
}

/// By the set of negative corners (bit `k` for corner `k`): the facets of the section's sides, in order, 4
/// for none. The tetrahedron is (0, x, y, z), and the section is counter-clockwise as seen from the side on which the
/// function is positive.
const SECTIONS: [[u8; 4]; 16] = sections();

const fn sections() -> [[u8; 4]; 16] {
    // Even permutations of the corners, by their first corner.
    const FIRST: [[u8; 4]; 4] = [[0, 1, 2, 3], [1, 0, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0]];
    // Even permutations by their first two corners.
    const TWO: [[u8; 4]; 6] =
        [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 2, 0], [2, 3, 0, 1]];
    let mut table = [[4; 4]; 16];
    let mut k = 0;
    // Even permutations keep the orientation, so that one case gives the others by renaming corners.
    while k < 4 {
        let [v, a, b, c] = FIRST[k];
        // Corners on va, vb, vc: the side between va and vb is on the facet opposite c.
        table[1 << v] = [c, a, b, 4];
        // The complement has the same section, as seen from its other side.
        table[15 - (1 << v)] = [b, a, c, 4];
        k += 1;
    }
    k = 0;
    while k < 6 {
        // Corners on ac, ad, bd, bc.
        let [a, b, c, d] = TWO[k];
        table[1 << a | 1 << b] = [b, c, a, d];
        k += 1;
    }
    table
}
