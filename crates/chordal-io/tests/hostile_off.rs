//! What a hostile OFF may try, row by row of the list that the project keeps, and what must happen.
use crate::common;

use chordal_io::{Content, FileLocation, Format, Limits, ReadError, read};
use common::{count, load, refuse};

/// The text of a triangle with this keyword, counts and rows.
fn triangle(keyword: &str, rows: [&str; 3]) -> Vec<u8> {
    format!("{keyword}\n3 1 0\n{}\n3 0 1 2\n", rows.join("\n")).into_bytes()
}

const ROWS: [&str; 3] = ["0 0 0", "1 0 0", "0 1 0"];

fn code(bytes: &[u8]) -> &'static str {
    refuse(bytes, Format::Off).code
}
#[test]
fn h27_variants_that_are_not_read_are_refused_by_name() {
    for (keyword, name) in [
        ("nOFF 4", "variant nOFF of dimension 4"),
        ("nOFF 1", "variant nOFF of dimension 1"),
        ("nOFF\n1000000000000", "variant nOFF of dimension 1,000,000,000,000"),
        ("NCOFF", "variant 'NCOFF'"),
        ("4SOFF", "'4SOFF' where a keyword [ST][C][N][4][n]OFF should stand"),
    ] {
        let error = refuse(&triangle(keyword, ROWS), Format::Off);
        assert_eq!(error.code, "format-unsupported", "{error}");
        assert!(error.message.contains(name), "{error}");
        assert!(matches!(error.place, FileLocation::Line(1 | 2)), "{error}");
    }
    let with = |w: &str| triangle("4OFF", ["0 0 0 1", w, "0 1 0 1"]);
    for w in ["1 0 0 0", "1 0 0 inf", "1e308 0 0 1e-9", "0 0 0 0"] {
        let error = refuse(&with(w), Format::Off);
        assert_eq!((error.code, error.place), ("not-finite", FileLocation::Line(4)), "{w}");
        let limits = Limits { drop_nonfinite: true, ..Limits::default() };
        let loaded = read(&with(w), Format::Off, &limits).unwrap();
        assert_eq!(count(&loaded.warnings, "vertices-dropped"), 1, "{w}");
    }
    assert_eq!(refuse(&with("1 0 0 -0.0"), Format::Off).code, "not-finite");
}

#[test]
fn h26_counts_that_the_file_cannot_hold_reserve_nothing() {
    let wide = Limits { rows: u64::MAX, ..Limits::default() };
    for counts in ["2000000000 1 0", "1 2000000000 0", "353535235358 1 0", "1 353535235358 0"] {
        for keyword in ["OFF", "STCNOFF", "4OFF", "nOFF 3"] {
            let bytes = format!("{keyword}\n{counts}\n0 0 0 0 0 0 0 0 0 0 0\n").into_bytes();
            let error = refuse(&bytes, Format::Off);
            assert_eq!((error.code, &error.place), ("too-many-rows", &FileLocation::Line(2)), "{error}");
            assert!(error.message.contains("are over the limit of 500,000,000"), "{error}");
        }
        let error = read(format!("OFF\n{counts}\n0 0 0\n").as_bytes(), Format::Off, &wide).unwrap_err();
        assert!(matches!(error.code, "too-many-rows" | "truncated"), "{error}");
    }
    let error = refuse(b"OFF\n400000000 1 0\n0 0 0\n", Format::Off);
    assert!(
        error
            .message
            .contains("the vertex list has 400,000,000 rows of at least 6 bytes, but only 6 bytes follow"),
        "{error}"
    );
    for count in ["-1", "18446744073709551616", "1e3", "3.0", "0x10", "three"] {
        for counts in [format!("{count} 1 0"), format!("1 {count} 0")] {
            let error = refuse(format!("OFF\n{counts}\n0 0 0\n").as_bytes(), Format::Off);
            assert_eq!((error.code, error.place), ("not-a-count", FileLocation::Line(2)), "{counts}");
        }
    }
    assert_eq!(code(b"OFF\n1 0 x\n0 0 0\n"), "not-a-count");
    assert_eq!(code(b"OFF\n1 0 0 0\n0 0 0\n"), "row-too-long");
    // The number of edges is not used, whatever it is.
    let (mesh, _) = load(b"OFF\n1 0 -99999999999999999999999\n0 0 0\n", Format::Off);
    assert_eq!(mesh.positions().len(), 1);
    let few = Limits { rows: 2, ..Limits::default() };
    let quads = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n4 3 2 1 0\n";
    let four = Limits { rows: 4, ..few };
    assert_eq!(read(quads.as_bytes(), Format::Off, &few).unwrap_err().code, "too-many-rows");
    assert!(read(quads.as_bytes(), Format::Off, &four).is_ok());
    let three = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n5 0 1 2 0 1\n";
    let limits = Limits { rows: 3, ..few };
    assert!(read(three.as_bytes(), Format::Off, &limits).is_ok());
    let six = three.replace("5 0 1 2 0 1", "6 0 1 2 0 1 2");
    assert_eq!(read(six.as_bytes(), Format::Off, &limits).unwrap_err().code, "too-many-rows");
}

#[test]
fn h26_rows_that_are_wrong_name_their_line() {
    let with =
        |row: &str, face: &str| format!("OFF\n3 2 0\n0 0 0\n{row}\n0 1 0\n3 0 1 2\n{face}\n").into_bytes();
    let fails = |bytes: Vec<u8>, line: u64| -> ReadError {
        let error = refuse(&bytes, Format::Off);
        assert_eq!(error.place, FileLocation::Line(line), "{error}");
        error
    };
    for (row, expected) in [
        ("1 0", "row-too-short"),
        ("1 0 0 255 0 0", "row-too-long"),
        ("1 0 x", "not-a-number"),
        ("1 0,5 0", "not-a-number"),
        ("1 nan 0", "not-finite"),
        ("1e400 0 0", "not-finite"),
        ("-1.#IND 0 0", "row-too-short"),
    ] {
        let error = fails(with(row, "3 2 1 0"), 4);
        assert_eq!(error.code, expected, "{error}");
        assert!(error.message.starts_with("vertex 1: "), "{error}");
    }
    for (face, expected) in [
        ("3 0 1 3", "index-out-of-range"),
        ("3 0 1 -1", "index-out-of-range"),
        ("3 0 1 4294967297", "index-out-of-range"),
        ("3 0 1 9223372036854775808", "value-out-of-range"),
        ("3 0 1 1.0", "not-a-number"),
        ("3 0 1", "list-length"),
        ("-3 0 1 2", "list-length"),
        ("4294967295 0 1 2", "list-length"),
        ("200 0 1 2", "list-length"),
    ] {
        let error = fails(with("1 0 0", face), 7);
        assert_eq!(error.code, expected, "{error}");
        assert!(error.message.starts_with("face 1: "), "{error}");
    }
    for (keyword, row, expected) in [
        ("COFF", "1 0 0", "wrong-width"),
        ("COFF", "1 0 0 1 1", "wrong-width"),
        ("COFF", "1 0 0 1 1 1 1 1", "wrong-width"),
        ("STCOFF", "1 0 0 1 1 1 1", "wrong-width"),
        ("NOFF", "1 0 0 0 0", "row-too-short"),
        ("STOFF", "1 0 0 0 0 0", "row-too-long"),
    ] {
        let bytes = triangle(keyword, [row; 3]);
        assert!([expected, "truncated"].contains(&code(&bytes)), "{keyword} {row}");
    }
}

#[test]
fn h26_a_truncated_file_is_an_error_wherever_it_ends() {
    let whole = "STCNOFF\n3 2 0\n0 0 0 0 0 1 255 0 0 1 1\n1 0 0 0 0 1 255 0 0 1 1\n0 1 0 0 0 1 255 0 0 1 1\n3 0 1 2\n3 2 1 0";
    for end in 1..whole.len() {
        let error = refuse(&whole.as_bytes()[..end], Format::Off);
        assert!(matches!(error.place, FileLocation::Line(_)), "{end}: {error}");
    }
    load(whole.as_bytes(), Format::Off);
}

#[test]
fn h20_positions_that_are_not_finite_are_dropped_only_when_asked() {
    let bytes = b"COFF\n4 2 0\n0 0 0 1 0 0\nnan 0 0 1 0 0\n0 1 0 0 0.5 0\n1 1 0 0 0 1\n3 0 1 2 9 9 9\n3 0 2 3 8 8 8\n";
    assert_eq!(refuse(bytes, Format::Off).place, FileLocation::Line(4));
    let limits = Limits { drop_nonfinite: true, ..Limits::default() };
    let loaded = read(bytes, Format::Off, &limits).unwrap();
    let Content::Scene(scene) = loaded.content else { panic!("a scene") };
    let mesh = &scene.parts[0].mesh;
    assert_eq!((mesh.positions().len(), mesh.faces()), (3, &[[0, 1, 2]][..]));
    assert_eq!(mesh.attributes()[1].values, [8.0 / 255.0; 3], "the colour of the face that is left");
    assert_eq!(count(&loaded.warnings, "faces-dropped"), 1);
}

#[test]
fn h28_files_that_are_no_off_are_refused_and_named() {
    for (bytes, expected) in [
        (&b"\n \n"[..], "empty"),
        (b"# OFF\n", "truncated"),
        (b"OFF", "truncated"),
        (b"OFF\n3", "truncated"),
        (b"ply\nformat ascii 1.0\nend_header\n", "not-off"),
        (b"OFFSET 3 1 0\n", "not-off"),
        (b"\xff\xfeO\0F\0F\0", "not-utf8"),
        (b"OFF\n3 1 0\n0 0\0 0\n", "not-text"),
        (b"\0\0\0\0", "not-text"),
    ] {
        assert_eq!(code(bytes), expected, "{}", bytes.escape_ascii());
    }
    let error = refuse(b"ply\nformat ascii 1.0\nend_header\n", Format::Off);
    assert!(error.message.ends_with("; the content looks like ply"), "{error}");
    let error = refuse(b"OFF\n3 1 0\n", Format::Ply);
    assert!(error.message.ends_with("; the content looks like off"), "{error}");
    let long = [b"OFF # ".to_vec(), vec![b'x'; 100_000], b"\n1 0 0\n0 0 0\n".to_vec()].concat();
    assert_eq!(code(&long), "line-too-long");
    let later = [b"OFF\n1 0 0\n0 0 0 # ".to_vec(), vec![b'x'; 100_000]].concat();
    load(&later, Format::Off);
}
