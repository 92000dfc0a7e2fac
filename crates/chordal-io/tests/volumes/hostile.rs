//! What a hostile volume may try, row by row of the list that the project keeps, and what must happen.
use super::build::{Nii, npy, npy_of, nrrd, pack};
use super::{load, load_with, values};
use crate::common::{count, refuse};
use chordal_io::{Conformance, FileLocation, Format, Limits, read, read_with};

fn nii(dim: [i64; 8]) -> Nii {
    Nii { dim, ..Nii::default() }
}

#[test]
fn h61_sizes_that_are_no_sizes_are_refused_at_their_place() {
    for (dim, code, words) in [
        ([3, 0, 3, 2, 1, 1, 1, 1], "bad-size", "axis 0 has 0 samples"),
        ([3, 2, -3, 2, 1, 1, 1, 1], "bad-size", "axis 1 has -3 samples"),
        ([3, 2, 3, 1, 1, 1, 1, 1], "flat-volume", "axis 2 has 1 sample"),
        ([3, 32767, 32767, 32767, 1, 1, 1, 1], "too-large", "over the limit"),
        ([0, 2, 3, 2, 1, 1, 1, 1], "bad-size", "0 axes"),
        ([8, 2, 3, 2, 1, 1, 1, 1], "bad-size", "8 axes"),
        ([2, 4, 3, 1, 1, 1, 1, 1], "not-3d", "4 x 3 samples"),
        ([5, 2, 3, 2, 1, 2, 1, 1], "not-3d", "2 x 3 x 2 x 1 x 2"),
        ([4, 2, 3, 2, 7, 1, 1, 1], "several-volumes", "7 volumes: 'index' names one, from 0 to 6"),
    ] {
        for bytes in [nii(dim).bytes(), nii(dim).packed()] {
            let error = refuse(&bytes, Format::Nii);
            assert_eq!((error.code, &error.place), (code, &FileLocation::Byte(40)), "{error}");
            assert!(error.message.contains(words), "{error}");
        }
    }
    let wide = |dim: [i64; 8]| Nii { version: 2, offset: 544.0, dim, ..Nii::default() }.bytes();
    for (n, code) in
        [(1 << 31, "bad-size"), (i64::MAX, "bad-size"), (i64::MIN, "bad-size"), ((1 << 31) - 1, "too-large")]
    {
        let error = refuse(&wide([3, n, n, n, 1, 1, 1, 1]), Format::Nii);
        assert_eq!((error.code, error.place), (code, FileLocation::Byte(16)));
    }
    let limits = Limits { index: Some(3), ..Limits::default() };
    let several = Nii { dim: [4, 2, 2, 2, 3, 1, 1, 1], data: vec![0; 24], ..Nii::default() };
    assert_eq!(read(&several.bytes(), Format::Nii, &limits).unwrap_err().code, "no-such-volume");
    assert_eq!(read(&Nii::default().bytes(), Format::Nii, &limits).unwrap_err().code, "no-such-volume");
}

#[test]
fn h61_sizes_of_arrays_and_nrrd_are_checked_too() {
    for (shape, code) in [
        ("(0, 2, 2)", "bad-size"),
        ("(2, -2, 2)", "bad-size"),
        ("(2147483648, 2, 2)", "bad-size"),
        ("(2, 1, 2)", "flat-volume"),
        ("(2147483647, 2147483647, 2147483647)", "too-large"),
        ("(100000, 100000, 2)", "too-large"),
        ("(99999999999999999999, 2, 2)", "bad-header"),
        ("(2, 2)", "not-3d"),
        ("(8,)", "not-3d"),
        ("()", "not-3d"),
        ("(2, 2, 2, 1)", "not-3d"),
    ] {
        let error = refuse(&npy("'|u1'", "False", shape, &[0; 8]), Format::Npy);
        assert_eq!(error.code, code, "{shape}: {error}");
        assert!(matches!(error.place, FileLocation::Byte(_)), "{error}");
    }
    assert!(refuse(&npy("'|u1'", "False", "(2, 2)", &[0; 4]), Format::Npy).message.contains("np.stack"));
    for (sizes, code) in [
        ("0 2 2", "bad-size"),
        ("2 -2 2", "bad-size"),
        ("2 2 2147483648", "bad-size"),
        ("2 2 1", "flat-volume"),
        ("100000 100000 100000", "too-large"),
        ("2 2", "bad-header"),
        ("2 2 x", "bad-header"),
    ] {
        let file = format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: {sizes}\nencoding: raw\n\n12345678");
        let error = refuse(file.as_bytes(), Format::Nrrd);
        assert_eq!((error.code, error.place), (code, FileLocation::Line(4)), "{sizes}");
    }
    let file = b"NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 2 2\nencoding: raw\n\n0123456701234567";
    let error = refuse(file, Format::Nrrd);
    assert_eq!((error.code, error.place), ("several-volumes", FileLocation::Line(4)));
    let error = refuse(&file.map(|b| if b == b'4' { b'5' } else { b }), Format::Nrrd);
    assert_eq!(error.code, "bad-header");
}

#[test]
fn h62_samples_that_end_too_early_or_too_late_are_refused_at_the_byte() {
    let whole = Nii::default().bytes();
    let error = refuse(&whole[..whole.len() - 1], Format::Nii);
    assert_eq!((error.code, error.place), ("truncated", FileLocation::Byte(363)));
    assert!(error.message.contains("11 bytes are there, the header says 12"), "{}", error.message);
    let error = refuse(&[&whole[..], b"xyz"].concat(), Format::Nii);
    assert_eq!((error.code, error.place), ("trailing-bytes", FileLocation::Byte(364)));
    let lenient = Limits { conformance: Conformance::Lenient, ..Limits::default() };
    for bytes in [[&whole[..], b"xyz"].concat(), pack(&[&whole[..], b"xyz"].concat())] {
        let (volume, warnings) = load_with(&bytes, Format::Nii, &lenient);
        assert_eq!(values(&volume)[11], 11.0);
        assert_eq!(count(&warnings, "trailing-bytes"), 1);
    }
    let file = npy("'<u2'", "False", "(2, 2, 2)", &[0; 16]);
    assert_eq!(refuse(&file[..file.len() - 1], Format::Npy).code, "truncated");
    assert_eq!(refuse(&[&file[..], &[0]].concat(), Format::Npy).code, "trailing-bytes");
    let raw = "type: uint8\nencoding: raw\n";
    assert_eq!(refuse(&nrrd(raw, &[0; 11]), Format::Nrrd).code, "truncated");
    assert_eq!(refuse(&nrrd(raw, &[0; 13]), Format::Nrrd).code, "trailing-bytes");
    let text = "type: uint8\nencoding: text\n";
    assert_eq!(refuse(&nrrd(text, b"0 1 2 3 4 5 6 7 8 9 10"), Format::Nrrd).code, "truncated");
    let error = refuse(&nrrd(text, b"0 1 2 3 4 5 6 7 8 9 10 11 12"), Format::Nrrd);
    assert_eq!(error.code, "trailing-bytes");
    for number in ["256", "-1", "1.5", "x", "nan"] {
        let error = refuse(&nrrd(text, format!("0 1 {number}").as_bytes()), Format::Nrrd);
        let start = nrrd(text, b"").len() as u64;
        assert_eq!((error.code, error.place), ("bad-number", FileLocation::Byte(start + 4)), "{number}");
    }
}

#[test]
fn h62_a_file_of_the_other_byte_order_is_read_as_that_or_refused() {
    // Swapping the size of the header alone makes every other field nonsense.
    let mut bytes = Nii::default().bytes();
    bytes[..4].reverse();
    assert_eq!(refuse(&bytes, Format::Nii).code, "bad-offset");
    let missing = refuse(&nrrd("type: short\nencoding: raw\n", &[0; 24]), Format::Nrrd);
    assert!(missing.message.contains("'endian'"), "{missing}");
    let missing = refuse(&npy("'|u2'", "False", "(2, 2, 2)", &[0; 16]), Format::Npy);
    assert!(missing.message.contains("byte order"), "{missing}");
}

#[test]
fn h62_packed_bytes_that_are_cut_damaged_or_too_many_are_refused() {
    let packed = Nii::default().packed();
    for end in 2..packed.len() {
        let error = refuse(&packed[..end], Format::Nii);
        assert_eq!(error.code, "truncated", "{end}: {error}");
        assert!(matches!(error.place, FileLocation::Byte(at) if at <= end as u64), "{error}");
    }
    let mut damaged = packed.clone();
    let crc = damaged.len() - 8;
    damaged[crc] ^= 1;
    assert_eq!(refuse(&damaged, Format::Nii).code, "bad-gzip");
    // Another stream that goes on is part of the same file; anything else is not.
    let halves = [pack(&Nii::default().bytes()[..200]), pack(&Nii::default().bytes()[200..])].concat();
    assert_eq!(values(&load(&halves, Format::Nii).0)[11], 11.0);
    assert_eq!(refuse(&[&packed[..], b"more, which is no gzip"].concat(), Format::Nii).code, "bad-gzip");
    assert_eq!(refuse(&[&packed[..], &pack(b"x")].concat(), Format::Nii).code, "trailing-bytes");
    let gz = "type: uint8\nencoding: gzip\n";
    assert_eq!(refuse(&nrrd(gz, &pack(&[0; 11])), Format::Nrrd).code, "truncated");
    assert_eq!(refuse(&nrrd(gz, &pack(&[0; 13])), Format::Nrrd).code, "trailing-bytes");
    assert_eq!(refuse(&nrrd(gz, b"this is no gzip stream"), Format::Nrrd).code, "bad-gzip");
}

#[test]
fn h62_a_bomb_unpacks_no_further_than_its_header_and_the_limit() {
    // 64 MiB of zeros in 300 kB, behind a header that declares 12 samples: over after the first byte too
    // many.
    let bomb = pack(&[&Nii::default().bytes()[..], &vec![0; 64 << 20]].concat());
    assert!(bomb.len() < 400_000);
    let error = refuse(&bomb, Format::Nii);
    assert_eq!(error.code, "trailing-bytes");
    assert!(matches!(error.place, FileLocation::Byte(at) if at < 100_000), "{error}");
    // One that declares all of it is refused by the limit before anything is unpacked.
    let dim = [3, 512, 512, 256, 1, 1, 1, 1];
    let bomb = pack(&[&nii(dim).bytes()[..352], &vec![0; 64 << 20]].concat());
    let limits = Limits { bytes: 32 << 20, ..Limits::default() };
    let error = read(&bomb, Format::Nii, &limits).unwrap_err();
    assert_eq!((error.code, error.place), ("too-large", FileLocation::Byte(40)));
    // One that declares more than there is allocates what arrives: `sweep.rs` counts the bytes.
    let error = refuse(&pack(&nii([3, 1000, 1000, 1000, 1, 1, 1, 1]).bytes()), Format::Nii);
    assert_eq!(error.code, "truncated");
    assert!(error.message.contains("12 bytes are there, the header says 1,000,000,000"), "{error}");
    // Beyond what any measured volume is packed to it is not even tried.
    let error = refuse(&pack(&nii([3, 2000, 1000, 1000, 1, 1, 1, 1]).bytes()), Format::Nii);
    assert_eq!((error.code, error.place), ("too-dense", FileLocation::Byte(40)));
    let gz = "type: uint8\nencoding: gzip\n";
    let large = String::from_utf8(nrrd(gz, b"")).expect("text").replace("2 3 2", "1430 1430 1430");
    let error = refuse(&[large.as_bytes(), &pack(&[0; 1 << 20])].concat(), Format::Nrrd);
    assert_eq!(error.code, "too-dense");
}

#[test]
fn h63_samples_that_are_no_numbers_are_kept_and_counted() {
    let mut all = [1.0_f32; 12];
    (all[3], all[7], all[8], all[11]) = (f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::NAN);
    let data: Vec<u8> = all.iter().flat_map(|x| x.to_le_bytes()).collect();
    let (volume, warnings) =
        load(&Nii { datatype: 16, bitpix: 32, data, ..Nii::default() }.bytes(), Format::Nii);
    assert!(values(&volume)[3].is_nan() && values(&volume)[7] == f64::INFINITY);
    let nan = warnings.iter().find(|w| w.code == "nan-samples").expect("counted");
    assert_eq!((nan.count, &nan.place), (2, &FileLocation::Row { list: "sample", row: 3 }));
    assert!(nan.message.contains("outside"), "the policy is said: {nan}");
    assert_eq!(count(&warnings, "infinite-samples"), 2);
}

#[test]
fn h65_a_place_that_is_flat_or_no_number_is_refused() {
    let row = |rows: [[f64; 4]; 3]| Nii { rows, ..Nii::default() }.bytes();
    let (x, y, z) = ([1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]);
    for rows in [
        [x, y, [0.0; 4]],
        [x, y, y],
        [[0.0; 4]; 3],
        [x, y, [0.0, 0.0, f64::NAN, 0.0]],
        [x, y, [0.0, 0.0, 1.0, f64::INFINITY]],
    ] {
        let error = refuse(&row(rows), Format::Nii);
        assert_eq!((error.code, error.place), ("singular", FileLocation::Byte(280)));
    }
    // Mirrored and sheared are places like others.
    assert_eq!(load(&row([y, x, z]), Format::Nii).0.grid.affine().orientation(), -1);
    let quaternion = Nii { sform: 0, qform: 1, quaternion: [f64::NAN; 6], ..Nii::default() };
    assert_eq!(refuse(&quaternion.bytes(), Format::Nii).place, FileLocation::Byte(256));
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let pixdim = [1.0, 1.0, step, 1.0, 0.0, 0.0, 0.0, 0.0];
        for qform in [0, 1] {
            let error = refuse(&Nii { sform: 0, qform, pixdim, ..Nii::default() }.bytes(), Format::Nii);
            assert_eq!((error.code, error.place), ("singular", FileLocation::Byte(76)));
        }
    }
    let place = |fields: &str| {
        refuse(&nrrd(&format!("type: uint8\nencoding: raw\n{fields}"), &[0; 12]), Format::Nrrd)
    };
    let singular = [
        "space: RAS\nspace directions: (1,0,0) (0,1,0) (1,1,0)\n",
        "space: RAS\nspace directions: (1,0,0) (0,1,0) none\n",
    ];
    for fields in singular {
        let error = place(fields);
        assert_eq!((error.code, error.place), ("singular", FileLocation::Line(8)));
    }
    for fields in ["spacings: 1 0 1\n", "spacings: 1 nan 1\n", "spacings: 1 1\n"] {
        assert_eq!(place(fields).code, "singular", "{fields}");
    }
    for fields in
        ["space directions: (1,0,0) (0,nan,0) (0,0,1)\n", "space directions: (1,0,0) (0,inf,0) (0,0,1)\n"]
    {
        assert_eq!(place(fields).code, "not-finite", "{fields}");
    }
}

#[test]
fn h66_labels_up_to_the_largest_are_kept() {
    let all: [u32; 12] = [0, 1, 2, 2523, 2524, u32::MAX, u32::MAX - 1, 0, 0, 0, 0, 0];
    let data: Vec<u8> = all.iter().flat_map(|x| x.to_le_bytes()).collect();
    let (volume, _) = load(&Nii { datatype: 768, bitpix: 32, data, ..Nii::default() }.bytes(), Format::Nii);
    assert_eq!(values(&volume), all.map(f64::from));
}

#[test]
fn headers_that_are_none_are_refused() {
    for (bytes, code) in [
        (npy("'|O'", "False", "(2, 2, 2)", &[0; 8]), "unsupported-type"),
        (npy("'<c8'", "False", "(2, 2, 2)", &[0; 64]), "unsupported-type"),
        (npy("[('x', '<f4')]", "False", "(2, 2, 2)", &[0; 32]), "unsupported-type"),
        (npy("'<U8'", "False", "(2, 2, 2)", &[0; 8]), "unsupported-type"),
        (npy("'<f16'", "False", "(2, 2, 2)", &[0; 128]), "unsupported-type"),
        (npy("'=f4'", "False", "(2, 2, 2)", &[0; 32]), "unsupported-type"),
        (npy("'|u1'", "Maybe", "(2, 2, 2)", &[0; 8]), "bad-header"),
        (npy("'|u1'", "False", "2, 2, 2", &[0; 8]), "bad-header"),
        (npy_of(1, "{'descr': '|u1', 'shape': (2, 2, 2)}", &[0; 8]), "bad-header"),
        (npy_of(1, "__import__('os')", &[0; 8]), "bad-header"),
        (
            npy_of(1, "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 2, 2)} + {}", &[0; 8]),
            "bad-header",
        ),
        (npy_of(4, "{}", &[]), "bad-header"),
        (b"\x93NUMPY\x01".to_vec(), "truncated"),
        (b"\x93NUMPY\x02\x00\xff\xff\xff\xff{}".to_vec(), "bad-header"),
        (b"\x93NUMPX".to_vec(), "bad-magic"),
    ] {
        assert_eq!(refuse(&bytes, Format::Npy).code, code, "{}", String::from_utf8_lossy(&bytes));
    }
    let mut pair = Nii::default().bytes();
    pair[344..348].copy_from_slice(b"ni1\0");
    assert_eq!(refuse(&pair, Format::Nii).code, "detached");
    for (samples, code) in
        [(&[][..], "truncated"), (&[1; 5][..], "truncated"), (&[1; 500][..], "trailing-bytes")]
    {
        let mut open = |_: &str| Ok(samples.to_vec());
        let error = read_with(&pair, Format::Nii, &mut open, &Limits::default()).unwrap_err();
        assert_eq!(error.code, code, "{} bytes: {error}", samples.len());
    }
    let mut open = |path: &str| Err(format!("no {path}"));
    let error = read_with(&pair, Format::Nii, &mut open, &Limits::default()).unwrap_err();
    assert!(error.code == "missing-file" && error.message.contains(".img"), "{error}");
    assert_eq!(refuse(b"not a volume", Format::Nii).code, "bad-magic");
    for datatype in [0, 1, 32, 128, 1536, 1792, 2304, 7] {
        let error = refuse(&Nii { datatype, ..Nii::default() }.bytes(), Format::Nii);
        assert_eq!((error.code, error.place), ("unsupported-type", FileLocation::Byte(70)));
    }
    for offset in [1.0, 351.0, 352.5, -352.0, f64::NAN, f64::INFINITY] {
        assert_eq!(
            refuse(&Nii { offset, ..Nii::default() }.bytes(), Format::Nii).code,
            "bad-offset",
            "{offset}"
        );
    }
    assert_eq!(refuse(&Nii { offset: 1e15, ..Nii::default() }.bytes(), Format::Nii).code, "truncated");
    for (fields, code) in [
        ("type: block\nencoding: raw\n", "unsupported-type"),
        ("type: uint8\nencoding: bzip2\n", "unsupported"),
        ("type: uint8\nencoding: hex\n", "unsupported"),
        ("encoding: raw\n", "bad-header"),
        ("type: uint8\n", "bad-header"),
        ("type: uint8\ntype: uint8\nencoding: raw\n", "bad-header"),
        ("type: uint8\nencoding: raw\nno field\n", "bad-header"),
        ("type: uint8\nencoding: raw\nspaec: RAS\n", "bad-header"),
        ("type: uint8\nencoding: raw\nbyte skip: -2\n", "bad-header"),
        ("type: uint8\nencoding: raw\nbyte skip: 99999999999\n", "truncated"),
        ("type: uint8\nencoding: raw\nline skip: 99999999999\n", "truncated"),
        ("type: uint8\nencoding: raw\nspace: left-posterior-superior-time\n", "unsupported"),
        ("type: uint8\nencoding: raw\nspace dimension: 4\n", "not-3d"),
        ("type: uint8\nencoding: raw\nspace directions: (1,0) (0,1)\n", "unsupported"),
    ] {
        assert_eq!(refuse(&nrrd(fields, &[0; 12]), Format::Nrrd).code, code, "{fields}");
    }
    let error =
        refuse(&nrrd("type: uint8\nencoding: raw\ndata file: ../../etc/passwd\n", &[0; 12]), Format::Nrrd);
    assert_eq!((error.code, error.place), ("detached", FileLocation::Line(7)));
    assert!(error.message.contains("'../../etc/passwd'"), "{}", error.message);
}
