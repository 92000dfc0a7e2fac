//! A probe of the floating-point environment.
use std::hint::black_box;

/// Whether this thread replaces subnormal numbers by 0, in operands or in results.
///
/// Outward rounding rests on subnormals: next to 0 the neighbour of a result is one. Some libraries loaded into the
/// same process switch the processor to flushing them (FTZ and DAZ on x86-64, FZ on ARM); then nothing is proved, and
/// a job has to refuse. The setting belongs to a thread: probe on the one that computes.
///
/// A changed rounding *direction* needs no probe: whatever it is, the exact value lies between the neighbours of
/// the rounded one.
///
/// ```
/// assert!(!chordal::math::flushes_subnormals());
/// ```
#[must_use]
pub fn flushes_subnormals() -> bool {
    let smallest = f64::from_bits(1);
    // A normal operand with a subnormal result, then a subnormal operand with a normal result.
    let flushes_result = black_box(f64::MIN_POSITIVE) * black_box(0.5) == 0.0;
    let flushes_operand = black_box(smallest) * black_box(f64::MAX) == 0.0;
    // Sums and comparisons: the neighbour of 0 must stay apart from it.
    // The neighbour of 0 must stay apart from it in comparisons, too.
    let merges_with_zero = black_box(smallest) == black_box(0.0);
    flushes_result || flushes_operand || merges_with_zero
}
