//! How much a sweep tries. `make test` aims at some seconds of one core in a test; `make test-long` sets
//! `CHORDAL_LONG=1`, and takes twenty times as many random cases and all of what is otherwise sampled.

/// Whether the long sweep was asked for.
pub fn is_long() -> bool {
    std::env::var_os("CHORDAL_LONG").is_some_and(|value| value == "1")
}

/// An even share of a list, so many of its items; all of them in the long sweep.
pub fn some<T>(all: impl IntoIterator<Item = T>, most: usize) -> Vec<T> {
    let all: Vec<T> = all.into_iter().collect();
    let step = if is_long() { 1 } else { all.len().div_ceil(most).max(1) };
    all.into_iter().step_by(step).collect()
}

/// Half of so many cases, or ten times as many in the long sweep.
pub fn cases(n: usize) -> usize {
    if is_long() { 10 * n } else { n.div_ceil(2) }
}
