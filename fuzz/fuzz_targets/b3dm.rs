//! Any bytes as B3dm: a shape or a typed error, no panic.
#![no_main]
use chordal_io::{Format, Limits, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = read(bytes, Format::B3dm, &Limits::default());
});
