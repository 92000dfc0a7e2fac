//! Any bytes without a name: what they look like, and the reader of that.
#![no_main]
use chordal_io::{Format, Limits, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Some(format) = Format::sniff(bytes) {
        let _ = read(bytes, format, &Limits { drop_nonfinite: true, ..Limits::default() });
    }
});
