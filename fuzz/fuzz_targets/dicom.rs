//! Any bytes as two slices of a series, and as a file of many frames: a volume or a typed error, no panic.
#![no_main]
use chordal_io::{Format, Limits, dicom, read, read_with};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let (first, second) = bytes.split_at(bytes.len() / 2);
    let list = dicom::slice_list(["a", "b"]);
    let mut open = |path: &str| Ok(if path == "a" { first.to_vec() } else { second.to_vec() });
    let _ = read_with(&list, Format::Dicom, &mut open, &Limits::default());
    let _ = read(bytes, Format::Dicom, &Limits::default());
});
