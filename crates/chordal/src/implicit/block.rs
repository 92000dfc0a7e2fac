//! Blocks: as many values as fit well into the first cache, each component in a row of its own, so that loops over them
//! become vector code.
use super::number::Range;
use super::slope::{Slope, each_axis};
use super::sources::Source;
use crate::math::{Ends, Interval};

/// A number of which blocks are made.
pub(super) trait Lane: Source + 'static {
    /// Where its components are kept, for [`Lane::LANES`] numbers.
    type Block: Clone + 'static;
    /// How many numbers a block has.
    const LANES: usize;
    /// Whether it claims to be defined, and so may lose that claim.
    const CLAIMS: bool;
    /// Whether constants are put into the loops themselves; else into a block first, which keeps the program small.
    const IMMEDIATE: bool;

    fn block() -> Self::Block;
    fn load(block: &Self::Block, at: usize) -> Self;
    fn store(self, block: &mut Self::Block, at: usize);

    /// What it claims: the bits of [`DEFINED`] and [`SOME`], and all others.
    #[inline(always)]
    fn claims(self) -> u64 {
        u64::MAX
    }

    /// The same with the claims that are left after all operations; NaN gets the same bits everywhere.
    fn settled(self, claims: u64) -> Self;
}

/// The most numbers that a block has which makes claims.
pub(super) const MOST_CLAIMS: usize = 128;

/// The claim that everything before was defined and continuous.
pub(super) const DEFINED: u64 = 1;
/// The claim that no range before was empty.
pub(super) const SOME: u64 = 2;

/// What is left of the claims of a block's numbers.
pub(super) type Claims = [u64; MOST_CLAIMS];

impl Lane for f32 {
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
    fn settled(self, _: u64) -> Self {
        Self::from_bits(if self.is_nan() { Self::NAN.to_bits() } else { self.to_bits() })
    }
}

impl Lane for f64 {
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
    fn settled(self, _: u64) -> Self {
        Self::from_bits(if self.is_nan() { Self::NAN.to_bits() } else { self.to_bits() })
    }
}

impl Lane for Slope<f64> {
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
    fn settled(self, claims: u64) -> Self {
        Self { value: self.value.settled(claims), gradient: self.gradient.map(|d| d.settled(claims)) }
    }
}

impl Lane for Range {
    type Block = [[f64; 128]; 2];
    const LANES: usize = 128;
    const CLAIMS: bool = true;
    const IMMEDIATE: bool = true;

    fn block() -> Self::Block {
        [[0.0; 128]; 2]
    }
    #[inline(always)]
    fn load(block: &Self::Block, at: usize) -> Self {
        Self { ends: Ends { lo: block[0][at], hi: block[1][at] }, defined: true, some: true }
    }
    #[inline(always)]
    fn store(self, block: &mut Self::Block, at: usize) {
        block[0][at] = self.ends.lo;
        block[1][at] = self.ends.hi;
    }
    #[inline(always)]
    fn claims(self) -> u64 {
        (if self.defined { u64::MAX } else { !DEFINED }) & (if self.some { u64::MAX } else { !SOME })
    }
    #[inline(always)]
    fn settled(self, claims: u64) -> Self {
        Self { defined: claims & DEFINED != 0, some: claims & SOME != 0, ..self }
    }
}

impl Lane for Slope<Interval> {
    type Block = [[f64; 64]; 8];
    const LANES: usize = 64;
    const CLAIMS: bool = true;
    const IMMEDIATE: bool = false;

    fn block() -> Self::Block {
        [[0.0; 64]; 8]
    }
    #[inline(always)]
    fn load(block: &Self::Block, at: usize) -> Self {
        let value = Interval::from_parts(block[0][at], block[1][at]);
        Self {
            value,
            gradient: each_axis!(k => Interval::from_parts(block[2 * k + 2][at], block[2 * k + 3][at])),
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
    fn claims(self) -> u64 {
        if self.value.is_defined() { u64::MAX } else { !DEFINED }
    }
    #[inline(always)]
    fn settled(self, claims: u64) -> Self {
        if claims & DEFINED != 0 {
            return self;
        }
        Self { value: self.value.undefined(), gradient: self.gradient.map(Interval::undefined) }
    }
}

/// Puts the ends of a range into the rows `row` and `row + 1`.
#[inline(always)]
fn put_ends(range: Interval, block: &mut [[f64; 64]; 8], row: usize, at: usize) {
    block[row][at] = range.lo();
    block[row + 1][at] = range.hi();
}

/// Stores a value, and what that leaves of its claim.
#[inline(always)]
pub(super) fn put<N: Lane>(value: N, out: &mut N::Block, claims: &mut Claims, at: usize) {
    value.store(out, at);
    if N::CLAIMS {
        claims[at] &= value.claims();
    }
}

/// Whether all of the first `n` are where sines need no reduction by integers.
#[inline(always)]
pub(super) fn all_near<N: Lane>(n: usize, a: &N::Block) -> bool {
    let mut all = true;
    for at in 0..at_most::<N>(n) {
        all &= N::is_near(N::load(a, at));
    }
    all
}

/// `n`, known to be no more than a block has.
#[inline(always)]
pub(super) fn at_most<N: Lane>(n: usize) -> usize {
    if n < N::LANES { n } else { N::LANES }
}
