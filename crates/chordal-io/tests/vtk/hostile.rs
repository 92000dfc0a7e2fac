//! Ways in which VTK files lie, and what each leads to.
use super::build::{Encoding, Form, base64, poly_data, zlib};
use crate::common::{load_scene, refuse};
use chordal_io::{FileLocation, Format, Limits, read};

/// A triangle as text, with something else in the place of one thing.
fn changed(from: &str, to: &str) -> Vec<u8> {
    let text = "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n\
        <Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\">\n\
        <PointData><DataArray type=\"UInt8\" Name=\"u\">1 2 3</DataArray></PointData>\n\
        <Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray></Points>\n\
        <Polys><DataArray type=\"Int32\" Name=\"connectivity\">0 1 2</DataArray>\n\
        <DataArray type=\"Int32\" Name=\"offsets\">3</DataArray></Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n";
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1).into_bytes()
}

#[test]
fn xml_that_lies_is_one_error_at_its_place() {
    load_scene(&changed("1 2 3", "1 2 3"), Format::Vtp);
    let offset = "format=\"appended\" offset=\"9\"/";
    for (from, to, code) in [
        ("type=\"PolyData\"", "type=\"ImageData\"", "unsupported-data-set"),
        ("type=\"PolyData\"", "", "missing-attribute"),
        ("LittleEndian", "MiddleEndian", "unknown-value"),
        ("version=\"0.1\"", "compressor=\"vtkLZMADataCompressor\"", "unknown-value"),
        ("version=\"0.1\"", "header_type=\"Int8\"", "unknown-value"),
        ("NumberOfPoints=\"3\"", "NumberOfPoints=\"1000000000000\"", "too-many-rows"),
        ("NumberOfPoints=\"3\"", "NumberOfPoints=\"4000000000\"", "too-many-rows"),
        ("NumberOfPoints=\"3\"", "NumberOfPoints=\"400000000\"", "truncated"),
        ("NumberOfPoints=\"3\"", "NumberOfPoints=\"-1\"", "count-out-of-range"),
        ("NumberOfPoints=\"3\"", "NumberOfPoints=\"18446744073709551616\"", "count-out-of-range"),
        ("NumberOfPoints=\"3\"", "NumberOfPoints=\"1e3\"", "not-a-number"),
        ("NumberOfPoints=\"3\"", "NumberOfPoints=\"2\"", "index-out-of-range"),
        ("NumberOfPolys=\"1\"", "NumberOfPolys=\"2\"", "truncated"),
        ("NumberOfPolys=\"1\"", "NumberOfPolys=\"9000000000000000000\"", "too-many-rows"),
        ("NumberOfPolys=\"1\"", "NumberOfPolys=\"1\" NumberOfStrips=\"1\"", "no-cells"),
        ("NumberOfComponents=\"3\"", "NumberOfComponents=\"2\"", "wrong-width"),
        ("NumberOfComponents=\"3\"", "NumberOfComponents=\"99999999999999999999\"", "count-out-of-range"),
        ("0 0 0 1 0 0 0 1 0", "0 0 0 1 0 0 0 1", "truncated"),
        ("0 0 0 1 0 0 0 1 0", "0 0 0 1 0 0 0 nan 0", "not-finite"),
        ("0 0 0 1 0 0 0 1 0", "0 0 0 1 0 0 0 1,5 0", "not-a-number"),
        ("0 0 0 1 0 0 0 1 0", "1e308 0 0 -1e308 0 0 0 1 0", "extent-overflow"),
        ("0 1 2<", "0 1 3<", "index-out-of-range"),
        ("0 1 2<", "0 1 -1<", "index-out-of-range"),
        ("0 1 2<", "0 1 4294967297<", "value-out-of-range"),
        (">3</DataArray></Polys>", ">-3</DataArray></Polys>", "bad-offset"),
        (">3</DataArray></Polys>", ">4</DataArray></Polys>", "bad-offset"),
        ("1 2 3", "1 2", "truncated"),
        ("1 2 3", "1 2 256", "value-out-of-range"),
        ("\"UInt8\"", "\"UInt7\"", "unknown-value"),
        ("Name=\"u\">1 2 3</DataArray>", &*format!("Name=\"u\" {offset}>"), "no-appended-data"),
        ("Name=\"u\">1 2 3", "Name=\"u\" format=\"binary\">AA-AAAAA", "bad-base64"),
        ("</Piece>", "", "not-xml"),
        ("<PolyData>", "<!DOCTYPE x [<!ENTITY a \"b\">]><PolyData>", "dtd-not-allowed"),
        ("1 2 3", "1 2 &a;", "unknown-entity"),
    ] {
        let error = refuse(&changed(from, to), Format::Vtp);
        assert_eq!(error.code, code, "{to}: {error}");
    }
    let error = refuse(&changed("0 0 0 1 0 0 0 1 0", "0 0 0 1 0\n0 0 x 0"), Format::Vtp);
    assert_eq!(error.place, FileLocation::LineColumn { line: 6, column: 5 });
}

/// A file whose array of bytes has this content, in a form.
fn inline(attributes: &str, content: &str) -> Vec<u8> {
    let text = String::from_utf8(changed("version=\"0.1\"", attributes)).unwrap();
    text.replacen("Name=\"u\">1 2 3", &format!("Name=\"u\" format=\"binary\">{content}"), 1).into_bytes()
}

#[test]
fn packed_arrays_that_lie_are_refused() {
    let length = |n: u32| n.to_le_bytes().to_vec();
    let plain = |n: u32, bytes: &[u8]| inline("", &base64(&[length(n), bytes.to_vec()].concat()));
    load_scene(&plain(3, &[1, 2, 3]), Format::Vtp);
    assert_eq!(refuse(&plain(u32::MAX, &[1, 2, 3]), Format::Vtp).code, "truncated");
    assert_eq!(refuse(&plain(2, &[1, 2]), Format::Vtp).code, "truncated");
    let with = "compressor=\"vtkZLibDataCompressor\"";
    let packed = |header: &[u32], bytes: &[u8]| {
        let header: Vec<u8> = header.iter().flat_map(|n| n.to_le_bytes()).collect();
        inline(with, &(base64(&header) + &base64(bytes)))
    };
    let block = zlib(&[1, 2, 3]);
    let n = block.len() as u32;
    load_scene(&packed(&[1, 3, 0, n], &block), Format::Vtp);
    load_scene(&packed(&[1, 8, 3, n], &block), Format::Vtp);
    for (header, bytes, code) in [
        (&[1, 4, 0, n][..], &block[..], "size-mismatch"),
        (&[1, 2, 0, n], &block, "too-large"),
        (&[2, 3, 0, n, n], &block, "truncated"),
        (&[u32::MAX, 3, 0, n], &block, "truncated"),
        (&[1, 3, 0, u32::MAX], &block, "truncated"),
        (&[1, u32::MAX, u32::MAX, n], &block, "too-dense"),
        (&[1, 3, 0, n - 2], &block[..block.len() - 2], "bad-deflate"),
        (&[0, 0, 0], &[], "truncated"),
        (&[1], &[], "truncated"),
    ] {
        let error = refuse(&packed(header, bytes), Format::Vtp);
        assert_eq!(error.code, code, "{header:?}: {error}");
    }
    // What is unpacked counts against the limit, and a bomb ends there.
    let bomb = zlib(&vec![0; 1 << 24]);
    let bytes = packed(&[1, 1 << 24, 0, bomb.len() as u32], &bomb);
    let limits = Limits { bytes: 1 << 20, ..Limits::default() };
    assert_eq!(read(&bytes, Format::Vtp, &limits).unwrap_err().code, "too-large");
}

#[test]
fn appended_bytes_belong_to_one_array_each() {
    let encoding = Encoding { form: Form::AppendedRaw, ..Encoding::TEXT };
    let text = |bytes: &[u8]| bytes.to_vec();
    let bytes = text(&poly_data(encoding));
    let at = |needle: &[u8]| bytes.windows(needle.len()).position(|w| w == needle).expect("there");
    // Many arrays of the same bytes.
    let array = "<DataArray type=\"Float64\" Name=\"t\" format=\"appended\" offset=\"98\"/>";
    let many: String = (0..40).map(|i| array.replace("\"t\"", &format!("\"t{i}\""))).collect();
    let mut copied = bytes.clone();
    let end = at(b"</PointData>");
    copied.splice(end..end, many.bytes());
    assert_eq!(refuse(&copied, Format::Vtp).code, "overlapping-arrays");
    let mut beyond = bytes.clone();
    let start = at(b"offset=\"0\"") + 8;
    beyond.splice(start..start + 1, b"999999999".iter().copied());
    assert_eq!(refuse(&beyond, Format::Vtp).code, "offset-out-of-range");
    for (from, to, code) in [
        (&b"encoding=\"raw\">"[..], &b"encoding=\"hex\">"[..], "unknown-value"),
        (b"encoding=\"raw\">\n_", b"encoding=\"raw\">\n.", "bad-appended-data"),
    ] {
        let mut changed = bytes.clone();
        let start = at(from);
        changed.splice(start..start + from.len(), to.iter().copied());
        assert_eq!(refuse(&changed, Format::Vtp).code, code);
    }
    let cut = &bytes[..at(b"<AppendedData") + 20];
    assert_eq!(refuse(cut, Format::Vtp).code, "truncated");
}

#[test]
fn values_of_cells_are_not_spread_without_limit() {
    // One cell of many corners, and many arrays of one value.
    let n = 1_000_000;
    let arrays: String =
        (0..40).map(|i| format!("<DataArray type=\"UInt8\" Name=\"{i}\">1</DataArray>")).collect();
    let corners = "0 1 2 ".repeat(n / 3);
    let text = String::from_utf8(changed("0 1 2<", &format!("{corners}<"))).unwrap();
    let text = text.replacen(">3</DataArray></Polys>", &format!(">{}</DataArray></Polys>", n / 3 * 3), 1);
    let text = text.replacen("<Points>", &format!("<CellData>{arrays}</CellData><Points>"), 1);
    assert_eq!(refuse(text.as_bytes(), Format::Vtp).code, "too-many-values");
}

#[test]
fn a_file_without_a_surface_is_refused_and_says_what_it_holds() {
    let text = "# vtk DataFile Version 2.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 int\n\
                0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 2 8\n4 0 1 2 3 2 0 1\nCELL_TYPES 2\n10 3\n";
    let error = refuse(text.as_bytes(), Format::Vtk);
    assert_eq!(error.code, "no-surface");
    assert!(error.message.contains("1 line (type 3), 1 tetrahedron (type 10)"), "{error}");
}

#[test]
fn legacy_files_that_lie_are_one_error_at_their_line() {
    let text = "# vtk DataFile Version 2.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\n\
                POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3\n";
    load_scene(text.as_bytes(), Format::Vtk);
    for (from, to, code) in [
        ("# vtk", "# vkt", "not-vtk"),
        ("ASCII", "TEXT", "not-vtk"),
        ("POLYDATA", "STRUCTURED_GRID", "unsupported-data-set"),
        ("POINTS 3", "POINTS 1000000000000", "truncated"),
        ("POINTS 3", "POINTS 99999999999999999999", "count-out-of-range"),
        ("POINTS 3", "POINTS -3", "count-out-of-range"),
        ("POINTS 3 float", "POINTS 3 flout", "type-unknown"),
        ("POINTS 3 float", "POINTS 3 string", "type-unknown"),
        ("1 0 0 0", "1 0 x 0", "not-a-number"),
        ("1 0 0 0", "1 0 inf 0", "not-finite"),
        ("POLYGONS 1 4", "POLYGONS 1 5", "not-a-number"),
        ("POLYGONS 1 4", "POLYGONS 2 4", "truncated"),
        ("POLYGONS 1 4", "POLYGONS 1000000000 4", "too-many-rows"),
        ("3 0 1 2", "4 0 1 2", "bad-offset"),
        ("3 0 1 2", "-3 0 1 2", "bad-offset"),
        ("3 0 1 2", "3 0 1 3", "index-out-of-range"),
        ("POINT_DATA 3", "POINT_DATA 4", "count-mismatch"),
        ("POINT_DATA 3", "POINT_DATTA 3", "unknown-keyword"),
        ("SCALARS s float", "SCALARS s float 99999999999", "truncated"),
        ("SCALARS s float", "SKALARS s float", "unknown-keyword"),
        ("1 2 3\n", "1 2\n", "truncated"),
        (
            "POLYGONS 1 4\n3 0 1 2",
            "POLYGONS 2 3\nOFFSETS vtktypeint64\n1 3\nCONNECTIVITY int\n0 1 2",
            "bad-offset",
        ),
        (
            "POLYGONS 1 4\n3 0 1 2",
            "POLYGONS 2 3\nOFFSETS vtktypeint64\n0 3\nCONNECT int\n0 1 2",
            "unknown-keyword",
        ),
        ("POLYGONS 1 4", "POLYGONS 1 4\n3 0 1 2\nPOLYGONS 1 4", "repeated-keyword"),
        ("POLYGONS 1 4", "CELLS 1 4", "wrong-cells"),
    ] {
        assert!(text.contains(from), "{from}");
        let error = refuse(text.replacen(from, to, 1).as_bytes(), Format::Vtk);
        assert_eq!(error.code, code, "{to}: {error}");
    }
    let error = refuse(text.replacen("1 0 0 0", "1 0 x 0", 1).as_bytes(), Format::Vtk);
    assert_eq!(error.place, FileLocation::Line(6));
    let long = format!("# vtk DataFile Version 2.0\n{}\nASCII\n", "x".repeat(1 << 17));
    assert_eq!(refuse(long.as_bytes(), Format::Vtk).code, "line-too-long");
}
