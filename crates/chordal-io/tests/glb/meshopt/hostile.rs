//! Broken streams end in an error with the view's pointer, or in bytes; never in a panic.
use super::super::build::{glb_of, put, strict};
use super::{PackedRows, attribute, encode, known_streams};
use chordal_io::{Conformance, FileLocation, Limits, glb};
use chordal_testkit::Random;
use proptest::prelude::*;
use serde_json::json;

const PLACE: &str = "/bufferViews/0/extensions/KHR_meshopt_compression";

/// Bytes, or an error of the stream at its view.
#[track_caller]
fn survive(packed: &PackedRows) -> bool {
    match packed.unpacked() {
        Ok(bytes) => {
            assert_eq!(bytes.len(), packed.stride * packed.count);
            true
        }
        Err(error) => {
            assert_eq!(error.place, FileLocation::Pointer(PLACE.to_owned()), "{error}");
            assert_eq!(error.code, "meshopt-stream", "{error}");
            false
        }
    }
}

/// One small stream of each kind.
fn seeds() -> Vec<PackedRows> {
    let mut random = Random::new(1);
    let rows: Vec<u8> = (0..40 * 8).map(|i| (i % 8 * (i / 8) % 50) as u8).collect();
    let triangles = [[0, 1, 2], [2, 1, 3], [4, 5, 6], [4, 6, 7], [9, 8, 1], [0, 1, 2], [2, 1, 3], [7, 7, 9]];
    let mut all = vec![
        encode::vertices(&rows, 8, 0, &mut random),
        encode::vertices(&rows, 8, 1, &mut random),
        encode::triangles(&triangles, 4, 0, &mut random).0,
        encode::triangles(&triangles, 2, 1, &mut random).0,
        encode::sequence(&[3, 1, 4, 1, 5, 900, 2, 60_000], 2, 1, &mut random),
    ];
    let names = ["normals of 11 bits", "turns v1", "places v0", "colours of 7 bits"];
    all.extend(known_streams().into_iter().filter(|s| names.contains(&&*s.name)).map(|s| s.packed));
    assert_eq!(all.len(), 9);
    all
}

#[test]
fn streams_cut_off_anywhere() {
    for seed in seeds() {
        assert!(survive(&seed));
        for end in 0..seed.stream.len() {
            let mut cut = seed.clone();
            cut.stream.truncate(end);
            if end > 0 {
                assert!(!survive(&cut), "{} cut at {end}", seed.mode);
            } else {
                // A view has at least one byte.
                assert!(cut.unpacked().is_err());
            }
            // A byte too many inside is no better.
            let mut long = seed.clone();
            long.stream.insert(end.max(1), 0);
            survive(&long);
        }
        let mut long = seed.clone();
        long.stream.extend([0; 64]);
        assert!(!survive(&long), "{} with bytes left over", seed.mode);
        for count in [seed.count + 6, seed.count - 6] {
            let other = PackedRows { count, ..seed.clone() };
            // Rows of one group are as long, however many they are.
            let read = survive(&other);
            assert!(seed.mode == "ATTRIBUTES" || !read, "{} with {count} rows", seed.mode);
        }
    }
}

#[test]
fn streams_with_flipped_bits() {
    let mut random = Random::new(77);
    let mut n_read = 0;
    for seed in seeds() {
        for _ in 0..chordal_testkit::cases(1500) {
            let mut packed = seed.clone();
            for _ in 0..=random.below(3) {
                let at = random.below(packed.stream.len());
                packed.stream[at] ^= 1 << random.below(8);
            }
            n_read += usize::from(survive(&packed));
        }
    }
    assert!(n_read > 1000, "only {n_read} were read");
}

proptest! {
    #[test]
    fn any_bytes(
        mut stream in proptest::collection::vec(any::<u8>(), 1..400),
        kind in 0_usize..9,
        header in prop::option::weighted(0.9, 0_u8..2),
        count in 1_usize..200,
    ) {
        let seed = &seeds()[kind];
        if let Some(version) = header {
            stream[0] = seed.stream[0] & 0xF0 | version;
        }
        let n = stream.len();
        // A table of codes, so that triangles are read.
        if matches!(kind, 2 | 3) && n > 17 {
            stream[n - 16..].fill(0x76);
            stream[n - 2..].fill(0);
        }
        survive(&PackedRows { count: count * 6, stream, ..seed.clone() });
    }
}

#[test]
fn streams_that_break_one_rule() {
    let vertex = |tail: &[u8]| [&[0xA1, 0x02 | 0x08 | 0x20 | 0x80], &[0; 19][..], tail].concat();
    let row = |stream| PackedRows::new("ATTRIBUTES", 4, 1, stream);
    assert!(survive(&row(vertex(&[1, 2, 3, 4, 0]))));
    for mode in [3, 4, 0x10, 0x21, 0x13, 0xFF] {
        assert!(!survive(&row(vertex(&[1, 2, 3, 4, mode]))), "mode {mode:#x}");
    }
    let mut unknown = vertex(&[1, 2, 3, 4, 0]);
    unknown[0] = 0xA2;
    assert!(!survive(&row(unknown)));

    let triangle = |codes: &[u8], rest: &[u8]| {
        let stream = [&[0xE1], codes, rest, &[0; 16]].concat();
        PackedRows::new("TRIANGLES", 4, 3 * codes.len(), stream)
    };
    assert!(survive(&triangle(&[0xF0, 0x00], &[])));
    // The first triangle has no edge, the second no fourth, and the vertex before is not there.
    assert!(!survive(&triangle(&[0x00], &[])));
    assert!(!survive(&triangle(&[0xF0, 0x30], &[])));
    assert!(!survive(&triangle(&[0xF0, 0x03], &[])));
    assert!(!survive(&triangle(&[0xFE], &[0x10])));
    // A table with an open corner; with bytes in its last two places.
    for at in [1, 14, 15, 16] {
        let mut packed = triangle(&[0xF0], &[]);
        let n = packed.stream.len();
        packed.stream[n - at] = 0xF0;
        assert!(!survive(&packed), "{at}");
    }
    // Numbers of more than 32 bits, and indices of more than 16.
    assert!(survive(&triangle(&[0xFF], &[0xFF, 0xFE, 0xFF, 0xFF, 0xFF, 0x0F, 1, 1])));
    assert!(!survive(&triangle(&[0xFF], &[0xFF, 0xFE, 0xFF, 0xFF, 0xFF, 0x1F, 1, 1])));
    assert!(!survive(&triangle(&[0xFF], &[0xFF, 0xFE, 0xFF, 0xFF, 0xFF, 0xFF, 1, 1, 1])));
    let wide = |stride| {
        let stream = [&[0xD1, 0x80, 0x80, 0x10, 0x00][..], &[0; 4]].concat();
        PackedRows::new("INDICES", stride, 2, stream)
    };
    assert!(survive(&wide(4)) && !survive(&wide(2)));
}

#[test]
fn extensions_that_say_something_wrong() {
    let seed = encode::vertices(&[7; 48], 4, 0, &mut Random::new(1));
    let name = "EXT_meshopt_compression";
    let own = format!("/bufferViews/0/extensions/{name}");
    let at = |key: &str| format!("{own}/{key}");
    let none = json!(null);
    let cases = [
        (at("buffer"), none.clone(), "UNDEFINED_PROPERTY", own.clone()),
        (at("buffer"), json!(9), "UNRESOLVED_REFERENCE", at("buffer")),
        (at("buffer"), json!(1), "meshopt-fallback", at("buffer")),
        (at("byteLength"), none.clone(), "UNDEFINED_PROPERTY", own.clone()),
        (at("byteLength"), json!(0), "VALUE_NOT_IN_RANGE", at("byteLength")),
        (at("byteLength"), json!(1_i64 << 40), "BUFFER_VIEW_TOO_LONG", at("byteLength")),
        (at("byteOffset"), json!(-1), "VALUE_NOT_IN_RANGE", at("byteOffset")),
        (at("byteOffset"), json!(1), "BUFFER_VIEW_TOO_LONG", at("byteLength")),
        (at("byteOffset"), json!(i64::MAX), "BUFFER_VIEW_TOO_LONG", at("byteLength")),
        (at("byteStride"), none.clone(), "UNDEFINED_PROPERTY", own.clone()),
        (at("byteStride"), json!(6), "VALUE_NOT_IN_RANGE", at("byteStride")),
        (at("byteStride"), json!(260), "VALUE_NOT_IN_RANGE", at("byteStride")),
        (at("byteStride"), json!(8), "VALUE_NOT_IN_RANGE", at("count")),
        (at("count"), json!(11), "VALUE_NOT_IN_RANGE", at("count")),
        (at("count"), json!(0), "VALUE_NOT_IN_RANGE", at("count")),
        (at("mode"), none.clone(), "UNDEFINED_PROPERTY", own.clone()),
        (at("mode"), json!("CUBES"), "VALUE_NOT_IN_LIST", at("mode")),
        (at("mode"), json!("TRIANGLES"), "meshopt-stream", own.clone()),
        (at("filter"), json!("CUBES"), "VALUE_NOT_IN_LIST", at("filter")),
        (at("filter"), json!(1), "TYPE_MISMATCH", at("filter")),
        (at("filter"), json!("QUATERNION"), "VALUE_NOT_IN_RANGE", at("filter")),
        (own.clone(), json!(5), "TYPE_MISMATCH", own.clone()),
        (
            "/extensionsUsed".to_owned(),
            json!(["KHR_texture_transform"]),
            "UNUSED_EXTENSION_REQUIRED",
            "/extensionsRequired/0".to_owned(),
        ),
        ("/bufferViews/0/byteStride".to_owned(), json!(8), "VALUE_NOT_IN_RANGE", at("byteStride")),
        (
            "/bufferViews/0/extensions".to_owned(),
            none,
            "meshopt-fallback",
            "/bufferViews/0/buffer".to_owned(),
        ),
    ];
    for (pointer, value, code, place) in cases {
        let mut json = seed.document(name);
        put(&mut json, &pointer, value.clone());
        let file = glb_of(&json.to_string(), &seed.stream);
        let error = glb::read(&file, &strict()).map(|_| ()).expect_err(&pointer);
        let found = (error.code, &error.place);
        assert_eq!(found, (code, &FileLocation::Pointer(place)), "{pointer} = {value}: {error}");
        // Whether it is forgiven or not: no panic, and no bytes that nobody wrote.
        let lenient = Limits { conformance: Conformance::Lenient, ..Limits::default() };
        if let Ok(loaded) = glb::read(&file, &lenient) {
            assert!(loaded.warnings.iter().any(|warning| warning.code == code), "{:?}", loaded.warnings);
        }
    }
    let both = json!({ name: seed.extension(), "KHR_meshopt_compression": seed.extension() });
    let mut json = seed.document(name);
    put(&mut json, "/extensionsUsed", json!([name, "KHR_meshopt_compression"]));
    put(&mut json, "/bufferViews/0/extensions", both);
    let error = glb::read(&glb_of(&json.to_string(), &seed.stream), &strict()).map(|_| ());
    assert_eq!(error.expect_err("accepted").code, "UNEXPECTED_EXTENSION_OBJECT");
    for (mode, stride, count, key) in
        [("TRIANGLES", 4, 5, "count"), ("TRIANGLES", 1, 12, "byteStride"), ("INDICES", 8, 6, "byteStride")]
    {
        let packed = PackedRows::new(mode, stride, count, vec![0xE1]);
        let error = packed.unpacked().expect_err("accepted");
        assert_eq!(error.place, FileLocation::Pointer(format!("{PLACE}/{key}")), "{error}");
    }
}

#[test]
fn what_is_unpacked_is_limited_before_it_is_made() {
    // A block of still rows takes a byte for each channel: 128 bytes of output for one.
    let n = 1 << 16;
    let seed = encode::vertices(&vec![0; 256 * 64], 256, 1, &mut Random::new(1));
    let mut still = vec![0xA1];
    still.resize(1 + n * 64, 0xAA);
    still.extend(&seed.stream[seed.stream.len() - 320..seed.stream.len() - 64]);
    still.extend([0; 64]);
    let packed = PackedRows::new("ATTRIBUTES", 256, n * 32, still);
    let limits = Limits { bytes: 256 << 20, ..Limits::default() };
    for limits in [limits, Limits { conformance: Conformance::Lenient, ..limits }] {
        let error = attribute(&packed.file("KHR_meshopt_compression"), &limits).expect_err("accepted");
        assert_eq!((error.code, &error.place), ("too-large", &FileLocation::Pointer(PLACE.to_owned())));
    }
    // A small file, whatever the limit is, unpacks to little: many views of one stream too.
    let mut json = packed.document("EXT_meshopt_compression");
    put(&mut json, "/bufferViews/0/byteLength", json!(u64::from(u32::MAX) * 256));
    put(&mut json, "/bufferViews/0/extensions/EXT_meshopt_compression/count", json!(u64::from(u32::MAX)));
    let file = glb_of(&json.to_string(), &packed.stream);
    let limits = Limits { bytes: 1 << 60, ..Limits::default() };
    assert_eq!(glb::read(&file, &limits).map(|_| ()).expect_err("accepted").code, "too-large");
}
