//! Blocks: as many values as fit well into the first-level cache, one row per component, for vectorized code.
use super::dual::{Dual, each_axis};
use super::inputs::LeafScalar;
use super::number::TapeInterval;
use crate::math::{BareInterval, Interval, lesser};

/// A number type that is stored in blocks.
pub(super) trait BlockScalar: LeafScalar + 'static {
    /// Storage for the components of [`BlockScalar::LANES`] numbers.
    type Block: Clone + 'static;
    /// The number of values in a block.
    const LANES: usize;
    /// Whether it carries a decoration, which operations may clear.
    const CLAIMS: bool;
    /// Whether constants are written into the loops themselves; otherwise they are first copied to a block,
    /// which keeps the program small.
    const IMMEDIATE: bool;

    fn block() -> Self::Block;
    fn load(block: &Self::Block, at: usize) -> Self;
    fn store(self, block: &mut Self::Block, at: usize);

    /// Its decoration: the bits of [`DEFINED`] and [`SOME`], with all other bits set.
    #[inline(always)]
    fn decoration(self) -> u64 {
        u64::MAX
    }

    /// The same number with the decoration that remains after all operations; NaN gets the same bits
    /// everywhere.
    fn with_decoration(self, claims: u64) -> Self;
}

/// The size of the largest block of numbers with decorations.
pub(super) const MOST_CLAIMS: usize = 128;

/// Decoration bit: every operation so far was defined and continuous.
pub(super) const DEFINED: u64 = 1;
/// Decoration bit: no interval so far was empty.
pub(super) const SOME: u64 = 2;

/// The decorations of a block's numbers.
pub(super) type Decorations = [u64; MOST_CLAIMS];

impl BlockScalar for f32 {
    type Block = [f32; 512];
    const LANES: usize = 512;
    const CLAIMS: bool = false;
    const IMMEDIATE: bool = true;

    fn block() -> Self::Block {
        [0.0; 512]
    }
    #[inline(always)]
    fn load(block: &Self::Block, at: usize) -> Self {
        block[at]
    }
    #[inline(always)]
    fn store(self, block: &mut Self::Block, at: usize) {
        block[at] = self;
    }
    #[inline(always)]
    fn with_decoration(self, _: u64) -> Self {
        Self::from_bits(if self.is_nan() { Self::NAN.to_bits() } else { self.to_bits() })
    }
}

impl BlockScalar for f64 {
    type Block = [f64; 256];
    const LANES: usize = 256;
    const CLAIMS: bool = false;
    const IMMEDIATE: bool = true;

    fn block() -> Self::Block {
        [0.0; 256]
    }
    #[inline(always)]
    fn load(block: &Self::Block, at: usize) -> Self {
        block[at]
    }
    #[inline(always)]
    fn store(self, block: &mut Self::Block, at: usize) {
        block[at] = self;
    }
    #[inline(always)]
    fn with_decoration(self, _: u64) -> Self {
        Self::from_bits(if self.is_nan() { Self::NAN.to_bits() } else { self.to_bits() })
    }
}

impl BlockScalar for Dual<f64> {
    type Block = [[f64; 128]; 4];
    const LANES: usize = 128;
    const CLAIMS: bool = false;
    const IMMEDIATE: bool = false;

    fn block() -> Self::Block {
        [[0.0; 128]; 4]
    }
    #[inline(always)]
    fn load(block: &Self::Block, at: usize) -> Self {
        Self { value: block[0][at], gradient: [block[1][at], block[2][at], block[3][at]] }
    }
    #[inline(always)]
    fn store(self, block: &mut Self::Block, at: usize) {
        block[0][at] = self.value;
        block[1][at] = self.gradient[0];
        block[2][at] = self.gradient[1];
        block[3][at] = self.gradient[2];
    }
    #[inline(always)]
    fn with_decoration(self, claims: u64) -> Self {
        Self {
            value: self.value.with_decoration(claims),
            gradient: self.gradient.map(|d| d.with_decoration(claims)),
        }
    }
}

impl BlockScalar for TapeInterval {
    type Block = [[f64; 128]; 2];
    const LANES: usize = 128;
    const CLAIMS: bool = true;
    const IMMEDIATE: bool = true;

    fn block() -> Self::Block {
        [[0.0; 128]; 2]
    }
    #[inline(always)]
    fn load(block: &Self::Block, at: usize) -> Self {
        Self { ends: BareInterval { lo: block[0][at], hi: block[1][at] }, defined: true, some: true }
    }
    #[inline(always)]
    fn store(self, block: &mut Self::Block, at: usize) {
        block[0][at] = self.ends.lo;
        block[1][at] = self.ends.hi;
    }
    #[inline(always)]
    fn decoration(self) -> u64 {
        (if self.defined { u64::MAX } else { !DEFINED }) & (if self.some { u64::MAX } else { !SOME })
    }
    #[inline(always)]
    fn with_decoration(self, claims: u64) -> Self {
        Self { defined: claims & DEFINED != 0, some: claims & SOME != 0, ..self }
    }
}

impl BlockScalar for Dual<Interval> {
    type Block = [[f64; 64]; 8];
    const LANES: usize = 64;
    const CLAIMS: bool = true;
    const IMMEDIATE: bool = false;

    fn block() -> Self::Block {
        [[0.0; 64]; 8]
    }
    #[inline(always)]
    fn load(block: &Self::Block, at: usize) -> Self {
        let value = Interval::from_endpoints(block[0][at], block[1][at]);
        Self {
            value,
            gradient: each_axis!(k => Interval::from_endpoints(block[2 * k + 2][at], block[2 * k + 3][at])),
        }
    }
    #[inline(always)]
    fn store(self, block: &mut Self::Block, at: usize) {
        put_ends(self.value, block, 0, at);
        put_ends(self.gradient[0], block, 2, at);
        put_ends(self.gradient[1], block, 4, at);
        put_ends(self.gradient[2], block, 6, at);
    }
    #[inline(always)]
    fn decoration(self) -> u64 {
        if self.value.is_defined() { u64::MAX } else { !DEFINED }
    }
    #[inline(always)]
    fn with_decoration(self, claims: u64) -> Self {
        if claims & DEFINED != 0 {
            return self;
        }
        Self { value: self.value.undefined(), gradient: self.gradient.map(Interval::undefined) }
    }
}

/// Stores the ends of an interval in the rows `row` and `row + 1`.
#[inline(always)]
fn put_ends(range: Interval, block: &mut [[f64; 64]; 8], row: usize, at: usize) {
    block[row][at] = range.lo();
    block[row + 1][at] = range.hi();
}

/// Stores a value, and clears the decoration bits that it lacks.
#[inline(always)]
pub(super) fn put<N: BlockScalar>(value: N, out: &mut N::Block, claims: &mut Decorations, at: usize) {
    value.store(out, at);
    if N::CLAIMS {
        claims[at] &= value.decoration();
    }
}

/// Whether the sines of the first `n` numbers need no argument reduction in integers.
#[inline(always)]
pub(super) fn all_near<N: BlockScalar>(n: usize, a: &N::Block) -> bool {
    let mut near = true;
    for at in 0..at_most::<N>(n) {
        near &= N::is_near(N::load(a, at));
    }
    near
}

/// `n`, at most the block size, which the compiler then knows.
#[inline(always)]
pub(super) fn at_most<N: BlockScalar>(n: usize) -> usize {
    lesser(n, N::LANES)
}
