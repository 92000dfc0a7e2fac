//! Any bytes as a font that sets a text: letters or a typed error, no panic.
#![no_main]
use chordal_io::Limits;
use chordal_io::font::{Letters, read_letters};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let letters = Letters { axes: vec![("wght".to_owned(), 700.0)], ..Letters::new("AVATAR fi\nO") };
    let _ = read_letters(bytes, &letters, &Limits::default());
    let _ = read_letters(bytes, &Letters::new("AV ß"), &Limits::default());
});
