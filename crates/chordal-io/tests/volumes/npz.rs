//! `.npz`: arrays in a zip container, stored and deflated.
use super::build::npy;
use super::{load, load_with, values};
use crate::common::{count, refuse};
use chordal_io::{Format, Limits, read};
use std::io::Write;

/// A zip container of entries, each with its method: 0 for stored, 8 for deflated.
fn zip(entries: &[(&str, u16, &[u8])]) -> Vec<u8> {
    let (mut file, mut rows) = (Vec::new(), Vec::new());
    for (name, method, content) in entries {
        let mut crc = flate2::Crc::new();
        crc.update(content);
        let mut encoder = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(content).unwrap();
        let packed = if *method == 0 { content.to_vec() } else { encoder.finish().unwrap() };
        let mut common = [20_u16, 0, *method, 0, 0].map(u16::to_le_bytes).concat();
        let sizes = [crc.sum(), packed.len() as u32, content.len() as u32].map(u32::to_le_bytes).concat();
        common.extend(sizes);
        common.extend((name.len() as u16).to_le_bytes());
        rows.extend([b"PK\x01\x02\x14\0", &common[..], &[0; 12]].concat());
        rows.extend((file.len() as u32).to_le_bytes());
        rows.extend(name.bytes());
        file.extend([b"PK\x03\x04", &common[..], &[0, 0], name.as_bytes(), &packed].concat());
    }
    let (start, n) = (file.len() as u32, entries.len() as u16);
    file.extend(&rows);
    file.extend([b"PK\x05\x06\0\0\0\0", &n.to_le_bytes()[..], &n.to_le_bytes()].concat());
    file.extend([(rows.len() as u32).to_le_bytes(), start.to_le_bytes()].concat());
    file.extend([0, 0]);
    file
}

fn volume(first: u8) -> Vec<u8> {
    npy("'|u1'", "False", "(2, 2, 2)", &(first..first + 8).collect::<Vec<_>>())
}

#[test]
fn the_one_array_of_three_axes_is_read() {
    let flat = npy("'<f4'", "False", "(2, 2)", &[0; 16]);
    for method in [0, 8] {
        let alone = zip(&[("scan.npy", method, &volume(5))]);
        assert_eq!(Format::sniff(&alone), Some(Format::Npz));
        let (found, warnings) = load(&alone, Format::Npz);
        assert!(warnings.is_empty());
        assert_eq!(values(&found), (5..13).map(f64::from).collect::<Vec<_>>());
        assert_eq!((found.name.as_str(), found.grid), ("scan", load(&volume(5), Format::Npy).0.grid));
        let more = zip(&[("flat.npy", method, &flat), ("Scan.npy", method, &volume(5)), ("n.txt", 0, b"x")]);
        let (found, warnings) = load(&more, Format::Npz);
        assert_eq!((found.name.as_str(), count(&warnings, "arrays-ignored")), ("Scan", 2));
    }
}

#[test]
fn several_arrays_are_named_and_chosen_from() {
    let file = zip(&[
        ("a.npy", 8, &volume(1)),
        ("flat.npy", 0, &npy("'<f4'", "False", "(4,)", &[0; 16])),
        ("A.npy", 0, &volume(2)),
    ]);
    let error = refuse(&file, Format::Npz);
    assert_eq!(error.code, "several-volumes");
    let message = "2 arrays have three axes, 'a' (2, 2, 2), 'A' (2, 2, 2): 'index' names one, from 0 to 1";
    assert_eq!(error.message, *message);
    let limits = Limits { index: Some(1), ..Limits::default() };
    let (found, warnings) = load_with(&file, Format::Npz, &limits);
    assert_eq!((values(&found)[0], found.name.as_str(), count(&warnings, "arrays-ignored")), (2.0, "A", 2));
    let limits = Limits { index: Some(2), ..Limits::default() };
    assert_eq!(read(&file, Format::Npz, &limits).unwrap_err().code, "no-such-volume");
}

#[test]
fn containers_that_lie_are_refused() {
    let objects = npy("'|O'", "False", "(2, 2, 2)", &[0; 8]);
    for (entries, code) in [
        (vec![("a.npy", 0, npy("'|u1'", "False", "(4,)", &[0; 4]))], "not-3d"),
        (vec![("a.npy", 0, objects)], "not-3d"),
        (vec![("a.txt", 0, volume(1))], "not-3d"),
        (vec![("a.npy", 0, volume(1)), ("a.npy", 0, volume(1))], "duplicate-name"),
        (vec![("../a.npy", 0, volume(1))], "unsafe-name"),
        (vec![("a.npy", 8, npy("'|u1'", "False", "(2, 2, 3)", &[0; 8]))], "truncated"),
        (vec![("a.npy", 0, npy("'|u1'", "False", "(2, 2, 2)", &[0; 9]))], "trailing-bytes"),
        (vec![("a.npy", 0, npy("'|u1'", "False", "(2, 2, 1)", &[0; 4]))], "flat-volume"),
        (vec![], "not-3d"),
    ] {
        let entries: Vec<_> =
            entries.iter().map(|(name, method, bytes)| (*name, *method, &bytes[..])).collect();
        let error = refuse(&zip(&entries), Format::Npz);
        assert_eq!(error.code, code, "{error}");
    }
    let whole = zip(&[("a.npy", 8, &volume(1))]);
    for end in 0..whole.len() {
        let error = refuse(&whole[..end], Format::Npz);
        assert!(!error.code.is_empty());
    }
    let mut damaged = zip(&[("a.npy", 0, &volume(1))]);
    let at = damaged.windows(8).position(|w| w == [1, 2, 3, 4, 5, 6, 7, 8]).unwrap();
    damaged[at] = 9;
    assert_eq!(refuse(&damaged, Format::Npz).code, "bad-checksum");
}
