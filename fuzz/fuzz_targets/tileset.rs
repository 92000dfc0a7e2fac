//! Any bytes as a tileset; all that it names holds what stands behind its first zero byte: a tree or a typed error,
//! no panic.
#![no_main]
use chordal_io::{Limits, tiles};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let (tileset, other) = bytes.split_at(bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len()));
    let mut open = |_: &str| Ok(other.to_vec());
    let _ = tiles::read(tileset, &mut open, &Limits::default());
});
