//! Any bytes as a gzipped file of the format that its content looks like: a shape or a typed error, no panic.
#![no_main]
use chordal_io::{Format, Limits, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let packed = [b"\x1f\x8b", bytes].concat();
    let format = Format::sniff(&packed).unwrap_or(Format::Nii);
    let _ = read(&packed, format, &Limits { bytes: 1 << 28, ..Limits::default() });
});
