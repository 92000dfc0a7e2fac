//! Levels of terms: zero sets of primitives that differ only by operations with constants.
use super::affine_terms::PlaneFamily;
use crate::math::{exponent, greater, power_of_two};
use std::collections::BTreeMap;

/// An operation of a term with a constant; its result increases or decreases with the term.
#[derive(Clone, Copy, Debug)]
pub(super) enum MonotoneOp {
    Neg,
    Add(f64),
    /// `constant − a`.
    From(f64),
    Mul(f64),
    Div(f64),
}

impl MonotoneOp {
    pub fn falls(self) -> bool {
        match self {
            Self::Neg | Self::From(_) => true,
            Self::Add(_) => false,
            Self::Mul(k) | Self::Div(k) => k < 0.0,
        }
    }
}

/// A function that levels are compared by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum LevelFunction {
    Term(u32),
    /// A linear function, by the number of its gradient.
    Planes(u32),
}

/// The zero set of a primitive, as a level set of a term of the full expression.
#[derive(Clone, Copy, Debug)]
pub(super) struct LevelSet {
    base: LevelFunction,
    at: f64,
    /// The largest number in its computation.
    size: f64,
    /// Whether nothing was rounded.
    is_exact: bool,
    /// Whether the primitive decreases as the term increases.
    falls: bool,
}

/// Two parallel planes that differ by at most this fraction of their sizes are treated as one. Chosen: 16
/// roundings, as many as a script's additions make, and far less than any length that coordinates can
/// express. For other terms a small difference of values may be a large distance.
const WELD: f64 = 16.0 * f64::EPSILON;
/// Two levels that differ by more than this fraction of their sizes also differ without rounding. Derived: a
/// chain of thousands of roundings is off by less than 2⁻⁴⁰ of them.
const CLEAR: f64 = 1.0 / (1_u64 << 40) as f64;
/// The most operations with constants above a base; the rounding of longer chains is not accounted for.
const MOST_ROUNDINGS: usize = 1024;

/// A term and one of its levels, in a total order.
type LevelKey = (LevelFunction, i64);

/// An integer that orders like the number, for all finite numbers.
fn order_key(at: f64) -> i64 {
    let bits = at.to_bits().cast_signed();
    // The bits of negative numbers grow with their size, so all bits but the sign are inverted.
    bits ^ ((bits >> 63).cast_unsigned() >> 1).cast_signed()
}

impl LevelSet {
    /// The zero set of a chain of operations above a term, as a level of the term.
    pub fn from_chain(base: u32, ops: &[MonotoneOp]) -> Option<Self> {
        // The chain applied to `base` is `scale · base + offset`. In an exact chain the scale is a power of 2
        // or its negative.
        let mut shift = ScaleOffset { scale: 1.0, offset: 0.0, size: 0.0, is_exact: true, is_lost: false };
        ops.iter().for_each(|op| shift.apply(*op));
        let ScaleOffset { scale, offset, size, is_exact, is_lost } = shift;
        // −0 and 0 are one level.
        let at = -offset / scale + 0.0;
        let is_sound = !is_lost
            && at.is_finite()
            && size.is_finite()
            && scale.is_normal()
            && (at.is_normal() || offset == 0.0)
            && ops.len() <= MOST_ROUNDINGS;
        is_sound.then_some(LevelSet {
            base: LevelFunction::Term(base),
            at,
            size,
            is_exact,
            falls: scale < 0.0,
        })
    }

    /// The same level, as one of the linear function that differs from its term only by an offset.
    pub fn on_planes(self, planes: &PlaneFamily) -> Self {
        let at = if planes.is_opposite { 0.0 - self.at } else { self.at };
        Self {
            base: LevelFunction::Planes(planes.number),
            at: at - planes.offset + 0.0,
            size: greater(planes.size, self.size),
            is_exact: self.is_exact && planes.size == 0.0,
            falls: self.falls != planes.is_opposite,
        }
    }

    pub fn is_plane_along(&self, other: &Self) -> bool {
        self.base == other.base && matches!(self.base, LevelFunction::Planes(_))
    }

    pub fn function(&self) -> LevelFunction {
        self.base
    }

    /// The value of the function.
    pub fn height(&self) -> f64 {
        self.at
    }

    pub fn falls(&self) -> bool {
        self.falls
    }

    fn gap(&self, other: &Self) -> f64 {
        (self.at - other.at).abs()
    }

    /// Whether the two never meet, since they are two different levels of one function.
    pub fn is_parallel_to(&self, other: &Self) -> bool {
        // Levels are off by some roundings of their sizes, one per operation: far less than this fraction.
        let clear = CLEAR * (self.size + other.size);
        let is_apart =
            if self.is_exact && other.is_exact { self.at != other.at } else { self.gap(other) > clear };
        self.base == other.base && is_apart
    }
}

/// A chain of operations applied to a term `t`: `scale · t + offset`.
struct ScaleOffset {
    scale: f64,
    offset: f64,
    /// The largest offset so far, divided by the scale.
    size: f64,
    is_exact: bool,
    /// Whether digits were lost to underflow, and the level with them.
    is_lost: bool,
}

impl ScaleOffset {
    fn apply(&mut self, op: MonotoneOp) {
        match op {
            MonotoneOp::Neg => (self.scale, self.offset) = (-self.scale, -self.offset),
            MonotoneOp::Add(k) => self.add(k),
            MonotoneOp::From(k) => {
                (self.scale, self.offset) = (-self.scale, -self.offset);
                self.add(k);
            }
            MonotoneOp::Mul(k) => {
                self.scale_by(self.scale * k, self.offset * k);
                self.is_exact &= is_power_of_two(k);
            }
            MonotoneOp::Div(k) => {
                self.scale_by(self.scale / k, self.offset / k);
                self.is_exact &= is_power_of_two(k);
            }
        }
        // The largest size of the level on the way; NaN counts as larger.
        let size = (self.offset / self.scale).abs();
        self.size = if size > self.size || size.is_nan() { size } else { self.size };
    }

    fn scale_by(&mut self, scale: f64, offset: f64) {
        // Subnormal numbers lose digits, and with them the level.
        if !(offset.is_normal() || self.offset == 0.0) {
            self.is_lost = true;
        }
        (self.scale, self.offset) = (scale, offset);
    }

    fn add(&mut self, k: f64) {
        let sum = self.offset + k;
        // The exact error of the sum (Knuth's two-sum).
        let part = sum - self.offset;
        self.is_exact &= (self.offset - (sum - part)) + (k - part) == 0.0;
        let size = (k / self.scale).abs();
        self.size = if size > self.size || size.is_nan() { size } else { self.size };
        self.offset = sum;
    }
}

fn is_power_of_two(k: f64) -> bool {
    power_of_two(exponent(k.abs()) - 1) == k.abs()
}

/// The levels of the primitives so far.
#[derive(Debug, Default)]
pub(super) struct LevelTable {
    levels: BTreeMap<LevelKey, (LevelSet, u32)>,
}

impl LevelTable {
    pub fn insert(&mut self, level: LevelSet, primitive: u32) {
        self.levels.insert((level.base, order_key(level.at)), (level, primitive));
    }

    /// The primitive of the same level, or, for planes, of one that differs from it only by rounding.
    pub fn same(&self, level: &LevelSet) -> Option<SameLevel> {
        let key = (level.base, order_key(level.at));
        // If some known level is near enough, so is the next one on its side.
        let next = self.levels.range(key..).next();
        let last = self.levels.range(..key).next_back();
        let is_same = |known: &LevelSet| {
            let is_equal = known.is_exact && level.is_exact && known.at == level.at;
            let is_welded =
                level.is_plane_along(known) && level.gap(known) <= WELD * (known.size + level.size);
            known.base == level.base && (is_equal || is_welded)
        };
        let same = [next, last].into_iter().flatten().find(|(_, (known, _))| is_same(known));
        same.map(|(_, (known, primitive))| SameLevel {
            primitive: *primitive,
            is_opposite: known.falls != level.falls,
            // A rounded level is off by much less than this fraction of its size.
            off: level.gap(known)
                + if known.is_exact && level.is_exact { 0.0 } else { CLEAR * (known.size + level.size) },
        })
    }
}

/// A primitive with the level of another.
#[derive(Clone, Copy, Debug)]
pub(super) struct SameLevel {
    pub primitive: u32,
    /// Whether one of them falls as the other rises.
    pub is_opposite: bool,
    /// The largest difference of the two levels, up to rounding.
    pub off: f64,
}
