//! The size of sweeps. `make test` aims at some seconds of one core for a test; `make test-long` sets
//! `CHORDAL_LONG=1`, which takes twenty times as many random cases and all items of lists that are otherwise
//! sampled.

/// Whether the long sweep is requested.
pub fn is_long() -> bool {
    std::env::var_os("CHORDAL_LONG").is_some_and(|value| value == "1")
}

/// At most `most` items of a list, evenly spread; all items in the long sweep.
pub fn some<T>(items: impl IntoIterator<Item = T>, most: usize) -> Vec<T> {
    let items: Vec<T> = items.into_iter().collect();
    let step = if is_long() { 1 } else { items.len().div_ceil(most).max(1) };
    items.into_iter().step_by(step).collect()
}

/// Half of `n` cases, or ten times `n` in the long sweep.
pub fn cases(n: usize) -> usize {
    if is_long() { 10 * n } else { n.div_ceil(2) }
}
