//! How much a sweep tries. `make test` stays below ten seconds of one core in every test; `make test-long`
//! sets `CHORDAL_LONG=1`, and takes ten times as many random cases and all of what is otherwise sampled.

/// Whether the long sweep was asked for.
pub fn is_long() -> bool {
    std::env::var_os("CHORDAL_LONG").is_some_and(|value| value == "1")
}

/// So many cases, or ten times as many in the long sweep.
pub fn cases(n: usize) -> usize {
    if is_long() { 10 * n } else { n }
}
