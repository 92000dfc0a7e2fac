//! The `chordal` command: translates arguments into verbs.
fn main() {}
