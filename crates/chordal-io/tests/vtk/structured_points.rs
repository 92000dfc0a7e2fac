//! Volumes in legacy VTK files, STRUCTURED_POINTS.
use crate::common::{count, refuse};
use chordal::implicit::Samples;
use chordal_io::{Content, Format, Limits, Volume, Warning, read};

const HEAD: &str = "# vtk DataFile Version 3.0\nA scan\n";
const LATTICE: &str = "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 3 2\nSPACING 1 0.5 2\nORIGIN 10 20 -30\n";

fn load(bytes: &[u8], index: Option<u64>) -> (Volume, Vec<Warning>) {
    let limits = Limits { index, ..Limits::default() };
    let outcome = read(bytes, Format::Vtk, &limits).unwrap_or_else(|error| panic!("{error}"));
    let Content::Volume(volume) = outcome.content else { panic!("no volume") };
    (volume, outcome.warnings)
}

fn text(data: &str) -> String {
    format!("{HEAD}ASCII\n{LATTICE}{data}")
}

#[test]
fn text_and_binary_say_the_same() {
    let numbers: Vec<i16> = (0..12).map(|i| 7 * i - 20).collect();
    let words: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    let data = "POINT_DATA 12\nSCALARS density short\nLOOKUP_TABLE default\n";
    let ascii = text(&format!("{data}{}\n", words.join(" "))).into_bytes();
    let mut binary = format!("{HEAD}BINARY\n{LATTICE}{data}").into_bytes();
    numbers.iter().for_each(|number| binary.extend(number.to_be_bytes()));
    binary.push(b'\n');
    for bytes in [ascii, binary] {
        assert_eq!(Format::sniff(&bytes), Some(Format::Vtk));
        let (volume, warnings) = load(&bytes, None);
        assert_eq!(warnings, []);
        assert_eq!(*volume.grid.samples(), Samples::I16(numbers.clone()));
        assert_eq!((volume.grid.size(), volume.name.as_str()), ([2, 3, 2], "density"));
        // The first axis runs fastest.
        assert_eq!(volume.grid.sample([1, 2, 1]), f64::from(numbers[11]));
        assert_eq!(volume.grid.sample([1, 0, 0]), f64::from(numbers[1]));
        assert_eq!(volume.grid.affine().at([1.0, 2.0, 1.0]), [11.0, 21.0, -28.0]);
    }
}

#[test]
fn numbers_have_the_type_that_the_file_gives_them() {
    for (kind, word, expected) in [
        ("unsigned_char", "255", Samples::U8(vec![255; 12])),
        ("char", "-3", Samples::I8(vec![-3; 12])),
        ("unsigned_short", "65535", Samples::U16(vec![65535; 12])),
        ("int", "-70000", Samples::I32(vec![-70000; 12])),
        ("unsigned_int", "4000000000", Samples::U32(vec![4_000_000_000; 12])),
        ("long", "5", Samples::I32(vec![5; 12])),
        ("float", "0.1", Samples::F32(vec![0.1; 12])),
        ("double", "0.1", Samples::F64(vec![0.1; 12])),
    ] {
        let data = format!(
            "POINT_DATA 12\nSCALARS a {kind} 1\nLOOKUP_TABLE default\n{}",
            format!("{word} ").repeat(12)
        );
        assert_eq!(*load(text(&data).as_bytes(), None).0.grid.samples(), expected, "{kind}");
    }
}

#[test]
fn scalars_come_before_other_arrays_and_an_index_chooses() {
    let field = |name: &str, value: u32| format!("{name} 1 12 int\n{}\n", format!("{value} ").repeat(12));
    let fields = format!("FIELD f 2\n{}{}", field("first", 1), field("second", 2));
    let vectors = format!("VECTORS v float\n{}\n", "0 0 1 ".repeat(12));
    let scalars = format!("SCALARS s int\nLOOKUP_TABLE default\n{}\n", "3 ".repeat(12));
    let several = text(&format!("POINT_DATA 12\n{vectors}{fields}"));
    let error = refuse(several.as_bytes(), Format::Vtk);
    assert_eq!(error.code, "several-volumes");
    assert!(error.message.contains("first") && error.message.contains("second"), "{error}");
    for (index, value) in [(0, 1.0), (1, 2.0)] {
        assert_eq!(load(several.as_bytes(), Some(index)).0.grid.sample([0; 3]), value);
    }
    let outcome = read(several.as_bytes(), Format::Vtk, &Limits { index: Some(2), ..Limits::default() });
    assert_eq!(outcome.unwrap_err().code, "no-such-volume");
    let named = text(&format!("POINT_DATA 12\n{vectors}{fields}{scalars}"));
    let (volume, warnings) = load(named.as_bytes(), None);
    assert_eq!((volume.grid.sample([1; 3]), count(&warnings, "arrays-ignored")), (3.0, 2));
}

#[test]
fn samples_of_cells_stand_at_their_centres() {
    let head = "DATASET STRUCTURED_POINTS\nDIMENSIONS 3 3 4\nASPECT_RATIO 2 2 2\nORIGIN 0 0 0\n";
    let data = format!("CELL_DATA 12\nSCALARS c unsigned_char\nLOOKUP_TABLE default\n{}", "0 1 ".repeat(6));
    let (volume, warnings) = load(format!("{HEAD}ASCII\n{head}{data}").as_bytes(), None);
    assert_eq!((volume.grid.size(), count(&warnings, "cell-samples")), ([2, 2, 3], 1));
    assert_eq!(volume.grid.affine().at([0.0; 3]), [1.0; 3]);
}

#[test]
fn files_that_lie_are_one_error() {
    let whole =
        text(&format!("POINT_DATA 12\nSCALARS a float\nLOOKUP_TABLE default\n{}\n", "1.5 ".repeat(12)));
    load(whole.as_bytes(), None);
    for (from, to, code) in [
        ("DIMENSIONS 2 3 2\n", "", "bad-header"),
        ("DIMENSIONS 2 3 2", "DIMENSIONS 2 3", "not-a-number"),
        ("DIMENSIONS 2 3 2", "DIMENSIONS 2 0 2", "bad-size"),
        ("DIMENSIONS 2 3 2", "DIMENSIONS 2 -3 2", "bad-size"),
        ("DIMENSIONS 2 3 2", "DIMENSIONS 2 6 1", "flat-volume"),
        ("DIMENSIONS 2 3 2", "DIMENSIONS 3000000000 3000000000 3000000000", "bad-size"),
        ("DIMENSIONS 2 3 2", "DIMENSIONS 2000000000 2000000000 2000000000", "count-mismatch"),
        ("SPACING 1 0.5 2", "SPACING 1 0 2", "singular"),
        ("SPACING 1 0.5 2", "SPACING 1 nan 2", "not-finite"),
        ("ORIGIN 10 20 -30", "ORIGIN 10 20", "not-a-number"),
        ("POINT_DATA 12", "POINT_DATA 13", "count-mismatch"),
        ("POINT_DATA 12", "CELL_DATA 12", "count-mismatch"),
        ("SCALARS a float", "SCALARS a flout", "type-unknown"),
        ("SCALARS a float", "SCALARS a float 2", "truncated"),
        ("1.5 1.5", "1.5 x", "not-a-number"),
        ("1.5 1.5", "1.5", "truncated"),
        ("SPACING", "SPACE", "unknown-keyword"),
        ("STRUCTURED_POINTS", "STRUCTURED_GRID", "unsupported-data-set"),
    ] {
        assert!(whole.contains(from), "{from}");
        let error = refuse(whole.replacen(from, to, 1).as_bytes(), Format::Vtk);
        assert_eq!(error.code, code, "{to}: {error}");
    }
    let error = refuse(text("").as_bytes(), Format::Vtk);
    assert_eq!(error.code, "no-samples", "{error}");
}
