//! Any bytes as Npz: a shape or a typed error, no panic.
#![no_main]
use chordal_io::{Format, Limits, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = read(
        bytes,
        Format::Npz,
        &Limits { index: bytes.first().map(|b| u64::from(b % 3)), ..Limits::default() },
    );
});
