//! What the reader of legacy VTK files makes of them.
use super::build::Numbers;
use crate::common::{count, load_scene};
use chordal::explicit::{Domain, Semantic};
use chordal_io::Format;

const POINTS: [f32; 15] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 2.0, 0.0, 0.5];

/// Puts a file together: words, and numbers in its form.
struct Legacy {
    bytes: Vec<u8>,
    is_binary: bool,
}

impl Legacy {
    fn new(version: &str, is_binary: bool, data_set: &str) -> Self {
        let form = if is_binary { "BINARY" } else { "ASCII" };
        let head = format!("# vtk DataFile Version {version}\nA title, {form}\n{form}\nDATASET {data_set}\n");
        Self { bytes: head.into_bytes(), is_binary }
    }

    fn put(&mut self, line: &str) -> &mut Self {
        self.bytes.extend(line.as_bytes());
        self.bytes.push(b'\n');
        self
    }

    fn numbers(&mut self, numbers: &Numbers) -> &mut Self {
        if self.is_binary {
            self.bytes.extend(numbers.bytes(true));
            return self.put("");
        }
        let text = match numbers {
            Numbers::F32(list) => list.iter().map(|x| format!("{x} ")).collect::<String>(),
            Numbers::F64(list) => list.iter().map(|x| format!("{x}\n")).collect(),
            Numbers::U8(list) => list.iter().map(|x| format!("{x} ")).collect(),
            Numbers::I32(list) => list.iter().map(|x| format!("{x}\t")).collect(),
            Numbers::I64(list) => list.iter().map(|x| format!("{x} ")).collect(),
        };
        self.put(&text)
    }
}

/// PolyData in a form, with its lists of cells in another order than VTK numbers them.
fn poly_data(version: &str, is_binary: bool) -> Vec<u8> {
    let mut file = Legacy::new(version, is_binary, "POLYDATA");
    file.put("FIELD FieldData 1\ntime 1 1 double").numbers(&Numbers::F64(vec![0.5]));
    file.put("POINTS 5 float").numbers(&Numbers::F32(POINTS.to_vec()));
    file.put("METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1.5 \n");
    if version.starts_with('5') {
        file.put("TRIANGLE_STRIPS 2 4\nOFFSETS vtktypeint64").numbers(&Numbers::I64(vec![0, 4]));
        file.put("CONNECTIVITY vtktypeint64").numbers(&Numbers::I64(vec![0, 1, 3, 2]));
        file.put("LINES 2 2\nOFFSETS vtktypeint64").numbers(&Numbers::I64(vec![0, 2]));
        file.put("CONNECTIVITY vtktypeint64").numbers(&Numbers::I64(vec![0, 4]));
        file.put("POLYGONS 2 3\nOFFSETS vtktypeint64").numbers(&Numbers::I64(vec![0, 3]));
        file.put("CONNECTIVITY vtktypeint64").numbers(&Numbers::I64(vec![1, 4, 2]));
    } else {
        file.put("TRIANGLE_STRIPS 1 5").numbers(&Numbers::I32(vec![4, 0, 1, 3, 2]));
        file.put("LINES 1 3").numbers(&Numbers::I32(vec![2, 0, 4]));
        file.put("POLYGONS 1 4").numbers(&Numbers::I32(vec![3, 1, 4, 2]));
    }
    file.put("CELL_DATA 3\nSCALARS cell%20id int 1\nLOOKUP_TABLE default");
    file.numbers(&Numbers::I32(vec![7, 8, 9]));
    file.put("POINT_DATA 5\nSCALARS s float\nLOOKUP_TABLE mine");
    file.numbers(&Numbers::F32(vec![0.0, 1.0, 2.0, 3.0, 4.0])).put("LOOKUP_TABLE mine 2");
    let bytes: Vec<u8> = vec![0, 51, 102, 255, 255, 204, 153, 0];
    let fractions = |bytes: &[u8]| Numbers::F32(bytes.iter().map(|b| f32::from(*b) / 255.0).collect());
    let colors = |bytes: &[u8]| if is_binary { Numbers::U8(bytes.to_vec()) } else { fractions(bytes) };
    file.numbers(&colors(&bytes)).put("COLOR_SCALARS c 3");
    file.numbers(&colors(&[0, 51, 102].repeat(5))).put("VECTORS v double");
    file.numbers(&Numbers::F64((0..15).map(f64::from).collect())).put("NORMALS n float");
    file.numbers(&Numbers::F32([0.0, 0.0, 1.0].repeat(5))).put("TEXTURE_COORDINATES t 2 float");
    file.numbers(&Numbers::F32([0.25, 0.75].repeat(5))).put("FIELD FieldData 2\na 2 5 unsigned_char");
    file.numbers(&Numbers::U8((0..10).collect())).put("METADATA\nCOMPONENT_NAMES\nx\ny\n").put("few 1 2 int");
    file.numbers(&Numbers::I32(vec![1, 2]));
    file.bytes.clone()
}

#[test]
fn every_version_and_form_of_poly_data_is_the_same_mesh() {
    for version in ["1.0", "2.0", "3.0", "4.2", "5.1"] {
        for is_binary in [false, true] {
            let what = format!("{version} {is_binary}");
            let bytes = poly_data(version, is_binary);
            assert_eq!(Format::sniff(&bytes), Some(Format::Vtk), "{what}");
            let (scene, warnings) = load_scene(&bytes, Format::Vtk);
            let mesh = &scene.parts[0].mesh;
            assert_eq!(mesh.positions()[4], [2.0, 0.0, 0.5], "{what}");
            // Polygons come before strips, wherever they stand.
            assert_eq!(mesh.faces(), [[1, 4, 2], [0, 1, 3], [3, 1, 2]], "{what}");
            let of = |semantic: &Semantic| mesh.attribute(semantic).expect("kept");
            let custom = |name: &str| of(&Semantic::Custom(name.into()));
            assert_eq!(
                (custom("cell id").domain, &*custom("cell id").values),
                (Domain::Face, &[8.0, 9.0, 9.0][..])
            );
            assert_eq!(custom("s").values, [0.0, 1.0, 2.0, 3.0, 4.0]);
            assert_eq!((custom("v").width, custom("v").row(4)), (3, &[12.0, 13.0, 14.0][..]));
            assert_eq!((custom("a").width, custom("a").row(4)), (2, &[8.0, 9.0][..]));
            assert_eq!(of(&Semantic::Normal).row(4), [0.0, 0.0, 1.0]);
            assert_eq!(of(&Semantic::TexCoord(0)).row(4), [0.25, 0.75]);
            let close = |a: &[f64], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-7);
            assert!(close(of(&Semantic::Color(0)).row(4), [0.0, 0.2, 0.4]), "{what}");
            let counts = ["arrays-skipped", "lookup-tables-skipped", "cells-left-out"];
            assert_eq!(counts.map(|code| count(&warnings, code)), [2, 1, 1], "{what}");
        }
    }
}

#[test]
fn the_surface_of_a_grid_is_read_in_every_form() {
    for version in ["2.0", "5.1"] {
        for is_binary in [false, true] {
            let mut file = Legacy::new(version, is_binary, "UNSTRUCTURED_GRID");
            file.put("POINTS 5 float").numbers(&Numbers::F32(POINTS.to_vec()));
            if version == "5.1" {
                file.put("CELLS 4 11\nOFFSETS vtktypeint64").numbers(&Numbers::I64(vec![0, 3, 7, 11]));
                file.put("CONNECTIVITY vtktypeint64");
                file.numbers(&Numbers::I64(vec![0, 1, 2, 0, 1, 2, 4, 0, 1, 2, 3]));
            } else {
                file.put("CELLS 3 14");
                file.numbers(&Numbers::I32(vec![3, 0, 1, 2, 4, 0, 1, 2, 4, 4, 0, 1, 2, 3]));
            }
            file.put("CELL_TYPES 3").numbers(&Numbers::I32(vec![5, 10, 9]));
            file.put("CELL_DATA 3\nSCALARS id int").put("LOOKUP_TABLE default");
            file.numbers(&Numbers::I32(vec![1, 2, 3]));
            let (scene, warnings) = load_scene(&file.bytes, Format::Vtk);
            let mesh = &scene.parts[0].mesh;
            assert_eq!((mesh.faces().len(), mesh.faces()[0]), (3, [0, 1, 2]));
            assert_eq!(mesh.attributes()[0].values, [1.0, 3.0, 3.0]);
            assert_eq!(count(&warnings, "cells-left-out"), 1);
        }
    }
}

#[test]
fn texts_and_bits_are_skipped_by_their_size() {
    let head = "# vtk DataFile Version 4.2\nx\nBINARY\nDATASET POLYDATA\nFIELD FieldData 2\n";
    let mut bytes = head.as_bytes().to_vec();
    bytes.extend(b"names 1 3 string\n");
    // Lengths of 6, 14 and 30 bits.
    bytes.extend(b"\xC2ab");
    bytes.extend([&[0x80, 100][..], &[b'x'; 100]].concat());
    bytes.extend([&[0x40, 0, 0, 3][..], b"a\nb"].concat());
    bytes.extend(b"\nflags 1 11 bit\n\xff\xe0\nPOINTS 3 float\n");
    [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().for_each(|x| bytes.extend(x.to_be_bytes()));
    bytes.extend(b"\nPOLYGONS 1 4\n");
    [3_i32, 0, 1, 2].iter().for_each(|x| bytes.extend(x.to_be_bytes()));
    let (scene, warnings) = load_scene(&bytes, Format::Vtk);
    assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2]]);
    assert_eq!(count(&warnings, "arrays-skipped"), 2);
    let text = "# VTK DataFile Version 4.2\r\nx\r\nascii\r\ndataset polydata\r\nfield f 2\r\nnames 1 2 string\r\n\
                one 1\r\n\r\nflags 1 3 bit\r\n1 0 1\r\npoints 3 double 0 0 0 1 0 0\r\n0 1 0 polygons 1 4 3\r\n0 1 2";
    assert_eq!(load_scene(text.as_bytes(), Format::Vtk).0.parts[0].mesh.faces(), [[0, 1, 2]]);
}
