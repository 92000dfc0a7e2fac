//! `Real`: the types of values at the vertices of a cage, in single or double precision.
use std::fmt::Debug;
use std::ops::{Add, Mul};

/// A number that refinement can average: f32 or f64.
pub trait Real:
    Copy + Debug + Default + PartialOrd + Send + Sync + Add<Output = Self> + Mul<Output = Self> + sealed::Sealed
{
    /// A weight, rounded.
    #[doc(hidden)]
    fn from_f64(weight: f64) -> Self;
    /// The same number.
    #[doc(hidden)]
    fn to_f64(self) -> f64;
    /// Whether neither it nor a sum of the largest possible number of such values can overflow.
    #[doc(hidden)]
    fn is_safe_to_sum(self) -> bool;
    /// Whether it is neither NaN nor infinite.
    #[doc(hidden)]
    fn is_finite(self) -> bool;
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A fraction of the largest number. Derived: a vertex has fewer than 2^31 neighbours; with a margin.
const CALM: f64 = 1.0 / (1_u64 << 40) as f64;

macro_rules! real {
    ($($T:ty),*) => {$(
        impl Real for $T {
            #[inline(always)]
            fn from_f64(weight: f64) -> Self {
                weight as Self
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn is_safe_to_sum(self) -> bool {
                self.abs() < Self::MAX * CALM as Self
            }

            #[inline(always)]
            fn is_finite(self) -> bool {
                self.is_finite()
            }
        }
    )*};
}
real!(f32, f64);

/// `sum` plus a multiple of `p`.
#[inline(always)]
pub(super) fn add<T: Real, const K: usize>(sum: [T; K], share: T, p: [T; K]) -> [T; K] {
    std::array::from_fn(|k| sum[k] + share * p[k])
}

#[inline(always)]
pub(super) fn scaled<T: Real, const K: usize>(share: T, p: [T; K]) -> [T; K] {
    p.map(|x| share * x)
}

/// A sum of any number of terms, in f64 also for f32: around a pole of hundreds of faces, roundings in f32
/// would add up to 2e-5.
#[derive(Clone, Copy)]
pub(super) struct WideSum<const K: usize>(pub [f64; K]);

impl<const K: usize> WideSum<K> {
    pub const ZERO: Self = Self([0.0; K]);

    #[inline(always)]
    pub fn plus<T: Real>(self, share: f64, p: [T; K]) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + share * p[k].to_f64()))
    }

    /// The sum, rounded.
    #[inline(always)]
    pub fn value<T: Real>(self) -> [T; K] {
        self.0.map(T::from_f64)
    }
}

/// The mean of two points.
#[inline(always)]
pub(super) fn mid<T: Real, const K: usize>(a: [T; K], b: [T; K]) -> [T; K] {
    let half = T::from_f64(0.5);
    std::array::from_fn(|k| half * (a[k] + b[k]))
}

/// Chunks of `size` items each (the last may be shorter), with the index of the first.
pub(super) fn chunks<T>(items: &mut [T], size: usize) -> Vec<(usize, &mut [T])> {
    items.chunks_mut(size).enumerate().map(|(k, part)| (k * size, part)).collect()
}
