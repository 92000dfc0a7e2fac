//! How much the tests of the command try. `make test` stays below ten seconds of one core in every test;
//! `make test-long` sets `CHORDAL_LONG=1`, and takes what is slower.

/// Whether the long sweep was asked for.
pub fn is_long() -> bool {
    std::env::var_os("CHORDAL_LONG").is_some_and(|value| value == "1")
}
