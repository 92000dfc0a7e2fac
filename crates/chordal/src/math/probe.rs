//! A probe of the floating-point environment.
use std::hint::black_box;

/// Whether this thread replaces subnormal numbers by 0, in operands or in results.
///
/// Outward rounding needs subnormals: the neighbours of a result next to 0 are subnormal. Some libraries
/// loaded into the same process switch the processor to flushing them (FTZ and DAZ on x86-64, FZ on ARM);
/// then nothing is proved, and a job must refuse. The setting is per thread: probe on the thread that
/// computes.
///
/// A changed rounding *direction* needs no probe: in every mode the exact value lies between the neighbours
/// of the rounded one.
///
/// ```
/// assert!(!chordal::math::flushes_subnormals());
/// ```
#[must_use]
pub fn flushes_subnormals() -> bool {
    // `black_box` keeps the compiler from computing these at build time, where nothing is flushed.
    let smallest = f64::from_bits(1);
    // A normal operand with a subnormal result, then a subnormal operand with a normal result.
    let flushes_result = black_box(f64::MIN_POSITIVE) * black_box(0.5) == 0.0;
    let flushes_operand = black_box(smallest) * black_box(f64::MAX) == 0.0;
    // The neighbour of 0 must compare as different from 0.
    let merges_with_zero = black_box(smallest) == black_box(0.0);
    flushes_result || flushes_operand || merges_with_zero
}
